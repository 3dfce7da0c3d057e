/* SPDX-License-Identifier: BSD-3-Clause
 * The density by which a tree splits a set of bricks (Guo et al. 2025, eq. 5): one number for each voxel or for each brick, and its peak.
 *
 * Over bricks, the voxels of a brick count as if they were spread evenly over its 64 places, and the density is computed at a brick's
 * middle. This is exact for full bricks. Otherwise the density errs by at most the sum over the bricks in reach of count * min(1, 4.72 /
 * bandwidth). The unit is a voxel's contribution at its own place: the kernel falls by at most 8 / (3 sqrt 3) = 1.54 per bandwidth, and
 * 3.065 voxels is the mean distance to a brick's 64 places from its corner voxel, the worst case. density_cells.c sums bandwidths beyond 30
 * voxels. */
#include "density.h"
#include "volume_device.h"
#include "device.h"
#include "density_plan.h"

#include <float.h>

static stratus_status number_voxels(stratus_context* context, const stratus_brick* bricks, int64_t count, stratus_density* density)
{
  void* memory;
  TRY(stratus_allocate(context, (size_t)count + 1, sizeof *density->start, &memory));
  density->start = memory;
  density->start[0] = 0;
  for (int64_t b = 0; b < count; ++b) {
    density->start[b + 1] = density->start[b] + bricks[b].count;
  }
  return STRATUS_OK;
}

/* Chooses how to compute the sums: on the device if the context builds there and the set fits; else by rows if few bricks are in reach;
 * else by cells. */
static stratus_status sum_weights(
  stratus_context* context, const stratus_brick* bricks, int64_t count, const stratus_density* density, int64_t voxels, uint64_t* sums)
{
  stratus_status status = STRATUS_OK;
  density_plan plan = { .context = NULL };
  if (!stratus_density_plan_fits(density->bandwidth, density->exact)) {
    return stratus_density_cells(context, bricks, count, density->bandwidth, density->exact, density->start, sums);
  }
  TRY_CLEANUP(stratus_density_plan_create(context, density->bandwidth, density->exact, &plan));
  if (stratus_device_builds(context) && stratus_device_takes_density(context, &plan, count, voxels)) {
    status = stratus_device_density(context, &plan, bricks, count, density->start, sums);
    if (!stratus_device_hands_back(context, status)) {
      goto cleanup;
    }
  }
  TRY_CLEANUP(stratus_density_rows(&plan, bricks, count, density->start, sums));

cleanup:
  stratus_density_plan_release(&plan);
  return status;
}

static stratus_status fill_density(stratus_context* context, const stratus_brick* bricks, int64_t count, stratus_density* density)
{
  stratus_status status = STRATUS_OK;
  void *memory, *sums = NULL;
  int64_t voxels = 0;
  for (int64_t b = 0; b < count; ++b) {
    voxels += bricks[b].count;
  }
  if (density->exact) {
    TRY(number_voxels(context, bricks, count, density));
  }
  const int64_t values = density->exact ? voxels : count;
  const double h = density->bandwidth;
  const double unit = DENSITY_CONSTANT / ((double)(1u << DENSITY_POINT) * (double)(voxels ? voxels : 1) * h * h * h);
  TRY_CLEANUP(stratus_allocate(context, (size_t)values, sizeof *density->of, &memory));
  density->of = memory;
  TRY_CLEANUP(stratus_allocate_zero(context, (size_t)values, sizeof(uint64_t), &sums));
  TRY_CLEANUP(sum_weights(context, bricks, count, density, voxels, sums));
  for (int64_t i = 0; i < values; ++i) {
    density->of[i] = (float)fmin((double)((const uint64_t*)sums)[i] * unit, FLT_MAX);
  }

cleanup:
  stratus_release(context, sums);
  return status;
}

stratus_status stratus_density_create(
  stratus_context* context, const stratus_brick* bricks, int64_t count, double bandwidth, int exact, stratus_density** out)
{
  void* memory;
  const stratus_stage stage = stratus_stage_begin(context);
  TRY(stratus_progress(context, "density", 0.0));
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_density), &memory));
  stratus_density* density = memory;
  density->context = context;
  density->bandwidth = bandwidth;
  density->exact = exact;
  density->count = count;
  stratus_status status = fill_density(context, bricks, count, density);
  if (status == STRATUS_OK) {
    stratus_stage_end(context, &stage, "density", (size_t)(exact ? density->start[count] : count) * sizeof *density->of);
    status = stratus_progress(context, "density", 1.0);
  }
  if (status != STRATUS_OK) {
    stratus_density_destroy(density);
    return status;
  }
  *out = density;
  return STRATUS_OK;
}

void stratus_density_destroy(stratus_density* density)
{
  if (density) {
    stratus_context* context = density->context;
    stratus_release(context, density->start);
    stratus_release(context, density->of);
    stratus_release(context, density);
  }
}

/* ---- the peak */

typedef struct peak_search {
  float density;
  int64_t order; /* z, y and x in one number; the least wins a tie */
  int32_t at[3];
} peak_search;

static void offer(peak_search* best, float density, const stratus_brick* brick, int bit)
{
  const int32_t at[3] = { STRATUS_BRICK * brick->at[0] + (bit & 3), STRATUS_BRICK * brick->at[1] + (bit >> 2 & 3),
    STRATUS_BRICK * brick->at[2] + (bit >> 4) };
  const int64_t order = ((int64_t)at[2] << 40) + ((int64_t)at[1] << 20) + at[0];
  if (density > best->density || (density >= best->density && order < best->order)) {
    *best = (peak_search){ density, order, { at[0], at[1], at[2] } };
  }
}

/* Returns the bit of the voxel nearest to the brick's middle, the first of several. */
static int middle_bit(uint64_t mask)
{
  int best = 0, least = 64;
  for (; mask; mask &= mask - 1) {
    const int bit = __builtin_ctzll(mask), x = 2 * (bit & 3) - 3, y = 2 * (bit >> 2 & 3) - 3, z = 2 * (bit >> 4) - 3;
    const int squared = x * x + y * y + z * z;
    if (squared < least) {
      least = squared;
      best = bit;
    }
  }
  return best;
}

void stratus_density_peak(
  const stratus_density* density, const stratus_brick* bricks, const uint32_t* which, int64_t count, int32_t peak[3])
{
  peak_search best = { -1.0f, 0, { 0, 0, 0 } };
  for (int64_t i = 0; i < count; ++i) {
    const int64_t b = which ? (int64_t)which[i] : i;
    if (!density->exact) {
      if (density->of[b] >= best.density) {
        offer(&best, density->of[b], bricks + b, middle_bit(bricks[b].mask));
      }
      continue;
    }
    const float* of = density->of + density->start[b];
    for (uint64_t bits = bricks[b].mask; bits; bits &= bits - 1) {
      if (*of >= best.density) {
        offer(&best, *of, bricks + b, __builtin_ctzll(bits));
      }
      ++of;
    }
  }
  for (int a = 0; a < 3; ++a) {
    peak[a] = best.at[a];
  }
}
