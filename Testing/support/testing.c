/* SPDX-License-Identifier: BSD-3-Clause
 * main() of each test program. PROGRAM TEST [--WORD...] [CASE...] runs one test, or only the cases that match a pattern CASE. --seed=N runs
 * one seed of random cases.
 *
 * The linker redirects cmocka's group runner and skip() to this file, so that test files stay plain cmocka. cmocka returns 0 if cases were
 * skipped, and if a group's tear-down failed. This file reports the first as ctest's skip, the second as a failure. */
#include "testing.h"

#include <fnmatch.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

int __real__cmocka_run_group_tests(
  const char* name, const struct CMUnitTest* tests, size_t count, CMFixtureFunction set_up, CMFixtureFunction tear_down);
int __wrap__cmocka_run_group_tests(
  const char* name, const struct CMUnitTest* tests, size_t count, CMFixtureFunction set_up, CMFixtureFunction tear_down);
void __real__skip(const char* file, int line);
void __wrap__skip(const char* file, int line);

static char** words;
static bool few;
static size_t cases, skipped, failed_teardowns;
static CMFixtureFunction group_teardown;
static const struct CMUnitTest* originals; /* the running group, with its functions before they are wrapped */
static size_t original;
static bool seed_runs; /* a seed has begun, and test_next() was not called since */
static uint32_t seed;

int test_skip(const char* why)
{
  printf("SKIPPED: %s\n", why);
  return TEST_SKIPPED;
}

bool test_option(const char* word)
{
  for (char** w = words + 2; *w; ++w) {
    if (strcmp(*w, word) == 0) {
      return true;
    }
  }
  return false;
}

static bool is_set(const char* name)
{
  const char* value = getenv(name);
  return value && *value && strcmp(value, "0") != 0;
}

bool long_run(void)
{
  return is_set("STRATUS_LONG");
}

bool few_run(void)
{
  return few; /* loops over pixels read it */
}

const char* test_program(void)
{
  return words[0];
}

/* Returns the number after --seed= on the command line, or NULL. */
static const char* given_seed(void)
{
  for (char** w = words + 2; *w; ++w) {
    if (strncmp(*w, "--seed=", 7) == 0) {
      return *w + 7;
    }
  }
  return NULL;
}

test_seeds test_seeds_of(uint32_t quick, uint32_t all)
{
  const char* given = given_seed();
  if (given) {
    const uint32_t first = (uint32_t)strtoul(given, NULL, 10);
    return (test_seeds){ .seed = first, .end = first + 1 };
  }
  return (test_seeds){ .end = long_run() ? all : few_run() ? (quick + 2) / 3 : quick };
}

bool test_next(test_seeds* seeds)
{
  seeds->seed += seeds->begun;
  seeds->begun = true;
  seed_runs = seeds->seed < seeds->end;
  seed = seeds->seed;
  return seed_runs;
}

bool test_many(const test_seeds* seeds, uint32_t least)
{
  return seeds->end >= least && !given_seed();
}

/* Whether a pattern of the command line matches this case. NULL: whether there is a pattern at all. */
static bool pattern_for(const char* name)
{
  for (char** w = words + 2; *w; ++w) {
    if (strncmp(*w, "--", 2) != 0 && (!name || fnmatch(*w, name, 0) == 0)) {
      return true;
    }
  }
  return false;
}

static int set_up_case(void** state)
{
  return originals[original].setup_func ? originals[original].setup_func(state) : 0;
}

/* Runs after a case, which an assertion may have left in the middle of a seed. */
static int tear_down_case(void** state)
{
  const struct CMUnitTest* test = &originals[original++];
  if (seed_runs) {
    fprintf(stderr, "Seed %u failed. To repeat it: %s %s --seed=%u %s\n", seed, words[0], words[1], seed, test->name);
    seed_runs = false;
  }
  return test->teardown_func ? test->teardown_func(state) : 0;
}

static int tear_down_group(void** state)
{
  ++failed_teardowns; /* an assertion that fails does not come back */
  const int status = group_teardown(state);
  failed_teardowns -= status == 0;
  return status;
}

int __wrap__cmocka_run_group_tests(
  const char* name, const struct CMUnitTest* tests, size_t count, CMFixtureFunction set_up, CMFixtureFunction tear_down)
{
  struct CMUnitTest* chosen = calloc(2 * count, sizeof *chosen);
  size_t number = 0;
  if (!chosen) {
    return 1;
  }
  for (size_t i = 0; i < count; ++i) {
    if (!pattern_for(NULL) || pattern_for(tests[i].name)) {
      chosen[number] = chosen[count + number] = tests[i];
      chosen[number].setup_func = set_up_case;
      chosen[number++].teardown_func = tear_down_case;
    }
  }
  originals = chosen + count;
  original = 0;
  cases += number;
  group_teardown = tear_down;
  const int failed = number ? __real__cmocka_run_group_tests(name, chosen, number, set_up, tear_down ? tear_down_group : NULL) : 0;
  free(chosen);
  return failed != 0; /* a number of failures might be TEST_SKIPPED */
}

void __wrap__skip(const char* file, int line)
{
  ++skipped;
  __real__skip(file, line);
}

int main(int argc, char** argv)
{
  const test_entry* entry = test_entries;
  while (entry->name && (argc < 2 || strcmp(entry->name, argv[1]) != 0)) {
    ++entry;
  }
  if (!entry->name) {
    fprintf(stderr, "usage: %s TEST [CASE...], with patterns of cases' names; TEST is one of\n", argv[0]);
    for (entry = test_entries; entry->name; ++entry) {
      fprintf(stderr, "  %s\n", entry->name);
    }
    return 2;
  }
  words = argv;
  few = (is_set("STRATUS_FEW") && !long_run()) || test_option("--few");
  const int status = entry->run();
  if (status == TEST_SKIPPED) {
    return TEST_SKIPPED;
  }
  if (status != 0 || failed_teardowns != 0) {
    return 1;
  }
  if (cases == 0 && pattern_for(NULL)) {
    fprintf(stderr, "%s has no such case\n", entry->name);
    return 2;
  }
  if (skipped != 0) {
    printf("SKIPPED: %zu of %zu cases\n", skipped, cases);
    return TEST_SKIPPED;
  }
  return 0;
}
