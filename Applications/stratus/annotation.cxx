// SPDX-License-Identifier: BSD-3-Clause
#include "annotation.h"

#include "picture.h"
#include "text.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace cli {

namespace {
constexpr int text_size = 13, title_size = 15, bar_wide = 16, margin = 14;
using vec = std::array<double, 3>;

double dot(const double* a, const double* b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// The corner of the box with the upper bound along the axes whose bit is set.
vec corner(const double bounds[6], int bits)
{
  return { { bounds[bits & 1], bounds[2 + (bits >> 1 & 1)], bounds[4 + (bits >> 2 & 1)] } };
}

std::string short_number(double value)
{
  return format("%.6g", std::fabs(value) < 1e-300 ? 0.0 : value);
}

// Returns round values within low..high, at most about `most`.
std::vector<double> ticks_of(double low, double high, int most)
{
  std::vector<double> ticks;
  const double step = round_step((high - low) / most);
  for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step && ticks.size() < 50; i += 1.0) {
    ticks.push_back(i * step);
  }
  return ticks;
}
} // namespace

// A picture of one's own that is put before or behind another.
class annotation::layer
{
public:
  layer(int width, int height, const stratus_camera& camera, double ink)
      : Width(width), Height(height), Camera(camera), Ink(static_cast<float>(ink)),
        Rgba(4 * static_cast<size_t>(width) * static_cast<size_t>(height))
  {
  }

  int width() const { return this->Width; }
  int height() const { return this->Height; }
  const std::vector<float>& rgba() const { return this->Rgba; }

  void put(int x, int y, float coverage, float r, float g, float b)
  {
    if (x < 0 || y < 0 || x >= this->Width || y >= this->Height || coverage <= 0.0f) {
      return;
    }
    float* to = &this->Rgba[4 * (static_cast<size_t>(y) * static_cast<size_t>(this->Width) + static_cast<size_t>(x))];
    const float color[4] = { r * coverage, g * coverage, b * coverage, coverage };
    for (int c = 0; c < 4; ++c) {
      to[c] = color[c] + (1.0f - coverage) * to[c];
    }
  }

  // The k of a point along its ray, and its place in pixels. k <= 0 in perspective: it is behind the eye.
  double project(const vec& world, double& x, double& y) const
  {
    const double d[3] = { world[0] - this->Camera.eye[0], world[1] - this->Camera.eye[1], world[2] - this->Camera.eye[2] };
    const double k = dot(d, this->Camera.forward) / dot(this->Camera.forward, this->Camera.forward);
    const double depth = this->Camera.parallel ? 1.0 : k;
    x = (dot(d, this->Camera.right) / dot(this->Camera.right, this->Camera.right) / depth + 1.0) * 0.5 * this->Width - 0.5;
    y = (dot(d, this->Camera.up) / dot(this->Camera.up, this->Camera.up) / depth + 1.0) * 0.5 * this->Height - 0.5;
    return depth;
  }

  void line(const vec& a, const vec& b)
  {
    double xa, ya, xb, yb;
    const double ka = this->project(a, xa, ya), kb = this->project(b, xb, yb);
    if (ka > 1e-9 && kb > 1e-9) { // an eye within the box does not see the edges beside it
      this->flat_line(xa, ya, xb, yb);
    }
  }

  // A line one pixel wide.
  void flat_line(double xa, double ya, double xb, double yb)
  {
    const double dx = xb - xa, dy = yb - ya, length = std::max(std::hypot(dx, dy), 1e-9);
    const auto bound = [](double value, int most) { return static_cast<int>(std::min(std::max(value, -2.0), most + 2.0)); };
    const int y0 = bound(std::min(ya, yb) - 1.0, this->Height), y1 = bound(std::max(ya, yb) + 2.0, this->Height);
    const int x0 = bound(std::min(xa, xb) - 1.0, this->Width), x1 = bound(std::max(xa, xb) + 2.0, this->Width);
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const double t = std::min(std::max(((x - xa) * dx + (y - ya) * dy) / (length * length), 0.0), 1.0);
        const double distance = std::hypot(x - xa - t * dx, y - ya - t * dy);
        this->put(x, y, static_cast<float>(std::min(std::max(1.1 - distance, 0.0), 1.0)) * 0.8f, this->Ink, this->Ink, this->Ink);
      }
    }
  }

  // Writes text with the point (x, y) at the part (across, along) of its size.
  void write(const std::string& text, double x, double y, double across, double along, int size)
  {
    const text_image image = render_text(text, size);
    const int left = static_cast<int>(std::lround(x - across * image.width)),
              bottom = static_cast<int>(std::lround(y - along * image.height));
    for (int j = 0; j < image.height; ++j) {
      for (int i = 0; i < image.width; ++i) {
        const float coverage = static_cast<float>(image.coverage[static_cast<size_t>(j * image.width + i)]) / 255.0f;
        this->put(left + i, bottom + j, coverage, this->Ink, this->Ink, this->Ink);
      }
    }
  }

