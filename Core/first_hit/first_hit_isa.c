/* SPDX-License-Identifier: BSD-3-Clause
 * First hits on the host, compiled for one instruction set, STRATUS_ISA. Rays are gathered in packets, packets walk the tree, a lane whose
 * ray has ended gets the next ray, and hits are computed in double precision. */
#include "first_hit_batch.h"

#include "first_hit_beam_leaves.h"
#include "first_hit_leaves.h"
#include "first_hit_wide_beams.h"

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

/* ---------------------------------------------------------------- rays to chunk */

#define HAIR 4e-7 /* relative error of a t computed in floats */

/* Rays that are prepared together: loops of so many turns become a few vectors each. */
#define BLOCK 16
#define EACH_RAY _Pragma("omp simd") for (int i = 0; i < BLOCK; ++i)

_Static_assert(sizeof(stratus_ray) == 8 * sizeof(double) && STRATUS_HIT_CHUNK % BLOCK == 0, "a ray is eight numbers");

static inline double larger(double a, double b)
{
  return a > b ? a : b;
}
static inline double smaller(double a, double b)
{
  return a < b ? a : b;
}

/* Transposes a block: number c of ray i becomes to[c][i]. */
static inline void take_block(const stratus_ray* rays, double to[8][BLOCK])
{
#if STRATUS_ISA == 2
  for (int half = 0; half < BLOCK; half += 8) {
    __m512d row[8], pair[8], four[8];
    for (int i = 0; i < 8; ++i) {
      row[i] = _mm512_loadu_pd(&rays[half + i]);
    }
    for (int i = 0; i < 4; ++i) { /* numbers 0 2 4 6 of two rays, and 1 3 5 7 */
      pair[i] = _mm512_unpacklo_pd(row[2 * i], row[2 * i + 1]);
      pair[4 + i] = _mm512_unpackhi_pd(row[2 * i], row[2 * i + 1]);
    }
    for (int odd = 0; odd < 2; ++odd) {
      for (int i = 0; i < 2; ++i) { /* 0 4 of four rays, and 2 6 */
        four[2 * i] = _mm512_shuffle_f64x2(pair[4 * odd + 2 * i], pair[4 * odd + 2 * i + 1], 0x88);
        four[2 * i + 1] = _mm512_shuffle_f64x2(pair[4 * odd + 2 * i], pair[4 * odd + 2 * i + 1], 0xdd);
      }
      for (int i = 0; i < 2; ++i) {
        _mm512_storeu_pd(to[odd + 2 * i] + half, _mm512_shuffle_f64x2(four[i], four[i + 2], 0x88));
        _mm512_storeu_pd(to[odd + 2 * i + 4] + half, _mm512_shuffle_f64x2(four[i], four[i + 2], 0xdd));
      }
    }
  }
#else
  for (int i = 0; i < BLOCK; ++i) {
    for (int c = 0; c < 8; ++c) {
      to[c][i] = ((const double*)(const void*)&rays[i])[c];
    }
  }
#endif
}

/* Converts a block's rays to voxel coordinates: origins, directions. */
static inline void transform(const double m[16], double ray[8][BLOCK], double from[3][BLOCK], double along[3][BLOCK])
{
  for (int a = 0; a < 3; ++a) {
    const double x = m[4 * a], y = m[4 * a + 1], z = m[4 * a + 2], w = m[4 * a + 3];
    EACH_RAY
    {
      from[a][i] = x * ray[0][i] + y * ray[1][i] + z * ray[2][i] + w;
      along[a][i] = x * ray[3][i] + y * ray[4][i] + z * ray[5][i];
    }
  }
}

