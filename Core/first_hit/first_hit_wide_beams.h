/* SPDX-License-Identifier: BSD-3-Clause
 * Beams of rays through wide hierarchies. BEAM rays that follow each other and run side by side visit a node once for all of them. The
 * borders of the beam determine which of the node's children it may meet. These are tested against the rays that have come so far, and a
 * child goes on the stack with the set of rays that may meet it. Rays that do not, or no longer, share their visits continue one by one.
 *
 * The borders enclose all rays of the beam. Across its axis, the lower border is a line of the rays' least position and slope, the upper
 * one a line of the greatest. A box is met between them as by a ray: it is entered by the upper border and left by the lower one. As in
 * first_hit_wide.h, boxes are grown by the slack of positions in float, so that none is missed.
 *
 * Included by first_hit_isa.c. */
#ifndef STRATUS_FIRST_HIT_WIDE_BEAMS_H
#define STRATUS_FIRST_HIT_WIDE_BEAMS_H

#include "first_hit_beams.h"
#include "first_hit_wide.h"

/* The least speed of a beam's rays along its axis, where 1 is a ray's along its longest one. All rays of a narrow cone are faster than that
 * along some axis. */
#define WIDE_BEAM_SLOWEST 0.5f

/* A visit by a beam takes as long as about so many visits by single rays. */
#define WIDE_BEAM_VISIT 4

#define WIDE_PARTS (STRATUS_WIDE / STRATUS_WIDTH) /* vectors for a node's children */
#define WIDE_LANES ((UINT64_C(1) << STRATUS_WIDTH) - 1)

typedef struct wide_beam_entry {
  uint64_t rays;   /* that may meet it */
  uint32_t number; /* of a node, or of a brick with WIDE_BRICK */
  float at;        /* where the beam enters, along its axis */
} wide_beam_entry;

/* Sets of rays have bit i for the beam's ray i. Positions along the axis are counted from where the first ray begins, in the direction of
 * the rays. */
typedef struct wide_beam {
  int first; /* ray of the chunk */
  int axis;
  uint64_t live;       /* rays that meet the root's box */
  int near[3], far[3]; /* as wide_ray has them */
  float sign[3];       /* of the rays' directions */
  float speed[2][3];   /* a plane at p is met at p * speed + base: [0] at the earliest, [1] at the latest */
  float base[2][3];    /* see speed */
  float last;          /* no ray ends behind it */
  uint64_t begun;      /* rays that have a line */
  int top, visited;
  /* Of each ray: it meets a plane at p at p * inverse + early at the earliest, and p * inverse + late at the latest. */
  _Alignas(64) float inverse[3][BEAM];
  float early[3][BEAM], late[3][BEAM];
  float end[BEAM];                 /* its end, along itself */
  float ends[BEAM];                /* its end along the axis; below 0 if it is not live */
  float begins[BEAM], along[BEAM]; /* where it begins along the axis, and its speed there */
  wide_line line[BEAM];
  wide_beam_entry stack[STRATUS_WIDE_STACK];
} wide_beam;

/* The lanes of a mask as bits. */
static inline uint64_t wide_bits(vmask mask)
{
#if STRATUS_ISA == 2
  return mask;
#elif STRATUS_ISA == 1
  return (uint64_t)m_bits(mask);
#else
  uint64_t bits = 0;
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    bits |= (uint64_t)(mask[lane] & 1) << lane;
  }
  return bits;
#endif
}

static inline float beam_highest(vfloat v)
{
  return -beam_lowest(v_set(0.0f) - v);
}

/* ---------------------------------------------------------------- a beam of rays */

