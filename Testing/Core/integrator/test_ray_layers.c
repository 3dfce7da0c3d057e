/* SPDX-License-Identifier: BSD-3-Clause
 * Isosurfaces and slices of several grids: each pixel against the surfaces of each grid by itself, which are found in double precision,
 * sorted and composited here. */
#include "reference_modes.h"
#include "several_case.h"

#include "base.h"

#undef TETRA_PIXELS
#include "tetra_case.h"
#include "testing.h"

#define MOST 96          /* surfaces on a ray in a grid */
#define LAYERS_DB 64.0   /* as of slices and isosurfaces of one grid */
#define DEPTH_ERROR 2e-3 /* in world units, for volumes 30 wide */
#define SHARE_OFF 0.01   /* of pixels: rays along a rim, or along a surface, meet it in only one picture */
#define SAME 1e-6        /* in the world: surfaces of one place, which both were found by bisection */
#define NEAR 1.0
#define FAR 300.0

typedef struct placed_layer {
  reference_layer of;
  int input;
} placed_layer;

static picture drawn, other;
static reference_layer found[3][CASE_PIXELS_MOST * MOST];
static int counts[3][CASE_PIXELS_MOST];
static float expected[4 * CASE_PIXELS_MOST], expected_depth[CASE_PIXELS_MOST], opaque[CASE_PIXELS_MOST];
static double reach[CASE_PIXELS_MOST]; /* where rays end */

static int nearer(const void* a, const void* b)
{
  const placed_layer *p = a, *q = b;
  return fabs(p->of.t - q->of.t) < SAME ? p->input - q->input : p->of.t < q->of.t ? -1 : 1;
}

/* Composites the surfaces that were found in `count` grids. Returns the most that a pixel has. */
static int composite(int count)
{
  int most = 0;
  for (int i = 0; i < CASE_PIXELS; ++i) {
    placed_layer all[3 * MOST];
    int layers = 0;
    double left = 1.0, rgb[3] = { 0.0, 0.0, 0.0 };
    for (int n = 0; n < count; ++n) {
      for (int l = 0; l < counts[n][i]; ++l) {
        const reference_layer* layer = &found[n][i * MOST + l];
        if (layer->color[3] > 0.0 && layer->t < reach[i]) {
          all[layers++] = (placed_layer){ *layer, n };
        }
      }
    }
    qsort(all, (size_t)layers, sizeof *all, nearer);
    for (int l = 0; l < layers; ++l) {
      for (int c = 0; c < 3; ++c) {
        rgb[c] += left * all[l].of.color[3] * all[l].of.color[c];
      }
      left *= 1.0 - all[l].of.color[3];
    }
    for (int c = 0; c < 4; ++c) {
      expected[4 * i + c] = (float)(c < 3 ? rgb[c] : 1.0 - left);
    }
    expected_depth[i] = layers > 0 ? (float)all[0].of.t : INFINITY;
    most = layers > most ? layers : most;
  }
  return most;
}

/* Compares a picture with the surfaces of `count` grids. */
static void expect_layers(const char* what, picture* p, int count)
{
  const int most = composite(count), lit = case_lit(p);
  int off = 0, far = 0;
  for (int i = 0; i < CASE_PIXELS; ++i) {
    bool same = true;
    for (int c = 0; c < 4; ++c) {
      same = same && fabsf(p->rgba[4 * i + c] - expected[4 * i + c]) < 0.02f;
    }
    if (!same) {
      memcpy(p->rgba + 4 * i, expected + 4 * i, 4 * sizeof *expected);
      ++off;
    } else if (isfinite(expected_depth[i]) && !((double)fabsf(p->depth[i] - expected_depth[i]) < DEPTH_ERROR)) {
      ++far;
    }
  }
  const double db = reference_psnr(p->rgba, expected, CASE_PIXELS);
  print_message(
    "             %s of %d: %.1f dB, %d pixels, at most %d surfaces, %d off, %d at another depth\n", what, count, db, lit, most, off, far);
  assert_true(lit > CASE_PIXELS / 20);
  assert_true(most > 1);
  assert_true(db >= LAYERS_DB);
  assert_true(off + far <= (int)(SHARE_OFF * CASE_PIXELS));
}

