/* SPDX-License-Identifier: BSD-3-Clause
 * Sets of voxels for tests: random ones, and shapes that break heuristics made for clouds. */
#ifndef STRATUS_TESTING_VOXEL_SETS_H
#define STRATUS_TESTING_VOXEL_SETS_H

#include "structures.h"
#include "voxels.h"

#define VOXEL_SET_MAX 40000

typedef struct voxel_set {
  int64_t dimensions[3];
  size_t count;
  int32_t at[VOXEL_SET_MAX][3];
} voxel_set;

static inline void set_begin(voxel_set* set, int64_t nx, int64_t ny, int64_t nz)
{
  set->dimensions[0] = nx;
  set->dimensions[1] = ny;
  set->dimensions[2] = nz;
  set->count = 0;
}

static inline void set_add(voxel_set* set, int64_t x, int64_t y, int64_t z)
{
  assert_true(set->count < VOXEL_SET_MAX);
  int32_t* at = set->at[set->count++];
  at[0] = (int32_t)x;
  at[1] = (int32_t)y;
  at[2] = (int32_t)z;
}

/* Adds all voxels of [x0, x1) x [y0, y1) x [z0, z1). */
static inline void set_add_box(voxel_set* set, int64_t x0, int64_t x1, int64_t y0, int64_t y1, int64_t z0, int64_t z1)
{
  for (int64_t z = z0; z < z1; ++z) {
    for (int64_t y = y0; y < y1; ++y) {
      for (int64_t x = x0; x < x1; ++x) {
        set_add(set, x, y, z);
      }
    }
  }
}

static inline void set_add_noise(voxel_set* set, int64_t count, uint32_t* random)
{
  for (int64_t i = 0; i < count; ++i) {
    const int64_t x = random_below(random, set->dimensions[0]), y = random_below(random, set->dimensions[1]);
    set_add(set, x, y, random_below(random, set->dimensions[2]));
  }
}

/* Adds the voxels whose distance to (c, c, c) is within half a voxel of the radius. */
static inline void set_add_shell(voxel_set* set, int c, int radius)
{
  for (int z = -radius - 1; z <= radius + 1; ++z) {
    for (int y = -radius - 1; y <= radius + 1; ++y) {
      for (int x = -radius - 1; x <= radius + 1; ++x) {
        if (fabs(sqrt((double)(x * x + y * y + z * z)) - radius) < 0.5) {
          set_add(set, c + x, c + y, c + z);
        }
      }
    }
  }
}

static inline stratus_voxels* make_voxels(stratus_context* context, const voxel_set* set)
{
  stratus_voxels* voxels = NULL;
  if (stratus_voxels_create_list(context, set->dimensions, set->at[0], set->count, &voxels) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(context));
  }
  return voxels;
}

/* Lists the voxels by ascending brick and bit, the numbering of an exact density. at: voxels->count triples. */
static inline void list_voxels(const stratus_voxels* voxels, int32_t (*at)[3])
{
  for (int64_t b = 0; b < voxels->brick_count; ++b) {
    const stratus_brick* brick = voxels->bricks + b;
    for (int bit = 0; bit < 64; ++bit) {
      if (brick->mask >> bit & 1) {
        (*at)[0] = 4 * brick->at[0] + bit % 4;
        (*at)[1] = 4 * brick->at[1] + bit / 4 % 4;
        (*at)[2] = 4 * brick->at[2] + bit / 16;
        ++at;
      }
    }
  }
}

#endif
