/* SPDX-License-Identifier: BSD-3-Clause
 * Partitions: pieces fill what they were cut from, meet in the same faces, and lie in their leaves; the plane is the one that a loop over all
 * candidates finds; orders by leaves are right. */
#include "mesh.h"
#include "mesh_case.h"

static stratus_context* make_context(int threads)
{
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context = NULL;
  options.device = "host";
  options.threads = threads;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  return context;
}

static double volume_of(const double* points, const int32_t* v)
{
  double m[3][3];
  for (int i = 0; i < 9; i++) {
    m[i / 3][i % 3] = points[3 * (int64_t)v[i / 3 + 1] + i % 3] - points[3 * (int64_t)v[0] + i % 3];
  }
  return (m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) + m[0][1] * (m[1][2] * m[2][0] - m[1][0] * m[2][2]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])) /
    6.0;
}

static mesh_case mesh_of(const stratus_partition_result* cut)
{
  return (mesh_case){ (double*)(uintptr_t)cut->points, (int32_t*)(uintptr_t)cut->vertices, cut->point_count, cut->cell_count };
}

/* Volumes and the integral of an interpolated field, cell by cell; orientations; points as their ends and weights have them. */
static void assert_pieces_fill_their_cells(const mesh_case* mesh, const stratus_partition_result* cut)
{
  double* sums = calloc((size_t)mesh->cell_count * 2 + 1, sizeof(double));
  double* field = malloc((size_t)cut->point_count * sizeof(double) + 1);
  assert_true(sums && field);
  assert_int_equal(cut->old_points, mesh->point_count);
  assert_memory_equal(cut->points, mesh->points, (size_t)mesh->point_count * 3 * sizeof(double));
  for (int64_t i = 0; i < cut->point_count; i++) {
    field[i] = i < mesh->point_count ? (double)(i * 37 % 101) : 0.0;
    if (i >= mesh->point_count) {
      const int32_t* end = cut->ends + 2 * (i - mesh->point_count);
      const double w = cut->weights[i - mesh->point_count];
      assert_true(w > 0.0 && w < 1.0 && end[0] < i && end[1] < i && end[0] != end[1]);
      field[i] = (1.0 - w) * field[end[0]] + w * field[end[1]];
      for (int a = 0; a < 3; a++) {
        const double p = cut->points[3 * (int64_t)end[0] + a], q = cut->points[3 * (int64_t)end[1] + a];
        assert_true(fabs((1.0 - w) * p + w * q - cut->points[3 * i + a]) <= 4e-16 * fmax(fabs(p), fabs(q)));
      }
    }
  }
  for (int64_t c = 0; c < cut->cell_count; c++) {
    const int32_t* v = cut->vertices + 4 * c;
    const int32_t origin = cut->cells[c];
    const double volume = volume_of(cut->points, v);
    const double *p = cut->points, *o = mesh->points;
    const int32_t* w = mesh->vertices + 4 * (int64_t)origin;
    assert_true(origin >= 0 && origin < mesh->cell_count);
    assert_int_equal(stratus_orientation(p + 3 * (int64_t)v[0], p + 3 * (int64_t)v[1], p + 3 * (int64_t)v[2], p + 3 * (int64_t)v[3]),
      stratus_orientation(o + 3 * (int64_t)w[0], o + 3 * (int64_t)w[1], o + 3 * (int64_t)w[2], o + 3 * (int64_t)w[3]));
    sums[2 * origin] += volume;
    sums[2 * origin + 1] += 0.25 * volume * (field[v[0]] + field[v[1]] + field[v[2]] + field[v[3]]);
  }
  for (int64_t c = 0; c < mesh->cell_count; c++) {
    const int32_t* v = mesh->vertices + 4 * c;
    const double volume = volume_of(mesh->points, v), mean = 0.25 * (field[v[0]] + field[v[1]] + field[v[2]] + field[v[3]]);
    assert_true(fabs(sums[2 * c] - volume) <= 1e-12 * fabs(volume));
    assert_true(fabs(sums[2 * c + 1] - volume * mean) <= 1e-12 * fabs(volume) * 101.0);
  }
  free(sums);
  free(field);
}