/* Volumes of which most values show. */
static void create(stratus_context* context, several_case* m, int count, stratus_mode mode, uint32_t seed)
{
  several_create(context, m, count, seed);
  const stratus_camera camera = m->of[0].camera;
  for (int n = 0; n < count; ++n) {
    picture_case* c = &m->of[n];
    case_destroy(c);
    case_create(context, c, n == 1 ? STRATUS_UINT16 : STRATUS_FLOAT32, 20 + 3 * n, 24, 31 - 2 * n, seed + (uint32_t)n);
    several_place(c, seed + 17u * (uint32_t)n);
    several_color(c, n);
    const double base = case_type_values[c->volume.type].base, scale = case_type_values[c->volume.type].scale;
    const double opacity[8] = { base - scale, 0.2, base - 0.2 * scale, 0.3, base + 0.3 * scale, 0.6, base + scale, 0.9 };
    memcpy(c->opacity, opacity, sizeof opacity);
    c->options.mode = mode;
    c->options.optics.contour_count = 3;
    for (int i = 0; i < 3; ++i) {
      c->options.optics.contours[i] = base + scale * (0.2 * i - 0.25 + 0.03 * n);
    }
    c->options.slice = (stratus_slice){ .square = { 1, 1, 1 }, .constant = -60.0 - 30.0 * n };
    c->options.skipping.audit = 1;
  }
  m->of[0].camera = camera;
}

static void find_layers(const several_case* m)
{
  for (int n = 0; n < m->count; ++n) {
    const picture_case* c = &m->of[n];
    reference_modes_layers(&c->volume, &c->transfer, &m->of[0].camera, &c->options, CASE_WIDTH, CASE_HEIGHT, MOST, found[n], counts[n]);
  }
  for (int i = 0; i < CASE_PIXELS; ++i) {
    reach[i] = (double)INFINITY;
  }
}

static void surfaces_are_by_depth(void** state)
{
  for (uint32_t seed = 0; seed < (few_run() ? 4u : 10u); ++seed) {
    const stratus_mode mode = seed % 2 ? STRATUS_MODE_SLICE : STRATUS_MODE_ISOSURFACE;
    several_case m;
    create(*state, &m, 2 + (int)(seed / 2 % 2), mode, 900 + seed);
    find_layers(&m);
    several_draw(*state, &m, &drawn);
    assert_int_equal(drawn.report.differing_pixels, 0);
    expect_layers(stratus_mode_name(mode), &drawn, m.count);
    several_destroy(&m);
  }
}

/* Volumes of one slice have surfaces at one depth where they overlap. */
static void surfaces_at_one_depth_are_in_the_order_of_inputs(void** state)
{
  several_case m;
  create(*state, &m, 3, STRATUS_MODE_SLICE, 920);
  for (int n = 0; n < 3; ++n) {
    m.of[n].options.slice = (stratus_slice){ .square = { 1, 1, 0.6 }, .linear = { 0.3, 2.0, 0.1 }, .constant = -50.0 };
  }
  find_layers(&m);
  several_draw(*state, &m, &drawn);
  expect_layers("one slice", &drawn, 3);
  const picture_case first = m.of[0];
  m.of[0] = m.of[2];
  m.of[0].camera = first.camera;
  m.of[2] = first;
  several_draw(*state, &m, &other);
  assert_true(reference_psnr(other.rgba, expected, CASE_PIXELS) < 30.0);
  find_layers(&m);
  expect_layers("one slice, turned round", &other, 3);
  several_destroy(&m);
}

