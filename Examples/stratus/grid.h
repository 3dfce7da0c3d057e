// SPDX-License-Identifier: BSD-3-Clause
// Pictures of unstructured grids, and what is in them.
#pragma once

#include "options.h"

namespace cli {

void render_grid(const options& o);
void print_grid(const options& o); // info
} // namespace cli
