/* SPDX-License-Identifier: BSD-3-Clause
 * Reads and writes the files of built programs, and keeps their sum small. A program is code that will run: only files that this user owns
 * and nobody else may write are read. */
#define _POSIX_C_SOURCE 200809L
#include "program_cache.h"

#include "cache_folder.h"

#include <dirent.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>
#if defined(__x86_64__) || defined(__i386__)
#include <cpuid.h>
#endif

#define FORMAT "1" /* of the files; part of the folder's name */
#define MAGIC 0x31676f7270727473ull
#define ENDING ".program"
#define NAME_MOST 64
#define BINARY_MOST ((uint64_t)64 << 20) /* a file that is larger is not ours */
#define STALE_SECONDS 3600               /* a file that a writer left half written goes after so long */

typedef struct header {
  uint64_t magic, checksum; /* the checksum is of all that follows it */
  uint64_t key_bytes, binary_bytes;
} header;

_Static_assert(sizeof(header) == 32, "a header has no padding");

static size_t limit = STRATUS_PROGRAMS_MOST;

void stratus_program_limit(size_t bytes)
{
  limit = bytes;
}

/* Two lanes of a hash that multiplies and folds eight bytes at a time. It detects damage, not forgery. */
static uint64_t hash(uint64_t h, const void* bytes, size_t size)
{
  const unsigned char* p = bytes;
  h ^= size;
  while (size > 0) {
    const size_t part = size < 8 ? size : 8;
    uint64_t word = 0;
    memcpy(&word, p, part);
    h = (h ^ word) * 0xff51afd7ed558ccdull;
    h ^= h >> 32;
    p += part;
    size -= part;
  }
  return h;
}

/* ---------------------------------------------------------------- keys */

stratus_status stratus_program_folder(stratus_context* context, const char* folder, char* path)
{
  path[0] = '\0';
  if (!folder) {
    char cache[STRATUS_CACHE_PATH];
    const bool found = stratus_cache_find(cache);
    const int length = found ? snprintf(path, STRATUS_CACHE_PATH, "%s/programs-" FORMAT, cache) : 0;
    path[length < STRATUS_CACHE_PATH ? length : 0] = '\0';
    return STRATUS_OK;
  }
  const size_t length = strlen(folder);
  if (length + NAME_MOST >= STRATUS_CACHE_PATH) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "the path of the folder of programs has %zu characters, more than %d", length,
      STRATUS_CACHE_PATH - NAME_MOST - 1);
  }
  memcpy(path, folder, length + 1);
  return STRATUS_OK;
}

bool stratus_programs_are_kept(cl_device_id id)
{
  cl_platform_id platform = NULL;
  char name[256];
  return clGetDeviceInfo(id, CL_DEVICE_PLATFORM, sizeof platform, &platform, NULL) == CL_SUCCESS &&
    clGetPlatformInfo(platform, CL_PLATFORM_NAME, sizeof name, name, NULL) == CL_SUCCESS &&
    strcmp(name, "Portable Computing Language") == 0;
}

/* Write the processor's features. Its name does not show them if a virtual machine hides it, and compilers for it query the features. */
static void processor_features(char* text, size_t capacity)
{
#if defined(__x86_64__) || defined(__i386__)
  unsigned a[4] = { 0 }, b[4] = { 0 };
  (void)__get_cpuid(1, a, a + 1, a + 2, a + 3);
  (void)__get_cpuid_count(7, 0, b, b + 1, b + 2, b + 3);
  snprintf(text, capacity, "%x %x %x %x %x %x", a[0], a[2], a[3], b[1], b[2], b[3]); /* a[1] numbers the core */
#else
  snprintf(text, capacity, "-");
#endif
}

static bool add_line(char* key, size_t* used, const char* text)
{
  const int length = snprintf(key + *used, STRATUS_PROGRAM_KEY - *used, "%s\n", text);
  *used += length > 0 ? (size_t)length : 0;
  return length > 0 && *used < STRATUS_PROGRAM_KEY;
}

bool stratus_program_key(cl_device_id id, const char* text, const char* options, char key[STRATUS_PROGRAM_KEY])
{
  static const cl_device_info device_lines[] = { CL_DEVICE_NAME, CL_DEVICE_VENDOR, CL_DEVICE_VERSION, CL_DRIVER_VERSION };
  static const cl_platform_info platform_lines[] = { CL_PLATFORM_NAME, CL_PLATFORM_VENDOR, CL_PLATFORM_VERSION };
  const size_t length = strlen(text);
  char line[256];
  cl_platform_id platform = NULL;
  cl_device_type type = 0;
  size_t used = 0;
  bool fits = clGetDeviceInfo(id, CL_DEVICE_PLATFORM, sizeof platform, &platform, NULL) == CL_SUCCESS &&
    clGetDeviceInfo(id, CL_DEVICE_TYPE, sizeof type, &type, NULL) == CL_SUCCESS;
  for (size_t i = 0; fits && i < COUNT_OF(platform_lines); ++i) {
    fits = clGetPlatformInfo(platform, platform_lines[i], sizeof line, line, NULL) == CL_SUCCESS && add_line(key, &used, line);
  }
  for (size_t i = 0; fits && i < COUNT_OF(device_lines); ++i) {
    fits = clGetDeviceInfo(id, device_lines[i], sizeof line, line, NULL) == CL_SUCCESS && add_line(key, &used, line);
  }
  snprintf(line, sizeof line, "-");
  if (type & CL_DEVICE_TYPE_CPU) {
    processor_features(line, sizeof line);
  }
  fits = fits && add_line(key, &used, line) && add_line(key, &used, options);
  snprintf(line, sizeof line, "%zu %" PRIx64 " %" PRIx64, length, hash(1, text, length), hash(2, text, length));
  return fits && add_line(key, &used, line);
}

