/* SPDX-License-Identifier: BSD-3-Clause
 * First hits in wide hierarchies. The boxes of a node's 16 children are tested at once against one ray, grown by the slack of positions in
 * float, so that none is missed. Several rays alternate: while one waits for a node of its own, the others compute. In a brick floats find
 * the voxels that the ray may meet, and doubles decide between them as voxel_walk.c does, so that no ray is left in doubt on the host.
 * Devices return such rays to the host.
 *
 * Included by first_hit_isa.c. */
#ifndef STRATUS_FIRST_HIT_WIDE_H
#define STRATUS_FIRST_HIT_WIDE_H

#include "first_hit_batch.h"

#include "packet.h"

#define WIDE_RAYS 8            /* that take turns */
#define WIDE_BRICK 0x80000000u /* set in a brick's number on the stack */

/* A ray, and its hit so far. */
typedef struct wide_line {
  float inverse[3];
  float early[3], late[3]; /* the origin, off by the slack: planes are met at (p - early) * inverse at the earliest, and so on */
  float end;               /* voxels that the ray enters behind it cannot be its hit */
  stratus_hit hit;
} wide_line;

typedef struct wide_ray {
  wide_line* line;
  int near[3], far[3]; /* offsets in a node: the planes of boxes where the ray enters and leaves them */
  int number;          /* in the chunk; -1: none */
  int top;
  uint32_t visited;
  /* Where the ray enters, as the bits of a float >= 0, which are ordered as the float is, above the number of the node or brick. Sorting
   * writes four entries at once. */
  uint64_t stack[STRATUS_WIDE_STACK + 4];
} wide_ray;

static inline float float_of(uint32_t bits)
{
  float f;
  memcpy(&f, &bits, sizeof f);
  return f;
}

static inline uint32_t bits_of(float f)
{
  uint32_t bits;
  memcpy(&bits, &f, sizeof bits);
  return bits;
}

/* Put an entry on the stack, below the entries of the same node that the ray enters earlier. */
static inline void wide_push(wide_ray* r, int least, uint64_t entry)
{
  int at = r->top++;
  for (; at > least && r->stack[at - 1] < entry; --at) {
    r->stack[at] = r->stack[at - 1];
  }
  r->stack[at] = entry;
}

static inline uint32_t wide_child(const stratus_wide_node* node, int c)
{
  return c < node->inner ? node->node + (uint32_t)c : (node->brick + (uint32_t)(c - node->inner)) | WIDE_BRICK;
}

#if STRATUS_ISA == 2
/* Pushes the children of `met`; no branch depends on how many of them are four or fewer. */
static inline void wide_push_all(wide_ray* r, const stratus_wide_node* node, __m512 enter, __mmask16 met)
{
  const int count = __builtin_popcount(met), inner = node->inner;
  const __m512i lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  const __m512i first = _mm512_mask_blend_epi32((__mmask16)((1u << inner) - 1),
    _mm512_set1_epi32((int)(node->brick - (uint32_t)inner + WIDE_BRICK)), _mm512_set1_epi32((int)node->node));
  const __m512i t = _mm512_maskz_compress_epi32(met, _mm512_castps_si512(enter));
  const __m512i n = _mm512_maskz_compress_epi32(met, _mm512_add_epi32(first, lanes));
  if (__builtin_expect(count <= 4, 1)) {
    const __m128i t4 = _mm512_castsi512_si128(t), n4 = _mm512_castsi512_si128(n);
    __m256i k = _mm256_inserti128_si256(_mm256_castsi128_si256(_mm_unpacklo_epi32(n4, t4)), _mm_unpackhi_epi32(n4, t4), 1), other;
    /* Four entries are sorted by three rounds of exchanges, the greatest first. Empty ones are 0 and come last, above the top. */
    other = _mm256_permute4x64_epi64(k, 0xb1);
    k = _mm256_blend_epi32(_mm256_max_epu64(k, other), _mm256_min_epu64(k, other), 0xcc);
    other = _mm256_permute4x64_epi64(k, 0x4e);
    k = _mm256_blend_epi32(_mm256_max_epu64(k, other), _mm256_min_epu64(k, other), 0xf0);
    other = _mm256_permute4x64_epi64(k, 0xd8);
    k = _mm256_blend_epi32(_mm256_max_epu64(k, other), _mm256_min_epu64(k, other), 0x30);
    _mm256_storeu_si256((__m256i*)(void*)(r->stack + r->top), k);
    r->top += count;
    return;
  }
  uint32_t enters[STRATUS_WIDE], numbers[STRATUS_WIDE];
  const int least = r->top;
  _mm512_storeu_si512(enters, t);
  _mm512_storeu_si512(numbers, n);
  for (int i = 0; i < count; ++i) {
    wide_push(r, least, (uint64_t)enters[i] << 32 | numbers[i]);
  }
}

