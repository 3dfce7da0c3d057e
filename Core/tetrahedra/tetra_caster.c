/* SPDX-License-Identifier: BSD-3-Clause
 * The renderer of tetrahedra: checks its input, rebuilds what changed (mesh: cells and border faces; transfer function: table), draws and
 * reports. */
#include "tetra_caster.h"
#include "tetra_lattice.h"

#include "device.h"
#include "picture.h"
#include "camera.h"
#include "lights.h"
#include "mesh.h"

#include <stdio.h>
#include <string.h>

/* Entries of the table. Segments end at any value, which is rounded to an entry: the error of light falls with the width of entries. */
#define ENTRIES 32768

stratus_tetra_options stratus_tetra_options_default(void)
{
  return (stratus_tetra_options){
    .tolerance = 0.001, .average_range = { -(double)INFINITY, (double)INFINITY }, .shading = stratus_shading_default()
  };
}

stratus_status stratus_tetra_caster_create(stratus_context* context, stratus_tetra_caster** out)
{
  void* memory = NULL;
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!out) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "no place for the caster of tetrahedra: out is NULL");
  }
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_tetra_caster), &memory));
  *out = memory;
  (*out)->context = context;
  return STRATUS_OK;
}

static void drop_table(stratus_tetra_caster* caster)
{
  stratus_tetra_device_drop_table(caster->device);
  stratus_tetra_light_drop_factors(caster);
  stratus_table_destroy(caster->table);
  stratus_release(caster->context, caster->march_sums);
  stratus_release(caster->context, caster->transfer);
  caster->table = NULL;
  caster->march_sums = NULL;
  caster->transfer = NULL;
}

static void drop_mesh(stratus_tetra_caster* caster)
{
  drop_table(caster); /* the table spans the mesh's values */
  stratus_tetra_light_drop(caster);
  stratus_tetra_components_drop(caster);
  stratus_tetra_device_destroy(caster->context, caster->device); /* the device may read the mesh in place */
  caster->device = NULL;
  stratus_tetra_projector_destroy(caster->projector);
  caster->projector = NULL;
  stratus_tetra_mesh_destroy(caster->mesh);
  caster->mesh = NULL;
}

void stratus_tetra_caster_release(stratus_tetra_caster* caster)
{
  if (caster) {
    drop_mesh(caster);
    stratus_tetra_list_destroy(caster->list);
    caster->list = NULL;
    stratus_tetra_buffers_release(caster->context, &caster->buffers);
  }
}

void stratus_tetra_caster_destroy(stratus_tetra_caster* caster)
{
  if (caster) {
    stratus_tetra_caster_release(caster);
    stratus_release(caster->context, caster);
  }
}

static stratus_status check_options(stratus_context* context, const stratus_tetra_options* options)
{
  if ((unsigned)options->mode > STRATUS_TETRA_ISOSURFACE) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "mode %d of tetrahedra outside 0..%d", (int)options->mode, STRATUS_TETRA_ISOSURFACE);
  }
  if ((unsigned)options->method > STRATUS_TETRA_METHOD_PROJECT) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "method %d of tetrahedra outside 0..%d", (int)options->method, STRATUS_TETRA_METHOD_PROJECT);
  }
  if (!(options->termination >= 0.0 && options->termination <= 1.0)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "termination %g outside 0..1", options->termination);
  }
  if (!(options->tolerance >= 0.0) || !isfinite(options->tolerance)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "tolerance %g, must be at least 0 and finite", options->tolerance);
  }
  return STRATUS_OK;
}

/* ---- rebuilding */

static bool same_mesh(const stratus_mesh* a, const stratus_mesh* b)
{
  return a->points == b->points && a->point_count == b->point_count && a->vertices == b->vertices && a->cell_count == b->cell_count &&
    a->float_points == b->float_points && memcmp(a->lattice, b->lattice, sizeof a->lattice) == 0 && a->values == b->values &&
    a->type == b->type && a->value_stride == b->value_stride && a->components == b->components && a->cell_values == b->cell_values &&
    a->hidden == b->hidden && a->revision == b->revision;
}

/* Takes other values of the same points and cells; neighbours, and the order of cells, stay. *taken false: it is another mesh, or other
 * cells show. */
static stratus_status update_values(stratus_tetra_caster* caster, const stratus_mesh* mesh, bool* taken)
{
  stratus_tetra_mesh* known = caster->mesh;
  const float low = known->low, high = known->high;
  const double bias = known->bias;
  *taken = false;
  if (!stratus_tetra_mesh_fits(known, mesh)) {
    return STRATUS_OK;
  }
  stratus_tetra_device_drop_values(caster->device);
  if (stratus_mesh_is_lattice(mesh)) {
    TRY(stratus_tetra_lattice_take_values(known, mesh, taken));
  } else {
    TRY(stratus_tetra_mesh_take_values(known, mesh, taken));
  }
  if (*taken) {
    stratus_tetra_light_drop(caster);
    if (caster->projector) {
      stratus_tetra_projector_take(caster->projector, mesh, known);
    }
    if (caster->view.type != mesh->type || low != known->low || high != known->high || bias != known->bias) {
      drop_table(caster); /* it spans the values */
    }
    caster->view = *mesh;
    ++caster->value_builds;
  }
  return STRATUS_OK;
}

