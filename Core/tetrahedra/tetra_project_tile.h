/* SPDX-License-Identifier: BSD-3-Clause
 * A tile of pixels under projection: its pixels, and a buffer of pieces. A piece is the part of a pixel's ray inside a cell. Pieces are
 * shaded one per lane, then composited one after another behind what their pixels hold. Included by tetra_project_isa.c. */
#ifndef STRATUS_TETRA_PROJECT_TILE_H
#define STRATUS_TETRA_PROJECT_TILE_H

#include "tetra_project.h"

#include "tetra_march.h"

#define WIDTH STRATUS_WIDTH
#define PIXELS (PROJECT_TILE * PROJECT_TILE)
#define ACROSS (PROJECT_TILE / PACKET_X) /* packets side by side in a tile */
#define UPWARDS (PROJECT_TILE / PACKET_Y)
#define PIECES 256 /* size of the buffer: few enough pieces to stay in the innermost cache */

/* A piece is out of order if it begins before the end of its pixel's last piece by more than rounding explains: OUT_OF_ORDER of its depth
 * plus OUT_OF_ORDER_LENGTH of its length. */
#define OUT_OF_ORDER 0x1p-19f
#define OUT_OF_ORDER_LENGTH 0x1p-8f

typedef float four_floats __attribute__((vector_size(16), may_alias));

/* A pixel: the pieces composited so far. */
typedef struct tile_pixel {
  four_floats light; /* red, green, blue, transparency; maximum: distance of the largest value, that value, two unused */
  float back;        /* z where the last visible piece ends */
  float depth;
  uint32_t samples;
  uint32_t wrong; /* 1: pieces came out of order */
} tile_pixel;

/* Pixels are stored packet by packet: pixel p is lane p % WIDTH of packet p / WIDTH. */
typedef struct project_tile {
  const stratus_tetra_projection* projection;
  stratus_tetra_project_counts* counts;
  int x0, y0, width, height, alive;
  float us[ACROSS][WIDTH], uw[ACROSS][WIDTH], vs[UPWARDS][WIDTH], vw[UPWARDS][WIDTH];
  float dx[ACROSS][WIDTH], dy[UPWARDS][WIDTH]; /* from the tile's first pixel, in pixels */
  float length[PIXELS], offset[PIXELS];        /* world distance = offset + length z */
  float begin[PIXELS], end[PIXELS];            /* the visible part of the ray, in z */
  float open[PIXELS];                          /* pieces that begin behind it are invisible; LARGEST_FLOAT until the pixel is opaque */
  tile_pixel pixels[PIXELS];
  int wrong; /* number of wrong pixels */
  int count; /* pieces in the buffer */
  float at[PIECES + 2 * WIDTH], to[PIECES + 2 * WIDTH], first[PIECES + 2 * WIDTH], last[PIECES + 2 * WIDTH];
  int pixel[PIECES + 2 * WIDTH];
} project_tile;

static int place_of(int x, int y)
{
  return (y / PACKET_Y * ACROSS + x / PACKET_X) * WIDTH + y % PACKET_Y * PACKET_X + x % PACKET_X;
}

/* Empties a pixel. Pixels beyond the picture are closed: they take no pieces. */
static void clear_pixel(project_tile* t, int p, bool inside)
{
  const bool maximum = t->projection->frame->arguments.maximum;
  t->pixels[p] =
    (tile_pixel){ .light = { 0.0f, maximum ? -LARGEST_FLOAT : 0.0f, 0.0f, 1.0f }, .back = -LARGEST_FLOAT, .depth = LARGEST_FLOAT };
  t->open[p] = inside ? LARGEST_FLOAT : -LARGEST_FLOAT;
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
  t->wrong = 0;
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
      const double middle = stratus_tetra_middle(frame, t->x0 + x, t->y0 + y);
      t->length[p] = (float)(sqrt(square) * frame->per_z);
      t->offset[p] = (float)(sqrt(square) * middle);
      const size_t pixel = (size_t)(t->y0 + y) * (size_t)image->width + (size_t)(t->x0 + x);
      const float end = inside && frame->ends ? frame->ends[pixel] : (float)fmin((c->far_k - middle) / frame->per_z, 1e30);
      t->begin[p] = (float)((c->near_k - middle) / frame->per_z);
      t->end[p] = inside ? end : -LARGEST_FLOAT;
    }
  }
}

