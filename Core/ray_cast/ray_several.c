/* SPDX-License-Identifier: BSD-3-Clause
 * Draws several volumes in one march: each caster keeps tables, structure and choice of its own volume, and all share the lattice. */
#include "ray_caster.h"

#include "camera.h"
#include "instruction_set.h"
#include "matrix.h"
#include "device.h"
#include "picture.h"
#include "ray_cast_rest.h"
#include "ray_device_buffers.h"
#include "ray_fetched.h"
#include "ray_frame.h"
#include "ray_probe.h"
#include "ray_several_host.h"
#include "ray_shading_render.h"
#include "table_fill.h"
#include "tetra_caster.h"
#include "tiles.h"

#include <stdio.h>
#include <string.h>

/* Places along a ray are numbered by ints: so many segments may lie between the volumes. */
#define SEGMENTS_MOST 1e9
/* Most segments to a sample. */
#define STRIDE_MOST 65536.0
/* How finely the shortest step may be divided, what a layer of light costs in samples, and what a finer lattice must cost at most. */
#define PARTS_MOST 4
#define EVENT_COST 0.3
#define GAIN 0.95

/* Segments of the lattice to the length of a mesh where there are no volumes. */
#define SEGMENTS_OF_MESHES 256.0

/* What is made of one input for this picture. */
typedef struct several_input {
  const stratus_ray_cast_input* of;
  stratus_ray_cast_options options; /* with the tolerance of a picture of several, and what all take from the first */
  stratus_ray_cast_report report;
  stratus_tetra_options tetra_options; /* of a mesh, likewise */
  stratus_tetra_frame frame;           /* of a mesh that shows */
  bool shows;
  stratus_structure used;
  int stride, part; /* part: its number among those that are shown; -1: it is not */
  char why[192];
} several_input;

typedef struct several {
  stratus_context* context;
  const stratus_camera* camera;
  const stratus_image* image;
  int count;
  double step;     /* of the lattice */
  char where[160]; /* why the host draws though there is a device; else empty */
  several_input inputs[STRATUS_SEVERAL_MAX];
} several;

/* ---- checks */

static stratus_context* context_of(const stratus_ray_cast_input* input)
{
  return input->caster ? input->caster->context : input->tetra ? input->tetra->context : NULL;
}

static stratus_status check_numbers(const stratus_ray_cast_input* inputs, int count)
{
  stratus_context* context = context_of(inputs);
  if (count < 1 || count > STRATUS_SEVERAL_MAX) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%d volumes, must be 1..%d", count, STRATUS_SEVERAL_MAX);
  }
  for (int n = 0; n < count; ++n) {
    if (!inputs[n].caster && !inputs[n].tetra) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volume %d has no ray caster: caster is NULL, and so is tetra", n);
    }
    if (context_of(&inputs[n]) != context) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "the ray caster of volume %d is of another context than that of volume 0", n);
    }
    if (inputs[n].caster && inputs[n].tetra) {
      return stratus_fail(
        context, STRATUS_INVALID_ARGUMENT, "input %d has a ray caster and one of tetrahedra, must be a volume or a mesh", n);
    }
    for (int other = 0; other < n; ++other) {
      if (inputs[n].caster == inputs[other].caster && inputs[n].tetra == inputs[other].tetra) {
        return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volumes %d and %d have the same ray caster, each needs its own", other, n);
      }
    }
  }
  return STRATUS_OK;
}

