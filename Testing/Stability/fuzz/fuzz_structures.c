/* SPDX-License-Identifier: BSD-3-Clause
 * Value ranges, occupancy and distance maps of volumes, compared with loops over all blocks. */
#include "fuzz.h"

#include <stdlib.h>

#define FARTHEST 127
#define FARTHEST_PAPER 255

typedef struct grid {
  int64_t n[3];
  int size;
} grid;

static int64_t blocks_of(const grid* g)
{
  return g->n[0] * g->n[1] * g->n[2];
}

/* Bound on the error of a float that stands for a double, from which an offset is subtracted and to which it is added again. */
static double slack(double low, double high)
{
  return 1e-6 * fmax(fabs(low), fabs(high)) + 1e-37;
}

static void check_block(fuzz* f, const fuzz_field* field, const stratus_value_range* ranges, const grid* g, int64_t block)
{
  const int64_t at[3] = { block % g->n[0], block / g->n[0] % g->n[1], block / (g->n[0] * g->n[1]) };
  const stratus_volume* v = &field->view;
  double low, high, least = INFINITY, most = -INFINITY;
  int gaps = -1, broken = 0;
  CALL(stratus_value_range_block(ranges, at[0], at[1], at[2], &low, &high, &gaps));
  for (int64_t k = at[2] * g->size; k <= (at[2] + 1) * g->size && k < v->dimensions[2]; ++k) {
    for (int64_t j = at[1] * g->size; j <= (at[1] + 1) * g->size && j < v->dimensions[1]; ++j) {
      for (int64_t i = at[0] * g->size; i <= (at[0] + 1) * g->size && i < v->dimensions[0]; ++i) {
        const double value = fuzz_value_of(v, (size_t)((k * v->dimensions[1] + j) * v->dimensions[0] + i));
        broken |= !isfinite(value) || (v->type == STRATUS_FLOAT64 && fabs(value) > 3e38);
        least = isfinite(value) ? fmin(least, value) : least;
        most = isfinite(value) ? fmax(most, value) : most;
      }
    }
  }
  EXPECT(gaps == 0 || gaps == 1, "gaps %d", gaps);
  if (broken) {
    EXPECT(gaps == 1, "block %lld has a value that is not finite, and no gap", (long long)block);
  } else {
    const double allowed = slack(least, most);
    EXPECT(fabs(low - least) <= allowed && fabs(high - most) <= allowed, "block %lld is %.17g..%.17g, got %.17g..%.17g", (long long)block,
      least, most, low, high);
  }
}

static stratus_value_range* make_ranges(fuzz* f, const fuzz_field* field, grid* g)
{
  static const int sizes[] = { 0, 2, 4, 8, 16, 32 };
  const int wanted = fuzz_odd(f) ? fuzz_integer(f, -4, 64) : sizes[fuzz_below(f, 6)];
  stratus_value_range* ranges = NULL;
  stratus_value_range** out = fuzz_odd(f) ? NULL : &ranges;
  const stratus_volume* volume = fuzz_pointer(f, FUZZ_INPUT(f, field->view));
  if (CREATE(out, stratus_value_range_create(f->context, volume, wanted, out)) != STRATUS_OK) {
    return NULL;
  }
  CALL(stratus_value_range_blocks(ranges, g->n, &g->size));
  CALL(stratus_value_range_blocks(ranges, NULL, NULL));
  EXPECT(g->size == (wanted ? wanted : 4), "blocks of %d instead of %d", g->size, wanted);
  double low = NAN, high = NAN;
  const stratus_status whole = STATUS(stratus_value_range_whole(ranges, &low, &high));
  EXPECT(
    whole == STRATUS_OK ? low <= high && isfinite(low) && isfinite(high) : isnan(low) && isnan(high), "the whole is %g..%g", low, high);
  for (int64_t block = 0; block < blocks_of(g); ++block) {
    check_block(f, field, ranges, g, block);
  }
  ++f->tally->compared;
  return ranges;
}

/* Queries a block outside the grid: its range must be empty, and it must not be occupied. */
static void ask_beyond(fuzz* f, const stratus_value_range* ranges, const stratus_occupancy* occupancy, const grid* g)
{
  int64_t at[3];
  double low = 0.0, high = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    at[axis] = (int64_t)fuzz_below(f, (uint64_t)g->n[axis]);
  }
  const int axis = (int)fuzz_below(f, 3);
  const int64_t far = fuzz_odd_integer(f);
  at[axis] = far >= 0 && far < g->n[axis] ? g->n[axis] : far;
  CALL(stratus_value_range_block(ranges, at[0], at[1], at[2], &low, &high, fuzz_chance(f, 0.5) ? NULL : &(int){ 0 }));
  EXPECT(low > high, "block %lld of %lld is %g..%g", (long long)at[axis], (long long)g->n[axis], low, high);
  EXPECT(CALL(stratus_occupancy_get(occupancy, at[0], at[1], at[2])) == 0, "block %lld of %lld is occupied", (long long)at[axis],
    (long long)g->n[axis]);
}

