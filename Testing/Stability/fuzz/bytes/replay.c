/* SPDX-License-Identifier: BSD-3-Clause
 * main() where libFuzzer has none: gives each file of the folders and files that the command line names to the fuzzer's entry. */
#define _XOPEN_SOURCE 700
#include "bytes.h"

#include <dirent.h>
#include <string.h>
#include <sys/stat.h>

static size_t files;

static void give(const char* path)
{
  struct stat status;
  FILE* file = fopen(path, "rb");
  if (!file || fstat(fileno(file), &status) != 0) {
    perror(path);
    exit(EXIT_FAILURE);
  }
  const size_t size = (size_t)status.st_size;
  uint8_t* data = malloc(size > 0 ? size : 1); /* of exactly this size, for the address sanitizer */
  if (!data || fread(data, 1, size, file) != size) {
    perror(path);
    exit(EXIT_FAILURE);
  }
  fclose(file);
  fprintf(stderr, "%s\n", path); /* the last line names the file that ended the process */
  (void)LLVMFuzzerTestOneInput(data, size);
  free(data);
  ++files;
}

int main(int argc, char** argv)
{
  for (int i = 1; i < argc; ++i) {
    struct dirent** names = NULL;
    const int count = scandir(argv[i], &names, NULL, alphasort);
    if (count < 0) {
      give(argv[i]);
    }
    for (int n = 0; n < count; ++n) {
      char path[4096];
      snprintf(path, sizeof path, "%s/%s", argv[i], names[n]->d_name);
      if (names[n]->d_name[0] != '.') {
        give(path);
      }
      free(names[n]);
    }
    free(names);
  }
  printf("%zu files\n", files);
  return files > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
