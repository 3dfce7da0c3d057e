/* SPDX-License-Identifier: BSD-3-Clause
 * Linear BVH (Lauterbach et al. 2009): a range of boxes splits at the highest bit in which their Morton codes differ. Each node finds its
 * own range (Karras 2012). Device and host compile the same source. */
#include "bvh_build.h"

#include "device.h"
#include "morton.h"

stratus_status stratus_bvh_build_lbvh(stratus_bvh_build* build)
{
  _Static_assert(MORTON_LEAF == STRATUS_BVH_LEAF, "the kernel's children are the layout's");
  build->root = 0;
  if (stratus_device_takes_boxes(build->context, build->count)) {
    const stratus_status status = stratus_device_morton_hierarchy(build->context, build->codes, build->count, build->pairs);
    if (!stratus_device_hands_back(build->context, status)) {
      return status;
    }
  }
#pragma omp parallel for schedule(static) num_threads(build->context->threads)
  for (uint32_t i = 0; i < build->count - 1; ++i) {
    uint32_t* child = build->pairs[i].child;
    morton_children(build->codes, build->count, i, child, child + 1);
  }
  return STRATUS_OK;
}
