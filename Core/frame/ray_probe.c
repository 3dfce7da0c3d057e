/* SPDX-License-Identifier: BSD-3-Clause
 * Measures which sampling a scene needs: draws a thousand or so rays with a few settings and with a finer one, and takes the cheapest that
 * keeps the tolerance. No statistics are asked, so that whatever a picture shows, colour and light included, counts by itself. */
#include "ray_probe.h"

#include "lights.h"
#include "picture.h"
#include "ray_cast_host.h"
#include "ray_fetched.h"
#include "ray_frame.h"
#include "ray_modes_render.h"
#include "ray_probe_rays.h"
#include "ray_shading_render.h"
#include "tiles.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Rung r of a lattice is a step of 2^(2 - r/4) voxels, rung r of cells an error of 2^(-2 - r/2): rungs 0..24 and 0..30. By either, two
 * rungs halve the error where it falls with the square of the step, or with the cell's error. */
#define LATTICE_RUNGS 25
#define CELL_RUNGS 31
#define ONE_VOXEL 8
/* The finer setting with which candidates are compared. On a lattice it has steps of this rung at first. At least FINER_BY rungs are
 * between it and the chosen setting, or it is made finer by as many: beyond the finest setting of images, too. For cells, its error is the
 * tolerance times CELL_SHARE. Rays end by that tolerance, too, also the candidates' rays, so that only sampling is compared. */
#define LATTICE_FINE 14
#define FINER_BY 6
#define CELL_SHARE 0.125
/* An error falls by some power of the step, between 1 where light or the function's ends meet it and 2. The finer setting's own error,
 * which the comparison hides, is reckoned by the mean of the two. */
#define ORDER 1.5
/* A candidate passes if its error's mean plus CONFIDENCE standard errors, by the probe's rays, is at most this share of the tolerance. */
#define CONFIDENCE 1.5
#define SHARE 0.65
/* An error that rises by less over rungs of cells has come to rest. */
#define SETTLED 1.1
/* The rung from which the step of smooth blocks is sought: two voxels. */
#define LOCAL_START 4
/* Rule local is for few rough blocks: at most LOCAL_MOST of all. It is chosen if it costs less than LOCAL_GAIN of the next best rule: its
 * cost does not contain the switches between cells and samples, and the lookups of their borders. */
#define LOCAL_MOST 0.5
#define LOCAL_GAIN 0.75
/* Rule local's allowed error on the probe's rays, as a share of other rules' allowed error. It is half, because two parts of the rule err,
 * and few rays meet an error of few blocks. */
#define LOCAL_SHARE 0.5
/* Rung l of light is a spread of 2^(-2 - l/2), l in 0..LIGHT_FINEST. While rules and steps are sought, it is the tolerance times
 * LIGHT_SOUGHT, and errors may be LIT_SHARE of the allowed error, so that there is room for a coarser one. The finer setting's is the
 * tolerance times LIGHT_COMPARED. An error falls by about the power 2/3 of the spread. */
#define LIGHT_FINEST 40
#define LIGHT_SOUGHT 0x1p-6
#define LIGHT_COMPARED 0x1p-10
#define LIT_SHARE 0.7
/* Where the tolerance is missed by light, so many times the finest setting's error is allowed. */
#define NEARLY 1.1
/* A function hardly bends if one sample a voxel errs by no more than this, at whatever tolerance. A limit that rose with the tolerance
 * would replace long pre-integrated steps by shorter ones at a looser tolerance. */
#define FLAT (SHARE * 1e-3)
/* The least cost of pre-integrated steps shorter than a voxel, over the cost of cells. */
#define DENSE 1.01
#define PATCH (STRATUS_PROBE_WIDTH * STRATUS_PROBE_HEIGHT)

/* Reads of memory: a sample fetches a cell and reads an entry, or two of running sums, which are neighbours in rule local; a cell takes
 * pieces of two entries each. A line crosses 1.5 cubes in the length of an edge, the mean over all directions. */
static const double costs[] = { [STRATUS_SAMPLING_MIDPOINT] = 1.0,
  [STRATUS_SAMPLING_PREINTEGRATED] = 1.6,
  [STRATUS_SAMPLING_CELLS] = 1.5 * 2.2,
  [STRATUS_SAMPLING_LOCAL] = 1.3 };

typedef struct setting {
  stratus_sampling sampling;
  int rung;
  int cells;  /* local: the rung of cells in rough blocks */
  int light;  /* cells, local, lit: the rung of light */
  bool finer; /* it is what others are compared with, and has a light of its own */
} setting;

