/* SPDX-License-Identifier: BSD-3-Clause
 * Pages of a volume's values: the pages that rays need, their copy in the layout of kernels/ray/ray_cast_arguments.h, and the table of
 * their places. A page is left out if it holds no value of an occupied block, and none that a sample in such a block reads next to it: all
 * samples in it would add exactly zero. */
#include "ray_pages_device.h"

#include <stdio.h>
#include <string.h>

/* Pages are copied to the device so many bytes at a time. */
#define STAGE_BYTES ((size_t)8 << 20)
/* The table's mark of a page that is to get a place. */
#define WANTED 0
#define ABSENT (-1)

void stratus_ray_pages_drop(stratus_context* context, stratus_ray_pages* pages)
{
  for (int s = 0; s < PAGE_SLABS; ++s) {
    stratus_slot_drop(&pages->slabs[s]);
  }
  stratus_slot_drop(&pages->table);
  stratus_release(context, pages->entries);
  *pages = (stratus_ray_pages){ .uploads = pages->uploads };
}

void stratus_ray_pages_arguments(const stratus_ray_pages* pages, int planes, stratus_ray_cast_arguments* a)
{
  a->values.pages_across = (int)pages->pages[0];
  a->values.pages_rows = (int)pages->pages[1];
  a->values.page_components = planes;
}

/* ---- which pages */

static int64_t page_of(int64_t value, int64_t values)
{
  const int64_t inside = value < 0 ? 0 : value >= values ? values - 1 : value;
  return inside >> PAGE_LOG2;
}

/* Marks the pages about the occupied blocks. */
static void mark_pages(
  const stratus_volume* volume, const stratus_occupancy* occupancy, const int margin[2], const int64_t pages[3], int32_t* wanted)
{
  const int64_t *blocks = occupancy->blocks, *n = volume->dimensions, size = occupancy->block_size;
  for (int64_t block = 0; block < blocks[0] * blocks[1] * blocks[2]; ++block) {
    if (!occupancy->occupied[block]) {
      continue;
    }
    const int64_t at[3] = { block % blocks[0], block / blocks[0] % blocks[1], block / (blocks[0] * blocks[1]) };
    int64_t lo[3], hi[3];
    for (int axis = 0; axis < 3; ++axis) {
      lo[axis] = page_of(at[axis] * size - margin[0], n[axis]);
      hi[axis] = page_of((at[axis] + 1) * size - 1 + margin[1], n[axis]);
    }
    for (int64_t k = lo[2]; k <= hi[2]; ++k) {
      for (int64_t j = lo[1]; j <= hi[1]; ++j) {
        for (int64_t i = lo[0]; i <= hi[0]; ++i) {
          wanted[(k * pages[1] + j) * pages[0] + i] = WANTED;
        }
      }
    }
  }
}

/* Gives each wanted page a place, `in_slab` pages in a slab. Returns their number. */
static int64_t place_pages(int32_t* entries, int64_t table, int64_t in_slab)
{
  int64_t count = 0;
  for (int64_t page = 0; page < table; ++page) {
    if (entries[page] != ABSENT) {
      entries[page] = (int32_t)((count / in_slab << PAGE_SLAB_SHIFT) + count % in_slab);
      ++count;
    }
  }
  return count;
}

static bool has_all(const stratus_ray_pages* pages, const int32_t* wanted, int64_t table)
{
  for (int64_t page = 0; page < table; ++page) {
    if (wanted[page] != ABSENT && pages->entries[page] == ABSENT) {
      return false;
    }
  }
  return true;
}

/* ---- copies */

/* A volume as pages are copied from it. Strides are in values. */
typedef struct page_source {
  const uint8_t* values;
  const stratus_tiles* tiles; /* of each component; NULL: values are not in tiles */
  int64_t dimensions[3];
  size_t stride, component, size; /* size: bytes of a value */
  int components;
} page_source;

static page_source source_of(const stratus_ray_field* field)
{
  const stratus_volume* v = &field->traversed;
  const bool planes = v->values == field->fetched || v->gradients; /* one component, or derivative, after the other */
  return (page_source){ .values = v->values,
    .tiles = v->tiles.values ? field->tiles : NULL,
    .dimensions = { v->dimensions[0], v->dimensions[1], v->dimensions[2] },
    .stride = (size_t)v->value_stride,
    .component = planes ? stratus_volume_count(v) : 1,
    .size = stratus_type_size(v->type),
    .components = stratus_volume_planes(v) };
}

