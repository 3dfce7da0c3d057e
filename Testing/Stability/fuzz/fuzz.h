/* SPDX-License-Identifier: BSD-3-Clause
 * What the kinds of fuzzing share: numbers from a seed, buffers that end where memory ends, calls that are counted and watched, findings.
 * A case is all that happens for one (kind, seed, number); it depends on nothing else, so any one can be had again. */
#ifndef STRATUS_FUZZ_H
#define STRATUS_FUZZ_H

#include "stratus.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#define FUZZ_STATUSES 8

/* Of one kind, in memory that the supervising process shares: it outlives a case that crashes. */
typedef struct fuzz_tally {
  uint64_t number;  /* of the case under way */
  const char* call; /* the call under way, or the last one */
  bool told;        /* what is wrong has been printed */
  char about[512];  /* of the case: what a reader of a finding asks first, .. */
  char odd[256];    /* .. and its odd numbers so far */
  /* Sums; from here on nothing but uint64_t. */
  uint64_t cases, calls, pictures;
  uint64_t objects;                   /* ranges, maps, voxels, fields, trees, octrees, partitions, orders, casters */
  uint64_t byte_strings;              /* saved trees that were changed and offered */
  uint64_t compared;                  /* answers held against those of another way, or of a second time */
  uint64_t buffers;                   /* at a guard page */
  uint64_t refused_memory, cancelled; /* on purpose */
  uint64_t statuses[FUZZ_STATUSES];
  uint64_t findings;
} fuzz_tally;

/* The memory that a context lives on. */
typedef struct fuzz_memory {
  int64_t calls, live;
  int64_t fail_at; /* the call that is refused, counted from 1; 0: none */
  int fill;        /* what new memory is filled with: nothing may depend on it */
  bool guarded;    /* each allocation ends within 64 bytes of a guard page */
  bool damaged;    /* somebody wrote behind an allocation */
  uint64_t refused;
} fuzz_memory;

typedef struct fuzz_progress {
  int64_t calls, cancel_at; /* as in fuzz_memory */
  bool wrong;               /* no stage, or a fraction outside 0..1; no line to log */
  uint64_t cancelled;
} fuzz_progress;

typedef struct fuzz_block {
  unsigned char *base, *data;
  size_t total, bytes;
  bool input;
} fuzz_block;

typedef struct fuzz {
  const char* kind;
  const char* program;
  const char* device; /* of the contexts */
  uint64_t seed, number, random;
  fuzz_tally* tally;
  bool here; /* no supervisor: a finding aborts */
  /* Of 10000 fields so many get an odd value (NULL, zero, negative, huge, no number, out of range), and the field odd_at does. */
  int oddness, odd_at, fields;
  fuzz_block* blocks;
  size_t block_count, block_room;
  fuzz_memory memory;
  fuzz_progress progress;
  stratus_context* context;
} fuzz;

/* ---- fuzz_random.c */
uint64_t fuzz_next(fuzz* f);
uint64_t fuzz_below(fuzz* f, uint64_t count); /* 0..count-1 */
double fuzz_unit(fuzz* f);                    /* [0, 1) */
double fuzz_between(fuzz* f, double low, double high);
double fuzz_scale(fuzz* f, double low, double high); /* logarithmically even */
bool fuzz_chance(fuzz* f, double chance);
/* Asked once a field: whether this one is to be odd. False throughout most cases. */
bool fuzz_odd(fuzz* f);
bool fuzz_is_tame(const fuzz* f); /* no field of this case is odd: what is made is valid */
double fuzz_odd_real(fuzz* f);
int64_t fuzz_odd_integer(fuzz* f);
/* Fields: mostly within the range, at times odd. */
double fuzz_real(fuzz* f, double low, double high);
int fuzz_integer(fuzz* f, int low, int high);
int fuzz_choice(fuzz* f, int count); /* an enum's value */
int fuzz_flag(fuzz* f);
void fuzz_vector(fuzz* f, double low, double high, double v[3]);
const void* fuzz_pointer(fuzz* f, const void* pointer); /* at times NULL */

/* ---- fuzz_memory.c */
/* `bytes` bytes that end at a guard page, or begin behind one, filled with what no output may keep. Live until the case ends. */
void* fuzz_output(fuzz* f, size_t bytes);
/* The same with a copy of `data` that nobody can write to. */
const void* fuzz_input(fuzz* f, const void* data, size_t bytes);
#define FUZZ_INPUT(f, object) fuzz_input((f), &(object), sizeof(object))
/* New bytes in an input, as a caller may who raises its revision. */
void fuzz_change(fuzz* f, const void* input, const void* data);
void fuzz_free_blocks(fuzz* f); /* a finding if anything was written beside a buffer */
stratus_context_options fuzz_context_options(fuzz* f, fuzz_memory* memory);
/* A context of its own, or the process ends with a finding. */
stratus_context* fuzz_context(fuzz* f, fuzz_memory* memory);
void fuzz_context_close(fuzz* f, stratus_context* context, fuzz_memory* memory);

