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

stratus_tetra_options stratus_tetra_options_default(void)
{
  return (stratus_tetra_options){ .tolerance = 0.001,
    .crop_regions = STRATUS_CROP_INSIDE,
    .average_range = { -(double)INFINITY, (double)INFINITY },
    .shading = stratus_shading_default() };
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
  stratus_tetra_look_drop(caster->context, &caster->look);
}

static void drop_mesh(stratus_tetra_caster* caster)
{
  drop_table(caster); /* the table spans the mesh's values */
  stratus_tetra_light_drop(caster);
  stratus_tetra_components_drop(caster);
  stratus_tetra_parts_drop(caster);
  stratus_tetra_device_destroy(caster->context, caster->device); /* the device may read the mesh in place */
  caster->device = NULL;
  stratus_tetra_projector_destroy(caster->projector);
  caster->projector = NULL;
  caster->buffers.placed = caster->buffers.binned = false;
  stratus_tetra_mesh_destroy(caster->mesh);
  caster->mesh = NULL;
}

void stratus_tetra_shadow_drop(stratus_tetra_caster* caster)
{
  stratus_light_state_drop(&caster->light);
  caster->lights = NULL;
  stratus_tetra_caster_destroy(caster->dark);
  caster->dark = NULL;
}

void stratus_tetra_caster_release(stratus_tetra_caster* caster)
{
  if (caster) {
    stratus_tetra_shadow_drop(caster);
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
  if ((unsigned)options->mode > STRATUS_TETRA_QUANTITIES) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "mode %d of tetrahedra outside 0..%d", (int)options->mode, STRATUS_TETRA_QUANTITIES);
  }
  if ((unsigned)options->normals > STRATUS_NORMALS_GRADIENT) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "normals %d outside 0..%d", (int)options->normals, STRATUS_NORMALS_GRADIENT);
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
    a->hidden == b->hidden && a->labels == b->labels && a->blocks == b->blocks && a->block_count == b->block_count &&
    a->revision == b->revision;
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
    known->identity = stratus_tetra_identity(mesh);
    caster->view = *mesh;
    ++caster->value_builds;
  }
  return STRATUS_OK;
}

static stratus_status update_mesh(stratus_tetra_caster* caster, const stratus_mesh* mesh, double* ms)
{
  stratus_tetra_mesh* made = NULL;
  bool taken = false;
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
    TRY(stratus_tetra_lattice_create(caster->context, mesh, &made));
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
  if (!list || !same_mesh(&list->source, lattice)) {
    TRY(stratus_tetra_list_create(caster->context, lattice, &list));
    *ms += stratus_now_ms() - start;
  }
  memcpy(list->mesh.matrix, lattice->matrix, sizeof lattice->matrix);
  const stratus_status status = update_mesh(caster, &list->mesh, ms);
  if (list != caster->list) {
    stratus_tetra_list* outdated = status == STRATUS_OK ? caster->list : list;
    caster->list = status == STRATUS_OK ? list : caster->list;
    stratus_tetra_list_destroy(outdated);
  }
  *drawn = &list->mesh;
  return status;
}

/* Update the caster to a mesh, or to the list of a lattice that is projected. *drawn: the mesh that the caster now has. */
static stratus_status update(
  stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_tetra_options* options, const stratus_mesh** drawn, double* ms)
{
  *drawn = mesh;
  if (stratus_mesh_is_lattice(mesh) && options->method == STRATUS_TETRA_METHOD_PROJECT) {
    return update_list(caster, mesh, drawn, ms);
  }
  TRY(update_mesh(caster, mesh, ms));
  stratus_tetra_list_destroy(caster->list);
  caster->list = NULL;
  return STRATUS_OK;
}

static stratus_status update_table(
  stratus_tetra_caster* caster, const stratus_transfer* transfer, const stratus_tetra_options* options, double* ms)
{
  const double start = stratus_now_ms();
  stratus_tetra_look made;
  TRY(stratus_tetra_look_update(caster, transfer, options, &made));
  if (made.table) {
    drop_table(caster);
    caster->look = made;
    ++caster->table_builds;
    *ms = stratus_now_ms() - start;
  }
  return STRATUS_OK;
}

/* ---- drawing */

static stratus_tetra_device_source device_source(const stratus_tetra_caster* caster)
{
  return (stratus_tetra_device_source){ caster->mesh_builds, caster->value_builds, caster->table_builds, caster->view.cell_count,
    caster->mesh->point_count, caster->mesh->cell_ints, caster->mesh->value_count, caster->gradient_builds, caster->component_builds };
}

