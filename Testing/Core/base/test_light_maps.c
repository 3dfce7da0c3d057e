/* SPDX-License-Identifier: BSD-3-Clause
 * Maps of light of matter whose opacity the test itself draws: their sizes, their errors, and how each light passes near matter. */
#include "structures.h"

#include "light_maps.h"
#include "lights.h"

static const double as_it_is[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };

/* The matter: even, rough at random, or hard bars that only light along z meets. */
typedef enum kind { EVEN, ROUGH, BARS } kind;

static stratus_status draw(void* of, const stratus_camera* camera, int layers, const stratus_image* image, bool colors)
{
  (void)colors;
  const kind matter = *(const kind*)of;
  for (int layer = 0; layer < layers; ++layer) {
    uint32_t random = 1;
    for (int i = 0; i < image->width * image->height; ++i) {
      const int x = i % image->width;
      float* rgba = image->rgba + 4 * (size_t)(layer * image->width * image->height + i);
      rgba[3] = matter == EVEN           ? 0.5f
        : matter == ROUGH                ? 1e-3f * (float)random_below(&random, 10)
        : fabs(camera->forward[2]) < 0.5 ? 0.0f
        : 8 * x / image->width % 2       ? 0.9f
                                         : 0.0f;
      rgba[0] = rgba[1] = rgba[2] = rgba[3];
    }
  }
  return STRATUS_OK;
}

static stratus_light_maps* maps_of(
  stratus_context* context, kind matter, double depth, double step, double tolerance, const stratus_light* lights, int count)
{
  const stratus_light_matter all = {
    .draw = draw, .of = &matter, .bounds = { 0.0, 1.0, 0.0, 1.0, 0.0, depth }, .step = step, .reflectance = 1.0, .tolerance = tolerance
  };
  const stratus_shading once = { .shadows = 1 };
  stratus_light_maps* maps = NULL;
  assert_int_equal(stratus_light_maps_build(context, &all, &once, lights, count, &maps), STRATUS_OK);
  return maps;
}

/* The finest map of a cube from any direction has 256 nodes along its longest side, and a map has at most 64 MiB wherever the light is. */
static void the_finest_maps_are_as_large_as_64_mib_allow(void** state)
{
  static const struct {
    stratus_light light;
    size_t words;
  } cases[] = {
    { { .vector = { 0, 0, 1 } }, 256 * 256 * 255 },
    { { .vector = { 0.5, 0.5, 0.5 }, .positional = 1 }, 6 * 128 * 128 * 64 },
    { { .vector = { 1, 0.7, 0.4 } }, 0 },
    { { .vector = { 0.5, 0.5, 9 }, .positional = 1 }, 0 },
  };
  (void)state;
  stratus_context* context = make_context("host", 2);
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
    stratus_light_maps* maps = maps_of(context, ROUGH, 1.0, 0.0, 0.0, &cases[i].light, 1);
    const size_t words = stratus_light_maps_bytes(maps) / sizeof(int32_t);
    assert_true(words <= 256 * 256 * 256);
    if (cases[i].words > 0) {
      assert_int_equal(words, cases[i].words);
    } else { /* as fine as along an axis: the two other sides have at least half of the nodes */
      assert_true(words > 256 * 128 * 128);
    }
    stratus_light_maps_destroy(maps);
  }
  stratus_context_destroy(context);
}

/* Matter without a depth has a map that light passes evenly: the coarsest one is exact. */
static void flat_matter_has_a_map(void** state)
{
  const stratus_light light = { .vector = { 0, 0, 1 } };
  (void)state;
  stratus_context* context = make_context("host", 1);
  for (int steps = 0; steps < 2; ++steps) {
    stratus_light_maps* maps = maps_of(context, EVEN, 0.0, steps ? 0.01 : 0.0, 1e-3, &light, 1);
    assert_int_equal(stratus_light_maps_bytes(maps), 32 * 32 * sizeof(int32_t));
    assert_true(stratus_light_maps_error(maps) < 1e-4); /* maps have 16 bits */
    assert_true(stratus_light_maps_near(maps) == 0.0);
    stratus_light_maps_destroy(maps);
  }
  stratus_context_destroy(context);
}

/* The length on which near matter is passed to a light follows from that light and its share of the tolerance: errors of lights add by
 * their squares. */
