/* SPDX-License-Identifier: BSD-3-Clause
 * The fields of bone, skin, stripes, shell, plate and labels, one row of x at a time, and their shading. They need no function of the C
 * library but the square root, which IEEE 754 rounds correctly, so that their bits are the same on every machine. Only scenes.c includes
 * this file. */
#ifndef STRATUS_SCENES_MEDIA_H
#define STRATUS_SCENES_MEDIA_H

#include "scenes_noise.h"

#include <math.h>

/* ---------------------------------------------------------------- distances */

static float media_clamp(float value, float low, float high)
{
  return value < low ? low : value > high ? high : value;
}

static float media_length(float x, float y, float z)
{
  return sqrtf(x * x + y * y + z * z);
}

/* Returns about the distance to an ellipsoid in voxels, negative inside. */
static float media_ellipsoid(float x, float y, float z, float a, float b, float c)
{
  const float least = a < b ? (a < c ? a : c) : (b < c ? b : c);
  return (media_length(x / a, y / b, z / c) - 1.0f) * least;
}

/* Returns the share of a solid at a signed distance from its surface, which blurs over `width` voxels as a scanner does. */
static float media_share(float distance, float width)
{
  return noise_fade(media_clamp(.5f - distance / width, 0.0f, 1.0f));
}

static float media_least(float a, float b)
{
  return a < b ? a : b;
}

/* ---------------------------------------------------------------- bone and skin: a head of computed tomography
 *
 * Values are a 12-bit scanner's: air 0, water 1000, soft tissue about 1040, bone 1300 to 2400. y is up, z points to the face. */

#define CT_BLUR 3.0f

/* Returns the distance to the soft tissue's surface: a head, a neck, a nose. */
static float ct_body(float x, float y, float z)
{
  const float head = media_ellipsoid(x, y - 158.0f, z, 72.0f, 84.0f, 88.0f);
  const float jaw = media_ellipsoid(x, y - 96.0f, z - 36.0f, 46.0f, 44.0f, 50.0f);
  const float nose = media_ellipsoid(x, y - 134.0f, z - 88.0f, 10.0f, 20.0f, 18.0f);
  float neck = media_length(x, 0.0f, z + 8.0f) - 44.0f;
  neck = y > 130.0f ? neck + (y - 130.0f) : neck;
  return media_least(media_least(head, jaw), media_least(nose, neck));
}

/* Returns the distance to the bone's surface: a shell with sockets and a nose's opening, a jaw, vertebrae. */
static float ct_skeleton(float x, float y, float z)
{
  const float side = x < 0.0f ? -x : x;
  const float brain = media_ellipsoid(x, y - 160.0f, z, 63.0f, 75.0f, 79.0f);
  float skull = (brain < 0.0f ? -brain : brain) - 3.0f;
  const float socket = media_ellipsoid(side - 27.0f, y - 148.0f, z - 74.0f, 17.0f, 14.0f, 26.0f);
  const float opening = media_ellipsoid(x, y - 124.0f, z - 76.0f, 9.0f, 14.0f, 22.0f);
  const float foramen = media_length(x, 0.0f, z + 8.0f) - 13.0f;
  skull = skull < -socket ? -socket : skull;
  skull = skull < -opening ? -opening : skull;
  skull = y < 120.0f && skull < -foramen ? -foramen : skull;
  float jaw = media_ellipsoid(x, 0.0f, z - 36.0f, 35.0f, 1.0f, 40.0f) * 35.0f;
  jaw = (jaw < 0.0f ? -jaw : jaw) - 4.0f;
  const float height = (y - 78.0f < 0.0f ? 78.0f - y : y - 78.0f) - 13.0f;
  jaw = jaw < height ? height : jaw;
  jaw = z < 20.0f && jaw < 20.0f - z ? 20.0f - z : jaw;
  /* A vertebra each 18 voxels: a body, a ring around the cord, and a process that points back. */
  const int number = (int)(y / 18.0f);
  const float middle = y - 18.0f * (float)number - 9.0f;
  const float body = media_ellipsoid(x, middle, z - 6.0f, 17.0f, 6.5f, 13.0f);
  float ring = media_length(x, 0.0f, z + 14.0f) - 11.0f;
  ring = media_length(ring, middle, 0.0f) - 3.5f;
  const float process = media_ellipsoid(x, middle + .3f * (z + 34.0f), z + 34.0f, 3.5f, 4.0f, 14.0f);
  const float spine = number < 5 ? media_least(media_least(body, ring), process) : 90.0f;
  return media_least(media_least(skull, jaw), spine);
}

static void ct_field(const field_tables* tables, int j, int k, float* row)
{
  (void)tables;
  noise_row grain;
  noise_row texture;
  noise_row_start(&grain, (float)j * .6f, (float)k * .6f, 2, 401);
  noise_row_start(&texture, (float)j * .06f, (float)k * .06f, 4, 411);
  const float y = (float)j, z = (float)k - 120.0f;
  for (int i = 0; i < 256; ++i) {
    const float x = (float)i - 127.5f;
    const float rough = noise_row_value(&texture, (float)i * .06f) - .45f;
    const float body = ct_body(x, y, z) + 2.0f * rough;
    const float noise = 90.0f * (noise_row_value(&grain, (float)i * .6f) - .37f);
    float value = 0.0f;
    if (body < 4.0f) {
      const float skeleton = ct_skeleton(x, y, z);
      /* Bone is dense at its surface and spongy inside. */
      const float dense = 1750.0f + 900.0f * rough - 300.0f * media_share(skeleton + 6.0f, 4.0f);
      const float soft = 1040.0f + 120.0f * rough;
      const float bone = media_share(skeleton, CT_BLUR);
      value = media_share(body, CT_BLUR) * (soft + bone * (dense - soft));
    }
    row[i] = value + noise;
  }
}

