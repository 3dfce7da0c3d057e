/* SPDX-License-Identifier: BSD-3-Clause
 * Text around pictures: whole at every size, and never over other text. Coastlines where the camera has their places. */
#include "structures.h"

#include "box.h"
#include "faulty_allocator.h"
#include "text.h"

#include "stratus/annotation.h"
#include "stratus/globe.h"

#include <stdio.h>

#define RADIANS (3.14159265358979323846 / 180.0)

static stratus_context* context;

static const double gray[] = { 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0 };

/* A volume's annotations with long texts. */
static stratus_annotation crowded(double x, double y, double z)
{
  stratus_annotation a = stratus_annotation_default();
  const double bounds[6] = { -x, x, 0.0, y, -z, 0.0 };
  memcpy(a.bounds, bounds, sizeof bounds);
  a.axes = 1;
  a.axis[0].kind = STRATUS_AXIS_LONGITUDE;
  a.axis[0].scale = 62.5 / x;
  a.axis[0].title = "longitude";
  a.axis[1].kind = STRATUS_AXIS_LATITUDE;
  a.axis[1].scale = 12.0 / y;
  a.axis[1].title = "latitude";
  a.axis[2].scale = -5700.0 / z;
  a.axis[2].title = "depth below the sea's surface";
  a.axis[2].units = "m";
  a.color = gray;
  a.color_count = 2;
  a.low = 0.00012;
  a.high = 0.01;
  a.bar_title = "mass_fraction_of_cloud_liquid_water_in_air";
  a.bar_units = "kg kg-1";
  a.caption =
    "Cumulus over the sea, a caption that is longer than a small picture is wide, 12.5 hours since 2001-01-01 00:00:00, heights x 1400";
  return a;
}

/* A camera whose window's part for the volume contains all corners of the box. */
static stratus_camera fitted(const stratus_annotation* a, int width, int height, double azimuth, double elevation, bool parallel)
{
  double room[4], middle[3], eye[3];
  assert_int_equal(stratus_annotation_room(context, a, width, height, room), STRATUS_OK);
  assert_true(room[0] >= 0.0 && room[0] < room[1] && room[1] <= width && room[2] >= 0.0 && room[2] < room[3] && room[3] <= height);
  const double aspect = (room[1] - room[0]) / (room[3] - room[2]), up[3] = { 0.0, 0.0, 1.0 };
  double size = 0.0;
  for (int i = 0; i < 3; ++i) {
    middle[i] = 0.5 * (a->bounds[2 * i] + a->bounds[2 * i + 1]);
    size = hypot(size, a->bounds[2 * i + 1] - a->bounds[2 * i]);
  }
  eye[0] = middle[0] + 2.0 * size * cos(elevation * RADIANS) * cos(azimuth * RADIANS);
  eye[1] = middle[1] + 2.0 * size * cos(elevation * RADIANS) * sin(azimuth * RADIANS);
  eye[2] = middle[2] + 2.0 * size * sin(elevation * RADIANS);
  stratus_camera camera;
  if (parallel) {
    assert_int_equal(stratus_camera_parallel(context, eye, middle, up, 0.5 * size / fmin(aspect, 1.0), aspect, &camera), STRATUS_OK);
  } else { /* sphere of the box, seen from twice its diameter */
    const double half = atan(tan(asin(0.25)) / fmin(aspect, 1.0)) / RADIANS;
    assert_int_equal(stratus_camera_perspective(context, eye, middle, up, 2.0 * half, aspect, &camera), STRATUS_OK);
  }
  assert_int_equal(stratus_camera_in_room(context, &camera, width, height, room, &camera), STRATUS_OK);
  return camera;
}

static float* draw(const stratus_annotation* a, const stratus_camera* camera, int width, int height, stratus_annotation_text* texts,
  size_t most, size_t* count)
{
  stratus_image image = { 0 };
  image.width = width;
  image.height = height;
  image.rgba = calloc(4 * (size_t)width * (size_t)height, sizeof(float));
  assert_non_null(image.rgba);
  assert_int_equal(stratus_annotation_draw(context, a, camera, &image, texts, most, count), STRATUS_OK);
  return image.rgba;
}

