/* SPDX-License-Identifier: BSD-3-Clause
 * Builds the maps of all lights of a scene, each as fine as its light's share of the tolerance needs, keeps them with the depths of
 * surfaces, and sets the arguments by which rays read both. */
#include "light_maps.h"

#include "device_frame.h"
#include "light_map_draw.h"
#include "light_surfaces.h"
#include "matrix.h"
#include "vector.h"

#include <string.h>

/* Nodes along the longest side of the first map and of the last. */
#define NODES_FIRST 32
#define NODES_LAST 256
/* Rays pass near matter on the map's spacing, or on NEAR_STEPS_LEAST steps if that is more, times one of stratus_light_near_lengths, and in
 * so many steps at most. Less than a spacing is no help, since the nodes about a place reach as far. */
#define NEAR_STEPS_LEAST 2
#define NEAR_STEPS_MOST 16
/* A map has at most so many words, 64 MiB. NODES_LAST nodes along each side are within it, but not in six faces of a cube. */
#define WORDS_MOST ((size_t)NODES_LAST * NODES_LAST * NODES_LAST)
/* The share of the tolerance that maps may use up. Errors of the picture's sampling add to it by their squares, and have .65. */
#define SHARE 0.7
/* The share that surfaces' edges may use up. The squares of the three add up to 1. */
#define SURFACE_SHARE 0.29
/* Surfaces are known at nodes that are up to so many times closer than a map's, and have at most so many words, 16 MiB. */
#define SURFACE_STEPS 64
#define SURFACE_WORDS ((size_t)1 << 22)
/* The part to which an error falls if the spacing is halved: of the second order where the light that passes is smooth, of the first where
 * it jumps, since as much smaller a part of the picture errs. A picture has both, so that not less than FALL_LEAST = 2^-1.5 is counted on,
 * and a map is not kept before a fall was measured. */
#define FALL_LEAST 0.354

typedef struct map {
  stratus_light light;
  stratus_light_grid grid;
  size_t at;   /* in words */
  double near; /* the length on which rays pass near matter, in near_steps */
  int near_steps;
  double error; /* that is expected of a picture, if the light is white */
  bool finest;  /* even the finest map errs by more than was wanted, so that none built anew would err less */
  /* Of surfaces that hide the light: nodes of a face, where their words begin, and the error that is expected of them. */
  int surface_size[2]; /* 0: there are none */
  size_t surface_at;
  double surface_error;
} map;

struct stratus_light_maps {
  stratus_context* context;
  map of[STRATUS_LIGHTS_MAX];
  int count;
  int32_t* words; /* of the maps, of scattered light, and of surfaces */
  size_t words_count;
  size_t own_count;                 /* of them, those before the surfaces' */
  uint64_t surfaces_key;            /* of the surfaces that are in the words; 0: none */
  double reflectance;               /* of the matter */
  stratus_device_slot* slot;        /* the words on the context's device, once they were sent */
  stratus_light_scatter scatter;    /* its arrays are released: the words are among all words */
  size_t scatter_at, scatter_words; /* of light that is scattered more than once; scatter_words: 0: there is none */
  double goes_on;                   /* the part of the extinction that light passes as if it were not there */
  double most, brightness;          /* the error that all maps may have, and the lights' brightness when they were built */
  double scatter_error;
};

/* ---- where a map is */

/* Sets the numbers of nodes of a map whose longest side has `nodes`. Returns whether its words are few enough. */
static bool size_map(map* m, const double sides[3], int nodes)
{
  const double spacing = fmax(fmax(sides[0], sides[1]), sides[2]) / (nodes - 1);
  for (int axis = 0; axis < 3; ++axis) {
    const int steps = (int)fmax(fmin(ceil(sides[axis] / spacing - 1e-9), nodes - 1), 1.0);
    m->grid.size[axis] = axis < 2 ? steps + 1 : steps;
  }
  return stratus_light_grid_words(&m->grid) <= WORDS_MOST;
}

static double near_length(const stratus_light_matter* matter, const map* m, double side)
{
  return fmax(side / m->grid.size[2], NEAR_STEPS_LEAST * matter->step);
}

/* Draws maps of a light, each finer than the one before, until the error that is expected of one is at most `most`: of the map by itself,
 * or of it where near matter is passed by rays. A map's error is measured at nodes of a finer one, where that is exact. Of the finer one
 * only some lines are drawn before it is known that it is wanted, and its own error is expected to fall as errors fell from map to map
 * before. words: receives the map's memory, also if a finer one fails. */
