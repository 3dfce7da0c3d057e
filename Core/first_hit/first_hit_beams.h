/* SPDX-License-Identifier: BSD-3-Clause
 * Beams of rays that run side by side, such as the rays of a tile of pixels, through one distance field whose cells are bricks. A beam of
 * BEAM rays looks a cell up once for all of them: it leaps while its whole cross-section is known to be empty. Otherwise it crosses one
 * layer of bricks, and the rays meet the boxes of the voxels within the beam.
 *
 * A position in float is off by up to `slack`, as in first_hit.h. A ray misses a voxel for certain if it misses its box grown by the slack,
 * and hits it for certain if it hits the box shrunk by as much. If it does neither, in front of all voxels that it hits, it is given up as
 * doubtful. Of two voxels that a ray hits for certain, one is behind a plane between them, and the ray meets that one later, in the
 * roundings of floats as well.
 *
 * Included by first_hit_isa.c. Lengths are in voxels. Positions that are called reflected are counted from the field's border on, in the
 * direction in which the rays run. */
#ifndef STRATUS_FIRST_HIT_BEAMS_H
#define STRATUS_FIRST_HIT_BEAMS_H

#include "first_hit_batch.h"

#include <limits.h>

#include "first_hit.h"
#include "tree_fields.h"

#define BEAM 64 /* rays; a tile of 8 x 8 pixels */
#define BEAM_PARTS (BEAM / STRATUS_WIDTH)
/* A wider beam leaps seldom, and rays of it have little in common. */
#define BEAM_WIDEST 2.875f
/* A cross-section of BEAM_WIDEST, with its growth within a layer, touches at most this many bricks along an axis. */
#define BEAM_BRICKS 5

typedef float four __attribute__((vector_size(16)));
typedef int four_int __attribute__((vector_size(16)));

typedef struct hit_beam {
  int first;           /* ray of the chunk */
  int axis, across[2]; /* the rays' longest axis, and the others */
  int octant, up[3];
  float begin, end;        /* where it starts and ends along its axis: reflected, in cells */
  four border, slope;      /* its lower two and its upper two borders across the axis at `begin`, in the same order, and how they move on */
  float inverse[2];        /* of the upper borders' slopes */
  four_int last;           /* the last cells across, twice */
  int64_t origin, step[3]; /* cell of the field at reflected (0, 0, 0), and from cell to cell along the axis and across it */
} hit_beam;

/* The voxels that the rays of a beam have met so far. */
typedef struct beam_rays {
  vfloat inverse[3][BEAM_PARTS], offset[3][BEAM_PARTS], end[BEAM_PARTS]; /* a plane at p is met at p * inverse + offset */
  vfloat nearest[BEAM_PARTS], safely[BEAM_PARTS]; /* where a ray enters its nearest certain voxel: at the earliest, at the latest */
  vfloat unsure[BEAM_PARTS];                      /* where it enters the nearest voxel of which it is not certain, at the earliest */
  vint cell[3][BEAM_PARTS];
  vmask live[BEAM_PARTS], hit[BEAM_PARTS], doubtful[BEAM_PARTS];
} beam_rays;

/* A brick of voxels in the layer that the beam crosses. */
typedef struct beam_brick {
  uint64_t mask;
  int at[2];    /* its cell across the axis, reflected */
  int voxel[3]; /* its first voxel */
} beam_brick;

/* ---------------------------------------------------------------- a beam of rays */

/* Finds the axis and the octant of the chunk's rays from `first` on. Returns how many live, or -1 unless these have the same. */
static inline int beam_direction(const stratus_hit_chunk* c, int first, hit_beam* beam)
{
  int live = 0, up[3] = { 0 }, down[3] = { 0 }, shorter[3] = { 0 };
  for (int i = first; i < first + BEAM; i += STRATUS_WIDTH) {
    const vmask lives = v_le(v_set(0.0f), v_load(c->end + i));
    live += m_count(lives);
    for (int axis = 0; axis < 3; ++axis) {
      const vfloat d = v_load(c->d[axis] + i);
      const vmask rises = v_lt(v_set(0.0f), d);
      up[axis] |= m_any(lives & rises);
      down[axis] |= m_any(m_andnot(lives, rises));
      shorter[axis] |= m_any(lives & v_lt(v_abs(d), v_set(1.0f)));
    }
  }
  beam->axis = !shorter[0] ? 0 : !shorter[1] ? 1 : 2;
  beam->octant = (up[0] ? 1 : 0) | (up[1] ? 2 : 0) | (up[2] ? 4 : 0);
  beam->across[0] = beam->axis == 0 ? 1 : 0;
  beam->across[1] = beam->axis == 2 ? 1 : 2;
  const bool mixed = (up[0] && down[0]) || (up[1] && down[1]) || (up[2] && down[2]) || shorter[beam->axis];
  return live > 0 && mixed ? -1 : live;
}

