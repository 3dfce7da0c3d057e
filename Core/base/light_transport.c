/* SPDX-License-Identifier: BSD-3-Clause
 * Solves the equation of radiative transfer by discrete ordinates. The source of scattered light follows from the mean radiance, and the
 * mean radiance from the source by a sweep, which is linear: (1 - sweep albedo) mean = sweep albedo direct + sky. GMRES (Saad & Schultz
 * 1986) solves this, begun anew after some steps. So many scatterings in thick matter need few sweeps. */
#include "light_transport.h"

#include "instruction_set.h"
#include "tiles.h"

#include <string.h>

#define STEPS 30        /* of GMRES until it begins anew */
#define SWEEPS_MOST 150 /* beyond them, matter of great depth and albedo stays somewhat too dark */
#define GROUPS 6        /* of directions: by the axis that they are swept along, forth and back */

/* Of each octant's ten directions the cosines, by their numbers, and the weights, which together are 1. */
static const double cosines[4] = { 0.2182179, 0.5773503, 0.7867958, 0.9511897 };
static const struct {
  int cosines[3];
  double weight;
} octant_directions[STRATUS_TRANSPORT_DIRECTIONS / 8] = { { { 0, 0, 3 }, 0.1209877 }, { { 0, 3, 0 }, 0.1209877 },
  { { 3, 0, 0 }, 0.1209877 }, { { 0, 1, 2 }, 0.0907407 }, { { 0, 2, 1 }, 0.0907407 }, { { 1, 0, 2 }, 0.0907407 },
  { { 1, 2, 0 }, 0.0907407 }, { { 2, 0, 1 }, 0.0907407 }, { { 2, 1, 0 }, 0.0907407 }, { { 1, 1, 1 }, 0.0925927 } };

/* The cells with vacuum about them, whose last axis is swept. */
typedef struct layout {
  int axes[3], size[3];
  size_t row, plane, count;
  float *extinction, *source, *emission;
} layout;

typedef struct solver {
  stratus_context* context;
  const stratus_transport* medium;
  size_t cells;
  layout layouts[3];
  float *sums[GROUPS], *planes[GROUPS];
  /* of the sweep now: */
  const float* source; /* of each cell */
  bool sky;
  int moment; /* by whose function directions' weights are multiplied; -1: they are not */
  int sweeps;
} solver;

double stratus_transport_direction(int i, double way[3])
{
  for (int axis = 0; axis < 3; ++axis) {
    const double size = cosines[octant_directions[i / 8].cosines[axis]];
    way[axis] = i % 8 >> axis & 1 ? -size : size;
  }
  return octant_directions[i / 8].weight / 8.0;
}

/* ---- a sweep along all directions */

/* The group of a direction: along the axis that it crosses the most planes of. */
static int group_of(const stratus_transport* m, const double way[3])
{
  int most = 0;
  for (int axis = 1; axis < 3; ++axis) {
    most = fabs(way[axis]) / m->spacing[axis] > fabs(way[most]) / m->spacing[most] ? axis : most;
  }
  return 2 * most + (way[most] < 0.0);
}

/* A moment is the mean of the radiance times this function of its direction. */
static double function_of(int moment, const double way[3])
{
  return moment < 0 ? 1.0
    : moment < 3    ? way[moment]
    : moment < 5    ? way[moment - 3] * way[moment - 3] - 1.0 / 3.0
                    : way[moment - 5] * way[(moment - 4) % 3];
}

static void fill_layout(const void* data, int axis, uint64_t counts[STRATUS_TILE_COUNTS])
{
  const solver* s = data;
  const layout* l = &s->layouts[axis];
  const int* n = s->medium->size;
  const size_t stride[3] = { 1, (size_t)n[0], (size_t)n[0] * (size_t)n[1] };
  (void)counts;
  for (int k = 0; k < l->size[2]; ++k) {
    for (int j = 0; j < l->size[1]; ++j) {
      const size_t from = (size_t)k * stride[l->axes[2]] + (size_t)j * stride[l->axes[1]];
      const size_t to = (size_t)(k + 1) * l->plane + (size_t)(j + 1) * l->row + 1;
      for (int i = 0; i < l->size[0]; ++i) {
        const float source = s->source[from + (size_t)i * stride[l->axes[0]]];
        l->source[to + (size_t)i] = source;
        l->emission[to + (size_t)i] = source * l->extinction[to + (size_t)i];
      }
    }
  }
}

