/* SPDX-License-Identifier: BSD-3-Clause
 * Chebyshev distances by sweeps, O(n): along x by doubling steps, then row by row along y and plane by plane along z. All neighbours of a
 * block in the next row are one step away: D = min(D, 1 + least of them). Along z these are 3x3 neighbours, in one octant 2x2. The sweeps
 * up and down z are independent, and the distance is the minimum of both. Threads share these sweeps and the octants.
 *
 * An octant's distance counts only occupied blocks that are behind the block on no axis, as seen along the octant's direction. Each axis
 * therefore needs one sweep in one direction. */
#include "distance_sweep.h"
#include "distance_rows.h"

#include <omp.h>

/* A box of the occupancy, and the distances computed in it. */
typedef struct field {
  const uint8_t* occupied; /* at the box's first block */
  int64_t row, plane;      /* strides of occupied */
  int64_t n[3];
  uint8_t target; /* 1: distances to occupied blocks, 0: to empty ones */
  size_t pitch;   /* of out and back */
  uint8_t* out;   /* distances; start and result of the sweep towards +z */
  uint8_t* back;  /* start and result of the sweep towards -z */
} field;

/* Scratch of one thread: two rows to spread in, two rows of near distances, and two planes of these for the sweep along z. */
typedef struct room {
  uint8_t* spread;
  size_t apart;
  uint8_t* near[2];
  uint8_t* planes[2];
  uint8_t* plane; /* distances in one plane */
  size_t pitch;
} room;

static size_t room_bytes(const int64_t blocks[3], size_t pitch)
{
  return 2 * (pitch + 2 * ROW_MARGIN) + 2 * pitch + 3 * pitch * (size_t)blocks[1];
}

static room make_room(uint8_t* memory, const int64_t blocks[3], size_t pitch)
{
  room r = { .apart = pitch + 2 * ROW_MARGIN, .pitch = pitch };
  /* Margins keep DISTANCE_MAX because a thread's rows only grow longer: run_sweeps() spreads the rows of the inner box first. */
  memset(memory, DISTANCE_MAX, 2 * r.apart);
  r.spread = memory + ROW_MARGIN;
  memory += 2 * r.apart;
  for (int i = 0; i < 2; ++i) {
    r.near[i] = memory + (size_t)i * pitch;
  }
  memory += 2 * pitch;
  for (int i = 0; i < 2; ++i) {
    r.planes[i] = memory + (size_t)i * pitch * (size_t)blocks[1];
  }
  r.plane = memory + 2 * pitch * (size_t)blocks[1];
  return r;
}

/* Computes the distances along x of one row. */
static void spread_row(const room* r, const uint8_t* occupied, uint8_t target, int64_t n, int side, uint8_t* out)
{
  const int64_t found = row_seed(occupied, target, n, r->spread);
  const uint8_t* result = r->spread;
  if (found != 0 && found != n) {
    result = row_spread(r->spread, r->apart, n, side);
  }
  memcpy(out, result, (size_t)n);
}

/* Sweeps a plane's rows towards higher y if `up`, else towards lower y. Each row steps from the row before. */
static void sweep_rows(const room* r, uint8_t* plane, int64_t nx, int64_t ny, int side, int up)
{
  for (int64_t i = 0; i < ny; ++i) {
    uint8_t* row = plane + (size_t)(up ? i : ny - 1 - i) * r->pitch;
    if (i > 0) {
      row_step(r->near[(i + 1) & 1], nx, row);
    }
    row_near(row, nx, side, r->near[i & 1]);
  }
}

/* Fills plane k of out and back with the distances within the plane, in all directions. */
static void full_plane(const field* f, const room* r, int64_t k)
{
  const size_t bytes = f->pitch * (size_t)f->n[1];
  uint8_t* plane = f->out + (size_t)k * bytes;
  for (int64_t j = 0; j < f->n[1]; ++j) {
    spread_row(r, f->occupied + k * f->plane + j * f->row, f->target, f->n[0], 0, plane + (size_t)j * f->pitch);
  }
  room rows = *r;
  rows.pitch = f->pitch;
  sweep_rows(&rows, plane, f->n[0], f->n[1], 0, 1);
  sweep_rows(&rows, plane, f->n[0], f->n[1], 0, 0);
  memcpy(f->back + (size_t)k * bytes, plane, bytes);
}

