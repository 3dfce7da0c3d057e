/* SPDX-License-Identifier: BSD-3-Clause
 * Structures of first-hit pictures: data and opacity -> voxels -> tree. Each is kept until its input changes. */
#include "first_hit_picture.h"

#include "ray_caster.h"
#include "ray_tree.h"
#include "tree.h"

#include <stdio.h>
#include <string.h>

static void drop_tree(struct stratus_first_hit* kept)
{
  stratus_tree_destroy(kept->tree);
  kept->tree = NULL;
}

void stratus_first_hit_release(stratus_ray_caster* caster)
{
  struct stratus_first_hit* kept = caster->first_hit;
  if (kept) {
    drop_tree(kept);
    stratus_voxels_destroy(kept->voxels);
    stratus_release(caster->context, kept->transfer);
    stratus_release(caster->context, kept->hidden);
    kept->voxels = NULL;
    kept->transfer = NULL;
    kept->hidden = NULL;
    kept->mask = NULL;
    stratus_ray_forget_offer(&caster->structure, false);
  }
}

void stratus_first_hit_destroy(stratus_ray_caster* caster)
{
  if (caster->first_hit) {
    stratus_first_hit_release(caster);
    stratus_release(caster->context, caster->first_hit);
    caster->first_hit = NULL;
  }
}

static stratus_status make_kept(stratus_ray_caster* caster)
{
  void* memory = NULL;
  if (!caster->first_hit) {
    TRY(stratus_allocate_zero(caster->context, 1, sizeof(struct stratus_first_hit), &memory));
    caster->first_hit = memory;
  }
  return STRATUS_OK;
}

/* ---- what changed */

/* Which voxels show is decided in doubles; their colours and normals are of the floats that rays read. */
static stratus_status check_values(stratus_context* context, const stratus_volume* volume)
{
  const double bias = stratus_volume_bias(volume);
  return volume->type != STRATUS_FLOAT64 || stratus_volume_floats_differ(volume, bias) ? STRATUS_OK
                                                                                       : stratus_volume_check_floats(context, volume, bias);
}

/* Makes the flags of values that are hidden, or that the mask hides. NULL: there is no mask. */
static stratus_status make_hidden(stratus_context* context, const stratus_volume* volume, const uint8_t* mask, uint8_t** hidden)
{
  const size_t values = (size_t)volume->dimensions[0] * (size_t)volume->dimensions[1] * (size_t)volume->dimensions[2];
  const uint8_t* ghosts = volume->cell_centered ? volume->cell_ghosts : volume->point_ghosts;
  const int flag = volume->cell_centered ? STRATUS_GHOST_HIDDEN_CELL : STRATUS_GHOST_HIDDEN_POINT;
  void* memory = NULL;
  *hidden = NULL;
  if (mask) {
    TRY(stratus_allocate(context, values, 1, &memory));
    *hidden = memory;
    for (size_t i = 0; i < values; ++i) {
      (*hidden)[i] = (uint8_t)((ghosts ? ghosts[i] : 0) | (mask[i] ? 0 : flag));
    }
  }
  return STRATUS_OK;
}

static stratus_status keep_source(
  stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer, const stratus_ray_mask_options* mask)
{
  struct stratus_first_hit* kept = caster->first_hit;
  stratus_transfer* copy = NULL;
  uint8_t* hidden = NULL;
  const bool same = kept->transfer && stratus_volume_same_data(&kept->volume, volume);
  const bool same_mask = kept->mask == mask->bytes && (!mask->bytes || kept->mask_revision == mask->revision);
  if (same && same_mask && stratus_transfer_same_opacity(kept->transfer, transfer)) {
    return STRATUS_OK;
  }
  if (!same) {
    TRY(check_values(caster->context, volume));
  }
  TRY(make_hidden(caster->context, volume, mask->bytes, &hidden));
  const stratus_status status = stratus_transfer_copy(caster->context, transfer, 1, &copy);
  if (status != STRATUS_OK) {
    stratus_release(caster->context, hidden);
    return status;
  }
  stratus_first_hit_release(caster);
  kept->transfer = copy;
  kept->volume = *volume;
  kept->hidden = hidden;
  kept->mask = mask->bytes;
  kept->mask_revision = mask->revision;
  return STRATUS_OK;
}

