// SPDX-License-Identifier: BSD-3-Clause
// Headers of NIfTI-1 and NIfTI-2: one file (.nii), or header and values (.hdr, .img), compressed by gzip or not.
#include "vtkStratusImageFile.h"
#include "vtkStratusText.h"

#include "vtkByteSwap.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

namespace {
constexpr size_t Length1 = 348, Length2 = 540; // of the headers of versions 1 and 2

constexpr struct {
  int Code, Type, Components;
  const char* Name;
} Types[] = {
  { 2, VTK_UNSIGNED_CHAR, 1, "" },
  { 4, VTK_SHORT, 1, "" },
  { 8, VTK_INT, 1, "" },
  { 16, VTK_FLOAT, 1, "" },
  { 64, VTK_DOUBLE, 1, "" },
  { 128, VTK_UNSIGNED_CHAR, 3, "" },
  { 256, VTK_SIGNED_CHAR, 1, "" },
  { 512, VTK_UNSIGNED_SHORT, 1, "" },
  { 768, VTK_UNSIGNED_INT, 1, "" },
  { 1024, VTK_LONG_LONG, 1, "" },
  { 1280, VTK_UNSIGNED_LONG_LONG, 1, "" },
  { 2304, VTK_UNSIGNED_CHAR, 4, "" },
  { 1, VTK_VOID, 1, "single bits" },
  { 32, VTK_VOID, 1, "complex numbers of 64 bits" },
  { 1536, VTK_VOID, 1, "numbers of 128 bits" },
  { 1792, VTK_VOID, 1, "complex numbers of 128 bits" },
  { 2048, VTK_VOID, 1, "complex numbers of 256 bits" },
};

class Header
{
public:
  explicit Header(const std::string& path);
  vtkStratusImageFile File;

private:
  // Returns a field of either version. A field that has another type in version 2 is read by that.
  template <class T> T Get(size_t at) const;
  int64_t GetInteger(size_t at1, size_t at2) const;
  double GetReal(size_t at1, size_t at2) const;
  int64_t GetSize(size_t i) const;
  double GetPixel(size_t i) const;

  void SetValues();
  void SetPlace(std::array<vtkStratusImageAxis, 3>& axes);
  void SetPlaceByQuaternion(std::array<vtkStratusImageAxis, 3>& axes, const double spacing[3]);
  void SetAxes();
  void SetUnits();
  void SetFiles();