/* Converts a block of rays to places at .. at + BLOCK - 1 of the chunk. Returns 0 if stratus_ray_usable() holds for all of them. */
static inline double prepare_block(const stratus_hit_batch* batch, const stratus_ray* rays, stratus_hit_chunk* chunk, int at)
{
  double ray[8][BLOCK], from[3][BLOCK], along[3][BLOCK], most[BLOCK], first[BLOCK], last[BLOCK], wrong = 0.0;
  const double slack = 8.0 * (double)batch->slack;
  take_block(rays, ray);
  transform(batch->to_voxels, ray, from, along);
#pragma omp simd reduction(+ : wrong)
  for (int i = 0; i < BLOCK; ++i) {
    const double longest = larger(larger(fabs(along[0][i]), fabs(along[1][i])), fabs(along[2][i]));
    const double sum = from[0][i] + from[1][i] + from[2][i] + along[0][i] + along[1][i] + along[2][i];
    wrong += 0.0 * (sum + ray[6][i]) + (longest >= STRATUS_RAY_SHORTEST ? 0.0 : 1.0) + (ray[7][i] == ray[7][i] ? 0.0 : 1.0);
    most[i] = 1.0 / longest;
    first[i] = ray[6][i] * longest;
    last[i] = smaller(ray[7][i], 1e300) * longest;
  }
  for (int a = 0; a < 3; ++a) {
    const double lo = batch->lo[a], hi = batch->hi[a];
    float* restrict const d = chunk->d[a] + at, * restrict const inverse = chunk->inverse[a] + at;
    EACH_RAY
    {
      const float unit = (float)(along[a][i] * most[i]);
      const float used = fabsf(unit) < 1e-30f ? (unit < 0.0f ? -1e-30f : 1e-30f) : unit, one_over = 1.0f / used;
      /* The slack keeps a ray that runs within a face of the box inside the box everywhere, not only from t = 0 on. */
      const double hair = fabsf(unit) < 1e-30f ? slack : 0.0;
      const double t0 = (lo - hair - from[a][i]) * (double)one_over, t1 = (hi + hair - from[a][i]) * (double)one_over;
      const double enter = smaller(t0, t1), leave = larger(t0, t1);
      first[i] = larger(first[i], enter - HAIR * fabs(enter) - slack);
      last[i] = smaller(last[i], leave + HAIR * fabs(leave));
      d[i] = used;
      inverse[i] = one_over;
    }
  }
  EACH_RAY
  {
    const double length = last[i] - first[i];
    chunk->end[at + i] = length + slack >= 0.0 ? (float)(smaller(length, 1e30) + slack) : -1.0f;
  }
  for (int a = 0; a < 3; ++a) {
    const double lo = batch->lo[a], inside = batch->hi[a] - 0.5; /* in the last voxel */
    EACH_RAY
    {
      const double p = from[a][i] + first[i] * (along[a][i] * most[i]);
      chunk->o[a][at + i] = (float)p;
      chunk->cell[a][at + i] = (int)smaller(larger(p, lo), inside);
    }
  }
  return wrong;
}

static int find_bad(const stratus_hit_batch* batch, const stratus_ray* rays, int count)
{
  int i = 0;
  while (i < count - 1 && stratus_ray_usable(batch->to_voxels, rays + i)) {
    ++i;
  }
  return i;
}

/* Converts rays to a chunk, in which t is in units of a ray's longest component. The entry into the root's box is computed in floats, a
 * hair early. It only sets where the walk begins; a voxel met there by mistake is rejected when its hit is computed. */
static bool prepare(const stratus_hit_batch* batch, const stratus_ray* rays, int count, stratus_hit_chunk* chunk, int* bad)
{
  double wrong = 0.0;
  int i = 0;
  chunk->count = count;
  for (; i + BLOCK <= count; i += BLOCK) {
    wrong += prepare_block(batch, rays + i, chunk, i);
  }
  if (i < count) { /* repeat the last ray to fill the block */
    stratus_ray rest[BLOCK];
    for (int k = 0; k < BLOCK; ++k) {
      rest[k] = rays[i + k < count ? i + k : count - 1];
    }
    wrong += prepare_block(batch, rest, chunk, i);
  }
  if (!(wrong == 0.0)) {
    *bad = find_bad(batch, rays, count);
    return false;
  }
  return true;
}

