/* SPDX-License-Identifier: BSD-3-Clause
 * The look of a mesh: the tables of a transfer function, by which values are drawn. In mode composite a look has running sums per world
 * unit. In other modes it has colour and alpha over one unit distance, and sums if the mode adds values. */
#include "tetra_caster.h"

#include "mesh.h"
#include "table_fill.h"

#include <string.h>

void stratus_tetra_look_drop(stratus_context* context, stratus_tetra_look* look)
{
  stratus_table_destroy(look->table);
  stratus_release(context, look->sums);
  stratus_release(context, look->transfer);
  *look = (stratus_tetra_look){ 0 };
}

stratus_table_values stratus_tetra_look_values(const stratus_mesh* mesh, float low, float high, double bias)
{
  const bool any = low <= high;
  return (stratus_table_values){ .fetching = { bias, stratus_type_is_wide(mesh->type), stratus_type_is_integer(mesh->type) },
    .lo = any ? low : 0.0f,
    .hi = any ? high : 0.0f,
    .uniform = true };
}

stratus_status stratus_tetra_look_make(stratus_context* context, const stratus_table_values* values, const stratus_transfer* transfer,
  const stratus_tetra_options* options, const stratus_tetra_look* known, stratus_tetra_look* made)
{
  const stratus_tetra_mode mode = options->mode;
  static const double all[2] = { -(double)INFINITY, (double)INFINITY };
  const bool adds = mode == STRATUS_TETRA_AVERAGE || mode == STRATUS_TETRA_ADDITIVE;
  const double* range = mode == STRATUS_TETRA_AVERAGE ? options->average_range : all;
  stratus_status status;
  if (known->table && stratus_transfer_same_table(known->transfer, transfer) && known->mode == mode &&
    memcmp(known->average_range, range, sizeof known->average_range) == 0) {
    return STRATUS_OK;
  }
  made->mode = mode;
  memcpy(made->average_range, range, sizeof made->average_range);
  TRY(stratus_transfer_copy(context, transfer, 1, &made->transfer));
  TRY_CLEANUP(stratus_table_create_fine(context, transfer, values,
    mode == STRATUS_TETRA_COMPOSITE ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT,
    mode == STRATUS_TETRA_COMPOSITE ? 1.0 : transfer->unit_distance, STRATUS_TETRA_ENTRIES, &made->table));
  TRY_CLEANUP(adds                      ? stratus_tetra_value_sums(context, made->table, values, range, &made->sums)
      : mode == STRATUS_TETRA_FIRST_HIT ? stratus_tetra_shown_sums(context, made->table, &made->sums)
                                        : stratus_tetra_sums(context, made->table, &made->sums));
  return STRATUS_OK;
cleanup:
  stratus_tetra_look_drop(context, made);
  return status;
}

stratus_status stratus_tetra_look_update(
  stratus_tetra_caster* caster, const stratus_transfer* transfer, const stratus_tetra_options* options, stratus_tetra_look* made)
{
  const stratus_tetra_mesh* mesh = caster->mesh;
  const stratus_table_values values = stratus_tetra_look_values(&caster->view, mesh->low, mesh->high, mesh->bias);
  *made = (stratus_tetra_look){ 0 };
  return stratus_tetra_look_make(caster->context, &values, transfer, options, &caster->look, made);
}
