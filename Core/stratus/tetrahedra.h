/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures of meshes of tetrahedra. */
#ifndef STRATUS_PUBLIC_TETRAHEDRA_H
#define STRATUS_PUBLIC_TETRAHEDRA_H

#include "visibility.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Rays march from cell to cell through faces. Every cell that a ray meets counts with its exact thickness, its field linear between where
 * the ray enters and leaves (a cell's own value: constant), the transfer function pre-integrated over it. No order is needed, and gaps,
 * hollows and several parts are walked in the order in which the ray meets their borders. Which faces a ray meets is decided exactly, in
 * one plane for all cells, so that no ray slips between two cells or meets a face twice. Folded and inverted cells are drawn as parts of
 * their own: where cells overlap, both count, one after the other. */

typedef enum stratus_tetra_mode {
  STRATUS_TETRA_COMPOSITE, /* light through the whole of a ray */
  STRATUS_TETRA_MAXIMUM    /* the largest value on a ray: its colour, at the opacity of one unit distance */
} stratus_tetra_mode;

/* Two ways to one picture: the same faces are met at the same depths, and pieces of cells shaded by the same sums. They differ by the
 * rounding of floats: below .01 of 255 on the mean (root mean square), from whatever distance, and however a parallel camera's right and up
 * lean towards its forward. (A perspective one's are taken as they are: beyond 60 degrees off the right angle thickness loses digits.) A
 * pixel in which projection finds its cells out of order is drawn again, nearest piece first, so that no order of cells is trusted. Only
 * where cells overlap do the ways differ: pieces in order of depth, or one way through neighbours after the other. */
typedef enum stratus_tetra_method {
  STRATUS_TETRA_METHOD_AUTO,   /* the one that should cost less, by counts of cells, pixels and segments; a camera that stands still never
                                * changes it.   Where the context has a device: march */
  STRATUS_TETRA_METHOD_MARCH,  /* rays march from cell to cell */
  STRATUS_TETRA_METHOD_PROJECT /* cells that can show something are sorted, dealt to tiles of pixels, and composited there */
} stratus_tetra_method;

STRATUS_API const char* stratus_tetra_method_name(stratus_tetra_method method);

typedef struct stratus_tetra_options {
  stratus_tetra_mode mode; /* default composite */
  double termination; /* a ray ends when its alpha passes this, 0..1; default .9999: what is left out is a fortieth of a step of 8 bits.
                       * Not in mode maximum. */
  stratus_tetra_method method;  /* default auto */
  const stratus_leaves* leaves; /* of the mesh, for the order that projection needs: leaves are sorted in parallel. Borrowed until the
                                 * caster draws with others or is released. Default NULL: one leaf. */
} stratus_tetra_options;

STRATUS_API stratus_tetra_options stratus_tetra_options_default(void);

typedef struct stratus_tetra_report {
  stratus_tetra_method method; /* march or project */
  char why[256];               /* the reason, one sentence */
  uint64_t rays;    /* march: pixels whose ray meets a cell, in front of the eye or behind it; project: that meet a cell which can show */
  uint64_t entries; /* march: faces through which rays came in from outside */
  uint64_t
    segments;     /* march: cells that rays passed, those before the near plane included; project: pieces of cells that were composited */
  uint64_t stuck; /* ways through cells that ended inside, for no face could be told: 0 unless coordinates underflow */
  int64_t cells, shown_cells; /* of the mesh; those neither hidden nor blanked */
  int64_t blanked;            /* left out though not hidden: of values that are not finite floats, or that name a point more than once */
  int64_t repeated;           /* of those: that name a point more than once, and so have no volume */
  int64_t border_faces;       /* of shown cells */
  int64_t flat, inverted, broken_faces, folded_faces; /* cells without volume, of negative orientation; faces shared by more than two; by
                                                       * two on the same side */
  uint64_t mesh_builds, table_builds;                 /* since the caster was created: a camera move raises none */
  double build_ms, table_ms, transform_ms, entries_ms, march_ms; /* of this call; 0: not done */
  int64_t cells_in_view;                                         /* project: that can show something in some pixel */
  uint64_t pairs;                                                /* project: of a cell and a tile */
  int32_t leaves;                                                /* project: sorted in parallel */
  int64_t cycles;                                                /* project: of the order, see stratus_visibility_result */
  uint64_t again;                                                /* project: pixels drawn twice, as their cells had come in a wrong order */
  double sort_ms, bin_ms, project_ms;                            /* project: order, outlines and tiles of cells, pixels */
  size_t bytes;                                                  /* of what is kept for the mesh, and a frame's */
} stratus_tetra_report;

typedef struct stratus_tetra_caster stratus_tetra_caster;

/* World lengths between the camera and what it draws are at most the first, 1.2e27, and a mesh is at least one over it long (or a point),
 * so that lengths and optical depths over them are floats with all their digits. A parallel camera's window is at most the second, 1.1e12,
 * times narrower than what it draws lies off its middle, so that products of two such coordinates, and a value, are floats. The first holds
 * for coordinates in units of a perspective camera's right and up, too, times forward's length, and for how far a parallel one's lean along
 * forward; the second for how much longer than forward a perspective one's are. Others are STRATUS_INVALID_ARGUMENT, with the number in the
 * message. */
#define STRATUS_TETRA_REACH 1237940039285380274899124224.0 /* 2^90 */
#define STRATUS_TETRA_WINDOWS 1099511627776.0              /* 2^40 */

STRATUS_API stratus_status stratus_tetra_caster_create(stratus_context* context, stratus_tetra_caster** caster);
STRATUS_API void stratus_tetra_caster_destroy(stratus_tetra_caster* caster);

/* Marches on the context's device, or on the host where there is none or the mesh is too large for it; projects on the host, whatever the
 * device. The mesh must have values; it is read when pointers, counts, type, stride or revision differ from the last call's, else only its
 * matrix. Opacity is per world length. image: samples gets the segments of the pixel; depth the world distance to the first segment that
 * contributes (maximum: to where the largest value is). options, report may be NULL. A failed call leaves the picture undefined, and the
 * caster fit for the next call. At most INT32_MAX/8 cells, INT32_MAX/4 points and INT32_MAX/8 faces at the border: more are
 * STRATUS_UNSUPPORTED. */
STRATUS_API stratus_status stratus_tetra_caster_render(stratus_tetra_caster* caster, const stratus_mesh* mesh,
  const stratus_transfer* transfer, const stratus_camera* camera, const stratus_tetra_options* options, const stratus_image* image,
  stratus_tetra_report* report);
/* Frees what was built; the next render builds anew. */
STRATUS_API void stratus_tetra_caster_release(stratus_tetra_caster* caster);

#ifdef __cplusplus
}
#endif

#endif
