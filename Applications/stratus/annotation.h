// SPDX-License-Identifier: BSD-3-Clause
// Optional annotations around a volume: a box with axes, coastlines, a colour bar, a caption. The core draws them.
#pragma once

#include "options.h"
#include "support.h"
#include "transfer.h"

#include <string>

namespace cli {

struct scene_frame {
  stratus_camera camera;
  double bounds[6];              // of the data in the world
  double scale[3] = { 1, 1, 1 }; // world = scale * the data's coordinates
  std::string title;             // of the values
};

class annotation
{
public:
  explicit annotation(const options& o);
  bool any() const { return this->Options.axes || this->Options.coast || this->Options.color_bar || !this->Caption.empty(); }
  // Finds the part of the picture for the volume: left, right, bottom, top, in pixels. Returns false if the volume has all of it, because
  // there are no axes, and no colour bar in a view that the volume fills.
  bool find_room(const context& core, const scene_frame& frame, const transfer& look, double room[4]) const;
  // Draws the requested annotations onto the image's rgba. `time` replaces {time} in the caption.
  void draw(const context& core, const stratus_image& image, const scene_frame& frame, const transfer& look, const std::string& time) const;

private:
  struct lent;
  void lend(const scene_frame& frame, const transfer& look, lent& to) const;

  const options& Options;
  std::string Caption;
};

// Describes what axes show of data within the bounds, in one line: "longitude -97 .. -96.3 degrees, ... pressure 1000 .. 50 hPa".
std::string describe_axes(const options& o, const double bounds[6]);
} // namespace cli
