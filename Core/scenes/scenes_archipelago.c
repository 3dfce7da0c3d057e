/* SPDX-License-Identifier: BSD-3-Clause
 * The archipelago as a set of voxels, of which no dense volume would fit into memory, and as a smaller volume; and islets, a few dense
 * clouds in as large a cube. Logarithms of the clouds' particles and of their densities are evenly distributed. A scene never changes. */
#include "scenes_archipelago.h"
#include "scenes_random.h"

#include <string.h>

#define CLOUDS_MAX 64
#define NORMAL_VOLUME 15.75  /* (2 pi)^1.5: a normal distribution of N particles has N / (15.75 width^3) a voxel in its middle */
#define VALUE_OF_PARTICLE 40 /* in the volume */

typedef struct archipelago {
  int side, clouds;
  double fewest_log2, most_log2; /* particles in a cloud */
  double least_density;          /* particles a voxel in a cloud's middle; the most is 1 */
  int scattered;                 /* particles outside of all clouds */
  uint64_t seed;
} archipelago;

static const archipelago as_set = { ARCHIPELAGO_LONGEST, 64, 8.0, 20.0, .002, 1024, 4096 },
                         as_volume = { ARCHIPELAGO_SIDE, 64, 8.0, 18.0, .002, 1024, 1024 },
                         islets = { ARCHIPELAGO_LONGEST, 8, 14.0, 17.0, .2, 0, 8 };

typedef struct cloud {
  double at[3], width;
  int64_t particles;
} cloud;

static void make_clouds(const archipelago* a, uint64_t* state, cloud clouds[CLOUDS_MAX])
{
  for (int c = 0; c < a->clouds; ++c) {
    for (int axis = 0; axis < 3; ++axis) {
      clouds[c].at[axis] = random_unit(state) * a->side;
    }
    clouds[c].particles = (int64_t)exp2(a->fewest_log2 + (a->most_log2 - a->fewest_log2) * random_unit(state));
    const double density = pow(a->least_density, random_unit(state));
    clouds[c].width = cbrt((double)clouds[c].particles / (NORMAL_VOLUME * density));
  }
}

/* Calls put() with the voxel of each particle, x fastest. */
static stratus_status scatter(
  stratus_context* context, const archipelago* a, void (*put)(void* to, uint64_t voxel), void* to, int64_t* particles)
{
  cloud clouds[CLOUDS_MAX];
  uint64_t state = a->seed;
  const double side = a->side;
  const uint64_t n = (uint64_t)a->side;
  make_clouds(a, &state, clouds);
  *particles = a->scattered;
  for (int c = 0; c < a->clouds; ++c) {
    *particles += clouds[c].particles;
  }
  for (int i = 0; put && i < a->scattered; ++i) {
    const uint64_t x = random_bits(&state) % n, y = random_bits(&state) % n, z = random_bits(&state) % n;
    put(to, (z * n + y) * n + x);
  }
  for (int c = 0; put && c < a->clouds; ++c) {
    TRY(stratus_progress(context, "archipelago", (double)c / a->clouds));
    for (int64_t i = 0; i < clouds[c].particles; ++i) {
      const double x = floor(clouds[c].at[0] + clouds[c].width * random_normal(&state));
      const double y = floor(clouds[c].at[1] + clouds[c].width * random_normal(&state));
      const double z = floor(clouds[c].at[2] + clouds[c].width * random_normal(&state));
      if (x >= 0.0 && x < side && y >= 0.0 && y < side && z >= 0.0 && z < side) {
        put(to, ((uint64_t)z * n + (uint64_t)y) * n + (uint64_t)x);
      }
    }
  }
  return STRATUS_OK;
}

typedef struct key_list {
  uint64_t* keys;
  uint32_t count;
} key_list;

static void put_key(void* to, uint64_t voxel)
{
  key_list* const list = to;
  list->keys[list->count++] = voxel;
}

static void put_value(void* to, uint64_t voxel)
{
  uint8_t* const value = (uint8_t*)to + voxel;
  *value = *value > 255 - VALUE_OF_PARTICLE ? 255 : (uint8_t)(*value + VALUE_OF_PARTICLE);
}

#define DIGIT_BITS 12 /* an axis of the set */
#define DIGITS (1 << DIGIT_BITS)

/* Sorts keys of three digits, the lowest first. `room` holds as many; the result is there. */
static void sort(uint64_t* keys, uint64_t* room, uint32_t count)
{
  for (int shift = 0; shift < 3 * DIGIT_BITS; shift += DIGIT_BITS) {
    uint32_t starts[DIGITS + 1] = { 0 };
    for (uint32_t i = 0; i < count; ++i) {
      ++starts[(keys[i] >> shift & (DIGITS - 1)) + 1];
    }
    for (int d = 0; d < DIGITS; ++d) {
      starts[d + 1] += starts[d];
    }
    for (uint32_t i = 0; i < count; ++i) {
      room[starts[keys[i] >> shift & (DIGITS - 1)]++] = keys[i];
    }
    uint64_t* const other = keys;
    keys = room;
    room = other;
  }
}

stratus_status stratus_archipelago_list(stratus_context* context, bool of_islets, int32_t** positions, size_t* count)
{
  const archipelago* const a = of_islets ? &islets : &as_set;
  const uint64_t n = ARCHIPELAGO_LONGEST;
  void *keys = NULL, *sorted = NULL, *list = NULL;
  key_list particles = { NULL, 0 };
  int64_t most;
  size_t distinct = 0;
  stratus_status status;
  TRY_CLEANUP(scatter(context, a, NULL, NULL, &most));
  TRY_CLEANUP(stratus_allocate(context, (size_t)most, sizeof *particles.keys, &keys));
  TRY_CLEANUP(stratus_allocate(context, (size_t)most, sizeof *particles.keys, &sorted));
  particles.keys = keys;
  TRY_CLEANUP(scatter(context, a, put_key, &particles, &most));
  sort(keys, sorted, particles.count);
  particles.keys = sorted;
  for (uint32_t i = 0; i < particles.count; ++i) {
    distinct += i == 0 || particles.keys[i] != particles.keys[i - 1];
  }
  TRY_CLEANUP(stratus_allocate(context, 3 * distinct, sizeof **positions, &list));
  int32_t* next = list;
  for (uint32_t i = 0; i < particles.count; ++i) {
    const uint64_t key = particles.keys[i];
    if (i == 0 || key != particles.keys[i - 1]) {
      *next++ = (int32_t)(key % n);
      *next++ = (int32_t)(key / n % n);
      *next++ = (int32_t)(key / n / n);
    }
  }
  *positions = list;
  *count = distinct;
cleanup:
  stratus_release(context, keys);
  stratus_release(context, sorted);
  return status;
}

stratus_status stratus_archipelago_fill(stratus_context* context, uint8_t* values)
{
  int64_t particles;
  memset(values, 0, (size_t)ARCHIPELAGO_SIDE * ARCHIPELAGO_SIDE * ARCHIPELAGO_SIDE);
  return scatter(context, &as_volume, put_value, values, &particles);
}