/* ---- fuzz_case.c */
void fuzz_call_begins(fuzz* f, const char* call);
stratus_status fuzz_call_ended(fuzz* f, const stratus_context* context, stratus_status status);
/* A call without a status; and one with, on f->context or another: counted, watched, its message looked at. */
#define CALL(call) (fuzz_call_begins(f, #call), (call))
#define STATUS_OF(context, call) fuzz_call_ended(f, (context), (fuzz_call_begins(f, #call), (call)))
#define STATUS(call) STATUS_OF(f->context, call)
/* Prints what is wrong with how to have it again, and ends the process. */
void fuzz_finding(fuzz* f, const char* format, ...) __attribute__((format(printf, 2, 3), noreturn));
#define EXPECT(condition, ...)                                                                                                             \
  do {                                                                                                                                     \
    if (!(condition)) {                                                                                                                    \
      fuzz_finding(f, __VA_ARGS__);                                                                                                        \
    }                                                                                                                                      \
  } while (0)
/* What findings of this case tell of it; an odd number more of it. */
void fuzz_note(fuzz* f, double number);
void fuzz_about(fuzz* f, const char* format, ...) __attribute__((format(printf, 2, 3)));
/* A call that makes an object at `place`, at times NULL: failed, it leaves the place as it was. */
#define CREATE(place, call) fuzz_created(f, (place), (fuzz_create_begins(f, (place)), STATUS(call)))
void fuzz_create_begins(fuzz* f, void* place);
stratus_status fuzz_created(fuzz* f, void* place, stratus_status status);
/* The next calls may be refused memory, or be cancelled, at some point. Until fuzz_calm(). */
void fuzz_trouble(fuzz* f);
void fuzz_calm(fuzz* f);
void fuzz_run_case(fuzz* f, uint64_t number);

typedef struct fuzz_kind {
  const char* name;
  void (*run)(fuzz* f);
} fuzz_kind;

extern const fuzz_kind fuzz_kinds[];
extern const int fuzz_kind_count;

/* ---- fuzz_volumes.c */
typedef struct fuzz_field {
  stratus_volume view;
  size_t values;         /* places in the grid */
  size_t bytes;          /* of view.values */
  double low, high;      /* about the range of the values */
  double edge, shortest; /* a voxel's longest and shortest, in the world */
  double bounds[6];      /* of the world, 0..1 along each axis where the view is refused */
} fuzz_field;

fuzz_field fuzz_volume(fuzz* f, int largest, int components);
fuzz_field fuzz_row(fuzz* f, int64_t count);          /* values alone */
void fuzz_volume_changes(fuzz* f, fuzz_field* field); /* other values at the same place, the revision raised */
void fuzz_row_changes(fuzz* f, fuzz_field* row);
stratus_transfer fuzz_transfer(fuzz* f, double low, double high, double edge);
/* `count` of them, an array at a guard page. */
const stratus_transfer* fuzz_transfers(fuzz* f, int count, bool labels, double low, double high, double edge);
void fuzz_matrix(fuzz* f, double matrix[16]);
stratus_camera fuzz_camera(fuzz* f, const double bounds[6]);
/* A picture of the size to draw into, all of its buffers at guard pages, none of which keeps what it holds. */
stratus_image fuzz_image(fuzz* f, int width, int height, const stratus_camera* camera);
stratus_image fuzz_image_like(fuzz* f, const stratus_image* image); /* the same size and buffers */
typedef struct fuzz_limits {
  bool lit;      /* colours may be brighter than white */
  bool surfaces; /* depth is told wherever anything shows */
  bool behind;   /* parallel rays may begin behind the eye's plane */
} fuzz_limits;
void fuzz_check_image(fuzz* f, const stratus_image* image, fuzz_limits limits);
void fuzz_check_same(fuzz* f, const stratus_image* a, const stratus_image* b, bool samples, const char* what);
double fuzz_value_of(const stratus_volume* volume, size_t index); /* component 0 */

/* ---- fuzz_meshes.c */
typedef struct fuzz_tetrahedra {
  stratus_mesh view;
  fuzz_field row; /* its values */
  double low, high, edge, bounds[6];
  bool sound; /* a lattice whose cells do not overlap */
} fuzz_tetrahedra;

fuzz_tetrahedra fuzz_mesh(fuzz* f, int largest);
void fuzz_mesh_changes(fuzz* f, fuzz_tetrahedra* mesh); /* as fuzz_volume_changes() */

/* ---- fuzz_orders.c */
/* A partition of the mesh: what it says is checked, and is valid until it is destroyed. NULL: refused. */
stratus_partition* fuzz_partition(fuzz* f, const stratus_mesh* mesh, stratus_partition_result* result);

/* ---- one file each */
void fuzz_pictures(fuzz* f);
void fuzz_structures(fuzz* f);
void fuzz_voxels(fuzz* f);
void fuzz_trees(fuzz* f);
void fuzz_octrees(fuzz* f);
void fuzz_orders(fuzz* f);
void fuzz_tetra_pictures(fuzz* f);
void fuzz_contexts(fuzz* f);

#endif
