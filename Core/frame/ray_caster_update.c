/* SPDX-License-Identifier: BSD-3-Clause
 * Rebuilds what an input change makes stale. New data: value ranges. New transfer function: table, occupancy and map. New camera: nothing.
 */
#include "ray_caster.h"

#include "ray_mode.h"
#include "ray_modes_render.h"
#include "ray_sampling.h"
#include "ray_shading_render.h"
#include "ray_shading_table.h"
#include "ray_tree.h"

#include <stdio.h>
#include <string.h>

/* Updates the field, and drops what follows from its changes. */
static stratus_status update_field(
  stratus_ray_caster* caster, const stratus_volume* volume, const stratus_ray_cast_options* options, size_t rays, double* ms)
{
  stratus_ray_field_change change = { .values = false };
  const stratus_status status = stratus_ray_field_update(&caster->field, volume, options, rays, &change, ms);
  if (change.hidden) {
    stratus_ray_drop_offer_map(caster);
  }
  if (change.values) {
    stratus_ray_drop_transfer(caster);
  }
  if (change.values || change.hidden || change.grid) {
    caster->inputs.tolerance = caster->measured_for.tolerance = -1.0; /* equals none: the choice is made anew */
  }
  TRY(status);
  if (!stratus_ray_field_has_components(&caster->field)) {
    stratus_ray_shading_release(&caster->optics);
    TRY(stratus_ray_field_components(&caster->field));
  }
  return STRATUS_OK;
}

stratus_status stratus_ray_caster_find_ranges(stratus_ray_caster* caster, const stratus_volume* volume)
{
  const stratus_ray_cast_options options = stratus_ray_cast_options_default();
  double ms = 0.0;
  if (!caster) {
    return STRATUS_INVALID_ARGUMENT;
  }
  TRY(stratus_volume_check(caster->context, volume));
  return update_field(caster, volume, &options, 0, &ms);
}

stratus_status stratus_ray_update_transfer_2d(
  stratus_ray_caster* caster, const stratus_volume* volume, const stratus_ray_cast_options* options)
{
  stratus_ray_transfer_2d* kept = &caster->optics.transfer_2d;
  const stratus_transfer_2d* of = options->optics.transfer_2d;
  bool made = false;
  if (of) {
    TRY(stratus_volume_check(caster->context, volume));
    TRY(stratus_ray_transfer_2d_check(caster->context, kept, volume, options));
  }
  if (stratus_ray_transfer_2d_changes(kept, of)) {
    stratus_ray_drop_transfer(caster);
  }
  TRY(stratus_ray_transfer_2d_update(caster->context, kept, of, &made));
  caster->optics.table_serial += made;
  return STRATUS_OK;
}

static bool same_transfers(const stratus_ray_caster* caster, const stratus_transfer* transfers, int count, bool dependent)
{
  bool same = caster->optics.transfers && caster->optics.transfer_count == count && caster->optics.dependent == dependent;
  for (int i = 0; same && i < count; ++i) {
    same = stratus_transfer_same(caster->optics.transfers + i, transfers + i);
  }
  return same;
}