static void sweep_group(const void* data, int group, uint64_t counts[STRATUS_TILE_COUNTS])
{
  static void (*const functions[])(const stratus_transport_sweep*) = STRATUS_ISA_EACH(stratus_transport_sweep);
  const solver* s = data;
  const layout* l = &s->layouts[group / 2];
  (void)counts;
  memset(s->sums[group], 0, l->count * sizeof(float));
  for (int i = 0; i < STRATUS_TRANSPORT_DIRECTIONS; ++i) {
    double way[3];
    const double weight = stratus_transport_direction(i, way);
    if (group_of(s->medium, way) != group) {
      continue;
    }
    const int along = l->axes[2];
    stratus_transport_sweep sweep = { .size = { l->size[0], l->size[1], l->size[2] },
      .row = l->row,
      .plane = l->plane,
      .extinction = l->extinction,
      .source = l->source,
      .emission = l->emission,
      .step = (float)(s->medium->spacing[along] / fabs(way[along])),
      .reverse = group & 1,
      .sky = s->sky ? s->medium->sky[i] : 0.0f,
      .weight = (float)(weight * function_of(s->moment, way)),
      .radiance = { s->planes[group], s->planes[group] + l->plane },
      .sum = s->sums[group] };
    for (int a = 0; a < 2; ++a) {
      const int axis = l->axes[a];
      sweep.back[a] = way[axis] > 0.0 ? -1 : 1;
      sweep.part[a] = (float)(fabs(way[axis]) / s->medium->spacing[axis] * s->medium->spacing[along] / fabs(way[along]));
    }
    functions[stratus_isa_at_most(s->context->isa)](&sweep);
  }
}

/* Gathers the groups' sums, in their order. */
static void gather(const solver* s, float* to)
{
  const int* n = s->medium->size;
  memset(to, 0, s->cells * sizeof *to);
  for (int group = 0; group < GROUPS; ++group) {
    const layout* l = &s->layouts[group / 2];
    size_t stride[3];
    for (int a = 0; a < 3; ++a) {
      stride[l->axes[a]] = a == 0 ? 1 : a == 1 ? l->row : l->plane;
    }
    const float* from = s->sums[group] + l->plane + l->row + 1;
    size_t at = 0;
    for (int z = 0; z < n[2]; ++z) {
      for (int y = 0; y < n[1]; ++y) {
        for (int x = 0; x < n[0]; ++x) {
          to[at++] += from[(size_t)x * stride[0] + (size_t)y * stride[1] + (size_t)z * stride[2]];
        }
      }
    }
  }
}

/* to: receives the mean over all directions of the light that the source emits, and of the sky's if it shines. */
static stratus_status sweep(solver* s, const float* source, bool sky, int moment, float* to)
{
  uint64_t counts[STRATUS_TILE_COUNTS];
  s->source = source;
  s->sky = sky;
  s->moment = moment;
  ++s->sweeps;
  TRY(stratus_each_tile(s->context, "scattering", 3, fill_layout, s, counts));
  TRY(stratus_each_tile(s->context, "scattering", GROUPS, sweep_group, s, counts));
  gather(s, to);
  return STRATUS_OK;
}

static stratus_status create_layouts(solver* s)
{
  for (int axis = 0; axis < 3; ++axis) {
    layout* l = &s->layouts[axis];
    void* memory;
    for (int a = 0; a < 3; ++a) {
      l->axes[a] = (axis + 1 + a) % 3;
      l->size[a] = s->medium->size[l->axes[a]];
    }
    l->row = ((size_t)l->size[0] + 2 + STRATUS_TRANSPORT_PAD + 15) / 16 * 16;
    l->plane = l->row * ((size_t)l->size[1] + 2);
    l->count = l->plane * ((size_t)l->size[2] + 2);
    TRY(stratus_allocate_zero(s->context, l->count, 3 * sizeof(float), &memory));
    l->extinction = memory;
    l->source = l->extinction + l->count;
    l->emission = l->source + l->count;
    for (int group = 2 * axis; group < 2 * axis + 2; ++group) {
      TRY(stratus_allocate(s->context, l->count + 2 * l->plane, sizeof(float), &memory));
      s->sums[group] = memory;
      s->planes[group] = s->sums[group] + l->count;
    }
  }
  /* copy the extinction into the layouts, as a source is copied */
  s->source = s->medium->extinction;
  for (int axis = 0; axis < 3; ++axis) {
    uint64_t counts[STRATUS_TILE_COUNTS];
    fill_layout(s, axis, counts);
    memcpy(s->layouts[axis].extinction, s->layouts[axis].source, s->layouts[axis].count * sizeof(float));
  }
  return STRATUS_OK;
}

static void destroy_layouts(solver* s)
{
  for (int axis = 0; axis < 3; ++axis) {
    stratus_release(s->context, s->layouts[axis].extinction);
  }
  for (int group = 0; group < GROUPS; ++group) {
    stratus_release(s->context, s->sums[group]);
  }
}

/* ---- GMRES */

static double dot(const float* a, const float* b, size_t count)
{
  double sum = 0.0;
  for (size_t i = 0; i < count; ++i) {
    sum += (double)a[i] * (double)b[i];
  }
  return sum;
}

/* to += factor from */
static void add(double factor, const float* from, float* to, size_t count)
{
  for (size_t i = 0; i < count; ++i) {
    to[i] += (float)factor * from[i];
  }
}

static void scale(double factor, float* a, size_t count)
{
  for (size_t i = 0; i < count; ++i) {
    a[i] *= (float)factor;
  }
}

