/* SPDX-License-Identifier: BSD-3-Clause
 * The visibility order of a mesh's cells (Williams 1992; Li et al. 2012). Neighbours and gaps are found once for a mesh. Each view then
 * finds the signs of all faces, and peels the leaves of the K-D tree, both in parallel. */
#include "visibility_order.h"

#include "device.h"
#include "matrix.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

#define CELLS_PER_GATE 8     /* peeling a gate takes about as long as this many cells */
#define COORDINATE_MAX 1e300 /* so that differences of coordinates are finite */

static stratus_status find_bounds(stratus_visibility_order* order)
{
  double* b = order->bounds;
  double lx = INFINITY, ly = INFINITY, lz = INFINITY, hx = -INFINITY, hy = -INFINITY, hz = -INFINITY;
#pragma omp parallel for schedule(static) num_threads(order->context->threads) reduction(min : lx, ly, lz) reduction(max : hx, hy, hz)
  for (int64_t i = 0; i < order->point_count; ++i) {
    const double* p = order->points + 3 * i;
    lx = fmin(lx, p[0]);
    ly = fmin(ly, p[1]);
    lz = fmin(lz, p[2]);
    hx = fmax(hx, p[0]);
    hy = fmax(hy, p[1]);
    hz = fmax(hz, p[2]);
  }
  if (order->point_count > 0) {
    memcpy(b, (const double[]){ lx, hx, ly, hy, lz, hz }, 6 * sizeof *b);
  }
  for (int i = 0; i < 6; ++i) {
    if (!(fabs(b[i]) <= COORDINATE_MAX)) {
      return stratus_fail(order->context, STRATUS_INVALID_ARGUMENT, "mesh reaches %g, beyond +-%g", b[i], COORDINATE_MAX);
    }
  }
  return STRATUS_OK;
}

/* Each leaf is peeled by one thread. */
static int peeling_threads(const stratus_visibility_order* order)
{
  return order->leaf_count < order->context->threads ? order->leaf_count : order->context->threads;
}

static int compare_work(const void* a, const void* b)
{
  const int64_t p = *(const int64_t*)a, q = *(const int64_t*)b;
  return (p < q) - (p > q);
}

/* Sorts the leaves by the time that they should take. The longest are peeled first, so that threads do not idle at the end. */
static stratus_status plan_leaves(stratus_visibility_order* order)
{
  void* memory;
  TRY(stratus_order_allocate(order, (size_t)order->leaf_count, sizeof *order->leaf_work, &memory));
  order->leaf_work = memory;
  for (int32_t l = 0; l < order->leaf_count; ++l) {
    const int64_t cells = order->leaf_begin[l + 1] - order->leaf_begin[l], gates = order->gap_begin[l + 1] - order->gap_begin[l];
    order->leaf_work[l] = (cells + CELLS_PER_GATE * gates) * STRATUS_LEAVES_MAX + l;
  }
  qsort(order->leaf_work, (size_t)order->leaf_count, sizeof *order->leaf_work, compare_work);
  return STRATUS_OK;
}

static stratus_status allocate_order(stratus_visibility_order* order)
{
  const size_t cells = (size_t)order->cell_count;
  void* memory;
  TRY(stratus_order_allocate(order, (size_t)order->point_count, 3 * sizeof *order->seen, &memory));
  order->seen = memory;
  TRY(stratus_order_allocate(order, cells, sizeof *order->cells, &memory));
  order->cells = memory;
  for (int32_t l = 0; l < order->leaf_count; ++l) {
    const int64_t seeds = stratus_order_seed_count(order->leaf_begin[l + 1] - order->leaf_begin[l]);
    order->seed_count = seeds > order->seed_count ? seeds : order->seed_count;
  }
  TRY(stratus_order_allocate(order, (size_t)peeling_threads(order), (size_t)order->seed_count * sizeof *order->seeds, &memory));
  order->seeds = memory;
  return STRATUS_OK;
}

