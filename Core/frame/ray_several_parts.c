/* SPDX-License-Identifier: BSD-3-Clause
 * Makes each of several volumes ready to be drawn: its tables and structure, the lattice that all share, and the arrays that rays read. */
#include "ray_several_picture.h"

#include "matrix.h"
#include "ray_fetched.h"
#include "ray_frame.h"
#include "ray_modes_render.h"
#include "ray_probe.h"
#include "ray_shading_render.h"
#include "table_fill.h"

#include <stdio.h>
#include <string.h>

/* Places along a ray are numbered by ints, which limits the segments between the volumes. */
#define SEGMENTS_MOST 1e9
/* Most segments to a sample. */
#define STRIDE_MOST 65536.0
/* The largest division of the shortest step, the cost of a layer of light in samples, and the largest relative cost of a finer lattice. */
#define PARTS_MOST 4
#define EVENT_COST 0.3
#define GAIN 0.95

/* Segments of the lattice to the length of a mesh where there are no volumes. */
#define SEGMENTS_OF_MESHES 256.0

/* The bounds of an input in the world. Returns whether it has any. */
static stratus_status bounds_of(const stratus_several* s, const stratus_several_input* in, double bounds[6], bool* any)
{
  *any = true;
  if (!in->of->tetra) {
    return stratus_volume_bounds(s->context, in->of->volume, bounds);
  }
  const stratus_tetra_mesh* mesh = in->of->tetra->mesh;
  *any = in->shows;
  if (*any) {
    stratus_matrix_box(in->of->mesh->matrix, mesh->lo, mesh->hi, bounds);
  }
  return STRATUS_OK;
}

/* Refuses volumes between which a ray has more segments than can be numbered. */
static stratus_status check_extent(const stratus_several* s)
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

/* Updates what is built of a mesh, and makes its frame. */
static stratus_status update_mesh(stratus_several* s, stratus_several_input* in)
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

static stratus_status update_volume(stratus_several* s, stratus_several_input* in)
{
  stratus_ray_caster* caster = in->of->caster;
  const size_t rays = (size_t)s->image->width * (size_t)s->image->height;
  caster->where[0] = '\0';
  caster->together = true;
  TRY(stratus_ray_update_tables(caster, in->of->volume, in->transfer, &in->options, rays, &in->report));
  if (!caster->field.owns_all) {
    return stratus_fail(s->context, STRATUS_UNSUPPORTED, "a volume of several has DUPLICATE ghosts: only whole volumes mix");
  }
  /* times of an image of several volumes say nothing about one volume's structure */
  TRY(stratus_ray_update_structures(caster, in->options.skipping.structure, false, &in->used, in->why, sizeof in->why, &in->report));
  if (in->options.skipping.structure == STRATUS_STRUCTURE_AUTO && in->used != STRATUS_STRUCTURE_NONE) {
    snprintf(in->why, sizeof in->why, "%s: several volumes are not timed apart", stratus_structure_name(in->used));
  }
  if (caster->integrator.choice.provisional) {
    TRY(stratus_ray_probe(caster, in->of->volume, s->camera, &in->options, &in->report));
  }
  return STRATUS_OK;
}

stratus_status stratus_several_update(stratus_several* s, stratus_several_input* in)
{
  return (in->of->tetra ? update_mesh : update_volume)(s, in);
}

/* Whether an input takes samples of a lattice, at least in parts. */
static bool takes_samples(const stratus_several_input* in)
{
  return in->of->caster && in->of->caster->integrator.choice.sampling != STRATUS_SAMPLING_CELLS;
}

/* Returns the segments of the lattice to a sample of a volume. */
static int stride_of(const stratus_ray_caster* caster, double step)
{
  if (caster->integrator.choice.sampling == STRATUS_SAMPLING_CELLS) {
    return 1;
  }
  return (int)fmax(1.0, fmin(floor(caster->integrator.choice.sample_distance / step * (1.0 + 1e-9)), STRIDE_MOST));
}

/* Choose the lattice. Its segments are the shortest step that a volume has, or a half, a third or a quarter of it. A finer lattice is
 * chosen if other volumes' steps, which are whole numbers of segments, then come so much nearer to their limits that fewer samples are
 * needed. Volumes whose samples coincide share a layer of light, which counts EVENT_COST of a sample. If rays pass from cell to cell,
 * segments are at most as long as the voxels, so that floats distinguish places in a cell. */
