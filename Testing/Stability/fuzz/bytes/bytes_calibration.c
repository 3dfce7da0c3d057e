/* SPDX-License-Identifier: BSD-3-Clause
 * The file of measured costs: any content gives only valid numbers, and numbers that are added are read back. */
#define _XOPEN_SOURCE 700
#include "bytes.h"
#include "calibration.h"

#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[64], path[160];

static void remove_folder(void)
{
  (void)unlink(path);
  (void)rmdir(folder);
}

static stratus_calibration read_one(const char* part, int count)
{
  stratus_calibration c = stratus_calibration_of("host", part, count);
  stratus_calibration_read(&c);
  HOLDS(
    c.processes >= 0 && c.processes <= STRATUS_CALIBRATION_PROCESSES && c.count == count, "%d processes, %d numbers", c.processes, c.count);
  for (int i = 0; c.processes > 0 && i < count; ++i) {
    HOLDS(c.numbers[i] >= 0.0 && c.numbers[i] < INFINITY, "number %d is %g", i, c.numbers[i]);
  }
  return c;
}

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
  if (!folder[0]) {
    const char* memory = access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
    snprintf(folder, sizeof folder, "%s/stratus-bytes-XXXXXX", memory);
    HOLDS(mkdtemp(folder) && setenv("STRATUS_CACHE_DIR", folder, 1) == 0, "no folder");
    snprintf(path, sizeof path, "%s/calibration-1-%s.txt", folder, stratus_version());
    (void)atexit(remove_folder);
  }
  FILE* file = fopen(path, "wb");
  HOLDS(file && fwrite(data, 1, size, file) == size && fclose(file) == 0, "no file");
  static const char* parts[] = { "a", "part 2", "x" };
  for (int p = 0; p < 3; ++p) {
    stratus_calibration_forget();
    const stratus_calibration before = read_one(parts[p], 1 + p);
    stratus_calibration added = stratus_calibration_of("host", parts[p], 1 + p);
    for (int i = 0; i <= p; ++i) {
      added.numbers[i] = 1.5 + i;
    }
    stratus_calibration_add(&added);
    stratus_calibration_forget();
    const stratus_calibration after = read_one(parts[p], 1 + p);
    HOLDS(after.processes > 0 && after.processes >= before.processes, "%d processes, and %d after another one", before.processes,
      after.processes);
    for (int i = 0; i <= p; ++i) {
      const double least = before.processes > 0 && before.numbers[i] < 1.5 + i ? before.numbers[i] : 1.5 + i;
      HOLDS(after.numbers[i] == least, "the least of %g and %g is read as %g", before.numbers[i], 1.5 + i, after.numbers[i]);
    }
  }
  return 0;
}
