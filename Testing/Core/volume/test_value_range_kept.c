/* SPDX-License-Identifier: BSD-3-Clause
 * Value ranges that are kept in the cache's folder for volumes with an identity: other values under the same identity show whether ranges
 * were found again or kept. */
#define _XOPEN_SOURCE 700
#include "remove_folder.h"
#include "structures.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

enum { NX = 21, NY = 10, NZ = 9, COUNT = NX * NY * NZ };

static char folder[] = "/tmp/stratus-ranges-XXXXXX";
static stratus_context* host;

static int begin(void** state)
{
  (void)state;
  host = make_context("host", 2);
  return !mkdtemp(folder) || setenv("STRATUS_CACHE_DIR", folder, 1) != 0;
}

static int end(void** state)
{
  (void)state;
  stratus_context_destroy(host);
  return remove_folder(folder);
}

/* Fills an array of any type with values that depend on `seed`. */
static void fill(void* values, stratus_type type, uint32_t seed)
{
  for (size_t i = 0; i < COUNT; ++i) {
    const double value =
      (double)((i * 2654435761u + seed * 40503u) >> 7 & 127u) - (type == STRATUS_INT8 || type == STRATUS_INT16 ? 64.0 : 0.0);
    switch (type) {
      case STRATUS_INT8:
        ((int8_t*)values)[i] = (int8_t)value;
        break;
      case STRATUS_UINT8:
        ((uint8_t*)values)[i] = (uint8_t)value;
        break;
      case STRATUS_INT16:
        ((int16_t*)values)[i] = (int16_t)(100.0 * value);
        break;
      case STRATUS_UINT16:
        ((uint16_t*)values)[i] = (uint16_t)(100.0 * value);
        break;
      case STRATUS_INT32:
        ((int32_t*)values)[i] = (int32_t)(1000.0 * value);
        break;
      case STRATUS_FLOAT32:
        ((float*)values)[i] = i % 97 == 5 ? NAN : (float)value + 0.25f;
        break;
      default:
        ((double*)values)[i] = 1e9 + value;
        break;
    }
  }
}

static stratus_volume volume_of(const void* values, stratus_type type, uint64_t identity)
{
  stratus_volume v = stratus_volume_default();
  v.values = values;
  v.type = type;
  v.dimensions[0] = NX;
  v.dimensions[1] = NY;
  v.dimensions[2] = NZ;
  v.identity = identity;
  return v;
}

static stratus_value_range* ranges_of(const stratus_volume* v, int size)
{
  stratus_value_range* ranges = NULL;
  assert_int_equal(stratus_value_range_create(host, v, size, &ranges), STRATUS_OK);
  return ranges;
}

static int same(const stratus_value_range* a, const stratus_value_range* b)
{
  const size_t count = (size_t)(a->blocks[0] * a->blocks[1] * a->blocks[2]);
  return memcmp(a->blocks, b->blocks, sizeof a->blocks) == 0 && memcmp(a->lo, b->lo, count * sizeof *a->lo) == 0 &&
    memcmp(a->hi, b->hi, count * sizeof *a->hi) == 0 && memcmp(a->gaps, b->gaps, count) == 0 && a->whole_lo == b->whole_lo &&
    a->whole_hi == b->whole_hi;
}

/* Whether ranges of `later`, which has other values than the ranges `kept`, come from the kept file. */
static int recalls(const stratus_value_range* kept, const stratus_volume* later, int size)
{
  stratus_value_range* ranges = ranges_of(later, size);
  const int equal = same(kept, ranges);
  stratus_value_range_destroy(ranges);
  return equal;
}

static int kept_files(char path[512])
{
  DIR* listing = opendir(folder);
  int count = 0;
  assert_non_null(listing);
  for (const struct dirent* entry; (entry = readdir(listing)) != NULL;) {
    if (strncmp(entry->d_name, "ranges-", 7) == 0) {
      snprintf(path, 512, "%s/%.255s", folder, entry->d_name);
      ++count;
    }
  }
  closedir(listing);
  return count;
}

static void forget_all(void)
{
  char path[512];
  while (kept_files(path) > 0) {
    assert_int_equal(unlink(path), 0);
  }
}

static void ranges_of_every_type_are_kept(void** state)
{
  static const stratus_type types[] = { STRATUS_INT8, STRATUS_UINT8, STRATUS_INT16, STRATUS_UINT16, STRATUS_INT32, STRATUS_FLOAT32 };
  static double one[COUNT], other[COUNT];
  (void)state;
  for (size_t t = 0; t < sizeof types / sizeof *types; ++t) {
    forget_all();
    fill(one, types[t], 1);
    fill(other, types[t], 2);
    const stratus_volume first = volume_of(one, types[t], 77), second = volume_of(other, types[t], 77), plain = volume_of(one, types[t], 0),
                         stranger = volume_of(other, types[t], 78);
    stratus_volume cells = second, component = second;
    cells.cell_centered = 1;
    component.dimensions[0] = NX - 1;
    stratus_value_range *kept = ranges_of(&first, 4), *found = ranges_of(&plain, 4);
    assert_true(same(kept, found));
    assert_true(recalls(kept, &second, 4));
    assert_true(recalls(kept, &first, 4));
    assert_false(recalls(kept, &stranger, 4));
    assert_false(recalls(kept, &second, 8));
    assert_false(recalls(kept, &cells, 4));
    assert_false(recalls(kept, &component, 4));
    stratus_value_range_destroy(kept);
    stratus_value_range_destroy(found);
  }
}

