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

/* fmin() and fmax() of numbers, without a call. */
static inline double stratus_smaller(double a, double b)
{
  return b < a ? b : a;
}

static inline double stratus_larger(double a, double b)
{
  return b > a ? b : a;
}

/* The power of two that brings what is at most `largest` to at most 1. */
static inline double stratus_order_scale(double largest)
{
  int exponent;
  (void)frexp(largest, &exponent);
  return ldexp(1.0, exponent < -1000 ? 1000 : -exponent);
}

/* An eye, or the direction of parallel rays, in the mesh's local coordinates: exact from here on. */
typedef struct stratus_view {
  double eye[3], direction[3];
  int parallel;
} stratus_view;

/* A border face across which cells of its leaf may hide one another. */
typedef struct stratus_gate {
  float low, high; /* depths of its points lie between */
  float box[4];    /* in what its side sees, if there is one only */
  int8_t facing;   /* 1: a way out of the mesh, -1: a way in, 0: seen edge-on */
  uint8_t passed;  /* its cell has come */
  uint8_t sides;   /* of the view that see it: a bit each */
} stratus_gate;

/* Ways out among some gates that follow one another, or over some such nodes. */
typedef struct stratus_gate_node {
  float low, box[4]; /* as a gate's */
  uint32_t left;     /* that have not passed */
  uint8_t sides;
} stratus_gate_node;

/* Some cells that follow one another in their leaf, and are near one another. */
typedef struct stratus_order_seed {
  float key; /* how far away */
  uint32_t first;
} stratus_order_seed;

struct stratus_visibility_order {
  stratus_context* context;
  const double* points; /* borrowed */
  const int32_t* vertices;
  int64_t point_count, cell_count;
  double matrix[16];
  double bounds[6]; /* of the points: xmin xmax ymin .. */

  stratus_adjacency* adjacency; /* while the order is made: in the mesh's numbers, those through coincident points put in */
  int8_t* side; /* as long: the adjacency's orientation, flat cells given the one that fits their neighbours; 0: none does */
  int64_t flat, folded, inverted;

  stratus_partition_node* nodes;
  int32_t node_count, leaf_count;
  double frame[9];
  uint32_t* listed;    /* leaf by leaf: from here on a cell is a place in it, but in `cells`: the mesh's cell of each; NULL: the same */
  int32_t* neighbours; /* 4 a cell, of its leaf; itself where there is none */
  uint8_t* sides;   /* bit f: it has a neighbour behind face f; from bit 4 on, plus 1: on which side of its faces it lies, 0: flat, and fits
                     * nowhere */
  uint8_t* state;   /* of a view. Bit f: what is behind face f comes after the cell, bit 4 + f: before it; borders' faces, too */
  uint8_t* waiting; /* what peeling knows of a cell */
  int64_t* leaf_begin;  /* leaf_count + 1 */
  int32_t* leaf_order;  /* front to back */
  int64_t* leaf_output; /* where each begins in the order */
  int64_t* leaf_work;   /* leaf_count: what each takes, about, times STRATUS_LEAVES_MAX, plus its number: most first */

  uint32_t* gap_faces; /* leaf by leaf, rising: border faces beyond whose planes lies more of their leaf */
  int64_t* gap_begin;  /* leaf_count + 1 */
  uint32_t* gap_at;    /* the first face of each STRATUS_GAP_BLOCK cells, or of those behind them */
  stratus_gate* gates; /* of the gap faces in this view */
  stratus_gate_node* gate_nodes;

  uint32_t* seen_at;                         /* of each point; NULL: its number */
  double* seen;                              /* 3 a point: stratus_order_see_points() */
  uint32_t* cells;                           /* the order, in the mesh's numbers */
  bool relations_changed;                    /* by the last signs: some cell's state is not what it was */
  struct stratus_device_signs* device_signs; /* what the device keeps from view to view; NULL: it was not asked */
  stratus_order_seed* seeds;                 /* as many as the largest leaf has, for each thread that peels */
  int64_t seed_count;
  int64_t steps_per_cell; /* that the search for rings may take: STRATUS_STEPS_PER_CELL, but for tests */
  size_t bytes;
  double build_ms;

  bool sorted; /* cells are those of: */
  stratus_view view;
  stratus_peeling peeling;
  stratus_visibility_result result;
};

#define STRATUS_LEAVES_MAX 65536
#define STRATUS_SEED_CELLS 512
#define STRATUS_GAP_BLOCK 64 /* a power of two */
#define STRATUS_STEPS_PER_CELL 64
/* Border faces that follow one another stand under a box, so many of those under another, .. */
#define STRATUS_GATE_CHILDREN 8
#define STRATUS_GATE_LEVELS_MAX 12 /* 8^12 > 2^32 */
/* Times n sqrt(n) for a leaf's n gates: some times what one out of which every third cell is missing takes. */
#define STRATUS_GATE_TESTS 64
/* More rings across gaps than this and the root of a leaf's cells: they overlap, and no order is right. */
#define STRATUS_GATE_RINGS 64

