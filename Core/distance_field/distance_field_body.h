/* SPDX-License-Identifier: BSD-3-Clause
 * The exact transform for one lane width and one instruction set (distance_field_lanes.h), included by distance_field_exact.c.
 *
 * One array holds both halves of a signed field: squared distances outside, and the negated ones inside. This works after every axis,
 * because one half is 0 wherever the other is not. The targets of a voxel have distance 0 in its own half: voxels outside search `plus`
 * rows, voxels inside search `minus` rows.
 *
 * Along y distances are counted up and down the plane, with x in the lanes. Along x and z lines are searched (distance_field_line.h). */
#include "distance_field_lanes.h"

/* Scratch of one thread. Lines have `pad` values of FAR on each side, so that searches need not test for the ends. */
typedef struct NAME(room) {
  VALUE *plus, *minus;             /* rows, which point to x = 0 */
  VALUE *line, *up, *down, *spare; /* signed rows, padded to whole vectors */
  VALUE *tile_plus, *tile_minus;
  VALUE *column, *result;
  uint64_t *any, *all; /* bits by column of a plane: some voxel is effective, all voxels are */
  field_hull* hull;
} NAME(room);
#define room NAME(room)

typedef struct NAME(layout) {
  int64_t pad, row, tile, longest;
} NAME(layout);
#define layout NAME(layout)

FIELD_INLINE layout NAME(sizes)(const field_work* w)
{
  const int64_t nx = w->n[0], reach = nx < FAR_LINE ? nx : FAR_LINE, vectors = (nx * w->n[1] + LANES - 1) / LANES;
  return (layout){ .pad = (reach + 3 * LANES) / LANES * LANES,
    .row = (nx + LANES - 1) / LANES * LANES,
    .tile = w->n[2] * (vectors < FIELD_TILE_VECTORS ? vectors : FIELD_TILE_VECTORS) * LANES,
    .longest = nx > w->n[2] ? nx : w->n[2] };
}

static FIELD_TARGET size_t NAME(room_bytes)(const field_work* w)
{
  const layout l = NAME(sizes)(w);
  const int64_t values = 2 * (l.row + 2 * l.pad) + 4 * l.row + (w->is_signed ? 2 : 1) * l.tile + 2 * l.longest + LANES;
  const int64_t bytes =
    values * (int64_t)sizeof(VALUE) + 2 * w->words * (int64_t)sizeof(uint64_t) + (l.longest + 2) * (int64_t)sizeof(field_hull) + 8 * 64;
  return (size_t)((bytes + 63) / 64 * 64);
}

static FIELD_TARGET room NAME(make_room)(const field_work* w, unsigned char* memory)
{
  const layout l = NAME(sizes)(w);
  room r = { .hull = (field_hull*)(void*)memory };
  memory += (size_t)(l.longest + 2) * sizeof(field_hull);
  r.any = (uint64_t*)(void*)memory;
  r.all = r.any + w->words;
  VALUE* values = (VALUE*)(void*)(((uintptr_t)(r.all + w->words) + 63) / 64 * 64);
  r.plus = values + l.pad;
  r.minus = r.plus + l.row + 2 * l.pad;
  r.line = r.minus + l.row + l.pad;
  r.up = r.line + l.row;
  r.down = r.up + l.row;
  r.spare = r.down + l.row;
  r.tile_plus = r.spare + l.row;
  r.tile_minus = w->is_signed ? r.tile_plus + l.tile : r.tile_plus;
  r.column = r.tile_minus + l.tile;
  r.result = r.column + l.longest;
  return r;
}

static FIELD_TARGET void NAME(clear_lines)(const field_work* w, const room* r)
{
  const layout l = NAME(sizes)(w);
  for (VALUE* v = r->plus - l.pad; v < r->line; ++v) {
    *v = FAR;
  }
  for (int64_t x = 0; x < l.row; ++x) {
    r->line[x] = 0;
  }
}

#include "distance_field_line.h"

/* ---- along y and x: a plane */

/* One step of signed distances along y. before: distances of the last row; inside: mask of this row's effective voxels. */
FIELD_INLINE vector NAME(step)(vector before, vector inside, int is_signed)
{
  const vector cap = NAME(all)((VALUE)FAR_LINE);
  if (!is_signed) {
    return NAME(least)(before + 1, cap) & ~inside;
  }
  const vector same = NAME(flip)(before, inside); /* below 0: the last row's voxel is of the other kind, a target at distance 1 */
  return NAME(flip)(NAME(least)((same & (vector)(same > 0)) + 1, cap), inside);
}

/* The same for the first row, which has no row before it. */
FIELD_INLINE vector NAME(border)(vector inside, int is_signed)
{
  const vector cap = NAME(all)((VALUE)FAR_LINE);
  if (!is_signed) {
    return cap & ~inside;
  }
  return NAME(flip)(cap, inside);
}

