/* SPDX-License-Identifier: BSD-3-Clause
 * Modes of the ray cast beside light: which values matter to them, how they are sampled, and what their rays are told. */
#include "ray_caster.h"

/* Maxima are sampled this densely, in voxels: what lies between two samples is missed by a quarter of what the field bends over them. */
#define EXTREME_STEP 0.5

const char* stratus_mode_name(stratus_mode mode)
{
  static const char* const names[] = { "composite", "first-hit", "maximum", "minimum", "average", "additive" };
  return (unsigned)mode < sizeof names / sizeof *names ? names[mode] : "unknown";
}

static bool is_extreme(stratus_mode mode)
{
  return mode == STRATUS_MODE_MAXIMUM || mode == STRATUS_MODE_MINIMUM;
}

static bool is_sum(stratus_mode mode)
{
  return mode == STRATUS_MODE_AVERAGE || mode == STRATUS_MODE_ADDITIVE;
}

stratus_status stratus_ray_modes_check(stratus_context* context, const stratus_ray_cast_options* options)
{
  const double* range = options->average_range;
  if (!(range[0] <= range[1])) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "average range %g..%g is reversed or no number", range[0], range[1]);
  }
  return STRATUS_OK;
}

stratus_ray_shown stratus_ray_modes_shown(const stratus_ray_cast_options* options)
{
  return (stratus_ray_shown){ .mode = options->mode, .average_range = { options->average_range[0], options->average_range[1] } };
}

bool stratus_ray_modes_same(const stratus_ray_shown* shown, const stratus_ray_cast_options* options)
{
  const bool same_range = shown->average_range[0] == options->average_range[0] && shown->average_range[1] == options->average_range[1];
  return shown->mode == options->mode && (same_range || options->mode != STRATUS_MODE_AVERAGE);
}

void stratus_ray_modes_choose(const stratus_ray_cast_options* options, double voxel, stratus_ray_choice* choice)
{
  if (options->mode != STRATUS_MODE_COMPOSITE) {
    choice->sampling = STRATUS_SAMPLING_MIDPOINT;
  }
  if (is_extreme(options->mode) && !(options->sample_distance > 0.0)) {
    choice->sample_distance = EXTREME_STEP * voxel;
  }
}

double stratus_ray_modes_table_distance(const stratus_ray_cast_options* options, const stratus_transfer* transfer, double sample_distance)
{
  return is_extreme(options->mode) || is_sum(options->mode) ? transfer->unit_distance : sample_distance;
}

/* Entries first..last show, and no others. */
static void show_only(stratus_table* table, int first, int last)
{
  table->shown = last >= first ? last - first + 1 : 0;
  table->last_shown = last >= first ? last : -1;
  for (int e = 0; e <= table->size; ++e) {
    table->next_shown[e] = e > last ? table->size : e < first ? first : e;
  }
}

void stratus_ray_modes_mark(const stratus_ray_cast_options* options, double bias, stratus_table* table)
{
  const double* range = options->average_range;
  if (options->mode == STRATUS_MODE_MAXIMUM) { /* a maximum below all that shows is as good as none */
    show_only(table, table->next_shown[0], table->size - 1);
  } else if (options->mode == STRATUS_MODE_MINIMUM) {
    show_only(table, 0, table->last_shown);
  } else if (options->mode == STRATUS_MODE_AVERAGE) { /* transparent values count as much as others */
    show_only(table, stratus_table_entry(table, (float)(range[0] - bias)), stratus_table_entry(table, (float)(range[1] - bias)));
  }
}

/* The float nearest to `value` that is not below it (or above, where upward is 0): no value in the range may be left out. */
static float outward(double value, bool upward)
{
  const float nearest = (float)value;
  if (isinf(value) || isinf(nearest)) {
    return nearest;
  }
  return upward ? ((double)nearest < value ? nextafterf(nearest, INFINITY) : nearest)
                : ((double)nearest > value ? nextafterf(nearest, -INFINITY) : nearest);
}

void stratus_ray_modes_arguments(const stratus_ray_caster* caster, const stratus_ray_cast_options* options, stratus_ray_cast_arguments* a)
{
  const stratus_value_range* ranges = caster->ranges;
  const double lo = (double)ranges->whole_lo, hi = (double)ranges->whole_hi, extent = hi - lo;
  const bool additive = options->mode == STRATUS_MODE_ADDITIVE;
  a->sign = options->mode == STRATUS_MODE_MINIMUM ? -1.0f : 1.0f;
  a->top = options->mode == STRATUS_MODE_MINIMUM ? -ranges->whole_lo : ranges->whole_hi;
  a->sum = is_sum(options->mode);
  a->counted_first = additive ? -INFINITY : outward(options->average_range[0] - ranges->bias, false);
  a->counted_last = additive ? INFINITY : outward(options->average_range[1] - ranges->bias, true);
  a->grey_scale = extent > 0.0 && isfinite(extent) ? (float)(1.0 / extent) : 0.0f;
  a->grey_offset = a->grey_scale > 0.0f ? (float)(-lo / extent) : 0.0f;
  a->sum_scale = additive ? (float)(caster->choice.sample_distance / caster->transfer.unit_distance) : 0.0f;
}

stratus_ray_variant stratus_ray_modes_variant(const stratus_ray_caster* caster)
{
  const stratus_mode mode = caster->shown.mode;
  if (is_extreme(mode) || is_sum(mode)) {
    return is_sum(mode) ? STRATUS_RAY_ADDED : STRATUS_RAY_BEST;
  }
  return caster->choice.sampling == STRATUS_SAMPLING_PREINTEGRATED ? STRATUS_RAY_PREINTEGRATED : STRATUS_RAY_MIDPOINT;
}

bool stratus_ray_modes_covers(const stratus_ray_cast_options* options)
{
  return is_sum(options->mode);
}
