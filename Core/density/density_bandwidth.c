/* SPDX-License-Identifier: BSD-3-Clause
 * Bandwidth of the density by a rule of thumb (Guo et al. 2025, eq. 3 and 4): the spread of the voxels' distances to their mean position,
 * over the fifth root of their number. Sums run in chunks that depend only on the number of bricks, so that threads change no bit. */
#include "density.h"

#include "density_plan.h"

#include <omp.h>
#include <string.h>

#define CHUNKS 64
#define BINS 4096 /* bins of the histogram of squared distances; three refinements leave 2^-36 of the largest */

/* Runs `body` for each voxel of the brick, with its offset (x, y, z) from `origin` in voxels. */
#define FOR_EACH_VOXEL(brick, origin, x, y, z, body)                                                                                       \
  for (uint64_t bits = (brick)->mask; bits; bits &= bits - 1) {                                                                            \
    const int bit = __builtin_ctzll(bits);                                                                                                 \
    const double x = STRATUS_BRICK * (brick)->at[0] + (bit & 3) - (origin)[0];                                                             \
    const double y = STRATUS_BRICK * (brick)->at[1] + (bit >> 2 & 3) - (origin)[1];                                                        \
    const double z = STRATUS_BRICK * (brick)->at[2] + (bit >> 4) - (origin)[2];                                                            \
    body                                                                                                                                   \
  }

/* Finds the mean position of the voxels; returns their number. Integer sums make the mean independent of their order. */
static int64_t find_mean(const stratus_brick* bricks, int64_t count, double mean[3])
{
  int64_t voxels = 0, sum[3] = { 0, 0, 0 };
  for (int64_t b = 0; b < count; ++b) {
    for (uint64_t bits = bricks[b].mask; bits; bits &= bits - 1) {
      const int bit = __builtin_ctzll(bits);
      ++voxels;
      sum[0] += STRATUS_BRICK * bricks[b].at[0] + (bit & 3);
      sum[1] += STRATUS_BRICK * bricks[b].at[1] + (bit >> 2 & 3);
      sum[2] += STRATUS_BRICK * bricks[b].at[2] + (bit >> 4);
    }
  }
  for (int a = 0; a < 3; ++a) {
    mean[a] = voxels ? (double)sum[a] / (double)voxels : 0.0;
  }
  return voxels;
}

/* Compute the standard deviation of the distances to `mean` (eq. 4), and the largest squared distance. Distances are relative to one
 * voxel's distance: distances in a shell differ by little, which the squares of whole distances would lose. */
static double find_deviation(
  stratus_context* context, const stratus_brick* bricks, int64_t count, int64_t voxels, const double mean[3], double* largest)
{
  double sums[CHUNKS], squares[CHUNKS], most[CHUNKS], shift = 0.0;
  FOR_EACH_VOXEL(bricks, mean, x, y, z, { shift = sqrt(x * x + y * y + z * z); })
#pragma omp parallel for schedule(static) num_threads(context->threads) if (count >= DENSITY_PARALLEL)
  for (int chunk = 0; chunk < CHUNKS; ++chunk) {
    double sum = 0.0, square = 0.0, top = 0.0;
    for (int64_t b = count * chunk / CHUNKS; b < count * (chunk + 1) / CHUNKS; ++b) {
      FOR_EACH_VOXEL(bricks + b, mean, x, y, z, {
        const double squared = x * x + y * y + z * z;
        const double distance = sqrt(squared) - shift;
        sum += distance;
        square += distance * distance;
        top = squared > top ? squared : top;
      })
    }
    sums[chunk] = sum;
    squares[chunk] = square;
    most[chunk] = top;
  }
  double sum = 0.0, square = 0.0;
  *largest = 0.0;
  for (int chunk = 0; chunk < CHUNKS; ++chunk) {
    sum += sums[chunk];
    square += squares[chunk];
    *largest = most[chunk] > *largest ? most[chunk] : *largest;
  }
  const double average = sum / (double)voxels, variance = square / (double)voxels - average * average;
  return variance > 0.0 ? sqrt(variance) : 0.0;
}

