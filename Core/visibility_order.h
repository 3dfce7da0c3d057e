/* SPDX-License-Identifier: BSD-3-Clause
 * What the files of the visibility order share: relations of one view, and the peeling of one leaf. */
#ifndef STRATUS_VISIBILITY_ORDER_H
#define STRATUS_VISIBILITY_ORDER_H

#include "mesh.h"

#define STRATUS_NO_CELL UINT32_MAX

/* What will be read soon. */
#ifdef __GNUC__
#define STRATUS_FETCH(address) __builtin_prefetch(address)
#else
#define STRATUS_FETCH(address) ((void)(address))
#endif

/* An eye, or the direction of parallel rays, in the mesh's local coordinates: exact from here on. */
typedef struct stratus_view {
  double eye[3], direction[3];
  int parallel;
} stratus_view;

/* A border face across which cells of its leaf may hide one another. */
typedef struct stratus_gate {
  float low, high; /* depths of its points lie between */
  float box[4];    /* in what its side sees, if there is one only */
  uint32_t held;   /* a way out: the first of the cells that wait for its own; linked by `next` */
  int8_t facing;   /* 1: a way out of the mesh, -1: a way in, 0: seen edge-on */
  uint8_t passed;  /* its cell has come */
  uint8_t sides;   /* of the view that see it: a bit each */
} stratus_gate;

/* A cell as peeling asks for it. */
typedef struct stratus_ordered_cell {
  int32_t neighbours[4]; /* of its leaf, -1: none */
  union {
    float key;     /* how far away, until it is put into a list: then stratus_order_key() tells */
    uint32_t next; /* of its bucket, or of what a gate holds */
  };
  uint8_t state;         /* bit f: its neighbour behind face f comes after it, bit 4 + f: before it */
  uint8_t waiting;       /* neighbours that come before it and have not come yet; and STRATUS_GATE_IN, _OUT */
  int8_t side;           /* of faces on which it lies: 1, -1, 0 for flat ones that fit nowhere */
  uint8_t faces;         /* bit f: it has a neighbour behind face f */
} stratus_ordered_cell;

struct stratus_visibility_order {
  stratus_context* context;
  const double* points; /* borrowed */
  const int32_t* vertices;
  int64_t point_count, cell_count;
  double matrix[16];
  double bounds[6]; /* of the points: xmin xmax ymin .. */

  stratus_adjacency* adjacency; /* while the order is made: in the mesh's numbers, those through coincident points put in */
  int8_t* side;                 /* as long: the adjacency's orientation, flat cells given the one that fits their neighbours; 0: none does */
  int64_t flat, folded, inverted;

  stratus_partition_node* nodes;
  int32_t node_count, leaf_count;
  double frame[9];
  stratus_ordered_cell* ordered; /* leaf by leaf: from here on a cell is a place in it, but in `cells` */
  uint32_t* listed;              /* the mesh's cell of each place; NULL: the same */
  int64_t* leaf_begin;  /* leaf_count + 1 */
  int32_t* leaf_order;  /* front to back */
  int64_t* leaf_output; /* where each begins in the order */

  uint32_t* gap_faces; /* leaf by leaf, rising: border faces beyond whose planes lies more of their leaf */
  int64_t* gap_begin;  /* leaf_count + 1 */
  stratus_gate* gates; /* of the gap faces in this view */
  uint32_t *gate_bins, *gate_entries;

  uint32_t* seen_at; /* of each point; NULL: its number */
  double* seen;     /* 3 a point: stratus_order_see_points() */
  uint32_t* cells;  /* the order, in the mesh's numbers */
  bool relations_changed; /* by the last signs: some cell's state is not what it was */
  struct stratus_device_signs* device_signs; /* what the device keeps from view to view; NULL: it was not asked */
  uint32_t* heads;  /* of buckets: at least as many as the largest leaf has, for each thread that peels */
  int64_t buckets;
  size_t bytes;
  double build_ms;

  bool sorted; /* cells are those of: */
  stratus_view view;
  stratus_peeling peeling;
  stratus_visibility_result result;
};