stratus_status stratus_several_choose_step(stratus_several* s)
{
  double least = INFINITY, shortest = INFINITY, walked = INFINITY, longest = 0.0;
  for (int n = 0; n < s->count; ++n) {
    const stratus_several_input* in = &s->inputs[n];
    double bounds[6];
    bool any = false;
    if (in->of->caster) {
      const stratus_ray_choice* choice = &in->of->caster->integrator.choice;
      walked = stratus_ray_visits_cells(choice->sampling) ? fmin(walked, in->of->caster->inputs.voxel) : walked;
      shortest = takes_samples(in) ? fmin(shortest, choice->sample_distance) : shortest;
      continue;
    }
    TRY(bounds_of(s, in, bounds, &any));
    for (int axis = 0; any && axis < 3; ++axis) {
      longest = fmax(longest, bounds[2 * axis + 1] - bounds[2 * axis]);
    }
  }
  if (!(shortest < INFINITY)) { /* nothing takes samples: the lattice is no more than a unit of length */
    s->step = walked < INFINITY ? walked : longest > 0.0 ? longest / SEGMENTS_OF_MESHES : 1.0;
    return check_extent(s);
  }
  for (int parts = 1; parts <= PARTS_MOST; ++parts) {
    double samples = 0.0;
    bool together = true;
    for (int n = 0; n < s->count; ++n) {
      if (!takes_samples(&s->inputs[n])) {
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
  if (walked < s->step) {
    s->step /= ceil(s->step / walked);
  }
  return check_extent(s);
}

/* Makes the layers of a midpoint table: colour times optical depth, and optical depth, of each entry over a segment of the lattice. */
static stratus_status update_layers(stratus_ray_caster* caster, double step)
{
  const stratus_table* table = caster->optics.made.table;
  void* memory = NULL;
  if (caster->optics.layers && caster->optics.layers_of == caster->optics.made.number && caster->optics.layers_step == step) {
    return STRATUS_OK;
  }
  TRY(stratus_allocate(caster->context, 4 * (size_t)table->size, sizeof(float), &memory));
  stratus_release(caster->context, caster->optics.layers);
  caster->optics.layers = memory;
  caster->optics.layers_of = caster->optics.made.number;
  caster->optics.layers_step = step;
  const float scale = (float)(step / caster->optics.made.distance), *rgba = table->rgba, *depth = rgba + 4 * (size_t)table->size;
  for (size_t e = 0; e < 4 * (size_t)table->size; e += 4) {
    const float alpha = rgba[e + 3], tau = depth[e] * scale;
    for (size_t c = 0; c < 3; ++c) {
      caster->optics.layers[e + c] = alpha > 0.0f ? rgba[e + c] / alpha * tau : 0.0f;
    }
    caster->optics.layers[e + 3] = tau;
  }
  return STRATUS_OK;
}

/* The arguments of a mesh have what all rays share, and the table. */
static void set_mesh(
  const stratus_several* s, stratus_several_input* in, int number, stratus_ray_cast_arguments* a, stratus_several_part* part)
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
  a->camera.window[1] = image->width;
  a->camera.window[3] = image->height;
  a->camera.has_opaque_depth = image->opaque_depth != NULL;
  stratus_ray_frame_lattice(s->camera, image, s->step, a);
  a->lattice.jitter = s->inputs[0].options.sampling.jitter != 0;
  a->lattice.seed = (int)s->inputs[0].options.sampling.jitter_seed;
  stratus_ray_frame_table(in->frame.table, in->tetra_options.tolerance, a);
  a->table.tau_scale *= (float)s->step; /* the table is of the world's unit of length */
  *part = (stratus_several_part){ .frame = { .arguments = a,
                                    .table = in->frame.table->sums,
                                    .opaque_depth = image->opaque_depth,
                                    .rgba = image->rgba,
                                    .depth = image->depth,
                                    .samples = image->samples,
                                    .rgba8 = image->rgba8 },
    .tetra = in->of->tetra,
    .mesh = &in->frame,
    .arguments = { .stride = 1,
      .lit = in->frame.lit,
      .preintegrated = in->frame.components == NULL,
      .mesh = 1,
      .places = { stratus_pair_of(in->frame.middle), stratus_pair_of(in->frame.per_z),
        { stratus_pair_of(in->frame.lean[0]), stratus_pair_of(in->frame.lean[1]) } } } };
}

/* Returns what samples are more than one value's colour and opacity by. */
static int media_of(const stratus_ray_caster* caster)
{
  const bool labels = stratus_ray_shading_several(&caster->optics, &caster->field) && caster->field.components == 1;
  return caster->optics.transfer_2d.on ? SEVERAL_FUNCTION_2D
    : labels                           ? SEVERAL_LABELS
                                       : (stratus_ray_shading_several(&caster->optics, &caster->field) ? SEVERAL_COMPONENTS : 0);
}

static stratus_status set_volume(
  const stratus_several* s, stratus_several_input* in, int number, stratus_ray_cast_arguments* a, stratus_several_part* part)
{
  stratus_ray_caster* caster = in->of->caster;
  const bool with_map = in->used != STRATUS_STRUCTURE_NONE;
  bool empty = false;
  const stratus_sampling sampling = caster->integrator.choice.sampling;
  const bool preintegrated = sampling != STRATUS_SAMPLING_MIDPOINT;
  const int media = media_of(caster);
  if (preintegrated) {
    stratus_table_set_distance(caster->optics.made.table, s->step);
  } else if (!media) {
    TRY(update_layers(caster, s->step));
  }
  TRY(stratus_ray_frame_arguments(caster, s->camera, &in->options, s->image, s->step, false, a, &empty));
  const bool shown = !empty && stratus_ray_shading_show(&caster->optics, &caster->field, &caster->integrator.values) &&
    !(with_map && caster->structure.occupancy->count == 0);
  in->stride = stride_of(caster, s->step);
  in->part = -1;
  if (shown) {
    in->part = number;
    a->values.has_hidden = caster->field.hides;
    stratus_ray_modes_arguments(&caster->integrator, &caster->optics, &caster->field, caster->structure.rough, &in->options, a);
    a->lattice.jitter = in->options.sampling.jitter != 0; /* places on a ray by cells are places of the lattice, too */
    stratus_ray_shading_arguments(
      &caster->optics, &caster->field, caster->integrator.choice.sample_distance, in->of->volume, s->camera, &in->options, a);
    stratus_ray_frame_structures(&caster->field.grid, caster->optics.made.table, stratus_ray_tolerance(&in->options),
      caster->structure.occupancy, with_map ? caster->structure.map : NULL, a);
    *part = (stratus_several_part){ .caster = caster,
      .frame = stratus_ray_frame_of(caster, a, s->image, with_map),
      .layers = preintegrated || media ? NULL : caster->optics.layers,
      .type = stratus_ray_fetch_type(&caster->field.traversed),
      .arguments = { .stride = in->stride,
        .lit = caster->optics.shades && !media,
        .media = media,
        .segment = (float)(s->step / caster->integrator.choice.sample_distance),
        .cells = sampling == STRATUS_SAMPLING_CELLS ? SEVERAL_BY_CELLS
          : sampling == STRATUS_SAMPLING_LOCAL      ? SEVERAL_LOCAL
                                                    : SEVERAL_BY_SAMPLES,
        .preintegrated = preintegrated } };
  }
  return STRATUS_OK;
}

stratus_status stratus_several_set_part(
  const stratus_several* s, stratus_several_input* in, int number, stratus_ray_cast_arguments* a, stratus_several_part* part)
{
  if (in->of->tetra) {
    set_mesh(s, in, number, a, part);
    return STRATUS_OK;
  }
  return set_volume(s, in, number, a, part);
}

int stratus_several_part_count(const stratus_several_frame* frame)
{
  int parts = frame->count;
  for (int n = 0; n < frame->count; ++n) {
    const stratus_several_part* part = &frame->volumes[n];
    parts += (part->mesh ? part->mesh->arguments.regions : part->frame.arguments->crop.regions) ? CROP_PIECES - 1 : 0;
  }
  return parts;
}