/* Sweeps planes along z in place. Each plane steps from the 3x3 nearest blocks of the plane before. */
static void full_sweep(const field* f, const room* r, int up)
{
  const int64_t nx = f->n[0], ny = f->n[1], nz = f->n[2];
  uint8_t* map = up ? f->out : f->back;
  for (int64_t i = 0; i < nz; ++i) {
    const uint8_t* before = r->planes[(i + 1) & 1];
    for (int64_t j = 0; j < ny; ++j) {
      uint8_t* row = map + ((size_t)(up ? i : nz - 1 - i) * (size_t)ny + (size_t)j) * f->pitch;
      if (i > 0) {
        const uint8_t* near = before + (size_t)j * f->pitch;
        row_step3(j > 0 ? near - f->pitch : near, near, j < ny - 1 ? near + f->pitch : near, nx, row);
      }
      row_near(row, nx, 0, r->planes[i & 1] + (size_t)j * f->pitch);
    }
  }
}

/* Merges the inner distances of block row (j, k), if there are any, into the map's row. */
static void merge_inner(
  const stratus_distance_map* map, const distance_inner* inner, const uint8_t* occupied, int64_t j, int64_t k, uint8_t* row)
{
  if (!inner->bytes) {
    for (int64_t x = 0; x < map->blocks[0]; ++x) {
      row[x] = occupied[x] ? DISTANCE_OCCUPIED + DISTANCE_MAX : row[x];
    }
    return;
  }
  const int64_t y = j - inner->lo[1], z = k - inner->lo[2];
  if (y >= 0 && y < inner->n[1] && z >= 0 && z < inner->n[2]) {
    row_merge(inner->bytes + (size_t)(z * inner->n[1] + y) * inner->pitch, inner->n[0], row + inner->lo[0]);
  }
}

/* Sweeps one octant from the distances along x: each plane's rows, then the step from the plane before. */
static void octant_sweep(const stratus_occupancy* occupancy, const distance_inner* inner, const uint8_t* spread, int octant,
  const stratus_distance_map* map, const room* r)
{
  const int64_t nx = map->blocks[0], ny = map->blocks[1], nz = map->blocks[2];
  const int side = octant & 1 ? 1 : -1, y_up = octant & 2, z_up = octant & 4;
  const size_t pitch = map->pitch, plane_bytes = pitch * (size_t)ny;
  for (int64_t i = 0; i < nz; ++i) {
    const int64_t k = z_up ? nz - 1 - i : i; /* a ray towards +z meets the planes above, so that distances are swept downwards */
    const uint8_t* before = r->planes[(i + 1) & 1];
    memcpy(r->plane, spread + (size_t)k * plane_bytes, plane_bytes);
    sweep_rows(r, r->plane, nx, ny, side, !y_up);
    for (int64_t j = 0; j < ny; ++j) {
      const size_t at = (size_t)j * pitch;
      uint8_t* row = r->plane + at;
      if (i > 0) {
        const int64_t neighbour = y_up ? j + 1 : j - 1;
        row_step2(before + at, before + (neighbour >= 0 && neighbour < ny ? (size_t)neighbour * pitch : at), nx, row);
      }
      row_near(row, nx, side, r->planes[i & 1] + at);
      uint8_t* out = map->bytes + (size_t)octant * map->map_bytes + (size_t)k * plane_bytes + at;
      memcpy(out, row, (size_t)nx);
      merge_inner(map, inner, occupancy->occupied + (k * ny + j) * nx, j, k, out);
    }
  }
}

/* ---- order of the sweeps */

typedef struct sweep {
  const stratus_occupancy* occupancy;
  stratus_distance_map* map;
  field outer;
  field within; /* n[2] is 0 if all blocks are occupied or none is */
  distance_inner inner;
  uint8_t* along[2]; /* OCTANT: distances along x towards - and towards + */
  uint8_t* rooms;
  size_t room_size;
} sweep;

static void outer_planes(const sweep* s, const room* r, int64_t k)
{
  const int64_t nx = s->map->blocks[0], ny = s->map->blocks[1];
  if (s->map->kind == STRATUS_DISTANCE_FULL) {
    full_plane(&s->outer, r, k);
    return;
  }
  for (int64_t j = 0; j < ny; ++j) {
    const int64_t row = k * ny + j;
    for (int side = 0; side < 2; ++side) {
      spread_row(r, s->occupancy->occupied + row * nx, 1, nx, 2 * side - 1, s->along[side] + (size_t)row * s->map->pitch);
    }
  }
}

/* Leaves the minimum of a field's two sweeps in plane k of out. */
static void meet(const field* f, int64_t k)
{
  const size_t bytes = f->pitch * (size_t)f->n[1], at = (size_t)k * bytes;
  row_least(f->back + at, (int64_t)bytes, f->out + at);
}

static void merge_plane(const sweep* s, int64_t k)
{
  const int64_t nx = s->map->blocks[0], ny = s->map->blocks[1];
  meet(&s->outer, k);
  for (int64_t j = 0; j < ny; ++j) {
    uint8_t* row = s->map->bytes + (size_t)(k * ny + j) * s->map->pitch;
    merge_inner(s->map, &s->inner, s->occupancy->occupied + (k * ny + j) * nx, j, k, row);
  }
}

