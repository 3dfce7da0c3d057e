// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "options.h"
#include "support.h"

namespace cli {

// Looks at what the transfer function shows of the volume, from the options' azimuth and elevation about the axis `up`, so that all of it
// fits.
stratus_camera place_camera(const context& core, const options& o, const stratus_volume& volume, const stratus_transfer& transfer, int up);
// Eye, direction, up, and angle or parallel scale in one line, with the digits that another program needs to look from there.
std::string describe(const stratus_camera& camera);
} // namespace cli
