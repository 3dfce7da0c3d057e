// SPDX-License-Identifier: BSD-3-Clause
#include "globe.h"

#include <algorithm>
#include <cmath>

namespace cli {

// Cells between points are chords of the sphere. This is the sagitta of 3 degrees.
constexpr double chord = 0.9997;
constexpr double earth_radius = 6371000.0;          // as the readers have it
constexpr float color[3] = { 0.30f, 0.33f, 0.36f }; // of the sphere where it faces the eye, as of a map's land

globe::globe(const stratus_mesh& mesh)
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
  this->Radius = chord * std::sqrt(least);
}

void globe::end_rays(stratus_camera& camera, stratus_image& image)
{
  const size_t width = static_cast<size_t>(image.width), height = static_cast<size_t>(image.height);
  double distance = 0.0, length = 0.0;
  for (int a = 0; a < 3; ++a) {
    distance += camera.eye[a] * camera.eye[a];
    length += camera.forward[a] * camera.forward[a];
  }
  distance = std::sqrt(distance);
  length = std::sqrt(length);
  camera.far_k = 2.0 * (distance + this->Radius) / length; // behind all data, which are within two radii
  camera.near_k = camera.parallel ? -camera.far_k : 1e-3 * camera.far_k;
  this->Depth.assign(width * height, 1.0f);
  this->Light.assign(width * height, 0.0f);
  for (size_t pixel = 0; pixel < width * height; ++pixel) {
    const double u = (2.0 * static_cast<double>(pixel % width) + 1.0) / static_cast<double>(width) - 1.0;
    const double v = (2.0 * static_cast<double>(pixel / width) + 1.0) / static_cast<double>(height) - 1.0;
    double from[3], way[3], aa = 0.0, ab = 0.0, bb = 0.0;
    for (int a = 0; a < 3; ++a) {
      const double aside = u * camera.right[a] + v * camera.up[a];
      from[a] = camera.eye[a] + (camera.parallel ? aside : 0.0);
      way[a] = camera.forward[a] + (camera.parallel ? 0.0 : aside);
      aa += way[a] * way[a];
      ab += way[a] * from[a];
      bb += from[a] * from[a];
    }
    const double root = ab * ab - aa * (bb - this->Radius * this->Radius);
    const double k = root > 0.0 ? (-ab - std::sqrt(root)) / aa : INFINITY;
    if (k > camera.near_k && k < camera.far_k) {
      const double depth = camera.parallel ? (k - camera.near_k) / (camera.far_k - camera.near_k)
                                           : camera.far_k * (1.0 - camera.near_k / k) / (camera.far_k - camera.near_k);
      this->Depth[pixel] = static_cast<float>(depth);
      this->Light[pixel] = static_cast<float>(std::sqrt(root) / (std::sqrt(aa) * this->Radius)); // the cosine to the eye
    }
  }
  image.opaque_depth = this->Depth.data();
}

void globe::draw(const context& core, const stratus_camera& camera, bool coast, double ink, const stratus_image& image) const
{
  const bool below = this->Radius < 0.999 * earth_radius;
  std::vector<float> sphere(4 * this->Depth.size(), 0.0f);
  stratus_image ground = image;
  ground.rgba = sphere.data();
  for (size_t pixel = 0; pixel < this->Depth.size(); ++pixel) {
    for (size_t c = 0; this->Depth[pixel] < 1.0f && c < 4; ++c) {
      sphere[4 * pixel + c] = c < 3 ? color[c] * (0.3f + 0.7f * this->Light[pixel]) : 1.0f;
    }
  }
  stratus_annotation lines = stratus_annotation_default();
  lines.coast = coast ? 1 : 0;
  lines.globe = earth_radius;
  lines.ink = ink;
  if (!below) {
    core.check(stratus_annotation_draw(core, &lines, &camera, &ground, nullptr, 0, nullptr), "coastlines");
  }
  for (size_t i = 0; i < sphere.size(); ++i) {
    image.rgba[i] += (1.0f - image.rgba[i | 3]) * sphere[i]; // alpha is the last of four
  }
  if (below) {
    core.check(stratus_annotation_draw(core, &lines, &camera, &image, nullptr, 0, nullptr), "coastlines");
  }
}
} // namespace cli