static stratus_status build_map(stratus_context* context, const stratus_light_matter* matter, double goes_on, const stratus_light* light,
  double most, map* m, int32_t** words)
{
  double sides[3], last[STRATUS_LIGHT_NEARS] = { 0.0 }, near = 0.0, error = 0.0;
  const int nears = matter->step > 0.0 ? STRATUS_LIGHT_NEARS : 1;
  bool kept = false;
  m->light = *light;
  stratus_light_frame_place(light, matter->bounds, &m->grid.frame, sides);
  (void)size_map(m, sides, NODES_FIRST);
  TRY(stratus_light_grid_draw(context, matter, goes_on, &m->grid, words));
  for (int nodes = 2 * NODES_FIRST; nodes <= NODES_LAST && !kept; nodes *= 2) {
    map finer = *m;
    double differences[STRATUS_LIGHT_NEARS];
    bool finer_wanted = false;
    const bool fits = size_map(&finer, sides, nodes);
    const double near_layers = near_length(matter, m, sides[2]) * finer.grid.size[2] / sides[2];
    TRY(stratus_light_grid_compare(context, matter, goes_on, &finer.grid, &m->grid, *words, near_layers, differences));
    for (int of_finer = 0; of_finer < (fits ? 2 : 1) && !kept; ++of_finer) {
      double least = INFINITY;
      for (int i = 0; i < nears && !kept; ++i) {
        const double fall = last[i] > 0.0 ? fmin(fmax(differences[i] / last[i], FALL_LEAST), 1.0) : 1.0;
        const double expected = matter->reflectance * (of_finer ? differences[i] * fall : differences[i]);
        const double length = stratus_light_near_lengths[i] * near_length(matter, of_finer ? &finer : m, sides[2]);
        if (i > 0 && length > NEAR_STEPS_MOST * matter->step) {
          break;
        }
        kept = expected <= most;
        if (kept || expected < least) {
          least = error = expected;
          near = length;
          finer_wanted = of_finer;
        }
      }
    }
    memcpy(last, differences, sizeof last);
    if (!fits) {
      break;
    }
    if (finer_wanted) {
      stratus_release(context, *words);
      *words = NULL;
      *m = finer;
      TRY(stratus_light_grid_draw(context, matter, goes_on, &m->grid, words));
    }
  }
  m->error = error;
  m->finest = !kept;
  m->near = near;
  m->near_steps = near > 0.0 ? (int)ceil(near / matter->step) : 0;
  return STRATUS_OK;
}

/* ---- all maps */

/* How bright lights are together: each is as bright as its largest channel, and errors of lights add by their squares. */
static double brightness_of(const stratus_light* lights, int count)
{
  double squares = 0.0;
  for (int i = 0; i < count; ++i) {
    const double largest = fmax(fmax(lights[i].color[0], lights[i].color[1]), lights[i].color[2]);
    squares += largest * largest;
  }
  return sqrt(squares);
}

stratus_status stratus_light_maps_build(stratus_context* context, const stratus_light_matter* given, const stratus_shading* shading,
  const stratus_light* lights, int count, stratus_light_maps** maps)
{
  stratus_light_matter limited = *given;
  const stratus_light_matter* matter = &limited;
  int32_t* words[STRATUS_LIGHTS_MAX] = { NULL };
  void *memory = NULL, *all = NULL, *slot = NULL;
  stratus_light_maps* made = NULL;
  stratus_status status;
  limited.reach = shading->shadow_length;
  limited.step = limited.reach > 0.0 ? 0.0 : given->step; /* near rays would add to the reach */
  TRY_CLEANUP(stratus_allocate_zero(context, 1, sizeof *made, &memory));
  made = memory;
  made->context = context;
  made->count = count;
  made->most = SHARE * matter->tolerance;
  made->brightness = brightness_of(lights, count);
  made->reflectance = matter->reflectance;
  if (shading->multiple) {
    TRY_CLEANUP(stratus_light_scatter_build(
      context, matter->draw, matter->of, matter->bounds, matter->detail, shading, lights, count, matter->tolerance, &made->scatter));
    made->goes_on = stratus_light_forward(&made->scatter, shading);
    made->scatter_error = made->scatter.error;
  }
  for (int i = 0; i < count; ++i) {
    const double most = made->most / fmax(made->brightness, 1e-30);
    TRY_CLEANUP(build_map(context, matter, made->goes_on, &lights[i], most, &made->of[i], &words[i]));
    made->of[i].at = made->words_count;
    made->words_count += stratus_light_grid_words(&made->of[i].grid);
    TRY_CLEANUP(stratus_progress(context, "light", (i + 1.0) / count));
  }
  TRY_CLEANUP(stratus_allocate_zero(context, 1, sizeof *made->slot, &slot));
  made->scatter_at = made->words_count;
  made->scatter_words = stratus_light_scatter_words(&made->scatter);
  made->words_count += made->scatter_words;
  TRY_CLEANUP(stratus_allocate(context, made->words_count, sizeof(int32_t), &all));
  made->slot = slot;
  made->words = all;
  made->own_count = made->words_count;
  if (made->scatter.words) {
    memcpy(made->words + made->scatter_at, made->scatter.words, made->scatter_words * sizeof(int32_t));
    stratus_light_scatter_release(context, &made->scatter);
  }
  for (int i = 0; i < count; ++i) {
    memcpy(made->words + made->of[i].at, words[i], stratus_light_grid_words(&made->of[i].grid) * sizeof(int32_t));
  }
  stratus_light_maps_destroy(*maps);
  *maps = made;
  memory = slot = NULL;
cleanup:
  if (memory) {
    stratus_light_scatter_release(context, &made->scatter);
  }
  for (int i = 0; i < count; ++i) {
    stratus_release(context, words[i]);
  }
  stratus_release(context, slot);
  stratus_release(context, memory);
  return status;
}

