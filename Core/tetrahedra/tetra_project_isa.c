/* SPDX-License-Identifier: BSD-3-Clause
 * Projection of tetrahedra for one instruction set, STRATUS_ISA: the outlines of cells, one cell per lane, then the cells of a tile, one
 * pixel per lane. A pixel depends only on its cells and their order, not on the number of lanes. A wrong order of cells (across gaps, in
 * cycles, in overlaps) is noticed when a piece begins before the last one ends. Such pixels are redrawn, nearest pieces first. */
#include "tetra_project_again.h"
#include "tetra_project_cells.h"

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-function" /* this file uses only some of the headers' functions */
#endif

/* ---- outlines, one cell per lane */

static vmask transparent(const stratus_tetra_projection* projection, vmask mask, vfloat lo, vfloat hi)
{
  const stratus_table* table = projection->frame->table;
  const stratus_table_arguments* a = &projection->frame->arguments.table;
  /* exceeds the rounding of interpolation, as in stratus_table_shows() */
  const vfloat slack = v_set(1e-6f) * v_max(v_abs(lo), v_abs(hi));
  const vint first = table_entry(a, table->next_shown, lo - slack), last = table_entry(a, table->next_shown, hi + slack);
  return mask & vi_lt(last, v_gather_ints(table->next_shown, first, mask));
}

/* Finds the first and last pixel whose centre may lie within lo..hi; -1..1 spans `pixels`. */
static void pixel_span(vfloat lo, vfloat hi, int pixels, vint* first, vint* last)
{
  const vfloat half = v_set(0.5f * (float)pixels), shift = v_set(0.5f * (float)pixels - 0.5f), slack = v_set(1e-3f + 2e-6f * (float)pixels);
  const vfloat low = v_clamp(v_fma(lo, half, shift) - slack, 0.0f, (float)pixels), high = v_fma(hi, half, shift) + slack;
  *first = v_to_int(low);
  *first = vi_select(v_lt(v_from_int(*first), low), *first + vi_set(1), *first);
  *last = v_to_int(v_clamp(high, 0.0f, (float)(pixels - 1)));
  *last = vi_select(v_lt(high, v_set(0.0f)), vi_set(-1), *last);
}

int64_t STRATUS_ISA_NAME(stratus_tetra_outlines)(const stratus_tetra_projection* projection, int64_t first, int64_t beyond)
{
  const stratus_tetra_frame* frame = projection->frame;
  const vfloat middle = v_set(frame->arguments.middle), shear = v_set(frame->arguments.shear);
  const stratus_tetra_rect nowhere = { 1, 0, 1, 0, 0.0f };
  int64_t found = 0;
  for (int64_t cell = first; cell < beyond; cell += WIDTH) {
    const int64_t left = beyond - cell;
    const vint lane = vi_min(vi_lanes(), vi_set(left < WIDTH ? (int)left - 1 : WIDTH - 1)), at = vi_set((int)cell) + lane;
    vfloat lo[2], hi[2], near = v_set(LARGEST_FLOAT), far = v_set(-LARGEST_FLOAT), least = near, most = far, nearest = near;
    vmask on;
    int shown[WIDTH], covered[WIDTH], behind[WIDTH], x0[WIDTH], x1[WIDTH], y0[WIDTH], y1[WIDTH];
    lo[0] = lo[1] = near;
    hi[0] = hi[1] = far;
    for (int l = 0; l < WIDTH; ++l) {
      shown[l] = l < left ? projection->shown[cell + l] : 0;
    }
    on = vi_lt(vi_set(0), vi_load(shown));
    if (!m_any(on)) {
      for (int l = 0; l < WIDTH && l < left; ++l) {
        projection->rects[cell + l] = nowhere;
      }
      continue;
    }
    for (int i = 0; i < 4; ++i) {
      vfloat p[4];
      gather_four(frame->points, v_gather_ints(projection->vertices, (at << vi_set(2)) + vi_set(i), on), on, p);
      const vfloat w = v_fma(shear, p[2], middle);
      near = v_min(near, p[2]);
      far = v_max(far, p[2]);
      nearest = v_min(nearest, w);
      least = v_min(least, p[3]);
      most = v_max(most, p[3]);
      for (int side = 0; side < 2; ++side) {
        const vfloat u = p[side] / w;
        lo[side] = v_min(lo[side], u);
        hi[side] = v_max(hi[side], u);
      }
    }
    if (projection->cell_values) {
      float value[WIDTH];
      for (int l = 0; l < WIDTH; ++l) {
        value[l] = shown[l] ? projection->cell_values[cell + l] : 0.0f;
      }
      least = most = v_load(value);
    }
    on = on & v_lt(v_set(projection->begin), far) & v_lt(near, v_set(projection->end));
    if (!frame->arguments.maximum) {
      on = m_andnot(on, transparent(projection, on, least, most));
    }
    const vmask crossing = on & v_lt(nearest, v_set(NEAREST_OUTLINE));
    vint span[4];
    pixel_span(lo[0], hi[0], frame->image.width, span, span + 1);
    pixel_span(lo[1], hi[1], frame->image.height, span + 2, span + 3);
    float nearest_z[WIDTH];
    v_store(nearest_z, near);
    vi_store(x0, span[0]);
    vi_store(x1, span[1]);
    vi_store(y0, span[2]);
    vi_store(y1, span[3]);
    vi_store(covered, vi_select(on, vi_set(1), vi_set(0)));
    vi_store(behind, vi_select(crossing, vi_set(1), vi_set(0)));
    for (int l = 0; l < WIDTH && l < left; ++l) {
      stratus_tetra_rect rect = nowhere;
      if (behind[l]) {
        rect = stratus_tetra_outline_cut(projection, cell + l);
      } else if (covered[l] && x0[l] <= x1[l] && y0[l] <= y1[l]) {
        rect = (stratus_tetra_rect){ (uint16_t)x0[l], (uint16_t)x1[l], (uint16_t)y0[l], (uint16_t)y1[l], nearest_z[l] };
      }
      projection->rects[cell + l] = rect;
      found += rect.x0 <= rect.x1;
    }
  }
  return found;
}

