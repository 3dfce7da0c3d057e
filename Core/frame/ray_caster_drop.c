/* SPDX-License-Identifier: BSD-3-Clause
 * Drops stale structures with everything derived from them: data -> transfer function -> values that show, table -> occupancy -> map. */
#include "ray_caster.h"

void stratus_ray_drop_offer_map(stratus_ray_caster* caster)
{
  stratus_ray_forget_offer(&caster->structure, true);
  caster->trial.tried[STRATUS_STRUCTURE_HYBRID] = false;
  if (caster->structure.map && caster->structure.map->tree_nodes > 0) {
    stratus_ray_drop_map(&caster->structure);
    caster->trial = (stratus_ray_trial){ .map = STRATUS_STRUCTURE_AUTO };
  }
}

void stratus_ray_drop_occupancy(stratus_ray_caster* caster)
{
  stratus_ray_drop_blocks(&caster->structure);
  caster->trial = (stratus_ray_trial){ .map = STRATUS_STRUCTURE_AUTO };
}

void stratus_ray_drop_values(stratus_ray_caster* caster)
{
  stratus_ray_drop_occupancy(caster);
  stratus_ray_drop_rough(&caster->structure);
  stratus_release(caster->context, caster->integrator.values.of);
  caster->integrator.values = (stratus_shown){ .of = NULL };
  stratus_ray_drop_tables(&caster->optics);
}

void stratus_ray_drop_transfer(stratus_ray_caster* caster)
{
  stratus_ray_drop_values(caster);
  stratus_release(caster->context, caster->optics.transfers);
  caster->optics.transfers = NULL;
}
