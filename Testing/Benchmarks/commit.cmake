# SPDX-License-Identifier: BSD-3-Clause
# cmake -DFOLDER=... -DHEADER=... -P commit.cmake: writes the commit of FOLDER's sources to HEADER, with `+` behind it if they have changed
# since, and hashes of the sources of the reference and of the path tracer, by which their pictures are kept.
cmake_minimum_required(VERSION 3.20)
execute_process(COMMAND git -C "${FOLDER}" describe --always --exclude=* --abbrev=7 --dirty=+
  OUTPUT_VARIABLE commit RESULT_VARIABLE failed ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
if (failed)
  set(commit unknown)
endif ()
file(GLOB sources "${FOLDER}/Testing/support/reference*" "${FOLDER}/Testing/Benchmarks/volume/judge.cxx"
  "${FOLDER}/Testing/Benchmarks/tetra/tetra_judge.cxx" "${FOLDER}/Testing/Benchmarks/tetra/tetra_rays.cxx")
set(reference)
foreach (source IN LISTS sources)
  file(SHA1 "${source}" hash)
  string(APPEND reference "${hash}")
endforeach ()
string(SHA1 reference "${reference}")
file(GLOB sources "${FOLDER}/Core/path/*.[ch]" "${FOLDER}/Testing/Benchmarks/light/light_judge.cxx")
set(paths)
foreach (source IN LISTS sources)
  file(SHA1 "${source}" hash)
  string(APPEND paths "${hash}")
endforeach ()
string(SHA1 paths "${paths}")
# An unchanged header keeps its time stamp, so that nothing is compiled again.
file(CONFIGURE OUTPUT "${HEADER}" CONTENT "#define STRATUS_BENCH_COMMIT \"@commit@\"\n#define STRATUS_BENCH_REFERENCE \"@reference@\"\n\
#define STRATUS_BENCH_PATHS \"@paths@\"\n" @ONLY)
