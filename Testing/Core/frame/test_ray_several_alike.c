/* SPDX-License-Identifier: BSD-3-Clause
 * Volumes and meshes among several show what they show alone: with another input that is empty, the picture is the ordinary one but for
 * rounding. Where several overlap, the double reference says what they show. */
#include "mixed_case.h"

#include "testing.h"

static picture drawn, other, first;
static mixed_case m;

static float largest_difference(const picture* a, const picture* b)
{
  float largest = 0.0f;
  for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
    largest = fmaxf(largest, fabsf(a->rgba[i] - b->rgba[i]));
  }
  return largest;
}

static void empty(picture_case* c)
{
  memset(c->opacity, 0, sizeof c->opacity);
  c->transfer.opacity_count = 1;
}

/* Draws a volume beside an empty one, by samples that are as long as the ordinary picture's, and by each structure, which changes no bit.
 * Returns by how much the picture differs from the ordinary one. */
static float beside_nothing(void** state, several_case* pair, const stratus_transfer* transfers)
{
  picture_case* c = &pair->of[0];
  float difference;
  pair->count = 2;
  pair->transfers[0] = transfers;
  pair->transfers[1] = NULL;
  case_create(*state, &pair->of[1], STRATUS_FLOAT32, 17, 20, 23, 6);
  empty(&pair->of[1]);
  pair->of[1].options.sampling.distance = 100.0;
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = other.rgba, .depth = other.depth };
  stratus_ray_caster* caster = NULL;
  assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
  assert_int_equal(
    stratus_ray_caster_render(caster, &c->volume, transfers ? transfers : &c->transfer, &c->camera, &c->options, &image, NULL), STRATUS_OK);
  stratus_ray_caster_destroy(caster);
  several_draw(*state, pair, &drawn);
  difference = largest_difference(&drawn, &other);
  assert_true(case_lit(&drawn) > case_share(50));
  for (int i = 0; i < CASE_PIXELS; ++i) {
    assert_true(drawn.depth[i] == other.depth[i] || fabsf(drawn.depth[i] - other.depth[i]) < 1e-3f);
  }
  for (int structure = STRATUS_STRUCTURE_NONE; structure <= STRATUS_STRUCTURE_HYBRID; structure += few_run() ? 3 : 1) {
    pair->of[0].options.skipping.structure = pair->of[1].options.skipping.structure = (stratus_structure)structure;
    several_draw(*state, pair, &other);
    assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
    assert_memory_equal(drawn.depth, other.depth, sizeof drawn.depth);
  }
  case_destroy(&pair->of[1]);
  return difference;
}

/* ---- crop regions */

/* The sets that VTK has names for, and one that leaves four pieces of some rays. */
static const uint32_t regions[] = { 0x5ffdfffu, 0x0417410u, 0x7ebfbefu, 0x2ebfebau, 0x5140145u, 0x5555555u };

static void crop_between(int crops, stratus_ray_clipping_options* clipping, uint32_t shown, const int64_t dimensions[3])
{
  clipping->crop = crops;
  clipping->crop_regions = shown;
  for (int a = 0; a < 3; ++a) {
    clipping->crop_bounds[2 * a] = 0.31 * (double)dimensions[a];
    clipping->crop_bounds[2 * a + 1] = 0.63 * (double)dimensions[a];
  }
}

static void crop_regions_of_volumes_are_as_alone(void** state)
{
  static const stratus_sampling rules[] = { STRATUS_SAMPLING_MIDPOINT, STRATUS_SAMPLING_PREINTEGRATED, STRATUS_SAMPLING_CELLS };
  several_case pair;
  for (int i = few_run() ? 4 : 0; i < 6; ++i) {
    for (int rule = 0; rule < 3; ++rule) {
      picture_case* c = &pair.of[0];
      case_create(*state, c, STRATUS_FLOAT32, 23, 29, 21, 61u + (uint32_t)i);
      crop_between(1, &c->options.clipping, regions[i], c->volume.dimensions);
      c->opacity[1] = c->opacity[3] = 0.03; /* every value shows */
      c->options.sampling.rule = rules[rule];
      c->options.sampling.cell_error = 1e-5;
      case_camera(*state, c, i + rule, i % 2);
      const float difference = beside_nothing(state, &pair, NULL);
      print_message("             regions 0x%07x, %s: %g\n", (unsigned)regions[i], stratus_sampling_name(rules[rule]), (double)difference);
      assert_true(difference < 4e-6f);
      case_destroy(c);
    }
  }
}

