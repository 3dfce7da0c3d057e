// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusImageFile.h"
#include "vtkStratusText.h"

#include "vtkStratusImageValues.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace {
constexpr int64_t MostHeaderBytes = int64_t(64) << 20; // far above headers with lists of files
constexpr size_t StartBytes = 4096;                    // enough to know a format by

template <class T> bool ParseWhole(std::string_view text, T& value)
{
  const bool plus = text.size() > 1 && text[0] == '+' && text[1] != '-';
  const char* const end = text.data() + text.size();
  const std::from_chars_result result = std::from_chars(text.data() + (plus ? 1 : 0), end, value);
  return result.ec == std::errc() && result.ptr == end;
}

bool IsSpace(char c)
{
  return std::isspace(static_cast<unsigned char>(c)) != 0;
}

// NIfTI's header begins with its own length and ends with its name; the header of ANALYZE, NIfTI's predecessor, has only the length.
bool BeginsAsNifti(const std::string& start)
{
  for (const uint32_t length : { 348u, 540u }) {
    for (const bool big : { false, true }) {
      char bytes[4];
      for (int i = 0; i < 4; ++i) {
        bytes[i] = static_cast<char>(length >> 8 * (big ? 3 - i : i) & 255);
      }
      if (start.size() >= length && start.compare(0, 4, bytes, 4) == 0) {
        return true;
      }
    }
  }
  return false;
}

// "key = value" in the first line, and MetaImage's first keys.
bool BeginsAsMeta(const std::string& start)
{
  const std::string line = start.substr(0, start.find('\n'));
  const size_t equals = line.find('=');
  const std::string key = vtkStratusTrimmed(line.substr(0, equals));
  return equals != std::string::npos && !key.empty() &&
    std::all_of(key.begin(), key.end(), [](unsigned char c) { return std::isalnum(c) || c == '_'; }) &&
    start.find("NDims") != std::string::npos;
}
} // namespace

int64_t vtkStratusImageFile::CountValues() const
{
  constexpr int64_t most = int64_t(1) << 58;
  int64_t count = 1;
  std::string sizes;
  for (const vtkStratusImageAxis& axis : this->Axes) {
    sizes += (sizes.empty() ? "" : " x ") + std::to_string(axis.Size);
    if (axis.Size < 1) {
      this->Fail("a size is " + std::to_string(axis.Size) + ", must be at least 1");
    }
    if (axis.Kind == vtkStratusImageAxis::SPACE && axis.Size > VTK_INT_MAX) {
      this->Fail("a size is " + std::to_string(axis.Size) + ", must be at most " + std::to_string(VTK_INT_MAX));
    }
    count = axis.Size > most / count ? most + 1 : count * axis.Size;
    if (count > most) {
      this->Fail("sizes of " + sizes + " values are more than any memory holds");
    }
  }
  return count;
}

void vtkStratusImageFile::AddTime(int64_t size, double first, double step)
{
  vtkStratusImageAxis axis;
  axis.Kind = vtkStratusImageAxis::TIME;
  axis.Size = size;
  this->Axes.push_back(axis);
  this->CountValues(); // before memory is taken by a size that nothing bounds
  if (size < 2) {
    return;
  }
  constexpr int64_t most = 100000000;
  if (size > most) {
    this->Fail(std::to_string(size) + " steps in time, must be at most " + std::to_string(most));
  }
  const bool numbered = !std::isfinite(first) || !std::isfinite(step) || !(step > 0.0);
  if (numbered) {
    this->Notes.push_back("the file has no length of its time steps, they are numbered");
    this->TimeUnits.clear();
  }
  for (int64_t i = 0; i < size; ++i) {
    this->Times.push_back(numbered ? static_cast<double>(i) : first + static_cast<double>(i) * step);
  }
}

vtkStratusHeaderLines::vtkStratusHeaderLines(const std::string& path) : Path(path), Stream(path, std::ios::binary)
{
  if (!this->Stream) {
    throw vtkStratusReadError{ path + ": can't be opened" };
  }
}

void vtkStratusHeaderLines::Fail(const std::string& why) const
{
  throw vtkStratusReadError{ this->Path + ", line " + std::to_string(this->Number) + ": " + why };
}

bool vtkStratusHeaderLines::Next(std::string& line)
{
  line.clear();
  char c = 0;
  while (this->Stream.get(c) && c != '\n') {
    line += c;
    if (this->Bytes + static_cast<int64_t>(line.size()) > MostHeaderBytes) {
      throw vtkStratusReadError{ this->Path + ": the header is longer than " + std::to_string(MostHeaderBytes) + " bytes" };
    }
  }
  const bool ended = !this->Stream;
  this->Bytes += static_cast<int64_t>(line.size()) + (ended ? 0 : 1);
  this->Number += ended && line.empty() ? 0 : 1;
  const bool some = !ended || !line.empty();
  if (!line.empty() && line.back() == '\r') {
    line.pop_back();
  }
  return some;
}