/* Counts the voxels whose squared distance to `mean` is below `limit`. */
static int64_t count_below(stratus_context* context, const stratus_brick* bricks, int64_t count, const double mean[3], double limit)
{
  int64_t below = 0;
#pragma omp parallel for schedule(static) num_threads(context->threads) reduction(+ : below) if (count >= DENSITY_PARALLEL)
  for (int64_t b = 0; b < count; ++b) {
    FOR_EACH_VOXEL(bricks + b, mean, x, y, z, { below += x * x + y * y + z * z < limit; })
  }
  return below;
}

/* A histogram and the bins that each thread fills for it. They are allocated because threads' stacks may be small. */
typedef struct histogram {
  int64_t bins[BINS];
  uint32_t own[][BINS];
} histogram;

/* Counts the squared distances in [low, high) by bin. Returns the number of distances below low. */
static int64_t fill_bins(
  stratus_context* context, const stratus_brick* bricks, int64_t count, const double mean[3], double low, double high, histogram* histogram)
{
  int64_t* const bins = histogram->bins;
  const double scale = BINS / (high - low);
  int64_t below = 0;
  for (int i = 0; i < BINS; ++i) {
    bins[i] = 0;
  }
#pragma omp parallel num_threads(context->threads) if (count >= DENSITY_PARALLEL)
  {
    uint32_t* const own = histogram->own[omp_get_thread_num()];
    int64_t own_below = 0;
    memset(own, 0, sizeof histogram->own[0]);
#pragma omp for schedule(static)
    for (int64_t b = 0; b < count; ++b) {
      FOR_EACH_VOXEL(bricks + b, mean, x, y, z, {
        const double place = (x * x + y * y + z * z - low) * scale;
        own_below += place < 0.0;
        if (place >= 0.0 && place < BINS) {
          own[(int)place]++;
        }
      })
    }
#pragma omp critical(stratus_density_bins)
    {
      below += own_below;
      for (int i = 0; i < BINS; ++i) {
        bins[i] += own[i];
      }
    }
  }
  return below;
}

/* Finds the median of the distances to `mean`: of an even number, the upper of the middle two. */
static stratus_status find_median(stratus_context* context, const stratus_brick* bricks, int64_t count, int64_t voxels,
  const double mean[3], double largest, double* median)
{
  void* memory;
  TRY(stratus_allocate(context, 1, sizeof(histogram) + (size_t)context->threads * sizeof(uint32_t[BINS]), &memory));
  histogram* const histogram = memory;
  double low = 0.0, high = largest * (1.0 + 1e-9);
  for (int refinement = 0; refinement < 3 && low < high; ++refinement) {
    int64_t before = fill_bins(context, bricks, count, mean, low, high, histogram);
    const double width = (high - low) / BINS;
    int bin = 0;
    while (bin < BINS - 1 && before + histogram->bins[bin] <= voxels / 2) {
      before += histogram->bins[bin++];
    }
    low += width * bin;
    high = low + width;
  }
  stratus_release(context, memory);
  *median = sqrt(0.5 * (low + high));
  return STRATUS_OK;
}

stratus_status stratus_density_bandwidth_of(
  stratus_context* context, const stratus_brick* bricks, int64_t count, double* bandwidth, double* raw)
{
  const double widen = sqrt(1.0 / log(2.0));
  double mean[3], largest, printed = 0.0;
  const int64_t voxels = find_mean(bricks, count, mean);
  if (voxels >= 2) {
    double spread = find_deviation(context, bricks, count, voxels, mean, &largest);
    /* The median matters only if it gives less than the deviation does. It does if more than half of the voxels are nearer than this. */
    const double near = spread / widen;
    if (count_below(context, bricks, count, mean, near * near) > voxels / 2) {
      double median;
      TRY(find_median(context, bricks, count, voxels, mean, largest, &median));
      spread = fmin(spread, widen * median);
    }
    printed = 0.9 * spread * pow((double)voxels, -0.2);
  }
  *bandwidth = fmax(printed, 1.0);
  if (raw) {
    *raw = printed;
  }
  return STRATUS_OK;
}

stratus_status stratus_density_bandwidth(stratus_context* context, const stratus_voxels* voxels, double* bandwidth, double* raw)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!voxels || !bandwidth) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", voxels ? "bandwidth" : "voxels");
  }
  return stratus_density_bandwidth_of(context, voxels->bricks, voxels->brick_count, bandwidth, raw);
}
