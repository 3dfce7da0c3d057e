/* SPDX-License-Identifier: BSD-3-Clause
 * The path tracer: every option. One tracer draws images in sequence, and each must have the bits of a new tracer on another context. */
#include "fuzz.h"

#include <stdlib.h>

typedef struct path_case {
  fuzz_field field;
  stratus_path_options options;
  stratus_camera camera;
  const stratus_transfer* transfer;
} path_case;

static stratus_path_options choose_options(fuzz* f, const path_case* c)
{
  stratus_path_options o = stratus_path_options_default();
  stratus_shading shading = { .on = 0 };
  o.samples = fuzz_integer(f, 1, 5);
  o.tolerance = fuzz_chance(f, 0.5) ? 0.0 : fuzz_real(f, 0.0, 1.0);
  o.samples = o.samples > 64 ? 64 : o.samples; /* odd numbers would take hours, and are valid */
  o.seed = fuzz_next(f);
  o.bounces = fuzz_integer(f, 0, 8);
  o.albedo = fuzz_real(f, 0.0, o.bounces == 0 ? 0.9 : 1.0);
  o.bounces = o.albedo > 0.95 && (o.bounces == 0 || o.bounces > 1000) ? 9 : o.bounces; /* white, opaque media take as long */
  o.anisotropy = fuzz_real(f, -0.99, 0.99);
  fuzz_shading(f, c->field.bounds, c->field.edge, &shading);
  o.light_count = shading.light_count;
  memcpy(o.lights, shading.lights, sizeof o.lights);
  for (int i = 0; i < 3 && fuzz_chance(f, 0.8); ++i) {
    o.sky_zenith[i] = fuzz_real(f, 0.0, 2.0);
    o.sky_horizon[i] = fuzz_real(f, 0.0, 2.0);
    o.up[i] = fuzz_real(f, -1.0, 1.0);
  }
  o.interpolation = (stratus_interpolation)fuzz_choice(f, 2);
  fuzz_clipping(f, &o.clipping, &c->field);
  if (fuzz_chance(f, 0.2)) {
    uint8_t* mask = malloc(c->field.values + 1);
    for (size_t i = 0; mask && i < c->field.values; ++i) {
      mask[i] = (uint8_t)fuzz_below(f, 3);
    }
    o.mask.bytes = fuzz_input(f, mask, c->field.values);
    o.mask.revision = fuzz_below(f, 2);
    o.mask.label_count = fuzz_odd(f) ? fuzz_integer(f, -1, 256) : 0;
    free(mask);
  }
  o.block_size = fuzz_chance(f, 0.5) ? 0 : fuzz_integer(f, 1, 9);
  return o;
}

static stratus_status draw(fuzz* f, stratus_context* context, stratus_path_tracer* tracer, const path_case* c, const stratus_image* image,
  stratus_path_report* report)
{
  const stratus_volume* v = &c->field.view;
  const stratus_volume* volume = fuzz_pointer(f, FUZZ_INPUT(f, c->field.view));
  const stratus_transfer* transfer = fuzz_pointer(f, c->transfer);
  const stratus_camera* camera = fuzz_pointer(f, FUZZ_INPUT(f, c->camera));
  const stratus_path_options* options = FUZZ_INPUT(f, c->options);
  const stratus_image* into = fuzz_pointer(f, FUZZ_INPUT(f, *image));
  fuzz_about(f,
    "paths, %d samples, %d bounces, albedo %g, %d lights, interpolation %d, mask %d, crop %d, clips %d, block size %d, opaque %d; %lld x "
    "%lld x %lld of type %d, %d components, cells %d, ghosts %d %d",
    options->samples, options->bounces, options->albedo, options->light_count, (int)options->interpolation, options->mask.bytes != NULL,
    options->clipping.crop, options->clipping.clip_plane_count, options->block_size, image->opaque_depth != NULL,
    (long long)v->dimensions[0], (long long)v->dimensions[1], (long long)v->dimensions[2], (int)v->type, v->components, v->cell_centered,
    v->point_ghosts != NULL, v->cell_ghosts != NULL);
  ++f->tally->pictures;
  return STATUS_OF(context, stratus_path_tracer_render(tracer, volume, transfer, camera, options, into, report));
}