/* dB against the reference, of steps of a tenth where voxels are about a unit, as with planes that cut single volumes. */
#define REGIONS_DB 70.0

static void crop_regions_mix_as_the_reference_does(void** state)
{
  for (uint32_t seed = 0; seed < 4; seed += few_run() ? 2 : 1) {
    several_case v;
    char what[48];
    several_create(*state, &v, 2 + (int)(seed % 2), 620 + seed);
    for (int n = 0; n < v.count; ++n) {
      v.of[n].options.sampling.distance = 0.05;
      crop_between(n < 2, &v.of[n].options.clipping, regions[(seed + 3u * (uint32_t)n) % 6u], v.of[n].volume.dimensions);
    }
    v.of[1].options.sampling.distance = 0.11; /* a sample spans two segments */
    snprintf(what, sizeof what, "regions, seed %u, %d volumes", seed, v.count);
    assert_true(several_psnr(what, *state, &v, &drawn) >= REGIONS_DB);
    assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
    several_destroy(&v);
  }
}

/* Eight volumes of four pieces each, and none of which a region shows. */
static void many_pieces_and_none(void** state)
{
  several_case v;
  several_create(*state, &v, 8, 640);
  for (int n = 0; n < v.count; ++n) {
    v.of[n].options.sampling.distance = 0.1;
    crop_between(1, &v.of[n].options.clipping, 0x5555555u, v.of[n].volume.dimensions);
  }
  assert_true(several_psnr("eight volumes", *state, &v, &drawn) >= REGIONS_DB);
  assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
  for (int n = 0; n < v.count; ++n) {
    v.of[n].options.clipping.crop_regions = 0;
  }
  several_draw(*state, &v, &drawn);
  assert_int_equal(case_lit(&drawn), 0);
  several_destroy(&v);
}

/* ---- gradients */

static void thin(picture_case* c, double flat, double steep)
{
  static double points[STRATUS_SEVERAL_MAX][4];
  static int next;
  double* own = points[next++ % STRATUS_SEVERAL_MAX];
  own[0] = 0.0;
  own[1] = flat;
  own[2] = 0.1 * case_type_values[c->volume.type].scale;
  own[3] = steep;
  c->transfer.gradient = own;
  c->transfer.gradient_count = 2;
}

/* Opacity 1 above a part of the range. */
static void wall(picture_case* c)
{
  const double base = case_type_values[c->volume.type].base, scale = case_type_values[c->volume.type].scale;
  const double opacity[8] = { base - scale, 0, base + 0.2 * scale, 0.1, base + 0.2 * scale, 1.0, base + scale, 1.0 };
  memcpy(c->opacity, opacity, sizeof opacity);
}

static void gradient_opacity_over_a_length_is_as_alone(void** state)
{
  several_case pair;
  for (int i = few_run() ? 1 : 0; i < 6; i += few_run() ? 2 : 1) {
    static stratus_transfer twice[2];
    picture_case* c = &pair.of[0];
    case_create(*state, c, STRATUS_INT16, 23, 29, 21, 71u + (uint32_t)i);
    thin(c, 0.1, 0.9);
    c->options.optics.gradient_distance = i % 2 ? 0.7 : 4.0;
    c->options.light.shade = i % 3 == 1;
    if (i == 3) {
      wall(c);
    }
    if (i >= 4) { /* two components */
      int16_t* values = calloc(2 * 23 * 29 * 21, sizeof *values);
      assert_non_null(values);
      for (int64_t v = 0; v < 23 * 29 * 21; ++v) {
        values[2 * v] = values[2 * v + 1] = ((const int16_t*)c->values)[v];
      }
      free(c->values);
      c->values = values;
      c->volume.values = values;
      c->volume.components = 2;
      c->volume.value_stride = 2;
      twice[0] = twice[1] = c->transfer;
      twice[1].unit_distance = 2.5;
    }
    const float difference = beside_nothing(state, &pair, i >= 4 ? twice : NULL);
    print_message("             over a length of %g: %g\n", c->options.optics.gradient_distance, (double)difference);
    assert_true(difference < 4e-6f);
    first = drawn;
    c->options.optics.gradient_distance = 0.0; /* of optical depths it is another picture */
    (void)beside_nothing(state, &pair, i >= 4 ? twice : NULL);
    assert_true(largest_difference(&first, &drawn) > 0.005f);
    case_destroy(c);
  }
}

