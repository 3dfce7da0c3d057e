/* SPDX-License-Identifier: BSD-3-Clause
 * Redraws the pixels of a tile whose pieces came out of order. Each pass collects the nearest remaining pieces of their rays from all cells
 * of the tile, then draws them in order. */
#ifndef STRATUS_TETRA_PROJECT_AGAIN_H
#define STRATUS_TETRA_PROJECT_AGAIN_H

#include "tetra_project_cells.h"

#define KEPT 64 /* pieces per pixel and pass */

/* Up to STRATUS_WIDTH wrong pixels of a tile, one per lane, with their nearest pieces in order. */
typedef struct nearest_pieces {
  int pixel[STRATUS_WIDTH], pixels; /* their places in the tile, and their number */
  float us[STRATUS_WIDTH], uw[STRATUS_WIDTH], vs[STRATUS_WIDTH], vw[STRATUS_WIDTH];
  int x0, x1, y0, y1;                            /* bounding rectangle of the pixels in the picture */
  int count[STRATUS_WIDTH], lost[STRATUS_WIDTH]; /* lost: pieces beyond KEPT were dropped */
  float at[STRATUS_WIDTH][KEPT], to[STRATUS_WIDTH][KEPT], first[STRATUS_WIDTH][KEPT], last[STRATUS_WIDTH][KEPT];
  uint rank[STRATUS_WIDTH][KEPT]; /* 1 + the place of the cell in its bin; breaks ties of depth */
  float after[STRATUS_WIDTH];
  uint after_rank[STRATUS_WIDTH]; /* depth and rank of the last piece drawn; only pieces behind it remain */
} nearest_pieces;

static int comes_before(float at, uint rank, float other, uint other_rank) { return at < other || (at <= other && rank < other_rank); }

static void keep_piece(nearest_pieces* n, int l, const float piece[4], uint rank)
{
  if (n->count[l] == KEPT) {
    n->lost[l] = 1;
    if (!comes_before(piece[0], rank, n->at[l][KEPT - 1], n->rank[l][KEPT - 1])) {
      return;
    }
    --n->count[l];
  }
  int i = n->count[l]++;
  for (; i > 0 && comes_before(piece[0], rank, n->at[l][i - 1], n->rank[l][i - 1]); --i) {
    n->at[l][i] = n->at[l][i - 1];
    n->to[l][i] = n->to[l][i - 1];
    n->first[l][i] = n->first[l][i - 1];
    n->last[l][i] = n->last[l][i - 1];
    n->rank[l][i] = n->rank[l][i - 1];
  }
  n->at[l][i] = piece[0];
  n->to[l][i] = piece[1];
  n->first[l][i] = piece[2];
  n->last[l][i] = piece[3];
  n->rank[l][i] = rank;
}

/* Collects the nearest pieces behind those already drawn. */
static void collect_nearest(const project_tile* t, GLOBAL const uint* cells, uint count, nearest_pieces* n)
{
  const vmask on = vi_lt(vi_lanes(), vi_set(n->pixels));
  for (uint i = 0; i < count; ++i) {
    GLOBAL const stratus_tetra_rect* rect = t->view->rects + cells[i];
    float lanes[4][STRATUS_WIDTH];
    int met[STRATUS_WIDTH];
    cell_points c;
    ray_piece piece;
    if (rect->x1 < n->x0 || rect->x0 > n->x1 || rect->y1 < n->y0 || rect->y0 > n->y1) {
      continue;
    }
    load_points(t, cells[i], &c);
    const vmask mask = pass_cell(&c, v_load(n->us), v_load(n->uw), v_load(n->vs), v_load(n->vw), on, &piece);
    if (!m_any(mask)) {
      continue;
    }
    vi_store(met, vi_select(mask, vi_set(1), vi_set(0)));
    v_store(lanes[0], piece.at);
    v_store(lanes[1], piece.to);
    v_store(lanes[2], piece.first);
    v_store(lanes[3], piece.last);
    for (int l = 0; l < n->pixels; ++l) {
      const float values[4] = { lanes[0][l], lanes[1][l], lanes[2][l], lanes[3][l] };
      if (met[l] && comes_before(n->after[l], n->after_rank[l], values[0], i + 1)) {
        keep_piece(n, l, values, i + 1);
      }
    }
  }
}

/* Draws the collected pieces. Returns whether more remain. */
static int draw_nearest(project_tile* t, nearest_pieces* n)
{
  int more = 0;
  for (int l = 0; l < n->pixels; ++l) {
    for (int i = 0; i < n->count[l]; ++i) {
      t->at[t->count] = n->after[l] = n->at[l][i];
      t->to[t->count] = n->to[l][i];
      t->first[t->count] = n->first[l][i];
      t->last[t->count] = n->last[l][i];
      t->pixel[t->count++] = n->pixel[l];
      n->after_rank[l] = n->rank[l][i];
      if (t->count >= PIECES) {
        flush(t);
      }
    }
    more = more || n->lost[l];
  }
  flush(t);
  return more;
}

/* Clears pixel p of the tile and adds it to the pixels to redraw. */
static void take_pixel(project_tile* t, int p, nearest_pieces* n)
{
  const int l = n->pixels++, packet = p / STRATUS_WIDTH, row = packet / ACROSS, column = packet % ACROSS, lane = p % STRATUS_WIDTH;
  const int x = t->own_x + column * PACKET_X + lane % PACKET_X, y = t->own_y + row * PACKET_Y + lane / PACKET_X;
  clear_pixel(t, p, 1);
  n->pixel[l] = p;
  n->us[l] = t->us[column][lane];
  n->uw[l] = t->uw[column][lane];
  n->vs[l] = t->vs[row][lane];
  n->vw[l] = t->vw[row][lane];
  n->x0 = x < n->x0 ? x : n->x0;
  n->x1 = x > n->x1 ? x : n->x1;
  n->y0 = y < n->y0 ? y : n->y0;
  n->y1 = y > n->y1 ? y : n->y1;
  n->after[l] = -LARGEST_FLOAT;
  n->after_rank[l] = 0;
}

static void draw_again(project_tile* t, GLOBAL const uint* cells, uint count)
{
  nearest_pieces n;
  for (int p = 0; p < PIXELS;) {
    n.pixels = 0;
    n.x0 = n.y0 = 0x7fffffff;
    n.x1 = n.y1 = -1;
    for (int l = 0; l < STRATUS_WIDTH; ++l) { /* lanes without a pixel need finite numbers */
      n.us[l] = n.uw[l] = n.vs[l] = n.vw[l] = 0.0f;
    }
    for (; p < PIXELS && n.pixels < STRATUS_WIDTH; ++p) {
      if (t->pixels[p].wrong) {
        take_pixel(t, p, &n);
      }
    }
    t->again += (uint)n.pixels;
    for (int more = n.pixels > 0; more;) {
      for (int l = 0; l < STRATUS_WIDTH; ++l) {
        n.count[l] = n.lost[l] = 0;
      }
      collect_nearest(t, cells, count, &n);
      more = draw_nearest(t, &n);
    }
  }
}

#endif
