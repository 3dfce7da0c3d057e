/* SPDX-License-Identifier: BSD-3-Clause
 * Faces of longitudes and latitudes on a plane. Areas in square degrees are the oracle: parts of a face have its area together, and a mesh
 * all over the Earth has 360 x 180. */
#include "structures.h"

#include "faulty_allocator.h"

#include "stratus/globe.h"
#include "stratus/layers.h"

#include <math.h>
#include <stdlib.h>

#define PI 3.14159265358979323846

enum { NODES_MAX = 4096, FACES_MAX = 2048 };

static stratus_context* context;

typedef struct test_mesh_arrays {
  double degrees[NODES_MAX][2];
  int64_t offsets[FACES_MAX + 1];
  int32_t nodes[4 * NODES_MAX];
  uint8_t absent[FACES_MAX];
  stratus_faces view;
} test_mesh_arrays;

static test_mesh_arrays mesh;

static void clear(void)
{
  memset(&mesh, 0, sizeof mesh);
  mesh.view.offsets = mesh.offsets;
  mesh.view.nodes = mesh.nodes;
  mesh.view.absent = mesh.absent;
}

static int32_t add_node(double east, double north)
{
  assert_true(mesh.view.node_count < NODES_MAX);
  mesh.degrees[mesh.view.node_count][0] = remainder(east, 360.0); /* -180..180 */
  mesh.degrees[mesh.view.node_count][1] = north;
  return (int32_t)mesh.view.node_count++;
}

static void add_face(int count, const int32_t* nodes)
{
  assert_true(mesh.view.face_count < FACES_MAX);
  const int64_t begin = mesh.offsets[mesh.view.face_count];
  memcpy(mesh.nodes + begin, nodes, (size_t)count * sizeof *nodes);
  mesh.offsets[++mesh.view.face_count] = begin + count;
}

/* A band of quadrangles round the Earth at the far south, which make a mesh one that must be cut. Its area is 360 degrees x 1. */
static void add_band(void)
{
  const int columns = 12;
  const int32_t first = (int32_t)mesh.view.node_count;
  for (int i = 0; i < columns; ++i) {
    add_node(30.0 * i + 7, -89);
    add_node(30.0 * i + 7, -88);
  }
  for (int i = 0; i < columns; ++i) {
    const int32_t a = first + 2 * i, b = first + 2 * ((i + 1) % columns);
    add_face(4, (const int32_t[]){ a, b, b + 1, a + 1 });
  }
}

static stratus_flat_faces flatten(void)
{
  stratus_flat_faces flat;
  if (stratus_faces_flatten(context, &mesh.view, mesh.degrees[0], &flat) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(context));
  }
  assert_true(flat.faces.node_count >= mesh.view.node_count && flat.faces.face_count >= mesh.view.face_count);
  for (int64_t f = 0; f < flat.faces.face_count; ++f) {
    const int64_t count = flat.faces.offsets[f + 1] - flat.faces.offsets[f];
    assert_true(count >= 3 && count <= STRATUS_FACE_NODES_MAX);
    assert_true(f < mesh.view.face_count ? flat.face_of[f] == f : flat.face_of[f] >= 0 && flat.face_of[f] < mesh.view.face_count);
  }
  for (int64_t i = 0; i < flat.faces.node_count; ++i) {
    const int32_t* const of = flat.node_of + 2 * i;
    assert_true(i >= mesh.view.node_count || (of[0] == i && of[1] == i));
    assert_true(of[0] >= 0 && of[0] < mesh.view.node_count && of[1] >= 0 && of[1] < mesh.view.node_count);
    assert_true(flat.weights[i] >= 0.0 && flat.weights[i] <= 1.0);
    assert_true(!flat.cut || (flat.degrees[2 * i] >= flat.meridian && flat.degrees[2 * i] <= flat.meridian + 360.0));
    /* a place between its ends, or a copy of a node, or at a pole */
    const double *a = mesh.degrees[of[0]], *b = mesh.degrees[of[1]], weight = flat.weights[i];
    const double east = weight * a[0] + (1.0 - weight) * (a[0] + remainder(b[0] - a[0], 360.0)),
                 north = weight * a[1] + (1.0 - weight) * b[1];
    const bool pole = fabs(flat.degrees[2 * i + 1]) > 90.0 - 1e-4;
    assert_true(pole || fabs(flat.degrees[2 * i + 1] - north) < 1e-9);
    assert_true(pole || fabs(remainder(flat.degrees[2 * i] - east, 360.0)) < 1e-9);
  }
  return flat;
}