/* Occupied blocks, one byte each. The caller frees them. */
static uint8_t* check_occupancy(fuzz* f, const stratus_occupancy* occupancy, const grid* g)
{
  int64_t n[3], lo[3], hi[3], tight_lo[3] = { INT64_MAX, INT64_MAX, INT64_MAX }, tight_hi[3] = { 0, 0, 0 }, count = 0;
  int size = 0;
  CALL(stratus_occupancy_blocks(occupancy, n, &size));
  CALL(stratus_occupancy_bounds(occupancy, lo, hi));
  EXPECT(memcmp(n, g->n, sizeof n) == 0 && size == g->size, "occupancy has other blocks than its ranges");
  uint8_t* occupied = calloc((size_t)blocks_of(g) + 1, 1);
  for (int64_t b = 0; occupied && b < blocks_of(g); ++b) {
    const int64_t at[3] = { b % n[0], b / n[0] % n[1], b / (n[0] * n[1]) };
    const int is = CALL(stratus_occupancy_get(occupancy, at[0], at[1], at[2]));
    EXPECT(is == 0 || is == 1, "block %lld is %d", (long long)b, is);
    occupied[b] = (uint8_t)is;
    count += is;
    for (int axis = 0; is && axis < 3; ++axis) {
      tight_lo[axis] = at[axis] < tight_lo[axis] ? at[axis] : tight_lo[axis];
      tight_hi[axis] = at[axis] + 1 > tight_hi[axis] ? at[axis] + 1 : tight_hi[axis];
    }
  }
  EXPECT(CALL(stratus_occupancy_count(occupancy)) == count, "%lld blocks are occupied, the count is another", (long long)count);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT(lo[axis] == (count ? tight_lo[axis] : 0) && hi[axis] == tight_hi[axis], "occupied bounds %lld..%lld, got %lld..%lld",
      (long long)tight_lo[axis], (long long)tight_hi[axis], (long long)lo[axis], (long long)hi[axis]);
  }
  ++f->tally->compared;
  return occupied;
}

static int true_distance(const uint8_t* occupied, const grid* g, stratus_distance_kind kind, int octant, const int64_t from[3])
{
  int64_t nearest = kind == STRATUS_DISTANCE_PAPER ? FARTHEST_PAPER : FARTHEST;
  for (int64_t b = 0; b < blocks_of(g); ++b) {
    const int64_t at[3] = { b % g->n[0], b / g->n[0] % g->n[1], b / (g->n[0] * g->n[1]) };
    int64_t farthest = 0;
    bool ahead = true;
    for (int axis = 0; axis < 3; ++axis) {
      const int64_t way = at[axis] - from[axis];
      ahead = ahead && (kind != STRATUS_DISTANCE_OCTANT || (octant >> axis & 1 ? way >= 0 : way <= 0));
      farthest = llabs(way) > farthest ? llabs(way) : farthest;
    }
    nearest = occupied[b] && ahead && farthest < nearest ? farthest : nearest;
  }
  return kind == STRATUS_DISTANCE_BLOCK && nearest > 1 ? 1 : (int)nearest;
}

static void check_map(fuzz* f, const stratus_occupancy* occupancy, const uint8_t* occupied, const grid* g, stratus_distance_kind kind)
{
  stratus_distance_map* map = NULL;
  if (fuzz_chance(f, 0.1)) {
    fuzz_trouble(f);
  }
  const stratus_status status = CREATE(&map, stratus_distance_map_create(f->context, occupancy, kind, &map));
  const bool troubled = f->memory.refused + f->progress.cancelled > 0;
  fuzz_calm(f);
  EXPECT(status == STRATUS_OK || troubled || !fuzz_is_tame(f), "%s", stratus_context_message(f->context));
  if (status != STRATUS_OK) {
    return;
  }
  EXPECT(CALL(stratus_distance_map_get(map, (int)fuzz_below(f, 8), g->n[0], 0, 0)) == 0, "a distance beyond the blocks");
  EXPECT(CALL(stratus_distance_map_get(map, (int)fuzz_below(f, 8), 0, INT64_MIN, 0)) == 0, "a distance beyond the blocks");
  EXPECT(CALL(stratus_distance_map_bytes(map)) > 0, "a map of no bytes");
  for (int64_t b = 0; b < 8 * blocks_of(g); ++b) {
    const int64_t q = b / 8, at[3] = { q % g->n[0], q / g->n[0] % g->n[1], q / (g->n[0] * g->n[1]) };
    const int octant = (int)(b % 8), distance = CALL(stratus_distance_map_get(map, octant, at[0], at[1], at[2]));
    const int truth = true_distance(occupied, g, kind, octant, at);
    EXPECT(distance == truth, "kind %d, octant %d, block %lld: distance %d, got %d", (int)kind, octant, (long long)q, truth, distance);
  }
  ++f->tally->compared;
  CALL(stratus_distance_map_destroy(map));
}