/* Every pixel of a text, drawn alone, is in the picture. Its size is one of two. */
static void assert_whole(const stratus_annotation_text* t, const float* rgba, int width, int height, double size)
{
  const int wide = t->right - t->left + 1, high = t->top - t->bottom + 1;
  for (int n = 0; n < 4; ++n) {
    const double own = n & 1 ? size : 1.15 * size;
    stratus_text level, text = { 0, 0, NULL };
    assert_int_equal(stratus_text_create(context, t->text, own, &level), STRATUS_OK);
    if (n & 2) {
      assert_int_equal(stratus_text_turn(context, &level, &text), STRATUS_OK);
    }
    const stratus_text* const drawn = n & 2 ? &text : &level;
    const bool found = drawn->width == wide && drawn->height == high;
    for (int j = 0; found && j < high; ++j) {
      for (int i = 0; i < wide; ++i) {
        const float alpha = rgba[4 * ((size_t)(t->bottom + j) * (size_t)width + (size_t)(t->left + i)) + 3];
        assert_true(alpha >= drawn->coverage[j * wide + i] - 1e-6f);
      }
    }
    stratus_text_destroy(context, &level);
    stratus_text_destroy(context, &text);
    if (found) {
      return;
    }
  }
  fail_msg("'%s' at %dx%d has a size of neither titles nor numbers: %dx%d", t->text, width, height, wide, high);
}

static void check_texts(const stratus_annotation* a, int width, int height, double azimuth, double elevation, bool parallel)
{
  static stratus_annotation_text texts[256];
  const stratus_camera camera = fitted(a, width, height, azimuth, elevation, parallel);
  const int side = width < height ? width : height;
  const double size = fmax(10.0, 13.0 * pow(side / 512.0, 0.75));
  size_t count = 0;
  float* const rgba = draw(a, &camera, width, height, texts, 256, &count);
  int numbers[5] = { 0 }, titles[5] = { 0 };
  assert_true(count < 256);
  for (size_t i = 0; i < count; ++i) {
    const stratus_annotation_text* const t = &texts[i];
    if (t->left < 2 || t->bottom < 2 || t->right >= width - 2 || t->top >= height - 2) {
      fail_msg("'%s' is cut off at %dx%d: %d..%d, %d..%d", t->text, width, height, t->left, t->right, t->bottom, t->top);
    }
    for (size_t j = 0; j < i; ++j) {
      const stratus_annotation_text* const o = &texts[j];
      if (t->left <= o->right && o->left <= t->right && t->bottom <= o->top && o->bottom <= t->top) {
        fail_msg("'%s' and '%s' overlap at %dx%d, azimuth %g, elevation %g", t->text, o->text, width, height, azimuth, elevation);
      }
    }
    assert_in_range(t->part, 0, 4);
    const char first = t->text[0];
    ++*(((first >= '0' && first <= '9') || first == '-') ? &numbers[t->part] : &titles[t->part]);
    if (strlen(t->text) < sizeof t->text - 1) {
      assert_whole(t, rgba, width, height, size);
    }
  }
  assert_true(titles[4] >= 1 && titles[3] >= 1 && numbers[3] >= 1); /* a caption, and a bar with a title */
  for (int axis = 0; axis < 3 && height >= 480 && width >= 640; ++axis) {
    if (numbers[axis] < 1 || titles[axis] != 1) {
      fail_msg("axis %d has %d numbers, %d titles at %dx%d, azimuth %g, elevation %g, box %g %g %g", axis, numbers[axis], titles[axis],
        width, height, azimuth, elevation, a->bounds[1], a->bounds[3], a->bounds[5]);
    }
  }
  for (int x = 0; x < width; ++x) { /* nor lines */
    for (int y = 0; y < 2; ++y) {
      assert_true(rgba[4 * (y * width + x) + 3] == 0.0f && rgba[4 * ((height - 1 - y) * width + x) + 3] == 0.0f);
    }
  }
  for (int y = 0; y < height; ++y) {
    assert_true(rgba[4 * (y * width) + 3] == 0.0f && rgba[4 * (y * width + width - 1) + 3] == 0.0f);
  }
  free(rgba);
}

static void text_is_whole_and_covers_no_other(void** state)
{
  (void)state;
  static const int sizes[][2] = { { 256, 256 }, { 320, 240 }, { 640, 480 }, { 1024, 1024 }, { 1920, 1080 }, { 3840, 2160 }, { 480, 900 } };
  static const double shapes[][3] = { { 1.0, 1.0, 8.0 }, { 6.0, 3.0, 2.0 }, { 1.0, 2.0, 0.1 } }; /* tall, wide, flat */
  for (size_t s = 0; s < sizeof sizes / sizeof *sizes; ++s) {
    for (size_t n = 0; n < 3; ++n) {
      const stratus_annotation a = crowded(shapes[n][0], shapes[n][1], shapes[n][2]);
      const int step = sizes[s][0] > 2000 ? 120 : 30;
      for (int azimuth = -70; azimuth < 290; azimuth += step) {
        check_texts(&a, sizes[s][0], sizes[s][1], azimuth, 35.0, azimuth % 60 == 0);
      }
    }
  }
}

