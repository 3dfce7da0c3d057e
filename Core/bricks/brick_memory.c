/* SPDX-License-Identifier: BSD-3-Clause
 * How much memory is free: for the process's control group where that has a limit, as in a container or a batch job, else in the machine.
 * And how much of its limit a pool has left. */
#define _POSIX_C_SOURCE 200809L
#include "bricks.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define PATH_MOST 4096
#define LEAST_LEFT ((uint64_t)32 << 20) /* bytes for bricks, if the limit has so many: rays read parts over and over if few are there */
#define LOOK_MS 10.0                    /* between two looks at the process's memory */

/* Returns the number in a file, or `otherwise` if there is none: a group without a limit says "max". */
static uint64_t number_in(const char* path, uint64_t otherwise)
{
  uint64_t number = otherwise;
  FILE* file = fopen(path, "r");
  if (file) {
    if (fscanf(file, "%" SCNu64, &number) != 1) {
      number = otherwise;
    }
    fclose(file);
  }
  return number;
}

/* Returns the bytes that the machine has free, by its own estimate of what programs can take without others being swapped out. */
static uint64_t free_in_machine(void)
{
  char line[256];
  uint64_t kilobytes = 0;
  FILE* file = fopen("/proc/meminfo", "r");
  while (file && fgets(line, sizeof line, file) && sscanf(line, "MemAvailable: %" SCNu64, &kilobytes) != 1) {}
  if (file) {
    fclose(file);
  }
  if (kilobytes) {
    return kilobytes * 1024;
  }
  const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
  return pages > 0 && page > 0 ? (uint64_t)pages * (uint64_t)page : (uint64_t)1 << 31;
}

/* Returns the least that any of the process's groups has free, or `otherwise`. Pages of files count as used there, although they can go. */
static uint64_t free_in_group(uint64_t otherwise)
{
  char line[PATH_MOST], path[2 * PATH_MOST];
  uint64_t rest = otherwise;
  FILE* file = fopen("/proc/self/cgroup", "r");
  char* group = NULL;
  while (file && !group && fgets(line, sizeof line, file)) {
    group = strncmp(line, "0::", 3) == 0 ? line + 3 : NULL;
  }
  if (file) {
    fclose(file);
  }
  if (!group) {
    return rest;
  }
  group[strcspn(group, "\n")] = '\0';
  for (size_t length = strlen(group);; length = (size_t)(strrchr(group, '/') - group)) {
    group[length] = '\0';
    snprintf(path, sizeof path, "/sys/fs/cgroup%s/memory.max", group);
    const uint64_t most = number_in(path, UINT64_MAX);
    snprintf(path, sizeof path, "/sys/fs/cgroup%s/memory.current", group);
    const uint64_t used = most == UINT64_MAX ? 0 : number_in(path, 0);
    if (most != UINT64_MAX) {
      const uint64_t left = most > used ? most - used : 0;
      rest = left < rest ? left : rest;
    }
    if (!strrchr(group, '/')) {
      return rest;
    }
  }
}

uint64_t stratus_brick_memory_default(void)
{
  return free_in_group(free_in_machine()) / 2;
}

uint64_t stratus_brick_memory_private(void)
{
  uint64_t all = 0, of_files = 0; /* in pages */
  FILE* file = fopen("/proc/self/statm", "r");
  const bool known = file && fscanf(file, "%*u %" SCNu64 " %" SCNu64, &all, &of_files) == 2 && all > of_files;
  if (file) {
    fclose(file);
  }
  return known ? (all - of_files) * (uint64_t)sysconf(_SC_PAGESIZE) : 0;
}

uint64_t stratus_brick_memory_left(stratus_brick_pool* pool)
{
  const double now = pool->whole_process ? stratus_now_ms() : 0.0;
  if (pool->whole_process && now - pool->looked >= LOOK_MS) {
    const uint64_t bytes = stratus_brick_memory_private();
    pool->grown = bytes > pool->began ? bytes - pool->began : 0;
    pool->looked = now;
  }
  const uint64_t half = pool->memory / 2, few = pool->memory < LEAST_LEFT ? pool->memory : LEAST_LEFT, least = half > few ? half : few;
  return pool->grown < pool->memory - least ? pool->memory - pool->grown : least;
}
