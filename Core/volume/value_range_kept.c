/* SPDX-License-Identifier: BSD-3-Clause
 * Keeps the value ranges of volumes that have an identity in files of the cache's folder, so that a later process need not read all values
 * of a large file again. A file has a header, then the least and the greatest value of each block, in the volume's type where that has at
 * most 16 bits and as floats otherwise, then a bit for each block's gaps. A file that does not fit the volume, or whose hash is wrong, is
 * removed. No failure here is an error: the ranges are found again. */
#define _POSIX_C_SOURCE 200809L
#include "value_range_kept.h"

#include "cache_folder.h"
#include "hash.h"

#include <dirent.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define MAGIC "Stratus ranges 1"
#define PREFIX "ranges-"
/* Bytes of all files of ranges. Those that were not used for longest are removed. */
#define BYTES_MOST ((uint64_t)1 << 30)

typedef struct header {
  char magic[16];
  uint64_t key, hash; /* of the bytes behind the header */
  int64_t blocks[3];
  double bias;
  float whole_lo, whole_hi;
} header;

static bool is_kept(const stratus_volume* volume)
{
  return volume->identity != 0 && !volume->point_ghosts && !volume->cell_ghosts;
}

static uint64_t key_of(const stratus_volume* volume, const stratus_value_range* ranges)
{
  uint64_t key = stratus_hash_finish(volume->identity);
  const int64_t numbers[] = { volume->dimensions[0], volume->dimensions[1], volume->dimensions[2], volume->value_stride, volume->type,
    volume->cell_centered != 0, ranges->block_size };
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; ++i) {
    key = stratus_hash_finish(stratus_hash_rotate(key, 21) ^ (uint64_t)numbers[i]);
  }
  return key;
}

static bool name_of(uint64_t key, char folder[STRATUS_CACHE_PATH], char name[64])
{
  snprintf(name, 64, PREFIX "%016" PRIx64, key);
  return stratus_cache_find(folder);
}

static size_t blocks_of(const stratus_value_range* ranges)
{
  return (size_t)ranges->blocks[0] * (size_t)ranges->blocks[1] * (size_t)ranges->blocks[2];
}

/* Bytes of a stored extreme. */
static size_t extreme_bytes(stratus_type type)
{
  const size_t size = stratus_type_size(type);
  return size < sizeof(float) ? size : sizeof(float);
}

static size_t stored_bytes(stratus_type type, size_t blocks)
{
  return 2 * blocks * extreme_bytes(type) + (blocks + 7) / 8;
}

#define EACH(work)                                                                                                                         \
  for (size_t b = 0; b < count; ++b) {                                                                                                     \
    work;                                                                                                                                  \
  }                                                                                                                                        \
  return

static void pack(stratus_type type, const float* from, void* to, size_t count)
{
  switch (type) {
    case STRATUS_INT8:
      EACH(((int8_t*)to)[b] = (int8_t)from[b]);
    case STRATUS_UINT8:
      EACH(((uint8_t*)to)[b] = (uint8_t)from[b]);
    case STRATUS_INT16:
      EACH(((int16_t*)to)[b] = (int16_t)from[b]);
    case STRATUS_UINT16:
      EACH(((uint16_t*)to)[b] = (uint16_t)from[b]);
    default:
      memcpy(to, from, count * sizeof *from);
  }
}

static void unpack(stratus_type type, const void* from, float* to, size_t count)
{
  switch (type) {
    case STRATUS_INT8:
      EACH(to[b] = (float)((const int8_t*)from)[b]);
    case STRATUS_UINT8:
      EACH(to[b] = (float)((const uint8_t*)from)[b]);
    case STRATUS_INT16:
      EACH(to[b] = (float)((const int16_t*)from)[b]);
    case STRATUS_UINT16:
      EACH(to[b] = (float)((const uint16_t*)from)[b]);
    default:
      memcpy(to, from, count * sizeof *to);
  }
}

