/* SPDX-License-Identifier: BSD-3-Clause
 * First hits in a wide hierarchy, one ray a work item. The boxes of a node's 16 children are tested STRATUS_WIDTH at a time, grown by the
 * slack of positions in float, so that none is missed.
 *
 * In a brick, floats bound where the ray enters each voxel that it may meet. Of these the ray takes the one whose latest beginning comes
 * first; if another may begin before that, the ray is doubtful, and the caller walks it again in double precision. The caller computes the
 * hit with the voxel that was taken, too, and finds out if there is none. Doubtful rays graze edges, so that they are few. */
#ifndef STRATUS_DEVICE
#define STRATUS_DEVICE 1
#endif
#ifndef STRATUS_WIDTH
#define STRATUS_WIDTH 1
#endif

#include "first_hit_arguments.h"
#include "packet.h"

#ifdef STRATUS_ARGUMENTS_BYTES
/* An array of negative size, which does not compile, where the host lays the arguments out otherwise. */
typedef char stratus_arguments_agree[sizeof(stratus_hit_arguments) == STRATUS_ARGUMENTS_BYTES ? 1 : -1];
#endif

#define WIDE 16
#define WIDE_STACK 226         /* as STRATUS_WIDE_STACK of wide_tree.h, which explains the number */
#define WIDE_BRICK 0x80000000u /* set in a brick's number on the stack */

/* The struct of wide_tree.h. */
typedef struct stratus_wide_node {
  float at[3];
  uint node, brick;
  uchar count, inner, shift, unused[9];
  uchar lo[3][WIDE], hi[3][WIDE];
} stratus_wide_node;

typedef char stratus_wide_nodes_agree[sizeof(stratus_wide_node) == 128 ? 1 : -1];

typedef struct wide_ray {
  float inverse[3];
  float early[3], late[3]; /* the origin, off by the slack: planes are met at (p - early) * inverse at the earliest, and so on */
  int up[3];
  float end; /* voxels that the ray enters behind it cannot be its hit */
  int top, visited;
  /* The voxel that was taken: from where to where it may begin. And where any other voxel that the ray may meet may begin. */
  int voxel[3];
  float from, to, other;
  ulong stack[WIDE_STACK]; /* bits of a float >= 0, which are ordered as the float is, above the number of a node or brick */
} wide_ray;

/* Put an entry on the stack, below the entries of the same node that the ray enters earlier. */
INLINE void wide_push(wide_ray* r, int least, float enter, uint number)
{
  const ulong entry = (ulong)as_uint(enter) << 32 | number;
  int at = r->top++;
  for (; at > least && r->stack[at - 1] < entry; --at) {
    r->stack[at] = r->stack[at - 1];
  }
  r->stack[at] = entry;
}

INLINE vfloat wide_planes(__global const uchar* bytes)
{
#if STRATUS_WIDTH == 16
  return convert_float16(*(__global const uchar16*)bytes); /* which lies as a uchar16 should, so that it is loaded as one */
#else
  return (float)bytes[0];
#endif
}

/* A bit for each lane of the mask. */
INLINE uint wide_bits(vmask mask)
{
#if STRATUS_WIDTH == 16 && defined(STRATUS_DEVICE_AVX512)
  return mask;
#elif STRATUS_WIDTH == 16
  const int16 bits = mask & (int16)(1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768);
  const int8 of8 = bits.lo | bits.hi;
  const int4 of4 = of8.lo | of8.hi;
  const int2 of2 = of4.lo | of4.hi;
  return (uint)(of2.x | of2.y);
#else
  return m_any(mask) ? 1u : 0u;
#endif
}

/* Pushes the children of the node that the ray may meet before its end. */
INLINE void wide_node(__global const stratus_wide_node* node, wide_ray* r)
{
  const float scale = as_float((uint)(node->shift + 127) << 23); /* 2^shift */
  const int least = r->top, inner = node->inner;
  float enters[STRATUS_WIDTH], base_early[3], base_late[3], speed[3];
  ++r->visited;
  for (int a = 0; a < 3; ++a) {
    base_early[a] = (node->at[a] - r->early[a]) * r->inverse[a];
    base_late[a] = (node->at[a] - r->late[a]) * r->inverse[a];
    speed[a] = scale * r->inverse[a];
  }
  for (int part = 0; part < (STRATUS_WIDTH == 16 ? WIDE : node->count); part += STRATUS_WIDTH) {
    vfloat enter = v_set(0.0f), leave = v_set(r->end);
    for (int a = 0; a < 3; ++a) {
      const vfloat near = wide_planes((r->up[a] ? node->lo[a] : node->hi[a]) + part);
      const vfloat far = wide_planes((r->up[a] ? node->hi[a] : node->lo[a]) + part);
      enter = v_max(v_fma(near, v_set(speed[a]), v_set(base_early[a])), enter);
      leave = v_min(v_fma(far, v_set(speed[a]), v_set(base_late[a])), leave);
    }
    uint met = wide_bits(v_le(enter, leave));
#if STRATUS_WIDTH == 16
    met &= (1u << node->count) - 1u; /* the others' planes do not keep rays out: see first_hit_wide.h */
#endif
    v_store(enters, enter);
    while (met) {
      const uint low = met & (0u - met);
      const int lane = (int)popcount(low - 1u), c = part + lane;
      wide_push(r, least, enters[lane], c < inner ? node->node + (uint)c : (node->brick + (uint)(c - inner)) | WIDE_BRICK);
      met ^= low;
    }
  }
}