/* Hidden cells are not the values', so that nothing is kept of volumes that have any. */
static void nothing_is_kept_without_an_identity_or_with_ghosts(void** state)
{
  static uint8_t values[COUNT], ghosts[COUNT];
  char path[512];
  (void)state;
  forget_all();
  fill(values, STRATUS_UINT8, 3);
  stratus_volume v = volume_of(values, STRATUS_UINT8, 0);
  stratus_value_range_destroy(ranges_of(&v, 4));
  assert_int_equal(kept_files(path), 0);
  v.identity = 5;
  v.point_ghosts = ghosts;
  stratus_value_range_destroy(ranges_of(&v, 4));
  assert_int_equal(kept_files(path), 0);
  v.point_ghosts = NULL;
  stratus_value_range_destroy(ranges_of(&v, 4));
  assert_int_equal(kept_files(path), 1);
}

static void damage(const char* path, long at, int cut)
{
  FILE* file = fopen(path, "r+b");
  assert_non_null(file);
  if (cut) {
    assert_int_equal(ftruncate(fileno(file), at), 0);
  } else {
    fseek(file, at, SEEK_SET);
    const int byte = fgetc(file);
    fseek(file, at, SEEK_SET);
    fputc(byte ^ 1, file);
  }
  assert_int_equal(fclose(file), 0);
}

/* A file of which any byte is wrong, or that is too short, is dropped, and the ranges are found again and kept. */
static void a_damaged_file_is_dropped(void** state)
{
  static uint8_t one[COUNT], other[COUNT];
  static const long places[] = { 3, 17, 25, 33, 60, 90, 200 };
  char path[512];
  (void)state;
  fill(one, STRATUS_UINT8, 1);
  fill(other, STRATUS_UINT8, 2);
  const stratus_volume first = volume_of(one, STRATUS_UINT8, 9), second = volume_of(other, STRATUS_UINT8, 9);
  stratus_value_range* kept = ranges_of(&first, 4);
  for (size_t i = 0; i < 2 * sizeof places / sizeof *places; ++i) {
    forget_all();
    stratus_value_range_destroy(ranges_of(&first, 4));
    assert_int_equal(kept_files(path), 1);
    assert_true(recalls(kept, &second, 4));
    damage(path, places[i / 2], i % 2);
    assert_false(recalls(kept, &second, 4));
    assert_int_equal(kept_files(path), 1); /* of the second now */
    assert_false(recalls(kept, &first, 4));
  }
  stratus_value_range_destroy(kept);
}

/* Values that are missing are an error, and nothing of them is kept. */
static void missing_values_are_an_error(void** state)
{
  static uint8_t values[COUNT];
  uint64_t missing = 0;
  char path[512];
  stratus_value_range* ranges = NULL;
  (void)state;
  forget_all();
  stratus_volume v = volume_of(values, STRATUS_UINT8, 11);
  v.missing = &missing;
  stratus_value_range_destroy(ranges_of(&v, 4));
  assert_int_equal(kept_files(path), 1);
  forget_all();
  missing = 4096;
  assert_int_equal(stratus_value_range_create(host, &v, 4, &ranges), STRATUS_INVALID_ARGUMENT);
  assert_null(ranges);
  assert_non_null(strstr(stratus_context_message(host), "4096 bytes"));
  assert_int_equal(kept_files(path), 0);
}

/* Without the folder, ranges are found as ever. */
static void a_folder_that_cannot_be_written_is_no_error(void** state)
{
  static uint8_t values[COUNT];
  (void)state;
  setenv("STRATUS_CACHE_DIR", "/proc/none/stratus", 1);
  const stratus_volume v = volume_of(values, STRATUS_UINT8, 12);
  stratus_value_range_destroy(ranges_of(&v, 4));
  setenv("STRATUS_CACHE_DIR", folder, 1);
}

int test_value_range_kept(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(ranges_of_every_type_are_kept),
    cmocka_unit_test(nothing_is_kept_without_an_identity_or_with_ghosts),
    cmocka_unit_test(a_damaged_file_is_dropped),
    cmocka_unit_test(missing_values_are_an_error),
    cmocka_unit_test(a_folder_that_cannot_be_written_is_no_error),
  };
  return cmocka_run_group_tests(tests, begin, end);
}
