/* SPDX-License-Identifier: BSD-3-Clause
 * Exact Euclidean distances on the host, axis by axis (Saito & Toriwaki 1994), by a zigzag search or by envelopes (Felzenszwalb &
 * Huttenlocher 2012): planes, then columns, in the narrowest lanes that hold the squares.
 *
 * 16 bits hold distances below 176. Larger grids try them, too, because few sets leave such gaps: a distance that does not fit is noticed,
 * and the field is computed anew in 32 bits. 32 bits hold diagonals below 46339. Larger grids take 64.
 *
 * STRATUS_FIELD_EXACT chooses between zigzag and envelopes. In 16 bits it always takes the zigzag, which needs at most 176 steps for a
 * vector and was always cheaper. In wider lanes each line (or tile of columns) searches 8 samples. Where these take more than
 * FIELD_STEPS_A_LANE steps for each lane on average, envelopes are cheaper. */
#include "clones.h"
#include "distance_field.h"

#include <omp.h>
#include <string.h>

#if HAVE_CLONES
#include <immintrin.h>
#endif

#define FIELD_FAR_LINE_16 176
#define FIELD_FAR_LINE_32 46339
#define FIELD_FAR_LINE_64 (1 << 30)
/* Vectors in a tile of columns: the tile fits the second-level cache, one of its vectors the first. */
#define FIELD_TILE_VECTORS 4
#define FIELD_SAMPLES 8
#define FIELD_STEPS_A_LANE 12 /* measured: so many steps of a vector for each lane cost as much as an envelope */

/* A parabola of an envelope. Its minimum is `height` at `at`, and it is the lowest parabola from `start` on. */
typedef struct field_hull {
  int64_t at, height, start;
} field_hull;

/* First and last place along a line that holds a target. */
typedef struct field_range {
  int64_t first, last;
} field_range;

typedef struct field_work {
  int64_t n[3], words;
  const uint64_t* bits;
  stratus_field_method method;
  int is_signed;
  void* values;
  uint8_t* planes;      /* by plane: bit 0: some voxel is effective, bit 1: some voxel is not */
  field_range range[2]; /* planes that hold an effective voxel, and planes that hold another */
  int far;              /* 1: some distance does not fit a lane */
} field_work;

typedef struct field_passes {
  int bytes;
  int64_t columns_at_once;
  size_t (*room_bytes)(const field_work* w);
  void (*plane)(const field_work* w, unsigned char* room, int64_t k);
  void (*columns)(field_work* w, unsigned char* room, int64_t first);
} field_passes;

static void stratus_field_is_far(field_work* w)
{
#pragma omp atomic write
  w->far = 1;
}

static int is_far(const field_work* w)
{
  int far;
#pragma omp atomic read
  far = w->far;
  return far;
}

#define FIELD_BITS 16
#define FIELD_ISA 0
#include "distance_field_body.h"
#define FIELD_BITS 32
#define FIELD_ISA 0
#include "distance_field_body.h"
#define FIELD_BITS 64
#define FIELD_ISA 0
#include "distance_field_body.h"
#if HAVE_CLONES
#define FIELD_BITS 16
#define FIELD_ISA 1
#include "distance_field_body.h"
#define FIELD_BITS 32
#define FIELD_ISA 1
#include "distance_field_body.h"
#define FIELD_BITS 16
#define FIELD_ISA 2
#include "distance_field_body.h"
#define FIELD_BITS 32
#define FIELD_ISA 2
#include "distance_field_body.h"
#endif

static const field_passes* choose_passes(const stratus_context* context, int bits)
{
#if HAVE_CLONES
  if (bits < 64 && context->isa >= 2) {
    return bits == 16 ? &passes_16_2 : &passes_32_2;
  }
  if (bits < 64 && context->isa >= 1) {
    return bits == 16 ? &passes_16_1 : &passes_32_1;
  }
#endif
  (void)context;
  return bits == 16 ? &passes_16_0 : bits == 32 ? &passes_32_0 : &passes_64_0;
}

