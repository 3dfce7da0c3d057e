# SPDX-License-Identifier: BSD-3-Clause
# cmake -DFOLDER=... -DHEADER=... -P commit.cmake: HEADER names the commit of FOLDER's sources, `+` behind it where they were changed since.
cmake_minimum_required(VERSION 3.20)
execute_process(COMMAND git -C "${FOLDER}" describe --always --exclude=* --abbrev=7 --dirty=+
  OUTPUT_VARIABLE commit RESULT_VARIABLE failed ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
if (failed)
  set(commit unknown)
endif ()
# A header that says the same stays untouched, so that nothing is compiled again.
file(CONFIGURE OUTPUT "${HEADER}" CONTENT "#define STRATUS_BENCH_COMMIT \"@commit@\"\n" @ONLY)
