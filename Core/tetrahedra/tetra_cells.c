/* SPDX-License-Identifier: BSD-3-Clause
 * Finds tetrahedra and values of a mesh by their numbers. */
#include "tetra_cells.h"

#include "mesh.h"

#include <string.h>

const int stratus_lattice_ways[6][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 0, 2, 1 }, { 1, 0, 2 }, { 2, 1, 0 } };

void stratus_lattice_steps(const stratus_mesh* mesh, int64_t step[3])
{
  step[0] = 1;
  step[1] = mesh->lattice[0];
  step[2] = step[1] * mesh->lattice[1];
}

int64_t stratus_lattice_hexahedron(const stratus_mesh* mesh, int64_t point)
{
  const int32_t* n = mesh->lattice;
  const int64_t i = point % n[0], j = point / n[0] % n[1], k = point / n[0] / n[1];
  return i < n[0] - 1 && j < n[1] - 1 && k < n[2] - 1 ? (k * (n[1] - 1) + j) * (n[0] - 1) + i : -1;
}

stratus_tetra_cells stratus_tetra_cells_of(const stratus_tetra_mesh* tetra, const stratus_mesh* mesh)
{
  return (stratus_tetra_cells){ tetra, mesh, tetra->names ? tetra->cell_count : 6 * tetra->point_count };
}

/* The lattice that a point belongs to. */
static int lattice_of(const stratus_tetra_mesh* tetra, int64_t point)
{
  int low = 0, high = tetra->lattices;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    *(point < tetra->first[middle] ? &high : &low) = middle;
  }
  return low;
}

bool stratus_tetra_cell_at(const stratus_tetra_cells* cells, int64_t number, int32_t v[4], int64_t* value)
{
  const stratus_tetra_mesh* tetra = cells->tetra;
  if (tetra->names) {
    const int64_t cell = tetra->at ? (int64_t)tetra->at[number] : number;
    memcpy(v, cells->mesh->vertices + 4 * cell, 4 * sizeof *v);
    *value = number;
    return tetra->shown[cell] == STRATUS_TETRA_SHOWN;
  }
  const int64_t first = number / 6;
  const int way = (int)(number % 6);
  int64_t step[3];
  v[0] = (int32_t)first;
  *value = first;
  if (!((uint32_t)tetra->cells[first / 32] >> (first % 32) & 1)) {
    return false;
  }
  stratus_lattice_steps(stratus_mesh_part(cells->mesh, lattice_of(tetra, first)), step);
  for (int i = 0; i < 3; ++i) {
    v[i + 1] = v[i] + (int32_t)step[stratus_lattice_ways[way][i]];
  }
  return true;
}

void stratus_tetra_point_at(const stratus_tetra_cells* cells, int64_t point, double at[3])
{
  const int part = cells->tetra->names ? 0 : lattice_of(cells->tetra, point);
  stratus_mesh_point(stratus_mesh_part(cells->mesh, part), point - (cells->tetra->names ? 0 : cells->tetra->first[part]), at);
}

stratus_tetra_slots stratus_tetra_slots_of(const stratus_tetra_cells* cells, int part)
{
  const stratus_mesh* mesh = stratus_mesh_part(cells->mesh, part);
  return cells->tetra->names ? (stratus_tetra_slots){ mesh, 0, (int64_t)cells->tetra->value_count }
                             : (stratus_tetra_slots){ mesh, cells->tetra->first[part], mesh->point_count };
}

int64_t stratus_tetra_value_at(const stratus_tetra_cells* cells, const stratus_tetra_slots* slots, int64_t slot)
{
  if (cells->tetra->names) {
    return slots->mesh->cell_values ? (int64_t)cells->tetra->at[slot] : slot;
  }
  return slots->mesh->cell_values ? stratus_lattice_hexahedron(slots->mesh, slot) : slot;
}

/* ---- components */

int stratus_tetra_component_count(const stratus_mesh* mesh)
{
  return mesh->components > 1 ? mesh->components : 1;
}

stratus_volume stratus_tetra_component(const stratus_mesh* part, int c)
{
  stratus_volume volume = stratus_mesh_values(part);
  volume.values = (const char*)volume.values + (size_t)c * stratus_type_size(part->type);
  return volume;
}

double stratus_tetra_bias(const stratus_mesh* mesh, int c)
{
  double bias = INFINITY;
  for (int part = 0; part < stratus_mesh_part_count(mesh); ++part) {
    const stratus_volume volume = stratus_tetra_component(stratus_mesh_part(mesh, part), c);
    const double own = stratus_volume_bias(&volume);
    bias = fabs(own) < fabs(bias) ? own : bias;
  }
  return bias;
}

stratus_status stratus_tetra_fetch_component(const stratus_tetra_cells* cells, int c, double* bias, float** values)
{
  stratus_context* context = cells->tetra->context;
  void* memory = NULL;
  TRY(stratus_allocate_zero(context, cells->tetra->value_count, sizeof(float), &memory));
  *values = memory;
  const double offset = *bias = stratus_tetra_bias(cells->mesh, c);
  for (int part = 0; part < stratus_mesh_part_count(cells->mesh); ++part) {
    const stratus_tetra_slots slots = stratus_tetra_slots_of(cells, part);
    const stratus_volume volume = stratus_tetra_component(slots.mesh, c);
    float* out = *values + slots.first;
#pragma omp parallel for num_threads(context->threads)
    for (int64_t slot = 0; slot < slots.count; ++slot) {
      const int64_t value = stratus_tetra_value_at(cells, &slots, slot);
      out[slot] = value < 0 ? 0.0f : stratus_volume_fetch(&volume, offset, (size_t)value);
    }
  }
  return STRATUS_OK;
}

float stratus_tetra_fetch(const stratus_mesh* part, const stratus_volume* volume, double bias, size_t value)
{
  bool finite = true;
  for (int c = 1; c < part->components; ++c) {
    const stratus_volume other = stratus_tetra_component(part, c);
    finite = finite && isfinite(stratus_volume_fetch(&other, bias, value));
  }
  return finite ? stratus_volume_fetch(volume, bias, value) : NAN;
}
