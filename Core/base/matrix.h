/* SPDX-License-Identifier: BSD-3-Clause
 * Affine matrices of 4x4 numbers, row-major: point' = matrix * (point, 1). The functions take the last row for 0 0 0 1. */
#ifndef STRATUS_MATRIX_H
#define STRATUS_MATRIX_H

#include <stdbool.h>

/* Returns false, and writes nothing, if the matrix has no inverse in doubles. */
bool stratus_matrix_invert_affine(const double matrix[16], double inverse[16]);
void stratus_matrix_point(const double matrix[16], const double point[3], double result[3]);
/* Transforms a direction, without the matrix's translation. */
void stratus_matrix_vector(const double matrix[16], const double vector[3], double result[3]);
/* The bounds, xmin xmax ymin ymax zmin zmax, of the box lo..hi after the transformation. */
void stratus_matrix_box(const double matrix[16], const double lo[3], const double hi[3], double bounds[6]);

#endif