/* Places the beam in the field. */
static inline void beam_place(const stratus_hit_arguments* a, hit_beam* beam)
{
  const int64_t stride[3] = { 1, a->cells[0], (int64_t)a->cells[0] * a->cells[1] };
  const int axes[3] = { beam->axis, beam->across[0], beam->across[1] };
  beam->origin = 0;
  for (int n = 0; n < 3; ++n) {
    const int axis = axes[n];
    beam->up[axis] = beam->octant >> axis & 1;
    beam->step[n] = beam->up[axis] ? stride[axis] : -stride[axis];
    beam->origin += beam->up[axis] ? 0 : (a->cells[axis] - 1) * stride[axis];
  }
  const int p = a->cells[beam->across[0]] - 1, q = a->cells[beam->across[1]] - 1;
  beam->last = (four_int){ p, q, p, q };
}

/* The least number of a vector's lanes. */
static inline float beam_lowest(vfloat v)
{
#if STRATUS_ISA == 2
  return _mm512_reduce_min_ps(v);
#else
  float x[STRATUS_WIDTH];
  v_store(x, v);
  for (int half = STRATUS_WIDTH / 2; half > 0; half /= 2) {
    for (int i = 0; i < half; ++i) {
      x[i] = x[i + half] < x[i] ? x[i + half] : x[i];
    }
  }
  return x[0];
#endif
}

/* Finds the borders of a beam. Returns false if it would be wide. */
static inline bool beam_borders(const stratus_hit_arguments* a, const stratus_hit_chunk* c, hit_beam* beam)
{
  const float cell = 1.0f / STRATUS_BRICK;
  const int m = beam->axis, first = beam->first;
  float base[3], sign[3];
  for (int axis = 0; axis < 3; ++axis) {
    sign[axis] = beam->up[axis] ? 1.0f : -1.0f;
    base[axis] = (float)(beam->up[axis] ? -(a->at[axis] * STRATUS_BRICK) : (a->at[axis] + a->cells[axis]) * STRATUS_BRICK);
  }
  const vfloat most = v_set(INFINITY), least = v_set(-INFINITY);
  vfloat begins = most, ends = least, ahead[BEAM_PARTS]; /* how far a ray begins along the axis */
  vmask lives[BEAM_PARTS];
  for (int part = 0; part < BEAM_PARTS; ++part) {
    const vfloat length = v_load(c->end + first + part * STRATUS_WIDTH);
    ahead[part] = v_set(base[m]) + v_set(sign[m]) * v_load(c->o[m] + first + part * STRATUS_WIDTH);
    lives[part] = v_le(v_set(0.0f), length);
    begins = v_min(begins, v_select(lives[part], ahead[part], most));
    ends = v_max(ends, v_select(lives[part], ahead[part] + length, least));
  }
  const float begin = fmaxf(beam_lowest(begins), 0.0f), end = -beam_lowest(v_set(0.0f) - ends);
  beam->begin = begin * cell;
  beam->end = end * cell < (float)a->cells[m] ? end * cell : (float)a->cells[m];
  bool narrow = true;
  for (int side = 0; side < 2; ++side) {
    const int n = beam->across[side];
    vfloat low = most, high = least, low_slope = most, high_slope = least;
    for (int part = 0; part < BEAM_PARTS; ++part) {
      const int i = first + part * STRATUS_WIDTH;
      const vfloat slope = v_set(sign[n]) * v_load(c->d[n] + i);
      const vfloat at = v_set(base[n]) + v_set(sign[n]) * v_load(c->o[n] + i) - (ahead[part] - v_set(begin)) * slope;
      low = v_min(low, v_select(lives[part], at, most));
      high = v_max(high, v_select(lives[part], at, least));
      low_slope = v_min(low_slope, v_select(lives[part], slope, most));
      high_slope = v_max(high_slope, v_select(lives[part], slope, least));
    }
    const float lo = beam_lowest(low), hi = -beam_lowest(v_set(0.0f) - high), lo_slope = beam_lowest(low_slope),
                hi_slope = -beam_lowest(v_set(0.0f) - high_slope);
    /* A border's position is computed in a few roundings more than a ray's. */
    beam->border[side] = (lo - 2.0f * a->slack) * cell;
    beam->border[side + 2] = (hi + 2.0f * a->slack) * cell;
    beam->slope[side] = lo_slope;
    beam->slope[side + 2] = hi_slope;
    beam->inverse[side] = 1.0f / hi_slope;
    narrow &= beam->border[side + 2] - beam->border[side] + (hi_slope - lo_slope) * (beam->end - beam->begin) <= BEAM_WIDEST;
  }
  return narrow;
}