/* Finds the columns of plane k that hold voxels of each kind. Returns bit 0: some voxel is effective, bit 1: some voxel is not. */
static FIELD_TARGET int NAME(survey)(const field_work* w, const room* r, int64_t k, field_range* range)
{
  const int64_t nx = w->n[0];
  const uint64_t* row = w->bits + k * w->n[1] * w->words;
  memcpy(r->any, row, (size_t)w->words * sizeof *row);
  memcpy(r->all, row, (size_t)w->words * sizeof *row);
  for (int64_t j = 1; j < w->n[1]; ++j) {
    row += w->words;
    for (int64_t i = 0; i < w->words; ++i) {
      r->any[i] |= row[i];
      r->all[i] &= row[i];
    }
  }
  int kinds = 0;
  for (int64_t x = 0; x < nx; ++x) {
    const int holds[2] = { r->any[x >> 6] >> (x & 63) & 1, !(r->all[x >> 6] >> (x & 63) & 1) };
    for (int kind = 0; kind < 2; ++kind) {
      if (holds[kind]) {
        range[kind].first = kinds >> kind & 1 ? range[kind].first : x;
        range[kind].last = x;
        kinds |= 1 << kind;
      }
    }
  }
  return kinds;
}

static FIELD_TARGET void NAME(row)(const field_work* w, const room* r, const field_range* range, VALUE* field)
{
  const int64_t nx = w->n[0], vectors = (nx + LANES - 1) / LANES;
  int envelope = w->method == STRATUS_FIELD_ENVELOPE;
  if (FIELD_BITS != 16 && w->method == STRATUS_FIELD_EXACT && vectors >= 2 * FIELD_SAMPLES) {
    int64_t steps = 0;
    for (int64_t i = 0; i < FIELD_SAMPLES; ++i) {
      steps += NAME(search_row)(r, range, (2 * i + 1) * vectors / (2 * FIELD_SAMPLES) * LANES, r->spare);
    }
    envelope = steps > FIELD_SAMPLES * LANES * FIELD_STEPS_A_LANE;
  }
  if (envelope) {
    NAME(envelope_line)(r->line, nx, r->hull, field);
    return;
  }
  for (int64_t x = 0; x + LANES <= nx; x += LANES) {
    NAME(search_row)(r, range, x, field);
  }
  if (nx % LANES) {
    const int64_t x = nx / LANES * LANES;
    NAME(search_row)(r, range, x, r->spare);
    memcpy(field + x, r->spare + x, (size_t)(nx - x) * sizeof *field);
  }
}

/* Square a row in the downward pass, when its distances along y from both sides are known. r->line gets the signed squares, r->plus and
 * r->minus the two halves that searches read. */
static FIELD_TARGET void NAME(square_row)(const field_work* w, const room* r, int first)
{
  const int64_t nx = w->n[0], row = (nx + LANES - 1) / LANES * LANES;
  for (int64_t x = 0; x < row; x += LANES) {
    const vector up = NAME(load)(r->line + x);
    vector inside, sign = { 0 };
    if (w->is_signed) {
      inside = sign = (vector)(up < 0);
    } else {
      inside = (vector)(up == 0);
    }
    vector s;
    if (first) {
      s = NAME(border)(inside, w->is_signed);
    } else {
      s = NAME(step)(NAME(load)(r->down + x), inside, w->is_signed);
    }
    NAME(store)(r->down + x, s);
    const vector d = NAME(least)(NAME(flip)(up, sign), NAME(flip)(s, sign)), squared = d * d;
    NAME(store)(r->line + x, NAME(flip)(squared, sign));
    NAME(store)(r->plus + x, squared & ~sign);
    NAME(store)(r->minus + x, squared & sign);
  }
  for (int64_t x = nx; x < row; ++x) {
    r->line[x] = 0;
    r->plus[x] = r->minus[x] = FAR;
  }
}

static FIELD_TARGET void NAME(plane)(const field_work* w, unsigned char* memory, int64_t k)
{
  const room r = NAME(make_room)(w, memory);
  const int64_t nx = w->n[0], ny = w->n[1];
  VALUE* field = (VALUE*)w->values + k * nx * ny;
  field_range range[2] = { { 0, 0 }, { 0, 0 } };
  const int kinds = NAME(survey)(w, &r, k, range);
  w->planes[k] = (uint8_t)kinds;
  if (kinds != 3) {
    const VALUE fill = kinds == 2 ? FAR : w->is_signed ? (VALUE)-FAR : 0;
    for (int64_t i = 0; i < nx * ny; ++i) {
      field[i] = fill;
    }
    return;
  }
  NAME(clear_lines)(w, &r);
  for (int64_t j = 0; j < ny; ++j) {
    const uint64_t* bits = w->bits + (k * ny + j) * w->words;
    for (int64_t x = 0; x < nx; x += LANES) {
      const vector inside = NAME(spread_bits)(bits, x);
      if (j > 0) {
        NAME(store)(r.up + x, NAME(step)(NAME(load)(r.up + x), inside, w->is_signed));
      } else {
        NAME(store)(r.up + x, NAME(border)(inside, w->is_signed));
      }
    }
    memcpy(field + j * nx, r.up, (size_t)nx * sizeof *field);
  }
  for (int64_t j = ny - 1; j >= 0; --j) {
    memcpy(r.line, field + j * nx, (size_t)nx * sizeof *field);
    NAME(square_row)(w, &r, j == ny - 1);
    NAME(row)(w, &r, range, field + j * nx);
  }
}

