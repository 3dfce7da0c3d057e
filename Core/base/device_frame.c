/* SPDX-License-Identifier: BSD-3-Clause
 * Buffers of an OpenCL device that are kept from frame to frame. */
#include "device_frame.h"

#define NOTHING 16 /* bytes of the buffer that replaces a missing array */

void stratus_slot_drop(stratus_device_slot* slot)
{
  stratus_device_buffer_release(slot->memory);
  *slot = (stratus_device_slot){ .memory = NULL };
}

stratus_status stratus_slot_reserve(stratus_context* context, stratus_device_slot* slot, cl_mem_flags access, size_t bytes)
{
  if (slot->memory && slot->bytes >= bytes) {
    return STRATUS_OK;
  }
  stratus_slot_drop(slot);
  TRY(stratus_device_buffer(context, access, bytes, NULL, false, &slot->memory));
  slot->bytes = bytes;
  return STRATUS_OK;
}

stratus_status stratus_slot_keep(stratus_context* context, stratus_device_slot* slot, const void* host, size_t bytes)
{
  stratus_slot_drop(slot);
  return stratus_device_buffer(context, CL_MEM_READ_ONLY, host ? bytes : NOTHING, host, host != NULL, &slot->memory);
}

stratus_status stratus_slot_lend(stratus_context* context, stratus_device_slot* slot, cl_mem_flags access, const void* host, size_t bytes)
{
  if (!host || bytes == 0 || !stratus_device_lends(context->device, host)) {
    return stratus_slot_reserve(context, slot, access, host && bytes > 0 ? bytes : NOTHING);
  }
  stratus_slot_drop(slot);
  TRY(stratus_device_buffer(context, access, bytes, host, true, &slot->memory));
  slot->lent = true;
  return STRATUS_OK;
}

stratus_status stratus_slot_send(stratus_context* context, stratus_device_slot* slot, cl_mem_flags access, const void* host, size_t bytes)
{
  TRY(stratus_slot_lend(context, slot, access, host, bytes));
  return !host || bytes == 0 || slot->lent ? STRATUS_OK : stratus_device_write(context, slot->memory, 0, bytes, host);
}

stratus_status stratus_slot_receive(stratus_context* context, const stratus_device_slot* slot, void* host, size_t bytes)
{
  if (!host) {
    return STRATUS_OK;
  }
  return slot->lent ? stratus_device_settle(context, slot->memory, bytes) : stratus_device_read(context, slot->memory, 0, bytes, host);
}

void stratus_slots_return(const stratus_context* context, stratus_device_slot* slots, int count)
{
  stratus_device_drain(context);
  for (int i = 0; i < count; ++i) {
    if (slots[i].lent) {
      stratus_slot_drop(slots + i);
    }
  }
}