/* ---------------------------------------------------------------- walk */

/* Sets the lanes of `mask` to consecutive values from p. */
static inline vfloat expand(vfloat old, vmask mask, const int* lanes, int count, const float* p)
{
#if STRATUS_ISA == 2
  (void)lanes;
  (void)count;
  return _mm512_mask_expandloadu_ps(old, mask, p);
#else
  float values[STRATUS_WIDTH];
  (void)mask;
  v_store(values, old);
  for (int i = 0; i < count; ++i) {
    values[lanes[i]] = p[i];
  }
  return v_load(values);
#endif
}

static inline vint expand_int(vint old, vmask mask, const int* lanes, int count, const int* p)
{
#if STRATUS_ISA == 2
  (void)lanes;
  (void)count;
  return (vint)_mm512_mask_expandloadu_epi32((__m512i)old, mask, p);
#else
  int values[STRATUS_WIDTH];
  (void)mask;
  vi_store(values, old);
  for (int i = 0; i < count; ++i) {
    values[lanes[i]] = p[i];
  }
  return vi_load(values);
#endif
}

typedef struct stream {
  stratus_hit_chunk* chunk;
  int* next; /* next ray of the chunk, shared by all packets */
  int last;  /* the ray that they end before */
  vint id;   /* ray in each lane, -1: none */
} stream;

/* base[at[lane]] = value[lane] for lanes of the mask. */
static inline void scatter(int* base, vint at, vint value, vmask mask)
{
#if STRATUS_ISA == 2
  _mm512_mask_i32scatter_epi32(base, mask, (__m512i)at, (__m512i)value, 4);
#else
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    if (mask[lane]) {
      base[at[lane]] = value[lane];
    }
  }
#endif
}

/* Returns the first `count` lanes of a mask, and lists their numbers where expand() needs them. */
static inline vmask first_lanes(vmask mask, int count, int* lanes)
{
#if STRATUS_ISA == 2
  (void)lanes;
  unsigned left = mask;
  for (int i = m_count(mask); i > count; --i) {
    left &= ~(1u << (31 - __builtin_clz(left)));
  }
  return (vmask)left;
#else
  int n = 0;
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    if (mask[lane] && n < count) {
      lanes[n++] = lane;
    } else {
      mask[lane] = 0;
    }
  }
  return mask;
#endif
}

/* Stores the results of lanes whose ray has ended, and gives those lanes the next rays. Without a search they begin in the field. */
static inline __attribute__((always_inline)) void refill(
  const stratus_hit_arguments* a, stream* s, stratus_hit_packet* k, stratus_hit_search* search)
{
  static const int numbers[16] = { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15 };
  stratus_hit_chunk* const c = s->chunk;
  const vint zero = vi_set(0);
  const vmask busy = k->live | k->seeking;
  const vmask free = m_andnot(vi_ge(zero, zero), busy), ended = free & vi_ge(s->id, zero);
  int lanes[STRATUS_WIDTH];
  const vint state = vi_select(k->doubtful, vi_set(STRATUS_HIT_DOUBTFUL), vi_select(k->hit, vi_set(STRATUS_HIT_VOXEL), zero));
  scatter(c->state, s->id, state, ended);
  scatter(c->visited, s->id, k->visited, ended);
  for (int axis = 0; axis < 3; ++axis) {
    scatter(c->cell[axis], s->id, k->cell[axis], ended);
  }
  const int first = *s->next, left = s->last - first, places = m_count(free), count = left < places ? left : places;
  const vmask fresh = first_lanes(free, count, lanes);
  s->id = vi_select(free, vi_set(-1), s->id);
  s->id = vi_select(fresh, expand_int(zero, fresh, lanes, count, numbers) + vi_set(first), s->id);
  *s->next += count;
  vint octant = zero;
  for (int axis = 0; axis < 3; ++axis) {
    k->o[axis] = expand(k->o[axis], fresh, lanes, count, c->o[axis] + first);
    k->d[axis] = expand(k->d[axis], fresh, lanes, count, c->d[axis] + first);
    k->inverse[axis] = expand(k->inverse[axis], fresh, lanes, count, c->inverse[axis] + first);
    k->cell[axis] = expand_int(k->cell[axis], fresh, lanes, count, c->cell[axis] + first);
    k->up[axis] = v_lt(v_set(0.0f), k->d[axis]);
    octant = octant | vi_select(k->up[axis], vi_set(1 << axis), zero);
  }
  k->octant_shift = octant * vi_set(a->entry_bytes);
  k->end = expand(k->end, fresh, lanes, count, c->end + first);
  k->hit = m_none();
  k->doubtful = m_none();
  k->visited = vi_select(fresh, zero, k->visited);
  const vmask started = fresh & v_le(v_set(0.0f), k->end);
  if (search) {
    hit_begin(k, search, started);
  } else {
    k->live = k->live | started;
  }
}

