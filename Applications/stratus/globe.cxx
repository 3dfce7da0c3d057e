// SPDX-License-Identifier: BSD-3-Clause
#include "globe.h"

#include <algorithm>
#include <cmath>

namespace cli {

globe::globe(const stratus_mesh& mesh, bool coast, double ink)
{
  double least = INFINITY;
  const size_t count = static_cast<size_t>(mesh.point_count);
  for (size_t i = 0; i < count; ++i) {
    double square = 0.0;
    for (size_t axis = 3 * i; axis < 3 * i + 3; ++axis) {
      const double x = mesh.points ? mesh.points[axis] : static_cast<double>(mesh.float_points[axis]);
      square += x * x;
    }
    least = std::min(least, square);
  }
  this->Earth.innermost = std::sqrt(least);
  this->Earth.coast = coast ? 1 : 0;
  this->Earth.ink = ink;
}

void globe::end_rays(const context& core, stratus_camera& camera, stratus_image& image)
{
  const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  this->Depth.resize(pixels);
  this->Light.resize(pixels);
  core.check(
    stratus_globe_end_rays(core, &this->Earth, image.width, image.height, &camera, this->Depth.data(), this->Light.data()), "--globe");
  image.opaque_depth = this->Depth.data();
}

void globe::draw(const context& core, const stratus_camera& camera, const stratus_image& image) const
{
  core.check(stratus_globe_draw(core, &this->Earth, &camera, this->Light.data(), &image), "--globe");
}
} // namespace cli
