/* SPDX-License-Identifier: BSD-3-Clause
 * Meshes in layers: faces from tables of both kinds, corners that are one node, heights of layers from all that files have of them, and
 * prisms whose tetrahedra fill them once and meet in whole faces. */
#include "structures.h"

#include "faulty_allocator.h"

#include "stratus/layers.h"

#define NONE NAN

static stratus_context* context;

enum { MOST = 64 };

typedef struct face_arrays {
  int64_t offsets[MOST];
  int32_t nodes[4 * MOST];
  uint8_t absent[MOST];
  stratus_faces view;
} face_arrays;

static void set_view(face_arrays* f, int64_t nodes, int64_t faces)
{
  memset(f, 0, sizeof *f);
  f->view = (stratus_faces){ .node_count = nodes, .face_count = faces, .offsets = f->offsets, .nodes = f->nodes, .absent = f->absent };
}

static void check_face(const face_arrays* f, int64_t face, int64_t count, const int32_t* nodes)
{
  assert_int_equal(f->offsets[face + 1] - f->offsets[face], count);
  assert_memory_equal(f->nodes + f->offsets[face], nodes, (size_t)count * sizeof *nodes);
}

static void rows_of_nodes_are_faces(void** state)
{
  (void)state;
  const double numbers[4][4] = { { 1, 2, 3, NONE }, { 2, 5, 4, 3 }, { 3, 4, 4, 3 }, { 4, 5, 5, 1 } };
  const stratus_face_table table = { .numbers = numbers[0], .rows = 4, .columns = 4, .first = 1 };
  face_arrays f;
  set_view(&f, 5, 4);
  assert_int_equal(stratus_faces_from_table(context, &table, &f.view), STRATUS_OK);
  check_face(&f, 0, 3, (const int32_t[]){ 0, 1, 2 });
  check_face(&f, 1, 4, (const int32_t[]){ 1, 4, 3, 2 });
  check_face(&f, 2, 3, (const int32_t[]){ 0, 0, 0 }); /* of two different nodes */
  check_face(&f, 3, 3, (const int32_t[]){ 3, 4, 0 });
  assert_memory_equal(f.absent, ((const uint8_t[]){ 0, 0, 1, 0 }), 4);

  stratus_face_table four = table;
  four.fewest = 4;
  set_view(&f, 5, 4);
  assert_int_equal(stratus_faces_from_table(context, &four, &f.view), STRATUS_OK);
  assert_memory_equal(f.absent, ((const uint8_t[]){ 1, 0, 1, 1 }), 4);
}

static void rows_of_faces_are_nodes(void** state)
{
  (void)state;
  /* two triangles and a corner at the border of the mesh, around four nodes */
  const double numbers[4][3] = { { 1, NONE, NONE }, { 2, 1, 3 }, { 1, 2, 2 }, { 2, 3, NONE } };
  const stratus_face_table table = { .numbers = numbers[0], .rows = 4, .columns = 3, .first = 1, .rows_are_nodes = 1, .fewest = 3 };
  face_arrays f;
  set_view(&f, 4, 3);
  assert_int_equal(stratus_faces_from_table(context, &table, &f.view), STRATUS_OK);
  check_face(&f, 0, 3, (const int32_t[]){ 0, 1, 2 });
  check_face(&f, 1, 3, (const int32_t[]){ 1, 2, 3 });
  check_face(&f, 2, 3, (const int32_t[]){ 0, 0, 0 });
  assert_memory_equal(f.absent, ((const uint8_t[]){ 0, 0, 1 }), 3);
}

static void refuses(const stratus_face_table* table, int64_t nodes, int64_t faces, const char* words)
{
  face_arrays f;
  set_view(&f, nodes, faces);
  assert_int_equal(stratus_faces_from_table(context, table, &f.view), STRATUS_INVALID_ARGUMENT);
  if (!strstr(stratus_context_message(context), words)) {
    fail_msg("\"%s\" must have \"%s\"", stratus_context_message(context), words);
  }
}