/* Refuses what one march through several volumes does not draw. */
static stratus_status check_supported(stratus_context* context, int n, const several_input* in)
{
  const stratus_ray_cast_options* options = &in->options;
  const int components = stratus_volume_components(in->of->volume);
  if (options->mode != STRATUS_MODE_COMPOSITE) {
    return stratus_fail(
      context, STRATUS_UNSUPPORTED, "volume %d of several has mode %s: only composite mixes", n, stratus_mode_name(options->mode));
  }
  if (options->gradient_distance > 0.0 && in->of->transfer->gradient_count > 0) {
    return stratus_fail(context, STRATUS_UNSUPPORTED,
      "volume %d of several has a gradient opacity over a length of %g, must be of optical depths, 0", n, options->gradient_distance);
  }
  if (options->clip_gradients && options->clip_plane_count > 0) {
    return stratus_fail(
      context, STRATUS_UNSUPPORTED, "volume %d of several has gradients that clip planes change: one volume alone takes that", n);
  }
  if (components > 1 || options->label_count > 0) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "volume %d of several has %d components and %d labels, must have 1 and 0", n,
      components, options->label_count);
  }
  if (options->crop && options->crop_regions != STRATUS_CROP_INSIDE && options->crop_regions != STRATUS_CROP_ALL) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "volume %d of several shows crop regions 0x%x, must be the inside (0x%x) or all", n,
      (unsigned)options->crop_regions, (unsigned)STRATUS_CROP_INSIDE);
  }
  if (options->sampling == STRATUS_SAMPLING_CELLS) {
    return stratus_fail(context, STRATUS_UNSUPPORTED,
      "volume %d of several is to be sampled by cells, which follow one grid: midpoint, pre-integrated or automatic", n);
  }
  return STRATUS_OK;
}

static stratus_status check_mesh(
  stratus_context* context, int n, const stratus_mesh* mesh, const stratus_transfer* transfer, const stratus_tetra_options* options)
{
  if (mesh && mesh->components > 1) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "mesh %d of several has %d components, must have 1", n, mesh->components);
  }
  if (options->mode != STRATUS_TETRA_COMPOSITE) {
    return stratus_fail(
      context, STRATUS_UNSUPPORTED, "mesh %d of several has mode %s: only composite mixes", n, stratus_tetra_mode_name(options->mode));
  }
  if (options->method == STRATUS_TETRA_METHOD_PROJECT) {
    return stratus_fail(
      context, STRATUS_UNSUPPORTED, "mesh %d of several is to be projected, which draws whole pictures: its rays can only be marched", n);
  }
  if (transfer && stratus_tetra_light_wanted(transfer, options)) {
    return stratus_fail(
      context, STRATUS_UNSUPPORTED, "mesh %d of several has light or gradient opacity, which only volumes have in one march", n);
  }
  return STRATUS_OK;
}

/* The bounds of an input in the world. Returns whether it has any. */
static stratus_status bounds_of(const several* s, const several_input* in, double bounds[6], bool* any)
{
  *any = true;
  if (!in->of->tetra) {
    return stratus_volume_bounds(s->context, in->of->volume, bounds);
  }
  const stratus_tetra_mesh* mesh = in->of->tetra->mesh;
  *any = in->shows;
  for (int corner = 0; corner < 8 && *any; ++corner) {
    double local[3], point[3];
    for (int axis = 0; axis < 3; ++axis) {
      local[axis] = corner >> axis & 1 ? mesh->hi[axis] : mesh->lo[axis];
    }
    stratus_matrix_point(in->of->mesh->matrix, local, point);
    for (int axis = 0; axis < 3; ++axis) {
      bounds[2 * axis] = corner ? fmin(bounds[2 * axis], point[axis]) : point[axis];
      bounds[2 * axis + 1] = corner ? fmax(bounds[2 * axis + 1], point[axis]) : point[axis];
    }
  }
  return STRATUS_OK;
}

/* Refuses volumes between which a ray has more segments than can be numbered. */
static stratus_status check_extent(const several* s)
{
  double lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY }, square = 0.0;
  for (int n = 0; n < s->count; ++n) {
    double bounds[6];
    bool any;
    TRY(bounds_of(s, &s->inputs[n], bounds, &any));
    for (int axis = 0; any && axis < 3; ++axis) {
      lo[axis] = fmin(lo[axis], bounds[2 * axis]);
      hi[axis] = fmax(hi[axis], bounds[2 * axis + 1]);
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    square += (hi[axis] - lo[axis]) * (hi[axis] - lo[axis]);
  }
  if (isfinite(lo[0]) && !(sqrt(square) / s->step <= SEGMENTS_MOST)) {
    return stratus_fail(s->context, STRATUS_INVALID_ARGUMENT,
      "the volumes together are %g wide, too much for sample distance %g: at most %g of them", sqrt(square), s->step, SEGMENTS_MOST);
  }
  return STRATUS_OK;
}

