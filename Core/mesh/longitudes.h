/* SPDX-License-Identifier: BSD-3-Clause
 * Longitudes that jump by whole turns, on any graph of neighbours. */
#ifndef STRATUS_LONGITUDES_H
#define STRATUS_LONGITUDES_H

#include "base.h"

#define TURN 360.0 /* degrees */

/* Receives two places that are neighbours. */
typedef void (*stratus_edge_function)(void* state, int64_t a, int64_t b);

/* Places and their neighbours. `walk` calls back with each pair of neighbours; it reads the graph that the struct is the first member of.
 */
typedef struct stratus_edges {
  int64_t count; /* of places */
  void (*walk)(const struct stratus_edges* edges, stratus_edge_function call, void* state);
} stratus_edges;

/* Return the whole turns by which a difference of longitudes is less than half a turn: 0 up to 180 degrees. */
double stratus_longitudes_turns(double difference);
/* Return whether neighbours differ by more than half a turn. */
bool stratus_longitudes_jump(const stratus_edges* edges, const double* degrees);
/* Add whole turns to longitudes, as stratus_longitudes_unwrap() describes. */
stratus_status stratus_longitudes_join(stratus_context* context, const stratus_edges* edges, double* degrees, int* changed);

#endif
