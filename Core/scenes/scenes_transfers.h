/* SPDX-License-Identifier: BSD-3-Clause
 * The transfer functions of the volumes of record. Only scenes.c includes this file. */
#ifndef STRATUS_SCENES_TRANSFERS_H
#define STRATUS_SCENES_TRANSFERS_H

#include "stratus/volume.h"

#include <string.h>

#define POINTS_MAX 24
#define COLORS_MAX 40
#define STRIPES 20
#define LABELS 11

typedef struct scene_functions {
  double opacity[POINTS_MAX][2], edited_opacity[POINTS_MAX][2];
  double color[COLORS_MAX][4], edited_color[COLORS_MAX][4];
  double second_color[2][4];
} scene_functions;

/* Copy a table of points, and set their number. */
#define SET_POINTS(to, count, from) (memcpy((to), (from), sizeof(from)), *(count) = sizeof(from) / sizeof *(from))

static void set_ramps(scene_functions* functions, double top, double most, stratus_transfer* transfer, stratus_transfer* edit)
{
  const double opacity[][2] = { { 0, 0 }, { top, most } };
  const double edited[][2] = { { 0, 0 }, { .15 * top, 0 }, { .6 * top, .8 * most }, { top, .5 * most } };
  SET_POINTS(functions->opacity, &transfer->opacity_count, opacity);
  SET_POINTS(functions->edited_opacity, &edit->opacity_count, edited);
}

static void set_peaks(scene_functions* functions, stratus_transfer* transfer, stratus_transfer* edit)
{
  static const double opacity[][2] = { { 0, 0 }, { .40, 0 }, { .41, .9 }, { .42, 0 }, { 1, 0 } };
  static const double edited[][2] = { { 0, 0 }, { .50, 0 }, { .51, .9 }, { .52, 0 }, { 1, 0 } };
  SET_POINTS(functions->opacity, &transfer->opacity_count, opacity);
  SET_POINTS(functions->edited_opacity, &edit->opacity_count, edited);
}

static void set_colors(scene_functions* functions, double top, stratus_transfer* transfer, stratus_transfer* edit)
{
  const double color[][4] = { { 0, .35, .45, .75 }, { .5 * top, .85, .9, .95 }, { top, 1, .95, .85 } };
  const double edited[][4] = { { 0, .7, .3, .2 }, { .5 * top, .95, .8, .4 }, { top, 1, 1, .9 } };
  SET_POINTS(functions->color, &transfer->color_count, color);
  SET_POINTS(functions->edited_color, &edit->color_count, edited);
}

/* Tissue is thin over a broad range of values; bone rises steeply. Edited: only bone. */
static void set_bone(scene_functions* functions, stratus_transfer* transfer, stratus_transfer* edit)
{
  static const double opacity[][2] = { { 0, 0 }, { 700, 0 }, { 1000, .006 }, { 1180, .008 }, { 1260, .02 }, { 1500, .35 }, { 4095, .6 } };
  static const double edited[][2] = { { 0, 0 }, { 1200, 0 }, { 1400, .3 }, { 4095, .6 } };
  static const double color[][4] = { { 0, .8, .45, .35 }, { 1150, .85, .5, .4 }, { 1300, .95, .85, .7 }, { 2400, 1, 1, .95 } };
  static const double edited_color[][4] = { { 0, .9, .8, .6 }, { 1500, 1, .95, .8 }, { 2400, .7, .85, 1 } };
  SET_POINTS(functions->opacity, &transfer->opacity_count, opacity);
  SET_POINTS(functions->edited_opacity, &edit->opacity_count, edited);
  SET_POINTS(functions->color, &transfer->color_count, color);
  SET_POINTS(functions->edited_color, &edit->color_count, edited_color);
}

/* A narrow window between two vertical steps, between air and tissue. Edited: a wider one, further in. */
static void set_skin(scene_functions* functions, stratus_transfer* transfer, stratus_transfer* edit)
{
  static const double opacity[][2] = { { 0, 0 }, { 480, 0 }, { 480, .85 }, { 600, .85 }, { 600, 0 }, { 4095, 0 } };
  static const double edited[][2] = { { 0, 0 }, { 500, 0 }, { 500, .5 }, { 800, .7 }, { 800, 0 }, { 4095, 0 } };
  static const double color[][4] = { { 0, .95, .75, .6 }, { 480, .95, .75, .6 }, { 600, .7, .35, .25 } };
  static const double edited_color[][4] = { { 0, .6, .75, .95 }, { 500, .6, .75, .95 }, { 800, .2, .3, .6 } };
  SET_POINTS(functions->opacity, &transfer->opacity_count, opacity);
  SET_POINTS(functions->edited_opacity, &edit->opacity_count, edited);
  SET_POINTS(functions->color, &transfer->color_count, color);
  SET_POINTS(functions->edited_color, &edit->color_count, edited_color);
}

