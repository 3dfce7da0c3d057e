/* SPDX-License-Identifier: BSD-3-Clause
 * Measures which structure draws a volume's frames fastest. Two decisions are made, and for each the worst that it can cost is known.
 *
 * Skip or not: tiles of the picture are drawn with the map and without it. Noise can only turn a decision between times that are nearly
 * equal.
 *
 * Another map: no map can save more than the look-ups in this one cost. Their sum over the frames since the last edit is what a better map
 * would have saved at most. Once it reaches the price of another map, that is built and measured, and stays if it is faster. So maps that
 * bring nothing cost no more than rays have spent on look-ups. (The ski rental problem, Karlin et al. 1988: never more than twice what is
 * best in hindsight.)
 */
#include "ray_trial.h"

#include "ray_fetched.h"
#include "ray_frame.h"
#include "ray_tree.h"
#include "tiles.h"

#include <stdio.h>
#include <string.h>

/* Side of a tile in pixels: a multiple of the traversal's 8, large enough that rays share memory as they do in the picture. */
#define SIDE 16
/* Tiles of one trial: up to ACROSS x ACROSS, but no more than one in SHARE of the picture's. */
#define ACROSS 3
#define SHARE 64
/* Eight octant maps are eight sweeps over the blocks, where one distance map is one. */
#define OCTANT_MAPS 8

typedef struct tile_time {
  double ms;
  double samples;
} tile_time;

typedef struct trial_job {
  stratus_ray_cast_frame frame;
  stratus_ray_cast_tile* draw;
  int across; /* tiles along either axis of the window */
  int first;  /* tile that the first of this pass stands for */
  int window[4];
  tile_time* times;
} trial_job;

static int origin_of(const trial_job* job, int axis, int place)
{
  const int lo = job->window[2 * axis], size = job->window[2 * axis + 1] - lo;
  const int at = lo + (int)((2 * place + 1) * (int64_t)size / (2 * job->across)) - SIDE / 2;
  return at > 0 ? at / 8 * 8 : 0;
}

static void time_tile(const void* data, int tile, uint64_t counts[STRATUS_TILE_COUNTS])
{
  const trial_job* job = data;
  const int width = job->frame.arguments->picture.width, height = job->frame.arguments->picture.height;
  const int place = job->first + tile, x0 = origin_of(job, 0, place % job->across), y0 = origin_of(job, 1, place / job->across);
  stratus_ray_counts mine = { 0 };
  const double start = stratus_thread_ms();
  job->draw(&job->frame, x0, y0, x0 + SIDE < width ? x0 + SIDE : width, y0 + SIDE < height ? y0 + SIDE : height, &mine);
  const double ms = stratus_thread_ms() - start;
  tile_time* time = &job->times[tile];
  time->ms = ms < time->ms ? ms : time->ms;
  time->samples = (double)mine.samples;
  counts[0] += mine.rays;
}

/* Times of a whole frame, estimated from the tiles. */
typedef struct trial_costs {
  double with, without; /* milliseconds; without: at least so many, if it is the longer */
  double look_ups;      /* of `with`, what is beyond the samples */
} trial_costs;

static tile_time sum_of(const tile_time* times, int tiles)
{
  tile_time sum = { 0.0, 0.0 };
  for (int tile = 0; tile < tiles; ++tile) {
    sum.ms += times[tile].ms;
    sum.samples += times[tile].samples;
  }
  return sum;
}

/* Draws tiles with the map, without it, and with it again: nothing counts the first reads of memory. Without it, no more is drawn than is
 * needed to take longer, and nothing if plain is NULL. *drawn: the tiles that were drawn without it. */
static stratus_status draw_tiles(
  stratus_context* context, trial_job* job, const stratus_ray_cast_arguments* plain, tile_time* with, tile_time* without, int* drawn)
{
  const stratus_ray_cast_frame frame = job->frame;
  const int across = job->across, tiles = across * across;
  uint64_t counts[STRATUS_TILE_COUNTS];
  for (int tile = 0; tile < tiles; ++tile) {
    with[tile] = without[tile] = (tile_time){ INFINITY, 0.0 };
  }
  job->times = with;
  TRY(stratus_each_tile(context, "structure", tiles, time_tile, job, counts));
  job->frame.arguments = plain;
  job->frame.map = NULL;
  for (*drawn = 0; plain && *drawn < tiles && sum_of(without, *drawn).ms <= sum_of(with, tiles).ms; *drawn += across) {
    job->first = (*drawn + tiles / 2 / across * across) % tiles; /* the window's middle first */
    job->times = without + *drawn;
    TRY(stratus_each_tile(context, "structure", across, time_tile, job, counts));
  }
  job->first = 0;
  job->frame = frame;
  job->times = with;
  return stratus_each_tile(context, "structure", tiles, time_tile, job, counts);
}