/* The results of one sampling rule so far, at all its rungs. */
typedef struct family {
  stratus_sampling sampling;
  int rungs;                /* 1 where the user has set the step */
  double cost;              /* of a voxel's length, at a step of one voxel, in samples of the midpoint rule */
  int cells;                /* as in setting */
  int beyond;               /* local: blocks of classes below it are rough; else 0 */
  double rough;             /* local: the share of rough blocks */
  double error[CELL_RUNGS]; /* root mean square on the probe's rays; -1: not measured */
} family;

typedef struct probe {
  stratus_ray_caster* caster;
  const stratus_volume* volume;
  const stratus_ray_cast_options* options;
  /* The same without what hides parts: a setting serves whatever part is shown. Rays end by its tolerance. */
  stratus_ray_cast_options whole;
  stratus_probe_patch patches[STRATUS_PROBE_PATCHES];
  int count;
  stratus_probe_classes classes;
  stratus_distance_map* rough[STRATUS_PROBE_CLASSES]; /* number c: of the blocks of classes below c; NULL: not made */
  bool lit;                                           /* rays by cells are lit */
  bool by_cells;                                      /* rule cells is a candidate */
  double voxel;
  float *fine, *coarse; /* pictures of all patches: of the finer setting, and of the candidate */
  uint64_t samples;     /* of all settings together */
} probe;

/* Fill `choice` from a setting, with the values that the user has set instead. */
static void take(const probe* p, const setting* s, stratus_ray_choice* choice)
{
  const stratus_ray_cast_options* options = p->options;
  const bool cells = s->sampling == STRATUS_SAMPLING_CELLS;
  choice->sampling = s->sampling;
  const int cell_rung = s->sampling == STRATUS_SAMPLING_LOCAL ? s->cells : s->rung;
  choice->cell_error = options->sampling.cell_error > 0.0 ? options->sampling.cell_error : exp2(-2.0 - 0.5 * cell_rung);
  choice->light_spread = options->sampling.light_spread > 0.0 && !s->finer ? options->sampling.light_spread : exp2(-2.0 - 0.5 * s->light);
  choice->sample_distance = cells      ? p->voxel
    : options->sampling.distance > 0.0 ? options->sampling.distance
                                       : exp2(2.0 - 0.25 * s->rung) * p->voxel;
  choice->follows = (cells || !(options->sampling.distance > 0.0)) && stratus_ray_follows_voxels(&p->caster->field.traversed);
}

/* ---- drawing */

typedef struct patch_job {
  const probe* p;
  float* pictures;
  double distance, tolerance;
  bool follows;
  stratus_ray_variant variant;
  int type;
} patch_job;

/* Sets the arguments of a patch as far as they can be wrong, and its picture. */
static stratus_status begin_patch(const patch_job* job, int number, stratus_ray_cast_arguments* a, stratus_image* image, bool* empty)
{
  *image = (stratus_image){
    .width = STRATUS_PROBE_WIDTH, .height = STRATUS_PROBE_HEIGHT, .rgba = job->pictures + 4 * (size_t)PATCH * (size_t)number
  };
  return stratus_ray_frame_arguments(
    job->p->caster, &job->p->patches[number].camera, &job->p->whole, image, job->distance, job->follows, a, empty);
}

static void draw_patch(const void* data, int number, uint64_t counts[STRATUS_TILE_COUNTS])
{
  const patch_job* job = data;
  const stratus_ray_caster* caster = job->p->caster;
  const stratus_camera* camera = &job->p->patches[number].camera;
  const stratus_ray_cast_options* options = &job->p->whole;
  stratus_ray_cast_arguments a;
  stratus_ray_counts mine = { 0 };
  stratus_image image;
  bool empty = false;
  if (begin_patch(job, number, &a, &image, &empty) != STRATUS_OK || empty) {
    stratus_image_clear(&image);
    return;
  }
  a.values.has_hidden = caster->field.hides;
  stratus_ray_modes_arguments(&caster->integrator, &caster->optics, &caster->field, caster->structure.rough, options, &a);
  stratus_ray_shading_arguments(
    &caster->optics, &caster->field, caster->integrator.choice.sample_distance, job->p->volume, camera, options, &a);
  stratus_ray_frame_structures(
    &caster->field.grid, caster->optics.made.table, job->tolerance, caster->structure.occupancy, caster->structure.map, &a);
  const stratus_ray_cast_frame frame = stratus_ray_frame_of(caster, &a, &image, caster->structure.map != NULL);
  stratus_ray_cast_tile_for(caster->context->isa, job->type, job->variant)(&frame, 0, 0, STRATUS_PROBE_WIDTH, STRATUS_PROBE_HEIGHT, &mine);
  counts[1] += mine.samples;
}

