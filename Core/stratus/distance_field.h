/* SPDX-License-Identifier: BSD-3-Clause
 * Euclidean distance fields of effective voxels. */
#ifndef STRATUS_PUBLIC_DISTANCE_FIELD_H
#define STRATUS_PUBLIC_DISTANCE_FIELD_H

#include "voxels.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Euclidean distance, voxel centre to voxel centre, from each voxel to the nearest effective one. */

typedef enum stratus_field_method {
  STRATUS_FIELD_EXACT,       /* separable, squared distances as integers; zigzag or envelope, whichever is cheaper for the set */
  STRATUS_FIELD_ZIGZAG,      /* rows searched outward from each voxel, up to the best so far */
  STRATUS_FIELD_ENVELOPE,    /* lower envelope of parabolas (Felzenszwalb & Huttenlocher 2012) */
  STRATUS_FIELD_JFA,         /* jump flooding (Rong & Tan 2006): steps n/2, n/4 .. 1 */
  STRATUS_FIELD_JFA_1,       /* JFA+1: one more pass of step 1 */
  STRATUS_FIELD_JFA_2,       /* JFA+2: passes of steps 2 and 1 more */
  STRATUS_FIELD_1_JFA,       /* 1+JFA: a pass of step 1 first */
  STRATUS_FIELD_JFA_SQUARED, /* JFA^2: all passes twice */
  STRATUS_FIELD_AJFA,        /* adaptive: E1 (1 - E2) of a pass (eq. 6 and 7) of .05 or more lets the step fall to 3/4, else to 1/2 */
  STRATUS_FIELD_AJFA_FIG5    /* the paper's figure 5: 64, 48, 15, 10, 3, 1, scaled to the grid; leaves voxels unfilled */
} stratus_field_method;

STRATUS_EXPERIMENTAL const char* stratus_field_method_name(stratus_field_method method);

typedef struct stratus_field_options {
  stratus_field_method method; /* default exact */
  int is_signed;               /* 1: inside effective voxels minus the distance to the nearest voxel that is not one. Default 0. */
  int first_step;              /* floodings: cap on the first step, >= 1; 0 (default): half the longest edge */
} stratus_field_options;

STRATUS_EXPERIMENTAL stratus_field_options stratus_field_options_default(void);

typedef struct stratus_field_report {
  int passes;            /* over the grid; exact: 3, signed too, for both halves share them; signed floodings: both of them */
  uint64_t updated;      /* voxels that a flooding pass brought nearer, all passes */
  int steps[64];         /* floodings: step of each of the first 64 passes */
  double e1[64], e2[64]; /* floodings: eq. 6 and 7 of each, over the voxels that are not sought; e2 is 1 where none came nearer */
  double build_ms;
} stratus_field_report;

typedef struct stratus_field stratus_field;

/* Over all of the voxels' dimensions. report: may be NULL. Exact fields take 2 bytes a voxel where all distances are below 176, 8 where the
 * grid's diagonal is 46339 or longer, else 4; none where no voxel or every one is effective. STRATUS_OVERFLOW where 4 bytes a voxel do not
 * fit the address space, or where a flooding would need more than 31 bits to name a voxel. Floodings err on the long side only. */
STRATUS_EXPERIMENTAL stratus_status stratus_field_create(stratus_context* context, const stratus_voxels* voxels,
  const stratus_field_options* options, stratus_field** field, stratus_field_report* report);
STRATUS_EXPERIMENTAL void stratus_field_destroy(stratus_field* field);
/* Distance in voxels; INFINITY where no effective voxel is known (none at all, or a flooding left it unfilled), -INFINITY inside a signed
 * field that is all effective; INFINITY beyond the dimensions. */
STRATUS_EXPERIMENTAL double stratus_field_get(const stratus_field* field, int64_t i, int64_t j, int64_t k);
/* dimensions[0]*[1]*[2] distances, x fastest. */
STRATUS_EXPERIMENTAL void stratus_field_distances(const stratus_field* field, float* distances);
/* The paper's layout (2.3): four floats a voxel, the nearest effective voxel's position and the distance; -1, -1, -1, INFINITY where
 * unknown. A signed field names the voxel that its distance goes to; of several equally near ones, the one of the smallest index (a
 * flooding: of those that it found). voxels: those of the field; others of another size or count are STRATUS_INVALID_ARGUMENT. */
STRATUS_EXPERIMENTAL stratus_status stratus_field_rgba(const stratus_field* field, const stratus_voxels* voxels, float* rgba);

#ifdef __cplusplus
}
#endif

#endif