/* fmin() and fmax() of OpenCL C heed NaNs, of which there are none here. */
INLINE float larger(float a, float b) { return a > b ? a : b; }
INLINE float smaller(float a, float b) { return a < b ? a : b; }

/* Takes in a voxel that the ray may meet, and enters between `from` and `to`. */
INLINE void wide_take(wide_ray* r, const int voxel[3], float from, float to)
{
  if (to < r->to) {
    r->other = smaller(r->other, r->from);
    for (int a = 0; a < 3; ++a) {
      r->voxel[a] = voxel[a];
    }
    r->from = from;
    r->to = to;
    r->end = smaller(r->end, to);
  } else {
    r->other = smaller(r->other, from);
  }
}

/* Takes in the brick's voxels that the ray may meet. */
INLINE void wide_brick(__global const int* brick, wide_ray* r)
{
  const uint mask[2] = { (uint)brick[0], (uint)brick[1] };
  const int at[3] = { 4 * (brick[2] & 0xffff), 4 * (brick[2] >> 16 & 0xffff), 4 * (brick[3] & 0xffff) };
  float enter[3][4], latest[3][4], leave[3][4]; /* where the ray enters layers of voxels at the earliest, at the latest, and leaves them */
  ++r->visited;
  for (int a = 0; a < 3; ++a) {
    for (int i = 0; i < 4; ++i) {
      const float near = (float)(at[a] + i + !r->up[a]), far = (float)(at[a] + i + r->up[a]);
      enter[a][i] = (near - r->early[a]) * r->inverse[a];
      latest[a][i] = (near - r->late[a]) * r->inverse[a];
      leave[a][i] = (far - r->late[a]) * r->inverse[a];
    }
  }
  for (int zy = 0; zy < 16; ++zy) {
    const int z = zy >> 2, y = zy & 3;
    const uint row = mask[zy >> 3] >> 4 * (zy & 7) & 15u;
    const float from = larger(0.0f, larger(enter[2][z], enter[1][y])), last = smaller(leave[2][z], leave[1][y]);
    if (!row || from > smaller(r->end, last)) {
      continue;
    }
    const float to = larger(0.0f, larger(latest[2][z], latest[1][y]));
    for (int x = 0; x < 4; ++x) {
      const float begin = larger(from, enter[0][x]);
      if ((row >> x & 1u) && begin <= smaller(r->end, smaller(last, leave[0][x]))) {
        const int voxel[3] = { at[0] + x, at[1] + y, at[2] + z };
        wide_take(r, voxel, begin, larger(to, latest[0][x]));
      }
    }
  }
}

/* Walks a ray from its origin to `end`. Returns STRATUS_HIT_VOXEL where r->voxel is its hit. */
INLINE int wide_walk(const float o[3], const float inverse[3], float end, float slack, __global const stratus_wide_node* nodes,
  __global const int* bricks, wide_ray* r)
{
  for (int a = 0; a < 3; ++a) {
    r->inverse[a] = inverse[a];
    r->up[a] = inverse[a] > 0.0f;
    r->early[a] = o[a] + (r->up[a] ? slack : -slack);
    r->late[a] = o[a] - (r->up[a] ? slack : -slack);
    r->voxel[a] = 0;
  }
  r->end = end;
  r->from = r->to = r->other = INFINITY;
  r->visited = 0;
  r->stack[0] = 0;
  r->top = end >= 0.0f ? 1 : 0;
  while (r->top > 0) {
    const ulong entry = r->stack[--r->top];
    const uint number = (uint)entry;
    if (as_float((uint)(entry >> 32)) > r->end) {
      continue;
    }
    if (number & WIDE_BRICK) {
      wide_brick(bricks + 4 * (size_t)(number & ~WIDE_BRICK), r);
    } else {
      wide_node(nodes + number, r);
    }
  }
  if (r->to < INFINITY && r->other > r->to) {
    return STRATUS_HIT_VOXEL;
  }
  return r->to < INFINITY || r->other < INFINITY ? STRATUS_HIT_DOUBTFUL : STRATUS_HIT_NONE;
}

/* rays, results: as in first_hit.cl, and as many of each. Directions and cells are not read. */
PACKET_KERNEL void first_hit_wide(__constant stratus_hit_arguments* a, __global const stratus_wide_node* nodes, __global const int* bricks,
  __global const float* rays, __global int* results)
{
  const int ray = (int)get_global_id(0);
  const size_t n = (size_t)a->count;
  if (ray >= a->count) {
    return;
  }
  wide_ray r;
  float o[3], inverse[3];
  for (int axis = 0; axis < 3; ++axis) {
    o[axis] = rays[(size_t)axis * n + (size_t)ray];
    inverse[axis] = rays[(size_t)(6 + axis) * n + (size_t)ray];
  }
  results[ray] = wide_walk(o, inverse, rays[9 * n + (size_t)ray], a->slack, nodes, bricks, &r);
  for (int axis = 0; axis < 3; ++axis) {
    results[(size_t)(1 + axis) * n + (size_t)ray] = r.voxel[axis];
  }
  results[4 * n + (size_t)ray] = r.visited;
}
