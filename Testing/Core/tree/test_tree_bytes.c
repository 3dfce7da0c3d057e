/* SPDX-License-Identifier: BSD-3-Clause
 * Trees as bytes: the same tree comes back, and damaged, foreign or forged bytes give none. */
#include "first_hits.h"

#include "tree.h"

static stratus_context* open_context(void)
{
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context = NULL;
  options.device = "host";
  options.threads = 1;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  return context;
}

static stratus_tree* make_tree(stratus_context* context, stratus_tree_method method, uint32_t* random, stratus_voxels** voxels)
{
  const int64_t dimensions[3] = { 40, 30, 50 };
  stratus_tree_options options = stratus_tree_options_default();
  stratus_tree* tree = NULL;
  *voxels = random_voxels(context, dimensions, 0.01, 0, random);
  options.method = method;
  options.field_emptiness = 2.0;
  options.paper_threshold = 0.5; /* so that the paper's tree of so few voxels has several levels, too */
  assert_int_equal(stratus_tree_create(context, *voxels, &options, &tree), STRATUS_OK);
  return tree;
}

static void* save(const stratus_tree* tree, size_t* size)
{
  *size = stratus_tree_bytes(tree);
  void* bytes = malloc(*size);
  stratus_tree_save(tree, bytes);
  return bytes;
}

static void what_is_saved_comes_back(void** state)
{
  (void)state;
  uint32_t random = 2;
  stratus_context* context = open_context();
  for (int method = 0; method < STRATUS_TREE_METHODS; ++method) {
    stratus_voxels* voxels;
    stratus_tree *tree = make_tree(context, (stratus_tree_method)method, &random, &voxels), *back = NULL;
    size_t size, again;
    void* bytes = save(tree, &size);
    assert_int_equal(stratus_tree_load(context, bytes, size, &back), STRATUS_OK);
    void* copy = save(back, &again);
    assert_int_equal(size, again);
    assert_memory_equal(bytes, copy, size);
    assert_int_equal(stratus_tree_check(context, back, voxels), STRATUS_OK);
    stratus_tree_statistics a, b;
    stratus_tree_get_statistics(tree, &a);
    stratus_tree_get_statistics(back, &b);
    assert_true(a.nodes == b.nodes && a.depth == b.depth && a.sah == b.sah && a.bytes == b.bytes && a.voxels == b.voxels);
    assert_string_equal(a.why, b.why);
    free(bytes);
    free(copy);
    stratus_tree_destroy(tree);
    stratus_tree_destroy(back);
    stratus_voxels_destroy(voxels);
  }
  stratus_context_destroy(context);
}

/* A tree as a criterion that no value meets makes it. */
static void a_tree_of_no_voxel_comes_back_and_nothing_hits_it(void** state)
{
  (void)state;
  uint32_t random = 3;
  const int64_t dimensions[3] = { 40, 30, 50 };
  const int32_t nowhere[3] = { 0 };
  stratus_context* context = open_context();
  stratus_voxels* voxels = NULL;
  assert_int_equal(stratus_voxels_create_list(context, dimensions, nowhere, 0, &voxels), STRATUS_OK);
  for (int method = 0; method < STRATUS_TREE_METHODS; ++method) {
    stratus_tree_options options = stratus_tree_options_default();
    stratus_tree *tree = NULL, *back = NULL, *damaged = NULL;
    size_t size, again;
    options.method = (stratus_tree_method)method;
    assert_int_equal(stratus_tree_create(context, voxels, &options, &tree), STRATUS_OK);
    unsigned char* bytes = save(tree, &size);
    if (stratus_tree_load(context, bytes, size, &back) != STRATUS_OK) {
      fail_msg("%s: %s", stratus_tree_method_name(options.method), stratus_context_message(context));
    }
    void* copy = save(back, &again);
    assert_int_equal(size, again);
    assert_memory_equal(bytes, copy, size);
    assert_int_equal(stratus_tree_check(context, back, voxels), STRATUS_OK);
    for (int i = 0; i < 100; ++i) {
      const stratus_ray ray = random_ray(dimensions, &random);
      stratus_hit hit = { .t = 0 };
      assert_int_equal(stratus_tree_first_hit(context, back, &ray, 1, &hit), STRATUS_OK);
      assert_true(isinf(hit.t) && hit.voxel[0] == -1 && hit.face == -1);
    }
    for (size_t cut = 0; cut < size; ++cut) {
      assert_int_equal(stratus_tree_load(context, bytes, cut, &damaged), STRATUS_INVALID_ARGUMENT);
    }
    for (size_t at = 0; at < size; ++at) {
      bytes[at] ^= 0x10;
      assert_int_equal(stratus_tree_load(context, bytes, size, &damaged), STRATUS_INVALID_ARGUMENT);
      bytes[at] ^= 0x10;
    }
    tree->statistics.voxels = 1; /* but no node */
    free(copy);
    copy = save(tree, &again);
    assert_int_equal(stratus_tree_load(context, copy, again, &damaged), STRATUS_INVALID_ARGUMENT);
    assert_null(damaged);
    free(bytes);
    free(copy);
    stratus_tree_destroy(tree);
    stratus_tree_destroy(back);
  }
  stratus_voxels_destroy(voxels);
  stratus_context_destroy(context);
}

