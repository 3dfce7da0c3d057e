/* SPDX-License-Identifier: BSD-3-Clause
 * The voxel sets of record and their rays, defined to the last voxel: uneven mixtures of blobs, shells and noise, solid cubes in noise
 * whose density has a given deviation, an archipelago of clouds, and islets. A set never changes. */
#include "stratus/scenes.h"
#include "scenes_archipelago.h"
#include "scenes_random.h"
#include "voxels.h"

#include <stdio.h>
#include <string.h>

#define RAYS_ACROSS 512
#define LEAST_DIRECTION 1e-6f /* least magnitude of each component of a ray's direction */
#define BLOBS_MAX 64
#define DEVIATION_BLOCK 8
#define BISECTIONS 24
#define DEVIATION_VOXELS 20000

typedef struct recipe {
  const char* name;
  int n[3];
  int64_t voxels;
  int blobs; /* number of blobs; 0: cubes in noise, or an archipelago or islets, which have no `voxels` */
  double in_blobs, in_shells;
  double deviation; /* cubes in noise: standard deviation of the density of occupied blocks of 8^3, over .5 */
  uint64_t seed;
} recipe;

/* clang-format off */
static const recipe recipes[] = {
  { "17K",  { 256, 128, 256 },    17000,  6, .55, .30, 0,   18000 },
  { "24K",  { 256, 128, 256 },    24000,  6, .55, .30, 0,   25000 },
  { "30K",  { 256, 128, 256 },    30000,  6, .55, .30, 0,   31000 },
  { "35K",  { 256, 128, 256 },    35000,  6, .55, .30, 0,   36000 },
  { "u225", { 256, 128, 256 }, DEVIATION_VOXELS, 0, 0, 0, .225, 4242 },
  { "u367", { 256, 128, 256 }, DEVIATION_VOXELS, 0, 0, 0, .367, 4242 },
  { "u571", { 256, 128, 256 }, DEVIATION_VOXELS, 0, 0, 0, .571, 4242 },
  { "u640", { 256, 128, 256 }, DEVIATION_VOXELS, 0, 0, 0, .640, 4242 },
  { "1M",   { 512, 512, 512 },  1000000, 40, .60, .25, 0,   77 },
  { "10M",  { 1024, 1024, 1024 }, 10000000, 60, .60, .25, 0, 78 },
  { "archipelago", { ARCHIPELAGO_LONGEST, ARCHIPELAGO_LONGEST, ARCHIPELAGO_LONGEST }, 0, 0, 0, 0, 0, 0 },
  { "islets", { ARCHIPELAGO_LONGEST, ARCHIPELAGO_LONGEST, ARCHIPELAGO_LONGEST }, 0, 0, 0, 0, 0, 0 },
};
/* clang-format on */
#define RECIPES ((int)(sizeof recipes / sizeof recipes[0]))

/* ---------------------------------------------------------------- sets */

typedef struct bit_set {
  int n[3];
  uint64_t* bits; /* x fastest */
} bit_set;

static size_t words_of(const int n[3])
{
  return ((size_t)n[0] * (size_t)n[1] * (size_t)n[2] + 63) / 64;
}

/* Set a voxel. Returns 1 if it is in the box and was not set. */
static int set_voxel(bit_set* set, int x, int y, int z)
{
  if (x < 0 || y < 0 || z < 0 || x >= set->n[0] || y >= set->n[1] || z >= set->n[2]) {
    return 0;
  }
  const size_t at = (size_t)x + (size_t)set->n[0] * ((size_t)y + (size_t)set->n[1] * (size_t)z);
  const uint64_t bit = (uint64_t)1 << (at & 63);
  const int fresh = !(set->bits[at >> 6] & bit);
  set->bits[at >> 6] |= bit;
  return fresh;
}

/* Sets random voxels; their z is drawn before y before x. */
static void fill_noise(bit_set* set, int64_t missing, uint64_t* state)
{
  while (missing > 0) {
    const int z = random_below(state, set->n[2]), y = random_below(state, set->n[1]), x = random_below(state, set->n[0]);
    missing -= set_voxel(set, x, y, z);
  }
}

typedef struct ball {
  double at[3], weight;
} ball;