/* Area of a face, above 0 if it is counterclockwise. */
static double area_of(const stratus_flat_faces* flat, int64_t face)
{
  double area = 0.0;
  const int64_t begin = flat->faces.offsets[face], end = flat->faces.offsets[face + 1];
  for (int64_t i = begin; i < end; ++i) {
    const double* const a = flat->degrees + 2 * flat->faces.nodes[i];
    const double* const b = flat->degrees + 2 * flat->faces.nodes[i + 1 < end ? i + 1 : begin];
    area += 0.5 * (a[0] * b[1] - b[0] * a[1]);
  }
  return area;
}

static double area_of_parts(const stratus_flat_faces* flat, int64_t face)
{
  double area = 0.0;
  for (int64_t f = 0; f < flat->faces.face_count; ++f) {
    area += flat->face_of[f] == face ? area_of(flat, f) : 0.0;
  }
  return area;
}

static double random_between(double low, double high)
{
  return low + (high - low) * rand() / RAND_MAX;
}

/* Random stars around places near the cut: convex ones of equal radii, and concave ones. */
static void parts_have_the_area_of_their_face(void** state)
{
  (void)state;
  srand(1);
  for (int round = 0; round < 300; ++round) {
    clear();
    add_band();
    const bool convex = round % 2 == 0;
    const int corners = round % 10 == 9 ? STRATUS_FACE_NODES_MAX : 3 + rand() % 10;
    double wanted = 0.0, at[STRATUS_FACE_NODES_MAX][2], begin = random_between(0, 1);
    int32_t nodes[STRATUS_FACE_NODES_MAX];
    const double middle[2] = { random_between(150, 210), random_between(-20, 20) }, wide = random_between(1, 60);
    for (int i = 0; i < corners; ++i) {
      const double radius = convex ? wide : random_between(0.1 * wide, wide), angle = 2.0 * PI * (i + begin) / corners;
      at[i][0] = middle[0] + radius * cos(angle);
      at[i][1] = middle[1] + radius * sin(angle);
      if (round % 7 == 0 && i % 2 == 0) {
        at[i][0] = 180.0; /* on the meridian */
      }
      nodes[i] = add_node(at[i][0], at[i][1]);
    }
    for (int i = 0; i < corners; ++i) {
      const double *a = at[i], *b = at[(i + 1) % corners];
      wanted += 0.5 * (a[0] * b[1] - b[0] * a[1]);
    }
    add_face(corners, nodes);
    stratus_flat_faces flat = flatten();
    assert_true(flat.cut && !flat.unwrapped && flat.meridian == -180.0);
    const double got = area_of_parts(&flat, mesh.view.face_count - 1);
    if (!(fabs(got - wanted) < 1e-9 * wide * wide)) {
      fail_msg("round %d: a face of %d corners has %g square degrees, must have %g", round, corners, got, wanted);
    }
    for (int64_t f = 0; f < mesh.view.face_count - 1; ++f) {
      assert_true(fabs(area_of_parts(&flat, f) - 30.0) < 1e-9);
    }
    stratus_flat_faces_destroy(context, &flat);
    assert_null(flat.degrees);
  }
}

