/* SPDX-License-Identifier: BSD-3-Clause
 * The public functions that allocate and that no other test of refused memory calls: each request fails once. The call says so, holds
 * nothing, leaves what it would have filled as it was, and gives the same result at the next attempt. */
#include "device_jobs.h"
#include "faulty_allocator.h"
#include "testing.h"

#define REQUESTS_MAX 2000 /* for one call: far more than any needs, so that a loop which never succeeds ends */
#define MARK 0x5a         /* each byte of a call's output before the call */
#define OBJECTS 40        /* of an octree */

static void* saved; /* a tree's bytes */
static size_t saved_size;
static stratus_tree* cells;          /* of the scene's cells */
static stratus_voxels* clustered;    /* more than half of them close together, so that their median counts */
static stratus_value_range* ranges;  /* of the scene's volume */
static double boxes[OBJECTS][2][12]; /* turned boxes, and where they go */

static void assert_marked(const void* output, size_t size)
{
  for (size_t i = 0; i < size; ++i) {
    assert_int_equal(((const uint8_t*)output)[i], MARK);
  }
}

/* ---- the calls */

static stratus_status make_any_voxels(stratus_context* context, int kind, uint64_t* sum)
{
  const job_data* d = &jobs_data;
  const stratus_criterion criterion = { .transfer = &d->scene.transfer };
  stratus_voxels* voxels = NULL;
  const stratus_status status = kind == 0 ? stratus_voxels_create(context, &d->scene.volume, &criterion, &voxels)
    : kind == 1                           ? stratus_voxels_create_cells(context, &d->scene.volume, &criterion, &voxels)
                                          : stratus_voxels_create_list(context, d->set.dimensions, d->set.at[0], d->set.count, &voxels);
  if (status == STRATUS_OK) {
    *sum = job_sum(7, voxels->bricks, (size_t)voxels->brick_count * sizeof *voxels->bricks);
  } else {
    assert_null(voxels);
  }
  stratus_voxels_destroy(voxels);
  return status;
}

static stratus_status find_bandwidth(stratus_context* context, int number, uint64_t* sum)
{
  double found[2];
  (void)number;
  memset(found, MARK, sizeof found);
  const stratus_status status = stratus_density_bandwidth(context, clustered, found, found + 1);
  if (status == STRATUS_OK) {
    *sum = job_sum(7, found, sizeof found);
  } else {
    assert_marked(found, sizeof found);
  }
  return status;
}

/* Of two blocks that share points, with outliers left out, by columns. */
static stratus_status guess_look(stratus_context* context, int kind, uint64_t* sum)
{
  static float values[2][3 * 4 * 200];
  stratus_volume blocks[2] = { stratus_volume_default(), stratus_volume_default() };
  for (int n = 0; n < 2; ++n) {
    for (int i = 0; i < 3 * 4 * 200; ++i) {
      values[n][i] = i == 1234 ? 1e6f : (float)(i % 101);
    }
    blocks[n].values = values[n];
    blocks[n].type = STRATUS_FLOAT32;
    blocks[n].dimensions[0] = 3;
    blocks[n].dimensions[1] = 4;
    blocks[n].dimensions[2] = 200;
    blocks[n].origin[0] = 2.0 * n;
  }
  stratus_look_options options = stratus_look_options_default();
  stratus_look look;
  options.kind = (stratus_look_kind)kind;
  options.column_axis = 2;
  memset(&look, MARK, sizeof look);
  const stratus_status status = stratus_look_guess(context, blocks, 2, &options, &look);
  if (status == STRATUS_OK) {
    *sum = job_sum(7, look.opacity, 2 * look.opacity_count * sizeof *look.opacity);
    assert_true(look.high < 1e5);
  } else {
    assert_marked(&look, sizeof look);
  }
  return status;
}

static stratus_status mark_between(stratus_context* context, int number, uint64_t* sum)
{
  stratus_occupancy* occupancy = NULL;
  (void)number;
  const stratus_status status = stratus_occupancy_create_between(context, ranges, 1e6 + 0.3, 1e6 + 0.5, &occupancy);
  if (status == STRATUS_OK) {
    *sum = (uint64_t)stratus_occupancy_count(occupancy);
  } else {
    assert_null(occupancy);
  }
  stratus_occupancy_destroy(occupancy);
  return status;
}

static stratus_status make_field(stratus_context* context, int method, uint64_t* sum)
{
  return job_field(context, method, NULL, sum);
}

static stratus_status make_tree(stratus_context* context, int method, uint64_t* sum)
{
  stratus_tree_options options = stratus_tree_options_default();
  stratus_tree* tree = NULL;
  options.method = (stratus_tree_method)method;
  const stratus_status status = stratus_tree_create(context, jobs_data.voxels, &options, &tree);
  if (status == STRATUS_OK) {
    void* bytes = malloc(stratus_tree_bytes(tree));
    assert_non_null(bytes);
    stratus_tree_save(tree, bytes);
    *sum = job_sum(7, bytes, stratus_tree_bytes(tree));
    free(bytes);
  } else {
    assert_null(tree);
  }
  stratus_tree_destroy(tree);
  return status;
}