stratus_status stratus_ray_make_rough(
  stratus_context* context, const stratus_probe_classes* classes, int beyond, stratus_distance_map** rough)
{
  stratus_occupancy* blocks = NULL;
  TRY(stratus_occupancy_below(context, classes->blocks, classes->block_size, classes->of, (uint8_t)beyond, &blocks));
  const stratus_status status = stratus_distance_map_create(context, blocks, STRATUS_DISTANCE_FULL, rough);
  stratus_occupancy_destroy(blocks);
  return status;
}

/* Makes the map of rough blocks for a setting the caster's, on loan. */
static stratus_status lend_rough(probe* p, int beyond)
{
  if (!p->rough[beyond]) {
    TRY(stratus_ray_make_rough(p->caster->context, &p->classes, beyond, &p->rough[beyond]));
  }
  p->caster->structure.rough = p->rough[beyond];
  return STRATUS_OK;
}

/* Draws all patches with a setting. */
static stratus_status draw_patches(probe* p, const setting* s, double tolerance, float* pictures)
{
  stratus_ray_caster* caster = p->caster;
  uint64_t sums[STRATUS_TILE_COUNTS];
  take(p, s, &caster->integrator.choice);
  TRY(stratus_ray_update_table(caster, p->options));
  const patch_job job = { .p = p,
    .pictures = pictures,
    .distance = caster->integrator.choice.sample_distance,
    .follows = caster->integrator.choice.follows,
    .tolerance = tolerance,
    .variant = stratus_ray_modes_variant(&caster->integrator, &caster->optics),
    .type = stratus_ray_fetch_type(&caster->field.traversed) };
  stratus_ray_cast_arguments unused;
  stratus_image picture;
  bool empty;
  TRY(begin_patch(&job, 0, &unused, &picture, &empty)); /* an error of one patch, a step too short, is an error of all */
  TRY(stratus_each_tile(caster->context, "sampling", p->count, draw_patch, &job, sums));
  p->samples += sums[1];
  return STRATUS_OK;
}

/* ---- judging */

/* Returns the root mean square difference between candidate and finer setting over the rays that either lights: its square is the mean of
 * the patches, weighted, plus CONFIDENCE standard errors of that mean. */
static double error_of(const probe* p)
{
  double squares[STRATUS_PROBE_PATCHES], lit[STRATUS_PROBE_PATCHES], all_squares = 0.0, all_lit = 0.0;
  for (int n = 0; n < p->count; ++n) {
    squares[n] = lit[n] = 0.0;
    for (size_t ray = 0; ray < PATCH; ++ray) {
      const float* a = p->fine + 4 * ((size_t)n * PATCH + ray);
      const float* b = p->coarse + 4 * ((size_t)n * PATCH + ray);
      double square = 0.0;
      for (int c = 0; c < 4; ++c) {
        square += ((double)a[c] - (double)b[c]) * ((double)a[c] - (double)b[c]);
      }
      squares[n] += p->patches[n].weight * square;
      lit[n] += p->patches[n].weight * 4.0 * (a[3] > 0.0f || b[3] > 0.0f);
    }
    all_squares += squares[n];
    all_lit += lit[n];
  }
  if (!(all_lit > 0.0)) {
    return 0.0;
  }
  const double mean = all_squares / all_lit;
  double variance = 0.0;
  for (int n = 0; n < p->count; ++n) {
    variance += (squares[n] - mean * lit[n]) * (squares[n] - mean * lit[n]);
  }
  return sqrt(mean + CONFIDENCE * sqrt(variance) / all_lit);
}

static void note(probe* p, const char* format, ...)
{
  char* tried = p->caster->tried;
  const size_t length = strlen(tried);
  va_list list;
  va_start(list, format);
  vsnprintf(tried + length, sizeof p->caster->tried - length, format, list);
  va_end(list);
}

/* Whether two rules err alike at the same rung: both take samples on a lattice, or both go from cell to cell. */
static bool alike(stratus_sampling a, stratus_sampling b)
{
  return (a == STRATUS_SAMPLING_CELLS) == (b == STRATUS_SAMPLING_CELLS);
}