/* *mixed: the mesh is a lattice whose cells turn both ways, and is to be listed; then nothing has changed. */
static stratus_status update_mesh(stratus_tetra_caster* caster, const stratus_mesh* mesh, bool* mixed, double* ms)
{
  stratus_tetra_mesh* made = NULL;
  bool taken = false;
  *mixed = false;
  if (caster->mesh && same_mesh(&caster->view, mesh)) {
    return STRATUS_OK;
  }
  const double start = stratus_now_ms();
  if (caster->mesh) {
    TRY(update_values(caster, mesh, &taken));
    if (taken) {
      *ms += stratus_now_ms() - start;
      return STRATUS_OK;
    }
  }
  if (stratus_mesh_is_lattice(mesh)) {
    TRY(stratus_tetra_lattice_create(caster->context, mesh, &made, mixed));
    if (*mixed) {
      caster->mixed = made->geometry;
      stratus_tetra_mesh_destroy(made);
      *ms += stratus_now_ms() - start;
      return STRATUS_OK;
    }
  } else {
    TRY(stratus_tetra_mesh_create(caster->context, mesh, &made));
  }
  drop_mesh(caster);
  caster->mesh = made;
  caster->view = *mesh;
  ++caster->mesh_builds;
  ++caster->value_builds;
  *ms += stratus_now_ms() - start;
  return STRATUS_OK;
}

/* Takes the list of a lattice's cells. *drawn: the list's mesh. */
static stratus_status update_list(stratus_tetra_caster* caster, const stratus_mesh* lattice, const stratus_mesh** drawn, double* ms)
{
  const double start = stratus_now_ms();
  stratus_tetra_list* list = caster->list;
  bool mixed = false;
  if (!list || !same_mesh(&list->source, lattice)) {
    TRY(stratus_tetra_list_create(caster->context, lattice, &list));
    *ms += stratus_now_ms() - start;
  }
  memcpy(list->mesh.matrix, lattice->matrix, sizeof lattice->matrix);
  const stratus_status status = update_mesh(caster, &list->mesh, &mixed, ms);
  if (list != caster->list) {
    stratus_tetra_list* outdated = status == STRATUS_OK ? caster->list : list;
    caster->list = status == STRATUS_OK ? list : caster->list;
    stratus_tetra_list_destroy(outdated);
  }
  *drawn = &list->mesh;
  return status;
}

/* Takes a mesh, or the list of a lattice that cannot be drawn as it is. *drawn: what the caster has taken. */
static stratus_status update(
  stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_tetra_options* options, const stratus_mesh** drawn, double* ms)
{
  bool listed = false;
  *drawn = mesh;
  if (stratus_mesh_is_lattice(mesh)) {
    const bool known = caster->list && same_mesh(&caster->list->source, mesh);
    listed = options->method == STRATUS_TETRA_METHOD_PROJECT ||
      (caster->mixed != 0 && (known || caster->mixed == stratus_tetra_hash(caster->context, mesh)));
  }
  if (!listed) {
    TRY(update_mesh(caster, mesh, &listed, ms));
  }
  if (listed) {
    return update_list(caster, mesh, drawn, ms);
  }
  stratus_tetra_list_destroy(caster->list);
  caster->list = NULL;
  caster->mixed = stratus_mesh_is_lattice(mesh) ? 0 : caster->mixed;
  return STRATUS_OK;
}

/* Updates the table. Composite: running sums per world unit. Other modes: colour and alpha over one unit distance, and sums where values
 * are added. */
