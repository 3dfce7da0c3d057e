/* SPDX-License-Identifier: BSD-3-Clause
 * A tile of pixels under projection: what its pixels have gathered, and pieces of cells on their way there. Included by tetra_project_host.c.
 * Pieces are shaded a piece a lane, then put behind what their pixels have gathered, one after the other. */
#ifndef STRATUS_TETRA_PROJECT_TILE_H
#define STRATUS_TETRA_PROJECT_TILE_H

#include "tetra_project.h"

#include "../kernels/tetra_march.h"

#define WIDTH STRATUS_WIDTH
#define PIXELS (PROJECT_TILE * PROJECT_TILE)
#define ACROSS (PROJECT_TILE / PACKET_X) /* packets side by side in a tile */
#define UPWARDS (PROJECT_TILE / PACKET_Y)
#define PIECES 1024 /* collected before they are shaded */

/* A piece lies before the last one of its pixel, out of order, if it begins by more before that one's end than rounding explains: a share of both
 * depths, and of its length. */
#define OUT_OF_ORDER 0x1p-20f
#define OUT_OF_ORDER_LENGTH 0x1p-8f

/* Pixels lie packet by packet: pixel p is lane p % WIDTH of packet p / WIDTH. */
typedef struct project_tile {
  const stratus_tetra_projection* projection;
  stratus_tetra_project_counts* counts;
  int x0, y0, width, height, alive;
  float us[ACROSS][WIDTH], uw[ACROSS][WIDTH], vs[UPWARDS][WIDTH], vw[UPWARDS][WIDTH];
  float dx[ACROSS][WIDTH], dy[UPWARDS][WIDTH]; /* from the tile's first pixel, in pixels */
  float length[PIXELS], offset[PIXELS], end[PIXELS]; /* world distance = offset + length z */
  float transparency[PIXELS], red[PIXELS], green[PIXELS], blue[PIXELS], depth[PIXELS];
  float back[PIXELS];  /* where the last piece ends */
  float open[PIXELS];  /* what begins behind it need not be looked at: no end, until the pixel is opaque */
  uint32_t samples[PIXELS];
  uint8_t wrong[PIXELS]; /* 1: pieces came out of order */
  int count; /* pieces */
  float at[PIECES + 2 * WIDTH], to[PIECES + 2 * WIDTH], first[PIECES + 2 * WIDTH], last[PIECES + 2 * WIDTH];
  int pixel[PIECES + 2 * WIDTH];
} project_tile;

static int place_of(int x, int y)
{
  return (y / PACKET_Y * ACROSS + x / PACKET_X) * WIDTH + y % PACKET_Y * PACKET_X + x % PACKET_X;
}

/* What is seen of a ray ends at the far plane, or at what is opaque; in z. */
static float end_of(const stratus_tetra_projection* projection, int x, int y)
{
  const stratus_tetra_frame* frame = projection->frame;
  const stratus_camera* c = &frame->camera;
  if (!frame->image.opaque_depth) {
    return projection->end;
  }
  const double extent = (double)frame->image.opaque_depth[(size_t)y * (size_t)frame->image.width + (size_t)x] * (c->far_k - c->near_k);
  const double end = c->parallel ? c->near_k + extent : c->near_k * c->far_k / (c->far_k - extent);
  return (float)fmin((end - frame->middle) / frame->per_z, 1e30);
}

/* Nothing gathered yet. Pixels beyond the picture are closed. */
static void clear_pixel(project_tile* t, int p, bool inside)
{
  t->red[p] = t->green[p] = t->blue[p] = 0.0f;
  t->transparency[p] = inside ? 1.0f : -1.0f;
  t->depth[p] = t->projection->frame->arguments.maximum ? -LARGEST_FLOAT : LARGEST_FLOAT;
  t->back[p] = -LARGEST_FLOAT;
  t->open[p] = inside ? LARGEST_FLOAT : -LARGEST_FLOAT;
  t->samples[p] = 0;
}

