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
constexpr double bar_room = 96.0; // pixels for the colour bar and its numbers
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
  return format("%.9g", std::fabs(value) < 1e-300 ? 0.0 : value);
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

// A rectangle of pixels, with its last column and row.
struct pixels {
  int left, bottom, right, top;
  bool meets(const pixels& other) const
  {
    return this->left <= other.right && other.left <= this->right && this->bottom <= other.top && other.bottom <= this->top;
  }
};

// Turns text by a right angle, so that it is read from below.
text_image turn(const text_image& image)
{
  text_image turned;
  turned.width = image.height;
  turned.height = image.width;
  turned.coverage.resize(image.coverage.size());
  for (int j = 0; j < image.height; ++j) {
    for (int i = 0; i < image.width; ++i) {
      turned.coverage[static_cast<size_t>(i * turned.width + image.height - 1 - j)] =
        image.coverage[static_cast<size_t>(j * image.width + i)];
    }
  }
  return turned;
}
} // namespace

double share_of_bar(const options& o)
{
  return (o.axes || (o.about.earth && !o.has_azimuth)) && o.color_bar ? std::min(bar_room / o.width, 0.4) : 0.0;
}

// An edge of the box in the picture, along which an axis has its numbers.
struct annotation::edge {
  int axis = 0;
  vec from = { { 0.0, 0.0, 0.0 } };      // in the world
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0; // both ends, in pixels
  double out_x = 0, out_y = 0;           // across the edge, away from the box
  bool seen = false;
  double length() const { return std::hypot(this->x1 - this->x0, this->y1 - this->y0); }
};

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
    if (ka > 1e-9 && kb > 1e-9) { // an eye within the box does not see the edges behind it
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

  // Returns the pixels of text of which the point (x, y) is at the part (across, along) of its size.
  static pixels place(const text_image& image, double x, double y, double across, double along)
  {
    const int left = static_cast<int>(std::lround(x - across * image.width)),
              bottom = static_cast<int>(std::lround(y - along * image.height));
    return { left, bottom, left + image.width - 1, bottom + image.height - 1 };
  }

  void write(const text_image& image, const pixels& where)
  {
    for (int j = 0; j < image.height; ++j) {
      for (int i = 0; i < image.width; ++i) {
        const float coverage = static_cast<float>(image.coverage[static_cast<size_t>(j * image.width + i)]) / 255.0f;
        this->put(where.left + i, where.bottom + j, coverage, this->Ink, this->Ink, this->Ink);
      }
    }
    this->take(where);
  }

  // Keeps other text out of these pixels.
  void take(const pixels& where) { this->Taken.push_back(where); }

  // Keeps titles off the line.
  void keep_off(double xa, double ya, double xb, double yb)
  {
    const int count = static_cast<int>(std::min(std::hypot(xb - xa, yb - ya) / 4.0, 4096.0)) + 1;
    for (int i = 0; i <= count; ++i) {
      const double t = static_cast<double>(i) / count, x = xa + t * (xb - xa), y = ya + t * (yb - ya);
      if (x >= 0.0 && y >= 0.0 && x < this->Width && y < this->Height) {
        const int left = static_cast<int>(x) - 2, bottom = static_cast<int>(y) - 2;
        this->Lines.push_back({ left, bottom, left + 4, bottom + 4 });
      }
    }
  }

  // Returns whether text there is whole, and meets neither other text nor, if it is a title, a line.
  bool is_free(const pixels& where, bool title) const
  {
    const int gap = title ? 4 : 0;
    const pixels wide = { where.left - gap, where.bottom - gap, where.right + gap, where.top + gap };
    const auto meets = [&wide](const pixels& other) { return wide.meets(other); };
    return where.left >= 2 && where.bottom >= 2 && where.right < this->Width - 2 && where.top < this->Height - 2 &&
      std::none_of(this->Taken.begin(), this->Taken.end(), meets) && !(title && std::any_of(this->Lines.begin(), this->Lines.end(), meets));
  }

private:
  int Width, Height;
  const stratus_camera& Camera;
  float Ink;
  std::vector<float> Rgba;
  std::vector<pixels> Taken, Lines;
};

