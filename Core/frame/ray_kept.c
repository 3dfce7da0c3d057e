/* SPDX-License-Identifier: BSD-3-Clause
 * Joins what rays keep of several grids: the best value, a sum, or surfaces. */
#include "ray_kept.h"

#include "picture.h"
#include "ray_frame.h"
#include "tetra_caster.h"

#include <math.h>
#include <stdio.h>

bool stratus_kept_is(stratus_mode mode)
{
  return stratus_mode_is_extreme(mode) || stratus_mode_is_sum(mode) || mode == STRATUS_MODE_QUANTITIES;
}

stratus_mode stratus_kept_mode(const stratus_ray_cast_input* input)
{
  static const stratus_mode of_mesh[] = { STRATUS_MODE_COMPOSITE, STRATUS_MODE_MAXIMUM, STRATUS_MODE_MINIMUM, STRATUS_MODE_AVERAGE,
    STRATUS_MODE_ADDITIVE, STRATUS_MODE_ISOSURFACE, STRATUS_MODE_SLICE, STRATUS_MODE_FIRST_HIT, STRATUS_MODE_QUANTITIES };
  if (!input->tetra) {
    return input->options ? input->options->mode : STRATUS_MODE_COMPOSITE;
  }
  const stratus_tetra_mode mode = input->tetra_options ? input->tetra_options->mode : STRATUS_TETRA_COMPOSITE;
  return (unsigned)mode < sizeof of_mesh / sizeof *of_mesh ? of_mesh[mode] : STRATUS_MODE_COMPOSITE;
}

stratus_status stratus_kept_create(stratus_kept* kept)
{
  void* memory = NULL;
  if (!stratus_kept_is(kept->mode)) {
    return stratus_layers_create(kept->context, kept->image, &kept->layers);
  }
  TRY(stratus_allocate(kept->context, (size_t)kept->image->width * (size_t)kept->image->height, sizeof *kept->pixels, &memory));
  kept->pixels = memory;
  return STRATUS_OK;
}

void stratus_kept_destroy(stratus_kept* kept)
{
  stratus_layers_destroy(kept->context, &kept->layers);
  stratus_release(kept->context, kept->pixels);
  kept->pixels = NULL;
}

stratus_status stratus_kept_part_create(const stratus_kept* kept, stratus_image* part)
{
  stratus_image like = *kept->image;
  float depth = 0.0f;
  uint32_t samples = 0;
  like.depth = &depth;
  like.samples = kept->mode == STRATUS_MODE_QUANTITIES ? &samples : like.samples;
  return stratus_image_part_create(kept->context, &like, part);
}

void stratus_kept_begin(stratus_kept* kept, int component)
{
  const size_t pixels = (size_t)kept->image->width * (size_t)kept->image->height;
  for (size_t i = 0; kept->pixels && i < pixels; ++i) {
    kept->pixels[i] = (stratus_kept_pixel){ .depth = INFINITY, .of = -1 };
  }
  kept->component = component;
  kept->any = false;
  kept->low = kept->high = kept->base = 0.0;
}

/* ---- drawing */

float stratus_kept_least(const stratus_ray_cast_options* options)
{
  return (float)(options->sampling.termination > 0.0 ? 1.0 - options->sampling.termination
                                                     : stratus_ray_termination(options->sampling.tolerance));
}

bool stratus_kept_ends(const stratus_kept* kept, int n, const stratus_image* image, const stratus_camera* camera, const int window[4],
  float least, float* ends, bool* wanted)
{
  const bool may_end = isfinite(camera->far_k) && (camera->parallel || camera->near_k > 0.0);
  bool any = false;
  *wanted = image->opaque_depth != NULL;
  for (int y = window[2]; y < window[3]; ++y) {
    const size_t row = (size_t)y * (size_t)image->width;
    for (int x = window[0]; x < window[1]; ++x) {
      const size_t pixel = row + (size_t)x;
      const bool seen =
        !kept ? 1.0f - image->rgba[4 * pixel + 3] > least : kept->pixels || stratus_layers_wanted(&kept->layers, pixel, n, kept->pass);
      *ends++ = !seen ? 0.0f : image->opaque_depth ? image->opaque_depth[pixel] : 1.0f;
      any = any || seen;
      *wanted = *wanted || (!seen && may_end);
    }
  }
  return any;
}

stratus_status stratus_kept_draw(stratus_kept* kept, int n, const stratus_camera* camera, const stratus_ray_cast_options* options,
  const stratus_image* part, stratus_ray_cast_report* report)
{
  const stratus_ray_cast_input* in = &kept->inputs[n];
  const stratus_ray_caster* caster = NULL;
  TRY(
    stratus_ray_render_kept(in->caster, in->volume, in->transfer, kept->component, kept->pass + 1, camera, options, part, &caster, report));
  if (caster->field.ranges) {
    const stratus_value_range* ranges = stratus_mode_is_sum(kept->mode) ? stratus_ray_range_of(&caster->field, 0) : caster->field.ranges;
    kept->bias = ranges->bias;
    kept->part_low = (double)ranges->whole_lo + kept->bias;
    kept->part_high = (double)ranges->whole_hi + kept->bias;
  }
  return STRATUS_OK;
}