/* Fills blobs, which fall off as a normal distribution. A blob's fraction of the voxels is proportional to the cube of its weight. */
static void fill_blobs(bit_set* set, const ball* blobs, int count, int64_t voxels, uint64_t* state)
{
  double total = 0.0;
  for (int i = 0; i < count; ++i) {
    total += blobs[i].weight * blobs[i].weight * blobs[i].weight;
  }
  for (int64_t done = 0; done < voxels;) {
    double left = random_unit(state) * total;
    int i = 0;
    for (; i < count - 1; ++i) {
      left -= blobs[i].weight * blobs[i].weight * blobs[i].weight;
      if (left < 0.0) {
        break;
      }
    }
    const ball* b = blobs + i;
    const double share = (double)voxels * b->weight * b->weight * b->weight / total, width = cbrt(share / 15.75 / 0.6);
    const int x = (int)floor(b->at[0] + width * random_normal(state));
    const int y = (int)floor(b->at[1] + width * random_normal(state));
    const int z = (int)floor(b->at[2] + width * random_normal(state));
    done += set_voxel(set, x, y, z);
  }
}

/* Fills shells one voxel thick. Shells may become full: after 50 tries for each voxel their radii spread. */
static void fill_shells(bit_set* set, const ball* shells, int count, int64_t voxels, uint64_t* state)
{
  const int *n = set->n, shorter = n[1] < n[2] ? n[1] : n[2], least = n[0] < shorter ? n[0] : shorter;
  double squares = 0.0;
  for (int i = 0; i < count; ++i) {
    squares += shells[i].weight * shells[i].weight;
  }
  const double radius = fmin((double)least * 0.45, sqrt((double)voxels * 1.6 / (12.566 * squares)));
  int64_t tries = 0;
  for (int64_t done = 0; done < voxels; ++tries) {
    const ball* s = shells + random_below(state, count);
    const double a = random_normal(state), b = random_normal(state), c = random_normal(state), length = sqrt(a * a + b * b + c * c);
    const double here = radius * s->weight * (tries > voxels * 50 ? 1.0 + 0.5 * random_unit(state) : 1.0);
    done += set_voxel(
      set, (int)floor(s->at[0] + here * a / length), (int)floor(s->at[1] + here * b / length), (int)floor(s->at[2] + here * c / length));
  }
}

static stratus_status fill_mixture(stratus_context* context, const recipe* recipe, bit_set* set)
{
  ball blobs[BLOBS_MAX], shells[BLOBS_MAX];
  const int shell_count = recipe->blobs / 3 > 1 ? recipe->blobs / 3 : 1;
  const int64_t in_blobs = (int64_t)((double)recipe->voxels * recipe->in_blobs);
  const int64_t in_shells = (int64_t)((double)recipe->voxels * recipe->in_shells);
  uint64_t state = recipe->seed;
  for (int i = 0; i < recipe->blobs; ++i) {
    for (int a = 0; a < 3; ++a) {
      blobs[i].at[a] = random_unit(&state) * recipe->n[a] * .8 + .1 * recipe->n[a];
    }
    blobs[i].weight = 0.5 + random_unit(&state);
  }
  fill_blobs(set, blobs, recipe->blobs, in_blobs, &state);
  TRY(stratus_progress(context, "voxel scene", 0.6));
  for (int i = 0; i < shell_count; ++i) {
    for (int a = 0; a < 3; ++a) {
      shells[i].at[a] = random_unit(&state) * recipe->n[a];
    }
    shells[i].weight = 0.5 + random_unit(&state);
  }
  fill_shells(set, shells, shell_count, in_shells, &state);
  TRY(stratus_progress(context, "voxel scene", 0.8));
  fill_noise(set, recipe->voxels - in_blobs - in_shells, &state);
  return STRATUS_OK;
}

/* Fills cubes of 16^3 at multiples of 8, the last one cut short, and adds noise. */
static void fill_cubes(bit_set* set, double in_cubes, uint64_t seed)
{
  const int64_t wanted = (int64_t)((double)DEVIATION_VOXELS * in_cubes);
  uint64_t state = seed;
  int64_t done = 0;
  memset(set->bits, 0, words_of(set->n) * sizeof *set->bits);
  while (done < wanted) {
    int at[3];
    for (int a = 0; a < 3; ++a) {
      at[a] = random_below(&state, set->n[a] / 8 - 1) * 8;
    }
    for (int i = 0; i < 8 * 512 && done < wanted; ++i) {
      const int k = i / 512;
      done += set_voxel(set, at[0] + (k & 1) * 8 + (i & 7), at[1] + (k >> 1 & 1) * 8 + (i >> 3 & 7), at[2] + (k >> 2) * 8 + (i >> 6 & 7));
    }
  }
  fill_noise(set, DEVIATION_VOXELS - done, &state);
}

