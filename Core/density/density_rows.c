/* SPDX-License-Identifier: BSD-3-Clause
 * Sums of weights for bandwidths that reach over few bricks. A voxel's neighbours are read as rows of bits, and a table gives a row's sum
 * of weights. Bricks are in ascending order, and so are the bricks at a fixed offset from them: each row of neighbours has a cursor that
 * only moves forward. */
#include "density_plan.h"

#include <omp.h>
#include <string.h>

#define ROWS_MAX ((2 * DENSITY_REACH_MAX + 1) * (2 * DENSITY_REACH_MAX + 1))
#define CHUNKS 64
#define RADIUS_MAX (STRATUS_BRICK * DENSITY_REACH_MAX)

static int reach_of(double bandwidth, int exact)
{
  /* The nearest voxel of a brick `reach` bricks away is 4 reach - 3 from a brick's last voxel and 4 reach - 1.5 from its middle. */
  const double nearest = exact ? bandwidth + 3.0 : bandwidth + 1.5;
  return nearest >= 4.0 * (DENSITY_REACH_MAX + 1) ? DENSITY_REACH_MAX + 1 : (int)(nearest / 4.0);
}

bool stratus_density_plan_fits(double bandwidth, int exact)
{
  return reach_of(bandwidth, exact) <= DENSITY_REACH_MAX;
}

/* Fills a row's table: for each piece of the window and each pattern of its bits, the sum of the weights of the bits that are set. across:
 * the row's squared distance. */
static void fill_row_table(const density_plan* plan, int across, uint32_t* table)
{
  for (int chunk = 0; chunk < plan->chunks; ++chunk, table += (size_t)1 << plan->width) {
    table[0] = 0;
    for (uint32_t bits = 1; bits < 1u << plan->width; ++bits) {
      const int along = chunk * plan->width + __builtin_ctz(bits) - plan->radius;
      const uint64_t weight = along <= plan->radius ? density_weight((double)(across + along * along), plan->bandwidth) : 0;
      table[bits] = table[bits & (bits - 1)] + (uint32_t)weight;
    }
  }
}

static stratus_status plan_exact(density_plan* plan)
{
  const int radius = plan->radius, side = STRATUS_BRICK * (2 * plan->reach + 1), window = 2 * radius + 1;
  const double limit = plan->bandwidth * plan->bandwidth;
  int32_t slots[2 * RADIUS_MAX * RADIUS_MAX + 1]; /* index of the table of each squared distance across; -1: out of reach */
  void* memory;
  plan->width = window <= 11 ? window : 8; /* tables stay small, and their sums fit 32 bits */
  plan->chunks = (window + plan->width - 1) / plan->width;
  const size_t entries = (size_t)plan->chunks << plan->width;
  int slot_count = 0;
  memset(slots, 0xff, sizeof slots);
  for (int z = -radius; z <= radius; ++z) {
    for (int y = -radius; y <= radius; ++y) {
      const int across = z * z + y * y;
      plan->row_count += (double)across < limit;
      if ((double)across < limit && slots[across] < 0) {
        slots[across] = slot_count++;
      }
    }
  }
  plan->table_size = entries * (size_t)slot_count;
  TRY(stratus_allocate(plan->context, (size_t)plan->row_count, sizeof *plan->rows, &memory));
  plan->rows = memory;
  TRY(stratus_allocate(plan->context, plan->table_size, sizeof *plan->table, &memory));
  plan->table = memory;
  int row = 0;
  for (int across = 0; across <= 2 * RADIUS_MAX * RADIUS_MAX; ++across) {
    if (slots[across] >= 0) {
      fill_row_table(plan, across, plan->table + entries * (size_t)slots[across]);
    }
  }
  for (int z = -radius; z <= radius; ++z) {
    for (int y = -radius; y <= radius; ++y) {
      if ((double)(z * z + y * y) < limit) {
        plan->rows[row++] = (density_row){ z * side + y, (int32_t)entries * slots[z * z + y * y] };
      }
    }
  }
  return STRATUS_OK;
}

/* Returns the mean weight of the 64 places of a brick `d` bricks away, seen from a brick's middle. */
static uint32_t mean_weight(const int d[3], double bandwidth)
{
  uint64_t sum = 0;
  for (int place = 0; place < 64; ++place) {
    const double x = 4 * d[0] + (place & 3) - 1.5, y = 4 * d[1] + (place >> 2 & 3) - 1.5, z = 4 * d[2] + (place >> 4) - 1.5;
    sum += density_weight(x * x + y * y + z * z, bandwidth);
  }
  return (uint32_t)((sum + 32) / 64);
}

static stratus_status plan_binned(density_plan* plan)
{
  const int n = plan->reach + 1;
  void* memory;
  plan->table_size = (size_t)(n * n * n);
  TRY(stratus_allocate(plan->context, plan->table_size, sizeof *plan->table, &memory));
  plan->table = memory;
  for (int i = 0; i < n * n * n; ++i) {
    plan->table[i] = mean_weight((const int[3]){ i % n, i / n % n, i / n / n }, plan->bandwidth);
  }
  return STRATUS_OK;
}

stratus_status stratus_density_plan_create(stratus_context* context, double bandwidth, int exact, density_plan* plan)
{
  *plan = (density_plan){ .context = context, .bandwidth = bandwidth, .exact = exact, .reach = reach_of(bandwidth, exact) };
  plan->radius = (int)ceil(bandwidth) - 1;
  return exact ? plan_exact(plan) : plan_binned(plan);
}

void stratus_density_plan_release(density_plan* plan)
{
  if (plan->context) {
    stratus_release(plan->context, plan->rows);
    stratus_release(plan->context, plan->table);
  }
}

