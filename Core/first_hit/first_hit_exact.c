/* SPDX-License-Identifier: BSD-3-Clause
 * First hits in double precision, one ray at a time, in any tree. This method is used for hierarchies whose boxes may overlap (not WIDE),
 * for trees with uncorrected floodings, for sets longer than about 52,000 voxels (not WIDE), and for rays that packets leave in doubt.
 * Boxes are grown by a hair, and near an edge all voxels around the position are tested, so that rounding can hide none. Of all voxels that
 * the ray meets, the first counts. */
#include "first_hit_batch.h"

#include <string.h>

/* The error of a position relative to its size: about ten roundings. */
#define HAIR 4e-15

/* A crossing of a plane between voxels. Crossings are ordered by t, and at equal t by axis. Axis 3 is the ray's own start, which comes
 * after all crossings of the same t. The rule and the bits of t are as in voxel_walk.c: a ray is in one voxel at a time, in the same order
 * for every tree. */
typedef struct crossing {
  double t;
  int axis;
} crossing;

static inline bool before(crossing a, crossing b)
{
  return a.t < b.t || (a.t == b.t && a.axis < b.axis);
}

typedef struct walker {
  const stratus_hit_batch* batch;
  const stratus_tree* tree;
  const stratus_ray* ray;
  double o[3], d[3], inverse[3]; /* in voxel coordinates */
  double hair;                   /* error of positions */
  int up[3], octant;
  stratus_hit* hit;
  crossing first; /* crossing by which the ray enters the hit voxel */
  uint32_t visited;
} walker;

/* Returns whether the ray is ever in the voxel, and finds the crossing by which it enters. */
static inline bool enters(const stratus_ray* ray, const double from[3], const double along[3], const int voxel[3], crossing* entry)
{
  crossing in = { ray->t_min, 3 }, out = { INFINITY, 4 };
  for (int a = 0; a < 3; ++a) {
    if (along[a] == 0.0) {
      if (floor(from[a]) != (double)voxel[a]) {
        return false;
      }
      continue;
    }
    const double first = ((double)(along[a] > 0.0 ? voxel[a] : voxel[a] + 1) - from[a]) / along[a];
    const double last = ((double)(along[a] > 0.0 ? voxel[a] + 1 : voxel[a]) - from[a]) / along[a];
    /* No branches: the axis by which a ray enters is unpredictable. Axes come in rising order, so if crossings are equal the last axis
     * counts for entering, and the first one for leaving. The ray's own start comes after all crossings of the same t. */
    in.axis = (first > in.t) | ((first == in.t) & (in.axis != 3)) ? a : in.axis;
    in.t = first > in.t ? first : in.t;
    out.axis = last < out.t ? a : out.axis;
    out.t = last < out.t ? last : out.t;
  }
  *entry = in;
  return before(in, out) && in.t <= ray->t_max && in.t < INFINITY;
}

static void make_hit(
  const stratus_hit_batch* batch, const stratus_ray* ray, const double along[3], const int voxel[3], crossing entry, stratus_hit* hit)
{
  hit->t = entry.t;
  hit->face = entry.axis == 3 ? -1 : 2 * entry.axis + (along[entry.axis] < 0.0);
  if (hit->face >= 0) {
    for (int a = 0; a < 3; ++a) {
      hit->normal[a] = (float)batch->normal[hit->face][a];
    }
  } else {
    const double* d = ray->direction;
    const double most = fmax(fabs(d[0]), fmax(fabs(d[1]), fabs(d[2])));
    const double x = d[0] / most, y = d[1] / most, z = d[2] / most, length = sqrt(x * x + y * y + z * z);
    hit->normal[0] = (float)(-x / length);
    hit->normal[1] = (float)(-y / length);
    hit->normal[2] = (float)(-z / length);
  }
  for (int a = 0; a < 3; ++a) {
    hit->voxel[a] = voxel[a];
  }
}

/* Converts a ray to voxel coordinates. */
static inline void to_voxels(const double m[16], const stratus_ray* ray, double from[3], double along[3])
{
  const double *o = ray->origin, *d = ray->direction;
  for (int a = 0; a < 3; ++a) {
    from[a] = m[4 * a] * o[0] + m[4 * a + 1] * o[1] + m[4 * a + 2] * o[2] + m[4 * a + 3];
    along[a] = m[4 * a] * d[0] + m[4 * a + 1] * d[1] + m[4 * a + 2] * d[2];
  }
}

void stratus_hit_of_voxel(const stratus_hit_batch* batch, const stratus_ray* ray, const int voxel[3], stratus_hit* hit)
{
  double from[3], along[3];
  crossing entry;
  to_voxels(batch->to_voxels, ray, from, along);
  hit->t = INFINITY;
  if (enters(ray, from, along, voxel, &entry)) {
    make_hit(batch, ray, along, voxel, entry, hit);
  }
}

