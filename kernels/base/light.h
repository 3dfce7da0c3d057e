/* SPDX-License-Identifier: BSD-3-Clause
 * The light that falls on a place, as VTK's volume mappers compute it: ambient light, diffuse by N L, specular by (N H)^power with H half
 * way between the light and the eye (Blinn 1977). N points against the gradient; where both sides are lit it is turned towards the eye.
 * A share of the light may be scattered by the matter, as Henyey & Greenstein (1941) have it. Maps say how much light passes to the place.
 */
#ifndef STRATUS_LIGHT_H
#define STRATUS_LIGHT_H

#include "light_arguments.h"
#include "gather.h"
#include "light_map.h"
#include "light_scatter.h"
#include "packet_math.h"

INLINE vfloat v_dot3(const vfloat a[3], const vfloat b[3]) { return v_fma(a[0], b[0], v_fma(a[1], b[1], a[2] * b[2])); }

/* The product of the 3x3 matrix m, row by row, and v. */
INLINE void v_transform3(CONSTANT float* m, const vfloat v[3], vfloat result[3])
{
  for (int row = 0; row < 3; ++row) {
    result[row] = v_fma(v_set(m[3 * row]), v[0], v_fma(v_set(m[3 * row + 1]), v[1], v_set(m[3 * row + 2]) * v[2]));
  }
}

/* Scales v by the power of 2 that brings its largest component to 1..4. That is exact, and squares then neither overflow nor vanish,
 * whatever the range of the values. Returns the largest component as it was. */
INLINE vfloat v_scale3(vfloat v[3])
{
  const vfloat largest = v_max(v_max(v_abs(v[0]), v_abs(v[1])), v_abs(v[2]));
  const vint exponent =
    v_to_bits(v_clamp(largest, 0.0f, 1e38f)) & vi_set(0x7f800000); /* at most 253, so that 254 less it is the exponent of a normal number */
  const vfloat scale = v_from_bits(vi_set(0x7f000000) - exponent);
  for (int axis = 0; axis < 3; ++axis) {
    v[axis] = v[axis] * scale;
  }
  return largest;
}

/* Scales v to length 1. Makes it 0 where no component is above `least`, or where one is not finite. */
INLINE void v_normalize3(vfloat v[3], float least)
{
  const vfloat largest = v_scale3(v), square = v_dot3(v, v), zero = v_set(0.0f);
  const vmask any = v_lt(v_set(least), largest) & v_lt(zero, square) & v_finite(square);
  const vfloat scale = v_inverse_root(v_select(any, square, v_set(1.0f)));
  for (int axis = 0; axis < 3; ++axis) {
    v[axis] = v_select(any, v[axis] * scale, zero);
  }
}

/* The logarithm of a, 0 < a <= 1: by the exponent, and a series about 1. */
INLINE vfloat v_logarithm(vfloat a)
{
  const vint bits = v_to_bits(a) - vi_set(0x3f3504f3); /* so that the exponent changes at sqrt(1/2), not at 1 */
  const vint exponent = bits >> vi_set(23);
  const vfloat m = v_from_bits((bits & vi_set(0x7fffff)) + vi_set(0x3f3504f3)), one = v_set(1.0f);
  const vfloat s = (m - one) * v_reciprocal(m + one), square = s * s;
  vfloat series = v_fma(square, v_set(2.0f / 11.0f), v_set(2.0f / 9.0f));
  series = v_fma(square, series, v_set(2.0f / 7.0f));
  series = v_fma(square, series, v_set(2.0f / 5.0f));
  series = v_fma(square, series, v_set(2.0f / 3.0f));
  series = v_fma(square * s, series, s + s);
  return v_fma(v_from_int(exponent), v_set(0.69314718f), series);
}

/* a^power for 0 < a <= 1, with an error of about 1e-6. */
INLINE vfloat v_power(vfloat a, float power)
{
  const vfloat depth = v_clamp(v_set(0.0f) - v_logarithm(a) * v_set(power), 0.0f, 80.0f);
  return v_set(1.0f) - v_absorbed(depth);
}

/* The optical depth of an opacity, of which `passes` is 1 less it. Near 1 the logarithm loses what that has rounded, so that a series takes
 * opacities from 0 to 1/8. */
INLINE vfloat depth_of_opacity(vfloat opacity, vfloat passes)
{
  vfloat thin = v_set(1.0f / 8.0f);
  for (int n = 7; n > 0; --n) {
    thin = v_fma(thin, opacity, v_set(1.0f / (float)n));
  }
  return v_select(v_lt(opacity, v_set(0.125f)), thin * opacity, v_set(0.0f) - v_logarithm(v_clamp(passes, 1e-35f, 1.0f)));
}

/* Return the factor of an optical depth, if `factor`, 0..1, multiplies the opacity A of a segment on which the depth is `way`. The
 * transparency 1 - F A has the optical depth -ln(1 - F A). */