/* The mesh's number of the cell at a place. */
static inline uint32_t stratus_order_cell(const stratus_visibility_order* order, uint32_t place)
{
  return order->listed ? order->listed[place] : place;
}

static inline const int32_t* stratus_order_vertices(const stratus_visibility_order* order, uint32_t place)
{
  return order->vertices + 4 * (int64_t)stratus_order_cell(order, place);
}

/* Where a point stands in `seen`. */
static inline int64_t stratus_order_seen_at(const stratus_visibility_order* order, int64_t point)
{
  return 3 * (order->seen_at ? (int64_t)order->seen_at[point] : point);
}

static inline double* stratus_order_seen(const stratus_visibility_order* order, int64_t point)
{
  return order->seen + stratus_order_seen_at(order, point);
}

/* Faces through which a cell's neighbours come before it, or after it: a bit each. */
static inline unsigned stratus_order_before(const stratus_visibility_order* order, uint32_t cell)
{
  return (unsigned)order->state[cell] >> 4 & order->sides[cell];
}

static inline unsigned stratus_order_after(const stratus_visibility_order* order, uint32_t cell)
{
  return order->state[cell] & order->sides[cell] & 15u;
}

/* Of the lowest four bits, those that are set. */
static inline int stratus_order_count_faces(unsigned bits)
{
  return (int)((bits & 1) + (bits >> 1 & 1) + (bits >> 2 & 1) + (bits >> 3 & 1));
}

/* before << 4 | after. Returns whether a neighbour that came before comes after, or the like. */
static inline bool stratus_order_take_state(stratus_visibility_order* order, int64_t cell, unsigned state)
{
  const bool changed = ((order->state[cell] ^ state) & (order->sides[cell] & 15u) * 17u) != 0;
  order->state[cell] = (uint8_t)state;
  return changed;
}

/* The side of its faces on which a cell lies. */
static inline int stratus_order_side(const stratus_visibility_order* order, int64_t cell)
{
  return (order->sides[cell] >> 4) - 1;
}

/* Memory that lasts as long as the order, counted in its bytes. */
static inline stratus_status stratus_order_allocate(stratus_visibility_order* order, size_t count, size_t size, void** memory)
{
  TRY(stratus_allocate(order->context, count, size, memory));
  order->bytes += count * size;
  return STRATUS_OK;
}

/* ---- visibility_flat.c: sides of cells without volume. What does not fit together is no neighbour any more. */
stratus_status stratus_order_side_flat_cells(stratus_visibility_order* order);

/* ---- visibility_seams.c: neighbours through faces that coincide but name different points. */
stratus_status stratus_order_join_seams(stratus_visibility_order* order);

/* ---- visibility_cells.c: listed, neighbours, sides, state, waiting and leaf_begin. leaf NULL: there is one. */
stratus_status stratus_order_take_cells(stratus_visibility_order* order, const int8_t* side, const int32_t* leaf);
/* seen_at. After the cells. */
stratus_status stratus_order_place_points(stratus_visibility_order* order);

/* ---- visibility_leaves.c: whether a tree is one, and has the mesh's cells in its leaves: asked first, as a mesh that has moved since is
 * not worth building anything for. NULL: there is none. */
stratus_status stratus_order_check_leaves(const stratus_visibility_order* order, const stratus_leaves* leaves);
/* Takes a checked tree. */
stratus_status stratus_order_take_leaves(stratus_visibility_order* order, const stratus_leaves* leaves);
/* leaf_order and leaf_output of a view. Returns whether leaves come in another order than in the last one. */
bool stratus_order_sort_leaves(stratus_visibility_order* order, const stratus_view* view);

/* ---- visibility_gaps.c: gap_faces, gap_at. After leaves. */
stratus_status stratus_order_find_gaps(stratus_visibility_order* order);

/* ---- visibility_gates.c: a leaf's gap faces in one view */

typedef struct stratus_gates {
  stratus_visibility_order* order;
  int parallel, sides;
  const uint32_t* faces;
  stratus_gate* gates;
  int64_t count;
  stratus_gate_node* nodes; /* over gates that follow one another, over those nodes, ..: level by level, the finest first */
  int64_t level_begin[STRATUS_GATE_LEVELS_MAX];
  int levels;
  int64_t tests;      /* boxes and faces that were held against ways in */
  int64_t tests_left; /* may still be; below 0: no way in waits for anything any more */
  int64_t ring_tests; /* that a ring across gaps costs */
} stratus_gates;

/* As seen: from the eye, or with z along the rays. */
typedef struct stratus_view_point {
  double x, y, z;
} stratus_view_point;

