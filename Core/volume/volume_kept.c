/* SPDX-License-Identifier: BSD-3-Clause
 * Keeps bytes of volumes that have an identity in files of the cache's folder, so that a later process need not read all values of a large
 * file again. A file is a header and the bytes. */
#define _POSIX_C_SOURCE 200809L
#include "volume_kept.h"

#include "cache_folder.h"
#include "hash.h"

#include <dirent.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define MAGIC "Stratus kept 001"
/* Bytes of all files of a kind. */
#define BYTES_MOST ((uint64_t)1 << 30)

typedef struct header {
  char magic[16];
  uint64_t key, hash; /* of the bytes behind the header */
} header;

static uint64_t key_of(const stratus_volume* volume, int64_t number)
{
  uint64_t key = stratus_hash_finish(volume->identity);
  const int64_t numbers[] = { volume->dimensions[0], volume->dimensions[1], volume->dimensions[2], volume->value_stride, volume->type,
    volume->cell_centered != 0, number };
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; ++i) {
    key = stratus_hash_finish(stratus_hash_rotate(key, 21) ^ (uint64_t)numbers[i]);
  }
  return key;
}

/* Gives the folder, if anything can be kept of the volume there. */
static bool find_folder(const stratus_volume* volume, char folder[STRATUS_CACHE_PATH])
{
  return volume->identity != 0 && !volume->point_ghosts && !volume->cell_ghosts && stratus_cache_find(folder);
}

bool stratus_kept_is_possible(const stratus_volume* volume)
{
  char folder[STRATUS_CACHE_PATH];
  return find_folder(volume, folder);
}

static bool name_of(const stratus_volume* volume, const char* kind, uint64_t key, char folder[STRATUS_CACHE_PATH], char name[64])
{
  snprintf(name, 64, "%s-%016" PRIx64, kind, key);
  return find_folder(volume, folder);
}

uint8_t* stratus_kept_recall(stratus_context* context, const stratus_volume* volume, const char* kind, int64_t number, size_t size)
{
  char folder[STRATUS_CACHE_PATH], name[64], path[STRATUS_CACHE_PATH + 64];
  header h;
  const uint64_t key = key_of(volume, number);
  if (!name_of(volume, kind, key, folder, name)) {
    return NULL;
  }
  snprintf(path, sizeof path, "%s/%s", folder, name);
  uint64_t whole = 0;
  const int handle = stratus_cache_open(path, &whole);
  uint8_t* bytes = handle < 0 ? NULL : malloc(size);
  if (bytes) {
    const bool serves = whole == sizeof h + size && stratus_cache_read(handle, &h, sizeof h) && stratus_cache_read(handle, bytes, size) &&
      memcmp(h.magic, MAGIC, sizeof h.magic) == 0 && h.key == key && h.hash == stratus_hash(bytes, size, key);
    if (serves) {
      (void)futimens(handle, NULL); /* it was used now */
    } else {
      (void)unlink(path);
      stratus_log(context, STRATUS_LOG_WARNING, "%s is damaged or of another version: its contents are found again", path);
      free(bytes);
      bytes = NULL;
    }
  }
  if (handle >= 0) {
    close(handle);
  }
  return bytes;
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

/* Removes files of a kind, those that were not used for longest first, until all have at most BYTES_MOST. */
static void remove_old(const char* folder, const char* kind, const char* newest)
{
  enum { FILES_MOST = 4096 };
  kept_file* files = malloc(FILES_MOST * sizeof *files);
  DIR* listing = files ? opendir(folder) : NULL;
  size_t count = 0;
  uint64_t all = 0;
  for (const struct dirent* entry; listing && count < FILES_MOST && (entry = readdir(listing)) != NULL;) {
    struct stat status;
    kept_file* f = &files[count];
    if (strncmp(entry->d_name, kind, strlen(kind)) == 0 && entry->d_name[strlen(kind)] == '-' && strlen(entry->d_name) < sizeof f->name &&
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

void stratus_kept_keep(const stratus_volume* volume, const char* kind, int64_t number, const void* bytes, size_t size)
{
  char folder[STRATUS_CACHE_PATH], name[64];
  const uint64_t key = key_of(volume, number);
  if (size > BYTES_MOST || !name_of(volume, kind, key, folder, name)) {
    return;
  }
  header h = { .key = key, .hash = stratus_hash(bytes, size, key) };
  memcpy(h.magic, MAGIC, sizeof h.magic);
  const stratus_cache_part parts[] = { { &h, sizeof h }, { bytes, size } };
  if (stratus_cache_write(folder, name, parts, 2)) {
    remove_old(folder, kind, name);
  }
}
