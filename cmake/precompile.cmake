# SPDX-License-Identifier: BSD-3-Clause
# Most of the compile time of a C++ file here is spent in VTK's headers. Those that most files include are compiled once for each set of flags.
# CMAKE_DISABLE_PRECOMPILE_HEADERS turns this off: the preset "all" does, so that a header that a file forgot is missed there.
set(stratus_headers <algorithm> <array> <cmath> <cstring> <fstream> <functional> <limits> <map> <memory> <sstream> <string> <vector>
  <vtkCellArray.h> <vtkCellData.h> <vtkDataArray.h> <vtkFloatArray.h> <vtkImageData.h> <vtkInformation.h> <vtkInformationVector.h>
  <vtkMultiBlockDataSet.h> <vtkNew.h> <vtkObjectFactory.h> <vtkPointData.h> <vtkRectilinearGrid.h> <vtkSmartPointer.h>
  <vtkStreamingDemandDrivenPipeline.h> <vtkStructuredGrid.h> <vtkUnstructuredGrid.h>)
set(stratus_headers_rendering <vtkCamera.h> <vtkColorTransferFunction.h> <vtkPiecewiseFunction.h> <vtkRenderWindow.h> <vtkRenderer.h>
  <vtkVolume.h> <vtkVolumeProperty.h>)
set(stratus_headers_python <vtkPython.h> <PyVTKObject.h> <vtkPythonArgs.h> <vtkPythonOverload.h> <vtkPythonUtil.h>)

# stratus_precompiled(NAME HEADER... LINKS TARGET...): an object library that compiles the headers as programs do that link the targets; with
# PIC before the headers, as libraries do.
function (stratus_precompiled name)
  cmake_parse_arguments(arg "PIC" "" "LINKS" ${ARGN})
  set(empty "${CMAKE_CURRENT_BINARY_DIR}/${name}.cxx")
  file(CONFIGURE OUTPUT "${empty}" CONTENT "")
  add_library(${name} OBJECT "${empty}")
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ${arg_PIC})
  target_link_libraries(${name} PRIVATE ${arg_LINKS})
  target_precompile_headers(${name} PRIVATE ${arg_UNPARSED_ARGUMENTS})
endfunction ()

# stratus_precompile(NAME TARGET...): the targets take the headers of that library.
function (stratus_precompile name)
  foreach (target IN LISTS ARGN)
    get_target_property(real ${target} ALIASED_TARGET)
    if (NOT real)
      set(real ${target})
    endif ()
    target_precompile_headers(${real} REUSE_FROM ${name})
  endforeach ()
endfunction ()
