/* SPDX-License-Identifier: BSD-3-Clause
 * Trees for first hits: their hits compared with the plain walk's, trees as bytes, and invalid bytes. */
#include "stratus.h"
#include "tree.h"

#include "fuzz.h"
#include "tree.h"

#include <stdlib.h>

#define LIST_MOST 600
#define RAYS_MOST 60

typedef struct tree_case {
  stratus_voxels* voxels;
  int64_t n[3];
  fuzz_field field; /* valid if `of_volume` */
  stratus_criterion criterion;
  bool of_volume, cells;
  double bounds[6];
} tree_case;

/* ---- inputs */

static stratus_status make_list(fuzz* f, tree_case* c)
{
  int32_t positions[3 * LIST_MOST];
  const size_t count = fuzz_chance(f, 0.05) ? 0 : 1 + fuzz_below(f, LIST_MOST - 1);
  const int shape = (int)fuzz_below(f, 4);
  for (int axis = 0; axis < 3; ++axis) {
    c->n[axis] = fuzz_chance(f, 0.1) ? 1 : 1 + (int64_t)fuzz_below(f, fuzz_chance(f, 0.1) ? 3000 : 40);
    c->bounds[2 * axis] = 0.0;
    c->bounds[2 * axis + 1] = (double)c->n[axis];
  }
  for (size_t i = 0; i < count; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const int64_t n = c->n[axis];
      int64_t at = (int64_t)fuzz_below(f, (uint64_t)n);
      at = shape == 1 && i > 0 ? positions[3 * i - 3 + (size_t)axis] + (int64_t)fuzz_below(f, 3) - 1 : at;
      at = shape == 2 && axis == 2 ? n / 2 : at;
      at = shape == 3 ? (int64_t)(i >> (3 * axis) & 7) : at;
      positions[3 * i + (size_t)axis] = (int32_t)(at < 0 ? 0 : at >= n ? n - 1 : at);
    }
  }
  return CREATE(&c->voxels,
    stratus_voxels_create_list(
      f->context, FUZZ_INPUT(f, c->n), fuzz_input(f, positions, 3 * count * sizeof *positions), count, &c->voxels));
}

static stratus_status make_of_volume(fuzz* f, tree_case* c)
{
  c->of_volume = true;
  c->cells = fuzz_chance(f, 0.5);
  c->field = fuzz_volume(f, 12, 1);
  c->criterion = stratus_criterion_default();
  if (fuzz_chance(f, 0.5)) {
    c->criterion.transfer = fuzz_transfers(f, 1, c->field.low, c->field.high, c->field.edge);
  } else {
    c->criterion.lower = fuzz_real(f, c->field.low, c->field.high);
  }
  memcpy(c->bounds, c->field.bounds, sizeof c->bounds);
  const stratus_volume* volume = FUZZ_INPUT(f, c->field.view);
  const stratus_criterion* criterion = FUZZ_INPUT(f, c->criterion);
  const stratus_status status = c->cells ? CREATE(&c->voxels, stratus_voxels_create_cells(f->context, volume, criterion, &c->voxels))
                                         : CREATE(&c->voxels, stratus_voxels_create(f->context, volume, criterion, &c->voxels));
  if (status == STRATUS_OK) {
    CALL(stratus_voxels_dimensions(c->voxels, c->n));
  }
  return status;
}

static stratus_tree_options choose_options(fuzz* f)
{
  stratus_tree_options o = CALL(stratus_tree_options_default());
  o.method = (stratus_tree_method)fuzz_choice(f, STRATUS_TREE_METHODS);
  if (fuzz_chance(f, 0.6)) {
    o.max_depth = fuzz_integer(f, 1, 64);
    o.leaf_bricks = fuzz_integer(f, 1, 64);
    o.leaf_voxels = fuzz_integer(f, 1, 64);
    o.field_bricks = fuzz_odd(f) ? fuzz_odd_integer(f) : 1 + (int64_t)fuzz_below(f, fuzz_chance(f, 0.5) ? 30 : 200000);
    o.field_emptiness = fuzz_odd(f) ? fuzz_odd_real(f) : fuzz_scale(f, 1.0, 2000.0);
    o.uniform = fuzz_real(f, 0.0, 1.0);
    o.paper_threshold = fuzz_real(f, 0.0, 20.0);
    o.bandwidth = fuzz_chance(f, 0.5) ? 0.0 : fuzz_real(f, 1.0, 10.0);
    o.exact_density = fuzz_flag(f);
    o.density_per_node = fuzz_flag(f);
    o.agglomerative_by_edges = fuzz_flag(f);
    o.uncorrected_flooding = fuzz_chance(f, 0.1);
  }
  return o;
}