std::string vtkStratusShown(std::string_view text)
{
  constexpr size_t most = 60;
  std::string shown(text.substr(0, most));
  std::replace_if(
    shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return "'" + shown + (text.size() > most ? "...'" : "'");
}

std::vector<std::string> vtkStratusSplit(std::string_view text)
{
  std::vector<std::string> words;
  bool within = false;
  for (const char c : text) {
    if (IsSpace(c)) {
      within = false;
      continue;
    }
    if (!within) {
      words.emplace_back();
    }
    within = true;
    words.back() += c;
  }
  return words;
}

bool vtkStratusParse(std::string_view text, int64_t& value)
{
  return ParseWhole(text, value);
}

bool vtkStratusParse(std::string_view text, double& value)
{
  return ParseWhole(text, value);
}

std::string vtkStratusWriteNumber(double value)
{
  char text[32];
  return std::string(text, std::to_chars(text, text + sizeof text, value).ptr);
}

std::vector<std::string> vtkStratusNumberedFiles(
  const vtkStratusImageFile& file, const std::string& pattern, const std::string numbers[3], int64_t wanted, int64_t most)
{
  int64_t number[3];
  for (int i = 0; i < 3; ++i) {
    if (!vtkStratusParse(numbers[i], number[i]) || number[i] < -VTK_INT_MAX || number[i] > VTK_INT_MAX) {
      file.Fail("the files " + vtkStratusShown(pattern) + " are numbered by " + vtkStratusShown(numbers[i]) + ", must be an integer");
    }
  }
  const auto [first, last, step] = number;
  const std::string listed = "the files " + vtkStratusShown(pattern) + " from " + numbers[0] + " to " + numbers[1] + " by " + numbers[2];
  if (step == 0 || (last - first) / step < 0 || (last != first && (last > first) != (step > 0))) {
    file.Fail(listed + ": the step must lead from the first number to the last one");
  }
  const int64_t count = (last - first) / step + 1;
  if (wanted ? count != wanted : count > most) {
    file.Fail(
      listed + " are " + std::to_string(count) + ", must be " + (wanted ? std::to_string(wanted) : "at most " + std::to_string(most)));
  }
  // One number, as %d, %4d or %04d.
  const size_t percent = pattern.find('%');
  size_t end = percent + 1;
  while (end < pattern.size() && std::isdigit(static_cast<unsigned char>(pattern[end]))) {
    ++end;
  }
  const std::string width = pattern.substr(percent + 1, end - percent - 1);
  if (end >= pattern.size() || std::strchr("diu", pattern[end]) == nullptr || width.size() > 2 ||
    pattern.find('%', end) != std::string::npos) {
    file.Fail("the file name " + vtkStratusShown(pattern) + " must have one number, such as %d or %03d");
  }
  std::vector<std::string> names;
  for (int64_t i = 0; i < count; ++i) {
    char text[128];
    const int columns = width.empty() ? 0 : std::stoi(width);
    std::snprintf(
      text, sizeof text, !width.empty() && width[0] == '0' ? "%0*lld" : "%*lld", columns, static_cast<long long>(first + i * step));
    names.push_back(vtkStratusBeside(file.Path, pattern.substr(0, percent) + text + pattern.substr(end + 1)));
  }
  return names;
}

std::string vtkStratusBeside(const std::string& header, const std::string& name)
{
  const size_t slash = header.find_last_of('/');
  return std::filesystem::path(name).is_absolute() || slash == std::string::npos ? name : header.substr(0, slash + 1) + name;
}

vtkStratusImageFormat vtkStratusFindImageFormat(std::string& path)
{
  for (const char* end : { ".img", ".img.gz" }) {
    if (vtkStratusEndsWith(path, end)) { // the values of a NIfTI file, whose header is in the same folder
      const std::string stem = path.substr(0, path.size() - std::strlen(end));
      for (const char* other : { ".hdr", ".hdr.gz" }) {
        std::error_code error;
        if (std::filesystem::exists(stem + other, error)) {
          path = stem + other;
          break;
        }
      }
    }
  }
  const std::string start = vtkStratusReadStart(path, StartBytes);
  return start.compare(0, 4, "NRRD") == 0 ? vtkStratusImageFormat::NRRD
    : BeginsAsNifti(start)                ? vtkStratusImageFormat::NIFTI
    : BeginsAsMeta(start)                 ? vtkStratusImageFormat::META
                                          : vtkStratusImageFormat::NONE;
}
