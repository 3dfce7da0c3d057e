# SPDX-License-Identifier: BSD-3-Clause
# Tests that build something anew, each one line of ctest's summary. Their programs must be installed, except Oclgrind, which Debian 13
# lacks.
find_program(CLANG clang REQUIRED)
find_program(OCLGRIND oclgrind)

# ---- clang-tidy over the core, as compile_commands.json has it
find_program(CLANG_TIDY NAMES clang-tidy-14 clang-tidy REQUIRED)
stratus_add_test(tidy style "${PROJECT_SOURCE_DIR}/Testing/tidy" "${CLANG_TIDY}" "${CMAKE_BINARY_DIR}")
stratus_test_needs(tidy NOTHING)

# ---- only the core, without VTK: under sanitizers, and with clang
# stratus_add_core_build(NAME CTEST_OPTIONS CONFIGURE_OPTION...)
function (stratus_add_core_build name ctest_options)
  stratus_add_test(${name} builds "${CMAKE_CTEST_COMMAND}" --build-and-test "${PROJECT_SOURCE_DIR}" "${CMAKE_BINARY_DIR}/${name}"
    --build-generator "${CMAKE_GENERATOR}" --build-project Stratus
    --build-options -DSTRATUS_BUILD_VTK=OFF -DSTRATUS_BUILD_TESTING=ON -DSTRATUS_WERROR=ON
      "-DCMAKE_INSTALL_PREFIX=${CMAKE_BINARY_DIR}/${name}/prefix" ${ARGN}
    --test-command "${CMAKE_CTEST_COMMAND}" --output-on-failure --parallel 2 ${ctest_options})
  stratus_test_needs(${name} NOTHING)
  set_tests_properties(${name} PROPERTIES TIMEOUT 2700 PROCESSORS 2)
endfunction ()
# By clang: gcc takes minutes a file where it checks vectors wider than the machine's for undefined behaviour. One instruction set is the
# same source as the others, here compiled for this processor: without its fused multiply-add each of them is a call of the C library, and
# tests take 2.5 times as long. Those that take minutes all the same to go through code of the others are left to
# `ctest --preset sanitizers`.
stratus_add_core_build(core_under_sanitizers
  "--exclude-regex;^test_(opacity_one|opacity_one_device|ray_cast_beyond_32_bits|scenes|ray_pages_device|exact_functions_device)$"
  -DCMAKE_C_COMPILER=${CLANG} -DSTRATUS_ISAS=portable "-DSTRATUS_SANITIZE=address,undefined" -DCMAKE_BUILD_TYPE=Debug
  "-DCMAKE_C_FLAGS_DEBUG=-O1 -g -march=native -Wno-pass-failed")
# Two instruction sets, so that they are compared; whoever builds with clang tests AVX-512. Devices have their own compilers, so their tests
# would show little that gcc's build does not show.
stratus_add_core_build(core_by_clang "--label-exclude;^Device$" -DCMAKE_C_COMPILER=${CLANG} -DCMAKE_BUILD_TYPE=Release -DSTRATUS_ISAS=avx2)

# ---- consumers of installed builds, which were moved: the core that clang built without VTK, and everything
function (stratus_add_installation name folder)
  stratus_add_test(${name} consumers "${PROJECT_SOURCE_DIR}/Testing/Consumers/install_and_move" "${folder}" "${CMAKE_BINARY_DIR}/${name}")
  if (NOT folder STREQUAL CMAKE_BINARY_DIR)
    stratus_test_needs(${name} NOTHING)
  endif ()
  set_tests_properties(${name} PROPERTIES FIXTURES_SETUP ${name})
endfunction ()
function (stratus_add_consumer name source prefix)
  stratus_add_test(${name} consumers "${CMAKE_CTEST_COMMAND}" --build-and-test "${PROJECT_SOURCE_DIR}/${source}" "${CMAKE_BINARY_DIR}/${name}"
    --build-generator "${CMAKE_GENERATOR}" --build-noclean --build-project ${name}
    --build-options "-DCMAKE_PREFIX_PATH=${CMAKE_BINARY_DIR}/${prefix}" -DCMAKE_BUILD_TYPE=Release
    --test-command ${ARGN})
  stratus_test_needs(${name} NOTHING)
  set_tests_properties(${name} PROPERTIES FIXTURES_REQUIRED ${prefix})
endfunction ()
stratus_add_installation(install_core "${CMAKE_BINARY_DIR}/core_by_clang")
set_tests_properties(core_by_clang PROPERTIES FIXTURES_SETUP core_by_clang)
set_tests_properties(install_core PROPERTIES FIXTURES_REQUIRED core_by_clang)
stratus_add_consumer(consumer_of_core Testing/Consumers/Core install_core "${CMAKE_BINARY_DIR}/consumer_of_core/consumer")
stratus_add_consumer(example_c_alone Examples/C install_core "${CMAKE_BINARY_DIR}/example_c_alone/cloud"
  "${CMAKE_BINARY_DIR}/example_c_alone/cloud.png")
