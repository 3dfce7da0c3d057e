/* SPDX-License-Identifier: BSD-3-Clause
 * The fields of the volumes of record, one row of x at a time, and their shading above the threshold. Only scenes.c includes this file. */
#ifndef STRATUS_SCENES_FIELDS_H
#define STRATUS_SCENES_FIELDS_H

#include "scenes_noise.h"

#include <math.h>

#define BLOBS 28
#define ROW_MAX 512

/* Tables that all rows of a field share. */
typedef struct field_tables {
  struct {
    float y, z, r;
    float dx2[256];
  } blobs[BLOBS];                             /* cloud */
  float cy[ROW_MAX], cz[ROW_MAX], r[ROW_MAX]; /* plume: axis and radius at each x */
} field_tables;

/* ---------------------------------------------------------------- cloud: blobs with flat bases, eroded by noise, 3 % occupied */

static void cloud_tables(field_tables* tables)
{
  for (uint32_t b = 0; b < BLOBS; ++b) {
    const float x = 20.0f + 216.0f * noise_unit(b, 1);
    const float r = 10.0f + 26.0f * noise_unit(b, 4) * noise_unit(b, 5);
    tables->blobs[b].y = 36.0f + 10.0f * noise_unit(b, 2);
    tables->blobs[b].z = 20.0f + 216.0f * noise_unit(b, 3);
    tables->blobs[b].r = r;
    for (int i = 0; i < 256; ++i) {
      const float dx = ((float)i - x) / r;
      tables->blobs[b].dx2[i] = dx * dx;
    }
  }
}

/* A row of the cloud's field at a height, and at `away` along the third axis. */
static void cloud_row(const field_tables* tables, float height, float away, float* row)
{
  for (int i = 0; i < 256; ++i) {
    row[i] = -9.0f;
  }
  for (int b = 0; b < BLOBS; ++b) {
    const float y = tables->blobs[b].y;
    const float r = tables->blobs[b].r;
    const float dy = (height - y) / (r * (height < y ? 0.35f : 1.3f));
    const float dz = (away - tables->blobs[b].z) / r;
    const float dy2 = dy * dy;
    const float dz2 = dz * dz;
    const float* dx2 = tables->blobs[b].dx2;
    for (int i = 0; i < 256; ++i) {
      const float inside = 1.0f - (dx2[i] + dy2 + dz2);
      row[i] = row[i] < inside ? inside : row[i];
    }
  }
  noise_row noise;
  noise_row_start(&noise, height * .07f, away * .07f, 5, 11);
  for (int i = 0; i < 256; ++i) {
    if (row[i] > -1.5f) {
      row[i] = row[i] + 1.8f * (noise_row_value(&noise, (float)i * .07f) - .5f);
    }
  }
}

static void cloud_field(const field_tables* tables, int j, int k, float* row)
{
  cloud_row(tables, (float)j, (float)k, row);
}

static void cloud_shade_row(float up, float away, const float* row, float threshold, float height, void* values)
{
  float* out = values;
  noise_row noise;
  noise_row_start(&noise, up * .15f, away * .15f, 4, 77);
  for (int i = 0; i < 256; ++i) {
    const float e = (row[i] - threshold) / height;
    float value = 0.0f;
    if (e > 0.0f) {
      const float n = noise_row_value(&noise, (float)i * .15f);
      value = powf(e, 0.8f) * (0.08f + 2.2f * n * n * n + .4f * e);
    }
    out[i] = value < 1.0f ? value : 1.0f;
  }
}

static void cloud_shade(int j, int k, const float* row, float threshold, float height, void* values)
{
  cloud_shade_row((float)j, (float)k, row, threshold, height, values);
}

/* ---------------------------------------------------------------- cumulus-rectilinear: the cloud on levels that stretch with height */

#define CUMULUS_LEVELS 96

/* The height of a level: the lowest two are .4 apart, and each step is 3 % longer than the one below it. */
static double cumulus_height(int level)
{
  double height = 0.0, step = 0.4;
  for (int k = 0; k < level; ++k) {
    height += step;
    step *= 1.03;
  }
  return height;
}

static void cumulus_field(const field_tables* tables, int j, int k, float* row)
{
  cloud_row(tables, (float)cumulus_height(k), (float)j, row);
}

static void cumulus_shade(int j, int k, const float* row, float threshold, float height, void* values)
{
  cloud_shade_row((float)cumulus_height(k), (float)j, row, threshold, height, values);
}

/* ---------------------------------------------------------------- plume: meandering, 1 % occupied */

static void plume_tables(field_tables* tables)
{
  for (int i = 8; i < 512; ++i) {
    const float u = (float)(i - 8) / 504.0f;
    tables->cy[i] = 256.0f + 70.0f * sinf(5.0f * u) + 20.0f * sinf(17.0f * u + 1.0f);
    tables->cz[i] = 60.0f + 110.0f * sqrtf(u) + 10.0f * sinf(11.0f * u);
    tables->r[i] = 5.0f + 44.0f * u;
  }
}

static void plume_field(const field_tables* tables, int j, int k, float* row)
{
  float away[512];
  for (int i = 8; i < 512; ++i) {
    const float dy = ((float)j - tables->cy[i]) / tables->r[i];
    const float dz = ((float)k - tables->cz[i]) / (.8f * tables->r[i]);
    away[i] = dy * dy + dz * dz;
  }
  noise_row noise;
  noise_row_start(&noise, (float)j * .06f, (float)k * .06f, 5, 5);
  for (int i = 0; i < 512; ++i) {
    row[i] = i >= 8 && away[i] < 9.0f ? 1.0f - away[i] + 2.2f * (noise_row_value(&noise, (float)i * .06f) - .5f) : -9.0f;
  }
}

static void plume_shade(int j, int k, const float* row, float threshold, float height, void* values)
{
  uint8_t* out = values;
  noise_row noise;
  noise_row_start(&noise, (float)j * .12f, (float)k * .12f, 4, 9);
  for (int i = 0; i < 512; ++i) {
    const float e = (row[i] - threshold) / height;
    out[i] = 0;
    if (e > 0.0f) {
      const float u = (float)(i - 8) / 504.0f;
      const float d = powf(e, .7f) * (1.1f - .8f * u) * (.3f + 1.4f * noise_row_value(&noise, (float)i * .12f));
      const float rounded = roundf(255.0f * d);
      out[i] = (uint8_t)(rounded < 1.0f ? 1.0f : rounded > 255.0f ? 255.0f : rounded);
    }
  }
}

/* ---------------------------------------------------------------- fog: noise everywhere, 80 % occupied */

static void fog_field(const field_tables* tables, int j, int k, float* row)
{
  (void)tables;
  noise_row noise;
  noise_row_start(&noise, (float)j * .025f, (float)k * .025f, 6, 3);
  for (int i = 0; i < 256; ++i) {
    row[i] = noise_row_value(&noise, (float)i * .025f);
  }
}

static void fog_shade(int j, int k, const float* row, float threshold, float height, void* values)
{
  (void)j;
  (void)k;
  float* out = values;
  for (int i = 0; i < 256; ++i) {
    const float e = (row[i] - threshold) / height;
    out[i] = e > 0.0f ? e : 0.0f;
  }
}

#endif
