/* SPDX-License-Identifier: BSD-3-Clause
 * Files of images, against a reader of PNG that knows what the writer may write, and images that cannot be written. */
#define _XOPEN_SOURCE 700
#include "structures.h"

#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#ifdef STRATUS_ZLIB
#include <zlib.h>

enum { WIDE = 37, HIGH = 23 };

static uint32_t big_endian(const uint8_t* b)
{
  return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

/* Reads a file of WIDE x HIGH pixels, the top row first. Returns its channels. */
static int read_png(const char* path, uint8_t pixels[4 * WIDE * HIGH])
{
  static uint8_t file[1 << 16], packed[1 << 16];
  static uint8_t rows[HIGH * (1 + 4 * WIDE)];
  uLongf count = sizeof rows;
  size_t data = 0, at = 8;
  FILE* opened = fopen(path, "rb");
  assert_non_null(opened);
  const size_t bytes = fread(file, 1, sizeof file, opened);
  assert_int_equal(fclose(opened), 0);
  assert_memory_equal(file, "\x89PNG\r\n\x1a\n", 8);
  int channels = 0;
  while (at < bytes) {
    const size_t length = big_endian(file + at);
    const uint8_t *name = file + at + 4, *content = file + at + 8;
    assert_true(at + length + 12 <= bytes);
    assert_int_equal(big_endian(content + length), crc32(0, name, (uInt)length + 4));
    if (memcmp(name, "IHDR", 4) == 0) {
      assert_int_equal(big_endian(content), WIDE);
      assert_int_equal(big_endian(content + 4), HIGH);
      assert_int_equal(content[8], 8);
      assert_true(content[9] == 2 || content[9] == 6);
      channels = content[9] == 6 ? 4 : 3;
    } else if (memcmp(name, "IDAT", 4) == 0) {
      memcpy(packed + data, content, length);
      data += length;
    }
    at += length + 12;
  }
  assert_memory_equal(file + bytes - 8, "IEND", 4);
  assert_int_equal(uncompress(rows, &count, packed, data), Z_OK);
  assert_int_equal(count, HIGH * (1 + channels * WIDE));
  const uint8_t* from = rows;
  for (int row = 0; row < HIGH; ++row) {
    assert_int_equal(*from++, 1); /* differences from the left */
    for (int i = 0; i < channels * WIDE; ++i) {
      uint8_t* to = pixels + row * channels * WIDE + i;
      *to = (uint8_t)(*from++ + (i < channels ? 0 : to[-channels]));
    }
  }
  return channels;
}

static void pixels_are_those_of_the_image(void** state)
{
  (void)state;
  stratus_context* context = make_context("host", 1);
  static float rgba[4 * WIDE * HIGH];
  static uint8_t rgba8[4 * WIDE * HIGH], read[4 * WIDE * HIGH];
  const double background[3] = { 0.25, 0.5, 1.0 };
  char path[] = "/tmp/stratus_image_XXXXXX";
  assert_true(close(mkstemp(path)) == 0);
  for (int i = 0; i < WIDE * HIGH; ++i) { /* premultiplied; the bottom row first */
    const float alpha = (float)(i % WIDE) / (WIDE - 1), color[3] = { (float)(i / WIDE) / HIGH, 0.3f, 1.0f };
    for (int c = 0; c < 4; ++c) {
      rgba[4 * i + c] = c < 3 ? color[c] * alpha : alpha;
      rgba8[4 * i + c] = (uint8_t)(255.0f * rgba[4 * i + c] + 0.5f);
    }
  }
  for (int kind = 0; kind < 2; ++kind) {
    const stratus_image image = { .width = WIDE, .height = HIGH, .rgba = rgba, .rgba8 = kind ? rgba8 : NULL };
    assert_int_equal(stratus_image_write(context, &image, background, path), STRATUS_OK);
    assert_int_equal(read_png(path, read), 3);
    for (int i = 0; i < WIDE * HIGH; ++i) {
      const int from = (HIGH - 1 - i / WIDE) * WIDE + i % WIDE;
      for (int c = 0; c < 3; ++c) {
        const double expected = (double)rgba[4 * from + c] + (1.0 - (double)rgba[4 * from + 3]) * background[c];
        assert_true(fabs(read[3 * i + c] - 255.0 * expected) <= (kind ? 1.6 : 0.51));
      }
    }
    assert_int_equal(stratus_image_write(context, &image, NULL, path), STRATUS_OK);
    assert_int_equal(read_png(path, read), 4);
    for (int i = 0; i < WIDE * HIGH; ++i) {
      const int from = (HIGH - 1 - i / WIDE) * WIDE + i % WIDE, alpha = from % WIDE;
      assert_true(fabs(read[4 * i + 3] - 255.0 * alpha / (WIDE - 1)) <= 0.51);
      if (alpha > WIDE / 2) { /* less transparent bytes keep their colours */
        assert_true(fabs(read[4 * i] - 255.0 * (double)(from / WIDE) / HIGH) <= 1.6);
        assert_int_equal(read[4 * i + 2], 255);
      }
    }
  }
  unlink(path);
  stratus_context_destroy(context);
}

static void what_cannot_be_written_is_an_error(void** state)
{
  (void)state;
  stratus_context* context = make_context("host", 1);
  float pixel[4] = { 0 };
  stratus_image image = { .width = 1, .height = 1, .rgba = pixel };
  const double wrong[3] = { 0.0, 1.5, 0.0 };
  assert_int_equal(stratus_image_write(context, &image, wrong, "/tmp/no.png"), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "background[1] is 1.5, must be in 0..1"));
  assert_int_equal(stratus_image_write(context, &image, NULL, "/no/such/folder/a.png"), STRATUS_FILE_ERROR);
  assert_non_null(strstr(stratus_context_message(context), "cannot write '/no/such/folder/a.png': No such file"));
  char path[] = "/tmp/stratus_image_XXXXXX", part[sizeof path + 5];

  const int file = mkstemp(path);
  assert_int_equal(write(file, "before", 6), 6);
  assert_int_equal(close(file), 0);
  snprintf(part, sizeof part, "%s.part", path);
  struct rlimit limit;
  getrlimit(RLIMIT_FSIZE, &limit);
  const struct rlimit tiny = { 16, limit.rlim_max };
  signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &tiny);
  const stratus_status status = stratus_image_write(context, &image, NULL, path);
  setrlimit(RLIMIT_FSIZE, &limit);
  assert_int_equal(status, STRATUS_FILE_ERROR);
  assert_non_null(strstr(stratus_context_message(context), "File too large"));
  assert_int_equal(access(part, F_OK), -1);
  struct stat was;
  assert_int_equal(stat(path, &was), 0);
  assert_int_equal(was.st_size, 6);
  unlink(path);
  image.width = 0;
  assert_int_equal(stratus_image_write(context, &image, NULL, "/tmp/no.png"), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(access("/tmp/no.png", F_OK), -1);
  stratus_context_destroy(context);
}

