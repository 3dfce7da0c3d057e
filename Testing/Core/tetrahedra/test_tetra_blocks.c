/* SPDX-License-Identifier: BSD-3-Clause
 * Several lattices as one mesh: a bent lattice cut into blocks is the whole one, and the double-precision reference of its tetrahedra, by
 * march and projection, lit, with hollows, values of cells and components; and refused inputs. */
#include "tetra_case.h"

#include "mesh.h"
#include "tetra_caster.h"
#include "testing.h"

#define SIDE 7 /* points along each axis of the whole */
#define POINTS (SIDE * SIDE * SIDE)
#define MOST 8

typedef struct blocks_case {
  tetra_case listed; /* the whole's cells in a list, for the reference, and functions, options and camera */
  stratus_mesh whole, blocks, block[MOST];
  double points[3 * POINTS];
  float values[2 * POINTS];
  uint8_t hidden[POINTS];
  double* block_points[MOST];
  float* block_values[MOST];
  uint8_t* block_hidden[MOST];
} blocks_case;

static blocks_case c;
static tetra_picture ours, theirs;
static double reference[4 * TETRA_PIXELS_MOST];

static int64_t at(const int32_t n[3], int i, int j, int k)
{
  return ((int64_t)k * n[1] + j) * n[0] + i;
}

/* The whole: a bent lattice. Values of two components, of which the first is drawn unless a test says so. */
static void start(int cell_values)
{
  static const int32_t side[3] = { SIDE, SIDE, SIDE };
  memset(&c, 0, sizeof c);
  tetra_create(&c.listed, SIDE - 1, 0.0, 0.0, 1);
  c.whole = stratus_mesh_default();
  for (int p = 0; p < POINTS; ++p) {
    const double i = p % SIDE, j = p / SIDE % SIDE, k = p / SIDE / SIDE;
    c.points[3 * p] = i + 0.3 * sin(1.1 * j + 0.7 * k);
    c.points[3 * p + 1] = j + 0.25 * cos(1.3 * i + k);
    c.points[3 * p + 2] = k + 0.3 * sin(1.7 * i) * cos(1.2 * j);
    c.values[2 * p] = (float)(0.5 + 0.25 * sin(1.9 * i + 0.7 * j) + 0.25 * cos(1.3 * k - 0.9 * j));
    c.values[2 * p + 1] = (float)(0.5 + 0.45 * sin(0.8 * i - 0.9 * k));
  }
  memcpy(c.whole.lattice, side, sizeof side);
  c.whole.points = c.points;
  c.whole.point_count = POINTS;
  c.whole.cell_count = (SIDE - 1) * (SIDE - 1) * (SIDE - 1);
  c.whole.values = c.values;
  c.whole.value_stride = 2;
  c.whole.cell_values = cell_values;
}

static void drop_blocks(void)
{
  for (int b = 0; b < MOST; ++b) {
    free(c.block_points[b]);
    free(c.block_values[b]);
    free(c.block_hidden[b]);
    c.block_points[b] = NULL;
    c.block_values[b] = NULL;
    c.block_hidden[b] = NULL;
  }
}

static void end(void)
{
  drop_blocks();
  tetra_destroy(&c.listed);
}

