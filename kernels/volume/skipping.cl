/* SPDX-License-Identifier: BSD-3-Clause
 * The structures by which rays skip blocks: value ranges, occupancy, distance maps. All kernels are one program,
 * because OpenCL on a processor needs longer to start a program than to compile one of them.
 *
 * VALUE: the type of a volume's values. WIDE 1: the value less the bias, computed in double, becomes the float. Only the value ranges
 * depend on VALUE and WIDE. */
#ifndef VALUE
#define VALUE float
#endif
#ifndef WIDE
#define WIDE 0
#endif
#if WIDE
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
typedef double bias_type;
#define FETCH(v) ((float)((double)(v)-bias))
#else
typedef float bias_type; /* 0 */
#define FETCH(v) ((float)(v))
#endif
#pragma OPENCL FP_CONTRACT OFF

/* ---- value ranges
 * The same as Core/volume/value_range.c builds, in two stages. */

typedef struct value_bounds {
  float least, most;
  uchar odd; /* some value is not finite */
} value_bounds;

/* The column of block row (j, k) at x: values (x, j size .. (j+1) size, k size .. (k+1) size), as far as the volume goes. */
static value_bounds column_of(
  __global const VALUE* values, bias_type bias, long nx, long ny, long nz, long stride, long size, long x, long j, long k)
{
  value_bounds b = { INFINITY, -INFINITY, 0 };
  (void)bias; /* narrow types have no bias */
  const long y1 = min((j + 1) * size, ny - 1), z1 = min((k + 1) * size, nz - 1);
  for (long z = k * size; z <= z1; ++z) {
    for (long y = j * size; y <= y1; ++y) {
      const float v = FETCH(values[((z * ny + y) * nx + x) * stride]);
      if (fabs(v) <= FLT_MAX) {
        b.least = v < b.least ? v : b.least;
        b.most = v > b.most ? v : b.most;
      } else {
        b.odd = 1;
      }
    }
  }
  return b;
}

/* Stage 0 reduces, for a row of blocks, each column of values (all y and z of one x), so that neighbouring work items read neighbouring
 * values. Stage 1 then reduces the few columns of each block. Columns are indexed as blocks are, x fastest. One kernel, as of the sweeps of
 * distances below. */
__kernel void value_ranges(int stage, __global const VALUE* values, bias_type bias, long nx, long ny, long nz, long stride, long size,
  long blocks_x, long blocks_y, long blocks_z, __global float* column_lo, __global float* column_hi, __global uchar* column_bad,
  __global float* lo, __global float* hi, __global uchar* gaps)
{
  const long i = (long)get_global_id(0), j = (long)get_global_id(1), k = (long)get_global_id(2), row = k * blocks_y + j;
  if (i >= (stage ? blocks_x : nx) || j >= blocks_y || k >= blocks_z) {
    return;
  }
  if (stage == 0) {
    const value_bounds b = column_of(values, bias, nx, ny, nz, stride, size, i, j, k);
    column_lo[row * nx + i] = b.least;
    column_hi[row * nx + i] = b.most;
    column_bad[row * nx + i] = b.odd;
    return;
  }
  value_bounds b = { INFINITY, -INFINITY, 0 };
  const long x1 = min((i + 1) * size, nx - 1);
  for (long x = i * size; x <= x1; ++x) {
    const long column = row * nx + x;
    b.least = column_lo[column] < b.least ? column_lo[column] : b.least;
    b.most = column_hi[column] > b.most ? column_hi[column] : b.most;
    b.odd |= column_bad[column];
  }
  /* -0 becomes 0, so that the order of comparisons does not show in the bits. */
  lo[row * blocks_x + i] = b.least == 0.0f ? 0.0f : b.least;
  hi[row * blocks_x + i] = b.most == 0.0f ? 0.0f : b.most;
  gaps[row * blocks_x + i] = b.odd;
}

/* ---- occupancy
 *
 * One work item for each block. stratus_occupancy_build() in Core/volume/occupancy.c does the same on the host. */

