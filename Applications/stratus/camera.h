// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "options.h"
#include "support.h"

#include <vector>

namespace cli {

// Places a camera that looks from the options' azimuth and elevation about the axis `up`. The view contains all that the transfer function
// shows of the volume.
stratus_camera place_camera(const context& core, const options& o, const stratus_volume& volume, const stratus_transfer& transfer, int up);
struct shown_volume {
  const stratus_volume* volume;
  stratus_transfer transfer;
};

// The same for several volumes. room: left, right, bottom and top of the picture's part that contains the view, in pixels; null: all of it.
stratus_camera place_camera(
  const context& core, const options& o, const std::vector<shown_volume>& shown, int up, const double* room = nullptr);
// Describes eye, direction, up, and angle or parallel scale in one line, with enough digits for another program to reproduce the view.
std::string describe(const stratus_camera& camera);
} // namespace cli
