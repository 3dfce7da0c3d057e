/* SPDX-License-Identifier: BSD-3-Clause
 * The part of a tile that a work item or thread draws under projection: all its pixels in packets, or one pixel if a packet is one ray. A
 * piece is the part of a pixel's ray inside a cell. Pieces are collected in a buffer, shaded one per lane, then composited one after
 * another behind the earlier pieces of their pixels. A pixel depends on its cells and their order, not on the number of lanes. */
#ifndef STRATUS_TETRA_PROJECT_TILE_H
#define STRATUS_TETRA_PROJECT_TILE_H

#include "tetra_march.h"
#include "tetra_pixel.h"
#include "tetra_project_arguments.h"

/* Sizes of the parts that are drawn together: pixels along an edge, and pieces in the buffer, few enough to stay in the innermost cache. */
#if STRATUS_WIDTH == 1
#define PROJECT_SIDE 1
#define PIECES 1
#else
#define PROJECT_SIDE PROJECT_TILE
#define PIECES 256
#endif
#define PIXELS (PROJECT_SIDE * PROJECT_SIDE)
#define ACROSS (PROJECT_SIDE / PACKET_X) /* packets side by side */
#define UPWARDS (PROJECT_SIDE / PACKET_Y)

/* A piece is out of order if it begins before the end of its pixel's last piece by more than rounding explains: OUT_OF_ORDER of its depth
 * plus OUT_OF_ORDER_LENGTH of its length. */
#define OUT_OF_ORDER 0x1p-19f
#define OUT_OF_ORDER_LENGTH 0x1p-8f

/* Four floats of one register, and one of them. */
#ifdef STRATUS_DEVICE
typedef float4 four_floats;
#define FOUR_FLOATS(a, b, c, d) ((float4)(a, b, c, d))
#define ONE_OF(four, i) ((four).s##i)
#else
typedef float four_floats __attribute__((vector_size(16), may_alias));
#define FOUR_FLOATS(a, b, c, d) ((four_floats){ a, b, c, d })
#define ONE_OF(four, i) ((four)[i])
#endif

/* The arrays of a frame. */
typedef struct stratus_project_view {
  GLOBAL const int* vertices;             /* of the mesh: four points a cell */
  GLOBAL const float* points;             /* x, y, z and value of each, in the mesh's order */
  GLOBAL const float* cell_values;        /* in the mesh's order; read only if the arguments' cell_values is set */
  GLOBAL const int* sums;                 /* stratus_tetra_sums() */
  GLOBAL const float* colors;             /* maximum: colours of the table's entries */
  GLOBAL const float* lines;              /* us and uw of all columns, then vs and vw of all rows */
  GLOBAL const float* ends;               /* one a pixel, in z: where its ray ends; read only if has_ends */
  GLOBAL const stratus_tetra_rect* rects; /* of each cell */
  GLOBAL const uint* bin_begin;           /* cells that may cover tile t: bins[bin_begin[t]] .. bins[bin_begin[t + 1] - 1], nearest first */
  GLOBAL const uint* bins;
  stratus_tetra_picture picture;
} stratus_project_view;

/* Of what one work item or thread drew. again: pixels redrawn because their pieces came out of order. */
typedef struct stratus_project_found {
  uint rays, segments, again;
} stratus_project_found;

/* A pixel: the pieces composited so far. */
typedef struct tile_pixel {
  four_floats light; /* red, green, blue, transparency; maximum: distance of the largest value, that value, two unused */
  float back;        /* z where the last visible piece ends */
  float depth;
  uint samples;
  uint wrong; /* 1: pieces came out of order */
} tile_pixel;