#define STRATUS_BUCKETS_MAX 65536
/* Coarse: within a bucket the cell that became ready last comes first, one of those just looked at, and its neighbours are still in the cache. */
#define STRATUS_CELLS_PER_BUCKET 8192
#define STRATUS_GATE_IN 0x80u  /* of a cell that has ways in from gaps */
#define STRATUS_GATE_OUT 0x40u /* of one that has ways out into gaps */

static inline int64_t stratus_order_buckets(int64_t cells)
{
  const int64_t wanted = cells / STRATUS_CELLS_PER_BUCKET + 1;
  return wanted < STRATUS_BUCKETS_MAX ? wanted : STRATUS_BUCKETS_MAX;
}

/* The mesh's number of the cell at a place. */
static inline uint32_t stratus_order_cell(const stratus_visibility_order* order, uint32_t place)
{
  return order->listed ? order->listed[place] : place;
}

static inline const int32_t* stratus_order_vertices(const stratus_visibility_order* order, uint32_t place)
{
  return order->vertices + 4 * (int64_t)stratus_order_cell(order, place);
}

static inline double* stratus_order_seen(const stratus_visibility_order* order, int64_t point)
{
  return order->seen + 3 * (order->seen_at ? (int64_t)order->seen_at[point] : point);
}

/* before << 4 | after, and all that come before still to come. Returns whether the state was another. */
static inline bool stratus_order_take_state(stratus_ordered_cell* ordered, unsigned state)
{
  const bool changed = ordered->state != state;
  ordered->state = (uint8_t)state;
  ordered->waiting = (uint8_t)((state >> 4 & 1) + (state >> 5 & 1) + (state >> 6 & 1) + (state >> 7 & 1));
  return changed;
}

static inline unsigned stratus_order_waits_for(const stratus_visibility_order* order, uint32_t cell)
{
  return order->ordered[cell].waiting & 7u;
}

/* ---- visibility_flat.c: sides of cells without volume. What does not fit together is no neighbour any more. */
stratus_status stratus_order_side_flat_cells(stratus_visibility_order* order);

/* ---- visibility_seams.c: neighbours through faces that coincide but name different points. */
stratus_status stratus_order_join_seams(stratus_visibility_order* order);

/* ---- visibility_points.c: seen_at. After the cells. */
stratus_status stratus_order_place_points(stratus_visibility_order* order);

/* ---- visibility_cells.c: ordered, listed and leaf_begin. leaf NULL: there is one. */
stratus_status stratus_order_take_cells(stratus_visibility_order* order, const int8_t* side, const int32_t* leaf);

/* ---- visibility_leaves.c: whether a tree is one, and has the mesh's cells in its leaves: asked first, as a mesh that has moved since is not
 * worth building anything for. NULL: there is none. */
stratus_status stratus_order_check_leaves(const stratus_visibility_order* order, const stratus_leaves* leaves);
/* Takes a checked tree. */
stratus_status stratus_order_take_leaves(stratus_visibility_order* order, const stratus_leaves* leaves);
/* leaf_order and leaf_output of a view. Returns whether leaves come in another order than in the last one. */
bool stratus_order_sort_leaves(stratus_visibility_order* order, const stratus_view* view);

/* ---- visibility_gaps.c: gap_faces. After leaves. */
stratus_status stratus_order_find_gaps(stratus_visibility_order* order);

/* ---- visibility_gates.c: a leaf's gap faces in one view */
typedef struct stratus_gate_grid {
  int size; /* bins across and down; 0: the side sees none */
  uint32_t first;
  double low[2], extent[2], scale[2];
} stratus_gate_grid;

typedef struct stratus_gates {
  stratus_visibility_order* order;
  int parallel, sides;
  const uint32_t* faces;
  stratus_gate* gates;
  int64_t count, held; /* gates; cells that are held back */
  stratus_gate_grid grids[6];
  uint32_t *bin_begin, *bin_end, *entries; /* ways out by what they cover of the view */
} stratus_gates;

#define STRATUS_GATE_BINS_EXTRA 8 /* a leaf, beyond one a gate */
#define STRATUS_GATE_ENTRIES 6    /* a gate in bins: at least one a side */

