/* SPDX-License-Identifier: BSD-3-Clause
 * Light that matter scatters more than once, in the layout of kernels/base/light_scatter.h. */
#ifndef STRATUS_LIGHT_SCATTER_H
#define STRATUS_LIGHT_SCATTER_H

#include "base.h"
#include "light_arguments.h"
#include "stratus/ray_cast.h"

/* Draws matter as it is seen without lights, in `layers`: the image's rgba receives so many pictures, one after the other, each of a part
 * of the same depth of the camera's near_k to far_k. colors: as its albedo, else in its own colours. */
typedef stratus_status stratus_light_draw(void* of, const stratus_camera* camera, int layers, const stratus_image* image, bool colors);

/* For renderers that draw layer by layer: the camera and the picture of one of `layers`. */
static inline stratus_camera stratus_light_layer_camera(const stratus_camera* all, int layer, int layers)
{
  stratus_camera camera = *all;
  const double depth = (all->far_k - all->near_k) / layers;
  camera.near_k = all->near_k + layer * depth;
  camera.far_k = all->near_k + (layer + 1) * depth;
  return camera;
}

static inline stratus_image stratus_light_layer_image(const stratus_image* all, int layer)
{
  stratus_image image = *all;
  image.rgba += 4 * (size_t)layer * (size_t)all->width * (size_t)all->height;
  return image;
}

/* Matter in a box of cells. */
typedef struct stratus_light_cells {
  int size[3];
  double lo[3], spacing[3]; /* world coordinates */
  float* extinction;        /* of each cell, x fastest, in 1 / world length */
  float* albedo;            /* red of each cell, then green, then blue */
} stratus_light_cells;

typedef struct stratus_light_scatter {
  stratus_light_cells cells; /* its extinction is NULL if there is no light that is scattered more than once */
  int32_t* words;            /* in the layout */
  float scale[3];            /* the factors of red, green and blue */
  double error;              /* that is expected of the cells' size */
} stratus_light_scatter;

/* Solve for the light that matter within the bounds scatters more than once, and for the sky's. lights: in the world. The cells fill the
 * box of the matter. At most they are as many as a cube of 64 cells along each side has, and none is smaller than `detail` (0: not known).
 * A quarter and a half as many along each side are tried before, until the expected error keeps the tolerance. */
stratus_status stratus_light_scatter_build(stratus_context* context, stratus_light_draw* draw, void* of, const double bounds[6],
  double detail, const stratus_shading* shading, const stratus_light* lights, int count, double tolerance, stratus_light_scatter* scatter);
/* Frees the arrays, and leaves the cells' places and the scale. */
void stratus_light_scatter_release(stratus_context* context, stratus_light_scatter* scatter);
size_t stratus_light_scatter_words(const stratus_light_scatter* scatter);

/* The part of the extinction after which light goes on as before: the anisotropy's share of the scattered light, 0 where matter scatters
 * backwards, or if there is no light that is scattered more than once. */
double stratus_light_forward(const stratus_light_scatter* scatter, const stratus_shading* shading);

/* Sets where the words of scattered light begin, and the way to them. scatter: NULL: there are none. to_world: 4x4, from the places that
 * rays have. */
void stratus_light_scatter_arguments(
  const stratus_light_scatter* scatter, size_t at, const double to_world[16], stratus_light_arguments* a);

#endif