static void release_adjacency(stratus_visibility_order* order)
{
  if (order->adjacency && order->side != order->adjacency->orientation) {
    stratus_release(order->context, order->side);
  }
  stratus_adjacency_destroy(order->adjacency);
  order->adjacency = NULL;
  order->side = NULL;
}

static stratus_status build_order(stratus_visibility_order* order, const stratus_mesh* mesh, const stratus_leaves* leaves)
{
  stratus_context* context = order->context;
  const size_t cells = (size_t)order->cell_count;
  void* memory;
  TRY(find_bounds(order));
  TRY(stratus_order_check_leaves(order, leaves));
  TRY(stratus_adjacency_create(context, mesh, &order->adjacency));
  order->side = order->adjacency->orientation;
  if (order->adjacency->flat > 0) { /* else every cell's side is its orientation, and no copy is needed */
    TRY(stratus_allocate(context, cells, sizeof *order->side, &memory));
    order->side = memcpy(memory, order->adjacency->orientation, cells * sizeof *order->side);
  }
  TRY(stratus_order_side_flat_cells(order));
  TRY(stratus_order_join_seams(order));
  TRY(stratus_order_take_leaves(order, leaves));
  order->flat = order->adjacency->flat;
  order->folded = order->adjacency->folded_faces;
  order->inverted = order->adjacency->inverted;
  release_adjacency(order);
  TRY(stratus_order_place_points(order));
  TRY(stratus_order_find_gaps(order));
  TRY(allocate_order(order));
  TRY(plan_leaves(order));
  return stratus_progress(context, "visibility order", 1.0);
}

stratus_status stratus_visibility_order_create(
  stratus_context* context, const stratus_mesh* mesh, const stratus_leaves* leaves, stratus_visibility_order** out)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!out) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "order is NULL");
  }
  const double begin = stratus_now_ms();
  const stratus_stage stage = stratus_stage_begin(context);
  void* memory = NULL;
  TRY(stratus_mesh_check_listed(context, mesh));
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_visibility_order), &memory));
  stratus_visibility_order* order = memory;
  order->context = context;
  order->bytes = sizeof *order;
  order->steps_per_cell = STRATUS_STEPS_PER_CELL;
  order->points = mesh->points;
  order->vertices = mesh->vertices;
  order->point_count = mesh->point_count;
  order->cell_count = mesh->cell_count;
  memcpy(order->matrix, mesh->matrix, sizeof order->matrix);
  const stratus_status status = build_order(order, mesh, leaves);
  if (status != STRATUS_OK) {
    stratus_visibility_order_destroy(order);
    return status;
  }
  order->build_ms = stratus_now_ms() - begin;
  stratus_stage_end(context, &stage, "visibility order", (size_t)order->bytes);
  *out = order;
  return STRATUS_OK;
}

void stratus_visibility_order_rebase(stratus_visibility_order* order, const stratus_mesh* mesh)
{
  order->points = mesh->points;
  order->vertices = mesh->vertices;
}

void stratus_visibility_order_destroy(stratus_visibility_order* order)
{
  if (!order) {
    return;
  }
  stratus_context* context = order->context;
  release_adjacency(order);
  stratus_release(context, order->nodes);
  stratus_release(context, order->neighbours);
  stratus_release(context, order->sides);
  stratus_release(context, order->state);
  stratus_release(context, order->waiting);
  stratus_release(context, order->listed);
  stratus_release(context, order->leaf_begin);
  stratus_release(context, order->leaf_order);
  stratus_release(context, order->leaf_output);
  stratus_release(context, order->leaf_work);
  stratus_release(context, order->gap_faces);
  stratus_release(context, order->gap_begin);
  stratus_release(context, order->gap_at);
  stratus_release(context, order->gates);
  stratus_release(context, order->gate_nodes);
  stratus_release(context, order->seen_at);
  stratus_release(context, order->seen);
  stratus_release(context, order->cells);
  stratus_release(context, order->seeds);
  stratus_device_signs_destroy(context, order->device_signs);
  stratus_device_layers_destroy(context, order->device_layers);
  stratus_release(context, order);
}