INLINE vfloat factor_of_way(vfloat factor, vfloat way)
{
  const vfloat one = v_set(1.0f), opacity = v_absorbed(way);
  const vfloat effective = depth_of_opacity(factor * opacity, (one - factor) + factor * (one - opacity));
  return v_select(v_lt(factor, one), effective * v_reciprocal(v_max(way, v_set(1e-30f))), one);
}

/* The gradient opacity of a gradient. Each lane has a function of its own, sampled at `last` + 1 even steps from `first` on; `scale` takes
 * gradients to steps. */
INLINE vfloat factor_of_gradient(GLOBAL const int* factors, vint first, vfloat scale, float last, const vfloat g[3], vmask mask)
{
  const vfloat zero = v_set(0.0f), one = v_set(1.0f);
  vfloat v[3];
  for (int axis = 0; axis < 3; ++axis) { /* beyond the last step the factor is constant; squares stay finite */
    v[axis] = v_clamp(g[axis] * scale, -last, last);
  }
  const vfloat square = v_dot3(v, v);
  const vmask steep = v_le(v_set(1e-28f), square); /* a shorter gradient takes the first factor */
  const vfloat place = v_min(v_select(steep, square * v_inverse_root(v_select(steep, square, one)), zero), v_set(last));
  const vint entry = v_to_int(place), at = first + entry;
  const vfloat low = v_from_bits(v_gather_ints(factors, at, mask)), high = v_from_bits(v_gather_ints(factors + 1, at, mask));
  return v_lerp(low, high, place - v_from_int(entry));
}

/* Return the fraction of light i that reaches a place. `way`, in units of `place`, and `light`, its direction, lead from the place to the
 * light. */
INLINE vfloat lamp_reaching(CONSTANT stratus_light_arguments* a, int i, const vfloat way[3], const vfloat light[3])
{
  CONSTANT float *far = a->attenuation[i], *cone = a->cone[i];
  const vfloat zero = v_set(0.0f), one = v_set(1.0f);
  vfloat part = one;
  if (far[1] != 0.0f || far[2] != 0.0f || far[0] != 1.0f) {
    const vfloat square = v_min(v_dot3(way, way), v_set(1e37f)), distance = square * v_inverse_root(v_max(square, v_set(1e-30f)));
    const vfloat sum = v_fma(distance, v_fma(distance, v_set(far[2]), v_set(far[1])), v_set(far[0]));
    part = v_reciprocal(v_clamp(sum, 1e-35f, 1e35f));
  }
  if (cone[3] >= 0.0f) {
    const vfloat axis[3] = { zero - v_set(cone[0]), zero - v_set(cone[1]), zero - v_set(cone[2]) };
    const vfloat cosine = v_dot3(axis, light);
    const vmask inside = v_le(v_set(cone[3]), cosine) & v_lt(zero, cosine);
    part = v_select(inside, part * v_power(v_select(inside, v_min(cosine, one), one), cone[4]), zero);
  }
  return part;
}

/* The light that scatters from a direction to the eye, 1 if it scatters evenly to all sides. The cosine is between the directions before
 * and after. */
INLINE vfloat light_phase(CONSTANT stratus_light_arguments* a, vfloat cosine)
{
  const vfloat root = v_inverse_root(v_max(v_set(a->phase[1]) - cosine * v_set(a->phase[2]), v_set(1e-12f)));
  return v_set(a->phase[0]) * (root * root * root);
}

/* The way from the places x towards light i on which near matter is passed, of a light that has near steps. */
INLINE void light_near_way(CONSTANT stratus_light_arguments* a, int i, const vfloat x[3], vfloat way[3])
{
  for (int axis = 0; axis < 3; ++axis) {
    way[axis] = v_set(a->near_way[i][axis]);
  }
  if (a->positional[i]) {
    vfloat place[3];
    for (int axis = 0; axis < 3; ++axis) {
      way[axis] = way[axis] - x[axis];
    }
    v_transform3(a->place, way, place);
    const vfloat square = v_clamp(v_dot3(place, place), 1e-30f, 1e37f);
    const vfloat part = v_min(v_set(a->near_reach[i]) * v_inverse_root(square), v_set(1.0f));
    for (int axis = 0; axis < 3; ++axis) {
      way[axis] = way[axis] * part;
    }
  }
}

/* Whether light depends on the gradient. */
INLINE int light_reflects(CONSTANT stratus_light_arguments* a) { return a->scattered < 1.0f; }

/* Lights component m at the places x where the gradient is g, on rays of direction d. A colour C of opacity A becomes C diffuse + A
 * specular. diffuse includes the ambient light. maps: of the lights; not read if none has one. passing: the part of each light that passes
 * to the places, read of lights that have a map; NULL: maps are read at the places.
 *
 * turned: receives by how much diffuse and specular would change where the ray has passed the place at which the field turns along it, as
 * far behind it as these places are in front: there the part of the normal along the ray is the same, and the rest is turned round. NULL:
 * not wanted. */