static void exponents_in_braces_are_written_as_cf_does(void** state)
{
  (void)state;
  float* pictures[3];
  for (int n = 0; n < 3; ++n) {
    stratus_annotation a = crowded(1.0, 1.0, 1.0);
    a.bar_units = n == 0 ? "kg kg^{-1}" : "kg kg-1";
    a.axis[2].units = n == 2 ? "103 m" : "10^3 m";
    const stratus_camera camera = fitted(&a, 480, 360, 30.0, 20.0, false);
    pictures[n] = draw(&a, &camera, 480, 360, NULL, 0, NULL);
  }
  const size_t bytes = 4 * sizeof(float) * 480 * 360;
  assert_memory_equal(pictures[0], pictures[1], bytes);
  assert_true(memcmp(pictures[1], pictures[2], bytes) != 0);
  for (int n = 0; n < 3; ++n) {
    free(pictures[n]);
  }
}

/* No picture is too small, too narrow or too crowded to be drawn, and none has text that is cut off. */
static void pictures_without_room_leave_text_out(void** state)
{
  (void)state;
  static const int sizes[][2] = { { 1, 1 }, { 3, 40 }, { 48, 40 }, { 700, 30 }, { 40, 700 } };
  for (size_t s = 0; s < sizeof sizes / sizeof *sizes; ++s) {
    const stratus_annotation a = crowded(6.0, 3.0, 2.0);
    stratus_annotation_text texts[64];
    const stratus_camera camera = fitted(&a, sizes[s][0], sizes[s][1], 30.0, 30.0, false);
    size_t count = 0;
    free(draw(&a, &camera, sizes[s][0], sizes[s][1], texts, 64, &count));
    for (size_t i = 0; i < count; ++i) {
      assert_true(texts[i].left >= 2 && texts[i].bottom >= 2 && texts[i].right < sizes[s][0] - 2 && texts[i].top < sizes[s][1] - 2);
    }
  }
}

/* The pixel of a place by Cramer's rule. */
static bool project(const stratus_camera* c, const double place[3], int width, int height, double at[2])
{
  double m[3][3], d[3];
  const double* const columns[3] = { c->forward, c->right, c->up };
  for (int r = 0; r < 3; ++r) {
    d[r] = place[r] - c->eye[r];
    for (int k = 0; k < 3; ++k) {
      m[r][k] = columns[k][r];
    }
  }
  double det[4];
  for (int replaced = 0; replaced < 4; ++replaced) { /* 3: none */
    double n[3][3];
    memcpy(n, m, sizeof n);
    for (int r = 0; r < 3 && replaced < 3; ++r) {
      n[r][replaced] = d[r];
    }
    det[replaced] = n[0][0] * (n[1][1] * n[2][2] - n[1][2] * n[2][1]) - n[0][1] * (n[1][0] * n[2][2] - n[1][2] * n[2][0]) +
      n[0][2] * (n[1][0] * n[2][1] - n[1][1] * n[2][0]);
  }
  const double k = c->parallel ? 1.0 : det[0] / det[3];
  at[0] = (det[1] / det[3] / k + 1.0) * 0.5 * width - 0.5;
  at[1] = (det[2] / det[3] / k + 1.0) * 0.5 * height - 0.5;
  return k > 0.0;
}

/* Both cameras have every place at the same pixel of the part. */
static void camera_of_the_whole_picture_sees_the_part_as_before(void** state)
{
  (void)state;
  const double eye[3] = { 3.0, -8.0, 4.0 }, focal[3] = { 0.5, 0.25, -0.5 }, up[3] = { 0.0, 0.0, 1.0 };
  const double room[4] = { 40.0, 240.0, 70.0, 170.0 };
  uint32_t random = 5;
  for (int parallel = 0; parallel < 2; ++parallel) {
    stratus_camera part, whole;
    assert_int_equal(parallel ? stratus_camera_parallel(context, eye, focal, up, 2.0, 2.0, &part)
                              : stratus_camera_perspective(context, eye, focal, up, 30.0, 2.0, &part),
      STRATUS_OK);
    assert_int_equal(stratus_camera_in_room(context, &part, 400, 300, room, &whole), STRATUS_OK);
    for (int n = 0; n < 100; ++n) {
      double place[3], own[2], at[2] = { NAN, NAN };
      for (int a = 0; a < 3; ++a) {
        place[a] = (double)random_below(&random, 2001) / 500.0 - 2.0;
      }
      assert_true(project(&part, place, 200, 100, own) && project(&whole, place, 400, 300, at));
      assert_true(fabs(own[0] + room[0] - at[0]) < 1e-9 && fabs(own[1] + room[2] - at[1]) < 1e-9);
    }
  }
}

/* ---- coastlines */

typedef struct found_lines {
  double length, bounds[4];
  double nearest, to[2]; /* distance from a place to the nearest vertex */
  size_t count;
  double (*list)[2];
} found_lines;

