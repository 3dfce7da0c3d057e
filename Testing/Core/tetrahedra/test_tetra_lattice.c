/* SPDX-License-Identifier: BSD-3-Clause
 * Lattices of hexahedra against the double-precision reference of their tetrahedra, listed here anew: bent, mirrored, with poles, hollows,
 * fill values and layers that cross; their memory; and steps of values. */
#include "tetra_case.h"

#include "faulty_allocator.h"
#include "tetra_caster.h"

static const int32_t sizes[3] = { 4, 3, 5 }; /* hexahedra */
#define HEXAHEDRA (4 * 3 * 5)
#define POINTS (5 * 4 * 6)

/* A lattice, and the same cells in a list, for the reference. */
typedef struct lattice_case {
  tetra_case listed;
  stratus_mesh lattice;
  double points[3 * POINTS];
  float float_points[3 * POINTS], values[POINTS];
  uint8_t hidden[HEXAHEDRA];
} lattice_case;

static lattice_case c;
static tetra_picture ours, theirs;
static double reference[4 * TETRA_PIXELS_MOST];

static int point_at(int i, int j, int k)
{
  return (k * (sizes[1] + 1) + j) * (sizes[0] + 1) + i;
}

/* Lists the tetrahedra: from a hexahedron's first corner over two others to its last, along edges. */
static void list_cells(void)
{
  static const int ways[6][2] = { { 1, 3 }, { 1, 5 }, { 2, 3 }, { 2, 6 }, { 4, 5 }, { 4, 6 } };
  tetra_case* l = &c.listed;
  for (int cell = 0; cell < HEXAHEDRA; ++cell) {
    const int i = cell % sizes[0], j = cell / sizes[0] % sizes[1], k = cell / sizes[0] / sizes[1];
    int32_t corner[8];
    bool shows = !(c.lattice.hidden && c.hidden[cell]);
    for (int n = 0; n < 8; ++n) {
      corner[n] = point_at(i + (n & 1), j + (n >> 1 & 1), k + (n >> 2));
      for (int a = 0; a < 3; ++a) {
        shows = shows && isfinite(c.points[3 * corner[n] + a]);
      }
      shows = shows && (c.lattice.cell_values || isfinite(c.values[corner[n]]));
    }
    for (int t = 0; t < 6; ++t) {
      const int32_t v[4] = { corner[0], corner[ways[t][0]], corner[ways[t][1]], corner[7] };
      memcpy(l->vertices + 4 * (6 * cell + t), v, sizeof v);
      l->hidden[6 * cell + t] = shows ? 0 : 1;
    }
  }
  for (int i = 0; i < 3 * POINTS; ++i) {
    l->points[i] = isfinite(c.points[i]) ? c.points[i] : 0.0;
  }
  for (int i = 0; i < (c.lattice.cell_values ? 6 * HEXAHEDRA : POINTS); ++i) {
    l->values[i] = c.values[c.lattice.cell_values ? i / 6 : i];
  }
  l->mesh.cell_values = c.lattice.cell_values;
}

static void start_case(int cell_values)
{
  tetra_method = STRATUS_TETRA_METHOD_MARCH;
  memset(&c, 0, sizeof c);
  tetra_create(&c.listed, 6, 0.0, 0.0, 1); /* room for all that follows, and a transfer function */
  c.lattice = stratus_mesh_default();
  for (int a = 0; a < 3; ++a) {
    c.lattice.lattice[a] = sizes[a] + 1;
  }
  for (int p = 0; p < POINTS; ++p) {
    const double i = p % 5, j = p / 5 % 4, k = p / 20;
    c.points[3 * p] = i + 0.3 * sin(1.1 * j + 0.7 * k);
    c.points[3 * p + 1] = 1.4 * j + 0.25 * cos(1.3 * i + k);
    c.points[3 * p + 2] = 0.7 * k + 0.3 * sin(1.7 * i) * cos(1.2 * j);
    c.values[p] = (float)(0.5 + 0.25 * sin(1.9 * i + 0.7 * j) + 0.25 * cos(1.3 * k - 0.9 * j));
  }
  c.lattice.points = c.points;
  c.lattice.point_count = POINTS;
  c.lattice.cell_count = HEXAHEDRA;
  c.lattice.values = c.values;
  c.lattice.cell_values = cell_values;
  tetra_case* l = &c.listed;
  l->mesh.point_count = POINTS;
  l->mesh.cell_count = 6 * HEXAHEDRA;
  l->mesh.hidden = l->hidden;
  list_cells();
}

