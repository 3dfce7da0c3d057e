/* SPDX-License-Identifier: BSD-3-Clause
 * What the files of the octree share: lists of boxes in packs, levels as arrays, and how a node's children are found by counting. */
#ifndef STRATUS_OCTREE_H
#define STRATUS_OCTREE_H

#include "frustum.h"

#define STRATUS_PACK 16        /* boxes that are tested at once */
#define STRATUS_PACK_FLOATS 96 /* rows of 16: least x, y, z, greatest x, y, z */

/* Boxes of a node, in one allocation: packs, then ids, then a byte a pack: the plane that last rejected it whole. Boxes are relative to the
 * tree's origin, in floats rounded outward. */
typedef struct stratus_octree_list {
  float* boxes; /* NULL: packs is 0 */
  uint32_t count;
  uint32_t packs; /* that there is room for */
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

/* Nodes of one level in Morton order, eight a group; level 0 has one group, and only its first node. */
typedef struct stratus_octree_level {
  stratus_octree_list* nodes;
  uint8_t* split; /* a bit a node, a byte a group */
  uint8_t* stuck; /* the same: a split would not part what it holds */
  uint32_t* rank; /* split nodes in the groups before */
  uint32_t* used; /* clock when a border last crossed the group's parent */
  size_t groups, capacity;
} stratus_octree_level;

enum { STRATUS_OBJECT_FREE, STRATUS_OBJECT_BOX, STRATUS_OBJECT_TURNED, STRATUS_OBJECT_UNBOUNDED };

struct stratus_octree {
  stratus_context* context;
  stratus_octree_options options;
  double pad; /* of a node on each side, in its own widths: (looseness - 1) / 2 */
  /* objects by id */
  double (*bounds)[6];
  double (*turned)[12]; /* NULL until there is one */
  uint32_t* slot;       /* place in its node's list (touching: in one of them, a guess); of a free id: the next free one */
  uint8_t* kind;
  size_t capacity, limit, count, unbounded_count;
  uint32_t free_head; /* UINT32_MAX: none */
  stratus_octree_list unbounded;
  /* the tree */
  stratus_octree_level levels[STRATUS_OCTREE_LEVELS_MAX + 1];
  int depth;
  bool rooted;      /* the root has a cell */
  double origin[3]; /* world */
  double corner[3]; /* of the root's cell, relative to origin, a multiple of edge / 1024 when it was made */
  double edge;      /* a power of two */
  double first_edge;
  double reach;   /* no relative coordinate was ever larger */
  double hull[6]; /* world: holds every bounded object that there is (and some that were) */
  bool has_origin, changed;
  uint32_t clock;
  uint8_t* octants; /* scratch of splits */
  size_t octants_capacity;
  stratus_octree_view* walker; /* of queries */
};

/* A node and its cell; x, y, z count cells of its level from the root's corner. */
typedef struct stratus_octree_place {
  uint32_t node;
  uint32_t x, y, z;
  uint32_t mask; /* planes that cross it; 0: seen whole */
} stratus_octree_place;

/* The parts of a frustum that packs and nodes are tested against, relative to the tree's origin. */
typedef struct stratus_octree_planes {
  float normal[STRATUS_PLANES][3], offset[STRATUS_PLANES];
  float band[STRATUS_PLANES]; /* nearer to the plane than this, floats don't tell */
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

/* Least corner of a cell, relative to the origin. Exact. */
static inline void stratus_octree_cell_corner(const stratus_octree* tree, int level, const stratus_octree_place* place, double corner[3])
{
  const double size = stratus_octree_cell_size(tree, level);
  corner[0] = tree->corner[0] + size * place->x;
  corner[1] = tree->corner[1] + size * place->y;
  corner[2] = tree->corner[2] + size * place->z;
}

/* ---- octree_objects.c */
#define STRATUS_NO_ID UINT32_MAX
stratus_status stratus_octree_check_ids(const stratus_octree* tree, const uint32_t* ids, size_t count); /* all in use */

/* ---- octree_lists.c */
stratus_status stratus_list_allocate(stratus_context* context, size_t count, stratus_octree_list* list); /* empty, room for count */
void stratus_list_release(stratus_context* context, stratus_octree_list* list);
/* Room for so many in all. */
stratus_status stratus_list_reserve(stratus_context* context, stratus_octree_list* list, size_t needed);
/* Sets *slot. Grows by half where there is no room. */
stratus_status stratus_list_append(stratus_context* context, stratus_octree_list* list, const float box[6], uint32_t id, uint32_t* slot);
/* Before the first box of a pack is set: the lanes behind the last one are tested, too, and their answer is dropped. */
void stratus_list_clear_rest(const stratus_octree_list* list, uint32_t slot);
void stratus_list_set(const stratus_octree_list* list, uint32_t slot, const float box[6]);
void stratus_list_get(const stratus_octree_list* list, uint32_t slot, float box[6]);
/* Where id is; UINT32_MAX: it is not. guess: tried first. */
uint32_t stratus_list_find(const stratus_octree_list* list, uint32_t id, uint32_t guess);
/* The last takes its place; slots: of objects by id. */
void stratus_list_remove(stratus_octree_list* list, uint32_t slot, uint32_t* slots);
size_t stratus_list_bytes(const stratus_octree_list* list);
/* Room for `needed`, `used` kept; grows by half at least. */
stratus_status stratus_octree_reserve(stratus_context* context, void** memory, size_t* capacity, size_t needed, size_t used, size_t size);

/* ---- octree_levels.c */
stratus_status stratus_octree_levels_create(stratus_octree* tree); /* an unsplit root */
void stratus_octree_levels_release(stratus_octree* tree);
/* Gives a root that has none a cell, if it holds enough to be split. May move the tree's origin. */
void stratus_octree_make_root(stratus_octree* tree);
/* Room for `needed` groups, cleared. */
stratus_status stratus_octree_reserve_groups(stratus_context* context, stratus_octree_level* level, size_t needed);
void stratus_octree_count_splits(stratus_octree_level* level); /* into rank[] */

/* Every split node of `level` whose children are not split and were last used more than `age` calls ago is whole again. age < 0: all of
 * them. */
stratus_status stratus_octree_collapse(stratus_octree* tree, int level, int64_t age, uint64_t* collapses);
/* The root's cell holds the box, or the tree is flat. */
stratus_status stratus_octree_grow(stratus_octree* tree, const float box[6]);

/* ---- octree_split.c */
/* Splits nodes of one level, places in rising order of node; those that cannot be parted are marked as stuck. All or none. */
stratus_status stratus_octree_split(
  stratus_octree* tree, int level, const stratus_octree_place* places, size_t count, uint64_t* splits, uint64_t* handed_down);

/* ---- octree_place.c */
/* World bounds to the list's box; false: none that a float holds. */
void stratus_octree_relative(const stratus_octree* tree, const double bounds[6], float box[6]);
/* What must lie in the root's cell: the box, or a cube about its sphere. */
void stratus_octree_extent(const stratus_octree* tree, const float box[6], double lo[3], double hi[3]);
bool stratus_octree_root_holds(const stratus_octree* tree, const float box[6]);
/* Enclosing: octant of the child that holds the box, 8 if none does. Touching: a bit for each octant that the sphere touches. */
unsigned stratus_octree_octants(const stratus_octree* tree, const double corner[3], double size, const float box[6]);
/* Does `visit` for each node whose list holds (or is to hold) the box. Stops at the first status that is not OK. */
typedef stratus_status (*stratus_octree_visit)(stratus_octree* tree, int level, size_t node, void* user);
stratus_status stratus_octree_visit_places(stratus_octree* tree, const float box[6], stratus_octree_visit visit, void* user);

/* ---- octree_pack.c */
void stratus_octree_planes_prepare(const stratus_octree* tree, const stratus_frustum_plan* plan, stratus_octree_planes* planes);
/* Sixteen boxes a pack against the planes of `mask`. keep: bits of those not surely outside; unsure: of those among them that doubles must
 * decide. turned: the boxes may stand about smaller things: unsure are all that a plane crosses. */
void stratus_octree_test_packs(const stratus_octree_planes* planes, unsigned mask, int turned, const float* boxes, uint8_t* hints,
  size_t packs, uint16_t* keep, uint16_t* unsure);
/* Eight children of the cell with this centre and half width `quarter` each (times `looseness`): masks[o] the planes that cross child o,
 * 0x80 if it is outside. */
void stratus_octree_test_children(
  const stratus_octree_planes* planes, unsigned mask, const double center[3], double quarter, double looseness, uint8_t masks[8]);

/* ---- octree_walk.c */

/* A piece of a list that a walk came to: at most STRATUS_JOB_PACKS packs. */
typedef struct stratus_octree_job {
  const float* boxes;
  const uint32_t* ids;
  uint8_t* hints;
  uint32_t count; /* boxes */
  uint32_t mask;  /* planes to test; 0: all are seen */
  uint32_t kept;  /* found later */
  size_t first;   /* of its packs among all jobs' */
} stratus_octree_job;

#define STRATUS_JOB_PACKS 256

struct stratus_octree_view {
  stratus_octree* tree;
  uint32_t* ids;
  float *coverage, *depth;
  size_t ids_capacity, coverage_capacity, depth_capacity;
  uint32_t* stamps; /* touching: by id, of the last call that told it */
  size_t stamps_capacity;
  uint32_t stamp;
  stratus_octree_place *places[2], *batch;
  size_t places_capacity[2], batch_capacity;
  stratus_octree_job* jobs;
  size_t jobs_capacity, job_count;
  uint16_t *keep, *unsure; /* of each pack of the jobs */
  size_t keep_capacity, unsure_capacity, packs;
};

/* What is looked for, and how far it is refined. */
typedef struct stratus_octree_walk {
  const void* self;
  unsigned mask; /* planes that may cut; 0: all is seen */
  /* Of the eight children about this centre, of half width `quarter` each: the planes that cross it, 0 if it is seen whole, 0x80 if not at
   * all. */
  void (*children)(const stratus_octree* tree, const void* self, unsigned mask, const double center[3], double quarter, uint8_t masks[8]);
  /* The stop rule: true if a node that is seen in part is to be split. Its count, level and depth have been looked at. */
  bool (*divides)(const stratus_octree* tree, const void* self, int level, const stratus_octree_place* place);
  bool boxes_stick_out;                       /* of nodes: what crosses a box is not what crosses its node */
  bool test_whole;                            /* boxes in a node that is seen whole may not be */
  int64_t budget;                             /* objects to hand down */
  uint64_t nodes_tested, splits, handed_down; /* out */
} stratus_octree_walk;

/* Leaves the jobs in the view. */
stratus_status stratus_octree_walk_nodes(stratus_octree_view* view, stratus_octree_walk* walk);
/* Splits whatever has more than leaf_objects, down to the last level. */
stratus_status stratus_octree_split_all(stratus_octree_view* view, uint64_t* splits, uint64_t* handed_down);
stratus_status stratus_octree_view_reserve_stamps(stratus_octree_view* view);

#endif
