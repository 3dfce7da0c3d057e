/* SPDX-License-Identifier: BSD-3-Clause
 * Ray modes other than composite: which values matter, how they are sampled, and the arguments of their rays. */
#include "ray_modes_render.h"

#include "ray_cast_host.h"
#include "slices.h"

#include <string.h>

static stratus_status check_contours(stratus_context* context, const stratus_ray_cast_options* options)
{
  if (options->optics.contour_count < 1 || options->optics.contour_count > STRATUS_CONTOURS_MAX) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%d contour values, an isosurface needs 1..%d", options->optics.contour_count,
      STRATUS_CONTOURS_MAX);
  }
  for (int n = 0; n < options->optics.contour_count; ++n) {
    if (!isfinite(options->optics.contours[n])) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "contour %d has value %g, must be finite", n, options->optics.contours[n]);
    }
  }
  if (options->sampling.interpolation == STRATUS_INTERPOLATION_NEAREST) {
    return stratus_fail(context, STRATUS_UNSUPPORTED,
      "isosurfaces of values taken as they are (nearest) are not supported, only linear interpolation is: vtkVolumeProperty has "
      "SetInterpolationTypeToLinear()");
  }
  return STRATUS_OK;
}

stratus_status stratus_ray_modes_check(stratus_context* context, const stratus_ray_cast_options* options)
{
  const double* range = options->optics.average_range;
  if (!(range[0] <= range[1])) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "average range %g..%g is reversed or no number", range[0], range[1]);
  }
  if (options->clipping.crop_regions > STRATUS_CROP_ALL) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "crop regions 0x%x, must be 0..0x%x", (unsigned)options->clipping.crop_regions,
      (unsigned)STRATUS_CROP_ALL);
  }
  if (options->mode == STRATUS_MODE_FIRST_HIT && options->clipping.crop && options->clipping.crop_regions != STRATUS_CROP_INSIDE) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "first hits with crop regions other than the inside are not supported");
  }
  if (options->mode == STRATUS_MODE_SLICE) {
    return stratus_slice_check(context, &options->slice);
  }
  return options->mode == STRATUS_MODE_ISOSURFACE ? check_contours(context, options) : STRATUS_OK;
}

stratus_ray_shown stratus_ray_modes_shown(const stratus_ray_cast_options* options)
{
  stratus_ray_shown shown = { .mode = options->mode };
  if (options->mode == STRATUS_MODE_QUANTITIES) { /* all finite values count */
    shown.average_range[0] = -INFINITY;
    shown.average_range[1] = INFINITY;
  } else if (options->mode == STRATUS_MODE_AVERAGE) {
    shown.average_range[0] = options->optics.average_range[0];
    shown.average_range[1] = options->optics.average_range[1];
  }
  for (int n = 0; options->mode == STRATUS_MODE_ISOSURFACE && n < options->optics.contour_count;
       ++n) { /* insertion sort without duplicates */
    const double contour = options->optics.contours[n];
    int at = shown.contour_count;
    while (at > 0 && shown.contours[at - 1] >= contour) {
      --at;
    }
    if (at < shown.contour_count && shown.contours[at] == contour) {
      continue;
    }
    for (int moved = shown.contour_count; moved > at; --moved) {
      shown.contours[moved] = shown.contours[moved - 1];
    }
    shown.contours[at] = contour;
    ++shown.contour_count;
  }
  return shown;
}

bool stratus_ray_modes_same(const stratus_ray_shown* a, const stratus_ray_shown* b)
{
  bool same = a->mode == b->mode && a->average_range[0] == b->average_range[0] && a->average_range[1] == b->average_range[1] &&
    a->contour_count == b->contour_count;
  for (int n = 0; same && n < a->contour_count; ++n) {
    same = a->contours[n] == b->contours[n];
  }
  return same;
}

/* The contour as rays see it. */
static float fetched_contour(double contour, double bias)
{
  return (float)(contour - bias);
}

/* The ends of the average's range as rays see them, rounded outward so that no value of the range is left out. */
static void fetched_range(const double range[2], double bias, float fetched[2])
{
  fetched[0] = stratus_float_below(range[0] - bias);
  fetched[1] = stratus_float_above(range[1] - bias);
}

/* Adds the contours of opacity above 0, which are in ascending order. */
static void show_contours(const stratus_ray_shown* shown, const stratus_pieces* pieces, double bias, stratus_shown* values)
{
  values->count = 0;
  for (int n = 0; n < shown->contour_count; ++n) {
    const float contour = fetched_contour(shown->contours[n], bias);
    if (stratus_curve_at(&pieces->opacity, shown->contours[n]) > 0.0 &&
      (values->count == 0 || values->of[values->count - 1][0] < contour)) {
      values->of[values->count][0] = values->of[values->count][1] = contour;
      ++values->count;
    }
  }
}