/* The k-th of some colours that differ clearly from their neighbours in order. */
static void pick_color(int k, double rgb[3])
{
  static const double hues[][3] = { { .9, .2, .15 }, { .2, .55, .9 }, { .95, .85, .25 }, { .25, .7, .35 }, { .6, .3, .75 },
    { .95, .55, .2 }, { .3, .8, .8 }, { .9, .5, .7 }, { .55, .4, .25 }, { .85, .85, .85 } };
  memcpy(rgb, hues[k % 10], sizeof hues[0]);
  for (int c = 0; c < 3 && k >= 10; ++c) {
    rgb[c] *= .6;
  }
}

/* A constant opacity, and stripes of colours that meet in vertical steps. Edited: the stripes in reverse, half as dense. */
static void set_stripes(scene_functions* functions, stratus_transfer* transfer, stratus_transfer* edit)
{
  static const double opacity[][2] = { { 0, .3 }, { 1, .3 } };
  static const double edited[][2] = { { 0, .15 }, { 1, .15 } };
  SET_POINTS(functions->opacity, &transfer->opacity_count, opacity);
  SET_POINTS(functions->edited_opacity, &edit->opacity_count, edited);
  for (int k = 0; k < STRIPES; ++k) {
    for (int end = 0; end < 2; ++end) {
      double* point = functions->color[2 * k + end];
      double* other = functions->edited_color[2 * k + end];
      point[0] = other[0] = (double)(k + end) / STRIPES;
      pick_color(k, point + 1);
      pick_color(STRIPES - 1 - k, other + 1);
    }
  }
  transfer->color_count = edit->color_count = 2 * (size_t)STRIPES;
}

/* Fog up to value .6, and a solid above .7. Edited: denser fog, a translucent solid. */
static void set_solid(scene_functions* functions, stratus_transfer* transfer, stratus_transfer* edit)
{
  static const double opacity[][2] = { { 0, 0 }, { .6, .004 }, { .7, .004 }, { .8, .95 }, { 1, .95 } };
  static const double edited[][2] = { { 0, 0 }, { .2, 0 }, { .6, .012 }, { .7, .012 }, { .8, .5 }, { 1, .5 } };
  static const double color[][4] = { { 0, .35, .45, .75 }, { .6, .85, .9, .95 }, { .7, .9, .55, .2 }, { 1, 1, .8, .4 } };
  static const double edited_color[][4] = { { 0, .7, .3, .2 }, { .6, .95, .8, .4 }, { .7, .2, .6, .9 }, { 1, .6, .9, 1 } };
  SET_POINTS(functions->opacity, &transfer->opacity_count, opacity);
  SET_POINTS(functions->edited_opacity, &edit->opacity_count, edited);
  SET_POINTS(functions->color, &transfer->color_count, color);
  SET_POINTS(functions->edited_color, &edit->color_count, edited_color);
}

/* A window of width 1 around each label, between vertical steps. Interpolation from one label to another passes through the windows
 * between them. Edited: other labels show. */
static void set_labels(scene_functions* functions, stratus_transfer* transfer, stratus_transfer* edit)
{
  static const double shown[LABELS] = { 0, .3, 0, .8, 0, .3, 0, .8, .3, 0, .8 };
  static const double edited[LABELS] = { 0, 0, .3, 0, .8, 0, .3, 0, 0, .8, .3 };
  for (int k = 0; k < LABELS; ++k) {
    for (int end = 0; end < 2; ++end) {
      const double value = (double)(k + end) - .5;
      double* color = functions->color[2 * k + end];
      functions->opacity[2 * k + end][0] = functions->edited_opacity[2 * k + end][0] = color[0] = value;
      functions->opacity[2 * k + end][1] = shown[k];
      functions->edited_opacity[2 * k + end][1] = edited[k];
      pick_color(k + 9, color + 1); /* label 1 has the first hue; the order of the others is the hues' */
      if (k > 0) {
        pick_color(k - 1, color + 1);
      }
    }
  }
  memcpy(functions->edited_color, functions->color, sizeof functions->color);
  transfer->opacity_count = edit->opacity_count = transfer->color_count = edit->color_count = 2 * (size_t)LABELS;
}

/* Sets both functions of a scene. `top` and `most`: the ends of a ramp. */
static void set_functions(
  const char* name, double top, double most, scene_functions* functions, stratus_transfer* transfer, stratus_transfer* edit)
{
  *transfer = *edit = stratus_transfer_default();
  transfer->opacity = functions->opacity[0];
  transfer->color = functions->color[0];
  edit->opacity = functions->edited_opacity[0];
  edit->color = functions->edited_color[0];
  if (strcmp(name, "bone") == 0) {
    set_bone(functions, transfer, edit);
  } else if (strcmp(name, "skin") == 0) {
    set_skin(functions, transfer, edit);
  } else if (strcmp(name, "stripes") == 0) {
    set_stripes(functions, transfer, edit);
  } else if (strcmp(name, "shell") == 0 || strcmp(name, "plate") == 0) {
    set_solid(functions, transfer, edit);
  } else if (strcmp(name, "labels") == 0) {
    set_labels(functions, transfer, edit);
  } else {
    set_colors(functions, top, transfer, edit);
    if (strcmp(name, "peak") == 0) {
      set_peaks(functions, transfer, edit);
    } else {
      set_ramps(functions, top, most, transfer, edit);
    }
  }
}

#endif
