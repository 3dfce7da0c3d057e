/* SPDX-License-Identifier: BSD-3-Clause
 * Draws the cells of a tile. A wrong order of cells (across gaps, in cycles, in overlaps) is noticed when a piece begins before the last
 * one ends. Such pixels are redrawn, nearest pieces first. */
#ifndef STRATUS_TETRA_PROJECT_DRAW_H
#define STRATUS_TETRA_PROJECT_DRAW_H

#include "tetra_project_again.h"

#ifdef STRATUS_DEVICE_AVX512
#if __has_builtin(__builtin_ia32_compresssi512_mask)
#define COMPRESS_INTS(value, mask)                                                                                                         \
  __builtin_astype(__builtin_ia32_compresssi512_mask(STRATUS_I16(value), STRATUS_I16((int16)(0)), mask), int16)
#endif
#endif

/* Stores the lanes of `mask` one after another at `place`. Up to STRATUS_WIDTH numbers are overwritten. */
INLINE void put_ints(int* place, vmask mask, vint value)
{
#if !defined(STRATUS_DEVICE) && STRATUS_ISA == 2
  _mm512_storeu_si512(place, _mm512_maskz_compress_epi32(mask, (__m512i)value));
#elif defined(COMPRESS_INTS)
  vi_store(place, COMPRESS_INTS(value, mask));
#else
  int lanes[STRATUS_WIDTH], on[STRATUS_WIDTH];
  vi_store(lanes, value);
  vi_store(on, vi_select(mask, vi_set(1), vi_set(0)));
  for (int l = 0, n = 0; l < STRATUS_WIDTH; n += on[l++]) {
    place[n] = lanes[l];
  }
#endif
}

INLINE void put_floats(float* place, vmask mask, vfloat value)
{
#if !defined(STRATUS_DEVICE) && STRATUS_ISA == 2
  _mm512_storeu_ps(place, _mm512_maskz_compress_ps(mask, value));
#elif defined(COMPRESS_INTS)
  v_store(place, v_from_bits(COMPRESS_INTS(v_to_bits(value), mask)));
#else
  float lanes[STRATUS_WIDTH];
  int on[STRATUS_WIDTH];
  v_store(lanes, value);
  vi_store(on, vi_select(mask, vi_set(1), vi_set(0)));
  for (int l = 0, n = 0; l < STRATUS_WIDTH; n += on[l++]) {
    place[n] = lanes[l];
  }
#endif
}

INLINE void put_piece(project_tile* t, vmask mask, const ray_piece* piece, int place)
{
  put_floats(t->at + t->count, mask, piece->at);
  put_floats(t->to + t->count, mask, piece->to);
  put_floats(t->first + t->count, mask, piece->first);
  put_floats(t->last + t->count, mask, piece->last);
  put_ints(t->pixel + t->count, mask, vi_lanes() + vi_set(place));
  t->count += m_count(mask);
  if (t->count >= PIECES) {
    flush(t);
  }
}

/* The packets that a cell may cover. */
typedef struct span {
  int x0, x1, y0, y1;
} span;

INLINE span span_of(const project_tile* t, GLOBAL const stratus_tetra_rect* rect)
{
#if STRATUS_WIDTH == 1 /* a pixel draws the cells of the packet that it would be in, whose rounding may meet it next to their rect */
  const int left = (rect->x0 & ~3) - t->own_x, right = (rect->x1 | 3) - t->own_x;
  const int low = (rect->y0 & ~3) - t->own_y, high = (rect->y1 | 3) - t->own_y;
#else
  const int left = rect->x0 - t->own_x, right = rect->x1 - t->own_x, low = rect->y0 - t->own_y, high = rect->y1 - t->own_y;
#endif
  const int x0 = left > 0 ? left : 0, x1 = right < t->width ? right : t->width - 1;
  const int y0 = low > 0 ? low : 0, y1 = high < t->height ? high : t->height - 1;
  span s;
  s.x0 = x0 / PACKET_X;
  s.x1 = x1 / PACKET_X;
  s.y0 = y0 / PACKET_Y;
  s.y1 = y1 / PACKET_Y;
  return s;
}

