/* SPDX-License-Identifier: BSD-3-Clause
 * Measures which structure draws a volume's frames fastest. A trial compares two structures by tiles of the frame that it is part of. The
 * better so far draws these tiles for the picture, so that its draws cost nothing. The other draws a small square of each again, stops
 * where it has taken as long as the better, and draws no more squares once it is clearly the slower: a trial costs a few per cent of a
 * frame, whatever it finds. Which of the two is first alternates from tile to tile, for the second finds its data in the cache.
 *
 * Skip or not: frames 1, 2, 4, 8, ... since the transfer function or the sampling changed compare the map with none.
 *
 * Another map is built when frames have spent so much time that building it cannot waste more than a small share of that, and stays if it
 * is faster. */
#include "ray_trial.h"

#include "ray_fetched.h"
#include "ray_frame.h"
#include "ray_tree.h"
#include "tiles.h"

#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

/* Side in pixels of the traversal's unit, and of the squares that two structures draw. Pictures of fewer than SMALL pixels have smaller
 * ones. */
#define UNIT 8
#define SIDE 16
#define SMALL (384 * 384)
/* Tiles of a trial along either axis. */
#define ACROSS 4
#define TILES (ACROSS * ACROSS)
/* If a look-up skips more samples than this, the map surely pays, and nothing is measured. A look-up reads one byte of the map, a sample
 * eight values and a table: for the map to lose, a look-up would have to take as long as 64 reads of values. This is policy. It is far from
 * the point where both take equally long, so that little depends on it. */
#define SURE 8
/* A structure that has taken 1 + LOST / n^2 times the other's time in n tiles draws no more squares. It has then taken the time of n + LOST
 * / n of the other's squares. With as many squares as there are tiles that is at most TILES + 1, plus the time by which the last square
 * exceeded it: to find a loser costs no more than to compare two that are equally fast. */
#define LOST ((double)TILES)
/* Other maps and trials may use these shares of the frame time since the last edit. A map that never pays costs at most its share, one
 * trial, and the error of its estimated build time. On the other side, a map which makes frames take 1/k of the time comes late: a camera
 * that stops just then has paid k times the necessary time. Any share trades one cost for the other. These are policy: frames differ by as
 * much from run to run, so that nobody sees that structures are tried. */
#define BUILD_SHARE 0.05
#define TRIAL_SHARE 0.02
/* Octant maps skip at least as far as a distance map, so that only the cache can make them slower. They are used unless they are slower by
 * this factor. It is policy: within the uncertainty of one trial's times, the map of fewer look-ups wins, and a wrong choice costs at most
 * this factor. */
#define OCTANTS_LOST 1.1
/* Eight octant maps are eight sweeps over the blocks, where one distance map is one. */
#define OCTANT_MAPS 8

/* One of the two that a trial compares. */
typedef struct contender {
  stratus_structure structure;
  const stratus_ray_cast_arguments* arguments;
  const uint8_t* map; /* NULL: none */
} contender;

typedef struct trial_job {
  stratus_ray_cast_frame better, other;
  stratus_ray_cast_tile* draw;
  int side;
  int columns; /* of the picture's tiles */
  int tiles[TILES];
  double (*times)[2];     /* of each tile's square, by the better and by the other; the latter 0: it was not drawn */
  double *whole, *wasted; /* milliseconds of each tile by the better structure, and by the other */
  stratus_ray_counts* counts;
  atomic_llong* spent; /* nanoseconds by both structures; then the number of tiles that both have drawn */
} trial_job;

static double time_pixels(
  const trial_job* job, const stratus_ray_cast_frame* frame, const int lo[2], const int hi[2], stratus_ray_counts* counts)
{
  const double start = stratus_thread_ms();
  stratus_ray_cast_pixels(frame, job->draw, lo[0], lo[1], hi[0], hi[1], counts);
  return stratus_thread_ms() - start;
}

static bool lost(const trial_job* job)
{
  const double better = (double)atomic_load(&job->spent[0]), other = (double)atomic_load(&job->spent[1]);
  const double tiles = (double)atomic_load(&job->spent[2]);
  return tiles * tiles * (other - better) > LOST * better;
}

