/* SPDX-License-Identifier: BSD-3-Clause
 * Effective voxels of lists and volumes, their density, and distance fields by all methods, compared with loops over all voxels. */
#include "fuzz.h"

#include <stdlib.h>

#define LIST_MOST 400

typedef struct voxel_set {
  stratus_voxels* voxels;
  int64_t n[3], count;
  uint8_t* is; /* one byte for each voxel */
} voxel_set;

static int64_t size_of(const voxel_set* s)
{
  return s->n[0] * s->n[1] * s->n[2];
}

static void check_set(fuzz* f, voxel_set* s)
{
  int64_t lo[3], hi[3], count = 0, tight_lo[3] = { INT64_MAX, INT64_MAX, INT64_MAX }, tight_hi[3] = { 0, 0, 0 };
  CALL(stratus_voxels_dimensions(s->voxels, s->n));
  CALL(stratus_voxels_bounds(s->voxels, lo, hi));
  s->count = CALL(stratus_voxels_count(s->voxels));
  s->is = calloc((size_t)size_of(s) + 1, 1);
  for (int64_t q = 0; s->is && q < size_of(s); ++q) {
    const int64_t at[3] = { q % s->n[0], q / s->n[0] % s->n[1], q / (s->n[0] * s->n[1]) };
    s->is[q] = stratus_voxels_get(s->voxels, at[0], at[1], at[2]) != 0;
    for (int axis = 0; s->is[q] && axis < 3; ++axis) {
      tight_lo[axis] = at[axis] < tight_lo[axis] ? at[axis] : tight_lo[axis];
      tight_hi[axis] = at[axis] + 1 > tight_hi[axis] ? at[axis] + 1 : tight_hi[axis];
    }
    count += s->is[q];
  }
  EXPECT(s->count == count, "%lld voxels, got %lld", (long long)count, (long long)s->count);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT(lo[axis] == (count ? tight_lo[axis] : 0) && hi[axis] == tight_hi[axis], "bounds %lld..%lld, got %lld..%lld",
      (long long)tight_lo[axis], (long long)tight_hi[axis], (long long)lo[axis], (long long)hi[axis]);
  }
  EXPECT(CALL(stratus_voxels_get(s->voxels, fuzz_odd_integer(f) | INT64_MIN, 0, 0)) == 0, "a voxel beyond the dimensions");
  EXPECT(CALL(stratus_voxels_get(s->voxels, 0, s->n[1] + (int64_t)fuzz_below(f, 9), 0)) == 0, "a voxel beyond the dimensions");
  EXPECT(CALL(stratus_voxels_get(s->voxels, 0, 0, INT64_MAX)) == 0, "a voxel beyond the dimensions");
  ++f->tally->compared;
}

static stratus_status make_list(fuzz* f, voxel_set* s, int largest)
{
  static const int64_t wrong[] = { 0, -1, INT64_MIN, INT64_MAX, ((int64_t)1 << 18) + 1, (int64_t)1 << 31, (int64_t)1 << 40 };
  int32_t positions[3 * LIST_MOST];
  int64_t n[3];
  size_t count = fuzz_chance(f, 0.1) ? 0 : fuzz_below(f, LIST_MOST);
  const bool clusters = fuzz_chance(f, 0.4);
  for (int axis = 0; axis < 3; ++axis) {
    n[axis] = fuzz_chance(f, 0.1) ? 1 : 1 + (int64_t)fuzz_below(f, (uint64_t)largest);
  }
  for (size_t i = 0; i < 3 * count; ++i) {
    const int64_t most = n[i % 3] - 1, far = clusters && i >= 3 ? positions[i - 3] + (int64_t)fuzz_below(f, 3) - 1 : -1;
    positions[i] = (int32_t)(far >= 0 && far <= most ? far : (int64_t)fuzz_below(f, (uint64_t)most + 1));
    positions[i] = fuzz_odd(f) ? (int32_t)(uint32_t)(uint64_t)fuzz_odd_integer(f) : positions[i];
  }
  for (int axis = 0; axis < 3; ++axis) {
    n[axis] = fuzz_odd(f) ? wrong[fuzz_below(f, 7)] : n[axis];
  }
  const int32_t* list = fuzz_pointer(f, fuzz_input(f, positions, 3 * count * sizeof *positions));
  count = fuzz_odd(f) ? SIZE_MAX / (1 + (size_t)fuzz_below(f, 3)) : count;
  const int64_t* dimensions = fuzz_pointer(f, FUZZ_INPUT(f, n));
  return CREATE(&s->voxels, stratus_voxels_create_list(f->context, dimensions, list, count, &s->voxels));
}

