# SPDX-License-Identifier: BSD-3-Clause
# The plugin in Debian's ParaView: unpacked (once a build folder), built against, and run. Needs apt-get and a network the first time, and OpenEXR, by
# whose floats the pictures are judged.
set(paraview "${CMAKE_BINARY_DIR}/paraview")
set(plugin_build "${CMAKE_BINARY_DIR}/paraview_plugin")
file(GLOB vtk_cmake "/usr/lib/*/cmake/VTK-9.[13]" "/usr/lib/*/cmake/vtk-9.[13]") # which of Debian's architectures
if (NOT vtk_cmake)
  message(FATAL_ERROR "STRATUS_TEST_BUILDS tests the plugin in Debian's ParaView, which goes with Debian's VTK 9.1 or 9.3: there is no "
    "/usr/lib/*/cmake/vtk-9.1. Install libvtk9-dev, or set STRATUS_TEST_BUILDS=OFF.")
endif ()
list(GET vtk_cmake 0 vtk_cmake)
set(paraview_series paraview-5.11) # of Debian 12
if (vtk_cmake MATCHES "9[.]3$")
  set(paraview_series paraview-5.13) # of Debian 13
endif ()
get_filename_component(paraview_cmake "${vtk_cmake}/../${paraview_series}" ABSOLUTE)
set(paraview_plugin "${plugin_build}/lib/${paraview_series}/plugins/Stratus/Stratus.so")

stratus_add_test(paraview_unpacked paraview "${PROJECT_SOURCE_DIR}/cmake/unpack-paraview" "${paraview}")
stratus_test_needs(paraview_unpacked NOTHING)
set_tests_properties(paraview_unpacked PROPERTIES FIXTURES_SETUP paraview)

stratus_add_test(paraview_plugin paraview "${CMAKE_CTEST_COMMAND}" --build-and-test "${PROJECT_SOURCE_DIR}/ParaView" "${plugin_build}"
  --build-generator "${CMAKE_GENERATOR}" --build-noclean --build-project StratusParaView
  --build-options -DCMAKE_BUILD_TYPE=Release -DSTRATUS_WERROR=ON "-DStratus_DIR=${CMAKE_BINARY_DIR}/lib/cmake/Stratus"
    "-DParaView_DIR=${paraview}${paraview_cmake}")
stratus_test_needs(paraview_plugin stratus-core)
set_tests_properties(paraview_plugin PROPERTIES FIXTURES_REQUIRED paraview FIXTURES_SETUP paraview_plugin TIMEOUT 2700 PROCESSORS 2)

foreach (test IN ITEMS pictures clouds datasets files lights quantities refined session streamed)
  stratus_add_test(paraview_${test} paraview ${stratus_display} "${paraview}/usr/bin/pvbatch" "${PROJECT_SOURCE_DIR}/Testing/ParaView/test_${test}.py"
    "${paraview_plugin}" $<TARGET_FILE:stratus-command> $<TARGET_FILE:compare-pictures>
    "${CMAKE_BINARY_DIR}/Testing/Temporary/paraview")
  set_tests_properties(paraview_${test} PROPERTIES FIXTURES_REQUIRED "paraview;paraview_plugin")
endforeach ()

stratus_add_test(paraview_tutorial paraview "${CMAKE_COMMAND}" -E env "STRATUS_PVBATCH=${paraview}/usr/bin/pvbatch"
  "STRATUS_PLUGIN=${paraview_plugin}" ${stratus_display}
  "${PROJECT_SOURCE_DIR}/Testing/Documentation/test_tutorials.py" "${CMAKE_BINARY_DIR}" "${CMAKE_BINARY_DIR}/Testing/Temporary/tutorials" paraview)
set_tests_properties(paraview_tutorial PROPERTIES FIXTURES_REQUIRED "paraview;paraview_plugin")

if (TARGET TestStratusVDBReader) # whose sparse grids are read
  set_tests_properties(paraview_files PROPERTIES DEPENDS TestStratusVDBReader)
endif ()

stratus_add_test(paraview_install paraview ${stratus_display} "${CMAKE_CURRENT_SOURCE_DIR}/ParaView/test_install" "${paraview}/usr" "${CMAKE_BINARY_DIR}"
  "${plugin_build}" "${CMAKE_BINARY_DIR}/Testing/Temporary/paraview_install")
