// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusTIFFFile.h"

#include <cstdint>
#include <fstream>

namespace {
// Numbers of a file, in the byte order that its first two letters specify.
class Numbers
{
public:
  explicit Numbers(const std::string& path) : Stream(path, std::ios::binary) {}

  uint64_t Read(int bytes)
  {
    uint64_t value = 0;
    for (int i = 0; i < bytes; ++i) {
      const uint64_t byte = static_cast<unsigned char>(this->Stream.get());
      value = this->Big ? value << 8 | byte : value | byte << 8 * i;
    }
    return value;
  }
  void Go(uint64_t place) { this->Stream.seekg(static_cast<std::streamoff>(place)); }
  bool IsGood() const { return static_cast<bool>(this->Stream); }

  bool Big = false;

private:
  std::ifstream Stream;
};
} // namespace

int vtkStratusTIFFOrientation(const std::string& path)
{
  constexpr uint64_t classic = 42, with_long_offsets = 43, intel = 0x4949, motorola = 0x4d4d, tag_orientation = 274;
  Numbers file(path);
  const uint64_t order = file.Read(2);
  file.Big = order == motorola;
  const uint64_t version = file.Read(2);
  if (!file.IsGood() || (order != intel && order != motorola) || (version != classic && version != with_long_offsets)) {
    return 0;
  }
  const bool wide = version == with_long_offsets;
  if (wide) {
    file.Read(4);
  }
  file.Go(file.Read(wide ? 8 : 4));
  const uint64_t count = file.Read(wide ? 8 : 2);
  for (uint64_t i = 0; i < count && file.IsGood(); ++i) { // tag, type, count, value
    const uint64_t tag = file.Read(2);
    file.Read(wide ? 10 : 6);
    const uint64_t value = file.Read(2);
    file.Read(wide ? 6 : 2);
    if (tag == tag_orientation && value >= 1 && value <= 8) {
      return static_cast<int>(value);
    }
  }
  return 1;
}
