/* SPDX-License-Identifier: BSD-3-Clause
 * plume-in-situ SCRIPT [STEPS [FILE]]: a chimney's smoke in a wind that turns, on 97 x 49 x 49 points in slabs along x, one a rank, which
 * draws itself at each step by Catalyst's SCRIPT. FILE gets the last step's values, float32 with x fastest, for comparison. */
#include "adaptor.h"

#include <math.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>

enum { NX = 97, NY = 49, NZ = 49, ROWS = NY * NZ };

/* A rank's slab: points first..last of x, and a point more on either side that its neighbours compute. */
typedef struct slab {
  int rank, ranks, first, last, width; /* width: with the points of neighbours */
  float *now, *next;
} slab;

static float* at(const slab* s, float* values, int x, int y, int z)
{
  return values + (size_t)(z * NY + y) * (size_t)s->width + (x - s->first + 1);
}

static int owner_of_border(int rank, int ranks)
{
  return (NX - 1) * rank / ranks;
}

/* Swaps the planes next to the slab. Both ranks of a border hold its points; each sends its plane next to the border. */
static void swap_borders(const slab* s)
{
  float* planes = malloc(4 * ROWS * sizeof *planes);
  if (!planes) {
    MPI_Abort(MPI_COMM_WORLD, 1);
  }
  const int left = s->rank > 0 ? s->rank - 1 : MPI_PROC_NULL, right = s->rank + 1 < s->ranks ? s->rank + 1 : MPI_PROC_NULL;
  for (int row = 0; row < ROWS; ++row) {
    planes[row] = *at(s, s->now, s->first + 1, row % NY, row / NY);
    planes[ROWS + row] = *at(s, s->now, s->last - 1, row % NY, row / NY);
    planes[2 * ROWS + row] = planes[3 * ROWS + row] = 0.0f; /* outside is clean air */
  }
  MPI_Sendrecv(planes, ROWS, MPI_FLOAT, left, 0, planes + 3 * ROWS, ROWS, MPI_FLOAT, right, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  MPI_Sendrecv(planes + ROWS, ROWS, MPI_FLOAT, right, 1, planes + 2 * ROWS, ROWS, MPI_FLOAT, left, 1, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  for (int row = 0; row < ROWS; ++row) {
    *at(s, s->now, s->first - 1, row % NY, row / NY) = planes[2 * ROWS + row];
    *at(s, s->now, s->last + 1, row % NY, row / NY) = planes[3 * ROWS + row];
  }
  free(planes);
}

static float value_at(const slab* s, int x, int y, int z)
{
  return y < 0 || z < 0 || y >= NY || z >= NZ ? 0.0f : *at(s, s->now, x, y, z);
}

/* A step of the first-order upwind scheme for c_t + v . grad c = k lap c + source; v changes with height and time and is below one cell a
 * step, so that the scheme is stable. */
static void advance(slab* s, double time)
{
  swap_borders(s);
  for (int z = 0; z < NZ; ++z) {
    for (int y = 0; y < NY; ++y) {
      for (int x = s->first; x <= s->last; ++x) {
        const float u = 0.45f + 0.2f * (float)z / NZ, v = 0.15f * (float)sin(0.15 * time + 0.08 * x), w = 0.12f * expf(-0.03f * (float)x);
        const float c = value_at(s, x, y, z), back = value_at(s, x - 1, y, z), ahead = value_at(s, x + 1, y, z);
        const float low = value_at(s, x, y - 1, z), high = value_at(s, x, y + 1, z);
        const float below = value_at(s, x, y, z - 1), above = value_at(s, x, y, z + 1);
        const float moved = u * (c - back) + (v > 0 ? v * (c - low) : v * (high - c)) + w * (c - below);
        const float spread = 0.02f * (back + ahead + low + high + below + above - 6 * c);
        const float dx = (float)(x - 8), dy = (float)(y - NY / 2), dz = (float)(z - 12);
        *at(s, s->next, x, y, z) = c - moved + spread + 0.2f * expf(-(dx * dx + dy * dy + dz * dz) / 6.0f);
      }
    }
  }
  float* old = s->now;
  s->now = s->next;
  s->next = old;
}

static void show(const slab* s, float* own, double time, int step)
{
  const int whole[3] = { NX - 1, NY - 1, NZ - 1 }, count = s->last - s->first + 1;
  for (int row = 0; row < ROWS; ++row) {
    for (int x = 0; x < count; ++x) {
      own[(size_t)row * (size_t)count + (size_t)x] = *at(s, s->now, s->first + x, row % NY, row / NY);
    }
  }
  adaptor_show(whole, s->first, s->last, own, time, step);
}

/* Rank 0 writes what all hold, row by row. */
static int write_whole(const slab* s, const float* own, const char* path)
{
  FILE* file = s->rank == 0 ? fopen(path, "wb") : NULL;
  int* counts = calloc(2 * (size_t)s->ranks, sizeof *counts);
  if (!counts) {
    MPI_Abort(MPI_COMM_WORLD, 1);
  }
  const int count = s->last - s->first + (s->rank + 1 == s->ranks); /* a border's points come from the rank on its right */
  for (int r = 0; r < s->ranks; ++r) {
    counts[s->ranks + r] = owner_of_border(r, s->ranks);
    counts[r] = owner_of_border(r + 1, s->ranks) - counts[s->ranks + r] + (r + 1 == s->ranks);
  }
  float line[NX];
  int good = s->rank != 0 || file;
  for (int row = 0; row < ROWS; ++row) {
    MPI_Gatherv(own + (size_t)row * (size_t)(s->last - s->first + 1), count, MPI_FLOAT, line, counts, counts + s->ranks, MPI_FLOAT, 0,
      MPI_COMM_WORLD);
    good = good && (!file || fwrite(line, sizeof line, 1, file) == 1);
  }
  free(counts);
  return (!file || fclose(file) == 0) && good;
}

int main(int argc, char* argv[])
{
  MPI_Init(&argc, &argv);
  slab s;
  MPI_Comm_rank(MPI_COMM_WORLD, &s.rank);
  MPI_Comm_size(MPI_COMM_WORLD, &s.ranks);
  const int steps = argc > 2 ? atoi(argv[2]) : 150;
  if (argc < 2 || steps < 1 || s.ranks > (NX - 1) / 2) {
    if (s.rank == 0) {
      fprintf(stderr, "plume-in-situ SCRIPT [STEPS [FILE]], on at most %d ranks, with 1 step or more (default 150)\n", (NX - 1) / 2);
    }
    MPI_Finalize();
    return 2;
  }
  s.first = owner_of_border(s.rank, s.ranks);
  s.last = owner_of_border(s.rank + 1, s.ranks);
  s.width = s.last - s.first + 3;
  s.now = calloc((size_t)s.width * ROWS, sizeof *s.now);
  s.next = calloc((size_t)s.width * ROWS, sizeof *s.next);
  float* own = calloc((size_t)(s.width - 2) * ROWS, sizeof *own);
  int status = !s.now || !s.next || !own || adaptor_start(argv[1]);
  MPI_Allreduce(MPI_IN_PLACE, &status, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  if (status) {
    fprintf(stderr, "rank %d: no memory, or Catalyst does not start with %s\n", s.rank, argv[1]);
    MPI_Abort(MPI_COMM_WORLD, 1);
  }
  for (int step = 0; step < steps; ++step) {
    advance(&s, step);
    show(&s, own, step + 1, step);
  }
  if (argc > 3 && !write_whole(&s, own, argv[3])) {
    fprintf(stderr, "%s cannot be written\n", argv[3]);
    status = 1;
  }
  adaptor_end();
  free(s.now);
  free(s.next);
  free(own);
  MPI_Finalize();
  return status;
}
