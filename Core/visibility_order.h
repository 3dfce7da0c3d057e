/* SPDX-License-Identifier: BSD-3-Clause
 * What the files of the visibility order share: relations of one view, and the peeling of one leaf. */
#ifndef STRATUS_VISIBILITY_ORDER_H
#define STRATUS_VISIBILITY_ORDER_H

#include "mesh.h"

#define STRATUS_NO_CELL UINT32_MAX

/* An eye, or the direction of parallel rays, in the mesh's local coordinates: exact from here on. */
typedef struct stratus_view {
  double eye[3], direction[3];
  int parallel;
} stratus_view;

struct stratus_visibility_order {
  stratus_context* context;
  const double* points; /* borrowed */
  const int32_t* vertices;
  int64_t point_count, cell_count;
  double matrix[16];
  double bounds[6]; /* of the points: xmin xmax ymin .. */

  stratus_adjacency* adjacency; /* neighbours in other leaves taken out, those through coincident points put in */
  int8_t* side;                 /* the adjacency's orientation, flat cells given the one that fits their neighbours; 0: none does */

  stratus_partition_node* nodes;
  int32_t node_count, leaf_count;
  double frame[9];
  uint32_t* listed;     /* cells leaf by leaf; NULL: as they come */
  int64_t* leaf_begin;  /* leaf_count + 1 */
  int32_t* leaf_order;  /* front to back */
  int64_t* leaf_output; /* where each begins in the order */

  double* seen;     /* 3 a point: stratus_view_signs() */
  uint8_t* state;   /* a cell: bit f: its neighbour behind face f comes after it, bit 4 + f: before it */
  uint8_t* waiting; /* neighbours that come before it and have not come yet */
  float* key;       /* how far away */
  uint32_t* next;   /* in its bucket */
  uint32_t* cells;  /* the order */
  uint32_t* heads;  /* STRATUS_BUCKETS_MAX a thread */
  size_t bytes;
  double build_ms;

  bool sorted; /* cells are those of: */
  stratus_view view;
  stratus_peeling peeling;
  stratus_visibility_result result;
};

#define STRATUS_BUCKETS_MAX 65536

/* ---- visibility_flat.c: sides of cells without volume. What does not fit together is no neighbour any more. */
void stratus_order_side_flat_cells(stratus_visibility_order* order, uint32_t* queue);

/* ---- visibility_seams.c: neighbours through faces that coincide but name different points. */
stratus_status stratus_order_join_seams(stratus_visibility_order* order);

/* ---- visibility_leaves.c: takes a tree, NULL: none; checks it against the cells. */
stratus_status stratus_order_take_leaves(stratus_visibility_order* order, const stratus_leaves* leaves);
/* leaf_order and leaf_output of a view. */
void stratus_order_sort_leaves(stratus_visibility_order* order, const stratus_view* view);

/* ---- visibility_signs.c: state, waiting and key of all cells. Returns the signs that needed exact arithmetic. */
int64_t stratus_order_find_signs(stratus_visibility_order* order, const stratus_view* view);
/* How large a face of a cell is seen, in some unit of the view. */
double stratus_order_face_size(const stratus_visibility_order* order, uint32_t cell, int face);

/* ---- visibility_peel.c: one leaf's cells into order->cells. */
typedef struct stratus_peel_counts {
  int layers;
  int64_t cycles, forced;
} stratus_peel_counts;

stratus_peel_counts stratus_order_peel_leaf(stratus_visibility_order* order, int32_t leaf, stratus_peeling peeling, uint32_t* heads);

/* ---- visibility_cycles.c */

/* Nothing is ready, yet cells wait: one relation of a cycle is taken out, and the cell that it led to told, ready or not. `start` is a cell
 * that waits; `steps` is counted up by what the search cost. */
uint32_t stratus_order_break_cycle(stratus_visibility_order* order, uint32_t start, int64_t* steps);
/* By distance. */
void stratus_order_sort_by_key(const stratus_visibility_order* order, uint32_t* cells, int64_t count);

#endif
