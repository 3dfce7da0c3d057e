/* SPDX-License-Identifier: BSD-3-Clause
 * Double precision for the set-up of rays, REAL_WIDTH rays at once. A real is the dialect's double. On a device that has none
 * (STRATUS_REAL_PAIR) it is an unevaluated sum of two floats (Dekker 1971, with fma), which keeps 48 bits. Arguments are such pairs in
 * both cases, so that host and device start from the same numbers. */
#ifndef STRATUS_REAL_H
#define STRATUS_REAL_H

#include "packet.h"

typedef struct stratus_pair {
  float hi, lo;
} stratus_pair;

#ifndef STRATUS_DEVICE
INLINE stratus_pair stratus_pair_of(double a)
{
  stratus_pair p;
  p.hi = (float)a;
  p.lo = (float)(a - (double)p.hi);
  if (!(fabsf(p.hi) <= LARGEST_FLOAT)) {
    p.hi = a > 0 ? LARGEST_FLOAT : -LARGEST_FLOAT; /* clamped to the largest float: no ray goes as far */
    p.lo = 0.0f;
  }
  return p;
}
#endif

#ifdef STRATUS_REAL_PAIR
#if STRATUS_WIDTH != 1
#error "pairs of floats are for one ray at a time"
#endif
#define REAL_WIDTH 1
typedef stratus_pair real;
typedef int rmask;

INLINE real r_two(float a, float b) /* |a| >= |b| */
{
  real r;
  r.hi = a + b;
  r.lo = b - (r.hi - a);
  return r;
}
INLINE real r_of(stratus_pair p) { return p; }
INLINE real r_add(real a, real b)
{
  const float s = a.hi + b.hi, v = s - a.hi;
  const float e = (a.hi - (s - v)) + (b.hi - v);
  return r_two(s, e + (a.lo + b.lo));
}
INLINE real r_neg(real a)
{
  a.hi = -a.hi;
  a.lo = -a.lo;
  return a;
}
INLINE real r_sub(real a, real b) { return r_add(a, r_neg(b)); }
INLINE real r_mul(real a, real b)
{
  const float p = a.hi * b.hi;
  const float e = v_fma(a.hi, b.hi, -p);
  return r_two(p, v_fma(a.hi, b.lo, v_fma(a.lo, b.hi, e)));
}
INLINE real r_div(real a, real b)
{
  const float q = a.hi / b.hi;
  real r, quotient;
  quotient.hi = q;
  quotient.lo = 0.0f;
  r = r_sub(a, r_mul(quotient, b));
  return r_two(q, (r.hi + r.lo) / b.hi);
}
INLINE real r_sqrt(real a)
{
  const float s = sqrt(a.hi);
  real root;
  root.hi = s;
  root.lo = 0.0f;
  return r_two(s, r_sub(a, r_mul(root, root)).hi / (2.0f * s));
}
INLINE rmask r_lt(real a, real b) { return a.hi < b.hi || (a.hi == b.hi && a.lo < b.lo); }
INLINE real r_select(rmask m, real a, real b)
{
  if (m) {
    return a;
  }
  return b;
}
INLINE real r_floor(real a)
{
  const float f = floor(a.hi);
  return f == a.hi ? r_two(f, floor(a.lo)) : r_two(f, 0.0f);
}
INLINE void r_store(float* p, real a) { *p = a.hi + a.lo; }
INLINE real r_load(const float* p)
{
  real r;
  r.hi = *p;
  r.lo = 0.0f;
  return r;
}

#else

#ifdef STRATUS_DEVICE
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#endif
#if STRATUS_WIDTH == 1
#define REAL_WIDTH 1
typedef double real;
typedef int rmask;
INLINE real r_of(stratus_pair p) { return (double)p.hi + (double)p.lo; }
INLINE real r_select(rmask m, real a, real b) { return m ? a : b; }
INLINE rmask r_lt(real a, real b) { return a < b; }
INLINE void r_store(float* p, real a) { *p = (float)a; }
INLINE real r_load(const float* p) { return (double)*p; }
INLINE real r_sqrt(real a) { return sqrt(a); }
INLINE real r_floor(real a) { return floor(a); }

#elif defined(STRATUS_DEVICE)
#define REAL_WIDTH 16
typedef double16 real;
typedef long16 rmask;
INLINE real r_of(stratus_pair p) { return (double16)((double)p.hi + (double)p.lo); }
INLINE real r_select(rmask m, real a, real b) { return m ? a : b; }
INLINE rmask r_lt(real a, real b) { return a < b; }
INLINE void r_store(float* p, real a) { vstore16(convert_float16(a), 0, p); }
INLINE real r_load(const float* p) { return convert_double16(vload16(0, p)); }
INLINE real r_sqrt(real a) { return sqrt(a); }
INLINE real r_floor(real a) { return floor(a); }

#else
/* A real fills one register: the compiler would compare wider vectors lane by lane. */
#if STRATUS_ISA == 2
#define REAL_WIDTH 8
#elif STRATUS_ISA == 1
#define REAL_WIDTH 4
#else
#define REAL_WIDTH 2
#endif
typedef double real __attribute__((vector_size(8 * REAL_WIDTH), may_alias));
typedef int64_t rmask __attribute__((vector_size(8 * REAL_WIDTH), may_alias));
#define REAL_EACH for (int lane = 0; lane < REAL_WIDTH; ++lane)
INLINE real r_of(stratus_pair p) { return ((double)p.hi + (double)p.lo) - (real){ 0 }; }
INLINE real r_select(rmask m, real a, real b) { return (real)(((rmask)a & m) | ((rmask)b & ~m)); }
INLINE rmask r_lt(real a, real b) { return (rmask)(a < b); }
#if STRATUS_ISA == 2
INLINE real r_sqrt(real a) { return (real)_mm512_sqrt_pd((__m512d)a); }
INLINE real r_floor(real a) { return (real)_mm512_roundscale_pd((__m512d)a, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC); }
INLINE void r_store(float* p, real a) { _mm256_storeu_ps(p, _mm512_cvtpd_ps((__m512d)a)); }
INLINE real r_load(const float* p) { return (real)_mm512_cvtps_pd(_mm256_loadu_ps(p)); }
#else
INLINE real r_sqrt(real a)
{
  real r = a;
  REAL_EACH r[lane] = sqrt(a[lane]);
  return r;
}
INLINE real r_floor(real a)
{
  real r = a;
  REAL_EACH r[lane] = floor(a[lane]);
  return r;
}
INLINE void r_store(float* p, real a) { REAL_EACH p[lane] = (float)a[lane]; }
INLINE real r_load(const float* p)
{
  real r = { 0 };
  REAL_EACH r[lane] = (double)p[lane];
  return r;
}
#endif
#endif
INLINE real r_add(real a, real b) { return a + b; }
INLINE real r_sub(real a, real b) { return a - b; }
INLINE real r_neg(real a) { return -a; }
INLINE real r_mul(real a, real b) { return a * b; }
INLINE real r_div(real a, real b) { return a / b; }
#endif

INLINE real r_number(float a)
{
  stratus_pair number;
  number.hi = a;
  number.lo = 0.0f;
  return r_of(number);
}
INLINE real r_min(real a, real b) { return r_select(r_lt(b, a), b, a); }
INLINE real r_max(real a, real b) { return r_select(r_lt(a, b), b, a); }

#endif
