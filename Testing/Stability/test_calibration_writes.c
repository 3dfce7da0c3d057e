/* SPDX-License-Identifier: BSD-3-Clause
 * The file of measured costs, the only file that the core writes, on a disk that is full from byte n on, for every n, and in folders that
 * accept no file. Readers find the old file or the new one, no other file is left, and the requested costs are measured. */
#define _XOPEN_SOURCE 700
#include "calibration.h"
#include "testing.h"

#include <dirent.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#define FILE_BYTES 4096

typedef struct file_bytes {
  size_t length;
  char text[FILE_BYTES];
} file_bytes;

static char folder[64], path[160];

static int begin(void** state)
{
  (void)state;
  snprintf(folder, sizeof folder, "/tmp/stratus-writes-XXXXXX");
  if (!mkdtemp(folder) || setenv("STRATUS_CACHE_DIR", folder, 1) != 0) {
    return 1;
  }
  snprintf(path, sizeof path, "%s/calibration-1-%s.txt", folder, stratus_version());
  stratus_calibration_forget();
  return 0;
}

static int end(void** state)
{
  (void)state;
  (void)unlink(path);
  stratus_calibration_forget();
  return rmdir(folder); /* fails if a file was left */
}

static file_bytes read_bytes(void)
{
  file_bytes bytes = { .length = 0 };
  FILE* file = fopen(path, "rb");
  if (file) {
    bytes.length = fread(bytes.text, 1, sizeof bytes.text, file);
    fclose(file);
  }
  return bytes;
}

static void write_bytes(const file_bytes* bytes)
{
  FILE* file = fopen(path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(bytes->text, 1, bytes->length, file), bytes->length);
  assert_int_equal(fclose(file), 0);
}

static int files_in_folder(void)
{
  int count = 0;
  DIR* opened = opendir(folder);
  assert_non_null(opened);
  for (const struct dirent* entry = readdir(opened); entry; entry = readdir(opened)) {
    count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
  }
  closedir(opened);
  return count;
}

static void add(const char* part, double number)
{
  stratus_calibration c = stratus_calibration_of("host", part, 2);
  c.numbers[0] = number;
  c.numbers[1] = 2.0 * number;
  stratus_calibration_add(&c);
}

static bool same(const file_bytes* a, const file_bytes* b)
{
  return a->length == b->length && memcmp(a->text, b->text, a->length) == 0;
}

static void a_disk_that_is_full_from_byte_n_on_keeps_the_old_file(void** state)
{
  struct rlimit before;
  int kept = 0, made = 0;
  (void)state;
  add("first", 0.1);
  add("second", 0.7);
  const file_bytes old = read_bytes();
  add("first", 0.05);
  const file_bytes new = read_bytes();
  assert_true(old.length > 40 && new.length < FILE_BYTES && !same(&old, &new));
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
  void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
  for (size_t n = 0; n <= new.length + 1; ++n) {
    const struct rlimit few = { n, before.rlim_max };
    write_bytes(&old);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &few), 0);
    add("first", 0.05);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    const file_bytes now = read_bytes();
    kept += same(&now, &old);
    made += same(&now, &new);
    assert_true(same(&now, n < new.length ? &old : &new));
    assert_int_equal(files_in_folder(), 1);
  }
  signal(SIGXFSZ, handler);
  assert_true(kept == (int)new.length&& made == 2);
}

static stratus_status measure(stratus_context* context, void* job, double* numbers)
{
  (void)context;
  ++*(int*)job;
  numbers[0] = 0.5;
  return STRATUS_OK;
}

/* A file in place of the folder, a folder that takes no files, one that is not there and cannot be, and a folder in the file's place. */
static void a_folder_that_takes_no_file_costs_the_measurement_only(void** state)
{
  static const char* folders[] = { "/dev/null", "/proc", "/proc/nothing/here", "/dev/full/below" };
  (void)state;
  for (size_t i = 0; i < sizeof folders / sizeof *folders + 1; ++i) {
    const bool in_place = i == sizeof folders / sizeof *folders;
    int measured = 0;
    stratus_context* context = NULL;
    stratus_context_options options = stratus_context_options_default();
    options.device = "host";
    assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
    assert_int_equal(setenv("STRATUS_CACHE_DIR", in_place ? folder : folders[i], 1), 0);
    assert_true(!in_place || mkdir(path, 0700) == 0);
    stratus_calibration_forget();
    for (int again = 0; again < 2; ++again) {
      stratus_calibration c = stratus_calibration_of("host", "part", 1);
      assert_int_equal(stratus_calibrate(context, &c, measure, &measured), STRATUS_OK);
      assert_true(c.numbers[0] == 0.5);
    }
    assert_int_equal(measured, 1); /* the process keeps what no file can */
    assert_true(!in_place || (files_in_folder() == 1 && rmdir(path) == 0));
    stratus_context_destroy(context);
  }
  assert_int_equal(setenv("STRATUS_CACHE_DIR", folder, 1), 0);
}

int test_calibration_writes(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup_teardown(a_disk_that_is_full_from_byte_n_on_keeps_the_old_file, begin, end),
    cmocka_unit_test_setup_teardown(a_folder_that_takes_no_file_costs_the_measurement_only, begin, end),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