static inline uint32_t stratus_gate_cell(const stratus_gates* gates, int64_t gate)
{
  return gates->faces[gate] / 4;
}

/* The corners of a gate's face, as seen. */
static inline void stratus_gate_points(const stratus_gates* gates, int64_t gate, stratus_view_point points[3])
{
  const stratus_visibility_order* order = gates->order;
  const int32_t* v = stratus_order_vertices(order, stratus_gate_cell(gates, gate));
  for (unsigned i = 0; i < 3; ++i) {
    const double* p = stratus_order_seen(order, v[(gates->faces[gate] + 1 + i) % 4]);
    points[i] = (stratus_view_point){ p[0], p[1], p[2] };
  }
}

stratus_status stratus_gates_allocate(stratus_visibility_order* order, int64_t gaps);
#define STRATUS_GATE_IN 0x80u  /* of `waiting`: the cell has ways in from gaps */
#define STRATUS_GATE_OUT 0x40u /* ways out into gaps */

/* After the signs. Marks the cells that have gates. */
void stratus_gates_open(stratus_gates* gates, stratus_visibility_order* order, int32_t leaf);
/* A cell that has not come and has to before one that is marked IN, across a gap; STRATUS_NO_CELL: none. */
uint32_t stratus_gates_before(stratus_gates* gates, uint32_t cell);
/* A ring's: the ways in by which it has to wait no more. False: there are none. */
bool stratus_gates_cut(stratus_gates* gates, uint32_t cell, uint32_t before);
/* A cell marked OUT has come. */
void stratus_gates_pass(stratus_gates* gates, uint32_t cell);

/* ---- visibility_gate_cover.c */

/* Whether the face of gate a lies before the one of b in the middle of what they share of the view. */
bool stratus_gate_lies_before(const stratus_gates* gates, int64_t a, int64_t b);

/* ---- visibility_gate_tree.c: ways out by where they are in the view */

/* A gate's sides and box. */
void stratus_gate_see(const stratus_gates* gates, stratus_gate* gate, const stratus_view_point points[3]);
/* Over all gates that have been seen. */
void stratus_gates_build_tree(stratus_gates* gates);
/* A way out that has not passed, of another cell than a way in's, and lies before that; -1: none. */
int64_t stratus_gates_search(stratus_gates* gates, int64_t way_in);
void stratus_gates_take_from_tree(stratus_gates* gates, int64_t way_out);

/* ---- visibility_signs.c: state of all cells, and relations_changed. Returns the signs that needed exact arithmetic. */
int64_t stratus_order_find_signs(stratus_visibility_order* order, const stratus_view* view);
/* `seen` alone. */
void stratus_order_see_points(stratus_visibility_order* order, const stratus_view* view);
/* The sign of face_determinants() without rounding. */
int stratus_order_exact_sign(const stratus_visibility_order* order, const stratus_view* view, uint32_t cell, int face);
/* How far away a cell is. */
float stratus_order_key(const stratus_visibility_order* order, uint32_t cell);
/* How large a face of a cell is seen, in some unit of the view. */
double stratus_order_face_size(const stratus_visibility_order* order, uint32_t cell, int face);

/* ---- visibility_signs_device.c: the same as stratus_order_find_signs(), to the bit, by the context's device. */
typedef struct stratus_device_signs stratus_device_signs;

/* Whether the device should: a GPU that has doubles and room, asked for cells enough. */
bool stratus_order_signs_on_device(const stratus_visibility_order* order);
stratus_status stratus_order_find_signs_on_device(stratus_visibility_order* order, const stratus_view* view, int64_t* exact);
void stratus_device_signs_destroy(stratus_context* context, stratus_device_signs* signs); /* takes NULL */

/* One leaf's cells into order->cells. seeds: room for the leaf's. */
typedef struct stratus_peel_counts {
  int layers;
  int64_t cycles, forced, overlaps, gate_tests;
} stratus_peel_counts;

/* ---- visibility_nearest.c */
stratus_peel_counts stratus_order_leaf_nearest(stratus_visibility_order* order, int32_t leaf, stratus_order_seed* seeds);

/* ---- visibility_layers.c */
stratus_peel_counts stratus_order_leaf_layers(stratus_visibility_order* order, int32_t leaf, stratus_order_seed* seeds);

/* ---- visibility_peeling.c */

/* A neighbour need no longer come before a cell: one relation of a ring, on both sides of its face. */
void stratus_order_cut(stratus_visibility_order* order, uint32_t cell, int face);

/* Steps of a leaf's cells: some that follow one another, and so are near one another. */
static inline int64_t stratus_order_seed_count(int64_t cells)
{
  return (cells + STRATUS_SEED_CELLS - 1) / STRATUS_SEED_CELLS;
}

/* A leaf's, nearest first. */
void stratus_order_sort_seeds(const stratus_visibility_order* order, int32_t leaf, stratus_order_seed* seeds);

#endif