static stratus_status update_table(
  stratus_tetra_caster* caster, const stratus_transfer* transfer, const stratus_tetra_options* options, double* ms)
{
  const stratus_tetra_mode mode = options->mode;
  static const double all[2] = { -(double)INFINITY, (double)INFINITY };
  const bool adds = mode == STRATUS_TETRA_AVERAGE || mode == STRATUS_TETRA_ADDITIVE;
  const double* range = mode == STRATUS_TETRA_AVERAGE ? options->average_range : all;
  const double start = stratus_now_ms();
  const stratus_tetra_mesh* mesh = caster->mesh;
  const bool any = mesh->low <= mesh->high;
  stratus_table* table = NULL;
  int32_t* sums = NULL;
  stratus_transfer* copy = NULL;
  if (caster->table && stratus_transfer_same_table(caster->transfer, transfer) && caster->mode == mode &&
    memcmp(caster->average_range, range, sizeof caster->average_range) == 0) {
    return STRATUS_OK;
  }
  TRY(stratus_transfer_copy(caster->context, transfer, 1, &copy));
  const stratus_volume view = stratus_mesh_values(&caster->view);
  const stratus_table_values values = { .fetching = { mesh->bias, stratus_type_is_wide(view.type), stratus_type_is_integer(view.type) },
    .lo = any ? mesh->low : 0.0f,
    .hi = any ? mesh->high : 0.0f,
    .uniform = true };
  stratus_status status = stratus_table_create_fine(caster->context, transfer, &values,
    mode == STRATUS_TETRA_COMPOSITE ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT,
    mode == STRATUS_TETRA_COMPOSITE ? 1.0 : transfer->unit_distance, ENTRIES, &table);
  if (status == STRATUS_OK) {
    status =
      adds ? stratus_tetra_value_sums(caster->context, table, mesh, range, &sums) : stratus_tetra_sums(caster->context, table, &sums);
  }
  if (status != STRATUS_OK) {
    stratus_table_destroy(table);
    stratus_release(caster->context, copy);
    return status;
  }
  drop_table(caster);
  caster->table = table;
  caster->march_sums = sums;
  caster->mode = mode;
  memcpy(caster->average_range, range, sizeof caster->average_range);
  caster->transfer = copy;
  ++caster->table_builds;
  *ms = stratus_now_ms() - start;
  return STRATUS_OK;
}

/* ---- drawing */

static stratus_tetra_device_source device_source(const stratus_tetra_caster* caster)
{
  return (stratus_tetra_device_source){ caster->mesh_builds, caster->value_builds, caster->table_builds, caster->view.cell_count,
    caster->view.point_count, caster->mesh->cell_ints, caster->mesh->value_count, caster->gradient_builds, caster->component_builds };
}

/* Marches on the device if there is one and it can, else on the host. */
static stratus_status march_rays(
  stratus_tetra_caster* caster, stratus_tetra_frame* frame, stratus_tetra_counts* counts, stratus_tetra_report* report)
{
  const stratus_tetra_device_source source = device_source(caster);
  bool drawn = false;
  if (caster->context->device) {
    const stratus_status status = stratus_tetra_march_device(
      caster->context, &caster->device, &source, frame, &caster->buffers, counts, &report->entries_ms, &report->march_ms, &drawn);
    if (!stratus_device_hands_back(caster->context, status)) {
      TRY(status);
    }
  }
  return drawn ? STRATUS_OK : stratus_tetra_march(caster->context, frame, &caster->buffers, counts, &report->entries_ms, &report->march_ms);
}

static stratus_status march(stratus_tetra_caster* caster, stratus_tetra_frame* frame, stratus_tetra_report* report)
{
  stratus_tetra_counts counts = { 0 };
  TRY(march_rays(caster, frame, &counts, report));
  report->rays = counts.rays;
  report->entries = counts.entries;
  report->segments = counts.segments;
  report->stuck = counts.stuck;
  return STRATUS_OK;
}

/* Draws tiles on the device if there is one and it can, else on the host. data: the caster. */
static stratus_status project_tiles(
  void* data, stratus_context* context, const stratus_tetra_projection* projection, stratus_tetra_project_counts* counts)
{
  stratus_tetra_caster* caster = data;
  const stratus_tetra_device_source source = device_source(caster);
  bool drawn = false;
  if (context->device) {
    const stratus_status status = stratus_tetra_project_device(context, &caster->device, &source, projection, counts, &drawn);
    if (!stratus_device_hands_back(context, status)) {
      TRY(status);
    }
  }
  return drawn ? STRATUS_OK : stratus_tetra_project_tiles(NULL, context, projection, counts);
}

static stratus_status project(stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_leaves* leaves,
  const stratus_tetra_frame* frame, stratus_tetra_report* report)
{
  const double start = stratus_now_ms();
  if (!caster->projector) {
    TRY(stratus_tetra_projector_create(caster->context, caster->mesh, &caster->projector));
    report->build_ms += stratus_now_ms() - start;
  }
  return stratus_tetra_project(caster->projector, mesh, frame, leaves, project_tiles, caster, report);
}

