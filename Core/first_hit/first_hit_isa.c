/* SPDX-License-Identifier: BSD-3-Clause
 * First hits on the host, compiled for one instruction set, STRATUS_ISA. Rays are gathered in packets, packets walk the field, a lane whose
 * ray has ended gets the next ray, and hits are computed in double precision. */
#include "first_hit_batch.h"

#include "first_hit.h"

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

/* ---------------------------------------------------------------- rays to chunk */

#define HAIR 4e-7 /* relative error of a t computed in floats */

/* A loop over a chunk in a form that the compiler vectorizes. */
#define EACH_RAY _Pragma("omp simd") for (int i = 0; i < n; ++i)

static inline double larger(double a, double b)
{
  return a > b ? a : b;
}
static inline double smaller(double a, double b)
{
  return a < b ? a : b;
}

/* Converts rays to voxel coordinates. */
static void transform(
  const stratus_hit_batch* batch, const stratus_ray* rays, stratus_hit_chunk* chunk, double* restrict first, double* restrict last)
{
  const double* m = batch->to_voxels;
  const int n = chunk->count;
  for (int a = 0; a < 3; ++a) {
    double* restrict const from = chunk->from[a], * restrict const along = chunk->along[a];
    const double x = m[4 * a], y = m[4 * a + 1], z = m[4 * a + 2], w = m[4 * a + 3];
    EACH_RAY
    {
      from[i] = x * rays[i].origin[0] + y * rays[i].origin[1] + z * rays[i].origin[2] + w;
      along[i] = x * rays[i].direction[0] + y * rays[i].direction[1] + z * rays[i].direction[2];
    }
  }
  for (int i = 0; i < n; ++i) {
    first[i] = rays[i].t_min;
    last[i] = rays[i].t_max;
  }
}

