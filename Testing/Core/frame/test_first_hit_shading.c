/* SPDX-License-Identifier: BSD-3-Clause
 * Light in first-hit pictures, compared with geometry: normals of faces, cuts and fields, and Phong's sum. */
#define CASE_FULL_SIZE
#include "picture_case.h"

#include <stdbool.h>

static picture first;

/* White surfaces, lit by a red light from +x, a green one from +y, a blue one from +z: the colour is the normal where that is positive. */
static void light_normals(picture_case* c)
{
  stratus_shading* shading = &c->options.light.shading;
  static const double white[4] = { 0, 1, 1, 1 };
  c->transfer.color = white;
  c->transfer.color_count = 1;
  *shading = (stratus_shading){ .on = 1, .diffuse = 1.0, .light_count = 3 };
  for (int a = 0; a < 3; ++a) {
    shading->lights[a].vector[a] = 7.0;
    shading->lights[a].color[a] = 1.0;
  }
}

/* The middle voxel of 3^3, seen from (1,1,1). All other values are too low to show. */
static void create_single(stratus_context* context, picture_case* c)
{
  static const double opacity[4] = { 0.5, 0.0, 1.0, 1.0 };
  case_create(context, c, STRATUS_FLOAT32, 3, 3, 3, 1);
  memset(c->values, 0, 27 * sizeof(float));
  ((float*)c->values)[13] = 1.0f;
  c->transfer.opacity = opacity;
  c->transfer.opacity_count = 2;
  c->options.mode = STRATUS_MODE_FIRST_HIT;
  light_normals(c);
}

static void look_from(stratus_context* context, picture_case* c, const double from[3], const double at[3], double scale)
{
  static const double up[3] = { 0.1, 0.2, 1.0 };
  const double eye[3] = { at[0] + from[0], at[1] + from[1], at[2] + from[2] };
  assert_int_equal(stratus_camera_parallel(context, eye, at, up, scale, (double)CASE_WIDTH / CASE_HEIGHT, &c->camera), STRATUS_OK);
}

static void faces_have_their_normals_under_any_matrix(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 1);
  for (uint32_t seed = 0; seed < 20; ++seed) {
    picture_case c;
    double edges[3][3], normals[3][3], middle[3];
    uint32_t s = seed;
    int seen[3] = { 0, 0, 0 };
    create_single(context, &c);
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        c.volume.matrix[4 * a + b] = (a == b ? (seed % 2 ? -1.0 : 1.0) : 0.0) + (seed ? case_uniform(&s, -0.4, 0.4) : 0.0);
      }
    }
    for (int a = 0; a < 3; ++a) {
      middle[a] = c.volume.matrix[4 * a] + c.volume.matrix[4 * a + 1] + c.volume.matrix[4 * a + 2];
      for (int b = 0; b < 3; ++b) {
        edges[b][a] = c.volume.matrix[4 * a + b];
      }
    }
    const double from[3] = { 20, 17, 14 };
    for (int a = 0; a < 3; ++a) { /* of the face spanned by the two other edges, towards the eye */
      const double *e = edges[(a + 1) % 3], *f = edges[(a + 2) % 3];
      double* n = normals[a];
      double length = 0.0, toward = 0.0;
      for (int i = 0; i < 3; ++i) {
        n[i] = e[(i + 1) % 3] * f[(i + 2) % 3] - e[(i + 2) % 3] * f[(i + 1) % 3];
        length += n[i] * n[i];
        toward += n[i] * from[i];
      }
      for (int i = 0; i < 3; ++i) {
        n[i] /= (toward < 0.0 ? -1.0 : 1.0) * sqrt(length);
      }
    }
    look_from(context, &c, from, middle, 1.2);
    case_render(context, &c, &first);
    for (int at = 0; at < CASE_PIXELS; ++at) {
      if (first.rgba[4 * at + 3] > 0.0f) {
        int which = -1;
        for (int a = 0; a < 3; ++a) {
          bool same = true;
          for (int i = 0; i < 3; ++i) {
            same = same && fabs((double)first.rgba[4 * at + i] - fmax(0.0, normals[a][i])) < 1e-6;
          }
          which = same ? a : which;
        }
        assert_true(which >= 0);
        ++seen[which];
      }
    }
    assert_true(seen[0] > 10 && seen[1] > 10 && seen[2] > 10);
    case_destroy(&c);
  }
  stratus_context_destroy(context);
}

