/* SPDX-License-Identifier: BSD-3-Clause
 * Marching through tetrahedra on the host, compiled once for each instruction set and picked at run time. */
#ifndef STRATUS_TETRA_MARCH_HOST_H
#define STRATUS_TETRA_MARCH_HOST_H

#include "stratus/tetrahedra.h"
#include "instruction_set.h"
#include "tetra_arguments.h"

#include "volume.h"

/* A face of one shown cell only, turned so that a ray that enters the cell by it sees its points turn from right to up. */
typedef struct stratus_tetra_face {
  int32_t point[3], fourth; /* of the cell */
  int32_t cell;             /* where its ints begin */
} stratus_tetra_face;

/* The same in a frame, as kernels/tetra_arguments.h has it. */
typedef struct stratus_tetra_border_face {
  stratus_tetra_face face;
  uint16_t columns[2], rows[2]; /* first and last of pixels */
  int32_t anywhere;
} stratus_tetra_border_face;

typedef struct stratus_tetra_buffer {
  void* memory;
  size_t bytes;
} stratus_tetra_buffer;

/* Memory of a frame, kept for the next one. */
typedef struct stratus_tetra_buffers {
  stratus_tetra_buffer points, places, faces, lines, ends, bin_begin, bins, first, entries;
} stratus_tetra_buffers;

typedef struct stratus_tetra_counts {
  uint64_t rays, entries, segments, stuck;
} stratus_tetra_counts;

typedef struct stratus_tetra_frame {
  stratus_tetra_arguments arguments;
  const int32_t* cells;
  const float* points;                    /* x, y, z, value each */
  const float* places;                    /* the same in the order of the cells' points: tetra_mesh.c */
  const float* cell_values;               /* a cell each in the order of `cells`, or NULL */
  const stratus_tetra_border_face* faces; /* turned for this camera */
  size_t face_count;
  const float *us, *uw, *vs, *vw; /* a column each, a row each: STRATUS_WIDTH_MOST of them beyond the picture */
  int columns, rows;              /* of tiles */
  const uint32_t* bin_begin;      /* columns*rows + 1 places in bins */
  const int32_t* bins;            /* faces that may cover a tile, rising */
  uint32_t* first;                /* entries of tile t's pixel p begin at first[256 t + p] */
  int32_t* entries;               /* z's bits and the face: where rays come in. Those of a pixel lie together, nearest first */
  const float* ends;              /* a pixel each, what is opaque in z, or NULL */
  const int32_t* march_sums;      /* stratus_tetra_sums() */
  const stratus_table* table;
  stratus_camera camera;
  double middle, per_z, lean[2]; /* k = middle + per_z*z - lean[0]*u - lean[1]*v */
  stratus_image image;
} stratus_tetra_frame;

/* k of a pixel's ray where z is 0. */
static inline double stratus_tetra_middle(const stratus_tetra_frame* frame, int x, int y)
{
  const double u = (2.0 * x + 1.0) / frame->image.width - 1.0, v = (2.0 * y + 1.0) / frame->image.height - 1.0;
  return frame->middle - (frame->lean[0] * u + frame->lean[1] * v);
}

/* counting: writes how many entries each pixel of the tile has to first[]; else fills the entries, marches and stores the pixels. */
typedef void stratus_tetra_tile(const stratus_tetra_frame* frame, int tile, bool counting, stratus_tetra_counts* counts);

stratus_tetra_tile stratus_tetra_tile_isa0, stratus_tetra_tile_isa1, stratus_tetra_tile_isa2;

/* tetra_march.c: counts of entries a pixel in frame->first, `pixels` of them and one more, become where each pixel's begin. */
stratus_status stratus_tetra_sum_entries(stratus_context* context, stratus_tetra_frame* frame, size_t pixels, size_t* total);
/* All tiles. */
stratus_status stratus_tetra_march(stratus_context* context, stratus_tetra_frame* frame, stratus_tetra_buffers* buffers,
  stratus_tetra_counts* counts, double* entries_ms, double* march_ms);

#endif
