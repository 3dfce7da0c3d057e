// SPDX-License-Identifier: BSD-3-Clause
// Interface for drawing one kind of data: takes a time step, sets camera and transfer functions once, and draws every step with one caster.
#pragma once

#include "annotation.h"
#include "options.h"
#include "route.h"
#include "support.h"
#include "transfer.h"

#include <memory>
#include <utility>

namespace cli {

class drawing
{
public:
  virtual ~drawing() = default;
  // Takes a step's data in place of the last one's. The first step's structures are kept as far as the data allow.
  virtual void take(const routed& data) = 0;
  // Chooses transfer functions and camera by the step that was taken. A film looks once, so that its frames agree.
  virtual void look() = 0;
  // The range of the finite values that were taken; first > second: there are none.
  virtual std::pair<double, double> range() const = 0;
  // The annotations' input: camera, box, and the values' name.
  virtual scene_frame place() const = 0;
  virtual const transfer& functions() const = 0;
  virtual void draw(const stratus_image& image) = 0;
  // Computes numbers of the rays of the picture that was drawn.
  virtual void measure(const stratus_quantities& wanted) = 0;
  // Prints the last picture's rows: those before and after "a pixel".
  virtual void print_rows() const = 0;
  // Fails where the picture is not what it should be; it has been written.
  virtual void judge() const {}
};

// Throws usage for options that are for other data.
std::unique_ptr<drawing> make_volume_drawing(const options& o, context& core);
std::unique_ptr<drawing> make_grid_drawing(const options& o, context& core);
// Of the INPUT and its companions.
std::unique_ptr<drawing> make_several_drawing(const options& o, context& core);
} // namespace cli
