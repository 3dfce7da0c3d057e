// SPDX-License-Identifier: BSD-3-Clause
#include "frame.h"

#include "heat.h"
#include "support.h"
#ifdef STRATUS_EXR
#include "vtkStratusEXRFile.h"
#endif

#include <algorithm>

namespace cli {

frame::frame(const options& o)
    : Width(o.width), Height(o.height), Behind(parse_background(o.background)), Color(o.color),
      Format(format_of_picture(o.frames.empty() ? o.output : o.frames)), IsExr(Format == picture_format::exr), ShowsSamples(o.shows_samples)
{
  if (this->Behind.transparent && !this->IsExr && this->Format != picture_format::png) {
    throw usage("'" + (o.frames.empty() ? o.output : o.frames) + "': only .png and .exr pictures can be transparent");
  }
  if (this->IsExr && this->ShowsSamples) {
    throw usage(
      "--show samples is a picture for people, of another format than OpenEXR; '" + o.output + "' has the samples themselves without it");
  }
  if (this->IsExr && (o.axes || o.color_bar || !o.caption.empty())) {
    throw usage("an OpenEXR file has only values: leave out --axes, --color-bar and --caption");
  }
  const size_t pixels = static_cast<size_t>(o.width) * static_cast<size_t>(o.height);
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
  return vtkStratusEncodeEXR(this->Width, this->Height, channels);
#else
  return {};
#endif
}

void frame::annotate(const annotation& wish, const scene_frame& place, const transfer& look, const std::string& time)
{
  if (wish.any()) {
    wish.draw(this->Rgba, this->Width, this->Height, place, look, time);
  }
}

void frame::write(output_file& file) const
{
  if (this->IsExr) {
    file.write(this->encode_exr());
  } else if (this->ShowsSamples) {
    file.write(
      encode(this->Format, heat_map(this->Samples, this->Width, this->Height, this->Color), this->Width + heat_bar_width, this->Height));
  } else {
    file.write(encode(this->Format, to_bytes(this->Rgba, this->Width, this->Height, this->Behind), this->Width, this->Height));
  }
}
} // namespace cli