static void end_case(void)
{
  tetra_destroy(&c.listed);
}

static void draw_lattice(stratus_context* context, stratus_tetra_method method, tetra_picture* picture)
{
  tetra_case drawn = c.listed;
  drawn.mesh = c.lattice;
  memcpy(drawn.mesh.matrix, c.listed.mesh.matrix, sizeof drawn.mesh.matrix);
  drawn.options.method = tetra_method = method;
  tetra_draw(context, &drawn, picture);
  tetra_method = STRATUS_TETRA_METHOD_MARCH;
}

/* Draws from several sides, by both methods, against the reference. */
static void is_right(stratus_context* context, bool marches_listed, const char* what)
{
  list_cells();
  for (int view = 0; view < 4; ++view) {
    double largest;
    tetra_camera(context, &c.listed, 4, view, view == 3);
    tetra_reference(&c.listed, reference, NULL);
    for (int method = STRATUS_TETRA_METHOD_MARCH; method <= STRATUS_TETRA_METHOD_PROJECT; ++method) {
      draw_lattice(context, (stratus_tetra_method)method, &ours);
      const double error = tetra_error(ours.rgba, reference, &largest);
      if (!(error < 0.15)) {
        print_error("%s, view %d, method %d: %.3f of 255, at most %.3f\n", what, view, method, error, largest);
      }
      assert_true(error < 0.15); /* the tolerance of .001 is .25 of 255 */
      assert_int_equal(ours.report.cells, 6 * HEXAHEDRA);
      assert_int_equal(ours.report.stuck, 0);
    }
    tetra_draw(context, &c.listed, &theirs);
    if (!marches_listed) { /* the same faces at the same depths; cells are entered by the same points in another order */
      draw_lattice(context, STRATUS_TETRA_METHOD_MARCH, &ours);
      assert_int_equal(ours.report.entries, theirs.report.entries);
      assert_int_equal(ours.report.segments, theirs.report.segments);
      assert_int_equal(ours.report.shown_cells, theirs.report.shown_cells);
      assert_int_equal(ours.report.border_faces, theirs.report.border_faces);
    }
  }
}

static void bent_lattices(void** state)
{
  for (int cell_values = 0; cell_values < 2; ++cell_values) {
    start_case(cell_values);
    is_right(*state, false, cell_values ? "cells" : "points");
    for (int i = 0; i < 3 * POINTS; ++i) {
      c.float_points[i] = (float)c.points[i];
      c.points[i] = (double)c.float_points[i];
    }
    c.lattice.points = NULL;
    c.lattice.float_points = c.float_points;
    is_right(*state, false, "points of floats");
    for (int p = 0; p < POINTS; ++p) {
      c.points[3 * p] = 4.0 - c.points[3 * p];
    }
    c.lattice.points = c.points;
    c.lattice.float_points = NULL;
    is_right(*state, false, "mirrored");
    end_case();
  }
}

/* Hidden cells, values that are not finite, and coordinates that are not: whole hexahedra are hollows. */
static void dry_cells(void** state)
{
  for (int cell_values = 0; cell_values < 2; ++cell_values) {
    start_case(cell_values);
    c.lattice.hidden = c.hidden;
    for (int cell = 0; cell < HEXAHEDRA; cell += 7) {
      c.hidden[cell] = 1;
    }
    is_right(*state, false, "hidden cells");
    c.values[point_at(2, 1, 2)] = NAN;
    is_right(*state, false, "a value that is not finite");
    c.points[3 * point_at(4, 3, 5)] = NAN;
    c.points[3 * point_at(0, 0, 5) + 2] = INFINITY;
    is_right(*state, false, "fill values in coordinates");
    assert_true(ours.report.blanked > 0);
    end_case();
  }
}

