# SPDX-License-Identifier: BSD-3-Clause
# The VTK half: find, scan, build, wrap, install and export the modules. Sets stratus_vtk to ON if they are built.
include(CheckLanguage)

# Named one by one: a bare find of Debian's VTK wants Qt. The first list is for consumers, the second for tests and programs.
set(stratus_vtk_components CommonCore CommonDataModel CommonExecutionModel CommonMath CommonMisc CommonTransforms FiltersGeometry ImagingCore ImagingMath IOCore IOImage jsoncpp lz4
  RenderingCore RenderingOpenGL2 RenderingVolume RenderingVolumeOpenGL2)
set(stratus_vtk_programs ChartsCore CommonColor CommonSystem FiltersCore FiltersGeneral FiltersSources ImagingSources InteractionStyle
  IOEnSight IOExportGL2PS IOGeometry IOHDF IOLegacy IOXML IOXMLParser RenderingAnnotation
  RenderingContext2D RenderingContextOpenGL2 RenderingFreeType RenderingGL2PSOpenGL2 TestingRendering ViewsContext2D)

check_language(CXX)
if (CMAKE_CXX_COMPILER)
  enable_language(CXX)
  find_package(VTK 9.1 QUIET COMPONENTS ${stratus_vtk_components}
    OPTIONAL_COMPONENTS ${stratus_vtk_programs} Python WrappingPythonCore)
endif ()
if (NOT VTK_FOUND)
  if (STRATUS_BUILD_VTK STREQUAL "AUTO")
    message(STATUS "No VTK 9.1: building only the core")
    return ()
  endif ()
  message(FATAL_ERROR "STRATUS_BUILD_VTK is ${STRATUS_BUILD_VTK}, but VTK 9.1 was not found (Debian: libvtk9-dev) ${VTK_NOT_FOUND_MESSAGE}")
endif ()

set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)

# Without this property the modules' header that registers object factories is not generated outside VTK's own tree.
set_property(GLOBAL PROPERTY _vtk_module_autoinit_include "${VTK_AUTOINIT_INCLUDE}")
vtk_module_find_modules(stratus_module_files "${CMAKE_CURRENT_SOURCE_DIR}/Filters")
vtk_module_find_modules(stratus_module_files_rendering "${CMAKE_CURRENT_SOURCE_DIR}/Rendering")
list(APPEND stratus_module_files ${stratus_module_files_rendering})
include(cmake/openexr.cmake)
include(cmake/netcdf.cmake)
include(cmake/hdf5.cmake)
include(cmake/udunits.cmake)
include(cmake/proj.cmake)
include(cmake/codecs.cmake)
include(cmake/openvdb.cmake)
include(cmake/tetgen.cmake)
include(cmake/precompile.cmake)
include(cmake/common.cmake)
if (NOT stratus_tetgen)
  list(FILTER stratus_module_files EXCLUDE REGEX "/TetGen/vtk.module$")
endif ()
set(stratus_vtk ON)
vtk_module_scan(
  MODULE_FILES ${stratus_module_files}
  PROVIDES_MODULES stratus_modules
  WANT_BY_DEFAULT ON
  ENABLE_TESTS OFF)
vtk_module_build(
  MODULES ${stratus_modules}
  PACKAGE Stratus
  INSTALL_EXPORT StratusModules
  INSTALL_HEADERS ON
  HEADERS_DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/stratus"
  CMAKE_DESTINATION "${stratus_cmake_destination}"
  ${stratus_library_version}
  TEST_DIRECTORY_NAME NONE)
foreach (module IN LISTS stratus_modules)
  vtk_module_compile_options("${module}" PRIVATE -Wall -Wextra $<$<BOOL:${STRATUS_WERROR}>:-Werror>)
endforeach ()
stratus_precompiled(stratus-headers PIC ${stratus_headers} LINKS VTK::CommonDataModel VTK::CommonExecutionModel)
stratus_precompile(stratus-headers ${stratus_modules} ${stratus_common_libraries})

