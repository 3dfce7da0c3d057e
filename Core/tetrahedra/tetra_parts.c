/* SPDX-License-Identifier: BSD-3-Clause
 * Components that are drawn separately. In modes that find one value per ray, each component of a mesh has its own values and look. While a
 * component is drawn, its values and look replace the first component's. The images are added. Of dependent components, only the last one
 * is drawn so. */
#include "tetra_caster.h"

#include "mesh.h"
#include "tetra_cells.h"

#include <string.h>

bool stratus_tetra_draws_last(const stratus_mesh* mesh, const stratus_tetra_options* options)
{
  return stratus_tetra_component_count(mesh) > 1 && options->dependent && options->mode != STRATUS_TETRA_COMPOSITE &&
    options->mode != STRATUS_TETRA_SLICE;
}

bool stratus_tetra_draws_parts(const stratus_mesh* mesh, const stratus_tetra_options* options)
{
  return stratus_tetra_component_count(mesh) > 1 && !options->dependent && options->mode >= STRATUS_TETRA_MAXIMUM &&
    options->mode <= STRATUS_TETRA_ADDITIVE;
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
  const bool last = stratus_tetra_draws_last(mesh, options);
  stratus_tetra_options own = *options;
  if (last) { /* the range is of the first component's values */
    own.average_range[0] = -(double)INFINITY;
    own.average_range[1] = (double)INFINITY;
  }
  if (!last && !stratus_tetra_draws_parts(mesh, options)) {
    return STRATUS_OK;
  }
  if (caster->part_values != caster->value_builds) {
    stratus_tetra_parts_drop(caster);
  }
  for (int c = last ? stratus_tetra_component_count(mesh) - 1 : 1; c < stratus_tetra_component_count(mesh) && status == STRATUS_OK; ++c) {
    stratus_tetra_part* part = caster->parts + c - 1;
    stratus_tetra_look made = { 0 };
    status = part->values ? STRATUS_OK : fetch_part(caster, mesh, c, part);
    if (status == STRATUS_OK) {
      const stratus_table_values values = stratus_tetra_look_values(mesh, part->low, part->high, part->bias);
      status = stratus_tetra_look_make(caster->context, &values, transfers + (last ? 0 : c), &own, &part->look, &made);
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