/* Occupancy by values. For types that are fetched exactly, it must hold just the blocks whose values meet lower..upper. */
static stratus_occupancy* make_between(fuzz* f, const fuzz_field* field, const stratus_value_range* ranges, const grid* g)
{
  stratus_occupancy* occupancy = NULL;
  const double lower = fuzz_chance(f, 0.2) ? -INFINITY : fuzz_real(f, field->low, field->high);
  const double upper = fuzz_chance(f, 0.2) ? INFINITY : fuzz_chance(f, 0.3) ? lower : fuzz_real(f, fmax(field->low, lower), field->high);
  const stratus_status status = CREATE(&occupancy, stratus_occupancy_create_between(f->context, ranges, lower, upper, &occupancy));
  EXPECT(
    status == (lower <= upper ? STRATUS_OK : STRATUS_INVALID_ARGUMENT), "%g..%g: %s", lower, upper, stratus_context_message(f->context));
  const stratus_type type = field->view.type;
  const bool exact = type <= STRATUS_UINT16 || type == STRATUS_FLOAT32;
  for (int64_t b = 0; status == STRATUS_OK && b < blocks_of(g); ++b) {
    const int64_t at[3] = { b % g->n[0], b / g->n[0] % g->n[1], b / (g->n[0] * g->n[1]) };
    double low, high;
    stratus_value_range_block(ranges, at[0], at[1], at[2], &low, &high, NULL);
    const int wanted = low <= high && low <= upper && high >= lower;
    EXPECT(!exact || stratus_occupancy_get(occupancy, at[0], at[1], at[2]) == wanted, "block %lld of %.17g..%.17g is %d for %.17g..%.17g",
      (long long)b, low, high, !wanted, lower, upper);
  }
  return occupancy;
}

static stratus_occupancy* make_shown(fuzz* f, const fuzz_field* field, const stratus_value_range* ranges)
{
  stratus_occupancy* occupancy = NULL;
  const stratus_transfer* transfer = fuzz_transfers(f, 1, field->low, field->high, field->edge);
  const stratus_sampling sampling = (stratus_sampling)fuzz_choice(f, STRATUS_SAMPLING_PREINTEGRATED + 1);
  (void)STATUS(stratus_transfer_check(f->context, transfer));
  const stratus_status status = CREATE(&occupancy, stratus_occupancy_create(f->context, ranges, transfer, sampling, &occupancy));
  EXPECT(status == STRATUS_OK || !fuzz_is_tame(f), "%s", stratus_context_message(f->context));
  return occupancy;
}

void fuzz_structures(fuzz* f)
{
  const fuzz_field field = fuzz_volume(f, 12, fuzz_chance(f, 0.8) ? 1 : 2);
  grid g = { .size = 0 };
  (void)STATUS(stratus_volume_check(f->context, fuzz_pointer(f, FUZZ_INPUT(f, field.view))));
  stratus_value_range* ranges = make_ranges(f, &field, &g);
  for (int times = 0; ranges && times < 2; ++times) {
    stratus_occupancy* occupancy = fuzz_chance(f, 0.6) ? make_shown(f, &field, ranges) : make_between(f, &field, ranges, &g);
    if (occupancy) {
      ask_beyond(f, ranges, occupancy, &g);
      uint8_t* occupied = check_occupancy(f, occupancy, &g);
      check_map(f, occupancy, occupied, &g, (stratus_distance_kind)fuzz_choice(f, STRATUS_DISTANCE_OCTANT + 1));
      free(occupied);
      CALL(stratus_occupancy_destroy(occupancy));
    }
  }
  CALL(stratus_value_range_destroy(ranges));
}