static void step(fuzz* f, stratus_path_tracer* tracer, const path_case* c)
{
  const stratus_image image = fuzz_image(f, 1 + (int)fuzz_below(f, 12), 1 + (int)fuzz_below(f, 12), &c->camera);
  stratus_path_report* report = fuzz_output(f, sizeof *report);
  float* errors = fuzz_output(f, 4 * sizeof *errors * (size_t)(image.width * image.height));
  if (fuzz_chance(f, 0.15)) {
    fuzz_trouble(f);
  }
  stratus_status status = draw(f, f->context, tracer, c, &image, report);
  const bool troubled = f->memory.refused + f->progress.cancelled > 0;
  fuzz_calm(f);
  EXPECT(status == STRATUS_OK || status == STRATUS_UNSUPPORTED || troubled || !fuzz_is_tame(f), "%s: %s", stratus_status_name(status),
    stratus_context_message(f->context));
  if (troubled || status != STRATUS_OK) {
    return;
  }
  fuzz_check_image(f, &image, (fuzz_limits){ .lit = true, .surfaces = true, .behind = c->camera.parallel });
  EXPECT(STATUS(stratus_path_tracer_errors(tracer, errors)) == STRATUS_OK, "an image without errors");
  EXPECT(report->samples >= 1 && !(report->standard_error > report->largest_error), "%llu samples, error %g, %g at most",
    (unsigned long long)report->samples, report->standard_error, report->largest_error);
  for (int i = 0; i < 4 * image.width * image.height; ++i) {
    EXPECT(isnan(errors[i]) == (report->samples == 1) && !(errors[i] < 0.0f), "error %d is %g", i, (double)errors[i]);
  }
  if (!fuzz_is_tame(f)) {
    return;
  }
  fuzz_memory memory; /* other threads and memory; as many samples in one call */
  stratus_context* context = fuzz_context(f, &memory);
  stratus_path_tracer* other = NULL;
  const stratus_image again = fuzz_image_like(f, &image);
  path_case whole = *c;
  whole.options.samples = (int)report->samples;
  whole.options.tolerance = 0.0;
  EXPECT(STATUS_OF(context, stratus_path_tracer_create(context, &other)) == STRATUS_OK, "no tracer");
  EXPECT(draw(f, context, other, &whole, &again, NULL) == STRATUS_OK, "a new tracer refuses it");
  fuzz_check_same(f, &image, &again, true, "a new tracer");
  CALL(stratus_path_tracer_destroy(other));
  fuzz_context_close(f, context, &memory);
}

void fuzz_paths(fuzz* f)
{
  path_case c = { .field = fuzz_volume(f, 9, fuzz_chance(f, 0.95) ? 1 : 2) };
  stratus_path_tracer* tracer = NULL;
  c.options = choose_options(f, &c);
  c.camera = fuzz_camera(f, c.field.bounds);
  c.transfer = fuzz_transfers(f, 1, c.field.low, c.field.high, c.field.edge);
  if (CREATE(&tracer, stratus_path_tracer_create(f->context, &tracer)) != STRATUS_OK) {
    return;
  }
  const uint64_t steps = 1 + fuzz_below(f, 4);
  for (uint64_t s = 0; s < steps; ++s) {
    step(f, tracer, &c);
    switch (fuzz_below(f, 5)) {
      case 0:
        c.camera = fuzz_camera(f, c.field.bounds);
        break;
      case 1:
        fuzz_volume_changes(f, &c.field);
        break;
      case 2:
        c.options = choose_options(f, &c);
        break;
      case 3:
        c.transfer = fuzz_transfers(f, 1, c.field.low, c.field.high, c.field.edge);
        break;
      default: /* more samples of the last image, or one of another size */
        break;
    }
  }
  CALL(stratus_path_tracer_destroy(tracer));
}