/* Squared length of the grid's diagonal, which no distance exceeds. */
static int64_t diagonal(const int64_t n[3])
{
  int64_t sum = 0;
  for (int a = 0; a < 3; ++a) {
    sum += (n[a] - 1) * (n[a] - 1);
  }
  return sum;
}

int stratus_field_is_wide(const int64_t n[3])
{
  return diagonal(n) >= (int64_t)FIELD_FAR_LINE_32 * FIELD_FAR_LINE_32;
}

/* Squared distance from the box of effective voxels to the farthest corner of the grid. Some distance is at least as long. */
static int64_t farthest_corner(const stratus_voxels* voxels)
{
  int64_t sum = 0;
  for (int a = 0; a < 3; ++a) {
    const int64_t below = voxels->lo[a], above = voxels->dimensions[a] - voxels->hi[a], gap = below > above ? below : above;
    sum += gap * gap;
  }
  return sum;
}

static void find_range(field_work* w)
{
  for (int kind = 0; kind < 2; ++kind) {
    int64_t first = 0, last = w->n[2] - 1;
    while (first < last && !(w->planes[first] >> kind & 1)) {
      ++first;
    }
    while (last > first && !(w->planes[last] >> kind & 1)) {
      --last;
    }
    w->range[kind] = (field_range){ first, last };
  }
}

static void run_passes(const stratus_context* context, const field_passes* passes, field_work* w, unsigned char* rooms, size_t room)
{
  const int64_t plane = w->n[0] * w->n[1], at_once = passes->columns_at_once, chunks = (plane + at_once - 1) / at_once;
#pragma omp parallel num_threads(context->threads)
  {
    unsigned char* mine = rooms + (size_t)omp_get_thread_num() * room;
#pragma omp for schedule(dynamic, 1)
    for (int64_t k = 0; k < w->n[2]; ++k) {
      passes->plane(w, mine, k);
    }
#pragma omp single
    find_range(w);
#pragma omp for schedule(dynamic, 4)
    for (int64_t chunk = 0; chunk < chunks; ++chunk) {
      if (!is_far(w)) {
        passes->columns(w, mine, chunk * at_once);
      }
    }
  }
}

static stratus_status run_width(stratus_context* context, const field_passes* passes, field_work* w, stratus_field* field)
{
  stratus_status status = STRATUS_OK;
  void *values = NULL, *rooms = NULL, *planes = NULL;
  size_t count;
  const size_t room = passes->room_bytes(w);

  TRY(stratus_product(context, "distance field", (size_t)w->n[0], (size_t)w->n[1], (size_t)w->n[2], &count));
  TRY_CLEANUP(stratus_allocate(context, count, (size_t)passes->bytes, &values));
  TRY_CLEANUP(stratus_allocate(context, (size_t)context->threads, room, &rooms));
  TRY_CLEANUP(stratus_allocate(context, (size_t)w->n[2], 1, &planes));
  w->values = values;
  w->planes = planes;
  w->far = 0;
  run_passes(context, passes, w, rooms, room);
  if (!w->far) {
    field->values = values;
    field->bytes = passes->bytes;
    values = NULL;
  }

cleanup:
  stratus_release(context, values);
  stratus_release(context, rooms);
  stratus_release(context, planes);
  return status;
}

stratus_status stratus_field_exact(stratus_context* context, const stratus_voxels* voxels, const stratus_bits* set, stratus_field* field)
{
  field_work w = { .words = set->words, .bits = set->bits, .method = field->method, .is_signed = field->is_signed };
  memcpy(w.n, set->n, sizeof w.n);
  const int64_t longest = diagonal(w.n), most_16 = (int64_t)FIELD_FAR_LINE_16 * FIELD_FAR_LINE_16;
  if (longest < most_16 || farthest_corner(voxels) < most_16) {
    TRY(run_width(context, choose_passes(context, 16), &w, field));
    if (!w.far) {
      return STRATUS_OK;
    }
    stratus_log(context, STRATUS_LOG_DEBUG, "distance field: distances of %d and more, once again with 32 bits", FIELD_FAR_LINE_16);
  }
  return run_width(context, choose_passes(context, stratus_field_is_wide(w.n) ? 64 : 32), &w, field);
}
