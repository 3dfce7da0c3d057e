/* SPDX-License-Identifier: BSD-3-Clause
 * Measured costs: how the process and the file keep them, and wrong lines and files. */
#define _XOPEN_SOURCE 700
#include "calibration.h"
#include "comma_locale.h"
#include "remove_folder.h"

#include <float.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#define PATH 512

static char folder[PATH / 4]; /* of one case */
static stratus_context* host;

static int begin(void** state)
{
  stratus_context_options options = stratus_context_options_default();
  (void)state;
  options.device = "host";
  snprintf(folder, sizeof folder, "/tmp/stratus-calibration-XXXXXX");
  stratus_calibration_forget();
  return stratus_context_create(&options, &host, NULL, 0) != STRATUS_OK || !mkdtemp(folder) || setenv("STRATUS_CACHE_DIR", folder, 1) != 0;
}

static int end(void** state)
{
  (void)state;
  stratus_context_destroy(host);
  return remove_folder(folder);
}

/* The file that the library should use in a folder. */
static void path_in(const char* where, char path[PATH])
{
  snprintf(path, PATH, "%s/calibration-1-%s.txt", where, stratus_version());
}

static bool exists(const char* path)
{
  struct stat status;
  return stat(path, &status) == 0;
}

static void write_text(const char* path, const char* text, size_t length)
{
  FILE* file = fopen(path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(text, 1, length, file), length);
  assert_int_equal(fclose(file), 0);
}

/* Returns what the file has of `part`; processes is 0 if it has nothing. */
static stratus_calibration stored(const char* part, int count)
{
  stratus_calibration calibration = stratus_calibration_of("test", part, count);
  stratus_calibration_read(&calibration);
  return calibration;
}

static void add(const char* part, int count, const double* numbers)
{
  stratus_calibration calibration = stratus_calibration_of("test", part, count);
  memcpy(calibration.numbers, numbers, (size_t)count * sizeof *numbers);
  stratus_calibration_add(&calibration);
}

static void add_one(const char* part, double number)
{
  add(part, 1, &number);
}

/* A measurement for tests: copies `numbers`, returns `status` and counts its calls. */
typedef struct measured {
  int calls, count;
  double numbers[2];
  stratus_status status;
} measured;

static stratus_status copy_numbers(stratus_context* context, void* job, double* numbers)
{
  measured* m = job;
  ++m->calls;
  memcpy(numbers, m->numbers, (size_t)m->count * sizeof *numbers);
  return m->status == STRATUS_OK ? STRATUS_OK : stratus_fail(context, m->status, "fails as the test wants");
}

static void numbers_come_back_bit_by_bit_in_any_locale(void** state)
{
  static const double numbers[STRATUS_CALIBRATION_NUMBERS] = { 0.0, 5e-324, DBL_MIN, 0.1, 1.0 / 3.0, 12345.678, 1e300, DBL_MAX };
  (void)state;
  add("point", STRATUS_CALIBRATION_NUMBERS, numbers);
  const bool commas = comma_locale_begin();
  if (commas) { /* each reads what the other has written */
    add("comma", STRATUS_CALIBRATION_NUMBERS, numbers);
    assert_memory_equal(stored("point", STRATUS_CALIBRATION_NUMBERS).numbers, numbers, sizeof numbers);
  }
  comma_locale_end();
  if (!commas) {
    printf("SKIPPED: no locale with decimal commas (Debian: locales)\n");
    skip();
  }
  const stratus_calibration back = stored("comma", STRATUS_CALIBRATION_NUMBERS);
  assert_int_equal(back.processes, 1);
  assert_memory_equal(back.numbers, numbers, sizeof numbers);
  assert_int_equal(stored("comma", STRATUS_CALIBRATION_NUMBERS - 1).processes, 0);
}

static void three_processes_measure_and_the_least_of_each_number_is_kept(void** state)
{
  static const double measured_by[5][2] = { { 5.0, 3.0 }, { 4.0, 4.0 }, { 6.0, 2.0 }, { 1.0, 1.0 }, { 1.0, 1.0 } };
  static const double least[5][2] = { { 5.0, 3.0 }, { 4.0, 3.0 }, { 4.0, 2.0 }, { 4.0, 2.0 }, { 4.0, 2.0 } };
  (void)state;
  for (int process = 0; process < 5; ++process) {
    measured m = { .count = 2, .numbers = { measured_by[process][0], measured_by[process][1] } };
    stratus_calibration_forget();
    for (int again = 0; again < 2; ++again) { /* a process measures once, whatever the file says */
      stratus_calibration calibration = stratus_calibration_of("test", "part", 2);
      assert_int_equal(stratus_calibrate(host, &calibration, copy_numbers, &m), STRATUS_OK);
      assert_memory_equal(calibration.numbers, least[process], sizeof least[process]);
      assert_int_equal(m.calls, process < 3);
    }
    assert_int_equal(stored("part", 2).processes, process < 3 ? process + 1 : 3);
  }
}

