/* SPDX-License-Identifier: BSD-3-Clause
 * Partitions of meshes, and visibility orders, which name every cell exactly once. */
#include "fuzz.h"

#include <stdlib.h>

/* ---- partitions */

static stratus_partition_options choose_options(fuzz* f)
{
  stratus_partition_options o = CALL(stratus_partition_options_default());
  o.rule = (stratus_partition_rule)fuzz_choice(f, 2);
  o.depth = fuzz_integer(f, 0, fuzz_chance(f, 0.9) ? 4 : 7);
  o.depth = o.depth > 7 && o.depth <= 16 ? 17 : o.depth; /* at 16 levels ten overlapping cells give millions of pieces */
  o.planes = fuzz_integer(f, 1, fuzz_chance(f, 0.8) ? 80 : 4096);
  o.growth = fuzz_chance(f, 0.5) ? o.growth : fuzz_real(f, 0.01, 2.0);
  o.imbalance = fuzz_real(f, 0.01, 3.0);
  o.rotations = fuzz_chance(f, 0.6) ? 0 : fuzz_integer(f, 0, fuzz_chance(f, 0.8) ? 4 : 64);
  o.leaf_cells = fuzz_odd(f) ? fuzz_odd_integer(f) : 1 + (int64_t)fuzz_below(f, 60);
  return o;
}

static void check_nodes(fuzz* f, const stratus_leaves* leaves)
{
  EXPECT(leaves->node_count >= 1 && leaves->leaf_count >= 1 && leaves->leaf_count <= 65536, "%d nodes, %d leaves", leaves->node_count,
    leaves->leaf_count);
  for (int32_t n = 0; n < leaves->node_count; ++n) {
    const stratus_partition_node* node = leaves->nodes + n;
    EXPECT(node->axis >= -1 && node->axis <= 2 && node->reserved == 0, "node %d has axis %d", n, node->axis);
    if (node->axis < 0) {
      EXPECT(node->below >= 0 && node->below < leaves->leaf_count, "node %d is leaf %d", n, node->below);
    } else {
      EXPECT(node->below > n && node->below < leaves->node_count && node->above > n && node->above < leaves->node_count,
        "node %d over %d, %d", n, node->below, node->above);
      EXPECT(isfinite(node->value), "node %d cuts at %g", n, node->value);
    }
  }
}

static void check_partition(fuzz* f, const stratus_mesh* mesh, const stratus_partition_result* r)
{
  check_nodes(f, &r->leaves);
  EXPECT(r->old_points == mesh->point_count && r->point_count >= r->old_points, "%lld points of %lld", (long long)r->point_count,
    (long long)mesh->point_count);
  EXPECT(r->old_points == 0 || memcmp(r->points, mesh->points, (size_t)r->old_points * 3 * sizeof(double)) == 0, "points have moved");
  for (int64_t p = r->old_points; p < r->point_count; ++p) {
    const int32_t* ends = r->ends + 2 * (p - r->old_points);
    const double weight = r->weights[p - r->old_points];
    EXPECT(ends[0] >= 0 && ends[0] < p && ends[1] >= 0 && ends[1] < p && weight > 0.0 && weight < 1.0, "point %lld between %d and %d at %g",
      (long long)p, ends[0], ends[1], weight);
    EXPECT(isfinite(r->points[3 * p]) && isfinite(r->points[3 * p + 1]) && isfinite(r->points[3 * p + 2]), "point %lld is no point",
      (long long)p);
  }
  for (int64_t c = 0; c < r->cell_count; ++c) {
    EXPECT(r->cells[c] >= 0 && r->cells[c] < mesh->cell_count && r->leaves.leaf[c] >= 0 && r->leaves.leaf[c] < r->leaves.leaf_count,
      "cell %lld of %d in leaf %d", (long long)c, r->cells[c], r->leaves.leaf[c]);
    for (int v = 0; v < 4; ++v) {
      EXPECT(r->vertices[4 * c + v] >= 0 && r->vertices[4 * c + v] < r->point_count, "cell %lld names point %d", (long long)c,
        r->vertices[4 * c + v]);
    }
  }
  ++f->tally->compared;
}

