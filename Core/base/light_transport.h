/* SPDX-License-Identifier: BSD-3-Clause
 * Light that a medium scatters evenly to all sides, any number of times, in a box of cells that vacuum surrounds: the equation of radiative
 * transfer by discrete ordinates (Chandrasekhar 1950, chapter 2). Along each of 80 directions light goes from plane to plane of cells by
 * short characteristics (Kunasz & Auer 1988), which integrate a source that is linear between two planes exactly. */
#ifndef STRATUS_LIGHT_TRANSPORT_H
#define STRATUS_LIGHT_TRANSPORT_H

#include "base.h"

/* The directions of the quadrature S8, symmetric in all axes (Carlson & Lathrop 1965). */
#define STRATUS_TRANSPORT_DIRECTIONS 80
#define STRATUS_TRANSPORT_MOMENTS 8

/* Arrays have a number for each cell, the first axis fastest. */
typedef struct stratus_transport {
  int size[3];                             /* cells along each axis, at least 1 */
  double spacing[3];                       /* their sides, above 0 */
  const float* extinction;                 /* in 1 / length, at least 0, finite */
  const float* albedo;                     /* the part of extinct light that is scattered, 0..1 */
  const float* direct;                     /* radiance of light that has not been scattered, the mean over all directions, at least 0 */
  float sky[STRATUS_TRANSPORT_DIRECTIONS]; /* the radiance that comes from outside along each direction, at least 0 */
} stratus_transport;

/* Gives direction i, in which light travels, of length 1. Returns its weight; the weights sum to 1. */
double stratus_transport_direction(int i, double way[3]);

/* Solve the equation to a relative residual of `tolerance`, 0..1.
 * mean: receives the mean over all directions of the radiance at each cell's centre: of scattered light, and of the sky's.
 * first: receives the part of the mean that was scattered once, 0..1.
 * moments: receives arrays one after the other, the mean of this radiance times a function of its direction: x, y, z, xx - 1/3,
 * yy - 1/3, xy, yz, zx. NULL: neither these nor `first` are wanted.
 * sweeps: receives how often light went along all directions. */
stratus_status stratus_transport_solve(
  stratus_context* context, const stratus_transport* medium, double tolerance, float* mean, float* first, float* moments, int* sweeps);

/* One sweep: light goes along a direction through all planes. Arrays have a cell more at either end of each axis, in which there is vacuum.
 * Rows along the first axis begin every `row` floats, planes of the first two every `plane` floats. */
typedef struct stratus_transport_sweep {
  int size[3]; /* the last axis is swept */
  size_t row, plane;
  const float *extinction, *source, *emission; /* emission: extinction times source */
  int back[2];                                 /* -1 or 1: the neighbour along the first and second axis from which light comes */
  float part[2], step; /* how far towards it, 0..1 cells, the place is from which light comes, and the distance from there */
  int reverse;         /* 1: from the last plane to the first */
  float sky, weight;
  float* radiance[2]; /* two planes to work in */
  float* sum;         /* the radiance times the weight is added to it */
} stratus_transport_sweep;

/* light_transport_isa.c, once for each instruction set. */
#define STRATUS_TRANSPORT_PAD 16 /* floats that may be read and written beyond the last cell of a row */
void stratus_transport_sweep_isa0(const stratus_transport_sweep* s);
void stratus_transport_sweep_isa1(const stratus_transport_sweep* s);
void stratus_transport_sweep_isa2(const stratus_transport_sweep* s);

#endif
