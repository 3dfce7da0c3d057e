/* SPDX-License-Identifier: BSD-3-Clause
 * Images as PNG files (ISO/IEC 15948), by zlib. */
#define _XOPEN_SOURCE 700
#include "base.h"
#include "stratus/camera.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#ifdef STRATUS_ZLIB
#include <zlib.h>

#define SIDE_MOST 65536

/* Writes a chunk: its length, its name, its bytes, and their check sum. */
static bool write_chunk(FILE* file, const char* name, const uint8_t* bytes, size_t count)
{
  const uLong of_name = crc32(0, (const Bytef*)name, 4), sum = count > 0 ? crc32(of_name, bytes, (uInt)count) : of_name;
  uint8_t begin[8], end[4];
  for (int i = 0; i < 4; ++i) {
    begin[i] = (uint8_t)(count >> (24 - 8 * i));
    begin[4 + i] = (uint8_t)name[i];
    end[i] = (uint8_t)(sum >> (24 - 8 * i));
  }
  return fwrite(begin, sizeof begin, 1, file) == 1 && (count == 0 || fwrite(bytes, count, 1, file) == 1) &&
    fwrite(end, sizeof end, 1, file) == 1;
}

static uint8_t byte_of(double value)
{
  return (uint8_t)(255.0 * fmin(fmax(value, 0.0), 1.0) + 0.5);
}

/* Gives a pixel over the background, or with its colour as it is without transparency. */
static void convert(const stratus_image* image, size_t pixel, const double background[3], uint8_t* to)
{
  double rgba[4];
  for (int c = 0; c < 4; ++c) {
    rgba[c] = image->rgba8 ? image->rgba8[4 * pixel + (size_t)c] / 255.0 : (double)image->rgba[4 * pixel + (size_t)c];
  }
  for (int c = 0; c < 3; ++c) {
    to[c] = byte_of(background ? rgba[c] + (1.0 - rgba[3]) * background[c] : rgba[3] > 0.0 ? rgba[c] / rgba[3] : 0.0);
  }
  if (!background) {
    to[3] = byte_of(rgba[3]);
  }
}

/* Makes the rows, the top one first, each after a byte that says how it is filtered: as differences from the pixel on the left. */
static void make_rows(const stratus_image* image, const double background[3], size_t channels, uint8_t* to)
{
  uint8_t pixel[4];
  for (int row = image->height - 1; row >= 0; --row) {
    uint8_t before[4] = { 0, 0, 0, 0 };
    *to++ = 1;
    for (int column = 0; column < image->width; ++column) {
      convert(image, (size_t)row * (size_t)image->width + (size_t)column, background, pixel);
      for (size_t c = 0; c < channels; ++c) {
        *to++ = (uint8_t)(pixel[c] - before[c]);
        before[c] = pixel[c];
      }
    }
  }
}

static bool write_file(FILE* file, const stratus_image* image, size_t channels, const uint8_t* bytes, size_t count)
{
  static const uint8_t signature[8] = { 0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n' };
  uint8_t header[13] = { 0 };
  for (int i = 0; i < 4; ++i) {
    header[i] = (uint8_t)(image->width >> (24 - 8 * i));
    header[4 + i] = (uint8_t)(image->height >> (24 - 8 * i));
  }
  header[8] = 8;                     /* bits */
  header[9] = channels == 4 ? 6 : 2; /* colours with or without transparency */
  bool wrote = fwrite(signature, sizeof signature, 1, file) == 1 && write_chunk(file, "IHDR", header, sizeof header);
  for (size_t at = 0; wrote && at < count; at += (size_t)1 << 30) { /* a chunk has less than 2^31 bytes */
    const size_t rest = count - at, most = (size_t)1 << 30;
    wrote = write_chunk(file, "IDAT", bytes + at, rest < most ? rest : most);
  }
  return wrote && write_chunk(file, "IEND", NULL, 0);
}

/* Whether a rename may put the picture at `path`: there is a regular file or nothing yet. A rename would replace a device, a pipe or a file
 * that has no name by a file; these are written in place. Sets *target to the file behind links, to be freed, or to NULL. */
static bool can_be_replaced(const char* path, char** target)
{
  struct stat status, found;
  *target = realpath(path, NULL);
  if (!*target) {
    return lstat(path, &found) != 0;
  }
  return stat(path, &status) == 0 && stat(*target, &found) == 0 && S_ISREG(found.st_mode) && status.st_dev == found.st_dev &&
    status.st_ino == found.st_ino;
}

static stratus_status write_image(stratus_context* context, const stratus_image* image, const double background[3], const char* path)
{
  const size_t channels = background ? 3 : 4, row = 1 + channels * (size_t)image->width, count = row * (size_t)image->height;
  uLongf packed = compressBound(count);
  char* behind = NULL;
  const bool replaced = can_be_replaced(path, &behind);
  const char *target = replaced && behind ? behind : path, *written = target;
  void *rows = NULL, *bytes = NULL, *part = NULL;
  stratus_status status;
  TRY_CLEANUP(stratus_allocate(context, count, 1, &rows));
  TRY_CLEANUP(stratus_allocate(context, packed, 1, &bytes));
  TRY_CLEANUP(stratus_allocate(context, strlen(target) + sizeof ".part", 1, &part));
  make_rows(image, background, channels, rows);
  if (compress2(bytes, &packed, rows, count, Z_BEST_SPEED) != Z_OK) {
    status = stratus_fail(context, STRATUS_OUT_OF_MEMORY, "zlib has no memory for a picture of %zu bytes", count);
    goto cleanup;
  }
  if (replaced) {
    written = strcat(strcpy(part, target), ".part");
  }
  errno = 0;
  FILE* file = fopen(written, "wb");
  const bool wrote = file && write_file(file, image, channels, bytes, packed);
  const bool closed = file && fclose(file) == 0;
  if (!wrote || !closed || (replaced && rename(written, target) != 0)) {
    status = stratus_fail(context, STRATUS_FILE_ERROR, "cannot write '%s': %s", path, strerror(errno));
    if (file && replaced) {
      remove(written);
    }
  }

cleanup:
  free(behind);
  stratus_release(context, part);
  stratus_release(context, bytes);
  stratus_release(context, rows);
  return status;
}
#endif

stratus_status stratus_image_write(stratus_context* context, const stratus_image* image, const double background[3], const char* path)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!image || !path || !(image->rgba || image->rgba8)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "an image file needs an image with pixels, and a path: one of them is NULL");
  }
#ifdef STRATUS_ZLIB
  if (image->width < 1 || image->width > SIDE_MOST || image->height < 1 || image->height > SIDE_MOST) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "image of %d x %d pixels: both must be in 1..%d", image->width, image->height, SIDE_MOST);
  }
  for (int c = 0; background && c < 3; ++c) {
    if (!(background[c] >= 0.0 && background[c] <= 1.0)) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "background[%d] is %g, must be in 0..1", c, background[c]);
    }
  }
  return write_image(context, image, background, path);
#else
  (void)background;
  return stratus_fail(context, STRATUS_UNSUPPORTED, "no image files: the core was built without zlib (Debian: zlib1g-dev)");
#endif
}
