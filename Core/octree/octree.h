/* SPDX-License-Identifier: BSD-3-Clause
 * Types that the octree's files share: packed lists of boxes, and levels stored as arrays, where counting split nodes finds a node's
 * children. */
#ifndef STRATUS_OCTREE_H
#define STRATUS_OCTREE_H

#include "frustum.h"

#define STRATUS_PACK 16        /* boxes in one pack, tested at once */
#define STRATUS_PACK_FLOATS 96 /* six rows of 16: least x, y, z, greatest x, y, z */

/* Boxes of a node. One allocation holds the packs, then the ids, then one byte for each pack, its hint: the plane that last rejected the
 * whole pack. Boxes are relative to the tree's origin, in floats rounded outward. */
typedef struct stratus_octree_list {
  float* boxes; /* NULL if packs is 0 */
  uint32_t count;
  uint32_t packs; /* capacity of the list */
} stratus_octree_list;

static inline uint32_t* stratus_list_ids(const stratus_octree_list* list)
{
  return (uint32_t*)(list->boxes + (size_t)list->packs * STRATUS_PACK_FLOATS);
}

static inline uint8_t* stratus_list_hints(const stratus_octree_list* list)
{
  return (uint8_t*)(stratus_list_ids(list) + (size_t)list->packs * STRATUS_PACK);
}

static inline float* stratus_list_box(const stratus_octree_list* list, uint32_t slot)
{
  return list->boxes + (size_t)(slot / STRATUS_PACK) * STRATUS_PACK_FLOATS + slot % STRATUS_PACK;
}

/* Nodes of one level in Morton order, in groups of eight siblings. Level 0 has one group and uses only its first node. */
typedef struct stratus_octree_level {
  stratus_octree_list* nodes;
  uint8_t* split; /* a bit for each node, a byte for each group: the node has children */
  uint8_t* stuck; /* same layout: a split would not separate the node's objects */
  uint32_t* rank; /* number of split nodes in all groups before */
  uint32_t* used; /* clock of the last call whose border crossed the group's parent */
  size_t groups, capacity;
} stratus_octree_level;

enum { STRATUS_OBJECT_FREE, STRATUS_OBJECT_BOX, STRATUS_OBJECT_TURNED, STRATUS_OBJECT_UNBOUNDED };

struct stratus_octree {
  stratus_context* context;
  stratus_octree_options options;
  double pad; /* widening of a node on each side, in units of its width: (looseness - 1) / 2 */
  /* objects, indexed by id */
  double (*bounds)[6];
  double (*turned)[12]; /* NULL until the first turned box */
  uint32_t* slot;       /* index in its node's list; touching: a guess, in one of the lists; free id: the next free id */
  uint8_t* kind;
  size_t capacity, limit, count, unbounded_count;
  uint32_t free_head; /* UINT32_MAX if no id is free */
  stratus_octree_list unbounded;
  /* the tree */
  stratus_octree_level levels[STRATUS_OCTREE_LEVELS_MAX + 1];
  int depth;
  bool rooted;      /* the root has a cell */
  double origin[3]; /* of the list's boxes, in world coordinates */
  double corner[3]; /* of the root's cell, relative to origin: a multiple of first_edge / 1024 */
  double edge;      /* width of the root's cell: a power of two */
  double first_edge;
  double reach;   /* largest magnitude that a relative coordinate has had */
  double hull[6]; /* world bounds of all bounded objects, those removed since included */
  bool has_origin, changed;
  uint32_t clock;
  stratus_octree_view* walker; /* view that the queries use */
};

/* A node and its cell. x, y and z count cells of the node's level from the root's corner. */
typedef struct stratus_octree_place {
  uint32_t node;
  uint32_t x, y, z;
  uint32_t mask; /* planes that cross the cell; 0: the cell lies inside all of them */
} stratus_octree_place;

/* A frustum's planes relative to the tree's origin: in floats for packs, in doubles (`wide`) for nodes. */
typedef struct stratus_octree_planes {
  float normal[STRATUS_PLANES][3], offset[STRATUS_PLANES];
  float band[STRATUS_PLANES]; /* nearer to 0 than this, floats cannot decide the side of a value */
  double wide[STRATUS_PLANES][4];
} stratus_octree_planes;

static inline size_t stratus_octree_child_group(const stratus_octree_level* level, size_t node)
{
  return level->rank[node >> 3] + (size_t)__builtin_popcount(level->split[node >> 3] & ((1u << (node & 7)) - 1u));
}

static inline bool stratus_octree_is_split(const stratus_octree_level* level, size_t node)
{
  return level->split[node >> 3] >> (node & 7) & 1;
}