/* Draws a square with the other structure. Returns its time, estimated by a unit of it if that has cost as much as the better's square; 0:
 * nothing was drawn. most: the better's time, INFINITY: not known. */
static double time_other(const trial_job* job, const int lo[2], const int hi[2], double most, double* wasted)
{
  const int ends[2] = { lo[0] + UNIT < hi[0] ? lo[0] + UNIT : hi[0], lo[1] + UNIT < hi[1] ? lo[1] + UNIT : hi[1] };
  stratus_ray_counts ignored = { 0 };
  double ms = 0.0;
  if (lost(job)) {
    return 0.0;
  }
  if (most < INFINITY) {
    ms = time_pixels(job, &job->other, lo, ends, &ignored);
    *wasted += ms;
  }
  if (ms > most) {
    return ms * ((hi[0] - lo[0]) * (hi[1] - lo[1])) / ((ends[0] - lo[0]) * (ends[1] - lo[1]));
  }
  ms = time_pixels(job, &job->other, lo, hi, &ignored); /* at once, as the better does */
  *wasted += ms;
  return ms;
}

static void try_tile(const void* data, int number, uint64_t sums[STRATUS_TILE_COUNTS])
{
  const trial_job* job = data;
  const int tile = job->tiles[number], sizes[2] = { job->better.arguments->picture.width, job->better.arguments->picture.height };
  const int lo[2] = { tile % job->columns * STRATUS_RAY_TILE, tile / job->columns * STRATUS_RAY_TILE };
  int hi[2], inner[2];
  double* times = job->times[number];
  stratus_ray_counts counts = { 0 };
  for (int axis = 0; axis < 2; ++axis) {
    hi[axis] = lo[axis] + STRATUS_RAY_TILE < sizes[axis] ? lo[axis] + STRATUS_RAY_TILE : sizes[axis];
    inner[axis] = lo[axis] + job->side < hi[axis] ? lo[axis] + job->side : hi[axis];
  }
  const int right[2] = { inner[0], lo[1] }, right_end[2] = { hi[0], inner[1] }, below[2] = { lo[0], inner[1] };
  double rest = time_pixels(job, &job->better, right, right_end, &counts);
  rest += time_pixels(job, &job->better, below, hi, &counts);
  const int square = (inner[0] - lo[0]) * (inner[1] - lo[1]), others = (hi[0] - lo[0]) * (hi[1] - lo[1]) - square;
  const bool sure = job->better.map && !job->other.map && counts.skipped > SURE * counts.lookups;
  if (number % 2 && !sure) {
    times[1] = time_other(job, lo, inner, others > 0 ? rest * square / others : INFINITY, &job->wasted[number]);
  }
  times[0] = time_pixels(job, &job->better, lo, inner, &counts);
  if (sure) { /* at least so much: as if a sample cost no more than a look-up */
    times[1] = times[0] * (double)(counts.samples + counts.skipped) / (double)(counts.samples + counts.lookups + 1);
  } else if (number % 2 == 0) {
    times[1] = time_other(job, lo, inner, times[0], &job->wasted[number]);
  }
  job->whole[number] = rest + times[0];
  job->counts[number] = counts;
  if (times[1] > 0.0) {
    atomic_fetch_add(&job->spent[0], (long long)(1e6 * times[0]));
    atomic_fetch_add(&job->spent[1], (long long)(1e6 * times[1]));
    atomic_fetch_add(&job->spent[2], 1);
  }
  sums[0] += 1;
}

/* Returns the i-th of n places, the middle ones first. */
static int from_middle(int i, int n)
{
  return n / 2 + (i % 2 ? -(i + 1) / 2 : i / 2);
}

/* Spread tiles over the window, the middle's first: tiles at the border may be empty, and show little. `shift`: shift of the columns, so
 * that a frame's second trial uses other tiles. Returns the number of tiles. */