static inline void beam_take_rays(const stratus_hit_chunk* c, const hit_beam* beam, beam_rays* rays)
{
  for (int part = 0; part < BEAM_PARTS; ++part) {
    const int i = beam->first + part * STRATUS_WIDTH;
    for (int axis = 0; axis < 3; ++axis) {
      rays->inverse[axis][part] = v_load(c->inverse[axis] + i);
      rays->offset[axis][part] = (v_set(0.0f) - v_load(c->o[axis] + i)) * rays->inverse[axis][part];
      rays->cell[axis][part] = vi_set(-1);
    }
    rays->end[part] = v_load(c->end + i);
    rays->live[part] = v_le(v_set(0.0f), rays->end[part]);
    rays->hit[part] = rays->doubtful[part] = m_none();
    rays->nearest[part] = rays->safely[part] = rays->unsure[part] = v_set(INFINITY);
  }
}

/* ---------------------------------------------------------------- voxels */

/* Finds which rays meet a voxel, grown and shrunk by the slack, and keeps it where it is the nearest. */
static inline __attribute__((always_inline)) void beam_meet(
  const stratus_hit_arguments* a, const hit_beam* beam, const int voxel[3], beam_rays* rays)
{
  float grown_in[3], grown_out[3], in[3], out[3];
  for (int axis = 0; axis < 3; ++axis) {
    const float slack = beam->up[axis] ? a->slack : -a->slack;
    const float near = (float)(voxel[axis] + !beam->up[axis]), far = (float)(voxel[axis] + beam->up[axis]);
    grown_in[axis] = near - slack;
    grown_out[axis] = far + slack;
    in[axis] = near + slack;
    out[axis] = far - slack;
  }
  for (int part = 0; part < BEAM_PARTS; ++part) {
    vfloat t[3], enter, leave;
    for (int axis = 0; axis < 3; ++axis) {
      t[axis] = v_fma(v_set(grown_in[axis]), rays->inverse[axis][part], rays->offset[axis][part]);
    }
    enter = v_max(v_max(t[0], t[1]), t[2]);
    for (int axis = 0; axis < 3; ++axis) {
      t[axis] = v_fma(v_set(grown_out[axis]), rays->inverse[axis][part], rays->offset[axis][part]);
    }
    leave = v_min(v_min(t[0], t[1]), v_min(t[2], rays->end[part]));
    const vmask met = rays->live[part] & v_le(v_max(enter, v_set(-a->slack)), leave);
    if (!m_any(met)) {
      continue;
    }
    for (int axis = 0; axis < 3; ++axis) {
      t[axis] = v_fma(v_set(in[axis]), rays->inverse[axis][part], rays->offset[axis][part]);
    }
    const vfloat late = v_max(v_max(t[0], t[1]), v_max(t[2], v_set(a->slack)));
    for (int axis = 0; axis < 3; ++axis) {
      t[axis] = v_fma(v_set(out[axis]), rays->inverse[axis][part], rays->offset[axis][part]);
    }
    leave = v_min(v_min(t[0], t[1]), v_min(t[2], rays->end[part]));
    const vmask certain = met & v_le(late, leave), closer = certain & v_lt(enter, rays->nearest[part]);
    const vmask unsure = m_andnot(met, certain) | m_andnot(certain & v_le(enter, rays->nearest[part]), closer);
    rays->unsure[part] = v_select(unsure, v_min(rays->unsure[part], enter), rays->unsure[part]);
    rays->nearest[part] = v_select(closer, enter, rays->nearest[part]);
    rays->safely[part] = v_select(closer, late, rays->safely[part]);
    for (int axis = 0; axis < 3; ++axis) {
      rays->cell[axis][part] = vi_select(closer, vi_set(voxel[axis]), rays->cell[axis][part]);
    }
  }
}