annotation::annotation(const options& o)
    : Axes(o.axes), Bar(o.color_bar), Caption(o.caption + (o.caption.empty() || o.heights.empty() ? "" : ", ") + o.heights)
{
  const background behind = parse_background(o.background);
  this->Ink = behind.transparent ? 0.5 : is_bright(behind) ? 0.1 : 0.9;
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
      double x0, y0, x1, y1;
      if (over.project(corner(frame.bounds, bits), x0, y0) > 1e-9 && over.project(corner(frame.bounds, bits | 1 << axis), x1, y1) > 1e-9) {
        over.keep_off(x0, y0, x1, y1);
      }
    }
  }
  // Axes of length that are stretched alike have one unit, so that their numbers compare. Titles are last, because they go where there is
  // room.
  bool kilo[3];
  for (int axis = 0; axis < 3; ++axis) {
    double longest = 0.0;
    for (int side = 0; side < 6; ++side) {
      if (frame.axes[static_cast<size_t>(side / 2)].units == "m" && frame.scale[side / 2] == frame.scale[axis]) {
        longest = std::max(longest, std::fabs(frame.bounds[side] / frame.scale[axis]));
      }
    }
    kilo[axis] = longest >= 10000.0;
  }
  std::array<edge, 3> edges;
  for (int axis = 0; axis < 3; ++axis) {
    edges[static_cast<size_t>(axis)] = this->find_edge(over, frame, axis, facing);
    this->draw_numbers(over, frame, edges[static_cast<size_t>(axis)], kilo[axis]);
  }
  for (const edge& one : edges) {
    const axis_label& label = frame.axes[static_cast<size_t>(one.axis)];
    const std::string units = label.units == "m" && kilo[one.axis] ? "km" : label.units;
    const std::string name = label.name.empty() ? std::string(1, "xyz"[one.axis]) : label.name;
    if (one.seen) {
      this->draw_title(over, name + (units.empty() ? "" : " (" + units + ")"), one);
    }
  }
}

// Finds the edge on the outline of the box that an axis has its numbers along: the lowest one in the picture, or of an axis that stands
// upright, the leftmost.
annotation::edge annotation::find_edge(const layer& over, const scene_frame& frame, int axis, const bool facing[6]) const
{
  const int a = (axis + 1) % 3, b = (axis + 2) % 3;
  edge result;
  result.axis = axis;
  int best = -1;
  double least = INFINITY, middle_x = 0.0, middle_y = 0.0;
  const vec middle = { { 0.5 * (frame.bounds[0] + frame.bounds[1]), 0.5 * (frame.bounds[2] + frame.bounds[3]),
    0.5 * (frame.bounds[4] + frame.bounds[5]) } };
  over.project(middle, middle_x, middle_y);
  for (int i = 0; i < 4; ++i) {
    const int bits = (i & 1) << a | (i >> 1) << b;
    if (facing[2 * a + (i & 1)] == facing[2 * b + (i >> 1)]) {
      continue;
    }
    double x0 = 0.0, y0 = 0.0, x1 = 0.0, y1 = 0.0;
    const bool seen =
      over.project(corner(frame.bounds, bits), x0, y0) > 1e-9 && over.project(corner(frame.bounds, bits | 1 << axis), x1, y1) > 1e-9;
    const double order = std::fabs(y1 - y0) > 2.0 * std::fabs(x1 - x0) ? x0 + x1 : y0 + y1;
    if (seen && order < least) {
      least = order;
      best = bits;
    }
  }
  if (best < 0 || !(frame.bounds[2 * axis + 1] > frame.bounds[2 * axis])) {
    return result;
  }
  result.seen = true;
  result.from = corner(frame.bounds, best);
  over.project(result.from, result.x0, result.y0);
  over.project(corner(frame.bounds, best | 1 << axis), result.x1, result.y1);
  const double across_x = result.y1 - result.y0, across_y = result.x0 - result.x1;
  const double sign = across_x * (result.x0 - middle_x) + across_y * (result.y0 - middle_y) < 0.0 ? -1.0 : 1.0;
  result.out_x = across_x * sign / std::max(result.length(), 1e-9);
  result.out_y = across_y * sign / std::max(result.length(), 1e-9);
  return result;
}

