/* SPDX-License-Identifier: BSD-3-Clause
 * The visibility order's structures, and the functions that its files share.
 *
 * A view decides for each inner face which of its two cells comes before the other: a relation. Peeling a leaf of the K-D tree lists its
 * cells so that all relations hold. A cycle of relations, here a ring, has no such list, and loses a relation.
 *
 * A gap is empty space between cells of a leaf, which a ray can cross. A gate is a border face at a gap. Rays leave the cells at an exit
 * gate (way_out), and come back into them at an entry gate (way_in): the exit's cell has to come before the entry's cell. */
#ifndef STRATUS_VISIBILITY_ORDER_H
#define STRATUS_VISIBILITY_ORDER_H

#include "stratus/visibility.h"
#include "mesh.h"

#define STRATUS_NO_CELL UINT32_MAX

/* Prefetches memory that will be read soon. */
#ifdef __GNUC__
#define STRATUS_FETCH(address) __builtin_prefetch(address)
#else
#define STRATUS_FETCH(address) ((void)(address))
#endif

/* fmin() and fmax() for values that are not NaN: compilers call those functions, but inline these. */
static inline double stratus_smaller(double a, double b)
{
  return b < a ? b : a;
}

static inline double stratus_larger(double a, double b)
{
  return b > a ? b : a;
}

/* The power of two that scales a length of `largest` to at most 1. */
static inline double stratus_order_scale(double largest)
{
  int exponent;
  (void)frexp(largest, &exponent);
  return ldexp(1.0, exponent < -1000 ? 1000 : -exponent);
}

/* An eye, or the direction of parallel rays, in the mesh's local coordinates. It counts as exact from here on. */
typedef struct stratus_view {
  double eye[3], direction[3];
  int parallel;
} stratus_view;

/* A border face at a gap, in one view. */
typedef struct stratus_gate {
  float low, high; /* its points' depths are between them */
  float box[4];    /* its extent in the view, if only one side sees it: umin umax vmin vmax */
  int8_t facing;   /* 1: exit, -1: entry, 0: seen edge-on, or cut from a ring */
  uint8_t passed;  /* its cell is listed */
  uint8_t sides;   /* a bit for each of the view's sides that sees it */
} stratus_gate;

/* A node over STRATUS_GATE_CHILDREN consecutive gates or nodes: it covers their ways out. */
typedef struct stratus_gate_node {
  float low, box[4]; /* as in stratus_gate */
  uint32_t left;     /* ways out whose cells are not listed yet */
  uint8_t sides;
} stratus_gate_node;

/* STRATUS_SEED_CELLS consecutive cells of a leaf, which lie near one another. */
typedef struct stratus_order_seed {
  float key; /* stratus_order_key() of its middle cell */
  uint32_t first;
} stratus_order_seed;

struct stratus_visibility_order {
  stratus_context* context;
  const double* points; /* borrowed */
  const int32_t* vertices;
  int64_t point_count, cell_count;
  double matrix[16];
  double bounds[6]; /* of the points: xmin xmax ymin ymax zmin zmax */

  stratus_adjacency* adjacency; /* by the mesh's cell numbers, joined across seams; NULL once the order is made */
  int8_t* side; /* the adjacency's orientations, with a side for each flat cell that some neighbour fits, else 0; NULL with it */
  int64_t flat, folded, inverted;

  stratus_partition_node* nodes;
  int32_t node_count, leaf_count;
  double frame[9];
  uint32_t* listed;     /* the mesh's cell at each place; NULL: the same. Arrays below name cells by place, except `cells` */
  int32_t* neighbours;  /* 4 a cell: its leaf's cell behind each face; the cell itself at the leaf's border */
  uint8_t* sides;       /* bit f: face f has a neighbour. Bits 4 and 5: stratus_order_side() + 1 */
  uint8_t* state;       /* of a view, for border faces, too. Bit f: the cell behind face f comes after the cell; bit 4 + f: before it */
  uint8_t* waiting;     /* how far peeling is with each cell: each method has a code of its own */
  int64_t* leaf_begin;  /* leaf_count + 1 */
  int32_t* leaf_order;  /* leaves, front to back */
  int64_t* leaf_output; /* each leaf's first entry in `cells` */
  int64_t* leaf_work;   /* per leaf: estimated time to peel * STRATUS_LEAVES_MAX + leaf, the longest first */