static void wrong_tables_are_refused(void** state)
{
  (void)state;
  const double numbers[6] = { 1, 2, 3, 2, 3, 7 }, few[6] = { 1, 2, 3, 2, NONE, NONE }, broken[3] = { 1, 1.5, 3 };
  const stratus_face_table table = { .numbers = numbers, .rows = 2, .columns = 3, .first = 1 };
  refuses(&table, 6, 2, "face 1 has the node 7, must be 1 to 6");
  refuses(&table, 7, 3, "a table of 2 rows, must be 3, one for each face");
  stratus_face_table other = table;
  other.first = 2;
  refuses(&other, 7, 2, "face 0 has the node 1, must be 2 to 8");
  other = table;
  other.numbers = few;
  refuses(&other, 7, 2, "face 1 has 1 nodes, at least 3 are needed");
  other = (stratus_face_table){ .numbers = broken, .rows = 1, .columns = 3 };
  refuses(&other, 7, 1, "face 0 has the node 1.5");
  other = table;
  other.rows_are_nodes = 1;
  refuses(&other, 2, 6, "node 1 has the face 7, must be 1 to 6");
  other = table;
  other.columns = 65;
  refuses(&other, 7, 2, "a table of 65 columns, must be 1 to 64");
  other = table;
  other.fewest = 2;
  refuses(&other, 7, 2, "at least 2 nodes, must be 0 or 3 to 64");
  other = table;
  other.first = INFINITY;
  refuses(&other, 7, 2, "a first number of inf, must be finite");
  refuses(&table, 0, 2, "a mesh of 0 nodes and 2 faces");
}

static void corners_at_one_place_are_one_node(void** state)
{
  (void)state;
  /* at the date line and at a pole longitudes differ; 1e-5 degrees are a metre, 1e-4 are eleven */
  const double degrees[9][2] = { { 180, 10 }, { -180, 10 }, { 0, 90 }, { 77, 90 }, { 20, 30 }, { 20.00001, 30 }, { 20.0001, 30 },
    { 20, 30 }, { 540, 10.00001 } };
  const int32_t wanted[9] = { 0, 0, 1, 1, 2, 2, 3, 2, 0 };
  int32_t numbers[9];
  int64_t first[9], count = 0;
  assert_int_equal(stratus_faces_join_corners(context, 9, degrees[0], numbers, first, &count), STRATUS_OK);
  assert_int_equal(count, 4);
  assert_memory_equal(numbers, wanted, sizeof numbers);
  assert_memory_equal(first, ((const int64_t[]){ 0, 2, 4, 6 }), 4 * sizeof *first);
  const double unknown[2][2] = { { 1, 2 }, { 3, NAN } };
  assert_int_equal(stratus_faces_join_corners(context, 2, unknown[0], numbers, first, &count), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "place 1"));
  assert_int_equal(stratus_faces_join_corners(context, 0, degrees[0], numbers, first, &count), STRATUS_INVALID_ARGUMENT);
}

static void faces_are_turned(void** state)
{
  (void)state;
  face_arrays f;
  const double places[5][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 }, { 0.5, -1 } };
  set_view(&f, 5, 2);
  memcpy(f.nodes, ((const int32_t[]){ 0, 3, 2, 1, 0, 4, 1 }), 7 * sizeof *f.nodes); /* clockwise, counterclockwise */
  f.offsets[1] = 4;
  f.offsets[2] = 7;
  assert_int_equal(stratus_faces_turn(context, &f.view, places[0], 0), STRATUS_OK);
  check_face(&f, 0, 4, (const int32_t[]){ 1, 2, 3, 0 });
  check_face(&f, 1, 3, (const int32_t[]){ 0, 4, 1 });
  /* around the south pole, where longitudes run the other way */
  const double south[3][2] = { { 0, -80 }, { 120, -80 }, { 240, -80 } };
  set_view(&f, 3, 1);
  memcpy(f.nodes, ((const int32_t[]){ 0, 1, 2 }), 3 * sizeof *f.nodes);
  f.offsets[1] = 3;
  assert_int_equal(stratus_faces_turn(context, &f.view, south[0], 1), STRATUS_OK);
  check_face(&f, 0, 3, (const int32_t[]){ 2, 1, 0 });
  f.nodes[1] = 3;
  assert_int_equal(stratus_faces_turn(context, &f.view, south[0], 1), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "face 0 has the node 3, must be 0 to 2"));
  f.offsets[1] = 2;
  assert_int_equal(stratus_faces_turn(context, &f.view, south[0], 1), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "face 0 has 2 nodes, must be 3 to 64"));
}

static void check_numbers(const double* got, const double* wanted, size_t count)
{
  for (size_t i = 0; i < count; ++i) {
    if (!(fabs(got[i] - wanted[i]) < 1e-9) && !(isnan(got[i]) && isnan(wanted[i]))) {
      fail_msg("number %zu is %g, must be %g", i, got[i], wanted[i]);
    }
  }
}

