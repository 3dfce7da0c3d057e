/* SPDX-License-Identifier: BSD-3-Clause
 * Interface that the kinds of fuzzing share: numbers from a seed, buffers at guard pages, calls that are counted and watched, findings. A
 * case is all that happens for one (kind, seed, number). It depends on nothing else, so that each case can be repeated. */
#ifndef STRATUS_FUZZ_H
#define STRATUS_FUZZ_H

#include "stratus.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#define FUZZ_STATUSES 8

/* Record of one kind, in memory that the supervising process shares: it outlives a case that crashes. */
typedef struct fuzz_tally {
  uint64_t number;  /* of the current case */
  const char* call; /* the current call, or the last one */
  bool reported;    /* the finding has been printed */
  char about[512];  /* the case's description, which a finding prints */
  char odd[256];    /* the case's odd numbers so far, which a finding prints */
  /* Counters; all members from here on are uint64_t. */
  uint64_t cases, calls, pictures;
  uint64_t objects;                   /* ranges, maps, voxels, fields, trees, octrees, partitions, orders, casters */
  uint64_t byte_strings;              /* saved trees that were changed and offered */
  uint64_t compared;                  /* results compared with another method's, or with a second run's */
  uint64_t buffers;                   /* buffers at a guard page */
  uint64_t refused_memory, cancelled; /* calls refused memory or cancelled on purpose */
  uint64_t statuses[FUZZ_STATUSES];
  uint64_t findings;
} fuzz_tally;

/* Allocator of a context. */
typedef struct fuzz_memory {
  int64_t calls, live;
  int64_t fail_at; /* number of the request that is refused, from 1; 0: none */
  int fill;        /* value of new memory's bytes, on which no result may depend */
  bool guarded;    /* each allocation ends within 64 bytes of a guard page */
  bool damaged;    /* a byte next to an allocation was overwritten */
  uint64_t refused;
} fuzz_memory;

typedef struct fuzz_progress {
  int64_t calls, cancel_at; /* as in fuzz_memory */
  bool wrong;               /* a call without a stage, with a fraction outside 0..1, or without a line to log */
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
  const char* device; /* device of the contexts */
  uint64_t seed, number, random;
  const unsigned char* bytes; /* `driven`: choices follow from these bytes, two each, and then from the seed */
  size_t bytes_left;
  bool driven; /* by another program, which watches the time, too */
  fuzz_tally* tally;
  bool here; /* 1: there is no supervisor, and a finding aborts */
  /* oddness: of 10000 fields so many get an odd value (NULL, zero, negative, huge, NaN, out of range). odd_at: number of a field that gets
   * one in any case. */
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
double fuzz_scale(fuzz* f, double low, double high); /* evenly distributed in the logarithm */
bool fuzz_chance(fuzz* f, double chance);
/* True if the next field gets an odd value. Called once for each field; false throughout most cases. */
bool fuzz_odd(fuzz* f);
bool fuzz_is_tame(const fuzz* f); /* no field of this case is odd, so that all inputs are valid */
double fuzz_odd_real(fuzz* f);
int64_t fuzz_odd_integer(fuzz* f);
/* Values of fields: mostly within the range, at times odd. */
double fuzz_real(fuzz* f, double low, double high);
int fuzz_integer(fuzz* f, int low, int high);
int fuzz_choice(fuzz* f, int count); /* value of an enum */
int fuzz_flag(fuzz* f);
void fuzz_vector(fuzz* f, double low, double high, double v[3]);
const void* fuzz_pointer(fuzz* f, const void* pointer); /* the pointer, at times NULL */

/* ---- fuzz_memory.c */
/* Buffer of `bytes` bytes that ends at a guard page or begins behind one. It is filled with a value that no output may keep, and lives
 * until the case ends. */
void* fuzz_output(fuzz* f, size_t bytes);
/* The same with a read-only copy of `data`. */
const void* fuzz_input(fuzz* f, const void* data, size_t bytes);
#define FUZZ_INPUT(f, object) fuzz_input((f), &(object), sizeof(object))
/* Writes new bytes to an input, as a caller does before it raises the revision. */
void fuzz_change(fuzz* f, const void* input, const void* data);
void fuzz_free_blocks(fuzz* f); /* a changed byte next to a buffer is a finding */
stratus_context_options fuzz_context_options(fuzz* f, fuzz_memory* memory);
/* Creates a context of its own. A failure ends the process with a finding. */
stratus_context* fuzz_context(fuzz* f, fuzz_memory* memory);
void fuzz_context_close(fuzz* f, stratus_context* context, fuzz_memory* memory);

/* ---- fuzz_case.c */
void fuzz_call_begins(fuzz* f, const char* call);
stratus_status fuzz_call_ended(fuzz* f, const stratus_context* context, stratus_status status);
/* CALL is a call without a status. STATUS_OF and STATUS are calls with one, on f->context or another. All are counted and watched, and
 * their messages are checked. */
#define CALL(call) (fuzz_call_begins(f, #call), (call))
#define STATUS_OF(context, call) fuzz_call_ended(f, (context), (fuzz_call_begins(f, #call), (call)))
#define STATUS(call) STATUS_OF(f->context, call)
/* Prints the finding and the command that repeats it, and ends the process. */
void fuzz_finding(fuzz* f, const char* format, ...) __attribute__((format(printf, 2, 3), noreturn));
#define EXPECT(condition, ...)                                                                                                             \
  do {                                                                                                                                     \
    if (!(condition)) {                                                                                                                    \
      fuzz_finding(f, __VA_ARGS__);                                                                                                        \
    }                                                                                                                                      \
  } while (0)
/* fuzz_note() and fuzz_about() add an odd number and a description, which the case's findings print. */
void fuzz_note(fuzz* f, double number);
void fuzz_about(fuzz* f, const char* format, ...) __attribute__((format(printf, 2, 3)));
/* A call that creates an object at `place`, which is at times NULL. After a failure the place must be unchanged. */
#define CREATE(place, call) fuzz_created(f, (place), (fuzz_create_begins(f, (place)), STATUS(call)))
void fuzz_create_begins(fuzz* f, void* place);
stratus_status fuzz_created(fuzz* f, void* place, stratus_status status);
/* Until fuzz_calm(), the next calls may be refused memory, or be cancelled, at some point. */
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
  size_t values;         /* number of places in the grid */
  size_t bytes;          /* size of view.values */
  double low, high;      /* range of the values, roughly */
  double edge, shortest; /* longest and shortest edge of a voxel in the world */
  double bounds[6];      /* in the world; 0..1 along each axis if the view is refused */
} fuzz_field;