static inline double stratus_octree_cell_size(const stratus_octree* tree, int level)
{
  return ldexp(tree->edge, -level);
}

static inline stratus_octree_place stratus_octree_child(const stratus_octree_place* parent, size_t group, unsigned octant)
{
  return (stratus_octree_place){ (uint32_t)(8 * group + octant), 2 * parent->x + (octant & 1), 2 * parent->y + (octant >> 1 & 1),
    2 * parent->z + (octant >> 2), 0 };
}

/* Least corner of a cell, relative to the origin. The result is exact. */
static inline void stratus_octree_cell_corner(const stratus_octree* tree, int level, const stratus_octree_place* place, double corner[3])
{
  const double size = stratus_octree_cell_size(tree, level);
  corner[0] = tree->corner[0] + size * place->x;
  corner[1] = tree->corner[1] + size * place->y;
  corner[2] = tree->corner[2] + size * place->z;
}

/* ---- octree_objects.c */
#define STRATUS_NO_ID UINT32_MAX
/* Fails unless all ids are in use. */
stratus_status stratus_octree_check_ids(const stratus_octree* tree, const uint32_t* ids, size_t count);

/* ---- octree_lists.c */
/* Creates an empty list with room for `count` boxes. */
stratus_status stratus_list_allocate(stratus_context* context, size_t count, stratus_octree_list* list);
void stratus_list_release(stratus_context* context, stratus_octree_list* list);
/* Gives the list room for `needed` boxes in all. */
stratus_status stratus_list_reserve(stratus_context* context, stratus_octree_list* list, size_t needed);
/* Sets *slot. A full list grows by half. */
stratus_status stratus_list_append(stratus_context* context, stratus_octree_list* list, const float box[6], uint32_t id, uint32_t* slot);
/* Zeroes the pack whose first lane is `slot`; other slots leave it as it is. Tests read all 16 lanes, so that unused lanes need numbers. */
void stratus_list_clear_rest(const stratus_octree_list* list, uint32_t slot);
void stratus_list_set(const stratus_octree_list* list, uint32_t slot, const float box[6]);
void stratus_list_get(const stratus_octree_list* list, uint32_t slot, float box[6]);
/* Slot of id, or UINT32_MAX if the list does not hold it. The slot `guess` is tried first. */
uint32_t stratus_list_find(const stratus_octree_list* list, uint32_t id, uint32_t guess);
/* The list's last box moves to the freed slot. `slots`, indexed by id, is updated. */
void stratus_list_remove(stratus_octree_list* list, uint32_t slot, uint32_t* slots);
size_t stratus_list_bytes(const stratus_octree_list* list);
/* Gives an array room for `needed` items and keeps the first `used`. The capacity grows by half at least. */
stratus_status stratus_octree_reserve(stratus_context* context, void** memory, size_t* capacity, size_t needed, size_t used, size_t size);

/* ---- octree_levels.c */
stratus_status stratus_octree_levels_create(stratus_octree* tree); /* creates a root that is not split */
void stratus_octree_levels_release(stratus_octree* tree);
/* Fits a cell to a root that has none, if its list is long enough to be split. The tree's origin may move. */
void stratus_octree_make_root(stratus_octree* tree);
/* Gives the level room for `needed` groups; new ones are zeroed. */
stratus_status stratus_octree_reserve_groups(stratus_context* context, stratus_octree_level* level, size_t needed);
void stratus_octree_count_splits(stratus_octree_level* level); /* fills rank[] */

/* Merges each split node of `level` with its children if none of these is split and no border has crossed the node for more than `age`
 * calls. age < 0: merges whatever its age. */
stratus_status stratus_octree_collapse(stratus_octree* tree, int level, int64_t age, uint64_t* collapses);
/* Doubles the root until its cell holds the box. Beyond a limit of growth the tree becomes a flat list instead. */
stratus_status stratus_octree_grow(stratus_octree* tree, const float box[6]);

/* ---- octree_split.c */
/* Splits nodes of one level, given in rising order of node. A node whose objects a split would not separate is marked as stuck instead. Out
 * of memory: no node is split. */
stratus_status stratus_octree_split(
  stratus_octree* tree, int level, const stratus_octree_place* places, size_t count, uint64_t* splits, uint64_t* handed_down);

/* ---- octree_place.c */
/* Converts world bounds to a list's box. */
void stratus_octree_relative(const stratus_octree* tree, const double bounds[6], float box[6]);
/* Part of space that the root's cell must hold: the box itself, or, for touching placement, a cube about the box's bounding sphere. */
void stratus_octree_extent(const stratus_octree* tree, const float box[6], double lo[3], double hi[3]);
bool stratus_octree_root_holds(const stratus_octree* tree, const float box[6]);
/* Enclosing: the octant of the child that holds the box, or 8 if none does. Touching: a bit for each octant that the box's sphere
 * touches. */