/* The rung of light that is a part of the tolerance, or the next coarser one. */
static int light_rung(const probe* p, double part)
{
  const double rung = -2.0 * (log2(part * p->options->sampling.tolerance) + 2.0);
  return rung < 0.0 ? 0 : rung < LIGHT_FINEST ? (int)rung : LIGHT_FINEST;
}

static setting setting_of(const probe* p, const family* f, int rung)
{
  return (setting){ f->sampling, rung, f->cells, light_rung(p, LIGHT_SOUGHT), false };
}

static void forget(family* f)
{
  for (int r = 0; r < CELL_RUNGS; ++r) {
    f->error[r] = -1.0;
  }
}

static stratus_status measure(probe* p, family* f, int rung)
{
  const setting s = setting_of(p, f, rung);
  if (f->error[rung] < 0.0) {
    TRY(draw_patches(p, &s, p->options->sampling.tolerance, p->coarse));
    f->error[rung] = error_of(p);
    const stratus_ray_choice* c = &p->caster->integrator.choice;
    note(p, "%s%s %.3g: %.2g", *p->caster->tried ? ", " : "tried ", stratus_sampling_name(s.sampling),
      s.sampling == STRATUS_SAMPLING_CELLS ? c->cell_error : c->sample_distance / p->voxel, f->error[rung]);
    if (s.sampling == STRATUS_SAMPLING_LOCAL) {
      note(p, " (%.2g %% by cells)", 100.0 * f->rough);
    }
  }
  return STRATUS_OK;
}

/* The cost of a voxel's length. It is computed, not measured, because measured samples depend on the structure. Cells cost the same at
 * every rung, but for their pieces. Pre-integrated steps shorter than a voxel cost more than cells, because some rays take more of these
 * steps than they meet cells. A looser tolerance then never reads more than a tighter one. */
static double cost_of(const probe* p, const family* f, int rung)
{
  const setting s = setting_of(p, f, rung);
  stratus_ray_choice c;
  take(p, &s, &c);
  const bool dense = p->by_cells && f->sampling == STRATUS_SAMPLING_PREINTEGRATED && rung > ONE_VOXEL;
  const double lattice = fmax(f->cost * p->voxel / c.sample_distance, dense ? DENSE * costs[STRATUS_SAMPLING_CELLS] : 0.0);
  return f->sampling == STRATUS_SAMPLING_CELLS ? f->cost
    : f->sampling == STRATUS_SAMPLING_LOCAL    ? f->rough * costs[STRATUS_SAMPLING_CELLS] + (1.0 - f->rough) * lattice
                                               : lattice;
}

/* Returns the coarsest rung of cells. Values that are off by more than the tolerance's share of the function's range could show in rays
 * that graze a surface, and the probe may have none of these. */
static int coarsest_cells(const probe* p, const family* f)
{
  const double rung = -2.0 * (log2(p->options->sampling.tolerance) + 2.0);
  return rung < 0.0 ? 0 : rung < f->rungs - 1 ? (int)rung : f->rungs - 1;
}

/* The coarsest rung of a lattice: one voxel, or the mean free path of light where that is longer. A longer segment gets one colour where
 * only its front is seen, and the probe may have no ray where that shows. Local: only in smooth blocks, whose values differ little. */
static int coarsest_lattice(const probe* p, const family* f)
{
  const stratus_probe_classes* k = &p->classes;
  double depth = f->sampling == STRATUS_SAMPLING_LOCAL ? 0.0 : k->deepest;
  for (int c = f->beyond; f->sampling == STRATUS_SAMPLING_LOCAL && c < STRATUS_PROBE_CLASSES; ++c) {
    depth = fmax(depth, k->depth[c]);
  }
  const double rung = ceil(4.0 * (2.0 + log2(depth))); /* -INFINITY where nothing is opaque */
  return f->rungs == 1 || p->options->mode != STRATUS_MODE_COMPOSITE || !(rung > 0.0) ? 0 : rung < ONE_VOXEL ? (int)rung : ONE_VOXEL;
}

/* Find the coarsest rung of a family that keeps `most`, moving by as many rungs at a time as the error suggests. Gives up once the next
 * rung to be measured would cost more than `dear`. *best: -1 if no rung was found. */