/* Clip planes that hide the values before and behind a place change its gradient, and so light and gradient opacity. */
static void gradients_that_clip_planes_change_are_as_alone(void** state)
{
  several_case pair;
  for (int i = few_run() ? 2 : 0; i < 4; ++i) {
    picture_case* c = &pair.of[0];
    case_create(*state, c, i % 2 ? STRATUS_FLOAT32 : STRATUS_UINT8, 23, 29, 21, 81u + (uint32_t)i);
    c->options.sampling.rule = i % 2 ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT;
    c->options.light.shade = i != 2;
    if (i > 1) {
      thin(c, 0.1, 0.9);
    }
    c->options.clipping.clip_plane_count = 1;
    c->options.clipping.clip_gradients = 1;
    c->options.clipping.clipped_value = case_type_values[c->volume.type].base - 2.0 * case_type_values[c->volume.type].scale;
    memcpy(c->options.clipping.clip_planes[0], (const double[4]){ 0.3, 0.8, -0.5, -4.0 }, sizeof c->options.clipping.clip_planes[0]);
    const float difference = beside_nothing(state, &pair, NULL);
    print_message("             clipped gradients: %g\n", (double)difference);
    assert_true(difference < 4e-6f);
    c->options.clipping.clip_gradients = 0;
    case_render(*state, c, &other); /* they count */
    assert_true(largest_difference(&drawn, &other) > 0.01f);
    case_destroy(c);
  }
}

/* Both overlap another volume, of another step. */
static void gradients_mix_as_the_reference_does(void** state)
{
  for (uint32_t seed = 0; seed < 4; seed += few_run() ? 3 : 1) {
    several_case v;
    char what[48];
    several_create(*state, &v, 2, 670 + seed);
    for (int n = 0; n < v.count; ++n) {
      stratus_ray_clipping_options* clipping = &v.of[n].options.clipping;
      v.of[n].options.sampling.distance = n == 0 ? 0.05 : 0.11;
      thin(&v.of[n], 0.1, 0.9);
      v.of[n].options.light.shade = seed % 2 == 0;
      v.of[n].options.optics.gradient_distance = n == 0 || seed > 1 ? 1.5 : 0.0;
      if (n == 1) {
        clipping->clip_plane_count = clipping->clip_gradients = 1;
        clipping->clipped_value = case_type_values[v.of[n].volume.type].base - case_type_values[v.of[n].volume.type].scale;
        memcpy(clipping->clip_planes[0], (const double[4]){ 0.3, 0.8, -0.5, 2.0 }, sizeof clipping->clip_planes[0]);
      }
    }
    snprintf(what, sizeof what, "gradients, seed %u", seed);
    assert_true(several_psnr(what, *state, &v, &drawn) >= REGIONS_DB);
    assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
    several_destroy(&v);
  }
}

/* ---- light by cells */

/* dB at the spread of light that the default tolerance asks for: the ordinary picture shares places of light between pieces. Measured: 82
 * to 118. */
#define LIT_CELLS_DB 75.0

static void set_lit_cells(picture_case* c)
{
  c->options.sampling.rule = STRATUS_SAMPLING_CELLS;
  c->options.sampling.cell_error = 1e-4;
  c->options.light.shade = 1;
  c->options.light.shading.specular = 0.3;
}

