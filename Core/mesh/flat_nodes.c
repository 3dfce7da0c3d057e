/* SPDX-License-Identifier: BSD-3-Clause
 * Nodes that faces on a plane need in addition to the mesh's, each once, and the arrays of such faces. */
#include "flat_faces.h"

#include <string.h>

/* Makes room for `needed` items, of which the first `used` are kept. */
static stratus_status reserve(stratus_context* context, void** memory, int64_t* room, int64_t used, int64_t needed, size_t size)
{
  if (needed <= *room) {
    return STRATUS_OK;
  }
  void* larger;
  const int64_t wanted = needed + needed / 2;
  TRY(stratus_allocate(context, (size_t)wanted, size, &larger));
  if (used > 0) {
    memcpy(larger, *memory, (size_t)used * size);
  }
  stratus_release(context, *memory);
  *memory = larger;
  *room = wanted;
  return STRATUS_OK;
}

static stratus_status reserve_node(flat_builder* b)
{
  if (b->count >= INT32_MAX) {
    return stratus_fail(b->context, STRATUS_OVERFLOW, "a mesh of more than %d nodes, with those where it is cut", INT32_MAX);
  }
  void* memory = b->nodes;
  const stratus_status status = reserve(b->context, &memory, &b->room, b->count, b->count + 1, sizeof *b->nodes);
  b->nodes = memory;
  return status;
}

static int64_t bucket_of(const flat_builder* b, const int32_t key[2], double longitude)
{
  uint64_t bits;
  longitude += 0.0; /* -0 is 0 */
  memcpy(&bits, &longitude, sizeof bits);
  bits = (bits ^ (uint64_t)(uint32_t)key[0] * 0x9e3779b97f4a7c15u) * 0xc2b2ae3d27d4eb4fu ^ (uint64_t)(uint32_t)key[1] * 0x165667b19e3779f9u;
  return (int64_t)((bits ^ bits >> 31) & (uint64_t)(b->bucket_count - 1));
}

static void enter(flat_builder* b, int32_t node)
{
  int32_t* const bucket = b->buckets + bucket_of(b, b->nodes[node].key, b->nodes[node].x);
  b->nodes[node].next = *bucket;
  *bucket = node;
}

/* Makes as many buckets as there will be nodes to be found. */
static stratus_status reserve_bucket(flat_builder* b, int64_t from)
{
  const int64_t needed = b->count + 1 - from;
  if (needed <= b->bucket_count) {
    return STRATUS_OK;
  }
  int64_t wanted = b->bucket_count > 0 ? b->bucket_count : 64;
  while (wanted < needed) {
    wanted *= 2;
  }
  void* larger;
  TRY(stratus_allocate(b->context, (size_t)(2 * wanted), sizeof *b->buckets, &larger));
  stratus_release(b->context, b->buckets);
  b->buckets = larger;
  b->bucket_count = 2 * wanted;
  for (int64_t i = 0; i < b->bucket_count; ++i) {
    b->buckets[i] = -1;
  }
  for (int64_t node = from; node < b->count; ++node) {
    enter(b, (int32_t)node);
  }
  return STRATUS_OK;
}

/* Finds the node of a key and longitude, or adds one. */
static stratus_status find_or_add(flat_builder* b, const flat_node* node, int32_t* found)
{
  TRY(reserve_node(b));
  TRY(reserve_bucket(b, b->own));
  for (int32_t i = b->buckets[bucket_of(b, node->key, node->x)]; i >= 0; i = b->nodes[i].next) {
    const flat_node* const other = b->nodes + i;
    if (other->x == node->x && other->key[0] == node->key[0] && other->key[1] == node->key[1]) {
      *found = i;
      return STRATUS_OK;
    }
  }
  *found = (int32_t)b->count++;
  b->nodes[*found] = *node;
  enter(b, *found);
  return STRATUS_OK;
}

stratus_status stratus_flat_begin(flat_builder* b, const stratus_faces* faces, const double* degrees)
{
  void* memory = NULL;
  TRY(reserve(b->context, &memory, &b->room, 0, faces->node_count, sizeof *b->nodes));
  b->nodes = memory;
  b->count = b->own = faces->node_count;
  for (int32_t i = 0; i < (int32_t)faces->node_count; ++i) {
    b->nodes[i] = (flat_node){ degrees[2 * (int64_t)i], degrees[2 * (int64_t)i + 1], i, i, 1.0, { i, i }, -1 };
  }
  return STRATUS_OK;
}

stratus_status stratus_flat_copy(flat_builder* b, int32_t node, double longitude, int32_t* found)
{
  if (b->nodes[node].x == longitude) {
    *found = node;
    return STRATUS_OK;
  }
  flat_node copy = b->nodes[node];
  copy.x = longitude;
  copy.key[0] = copy.key[1] = node;
  return find_or_add(b, &copy, found);
}

stratus_status stratus_flat_between(flat_builder* b, const int32_t nodes[2], const double longitudes[2], double meridian, int32_t* found)
{
  const int low = nodes[1] < nodes[0]; /* in this order for both faces at the edge */
  const flat_node *one = b->nodes + nodes[low], *other = b->nodes + nodes[1 - low];
  const double weight = (longitudes[1 - low] - meridian) / (longitudes[1 - low] - longitudes[low]);
  const flat_node between = { meridian, weight * one->y + (1.0 - weight) * other->y, one->first, other->first, weight,
    { nodes[low], nodes[1 - low] }, -1 };
  return find_or_add(b, &between, found);
}