/* Brings the eye or direction into the mesh's coordinates. Rounding moves it for all cells alike, so relations stay consistent. */
static stratus_status find_view(stratus_visibility_order* order, const stratus_camera* camera, const double matrix[16], stratus_view* view)
{
  stratus_context* context = order->context;
  double inverse[16], largest = 0.0;
  if (!camera) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera is NULL");
  }
  for (int i = 0; matrix && i < 16; ++i) {
    if (!isfinite(matrix[i]) || (i >= 12 && matrix[i] != (i == 15))) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "matrix[%d] is %g, must be finite, and the last row 0 0 0 1", i, matrix[i]);
    }
  }
  if (!stratus_matrix_invert_affine(matrix ? matrix : order->matrix, inverse)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "matrix is singular, must be invertible");
  }
  *view = (stratus_view){ .parallel = camera->parallel != 0 };
  if (view->parallel) {
    stratus_matrix_vector(inverse, camera->forward, view->direction);
  } else {
    stratus_matrix_point(inverse, camera->eye, view->eye);
  }
  for (int a = 0; a < 3; ++a) {
    const double number = view->parallel ? view->direction[a] : view->eye[a];
    if (!(fabs(number) <= COORDINATE_MAX)) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera %s[%d] is %g in the mesh's coordinates, outside +-%g",
        view->parallel ? "forward" : "eye", a, number, COORDINATE_MAX);
    }
    largest = fmax(largest, fabs(number));
  }
  if (view->parallel && largest == 0.0) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "camera forward is (0, 0, 0), must have a length");
  }
  return STRATUS_OK;
}

