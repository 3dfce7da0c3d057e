/* SPDX-License-Identifier: BSD-3-Clause
 * Ways out into gaps by what they cover of the view: bins of its sides, one where rays are parallel, the six of a cube around the eye where
 * not. */
#include "visibility_order.h"

#include <string.h>

/* Across, down and ahead of a side of the cube. */
static void turn_to(int side, const stratus_view_point* point, double turned[3])
{
  const double p[3] = { point->x, point->y, point->z };
  const int axis = side / 2;
  turned[0] = p[(axis + 1) % 3];
  turned[1] = p[(axis + 2) % 3];
  turned[2] = side % 2 ? -p[axis] : p[axis];
}

/* Sees it if not all points are beyond one of its four edges. */
static bool side_sees(int side, const stratus_view_point points[3])
{
  unsigned outside = 15;
  for (int i = 0; i < 3; i++) {
    double p[3];
    turn_to(side, points + i, p);
    outside &= (unsigned)(p[0] > p[2]) | (unsigned)(-p[0] > p[2]) << 1 | (unsigned)(p[1] > p[2]) << 2 | (unsigned)(-p[1] > p[2]) << 3;
  }
  return outside == 0;
}

static void include(float box[4], double u, double v)
{
  box[0] = fminf(box[0], (float)u);
  box[1] = fmaxf(box[1], (float)u);
  box[2] = fminf(box[2], (float)v);
  box[3] = fmaxf(box[3], (float)v);
}

/* All of the side where a point is not ahead. */
static void find_box(const stratus_gates* gates, int side, const stratus_view_point points[3], float box[4])
{
  box[0] = box[2] = INFINITY;
  box[1] = box[3] = -INFINITY;
  for (int i = 0; i < 3; i++) {
    if (gates->parallel) {
      include(box, points[i].x, points[i].y);
      continue;
    }
    double p[3];
    turn_to(side, points + i, p);
    if (!(p[2] > 0.0)) {
      include(box, -1.0, -1.0);
      include(box, 1.0, 1.0);
      continue;
    }
    include(box, fmin(fmax(p[0] / p[2], -1.0), 1.0), fmin(fmax(p[1] / p[2], -1.0), 1.0));
  }
}

/* The side that sees all of a face and is the only one to, -1 if there is none. */
static int only_side(const stratus_view_point points[3])
{
  const double x = fabs(points->x), y = fabs(points->y), z = fabs(points->z);
  const int side = x > y && x > z ? (points->x > 0.0 ? 0 : 1) : y > z ? (points->y > 0.0 ? 2 : 3) : points->z > 0.0 ? 4 : 5;
  for (int i = 0; i < 3; i++) {
    double p[3];
    turn_to(side, points + i, p);
    if (!(fabs(p[0]) < p[2] && fabs(p[1]) < p[2])) {
      return -1;
    }
  }
  return side;
}

void stratus_gate_see(const stratus_gates* gates, stratus_gate* gate, const stratus_view_point points[3])
{
  const int only = gates->parallel ? 0 : only_side(points);
  int last = only < 0 ? 0 : only;
  gate->sides = (uint8_t)(only < 0 ? 0u : 1u << only);
  for (int side = 0; side < gates->sides && only < 0; side++) {
    if (side_sees(side, points)) {
      gate->sides |= (uint8_t)(1u << side);
      last = side;
    }
  }
  find_box(gates, last, points, gate->box);
}

bool stratus_gate_box(const stratus_gates* gates, int64_t gate, int side, float box[4])
{
  const unsigned sides = gates->gates[gate].sides;
  if (!(sides >> side & 1)) {
    return false;
  }
  if ((sides & (sides - 1)) == 0) {
    memcpy(box, gates->gates[gate].box, sizeof gates->gates[gate].box);
    return true;
  }
  stratus_view_point points[3];
  stratus_gate_points(gates, gate, points);
  find_box(gates, side, points, box);
  return true;
}