static stratus_status keep_transfers(stratus_ray_caster* caster, const stratus_transfer* transfers, int count, bool dependent)
{
  stratus_transfer* copy = NULL;
  TRY(stratus_transfer_copy(caster->context, transfers, count, &copy));
  stratus_ray_drop_transfer(caster);
  caster->optics.transfers = copy;
  caster->optics.transfer_count = count;
  caster->optics.dependent = dependent;
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
  if (in.shade) {
    const stratus_shading* shading = &options->light.shading;
    in.materials[0].ambient = shading->ambient;
    in.materials[0].diffuse = shading->diffuse;
    in.materials[0].specular = shading->specular;
    in.materials[0].specular_power = shading->specular_power;
    in.one_sided = shading->one_sided != 0;
    in.lights = shading->light_count;
    in.shadows = (shading->shadows != 0) + 2 * (shading->multiple != 0);
    in.scattering = shading->scattering;
    in.anisotropy = shading->anisotropy;
  }
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
  if (caster->field.followed) { /* an average's values are another component's */
    shown.average_range[0] = -INFINITY;
    shown.average_range[1] = INFINITY;
  }
  if (!same_transfers(caster, transfer, media, options->optics.dependent != 0)) {
    TRY(keep_transfers(caster, transfer, media, options->optics.dependent != 0));
    *changed = true;
  }
  if (!caster->integrator.values.of || !stratus_ray_modes_same(&caster->integrator.shown, &shown) ||
    caster->field.interpolation != options->sampling.interpolation) {
    const stratus_fetching fetching = stratus_value_range_fetching(caster->field.ranges);
    stratus_ray_drop_values(caster);
    *changed = true;
    TRY(stratus_ray_modes_values(caster->context, &shown, caster->optics.transfers, &fetching, &caster->integrator.values));
    caster->integrator.shown = shown;
    caster->field.interpolation = options->sampling.interpolation;
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
  const bool sums = caster->integrator.choice.sampling != STRATUS_SAMPLING_MIDPOINT;
  const stratus_sampling rule = sums ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT;
  const double distance =
    stratus_ray_modes_table_distance(options->mode, caster->optics.transfers, caster->integrator.choice.sample_distance);
  const int entries = stratus_table_entries_for(rule, stratus_ray_tolerance(options));
  const stratus_ray_made_table last = caster->optics.made;
  stratus_ray_made_table made = last;
  if (!table_fits(&last, sums, entries, distance)) {
    made = caster->optics.spare_table;
    if (!table_fits(&made, sums, entries, distance)) {
      const stratus_table_values values =
        stratus_table_values_of(caster->field.ranges, caster->field.interpolation == STRATUS_INTERPOLATION_NEAREST);
      made = (stratus_ray_made_table){ NULL, distance, entries, caster->optics.table_builds + 1 };
      TRY(stratus_table_create_fine(caster->context, caster->optics.transfers, &values, rule, distance, entries, &made.table));
      ++caster->optics.table_builds;
      const bool same_kind = last.table && (last.table->sums != NULL) == sums;
      stratus_table_destroy(same_kind ? last.table : caster->optics.spare_table.table);
      caster->optics.spare_table = same_kind ? caster->optics.spare_table : last;
    } else {
      caster->optics.spare_table = last;
    }
    ++caster->optics.table_serial;
  }
  if (sums) {
    stratus_table_set_distance(made.table, distance);
  }
  made.distance = distance;
  caster->optics.made = made;
  return caster->optics.shades ? stratus_ray_shading_tables_update(&caster->optics, &caster->field, caster->integrator.shown.mode,
                                   caster->integrator.choice.sample_distance)
                               : STRATUS_OK;
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
    stratus_ray_choose(caster, options, &caster->integrator.choice);
    if (caster->integrator.choice.provisional && memcmp(&caster->measured_for, &inputs, sizeof inputs) == 0) {
      caster->integrator.choice = caster->measured;
      snprintf(caster->tried, sizeof caster->tried, "as measured before");
    }
  }
}

stratus_status stratus_ray_update_tables(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_ray_cast_options* options, size_t rays, stratus_ray_cast_report* report)
{
  caster->optics.shades = stratus_ray_shading_wanted(volume, transfer, options);
  TRY(update_field(caster, volume, options, rays, &report->range_ms));
  const double start = stratus_now_ms();
  const uint64_t builds = caster->optics.table_builds;
  bool changed = !caster->optics.made.table;
  TRY(update_function(caster, volume, transfer, options, &changed));
  update_choice(caster, volume, options, changed);
  if (!caster->integrator.choice.provisional) { /* the probe makes the tables of its own choice */
    TRY(stratus_ray_update_table(caster, options));
  }
  report->table_ms = caster->optics.table_builds != builds ? stratus_now_ms() - start : 0.0;
  return STRATUS_OK;
}

bool stratus_ray_offer_is_open(const stratus_ray_caster* caster)
{
  return caster->integrator.shown.mode == STRATUS_MODE_COMPOSITE && !stratus_ray_shading_several(&caster->optics, &caster->field) &&
    stratus_ray_tree_is_offered(&caster->structure);
}

stratus_status stratus_ray_offer_serves(stratus_ray_caster* caster, bool* serves)
{
  stratus_criterion criterion = stratus_criterion_default();
  criterion.transfer = caster->optics.transfers;
  *serves = false;
  return stratus_ray_offer_is_open(caster) ? stratus_ray_tree_serves(&caster->structure, &caster->field, &criterion, serves) : STRATUS_OK;
}

/* Return the structure whose map an automatic choice draws, or tries first. stratus_ray_try() measures whether it pays. In modes that skip
 * by bounds, the number of occupied blocks never shows that nothing can be skipped. */
