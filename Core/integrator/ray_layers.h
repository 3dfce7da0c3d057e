/* SPDX-License-Identifier: BSD-3-Clause
 * Layers of surfaces from several grids: hits, isosurfaces and slices. Each grid is drawn by itself, one surface of each ray a picture. A
 * pixel's layers are kept in the order of depth, and composited at the end. */
#ifndef STRATUS_RAY_LAYERS_H
#define STRATUS_RAY_LAYERS_H

#include "base.h"

typedef struct stratus_layer {
  float rgba[4]; /* colour times alpha, alpha */
  float depth;
  int of; /* the input */
  struct stratus_layer* behind;
} stratus_layer;

typedef struct stratus_layers {
  stratus_layer** nearest; /* of each pixel; NULL: it has none */
  stratus_layer* memory;   /* of the pictures so far, each of which begins with a layer that is none, and leads to the next */
  float least;             /* the transparency below which nothing is seen behind layers */
} stratus_layers;

/* Makes an empty list for each pixel. least is the caller's. */
stratus_status stratus_layers_create(stratus_context* context, const stratus_image* image, stratus_layers* layers);
void stratus_layers_destroy(stratus_context* context, stratus_layers* layers);
/* Whether the input's layer behind its first `count` ones may be seen in a pixel: it has all of these, and light passes the last. */
bool stratus_layers_wanted(const stratus_layers* layers, size_t pixel, int input, int count);
/* Adds the input's next layers from the pixels `inside` (x0, x1, y0, y1) of a part, whose lower left pixel is at x0, y0 of the image. */
stratus_status stratus_layers_join(stratus_context* context, stratus_layers* layers, int input, const stratus_image* image,
  const stratus_image* part, int x0, int y0, const int inside[4]);
/* Composites the layers of each pixel. The image is clear. */
void stratus_layers_finish(stratus_context* context, const stratus_layers* layers, const stratus_image* image);

#endif
