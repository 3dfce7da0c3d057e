/* SPDX-License-Identifier: BSD-3-Clause
 * Jump flooding: its entry for distance_field.c, and declarations that host and device passes share. */
#ifndef STRATUS_JUMP_FLOODING_PASSES_H
#define STRATUS_JUMP_FLOODING_PASSES_H

#include "jump_flooding.h"
#include "distance_field.h"

#define FLOOD_BITS 31 /* limit on the bits of a packed position */

typedef struct flood_layout {
  int shift_y, shift_z, bits;
} flood_layout;

static inline flood_layout flood_shifts(const int64_t n[3])
{
  int bits[3] = { 0, 0, 0 };
  for (int a = 0; a < 3; ++a) {
    while ((int64_t)1 << bits[a] < n[a]) {
      ++bits[a];
    }
  }
  return (flood_layout){ bits[0], bits[0] + bits[1], bits[0] + bits[1] + bits[2] };
}

static inline uint32_t flood_pack(flood_layout layout, int64_t i, int64_t j, int64_t k)
{
  return (uint32_t)(k << layout.shift_z | j << layout.shift_y | i);
}

static inline void flood_unpack(uint32_t position, flood_layout layout, int64_t at[3])
{
  at[0] = position & ((1u << layout.shift_y) - 1);
  at[1] = position >> layout.shift_y & ((1u << (layout.shift_z - layout.shift_y)) - 1);
  at[2] = position >> layout.shift_z;
}

/* Effect of a pass: the number of voxels brought nearer, and the sum of their new over old distances in units of 1/FLOOD_RATIO_ONE. */
typedef struct flood_count {
  uint64_t updated, ratios;
} flood_count;

/* jump_flooding.c: fills field->nearest. */
stratus_status stratus_flood(stratus_context* context, const stratus_bits* set, const stratus_field_options* options, stratus_field* field,
  stratus_field_report* report);

/* jump_flooding_host.c: one pass on the host, from[] to to[]. wide: squared distances need 64 bits. rooms: stratus_flood_room_bytes() for
 * each thread. */
size_t stratus_flood_room_bytes(const int64_t n[3]);
void stratus_flood_pass(const stratus_context* context, const int64_t n[3], int step, int wide, const uint32_t* from, uint32_t* to,
  unsigned char* rooms, flood_count* count);

/* distance_field_device.c: passes on the device. _create copies from[] there, _pass swaps the buffers, _read copies the result back. */
typedef struct flood_device flood_device;
stratus_status stratus_flood_device_create(
  stratus_context* context, const int64_t n[3], int wide, const uint32_t* from, flood_device** device);
stratus_status stratus_flood_device_pass(stratus_context* context, flood_device* device, int step, flood_count* count);
stratus_status stratus_flood_device_read(stratus_context* context, const flood_device* device, uint32_t* to);
void stratus_flood_device_destroy(stratus_context* context, flood_device* device); /* takes NULL */

#endif
