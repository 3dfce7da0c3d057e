/* SPDX-License-Identifier: BSD-3-Clause
 * Finds the border faces by which the rays of a tile enter the mesh, nearest first. */
#ifndef STRATUS_TETRA_ENTRY_H
#define STRATUS_TETRA_ENTRY_H

#include "tetra_march.h"
#include "tetra_pixel.h"

#define TETRA_PIXELS (TETRA_TILE * TETRA_TILE)

/* The arrays of a frame. Pixel p of tile t has the entries first[TETRA_PIXELS t + p] .. first[TETRA_PIXELS t + p + 1] - 1. */
typedef struct stratus_tetra_view {
  stratus_tetra_scene scene;
  GLOBAL const float* lines;    /* us and uw of all columns, then vs and vw of all rows */
  GLOBAL const float* ends;     /* one a pixel, in z: where its ray ends; read only if has_ends */
  GLOBAL const int* faces;      /* TETRA_FACE ints each */
  GLOBAL const uint* bin_begin; /* faces that may cover tile t: bins[bin_begin[t]] .. bins[bin_begin[t + 1] - 1] */
  GLOBAL const int* bins;
  GLOBAL const uint* first;
  GLOBAL int* entries; /* two ints an entry: the bits of its z, and the face; nearest first */
  stratus_tetra_picture picture;
} stratus_tetra_view;

/* A border face in the coordinates of one packet's columns, which all rows of a tile share. */
typedef struct stratus_tetra_border {
  float point[3][4];
  vfloat x[3], wide;
} stratus_tetra_border;

INLINE void border_columns(const stratus_tetra_view* v, CONSTANT stratus_tetra_arguments* a, int x, stratus_tetra_border* b)
{
  const int padded = a->picture.width + TETRA_PADDING;
  const vfloat us = v_load_global(v->lines + x), uw = v_load_global(v->lines + padded + x);
  for (int i = 0; i < 3; ++i) {
    b->x[i] = v_fma(-us, v_set(b->point[i][2]), v_set(b->point[i][0]) - uw);
  }
  b->wide = v_max(v_abs(b->x[1] - b->x[0]), v_abs(b->x[2] - b->x[0]));
}

/* The rays of row y that enter by the face; *at: the z where they do. */
INLINE vmask border_row(const stratus_tetra_view* v, CONSTANT stratus_tetra_arguments* a, const stratus_tetra_border* b, int y, vfloat* at)
{
  const vfloat zero = v_set(0.0f);
  GLOBAL const float* lines = v->lines + 2 * (a->picture.width + TETRA_PADDING) + y;
  const vfloat vs = v_set(lines[0]), vw = v_set(lines[a->picture.height + TETRA_PADDING]);
  vfloat py[3], edge[3], z[3], value[3], unused;
  for (int i = 0; i < 3; ++i) {
    z[i] = value[i] = v_set(b->point[i][2]);
    py[i] = v_fma(-vs, z[i], v_set(b->point[i][1]) - vw);
  }
  vmask outside = m_none();
  for (int i = 0; i < 3; ++i) {
    const int p = (i + 1) % 3, q = (i + 2) % 3;
    edge[i] = tetra_edge(b->x[p], py[p], b->x[q], py[q]);
    outside = outside | tetra_negative(edge[i], b->x[p], py[p], b->x[q], py[q]);
  }
  /* a face whose three points coincide counts as none */
  const vfloat wide = v_max(b->wide, v_max(v_abs(py[1] - py[0]), v_abs(py[2] - py[0])));
  const vmask met = m_andnot(v_lt(zero, wide), outside);
  if (m_any(met)) {
    tetra_cross(edge, z, value, at, &unused);
  }
  return met;
}

INLINE void insert_entry(GLOBAL int* entries, uint count, int z, int face)
{
  const float near = scalar_from_bits(z);
  while (count > 0 && scalar_from_bits(entries[2 * count - 2]) > near) {
    entries[2 * count] = entries[2 * count - 2];
    entries[2 * count + 1] = entries[2 * count - 1];
    --count;
  }
  entries[2 * count] = z;
  entries[2 * count + 1] = face;
}

/* Counts, or stores, the entries of the tile's pixels from..beyond-1, which are whole rows, or one pixel where a packet is one ray.
 * Entries are sorted by depth, and by the face's number where depths are equal. found: how many entries each pixel of the tile has. */
INLINE void find_entries(
  const stratus_tetra_view* v, CONSTANT stratus_tetra_arguments* a, int tile, int from, int beyond, int counting, GLOBAL uint* found)
{
  const int x0 = tile % a->columns * TETRA_TILE, y0 = tile / a->columns * TETRA_TILE;
  const int rows = a->picture.height - y0 < TETRA_TILE ? a->picture.height - y0 : TETRA_TILE;
  const int row_from = from / TETRA_TILE, row_beyond = (beyond - 1) / TETRA_TILE + 1 < rows ? (beyond - 1) / TETRA_TILE + 1 : rows;
  const int column_from = from % TETRA_TILE, column_beyond = (beyond - 1) % TETRA_TILE + 1;
  for (int pixel = from; pixel < beyond; ++pixel) {
    found[pixel] = 0;
  }
  for (uint bin = v->bin_begin[tile]; bin < v->bin_begin[tile + 1]; ++bin) {
    const int number = v->bins[bin];
    GLOBAL const int* face = v->faces + TETRA_FACE * number;
    stratus_tetra_border border;
    for (int i = 0; i < 12; ++i) {
      border.point[i / 4][i % 4] = v->scene.points[4 * face[i / 4] + i % 4];
    }
    const int anywhere = face[7], first_row = (face[6] & 0xffff) - y0, last_row = (int)((uint)face[6] >> 16) - y0;
    const int begin = anywhere || first_row < row_from ? row_from : first_row,
              end = anywhere || last_row >= row_beyond ? row_beyond : last_row + 1;
    for (int x = column_from; x < column_beyond; x += STRATUS_WIDTH) {
      if (!anywhere && (x0 + x > (int)((uint)face[5] >> 16) || x0 + x + STRATUS_WIDTH <= (face[5] & 0xffff))) {
        continue;
      }
      border_columns(v, a, x0 + x, &border);
      for (int y = begin; y < end; ++y) {
        vfloat at = v_set(0.0f);
        int hit[STRATUS_WIDTH];
        float z[STRATUS_WIDTH];
        const vmask mask = border_row(v, a, &border, y0 + y, &at);
        if (!m_any(mask)) {
          continue;
        }
        vi_store(hit, vi_select(mask, vi_set(1), vi_set(0)));
        v_store(z, at);
        for (int lane = 0; lane < STRATUS_WIDTH && x0 + x + lane < a->picture.width; ++lane) {
          const int pixel = y * TETRA_TILE + x + lane;
          if (hit[lane] && !counting) {
            insert_entry(v->entries + 2 * (size_t)v->first[TETRA_PIXELS * tile + pixel], found[pixel], scalar_bits(z[lane]), number);
          }
          found[pixel] += (uint)hit[lane];
        }
      }
    }
  }
}

#endif