bool stratus_value_range_recall(const stratus_volume* volume, stratus_value_range* ranges)
{
  char folder[STRATUS_CACHE_PATH], name[64], path[STRATUS_CACHE_PATH + 64];
  header h;
  bool serves = false;
  if (!is_kept(volume)) {
    return false;
  }
  const uint64_t key = key_of(volume, ranges);
  const size_t blocks = blocks_of(ranges), size = stored_bytes(volume->type, blocks), part = blocks * extreme_bytes(volume->type);
  if (!name_of(key, folder, name)) {
    return false;
  }
  snprintf(path, sizeof path, "%s/%s", folder, name);
  uint64_t whole = 0;
  const int handle = stratus_cache_open(path, &whole);
  if (handle < 0) {
    return false;
  }
  uint8_t* bytes = malloc(size);
  if (bytes && whole == sizeof h + size && stratus_cache_read(handle, &h, sizeof h) && stratus_cache_read(handle, bytes, size)) {
    serves = memcmp(h.magic, MAGIC, sizeof h.magic) == 0 && h.key == key && memcmp(h.blocks, ranges->blocks, sizeof h.blocks) == 0 &&
      h.bias == ranges->bias && h.hash == stratus_hash(bytes, size, key);
  }
  if (serves) {
    unpack(volume->type, bytes, ranges->lo, blocks);
    unpack(volume->type, bytes + part, ranges->hi, blocks);
    for (size_t b = 0; b < blocks; ++b) {
      ranges->gaps[b] = bytes[2 * part + b / 8] >> b % 8 & 1;
    }
    ranges->whole_lo = h.whole_lo;
    ranges->whole_hi = h.whole_hi;
    (void)futimens(handle, NULL); /* it was used now */
  } else if (bytes) {
    (void)unlink(path);
    stratus_log(ranges->context, STRATUS_LOG_WARNING, "value ranges kept in %s are damaged or of another version: found again", path);
  }
  free(bytes);
  close(handle);
  return serves;
}

typedef struct kept_file {
  char name[64];
  int64_t used; /* nanoseconds */
  uint64_t size;
} kept_file;

static int older(const void* a, const void* b)
{
  const int64_t x = ((const kept_file*)a)->used, y = ((const kept_file*)b)->used;
  return (x > y) - (x < y);
}

/* Removes files of ranges, those that were not used for longest first, until all have at most BYTES_MOST. */
static void remove_old(const char* folder, const char* newest)
{
  enum { FILES_MOST = 4096 };
  kept_file* files = malloc(FILES_MOST * sizeof *files);
  DIR* listing = files ? opendir(folder) : NULL;
  size_t count = 0;
  uint64_t all = 0;
  for (const struct dirent* entry; listing && count < FILES_MOST && (entry = readdir(listing)) != NULL;) {
    struct stat status;
    kept_file* f = &files[count];
    if (strncmp(entry->d_name, PREFIX, strlen(PREFIX)) == 0 && strlen(entry->d_name) < sizeof f->name &&
      fstatat(dirfd(listing), entry->d_name, &status, 0) == 0) {
      snprintf(f->name, sizeof f->name, "%.63s", entry->d_name);
      f->used = (int64_t)status.st_mtim.tv_sec * 1000000000 + status.st_mtim.tv_nsec;
      f->size = (uint64_t)status.st_size;
      all += f->size;
      ++count;
    }
  }
  if (listing) {
    qsort(files, count, sizeof *files, older);
    for (size_t i = 0; i < count && all > BYTES_MOST; ++i) {
      if (strcmp(files[i].name, newest) != 0 && unlinkat(dirfd(listing), files[i].name, 0) == 0) {
        all -= files[i].size;
      }
    }
    closedir(listing);
  }
  free(files);
}

void stratus_value_range_keep(const stratus_volume* volume, const stratus_value_range* ranges)
{
  char folder[STRATUS_CACHE_PATH], name[64];
  if (!is_kept(volume)) {
    return;
  }
  const uint64_t key = key_of(volume, ranges);
  const size_t blocks = blocks_of(ranges), size = stored_bytes(volume->type, blocks), part = blocks * extreme_bytes(volume->type);
  uint8_t* bytes = size <= BYTES_MOST && name_of(key, folder, name) ? calloc(size, 1) : NULL;
  if (!bytes) {
    return;
  }
  pack(volume->type, ranges->lo, bytes, blocks);
  pack(volume->type, ranges->hi, bytes + part, blocks);
  for (size_t b = 0; b < blocks; ++b) {
    bytes[2 * part + b / 8] |= (uint8_t)((ranges->gaps[b] != 0) << b % 8);
  }
  header h = { .key = key,
    .hash = stratus_hash(bytes, size, key),
    .blocks = { ranges->blocks[0], ranges->blocks[1], ranges->blocks[2] },
    .bias = ranges->bias,
    .whole_lo = ranges->whole_lo,
    .whole_hi = ranges->whole_hi };
  memcpy(h.magic, MAGIC, sizeof h.magic);
  const stratus_cache_part parts[] = { { &h, sizeof h }, { bytes, size } };
  if (stratus_cache_write(folder, name, parts, 2)) {
    remove_old(folder, name);
  }
  free(bytes);
}