/* ---- what each volume brings */

/* Updates what is built of a mesh, and makes its frame. */
static stratus_status update_mesh(several* s, several_input* in)
{
  const stratus_tetra_subject of = { in->of->mesh, in->of->transfer, &in->tetra_options };
  stratus_tetra_report report = { 0 };
  TRY(stratus_tetra_caster_prepare(in->of->tetra, &of, s->camera, s->image, &in->frame, &in->shows, &report));
  in->report.table_builds = report.table_builds;
  in->report.structure_builds = report.mesh_builds;
  in->report.table_ms = report.table_ms;
  in->report.structure_ms = report.build_ms;
  in->report.structure_bytes = report.bytes;
  return STRATUS_OK;
}

/* Updates tables, structure and choice of one input. */
static stratus_status update(several* s, several_input* in)
{
  stratus_ray_caster* caster = in->of->caster;
  const size_t rays = (size_t)s->image->width * (size_t)s->image->height;
  caster->in_several = true;
  caster->where[0] = '\0';
  TRY(stratus_ray_transfer_2d_update(caster, &in->options)); /* it has none now */
  TRY(stratus_ray_update_tables(caster, in->of->volume, in->of->transfer, &in->options, rays, &in->report));
  if (!caster->owns_all) {
    return stratus_fail(s->context, STRATUS_UNSUPPORTED, "a volume of several has DUPLICATE ghosts: only whole volumes mix");
  }
  /* times of a picture of several tell nothing of one volume's structure */
  TRY(stratus_ray_update_structures(caster, in->options.structure, false, &in->used, in->why, sizeof in->why, &in->report));
  if (in->options.structure == STRATUS_STRUCTURE_AUTO && in->used != STRATUS_STRUCTURE_NONE) {
    snprintf(in->why, sizeof in->why, "%s: several volumes are not timed apart", stratus_structure_name(in->used));
  }
  if (caster->choice.provisional) {
    TRY(stratus_ray_probe(caster, in->of->volume, &in->options, &in->report));
  }
  return STRATUS_OK;
}

static int stride_of(const stratus_ray_caster* caster, double step)
{
  return (int)fmax(1.0, fmin(floor(caster->choice.sample_distance / step * (1.0 + 1e-9)), STRIDE_MOST));
}

/* Chooses the lattice: segments of the shortest step that a volume has, or of a half, a third or a quarter of it where other volumes'
 * steps, whole numbers of segments, then come so much nearer to what they may be that fewer samples are taken. Volumes whose samples fall
 * together share a layer of light, which counts EVENT_COST of a sample. */
static stratus_status choose_step(several* s)
{
  double least = INFINITY, shortest = INFINITY, longest = 0.0;
  for (int n = 0; n < s->count; ++n) {
    const several_input* in = &s->inputs[n];
    double bounds[6];
    bool any = false;
    if (in->of->caster) {
      shortest = fmin(shortest, in->of->caster->choice.sample_distance);
      continue;
    }
    TRY(bounds_of(s, in, bounds, &any));
    for (int axis = 0; any && axis < 3; ++axis) {
      longest = fmax(longest, bounds[2 * axis + 1] - bounds[2 * axis]);
    }
  }
  if (!(shortest < INFINITY)) { /* meshes alone: the lattice is no more than their unit of length */
    s->step = longest > 0.0 ? longest / SEGMENTS_OF_MESHES : 1.0;
    return STRATUS_OK;
  }
  for (int parts = 1; parts <= PARTS_MOST; ++parts) {
    double samples = 0.0;
    bool together = true;
    for (int n = 0; n < s->count; ++n) {
      if (!s->inputs[n].of->caster) {
        continue;
      }
      const int stride = stride_of(s->inputs[n].of->caster, shortest / parts);
      samples += (double)parts / stride;
      together = together && stride % parts == 0;
    }
    const double cost = samples + EVENT_COST * (together ? 1.0 : samples);
    if (cost < GAIN * least) {
      least = cost;
      s->step = shortest / parts;
    }
  }
  return STRATUS_OK;
}

