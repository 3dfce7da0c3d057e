/* SPDX-License-Identifier: BSD-3-Clause
 * Hard cases for meshes, partitions and orders: memory refused at every request, a caller that cancels, parts that share nothing, numbers
 * at the ends of their range. Each case ends in the right order or in an error that says why. */
#include "faulty_allocator.h"
#include "mesh_case.h"

#define REQUESTS_MAX 2000 /* more than any call below needs */

/* Cuts the mesh, sorts its cells, and frees everything. *wrong, if wanted: pairs in the wrong order. */
static stratus_status cut_and_sort(stratus_context* context, const mesh_case* mesh, int64_t* wrong)
{
  stratus_partition_options options = stratus_partition_options_default();
  const stratus_mesh view = mesh_case_view(mesh);
  const stratus_camera camera = { .eye = { 11, 9, 7 }, .forward = { -1, -1, -1 } };
  stratus_partition* partition = NULL;
  stratus_visibility_order* order = NULL;
  options.leaf_cells = 30;
  stratus_status status = stratus_partition_create(context, &view, &options, &partition);
  if (status == STRATUS_OK) {
    stratus_partition_result cut;
    stratus_visibility_result result;
    stratus_partition_get(partition, &cut);
    mesh_case pieces = { (double*)(uintptr_t)cut.points, (int32_t*)(uintptr_t)cut.vertices, cut.point_count, cut.cell_count };
    const stratus_mesh pieces_view = mesh_case_view(&pieces);
    status = stratus_visibility_order_create(context, &pieces_view, &cut.leaves, &order);
    if (status == STRATUS_OK) {
      status = stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result);
    }
    if (status == STRATUS_OK && wrong) {
      int64_t pairs = 0;
      *wrong = mesh_wrong_pairs(&pieces, &camera, result.cells, 100, 1, &pairs);
      assert_true(pairs > 100);
    }
  }
  stratus_visibility_order_destroy(order);
  stratus_partition_destroy(partition);
  return status;
}

/* Two boxes side by side that share no point. One has cells without volume. */
static mesh_case seamed_mesh(void)
{
  static const int n[3] = { 3, 3, 3 };
  static const double one[3] = { 1, 1, 1 }, offset[3] = { 3, 0, 0 };
  mesh_case left = mesh_grid(n, 0.1, 1), right = mesh_grid(n, 0.0, 1);
  for (int64_t i = 0; i < right.point_count; ++i) {
    right.points[3 * i] -= right.points[3 * i] >= 2.0;
  }
  mesh_move(&right, one, offset);
  return mesh_join(left, right);
}

static void orders_and_partitions_are_made_whole_or_not_at_all(void** state)
{
  (void)state;
  faulty_allocator allocator = { 0 };
  stratus_context_options options = faulty_options(&allocator, "host");
  stratus_context* context = NULL;
  options.threads = 1;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  mesh_case mesh = seamed_mesh();
  const int64_t live = allocator.live;
  int64_t n = 1;
  for (; n < REQUESTS_MAX; ++n) {
    allocator.fail_at = allocator.calls + n;
    const stratus_status status = cut_and_sort(context, &mesh, NULL);
    assert_int_equal(allocator.live, live);
    if (status == STRATUS_OK) {
      break;
    }
    assert_int_equal(status, STRATUS_OUT_OF_MEMORY);
    assert_non_null(strstr(stratus_context_message(context), "bytes"));
  }
  assert_true(n > 30 && n < REQUESTS_MAX);
  allocator.fail_at = 0;
  int64_t wrong = -1;
  assert_int_equal(cut_and_sort(context, &mesh, &wrong), STRATUS_OK);
  assert_int_equal(wrong, 0);
  mesh_case_free(&mesh);
  stratus_context_destroy(context);
  assert_int_equal(allocator.live, 0);
}

typedef struct cancel_state {
  int calls, cancel_at;
} cancel_state;

static int cancel_sometime(void* user, const char* stage, double fraction)
{
  cancel_state* cancel = user;
  assert_non_null(stage);
  assert_true(fraction >= 0.0 && fraction <= 1.0);
  return ++cancel->calls == cancel->cancel_at;
}

static void a_cancelled_call_leaves_nothing_behind(void** state)
{
  (void)state;
  faulty_allocator allocator = { 0 };
  cancel_state cancel = { 0 };
  stratus_context_options options = faulty_options(&allocator, "host");
  stratus_context* context = NULL;
  options.progress = cancel_sometime;
  options.progress_user = &cancel;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  mesh_case mesh = seamed_mesh();
  const int64_t live = allocator.live;
  int cancelled = 0;
  for (cancel.cancel_at = 1; cancel.cancel_at < REQUESTS_MAX; ++cancel.cancel_at, ++cancelled) {
    cancel.calls = 0;
    const stratus_status status = cut_and_sort(context, &mesh, NULL);
    assert_int_equal(allocator.live, live);
    if (status == STRATUS_OK) {
      break;
    }
    assert_int_equal(status, STRATUS_CANCELLED);
  }
  assert_true(cancelled > 5 && cancelled < REQUESTS_MAX - 1);
  mesh_case_free(&mesh);
  stratus_context_destroy(context);
}

static stratus_context* make_context(void)
{
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context = NULL;
  options.device = "host";
  options.threads = 2;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  return context;
}