static inline vfloat wide_planes(const uint8_t bytes[STRATUS_WIDE])
{
  return _mm512_cvtepi32_ps(_mm512_cvtepu8_epi32(_mm_loadu_si128((const __m128i*)(const void*)bytes)));
}
#else
static inline vfloat wide_planes(const uint8_t bytes[STRATUS_WIDTH])
{
#if STRATUS_ISA == 1
  return (vfloat)_mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i*)(const void*)bytes)));
#else
  vfloat f;
  for (int i = 0; i < STRATUS_WIDTH; ++i) {
    f[i] = bytes[i];
  }
  return f;
#endif
}
#endif

/* Pushes the children of the node that the ray may meet before its end. Places without a child are masked out by number: a ray that begins
 * very far away meets all planes at one distance, as floats round it, and so a box of any planes. */
static inline void wide_node(const stratus_wide_node* node, wide_ray* r)
{
  const uint32_t children = (1u << node->count) - 1;
  const float scale = float_of((uint32_t)(node->shift + 127) << 23); /* 2^shift */
#if STRATUS_ISA != 2
  const int least = r->top;
#endif
  ++r->visited;
  for (int part = 0; part < STRATUS_WIDE; part += STRATUS_WIDTH) {
    vfloat enter = v_set(0.0f), leave = v_set(r->line->end);
    for (int a = 0; a < 3; ++a) {
      const float inverse = r->line->inverse[a];
      const vfloat speed = v_set(scale * inverse);
      const vfloat near = wide_planes((const uint8_t*)node + r->near[a] + part), far = wide_planes((const uint8_t*)node + r->far[a] + part);
      enter = v_max(v_fma(near, speed, v_set((node->at[a] - r->line->early[a]) * inverse)), enter);
      leave = v_min(v_fma(far, speed, v_set((node->at[a] - r->line->late[a]) * inverse)), leave);
    }
    const vmask met = v_le(enter, leave);
#if STRATUS_ISA == 2
    wide_push_all(r, node, enter, met & (__mmask16)children);
#else
    if (m_any(met)) {
      for (int i = 0; i < STRATUS_WIDTH; ++i) {
        if (met[i] && (children >> (part + i) & 1)) {
          wide_push(r, least, (uint64_t)bits_of(enter[i]) << 32 | wide_child(node, part + i));
        }
      }
    }
#endif
  }
}

/* Whether a hit comes before another: crossings of equal t come in the order of their axes, the ray's own start last. */
static inline bool wide_before(const stratus_hit* a, const stratus_hit* b)
{
  const int axis_a = a->face < 0 ? 3 : a->face / 2, axis_b = b->face < 0 ? 3 : b->face / 2;
  return a->t < b->t || (a->t == b->t && a->t < INFINITY && axis_a < axis_b);
}

static inline float wide_larger(float a, float b)
{
  return a > b ? a : b;
}
static inline float wide_smaller(float a, float b)
{
  return a < b ? a : b;
}