void stratus_gate_bins(const stratus_gate_grid* grid, const float box[4], int bins[4])
{
  for (int i = 0; i < 4; i++) {
    const double at = (box[i] - grid->low[i / 2]) * grid->scale[i / 2];
    bins[i] = at > 0.0 ? (at < grid->size ? (int)at : grid->size - 1) : 0;
  }
}

/* A grid for each side that sees a way out: as many bins as gates, or so. */
static void measure_sides(stratus_gates* gates)
{
  for (int side = 0; side < gates->sides; side++) {
    stratus_gate_grid* grid = gates->grids + side;
    float all[4] = { INFINITY, -INFINITY, INFINITY, -INFINITY }, box[4];
    int64_t seen = 0;
    for (int64_t g = 0; g < gates->count; g++) {
      if (gates->gates[g].facing > 0 && stratus_gate_box(gates, g, side, box)) {
        seen++;
        for (int i = 0; i < 4; i++) {
          all[i] = i % 2 ? fmaxf(all[i], box[i]) : fminf(all[i], box[i]);
        }
      }
    }
    grid->size = (int)sqrt((double)(seen / gates->sides));
    grid->size = seen > 0 && grid->size == 0 ? 1 : grid->size;
    for (int a = 0; a < 2; a++) {
      const double extent = (double)all[2 * a + 1] - all[2 * a];
      grid->low[a] = all[2 * a];
      grid->extent[a] = extent > 0.0 ? extent : 1.0;
    }
  }
}

/* Counts gates into bins; false if there are more entries than room. */
static bool count_entries(stratus_gates* gates)
{
  uint32_t bins = 0;
  int64_t total = 0;
  for (int side = 0; side < gates->sides; side++) {
    stratus_gate_grid* grid = gates->grids + side;
    grid->first = bins;
    bins += (uint32_t)(grid->size * grid->size);
    grid->scale[0] = grid->size / grid->extent[0];
    grid->scale[1] = grid->size / grid->extent[1];
  }
  memset(gates->bin_end, 0, (bins + 1) * sizeof *gates->bin_end);
  for (int64_t g = 0; g < gates->count; g++) {
    float box[4];
    int at[4];
    for (int side = 0; side < gates->sides && gates->gates[g].facing > 0; side++) {
      const stratus_gate_grid* grid = gates->grids + side;
      if (grid->size == 0 || !stratus_gate_box(gates, g, side, box)) {
        continue;
      }
      stratus_gate_bins(grid, box, at);
      total += (int64_t)(at[1] - at[0] + 1) * (at[3] - at[2] + 1);
      if (total > STRATUS_GATE_ENTRIES * gates->count) {
        return false;
      }
      for (int v = at[2]; v <= at[3]; v++) {
        for (int u = at[0]; u <= at[1]; u++) {
          gates->bin_end[grid->first + (uint32_t)(v * grid->size + u)]++;
        }
      }
    }
  }
  uint32_t place = 0;
  for (uint32_t b = 0; b < bins; b++) {
    gates->bin_begin[b] = place;
    place += gates->bin_end[b];
    gates->bin_end[b] = gates->bin_begin[b];
  }
  return true;
}

void stratus_gates_fill_bins(stratus_gates* gates)
{
  measure_sides(gates);
  while (!count_entries(gates)) {
    for (int side = 0; side < gates->sides; side++) {
      gates->grids[side].size = (gates->grids[side].size + 1) / 2;
    }
  }
  for (int64_t g = 0; g < gates->count; g++) {
    float box[4];
    int at[4];
    for (int side = 0; side < gates->sides && gates->gates[g].facing > 0; side++) {
      const stratus_gate_grid* grid = gates->grids + side;
      if (grid->size == 0 || !stratus_gate_box(gates, g, side, box)) {
        continue;
      }
      stratus_gate_bins(grid, box, at);
      for (int v = at[2]; v <= at[3]; v++) {
        for (int u = at[0]; u <= at[1]; u++) {
          gates->entries[gates->bin_end[grid->first + (uint32_t)(v * grid->size + u)]++] = (uint32_t)g;
        }
      }
    }
  }
}