static void draw_any_cell(project_tile* t, uint cell)
{
  GLOBAL const stratus_tetra_rect* rect = t->view->rects + cell;
  const span s = span_of(t, rect);
  const vfloat near = v_set(rect->near);
  cell_points c;
  load_points(t, cell, &c);
  for (int row = s.y0; row <= s.y1; ++row) {
    for (int column = s.x0; column <= s.x1; ++column) {
      const int place = (row * ACROSS + column) * STRATUS_WIDTH;
      const vmask live = v_lt(near, v_load(t->open + place));
      ray_piece piece;
      if (m_any(live)) {
        const vmask met = pass_cell(&c, v_load(t->us[column]), v_load(t->uw[column]), v_load(t->vs[row]), v_load(t->vw[row]), live, &piece);
        if (m_any(met)) {
          put_piece(t, met, &piece, place);
        }
      }
    }
  }
}

/* Callers pass a constant `fronts`, so that meet_planes() has no branches. */
INLINE void draw_by_planes(project_tile* t, const one_cell* c, int fronts, GLOBAL const stratus_tetra_rect* rect)
{
  const span s = span_of(t, rect);
  const vfloat nearest = v_set(rect->near);
  for (int row = s.y0; row <= s.y1; ++row) {
    const vfloat dy = v_load(t->dy[row]);
    vfloat rows[4];
    for (int k = 0; k < 4; ++k) {
      rows[k] = v_fma(c->b[k], dy, c->c[k]);
    }
    for (int column = s.x0; column <= s.x1; ++column) {
      const int place = (row * ACROSS + column) * STRATUS_WIDTH;
      const vfloat dx = v_load(t->dx[column]);
      vfloat near, far;
      const vmask met = meet_planes(c, fronts, rows, dx, &near, &far) & v_lt(nearest, v_load(t->open + place));
      if (m_any(met)) {
        ray_piece piece;
        cut_piece(c, dx, dy, near, far, &piece);
        put_piece(t, met, &piece, place);
      }
    }
  }
}

/* Draws a cell of one front or more. */
INLINE void draw_taken(project_tile* t, const one_cell* c, uint cell)
{
  GLOBAL const stratus_tetra_rect* rect = t->view->rects + cell;
  if (c->fronts == 1) {
    draw_by_planes(t, c, 1, rect);
  } else if (c->fronts == 2) {
    draw_by_planes(t, c, 2, rect);
  } else {
    draw_by_planes(t, c, 3, rect);
  }
}

#if STRATUS_WIDTH > 1
static void draw_cell(project_tile* t, const cell_planes* planes, int l, uint cell)
{
  one_cell c;
  if (planes->fronts[l] == 0) {
    draw_any_cell(t, cell);
    return;
  }
  take_cell(t, planes, l, &c);
  draw_taken(t, &c, cell);
}

/* Returns the depth from which on no pixel shows anything, once all are opaque. */
static float farthest_open(const project_tile* t)
{
  float farthest = -LARGEST_FLOAT;
  for (int p = 0; p < PIXELS; ++p) {
    farthest = t->open[p] > farthest ? t->open[p] : farthest;
  }
  return farthest;
}

static void draw_cells(project_tile* t, GLOBAL const uint* cells, uint count)
{
  cell_planes planes;
  float open = LARGEST_FLOAT;
  for (uint i = 0; i < count;) {
    int batch[STRATUS_WIDTH], found = 0;
    if (t->alive == 0 && open >= LARGEST_FLOAT) {
      open = farthest_open(t);
    }
    for (; found < STRATUS_WIDTH && i < count; ++i) {
      batch[found] = (int)cells[i];
      found += t->view->rects[cells[i]].near < open;
    }
    for (int l = found; l < STRATUS_WIDTH; ++l) {
      batch[l] = found ? batch[found - 1] : (int)cells[0];
    }
    if (found) {
      find_planes(t, batch, &planes);
    }
    for (int l = 0; l < found; ++l) {
      draw_cell(t, &planes, l, (uint)batch[l]);
    }
  }
  flush(t);
}

/* Draw the tile, and draw again its pixels whose pieces came out of order. */
static void draw_tile(const stratus_project_view* view, CONSTANT stratus_tetra_arguments* arguments, int tile, stratus_project_found* found)
{
  GLOBAL const uint* cells = view->bins + view->bin_begin[tile];
  const uint count = view->bin_begin[tile + 1] - view->bin_begin[tile];
  project_tile t; /* begin_tile() initializes it */
  begin_tile(&t, view, arguments, tile, 0);
  draw_cells(&t, cells, count);
  if (t.wrong > 0) {
    draw_again(&t, cells, count);
  }
  store_tile(&t, found);
}
#endif

#endif