/* The border is that of the box, nothing is shared by three or folded, and no two points are the same. */
static void assert_box_conforms(stratus_context* context, const stratus_partition_result* cut, const int n[3], double offset)
{
  mesh_case mesh = mesh_of(cut);
  const stratus_mesh view = mesh_case_view(&mesh);
  stratus_adjacency* adjacency = NULL;
  assert_int_equal(stratus_adjacency_create(context, &view, &adjacency), STRATUS_OK);
  assert_int_equal(adjacency->broken_faces + adjacency->folded_faces + adjacency->flat, 0);
  for (int64_t i = 0; i < 4 * mesh.cell_count; i++) {
    if (adjacency->neighbours[i] < 0) {
      int on = 0;
      for (int side = 0; side < 6; side++) {
        int points = 0;
        for (int v = 0; v < 4; v++) {
          const double x = mesh.points[3 * (int64_t)mesh.vertices[4 * (i / 4) + v] + side / 2];
          points += v != i % 4 && fabs(x - offset - (side % 2 ? n[side / 2] : 0)) < 1e-14 * n[side / 2] + 1e-15 * fabs(offset);
        }
        on += points == 3;
      }
      assert_int_equal(on, 1);
    }
  }
  for (int64_t i = mesh.point_count - 1; i >= cut->old_points; i--) {
    for (int64_t j = 0; j < i; j++) {
      assert_memory_not_equal(mesh.points + 3 * i, mesh.points + 3 * j, 3 * sizeof(double));
    }
  }
  stratus_adjacency_destroy(adjacency);
}

static void assert_conforming(stratus_context* context, const stratus_partition_result* cut, const int n[3])
{
  assert_box_conforms(context, cut, n, 0.0);
}

static stratus_partition* make_partition(stratus_context* context, const mesh_case* mesh, const stratus_partition_options* options)
{
  const stratus_mesh view = mesh_case_view(mesh);
  stratus_partition* partition = NULL;
  assert_int_equal(stratus_partition_create(context, &view, options, &partition), STRATUS_OK);
  return partition;
}

static void pieces_meet_and_fill_at_every_depth_and_rule(void** state)
{
  static const int n[3] = { 6, 5, 7 };
  int64_t added = 0, leaves = 0;
  (void)state;
  stratus_context* context = make_context(2);
  for (int repeat = 0; repeat < 16; repeat++) {
    mesh_case mesh = mesh_grid(n, repeat % 4 == 3 ? 0.0 : 0.19, (uint32_t)repeat);
    stratus_partition_options options = stratus_partition_options_default();
    stratus_partition_result cut;
    mesh_shuffle(&mesh, (uint32_t)repeat);
    options.rule = repeat % 2 ? STRATUS_PARTITION_PAPER : STRATUS_PARTITION_MEDIAN;
    options.depth = 1 + repeat % 5;
    options.planes = 1 + 7 * (repeat % 3);
    options.leaf_cells = 30;
    stratus_partition* partition = make_partition(context, &mesh, &options);
    stratus_partition_get(partition, &cut);
    assert_true(cut.leaves.leaf_count > 1 && cut.leaves.leaf_count <= 1 << options.depth);
    assert_int_equal(cut.tiny_pieces, 0);
    assert_pieces_fill_their_cells(&mesh, &cut);
    assert_conforming(context, &cut, n);
    added += cut.cell_count - mesh.cell_count;
    leaves += cut.leaves.leaf_count;
    stratus_partition_destroy(partition);
    mesh_case_free(&mesh);
  }
  assert_true(added > 1000 && leaves > 100);
  stratus_context_destroy(context);
}