static stratus_status contour_values(stratus_context* context, const stratus_ray_shown* shown, const stratus_transfer* transfer,
  const stratus_fetching* fetching, stratus_shown* values)
{
  void* memory;
  stratus_pieces* pieces = NULL;
  TRY(stratus_pieces_create(context, transfer, &pieces));
  const stratus_status status = stratus_allocate(context, STRATUS_CONTOURS_MAX, sizeof *values->of, &memory);
  if (status == STRATUS_OK) {
    *values = (stratus_shown){ .of = memory };
    show_contours(shown, pieces, fetching->bias, values);
  }
  stratus_pieces_destroy(pieces);
  return status;
}

stratus_status stratus_ray_modes_values(stratus_context* context, const stratus_ray_shown* shown, const stratus_transfer* transfer,
  const stratus_fetching* fetching, stratus_shown* values)
{
  if (shown->mode == STRATUS_MODE_ISOSURFACE) {
    return contour_values(context, shown, transfer, fetching, values);
  }
  TRY(stratus_shown_of_transfer(context, fetching, transfer, values));
  if (shown->mode == STRATUS_MODE_AVERAGE ||
    shown->mode == STRATUS_MODE_QUANTITIES) { /* transparent values count, too; the array holds at least one interval */
    values->count = 1;
    fetched_range(shown->average_range, fetching->bias, values->of[0]);
  } else if (shown->mode == STRATUS_MODE_MAXIMUM && values->count > 0) { /* a maximum below the lowest visible value shows nothing */
    values->count = 1;
    values->of[0][1] = INFINITY;
  } else if (shown->mode == STRATUS_MODE_MINIMUM && values->count > 0) {
    values->of[0][0] = -INFINITY;
    values->of[0][1] = values->of[values->count - 1][1];
    values->count = 1;
  }
  return STRATUS_OK;
}

stratus_status stratus_ray_modes_bounds(const stratus_ray_field* field, stratus_mode mode, stratus_distance_map* map)
{
  const stratus_value_range* ranges = field->ranges;
  const size_t blocks = (size_t)ranges->blocks[0] * (size_t)ranges->blocks[1] * (size_t)ranges->blocks[2];
  const size_t at = (map->bytes_size + 63) / 64 * 64, bytes = blocks * sizeof(float);
  const bool smallest = mode == STRATUS_MODE_MINIMUM;
  void* memory = NULL;
  if (!stratus_mode_is_extreme(mode)) {
    return STRATUS_OK;
  }
  TRY(stratus_allocate(field->context, at + bytes, 1, &memory));
  memcpy(memory, map->bytes, map->bytes_size);
  uint8_t* bounds = (uint8_t*)memory + at;
#pragma omp parallel for num_threads(field->context->threads)
  for (size_t b = 0; b < blocks; ++b) {
    const float best = smallest ? -ranges->lo[b] : ranges->hi[b]; /* -INFINITY where no value is finite */
    const float bound = best + STRATUS_HULL_SLACK * fmaxf(fabsf(ranges->lo[b]), fabsf(ranges->hi[b]));
    memcpy(bounds + b * sizeof bound, isfinite(best) ? &bound : &best, sizeof bound);
  }
  stratus_release(field->context, map->bytes);
  map->bytes = memory;
  map->bytes_size = at + bytes;
  map->bounds_at = at;
  return STRATUS_OK;
}

/* Return the length of the part of lo..hi within which the function changes, or of all of lo..hi if it changes at one value at most. The
 * error of rule cells is a fraction of this length. A fill value far from the function's points makes no piece coarser. */
static double changing_extent(const stratus_transfer* transfer, double lo, double hi)
{
  const double* opacity = transfer->opacity;
  const double* color = transfer->color;
  const double first = fmin(opacity[0], color[0]);
  const double last = fmax(opacity[2 * (transfer->opacity_count - 1)], color[4 * (transfer->color_count - 1)]);
  const double extent = fmin(hi, last) - fmax(lo, first);
  return extent > 0.0 ? extent : hi - lo;
}

