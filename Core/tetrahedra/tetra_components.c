/* SPDX-License-Identifier: BSD-3-Clause
 * Values of several components: a table for each, and the places of all values in them. */
#include "tetra_caster.h"

#include "mesh.h"
#include "table_fill.h"
#include "tetra_cells.h"

#include <string.h>

stratus_status stratus_tetra_components_check(
  stratus_context* context, const stratus_mesh* mesh, const stratus_transfer* transfers, const stratus_tetra_options* options)
{
  const int count = stratus_tetra_component_count(mesh);
  if (count == 1) {
    return STRATUS_OK;
  }
  if (options->method == STRATUS_TETRA_METHOD_PROJECT) {
    return stratus_fail(
      context, STRATUS_UNSUPPORTED, "values of %d components cannot be projected, only marched: take the method march or auto", count);
  }
  if (options->dependent && !(count == 2 || (count == 4 && !stratus_type_is_wide(mesh->type)))) {
    return stratus_fail(context, STRATUS_UNSUPPORTED,
      "%d dependent components of type %d are not supported, only 2 of any type, or 4 of up to 16 bits or floats", count, (int)mesh->type);
  }
  for (int c = 0; c < (options->dependent ? 1 : count); ++c) {
    TRY(stratus_transfer_check(context, transfers + c));
  }
  return STRATUS_OK;
}

void stratus_tetra_components_drop(stratus_tetra_caster* caster)
{
  stratus_tetra_components* m = &caster->components;
  stratus_tetra_device_drop_components(caster->device);
  stratus_release(caster->context, m->places);
  stratus_release(caster->context, m->sums);
  stratus_release(caster->context, m->transfers);
  *m = (stratus_tetra_components){ 0 };
}

/* ---- tables */

/* The finite fetched values of a component, from lo to hi. */
static stratus_table_values values_of(const stratus_mesh* mesh, int c, double bias)
{
  float lo = INFINITY, hi = -INFINITY;
  for (int p = 0; p < stratus_mesh_part_count(mesh); ++p) {
    const stratus_mesh* part = stratus_mesh_part(mesh, p);
    const stratus_volume component = stratus_tetra_component(part, c);
    const int64_t count = part->cell_values ? part->cell_count : part->point_count;
    for (int64_t i = 0; i < count; ++i) {
      const float value = stratus_volume_fetch(&component, bias, (size_t)i);
      lo = isfinite(value) ? fminf(lo, value) : lo;
      hi = isfinite(value) ? fmaxf(hi, value) : hi;
    }
  }
  return (stratus_table_values){ .fetching = { bias, stratus_type_is_wide(mesh->type), stratus_type_is_integer(mesh->type) },
    .lo = lo <= hi ? lo : 0.0f,
    .hi = lo <= hi ? hi : 0.0f,
    .uniform = true };
}

typedef struct components_build {
  stratus_tetra_caster* caster;
  const stratus_mesh* mesh;
  const stratus_transfer* transfers;
  stratus_tetra_components made;
} components_build;

/* Return the function of a component's table. half: points for a component that has only a colour. */
static stratus_transfer function_of(const components_build* b, int c, double half[2])
{
  const bool colors = b->made.dependent && c + 1 < b->made.count;
  stratus_transfer t = b->transfers[b->made.dependent ? 0 : c];
  if (colors) { /* any opacity: the sums' colours are divided by it */
    half[0] = 0.0;
    half[1] = 0.5;
    t.opacity = half;
    t.opacity_count = 1;
    t.clamp = 1;
  }
  return t;
}