static int place_tiles(const int window[4], int columns, int shift, const stratus_ray_drawn* drawn, int tiles[TILES])
{
  int first[2], size[2], across[2], count = 0;
  for (int axis = 0; axis < 2; ++axis) {
    first[axis] = window[2 * axis] / STRATUS_RAY_TILE;
    size[axis] = (window[2 * axis + 1] - 1) / STRATUS_RAY_TILE - first[axis] + 1;
    across[axis] = size[axis] < ACROSS ? size[axis] : ACROSS;
  }
  for (int row = 0; row < across[1]; ++row) {
    for (int column = 0; column < across[0]; ++column) {
      const int y = first[1] + (2 * from_middle(row, across[1]) + 1) * size[1] / (2 * across[1]);
      const int x = first[0] + ((2 * from_middle(column, across[0]) + 1) * size[0] / (2 * across[0]) + shift) % size[0];
      if (!stratus_ray_is_drawn(drawn, y * columns + x)) {
        tiles[count++] = y * columns + x;
      }
    }
  }
  return count;
}

/* The result of a trial. */
typedef struct trial_result {
  double better, other; /* milliseconds of the squares that both have drawn */
  double frame;         /* milliseconds of a frame by the better, estimated */
  double wasted;        /* milliseconds that the other took */
  double drawn;         /* milliseconds that the better's whole tiles took */
} trial_result;

static stratus_ray_cast_frame frame_by(const stratus_ray_caster* caster, const stratus_image* image, const contender* c)
{
  stratus_ray_cast_frame frame = stratus_ray_frame_of(caster, c->arguments, image, false);
  frame.map = c->map;
  return frame;
}

static void add_up(
  const trial_job* job, int count, const stratus_context* context, double pixels, stratus_ray_drawn* drawn, trial_result* r)
{
  double ms = 0.0;
  for (int i = 0; i < count; ++i) {
    ms += job->whole[i];
    r->wasted += job->wasted[i] / context->threads;
    if (job->times[i][1] > 0.0) {
      r->better += job->times[i][0];
      r->other += job->times[i][1];
    }
    drawn->tiles[drawn->count++] = job->tiles[i];
    drawn->counts.rays += job->counts[i].rays;
    drawn->counts.samples += job->counts[i].samples;
    drawn->counts.skipped += job->counts[i].skipped;
    drawn->counts.lookups += job->counts[i].lookups;
  }
  r->drawn = ms / context->threads;
  if (count > 0) {
    r->frame = ms * pixels / ((double)count * STRATUS_RAY_TILE * STRATUS_RAY_TILE * context->threads);
  }
}

/* Compares two structures. whole_tiles: by whole tiles. */
static stratus_status compare(stratus_ray_caster* caster, stratus_ray_choice_frame* frame, const contender* better, const contender* other,
  bool whole_tiles, trial_result* result)
{
  double times[TILES][2], whole[TILES], wasted[TILES] = { 0.0 };
  stratus_ray_counts counts[TILES];
  uint64_t sums[STRATUS_TILE_COUNTS];
  atomic_llong spent[3] = { 0, 0, 0 };
  _Alignas(64) stratus_ray_cast_arguments plain = *frame->arguments;
  stratus_ray_frame_structures(&caster->field.grid, NULL, 0.0, NULL, NULL, &plain);
  const int* window = plain.camera.window;
  const double pixels = (double)(window[1] - window[0]) * (double)(window[3] - window[2]);
  *result = (trial_result){ .frame = 0.0 };
  if (window[0] >= window[1] || window[2] >= window[3]) {
    return STRATUS_OK;
  }
  trial_job job = { .better = frame_by(caster, frame->image, better),
    .other = frame_by(caster, frame->image, other),
    .draw = stratus_ray_cast_tile_for(caster->context->isa, stratus_ray_fetch_type(&caster->field.traversed),
      stratus_ray_modes_variant(&caster->integrator, &caster->optics)),
    .side = whole_tiles ? STRATUS_RAY_TILE
      : pixels < SMALL  ? UNIT
                        : SIDE,
    .columns = (plain.picture.width + STRATUS_RAY_TILE - 1) / STRATUS_RAY_TILE,
    .times = times,
    .whole = whole,
    .wasted = wasted,
    .counts = counts,
    .spent = spent };
  const int count = place_tiles(window, job.columns, frame->drawn.count > 0, &frame->drawn, job.tiles);
  TRY(stratus_each_tile(caster->context, "structure", count, try_tile, &job, sums));
  add_up(&job, count, caster->context, pixels, &frame->drawn, result);
  frame->drawn_ms += result->drawn;
  if (caster->forced) {
    result->frame = result->better = caster->forced->frame[better->structure];
    result->other = caster->forced->frame[other->structure];
    result->wasted = caster->forced->trial;
  }
  return STRATUS_OK;
}