static void damaged_bytes_are_refused(void** state)
{
  (void)state;
  uint32_t random = 4;
  stratus_context* context = open_context();
  stratus_voxels* voxels;
  stratus_tree *tree = make_tree(context, STRATUS_TREE_OCTANT, &random, &voxels), *back = NULL;
  size_t size;
  unsigned char* bytes = save(tree, &size);
  for (size_t cut = 0; cut < size; cut += cut < 700 ? 1 : 97) {
    assert_int_equal(stratus_tree_load(context, bytes, cut, &back), STRATUS_INVALID_ARGUMENT);
  }
  for (size_t at = 0; at < size; at += at < 3000 ? 1 : 13) { /* padding counts, too */
    bytes[at] ^= 0x10;
    assert_int_equal(stratus_tree_load(context, bytes, size, &back), STRATUS_INVALID_ARGUMENT);
    bytes[at] ^= 0x10;
  }
  assert_null(back);
  assert_int_equal(stratus_tree_load(context, NULL, size, &back), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_tree_load(context, bytes, size, &back), STRATUS_OK);
  stratus_tree_destroy(back);
  free(bytes);
  stratus_tree_destroy(tree);
  stratus_voxels_destroy(voxels);
  stratus_context_destroy(context);
}

/* Trees forged with a right checksum are refused, or can at least be walked without harm. */
static void forged_trees_do_no_harm(void** state)
{
  (void)state;
  uint32_t random = 6;
  stratus_context* context = open_context();
  int refused = 0;
  for (int round = 0; round < 600; ++round) {
    static const int methods[4] = { STRATUS_TREE_OCTANT, STRATUS_TREE_DISTANCE, STRATUS_TREE_SAH, STRATUS_TREE_LBVH };
    stratus_voxels* voxels;
    stratus_tree *tree = make_tree(context, (stratus_tree_method)methods[round % 4], &random, &voxels), *back = NULL;
    const int64_t dimensions[3] = { 40, 30, 50 };
    void* const arrays[6] = { tree->nodes, tree->bricks, tree->fields, tree->entries, tree->rows, tree->masks };
    const size_t sizes[6] = { tree->node_count * sizeof *tree->nodes, tree->brick_count * sizeof *tree->bricks,
      tree->field_count * sizeof *tree->fields, (size_t)tree->entry_count * (size_t)tree->entry_bytes, tree->row_count * sizeof *tree->rows,
      tree->mask_count * sizeof *tree->masks };
    uint32_t which = next_random(&random) % 6;
    while (sizes[which] == 0) {
      which = (which + 1) % 6;
    }
    unsigned char* const victim = (unsigned char*)arrays[which] + next_random(&random) % sizes[which];
    *victim = (unsigned char)(*victim ^ (1u + next_random(&random) % 255));
    size_t size;
    void* bytes = save(tree, &size);
    if (stratus_tree_load(context, bytes, size, &back) == STRATUS_OK) {
      for (int i = 0; i < 100; ++i) {
        const stratus_ray ray = random_ray(dimensions, &random);
        stratus_hit hit;
        assert_int_equal(stratus_tree_first_hit(context, back, &ray, 1, &hit), STRATUS_OK);
      }
      stratus_tree_check(context, back, voxels); /* finds it, or the change was none that matters */
      stratus_tree_destroy(back);
    } else {
      ++refused;
    }
    free(bytes);
    stratus_tree_destroy(tree);
    stratus_voxels_destroy(voxels);
  }
  assert_true(refused > 100);
  stratus_context_destroy(context);
}

