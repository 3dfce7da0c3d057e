# SPDX-License-Identifier: BSD-3-Clause
# Settings common to all Debian packages, of the main project and of ParaView's plugin. dpkg-shlibdeps finds a library's dependencies;
# ldconfig registers new libraries with the loader.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VENDOR "Stratus")
set(CPACK_PACKAGE_CONTACT "Stratus contributors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Draws uneven volumes and tetrahedra")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY "${CMAKE_BINARY_DIR}/packages")
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${CMAKE_BINARY_DIR}/lib")
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE zstd)
set(CPACK_COMPONENTS_ALL "")

# stratus_package(COMPONENT NAME DESCRIPTION DEPENDS...): the package NAME holds what the component installs.
macro (stratus_package component name description)
  string(TOUPPER "${component}" upper)
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME "${name}")
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${description}")
  string(REPLACE ";" ", " needs "${ARGN}")
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${needs}")
endmacro ()