static stratus_status search(probe* p, family* f, int start, double most, double dear, int* best)
{
  const bool cells = f->sampling == STRATUS_SAMPLING_CELLS;
  int low = cells ? coarsest_cells(p, f) : coarsest_lattice(p, f), high = f->rungs - 1; /* the rung is in low..high, if there is one */
  int rung = start < low ? low : start < high ? start : high;
  *best = -1;
  while (low <= high) {
    TRY(measure(p, f, rung));
    const double error = f->error[rung], excess = error > 0.0 ? 2.0 * log2(error / most) : -CELL_RUNGS; /* in rungs */
    const int before = rung;
    if (error <= most) {
      const bool settled = cells && *best >= 0 && error < SETTLED * f->error[*best];
      *best = rung;
      high = rung - 1;
      if (excess > -1.0 || settled) {
        break; /* the next coarser rung would miss, or save nothing: paths through cells are whole */
      }
      rung -= (int)floor(-excess);
    } else {
      low = rung + 1;
      rung += (int)ceil(fmin(excess, CELL_RUNGS));
    }
    rung = rung < low ? low : rung > high ? high : rung;
    if (rung > before && cost_of(p, f, rung) > dear) {
      break;
    }
  }
  return STRATUS_OK;
}

/* The families that are open, and the finer setting that they are compared with. */
typedef struct candidates {
  family of[3];
  int count;
  family local; /* the cheapest of its kind */
  setting fine;
} candidates;

/* Searches for blocks that are worth cells while all others take longer steps: the roughest class, then the two roughest, and so on. cells:
 * the rung of cells. *least: the cost of *found at *best. If nothing is cheaper, all three stay unchanged. */
static stratus_status search_local(probe* p, candidates* k, double most, int cells, double* least, int* best, family** found)
{
  const stratus_probe_classes* classes = &p->classes;
  double all = 0.0, rough = 0.0, before = INFINITY, limit = LOCAL_GAIN * *least;
  const int first = p->lit ? 0 : 1; /* not lit, samples of one lattice are a rule of their own, which is not local */
  for (int c = 0; c < STRATUS_PROBE_CLASSES; ++c) {
    all += (double)classes->count[c];
  }
  for (int beyond = first; beyond < STRATUS_PROBE_CLASSES; ++beyond) {
    const double more = beyond > 0 ? (double)classes->count[beyond - 1] : 0.0;
    int rung = -1;
    rough += more;
    if (rough > LOCAL_MOST * all) {
      break;
    }
    if (!(more > 0.0) && beyond > 0) {
      continue;
    }
    family f = { .sampling = STRATUS_SAMPLING_LOCAL,
      .rungs = p->options->sampling.distance > 0.0 ? 1 : LATTICE_RUNGS,
      .cost = costs[STRATUS_SAMPLING_LOCAL],
      .cells = cells,
      .beyond = beyond,
      .rough = rough / all };
    if (cost_of(p, &f, 0) > limit) {
      break; /* the next class only adds cells */
    }
    if (cost_of(p, &f, coarsest_lattice(p, &f)) > limit) {
      continue; /* without the densest blocks longer steps may be open */
    }
    const stratus_status lent = lend_rough(p, beyond);
    if (lent == STRATUS_OUT_OF_MEMORY || lent == STRATUS_OVERFLOW) {
      break; /* the rule only saves time */
    }
    TRY(lent);
    forget(&f);
    TRY(search(p, &f, LOCAL_START, LOCAL_SHARE * most, limit, &rung));
    const double cost = rung >= 0 ? cost_of(p, &f, rung) : INFINITY;
    if (cost < limit) {
      k->local = f;
      *least = limit = cost;
      *best = rung;
      *found = &k->local;
    } else if (cost > before) {
      break;
    }
    before = cost;
  }
  return STRATUS_OK;
}