/* Copies hexahedra from..to-1 to block b, along an axis in reverse order where `reverse` names it. */
static void copy_block(int b, const int from[3], const int to[3], int reverse)
{
  const int32_t n[3] = { to[0] - from[0] + 1, to[1] - from[1] + 1, to[2] - from[2] + 1 };
  const size_t count = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
  stratus_mesh* block = c.block + b;
  double* points = c.block_points[b] = calloc(count, 3 * sizeof(double));
  float* values = c.block_values[b] = calloc(count, 2 * sizeof(float));
  uint8_t* hidden = c.block_hidden[b] = calloc(count, 1);
  assert_true(points && values && hidden);
  *block = c.whole;
  memcpy(block->lattice, n, sizeof n);
  block->point_count = (int64_t)count;
  block->cell_count = (int64_t)(n[0] - 1) * (n[1] - 1) * (n[2] - 1);
  block->points = points;
  block->values = values;
  block->hidden = c.whole.hidden ? hidden : NULL;
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        const int own[3] = { i, j, k };
        int p[3], cell[3];
        for (int a = 0; a < 3; ++a) {
          p[a] = from[a] + (a == reverse ? n[a] - 1 - own[a] : own[a]);
          cell[a] = from[a] + (a == reverse ? n[a] - 2 - own[a] : own[a]);
        }
        const int64_t to_point = at(n, i, j, k), from_point = at(c.whole.lattice, p[0], p[1], p[2]);
        memcpy(points + 3 * to_point, c.points + 3 * from_point, 3 * sizeof(double));
        if (!c.whole.cell_values) {
          memcpy(values + 2 * to_point, c.values + 2 * from_point, 2 * sizeof(float));
        }
        if (i < n[0] - 1 && j < n[1] - 1 && k < n[2] - 1) {
          const int32_t m[3] = { n[0] - 1, n[1] - 1, n[2] - 1 }, all[3] = { SIDE - 1, SIDE - 1, SIDE - 1 };
          const int64_t to_cell = at(m, i, j, k), from_cell = at(all, cell[0], cell[1], cell[2]);
          hidden[to_cell] = c.hidden[from_cell];
          if (c.whole.cell_values) {
            memcpy(values + 2 * to_cell, c.values + 2 * from_cell, 2 * sizeof(float));
          }
        }
      }
    }
  }
}

/* Cuts the whole at these planes of points, 0: not, into blocks; order 1: from the last to the first. */
static void cut(int i, int j, int k, int order, int reverse)
{
  const int cuts[3] = { i, j, k };
  int count = 1, made = 0;
  drop_blocks();
  for (int a = 0; a < 3; ++a) {
    count *= cuts[a] > 0 ? 2 : 1;
  }
  for (int part = 0; part < 8; ++part) {
    int from[3] = { 0, 0, 0 }, to[3] = { SIDE - 1, SIDE - 1, SIDE - 1 };
    bool there = true;
    for (int a = 0; a < 3; ++a) {
      there = there && (cuts[a] > 0 || !(part >> a & 1));
      (part >> a & 1 ? from : to)[a] = cuts[a] > 0 ? cuts[a] : (part >> a & 1 ? from : to)[a];
    }
    if (there) {
      copy_block(order ? count - 1 - made : made, from, to, made == 1 ? reverse : -1);
      ++made;
    }
  }
  c.blocks = stratus_mesh_default();
  c.blocks.cell_values = c.whole.cell_values;
  c.blocks.components = c.whole.components;
  c.blocks.blocks = c.block;
  c.blocks.block_count = count;
  c.blocks.point_count = c.blocks.cell_count = 0;
  for (int b = 0; b < count; ++b) {
    c.blocks.point_count += c.block[b].point_count;
    c.blocks.cell_count += c.block[b].cell_count;
  }
}

static void draw(stratus_context* context, const stratus_mesh* mesh, stratus_tetra_method method, tetra_picture* picture)
{
  tetra_case drawn = c.listed;
  drawn.mesh = *mesh;
  drawn.options.method = tetra_method = method;
  tetra_draw(context, &drawn, picture);
  tetra_method = STRATUS_TETRA_METHOD_MARCH;
}