static int64_t wrong_pairs_in_one_leaf(stratus_context* context, const mesh_case* mesh)
{
  static const double eyes[][3] = { { 30, 4, 5 }, { -20, 6, 3 }, { 3, 40, -9 }, { 5, 5, 30 }, { -9, -8, -12 } };
  const stratus_mesh view = mesh_case_view(mesh);
  stratus_visibility_order* order = NULL;
  int64_t wrong = 0, pairs = 0;
  assert_int_equal(stratus_visibility_order_create(context, &view, NULL, &order), STRATUS_OK);
  for (size_t i = 0; i < sizeof eyes / sizeof *eyes; ++i) {
    stratus_camera camera = { .forward = { 1, 0, 0 } };
    stratus_visibility_result result;
    memcpy(camera.eye, eyes[i], sizeof camera.eye);
    assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_OK);
    wrong += mesh_wrong_pairs(mesh, &camera, result.cells, 200, (uint32_t)i, &pairs);
  }
  assert_true(pairs > 1000);
  stratus_visibility_order_destroy(order);
  return wrong;
}

static void parts_with_gaps_between_are_in_order(void** state)
{
  static const int n[3] = { 4, 4, 4 }, slab[3] = { 1, 5, 5 };
  static const double one[3] = { 1, 1, 1 };
  (void)state;
  stratus_context* context = make_context();
  mesh_case far = mesh_grid(n, 0.15, 2);
  mesh_move(&far, one, (const double[3]){ 4.7, 0.3, 0.2 });
  mesh_case mesh = mesh_join(mesh_grid(n, 0.15, 1), far);
  mesh_shuffle(&mesh, 3);
  assert_int_equal(wrong_pairs_in_one_leaf(context, &mesh), 0);
  mesh_case_free(&mesh);

  mesh = mesh_grid(slab, 0.1, 1); /* slabs of two parts by turns */
  for (int i = 1; i < 6; ++i) {
    mesh_case next = mesh_grid(slab, 0.1, (uint32_t)i);
    mesh_move(&next, one, (const double[3]){ 1.6 * i, 0, 0 });
    mesh = mesh_join(mesh, next);
  }
  mesh_shuffle(&mesh, 3);
  assert_int_equal(wrong_pairs_in_one_leaf(context, &mesh), 0);
  mesh_case_free(&mesh);
  stratus_context_destroy(context);
}

static void slivers_are_in_order(void** state)
{
  static const int n[3] = { 4, 4, 4 };
  (void)state;
  stratus_context* context = make_context();
  for (int exponent = -3; exponent >= -12; exponent -= 3) {
    mesh_case mesh = mesh_grid(n, 0.0, 1);
    for (int64_t i = 0; i < mesh.point_count; ++i) { /* a layer as thin as that */
      double* z = mesh.points + 3 * i + 2;
      *z -= *z >= 2.0 ? 1.0 - pow(10.0, exponent) : 0.0;
    }
    mesh_shuffle(&mesh, 5);
    assert_int_equal(wrong_pairs_in_one_leaf(context, &mesh), 0);
    mesh_case_free(&mesh);
  }
  stratus_context_destroy(context);
}

static void numbers_at_the_ends_of_their_range_end_in_an_order_or_an_error(void** state)
{
  static const int n[3] = { 3, 3, 3 };
  static const double scales[] = { 1e-300, 1e-160, 1e-30, 1e30, 1e160, 1e299, 1e305 };
  (void)state;
  stratus_context* context = make_context();
  for (size_t i = 0; i < sizeof scales / sizeof *scales; ++i) {
    mesh_case mesh = mesh_grid(n, 0.1, 1);
    const double s = scales[i];
    mesh_move(&mesh, (const double[3]){ s, s, s }, (const double[3]){ 0, 0, 0 });
    const stratus_mesh view = mesh_case_view(&mesh);
    stratus_visibility_order *order = NULL, *plain = NULL;
    const stratus_status status = stratus_visibility_order_create(context, &view, NULL, &order);
    assert_int_equal(status, s > 1e300 ? STRATUS_INVALID_ARGUMENT : STRATUS_OK);
    if (status == STRATUS_OK) {
      mesh_case same = mesh_grid(n, 0.1, 1);
      const stratus_mesh same_view = mesh_case_view(&same);
      const stratus_camera camera = { .forward = { 1, .4, .7 }, .parallel = 1 };
      stratus_visibility_result scaled, unit;
      int64_t pairs = 0;
      assert_int_equal(stratus_visibility_order_create(context, &same_view, NULL, &plain), STRATUS_OK);
      assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &scaled), STRATUS_OK);
      assert_int_equal(stratus_visibility_order_sort(plain, &camera, NULL, STRATUS_PEELING_NEAREST, &unit), STRATUS_OK);
      assert_int_equal(mesh_wrong_pairs(&same, &camera, scaled.cells, 100, 1, &pairs), 0); /* the same mesh but for its unit */
      stratus_visibility_order_destroy(plain);
      mesh_case_free(&same);
    }
    stratus_visibility_order_destroy(order);
    mesh_case_free(&mesh);
  }
  stratus_context_destroy(context);
}

int test_tetrahedra_fail(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(orders_and_partitions_are_made_whole_or_not_at_all),
    cmocka_unit_test(a_cancelled_call_leaves_nothing_behind),
    cmocka_unit_test(parts_with_gaps_between_are_in_order),
    cmocka_unit_test(slivers_are_in_order),
    cmocka_unit_test(numbers_at_the_ends_of_their_range_end_in_an_order_or_an_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
