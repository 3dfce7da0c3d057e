/* SPDX-License-Identifier: BSD-3-Clause
 * Draws several volumes in one march: each caster keeps tables, structure and choice of its own volume, and all share the lattice. */
#include "instruction_set.h"
#include "camera.h"
#include "device.h"
#include "picture.h"
#include "ray_cast_rest.h"
#include "ray_device_buffers.h"
#include "ray_frame.h"
#include "ray_kept.h"
#include "ray_light.h"
#include "ray_several_picture.h"
#include "tiles.h"

#include <stdio.h>
#include <string.h>

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
  static stratus_ray_cast_tile* const tiles[] = STRATUS_ISA_EVERY(stratus_several_tile);
  const int width = frame->picture.arguments->picture.width, height = frame->picture.arguments->picture.height;
  const int columns = (width + STRATUS_RAY_TILE - 1) / STRATUS_RAY_TILE, rows = (height + STRATUS_RAY_TILE - 1) / STRATUS_RAY_TILE;
  stratus_several_frame mine = *frame;
  const several_job job = { &mine, tiles[stratus_isa_at_most(context->isa)], columns };
  uint64_t sums[STRATUS_TILE_COUNTS];
  void* memory = NULL;
  for (int n = 0; n < frame->count; ++n) {
    const stratus_several_part* part = &frame->volumes[n];
    stratus_tetra_counts found;
    if (part->mesh && !part->mesh->entries) {
      TRY(stratus_tetra_count_entries(context, part->mesh, &part->tetra->buffers, &found));
    }
  }
  mine.room = (size_t)stratus_several_part_count(frame) * STRATUS_SEVERAL_PART_BYTES;
  TRY(stratus_allocate(context, (size_t)context->threads, mine.room, &memory));
  mine.rooms = memory;
  const stratus_status status = stratus_each_tile(context, "ray cast", columns * rows, draw_tile, &job, sums);
  stratus_release(context, memory);
  TRY(status);
  *counts = (stratus_ray_counts){ .rays = sums[0], .samples = sums[1], .skipped = sums[2], .lookups = sums[3] };
  return STRATUS_OK;
}

