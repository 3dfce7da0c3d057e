#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# build.sh: the script of recipe.yaml. Builds the core, the VTK modules and the command line, and installs both Python packages.
set -euo pipefail
# Conda's compilers set CMAKE_ARGS, one word per option.
# shellcheck disable=SC2086
cmake -S . -B build-conda -G Ninja ${CMAKE_ARGS-} \
  -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_INSTALL_PREFIX="$PREFIX" \
  -DCMAKE_INSTALL_LIBDIR=lib \
  -DPython3_EXECUTABLE="$PYTHON" \
  -DSTRATUS_PYTHON_FOLDER="${SP_DIR#"$PREFIX"/}" \
  -DSTRATUS_BUILD_VTK=ON \
  -DSTRATUS_BUILD_TETGEN=OFF \
  -DSTRATUS_BUILD_TESTING=OFF \
  -DSTRATUS_BUILD_EXAMPLES=OFF
cmake --build build-conda
cmake --install build-conda
"$PYTHON" -m pip install . --no-deps --no-build-isolation -vv \
  --config-settings=cmake.define.STRATUS_PREBUILT="$PREFIX/lib/libstratus-core.so"