static stratus_status draw(stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_tetra_options* options, const stratus_image* image, stratus_tetra_report* report)
{
  stratus_tetra_frame frame;
  const double start = stratus_now_ms();
  const bool adds = options->mode == STRATUS_TETRA_AVERAGE || options->mode == STRATUS_TETRA_ADDITIVE; /* black where nothing shows */
  const bool shows = caster->components.count > 0 ? caster->components.shown : caster->table->shown > 0;
  if ((!shows && !adds && options->mode != STRATUS_TETRA_ISOSURFACE) || caster->mesh->face_count == 0) {
    report->method = options->method == STRATUS_TETRA_METHOD_PROJECT ? STRATUS_TETRA_METHOD_PROJECT : STRATUS_TETRA_METHOD_MARCH;
    snprintf(report->why, sizeof report->why, "nothing to draw: no cell, or none that shows");
    stratus_image_clear(image);
    return STRATUS_OK;
  }
  TRY(stratus_tetra_choose(caster, mesh, transfer, camera, options, image, report));
  const bool marches = report->method == STRATUS_TETRA_METHOD_MARCH;
  TRY(stratus_tetra_frame_prepare(caster->context, caster->mesh, mesh, camera, image, marches, &caster->buffers, &frame));
  frame.table = caster->table;
  frame.march_sums = caster->march_sums;
  stratus_tetra_frame_shade(&frame, options);
  stratus_tetra_frame_contours(&frame, caster->mesh, caster->transfer, options);
  stratus_tetra_frame_clip(&frame, mesh, options);
  stratus_tetra_frame_light(&frame, caster, mesh, transfer, options);
  stratus_tetra_frame_components(&frame, caster, options);
  report->transform_ms = stratus_now_ms() - start;
  return marches ? march(caster, &frame, report) : project(caster, mesh, options->leaves, &frame, report);
}

static void fill_report(const stratus_tetra_caster* caster, stratus_tetra_report* report)
{
  const stratus_tetra_mesh* mesh = caster->mesh;
  const stratus_tetra_buffers* b = &caster->buffers;
  report->cells = mesh->cell_count;
  report->shown_cells = mesh->shown_cells;
  report->blanked = mesh->blanked;
  report->repeated = mesh->repeated;
  report->border_faces = (int64_t)mesh->face_count;
  report->flat = mesh->flat;
  report->inverted = mesh->inverted;
  report->broken_faces = mesh->broken;
  report->folded_faces = mesh->folded;
  report->mesh_builds = caster->mesh_builds;
  report->value_builds = caster->value_builds;
  report->table_builds = caster->table_builds;
  report->gradient_builds = caster->gradient_builds;
  report->bytes += (caster->projector ? stratus_tetra_projector_bytes(caster->projector) : 0) + mesh->bytes + caster->gradients.bytes +
    b->points.bytes + b->places.bytes + b->faces.bytes + b->lines.bytes + b->ends.bytes + b->bin_begin.bytes + b->bins.bytes +
    b->first.bytes + b->entries.bytes;
}

stratus_status stratus_tetra_caster_render(stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_tetra_options* options, const stratus_image* image, stratus_tetra_report* report)
{
  const stratus_tetra_options defaults = stratus_tetra_options_default();
  stratus_tetra_report mine = { 0 };
  if (!caster) {
    return STRATUS_INVALID_ARGUMENT;
  }
  options = options ? options : &defaults;
  TRY(stratus_image_check(caster->context, image));
  TRY(check_options(caster->context, options));
  TRY(stratus_transfer_check(caster->context, transfer));
  TRY(stratus_camera_check(caster->context, camera, image));
  /* a mesh is checked only when it changes, so that a moved camera costs no pass over it */
  const stratus_mesh* known = caster->list ? &caster->list->source : &caster->view;
  if (!mesh || !caster->mesh || !same_mesh(known, mesh) || memcmp(caster->view.matrix, mesh->matrix, sizeof mesh->matrix) != 0) {
    TRY(stratus_mesh_check(caster->context, mesh));
  }
  const int64_t values = mesh->cell_values ? mesh->cell_count : mesh->point_count;
  if (!mesh->values && values > 0) {
    return stratus_fail(caster->context, STRATUS_INVALID_ARGUMENT, "mesh values is NULL, with %lld to be drawn", (long long)values);
  }
  const stratus_mesh* drawn = NULL;
  TRY(stratus_tetra_modes_check(caster->context, options, mesh));
  TRY(stratus_tetra_light_check(caster->context, transfer, options));
  TRY(stratus_tetra_components_check(caster->context, mesh, transfer, options));
  TRY(update(caster, mesh, options, &drawn, &mine.build_ms));
  memcpy(caster->view.matrix, mesh->matrix, sizeof mesh->matrix);
  TRY(update_table(caster, transfer, options, &mine.table_ms));
  TRY(stratus_tetra_light_update(caster, drawn, transfer, options, &mine.build_ms));
  TRY(stratus_tetra_components_update(caster, drawn, transfer, options, &mine.build_ms));
  TRY(draw(caster, drawn, transfer, camera, options, image, &mine));
  fill_report(caster, &mine);
  if (report) {
    *report = mine;
  }
  return STRATUS_OK;
}