/* Opaque geometry ends rays among the surfaces. Without it, a camera that sees no far end can't end rays that see nothing more. */
static void geometry_ends_rays_among_surfaces(void** state)
{
  for (uint32_t seed = 0; seed < 2; ++seed) { /* both projections */
    several_case m;
    uint32_t random = 7 + seed;
    create(*state, &m, 2, STRATUS_MODE_ISOSURFACE, 930 + seed);
    stratus_camera* camera = &m.of[0].camera;
    const double distance = sqrt(camera->eye[0] * camera->eye[0] + camera->eye[1] * camera->eye[1] + camera->eye[2] * camera->eye[2]);
    find_layers(&m);
    several_draw(*state, &m, &other);
    camera->near_k = NEAR;
    camera->far_k = FAR;
    several_draw(*state, &m, &drawn);
    assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba); /* to the bit: the same rays */
    for (int i = 0; i < CASE_PIXELS; ++i) {
      const double u = (2.0 * (i % CASE_WIDTH) + 1.0) / CASE_WIDTH - 1.0, v = (2.0 * (i / CASE_WIDTH) + 1.0) / CASE_HEIGHT - 1.0;
      const double k = distance + case_uniform(&random, -12.0, 12.0);
      double square = 0.0;
      for (int a = 0; a < 3; ++a) {
        const double side = camera->parallel ? 0.0 : u * camera->right[a] + v * camera->up[a];
        square += (camera->forward[a] + side) * (camera->forward[a] + side);
      }
      opaque[i] = (float)(camera->parallel ? (k - NEAR) / (FAR - NEAR) : FAR * (k - NEAR) / (k * (FAR - NEAR)));
      reach[i] = k * sqrt(square);
    }
    m.of[0].opaque_depth = opaque;
    several_draw(*state, &m, &drawn);
    expect_layers("surfaces before geometry", &drawn, 2);
    several_destroy(&m);
  }
}

/* Rays that end at an opaque surface are drawn once: each grid takes as many samples as by itself. */
static void nothing_is_drawn_behind_opaque_surfaces(void** state)
{
  several_case m;
  several_casters casters;
  stratus_ray_cast_report reports[STRATUS_SEVERAL_MAX];
  create(*state, &m, 2, STRATUS_MODE_ISOSURFACE, 940);
  several_casters_create(*state, &casters);
  m.of[0].camera.near_k = NEAR;
  m.of[0].camera.far_k = FAR;
  for (int n = 0; n < 2; ++n) {
    for (int i = 1; i < 8; i += 2) {
      m.of[n].opacity[i] = 1.0;
    }
    m.of[n].options.sampling.termination = 0.999;
    m.of[n].options.skipping.structure = STRATUS_STRUCTURE_NONE;
  }
  find_layers(&m);
  assert_int_equal(several_draw_with(&casters, &m, &drawn, reports), STRATUS_OK);
  const picture_case second = m.of[1];
  m.of[1].camera = m.of[0].camera;
  for (int n = 0; n < 2; ++n) {
    case_render(*state, &m.of[n], &other);
    print_message("             volume %d: %llu samples, by itself %llu\n", n, (unsigned long long)reports[n].samples,
      (unsigned long long)other.report.samples);
    assert_int_equal(reports[n].samples, other.report.samples);
  }
  m.of[1] = second;
  expect_layers("opaque surfaces", &drawn, 2);
  several_casters_destroy(&casters);
  several_destroy(&m);
}

/* Blocks that overlap show their surfaces by depth, too. */
static void surfaces_of_overlapping_blocks_are_by_depth(void** state)
{
  several_case m;
  several_casters casters;
  stratus_ray_cast_input inputs[2];
  stratus_ray_cast_report reports[2];
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba, .depth = drawn.depth };
  create(*state, &m, 2, STRATUS_MODE_ISOSURFACE, 950);
  several_casters_create(*state, &casters);
  for (int n = 0; n < 2; ++n) {
    inputs[n] = (stratus_ray_cast_input){
      .caster = casters.of[n], .volume = &m.of[n].volume, .transfer = &m.of[n].transfer, .options = &m.of[n].options
    };
  }
  for (int far = 0; far < 2; ++far) {
    m.of[0].camera.near_k = far ? NEAR : 0.0;
    m.of[0].camera.far_k = far ? FAR : (double)INFINITY;
    find_layers(&m);
    assert_int_equal(stratus_ray_caster_render_blocks(inputs, 2, &m.of[0].camera, &image, reports), STRATUS_OK);
    assert_null(strstr(reports[0].why, "overlaps"));
    expect_layers("blocks", &drawn, 2);
  }
  m.of[1].options.optics.contour_count = 0;
  assert_int_equal(stratus_ray_caster_render_blocks(inputs, 2, &m.of[0].camera, &image, reports), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(*state), "contour"));
  several_casters_destroy(&casters);
  several_destroy(&m);
}

/* ---- meshes. Fields are linear, so that surfaces are planes within a box. */

typedef struct linear_field {
  double slope[3], level; /* of the value, in the coordinates of the box */
  double low, high;       /* the box along each axis */
  double to_world[12];    /* rows of 4 */
} linear_field;