/* End the rays that have met a voxel. Nothing that is met later is in front of it. Returns false once no ray is left. */
static inline bool beam_settle(beam_rays* rays)
{
  int left = 0;
  for (int part = 0; part < BEAM_PARTS; ++part) {
    const vmask doubtful = rays->live[part] & v_lt(rays->unsure[part], v_set(INFINITY)) & v_le(rays->unsure[part], rays->safely[part]);
    const vmask hit = m_andnot(rays->live[part] & v_lt(rays->nearest[part], v_set(INFINITY)), doubtful);
    rays->doubtful[part] = rays->doubtful[part] | doubtful;
    rays->hit[part] = rays->hit[part] | hit;
    rays->live[part] = m_andnot(m_andnot(rays->live[part], doubtful), hit);
    left |= m_any(rays->live[part]);
  }
  return left != 0;
}

/* Bits of a brick's mask whose voxels have a reflected index of lo..hi along an axis. */
static inline uint64_t beam_range(const hit_beam* beam, int axis, int lo, int hi)
{
  const int low = beam->up[axis] ? lo : STRATUS_BRICK - 1 - hi, high = beam->up[axis] ? hi : STRATUS_BRICK - 1 - lo;
  if (axis == 0) {
    return (uint64_t)((2 << high) - (1 << low)) * 0x1111111111111111u;
  }
  if (axis == 1) {
    return (uint64_t)((1 << (4 * high + 4)) - (1 << (4 * low))) * 0x0001000100010001u;
  }
  return ~UINT64_C(0) >> (48 - 16 * high) & ~UINT64_C(0) << (16 * low);
}

/* Returns the bits of a brick's mask whose voxels are within the borders across the axis, in voxels. */
static inline uint64_t beam_covers(const hit_beam* beam, const beam_brick* brick, four_int voxels)
{
  uint64_t bits = ~UINT64_C(0);
  for (int side = 0; side < 2; ++side) {
    const int first = brick->at[side] * STRATUS_BRICK, lo = voxels[side] - first, hi = voxels[side + 2] - first;
    if (lo >= STRATUS_BRICK || hi < 0) {
      return 0;
    }
    bits &= beam_range(beam, beam->across[side], lo > 0 ? lo : 0, hi < STRATUS_BRICK ? hi : STRATUS_BRICK - 1);
  }
  return bits;
}

/* ---------------------------------------------------------------- cells */

/* Returns the lower borders at one position along the axis, and the upper ones at another. */
static inline four beam_between(const hit_beam* beam, float from, float to)
{
  const float low = from - beam->begin, high = to - beam->begin;
  return beam->border + (four){ low, low, high, high } * beam->slope;
}

/* Truncates borders. One below the field becomes its first cell: a ray begins a little before it enters the field. */
static inline four_int beam_whole(four borders)
{
  const four_int whole = __builtin_convertvector(borders, four_int);
  return whole & ~(whole < 0);
}

static inline uint32_t beam_entry(const stratus_tree* tree, int64_t cell, const int entry_bytes)
{
  uint32_t entry;
  memcpy(&entry, tree->entries + cell * entry_bytes, sizeof entry);
  return entry & (entry_bytes == 3 ? 0xffffffu : 0xffffu);
}

