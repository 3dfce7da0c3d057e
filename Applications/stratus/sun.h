// SPDX-License-Identifier: BSD-3-Clause
// The sun by time and place (--sun-time, --place), and the sun of --cloud.
#pragma once

#include "options.h"
#include "series.h"

#include <string>

class vtkDataSet;

namespace cli {

// Sets o.sun_at for a step, as `given` asks: by --sun-time; with --cloud and without any sun by the file's time and place, or a usual one.
// Returns a line about it, "" if it leaves o.sun_at. `in` and `grid` are null for a scene. Throws failure if time or place is not known,
// and if the sun is below the horizon.
std::string set_sun(options& o, const options& given, const series* in, vtkDataSet* grid, size_t step);
} // namespace cli
