/* SPDX-License-Identifier: BSD-3-Clause
 * The meaning of a volume's ghost flags: the cells that are transparent, and those that another piece draws. */
#include "volume.h"

/* Flags of points and cells in one form. Along a flat axis VTK counts one cell. */
typedef struct ghosts {
  const uint8_t* points; /* NULL if there are none */
  const uint8_t* cells;  /* NULL if there are none */
  int64_t n[3];          /* number of cells */
  int64_t p[3];          /* number of points */
} ghosts;

static ghosts ghosts_of(const stratus_volume* volume)
{
  ghosts g = { .points = volume->cell_centered ? NULL : volume->point_ghosts, .cells = volume->cell_ghosts };
  for (int a = 0; a < 3; ++a) {
    g.p[a] = volume->dimensions[a];
    g.n[a] = volume->cell_centered || volume->dimensions[a] == 1 ? volume->dimensions[a] : volume->dimensions[a] - 1;
  }
  return g;
}

/* Sets *any if a corner of the cell has `flag`, and *all if each corner has it. */
static void corner_flags(const ghosts* g, int64_t i, int64_t j, int64_t k, unsigned flag, bool* any, bool* all)
{
  unsigned some = 0, every = flag;
  for (int64_t z = k; z <= k + 1 && z < g->p[2]; ++z) {
    for (int64_t y = j; y <= j + 1 && y < g->p[1]; ++y) {
      for (int64_t x = i; x <= i + 1 && x < g->p[0]; ++x) {
        const unsigned flags = g->points[(z * g->p[1] + y) * g->p[0] + x];
        some |= flags & flag;
        every &= flags;
      }
    }
  }
  *any = some != 0;
  *all = every != 0;
}

static bool has_flag(const uint8_t* flags, const int64_t n[3], unsigned flag)
{
  const int64_t count = n[0] * n[1] * n[2];
  for (int64_t i = 0; flags && i < count; ++i) {
    if (flags[i] & flag) {
      return true;
    }
  }
  return false;
}

stratus_status stratus_volume_hidden_cells(stratus_context* context, const stratus_volume* volume, uint8_t** hidden)
{
  const ghosts g = ghosts_of(volume);
  const bool points = has_flag(g.points, g.p, STRATUS_GHOST_HIDDEN_POINT);
  const bool cells = has_flag(g.cells, g.n, STRATUS_GHOST_HIDDEN_CELL);
  if (!points && !cells) {
    return STRATUS_OK;
  }
  void* memory;
  TRY(stratus_allocate(context, (size_t)(g.n[0] * g.n[1] * g.n[2]), 1, &memory));
  uint8_t* result = memory;
#pragma omp parallel for schedule(static) num_threads(context->threads)
  for (int64_t k = 0; k < g.n[2]; ++k) {
    for (int64_t j = 0; j < g.n[1]; ++j) {
      for (int64_t i = 0; i < g.n[0]; ++i) {
        const int64_t cell = (k * g.n[1] + j) * g.n[0] + i;
        bool any = false, all = false;
        if (points) {
          corner_flags(&g, i, j, k, STRATUS_GHOST_HIDDEN_POINT, &any, &all);
        }
        result[cell] = any || (cells && g.cells[cell] & STRATUS_GHOST_HIDDEN_CELL);
      }
    }
  }
  *hidden = result;
  return STRATUS_OK;
}

/* Without flags of cells, a cell belongs to another piece only if all its corners do: pieces share the points of their border. */
static bool is_duplicate(const ghosts* g, int64_t i, int64_t j, int64_t k)
{
  if (g->cells) {
    return g->cells[(k * g->n[1] + j) * g->n[0] + i] & STRATUS_GHOST_DUPLICATE;
  }
  bool any, all;
  corner_flags(g, i, j, k, STRATUS_GHOST_DUPLICATE, &any, &all);
  return all;
}

bool stratus_volume_owned(const stratus_volume* volume, int64_t lo[3], int64_t hi[3])
{
  const ghosts g = ghosts_of(volume);
  if (!g.cells && !g.points) {
    for (int a = 0; a < 3; ++a) {
      lo[a] = 0;
      hi[a] = g.n[a];
    }
    return true;
  }
  for (int a = 0; a < 3; ++a) {
    lo[a] = g.n[a];
    hi[a] = 0;
  }
  for (int64_t k = 0; k < g.n[2]; ++k) {
    for (int64_t j = 0; j < g.n[1]; ++j) {
      for (int64_t i = 0; i < g.n[0]; ++i) {
        if (!is_duplicate(&g, i, j, k)) {
          const int64_t at[3] = { i, j, k };
          for (int a = 0; a < 3; ++a) {
            lo[a] = at[a] < lo[a] ? at[a] : lo[a];
            hi[a] = at[a] >= hi[a] ? at[a] + 1 : hi[a];
          }
        }
      }
    }
  }
  if (hi[0] == 0) {
    lo[0] = lo[1] = lo[2] = 0;
  }
  return lo[0] == 0 && lo[1] == 0 && lo[2] == 0 && hi[0] == g.n[0] && hi[1] == g.n[1] && hi[2] == g.n[2];
}