/* Nodes of a turned cube's quadrangles on the sphere: every face has another orientation to the poles. */
static void add_cube(int divisions, const double turned[3][3])
{
  int32_t number[6][17][17];
  for (int side = 0; side < 6; ++side) {
    for (int j = 0; j <= divisions; ++j) {
      for (int i = 0; i <= divisions; ++i) {
        double p[3], q[3], length = 0.0;
        p[side / 2] = side % 2 ? 1.0 : -1.0;
        p[(side / 2 + 1) % 3] = (side % 2 ? 1.0 : -1.0) * (2.0 * i / divisions - 1.0);
        p[(side / 2 + 2) % 3] = 2.0 * j / divisions - 1.0;
        for (int a = 0; a < 3; ++a) {
          q[a] = turned[a][0] * p[0] + turned[a][1] * p[1] + turned[a][2] * p[2];
          length += p[a] * p[a];
        }
        const double north = asin(fmax(-1.0, fmin(1.0, q[2] / sqrt(length)))) * 180.0 / PI, east = atan2(q[1], q[0]) * 180.0 / PI;
        int32_t found = -1; /* nodes at edges of the cube are shared */
        for (int32_t n = 0; n < mesh.view.node_count && (i == 0 || j == 0 || i == divisions || j == divisions); ++n) {
          const double d = fabs(remainder(mesh.degrees[n][0] - east, 360.0)) * cos(north * PI / 180.0);
          found = d < 1e-6 && fabs(mesh.degrees[n][1] - north) < 1e-6 ? n : found;
        }
        number[side][j][i] = found >= 0 ? found : add_node(east, north);
      }
    }
    for (int j = 0; j < divisions; ++j) {
      for (int i = 0; i < divisions; ++i) {
        add_face(4, (const int32_t[]){ number[side][j][i], number[side][j][i + 1], number[side][j + 1][i + 1], number[side][j + 1][i] });
      }
    }
  }
}

static void turn_matrix(double x, double y, double z, double to[3][3])
{
  const double a = cos(x), b = cos(y), c = cos(z), s = sin(x), t = sin(y), u = sin(z);
  const double m[3][3] = { { c * b, c * t * s - u * a, c * t * a + u * s }, { u * b, u * t * s + c * a, u * t * a - c * s },
    { -t, b * s, b * a } };
  memcpy(to, m, sizeof m);
}

/* Counts edges that are not at the border of the map and that only one face has. */
static int torn_edges(const stratus_flat_faces* flat)
{
  int torn = 0;
  for (int64_t f = 0; f < flat->faces.face_count; ++f) {
    const int64_t begin = flat->faces.offsets[f], end = flat->faces.offsets[f + 1];
    for (int64_t i = begin; i < end; ++i) {
      const int32_t a = flat->faces.nodes[i], b = flat->faces.nodes[i + 1 < end ? i + 1 : begin];
      const double *p = flat->degrees + 2 * (int64_t)a, *q = flat->degrees + 2 * (int64_t)b;
      bool found = fabs(p[1] + q[1]) > 180.0 - 2e-4;
      for (int side = 0; side < 2; ++side) {
        const double border = flat->meridian + 360.0 * side;
        found = found || (p[0] == border && q[0] == border);
      }
      for (int64_t other = 0; other < flat->faces.face_count && !found; ++other) {
        const int64_t first = flat->faces.offsets[other], last = flat->faces.offsets[other + 1];
        for (int64_t n = first; n < last && !found; ++n) {
          found = flat->faces.nodes[n] == b && flat->faces.nodes[n + 1 < last ? n + 1 : first] == a;
        }
      }
      torn += !found;
    }
  }
  return torn;
}