/* Pixels are stored packet by packet: pixel p is lane p % STRATUS_WIDTH of packet p / STRATUS_WIDTH. */
typedef struct project_tile {
  const stratus_project_view* view;
  CONSTANT stratus_tetra_arguments* arguments;
  int x0, y0;               /* the tile's first pixel, which planes refer to */
  int own_x, own_y;         /* the first pixel that is drawn here */
  int width, height, alive; /* alive: pixels that are not opaque yet */
  int rays_differ;          /* 1: rays differ in where they begin or end */
  float us[ACROSS][STRATUS_WIDTH], uw[ACROSS][STRATUS_WIDTH], vs[UPWARDS][STRATUS_WIDTH], vw[UPWARDS][STRATUS_WIDTH];
  float dx[ACROSS][STRATUS_WIDTH], dy[UPWARDS][STRATUS_WIDTH]; /* from the tile's first pixel, in pixels */
  float length[PIXELS], offset[PIXELS];                        /* world distance = offset + length z */
  float begin[PIXELS], end[PIXELS];                            /* the visible part of the ray, in z */
  float open[PIXELS]; /* pieces that begin behind it are invisible; LARGEST_FLOAT until the pixel is opaque */
  tile_pixel pixels[PIXELS];
  int wrong; /* number of wrong pixels */
  uint again;
  int count; /* pieces in the buffer */
  float at[PIECES + 2 * STRATUS_WIDTH], to[PIECES + 2 * STRATUS_WIDTH], first[PIECES + 2 * STRATUS_WIDTH], last[PIECES + 2 * STRATUS_WIDTH];
  int pixel[PIECES + 2 * STRATUS_WIDTH];
} project_tile;

/* Where a pixel of the part drawn here is stored, and whether it is in the picture. */
INLINE int place_of(int x, int y)
{
  return (y / PACKET_Y * ACROSS + x / PACKET_X) * STRATUS_WIDTH + y % PACKET_Y * PACKET_X + x % PACKET_X;
}

INLINE tile_pixel empty_pixel(CONSTANT stratus_tetra_arguments* a)
{
  tile_pixel pixel;
  pixel.light = FOUR_FLOATS(0.0f, a->mode == TETRA_EXTREMES ? -LARGEST_FLOAT : 0.0f, 0.0f, 1.0f);
  pixel.back = -LARGEST_FLOAT;
  pixel.depth = LARGEST_FLOAT;
  pixel.samples = pixel.wrong = 0;
  return pixel;
}

/* Empties a pixel. Pixels beyond the picture are closed: they take no pieces. */
INLINE void clear_pixel(project_tile* t, int p, int inside)
{
  t->pixels[p] = empty_pixel(t->arguments);
  t->open[p] = inside ? LARGEST_FLOAT : -LARGEST_FLOAT;
}

INLINE void begin_packet(project_tile* t, int column, int row)
{
  const int place = (row * ACROSS + column) * STRATUS_WIDTH;
  int x[STRATUS_WIDTH], y[STRATUS_WIDTH];
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    x[lane] = column * PACKET_X + lane % PACKET_X;
    y[lane] = row * PACKET_Y + lane / PACKET_X;
    clear_pixel(t, place + lane, x[lane] < t->width && y[lane] < t->height);
    x[lane] += t->own_x;
    y[lane] += t->own_y;
  }
  const vmask inside = v_lt(v_set(0.0f), v_load(t->open + place));
  const stratus_tetra_sight sight = tetra_sight(t->arguments, t->view->ends, v_load(t->us[column]), v_load(t->uw[column]),
    v_load(t->vs[row]), v_load(t->vw[row]), vi_load(x), vi_load(y), inside);
  v_store(t->length + place, sight.length);
  v_store(t->offset + place, sight.offset);
  v_store(t->begin + place, sight.begin);
  v_store(t->end + place, v_select(inside, sight.end, v_set(-LARGEST_FLOAT)));
}

