// SPDX-License-Identifier: BSD-3-Clause
// Headers of MetaImage (.mha, and .mhd with its values in another file), with the keys of MetaIO's documentation and library.
#include "vtkStratusImageFile.h"
#include "vtkStratusText.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace {
// MetaIO's types. Its long has 4 bytes, on every machine.
constexpr struct {
  const char* Name;
  int Type;
} Types[] = {
  { "MET_CHAR", VTK_SIGNED_CHAR },
  { "MET_UCHAR", VTK_UNSIGNED_CHAR },
  { "MET_SHORT", VTK_SHORT },
  { "MET_USHORT", VTK_UNSIGNED_SHORT },
  { "MET_INT", VTK_INT },
  { "MET_UINT", VTK_UNSIGNED_INT },
  { "MET_LONG", VTK_INT },
  { "MET_ULONG", VTK_UNSIGNED_INT },
  { "MET_LONG_LONG", VTK_LONG_LONG },
  { "MET_ULONG_LONG", VTK_UNSIGNED_LONG_LONG },
  { "MET_FLOAT", VTK_FLOAT },
  { "MET_DOUBLE", VTK_DOUBLE },
};

// Synonyms of keys. The first name of each list is the one in Fields.
const std::vector<std::vector<std::string>> Synonyms = {
  { "Offset", "Origin", "Position" },
  { "TransformMatrix", "Rotation", "Orientation" },
  { "BinaryDataByteOrderMSB", "ElementByteOrderMSB" },
};

class Header
{
public:
  explicit Header(const std::string& path);
  vtkStratusImageFile File;

private:
  void ReadFields(vtkStratusHeaderLines& lines);
  bool Has(const char* key) const { return this->Fields.count(key) > 0; }
  std::string Get(const char* key) const;
  [[noreturn]] void Wrong(const char* key, const std::string& why) const;
  bool GetBool(const char* key, bool usual) const;
  int64_t GetInteger(const char* key, int64_t lower, int64_t upper, int64_t usual) const;
  std::vector<double> GetNumbers(const char* key, size_t count, const std::vector<double>& usual) const;

  void SetType();
  void SetAxes();
  void SetFiles(vtkStratusHeaderLines& lines);

  std::map<std::string, std::string> Fields;
  size_t Dimension = 0;
  std::vector<int64_t> Sizes;
};

Header::Header(const std::string& path)
{
  this->File.Path = path;
  this->File.Format = "MetaImage";
  this->File.ArrayName = "MetaImage";
  vtkStratusHeaderLines lines(path);
  this->ReadFields(lines);
  if (this->Has("ObjectType") && this->Get("ObjectType") != "Image") {
    this->Wrong("ObjectType", "only Image can be read");
  }
  this->SetType();
  this->SetAxes();
  this->SetFiles(lines);
  this->File.Content = this->Get("Comment");
  const std::string units = this->Get("DistanceUnits");
  this->File.LengthUnits = units == "?" ? "" : units;
}

void Header::ReadFields(vtkStratusHeaderLines& lines)
{
  std::string line;
  while (lines.Next(line)) {
    const size_t equals = line.find('=');
    if (vtkStratusTrimmed(line).empty()) {
      continue;
    }
    if (equals == std::string::npos) {
      lines.Fail(vtkStratusShown(line) + " is not 'key = value'");
    }
    std::string key = vtkStratusTrimmed(line.substr(0, equals));
    for (const std::vector<std::string>& names : Synonyms) {
      key = std::count(names.begin(), names.end(), key) > 0 ? names[0] : key;
    }
    const std::string value = vtkStratusTrimmed(line.substr(equals + 1));
    const auto put = this->Fields.emplace(key, value);
    if (!put.second && put.first->second != value) {
      lines.Fail(
        "the key " + vtkStratusShown(key) + " was " + vtkStratusShown(put.first->second) + " before, and is " + vtkStratusShown(value));
    }
    if (key == "ElementDataFile") { // the last key: values follow, or names of files
      return;
    }
  }
  this->File.Fail("the key 'ElementDataFile' is missing, which ends a header");
}

std::string Header::Get(const char* key) const
{
  const auto found = this->Fields.find(key);
  return found == this->Fields.end() ? "" : found->second;
}

void Header::Wrong(const char* key, const std::string& why) const
{
  this->File.Fail(std::string("the key '") + key + "' is " + vtkStratusShown(this->Get(key)) + ", " + why);
}