/* Appends the sums of component c's table. */
static stratus_status add_table(components_build* b, int c)
{
  stratus_context* context = b->caster->context;
  stratus_tetra_components* m = &b->made;
  const stratus_table_values values = values_of(b->mesh, c, b->made.bias[c]);
  double half[2];
  const stratus_transfer function = function_of(b, c, half);
  stratus_table* table = NULL;
  int32_t* sums = NULL;
  void* memory = NULL;
  const bool hits = m->mode == STRATUS_TETRA_FIRST_HIT;
  stratus_status status = stratus_table_create_fine(context, &function, &values,
    hits ? STRATUS_SAMPLING_MIDPOINT : STRATUS_SAMPLING_PREINTEGRATED, hits ? function.unit_distance : 1.0, STRATUS_TETRA_ENTRIES, &table);
  status = status == STRATUS_OK ? (hits ? stratus_tetra_shown_sums : stratus_tetra_sums)(context, table, &sums) : status;
  const size_t words = status == STRATUS_OK ? STRATUS_TETRA_SUMS * (size_t)table->size : 0, at = (m->sum_count + 3) / 4 * 4;
  status = status == STRATUS_OK ? stratus_allocate_zero(context, at + words, sizeof(int32_t), &memory) : status;
  if (status == STRATUS_OK) {
    if (m->sums) {
      memcpy(memory, m->sums, m->sum_count * sizeof *m->sums);
    }
    memcpy((int32_t*)memory + at, sums, words * sizeof *sums);
    stratus_release(context, m->sums);
    m->sums = memory;
    m->sum_count = at + words;
    m->sums_at[c] = (int)at;
    m->last[c] = (float)(table->size - 1);
    m->depth_scale[c] = stratus_table_arguments_of(table).tau_scale * (m->dependent ? 1.0f : (float)function.weight);
    m->has_opaque[c] = table->has_opaque != 0 && (m->dependent || function.weight > 0.0);
    m->shown = m->shown || (table->shown > 0 && (m->dependent ? c + 1 == m->count : function.weight > 0.0));
    m->scale[c] = table->scale;
    m->offset[c] = table->offset;
    m->least[c] = values.lo;
  }
  stratus_release(context, sums);
  stratus_table_destroy(table);
  return status;
}

/* ---- places */

static stratus_status fill_places(components_build* b)
{
  stratus_tetra_components* m = &b->made;
  const stratus_tetra_mesh* tetra = b->caster->mesh;
  const stratus_tetra_cells cells = stratus_tetra_cells_of(tetra, b->mesh);
  void* memory = NULL;
  TRY(stratus_allocate_zero(b->caster->context, tetra->value_count, 4 * sizeof(float), &memory));
  m->places = memory;
  m->place_count = 4 * tetra->value_count;
  for (int part = 0; part < stratus_mesh_part_count(b->mesh); ++part) {
    const stratus_tetra_slots slots = stratus_tetra_slots_of(&cells, part);
    stratus_volume component[4];
    for (int c = 0; c < m->count; ++c) {
      component[c] = stratus_tetra_component(slots.mesh, c);
    }
#pragma omp parallel for num_threads(b->caster->context->threads)
    for (int64_t slot = 0; slot < slots.count; ++slot) {
      const int64_t value = stratus_tetra_value_at(&cells, &slots, slot);
      float* place = m->places + 4 * (tetra->names && !b->mesh->cell_values ? tetra->names[slot] : slots.first + slot);
      for (int c = 0; c < m->count && value >= 0; ++c) {
        const float fetched = stratus_volume_fetch(&component[c], b->made.bias[c], (size_t)value);
        place[c] = isfinite(fetched) ? fetched * b->made.scale[c] + b->made.offset[c] : 0.0f;
      }
    }
  }
  return STRATUS_OK;
}

static stratus_status build(components_build* b)
{
  stratus_tetra_components* m = &b->made;
  for (int c = 0; c < m->count; ++c) {
    b->made.bias[c] = stratus_tetra_bias(b->mesh, c);
    if (m->dependent && m->count == 4 && c < 3) { /* red, green and blue are not scaled to the range */
      b->made.scale[c] = 1.0f / 255.0f;
      b->made.offset[c] = (float)b->made.bias[c] * b->made.scale[c];
    } else if (m->mode == STRATUS_TETRA_ISOSURFACE) {
      m->scale[c] = 1.0f;
    } else {
      TRY(add_table(b, c));
    }
  }
  TRY(fill_places(b));
  return stratus_transfer_copy(b->caster->context, b->transfers, m->transfer_count, &m->transfers);
}

