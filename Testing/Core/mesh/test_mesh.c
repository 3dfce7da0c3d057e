/* SPDX-License-Identifier: BSD-3-Clause
 * Meshes of tetrahedra: exact orientation compared with integers, neighbours compared with a loop over all pairs of faces. */
#include "mesh.h"
#include "mesh_case.h"

__extension__ typedef __int128 wide_integer;

static int sign_of(wide_integer x)
{
  return (x > 0) - (x < 0);
}

static int integer_orientation(int64_t p[4][3], int64_t direction[3])
{
  wide_integer m[3][3];
  for (int r = 0; r < 3; ++r) {
    for (int a = 0; a < 3; ++a) {
      m[r][a] = direction && r == 2 ? direction[a] : p[r + 1][a] - p[0][a];
    }
  }
  return sign_of(m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) + m[0][1] * (m[1][2] * m[2][0] - m[1][0] * m[2][2]) +
    m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]));
}

/* Points nearly in a plane, whose coordinates are integers times a power of two: the determinant is an integer of under 127 bits. */
static void orientation_is_that_of_integers(void** state)
{
  static const int exponents[] = { 0, -200, 150, -20 };
  uint32_t random = 1;
  int seen[3] = { 0 }, seen_along[3] = { 0 };
  (void)state;
  for (int repeat = 0; repeat < 200000; ++repeat) {
    int64_t p[4][3], bits = 2 + repeat % 38;
    double q[4][3], away[3];
    const int64_t offset = repeat % 3 == 0 ? INT64_C(1) << 44 : 0; /* far away, as UTM coordinates are */
    for (int i = 0; i < 12; ++i) {
      const int64_t number = (int64_t)(((uint64_t)mesh_random(&random) << 24 | mesh_random(&random)) & ((UINT64_C(1) << bits) - 1));
      p[i / 3][i % 3] = number;
    }
    const int64_t s = mesh_random(&random) % 4, t = mesh_random(&random) % 4;
    int64_t direction[3];
    for (int a = 0; a < 3; ++a) {
      direction[a] = s * (p[1][a] - p[0][a]) + t * (p[2][a] - p[0][a]) + (int64_t)(mesh_random(&random) % 3) - 1;
      p[3][a] = repeat % 2 ? p[0][a] + direction[a] : p[3][a];
      p[0][a] += offset;
      p[1][a] += offset;
      p[2][a] += offset;
      p[3][a] += offset;
    }
    for (int i = 0; i < 12; ++i) {
      q[i / 3][i % 3] = ldexp((double)p[i / 3][i % 3], exponents[repeat % 4]);
      away[i % 3] = ldexp((double)direction[i % 3], exponents[(repeat + 1) % 4]);
    }
    const int expected = integer_orientation(p, NULL), along = integer_orientation(p, direction);
    assert_int_equal(stratus_orientation(q[0], q[1], q[2], q[3]), expected);
    assert_int_equal(stratus_orientation(q[1], q[0], q[2], q[3]), -expected);
    assert_int_equal(stratus_orientation_along(q[0], q[1], q[2], away), along);
    ++seen[expected + 1];
    ++seen_along[along + 1];
  }
  for (int i = 0; i < 3; ++i) {
    assert_true(seen[i] > 1000 && seen_along[i] > 1000);
  }
}

/* Three points nearly in a line, as seen along an axis: two products of up to 90 bits decide. */
static void orientation_along_an_axis_is_that_of_integers(void** state)
{
  static const int exponents[] = { 0, -200, 150, -20 };
  uint32_t random = 7;
  int seen[3] = { 0 };
  (void)state;
  for (int repeat = 0; repeat < 100000; ++repeat) {
    int64_t p[4][3] = { { 0 } }, direction[3] = { 0, 0, 0 };
    double q[3][3], away[3];
    const int bits = 2 + repeat % 40, times = 1 + (int)(mesh_random(&random) % 15);
    direction[repeat % 3] = repeat % 2 ? 3 : -1;
    for (int a = 0; a < 3; ++a) {
      const int64_t mask = (INT64_C(1) << bits) - 1, step = ((int64_t)mesh_random(&random) << 24 | mesh_random(&random)) & mask;
      p[0][a] = ((int64_t)mesh_random(&random) << 24 | mesh_random(&random)) & mask;
      p[1][a] = p[0][a] + step;
      p[2][a] = p[0][a] + times * step + (int64_t)(mesh_random(&random) % 3) - 1;
    }
    for (int i = 0; i < 9; ++i) {
      q[i / 3][i % 3] = ldexp((double)p[i / 3][i % 3], exponents[repeat % 4]);
      away[i % 3] = ldexp((double)direction[i % 3], exponents[(repeat + 1) % 4]);
    }
    const int expected = integer_orientation(p, direction);
    assert_int_equal(stratus_orientation_along(q[0], q[1], q[2], away), expected);
    assert_int_equal(stratus_orientation_along(q[0], q[2], q[1], away), -expected);
    ++seen[expected + 1];
  }
  assert_true(seen[0] > 1000 && seen[1] > 1000 && seen[2] > 1000);
}

