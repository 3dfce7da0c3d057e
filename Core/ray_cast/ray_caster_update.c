/* SPDX-License-Identifier: BSD-3-Clause
 * Rebuilds what an input change makes stale. New data: value ranges. New transfer function: table, occupancy and map. New camera: nothing.
 */
#include "ray_caster.h"

#include "ray_fetched.h"
#include "ray_mask.h"
#include "ray_modes_render.h"
#include "ray_sampling.h"
#include "ray_shading_render.h"
#include "ray_shading_table.h"
#include "ray_tree.h"

#include <stdio.h>
#include <string.h>

#define BLOCK_SIZE_DEFAULT 4
/* Traversal addresses all eight octant maps with one int. */
#define MAP_BYTES_MOST 2000000000.0

static bool same_data(const stratus_ray_caster* caster, const stratus_volume* volume, int block_size)
{
  const stratus_volume* old = &caster->volume;
  return caster->ranges && caster->ranges->block_size == block_size && stratus_volume_same_data(old, volume) &&
    stratus_volume_components(old) == stratus_volume_components(volume);
}

static int chosen_block_size(const stratus_volume* volume, int wanted)
{
  int size = wanted ? wanted : BLOCK_SIZE_DEFAULT;
  while (size < 32) {
    double bytes = 8.0;
    for (int axis = 0; axis < 3; ++axis) {
      bytes *= ceil((double)volume->dimensions[axis] / size + (axis == 0 ? 64.0 : 0.0));
    }
    if (bytes < MAP_BYTES_MOST) {
      break;
    }
    size *= 2;
  }
  return size;
}

int stratus_ray_block_size(const stratus_volume* volume)
{
  return chosen_block_size(volume, 0);
}

static stratus_status update_ranges(
  stratus_ray_caster* caster, const stratus_volume* volume, const stratus_ray_cast_options* options, size_t rays, double* ms)
{
  const int block_size = chosen_block_size(volume, options->skipping.block_size);
  const bool by_value = options->sampling.interpolation == STRATUS_INTERPOLATION_NEAREST && volume->cell_centered;
  const int followed = stratus_ray_followed(volume, options);
  const bool same = same_data(caster, volume, block_size) && caster->followed == followed;
  if (!same || caster->hidden_by_value != by_value || !stratus_ray_mask_same(caster, options)) {
    const double start = stratus_now_ms();
    stratus_value_range* ranges = NULL;
    uint8_t* hidden = NULL;
    int hides = 0;
    stratus_status status = stratus_ray_hidden_make(caster->context, volume, by_value, &hidden);
    if (status == STRATUS_OK) {
      status =
        stratus_ray_mask_join(caster->context, volume, options->mask.bytes, options->mask.label_count > 0, by_value, &hidden, &hides);
    }
    const stratus_volume view = stratus_volume_component(volume, followed);
    if (status == STRATUS_OK && !same) {
      status = stratus_value_range_create(caster->context, &view, block_size, &ranges);
    }
    if (status == STRATUS_OK && ranges && ranges->whole_lo == ranges->whole_hi) {
      status = stratus_volume_check_floats(caster->context, &view, ranges->bias);
    }
    if (status != STRATUS_OK) {
      stratus_value_range_destroy(ranges);
      stratus_release(caster->context, hidden);
      return status;
    }
    stratus_release(caster->context, caster->hidden);
    caster->hidden = hidden;
    caster->hidden_by_value = by_value;
    caster->hides = hides;
    caster->mask = options->mask.bytes;
    caster->mask_revision = options->mask.revision;
    stratus_ray_drop_offer_map(caster);
    caster->inputs.tolerance = caster->measured_for.tolerance = -1.0; /* equals none: the choice is made anew */
    ++caster->data_serial;
    if (!same) {
      stratus_ray_drop_transfer(caster);
      stratus_value_range_destroy(caster->ranges);
      caster->ranges = ranges;
      caster->followed = followed;
      stratus_ray_fetched_drop(caster);
      ++caster->range_builds;
      caster->owns_all = stratus_volume_owned(volume, caster->owned[0], caster->owned[1]);
    }
    *ms = stratus_now_ms() - start;
    caster->scan_ms = same ? caster->scan_ms : *ms;
  }
  bool regridded = false;
  TRY(stratus_ray_grid_update(caster->context, volume, &caster->grid, &regridded));
  if (regridded) {
    caster->inputs.tolerance = caster->measured_for.tolerance = -1.0;
  }
  caster->volume = *volume;
  memcpy(caster->volume.coordinates, caster->grid.coordinates, sizeof caster->grid.coordinates);
  const float* before = caster->fetched;
  const double start = stratus_now_ms();
  TRY(stratus_ray_fetched_update(caster, rays));
  *ms += caster->fetched != before ? stratus_now_ms() - start : 0.0;
  return STRATUS_OK;
}