stratus_status stratus_tetra_components_update(stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_transfer* transfers,
  const stratus_tetra_options* options, double* ms)
{
  const int count = stratus_tetra_component_count(mesh);
  stratus_tetra_components* known = &caster->components;
  components_build b = { .caster = caster, .mesh = mesh, .transfers = transfers };
  const int labels = options->label_count;
  if (count == 1 && labels == 0) {
    stratus_tetra_components_drop(caster);
  }
  if (!stratus_tetra_mixes(mesh, options) && labels == 0) {
    return STRATUS_OK;
  }
  b.made = (stratus_tetra_components){ .count = count,
    .dependent = options->dependent != 0,
    .transfer_count = labels > 0 ? 1 + labels
      : options->dependent       ? 1
                                 : count,
    .mode = stratus_tetra_meets_components(mesh, options) ? options->mode : STRATUS_TETRA_COMPOSITE,
    .values = caster->value_builds,
    .low = caster->mesh->low,
    .high = caster->mesh->high };
  bool same = known->count == count && known->dependent == b.made.dependent && known->mode == b.made.mode &&
    known->transfer_count == b.made.transfer_count && known->values == caster->value_builds;
  for (int t = 0; t < b.made.transfer_count && same; ++t) {
    same = stratus_transfer_same(known->transfers + t, transfers + t);
  }
  if (same) {
    return STRATUS_OK;
  }
  const double start = stratus_now_ms();
  const stratus_status status = labels > 0 ? stratus_tetra_labels_build(caster->mesh, mesh, transfers, &b.made) : build(&b);
  stratus_tetra_components_drop(caster);
  *known = b.made;
  ++caster->component_builds;
  if (status != STRATUS_OK) {
    stratus_tetra_components_drop(caster);
  }
  *ms += stratus_now_ms() - start;
  return status;
}

/* Sets how the first component's values are parts of its range, and count. */
static void set_grey(const stratus_tetra_caster* caster, const stratus_tetra_options* options, stratus_tetra_media_arguments* a)
{
  const stratus_tetra_components* m = &caster->components;
  const double low = (double)m->low, width = (double)m->high - low, scale = (double)m->scale[0];
  const double per_place = scale > 0.0 && width > 0.0 ? 1.0 / (scale * width) : 0.0;
  a->grey[0] = (float)per_place;
  a->grey[1] = width > 0.0 ? (float)(-(double)m->offset[0] * per_place - low / width) : 0.0f;
  for (int end = 0; end < 2; ++end) {
    const double counted =
      options->mode == STRATUS_TETRA_AVERAGE ? options->average_range[end] - m->bias[0] : (end ? (double)INFINITY : -(double)INFINITY);
    a->counted[end] = (float)fmin(fmax(width > 0.0 ? (counted - low) / width : counted - low, -1e30), 1e30);
  }
}

void stratus_tetra_frame_components(
  stratus_tetra_frame* frame, const stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_tetra_options* options)
{
  const stratus_tetra_components* m = &caster->components;
  stratus_tetra_media_arguments* a = &frame->arguments.media;
  const bool labels = options->label_count > 0;
  if ((!stratus_tetra_mixes(mesh, options) && !labels) || (options->mode == STRATUS_TETRA_FIRST_HIT && options->dependent)) {
    return; /* hits of dependent components are of the last one's values, and coloured afterwards */
  }
  frame->lit = true;
  frame->components = m->places;
  frame->component_floats = m->place_count;
  frame->media = m->sums;
  frame->media_count = m->sum_count;
  a->labels = labels;
  if (labels) {
    return;
  }
  a->components = m->count;
  a->dependent = m->dependent;
  a->mean = options->mean_components && !m->dependent;
  for (int c = 0; c < m->count; ++c) {
    a->sums_at[c] = m->sums_at[c];
    a->last[c] = m->last[c];
    a->depth_scale[c] = m->depth_scale[c];
    a->has_opaque[c] = m->has_opaque[c];
    a->weight[c] = m->dependent ? 1.0f : (float)m->transfers[c].weight;
    if (options->mode == STRATUS_TETRA_SLICE) { /* a place has the optical depth of a unit distance of its own */
      a->depth_scale[c] *= (float)m->transfers[m->dependent ? 0 : c].unit_distance;
    }
    a->way_scale[c] = a->weight[c] > 0.0f ? m->depth_scale[c] / a->weight[c] * frame->arguments.factor_way : 0.0f;
  }
  if (options->mode == STRATUS_TETRA_AVERAGE || options->mode == STRATUS_TETRA_ADDITIVE) {
    set_grey(caster, options, a);
  }
}
