/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures of several volumes by the OpenCL device equal the host's to the bit, by packets and by one work item a ray, of one type of
 * values and of different ones, and with meshes among them. The device keeps unchanged data, and the host draws pictures that the device
 * cannot draw. */
#define CASE_FULL_SIZE
#include "grid_case.h"
#include "mixed_case.h"
#include "transfer_2d_case.h"
#include "testing.h"

#include "device_state.h"

static picture on_host, on_device;
static stratus_ray_cast_report reports[STRATUS_SEVERAL_MAX];

/* Two to four volumes: of one type where seed is even, with light, gradient opacity, jitter, crop regions, stretched grids and walls in
 * turn. */
static void make_case(stratus_context* context, uint32_t seed, several_case* m, grid_case* grid)
{
  static const double gradient[4] = { 0.0, 0.2, 1e9, 1.0 };
  uint32_t random = seed;
  several_create(context, m, 2 + (int)(seed % 3), 700 + seed);
  const stratus_camera camera = m->of[0].camera;
  for (int n = 0; n < m->count; ++n) {
    picture_case* c = &m->of[n];
    if (seed % 2 == 0) {
      const stratus_type type = (stratus_type)(seed / 2 % 10);
      case_destroy(c);
      case_create(context, c, type, 20 + 3 * n, 24, 31 - 2 * n, seed + (uint32_t)n);
      several_place(c, seed + 17u * (uint32_t)n);
      several_color(c, n);
    }
    c->options.sampling.rule = (seed + (uint32_t)n) % 3 ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT;
    c->options.sampling.distance = n == 1 ? 0.9 : 0.4;
    c->options.skipping.structure = (stratus_structure)(STRATUS_STRUCTURE_AUTO + (seed + (uint32_t)n) % 6);
    c->options.light.shade = (seed + (uint32_t)n) % 4 == 0;
    c->transfer.gradient = gradient;
    c->transfer.gradient_count = (seed + (uint32_t)n) % 5 == 0 ? 2 : 0;
    c->options.optics.gradient_distance = seed % 2 ? 0.0 : 1.5;
  }
  m->of[0].camera = camera;
  m->of[0].options.skipping.audit = 1;
  m->of[0].options.sampling.jitter = seed % 3 == 0;
  if (seed % 4 == 0) { /* lit, with gradients that a clip plane changes */
    stratus_ray_clipping_options* clipping = &m->of[0].options.clipping;
    m->of[0].options.light.shade = clipping->clip_plane_count = clipping->clip_gradients = 1;
    memcpy(clipping->clip_planes[0], (const double[4]){ 0.3, 0.8, -0.5, 2.0 }, sizeof clipping->clip_planes[0]);
  }
  if (seed % 4 == 1) { /* a wall */
    picture_case* c = &m->of[1];
    const double base = case_type_values[c->volume.type].base, scale = case_type_values[c->volume.type].scale;
    const double opacity[8] = { base - scale, 0, base + 0.2 * scale, 0.1, base + 0.2 * scale, 1.0, base + scale, 1.0 };
    memcpy(c->opacity, opacity, sizeof opacity);
  }
  if (seed % 3 == 0) { /* crop regions */
    stratus_ray_clipping_options* clipping = &m->of[1].options.clipping;
    clipping->crop = 1;
    clipping->crop_regions = 0x5555555u;
    memcpy(clipping->crop_bounds, (const double[6]){ 6, 14, 7, 15, 9, 17 }, sizeof clipping->crop_bounds);
  }
  if (seed % 4 == 2) {
    grid_case_set(&m->of[0], grid, GRID_GEOMETRIC, 3, -10.0, 1.0, 20.0, &random);
  }
}

/* Sharp functions by cells (seed below 3; 0: lit), clouds of haze with a rough box by rule local, and nearest values by boxes, together
 * with a volume by samples. */
