/* SPDX-License-Identifier: BSD-3-Clause
 * The ray caster's state. */
#ifndef STRATUS_RAY_CASTER_H
#define STRATUS_RAY_CASTER_H

#include "stratus/tree.h"
#include "stratus/ray_cast.h"
#include "ray_cast_host.h"
#include "ray_field.h"
#include "ray_integrator.h"
#include "ray_modes_render.h"
#include "ray_optics.h"
#include "ray_sampling.h"
#include "ray_structure.h"

typedef struct stratus_ray_device stratus_ray_device;
typedef struct stratus_first_hit stratus_first_hit;
typedef struct stratus_probe_blocks stratus_probe_blocks;

/* Casters within a caster: of up to four independent components, of the quantities of one, and of the matter that absorbs light. */
#define STRATUS_RAY_PARTS 6
#define STRATUS_RAY_QUANTITIES_PART 4
#define STRATUS_RAY_LIGHT_PART 5

/* Milliseconds of a frame, and of building, by structure; and the time that a trial wastes. */
typedef struct stratus_ray_costs {
  double frame[STRATUS_STRUCTURE_HYBRID + 1], build[STRATUS_STRUCTURE_HYBRID + 1], trial;
} stratus_ray_costs;

/* The measurements for an automatic choice of the structure since the occupancy changed, see ray_trial.h. */
typedef struct stratus_ray_trial {
  stratus_structure map;                    /* of caster->structure.map; AUTO: none was made yet */
  bool tried[STRATUS_STRUCTURE_HYBRID + 1]; /* maps that were built */
  stratus_structure lost;                   /* the last that was built and was slower than `map`; AUTO: none */
  uint64_t table_serial;                    /* of the table of the frame before */
  stratus_ray_choice choice;                /* its sampling */
  int frames;                               /* drawn with that table and sampling */
  bool timed;                               /* `with` and `without` are of these; else of those before */
  double with, without;                     /* milliseconds of the same pixels, by the map and by none */
  double build_ms;                          /* of the last distance map */
  double spent, built_ms, trial_ms;         /* milliseconds that frames, builds of other maps, and trials of none took */
} stratus_ray_trial;

/* Each room of rays has its part of the state, which it declares and drops. The rest is the frame's. */
struct stratus_ray_caster {
  stratus_context* context;
  stratus_ray_field field;
  stratus_ray_structure structure;
  stratus_ray_optics optics;
  stratus_ray_integrator integrator;

  stratus_ray_choice_inputs inputs;       /* of integrator.choice */
  stratus_ray_choice measured;            /* the last that the probe made; its sample distance is 0 before the first */
  stratus_ray_choice_inputs measured_for; /* the inputs of `measured`; tolerance -1: data or function have changed since */
  int measured_beyond;                    /* of `measured` by rule local: blocks of classes below it are rough */
  const stratus_probe_blocks* blocks;     /* of the picture that is drawn, with which it shares a probe; NULL: it has its own */
  char tried[256];                        /* the settings that the probe tried; empty: there was no probe */
  stratus_ray_trial trial;
  const stratus_ray_costs* forced; /* taken instead of all measured times, for tests; NULL: none */
  bool on_host;                    /* it never draws on the device */
  int layers;                      /* > 0: pictures hold so many layers, as stratus_light_draw has them; on the host */
  stratus_light_state light;       /* of a picture of this one volume, or of several inputs of which it is the first */
  bool light_given;                /* optics.lights belongs to a picture of several inputs */
  bool together;                   /* it draws in one march with others, which light each sample */

  stratus_ray_caster* parts[STRATUS_RAY_PARTS]; /* of independent components, see ray_caster_parts.c; NULL until such a mode is used */

  stratus_first_hit* first_hit; /* first_hit_picture.h; NULL until mode FIRST_HIT is used */

  stratus_ray_device* device; /* buffers on the OpenCL device; NULL: none */
  char where[160];            /* how the device drew the last picture, or why the host did; empty where nothing is to be said */
  uint64_t uploads, probe_builds;
};

