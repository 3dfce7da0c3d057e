/* SPDX-License-Identifier: BSD-3-Clause
 * Measures the costs of march and projection on this machine. Both draw a small mesh, once with many pixels for each cell and once with
 * few, so that costs of pixels and costs of cells can be separated. Segments and cells are counted by the estimate that is used for the
 * user's views, so that the costs include the estimate's error. It is done once for each instruction set and number of threads, by a few
 * processes (calibration.h). */
#include "tetra_costs.h"

#include "calibration.h"
#include "mesh.h"

#include <string.h>

/* Boxes along each axis of the mesh, six cells each: 25 thousand cells, whose data exceed the inner caches. */
#define BOXES 16
#define POINTS ((BOXES + 1) * (BOXES + 1) * (BOXES + 1))
#define CELLS (6 * BOXES * BOXES * BOXES)
/* Sides of the two pictures. */
#define MANY 96
#define FEW 16
/* Each is drawn so many times, and the shortest time counts: interruptions only add. */
#define REPEATS 2
#define ENTRIES 256
#define TOLERANCE 0.001

typedef struct sample {
  stratus_context context; /* without callbacks: the user did not request these images */
  stratus_mesh mesh;
  stratus_tetra_mesh* tetra;
  stratus_table* table;
  int32_t* sums;
  stratus_tetra_projector* projector;
  stratus_tetra_buffers buffers;
  double points[3 * POINTS];
  float values[POINTS];
  int32_t vertices[4 * CELLS];
  float rgba[4 * MANY * MANY];
} sample;

/* The measured times, in nanoseconds as in stratus_tetra_costs. They are only times that can be compared between processes: a piece's cost
 * is a difference of two times, which is too small if an interruption made the second too large. */
typedef enum measured {
  SEGMENT,
  SORTED,
  CELL,
  PACKET_OF_FEW,     /* a packet of the picture with few pixels, in which pieces hardly count */
  PACKET_OF_MANY,    /* a packet of the other with its pieces */
  PACKETS_PER_PIECE, /* of the picture with many pixels; the same in each process */
  MEASURED
} measured;

/* The shortest times of a picture, in milliseconds. */
typedef struct sample_times {
  stratus_tetra_view view;
  double march, sort, bin, project;
} sample_times;

/* Makes a lattice whose points are moved a little, so that it has the irregular faces of other meshes. */
static void make_mesh(sample* s)
{
  static const int path[6][2] = { { 0, 1 }, { 0, 2 }, { 1, 0 }, { 1, 2 }, { 2, 0 }, { 2, 1 } };
  const int side = BOXES + 1, step[3] = { 1, side, side * side };
  uint32_t state = 1;
  for (int i = 0; i < POINTS; ++i) {
    const int at[3] = { i % side, i / side % side, i / side / side };
    for (int a = 0; a < 3; ++a) {
      state = state * 1664525u + 1013904223u;
      s->points[3 * i + a] = at[a] + 0.4 * ((double)(state >> 8) * 0x1p-24 - 0.5);
    }
    s->values[i] = (float)(0.5 + 0.5 * sin(0.7 * at[0]) * cos(0.5 * at[1] + 0.3 * at[2]));
  }
  for (int box = 0, cell = 0; box < BOXES * BOXES * BOXES; ++box) {
    const int corner = (box / BOXES / BOXES * side + box / BOXES % BOXES) * side + box % BOXES;
    for (int t = 0; t < 6; ++t, ++cell) {
      const int a = corner + step[path[t][0]], b = a + step[path[t][1]];
      const int32_t vertices[4] = { corner, a, b, corner + step[0] + step[1] + step[2] };
      memcpy(s->vertices + 4 * cell, vertices, sizeof vertices);
    }
  }
  s->mesh = stratus_mesh_default();
  s->mesh.points = s->points;
  s->mesh.point_count = POINTS;
  s->mesh.vertices = s->vertices;
  s->mesh.cell_count = CELLS;
  s->mesh.values = s->values;
}

/* A function by which every cell shows and no ray ends early. */
static stratus_status make_table(sample* s)
{
  static const double opacity[] = { 0.0, 0.001, 1.0, 0.01 }, color[] = { 0.0, 0.1, 0.2, 0.9, 1.0, 0.9, 0.5, 0.1 };
  stratus_transfer transfer = stratus_transfer_default();
  transfer.opacity = opacity;
  transfer.opacity_count = 2;
  transfer.color = color;
  transfer.color_count = 2;
  const stratus_volume view = stratus_mesh_values(&s->mesh);
  const stratus_table_values values = {
    .fetching = { s->tetra->bias, stratus_type_is_wide(view.type), stratus_type_is_integer(view.type) },
    .lo = s->tetra->low,
    .hi = s->tetra->high,
    .uniform = true,
  };
  TRY(stratus_table_create_fine(&s->context, &transfer, &values, STRATUS_SAMPLING_PREINTEGRATED, 1.0, ENTRIES, &s->table));
  return stratus_tetra_sums(&s->context, s->table, &s->sums);
}

