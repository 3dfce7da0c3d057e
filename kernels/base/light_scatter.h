/* SPDX-License-Identifier: BSD-3-Clause
 * Light that matter scatters more than once, on a grid of nodes in a box of the world. A node has five words. Two numbers of 16 bits are in
 * the first, the lower one first: the mean radiance over all directions, red and green, 0..65535 times a factor; in the second is blue. The
 * others have three numbers of 10 bits each, 0..1022, of which 511 is 0: moments of the radiance, the mean of it times x, y, z, xx - 1/3,
 * yy - 1/3, xy, yz and zx of the direction of light, as parts of the mean: the largest is 1, 1, 1, 2/3, 2/3, 1/2, 1/2, 1/2. The last
 * number, 0..1022, is the part of the mean that was scattered once. Nodes along x follow one another, then come those along y, then z. */
#ifndef STRATUS_LIGHT_SCATTER_KERNEL_H
#define STRATUS_LIGHT_SCATTER_KERNEL_H

#include "gather.h"
#include "light_arguments.h"

/* The light that goes from the places x along d, of length 1 in the world, after one scattering more. The part that a scattering sends on
 * along its way, scatter_way, is of the radiance along d, which the mean and the moments give up to the second order in d. The solution
 * scatters evenly; `phase`, by the first scattering's phase function, is what that sends along d. */
OUTLINE void light_scattered(
  CONSTANT stratus_light_arguments* a, GLOBAL const int* maps, const vfloat x[3], const vfloat d[3], vfloat phase, vfloat rgb[3])
{
  const vfloat zero = v_set(0.0f), one = v_set(1.0f);
  vfloat part[3][2], mean[3] = { zero, zero, zero }, moments[9];
  vint at = vi_set(a->scatter_at);
  int step[3], stride = LIGHT_SCATTER_WORDS;
  const int words = a->scatter_way == 0.0f ? 2 : LIGHT_SCATTER_WORDS;
  for (int axis = 0; axis < 3; ++axis) {
    CONSTANT float* m = a->scatter_from + 4 * axis;
    const int last = a->scatter_size[axis] - 2 > 0 ? a->scatter_size[axis] - 2 : 0;
    vfloat q = v_fma(v_set(m[0]), x[0], v_fma(v_set(m[1]), x[1], v_fma(v_set(m[2]), x[2], v_set(m[3]))));
    q = v_clamp(q, 0.0f, (float)(a->scatter_size[axis] - 1));
    const vint cell = vi_min(v_to_int(q), vi_set(last));
    part[axis][1] = q - v_from_int(cell);
    part[axis][0] = one - part[axis][1];
    at = at + cell * vi_set(stride);
    step[axis] = a->scatter_size[axis] > 1 ? stride : 0;
    stride *= a->scatter_size[axis];
  }
  for (int i = 0; i < 9; ++i) {
    moments[i] = zero;
  }
  const vmask all = vi_ge(at, vi_set(0));
  for (int corner = 0; corner < 8; ++corner) {
    const int right = corner & 1, up = corner >> 1 & 1, far = corner >> 2;
    const vfloat weight = part[0][right] * (part[1][up] * part[2][far]);
    const vint from = at + vi_set(right * step[0] + up * step[1] + far * step[2]);
    const vint red_green = v_gather_ints(maps, from, all), blue = v_gather_ints(maps + 1, from, all);
    mean[0] = v_fma(v_from_int(red_green & vi_set(0xffff)), weight, mean[0]);
    mean[1] = v_fma(v_from_int((red_green >> vi_set(16)) & vi_set(0xffff)), weight, mean[1]);
    mean[2] = v_fma(v_from_int(blue), weight, mean[2]);
    for (int word = 2; word < words; ++word) {
      const vint three = v_gather_ints(maps + word, from, all);
      vfloat* to = moments + 3 * (word - 2);
      to[0] = v_fma(v_from_int(three & vi_set(0x3ff)), weight, to[0]);
      to[1] = v_fma(v_from_int((three >> vi_set(10)) & vi_set(0x3ff)), weight, to[1]);
      to[2] = v_fma(v_from_int((three >> vi_set(20)) & vi_set(0x3ff)), weight, to[2]);
    }
  }
  vfloat along = one;
  if (words > 2) {
    for (int i = 0; i < 8; ++i) {
      const float most = i < 3 ? 1.0f : i < 5 ? 2.0f / 3.0f : 0.5f;
      moments[i] = v_fma(moments[i], v_set(most / 511.0f), v_set(-most));
    }
    const vfloat slope = v_fma(moments[0], d[0], v_fma(moments[1], d[1], moments[2] * d[2]));
    const vfloat squares = v_fma(moments[3], v_fma(d[0], d[0], zero - d[2] * d[2]), moments[4] * v_fma(d[1], d[1], zero - d[2] * d[2]));
    const vfloat products = v_fma(moments[5], d[0] * d[1], v_fma(moments[6], d[1] * d[2], moments[7] * (d[2] * d[0])));
    const float on = a->scatter_way;
    if (on > 0.0f) {
      const vfloat radiance = v_max(v_fma(v_set(7.5f), v_fma(v_set(2.0f), products, squares), v_fma(v_set(3.0f), slope, one)), zero);
      const vfloat first = moments[8] * v_set(1.0f / 1022.0f), known = v_fma(phase, v_set(1.0f / (1.0f - on)), v_set(-1.0f));
      along = v_fma(radiance * v_fma(known, first, one), v_set(on), v_set(1.0f - on));
    } else {
      along = v_fma(v_fma(v_set(2.0f), products, squares), v_set(7.5f * on * on), v_fma(slope, v_set(3.0f * on), one));
      along = v_max(along, zero);
    }
  }
  for (int c = 0; c < 3; ++c) {
    rgb[c] = mean[c] * (v_set(a->scatter_scale[c]) * along);
  }
}

#endif