static void each_light_passes_near_matter_on_its_own_length(void** state)
{
  const stratus_light lights[3] = { { .color = { 1, 0, 0 }, .vector = { 1, 0, 0 } }, { .color = { 0, 0, 1 }, .vector = { 0, 0, 1 } },
    { .color = { 0, 1, 0 }, .vector = { 0.5, 0.5, 40 }, .positional = 1 } };
  stratus_light_arguments all = { .count = 3, .positional = { 0, 0, 1 } }, one = { .count = 1 };
  (void)state;
  stratus_context* context = make_context("host", 1);
  stratus_light_maps* maps = maps_of(context, BARS, 1.0, 1.0 / 128.0, 0.01, lights, 3);
  stratus_light_maps_arguments(maps, lights, as_it_is, 1.0, 0.1, &all);
  stratus_light_maps_destroy(maps);
  assert_true(all.near && all.near_steps[0] == 0 && all.near_steps[1] > 0);
  for (int i = 0; i < 3; ++i) {
    maps = maps_of(context, BARS, 1.0, 1.0 / 128.0, 0.01 / sqrt(3.0), &lights[i], 1);
    one.positional[0] = all.positional[i];
    stratus_light_maps_arguments(maps, &lights[i], as_it_is, 1.0, 0.1, &one);
    assert_int_equal(one.near_steps[0], all.near_steps[i]);
    if (one.near_steps[0] > 0) {
      assert_memory_equal(&one.near_length[0], &all.near_length[i], sizeof(float));
      assert_memory_equal(&one.near_reach[0], &all.near_reach[i], sizeof(float));
      assert_memory_equal(one.near_way[0], all.near_way[i], sizeof one.near_way[0]);
    }
    stratus_light_maps_destroy(maps);
  }
  stratus_light_maps_arguments(NULL, lights, as_it_is, 1.0, 0.1, &all);
  assert_false(all.near || all.near_steps[1] > 0 || all.map_at[1] >= 0);
  stratus_context_destroy(context);
}

/* A map is as exact as its light's brightness and its matter's colour need, and is kept until a brighter light needs more. */
static void brighter_lights_have_finer_maps(void** state)
{
  kind matter = BARS;
  stratus_light light = { .color = { 0.01, 0.02, 0.01 }, .vector = { 0, 0, 1 } };
  stratus_light_matter all = { .draw = draw, .of = &matter, .bounds = { 0, 1, 0, 1, 0, 1 }, .tolerance = 0.02 };
  const stratus_shading once = { .shadows = 1 };
  stratus_light_state kept = { 0 };
  double errors[2][2];
  (void)state;
  stratus_context* context = make_context("host", 1);
  for (int dark = 0; dark < 2; ++dark) {
    all.reflectance = dark ? 0.5 : 1.0;
    light.color[1] = 0.02;
    assert_int_equal(stratus_light_state_build(context, &all, &once, &light, 1, &kept), STRATUS_OK);
    kept.key = 1;
    const size_t bytes = stratus_light_maps_bytes(kept.maps);
    assert_int_equal(bytes, 32 * 32 * 31 * sizeof(int32_t));
    errors[dark][0] = stratus_light_maps_error(kept.maps);
    light.color[1] = 0.01; /* darker: the same maps err less */
    assert_true(stratus_light_state_serves(&kept, 1, &light, 1));
    errors[dark][1] = stratus_light_maps_error(kept.maps);
    assert_true(fabs(errors[dark][1] - 0.5 * errors[dark][0]) < 1e-9 && errors[dark][1] > 0.0);
    light.color[1] = 1.0;
    assert_false(stratus_light_state_serves(&kept, 1, &light, 1));
    assert_int_equal(stratus_light_state_build(context, &all, &once, &light, 1, &kept), STRATUS_OK);
    kept.key = 1;
    assert_true(stratus_light_maps_bytes(kept.maps) > bytes);
    light.color[1] = 2.0; /* the maps of hard bars were as good as maps can be */
    assert_true(stratus_light_state_serves(&kept, 1, &light, 1) && stratus_light_maps_error(kept.maps) > all.tolerance);
    assert_false(stratus_light_state_serves(&kept, 2, &light, 1));
  }
  assert_true(fabs(errors[1][0] - 0.5 * errors[0][0]) < 1e-9);
  stratus_light_state_drop(&kept);
  stratus_context_destroy(context);
}

/* Highlights count by their root mean square over all normals, unless all light is scattered; of components the brightest counts. */
static void matter_reflects_as_its_material_says(void** state)
{
  stratus_shading shading = { .diffuse = 0.5, .specular = 0.3, .specular_power = 4.0 };
  const stratus_material own[3] = { { .shade = 1, .diffuse = 0.2 }, { .shade = 1, .diffuse = 0.4, .specular = 0.7, .specular_power = 24.0 },
    { .diffuse = 0.9 } };
  (void)state;
  assert_true(fabs(stratus_lights_reflectance(&shading, NULL, 1) - 0.6) < 1e-12);
  assert_true(fabs(stratus_lights_reflectance(&shading, own, 3) - 0.5) < 1e-12);
  shading.scattering = 1.0;
  assert_true(fabs(stratus_lights_reflectance(&shading, NULL, 1) - 0.5) < 1e-12);
  assert_true(fabs(stratus_lights_reflectance(&shading, own, 3) - 0.4) < 1e-12);
}

int test_light_maps(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(the_finest_maps_are_as_large_as_64_mib_allow),
    cmocka_unit_test(flat_matter_has_a_map),
    cmocka_unit_test(each_light_passes_near_matter_on_its_own_length),
    cmocka_unit_test(brighter_lights_have_finer_maps),
    cmocka_unit_test(matter_reflects_as_its_material_says),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