/* Finds the octant and the axis of the chunk's rays from `first` on. Returns false unless the live ones have one of each. */
static inline bool wide_beam_direction(const stratus_hit_chunk* c, int first, wide_beam* beam)
{
  const vfloat most = v_set(INFINITY);
  vfloat least[3] = { most, most, most };
  int up[3] = { 0 }, down[3] = { 0 };
  beam->first = first;
  beam->live = beam->begun = 0;
  beam->top = beam->visited = 0;
  for (int i = 0; i < BEAM; i += STRATUS_WIDTH) {
    const vmask lives = v_le(v_set(0.0f), v_load(c->end + first + i));
    beam->live |= wide_bits(lives) << i;
    for (int axis = 0; axis < 3; ++axis) {
      const vfloat d = v_load(c->d[axis] + first + i);
      const vmask rises = v_lt(v_set(0.0f), d);
      up[axis] |= m_any(lives & rises);
      down[axis] |= m_any(m_andnot(lives, rises));
      least[axis] = v_min(least[axis], v_select(lives, v_abs(d), most));
    }
  }
  float slowest = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    const float speed = beam_lowest(least[axis]);
    beam->axis = speed > slowest ? axis : beam->axis;
    slowest = speed > slowest ? speed : slowest;
    beam->sign[axis] = up[axis] ? 1.0f : -1.0f;
    wide_sides(axis, up[axis], &beam->near[axis], &beam->far[axis]);
  }
  return !((up[0] && down[0]) || (up[1] && down[1]) || (up[2] && down[2])) && slowest >= WIDE_BEAM_SLOWEST;
}

/* Finds the beam's borders, and takes its rays. */
static inline void wide_beam_place(const stratus_hit_batch* batch, const stratus_hit_chunk* c, wide_beam* beam)
{
  const vfloat most = v_set(INFINITY), least = v_set(-INFINITY);
  const int m = beam->axis, first = beam->first;
  vfloat begins = most, ends = least;
  vmask lives[BEAM_PARTS];
  for (int part = 0; part < BEAM_PARTS; ++part) {
    const int i = part * STRATUS_WIDTH;
    const vfloat end = v_load(c->end + first + i);
    const vfloat along = v_abs(v_load(c->d[m] + first + i)), from = v_set(beam->sign[m]) * v_load(c->o[m] + first + i);
    lives[part] = v_le(v_set(0.0f), end);
    v_store(beam->end + i, end);
    v_store(beam->begins + i, from);
    v_store(beam->along + i, along);
    begins = v_min(begins, v_select(lives[part], from, most));
    for (int axis = 0; axis < 3; ++axis) {
      const vfloat inverse = v_load(c->inverse[axis] + first + i), o = v_load(c->o[axis] + first + i);
      const vfloat grown = v_set(beam->sign[axis] * batch->slack);
      v_store(beam->inverse[axis] + i, inverse);
      v_store(beam->early[axis] + i, (v_set(0.0f) - (o + grown)) * inverse);
      v_store(beam->late[axis] + i, (grown - o) * inverse);
    }
  }
  const float begin = beam_lowest(begins), slack = 2.0f * batch->slack; /* a border takes a few roundings more than a ray */
  for (int part = 0; part < BEAM_PARTS; ++part) {
    const int i = part * STRATUS_WIDTH;
    const vfloat from = v_load(beam->begins + i) - v_set(begin);
    const vfloat end = v_fma(v_load(beam->end + i), v_load(beam->along + i), from + v_set(slack));
    v_store(beam->begins + i, from);
    v_store(beam->ends + i, v_select(lives[part], end, least));
    ends = v_max(ends, v_select(lives[part], end, least));
  }
  beam->last = beam_highest(ends);
  for (int axis = 0; axis < 3; ++axis) {
    const float sign = beam->sign[axis];
    if (axis == m) {
      beam->speed[0][axis] = beam->speed[1][axis] = sign;
      beam->base[0][axis] = -begin - slack;
      beam->base[1][axis] = -begin + slack;
      continue;
    }
    vfloat low = most, high = least, flat = most, steep = least;
    for (int part = 0; part < BEAM_PARTS; ++part) {
      const int i = part * STRATUS_WIDTH;
      const vfloat slope = v_abs(v_load(c->d[axis] + first + i)) / v_load(beam->along + i);
      const vfloat at = v_set(sign) * v_load(c->o[axis] + first + i) - v_load(beam->begins + i) * slope;
      low = v_min(low, v_select(lives[part], at, most));
      high = v_max(high, v_select(lives[part], at, least));
      flat = v_min(flat, v_select(lives[part], slope, most));
      steep = v_max(steep, v_select(lives[part], slope, least));
    }
    const float in = 1.0f / beam_highest(steep), out = 1.0f / beam_lowest(flat);
    beam->speed[0][axis] = sign * in;
    beam->speed[1][axis] = sign * out;
    beam->base[0][axis] = -(beam_highest(high) + slack) * in;
    beam->base[1][axis] = (slack - beam_lowest(low)) * out;
  }
  beam->top = 1;
  beam->stack[0] = (wide_beam_entry){ .rays = beam->live };
}

