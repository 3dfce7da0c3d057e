/* SPDX-License-Identifier: BSD-3-Clause
 * Creates and destroys ray casters, and keeps the trees that are offered to them. */
#include "ray_caster.h"

#include "first_hit_picture.h"
#include "ray_cast_device.h"
#include "tree.h"

#include <string.h>

static const double identity[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };

stratus_status stratus_ray_caster_offer_tree(stratus_ray_caster* caster, const void* bytes, size_t size)
{
  stratus_tree* tree = NULL;
  if (!caster) {
    return STRATUS_INVALID_ARGUMENT;
  }
  stratus_tree_destroy(caster->structure.offered);
  caster->structure.offered = NULL;
  stratus_ray_drop_offer_map(caster);
  if (bytes) {
    TRY(stratus_tree_load(caster->context, bytes, size, &tree));
    /* rays are in index coordinates, so the volume's geometry at the time of the build does not matter */
    memcpy(tree->index_to_world, identity, sizeof identity);
    memcpy(tree->world_to_index, identity, sizeof identity);
    caster->structure.offered = tree;
    caster->structure.tree_serves = -1;
  }
  return STRATUS_OK;
}

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
  (*out)->context = (*out)->field.context = (*out)->optics.context = context;
  return STRATUS_OK;
}

void stratus_ray_caster_release(stratus_ray_caster* caster)
{
  if (caster) {
    stratus_ray_drop_transfer(caster);
    stratus_ray_field_release(&caster->field);
    stratus_release(caster->context, caster->optics.layers);
    caster->optics.layers = NULL;
    stratus_first_hit_release(caster);
    stratus_light_state_drop(&caster->light);
    caster->optics.lights = NULL;
    for (int c = 0; c < STRATUS_RAY_PARTS; ++c) {
      stratus_ray_caster_destroy(caster->parts[c]);
      caster->parts[c] = NULL;
    }
    stratus_ray_shading_release(&caster->optics);
    stratus_ray_transfer_2d_release(caster->context, &caster->optics.transfer_2d);
    stratus_ray_device_destroy(caster);
  }
}

void stratus_ray_caster_destroy(stratus_ray_caster* caster)
{
  if (caster) {
    stratus_ray_caster_release(caster);
    stratus_first_hit_destroy(caster);
    stratus_tree_destroy(caster->structure.offered);
    stratus_release(caster->context, caster);
  }
}