static void cuts_have_the_normal_of_what_cuts(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 1);
  picture_case c;
  const double from[3] = { 0, 0, 10 }, middle[3] = { 1, 1, 1 };
  const float* center = first.rgba + 4 * (CASE_HEIGHT / 2 * CASE_WIDTH + CASE_WIDTH / 2);
  create_single(context, &c);
  look_from(context, &c, from, middle, 1.2);
  case_render(context, &c, &first);
  assert_true(center[2] > 0.999999f && center[0] == 0.0f && center[1] == 0.0f);
  c.options.clipping.clip_plane_count = 1; /* keeps x + 2 y + 2 z <= 5, through the middle: normal (1, 2, 2)/3 */
  const double plane[4] = { -1, -2, -2, 5 };
  memcpy(c.options.clipping.clip_planes[0], plane, sizeof plane);
  for (int normals = 0; normals < 2; ++normals) {
    c.options.light.normals = (stratus_normals)normals;
    case_render(context, &c, &first);
    assert_true(fabs(center[0] - 1.0 / 3) < 1e-6 && fabs(center[1] - 2.0 / 3) < 1e-6 && fabs(center[2] - 2.0 / 3) < 1e-6);
  }
  c.options.clipping.clip_plane_count = 0;
  c.options.clipping.crop = 1; /* the crop's upper z */
  const double crop[6] = { 0, 2, 0, 2, 0, 1.1 };
  memcpy(c.options.clipping.crop_bounds, crop, sizeof crop);
  case_render(context, &c, &first);
  assert_true(center[2] > 0.999999f && center[0] == 0.0f);
  assert_true(fabs((double)first.depth[CASE_HEIGHT / 2 * CASE_WIDTH + CASE_WIDTH / 2] - 9.9) < 1e-5);
  c.options.clipping.crop = 0;
  const double slanted[3] = { 3, 0, 4 };
  look_from(context, &c, slanted, middle, 0.1);
  c.camera.near_k = 5.0; /* begins in the middle: against the ray, which has length 1 */
  case_render(context, &c, &first);
  assert_true(fabs(center[0] - 0.6) < 1e-6 && center[1] < 1e-6f && fabs(center[2] - 0.8) < 1e-6);
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* A field that is linear in the world, so that central differences are exact at any spacing. */
static void gradients_are_the_fields(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 1);
  picture_case c;
  static const double opacity[4] = { -1e9, 1.0, 1e9, 1.0 };
  const double slope[3] = { 1.0, 2.0, 3.0 }, length = sqrt(14.0);
  case_create(context, &c, STRATUS_FLOAT64, 8, 9, 10, 1);
  c.volume.spacing[0] = 0.5;
  c.volume.spacing[2] = 3.0;
  for (int at = 0; at < 720; ++at) {
    ((double*)c.values)[at] = slope[0] * 0.5 * (at % 8) + slope[1] * (at / 8 % 9) + slope[2] * 3.0 * (at / 72);
  }
  c.transfer.opacity = opacity;
  c.transfer.opacity_count = 2;
  c.options.mode = STRATUS_MODE_FIRST_HIT;
  c.options.light.normals = STRATUS_NORMALS_GRADIENT;
  light_normals(&c);
  const double from[3] = { 50, 50, 50 }, middle[3] = { 2, 4, 13 };
  look_from(context, &c, from, middle, 14.0);
  case_render(context, &c, &first);
  assert_true(case_lit(&first) > case_share(200));
  for (int at = 0; at < CASE_PIXELS; ++at) {
    for (int a = 0; a < 3 && first.rgba[4 * at + 3] > 0.0f; ++a) {
      assert_true(fabs((double)first.rgba[4 * at + a] - slope[a] / length) < 1e-6);
    }
  }
  case_destroy(&c);
  stratus_context_destroy(context);
}

