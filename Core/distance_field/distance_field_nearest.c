/* SPDX-License-Identifier: BSD-3-Clause
 * The nearest voxel of each voxel of an exact field, for the paper's layout. A field keeps distances only. Positions come from the same
 * three axes, y, x, z, which carry a position along in the layout's own floats: the nearest target in the column, then in the plane, then
 * in the grid. The targets of a voxel are the voxels of the other kind, and each of these has its own position. Among equally near targets
 * the smallest index (z first, then y, then x) wins at each axis, and therefore in the end. */
#include "distance_field.h"

#include <omp.h>
#include <string.h>

#define NONE (-1)

/* A voxel's nearest target so far, kept in the bits of three floats. */
typedef struct site {
  int32_t at[3]; /* at[1] is NONE if no target is known */
} site;

static site get_site(const float* rgba, int64_t voxel)
{
  site s;
  memcpy(s.at, rgba + 4 * voxel, sizeof s.at);
  return s;
}

static void set_site(float* rgba, int64_t voxel, const site* s)
{
  memcpy(rgba + 4 * voxel, s->at, sizeof s->at);
}

/* Finds the nearest voxels of the other kind above and below, in column (i, k). */
static void find_in_column(const stratus_bits* set, int64_t i, int64_t k, float* rgba)
{
  const int64_t ny = set->n[1], step = set->n[0];
  int64_t last[2] = { NONE, NONE }; /* the last voxel of each kind */
  const int64_t first = k * ny * step + i;
  for (int64_t j = 0; j < ny; ++j) {
    const int kind = stratus_bits_get(set, i, j, k);
    last[kind] = j;
    set_site(rgba, first + j * step, &(site){ { (int32_t)i, (int32_t)last[!kind], (int32_t)k } });
  }
  last[0] = last[1] = NONE;
  for (int64_t j = ny - 1; j >= 0; --j) {
    const int kind = stratus_bits_get(set, i, j, k);
    const int64_t above = last[!kind], below = get_site(rgba, first + j * step).at[1];
    last[kind] = j;
    if (above != NONE && (below == NONE || above - j < j - below)) {
      set_site(rgba, first + j * step, &(site){ { (int32_t)i, (int32_t)above, (int32_t)k } });
    }
  }
}

typedef struct line {
  int64_t n, axis;
  int64_t at[3];     /* position of its first voxel */
  const site* sites; /* results of the axes before */
  const uint8_t* kinds;
  int64_t first[2], last[2]; /* places from which voxels of each kind can learn a target; first > last: none */
} line;

static int64_t squared_to(const site* s, const int64_t at[3])
{
  const int64_t x = s->at[0] - at[0], y = s->at[1] - at[1], z = s->at[2] - at[2];
  return x * x + y * y + z * z;
}

static bool is_before(const site* a, const site* b)
{
  for (int axis = 2; axis > 0; --axis) {
    if (a->at[axis] != b->at[axis]) {
      return a->at[axis] < b->at[axis];
    }
  }
  return a->at[0] < b->at[0];
}

/* Lets voxel `here` of the line learn a target from voxel `there`. */
static void learn(const line* l, int64_t here, int64_t there, const int64_t at[3], site* best, int64_t* distance)
{
  if (there < 0 || there >= l->n) {
    return;
  }
  site s = l->sites[there];
  if (l->kinds[here] != l->kinds[there]) {
    for (int a = 0; a < 3; ++a) {
      s.at[a] = (int32_t)(a == l->axis ? there : at[a]);
    }
  } else if (s.at[1] == NONE) {
    return;
  }
  const int64_t d = squared_to(&s, at);
  if (d < *distance || (d == *distance && is_before(&s, best))) {
    *best = s;
    *distance = d;
  }
}

static site find_in_line(const line* l, int64_t here)
{
  int64_t at[3] = { l->at[0], l->at[1], l->at[2] };
  site best = l->sites[here];
  at[l->axis] = here;
  int64_t distance = best.at[1] == NONE ? INT64_MAX : squared_to(&best, at);
  const int64_t first = l->first[l->kinds[here]], last = l->last[l->kinds[here]];
  const int64_t below = first - here, above = here - last, nearest = below > above ? below : above;
  for (int64_t n = nearest > 1 ? nearest : 1; first <= last && (n <= -below || n <= -above) && n * n <= distance; ++n) {
    learn(l, here, here - n, at, &best, &distance);
    learn(l, here, here + n, at, &best, &distance);
  }
  return best;
}