static void name_of(const char* key, char name[NAME_MOST])
{
  const size_t length = strlen(key);
  snprintf(name, NAME_MOST, "%016" PRIx64 "%016" PRIx64 ENDING, hash(3, key, length), hash(4, key, length));
}

static uint64_t checksum(const header* h, const char* key, const void* binary)
{
  const uint64_t sizes[2] = { h->key_bytes, h->binary_bytes };
  return hash(hash(hash(MAGIC, sizes, sizeof sizes), key, (size_t)h->key_bytes), binary, (size_t)h->binary_bytes);
}

/* ---------------------------------------------------------------- files */

/* Whether the file is one of ours for this key, by its header and its size. */
static bool begins_well(int handle, uint64_t size, const char* key, header* h)
{
  char stored[STRATUS_PROGRAM_KEY];
  const size_t length = strlen(key);
  return stratus_cache_read(handle, h, sizeof *h) && h->magic == MAGIC && h->key_bytes == length && h->binary_bytes > 0 &&
    h->binary_bytes <= BINARY_MOST && size == sizeof *h + length + h->binary_bytes && stratus_cache_read(handle, stored, length) &&
    memcmp(stored, key, length) == 0;
}

stratus_status stratus_program_read(stratus_context* context, const char* key, void** binary, size_t* size)
{
  char name[NAME_MOST], path[STRATUS_CACHE_PATH + NAME_MOST];
  header h;
  stratus_status status = STRATUS_OK;
  *binary = NULL;
  if (!*context->program_folder) {
    return STRATUS_OK;
  }
  name_of(key, name);
  snprintf(path, sizeof path, "%s/%s", context->program_folder, name);
  uint64_t whole = 0;
  const int handle = stratus_cache_open(path, &whole);
  if (handle < 0) {
    return STRATUS_OK;
  }
  if (begins_well(handle, whole, key, &h)) {
    status = stratus_allocate(context, (size_t)h.binary_bytes, 1, binary);
    if (status == STRATUS_OK) {
      if (stratus_cache_read(handle, *binary, (size_t)h.binary_bytes) && checksum(&h, key, *binary) == h.checksum) {
        *size = (size_t)h.binary_bytes;
        (void)futimens(handle, NULL); /* it was used now */
      } else {
        stratus_release(context, *binary);
        *binary = NULL;
      }
    }
  }
  close(handle);
  return status;
}

static bool ends_with(const char* name, const char* ending)
{
  const size_t length = strlen(name), end = strlen(ending);
  return length >= end && strcmp(name + length - end, ending) == 0;
}

/* Sums up the folder's programs, and finds the one that was used last longest ago. Removes what writers left half written. */
static size_t look_through(DIR* folder, char oldest[NAME_MOST])
{
  const time_t now = time(NULL);
  struct timespec least = { 0 };
  size_t sum = 0;
  oldest[0] = '\0';
  rewinddir(folder);
  for (const struct dirent* entry = readdir(folder); entry; entry = readdir(folder)) {
    struct stat status;
    const size_t length = strlen(entry->d_name);
    if (!strstr(entry->d_name, ENDING) || length >= NAME_MOST || fstatat(dirfd(folder), entry->d_name, &status, AT_SYMLINK_NOFOLLOW) != 0 ||
      !S_ISREG(status.st_mode)) {
      continue;
    }
    if (!ends_with(entry->d_name, ENDING)) {
      if (now - status.st_mtime > STALE_SECONDS) {
        (void)unlinkat(dirfd(folder), entry->d_name, 0);
      }
      continue;
    }
    sum += (size_t)status.st_size;
    const struct timespec used = status.st_mtim;
    if (!*oldest || used.tv_sec < least.tv_sec || (used.tv_sec == least.tv_sec && used.tv_nsec < least.tv_nsec)) {
      least = used;
      memcpy(oldest, entry->d_name, length + 1);
    }
  }
  return sum;
}

static void make_room(const char* path)
{
  char oldest[NAME_MOST];
  DIR* folder = opendir(path);
  if (!folder) {
    return;
  }
  while (look_through(folder, oldest) > limit && unlinkat(dirfd(folder), oldest, 0) == 0) {}
  closedir(folder);
}

void stratus_program_write(const stratus_context* context, const char* key, const void* binary, size_t size)
{
  char name[NAME_MOST];
  header h = { .magic = MAGIC, .key_bytes = strlen(key), .binary_bytes = size };
  if (!*context->program_folder || size == 0 || size > BINARY_MOST) {
    return;
  }
  h.checksum = checksum(&h, key, binary);
  name_of(key, name);
  const stratus_cache_part parts[] = { { &h, sizeof h }, { key, (size_t)h.key_bytes }, { binary, size } };
  if (stratus_cache_write(context->program_folder, name, parts, (int)COUNT_OF(parts))) {
    make_room(context->program_folder);
  }
}