/* Lists the bricks of a layer that have voxels within the beam. Returns their number. */
static inline int beam_bricks(const stratus_hit_batch* batch, const stratus_hit_arguments* a, const hit_beam* beam, int layer,
  four_int cells, four_int voxels, const int entry_bytes, beam_brick* bricks)
{
  const stratus_tree* tree = batch->tree;
  const int p = beam->across[0], q = beam->across[1];
  int at[3], count = 0;
  at[beam->axis] = beam->up[beam->axis] ? layer : a->cells[beam->axis] - 1 - layer;
  for (int j = cells[1]; j <= cells[3]; ++j) {
    for (int i = cells[0]; i <= cells[2]; ++i) {
      const uint32_t entry = beam_entry(tree, beam->origin + layer * beam->step[0] + i * beam->step[1] + j * beam->step[2], entry_bytes);
      if (entry & ((1u << entry_bytes) - 1u)) {
        continue;
      }
      beam_brick* const brick = &bricks[count];
      at[p] = beam->up[p] ? i : a->cells[p] - 1 - i;
      at[q] = beam->up[q] ? j : a->cells[q] - 1 - j;
      brick->at[0] = i;
      brick->at[1] = j;
      brick->mask =
        tree->masks[tree->rows[a->row_start + at[2] * a->cells[1] + at[1]] + (entry >> entry_bytes)] & beam_covers(beam, brick, voxels);
      for (int axis = 0; axis < 3; ++axis) {
        brick->voxel[axis] = (at[axis] + a->at[axis]) * STRATUS_BRICK;
      }
      count += brick->mask != 0;
    }
  }
  return count;
}

/* Crosses a layer of cells between two positions along the axis, voxel by voxel. Returns false once no ray is left. */
static inline bool beam_cross(const stratus_hit_batch* batch, const stratus_hit_arguments* a, const hit_beam* beam, float from, float to,
  four_int cells, const int entry_bytes, beam_rays* rays)
{
  beam_brick bricks[BEAM_BRICKS * BEAM_BRICKS];
  const int layer = (int)from;
  const four_int around = beam_whole(beam_between(beam, from, to) * (float)STRATUS_BRICK);
  const int count = beam_bricks(batch, a, beam, layer, cells, around, entry_bytes, bricks);
  for (int slice = 0; count > 0 && slice < STRATUS_BRICK; ++slice) {
    const uint64_t slab = beam_range(beam, beam->axis, slice, slice);
    const float low = (float)layer + (float)slice / STRATUS_BRICK, high = low + 1.0f / STRATUS_BRICK;
    const four_int voxels = beam_whole(beam_between(beam, low > from ? low : from, high < to ? high : to) * (float)STRATUS_BRICK);
    bool any = false;
    for (int b = 0; b < count; ++b) {
      const beam_brick* brick = &bricks[b];
      uint64_t left = brick->mask & slab;
      for (left = left ? left & beam_covers(beam, brick, voxels) : 0; left; left &= left - 1) {
        const int bit = __builtin_ctzll(left);
        const int voxel[3] = { brick->voxel[0] + (bit & 3), brick->voxel[1] + (bit >> 2 & 3), brick->voxel[2] + (bit >> 4) };
        beam_meet(a, beam, voxel, rays);
        any = true;
      }
    }
    if (any && !beam_settle(rays)) {
      return false;
    }
  }
  return true;
}

/* ---------------------------------------------------------------- the walk */

/* The leap of an entry, or the code of one; 0: the cell has voxels. */
static inline uint32_t beam_code(const hit_beam* beam, uint32_t entry, const int octants, const int entry_bytes)
{
  const uint32_t low = (1u << entry_bytes) - 1u;
  return !(entry & low) ? 0 : octants ? entry >> (beam->octant * entry_bytes) & low : entry >> 2;
}

/* Finds the least leap, or code of one, of all cells from cells[0], cells[1] to cells[2], cells[3] across. `row` is the first of them. */
static inline __attribute__((always_inline)) uint32_t beam_least(
  const stratus_tree* tree, const hit_beam* beam, int64_t row, four_int cells, const int octants, const int entry_bytes)
{
  uint32_t least = UINT32_MAX;
  for (int j = cells[1]; j <= cells[3]; ++j, row += beam->step[2]) {
    int64_t cell = row;
    for (int i = cells[0]; i <= cells[2]; ++i, cell += beam->step[1]) {
      const uint32_t code = beam_code(beam, beam_entry(tree, cell, entry_bytes), octants, entry_bytes);
      least = code < least ? code : least;
    }
  }
  return least;
}