/* Keeps the hit of an effective voxel if the ray enters it before the hit so far. */
static void try_voxel(walker* w, int x, int y, int z)
{
  const int voxel[3] = { x, y, z };
  crossing entry;
  if (enters(w->ray, w->o, w->d, voxel, &entry) && before(entry, w->first)) {
    w->first = entry;
    make_hit(w->batch, w->ray, w->d, voxel, entry, w->hit);
  }
}

/* Finds where the ray enters and leaves a box grown by a hair. Returns false if it misses the box or meets it behind the hit so far. */
static bool meets_box(const walker* w, const int32_t lo[3], const int32_t hi[3], double* enter, double* leave)
{
  double t0 = w->ray->t_min, t1 = w->ray->t_max < w->hit->t ? w->ray->t_max : w->hit->t;
  for (int a = 0; a < 3; ++a) {
    const double l = lo[a] - w->hair - w->o[a], h = hi[a] + w->hair - w->o[a];
    if (w->d[a] == 0.0) {
      if (l > 0.0 || h < 0.0) {
        return false;
      }
      continue;
    }
    const double near = (w->up[a] ? l : h) * w->inverse[a], far = (w->up[a] ? h : l) * w->inverse[a];
    t0 = near > t0 ? near : t0;
    t1 = far < t1 ? far : t1;
  }
  *enter = t0;
  *leave = t1;
  return t0 <= t1;
}

/* ---------------------------------------------------------------- leaves */

static void try_brick(walker* w, const stratus_brick* brick)
{
  for (uint64_t left = brick->mask; left; left &= left - 1) {
    const int bit = __builtin_ctzll(left);
    try_voxel(w, brick->at[0] * 4 + (bit & 3), brick->at[1] * 4 + (bit >> 2 & 3), brick->at[2] * 4 + (bit >> 4));
  }
}

static void walk_bricks(walker* w, const stratus_tree_node* node)
{
  const uint32_t count = stratus_tree_node_count(node);
  for (uint32_t b = 0; b < count; ++b) {
    const stratus_brick* brick = &w->tree->bricks[node->first + b];
    const int32_t lo[3] = { brick->at[0] * 4, brick->at[1] * 4, brick->at[2] * 4 };
    const int32_t hi[3] = { lo[0] + 4, lo[1] + 4, lo[2] + 4 };
    double enter, leave;
    ++w->visited;
    if (brick->count == 1 || meets_box(w, lo, hi, &enter, &leave)) {
      try_brick(w, brick);
    }
  }
}

/* Returns how far a ray may leap from a voxel's cell; 0 if the voxel is effective, -1 if only its cell is occupied, -2 beyond the field. */
static int32_t look(const walker* w, const stratus_tree_field* field, const int voxel[3])
{
  const int log2 = w->tree->cell_log2;
  int32_t at[3];
  uint64_t mask;
  for (int a = 0; a < 3; ++a) {
    at[a] = (voxel[a] >> log2) - field->at[a];
    if (at[a] < 0 || at[a] >= field->cells[a]) {
      return -2;
    }
  }
  const int32_t leap = stratus_tree_field_leap(w->tree, field, w->octant, at[0], at[1], at[2], &mask);
  if (leap > 0 || log2 == 0) {
    return leap;
  }
  return mask >> ((voxel[2] & 3) << 4 | (voxel[1] & 3) << 2 | (voxel[0] & 3)) & 1 ? 0 : -1;
}

/* Tests the other voxels in which a position within a hair of a border may lie. */
static void try_neighbours(walker* w, const stratus_tree_field* field, const double position[3], const int voxel[3])
{
  int other[3], any = 0;
  for (int a = 0; a < 3; ++a) {
    const double f = position[a] - voxel[a];
    other[a] = f < w->hair ? -1 : f > 1.0 - w->hair ? 1 : 0;
    any |= other[a] != 0;
  }
  for (int corner = 1; any && corner < 8; ++corner) {
    int c[3], real = 1;
    for (int a = 0; a < 3; ++a) {
      const int moved = corner >> a & 1;
      real &= !moved || other[a] != 0;
      c[a] = voxel[a] + (moved ? other[a] : 0);
    }
    if (real && look(w, field, c) == 0) {
      try_voxel(w, c[0], c[1], c[2]);
    }
  }
}