__kernel void occupancy(__global const float* lo, __global const float* hi, __global const uchar* gaps, __global const float* intervals,
  int interval_count, int gaps_show, ulong count, __global uchar* occupied)
{
  const ulong b = get_global_id(0);
  if (b >= count) {
    return;
  }
  const float from = lo[b], to = hi[b];
  int first = 0, beyond = interval_count; /* the first interval that does not end below the block's range */
  while (first < beyond) {
    const int middle = (first + beyond) / 2;
    if (intervals[2 * middle + 1] < from) {
      first = middle + 1;
    } else {
      beyond = middle;
    }
  }
  const int meets = from <= to && first < interval_count && intervals[2 * first] <= to;
  occupied[b] = (gaps_show && gaps[b]) || meets ? 1 : 0;
}

/* ---- distance maps
 *
 * Distance maps on a device that has thousands of work items to feed. The host's sweeps would leave most of them idle, so every block
 * searches for itself here. Running sums of the occupancy along all axes (Crow 1984) give the number of occupied blocks in a box by eight
 * reads. A block's distance is the half-width of the smallest box about it that holds an occupied block, and a binary search finds it. All
 * octants share the sums.
 *
 * The paper's transform (Deakin & Knackstedt 2019) is below, as the baseline. */
#define DISTANCE_MAX 127
#define DISTANCE_OCCUPIED 128
#define DISTANCE_MAX_PAPER 255

/* sum_x and sum_axis make sums[(K (ny+1) + J) (nx+1) + I] the number of occupied blocks with i < I, j < J, k < K. sum_x runs along x; each
 * work item does one row. */
__kernel void sum_x(__global const uchar* occupied, long nx, long ny, long nz, __global uint* sums)
{
  const long J = (long)get_global_id(0), K = (long)get_global_id(1);
  if (J > ny || K > nz) {
    return;
  }
  __global uint* sum = sums + (K * (ny + 1) + J) * (nx + 1);
  uint running = 0;
  sum[0] = 0;
  for (long i = 0; i < nx; ++i) {
    running += J > 0 && K > 0 ? occupied[((K - 1) * ny + J - 1) * nx + i] : 0;
    sum[i + 1] = running;
  }
}

/* Runs along another axis: `length` sums, `step` apart. Each work item does one line. */
__kernel void sum_axis(__global uint* sums, long n0, long step0, long n1, long step1, long length, long step)
{
  const long a = (long)get_global_id(0), b = (long)get_global_id(1);
  if (a >= n0 || b >= n1) {
    return;
  }
  __global uint* sum = sums + a * step0 + b * step1;
  for (long i = 1; i < length; ++i) {
    sum[i * step] += sum[(i - 1) * step];
  }
}

/* Occupied blocks in [lo, hi). */
static uint count_box(__global const uint* sums, long nx, long ny, const long lo[3], const long hi[3])
{
  const long row = nx + 1, plane = (ny + 1) * row;
  const long y0 = lo[1] * row, y1 = hi[1] * row, z0 = lo[2] * plane, z1 = hi[2] * plane;
  return sums[z1 + y1 + hi[0]] - sums[z1 + y1 + lo[0]] - sums[z1 + y0 + hi[0]] + sums[z1 + y0 + lo[0]] - sums[z0 + y1 + hi[0]] +
    sums[z0 + y1 + lo[0]] + sums[z0 + y0 + hi[0]] - sums[z0 + y0 + lo[0]];
}

/* Returns whether a block of occupancy `target` is within `distance` of `at`. side: along each axis -1 looks below `at`, +1 above, 0 to
 * both sides. */
static int found(__global const uint* sums, const long n[3], const long at[3], const int side[3], long distance, int target)
{
  long lo[3], hi[3];
  for (int a = 0; a < 3; ++a) {
    lo[a] = side[a] > 0 ? at[a] : max(at[a] - distance, 0L);
    hi[a] = (side[a] < 0 ? at[a] : min(at[a] + distance, n[a] - 1)) + 1;
  }
  const uint count = count_box(sums, n[0], n[1], lo, hi);
  return target ? count > 0 : count < (uint)((hi[0] - lo[0]) * (hi[1] - lo[1]) * (hi[2] - lo[2]));
}

