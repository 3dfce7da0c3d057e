/* SPDX-License-Identifier: BSD-3-Clause
 * Composites exactly but for rounding and quadrature. Between two grid planes the field along a ray is a cubic. It is cut where it crosses
 * a point of the transfer function, so that opacity and colour are linear in the value on each piece and vertical steps are between pieces.
 * Collocation at three Gauss points, of order 6, integrates a piece. */
#include "reference_pieces.h"

#include "reference_shading.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#define THICKEST 0.5 /* optical depth of a piece that is not divided further */
#define DIVISIONS 40 /* of a piece by two, at most */

/* ---- the points of a transfer function */

static int in_order(const void* a, const void* b)
{
  const double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}

int reference_breaks_create(const stratus_transfer* transfer, reference_breaks* breaks)
{
  const size_t opacities = transfer->opacity_count, all = opacities + transfer->color_count;
  breaks->count = 0;
  breaks->values = malloc(all * sizeof *breaks->values);
  if (!breaks->values) {
    return -1;
  }
  for (size_t i = 0; i < all; ++i) {
    breaks->values[i] = i < opacities ? transfer->opacity[2 * i] : transfer->color[4 * (i - opacities)];
  }
  qsort(breaks->values, all, sizeof *breaks->values, in_order);
  for (size_t i = 0; i < all; ++i) {
    if (breaks->count == 0 || breaks->values[i] > breaks->values[breaks->count - 1]) {
      breaks->values[breaks->count++] = breaks->values[i];
    }
  }
  return 0;
}

void reference_breaks_release(reference_breaks* breaks)
{
  free(breaks->values);
  breaks->values = NULL;
}

/* ---- the field on a line, as a cubic of t in 0..1 */

typedef struct cubic {
  double c[4]; /* c[0] + c[1] t + c[2] t^2 + c[3] t^3 */
} cubic;

static double value_of(const cubic* q, double t)
{
  return q->c[0] + t * (q->c[1] + t * (q->c[2] + t * q->c[3]));
}

/* Finds the cubic through four samples inside the line, where no rounding can read a neighbour of the line's cells. Returns false where the
 * field is hidden. */
static bool fit(const reference_field* f, const reference_line* line, reference_cell* cell, cubic* q)
{
  static const double at[4] = { 0.125, 0.375, 0.625, 0.875 };
  double d[4];
  for (int n = 0; n < 4; ++n) {
    const double s = line->begin + at[n] * (line->end - line->begin);
    const double p[3] = { line->origin[0] + s * line->direction[0], line->origin[1] + s * line->direction[1],
      line->origin[2] + s * line->direction[2] };
    d[n] = reference_field_sample(f, p, cell);
    if (isnan(d[n])) {
      return false;
    }
  }
  /* Newton's divided differences, then powers of t. Equal samples give a constant without rounding. */
  for (int order = 1; order < 4; ++order) {
    for (int n = 3; n >= order; --n) {
      d[n] = (d[n] - d[n - 1]) / (at[n] - at[n - order]);
    }
  }
  *q = (cubic){ { d[3], 0.0, 0.0, 0.0 } };
  for (int n = 2; n >= 0; --n) {
    for (int power = 3; power > 0; --power) {
      q->c[power] = q->c[power - 1] - at[n] * q->c[power];
    }
    q->c[0] = d[n] - at[n] * q->c[0];
  }
  return true;
}

/* Finds where a cubic that is monotone on a..b takes a value between those at the ends. */
static double crossing(const cubic* q, double a, double b, double value)
{
  const bool rises = value_of(q, a) < value_of(q, b);
  for (int i = 0; i < 60 && b - a > DBL_EPSILON; ++i) {
    const double middle = 0.5 * (a + b);
    if ((value_of(q, middle) < value) == rises) {
      a = middle;
    } else {
      b = middle;
    }
  }
  return 0.5 * (a + b);
}

/* Writes 0, the places where the derivative vanishes, and 1. Returns how many. */
static int monotone_parts(const cubic* q, double ends[4])
{
  int count = 0;
  ends[count++] = 0.0;
  const double a = 3.0 * q->c[3], half = q->c[2], c = q->c[1];
  const double square = half * half - a * c;
  if (square > 0.0) {
    const double big = -(half + copysign(sqrt(square), half));
    double roots[2] = { a != 0.0 ? big / a : -1.0, big != 0.0 ? c / big : -1.0 };
    if (roots[0] > roots[1]) {
      const double swap = roots[0];
      roots[0] = roots[1];
      roots[1] = swap;
    }
    for (int i = 0; i < 2; ++i) {
      if (roots[i] > ends[count - 1] && roots[i] < 1.0) {
        ends[count++] = roots[i];
      }
    }
  }
  ends[count++] = 1.0;
  return count;
}

/* ---- the transfer function on a piece, where it is linear in the value */

typedef struct ramp {
  double at, opacity[2], color[2][3]; /* at: a value of the piece; [0]: there, [1]: slopes */
} ramp;

