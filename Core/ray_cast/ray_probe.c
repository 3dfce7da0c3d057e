/* SPDX-License-Identifier: BSD-3-Clause
 * Measures which sampling a scene needs: draws a thousand or so rays with a few settings and with a finer one, and takes the cheapest that
 * keeps the tolerance. No statistics are asked, so that whatever a picture shows, colour and light included, counts by itself. */
#include "ray_probe.h"

#include "ray_cast_host.h"
#include "ray_fetched.h"
#include "ray_frame.h"
#include "ray_modes_render.h"
#include "ray_probe_rays.h"
#include "ray_shading_render.h"
#include "tiles.h"

#include <stdio.h>
#include <string.h>

/* Rungs of the step: rung r is a step of 2^(COARSEST - r/4) voxels. */
#define COARSEST 2.0
#define RUNGS 25
/* The rung of the finer setting that candidates are compared with, and how much finer it must be than a candidate. */
#define RUNG_ONE_VOXEL 8
/* The error on the probe's rays may be at most this share of the tolerance: other rays err by more. */
#define SHARE 0.6
/* Rays as many as one patch has. */
#define PATCH (STRATUS_PROBE_WIDTH * STRATUS_PROBE_HEIGHT)

typedef struct setting {
  stratus_sampling sampling;
  int rung;
} setting;

/* What a family of settings has shown so far: one sampling rule at all its rungs. */
typedef struct family {
  stratus_sampling sampling;
  double cost;         /* of a sample, in those of the midpoint rule */
  double error[RUNGS]; /* root mean square on the probe's rays; -1: not measured */
  double samples[RUNGS];
} family;

typedef struct probe {
  stratus_ray_caster* caster;
  const stratus_volume* volume;
  const stratus_ray_cast_options* options;
  stratus_ray_cast_options whole; /* the same without what hides parts: a setting serves whatever part is shown */
  stratus_probe_patch patches[STRATUS_PROBE_PATCHES];
  int count;
  double voxel;
  float *fine, *coarse; /* pictures of all patches: of the finer setting, and of the candidate */
  uint64_t samples;     /* of all settings together */
  int tried;
} probe;

static double step_of(int rung)
{
  return exp2(COARSEST - 0.25 * rung);
}

static double distance_of(const probe* p, int rung)
{
  return p->options->sample_distance > 0.0 ? p->options->sample_distance : step_of(rung) * p->voxel;
}

/* ---- drawing */

typedef struct patch_job {
  const probe* p;
  float* pictures;
  double distance;
  stratus_ray_variant variant;
  int type;
} patch_job;

/* Sets the arguments of a patch as far as they can be wrong. *rgba: where its picture lies. */
static stratus_status begin_patch(const patch_job* job, int number, stratus_ray_cast_arguments* a, float** rgba, bool* empty)
{
  *rgba = job->pictures + 4 * (size_t)PATCH * (size_t)number;
  const stratus_image image = { .width = STRATUS_PROBE_WIDTH, .height = STRATUS_PROBE_HEIGHT, .rgba = *rgba };
  return stratus_ray_frame_arguments(
    job->p->caster->context, &job->p->caster->traversed, &job->p->patches[number].camera, &job->p->whole, &image, job->distance, a, empty);
}

static void draw_patch(const void* data, int number, uint64_t counts[STRATUS_TILE_COUNTS])
{
  const patch_job* job = data;
  const stratus_ray_caster* caster = job->p->caster;
  const stratus_camera* camera = &job->p->patches[number].camera;
  const stratus_ray_cast_options* options = &job->p->whole;
  stratus_ray_cast_arguments a;
  stratus_ray_counts mine = { 0 };
  float* rgba;
  bool empty = false;
  if (begin_patch(job, number, &a, &rgba, &empty) != STRATUS_OK || empty) {
    memset(rgba, 0, 4 * PATCH * sizeof *rgba);
    return;
  }
  a.values.has_hidden = caster->hides;
  stratus_ray_modes_arguments(caster, options, &a);
  stratus_ray_shading_arguments(caster, job->p->volume, camera, options, &a);
  stratus_ray_frame_structures(caster->table, caster->occupancy, caster->map, &a);
  const void* const table = caster->table->sums ? (const void*)caster->table->sums : (const void*)caster->table->rgba;
  const stratus_ray_cast_frame frame = { .arguments = &a,
    .values = caster->traversed.values,
    .hidden = caster->hidden,
    .map = caster->map ? caster->map->bytes : NULL,
    .table = caster->shades ? caster->shading_tables.memory : table,
    .rgba = rgba };
  stratus_ray_cast_tile_for(caster->context->isa, job->type, job->variant)(&frame, 0, 0, STRATUS_PROBE_WIDTH, STRATUS_PROBE_HEIGHT, &mine);
  counts[1] += mine.samples;
}