/* Finds the surfaces of a linear field on all rays: of three contours, or a slice across axis x of the world at `slice` (NAN: none). */
static void find_planes(const linear_field* field, const stratus_camera* camera, const double contours[3], double slice,
  const stratus_transfer* transfer, reference_layer* layers, int* number)
{
  const double* m = field->to_world;
  for (int i = 0; i < CASE_PIXELS; ++i) {
    const double u = (2.0 * (i % CASE_WIDTH) + 1.0) / CASE_WIDTH - 1.0, v = (2.0 * (i / CASE_WIDTH) + 1.0) / CASE_HEIGHT - 1.0;
    double origin[3], along[3], length = 0.0, from[3], way[3], start = field->level, rise = 0.0;
    for (int a = 0; a < 3; ++a) {
      const double side = u * camera->right[a] + v * camera->up[a];
      origin[a] = camera->eye[a] + (camera->parallel ? side : 0.0);
      along[a] = camera->forward[a] + (camera->parallel ? 0.0 : side);
      length += along[a] * along[a];
    }
    for (int a = 0; a < 3; ++a) { /* the matrix's columns are orthogonal */
      const double square = m[a] * m[a] + m[4 + a] * m[4 + a] + m[8 + a] * m[8 + a];
      from[a] = way[a] = 0.0;
      for (int r = 0; r < 3; ++r) {
        from[a] += m[4 * r + a] * (origin[r] - m[4 * r + 3]) / square;
        way[a] += m[4 * r + a] * along[r] / sqrt(length) / square;
      }
      start += field->slope[a] * from[a];
      rise += field->slope[a] * way[a];
    }
    number[i] = 0;
    for (int n = 0; n < (isnan(slice) ? 3 : 1); ++n) {
      reference_layer layer = { .t = isnan(slice) ? (contours[n] - start) / rise : (slice - origin[0]) / along[0] * sqrt(length) };
      const double value = start + rise * layer.t;
      bool inside = layer.t > 0.0;
      for (int a = 0; a < 3; ++a) {
        const double at = from[a] + layer.t * way[a];
        inside = inside && at > field->low && at < field->high;
      }
      const bool beyond = value < transfer->opacity[0] || value > transfer->opacity[2 * (transfer->opacity_count - 1)];
      layer.color[3] = beyond && !transfer->clamp ? 0.0 : linear_between(transfer->opacity, transfer->opacity_count, 2, 1, value);
      for (size_t c = 0; c < 3; ++c) {
        layer.color[c] = linear_between(transfer->color, transfer->color_count, 4, c + 1, value);
      }
      if (inside) {
        layers[i * MOST + number[i]++] = layer;
      }
    }
  }
}

static void set_linear(linear_field* field, const double* matrix, double high)
{
  memcpy(field->to_world, matrix, sizeof field->to_world);
  field->high = high;
}

/* Rows of value and opacity, and of value, red, green and blue, which have contour n's colour at its value. */
static void set_functions(const double* contours, const double* colors, double opacity[8], double color[12])
{
  for (int n = 0; n < 3; ++n) {
    opacity[2 * n] = color[4 * n] = contours[n];
    opacity[2 * n + 1] = colors[4 * n + 3];
    memcpy(color + 4 * n + 1, colors + 4 * n, 3 * sizeof *color);
  }
  opacity[6] = contours[2] + 1.0;
  opacity[7] = 0.5;
}

