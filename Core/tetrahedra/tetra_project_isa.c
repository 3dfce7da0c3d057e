/* SPDX-License-Identifier: BSD-3-Clause
 * Projection of tetrahedra on the host, for one instruction set, STRATUS_ISA: the outlines of cells, one cell per lane, then
 * kernels/tetrahedra/tetra_project_draw.h, one pixel per lane. */
#include "tetra_project.h"

#include "tetra_project_draw.h"

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

/* Finds the first and last pixel whose centre may be within lo..hi; -1..1 spans `pixels`. */
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
  for (int64_t cell = first; cell < beyond; cell += STRATUS_WIDTH) {
    const int64_t left = beyond - cell;
    const vint lane = vi_min(vi_lanes(), vi_set(left < STRATUS_WIDTH ? (int)left - 1 : STRATUS_WIDTH - 1)), at = vi_set((int)cell) + lane;
    vfloat lo[2], hi[2], near = v_set(LARGEST_FLOAT), far = v_set(-LARGEST_FLOAT), least = near, most = far, nearest = near;
    vmask on;
    int shown[STRATUS_WIDTH], covered[STRATUS_WIDTH], behind[STRATUS_WIDTH], x0[STRATUS_WIDTH], x1[STRATUS_WIDTH], y0[STRATUS_WIDTH],
      y1[STRATUS_WIDTH];
    lo[0] = lo[1] = near;
    hi[0] = hi[1] = far;
    for (int l = 0; l < STRATUS_WIDTH; ++l) {
      shown[l] = l < left ? projection->shown[cell + l] : 0;
    }
    on = vi_lt(vi_set(0), vi_load(shown));
    if (!m_any(on)) {
      for (int l = 0; l < STRATUS_WIDTH && l < left; ++l) {
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
      float value[STRATUS_WIDTH];
      for (int l = 0; l < STRATUS_WIDTH; ++l) {
        value[l] = shown[l] ? projection->cell_values[cell + l] : 0.0f;
      }
      least = most = v_load(value);
    }
    on = on & v_lt(v_set(projection->begin), far) & v_lt(near, v_set(projection->end));
    if (frame->arguments.mode != TETRA_EXTREMES) {
      on = m_andnot(on, transparent(projection, on, least, most));
    }
    const vmask crossing = on & v_lt(nearest, v_set(NEAREST_OUTLINE));
    vint span[4];
    pixel_span(lo[0], hi[0], frame->image.width, span, span + 1);
    pixel_span(lo[1], hi[1], frame->image.height, span + 2, span + 3);
    float nearest_z[STRATUS_WIDTH];
    v_store(nearest_z, near);
    vi_store(x0, span[0]);
    vi_store(x1, span[1]);
    vi_store(y0, span[2]);
    vi_store(y1, span[3]);
    vi_store(covered, vi_select(on, vi_set(1), vi_set(0)));
    vi_store(behind, vi_select(crossing, vi_set(1), vi_set(0)));
    for (int l = 0; l < STRATUS_WIDTH && l < left; ++l) {
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

/* ---- the cells of a tile */

static stratus_project_view view_of(const stratus_tetra_projection* projection)
{
  const stratus_tetra_frame* frame = projection->frame;
  return (stratus_project_view){ .vertices = projection->vertices,
    .points = frame->points,
    .cell_values = projection->cell_values,
    .sums = frame->march_sums,
    .colors = frame->table->rgba,
    .lines = frame->us,
    .ends = frame->ends,
    .rects = projection->rects,
    .bin_begin = projection->bin_begin,
    .bins = projection->bins,
    .picture = { frame->image.rgba, frame->image.rgba8, frame->image.depth, frame->image.samples } };
}

void STRATUS_ISA_NAME(stratus_tetra_project_tile)(
  const stratus_tetra_projection* projection, int tile, stratus_tetra_project_counts* counts)
{
  const stratus_project_view view = view_of(projection);
  stratus_project_found found;
  draw_tile(&view, &projection->frame->arguments, tile, &found);
  counts->rays += found.rays;
  counts->segments += found.segments;
  counts->again += found.again;
}
