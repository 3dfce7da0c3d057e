/* SPDX-License-Identifier: BSD-3-Clause
 * Jump flooding (Rong & Tan 2006), and the adaptive jump flooding (AJFA) of Guo et al. 2025: the choice of steps, and the record of their
 * effect. A pass reads one array and writes another, so that no order shows.
 *
 * The steps of JFA are n/2, n/4 .. 1, rounded up. They add up to at least n - 1, and no step is more than twice the next, so that every
 * offset is a sum of them and no voxel stays unfilled. The steps of the paper's figure 5 fall by more, from 48 to 15 and from 10 to 3: on a
 * line of 128 a voxel at 42 never reaches 16 of the places.
 *
 * The paper gives AJFA's rule without a threshold: the step falls more slowly after a good pass, faster after a poor one. Here a pass is
 * good if it shortened the distance by GOOD on average over all voxels that search, E1 (1 - E2). The next step is then 3/4 of this one,
 * else 1/2, never less. Passes of step 1 are repeated while more than AGAIN of the voxels come nearer. */
#include "device.h"
#include "jump_flooding_passes.h"

#include <string.h>

#define GOOD 0.05
#define AGAIN 0.0005
#define AGAIN_MAX 4 /* greatest number of passes of step 1 */
#define PASSES_MAX 128

typedef struct flood_plan {
  stratus_field_method method;
  int first;
  int count; /* number of passes; AJFA: so far */
  int steps[PASSES_MAX];
} flood_plan;

static void add_step(flood_plan* plan, int64_t step)
{
  if (plan->count < PASSES_MAX) {
    plan->steps[plan->count++] = (int)step;
  }
}

static void add_halves(flood_plan* plan)
{
  int step = plan->first;
  for (; step > 1; step = (step + 1) / 2) {
    add_step(plan, step);
  }
  add_step(plan, 1);
}

/* Adds the list of figure 5, whose grid began at 64, scaled to begin at plan->first. */
static void add_figure_5(flood_plan* plan)
{
  static const int printed[] = { 64, 48, 15, 10, 3, 1 };
  for (int i = 0; i < 6; ++i) {
    const int64_t scaled = ((int64_t)printed[i] * plan->first + 32) / 64, step = i == 5 || scaled < 1 ? 1 : scaled;
    if (i == 0 || step != plan->steps[plan->count - 1]) {
      add_step(plan, step);
    }
  }
}

static flood_plan make_plan(const int64_t n[3], const stratus_field_options* options)
{
  flood_plan plan = { .method = options->method };
  int64_t longest = n[0] > n[1] ? n[0] : n[1];
  longest = n[2] > longest ? n[2] : longest;
  plan.first = (int)((longest + 1) / 2);
  plan.first = options->first_step > 0 && options->first_step < plan.first ? options->first_step : plan.first;
  switch (plan.method) {
    case STRATUS_FIELD_AJFA:
      add_step(&plan, plan.first);
      break;
    case STRATUS_FIELD_AJFA_FIG5:
      add_figure_5(&plan);
      break;
    case STRATUS_FIELD_JFA_SQUARED:
      add_halves(&plan);
      add_halves(&plan);
      break;
    case STRATUS_FIELD_1_JFA:
      add_step(&plan, 1);
      add_halves(&plan);
      break;
    default:
      add_halves(&plan);
      if (plan.method == STRATUS_FIELD_JFA_2) {
        add_step(&plan, 2);
      }
      if (plan.method != STRATUS_FIELD_JFA) {
        add_step(&plan, 1);
      }
  }
  return plan;
}

/* Adds AJFA's next step, which depends on the effect of the last pass. */
static void adapt(flood_plan* plan, double e1, double e2)
{
  const int step = plan->steps[plan->count - 1];
  if (step > 1) {
    const int slow = (3 * step + 3) / 4, fast = (step + 1) / 2;
    add_step(plan, e1 * (1.0 - e2) >= GOOD && slow < step ? slow : fast);
  } else if (e1 > AGAIN && (plan->count < AGAIN_MAX || plan->steps[plan->count - AGAIN_MAX] > 1)) {
    add_step(plan, 1);
  }
}

/* ---- one flooding */

typedef struct flooding {
  int64_t n[3];
  int64_t searched; /* number of voxels that search, which are all that are not sought */
  int wide;
  uint32_t *from, *to; /* after each pass the result is in from */
  unsigned char* rooms;
  flood_device* device; /* NULL if the host floods */
} flooding;

/* Seeds from[]: each voxel of occupancy `sought` is its own nearest. */
static void seed(const stratus_context* context, const stratus_bits* set, int sought, flooding* f)
{
  const flood_layout layout = flood_shifts(f->n);
  const int64_t nx = f->n[0], rows = f->n[1] * f->n[2];
  int64_t searched = 0;
#pragma omp parallel for schedule(static) num_threads(context->threads) reduction(+ : searched)
  for (int64_t row = 0; row < rows; ++row) {
    const int64_t j = row % f->n[1], k = row / f->n[1];
    for (int64_t i = 0; i < nx; ++i) {
      const int is_sought = stratus_bits_get(set, i, j, k) == sought;
      f->from[row * nx + i] = is_sought ? flood_pack(layout, i, j, k) : FLOOD_UNKNOWN;
      searched += !is_sought;
    }
  }
  f->searched = searched;
}

