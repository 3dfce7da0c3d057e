/* SPDX-License-Identifier: BSD-3-Clause
 * First hits of a batch of rays: chooses the method and distributes the rays over threads. */
#include "first_hit_batch.h"

#include "first_hit_arguments.h"
#include "device.h"

#include <omp.h>
#include <stdatomic.h>
#include <string.h>

/* Finds the hits of one chunk. Returns false if ray *bad of it is unusable. `more` is the number of rays behind the chunk. */
static bool run_chunk(const stratus_hit_batch* batch, const stratus_hit_functions* functions, const stratus_ray* rays, int count,
  size_t more, stratus_hit_chunk* chunk, stratus_hit* hits, int* bad)
{
  if (functions) {
    if (!functions->prepare(batch, rays, count, chunk, bad)) {
      return false;
    }
    chunk->rays = rays;
    chunk->ahead = rays + count;
    chunk->more = more < STRATUS_HIT_CHUNK ? (int)more : STRATUS_HIT_CHUNK;
    chunk->hits = hits;
    functions->walk(batch, chunk);
    functions->finish(batch, rays, chunk, hits);
    return true;
  }
  for (int i = 0; i < count; ++i) {
    if (!stratus_ray_usable(batch->to_voxels, &rays[i])) {
      *bad = i;
      return false;
    }
    stratus_first_hit_exact(batch, &rays[i], &hits[i]);
  }
  return true;
}

static stratus_status run_host(
  stratus_context* context, const stratus_hit_batch* batch, const stratus_ray* rays, size_t count, stratus_hit* hits)
{
  const stratus_hit_functions* functions = stratus_hit_takes_packets(batch) ? stratus_hit_functions_for(context) : NULL;
  const int64_t chunks = (int64_t)((count + STRATUS_HIT_CHUNK - 1) / STRATUS_HIT_CHUNK);
  const int threads = chunks < context->threads ? (int)chunks : context->threads;
  void* memory;
  int64_t worst = INT64_MAX;
  TRY(stratus_allocate(context, (size_t)threads, sizeof(stratus_hit_chunk), &memory));
  stratus_hit_chunk* const room = memory;
#pragma omp parallel num_threads(threads)
  {
    stratus_hit_chunk* const chunk = &room[omp_get_thread_num()];
#pragma omp for schedule(dynamic, 8) reduction(min : worst)
    for (int64_t c = 0; c < chunks; ++c) {
      const size_t first = (size_t)c * STRATUS_HIT_CHUNK, left = count - first;
      int bad = 0;
      const int n = left < STRATUS_HIT_CHUNK ? (int)left : STRATUS_HIT_CHUNK;
      if (!run_chunk(batch, functions, rays + first, n, left - (size_t)n, chunk, hits + first, &bad)) {
        worst = (int64_t)first + bad < worst ? (int64_t)first + bad : worst;
      }
    }
  }
  stratus_release(context, room);
  if (worst != INT64_MAX) {
    return stratus_ray_refuse(context, batch->to_voxels, rays + worst, (size_t)worst);
  }
  return STRATUS_OK;
}

stratus_status stratus_tree_first_hit(
  stratus_context* context, const stratus_tree* tree, const stratus_ray* rays, size_t count, stratus_hit* hits)
{
  stratus_hit_batch batch;
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!tree || (count && (!rays || !hits))) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", !tree ? "tree" : !rays ? "rays" : "hits");
  }
  TRY(stratus_array_check(context, "rays", count, sizeof *rays));
  if (count == 0) {
    return STRATUS_OK;
  }
  stratus_hit_batch_begin(tree, &batch);
  if (context->device && stratus_hit_takes_packets(&batch)) {
    const stratus_status status = stratus_first_hit_device(context, tree, rays, count, hits);
    if (!stratus_device_hands_back(context, status)) {
      return status;
    }
  } else if (context->device) {
    stratus_log(context, STRATUS_LOG_INFO, "first hits: rays are walked on the host, %s",
      batch.slack > 0.05f              ? "for the set is too long for floats"
        : tree->statistics.uncorrected ? "for the tree's distances may be too long"
                                       : "for the tree's boxes may overlap");
  }
  return run_host(context, &batch, rays, count, hits);
}
