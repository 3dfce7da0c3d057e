// SPDX-License-Identifier: BSD-3-Clause
// Light that is scattered (--mode path): conversion of options to the path tracer's settings, and the output of its report.
#pragma once

#include "options.h"
#include "support.h"
#include "transfer.h"

namespace cli {

// parts: which parts of the volume are drawn. `up` is the axis of heights, 0 to 2.
stratus_path_options paths_of(const options& o, const stratus_ray_cast_options& parts, int up);
// Prints the rows from "opacity" on.
void print_paths(const options& o, const context& core, const transfer& functions, const stratus_path_report& r);
} // namespace cli
