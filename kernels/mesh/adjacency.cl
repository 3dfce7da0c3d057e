/* SPDX-License-Identifier: BSD-3-Clause
 * Neighbours through faces: keys of faces, and runs of equal keys. Faces are sorted by their third point, and then, stably, by the first
 * two, so that faces of the same points follow one another. */
#include "face_points.h"

#define COUNTERS_BROKEN 0
#define COUNTERS_FOLDED 1

/* Gets a face's points, and returns the side of it on which its cell lies, times the orientation; 0 for the faces of a cell that names a
 * point twice. Those faces have the number of points for all three, which sorts them behind all others. */
static int points_of(__global const int* vertices, uint face, int point_count, int point[3])
{
  int cell[4];
  for (int i = 0; i < 4; ++i) {
    cell[i] = vertices[4 * (size_t)(face / 4) + i];
  }
  if (stratus_names_a_point_twice(cell)) {
    point[0] = point[1] = point[2] = point_count;
    return 0;
  }
  return stratus_face_points(cell, (int)(face % 4), point);
}

/* The third points of all faces, in the faces' order. */
__kernel void third_points(__global const int* vertices, uint count, int point_count, __global ulong* keys, __global uint* faces)
{
  const size_t i = get_global_id(0);
  if (i >= count) {
    return;
  }
  int point[3];
  (void)points_of(vertices, (uint)i, point_count, point);
  keys[i] = (ulong)point[2];
  faces[i] = (uint)i;
}

/* The first two points of the faces, in the order of `faces`. */
__kernel void first_points(
  __global const int* vertices, uint count, int point_count, int bits, __global const uint* faces, __global ulong* keys)
{
  const size_t i = get_global_id(0);
  if (i >= count) {
    return;
  }
  int point[3];
  (void)points_of(vertices, faces[i], point_count, point);
  keys[i] = (ulong)point[0] << bits | (ulong)point[1];
}

/* Pairs sorted faces. The item of a run's first face does the run. A run of two on different sides of the face are neighbours; all others
 * get -1. counters: faces in runs of more than two, and in runs of two on one side. */
__kernel void pair_faces(__global const int* vertices, __global const char* orientation, uint count, int point_count,
  __global const ulong* keys, __global const uint* faces, __global int* neighbours, __global uint* counters)
{
  const size_t i = get_global_id(0);
  if (i >= count) {
    return;
  }
  const uint face = faces[i];
  int point[3], other[3];
  const int sign = points_of(vertices, face, point_count, point);
  if (sign == 0) {
    neighbours[face] = -1;
    return;
  }
  if (i > 0 && keys[i - 1] == keys[i]) {
    (void)points_of(vertices, faces[i - 1], point_count, other);
    if (other[2] == point[2]) {
      return;
    }
  }
  size_t end = i + 1;
  int other_sign = 0;
  for (; end < count && keys[end] == keys[i]; ++end) {
    const int next_sign = points_of(vertices, faces[end], point_count, other);
    if (other[2] != point[2]) {
      break;
    }
    other_sign = next_sign;
  }
  if (end == i + 2) {
    const uint second = faces[i + 1];
    const int folded = sign * orientation[face / 4] * other_sign * orientation[second / 4] > 0;
    neighbours[face] = folded ? -1 : (int)(second / 4);
    neighbours[second] = folded ? -1 : (int)(face / 4);
    if (folded) {
      atomic_add(&counters[COUNTERS_FOLDED], 2u);
    }
    return;
  }
  for (size_t j = i; j < end; ++j) {
    neighbours[faces[j]] = -1;
  }
  if (end > i + 1) {
    atomic_add(&counters[COUNTERS_BROKEN], (uint)(end - i));
  }
}