  /* 4*place + face of each gap face (a border face with more of its leaf beyond its plane), ascending within each leaf */
  uint32_t* gap_faces;
  int64_t* gap_begin;  /* leaf_count + 1 */
  uint32_t* gap_at;    /* for each block of STRATUS_GAP_BLOCK cells: the first gap face of the block, or after it */
  stratus_gate* gates; /* the gap faces in this view */
  stratus_gate_node* gate_nodes;

  uint32_t* seen_at;                           /* each point's place in `seen`; NULL: its number */
  double* seen;                                /* 3 coordinates a point, by stratus_order_see_points() */
  uint32_t* cells;                             /* the result, front to back, by the mesh's cell numbers */
  bool relations_changed;                      /* the last view changed some cell's state */
  struct stratus_device_signs* device_signs;   /* the device's buffers, kept from view to view; NULL: it has not been used */
  struct stratus_device_layers* device_layers; /* the device's buffers for peeling in layers; NULL: not used yet */
  stratus_order_seed* seeds;                   /* seed_count for each thread that peels: the largest leaf's */
  int64_t seed_count;
  int64_t steps_per_cell; /* limit of the search for rings: STRATUS_STEPS_PER_CELL; tests lower it */
  size_t bytes;
  double build_ms;

  bool sorted; /* `cells` belongs to the view, peeling and result below */
  stratus_view view;
  stratus_peeling peeling;
  stratus_visibility_result result;
};

/* Continue with `mesh`'s arrays, which have the same content as the arrays from which the order was made. */
void stratus_visibility_order_rebase(stratus_visibility_order* order, const stratus_mesh* mesh);

#define STRATUS_LEAVES_MAX 65536
#define STRATUS_SEED_CELLS 512
#define STRATUS_GAP_BLOCK 64 /* a power of two */
#define STRATUS_STEPS_PER_CELL 64
/* Children of a node in the trees over border faces. */
#define STRATUS_GATE_CHILDREN 8
#define STRATUS_GATE_LEVELS_MAX 12 /* 8^12 > 2^32 */
/* A leaf of n gates may spend STRATUS_GATE_TESTS * n * sqrt(n) tests: several times what a grid takes that lacks every third cell. */
#define STRATUS_GATE_TESTS 64
/* A leaf of n cells with more than STRATUS_GATE_RINGS + sqrt(n) rings across gaps has cells that overlap: no order is right. */
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

/* The index of a point's first coordinate in `seen`. */
static inline int64_t stratus_order_seen_at(const stratus_visibility_order* order, int64_t point)
{
  return 3 * (order->seen_at ? (int64_t)order->seen_at[point] : point);
}

static inline double* stratus_order_seen(const stratus_visibility_order* order, int64_t point)
{
  return order->seen + stratus_order_seen_at(order, point);
}

/* A bit for each face whose neighbour comes before the cell; stratus_order_after(): after it. */
static inline unsigned stratus_order_before(const stratus_visibility_order* order, uint32_t cell)
{
  return (unsigned)order->state[cell] >> 4 & order->sides[cell];
}

static inline unsigned stratus_order_after(const stratus_visibility_order* order, uint32_t cell)
{
  return order->state[cell] & order->sides[cell] & 15u;
}

/* How many of the lowest four bits are set. */
static inline int stratus_order_count_faces(unsigned bits)
{
  return (int)((bits & 1) + (bits >> 1 & 1) + (bits >> 2 & 1) + (bits >> 3 & 1));
}

/* state: before << 4 | after, a bit a face. Returns whether the relation to a neighbour changed; border faces do not count. */
static inline bool stratus_order_take_state(stratus_visibility_order* order, int64_t cell, unsigned state)
{
  const bool changed = ((order->state[cell] ^ state) & (order->sides[cell] & 15u) * 17u) != 0;
  order->state[cell] = (uint8_t)state;
  return changed;
}