  std::string Bytes;
  bool Second = false; // NIfTI-2
  int64_t Rank = 0;
  int Components = 1; // of colours
};

template <class T> T Header::Get(size_t at) const
{
  T value;
  std::memcpy(&value, this->Bytes.data() + at, sizeof value);
  if (this->File.BigEndian) {
    vtkByteSwap::SwapBERange(&value, 1);
  } else {
    vtkByteSwap::SwapLERange(&value, 1);
  }
  return value;
}

int64_t Header::GetInteger(size_t at1, size_t at2) const
{
  return this->Second ? static_cast<int64_t>(this->Get<int32_t>(at2)) : this->Get<int16_t>(at1);
}

double Header::GetReal(size_t at1, size_t at2) const
{
  return this->Second ? this->Get<double>(at2) : static_cast<double>(this->Get<float>(at1));
}

int64_t Header::GetSize(size_t i) const
{
  return this->Second ? static_cast<int64_t>(this->Get<long long>(16 + 8 * i)) : this->Get<int16_t>(40 + 2 * i);
}

double Header::GetPixel(size_t i) const
{
  return this->GetReal(76 + 4 * i, 104 + 8 * i);
}

Header::Header(const std::string& path)
{
  vtkStratusImageFile& file = this->File;
  file.Path = path;
  file.ArrayName = "NIFTI";
  this->Bytes = vtkStratusReadStart(path, Length2);
  if (this->Bytes.size() < Length1) {
    file.Fail("has " + std::to_string(this->Bytes.size()) + " bytes, a header of NIfTI has at least " + std::to_string(Length1));
  }
  file.BigEndian = this->Bytes[0] == 0;
  const int32_t length = this->Get<int32_t>(0);
  this->Second = length == static_cast<int32_t>(Length2);
  file.Format = this->Second ? "NIfTI-2" : "NIfTI-1";
  const std::string magic = this->Second ? this->Bytes.substr(4, 4) : this->Bytes.substr(344, 4);
  const std::string one = this->Second ? "n+2" : "n+1", pair = this->Second ? "ni2" : "ni1";
  if (magic != one + '\0' && magic != pair + '\0') {
    file.Fail(std::all_of(magic.begin(), magic.end(), [](char c) { return c == 0; })
        ? "is a header of ANALYZE 7.5, which has no orientation and can't be read; NIfTI can"
        : "has " + vtkStratusShown(magic) + " where NIfTI has " + one + " or " + pair);
  }
  this->SetValues();
  this->SetAxes();
  this->SetUnits();
  this->SetFiles();
  file.Content = vtkStratusTrimmed(this->Bytes.substr(this->Second ? 240 : 148, 80).c_str());
}

void Header::SetValues()
{
  vtkStratusImageFile& file = this->File;
  const int64_t code = this->Second ? this->Get<int16_t>(12) : this->Get<int16_t>(70);
  const auto found = std::find_if(std::begin(Types), std::end(Types), [code](const auto& one) { return one.Code == code; });
  if (found == std::end(Types) || found->Type == VTK_VOID) {
    file.Fail("the datatype is " + std::to_string(code) +
      (found == std::end(Types) ? ", which is unknown" : std::string(", ") + found->Name + ", which can't be read"));
  }
  file.Type = found->Type;
  this->Components = found->Components;
  const double slope = this->GetReal(112, 176), intercept = this->GetReal(116, 184);
  if (slope == 0.0 || !std::isfinite(slope) || found->Components > 1) {
    return; // as the standard has it: values are as stored, and colours are never scaled
  }
  if (!std::isfinite(intercept)) {
    file.Fail("scl_slope is " + vtkStratusWriteNumber(slope) + " and scl_inter " + vtkStratusWriteNumber(intercept) + ", must be finite");
  }
  file.Slope = slope;
  file.Intercept = intercept;
}

void Header::SetPlaceByQuaternion(std::array<vtkStratusImageAxis, 3>& axes, const double spacing[3])
{
  double b = this->GetReal(256, 352), c = this->GetReal(260, 360), d = this->GetReal(264, 368);
  const double square = b * b + c * c + d * d;
  constexpr double rounding = 1e-5; // of floats
  if (!(square <= 1.0 + rounding)) {
    this->File.Fail("the quaternion " + vtkStratusWriteNumber(b) + ", " + vtkStratusWriteNumber(c) + ", " + vtkStratusWriteNumber(d) +
      " is longer than 1, so that it is no rotation");
  }
  const double length = std::max(std::sqrt(square), 1.0);
  b /= length;
  c /= length;
  d /= length;
  const double a = std::sqrt(std::max(1.0 - (b * b + c * c + d * d), 0.0));
  const double turn[3][3] = { { a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c) },
    { 2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b) },
    { 2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c } };
  const double side = this->GetPixel(0) < 0.0 ? -1.0 : 1.0; // qfac
  for (size_t r = 0; r < 3; ++r) {
    for (size_t i = 0; i < 3; ++i) {
      axes[i].Step[r] = turn[r][i] * spacing[i] * (i == 2 ? side : 1.0);
    }
    this->File.Origin[r] = this->GetReal(268 + 4 * r, 376 + 8 * r);
  }
}

// By the sform, otherwise by the qform, otherwise by spacings only (methods 3, 2 and 1 of the standard).
void Header::SetPlace(std::array<vtkStratusImageAxis, 3>& axes)
{
  double spacing[3];
  for (size_t i = 0; i < 3; ++i) {
    const double size = std::fabs(this->GetPixel(i + 1));
    spacing[i] = size == 0.0 && axes[i].Size == 1 ? 1.0 : size;
  }
  if (this->GetInteger(254, 348) > 0) {
    this->File.Notes.push_back("coordinates are right-anterior-superior, by the sform");
    for (size_t r = 0; r < 3; ++r) {
      for (size_t i = 0; i < 3; ++i) {
        axes[i].Step[r] = this->GetReal(280 + 16 * r + 4 * i, 400 + 32 * r + 8 * i);
      }
      this->File.Origin[r] = this->GetReal(280 + 16 * r + 12, 400 + 32 * r + 24);
    }
    return;
  }
  if (this->GetInteger(252, 344) > 0) {
    this->File.Notes.push_back("coordinates are right-anterior-superior, by the qform");
    this->SetPlaceByQuaternion(axes, spacing);
    return;
  }
  this->File.Notes.push_back("the file has neither sform nor qform: axes are x, y and z, from 0 on");
  for (size_t i = 0; i < 3; ++i) {
    axes[i].Step[i] = spacing[i];
  }
}

