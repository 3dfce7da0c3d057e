/* SPDX-License-Identifier: BSD-3-Clause
 * Distance fields: types and functions that the exact transform, the floodings and their kernels share.
 *
 * The Euclidean metric is part of every method: fields store squared integers, the exact transform adds squares axis by axis, and floodings
 * compare squares. Another metric needs its own files. Users are tree_fields.c (method hybrid-paper) and the Python package. */
#ifndef STRATUS_DISTANCE_FIELD_H
#define STRATUS_DISTANCE_FIELD_H

#include "stratus/distance_field.h"
#include "voxels.h"

/* One bit for each voxel: bit i % 64 of bits[(k*n[1] + j)*words + i/64] is voxel (i,j,k). Bits beyond a row's end are 0. */
typedef struct stratus_bits {
  int64_t n[3], words;
  uint64_t* bits;
} stratus_bits;

/* A field holds squared distances as integers of the narrowest type that fits, negative inside a signed field. */
struct stratus_field {
  stratus_context* context;
  stratus_field_method method;
  int is_signed;
  int64_t n[3];
  int64_t effective; /* number of effective voxels */
  int bytes;         /* bytes of a value: 2, 4 or 8; 0: no array, since all distances are `uniform` */
  double uniform;
  void* values;      /* exact: n[0]*n[1]*n[2] values */
  uint32_t* nearest; /* floodings: the nearest voxel's position (flood_pack()), FLOOD_UNKNOWN where none is */
  stratus_bits set;  /* floodings: bits of the effective voxels */
};

static inline int stratus_bits_get(const stratus_bits* set, int64_t i, int64_t j, int64_t k)
{
  return (int)(set->bits[(k * set->n[1] + j) * set->words + (i >> 6)] >> (i & 63) & 1);
}

/* distance_field_device.c: true if the context's device builds structures (stratus_device_builds()) and can allocate `bytes` for each
 * voxel. Otherwise the host makes the field. */
bool stratus_field_on_device(const stratus_context* context, const int64_t n[3], size_t bytes);

/* distance_field_exact.c: true if squared distances of a grid need 64 bits. */
int stratus_field_is_wide(const int64_t n[3]);

/* distance_field_exact.c: fills field->values and ->bytes. At least one voxel is effective and one is not. voxels: for their bounds. */
stratus_status stratus_field_exact(stratus_context* context, const stratus_voxels* voxels, const stratus_bits* set, stratus_field* field);
/* distance_field_device.c: does the same on the device, with 4 or 8 bytes for each value. */
stratus_status stratus_device_field_exact(stratus_context* context, const stratus_bits* set, stratus_field* field);
/* distance_field_nearest.c: write each voxel's nearest voxel of an exact field to the first three of four floats. Of several equally near
 * voxels it is the one of the smallest index. */
stratus_status stratus_field_nearest(stratus_context* context, const stratus_bits* set, int is_signed, float* rgba);

#endif