static void make_sharp_case(stratus_context* context, uint32_t seed, several_case* m)
{
  several_create(context, m, 2, 720 + seed);
  picture_case* c = &m->of[seed % 2];
  const stratus_camera camera = m->of[0].camera;
  const double base = case_type_values[c->volume.type].base, scale = case_type_values[c->volume.type].scale;
  const double functions[3][8] = { { base + 0.1 * scale, 0, base + 0.13 * scale, 0.8, base + 0.16 * scale, 0, base + scale, 0 },
    { base + 0.1 * scale, 0, base + 0.1 * scale, 0.4, base + 0.18 * scale, 0.4, base + 0.18 * scale, 0 },
    { base - scale, 0.005, base + 0.15 * scale, 0.01, base + 0.15 * scale, 1.0, base + scale, 1.0 } };
  if (seed < 3) {
    memcpy(c->opacity, functions[seed], sizeof c->opacity);
  }
  c->options.sampling.rule = STRATUS_SAMPLING_CELLS;
  c->options.sampling.cell_error = 0.001;
  c->options.light.shade = seed == 0;
  if (seed == 3) {
    case_destroy(c);
    case_create_local(context, 43, c);
    c->options.clipping.crop = 0;
    several_place(c, seed);
  }
  if (seed == 4) {
    c->options.sampling.interpolation = STRATUS_INTERPOLATION_NEAREST;
  }
  m->of[0].camera = camera;
  m->of[0].options.skipping.audit = 1;
  m->of[0].options.sampling.jitter = seed == 2;
}

/* A function of two variables (seed 0), components and labels, together with a volume of one medium. */
typedef struct media_case {
  stratus_transfer transfers[3];
  transfer_2d_case function;
  uint8_t labels[40 * 40 * 40];
} media_case;

static void make_media_case(stratus_context* context, uint32_t seed, several_case* m, media_case* media)
{
  several_create(context, m, 2, 740 + seed);
  picture_case* c = &m->of[seed % 2];
  media->function.pairs = NULL;
  c->options.sampling.rule = STRATUS_SAMPLING_MIDPOINT;
  c->options.light.shade = seed % 2 == 0;
  if (seed < 2) {
    transfer_2d_case_set(c, &media->function, 12 + seed, 0.25);
  } else if (seed == 2) {
    transfer_2d_case_pair(c, &media->function, 77);
  } else {
    for (size_t v = 0; v < sizeof media->labels; ++v) {
      media->labels[v] = (uint8_t)(v / 7 % 3);
    }
    c->options.mask.bytes = media->labels;
    c->options.mask.label_count = 2;
  }
  for (int i = 0; i < 3; ++i) {
    media->transfers[i] = c->transfer;
    media->transfers[i].unit_distance = 2.0 + i;
  }
  m->transfers[seed % 2] = media->transfers;
  m->of[0].options.skipping.audit = 1;
}

/* Modes whose rays keep a number or surfaces. */
static void make_kept_case(stratus_context* context, uint32_t seed, several_case* m)
{
  static const stratus_mode modes[] = { STRATUS_MODE_ADDITIVE, STRATUS_MODE_MAXIMUM, STRATUS_MODE_MINIMUM, STRATUS_MODE_AVERAGE,
    STRATUS_MODE_FIRST_HIT, STRATUS_MODE_ISOSURFACE, STRATUS_MODE_SLICE };
  several_create(context, m, 3, 760 + seed);
  for (int n = 0; n < m->count; ++n) {
    m->of[n].options.mode = modes[seed];
    const double base = case_type_values[m->of[n].volume.type].base, scale = case_type_values[m->of[n].volume.type].scale;
    m->of[n].options.sampling.rule = STRATUS_SAMPLING_AUTO;
    m->of[n].options.skipping.audit = 1;
    m->of[n].options.optics.contour_count = 2;
    m->of[n].options.optics.contours[0] = base + 0.1 * scale;
    m->of[n].options.optics.contours[1] = base + 0.25 * scale;
    m->of[n].options.light.shade = seed == 5;
    m->of[n].options.slice = (stratus_slice){ .square = { 1, 1, 1 }, .constant = -80.0 - 20.0 * n };
  }
}

/* Samples are not compared: which of them a packet leaps over depends on its width. */
static int differing(void)
{
  int count = 0;
  for (int i = 0; i < CASE_PIXELS; ++i) {
    count += memcmp(on_host.rgba + 4 * i, on_device.rgba + 4 * i, 4 * sizeof(float)) != 0 || on_host.depth[i] != on_device.depth[i];
  }
  return count;
}

typedef enum compared { PLAIN, SHARP, MEDIA, KEPT } compared;