static stratus_status load_tree(stratus_context* context, int number, uint64_t* sum)
{
  stratus_tree* tree = NULL;
  (void)number;
  const stratus_status status = stratus_tree_load(context, saved, saved_size, &tree);
  if (status == STRATUS_OK) {
    *sum = stratus_tree_bytes(tree);
  } else {
    assert_null(tree);
  }
  stratus_tree_destroy(tree);
  return status;
}

static stratus_status compare_tree(stratus_context* context, int number, uint64_t* sum)
{
  const stratus_criterion criterion = { .transfer = &jobs_data.scene.transfer };
  int covers;
  (void)number;
  memset(&covers, MARK, sizeof covers);
  const stratus_status status = stratus_tree_covers(context, cells, &jobs_data.scene.volume, &criterion, 1, &covers);
  if (status == STRATUS_OK) {
    assert_int_equal(covers, 1);
    *sum = 1;
  } else {
    assert_int_equal(covers, 0); /* a call that fails reports that the tree covers nothing */
  }
  return status;
}

static stratus_status trace_rays(stratus_context* context, int number, uint64_t* sum)
{
  stratus_hit hits[JOB_RAYS];
  (void)number;
  memset(hits, MARK, sizeof hits);
  stratus_tree* tree = NULL;
  assert_int_equal(stratus_tree_load(jobs_data.host, saved, saved_size, &tree), STRATUS_OK);
  const stratus_status status = stratus_tree_first_hit(context, tree, jobs_data.rays, JOB_RAYS, hits);
  if (status == STRATUS_OK) {
    *sum = 7;
    for (int i = 0; i < JOB_RAYS; ++i) { /* by values: there may be room between them */
      *sum = job_sum(*sum, &hits[i].t, sizeof hits[i].t);
    }
  } else {
    assert_marked(hits, sizeof hits);
  }
  stratus_tree_destroy(tree);
  return status;
}

/* All objects are there or none, and all where they were or where they go. */
static stratus_status fill_octree(stratus_context* context, int number, uint64_t* sum)
{
  stratus_octree* octree = NULL;
  uint32_t ids[OBJECTS];
  double before[6], after[6];
  (void)number;
  stratus_status status = stratus_octree_create(context, NULL, &octree);
  if (status != STRATUS_OK) {
    assert_null(octree);
    return status;
  }
  for (int i = 0; i < OBJECTS && status == STRATUS_OK; ++i) { /* one by one, so that storage grows */
    status = stratus_octree_insert_oriented(octree, boxes[i][0], 1, ids + i);
    if (status != STRATUS_OK) {
      assert_int_equal(stratus_octree_count(octree), i);
    }
  }
  for (int i = 0; i < OBJECTS && status == STRATUS_OK; ++i) {
    assert_int_equal(stratus_octree_bounds(octree, ids[i], before), STRATUS_OK);
    status = stratus_octree_move_oriented(octree, ids + i, boxes[i][1], 1);
    assert_int_equal(stratus_octree_bounds(octree, ids[i], after), STRATUS_OK);
    assert_int_equal(memcmp(before, after, sizeof before) != 0, status == STRATUS_OK);
    *sum = job_sum(*sum, after, sizeof after);
  }
  stratus_octree_destroy(octree);
  return status;
}

/* A tracer of which a request was refused draws the image at the next attempt. */
static stratus_status trace_paths(stratus_context* context, int number, uint64_t* sum)
{
  float rgba[4 * SMALL_PIXELS];
  const stratus_image image = { .width = SMALL_WIDTH, .height = SMALL_HEIGHT, .rgba = rgba };
  const small_scene* scene = &jobs_data.scene;
  stratus_path_options options = stratus_path_options_default();
  stratus_path_tracer* tracer = NULL;
  (void)number;
  options.samples = 2;
  stratus_status status = stratus_path_tracer_create(context, &tracer);
  if (status != STRATUS_OK) {
    assert_null(tracer);
    return status;
  }
  for (int attempt = 0; attempt < 2; ++attempt) {
    const stratus_status drawn =
      stratus_path_tracer_render(tracer, &scene->volume, &scene->transfer, &scene->camera, &options, &image, NULL);
    if (drawn == STRATUS_OK) {
      *sum = job_sum(7, rgba, sizeof rgba);
      break;
    }
    assert_int_equal(attempt, 0);
    status = drawn;
  }
  stratus_path_tracer_destroy(tracer);
  return status;
}

typedef struct call {
  const char* name;
  int number;
  stratus_status (*run)(stratus_context* context, int number, uint64_t* sum);
} call;

