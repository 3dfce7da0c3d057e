// SPDX-License-Identifier: BSD-3-Clause
#include "annotation.h"

#include "picture.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <vector>

namespace {
// VTK's readers of images have these names for values that a file does not name. The file's own name says more.
const char* const UNNAMED[] = { "ImageFile", "MetaImage", "NIFTI", "ImageScalars", "Scalars_" };
} // namespace

namespace cli {

// The core's view, with what it borrows.
struct annotation::lent {
  stratus_annotation view = stratus_annotation_default();
  std::array<std::vector<double>, 3> levels;
  std::string title, caption;
  const data_about* about = nullptr;
  double scale[2] = { 1.0, 1.0 };

  static int place(void* data, const double degrees[2], double at[2])
  {
    const lent* const all = static_cast<const lent*>(data);
    const bool found = all->about->place(degrees, at);
    at[0] *= all->scale[0];
    at[1] *= all->scale[1];
    return found ? 1 : 0;
  }
};

annotation::annotation(const options& o) : Options(o), Caption(o.caption + (o.caption.empty() || o.heights.empty() ? "" : ", ") + o.heights)
{
}

void annotation::lend(const scene_frame& frame, const transfer& look, lent& to) const
{
  const options& o = this->Options;
  stratus_annotation& view = to.view;
  view.axes = o.axes ? 1 : 0;
  view.coast = o.coast && !o.globe ? 1 : 0; // on a globe they are part of the Earth
  if (o.about.place) {
    to.about = &o.about;
    std::copy_n(frame.scale, 2, to.scale);
    view.coast_place = lent::place;
    view.coast_data = &to;
  }
  std::copy_n(frame.bounds, 6, view.bounds);
  for (size_t axis = 0; axis < 3; ++axis) {
    const axis_about& about = o.about.axes[axis];
    view.axis[axis].kind = about.kind;
    view.axis[axis].title = about.title.c_str();
    view.axis[axis].units = about.units.c_str();
    view.axis[axis].scale = about.scale / frame.scale[axis];
    to.levels[axis] = about.levels;
    for (size_t i = 0; i < about.levels.size(); i += 2) {
      to.levels[axis][i] *= frame.scale[axis];
    }
    view.axis[axis].levels = to.levels[axis].data();
    view.axis[axis].level_count = to.levels[axis].size() / 2;
  }
  if (o.color_bar) {
    const bool unnamed = std::find(std::begin(UNNAMED), std::end(UNNAMED), frame.title) != std::end(UNNAMED);
    to.title = unnamed && !o.source.empty() ? std::filesystem::path(o.source).stem().string() : frame.title;
    view.color = look.color.data();
    view.color_count = look.color.size() / 4;
    view.low = look.low;
    view.high = look.high > look.low ? look.high : look.low + 1.0;
    view.logarithmic = look.logarithmic ? 1 : 0;
    view.bar_title = to.title.c_str();
    view.bar_units = o.about.units.c_str();
  }
  to.caption = this->Caption;
  view.caption = to.caption.c_str();
  const background behind = parse_background(o.background);
  view.ink = behind.transparent ? 0.5 : is_bright(behind) ? 0.1 : 0.9;
}

bool annotation::find_room(const context& core, const scene_frame& frame, const transfer& look, double room[4]) const
{
  const options& o = this->Options;
  const bool fills = o.about.earth && !o.has_azimuth;
  if (!o.axes && !(fills && o.color_bar)) {
    return false;
  }
  lent all;
  this->lend(frame, look, all);
  core.check(stratus_annotation_room(core, &all.view, o.width, o.height, room), "'" + o.source + "'");
  return true;
}

void annotation::draw(
  const context& core, const stratus_image& image, const scene_frame& frame, const transfer& look, const std::string& time) const
{
  lent all;
  this->lend(frame, look, all);
  for (size_t at; (at = all.caption.find("{time}")) != std::string::npos;) {
    all.caption.replace(at, 6, time);
  }
  all.view.caption = all.caption.c_str();
  core.check(stratus_annotation_draw(core, &all.view, &frame.camera, &image, nullptr, 0, nullptr), "'" + this->Options.source + "'");
}

std::string describe_axes(const options& o, const double bounds[6])
{
  std::string text;
  for (size_t a = 0; a < 3; ++a) {
    const axis_about& axis = o.about.axes[a];
    const size_t n = axis.levels.size(), first = n > 0 && axis.levels[0] < axis.levels[n - 2] ? 0 : n - 2;
    const double low = n > 0 ? axis.levels[first + 1] : bounds[2 * a] * axis.scale + 0.0,
                 high = n > 0 ? axis.levels[n - 1 - first] : bounds[2 * a + 1] * axis.scale + 0.0; // no -0
    text += (a > 0 ? ", " : "") + (axis.title.empty() ? std::string(1, "xyz"[a]) : axis.title) + format(" %.6g .. %.6g", low, high) +
      (axis.units.empty() ? "" : " " + axis.units);
  }
  return text;
}
} // namespace cli
