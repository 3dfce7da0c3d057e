/* SPDX-License-Identifier: BSD-3-Clause
 * Nodes where a box belongs. They follow from only the box and the root's cell, so that no object stores a link to its node. Cells are
 * exact in double (their widths are powers of two) and stay the same when the root grows. */
#include "octree.h"

/* nextafterf() as one step of the bits, since every bound of every object needs it. */
static float next_above(float value)
{
  union {
    float value;
    int32_t bits;
  } u = { value + 0.0f }; /* -0 becomes +0 */
  u.bits += 1 | u.bits >> 31;
  return u.value;
}

void stratus_octree_relative(const stratus_octree* tree, const double bounds[6], float box[6])
{
  for (int a = 0; a < 3; ++a) {
    /* One step beyond the nearest float also covers the rounding of the difference. */
    box[a] = -next_above((float)(tree->origin[a] - bounds[2 * a]));
    box[a + 3] = next_above((float)(bounds[2 * a + 1] - tree->origin[a]));
  }
}

/* Centre of a box's bounding sphere; returns its radius. */
static double sphere_of(const float box[6], double center[3])
{
  double sum = 0.0;
  for (int a = 0; a < 3; ++a) {
    const double half = 0.5 * ((double)box[a + 3] - (double)box[a]);
    center[a] = 0.5 * ((double)box[a + 3] + (double)box[a]);
    sum += half * half;
  }
  return sqrt(sum) * (1.0 + 1e-12);
}

void stratus_octree_extent(const stratus_octree* tree, const float box[6], double lo[3], double hi[3])
{
  double center[3];
  const double radius = tree->options.placement == STRATUS_OCTREE_TOUCHING ? sphere_of(box, center) : 0.0;
  for (int a = 0; a < 3; ++a) {
    lo[a] = radius > 0.0 ? center[a] - radius : (double)box[a];
    hi[a] = radius > 0.0 ? center[a] + radius : (double)box[a + 3];
  }
}

bool stratus_octree_root_holds(const stratus_octree* tree, const float box[6])
{
  double lo[3], hi[3];
  stratus_octree_extent(tree, box, lo, hi);
  for (int a = 0; a < 3; ++a) {
    if (!(lo[a] > tree->corner[a] && hi[a] < tree->corner[a] + tree->edge)) {
      return false;
    }
  }
  return true;
}

static unsigned enclosing_octant(double pad, const double corner[3], double size, const float box[6])
{
  const double half = 0.5 * size, room = pad * half;
  unsigned octant = 0;
  for (int a = 0; a < 3; ++a) {
    const double middle = corner[a] + half;
    const bool upper = 0.5 * ((double)box[a] + (double)box[a + 3]) >= middle;
    const double lo = upper ? middle : corner[a];
    if ((double)box[a] < lo - room || (double)box[a + 3] > lo + half + room) {
      return 8;
    }
    octant |= (unsigned)upper << a;
  }
  return octant;
}

/* The paper's six bits, two for each axis: the halves of the cell that the sphere touches. */
static unsigned touched_octants(const double corner[3], double size, const float box[6])
{
  static const unsigned lower[3] = { 0x55, 0x33, 0x0f };
  double center[3];
  const double radius = sphere_of(box, center);
  unsigned octants = 0xff;
  for (int a = 0; a < 3; ++a) {
    const double middle = corner[a] + 0.5 * size;
    const unsigned below = center[a] - radius <= middle ? lower[a] : 0u, above = center[a] + radius >= middle ? 0xffu ^ lower[a] : 0u;
    octants &= below | above;
  }
  return octants;
}

unsigned stratus_octree_octants(const stratus_octree* tree, const double corner[3], double size, const float box[6])
{
  return tree->options.placement == STRATUS_OCTREE_TOUCHING ? touched_octants(corner, size, box)
                                                            : enclosing_octant(tree->pad, corner, size, box);
}

stratus_status stratus_octree_visit_places(stratus_octree* tree, const float box[6], stratus_octree_visit visit, void* user)
{
  /* A depth-first walk leaves at most seven siblings waiting on each level. */
  struct {
    stratus_octree_place place;
    int level;
  } stack[7 * STRATUS_OCTREE_LEVELS_MAX + 8];
  int height = 0;
  stack[height].place = (stratus_octree_place){ 0 };
  stack[height++].level = 0;
  while (height > 0) {
    const stratus_octree_place place = stack[--height].place;
    const int l = stack[height].level;
    const stratus_octree_level* level = &tree->levels[l];
    unsigned octants = 0;
    if (stratus_octree_is_split(level, place.node)) {
      double corner[3];
      stratus_octree_cell_corner(tree, l, &place, corner);
      octants = stratus_octree_octants(tree, corner, stratus_octree_cell_size(tree, l), box);
      if (tree->options.placement == STRATUS_OCTREE_ENCLOSING) {
        octants = octants < 8 ? 1u << octants : 0u;
      }
    }
    if (!octants) {
      TRY(visit(tree, l, place.node, user));
      continue;
    }
    const size_t group = stratus_octree_child_group(level, place.node);
    for (unsigned o = 0; o < 8; ++o) {
      if (octants >> o & 1) {
        stack[height].place = stratus_octree_child(&place, group, o);
        stack[height++].level = l + 1;
      }
    }
  }
  return STRATUS_OK;
}