stratus_partition* fuzz_partition(fuzz* f, const stratus_mesh* mesh, stratus_partition_result* result)
{
  stratus_partition* partition = NULL;
  const stratus_partition_options o = choose_options(f);
  const stratus_partition_options* options = fuzz_chance(f, 0.1) ? NULL : FUZZ_INPUT(f, o);
  if (fuzz_chance(f, 0.1)) {
    fuzz_trouble(f);
  }
  const stratus_status status = CREATE(&partition, stratus_partition_create(f->context, mesh, options, &partition));
  const bool troubled = f->memory.refused + f->progress.cancelled > 0;
  fuzz_calm(f);
  EXPECT(status == STRATUS_OK || troubled || !fuzz_is_tame(f), "%s", stratus_context_message(f->context));
  if (status == STRATUS_OK) {
    CALL(stratus_partition_get(partition, result));
    check_partition(f, mesh, result);
  }
  return partition;
}

/* ---- orders */

static void check_order(fuzz* f, const stratus_mesh* mesh, const stratus_visibility_result* r)
{
  EXPECT(r->count == mesh->cell_count, "%lld of %lld cells", (long long)r->count, (long long)mesh->cell_count);
  uint8_t* met = calloc((size_t)mesh->cell_count + 1, 1);
  for (int64_t i = 0; met && i < r->count; ++i) {
    EXPECT(r->cells[i] < mesh->cell_count && !met[r->cells[i]], "cell %u comes twice, or is none", r->cells[i]);
    met[r->cells[i]] = 1;
  }
  free(met);
  EXPECT(r->cycles >= 0 && r->forced >= 0 && r->exact_signs >= 0 && r->flat >= 0 && r->folded >= 0 && r->inverted >= 0 && r->layers >= 0,
    "a count below 0");
  EXPECT(r->reused == 0 || r->reused == 1, "reused %d", r->reused);
  ++f->tally->compared;
}

static void sort(fuzz* f, stratus_visibility_order* order, const stratus_mesh* mesh, const double bounds[6])
{
  const uint64_t times = 1 + fuzz_below(f, 4);
  double matrix[16];
  stratus_camera camera = fuzz_camera(f, bounds);
  for (uint64_t n = 0; n < times; ++n) {
    stratus_visibility_result* result = fuzz_output(f, sizeof *result);
    const stratus_peeling peeling = (stratus_peeling)fuzz_choice(f, 2);
    fuzz_matrix(f, matrix);
    const double* world = fuzz_chance(f, 0.6) ? NULL : FUZZ_INPUT(f, matrix);
    camera = fuzz_chance(f, 0.3) ? camera : fuzz_camera(f, bounds);
    if (fuzz_chance(f, 0.1)) {
      fuzz_trouble(f);
    }
    const stratus_status status =
      STATUS(stratus_visibility_order_sort(order, fuzz_pointer(f, FUZZ_INPUT(f, camera)), world, peeling, result));
    const bool troubled = f->memory.refused + f->progress.cancelled > 0;
    fuzz_calm(f);
    EXPECT(status == STRATUS_OK || troubled || !fuzz_is_tame(f), "%s", stratus_context_message(f->context));
    if (status == STRATUS_OK) {
      check_order(f, mesh, result);
    }
  }
}