static void borders_are_between_middles(void** state)
{
  (void)state;
  double borders[4];
  assert_int_equal(stratus_layers_between(context, 3, (const double[]){ -10, -4, -1 }, borders), STRATUS_OK);
  check_numbers(borders, (const double[]){ -13, -7, -2.5, 0 }, 4); /* not above the sea */
  assert_int_equal(stratus_layers_between(context, 3, (const double[]){ 1, 4, 10 }, borders), STRATUS_OK);
  check_numbers(borders, (const double[]){ 0, 2.5, 7, 13 }, 4);
  assert_int_equal(stratus_layers_between(context, 1, (const double[]){ 5 }, borders), STRATUS_OK);
  check_numbers(borders, (const double[]){ 4.5, 5.5 }, 2);
  assert_int_equal(stratus_layers_between(context, 2, (const double[]){ 4, 3 }, borders), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "the middle of layer 1 is at 3"));
  assert_int_equal(stratus_layers_between(context, 0, borders, borders), STRATUS_INVALID_ARGUMENT);
}

static void heights_come_from_what_files_have(void** state)
{
  (void)state;
  double z[12];
  uint8_t none[4];
  /* levels between a bottom and a free surface, at four nodes: deep, shallow, dry, unknown */
  const double levels[3] = { -100, -20, 0 }, bottom[4] = { -500, -50, 3, NAN }, surface[4] = { 2, -1, 2, 1 };
  stratus_layer_borders from = { .node_count = 4, .layer_count = 2, .borders = levels, .bottom = bottom, .surface = surface };
  assert_int_equal(stratus_layers_from_borders(context, &from, z, none), STRATUS_OK);
  check_numbers(z, (const double[]){ -100, -50, 3, 1, -20, -20, 3, 1, 2, -1, 3, 1 }, 12);
  assert_memory_equal(none, ((const uint8_t[]){ 0, 0, 1, 1 }), 4);
  from.stretched = 1;
  assert_int_equal(stratus_layers_from_borders(context, &from, z, none), STRATUS_OK);
  check_numbers(z, (const double[]){ -500, -50, 3, 1 }, 4);
  from.bottom = from.surface = NULL;
  assert_int_equal(stratus_layers_from_borders(context, &from, z, none), STRATUS_OK);
  check_numbers(z, (const double[]){ -100, -100, -100, -100, -20, -20, -20, -20, 0, 0, 0, 0 }, 12);
  assert_memory_equal(none, ((const uint8_t[]){ 0, 0, 0, 0 }), 4);
  /* sigma, of each node its own */
  const double sigma[6] = { -1, -1, -0.5, -0.25, 0, 0 };
  from = (stratus_layer_borders){
    .node_count = 2, .layer_count = 2, .borders = sigma, .of_nodes = 1, .sigma = 1, .bottom = bottom, .surface = surface
  };
  assert_int_equal(stratus_layers_from_borders(context, &from, z, none), STRATUS_OK);
  check_numbers(z, (const double[]){ -500, -50, -249, -13.25, 2, -1 }, 6);
  from.bottom = NULL;
  assert_int_equal(stratus_layers_from_borders(context, &from, z, none), STRATUS_INVALID_ARGUMENT);

  /* heights of borders and of middles; what is missing below a node's lowest layer has no thickness */
  const double heights[9] = { 0, NONE, NONE, 5, 4, NONE, 9, 8, NONE };
  assert_int_equal(stratus_layers_from_heights(context, 3, 2, 1, heights, z, none), STRATUS_OK);
  check_numbers(z, (const double[]){ 0, 4, 0, 5, 4, 0, 9, 8, 0 }, 9);
  assert_memory_equal(none, ((const uint8_t[]){ 0, 0, 1 }), 3);
  assert_int_equal(stratus_layers_from_heights(context, 1, 3, 0, (const double[]){ 1, 3, 7 }, z, none), STRATUS_OK);
  check_numbers(z, (const double[]){ 0, 2, 5, 9 }, 4);
  assert_int_equal(stratus_layers_from_heights(context, 1, 1, 0, (const double[]){ 7 }, z, none), STRATUS_OK);
  check_numbers(z, (const double[]){ 6.5, 7.5 }, 2);
  assert_int_equal(stratus_layers_from_heights(context, 1, 2, 1, (const double[]){ 1, 0, 7 }, z, none), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "layers are upside down: 1 is below 0 at node 0"));

  /* thicknesses above a bottom; the second node has one layer, whose other number is junk */
  const double thick[4] = { 10, -1e34, 5, 6 }, floors[2] = { -15, -5 }, present[2] = { 2, 1 };
  assert_int_equal(stratus_layers_from_thicknesses(context, 2, 2, thick, floors, present, z, none), STRATUS_OK);
  check_numbers(z, (const double[]){ -15, -5, -5, -5, 0, 1 }, 6);
  assert_memory_equal(none, ((const uint8_t[]){ 0, 0 }), 2);
  assert_int_equal(
    stratus_layers_from_thicknesses(context, 2, 2, thick, (const double[]){ NAN, -5 }, (const double[]){ 2, 0 }, z, none), STRATUS_OK);
  assert_memory_equal(none, ((const uint8_t[]){ 1, 1 }), 2);
  assert_int_equal(stratus_layers_from_thicknesses(context, 0, 2, thick, floors, present, z, none), STRATUS_INVALID_ARGUMENT);
}