/* One map. side_x, side_y, side_z: the octant's sides, or 0 in a map for all directions. */
__kernel void search(__global const uchar* occupied, __global const uint* sums, long nx, long ny, long nz, int side_x, int side_y,
  int side_z, long pitch, __global uchar* bytes)
{
  const long n[3] = { nx, ny, nz };
  const long at[3] = { (long)get_global_id(0), (long)get_global_id(1), (long)get_global_id(2) };
  if (at[0] >= nx || at[1] >= ny || at[2] >= nz) {
    return;
  }
  const long row = at[2] * ny + at[1];
  const int inside = occupied[row * nx + at[0]];
  /* An occupied block's distance to the nearest empty one counts in all directions. */
  const int side[3] = { inside ? 0 : side_x, inside ? 0 : side_y, inside ? 0 : side_z };
  int least = 1, most = DISTANCE_MAX;
  while (least < most) {
    const int middle = (least + most) / 2;
    if (found(sums, n, at, side, middle, !inside)) {
      most = middle;
    } else {
      least = middle + 1;
    }
  }
  bytes[row * pitch + at[0]] = (uchar)(least + (inside ? DISTANCE_OCCUPIED : 0));
}

/* ---- distance maps, for a processor
 * The host's sweeps (Core/volume/distance_sweep.c), 16 blocks at once. Distances to occupied blocks (target 1) and to empty ones (0) each
 * have two arrays, of which one is swept towards +z and one towards -z. Octants have distances along x towards - and towards + in place of
 * the first two. A row has ROW_MARGIN bytes of DISTANCE_MAX at either end; behind
 * its last block, up to the pitch, it has the distances of a wider grid, which change none within. Distances to empty blocks are found in
 * the box (y0, z0) .. (y1, z1), which holds the occupied ones and a layer about them. */
#define ROW_MARGIN 64

/* Where row (j, k) begins. Rows of a plane share the margins between them; planes share none, for items write theirs. */
static long row_at(long pitch, long ny, long j, long k)
{
  return k * (ny * (pitch + ROW_MARGIN) + ROW_MARGIN) + j * (pitch + ROW_MARGIN) + ROW_MARGIN;
}

/* Writes 0 to blocks of occupancy `target`, DISTANCE_MAX to all others of a row and to its margins. Returns how many have it. */
static long seed_row(__global const uchar* occupied, uchar target, long n, long pitch, __global uchar* row)
{
  const uchar16 far = (uchar16)(DISTANCE_MAX);
  long count = 0;
  for (long x = -ROW_MARGIN; x < 0; x += 16) {
    vstore16(far, 0, row + x);
  }
  for (long x = n / 16 * 16; x < pitch + ROW_MARGIN; x += 16) {
    vstore16(far, 0, row + x);
  }
  for (long x = 0; x + 16 <= n; x += 16) {
    const char16 found = vload16(0, occupied + x) == (uchar16)(target);
    const long2 parts = as_long2(found);
    vstore16(select(far, (uchar16)(0), found), 0, row + x);
    count += (long)(popcount((ulong)parts.x) + popcount((ulong)parts.y)) / 8;
  }
  for (long x = n / 16 * 16; x < n; ++x) {
    row[x] = occupied[x] == target ? 0 : DISTANCE_MAX;
    count += occupied[x] == target;
  }
  return count;
}

/* Distances along x of one row, by steps of 1, 2, 4 .. 64. `spare`: a second row. */
static void spread_row(__global const uchar* occupied, uchar target, long n, long pitch, __global uchar* row, __global uchar* spare)
{
  __global uchar *from = row, *to = spare;
  for (int step = 1; step < n && step <= ROW_MARGIN; step *= 2) { /* as many exchanges as there will be: the last step fills `row` */
    __global uchar* swap = from;
    from = to;
    to = swap;
  }
  const long count = seed_row(occupied, target, n, pitch, row);
  if (count == 0 || count == n) {
    return;
  }
  for (long x = -ROW_MARGIN; x < pitch + ROW_MARGIN; x += 16) {
    vstore16(vload16(0, row + x), 0, spare + x);
  }
  for (int step = 1; step < n && step <= ROW_MARGIN; step *= 2) {
    for (long x = 0; x < n; x += 16) {
      const uchar16 neighbours = min(vload16(0, from + x - step), vload16(0, from + x + step)) + (uchar16)((uchar)step);
      vstore16(min(vload16(0, from + x), neighbours), 0, to + x);
    }
    __global uchar* swap = from;
    from = to;
    to = swap;
  }
}