/* ---- pieces */

/* WIDTH shaded pieces. maximum: light holds the distance of the end with the larger value, and that value. */
typedef struct layers {
  four_floats light[WIDTH]; /* red, green, blue, transparency - 1 */
  float limit[WIDTH];       /* the piece is out of order if another ends behind this */
  float to[WIDTH], depth[WIDTH];
  int visible[WIDTH];
} layers;

INLINE vfloat gather_floats(const float* from, vint at, vmask mask)
{
  return v_from_bits(v_gather_ints((const int*)(const void*)from, at, mask));
}

INLINE void put_light(layers* out, vfloat red, vfloat green, vfloat blue, vfloat less)
{
#if STRATUS_ISA == 2
  const __m512 rg = _mm512_unpacklo_ps(red, green), rg_high = _mm512_unpackhi_ps(red, green);
  const __m512 bt = _mm512_unpacklo_ps(blue, less), bt_high = _mm512_unpackhi_ps(blue, less);
  const __m512 rows[4] = { _mm512_shuffle_ps(rg, bt, 0x44), _mm512_shuffle_ps(rg, bt, 0xee), _mm512_shuffle_ps(rg_high, bt_high, 0x44),
    _mm512_shuffle_ps(rg_high, bt_high, 0xee) };
  for (int i = 0; i < 4; ++i) { /* row i: lanes i, 4 + i, 8 + i, 12 + i */
    out->light[i] = (four_floats)_mm512_castps512_ps128(rows[i]);
    out->light[4 + i] = (four_floats)_mm512_extractf32x4_ps(rows[i], 1);
    out->light[8 + i] = (four_floats)_mm512_extractf32x4_ps(rows[i], 2);
    out->light[12 + i] = (four_floats)_mm512_extractf32x4_ps(rows[i], 3);
  }
#else
  float lanes[4][WIDTH];
  v_store(lanes[0], red);
  v_store(lanes[1], green);
  v_store(lanes[2], blue);
  v_store(lanes[3], less);
  for (int l = 0; l < WIDTH; ++l) {
    out->light[l] = (four_floats){ lanes[0][l], lanes[1][l], lanes[2][l], lanes[3][l] };
  }
#endif
}

INLINE void shade_pieces(project_tile* t, int i, layers* out)
{
  const stratus_tetra_frame* frame = t->projection->frame;
  const stratus_tetra_arguments* a = &frame->arguments;
  const vfloat zero = v_set(0.0f), one = v_set(1.0f);
  const vint pixel = vi_load(t->pixel + i);
  const vfloat at = v_load(t->at + i), to = v_load(t->to + i);
  vfloat first = v_load(t->first + i), last = v_load(t->last + i), near = zero;
  vmask mask = vi_lt(vi_lanes(), vi_set(t->count - i));
  const vfloat length = gather_floats(t->length, pixel, mask);
  const bool differ = t->projection->rays_differ;
  const vfloat nearest = differ ? gather_floats(t->begin, pixel, mask) : v_set(t->projection->begin);
  const vfloat farthest = differ ? gather_floats(t->end, pixel, mask) : v_set(t->projection->end);
  const vfloat begin = v_max(at, nearest), end = v_min(to, farthest);
  mask = mask & v_lt(begin, end);
  const vmask cut = mask & (v_lt(at, begin) | v_lt(end, to));
  if (m_any(cut)) {
    const vfloat slope = (last - first) * v_reciprocal(v_max(to - at, v_set(1e-30f))), start = first;
    first = v_select(cut, v_fma(slope, begin - at, start), first);
    last = v_select(cut, v_fma(slope, end - at, start), last);
  }
  vi_store(out->visible, vi_select(mask, vi_set(1), vi_set(0)));
  if (a->picture.want_depth || a->maximum) {
    near = v_fma(begin, length, gather_floats(t->offset, pixel, mask));
  }
  if (a->maximum) {
    const vfloat beyond = v_fma(end, length, gather_floats(t->offset, pixel, mask));
    put_light(out, v_select(v_lt(first, last), beyond, near), v_max(first, last), zero, zero);
    return;
  }
  stratus_tetra_light light = {
    .red = zero, .green = zero, .blue = zero, .transparency = one, .depth = v_set(LARGEST_FLOAT), .most = zero
  };
  const stratus_tetra_place from = tetra_place(a, frame->march_sums, first, mask), until = tetra_place(a, frame->march_sums, last, mask);
  tetra_integrate(a, frame->march_sums, &light, mask, first, last, &from, &until, (end - begin) * length, near);
  const vmask counts = mask & v_lt(light.transparency, one);
  put_light(out, light.red, light.green, light.blue, light.transparency - one);
  v_store(out->depth, light.depth);
  v_store(out->to, v_select(counts, to, v_set(-LARGEST_FLOAT)));
  v_store(out->limit,
    v_select(counts, v_fma(v_abs(at), v_set(OUT_OF_ORDER), v_fma(to - at, v_set(OUT_OF_ORDER_LENGTH), at)), v_set(LARGEST_FLOAT)));
}