/* ---- surfaces */

static size_t surface_words(const map* m)
{
  return stratus_light_faces(&m->grid.frame) * (size_t)m->surface_size[0] * (size_t)m->surface_size[1];
}

static void finer_nodes(const map* m, int step, int size[2])
{
  for (int axis = 0; axis < 2; ++axis) {
    size[axis] = (m->grid.size[axis] - 1) * step + 1;
  }
}

/* Finds the surfaces that hide a map's light, at the least of nodes whose expected error is at most `most`. An edge between two nodes errs
 * on a part of the picture that is proportional to their distance, so that the error falls by its root. depths: receives them in layers.
 */
static stratus_status find_surfaces(
  const stratus_light_maps* maps, const stratus_surfaces* surfaces, double most, map* m, stratus_light_depths* depths)
{
  stratus_light_depths fine;
  int step = SURFACE_STEPS, size[2];
  stratus_status status = STRATUS_OK;
  finer_nodes(m, step, size);
  while (step > 1 && stratus_light_faces(&m->grid.frame) * (size_t)size[0] * (size_t)size[1] > SURFACE_WORDS) {
    step /= 2;
    finer_nodes(m, step, size);
  }
  TRY(stratus_light_surfaces_draw(maps->context, &m->grid.frame, surfaces, size, &fine));
  double error = 0.0;
  for (bool kept = false; !kept; step /= kept ? 1 : 2) {
    error = step > 1 ? maps->reflectance * stratus_light_surfaces_error(&m->grid.frame, &fine, step, m->grid.size, maps->words + m->at)
                     : error * sqrt(0.5);
    kept = step == 1 || error <= most;
    if (kept) {
      TRY_CLEANUP(stratus_light_surfaces_coarsen(maps->context, &m->grid.frame, &fine, step, depths));
    }
  }
  m->surface_error = error;
  memcpy(m->surface_size, depths->size, sizeof m->surface_size);
  const float layers = (float)(m->grid.size[2] / (m->grid.frame.hi[2] - m->grid.frame.lo[2])), near = (float)m->grid.frame.lo[2];
  for (size_t i = 0; i < surface_words(m); ++i) {
    depths->depth[i] = depths->depth[i] < STRATUS_LIGHT_FREE ? (depths->depth[i] - near) * layers : STRATUS_LIGHT_FREE;
  }
cleanup:
  stratus_release(maps->context, fine.depth);
  return status;
}

