/* SPDX-License-Identifier: BSD-3-Clause
 * Distance fields: what the exact transform, the floodings and their kernels share. */
#ifndef STRATUS_DISTANCE_FIELD_H
#define STRATUS_DISTANCE_FIELD_H

#include "voxels.h"

/* A bit a voxel: of voxel (i,j,k) bit i % 64 of bits[(k*n[1] + j)*words + i/64]; those beyond a row's end are 0. */
typedef struct stratus_bits {
  int64_t n[3], words;
  uint64_t* bits;
} stratus_bits;

/* Squared distances are whole numbers in the narrowest type that holds them, negative inside a signed field. */
struct stratus_field {
  stratus_context* context;
  stratus_field_method method;
  int is_signed;
  int64_t n[3];
  int64_t effective; /* voxels */
  int bytes;         /* of a value: 2, 4 or 8; 0: no array, all distances are `uniform` */
  double uniform;
  void* values;      /* exact: n[0]*n[1]*n[2] values */
  uint32_t* nearest; /* floodings: the nearest voxel's position (flood_pack()), FLOOD_UNKNOWN where none is */
  stratus_bits set;  /* floodings: the effective voxels */
};

static inline int stratus_bits_get(const stratus_bits* set, int64_t i, int64_t j, int64_t k)
{
  return (int)(set->bits[(k * set->n[1] + j) * set->words + (i >> 6)] >> (i & 63) & 1);
}

/* Whether a context's device makes a field: a GPU (see device.h) does where buffers of `bytes` a voxel fit, else the host does.
 * distance_field_device.c */
bool stratus_field_on_device(const stratus_context* context, const int64_t n[3], size_t bytes);

/* Whether squared distances of a grid need 64 bits. distance_field_exact.c */
int stratus_field_is_wide(const int64_t n[3]);

/* Fills field->values and ->bytes. Neither all voxels nor none are effective. voxels: for bounds. distance_field_exact.c */
stratus_status stratus_field_exact(stratus_context* context, const stratus_voxels* voxels, const stratus_bits* set, stratus_field* field);
/* The same on the device: 4 or 8 bytes a value. distance_field_device.c */
stratus_status stratus_device_field_exact(stratus_context* context, const stratus_bits* set, stratus_field* field);
/* Nearest voxels of an exact field, the one of the smallest index of several: three floats of four. distance_field_nearest.c */
stratus_status stratus_field_nearest(stratus_context* context, const stratus_bits* set, int is_signed, float* rgba);

#endif