void stratus_ray_tried(stratus_ray_caster* caster, double cast_ms)
{
  stratus_ray_trial* t = &caster->trial;
  t->spent += caster->forced ? caster->forced->frame[t->with <= t->without ? t->map : STRATUS_STRUCTURE_NONE] : cast_ms;
}

/* Return the estimated time of building another map, from the first map's time and the blocks in each. A tree's origin is checked by a
 * hash, which reads the values once more, as their ranges have done. */
static double price_of(const stratus_ray_caster* caster, stratus_structure structure)
{
  const stratus_ray_trial* t = &caster->trial;
  const int64_t* n = caster->structure.occupancy->blocks;
  const double blocks = (double)n[0] * (double)n[1] * (double)n[2];
  if (caster->forced) {
    return caster->forced->build[structure];
  }
  return structure == STRATUS_STRUCTURE_HYBRID
    ? caster->field.scan_ms + t->build_ms * (double)stratus_ray_tree_blocks(&caster->structure) / blocks
    : OCTANT_MAPS * t->build_ms;
}

/* Return the map to build in this frame; AUTO: none. frame_ms: the expected time of the frame. */
static stratus_structure next_map(const stratus_ray_caster* caster, double frame_ms)
{
  const stratus_ray_trial* t = &caster->trial;
  stratus_structure next = STRATUS_STRUCTURE_AUTO;
  double most = BUILD_SHARE * (t->spent + frame_ms) - t->built_ms;
  for (stratus_structure s = STRATUS_STRUCTURE_OCTANT; s <= STRATUS_STRUCTURE_HYBRID; ++s) {
    const bool open = !t->tried[s] && (s != STRATUS_STRUCTURE_HYBRID || stratus_ray_offer_is_open(caster));
    const double price = open ? price_of(caster, s) : INFINITY;
    if (price <= most) {
      most = price;
      next = s;
    }
  }
  return next;
}

/* Builds another map and compares it with the better of the first and none. The faster stays. If memory runs out, the old one stays. */
static stratus_status try_map(
  stratus_ray_caster* caster, stratus_ray_choice_frame* frame, stratus_structure structure, const stratus_ray_cast_arguments* plain)
{
  stratus_ray_trial* t = &caster->trial;
  stratus_distance_map* map = NULL;
  trial_result result;
  bool offered = structure == STRATUS_STRUCTURE_HYBRID;
  _Alignas(64) stratus_ray_cast_arguments other = *frame->arguments;
  const double start = stratus_now_ms();
  t->tried[structure] = true;
  if (offered) {
    TRY(stratus_ray_offer_serves(caster, &offered));
    if (!offered) {
      t->built_ms += stratus_now_ms() - start;
      return STRATUS_OK;
    }
  }
  const stratus_status status = stratus_ray_make_map(caster, structure, offered, &map);
  if (status == STRATUS_OUT_OF_MEMORY || status == STRATUS_OVERFLOW) {
    return STRATUS_OK;
  }
  t->tried[structure] = status != STRATUS_CANCELLED;
  TRY(status);
  stratus_ray_frame_structures(&caster->field.grid, caster->optics.made.table, frame->tolerance, caster->structure.occupancy, map, &other);
  const bool skips = t->with <= t->without;
  const contender mine = { skips ? t->map : STRATUS_STRUCTURE_NONE, skips ? frame->arguments : plain,
    skips ? caster->structure.map->bytes : NULL };
  const contender its = { structure, &other, map->bytes };
  const stratus_status compared = compare(caster, frame, &mine, &its, t->frames > 1, &result);
  t->built_ms += caster->forced ? caster->forced->build[structure] : stratus_now_ms() - start;
  const bool as_far = structure == STRATUS_STRUCTURE_OCTANT && mine.structure == STRATUS_STRUCTURE_DISTANCE;
  if (compared != STRATUS_OK || !(result.other < (as_far ? OCTANTS_LOST : 1.0) * result.better)) {
    stratus_distance_map_destroy(map);
    t->tried[structure] = compared != STRATUS_CANCELLED;
    t->lost = compared == STRATUS_OK ? structure : t->lost;
    return compared;
  }
  stratus_ray_drop_map(&caster->structure);
  caster->structure.map = map;
  ++caster->structure.map_serial;
  *frame->arguments = other;
  t->lost = t->map;
  t->map = structure;
  /* scale the old map's measured time, or the time without a map, to the new map */
  t->with = (skips ? t->with : t->without) * fmin(result.other / result.better, 1.0);
  return STRATUS_OK;
}

