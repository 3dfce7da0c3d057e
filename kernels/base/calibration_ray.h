/* SPDX-License-Identifier: BSD-3-Clause
 * The rays of the calibration picture, by which host and devices are compared. They do what composite rays spend their time on: they load
 * the eight corners of a cell and an entry of a table, and add light. Nothing is skipped and no ray ends early, so that the work is the
 * same everywhere. */
#ifndef STRATUS_CALIBRATION_RAY_H
#define STRATUS_CALIBRATION_RAY_H

#include "gather.h"

/* Sides of the image, in pixels, and of the volume, in values; samples of a ray; entries of the table, four floats each. The work, and the
 * share of it that copying the image has, are as for a small volume in an ordinary window. */
#define CALIBRATION_PIXELS 512
#define CALIBRATION_VALUES 64
#define CALIBRATION_SAMPLES 48
#define CALIBRATION_ENTRIES 256

#define CALIBRATION_SLICE (CALIBRATION_VALUES * CALIBRATION_VALUES)

/* v[x + 2 y + 4 z]: the eight corners of the cell whose first value is values[index]. */
INLINE void calibration_cell(GLOBAL const float* values, vint index, vmask mask, vfloat v[8])
{
#ifdef LANES_LOAD
  lane_places places;
  lane_places_of(index, mask, &places);
  for (int z = 0; z < 2; ++z) {
    vfloat joined[4];
    for (int lane = 0; lane < 4; ++lane) {
      __m128 quad[STRATUS_WIDTH / 4];
      for (int part = 0; part < STRATUS_WIDTH / 4; ++part) {
        const float* at = values + places.at[4 * part + lane] + z * CALIBRATION_SLICE;
        quad[part] = _mm_loadh_pi(
          _mm_castsi128_ps(_mm_loadl_epi64((const __m128i*)(const void*)at)), (const __m64*)(const void*)(at + CALIBRATION_VALUES));
      }
      joined[lane] = join_quads(quad);
    }
    transpose_quads(joined, v + 4 * z);
  }
#else
  for (int corner = 0; corner < 8; ++corner) {
    GLOBAL const float* at = values + (corner & 1) + (corner >> 1 & 1) * CALIBRATION_VALUES + (corner >> 2) * CALIBRATION_SLICE;
#if STRATUS_WIDTH == 1
    v[corner] = mask ? at[index] : 0.0f;
#else
    int places[STRATUS_WIDTH];
    float lanes[STRATUS_WIDTH];
    vi_store(places, vi_select(mask, index, vi_set(0)));
    for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
      lanes[lane] = at[places[lane]];
    }
    v[corner] = v_load(lanes);
#endif
  }
#endif
}

/* March the rays of pixels (x, y). pixel: red, green, blue, opacity. The rays are parallel, oblique to all axes, and stay inside the
 * volume, whose values are between 0 and 1. */
INLINE void calibration_march(GLOBAL const float* values, GLOBAL const float* table, vfloat x, vfloat y, vfloat pixel[4])
{
  const vmask all = vi_ge(vi_set(0), vi_set(0));
  const vfloat scale = v_set(48.0f / CALIBRATION_PIXELS), one = v_set(1.0f);
  const vfloat from[3] = { v_fma(x, scale, v_set(2.0f)), v_fma(y, scale, v_set(3.0f)), one };
  const vfloat step[3] = { v_set(0.2f), v_set(0.1f), v_set(1.25f) };
  vfloat light[3] = { v_set(0.0f), v_set(0.0f), v_set(0.0f) }, transparency = one;
  for (int i = 0; i < CALIBRATION_SAMPLES; ++i) {
    vint cell[3];
    vfloat part[3], v[8], layer[4];
    for (int a = 0; a < 3; ++a) {
      const vfloat at = v_fma(v_set((float)i), step[a], from[a]);
      cell[a] = v_to_int(at);
      part[a] = at - v_from_int(cell[a]);
    }
    calibration_cell(values, cell[0] + cell[1] * vi_set(CALIBRATION_VALUES) + cell[2] * vi_set(CALIBRATION_SLICE), all, v);
    for (int axis = 0, left = 4; axis < 3; ++axis, left /= 2) {
      for (int j = 0; j < left; ++j) {
        v[j] = v_lerp(v[2 * j], v[2 * j + 1], part[axis]);
      }
    }
    gather_four(table, v_to_int(v[0] * v_set(CALIBRATION_ENTRIES - 1.0f)), all, layer);
    for (int c = 0; c < 3; ++c) {
      light[c] = v_fma(transparency, layer[c], light[c]);
    }
    transparency = v_fma(v_set(0.0f) - transparency, layer[3], transparency);
  }
  for (int c = 0; c < 3; ++c) {
    pixel[c] = light[c];
  }
  pixel[3] = one - transparency;
}

#endif