/* Draws a picture from a direction of its own, since an order of cells that hardly changes is found in less time. */
static stratus_status draw(sample* s, int side, int turn, sample_times* times)
{
  const double half = 0.5 * BOXES, eye[3] = { half + 30.0 * cos(turn), half + 30.0 * sin(turn), 1.5 * BOXES };
  const double middle[3] = { half, half, half }, up[3] = { 0.0, 0.0, 1.0 };
  const stratus_image image = { .width = side, .height = side, .rgba = s->rgba };
  const stratus_tetra_options options = { .tolerance = TOLERANCE };
  const stratus_tetra_shown shown = { s->tetra, s->table, STRATUS_TETRA_COMPOSITE };
  stratus_camera camera;
  stratus_tetra_frame frame;
  stratus_tetra_counts counts;
  stratus_tetra_report report = { .leaves = 0 };
  double entries_ms = 0.0, march_ms = 0.0;
  TRY(stratus_camera_perspective(&s->context, eye, middle, up, 40.0, 1.0, &camera));
  (void)stratus_tetra_count_view(&shown, &s->mesh, &camera, &image, &times->view);
  for (int march = 0; march < 2; ++march) {
    TRY(stratus_tetra_frame_prepare(&s->context, s->tetra, &s->mesh, &camera, &image, march != 0, &s->buffers, &frame));
    frame.table = s->table;
    frame.march_sums = s->sums;
    stratus_tetra_frame_shade(&frame, NULL, &options);
    if (march) {
      TRY(stratus_tetra_march(&s->context, &frame, &s->buffers, &counts, &entries_ms, &march_ms));
    } else {
      TRY(stratus_tetra_project(s->projector, &s->mesh, &frame, NULL, stratus_tetra_project_tiles, NULL, &report));
    }
  }
  times->march = fmin(times->march, entries_ms + march_ms);
  times->sort = fmin(times->sort, report.sort_ms);
  times->bin = fmin(times->bin, report.bin_ms);
  times->project = fmin(times->project, report.project_ms);
  return STRATUS_OK;
}

static stratus_status measure(sample* s, double* costs)
{
  sample_times many = { { 0 }, INFINITY, INFINITY, INFINITY, INFINITY }, few = many;
  make_mesh(s);
  TRY(stratus_tetra_mesh_create(&s->context, &s->mesh, &s->tetra));
  TRY(make_table(s));
  TRY(stratus_tetra_projector_create(&s->context, s->tetra, &s->projector));
  for (int i = 0; i < REPEATS; ++i) {
    TRY(draw(s, MANY, 2 * i, &many));
    TRY(draw(s, FEW, 2 * i + 1, &few));
  }
  costs[SEGMENT] = 1e6 * many.march / many.view.passed;
  costs[SORTED] = 1e6 * fmin(many.sort, few.sort) / CELLS;
  costs[CELL] = 1e6 * few.bin / few.view.shown;
  costs[PACKET_OF_FEW] = 1e6 * few.project / few.view.packets;
  costs[PACKET_OF_MANY] = 1e6 * many.project / many.view.packets;
  costs[PACKETS_PER_PIECE] = many.view.packets / many.view.pieces;
  return STRATUS_OK;
}

/* Measures in a context like `context`. */
static stratus_status measure_like(stratus_context* context, void* job, double* costs)
{
  void* memory = NULL;
  (void)job;
  TRY(stratus_allocate_zero(context, 1, sizeof(sample), &memory));
  sample* s = memory;
  s->context = *context;
  s->context.device = NULL;
  s->context.options.progress = NULL;
  s->context.options.log = NULL;
  const stratus_status status = measure(s, costs);
  stratus_tetra_projector_destroy(s->projector);
  stratus_release(&s->context, s->sums);
  stratus_table_destroy(s->table);
  stratus_tetra_mesh_destroy(s->tetra);
  stratus_tetra_buffers_release(&s->context, &s->buffers);
  if (status != STRATUS_OK) {
    (void)stratus_fail(context, status, "%s", s->context.message);
  }
  stratus_release(context, memory);
  return status;
}

stratus_status stratus_tetra_costs_here(stratus_context* context, stratus_tetra_costs* costs)
{
  stratus_calibration here = stratus_calibration_of_host(context, "tetrahedra", MEASURED);
  TRY(stratus_calibrate(context, &here, measure_like, NULL));
  const double* n = here.numbers;
  *costs = (stratus_tetra_costs){
    .segment = n[SEGMENT],
    .piece = fmax(n[PACKET_OF_MANY] - n[PACKET_OF_FEW], 0.0) * n[PACKETS_PER_PIECE],
    .packet = n[PACKET_OF_FEW],
    .cell = n[CELL],
    .sorted = n[SORTED],
  };
  return STRATUS_OK;
}
