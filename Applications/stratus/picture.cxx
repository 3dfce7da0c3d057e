// SPDX-License-Identifier: BSD-3-Clause
#include "picture.h"

#include "formats.h"
#include "support.h"

#include <vtkBMPWriter.h>
#include <vtkImageData.h>
#include <vtkJPEGWriter.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkTIFFWriter.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <memory>
#include <unistd.h>

namespace {

[[noreturn]] void fail_to_encode(const std::string& name)
{
  throw cli::failure("the picture could not be encoded as " + name);
}

template <class Writer> std::vector<uint8_t> encode_in_memory(vtkImageData* image, const std::string& name)
{
  vtkNew<Writer> writer;
  writer->SetInputData(image);
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* result = writer->GetResult();
  if (writer->GetErrorCode() != 0 || !result || result->GetNumberOfValues() == 0) {
    fail_to_encode(name);
  }
  return std::vector<uint8_t>(result->GetPointer(0), result->GetPointer(0) + result->GetNumberOfValues());
}

// VTK's writer of TIFF opens its file by name: here one without a place in a folder, so that nothing is left of it whatever happens.
std::vector<uint8_t> encode_tiff(vtkImageData* image)
{
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::tmpfile(), &std::fclose);
  if (!file) {
    fail_to_encode("TIFF");
  }
  vtkNew<vtkTIFFWriter> writer;
  writer->SetInputData(image);
  writer->SetFileName(("/dev/fd/" + std::to_string(fileno(file.get()))).c_str());
  writer->Write();
  std::vector<uint8_t> bytes;
  std::rewind(file.get());
  for (int c; (c = std::fgetc(file.get())) != EOF;) {
    bytes.push_back(static_cast<uint8_t>(c));
  }
  if (writer->GetErrorCode() != 0 || bytes.empty()) {
    fail_to_encode("TIFF");
  }
  return bytes;
}
} // namespace

namespace cli {

background parse_background(const std::string& text)
{
  background result;
  const auto fill = [](double* rgb, double r, double g, double b) {
    rgb[0] = r;
    rgb[1] = g;
    rgb[2] = b;
  };
  if (text.empty() || text == "dark") {
    return result;
  }
  if (text == "transparent") {
    result.transparent = true;
    fill(result.bottom, 0, 0, 0);
    fill(result.top, 0, 0, 0);
    return result;
  }
  if (text == "light") {
    fill(result.bottom, 0.95, 0.96, 0.98);
    fill(result.top, 0.62, 0.74, 0.88);
    return result;
  }
  if (text == "black" || text == "white") {
    const double level = text == "white" ? 1.0 : 0.0;
    fill(result.bottom, level, level, level);
    fill(result.top, level, level, level);
    return result;
  }
  const std::vector<std::string> ends = split(text, ',');
  for (size_t i = 0; i < ends.size() && i < 2; ++i) {
    const std::vector<std::string> rgb = split(ends[i], ':');
    for (size_t c = 0; c < 3 && rgb.size() == 3; ++c) {
      const double level = number(rgb[c], "--background");
      (i ? result.top : result.bottom)[c] = level;
      result.top[c] = level;
      if (level < 0.0 || level > 1.0) {
        throw usage("--background: " + rgb[c] + " is outside 0..1");
      }
    }
    if (rgb.size() != 3 || ends.size() > 2) {
      throw usage("--background: '" + text + "' is none of dark, light, black, white, transparent, r:g:b or r:g:b,r:g:b");
    }
  }
  return result;
}

static uint8_t to_byte(double level)
{
  return static_cast<uint8_t>(std::lround(255.0 * std::min(std::max(level, 0.0), 1.0)));
}

bool is_bright(const background& behind)
{
  double light = 0.0;
  for (int c = 0; c < 3; ++c) {
    light += (behind.bottom[c] + behind.top[c]) / 6.0;
  }
  return !behind.transparent && light > 0.4;
}

double from_screen(double level)
{
  return level <= 0.04045 ? std::max(level, 0.0) / 12.92 : std::pow((level + 0.055) / 1.055, 2.4);
}

std::vector<uint8_t> to_bytes(const std::vector<float>& rgba, int width, int height, const background& behind, bool linear)
{
  const size_t channels = behind.transparent ? 4 : 3;
  std::vector<uint8_t> bytes(static_cast<size_t>(width) * static_cast<size_t>(height) * channels);
  for (int y = 0; y < height; ++y) {
    const double t = (y + 0.5) / height;
    for (int x = 0; x < width; ++x) {
      const size_t at = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
      const float* in = rgba.data() + 4 * at;
      uint8_t* out = bytes.data() + channels * at;
      const double alpha = static_cast<double>(in[3]);
      for (int c = 0; c < 3; ++c) {
        const double own = static_cast<double>(in[c]);
        const double level = behind.bottom[c] + t * (behind.top[c] - behind.bottom[c]), under = linear ? from_screen(level) : level;
        const double mixed = behind.transparent ? (alpha > 0.0 ? own / alpha : 0.0) : own + (1.0 - alpha) * under;
        out[c] = to_byte(linear ? stratus_screen_level(mixed) : mixed);
      }
      if (behind.transparent) {
        out[3] = to_byte(alpha);
      }
    }
  }
  return bytes;
}

picture_format format_of_picture(const std::string& path)
{
  constexpr struct {
    const char* extension;
    picture_format format;
  } known[] = { { "", picture_format::png }, { ".", picture_format::png }, { ".png", picture_format::png },
    { ".jpg", picture_format::jpeg }, { ".jpeg", picture_format::jpeg }, { ".tif", picture_format::tiff },
    { ".tiff", picture_format::tiff }, { ".bmp", picture_format::bmp }, { ".exr", picture_format::exr } };
  const std::string extension = extension_of(path);
#ifdef STRATUS_EXR
  const std::string names = ".png, .jpg, .tif, .bmp and .exr";
#else
  const std::string names = ".png, .jpg, .tif and .bmp";
  if (extension == ".exr") {
    throw usage("'" + path + "': this program was built without OpenEXR, it writes " + names);
  }
#endif
  const auto found = std::find_if(std::begin(known), std::end(known), [&extension](const auto& one) { return extension == one.extension; });
  if (found == std::end(known)) {
    throw usage("'" + path + "': pictures can't be written as " + extension + ", but as " + names);
  }
  return found->format;
}

std::vector<uint8_t> encode(picture_format format, const std::vector<uint8_t>& bytes, int width, int height)
{
  const size_t channels = bytes.size() / (static_cast<size_t>(width) * static_cast<size_t>(height));
  vtkNew<vtkImageData> image;
  image->SetDimensions(width, height, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, static_cast<int>(channels));
  std::memcpy(image->GetScalarPointer(), bytes.data(), bytes.size());
  switch (format) {
    case picture_format::jpeg:
      return encode_in_memory<vtkJPEGWriter>(image, "JPEG");
    case picture_format::tiff:
      return encode_tiff(image);
    case picture_format::bmp:
      return encode_in_memory<vtkBMPWriter>(image, "BMP");
    default:
      return encode_in_memory<vtkPNGWriter>(image, "PNG");
  }
}
} // namespace cli