static bool same_transfers(const stratus_ray_caster* caster, const stratus_transfer* transfers, int count, bool dependent)
{
  bool same = caster->transfers && caster->transfer_count == count && caster->dependent == dependent;
  for (int i = 0; same && i < count; ++i) {
    same = stratus_transfer_same(caster->transfers + i, transfers + i);
  }
  return same;
}

static stratus_status keep_transfers(stratus_ray_caster* caster, const stratus_transfer* transfers, int count, bool dependent)
{
  stratus_transfer* copy = NULL;
  TRY(stratus_transfer_copy(caster->context, transfers, count, &copy));
  stratus_ray_drop_transfer(caster);
  caster->transfers = copy;
  caster->transfer_count = count;
  caster->dependent = dependent;
  return STRATUS_OK;
}

/* Return the inputs of the caster's choice, except values and transfer functions. */
static stratus_ray_choice_inputs choice_inputs(
  const stratus_ray_caster* caster, const stratus_volume* volume, const stratus_ray_cast_options* options)
{
  const int materials =
    options->light.materials && options->mode == STRATUS_MODE_COMPOSITE ? stratus_ray_shading_media(volume, options) : 0;
  stratus_ray_choice_inputs in;
  memset(&in, 0, sizeof in); /* padding, too: inputs are compared as bytes */
  in.sampling = options->sampling.rule;
  in.sample_distance = options->sampling.distance;
  in.cell_error = options->sampling.cell_error;
  in.light_spread = options->sampling.light_spread;
  in.tolerance = options->sampling.tolerance;
  in.interpolation = options->sampling.interpolation;
  in.shade = options->light.shade != 0;
  in.together = caster->together && in.shade;
  in.clips_gradients = stratus_ray_clips_gradients(options) && in.shade;
  in.mean_components = options->optics.mean_components != 0;
  in.gradient_distance = options->optics.gradient_distance;
  in.gradient_length = options->optics.gradient_length;
  for (int c = 0; c < materials && c < 4; ++c) { /* field by field: their padding is anything */
    in.materials[c].shade = options->light.materials[c].shade != 0;
    in.materials[c].ambient = options->light.materials[c].ambient;
    in.materials[c].diffuse = options->light.materials[c].diffuse;
    in.materials[c].specular = options->light.materials[c].specular;
    in.materials[c].specular_power = options->light.materials[c].specular_power;
  }
  in.voxel = stratus_ray_voxel_length(volume);
  return in;
}

/* Update the copied transfer functions and the values that they show in this mode. Occupancy depends on nothing else, in particular not on
 * sampling or tables. */
static stratus_status update_function(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_ray_cast_options* options, bool* changed)
{
  const int media = stratus_ray_shading_media(volume, options);
  stratus_ray_shown shown = stratus_ray_modes_shown(options);
  if (caster->followed) { /* an average's values are another component's */
    shown.average_range[0] = -INFINITY;
    shown.average_range[1] = INFINITY;
  }
  if (!same_transfers(caster, transfer, media, options->optics.dependent != 0)) {
    TRY(keep_transfers(caster, transfer, media, options->optics.dependent != 0));
    *changed = true;
  }
  if (!caster->values.of || !stratus_ray_modes_same(&caster->shown, &shown) || caster->interpolation != options->sampling.interpolation) {
    const stratus_fetching fetching = stratus_value_range_fetching(caster->ranges);
    stratus_ray_drop_values(caster);
    *changed = true;
    TRY(stratus_ray_modes_values(caster->context, &shown, caster->transfers, &fetching, &caster->values));
    caster->shown = shown;
    caster->interpolation = options->sampling.interpolation;
  }
  return STRATUS_OK;
}

/* Whether the table is of the requested kind (midpoint or running sums), entries and distance. Sums serve every distance. */
static bool table_fits(const stratus_ray_made_table* made, bool sums, int entries, double distance)
{
  return made->table && (made->table->sums != NULL) == sums && made->entries == entries && (sums || made->distance == distance);
}