static inline __attribute__((always_inline)) void beam_run(const stratus_hit_batch* batch, const stratus_hit_arguments* a,
  const stratus_hit_chunk* c, const hit_beam* beam, beam_rays* rays, int* looks, const int octants, const int entry_bytes)
{
  int asked = beam->first;
  for (float s = beam->begin; s < beam->end;) {
    asked = stratus_hit_fetch(c, asked, beam->first + BEAM);
    const int layer = (int)s;
    const float border = (float)(layer + 1), to = border < beam->end ? border : beam->end;
    const four_int touched = beam_whole(beam_between(beam, s, to));
    if (touched[0] > beam->last[0] || touched[1] > beam->last[1]) {
      return;
    }
    const four_int beyond = touched > beam->last, cells = (touched & ~beyond) | (beam->last & beyond);
    const int64_t first = beam->origin + layer * beam->step[0] + cells[0] * beam->step[1] + cells[1] * beam->step[2];
    /* The leap of the nearest cell may be so long that all that the beam touches is known to be empty. */
    uint32_t code = beam_code(beam, beam_entry(batch->tree, first, entry_bytes), octants, entry_bytes);
    const int leap = octants && code > 0 ? stratus_leap_of_code(entry_bytes, (int)code) : (int)code;
    *looks += 1;
    if (cells[2] - cells[0] < leap && cells[3] - cells[1] < leap) {
      s = (float)(layer + leap);
      for (int side = 0; side < 2; ++side) {
        const float leave = beam->begin + ((float)(cells[side] + leap) - beam->border[side + 2]) * beam->inverse[side];
        s = leave < s ? leave : s;
      }
      s = s > border ? s : border;
      continue;
    }
    code = code > 0 ? beam_least(batch->tree, beam, first, cells, octants, entry_bytes) : 0;
    *looks += (cells[2] - cells[0] + 1) * (cells[3] - cells[1] + 1) - 1;
    if (code == 0) {
      if (!beam_cross(batch, a, beam, s, to, cells, entry_bytes, rays)) {
        return;
      }
      s = border;
      continue;
    }
    /* So many cells from each of these on are empty. No slope is above 1, so that the beam cannot leave them on a side before. */
    s = (float)(layer + (octants ? stratus_leap_of_code(entry_bytes, (int)code) : (int)code));
  }
}

/* Stores what the rays have met. Each of `live` has its share of the beam's looks. */
static inline void beam_store(const hit_beam* beam, const beam_rays* rays, int live, int looks, stratus_hit_chunk* c)
{
  const vint zero = vi_set(0);
  const int last = beam->first + BEAM, share = live > 0 ? looks / live : 0;
  int i = beam->first;
  for (int ray = beam->first; ray < last; ray += STRATUS_WIDTH) {
    vi_store(c->visited + ray, vi_select(v_le(v_set(0.0f), v_load(c->end + ray)), vi_set(share), zero));
  }
  while (i < last - 1 && !(c->end[i] >= 0.0f)) {
    ++i;
  }
  c->visited[i] += looks - live * share;
  for (int part = 0; part < BEAM_PARTS; ++part) {
    const int at = beam->first + part * STRATUS_WIDTH;
    const vint state =
      vi_select(rays->doubtful[part], vi_set(STRATUS_HIT_DOUBTFUL), vi_select(rays->hit[part], vi_set(STRATUS_HIT_VOXEL), zero));
    vi_store(c->state + at, state);
    for (int axis = 0; axis < 3; ++axis) {
      vi_store(c->cell[axis] + at, rays->cell[axis][part]);
    }
  }
}

/* Walks the rays of a beam that was placed in a field. */
static inline void beam_walk_field(const stratus_hit_batch* batch, const stratus_hit_arguments* a, const stratus_hit_chunk* c,
  const hit_beam* beam, beam_rays* rays, int* looks)
{
  if (!a->octants) {
    beam_run(batch, a, c, beam, rays, looks, 0, 2);
  } else if (a->entry_bytes == 2) {
    beam_run(batch, a, c, beam, rays, looks, 1, 2);
  } else {
    beam_run(batch, a, c, beam, rays, looks, 1, 3);
  }
}

#endif
