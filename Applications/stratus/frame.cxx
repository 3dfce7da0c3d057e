// SPDX-License-Identifier: BSD-3-Clause
#include "frame.h"

#include "support.h"
#ifdef STRATUS_EXR
#include "vtkStratusEXRFile.h"
#endif

#include <algorithm>

namespace cli {

frame::frame(const options& o)
    : Width(o.width), Height(o.height), Behind(parse_background(o.background)), Color(o.color),
      Format(format_of_picture(o.frames.empty() ? o.output : o.frames)), IsExr(Format == picture_format::exr),
      ShowsSamples(o.shows_samples), Linear(o.cloud), Wanted(o.quantities), Threshold(o.threshold)
{
  if (this->Behind.transparent && !this->IsExr && this->Format != picture_format::png) {
    throw usage("'" + (o.frames.empty() ? o.output : o.frames) + "': only .png and .exr pictures can be transparent");
  }
  if (this->IsExr && this->ShowsSamples) {
    throw usage(
      "--show samples is a picture for people, of another format than OpenEXR; '" + o.output + "' has the samples themselves without it");
  }
  if (this->IsExr && (o.axes || o.coast || o.color_bar || !o.caption.empty())) {
    throw usage("an OpenEXR file has only values: leave out --axes, --coast, --color-bar and --caption");
  }
  if (!this->IsExr && this->Wanted.size() > 1) {
    throw usage("a picture shows one quantity, not " + std::to_string(this->Wanted.size()) + ": give an .exr for all, or one --quantity");
  }
  const size_t pixels = static_cast<size_t>(o.width) * static_cast<size_t>(o.height);
  this->Numbers.resize(this->Wanted.size(), std::vector<float>(pixels));
  this->Rgba.resize(4 * pixels);
  this->Depth.resize(this->IsExr ? pixels : 0);
  this->Samples.resize(this->IsExr || this->ShowsSamples ? pixels : 0);
}

stratus_image frame::view()
{
  stratus_image image = {};
  image.width = this->Width;
  image.height = this->Height;
  image.rgba = this->Rgba.data();
  image.depth = this->Depth.empty() ? nullptr : this->Depth.data();
  image.samples = this->Samples.empty() ? nullptr : this->Samples.data();
  return image;
}

bool frame::shows_nothing() const
{
  bool any = !this->shows_colors();
  for (size_t alpha = 3; alpha < this->Rgba.size() && !any; alpha += 4) {
    any = this->Rgba[alpha] >= 0.5F / 255.0F;
  }
  return !any;
}

void frame::set_units(const double scale[3], double metres, const std::string& values)
{
  this->InMetres = metres > 0.0;
  this->ValueUnits = values;
  for (int axis = 0; axis < 3; ++axis) {
    this->Measure[axis] = (this->InMetres ? metres : 1.0) / scale[axis];
  }
}

std::string frame::units_of(stratus_quantity quantity) const
{
  char text[256];
  stratus_quantity_unit(quantity, this->ValueUnits.c_str(), this->InMetres ? 1 : 0, text, sizeof text);
  return text;
}

stratus_quantities frame::numbers()
{
  stratus_quantities all = stratus_quantities_default();
  all.width = this->Width;
  all.height = this->Height;
  all.threshold = this->Threshold;
  for (int axis = 0; axis < 3; ++axis) {
    all.measure[4 * axis] = this->Measure[axis];
  }
  for (size_t i = 0; i < this->Wanted.size(); ++i) {
    all.of[this->Wanted[i]] = this->Numbers[i].data();
  }
  return all;
}

std::vector<std::string> frame::describe_numbers() const
{
  std::vector<std::string> lines;
  for (size_t i = 0; i < this->Wanted.size(); ++i) {
    const value_range range = range_of(this->Numbers[i]);
    const std::string own = this->units_of(this->Wanted[i]), units = own == "1" ? "" : own;
    lines.push_back(std::string(stratus_quantity_name(this->Wanted[i])) +
      (range.count > 0
          ? format(", %.6g .. %.6g", range.low, range.high) + (units.empty() ? "" : " " + units) + " in " + grouped(range.count) + " pixels"
          : ": no ray has one"));
  }
  return lines;
}

std::string frame::describe_samples() const
{
  if (this->Samples.empty()) {
    return "";
  }
  double sum = 0.0;
  size_t met = 0;
  for (uint32_t count : this->Samples) {
    sum += count;
    met += count > 0 ? 1 : 0;
  }
  const double mean = met ? sum / static_cast<double>(met) : 0.0;
  return format("%.1f samples on average in the %s pixels that took any, at most ", mean, grouped(met).c_str()) +
    grouped(*std::max_element(this->Samples.begin(), this->Samples.end()));
}

std::vector<uint8_t> frame::encode_exr() const
{
#ifdef STRATUS_EXR
  const auto row_of = [this](const auto& values, size_t components, size_t component) {
    return [this, &values, components, component](int y, float* row) {
      const size_t first = static_cast<size_t>(y) * static_cast<size_t>(this->Width);
      for (size_t x = 0; x < static_cast<size_t>(this->Width); ++x) {
        row[x] = static_cast<float>(values[(first + x) * components + component]);
      }
    };
  };
  std::vector<vtkStratusEXRChannel> channels;
  for (size_t c = 0; c < 4; ++c) {
    channels.push_back({ std::string(1, "RGBA"[c]), row_of(this->Rgba, 4, c) });
  }
  channels.push_back({ "Z", row_of(this->Depth, 1, 0) });
  channels.push_back({ "Samples", row_of(this->Samples, 1, 0) });
  for (size_t i = 0; i < this->Wanted.size(); ++i) {
    channels.push_back({ stratus_quantity_name(this->Wanted[i]), row_of(this->Numbers[i], 1, 0), this->units_of(this->Wanted[i]) });
  }
  return vtkStratusEncodeEXR(this->Width, this->Height, channels);
#else
  return {};
#endif
}

// Sums are shown from 0 on, the transmittance from 0 to 1, and what is of the values, or a depth, over its own range.
heat_scale frame::scale_of(size_t number) const
{
  const stratus_quantity quantity = this->Wanted[number];
  const value_range range = range_of(this->Numbers[number]);
  const bool sum = quantity == STRATUS_QUANTITY_INTEGRAL || quantity == STRATUS_QUANTITY_LENGTH || quantity == STRATUS_QUANTITY_CELLS;
  const bool part = quantity == STRATUS_QUANTITY_TRANSMITTANCE;
  const double low = part ? 0.0
    : sum                 ? std::min(0.0, range.low)
                          : range.low,
               high = part ? 1.0
    : sum                  ? std::max(0.0, range.high)
                           : range.high;
  const std::string title = quantity == STRATUS_QUANTITY_MAXIMUM_DEPTH ? "depth of max."
    : quantity == STRATUS_QUANTITY_TRANSMITTANCE_DEPTH                 ? format("depth of %.3g", this->Threshold)
                                                                       : stratus_quantity_name(quantity);
  const std::string units = this->units_of(quantity);
  return { low, high > low ? high : low + 1.0, title, units == "1" ? "" : units };
}

void frame::annotate(const context& core, const annotation& wish, const scene_frame& place, const transfer& look, const std::string& time)
{
  if (wish.any() && !this->IsExr && this->shows_colors()) {
    wish.draw(core, this->view(), place, look, time);
  }
}

void frame::write(const context& core, output_file& file) const
{
  if (this->IsExr) {
    file.write(this->encode_exr());
  } else if (!this->shows_colors()) {
    const std::vector<float> samples(this->Samples.begin(), this->Samples.end());
    const heat_scale scale =
      this->ShowsSamples ? heat_scale{ 0.0, std::max(1.0, range_of(samples).high), "samples a pixel", "" } : this->scale_of(0);
    const heat_picture map = heat_map(core, this->ShowsSamples ? samples : this->Numbers[0], this->Width, this->Height, scale, this->Color);
    file.write(encode(this->Format, map.rgb, map.width, this->Height));
  } else {
    file.write(
      encode(this->Format, to_bytes(this->Rgba, this->Width, this->Height, this->Behind, this->Linear), this->Width, this->Height));
  }
}
} // namespace cli