/* Lists the tetrahedra of all blocks, for the reference. */
static void list_blocks(void)
{
  static const int ways[6][2] = { { 1, 3 }, { 1, 5 }, { 2, 3 }, { 2, 6 }, { 4, 5 }, { 4, 6 } };
  tetra_case* l = &c.listed;
  int32_t first = 0;
  free(l->points);
  free(l->values);
  l->points = calloc((size_t)c.blocks.point_count, 3 * sizeof(double));
  l->values = calloc((size_t)(6 * c.blocks.cell_count + c.blocks.point_count), sizeof(float));
  assert_true(l->points && l->values);
  l->mesh.cell_count = 0;
  for (int b = 0; b < c.blocks.block_count; ++b) {
    const stratus_mesh* m = c.block + b;
    const int32_t* n = m->lattice;
    for (int64_t p = 0; p < m->point_count; ++p) {
      for (int a = 0; a < 3; ++a) {
        l->points[3 * (first + p) + a] = isfinite(m->points[3 * p + a]) ? m->points[3 * p + a] : 0.0;
      }
      if (!m->cell_values) {
        l->values[first + p] = c.block_values[b][2 * p];
      }
    }
    for (int64_t cell = 0; cell < m->cell_count; ++cell) {
      const int i = (int)(cell % (n[0] - 1)), j = (int)(cell / (n[0] - 1) % (n[1] - 1)), k = (int)(cell / (n[0] - 1) / (n[1] - 1));
      bool shows = !(m->hidden && m->hidden[cell]);
      int32_t corner[8];
      for (int q = 0; q < 8; ++q) {
        corner[q] = first + (int32_t)at(n, i + (q & 1), j + (q >> 1 & 1), k + (q >> 2));
        shows = shows && (m->cell_values || isfinite(l->values[corner[q]])) && isfinite(m->points[3 * (corner[q] - first)]);
      }
      for (int t = 0; t < 6 && shows; ++t) {
        const int32_t v[4] = { corner[0], corner[ways[t][0]], corner[ways[t][1]], corner[7] };
        memcpy(l->vertices + 4 * l->mesh.cell_count, v, sizeof v);
        if (m->cell_values) {
          l->values[l->mesh.cell_count] = c.block_values[b][2 * cell];
        }
        ++l->mesh.cell_count;
      }
    }
    first += (int32_t)m->point_count;
  }
  l->mesh.points = l->points;
  l->mesh.values = l->values;
  l->mesh.point_count = first;
  l->mesh.cell_values = c.whole.cell_values;
}

/* By both methods against the reference, from several sides. */
static void is_right(stratus_context* context, const char* what)
{
  list_blocks();
  for (int view = 0; view < 3; ++view) {
    double largest;
    tetra_camera(context, &c.listed, SIDE - 1, 3 * view, view == 1);
    tetra_reference(&c.listed, reference, NULL);
    for (int method = STRATUS_TETRA_METHOD_MARCH; method <= STRATUS_TETRA_METHOD_PROJECT; ++method) {
      draw(context, &c.blocks, (stratus_tetra_method)method, &ours);
      const double error = tetra_error(ours.rgba, reference, &largest);
      if (!(error < 0.15)) {
        print_error("%s, view %d, method %d: %.3f of 255, at most %.3f\n", what, view, method, error, largest);
      }
      assert_true(error < 0.15); /* the tolerance of .001 is .25 of 255 */
      assert_int_equal(ours.report.stuck, 0);
      assert_int_equal(ours.report.cells, 6 * c.blocks.cell_count);
    }
  }
}

/* The same cells as the whole's, met at the same depths: a ray passes no cell twice and misses none at seams. */
static void is_whole(stratus_context* context, const char* what)
{
  for (int view = 0; view < 6; view += few_run() ? 3 : 1) {
    tetra_camera(context, &c.listed, SIDE - 1, view, view & 1);
    draw(context, &c.whole, STRATUS_TETRA_METHOD_MARCH, &theirs);
    draw(context, &c.blocks, STRATUS_TETRA_METHOD_MARCH, &ours);
    assert_int_equal(ours.report.segments, theirs.report.segments);
    assert_int_equal(ours.report.shown_cells, theirs.report.shown_cells);
    assert_int_equal(ours.report.blanked, theirs.report.blanked);
    assert_true(ours.report.entries >= theirs.report.entries);
    for (int i = 0; i < TETRA_PIXELS; ++i) {
      assert_int_equal(ours.samples[i], theirs.samples[i]);
    }
    for (int i = 0; i < 4 * TETRA_PIXELS; ++i) { /* places where rays enter a cell are rounded by other points of its face */
      if (!(fabs((double)(ours.rgba[i] - theirs.rgba[i])) < 2e-4)) {
        print_error("%s, view %d, pixel %d: %g, not %g\n", what, view, i / 4, (double)ours.rgba[i], (double)theirs.rgba[i]);
      }
      assert_true(fabs((double)(ours.rgba[i] - theirs.rgba[i])) < 2e-4);
    }
  }
}