/* Quadratic hexahedra as they are divided: cubes of 20 points and one in the middle, corners of faces cut off. What is not a corner is moved by
 * up to 4 roundings, as by whoever computed it. `offset` moves all. */
static mesh_case quadratic_cubes(const int n[3], double offset, uint32_t seed)
{
  const int step[3] = { 1, 2 * n[0] + 1, (2 * n[0] + 1) * (2 * n[1] + 1) };
  mesh_case mesh = mesh_case_allocate((int64_t)step[2] * (2 * n[2] + 1), 36 * (int64_t)n[0] * n[1] * n[2]);
  int64_t cell = 0;
  for (int64_t i = 0; i < mesh.point_count; i++) {
    const int64_t at[3] = { i % step[1], i / step[1] % (2 * n[1] + 1), i / step[2] };
    for (int a = 0; a < 3; a++) {
      const double x = offset + 0.5 * (double)at[a];
      const bool corner = at[0] % 2 + at[1] % 2 + at[2] % 2 == 0;
      mesh.points[3 * i + a] = corner ? x : x + fabs(x) * 0x1p-52 * (double)((int)(mesh_random(&seed) % 9) - 4);
    }
  }
  for (int cube = 0; cube < n[0] * n[1] * n[2]; cube++) {
    const int at[3] = { cube % n[0], cube / n[0] % n[1], cube / n[0] / n[1] };
    const int middle = (2 * at[0] + 1) * step[0] + (2 * at[1] + 1) * step[1] + (2 * at[2] + 1) * step[2];
    for (int side = 0; side < 6; side++) {
      const int u = step[(side / 2 + 1) % 3], v = step[(side / 2 + 2) % 3];
      const int face = middle + (side % 2 ? step[side / 2] : -step[side / 2]);
      const int round[8] = { face - u - v, face - v, face + u - v, face + u, face + u + v, face + v, face - u + v, face - u };
      const int triangles[6][3] = { { 7, 0, 1 }, { 1, 2, 3 }, { 3, 4, 5 }, { 5, 6, 7 }, { 1, 3, 7 }, { 3, 5, 7 } };
      for (int t = 0; t < 6; t++, cell++) { /* both cubes at a face start round it from the same corner */
        mesh.vertices[4 * cell] = middle;
        for (int i = 0; i < 3; i++) {
          mesh.vertices[4 * cell + 1 + i] = round[triangles[t][side % 2 ? i : 2 - i]];
        }
      }
    }
  }
  return mesh;
}

/* Planes through points that are there but for rounding cut nothing off that is as thin. */
static void what_is_within_rounding_of_a_plane_lies_on_it(void** state)
{
  static const int n[3] = { 4, 4, 4 };
  static const double offsets[] = { 0.0, -2.0, 6e6 };
  int whole = 0, cut_too = 0;
  (void)state;
  stratus_context* context = make_context(1);
  for (int repeat = 0; repeat < 24; repeat++) {
    const double offset = offsets[repeat / 8];
    mesh_case mesh = quadratic_cubes(n, offset, (uint32_t)repeat + 1);
    stratus_partition_options options = stratus_partition_options_default();
    stratus_partition_result cut;
    options.rule = repeat % 2 ? STRATUS_PARTITION_PAPER : STRATUS_PARTITION_MEDIAN;
    options.planes = repeat % 4 == 1 ? 7 : 18; /* on the cubes' and their middles' planes, or beside */
    options.depth = 1 + repeat / 2 % 4;
    options.leaf_cells = 30;
    stratus_partition* partition = make_partition(context, &mesh, &options);
    stratus_partition_get(partition, &cut);
    assert_true(cut.leaves.leaf_count > 1);
    assert_int_equal(cut.tiny_pieces, 0);
    if (fabs(offset) < 10.0) { /* at 6e6 a point on a cut edge is off by 1e-10 of a cell, however it is rounded */
      assert_pieces_fill_their_cells(&mesh, &cut);
    }
    assert_box_conforms(context, &cut, n, offset);
    whole += cut.cut_cells == 0;
    cut_too += cut.cut_cells > 0;

    mesh_case pieces = mesh_of(&cut);
    const stratus_mesh view = mesh_case_view(&pieces);
    stratus_visibility_order* order = NULL;
    assert_int_equal(stratus_visibility_order_create(context, &view, &cut.leaves, &order), STRATUS_OK);
    stratus_visibility_order_destroy(order);
    stratus_partition_destroy(partition);
    mesh_case_free(&mesh);
  }
  assert_true(whole > 0 && cut_too > 0);
  stratus_context_destroy(context);
}