/* Draws all patches with a setting. *samples: the values that were interpolated. */
static stratus_status draw_patches(probe* p, const setting* s, float* pictures, double* samples)
{
  stratus_ray_caster* caster = p->caster;
  uint64_t sums[STRATUS_TILE_COUNTS];
  caster->choice.sampling = s->sampling;
  caster->choice.sample_distance = distance_of(p, s->rung);
  TRY(stratus_ray_update_table(caster, p->options));
  const stratus_ray_variant light = caster->table->sums ? STRATUS_VARIANT_SHADING_PREINTEGRATED : STRATUS_VARIANT_SHADING_MIDPOINT;
  const patch_job job = { .p = p,
    .pictures = pictures,
    .distance = caster->choice.sample_distance,
    .variant = caster->shades ? light : stratus_ray_modes_variant(caster),
    .type = stratus_ray_fetch_type(&caster->traversed) };
  stratus_ray_cast_arguments unused;
  float* picture;
  bool empty;
  TRY(begin_patch(&job, 0, &unused, &picture, &empty)); /* what fails for one patch, a step too short, fails for all */
  TRY(stratus_each_tile(caster->context, "sampling", p->count, draw_patch, &job, sums));
  *samples = (double)sums[1];
  p->samples += sums[1];
  ++p->tried;
  return STRATUS_OK;
}

/* ---- judging */

/* Returns the root mean square difference between candidate and finer setting, over the rays that either lights. */
static double error_of(const probe* p)
{
  double squares = 0.0, lit = 0.0;
  for (int n = 0; n < p->count; ++n) {
    for (size_t ray = 0; ray < PATCH; ++ray) {
      const float* a = p->fine + 4 * ((size_t)n * PATCH + ray);
      const float* b = p->coarse + 4 * ((size_t)n * PATCH + ray);
      double square = 0.0;
      for (int c = 0; c < 4; ++c) {
        square += ((double)a[c] - (double)b[c]) * ((double)a[c] - (double)b[c]);
      }
      squares += p->patches[n].weight * square;
      lit += p->patches[n].weight * (a[3] > 0.0f || b[3] > 0.0f);
    }
  }
  return lit > 0.0 ? sqrt(squares / (4.0 * lit)) : 0.0;
}

static stratus_status measure(probe* p, family* f, int rung)
{
  if (f->error[rung] < 0.0) {
    const setting s = { f->sampling, rung };
    TRY(draw_patches(p, &s, p->coarse, &f->samples[rung]));
    f->error[rung] = error_of(p);
  }
  return STRATUS_OK;
}

/* Finds the coarsest rung of a family that keeps `most`, by steps of as many rungs as the error asks for. Errors are taken to fall with the
 * square of the step. *best: -1 if none does. */
static stratus_status search(probe* p, family* f, double most, int start, int* best)
{
  int low = 0, high = RUNGS - 1; /* the rung is in low..high, if there is one */
  int rung = start;
  *best = -1;
  while (low <= high) {
    TRY(measure(p, f, rung));
    const double error = f->error[rung], excess = error > 0.0 ? 2.0 * log2(error / most) : -RUNGS; /* in rungs */
    if (error <= most) {
      *best = rung;
      high = rung - 1;
      const int by = (int)floor(-excess);
      if (by < 1) {
        break; /* the next coarser rung would miss */
      }
      rung -= by;
    } else {
      low = rung + 1;
      rung += (int)ceil(fmin(excess, RUNGS));
    }
    rung = rung < low ? low : rung > high ? high : rung;
  }
  return STRATUS_OK;
}

/* Measures a family at the step that the user set, or finds its coarsest rung that keeps `most`. *best: -1 if none does. */
static stratus_status search_family(probe* p, family* f, double most, int* best)
{
  for (int r = 0; r < RUNGS; ++r) {
    f->error[r] = -1.0;
  }
  if (p->options->sample_distance > 0.0) {
    TRY(measure(p, f, 0));
    *best = f->error[0] <= most ? 0 : -1;
    return STRATUS_OK;
  }
  return search(p, f, most, RUNG_ONE_VOXEL, best);
}