/* Makes the layers of a midpoint table: colour times optical depth, and optical depth, of each entry over a segment of the lattice. */
static stratus_status update_layers(stratus_ray_caster* caster, double step)
{
  const stratus_table* table = caster->made.table;
  void* memory = NULL;
  if (caster->layers && caster->layers_of == caster->made.number && caster->layers_step == step) {
    return STRATUS_OK;
  }
  TRY(stratus_allocate(caster->context, 4 * (size_t)table->size, sizeof(float), &memory));
  stratus_release(caster->context, caster->layers);
  caster->layers = memory;
  caster->layers_of = caster->made.number;
  caster->layers_step = step;
  const float scale = (float)(step / caster->made.distance), *rgba = table->rgba, *depth = rgba + 4 * (size_t)table->size;
  for (size_t e = 0; e < 4 * (size_t)table->size; e += 4) {
    const float alpha = rgba[e + 3], tau = depth[e] * scale;
    for (size_t c = 0; c < 3; ++c) {
      caster->layers[e + c] = alpha > 0.0f ? rgba[e + c] / alpha * tau : 0.0f;
    }
    caster->layers[e + 3] = tau;
  }
  return STRATUS_OK;
}

/* Sets what rays read of a mesh, unless they meet nothing of it. The arguments have what all rays share, and the table. */
static void set_mesh(const several* s, several_input* in, int number, stratus_ray_cast_arguments* a, stratus_several_part* part)
{
  const stratus_image* image = s->image;
  in->part = in->shows ? number : -1;
  in->stride = 1;
  if (!in->shows) {
    return;
  }
  memset(a, 0, sizeof *a);
  a->picture = in->frame.arguments.picture;
  a->termination = in->frame.arguments.termination;
  a->lattice.step = (float)s->step;
  a->camera.window[1] = image->width;
  a->camera.window[3] = image->height;
  a->camera.has_opaque_depth = image->opaque_depth != NULL;
  const stratus_ray_cast_options* first = &s->inputs[0].options;
  stratus_ray_frame_table(in->frame.table, in->tetra_options.tolerance, a);
  a->table.tau_scale *= (float)s->step; /* the table is of the world's unit of length */
  *part = (stratus_several_part){ .frame = { .arguments = a,
                                    .table = in->frame.table->sums,
                                    .opaque_depth = image->opaque_depth,
                                    .rgba = image->rgba,
                                    .depth = image->depth,
                                    .samples = image->samples,
                                    .rgba8 = image->rgba8 },
    .mesh = &in->frame,
    .jitter = first->jitter,
    .seed = (int)first->jitter_seed,
    .stride = 1,
    .preintegrated = 1 };
}

/* Sets what rays read of one input, unless they meet nothing of it. */
static stratus_status set_part(const several* s, several_input* in, int number, stratus_ray_cast_arguments* a, stratus_several_part* part)
{
  stratus_ray_caster* caster = in->of->caster;
  const bool with_map = in->used != STRATUS_STRUCTURE_NONE;
  bool empty = false;
  const bool preintegrated = caster->choice.sampling == STRATUS_SAMPLING_PREINTEGRATED;
  if (preintegrated) {
    stratus_table_set_distance(caster->made.table, s->step);
  } else {
    TRY(update_layers(caster, s->step));
  }
  TRY(stratus_ray_frame_arguments(caster, s->camera, &in->options, s->image, s->step, a, &empty));
  const bool shown = !empty && stratus_ray_shading_show(caster) && !(with_map && caster->occupancy->count == 0);
  in->stride = stride_of(caster, s->step);
  in->part = -1;
  if (shown) {
    in->part = number;
    a->values.has_hidden = caster->hides;
    stratus_ray_shading_arguments(caster, in->of->volume, s->camera, &in->options, a);
    stratus_ray_frame_structures(
      &caster->grid, caster->made.table, stratus_ray_tolerance(&in->options), caster->occupancy, with_map ? caster->map : NULL, a);
    *part = (stratus_several_part){ .caster = caster,
      .frame = stratus_ray_frame_of(caster, a, s->image, with_map),
      .layers = preintegrated ? NULL : caster->layers,
      .type = stratus_ray_fetch_type(&caster->traversed),
      .stride = in->stride,
      .lit = caster->shades,
      .preintegrated = preintegrated };
  }
  return STRATUS_OK;
}

