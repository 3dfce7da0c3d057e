/* SPDX-License-Identifier: BSD-3-Clause
 * Numbers of each pixel's ray. The numbers of the field come from a picture in mode quantities, the transmittance is what a composite
 * picture lets pass, and the depth of a threshold is sought by composite pictures whose rays end at other depths. So every grid, feature
 * and device that draws pictures gives numbers, too. */
#include "stratus/quantities.h"

#include "camera.h"
#include "matrix.h"
#include "picture.h"
#include "ray_caster.h"
#include "ray_several_picture.h"
#include "tetra_cells.h"
#include "vector.h"

#include <math.h>
#include <string.h>

/* How near the threshold the transmittance at its depth is, and after how many pictures the depth is as near as floats allow. */
#define THRESHOLD_ERROR 1e-4
#define SEARCHES_MOST 40
/* The nearest depth of a search where the eye is inside the data, by the farthest. */
#define NEAREST 1e-3

const char* stratus_quantity_name(stratus_quantity quantity)
{
  static const char* const names[] = { "integral", "length", "mean", "maximum", "maximum_depth", "cells", "transmittance",
    "transmittance_depth" };
  return (unsigned)quantity < sizeof names / sizeof *names ? names[quantity] : "unknown";
}

stratus_quantities stratus_quantities_default(void)
{
  return (stratus_quantities){ .threshold = 0.5 };
}

/* The picture draws this in place of an input: the options are its own, and a view shows one component. */
typedef struct own_input {
  stratus_ray_cast_options options;
  stratus_tetra_options tetra_options;
  stratus_volume volume;
  stratus_mesh mesh, *blocks; /* blocks: of the mesh; NULL: it has none */
} own_input;

typedef struct quantities {
  stratus_context* context;
  const stratus_ray_cast_input* inputs;
  int count;
  const stratus_camera* camera;
  const stratus_quantities* wanted;
  stratus_image image;
  stratus_ray_cast_input* drawn;
  own_input* own; /* of each that is drawn */
} quantities;

static bool is_measured(const stratus_quantities* wanted)
{
  static const double nothing[9];
  return memcmp(wanted->measure, nothing, sizeof nothing) != 0;
}

static stratus_status check(const quantities* q)
{
  const stratus_quantities* w = q->wanted;
  if (!(w->threshold > 0.0 && w->threshold < 1.0)) {
    return stratus_fail(
      q->context, STRATUS_INVALID_ARGUMENT, "threshold %g of the transmittance, must be above 0 and below 1", w->threshold);
  }
  double cross[3];
  stratus_vector_cross(w->measure + 3, w->measure + 6, cross);
  const double determinant = stratus_vector_dot(w->measure, cross);
  if (is_measured(w) && (!isfinite(determinant) || determinant == 0.0)) {
    return stratus_fail(q->context, STRATUS_INVALID_ARGUMENT, "measure has the determinant %g, must be finite and not 0", determinant);
  }
  if (q->count < 1 || (!w->blocks && q->count > STRATUS_SEVERAL_MAX)) {
    return stratus_fail(q->context, STRATUS_INVALID_ARGUMENT, "%d inputs, must be 1%s", q->count, w->blocks ? " or more" : "..8");
  }
  for (int n = 0; n < q->count; ++n) {
    const stratus_ray_cast_input* in = &q->inputs[n];
    if (!stratus_several_context(in)) {
      return stratus_fail(q->context, STRATUS_INVALID_ARGUMENT, "input %d has no caster: caster is NULL, and so is tetra", n);
    }
    if (in->tetra ? !in->mesh : !in->volume) {
      return stratus_fail(q->context, STRATUS_INVALID_ARGUMENT, "%s of input %d is NULL", in->tetra ? "mesh" : "volume", n);
    }
    if (!in->tetra) { /* drawing checks a mesh */
      TRY(stratus_volume_check(q->context, in->volume));
    }
    const int components = in->tetra ? stratus_tetra_component_count(in->mesh) : stratus_volume_components(in->volume);
    if (w->component < 0 || w->component >= components) {
      return stratus_fail(q->context, STRATUS_INVALID_ARGUMENT, "component %d of input %d, must be 0..%d", w->component, n, components - 1);
    }
  }
  return STRATUS_OK;
}