static const int cuts[6][4] = { { 3, 0, 0, 0 }, { 0, 2, 0, 1 }, { 0, 0, 4, 0 }, { 1, 5, 0, 1 }, { 2, 3, 5, 0 }, { 5, 2, 1, 1 } };

static void cut_lattices_are_whole(void** state)
{
  for (int cell_values = 0; cell_values < 2; ++cell_values) {
    start(cell_values);
    for (int n = 0; n < 6; n += few_run() ? 3 : 1) {
      char what[64];
      (void)snprintf(what, sizeof what, "cut %d, cell values %d", n, cell_values);
      cut(cuts[n][0], cuts[n][1], cuts[n][2], cuts[n][3], -1);
      is_whole(*state, what);
      if (n == 4) {
        is_right(*state, what);
      }
    }
    end();
  }
}

/* Hidden hexahedra, values and coordinates that are not finite, on both sides of a seam. */
static void hollows_at_seams(void** state)
{
  for (int cell_values = 0; cell_values < 2; ++cell_values) {
    start(cell_values);
    c.whole.hidden = c.hidden;
    for (int cell = 2; cell < c.whole.cell_count; cell += 5) {
      c.hidden[cell] = 1;
    }
    c.values[2 * 171] = NAN;
    c.points[3 * (POINTS - 1)] = NAN;
    cut(3, 3, 3, 0, -1);
    is_whole(*state, "hollows");
    is_right(*state, "hollows");
    end();
  }
}

/* A block whose i runs the other way is left-handed among right-handed ones. It meets those before and behind it along i in the same
 * diagonals. */
static void blocks_of_either_hand(void** state)
{
  start(0);
  cut(3, 0, 0, 0, 0);
  is_right(*state, "a left-handed block");
  assert_int_equal(ours.report.inverted, 3 * 6 * 6 * 6); /* of the list, by projection */
  draw(*state, &c.blocks, STRATUS_TETRA_METHOD_MARCH, &ours);
  assert_int_equal(ours.report.inverted, 3 * 6 * 6 * 6);
  end();
}

/* A gradient at a seam's point uses the cells of all blocks there. */
static void light_crosses_seams(void** state)
{
  static const double thin[4] = { 0.05, 0.0, 0.5, 1.0 };
  for (int cell_values = 0; cell_values < 2; ++cell_values) {
    start(cell_values);
    c.listed.options.shade = 1;
    c.listed.options.shading.specular = 0.4;
    c.listed.transfer.gradient = thin;
    c.listed.transfer.gradient_count = 2;
    for (int n = 0; n < 6; n += 2) {
      cut(cuts[n][0], cuts[n][1], cuts[n][2], cuts[n][3], -1);
      is_whole(*state, "lit");
    }
    end();
  }
}

