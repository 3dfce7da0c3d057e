# SPDX-License-Identifier: BSD-3-Clause
# Finds OpenEXR's C library and sets stratus_exr: whether to build vtkStratusEXRWriter, and `stratus render -o OUT.exr`. Debian's CMake
# package of OpenEXR is not used, because it demands a Python library that is not needed here.
set(STRATUS_BUILD_EXR AUTO CACHE STRING "Build vtkStratusEXRWriter, which needs OpenEXR 3.1: ON, OFF, or AUTO (where it is found)")
set_property(CACHE STRATUS_BUILD_EXR PROPERTY STRINGS AUTO ON OFF)
set(stratus_exr OFF)
if (STRATUS_BUILD_EXR)
  find_path(OPENEXR_INCLUDE_DIR openexr.h PATH_SUFFIXES OpenEXR)
  find_library(OPENEXR_CORE_LIBRARY NAMES OpenEXRCore OpenEXRCore-3_1) # exists since 3.1
  mark_as_advanced(OPENEXR_INCLUDE_DIR OPENEXR_CORE_LIBRARY)
  if (OPENEXR_INCLUDE_DIR AND OPENEXR_CORE_LIBRARY)
    set(stratus_exr ON)
  elseif (STRATUS_BUILD_EXR STREQUAL "AUTO")
    message(STATUS "No OpenEXR 3.1: building without vtkStratusEXRWriter (Debian: libopenexr-dev)")
  else ()
    message(FATAL_ERROR "STRATUS_BUILD_EXR is ${STRATUS_BUILD_EXR}, but OpenEXR 3.1 was not found (Debian: libopenexr-dev)")
  endif ()
endif ()