/* Finds the ramp around a value that is no point of the function. */
static ramp ramp_at(const stratus_transfer* transfer, double value)
{
  ramp r = { .at = value, .opacity = { reference_opacity(transfer, value), 0.0 } };
  reference_color(transfer, value, r.color[0]);
  for (size_t i = 1; i < transfer->opacity_count; ++i) {
    const double *a = transfer->opacity + 2 * (i - 1), *b = a + 2;
    if (value > a[0] && value < b[0]) {
      r.opacity[1] = (b[1] - a[1]) / (b[0] - a[0]);
    }
  }
  for (size_t i = 1; i < transfer->color_count; ++i) {
    const double *a = transfer->color + 4 * (i - 1), *b = a + 4;
    for (int c = 0; c < 3 && value > a[0] && value < b[0]; ++c) {
      r.color[1][c] = (b[1 + c] - a[1 + c]) / (b[0] - a[0]);
    }
  }
  return r;
}

/* ---- quadrature */

/* Gauss's points on 0..1, their weights, and the integrals of their Lagrange polynomials up to each point. */
#define ROOT15 3.872983346207416885
static const double points[3] = { 0.5 - ROOT15 / 10.0, 0.5, 0.5 + ROOT15 / 10.0 };
static const double weights[3] = { 5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0 };
static const double partial[3][3] = { { 5.0 / 36.0, 2.0 / 9.0 - ROOT15 / 15.0, 5.0 / 36.0 - ROOT15 / 30.0 },
  { 5.0 / 36.0 + ROOT15 / 24.0, 2.0 / 9.0, 5.0 / 36.0 - ROOT15 / 24.0 },
  { 5.0 / 36.0 + ROOT15 / 30.0, 2.0 / 9.0 + ROOT15 / 15.0, 5.0 / 36.0 } };

/* Adds a piece a..b of the cubic. length: world length of t = 0..1 over the unit distance. */
static void add_piece(const cubic* q, const ramp* r, double a, double b, double length, int divisions, reference_light* light)
{
  double density[3], total = 0.0, sum = 0.0, rgb[3] = { 0.0, 0.0, 0.0 };
  const double h = (b - a) * length;
  for (int n = 0; n < 3; ++n) {
    const double opacity = r->opacity[0] + (value_of(q, a + points[n] * (b - a)) - r->at) * r->opacity[1];
    density[n] = opacity < 1.0 ? -log1p(-fmax(opacity, 0.0)) : (double)INFINITY;
    total += h * weights[n] * density[n];
  }
  if (total > THICKEST && isfinite(total) && divisions < DIVISIONS) {
    const double middle = 0.5 * (a + b);
    add_piece(q, r, a, middle, length, divisions + 1, light);
    if (light->left > 1e-12) {
      add_piece(q, r, middle, b, length, divisions + 1, light);
    }
    return;
  }
  /* A colour's weight is the light that its point sends out of the piece. The weights' sum is scaled to the opacity, which is more
   * precise. */
  for (int n = 0; n < 3; ++n) {
    const double before = h * (partial[n][0] * density[0] + partial[n][1] * density[1] + partial[n][2] * density[2]);
    const double sent = isfinite(total) ? weights[n] * density[n] * exp(-before) : n == 0 ? 1.0 : 0.0;
    const double rise = value_of(q, a + points[n] * (b - a)) - r->at;
    for (int c = 0; c < 3; ++c) {
      rgb[c] += sent * (r->color[0][c] + rise * r->color[1][c]);
    }
    sum += sent;
  }
  const double kept = -expm1(-total);
  for (int c = 0; c < 3 && sum > 0.0; ++c) {
    light->rgb[c] += light->left * kept * rgb[c] / sum;
  }
  light->left *= exp(-total);
}

/* Adds the part a..b of the cubic, on which the value crosses no point of the function. */
static void add_part(
  const stratus_transfer* transfer, const cubic* q, double a, double b, const reference_line* line, double longest, reference_light* light)
{
  const ramp r = ramp_at(transfer, value_of(q, 0.5 * (a + b)));
  const double all = line->end - line->begin;
  const int count = (int)fmax(1.0, ceil((b - a) * all / longest - 1e-9));
  if (r.opacity[0] <= 0.0 && r.opacity[1] == 0.0) {
    return;
  }
  light->first = fmin(light->first, line->begin + a * all);
  for (int n = 0; n < count && light->left > 1e-12; ++n) {
    const double from = a + (b - a) * n / count, to = a + (b - a) * (n + 1) / count;
    add_piece(q, &r, from, to, all / transfer->unit_distance, 0, light);
  }
}

void reference_add_line(const reference_field* f, const stratus_transfer* transfer, const reference_breaks* breaks,
  const reference_line* line, double longest, reference_cell* cell, reference_light* light)
{
  cubic q;
  double ends[4];
  if (!(line->end > line->begin) || !fit(f, line, cell, &q)) {
    return;
  }
  const int count = monotone_parts(&q, ends);
  for (int n = 0; n + 1 < count && light->left > 1e-12; ++n) {
    const double from = value_of(&q, ends[n]), to = value_of(&q, ends[n + 1]);
    const bool rises = from < to;
    const double low = rises ? from : to, high = rises ? to : from;
    size_t first = 0, last = breaks->count;
    while (first < last && breaks->values[first] <= low) {
      ++first;
    }
    while (last > first && breaks->values[last - 1] >= high) {
      --last;
    }
    double a = ends[n];
    for (size_t i = first; i < last && light->left > 1e-12; ++i) {
      const double b = crossing(&q, a, ends[n + 1], breaks->values[rises ? i : last - 1 - (i - first)]);
      add_part(transfer, &q, a, b, line, longest, light);
      a = b;
    }
    if (light->left > 1e-12) {
      add_part(transfer, &q, a, ends[n + 1], line, longest, light);
    }
  }
}