/* Takes the cheapest of the settings that keep the tolerance, else the finest. */
static stratus_status choose(probe* p, stratus_ray_choice* choice)
{
  static const double costs[] = { [STRATUS_SAMPLING_MIDPOINT] = 1.0, [STRATUS_SAMPLING_PREINTEGRATED] = 1.8 };
  stratus_ray_caster* caster = p->caster;
  const stratus_ray_cast_options* options = p->options;
  const bool preintegrates = stratus_ray_can_sample(caster, options, STRATUS_SAMPLING_PREINTEGRATED);
  const setting fine = { preintegrates ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT, RUNGS - 1 };
  const double most = SHARE * options->tolerance;
  double least = INFINITY, unused;
  int at = 0;
  TRY(draw_patches(p, &fine, p->fine, &unused));
  choice->sampling = fine.sampling;
  choice->sample_distance = distance_of(p, fine.rung);
  choice->met = false;
  choice->expected_error = NAN;
  for (stratus_sampling rule = STRATUS_SAMPLING_MIDPOINT; rule <= STRATUS_SAMPLING_PREINTEGRATED; ++rule) {
    family f = { .sampling = rule, .cost = costs[rule] };
    int best;
    if (!stratus_ray_can_sample(caster, options, rule) ||
      (preintegrates && options->sampling != STRATUS_SAMPLING_AUTO && options->sampling != rule)) {
      continue;
    }
    TRY(search_family(p, &f, most, &best));
    for (int r = 0; r < RUNGS; ++r) {
      if (f.error[r] >= 0.0) {
        at += snprintf(caster->tried + at, sizeof caster->tried - (size_t)at, "%s%s %.3g voxels %.2g", at ? ", " : "tried ",
          stratus_sampling_name(rule), distance_of(p, r) / p->voxel, f.error[r]);
        at = at < (int)sizeof caster->tried ? at : (int)sizeof caster->tried - 1;
      }
    }
    if (best >= 0 && f.cost * f.samples[best] < least) {
      least = f.cost * f.samples[best];
      choice->sampling = rule;
      choice->sample_distance = distance_of(p, best);
      choice->expected_error = f.error[best];
      choice->met = true;
    }
  }
  return STRATUS_OK;
}

/* Draws the picture of this frame with the setting that was measured last, where there is one that can draw it. The next frame measures. */
static void keep_last(stratus_ray_caster* caster, const stratus_ray_cast_options* options)
{
  if (caster->measured.sample_distance > 0.0 && stratus_ray_can_sample(caster, options, caster->measured.sampling)) {
    caster->choice = caster->measured;
  }
  caster->choice.expected_error = NAN;
  caster->choice.met = false;
  caster->choice.provisional = true;
  snprintf(caster->tried, sizeof caster->tried, "no memory to measure what the tolerance needs, the last setting stays");
  stratus_log(caster->context, STRATUS_LOG_WARNING, "no memory to measure what the tolerance needs: the last setting stays");
}

stratus_status stratus_ray_probe(
  stratus_ray_caster* caster, const stratus_volume* volume, const stratus_ray_cast_options* options, stratus_ray_cast_report* report)
{
  const double start = stratus_now_ms();
  probe p = { .caster = caster, .volume = volume, .options = options, .whole = *options, .voxel = stratus_ray_voxel_length(volume) };
  const stratus_ray_choice provisional = caster->choice;
  stratus_ray_choice choice = provisional;
  void* memory = NULL;
  p.whole.crop = p.whole.clip_plane_count = p.whole.jitter = 0;
  caster->tried[0] = '\0';
  stratus_status status = stratus_ray_probe_rays(caster, p.patches, &p.count);
  if (status == STRATUS_OK && p.count > 0) {
    status = stratus_allocate(caster->context, 2 * 4 * (size_t)PATCH * (size_t)p.count, sizeof(float), &memory);
  }
  if (status == STRATUS_OUT_OF_MEMORY) {
    keep_last(caster, options);
    return stratus_ray_update_table(caster, options);
  }
  TRY(status);
  if (p.count > 0) {
    p.fine = memory;
    p.coarse = p.fine + 4 * (size_t)PATCH * (size_t)p.count;
    status = choose(&p, &choice);
    stratus_release(caster->context, memory);
  }
  caster->choice = status == STRATUS_OK ? choice : provisional;
  TRY(status);
  caster->choice.provisional = false;
  caster->probe_builds += p.count > 0;
  caster->measured = caster->choice;
  TRY(stratus_ray_update_table(caster, options));
  report->probe_samples = p.samples;
  report->probe_ms = stratus_now_ms() - start;
  return STRATUS_OK;
}