static void draw_two(stratus_context* context, const stratus_mesh* mesh, int mode, tetra_picture* picture)
{
  stratus_tetra_caster* caster = NULL;
  stratus_transfer transfers[2] = { c.listed.transfer, c.listed.transfer };
  static const double opacity[4] = { 0.3, 0.0, 1.0, 0.6 };
  transfers[1].opacity = opacity;
  transfers[1].opacity_count = 2;
  c.listed.options.mode = (stratus_tetra_mode)mode;
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = picture->rgba };
  assert_int_equal(stratus_tetra_caster_create(context, &caster), STRATUS_OK);
  assert_int_equal(
    stratus_tetra_caster_render(caster, mesh, transfers, &c.listed.camera, &c.listed.options, &image, &picture->report), STRATUS_OK);
  stratus_tetra_caster_destroy(caster);
}

static void components_cross_seams(void** state)
{
  for (int mode = STRATUS_TETRA_COMPOSITE; mode <= STRATUS_TETRA_ADDITIVE; ++mode) {
    start(mode & 1);
    c.whole.components = 2;
    cut(2, 3, 5, 1, -1);
    tetra_camera(*state, &c.listed, SIDE - 1, 2, 0);
    draw_two(*state, &c.whole, mode, &theirs);
    draw_two(*state, &c.blocks, mode, &ours);
    for (int i = 0; i < 4 * TETRA_PIXELS; ++i) {
      assert_true(fabs((double)(ours.rgba[i] - theirs.rgba[i])) < 2e-4);
    }
    end();
  }
}

/* New values on the same blocks build only the values; another cut builds everything. */
static void steps_of_values(void** state)
{
  stratus_tetra_caster* caster = NULL;
  stratus_tetra_report report;
  start(0);
  cut(2, 3, 5, 0, -1);
  tetra_camera(*state, &c.listed, SIDE - 1, 2, 0);
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = ours.rgba };
  assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
  for (int step = 0; step < 4; ++step) {
    for (int i = 0; i < 2 * POINTS; ++i) {
      c.values[i] *= 0.9f;
    }
    cut(step < 3 ? 2 : 1, 3, 5, 0, -1);
    c.blocks.revision = (uint64_t)step;
    assert_int_equal(
      stratus_tetra_caster_render(caster, &c.blocks, &c.listed.transfer, &c.listed.camera, &c.listed.options, &image, &report), STRATUS_OK);
    draw(*state, &c.blocks, STRATUS_TETRA_METHOD_MARCH, &theirs);
    assert_memory_equal(ours.rgba, theirs.rgba, sizeof ours.rgba);
    assert_int_equal(report.mesh_builds, step < 3 ? 1 : 2);
    assert_int_equal(report.value_builds, step + 1);
  }
  stratus_tetra_caster_destroy(caster);
  end();
}

/* The caster's memory for eight large lattices: less than 40 bytes a hexahedron, as for one of them. */
static void memory_of_a_cell(void** state)
{
  enum { EDGE = 49, COUNT = EDGE * EDGE * EDGE, CELLS = 8 * (EDGE - 1) * (EDGE - 1) * (EDGE - 1) };
  stratus_tetra_caster* caster = NULL;
  stratus_tetra_report report;
  start(0);
  float* all = calloc(8 * (size_t)COUNT, 4 * sizeof *all);
  assert_non_null(all);
  c.blocks = stratus_mesh_default();
  c.blocks.blocks = c.block;
  c.blocks.block_count = 8;
  c.blocks.point_count = 8 * (int64_t)COUNT;
  c.blocks.cell_count = CELLS;
  for (int b = 0; b < 8; ++b) {
    float* own = all + 4 * (size_t)COUNT * (size_t)b;
    for (int p = 0; p < COUNT; ++p) {
      own[3 * p] = (float)(p % EDGE + (b & 1) * (EDGE - 1)) * 0.05f;
      own[3 * p + 1] = (float)(p / EDGE % EDGE + (b >> 1 & 1) * (EDGE - 1)) * 0.05f;
      own[3 * p + 2] = (float)(p / EDGE / EDGE + (b >> 2) * (EDGE - 1)) * 0.05f;
      own[3 * COUNT + p] = 0.001f * (float)(p % 997);
    }
    c.block[b] = stratus_mesh_default();
    c.block[b].lattice[0] = c.block[b].lattice[1] = c.block[b].lattice[2] = EDGE;
    c.block[b].float_points = own;
    c.block[b].values = own + 3 * (size_t)COUNT;
    c.block[b].point_count = COUNT;
    c.block[b].cell_count = CELLS / 8;
  }
  tetra_camera(*state, &c.listed, 5, 0, 0);
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = ours.rgba };
  const int last = few_run() ? STRATUS_TETRA_METHOD_AUTO : STRATUS_TETRA_METHOD_PROJECT; /* the projection has no bound */
  for (int method = STRATUS_TETRA_METHOD_AUTO; method <= last; method += 2) {
    c.listed.options.method = (stratus_tetra_method)method;
    assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
    assert_int_equal(
      stratus_tetra_caster_render(caster, &c.blocks, &c.listed.transfer, &c.listed.camera, &c.listed.options, &image, &report), STRATUS_OK);
    print_message("%s: %.1f bytes a cell\n", stratus_tetra_method_name(report.method), (double)report.bytes / CELLS);
    assert_true(method == STRATUS_TETRA_METHOD_PROJECT || (double)report.bytes / CELLS < 40.0);
    stratus_tetra_caster_destroy(caster);
  }
  free(all);
  end();
}

