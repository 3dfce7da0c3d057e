/* SPDX-License-Identifier: BSD-3-Clause
 * A coarse copy of a large volume, for guesses and for first pictures. */
#ifndef STRATUS_LOOK_SAMPLE_H
#define STRATUS_LOOK_SAMPLE_H

#include "volume.h"

typedef struct stratus_look_sample {
  stratus_volume view; /* in the same place; its values are in `memory` */
  int64_t step[3];     /* along each axis one value in so many is taken */
  void* memory;        /* the caller releases it */
} stratus_look_sample;

/* Whether a volume has so many values that guesses take a sample of them. */
bool stratus_look_samples(const stratus_volume* volume);
/* Makes the copy of the first component; one that is kept is read. */
stratus_status stratus_look_sample_make(stratus_context* context, const stratus_volume* volume, stratus_look_sample* sample);

/* The parts of that. Makes room for a copy, whose values are not set. */
stratus_status stratus_look_sample_begin(stratus_context* context, const stratus_volume* volume, stratus_look_sample* sample);
/* Sets the copy's values that are in a part of the volume. */
void stratus_look_sample_part(const stratus_look_sample* sample, const stratus_part* part);
/* Sets the copy's values from what is kept of the volume; false if nothing is. */
bool stratus_look_sample_recall(stratus_context* context, const stratus_volume* volume, stratus_look_sample* sample);
void stratus_look_sample_keep(const stratus_volume* volume, const stratus_look_sample* sample);

#endif
