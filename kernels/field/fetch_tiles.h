/* SPDX-License-Identifier: BSD-3-Clause
 * Loads a volume's values from tiles (value_source.h) for a packet, as floats: of any type and size. Part of fetch.h, on the host. */
#ifndef STRATUS_FETCH_TILES_H
#define STRATUS_FETCH_TILES_H

#include "load_square.h"

/* A cell's first corner, and the bytes from there to its neighbour along x, y and z. */
typedef struct tile_place {
  const uchar* at;
  size_t step[3];
} tile_place;

INLINE float tile_value(const stratus_ray_cast_arguments* a, const uchar* at)
{
  switch (a->values.type) {
#define TILE_VALUE(number, type, result)                                                                                                   \
  case number: {                                                                                                                           \
    type value;                                                                                                                            \
    memcpy(&value, at, sizeof value);                                                                                                      \
    return result;                                                                                                                         \
  }
    TILE_VALUE(0, int8_t, (float)value)
    TILE_VALUE(1, uint8_t, (float)value)
    TILE_VALUE(2, int16_t, (float)value)
    TILE_VALUE(3, uint16_t, (float)value)
    TILE_VALUE(4, int32_t, (float)((double)value - BIAS_OF(a)))
    TILE_VALUE(5, uint32_t, (float)((double)value - BIAS_OF(a)))
    TILE_VALUE(6, int64_t, (float)((double)value - BIAS_OF(a)))
    TILE_VALUE(7, uint64_t, (float)((double)value - BIAS_OF(a)))
    TILE_VALUE(8, float, value)
    TILE_VALUE(9, double, (float)(value - BIAS_OF(a)))
#undef TILE_VALUE
    default:
      return 0.0f;
  }
}

/* Only lanes of the mask may touch memory: a tile would be read for the others. */
INLINE void tile_corners(const stratus_ray_cast_arguments* a, const tile_place places[STRATUS_WIDTH], vfloat v[8])
{
  float lv[8][STRATUS_WIDTH];
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    const tile_place* p = &places[lane];
    for (int corner = 0; corner < 8; ++corner) {
      const size_t behind = (corner & 1 ? p->step[0] : 0) + (corner & 2 ? p->step[1] : 0) + (corner & 4 ? p->step[2] : 0);
      lv[corner][lane] = p->at ? tile_value(a, p->at + behind) : 0.0f;
    }
  }
  for (int corner = 0; corner < 8; ++corner) {
    v[corner] = v_load(lv[corner]);
  }
}

#ifdef LANES_LOAD
/* The same for a type that load_square() takes: pairs of neighbours in a tile by one load, pairs of two tiles by two. */
INLINE void tile_squares(const stratus_ray_cast_arguments* a, const tile_place places[STRATUS_WIDTH], int type, size_t size, vfloat v[8])
{
  static const uchar nothing[16];
  const double bias = type == 9 ? BIAS_OF(a) : 0.0;
  for (int layer = 0; layer < 2; ++layer) {
    vfloat joined[4];
    for (int lane = 0; lane < 4; ++lane) {
      __m128 quad[STRATUS_WIDTH / 4];
      for (int part = 0; part < STRATUS_WIDTH / 4; ++part) {
        const tile_place* p = &places[4 * part + lane];
        const uchar* low = p->at ? p->at + (layer ? p->step[2] : 0) : nothing;
        const uchar* high = p->at ? low + p->step[1] : nothing;
        if (!p->at || p->step[0] == size) {
          quad[part] = load_square(type, bias, low, high);
        } else {
          quad[part] =
            _mm_setr_ps(tile_value(a, low), tile_value(a, low + p->step[0]), tile_value(a, high), tile_value(a, high + p->step[0]));
        }
      }
      joined[lane] = join_quads(quad);
    }
    transpose_quads(joined, v + 4 * layer);
  }
}
#endif

#endif

INLINE void RAY_NAME(fetch_cell)(const stratus_ray_cast_arguments* a, value_source values, vint i, vint j, vint k, vmask mask, vfloat v[8])
{
  const ray_tiles* tiles = (const ray_tiles*)values;
  int li[3][STRATUS_WIDTH], lm[STRATUS_WIDTH];
  tile_place places[STRATUS_WIDTH];
  vi_store(li[0], i);
  vi_store(li[1], j);
  vi_store(li[2], k);
  vi_store(lm, vi_select(mask, vi_set(1), vi_set(0)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    size_t first = 0;
    for (int axis = 0; lm[lane] && axis < 3; ++axis) {
      const uint64_t* at = tiles->at[axis] + li[axis][lane];
      first += at[0];
      places[lane].step[axis] = at[1] - at[0]; /* modulo 2^64: tiles may be in any order */
    }
    places[lane].at = lm[lane] ? tiles->values + first : NULL;
  }
  switch (a->values.type) {
#ifdef LANES_LOAD
    case 0:
      tile_squares(a, places, 0, 1, v);
      break;
    case 1:
      tile_squares(a, places, 1, 1, v);
      break;
    case 2:
      tile_squares(a, places, 2, 2, v);
      break;
    case 3:
      tile_squares(a, places, 3, 2, v);
      break;
    case 8:
      tile_squares(a, places, 8, 4, v);
      break;
    case 9:
      tile_squares(a, places, 9, 8, v);
      break;
#endif
    default:
      tile_corners(a, places, v);
  }
}

INLINE vfloat RAY_NAME(fetch_nearest)(const stratus_ray_cast_arguments* a, value_source values, vint i, vint j, vint k, vmask mask)
{
  const ray_tiles* tiles = (const ray_tiles*)values;
  int li[STRATUS_WIDTH], lj[STRATUS_WIDTH], lk[STRATUS_WIDTH], lm[STRATUS_WIDTH];
  float lv[STRATUS_WIDTH];
  vi_store(li, i);
  vi_store(lj, j);
  vi_store(lk, k);
  vi_store(lm, vi_select(mask, vi_set(1), vi_set(0)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    lv[lane] = lm[lane] ? tile_value(a, tiles->values + tiles->at[0][li[lane]] + tiles->at[1][lj[lane]] + tiles->at[2][lk[lane]]) : 0.0f;
  }
  return v_load(lv);
}