static stratus_status allocate(quantities* q)
{
  const size_t n = (size_t)q->count, pixels = (size_t)q->wanted->width * (size_t)q->wanted->height;
  void* memory = NULL;
  TRY(stratus_allocate_zero(q->context, n, sizeof *q->drawn, &memory));
  q->drawn = memory;
  TRY(stratus_allocate_zero(q->context, n, sizeof *q->own, &memory));
  q->own = memory;
  for (int i = 0; i < q->count; ++i) {
    if (q->inputs[i].tetra && q->inputs[i].mesh->block_count > 0) {
      TRY(stratus_allocate(q->context, (size_t)q->inputs[i].mesh->block_count, sizeof(stratus_mesh), &memory));
      q->own[i].blocks = memory;
    }
  }
  TRY(stratus_allocate(q->context, pixels, 4 * sizeof(float), &memory));
  q->image.rgba = memory;
  TRY(stratus_allocate(q->context, pixels, sizeof(float), &memory));
  q->image.depth = memory;
  return STRATUS_OK;
}

static void release(quantities* q)
{
  stratus_release(q->context, q->drawn);
  for (int n = 0; q->own && n < q->count; ++n) {
    stratus_release(q->context, q->own[n].blocks);
  }
  stratus_release(q->context, q->own);
  stratus_release(q->context, q->image.rgba);
  stratus_release(q->context, q->image.depth);
}

static stratus_mesh component_of(const stratus_mesh* mesh, int component)
{
  stratus_mesh view = *mesh;
  view.values = mesh->values ? (const char*)mesh->values + (size_t)component * stratus_type_size(mesh->type) : NULL;
  view.components = 1;
  return view;
}

static void set_mesh(own_input* own, const stratus_mesh* mesh, int component)
{
  own->mesh = component_of(mesh, component);
  for (int b = 0; b < mesh->block_count; ++b) {
    own->blocks[b] = component_of(&mesh->blocks[b], component);
  }
  own->mesh.blocks = own->blocks;
}

/* Numbers of the field do not depend on a function: with one of their own, a change of the picture's rebuilds nothing of theirs. */
static const double any_opacity[2] = { 0.0, 1.0 }, any_color[4] = { 0.0, 1.0, 1.0, 1.0 };
static const stratus_transfer any_function = {
  .opacity = any_opacity, .opacity_count = 1, .color = any_color, .color_count = 1, .unit_distance = 1.0, .clamp = 1, .weight = 1.0
};

/* Makes the inputs of pictures: of the component's numbers, or of light that no ray loses by ending early. */
static void set_inputs(quantities* q, bool numbers)
{
  for (int n = 0; n < q->count; ++n) {
    const stratus_ray_cast_input* in = &q->inputs[n];
    stratus_ray_cast_input* drawn = &q->drawn[n];
    own_input* own = &q->own[n];
    *drawn = *in;
    drawn->transfer = numbers ? &any_function : in->transfer;
    if (in->tetra) {
      stratus_tetra_options* options = &own->tetra_options;
      *options = in->tetra_options ? *in->tetra_options : stratus_tetra_options_default();
      options->mode = numbers ? STRATUS_TETRA_QUANTITIES : STRATUS_TETRA_COMPOSITE;
      options->termination = 1.0;
      options->shade = 0;
      options->materials = NULL;
      drawn->tetra_options = options;
      if (numbers) {
        options->label_count = 0; /* labels hide nothing */
        set_mesh(own, in->mesh, q->wanted->component);
        drawn->mesh = &own->mesh;
      }
      continue;
    }
    stratus_ray_cast_options* options = &own->options;
    *options = in->options ? *in->options : stratus_ray_cast_options_default();
    options->mode = numbers ? STRATUS_MODE_QUANTITIES : STRATUS_MODE_COMPOSITE;
    options->sampling.termination = 1.0;
    options->skipping.audit = 0;
    options->light.shade = 0;
    options->light.materials = NULL;
    if (numbers) {
      own->volume = stratus_volume_component(in->volume, q->wanted->component);
      drawn->volume = &own->volume;
      options->optics.dependent = 0;
      options->optics.transfer_2d = NULL;
      if (options->mask.label_count > 0) { /* labels hide nothing */
        options->mask.bytes = NULL;
        options->mask.label_count = 0;
      }
    }
    drawn->options = options;
  }
}

static stratus_status draw(const quantities* q, const stratus_camera* camera)
{
  const stratus_ray_cast_input* first = q->drawn;
  if (q->count == 1 && first->tetra &&
    first->tetra_options->mode == STRATUS_TETRA_COMPOSITE) { /* components, gradient opacity and projection, too */
    return stratus_tetra_caster_render(first->tetra, first->mesh, first->transfer, camera, first->tetra_options, &q->image, NULL);
  }
  return (q->wanted->blocks ? stratus_ray_caster_render_blocks : stratus_ray_caster_render_several)(
    q->drawn, q->count, camera, &q->image, NULL);
}