static void find_wrong(project_tile* t, tile_pixel* p)
{
  t->wrong += p->wrong == 0;
  p->wrong = 1;
}

static void composite_pieces(project_tile* t, int i, int count, const layers* layer)
{
  const stratus_tetra_arguments* a = &t->projection->frame->arguments;
  const float termination = a->termination;
  for (int l = 0; l < count; ++l) {
    tile_pixel* p = t->pixels + t->pixel[i + l];
    const float clear = p->light[3];
    if (p->back > layer->limit[l]) {
      find_wrong(t, p);
    }
    if (!layer->visible[l] || clear < termination) {
      continue;
    }
    p->light += clear * layer->light[l];
    p->back = layer->to[l] > p->back ? layer->to[l] : p->back;
    ++p->samples;
    if (a->picture.want_depth && p->depth >= LARGEST_FLOAT) {
      p->depth = layer->depth[l];
    }
    if (p->light[3] < termination) {
      t->open[t->pixel[i + l]] = p->back;
      --t->alive;
    }
  }
}

/* Keeps the largest value, and of equal ones the nearest. */
static void take_largest(project_tile* t, int i, int count, const layers* layer)
{
  for (int l = 0; l < count; ++l) {
    tile_pixel* p = t->pixels + t->pixel[i + l];
    if (layer->visible[l]) {
      const float value = layer->light[l][1], where = layer->light[l][0];
      if (value > p->light[1] || (value >= p->light[1] && where < p->light[0])) {
        p->light = layer->light[l];
      }
      ++p->samples;
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

static void store_pixel(const project_tile* t, const tile_pixel* p, size_t pixel)
{
  const stratus_tetra_frame* frame = t->projection->frame;
  const stratus_image* image = &frame->image;
  /* rounding may lift sums above 1 */
  float rgba[4] = { fminf(p->light[0], 1.0f), fminf(p->light[1], 1.0f), fminf(p->light[2], 1.0f), 1.0f - p->light[3] }, depth = p->depth;
  if (frame->arguments.maximum) {
    const bool any = p->samples > 0;
    const float* entry = frame->table->rgba + 4 * (size_t)stratus_table_entry(frame->table, p->light[1]);
    depth = any ? p->light[0] : LARGEST_FLOAT;
    for (int c = 0; c < 4; ++c) {
      rgba[c] = any ? entry[c] : 0.0f;
    }
  }
  depth = frame->arguments.shear > 0.0f && depth < 0.0f
    ? 0.0f
    : depth; /* perspective: rounding may put a piece that begins at the eye behind it */
  memcpy(image->rgba + 4 * pixel, rgba, sizeof rgba);
  if (image->depth) {
    image->depth[pixel] = rgba[3] > 0.0f && depth < LARGEST_FLOAT ? depth : INFINITY;
  }
  if (image->samples) {
    image->samples[pixel] = p->samples;
  }
  for (int c = 0; image->rgba8 && c < 4; ++c) {
    const float value = rgba[c] * 255.0f + 0.5f;
    image->rgba8[4 * pixel + (size_t)c] = (uint8_t)(int)(value < 255.0f ? value : 255.0f); /* rgba is never negative */
  }
}

static void store_tile(const project_tile* t)
{
  for (int y = 0; y < t->height; ++y) {
    for (int x = 0; x < t->width; ++x) {
      const tile_pixel* p = t->pixels + place_of(x, y);
      store_pixel(t, p, (size_t)(t->y0 + y) * (size_t)t->projection->frame->image.width + (size_t)(t->x0 + x));
      t->counts->rays += p->samples > 0;
      t->counts->segments += p->samples;
    }
  }
}

#endif