/* Tries the brick's voxels that the ray may meet, the nearest first. */
static void wide_brick(const stratus_hit_batch* batch, const stratus_ray* ray, const stratus_brick* brick, wide_line* r)
{
  float enter[3][4], late[3][4], leave[3][4]; /* where the ray enters voxels of a layer at the earliest, at the latest, and leaves them */
  float at[64];
  uint64_t open = brick->mask;
  for (int a = 0; a < 3; ++a) {
    const int up = r->inverse[a] > 0.0f;
    for (int i = 0; i < 4; ++i) {
      const int lo = 4 * brick->at[a] + i;
      const float near = (float)(lo + !up), far = (float)(lo + up);
      enter[a][i] = (near - r->early[a]) * r->inverse[a];
      late[a][i] = (near - r->late[a]) * r->inverse[a];
      leave[a][i] = (far - r->late[a]) * r->inverse[a];
    }
  }
  for (uint64_t left = brick->mask; left; left &= left - 1) {
    const int bit = __builtin_ctzll(left), x = bit & 3, y = bit >> 2 & 3, z = bit >> 4;
    const float to = wide_smaller(wide_smaller(r->end, leave[0][x]), wide_smaller(leave[1][y], leave[2][z]));
    at[bit] = wide_larger(wide_larger(0.0f, enter[0][x]), wide_larger(enter[1][y], enter[2][z]));
    open ^= (uint64_t)(at[bit] > to) << bit;
  }
  while (open) {
    int bit = __builtin_ctzll(open);
    for (uint64_t left = open & (open - 1); left; left &= left - 1) {
      const int other = __builtin_ctzll(left);
      bit = at[other] < at[bit] ? other : bit;
    }
    open &= ~(1ull << bit);
    if (at[bit] > r->end) {
      return;
    }
    const int in[3] = { bit & 3, bit >> 2 & 3, bit >> 4 };
    const int voxel[3] = { 4 * brick->at[0] + in[0], 4 * brick->at[1] + in[1], 4 * brick->at[2] + in[2] };
    stratus_hit hit;
    stratus_hit_of_voxel(batch, ray, voxel, &hit);
    if (wide_before(&hit, &r->hit)) {
      r->hit = hit;
      r->end = wide_smaller(r->end, wide_larger(0.0f, wide_larger(late[0][in[0]], wide_larger(late[1][in[1]], late[2][in[2]]))));
    }
  }
}

static inline void wide_line_begin(const stratus_hit_batch* batch, const stratus_hit_chunk* chunk, int number, wide_line* r)
{
  for (int a = 0; a < 3; ++a) {
    const float inverse = chunk->inverse[a][number], o = chunk->o[a][number], grown = inverse > 0.0f ? batch->slack : -batch->slack;
    r->inverse[a] = inverse;
    r->early[a] = o + grown;
    r->late[a] = o - grown;
  }
  r->end = chunk->end[number];
  r->hit = (stratus_hit){ .t = INFINITY };
}

/* Rays of a chunk that are not begun yet. */
typedef struct wide_rest {
  int next, last;
} wide_rest;

/* Gives r->line a ray, and r->number, r->top and r->stack; r->number is -1 if none is left. */
typedef void wide_next(const stratus_hit_batch* batch, const stratus_hit_chunk* chunk, void* rest, wide_ray* r);

static inline void wide_next_of_chunk(const stratus_hit_batch* batch, const stratus_hit_chunk* chunk, void* rest, wide_ray* r)
{
  wide_rest* const left = rest;
  while (left->next < left->last && chunk->end[left->next] < 0.0f) {
    ++left->next;
  }
  r->number = left->next < left->last ? left->next++ : -1;
  if (r->number >= 0) {
    wide_line_begin(batch, chunk, r->number, r->line);
    r->top = 1;
    r->stack[0] = 0;
  }
}

