/* SPDX-License-Identifier: BSD-3-Clause
 * Draws the calibration picture on the host or on a device, and takes the time. */
#include "calibration_picture.h"

#include "device_frame.h"
#include "instruction_set.h"
#include "tiles.h"

/* The picture is drawn at least so many times, and at least so long, and the shortest time counts: interruptions only add, and a GPU that
 * was idle needs a while until its clock is up. A first picture is not counted: it waits for the compiler and for new memory. */
#define REPEATS 3
#define LEAST_MS 40.0
#define TILES ((STRATUS_CALIBRATION_SIDE / STRATUS_CALIBRATION_TILE) * (STRATUS_CALIBRATION_SIDE / STRATUS_CALIBRATION_TILE))
#define VOLUME (STRATUS_CALIBRATION_VALUES * STRATUS_CALIBRATION_VALUES * STRATUS_CALIBRATION_VALUES)
#define GROUP_SIDE 8 /* rays along each side of a device's group */

typedef enum buffer_name { VALUES, TABLE, RGBA, BUFFERS } buffer_name;

typedef struct picture {
  const float *values, *table;
  float* rgba;
  stratus_calibration_tile* tile; /* the host's */
  cl_kernel kernel;               /* the device's */
  stratus_device_slot slots[BUFFERS];
} picture;

/* Smooth values within 0..1, and a table by which all of them show and rays stay see-through. */
static void fill(float* values, float* table)
{
  enum { SIDE = STRATUS_CALIBRATION_VALUES };
  float wave[SIDE];
  for (int i = 0; i < SIDE; ++i) {
    wave[i] = (float)sin(0.37 * i + 0.5);
  }
  for (int i = 0; i < VOLUME; ++i) {
    values[i] = 0.5f + 0.45f * wave[i % SIDE] * wave[i / SIDE % SIDE] * wave[i / SIDE / SIDE];
  }
  for (int i = 0; i < STRATUS_CALIBRATION_ENTRIES; ++i) {
    const float at = (float)i / STRATUS_CALIBRATION_ENTRIES, opacity = 0.05f * at;
    const float entry[4] = { opacity * at, opacity * (1.0f - at), 0.5f * opacity, opacity };
    for (int c = 0; c < 4; ++c) {
      table[4 * i + c] = entry[c];
    }
  }
}

static void draw_tile(const void* job, int tile, uint64_t counts[STRATUS_TILE_COUNTS])
{
  const picture* p = job;
  (void)counts;
  p->tile(p->values, p->table, tile, p->rgba);
}

static stratus_status draw_on_host(stratus_context* context, const picture* p)
{
  uint64_t counts[STRATUS_TILE_COUNTS];
  return stratus_each_tile(context, "calibration", TILES, draw_tile, p, counts);
}

/* Gives the device what it keeps from picture to picture. */
static stratus_status prepare_device(stratus_context* context, picture* p)
{
  TRY(stratus_device_kernel(context, "calibration_picture", "-DSTRATUS_DEVICE=1 -DSTRATUS_WIDTH=1", "calibration_picture", &p->kernel));
  TRY(stratus_slot_keep(context, p->slots + VALUES, p->values, VOLUME * sizeof(float)));
  return stratus_slot_keep(context, p->slots + TABLE, p->table, (size_t)4 * STRATUS_CALIBRATION_ENTRIES * sizeof(float));
}

static stratus_status draw_on_device(stratus_context* context, picture* p)
{
  const size_t bytes = STRATUS_CALIBRATION_FLOATS * sizeof(float);
  const size_t global[2] = { STRATUS_CALIBRATION_SIDE, STRATUS_CALIBRATION_SIDE }, local[2] = { GROUP_SIDE, GROUP_SIDE };
  TRY(stratus_slot_lend(context, p->slots + RGBA, CL_MEM_WRITE_ONLY, p->rgba, bytes));
  for (unsigned b = 0; b < BUFFERS; ++b) {
    TRY(stratus_device_argument(context, p->kernel, b, sizeof(cl_mem), &p->slots[b].memory));
  }
  TRY(stratus_device_run(context, p->kernel, 2, global, local));
  return stratus_slot_receive(context, p->slots + RGBA, p->rgba, bytes);
}

static stratus_status draw_often(stratus_context* context, picture* p, double* ms)
{
  double spent = 0.0;
  *ms = INFINITY;
  for (int i = 0; i <= REPEATS || spent < LEAST_MS; ++i) {
    const double start = stratus_now_ms();
    TRY(context->device ? draw_on_device(context, p) : draw_on_host(context, p));
    const double taken = stratus_now_ms() - start;
    if (i > 0) {
      *ms = fmin(*ms, taken);
      spent += taken;
    }
  }
  return STRATUS_OK;
}

stratus_status stratus_calibration_picture(stratus_context* context, float rgba[STRATUS_CALIBRATION_FLOATS], double* ms)
{
  static stratus_calibration_tile* const tiles[] = STRATUS_ISA_EACH(stratus_calibration_tile);
  void* memory = NULL;
  stratus_status status = STRATUS_OK;
  TRY(stratus_allocate(context, VOLUME + 4 * STRATUS_CALIBRATION_ENTRIES, sizeof(float), &memory));
  float* values = memory;
  picture p = { .values = values, .table = values + VOLUME, .rgba = rgba, .tile = tiles[stratus_isa_at_most(context->isa)] };
  fill(values, values + VOLUME);
  if (context->device) {
    TRY_CLEANUP(prepare_device(context, &p));
  }
  status = draw_often(context, &p, ms);
cleanup:
  for (int b = 0; b < BUFFERS; ++b) {
    stratus_slot_drop(p.slots + b);
  }
  stratus_release(context, memory);
  return status;
}