/* Two coordinates differ by the last bit: computed in doubles, these points would be coplanar. */
static void orientation_sees_the_last_bit(void** state)
{
  const double a[3] = { 0.0, 0.0, 0.1 }, b[3] = { 1e6, 0.0, 0.1 }, c[3] = { 0.0, 1e6, 0.1 }, d[3] = { 3e5, 3e5, nextafter(0.1, 1.0) },
               e[3] = { 3e5, 3e5, 0.1 };
  (void)state;
  assert_int_equal(stratus_orientation(a, b, c, d), 1);
  assert_int_equal(stratus_orientation(d, b, c, a), -1);
  assert_int_equal(stratus_orientation(a, b, c, e), 0);
}

static bool same_points(const int32_t p[3], const int32_t q[3])
{
  return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

static bool is_collapsed(const int32_t* v)
{
  return v[0] == v[1] || v[0] == v[2] || v[0] == v[3] || v[1] == v[2] || v[1] == v[3] || v[2] == v[3];
}

/* Compares with loops over all pairs of faces. */
static void assert_neighbours(const mesh_case* mesh, const stratus_adjacency* adjacency)
{
  int64_t border = 0, broken = 0, folded = 0;
  for (int64_t i = 0; i < 4 * mesh->cell_count; ++i) {
    const int32_t* v = mesh->vertices + 4 * (i / 4);
    int32_t p[3], q[3];
    int owners = 1, other_side = 0;
    int64_t other = -1;
    const int side = stratus_face_points(v, (int)(i % 4), p) * adjacency->orientation[i / 4];
    for (int64_t j = 0; j < 4 * mesh->cell_count && !is_collapsed(v); ++j) {
      const int32_t* w = mesh->vertices + 4 * (j / 4);
      if (i != j && !is_collapsed(w)) {
        const int sign = stratus_face_points(w, (int)(j % 4), q) * adjacency->orientation[j / 4];
        if (same_points(p, q)) {
          ++owners;
          other = j / 4;
          other_side = sign;
        }
      }
    }
    const bool fold = owners == 2 && side * other_side > 0;
    broken += owners > 2;
    folded += fold;
    border += owners != 2 || fold;
    assert_int_equal(adjacency->neighbours[i], owners == 2 && !fold ? other : -1);
  }
  assert_int_equal(adjacency->border_faces, border);
  assert_int_equal(adjacency->broken_faces, broken);
  assert_int_equal(adjacency->folded_faces, folded);
}

/* Random cells of few points: faces are shared in every way, cells come twice, some are flat or collapsed. */
static void neighbours_of_random_cells_are_those_of_all_pairs(void** state)
{
  uint32_t random = 3;
  int64_t broken = 0, folded = 0, flat = 0, inner = 0;
  (void)state;
  for (int repeat = 0; repeat < 300; ++repeat) {
    stratus_context* context = mesh_context(1 + repeat % 4);
    mesh_case mesh = mesh_case_allocate(4 + repeat % 12, mesh_random(&random) % 40);
    for (int64_t i = 0; i < 3 * mesh.point_count; ++i) {
      mesh.points[i] = mesh_random(&random) % 4;
    }
    for (int64_t i = 0; i < 4 * mesh.cell_count; ++i) {
      mesh.vertices[i] = (int32_t)(mesh_random(&random) % mesh.point_count);
    }
    const stratus_mesh view = mesh_case_view(&mesh);
    stratus_adjacency* adjacency = NULL;
    assert_int_equal(stratus_mesh_check(context, &view), STRATUS_OK);
    assert_int_equal(stratus_adjacency_create(context, &view, &adjacency), STRATUS_OK);
    assert_neighbours(&mesh, adjacency);
    broken += adjacency->broken_faces;
    folded += adjacency->folded_faces;
    flat += adjacency->flat;
    inner += 4 * mesh.cell_count - adjacency->border_faces;
    stratus_adjacency_destroy(adjacency);
    stratus_context_destroy(context);
    mesh_case_free(&mesh);
  }
  assert_true(broken > 100 && folded > 100 && flat > 100 && inner > 100);
}

/* A grid large enough for many buckets and chunks, whose border is known. Threads change nothing. */
static void a_grid_has_the_border_of_its_box(void** state)
{
  static const int n[3] = { 17, 23, 12 };
  int32_t* first = NULL;
  (void)state;
  mesh_case mesh = mesh_grid(n, 0.15, 5);
  mesh_shuffle(&mesh, 6);
  for (int threads = 1; threads <= 5; threads += 2) {
    stratus_context* context = mesh_context(threads);
    const stratus_mesh view = mesh_case_view(&mesh);
    stratus_adjacency* adjacency = NULL;
    assert_int_equal(stratus_adjacency_create(context, &view, &adjacency), STRATUS_OK);
    assert_int_equal(adjacency->border_faces, 4 * (n[0] * n[1] + n[1] * n[2] + n[2] * n[0]));
    assert_int_equal(adjacency->flat + adjacency->broken_faces + adjacency->folded_faces, 0);
    const size_t bytes = (size_t)mesh.cell_count * 4 * sizeof(int32_t);
    if (!first) {
      first = malloc(bytes);
      assert_non_null(first);
      memcpy(first, adjacency->neighbours, bytes);
    }
    assert_memory_equal(first, adjacency->neighbours, bytes);
    for (int64_t i = 0; i < 4 * mesh.cell_count; ++i) {
      const int32_t j = adjacency->neighbours[i];
      const int32_t* back = adjacency->neighbours + 4 * (int64_t)(j < 0 ? 0 : j);
      assert_true(j < 0 || back[0] == i / 4 || back[1] == i / 4 || back[2] == i / 4 || back[3] == i / 4);
    }
    stratus_adjacency_destroy(adjacency);
    stratus_context_destroy(context);
  }
  free(first);
  mesh_case_free(&mesh);
}

static void a_view_that_is_wrong_is_refused_with_its_value(void** state)
{
  static const double nan_points[12] = { 0, 0, 0, 1, 0, 0, 0, NAN, 0, 0, 0, 1 }, points[12] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  static const int32_t good[4] = { 0, 1, 2, 3 }, high[4] = { 0, 1, 2, 4 }, low[4] = { 0, -1, 2, 3 };
  (void)state;
  stratus_context* context = mesh_context(1);
  stratus_mesh right = stratus_mesh_default();
  right.points = points;
  right.point_count = 4;
  right.vertices = good;
  right.cell_count = 1;
  assert_int_equal(stratus_mesh_check(context, &right), STRATUS_OK);
  assert_int_equal(stratus_mesh_check(context, NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_mesh_check(NULL, &right), STRATUS_INVALID_ARGUMENT);
  for (int wrong = 0; wrong < 11; ++wrong) {
    static const char* says[] = { "points", "vertices", "point_count -1", "cell_count 1073741824", "point 2", "vertex 4", "vertex -1",
      "matrix", "singular", "value_stride 0", "cell_values 2" };
    stratus_mesh mesh = right;
    mesh.points = wrong == 0 ? NULL : wrong == 4 ? nan_points : points;
    mesh.vertices = wrong == 1 ? NULL : wrong == 5 ? high : wrong == 6 ? low : good;
    mesh.point_count = wrong == 2 ? -1 : 4;
    mesh.cell_count = wrong == 3 ? 1 << 30 : 1;
    mesh.matrix[15] = wrong == 7 ? 2.0 : 1.0;
    mesh.matrix[5] = wrong == 8 ? 0.0 : 1.0;
    mesh.value_stride = wrong == 9 ? 0 : 1;
    mesh.cell_values = wrong == 10 ? 2 : 0;
    assert_int_equal(stratus_mesh_check(context, &mesh), STRATUS_INVALID_ARGUMENT);
    assert_non_null(strstr(stratus_context_message(context), says[wrong]));
  }
  stratus_mesh empty = stratus_mesh_default();
  assert_int_equal(stratus_mesh_check(context, &empty), STRATUS_OK);
  stratus_context_destroy(context);
}

int test_mesh(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(orientation_is_that_of_integers),
    cmocka_unit_test(orientation_along_an_axis_is_that_of_integers),
    cmocka_unit_test(orientation_sees_the_last_bit),
    cmocka_unit_test(neighbours_of_random_cells_are_those_of_all_pairs),
    cmocka_unit_test(a_grid_has_the_border_of_its_box),
    cmocka_unit_test(a_view_that_is_wrong_is_refused_with_its_value),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