static void keep(void* data, const double from[2], const double to[2])
{
  found_lines* const found = data;
  for (int end = 0; end < 2; ++end) {
    const double* const p = end ? to : from;
    found->nearest = fmin(found->nearest, hypot(p[0] - found->to[0], p[1] - found->to[1]));
    for (int a = 0; a < 2; ++a) {
      assert_true(p[a] >= found->bounds[2 * a] - 1e-9 && p[a] <= found->bounds[2 * a + 1] + 1e-9);
    }
  }
  assert_true(fabs(from[0] - to[0]) < 20.0); /* no line crosses the map */
  found->length += hypot(from[0] - to[0], from[1] - to[1]);
  if (found->list && found->count < 20000) {
    found->list[found->count][0] = from[0];
    found->list[found->count][1] = from[1];
  }
  ++found->count;
}

static found_lines lines_of(double west, double east, double south, double north, double x, double y)
{
  found_lines found = { 0.0, { west, east, south, north }, INFINITY, { x, y }, 0, NULL };
  stratus_coast_within(found.bounds, keep, &found);
  return found;
}

static void coast_is_where_places_are(void** state)
{
  (void)state;
  /* Capes, of which the coordinates are known to a fraction of what 1:110m shows: half a degree. */
  static const double capes[][2] = { { -9.5, 38.78 }, { 18.47, -34.36 }, { -67.27, -55.98 }, { 142.53, -10.69 }, { -168.09, 65.60 },
    { 25.78, 71.17 }, { 77.55, 8.08 }, { -81.3, -4.68 }, { 51.29, 11.83 } };
  for (size_t i = 0; i < sizeof capes / sizeof *capes; ++i) {
    for (int turn = -1; turn < 3; ++turn) {
      const double x = capes[i][0] + 360.0 * turn, y = capes[i][1];
      const found_lines found = lines_of(x - 5.0, x + 5.0, y - 5.0, y + 5.0, x, y);
      if (!(found.nearest < 0.75)) {
        fail_msg("cape %zu is %g degrees off the coast", i, found.nearest);
      }
    }
  }
  assert_int_equal(lines_of(-40.0, -30.0, 20.0, 35.0, 0.0, 0.0).count, 0); /* the Atlantic */
  assert_int_equal(lines_of(85.0, 95.0, 40.0, 50.0, 0.0, 0.0).count, 0);   /* Asia */
}

/* The seam is anywhere, and bounds cut lines into parts. */
static void coast_is_as_long_from_every_meridian(void** state)
{
  (void)state;
  const double whole = lines_of(-180.0, 180.0, -90.0, 90.0, 0.0, 0.0).length;
  assert_true(whole > 1000.0);
  for (double west = -540.0; west <= 360.0; west += 67.3) {
    assert_true(fabs(lines_of(west, west + 360.0, -90.0, 90.0, 0.0, 0.0).length - whole) < 1e-6 * whole);
    const double cut = lines_of(west, west + 100.0, -90.0, 90.0, 0.0, 0.0).length +
      lines_of(west + 100.0, west + 360.0, -90.0, 12.3, 0.0, 0.0).length +
      lines_of(west + 100.0, west + 360.0, 12.3, 90.0, 0.0, 0.0).length;
    assert_true(fabs(cut - whole) < 1e-6 * whole);
  }
}

/* Ink at the pixel of each vertex, and none beyond the reach of lines. */
static void coast_is_drawn_where_the_camera_has_it(void** state)
{
  (void)state;
  const int width = 640, height = 480;
  const double metres = 6371000.0 * RADIANS;
  for (int deep = 0; deep < 2; ++deep) {
    stratus_annotation a = stratus_annotation_default();
    const double degrees[4] = { 190.0, 330.0, -20.0, 70.0 },
                 bounds[6] = { degrees[0] * metres, degrees[1] * metres, degrees[2] * metres, degrees[3] * metres, deep ? -2e6 : 0.0,
                   deep ? 0.0 : 3e6 };
    memcpy(a.bounds, bounds, sizeof bounds);
    a.coast = 1;
    a.axis[0].kind = STRATUS_AXIS_LONGITUDE;
    a.axis[1].kind = STRATUS_AXIS_LATITUDE;
    a.axis[0].scale = a.axis[1].scale = 1.0 / metres;
    a.axis[2].scale = deep ? -1e-3 : 1e-3;
    const stratus_camera camera = fitted(&a, width, height, -70.0, 35.0, deep == 1);
    float* const rgba = draw(&a, &camera, width, height, NULL, 0, NULL);
    found_lines found = { 0.0, { degrees[0], degrees[1], degrees[2], degrees[3] }, INFINITY, { 0.0, 0.0 }, 0, NULL };
    found.list = calloc(20000, sizeof *found.list);
    stratus_coast_within(found.bounds, keep, &found);
    assert_in_range(found.count, 500, 20000);
    for (size_t i = 0; i < found.count; ++i) {
      const double place[3] = { found.list[i][0] * metres, found.list[i][1] * metres, 0.0 };
      double at[2];
      assert_true(project(&camera, place, width, height, at));
      assert_true(at[0] > 0.0 && at[1] > 0.0 && at[0] < width - 1 && at[1] < height - 1);
      const size_t pixel = (size_t)lround(at[1]) * (size_t)width + (size_t)lround(at[0]);
      assert_true(rgba[4 * pixel + 3] > 0.15f); /* a line's middle is at most 0.71 off: 0.8 (1.1 - 0.71) */
    }
    size_t inked = 0;
    for (size_t i = 0; i < (size_t)width * (size_t)height; ++i) {
      inked += rgba[4 * i + 3] > 0.0f ? 1 : 0;
    }
    assert_true(inked > 500 && inked < 15000); /* lines, not areas */
    free(found.list);
    free(rgba);
  }
}