stratus_status stratus_ray_update_table(stratus_ray_caster* caster, const stratus_ray_cast_options* options)
{
  const bool sums = caster->choice.sampling != STRATUS_SAMPLING_MIDPOINT;
  const stratus_sampling rule = sums ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT;
  const double distance = stratus_ray_modes_table_distance(options->mode, caster->transfers, caster->choice.sample_distance);
  const int entries = stratus_table_entries_for(rule, stratus_ray_tolerance(options));
  const stratus_ray_made_table last = caster->made;
  stratus_ray_made_table made = last;
  if (!table_fits(&last, sums, entries, distance)) {
    made = caster->spare_table;
    if (!table_fits(&made, sums, entries, distance)) {
      const stratus_table_values values = stratus_table_values_of(caster->ranges, caster->interpolation == STRATUS_INTERPOLATION_NEAREST);
      made = (stratus_ray_made_table){ NULL, distance, entries, caster->table_builds + 1 };
      TRY(stratus_table_create_fine(caster->context, caster->transfers, &values, rule, distance, entries, &made.table));
      ++caster->table_builds;
      const bool same_kind = last.table && (last.table->sums != NULL) == sums;
      stratus_table_destroy(same_kind ? last.table : caster->spare_table.table);
      caster->spare_table = same_kind ? caster->spare_table : last;
    } else {
      caster->spare_table = last;
    }
    ++caster->table_serial;
  }
  if (sums) {
    stratus_table_set_distance(made.table, distance);
  }
  made.distance = distance;
  caster->made = made;
  return caster->shades ? stratus_ray_shading_tables_update(caster, caster->dependent) : STRATUS_OK;
}

/* Make a new choice if its inputs changed. If only options changed, and are again as they were when the choice was measured, the last
 * measurement serves again. This happens after the coarse images of a moving camera. */
static void update_choice(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_ray_cast_options* options, bool changed)
{
  const stratus_ray_choice_inputs inputs = choice_inputs(caster, volume, options);
  if (changed) {
    caster->measured_for.tolerance = -1.0;
  }
  if (changed || memcmp(&caster->inputs, &inputs, sizeof inputs) != 0) {
    caster->inputs = inputs;
    caster->tried[0] = '\0';
    stratus_ray_choose(caster, options, &caster->choice);
    if (caster->choice.provisional && memcmp(&caster->measured_for, &inputs, sizeof inputs) == 0) {
      caster->choice = caster->measured;
      snprintf(caster->tried, sizeof caster->tried, "as measured before");
    }
  }
}

stratus_status stratus_ray_update_tables(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_ray_cast_options* options, size_t rays, stratus_ray_cast_report* report)
{
  caster->shades = stratus_ray_shading_wanted(volume, transfer, options);
  TRY(update_ranges(caster, volume, options, rays, &report->range_ms));
  TRY(stratus_ray_shading_ranges(caster));
  const double start = stratus_now_ms();
  const uint64_t builds = caster->table_builds;
  bool changed = !caster->made.table;
  TRY(update_function(caster, volume, transfer, options, &changed));
  update_choice(caster, volume, options, changed);
  if (!caster->choice.provisional) { /* the probe makes the tables of its own choice */
    TRY(stratus_ray_update_table(caster, options));
  }
  report->table_ms = caster->table_builds != builds ? stratus_now_ms() - start : 0.0;
  return STRATUS_OK;
}

/* Return the structure whose map an automatic choice draws, or tries first. stratus_ray_try() measures whether it pays. In modes that skip
 * by bounds, the number of occupied blocks never shows that nothing can be skipped. */
static stratus_status automatic(stratus_ray_caster* caster, bool times, stratus_structure* structure)
{
  const int64_t* n = caster->occupancy->blocks;
  bool serves = true;
  *structure = STRATUS_STRUCTURE_NONE;
  if (caster->shown.mode == STRATUS_MODE_SLICE ||
    (caster->occupancy->count == n[0] * n[1] * n[2] &&
      (caster->shown.mode == STRATUS_MODE_COMPOSITE || caster->shown.mode == STRATUS_MODE_QUANTITIES))) {
    return STRATUS_OK;
  }
  if (!times) {
    *structure = STRATUS_STRUCTURE_DISTANCE;
    return STRATUS_OK;
  }
  if (caster->trial.map == STRATUS_STRUCTURE_HYBRID) {
    TRY(stratus_ray_tree_serves(caster, &serves));
  }
  if (!serves) {
    caster->trial = (stratus_ray_trial){ .map = STRATUS_STRUCTURE_AUTO, .build_ms = caster->trial.build_ms };
  }
  if (caster->trial.map == STRATUS_STRUCTURE_AUTO) {
    caster->trial.map = STRATUS_STRUCTURE_DISTANCE;
  }
  *structure = caster->trial.map;
  return STRATUS_OK;
}