/* Grid planes that are there to be found. */
static void a_grid_is_cut_between_its_cells(void** state)
{
  static const int n[3] = { 16, 9, 11 };
  (void)state;
  stratus_context* context = make_context(1);
  mesh_case mesh = mesh_grid(n, 0.0, 1);
  for (int64_t i = 0; i < mesh.point_count; i++) { /* bent, so that planes are left across x alone */
    double* p = mesh.points + 3 * i;
    p[1] += 0.3 * sin(p[0] + 0.7 * p[2]);
    p[2] += 0.3 * sin(1.3 * p[0] + p[1]);
  }
  stratus_partition* partition = make_partition(context, &mesh, NULL);
  stratus_partition_result cut;
  stratus_partition_get(partition, &cut);
  assert_int_equal(cut.cell_count, mesh.cell_count);
  assert_int_equal(cut.point_count, mesh.point_count);
  assert_int_equal(cut.cut_cells, 0);
  assert_int_equal(cut.leaves.leaf_count, 8);
  assert_true(cut.largest_leaf <= mesh.cell_count / 4);
  stratus_partition_destroy(partition);
  mesh_case_free(&mesh);
  stratus_context_destroy(context);
}

/* All planes of the paper's rule, each cut by counting pieces cell by cell. */
static void the_paper_s_plane_is_the_best_of_all_that_are_admissible(void** state)
{
  static const int n[3] = { 5, 4, 6 };
  static const int all[4][4] = { { 1, 1, 1, 1 }, { 1, 2, 3, 4 }, { 1, 3, 6, 1 }, { 1, 4, 1, 1 } }; /* pieces by vertices below and above */
  static const int share[4][4] = { { 0, 0, 0, 0 }, { 0, 1, 1, 1 }, { 0, 2, 3, 0 }, { 0, 3, 0, 0 } };
  int none = 0, found = 0;
  (void)state;
  stratus_context* context = make_context(1);
  for (int repeat = 0; repeat < 12; repeat++) {
    mesh_case mesh = mesh_grid(n, 0.19, (uint32_t)repeat);
    stratus_partition_options options = stratus_partition_options_default();
    options.rule = STRATUS_PARTITION_PAPER;
    options.depth = 1;
    options.planes = 10 + repeat;
    options.growth = 0.1 + 0.05 * repeat;
    options.imbalance = 0.2 + 0.1 * (repeat % 5);
    options.leaf_cells = 1;
    double least = INFINITY;
    for (int i = 0; i < 3 * options.planes; i++) {
      const int axis = i / options.planes;
      const double part = (i % options.planes + 1) / (options.planes + 1.0), x = 0.0 * (1.0 - part) + n[axis] * part;
      int64_t below = 0, above = 0, cells = 0;
      for (int64_t c = 0; c < mesh.cell_count; c++) {
        int l = 0, h = 0;
        for (int v = 0; v < 4; v++) {
          const double y = mesh.points[3 * (int64_t)mesh.vertices[4 * c + v] + axis];
          l += y < x;
          h += y > x;
        }
        cells += l == 4 || h == 4 ? 1 : all[l][h];
        below += h == 0 ? 1 : l == 0 ? 0 : share[l][h];
        above += h == 0 ? 0 : l == 0 ? 1 : share[h][l];
      }
      assert_int_equal(below + above, cells);
      const double growth = (double)(cells - mesh.cell_count) / (double)mesh.cell_count;
      if (growth <= options.growth && fabs((double)(below - above)) / (0.5 * (double)cells) < options.imbalance && growth < least) {
        least = growth;
      }
    }
    stratus_partition* partition = make_partition(context, &mesh, &options);
    stratus_partition_result cut;
    stratus_partition_get(partition, &cut);
    if (isinf(least)) {
      assert_int_equal(cut.leaves.leaf_count, 1);
      assert_int_equal(cut.cell_count, mesh.cell_count);
      none++;
    } else {
      assert_int_equal(cut.leaves.leaf_count, 2);
      assert_int_equal(cut.cell_count - mesh.cell_count, (int64_t)(least * (double)mesh.cell_count + 0.5));
      found++;
    }
    stratus_partition_destroy(partition);
    mesh_case_free(&mesh);
  }
  assert_true(none > 0 && found > 0);
  stratus_context_destroy(context);
}