static void ct_shade(int j, int k, const float* row, float threshold, float height, void* values)
{
  (void)j;
  (void)k;
  (void)threshold;
  (void)height;
  uint16_t* out = values;
  for (int i = 0; i < 256; ++i) {
    out[i] = (uint16_t)(media_clamp(row[i], 0.0f, 4095.0f) + .5f);
  }
}

/* ---------------------------------------------------------------- stripes: a smooth field that fills the volume */

static void stripes_field(const field_tables* tables, int j, int k, float* row)
{
  (void)tables;
  noise_row noise;
  noise_row_start(&noise, (float)j * .021f, (float)k * .021f, 2, 501);
  for (int i = 0; i < 256; ++i) {
    row[i] = noise_row_value(&noise, (float)i * .021f);
  }
}

/* Stretches the field to 0..1. */
static void stripes_shade(int j, int k, const float* row, float threshold, float height, void* values)
{
  (void)j;
  (void)k;
  float* out = values;
  for (int i = 0; i < 256; ++i) {
    out[i] = (row[i] - threshold) / height;
  }
}

/* ---------------------------------------------------------------- shell and plate: fog, 95 % occupied, and a thin solid in it
 *
 * Fog takes the values up to .6. The solid's value is 1 on its middle and falls to .6 within SOLID_HALF voxels. */

#define SOLID_HALF 1.6f

static float solid_value(float distance)
{
  return media_clamp(1.2f - .6f * distance / SOLID_HALF, 0.0f, 1.0f);
}

static void shell_shade(int j, int k, const float* row, float threshold, float height, void* values)
{
  float* out = values;
  for (int i = 0; i < 256; ++i) {
    const float fog = .6f * ((row[i] - threshold) / height);
    const float apart = media_length((float)i - 127.5f, (float)j - 127.5f, (float)k - 127.5f) - 80.0f;
    const float solid = solid_value(apart < 0.0f ? -apart : apart);
    out[i] = solid > .6f ? solid : fog > 0.0f ? fog : 0.0f;
  }
}

/* The plate is a square of 40 voxels. Its axes (3 2 6)/7, (2 6 -3)/7 and (6 -3 -2)/7 are skew to the grid. */
static void plate_shade(int j, int k, const float* row, float threshold, float height, void* values)
{
  float* out = values;
  const float y = (float)j - 127.5f, z = (float)k - 127.5f;
  for (int i = 0; i < 256; ++i) {
    const float x = (float)i - 127.5f;
    const float fog = .6f * ((row[i] - threshold) / height);
    const float across = (3.0f * x + 2.0f * y + 6.0f * z) / 7.0f;
    const float u = (2.0f * x + 6.0f * y - 3.0f * z) / 7.0f;
    const float v = (6.0f * x - 3.0f * y - 2.0f * z) / 7.0f;
    const bool within = u > -20.0f && u < 20.0f && v > -20.0f && v < 20.0f;
    const float solid = within ? solid_value(across < 0.0f ? -across : across) : 0.0f;
    out[i] = solid > .6f ? solid : fog > 0.0f ? fog : 0.0f;
  }
}

/* ---------------------------------------------------------------- labels: regions 1 to 10 in a body, 0 around it */

#define LABEL_SEEDS 40
#define LABEL_SIDE 192

static void labels_field(const field_tables* tables, int j, int k, float* row)
{
  (void)tables;
  float seeds[LABEL_SEEDS][3]; /* x; square of the distance in y and z; weight of the noise, which makes borders rough */
  const float y = (float)j - 95.5f, z = (float)k - 95.5f;
  for (uint32_t s = 0; s < LABEL_SEEDS; ++s) {
    const float dy = y - 120.0f * (noise_unit(s, 612) - .5f);
    const float dz = z - 140.0f * (noise_unit(s, 613) - .5f);
    seeds[s][0] = 150.0f * (noise_unit(s, 611) - .5f);
    seeds[s][1] = dy * dy + dz * dz;
    seeds[s][2] = 40.0f * noise_unit(s, 614);
  }
  noise_row noise;
  noise_row_start(&noise, (float)j * .05f, (float)k * .05f, 3, 601);
  for (int i = 0; i < LABEL_SIDE; ++i) {
    const float x = (float)i - 95.5f;
    const float rough = noise_row_value(&noise, (float)i * .05f) - .45f;
    const float body = media_ellipsoid(x, y, z, 86.0f, 70.0f, 80.0f) + 24.0f * rough;
    float nearest = 1e9f;
    int label = 0;
    for (int s = 0; body < 0.0f && s < LABEL_SEEDS; ++s) {
      const float dx = x - seeds[s][0];
      const float distance = sqrtf(dx * dx + seeds[s][1]) + rough * seeds[s][2];
      if (distance < nearest) {
        nearest = distance;
        label = 1 + s % 10;
      }
    }
    row[i] = (float)label;
  }
}

static void labels_shade(int j, int k, const float* row, float threshold, float height, void* values)
{
  (void)j;
  (void)k;
  (void)threshold;
  (void)height;
  uint8_t* out = values;
  for (int i = 0; i < LABEL_SIDE; ++i) {
    out[i] = (uint8_t)row[i];
  }
}

#endif