/* 1 or -1: the side of its faces on which a cell lies; 0: it is flat and fits nowhere. */
static inline int stratus_order_side(const stratus_visibility_order* order, int64_t cell)
{
  return (order->sides[cell] >> 4) - 1;
}

/* Allocates memory that lasts as long as the order, and adds it to order->bytes. */
static inline stratus_status stratus_order_allocate(stratus_visibility_order* order, size_t count, size_t size, void** memory)
{
  TRY(stratus_allocate(order->context, count, size, memory));
  order->bytes += count * size;
  return STRATUS_OK;
}

/* ---- visibility_flat.c: gives cells without volume a side in order->side. Cells whose sides contradict stop being neighbours. */
stratus_status stratus_order_side_flat_cells(stratus_visibility_order* order);

/* ---- visibility_seams.c: makes cells neighbours whose border faces coincide but name different points. */
stratus_status stratus_order_join_seams(stratus_visibility_order* order);

/* ---- visibility_cells.c: makes listed, neighbours, sides, state, waiting and leaf_begin. leaf: each cell's; NULL: there is only one. */
stratus_status stratus_order_take_cells(stratus_visibility_order* order, const int8_t* side, const int32_t* leaf);
/* Makes seen_at, from the cells. */
stratus_status stratus_order_place_points(stratus_visibility_order* order);

/* ---- visibility_leaves.c: refuses leaves that are no tree, or whose boxes do not hold their cells. This comes first: a mesh that moved
 * since the partition is refused before anything is built. NULL passes: there is no tree. */
stratus_status stratus_order_check_leaves(const stratus_visibility_order* order, const stratus_leaves* leaves);
/* Copies a checked tree, and takes the cells by its leaves. */
stratus_status stratus_order_take_leaves(stratus_visibility_order* order, const stratus_leaves* leaves);
/* Makes leaf_order and leaf_output for a view. Returns whether the leaves' order differs from the last view's. */
bool stratus_order_sort_leaves(stratus_visibility_order* order, const stratus_view* view);

/* ---- visibility_gaps.c: makes gap_begin, gap_faces and gap_at, from the leaves' cells, and room for their gates. */
stratus_status stratus_order_find_gaps(stratus_visibility_order* order);

/* ---- visibility_gates.c: a leaf's gap faces in one view */

typedef struct stratus_gates {
  stratus_visibility_order* order;
  int parallel, sides;
  const uint32_t* faces;
  stratus_gate* gates;
  int64_t count;
  stratus_gate_node* nodes; /* level by level: first those over gates, then those over nodes of the level before */
  int64_t level_begin[STRATUS_GATE_LEVELS_MAX];
  int levels;
  int64_t tests;      /* nodes and gates compared with entry gates */
  int64_t tests_left; /* tests that may follow; below 0: no entry waits any longer */
  int64_t ring_tests; /* tests_left that a ring across gaps costs */
} stratus_gates;

/* A point of `seen`: relative to the eye, or with z along parallel rays. */
typedef struct stratus_view_point {
  double x, y, z;
} stratus_view_point;

static inline uint32_t stratus_gate_cell(const stratus_gates* gates, int64_t gate)
{
  return gates->faces[gate] / 4;
}

/* The corners of a gate's face, as they are seen. */
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
#define STRATUS_GATE_IN 0x80u  /* in `waiting`: some gate of the cell is an entry */
#define STRATUS_GATE_OUT 0x40u /* some gate of the cell is an exit */

/* Begins a leaf in a view whose signs are known, and marks cells in `waiting` by their gates. */
void stratus_gates_open(stratus_gates* gates, stratus_visibility_order* order, int32_t leaf);
/* A cell that is not listed yet and has to come, across a gap, before this cell marked STRATUS_GATE_IN; STRATUS_NO_CELL: none. */
uint32_t stratus_gates_before(stratus_gates* gates, uint32_t cell);
/* Drop the relations by which the cell's entry gates wait for `before`. Return true if there were any. */
bool stratus_gates_cut(stratus_gates* gates, uint32_t cell, uint32_t before);
/* Notes that a cell marked STRATUS_GATE_OUT is listed. */
void stratus_gates_pass(stratus_gates* gates, uint32_t cell);

/* ---- visibility_gate_cover.c */