static void a_mesh_that_stands_askew_is_turned_before_it_is_cut(void** state)
{
  static const int n[3] = { 8, 8, 8 };
  (void)state;
  stratus_context* context = make_context(1);
  mesh_case mesh = mesh_grid(n, 0.0, 1);
  for (int64_t i = 0; i < mesh.point_count; i++) { /* no plane across x, y or z passes between cells */
    double* p = mesh.points + 3 * i;
    const double x = p[0], y = p[1], z = p[2];
    p[0] = 0.8 * x + 0.6 * y;
    p[1] = -0.6 * x + 0.8 * y + 0.1 * z;
    p[2] = z + 0.4 * x;
  }
  stratus_partition_options options = stratus_partition_options_default();
  stratus_partition_result cut;
  options.rule = STRATUS_PARTITION_PAPER;
  options.depth = 2;
  options.leaf_cells = 1;
  stratus_partition* partition = make_partition(context, &mesh, &options);
  stratus_partition_get(partition, &cut);
  assert_int_equal(cut.rotations, 0);
  stratus_partition_destroy(partition);
  options.depth = 1;
  partition = make_partition(context, &mesh, &options);
  stratus_partition_get(partition, &cut);
  options.growth = 0.999 * (double)(cut.cell_count - mesh.cell_count) / (double)mesh.cell_count; /* what no plane across an axis meets */
  stratus_partition_destroy(partition);
  partition = make_partition(context, &mesh, &options);
  stratus_partition_get(partition, &cut);
  assert_int_equal(cut.leaves.leaf_count, 1);
  stratus_partition_destroy(partition);
  options.rotations = 64;
  partition = make_partition(context, &mesh, &options);
  stratus_partition_get(partition, &cut);
  assert_int_equal(cut.leaves.leaf_count, 2);
  assert_true(cut.rotations > 0);
  assert_pieces_fill_their_cells(&mesh, &cut);

  mesh_case pieces = mesh_of(&cut);
  const stratus_mesh view = mesh_case_view(&pieces);
  stratus_visibility_order* order = NULL;
  stratus_visibility_result result;
  assert_int_equal(stratus_visibility_order_create(context, &view, &cut.leaves, &order), STRATUS_OK);
  for (int i = 0; i < 8; i++) {
    const stratus_camera camera = { .eye = { i % 2 ? 30 : -20, i / 2 % 2 ? 25 : -30, i / 4 ? 40 : -10 }, .forward = { 1, 0, 0 } };
    int64_t pairs = 0;
    assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_OK);
    assert_int_equal(mesh_wrong_pairs(&pieces, &camera, result.cells, 100, (uint32_t)i, &pairs), 0);
  }
  stratus_visibility_order_destroy(order);
  stratus_partition_destroy(partition);
  mesh_case_free(&mesh);
  stratus_context_destroy(context);
}

