/* SPDX-License-Identifier: BSD-3-Clause
 * Creates and destroys ray casters. */
#include "ray_caster.h"

#include "first_hit_picture.h"
#include "ray_cast_device.h"
#include "ray_fetched.h"
#include "ray_shading_table.h"

stratus_status stratus_ray_caster_create(stratus_context* context, stratus_ray_caster** out)
{
  void* memory = NULL;
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!out) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "no place for the ray caster: out is NULL");
  }
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_ray_caster), &memory));
  *out = memory;
  (*out)->context = context;
  return STRATUS_OK;
}

void stratus_ray_caster_release(stratus_ray_caster* caster)
{
  if (caster) {
    stratus_ray_drop_transfer(caster);
    stratus_value_range_destroy(caster->ranges);
    stratus_release(caster->context, caster->hidden);
    stratus_release(caster->context, caster->layers);
    caster->ranges = NULL;
    caster->hidden = NULL;
    caster->layers = NULL;
    stratus_ray_fetched_drop(caster);
    stratus_ray_grid_release(caster->context, &caster->grid);
    stratus_first_hit_release(caster);
    for (int c = 0; c < STRATUS_RAY_PARTS; ++c) {
      stratus_ray_caster_destroy(caster->parts[c]);
      caster->parts[c] = NULL;
    }
    stratus_ray_shading_release(caster);
    stratus_ray_transfer_2d_release(caster);
    stratus_ray_device_destroy(caster);
  }
}

void stratus_ray_caster_destroy(stratus_ray_caster* caster)
{
  if (caster) {
    stratus_ray_caster_release(caster);
    stratus_first_hit_destroy(caster);
    stratus_tree_destroy(caster->offered);
    stratus_release(caster->context, caster);
  }
}