static stratus_status save_and_load(stratus_context* context, const stratus_tree* tree, stratus_tree** back)
{
  size_t size;
  void* bytes = save(tree, &size);
  const stratus_status status = stratus_tree_load(context, bytes, size, back);
  free(bytes);
  return status;
}

static void forged_places_and_intervals_are_refused(void** state)
{
  (void)state;
  uint32_t random = 12;
  stratus_context* context = open_context();
  stratus_voxels* voxels;
  stratus_tree *tree = make_tree(context, STRATUS_TREE_SAH, &random, &voxels), *back = NULL;
  tree->bricks[5].at[2] = (uint16_t)(tree->bricks[5].at[2] ? 0 : 3); /* in the volume, but not in its leaf */
  assert_int_equal(save_and_load(context, tree, &back), STRATUS_INVALID_ARGUMENT);
  stratus_tree_destroy(tree);
  stratus_voxels_destroy(voxels);
  tree = make_tree(context, STRATUS_TREE_OCTANT, &random, &voxels);
  static const double intervals[4][2][2] = { { { NAN, 1 }, { 2, 3 } }, { { 2, 1 }, { 3, 4 } }, { { 0, 2 }, { 1, 3 } },
    { { 5, 6 }, { 1, 2 } } };
  for (int i = 0; i < 4; ++i) {
    tree->origin.intervals = 2;
    memcpy(tree->origin.interval, intervals[i], sizeof intervals[i]);
    assert_int_equal(save_and_load(context, tree, &back), STRATUS_INVALID_ARGUMENT);
  }
  tree->origin.intervals = 0;
  assert_int_equal(save_and_load(context, tree, &back), STRATUS_OK);
  stratus_tree_destroy(back);
  back = NULL;
  tree->nodes[0].hi[2] -= 2; /* voxels of the last bricks lie beyond it now */
  assert_int_equal(save_and_load(context, tree, &back), STRATUS_INVALID_ARGUMENT);
  assert_null(back);
  stratus_tree_destroy(tree);
  stratus_voxels_destroy(voxels);
  stratus_context_destroy(context);
}

static stratus_volume small_volume(float values[6 * 6 * 6])
{
  stratus_volume volume = stratus_volume_default();
  for (int i = 0; i < 216; ++i) {
    values[i] = (float)(i % 37);
  }
  volume.values = values;
  volume.type = STRATUS_FLOAT32;
  volume.dimensions[0] = volume.dimensions[1] = volume.dimensions[2] = 6;
  return volume;
}

/* A tree of voxels covers only the criterion that it was made by, a tree of cells also narrower ones; both only in the volume that they
 * were made of. */