/* Poles are in the middle of a face, at a node, on an edge, or anywhere. */
static void a_mesh_fills_the_map_of_the_earth(void** state)
{
  (void)state;
  srand(2);
  for (int round = 0; round < 40; ++round) {
    clear();
    double turned[3][3];
    const bool anywhere = round >= 4;
    turn_matrix(
      anywhere ? random_between(0, 6) : 0.0, anywhere ? random_between(0, 6) : 0.0, anywhere ? random_between(0, 6) : 0.3 * round, turned);
    add_cube(round % 4 == 3 ? 5 : 6, (const double(*)[3])turned); /* an odd number: poles in faces */
    if (round % 3 == 1) {
      for (int64_t i = 0; i < mesh.view.node_count; ++i) {
        mesh.degrees[i][0] += mesh.degrees[i][0] < 0.0 ? 360.0 : 0.0;
      }
    }
    stratus_flat_faces flat = flatten();
    assert_true(flat.cut && flat.meridian == (round % 3 == 1 ? 0.0 : -180.0));
    double sum = 0.0;
    for (int64_t f = 0; f < flat.faces.face_count; ++f) {
      sum += area_of(&flat, f);
    }
    if (!(fabs(sum - 360.0 * 180.0) < 1e-6)) {
      fail_msg("round %d: faces have %.9g square degrees", round, sum);
    }
    assert_int_equal(torn_edges(&flat), 0);
    stratus_flat_faces_destroy(context, &flat);
  }
}

/* A face around a pole has the area between its edges and the pole; of a face with a corner at the pole that corner is an edge. */
static void a_pole_is_a_line(void** state)
{
  (void)state;
  srand(3);
  for (int round = 0; round < 60; ++round) {
    clear();
    const int corners = 3 + rand() % 9;
    const double sign = round % 2 ? 1.0 : -1.0;
    double wanted = 0.0, north[16];
    int32_t nodes[16];
    for (int i = 0; i < corners; ++i) {
      north[i] = sign * random_between(30, 89);
      nodes[i] = add_node(360.0 * i / corners + 11 * round, north[i]);
    }
    int highest = 0;
    for (int i = 0; i < corners; ++i) {
      wanted += 360.0 / corners * (90.0 - 0.5 * fabs(north[i] + north[(i + 1) % corners]));
      highest = fabs(north[i]) > fabs(north[highest]) ? i : highest;
    }
    add_face(corners, nodes);
    stratus_flat_faces flat = flatten();
    assert_true(flat.cut && fabs(area_of_parts(&flat, 0) - sign * wanted) < 1e-7);
    for (int64_t i = mesh.view.node_count; i < flat.faces.node_count; ++i) {
      assert_true(fabs(flat.degrees[2 * i + 1]) < 90.0 || (flat.node_of[2 * i] == highest && flat.node_of[2 * i + 1] == highest));
    }
    stratus_flat_faces_destroy(context, &flat);
  }
  clear(); /* over the date line; its longitude at the pole is nonsense */
  const int32_t triangle[3] = { add_node(170, 80), add_node(-160, 70), add_node(33, 90) };
  add_face(3, triangle);
  stratus_flat_faces flat = flatten();
  assert_true(!flat.cut && flat.unwrapped && flat.faces.face_count == 1 && fabs(area_of(&flat, 0) - 30.0 * 15.0) < 1e-9);
  stratus_flat_faces_destroy(context, &flat);
  for (int first = 0; first < 6; ++first) { /* all but sixty degrees around the pole, which is a corner */
    clear();
    int32_t most[6];
    for (int i = 0; i < 6; ++i) {
      most[(first + i) % 6] = i == 0 ? add_node(5, 90) : add_node(75.0 * i - 45, 60);
    }
    add_face(6, most);
    flat = flatten();
    assert_true(fabs(area_of_parts(&flat, 0) - 300.0 * 30.0) < 1e-9);
    stratus_flat_faces_destroy(context, &flat);
  }
  clear(); /* nothing jumps but the longitude at the pole */
  add_face(3, (const int32_t[]){ add_node(10, 80), add_node(20, 70), add_node(-175, 90) });
  flat = flatten();
  assert_true(!flat.cut && !flat.unwrapped && fabs(area_of(&flat, 0) - 10.0 * 15.0) < 1e-9);
  stratus_flat_faces_destroy(context, &flat);
}