/* As seen: from the eye, or with z along the rays. */
typedef struct stratus_view_point {
  double x, y, z;
} stratus_view_point;

static inline uint32_t stratus_gate_cell(const stratus_gates* gates, int64_t gate)
{
  return gates->faces[gate] / 4;
}

void stratus_gate_points(const stratus_gates* gates, int64_t gate, stratus_view_point points[3]);

stratus_status stratus_gates_allocate(stratus_visibility_order* order, int64_t gaps);
/* After the signs: marks the cells that have gates. */
void stratus_gates_open(stratus_gates* gates, stratus_visibility_order* order, int32_t leaf);
/* A cell marked IN is to come: true if another has to come before it across a gap. It is held until then. */
bool stratus_gates_hold(stratus_gates* gates, uint32_t cell);
/* A cell marked OUT has come. Returns the cells that waited for it, linked by `next`, to be tried again. */
uint32_t stratus_gates_pass(stratus_gates* gates, uint32_t cell);
/* Nothing may come but cells are held: the nearest of them, not to be held again. */
uint32_t stratus_gates_yield(stratus_gates* gates, int64_t* steps);

/* ---- visibility_gate_bins.c */

/* Its sides and box. */
void stratus_gate_see(const stratus_gates* gates, stratus_gate* gate, const stratus_view_point points[3]);
/* The box around a gate's face in what a side sees, -1..1 where that is a side of the cube. False: it sees nothing of it. */
bool stratus_gate_box(const stratus_gates* gates, int64_t gate, int side, float box[4]);
/* First and last bins across and down. */
void stratus_gate_bins(const stratus_gate_grid* grid, const float box[4], int bins[4]);
/* All ways out. */
void stratus_gates_fill_bins(stratus_gates* gates);

/* ---- visibility_signs.c: state, waiting and key of all cells, and relations_changed. Returns the signs that needed exact arithmetic. */
int64_t stratus_order_find_signs(stratus_visibility_order* order, const stratus_view* view);
/* `seen` alone. */
void stratus_order_see_points(stratus_visibility_order* order, const stratus_view* view);
/* The sign of face_determinants() without rounding. */
int stratus_order_exact_sign(const stratus_visibility_order* order, const stratus_view* view, uint32_t cell, int face);
/* The cell's key once more. */
float stratus_order_key(const stratus_visibility_order* order, uint32_t cell);
/* 1: rays leave the cell through its face, -1: they come in, 0: it is seen edge-on, or may be. */
int stratus_order_facing(const stratus_visibility_order* order, uint32_t face);
/* How large a face of a cell is seen, in some unit of the view. */
double stratus_order_face_size(const stratus_visibility_order* order, uint32_t cell, int face);

/* ---- visibility_signs_device.c: the same as stratus_order_find_signs(), to the bit, by the context's device. */
typedef struct stratus_device_signs stratus_device_signs;

/* Whether the device should: a GPU that has doubles and room, asked for cells enough. */
bool stratus_order_signs_on_device(const stratus_visibility_order* order);
stratus_status stratus_order_find_signs_on_device(stratus_visibility_order* order, const stratus_view* view, int64_t* exact);
void stratus_device_signs_destroy(stratus_context* context, stratus_device_signs* signs); /* takes NULL */

/* ---- visibility_peel.c: one leaf's cells into order->cells. */
typedef struct stratus_peel_counts {
  int layers;
  int64_t cycles, forced;
} stratus_peel_counts;

stratus_peel_counts stratus_order_peel_leaf(stratus_visibility_order* order, int32_t leaf, stratus_peeling peeling, uint32_t* heads);

/* ---- visibility_cycles.c */

/* Nothing is ready, yet cells wait: one relation of a cycle is taken out, and the cell that it led to told, ready or not. `start` is a cell
 * that waits; `steps` is counted up by what the search cost. STRATUS_NO_CELL: there is no cycle, what `start` waits for is held back. */
uint32_t stratus_order_break_cycle(stratus_visibility_order* order, uint32_t start, int64_t* steps);
/* By distance; cells are places, of cells that are in no list. */
void stratus_order_sort_by_key(const stratus_visibility_order* order, uint32_t* cells, int64_t count);

#endif