/* ---- refusals, and memory */

static void refused(stratus_status status, const char* words)
{
  assert_int_equal(status, STRATUS_INVALID_ARGUMENT);
  if (!strstr(stratus_context_message(context), words)) {
    fail_msg("'%s' is not in the message '%s'", words, stratus_context_message(context));
  }
}

static void wrong_annotations_are_refused(void** state)
{
  (void)state;
  double room[4];
  stratus_annotation a = crowded(6.0, 3.0, 2.0);
  const stratus_camera camera = fitted(&a, 64, 64, 30.0, 30.0, false);
  refused(stratus_annotation_room(context, NULL, 64, 64, room), "annotation is NULL");
  refused(stratus_annotation_room(context, &a, 0, 64, room), "0x64 pixels");
  refused(stratus_annotation_room(context, &a, 64, 64, NULL), "room is NULL");
  refused(stratus_annotation_draw(context, &a, &camera, NULL, NULL, 0, NULL), "NULL");
  a.ink = 2.0;
  refused(stratus_annotation_room(context, &a, 64, 64, room), "ink 2, must be 0..1");
  a = crowded(6.0, 3.0, 2.0);
  a.low = 1.0;
  refused(stratus_annotation_room(context, &a, 64, 64, room), "a colour bar from 1 to 0.01");
  a = crowded(6.0, 3.0, 2.0);
  a.low = 0.0;
  a.logarithmic = 1;
  refused(stratus_annotation_room(context, &a, 64, 64, room), "above 0 by logarithms");
  a = crowded(6.0, 3.0, 2.0);
  a.bounds[1] = NAN;
  refused(stratus_annotation_room(context, &a, 64, 64, room), "bounds along axis 0 are -6 to nan");
  a = crowded(6.0, 3.0, 2.0);
  a.coast = 1;
  a.globe = -1.0;
  refused(stratus_annotation_room(context, &a, 64, 64, room), "a globe of radius -1, must be 0 or more");
  a.globe = 0.0;
  a.axis[0].kind = STRATUS_AXIS_NUMBER;
  refused(stratus_annotation_room(context, &a, 64, 64, room), "coastlines need an axis of longitudes");
  a.axis[0].kind = STRATUS_AXIS_LONGITUDE;
  a.axis[0].scale = 1e3;
  refused(stratus_annotation_room(context, &a, 64, 64, room), "coastlines at longitude -6000 degrees, must be in -3600..3600");
  a = crowded(6.0, 3.0, 2.0);
  stratus_camera flat = camera;
  memcpy(flat.up, flat.right, sizeof flat.up);
  float rgba[4] = { 0 };
  stratus_image image = { 0 };
  image.width = image.height = 1;
  image.rgba = rgba;
  refused(stratus_annotation_draw(context, &a, &flat, &image, NULL, 0, NULL), "in one plane");
  const double none[4] = { 5.0, 5.0, 0.0, 9.0 };
  refused(stratus_camera_in_room(context, &camera, 64, 64, none, &flat), "a room of 5..5 x 0..9 pixels");
}

static void wrong_globes_are_refused(void** state)
{
  (void)state;
  float depth[4], light[4] = { 0 }, rgba[16] = { 0 };
  stratus_camera camera = { .eye = { 9.0, 0.0, 0.0 }, .forward = { -1.0, 0.0, 0.0 }, .right = { 0.0, 1.0, 0.0 }, .up = { 0.0, 0.0, 1.0 } };
  stratus_image image = { .width = 2, .height = 2, .rgba = rgba };
  stratus_globe globe = stratus_globe_default();
  refused(stratus_globe_end_rays(context, &globe, 0, 2, &camera, depth, light), "0x2 pixels, each side must be 1..65536");
  globe.ink = 2.0;
  globe.coast = 1;
  refused(stratus_globe_draw(context, &globe, &camera, light, &image), "ink 2, must be 0..1");
  globe.innermost = 0.0;
  refused(stratus_globe_end_rays(context, &globe, 2, 2, &camera, depth, light), "points at 0 from its middle, must be above 0");
  refused(stratus_globe_draw(context, &globe, &camera, light, &image), "points at 0 from its middle, must be above 0");
  globe = stratus_globe_default();
  camera.forward[0] = 0.0;
  refused(stratus_globe_end_rays(context, &globe, 2, 2, &camera, depth, light), "a forward vector of length 0");
}

