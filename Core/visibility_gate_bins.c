/* SPDX-License-Identifier: BSD-3-Clause
 * Ways out into gaps by what they cover of the view: bins of its sides, one where rays are parallel, the six of a cube around the eye where
 * not. */
#include "visibility_order.h"

#include <string.h>

bool stratus_gate_box(const stratus_gates* gates, int64_t gate, int side, double box[4])
{
  stratus_view_point points[3];
  stratus_gate_points(gates, gate, points);
  unsigned outside = 15;
  bool behind = false;
  box[0] = box[2] = INFINITY;
  box[1] = box[3] = -INFINITY;
  for (int i = 0; i < 3; i++) {
    const double p[3] = { points[i].x, points[i].y, points[i].z };
    const int axis = gates->parallel ? 2 : side / 2;
    const double u = p[(axis + 1) % 3], v = p[(axis + 2) % 3], w = gates->parallel ? 1.0 : side % 2 ? -p[axis] : p[axis];
    if (gates->parallel) {
      outside = 0;
    } else {
      outside &= (unsigned)(u > w) | (unsigned)(-u > w) << 1 | (unsigned)(v > w) << 2 | (unsigned)(-v > w) << 3;
    }
    behind = behind || !(w > 0.0);
    box[0] = fmin(box[0], u / w);
    box[1] = fmax(box[1], u / w);
    box[2] = fmin(box[2], v / w);
    box[3] = fmax(box[3], v / w);
  }
  if (outside != 0) {
    return false;
  }
  for (int i = 0; i < 4 && !gates->parallel; i++) {
    box[i] = behind ? (i % 2 ? 1.0 : -1.0) : fmin(fmax(box[i], -1.0), 1.0);
  }
  return true;
}

void stratus_gate_bins(const stratus_gate_grid* grid, const double box[4], int bins[4])
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
    double all[4] = { INFINITY, -INFINITY, INFINITY, -INFINITY }, box[4];
    int64_t seen = 0;
    for (int64_t g = 0; g < gates->count; g++) {
      if (gates->gates[g].facing > 0 && stratus_gate_box(gates, g, side, box)) {
        seen++;
        for (int i = 0; i < 4; i++) {
          all[i] = i % 2 ? fmax(all[i], box[i]) : fmin(all[i], box[i]);
        }
      }
    }
    grid->size = (int)sqrt((double)(seen / gates->sides));
    grid->size = seen > 0 && grid->size == 0 ? 1 : grid->size;
    for (int a = 0; a < 2; a++) {
      const double extent = all[2 * a + 1] - all[2 * a];
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
    double box[4];
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
    double box[4];
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
