/* SPDX-License-Identifier: BSD-3-Clause
 * Labels of cells: tables of their functions, alike in size so that a value has one entry in all, and the label of each cell as rays read
 * it. */
#include "tetra_caster.h"

#include "gradient_factors.h"
#include "mesh.h"
#include "table_fill.h"
#include "tetra_cells.h"

#include <string.h>

stratus_status stratus_tetra_labels_check(
  stratus_context* context, const stratus_mesh* mesh, const stratus_transfer* transfers, const stratus_tetra_options* options)
{
  const int count = options->label_count;
  bool all = true;
  for (int part = 0; part < stratus_mesh_part_count(mesh); ++part) {
    all = all && stratus_mesh_part(mesh, part)->labels;
  }
  if (count < 0 || count > STRATUS_TETRA_LABELS_MAX || (count > 0 && !all)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "label_count %d of a mesh %s labels, must be 0..%d, and each cell must have one",
      count, all ? "with" : "without", STRATUS_TETRA_LABELS_MAX);
  }
  if (count > 0 && (stratus_tetra_component_count(mesh) > 1 || options->mode != STRATUS_TETRA_COMPOSITE)) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "labels in mode %s of a mesh of %d components: only composite of 1 has them",
      stratus_tetra_mode_name(options->mode), stratus_tetra_component_count(mesh));
  }
  if (count > 0 && options->method == STRATUS_TETRA_METHOD_PROJECT) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "labels cannot be projected, only marched: take the method march or auto");
  }
  for (int l = 1; l <= count; ++l) {
    TRY(stratus_transfer_check(context, transfers + l));
  }
  return STRATUS_OK;
}

/* The functions' tables. Equal functions share one. */
typedef struct label_tables {
  stratus_table* made[STRATUS_TETRA_LABELS_MAX + 1]; /* of a label; NULL: it has the table of an earlier one */
  int of[STRATUS_TETRA_LABELS_MAX + 1];              /* the label whose table a label has */
} label_tables;

/* Makes tables until all have the number of entries of the one that needs most. */
static stratus_status create_tables(
  stratus_context* context, const stratus_table_values* values, const stratus_transfer* transfers, int count, label_tables* t)
{
  int entries = STRATUS_TETRA_ENTRIES;
  bool alike = false;
  while (!alike) {
    alike = true;
    for (int l = 0; l < count; ++l) {
      for (t->of[l] = 0; !stratus_transfer_same_table(transfers + t->of[l], transfers + l);) {
        ++t->of[l];
      }
      if (t->of[l] < l || (t->made[l] && t->made[l]->size == entries)) {
        continue;
      }
      stratus_table_destroy(t->made[l]);
      t->made[l] = NULL;
      TRY(stratus_table_create_fine(context, transfers + l, values, STRATUS_SAMPLING_PREINTEGRATED, 1.0, entries, &t->made[l]));
      alike = alike && t->made[l]->size == entries;
      entries = t->made[l]->size;
    }
  }
  return STRATUS_OK;
}

/* Lays out the labels' records, and then the sums of each table. */
static stratus_status fill_sums(
  stratus_context* context, const stratus_transfer* transfers, int count, const label_tables* t, stratus_tetra_components* m)
{
  const size_t words = STRATUS_TETRA_SUMS * (size_t)t->made[0]->size;
  size_t at = TETRA_LABEL * (size_t)count;
  void* memory = NULL;
  m->sum_count = at;
  for (int l = 0; l < count; ++l) {
    m->sum_count += t->made[l] ? words : 0;
  }
  TRY(stratus_allocate_zero(context, m->sum_count, sizeof *m->sums, &memory));
  m->sums = memory;
  m->table = stratus_table_arguments_of(t->made[0]);
  m->table.tau_scale = 1.0f;
  for (int l = 0; l < count; ++l) {
    int32_t *record = m->sums + TETRA_LABEL * l, *sums = NULL;
    const stratus_transfer* thins = transfers + (transfers[l].gradient_count > 0 ? l : 0);
    const float scale = thins->gradient_count > 0 ? stratus_gradient_factors(thins, NULL) : 0.0f;
    if (t->made[l]) {
      const stratus_table_arguments table = stratus_table_arguments_of(t->made[l]);
      TRY(stratus_tetra_sums(context, t->made[l], &sums));
      memcpy(m->sums + at, sums, words * sizeof *sums);
      stratus_release(context, sums);
      record[0] = (int32_t)at;
      at += words;
      memcpy(record + 1, &table.tau_scale, sizeof *record);
      m->table.color_slope = fmaxf(m->table.color_slope, table.color_slope);
      m->table.has_opaque |= table.has_opaque;
      m->shown = m->shown || t->made[l]->shown > 0;
    } else {
      memcpy(record, m->sums + TETRA_LABEL * t->of[l], 2 * sizeof *record);
    }
    memcpy(record + 2, &scale, sizeof scale);
    record[3] = l;
  }
  return STRATUS_OK;
}

/* Stores the labels by cells' places, of a lattice by first corners. */
static stratus_status fill_labels(const stratus_tetra_mesh* tetra, const stratus_mesh* mesh, int count, stratus_tetra_components* m)
{
  void* memory = NULL;
  m->place_count = (size_t)(tetra->names ? tetra->cell_count : tetra->point_count);
  TRY(stratus_allocate_zero(tetra->context, m->place_count, sizeof *m->places, &memory));
  m->places = memory;
  for (int p = 0; p < stratus_mesh_part_count(mesh); ++p) {
    const stratus_mesh* part = stratus_mesh_part(mesh, p);
    const int64_t first = tetra->names ? 0 : tetra->first[p], slots = tetra->names ? tetra->cell_count : part->point_count;
#pragma omp parallel for num_threads(tetra->context->threads)
    for (int64_t slot = 0; slot < slots; ++slot) {
      const int64_t cell = tetra->names ? (int64_t)tetra->at[slot] : stratus_lattice_hexahedron(part, slot);
      const int label = cell < 0 ? 0 : part->labels[cell];
      m->places[first + slot] = label < count ? (float)label : 0.0f;
    }
  }
  return STRATUS_OK;
}

stratus_status stratus_tetra_labels_build(
  const stratus_tetra_mesh* tetra, const stratus_mesh* mesh, const stratus_transfer* transfers, stratus_tetra_components* m)
{
  const stratus_table_values values = stratus_tetra_look_values(mesh, tetra->low, tetra->high, tetra->bias);
  stratus_status status = STRATUS_OK;
  void* memory = NULL;
  TRY(stratus_allocate_zero(tetra->context, 1, sizeof(label_tables), &memory));
  label_tables* tables = memory;
  TRY_CLEANUP(create_tables(tetra->context, &values, transfers, m->transfer_count, tables));
  TRY_CLEANUP(fill_sums(tetra->context, transfers, m->transfer_count, tables, m));
  TRY_CLEANUP(fill_labels(tetra, mesh, m->transfer_count, m));
  status = stratus_transfer_copy(tetra->context, transfers, m->transfer_count, &m->transfers);
cleanup:
  for (int l = 0; l < m->transfer_count; ++l) {
    stratus_table_destroy(tables->made[l]);
  }
  stratus_release(tetra->context, tables);
  return status;
}