/* Marches on the device if there is one and it can, else on the host. */
static stratus_status march_rays(
  stratus_tetra_caster* caster, stratus_tetra_frame* frame, stratus_tetra_counts* counts, stratus_tetra_report* report)
{
  const stratus_tetra_device_source source = device_source(caster);
  bool drawn = false;
  if (caster->context->device && !caster->on_host) {
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
  if (context->device && !caster->on_host) {
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

/* Whether the functions show any value. */
static bool shows_values(const stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_tetra_options* options)
{
  const bool several = stratus_tetra_mixes(mesh, options) || options->label_count > 0;
  return several ? caster->components.shown : caster->look.table->shown > 0;
}

/* Whether no crop region shows. */
static bool crops_all(const stratus_tetra_options* options)
{
  return stratus_tetra_modes_regions(options) && options->crop_regions == 0;
}

static stratus_status draw_one(stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_tetra_options* options, const stratus_image* image, stratus_tetra_report* report)
{
  stratus_tetra_frame frame;
  const double start = stratus_now_ms();
  const bool adds = options->mode == STRATUS_TETRA_AVERAGE || options->mode == STRATUS_TETRA_ADDITIVE; /* black where nothing shows */
  const bool shows = shows_values(caster, mesh, options);
  const bool needs = !adds && options->mode != STRATUS_TETRA_ISOSURFACE && options->mode != STRATUS_TETRA_QUANTITIES;
  if ((!shows && needs) || caster->mesh->face_count == 0 || crops_all(options)) {
    report->method = options->method == STRATUS_TETRA_METHOD_PROJECT ? STRATUS_TETRA_METHOD_PROJECT : STRATUS_TETRA_METHOD_MARCH;
    snprintf(report->why, sizeof report->why, "nothing to draw: no cell, or none that shows");
    stratus_image_clear(image);
    return STRATUS_OK;
  }
  TRY(stratus_tetra_choose(caster, mesh, transfer, camera, options, image, report));
  const bool marches = report->method == STRATUS_TETRA_METHOD_MARCH, hits = options->mode == STRATUS_TETRA_FIRST_HIT;
  stratus_image marched = *image;
  if (hits) { /* rays store cells in place of colours */
    marched.depth = NULL;
    marched.rgba8 = NULL;
  }
  TRY(stratus_tetra_frame_prepare(caster->context, caster->mesh, mesh, camera, &marched, marches, &caster->buffers, &frame));
  frame.table = caster->look.table;
  frame.march_sums = caster->look.sums;
  stratus_tetra_frame_shade(&frame, caster, options);
  stratus_tetra_frame_slice(&frame, options);
  stratus_tetra_frame_contours(&frame, caster, mesh, options);
  stratus_tetra_frame_clip(&frame, mesh, options);
  stratus_tetra_frame_light(&frame, caster, mesh, transfer, options);
  stratus_tetra_frame_components(&frame, caster, mesh, options);
  frame.arguments.layers = caster->layers;
  frame.arguments.layer_depth = caster->layers > 0 ? (frame.arguments.end - frame.arguments.begin) / (float)caster->layers : 0.0f;
  report->transform_ms = stratus_now_ms() - start;
  TRY(marches ? march(caster, &frame, report) : project(caster, mesh, options->leaves, &frame, report));
  if (hits) {
    stratus_tetra_hits_shade(&frame, caster, mesh, transfer, options, image);
  }
  return STRATUS_OK;
}

/* transfer: the component's. */
static stratus_status draw_component(stratus_tetra_caster* caster, int component, const stratus_mesh* mesh,
  const stratus_transfer* transfer, const stratus_camera* camera, const stratus_tetra_options* options, const stratus_image* image,
  stratus_tetra_report* report, double* bias)
{
  stratus_tetra_part* other = component > 0 ? caster->parts + component - 1 : NULL;
  if (other) {
    stratus_tetra_part_swap(caster, other);
  }
  const stratus_status status = draw_one(caster, mesh, transfer, camera, options, image, report);
  *bias = caster->mesh->bias;
  if (other) {
    stratus_tetra_part_swap(caster, other);
  }
  return status;
}

/* In the report, counts and times are sums; the method is the same for all parts. */
static void add_report(stratus_tetra_report* sum, const stratus_tetra_report* part)
{
  sum->method = part->method;
  memcpy(sum->why, part->why, sizeof sum->why);
  sum->rays += part->rays;
  sum->entries += part->entries;
  sum->segments += part->segments;
  sum->stuck += part->stuck;
  sum->transform_ms += part->transform_ms;
  sum->entries_ms += part->entries_ms;
  sum->march_ms += part->march_ms;
}

/* Draws each component by itself and adds the pictures. */
static stratus_status draw_parts(stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_transfer* transfers,
  const stratus_camera* camera, const stratus_tetra_options* options, const stratus_image* image, stratus_tetra_report* report)
{
  const bool opaque = options->mode == STRATUS_TETRA_AVERAGE || options->mode == STRATUS_TETRA_ADDITIVE;
  stratus_image part;
  stratus_status status = STRATUS_OK;
  TRY(stratus_image_part_create(caster->context, image, &part));
  stratus_image_clear(image);
  for (int c = 0; c < mesh->components; ++c) {
    stratus_tetra_report mine = { 0 };
    double bias;
    TRY_CLEANUP(draw_component(caster, c, mesh, transfers + c, camera, options, &part, &mine, &bias));
    stratus_image_add(image, &part, (float)transfers[c].weight, opaque);
    add_report(report, &mine);
  }
  stratus_image_fill_bytes(image);
cleanup:
  stratus_image_part_destroy(caster->context, &part);
  return status;
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

/* Check the input and update the caster to it: mesh, list and table. *drawn: the mesh that the caster now has. */
static stratus_status take(stratus_tetra_caster* caster, const stratus_tetra_subject* of, const stratus_camera* camera,
  const stratus_image* image, const stratus_mesh** drawn, stratus_tetra_report* report)
{
  const stratus_mesh* mesh = of->mesh;
  TRY(stratus_image_check(caster->context, image));
  TRY(check_options(caster->context, of->options));
  TRY(stratus_transfer_check(caster->context, of->transfer));
  TRY(stratus_camera_check(caster->context, camera, image));
  /* a mesh is checked only when it changes, so that a moved camera costs no pass over it */
  const stratus_mesh* known = caster->list ? &caster->list->source : &caster->view;
  if (!mesh || !caster->mesh || !same_mesh(known, mesh) || memcmp(caster->view.matrix, mesh->matrix, sizeof mesh->matrix) != 0) {
    TRY(stratus_mesh_check(caster->context, mesh));
  }
  const int64_t values = mesh->cell_values ? mesh->cell_count : mesh->point_count;
  if (!(mesh->block_count > 0 ? mesh->blocks->values : mesh->values) && values > 0) {
    return stratus_fail(caster->context, STRATUS_INVALID_ARGUMENT, "mesh values is NULL, with %lld to be drawn", (long long)values);
  }
  TRY(stratus_tetra_modes_check(caster->context, of->options, mesh));
  TRY(stratus_tetra_labels_check(caster->context, mesh, of->transfer, of->options));
  TRY(stratus_tetra_light_check(caster->context, mesh, of->transfer, of->options));
  TRY(stratus_tetra_components_check(caster->context, mesh, of->transfer, of->options));
  TRY(update(caster, mesh, of->options, drawn, &report->build_ms));
  memcpy(caster->view.matrix, mesh->matrix, sizeof mesh->matrix);
  TRY(update_table(caster, of->transfer, of->options, &report->table_ms));
  TRY(stratus_tetra_light_update(caster, *drawn, of->transfer, of->options, &report->build_ms));
  TRY(stratus_tetra_components_update(caster, *drawn, of->transfer, of->options, &report->build_ms));
  return stratus_tetra_parts_update(caster, *drawn, of->transfer, of->options, &report->build_ms);
}

stratus_status stratus_tetra_caster_prepare(stratus_tetra_caster* caster, const stratus_tetra_subject* of, const stratus_camera* camera,
  const stratus_image* image, stratus_tetra_frame* frame, bool* shows, stratus_tetra_report* report)
{
  const stratus_mesh* drawn = NULL;
  TRY(take(caster, of, camera, image, &drawn, report));
  *shows = shows_values(caster, drawn, of->options) && caster->mesh->face_count > 0 && !crops_all(of->options);
  if (*shows) {
    TRY(stratus_tetra_frame_prepare(caster->context, caster->mesh, drawn, camera, image, true, &caster->buffers, frame));
    frame->table = caster->look.table;
    frame->march_sums = caster->look.sums;
    stratus_tetra_frame_shade(frame, caster, of->options);
    stratus_tetra_frame_clip(frame, drawn, of->options);
    stratus_tetra_frame_light(frame, caster, drawn, of->transfer, of->options);
    stratus_tetra_frame_components(frame, caster, drawn, of->options);
    frame->arguments.mode = TETRA_STRETCHES;
  }
  fill_report(caster, report);
  return STRATUS_OK;
}

stratus_status stratus_tetra_caster_enter(stratus_tetra_caster* caster, stratus_tetra_frame* frame, const char** why_not)
{
  const stratus_tetra_device_source source = device_source(caster);
  return stratus_tetra_device_enter(caster->context, &caster->device, &source, frame, &caster->buffers, why_not);
}

stratus_status stratus_tetra_light_caster(stratus_tetra_caster* caster, stratus_tetra_caster** dark)
{
  if (!caster->dark) {
    TRY(stratus_tetra_caster_create(caster->context, &caster->dark));
  }
  *dark = caster->dark;
  (*dark)->on_host = true;
  return STRATUS_OK;
}

/* Builds the maps of light of a picture of this one mesh where they are stale. */
static stratus_status update_shadows(
  stratus_tetra_caster* caster, const stratus_tetra_subject* of, const stratus_camera* camera, stratus_tetra_report* report)
{
  const double start = stratus_now_ms();
  stratus_tetra_caster* dark;
  if (!stratus_tetra_has_shadows(of->mesh, of->options)) {
    stratus_tetra_shadow_drop(caster);
    return STRATUS_OK;
  }
  TRY(stratus_tetra_light_caster(caster, &dark));
  TRY(stratus_tetra_shadow_update(caster, of, camera, stratus_tetra_caster_render));
  report->light_ms = stratus_now_ms() - start;
  report->light_builds = caster->light.builds;
  report->light_bytes = stratus_light_maps_bytes(caster->lights);
  report->light_error = stratus_light_maps_error(caster->lights);
  return STRATUS_OK;
}

stratus_status stratus_tetra_caster_render(stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_tetra_options* options, const stratus_image* image, stratus_tetra_report* report)
{
  const stratus_tetra_options defaults = stratus_tetra_options_default();
  stratus_tetra_report mine = { 0 };
  const stratus_mesh* drawn = NULL;
  if (!caster) {
    return STRATUS_INVALID_ARGUMENT;
  }
  options = options ? options : &defaults;
  if (options->mode == STRATUS_TETRA_QUANTITIES) {
    return stratus_fail(
      caster->context, STRATUS_INVALID_ARGUMENT, "mode quantities gives no picture: use stratus_ray_caster_render_quantities()");
  }
  const stratus_tetra_subject of = { mesh, transfer, options };
  TRY(take(caster, &of, camera, image, &drawn, &mine));
  TRY(update_shadows(caster, &of, camera, &mine));
  if (stratus_tetra_draws_last(drawn, options)) {
    double bias;
    TRY(draw_component(caster, drawn->components - 1, drawn, transfer, camera, options, image, &mine, &bias));
  } else {
    TRY((stratus_tetra_draws_parts(drawn, options) ? draw_parts : draw_one)(caster, drawn, transfer, camera, options, image, &mine));
  }
  fill_report(caster, &mine);
  if (report) {
    *report = mine;
  }
  return STRATUS_OK;
}

stratus_status stratus_tetra_caster_render_kept(stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_transfer* transfer,
  int component, int keeps, const stratus_camera* camera, const stratus_tetra_options* options, const stratus_image* image, double* bias,
  stratus_tetra_report* report)
{
  stratus_tetra_options marched = options ? *options : stratus_tetra_options_default();
  const stratus_mesh* drawn = NULL;
  marched.method = STRATUS_TETRA_METHOD_MARCH;
  const stratus_tetra_subject of = { mesh, transfer, &marched };
  TRY(take(caster, &of, camera, image, &drawn, report));
  caster->keeps = keeps;
  const int of_values = stratus_tetra_draws_last(drawn, &marched) ? drawn->components - 1 : component;
  const stratus_status status = draw_component(caster, of_values, drawn, transfer + component, camera, &marched, image, report, bias);
  caster->keeps = 0;
  fill_report(caster, report);
  return status;
}