stratus_status stratus_light_maps_hide(stratus_light_maps* maps, const stratus_surfaces* surfaces)
{
  const uint64_t key = stratus_light_key_of_surfaces(surfaces);
  map of[STRATUS_LIGHTS_MAX];
  stratus_light_depths depths[STRATUS_LIGHTS_MAX] = { { .depth = NULL } };
  size_t count = maps->own_count;
  void* all = NULL;
  stratus_status status = STRATUS_OK;
  if (key == maps->surfaces_key) {
    return STRATUS_OK;
  }
  TRY(stratus_surfaces_check(maps->context, surfaces));
  memcpy(of, maps->of, sizeof of);
  for (int i = 0; i < maps->count; ++i) {
    memset(of[i].surface_size, 0, sizeof of[i].surface_size);
    of[i].surface_error = 0.0;
    if (key) {
      const double most = SURFACE_SHARE / SHARE * maps->most / fmax(maps->brightness, 1e-30);
      TRY_CLEANUP(find_surfaces(maps, surfaces, most, &of[i], &depths[i]));
      of[i].surface_at = count;
      count += surface_words(&of[i]);
    }
  }
  TRY_CLEANUP(stratus_allocate(maps->context, count, sizeof(int32_t), &all));
  memcpy(all, maps->words, maps->own_count * sizeof(int32_t));
  for (int i = 0; key && i < maps->count; ++i) {
    memcpy((int32_t*)all + of[i].surface_at, depths[i].depth, surface_words(&of[i]) * sizeof(int32_t));
  }
  stratus_slot_drop(maps->slot); /* the device may read the words in place */
  stratus_release(maps->context, maps->words);
  maps->words = all;
  maps->words_count = count;
  maps->surfaces_key = key;
  memcpy(maps->of, of, sizeof of);
cleanup:
  for (int i = 0; i < maps->count; ++i) {
    stratus_release(maps->context, depths[i].depth);
  }
  return status;
}

void stratus_light_maps_destroy(stratus_light_maps* maps)
{
  if (maps) {
    stratus_slot_drop(maps->slot); /* the device may read the words in place */
    stratus_release(maps->context, maps->slot);
    stratus_release(maps->context, maps->words);
    stratus_release(maps->context, maps);
  }
}

void stratus_light_state_drop(stratus_light_state* state)
{
  stratus_light_maps_destroy(state->maps);
  state->maps = NULL;
}

static bool same_way(const stratus_light* a, const stratus_light* b)
{
  return a->positional == b->positional && memcmp(a->vector, b->vector, sizeof a->vector) == 0;
}

bool stratus_light_state_serves(stratus_light_state* state, uint64_t key, const stratus_light* lights, int count)
{
  stratus_light_maps* maps = state->maps;
  bool serves = state->key == key && maps && maps->count == count, finest = true;
  for (int i = 0; serves && i < count; ++i) {
    serves = same_way(&maps->of[i].light, &lights[i]);
  }
  for (int i = 0; serves && i < count; ++i) {
    memcpy(maps->of[i].light.color, lights[i].color, sizeof lights[i].color);
    finest = finest && maps->of[i].finest;
  }
  return serves && (finest || brightness_of(lights, count) <= maps->brightness || stratus_light_maps_error(maps) <= maps->most);
}

stratus_status stratus_light_state_build(stratus_context* context, const stratus_light_matter* matter, const stratus_shading* shading,
  const stratus_light* lights, int count, stratus_light_state* state)
{
  TRY(stratus_light_maps_build(context, matter, shading, lights, count, &state->maps));
  state->key = 0;
  ++state->builds;
  return STRATUS_OK;
}

/* Sets how near matter is passed on the way to light i. */
static void near_arguments(
  const map* m, int i, const double to_places[16], double unit, double sample_distance, double goes_on, stratus_light_arguments* a)
{
  double way[3], world[3];
  memcpy(way, m->light.vector, sizeof way);
  (void)stratus_vector_normalize(way);
  for (int axis = 0; axis < 3; ++axis) {
    world[axis] = a->positional[i] ? m->light.vector[axis] : way[axis] * m->near;
  }
  for (int row = 0; row < 3; ++row) {
    double sum = a->positional[i] ? to_places[4 * row + 3] : 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      sum += to_places[4 * row + axis] * world[axis];
    }
    a->near_way[i][row] = (float)sum;
  }
  a->near = 1;
  a->near_steps[i] = m->near_steps;
  a->near_length[i] = (float)(m->near / m->near_steps / sample_distance * (1.0 - goes_on));
  a->near_reach[i] = (float)(m->near / unit);
}