static void compare(compared what, bool one_ray)
{
  static const uint32_t seeds[] = { [PLAIN] = 9, [SHARP] = 5, [MEDIA] = 4, [KEPT] = 7 };
  static media_case media;
  stratus_context* host = case_context("host", 2);
  stratus_context* device = case_context("0", 2);
  assert_true(stratus_context_on_device(device));
  device->device->is_cpu = !one_ray;
  for (uint32_t seed = 0; seed < seeds[what]; seed += few_run() ? 9 : one_ray && what == PLAIN ? 5 : one_ray ? 3 : 1) {
    several_case m;
    grid_case grid;
    if (what == PLAIN) {
      make_case(host, seed, &m, &grid);
    } else if (what == SHARP) {
      make_sharp_case(host, seed, &m);
    } else if (what == KEPT) {
      make_kept_case(host, seed, &m);
    } else {
      make_media_case(host, seed, &m, &media);
    }
    several_draw(host, &m, &on_host);
    several_draw(device, &m, &on_device);
    print_message(
      "             seed %u: %d volumes, %d pixels, %d differ; %s\n", seed, m.count, case_lit(&on_host), differing(), on_device.report.why);
    assert_true(case_lit(&on_host) > case_share(100));
    assert_int_equal(differing(), 0);
    assert_int_equal(on_device.report.differing_pixels, 0);
    assert_true(on_device.report.samples > 0);
    if (what == PLAIN || (!one_ray && case_counts_agree())) { /* a packet counts all its rays if the visible window cuts it */
      assert_int_equal(on_device.report.rays, on_host.report.rays);
    }
    assert_null(strstr(on_device.report.why, "drawn on the host"));
    if (what == MEDIA) {
      free(media.function.pairs);
    }
    several_destroy(&m);
  }
  stratus_context_destroy(device);
  stratus_context_destroy(host);
}

static void a_device_by_packets_draws_the_hosts_pictures(void** state)
{
  (void)state;
  compare(PLAIN, false);
}

static void a_device_by_rays_draws_the_hosts_pictures(void** state)
{
  (void)state;
  if (!few_run()) { /* by rays, the media and the meshes are enough */
    compare(PLAIN, true);
  }
}

static void a_device_draws_sharp_functions_as_the_host(void** state)
{
  (void)state;
  compare(SHARP, false);
  if (!few_run()) { /* by rays, the media are enough */
    compare(SHARP, true);
  }
}

static void a_device_draws_several_media_as_the_host(void** state)
{
  (void)state;
  if (!few_run()) { /* by packets, the sharp functions are enough */
    compare(MEDIA, false);
  }
  compare(MEDIA, true);
}

static void a_device_keeps_what_the_host_keeps(void** state)
{
  (void)state;
  compare(KEPT, false);
  if (!few_run()) {
    compare(KEPT, true);
  }
}

/* Meshes among volumes by samples and by cells, and without volumes; values of cells, a lattice, light, gradient opacity, two components;
 * labels, opaque geometry, clip planes, crop regions, jitter,
 * walls. */
