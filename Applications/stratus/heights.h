// SPDX-License-Identifier: BSD-3-Clause
// Defaults for data on the Earth: how much heights are exaggerated, and from where the camera looks.
#pragma once

#include "options.h"
#include "series.h"

#include <vtkDataSet.h>

namespace cli {

// Sets options that were not given, by the first step of a file: the exaggeration of heights, and azimuth and elevation of the camera. `in`
// and `grid` are null for a scene.
void set_heights(options& o, const series* in, vtkDataSet* grid);
} // namespace cli