/* Estimates a frame's times with a map, and without it if that is wanted. arguments: with the map. */
static stratus_status measure(stratus_ray_caster* caster, const stratus_ray_cast_frame* frame, const stratus_ray_cast_arguments* arguments,
  stratus_ray_variant variant, const stratus_distance_map* map, stratus_structure structure, bool both, trial_costs* costs)
{
  tile_time with[ACROSS * ACROSS], without[ACROSS * ACROSS];
  int drawn = 0;
  _Alignas(64) stratus_ray_cast_arguments plain = *arguments;
  stratus_ray_frame_structures(NULL, 0.0, NULL, NULL, &plain);
  const int* window = plain.camera.window;
  const double pixels = fmax(window[1] - window[0], 0.0) * fmax(window[3] - window[2], 0.0), most = pixels / (SIDE * SIDE * SHARE);
  trial_job job = { .frame = *frame,
    .draw = stratus_ray_cast_tile_for(caster->context->isa, stratus_ray_fetch_type(&caster->traversed), variant),
    .across = most < ACROSS * ACROSS ? most < 4.0 ? 1 : (int)sqrt(most) : ACROSS };
  const int tiles = job.across * job.across;
  *costs = (trial_costs){ 0.0, 0.0, 0.0 };
  if (!(pixels > 0.0)) {
    return STRATUS_OK;
  }
  memcpy(job.window, window, sizeof job.window);
  job.frame.arguments = arguments;
  job.frame.map = map->bytes;
  TRY(draw_tiles(caster->context, &job, both ? &plain : NULL, with, without, &drawn));
  const tile_time a = sum_of(with, tiles), b = sum_of(without, drawn);
  const double scale = pixels / ((double)SIDE * SIDE * tiles * caster->context->threads); /* tiles' times are of one thread each */
  costs->with = a.ms * scale;
  costs->without = b.ms * scale;
  costs->look_ups = b.samples > 0.0 ? fmax(a.ms - a.samples * b.ms / b.samples, 0.0) * scale : costs->with;
  if (caster->forced) {
    costs->with = caster->forced->frame[structure];
    costs->without = caster->forced->frame[STRATUS_STRUCTURE_NONE];
    costs->look_ups = 0.5 * costs->with;
  }
  return STRATUS_OK;
}

/* Returns the milliseconds of a frame that a map of free look-ups would save, where the better of map and none is taken. */
static double regret_of(const stratus_ray_trial* t)
{
  return t->trials > 0 ? fmax(fmin(t->with, t->without) - (t->with - t->skippable), 0.0) / t->trials : 0.0;
}

void stratus_ray_tried(stratus_ray_caster* caster, double cast_ms)
{
  stratus_ray_trial* t = &caster->trial;
  const double frame = t->trials > 0 ? fmin(t->with, t->without) / t->trials : 0.0;
  t->regret += caster->forced || !(frame > 0.0) ? regret_of(t) : regret_of(t) / frame * cast_ms;
}

static void add_costs(stratus_ray_trial* t, const trial_costs* costs)
{
  t->with += costs->with;
  t->without += costs->without;
  t->skippable += costs->look_ups;
  ++t->trials;
}

/* What another map costs to build, by the price of this one and the blocks in each. */
static double price_of(const stratus_ray_caster* caster, stratus_structure structure)
{
  const stratus_ray_trial* t = &caster->trial;
  const int64_t* n = caster->occupancy->blocks;
  const double blocks = (double)n[0] * (double)n[1] * (double)n[2];
  const double mine = t->map == STRATUS_STRUCTURE_HYBRID ? (double)stratus_ray_tree_blocks(caster)
    : t->map == STRATUS_STRUCTURE_OCTANT                 ? OCTANT_MAPS * blocks
                                                         : blocks;
  const double other = structure == STRATUS_STRUCTURE_HYBRID ? (double)stratus_ray_tree_blocks(caster)
    : structure == STRATUS_STRUCTURE_OCTANT                  ? OCTANT_MAPS * blocks
                                                             : blocks;
  return caster->forced ? caster->forced->build[structure] : t->build_ms * other / fmax(mine, 1.0);
}

