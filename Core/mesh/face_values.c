/* SPDX-License-Identifier: BSD-3-Clause
 * Values of faces at their nodes. */
#include "faces.h"

stratus_status stratus_faces_to_nodes(stratus_context* context, const stratus_faces* faces, const double* values, double* at_nodes)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!values || !at_nodes) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "values or at_nodes is NULL");
  }
  TRY(stratus_faces_check_nodes(context, faces));
  void* memory;
  TRY(stratus_allocate_zero(context, (size_t)faces->node_count, sizeof(int32_t), &memory));
  int32_t* const around = memory;
  for (int64_t node = 0; node < faces->node_count; ++node) {
    at_nodes[node] = 0.0;
  }
  for (int64_t f = 0; f < faces->face_count; ++f) {
    const bool there = !(faces->absent && faces->absent[f]) && isfinite(values[f]);
    for (int64_t i = faces->offsets[f]; there && i < faces->offsets[f + 1]; ++i) {
      at_nodes[faces->nodes[i]] += values[f];
      ++around[faces->nodes[i]];
    }
  }
  for (int64_t node = 0; node < faces->node_count; ++node) {
    at_nodes[node] = around[node] > 0 ? at_nodes[node] / around[node] : NAN;
  }
  stratus_release(context, memory);
  return STRATUS_OK;
}