/* Draws on the device, which may have borrowed memory of meshes afterwards. *drawn stays false if it cannot draw one of the volumes. */
static stratus_status send_and_draw(stratus_several* s, const stratus_several_frame* frame, stratus_ray_counts* counts, bool* drawn)
{
  const bool fits = stratus_light_maps_bytes(frame->maps) <= stratus_device_largest_allocation(s->context->device);
  const char* why_not = fits ? NULL : "the maps of light are larger than the device's largest allocation";
  for (int n = 0; n < s->count; ++n) {
    stratus_several_input* in = &s->inputs[n];
    if (in->part >= 0 && !why_not) {
      const stratus_several_part* part = &frame->volumes[in->part];
      const double start = stratus_now_ms();
      if (part->mesh) {
        TRY(stratus_tetra_caster_enter(part->tetra, part->mesh, &why_not));
      } else {
        TRY(stratus_ray_device_send(part->caster, &part->frame, part->layers, &why_not));
      }
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

static stratus_status draw_on_device(stratus_several* s, const stratus_several_frame* frame, stratus_ray_counts* counts, bool* drawn)
{
  const stratus_status status = send_and_draw(s, frame, counts, drawn);
  for (int n = 0; n < frame->count; ++n) {
    if (frame->volumes[n].mesh) {
      stratus_tetra_device_return(s->context, frame->volumes[n].tetra->device);
    }
  }
  return status;
}

static stratus_status draw(stratus_several* s, const stratus_several_frame* frame, stratus_ray_counts* counts)
{
  const stratus_ray_cast_input* first = s->inputs[0].of; /* all are on the host, or none */
  const bool on_host = first->tetra ? first->tetra->on_host : first->caster->on_host;
  if (s->context->device && !on_host) {
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
static stratus_status audit(stratus_several* s, const stratus_several_frame* frame, stratus_ray_cast_arguments* plain, uint64_t* differing)
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

/* Writes a mesh's counts to its report. */
static void report_mesh(const stratus_several* s, stratus_several_input* in, const stratus_ray_counts* counts, const int window[4])
{
  in->report.rays = counts->rays;
  in->report.samples = counts->samples;
  in->report.skipped = counts->skipped;
  in->report.lookups = counts->lookups;
  memcpy(in->report.window, window, sizeof in->report.window);
  snprintf(in->report.why, sizeof in->report.why, "a mesh of %lld cells, from face to face%s%s", (long long)in->of->tetra->mesh->cell_count,
    *s->where ? "; " : "", s->where);
}

static void report_input(const stratus_several* s, stratus_several_input* in, const stratus_ray_counts* counts, const int window[4])
{
  if (in->of->tetra) {
    report_mesh(s, in, counts, window);
    return;
  }
  stratus_ray_caster* caster = in->of->caster;
  const stratus_ray_choice* choice = &caster->integrator.choice;
  char every[64] = "";
  if (in->stride > 1) {
    snprintf(every, sizeof every, " (every %d of the lattice's %.4g)", in->stride, s->step);
  }
  stratus_ray_fill_report(caster, counts, in->used, &in->report);
  if (choice->sampling != STRATUS_SAMPLING_CELLS) {
    in->report.sample_distance = in->stride * s->step;
  }
  memcpy(in->report.window, window, sizeof in->report.window);
  snprintf(in->report.why, sizeof in->report.why, "%s; %s, sample distance %.4g%s%s%s%s%s", in->why,
    stratus_sampling_name(choice->sampling), in->report.sample_distance, every, *s->where ? "; " : "", s->where, *caster->tried ? ": " : "",
    caster->tried);
  caster->field.samples_since_data += counts->samples / (uint64_t)s->count;
}

/* Draws what is shown of all inputs. arguments, plain: for each. */
static stratus_status render(stratus_several* s, stratus_ray_cast_arguments* arguments, stratus_ray_cast_arguments* plain)
{
  stratus_several_frame frame = { .count = 0 };
  stratus_ray_counts counts = { 0 };
  uint64_t differing = 0;
  int window[4] = { 0, 0, 0, 0 };
  float termination = 1.0f;
  TRY(stratus_ray_light_update_several(s->given, s->count, false, s->camera, stratus_ray_caster_render_several, &s->light));
  s->maps = s->given->tetra ? s->given->tetra->lights : s->given->caster->optics.lights;
  for (int n = 0; n < s->count; ++n) {
    TRY(stratus_several_update(s, &s->inputs[n]));
  }
  TRY(stratus_several_choose_step(s));
  const double start = stratus_now_ms();
  for (int n = 0; n < s->count; ++n) {
    stratus_ray_cast_arguments* a = &arguments[frame.count];
    TRY(stratus_several_set_part(s, &s->inputs[n], frame.count, a, &frame.volumes[frame.count]));
    if (s->inputs[n].part >= 0) {
      stratus_window_join(window, a->camera.window);
      termination = fminf(termination, a->termination);
      ++frame.count;
    }
  }
  if (frame.count == 0) {
    stratus_image_clear(s->image);
  } else {
    arguments[0].termination = termination;
    frame.picture = frame.volumes[0].frame;
    frame.picture.lights = stratus_light_maps_words(s->maps);
    frame.maps = s->maps;
    TRY(draw(s, &frame, &counts));
    if (s->inputs[0].options.skipping.audit) {
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
  stratus_several s = { .given = inputs, .camera = camera, .image = image, .count = count };
  if (!inputs || !stratus_several_context(inputs)) {
    return STRATUS_INVALID_ARGUMENT;
  }
  TRY(stratus_several_check_inputs(inputs, count));
  s.context = stratus_several_context(inputs);
  if (count == 1 && inputs[0].caster) {
    return stratus_ray_caster_render(inputs[0].caster, inputs[0].volume, inputs[0].transfer, camera, inputs[0].options, image, reports);
  }
  if (stratus_kept_mode(inputs) != STRATUS_MODE_COMPOSITE) {
    return stratus_several_kept(inputs, count, camera, image, reports);
  }
  for (int n = 0; n < count; ++n) {
    stratus_several_input* in = &s.inputs[n];
    in->of = &inputs[n];
    in->options = inputs[n].options ? *inputs[n].options : stratus_ray_cast_options_default();
    in->report = (stratus_ray_cast_report){ .expected_error = NAN, .tolerance_met = 1 };
    if (inputs[n].tetra) {
      in->tetra_options = inputs[n].tetra_options ? *inputs[n].tetra_options : stratus_tetra_options_default();
      TRY(stratus_several_check_mesh(s.context, n, in));
      in->tetra_options.tolerance /= sqrt((double)count);
      in->tetra_options.method = STRATUS_TETRA_METHOD_MARCH;
      continue;
    }
    TRY(stratus_ray_update_transfer_2d(inputs[n].caster, inputs[n].volume, &in->options));
    in->transfer = in->options.optics.transfer_2d ? &inputs[n].caster->optics.transfer_2d.shown : inputs[n].transfer;
    TRY(stratus_ray_check_input(s.context, inputs[n].volume, in->transfer, &in->options));
    TRY(stratus_several_check_volume(s.context, n, in));
    in->options.sampling.tolerance /= sqrt((double)count);
    in->options.sampling.jitter = s.inputs[0].options.sampling.jitter;
    in->options.sampling.jitter_seed = s.inputs[0].options.sampling.jitter_seed;
  }
  TRY(stratus_image_check(s.context, image));
  const stratus_status status = render(&s, arguments, plain);
  stratus_ray_light_return(inputs, count); /* the maps are the first input's, which may go before the others */
  TRY(status);
  TRY(stratus_several_check_missing(inputs, count));
  for (int n = 0; reports && n < count; ++n) {
    reports[n] = s.inputs[n].report;
  }
  stratus_ray_light_report(&s.light, reports, count);
  return STRATUS_OK;
}