stratus_status stratus_kept_draw_mesh(
  stratus_kept* kept, int n, const stratus_camera* camera, const stratus_image* part, stratus_ray_cast_report* report)
{
  const stratus_ray_cast_input* in = &kept->inputs[n];
  stratus_tetra_report of_mesh = { 0 };
  TRY(stratus_tetra_caster_render_kept(
    in->tetra, in->mesh, in->transfer, kept->component, kept->pass + 1, camera, in->tetra_options, part, &kept->bias, &of_mesh));
  report->rays = of_mesh.rays;
  report->samples = of_mesh.segments;
  report->cast_ms = of_mesh.transform_ms + of_mesh.entries_ms + of_mesh.march_ms;
  report->window[1] = part->width;
  report->window[3] = part->height;
  snprintf(report->why, sizeof report->why, "a mesh of %lld cells: %s", (long long)of_mesh.cells, of_mesh.why);
  return STRATUS_OK;
}

/* ---- joining */

/* Widens the range of one field by a part's, before the part is joined. */
static void widen(stratus_kept* kept)
{
  const bool known = kept->part_low <= kept->part_high; /* else the part has no finite value */
  if (known && !kept->any) {
    kept->base = kept->low = kept->part_low;
    kept->high = kept->part_high;
  } else if (known) {
    kept->low = fmin(kept->low, kept->part_low);
    kept->high = fmax(kept->high, kept->part_high);
  }
  kept->any = kept->any || known;
}

/* Whether a value shows in its input's function. */
static bool shows(const stratus_kept* kept, int n, double value)
{
  double rgba[4];
  stratus_transfer_at(kept->inputs[n].transfer + kept->component, value, rgba);
  return rgba[3] > 0.0;
}

static void join_best(const stratus_kept* kept, int n, const float rgba[4], float depth, stratus_kept_pixel* pixel)
{
  const double value = (double)rgba[0] + kept->bias;
  const bool better = pixel->of < 0 || (kept->mode == STRATUS_MODE_MINIMUM ? value < pixel->value : value > pixel->value);
  const bool equal = pixel->of >= 0 && !(value < pixel->value) && !(value > pixel->value);
  if ((better || (equal && depth < pixel->depth)) && (kept->one_field || shows(kept, n, value))) {
    *pixel = (stratus_kept_pixel){ .value = value, .depth = depth, .color = { rgba[1], rgba[2], rgba[3] - 1.0f }, .of = n };
  }
}

static void join_sum(const stratus_kept* kept, int n, const float rgba[4], float depth, stratus_kept_pixel* pixel)
{
  double value = (double)rgba[0];
  if (kept->one_field) { /* the part's grey spans its own range */
    value = value * (kept->part_high - kept->part_low) + (double)rgba[2] * (kept->part_low - kept->base);
  } else if (kept->mode == STRATUS_MODE_ADDITIVE) {
    value /= kept->inputs[n].transfer[kept->component].unit_distance;
  }
  pixel->value += value;
  pixel->length += (double)rgba[1];
  pixel->weight += (double)rgba[2];
  pixel->depth = fminf(pixel->depth, depth);
  pixel->of = pixel->of < 0 ? n : pixel->of;
}

static void join_quantities(const stratus_kept* kept, int n, const float rgba[4], float depth, uint32_t cells, stratus_kept_pixel* pixel)
{
  const double largest = (double)rgba[0] + kept->bias;
  if (pixel->of < 0 || largest > pixel->value || (!(largest < pixel->value) && depth < pixel->depth)) {
    pixel->value = largest;
    pixel->depth = depth;
  }
  pixel->weight += (double)rgba[1] + kept->bias * (double)rgba[2];
  pixel->length += (double)rgba[2];
  pixel->cells += (float)cells;
  pixel->of = n;
}

void stratus_kept_report(const stratus_kept* kept, stratus_ray_cast_report* sum, const stratus_ray_cast_report* report)
{
  if (kept->pass > 0) { /* of the caster that has drawn the nearer surfaces: builds, blocks and rays are the same */
    sum->samples += report->samples;
    sum->skipped += report->skipped;
    sum->lookups += report->lookups;
    sum->differing_pixels += report->differing_pixels;
    sum->upload_ms += report->upload_ms;
    sum->cast_ms += report->cast_ms;
  } else if (kept->component > 0) {
    stratus_ray_cast_report_add(sum, report);
  } else {
    *sum = *report;
  }
}

