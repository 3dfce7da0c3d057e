# SPDX-License-Identifier: BSD-3-Clause
# The port builds the checkout that it is a part of. A port in a registry would begin with vcpkg_from_git() instead.
get_filename_component(SOURCE_PATH "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)

vcpkg_check_features(OUT_FEATURE_OPTIONS feature_options FEATURES vtk STRATUS_BUILD_VTK)
string(COMPARE EQUAL "${VCPKG_LIBRARY_LINKAGE}" "dynamic" shared)
vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS
    ${feature_options}
    "-DBUILD_SHARED_LIBS=${shared}"
    -DSTRATUS_BUILD_UDUNITS=OFF
    -DSTRATUS_BUILD_VDB=OFF
    -DSTRATUS_BUILD_TETGEN=OFF
    -DSTRATUS_BUILD_APPLICATIONS=OFF
    -DSTRATUS_BUILD_TESTING=OFF
    -DSTRATUS_BUILD_EXAMPLES=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(PACKAGE_NAME Stratus CONFIG_PATH lib/cmake/Stratus)
vcpkg_fixup_pkgconfig()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