static void light_by_cells_is_as_alone(void** state)
{
  several_case pair;
  for (int i = few_run() ? 2 : 0; i < 4; ++i) {
    picture_case* c = &pair.of[0];
    case_create(*state, c, i % 2 ? STRATUS_FLOAT32 : STRATUS_UINT8, 23, 29, 21, 91u + (uint32_t)i);
    set_lit_cells(c);
    if (i == 3) {
      wall(c);
    }
    c->options.sampling.light_spread = 1e-6; /* each piece has its own place, then, as among several */
    const float difference = beside_nothing(state, &pair, NULL);
    assert_int_equal(drawn.report.sampling, STRATUS_SAMPLING_CELLS);
    case_render(*state, c, &other);
    const double db = reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS);
    print_message("             lit by cells: %g, %.1f dB\n", (double)difference, db);
    assert_true(db >= LIT_CELLS_DB);
    case_destroy(c);
  }
}

/* Together with a volume that is lit by samples, or by cells, too. */
static void light_by_cells_mixes_as_the_reference_does(void** state)
{
  for (uint32_t seed = 0; seed < 4; seed += few_run() ? 3 : 1) {
    several_case v;
    char what[48];
    several_create(*state, &v, 2, 690 + seed);
    set_lit_cells(&v.of[0]);
    v.of[1].options.light.shade = 1;
    v.of[1].options.sampling.distance = 0.05;
    if (seed > 1) {
      set_lit_cells(&v.of[1]);
    }
    snprintf(what, sizeof what, "lit by cells, seed %u", seed);
    assert_true(several_psnr(what, *state, &v, &drawn) >= LIT_CELLS_DB);
    assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
    several_destroy(&v);
  }
}

/* ---- meshes */

/* Draws the first mesh beside an empty volume, and without volumes. Returns by how much the pictures differ from its own. */
static float mesh_beside_nothing(void** state)
{
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = other.rgba, .depth = other.depth };
  tetra_case* c = &m.meshes[0];
  float most = 0.0f;
  empty(&m.volumes.of[0]);
  c->options.tolerance = 1e-5;
  assert_int_equal(stratus_tetra_caster_render(m.tetra[0], &c->mesh, m.transfers[0] ? m.transfers[0] : &c->transfer,
                     &m.volumes.of[0].camera, &c->options, &image, NULL),
    STRATUS_OK);
  for (int volumes = 1; volumes >= 0; --volumes) {
    m.volumes.count = volumes;
    const stratus_status status = mixed_draw(&m, &drawn);
    if (status != STRATUS_OK) {
      print_error("%s\n", stratus_context_message(*state));
    }
    assert_int_equal(status, STRATUS_OK);
    most = fmaxf(most, largest_difference(&drawn, &other));
    for (int i = 0; i < CASE_PIXELS; ++i) {
      /* a piece of a cell that shows nothing begins no depth; the mesh's own caster takes the cell's beginning */
      assert_true(drawn.depth[i] == other.depth[i] || fabsf(drawn.depth[i] - other.depth[i]) < 1e-3f ||
        ((c->transfer.gradient_count > 0 || c->options.label_count > 0) && drawn.depth[i] > other.depth[i]));
    }
  }
  m.volumes.count = 1;
  assert_true(case_lit(&drawn) > case_share(50));
  return most;
}

/* Both round values to the entries of one table, in different ways. */
#define MESH_DIFFERENCE 1e-3f

static void crop_mesh(tetra_case* c, uint32_t shown)
{
  c->options.crop = 1;
  c->options.crop_regions = shown;
  for (int a = 0; a < 3; ++a) {
    c->options.crop_bounds[2 * a] = 0.9;
    c->options.crop_bounds[2 * a + 1] = 2.1;
  }
}

static void crop_regions_of_meshes_are_as_alone(void** state)
{
  for (int i = few_run() ? 4 : 0; i < 6; ++i) {
    mixed_create(*state, &m, 1, 1, 650 + (uint32_t)i);
    crop_mesh(&m.meshes[0], regions[i]);
    m.meshes[0].options.shade = i % 2;
    const float difference = mesh_beside_nothing(state);
    print_message("             a mesh of regions 0x%07x: %g\n", (unsigned)regions[i], (double)difference);
    assert_true(difference < MESH_DIFFERENCE);
    m.meshes[0].options.crop_regions = 0;
    assert_int_equal(mixed_draw(&m, &drawn), STRATUS_OK);
    assert_int_equal(case_lit(&drawn), 0);
    mixed_destroy(&m);
  }
}