void Header::SetAxes()
{
  vtkStratusImageFile& file = this->File;
  this->Rank = this->GetSize(0);
  if (this->Rank < 1 || this->Rank > 7) {
    file.Fail("dim[0] is " + std::to_string(this->Rank) + ", must be 1 to 7");
  }
  int64_t sizes[8] = { 1, 1, 1, 1, 1, 1, 1, 1 };
  for (size_t i = 1; i <= static_cast<size_t>(this->Rank); ++i) {
    sizes[i] = this->GetSize(i);
    if (sizes[i] < 1) {
      file.Fail("dim[" + std::to_string(i) + "] is " + std::to_string(sizes[i]) + ", must be at least 1");
    }
  }
  if (sizes[6] > 1 || sizes[7] > 1) {
    file.Fail("dim[6] and dim[7] are " + std::to_string(sizes[6]) + " and " + std::to_string(sizes[7]) + ", only 1 can be read");
  }
  vtkStratusImageAxis colors, vectors;
  colors.Kind = vectors.Kind = vtkStratusImageAxis::COMPONENT;
  colors.Size = this->Components;
  vectors.Size = sizes[5];
  std::array<vtkStratusImageAxis, 3> axes;
  for (size_t i = 0; i < 3; ++i) {
    axes[i].Size = sizes[i + 1];
  }
  this->SetPlace(axes);
  file.Axes.push_back(colors);
  file.Axes.insert(file.Axes.end(), axes.begin(), axes.end());
  const int64_t units = this->Second ? this->Get<int32_t>(500) : this->Bytes[123];
  const int64_t time = units & 0x38;
  constexpr int64_t seconds = 8, milliseconds = 16, microseconds = 24;
  file.TimeUnits = time == seconds ? "s" : time == milliseconds ? "ms" : time == microseconds ? "us" : "";
  file.AddTime(sizes[4], this->GetReal(136, 216), this->GetPixel(4));
  file.Axes.push_back(vectors);
  file.CountValues();
  constexpr int64_t displacement = 1006, vector = 1007;
  const int64_t intent = this->GetInteger(68, 504);
  file.IsVector = intent == displacement || intent == vector;
}

void Header::SetUnits()
{
  const int64_t units = this->Second ? this->Get<int32_t>(500) : this->Bytes[123];
  const int64_t length = units & 7;
  this->File.LengthUnits = length == 1 ? "m" : length == 2 ? "mm" : length == 3 ? "um" : "";
}

void Header::SetFiles()
{
  vtkStratusImageFile& file = this->File;
  const double most = static_cast<double>(std::numeric_limits<int64_t>::max() / 4);
  const double offset = this->Second ? static_cast<double>(this->Get<long long>(168)) : static_cast<double>(this->Get<float>(108));
  if (!(offset >= 0.0) || offset > most || offset != std::floor(offset)) {
    file.Fail("vox_offset is " + vtkStratusWriteNumber(offset) + ", must be a number of bytes");
  }
  file.ByteSkip = static_cast<int64_t>(offset);
  const bool single = this->Bytes[this->Second ? 5 : 345] == '+';
  if (single) {
    const int64_t least = static_cast<int64_t>(this->Second ? Length2 : Length1) + 4;
    file.ByteSkip = file.ByteSkip == 0 ? least : file.ByteSkip;
    if (file.ByteSkip < least) {
      file.Fail("vox_offset is " + vtkStratusWriteNumber(offset) + ", must be at least " + std::to_string(least) + " in one file");
    }
    file.Files = { file.Path };
  } else {
    const std::string lower = vtkStratusLowerCase(file.Path);
    const size_t at = lower.rfind(".hdr");
    if (at == std::string::npos) {
      file.Fail("is the header of two files, its name must end in .hdr or .hdr.gz");
    }
    const bool upper = file.Path[at + 1] == 'H';
    const std::string stem = file.Path.substr(0, at) + (upper ? ".IMG" : ".img");
    std::error_code error;
    const std::string compressed = stem + (upper ? ".GZ" : ".gz");
    file.Files = { !std::filesystem::exists(stem, error) && std::filesystem::exists(compressed, error) ? compressed : stem };
  }
  char magic[2] = {};
  std::ifstream(file.Files[0], std::ios::binary).read(magic, 2);
  file.Encoding = magic[0] == '\x1f' && magic[1] == '\x8b' ? vtkStratusImageFile::DEFLATE : vtkStratusImageFile::RAW;
}
} // namespace

vtkStratusImageFile vtkStratusReadNiftiHeader(const std::string& path)
{
  return Header(path).File;
}