fuzz_field fuzz_volume(fuzz* f, int largest, int components);
fuzz_field fuzz_row(fuzz* f, int64_t count);          /* a field of values only */
void fuzz_volume_changes(fuzz* f, fuzz_field* field); /* writes other values at the same place and raises the revision */
void fuzz_row_changes(fuzz* f, fuzz_field* row);
void fuzz_shading(fuzz* f, const double bounds[6], double edge, stratus_shading* shading); /* lights about a box */
stratus_transfer fuzz_transfer(fuzz* f, double low, double high, double edge);
/* An array of `count` transfer functions at a guard page. */
const stratus_transfer* fuzz_transfers(fuzz* f, int count, double low, double high, double edge);
void fuzz_matrix(fuzz* f, double matrix[16]);
stratus_camera fuzz_camera(fuzz* f, const double bounds[6]);
/* A picture of this size to draw into. All its buffers are at guard pages, and a draw must overwrite them. */
stratus_image fuzz_image(fuzz* f, int width, int height, const stratus_camera* camera);
stratus_image fuzz_image_like(fuzz* f, const stratus_image* image); /* has the same size and buffers */
typedef struct fuzz_limits {
  bool lit;      /* colours may be brighter than white */
  bool surfaces; /* depth is set wherever anything shows */
  bool behind;   /* parallel rays may begin behind the eye's plane */
} fuzz_limits;
void fuzz_check_image(fuzz* f, const stratus_image* image, fuzz_limits limits);
void fuzz_check_same(fuzz* f, const stratus_image* a, const stratus_image* b, bool samples, const char* what);
double fuzz_value_of(const stratus_volume* volume, size_t index); /* value of component 0 */

/* ---- fuzz_meshes.c */
typedef struct fuzz_tetrahedra {
  stratus_mesh view;
  fuzz_field row; /* its values */
  double low, high, edge, bounds[6];
  bool sound; /* true for a lattice whose cells do not overlap */
} fuzz_tetrahedra;

fuzz_tetrahedra fuzz_mesh(fuzz* f, int largest);
void fuzz_mesh_changes(fuzz* f, fuzz_tetrahedra* mesh); /* as fuzz_volume_changes() */

/* ---- fuzz_orders.c */
/* A partition of the mesh, whose result is checked and valid until it is destroyed. NULL: refused. */
stratus_partition* fuzz_partition(fuzz* f, const stratus_mesh* mesh, stratus_partition_result* result);

/* ---- fuzz_pictures.c */
void fuzz_clipping(fuzz* f, stratus_ray_clipping_options* clipping, const fuzz_field* field);

/* ---- one file each */
void fuzz_pictures(fuzz* f);
void fuzz_structures(fuzz* f);
void fuzz_voxels(fuzz* f);
void fuzz_trees(fuzz* f);
void fuzz_octrees(fuzz* f);
void fuzz_orders(fuzz* f);
void fuzz_tetra_pictures(fuzz* f);
void fuzz_contexts(fuzz* f);
void fuzz_paths(fuzz* f);

#endif