static void gradient_opacity_of_meshes_over_a_length_is_as_alone(void** state)
{
  static const double points[6] = { 0.05, 0.0, 0.25, 0.6, 0.6, 1.0 };
  for (uint32_t i = few_run() ? 3 : 0; i < 6; i += few_run() ? 2 : 1) {
    mixed_create(*state, &m, 1, 1, 680 + i);
    tetra_case* c = &m.meshes[0];
    c->transfer.gradient = points;
    c->transfer.gradient_count = 3;
    c->options.gradient_distance = i % 2 ? 2.5 : -1.0;
    c->options.shade = i % 3 == 1;
    const bool walls = i == 3 || i == 5;
    if (walls) {
      const double opacity[8] = { 0.0, 0.0, 0.5, 0.1, 0.5, 1.0, 1.0, 1.0 };
      memcpy(c->opacity, opacity, sizeof opacity);
    }
    const float difference = mesh_beside_nothing(state);
    const double db = reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS);
    print_message("             a mesh over a length of %g: %g, %.1f dB\n", c->options.gradient_distance, (double)difference, db);
    /* where a ray grazes a wall, an entry of the table more or less is a part of its way */
    assert_true(walls ? db > 65.0 : difference < MESH_DIFFERENCE);
    c->options.gradient_distance = 0.0;
    assert_int_equal(mixed_draw(&m, &other), STRATUS_OK);
    assert_true(largest_difference(&drawn, &other) > 0.01f);
    mixed_destroy(&m);
  }
}

/* Functions of labels 0, 1 and 2 with peaks, opacity 1, and little of all. Cells have labels up to 3. */
typedef struct labels {
  stratus_transfer transfers[3];
  uint8_t of[6 * 4 * 4 * 4];
} labels;

static void label_mesh(tetra_case* c, labels* l)
{
  static const double opacity[3][6] = { { 0.2, 0.0, 0.5, 0.3, 1.0, 0.4 }, { 0.3, 0.0, 0.6, 1.0, 1.0, 1.0 },
    { 0.0, 0.2, 0.6, 0.0, 1.0, 0.5 } };
  static const double colors[3][8] = { { 0.0, 1.0, 0.2, 0.1, 1.0, 0.9, 0.9, 0.1 }, { 0.0, 0.1, 0.3, 1.0, 1.0, 0.2, 1.0, 0.4 },
    { 0.2, 0.9, 0.1, 0.8, 0.7, 0.3, 0.3, 0.3 } };
  uint32_t random = 11u;
  for (int f = 0; f < 3; ++f) {
    l->transfers[f] = c->transfer;
    l->transfers[f].opacity = opacity[f];
    l->transfers[f].opacity_count = 3;
    l->transfers[f].color = colors[f];
    l->transfers[f].color_count = 2;
  }
  for (int64_t cell = 0; cell < c->mesh.cell_count; ++cell) {
    l->of[cell] = (uint8_t)tetra_uniform(&random, 0.0, 3.999);
  }
  c->mesh.labels = l->of;
  c->options.label_count = 2;
}

static void labels_of_meshes_are_as_alone(void** state)
{
  static const double thin_points[2][6] = { { 0.1, 0.0, 0.5, 0.6, 1.2, 1.0 }, { 0.0, 1.0, 0.2, 0.3, 5.0, 0.9 } };
  static labels l;
  for (uint32_t i = few_run() ? 2 : 0; i < 8; i += few_run() ? 3 : 1) {
    mixed_create(*state, &m, 1, 1, 720 + i);
    tetra_case* c = &m.meshes[0];
    label_mesh(c, &l);
    m.transfers[0] = l.transfers;
    c->options.shade = i % 3 == 1;
    c->mesh.cell_values = i == 3;
    for (int n = 0; n < 2 && i > 3; ++n) { /* label 2 has the gradient opacity of label 0 */
      l.transfers[n].gradient = thin_points[n];
      l.transfers[n].gradient_count = 3;
      c->options.gradient_distance = i > 5 ? 2.5 : 0.0;
    }
    const float difference = mesh_beside_nothing(state);
    const double db = reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS);
    print_message("             labels %u: %g, %.1f dB\n", i, (double)difference, db);
    assert_true(difference < MESH_DIFFERENCE);
    mixed_destroy(&m);
  }
}

