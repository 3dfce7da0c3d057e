// SPDX-License-Identifier: BSD-3-Clause
// compare-pictures A B [DB]: compares two pictures over black. Fails if they differ by more than DB decibels allow, if their sizes differ,
// or if nothing is in them. Each is a PNG file, or an OpenEXR file, whose floats count as they are. The metric is the renderers' own: the
// mean square over the pixels that show anything in either, here of R, G and B.
#include "Testing/support/exr_reading.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace {
struct Picture {
  int Width = 0, Height = 0;
  std::vector<float> Rgb; // rows from the top down
};

bool ReadPng(const std::string& path, Picture& picture)
{
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  const int components = image->GetNumberOfScalarComponents();
  if (reader->GetErrorCode() != 0 || image->GetScalarType() != VTK_UNSIGNED_CHAR || components < 3) {
    return false;
  }
  picture.Width = image->GetDimensions()[0];
  picture.Height = image->GetDimensions()[1];
  for (int y = picture.Height - 1; y >= 0; --y) {
    for (int x = 0; x < picture.Width; ++x) {
      const auto* pixel = static_cast<const unsigned char*>(image->GetScalarPointer(x, y, 0));
      std::transform(
        pixel, pixel + 3, std::back_inserter(picture.Rgb), [](unsigned char byte) { return static_cast<float>(byte) / 255.0f; });
    }
  }
  return true;
}

bool Read(const std::string& path, Picture& picture)
{
  if (path.size() < 4 || path.compare(path.size() - 4, 4, ".exr") != 0) {
    return ReadPng(path, picture);
  }
  ExrPicture exr;
  if (!ReadExr(path, exr)) {
    return false;
  }
  picture.Width = exr.Width;
  picture.Height = exr.Height;
  picture.Rgb.resize(3 * static_cast<size_t>(exr.Width) * static_cast<size_t>(exr.Height));
  for (size_t c = 0; c < 3; ++c) {
    const std::vector<float>& channel = exr.Channels[std::string(1, "RGB"[c])];
    for (size_t pixel = 0; pixel < channel.size(); ++pixel) {
      picture.Rgb[3 * pixel + c] = channel[pixel];
    }
  }
  return true;
}

// Decibels; infinite where nothing differs.
double Compare(const Picture& a, const Picture& b, double& largest, size_t& pixels)
{
  double squares = 0.0;
  for (size_t at = 0; at < a.Rgb.size(); at += 3) {
    const auto shows = [at](const Picture& p) { return p.Rgb[at] != 0.0f || p.Rgb[at + 1] != 0.0f || p.Rgb[at + 2] != 0.0f; };
    if (shows(a) || shows(b)) {
      for (size_t c = at; c < at + 3; ++c) {
        const double d = std::abs(static_cast<double>(a.Rgb[c]) - static_cast<double>(b.Rgb[c]));
        squares += d * d;
        largest = d > largest || d != d ? d : largest;
      }
      ++pixels;
    }
  }
  return squares == 0.0 ? static_cast<double>(INFINITY) : -10.0 * std::log10(squares / (3.0 * static_cast<double>(pixels)));
}
} // namespace

int main(int argc, char** argv)
{
  Picture a, b;
  if (argc < 3 || !Read(argv[1], a) || !Read(argv[2], b)) {
    std::printf("compare-pictures A B [DB]: %s\n", argc < 3 ? "two pictures, please" : "one of them can't be read");
    return 1;
  }
  if (a.Width != b.Width || a.Height != b.Height) {
    std::printf("%d x %d and %d x %d pixels\n", a.Width, a.Height, b.Width, b.Height);
    return 1;
  }
  double largest = 0.0;
  size_t pixels = 0;
  const double decibels = Compare(a, b, largest, pixels);
  const double least = argc > 3 ? std::atof(argv[3]) : -static_cast<double>(INFINITY);
  std::printf("%.2f dB over %zu of %d pixels, largest difference %.2f of 255; at least %.2f dB wanted\n", decibels, pixels,
    a.Width * a.Height, 255.0 * largest, least);
  return pixels > 0 && decibels >= least ? 0 : 1;
}