/* Distances along x of one row to occupied blocks on one side, by steps of 1, 2, 4 .. 64. A step reads only blocks that it has not yet
 * changed. */
static void spread_side(__global const uchar* occupied, long n, long pitch, int side, __global uchar* row)
{
  const int some = seed_row(occupied, 1, n, pitch, row) > 0;
  for (int step = 1; some && step < n && step <= ROW_MARGIN; step *= 2) {
    const uchar16 farther = (uchar16)((uchar)step);
    if (side > 0) {
      for (long x = 0; x < n; x += 16) {
        vstore16(min(vload16(0, row + x), vload16(0, row + x + step) + farther), 0, row + x);
      }
    } else {
      for (long x = (n - 1) / 16 * 16; x >= 0; x -= 16) {
        vstore16(min(vload16(0, row + x), vload16(0, row + x - step) + farther), 0, row + x);
      }
    }
  }
}

/* The least of each block and its neighbours along x. */
static uchar16 near_of(__global const uchar* at) { return min(min(vload16(0, at - 1), vload16(0, at)), vload16(0, at + 1)); }

/* row[x] = min(row[x], 1 + the least of before[x - 1 .. x + 1]). */
static void step_row(__global const uchar* before, long n, __global uchar* row)
{
  for (long x = 0; x < n; x += 16) {
    vstore16(min(vload16(0, row + x), near_of(before + x) + (uchar16)(1)), 0, row + x);
  }
}

/* The arrays and extents of a map's sweeps. */
typedef struct sweep {
  __global uchar* of[4]; /* distances to occupied blocks swept up and down, to empty ones up and down */
  long nx, ny, nz, pitch, y0, y1, z0, z1;
  __global uchar* planes; /* octants: for each two planes of ny + 1 rows; 0: a map for all directions */
} sweep;

/* Distances within each plane. One item a plane and target. */
static void sweep_plane(const sweep* s, __global const uchar* occupied, long item)
{
  const long k = item % s->nz, nx = s->nx, ny = s->ny, pitch = s->pitch;
  const int to_empty = item >= s->nz;
  if (item >= 2 * s->nz || (to_empty && (k < s->z0 || k >= s->z1))) {
    return;
  }
  if (s->planes && !to_empty) {
    for (long j = 0; j < ny; ++j) {
      const long at = row_at(pitch, ny, j, k);
      spread_side(occupied + (k * ny + j) * nx, nx, pitch, -1, s->of[0] + at);
      spread_side(occupied + (k * ny + j) * nx, nx, pitch, 1, s->of[1] + at);
    }
    return;
  }
  __global uchar *up = to_empty ? s->of[2] : s->of[0], *down = to_empty ? s->of[3] : s->of[1];
  const long first = to_empty ? s->y0 : 0, beyond = to_empty ? s->y1 : ny, stride = pitch + ROW_MARGIN;
  const long rows = beyond - first, begin = row_at(pitch, ny, first, k);
  for (int back = 0; back < 2; ++back) {
    for (long i = 0; i < rows; ++i) {
      const long j = back ? rows - 1 - i : i, at = begin + j * stride;
      if (!back) {
        spread_row(occupied + (k * ny + first + j) * nx, (uchar)!to_empty, nx, pitch, up + at, down + at);
      }
      if (i > 0) {
        step_row(up + at + (back ? stride : -stride), nx, up + at);
      }
    }
  }
  for (long x = begin - ROW_MARGIN; x < begin + rows * stride; x += 16) {
    vstore16(vload16(0, up + x), 0, down + x);
  }
}