/* ---- drawing */

typedef struct several_job {
  const stratus_several_frame* frame;
  stratus_ray_cast_tile* draw;
  int columns;
} several_job;

static void draw_tile(const void* data, int tile, uint64_t counts[STRATUS_TILE_COUNTS])
{
  const several_job* job = data;
  const stratus_ray_cast_frame* frame = &job->frame->picture;
  const int width = frame->arguments->picture.width, height = frame->arguments->picture.height;
  const int x0 = tile % job->columns * STRATUS_RAY_TILE, x1 = x0 + STRATUS_RAY_TILE < width ? x0 + STRATUS_RAY_TILE : width;
  const int y0 = tile / job->columns * STRATUS_RAY_TILE, y1 = y0 + STRATUS_RAY_TILE < height ? y0 + STRATUS_RAY_TILE : height;
  stratus_ray_counts mine = { 0 };
  stratus_ray_cast_pixels(frame, job->draw, x0, y0, x1, y1, &mine);
  counts[0] += mine.rays;
  counts[1] += mine.samples;
  counts[2] += mine.skipped;
  counts[3] += mine.lookups;
}

static stratus_status draw_on_host(stratus_context* context, const stratus_several_frame* frame, stratus_ray_counts* counts)
{
  static stratus_ray_cast_tile* const tiles[] = STRATUS_ISA_EACH(stratus_several_tile);
  const int width = frame->picture.arguments->picture.width, height = frame->picture.arguments->picture.height;
  const int columns = (width + STRATUS_RAY_TILE - 1) / STRATUS_RAY_TILE, rows = (height + STRATUS_RAY_TILE - 1) / STRATUS_RAY_TILE;
  const several_job job = { frame, tiles[stratus_isa_at_most(context->isa)], columns };
  uint64_t sums[STRATUS_TILE_COUNTS];
  TRY(stratus_each_tile(context, "ray cast", columns * rows, draw_tile, &job, sums));
  *counts = (stratus_ray_counts){ .rays = sums[0], .samples = sums[1], .skipped = sums[2], .lookups = sums[3] };
  return STRATUS_OK;
}

/* *drawn stays false if the device cannot draw one of the volumes. */
static stratus_status draw_on_device(several* s, const stratus_several_frame* frame, stratus_ray_counts* counts, bool* drawn)
{
  const char* why_not = NULL;
  for (int n = 0; n < s->count; ++n) {
    several_input* in = &s->inputs[n];
    if (in->part >= 0) {
      const stratus_several_part* part = &frame->volumes[in->part];
      const double start = stratus_now_ms();
      if (part->mesh) {
        snprintf(s->where, sizeof s->where, "drawn on the host: volume %d is a mesh, and the device draws none among several", n);
        return STRATUS_OK;
      }
      TRY(stratus_ray_device_send(part->caster, &part->frame, part->layers, &why_not));
      in->report.upload_ms += stratus_now_ms() - start;
    }
    if (why_not) {
      stratus_log(s->context, STRATUS_LOG_WARNING, "drawing on the host: volume %d: %s", n, why_not);
      snprintf(s->where, sizeof s->where, "drawn on the host: volume %d: %s", n, why_not);
      return STRATUS_OK;
    }
  }
  *drawn = true;
  return stratus_several_device(s->context, frame, counts);
}

static stratus_status draw(several* s, const stratus_several_frame* frame, stratus_ray_counts* counts)
{
  if (s->context->device) {
    bool drawn = false;
    const stratus_status status = draw_on_device(s, frame, counts, &drawn);
    if (status != STRATUS_OK) { /* if the host is to draw, the message goes to the log only */
      snprintf(s->where, sizeof s->where, "drawn on the host: %s", stratus_context_message(s->context));
    }
    if (!stratus_device_hands_back(s->context, status) && (status != STRATUS_OK || drawn)) {
      return status;
    }
  }
  return draw_on_host(s->context, frame, counts);
}