/* Returns the standard deviation of the density of those blocks of 8^3 that hold any voxel. A row of 8 voxels is a byte. */
static double deviation_of(const bit_set* set)
{
  const int *n = set->n, rows = DEVIATION_BLOCK;
  double sum = 0.0, squares = 0.0;
  int64_t blocks = 0;
  for (int64_t b = 0; b < (int64_t)(n[0] / 8) * (n[1] / 8) * (n[2] / 8); ++b) {
    const size_t i = (size_t)(b % (n[0] / 8)), j = (size_t)(b / (n[0] / 8) % (n[1] / 8)), k = (size_t)(b / (n[0] / 8) / (n[1] / 8));
    int count = 0;
    for (int r = 0; r < rows * rows; ++r) {
      const size_t at = i * 8 + (size_t)n[0] * (j * 8 + (size_t)(r % rows) + (size_t)n[1] * (k * 8 + (size_t)(r / rows)));
      count += __builtin_popcountll(set->bits[at >> 6] >> (at & 63) & 0xff);
    }
    if (count > 0) {
      const double density = count / 512.0;
      sum += density;
      squares += density * density;
      ++blocks;
    }
  }
  const double mean = sum / (double)blocks;
  return sqrt(fmax(0.0, squares / (double)blocks - mean * mean));
}

static stratus_status fill_to_deviation(stratus_context* context, const recipe* recipe, bit_set* set)
{
  double lo = 0.0, hi = 0.9999;
  for (int i = 0; i < BISECTIONS; ++i) {
    const double middle = .5 * (lo + hi);
    TRY(stratus_progress(context, "voxel scene", (double)i / BISECTIONS));
    fill_cubes(set, middle, recipe->seed);
    if (2.0 * deviation_of(set) < recipe->deviation) {
      lo = middle;
    } else {
      hi = middle;
    }
  }
  return STRATUS_OK;
}

/* ---------------------------------------------------------------- public functions */

int stratus_voxel_scene_count(void)
{
  return RECIPES;
}

const char* stratus_voxel_scene_name(int index)
{
  return index >= 0 && index < RECIPES ? recipes[index].name : NULL;
}

static stratus_status find_recipe(stratus_context* context, const char* name, const recipe** result)
{
  char names[128] = "";
  for (int i = 0; i < RECIPES; ++i) {
    if (name && strcmp(name, recipes[i].name) == 0) {
      *result = recipes + i;
      return STRATUS_OK;
    }
    const size_t used = strlen(names);
    snprintf(names + used, sizeof names - used, "%s%s", i ? ", " : "", recipes[i].name);
  }
  return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "unknown voxel scene \"%.100s\"; there are: %s", name ? name : "(null)", names);
}

/* Lists the voxels in the order of their bits. */
static void list_voxels(const bit_set* set, int32_t* positions)
{
  const size_t nx = (size_t)set->n[0], ny = (size_t)set->n[1], words = words_of(set->n);
  for (size_t w = 0; w < words; ++w) {
    for (uint64_t bits = set->bits[w]; bits; bits &= bits - 1) {
      const size_t at = 64 * w + (size_t)__builtin_ctzll(bits);
      *positions++ = (int32_t)(at % nx);
      *positions++ = (int32_t)(at / nx % ny);
      *positions++ = (int32_t)(at / nx / ny);
    }
  }
}

/* Makes a set that has a bit for each position. */
static stratus_status make_set(stratus_context* context, const recipe* recipe, int32_t** positions, size_t* count)
{
  void *bits = NULL, *list = NULL;
  stratus_status status;
  bit_set set = { { recipe->n[0], recipe->n[1], recipe->n[2] }, NULL };
  TRY_CLEANUP(stratus_allocate_zero(context, words_of(set.n), sizeof *set.bits, &bits));
  set.bits = bits;
  TRY_CLEANUP(recipe->blobs ? fill_mixture(context, recipe, &set) : fill_to_deviation(context, recipe, &set));
  TRY_CLEANUP(stratus_allocate(context, 3 * (size_t)recipe->voxels, sizeof **positions, &list));
  list_voxels(&set, list);
  *positions = list;
  *count = (size_t)recipe->voxels;
cleanup:
  stratus_release(context, bits);
  return status;
}

stratus_status stratus_voxel_scene_create(
  stratus_context* context, const char* name, int64_t dimensions[3], int32_t** positions, size_t* count)
{
  const recipe* recipe = NULL;
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!dimensions || !positions || !count) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "the address of dimensions, positions or count is NULL");
  }
  TRY(find_recipe(context, name, &recipe));
  TRY(recipe->voxels ? make_set(context, recipe, positions, count)
                     : stratus_archipelago_list(context, strcmp(name, "islets") == 0, positions, count));
  for (int a = 0; a < 3; ++a) {
    dimensions[a] = recipe->n[a];
  }
  return STRATUS_OK;
}

