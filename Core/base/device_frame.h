/* SPDX-License-Identifier: BSD-3-Clause
 * Buffers of an OpenCL device that live from frame to frame. A device that shares memory with the host borrows the host's arrays for the
 * frame at hand, so that nothing is copied; any other gets copies. */
#ifndef STRATUS_DEVICE_FRAME_H
#define STRATUS_DEVICE_FRAME_H

#include "device.h"

typedef struct stratus_device_slot {
  cl_mem memory; /* NULL: none */
  size_t bytes;  /* that it can hold of a frame's; 0 where it belongs to the host */
  bool lent;     /* over the memory of the frame at hand: stratus_slots_return() */
} stratus_device_slot;

void stratus_slot_drop(stratus_device_slot* slot);

/* At least `bytes`, made anew only when the slot has to grow. */
stratus_status stratus_slot_reserve(stratus_context* context, stratus_device_slot* slot, cl_mem_flags access, size_t bytes);

/* For what outlives the frame: a copy, or, where device and host share memory, `host` itself, which must outlive the slot's use. NULL: a
 * few bytes, since a kernel's argument must be something. */
stratus_status stratus_slot_keep(stratus_context* context, stratus_device_slot* slot, const void* host, size_t bytes);

/* For one frame: the host's own memory where the device borrows it, else room for so many bytes. `host` NULL: not wanted. */
stratus_status stratus_slot_lend(stratus_context* context, stratus_device_slot* slot, cl_mem_flags access, const void* host, size_t bytes);
/* The same with what the host has written there. */
stratus_status stratus_slot_send(stratus_context* context, stratus_device_slot* slot, cl_mem_flags access, const void* host, size_t bytes);
/* What kernels have written, once they are done. `host` NULL: nothing. */
stratus_status stratus_slot_receive(stratus_context* context, const stratus_device_slot* slot, void* host, size_t bytes);
/* After a frame, whether or not it was drawn: lent memory is the host's own again. */
void stratus_slots_return(stratus_device_slot* slots, int count);

#endif