/* A mesh of labels is as many meshes, each of which shows the cells of one label, together with a volume that overlaps them. */
static void labels_are_meshes_of_their_cells(void** state)
{
  static labels l;
  for (uint32_t i = 0; i < 3; i += few_run() ? 2 : 1) {
    mixed_create(*state, &m, 1, 1, 730 + i);
    label_mesh(&m.meshes[0], &l);
    m.transfers[0] = l.transfers;
    m.meshes[0].options.tolerance = 1e-5;
    const stratus_status status = mixed_draw(&m, &drawn);
    if (status != STRATUS_OK) {
      print_error("%s\n", stratus_context_message(*state));
    }
    assert_int_equal(status, STRATUS_OK);
    mixed_destroy(&m);
    mixed_create(*state, &m, 1, 3, 730 + i);
    for (int n = 0; n < 3; ++n) {
      tetra_case* c = &m.meshes[n];
      tetra_destroy(c);
      tetra_create(c, 3, 0.2, 0.1, 730 + i);
      place_mesh(c, 3, (730 + i) % 5u);
      label_mesh(c, &l);
      for (int64_t cell = 0; cell < c->mesh.cell_count; ++cell) {
        c->hidden[cell] = (l.of[cell] < 3 ? l.of[cell] : 0) != n;
      }
      c->mesh.hidden = c->hidden;
      c->mesh.labels = NULL;
      c->options.label_count = 0;
      c->options.tolerance = 1e-5;
      m.transfers[n] = l.transfers + n;
    }
    assert_int_equal(mixed_draw(&m, &other), STRATUS_OK);
    const double db = reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS);
    print_message("             three meshes: %g, %.1f dB\n", (double)largest_difference(&drawn, &other), db);
    assert_true(case_lit(&drawn) > case_share(500));
    assert_true(largest_difference(&drawn, &other) < MESH_DIFFERENCE);
    mixed_destroy(&m);
  }
}

/* ---- dependent components of meshes in all modes */

/* A mesh by itself, in pictures of several: as its own caster draws it. */
static void dependent_components_of_meshes_are_as_alone(void** state)
{
  static const stratus_tetra_mode modes[] = { STRATUS_TETRA_MAXIMUM, STRATUS_TETRA_MINIMUM, STRATUS_TETRA_AVERAGE, STRATUS_TETRA_ADDITIVE,
    STRATUS_TETRA_ISOSURFACE, STRATUS_TETRA_SLICE, STRATUS_TETRA_FIRST_HIT };
  static float values[4 * 64];
  for (int i = 0; i < 14; i += few_run() ? 3 : 1) {
    const int components = i < 7 ? 2 : 4, mode = i % 7;
    const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = other.rgba, .depth = other.depth };
    mixed_create(*state, &m, 0, 1, 700 + (uint32_t)i);
    tetra_case* c = &m.meshes[0];
    for (int64_t v = 0; v < c->mesh.point_count; ++v) {
      for (int of = 0; of + 1 < components; ++of) {
        const double wave = 0.5 + 0.4 * sin(1.3 * (double)v + of);
        values[components * v + of] = (float)(components == 4 ? 255.0 * wave : wave);
      }
      values[components * v + components - 1] = c->values[v];
    }
    c->mesh.values = values;
    c->mesh.value_stride = c->mesh.components = components;
    c->options.dependent = 1;
    c->options.mode = modes[mode];
    c->options.contour_count = 2;
    c->options.contours[0] = 0.4;
    c->options.contours[1] = 0.7;
    c->options.slice = (stratus_slice){ .square = { 1, 1, 1 }, .constant = -40.0 };
    c->transfer.unit_distance = 40.0;
    c->options.average_range[0] = components == 4 ? 60.0 : 0.2;
    if (modes[mode] == STRATUS_TETRA_FIRST_HIT) {
      const double opacity[8] = { 0.0, 0.0, 0.5, 0.0, 0.5, 1.0, 1.0, 1.0 };
      memcpy(c->opacity, opacity, sizeof opacity);
    }
    assert_int_equal(
      stratus_tetra_caster_render(m.tetra[0], &c->mesh, &c->transfer, &m.volumes.of[0].camera, &c->options, &image, NULL), STRATUS_OK);
    const stratus_status status = mixed_draw(&m, &drawn);
    if (status != STRATUS_OK) {
      print_error("%s\n", stratus_context_message(*state));
    }
    assert_int_equal(status, STRATUS_OK);
    print_message("             %s of %d dependent components: %g, %d pixels\n", stratus_tetra_mode_name(modes[mode]), components,
      (double)largest_difference(&drawn, &other), case_lit(&drawn));
    assert_true(case_lit(&drawn) > case_share(50));
    assert_true(largest_difference(&drawn, &other) < MESH_DIFFERENCE);
    mixed_destroy(&m);
  }
}