static void light_adds_up_as_phong_says(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 1);
  picture_case c;
  static const double color[4] = { 0, 0.5, 0.25, 0.125 };
  const int pixel = CASE_HEIGHT / 2 * CASE_WIDTH + CASE_WIDTH / 2;
  const float* center = first.rgba + 4 * pixel;
  create_single(context, &c);
  c.transfer.color = color;
  const double from[3] = { 0, 0, 10 }, middle[3] = { 1, 1, 1 };
  look_from(context, &c, from, middle, 0.001); /* all rays meet (1, 1, 1.5) */
  c.options.light.shading = stratus_ray_cast_options_default().light.shading;
  case_render(context, &c, &first); /* the light at the eye */
  assert_true(fabs(center[0] - 0.5) < 1e-6 && fabs(center[1] - 0.25) < 1e-6 && fabs(center[2] - 0.125) < 1e-6);
  stratus_shading* shading = &c.options.light.shading;
  shading->light_count = 0;
  case_render(context, &c, &first);
  assert_true(fabs(center[0] - 0.05) < 1e-6);
  /* a light whose cosine is .8, standing there or in that direction; mirrored, it passes the eye at the same angle */
  shading->light_count = 1;
  shading->specular = 0.3;
  shading->specular_power = 3.0;
  for (int positional = 0; positional < 2; ++positional) {
    shading->lights[0] = (stratus_light){ .vector = { 3, 0, 4 }, .color = { 1, 0.5, 0 }, .positional = positional };
    if (positional) {
      shading->lights[0].vector[0] += 1.0;
      shading->lights[0].vector[1] += 1.0;
      shading->lights[0].vector[2] += 1.5;
    }
    case_render(context, &c, &first);
    const double gloss = 0.3 * 0.8 * 0.8 * 0.8;
    assert_true(fabs(center[0] - (0.5 * (0.1 + 0.9 * 0.8) + gloss)) < 1e-4);
    assert_true(fabs(center[1] - (0.25 * (0.1 + 0.9 * 0.8 * 0.5) + 0.5 * gloss)) < 1e-4);
    assert_true(fabs(center[2] - 0.125 * 0.1) < 1e-6);
    shading->lights[0].separate_specular = 1;
    shading->lights[0].specular_color[2] = 0.5;
    case_render(context, &c, &first);
    assert_true(fabs(center[0] - 0.5 * (0.1 + 0.9 * 0.8)) < 1e-4);
    assert_true(fabs(center[2] - (0.125 * 0.1 + 0.5 * gloss)) < 1e-4);
    shading->lights[0].separate_specular = 0;
  }
  const double dim = 1.0 / (0.5 + 0.1 * 5.0 + 0.04 * 25.0); /* 5 from the hit */
  shading->lights[0].attenuation[0] = 0.5;
  shading->lights[0].attenuation[1] = 0.1;
  shading->lights[0].attenuation[2] = 0.04;
  case_render(context, &c, &first);
  assert_true(fabs(center[0] - (0.5 * (0.1 + dim * 0.9 * 0.8) + dim * 0.3 * 0.8 * 0.8 * 0.8)) < 1e-4);
  memset(shading->lights[0].attenuation, 0, sizeof shading->lights[0].attenuation);
  for (int inside = 0; inside < 2; ++inside) { /* a cone straight down, from which the hit lies 36.87 degrees aside */
    shading->lights[0].axis[2] = -2.0;
    shading->lights[0].cone_exponent = 2.0;
    shading->lights[0].cone_angle = inside ? 36.9 : 36.8;
    case_render(context, &c, &first);
    const double part = inside ? 0.8 * 0.8 : 0.0;
    assert_true(fabs(center[0] - (0.5 * (0.1 + part * 0.9 * 0.8) + part * 0.3 * 0.8 * 0.8 * 0.8)) < 1e-4);
  }
  shading->lights[0].vector[2] = -50.0; /* from behind: nothing but ambient */
  case_render(context, &c, &first);
  assert_true(fabs(center[0] - 0.05) < 1e-6);
  shading->lights[0] = (stratus_light){ .vector = { 0, 0, 1 }, .color = { 9, 9, 9 } };
  case_render(context, &c, &first);
  assert_true(center[0] == 1.0f && center[3] == 1.0f); /* never more than white */
  case_destroy(&c);
  stratus_context_destroy(context);
}

int test_first_hit_shading(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(faces_have_their_normals_under_any_matrix),
    cmocka_unit_test(cuts_have_the_normal_of_what_cuts),
    cmocka_unit_test(gradients_are_the_fields),
    cmocka_unit_test(light_adds_up_as_phong_says),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