/* A lane whose ray has ended costs as much as a live one. This many may be idle before they get new rays. */
#define IDLE (STRATUS_WIDTH / 4)

/* Returns false once the packet's rays have ended and no ray is left. */
static inline __attribute__((always_inline)) bool keep_busy(
  const stratus_hit_arguments* a, stream* s, stratus_hit_packet* k, stratus_hit_search* search)
{
  const int live = m_count(k->live | k->seeking);
  if (live == STRATUS_WIDTH || (live > 0 && (*s->next >= s->last || STRATUS_WIDTH - live < IDLE))) {
    return true;
  }
  do {
    refill(a, s, k, search);
  } while (!m_any(k->live | k->seeking) && *s->next < s->last);
  return m_any(k->live | k->seeking);
}

/* Packets walked in turn. A step is a chain of dependent loads and sums, and while one packet waits the next computes. */
#define PACKETS 2

static stratus_hit_tables tables_of(const stratus_tree* tree)
{
  return (stratus_hit_tables){ tree->entries, (const int*)tree->rows, (const int*)(const void*)tree->masks,
    (const int*)(const void*)tree->nodes, (const int*)(const void*)tree->fields, (const int*)(const void*)tree->bricks };
}

/* Walks the chunk's rays first .. last - 1 in packets. */
static inline __attribute__((always_inline)) void walk_rays(const stratus_hit_batch* batch, const stratus_hit_arguments* a,
  stratus_hit_chunk* chunk, int first, int last, const int kind, const int octants, const int entry_bytes, const int cell_log2)
{
  const stratus_hit_tables tables = tables_of(batch->tree);
  stream s[PACKETS];
  stratus_hit_packet k[PACKETS];
  stratus_hit_search search[PACKETS];
  int next = first, asked = first;
  memset(k, 0, sizeof k);
  for (int p = 0; p < PACKETS; ++p) {
    s[p] = (stream){ .chunk = chunk, .next = &next, .last = last, .id = vi_set(-1) };
    search[p].top = search[p].node = search[p].count = search[p].first = search[p].key = search[p].number = vi_set(0);
  }
  for (bool busy = true; busy;) {
    asked = stratus_hit_fetch(chunk, asked, last);
    busy = false;
    for (int p = 0; p < PACKETS; ++p) {
      busy |= keep_busy(a, &s[p], &k[p], kind == STRATUS_HIT_LEAVES ? &search[p] : NULL);
    }
    for (int p = 0; p < PACKETS; ++p) {
      if (kind == STRATUS_HIT_LEAVES) {
        hit_step_leaves(a, &tables, &k[p], &search[p], octants, entry_bytes, cell_log2);
      } else {
        hit_step(a, &tables, &k[p], kind, octants, entry_bytes, cell_log2);
      }
    }
  }
  for (int p = 0; p < PACKETS; ++p) {
    refill(a, &s[p], &k[p], kind == STRATUS_HIT_LEAVES ? &search[p] : NULL);
  }
}

