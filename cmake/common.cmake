# SPDX-License-Identifier: BSD-3-Clause
# Sources that several modules and programs share, each compiled once into an object library. A module links the objects that it needs into
# its own library, where their symbols are hidden. Object libraries are neither installed nor exported, and no exported target names one.
set(stratus_common_libraries stratus-filters-common stratus-rendering-common)

# Compile options of both object libraries, which are not VTK modules.
function (stratus_common_flags target)
  set_target_properties(${target} PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${target} PUBLIC "${CMAKE_CURRENT_SOURCE_DIR}")
  target_compile_options(${target} PRIVATE -Wall -Wextra $<$<BOOL:${STRATUS_WERROR}>:-Werror>)
endfunction ()

# stratus_use_common(TARGET NAME...): adds to TARGET the objects of NAME.cxx and the folders of their headers, and always the objects of
# Filters/Common. TARGET links the libraries that the objects need.
function (stratus_use_common target)
  get_target_property(real ${target} ALIASED_TARGET)
  if (NOT real)
    set(real ${target})
  endif ()
  target_include_directories(${real} PRIVATE "$<TARGET_PROPERTY:stratus-filters-common,INTERFACE_INCLUDE_DIRECTORIES>")
  foreach (name IN LISTS ARGN)
    set(home)
    foreach (library IN LISTS stratus_common_libraries)
      get_target_property(sources ${library} SOURCES)
      if ("${name}.cxx" IN_LIST sources)
        set(home ${library})
      endif ()
    endforeach ()
    if (NOT home)
      message(FATAL_ERROR "${target}: none of ${stratus_common_libraries} compiles ${name}.cxx")
    endif ()
    target_sources(${real} PRIVATE "$<FILTER:$<TARGET_OBJECTS:${home}>,INCLUDE,/${name}[.]cxx[.]>")
    target_include_directories(${real} PRIVATE "$<TARGET_PROPERTY:${home},INTERFACE_INCLUDE_DIRECTORIES>")
  endforeach ()
endfunction ()

add_subdirectory("${CMAKE_CURRENT_LIST_DIR}/../Filters/Common" "${CMAKE_CURRENT_BINARY_DIR}/Filters/Common")
add_subdirectory("${CMAKE_CURRENT_LIST_DIR}/../Rendering/Common" "${CMAKE_CURRENT_BINARY_DIR}/Rendering/Common")