void stratus_light_maps_arguments(const stratus_light_maps* maps, const stratus_light* lights, const double to_world[16], double unit,
  double sample_distance, stratus_light_arguments* a)
{
  double to_places[16];
  const bool near = maps && sample_distance > 0.0 && stratus_matrix_invert_affine(to_world, to_places);
  a->near = 0;
  stratus_light_scatter_arguments(maps && maps->scatter_words > 0 ? &maps->scatter : NULL, maps ? maps->scatter_at : 0, to_world, a);
  for (int i = 0; i < a->count; ++i) {
    const map* m = maps && i < maps->count ? &maps->of[i] : NULL;
    a->map_at[i] = a->surface_at[i] = -1;
    a->near_steps[i] = 0;
    if (!m || !same_way(&m->light, &lights[i])) { /* a light that moves with a probe's rays has no map there */
      continue;
    }
    if (near && m->near_steps > 0) {
      near_arguments(m, i, to_places, unit, sample_distance, maps->goes_on, a);
    }
    const stratus_light_frame* f = &m->grid.frame;
    double scale[3], shift[3];
    for (int axis = 0; axis < 3; ++axis) {
      scale[axis] = (axis < 2 ? m->grid.size[axis] - 1 : m->grid.size[2]) / (f->hi[axis] - f->lo[axis]);
      shift[axis] = -f->lo[axis] * scale[axis];
    }
    a->map_at[i] = (int)m->at;
    a->map_faces[i] = m->grid.frame.faces;
    for (int axis = 0; m->surface_size[0] > 0 && axis < 2; ++axis) {
      a->surface_at[i] = (int)m->surface_at;
      a->surface_size[i][axis] = m->surface_size[axis];
      a->surface_scale[i][axis] = (float)((m->surface_size[axis] - 1.0) / (m->grid.size[axis] - 1.0));
    }
    for (int row = 0; row < 3; ++row) {
      double from[4] = { 0.0, 0.0, 0.0, 0.0 };
      for (int axis = 0; axis < 3; ++axis) {
        for (int column = 0; column < 4; ++column) {
          from[column] += f->basis[row][axis] * to_world[4 * axis + column];
        }
        from[3] -= f->basis[row][axis] * f->origin[axis];
      }
      for (int column = 0; column < 4; ++column) {
        const double whole = m->grid.frame.faces > 0 ? from[column] : from[column] * scale[row] + (column == 3 ? shift[row] : 0.0);
        a->map_from[i][4 * row + column] = (float)whole;
      }
      a->map_size[i][row] = m->grid.size[row];
      a->map_scale[i][2 * row] = (float)scale[row];
      a->map_scale[i][2 * row + 1] = (float)shift[row];
    }
  }
}

double stratus_light_maps_passing(const stratus_light_maps* maps, const stratus_light* light, int i, const double world[3])
{
  const map* m = maps && i < maps->count ? &maps->of[i] : NULL;
  double q[3];
  if (!m || !same_way(&m->light, light)) {
    return 1.0;
  }
  const stratus_light_frame* f = &m->grid.frame;
  const int face = stratus_light_frame_coordinates(f, world, q);
  bool beside = f->perspective && q[2] <= 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    beside = beside || (axis < 2 && (q[axis] < f->lo[axis] || q[axis] > f->hi[axis]));
    q[axis] = (q[axis] - f->lo[axis]) / (f->hi[axis] - f->lo[axis]) * (axis < 2 ? m->grid.size[axis] - 1 : m->grid.size[2]);
  }
  return beside ? 1.0 : (double)stratus_light_passing(m->grid.size, maps->words + m->at, face, q);
}

const int32_t* stratus_light_maps_words(const stratus_light_maps* maps)
{
  return maps ? maps->words : NULL;
}

size_t stratus_light_maps_bytes(const stratus_light_maps* maps)
{
  return maps ? maps->words_count * sizeof(int32_t) : 0;
}

double stratus_light_maps_error(const stratus_light_maps* maps)
{
  double squares = maps ? maps->scatter_error * maps->scatter_error : 0.0;
  for (int i = 0; maps && i < maps->count; ++i) {
    const map* m = &maps->of[i];
    const double error = sqrt(m->error * m->error + m->surface_error * m->surface_error) * brightness_of(&m->light, 1);
    squares += error * error;
  }
  return sqrt(squares);
}

double stratus_light_maps_near(const stratus_light_maps* maps)
{
  double most = 0.0;
  for (int i = 0; maps && i < maps->count; ++i) {
    most = fmax(most, maps->of[i].near);
  }
  return most;
}

stratus_status stratus_light_maps_on_device(const stratus_light_maps* maps, struct _cl_mem** memory, bool* sent)
{
  *sent = !maps->slot->memory;
  if (*sent) {
    TRY(stratus_slot_keep(maps->context, maps->slot, maps->words, stratus_light_maps_bytes(maps)));
  }
  *memory = maps->slot->memory;
  return STRATUS_OK;
}