static inline __attribute__((always_inline)) void walk_kind(
  const stratus_hit_batch* batch, const stratus_hit_arguments* a, stratus_hit_chunk* chunk, int first, int last, const int kind)
{
  if (!a->octants && a->cell_log2) {
    walk_rays(batch, a, chunk, first, last, kind, 0, 2, 2);
  } else if (!a->octants) {
    walk_rays(batch, a, chunk, first, last, kind, 0, 2, 0);
  } else if (a->entry_bytes == 2) {
    walk_rays(batch, a, chunk, first, last, kind, 1, 2, 2);
  } else {
    walk_rays(batch, a, chunk, first, last, kind, 1, 3, 2);
  }
}

static void walk_packets(const stratus_hit_batch* batch, const stratus_hit_arguments* a, stratus_hit_chunk* chunk, int first, int last)
{
  if (batch->leaves) {
    walk_kind(batch, a, chunk, first, last, STRATUS_HIT_LEAVES);
  } else {
    walk_kind(batch, a, chunk, first, last, STRATUS_HIT_FIELD);
  }
}

/* Walks the chunk's rays first .. last - 1 without beams. */
static void walk_rest(const stratus_hit_batch* batch, const stratus_hit_arguments* a, stratus_hit_chunk* chunk, int first, int last)
{
  if (first == last) {
    return;
  }
  if (batch->tree->wide.node_count) {
    wide_walk(batch, chunk, first, last);
  } else {
    walk_packets(batch, a, chunk, first, last);
  }
}

/* Rays that follow each other go in beams where these are narrow, the others in packets. */
static void walk(const stratus_hit_batch* batch, stratus_hit_chunk* chunk)
{
  const bool wide = batch->tree->wide.node_count > 0;
  const stratus_hit_arguments a = stratus_hit_arguments_of(batch);
  const bool beams = wide || a.cell_log2;
  int waiting = 0; /* the first ray that is neither in a beam nor walked */
  for (int first = 0; first < chunk->count; first += BEAM) {
    const bool whole = first + BEAM <= chunk->count;
    if (beams && whole && (wide ? wide_beam_walk(batch, first, chunk) : beam_walk(batch, &a, first, chunk))) {
      walk_rest(batch, &a, chunk, waiting, first);
      waiting = first + BEAM;
    }
  }
  walk_rest(batch, &a, chunk, waiting, chunk->count);
}

/* ---------------------------------------------------------------- chunk to hits */

static void finish(const stratus_hit_batch* batch, const stratus_ray* rays, const stratus_hit_chunk* chunk, stratus_hit* hits)
{
  for (int i = 0; i < chunk->count; ++i) {
    stratus_hit* const hit = &hits[i];
    *hit = (stratus_hit){ .t = INFINITY, .voxel = { -1, -1, -1 }, .face = -1, .visited = (uint32_t)chunk->visited[i] };
    if (chunk->state[i] == STRATUS_HIT_NONE) {
      continue;
    }
    bool certain = chunk->state[i] == STRATUS_HIT_VOXEL;
    if (certain) {
      const int voxel[3] = { chunk->cell[0][i], chunk->cell[1][i], chunk->cell[2][i] };
      stratus_hit_of_voxel(batch, &rays[i], voxel, hit);
      certain = hit->t < INFINITY;
    }
    if (!certain) {
      stratus_first_hit_exact(batch, &rays[i], hit);
      hit->visited += (uint32_t)chunk->visited[i];
    }
  }
}

const stratus_hit_functions STRATUS_ISA_NAME(stratus_hit_functions) = { prepare, walk, finish };
