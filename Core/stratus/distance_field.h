/* SPDX-License-Identifier: BSD-3-Clause
 * Euclidean distance fields of effective voxels: the distance, voxel centre to voxel centre, from each voxel to the nearest effective one.
 */
#ifndef STRATUS_PUBLIC_DISTANCE_FIELD_H
#define STRATUS_PUBLIC_DISTANCE_FIELD_H

#include "voxels.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum stratus_field_method {
  STRATUS_FIELD_EXACT,       /* separable, squared distances as integers; uses zigzag or envelope, whichever is cheaper for the set */
  STRATUS_FIELD_ZIGZAG,      /* searches each row outward from each voxel, as far as the best distance found */
  STRATUS_FIELD_ENVELOPE,    /* lower envelope of parabolas (Felzenszwalb & Huttenlocher 2012) */
  STRATUS_FIELD_JFA,         /* jump flooding (Rong & Tan 2006): steps n/2, n/4 and so on down to 1 */
  STRATUS_FIELD_JFA_1,       /* JFA+1: one more pass of step 1 */
  STRATUS_FIELD_JFA_2,       /* JFA+2: two more passes, of steps 2 and 1 */
  STRATUS_FIELD_1_JFA,       /* 1+JFA: a pass of step 1 first */
  STRATUS_FIELD_JFA_SQUARED, /* JFA^2: all passes twice */
  /* Adaptive. After each pass the step is multiplied by 3/4 if E1 (1 - E2) of the pass (eq. 6 and 7) is at least .05, otherwise by 1/2. */
  STRATUS_FIELD_AJFA,
  STRATUS_FIELD_AJFA_FIG5 /* the steps of the paper's figure 5, scaled to the grid: 64, 48, 15, 10, 3, 1; leaves voxels unfilled */
} stratus_field_method;

/* Return a method's name: "exact", "zigzag", "envelope", "jfa", "jfa+1", "jfa+2", "1+jfa", "jfa2", "ajfa" or "ajfa-fig5"; "unknown" for
 * other numbers. */
STRATUS_EXPERIMENTAL const char* stratus_field_method_name(stratus_field_method method);

typedef struct stratus_field_options {
  stratus_field_method method; /* default exact */
  /* 1: an effective voxel has minus the distance to the nearest voxel that is not effective. Default 0. */
  int is_signed;
  int first_step; /* floodings: upper bound on the first step, in voxels, >= 1; 0 (default): half the longest edge */
} stratus_field_options;

/* Return options with their defaults. */
STRATUS_EXPERIMENTAL stratus_field_options stratus_field_options_default(void);

typedef struct stratus_field_report {
  /* Passes over the grid. Exact: 3, signed or not, because both halves share them. Floodings: the passes of both halves if signed. */
  int passes;
  uint64_t updated; /* floodings: voxels for which a pass found a nearer one, summed over all passes */
  int steps[64];    /* floodings: step of each of the first 64 passes */
  /* Floodings: eq. 6 and 7 of each of these passes, over the voxels that are not targets. e2 is 1 if no voxel came nearer. */
  double e1[64], e2[64];
  double build_ms;
} stratus_field_report;

typedef struct stratus_field stratus_field;

/* Create a field over all of the voxels' dimensions. options and report may be NULL.
 *
 * Memory of an exact field: 2 bytes for each voxel if all distances are below 176, 8 if the grid's diagonal is at least 46339, otherwise 4;
 * none if no voxel or every voxel is effective. A flooding may overestimate a distance, and never underestimates one.
 *
 * Returns STRATUS_OVERFLOW if 4 bytes for each voxel do not fit the address space, or if a flooding would need more than 31 bits for a
 * voxel's position. Options out of their ranges give STRATUS_INVALID_ARGUMENT. */
STRATUS_EXPERIMENTAL stratus_status stratus_field_create(stratus_context* context, const stratus_voxels* voxels,
  const stratus_field_options* options, stratus_field** field, stratus_field_report* report);
STRATUS_EXPERIMENTAL void stratus_field_destroy(stratus_field* field);
/* Return the distance in voxels at voxel (i,j,k). INFINITY if no effective voxel is known: there is none, or a flooding left the voxel
 * unfilled. INFINITY also beyond the dimensions. -INFINITY in a signed field if every voxel is effective. */
STRATUS_EXPERIMENTAL double stratus_field_get(const stratus_field* field, int64_t i, int64_t j, int64_t k);
/* Fill dimensions[0]*[1]*[2] distances in voxels, x fastest. */
STRATUS_EXPERIMENTAL void stratus_field_distances(const stratus_field* field, float* distances);
/* Fill the paper's layout (2.3): four floats for each voxel, the position of the nearest effective voxel and the distance to it; -1, -1,
 * -1, INFINITY if it is unknown. In a signed field the position is the voxel to which the distance refers. Of several equally near voxels
 * it is the one of smallest index (floodings: of smallest index among the voxels that they found).
 * - voxels: the set from which the field was made. Other dimensions or another count give STRATUS_INVALID_ARGUMENT. */
STRATUS_EXPERIMENTAL stratus_status stratus_field_rgba(const stratus_field* field, const stratus_voxels* voxels, float* rgba);

#ifdef __cplusplus
}
#endif

#endif