/* A view of the volume whose world coordinates are its index coordinates. hidden: NULL, or flags in place of its own. */
static stratus_volume in_index_coordinates(const stratus_volume* volume, const uint8_t* hidden)
{
  stratus_volume plain = *volume;
  if (hidden) {
    *(volume->cell_centered ? &plain.cell_ghosts : &plain.point_ghosts) = hidden;
  }
  const stratus_volume defaults = stratus_volume_default();
  for (int axis = 0; axis < 3; ++axis) {
    plain.origin[axis] = volume->cell_centered ? -0.5 : 0.0;
    plain.spacing[axis] = 1.0;
    plain.coordinates[axis] = NULL;
  }
  memcpy(plain.direction, defaults.direction, sizeof plain.direction);
  memcpy(plain.matrix, defaults.matrix, sizeof plain.matrix);
  return plain;
}

/* ---- borders */

/* Sets the borders of n voxels, at[-1] .. at[STRATUS_BORDERS_BEYOND(n)]. x: coordinates of n values, or of n + 1 borders of cells. */
static void set_borders(const double* x, int64_t n, bool cells, double* at)
{
  const double whole = cells ? (double)n : (double)(n - 1), per_unit = whole / (x[cells ? n : n - 1] - x[0]);
  for (int64_t i = 0; i <= n; ++i) {
    if (cells) { /* there may be only one cell */
      at[i] = (x[i] - x[0]) * per_unit;
      continue;
    }
    const int64_t below = i > 0 ? i - 1 : 0, above = i < n ? i : n - 1;
    const double middle = 0.5 * ((x[below] - x[0]) + (x[above] - x[0]));
    const double outwards = i == 0 ? 0.5 * (x[0] - x[1])
      : i == n                     ? 0.5 * (x[n - 1] - x[n - 2])
                                   : 0.0; /* the ends reach as far as inwards */
    at[i] = (middle + outwards) * per_unit + 0.5;
  }
  at[-1] = at[0] - 1.0;
  for (int64_t i = n + 1; i <= STRATUS_BORDERS_BEYOND(n); ++i) {
    at[i] = at[i - 1] + 1.0;
  }
}

stratus_status stratus_first_hit_borders(
  stratus_context* context, const stratus_volume* volume, stratus_voxel_borders* borders, void** memory)
{
  const int64_t* n = volume->dimensions;
  size_t count = 0;
  *borders = (stratus_voxel_borders){ { NULL, NULL, NULL } };
  for (int axis = 0; axis < 3; ++axis) {
    count += (size_t)STRATUS_BORDERS_BEYOND(n[axis]) + 2;
  }
  TRY(stratus_allocate(context, count, sizeof(double), memory));
  double* at = *memory;
  for (int axis = 0; axis < 3; ++axis) {
    if (volume->coordinates[axis]) {
      set_borders(volume->coordinates[axis], n[axis], volume->cell_centered != 0, at + 1);
      borders->at[axis] = at + 1;
    }
    at += STRATUS_BORDERS_BEYOND(n[axis]) + 2;
  }
  return STRATUS_OK;
}

/* ---- building */

static stratus_status update_voxels(
  stratus_ray_caster* caster, const stratus_volume* plain, const stratus_criterion* criterion, stratus_ray_cast_report* report)
{
  struct stratus_first_hit* kept = caster->first_hit;
  if (!kept->voxels) {
    const double start = stratus_now_ms();
    TRY(stratus_voxels_create(caster->context, plain, criterion, &kept->voxels));
    ++caster->structure.occupancy_builds;
    report->occupancy_ms = stratus_now_ms() - start;
  }
  return STRATUS_OK;
}

static stratus_status update_tree(stratus_ray_caster* caster, stratus_tree_method method, stratus_ray_cast_report* report)
{
  struct stratus_first_hit* kept = caster->first_hit;
  if (kept->tree && kept->method == method) {
    return STRATUS_OK;
  }
  const double start = stratus_now_ms();
  stratus_tree_options options = stratus_tree_options_default();
  stratus_tree* tree = NULL;
  options.method = method;
  TRY(stratus_tree_create(caster->context, kept->voxels, &options, &tree));
  drop_tree(kept);
  kept->tree = tree;
  kept->method = method;
  ++caster->structure.structure_builds;
  report->structure_ms = stratus_now_ms() - start;
  return STRATUS_OK;
}