/* Layers that follow a ground steeper than they are thick: no tetrahedron turns the other way. */
static void thin_layers_over_rough_ground(void** state)
{
  start_case(0);
  uint32_t s = 5;
  for (int p = 0; p < POINTS / 6; ++p) {
    const double ground = tetra_uniform(&s, 0.0, 2.5);
    for (int k = 0; k < 6; ++k) {
      c.points[3 * (20 * k + p)] = p % 5;
      c.points[3 * (20 * k + p) + 1] = p / 5;
      c.points[3 * (20 * k + p) + 2] = ground + 0.05 * k;
    }
  }
  is_right(*state, false, "thin layers");
  assert_int_equal(ours.report.inverted, 0);
  end_case();
}

/* A pole, where a row of points coincides, layers without thickness, and a column of which nothing is left. */
static void collapsed_cells(void** state)
{
  start_case(0);
  for (int k = 0; k < 6; ++k) {
    for (int j = 0; j < 4; ++j) {
      memcpy(c.points + 3 * point_at(0, j, k), c.points + 3 * point_at(0, 0, k), 3 * sizeof(double));
      memcpy(c.points + 3 * point_at(3, j, 3), c.points + 3 * point_at(3, j, 2), 3 * sizeof(double));
    }
    memcpy(c.points + 3 * point_at(4, 3, k), c.points + 3 * point_at(4, 3, 0), 3 * sizeof(double));
  }
  list_cells();
  for (int view = 0; view < 4; ++view) {
    double largest;
    tetra_camera(*state, &c.listed, 4, view, 0);
    tetra_reference(&c.listed, reference, NULL);
    for (int method = STRATUS_TETRA_METHOD_MARCH; method <= STRATUS_TETRA_METHOD_PROJECT; ++method) {
      draw_lattice(*state, (stratus_tetra_method)method, &ours);
      assert_true(tetra_error(ours.rgba, reference, &largest) < 0.15);
      assert_true(ours.report.flat > 0);
      assert_int_equal(ours.report.stuck, 0);
    }
  }
  end_case();
}

/* Whether rays take the same ways through a lattice and through its listed cells: the same numbers of segments, the same largest values
 * and sums. Where cells overlap, ways overlap, and are composited one after the other. Which of two that begin at one face comes first
 * depends on how faces are numbered, so that composited pictures agree only as far as matter is thin. */
static void takes_the_same_ways(stratus_context* context, const tetra_case* cells, const tetra_case* lattice, const char* what)
{
  static const stratus_tetra_mode modes[] = { STRATUS_TETRA_MAXIMUM, STRATUS_TETRA_ADDITIVE, STRATUS_TETRA_COMPOSITE };
  tetra_method = STRATUS_TETRA_METHOD_MARCH;
  for (int m = 0; m < 3; ++m) {
    tetra_case one = *cells, other = *lattice;
    double largest, listed[4 * TETRA_PIXELS_MOST];
    int differ = 0;
    one.options.mode = other.options.mode = modes[m];
    one.options.method = other.options.method = STRATUS_TETRA_METHOD_MARCH;
    one.transfer.unit_distance = other.transfer.unit_distance = m == 2 ? 500.0 : 1.0;
    tetra_draw(context, &one, &theirs);
    tetra_draw(context, &other, &ours);
    for (int n = 0; n < 4 * TETRA_PIXELS; ++n) {
      listed[n] = (double)theirs.rgba[n];
      differ += n < TETRA_PIXELS && ours.samples[n] != theirs.samples[n];
    }
    const double error = tetra_error(ours.rgba, listed, &largest);
    if (differ > 0 || !(error < 0.01)) {
      print_error("%s, %s: %.5f of 255, %d pixels with other segments\n", what, stratus_tetra_mode_name(modes[m]), error, differ);
    }
    assert_int_equal(differ, 0);
    assert_true(error < 0.01);
  }
}