void stratus_ray_modes_arguments(const stratus_ray_integrator* integrator, const stratus_ray_optics* optics, const stratus_ray_field* field,
  const stratus_distance_map* rough, const stratus_ray_cast_options* options, stratus_ray_cast_arguments* a)
{
  const stratus_value_range *ranges = field->ranges, *summed = stratus_ray_range_of(field, 0);
  const double lo = (double)summed->whole_lo, hi = (double)summed->whole_hi, extent = hi - lo;
  const bool additive = options->mode == STRATUS_MODE_ADDITIVE;
  a->mode.sign = options->mode == STRATUS_MODE_MINIMUM ? -1.0f : 1.0f;
  a->mode.top = options->mode == STRATUS_MODE_MINIMUM ? -ranges->whole_lo : ranges->whole_hi;
  a->mode.sum = stratus_mode_is_sum(options->mode);
  a->mode.kept = 0;
  float counted[2] = { -INFINITY, INFINITY };
  if (stratus_mode_is_extreme(options->mode)) { /* values beyond never show, so that blocks of such values are skipped */
    counted[0] = integrator->values.count > 0 ? integrator->values.of[0][0] : INFINITY;
    counted[1] = integrator->values.count > 0 ? integrator->values.of[0][1] : -INFINITY;
  } else if (!additive) {
    fetched_range(options->optics.average_range, summed->bias, counted);
  }
  a->mode.counted_first = counted[0];
  a->mode.counted_last = counted[1];
  a->mode.grey_scale = extent > 0.0 && isfinite(extent) ? (float)(1.0 / extent) : 0.0f;
  a->mode.grey_offset = a->mode.grey_scale > 0.0f ? (float)(-lo / extent) : 0.0f;
  a->mode.sum_scale = additive ? (float)fmin(integrator->choice.sample_distance / optics->transfers[0].unit_distance, 1e30) : 0.0f;
  if (stratus_ray_visits_cells(integrator->choice.sampling)) {
    const double error = integrator->choice.cell_error * changing_extent(optics->transfers, lo + summed->bias, hi + summed->bias);
    a->lattice.pieces_per_bend = error > 0.0 ? (float)fmin(1.0 / (8.0 * error), 1e30) : 0.0f;
    a->lattice.light_spread = (float)fmax(fmin(integrator->choice.light_spread, 1e30), 1e-30);
  }
  if (integrator->choice.sampling == STRATUS_SAMPLING_CELLS || options->mode == STRATUS_MODE_SLICE ||
    options->mode == STRATUS_MODE_QUANTITIES) {
    a->lattice.jitter = 0; /* rays pass from cell to cell, or to a surface, whatever their lattice */
  }
  if (integrator->choice.sampling == STRATUS_SAMPLING_LOCAL) {
    a->rough = (stratus_ray_rough){
      .pitch = (int)rough->pitch, .rows = (int)rough->blocks[1], .block_log2 = stratus_distance_map_block_log2(rough)
    };
  }
  a->mode.contour_count = 0;
  for (int n = 0; n < integrator->shown.contour_count; ++n) {
    double rgba[4];
    stratus_transfer_at(optics->transfers, integrator->shown.contours[n], rgba);
    if (rgba[3] > 0.0) { /* transparent contours are left out */
      float* contour = a->mode.contour[a->mode.contour_count++];
      contour[0] = fetched_contour(integrator->shown.contours[n], ranges->bias);
      contour[4] = (float)rgba[3];
      for (int c = 0; c < 3; ++c) {
        contour[1 + c] = (float)(rgba[c] * rgba[3]);
      }
    }
  }
}

bool stratus_ray_lights_places(const stratus_ray_integrator* integrator, const stratus_ray_optics* optics)
{
  return optics->shades && integrator->shown.mode == STRATUS_MODE_COMPOSITE && stratus_ray_visits_cells(integrator->choice.sampling);
}

stratus_ray_variant stratus_ray_modes_variant(const stratus_ray_integrator* integrator, const stratus_ray_optics* optics)
{
  const stratus_mode mode = integrator->shown.mode;
  if (stratus_ray_lights_places(integrator, optics)) {
    return STRATUS_VARIANT_LIT;
  }
  if (optics->shades && mode == STRATUS_MODE_COMPOSITE) {
    return optics->made.table->sums ? STRATUS_VARIANT_SHADING_PREINTEGRATED : STRATUS_VARIANT_SHADING_MIDPOINT;
  }
  if (optics->transfer_2d.on) {
    return STRATUS_VARIANT_TRANSFER_2D;
  }
  if (mode == STRATUS_MODE_ISOSURFACE || mode == STRATUS_MODE_SLICE || mode == STRATUS_MODE_QUANTITIES) {
    return mode == STRATUS_MODE_SLICE   ? STRATUS_VARIANT_SLICE
      : mode == STRATUS_MODE_ISOSURFACE ? STRATUS_VARIANT_ISOSURFACE
                                        : STRATUS_VARIANT_QUANTITIES;
  }
  if (stratus_mode_is_extreme(mode) || stratus_mode_is_sum(mode)) {
    return stratus_mode_is_sum(mode) ? STRATUS_VARIANT_SUMS : STRATUS_VARIANT_EXTREMES;
  }
  return integrator->choice.sampling == STRATUS_SAMPLING_CELLS      ? STRATUS_VARIANT_CELLS
    : integrator->choice.sampling == STRATUS_SAMPLING_LOCAL         ? STRATUS_VARIANT_LOCAL
    : integrator->choice.sampling == STRATUS_SAMPLING_PREINTEGRATED ? STRATUS_VARIANT_PREINTEGRATED
                                                                    : STRATUS_VARIANT_MIDPOINT;
}

bool stratus_ray_modes_covers(const stratus_ray_cast_options* options)
{
  return stratus_mode_is_sum(options->mode);
}