stratus_test_needs(paraview_install stratus-core)
set_tests_properties(paraview_install PROPERTIES FIXTURES_REQUIRED "paraview;paraview_plugin")

if (XVFB_RUN) # a window that is large enough for all panels
  stratus_add_test(paraview_window paraview "${XVFB_RUN}" -a -s "-screen 0 1440x900x24 -noreset" "${CMAKE_CURRENT_SOURCE_DIR}/ParaView/test_window"
    "${paraview}/usr/bin" "${paraview_plugin}" "${CMAKE_BINARY_DIR}/Testing/Temporary/paraview_window")
  stratus_test_needs(paraview_window NOTHING)
  set_tests_properties(paraview_window PROPERTIES FIXTURES_REQUIRED "paraview;paraview_plugin")
else ()
  message(WARNING "There is no xvfb-run (Debian: xvfb): ParaView's window is not tested")
endif ()

find_program(STRATUS_MPIEXEC mpiexec)
mark_as_advanced(STRATUS_MPIEXEC)
if (STRATUS_MPIEXEC)
  stratus_add_test(paraview_ranks paraview ${stratus_display} "${CMAKE_CURRENT_SOURCE_DIR}/ParaView/test_ranks" "${paraview}/usr/bin/pvbatch"
    "${paraview_plugin}" "${CMAKE_BINARY_DIR}/Testing/Temporary/paraview_ranks")
  stratus_test_needs(paraview_ranks NOTHING)
  set_tests_properties(paraview_ranks PROPERTIES FIXTURES_REQUIRED "paraview;paraview_plugin" PROCESSORS 2)
  stratus_add_test(paraview_bad_ranks paraview ${stratus_display} "${CMAKE_CURRENT_SOURCE_DIR}/ParaView/test_bad_ranks" "${paraview}/usr/bin/pvbatch"
    "${paraview_plugin}" "${CMAKE_BINARY_DIR}/Testing/Temporary/paraview_bad_ranks")
  stratus_test_needs(paraview_bad_ranks NOTHING)
  set_tests_properties(paraview_bad_ranks PROPERTIES FIXTURES_REQUIRED "paraview;paraview_plugin" PROCESSORS 2)

  stratus_add_test(paraview_server paraview ${stratus_display} "${CMAKE_CURRENT_SOURCE_DIR}/ParaView/test_server" "${paraview}/usr/bin"
    "${paraview_plugin}" "${CMAKE_BINARY_DIR}/Testing/Temporary/paraview_server")
  stratus_test_needs(paraview_server NOTHING)
  set_tests_properties(paraview_server PROPERTIES FIXTURES_REQUIRED "paraview;paraview_plugin" PROCESSORS 2)

  # A simulation that draws itself: a project of its own, too.
  set(in_situ_build "${CMAKE_BINARY_DIR}/in_situ")
  stratus_add_test(paraview_in_situ_build paraview "${CMAKE_CTEST_COMMAND}" --build-and-test "${PROJECT_SOURCE_DIR}/Examples/in-situ" "${in_situ_build}"
    --build-generator "${CMAKE_GENERATOR}" --build-noclean --build-project StratusInSitu
    --build-options "-DParaView_DIR=${paraview}${paraview_cmake}" "-DPython3_EXECUTABLE=/usr/bin/python3")
  stratus_test_needs(paraview_in_situ_build NOTHING)
  set_tests_properties(paraview_in_situ_build PROPERTIES FIXTURES_REQUIRED paraview FIXTURES_SETUP paraview_in_situ)
  stratus_add_test(paraview_in_situ paraview ${stratus_display} "${CMAKE_CURRENT_SOURCE_DIR}/ParaView/test_in_situ" "${in_situ_build}/plume-in-situ"
    "${paraview}/usr/bin/pvbatch" "${paraview_plugin}" "${CMAKE_BINARY_DIR}/Testing/Temporary/paraview_in_situ")
  stratus_test_needs(paraview_in_situ NOTHING)
  set_tests_properties(paraview_in_situ PROPERTIES FIXTURES_REQUIRED "paraview;paraview_plugin;paraview_in_situ" PROCESSORS 2)
endif ()