/* Returns the cheapest map that was not tried; AUTO: there is none. */
static stratus_structure next_map(const stratus_ray_caster* caster, bool offered, double* price)
{
  static const stratus_structure maps[] = { STRATUS_STRUCTURE_HYBRID, STRATUS_STRUCTURE_DISTANCE, STRATUS_STRUCTURE_OCTANT };
  stratus_structure next = STRATUS_STRUCTURE_AUTO;
  *price = INFINITY;
  for (int i = 0; i < 3; ++i) {
    const bool open = !caster->trial.tried[maps[i]] && (offered || maps[i] != STRATUS_STRUCTURE_HYBRID);
    const double its = open ? price_of(caster, maps[i]) : INFINITY;
    if (its < *price) {
      *price = its;
      next = maps[i];
    }
  }
  return next;
}

/* Builds another map and measures it. The faster of the two stays. If memory runs out, the old one stays. */
static stratus_status try_map(stratus_ray_caster* caster, const stratus_ray_cast_frame* frame, stratus_ray_cast_arguments* arguments,
  double tolerance, stratus_ray_variant variant, stratus_structure structure, bool offered)
{
  stratus_ray_trial* t = &caster->trial;
  stratus_distance_map* map = NULL;
  trial_costs old, new;
  _Alignas(64) stratus_ray_cast_arguments other = *arguments;
  const double start = stratus_now_ms();
  t->tried[structure] = true;
  t->lost = structure;
  const stratus_status status = stratus_ray_make_map(caster, structure, offered && structure == STRATUS_STRUCTURE_HYBRID, &map);
  const double build_ms = stratus_now_ms() - start;
  if (status == STRATUS_OUT_OF_MEMORY || status == STRATUS_OVERFLOW) {
    return STRATUS_OK;
  }
  TRY(status);
  stratus_ray_frame_structures(caster->table, tolerance, caster->occupancy, map, &other);
  stratus_status measured = measure(caster, frame, arguments, variant, caster->map, t->map, false, &old);
  if (measured == STRATUS_OK) {
    measured = measure(caster, frame, &other, variant, map, structure, true, &new);
  }
  if (measured != STRATUS_OK || new.with >= old.with) {
    stratus_distance_map_destroy(map);
    return measured;
  }
  stratus_ray_drop_map(caster);
  caster->map = map;
  ++caster->map_serial;
  *arguments = other;
  t->lost = t->map;
  t->map = structure;
  t->build_ms = build_ms;
  t->with = t->without = t->skippable = 0.0;
  t->trials = 0;
  add_costs(t, &new);
  return STRATUS_OK;
}

stratus_status stratus_ray_try(stratus_ray_caster* caster, const stratus_ray_cast_frame* frame, stratus_ray_cast_arguments* arguments,
  double tolerance, stratus_ray_variant variant, bool offered, stratus_structure* used, char* why, size_t capacity)
{
  stratus_ray_trial* t = &caster->trial;
  double price;
  if (t->table_serial != caster->table_serial) { /* another sampling: samples cost what was not measured yet */
    t->table_serial = caster->table_serial;
    t->frames = t->trials = 0;
    t->with = t->without = t->skippable = 0.0;
  }
  ++t->frames;
  if ((t->frames & (t->frames - 1)) == 0) {
    trial_costs costs;
    TRY(measure(caster, frame, arguments, variant, caster->map, t->map, true, &costs));
    add_costs(t, &costs);
  }
  const stratus_structure next = next_map(caster, offered, &price);
  if (next != STRATUS_STRUCTURE_AUTO && t->regret >= price) {
    t->regret -= price;
    TRY(try_map(caster, frame, arguments, tolerance, variant, next, offered));
  }
  *used = t->with < t->without ? t->map : STRATUS_STRUCTURE_NONE;
  if (*used == STRATUS_STRUCTURE_NONE) {
    stratus_ray_frame_structures(NULL, 0.0, NULL, NULL, arguments);
  }
  snprintf(why, capacity, "%s: measured %.3g ms a frame by %s%s%s%s, %s%.3g without; look-ups cost %.2g", stratus_structure_name(*used),
    t->with / t->trials, stratus_structure_name(t->map), t->lost ? " (" : "", t->lost ? stratus_structure_name(t->lost) : "",
    t->lost ? " was slower)" : "", t->with < t->without ? "at least " : "", t->without / t->trials, t->skippable / t->trials);
  return STRATUS_OK;
}