/* ---------------------------------------------------------------- nodes and bricks */

static inline void wide_beam_fetch(const stratus_tree* tree, uint32_t next)
{
  if (next & WIDE_BRICK) {
    __builtin_prefetch(&tree->bricks[next & ~WIDE_BRICK]);
  } else {
    __builtin_prefetch(&tree->wide.nodes[next]);
    __builtin_prefetch(&tree->wide.nodes[next].hi[0][8]);
  }
}

/* The planes of a node's boxes by which rays enter and leave them. */
typedef struct wide_boxes {
  vfloat near[3][WIDE_PARTS], far[3][WIDE_PARTS];
} wide_boxes;

/* Finds the node's planes, and where the beam enters its children. Returns which of them it may meet. */
static inline uint32_t wide_beam_boxes(const stratus_wide_node* node, const wide_beam* beam, wide_boxes* boxes, float enters[STRATUS_WIDE])
{
  const vfloat scale = v_set(float_of((uint32_t)(node->shift + 127) << 23)); /* 2^shift */
  uint32_t met = 0;
  for (int part = 0; part < WIDE_PARTS; ++part) {
    const uint8_t* bytes = (const uint8_t*)node + part * STRATUS_WIDTH;
    vfloat enter = v_set(0.0f), leave = v_set(beam->last);
    for (int a = 0; a < 3; ++a) {
      boxes->near[a][part] = v_fma(wide_planes(bytes + beam->near[a]), scale, v_set(node->at[a]));
      boxes->far[a][part] = v_fma(wide_planes(bytes + beam->far[a]), scale, v_set(node->at[a]));
      enter = v_max(v_fma(boxes->near[a][part], v_set(beam->speed[0][a]), v_set(beam->base[0][a])), enter);
      leave = v_min(v_fma(boxes->far[a][part], v_set(beam->speed[1][a]), v_set(beam->base[1][a])), leave);
    }
    v_store(enters + part * STRATUS_WIDTH, enter);
    met |= (uint32_t)wide_bits(v_le(enter, leave)) << part * STRATUS_WIDTH;
  }
  return met & ((1u << node->count) - 1);
}

/* Finds which rays meet which of the children `met`: a ray after the other, its children in lanes. */
static inline void wide_beam_by_ray(
  const wide_beam* beam, const wide_boxes* boxes, uint32_t met, uint64_t rays, uint64_t meets[STRATUS_WIDE])
{
#if STRATUS_ISA == 2
  __m512i low = _mm512_setzero_si512(), high = low;
#endif
  for (; rays; rays &= rays - 1) {
    const int i = __builtin_ctzll(rays);
    uint32_t children = 0;
    for (int part = 0; part < WIDE_PARTS; ++part) {
      vfloat enter = v_set(0.0f), leave = v_set(beam->end[i]);
      for (int a = 0; a < 3; ++a) {
        const vfloat inverse = v_set(beam->inverse[a][i]);
        enter = v_max(v_fma(boxes->near[a][part], inverse, v_set(beam->early[a][i])), enter);
        leave = v_min(v_fma(boxes->far[a][part], inverse, v_set(beam->late[a][i])), leave);
      }
      children |= (uint32_t)wide_bits(v_le(enter, leave)) << part * STRATUS_WIDTH;
    }
    children &= met;
#if STRATUS_ISA == 2
    const __m512i ray = _mm512_set1_epi64((int64_t)(rays & -rays));
    low = _mm512_mask_or_epi64(low, (__mmask8)children, low, ray);
    high = _mm512_mask_or_epi64(high, (__mmask8)(children >> 8), high, ray);
#else
    for (; children; children &= children - 1) {
      meets[__builtin_ctz(children)] |= rays & -rays;
    }
#endif
  }
#if STRATUS_ISA == 2
  _mm512_storeu_si512(meets, low);
  _mm512_storeu_si512(meets + 8, high);
#endif
}