stratus_status stratus_flat_pole(flat_builder* b, int32_t node, int32_t* added)
{
  flat_node pole = b->nodes[node];
  pole.y = copysign(90.0, pole.y);
  pole.key[0] = pole.key[1] = (int32_t)b->count;
  return find_or_add(b, &pole, added);
}

stratus_status stratus_flat_add(flat_builder* b, int64_t face, const int32_t* nodes, int count)
{
  flat_list* const list = b->first.count == face ? &b->first : &b->more;
  const int64_t begin = list->count > 0 ? list->ends[list->count - 1] : 0;
  void *ends = list->ends, *of = list->of, *own = list->nodes;
  stratus_status status = reserve(b->context, &ends, &list->room, list->count, list->count + 1, sizeof *list->ends);
  list->ends = ends;
  TRY(status);
  status = reserve(b->context, &of, &list->of_room, list->count, list->count + 1, sizeof *list->of);
  list->of = of;
  TRY(status);
  status = reserve(b->context, &own, &list->node_room, begin, begin + count, sizeof *list->nodes);
  list->nodes = own;
  TRY(status);
  memcpy(list->nodes + begin, nodes, (size_t)count * sizeof *nodes);
  list->ends[list->count] = begin + count;
  list->of[list->count++] = (int32_t)face;
  return STRATUS_OK;
}

/* Adds a list's faces behind those that are there. */
static void append(const flat_list* list, stratus_flat_faces* flat)
{
  stratus_faces* const to = &flat->faces;
  const int64_t before = to->offsets[to->face_count];
  for (int64_t i = 0; i < list->count; ++i) {
    to->offsets[to->face_count + 1] = before + list->ends[i];
    flat->face_of[to->face_count++] = list->of[i];
  }
  if (list->count > 0) {
    memcpy(to->nodes + before, list->nodes, (size_t)list->ends[list->count - 1] * sizeof *list->nodes);
  }
}

stratus_status stratus_flat_end(flat_builder* b, const stratus_faces* faces, stratus_flat_faces* flat)
{
  const int64_t count = b->first.count + b->more.count, more = b->more.count > 0 ? b->more.ends[b->more.count - 1] : 0;
  if (count > INT32_MAX) {
    return stratus_fail(b->context, STRATUS_OVERFLOW, "a mesh of more than %d faces, with their parts", INT32_MAX);
  }
  void *offsets = NULL, *nodes = NULL, *absent = NULL, *degrees = NULL, *node_of = NULL, *weights = NULL, *face_of = NULL;
  stratus_status status = STRATUS_OK;
  TRY_CLEANUP(stratus_allocate_zero(b->context, (size_t)count + 1, sizeof(int64_t), &offsets));
  TRY_CLEANUP(stratus_allocate(b->context, (size_t)(b->first.ends[b->first.count - 1] + more), sizeof(int32_t), &nodes));
  TRY_CLEANUP(stratus_allocate_zero(b->context, (size_t)count, 1, &absent));
  TRY_CLEANUP(stratus_allocate(b->context, (size_t)count, sizeof(int32_t), &face_of));
  TRY_CLEANUP(stratus_allocate(b->context, (size_t)b->count, 2 * sizeof(double), &degrees));
  TRY_CLEANUP(stratus_allocate(b->context, (size_t)b->count, 2 * sizeof(int32_t), &node_of));
  TRY_CLEANUP(stratus_allocate(b->context, (size_t)b->count, sizeof(double), &weights));
  flat->faces = (stratus_faces){ .node_count = b->count, .offsets = offsets, .nodes = nodes, .absent = absent };
  flat->degrees = degrees;
  flat->node_of = node_of;
  flat->weights = weights;
  flat->face_of = face_of;
  append(&b->first, flat);
  append(&b->more, flat);
  if (faces->absent) {
    memcpy(absent, faces->absent, (size_t)faces->face_count);
  }
  for (int64_t i = 0; i < b->count; ++i) {
    flat->degrees[2 * i] = b->nodes[i].x;
    flat->degrees[2 * i + 1] = b->nodes[i].y;
    flat->node_of[2 * i] = b->nodes[i].first;
    flat->node_of[2 * i + 1] = b->nodes[i].second;
    flat->weights[i] = b->nodes[i].weight;
  }
  return STRATUS_OK;
cleanup:
  for (size_t i = 0; i < 7; ++i) {
    stratus_release(b->context, ((void*[]){ offsets, nodes, absent, degrees, node_of, weights, face_of })[i]);
  }
  return status;
}

static void release_list(stratus_context* context, flat_list* list)
{
  stratus_release(context, list->ends);
  stratus_release(context, list->of);
  stratus_release(context, list->nodes);
}

void stratus_flat_release(flat_builder* b)
{
  stratus_release(b->context, b->nodes);
  stratus_release(b->context, b->buckets);
  release_list(b->context, &b->first);
  release_list(b->context, &b->more);
}

void stratus_flat_faces_destroy(stratus_context* context, stratus_flat_faces* flat)
{
  if (!context || !flat) {
    return;
  }
  stratus_release(context, flat->faces.offsets);
  stratus_release(context, flat->faces.nodes);
  stratus_release(context, flat->faces.absent);
  stratus_release(context, flat->degrees);
  stratus_release(context, flat->node_of);
  stratus_release(context, flat->weights);
  stratus_release(context, flat->face_of);
  memset(flat, 0, sizeof *flat);
}