/* Whether gate a hides gate b: their faces overlap in the view, and a's is nearer in the middle of the overlap. */
bool stratus_gate_lies_before(const stratus_gates* gates, int64_t a, int64_t b);

/* ---- visibility_gate_tree.c: a tree over ways out by their place in the view */

/* Sets a gate's sides and box. */
void stratus_gate_see(const stratus_gates* gates, stratus_gate* gate, const stratus_view_point points[3]);
/* Builds the nodes over all gates, after stratus_gate_see() of each that is not edge-on. */
void stratus_gates_build_tree(stratus_gates* gates);
/* Return an exit that hides the entry and belongs to another cell that is not listed yet; -1: none. */
int64_t stratus_gates_search(stratus_gates* gates, int64_t way_in);
void stratus_gates_take_from_tree(stratus_gates* gates, int64_t way_out);

/* ---- visibility_signs.c: finds all cells' state, and relations_changed. Returns how many signs needed exact arithmetic. */
int64_t stratus_order_find_signs(stratus_visibility_order* order, const stratus_view* view);
/* Make only `seen`. */
void stratus_order_see_points(stratus_visibility_order* order, const stratus_view* view);
/* The exact sign of face_determinants() for a face. */
int stratus_order_exact_sign(const stratus_visibility_order* order, const stratus_view* view, uint32_t cell, int face);
/* How far away a cell's middle is, in a unit of the view. */
float stratus_order_key(const stratus_visibility_order* order, uint32_t cell);
/* How large a cell's face is seen, in a unit of the view. */
double stratus_order_face_size(const stratus_visibility_order* order, uint32_t cell, int face);

/* ---- visibility_signs_device.c: stratus_order_find_signs() on the context's device, the same to the bit. */
typedef struct stratus_device_signs stratus_device_signs;

/* Whether the device should find the signs: it is a GPU with doubles and enough memory, and the cells are many enough to pay. */
bool stratus_order_signs_on_device(const stratus_visibility_order* order);
stratus_status stratus_order_find_signs_on_device(stratus_visibility_order* order, const stratus_view* view, int64_t* exact);
void stratus_device_signs_destroy(stratus_context* context, stratus_device_signs* signs); /* takes NULL */

/* Peeling writes one leaf's cells into order->cells. seeds: room for the leaf's seeds. */
typedef struct stratus_peel_counts {
  int layers;
  int64_t cycles, forced, overlaps, gate_tests;
} stratus_peel_counts;

/* ---- visibility_nearest.c */
stratus_peel_counts stratus_order_leaf_nearest(stratus_visibility_order* order, int32_t leaf, stratus_order_seed* seeds);

/* ---- visibility_layers.c */
stratus_peel_counts stratus_order_leaf_layers(stratus_visibility_order* order, int32_t leaf, stratus_order_seed* seeds);

/* ---- visibility_layers_device.c: all leaves' layers on the context's device, as by stratus_order_leaf_layers(). */
typedef struct stratus_device_layers stratus_device_layers;

/* Whether the device builds, the cells are many, and they fit. */
bool stratus_order_layers_on_device(const stratus_visibility_order* order);
/* Sets peeled[leaf] for each leaf, and writes the cells of those that it has peeled; a leaf with rings is left to the host. layers: of the
 * leaf with most so far. */
stratus_status stratus_order_peel_layers_on_device(stratus_visibility_order* order, uint8_t* peeled, int* layers);
void stratus_device_layers_destroy(stratus_context* context, stratus_device_layers* layers); /* takes NULL */

/* ---- visibility_peeling.c */

/* Drops a relation, on both sides of the face: the neighbour need no longer come before the cell. */
void stratus_order_cut(stratus_visibility_order* order, uint32_t cell, int face);

/* Seeds of a leaf with so many cells. */
static inline int64_t stratus_order_seed_count(int64_t cells)
{
  return (cells + STRATUS_SEED_CELLS - 1) / STRATUS_SEED_CELLS;
}

/* Fill `seeds` with a leaf's seeds, nearest first. */
void stratus_order_sort_seeds(const stratus_visibility_order* order, int32_t leaf, stratus_order_seed* seeds);

#endif
