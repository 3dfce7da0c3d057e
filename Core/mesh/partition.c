/* SPDX-License-Identifier: BSD-3-Clause
 * Partitions a mesh by a K-D tree (Li et al. 2012, section 2). A cut also divides cells of the adjacent leaves, so cutting goes level by
 * level: those leaves exist by then. */
#include "partition_build.h"

#include <string.h>

#define DEPTH_MAX 16
#define PLANES_MAX 4096
#define ROTATIONS_MAX 64

stratus_partition_options stratus_partition_options_default(void)
{
  return (stratus_partition_options){
    .rule = STRATUS_PARTITION_MEDIAN, .depth = 3, .planes = 64, .growth = INFINITY, .imbalance = 0.5, .rotations = 0, .leaf_cells = 1024
  };
}

static stratus_status check_options(stratus_context* context, const stratus_partition_options* options)
{
  if (options->rule != STRATUS_PARTITION_MEDIAN && options->rule != STRATUS_PARTITION_PAPER) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "partition rule %d outside %d..%d", (int)options->rule, STRATUS_PARTITION_MEDIAN,
      STRATUS_PARTITION_PAPER);
  }
  if (options->depth < 0 || options->depth > DEPTH_MAX) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "partition depth %d outside 0..%d", options->depth, DEPTH_MAX);
  }
  if (options->planes < 1 || options->planes > PLANES_MAX) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "partition planes %d outside 1..%d", options->planes, PLANES_MAX);
  }
  if (!(options->growth > 0.0)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "partition growth %g, must be positive", options->growth);
  }
  if (!(options->imbalance > 0.0)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "partition imbalance %g, must be positive", options->imbalance);
  }
  if (options->rotations < 0 || options->rotations > ROTATIONS_MAX) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "partition rotations %d outside 0..%d", options->rotations, ROTATIONS_MAX);
  }
  if (options->leaf_cells < 1) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "partition leaf_cells %lld, must be at least 1", (long long)options->leaf_cells);
  }
  return STRATUS_OK;
}