private:
  int Width, Height;
  const stratus_camera& Camera;
  float Ink;
  std::vector<float> Rgba;
};

annotation::annotation(const options& o) : Axes(o.axes), Bar(o.color_bar), Caption(o.caption)
{
  const background behind = parse_background(o.background);
  double light = 0.0;
  for (int c = 0; c < 3; ++c) {
    light += (behind.bottom[c] + behind.top[c]) / 6.0;
  }
  this->Ink = behind.transparent ? 0.5 : light > 0.4 ? 0.1 : 0.9;
}

// An edge is near if one of its two faces looks towards the eye.
void annotation::draw_box(layer& under, layer& over, const scene_frame& frame) const
{
  bool facing[6];
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const double outward = face % 2 ? 1.0 : -1.0;
    facing[face] = outward * (frame.camera.parallel ? -frame.camera.forward[axis] : frame.camera.eye[axis] - frame.bounds[face]) > 0.0;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    for (int edge = 0; edge < 4; ++edge) {
      const int high_a = edge & 1, high_b = edge >> 1, bits = high_a << a | high_b << b;
      layer& where = facing[2 * a + high_a] || facing[2 * b + high_b] ? over : under;
      where.line(corner(frame.bounds, bits), corner(frame.bounds, bits | 1 << axis));
    }
    this->draw_axis(over, frame, axis, facing);
  }
}

// Puts ticks and numbers along an edge on the outline of the box: the lowest one in the picture, or of an axis that stands upright, the
// leftmost.
void annotation::draw_axis(layer& over, const scene_frame& frame, int axis, const bool facing[6]) const
{
  const int a = (axis + 1) % 3, b = (axis + 2) % 3;
  const double low = frame.bounds[2 * axis] / frame.scale[axis], high = frame.bounds[2 * axis + 1] / frame.scale[axis];
  int best = -1;
  double least = INFINITY, x0 = 0.0, y0 = 0.0, x1 = 0.0, y1 = 0.0, middle_x = 0.0, middle_y = 0.0;
  const vec middle = { { 0.5 * (frame.bounds[0] + frame.bounds[1]), 0.5 * (frame.bounds[2] + frame.bounds[3]),
    0.5 * (frame.bounds[4] + frame.bounds[5]) } };
  over.project(middle, middle_x, middle_y);
  for (int edge = 0; edge < 4; ++edge) {
    const int bits = (edge & 1) << a | (edge >> 1) << b;
    if (facing[2 * a + (edge & 1)] == facing[2 * b + (edge >> 1)]) {
      continue;
    }
    const bool seen =
      over.project(corner(frame.bounds, bits), x0, y0) > 1e-9 && over.project(corner(frame.bounds, bits | 1 << axis), x1, y1) > 1e-9;
    const double order = std::fabs(y1 - y0) > 2.0 * std::fabs(x1 - x0) ? x0 + x1 : y0 + y1;
    if (seen && order < least) {
      least = order;
      best = bits;
    }
  }
  if (best < 0 || !(high > low)) {
    return;
  }
  const vec from = corner(frame.bounds, best);
  over.project(from, x0, y0);
  over.project(corner(frame.bounds, best | 1 << axis), x1, y1);
  const double length = std::hypot(x1 - x0, y1 - y0);
  double out_x = y1 - y0, out_y = x0 - x1; // across the edge, away from the middle
  const double sign = out_x * (x0 - middle_x) + out_y * (y0 - middle_y) < 0.0 ? -1.0 : 1.0;
  out_x *= sign / std::max(length, 1e-9);
  out_y *= sign / std::max(length, 1e-9);
  const bool kilo = frame.length_units == "m" && std::max(std::fabs(low), std::fabs(high)) >= 10000.0;
  const double unit = kilo ? 1000.0 : 1.0;
  for (double tick : ticks_of(low / unit, high / unit, std::max(1, static_cast<int>(length / 60.0)))) {
    vec place = from;
    double x, y;
    place[static_cast<size_t>(axis)] = tick * unit * frame.scale[axis];
    over.project(place, x, y);
    over.flat_line(x, y, x + 5.0 * out_x, y + 5.0 * out_y);
    over.write(short_number(tick), x + 9.0 * out_x, y + 9.0 * out_y, 0.5 - 0.5 * out_x, 0.5 - 0.5 * out_y, text_size);
  }
  const std::string units = kilo ? "km" : frame.length_units;
  over.write(std::string(1, "xyz"[axis]) + (units.empty() ? "" : " (" + units + ")"), 0.5 * (x0 + x1) + 50.0 * out_x,
    0.5 * (y0 + y1) + 34.0 * out_y, 0.5 - 0.5 * out_x, 0.5 - 0.5 * out_y, title_size);
}