/* ---- hits */

static void choose_rays(fuzz* f, const tree_case* c, stratus_ray* rays, size_t count)
{
  for (size_t r = 0; r < count; ++r) {
    double target[3];
    for (int axis = 0; axis < 3; ++axis) {
      const double low = c->bounds[2 * axis], high = c->bounds[2 * axis + 1], width = high - low;
      const bool lattice = fuzz_chance(f, 0.2); /* along edges and through corners */
      const double far = fuzz_chance(f, 0.1) ? 1e4 : 1.0;
      rays[r].origin[axis] = fuzz_real(f, low - far * width, high + far * width);
      rays[r].origin[axis] = lattice && !c->of_volume ? floor(rays[r].origin[axis]) : rays[r].origin[axis];
      target[axis] = fuzz_between(f, low, high);
      target[axis] = lattice && !c->of_volume ? floor(target[axis]) : target[axis];
      rays[r].direction[axis] = fuzz_odd(f) ? fuzz_odd_real(f) : fuzz_chance(f, 0.1) ? 0.0 : target[axis] - rays[r].origin[axis];
    }
    rays[r].t_min = fuzz_chance(f, 0.7) ? 0.0 : fuzz_real(f, -1.0, 2.0);
    rays[r].t_max = fuzz_chance(f, 0.7) ? INFINITY : fuzz_real(f, 0.0, 3.0);
    const double* d = rays[r].direction;
    if (d[0] == 0.0 && d[1] == 0.0 && d[2] == 0.0 && fuzz_is_tame(f)) {
      rays[r].direction[0] = 1.0;
    }
  }
}

/* Returns whether the tree was made without correction, so that its rays may step past voxels. */
static bool is_uncorrected(fuzz* f, const stratus_tree* tree)
{
  stratus_tree_statistics s;
  CALL(stratus_tree_get_statistics(tree, &s));
  return s.uncorrected != 0;
}

static void check_hits(fuzz* f, const tree_case* c, const stratus_tree* tree, bool compare)
{
  compare = compare && !is_uncorrected(f, tree);
  stratus_ray rays[RAYS_MOST];
  const size_t count = fuzz_chance(f, 0.05) ? 0 : 1 + fuzz_below(f, RAYS_MOST - 1);
  choose_rays(f, c, rays, count);
  const stratus_ray* given = fuzz_input(f, rays, count * sizeof *rays);
  stratus_hit *hits = fuzz_output(f, count * sizeof *hits), *plain = fuzz_output(f, count * sizeof *plain);
  const stratus_status status = STATUS(stratus_tree_first_hit(f->context, tree, given, count, hits));
  const stratus_status walked = STATUS(stratus_voxels_first_hit(f->context, c->voxels, given, count, plain));
  EXPECT(status == walked || !compare, "hits: %s, and by the walk %s: %s", stratus_status_name(status), stratus_status_name(walked),
    stratus_context_message(f->context));
  EXPECT(status == STRATUS_OK || !compare || !fuzz_is_tame(f), "%s", stratus_context_message(f->context));
  for (size_t r = 0; compare && fuzz_is_tame(f) && status == STRATUS_OK && r < count; ++r) {
    const stratus_hit *h = hits + r, *p = plain + r;
    const double *o = rays[r].origin, *d = rays[r].direction;
    EXPECT(h->t == p->t && memcmp(h->voxel, p->voxel, sizeof h->voxel) == 0 && h->face == p->face &&
        memcmp(h->normal, p->normal, sizeof h->normal) == 0,
      "ray %zu from (%.17g, %.17g, %.17g) along (%.17g, %.17g, %.17g), %.17g to %.17g, hits (%d, %d, %d) at %.17g, face %d; by the walk "
      "(%d, %d, %d) "
      "at %.17g, face %d",
      r, o[0], o[1], o[2], d[0], d[1], d[2], rays[r].t_min, rays[r].t_max, h->voxel[0], h->voxel[1], h->voxel[2], h->t, h->face,
      p->voxel[0], p->voxel[1], p->voxel[2], p->t, p->face);
    EXPECT(!isnan(h->t), "ray %zu hits at no number", r);
  }
  ++f->tally->compared;
}