static void run_sweeps(const stratus_context* context, const sweep* s)
{
  const int full = s->map->kind == STRATUS_DISTANCE_FULL;
  const int64_t nz = s->map->blocks[2], inner_nz = s->within.n[2];
#pragma omp parallel num_threads(context->threads)
  {
    const room r = make_room(s->rooms + (size_t)omp_get_thread_num() * s->room_size, s->map->blocks, s->map->pitch);
#pragma omp for schedule(static) nowait
    for (int64_t k = 0; k < inner_nz; ++k) {
      full_plane(&s->within, &r, k);
    }
#pragma omp for schedule(static)
    for (int64_t k = 0; k < nz; ++k) {
      outer_planes(s, &r, k);
    }
#pragma omp for schedule(dynamic, 1)
    for (int task = full ? 0 : 2; task < 4; ++task) {
      full_sweep(task < 2 ? &s->outer : &s->within, &r, task & 1);
    }
#pragma omp for schedule(static)
    for (int64_t k = 0; k < inner_nz; ++k) {
      meet(&s->within, k);
    }
    if (full) {
#pragma omp for schedule(static)
      for (int64_t k = 0; k < nz; ++k) {
        merge_plane(s, k);
      }
    } else {
#pragma omp for schedule(dynamic, 1)
      for (int octant = 0; octant < 8; ++octant) {
        octant_sweep(s->occupancy, &s->inner, s->along[octant & 1], octant, s->map, &r);
      }
    }
  }
}

/* The inner box holds the occupied blocks and a layer of blocks around them, cut at the grid: no empty block outside it is nearer. */
static void choose_inner_box(sweep* s, int64_t total)
{
  const stratus_occupancy* occupancy = s->occupancy;
  field* f = &s->within;
  if (occupancy->count == total) {
    return;
  }
  for (int a = 0; a < 3; ++a) {
    const int64_t lo = occupancy->lo[a] > 0 ? occupancy->lo[a] - 1 : 0;
    const int64_t hi = occupancy->hi[a] < occupancy->blocks[a] ? occupancy->hi[a] + 1 : occupancy->blocks[a];
    s->inner.lo[a] = lo;
    s->inner.n[a] = f->n[a] = occupancy->count ? hi - lo : 0;
  }
  f->row = occupancy->blocks[0];
  f->plane = occupancy->blocks[0] * occupancy->blocks[1];
  f->occupied = occupancy->occupied + s->inner.lo[2] * f->plane + s->inner.lo[1] * f->row + s->inner.lo[0];
  f->target = 0;
  f->pitch = s->inner.pitch = ((size_t)f->n[0] + 63) / 64 * 64;
}

stratus_status stratus_distance_sweep(stratus_context* context, const stratus_occupancy* occupancy, stratus_distance_map* map)
{
  stratus_status status = STRATUS_OK;
  const int64_t *n = map->blocks, total = n[0] * n[1] * n[2];
  sweep s = { .occupancy = occupancy, .map = map, .room_size = (room_bytes(n, map->pitch) + 63) / 64 * 64 };
  void* memory[5] = { NULL };

  s.outer = (field){ .occupied = occupancy->occupied,
    .row = n[0],
    .plane = n[0] * n[1],
    .n = { n[0], n[1], n[2] },
    .target = 1,
    .pitch = map->pitch,
    .out = map->bytes };
  choose_inner_box(&s, total);
  const size_t inner_bytes = s.within.pitch * (size_t)s.within.n[1] * (size_t)s.within.n[2];
  TRY_CLEANUP(stratus_allocate(context, (size_t)context->threads, s.room_size, &memory[0]));
  TRY_CLEANUP(stratus_allocate(context, map->map_bytes, 1, &memory[1]));
  if (map->kind == STRATUS_DISTANCE_OCTANT) {
    TRY_CLEANUP(stratus_allocate(context, map->map_bytes, 1, &memory[2]));
  }
  if (occupancy->count < total) {
    TRY_CLEANUP(stratus_allocate(context, inner_bytes, 1, &memory[3]));
    TRY_CLEANUP(stratus_allocate(context, inner_bytes, 1, &memory[4]));
  }
  s.rooms = memory[0];
  s.outer.back = s.along[0] = memory[1];
  s.along[1] = memory[2];
  s.within.out = s.inner.bytes = memory[3];
  s.within.back = memory[4];
  run_sweeps(context, &s);

cleanup:
  for (int i = 0; i < 5; ++i) {
    stratus_release(context, memory[i]);
  }
  return status;
}