/* The sweeps along z. One item a target and direction: each plane steps from the 3x3 nearest blocks of the plane before. */
static void sweep_planes(const sweep* s, long item)
{
  if (item >= 4 || (s->planes && item < 2)) {
    return;
  }
  const int to_empty = item >= 2, down = (int)item & 1;
  __global uchar* map = item < 2 ? (down ? s->of[1] : s->of[0]) : down ? s->of[3] : s->of[2];
  const long nx = s->nx, ny = s->ny, pitch = s->pitch, first = to_empty ? s->y0 : 0, beyond = to_empty ? s->y1 : ny;
  const long from = to_empty ? s->z0 : 0, to = to_empty ? s->z1 : s->nz;
  const long stride = pitch + ROW_MARGIN;
  for (long i = 1; i < to - from; ++i) {
    const long k = down ? to - 1 - i : from + i;
    for (long j = first; j < beyond; ++j) {
      __global uchar* row = map + row_at(pitch, ny, j, k);
      __global const uchar* before = map + row_at(pitch, ny, j, down ? k + 1 : k - 1);
      const long below = j > first ? -stride : 0, above = j < beyond - 1 ? stride : 0;
      for (long x = 0; x < nx; x += 16) {
        const uchar16 near = min(min(near_of(before + below + x), near_of(before + x)), near_of(before + above + x));
        vstore16(min(vload16(0, row + x), near + (uchar16)(1)), 0, row + x);
      }
    }
  }
}

/* Write the map. An empty block gets its distance to the nearest occupied block; an occupied block gets its mark plus the distance to the
 * nearest empty block. One item per row. */
static void join_rows(const sweep* s, long row, __global uchar* bytes)
{
  const long j = row % s->ny, k = row / s->ny, at = row_at(s->pitch, s->ny, j, k);
  if (k >= s->nz) {
    return;
  }
  /* Otherwise no block of the row is occupied, or all blocks of the grid are. */
  const int in_box = j >= s->y0 && j < s->y1 && k >= s->z0 && k < s->z1;
  for (long x = 0; x < s->nx; x += 16) {
    uchar16 inside = (uchar16)(DISTANCE_MAX);
    if (in_box) {
      inside = min(vload16(0, s->of[2] + at + x), vload16(0, s->of[3] + at + x));
    }
    /* The distance of an occupied block to itself is 0. */
    const uchar16 outside = min(vload16(0, s->of[0] + at + x), vload16(0, s->of[1] + at + x));
    vstore16(select(outside, inside + (uchar16)(DISTANCE_OCCUPIED), outside == (uchar16)(0)), 0, bytes + row * s->pitch + x);
  }
}

/* Distances of occupied blocks, with their marks, where octants look for them. One item a row of the box. */
static void join_empty(const sweep* s, long row)
{
  const long rows = s->y1 - s->y0;
  if (row >= rows * (s->z1 - s->z0)) {
    return;
  }
  const long at = row_at(s->pitch, s->ny, s->y0 + row % rows, s->z0 + row / rows);
  for (long x = 0; x < s->nx; x += 16) {
    const uchar16 least = min(vload16(0, s->of[2] + at + x), vload16(0, s->of[3] + at + x));
    vstore16(least + (uchar16)(DISTANCE_OCCUPIED), 0, s->of[2] + at + x);
  }
}

/* Makes one octant's map. A block's nearest in its octant is along x, or one step nearer to a neighbour in the row, the plane or the row of
 * the plane before. The last row of the item's planes replaces rows beyond the grid. */