static void meshes_and_volumes_are_by_depth(void** state)
{
  static const double contours[3] = { 0.3, 0.5, 0.8 };
  static const double colors[2][12] = { { 1, 0.2, 0.1, 0.4, 0.3, 0.9, 0.2, 0.5, 0.1, 0.2, 1, 0.3 },
    { 0.9, 0.8, 0.1, 0.5, 0.1, 0.8, 0.9, 0.4, 1, 1, 1, 0.6 } };
  for (int run = 0; run < 4; ++run) {
    const int first = run % 2, cuts = run / 2; /* the mesh's place among the inputs, and the projection */
    const double slice = cuts ? 1.5 : (double)NAN;
    linear_field fields[2] = { { .slope = { 0.02, 0.02, 0.01 } }, { .slope = { 0.3, -0.1, 0.1 }, .level = 0.2 } };
    several_case m;
    tetra_case mesh;
    stratus_tetra_caster* tetra = NULL;
    stratus_ray_caster* caster = NULL;
    stratus_ray_cast_input inputs[2];
    stratus_ray_cast_report reports[2];
    several_create(*state, &m, 1, 960 + (uint32_t)first);
    const stratus_camera camera = m.of[0].camera;
    case_destroy(&m.of[0]);
    case_create(*state, &m.of[0], STRATUS_FLOAT32, 21, 21, 21, 3);
    m.of[0].volume.matrix[3] = m.of[0].volume.matrix[7] = m.of[0].volume.matrix[11] = -10.0;
    set_linear(&fields[0], m.of[0].volume.matrix, 20.0);
    for (int i = 0; i < 21 * 21 * 21; ++i) {
      ((float*)m.of[0].values)[i] = (float)(0.02 * (i % 21) + 0.02 * (i / 21 % 21) + 0.01 * (i / 441));
    }
    tetra_create(&mesh, 4, 0.0, 0.0, 5);
    const double turn[12] = { 4.0, -2.4, 0.0, -7.0, 2.4, 4.0, 0.0, -12.0, 0.0, 0.0, 5.0, -9.0 };
    memcpy(mesh.mesh.matrix, turn, sizeof turn);
    set_linear(&fields[1], turn, 4.0);
    for (int i = 0; i < 125; ++i) {
      mesh.values[i] = (float)(0.2 + 0.3 * (i % 5) - 0.1 * (i / 5 % 5) + 0.1 * (i / 25));
    }
    set_functions(contours, colors[0], m.of[0].opacity, m.of[0].color);
    set_functions(contours, colors[1], mesh.opacity, mesh.color);
    m.of[0].options.mode = cuts ? STRATUS_MODE_SLICE : STRATUS_MODE_ISOSURFACE;
    m.of[0].options.slice = mesh.options.slice = (stratus_slice){ .center = { 1.5 }, .linear = { 1.0 } };
    m.of[0].options.optics.contour_count = 3;
    memcpy(m.of[0].options.optics.contours, contours, sizeof contours);
    mesh.options.mode = cuts ? STRATUS_TETRA_SLICE : STRATUS_TETRA_ISOSURFACE;
    mesh.options.contour_count = 3;
    memcpy(mesh.options.contours, contours, sizeof contours);
    assert_int_equal(stratus_tetra_caster_create(*state, &tetra), STRATUS_OK);
    assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
    inputs[1 - first] =
      (stratus_ray_cast_input){ .caster = caster, .volume = &m.of[0].volume, .transfer = &m.of[0].transfer, .options = &m.of[0].options };
    inputs[first] =
      (stratus_ray_cast_input){ .tetra = tetra, .mesh = &mesh.mesh, .transfer = &mesh.transfer, .tetra_options = &mesh.options };
    const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba, .depth = drawn.depth };
    assert_int_equal(stratus_ray_caster_render_several(inputs, 2, &camera, &image, reports), STRATUS_OK);
    for (int n = 0; n < 2; ++n) {
      const int input = n == 0 ? 1 - first : first;
      find_planes(&fields[n], &camera, contours, slice, n ? &mesh.transfer : &m.of[0].transfer, found[input], counts[input]);
    }
    for (int i = 0; i < CASE_PIXELS; ++i) {
      reach[i] = (double)INFINITY;
    }
    expect_layers(cuts ? "one slice of an image and tetrahedra" : "planes in an image and tetrahedra", &drawn, 2);
    stratus_ray_caster_destroy(caster);
    stratus_tetra_caster_destroy(tetra);
    tetra_destroy(&mesh);
    several_destroy(&m);
  }
}

static void each_allocation_may_fail(void** state)
{
  several_case m;
  create(*state, &m, 2, STRATUS_MODE_ISOSURFACE, 970);
  several_each_allocation_may_fail(&m);
  several_destroy(&m);
}

int test_ray_layers(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(surfaces_are_by_depth),
    cmocka_unit_test(surfaces_at_one_depth_are_in_the_order_of_inputs),
    cmocka_unit_test(geometry_ends_rays_among_surfaces),
    cmocka_unit_test(nothing_is_drawn_behind_opaque_surfaces),
    cmocka_unit_test(surfaces_of_overlapping_blocks_are_by_depth),
    cmocka_unit_test(meshes_and_volumes_are_by_depth),
    cmocka_unit_test(each_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