// Puts ticks along an edge, and numbers where there is room for them. A short axis has one number at least.
void annotation::draw_numbers(layer& over, const scene_frame& frame, const edge& where, bool kilo) const
{
  const size_t axis = static_cast<size_t>(where.axis);
  const double unit = kilo && frame.axes[axis].units == "m" ? 1000.0 : 1.0;
  const double low = frame.bounds[2 * axis] / frame.scale[axis] / unit, high = frame.bounds[2 * axis + 1] / frame.scale[axis] / unit;
  if (!where.seen) {
    return;
  }
  std::vector<double> ticks;
  for (int most = std::max(1, static_cast<int>(where.length() / 60.0)); ticks.empty() && most < 100; most *= 2) {
    ticks = ticks_of(low, high, most);
  }
  for (double tick : ticks) {
    vec place = where.from;
    double x, y;
    place[axis] = tick * unit * frame.scale[axis];
    over.project(place, x, y);
    over.flat_line(x, y, x + 5.0 * where.out_x, y + 5.0 * where.out_y);
    const text_image number = render_text(short_number(tick), text_size);
    const pixels at = layer::place(number, x + 9.0 * where.out_x, y + 9.0 * where.out_y, 0.5 - 0.5 * where.out_x, 0.5 - 0.5 * where.out_y);
    if (over.is_free(at, false)) {
      over.write(number, at);
    }
  }
}

// Writes an axis' title as near to the middle of its edge as there is room outside of the box, along the edge of an upright axis if it can,
// else beyond one of its ends. A picture without room has no title.
void annotation::draw_title(layer& over, const std::string& title, const edge& where) const
{
  const text_image level = render_text(title, title_size), turned = turn(level);
  const double length = std::max(where.length(), 1e-9), x = (where.x1 - where.x0) / length, y = (where.y1 - where.y0) / length;
  const bool upright = std::fabs(y) > 2.0 * std::fabs(x);
  const text_image* best = nullptr;
  pixels place = { 0, 0, 0, 0 };
  double least = INFINITY;
  const auto attempt = [&](const text_image& image, double at_x, double at_y, double to_x, double to_y, double cost) {
    const pixels at = layer::place(image, at_x, at_y, 0.5 - 0.5 * to_x, 0.5 - 0.5 * to_y);
    if (cost < least && over.is_free(at, true)) {
      least = cost;
      best = &image;
      place = at;
    }
  };
  for (double distance = 14.0; distance <= 90.0; distance += 4.0) {
    for (double part = 0.05; part < 1.0; part += 0.05) {
      const double at_x = where.x0 + part * (where.x1 - where.x0) + distance * where.out_x,
                   at_y = where.y0 + part * (where.y1 - where.y0) + distance * where.out_y, cost = distance + 60.0 * std::fabs(part - 0.5);
      attempt(level, at_x, at_y, where.out_x, where.out_y, cost + (upright ? 30.0 : 0.0));
      if (upright) {
        attempt(turned, at_x, at_y, where.out_x, where.out_y, cost);
      }
    }
    attempt(level, where.x1 + distance * x, where.y1 + distance * y, x, y, distance + 100.0);
    attempt(level, where.x0 - distance * x, where.y0 - distance * y, -x, -y, distance + 110.0);
  }
  if (best) {
    over.write(*best, place);
  }
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
      const text_image number = render_text(short_number(tick), text_size);
      over.write(number, layer::place(number, left + bar_wide + 6, bottom + t * (tall - 1), 0.0, 0.5));
    }
  }
  const text_image title = render_text(frame.title, title_size);
  over.write(title, layer::place(title, over.width() - margin, bottom + tall + 10, 1.0, 0.0));
  over.take({ left - 6, bottom - 6, over.width(), bottom + tall + 6 });
}

void annotation::draw(
  std::vector<float>& rgba, int width, int height, const scene_frame& frame, const transfer& look, const std::string& time) const
{
  layer under(width, height, frame.camera, this->Ink), over(width, height, frame.camera, this->Ink);
  if (this->Bar) {
    this->draw_bar(over, frame, look);
  }
  std::string caption = this->Caption;
  for (size_t at; (at = caption.find("{time}")) != std::string::npos;) {
    caption.replace(at, 6, time);
  }
  if (!caption.empty()) {
    const text_image text = render_text(caption, title_size);
    over.write(text, layer::place(text, margin, height - margin, 0.0, 1.0));
  }
  if (this->Axes) {
    this->draw_box(under, over, frame);
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