static void lattice_takes_the_same_ways(stratus_context* context, const char* what)
{
  tetra_case lattice = c.listed;
  lattice.mesh = c.lattice;
  memcpy(lattice.mesh.matrix, c.listed.mesh.matrix, sizeof lattice.mesh.matrix);
  takes_the_same_ways(context, &c.listed, &lattice, what);
  assert_true(ours.report.inverted > 0 && ours.report.inverted < 6 * HEXAHEDRA);
  assert_int_equal(ours.report.folded_faces, theirs.report.folded_faces);
}

/* A layer that lies partly below the one beneath: its cells overlap, and both count, as in a list. */
static void layers_that_cross(void** state)
{
  start_case(0);
  c.points[3 * point_at(2, 1, 3) + 2] -= 1.6;
  list_cells();
  tetra_camera(*state, &c.listed, 4, 1, 0);
  lattice_takes_the_same_ways(*state, "layers that cross");
  end_case();
}

/* Lattices of which a part has been turned over about a fold, as tripolar ocean grids are beyond their poles; folds that close in the
 * middle of the lattice, and that meet; one point whose cells are the only ones that turn; and flat cells at such cells. */
static void folds_of_any_shape(void** state)
{
  static const char* const shapes[] = { "half turned over", "a closed fold", "all but one point", "two folds", "flat cells" };
  for (int shape = 0; shape < 5; ++shape) {
    for (int cell_values = 0; cell_values < 2; ++cell_values) {
      start_case(cell_values);
      for (int p = 0; p < POINTS; ++p) {
        const int i = p % 5, j = p / 5 % 4, k = p / 20;
        double* x = c.points + 3 * p;
        switch (shape) {
          case 0:
            x[0] = i > 2 ? x[0] - 2.1 * (i - 2) : x[0];
            break;
          case 1:
            x[1] += i == 2 && j == 2 && k > 0 && k < 5 ? -2.3 : 0.0;
            break;
          case 2:
            x[2] = p == point_at(2, 2, 2) ? x[2] : -x[2];
            break;
          case 3:
            x[0] = i > 2 ? x[0] - 1.9 * (i - 2) : x[0];
            x[2] = k > 3 ? x[2] - 1.6 * (k - 3) : x[2];
            break;
          default:
            x[0] = i == 3 ? c.points[3 * (p - 1)] : x[0];
            x[1] += i == 1 && j == 1 ? 1.7 : 0.0;
            break;
        }
      }
      list_cells();
      for (int view = 0; view < 5; ++view) {
        tetra_camera(*state, &c.listed, 4, view, view == 1);
        lattice_takes_the_same_ways(*state, shapes[shape]);
      }
      end_case();
    }
  }
}

/* Steps of a simulation on a lattice: nothing but values is taken, unless other cells show. */
static void steps_take_values_alone(void** state)
{
  for (int mixed = 0; mixed < 2; ++mixed) {
    stratus_tetra_caster* caster = NULL;
    stratus_tetra_report report;
    start_case(0);
    c.points[3 * point_at(2, 1, 3) + 2] -= mixed ? 1.6 : 0.0;
    tetra_camera(*state, &c.listed, 4, 0, 0);
    const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = ours.rgba };
    assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
    for (int step = 0; step < 5; ++step) {
      c.values[1] = 0.4f + 0.01f * (float)step;
      c.values[50] = step == 3 ? NAN : 0.5f;
      ++c.lattice.revision;
      assert_int_equal(
        stratus_tetra_caster_render(caster, &c.lattice, &c.listed.transfer, &c.listed.camera, &c.listed.options, &image, &report),
        STRATUS_OK);
      static const uint64_t builds[5] = { 1, 1, 1, 2, 3 };
      assert_int_equal(report.mesh_builds, builds[step]);
      assert_int_equal(report.value_builds, step + 1);
      draw_lattice(*state, STRATUS_TETRA_METHOD_MARCH, &theirs);
      assert_memory_equal(ours.rgba, theirs.rgba, sizeof ours.rgba);
    }
    assert_null(caster->list);
    stratus_tetra_caster_destroy(caster);
    end_case();
  }
}