/* Copies a row of PAGE_ROW values. The last `beyond` of them repeat the volume's last. */
static void copy_row(const page_source* s, const uint8_t* from, int64_t beyond, uint8_t* to)
{
  const size_t inside = (size_t)(PAGE_ROW - beyond);
  if (s->stride == 1) {
    memcpy(to, from, inside * s->size);
  } else {
    for (size_t i = 0; i < inside; ++i) {
      memcpy(to + i * s->size, from + i * s->stride * s->size, s->size);
    }
  }
  for (size_t i = inside; i < PAGE_ROW; ++i) {
    memcpy(to + i * s->size, to + (inside - 1) * s->size, s->size);
  }
}

/* The same from tiles; `at`: the row's first value. */
static void copy_tile_row(const page_source* s, const stratus_tiles* tiles, const int64_t at[3], int64_t beyond, uint8_t* to)
{
  const uint8_t* from = (const uint8_t*)tiles->values + tiles->at[1][at[1]] + tiles->at[2][at[2]];
  for (int64_t i = 0; i < PAGE_ROW; ++i) {
    const int64_t inside = i < PAGE_ROW - beyond ? i : PAGE_ROW - beyond - 1;
    memcpy(to + (size_t)i * s->size, from + tiles->at[0][at[0] + inside], s->size);
  }
}

static void copy_page(const page_source* s, const int64_t page[3], uint8_t* to)
{
  const int64_t* n = s->dimensions;
  const int64_t first[3] = { page[0] << PAGE_LOG2, page[1] << PAGE_LOG2, page[2] << PAGE_LOG2 };
  const int64_t over = first[0] + PAGE_ROW - n[0], beyond = over > 0 ? over : 0;
  for (int c = 0; c < s->components; ++c) {
    for (int64_t z = 0; z < PAGE_ROW; ++z) {
      for (int64_t y = 0; y < PAGE_ROW; ++y) {
        const int64_t j = first[1] + y < n[1] ? first[1] + y : n[1] - 1, k = first[2] + z < n[2] ? first[2] + z : n[2] - 1;
        const size_t value = (size_t)((k * n[1] + j) * n[0] + first[0]) * s->stride + (size_t)c * s->component;
        if (s->tiles) {
          copy_tile_row(s, &s->tiles[c], (const int64_t[]){ first[0], j, k }, beyond, to);
        } else {
          copy_row(s, s->values + value * s->size, beyond, to);
        }
        to += PAGE_ROW * s->size;
      }
    }
  }
}

/* Fills a slab with the `count` pages whose numbers in the table are in `list`. */
static stratus_status send_pages(stratus_context* context, const page_source* source, const stratus_ray_pages* pages, const int64_t* list,
  int64_t count, size_t page_bytes, cl_mem slab, uint8_t* stage)
{
  const int64_t most = (int64_t)(STAGE_BYTES / page_bytes) > 0 ? (int64_t)(STAGE_BYTES / page_bytes) : 1;
  for (int64_t begin = 0; begin < count; begin += most) {
    const int64_t part = count - begin < most ? count - begin : most;
#pragma omp parallel for schedule(static) num_threads(context->threads)
    for (int64_t p = 0; p < part; ++p) {
      const int64_t number = list[begin + p], across = pages->pages[0], rows = pages->pages[1];
      copy_page(
        source, (const int64_t[]){ number % across, number / across % rows, number / (across * rows) }, stage + (size_t)p * page_bytes);
    }
    TRY(stratus_device_write(context, slab, (size_t)begin * page_bytes, (size_t)part * page_bytes, stage));
  }
  return STRATUS_OK;
}

