/* SPDX-License-Identifier: BSD-3-Clause
 * The interface of a test program to its test files. One program holds all test files of a folder. Each function `int test_NAME(void)` is
 * a ctest test of its own, run as `PROGRAM test_NAME`. It returns the number of failures, or TEST_SKIPPED. */
#ifndef STRATUS_TESTING_H
#define STRATUS_TESTING_H

#include <stdbool.h>

#define TEST_SKIPPED 77 /* exit status that ctest counts as a skip */

/* Prints why the whole test cannot run, and returns TEST_SKIPPED. */
int test_skip(const char* why);

/* Whether the command line holds this word, such as "--tiny". */
bool test_option(const char* word);

/* Whether all cases are asked for, which take minutes: the environment variable STRATUS_LONG is set, and not 0. */
bool long_run(void);

/* Returns the path of the running program, for a test that runs itself. */
const char* test_program(void);

/* One line of the table that CMake writes for each program; its last line is empty. */
typedef struct test_entry {
  const char* name;
  int (*run)(void);
} test_entry;

extern const test_entry test_entries[];

#endif