/* Fills the line's sites and kinds from voxels that are `step` apart. */
static void read_line(const stratus_bits* set, const float* rgba, int64_t from, int64_t step, line* l, site* sites, uint8_t* kinds)
{
  int64_t at[3] = { l->at[0], l->at[1], l->at[2] };
  for (int kind = 0; kind < 2; ++kind) {
    l->first[kind] = l->n;
    l->last[kind] = -1;
  }
  for (int64_t i = 0; i < l->n; ++i) {
    at[l->axis] = i;
    sites[i] = get_site(rgba, from + i * step);
    kinds[i] = (uint8_t)stratus_bits_get(set, at[0], at[1], at[2]);
    for (int kind = 0; kind < 2; ++kind) {
      if (kinds[i] != kind || sites[i].at[1] != NONE) {
        l->first[kind] = i < l->first[kind] ? i : l->first[kind];
        l->last[kind] = i;
      }
    }
  }
}

/* Searches all lines along axis 0 or 2. rooms: for each thread a site and a byte for each place of a line. */
static void find_along(const stratus_context* context, const stratus_bits* set, int axis, float* rgba, unsigned char* rooms, size_t room)
{
  const int other = 2 - axis;
  const int64_t n = set->n[axis], step = axis == 0 ? 1 : set->n[0] * set->n[1], lines = set->n[other] * set->n[1];
#pragma omp parallel num_threads(context->threads)
  {
    site* sites = (site*)(void*)(rooms + (size_t)omp_get_thread_num() * room);
    uint8_t* kinds = (uint8_t*)(sites + n);
#pragma omp for schedule(dynamic, 16)
    for (int64_t number = 0; number < lines; ++number) {
      line l = { .n = n, .axis = axis, .sites = sites, .kinds = kinds };
      l.at[other] = number % set->n[other];
      l.at[1] = number / set->n[other];
      const int64_t first = (l.at[2] * set->n[1] + l.at[1]) * set->n[0] + l.at[0];
      read_line(set, rgba, first, step, &l, sites, kinds);
      for (int64_t i = 0; i < n; ++i) {
        const site found = find_in_line(&l, i);
        set_site(rgba, first + i * step, &found);
      }
    }
  }
}

/* Converts positions to floats. Effective voxels of an unsigned field are their own nearest. */
static void write_positions(const stratus_context* context, const stratus_bits* set, int is_signed, float* rgba)
{
  const int64_t nx = set->n[0], rows = set->n[1] * set->n[2];
#pragma omp parallel for schedule(static) num_threads(context->threads)
  for (int64_t row = 0; row < rows; ++row) {
    const int64_t j = row % set->n[1], k = row / set->n[1];
    for (int64_t i = 0; i < nx; ++i) {
      float* to = rgba + 4 * (row * nx + i);
      const site s = get_site(rgba, row * nx + i);
      const int own = !is_signed && stratus_bits_get(set, i, j, k), known = own || s.at[1] != NONE;
      const int64_t at[3] = { own ? i : s.at[0], own ? j : s.at[1], own ? k : s.at[2] };
      for (int a = 0; a < 3; ++a) {
        to[a] = known ? (float)at[a] : -1.0f;
      }
    }
  }
}

stratus_status stratus_field_nearest(stratus_context* context, const stratus_bits* set, int is_signed, float* rgba)
{
  const int64_t nx = set->n[0], nz = set->n[2], longest = nx > nz ? nx : nz;
  const size_t room = ((size_t)longest * (sizeof(site) + 1) + 63) / 64 * 64;
  void* rooms = NULL;
  TRY(stratus_allocate(context, (size_t)context->threads, room, &rooms));
#pragma omp parallel for schedule(static) num_threads(context->threads)
  for (int64_t k = 0; k < nz; ++k) {
    for (int64_t i = 0; i < nx; ++i) {
      find_in_column(set, i, k, rgba);
    }
  }
  find_along(context, set, 0, rgba, rooms, room);
  find_along(context, set, 2, rgba, rooms, room);
  write_positions(context, set, is_signed, rgba);
  stratus_release(context, rooms);
  return STRATUS_OK;
}
