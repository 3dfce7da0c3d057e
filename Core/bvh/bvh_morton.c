/* SPDX-License-Identifier: BSD-3-Clause
 * Sorting of boxes in Morton order, the first step of every builder: neighbours in space become neighbours in memory. Device and host
 * compute the same codes to the bit. The host's radix sort is stable, so that the order does not depend on the number of threads. */
#include "bvh_build.h"

#include "device.h"
#include "morton.h"
#include "radix_sort.h"

#include <omp.h>
#include <string.h>

/* Of twice the boxes' middles. */
static void middle_bounds(stratus_context* context, const stratus_box* boxes, uint32_t count, int32_t least[3], int32_t most[3])
{
  int32_t lx = INT32_MAX, ly = INT32_MAX, lz = INT32_MAX, mx = INT32_MIN, my = INT32_MIN, mz = INT32_MIN;
#pragma omp parallel for schedule(static) num_threads(context->threads) reduction(min : lx, ly, lz) reduction(max : mx, my, mz)
  for (uint32_t i = 0; i < count; ++i) {
    const int32_t x = stratus_box_middle(boxes + i, 0), y = stratus_box_middle(boxes + i, 1), z = stratus_box_middle(boxes + i, 2);
    lx = x < lx ? x : lx;
    ly = y < ly ? y : ly;
    lz = z < lz ? z : lz;
    mx = x > mx ? x : mx;
    my = y > my ? y : my;
    mz = z > mz ? z : mz;
  }
  memcpy(least, (const int32_t[]){ lx, ly, lz }, 3 * sizeof *least);
  memcpy(most, (const int32_t[]){ mx, my, mz }, 3 * sizeof *most);
}

/* *bits: length of the codes. */
static stratus_status make_codes(stratus_bvh_build* build, const stratus_box* boxes, int* bits)
{
  int32_t least[3], most[3];
  uint32_t extent = 0;
  int shift = 0, axis_bits = 0;
  middle_bounds(build->context, boxes, build->count, least, most);
  for (int a = 0; a < 3; ++a) {
    extent |= (uint32_t)most[a] - (uint32_t)least[a];
  }
  while (extent >> shift >= 1u << 21) {
    ++shift;
  }
  while (extent >> shift >> axis_bits) {
    ++axis_bits;
  }
  *bits = 3 * axis_bits;
  if (stratus_device_takes_boxes(build->context, build->count)) {
    const stratus_status status = stratus_device_morton_codes(build->context, boxes, build->count, least, shift, build->codes);
    if (!stratus_device_hands_back(build->context, status)) {
      return status;
    }
  }
#pragma omp parallel for schedule(static) num_threads(build->context->threads)
  for (uint32_t i = 0; i < build->count; ++i) {
    const stratus_box* box = boxes + i;
    build->codes[i] = morton_code((uint32_t)(stratus_box_middle(box, 0) - least[0]), (uint32_t)(stratus_box_middle(box, 1) - least[1]),
      (uint32_t)(stratus_box_middle(box, 2) - least[2]), shift);
  }
  return STRATUS_OK;
}

stratus_status stratus_bvh_sort_boxes(stratus_bvh_build* build, const stratus_box* boxes)
{
  void* memory;
  int bits = 0;
  TRY(stratus_allocate(build->context, build->count, sizeof *build->codes, &memory));
  build->codes = memory;
  TRY(stratus_allocate(build->context, build->count, sizeof *build->number, &memory));
  build->number = memory;
  TRY(make_codes(build, boxes, &bits));
  for (uint32_t i = 0; i < build->count; ++i) {
    build->number[i] = i;
  }
  TRY(stratus_radix_sort(build->context, build->codes, build->number, build->count, bits));
  TRY(stratus_allocate(build->context, build->count, sizeof *build->boxes, &memory));
  build->boxes = memory;
#pragma omp parallel for schedule(static) num_threads(build->context->threads)
  for (uint32_t i = 0; i < build->count; ++i) {
    build->boxes[i] = boxes[build->number[i]];
  }
  return STRATUS_OK;
}
