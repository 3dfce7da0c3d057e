// SPDX-License-Identifier: BSD-3-Clause
// Pictures of unstructured grids, and what is in them.
#pragma once

#include "mesh.h"
#include "options.h"

namespace cli {

// Looks at the whole of the mesh.
stratus_camera place_camera(const context& core, const options& o, const mesh& m, const stratus_transfer& view);
void render_grid(const options& o);
void print_grid(const options& o); // info
} // namespace cli