/* The same: a child after the other, its rays in lanes. */
static inline void wide_beam_by_child(
  const wide_beam* beam, const wide_boxes* boxes, uint32_t met, uint64_t rays, uint64_t meets[STRATUS_WIDE])
{
  float near[3][STRATUS_WIDE], far[3][STRATUS_WIDE];
  for (int a = 0; a < 3; ++a) {
    for (int part = 0; part < WIDE_PARTS; ++part) {
      v_store(near[a] + part * STRATUS_WIDTH, boxes->near[a][part]);
      v_store(far[a] + part * STRATUS_WIDTH, boxes->far[a][part]);
    }
  }
  for (int first = 0; first < BEAM; first += STRATUS_WIDTH) {
    vfloat inverse[3], early[3], late[3];
    const vfloat end = v_load(beam->end + first);
    const uint64_t some = rays >> first & WIDE_LANES;
    if (!some) {
      continue;
    }
    for (int a = 0; a < 3; ++a) {
      inverse[a] = v_load(beam->inverse[a] + first);
      early[a] = v_load(beam->early[a] + first);
      late[a] = v_load(beam->late[a] + first);
    }
    for (uint32_t left = met; left; left &= left - 1) {
      const int c = __builtin_ctz(left);
      vfloat enter = v_set(0.0f), leave = end;
      for (int a = 0; a < 3; ++a) {
        enter = v_max(v_fma(v_set(near[a][c]), inverse[a], early[a]), enter);
        leave = v_min(v_fma(v_set(far[a][c]), inverse[a], late[a]), leave);
      }
      meets[c] |= (wide_bits(v_le(enter, leave)) & some) << first;
    }
  }
}

/* Pushes the children that rays may meet before their ends. Both ways to find them take the same time a test: the one with fewer is taken.
 */
static inline void wide_beam_node(const stratus_tree* tree, const stratus_wide_node* node, uint64_t rays, wide_beam* beam)
{
  wide_boxes boxes;
  float enters[STRATUS_WIDE];
  uint64_t meets[STRATUS_WIDE] = { 0 };
  const int least = beam->top;
  const uint32_t met = wide_beam_boxes(node, beam, &boxes, enters);
  int packets = 0;
  for (int first = 0; first < BEAM; first += STRATUS_WIDTH) {
    packets += (rays >> first & WIDE_LANES) != 0;
  }
  if (__builtin_popcountll(rays) * WIDE_PARTS <= __builtin_popcount(met) * packets) {
    wide_beam_by_ray(beam, &boxes, met, rays, meets);
  } else {
    wide_beam_by_child(beam, &boxes, met, rays, meets);
  }
  for (uint32_t left = met; left; left &= left - 1) {
    const int c = __builtin_ctz(left);
    if (!meets[c]) {
      continue;
    }
    const wide_beam_entry entry = { meets[c], wide_child(node, c), enters[c] };
    int at = beam->top++;
    for (; at > least && beam->stack[at - 1].at < entry.at; --at) {
      beam->stack[at] = beam->stack[at - 1];
    }
    beam->stack[at] = entry;
    wide_beam_fetch(tree, entry.number);
  }
}

static inline wide_line* wide_beam_line(const stratus_hit_batch* batch, const stratus_hit_chunk* c, int i, wide_beam* beam)
{
  if (!(beam->begun >> i & 1)) {
    wide_line_begin(batch, c, beam->first + i, &beam->line[i]);
    beam->begun |= 1ull << i;
  }
  return &beam->line[i];
}

static inline void wide_beam_brick(
  const stratus_hit_batch* batch, const stratus_hit_chunk* c, const stratus_brick* brick, uint64_t rays, wide_beam* beam)
{
  bool shorter = false;
  for (; rays; rays &= rays - 1) {
    const int i = __builtin_ctzll(rays);
    wide_line* const line = wide_beam_line(batch, c, i, beam);
    wide_brick(batch, &c->rays[beam->first + i], brick, line);
    if (line->end < beam->end[i]) {
      beam->end[i] = line->end;
      beam->ends[i] = line->end * beam->along[i] + beam->begins[i] + 2.0f * batch->slack;
      shorter = true;
    }
  }
  if (shorter) {
    vfloat last = v_load(beam->ends);
    for (int part = STRATUS_WIDTH; part < BEAM; part += STRATUS_WIDTH) {
      last = v_max(last, v_load(beam->ends + part));
    }
    beam->last = beam_highest(last);
  }
}

/* Those of the rays that do not end in front of a position along the beam. */
static inline uint64_t wide_beam_reach(const wide_beam* beam, uint64_t rays, float at)
{
  uint64_t reach = 0;
  for (int part = 0; part < BEAM; part += STRATUS_WIDTH) {
    reach |= wide_bits(v_le(v_set(at), v_load(beam->ends + part))) << part;
  }
  return reach & rays;
}

