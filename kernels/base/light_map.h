/* SPDX-License-Identifier: BSD-3-Clause
 * Maps of the light that passes to the places in a volume. A map is a stack of layers across the light's direction, each a picture of
 * nodes. A node is a word of 32 bits: below, in 16 bits, the part of light, 0..65535, that passes to the layer's near side there, and above
 * the part that passes to its far side. The words of a node's layers follow one another, then come the nodes across, then up.
 *
 * The map of a direction is parallel. That of a position is in perspective; if it may be in the volume, it has six faces, the sides of a
 * cube along the axes: +x -x +y -y +z -z.
 *
 * Opaque surfaces hide lights, too. Their words are floats: the depth, in layers, at which light meets the first surface, at nodes across,
 * then up. These nodes span the same part as the map's, and are closer to each other. */
#ifndef STRATUS_LIGHT_MAP_H
#define STRATUS_LIGHT_MAP_H

#include "gather.h"
#include "light_arguments.h"
#include "packet_math.h"

/* The part of a node's light at a fraction of a layer's depth. */
INLINE vfloat light_map_node(GLOBAL const int* map, vint at, vfloat depth)
{
  const vint word = v_gather_ints(map, at, vi_ge(at, vi_set(0)));
  const vfloat near = v_from_int(word & vi_set(0xffff)), far = v_from_int((word >> vi_set(16)) & vi_set(0xffff));
  return v_lerp(near, far, depth);
}

/* Takes places x to nodes across and up and layers of light i, and returns the faces that they are in. */
INLINE vint light_map_place(CONSTANT stratus_light_arguments* a, int i, const vfloat x[3], vfloat q[3])
{
  CONSTANT float *from = a->map_from[i], *scale = a->map_scale[i];
  for (int row = 0; row < 3; ++row) {
    CONSTANT float* m = from + 4 * row;
    q[row] = v_fma(v_set(m[0]), x[0], v_fma(v_set(m[1]), x[1], v_fma(v_set(m[2]), x[2], v_set(m[3]))));
  }
  vint face = vi_set(0);
  if (a->map_faces[i] > 1) { /* the largest coordinate decides; across and up are the two that follow it */
    const vfloat size_x = v_abs(q[0]), size_y = v_abs(q[1]), size_z = v_abs(q[2]), zero = v_set(0.0f);
    const vmask by_z = v_lt(size_x, size_z) & v_lt(size_y, size_z), by_y = m_andnot(v_lt(size_x, size_y), by_z);
    const vfloat across = v_select(by_z, q[0], v_select(by_y, q[2], q[1])), up = v_select(by_z, q[1], v_select(by_y, q[0], q[2]));
    const vfloat along = v_select(by_z, q[2], v_select(by_y, q[1], q[0]));
    face = vi_select(by_z, vi_set(4), vi_select(by_y, vi_set(2), vi_set(0))) + vi_select(v_lt(along, zero), vi_set(1), vi_set(0));
    q[0] = across;
    q[1] = up;
    q[2] = v_abs(along);
  }
  if (a->map_faces[i] > 0) {
    const vfloat nearer = v_reciprocal(v_max(q[2], v_set(1e-30f)));
    q[0] = v_fma(q[0] * nearer, v_set(scale[0]), v_set(scale[1]));
    q[1] = v_fma(q[1] * nearer, v_set(scale[2]), v_set(scale[3]));
    q[2] = v_fma(q[2], v_set(scale[4]), v_set(scale[5]));
  }
  return face;
}

/* The part of light i that surfaces let pass to a place of its map. */
INLINE vfloat light_map_surfaces(CONSTANT stratus_light_arguments* a, GLOBAL const int* maps, int i, const vfloat q[3], vint face)
{
  CONSTANT int* size = a->surface_size[i];
  vfloat part[2], lit[4];
  vint cell[2];
  for (int axis = 0; axis < 2; ++axis) {
    const vfloat at = v_clamp(q[axis] * v_set(a->surface_scale[i][axis]), 0.0f, (float)(size[axis] - 1));
    cell[axis] = vi_min(v_to_int(at), vi_set(size[axis] - 2));
    part[axis] = at - v_from_int(cell[axis]);
  }
  const vint first = vi_set(a->surface_at[i]) + (face * vi_set(size[1]) + cell[1]) * vi_set(size[0]) + cell[0];
  for (int node = 0; node < 4; ++node) {
    const vint at = first + vi_set(node & 1) + vi_set(node > 1 ? size[0] : 0);
    const vfloat depth = v_from_bits(v_gather_ints(maps, at, vi_ge(at, vi_set(0))));
    lit[node] = v_select(v_le(q[2], depth), v_set(1.0f), v_set(0.0f));
  }
  return v_lerp(v_lerp(lit[0], lit[1], part[0]), v_lerp(lit[2], lit[3], part[0]), part[1]);
}

/* The part of light i that passes the matter in front of a place of its map. */
INLINE vfloat light_map_matter(CONSTANT stratus_light_arguments* a, GLOBAL const int* maps, int i, vfloat q[3], vint face)
{
  CONSTANT int* size = a->map_size[i];
  vfloat part[3];
  vint cell[3];
  for (int axis = 0; axis < 3; ++axis) { /* layers have both their sides, nodes across and up are between two */
    const int last = axis < 2 ? size[axis] - 2 : size[2] - 1;
    q[axis] = v_clamp(q[axis], 0.0f, (float)(last + 1));
    cell[axis] = vi_min(v_to_int(q[axis]), vi_set(last));
    part[axis] = q[axis] - v_from_int(cell[axis]);
  }
  const vint right = vi_set(size[2]), above = vi_set(size[0] * size[2]);
  const vint at = vi_set(a->map_at[i]) + face * vi_set(size[0] * size[1] * size[2]) + cell[2] + right * cell[0] + above * cell[1];
  const vfloat low = v_lerp(light_map_node(maps, at, part[2]), light_map_node(maps, at + right, part[2]), part[0]);
  const vfloat high = v_lerp(light_map_node(maps, at + above, part[2]), light_map_node(maps, at + above + right, part[2]), part[0]);
  return v_lerp(low, high, part[1]) * v_set(1.0f / 65535.0f);
}

/* The part of light i that passes to the places x. */
INLINE vfloat light_map_passing(CONSTANT stratus_light_arguments* a, GLOBAL const int* maps, int i, const vfloat x[3])
{
  vfloat q[3];
  const vint face = light_map_place(a, i, x, q);
  const vfloat lit = a->surface_at[i] >= 0 ? light_map_surfaces(a, maps, i, q, face) : v_set(1.0f);
  return lit * light_map_matter(a, maps, i, q, face);
}

#endif