static void walk_field(walker* w, const stratus_tree_field* field, double enter, double leave)
{
  const int log2 = w->tree->cell_log2;
  double t = enter, position[3];
  int voxel[3];
  for (int a = 0; a < 3; ++a) {
    const int lo = field->at[a] << log2, hi = (field->at[a] + field->cells[a]) << log2;
    position[a] = w->o[a] + t * w->d[a];
    const double floored = floor(position[a]);
    voxel[a] = floored < lo ? lo : floored > hi - 1 ? hi - 1 : (int)floored;
  }
  for (;;) {
    ++w->visited;
    const int32_t leap = look(w, field, voxel);
    if (leap == 0) {
      try_voxel(w, voxel[0], voxel[1], voxel[2]);
    }
    try_neighbours(w, field, position, voxel); /* also where the ray leaves the field, because it may leave by a corner */
    if (leap == -2 || t > leave || t > w->hit->t) {
      return;
    }
    /* Advance to the border of the cells known to be empty. */
    double next = INFINITY, at[3];
    int far[3], near[3];
    for (int a = 0; a < 3; ++a) {
      const int block = voxel[a] >> log2;
      const int first = field->at[a], beyond = first + field->cells[a]; /* a leap ends at the field's border */
      const int up = block + leap < beyond ? block + leap : beyond, down = block + 1 - leap > first ? block + 1 - leap : first;
      far[a] = leap <= 0 ? voxel[a] + w->up[a] : (w->up[a] ? up : down) * (1 << log2);
      near[a] = leap <= 0 ? voxel[a] : w->up[a] ? block * (1 << log2) : (block + 1) * (1 << log2) - 1;
      at[a] = w->d[a] == 0.0 ? INFINITY : (far[a] - w->o[a]) * w->inverse[a];
      next = at[a] < next ? at[a] : next;
    }
    t = next > t ? next : t;
    for (int a = 0; a < 3; ++a) {
      position[a] = w->o[a] + next * w->d[a];
      const int last = w->up[a] ? far[a] - 1 : far[a];
      const int lo = near[a] < last ? near[a] : last, hi = near[a] < last ? last : near[a];
      const double floored = floor(position[a]);
      voxel[a] = at[a] <= next ? (w->up[a] ? far[a] : far[a] - 1) : floored < lo ? lo : floored > hi ? hi : (int)floored;
    }
  }
}

/* Walks the paper's field as published (3.2): a ray steps by the distance that is stored for the voxel around its position, until that
 * voxel is effective. Distances are from centre to centre, and flooded, so that a step may lead past a voxel that the ray meets. */
static void walk_spheres(walker* w, const stratus_tree_field* field, double enter, double leave)
{
  const double length = sqrt(w->d[0] * w->d[0] + w->d[1] * w->d[1] + w->d[2] * w->d[2]); /* voxels for each unit of t */
  const double across = (double)field->cells[0] + (double)field->cells[1] + (double)field->cells[2];
  const double end = fmin((leave - enter) * length, across); /* far away, rounding may make the length too large */
  double done = 0.0;
  while (done <= end) {
    int voxel[3];
    const double t = enter + done / length;
    for (int a = 0; a < 3; ++a) {
      const double at = fmax(field->at[a], fmin(field->at[a] + field->cells[a] - 1, floor(w->o[a] + t * w->d[a])));
      voxel[a] = (int)at;
    }
    ++w->visited;
    const int32_t parts = look(w, field, voxel);
    if (parts == 0) {
      try_voxel(w, voxel[0], voxel[1], voxel[2]);
      if (w->hit->t < INFINITY) {
        return;
      }
    }
    done += parts > 0 ? (double)parts / STRATUS_FLOODED_PARTS : 1.0;
  }
}

/* ---------------------------------------------------------------- nodes */

/* A ray in floats, from where it enters the root's box, in units of its longest component. The sketch meets every
 * box that the ray meets, if the box is grown by the floats' slack. */
typedef float four __attribute__((vector_size(16)));
typedef int32_t four_int __attribute__((vector_size(16)));

typedef struct sketch {
  four o, inverse; /* the last lane is unused */
  double base, scale;
  float slack, end;
} sketch;

static float of_t(const sketch* k, double t)
{
  const double length = (t - k->base) * k->scale;
  return length < 1e30 ? (float)length + 8.0f * k->slack : 1e30f;
}

static bool make_sketch(const walker* w, sketch* k)
{
  double enter, leave, most = 0.0;
  if (!meets_box(w, w->tree->nodes[0].lo, w->tree->nodes[0].hi, &enter, &leave)) {
    return false;
  }
  for (int a = 0; a < 3; ++a) {
    most = fmax(most, fabs(w->d[a]));
  }
  *k = (sketch){ .o = { 0 }, .inverse = { 0 }, .base = enter, .scale = most, .slack = w->batch->slack };
  for (int a = 0; a < 3; ++a) {
    const float d = (float)(w->d[a] / most);
    k->o[a] = (float)(w->o[a] + enter * w->d[a]);
    k->inverse[a] = 1.0f / (fabsf(d) < 1e-30f ? 1e-30f : d);
  }
  k->end = of_t(k, leave);
  return true;
}

