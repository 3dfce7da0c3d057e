/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures of which the bits are on record: colours, alpha and depth, as docs/pictures.md promises them. Whoever changes bits on purpose
 * writes down the new ones, which the test prints, and says so in CHANGELOG.md. */
#ifndef STRATUS_TESTING_PICTURE_BITS_H
#define STRATUS_TESTING_PICTURE_BITS_H

#include "picture_case.h"
#include "tetra_case.h"

/* FNV-1a over bytes. */
static inline uint64_t bits_add(uint64_t hash, const void* data, size_t size)
{
  const unsigned char* bytes = data;
  for (size_t i = 0; i < size; ++i) {
    hash = (hash ^ bytes[i]) * 0x100000001b3u;
  }
  return hash;
}

#define BITS_START 0xcbf29ce484222325u

typedef struct bits_of_record {
  const char* name;
  stratus_mode mode;
  stratus_sampling sampling;
  stratus_type type;
  int shade, nearest, jitter, crop;
  uint64_t bits;
} bits_of_record;

static const bits_of_record bits_images[] = {
  { "automatic", STRATUS_MODE_COMPOSITE, STRATUS_SAMPLING_AUTO, STRATUS_FLOAT32, 0, 0, 0, 0, 0x5042c58dd9957008u },
  { "midpoint", STRATUS_MODE_COMPOSITE, STRATUS_SAMPLING_MIDPOINT, STRATUS_UINT8, 0, 0, 0, 0, 0x585efe4845a3ab6eu },
  { "pre-integrated", STRATUS_MODE_COMPOSITE, STRATUS_SAMPLING_PREINTEGRATED, STRATUS_INT16, 0, 0, 0, 0, 0x19566fb43e26097eu },
  { "cells", STRATUS_MODE_COMPOSITE, STRATUS_SAMPLING_CELLS, STRATUS_FLOAT32, 0, 0, 0, 0, 0x89643d3f64bf5265u },
  { "lit", STRATUS_MODE_COMPOSITE, STRATUS_SAMPLING_MIDPOINT, STRATUS_UINT16, 1, 0, 0, 0, 0xa79f1c648f4b6ac6u },
  { "nearest", STRATUS_MODE_COMPOSITE, STRATUS_SAMPLING_MIDPOINT, STRATUS_FLOAT64, 0, 1, 0, 0, 0xcc365dee5a43b72fu },
  { "jittered", STRATUS_MODE_COMPOSITE, STRATUS_SAMPLING_MIDPOINT, STRATUS_FLOAT32, 0, 0, 1, 0, 0x6e2220fa47347791u },
  { "cropped", STRATUS_MODE_COMPOSITE, STRATUS_SAMPLING_MIDPOINT, STRATUS_FLOAT32, 0, 0, 0, 1, 0xd011f0d9b331afb2u },
  { "maximum", STRATUS_MODE_MAXIMUM, STRATUS_SAMPLING_AUTO, STRATUS_FLOAT32, 0, 0, 0, 0, 0x812345050597398du },
  { "minimum", STRATUS_MODE_MINIMUM, STRATUS_SAMPLING_AUTO, STRATUS_UINT8, 0, 0, 0, 0, 0x8262bc327ad04a4bu },
  { "average", STRATUS_MODE_AVERAGE, STRATUS_SAMPLING_AUTO, STRATUS_FLOAT32, 0, 0, 0, 0, 0x642de5e757f50ab3u },
  { "additive", STRATUS_MODE_ADDITIVE, STRATUS_SAMPLING_AUTO, STRATUS_INT32, 0, 0, 0, 0, 0xe873274ff384212au },
  { "isosurface", STRATUS_MODE_ISOSURFACE, STRATUS_SAMPLING_AUTO, STRATUS_FLOAT32, 1, 0, 0, 0, 0x02039fe80a0ee97bu },
  { "slice", STRATUS_MODE_SLICE, STRATUS_SAMPLING_AUTO, STRATUS_FLOAT32, 0, 0, 0, 0, 0xa4d1b879a8aeb00bu },
};

static inline uint64_t bits_of_image(stratus_context* context, const bits_of_record* record)
{
  static picture drawn;
  picture_case c;
  case_create(context, &c, record->type, 23, 19, 21, 77);
  const double base = case_type_values[record->type].base, scale = case_type_values[record->type].scale;
  c.options.mode = record->mode;
  c.options.sampling.rule = record->sampling;
  c.options.sampling.distance = record->sampling == STRATUS_SAMPLING_AUTO || record->sampling == STRATUS_SAMPLING_CELLS ? 0.0 : 0.7;
  c.options.light.shade = record->shade;
  c.options.sampling.interpolation = record->nearest ? STRATUS_INTERPOLATION_NEAREST : STRATUS_INTERPOLATION_LINEAR;
  c.options.sampling.jitter = record->jitter;
  c.options.clipping.crop = record->crop;
  for (int side = 0; side < 6; ++side) {
    c.options.clipping.crop_bounds[side] = side % 2 ? 15.25 : 3.5;
  }
  c.options.optics.contour_count = 2;
  c.options.optics.contours[0] = base + 0.1 * scale;
  c.options.optics.contours[1] = base + 0.3 * scale;
  c.options.slice = (stratus_slice){ .center = { 11.0, 9.0, 10.0 }, .linear = { 0.2, 0.4, 1.0 } };
  case_render(context, &c, &drawn);
  assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
  case_destroy(&c);
  return bits_add(bits_add(BITS_START, drawn.rgba, sizeof drawn.rgba), drawn.depth, sizeof drawn.depth);
}

static const uint64_t bits_mesh = 0xedb50994cacf013cu;

static inline uint64_t bits_of_mesh(stratus_context* context)
{
  static tetra_picture drawn;
  tetra_case c;
  tetra_method = STRATUS_TETRA_METHOD_MARCH;
  tetra_create(&c, 5, 0.2, 0.1, 3);
  tetra_camera(context, &c, 5, 2, 0);
  tetra_draw(context, &c, &drawn);
  tetra_destroy(&c);
  return bits_add(bits_add(BITS_START, drawn.rgba, sizeof drawn.rgba), drawn.depth, sizeof drawn.depth);
}

static inline int bits_differ(const char* where, const char* name, uint64_t is, uint64_t was)
{
  if (is != was) {
    print_error(
      "%s, %s: the bits are 0x%016llxu, on record are 0x%016llxu\n", where, name, (unsigned long long)is, (unsigned long long)was);
  }
  return is != was;
}

/* Returns the number of pictures of which the bits are others than those on record. `where`: for the message; few: draw a quarter of them.
 */
static inline int bits_check(stratus_context* context, const char* where, int few)
{
  int others = 0;
  for (size_t i = 0; i < sizeof bits_images / sizeof bits_images[0]; i += few ? 4 : 1) {
    others += bits_differ(where, bits_images[i].name, bits_of_image(context, bits_images + i), bits_images[i].bits);
  }
  return others + bits_differ(where, "mesh", bits_of_mesh(context), bits_mesh);
}

#endif