static void bounds_of(const stratus_tree* tree, const stratus_voxels* voxels, stratus_first_hit_scene* scene)
{
  int64_t lo[3] = { 0, 0, 0 }, hi[3] = { 0, 0, 0 };
  if (voxels) {
    stratus_voxels_bounds(voxels, lo, hi);
  } else if (tree->node_count > 0) {
    for (int axis = 0; axis < 3; ++axis) {
      lo[axis] = tree->nodes[0].lo[axis];
      hi[axis] = tree->nodes[0].hi[axis];
    }
  }
  for (int axis = 0; axis < 3; ++axis) { /* an empty box becomes reversed: lo > hi */
    const bool any = lo[axis] < hi[axis];
    scene->lo[axis] = any ? stratus_voxel_border(scene->borders, axis, lo[axis]) - 0.5 : -0.5;
    scene->hi[axis] = any ? stratus_voxel_border(scene->borders, axis, hi[axis]) - 0.5 : -1.0;
  }
}

/* Why a structure is used, in words. */
static const char* reason_of(const stratus_first_hit_scene* scene, stratus_structure wanted, bool offered)
{
  const bool other = scene->borders && wanted == STRATUS_STRUCTURE_HYBRID;
  return offered                       ? "that comes with the data"
    : other                            ? "for the spacing changes"
    : wanted == STRATUS_STRUCTURE_AUTO ? "by default"
                                       : "as asked";
}

static void report_scene(const stratus_first_hit_scene* scene, stratus_structure wanted, bool offered, stratus_ray_cast_report* report)
{
  stratus_tree_statistics statistics = { .why = "" };
  report->structure = scene->used;
  report->offered_tree = offered;
  if (scene->tree) {
    stratus_tree_get_statistics(scene->tree, &statistics);
    report->structure_bytes = statistics.bytes;
    report->occupied_blocks = (uint64_t)statistics.bricks;
  } else {
    report->occupied_blocks = (uint64_t)scene->voxels->brick_count;
  }
  snprintf(report->why, sizeof report->why, "first hits, %s %s%s%.150s", stratus_structure_name(scene->used),
    reason_of(scene, wanted, offered), statistics.why[0] ? ": " : "", statistics.why);
}

stratus_status stratus_first_hit_update(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_voxel_borders* borders, const stratus_ray_cast_options* options, stratus_first_hit_scene* scene,
  stratus_ray_cast_report* report)
{
  static const stratus_tree_method methods[] = { [STRATUS_STRUCTURE_AUTO] = STRATUS_TREE_AUTO,
    [STRATUS_STRUCTURE_BLOCK] = STRATUS_TREE_DISTANCE,
    [STRATUS_STRUCTURE_DISTANCE] = STRATUS_TREE_DISTANCE,
    [STRATUS_STRUCTURE_OCTANT] = STRATUS_TREE_OCTANT,
    [STRATUS_STRUCTURE_HYBRID] = STRATUS_TREE_HYBRID };
  const stratus_structure structure = options->skipping.structure;
  stratus_criterion criterion = stratus_criterion_default();
  bool offered = false;

  TRY(make_kept(caster));
  TRY(keep_source(caster, volume, transfer, &options->mask));
  struct stratus_first_hit* kept = caster->first_hit;
  const stratus_volume in_index = in_index_coordinates(volume, kept->hidden);
  criterion.transfer = transfer;
  memset(scene, 0, sizeof *scene);
  scene->borders = borders;
  scene->used = structure == STRATUS_STRUCTURE_AUTO ? STRATUS_STRUCTURE_HYBRID : structure;
  if (borders && scene->used == STRATUS_STRUCTURE_HYBRID) { /* rays among voxels of any widths know one field */
    scene->used = STRATUS_STRUCTURE_OCTANT;
  }
  const stratus_tree_method method = methods[borders ? scene->used : structure];
  if (scene->used == STRATUS_STRUCTURE_HYBRID && !kept->mask) { /* an offered tree knows of no mask */
    TRY(stratus_ray_tree_serves_first_hits(caster->context, &caster->structure, &in_index, &criterion, &offered, &report->structure_ms));
  }
  if (!offered || options->skipping.audit) {
    TRY(update_voxels(caster, &in_index, &criterion, report));
  }
  scene->voxels = kept->voxels;
  if (offered) {
    scene->tree = caster->structure.offered;
  } else if (scene->used != STRATUS_STRUCTURE_NONE) {
    TRY(update_tree(caster, method, report));
    scene->tree = kept->tree;
    if (structure == STRATUS_STRUCTURE_AUTO && scene->tree->statistics.method == STRATUS_TREE_OCTANT) {
      scene->used = STRATUS_STRUCTURE_OCTANT;
    }
  }
  bounds_of(scene->tree, scene->voxels, scene);
  report_scene(scene, structure, offered, report);
  return STRATUS_OK;
}