/* The caster's memory for a large lattice: less than 40 bytes a hexahedron, where the list of its tetrahedra takes some 350. */
static void memory_of_a_cell(void** state)
{
  enum { SIDE = 49 };
  const int points = SIDE * SIDE * SIDE, cells = (SIDE - 1) * (SIDE - 1) * (SIDE - 1);
  stratus_tetra_caster* caster = NULL;
  stratus_tetra_report report;
  start_case(0);
  float* at = calloc((size_t)points, 4 * sizeof *at);
  assert_non_null(at);
  for (int p = 0; p < points; ++p) {
    at[3 * p] = (float)(p % SIDE) * 0.1f;
    at[3 * p + 1] = (float)(p / SIDE % SIDE) * 0.1f;
    at[3 * p + 2] = (float)(p / SIDE / SIDE) * 0.1f;
    at[3 * points + p] = 0.001f * (float)(p % 997);
  }
  stratus_mesh mesh = stratus_mesh_default();
  mesh.lattice[0] = mesh.lattice[1] = mesh.lattice[2] = SIDE;
  mesh.float_points = at;
  mesh.point_count = points;
  mesh.cell_count = cells;
  mesh.values = at + 3 * points;
  tetra_camera(*state, &c.listed, 4, 0, 0);
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = ours.rgba };
  for (int method = STRATUS_TETRA_METHOD_AUTO; method <= STRATUS_TETRA_METHOD_PROJECT; method += 2) {
    c.listed.options.method = (stratus_tetra_method)method;
    assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
    assert_int_equal(
      stratus_tetra_caster_render(caster, &mesh, &c.listed.transfer, &c.listed.camera, &c.listed.options, &image, &report), STRATUS_OK);
    print_message("%s: %.1f bytes a cell\n", stratus_tetra_method_name(report.method), (double)report.bytes / cells);
    assert_true(method != STRATUS_TETRA_METHOD_AUTO || report.method == STRATUS_TETRA_METHOD_MARCH);
    assert_true(method != STRATUS_TETRA_METHOD_AUTO || report.bytes < 40u * (size_t)cells);
    stratus_tetra_caster_destroy(caster);
  }
  free(at);
  end_case();
}

/* Lattices whose points lie anywhere near their places: the pictures of their listed tetrahedra, by both methods, or where some cells are
 * upside down their ways. */
static void random_lattices(void** state)
{
  int mixed = 0;
  for (uint32_t seed = 0; seed < 24; ++seed) {
    tetra_case listed, lattice;
    double largest, right[4 * TETRA_PIXELS_MOST];
    uint32_t s = seed;
    tetra_method = seed & 1 ? STRATUS_TETRA_METHOD_PROJECT : STRATUS_TETRA_METHOD_MARCH;
    tetra_create(&listed, 4, seed % 3 == 2 ? 0.5 : 0.15, 0.0, seed);
    for (int hole = 0; hole < (int)(seed % 4); ++hole) { /* all cells of a box */
      const int box = (int)tetra_uniform(&s, 0.0, 63.99);
      memset(listed.hidden + 6 * box, 1, 6);
    }
    listed.mesh.hidden = listed.hidden;
    tetra_camera(*state, &listed, 4, (int)(seed % 8), seed % 5 == 4);
    tetra_draw(*state, &listed, &theirs);
    lattice = listed;
    uint8_t hidden[64];
    for (int box = 0; box < 64; ++box) {
      hidden[box] = listed.hidden[6 * box];
    }
    lattice.mesh.hidden = hidden;
    tetra_as_lattice(&lattice, 4);
    tetra_draw(*state, &lattice, &ours);
    for (int i = 0; i < 4 * TETRA_PIXELS; ++i) {
      right[i] = (double)theirs.rgba[i];
    }
    const double error = tetra_error(ours.rgba, right, &largest);
    print_message("seed %u: %.4f of 255, at most %.2f\n", (unsigned)seed, error, largest);
    if (ours.report.inverted > 0 && ours.report.inverted < ours.report.cells) {
      ++mixed;
      takes_the_same_ways(*state, &listed, &lattice, "a random lattice");
    } else {
      assert_true(error < 0.02);
    }
    tetra_destroy(&listed);
  }
  assert_true(mixed > 3);
}

