// SPDX-License-Identifier: BSD-3-Clause
// The Earth beneath data on a globe: a sphere that hides what is behind it.
#pragma once

#include "support.h"

#include "stratus.h"

#include <vector>

namespace cli {

class globe
{
public:
  // As large as the innermost points of the mesh allow.
  explicit globe(const stratus_mesh& mesh);
  // Ends the rays of a picture at the sphere. Sets the ends of the camera, which is a copy for this picture, and the image's opaque_depth,
  // which this object keeps.
  void end_rays(stratus_camera& camera, stratus_image& image);
  // Draws the sphere behind the picture, as the camera's light shows it, and coastlines if they are wanted: on top of data below the sea,
  // beneath all other data. ink: their grey.
  void draw(const context& core, const stratus_camera& camera, bool coast, double ink, const stratus_image& image) const;

private:
  double Radius;
  std::vector<float> Depth; // 1: the ray passes the sphere
  std::vector<float> Light; // of the sphere, 0..1
};
} // namespace cli
