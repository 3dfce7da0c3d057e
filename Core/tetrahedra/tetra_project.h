/* SPDX-License-Identifier: BSD-3-Clause
 * Tetrahedra drawn by projection: cells in order of visibility are dealt to tiles of pixels, and each tile composites its cells front to
 * back. The work on lanes is compiled once for each instruction set and picked at run time. */
#ifndef STRATUS_TETRA_PROJECT_H
#define STRATUS_TETRA_PROJECT_H

#include "instruction_set.h"
#include "tetra_march_frame.h"

/* Pixels of a tile's edge: a tile's state fits the innermost cache, and most cells lie in one tile. */
#define PROJECT_TILE 32

/* Pixels whose rays may meet a cell: columns x0..x1, rows y0..y1; none if x0 > x1. And where the cell begins, in z. */
typedef struct stratus_tetra_rect {
  uint16_t x0, x1, y0, y1;
  float near;
} stratus_tetra_rect;

typedef struct stratus_tetra_project_counts {
  uint64_t rays, segments, again; /* again: pixels drawn twice, as cells had come in a wrong order */
} stratus_tetra_project_counts;

/* One frame. */
typedef struct stratus_tetra_projection {
  const stratus_tetra_frame* frame;
  const int32_t* vertices;  /* the mesh's */
  const float* cell_values; /* NULL: values belong to points */
  const uint8_t* shown;     /* a byte a cell */
  int64_t cell_count;
  float begin, end; /* near and far plane, in z: of the ray that begins first, and of the one that ends last */
  bool rays_differ; /* in where they begin or end */
  stratus_tetra_rect* rects;
  int columns, rows;         /* of tiles */
  const uint32_t* bin_begin; /* columns*rows + 1 places in bins */
  const uint32_t* bins;      /* cells that may cover a tile, nearest first */
} stratus_tetra_projection;

/* rects of cells [first, beyond): empty where a cell is hidden, transparent, before the near plane or beyond the far one, or covers no
 * pixel. Returns how many are not. */
typedef int64_t stratus_tetra_outlines(const stratus_tetra_projection* projection, int64_t first, int64_t beyond);
/* The pixels of one tile. */
typedef void stratus_tetra_project_tile(const stratus_tetra_projection* projection, int tile, stratus_tetra_project_counts* counts);

stratus_tetra_outlines stratus_tetra_outlines_isa0, stratus_tetra_outlines_isa1, stratus_tetra_outlines_isa2;
stratus_tetra_project_tile stratus_tetra_project_tile_isa0, stratus_tetra_project_tile_isa1, stratus_tetra_project_tile_isa2;

/* tetra_project_outline.c: a cell that reaches behind the eye, cut where it begins to be seen. */
stratus_tetra_rect stratus_tetra_outline_cut(const stratus_tetra_projection* projection, int64_t cell);

/* What is kept of a mesh, made when it is first projected. */
typedef struct stratus_tetra_projector {
  stratus_context* context;
  stratus_visibility_order* order; /* NULL until something is composited */
  stratus_leaves leaves;           /* that it was made with */
  uint8_t* shown;
  float* cell_values;
  int64_t cell_count;
  stratus_tetra_buffer rects, bin_begin, bins;
  size_t bytes; /* of shown and cell_values */
} stratus_tetra_projector;

/* values, bias: as the marching mesh has them; values NULL: cells have them. */
stratus_status stratus_tetra_projector_create(
  stratus_context* context, const stratus_mesh* mesh, const float* values, double bias, stratus_tetra_projector** out);
void stratus_tetra_projector_destroy(stratus_tetra_projector* projector); /* takes NULL */
size_t stratus_tetra_projector_bytes(const stratus_tetra_projector* projector);
/* Draws a frame that stratus_tetra_frame_prepare() made ready, table and all; fills what of the report belongs to it. */
stratus_status stratus_tetra_project(stratus_tetra_projector* projector, const stratus_mesh* mesh, const stratus_tetra_frame* frame,
  const stratus_leaves* leaves, stratus_tetra_report* report);

#endif