/* Memory that is refused at any call leaves an error, and the caster ready; of lattices that turn one way, and of some that fold. */
static void memory_refused_at_any_call(void** state)
{
  (void)state;
  for (int folds = 0; folds < 2; ++folds) {
    faulty_allocator allocator = { 0 };
    const stratus_context_options options = faulty_options(&allocator, "host");
    stratus_context* context = NULL;
    stratus_tetra_caster* caster = NULL;
    assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
    assert_int_equal(stratus_tetra_caster_create(context, &caster), STRATUS_OK);
    start_case(folds);
    c.points[3 * point_at(2, 1, 3) + 2] -= folds ? 1.6 : 0.0;
    c.points[7] = folds ? NAN : c.points[7];
    tetra_camera(context, &c.listed, 4, 0, 0);
    const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = ours.rgba };
    int refused = 0;
    for (bool reached = true; reached; refused += reached) {
      stratus_tetra_caster_release(caster);
      allocator.fail_at = allocator.calls + refused + 1;
      const stratus_status status =
        stratus_tetra_caster_render(caster, &c.lattice, &c.listed.transfer, &c.listed.camera, &c.listed.options, &image, NULL);
      reached = allocator.calls >= allocator.fail_at;
      allocator.fail_at = 0;
      assert_int_equal(status, reached ? STRATUS_OUT_OF_MEMORY : STRATUS_OK);
    }
    draw_lattice(context, STRATUS_TETRA_METHOD_MARCH, &theirs);
    assert_memory_equal(ours.rgba, theirs.rgba, sizeof ours.rgba);
    assert_true(refused > 8);
    stratus_tetra_caster_destroy(caster);
    end_case();
    stratus_context_destroy(context);
    assert_int_equal(allocator.live, 0);
  }
}

static void wrong_lattices_are_refused(void** state)
{
  start_case(0);
  stratus_tetra_caster* caster = NULL;
  stratus_partition* partition = NULL;
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = ours.rgba };
  assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
  for (int wrong = 0; wrong < 8; ++wrong) {
    stratus_mesh mesh = c.lattice;
    switch (wrong) {
      case 0:
        mesh.lattice[1] = 1;
        break;
      case 1:
        mesh.lattice[2] = -6;
        break;
      case 2:
        mesh.lattice[0] = mesh.lattice[1] = mesh.lattice[2] = INT32_MAX;
        break;
      case 3:
        ++mesh.point_count;
        break;
      case 4:
        --mesh.cell_count;
        break;
      case 5:
        mesh.points = NULL;
        break;
      case 6:
        mesh.float_points = c.float_points;
        break;
      default:
        mesh.vertices = c.listed.vertices;
        break;
    }
    assert_int_equal(stratus_mesh_check(*state, &mesh), STRATUS_INVALID_ARGUMENT);
    assert_int_equal(stratus_tetra_caster_render(caster, &mesh, &c.listed.transfer, &c.listed.camera, &c.listed.options, &image, NULL),
      STRATUS_INVALID_ARGUMENT);
  }
  assert_int_equal(stratus_mesh_check(*state, &c.lattice), STRATUS_OK);
  assert_int_equal(stratus_partition_create(*state, &c.lattice, NULL, &partition), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(*state), "lattice of 5 x 4 x 6"));
  stratus_tetra_caster_destroy(caster);
  end_case();
}

int test_tetra_lattice(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup_teardown(bent_lattices, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(dry_cells, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(thin_layers_over_rough_ground, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(collapsed_cells, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(layers_that_cross, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(folds_of_any_shape, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(steps_take_values_alone, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(memory_of_a_cell, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(random_lattices, tetra_start, tetra_stop),
    cmocka_unit_test(memory_refused_at_any_call),
    cmocka_unit_test_setup_teardown(wrong_lattices_are_refused, tetra_start, tetra_stop),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