/* Compares the set with the values that a criterion without transfer function takes, for types that floats hold. */
static void check_against_values(fuzz* f, const voxel_set* s, const stratus_volume* v, const stratus_criterion* criterion)
{
  if (v->point_ghosts || v->cell_ghosts || criterion->transfer) {
    return;
  }
  for (int64_t q = 0; q < size_of(s); ++q) {
    const double value = fuzz_value_of(v, (size_t)q);
    const bool meets = isfinite(value) && value >= criterion->lower && value <= criterion->upper;
    EXPECT(meets == s->is[q], "voxel %lld of value %.17g is %d for %.17g..%.17g", (long long)q, value, s->is[q], criterion->lower,
      criterion->upper);
  }
  ++f->tally->compared;
}

static stratus_status make_of_volume(fuzz* f, voxel_set* s, int largest)
{
  const fuzz_field field = fuzz_volume(f, largest, 1);
  stratus_criterion criterion = CALL(stratus_criterion_default());
  const stratus_volume* volume = fuzz_pointer(f, FUZZ_INPUT(f, field.view));
  if (fuzz_chance(f, 0.5)) {
    criterion.transfer = fuzz_transfers(f, 1, field.low, field.high, field.edge);
  } else {
    criterion.lower = fuzz_chance(f, 0.3) ? -INFINITY : fuzz_real(f, field.low, field.high);
    criterion.upper = fuzz_chance(f, 0.3) ? INFINITY : fuzz_real(f, fmax(field.low, criterion.lower), field.high);
  }
  const stratus_criterion* asked = fuzz_pointer(f, FUZZ_INPUT(f, criterion));
  if (fuzz_chance(f, 0.4)) {
    const stratus_status status = CREATE(&s->voxels, stratus_voxels_create_cells(f->context, volume, asked, &s->voxels));
    EXPECT(status == STRATUS_OK || !fuzz_is_tame(f), "%s", stratus_context_message(f->context));
    if (status == STRATUS_OK) {
      check_set(f, s);
    }
    return status;
  }
  const stratus_status status = CREATE(&s->voxels, stratus_voxels_create(f->context, volume, asked, &s->voxels));
  EXPECT(status == STRATUS_OK || !fuzz_is_tame(f), "%s", stratus_context_message(f->context));
  if (status == STRATUS_OK) {
    check_set(f, s);
    check_against_values(f, s, &field.view, &criterion);
  }
  return status;
}

/* ---- queries */

static void ask_density(fuzz* f, const voxel_set* s)
{
  double bandwidth = NAN, raw = NAN, density = NAN, point[3], *first = fuzz_output(f, 3 * sizeof(double));
  double* second = fuzz_chance(f, 0.5) ? fuzz_output(f, 3 * sizeof(double)) : NULL;
  stratus_status status = STATUS(stratus_density_bandwidth(f->context, s->voxels, &bandwidth, fuzz_chance(f, 0.5) ? &raw : NULL));
  EXPECT(status == STRATUS_OK && bandwidth >= 1.0 && isfinite(bandwidth), "bandwidth %g", bandwidth);
  for (int times = 0; times < 4; ++times) {
    for (int axis = 0; axis < 3; ++axis) {
      point[axis] = fuzz_real(f, -2.0, (double)s->n[axis] + 2.0);
    }
    const double h = fuzz_chance(f, 0.5) ? bandwidth : fuzz_real(f, 0.5, 20.0);
    status = STATUS(stratus_density_at(f->context, s->voxels, h, FUZZ_INPUT(f, point), &density, times ? first : NULL, second));
    EXPECT(status == STRATUS_OK || !fuzz_is_tame(f), "%s", stratus_context_message(f->context));
    if (status == STRATUS_OK) {
      EXPECT(density >= 0.0 && isfinite(density), "density %g at bandwidth %g", density, h);
      EXPECT(!times || (isfinite(first[0]) && isfinite(first[1]) && isfinite(first[2])), "slope %g %g %g", first[0], first[1], first[2]);
    }
  }
}

/* Squared distance to the nearest voxel that is `wanted`, or -1 if there is none. */
static int64_t nearest(const voxel_set* s, int64_t q, int wanted)
{
  const int64_t at[3] = { q % s->n[0], q / s->n[0] % s->n[1], q / (s->n[0] * s->n[1]) };
  int64_t best = -1;
  for (int64_t p = 0; p < size_of(s); ++p) {
    if (s->is[p] == wanted) {
      const int64_t x = p % s->n[0] - at[0], y = p / s->n[0] % s->n[1] - at[1], z = p / (s->n[0] * s->n[1]) - at[2];
      const int64_t square = x * x + y * y + z * z;
      best = best < 0 || square < best ? square : best;
    }
  }
  return best;
}