static void try_call(stratus_context* context, faulty_allocator* allocator, const call* c)
{
  const int64_t live = allocator->live, before = allocator->calls;
  uint64_t right = 0, sum = 0;
  assert_int_equal(c->run(context, c->number, &right), STRATUS_OK);
  assert_int_equal(allocator->live, live);
  const int64_t requests = allocator->calls - before;
  assert_in_range(requests, 1, REQUESTS_MAX);
  for (int64_t n = 1; n <= requests; ++n) {
    allocator->fail_at = allocator->calls + n;
    sum = 0;
    const stratus_status status = c->run(context, c->number, &sum);
    if (status != STRATUS_OUT_OF_MEMORY || !strstr(stratus_context_message(context), "bytes")) {
      fail_msg("%s %d, request %d of %d: %s: \"%s\"", c->name, c->number, (int)n, (int)requests, stratus_status_name(status),
        stratus_context_message(context));
    }
    assert_int_equal(allocator->live, live);
    allocator->fail_at = 0;
    sum = 0;
    assert_int_equal(c->run(context, c->number, &sum), STRATUS_OK);
    assert_true(sum == right);
    assert_int_equal(allocator->live, live);
  }
  print_message("%s %d: %d requests\n", c->name, c->number, (int)requests);
}

static void each_request_fails_once(void** state)
{
  static const call calls[] = { { "voxels", 0, make_any_voxels }, { "voxels of cells", 1, make_any_voxels },
    { "voxels of a list", 2, make_any_voxels }, { "bandwidth", 0, find_bandwidth }, { "occupancy between", 0, mark_between },
    { "saved tree", 0, load_tree }, { "tree that may serve", 0, compare_tree }, { "first hits", 0, trace_rays },
    { "octree of turned boxes", 0, fill_octree }, { "path tracer", 0, trace_paths }, { "look", STRATUS_LOOK_AMOUNT, guess_look },
    { "look", STRATUS_LOOK_STATE, guess_look } };
  faulty_allocator allocator = { 0 };
  stratus_context* context = NULL;
  stratus_context_options options = faulty_options(&allocator, "host");
  (void)state;
  options.threads = 1; /* in hundreds of tiny calls threads would only wait for each other */
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  for (size_t i = 0; i < COUNT_OF(calls); ++i) {
    try_call(context, &allocator, calls + i);
  }
  for (int method = STRATUS_FIELD_EXACT; method <= STRATUS_FIELD_AJFA_FIG5; ++method) {
    try_call(context, &allocator, &(call){ "field", method, make_field });
  }
  for (int method = 0; method < STRATUS_TREE_METHODS; ++method) {
    try_call(context, &allocator, &(call){ "tree", method, make_tree });
  }
  stratus_context_destroy(context);
  assert_int_equal(allocator.live, 0);
}

static int begin(void** state)
{
  const stratus_criterion criterion = { .transfer = &jobs_data.scene.transfer };
  static voxel_set set;
  stratus_voxels* voxels = NULL;
  stratus_tree* tree = NULL;
  uint32_t random = 3;
  (void)state;
  jobs_prepare();
  stratus_context* host = jobs_data.host;
  assert_int_equal(stratus_tree_create(host, jobs_data.voxels, NULL, &tree), STRATUS_OK);
  saved_size = stratus_tree_bytes(tree);
  saved = malloc(saved_size);
  assert_non_null(saved);
  stratus_tree_save(tree, saved);
  stratus_tree_destroy(tree);
  assert_int_equal(stratus_voxels_create_cells(host, &jobs_data.scene.volume, &criterion, &voxels), STRATUS_OK);
  assert_int_equal(stratus_tree_create(host, voxels, NULL, &cells), STRATUS_OK);
  stratus_voxels_destroy(voxels);
  set_begin(&set, 40, 40, 40);
  set_add_box(&set, 17, 23, 17, 23, 17, 23);
  set_add_noise(&set, 60, &random);
  clustered = make_voxels(host, &set);
  assert_int_equal(stratus_value_range_create(host, &jobs_data.scene.volume, 2, &ranges), STRATUS_OK);
  for (int i = 0; i < OBJECTS; ++i) {
    for (int place = 0; place < 2; ++place) {
      const double box[12] = { 0.3 * i + 40.0 * place, i % 7, i % 5, 0.2, 0.1, 0.0, -0.1, 0.2, 0.0, 0.0, 0.0, 0.3 };
      memcpy(boxes[i][place], box, sizeof box);
    }
  }
  return 0;
}

static int end(void** state)
{
  (void)state;
  free(saved);
  stratus_tree_destroy(cells);
  stratus_voxels_destroy(clustered);
  stratus_value_range_destroy(ranges);
  jobs_release();
  return 0;
}

int test_allocation_calls(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(each_request_fails_once) };
  return cmocka_run_group_tests(tests, begin, end);
}