/* to = u - sweep albedo u. work: of as many cells. */
static stratus_status apply(solver* s, const float* u, float* work, float* to)
{
  for (size_t i = 0; i < s->cells; ++i) {
    work[i] = s->medium->albedo[i] * u[i];
  }
  TRY(sweep(s, work, false, -1, to));
  for (size_t i = 0; i < s->cells; ++i) {
    to[i] = u[i] - to[i];
  }
  return STRATUS_OK;
}

/* Improves u in at most STEPS steps. basis: STEPS + 1 vectors, the first the residual of u, whose length is `length`. Returns the
 * residual's length by the least squares. */
static stratus_status improve(solver* s, float* basis, double length, double enough, float* work, float* u, double* left)
{
  double h[STEPS + 1][STEPS], turn[STEPS][2], rest[STEPS + 1] = { length }, y[STEPS];
  const size_t n = s->cells;
  int steps = 0;
  scale(1.0 / length, basis, n);
  while (steps < STEPS && fabs(rest[steps]) > enough && s->sweeps < SWEEPS_MOST) {
    const int k = steps++;
    float* next = basis + (size_t)(k + 1) * n;
    TRY(apply(s, basis + (size_t)k * n, work, next));
    for (int i = 0; i <= k; ++i) {
      h[i][k] = dot(basis + (size_t)i * n, next, n);
      add(-h[i][k], basis + (size_t)i * n, next, n);
    }
    h[k + 1][k] = sqrt(dot(next, next, n));
    for (int i = 0; i < k; ++i) {
      const double upper = turn[i][0] * h[i][k] + turn[i][1] * h[i + 1][k];
      h[i + 1][k] = turn[i][0] * h[i + 1][k] - turn[i][1] * h[i][k];
      h[i][k] = upper;
    }
    const double size = sqrt(h[k][k] * h[k][k] + h[k + 1][k] * h[k + 1][k]);
    if (size == 0.0) {
      --steps;
      break;
    }
    turn[k][0] = h[k][k] / size;
    turn[k][1] = h[k + 1][k] / size;
    if (h[k + 1][k] > 0.0) {
      scale(1.0 / h[k + 1][k], next, n);
    }
    h[k][k] = size;
    rest[k + 1] = -turn[k][1] * rest[k];
    rest[k] *= turn[k][0];
  }
  for (int i = steps - 1; i >= 0; --i) {
    y[i] = rest[i];
    for (int k = i + 1; k < steps; ++k) {
      y[i] -= h[i][k] * y[k];
    }
    y[i] /= h[i][i];
    add(y[i], basis + (size_t)i * n, u, n);
  }
  *left = fabs(rest[steps]);
  return STRATUS_OK;
}

static stratus_status solve(solver* s, double tolerance, float* memory, float* mean, float* first, float* moments)
{
  const stratus_transport* m = s->medium;
  const size_t n = s->cells;
  float *right = memory, *work = right + n, *basis = work + n;
  for (size_t i = 0; i < n; ++i) {
    work[i] = m->albedo[i] * m->direct[i];
  }
  TRY(sweep(s, work, true, -1, right));
  const double whole = sqrt(dot(right, right, n)), enough = tolerance * whole;
  memcpy(mean, right, n * sizeof *mean);
  double left = INFINITY;
  while (whole > 0.0 && left > enough && s->sweeps < SWEEPS_MOST) {
    TRY(apply(s, mean, work, basis));
    for (size_t i = 0; i < n; ++i) {
      basis[i] = right[i] - basis[i];
    }
    left = sqrt(dot(basis, basis, n));
    if (left > enough) {
      TRY(improve(s, basis, left, enough, work, mean, &left));
    }
  }
  if (moments) {
    for (size_t i = 0; i < n; ++i) {
      work[i] = m->albedo[i] * m->direct[i];
    }
    TRY(sweep(s, work, false, -1, first));
  }
  for (size_t i = 0; i < n; ++i) { /* a small residual may be below 0 */
    mean[i] = fmaxf(mean[i], 0.0f);
    work[i] = m->albedo[i] * (mean[i] + m->direct[i]);
    if (moments) {
      first[i] = mean[i] > 0.0f ? fminf(first[i] / mean[i], 1.0f) : 0.0f;
    }
  }
  for (int i = 0; i < STRATUS_TRANSPORT_MOMENTS && moments; ++i) {
    TRY(sweep(s, work, true, i, moments + (size_t)i * n));
  }
  return STRATUS_OK;
}

stratus_status stratus_transport_solve(
  stratus_context* context, const stratus_transport* medium, double tolerance, float* mean, float* first, float* moments, int* sweeps)
{
  solver s = { .context = context, .medium = medium };
  void* memory = NULL;
  stratus_status status;
  s.cells = (size_t)medium->size[0] * (size_t)medium->size[1] * (size_t)medium->size[2];
  TRY_CLEANUP(create_layouts(&s));
  TRY_CLEANUP(stratus_allocate(context, s.cells, (STEPS + 3) * sizeof(float), &memory));
  TRY_CLEANUP(solve(&s, tolerance, memory, mean, first, moments));
  *sweeps = s.sweeps;
cleanup:
  stratus_release(context, memory);
  destroy_layouts(&s);
  return status;
}