/* Sends all pages of the table, `in_slab` in each slab, and the table. */
static stratus_status send_all(const stratus_ray_field* field, stratus_ray_pages* pages, int64_t table, int64_t in_slab, size_t page_bytes)
{
  stratus_context* context = field->context;
  const page_source source = source_of(field);
  const size_t stage_bytes = page_bytes > STAGE_BYTES ? page_bytes : STAGE_BYTES, needed = (size_t)pages->count * page_bytes;
  stratus_status status = STRATUS_OK;
  void *stage = NULL, *list = NULL;

  TRY_CLEANUP(stratus_allocate(context, needed < stage_bytes ? needed + 1 : stage_bytes, 1, &stage));
  TRY_CLEANUP(stratus_allocate(context, (size_t)pages->count + 1, sizeof(int64_t), &list));
  int64_t* numbers = list;
  for (int64_t page = 0, count = 0; page < table; ++page) {
    if (pages->entries[page] != ABSENT) {
      numbers[count] = page;
      ++count;
    }
  }
  for (int s = 0; s < PAGE_SLABS; ++s) {
    const int64_t left = pages->count - s * in_slab, count = left < 0 ? 0 : left < in_slab ? left : in_slab;
    if (count == 0) {
      TRY_CLEANUP(stratus_slot_keep(context, &pages->slabs[s], NULL, 0)); /* a kernel's argument must be some buffer */
      continue;
    }
    TRY_CLEANUP(stratus_slot_reserve(context, &pages->slabs[s], CL_MEM_READ_ONLY, (size_t)count * page_bytes));
    TRY_CLEANUP(send_pages(context, &source, pages, numbers + s * in_slab, count, page_bytes, pages->slabs[s].memory, stage));
    ++pages->uploads;
  }
  TRY_CLEANUP(stratus_slot_reserve(context, &pages->table, CL_MEM_READ_ONLY, (size_t)table * sizeof(int32_t)));
  TRY_CLEANUP(stratus_device_write(context, pages->table.memory, 0, (size_t)table * sizeof(int32_t), pages->entries));
  ++pages->uploads;

cleanup:
  stratus_release(context, stage);
  stratus_release(context, list);
  return status;
}

/* Takes over the table `wanted`, places its pages and sends them. */
static stratus_status replace_pages(const stratus_ray_field* field, stratus_ray_pages* pages, int32_t* wanted, int64_t table,
  size_t page_bytes, char* text, size_t capacity, const char** why_not)
{
  stratus_context* context = field->context;
  const size_t largest = stratus_device_largest_allocation(context->device), most = ((size_t)1 << PAGE_SLAB_SHIFT) - 1;
  const size_t fit = largest / page_bytes < most ? largest / page_bytes : most;
  const int64_t count = fit > 0 ? place_pages(wanted, table, (int64_t)fit) : 1;
  const stratus_stage stage = stratus_stage_begin(context);
  if (count > PAGE_SLABS * (int64_t)fit || (size_t)table > largest / sizeof(int32_t)) {
    snprintf(text, capacity, "the blocks that show take %.4g MB, and %d of the device's largest allocations hold %.4g MB",
      (double)count * (double)page_bytes / 1e6, PAGE_SLABS, (double)PAGE_SLABS * (double)largest / 1e6);
    *why_not = text;
    stratus_release(context, wanted);
    return STRATUS_OK;
  }
  stratus_release(context, pages->entries);
  pages->entries = wanted;
  pages->count = count;
  pages->bytes = (size_t)count * page_bytes;
  TRY(send_all(field, pages, table, (int64_t)fit, page_bytes));
  stratus_stage_end(context, &stage, "pages of values", pages->bytes);
  return STRATUS_OK;
}

stratus_status stratus_ray_pages_update(const stratus_ray_field* field, const stratus_ray_structure* structure, const int margin[2],
  stratus_ray_pages* pages, char* text, size_t capacity, const char** why_not)
{
  stratus_context* context = field->context;
  const stratus_volume* volume = &field->traversed;
  *why_not = NULL;
  if (pages->data_serial != field->data_serial) {
    stratus_release(context, pages->entries);
    pages->entries = NULL;
  }
  const bool covered = margin[0] <= pages->margin[0] && margin[1] <= pages->margin[1];
  if (pages->entries && covered && pages->occupancy_serial == structure->occupancy_serial) {
    return STRATUS_OK;
  }
  int64_t table = 1;
  for (int axis = 0; axis < 3; ++axis) {
    pages->pages[axis] = page_of(volume->dimensions[axis] - 1, volume->dimensions[axis]) + 1;
    table *= pages->pages[axis];
  }
  void* wanted = NULL;
  TRY(stratus_allocate(context, (size_t)table, sizeof(int32_t), &wanted));
  memset(wanted, 0xff, (size_t)table * sizeof(int32_t)); /* all ABSENT */
  mark_pages(volume, structure->occupancy, margin, pages->pages, wanted);
  if (pages->entries && has_all(pages, wanted, table)) {
    stratus_release(context, wanted);
  } else {
    const size_t page_bytes = PAGE_VALUES * stratus_type_size(volume->type) * (size_t)stratus_volume_planes(volume);
    const stratus_status status = replace_pages(field, pages, wanted, table, page_bytes, text, capacity, why_not);
    if (status != STRATUS_OK || *why_not) {
      stratus_ray_pages_drop(context, pages);
      return status;
    }
  }
  pages->data_serial = field->data_serial;
  pages->occupancy_serial = structure->occupancy_serial;
  memcpy(pages->margin, margin, sizeof pages->margin);
  return STRATUS_OK;
}