static void a_tree_covers_only_what_it_was_made_of(void** state)
{
  (void)state;
  stratus_context* context = open_context();
  float values[216];
  stratus_volume volume = small_volume(values);
  stratus_criterion criterion = stratus_criterion_default(), narrower = criterion, wider = criterion;
  criterion.lower = 20;
  criterion.upper = 30;
  narrower.lower = 22;
  narrower.upper = 25;
  wider.lower = 10;
  wider.upper = 30;
  for (int cells = 0; cells < 2; ++cells) {
    stratus_voxels* voxels = NULL;
    stratus_tree* tree = NULL;
    int covers = -1;
    assert_int_equal((cells ? stratus_voxels_create_cells : stratus_voxels_create)(context, &volume, &criterion, &voxels), STRATUS_OK);
    assert_int_equal(stratus_tree_create(context, voxels, NULL, &tree), STRATUS_OK);
    assert_int_equal(stratus_tree_covers(context, tree, &volume, &criterion, cells, &covers), STRATUS_OK);
    assert_int_equal(covers, 1);
    assert_int_equal(stratus_tree_covers(context, tree, &volume, &criterion, !cells, &covers), STRATUS_OK);
    assert_int_equal(covers, 0);
    assert_int_equal(stratus_tree_covers(context, tree, &volume, &narrower, cells, &covers), STRATUS_OK);
    assert_int_equal(covers, cells); /* a voxel too many would be hit; a cell too many is only looked at */
    assert_int_equal(stratus_tree_covers(context, tree, &volume, &wider, cells, &covers), STRATUS_OK);
    assert_int_equal(covers, 0);
    values[100] += 0.5f;
    assert_int_equal(stratus_tree_covers(context, tree, &volume, &criterion, cells, &covers), STRATUS_OK);
    assert_int_equal(covers, 0);
    values[100] -= 0.5f;
    tree->dimensions[1] *= 2; /* a forged one, of the right hash */
    assert_int_equal(stratus_tree_covers(context, tree, &volume, &criterion, cells, &covers), STRATUS_OK);
    assert_int_equal(covers, 0);
    stratus_tree_destroy(tree);
    stratus_voxels_destroy(voxels);
  }
  stratus_context_destroy(context);
}

/* Saves the tree as it is now, checksum included, and loads that. */
static stratus_status load_forged(stratus_context* context, const stratus_tree* tree)
{
  stratus_tree* back = NULL;
  size_t size;
  void* bytes = save(tree, &size);
  const stratus_status status = stratus_tree_load(context, bytes, size, &back);
  assert_true((back != NULL) == (status == STRATUS_OK));
  stratus_tree_destroy(back);
  free(bytes);
  return status;
}

/* Grows the box of `child`, which no field's cells bind, as far as the plane between it and its sibling, and then a voxel farther. Returns
 * whether there is one axis along which they lie apart: boxes apart along several have no one plane to pass. */
static bool grow_to_sibling(
  stratus_context* context, const stratus_tree* tree, stratus_tree_node* child, const stratus_tree_node* sibling, stratus_status beyond)
{
  const stratus_tree_node kept = *child;
  int axes = 0, axis = 0;
  for (int a = 0; a < 3; ++a) {
    const bool apart = child->hi[a] <= sibling->lo[a] || sibling->hi[a] <= child->lo[a];
    axes += apart;
    axis = apart ? a : axis;
  }
  if (axes != 1) {
    return false;
  }
  const bool below = child->hi[axis] <= sibling->lo[axis];
  int32_t* end = below ? &child->hi[axis] : &child->lo[axis];
  *end = below ? sibling->lo[axis] : sibling->hi[axis];
  assert_int_equal(load_forged(context, tree), STRATUS_OK);
  *end += below ? 1 : -1;
  assert_int_equal(load_forged(context, tree), beyond);
  if (beyond != STRATUS_OK) {
    assert_non_null(strstr(stratus_context_message(context), "has children that overlap"));
  }
  *child = kept;
  return true;
}