/* ---- cells of a tile */

/* Stores the lanes of `mask` one after another at `place`. Up to WIDTH floats are overwritten. */
INLINE void put_floats(float* place, vmask mask, vfloat value)
{
#if STRATUS_ISA == 2
  _mm512_storeu_ps(place, _mm512_maskz_compress_ps(mask, value));
#else
  float lanes[WIDTH];
  int on[WIDTH];
  v_store(lanes, value);
  vi_store(on, vi_select(mask, vi_set(1), vi_set(0)));
  for (int l = 0, n = 0; l < WIDTH; n += on[l++]) {
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
  put_floats((float*)(void*)(t->pixel + t->count), mask, v_from_bits(vi_lanes() + vi_set(place)));
  t->count += m_count(mask);
  if (t->count >= PIECES) {
    flush(t);
  }
}

/* The packets that a cell may cover. */
typedef struct span {
  int x0, x1, y0, y1;
} span;

static span span_of(const project_tile* t, const stratus_tetra_rect* rect)
{
  const int x0 = rect->x0 > t->x0 ? rect->x0 - t->x0 : 0, x1 = rect->x1 - t->x0 < t->width ? rect->x1 - t->x0 : t->width - 1;
  const int y0 = rect->y0 > t->y0 ? rect->y0 - t->y0 : 0, y1 = rect->y1 - t->y0 < t->height ? rect->y1 - t->y0 : t->height - 1;
  return (span){ x0 / PACKET_X, x1 / PACKET_X, y0 / PACKET_Y, y1 / PACKET_Y };
}

static void draw_any_cell(project_tile* t, uint32_t cell)
{
  const stratus_tetra_rect* rect = t->projection->rects + cell;
  const span s = span_of(t, rect);
  const vfloat near = v_set(rect->near);
  cell_points c;
  load_points(t->projection, cell, &c);
  for (int row = s.y0; row <= s.y1; ++row) {
    for (int column = s.x0; column <= s.x1; ++column) {
      const int place = (row * ACROSS + column) * WIDTH;
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
INLINE void draw_by_planes(project_tile* t, const one_cell* c, int fronts, const stratus_tetra_rect* rect)
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
      const int place = (row * ACROSS + column) * WIDTH;
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

static void draw_cell(project_tile* t, const cell_planes* planes, int l, uint32_t cell)
{
  const stratus_tetra_rect* rect = t->projection->rects + cell;
  one_cell c;
  if (planes->fronts[l] == 0) {
    draw_any_cell(t, cell);
    return;
  }
  take_cell(t, planes, l, &c);
  if (c.fronts == 1) {
    draw_by_planes(t, &c, 1, rect);
  } else if (c.fronts == 2) {
    draw_by_planes(t, &c, 2, rect);
  } else {
    draw_by_planes(t, &c, 3, rect);
  }
}

/* Returns the depth from which on no pixel shows anything, once all are opaque. */
static float farthest_open(const project_tile* t)
{
  float farthest = -LARGEST_FLOAT;
  for (int p = 0; p < PIXELS; ++p) {
    farthest = fmaxf(farthest, t->open[p]);
  }
  return farthest;
}

static void draw_cells(project_tile* t, const uint32_t* cells, uint32_t count)
{
  cell_planes planes;
  float open = LARGEST_FLOAT;
  for (uint32_t i = 0; i < count;) {
    int batch[WIDTH], found = 0;
    if (t->alive == 0 && open >= LARGEST_FLOAT) {
      open = farthest_open(t);
    }
    for (; found < WIDTH && i < count; ++i) {
      batch[found] = (int)cells[i];
      found += t->projection->rects[cells[i]].near < open;
    }
    for (int l = found; l < WIDTH; ++l) {
      batch[l] = found ? batch[found - 1] : (int)cells[0];
    }
    if (found) {
      find_planes(t, batch, &planes);
    }
    for (int l = 0; l < found; ++l) {
      draw_cell(t, &planes, l, (uint32_t)batch[l]);
    }
  }
  flush(t);
}

void STRATUS_ISA_NAME(stratus_tetra_project_tile)(
  const stratus_tetra_projection* projection, int tile, stratus_tetra_project_counts* counts)
{
  const uint32_t begin = projection->bin_begin[tile], count = projection->bin_begin[tile + 1] - begin;
  project_tile t; /* begin_tile() initializes it */
  t.projection = projection;
  t.counts = counts;
  begin_tile(&t, tile);
  draw_cells(&t, projection->bins + begin, count);
  if (t.wrong > 0) {
    draw_again(&t, projection->bins + begin, count);
  }
  store_tile(&t);
}