/* from: which pixel of the tile is drawn, where a packet is one ray; else 0. */
INLINE void begin_tile(project_tile* t, const stratus_project_view* view, CONSTANT stratus_tetra_arguments* a, int tile, int from)
{
  const int columns = (a->picture.width + PROJECT_TILE - 1) / PROJECT_TILE, padded = a->picture.width + TETRA_PADDING;
  GLOBAL const float* rows = view->lines + 2 * padded;
  t->view = view;
  t->arguments = a;
  t->x0 = tile % columns * PROJECT_TILE;
  t->y0 = tile / columns * PROJECT_TILE;
  t->own_x = t->x0 + from % PROJECT_TILE;
  t->own_y = t->y0 + from / PROJECT_TILE;
  t->width = a->picture.width - t->own_x < PROJECT_SIDE ? a->picture.width - t->own_x : PROJECT_SIDE;
  t->height = a->picture.height - t->own_y < PROJECT_SIDE ? a->picture.height - t->own_y : PROJECT_SIDE;
  t->alive = t->width > 0 && t->height > 0 ? t->width * t->height : 0;
  t->rays_differ = a->has_ends || a->lean[0] < 0.0f || a->lean[0] > 0.0f || a->lean[1] < 0.0f || a->lean[1] > 0.0f || a->plane_count > 0;
  t->count = 0;
  t->wrong = 0;
  t->again = 0;
  for (int i = 0; i < PROJECT_SIDE * PACKET_Y; ++i) {
    const int x = i / STRATUS_WIDTH * PACKET_X + i % PACKET_X, lane = i % STRATUS_WIDTH;
    t->us[x / PACKET_X][lane] = view->lines[t->own_x + x];
    t->uw[x / PACKET_X][lane] = view->lines[padded + t->own_x + x];
    t->dx[x / PACKET_X][lane] = (float)(t->own_x - t->x0 + x);
  }
  for (int i = 0; i < PROJECT_SIDE * PACKET_X; ++i) {
    const int y = i / PACKET_X, lane = i % STRATUS_WIDTH;
    t->vs[y / PACKET_Y][lane] = rows[t->own_y + y];
    t->vw[y / PACKET_Y][lane] = rows[a->picture.height + TETRA_PADDING + t->own_y + y];
    t->dy[y / PACKET_Y][lane] = (float)(t->own_y - t->y0 + y);
  }
  for (int row = 0; row < UPWARDS; ++row) {
    for (int column = 0; column < ACROSS; ++column) {
      begin_packet(t, column, row);
    }
  }
}

#if STRATUS_WIDTH == 1
/* Goes on with a pixel that some pieces have been composited to. */
INLINE void resume_pixel(project_tile* t, const tile_pixel* pixel)
{
  const int opaque = t->arguments->mode != TETRA_EXTREMES && ONE_OF(pixel->light, 3) < t->arguments->termination;
  t->pixels[0] = *pixel;
  t->open[0] = opaque && t->alive ? pixel->back : t->open[0];
}
#endif

/* ---- pieces */

/* STRATUS_WIDTH shaded pieces. maximum: light holds the distance of the end with the larger value, and that value. */
typedef struct layers {
  four_floats light[STRATUS_WIDTH]; /* red, green, blue, transparency - 1 */
  float limit[STRATUS_WIDTH];       /* the piece is out of order if another ends behind this */
  float to[STRATUS_WIDTH], depth[STRATUS_WIDTH];
  int visible[STRATUS_WIDTH];
} layers;