/* Leaps for each octant are between bricks: rays read masks there, which a field of voxels has not (a finding of stratus-fuzz). */
static void octants_between_voxels_are_refused(void** state)
{
  (void)state;
  uint32_t random = 21;
  stratus_context* context = open_context();
  for (int paper = 0; paper < 2; ++paper) {
    stratus_voxels* voxels;
    stratus_tree* tree = make_tree(context, paper ? STRATUS_TREE_HYBRID_PAPER : STRATUS_TREE_OCTANT, &random, &voxels);
    assert_int_equal(load_forged(context, tree), STRATUS_OK);
    tree->octants = 1;
    tree->cell_log2 = 0;
    assert_int_equal(load_forged(context, tree), STRATUS_INVALID_ARGUMENT);
    stratus_tree_destroy(tree);
    stratus_voxels_destroy(voxels);
  }
  stratus_context_destroy(context);
}

/* Rays in hybrid trees take the sibling on their side of a plane first. A box that grows as far as that plane is let in, a box that grows a
 * voxel beyond it is not; hierarchies, whose boxes may overlap, are. */
static void hybrid_siblings_that_overlap_are_refused(void** state)
{
  static const stratus_tree_method methods[] = { STRATUS_TREE_HYBRID, STRATUS_TREE_HYBRID_PAPER, STRATUS_TREE_SAH };
  (void)state;
  uint32_t random = 9;
  stratus_context* context = open_context();
  for (int m = 0; m < 3; ++m) {
    stratus_voxels* voxels;
    stratus_tree* tree = make_tree(context, methods[m], &random, &voxels);
    const stratus_status beyond = methods[m] == STRATUS_TREE_SAH ? STRATUS_OK : STRATUS_INVALID_ARGUMENT;
    int grown = 0;
    for (uint32_t n = 0; n < tree->node_count && grown < 20; ++n) {
      for (int c = 0; stratus_tree_node_kind(&tree->nodes[n]) == STRATUS_NODE_INNER && c < 2; ++c) {
        stratus_tree_node* child = &tree->nodes[tree->nodes[n].first];
        grown +=
          stratus_tree_node_kind(&child[c]) != STRATUS_NODE_FIELD && grow_to_sibling(context, tree, &child[c], &child[1 - c], beyond);
      }
    }
    print_message("             %s: %d boxes grown\n", stratus_tree_method_name(methods[m]), grown);
    assert_true(grown > 0);
    assert_int_equal(load_forged(context, tree), STRATUS_OK);
    stratus_tree_destroy(tree);
    stratus_voxels_destroy(voxels);
  }
  stratus_context_destroy(context);
}

/* A saved tree contains the method that made it, which is never `auto`. */
static void a_tree_of_no_method_is_refused(void** state)
{
  stratus_context* context = open_context();
  stratus_voxels* voxels = NULL;
  uint32_t random = 9;
  (void)state;
  stratus_tree* tree = make_tree(context, STRATUS_TREE_AUTO, &random, &voxels);
  assert_int_equal(tree->statistics.method, STRATUS_TREE_OCTANT);
  assert_int_equal(load_forged(context, tree), STRATUS_OK);
  for (int method = -1; method <= STRATUS_TREE_METHODS; ++method) {
    const bool good = method >= 0 && method < STRATUS_TREE_AUTO && method != STRATUS_TREE_WIDE; /* which has no fields */
    tree->statistics.method = (stratus_tree_method)method;
    assert_int_equal(load_forged(context, tree), good ? STRATUS_OK : STRATUS_INVALID_ARGUMENT);
  }
  stratus_tree_destroy(tree);
  stratus_voxels_destroy(voxels);
  stratus_context_destroy(context);
}

int test_tree_bytes(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(what_is_saved_comes_back),
    cmocka_unit_test(a_tree_of_no_voxel_comes_back_and_nothing_hits_it), cmocka_unit_test(damaged_bytes_are_refused),
    cmocka_unit_test(forged_trees_do_no_harm), cmocka_unit_test(octants_between_voxels_are_refused),
    cmocka_unit_test(hybrid_siblings_that_overlap_are_refused), cmocka_unit_test(forged_places_and_intervals_are_refused),
    cmocka_unit_test(a_tree_covers_only_what_it_was_made_of), cmocka_unit_test(a_tree_of_no_method_is_refused) };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