/* Leaves of random numbers, which no partition made. */
static stratus_leaves choose_leaves(fuzz* f, const stratus_mesh* mesh)
{
  stratus_partition_node nodes[3] = { { .axis = 0, .below = 1, .above = 2, .value = 1.0 }, { .axis = -1 }, { .axis = -1, .below = 1 } };
  stratus_leaves leaves = { .node_count = 3, .leaf_count = 2, .frame = { 1, 0, 0, 0, 1, 0, 0, 0, 1 } };
  for (int n = 0; n < 3; ++n) {
    nodes[n].axis = fuzz_integer(f, nodes[n].axis, nodes[n].axis);
    nodes[n].below = fuzz_integer(f, nodes[n].below, nodes[n].below);
    nodes[n].above = fuzz_integer(f, nodes[n].above, nodes[n].above);
    nodes[n].value = fuzz_real(f, 0.0, 3.0);
    nodes[n].reserved = fuzz_integer(f, 0, 0);
  }
  for (int i = 0; i < 9; ++i) {
    leaves.frame[i] = fuzz_odd(f) ? fuzz_odd_real(f) : leaves.frame[i];
  }
  const size_t cells = mesh->cell_count > 0 && mesh->cell_count < 100000 ? (size_t)mesh->cell_count : 0;
  int32_t* leaf = calloc(cells + 1, sizeof *leaf);
  for (size_t c = 0; leaf && c < cells; ++c) {
    leaf[c] = fuzz_integer(f, 0, fuzz_chance(f, 0.9) ? 0 : 1);
  }
  leaves.nodes = fuzz_pointer(f, FUZZ_INPUT(f, nodes));
  leaves.leaf = fuzz_pointer(f, fuzz_input(f, leaf, cells * sizeof *leaf));
  free(leaf);
  leaves.node_count = fuzz_odd(f) ? -(int)fuzz_below(f, 5) : 3;
  leaves.leaf_count = fuzz_odd(f) ? fuzz_integer(f, -1, 65537) : 2;
  return leaves;
}

static void order_of(fuzz* f, const stratus_mesh* mesh, const stratus_leaves* leaves, const double bounds[6], bool right)
{
  stratus_visibility_order* order = NULL;
  if (fuzz_chance(f, 0.1)) {
    fuzz_trouble(f);
  }
  const stratus_status status = CREATE(&order, stratus_visibility_order_create(f->context, mesh, leaves, &order));
  const bool troubled = f->memory.refused + f->progress.cancelled > 0;
  fuzz_calm(f);
  EXPECT(status == STRATUS_OK || troubled || !right, "%s", stratus_context_message(f->context));
  if (status == STRATUS_OK) {
    sort(f, order, mesh, bounds);
    CALL(stratus_visibility_order_destroy(order));
  }
}

void fuzz_orders(fuzz* f)
{
  const fuzz_tetrahedra t = fuzz_mesh(f, fuzz_chance(f, 0.2) ? 6 : 3);
  const stratus_mesh* mesh = fuzz_pointer(f, FUZZ_INPUT(f, t.view));
  fuzz_about(f, "%lld points, %lld cells, sound %d", (long long)t.view.point_count, (long long)t.view.cell_count, t.sound);
  (void)STATUS(stratus_mesh_check(f->context, mesh));
  order_of(f, mesh, NULL, t.bounds, fuzz_is_tame(f));
  stratus_partition_result r;
  stratus_partition* partition = fuzz_partition(f, mesh, &r);
  if (partition) {
    stratus_mesh cut = t.view;
    cut.points = r.points;
    cut.point_count = r.point_count;
    cut.vertices = r.vertices;
    cut.cell_count = r.cell_count;
    cut.values = NULL;
    cut.hidden = NULL;
    fuzz_about(
      f, "%lld cells of %lld, %d leaves, sound %d", (long long)cut.cell_count, (long long)t.view.cell_count, r.leaves.leaf_count, t.sound);
    order_of(f, FUZZ_INPUT(f, cut), FUZZ_INPUT(f, r.leaves), t.bounds, fuzz_is_tame(f));
  }
  if (mesh && fuzz_chance(f, 0.3)) {
    const stratus_leaves leaves = choose_leaves(f, mesh);
    order_of(f, mesh, FUZZ_INPUT(f, leaves), t.bounds, false);
  }
  CALL(stratus_partition_destroy(partition));
}