static void begin_tile(project_tile* t, int tile)
{
  const stratus_tetra_frame* frame = t->projection->frame;
  const stratus_image* image = &frame->image;
  const stratus_camera* c = &frame->camera;
  t->x0 = tile % t->projection->columns * PROJECT_TILE;
  t->y0 = tile / t->projection->columns * PROJECT_TILE;
  t->width = image->width - t->x0 < PROJECT_TILE ? image->width - t->x0 : PROJECT_TILE;
  t->height = image->height - t->y0 < PROJECT_TILE ? image->height - t->y0 : PROJECT_TILE;
  t->alive = t->width * t->height;
  t->count = 0;
  memset(t->wrong, 0, sizeof t->wrong);
  for (int y = 0; y < PROJECT_TILE; ++y) {
    for (int x = 0; x < PROJECT_TILE; ++x) {
      const int p = place_of(x, y), lane = p % WIDTH;
      const bool inside = x < t->width && y < t->height;
      t->us[x / PACKET_X][lane] = frame->us[t->x0 + x];
      t->uw[x / PACKET_X][lane] = frame->uw[t->x0 + x];
      t->vs[y / PACKET_Y][lane] = frame->vs[t->y0 + y];
      t->vw[y / PACKET_Y][lane] = frame->vw[t->y0 + y];
      t->dx[x / PACKET_X][lane] = (float)x;
      t->dy[y / PACKET_Y][lane] = (float)y;
      clear_pixel(t, p, inside);
      const double u = (2.0 * (t->x0 + x) + 1.0) / image->width - 1.0, v = (2.0 * (t->y0 + y) + 1.0) / image->height - 1.0;
      double square = 0.0;
      for (int axis = 0; axis < 3; ++axis) {
        const double along = c->forward[axis] + (c->parallel ? 0.0 : u * c->right[axis] + v * c->up[axis]);
        square += along * along;
      }
      t->length[p] = (float)(sqrt(square) * frame->per_z);
      t->offset[p] = (float)(sqrt(square) * frame->middle);
      t->end[p] = inside ? end_of(t->projection, t->x0 + x, t->y0 + y) : -LARGEST_FLOAT;
    }
  }
}

/* ---- pieces */

typedef struct layers {
  float red[WIDTH], green[WIDTH], blue[WIDTH], transparency[WIDTH], depth[WIDTH];
  int visible[WIDTH];
} layers;

INLINE vfloat gather_floats(const float* from, vint at, vmask mask)
{
  return v_from_bits(v_gather_ints((const int*)(const void*)from, at, mask));
}

INLINE void shade_pieces(project_tile* t, int i, layers* out)
{
  const stratus_tetra_arguments* a = &t->projection->frame->arguments;
  const vint pixel = vi_load(t->pixel + i);
  const vfloat at = v_load(t->at + i), to = v_load(t->to + i);
  vfloat first = v_load(t->first + i), last = v_load(t->last + i), near = v_set(0.0f);
  vmask mask = vi_lt(vi_lanes(), vi_set(t->count - i));
  const vfloat length = gather_floats(t->length, pixel, mask);
  const bool cut_behind = t->projection->frame->image.opaque_depth != NULL;
  const vfloat far = cut_behind ? gather_floats(t->end, pixel, mask) : v_set(t->projection->end);
  const vfloat begin = v_max(at, v_set(t->projection->begin)), end = v_min(to, far);
  mask = mask & v_lt(begin, end);
  const vmask cut = mask & (v_lt(at, begin) | v_lt(end, to));
  if (m_any(cut)) {
    const vfloat slope = (last - first) * v_reciprocal(v_max(to - at, v_set(1e-30f))), start = first;
    first = v_select(cut, v_fma(slope, begin - at, start), first);
    last = v_select(cut, v_fma(slope, end - at, start), last);
  }
  if (a->table.want_depth || a->maximum) {
    const vfloat offset = gather_floats(t->offset, pixel, mask);
    near = v_fma(begin, length, offset);
    v_store(out->depth, v_select(v_lt(first, last), v_fma(end, length, offset), near));
  }
  vi_store(out->visible, vi_select(mask, vi_set(1), vi_set(0)));
  if (a->maximum) { /* red: the value, depth: where */
    v_store(out->red, v_max(first, last));
    return;
  }
  stratus_packet k;
  k.red = k.green = k.blue = k.first = v_set(0.0f);
  k.transparency = v_set(1.0f);
  k.depth = v_set(LARGEST_FLOAT);
  k.front = first;
  integrate_segment(&a->table, t->projection->frame->sums, &k, mask, last, (end - begin) * length, near);
  v_store(out->red, k.red);
  v_store(out->green, k.green);
  v_store(out->blue, k.blue);
  v_store(out->transparency, k.transparency);
  v_store(out->depth, k.depth);
}

