/* SPDX-License-Identifier: BSD-3-Clause
 * Signs of cells' faces in a view, by face_signs.h. Signs that rounding may have changed are marked, and the host computes them exactly. */
#ifndef STRATUS_DEVICE
#define STRATUS_DEVICE 1
#endif
#include "face_signs.h"

/* corners: of each of a cell's points, its number in `seen`. sides: bit f is set where the cell has a neighbour behind face f; the bits
 * from 4 on hold the side of its faces on which the cell lies, plus 1. results: bit f is set where the neighbour behind face f comes after
 * the cell, bit 4 + f where it comes before, bit 8 + f where that is not known. */
__kernel void signs(__global const double* seen, __global const int* corners, __global const uchar* sides, ulong count, int parallel,
  __global ushort* results)
{
  const size_t cell = get_global_id(0);
  if (cell >= count) {
    return;
  }
  __global const int* corner = corners + 4 * cell;
  const face_point p0 = face_point_at(seen + 3 * (size_t)corner[0]);
  const face_point p1 = face_point_at(seen + 3 * (size_t)corner[1]);
  const face_point p2 = face_point_at(seen + 3 * (size_t)corner[2]);
  const face_point p3 = face_point_at(seen + 3 * (size_t)corner[3]);
  const int side = (int)(sides[cell] >> 4) - 1;
  double det[4];
  uint state = 0;
  face_determinants(p0, p1, p2, p3, parallel, det);
  for (int f = 0; f < 4 && side != 0; ++f) {
    const int sign = face_sign(det[f]) * side;
    state |= (uint)(sign < 0) << f | (uint)(sign > 0) << (4 + f) | (uint)(sign == 0 && (sides[cell] >> f & 1)) << (8 + f);
  }
  results[cell] = (ushort)state;
}
