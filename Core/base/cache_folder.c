/* SPDX-License-Identifier: BSD-3-Clause
 * Finds the cache's folder, and reads and writes files in it. */
#define _POSIX_C_SOURCE 200809L
#include "cache_folder.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define FOLDERS_ABOVE 2 /* are made, too */

bool stratus_cache_find(char path[STRATUS_CACHE_PATH])
{
  static const struct {
    const char *variable, *below;
  } places[] = { { "STRATUS_CACHE_DIR", "" }, { "XDG_CACHE_HOME", "/stratus" }, { "HOME", "/.cache/stratus" } };
  for (size_t i = 0; i < sizeof places / sizeof *places; ++i) {
    const char* value = getenv(places[i].variable);
    if (value && (i == 0 || *value == '/')) { /* users' folders count where they are absolute, as XDG's rules say */
      const int length = snprintf(path, STRATUS_CACHE_PATH, "%s%s", value, places[i].below);
      return *value && length > 0 && length < STRATUS_CACHE_PATH;
    }
  }
  return false;
}

int stratus_cache_open(const char* path, uint64_t* size)
{
  struct stat status;
  const int handle = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK); /* a pipe must not be waited for */
  if (handle >= 0 &&
    (fstat(handle, &status) != 0 || !S_ISREG(status.st_mode) || status.st_uid != geteuid() ||
      (status.st_mode & (S_IWGRP | S_IWOTH)) != 0)) {
    close(handle);
    return -1;
  }
  *size = handle < 0 ? 0 : (uint64_t)status.st_size;
  return handle;
}

bool stratus_cache_read(int handle, void* to, size_t size)
{
  char* bytes = to;
  for (size_t done = 0; done < size;) {
    const ssize_t got = read(handle, bytes + done, size - done);
    if (got <= 0) {
      return false;
    }
    done += (size_t)got;
  }
  return true;
}

static void make_folder(const char* path, int above)
{
  char parent[STRATUS_CACHE_PATH];
  const char* last = strrchr(path, '/');
  if (mkdir(path, S_IRWXU) != 0 && errno == ENOENT && last && above > 0) {
    snprintf(parent, sizeof parent, "%.*s", (int)(last - path), path);
    make_folder(parent, above - 1);
    (void)mkdir(path, S_IRWXU);
  }
}

static bool write_whole(int handle, const stratus_cache_part* part)
{
  const char* bytes = part->bytes;
  for (size_t done = 0; done < part->size;) {
    const ssize_t put = write(handle, bytes + done, part->size - done);
    if (put <= 0) {
      return false;
    }
    done += (size_t)put;
  }
  return true;
}

bool stratus_cache_write(const char* folder, const char* name, const stratus_cache_part* parts, int count)
{
  char path[STRATUS_CACHE_PATH], temporary[STRATUS_CACHE_PATH];
  const int length = snprintf(path, sizeof path, "%s/%s", folder, name),
            longer = snprintf(temporary, sizeof temporary, "%s/%s.XXXXXX", folder, name);
  if (length < 0 || longer >= STRATUS_CACHE_PATH) {
    return false;
  }
  make_folder(folder, FOLDERS_ABOVE);
  const int handle = mkstemp(temporary);
  if (handle < 0) {
    return false;
  }
  bool whole = true;
  for (int i = 0; i < count; ++i) {
    whole = whole && write_whole(handle, parts + i);
  }
  if (close(handle) != 0 || !whole || rename(temporary, path) != 0) {
    (void)unlink(temporary);
    return false;
  }
  return true;
}