static void make_mesh_case(stratus_context* context, uint32_t seed, mixed_case* m, media_case* media, float* opaque)
{
  static const int volumes[] = { 1, 2, 1, 1, 0, 1, 1, 0 };
  mixed_create(context, m, volumes[seed], seed % 2 ? 2 : 1, 520 + seed);
  picture_case* c = &m->volumes.of[0];
  tetra_case* mesh = &m->meshes[m->mesh_count - 1];
  c->options.skipping.audit = 1;
  c->options.sampling.jitter = seed == 1;
  if (seed == 2) { /* a sharp function, by cells */
    const double base = case_type_values[c->volume.type].base, scale = case_type_values[c->volume.type].scale;
    const double sharp[8] = { base + 0.1 * scale, 0, base + 0.13 * scale, 0.8, base + 0.16 * scale, 0, base + scale, 0 };
    memcpy(c->opacity, sharp, sizeof sharp);
    c->options.sampling.rule = STRATUS_SAMPLING_CELLS;
    c->options.sampling.cell_error = 0.001;
    mesh->mesh.cell_values = 1;
    for (int64_t cell = 0; cell < mesh->mesh.cell_count; ++cell) {
      mesh->values[cell] = (float)(0.5 + 0.4 * sin(0.37 * (double)cell));
    }
  }
  if (seed == 3) { /* a wall in a lit mesh with gradient opacity, and a volume lit by the midpoint rule */
    static const double thin[6] = { 0.05, 0.0, 0.25, 0.6, 0.6, 1.0 };
    const double wall[8] = { 0.0, 0.0, 0.6, 0.1, 0.6, 1.0, 1.0, 1.0 };
    memcpy(mesh->opacity, wall, sizeof wall);
    mesh->options.shade = 1;
    mesh->transfer.gradient = thin;
    mesh->transfer.gradient_count = 3;
    mesh->options.gradient_distance = 2.5;
    c->options.light.shade = 1;
    c->options.sampling.rule = STRATUS_SAMPLING_MIDPOINT;
  }
  if (seed == 1 || seed == 3) { /* crop regions, without and with light */
    mesh->options.crop = 1;
    mesh->options.crop_regions = 0x5140145u;
    memcpy(mesh->options.crop_bounds, (const double[6]){ 0.9, 2.1, 0.9, 2.1, 0.9, 2.1 }, sizeof mesh->options.crop_bounds);
  }
  if (seed == 4) { /* lit labels, one of which has a wall */
    static const double wall[6] = { 0.3, 0.0, 0.6, 1.0, 1.0, 1.0 };
    for (int64_t cell = 0; cell < mesh->mesh.cell_count; ++cell) {
      media->labels[cell] = (uint8_t)(cell / 5 % 3);
    }
    for (int n = 0; n < 3; ++n) {
      media->transfers[n] = mesh->transfer;
      media->transfers[n].unit_distance = 2.0 + n;
    }
    media->transfers[1].opacity = wall;
    media->transfers[1].opacity_count = 3;
    mesh->mesh.labels = media->labels;
    mesh->options.label_count = 2;
    mesh->options.shade = 1;
    m->transfers[0] = media->transfers;
  }
  if (seed >= 6) { /* two components of the same values; 7: dependent ones, whose largest value counts */
    static float values[2 * 125];
    for (int64_t i = 0; i < 2 * mesh->mesh.point_count; ++i) {
      values[i] = mesh->values[i / 2];
    }
    for (int n = 0; n < 2; ++n) {
      media->transfers[n] = mesh->transfer;
      media->transfers[n].weight = 1.0 - 0.5 * n;
    }
    mesh->mesh.values = values;
    mesh->mesh.value_stride = mesh->mesh.components = 2;
    mesh->options.shade = seed == 6;
    mesh->options.mean_components = seed == 6;
    mesh->options.dependent = seed == 7;
    m->meshes[0].options.mode = mesh->options.mode = seed == 7 ? STRATUS_TETRA_MAXIMUM : STRATUS_TETRA_COMPOSITE;
    m->transfers[m->mesh_count - 1] = media->transfers;
  }
  if (seed == 5) {
    for (int i = 0; i < CASE_PIXELS; ++i) {
      opaque[i] = i % 7 == 0 ? 1.0f : (float)(i % CASE_WIDTH) / CASE_WIDTH;
    }
    c->camera.near_k = 55.0;
    c->camera.far_k = 85.0;
    c->opaque_depth = opaque;
    const double plane[4] = { 0.3, 0.5, -0.2, 1.0 };
    mesh->options.clip_plane_count = 1;
    memcpy(mesh->options.clip_planes[0], plane, sizeof plane);
    tetra_destroy(&m->meshes[0]);
    tetra_create(&m->meshes[0], 3, 0.2, 0.0, 4);
    place_mesh(&m->meshes[0], 3, 2);
    tetra_as_lattice(&m->meshes[0], 3);
  }
}

/* Lets matter cast shadows from one side on what is lit: volumes and meshes, of which a mesh is the first input where seed is even. The
 * maps of light are made on the host for both. */
static void add_shadows(mixed_case* m, uint32_t seed)
{
  static const stratus_light light = { .vector = { 3.0, -1.0, 2.0 }, .color = { 1.0, 0.9, 0.8 } };
  m->meshes_first = seed % 2 == 0;
  for (int n = 0; n < m->volumes.count + m->mesh_count; ++n) {
    const bool mesh = n >= m->volumes.count;
    stratus_shading* s = mesh ? &m->meshes[n - m->volumes.count].options.shading : &m->volumes.of[n].options.light.shading;
    if (mesh) {
      m->meshes[n - m->volumes.count].options.shade = 1;
      m->meshes[n - m->volumes.count].options.tolerance = 0.02; /* of which coarse maps are enough */
    } else {
      m->volumes.of[n].options.light.shade = 1;
      m->volumes.of[n].options.sampling.tolerance = 0.02;
    }
    s->shadows = s->light_count = 1;
    s->lights[0] = light;
  }
}

