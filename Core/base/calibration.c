/* SPDX-License-Identifier: BSD-3-Clause
 * Keeps measured costs in the process and in a small file. The file has a line for each calibration: name, number of processes, numbers,
 * with a tab between them. Numbers are written as hexadecimal integers times a power of two, which keeps their bits in every locale. */
#define _POSIX_C_SOURCE 200809L
#include "calibration.h"

#include "cache_folder.h"
#include "instruction_set.h"

#include <fcntl.h>
#include <float.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#if defined(__x86_64__) || defined(__i386__)
#include <cpuid.h>
#endif

#define FORMAT 1 /* of the file; part of its name, as the library's version is */
#define FILE_NAME "calibration-%d-%d.%d.%d.txt"
#define FILE_NAME_NUMBERS FORMAT, STRATUS_VERSION_MAJOR, STRATUS_VERSION_MINOR, STRATUS_VERSION_PATCH
#define KEPT 16
#define LINE_MOST 640
/* A file that is larger is not ours. Some 80 calibrations fit. */
#define FILE_MOST 16384

_Static_assert(STRATUS_CALIBRATION_NAME + 8 + 24 * STRATUS_CALIBRATION_NUMBERS < LINE_MOST, "a calibration must fit a line");

typedef struct file_text {
  size_t length;
  char text[FILE_MOST];
} file_text;

/* ---------------------------------------------------------------- names */

#if defined(__x86_64__) || defined(__i386__)
static char processor_name[64];

static void find_processor_name(void)
{
  unsigned words[12] = { 0 };
  for (unsigned leaf = 0; leaf < 3; ++leaf) {
    unsigned* w = words + 4 * (size_t)leaf;
    if (!__get_cpuid(0x80000002u + leaf, w, w + 1, w + 2, w + 3)) {
      words[0] = 0;
    }
  }
  memcpy(processor_name, words, sizeof words);
  size_t length = strlen(processor_name);
  while (length && processor_name[length - 1] == ' ') {
    processor_name[--length] = '\0';
  }
}

/* The processor is asked once, because a virtual machine takes its time to answer. */
static const char* processor(void)
{
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  pthread_once(&once, find_processor_name);
  return *processor_name ? processor_name : "processor";
}
#else
static const char* processor(void)
{
  return "processor";
}
#endif

stratus_calibration stratus_calibration_of(const char* kind, const char* part, int count)
{
  stratus_calibration calibration = { .count = count };
  snprintf(calibration.name, sizeof calibration.name, "%s: %s", kind, part);
  for (char* c = calibration.name; *c; ++c) {
    if (*c < ' ' || *c > '~') {
      *c = '_';
    }
  }
  return calibration;
}

stratus_calibration stratus_calibration_of_host(const stratus_context* context, const char* kind, int count)
{
  char part[160];
  snprintf(part, sizeof part, "%s, instruction set %d, %d thread%s", processor(), stratus_isa_at_most(context->isa), context->threads,
    context->threads == 1 ? "" : "s");
  return stratus_calibration_of(kind, part, count);
}

/* ---------------------------------------------------------------- lines */

static bool is_cost(double number)
{
  return number >= 0.0 && number <= DBL_MAX;
}

static bool parse(const char* line, size_t length, stratus_calibration* found)
{
  char text[LINE_MOST];
  if (length >= sizeof text || memchr(line, '\0', length)) {
    return false;
  }
  memcpy(text, line, length);
  text[length] = '\0';
  const size_t name = strcspn(text, "\t");
  if (name >= sizeof found->name || text[name] != '\t') {
    return false;
  }
  memcpy(found->name, text, name);
  found->name[name] = '\0';
  const char* at = text + name + 1;
  found->processes = *at - '0';
  if (found->processes < 1 || found->processes > STRATUS_CALIBRATION_PROCESSES) {
    return false;
  }
  ++at;
  for (found->count = 0; *at; ++found->count) {
    char* end = NULL;
    if (found->count == STRATUS_CALIBRATION_NUMBERS || strncmp(at, "\t0x", 3) != 0) {
      return false;
    }
    found->numbers[found->count] = strtod(at + 1, &end);
    if (!is_cost(found->numbers[found->count])) {
      return false;
    }
    at = end;
  }
  return found->count > 0;
}

static size_t format(const stratus_calibration* calibration, char line[LINE_MOST])
{
  int used = snprintf(line, LINE_MOST, "%s\t%d", calibration->name, calibration->processes);
  for (int i = 0; i < calibration->count; ++i) {
    int exponent = 0;
    const uint64_t digits = (uint64_t)ldexp(frexp(calibration->numbers[i], &exponent), DBL_MANT_DIG);
    used += snprintf(line + used, LINE_MOST - (size_t)used, "\t0x%" PRIx64 "p%d", digits, exponent - DBL_MANT_DIG);
  }
  line[used] = '\n';
  return (size_t)used + 1;
}

/* Gives the next line of the file that is a calibration, from *at on. Other lines are passed over. */
static bool next_line(const file_text* file, size_t* at, stratus_calibration* found)
{
  while (*at < file->length) {
    const char* line = file->text + *at;
    const char* end = memchr(line, '\n', file->length - *at);
    const size_t length = end ? (size_t)(end - line) : file->length - *at;
    *at += length + 1;
    if (end && parse(line, length, found)) { /* a line without an end was cut */
      return true;
    }
  }
  return false;
}