/* The frame of a rotation; 0 is the identity. No small multiple of the angles is a full turn, so every rotation is a new one. */
static void make_frame(int rotation, double frame[9])
{
  const double a = 0.7 * rotation, b = 0.43 * rotation;
  const double turned[9] = { cos(a), -sin(a) * cos(b), sin(a) * sin(b), sin(a), cos(a) * cos(b), -cos(a) * sin(b), 0.0, sin(b), cos(b) };
  const double identity[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  memcpy(frame, rotation == 0 ? identity : turned, sizeof identity);
}

static stratus_status see_in_frame(stratus_partition* partition, int rotation)
{
  make_frame(rotation, partition->frame);
  if (rotation == 0) {
    partition->along = partition->points;
    return STRATUS_OK;
  }
  if (partition->along == partition->points) {
    partition->along = NULL;
  }
  TRY(stratus_kdtree_reserve(partition->context, (void**)&partition->along, &partition->along_capacity, (size_t)partition->point_count, 0,
    3 * sizeof *partition->along));
  for (int64_t i = 0; i < 3 * partition->point_count; ++i) {
    const double *p = partition->points + 3 * (i / 3), *row = partition->frame + 3 * (i % 3);
    partition->along[i] = row[0] * p[0] + row[1] * p[1] + row[2] * p[2];
  }
  partition->rotations = rotation;
  return STRATUS_OK;
}

/* The largest coordinate of the cells' points. Other points may lie anywhere. */
static double largest_coordinate(const stratus_mesh* mesh)
{
  double largest = 0.0;
  for (int64_t i = 0; i < 12 * mesh->cell_count; ++i) {
    largest = fmax(largest, fabs(mesh->points[3 * (int64_t)mesh->vertices[i / 3] + i % 3]));
  }
  return largest;
}

static stratus_status take_mesh(stratus_partition* partition, const stratus_mesh* mesh)
{
  stratus_context* context = partition->context;
  const size_t points = (size_t)mesh->point_count, cells = (size_t)mesh->cell_count;
  void* memory;
  TRY(stratus_kdtree_reserve(context, (void**)&partition->points, &partition->point_capacity, points, 0, 3 * sizeof(double)));
  if (points > 0) {
    memcpy(partition->points, mesh->points, points * 3 * sizeof(double));
  }
  partition->point_count = partition->old_points = mesh->point_count;
  TRY(stratus_allocate_zero(context, cells, sizeof *partition->cut, &memory));
  partition->cut = memory;
  TRY(stratus_kdtree_reserve(context, (void**)&partition->nodes, &partition->node_capacity, 1, 0, sizeof *partition->nodes));
  stratus_kdtree_node* root = partition->nodes;
  *root = (stratus_kdtree_node){ .box = { -INFINITY, INFINITY, -INFINITY, INFINITY, -INFINITY, INFINITY }, .plane = { .axis = -1 } };
  partition->node_count = 1;
  TRY(stratus_kdtree_reserve(context, (void**)&root->cells, &root->capacity, cells, 0, sizeof *root->cells));
  for (size_t i = 0; i < cells; ++i) {
    memcpy(root->cells[i].vertex, mesh->vertices + 4 * i, sizeof root->cells[i].vertex);
    root->cells[i].origin = (int32_t)i;
  }
  root->count = mesh->cell_count;
  partition->tolerance = STRATUS_PLANE_TOLERANCE * largest_coordinate(mesh);
  return see_in_frame(partition, 0);
}

/* Chooses the root's plane, turning the frame until there is an admissible one. */
static stratus_status choose_root_plane(stratus_partition* partition, stratus_kdtree_plane* plane)
{
  for (int rotation = 0; rotation <= partition->options.rotations; ++rotation) {
    TRY(see_in_frame(partition, rotation));
    TRY(stratus_kdtree_choose_plane(partition, partition->nodes, plane));
    if (plane->axis >= 0) {
      return STRATUS_OK;
    }
  }
  return STRATUS_OK;
}

static stratus_status cut_levels(stratus_partition* partition)
{
  int32_t begin = 0;
  for (int level = 0; level < partition->options.depth; ++level) {
    const int32_t end = partition->node_count;
    for (int32_t n = begin; n < end; ++n) {
      stratus_kdtree_plane plane;
      if (partition->nodes[n].count <= partition->options.leaf_cells) {
        continue;
      }
      if (n == 0) {
        TRY(choose_root_plane(partition, &plane));
      } else {
        TRY(stratus_kdtree_choose_plane(partition, partition->nodes + n, &plane));
      }
      if (plane.axis >= 0) {
        TRY(stratus_kdtree_cut(partition, n, &plane));
      }
      TRY(stratus_progress(partition->context, "partition", (level + (n - begin + 1.0) / (end - begin)) / partition->options.depth));
    }
    begin = end;
  }
  return STRATUS_OK;
}

static stratus_status make_result(stratus_partition* partition)
{
  stratus_context* context = partition->context;
  void* memory;
  partition->cell_count = 0;
  for (int32_t n = 0; n < partition->node_count; ++n) {
    partition->cell_count += partition->nodes[n].count;
  }
  if (partition->cell_count > INT32_MAX / 2) {
    return stratus_fail(context, STRATUS_OVERFLOW, "partition: %lld cells, at most %d", (long long)partition->cell_count, INT32_MAX / 2);
  }
  const size_t cells = (size_t)partition->cell_count;
  TRY(stratus_allocate(context, cells, 4 * sizeof *partition->vertices, &memory));
  partition->vertices = memory;
  TRY(stratus_allocate(context, cells, sizeof *partition->cells, &memory));
  partition->cells = memory;
  TRY(stratus_allocate(context, cells, sizeof *partition->leaf, &memory));
  partition->leaf = memory;
  TRY(stratus_allocate(context, (size_t)partition->node_count, sizeof *partition->tree, &memory));
  partition->tree = memory;
  int64_t cell = 0;
  for (int32_t n = 0; n < partition->node_count; ++n) {
    stratus_kdtree_node* node = partition->nodes + n;
    partition->tree[n] = node->plane;
    if (node->plane.axis >= 0) {
      continue;
    }
    partition->tree[n].below = partition->leaf_count;
    TRY(stratus_kdtree_list_cells(partition, node));
    partition->largest_leaf = node->count > partition->largest_leaf ? node->count : partition->largest_leaf;
    for (int64_t i = 0; i < node->count; ++i, ++cell) {
      memcpy(partition->vertices + 4 * cell, node->cells[i].vertex, sizeof node->cells[i].vertex);
      partition->cells[cell] = node->cells[i].origin;
      partition->leaf[cell] = partition->leaf_count;
    }
    ++partition->leaf_count;
    stratus_release(context, node->cells);
    node->cells = NULL;
  }
  stratus_release(context, partition->cut);
  partition->cut = NULL;
  return STRATUS_OK;
}

stratus_status stratus_partition_create(
  stratus_context* context, const stratus_mesh* mesh, const stratus_partition_options* options, stratus_partition** out)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!out) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "partition is NULL");
  }
  const stratus_partition_options defaults = stratus_partition_options_default();
  void* memory = NULL;
  TRY(check_options(context, options ? options : &defaults));
  TRY(stratus_mesh_check_listed(context, mesh));
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_partition), &memory));
  stratus_partition* partition = memory;
  partition->context = context;
  partition->options = options ? *options : defaults;
  stratus_status status = STRATUS_OK;
  const stratus_stage stage = stratus_stage_begin(context);
  TRY_CLEANUP(take_mesh(partition, mesh));
  TRY_CLEANUP(cut_levels(partition));
  TRY_CLEANUP(make_result(partition));
  stratus_stage_end(context, &stage, "partition",
    (size_t)partition->cell_count * (4 * sizeof *partition->vertices + sizeof *partition->cells + sizeof *partition->leaf) +
      (size_t)partition->point_count * 3 * sizeof *partition->points + (size_t)partition->node_count * sizeof *partition->tree);
  *out = partition;
  return STRATUS_OK;

cleanup:
  stratus_partition_destroy(partition);
  return status;
}