static void compare_meshes(bool one_ray)
{
  static float opaque[CASE_PIXELS_MOST];
  static media_case media;
  stratus_context* host = case_context("host", 2);
  stratus_context* device = case_context("0", 2);
  assert_true(stratus_context_on_device(device));
  device->device->is_cpu = !one_ray;
  for (uint32_t seed = few_run() ? 3 : 0; seed < 8; seed += few_run() ? 8 : one_ray ? 3 : 1) { /* a kernel each */
    mixed_case m;
    make_mesh_case(host, seed, &m, &media, opaque);
    if (seed == 0 || seed == 3) {
      add_shadows(&m, seed);
    }
    assert_int_equal(mixed_draw(&m, &on_host), STRATUS_OK);
    assert_true((seed != 0 && seed != 3) || on_host.report.light_bytes > 0);
    const stratus_status status = mixed_draw_by(device, &m, &on_device);
    print_message("             seed %u: %d volumes, %d meshes, %d pixels, %d differ; %s%s\n", seed, m.volumes.count, m.mesh_count,
      case_lit(&on_host), differing(), on_device.report.why, status ? stratus_context_message(device) : "");
    assert_int_equal(status, STRATUS_OK);
    assert_true(case_lit(&on_host) > case_share(100));
    assert_int_equal(differing(), 0);
    assert_int_equal(on_device.report.differing_pixels, 0);
    assert_true(on_device.report.samples > 0);
    assert_null(strstr(on_device.report.why, "drawn on the host"));
    mixed_destroy(&m);
  }
  stratus_context_destroy(device);
  stratus_context_destroy(host);
}

static void a_device_draws_meshes_among_volumes_as_the_host(void** state)
{
  (void)state;
  if (!few_run()) { /* by packets, the volumes are enough */
    compare_meshes(false);
  }
}

static void a_device_by_rays_draws_meshes_among_volumes_as_the_host(void** state)
{
  (void)state;
  compare_meshes(true);
}

static void meshes_that_the_device_cannot_hold_are_drawn_on_the_host(void** state)
{
  (void)state;
  stratus_context* host = case_context("host", 2);
  stratus_context* device = case_context("0", 2);
  mixed_case m;
  mixed_create(host, &m, 0, 2, 527);
  assert_int_equal(mixed_draw(&m, &on_host), STRATUS_OK);
  device->device->largest_allocation = 3000;
  assert_int_equal(mixed_draw_by(device, &m, &on_device), STRATUS_OK);
  assert_non_null(strstr(on_device.report.why, "drawn on the host: volume 0: the mesh's cells are larger"));
  assert_int_equal(differing(), 0);
  mixed_destroy(&m);
  stratus_context_destroy(device);
  stratus_context_destroy(host);
}

/* Only what changed is sent again: for another function of one volume by the midpoint rule, its table, its layers and its map. */
static void what_did_not_change_stays_on_the_device(void** state)
{
  (void)state;
  stratus_context* device = case_context("0", 2);
  several_case m;
  several_casters casters;
  several_create(device, &m, 2, 44);
  m.of[0].options.sampling.rule = STRATUS_SAMPLING_PREINTEGRATED;
  m.of[1].options.sampling.rule = STRATUS_SAMPLING_MIDPOINT;
  several_casters_create(device, &casters);
  assert_int_equal(several_draw_with(&casters, &m, &on_device, reports), STRATUS_OK);
  const uint64_t first[2] = { reports[0].uploads, reports[1].uploads };
  assert_true(first[0] >= 5 && first[1] >= 6);
  m.of[0].camera.eye[0] += 1.0;
  assert_int_equal(several_draw_with(&casters, &m, &on_device, reports), STRATUS_OK);
  assert_int_equal(reports[0].uploads, first[0]);
  assert_int_equal(reports[1].uploads, first[1]);
  m.of[1].opacity[5] *= 0.5;
  assert_int_equal(several_draw_with(&casters, &m, &on_device, reports), STRATUS_OK);
  assert_int_equal(reports[0].uploads, first[0]);
  print_message("             uploads %d, then %d\n", (int)first[1], (int)reports[1].uploads);
  assert_true(reports[1].uploads > first[1] && reports[1].uploads <= first[1] + 3);
  /* another step changes only the layers */
  const uint64_t second = reports[1].uploads;
  m.of[0].options.sampling.distance = m.of[1].options.sampling.distance = 0.3;
  assert_int_equal(several_draw_with(&casters, &m, &on_device, reports), STRATUS_OK);
  assert_int_equal(reports[0].uploads, first[0]);
  assert_true(reports[1].uploads > second);
  stratus_context* host = case_context("host", 2);
  several_draw(host, &m, &on_host);
  assert_int_equal(differing(), 0);
  several_casters_destroy(&casters);
  several_destroy(&m);
  stratus_context_destroy(host);
  stratus_context_destroy(device);
}

