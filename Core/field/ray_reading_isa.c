/* SPDX-License-Identifier: BSD-3-Clause
 * The functions that read a field of each type of values, compiled for one instruction set, STRATUS_ISA. */
#include "ray_reading.h"
#include "stratus/volume.h"

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-function" /* a type uses only some of the fetches */
#endif

#define STRATUS_TYPE -1
#define RAY_NAME(x) JOIN(x, any)
#include "ray_reading_type.h"
#define STRATUS_TYPE -3
#define RAY_NAME(x) JOIN(x, tiles)
#include "ray_reading_type.h"
#define STRATUS_TYPE 0
#define RAY_NAME(x) JOIN(x, int8)
#include "ray_reading_type.h"
#define STRATUS_TYPE 1
#define RAY_NAME(x) JOIN(x, uint8)
#include "ray_reading_type.h"
#define STRATUS_TYPE 2
#define RAY_NAME(x) JOIN(x, int16)
#include "ray_reading_type.h"
#define STRATUS_TYPE 3
#define RAY_NAME(x) JOIN(x, uint16)
#include "ray_reading_type.h"
#define STRATUS_TYPE 8
#define RAY_NAME(x) JOIN(x, float32)
#include "ray_reading_type.h"
#define STRATUS_TYPE 9
#define RAY_NAME(x) JOIN(x, float64)
#include "ray_reading_type.h"

#define READING(type)                                                                                                                      \
  {                                                                                                                                        \
    reading_value_##type, reading_gradient_##type, reading_cell_##type, reading_nearest_##type                                             \
  }
_Static_assert(sizeof(ray_tiles) == sizeof(stratus_tiles), "fetches see the caller's tiles as their own");
const ray_reading RAY_READINGS[RAY_READING_TILES + 1] = { READING(any), READING(int8), READING(uint8), READING(int16), READING(uint16),
  READING(any), READING(any), READING(any), READING(any), READING(float32), READING(float64), READING(tiles) };