/* Leaves in order, and each in itself: also where cells come leaf by leaf no more. */
static void orders_by_leaves_are_right_from_everywhere(void** state)
{
  static const int n[3] = { 5, 5, 5 };
  static const double eyes[][3] = { { 20, 1, 2 }, { -20, 7, 3 }, { 2.5, 2.5, 2.6 }, { 1, 9, 9 }, { 2, 2, -9 } };
  (void)state;
  mesh_case mesh = mesh_grid(n, 0.19, 4);
  stratus_partition_options options = stratus_partition_options_default();
  options.leaf_cells = 20;
  uint32_t* first = NULL;
  for (int threads = 1; threads <= 3; threads++) {
    stratus_context* context = make_context(threads);
    stratus_partition* partition = make_partition(context, &mesh, &options);
    stratus_partition_result cut;
    stratus_partition_get(partition, &cut);
    assert_int_equal(cut.leaves.leaf_count, 8);
    mesh_case pieces = mesh_of(&cut);
    const stratus_mesh view = mesh_case_view(&pieces);
    for (size_t i = 0; i < 2 * sizeof eyes / sizeof *eyes; i++) {
      stratus_visibility_order* order = NULL;
      stratus_visibility_result result;
      stratus_camera camera = { .parallel = i % 2 };
      int64_t pairs = 0;
      for (int a = 0; a < 3; a++) {
        camera.eye[a] = eyes[i / 2][a];
        camera.forward[a] = 2.5 - camera.eye[a];
      }
      assert_int_equal(stratus_visibility_order_create(context, &view, &cut.leaves, &order), STRATUS_OK);
      assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_OK);
      assert_int_equal(result.forced, 0);
      assert_true(result.cycles < 10); /* cutting makes a few of its own, and they are broken where hardly anything is seen of it */
      assert_int_equal(mesh_wrong_pairs(&pieces, &camera, result.cells, 150, (uint32_t)i, &pairs), 0);
      assert_true(pairs > 300);
      if (i == 0) {
        const size_t bytes = (size_t)cut.cell_count * sizeof *first;
        first = first ? first : memcpy(malloc(bytes), result.cells, bytes);
        assert_memory_equal(first, result.cells, bytes);
      }
      stratus_visibility_order_destroy(order);
    }
    stratus_partition_destroy(partition);
    stratus_context_destroy(context);
  }
  free(first);
  mesh_case_free(&mesh);
}

static void nothing_is_cut_where_nothing_is_to_cut(void** state)
{
  static const double points[12] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  static const int32_t vertices[8] = { 0, 1, 2, 3, 2, 2, 2, 2 };
  (void)state;
  stratus_context* context = make_context(1);
  for (int cells = 0; cells <= 2; cells++) {
    stratus_mesh mesh = stratus_mesh_default();
    stratus_partition* partition = NULL;
    stratus_partition_result cut;
    stratus_partition_options options = stratus_partition_options_default();
    mesh.points = points;
    mesh.vertices = vertices;
    mesh.point_count = 4;
    mesh.cell_count = cells;
    options.leaf_cells = 1;
    assert_int_equal(stratus_partition_create(context, &mesh, &options, &partition), STRATUS_OK);
    stratus_partition_get(partition, &cut);
    assert_true(cut.cell_count >= cells && cut.leaves.leaf_count >= 1);
    stratus_partition_destroy(partition);
  }
  stratus_context_destroy(context);
}

/* How far it is from one cell's first point to the next one's, in the mean. */
static double mean_step(const double* points, const int32_t* vertices, int64_t cells)
{
  double sum = 0.0;
  for (int64_t i = 0; i + 1 < cells; i++) {
    const double *p = points + 3 * (int64_t)vertices[4 * i], *q = p + 3 * ((int64_t)vertices[4 * i + 4] - vertices[4 * i]);
    sum += fabs(p[0] - q[0]) + fabs(p[1] - q[1]) + fabs(p[2] - q[2]);
  }
  return sum / (double)cells;
}

