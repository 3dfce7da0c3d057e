/* SPDX-License-Identifier: BSD-3-Clause
 * Projects tetrahedra: sorts the cells by visibility, puts those in view into bins by tile, nearest first, and draws the tiles, here or on
 * the device, in parallel. Threads do not affect the picture, because the order of a tile's cells is fixed. */
#include "tetra_caster.h"

#include "mesh.h"
#include "visibility_order.h"
#include "instruction_set.h"
#include "tiles.h"

#include <string.h>

#define CELLS_AT_ONCE 4096

static stratus_tetra_outlines* outlines_for(const stratus_context* context)
{
  static stratus_tetra_outlines* const outlines[] = STRATUS_ISA_EACH(stratus_tetra_outlines);
  return outlines[stratus_isa_at_most(context->isa)];
}

static stratus_tetra_project_tile* tile_for(const stratus_context* context)
{
  static stratus_tetra_project_tile* const tiles[] = STRATUS_ISA_EACH(stratus_tetra_project_tile);
  return tiles[stratus_isa_at_most(context->isa)];
}

/* ---- of a mesh */

/* Brings the values of cells into the mesh's order. */
static void find_cell_values(stratus_tetra_projector* projector)
{
  const stratus_tetra_mesh* tetra = projector->tetra;
#pragma omp parallel for num_threads(projector->context->threads)
  for (int64_t place = 0; place < tetra->cell_count; ++place) {
    projector->cell_values[tetra->at[place]] = tetra->cell_values[place];
  }
}

stratus_status stratus_tetra_projector_create(stratus_context* context, const stratus_tetra_mesh* tetra, stratus_tetra_projector** out)
{
  void* memory = NULL;
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_tetra_projector), &memory));
  stratus_tetra_projector* projector = memory;
  projector->context = context;
  projector->tetra = tetra;
  if (tetra->cell_values) {
    const stratus_status status = stratus_allocate(context, (size_t)tetra->cell_count, sizeof(float), &memory);
    if (status != STRATUS_OK) {
      stratus_tetra_projector_destroy(projector);
      return status;
    }
    projector->cell_values = memory;
    find_cell_values(projector);
  }
  *out = projector;
  return STRATUS_OK;
}

void stratus_tetra_projector_take(stratus_tetra_projector* projector, const stratus_mesh* mesh, const stratus_tetra_mesh* tetra)
{
  projector->tetra = tetra;
  if (projector->cell_values) {
    find_cell_values(projector);
  }
  if (projector->order) {
    stratus_visibility_order_rebase(projector->order, mesh);
    projector->leaves_unsure = true;
  }
}

void stratus_tetra_projector_destroy(stratus_tetra_projector* projector)
{
  if (projector) {
    stratus_context* context = projector->context;
    stratus_visibility_order_destroy(projector->order);
    stratus_release(context, projector->cell_values);
    stratus_release(context, projector->rects.memory);
    stratus_release(context, projector->bin_begin.memory);
    stratus_release(context, projector->bins.memory);
    stratus_release(context, projector);
  }
}

size_t stratus_tetra_projector_bytes(const stratus_tetra_projector* projector)
{
  const size_t values = projector->cell_values ? (size_t)projector->tetra->cell_count * sizeof *projector->cell_values : 0;
  return values + projector->rects.bytes + projector->bin_begin.bytes + projector->bins.bytes;
}

/* ---- of a frame */

static uint64_t hash_leaves(const stratus_leaves* leaves, int64_t cells)
{
  return leaves->nodes ? stratus_hash(leaves->nodes, (size_t)leaves->node_count * sizeof *leaves->nodes, 0) +
      stratus_hash(leaves->leaf, (size_t)cells * sizeof *leaves->leaf, 1)
                       : 0;
}

/* Whether the order was made with these leaves, by their pointers or else by their content. */
static bool same_leaves(const stratus_tetra_projector* projector, const stratus_leaves* leaves, int64_t cells)
{
  const stratus_leaves* known = &projector->leaves;
  if ((known->nodes == NULL) != (leaves->nodes == NULL) || known->node_count != leaves->node_count ||
    known->leaf_count != leaves->leaf_count || memcmp(known->frame, leaves->frame, sizeof known->frame) != 0) {
    return false;
  }
  return (known->nodes == leaves->nodes && known->leaf == leaves->leaf && !projector->leaves_unsure) ||
    projector->leaves_hash == hash_leaves(leaves, cells);
}

