/* SPDX-License-Identifier: BSD-3-Clause
 * Sets of boxes for the tests of bounding volume hierarchies on host and device. */
#ifndef STRATUS_TESTING_BOXES_H
#define STRATUS_TESTING_BOXES_H

#include "bvh_build.h"
#include "structures.h"

typedef enum box_set {
  BOXES_RANDOM,   /* of any size, overlapping */
  BOXES_UNIT,     /* voxels in a small grid: many coincide, and many are at equal distances */
  BOXES_ONE,      /* all coincide */
  BOXES_LINE,     /* voxels along y */
  BOXES_PLANE,    /* voxels in z = 5 */
  BOXES_DOUBLING, /* each twice as far out as the last, which makes the deepest trees */
  BOXES_UNEVEN,   /* a blob, a shell and noise, also at negative coordinates */
  BOX_SETS
} box_set;

static inline stratus_box unit_box(int64_t x, int64_t y, int64_t z)
{
  const int32_t lo[3] = { (int32_t)x, (int32_t)y, (int32_t)z };
  return (stratus_box){ { lo[0], lo[1], lo[2] }, { lo[0] + 1, lo[1] + 1, lo[2] + 1 } };
}

static inline stratus_box uneven_box(uint32_t i, uint32_t count, uint32_t* random)
{
  double at[3];
  double length = 0.0;
  for (int a = 0; a < 3; ++a) { /* sums of four uniform numbers are nearly normal, so blob and shell are nearly round */
    at[a] = 0.0;
    for (int k = 0; k < 4; ++k) {
      at[a] += (double)random_below(random, 2001) / 1000.0 - 1.0;
    }
    length += at[a] * at[a];
  }
  const double scale = i < count / 2 ? 6.0 : i < count - count / 6 ? 30.0 / (sqrt(length) + 1e-3) : 0.0;
  if (scale == 0.0) {
    return unit_box(random_below(random, 256) - 128, random_below(random, 128) - 64, random_below(random, 256) - 128);
  }
  const double shift = i < count / 2 ? 40.0 : -50.0;
  return unit_box((int64_t)floor(scale * at[0] + shift), (int64_t)floor(scale * at[1]), (int64_t)floor(scale * at[2]));
}

static inline stratus_box* make_boxes(box_set set, uint32_t count, uint32_t* random)
{
  stratus_box* boxes = malloc(count * sizeof *boxes);
  assert_non_null(boxes);
  for (uint32_t i = 0; i < count; ++i) {
    const int64_t doubled = (int64_t)1 << i % 28;
    switch (set) {
      case BOXES_RANDOM:
        for (int a = 0; a < 3; ++a) {
          boxes[i].lo[a] = (int32_t)(random_below(random, 1000) - 500);
          boxes[i].hi[a] = boxes[i].lo[a] + 1 + (int32_t)random_below(random, 30);
        }
        break;
      case BOXES_UNIT:
        boxes[i] = unit_box(random_below(random, 7), random_below(random, 6), random_below(random, 5));
        break;
      case BOXES_ONE:
        boxes[i] = unit_box(-3, 7, 9);
        break;
      case BOXES_LINE:
        boxes[i] = unit_box(4, random_below(random, 3 * (int64_t)count), 2);
        break;
      case BOXES_PLANE:
        boxes[i] = unit_box(random_below(random, 40), random_below(random, 40), 5);
        break;
      case BOXES_DOUBLING:
        boxes[i] = unit_box(doubled - 1, -doubled, i % 3 ? 0 : doubled - 1);
        break;
      default:
        boxes[i] = uneven_box(i, count, random);
    }
  }
  return boxes;
}

static inline stratus_bvh make_bvh_by(
  stratus_context* context, const stratus_bvh_options* options, const stratus_box* boxes, uint32_t count)
{
  stratus_bvh bvh = { .nodes = NULL };
  if (stratus_bvh_create(context, boxes, count, options, &bvh) != STRATUS_OK) {
    fail_msg("method %d, %u boxes: %s", (int)options->method, count, stratus_context_message(context));
  }
  return bvh;
}

static inline stratus_bvh make_bvh(
  stratus_context* context, stratus_tree_method method, const stratus_box* boxes, uint32_t count, int leaf_boxes, int max_depth)
{
  const stratus_bvh_options options = { .method = method, .leaf_boxes = leaf_boxes, .max_depth = max_depth };
  return make_bvh_by(context, &options, boxes, count);
}

static inline void assert_same_bvh(const stratus_bvh* a, const stratus_bvh* b, uint32_t count)
{
  assert_int_equal(a->node_count, b->node_count);
  assert_memory_equal(a->nodes, b->nodes, a->node_count * sizeof *a->nodes);
  assert_memory_equal(a->order, b->order, count * sizeof *a->order);
}

#endif