static void wrong_blocks_are_refused(void** state)
{
  static const char* const words[] = { "block_count -1", "with blocks NULL", "or a lattice of its own", "or a lattice of its own",
    "block 1 is no lattice", "block 1 has type", "block 1 has type", "block 1 has type", "point_count of 1 and", "lattice of 1 x" };
  stratus_tetra_caster* caster = NULL;
  start(0);
  cut(3, 0, 0, 0, -1);
  tetra_camera(*state, &c.listed, SIDE - 1, 2, 0);
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = ours.rgba };
  assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
  for (int wrong = 0; wrong < 10; ++wrong) {
    stratus_mesh mesh = c.blocks, block = c.block[1];
    mesh.block_count = wrong == 0 ? -1 : 2;
    mesh.blocks = wrong == 1 ? NULL : c.block;
    mesh.points = wrong == 2 ? c.points : NULL;
    mesh.lattice[0] = wrong == 3 ? 2 : 0;
    mesh.point_count = wrong == 8 ? 1 : mesh.point_count;
    memset(c.block[1].lattice, 0, wrong == 4 ? sizeof block.lattice : 0);
    c.block[1].type = wrong == 5 ? STRATUS_FLOAT64 : block.type;
    c.block[1].values = wrong == 6 ? NULL : block.values;
    c.block[1].cell_values = wrong == 7;
    c.block[1].lattice[0] = wrong == 9 ? 1 : c.block[1].lattice[0];
    assert_int_equal(stratus_tetra_caster_render(caster, &mesh, &c.listed.transfer, &c.listed.camera, &c.listed.options, &image, NULL),
      STRATUS_INVALID_ARGUMENT);
    if (!strstr(stratus_context_message(*state), words[wrong])) {
      print_error("%d: %s\n", wrong, stratus_context_message(*state));
    }
    assert_non_null(strstr(stratus_context_message(*state), words[wrong]));
    c.block[1] = block;
  }
  stratus_partition* partition = NULL;
  assert_int_equal(stratus_partition_create(*state, &c.blocks, NULL, &partition), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(*state), "mesh has 2 blocks"));
  draw(*state, &c.blocks, STRATUS_TETRA_METHOD_MARCH, &ours);
  stratus_tetra_caster_destroy(caster);
  end();
}

int test_tetra_blocks(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup_teardown(cut_lattices_are_whole, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(hollows_at_seams, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(blocks_of_either_hand, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(light_crosses_seams, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(components_cross_seams, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(steps_of_values, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(memory_of_a_cell, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(wrong_blocks_are_refused, tetra_start, tetra_stop),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