static stratus_status sort_cells(stratus_tetra_projector* projector, const stratus_mesh* mesh, const stratus_camera* camera,
  const stratus_leaves* leaves, const uint32_t** cells, stratus_tetra_report* report)
{
  const stratus_leaves none = { .nodes = NULL };
  stratus_visibility_result result;
  const double start = stratus_now_ms();
  leaves = leaves ? leaves : &none;
  if (projector->order && !same_leaves(projector, leaves, mesh->cell_count)) {
    stratus_visibility_order_destroy(projector->order);
    projector->order = NULL;
  }
  if (!projector->order) {
    TRY(stratus_visibility_order_create(projector->context, mesh, leaves->nodes ? leaves : NULL, &projector->order));
    projector->leaves_hash = hash_leaves(leaves, mesh->cell_count);
    report->build_ms += stratus_now_ms() - start;
  }
  projector->leaves = *leaves;
  projector->leaves_unsure = false;
  const double sorting = stratus_now_ms();
  TRY(stratus_visibility_order_sort(projector->order, camera, mesh->matrix, STRATUS_PEELING_NEAREST, &result));
  *cells = result.cells;
  report->sort_ms = stratus_now_ms() - sorting;
  report->leaves = leaves->nodes ? leaves->leaf_count : 1;
  report->cycles = result.cycles;
  report->bytes += result.bytes;
  return STRATUS_OK;
}

/* Finds each cell's rectangle of pixels. Returns how many cells are in view. */
static int64_t find_rects(const stratus_context* context, stratus_tetra_projection* projection)
{
  stratus_tetra_outlines* const work = outlines_for(context);
  const int64_t parts = (projection->cell_count + CELLS_AT_ONCE - 1) / CELLS_AT_ONCE;
  int64_t found = 0;
#pragma omp parallel for schedule(dynamic, 1) num_threads(context->threads) reduction(+ : found)
  for (int64_t part = 0; part < parts; ++part) {
    const int64_t beyond = (part + 1) * CELLS_AT_ONCE;
    found += work(projection, part * CELLS_AT_ONCE, beyond < projection->cell_count ? beyond : projection->cell_count);
  }
  return found;
}

/* Counts the cells first..beyond-1 of the order in each tile that they may cover and, unless bins is NULL, stores them there. */
static uint64_t deal_cells(
  const stratus_tetra_projection* projection, const uint32_t* cells, int64_t first, int64_t beyond, uint32_t* begin, uint32_t* bins)
{
  uint64_t count = 0;
  for (int64_t i = first; i < beyond; ++i) {
    const uint32_t cell = cells ? cells[i] : (uint32_t)i;
    const stratus_tetra_rect rect = projection->rects[cell];
    if (rect.x0 > rect.x1) {
      continue;
    }
    for (int row = rect.y0 / PROJECT_TILE; row <= rect.y1 / PROJECT_TILE; ++row) {
      for (int column = rect.x0 / PROJECT_TILE; column <= rect.x1 / PROJECT_TILE; ++column) {
        uint32_t* place = begin + (size_t)row * (size_t)projection->columns + (size_t)column;
        if (bins) {
          bins[*place] = cell;
        }
        ++*place;
        ++count;
      }
    }
  }
  return count;
}

/* Fill the bins in parallel. Each thread counts its part of the order. Running sums over tiles, and over parts within a tile, then place
 * each part's cells after the cells of earlier parts. */