/* ---------------------------------------------------------------- rays that part */

typedef struct wide_beam_rest {
  wide_beam* beam;
  uint64_t rays;
  float slack;
} wide_beam_rest;

/* Gives a ray what its beam has on the stack for it. */
static inline void wide_next_of_beam(const stratus_hit_batch* batch, const stratus_hit_chunk* chunk, void* rest, wide_ray* r)
{
  wide_beam_rest* const left = rest;
  wide_beam* const beam = left->beam;
  r->number = -1;
  for (r->top = 0; left->rays && r->top == 0; left->rays &= left->rays - 1) {
    const int i = __builtin_ctzll(left->rays);
    for (int e = 0; e < beam->top; ++e) {
      const wide_beam_entry* entry = &beam->stack[e];
      const float at = (entry->at - beam->begins[i] - 2.0f * left->slack) / beam->along[i];
      if (entry->rays >> i & 1) {
        r->stack[r->top++] = (uint64_t)bits_of(wide_larger(at, 0.0f)) << 32 | entry->number;
      }
    }
    if (r->top > 0) {
      r->number = beam->first + i;
      r->line = wide_beam_line(batch, chunk, i, beam);
    }
  }
}

/* Whether the rays run side by side, once the beam has visited the root: a child that any of them meets is met by a third of them, on
 * average. Rays that run apart meet fewer of a full node's children in common. */
static inline bool wide_beam_narrow(const wide_beam* beam)
{
  uint64_t rays = 0;
  int pairs = 0;
  for (int e = 0; e < beam->top; ++e) {
    rays |= beam->stack[e].rays;
    pairs += __builtin_popcountll(beam->stack[e].rays);
  }
  return 3 * pairs >= beam->top * __builtin_popcountll(rays);
}

/* Store the rays' hits. Each live ray has its share of the nodes that the beam visited. */
static inline void wide_beam_store(const wide_beam* beam, stratus_hit_chunk* c)
{
  const int live = __builtin_popcountll(beam->live), share = live ? beam->visited / live : 0;
  int rest = beam->visited - live * share;
  for (int i = 0; i < BEAM; ++i) {
    const int ray = beam->first + i;
    c->state[ray] = STRATUS_HIT_NONE;
    if (beam->live >> i & 1) {
      c->visited[ray] += share + rest;
      rest = 0;
    }
    if (beam->begun >> i & 1 && beam->line[i].hit.t < INFINITY) {
      c->state[ray] = STRATUS_HIT_VOXEL;
      for (int a = 0; a < 3; ++a) {
        c->cell[a][ray] = beam->line[i].hit.voxel[a];
      }
    }
  }
}

/* Walks BEAM rays of a chunk from `first` on, if they run side by side. Returns false if they do not. */
static inline bool wide_beam_walk(const stratus_hit_batch* batch, int first, stratus_hit_chunk* c)
{
  const stratus_tree* tree = batch->tree;
  wide_beam beam;
  int asked = first, gain = 0; /* visits by single rays that the beam has saved */
  if (!wide_beam_direction(c, first, &beam)) {
    return false;
  }
  if (beam.live) {
    wide_beam_place(batch, c, &beam);
  }
  for (int i = first; i < first + BEAM; ++i) {
    c->visited[i] = 0;
  }
  while (beam.top > 0 && gain >= 0) {
    const wide_beam_entry entry = beam.stack[--beam.top];
    const uint64_t rays = wide_beam_reach(&beam, entry.rays, entry.at);
    if (!rays) {
      continue;
    }
    asked = stratus_hit_fetch(c, asked, first + BEAM);
    ++beam.visited;
    gain += __builtin_popcountll(rays) - WIDE_BEAM_VISIT;
    if (entry.number & WIDE_BRICK) {
      wide_beam_brick(batch, c, &tree->bricks[entry.number & ~WIDE_BRICK], rays, &beam);
    } else {
      wide_beam_node(tree, &tree->wide.nodes[entry.number], rays, &beam);
      if (beam.visited == 1 && !wide_beam_narrow(&beam)) {
        return false;
      }
    }
  }
  wide_beam_rest rest = { &beam, beam.live, batch->slack };
  if (beam.top > 0) {
    wide_turns(batch, c, first, first + BEAM, wide_next_of_beam, &rest);
  }
  wide_beam_store(&beam, c);
  return true;
}

#endif
