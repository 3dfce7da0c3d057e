/* SPDX-License-Identifier: BSD-3-Clause
 * The colour and opacity of samples and stretches: a caster's part of the state that has transfer functions and the tables made of them. */
#ifndef STRATUS_RAY_OPTICS_H
#define STRATUS_RAY_OPTICS_H

#include "light_maps.h"
#include "ray_shading_table.h"
#include "ray_transfer_2d_host.h"

/* A table and its inputs. */
typedef struct stratus_ray_made_table {
  stratus_table* table; /* NULL: none */
  double distance;      /* between samples */
  int entries;          /* the requested minimum */
  uint64_t number;      /* of the caster's tables, in the order of their making */
} stratus_ray_made_table;

struct stratus_ray_optics {
  stratus_context* context;
  stratus_transfer* transfers; /* transfer_count copies; NULL: none yet */
  int transfer_count;
  bool shades, dependent;      /* shades: stratus_ray_shading_wanted() of this render; dependent: options->dependent of `transfers` */
  stratus_ray_made_table made; /* the table that is drawn by */
  stratus_ray_made_table spare_table; /* of the other kind, samples or running sums: the probe and coarse pictures change between them */
  stratus_ray_shading_tables shading_tables;
  stratus_ray_transfer_2d transfer_2d;
  const stratus_light_maps* lights; /* shadows: the frame's; NULL: none */
  /* of several volumes, by midpoint: colour and optical depth of each table entry over a segment; NULL: none */
  float* layers;
  uint64_t layers_of;    /* that table's number */
  double layers_step;    /* the segment's length */
  uint64_t table_serial; /* incremented by each build, so that the device knows which buffers are stale */
  uint64_t table_builds;
};

/* ray_shading_table.c: drops the tables of one function, so that all are made anew; and the table that rays read, with its size. */
void stratus_ray_drop_tables(stratus_ray_optics* optics);
const void* stratus_ray_table_of(const stratus_ray_optics* optics, size_t* bytes);

#endif
