// SPDX-License-Identifier: BSD-3-Clause
#include "camera.h"

#include "vtkBoundingBox.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace {
constexpr double margin = 1.02; // of the window around what it shows

// Finds the world bounds of the blocks that show anything, or of the whole volume where none does.
void shown_bounds(const cli::context& core, const stratus_volume& volume, const stratus_transfer& transfer, double bounds[6])
{
  stratus_value_range* ranges = nullptr;
  stratus_occupancy* occupancy = nullptr;
  stratus_volume part = volume;
  part.tiles = {};                       // they are of all of it
  constexpr double large = 2147483648.0; // values, whose blocks are at least as large by default
  const double values =
    static_cast<double>(volume.dimensions[0]) * static_cast<double>(volume.dimensions[1]) * static_cast<double>(volume.dimensions[2]);
  stratus_status status = stratus_value_range_create(core, &volume, values > large ? 0 : 8, &ranges);
  if (status == STRATUS_OK) {
    status = stratus_occupancy_create(core, ranges, &transfer, STRATUS_SAMPLING_MIDPOINT, &occupancy);
  }
  if (status == STRATUS_OK && stratus_occupancy_count(occupancy) > 0) {
    int64_t lo[3];
    int64_t hi[3];
    int size = 0;
    stratus_occupancy_bounds(occupancy, lo, hi);
    stratus_occupancy_blocks(occupancy, nullptr, &size);
    for (int a = 0; a < 3; ++a) {
      part.dimensions[a] = std::min(hi[a] * size + 1, volume.dimensions[a]) - lo[a] * size;
      if (volume.coordinates[a]) {
        part.coordinates[a] = volume.coordinates[a] + lo[a] * size;
        part.dimensions[a] = std::max<int64_t>(part.dimensions[a], volume.cell_centered ? 1 : 2);
        continue;
      }
      for (int r = 0; r < 3; ++r) {
        part.origin[r] += volume.direction[3 * r + a] * volume.spacing[a] * static_cast<double>(lo[a] * size);
      }
    }
  }
  stratus_occupancy_destroy(occupancy);
  stratus_value_range_destroy(ranges);
  core.check(status, "what is shown");
  core.check(stratus_volume_bounds(core, &part, bounds), "bounds");
}

// Points of an opacity that is 0 but at contours, by which a camera shows isosurfaces only.
std::vector<double> opacity_at(const std::vector<double>& contours)
{
  std::vector<double> points;
  for (double contour : std::set<double>(contours.begin(), contours.end())) {
    const double width = 1e-6 * std::fabs(contour) + 1e-30;
    if (points.empty() || contour - width > points[points.size() - 2]) {
      points.insert(points.end(), { contour - width, 0.0, contour, 1.0, contour + width, 0.0 });
    }
  }
  return points;
}

// Finds the tangents of the widest and highest view of the bounds at this elevation, for any azimuth, so that a turn about the upward axis
// neither cuts anything off nor changes the scale. In a parallel view these are half sizes instead of tangents.
void fit(double around, double upward, double elevation, double away, bool parallel, double& wide, double& high)
{
  wide = high = 0.0;
  for (int i = 0; i < 256; ++i) {
    const double angle = i * std::acos(-1.0) / 64.0;
    const double toward = around * std::cos(angle);
    const double height = i < 128 ? upward : -upward;
    const double depth = parallel ? 1.0 : away - toward * std::cos(elevation) - height * std::sin(elevation);
    wide = std::max(wide, std::fabs(around * std::sin(angle)) / depth);
    high = std::max(high, std::fabs(height * std::cos(elevation) - toward * std::sin(elevation)) / depth);
  }
}

// The tangents between which a view shows all corners of the bounds, from left to right and from bottom to top. In a parallel view these
// are lengths.
void fit_corners(const double bounds[6], const double eye[3], const double axes[3][3], bool parallel, double sides[4])
{
  for (int corner = 0; corner < 8; ++corner) {
    double along[3] = { 0.0, 0.0, 0.0 }; // to the right, up, forward
    for (int a = 0; a < 3; ++a) {
      const double place = bounds[2 * a + (corner >> a & 1)] - eye[a];
      for (int axis = 0; axis < 3; ++axis) {
        along[axis] += axes[axis][a] * place;
      }
    }
    for (int axis = 0; axis < 2; ++axis) {
      const double at = along[axis] / (parallel ? 1.0 : along[2]);
      sides[2 * axis] = corner == 0 ? at : std::min(sides[2 * axis], at);
      sides[2 * axis + 1] = corner == 0 ? at : std::max(sides[2 * axis + 1], at);
    }
  }
}

bool is_around_middle(const double bounds[6])
{
  return bounds[0] < 0.0 && bounds[1] > 0.0 && bounds[2] < 0.0 && bounds[3] > 0.0 && bounds[4] < 0.0 && bounds[5] > 0.0;
}

} // namespace

