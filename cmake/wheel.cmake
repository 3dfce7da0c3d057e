# SPDX-License-Identifier: BSD-3-Clause
# Settings for the build of a Python wheel by scikit-build-core, which sets SKBUILD.

set(stratus_library_version VERSION "${PROJECT_VERSION}" SOVERSION "${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}")
if (SKBUILD) # A wheel holds no links: each further name of a library would be a copy of it.
  list(REMOVE_AT stratus_library_version 0 1)
endif ()

# The machine that installs a wheel may have an older C library than this one.
if (SKBUILD AND CMAKE_SYSTEM_NAME STREQUAL "Linux" AND CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
  include(CheckSymbolExists)
  check_symbol_exists(__GLIBC__ "features.h" STRATUS_GLIBC)
  if (STRATUS_GLIBC)
    add_compile_options("SHELL:-include ${PROJECT_SOURCE_DIR}/Python/glibc_2_28.h")
  endif ()
endif ()

# stratus_add_no_opencl(FOLDER): an OpenCL loader without platforms, built into FOLDER, for machines that have none.
function (stratus_add_no_opencl folder)
  set(source "${PROJECT_SOURCE_DIR}/Python/no_opencl")
  add_library(stratus-no-opencl SHARED "${source}.c")
  set_target_properties(stratus-no-opencl PROPERTIES OUTPUT_NAME OpenCL SOVERSION 1 NO_SONAME OFF C_STANDARD 11 C_VISIBILITY_PRESET hidden
    LIBRARY_OUTPUT_DIRECTORY "${folder}" LINK_DEPENDS "${source}.map")
  target_link_options(stratus-no-opencl PRIVATE "LINKER:--version-script=${source}.map")
endfunction ()

set(STRATUS_WHEEL_OPENMP "" CACHE STRING "Name of the OpenMP runtime that is next to VTK's wheel, which the core then shares")
# stratus_share_openmp(): in a wheel, the installed core links the OpenMP runtime of VTK's wheel by the name that auditwheel gave it there.
# By its usual name it would load a second, system runtime in the same process.
function (stratus_share_openmp)
  if (NOT SKBUILD OR NOT STRATUS_WHEEL_OPENMP)
    return ()
  endif ()
  find_program(STRATUS_PATCHELF patchelf REQUIRED)
  list(JOIN CMAKE_INSTALL_RPATH ":" rpath)
  string(REPLACE "$" "\\$" rpath "${rpath}")
  install(CODE "execute_process(COMMAND \"${STRATUS_PATCHELF}\" --replace-needed libgomp.so.1 \"${STRATUS_WHEEL_OPENMP}\" --set-rpath \"${rpath}\"
    \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/$<TARGET_SONAME_FILE_NAME:Stratus::Core>\" COMMAND_ERROR_IS_FATAL ANY)" COMPONENT core)
endfunction ()