/* ---- numbers of the field */

static void store_numbers(const quantities* q)
{
  const stratus_quantities* w = q->wanted;
  const int64_t pixels = (int64_t)w->width * w->height;
#pragma omp parallel for num_threads(q->context->threads)
  for (int64_t i = 0; i < pixels; ++i) {
    const float* numbers = q->image.rgba + 4 * i;
    const bool any = numbers[3] > 0.0f;
    const float of[] = { numbers[1], numbers[2], any ? (float)((double)numbers[1] / (double)numbers[2]) : NAN, any ? numbers[0] : NAN,
      any ? q->image.depth[i] : NAN, numbers[3] };
    for (int quantity = STRATUS_QUANTITY_INTEGRAL; quantity <= STRATUS_QUANTITY_CELLS; ++quantity) {
      if (w->of[quantity]) {
        w->of[quantity][i] = of[quantity];
      }
    }
  }
}

/* ---- depth of a threshold */

/* Widens lo..hi by a place's distance along the camera's forward. */
static void reach(const stratus_camera* camera, const double place[3], double* lo, double* hi)
{
  double across[3];
  const double from_eye[3] = { place[0] - camera->eye[0], place[1] - camera->eye[1], place[2] - camera->eye[2] };
  stratus_vector_cross(camera->right, camera->up, across);
  const double k = stratus_vector_dot(from_eye, across) / stratus_vector_dot(camera->forward, across);
  *lo = fmin(*lo, k);
  *hi = fmax(*hi, k);
}

/* The same by a box's corners, in coordinates that the matrix takes to the world. */
static void reach_box(
  const stratus_camera* camera, const double low[3], const double high[3], const double to_world[16], double* lo, double* hi)
{
  for (int corner = 0; corner < 8; ++corner) {
    double local[3], place[3];
    for (int axis = 0; axis < 3; ++axis) {
      local[axis] = (corner >> axis & 1) ? high[axis] : low[axis];
    }
    stratus_matrix_point(to_world, local, place);
    reach(camera, place, lo, hi);
  }
}

static void reach_volume(const stratus_camera* camera, const stratus_volume* volume, double* lo, double* hi)
{
  double to_world[16], low[3], high[3];
  for (int axis = 0; axis < 3; ++axis) { /* cells reach half a voxel beyond their middles */
    low[axis] = -0.5;
    high[axis] = (double)volume->dimensions[axis] - 0.5;
  }
  stratus_volume_index_to_world(volume, to_world);
  reach_box(camera, low, high, to_world, lo, hi);
}

/* The camera of a search: opaque depth 0 is in front of all inputs, 1 is behind them. Returns false where all are behind the eye. */
static bool find_camera(const quantities* q, stratus_camera* camera)
{
  double lo = INFINITY, hi = -INFINITY;
  for (int n = 0; n < q->count; ++n) {
    const stratus_ray_cast_input* in = &q->inputs[n];
    if (in->tetra) {
      double low[3], high[3];
      if (stratus_tetra_box(in->mesh, low, high)) {
        reach_box(q->camera, low, high, in->mesh->matrix, &lo, &hi);
      }
    } else {
      reach_volume(q->camera, in->volume, &lo, &hi);
    }
  }
  const double margin = 1e-6 * (hi - lo);
  *camera = *q->camera;
  camera->far_k = fmin(camera->far_k, hi + margin);
  camera->near_k = fmax(camera->near_k, camera->parallel ? lo - margin : fmax(lo - margin, NEAREST * camera->far_k));
  return camera->near_k < camera->far_k;
}

/* The window depth of a place in units of forward, as stratus_camera_place() takes it. */
static double depth_of(const stratus_camera* c, double k)
{
  const double part = (k - c->near_k) / (c->far_k - c->near_k);
  return fmin(fmax(c->parallel ? part : part * c->far_k / k, 0.0), 1.0);
}

/* A ray's search: the transmittance is above the threshold at `lo` and not at `hi`, in units of forward. Excesses are the logarithms of
 * transmittance by threshold. */
typedef struct search {
  float lo, hi, lo_excess, hi_excess;
} search;

/* A ray's next depth. The transmittance's logarithm is nearly linear in smooth media, which the false position uses; where it is not,
 * halving is safe. */
