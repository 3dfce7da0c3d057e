// SPDX-License-Identifier: BSD-3-Clause
// A picture that is written as an OpenEXR file and read by the tests' reader, which judges Stratus' files. The first byte is the
// number of edits of the file, 3 bytes each; then come the width, the height and the channels. The other bytes are the channels' floats,
// repeated as needed. 255: all that follows is a file. Without an edit the same bits come back; with edits the reader refuses, or gives a
// whole picture.
#include "Filters/Common/vtkStratusEXRFile.h"
#include "Testing/support/exr_reading.h"
#include "bytes.h"

namespace {
constexpr int MostEdits = 8;
constexpr size_t EditBytes = 3, HeaderBytes = 4;

void CheckWhole(const ExrPicture& picture)
{
  for (const auto& channel : picture.Channels) {
    HOLDS(channel.second.size() == static_cast<size_t>(picture.Width) * static_cast<size_t>(picture.Height), "%zu values of %d x %d",
      channel.second.size(), picture.Width, picture.Height);
  }
  HOLDS(!picture.Channels.empty(), "read, but there is no channel");
}

// Bits of any float, NaN, too.
float FloatAt(const uint8_t* data, size_t size, size_t number)
{
  uint8_t bits[4] = {};
  float value;
  for (size_t i = 0; size > 0 && i < sizeof bits; ++i) {
    bits[i] = data[(4 * number + i) % size];
  }
  std::memcpy(&value, bits, sizeof value);
  return value;
}
} // namespace

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
  ExrPicture picture;
  if (size > 0 && data[0] == 255) {
    if (ReadExr({ data + 1, size - 1 }, picture)) {
      CheckWhole(picture);
    }
    return 0;
  }
  const size_t edits = size > 0 ? data[0] % (MostEdits + 1) : 0, header = HeaderBytes + EditBytes * edits;
  if (size < header) {
    return 0;
  }
  const int width = data[1] % 80 + 1, height = data[2] % 80 + 1;
  const uint8_t* rest = data + header;
  const size_t left = size - header;
  std::vector<vtkStratusEXRChannel> channels;
  for (int c = 0; c <= data[3] % 4; ++c) { // names of 1 byte or more than older versions of OpenEXR know
    const std::string name = std::string(data[3] & 64 ? 40 : 1, "RGBA"[c]);
    channels.push_back({ name, [=](int y, float* row) {
                          for (int x = 0; x < width; ++x) {
                            row[x] = FloatAt(rest, left, static_cast<size_t>((c * height + y) * width + x));
                          }
                        } });
  }
  std::vector<unsigned char> file = vtkStratusEncodeEXR(width, height, channels);
  for (size_t e = 0; e < edits; ++e) {
    const uint8_t* edit = data + HeaderBytes + EditBytes * e;
    file[(edit[0] | static_cast<size_t>(edit[1]) << 8) % file.size()] ^= edit[2];
  }
  const bool read = ReadExr({ file.data(), file.size() }, picture);
  if (edits > 0) {
    if (read) {
      CheckWhole(picture);
    }
    return 0;
  }
  HOLDS(read && picture.Width == width && picture.Height == height && picture.Channels.size() == channels.size(),
    "%d x %d pixels came back as %d x %d", width, height, picture.Width, picture.Height);
  CheckWhole(picture);
  std::vector<float> row(static_cast<size_t>(width));
  for (const vtkStratusEXRChannel& channel : channels) {
    for (int y = 0; y < height; ++y) {
      channel.GetRow(height - 1 - y, row.data());
      HOLDS(std::memcmp(row.data(), picture.Channels[channel.Name].data() + static_cast<size_t>(y) * row.size(), 4 * row.size()) == 0,
        "row %d of %s differs", y, channel.Name.c_str());
    }
  }
  return 0;
}