static void check_distance(fuzz* f, const voxel_set* s, const stratus_field_options* o, int64_t q, double result)
{
  const bool inside = o->is_signed && s->is[q];
  const int64_t square = nearest(s, q, inside ? 0 : 1);
  const double truth = square < 0 ? INFINITY : sqrt((double)square);
  const double positive = inside ? -result : result;
  const bool exact = o->method <= STRATUS_FIELD_ENVELOPE;
  EXPECT(exact ? fabs(positive - truth) <= 1e-6 * truth || positive == truth : positive >= truth * (1.0 - 1e-6),
    "method %d, signed %d, voxel %lld: distance %.9g, got %.9g", (int)o->method, o->is_signed, (long long)q, inside ? -truth : truth,
    result);
}

static void ask_field(fuzz* f, const voxel_set* s)
{
  stratus_field_options o = CALL(stratus_field_options_default());
  stratus_field* field = NULL;
  o.method = (stratus_field_method)fuzz_choice(f, STRATUS_FIELD_AJFA_FIG5 + 1);
  o.is_signed = fuzz_flag(f);
  o.first_step = fuzz_chance(f, 0.6) ? 0 : fuzz_integer(f, 1, 40);
  stratus_field_report* report = fuzz_chance(f, 0.5) ? fuzz_output(f, sizeof *report) : NULL;
  const stratus_field_options* given = fuzz_pointer(f, FUZZ_INPUT(f, o));
  if (fuzz_chance(f, 0.15)) {
    fuzz_trouble(f);
  }
  const stratus_status status = CREATE(&field, stratus_field_create(f->context, s->voxels, given, &field, report));
  const bool troubled = f->memory.refused + f->progress.cancelled > 0;
  fuzz_calm(f);
  EXPECT(status == STRATUS_OK || troubled || !fuzz_is_tame(f), "%s", stratus_context_message(f->context));
  if (status != STRATUS_OK) {
    return;
  }
  o = given ? o : stratus_field_options_default();
  const size_t voxels = (size_t)size_of(s);
  float *distances = fuzz_output(f, voxels * sizeof *distances), *rgba = fuzz_output(f, 4 * voxels * sizeof *rgba);
  CALL(stratus_field_distances(field, distances));
  EXPECT(CALL(stratus_field_get(field, 0, s->n[1], 0)) == INFINITY && CALL(stratus_field_get(field, INT64_MIN, 0, 0)) == INFINITY,
    "a distance beyond the dimensions");
  const stratus_status named = STATUS(stratus_field_rgba(field, s->voxels, rgba));
  EXPECT(named == STRATUS_OK, "%s", stratus_context_message(f->context));
  for (int64_t q = 0; q < size_of(s); ++q) {
    const double result = stratus_field_get(field, q % s->n[0], q / s->n[0] % s->n[1], q / (s->n[0] * s->n[1]));
    const float *p = rgba + 4 * q, nowhere[4] = { -1.0f, -1.0f, -1.0f, INFINITY };
    EXPECT((float)result == distances[q], "voxel %lld: %g and %g", (long long)q, result, (double)distances[q]);
    EXPECT(isinf(result) ? p[0] == -1.0f : p[3] == (float)result, "voxel %lld: %g and %g", (long long)q, result, (double)p[3]);
    EXPECT(p[0] == nowhere[0] || (p[0] >= 0.0f && p[0] < (float)s->n[0] && p[2] >= 0.0f && p[2] < (float)s->n[2]), "nearest at %g",
      (double)p[0]);
    if (q % 7 == 0 || voxels < 200) {
      check_distance(f, s, &o, q, result);
    }
  }
  ++f->tally->compared;
  CALL(stratus_field_destroy(field));
}

void fuzz_voxels(fuzz* f)
{
  voxel_set s = { .voxels = NULL };
  stratus_status status;
  if (fuzz_chance(f, 0.6)) {
    status = make_list(f, &s, fuzz_chance(f, 0.3) ? 20 : 9);
    EXPECT(status == STRATUS_OK || !fuzz_is_tame(f), "%s", stratus_context_message(f->context));
    if (status == STRATUS_OK) {
      check_set(f, &s);
    }
  } else {
    status = make_of_volume(f, &s, 10);
  }
  if (status == STRATUS_OK) {
    ask_density(f, &s);
    ask_field(f, &s);
    ask_field(f, &s);
  }
  CALL(stratus_voxels_destroy(s.voxels));
  free(s.is);
}