static stratus_status automatic(stratus_ray_caster* caster, bool times, stratus_structure* structure)
{
  const int64_t* n = caster->structure.occupancy->blocks;
  bool serves = true;
  *structure = STRATUS_STRUCTURE_NONE;
  if (caster->integrator.shown.mode == STRATUS_MODE_SLICE ||
    (caster->structure.occupancy->count == n[0] * n[1] * n[2] &&
      (caster->integrator.shown.mode == STRATUS_MODE_COMPOSITE || caster->integrator.shown.mode == STRATUS_MODE_QUANTITIES))) {
    return STRATUS_OK;
  }
  if (!times) {
    *structure = STRATUS_STRUCTURE_DISTANCE;
    return STRATUS_OK;
  }
  if (caster->trial.map == STRATUS_STRUCTURE_HYBRID) {
    TRY(stratus_ray_offer_serves(caster, &serves));
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
  if (structure == STRATUS_STRUCTURE_HYBRID && caster->structure.occupancy->count == 0) {
    return STRATUS_OK; /* the picture is empty: no ray reads the map */
  }
  if (structure == STRATUS_STRUCTURE_HYBRID) {
    TRY(stratus_ray_tree_map(caster->context, &caster->structure, offered, &map));
  } else {
    TRY(stratus_distance_map_create(caster->context, caster->structure.occupancy, kind_of(structure), &map));
  }
  const stratus_status status = stratus_ray_modes_bounds(&caster->field, caster->integrator.shown.mode, map);
  if (status != STRATUS_OK) {
    stratus_distance_map_destroy(map);
    return status;
  }
  caster->structure.structure_builds += structure != STRATUS_STRUCTURE_HYBRID || !offered;
  *out = map;
  return STRATUS_OK;
}

stratus_status stratus_ray_make_occupancy(stratus_ray_caster* caster)
{
  if (stratus_ray_shading_several(&caster->optics, &caster->field)) {
    return stratus_ray_shading_occupancy(&caster->optics, &caster->field, &caster->structure.occupancy);
  }
  const bool gaps = caster->integrator.shown.mode == STRATUS_MODE_COMPOSITE && caster->field.interpolation == STRATUS_INTERPOLATION_LINEAR;
  return stratus_occupancy_build(caster->context, caster->field.ranges, &caster->integrator.values, gaps, &caster->structure.occupancy);
}

static stratus_status update_map(stratus_ray_caster* caster, stratus_structure structure, bool offered, double* ms)
{
  stratus_distance_map* map = NULL;
  if (structure == STRATUS_STRUCTURE_NONE || is_map_of(caster->structure.map, structure)) {
    return STRATUS_OK;
  }
  const double start = stratus_now_ms();
  TRY(stratus_ray_make_map(caster, structure, offered, &map));
  if (map) {
    stratus_ray_drop_map(&caster->structure);
    caster->structure.map = map;
    ++caster->structure.map_serial;
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
  if (!caster->structure.occupancy && (wanted != STRATUS_STRUCTURE_NONE || caster->integrator.choice.provisional)) {
    const double start = stratus_now_ms();
    TRY(stratus_ray_make_occupancy(caster));
    ++caster->structure.occupancy_builds;
    report->occupancy_ms = stratus_now_ms() - start;
  }
  if (wanted == STRATUS_STRUCTURE_AUTO) { /* if stratus_ray_try() measures, it adds its results */
    TRY(automatic(caster, times, used));
    snprintf(why, capacity, "%s: %s", stratus_structure_name(*used),
      caster->integrator.shown.mode == STRATUS_MODE_SLICE ? "a ray takes two samples at most"
        : *used == STRATUS_STRUCTURE_NONE                 ? "every block is occupied, nothing to skip"
        : times                                           ? "nothing was measured"
        : caster->field.traversed.tiles.values            ? "values that it skips are not read"
                                                          : "a picture of samples follows from no times");
    offered = *used == STRATUS_STRUCTURE_HYBRID;
  } else {
    if (wanted == STRATUS_STRUCTURE_HYBRID) {
      TRY(stratus_ray_offer_serves(caster, &offered));
    }
    snprintf(why, capacity, "%s as asked%s", stratus_structure_name(wanted), offered ? ", the tree that came with the data" : "");
  }
  report->offered_tree = offered;
  return update_map(caster, *used, offered, &report->structure_ms);
}
