/* SPDX-License-Identifier: BSD-3-Clause
 * One pass of jump flooding on the host, row by row. It gives the same bits as jump_flooding.cl. */
#include "clones.h"
#include "jump_flooding_passes.h"

#include <omp.h>
#include <string.h>

typedef struct flood_pass {
  int64_t n[3];
  flood_layout layout;
  int64_t step;
  const uint32_t* from;
  uint32_t* to;
} flood_pass;

typedef void (*row_function)(const flood_pass* p, int64_t j, int64_t k, void* room, flood_count* count);

#define FLOOD_NAME(name) name##_32_0
#define FLOOD_TARGET
#define LENGTH int32_t
#define ULENGTH uint32_t
#define LENGTH_MAX INT32_MAX
#include "jump_flooding_rows.h"
#define FLOOD_NAME(name) name##_64_0
#define FLOOD_TARGET
#define LENGTH int64_t
#define ULENGTH uint64_t
#define LENGTH_MAX INT64_MAX
#include "jump_flooding_rows.h"
#if HAVE_CLONES
#define FLOOD_NAME(name) name##_32_1
#define FLOOD_TARGET TARGET_AVX2
#define LENGTH int32_t
#define ULENGTH uint32_t
#define LENGTH_MAX INT32_MAX
#include "jump_flooding_rows.h"
#define FLOOD_NAME(name) name##_32_2
#define FLOOD_TARGET TARGET_AVX512
#define LENGTH int32_t
#define ULENGTH uint32_t
#define LENGTH_MAX INT32_MAX
#include "jump_flooding_rows.h"
#endif

static row_function choose_row(const stratus_context* context, int wide)
{
#if HAVE_CLONES
  if (!wide && context->isa >= 1) {
    return context->isa >= 2 ? row_32_2 : row_32_1;
  }
#endif
  (void)context;
  return wide ? row_64_0 : row_32_0;
}

size_t stratus_flood_room_bytes(const int64_t n[3])
{
  return ((size_t)n[0] * 2 * sizeof(int64_t) + 63) / 64 * 64;
}

void stratus_flood_pass(const stratus_context* context, const int64_t n[3], int step, int wide, const uint32_t* from, uint32_t* to,
  unsigned char* rooms, flood_count* count)
{
  flood_pass p = { .layout = flood_shifts(n), .step = step, .from = from, .to = to };
  memcpy(p.n, n, sizeof p.n);
  const row_function row = choose_row(context, wide);
  const int64_t rows = n[1] * n[2];
  const size_t room = stratus_flood_room_bytes(n);
  uint64_t updated = 0, ratios = 0;
#pragma omp parallel num_threads(context->threads) reduction(+ : updated, ratios)
  {
    flood_count mine = { 0, 0 };
    void* my_room = rooms + (size_t)omp_get_thread_num() * room;
#pragma omp for schedule(dynamic, 64)
    for (int64_t r = 0; r < rows; ++r) {
      row(&p, r % n[1], r / n[1], my_room, &mine);
    }
    updated += mine.updated;
    ratios += mine.ratios;
  }
  *count = (flood_count){ updated, ratios };
}
