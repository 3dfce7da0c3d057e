/* SPDX-License-Identifier: BSD-3-Clause
 * State of an image of several volumes: ray_several.c draws it, ray_several_check.c refuses unsupported input, ray_several_parts.c prepares
 * it. */
#ifndef STRATUS_RAY_SEVERAL_PICTURE_H
#define STRATUS_RAY_SEVERAL_PICTURE_H

#include "ray_caster.h"
#include "ray_several_host.h"
#include "tetra_caster.h"

/* The data derived from one input for this image. */
typedef struct stratus_several_input {
  const stratus_ray_cast_input* of;
  const stratus_transfer* transfer; /* of a volume: the input's function, or the one derived from its function of two variables */
  stratus_ray_cast_options options; /* with the tolerance of a picture of several, and the settings that all share with the first */
  stratus_ray_cast_report report;
  stratus_tetra_options tetra_options; /* of a mesh: the input's options */
  stratus_tetra_frame frame;           /* of a mesh that shows */
  bool shows;
  stratus_structure used;
  int stride, part; /* part: its number among those that are shown; -1: it is not */
  char why[192];
} stratus_several_input;

typedef struct stratus_several {
  stratus_context* context;
  const stratus_camera* camera;
  const stratus_image* image;
  const stratus_ray_cast_input* given;
  const stratus_light_maps* maps; /* of light, that all share; NULL: none */
  stratus_ray_cast_report light;  /* its members of light are set */
  int count;
  double step;     /* of the lattice */
  char where[160]; /* why the host draws though there is a device; else empty */
  stratus_several_input inputs[STRATUS_SEVERAL_MAX];
} stratus_several;

/* ray_several_device.c: draws on the context's device, which has what stratus_ray_device_send() gave it of every volume, and
 * stratus_tetra_caster_enter() of every mesh. */
stratus_status stratus_several_device(stratus_context* context, const stratus_several_frame* frame, stratus_ray_counts* counts);

/* ray_several_check.c. The context of an input; NULL: it has neither caster. */
stratus_context* stratus_several_context(const stratus_ray_cast_input* input);
/* Refuses numbers of inputs out of range, and inputs without a caster of their own. */
stratus_status stratus_several_check_inputs(const stratus_ray_cast_input* inputs, int count);
/* Refuses what one march through several volumes does not draw; n: the input's number. */
stratus_status stratus_several_check_volume(stratus_context* context, int n, const stratus_several_input* in);
/* Fails where values of a volume were missing when rays looked at them. */
stratus_status stratus_several_check_missing(const stratus_ray_cast_input* inputs, int count);
stratus_status stratus_several_check_mesh(stratus_context* context, int n, const stratus_several_input* in);

/* ray_several_kept.c. Draws inputs, which were checked for casters, in a mode other than composite. */
stratus_status stratus_several_kept(const stratus_ray_cast_input* inputs, int count, const stratus_camera* camera,
  const stratus_image* image, stratus_ray_cast_report* reports);

/* ray_several_parts.c. Updates tables, structure and choice of an input. */
stratus_status stratus_several_update(stratus_several* s, stratus_several_input* in);
/* Chooses the lattice, once all inputs are up to date. */
stratus_status stratus_several_choose_step(stratus_several* s);
/* Sets what rays read of an input, unless they meet nothing of it: then in->part is -1, else `number`. */
stratus_status stratus_several_set_part(
  const stratus_several* s, stratus_several_input* in, int number, stratus_ray_cast_arguments* a, stratus_several_part* part);
/* Returns the number of volumes and of further pieces of those that crop regions cut, each of which marches by itself. */
int stratus_several_part_count(const stratus_several_frame* frame);

#endif