void stratus_voxel_scene_release(stratus_context* context, int32_t* positions)
{
  if (context) {
    stratus_release(context, positions);
  }
}

/* ---------------------------------------------------------------- rays */

/* Sets a direction in float precision, such that the ray is never nearly parallel to a face. */
static void set_direction(stratus_ray* ray, const double d[3], double length)
{
  for (int a = 0; a < 3; ++a) {
    const float f = (float)(d[a] / length);
    ray->direction[a] = (double)(fabsf(f) < LEAST_DIRECTION ? LEAST_DIRECTION : f);
  }
}

/* Rounds to float precision. volatile, because gcc 12 drops the conversion to float and back for neighbouring numbers. */
static double round_to_float(double x)
{
  const volatile float rounded = (float)x;
  return (double)rounded;
}

/* Makes rays from an eye outside, one through a random point of each pixel. */
static void primary_rays(const int64_t n[3], stratus_ray* rays)
{
  const double nx = (double)n[0], ny = (double)n[1], nz = (double)n[2], diagonal = sqrt(nx * nx + ny * ny + nz * nz);
  const double eye[3] = { nx / 2. + 0.62 * diagonal * 0.70, ny / 2. + 0.62 * diagonal * 0.45, nz / 2. - 0.62 * diagonal * 0.9 };
  double f[3] = { nx / 2. - eye[0], ny / 2. - eye[1], nz / 2. - eye[2] };
  double length = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
  for (int a = 0; a < 3; ++a) {
    f[a] /= length;
  }
  length = sqrt(f[2] * f[2] + f[0] * f[0]);
  const double right[3] = { f[2] / length, 0.0, -f[0] / length };
  const double up[3] = { f[1] * right[2] - f[2] * right[1], f[2] * right[0] - f[0] * right[2], f[0] * right[1] - f[1] * right[0] };
  uint64_t state = 99;
  for (int p = 0; p < RAYS_ACROSS * RAYS_ACROSS; ++p) {
    const double a = (p % RAYS_ACROSS + random_unit(&state)) / RAYS_ACROSS - .5;
    const double b = (p / RAYS_ACROSS + random_unit(&state)) / RAYS_ACROSS - .5;
    const double d[3] = { f[0] + a * right[0] + b * up[0], f[1] + a * right[1] + b * up[1], f[2] + a * right[2] + b * up[2] };
    rays[p] = (stratus_ray){ .origin = { round_to_float(eye[0]), round_to_float(eye[1]), round_to_float(eye[2]) }, .t_max = INFINITY };
    set_direction(rays + p, d, sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
  }
}

/* Makes rays from random points in empty voxels, in random directions. */
static void random_rays(const stratus_voxels* voxels, stratus_ray* rays)
{
  const int64_t* n = voxels->dimensions;
  uint64_t state = 7;
  for (int p = 0; p < RAYS_ACROSS * RAYS_ACROSS; ++p) {
    int64_t at[3];
    rays[p] = (stratus_ray){ .t_max = INFINITY };
    do {
      for (int a = 0; a < 3; ++a) {
        rays[p].origin[a] = round_to_float(random_unit(&state) * (double)n[a]);
        at[a] = (int64_t)rays[p].origin[a]; /* rounding may put the origin on the far border */
      }
    } while (at[0] >= n[0] || at[1] >= n[1] || at[2] >= n[2] || stratus_voxels_get(voxels, at[0], at[1], at[2]));
    const double d[3] = { random_normal(&state), random_normal(&state), random_normal(&state) };
    set_direction(rays + p, d, sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
  }
}

stratus_status stratus_voxel_scene_rays(stratus_context* context, const stratus_voxels* voxels, int kind, stratus_ray* rays)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!voxels || !rays) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", voxels ? "rays" : "voxels");
  }
  if (kind != 0 && kind != 1) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "kind of rays %d outside 0..1", kind);
  }
  if (kind == 0) {
    primary_rays(voxels->dimensions, rays);
    return STRATUS_OK;
  }
  if (voxels->count == voxels->dimensions[0] * voxels->dimensions[1] * voxels->dimensions[2]) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "random rays begin in empty voxels, and all %lld are effective", (long long)voxels->count);
  }
  random_rays(voxels, rays);
  return STRATUS_OK;
}
