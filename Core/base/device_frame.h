/* SPDX-License-Identifier: BSD-3-Clause
 * Buffers of an OpenCL device that are kept from frame to frame. A device that shares memory with the host borrows the host's arrays for
 * one frame, which saves copies. Other devices get copies. */
#ifndef STRATUS_DEVICE_FRAME_H
#define STRATUS_DEVICE_FRAME_H

#include "device.h"

typedef struct stratus_device_slot {
  cl_mem memory; /* NULL: none */
  size_t bytes;  /* capacity for a frame's data; 0 if the memory belongs to the host */
  bool lent;     /* the buffer borrows host memory for one frame: stratus_slots_return() ends that */
} stratus_device_slot;

void stratus_slot_drop(stratus_device_slot* slot);

/* Gives the slot at least `bytes`. Creates a new buffer only if the slot has to grow. */
stratus_status stratus_slot_reserve(stratus_context* context, stratus_device_slot* slot, cl_mem_flags access, size_t bytes);

/* Fills the slot with data that outlives the frame: a copy of `host`, or, where device and host share memory, `host` itself, which must
 * then outlive the slot's use. host NULL: the slot gets a few bytes, because a kernel's argument must be some buffer. */
stratus_status stratus_slot_keep(stratus_context* context, stratus_device_slot* slot, const void* host, size_t bytes);

/* Prepares the slot for one frame: it borrows `host` where the device can, else it gets room for `bytes`. host NULL: the kernel does not
 * need the array. */
stratus_status stratus_slot_lend(stratus_context* context, stratus_device_slot* slot, cl_mem_flags access, const void* host, size_t bytes);
/* Does the same, and gives the device the bytes that the host has written to `host`. */
stratus_status stratus_slot_send(stratus_context* context, stratus_device_slot* slot, cl_mem_flags access, const void* host, size_t bytes);
/* Waits for the kernels, and gives `host` the bytes that they have written. host NULL: does nothing. */
stratus_status stratus_slot_receive(stratus_context* context, const stratus_device_slot* slot, void* host, size_t bytes);
/* Ends all loans after a frame, whether or not it was drawn: the host may use its memory again. */
void stratus_slots_return(const stratus_context* context, stratus_device_slot* slots, int count);

#endif