static bool same_view(const stratus_view* p, const stratus_view* q)
{
  const double *a = p->parallel ? p->direction : p->eye, *b = q->parallel ? q->direction : q->eye;
  return p->parallel == q->parallel && a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static stratus_peel_counts peel_leaf(stratus_visibility_order* order, int32_t leaf, stratus_peeling peeling)
{
  stratus_order_seed* seeds = order->seeds + omp_get_thread_num() * order->seed_count;
  const int64_t cells = order->leaf_begin[leaf + 1] - order->leaf_begin[leaf];
  uint32_t* out = order->cells + order->leaf_output[leaf];
  const stratus_peel_counts counts =
    peeling == STRATUS_PEELING_LAYERS ? stratus_order_leaf_layers(order, leaf, seeds) : stratus_order_leaf_nearest(order, leaf, seeds);
  for (int64_t i = 0; i < cells && order->listed; ++i) {
    out[i] = order->listed[out[i]];
  }
  return counts;
}

/* peeled: leaves that are left out; NULL: none. */
static void peel_on_host(stratus_visibility_order* order, stratus_peeling peeling, const uint8_t* peeled, stratus_visibility_result* result)
{
  int64_t cycles = 0, forced = 0, overlaps = 0, tests = 0;
  int layers = 0;
#pragma omp parallel for schedule(dynamic, 1) num_threads(peeling_threads(order)) reduction(+ : cycles, forced, overlaps, tests)           \
  reduction(max : layers)
  for (int32_t i = 0; i < order->leaf_count; ++i) {
    const int32_t leaf = (int32_t)(order->leaf_work[i] % STRATUS_LEAVES_MAX);
    if (peeled && peeled[leaf]) {
      continue;
    }
    const stratus_peel_counts counts = peel_leaf(order, leaf, peeling);
    cycles += counts.cycles;
    forced += counts.forced;
    overlaps += counts.overlaps;
    tests += counts.gate_tests;
    layers = counts.layers > layers ? counts.layers : layers;
  }
  result->cycles = cycles;
  result->forced = forced;
  result->overlaps = overlaps;
  result->gate_tests = tests;
  result->layers = layers;
}

static stratus_status peel_leaves(stratus_visibility_order* order, stratus_peeling peeling, stratus_visibility_result* result)
{
  stratus_context* context = order->context;
  void* peeled = NULL;
  int layers = 0;
  if (peeling == STRATUS_PEELING_LAYERS && stratus_order_layers_on_device(order)) {
    TRY(stratus_allocate_zero(context, (size_t)order->leaf_count, 1, &peeled));
    const stratus_status status = stratus_order_peel_layers_on_device(order, peeled, &layers);
    const bool handed_back = stratus_device_hands_back(context, status);
    if (status != STRATUS_OK) {
      stratus_release(context, peeled);
      peeled = NULL;
      layers = 0;
    }
    if (status != STRATUS_OK && !handed_back) {
      return status;
    }
  }
  peel_on_host(order, peeling, peeled, result);
  result->layers = layers > result->layers ? layers : result->layers;
  stratus_release(context, peeled);
  return STRATUS_OK;
}

static stratus_status find_signs(stratus_visibility_order* order, const stratus_view* view, int64_t* exact)
{
  bool handed_back = false;
  if (stratus_order_signs_on_device(order)) {
    const stratus_status status = stratus_order_find_signs_on_device(order, view, exact);
    handed_back = stratus_device_hands_back(order->context, status);
    if (!handed_back) {
      return status;
    }
  }
  *exact = stratus_order_find_signs(order, view);
  order->relations_changed = order->relations_changed || handed_back; /* the device may have changed some before it failed */
  return STRATUS_OK;
}

stratus_status stratus_visibility_order_sort(stratus_visibility_order* order, const stratus_camera* camera, const double matrix[16],
  stratus_peeling peeling, stratus_visibility_result* result)
{
  if (!order) {
    return STRATUS_INVALID_ARGUMENT;
  }
  stratus_context* context = order->context;
  if (!result) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "result is NULL");
  }
  if (peeling != STRATUS_PEELING_NEAREST && peeling != STRATUS_PEELING_LAYERS) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "peeling %d outside %d..%d", (int)peeling, STRATUS_PEELING_NEAREST, STRATUS_PEELING_LAYERS);
  }
  stratus_view view;
  TRY(find_view(order, camera, matrix, &view));
  if (order->sorted && order->peeling == peeling && same_view(&view, &order->view)) {
    order->result.reused = 1;
    order->result.signs_ms = order->result.peel_ms = 0.0;
    *result = order->result;
    return STRATUS_OK;
  }
  const bool sorted = order->sorted && order->peeling == peeling;
  order->sorted = false;
  order->view = view;
  order->peeling = peeling;
  stratus_visibility_result found = { .cells = order->cells,
    .count = order->cell_count,
    .flat = order->flat,
    .folded = order->folded,
    .inverted = order->inverted,
    .bytes = order->bytes,
    .build_ms = order->build_ms };
  const double begin = stratus_now_ms();
  const stratus_stage signs_stage = stratus_stage_begin(context);
  TRY(find_signs(order, &view, &found.exact_signs));
  stratus_stage_end(context, &signs_stage, "visibility signs", (size_t)order->cell_count * sizeof *order->state);
  const double signs_end = stratus_now_ms();
  TRY(stratus_progress(context, "visibility order", 0.5));
  const stratus_stage peel_stage = stratus_stage_begin(context);
  const bool leaves_changed = stratus_order_sort_leaves(order, &view), gaps = order->gap_begin[order->leaf_count] > 0;
  if (leaves_changed || !sorted || order->relations_changed || gaps || order->result.forced > 0) {
    TRY(peel_leaves(order, peeling, &found));
    stratus_stage_end(context, &peel_stage, "visibility peeling", (size_t)order->cell_count * sizeof *order->cells);
  } else { /* all relations are as in the last view, and there are no gaps, where relations are not compared */
    found.reused = 1;
    found.layers = order->result.layers;
  }
  found.signs_ms = signs_end - begin;
  found.peel_ms = stratus_now_ms() - signs_end;
  order->result = found;
  order->sorted = true;
  *result = found;
  return STRATUS_OK;
}