static void composite_pieces(project_tile* t, int i, int count, const layers* layer)
{
  const float termination = t->projection->frame->arguments.table.termination;
  for (int l = 0; l < count; ++l) {
    const int p = t->pixel[i + l];
    const float clear = t->transparency[p], at = t->at[i + l], to = t->to[i + l], back = t->back[p];
    const bool ended = clear < termination;
    if (!layer->visible[l] || (ended && at >= back)) {
      continue;
    }
    if (layer->transparency[l] < 1.0f) {
      t->wrong[p] |= at < back - (OUT_OF_ORDER * (fabsf(at) + fabsf(back)) + OUT_OF_ORDER_LENGTH * (to - at));
      t->back[p] = to > back && !ended ? to : back;
    }
    if (!ended) {
      t->red[p] += clear * layer->red[l];
      t->green[p] += clear * layer->green[l];
      t->blue[p] += clear * layer->blue[l];
      t->transparency[p] = clear * layer->transparency[l];
      t->depth[p] = layer->depth[l] < LARGEST_FLOAT && t->depth[p] >= LARGEST_FLOAT ? layer->depth[l] : t->depth[p];
      ++t->samples[p];
      if (t->transparency[p] < termination) {
        t->open[p] = t->back[p];
        --t->alive;
      }
    }
  }
}

/* depth holds the largest value, red where it is: the nearest place, if there are several. */
static void take_largest(project_tile* t, int i, int count, const layers* layer)
{
  for (int l = 0; l < count; ++l) {
    const int p = t->pixel[i + l];
    if (layer->visible[l]) {
      const float value = layer->red[l], where = layer->depth[l];
      const bool more = value > t->depth[p] || (value >= t->depth[p] && where < t->red[p]);
      t->red[p] = more ? where : t->red[p];
      t->depth[p] = more ? value : t->depth[p];
      ++t->samples[p];
    }
  }
}

static void flush(project_tile* t)
{
  for (int i = 0; i < t->count; i += WIDTH) {
    const int count = t->count - i < WIDTH ? t->count - i : WIDTH;
    layers layer;
    shade_pieces(t, i, &layer);
    if (t->projection->frame->arguments.maximum) {
      take_largest(t, i, count, &layer);
    } else {
      composite_pieces(t, i, count, &layer);
    }
  }
  t->count = 0;
}

static void store_pixel(const project_tile* t, int p, size_t pixel)
{
  const stratus_tetra_frame* frame = t->projection->frame;
  const stratus_image* image = &frame->image;
  float rgba[4] = { t->red[p], t->green[p], t->blue[p], 1.0f - t->transparency[p] }, depth = t->depth[p];
  if (frame->arguments.maximum) {
    const bool any = t->samples[p] > 0;
    const float* entry = frame->table->rgba + 4 * (size_t)stratus_table_entry(frame->table, t->depth[p]);
    depth = any ? t->red[p] : LARGEST_FLOAT;
    for (int c = 0; c < 4; ++c) {
      rgba[c] = any ? entry[c] : 0.0f;
    }
  }
  memcpy(image->rgba + 4 * pixel, rgba, sizeof rgba);
  if (image->depth) {
    image->depth[pixel] = rgba[3] > 0.0f && depth < LARGEST_FLOAT ? depth : INFINITY;
  }
  if (image->samples) {
    image->samples[pixel] = t->samples[p];
  }
  for (int c = 0; image->rgba8 && c < 4; ++c) {
    const float value = rgba[c] * 255.0f + 0.5f;
    image->rgba8[4 * pixel + (size_t)c] = (uint8_t)(int)(value < 255.0f ? value : 255.0f); /* premultiplied light is never below 0 */
  }
}

static void store_tile(const project_tile* t)
{
  for (int y = 0; y < t->height; ++y) {
    for (int x = 0; x < t->width; ++x) {
      const int p = place_of(x, y);
      store_pixel(t, p, (size_t)(t->y0 + y) * (size_t)t->projection->frame->image.width + (size_t)(t->x0 + x));
      t->counts->rays += t->samples[p] > 0;
      t->counts->segments += t->samples[p];
    }
  }
}

#endif