// MetaIO looks at the first letter.
bool Header::GetBool(const char* key, bool usual) const
{
  const std::string value = vtkStratusLowerCase(this->Get(key));
  if (!this->Has(key)) {
    return usual;
  }
  if (value.empty() || std::string("tfyn10").find(value[0]) == std::string::npos) {
    this->Wrong(key, "must be True or False");
  }
  return value[0] == 't' || value[0] == 'y' || value[0] == '1';
}

int64_t Header::GetInteger(const char* key, int64_t lower, int64_t upper, int64_t usual) const
{
  int64_t value = usual;
  if (this->Has(key) && (!vtkStratusParse(this->Get(key), value) || value < lower || value > upper)) {
    this->Wrong(key, "must be an integer from " + std::to_string(lower) + " to " + std::to_string(upper));
  }
  return value;
}

std::vector<double> Header::GetNumbers(const char* key, size_t count, const std::vector<double>& usual) const
{
  if (!this->Has(key)) {
    return usual;
  }
  std::vector<double> numbers;
  for (const std::string& word : vtkStratusSplit(this->Get(key))) {
    numbers.push_back(0.0);
    if (!vtkStratusParse(word, numbers.back()) || !std::isfinite(numbers.back())) {
      this->Wrong(key, "must have finite numbers");
    }
  }
  if (numbers.size() != count) {
    this->Wrong(key, "must have " + std::to_string(count) + " numbers");
  }
  return numbers;
}

void Header::SetType()
{
  std::string name = this->Get("ElementType");
  if (name.empty()) {
    this->File.Fail("the key 'ElementType' is missing");
  }
  const std::string array = "_ARRAY"; // of values with several channels; ElementNumberOfChannels is their number
  if (name.size() > array.size() && name.compare(name.size() - array.size(), array.size(), array) == 0) {
    name.resize(name.size() - array.size());
  }
  const auto found = std::find_if(std::begin(Types), std::end(Types), [&name](const auto& one) { return name == one.Name; });
  if (found == std::end(Types)) {
    this->Wrong("ElementType", "must be one of MetaImage's types of numbers, such as MET_SHORT");
  }
  this->File.Type = found->Type;
  // As MetaIO has it where a key is missing, on every machine that is in use.
  this->File.BigEndian = this->GetBool("BinaryDataByteOrderMSB", false);
  const bool text = !this->GetBool("BinaryData", true), compressed = this->GetBool("CompressedData", false);
  if (text && compressed) {
    this->Wrong("CompressedData", "which goes with BinaryData = True only");
  }
  this->File.Encoding = text ? vtkStratusImageFile::TEXT : compressed ? vtkStratusImageFile::DEFLATE : vtkStratusImageFile::RAW;
  const std::vector<double> slope = this->GetNumbers("ElementToIntensityFunctionSlope", 1, { 1.0 });
  const std::vector<double> offset = this->GetNumbers("ElementToIntensityFunctionOffset", 1, { 0.0 });
  this->File.Slope = slope[0];
  this->File.Intercept = offset[0];
  if (slope[0] == 0.0) {
    this->Wrong("ElementToIntensityFunctionSlope", "which makes all values the same");
  }
}

