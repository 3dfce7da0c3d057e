/* SPDX-License-Identifier: BSD-3-Clause
 * Projection of tetrahedra: cells, sorted by visibility, are put into bins by tile of pixels, and each tile composites its cells front to
 * back. The vectorized functions are compiled once for each instruction set and picked at run time. */
#ifndef STRATUS_TETRA_PROJECT_H
#define STRATUS_TETRA_PROJECT_H

#include "instruction_set.h"
#include "tetra_march_frame.h"
#include "tetra_project_arguments.h"

typedef struct stratus_tetra_project_counts {
  uint64_t rays, segments, again; /* again: pixels redrawn because their pieces came out of order */
} stratus_tetra_project_counts;

/* One frame. */
typedef struct stratus_tetra_projection {
  const stratus_tetra_frame* frame;
  const int32_t* vertices;  /* the mesh's */
  const float* cell_values; /* NULL: values belong to points */
  const uint8_t* shown;     /* per cell */
  int64_t cell_count;
  float begin, end; /* the smallest z of the near plane and the largest of the far plane, over all rays */
  stratus_tetra_rect* rects;
  int columns, rows;         /* of tiles */
  const uint32_t* bin_begin; /* where each tile's cells begin in `bins`, and the end */
  const uint32_t* bins;      /* cells that may cover a tile, nearest first */
} stratus_tetra_projection;

/* Sets the rects of cells [first, beyond). A rect is empty if its cell is hidden, transparent, before the near plane or beyond the far one,
 * or covers no pixel. Returns the number of rects that are not empty. */
typedef int64_t stratus_tetra_outlines(const stratus_tetra_projection* projection, int64_t first, int64_t beyond);
/* Draws the pixels of one tile. */
typedef void stratus_tetra_project_tile(const stratus_tetra_projection* projection, int tile, stratus_tetra_project_counts* counts);

stratus_tetra_outlines stratus_tetra_outlines_isa0, stratus_tetra_outlines_isa1, stratus_tetra_outlines_isa2;
stratus_tetra_project_tile stratus_tetra_project_tile_isa0, stratus_tetra_project_tile_isa1, stratus_tetra_project_tile_isa2;

/* tetra_project_outline.c: finds the rect of a cell that reaches behind the eye, clipped at the near plane. */
stratus_tetra_rect stratus_tetra_outline_cut(const stratus_tetra_projection* projection, int64_t cell);

typedef struct stratus_tetra_mesh stratus_tetra_mesh; /* tetra_caster.h */

/* The state of projection, made when a mesh is first projected. */
typedef struct stratus_tetra_projector {
  stratus_context* context;
  const stratus_tetra_mesh* tetra; /* borrowed */
  stratus_visibility_order* order; /* NULL until something is composited */
  stratus_leaves leaves;           /* of `order` */
  uint64_t leaves_hash;            /* of their content */
  bool leaves_unsure;              /* their content may have changed */
  float* cell_values;              /* in the mesh's order; NULL: values belong to points */
  stratus_tetra_buffer rects, bin_begin, bins;
} stratus_tetra_projector;

stratus_status stratus_tetra_projector_create(stratus_context* context, const stratus_tetra_mesh* tetra, stratus_tetra_projector** out);
/* Goes on with other values of the mesh, and with other arrays of the same points and vertices. */
void stratus_tetra_projector_take(stratus_tetra_projector* projector, const stratus_mesh* mesh, const stratus_tetra_mesh* tetra);
void stratus_tetra_projector_destroy(stratus_tetra_projector* projector); /* takes NULL */
size_t stratus_tetra_projector_bytes(const stratus_tetra_projector* projector);
/* Draws the tiles of a projection whose cells are in their bins; stratus_tetra_project_tiles() does on the host. */
typedef stratus_status stratus_tetra_draw_tiles(
  void* data, stratus_context* context, const stratus_tetra_projection* projection, stratus_tetra_project_counts* counts);
stratus_tetra_draw_tiles stratus_tetra_project_tiles; /* data: not read */
/* Draws a frame that stratus_tetra_frame_prepare() has prepared and whose table is set, its tiles by `draw`, and fills the report's fields
 * of projection. */
stratus_status stratus_tetra_project(stratus_tetra_projector* projector, const stratus_mesh* mesh, const stratus_tetra_frame* frame,
  const stratus_leaves* leaves, stratus_tetra_draw_tiles* draw, void* data, stratus_tetra_report* report);

#endif