/* Compares the candidates with one finer setting. *best, *found: the cheapest setting that keeps `most`; found NULL if none does. */
static stratus_status compare(probe* p, candidates* k, double most, int* best, family** found)
{
  double least = INFINITY, cells_cost = INFINITY; /* cells are the same in number at every rung */
  int cell_rung = k->fine.rung - FINER_BY;
  *found = NULL;
  p->caster->tried[0] = '\0';
  TRY(draw_patches(p, &k->fine, CELL_SHARE * p->options->sampling.tolerance, p->fine));
  for (int i = 0; i < k->count; ++i) {
    cells_cost = k->of[i].sampling == STRATUS_SAMPLING_CELLS ? k->of[i].cost : cells_cost;
  }
  for (int i = 0; i < k->count; ++i) {
    family* f = &k->of[i];
    const bool cells = f->sampling == STRATUS_SAMPLING_CELLS;
    int start = cells ? k->fine.rung - FINER_BY : ONE_VOXEL, rung;
    forget(f);
    if (cells ? cells_cost > least : least < INFINITY && k->of[0].error[ONE_VOXEL] <= fmin(most, FLAT) && k->of[0].rungs > 1) {
      continue; /* where one sample a voxel is enough, the function hardly bends, and two reads a sample gain nothing */
    }
    const int rungs = f->rungs;
    if (alike(f->sampling, k->fine.sampling) && rungs > k->fine.rung) {
      f->rungs = k->fine.rung; /* against itself, the finer setting would err by nothing, and against its equal by little */
    }
    TRY(search(p, f, start > 0 ? start : 0, most, fmin(least, cells_cost), &rung));
    f->rungs = rungs;
    cell_rung = cells && rung >= 0 ? rung : cell_rung;
    if (rung >= 0 && cost_of(p, f, rung) < least) {
      least = cost_of(p, f, rung);
      *best = rung;
      *found = f;
    }
  }
  return p->options->sampling.rule == STRATUS_SAMPLING_AUTO && stratus_ray_can_sample(p->caster, p->options, STRATUS_SAMPLING_LOCAL)
    ? search_local(p, k, most, cell_rung > 0 ? cell_rung : 0, &least, best, found)
    : STRATUS_OK;
}

static void add_family(candidates* k, const probe* p, stratus_sampling sampling)
{
  const stratus_ray_cast_options* options = p->options;
  const bool cells = sampling == STRATUS_SAMPLING_CELLS;
  const bool by_samples = sampling == STRATUS_SAMPLING_MIDPOINT || sampling == STRATUS_SAMPLING_PREINTEGRATED;
  if (p->lit && by_samples && options->sampling.rule == STRATUS_SAMPLING_AUTO &&
    stratus_ray_can_sample(p->caster, options, STRATUS_SAMPLING_LOCAL)) {
    return; /* each sample has a place of light of its own, which rules cells and local share at no greater cost */
  }
  if (stratus_ray_can_sample(p->caster, options, sampling) &&
    (options->sampling.rule == STRATUS_SAMPLING_AUTO || options->sampling.rule == sampling ||
      !stratus_ray_can_sample(p->caster, options, options->sampling.rule))) {
    family* f = &k->of[k->count++];
    *f = (family){ .sampling = sampling, .cost = costs[sampling], .rungs = cells ? CELL_RUNGS : LATTICE_RUNGS };
    f->rungs = (cells ? options->sampling.cell_error : options->sampling.distance) > 0.0 ? 1 : f->rungs;
  }
}

/* Whether a setting errs like the finer one that it was compared with. */
static bool too_near(const probe* p, const family* f, int rung, const setting* fine)
{
  const bool local = f->sampling == STRATUS_SAMPLING_LOCAL; /* and then the finer one is of cells */
  const bool open = local ? !(p->options->sampling.cell_error > 0.0) : f->rungs > 1;
  return (local || alike(f->sampling, fine->sampling)) && open && (local ? f->cells : rung) > fine->rung - FINER_BY;
}

/* The error of a setting: its difference to the finer setting, plus the finer setting's own error. */
static double expected_of(const family* f, int rung, double error, const setting* fine)
{
  if (f->sampling == STRATUS_SAMPLING_LOCAL || !alike(f->sampling, fine->sampling) || f->rungs == 1) {
    return error;
  }
  const double falls = f->sampling == STRATUS_SAMPLING_CELLS ? 0.5 : 0.25 * ORDER; /* by this power of 2 from rung to rung */
  return error / (1.0 - exp2(-falls * (fine->rung - rung)));
}

/* Gives a setting the coarsest light, up to its own, by which it keeps `most`. Its rough blocks are on loan. */
static stratus_status search_light(probe* p, double most, setting* s)
{
  int high = s->light, low = p->options->sampling.light_spread > 0.0 ? high : 0;
  for (s->light = high / 2; low < high; s->light = (low + high) / 2) {
    TRY(draw_patches(p, s, p->options->sampling.tolerance, p->coarse));
    const double error = error_of(p);
    note(p, ", light %.2g: %.2g", p->caster->integrator.choice.light_spread, error);
    if (error <= most) {
      high = s->light;
    } else {
      low = s->light + 1;
    }
  }
  s->light = high;
  return STRATUS_OK;
}