static void without_a_file_the_process_keeps_what_it_measured(void** state)
{
  measured m = { .count = 1, .numbers = { 7.0 } };
  char elsewhere[PATH], file[PATH];
  (void)state;
  snprintf(elsewhere, sizeof elsewhere, "%s/home", folder);
  snprintf(file, sizeof file, "%s/file", folder);
  write_text(file, "", 0);
  setenv("HOME", elsewhere, 1);
  setenv("XDG_CACHE_HOME", elsewhere, 1);
  const char* const none[] = { "", strcat(file, "/below") }; /* nobody can make a folder below a file */
  for (int i = 0; i < 2; ++i) {
    setenv("STRATUS_CACHE_DIR", none[i], 1);
    for (int process = 0; process < 4; ++process) {
      stratus_calibration_forget();
      for (int again = 0; again < 2; ++again) {
        stratus_calibration calibration = stratus_calibration_of("test", "part", 1);
        assert_int_equal(stratus_calibrate(host, &calibration, copy_numbers, &m), STRATUS_OK);
        assert_true(calibration.numbers[0] == 7.0);
        assert_int_equal(m.calls, 4 * i + process + 1);
      }
    }
  }
  assert_false(exists(elsewhere));
}

static void folders_are_taken_in_order_and_made(void** state)
{
  static const struct {
    const char *own, *users, *home, *expected; /* below the case's folder; NULL: not set */
  } cases[] = {
    { "a/b", "c", "d", "a/b" },
    { NULL, "e", "d", "e/stratus" },
    { NULL, NULL, "", ".cache/stratus" },
  };
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    const char* const names[] = { "STRATUS_CACHE_DIR", "XDG_CACHE_HOME", "HOME" };
    const char* const values[] = { cases[i].own, cases[i].users, cases[i].home };
    char path[PATH], where[PATH / 2];
    for (int j = 0; j < 3; ++j) {
      snprintf(path, sizeof path, "%s/%s", folder, values[j] ? values[j] : "");
      assert_int_equal(values[j] ? setenv(names[j], path, 1) : unsetenv(names[j]), 0);
    }
    add_one("part", 1.0);
    snprintf(where, sizeof where, "%s/%s", folder, cases[i].expected);
    path_in(where, path);
    assert_true(exists(path));
    assert_int_equal(stored("part", 1).processes, 1);
  }
  setenv("XDG_CACHE_HOME", "relative", 1); /* it does not count, and HOME does */
  assert_int_equal(stored("part", 1).processes, 1);
  unsetenv("XDG_CACHE_HOME");
  unsetenv("HOME");
  assert_int_equal(stored("part", 1).processes, 0);
}

static void another_version_s_file_is_not_read(void** state)
{
  char own[PATH], other[PATH];
  (void)state;
  add_one("part", 1.0);
  path_in(folder, own);
  assert_true(exists(own));
  snprintf(other, sizeof other, "%s/calibration-1-0.0.9.txt", folder);
  assert_int_equal(rename(own, other), 0);
  assert_int_equal(stored("part", 1).processes, 0);
  add_one("part", 2.0);
  assert_true(stored("part", 1).numbers[0] == 2.0);
  assert_true(exists(other));
}