static double next_place(const search* s, int round)
{
  const double lo = (double)s->lo, hi = (double)s->hi, rise = (double)s->lo_excess - (double)s->hi_excess;
  double part = round % 3 == 2 || !isfinite(rise) ? 0.5 : (double)s->lo_excess / rise;
  part = fmin(fmax(part, 0.02), 0.98);
  return lo + part * (hi - lo);
}

static float excess(const quantities* q, int64_t pixel)
{
  const double passes = 1.0 - (double)q->image.rgba[4 * pixel + 3];
  return passes > 0.0 ? (float)(log(passes) - log(q->wanted->threshold)) : -INFINITY;
}

/* Sets where each ray ends in the next picture: at its next depth, or at once where the search is over. Returns whether any goes on. */
static bool set_ends(const quantities* q, const stratus_camera* camera, const search* searches, float* ends, int round)
{
  const int64_t pixels = (int64_t)q->wanted->width * q->wanted->height;
  bool any = false;
#pragma omp parallel for num_threads(q->context->threads) reduction(|| : any)
  for (int64_t i = 0; i < pixels; ++i) {
    const search* s = &searches[i];
    ends[i] = s->lo < s->hi ? (float)depth_of(camera, next_place(s, round)) : 0.0f;
    any = any || s->lo < s->hi;
  }
  return any;
}

static void narrow(const quantities* q, const stratus_camera* camera, search* searches, const float* ends)
{
  const int64_t pixels = (int64_t)q->wanted->width * q->wanted->height;
#pragma omp parallel for num_threads(q->context->threads)
  for (int64_t i = 0; i < pixels; ++i) {
    search* s = &searches[i];
    if (!(s->lo < s->hi)) {
      continue;
    }
    const float at = fminf(fmaxf((float)stratus_camera_place(camera, (double)ends[i]), s->lo), s->hi), above = excess(q, i);
    const bool found = fabs(exp((double)above) - 1.0) * q->wanted->threshold <= THRESHOLD_ERROR;
    const bool stuck = at <= s->lo || at >= s->hi; /* floats know no depth between them */
    if (found || stuck) {
      s->lo = s->hi = found ? at : s->hi;
    } else if (above > 0.0f) {
      s->lo = at;
      s->lo_excess = above;
    } else {
      s->hi = at;
      s->hi_excess = above;
    }
  }
}

/* Starts the searches from the whole picture: of rays that lose enough light in front of opaque geometry. */
static void start(const quantities* q, const stratus_camera* camera, search* searches)
{
  const int64_t pixels = (int64_t)q->wanted->width * q->wanted->height;
#pragma omp parallel for num_threads(q->context->threads)
  for (int64_t i = 0; i < pixels; ++i) {
    const float above = excess(q, i);
    double far_k = camera->far_k;
    if (q->wanted->opaque_depth) {
      far_k = fmin(far_k, stratus_camera_place(q->camera, (double)q->wanted->opaque_depth[i]));
    }
    searches[i] =
      (search){ .lo = (float)camera->near_k, .hi = (float)far_k, .lo_excess = (float)-log(q->wanted->threshold), .hi_excess = above };
    if (above > 0.0f || !(searches[i].lo < searches[i].hi)) {
      searches[i].lo = searches[i].hi = NAN;
    }
  }
}

/* The world's length of a unit of forward on a pixel's ray. */
static double unit_of(const quantities* q, int64_t pixel)
{
  const int sides[2] = { q->wanted->width, q->wanted->height };
  double from[3], along[3];
  stratus_camera_ray(q->camera, sides, (int)(pixel % sides[0]), (int)(pixel / sides[0]), from, along);
  return sqrt(stratus_vector_dot(along, along));
}

/* Finds the depths of the threshold, after the whole picture was drawn. */
static stratus_status find_depths(quantities* q)
{
  const int64_t pixels = (int64_t)q->wanted->width * q->wanted->height;
  float* depths = q->wanted->of[STRATUS_QUANTITY_TRANSMITTANCE_DEPTH];
  stratus_camera camera;
  void *searches = NULL, *ends = NULL;
  stratus_status status = STRATUS_OK;
  if (!find_camera(q, &camera)) {
    for (int64_t i = 0; i < pixels; ++i) {
      depths[i] = NAN;
    }
    return STRATUS_OK;
  }
  TRY_CLEANUP(stratus_allocate(q->context, (size_t)pixels, sizeof(search), &searches));
  TRY_CLEANUP(stratus_allocate(q->context, (size_t)pixels, sizeof(float), &ends));
  start(q, &camera, searches);
  q->image.opaque_depth = ends;
  for (int round = 0; round < SEARCHES_MOST && set_ends(q, &camera, searches, ends, round); ++round) {
    TRY_CLEANUP(draw(q, &camera));
    narrow(q, &camera, searches, ends);
  }
  for (int64_t i = 0; i < pixels; ++i) {
    depths[i] = (float)((double)((const search*)searches)[i].hi * unit_of(q, i));
  }
cleanup:
  stratus_release(q->context, searches);
  stratus_release(q->context, ends);
  return status;
}