/* Whether the times are of this frame's table and sampling. One table of running sums serves two rules and every step. */
static bool same_sampling(const stratus_ray_caster* caster)
{
  const stratus_ray_choice *last = &caster->trial.choice, *next = &caster->integrator.choice;
  return caster->trial.table_serial == caster->optics.table_serial && last->sampling == next->sampling &&
    last->sample_distance == next->sample_distance &&
    (!stratus_ray_visits_cells(next->sampling) || (last->cell_error == next->cell_error && last->light_spread == next->light_spread));
}

stratus_status stratus_ray_try(stratus_ray_caster* caster, stratus_ray_choice_frame* frame, char* why, size_t capacity)
{
  stratus_ray_trial* t = &caster->trial;
  _Alignas(64) stratus_ray_cast_arguments plain = *frame->arguments;
  double frame_ms = 0.0;
  stratus_ray_frame_structures(&caster->field.grid, NULL, 0.0, NULL, NULL, &plain);
  if (!same_sampling(caster)) { /* samples cost what was not measured yet; until it is, the times before are the best guess */
    t->table_serial = caster->optics.table_serial;
    t->choice = caster->integrator.choice;
    t->frames = 0;
    t->timed = false;
  }
  ++t->frames;
  if ((t->frames & (t->frames - 1)) == 0 && t->trial_ms <= TRIAL_SHARE * t->spent) {
    const bool skips = t->with <= t->without;
    const contender map = { t->map, frame->arguments, caster->structure.map->bytes }, none = { STRATUS_STRUCTURE_NONE, &plain, NULL };
    trial_result result;
    TRY(compare(caster, frame, skips ? &map : &none, skips ? &none : &map, false, &result));
    t->trial_ms += result.wasted;
    t->with = (t->timed ? t->with : 0.0) + (skips ? result.better : result.other);
    t->without = (t->timed ? t->without : 0.0) + (skips ? result.other : result.better);
    t->timed = true;
    frame_ms = result.frame * (skips && result.other < result.better ? result.other / result.better : 1.0);
  }
  /* a window of few columns of tiles has none left for a second comparison in one frame */
  const int* window = plain.camera.window;
  const bool comparable = window[0] < window[1] && window[2] < window[3] &&
    (frame->drawn.count == 0 || (window[1] - 1) / STRATUS_RAY_TILE - window[0] / STRATUS_RAY_TILE >= ACROSS);
  const stratus_structure next = comparable || caster->forced ? next_map(caster, frame_ms) : STRATUS_STRUCTURE_AUTO;
  if (next != STRATUS_STRUCTURE_AUTO) {
    TRY(try_map(caster, frame, next, &plain));
  }
  frame->used = t->with <= t->without ? t->map : STRATUS_STRUCTURE_NONE;
  frame->offered = frame->used == STRATUS_STRUCTURE_HYBRID;
  if (frame->used == STRATUS_STRUCTURE_NONE) {
    *frame->arguments = plain;
  }
  if (!(t->without > 0.0)) {
    snprintf(why, capacity, "%s: nothing was measured yet", stratus_structure_name(frame->used));
    return STRATUS_OK;
  }
  snprintf(why, capacity, "%s: measured%s, %s takes %.2g of the time without%s%s%s", stratus_structure_name(frame->used),
    t->timed ? "" : " with another sampling", stratus_structure_name(t->map), t->with / t->without, t->lost ? "; " : "",
    t->lost ? stratus_structure_name(t->lost) : "", t->lost ? " was slower" : "");
  return STRATUS_OK;
}
