// SPDX-License-Identifier: BSD-3-Clause
// Pictures of unstructured grids of tetrahedra.
#pragma once

#include "options.h"

namespace cli {

// A file that says so by its name (.vtu, .pvtu) or its first lines (.vtk).
bool is_grid(const std::string& path);
void render_grid(const options& o);
} // namespace cli
