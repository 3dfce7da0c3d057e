// SPDX-License-Identifier: BSD-3-Clause
// Looks at and describes unstructured grids.
#pragma once

#include "mesh.h"
#include "options.h"

namespace cli {

// Places a camera that looks at the whole mesh.
stratus_camera place_camera(
  const context& core, const options& o, const mesh& m, const stratus_transfer& view, const double* room = nullptr);
// Describes a grid: stratus info.
void print_grid(const options& o, vtkDataSet* grid);
} // namespace cli