/* ---- sums */

/* Moves the cursor of row (dy, dz) to the first brick in reach and returns its index. *last: key of the last place in reach. */
static inline int64_t first_in_row(
  const stratus_brick* bricks, int64_t count, const stratus_brick* brick, int reach, int dy, int dz, int64_t* cursor, uint64_t* last)
{
  const uint64_t first = density_key(brick->at[0] - reach, brick->at[1] + dy, brick->at[2] + dz);
  int64_t i = *cursor;
  if (i < 0) {
    i = density_first_brick(bricks, count, first);
  }
  while (i < count && density_brick_key(bricks + i) < first) {
    ++i;
  }
  *cursor = i;
  *last = first + 2 * (uint64_t)reach;
  return i;
}

/* Gathers the rows of bits in reach of brick `b`: bit x of rows[z*side + y], counted from the first voxel in reach. */
static void gather_rows(const density_plan* plan, const stratus_brick* bricks, int64_t count, int64_t b, int64_t* cursors, uint64_t* rows)
{
  const int reach = plan->reach, side = STRATUS_BRICK * (2 * reach + 1);
  memset(rows, 0, sizeof *rows * (size_t)(side * side));
  for (int dz = -reach; dz <= reach; ++dz) {
    for (int dy = -reach; dy <= reach; ++dy) {
      uint64_t last;
      uint64_t* const brick_rows = rows + (dz + reach) * STRATUS_BRICK * side + (dy + reach) * STRATUS_BRICK;
      for (int64_t i = first_in_row(bricks, count, bricks + b, reach, dy, dz, cursors++, &last);
           i < count && density_brick_key(bricks + i) <= last; ++i) {
        const int shift = STRATUS_BRICK * (bricks[i].at[0] - bricks[b].at[0] + reach);
        for (int row = 0; row < 16; ++row) {
          brick_rows[(row >> 2) * side + (row & 3)] |= (bricks[i].mask >> (4 * row) & 15) << shift;
        }
      }
    }
  }
}

static void sum_brick(const density_plan* plan, uint64_t mask, const uint64_t* rows, uint64_t* sums)
{
  const int reach = plan->reach, side = STRATUS_BRICK * (2 * reach + 1), width = plan->width;
  const uint64_t window = ((uint64_t)1 << (2 * plan->radius + 1)) - 1, piece = ((uint64_t)1 << width) - 1;
  for (; mask; mask &= mask - 1) {
    const int bit = __builtin_ctzll(mask), shift = STRATUS_BRICK * reach + (bit & 3) - plan->radius;
    const uint64_t* const own = rows + (STRATUS_BRICK * reach + (bit >> 4)) * side + STRATUS_BRICK * reach + (bit >> 2 & 3);
    uint64_t sum = 0;
    for (int r = 0; r < plan->row_count; ++r) {
      const uint32_t* table = plan->table + plan->rows[r].table;
      uint64_t bits = own[plan->rows[r].offset] >> shift & window;
      sum += table[bits & piece];
      for (bits >>= width; bits; bits >>= width) {
        table += (size_t)1 << width;
        sum += table[bits & piece];
      }
    }
    *sums++ = sum;
  }
}

static uint64_t sum_neighbours(const density_plan* plan, const stratus_brick* bricks, int64_t count, int64_t b, int64_t* cursors)
{
  const int reach = plan->reach, n = reach + 1;
  uint64_t sum = 0;
  for (int dz = -reach; dz <= reach; ++dz) {
    for (int dy = -reach; dy <= reach; ++dy) {
      uint64_t last;
      const uint32_t* const weights = plan->table + ((dz < 0 ? -dz : dz) * n + (dy < 0 ? -dy : dy)) * n;
      for (int64_t i = first_in_row(bricks, count, bricks + b, reach, dy, dz, cursors++, &last);
           i < count && density_brick_key(bricks + i) <= last; ++i) {
        const int dx = bricks[i].at[0] - bricks[b].at[0];
        sum += (uint64_t)bricks[i].count * weights[dx < 0 ? -dx : dx];
      }
    }
  }
  return sum;
}

/* Scratch of one thread, allocated because threads' stacks may be small. */
typedef struct room {
  uint64_t rows[DENSITY_SIDE_MAX * DENSITY_SIDE_MAX];
  int64_t cursors[ROWS_MAX];
} room;

stratus_status stratus_density_rows(
  const density_plan* plan, const stratus_brick* bricks, int64_t count, const int64_t* start, uint64_t* sums)
{
  void* memory;
  TRY(stratus_allocate(plan->context, (size_t)plan->context->threads, sizeof(room), &memory));
  room* const rooms = memory;
#pragma omp parallel for schedule(dynamic, 1) num_threads(plan->context->threads) if (count >= DENSITY_PARALLEL)
  for (int chunk = 0; chunk < CHUNKS; ++chunk) {
    uint64_t* const rows = rooms[omp_get_thread_num()].rows;
    int64_t* const cursors = rooms[omp_get_thread_num()].cursors;
    memset(cursors, 0xff, sizeof rooms->cursors);
    for (int64_t b = count * chunk / CHUNKS; b < count * (chunk + 1) / CHUNKS; ++b) {
      if (plan->exact) {
        gather_rows(plan, bricks, count, b, cursors, rows);
        sum_brick(plan, bricks[b].mask, rows, sums + start[b]);
      } else {
        sums[b] = sum_neighbours(plan, bricks, count, b, cursors);
      }
    }
  }
  stratus_release(plan->context, memory);
  return STRATUS_OK;
}