static stratus_status run_pass(stratus_context* context, flooding* f, int step, flood_count* count)
{
  if (f->device) {
    return stratus_flood_device_pass(context, f->device, step, count);
  }
  stratus_flood_pass(context, f->n, step, f->wide, f->from, f->to, f->rooms, count);
  uint32_t* swap = f->from;
  f->from = f->to;
  f->to = swap;
  return STRATUS_OK;
}

static void add_pass(stratus_field_report* report, int step, const flood_count* count, double e1, double e2)
{
  const int most = (int)(sizeof report->steps / sizeof *report->steps);
  if (report->passes < most) {
    report->steps[report->passes] = step;
    report->e1[report->passes] = e1;
    report->e2[report->passes] = e2;
  }
  ++report->passes;
  report->updated += count->updated;
}

static stratus_status run_plan(stratus_context* context, flooding* f, flood_plan plan, stratus_field_report* report)
{
  for (int pass = 0; pass < plan.count; ++pass) {
    flood_count count;
    TRY(run_pass(context, f, plan.steps[pass], &count));
    const double updated = (double)count.updated;
    const double e1 = f->searched > 0 ? updated / (double)f->searched : 0.0;
    const double e2 = count.updated > 0 ? (double)count.ratios / (double)FLOOD_RATIO_ONE / updated : 1.0;
    add_pass(report, plan.steps[pass], &count, e1, e2);
    if (plan.method == STRATUS_FIELD_AJFA) {
      adapt(&plan, e1, e2);
    }
    TRY(stratus_progress(context, "jump flooding", (pass + 1.0) / (plan.count + 1.0)));
  }
  return STRATUS_OK;
}

/* Floods for the nearest voxels of occupancy `sought`. The caller releases *nearest. */
static stratus_status flood_at(stratus_context* context, const stratus_bits* set, int sought, const stratus_field_options* options,
  uint32_t** nearest, stratus_field_report* report, bool on_device)
{
  stratus_status status = STRATUS_OK;
  flooding f = { .wide = 0 };
  void* memory = NULL;
  const size_t count = (size_t)(set->n[0] * set->n[1] * set->n[2]);
  int64_t diagonal = 0;
  memcpy(f.n, set->n, sizeof f.n);
  for (int a = 0; a < 3; ++a) {
    diagonal += f.n[a] * f.n[a];
  }
  f.wide = diagonal > INT32_MAX;

  TRY_CLEANUP(stratus_allocate(context, count, sizeof(uint32_t), &memory));
  f.from = memory;
  seed(context, set, sought, &f);
  if (on_device) {
    TRY_CLEANUP(stratus_flood_device_create(context, f.n, f.wide, f.from, &f.device));
  } else {
    TRY_CLEANUP(stratus_allocate(context, count, sizeof(uint32_t), &memory));
    f.to = memory;
    TRY_CLEANUP(stratus_allocate(context, (size_t)context->threads, stratus_flood_room_bytes(f.n), &memory));
    f.rooms = memory;
  }
  TRY_CLEANUP(run_plan(context, &f, make_plan(f.n, options), report));
  if (f.device) {
    TRY_CLEANUP(stratus_flood_device_read(context, f.device, f.from));
  }
  *nearest = f.from;
  f.from = NULL;

cleanup:
  stratus_flood_device_destroy(context, f.device);
  stratus_release(context, f.from);
  stratus_release(context, f.to);
  stratus_release(context, f.rooms);
  return status;
}

static stratus_status flood(stratus_context* context, const stratus_bits* set, int sought, const stratus_field_options* options,
  uint32_t** nearest, stratus_field_report* report)
{
  const stratus_field_report before = *report;
  if (stratus_field_on_device(context, set->n, sizeof(uint32_t))) {
    const stratus_status status = flood_at(context, set, sought, options, nearest, report, true);
    if (!stratus_device_hands_back(context, status)) {
      return status;
    }
    *report = before;
  }
  return flood_at(context, set, sought, options, nearest, report, false);
}

/* Effective voxels take the result of the flooding for the other voxels. */
static void merge(const stratus_context* context, const stratus_bits* set, const uint32_t* inner, uint32_t* nearest)
{
  const int64_t nx = set->n[0], rows = set->n[1] * set->n[2];
#pragma omp parallel for schedule(static) num_threads(context->threads)
  for (int64_t row = 0; row < rows; ++row) {
    for (int64_t i = 0; i < nx; ++i) {
      if (stratus_bits_get(set, i, row % set->n[1], row / set->n[1])) {
        nearest[row * nx + i] = inner[row * nx + i];
      }
    }
  }
}

stratus_status stratus_flood(stratus_context* context, const stratus_bits* set, const stratus_field_options* options, stratus_field* field,
  stratus_field_report* report)
{
  const flood_layout layout = flood_shifts(set->n);
  if (layout.bits > FLOOD_BITS) {
    return stratus_fail(context, STRATUS_OVERFLOW, "a flooding names voxels in %d bits; %lld x %lld x %lld take %d", FLOOD_BITS,
      (long long)set->n[0], (long long)set->n[1], (long long)set->n[2], layout.bits);
  }
  TRY(flood(context, set, 1, options, &field->nearest, report));
  if (field->is_signed) {
    uint32_t* inner = NULL;
    TRY(flood(context, set, 0, options, &inner, report));
    merge(context, set, inner, field->nearest);
    stratus_release(context, inner);
  }
  return STRATUS_OK;
}