/* Scattered cells come near one another, each once; others stay as they come. */
static void scattered_cells_are_listed_where_they_are(void** state)
{
  static const int n[3] = { 20, 20, 20 };
  (void)state;
  stratus_context* context = make_context(2);
  stratus_partition_options options = stratus_partition_options_default();
  for (int depth = 0; depth < 2; depth++) {
    for (int scattered = 0; scattered < 2; scattered++) {
      mesh_case mesh = mesh_grid(n, 0.1, 1);
      if (scattered) {
        mesh_shuffle(&mesh, 3);
      }
      options.depth = depth;
      stratus_partition* partition = make_partition(context, &mesh, &options);
      stratus_partition_result cut;
      stratus_partition_get(partition, &cut);
      assert_pieces_fill_their_cells(&mesh, &cut);
      assert_true(mean_step(cut.points, cut.vertices, cut.cell_count) < 4.0);
      if (scattered) {
        assert_true(mean_step(mesh.points, mesh.vertices, mesh.cell_count) > 15.0);
      }
      for (int64_t i = 1; i < cut.cell_count && !scattered; i++) {
        assert_true(cut.leaves.leaf[i] != cut.leaves.leaf[i - 1] || cut.cells[i] >= cut.cells[i - 1] || cut.cut_cells > 0);
      }
      stratus_partition_destroy(partition);
      mesh_case_free(&mesh);
    }
  }
  stratus_context_destroy(context);
}

static void options_out_of_range_are_refused_with_their_values(void** state)
{
  static const char* says[] = { "rule 2", "depth 17", "depth -1", "planes 0", "planes 4097", "growth 0", "growth nan", "imbalance -1",
    "rotations 65", "leaf_cells 0" };
  static const int n[3] = { 1, 1, 1 };
  (void)state;
  stratus_context* context = make_context(1);
  mesh_case mesh = mesh_grid(n, 0.0, 1);
  const stratus_mesh view = mesh_case_view(&mesh);
  for (int wrong = 0; wrong < 10; wrong++) {
    stratus_partition_options options = stratus_partition_options_default();
    stratus_partition* partition = NULL;
    options.rule = wrong == 0 ? (stratus_partition_rule)2 : STRATUS_PARTITION_MEDIAN;
    options.depth = wrong == 1 ? 17 : wrong == 2 ? -1 : 3;
    options.planes = wrong == 3 ? 0 : wrong == 4 ? 4097 : 8;
    options.growth = wrong == 5 ? 0.0 : wrong == 6 ? NAN : 1.0;
    options.imbalance = wrong == 7 ? -1.0 : 0.5;
    options.rotations = wrong == 8 ? 65 : 0;
    options.leaf_cells = wrong == 9 ? 0 : 1;
    assert_int_equal(stratus_partition_create(context, &view, &options, &partition), STRATUS_INVALID_ARGUMENT);
    assert_null(partition);
    assert_non_null(strstr(stratus_context_message(context), says[wrong]));
  }
  mesh_case_free(&mesh);
  stratus_context_destroy(context);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(pieces_meet_and_fill_at_every_depth_and_rule),
    cmocka_unit_test(what_is_within_rounding_of_a_plane_lies_on_it),
    cmocka_unit_test(a_grid_is_cut_between_its_cells),
    cmocka_unit_test(the_paper_s_plane_is_the_best_of_all_that_are_admissible),
    cmocka_unit_test(a_mesh_that_stands_askew_is_turned_before_it_is_cut),
    cmocka_unit_test(orders_by_leaves_are_right_from_everywhere),
    cmocka_unit_test(nothing_is_cut_where_nothing_is_to_cut),
    cmocka_unit_test(scattered_cells_are_listed_where_they_are),
    cmocka_unit_test(options_out_of_range_are_refused_with_their_values),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