/* The float base[at] of an array of the tile. */
INLINE vfloat gather_own(const float* base, vint at, vmask mask)
{
#if STRATUS_WIDTH == 1
  return mask ? base[at] : 0.0f;
#elif !defined(STRATUS_DEVICE)
  return v_from_bits(v_gather_ints((const int*)(const void*)base, at, mask));
#elif defined(STRATUS_DEVICE_AVX512)
  return v_from_bits(STRATUS_GATHER(base, at, mask, 4));
#else
  float value[STRATUS_WIDTH];
  int place[STRATUS_WIDTH];
  vi_store(place, vi_select(mask, at, vi_set(0)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    value[lane] = base[place[lane]];
  }
  return v_select(mask, v_load(value), v_set(0.0f));
#endif
}

INLINE void put_light(layers* out, vfloat red, vfloat green, vfloat blue, vfloat less)
{
#if !defined(STRATUS_DEVICE) && STRATUS_ISA == 2
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
  float lanes[4][STRATUS_WIDTH];
  v_store(lanes[0], red);
  v_store(lanes[1], green);
  v_store(lanes[2], blue);
  v_store(lanes[3], less);
  for (int l = 0; l < STRATUS_WIDTH; ++l) {
    out->light[l] = FOUR_FLOATS(lanes[0][l], lanes[1][l], lanes[2][l], lanes[3][l]);
  }
#endif
}

INLINE void shade_pieces(project_tile* t, int i, layers* out)
{
  CONSTANT stratus_tetra_arguments* a = t->arguments;
  GLOBAL const int* sums = t->view->sums;
  const vfloat zero = v_set(0.0f), one = v_set(1.0f);
  const vint pixel = vi_load(t->pixel + i);
  const vfloat at = v_load(t->at + i), to = v_load(t->to + i);
  vfloat first = v_load(t->first + i), last = v_load(t->last + i), near = zero;
  vmask mask = vi_lt(vi_lanes(), vi_set(t->count - i));
  const vfloat length = gather_own(t->length, pixel, mask);
  const vfloat nearest = t->rays_differ ? gather_own(t->begin, pixel, mask) : v_set(a->begin);
  const vfloat farthest = t->rays_differ ? gather_own(t->end, pixel, mask) : v_set(a->end);
  const vfloat begin = v_max(at, nearest), end = v_min(to, farthest);
  mask = mask & v_lt(begin, end);
  const vmask cut = mask & (v_lt(at, begin) | v_lt(end, to));
  if (m_any(cut)) {
    const vfloat slope = (last - first) * v_reciprocal(v_max(to - at, v_set(1e-30f))), start = first;
    first = v_select(cut, v_fma(slope, begin - at, start), first);
    last = v_select(cut, v_fma(slope, end - at, start), last);
  }
  vi_store(out->visible, vi_select(mask, vi_set(1), vi_set(0)));
  if (a->picture.want_depth || a->mode == TETRA_EXTREMES) {
    near = v_fma(begin, length, gather_own(t->offset, pixel, mask));
  }
  if (a->mode == TETRA_EXTREMES) {
    const vfloat beyond = v_fma(end, length, gather_own(t->offset, pixel, mask));
    put_light(out, v_select(v_lt(first, last), beyond, near), v_max(first, last), zero, zero);
    return;
  }
  stratus_tetra_light light;
  light.red = light.green = light.blue = light.most = zero;
  light.transparency = one;
  light.depth = v_set(LARGEST_FLOAT);
  const stratus_tetra_place from = tetra_place(a, sums, first, mask), until = tetra_place(a, sums, last, mask);
  tetra_integrate(a, sums, &light, mask, first, last, &from, &until, (end - begin) * length, near);
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
  CONSTANT stratus_tetra_arguments* a = t->arguments;
  const float termination = a->termination;
  for (int l = 0; l < count; ++l) {
    tile_pixel* p = t->pixels + t->pixel[i + l];
    const float clear = ONE_OF(p->light, 3);
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
    if (ONE_OF(p->light, 3) < termination) {
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
      const float value = ONE_OF(layer->light[l], 1), where = ONE_OF(layer->light[l], 0);
      if (value > ONE_OF(p->light, 1) || (value >= ONE_OF(p->light, 1) && where < ONE_OF(p->light, 0))) {
        p->light = layer->light[l];
      }
      ++p->samples;
    }
  }
}

static void flush(project_tile* t)
{
  for (int i = 0; i < t->count; i += STRATUS_WIDTH) {
    const int count = t->count - i < STRATUS_WIDTH ? t->count - i : STRATUS_WIDTH;
    layers layer;
    shade_pieces(t, i, &layer);
    if (t->arguments->mode == TETRA_EXTREMES) {
      take_largest(t, i, count, &layer);
    } else {
      composite_pieces(t, i, count, &layer);
    }
  }
  t->count = 0;
}

/* ---- the picture */

static void store_tile(project_tile* t, stratus_project_found* found)
{
  CONSTANT stratus_tetra_arguments* a = t->arguments;
  found->rays = found->segments = 0;
  found->again = t->again;
  for (int y = 0; y < t->height; ++y) {
    for (int x = 0; x < t->width; ++x) {
      const tile_pixel* p = t->pixels + place_of(x, y);
      const float light[4] = { ONE_OF(p->light, 0), ONE_OF(p->light, 1), ONE_OF(p->light, 2), ONE_OF(p->light, 3) };
      float rgba[4], depth = p->depth;
      for (int c = 0; c < 3; ++c) {
        rgba[c] = light[c] < 1.0f ? light[c] : 1.0f; /* rounding may lift sums above 1 */
      }
      rgba[3] = 1.0f - light[3];
      if (a->mode == TETRA_EXTREMES) {
        int entry[STRATUS_WIDTH];
        vi_store(entry, table_entry(&a->table, t->view->colors, v_set(light[1])));
        depth = p->samples > 0 ? light[0] : LARGEST_FLOAT;
        for (int c = 0; c < 4; ++c) {
          rgba[c] = p->samples > 0 ? t->view->colors[4 * entry[0] + c] : 0.0f;
        }
      }
      tetra_store_pixel(&t->view->picture, a, t->own_x + x, t->own_y + y, rgba, depth, p->samples);
      found->rays += p->samples > 0;
      found->segments += p->samples;
    }
  }
}

#endif