static void values_at_borders_are_between_those_of_layers(void** state)
{
  (void)state;
  /* layers of 1 and 3 metres; no layer below; a layer without a value */
  const double z[9] = { 0, 4, 0, 1, 4, 1, 4, 5, 2 }, values[6] = { 10, 77, NONE, 30, 20, 6 };
  double at[9];
  assert_int_equal(stratus_layers_to_borders(context, 3, 2, z, values, at), STRATUS_OK);
  check_numbers(at, (const double[]){ 10, 77, NAN, 15, 20, 6, 30, 20, 6 }, 9);
}

/* The volume of tetrahedra, all of which have one orientation. */
static double volume_of(double (*points)[3], const int32_t* vertices, int64_t count)
{
  double sum = 0.0;
  for (int64_t t = 0; t < count; ++t) {
    double e[3][3];
    for (int n = 0; n < 3; ++n) {
      for (int a = 0; a < 3; ++a) {
        e[n][a] = points[vertices[4 * t + n + 1]][a] - points[vertices[4 * t]][a];
      }
    }
    const double size = (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
                          e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
      6.0;
    assert_true(size > 0.0);
    sum += size;
  }
  return sum;
}

/* Faces of tetrahedra that no other has. */
static int border_faces(const int32_t* vertices, int64_t count)
{
  int found = 0;
  for (int64_t t = 0; t < count; ++t) {
    for (int left = 0; left < 4; ++left) {
      int same = 0;
      for (int64_t other = 0; other < count; ++other) {
        int shared = 0;
        for (int n = 0; n < 16; ++n) {
          shared += n / 4 != left && vertices[4 * t + n / 4] == vertices[4 * other + n % 4];
        }
        same += shared == 3;
      }
      found += same == 1;
    }
  }
  return found;
}

static void prisms_are_filled_once(void** state)
{
  (void)state;
  /* a pentagon and a triangle with a common edge, in two layers; nodes in no order */
  const double at[6][2] = { { 2, 0 }, { 3, 2 }, { 0, 2 }, { 0, 0 }, { 1, 3 }, { 3, 0 } };
  const int32_t nodes[8] = { 3, 0, 1, 4, 2, 0, 5, 1 };
  face_arrays f;
  set_view(&f, 6, 2);
  memcpy(f.nodes, nodes, sizeof nodes);
  f.offsets[1] = 5;
  f.offsets[2] = 8;
  double points[18][3], z[18];
  for (int i = 0; i < 18; ++i) {
    z[i] = i / 6 == 0 ? 0.0 : i / 6 == 1 ? 1.0 : 3.0;
    points[i][0] = at[i % 6][0];
    points[i][1] = at[i % 6][1];
    points[i][2] = z[i];
  }
  uint8_t hidden[4];
  int64_t count = 0;
  int32_t vertices[4 * MOST], prisms[MOST];
  assert_int_equal(stratus_prisms_hide(context, &f.view, 2, z, NULL, hidden), STRATUS_OK);
  assert_memory_equal(hidden, ((const uint8_t[]){ 0, 0, 0, 0 }), 4);
  assert_int_equal(stratus_prisms_divide(context, &f.view, 2, hidden, &count, NULL, NULL), STRATUS_OK);
  assert_int_equal(count, 2 * 3 * (3 + 1));
  assert_int_equal(stratus_prisms_divide(context, &f.view, 2, NULL, &count, vertices, prisms), STRATUS_OK);
  assert_true(fabs(volume_of(points, vertices, count) - 3.0 * 7.5) < 1e-12); /* areas of 6.5 and 1 */
  assert_int_equal(border_faces(vertices, count), 2 * (3 + 1) + 2 * 2 * 6);  /* below and above, and six sides in two layers */
  for (int64_t t = 0; t < count; ++t) {
    assert_int_equal(prisms[t], t < 9 ? 0 : t < 12 ? 1 : t < 21 ? 2 : 3);
  }
  /* without thickness, at a node without layers, absent */
  for (int i = 0; i < 6; ++i) {
    z[6 + i] = i == 5 ? 1.0 : 0.0;
  }
  assert_int_equal(stratus_prisms_hide(context, &f.view, 2, z, NULL, hidden), STRATUS_OK);
  assert_memory_equal(hidden, ((const uint8_t[]){ 1, 0, 0, 0 }), 4);
  assert_int_equal(stratus_prisms_hide(context, &f.view, 2, z, (const uint8_t[]){ 0, 0, 0, 0, 0, 1 }, hidden), STRATUS_OK);
  assert_memory_equal(hidden, ((const uint8_t[]){ 1, 1, 0, 1 }), 4);
  f.absent[0] = 1;
  assert_int_equal(stratus_prisms_hide(context, &f.view, 2, z, NULL, hidden), STRATUS_OK);
  assert_memory_equal(hidden, ((const uint8_t[]){ 1, 0, 1, 0 }), 4);
  assert_int_equal(stratus_prisms_divide(context, &f.view, 2, hidden, &count, vertices, prisms), STRATUS_OK);
  assert_true(count == 6 && prisms[0] == 1 && prisms[5] == 3);
  assert_int_equal(stratus_prisms_divide(context, &f.view, 0, hidden, &count, vertices, prisms), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_prisms_divide(context, &f.view, INT32_MAX, hidden, &count, vertices, prisms), STRATUS_INVALID_ARGUMENT);
}

static void every_allocation_may_fail(void** state)
{
  (void)state;
  const double numbers[3] = { 0, 0, 0 }, degrees[6] = { 0, 0, 1, 0, 0, 1 };
  const stratus_face_table table = { .numbers = numbers, .rows = 3, .columns = 1, .rows_are_nodes = 1, .fewest = 3 };
  for (int n = 1; n <= 5; ++n) { /* one of a table, three of corners, one of heights */
    faulty_allocator allocator = { 0, 0, 0 };
    const stratus_context_options options = faulty_options(&allocator, "host");
    stratus_context* faulty = NULL;
    char message[256];
    assert_int_equal(stratus_context_create(&options, &faulty, message, sizeof message), STRATUS_OK);
    const int64_t live = allocator.live;
    face_arrays f;
    set_view(&f, 3, 1);
    int32_t joined[3];
    int64_t first[3], count;
    double z[2];
    uint8_t none;
    allocator.fail_at = allocator.calls + (n < 2 || n > 4 ? 1 : n - 1);
    const stratus_status status = n == 1 ? stratus_faces_from_table(faulty, &table, &f.view)
      : n < 5                            ? stratus_faces_join_corners(faulty, 3, degrees, joined, first, &count)
                                         : stratus_layers_from_heights(faulty, 1, 1, 1, degrees, z, &none);
    assert_int_equal(status, STRATUS_OUT_OF_MEMORY);
    assert_true(allocator.live == live);
    stratus_context_destroy(faulty);
  }
}

static int make(void** state)
{
  (void)state;
  context = make_context("host", 1);
  return 0;
}

static int destroy(void** state)
{
  (void)state;
  stratus_context_destroy(context);
  return 0;
}

int test_faces_and_layers(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(rows_of_nodes_are_faces),
    cmocka_unit_test(rows_of_faces_are_nodes),
    cmocka_unit_test(wrong_tables_are_refused),
    cmocka_unit_test(corners_at_one_place_are_one_node),
    cmocka_unit_test(faces_are_turned),
    cmocka_unit_test(borders_are_between_middles),
    cmocka_unit_test(heights_come_from_what_files_have),
    cmocka_unit_test(values_at_borders_are_between_those_of_layers),
    cmocka_unit_test(prisms_are_filled_once),
    cmocka_unit_test(every_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, make, destroy);
}
