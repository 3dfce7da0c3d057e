// SPDX-License-Identifier: BSD-3-Clause
#include "picture.h"
#include "support.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <sys/stat.h>
#include <unistd.h>

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

std::vector<uint8_t> to_bytes(const std::vector<float>& rgba, int width, int height, const background& behind)
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
        const double under = behind.bottom[c] + t * (behind.top[c] - behind.bottom[c]);
        out[c] = to_byte(behind.transparent ? (alpha > 0.0 ? own / alpha : 0.0) : own + (1.0 - alpha) * under);
      }
      if (behind.transparent) {
        out[3] = to_byte(alpha);
      }
    }
  }
  return bytes;
}

std::vector<uint8_t> encode_png(const std::vector<uint8_t>& bytes, int width, int height)
{
  const size_t channels = bytes.size() / (static_cast<size_t>(width) * static_cast<size_t>(height));
  vtkNew<vtkImageData> image;
  image->SetDimensions(width, height, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, static_cast<int>(channels));
  std::memcpy(image->GetScalarPointer(), bytes.data(), bytes.size());
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(image);
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* result = writer->GetResult();
  if (writer->GetErrorCode() != 0 || !result || result->GetNumberOfValues() == 0) {
    throw failure("the picture could not be encoded as PNG");
  }
  return std::vector<uint8_t>(result->GetPointer(0), result->GetPointer(0) + result->GetNumberOfValues());
}

output_file::output_file(const std::string& path) : Path(path)
{
  struct stat status;
  const bool exists = stat(path.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) {
    throw failure("cannot write '" + path + "': it is a folder");
  }
  if (exists && access(path.c_str(), W_OK) != 0) { // a rename would not ask
    throw failure("cannot write '" + path + "': " + std::strerror(errno));
  }
  if (!exists || S_ISREG(status.st_mode)) {
    this->Temporary = path + ".part" + std::to_string(getpid());
  }
  this->File = std::fopen(this->Temporary.empty() ? path.c_str() : this->Temporary.c_str(), "wb");
  if (!this->File) {
    throw failure("cannot write '" + path + "': " + std::strerror(errno));
  }
}

output_file::~output_file()
{
  if (this->File) {
    std::fclose(this->File);
  }
  if (!this->Temporary.empty()) {
    std::remove(this->Temporary.c_str());
  }
}

void output_file::fail(int reason)
{
  throw failure("cannot write '" + this->Path + "': " + std::strerror(reason));
}

void output_file::write(const std::vector<uint8_t>& bytes)
{
  if (std::fwrite(bytes.data(), 1, bytes.size(), this->File) != bytes.size()) {
    this->fail(errno);
  }
}

void output_file::commit()
{
  // On the disk before the name: after a crash there is the old picture or the new one. A pipe has no disk to reach.
  if (std::fflush(this->File) != 0 || (fsync(fileno(this->File)) != 0 && !this->Temporary.empty())) {
    this->fail(errno);
  }
  std::FILE* file = this->File;
  this->File = nullptr;
  if (std::fclose(file) != 0) {
    this->fail(errno);
  }
  if (!this->Temporary.empty()) {
    if (std::rename(this->Temporary.c_str(), this->Path.c_str()) != 0) {
      this->fail(errno);
    }
    this->Temporary.clear();
  }
}
} // namespace cli