/* ---- both */

/* A volume and a mesh that do not overlap lie over each other. */
static void cropped_inputs_apart_lie_over_each_other(void** state)
{
  static picture front;
  mixed_create(*state, &m, 1, 1, 660);
  picture_case* c = &m.volumes.of[0];
  tetra_case* mesh = &m.meshes[0];
  const double eye[3] = { 60, 2, 1 }, focal[3] = { 0, 0, 0 }, up[3] = { 0, 0.2, 1 };
  assert_int_equal(stratus_camera_perspective(*state, eye, focal, up, 44.0, 1.2, &c->camera), STRATUS_OK);
  crop_between(1, &c->options.clipping, 0x2ebfebau, c->volume.dimensions);
  crop_mesh(mesh, regions[0]);
  for (int i = 0; i < 12; ++i) {
    mesh->mesh.matrix[i] *= i % 4 == 3 ? 1.0 : 1.8;
  }
  mesh->mesh.matrix[3] -= 70.0; /* behind the volume, through which it is seen */
  c->transfer.unit_distance = 40.0;
  mesh->options.tolerance = 1e-5;
  assert_int_equal(mixed_draw(&m, &drawn), STRATUS_OK);
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = other.rgba, .depth = other.depth };
  assert_int_equal(
    stratus_tetra_caster_render(m.tetra[0], &mesh->mesh, &mesh->transfer, &c->camera, &mesh->options, &image, NULL), STRATUS_OK);
  case_render(*state, c, &front);
  int behind = 0;
  assert_true(case_lit(&front) > case_share(100));
  for (int i = 0; i < CASE_PIXELS; ++i) {
    const float left = 1.0f - front.rgba[4 * i + 3];
    for (int channel = 0; channel < 4; ++channel) {
      other.rgba[4 * i + channel] = front.rgba[4 * i + channel] + left * other.rgba[4 * i + channel];
    }
    behind += left < 1.0f && other.rgba[4 * i + 3] > front.rgba[4 * i + 3];
  }
  print_message("             over each other: %g, %d pixels\n", (double)largest_difference(&drawn, &other), behind);
  assert_true(behind > case_share(40));
  assert_true(largest_difference(&drawn, &other) < MESH_DIFFERENCE);
  mixed_destroy(&m);
}

int test_ray_several_alike(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(crop_regions_of_volumes_are_as_alone),
    cmocka_unit_test(crop_regions_mix_as_the_reference_does),
    cmocka_unit_test(many_pieces_and_none),
    cmocka_unit_test(gradient_opacity_over_a_length_is_as_alone),
    cmocka_unit_test(gradients_that_clip_planes_change_are_as_alone),
    cmocka_unit_test(gradients_mix_as_the_reference_does),
    cmocka_unit_test(light_by_cells_is_as_alone),
    cmocka_unit_test(light_by_cells_mixes_as_the_reference_does),
    cmocka_unit_test(crop_regions_of_meshes_are_as_alone),
    cmocka_unit_test(gradient_opacity_of_meshes_over_a_length_is_as_alone),
    cmocka_unit_test(labels_of_meshes_are_as_alone),
    cmocka_unit_test(labels_are_meshes_of_their_cells),
    cmocka_unit_test(dependent_components_of_meshes_are_as_alone),
    cmocka_unit_test(cropped_inputs_apart_lie_over_each_other),
  };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