/* ---- along z: columns */

static FIELD_TARGET void NAME(envelope_tile)(
  const field_work* w, const room* r, const VALUE* plus, const VALUE* minus, VALUE* field, int64_t lanes, int* far)
{
  const int64_t nz = w->n[2], plane = w->n[0] * w->n[1];
  for (int64_t lane = 0; lane < lanes; ++lane) {
    for (int64_t k = 0; k < nz; ++k) {
      r->column[k] = plus == minus ? plus[k * LANES + lane] : (VALUE)(plus[k * LANES + lane] - minus[k * LANES + lane]);
    }
    NAME(envelope_line)(r->column, nz, r->hull, r->result);
    for (int64_t k = 0; k < nz; ++k) {
      field[k * plane + lane] = r->result[k];
      *far |= r->result[k] >= FAR || r->result[k] <= -FAR;
    }
  }
}

/* Searches the tile's first `lanes` columns and stores them in the field. *far becomes 1 if a result is FAR. */
static FIELD_TARGET void NAME(tile)(
  const field_work* w, const room* r, const VALUE* plus, const VALUE* minus, VALUE* field, int64_t lanes, int* far)
{
  const int64_t nz = w->n[2], plane = w->n[0] * w->n[1];
  int envelope = w->method == STRATUS_FIELD_ENVELOPE;
  vector out, farthest = { 0 };
  if (FIELD_BITS != 16 && w->method == STRATUS_FIELD_EXACT && nz >= 2 * FIELD_SAMPLES) {
    int64_t steps = 0;
    for (int64_t i = 0; i < FIELD_SAMPLES; ++i) {
      steps += NAME(search_tile)(plus, minus, w->range, (2 * i + 1) * nz / (2 * FIELD_SAMPLES), &out);
    }
    envelope = steps > FIELD_SAMPLES * LANES * FIELD_STEPS_A_LANE;
  }
  if (envelope) {
    NAME(envelope_tile)(w, r, plus, minus, field, lanes, far);
    return;
  }
  for (int64_t k = 0; k < nz; ++k) {
    NAME(search_tile)(plus, minus, w->range, k, &out);
    if (lanes == LANES) {
      NAME(store)(field + k * plane, out);
    } else {
      memcpy(field + k * plane, &out, (size_t)lanes * sizeof *field);
    }
    farthest = NAME(least)(farthest, NAME(least)(out, -out));
  }
  *far |= NAME(positive)(-farthest - NAME(all)((VALUE)(FAR - 1)));
}

/* Runs along z over FIELD_TILE_VECTORS vectors of columns, from voxel `first` of a plane on. */
static FIELD_TARGET void NAME(columns)(field_work* w, unsigned char* memory, int64_t first)
{
  const room r = NAME(make_room)(w, memory);
  const int64_t nz = w->n[2], plane = w->n[0] * w->n[1];
  VALUE* field = (VALUE*)w->values + first;
  const int64_t left = plane - first, most = FIELD_TILE_VECTORS * LANES, count = left < most ? left : most;
  const int64_t apart = nz * LANES;
  for (int64_t k = 0; k < nz; ++k) {
    for (int64_t v = 0; v * LANES < count; ++v) {
      const int64_t lanes = count - v * LANES, at = v * apart + k * LANES;
      vector s = { 0 };
      if (lanes >= LANES) {
        s = NAME(load)(field + k * plane + v * LANES);
      } else {
        memcpy(&s, field + k * plane + v * LANES, (size_t)lanes * sizeof *field);
      }
      if (w->is_signed) {
        NAME(store)(r.tile_plus + at, s & (vector)(s > 0));
        NAME(store)(r.tile_minus + at, -(s & (vector)(s < 0)));
      } else {
        NAME(store)(r.tile_plus + at, s);
      }
    }
  }
  int far = 0;
  for (int64_t v = 0; v * LANES < count; ++v) {
    const int64_t lanes = count - v * LANES;
    NAME(tile)(w, &r, r.tile_plus + v * apart, r.tile_minus + v * apart, field + v * LANES, lanes < LANES ? lanes : LANES, &far);
  }
  if (far) {
    stratus_field_is_far(w);
  }
}

static const field_passes NAME(
  passes) = { FIELD_BITS / 8, (int64_t)FIELD_TILE_VECTORS* LANES, NAME(room_bytes), NAME(plane), NAME(columns) };

#undef room
#undef layout
#undef aim
#undef vector
#undef NAME
#undef FIELD_TARGET
#undef FIELD_INLINE
#undef VECTOR_BYTES
#undef VALUE
#undef FAR_LINE
#undef FAR
#undef LANES
#undef FIELD_BITS
#undef FIELD_ISA