/* Offsets in a node: the planes of boxes where rays enter and leave them that run along an axis, or against it. */
static inline void wide_sides(int axis, bool up, int* near, int* far)
{
  const int lo = (int)(offsetof(stratus_wide_node, lo) + STRATUS_WIDE * (size_t)axis),
            hi = (int)(offsetof(stratus_wide_node, hi) + STRATUS_WIDE * (size_t)axis);
  *near = up ? lo : hi;
  *far = up ? hi : lo;
}

static inline __attribute__((always_inline)) bool wide_begin(
  const stratus_hit_batch* batch, const stratus_hit_chunk* chunk, wide_next* next, void* rest, wide_ray* r)
{
  next(batch, chunk, rest, r);
  for (int a = 0; r->number >= 0 && a < 3; ++a) {
    wide_sides(a, r->line->inverse[a] > 0.0f, &r->near[a], &r->far[a]);
  }
  r->visited = 0;
  return r->number >= 0;
}

static void wide_end(stratus_hit_chunk* chunk, const wide_ray* r)
{
  chunk->visited[r->number] = (int)r->visited;
  chunk->state[r->number] = r->line->hit.t < INFINITY ? STRATUS_HIT_VOXEL : STRATUS_HIT_NONE;
  for (int a = 0; a < 3; ++a) {
    chunk->cell[a][r->number] = r->line->hit.voxel[a];
  }
}

/* Takes a ray to its next node or brick. Returns false once it has none. */
static inline bool wide_step(const stratus_hit_batch* batch, const stratus_hit_chunk* chunk, wide_ray* r)
{
  const stratus_tree* tree = batch->tree;
  uint64_t entry;
  do {
    if (r->top == 0) {
      return false;
    }
    entry = r->stack[--r->top];
  } while (float_of((uint32_t)(entry >> 32)) > r->line->end);
  const uint32_t number = (uint32_t)entry;
  if (__builtin_expect((number & WIDE_BRICK) != 0, 0)) {
    ++r->visited;
    wide_brick(batch, &chunk->rays[r->number], &tree->bricks[number & ~WIDE_BRICK], r->line);
  } else {
    wide_node(&tree->wide.nodes[number], r);
  }
  if (r->top == 0) {
    return false;
  }
  const uint32_t next = (uint32_t)r->stack[r->top - 1];
  if (next & WIDE_BRICK) {
    __builtin_prefetch(&tree->bricks[next & ~WIDE_BRICK]);
  } else {
    __builtin_prefetch(&tree->wide.nodes[next]);
    __builtin_prefetch(&tree->wide.nodes[next].hi[0][8]);
  }
  return true;
}

/* Lets rays take turns until none is left. */
static inline __attribute__((always_inline)) void wide_turns(
  const stratus_hit_batch* batch, stratus_hit_chunk* chunk, int first, int last, wide_next* next, void* rest)
{
  wide_ray rays[WIDE_RAYS];
  wide_line lines[WIDE_RAYS];
  int busy = 0, asked = first;
  for (int i = 0; i < WIDE_RAYS; ++i) {
    rays[i].line = &lines[i];
    busy += wide_begin(batch, chunk, next, rest, &rays[i]);
  }
  while (busy > 0) {
    asked = stratus_hit_fetch(chunk, asked, last);
    for (int i = 0; i < WIDE_RAYS; ++i) {
      if (rays[i].number >= 0 && !wide_step(batch, chunk, &rays[i])) {
        wide_end(chunk, &rays[i]);
        busy -= !wide_begin(batch, chunk, next, rest, &rays[i]);
      }
    }
  }
}

/* Walks the rays first .. last - 1 of a chunk. */
static void wide_walk(const stratus_hit_batch* batch, stratus_hit_chunk* chunk, int first, int last)
{
  wide_rest rest = { first, last };
  for (int i = first; i < last; ++i) {
    chunk->state[i] = STRATUS_HIT_NONE;
    chunk->visited[i] = 0;
  }
  wide_turns(batch, chunk, first, last, wide_next_of_chunk, &rest);
}

#endif