struct pipe {
  const char* path;
  size_t read;
};

static void* read_pipe(void* of)
{
  struct pipe* pipe = of;
  char bytes[4096];
  FILE* file = fopen(pipe->path, "rb");
  for (size_t got; file && (got = fread(bytes, 1, sizeof bytes, file)) > 0; pipe->read += got) {}
  return file && fclose(file) == 0 ? pipe : NULL;
}

/* A rename would put a file in the place of a pipe, as of a device, and of a link. */
static void pipes_and_links_stay(void** state)
{
  (void)state;
  stratus_context* context = make_context("host", 1);
  float pixel[4] = { 0 };
  stratus_image image = { .width = 1, .height = 1, .rgba = pixel };
  char folder[] = "/tmp/stratus_image_XXXXXX", path[64], link[64];
  assert_non_null(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/pipe", folder);
  struct pipe pipe = { .path = path };
  struct stat was;
  pthread_t reader;
  void* done = NULL;
  assert_int_equal(mkfifo(path, 0600), 0);
  assert_int_equal(pthread_create(&reader, NULL, read_pipe, &pipe), 0);
  assert_int_equal(stratus_image_write(context, &image, NULL, path), STRATUS_OK);
  assert_int_equal(pthread_join(reader, &done), 0);
  assert_non_null(done);
  assert_true(pipe.read > 50 && stat(path, &was) == 0 && S_ISFIFO(was.st_mode));
  unlink(path);
  snprintf(link, sizeof link, "%s/link", folder);
  for (int i = 0; i < 2; ++i) { /* to nothing, to a file */
    assert_true(i > 0 || symlink("pipe", link) == 0);
    assert_int_equal(stratus_image_write(context, &image, NULL, link), STRATUS_OK);
    assert_true(lstat(link, &was) == 0 && S_ISLNK(was.st_mode));
    assert_true(stat(path, &was) == 0 && S_ISREG(was.st_mode) && (size_t)was.st_size == pipe.read);
  }
  unlink(link);
  unlink(path);
  assert_int_equal(rmdir(folder), 0); /* no part is left */
  stratus_context_destroy(context);
}

#else

static void without_zlib_there_are_none(void** state)
{
  (void)state;
  stratus_context* context = make_context("host", 1);
  float pixel[4] = { 0 };
  const stratus_image image = { .width = 1, .height = 1, .rgba = pixel };
  assert_int_equal(stratus_image_write(context, &image, NULL, "/tmp/no.png"), STRATUS_UNSUPPORTED);
  stratus_context_destroy(context);
}
#endif

int test_image_file(void)
{
  const struct CMUnitTest tests[] = {
#ifdef STRATUS_ZLIB
    cmocka_unit_test(pixels_are_those_of_the_image),
    cmocka_unit_test(what_cannot_be_written_is_an_error),
    cmocka_unit_test(pipes_and_links_stay),
#else
    cmocka_unit_test(without_zlib_there_are_none),
#endif
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