static stratus_distance_kind kind_of(stratus_structure structure)
{
  static const stratus_distance_kind kinds[] = { [STRATUS_STRUCTURE_BLOCK] = STRATUS_DISTANCE_BLOCK,
    [STRATUS_STRUCTURE_DISTANCE] = STRATUS_DISTANCE_FULL,
    [STRATUS_STRUCTURE_OCTANT] = STRATUS_DISTANCE_OCTANT,
    [STRATUS_STRUCTURE_HYBRID] = STRATUS_DISTANCE_FULL };
  return kinds[structure];
}

static bool is_map_of(const stratus_distance_map* map, stratus_structure structure)
{
  return map && (structure == STRATUS_STRUCTURE_HYBRID ? map->tree_nodes > 0 : map->tree_nodes == 0 && map->kind == kind_of(structure));
}

stratus_status stratus_ray_make_map(stratus_ray_caster* caster, stratus_structure structure, bool offered, stratus_distance_map** out)
{
  stratus_distance_map* map = NULL;
  *out = NULL;
  if (structure == STRATUS_STRUCTURE_HYBRID && caster->occupancy->count == 0) {
    return STRATUS_OK; /* the picture is empty: no ray reads the map */
  }
  if (structure == STRATUS_STRUCTURE_HYBRID) {
    TRY(stratus_ray_tree_map(caster, offered, &map));
  } else {
    TRY(stratus_distance_map_create(caster->context, caster->occupancy, kind_of(structure), &map));
  }
  const stratus_status status = stratus_ray_modes_bounds(caster, map);
  if (status != STRATUS_OK) {
    stratus_distance_map_destroy(map);
    return status;
  }
  caster->structure_builds += structure != STRATUS_STRUCTURE_HYBRID || !offered;
  *out = map;
  return STRATUS_OK;
}

stratus_status stratus_ray_make_occupancy(stratus_ray_caster* caster)
{
  if (stratus_ray_shading_several(caster)) {
    return stratus_ray_shading_occupancy(caster);
  }
  const bool gaps = caster->shown.mode == STRATUS_MODE_COMPOSITE && caster->interpolation == STRATUS_INTERPOLATION_LINEAR;
  return stratus_occupancy_build(caster->context, caster->ranges, &caster->values, gaps, &caster->occupancy);
}

static stratus_status update_map(stratus_ray_caster* caster, stratus_structure structure, bool offered, double* ms)
{
  stratus_distance_map* map = NULL;
  if (structure == STRATUS_STRUCTURE_NONE || is_map_of(caster->map, structure)) {
    return STRATUS_OK;
  }
  const double start = stratus_now_ms();
  TRY(stratus_ray_make_map(caster, structure, offered, &map));
  if (map) {
    stratus_ray_drop_map(caster);
    caster->map = map;
    ++caster->map_serial;
    *ms = stratus_now_ms() - start;
    caster->trial.build_ms = structure == STRATUS_STRUCTURE_DISTANCE ? *ms : caster->trial.build_ms;
  }
  return STRATUS_OK;
}

stratus_status stratus_ray_update_structures(stratus_ray_caster* caster, stratus_structure wanted, bool times, stratus_structure* used,
  char* why, size_t capacity, stratus_ray_cast_report* report)
{
  bool offered = false;
  *used = wanted;
  if (!caster->occupancy && (wanted != STRATUS_STRUCTURE_NONE || caster->choice.provisional)) {
    const double start = stratus_now_ms();
    TRY(stratus_ray_make_occupancy(caster));
    ++caster->occupancy_builds;
    report->occupancy_ms = stratus_now_ms() - start;
  }
  if (wanted == STRATUS_STRUCTURE_AUTO) { /* if stratus_ray_try() measures, it adds its results */
    TRY(automatic(caster, times, used));
    snprintf(why, capacity, "%s: %s", stratus_structure_name(*used),
      caster->shown.mode == STRATUS_MODE_SLICE ? "a ray takes two samples at most"
        : *used == STRATUS_STRUCTURE_NONE      ? "every block is occupied, nothing to skip"
        : times                                ? "nothing was measured"
                                               : "a picture of samples follows from no times");
    offered = *used == STRATUS_STRUCTURE_HYBRID;
  } else {
    if (wanted == STRATUS_STRUCTURE_HYBRID) {
      TRY(stratus_ray_tree_serves(caster, &offered));
    }
    snprintf(why, capacity, "%s as asked%s", stratus_structure_name(wanted), offered ? ", the tree that came with the data" : "");
  }
  report->offered_tree = offered;
  return update_map(caster, *used, offered, &report->structure_ms);
}
