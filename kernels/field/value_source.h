/* SPDX-License-Identifier: BSD-3-Clause
 * Where a volume's values are, and which of them are hidden. */
#ifndef STRATUS_VALUE_SOURCE_H
#define STRATUS_VALUE_SOURCE_H

#include "ray_packet.h"

/* BIAS_OF(a): the double that values of wide types are relative to. stratus_index: an index into a volume of any size. */
#ifdef STRATUS_DEVICE
#define BIAS_OF(a) as_double(((ulong)(uint)(a)->values.bias_high << 32) | (ulong)(uint)(a)->values.bias_low)
typedef ulong stratus_index;
#else
INLINE double stratus_bias(const stratus_ray_cast_arguments* a)
{
  const uint64_t bits = ((uint64_t)(uint32_t)a->values.bias_high << 32) | (uint64_t)(uint32_t)a->values.bias_low;
  double bias;
  memcpy(&bias, &bits, sizeof bias);
  return bias;
}
#define BIAS_OF(a) stratus_bias(a)
typedef uint64_t stratus_index;
#endif

#ifndef STRATUS_DEVICE
/* The values of a component in tiles: stratus_tiles. */
typedef struct ray_tiles {
  const uchar* values;
  const uint64_t* at[3];
  int64_t dimensions[3];
} ray_tiles;
#endif

/* Where a volume's values are: one after the other, or in pages (RAY_PAGES), with a table of each page's slab and its place in the slab. On
 * the host it may be the address of a ray_tiles instead, one for each component. */
#if RAY_IN_PAGES
typedef struct value_source {
  GLOBAL const void* slab[PAGE_SLABS];
  GLOBAL const int* table;
  int component;
} value_source;
#else
typedef GLOBAL const void* value_source;
#endif

/* Where the values of component c are. */
#if RAY_IN_PAGES
INLINE value_source component_values(CONSTANT stratus_ray_cast_arguments* a, value_source values, int c)
{
  values.component = c * (RAY_RARE(RAY_GRADIENTS, a->values.gradient_at != 0) ? 4 : 1);
  return values;
}
#define COMPONENT_VALUES(a, values, c) component_values(a, values, c)
#else
#define COMPONENT_VALUES(a, values, c) ((GLOBAL const uchar*)(values) + (size_t)(c) * (size_t)(uint)(a)->media.component_bytes)
#endif

/* A sample of every ray, in the segment [lo, lo + weight]. */
typedef struct stratus_sample {
  vfloat value, lo, weight;
  vfloat length;       /* of the segment, in sample distances */
  value_source values; /* of the volume that the sample is from */
  GLOBAL const uchar* hidden;
} stratus_sample;

/* The number of the byte at index coordinates x, y, z: of the nearest value where there is a byte a value (by_value), else of the cell. */
INLINE size_t hidden_place(CONSTANT stratus_ray_cast_arguments* a, int by_value, float x, float y, float z)
{
  const float place[3] = { x, y, z };
  size_t cell = 0;
  for (int axis = 2; axis >= 0; --axis) {
    const int between = a->values.dimensions[axis] > 1 ? a->values.dimensions[axis] - 1 : 1,
              cells = by_value ? a->values.dimensions[axis] : between;
    const int at = (int)(by_value ? place[axis] + 0.5f : place[axis]);
    cell = cell * (size_t)cells + (size_t)(at < cells ? at : cells - 1);
  }
  return cell;
}

/* The value, or a NaN where it is hidden. what: which of HIDDEN_CELLS and HIDDEN_BY_MASK to look at. */
INLINE vfloat ray_hide_by(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const uchar* hidden, int what, const vfloat x[3], vmask mask, vfloat value)
{
  float lx[3][STRATUS_WIDTH], lv[STRATUS_WIDTH];
  int lm[STRATUS_WIDTH];
  v_store(lv, value);
  vi_store(lm, vi_select(mask, vi_set(1), vi_set(0)));
  for (int axis = 0; axis < 3; ++axis) {
    v_store(lx[axis], x[axis]);
  }
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    if (lm[lane]) {
      const float x0 = lx[0][lane], x1 = lx[1][lane], x2 = lx[2][lane];
      size_t masked = 0; /* the mask's bytes come first */
      if (a->values.has_hidden & (HIDDEN_BY_MASK | HIDDEN_LABELS)) {
        masked = (size_t)a->values.dimensions[0] * (size_t)a->values.dimensions[1] * (size_t)a->values.dimensions[2];
      }
      if (what & HIDDEN_BY_MASK) {
        lv[lane] = hidden[hidden_place(a, 1, x0, x1, x2)] ? lv[lane] : NAN;
      }
      if (what & HIDDEN_CELLS) { /* a byte for each cell; nearest interpolation of cell_centered volumes has a byte for each value */
        lv[lane] = hidden[masked + hidden_place(a, a->values.clamp && a->values.nearest, x0, x1, x2)] ? NAN : lv[lane];
      }
    }
  }
  return v_load(lv);
}

INLINE vfloat ray_hide(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const uchar* hidden, const vfloat x[3], vmask mask, vfloat value)
{
  return ray_hide_by(a, hidden, a->values.has_hidden, x, mask, value);
}

#endif