void Header::SetAxes()
{
  constexpr int64_t most = 4; // the fourth is time
  if (!this->Has("NDims") || !this->Has("DimSize")) {
    this->File.Fail(std::string("the key '") + (this->Has("NDims") ? "DimSize" : "NDims") + "' is missing");
  }
  const int64_t n = this->GetInteger("NDims", 1, most, 3);
  this->Dimension = static_cast<size_t>(n);
  for (const std::string& word : vtkStratusSplit(this->Get("DimSize"))) {
    this->Sizes.push_back(0);
    if (!vtkStratusParse(word, this->Sizes.back()) || this->Sizes.back() < 1) {
      this->Wrong("DimSize", "must have integers of at least 1");
    }
  }
  if (this->Sizes.size() != this->Dimension) {
    this->Wrong("DimSize", "must have " + std::to_string(n) + " integers");
  }
  std::vector<double> identity(this->Dimension * this->Dimension, 0.0);
  for (size_t i = 0; i < this->Dimension; ++i) {
    identity[i * this->Dimension + i] = 1.0;
  }
  const std::vector<double> size = this->GetNumbers("ElementSize", this->Dimension, std::vector<double>(this->Dimension, 1.0));
  const std::vector<double> spacing = this->GetNumbers("ElementSpacing", this->Dimension, size);
  const std::vector<double> offset = this->GetNumbers("Offset", this->Dimension, std::vector<double>(this->Dimension, 0.0));
  const std::vector<double> matrix = this->GetNumbers("TransformMatrix", identity.size(), identity);
  vtkStratusImageAxis channels;
  channels.Kind = vtkStratusImageAxis::COMPONENT;
  channels.Size = this->GetInteger("ElementNumberOfChannels", 1, VTK_INT_MAX, 1);
  this->File.Axes.push_back(channels);
  const size_t spaces = std::min<size_t>(this->Dimension, 3);
  for (size_t i = 0; i < spaces; ++i) { // the matrix's rows are the axes
    vtkStratusImageAxis axis;
    axis.Size = this->Sizes[i];
    for (size_t c = 0; c < spaces; ++c) {
      axis.Step[c] = spacing[i] * matrix[i * this->Dimension + c];
    }
    if (spacing[i] == 0.0) {
      this->Wrong(this->Has("ElementSpacing") ? "ElementSpacing" : "ElementSize", "must have numbers other than 0");
    }
    this->File.Axes.push_back(axis);
    this->File.Origin[i] = offset[i];
  }
  if (n == most) {
    for (size_t i = 0; i < spaces; ++i) {
      if (matrix[i * 4 + 3] != 0.0 || matrix[12 + i] != 0.0) {
        this->Wrong("TransformMatrix", "which mixes space with the fourth axis, time");
      }
    }
    this->File.AddTime(this->Sizes[3], offset[3], spacing[3]);
  }
  this->File.CountValues();
}

void Header::SetFiles(vtkStratusHeaderLines& lines)
{
  vtkStratusImageFile& file = this->File;
  file.ByteSkip = this->GetInteger("HeaderSize", -1, std::numeric_limits<int64_t>::max() / 4, 0);
  if (file.Encoding != vtkStratusImageFile::RAW && file.ByteSkip != 0) {
    if (file.ByteSkip < 0) {
      this->Wrong("HeaderSize", "which needs values that are neither compressed nor text");
    }
    file.HeaderBytes = file.ByteSkip; // before the compressed bytes
    file.ByteSkip = 0;
  }
  const std::string name = this->Get("ElementDataFile");
  const std::vector<std::string> words = vtkStratusSplit(name);
  if (words.empty()) {
    this->Wrong("ElementDataFile", "must be LOCAL, LIST or name a file");
  }
  const std::string first = vtkStratusLowerCase(words[0]);
  const bool list = words[0] == "LIST", pattern = words[0].find('%') != std::string::npos;
  if (words.size() == 1 && first == "local") {
    file.Files = { file.Path };
    file.HeaderBytes += lines.GetBytes();
    return;
  }
  if (!list && !pattern) {
    file.Files = { vtkStratusBeside(file.Path, name) };
    return;
  }
  // Axes of each file: all but the last one, or the number in "LIST 2D".
  int64_t within = static_cast<int64_t>(this->Dimension) - 1, wanted = 1;
  if (list && words.size() > 1) {
    std::string digits = words[1];
    while (!digits.empty() && (digits.back() == 'D' || digits.back() == 'd')) {
      digits.pop_back();
    }
    if (words.size() > 2 || !vtkStratusParse(digits, within) || within < 1 || within >= static_cast<int64_t>(this->Dimension)) {
      this->Wrong("ElementDataFile", "must end with the number of axes of each file, such as 2D");
    }
  }
  for (size_t i = static_cast<size_t>(within); i < this->Dimension; ++i) {
    wanted *= this->Sizes[i];
  }
  if (pattern) {
    if (words.size() > 4) {
      this->Wrong("ElementDataFile", "must be a pattern, the first number, the last one and the step");
    }
    const std::string numbers[3] = { words.size() > 1 ? words[1] : "1", words.size() > 2 ? words[2] : std::to_string(wanted),
      words.size() > 3 ? words[3] : "1" };
    file.Files = vtkStratusNumberedFiles(file, words[0], numbers, wanted, 0);
    return;
  }
  std::string line;
  while (lines.Next(line)) {
    const std::string one = vtkStratusTrimmed(line);
    if (!one.empty()) {
      file.Files.push_back(vtkStratusBeside(file.Path, one));
    }
  }
  if (static_cast<int64_t>(file.Files.size()) != wanted) {
    file.Fail("the list has " + std::to_string(file.Files.size()) + " files, must have " + std::to_string(wanted));
  }
}
} // namespace

vtkStratusImageFile vtkStratusReadMetaHeader(const std::string& path)
{
  return Header(path).File;
}