/* ---- lengths */

/* Takes lengths and depths from the world to the coordinates of `measure`. The map is linear, so a ray has one factor. */
static void measure(const quantities* q)
{
  static const stratus_quantity lengths[] = { STRATUS_QUANTITY_INTEGRAL, STRATUS_QUANTITY_LENGTH, STRATUS_QUANTITY_MAXIMUM_DEPTH,
    STRATUS_QUANTITY_TRANSMITTANCE_DEPTH };
  const stratus_quantities* w = q->wanted;
  const int sides[2] = { w->width, w->height };
  const int64_t pixels = (int64_t)w->width * w->height;
  if (!is_measured(w)) {
    return;
  }
  for (int64_t i = 0; i < pixels; ++i) {
    double from[3], along[3], measured[3];
    stratus_camera_ray(q->camera, sides, (int)(i % sides[0]), (int)(i / sides[0]), from, along);
    for (int axis = 0; axis < 3; ++axis) {
      measured[axis] = stratus_vector_dot(w->measure + 3 * axis, along);
    }
    const double factor = sqrt(stratus_vector_dot(measured, measured) / stratus_vector_dot(along, along));
    for (size_t n = 0; n < sizeof lengths / sizeof *lengths; ++n) {
      if (w->of[lengths[n]]) {
        w->of[lengths[n]][i] = (float)((double)w->of[lengths[n]][i] * factor);
      }
    }
  }
}

/* ---- all */

static stratus_status compute(quantities* q)
{
  const stratus_quantities* w = q->wanted;
  bool numbers = false;
  for (int quantity = STRATUS_QUANTITY_INTEGRAL; quantity <= STRATUS_QUANTITY_CELLS; ++quantity) {
    numbers = numbers || w->of[quantity];
  }
  if (numbers) {
    set_inputs(q, true);
    TRY(draw(q, q->camera));
    store_numbers(q);
  }
  if (!w->of[STRATUS_QUANTITY_TRANSMITTANCE] && !w->of[STRATUS_QUANTITY_TRANSMITTANCE_DEPTH]) {
    return STRATUS_OK;
  }
  set_inputs(q, false);
  TRY(draw(q, q->camera));
  const int64_t pixels = (int64_t)w->width * w->height;
  for (int64_t i = 0; w->of[STRATUS_QUANTITY_TRANSMITTANCE] && i < pixels; ++i) {
    w->of[STRATUS_QUANTITY_TRANSMITTANCE][i] = 1.0f - q->image.rgba[4 * i + 3];
  }
  return w->of[STRATUS_QUANTITY_TRANSMITTANCE_DEPTH] ? find_depths(q) : STRATUS_OK;
}

stratus_status stratus_ray_caster_render_quantities(
  const stratus_ray_cast_input* inputs, int count, const stratus_camera* camera, const stratus_quantities* wanted)
{
  if (!inputs || !stratus_several_context(inputs)) {
    return STRATUS_INVALID_ARGUMENT;
  }
  quantities q = { .context = stratus_several_context(inputs), .inputs = inputs, .count = count, .camera = camera, .wanted = wanted };
  float pixel[4];
  if (!wanted) {
    return stratus_fail(q.context, STRATUS_INVALID_ARGUMENT, "quantities is NULL");
  }
  q.image = (stratus_image){ .width = wanted->width, .height = wanted->height, .rgba = pixel, .opaque_depth = wanted->opaque_depth };
  TRY(stratus_image_check(q.context, &q.image));
  TRY(stratus_camera_check(q.context, camera, &q.image));
  TRY(check(&q));
  q.image.rgba = NULL;
  stratus_status status = allocate(&q);
  if (status == STRATUS_OK) {
    status = compute(&q);
  }
  if (status == STRATUS_OK) {
    measure(&q);
  }
  release(&q);
  return status;
}
