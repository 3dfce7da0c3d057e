/* SPDX-License-Identifier: BSD-3-Clause
 * Which side of a tetrahedron's faces the eye sees. Host and device compile the same operations on doubles in the same order, never
 * contracted, so that they give the same bits. Points are as visibility_signs.c transforms them. */
#ifndef STRATUS_FACE_SIGNS_H
#define STRATUS_FACE_SIGNS_H

#ifdef STRATUS_DEVICE
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF
#define FACE_SIGNS_GLOBAL __global
#else
#define FACE_SIGNS_GLOBAL
#endif

/* Coordinates are scaled to 1 at most. Perspective: a determinant sums six products of three differences with the eye, fewer than 100
 * roundings of 2^-53. Parallel: projected coordinates are up to twice as large, with four roundings each, fewer than 250 in all. */
#define FACE_SIGNS_ERROR_BOUND 0x1p-44

typedef struct face_point {
  double x, y, z;
} face_point;

static inline face_point face_point_at(FACE_SIGNS_GLOBAL const double* p)
{
  const face_point point = { p[0], p[1], p[2] };
  return point;
}

/* Determinants of the triples (1 3 2), (0 2 3), (0 3 1), (0 1 2): one for each face, in the order of stratus_face_points(). */
static inline void face_determinants(face_point p0, face_point p1, face_point p2, face_point p3, int parallel, double det[4])
{
  const double m01 = p0.x * p1.y - p0.y * p1.x, m02 = p0.x * p2.y - p0.y * p2.x, m03 = p0.x * p3.y - p0.y * p3.x;
  const double m12 = p1.x * p2.y - p1.y * p2.x, m13 = p1.x * p3.y - p1.y * p3.x, m23 = p2.x * p3.y - p2.y * p3.x;
  const double z0 = parallel ? 1.0 : p0.z, z1 = parallel ? 1.0 : p1.z, z2 = parallel ? 1.0 : p2.z, z3 = parallel ? 1.0 : p3.z;
  det[0] = m13 * z2 - m12 * z3 - m23 * z1;
  det[1] = m02 * z3 - m03 * z2 + m23 * z0;
  det[2] = m03 * z1 - m01 * z3 - m13 * z0;
  det[3] = m01 * z2 - m02 * z1 + m12 * z0;
}

/* The sign of a determinant, or 0 if rounding may have changed it and exact arithmetic has to decide. */
static inline int face_sign(double det) { return (det > FACE_SIGNS_ERROR_BOUND) - (det < -FACE_SIGNS_ERROR_BOUND); }

#endif