INLINE void light_at(CONSTANT stratus_light_arguments* a, GLOBAL const int* maps, const vfloat* passing, int m, const vfloat x[3],
  const vfloat d[3], const vfloat g[3], vfloat diffuse[3], vfloat specular[3], vfloat turned[6])
{
  CONSTANT float* material = a->material[m];
  const vfloat zero = v_set(0.0f);
  vfloat normal[3], eye[3], place[3];
  vfloat steep[3] = { g[0], g[1], g[2] };
  v_scale3(steep);
  v_transform3(a->normal, steep, normal);
  v_normalize3(normal, 0.0f); /* where the field is flat the normal is 0, and only ambient light remains */
  v_transform3(a->place, d, eye);
  v_normalize3(eye, 0.0f);
  v_transform3(a->place, x, place);
  const vmask away = v_lt(zero, v_dot3(normal, eye));
  for (int axis = 0; axis < 3; ++axis) {
    eye[axis] = zero - eye[axis];
    if (a->two_sided) {
      normal[axis] = v_select(away, zero - normal[axis], normal[axis]);
    }
    diffuse[axis] = v_set(material[0]);
    specular[axis] = zero;
  }
  vfloat behind[3] = { zero, zero, zero };
  if (turned) {
    const vfloat twice = v_set(2.0f) * v_dot3(normal, eye);
    for (int axis = 0; axis < 3; ++axis) {
      behind[axis] = v_fma(twice, eye[axis], zero - normal[axis]);
      turned[axis] = turned[3 + axis] = zero;
    }
  }
  vfloat sent = zero, all = v_set(1e-30f); /* the light that the phase function sends to the eye, of all lights */
  for (int i = 0; i < a->count; ++i) {
    vfloat light[3], half_way[3];
    for (int axis = 0; axis < 3; ++axis) {
      light[axis] = v_set(a->vector[i][axis]);
      if (a->positional[i]) {
        light[axis] = light[axis] - place[axis];
      }
    }
    const vfloat way[3] = { light[0], light[1], light[2] };
    v_normalize3(light, 0.0f);
    vfloat reaching = a->positional[i] ? lamp_reaching(a, i, way, light) : v_set(1.0f);
    const vfloat full = reaching;
    if (a->map_at[i] >= 0) {
      reaching = reaching * (passing ? passing[i] : light_map_passing(a, maps, i, x));
    }
    if (a->scattered > 0.0f) {
      const vfloat phase = light_phase(a, zero - v_dot3(light, eye)), part = phase * reaching * v_set(material[1] * a->scattered);
      if (a->scatter_at >= 0) {
        const vfloat bright = full * v_set(a->color[i][0] + a->color[i][1] + a->color[i][2]);
        sent = v_fma(phase, bright, sent);
        all = all + bright;
      }
      for (int c = 0; c < 3; ++c) {
        diffuse[c] = v_fma(part, v_set(a->color[i][c]), diffuse[c]);
      }
      if (a->scattered >= 1.0f) {
        continue;
      }
      reaching = reaching * v_set(1.0f - a->scattered);
    }
    for (int axis = 0; axis < 3; ++axis) {
      half_way[axis] = light[axis] + eye[axis];
    }
    v_normalize3(half_way, 1e-6f); /* where light and eye lie opposite, half_way is nothing but rounding */
    const vfloat cosine = v_max(v_dot3(normal, light), zero), gloss = v_dot3(normal, half_way);
    const vmask lit = v_lt(zero, cosine), shines = lit & v_lt(v_set(1e-9f), gloss);
    const vfloat matt = cosine * v_set(material[1]) * reaching;
    vfloat shine = zero;
    if (material[2] > 0.0f && m_any(shines)) {
      shine = v_select(shines, v_power(v_select(shines, gloss, v_set(1.0f)), material[3]) * v_set(material[2]) * reaching, zero);
    }
    for (int c = 0; c < 3; ++c) {
      diffuse[c] = v_fma(matt, v_set(a->color[i][c]), diffuse[c]);
      specular[c] = v_fma(shine, v_set(a->specular_color[i][c]), specular[c]);
    }
    if (turned) {
      const vfloat other = v_max(v_dot3(behind, light), zero), more = (other - cosine) * v_set(material[1]) * reaching;
      vfloat shines_more = zero - shine;
      if (material[2] > 0.0f) {
        const vfloat other_gloss = v_dot3(behind, half_way);
        const vmask other_shines = v_lt(zero, other) & v_lt(v_set(1e-9f), other_gloss);
        const vfloat power = v_power(v_select(other_shines, v_min(other_gloss, v_set(1.0f)), v_set(1.0f)), material[3]);
        shines_more = v_select(other_shines, v_fma(power * v_set(material[2]), reaching, shines_more), shines_more);
      }
      for (int c = 0; c < 3; ++c) {
        turned[c] = v_fma(more, v_set(a->color[i][c]), turned[c]);
        turned[3 + c] = v_fma(shines_more, v_set(a->specular_color[i][c]), turned[3 + c]);
      }
    }
  }
  if (a->scatter_at >= 0) {
    vfloat more[3];
    light_scattered(a, maps, x, eye, sent * v_reciprocal(all), more);
    for (int c = 0; c < 3; ++c) {
      diffuse[c] = v_fma(more[c], v_set(material[1] * a->scattered), diffuse[c]);
    }
  }
}

#endif