/* Joins pixel number `from` of a part. */
static void join_pixel(const stratus_kept* kept, int n, const stratus_image* part, size_t from, stratus_kept_pixel* pixel)
{
  const float *rgba = part->rgba + 4 * from, depth = part->depth[from];
  if (!(rgba[3] > 0.0f)) {
    return;
  }
  if (kept->mode == STRATUS_MODE_QUANTITIES) {
    join_quantities(kept, n, rgba, depth, part->samples[from], pixel);
  } else if (stratus_mode_is_extreme(kept->mode)) {
    join_best(kept, n, rgba, depth, pixel);
  } else {
    join_sum(kept, n, rgba, depth, pixel);
  }
}

stratus_status stratus_kept_join(stratus_kept* kept, int n, const stratus_image* part, int x0, int y0, const int inside[4])
{
  const stratus_image* image = kept->image;
  if (kept->one_field) {
    widen(kept);
  }
#pragma omp parallel for num_threads(kept->context->threads)
  for (int y = inside[2]; y < inside[3]; ++y) {
    for (int x = inside[0]; x < inside[1]; ++x) {
      const size_t from = (size_t)y * (size_t)part->width + (size_t)x, to = (size_t)(y0 + y) * (size_t)image->width + (size_t)(x0 + x);
      if (image->samples) {
        image->samples[to] += part->samples[from];
      }
      if (kept->pixels) {
        join_pixel(kept, n, part, from, kept->pixels + to);
      }
    }
  }
  return kept->pixels ? STRATUS_OK : stratus_layers_join(kept->context, &kept->layers, n, image, part, x0, y0, inside);
}

/* ---- colours */

/* Whether an input's components are one medium. */
static bool is_dependent(const stratus_ray_cast_input* input)
{
  return input->tetra ? input->tetra_options && stratus_tetra_draws_last(input->mesh, input->tetra_options)
                      : input->options && input->options->optics.dependent && stratus_volume_components(input->volume) > 1;
}

static void color_best(const stratus_kept* kept, stratus_kept_pixel* pixel, float rgba[4])
{
  double color[4];
  stratus_transfer_at(kept->inputs[pixel->of].transfer + kept->component, pixel->value, color);
  for (int c = 0; is_dependent(&kept->inputs[pixel->of]) && c < 3; ++c) {
    color[c] = (double)pixel->color[c];
  }
  for (int c = 0; c < 4; ++c) {
    rgba[c] = (float)(c < 3 ? color[c] * color[3] : color[3]);
  }
  if (!(color[3] > 0.0)) {
    pixel->depth = INFINITY;
  }
}

static void color_sum(const stratus_kept* kept, const stratus_kept_pixel* pixel, float rgba[4])
{
  const stratus_transfer* transfer = kept->inputs[pixel->of].transfer + kept->component;
  const bool mean = kept->mode == STRATUS_MODE_AVERAGE;
  double grey = pixel->value;
  if (kept->one_field) {
    const double extent = kept->high - kept->low;
    grey = extent > 0.0 && isfinite(extent) ? (grey + pixel->weight * (kept->base - kept->low)) / extent : 0.0;
    grey = mean ? grey : grey / transfer->unit_distance;
  }
  if (mean) {
    grey = pixel->length > 0.0 ? grey / pixel->length : 0.0;
  }
  const bool any = !mean || pixel->length > 0.0;
  rgba[0] = rgba[1] = rgba[2] = any ? (float)fmin(fmax(grey, 0.0), 1.0) : 0.0f;
  rgba[3] = any ? 1.0f : 0.0f;
}

void stratus_kept_finish(const stratus_kept* kept)
{
  const stratus_image* image = kept->image;
  const int64_t pixels = (int64_t)image->width * image->height;
  const bool opaque = !stratus_mode_is_extreme(kept->mode);
  if (!kept->pixels) {
    stratus_layers_finish(kept->context, &kept->layers, image);
    return;
  }
#pragma omp parallel for num_threads(kept->context->threads)
  for (int64_t i = 0; i < pixels; ++i) {
    stratus_kept_pixel* pixel = kept->pixels + i;
    float add[4];
    if (pixel->of < 0) {
      continue;
    }
    if (kept->mode == STRATUS_MODE_QUANTITIES) {
      const double numbers[4] = { pixel->value, pixel->weight, pixel->length, (double)pixel->cells };
      for (int c = 0; c < 4; ++c) {
        image->rgba[4 * i + c] = (float)numbers[c];
      }
    } else {
      const float weight = (float)kept->inputs[pixel->of].transfer[kept->component].weight;
      if (stratus_mode_is_extreme(kept->mode)) {
        color_best(kept, pixel, add);
      } else {
        color_sum(kept, pixel, add);
      }
      stratus_pixel_add(image->rgba + 4 * i, add, weight, opaque);
    }
    if (image->depth) {
      image->depth[i] = fminf(image->depth[i], pixel->depth);
    }
  }
}
