# SPDX-License-Identifier: BSD-3-Clause
# Sets stratus_version to "major.minor.patch" as the public header has it: the one place where the version stands.
file(STRINGS "${CMAKE_CURRENT_LIST_DIR}/../Core/stratus/version.h" stratus_version REGEX "^#define STRATUS_VERSION_(MAJOR|MINOR|PATCH) [0-9]+$")
string(REGEX REPLACE "#define STRATUS_VERSION_[A-Z]+ " "" stratus_version "${stratus_version}")
string(REPLACE ";" "." stratus_version "${stratus_version}")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${CMAKE_CURRENT_LIST_DIR}/../Core/stratus/version.h")