static inline four load_box(const int32_t* corner)
{
  four_int i;
  memcpy(&i, corner, sizeof i);
  return __builtin_convertvector(i, four);
}

/* Returns whether the ray may meet the node's box before `end`, and finds about where. */
static inline bool may_meet(const sketch* k, const stratus_tree_node* node, float end, float* enter)
{
  const four lo = (load_box(node->lo) - k->slack - k->o) * k->inverse, hi = (load_box(node->hi) + k->slack - k->o) * k->inverse;
  float t0 = 0.0f, t1 = end;
  for (int a = 0; a < 3; ++a) {
    const float near = lo[a] < hi[a] ? lo[a] : hi[a], far = lo[a] < hi[a] ? hi[a] : lo[a];
    t0 = near > t0 ? near : t0;
    t1 = far < t1 ? far : t1;
  }
  *enter = t0;
  return t0 <= t1;
}

typedef struct pending {
  uint32_t node;
  float enter;
} pending;

/* Visits the children of wide nodes in the order of their numbers. */
static void walk_wide(walker* w, const sketch* k)
{
  const stratus_wide_node* nodes = w->tree->wide.nodes;
  uint32_t stack[STRATUS_WIDE_STACK];
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const stratus_wide_node* node = &nodes[stack[--top]];
    ++w->visited;
    for (int c = 0; c < node->count; ++c) {
      const stratus_box box = stratus_wide_box(node, c);
      stratus_tree_node child = { .first = 0 };
      float enter;
      memcpy(child.lo, box.lo, sizeof child.lo);
      memcpy(child.hi, box.hi, sizeof child.hi);
      if (!may_meet(k, &child, w->hit->t < INFINITY ? fminf(k->end, of_t(k, w->hit->t)) : k->end, &enter)) {
        continue;
      }
      if (c < node->inner) {
        stack[top++] = node->node + (uint32_t)c;
      } else {
        ++w->visited;
        try_brick(w, &w->tree->bricks[node->brick + (uint32_t)(c - node->inner)]);
      }
    }
  }
}

static void walk_leaf(walker* w, const sketch* k, const stratus_tree_node* node)
{
  double enter, leave;
  if (w->tree->wide.node_count) {
    walk_wide(w, k);
  } else if (stratus_tree_node_kind(node) == STRATUS_NODE_BRICKS) {
    walk_bricks(w, node);
  } else if (meets_box(w, node->lo, node->hi, &enter, &leave)) {
    (w->tree->statistics.uncorrected ? walk_spheres : walk_field)(w, &w->tree->fields[node->first], enter, leave);
  }
}

static void walk_tree(walker* w)
{
  const stratus_tree* tree = w->tree;
  pending stack[130]; /* each level adds two children and takes one; trees are at most 128 deep */
  int top = 0;
  sketch k;
  if (tree->node_count == 0 || !make_sketch(w, &k)) {
    return;
  }
  float end = k.end;
  stack[top++] = (pending){ 0, 0.0f };
  while (top > 0) {
    const pending now = stack[--top];
    const stratus_tree_node* node = &tree->nodes[now.node];
    if (now.enter > end) {
      continue;
    }
    ++w->visited;
    if (stratus_tree_node_kind(node) != STRATUS_NODE_INNER) {
      walk_leaf(w, &k, node);
      end = w->hit->t < INFINITY ? fminf(end, of_t(&k, w->hit->t)) : end;
      continue;
    }
    pending child[2] = { { node->first, 0.0f }, { node->first + 1, 0.0f } };
    const bool left = may_meet(&k, &tree->nodes[node->first], end, &child[0].enter);
    const bool right = may_meet(&k, &tree->nodes[node->first + 1], end, &child[1].enter);
    if (left && right) {
      const int near = child[0].enter <= child[1].enter ? 0 : 1;
      stack[top++] = child[1 - near];
      stack[top++] = child[near];
    } else if (left || right) {
      stack[top++] = child[left ? 0 : 1];
    }
  }
}

void stratus_first_hit_exact(const stratus_hit_batch* batch, const stratus_ray* ray, stratus_hit* hit)
{
  walker w = { .batch = batch, .tree = batch->tree, .ray = ray, .hit = hit, .first = { INFINITY, 4 } };
  double size = 0.0;
  to_voxels(batch->to_voxels, ray, w.o, w.d);
  for (int a = 0; a < 3; ++a) {
    w.inverse[a] = 1.0 / w.d[a];
    w.up[a] = w.d[a] > 0.0;
    w.octant |= w.up[a] << a;
    size = fmax(size, fmax(fabs(w.o[a]), batch->tree->dimensions[a]));
  }
  w.hair = HAIR * size;
  *hit = (stratus_hit){ .t = INFINITY, .voxel = { -1, -1, -1 }, .face = -1 };
  walk_tree(&w);
  hit->visited = w.visited;
}