/* Computes the length of each ray's longest component. Returns 0 if stratus_ray_usable() holds for all rays. */
static double measure(const stratus_hit_chunk* chunk, const double* restrict first, const double* restrict last, double* restrict most)
{
  const int n = chunk->count;
  double wrong = 0.0;
#pragma omp simd reduction(+ : wrong)
  for (int i = 0; i < n; ++i) {
    const double longest = larger(larger(fabs(chunk->along[0][i]), fabs(chunk->along[1][i])), fabs(chunk->along[2][i]));
    const double sum =
      chunk->from[0][i] + chunk->from[1][i] + chunk->from[2][i] + chunk->along[0][i] + chunk->along[1][i] + chunk->along[2][i];
    most[i] = longest;
    wrong += 0.0 * (sum + first[i]) + (longest >= STRATUS_RAY_SHORTEST ? 0.0 : 1.0) + (last[i] == last[i] ? 0.0 : 1.0);
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
  double first[STRATUS_HIT_CHUNK], last[STRATUS_HIT_CHUNK], most[STRATUS_HIT_CHUNK];
  const int n = count;
  const double slack = 8.0 * (double)batch->slack;
  chunk->count = count;
  transform(batch, rays, chunk, first, last);
  if (!(measure(chunk, first, last, most) == 0.0)) {
    *bad = find_bad(batch, rays, count);
    return false;
  }
  EACH_RAY
  {
    first[i] = first[i] * most[i];
    last[i] = smaller(last[i], 1e300) * most[i];
    most[i] = 1.0 / most[i];
  }
  for (int a = 0; a < 3; ++a) {
    const double lo = batch->lo[a], hi = batch->hi[a];
    const double* restrict const from = chunk->from[a], * restrict const along = chunk->along[a];
    float* restrict const d = chunk->d[a], * restrict const inverse = chunk->inverse[a];
    EACH_RAY
    {
      const float unit = (float)(along[i] * most[i]);
      d[i] = fabsf(unit) < 1e-30f ? (unit < 0.0f ? -1e-30f : 1e-30f) : unit;
      inverse[i] = 1.0f / d[i];
      /* The slack keeps a ray that runs within a face of the box inside the box all the way, not only from t = 0 on. */
      const double hair = fabsf(unit) < 1e-30f ? slack : 0.0;
      const double t0 = (lo - hair - from[i]) * (double)inverse[i], t1 = (hi + hair - from[i]) * (double)inverse[i];
      const double enter = smaller(t0, t1), leave = larger(t0, t1);
      first[i] = larger(first[i], enter - HAIR * fabs(enter) - slack);
      last[i] = smaller(last[i], leave + HAIR * fabs(leave));
    }
  }
  EACH_RAY
  {
    const double length = last[i] - first[i];
    chunk->end[i] = length + slack >= 0.0 ? (float)(smaller(length, 1e30) + slack) : -1.0f;
  }
  for (int a = 0; a < 3; ++a) {
    const double lo = batch->lo[a], inside = batch->hi[a] - 0.5; /* in the last voxel */
    const double* restrict const from = chunk->from[a], * restrict const along = chunk->along[a];
    float* restrict const o = chunk->o[a];
    int* restrict const cell = chunk->cell[a];
    EACH_RAY
    {
      const double p = from[i] + first[i] * (along[i] * most[i]);
      o[i] = (float)p;
      cell[i] = (int)smaller(larger(p, lo), inside);
    }
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

/* Stores the results of lanes whose ray has ended, and gives those lanes the next rays. */
static void refill(const stratus_hit_arguments* a, stream* s, stratus_hit_packet* k)
{
  static const int numbers[16] = { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15 };
  stratus_hit_chunk* const c = s->chunk;
  const vint zero = vi_set(0);
  const vmask free = m_andnot(vi_ge(zero, zero), k->live), ended = free & vi_ge(s->id, zero);
  int lanes[STRATUS_WIDTH];
  const vint state = vi_select(k->doubtful, vi_set(STRATUS_HIT_DOUBTFUL), vi_select(k->hit, vi_set(STRATUS_HIT_VOXEL), zero));
  scatter(c->state, s->id, state, ended);
  scatter(c->visited, s->id, k->visited, ended);
  for (int axis = 0; axis < 3; ++axis) {
    scatter(c->cell[axis], s->id, k->cell[axis], ended);
  }
  const int first = *s->next, left = c->count - first, places = m_count(free), count = left < places ? left : places;
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
  k->live = k->live | (fresh & v_le(v_set(0.0f), k->end));
}

/* A lane whose ray has ended costs as much as a live one. This many may be idle before they get new rays. */
#define IDLE (STRATUS_WIDTH / 4)

/* Returns false once the packet's rays have ended and no ray is left. */
static inline bool keep_busy(const stratus_hit_arguments* a, stream* s, stratus_hit_packet* k)
{
  const int live = m_count(k->live);
  if (live == STRATUS_WIDTH || (live > 0 && (*s->next >= s->chunk->count || STRATUS_WIDTH - live < IDLE))) {
    return true;
  }
  do {
    refill(a, s, k);
  } while (!m_any(k->live) && *s->next < s->chunk->count);
  return m_any(k->live);
}

/* Packets walked in turn. A step is a chain of dependent loads and sums, and while one packet waits the next computes. */
#define PACKETS 2

/* Cache lines of the next chunk's rays prefetched per step. Without them each chunk would begin by waiting for memory. */
#define LINES 4

static inline __attribute__((always_inline)) void walk_field(const stratus_hit_batch* batch, const stratus_hit_arguments* a,
  stratus_hit_chunk* chunk, const int octants, const int entry_bytes, const int cell_log2)
{
  const stratus_tree* tree = batch->tree;
  stream s[PACKETS];
  stratus_hit_packet k[PACKETS];
  int next = 0;
  memset(k, 0, sizeof k);
  for (int p = 0; p < PACKETS; ++p) {
    s[p] = (stream){ .chunk = chunk, .next = &next, .id = vi_set(-1) };
  }
  const char* const ahead = chunk->ahead;
  size_t asked = 0;
  for (bool busy = true; busy;) {
    for (int line = 0; line < LINES && asked < chunk->ahead_bytes; ++line, asked += 64) {
      __builtin_prefetch(ahead + asked);
    }
    busy = false;
    for (int p = 0; p < PACKETS; ++p) {
      busy |= keep_busy(a, &s[p], &k[p]);
    }
    for (int p = 0; p < PACKETS; ++p) {
      hit_step(a, tree->entries, (const int*)tree->rows, batch->mask_words, &k[p], octants, entry_bytes, cell_log2);
    }
  }
  for (int p = 0; p < PACKETS; ++p) {
    refill(a, &s[p], &k[p]);
  }
}

static void walk(const stratus_hit_batch* batch, stratus_hit_chunk* chunk)
{
  const stratus_tree* tree = batch->tree;
  const stratus_tree_field* field = &tree->fields[0];
  const stratus_hit_arguments a = { .at = { field->at[0], field->at[1], field->at[2] },
    .cells = { field->cells[0], field->cells[1], field->cells[2] },
    .row_start = (int)field->first_row,
    .octants = tree->octants,
    .entry_bytes = tree->entry_bytes,
    .cell_log2 = tree->cell_log2,
    .slack = batch->slack };
  if (!tree->octants && tree->cell_log2) {
    walk_field(batch, &a, chunk, 0, 2, 2);
  } else if (!tree->octants) {
    walk_field(batch, &a, chunk, 0, 2, 0);
  } else if (tree->entry_bytes == 2) {
    walk_field(batch, &a, chunk, 1, 2, 2);
  } else {
    walk_field(batch, &a, chunk, 1, 3, 2);
  }
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
    const double from[3] = { chunk->from[0][i], chunk->from[1][i], chunk->from[2][i] };
    const double along[3] = { chunk->along[0][i], chunk->along[1][i], chunk->along[2][i] };
    const int voxel[3] = { chunk->cell[0][i], chunk->cell[1][i], chunk->cell[2][i] };
    bool certain = chunk->state[i] == STRATUS_HIT_VOXEL;
    if (certain) {
      stratus_hit_of_voxel(batch, &rays[i], from, along, voxel, hit);
      certain = hit->t < INFINITY;
    }
    if (!certain) {
      stratus_first_hit_exact(batch, &rays[i], hit);
      hit->visited += (uint32_t)chunk->visited[i];
    }
  }
}

const stratus_hit_functions STRATUS_ISA_NAME(stratus_hit_functions) = { prepare, walk, finish };