/* Draws the frame again without structures and counts the pixels whose bits differ. */
static stratus_status audit(several* s, const stratus_several_frame* frame, stratus_ray_cast_arguments* plain, uint64_t* differing)
{
  const size_t pixels = (size_t)s->image->width * (size_t)s->image->height;
  stratus_several_frame march = *frame;
  stratus_ray_counts counts;
  void *rgba = NULL, *depth = NULL;
  stratus_status status;
  for (int n = 0; n < frame->count; ++n) {
    plain[n] = *frame->volumes[n].frame.arguments;
    if (!frame->volumes[n].mesh) {
      stratus_ray_frame_structures(NULL, NULL, 0.0, NULL, NULL, &plain[n]);
    }
    plain[n].picture.want_samples = plain[n].picture.want_bytes = 0;
    march.volumes[n].frame.arguments = &plain[n];
  }
  TRY_CLEANUP(stratus_allocate(s->context, pixels, 4 * sizeof(float), &rgba));
  march.picture.rgba = rgba;
  if (s->image->depth) {
    TRY_CLEANUP(stratus_allocate(s->context, pixels, sizeof(float), &depth));
    march.picture.depth = depth;
  }
  march.picture.samples = NULL;
  march.picture.rgba8 = NULL;
  TRY_CLEANUP(draw(s, &march, &counts));
  *differing = stratus_ray_differing(s->image, rgba, depth);
cleanup:
  stratus_release(s->context, rgba);
  stratus_release(s->context, depth);
  return status;
}

/* Widens a window by another; one without pixels has none to add. */
static void join_windows(const int of[4], int window[4])
{
  if (of[0] >= of[1] || of[2] >= of[3]) {
    return;
  }
  const bool any = window[0] < window[1];
  for (int side = 0; side < 4; ++side) {
    const bool farther = side % 2 ? of[side] > window[side] : of[side] < window[side];
    window[side] = !any || farther ? of[side] : window[side];
  }
}

/* Tells of a mesh what was counted. */
static void report_mesh(const several* s, several_input* in, const stratus_ray_counts* counts, const int window[4])
{
  in->report.rays = counts->rays;
  in->report.samples = counts->samples;
  in->report.skipped = counts->skipped;
  in->report.lookups = counts->lookups;
  memcpy(in->report.window, window, sizeof in->report.window);
  snprintf(in->report.why, sizeof in->report.why, "a mesh of %lld cells, from face to face%s%s", (long long)in->of->tetra->mesh->cell_count,
    *s->where ? "; " : "", s->where);
}

static void report_input(const several* s, several_input* in, const stratus_ray_counts* counts, const int window[4])
{
  if (in->of->tetra) {
    report_mesh(s, in, counts, window);
    return;
  }
  stratus_ray_caster* caster = in->of->caster;
  const stratus_ray_choice* choice = &caster->choice;
  char every[64] = "";
  if (in->stride > 1) {
    snprintf(every, sizeof every, " (every %d of the lattice's %.4g)", in->stride, s->step);
  }
  stratus_ray_fill_report(caster, counts, in->used, &in->report);
  in->report.sample_distance = in->stride * s->step;
  memcpy(in->report.window, window, sizeof in->report.window);
  snprintf(in->report.why, sizeof in->report.why, "%s; %s, sample distance %.4g%s%s%s%s%s", in->why,
    stratus_sampling_name(choice->sampling), in->report.sample_distance, every, *s->where ? "; " : "", s->where, *caster->tried ? ": " : "",
    caster->tried);
  caster->samples_since_data += counts->samples / (uint64_t)s->count;
}

