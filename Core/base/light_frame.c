/* SPDX-License-Identifier: BSD-3-Clause
 * Places a map of light about matter, and reads it. */
#include "light_frame.h"

#include "vector.h"

#include <math.h>

/* A position whose light meets the matter at a greater slope than this, or is in it, has a cube of maps. */
#define SLOPE_MOST 2.0
#define FAR 1e4   /* so many extents of the matter away, a position is a direction */
#define FLAT 1e-6 /* a side of the map is at least this part of the longest */

void stratus_light_frame_place(const stratus_light* light, const double bounds[6], stratus_light_frame* f, double sides[3])
{
  double way[3], middle[3];
  double distance = 0.0, extent = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    middle[axis] = 0.5 * (bounds[2 * axis] + bounds[2 * axis + 1]);
    way[axis] = light->positional ? middle[axis] - light->vector[axis] : -light->vector[axis];
    distance = fmax(distance, fabs(way[axis]));
    extent = fmax(extent, bounds[2 * axis + 1] - bounds[2 * axis]);
  }
  f->perspective = light->positional && distance < FAR * extent;
  f->faces = f->perspective;
  memcpy(f->origin, f->perspective ? light->vector : middle, sizeof f->origin);
  if (stratus_vector_normalize(way) == 0.0) {
    way[2] = 1.0;
  }
  const int least = fabs(way[0]) <= fabs(way[1]) && fabs(way[0]) <= fabs(way[2]) ? 0 : fabs(way[1]) <= fabs(way[2]) ? 1 : 2;
  double other[3] = { 0.0, 0.0, 0.0 };
  other[least] = 1.0;
  memcpy(f->basis[2], way, sizeof way);
  stratus_vector_cross(way, other, f->basis[0]);
  (void)stratus_vector_normalize(f->basis[0]);
  stratus_vector_cross(way, f->basis[0], f->basis[1]);
  double depth_lo = INFINITY, depth_hi = -INFINITY, largest = 0.0;
  bool wide = false;
  for (int corner = 0; corner < 8; ++corner) {
    double point[3], q[3];
    for (int axis = 0; axis < 3; ++axis) {
      point[axis] = bounds[2 * axis + (corner >> axis & 1)] - f->origin[axis];
      largest = fmax(largest, fabs(point[axis]));
    }
    for (int axis = 0; axis < 3; ++axis) {
      q[axis] = stratus_vector_dot(f->basis[axis], point);
    }
    wide = wide || !(fmax(fabs(q[0]), fabs(q[1])) < SLOPE_MOST * q[2]);
    for (int axis = 0; axis < 3; ++axis) {
      const double x = f->perspective && axis < 2 ? q[axis] / fmax(q[2], 1e-300) : q[axis];
      f->lo[axis] = corner ? fmin(f->lo[axis], x) : x;
      f->hi[axis] = corner ? fmax(f->hi[axis], x) : x;
    }
    depth_lo = fmin(depth_lo, q[2]);
    depth_hi = fmax(depth_hi, q[2]);
  }
  if (f->perspective && wide) {
    f->faces = 6;
    memset(f->basis, 0, sizeof f->basis);
    for (int axis = 0; axis < 3; ++axis) {
      f->basis[axis][axis] = 1.0;
      f->lo[axis] = axis < 2 ? -1.0 : 0.0;
      f->hi[axis] = axis < 2 ? 1.0 : largest;
      sides[axis] = axis < 2 ? 2.0 * largest : largest;
    }
    return;
  }
  const double scale = f->perspective ? 0.5 * (depth_lo + depth_hi) : 1.0;
  double longest = 1e-300;
  for (int axis = 0; axis < 3; ++axis) {
    sides[axis] = (f->hi[axis] - f->lo[axis]) * (axis < 2 ? scale : 1.0);
    longest = fmax(longest, sides[axis]);
  }
  for (int axis = 0; axis < 3; ++axis) { /* of flat matter, too, nodes are apart */
    const double more = 0.5 * fmax(FLAT * longest - sides[axis], 0.0) / (axis < 2 ? scale : 1.0);
    const bool distance = f->perspective && axis == 2;
    f->lo[axis] -= distance ? 0.0 : more;
    f->hi[axis] += distance ? 2.0 * more : more;
    sides[axis] = fmax(sides[axis], FLAT * longest);
  }
}

float stratus_light_passing(const int size[3], const int32_t* words, int face, const double place[3])
{
  int cell[3];
  float part[3], up[2];
  for (int axis = 0; axis < 3; ++axis) {
    const int last = axis < 2 ? size[axis] - 2 : size[2] - 1;
    cell[axis] = (int)fmax(fmin(place[axis], last), 0.0);
    part[axis] = (float)fmax(fmin(place[axis] - cell[axis], 1.0), 0.0);
  }
  const size_t layers = (size_t)size[2], across = layers * (size_t)size[0];
  const int32_t* at = words + (size_t)face * across * (size_t)size[1] + (size_t)cell[1] * across + (size_t)cell[0] * layers + cell[2];
  for (int row = 0; row < 2; ++row) {
    float column[2];
    for (int i = 0; i < 2; ++i) {
      const uint32_t word = (uint32_t)at[(size_t)row * across + (size_t)i * layers];
      column[i] = (float)(word & 0xffff) * (1.0f - part[2]) + (float)(word >> 16) * part[2];
    }
    up[row] = column[0] * (1.0f - part[0]) + column[1] * part[0];
  }
  return (up[0] * (1.0f - part[1]) + up[1] * part[1]) / 65535.0f;
}

int stratus_light_frame_coordinates(const stratus_light_frame* f, const double world[3], double q[3])
{
  double from[3], basis[3][3];
  int face = 0;
  for (int axis = 0; axis < 3; ++axis) {
    from[axis] = world[axis] - f->origin[axis];
  }
  if (f->faces == 6) {
    const double size[3] = { fabs(from[0]), fabs(from[1]), fabs(from[2]) };
    const int along = size[0] < size[2] && size[1] < size[2] ? 2 : size[0] < size[1] ? 1 : 0;
    face = 2 * along + (from[along] < 0.0);
  }
  stratus_light_face_basis(f, face, basis);
  for (int axis = 0; axis < 3; ++axis) {
    q[axis] = stratus_vector_dot(basis[axis], from);
  }
  const double nearer = f->perspective ? 1.0 / fmax(q[2], 1e-300) : 1.0;
  q[0] *= nearer;
  q[1] *= nearer;
  return face;
}
