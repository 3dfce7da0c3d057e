/* SPDX-License-Identifier: BSD-3-Clause
 * The interface of a test program to its test files. One program holds all test files of a folder. Each function `int test_NAME(void)` is
 * a ctest test of its own, run as `PROGRAM test_NAME`. It returns the number of failures, or TEST_SKIPPED. */
#ifndef STRATUS_TESTING_H
#define STRATUS_TESTING_H

#include <stdbool.h>
#include <stdint.h>

#define TEST_SKIPPED 77 /* exit status that ctest counts as a skip */

/* Prints why the whole test cannot run, and returns TEST_SKIPPED. */
int test_skip(const char* why);

/* Whether the command line holds this word, such as "--tiny". */
bool test_option(const char* word);

/* Random cases by seed: `for (test_seeds s = test_seeds_of(TEST_SOME(10000), 10000); test_next(&s);)` runs its body with s.seed 0, 1, 2 and
 * so on. There are `quick` of them, a third of these where few_run(), `all` if the environment has STRATUS_LONG=1, or the one that --seed=N
 * on the command line names. If a body fails, the command that repeats its seed is printed. */
typedef struct test_seeds {
  uint32_t seed, end;
  bool begun;
} test_seeds;

/* How many of `all` are quick: a tenth, or fewer in a build for debugging, which takes ten times as long, and with sanitizers. */
#if defined(__SANITIZE_ADDRESS__)
#define TEST_SOME(all) 20
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define TEST_SOME(all) 20
#endif
#endif
#ifndef TEST_SOME
#ifdef NDEBUG
#define TEST_SOME(all) ((all) / 10)
#else
#define TEST_SOME(all) ((all) < 2000 ? 20 : (all) / 100)
#endif
#endif

test_seeds test_seeds_of(uint32_t quick, uint32_t all);
bool test_next(test_seeds* seeds);
/* Returns whether at least `least` seeds run, enough for a bound on their mean. */
bool test_many(const test_seeds* seeds, uint32_t least);

/* Returns whether all cases run, which takes minutes: the environment variable STRATUS_LONG is set, and not 0. */
bool long_run(void);

/* Returns whether some cases are enough, of a test that has many like one another: the environment variable STRATUS_FEW is set, and not 0,
 * or the command line has --few. The presets quick and dev set it. */
bool few_run(void);

/* Returns the path of the running program, for a test that runs itself. */
const char* test_program(void);

/* One line of the table that CMake writes for each program; its last line is empty. */
typedef struct test_entry {
  const char* name;
  int (*run)(void);
} test_entry;

extern const test_entry test_entries[];

#endif