/* A face with an edge along the cut is on one side only. */
static void an_edge_along_the_cut_is_no_part(void** state)
{
  (void)state;
  for (int side = -1; side <= 1; side += 2) {
    clear();
    add_band();
    const double at[5][2] = { { 0, 0 }, { 0, 5 }, { 0, 10 }, { 10, 10 }, { 10, 0 } };
    int32_t nodes[5];
    for (int i = 0; i < 5; ++i) {
      nodes[i] = add_node(180 + side * at[i][0], at[i][1]);
    }
    add_face(5, nodes);
    stratus_flat_faces flat = flatten();
    assert_int_equal(flat.faces.face_count, mesh.view.face_count + 1); /* one face of the band is cut */
    assert_true(fabs(area_of_parts(&flat, mesh.view.face_count - 1) + side * 100.0) < 1e-9);
    stratus_flat_faces_destroy(context, &flat);
  }
}

static void longitudes_become_continuous(void** state)
{
  (void)state;
  clear(); /* two squares at the date line, and one by itself */
  const double at[10][2] = { { 179, 0 }, { 181, 0 }, { 181, 1 }, { 179, 1 }, { 183, 0 }, { 183, 1 }, { 184, 0 }, { 185, 0 }, { 185, 1 },
    { 184, 1 } };
  for (int i = 0; i < 10; ++i) {
    add_node(at[i][0], at[i][1]);
  }
  add_face(4, (const int32_t[]){ 0, 1, 2, 3 });
  add_face(4, (const int32_t[]){ 1, 4, 5, 2 });
  add_face(4, (const int32_t[]){ 6, 7, 8, 9 });
  stratus_flat_faces flat = flatten();
  assert_true(flat.unwrapped && !flat.cut && flat.faces.node_count == 10 && flat.faces.face_count == 3);
  assert_memory_equal(flat.degrees, at, sizeof at);
  assert_memory_equal(flat.faces.nodes, mesh.nodes, 12 * sizeof *mesh.nodes);
  stratus_flat_faces_destroy(context, &flat);
  memcpy(mesh.nodes, (const int32_t[]){ 1, 0, 3, 2, 2, 5, 4, 1 }, 8 * sizeof *mesh.nodes); /* the other orientation */
  flat = flatten();
  assert_memory_equal(flat.degrees, at, sizeof at);
  stratus_flat_faces_destroy(context, &flat);
  for (int i = 0; i < 10; ++i) {
    mesh.degrees[i][0] = at[i][0] - 7; /* no jump: nothing changes */
  }
  mesh.absent[1] = 1;
  flat = flatten();
  assert_true(!flat.unwrapped && !flat.cut);
  assert_memory_equal(flat.degrees, mesh.degrees, sizeof at);
  assert_memory_equal(flat.faces.absent, mesh.absent, 3);
  stratus_flat_faces_destroy(context, &flat);

  double lattice[12], wanted[12]; /* four columns by three rows, with an unknown place */
  for (int i = 0; i < 12; ++i) {
    wanted[i] = 150.0 + 20.0 * (i % 4) + i;
    lattice[i] = remainder(wanted[i], 360.0);
  }
  wanted[5] = lattice[5] = NAN;
  int changed = 0;
  const int64_t lengths[3] = { 4, 3, 9 }, strides[3] = { 1, 4, 0 };
  assert_int_equal(stratus_longitudes_unwrap(context, lengths, strides, lattice, &changed), STRATUS_OK);
  assert_int_equal(changed, 1);
  for (int i = 0; i < 12; ++i) {
    assert_true(i == 5 ? isnan(lattice[i]) != 0 : fabs(lattice[i] - wanted[i]) < 1e-9);
  }
  assert_int_equal(stratus_longitudes_unwrap(context, lengths, strides, lattice, &changed), STRATUS_OK);
  assert_int_equal(changed, 0);
  assert_int_equal(stratus_longitudes_unwrap(context, (const int64_t[]){ 4, 0, 1 }, strides, lattice, &changed), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "axis 1 has 0 places 4 apart"));
  assert_int_equal(
    stratus_longitudes_unwrap(context, (const int64_t[]){ 1, INT64_C(1) << 40, 1 }, strides, lattice, &changed), STRATUS_OVERFLOW);
}

