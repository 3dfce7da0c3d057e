// SPDX-License-Identifier: BSD-3-Clause
// Optional annotations around a volume: a box with axes, a colour bar, a caption. Drawing them needs no display. The box's far edges are
// behind the whole volume and its near edges in front of it, so that two layers give the right depth order.
#pragma once

#include "options.h"
#include "transfer.h"

#include <array>
#include <string>
#include <vector>

namespace cli {

// The name and unit of an axis of coordinates, "" if unknown.
struct axis_label {
  std::string name, units;
};

// Returns the part of a picture's width that axes, and boxes that fill the picture, leave to the colour bar.
double share_of_bar(const options& o);

struct scene_frame {
  stratus_camera camera;
  double bounds[6];              // of the data in the world
  double scale[3] = { 1, 1, 1 }; // world = scale * the data's coordinates
  std::array<axis_label, 3> axes;
  std::string title; // of the values, with their unit
};

class annotation
{
public:
  explicit annotation(const options& o);
  bool any() const { return this->Axes || this->Bar || !this->Caption.empty(); }
  // Draws the requested annotations onto an image of premultiplied floats, width x height, bottom row first. `time` replaces {time} in the
  // caption.
  void draw(std::vector<float>& rgba, int width, int height, const scene_frame& frame, const transfer& look, const std::string& time) const;

private:
  class layer;
  void draw_box(layer& under, layer& over, const scene_frame& frame) const;
  struct edge;
  edge find_edge(const layer& over, const scene_frame& frame, int axis, const bool facing[6]) const;
  void draw_numbers(layer& over, const scene_frame& frame, const edge& where, bool kilo) const;
  void draw_title(layer& over, const std::string& title, const edge& where) const;
  void draw_bar(layer& over, const scene_frame& frame, const transfer& look) const;

  bool Axes, Bar;
  std::string Caption;
  double Ink; // grey of lines and text, 0..1
};
} // namespace cli