/* ---- bytes */

static void change_bytes(fuzz* f, unsigned char* bytes, size_t size)
{
  static const int32_t numbers[] = { 0, 1, -1, 2, 3, 7, 64, 255, 256, 65535, 65536, INT32_MAX, INT32_MIN };
  const uint64_t changes = 1 + fuzz_below(f, fuzz_chance(f, 0.5) ? 1 : 8);
  for (uint64_t n = 0; n < changes && size > 8; ++n) {
    const size_t range = fuzz_chance(f, 0.3) && size > 160 ? 160 : size; /* the header */
    size_t at = fuzz_below(f, range - 4);
    switch (fuzz_below(f, 4)) {
      case 0:
        bytes[at] ^= (unsigned char)(1u << fuzz_below(f, 8));
        break;
      case 1:
        bytes[at] = (unsigned char)fuzz_next(f);
        break;
      case 2:
        at &= ~(size_t)3;
        memcpy(bytes + at, numbers + fuzz_below(f, sizeof numbers / sizeof *numbers), 4);
        break;
      default: {
        const size_t from = fuzz_below(f, size), length = 1 + fuzz_below(f, 32), to = fuzz_below(f, size);
        memmove(bytes + to, bytes + from, from + length <= size && to + length <= size ? length : 1);
        break;
      }
    }
  }
}

static void load_changed(fuzz* f, const tree_case* c, const unsigned char* saved, size_t size)
{
  size_t cut = fuzz_chance(f, 0.1) ? fuzz_below(f, size) : size;
  unsigned char* bytes = malloc(size + 64);
  memset(bytes, (int)fuzz_below(f, 256), size + 64);
  memcpy(bytes, saved, size);
  cut = fuzz_chance(f, 0.03) ? size + fuzz_below(f, 64) : cut;
  change_bytes(f, bytes, cut);
  if (fuzz_chance(f, 0.8) && cut > 24) {
    const uint64_t length = fuzz_chance(f, 0.9) ? cut : size;
    stratus_tree_seal(bytes, cut);
    memcpy(bytes + 8, &length, sizeof length); /* the checksum covers the bytes behind it */
  }
  const void* given = fuzz_input(f, bytes, cut);
  free(bytes);
  ++f->tally->byte_strings;
  stratus_tree* tree = NULL;
  if (CREATE(&tree, stratus_tree_load(f->context, given, cut, &tree)) == STRATUS_OK) {
    /* A tree that is accepted must be safe to use, whatever it says. */
    stratus_tree_statistics s;
    CALL(stratus_tree_get_statistics(tree, &s));
    EXPECT(s.nodes >= 0 && s.nodes < 1000000 && memchr(s.why, '\0', sizeof s.why), "%lld nodes are let in", (long long)s.nodes);
    CALL(stratus_tree_boxes(tree, fuzz_output(f, (size_t)s.nodes * sizeof(stratus_node_box))));
    (void)STATUS(stratus_tree_check(f->context, tree, c->voxels));
    check_hits(f, c, tree, false);
    const size_t bytes_again = CALL(stratus_tree_bytes(tree));
    CALL(stratus_tree_save(tree, fuzz_output(f, bytes_again)));
    if (c->of_volume) {
      int covers = -1;
      (void)STATUS(stratus_tree_covers(f->context, tree, &c->field.view, &c->criterion, c->cells, &covers));
    }
  }
  CALL(stratus_tree_destroy(tree));
}