static void lines_that_are_none_are_ignored_and_go(void** state)
{
  /* Each would be a line of "bad" with one number, but for its one fault. */
  static const char* const bad[] = { "test: bad", "test: bad\t", "test: bad\t1", "test: bad\t1\t", "test: bad\t1\tnan", "test: bad\t1\tinf",
    "test: bad\t1\t-0x1p0", "test: bad\t1\t0x", "test: bad\t1\t0x1p2000", "test: bad\t1\t1.5", "test: bad\t1\t0x1p0 ",
    "test: bad\t1\t0x1p0\t", "test: bad\t0\t0x1p0", "test: bad\t4\t0x1p0", "test: bad\t-1\t0x1p0", "test: bad\t11\t0x1p0",
    "test: bad \t1\t0x1p0", "test: bad\t1 0x1p0", "test: bad\t1\t0x1p0\t0x1p0", "test: bad\t1\t0x1\t0x1\t0x1\t0x1\t0x1\t0x1\t0x1\t0x1\t0x1",
    "\t1\t0x1p0", "", "\x80\xff", "test: bad\t1\t0x1p0\r" };
  char text[8192], path[PATH];
  size_t used = 0;
  (void)state;
  path_in(folder, path);
  for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
    used += (size_t)snprintf(text + used, sizeof text - used, "%s\n", bad[i]);
  }
  memcpy(text + used, "test: bad\t1\t0x1p0\0\n", 20);
  used += 20;
  memset(text + used, 'x', 2000); /* a line that is too long, whose end would do */
  memcpy(text + used + 2000, "test: bad\t1\t0x1p0\n", 18);
  used += 2018;
  used += (size_t)snprintf(text + used, sizeof text - used, "test: good\t2\t0x3p-1\ntest: bad\t1\t0x1p0"); /* the last was cut */
  write_text(path, text, used);
  assert_int_equal(stored("bad", 1).processes, 0);
  const stratus_calibration good = stored("good", 1);
  assert_int_equal(good.processes, 2);
  assert_true(good.numbers[0] == 1.5);

  static const char expected[] = "test: bad \t1\t0x10000000000000p-52\n"
                                 "test: bad\t1\t0x10000000000000p-52\t0x10000000000000p-52\n"
                                 "\t1\t0x10000000000000p-52\n"
                                 "test: good\t2\t0x18000000000000p-52\n"
                                 "test: more\t1\t0x10000000000000p-51\n";
  add_one("more", 2.0);
  FILE* file = fopen(path, "rb");
  assert_non_null(file);
  used = fread(text, 1, sizeof text - 1, file);
  fclose(file);
  text[used] = '\0';
  assert_string_equal(text, expected);
}

static void what_is_no_file_of_ours_is_not_read(void** state)
{
  static char text[20000];
  char path[PATH];
  (void)state;
  path_in(folder, path);
  for (size_t i = 0; i + 20 < sizeof text; i += 20) {
    memcpy(text + i, "test: part\t1\t0x01p0\n", 20);
  }
  write_text(path, text, 16380);
  assert_int_equal(stored("part", 1).processes, 1);
  write_text(path, text, 16400);
  assert_int_equal(stored("part", 1).processes, 0);
  add_one("part", 3.0);
  assert_true(stored("part", 1).numbers[0] == 3.0);
  assert_int_equal(remove(path), 0);
  assert_int_equal(mkfifo(path, S_IRWXU), 0); /* nobody writes to it: who waits for it waits for ever */
  assert_int_equal(stored("part", 1).processes, 0);
  assert_int_equal(remove(path), 0);
  assert_int_equal(mkdir(path, S_IRWXU), 0);
  assert_int_equal(stored("part", 1).processes, 0);
  add_one("part", 3.0);
  assert_int_equal(stored("part", 1).processes, 0);
}

static void the_file_does_not_grow_without_end(void** state)
{
  char part[32], path[PATH];
  struct stat status;
  (void)state;
  path_in(folder, path);
  for (int i = 0; i < 500; ++i) {
    snprintf(part, sizeof part, "number %d", i);
    add(part, 2, (const double[]){ i, 1.0 });
    assert_int_equal(stored(part, 2).processes, 1);
  }
  assert_int_equal(stat(path, &status), 0);
  assert_true(status.st_size > 15000 && status.st_size <= 16384);
  assert_int_equal(stored("number 0", 2).processes, 0);
  assert_true(stored("number 400", 2).numbers[0] == 400.0);
}

static void a_name_may_hold_anything(void** state)
{
  static const char* const parts[] = { "a\tb", "a\nb\t3\t0x1p0\n", "caf\xc3\xa9", "", " " };
  char longest[1000];
  (void)state;
  memset(longest, 'x', sizeof longest);
  longest[sizeof longest - 1] = '\0';
  for (size_t i = 0; i <= sizeof parts / sizeof *parts; ++i) {
    const char* part = i < sizeof parts / sizeof *parts ? parts[i] : longest;
    add_one(part, (double)i + 1.0);
    assert_true(stored(part, 1).numbers[0] == (double)i + 1.0);
    assert_int_equal(stored(part, 1).processes, 1);
  }
}

static void a_measurement_that_fails_is_reported_and_not_stored(void** state)
{
  measured m = { .count = 1, .status = STRATUS_DEVICE_ERROR };
  stratus_calibration calibration = stratus_calibration_of("test", "part", 1);
  char path[PATH];
  (void)state;
  assert_int_equal(stratus_calibrate(host, &calibration, copy_numbers, &m), STRATUS_DEVICE_ERROR);
  assert_string_equal(stratus_context_message(host), "fails as the test wants");
  static const double wrong[] = { NAN, INFINITY, -1.0 };
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i) {
    add_one("part", wrong[i]);
  }
  path_in(folder, path);
  assert_false(exists(path));
  m.status = STRATUS_OK;
  assert_int_equal(stratus_calibrate(host, &calibration, copy_numbers, &m), STRATUS_OK);
  assert_int_equal(m.calls, 2);
}

