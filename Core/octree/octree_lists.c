/* SPDX-License-Identifier: BSD-3-Clause
 * A node's list of boxes. Packs of sixteen boxes let one instruction test as many as the machine is wide. Ids lie apart from them, so that
 * the ids of a list that is seen whole are copied as they stand. */
#include "octree.h"

#include <string.h>

#define PACK_BYTES (STRATUS_PACK_FLOATS * sizeof(float) + STRATUS_PACK * sizeof(uint32_t) + 1)

stratus_status stratus_list_allocate(stratus_context* context, size_t count, stratus_octree_list* list)
{
  const size_t packs = (count + STRATUS_PACK - 1) / STRATUS_PACK;
  void* memory = NULL;
  *list = (stratus_octree_list){ 0 };
  if (packs == 0) {
    return STRATUS_OK;
  }
  TRY(stratus_allocate(context, packs, PACK_BYTES, &memory));
  list->boxes = memory;
  list->packs = (uint32_t)packs;
  memset(stratus_list_hints(list), 0, packs);
  return STRATUS_OK;
}

void stratus_list_release(stratus_context* context, stratus_octree_list* list)
{
  stratus_release(context, list->boxes);
  *list = (stratus_octree_list){ 0 };
}

void stratus_list_set(const stratus_octree_list* list, uint32_t slot, const float box[6])
{
  float* to = stratus_list_box(list, slot);
  for (int i = 0; i < 6; ++i) {
    to[i * STRATUS_PACK] = box[i];
  }
}

void stratus_list_get(const stratus_octree_list* list, uint32_t slot, float box[6])
{
  const float* from = stratus_list_box(list, slot);
  for (int i = 0; i < 6; ++i) {
    box[i] = from[i * STRATUS_PACK];
  }
}

void stratus_list_clear_rest(const stratus_octree_list* list, uint32_t slot)
{
  if (slot % STRATUS_PACK == 0) {
    memset(stratus_list_box(list, slot), 0, STRATUS_PACK_FLOATS * sizeof(float));
  }
}

stratus_status stratus_list_reserve(stratus_context* context, stratus_octree_list* list, size_t needed)
{
  stratus_octree_list larger;
  if (needed <= (size_t)list->packs * STRATUS_PACK) {
    return STRATUS_OK;
  }
  TRY(stratus_list_allocate(context, needed, &larger));
  if (list->count > 0) {
    memcpy(larger.boxes, list->boxes, list->packs * STRATUS_PACK_FLOATS * sizeof(float));
    memcpy(stratus_list_ids(&larger), stratus_list_ids(list), list->count * sizeof(uint32_t));
    memcpy(stratus_list_hints(&larger), stratus_list_hints(list), list->packs);
  }
  larger.count = list->count;
  stratus_release(context, list->boxes);
  *list = larger;
  return STRATUS_OK;
}

stratus_status stratus_list_append(stratus_context* context, stratus_octree_list* list, const float box[6], uint32_t id, uint32_t* slot)
{
  if (list->count == list->packs * STRATUS_PACK) {
    TRY(stratus_list_reserve(context, list, (size_t)list->count + list->count / 2 + 1));
  }
  *slot = list->count++;
  stratus_list_clear_rest(list, *slot);
  stratus_list_set(list, *slot, box);
  stratus_list_ids(list)[*slot] = id;
  return STRATUS_OK;
}

uint32_t stratus_list_find(const stratus_octree_list* list, uint32_t id, uint32_t guess)
{
  if (list->count == 0) {
    return UINT32_MAX;
  }
  const uint32_t* ids = stratus_list_ids(list);
  if (guess < list->count && ids[guess] == id) {
    return guess;
  }
  for (uint32_t i = 0; i < list->count; ++i) {
    if (ids[i] == id) {
      return i;
    }
  }
  return UINT32_MAX;
}

void stratus_list_remove(stratus_octree_list* list, uint32_t slot, uint32_t* slots)
{
  const uint32_t last = --list->count;
  if (slot != last) {
    float box[6];
    uint32_t* ids = stratus_list_ids(list);
    stratus_list_get(list, last, box);
    stratus_list_set(list, slot, box);
    ids[slot] = ids[last];
    if (slots[ids[slot]] == last) {
      slots[ids[slot]] = slot;
    }
  }
}

size_t stratus_list_bytes(const stratus_octree_list* list)
{
  return list->packs * PACK_BYTES;
}

stratus_status stratus_octree_reserve(stratus_context* context, void** memory, size_t* capacity, size_t needed, size_t used, size_t size)
{
  if (needed <= *capacity) {
    return STRATUS_OK;
  }
  const size_t grown = *capacity + *capacity / 2, room = grown > needed ? grown : needed;
  void* larger = NULL;
  TRY(stratus_allocate(context, room, size, &larger));
  if (used > 0) {
    memcpy(larger, *memory, used * size);
  }
  stratus_release(context, *memory);
  *memory = larger;
  *capacity = room;
  return STRATUS_OK;
}