/* The error of the setting that is taken, whose rays end by the whole tolerance, as pictures' do. Its rough blocks are on loan. */
static stratus_status measure_taken(probe* p, const family* f, const setting* s, const setting* fine, double* error)
{
  p->whole.sampling.tolerance = p->options->sampling.tolerance;
  TRY(draw_patches(p, s, p->options->sampling.tolerance, p->coarse));
  *error = expected_of(f, s->rung, error_of(p), fine);
  return STRATUS_OK;
}

/* The finest setting's error, where it was measured; NaN if not. */
static double error_of_finest(const candidates* k, int last)
{
  for (int i = 0; i < k->count; ++i) {
    const family* f = &k->of[i];
    const int rung = f->rungs - 1 < last ? f->rungs - 1 : last;
    if (f->sampling == k->fine.sampling && f->error[rung] >= 0.0) {
      return expected_of(f, rung, f->error[rung], &k->fine);
    }
  }
  return NAN;
}

/* The finest setting that candidates are compared with, unless its step is too short for rays through this volume. */
static int finest_to_compare(const probe* p, stratus_sampling sampling, int last)
{
  const setting finest = { .sampling = sampling, .rung = last + FINER_BY };
  stratus_ray_choice choice;
  take(p, &finest, &choice);
  return stratus_ray_step_fits(&p->caster->field.traversed, choice.sample_distance, choice.follows) ? finest.rung : last;
}

/* Takes the cheapest of the settings that keep the tolerance, else the finest. *beyond: blocks of classes below it are rough, 0 if the
 * choice is not rule local. */
static stratus_status choose(probe* p, stratus_ray_choice* choice, int* beyond)
{
  const stratus_ray_caster* caster = p->caster;
  const stratus_ray_cast_options* options = p->options;
  const bool cells = stratus_ray_can_sample(caster, options, STRATUS_SAMPLING_CELLS);
  const bool preintegrates = stratus_ray_can_sample(caster, options, STRATUS_SAMPLING_PREINTEGRATED);
  const double most = SHARE * options->sampling.tolerance, for_rules = p->lit ? LIT_SHARE * most : most;
  const int last = (cells ? CELL_RUNGS : LATTICE_RUNGS) - 1;
  candidates k = { .count = 0, .fine.light = light_rung(p, LIGHT_COMPARED), .fine.finer = true };
  for (stratus_sampling rule = STRATUS_SAMPLING_MIDPOINT; rule <= STRATUS_SAMPLING_CELLS; ++rule) {
    add_family(&k, p, rule);
  }
  p->by_cells = k.count > 1 && k.of[k.count - 1].sampling == STRATUS_SAMPLING_CELLS;
  k.fine.sampling = cells ? STRATUS_SAMPLING_CELLS : preintegrates ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT;
  if (!(options->sampling.tolerance > 0.0)) {
    const bool open = options->sampling.rule == STRATUS_SAMPLING_AUTO;
    const setting finest = { .sampling = open ? k.fine.sampling : choice->sampling, .rung = last, .light = LIGHT_FINEST };
    take(p, &finest, choice);
    return STRATUS_OK;
  }
  p->whole.sampling.tolerance = CELL_SHARE * options->sampling.tolerance;
  const int finest = finest_to_compare(p, k.fine.sampling, last);
  const double wanted = cells ? -2.0 * (log2(CELL_SHARE * options->sampling.tolerance) + 2.0) : LATTICE_FINE;
  k.fine.rung = wanted < FINER_BY ? FINER_BY : wanted < finest ? (int)ceil(wanted) : finest;
  for (;;) {
    family* found = NULL;
    int best = 0;
    double allowed = most;
    TRY(compare(p, &k, for_rules, &best, &found));
    const bool kept = found != NULL;
    if (!kept && p->lit && k.fine.rung == finest) { /* light that jumps is not worth the finest setting, which hardly errs less */
      const double reached = error_of_finest(&k, last);
      allowed = NEARLY * reached;
      if (reached > most) {
        TRY(compare(p, &k, allowed, &best, &found));
      }
    }
    if (k.fine.rung == finest || (found && !too_near(p, found, best, &k.fine))) {
      setting s = found ? setting_of(p, found, best) : (setting){ .sampling = k.fine.sampling, .rung = last, .light = LIGHT_FINEST };
      if (found && found->sampling == STRATUS_SAMPLING_LOCAL) {
        TRY(lend_rough(p, found->beyond));
      }
      if (found && p->lit && stratus_ray_visits_cells(found->sampling)) {
        TRY(search_light(p, allowed, &s));
      }
      take(p, &s, choice);
      *beyond = found ? found->beyond : 0;
      choice->met = kept;
      choice->expected_error = error_of_finest(&k, last);
      if (found) {
        TRY(measure_taken(p, found, &s, &k.fine, &choice->expected_error));
      }
      return STRATUS_OK;
    }
    k.fine.rung = k.fine.rung + FINER_BY < finest ? k.fine.rung + FINER_BY : finest;
  }
}