/* Saves, loads and saves again: bytes and hits must be the same. */
static void check_bytes(fuzz* f, const tree_case* c, const stratus_tree* tree)
{
  const size_t size = CALL(stratus_tree_bytes(tree));
  unsigned char *saved = fuzz_output(f, size), *again = fuzz_output(f, size);
  stratus_tree* loaded = NULL;
  CALL(stratus_tree_save(tree, saved));
  const stratus_status status = CREATE(&loaded, stratus_tree_load(f->context, fuzz_input(f, saved, size), size, &loaded));
  EXPECT(status == STRATUS_OK, "a tree as it was saved is refused: %s", stratus_context_message(f->context));
  EXPECT(CALL(stratus_tree_bytes(loaded)) == size, "loaded, it has another size");
  CALL(stratus_tree_save(loaded, again));
  EXPECT(memcmp(saved, again, size) == 0, "saved, loaded and saved, it has other bytes");
  EXPECT(CALL(stratus_tree_hash(loaded)) == CALL(stratus_tree_hash(tree)), "loaded, it has another hash");
  check_hits(f, c, loaded, true);
  if (c->of_volume && fuzz_chance(f, 0.5)) {
    int covers = -1;
    const stratus_status asked = STATUS(stratus_tree_covers(f->context, loaded, &c->field.view, &c->criterion, c->cells, &covers));
    EXPECT(asked == STRATUS_OK && covers == !is_uncorrected(f, loaded), "it does not cover what it was made of, or though uncorrected: %d",
      covers);
  }
  CALL(stratus_tree_destroy(loaded));
  const uint64_t changed = 1 + fuzz_below(f, 8);
  for (uint64_t i = 0; i < changed; ++i) {
    load_changed(f, c, saved, size);
  }
}

static void check_tree(fuzz* f, const tree_case* c, const stratus_tree* tree)
{
  stratus_tree_statistics* s = fuzz_output(f, sizeof *s);
  CALL(stratus_tree_get_statistics(tree, s));
  EXPECT(s->voxels == CALL(stratus_voxels_count(c->voxels)), "%lld voxels in the tree", (long long)s->voxels);
  stratus_node_box* boxes = fuzz_output(f, (size_t)s->nodes * sizeof *boxes);
  CALL(stratus_tree_boxes(tree, boxes));
  for (int64_t b = 0; b < s->nodes; ++b) {
    EXPECT(boxes[b].depth >= 0 && boxes[b].depth <= s->depth && (unsigned)boxes[b].kind <= STRATUS_NODE_FIELD, "node %lld at depth %d",
      (long long)b, boxes[b].depth);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT(boxes[b].lo[axis] >= 0 && boxes[b].lo[axis] <= boxes[b].hi[axis], "node %lld from %lld to %lld", (long long)b,
        (long long)boxes[b].lo[axis], (long long)boxes[b].hi[axis]);
    }
  }
  EXPECT(
    (STATUS(stratus_tree_check(f->context, tree, c->voxels)) == STRATUS_OK) == !s->uncorrected, "%s", stratus_context_message(f->context));
  check_hits(f, c, tree, true);
}

void fuzz_trees(fuzz* f)
{
  tree_case c = { .voxels = NULL };
  stratus_tree* tree = NULL;
  const stratus_status made = fuzz_chance(f, 0.6) ? make_list(f, &c) : make_of_volume(f, &c);
  if (made != STRATUS_OK) {
    return;
  }
  const stratus_tree_options o = choose_options(f);
  const stratus_tree_options* options = fuzz_chance(f, 0.05) ? NULL : FUZZ_INPUT(f, o);
  fuzz_about(f, "%s, depth %d, leaves %d %d, field %lld %g; %lld x %lld x %lld, %lld voxels", stratus_tree_method_name(o.method),
    o.max_depth, o.leaf_bricks, o.leaf_voxels, (long long)o.field_bricks, o.field_emptiness, (long long)c.n[0], (long long)c.n[1],
    (long long)c.n[2], (long long)stratus_voxels_count(c.voxels));
  if (fuzz_chance(f, 0.15)) {
    fuzz_trouble(f);
  }
  const stratus_status status = CREATE(&tree, stratus_tree_create(f->context, c.voxels, options, &tree));
  const bool troubled = f->memory.refused + f->progress.cancelled > 0;
  fuzz_calm(f);
  EXPECT(status == STRATUS_OK || troubled || !fuzz_is_tame(f), "%s", stratus_context_message(f->context));
  if (status == STRATUS_OK) {
    check_tree(f, &c, tree);
    check_bytes(f, &c, tree);
  }
  CALL(stratus_tree_destroy(tree));
  CALL(stratus_voxels_destroy(c.voxels));
}