static void sweep_octant(const sweep* s, int octant, __global uchar* bytes)
{
  const long nx = s->nx, ny = s->ny, nz = s->nz, stride = s->pitch + ROW_MARGIN, plane = (ny + 1) * stride + ROW_MARGIN;
  const int side = octant & 1 ? 1 : -1, y_up = octant & 2, z_up = octant & 4;
  __global uchar* planes = s->planes + 2 * octant * plane;
  __global const uchar* along = s->of[octant & 1];
  for (long x = 0; x < 2 * plane; x += 16) {
    vstore16((uchar16)(DISTANCE_MAX), 0, planes + x);
  }
  for (long i = 0; i < nz; ++i) {
    const long k = z_up ? nz - 1 - i : i;
    __global uchar* now = planes + (i & 1) * plane + ROW_MARGIN;
    __global const uchar* before = planes + (1 - (i & 1)) * plane + ROW_MARGIN;
    for (long last = ny, n = 0; n < ny; ++n) {
      const long j = y_up ? ny - 1 - n : n, at = row_at(s->pitch, ny, j, k);
      const int in_box = j >= s->y0 && j < s->y1 && k >= s->z0 && k < s->z1;
      __global const uchar *row = now + last * stride, *behind = before + j * stride, *corner = before + last * stride;
      __global uchar *to = now + j * stride, *out = bytes + (((octant * nz) + k) * ny + j) * s->pitch;
      for (long x = 0; x < nx; x += 16) {
        const uchar16 ahead = min(min(vload16(0, row + x), vload16(0, behind + x)), vload16(0, corner + x));
        const uchar16 aside = min(min(vload16(0, row + x + side), vload16(0, behind + x + side)), vload16(0, corner + x + side));
        const uchar16 d = min(vload16(0, along + at + x), min(ahead, aside) + (uchar16)(1));
        uchar16 inside = (uchar16)(DISTANCE_OCCUPIED + DISTANCE_MAX);
        if (in_box) {
          inside = vload16(0, s->of[2] + at + x);
        }
        vstore16(d, 0, to + x);
        vstore16(select(d, inside, d == (uchar16)(0)), 0, out + x);
      }
      last = j;
    }
  }
}

/* The stages, one after the other: one kernel, for each takes a processor's compiler a while to begin with. A map for all directions takes
 * stages 0 to 2, octants 0, 1, 3 and 4. */
__kernel void distance_sweep(int stage, __global const uchar* occupied, long nx, long ny, long nz, long pitch, long y0, long y1, long z0,
  long z1, __global uchar* up_occupied, __global uchar* down_occupied, __global uchar* up_empty, __global uchar* down_empty,
  __global uchar* planes, __global uchar* bytes)
{
  const sweep s = { { up_occupied, down_occupied, up_empty, down_empty }, nx, ny, nz, pitch, y0, y1, z0, z1, planes };
  const long item = (long)get_global_id(0);
  if (stage == 0) {
    sweep_plane(&s, occupied, item);
  } else if (stage == 1) {
    sweep_planes(&s, item);
  } else if (stage == 2) {
    join_rows(&s, item, bytes);
  } else if (stage == 3) {
    join_empty(&s, item);
  } else if (item < 8) {
    sweep_octant(&s, (int)item, bytes);
  }
}

/* ---- the paper's transform */

__kernel void paper_seed(__global const uchar* occupied, ulong count, __global uchar* distance)
{
  const ulong b = get_global_id(0);
  if (b < count) {
    distance[b] = occupied[b] ? 0 : DISTANCE_MAX_PAPER;
  }
}

/* One axis: the least over k of max(|k|, the distance k blocks on), for k below the distance found so far. */
__kernel void paper_axis(__global const uchar* from, long nx, long ny, long nz, int axis, __global uchar* to)
{
  const long at[3] = { (long)get_global_id(0), (long)get_global_id(1), (long)get_global_id(2) };
  if (at[0] >= nx || at[1] >= ny || at[2] >= nz) {
    return;
  }
  const long step = axis == 0 ? 1 : axis == 1 ? nx : nx * ny, n = axis == 0 ? nx : axis == 1 ? ny : nz;
  const long b = (at[2] * ny + at[1]) * nx + at[0];
  int nearest = from[b];
  for (int k = 1; k < nearest; ++k) {
    if (at[axis] >= k) {
      nearest = min(nearest, max(k, (int)from[b - k * step]));
    }
    if (at[axis] + k < n) {
      nearest = min(nearest, max(k, (int)from[b + k * step]));
    }
  }
  to[b] = (uchar)nearest;
}

/* Sets the rows of distances `pitch` apart. */
__kernel void paper_place(__global const uchar* distance, long nx, long rows, long pitch, __global uchar* bytes)
{
  const long i = (long)get_global_id(0), row = (long)get_global_id(1);
  if (i < nx && row < rows) {
    bytes[row * pitch + i] = distance[row * nx + i];
  }
}
