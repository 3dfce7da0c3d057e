/* SPDX-License-Identifier: BSD-3-Clause
 * Tables of transfer functions, and components that are drawn by themselves: in modes that find one value a ray, each component of a mesh
 * has values and a table of its own, which take the places of the first component's while it is drawn, and the pictures are added. */
#include "tetra_caster.h"

#include "mesh.h"
#include "table_fill.h"
#include "tetra_cells.h"

#include <string.h>

/* Entries of a table. Segments end at any value, which is rounded to an entry: the error of light falls with the width of entries. */
#define ENTRIES 32768

/* ---- tables */

void stratus_tetra_look_drop(stratus_context* context, stratus_tetra_look* look)
{
  stratus_table_destroy(look->table);
  stratus_release(context, look->sums);
  stratus_release(context, look->transfer);
  *look = (stratus_tetra_look){ 0 };
}

static stratus_table_values values_of(const stratus_mesh* mesh, float low, float high, double bias)
{
  const bool any = low <= high;
  return (stratus_table_values){ .fetching = { bias, stratus_type_is_wide(mesh->type), stratus_type_is_integer(mesh->type) },
    .lo = any ? low : 0.0f,
    .hi = any ? high : 0.0f,
    .uniform = true };
}

/* Composite: running sums per world unit. Other modes: colour and alpha over one unit distance, and sums where values are added. */
static stratus_status make_look(stratus_context* context, const stratus_table_values* values, const stratus_transfer* transfer,
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
    mode == STRATUS_TETRA_COMPOSITE ? 1.0 : transfer->unit_distance, ENTRIES, &made->table));
  TRY_CLEANUP(adds ? stratus_tetra_value_sums(context, made->table, values, range, &made->sums)
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
  const stratus_table_values values = values_of(&caster->view, mesh->low, mesh->high, mesh->bias);
  *made = (stratus_tetra_look){ 0 };
  return make_look(caster->context, &values, transfer, options, &caster->look, made);
}

/* ---- components that are drawn by themselves */

bool stratus_tetra_draws_parts(const stratus_mesh* mesh, const stratus_tetra_options* options)
{
  return stratus_tetra_component_count(mesh) > 1 && options->mode != STRATUS_TETRA_COMPOSITE && options->mode != STRATUS_TETRA_ISOSURFACE;
}

void stratus_tetra_parts_drop(stratus_tetra_caster* caster)
{
  for (int c = 0; c < STRATUS_TETRA_PARTS; ++c) {
    stratus_tetra_look_drop(caster->context, &caster->parts[c].look);
    stratus_release(caster->context, caster->parts[c].values);
    caster->parts[c] = (stratus_tetra_part){ 0 };
  }
  caster->part_values = 0;
}

/* Fetch component c's values in the order of the mesh's own, and find the range over the cells with a volume. */
static stratus_status fetch_part(const stratus_tetra_caster* caster, const stratus_mesh* mesh, int c, stratus_tetra_part* part)
{
  const stratus_tetra_cells cells = stratus_tetra_cells_of(caster->mesh, mesh);
  const int threads = caster->context->threads;
  float low = INFINITY, high = -INFINITY;
  TRY(stratus_tetra_fetch_component(&cells, c, &part->bias, &part->values));
  const float* values = part->values;
#pragma omp parallel for num_threads(threads) reduction(min : low) reduction(max : high)
  for (int64_t number = 0; number < cells.count; ++number) {
    int32_t v[4];
    int64_t own;
    const bool shows = stratus_tetra_cell_at(&cells, number, v, &own);
    for (int i = 0; shows && i < 4; ++i) {
      const float value = values[mesh->cell_values ? own : v[i]];
      low = fminf(low, value);
      high = fmaxf(high, value);
    }
  }
  part->low = low;
  part->high = high;
  return STRATUS_OK;
}

void stratus_tetra_part_swap(stratus_tetra_caster* caster, stratus_tetra_part* part)
{
  stratus_tetra_mesh* mesh = caster->mesh;
  float** values = mesh->values ? &mesh->values : &mesh->cell_values;
  const stratus_tetra_part own = { *values, mesh->low, mesh->high, mesh->bias, caster->look };
  stratus_tetra_device_drop_values(caster->device); /* the device reads tables and values in place, or knows them by the mesh's builds */
  stratus_tetra_device_drop_table(caster->device);
  *values = part->values;
  mesh->low = part->low;
  mesh->high = part->high;
  mesh->bias = part->bias;
  caster->look = part->look;
  *part = own;
}

stratus_status stratus_tetra_parts_update(stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_transfer* transfers,
  const stratus_tetra_options* options, double* ms)
{
  const double start = stratus_now_ms();
  stratus_status status = STRATUS_OK;
  if (!stratus_tetra_draws_parts(mesh, options)) {
    return STRATUS_OK;
  }
  if (caster->part_values != caster->value_builds) {
    stratus_tetra_parts_drop(caster);
  }
  for (int c = 1; c < stratus_tetra_component_count(mesh) && status == STRATUS_OK; ++c) {
    stratus_tetra_part* part = caster->parts + c - 1;
    stratus_tetra_look made = { 0 };
    status = part->values ? STRATUS_OK : fetch_part(caster, mesh, c, part);
    if (status == STRATUS_OK) {
      const stratus_table_values values = values_of(mesh, part->low, part->high, part->bias);
      status = make_look(caster->context, &values, transfers + c, options, &part->look, &made);
    }
    if (made.table) {
      stratus_tetra_look_drop(caster->context, &part->look);
      part->look = made;
      ++caster->table_builds;
    }
  }
  caster->part_values = caster->value_builds;
  if (status != STRATUS_OK) {
    stratus_tetra_parts_drop(caster);
  }
  *ms += stratus_now_ms() - start;
  return status;
}