unsigned stratus_octree_octants(const stratus_octree* tree, const double corner[3], double size, const float box[6]);
/* Calls `visit` for each node in whose list the box belongs. The first status that is not STRATUS_OK ends the walk. */
typedef stratus_status (*stratus_octree_visit)(stratus_octree* tree, int level, size_t node, void* user);
stratus_status stratus_octree_visit_places(stratus_octree* tree, const float box[6], stratus_octree_visit visit, void* user);

/* ---- octree_pack.c */
void stratus_octree_planes_prepare(const stratus_octree* tree, const stratus_frustum_plan* plan, stratus_octree_planes* planes);
/* Tests packs of sixteen boxes against the planes of `mask`. keep[i] has a bit for each box of pack i that is not certainly outside.
 * unsure[i] has a bit for each kept box that needs a test in double precision. turned: boxes may only bound their objects, so each box that
 * a plane crosses is unsure. */
void stratus_octree_test_packs(const stratus_octree_planes* planes, unsigned mask, int turned, const float* boxes, uint8_t* hints,
  size_t packs, uint16_t* keep, uint16_t* unsure);
/* Tests the eight children of the cell with this centre. Each child has the half width `quarter`, times `looseness`. masks[o] has a bit for
 * each plane that crosses child o, and 0x80 if the child is outside. */
void stratus_octree_test_children(
  const stratus_octree_planes* planes, unsigned mask, const double center[3], double quarter, double looseness, uint8_t masks[8]);

/* ---- octree_walk.c */

/* A part of the list of a node that the walk reached: at most STRATUS_JOB_PACKS packs. */
typedef struct stratus_octree_job {
  const float* boxes;
  const uint32_t* ids;
  uint8_t* hints;
  uint32_t count; /* number of boxes */
  uint32_t mask;  /* planes to test; 0: all boxes are seen */
  uint32_t kept;  /* number of boxes seen, filled in by the test */
  size_t first;   /* index of its first pack among the packs of all jobs */
} stratus_octree_job;

#define STRATUS_JOB_PACKS 256

struct stratus_octree_view {
  stratus_octree* tree;
  uint32_t* ids;
  float *coverage, *depth;
  size_t ids_capacity, coverage_capacity, depth_capacity;
  uint32_t* stamps; /* touching: stamp of the last call that reported the object, by id */
  size_t stamps_capacity;
  uint32_t stamp;
  stratus_octree_place *places[2], *batch;
  size_t places_capacity[2], batch_capacity;
  stratus_octree_job* jobs;
  size_t jobs_capacity, job_count;
  uint16_t *keep, *unsure; /* one word for each pack of the jobs */
  size_t keep_capacity, unsure_capacity, packs;
};

/* One walk through the tree: its callbacks, which say what it looks for and how far it refines, and its counters. */
typedef struct stratus_octree_walk {
  const void* self;
  unsigned mask; /* planes that may cut; 0: everything is seen */
  /* Tests the eight children about this centre, each of half width `quarter`. masks[o]: planes that cross child o, 0 if it is wholly
   * inside, 0x80 if it is outside. */
  void (*children)(const stratus_octree* tree, const void* self, unsigned mask, const double center[3], double quarter, uint8_t masks[8]);
  /* The stop rule: true if a node that is partly inside shall be split. The walk has already checked its count, level and depth. */
  bool (*divides)(const stratus_octree* tree, const void* self, int level, const stratus_octree_place* place);
  bool boxes_stick_out;                       /* boxes may reach beyond their node, so that its mask does not hold for them */
  bool test_whole;                            /* even boxes of a node that is wholly inside are tested */
  int64_t budget;                             /* objects that splits may still hand down */
  uint64_t nodes_tested, splits, handed_down; /* results */
} stratus_octree_walk;

/* Fills the view's jobs. */
stratus_status stratus_octree_walk_nodes(stratus_octree_view* view, stratus_octree_walk* walk);
/* Splits every node that holds more than leaf_objects, down to the last level. */
stratus_status stratus_octree_split_all(stratus_octree_view* view, uint64_t* splits, uint64_t* handed_down);
stratus_status stratus_octree_view_reserve_stamps(stratus_octree_view* view);

/* ---- octree_nodes.c */
/* Checks that every object is listed once in each node where its placement puts it, and that all counts are right. Otherwise returns
 * STRATUS_INVALID_ARGUMENT, with the error in the message. */
stratus_status stratus_octree_check(const stratus_octree* octree);

#endif
