/* SPDX-License-Identifier: BSD-3-Clause
 * The trilinear field along a ray through one cell is a cubic. It is cut where it turns, and its roots are found piece by piece.
 *
 * The cut into monotone pieces follows Marmitt, Kleer, Wald, Friedrich & Slusallek 2004. Their bracketing is kept. Their search is replaced
 * by bisection, which needs no division and ends after the same number of steps in every lane. Where a ray passes from a cell to the next,
 * both cells compute the very same bits, so that a root there is found in exactly one of them. */
#ifndef STRATUS_CELL_CUBIC_H
#define STRATUS_CELL_CUBIC_H

#include "packet_math.h"

/* Steps of bisection, after which the piece is taken as straight. */
#define CUBIC_HALVINGS 12

/* The field at w in 0..1 is k[0] + k[1] w + k[2] w^2 + k[3] w^3. Between cut[i] and cut[i + 1] it is monotone, from value[i] to value[i +
 * 1]. */
typedef struct stratus_cubic {
  vfloat k[4];
  vfloat cut[4], value[4];
} stratus_cubic;

/* Interpolates: exactly a at t = 0, exactly b at t = 1, and never outside a..b. */
INLINE vfloat v_between(vfloat a, vfloat b, vfloat t)
{
  const vfloat value = v_fma(t, b, v_fma(v_set(0.0f) - t, a, a));
  return v_min(v_max(value, v_min(a, b)), v_max(a, b));
}

/* The field at the fractions e of a cell with corners v. */
INLINE vfloat cell_value(const vfloat v[8], const vfloat e[3])
{
  const vfloat near = v_between(v_between(v[0], v[1], e[0]), v_between(v[2], v[3], e[0]), e[1]);
  const vfloat far = v_between(v_between(v[4], v[5], e[0]), v_between(v[6], v[7], e[0]), e[1]);
  return v_between(near, far, e[2]);
}

INLINE vfloat cubic_at(const stratus_cubic* c, vfloat w) { return v_fma(v_fma(v_fma(c->k[3], w, c->k[2]), w, c->k[1]), w, c->k[0]); }

/* 1/a for a of either sign. Where a is next to zero the result stays finite. */
INLINE vfloat v_signed_reciprocal(vfloat a)
{
  const vfloat size = v_reciprocal(v_max(v_abs(a), v_set(1e-30f)));
  return v_select(v_lt(a, v_set(0.0f)), v_set(0.0f) - size, size);
}

/* Coefficients of the cubic on the segment from the fractions e to the fractions e + d. */
INLINE void cubic_coefficients(const vfloat v[8], const vfloat e[3], const vfloat d[3], vfloat k[4])
{
  vfloat q[2][3];
  for (int z = 0; z < 2; ++z) {
    const vfloat *low = v + 4 * z, *high = low + 2;
    const vfloat rise = low[1] - low[0], base = v_fma(e[0], rise, low[0]), slope = rise * d[0];
    const vfloat high_rise = high[1] - high[0], up = v_fma(e[0], high_rise, high[0]) - base,
                 steeper = v_fma(high_rise, d[0], v_set(0.0f) - slope);
    q[z][0] = v_fma(e[1], up, base);
    q[z][1] = v_fma(d[1], up, v_fma(e[1], steeper, slope));
    q[z][2] = d[1] * steeper;
  }
  const vfloat up[3] = { q[1][0] - q[0][0], q[1][1] - q[0][1], q[1][2] - q[0][2] };
  k[0] = v_fma(e[2], up[0], q[0][0]);
  k[1] = v_fma(d[2], up[0], v_fma(e[2], up[1], q[0][1]));
  k[2] = v_fma(d[2], up[1], v_fma(e[2], up[2], q[0][2]));
  k[3] = d[2] * up[2];
}

/* Where the cubic turns within 0..1, the nearer turn first. A turn that is elsewhere, or none, becomes 0 or 1. */
INLINE void cubic_turns(const vfloat k[4], vfloat* first, vfloat* second)
{
  const vfloat zero = v_set(0.0f), largest = v_max(v_max(v_abs(k[1]), v_abs(k[2])), v_abs(k[3]));
  const vfloat scale = v_reciprocal(v_max(largest, v_set(1e-30f)));
  const vfloat c1 = k[1] * scale, c2 = k[2] * scale, c3 = v_set(3.0f) * (k[3] * scale);
  const vfloat square = v_fma(c2, c2, zero - c3 * c1);
  const vmask any = v_lt(zero, square);
  const vfloat root = v_select(any, square * v_inverse_root(v_max(square, v_set(1e-30f))), zero);
  const vfloat sum =
    v_select(v_lt(c2, zero), root - c2, zero - (root + c2)); /* the sum of two numbers of the same sign, so that no digits cancel */
  const vfloat one_turn = v_select(any, v_clamp(sum * v_signed_reciprocal(c3), 0.0f, 1.0f), zero);
  const vfloat other_turn = v_select(any, v_clamp(c1 * v_signed_reciprocal(sum), 0.0f, 1.0f), zero);
  *first = v_min(one_turn, other_turn);
  *second = v_max(one_turn, other_turn);
}

/* The cubic of a cell with corners v, on the segment from the fractions e to the fractions f. */
INLINE void cubic_of_cell(const vfloat v[8], const vfloat e[3], const vfloat f[3], stratus_cubic* c)
{
  const vfloat d[3] = { f[0] - e[0], f[1] - e[1], f[2] - e[2] }, zero = v_set(0.0f), one = v_set(1.0f);
  cubic_coefficients(v, e, d, c->k);
  c->cut[0] = zero;
  c->cut[3] = one;
  c->value[0] = cell_value(v, e);
  c->value[3] = cell_value(v, f);
  cubic_turns(c->k, &c->cut[1], &c->cut[2]);
  for (int turn = 1; turn < 3; ++turn) {
    const vfloat at = cubic_at(c, c->cut[turn]);
    c->value[turn] = v_select(v_le(c->cut[turn], zero), c->value[0], v_select(v_le(one, c->cut[turn]), c->value[3], at));
  }
}

/* Where the cubic passes `level` in piece number `piece`. below: whether the piece begins below the level. In a piece that does not pass
 * the level, the result is anywhere. */
INLINE vfloat cubic_root(const stratus_cubic* c, int piece, vfloat level, vmask below)
{
  vfloat lo = c->cut[piece], hi = c->cut[piece + 1];
  for (int halving = 0; halving < CUBIC_HALVINGS; ++halving) {
    const vfloat middle = v_set(0.5f) * (lo + hi);
    const vmask under = v_lt(cubic_at(c, middle), level);
    const vmask same = (under & below) | m_andnot(m_andnot(v_le(middle, middle), under), below);
    lo = v_select(same, middle, lo);
    hi = v_select(same, hi, middle);
  }
  const vfloat from = cubic_at(c, lo) - level, rise = cubic_at(c, hi) - level - from;
  const vfloat part = v_clamp((v_set(0.0f) - from) * v_signed_reciprocal(rise), 0.0f, 1.0f);
  return v_lerp(lo, hi, part);
}

#endif