/* Draws the picture of this frame with the setting that was measured last, where there is one that can draw it. The next frame measures. */
static void keep_last(stratus_ray_caster* caster, const stratus_ray_cast_options* options)
{
  const bool open =
    options->sampling.rule == STRATUS_SAMPLING_AUTO && (caster->measured.sampling != STRATUS_SAMPLING_LOCAL || caster->structure.rough);
  const bool wanted = open || caster->measured.sampling == options->sampling.rule;
  if (caster->measured.sample_distance > 0.0 && wanted && stratus_ray_can_sample(caster, options, caster->measured.sampling)) {
    caster->integrator.choice = caster->measured;
  }
  caster->integrator.choice.expected_error = NAN;
  caster->integrator.choice.met = false;
  caster->integrator.choice.provisional = true;
  snprintf(caster->tried, sizeof caster->tried, "no memory to measure what the tolerance needs, the last setting stays");
  stratus_log(caster->context, STRATUS_LOG_WARNING, "no memory to measure what the tolerance needs: the last setting stays");
}

stratus_status stratus_ray_probe(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_camera* camera,
  const stratus_ray_cast_options* options, stratus_ray_cast_report* report)
{
  const double start = stratus_now_ms();
  probe p = { .caster = caster, .volume = volume, .options = options, .whole = *options, .voxel = stratus_ray_voxel_length(volume) };
  const stratus_ray_choice provisional = caster->integrator.choice;
  stratus_ray_choice choice = provisional;
  stratus_distance_map* const last = caster->structure.rough;
  void* memory = NULL;
  int beyond = 0;
  p.lit = caster->optics.shades && stratus_ray_can_sample(caster, options, STRATUS_SAMPLING_CELLS) &&
    (options->sampling.rule == STRATUS_SAMPLING_AUTO || stratus_ray_visits_cells(options->sampling.rule));
  p.whole.clipping.crop = p.whole.clipping.clip_plane_count = p.whole.sampling.jitter = 0;
  if (caster->optics.lights) {
    stratus_shading* shading = &p.whole.light.shading;
    shading->light_count = stratus_lights_in_world(camera, &options->light.shading, shading->lights);
  }
  caster->tried[0] = '\0';
  stratus_status status = stratus_ray_probe_rays(caster, p.patches, &p.count, &p.classes);
  if (status == STRATUS_OK && p.count > 0) {
    status = stratus_allocate(caster->context, 2 * 4 * (size_t)PATCH * (size_t)p.count, sizeof(float), &memory);
  }
  if (status == STRATUS_OUT_OF_MEMORY) {
    stratus_release(caster->context, p.classes.of);
    keep_last(caster, options);
    return stratus_ray_update_table(caster, options);
  }
  if (status == STRATUS_OK && p.count > 0) {
    p.fine = memory;
    p.coarse = p.fine + 4 * (size_t)PATCH * (size_t)p.count;
    status = choose(&p, &choice, &beyond);
    stratus_release(caster->context, memory);
  }
  stratus_release(caster->context, p.classes.of);
  caster->structure.rough = last;
  if (status == STRATUS_OK) {
    stratus_ray_drop_rough(&caster->structure);
    caster->structure.rough = choice.sampling == STRATUS_SAMPLING_LOCAL ? p.rough[beyond] : NULL;
    p.rough[beyond] = caster->structure.rough ? NULL : p.rough[beyond];
  }
  for (int c = 0; c < STRATUS_PROBE_CLASSES; ++c) {
    stratus_distance_map_destroy(p.rough[c]);
  }
  caster->integrator.choice = status == STRATUS_OK ? choice : provisional;
  TRY(status);
  caster->integrator.choice.provisional = false;
  caster->probe_builds += p.count > 0;
  caster->measured = caster->integrator.choice;
  caster->measured_beyond = beyond;
  caster->measured_for = caster->inputs;
  TRY(stratus_ray_update_table(caster, options));
  report->probe_samples = p.samples;
  report->probe_ms = stratus_now_ms() - start;
  return STRATUS_OK;
}