/* Children write as fast as they can. Whoever reads meanwhile finds a whole file: the line that was there before is never lost. */
static void writers_at_once_leave_a_whole_file(void** state)
{
  enum { WRITERS = 4, WRITES = 60 };
  pid_t children[WRITERS];
  (void)state;
  add_one("first", 0.1);
  for (int c = 0; c < WRITERS; ++c) {
    children[c] = fork();
    assert_true(children[c] >= 0);
    if (children[c] == 0) {
      for (int i = 0; i < WRITES; ++i) {
        char part[32];
        snprintf(part, sizeof part, "child %d", i % 3);
        add_one(part, 2.0 + c);
      }
      _exit(0);
    }
  }
  for (int i = 0; i < 500; ++i) {
    const stratus_calibration first = stored("first", 1);
    assert_int_equal(first.processes, 1);
    assert_true(first.numbers[0] == 0.1);
  }
  for (int c = 0; c < WRITERS; ++c) {
    int status = -1;
    assert_int_equal(waitpid(children[c], &status, 0), children[c]);
    assert_int_equal(status, 0);
  }
  for (int i = 0; i < 3; ++i) {
    char part[32];
    snprintf(part, sizeof part, "child %d", i);
    const stratus_calibration last = stored(part, 1);
    assert_true(last.processes == 3 && last.numbers[0] >= 2.0 && last.numbers[0] <= 1.0 + WRITERS);
  }
}

typedef struct asker {
  pthread_t thread;
  measured* m;
  stratus_calibration calibration;
} asker;

static void* ask(void* argument)
{
  asker* a = argument;
  a->calibration = stratus_calibration_of("test", "part", 1);
  return stratus_calibrate(host, &a->calibration, copy_numbers, a->m) == STRATUS_OK ? NULL : a;
}

static void threads_that_ask_at_once_measure_once(void** state)
{
  enum { THREADS = 8 };
  asker askers[THREADS];
  measured m = { .count = 1, .numbers = { 3.5 } };
  (void)state;
  for (int t = 0; t < THREADS; ++t) {
    askers[t].m = &m;
    assert_int_equal(pthread_create(&askers[t].thread, NULL, ask, askers + t), 0);
  }
  for (int t = 0; t < THREADS; ++t) {
    void* failed = askers;
    assert_int_equal(pthread_join(askers[t].thread, &failed), 0);
    assert_null(failed);
    assert_true(askers[t].calibration.numbers[0] == 3.5);
  }
  assert_int_equal(m.calls, 1);
}

static void calibrations_of_the_host_are_by_instruction_set_and_threads(void** state)
{
  stratus_context context = *host;
  (void)state;
  context.threads = 2;
  const stratus_calibration two = stratus_calibration_of_host(&context, "kind", 1);
  assert_memory_equal(two.name, "kind: ", 6);
  assert_non_null(strstr(two.name, ", 2 threads"));
  context.threads = 1;
  const stratus_calibration one = stratus_calibration_of_host(&context, "kind", 1);
  assert_string_not_equal(one.name, two.name);
  context.isa = 0;
  const stratus_calibration plain = stratus_calibration_of_host(&context, "kind", 1);
  assert_true((strcmp(plain.name, one.name) == 0) == (host->isa == 0));
}

int test_calibration(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup_teardown(numbers_come_back_bit_by_bit_in_any_locale, begin, end),
    cmocka_unit_test_setup_teardown(three_processes_measure_and_the_least_of_each_number_is_kept, begin, end),
    cmocka_unit_test_setup_teardown(without_a_file_the_process_keeps_what_it_measured, begin, end),
    cmocka_unit_test_setup_teardown(folders_are_taken_in_order_and_made, begin, end),
    cmocka_unit_test_setup_teardown(another_version_s_file_is_not_read, begin, end),
    cmocka_unit_test_setup_teardown(lines_that_are_none_are_ignored_and_go, begin, end),
    cmocka_unit_test_setup_teardown(what_is_no_file_of_ours_is_not_read, begin, end),
    cmocka_unit_test_setup_teardown(the_file_does_not_grow_without_end, begin, end),
    cmocka_unit_test_setup_teardown(a_name_may_hold_anything, begin, end),
    cmocka_unit_test_setup_teardown(a_measurement_that_fails_is_reported_and_not_stored, begin, end),
    cmocka_unit_test_setup_teardown(writers_at_once_leave_a_whole_file, begin, end),
    cmocka_unit_test_setup_teardown(threads_that_ask_at_once_measure_once, begin, end),
    cmocka_unit_test_setup_teardown(calibrations_of_the_host_are_by_instruction_set_and_threads, begin, end),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
