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
    kept->voxels = NULL;
    kept->transfer = NULL;
    stratus_ray_forget_offer(caster, false);
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

static stratus_status keep_source(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer)
{
  struct stratus_first_hit* kept = caster->first_hit;
  stratus_transfer* copy = NULL;
  const bool same = kept->transfer && stratus_volume_same_data(&kept->volume, volume);
  if (same && stratus_transfer_same_opacity(kept->transfer, transfer)) {
    return STRATUS_OK;
  }
  if (!same) {
    TRY(check_values(caster->context, volume));
  }
  TRY(stratus_transfer_copy(caster->context, transfer, 1, &copy));
  stratus_first_hit_release(caster);
  kept->transfer = copy;
  kept->volume = *volume;
  return STRATUS_OK;
}

/* A view of the volume whose world coordinates are its index coordinates. */
static stratus_volume in_index_coordinates(const stratus_volume* volume)
{
  stratus_volume plain = *volume;
  const stratus_volume defaults = stratus_volume_default();
  for (int axis = 0; axis < 3; ++axis) {
    plain.origin[axis] = volume->cell_centered ? -0.5 : 0.0;
    plain.spacing[axis] = 1.0;
  }
  memcpy(plain.direction, defaults.direction, sizeof plain.direction);
  memcpy(plain.matrix, defaults.matrix, sizeof plain.matrix);
  return plain;
}

/* ---- building */

static stratus_status update_voxels(
  stratus_ray_caster* caster, const stratus_volume* plain, const stratus_criterion* criterion, stratus_ray_cast_report* report)
{
  struct stratus_first_hit* kept = caster->first_hit;
  if (!kept->voxels) {
    const double start = stratus_now_ms();
    TRY(stratus_voxels_create(caster->context, plain, criterion, &kept->voxels));
    ++caster->occupancy_builds;
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
  ++caster->structure_builds;
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
    scene->lo[axis] = (double)lo[axis] - 0.5;
    scene->hi[axis] = lo[axis] < hi[axis] ? (double)hi[axis] - 0.5 : -1.0;
  }
}

static void tell(const stratus_first_hit_scene* scene, stratus_structure wanted, bool offered, stratus_ray_cast_report* report)
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
    offered                              ? "that comes with the data"
      : wanted == STRATUS_STRUCTURE_AUTO ? "by default"
                                         : "as asked",
    statistics.why[0] ? ": " : "", statistics.why);
}

stratus_status stratus_first_hit_update(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  stratus_structure structure, bool plain, stratus_first_hit_scene* scene, stratus_ray_cast_report* report)
{
  static const stratus_tree_method methods[] = { [STRATUS_STRUCTURE_AUTO] = STRATUS_TREE_AUTO,
    [STRATUS_STRUCTURE_BLOCK] = STRATUS_TREE_DISTANCE,
    [STRATUS_STRUCTURE_DISTANCE] = STRATUS_TREE_DISTANCE,
    [STRATUS_STRUCTURE_OCTANT] = STRATUS_TREE_OCTANT,
    [STRATUS_STRUCTURE_HYBRID] = STRATUS_TREE_HYBRID };
  const stratus_volume in_index = in_index_coordinates(volume);
  stratus_criterion criterion = stratus_criterion_default();
  bool offered = false;

  TRY(make_kept(caster));
  TRY(keep_source(caster, volume, transfer));
  struct stratus_first_hit* kept = caster->first_hit;
  criterion.transfer = transfer;
  memset(scene, 0, sizeof *scene);
  scene->used = structure == STRATUS_STRUCTURE_AUTO ? STRATUS_STRUCTURE_HYBRID : structure;
  if (scene->used == STRATUS_STRUCTURE_HYBRID) {
    TRY(stratus_ray_tree_serves_first_hits(caster, &in_index, &criterion, &offered, &report->structure_ms));
  }
  if (!offered || plain) {
    TRY(update_voxels(caster, &in_index, &criterion, report));
  }
  scene->voxels = kept->voxels;
  if (offered) {
    scene->tree = caster->offered;
  } else if (scene->used != STRATUS_STRUCTURE_NONE) {
    TRY(update_tree(caster, methods[structure], report));
    scene->tree = kept->tree;
    if (structure == STRATUS_STRUCTURE_AUTO && scene->tree->statistics.method == STRATUS_TREE_OCTANT) {
      scene->used = STRATUS_STRUCTURE_OCTANT;
    }
  }
  bounds_of(scene->tree, scene->voxels, scene);
  tell(scene, structure, offered, report);
  return STRATUS_OK;
}
