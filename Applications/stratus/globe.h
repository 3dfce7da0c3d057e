// SPDX-License-Identifier: BSD-3-Clause
// The Earth beneath data on a globe, by the core: a sphere that hides what is behind it.
#pragma once

#include "support.h"

#include "stratus.h"

#include <vector>

namespace cli {

class globe
{
public:
  // As large as the innermost points of the mesh allow. ink: the grey of coastlines, if they are wanted.
  globe(const stratus_mesh& mesh, bool coast, double ink);
  // Ends the rays of a picture at the sphere. Sets the ends of the camera, which is a copy for this picture, and the image's opaque_depth,
  // which this object keeps.
  void end_rays(const context& core, stratus_camera& camera, stratus_image& image);
  // Draws the sphere and the coastlines behind the picture.
  void draw(const context& core, const stratus_camera& camera, const stratus_image& image) const;

private:
  stratus_globe Earth = stratus_globe_default();
  std::vector<float> Depth, Light;
};
} // namespace cli