static bool find_line(const file_text* file, const char* name, int count, stratus_calibration* found)
{
  size_t at = 0;
  while (next_line(file, &at, found)) {
    if (found->count == count && strcmp(found->name, name) == 0) {
      return true;
    }
  }
  return false;
}

/* Adds a line. Where the file would grow too large, its first lines go, which nobody has measured for longest. */
static void append(file_text* file, const stratus_calibration* calibration)
{
  char line[LINE_MOST];
  const size_t length = format(calibration, line);
  while (file->length + length > FILE_MOST) {
    const char* end = memchr(file->text, '\n', file->length);
    const size_t first = (size_t)(end - file->text) + 1;
    file->length -= first;
    memmove(file->text, file->text + first, file->length);
  }
  memcpy(file->text + file->length, line, length);
  file->length += length;
}

/* ---------------------------------------------------------------- file */

/* Returns false if there is no place for the file. */
static bool find_file(char folder[STRATUS_CACHE_PATH], char path[STRATUS_CACHE_PATH])
{
  if (!stratus_cache_find(folder)) {
    return false;
  }
  const int length = snprintf(path, STRATUS_CACHE_PATH, "%s/" FILE_NAME, folder, FILE_NAME_NUMBERS);
  return length > 0 && length < STRATUS_CACHE_PATH;
}

/* A file that cannot be read, or is none of ours, counts as empty. */
static void read_file(const char* path, file_text* file)
{
  struct stat status;
  file->length = 0;
  const int handle = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); /* a pipe must not be waited for */
  if (handle < 0) {
    return;
  }
  if (fstat(handle, &status) == 0 && S_ISREG(status.st_mode) && status.st_size <= FILE_MOST) {
    ssize_t got = 1;
    while (got > 0 && file->length < FILE_MOST) {
      got = read(handle, file->text + file->length, FILE_MOST - file->length);
      file->length += got > 0 ? (size_t)got : 0;
    }
    file->length = got < 0 ? 0 : file->length;
  }
  close(handle);
}

void stratus_calibration_read(stratus_calibration* calibration)
{
  char folder[STRATUS_CACHE_PATH], path[STRATUS_CACHE_PATH];
  file_text file;
  stratus_calibration found;
  if (!find_file(folder, path)) {
    return;
  }
  read_file(path, &file);
  if (find_line(&file, calibration->name, calibration->count, &found)) {
    *calibration = found;
  }
}

void stratus_calibration_add(stratus_calibration* calibration)
{
  char folder[STRATUS_CACHE_PATH], path[STRATUS_CACHE_PATH];
  file_text old, file = { .length = 0 };
  stratus_calibration found;
  size_t at = 0;
  calibration->processes = 1;
  for (int i = 0; i < calibration->count; ++i) {
    if (!is_cost(calibration->numbers[i])) {
      return;
    }
  }
  if (!find_file(folder, path)) {
    return;
  }
  read_file(path, &old);
  if (find_line(&old, calibration->name, calibration->count, &found)) {
    calibration->processes = found.processes < STRATUS_CALIBRATION_PROCESSES ? found.processes + 1 : found.processes;
    for (int i = 0; i < calibration->count; ++i) {
      calibration->numbers[i] = fmin(calibration->numbers[i], found.numbers[i]);
    }
  }
  while (next_line(&old, &at, &found)) {
    if (strcmp(found.name, calibration->name) != 0) {
      append(&file, &found);
    }
  }
  append(&file, calibration);
  char name[64];
  const stratus_cache_part whole = { file.text, file.length };
  snprintf(name, sizeof name, FILE_NAME, FILE_NAME_NUMBERS);
  (void)stratus_cache_write(folder, name, &whole, 1);
}

/* ---------------------------------------------------------------- process */

/* The calibrations that this process has used. */
static stratus_calibration kept[KEPT];
static int kept_count;

/* Use the file's numbers or measure them. measuring_ms is unchanged if nothing is measured. */
static stratus_status make(
  stratus_context* context, stratus_calibration* calibration, stratus_calibration_measure* measure, void* job, double* measuring_ms)
{
  stratus_calibration_read(calibration);
  if (calibration->processes < STRATUS_CALIBRATION_PROCESSES) {
    const double start = stratus_now_ms();
    TRY(measure(context, job, calibration->numbers));
    *measuring_ms = stratus_now_ms() - start;
    stratus_calibration_add(calibration);
  }
  return STRATUS_OK;
}

stratus_status stratus_calibrate(
  stratus_context* context, stratus_calibration* calibration, stratus_calibration_measure* measure, void* job)
{
  stratus_status status = STRATUS_OK;
  double measuring_ms = 0.0;
#pragma omp critical(stratus_calibration)
  {
    int i = 0;
    while (i < kept_count && strcmp(kept[i].name, calibration->name) != 0) {
      ++i;
    }
    if (i < kept_count) {
      *calibration = kept[i];
    } else {
      status = make(context, calibration, measure, job, &measuring_ms);
      if (status == STRATUS_OK) {
        i = kept_count < KEPT ? kept_count : KEPT - 1; /* the last makes room for more */
        kept[i] = *calibration;
        kept_count = i + 1;
      }
    }
  }
  if (measuring_ms > 0.0) {
    stratus_log(context, STRATUS_LOG_DEBUG, "measured %s in %.0f ms", calibration->name, measuring_ms);
  }
  return status;
}

void stratus_calibration_forget(void)
{
#pragma omp critical(stratus_calibration)
  kept_count = 0;
}