/* Several volumes are not drawn from pages. */
static void the_host_draws_what_the_device_cannot_hold(void** state)
{
  (void)state;
  stratus_context* host = case_context("host", 2);
  stratus_context* device = case_context("0", 2);
  several_case m;
  several_create(device, &m, 2, 45);
  several_draw(host, &m, &on_host);
  device->device->largest_allocation = 30000;
  several_draw(device, &m, &on_device);
  assert_non_null(strstr(on_device.report.why, "drawn on the host: volume 0: "));
  assert_non_null(strstr(on_device.report.why, "largest allocation"));
  assert_int_equal(differing(), 0);
  several_destroy(&m);
  stratus_context_destroy(device);
  stratus_context_destroy(host);
}

/* Without double, rays are set up in pairs of floats: as test_ray_cast_pairs has it of one volume. */
static void a_device_without_double_draws_nearly_the_same(void** state)
{
  (void)state;
  stratus_context* host = case_context("host", 2);
  stratus_context* device = case_context("0", 2);
  several_case m;
  float most = 0.0f;
  device->device->has_double = false;
  several_create(host, &m, 3, 46);
  for (int n = 0; n < 3; ++n) {
    case_destroy(&m.of[n]);
    case_create(host, &m.of[n], n ? STRATUS_FLOAT32 : STRATUS_UINT8, 20, 24, 22, 46u + (uint32_t)n);
    several_place(&m.of[n], 5u + 17u * (uint32_t)n);
  }
  const double eye[3] = { 30, 40, 35 }, focal[3] = { 0, 0, 0 }, up[3] = { 0, 1, 0 };
  assert_int_equal(stratus_camera_perspective(host, eye, focal, up, 40.0, 1.2, &m.of[0].camera), STRATUS_OK);
  several_draw(host, &m, &on_host);
  several_draw(device, &m, &on_device);
  for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
    most = fmaxf(most, fabsf(on_host.rgba[i] - on_device.rgba[i]));
  }
  assert_true(case_lit(&on_host) > case_share(100));
  assert_null(strstr(on_device.report.why, "drawn on the host"));
  assert_true(most <= 2e-3f);
  several_destroy(&m);
  stratus_context_destroy(device);
  stratus_context_destroy(host);
}

#define RUN(tests)                                                                                                                         \
  (stratus_device_count() == 0 ? test_skip("no OpenCL device on this machine") : cmocka_run_group_tests((tests), NULL, NULL))

int test_ray_several_device(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_device_by_packets_draws_the_hosts_pictures),
    cmocka_unit_test(a_device_by_rays_draws_the_hosts_pictures),
    cmocka_unit_test(the_host_draws_what_the_device_cannot_hold),
  };
  return RUN(tests);
}

int test_ray_several_media_device(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_device_draws_sharp_functions_as_the_host),
    cmocka_unit_test(a_device_draws_several_media_as_the_host),
    cmocka_unit_test(a_device_keeps_what_the_host_keeps),
  };
  return RUN(tests);
}

int test_ray_several_meshes_device(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_device_draws_meshes_among_volumes_as_the_host),
    cmocka_unit_test(a_device_by_rays_draws_meshes_among_volumes_as_the_host),
    cmocka_unit_test(meshes_that_the_device_cannot_hold_are_drawn_on_the_host),
  };
  return RUN(tests);
}

int test_ray_several_kept_device(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(what_did_not_change_stays_on_the_device),
    cmocka_unit_test(a_device_without_double_draws_nearly_the_same),
  };
  return RUN(tests);
}