if (stratus_vtk)
  stratus_add_installation(install_all "${CMAKE_BINARY_DIR}")
  stratus_add_consumer(consumer_of_vtk Testing/Consumers/VTK install_all ${stratus_display} "${CMAKE_BINARY_DIR}/consumer_of_vtk/consumer")
  stratus_add_consumer(example_cxx_alone Examples/Cxx install_all ${stratus_display}
    "${CMAKE_BINARY_DIR}/example_cxx_alone/ball-in-cloud" "${CMAKE_BINARY_DIR}/example_cxx_alone/ball-in-cloud.png")
  if (stratus_python)
    stratus_add_test(python_of_installation consumers "${CMAKE_COMMAND}" -E env
      "PYTHONPATH=${CMAKE_BINARY_DIR}/install_all/lib/python3/dist-packages" "${Python3_EXECUTABLE}" -c
      "import vtk, stratus; assert 'install_all' in stratus.__file__; assert issubclass(stratus.vtkStratusVolumeMapper, vtk.vtkVolumeMapper)")
    stratus_test_needs(python_of_installation NOTHING)
    set_tests_properties(python_of_installation PROPERTIES FIXTURES_REQUIRED install_all)
  endif ()
endif ()

# ---- Debian packages: made, unpacked and used
if (stratus_vtk AND TARGET stratus-command)
  find_program(CPACK cpack REQUIRED)
  stratus_add_test(packages consumers "${PROJECT_SOURCE_DIR}/Testing/Consumers/test_packages" "${CPACK}" "${CMAKE_BINARY_DIR}"
    "${CMAKE_BINARY_DIR}/Testing/Temporary/packages")
  set_tests_properties(packages PROPERTIES PROCESSORS 2)
endif ()

# ---- every kernel through clang's own OpenCL front end, warnings as errors
function (stratus_add_kernel_test name)
  stratus_add_test(${name} kernels ${ARGN})
  stratus_test_needs(${name} NOTHING)
endfunction ()
file(GLOB kernels CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/kernels/*/*.cl")
foreach (kernel IN LISTS kernels)
  get_filename_component(name "${kernel}" NAME_WE)
  set(compile "${PROJECT_SOURCE_DIR}/Testing/compile-kernel" "${CLANG}" "${kernel}")
  stratus_add_kernel_test(kernel_${name} ${compile} -DSTRATUS_WIDTH=1)
  if (name MATCHES "^(ray_cast|ray_several)$")
    stratus_add_kernel_test(kernel_${name}_pairs ${compile} -DSTRATUS_WIDTH=1 -DSTRATUS_REAL_PAIR=1)
  endif ()
  if (name STREQUAL "distance_field")
    stratus_add_kernel_test(kernel_${name}_avx512 ${compile} -mavx512f)
  endif ()
  if (name MATCHES "^(ray_cast|ray_several|first_hit|first_hit_wide|tetra_march|tetra_project)$")
    stratus_add_kernel_test(kernel_${name}_packets ${compile} -DSTRATUS_WIDTH=16)
    stratus_add_kernel_test(kernel_${name}_packets_avx512 ${compile} -DSTRATUS_WIDTH=16 -mavx512f)
  endif ()
endforeach ()

# ---- what a ray needs in a GPU's registers and private memory, by clang's compiler for AMD's
stratus_add_kernel_test(gpu_registers "${PROJECT_SOURCE_DIR}/Testing/gpu-registers" "${CLANG}")

# ---- the kernels on tiny volumes in Oclgrind's simulator: no invalid access, no data race
stratus_add_test(kernels_under_oclgrind kernels "${PROJECT_SOURCE_DIR}/Testing/under-oclgrind" "${OCLGRIND}"
  $<TARGET_FILE:test_device> test_device_tiny)
foreach (kind IN ITEMS adjacency bvh density distance_field first_hit radix_sort ray_pages structures tetra tree visibility_layers
    visibility_signs)
  stratus_add_test(${kind}_under_oclgrind kernels "${PROJECT_SOURCE_DIR}/Testing/under-oclgrind" "${OCLGRIND}"
    $<TARGET_FILE:test_device> test_${kind}_device --tiny)
endforeach ()

# ---- the plugin in ParaView
if (stratus_vtk AND stratus_exr AND TARGET stratus-command)
  include(paraview.cmake)
endif ()

# ---- the documentation: no warning
if (TARGET doc)
  stratus_add_test(documentation documentation "${PROJECT_SOURCE_DIR}/Testing/Documentation/test_doxygen" "${CMAKE_COMMAND}" "${CMAKE_BINARY_DIR}")
  stratus_test_needs(documentation NOTHING)
endif ()