static void every_allocation_may_fail(void** state)
{
  (void)state;
  const stratus_annotation a = crowded(6.0, 3.0, 2.0);
  const stratus_camera camera = fitted(&a, 320, 240, 30.0, 30.0, false);
  float* const rgba = calloc(4 * 320 * 240, sizeof(float));
  stratus_image image = { 0 };
  image.width = 320;
  image.height = 240;
  image.rgba = rgba;
  for (int64_t n = 0, last = 1; n <= last; ++n) {
    faulty_allocator allocator = { 0, 0, 0 };
    const stratus_context_options options = faulty_options(&allocator, "host");
    stratus_context* faulty = NULL;
    char message[256];
    assert_int_equal(stratus_context_create(&options, &faulty, message, sizeof message), STRATUS_OK);
    const int64_t live = allocator.live, made = allocator.calls;
    allocator.fail_at = n ? made + n : 0;
    const stratus_status status = stratus_annotation_draw(faulty, &a, &camera, &image, NULL, 0, NULL);
    assert_int_equal(status, n ? STRATUS_OUT_OF_MEMORY : STRATUS_OK);
    assert_true(allocator.live == live);
    last = n ? last : allocator.calls - made;
    stratus_context_destroy(faulty);
  }
  free(rgba);
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

int test_annotation(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(text_is_whole_and_covers_no_other),
    cmocka_unit_test(exponents_in_braces_are_written_as_cf_does),
    cmocka_unit_test(pictures_without_room_leave_text_out),
    cmocka_unit_test(camera_of_the_whole_picture_sees_the_part_as_before),
    cmocka_unit_test(wrong_annotations_are_refused),
    cmocka_unit_test(wrong_globes_are_refused),
    cmocka_unit_test(every_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, make, destroy);
}

/* On a globe: ink at the pixel of each vertex that is nearer to the eye than the limb, and none outside of the disk. */
static void coast_is_on_the_side_of_the_globe_that_faces_the_eye(void** state)
{
  (void)state;
  const int size = 480;
  for (int parallel = 0; parallel < 2; ++parallel) {
    stratus_annotation a = stratus_annotation_default();
    a.coast = 1;
    a.globe = 2.0;
    const double eye = parallel ? 9.0 : 7.0, half = parallel ? 2.5 : 0.4;
    const stratus_camera camera = {
      .eye = { 0.0, -eye, 0.0 }, .forward = { 0.0, 1.0, 0.0 }, .right = { half, 0.0, 0.0 }, .up = { 0.0, 0.0, half }, .parallel = parallel
    };
    float* const rgba = draw(&a, &camera, size, size, NULL, 0, NULL);
    found_lines found = { 0.0, { -180.0, 180.0, -90.0, 90.0 }, INFINITY, { 0.0, 0.0 }, 0, NULL };
    found.list = calloc(20000, sizeof *found.list);
    stratus_coast_within(found.bounds, keep, &found);
    size_t seen = 0, inked = 0;
    for (size_t i = 0; i + 1 < found.count; ++i) {
      const double longitude = found.list[i][0] * RADIANS, latitude = found.list[i][1] * RADIANS;
      const double place[3] = { 2.0 * cos(latitude) * cos(longitude), 2.0 * cos(latitude) * sin(longitude), 2.0 * sin(latitude) };
      double at[2];
      /* a line to the next vertex may pass the limb */
      if (-place[1] > (parallel ? 0.0 : 4.0 / eye) + 0.2 && project(&camera, place, size, size, at)) {
        const size_t pixel = (size_t)lround(at[1]) * (size_t)size + (size_t)lround(at[0]);
        assert_true(rgba[4 * pixel + 3] > 0.15f);
        ++seen;
      }
    }
    const double disk = (parallel ? 2.0 : 2.0 / sqrt(eye * eye - 4.0)) / half * 0.5 * size + 2.0; /* in pixels */
    for (int i = 0; i < size * size; ++i) {
      const bool ink = rgba[4 * i + 3] > 0.0f;
      inked += ink ? 1 : 0;
      assert_true(!ink || hypot(i % size - 0.5 * (size - 1), (double)(i / size) - 0.5 * (size - 1)) < disk);
    }
    assert_in_range(seen, 500, 5000);
    assert_in_range(inked, 1000, 30000);
    free(found.list);
    free(rgba);
  }
}

/* The Earth's disk is as large as the camera has it, and it is behind the picture. Its depths are on the sphere. */
static void earth_is_a_sphere_behind_the_picture(void** state)
{
  (void)state;
  enum { SIZE = 200 };
  const double innermost = 6400000.0, radius = 0.9997 * innermost;
  float* const depth = calloc(SIZE * SIZE, sizeof(float));
  float* const light = calloc(SIZE * SIZE, sizeof(float));
  float* const rgba = calloc(4 * SIZE * SIZE, sizeof(float));
  for (int parallel = 0; parallel < 2; ++parallel) {
    const double eye[3] = { 3.0 * radius, 0.0, 0.0 }, focal[3] = { 0.0, 0.0, 0.0 }, up[3] = { 0.0, 0.0, 1.0 };
    stratus_camera camera;
    assert_int_equal(parallel ? stratus_camera_parallel(context, eye, focal, up, 1.5 * radius, 1.0, &camera)
                              : stratus_camera_perspective(context, eye, focal, up, 60.0, 1.0, &camera),
      STRATUS_OK);
    stratus_globe globe = stratus_globe_default();
    globe.innermost = innermost;
    assert_int_equal(stratus_globe_end_rays(context, &globe, SIZE, SIZE, &camera, depth, light), STRATUS_OK);
    const double across = 0.5 * SIZE * (parallel ? 1.0 / 1.5 : tan(asin(1.0 / 3.0)) / tan(30.0 * RADIANS));
    for (int i = 0; i < SIZE * SIZE; ++i) {
      const double u = (2.0 * (i % SIZE) + 1.0) / SIZE - 1.0, v = (2.0 * (double)(i / SIZE) + 1.0) / SIZE - 1.0,
                   away = 0.5 * SIZE * hypot(u, v);
      assert_true(fabs(away - across) < 1e-6 || (light[i] > 0.0f) == (away < across));
      assert_true((depth[i] < 1.0f) == (light[i] > 0.0f));
      rgba[4 * i] = rgba[4 * i + 3] = i % 2 ? 0.5f : 0.0f;
      rgba[4 * i + 1] = rgba[4 * i + 2] = 0.0f;
      if (light[i] > 0.0f) {
        const double range = camera.far_k - camera.near_k,
                     k = parallel ? camera.near_k + (double)depth[i] * range
                                  : camera.near_k / (1.0 - (double)depth[i] * range / camera.far_k);
        double square = 0.0;
        for (int a = 0; a < 3; ++a) {
          const double aside = u * camera.right[a] + v * camera.up[a],
                       x = camera.eye[a] + k * camera.forward[a] + (parallel ? 1.0 : k) * aside;
          square += x * x;
        }
        assert_true(fabs(sqrt(square) / radius - 1.0) < 2e-3); /* 24 bits of depth, from a thousandth of the range on */
      }
    }
    const stratus_image image = { .width = SIZE, .height = SIZE, .rgba = rgba };
    assert_int_equal(stratus_globe_draw(context, &globe, &camera, light, &image), STRATUS_OK);
    for (int i = 0; i < SIZE * SIZE; ++i) {
      const float own = i % 2 ? 0.5f : 0.0f, shown = 0.36f * (0.3f + 0.7f * light[i]);
      assert_true(
        light[i] > 0.0f ? rgba[4 * i + 3] == 1.0f && fabsf(rgba[4 * i + 2] - (1.0f - own) * shown) < 1e-6f : rgba[4 * i + 3] == own);
    }
  }
  free(depth);
  free(light);
  free(rgba);
}

/* The stereographic projection of a sphere from the south pole, north of 20 degrees. Rotated by the double that data points to. */
static int place_polar(void* data, const double degrees[2], double place[2])
{
  const double turn = *(const double*)data, distance = 2.0 * tan(0.5 * (90.0 - degrees[1]) * RADIANS);
  place[0] = distance * sin((degrees[0] - turn) * RADIANS);
  place[1] = -distance * cos((degrees[0] - turn) * RADIANS);
  return degrees[1] >= 20.0;
}

/* Longitudes from the double that data points to, on the way round. */
static int place_turned(void* data, const double degrees[2], double place[2])
{
  const double first = *(const double*)data;
  place[0] = degrees[0] - 360.0 * floor((degrees[0] - first) / 360.0);
  place[1] = degrees[1];
  return 1;
}

static void coast_on_a_plane_is_where_the_projection_has_it(void** state)
{
  (void)state;
  const int size = 480;
  double turn = -45.0;
  stratus_annotation a = stratus_annotation_default();
  const double bounds[6] = { -0.9, 0.7, -0.8, 0.8, 0.0, 0.1 };
  memcpy(a.bounds, bounds, sizeof bounds);
  a.coast = 1;
  a.coast_place = place_polar;
  a.coast_data = &turn;
  const stratus_camera camera = fitted(&a, size, size, -90.0, 89.0, true);
  float* const rgba = draw(&a, &camera, size, size, NULL, 0, NULL);
  found_lines found = { 0.0, { -180.0, 180.0, -90.0, 90.0 }, INFINITY, { 0.0, 0.0 }, 0, NULL };
  found.list = calloc(20000, sizeof *found.list);
  stratus_coast_within(found.bounds, keep, &found);
  size_t seen = 0, inked = 0;
  for (size_t i = 0; i < found.count; ++i) {
    double place[3] = { 0.0, 0.0, 0.0 }, at[2];
    if (place_polar(&turn, found.list[i], place) && place[0] > bounds[0] && place[0] < bounds[1] && place[1] > bounds[2] &&
      place[1] < bounds[3]) {
      assert_true(project(&camera, place, size, size, at));
      assert_true(rgba[4 * ((size_t)lround(at[1]) * (size_t)size + (size_t)lround(at[0])) + 3] > 0.15f);
      ++seen;
    }
  }
  /* no line leaves the box */
  const double corner[3] = { bounds[0], bounds[2], 0.0 }, other[3] = { bounds[1], bounds[3], 0.0 };
  double low[2], high[2];
  assert_true(project(&camera, corner, size, size, low) && project(&camera, other, size, size, high));
  for (int i = 0; i < size * size; ++i) {
    const int x = i % size, y = i / size;
    inked += rgba[4 * i + 3] > 0.0f ? 1 : 0;
    assert_true(rgba[4 * i + 3] == 0.0f || (x > low[0] - 3.0 && x < high[0] + 3.0 && y > low[1] - 3.0 && y < high[1] + 3.0));
  }
  assert_in_range(seen, 500, 5000);
  assert_in_range(inked, 1000, 30000);
  free(found.list);
  free(rgba);
}

/* Around a plane of longitudes: as lines of longitudes are, without lines across the map where the projection tears them. */
static void coast_is_not_drawn_across_a_seam(void** state)
{
  (void)state;
  const int width = 640, height = 400, size = width * height;
  double first = 30.0;
  stratus_annotation a = stratus_annotation_default();
  const double bounds[6] = { first, first + 360.0, -80.0, 80.0, 0.0, 10.0 };
  memcpy(a.bounds, bounds, sizeof bounds);
  a.coast = 1;
  a.axis[0].kind = STRATUS_AXIS_LONGITUDE;
  a.axis[1].kind = STRATUS_AXIS_LATITUDE;
  const stratus_camera camera = fitted(&a, width, height, -90.0, 89.0, true);
  float* const plain = draw(&a, &camera, width, height, NULL, 0, NULL);
  a.coast_place = place_turned;
  a.coast_data = &first;
  a.axis[0].kind = a.axis[1].kind = STRATUS_AXIS_NUMBER; /* which are not used */
  float* const turned = draw(&a, &camera, width, height, NULL, 0, NULL);
  size_t missing = 0, added = 0, inked = 0;
  for (int i = 0; i < size; ++i) {
    bool near_plain = false, near_turned = false;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const int at = i + dy * width + dx;
        near_plain = near_plain || (at >= 0 && at < size && plain[4 * at + 3] > 0.0f);
        near_turned = near_turned || (at >= 0 && at < size && turned[4 * at + 3] > 0.0f);
      }
    }
    missing += plain[4 * i + 3] > 0.0f && !near_turned ? 1 : 0;
    added += turned[4 * i + 3] > 0.0f && !near_plain ? 1 : 0;
    inked += plain[4 * i + 3] > 0.0f ? 1 : 0;
  }
  assert_int_equal(added, 0);
  assert_true(missing < 20); /* the torn pieces, of at most half a degree: a pixel has .7 degrees */
  assert_true(inked > 3000);
  free(plain);
  free(turned);
}

int test_coast(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(coast_is_where_places_are),
    cmocka_unit_test(coast_is_as_long_from_every_meridian),
    cmocka_unit_test(coast_is_drawn_where_the_camera_has_it),
    cmocka_unit_test(coast_is_on_the_side_of_the_globe_that_faces_the_eye),
    cmocka_unit_test(earth_is_a_sphere_behind_the_picture),
    cmocka_unit_test(coast_on_a_plane_is_where_the_projection_has_it),
    cmocka_unit_test(coast_is_not_drawn_across_a_seam),
  };
  return cmocka_run_group_tests(tests, make, destroy);
}
