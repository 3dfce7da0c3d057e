/* SPDX-License-Identifier: BSD-3-Clause
 * A frame of tetrahedra, and the march on the host, which is compiled once for each instruction set and picked at run time. */
#ifndef STRATUS_TETRA_MARCH_FRAME_H
#define STRATUS_TETRA_MARCH_FRAME_H

#include "stratus/tetrahedra.h"
#include "instruction_set.h"
#include "tetra_arguments.h"

#include "volume.h"

/* A border face, which only one shown cell has. A ray that enters the cell by it sees its points turn from right to up. */
typedef struct stratus_tetra_face {
  int32_t point[3], fourth; /* fourth: the cell's point opposite the face */
  int32_t cell;             /* where the cell's ints begin; of a lattice that turns both ways 1 more where the cell turns left */
} stratus_tetra_face;

/* A border face of a frame, in the layout of kernels/tetrahedra/tetra_arguments.h. */
typedef struct stratus_tetra_border_face {
  stratus_tetra_face face;
  uint16_t columns[2], rows[2]; /* first and last pixel that it may cover */
  int32_t anywhere;             /* 1: these are not known */
} stratus_tetra_border_face;

typedef struct stratus_tetra_buffer {
  void* memory;
  size_t bytes;
} stratus_tetra_buffer;

/* The camera and the image for which a frame placed its points and faces. */
typedef struct stratus_tetra_placement {
  double matrix[16], scale, middle;
  int parallel, width, height;
} stratus_tetra_placement;

/* Memory of a frame, reused by the next one. If the next frame has the same mesh, camera and image, its points and faces stay where they
 * are, and only values are stored anew. */
typedef struct stratus_tetra_buffers {
  stratus_tetra_buffer points, places, faces, lines, ends, bin_begin, bins, first, entries;
  bool placed, binned; /* points, and faces, fit `placement`; whoever changes the mesh sets both false */
  stratus_tetra_placement placement;
} stratus_tetra_buffers;

typedef struct stratus_tetra_counts {
  uint64_t rays, entries, segments, stuck;
} stratus_tetra_counts;

typedef struct stratus_tetra_frame {
  stratus_tetra_arguments arguments;
  const int32_t* cells;
  const float* points;                    /* x, y, z and value of each mesh point */
  const float* places;                    /* the same in the order of stratus_tetra_mesh.names */
  const float* cell_values;               /* in the order of `cells`; NULL: values belong to points */
  const stratus_tetra_border_face* faces; /* their points turn as this camera sees them */
  size_t face_count;
  const float *us, *uw, *vs, *vw; /* parts of rays by column and by row, TETRA_PADDING of them beyond the picture */
  int columns, rows;              /* of tiles */
  const uint32_t* bin_begin;      /* where each tile's faces begin in `bins`, and the end */
  const int32_t* bins;            /* faces that may cover a tile, in rising order */
  uint32_t* first;                /* entries of tile t's pixel p begin at first[256 t + p] */
  int32_t* entries;          /* where rays enter the mesh: the bits of z, and the face. A pixel's entries are consecutive, nearest first */
  const float* ends;         /* z of opaque geometry in each pixel; NULL: none */
  const int32_t* march_sums; /* stratus_tetra_sums() */
  const stratus_table* table;
  bool lit;                              /* light and opacity depend on the gradient */
  const float* gradients;                /* stratus_tetra_gradients.vectors; NULL unless lit */
  int gradient_sets;                     /* of a vector for each point */
  const int32_t* lights;                 /* the maps of lights (kernels/base/light_map.h); NULL: none */
  const struct stratus_light_maps* maps; /* the same */
  const float* factors;                  /* gradient opacities; NULL: there is none */
  size_t factor_count;
  const float* components; /* stratus_tetra_components.places; NULL: values have one component, and cells no labels */
  size_t component_floats;
  const int32_t* media; /* their sums */
  size_t media_count;
  stratus_camera camera;
  double basis[3][3];            /* world vectors of one unit of a, b and z of the rays' coordinates */
  double middle, per_z, lean[2]; /* k = middle + per_z*z - lean[0]*u - lean[1]*v */
  stratus_image image;
} stratus_tetra_frame;

/* Returns k of a pixel's ray where z is 0. */
static inline double stratus_tetra_middle(const stratus_tetra_frame* frame, int x, int y)
{
  const double u = (2.0 * x + 1.0) / frame->image.width - 1.0, v = (2.0 * y + 1.0) / frame->image.height - 1.0;
  return frame->middle - (frame->lean[0] * u + frame->lean[1] * v);
}

/* counting: writes the number of entries of each pixel of the tile to first[]. Otherwise fills the entries, marches and stores the pixels.
 */
typedef void stratus_tetra_tile(const stratus_tetra_frame* frame, int tile, bool counting, stratus_tetra_counts* counts);

stratus_tetra_tile stratus_tetra_tile_isa0, stratus_tetra_tile_isa1, stratus_tetra_tile_isa2;
/* The variant TETRA_LIT. */
stratus_tetra_tile stratus_tetra_light_tile_isa0, stratus_tetra_light_tile_isa1, stratus_tetra_light_tile_isa2;

/* tetra_march.c: turns the counts of entries in frame->first, one per pixel, into where each pixel's entries begin; first[pixels] is the
 * end. */
stratus_status stratus_tetra_sum_entries(stratus_context* context, stratus_tetra_frame* frame, size_t pixels, size_t* total);
/* Makes room for all entries: the march of a tile finds them. */
stratus_status stratus_tetra_count_entries(
  stratus_context* context, stratus_tetra_frame* frame, stratus_tetra_buffers* buffers, stratus_tetra_counts* counts);
/* Marches all tiles. */
stratus_status stratus_tetra_march(stratus_context* context, stratus_tetra_frame* frame, stratus_tetra_buffers* buffers,
  stratus_tetra_counts* counts, double* entries_ms, double* march_ms);

#endif