namespace cli {

stratus_camera place_camera(const context& core, const options& o, const stratus_volume& volume, const stratus_transfer& transfer, int up)
{
  return place_camera(core, o, { { &volume, transfer } }, up);
}

stratus_camera place_camera(const context& core, const options& o, const std::vector<shown_volume>& shown, int up, const double* room)
{
  const double degree = std::acos(-1.0) / 180.0;
  vtkBoundingBox box;
  double bounds[6];
  double focal[3];
  double half[3];
  double eye[3];
  const std::vector<double> at_contours = opacity_at(o.mode == STRATUS_MODE_ISOSURFACE ? o.contours : std::vector<double>());
  for (shown_volume one : shown) {
    double own[6];
    if (!at_contours.empty()) {
      one.transfer.opacity = at_contours.data();
      one.transfer.opacity_count = at_contours.size() / 2;
    }
    if (o.axes || (o.coast && !o.globe)) { // the box is seen as a whole
      core.check(stratus_volume_bounds(core, one.volume, own), "bounds");
    } else {
      shown_bounds(core, *one.volume, one.transfer, own);
    }
    box.AddBounds(own);
  }
  box.GetBounds(bounds);
  for (int a = 0; a < 3; ++a) {
    focal[a] = 0.5 * (bounds[2 * a] + bounds[2 * a + 1]);
    half[a] = 0.5 * (bounds[2 * a + 1] - bounds[2 * a]);
  }
  // Straight up or down, the view direction is parallel to the upward axis, so the elevation stays a thousandth of a degree off.
  const double elevation = std::min(std::max(o.elevation, -89.999), 89.999) * degree;
  const double around = std::hypot(half[(up + 1) % 3], half[(up + 2) % 3]);
  const double away = std::hypot(around, half[up]) / std::sin(15.0 * degree); // the same distance as stratus_scene_camera()
  double direction[3];
  direction[up] = std::sin(elevation);
  direction[(up + 1) % 3] = std::cos(elevation) * std::cos(o.azimuth * degree);
  direction[(up + 2) % 3] = std::cos(elevation) * std::sin(o.azimuth * degree);
  for (int a = 0; a < 3; ++a) {
    eye[a] = focal[a] + away * direction[a];
  }
  const double view_up[3] = { up == 0 ? 1.0 : 0.0, up == 1 ? 1.0 : 0.0, up == 2 ? 1.0 : 0.0 };
  const double aspect = room ? (room[1] - room[0]) / (room[3] - room[2]) : static_cast<double>(o.width) / o.height;
  double wide;
  double high;
  fit(around, half[up], elevation, away, o.parallel, wide, high);
  if (o.globe && is_around_middle(bounds)) { // the sphere around all fills the view
    double radius = 0.0;
    for (int a = 0; a < 3; ++a) {
      radius = std::max(radius, std::max(-bounds[2 * a], bounds[2 * a + 1]));
      eye[a] -= focal[a];
      focal[a] = 0.0;
    }
    wide = high = o.parallel ? radius : radius / std::sqrt(away * away - radius * radius);
  } else if (o.about.earth && !o.has_azimuth) { // a view that nobody turns: the box fills it
    const double level = std::hypot(direction[(up + 1) % 3], direction[(up + 2) % 3]);
    double axes[3][3], sides[4];
    axes[0][up] = 0.0;
    axes[0][(up + 1) % 3] = -direction[(up + 2) % 3] / level;
    axes[0][(up + 2) % 3] = direction[(up + 1) % 3] / level;
    for (int a = 0; a < 3; ++a) {
      axes[2][a] = -direction[a];
    }
    for (int a = 0; a < 3; ++a) {
      axes[1][a] = axes[0][(a + 1) % 3] * axes[2][(a + 2) % 3] - axes[0][(a + 2) % 3] * axes[2][(a + 1) % 3];
    }
    for (int pass = 0; pass < 4; ++pass) { // each moves the middle of what is seen to the middle of the picture, to first order
      fit_corners(bounds, eye, axes, o.parallel, sides);
      for (int a = 0; a < 3; ++a) {
        const double move = 0.5 * (o.parallel ? 1.0 : away) * ((sides[0] + sides[1]) * axes[0][a] + (sides[2] + sides[3]) * axes[1][a]);
        eye[a] += move;
        focal[a] += move;
      }
    }
    fit_corners(bounds, eye, axes, o.parallel, sides);
    wide = std::max(-sides[0], sides[1]);
    high = std::max(-sides[2], sides[3]);
  }
  const double scale = margin * std::max(high, wide / aspect) / o.zoom;
  stratus_camera camera;
  if (o.parallel) {
    core.check(stratus_camera_parallel(core, eye, focal, view_up, scale, aspect, &camera), "camera");
  } else {
    core.check(stratus_camera_perspective(core, eye, focal, view_up, 2.0 * std::atan(scale) / degree, aspect, &camera), "camera");
  }
  if (room) {
    core.check(stratus_camera_in_room(core, &camera, o.width, o.height, room, &camera), "camera");
  }
  return camera;
}

std::string describe(const stratus_camera& camera)
{
  const double half = std::sqrt(camera.up[0] * camera.up[0] + camera.up[1] * camera.up[1] + camera.up[2] * camera.up[2]);
  const double degree = std::acos(-1.0) / 180.0;
  return format("eye %.9g %.9g %.9g, forward %.9g %.9g %.9g, up %.9g %.9g %.9g, %s %.9g", camera.eye[0], camera.eye[1], camera.eye[2],
    camera.forward[0], camera.forward[1], camera.forward[2], camera.up[0] / half, camera.up[1] / half, camera.up[2] / half,
    camera.parallel ? "parallel scale" : "angle", camera.parallel ? half : 2.0 * std::atan(half) / degree);
}
} // namespace cli