static stratus_status bin_cells(
  stratus_tetra_projector* projector, stratus_tetra_projection* projection, const uint32_t* cells, uint64_t* pairs)
{
  stratus_context* context = projector->context;
  const size_t tiles = (size_t)projection->columns * (size_t)projection->rows, parts = (size_t)context->threads;
  const int64_t count = projection->cell_count;
  uint64_t total = 0;
  TRY(stratus_tetra_reserve(context, &projector->bin_begin, (parts + 1) * (tiles + 1), sizeof(uint32_t)));
  uint32_t* begin = projector->bin_begin.memory;
  uint32_t* places = begin + tiles + 1;
  memset(places, 0, parts * tiles * sizeof *places);
#pragma omp parallel for schedule(static, 1) num_threads(context->threads) reduction(+ : total)
  for (size_t part = 0; part < parts; ++part) {
    const int64_t first = count * (int64_t)part / (int64_t)parts, beyond = count * ((int64_t)part + 1) / (int64_t)parts;
    total += deal_cells(projection, cells, first, beyond, places + part * tiles, NULL);
  }
  if (total >= UINT32_MAX) {
    return stratus_fail(context, STRATUS_OVERFLOW, "%lld cells cover %d x %d pixels too often", (long long)count,
      projection->frame->image.width, projection->frame->image.height);
  }
  TRY(stratus_tetra_reserve(context, &projector->bins, (size_t)total, sizeof(uint32_t)));
  uint32_t* bins = projector->bins.memory;
  uint32_t place = 0;
  for (size_t tile = 0; tile < tiles; ++tile) {
    begin[tile] = place;
    for (size_t part = 0; part < parts; ++part) {
      const uint32_t here = places[part * tiles + tile];
      places[part * tiles + tile] = place;
      place += here;
    }
  }
  begin[tiles] = place;
#pragma omp parallel for schedule(static, 1) num_threads(context->threads)
  for (size_t part = 0; part < parts; ++part) {
    const int64_t first = count * (int64_t)part / (int64_t)parts, beyond = count * ((int64_t)part + 1) / (int64_t)parts;
    (void)deal_cells(projection, cells, first, beyond, places + part * tiles, bins);
  }
  projection->bin_begin = begin;
  projection->bins = bins;
  *pairs = total;
  return STRATUS_OK;
}

typedef struct project_job {
  const stratus_tetra_projection* projection;
  stratus_tetra_project_tile* work;
} project_job;

static void project_tile(const void* data, int tile, uint64_t counts[STRATUS_TILE_COUNTS])
{
  const project_job* job = data;
  stratus_tetra_project_counts mine = { 0 };
  job->work(job->projection, tile, &mine);
  counts[0] += mine.rays;
  counts[1] += mine.segments;
  counts[2] += mine.again;
}

stratus_status stratus_tetra_project_tiles(
  void* data, stratus_context* context, const stratus_tetra_projection* projection, stratus_tetra_project_counts* counts)
{
  (void)data;
  const project_job job = { projection, tile_for(context) };
  uint64_t sums[STRATUS_TILE_COUNTS];
  const stratus_status status = stratus_each_tile(context, "project", projection->columns * projection->rows, project_tile, &job, sums);
  *counts = (stratus_tetra_project_counts){ .rays = sums[0], .segments = sums[1], .again = sums[2] };
  return status;
}

stratus_status stratus_tetra_project(stratus_tetra_projector* projector, const stratus_mesh* mesh, const stratus_tetra_frame* frame,
  const stratus_leaves* leaves, stratus_tetra_draw_tiles* draw, void* data, stratus_tetra_report* report)
{
  stratus_context* context = projector->context;
  stratus_tetra_project_counts counts = { 0 };
  const uint32_t* cells = NULL;
  const double lean = fabs(frame->lean[0]) + fabs(frame->lean[1]); /* its most, in a corner of the window */
  stratus_tetra_projection projection = { .frame = frame,
    .vertices = mesh->vertices,
    .cell_values = projector->cell_values,
    .shown = projector->tetra->shown,
    .cell_count = mesh->cell_count,
    .begin = (float)((frame->camera.near_k - frame->middle - lean) / frame->per_z),
    .end = (float)fmin((frame->camera.far_k - frame->middle + lean) / frame->per_z, 1e30),
    .columns = (frame->image.width + PROJECT_TILE - 1) / PROJECT_TILE,
    .rows = (frame->image.height + PROJECT_TILE - 1) / PROJECT_TILE };
  if (frame->arguments.mode != TETRA_EXTREMES) { /* the maximum does not depend on the order */
    TRY(sort_cells(projector, mesh, &frame->camera, leaves, &cells, report));
  }
  const double start = stratus_now_ms();
  TRY(stratus_tetra_reserve(context, &projector->rects, (size_t)mesh->cell_count, sizeof(stratus_tetra_rect)));
  projection.rects = projector->rects.memory;
  report->cells_in_view = find_rects(context, &projection);
  TRY(bin_cells(projector, &projection, cells, &report->pairs));
  const double drawing = stratus_now_ms();
  TRY(draw(data, context, &projection, &counts));
  report->bin_ms = drawing - start;
  report->project_ms = stratus_now_ms() - drawing;
  report->rays = counts.rays;
  report->segments = counts.segments;
  report->again = counts.again;
  return STRATUS_OK;
}