void annotation::draw_bar(layer& over, const scene_frame& frame, const transfer& look) const
{
  const int tall = over.height() * 6 / 10, bottom = (over.height() - tall) / 2;
  const double low = look.low, high = look.high > look.low ? look.high : look.low + 1.0;
  const auto place = [&](double value) {
    return look.logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
  };
  std::vector<double> ticks;
  if (look.logarithmic) {
    for (int power = static_cast<int>(std::floor(std::log10(low))); power <= static_cast<int>(std::log10(high)) + 1; ++power) {
      ticks.push_back(std::pow(10.0, power));
    }
  } else {
    ticks = ticks_of(low, high, std::max(1, tall / 32));
  }
  int widest = 0;
  for (double tick : ticks) {
    widest = std::max(widest, render_text(short_number(tick), text_size).width);
  }
  const int left = over.width() - margin - widest - 6 - bar_wide;
  for (int j = 0; j < tall; ++j) {
    const double t = (j + 0.5) / tall, value = look.logarithmic ? low * std::pow(high / low, t) : low + t * (high - low);
    float rgb[3];
    look.color_at(value, rgb);
    for (int i = 0; i < bar_wide; ++i) {
      over.put(left + i, bottom + j, 1.0f, rgb[0], rgb[1], rgb[2]);
    }
  }
  for (double tick : ticks) {
    const double t = place(tick);
    if (t > -1e-6 && t < 1.0 + 1e-6) {
      over.write(short_number(tick), left + bar_wide + 6, bottom + t * (tall - 1), 0.0, 0.5, text_size);
    }
  }
  over.write(frame.title, over.width() - margin, bottom + tall + 10, 1.0, 0.0, title_size);
}

void annotation::draw(
  std::vector<float>& rgba, int width, int height, const scene_frame& frame, const transfer& look, const std::string& time) const
{
  layer under(width, height, frame.camera, this->Ink), over(width, height, frame.camera, this->Ink);
  if (this->Axes) {
    this->draw_box(under, over, frame);
  }
  if (this->Bar) {
    this->draw_bar(over, frame, look);
  }
  std::string caption = this->Caption;
  for (size_t at; (at = caption.find("{time}")) != std::string::npos;) {
    caption.replace(at, 6, time);
  }
  if (!caption.empty()) {
    over.write(caption, margin, height - margin, 0.0, 1.0, title_size);
  }
  for (size_t i = 0; i < rgba.size(); i += 4) {
    const float* const o = &over.rgba()[i];
    const float* const u = &under.rgba()[i];
    const float behind = 1.0f - rgba[i + 3];
    for (size_t c = 0; c < 4; ++c) {
      rgba[i + c] += behind * u[c];
    }
    for (size_t c = 0; c < 4; ++c) {
      rgba[i + c] = o[c] + (1.0f - o[3]) * rgba[i + c];
    }
  }
}
} // namespace cli
