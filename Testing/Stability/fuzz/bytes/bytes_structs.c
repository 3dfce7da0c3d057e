/* SPDX-License-Identifier: BSD-3-Clause
 * The public structs: bytes in place of the seed drive the cases of stratus-fuzz. The first byte chooses the kind. The last kind is
 * left to stratus-fuzz, so that the corpus keeps its kinds. */
#include "bytes.h"
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
  static fuzz_tally tally;
  if (size < 2) {
    return 0;
  }
  fuzz f = { .kind = fuzz_kinds[data[0] % (fuzz_kind_count - 1)].name,
    .program = "fuzz-structs",
    .device = "host",
    .seed = 1,
    .tally = &tally,
    .here = true,
    .driven = true,
    .bytes = data + 1,
    .bytes_left = size - 1 };
  fuzz_run_case(&f, 0);
  free(f.blocks);
  return 0;
}
