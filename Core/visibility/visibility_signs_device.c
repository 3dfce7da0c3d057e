/* SPDX-License-Identifier: BSD-3-Clause
 * Signs of faces on the context's device. The device keeps the cells from view to view. A view sends the points as they are seen, and reads
 * back a word per cell, in parts, so that the host needs no room for all words. The host decides exactly what the device's rounding leaves
 * open. */
#include "device.h"
#include "visibility_order.h"

#define PART ((int64_t)1 << 17)      /* cells read back at once */
#define CELLS_MIN ((int64_t)1 << 14) /* the host has done fewer before a device could begin */

struct stratus_device_signs {
  cl_mem corners, sides, seen, results;
};

bool stratus_order_signs_on_device(const stratus_visibility_order* order)
{
  const stratus_device* device = order->context->device;
  if (!device || stratus_device_is_cpu(device) || !stratus_device_has_double(device) || order->cell_count < CELLS_MIN) {
    return false;
  }
  const size_t largest = stratus_device_largest_allocation(device);
  return (size_t)order->cell_count <= largest / (4 * sizeof(int32_t)) && (size_t)order->point_count <= largest / (3 * sizeof(double));
}

void stratus_device_signs_destroy(stratus_context* context, stratus_device_signs* signs)
{
  if (signs) {
    stratus_device_buffer_release(signs->corners);
    stratus_device_buffer_release(signs->sides);
    stratus_device_buffer_release(signs->seen);
    stratus_device_buffer_release(signs->results);
    stratus_release(context, signs);
  }
}

/* Sends a part of the cells: the places in `seen` of their corners. */
static stratus_status send_corners(
  const stratus_visibility_order* order, stratus_device_signs* signs, int64_t begin, int64_t count, int32_t* corners)
{
  for (int64_t i = 0; i < count; ++i) {
    const int32_t* v = stratus_order_vertices(order, (uint32_t)(begin + i));
    for (int f = 0; f < 4; ++f) {
      corners[4 * i + f] = order->seen_at ? (int32_t)order->seen_at[v[f]] : v[f];
    }
  }
  const size_t cells = (size_t)count, first = (size_t)begin;
  return stratus_device_write(order->context, signs->corners, 4 * first * sizeof *corners, 4 * cells * sizeof *corners, corners);
}

static stratus_status make_signs(stratus_visibility_order* order)
{
  stratus_context* context = order->context;
  const size_t cells = (size_t)order->cell_count, part = (size_t)(order->cell_count < PART ? order->cell_count : PART);
  stratus_status status = STRATUS_OK;
  void *memory = NULL, *corners = NULL;
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_device_signs), &memory));
  stratus_device_signs* signs = memory;
  TRY_CLEANUP(stratus_allocate(context, part, 4 * sizeof(int32_t), &corners));
  TRY_CLEANUP(stratus_device_buffer(context, CL_MEM_READ_ONLY, 4 * cells * sizeof(int32_t), NULL, false, &signs->corners));
  TRY_CLEANUP(stratus_device_buffer(context, CL_MEM_READ_ONLY, cells, NULL, false, &signs->sides));
  TRY_CLEANUP(stratus_device_buffer(context, CL_MEM_READ_ONLY, (size_t)order->point_count * 3 * sizeof(double), NULL, false, &signs->seen));
  TRY_CLEANUP(stratus_device_buffer(context, CL_MEM_WRITE_ONLY, cells * sizeof(uint16_t), NULL, false, &signs->results));
  for (int64_t begin = 0; begin < order->cell_count; begin += PART) {
    const int64_t left = order->cell_count - begin;
    TRY_CLEANUP(send_corners(order, signs, begin, left < PART ? left : PART, corners));
  }
  TRY_CLEANUP(stratus_device_write(context, signs->sides, 0, cells, order->sides));
  order->device_signs = signs;
  signs = NULL;

cleanup:
  stratus_device_signs_destroy(context, signs);
  stratus_release(context, corners);
  return status;
}

static stratus_status run_signs(const stratus_visibility_order* order, const stratus_view* view)
{
  stratus_context* context = order->context;
  const stratus_device_signs* signs = order->device_signs;
  const cl_ulong cells = (cl_ulong)order->cell_count;
  const cl_int parallel = view->parallel;
  const stratus_kernel_argument arguments[] = { ARGUMENT(signs->seen), ARGUMENT(signs->corners), ARGUMENT(signs->sides), ARGUMENT(cells),
    ARGUMENT(parallel), ARGUMENT(signs->results) };
  TRY(stratus_device_write(context, signs->seen, 0, (size_t)order->point_count * 3 * sizeof *order->seen, order->seen));
  const int64_t items[3] = { order->cell_count, 1, 1 };
  return stratus_device_launch(context, "visibility_signs", "", "signs", arguments, COUNT_OF(arguments), items);
}

/* Takes the device's result for a cell. Bits 0 to 7 are its state; a set bit 8 + f leaves face f to the host. Returns how many it left. */
static int64_t take_result(stratus_visibility_order* order, const stratus_view* view, uint32_t cell, unsigned result, bool* changed)
{
  unsigned state = result & 255u;
  int64_t exact = 0;
  for (int f = 0; f < 4; ++f) {
    if (result >> (8 + f) & 1) {
      const int sign = stratus_order_exact_sign(order, view, cell, f) * stratus_order_side(order, cell);
      state |= (unsigned)(sign < 0) << f | (unsigned)(sign > 0) << (4 + f);
      ++exact;
    }
  }
  *changed = stratus_order_take_state(order, cell, state) || *changed;
  return exact;
}

stratus_status stratus_order_find_signs_on_device(stratus_visibility_order* order, const stratus_view* view, int64_t* exact)
{
  stratus_context* context = order->context;
  stratus_status status = STRATUS_OK;
  void* memory = NULL;
  int64_t open = 0;
  bool changed = false;
  if (!order->device_signs) {
    TRY(make_signs(order));
  }
  TRY(stratus_allocate(context, (size_t)(order->cell_count < PART ? order->cell_count : PART), sizeof(uint16_t), &memory));
  const uint16_t* results = memory;
  stratus_order_see_points(order, view);
  TRY_CLEANUP(run_signs(order, view));
  for (int64_t begin = 0; begin < order->cell_count; begin += PART) {
    const int64_t left = order->cell_count - begin, count = left < PART ? left : PART;
    const size_t cell = sizeof(uint16_t);
    TRY_CLEANUP(stratus_device_read(context, order->device_signs->results, (size_t)begin * cell, (size_t)count * cell, memory));
#pragma omp parallel for schedule(static) num_threads(context->threads) reduction(+ : open) reduction(|| : changed)
    for (int64_t i = 0; i < count; ++i) {
      open += take_result(order, view, (uint32_t)(begin + i), results[i], &changed);
    }
  }
  order->relations_changed = changed;
  *exact = open;

cleanup:
  stratus_release(context, memory);
  return status;
}