# The library of VTK's core. By its name programs decide whether their VTK is the one that this was built for.
_vtk_module_real_target(stratus_vtk_core VTK::CommonCore) # its name differs between versions of VTK
get_target_property(type ${stratus_vtk_core} TYPE)
if (type STREQUAL "INTERFACE_LIBRARY") # a VTK of kits, which join modules in one library
  set(stratus_vtk_core VTK::Common)
endif ()
set(stratus_vtk_library "$<TARGET_SONAME_FILE_NAME:${stratus_vtk_core}>")
add_subdirectory(Rendering/Factory)

# ---- Python: package `stratus` in addition to Debian's `vtk`
if (VTK_WRAP_PYTHON AND TARGET VTK::WrappingPythonCore)
  # The interpreter VTK was built with, not the first one on PATH.
  if (NOT Python3_EXECUTABLE AND EXISTS /usr/bin/python3)
    set(Python3_EXECUTABLE /usr/bin/python3 CACHE FILEPATH "Interpreter that VTK's wrapping was built for")
  endif ()
  find_package(Python3 QUIET COMPONENTS Interpreter Development.Module)
endif ()
set(stratus_python OFF)
if (Python3_FOUND AND Python3_Development.Module_FOUND)
  set(stratus_python ON)
  set(STRATUS_PYTHON_FOLDER "lib/python3/dist-packages" CACHE STRING "Folder of the Python package below the prefix")
  set(python_folder "${STRATUS_PYTHON_FOLDER}")
  if (SKBUILD) # a wheel contains only installed files
    set(python_folder ".")
  endif ()
  set(STRATUS_VTK_PYTHON_PACKAGE "vtkmodules" CACHE STRING "Package of VTK's Python modules, which builds of others may have renamed")
  vtk_module_wrap_python(
    MODULES ${stratus_modules}
    TARGET Stratus::PythonModules
    INSTALL_EXPORT StratusPython
    INSTALL_HEADERS OFF
    MODULE_DESTINATION "${python_folder}"
    PYTHON_PACKAGE "stratus"
    CMAKE_DESTINATION "${stratus_cmake_destination}"
    BUILD_STATIC OFF)
  set(stratus_python_imports "")
  stratus_precompiled(stratus-headers-python PIC ${stratus_headers_python} LINKS VTK::WrappingPythonCore VTK::Python)
  foreach (module IN LISTS stratus_modules)
    _vtk_module_get_module_property("${module}" PROPERTY "library_name" VARIABLE library)
    string(APPEND stratus_python_imports "from .${library} import *\n")
    if (TARGET ${library}Python)
      stratus_precompile(stratus-headers-python ${library}Python)
    endif ()
  endforeach ()
  set(stratus_package "${CMAKE_BINARY_DIR}/${python_folder}/stratus")
  configure_file(Rendering/Python/__init__.py.in "${stratus_package}/__init__.py" @ONLY)
  configure_file(Rendering/Python/_show.py.in "${stratus_package}/_show.py" @ONLY)
  configure_file(Rendering/Python/_needed.py.in "${CMAKE_BINARY_DIR}/_needed.py.in" @ONLY)
  file(GENERATE OUTPUT "${stratus_package}/_needed.py" INPUT "${CMAKE_BINARY_DIR}/_needed.py.in")
  # Arrays and pictures are taken and made as stratus_volume does.
  set(stratus_package_files Python/stratus_volume/_picture.py Python/stratus_volume/_values.py)
  foreach (file IN LISTS stratus_package_files)
    get_filename_component(name "${file}" NAME)
    configure_file("${file}" "${stratus_package}/${name}" COPYONLY)
  endforeach ()
  install(FILES "${stratus_package}/__init__.py" "${stratus_package}/_needed.py" "${stratus_package}/_show.py" ${stratus_package_files} DESTINATION "${python_folder}/stratus" COMPONENT python)
  if (SKBUILD)
    stratus_add_no_opencl("${stratus_package}/no_opencl")
    install(PROGRAMS "$<TARGET_FILE:stratus-no-opencl>" DESTINATION "${python_folder}/stratus/no_opencl" COMPONENT python)
  endif ()
else ()
  message(STATUS "No Python wrapping: VTK's or Python's development files are missing")
endif ()