/* ray_caster_drop.c: each function also drops the data derived from its own. stratus_ray_drop_offer_map() makes the caster check an offered
 * tree of cells again, and drops a map that was made from a tree. */
void stratus_ray_drop_transfer(stratus_ray_caster* caster);
void stratus_ray_drop_values(stratus_ray_caster* caster);
void stratus_ray_drop_occupancy(stratus_ray_caster* caster);
void stratus_ray_drop_offer_map(stratus_ray_caster* caster);

/* ray_caster_update.c: rebuilds only parts whose inputs changed. */
stratus_status stratus_ray_update_tables(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_ray_cast_options* options, size_t rays, stratus_ray_cast_report* report); /* value ranges, choices, table */
/* Checks and keeps the options' function of two variables, if there is one. Drops what follows from another one. */
stratus_status stratus_ray_update_transfer_2d(
  stratus_ray_caster* caster, const stratus_volume* volume, const stratus_ray_cast_options* options);
/* Whether a tree was offered whose cells decide which blocks matter: only where one table's opacity does. stratus_ray_offer_serves():
 * whether it covers all cells that the transfer function shows. */
bool stratus_ray_offer_is_open(const stratus_ray_caster* caster);
stratus_status stratus_ray_offer_serves(stratus_ray_caster* caster, bool* serves);
/* Makes caster->structure.occupancy of caster->field.ranges. */
stratus_status stratus_ray_make_occupancy(stratus_ray_caster* caster);
/* Makes the tables of caster->integrator.choice. */
stratus_status stratus_ray_update_table(stratus_ray_caster* caster, const stratus_ray_cast_options* options);
/* Makes a map for a structure other than NONE. offered: of the tree that came with the data. *map: NULL if no block is occupied and the
 * structure is a tree. */
stratus_status stratus_ray_make_map(stratus_ray_caster* caster, stratus_structure structure, bool offered, stratus_distance_map** map);
/* times: measured times may decide if the structure is automatic. */
stratus_status stratus_ray_update_structures(stratus_ray_caster* caster, stratus_structure wanted, bool times, stratus_structure* used,
  char* why, size_t capacity, stratus_ray_cast_report* report);

/* ray_caster_check.c: checks the input of an image except camera and image. */
stratus_status stratus_ray_check_input(
  stratus_context* context, const stratus_volume* volume, const stratus_transfer* transfer, const stratus_ray_cast_options* options);

/* ray_caster_render.c. stratus_ray_fill_report() reports the counts and choices. */
void stratus_ray_fill_report(
  const stratus_ray_caster* caster, const stratus_ray_counts* counts, stratus_structure used, stratus_ray_cast_report* report);
/* Returns how many pixels differ in their bits. */
uint64_t stratus_ray_differing(const stratus_image* image, const float* rgba, const float* depth);
/* One picture, of one component or of all that mix along a ray, of input that was checked. */
stratus_status stratus_ray_render_one(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image, stratus_ray_cast_report* report);

/* ray_caster_parts.c. stratus_ray_parts(): the number of components that are drawn by themselves; options NULL: the defaults.
 * stratus_ray_render_kept() draws what rays keep of one of them, in all modes but composite. keeps: as in the caster. *drawn: the caster
 * that has the component's structures. */
int stratus_ray_parts(const stratus_volume* volume, const stratus_ray_cast_options* options);
/* Finds the caster of an independent component, and makes it where there is none yet. */
stratus_status stratus_ray_part(stratus_ray_caster* caster, int component, stratus_ray_caster** part);
stratus_status stratus_ray_render_kept(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  int component, int keeps, const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image,
  const stratus_ray_caster** drawn, stratus_ray_cast_report* report);

/* ray_frame.c: the arrays that a frame reads and writes. */
stratus_ray_cast_frame stratus_ray_frame_of(
  const stratus_ray_caster* caster, const stratus_ray_cast_arguments* arguments, const stratus_image* image, bool with_map);

#endif