/* Draws what is shown of all inputs. arguments, plain: for each. */
static stratus_status render(several* s, stratus_ray_cast_arguments* arguments, stratus_ray_cast_arguments* plain)
{
  stratus_several_frame frame = { .count = 0 };
  stratus_ray_counts counts = { 0 };
  uint64_t differing = 0;
  int window[4] = { 0, 0, 0, 0 };
  float termination = 1.0f;
  for (int n = 0; n < s->count; ++n) {
    TRY((s->inputs[n].of->tetra ? update_mesh : update)(s, &s->inputs[n]));
  }
  TRY(choose_step(s));
  TRY(check_extent(s));
  frame.step = s->step;
  const double start = stratus_now_ms();
  for (int n = 0; n < s->count; ++n) {
    stratus_ray_cast_arguments* a = &arguments[frame.count];
    if (s->inputs[n].of->tetra) {
      set_mesh(s, &s->inputs[n], frame.count, a, &frame.volumes[frame.count]);
    } else {
      TRY(set_part(s, &s->inputs[n], frame.count, a, &frame.volumes[frame.count]));
    }
    if (s->inputs[n].part >= 0) {
      join_windows(a->camera.window, window);
      termination = fminf(termination, a->termination);
      ++frame.count;
    }
  }
  if (frame.count == 0) {
    stratus_image_clear(s->image);
  } else {
    arguments[0].termination = termination;
    frame.picture = frame.volumes[0].frame;
    TRY(draw(s, &frame, &counts));
    if (s->inputs[0].options.audit) {
      TRY(audit(s, &frame, plain, &differing));
    }
  }
  const double cast_ms = stratus_now_ms() - start;
  double upload_ms = 0.0;
  for (int n = 0; n < s->count; ++n) {
    upload_ms += s->inputs[n].report.upload_ms;
  }
  for (int n = 0; n < s->count; ++n) {
    s->inputs[n].report.differing_pixels = differing;
    s->inputs[n].report.cast_ms = cast_ms - upload_ms;
    report_input(s, &s->inputs[n], &counts, window);
  }
  return STRATUS_OK;
}

stratus_status stratus_ray_caster_render_several(const stratus_ray_cast_input* inputs, int count, const stratus_camera* camera,
  const stratus_image* image, stratus_ray_cast_report* reports)
{
  _Alignas(64) stratus_ray_cast_arguments arguments[STRATUS_SEVERAL_MAX], plain[STRATUS_SEVERAL_MAX];
  several s = { .camera = camera, .image = image, .count = count };
  if (!inputs || !context_of(inputs)) {
    return STRATUS_INVALID_ARGUMENT;
  }
  TRY(check_numbers(inputs, count));
  s.context = context_of(inputs);
  if (count == 1 && inputs[0].caster) {
    return stratus_ray_caster_render(inputs[0].caster, inputs[0].volume, inputs[0].transfer, camera, inputs[0].options, image, reports);
  }
  for (int n = 0; n < count; ++n) {
    several_input* in = &s.inputs[n];
    in->of = &inputs[n];
    in->options = inputs[n].options ? *inputs[n].options : stratus_ray_cast_options_default();
    in->report = (stratus_ray_cast_report){ .expected_error = NAN, .tolerance_met = 1 };
    if (inputs[n].tetra) {
      in->tetra_options = inputs[n].tetra_options ? *inputs[n].tetra_options : stratus_tetra_options_default();
      TRY(check_mesh(s.context, n, inputs[n].mesh, inputs[n].transfer, &in->tetra_options));
      in->tetra_options.tolerance /= sqrt((double)count);
      in->tetra_options.method = STRATUS_TETRA_METHOD_MARCH;
      continue;
    }
    if (in->options.transfer_2d) { /* in place of the function that is checked next */
      return stratus_fail(
        s.context, STRATUS_UNSUPPORTED, "volume %d of several has a two-dimensional function: one volume alone takes that", n);
    }
    TRY(stratus_ray_check_input(s.context, inputs[n].volume, inputs[n].transfer, &in->options));
    TRY(check_supported(s.context, n, in));
    in->options.tolerance /= sqrt((double)count);
    in->options.jitter = s.inputs[0].options.jitter;
    in->options.jitter_seed = s.inputs[0].options.jitter_seed;
  }
  TRY(stratus_image_check(s.context, image));
  TRY(render(&s, arguments, plain));
  for (int n = 0; reports && n < count; ++n) {
    reports[n] = s.inputs[n].report;
  }
  return STRATUS_OK;
}