static void refuses(const char* words)
{
  stratus_flat_faces flat;
  assert_int_equal(stratus_faces_flatten(context, &mesh.view, mesh.degrees[0], &flat), STRATUS_INVALID_ARGUMENT);
  if (!strstr(stratus_context_message(context), words)) {
    fail_msg("\"%s\" must have \"%s\"", stratus_context_message(context), words);
  }
  stratus_flat_faces_destroy(context, &flat); /* it is empty */
}

static void wrong_places_are_refused(void** state)
{
  (void)state;
  clear();
  add_band();
  mesh.degrees[3][1] = 91;
  refuses("node 3 is at 37 degrees east, 91 degrees north, must be -1e+06 to 1e+06, and -90 to 90");
  mesh.degrees[3][1] = NAN;
  refuses("node 3 is at 37 degrees east");
  mesh.degrees[3][1] = 0;
  mesh.degrees[2][0] = INFINITY;
  refuses("node 2 is at inf degrees east");
  mesh.degrees[2][0] = 0;
  mesh.nodes[5] = 24;
  refuses("face 1 has the node 24, must be 0 to 23");
}

static void faces_have_means_at_nodes(void** state)
{
  (void)state;
  clear();
  for (int i = 0; i < 6; ++i) {
    add_node(i % 3, i / 3);
  }
  add_face(4, (const int32_t[]){ 0, 1, 4, 3 });
  add_face(3, (const int32_t[]){ 1, 2, 4 });
  double at_nodes[6];
  assert_int_equal(stratus_faces_to_nodes(context, &mesh.view, (const double[]){ 3, 5 }, at_nodes), STRATUS_OK);
  assert_true(at_nodes[0] == 3 && at_nodes[1] == 4 && at_nodes[2] == 5 && at_nodes[3] == 3 && at_nodes[4] == 4 && isnan(at_nodes[5]));
  assert_int_equal(stratus_faces_to_nodes(context, &mesh.view, (const double[]){ NAN, 5 }, at_nodes), STRATUS_OK);
  assert_true(isnan(at_nodes[0]) && at_nodes[1] == 5);
  mesh.absent[1] = 1;
  assert_int_equal(stratus_faces_to_nodes(context, &mesh.view, (const double[]){ 3, 5 }, at_nodes), STRATUS_OK);
  assert_true(at_nodes[1] == 3 && isnan(at_nodes[2]));
}

static void every_allocation_may_fail(void** state)
{
  (void)state;
  clear();
  double turned[3][3];
  turn_matrix(1, 2, 3, turned);
  add_cube(6, (const double(*)[3])turned);
  bool failed = true;
  int failures = 0;
  while (failed) {
    faulty_allocator allocator = { 0, 0, 0 };
    const stratus_context_options options = faulty_options(&allocator, "host");
    stratus_context* faulty = NULL;
    char message[256];
    assert_int_equal(stratus_context_create(&options, &faulty, message, sizeof message), STRATUS_OK);
    const int64_t live = allocator.live;
    allocator.fail_at = allocator.calls + ++failures;
    stratus_flat_faces flat;
    const stratus_status status = stratus_faces_flatten(faulty, &mesh.view, mesh.degrees[0], &flat);
    failed = status == STRATUS_OUT_OF_MEMORY;
    assert_true(failed || status == STRATUS_OK);
    assert_true(!failed || allocator.live == live);
    stratus_flat_faces_destroy(faulty, &flat);
    assert_true(allocator.live == live);
    stratus_context_destroy(faulty);
  }
  assert_true(failures > 15);
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

int test_flat_faces(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(parts_have_the_area_of_their_face),
    cmocka_unit_test(a_mesh_fills_the_map_of_the_earth),
    cmocka_unit_test(a_pole_is_a_line),
    cmocka_unit_test(an_edge_along_the_cut_is_no_part),
    cmocka_unit_test(longitudes_become_continuous),
    cmocka_unit_test(wrong_places_are_refused),
    cmocka_unit_test(faces_have_means_at_nodes),
    cmocka_unit_test(every_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, make, destroy);
}
