// SPDX-License-Identifier: BSD-3-Clause
// Headers of NRRD (Teem's "nearly raw raster data", versions 1 to 5), attached to their values or detached.
#include "vtkStratusImageFile.h"
#include "vtkStratusText.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

namespace {
constexpr int MostAxes = 16; // Teem's

constexpr struct {
  int Type;
  const char* Names;
} Types[] = {
  { VTK_SIGNED_CHAR, "|signed char|int8|int8_t|" },
  { VTK_UNSIGNED_CHAR, "|uchar|unsigned char|uint8|uint8_t|" },
  { VTK_SHORT, "|short|short int|signed short|signed short int|int16|int16_t|" },
  { VTK_UNSIGNED_SHORT, "|ushort|unsigned short|unsigned short int|uint16|uint16_t|" },
  { VTK_INT, "|int|signed int|int32|int32_t|" },
  { VTK_UNSIGNED_INT, "|uint|unsigned int|uint32|uint32_t|" },
  { VTK_LONG_LONG, "|longlong|long long|long long int|signed long long|signed long long int|int64|int64_t|" },
  { VTK_UNSIGNED_LONG_LONG, "|ulonglong|unsigned long long|unsigned long long int|uint64|uint64_t|" },
  { VTK_FLOAT, "|float|" },
  { VTK_DOUBLE, "|double|" },
};

// The number of dimensions that a space's name has, 0 for an unknown name. A last dimension of time is one of them.
constexpr struct {
  int Dimensions;
  bool HasTime;
  const char* Names;
} Spaces[] = {
  { 3, false,
    "|right-anterior-superior|ras|left-anterior-superior|las|left-posterior-superior|lps|scanner-xyz|3d-right-handed|3d-left-handed|" },
  { 4, true,
    "|right-anterior-superior-time|rast|left-anterior-superior-time|last|left-posterior-superior-time|lpst|scanner-xyz-time|"
    "3d-right-handed-time|3d-left-handed-time|" },
};

// Kinds of axes whose samples are one value's components. Of those in VectorKinds the components are a direction's.
const char* const ComponentKinds = "|list|point|vector|covariant-vector|normal|stub|scalar|complex|2-vector|3-color|rgb-color|hsv-color|"
                                   "xyz-color|4-color|rgba-color|3-vector|3-gradient|3-normal|4-vector|quaternion|2d-symmetric-matrix|"
                                   "2d-masked-symmetric-matrix|2d-matrix|2d-masked-matrix|3d-symmetric-matrix|"
                                   "3d-masked-symmetric-matrix|3d-matrix|3d-masked-matrix|covector|3-covector|rgb|rgba|hsv|xyz|"
                                   "2d-symmetric-tensor|2d-tensor|3d-symmetric-tensor|3d-masked-symmetric-tensor|3d-tensor|";
const char* const VectorKinds = "|vector|covariant-vector|covector|normal|3-vector|3-covector|3-gradient|3-normal|";

bool IsAmong(const char* names, const std::string& name)
{
  return !name.empty() && std::string(names).find("|" + name + "|") != std::string::npos;
}

const double Unknown = std::numeric_limits<double>::quiet_NaN();

class Header
{
public:
  explicit Header(const std::string& path);
  vtkStratusImageFile File;

private:
  using Vector = std::optional<std::vector<double>>; // "none", or numbers

  // Reads fields up to the blank line, or the end of a detached header.
  void ReadFields(vtkStratusHeaderLines& lines);
  bool Has(const char* field) const { return this->Fields.count(field) > 0; }
  std::string Get(const char* field) const;
  [[noreturn]] void Wrong(const char* field, const std::string& why) const;
  int64_t GetInteger(const char* field, int64_t lower, int64_t upper, int64_t usual) const;
  std::vector<double> GetNumbers(const char* field) const; // one for each axis
  std::vector<std::string> GetWords(const char* field) const;
  std::vector<std::string> GetQuoted(const char* field) const;
  std::vector<Vector> GetVectors(const char* field) const;

  void SetType();
  void SetAxes();
  void SetSpace(std::vector<vtkStratusImageAxis>& axes, const std::vector<std::string>& kinds);
  void SetSpacings(std::vector<vtkStratusImageAxis>& axes);
  void SetTime(const std::vector<vtkStratusImageAxis>& axes);
  void CheckVectors(const std::vector<std::string>& kinds);
  void SetFiles(vtkStratusHeaderLines& lines);

  std::map<std::string, std::string> Fields;
  size_t Dimension = 0;
  double TimeFirst = 0.0, TimeStep = Unknown;
};

// All fields that the format has. Blanks in them may be left out.
const char* const KnownFields =
  "|content|number|type|block size|dimension|space|space dimension|sizes|spacings|thicknesses|axis mins|axis maxs|space directions|"
  "centerings|centers|kinds|labels|units|min|max|old min|old max|endian|encoding|line skip|byte skip|sample units|space units|"
  "space origin|measurement frame|data file|";

std::string Canonical(const std::string& name)
{
  static const std::map<std::string, std::string> joined = { { "blocksize", "block size" }, { "axismins", "axis mins" },
    { "axismaxs", "axis maxs" }, { "centers", "centerings" }, { "oldmin", "old min" }, { "oldmax", "old max" }, { "lineskip", "line skip" },
    { "byteskip", "byte skip" }, { "sampleunits", "sample units" }, { "datafile", "data file" } };
  const std::string lower = vtkStratusLowerCase(vtkStratusTrimmed(name));
  const auto found = joined.find(lower);
  return found == joined.end() ? lower : found->second;
}

Header::Header(const std::string& path)
{
  this->File.Path = path;
  this->File.Format = "NRRD";
  this->File.ArrayName = "ImageFile";
  vtkStratusHeaderLines lines(path);
  this->ReadFields(lines);
  this->SetType();
  this->SetAxes();
  this->SetFiles(lines);
  this->File.Content = this->Get("content");
  this->File.Units = this->Get("sample units");
  if (this->Has("old min") || this->Has("old max")) {
    this->File.Notes.push_back(
      "values were quantized from " + this->Get("old min") + " .. " + this->Get("old max") + " and stay as stored");
  }
}

void Header::ReadFields(vtkStratusHeaderLines& lines)
{
  std::string line;
  lines.Next(line);
  if (line.size() < 8 || line.compare(0, 7, "NRRD000") != 0 || line[7] < '1' || line[7] > '9') {
    lines.Fail("a NRRD file begins with NRRD0001 to NRRD0005, not " + vtkStratusShown(line));
  }
  if (line[7] > '5') {
    lines.Fail("version " + vtkStratusShown(line) + " of NRRD is unknown; 1 to 5 are read");
  }
  while (lines.Next(line) && !line.empty()) {
    const size_t colon = line.find(':');
    if (line[0] == '#') {
      continue;
    }
    if (colon == std::string::npos) {
      lines.Fail(vtkStratusShown(line) + " is neither 'field: value' nor 'key:=value'");
    }
    if (line.compare(colon, 2, ":=") == 0) {
      continue; // says nothing of how values are stored
    }
    const std::string name = Canonical(line.substr(0, colon));
    if (!IsAmong(KnownFields, name)) {
      lines.Fail("the field " + vtkStratusShown(name) + " is unknown");
    }
    if (!this->Fields.emplace(name, vtkStratusTrimmed(line.substr(colon + 1))).second) {
      lines.Fail("the field " + vtkStratusShown(name) + " is there twice");
    }
    const std::vector<std::string> words = vtkStratusSplit(this->Fields[name]);
    if (name == "data file" && !words.empty() && words[0] == "LIST") {
      break; // names follow, up to the file's end
    }
  }
}

std::string Header::Get(const char* field) const
{
  const auto found = this->Fields.find(field);
  return found == this->Fields.end() ? "" : found->second;
}

void Header::Wrong(const char* field, const std::string& why) const
{
  this->File.Fail(std::string("the field '") + field + "' is " + vtkStratusShown(this->Get(field)) + ", " + why);
}

int64_t Header::GetInteger(const char* field, int64_t lower, int64_t upper, int64_t usual) const
{
  int64_t value = usual;
  if (this->Has(field) && (!vtkStratusParse(this->Get(field), value) || value < lower || value > upper)) {
    this->Wrong(field, "must be an integer from " + std::to_string(lower) + " to " + std::to_string(upper));
  }
  return value;
}

std::vector<std::string> Header::GetWords(const char* field) const
{
  const std::vector<std::string> words = vtkStratusSplit(this->Get(field));
  if (words.size() != this->Dimension) {
    this->Wrong(field, "must have " + std::to_string(this->Dimension) + " entries");
  }
  return words;
}

std::vector<double> Header::GetNumbers(const char* field) const
{
  std::vector<double> numbers;
  for (const std::string& word : this->GetWords(field)) {
    numbers.push_back(0.0);
    if (!vtkStratusParse(word, numbers.back())) {
      this->Wrong(field, "must have numbers");
    }
  }
  return numbers;
}

std::vector<std::string> Header::GetQuoted(const char* field) const
{
  std::vector<std::string> texts;
  const std::string all = this->Get(field);
  for (size_t begin = all.find('"'); begin != std::string::npos;) {
    const size_t end = all.find('"', begin + 1);
    texts.push_back(all.substr(begin + 1, end == std::string::npos ? end : end - begin - 1));
    begin = end == std::string::npos ? end : all.find('"', end + 1);
  }
  return texts;
}

// "(1,0,0) none (0, 1.5, 0)".
std::vector<Header::Vector> Header::GetVectors(const char* field) const
{
  std::vector<Vector> vectors;
  const std::string all = this->Get(field);
  for (size_t at = 0; (at = all.find_first_not_of(" \t", at)) != std::string::npos;) {
    if (vtkStratusLowerCase(all.substr(at, 4)) == "none") {
      vectors.push_back(std::nullopt);
      at += 4;
      continue;
    }
    const size_t end = all.find(')', at);
    if (all[at] != '(' || end == std::string::npos) {
      this->Wrong(field, "must have vectors such as (1,0,0), or none");
    }
    std::vector<double> numbers;
    std::string inside = all.substr(at + 1, end - at - 1);
    std::replace(inside.begin(), inside.end(), ',', ' ');
    for (const std::string& word : vtkStratusSplit(inside)) {
      numbers.push_back(0.0);
      if (!vtkStratusParse(word, numbers.back()) || !std::isfinite(numbers.back())) {
        this->Wrong(field, "must have vectors of finite numbers");
      }
    }
    vectors.push_back(numbers);
    at = end + 1;
  }
  return vectors;
}

void Header::SetType()
{
  const std::string name = vtkStratusLowerCase(this->Get("type"));
  const auto found = std::find_if(std::begin(Types), std::end(Types), [&name](const auto& one) { return IsAmong(one.Names, name); });
  if (!this->Has("type")) {
    this->File.Fail("the field 'type' is missing");
  }
  if (found == std::end(Types)) {
    this->Wrong("type", name == "block" ? "which can't be read" : "must be a type of integers of 8 to 64 bits, float or double");
  }
  this->File.Type = found->Type;
  const std::string encoding = vtkStratusLowerCase(this->Get("encoding")), endian = vtkStratusLowerCase(this->Get("endian"));
  if (encoding == "raw") {
    this->File.Encoding = vtkStratusImageFile::RAW;
  } else if (encoding == "gzip" || encoding == "gz") {
    this->File.Encoding = vtkStratusImageFile::DEFLATE;
  } else if (encoding == "ascii" || encoding == "text" || encoding == "txt") {
    this->File.Encoding = vtkStratusImageFile::TEXT;
  } else if (!this->Has("encoding")) {
    this->File.Fail("the field 'encoding' is missing");
  } else {
    this->Wrong("encoding", "which can't be read; raw, gzip and ascii can");
  }
  const bool single = found->Type == VTK_SIGNED_CHAR || found->Type == VTK_UNSIGNED_CHAR;
  if (this->Has("endian") && endian != "little" && endian != "big") {
    this->Wrong("endian", "must be little or big");
  }
  if (!this->Has("endian") && !single && this->File.Encoding != vtkStratusImageFile::TEXT) {
    this->File.Fail("the field 'endian' is missing, which values of type " + name + " need");
  }
  this->File.BigEndian = endian == "big";
}

void Header::SetAxes()
{
  if (!this->Has("dimension") || !this->Has("sizes")) {
    this->File.Fail(std::string("the field '") + (this->Has("dimension") ? "sizes" : "dimension") + "' is missing");
  }
  this->Dimension = static_cast<size_t>(this->GetInteger("dimension", 1, MostAxes, 1));
  std::vector<vtkStratusImageAxis> axes(this->Dimension);
  const std::vector<std::string> sizes = this->GetWords("sizes");
  for (size_t i = 0; i < this->Dimension; ++i) {
    if (!vtkStratusParse(sizes[i], axes[i].Size) || axes[i].Size < 1) {
      this->Wrong("sizes", "must have integers of at least 1");
    }
  }
  std::vector<std::string> kinds(this->Dimension);
  if (this->Has("kinds")) {
    kinds = this->GetWords("kinds");
    std::transform(kinds.begin(), kinds.end(), kinds.begin(), [](const std::string& kind) { return vtkStratusLowerCase(kind); });
  }
  for (size_t i = 0; i < this->Dimension; ++i) {
    const bool none = kinds[i].empty() || kinds[i] == "none" || kinds[i] == "???";
    if (IsAmong(ComponentKinds, kinds[i])) {
      axes[i].Kind = vtkStratusImageAxis::COMPONENT;
    } else if (kinds[i] == "time") {
      axes[i].Kind = vtkStratusImageAxis::TIME;
    } else if (!none && kinds[i] != "domain" && kinds[i] != "space") {
      this->Wrong("kinds", "of which " + vtkStratusShown(kinds[i]) + " is unknown");
    }
    kinds[i] = none ? "" : kinds[i];
  }
  if (this->Has("space directions")) {
    this->SetSpace(axes, kinds);
  } else {
    this->SetSpacings(axes);
  }
  const auto count = [&axes](vtkStratusImageAxis::Kinds kind) {
    return std::count_if(axes.begin(), axes.end(), [kind](const vtkStratusImageAxis& axis) { return axis.Kind == kind; });
  };
  const auto spaces = count(vtkStratusImageAxis::SPACE);
  if (spaces < 1 || spaces > 3 || count(vtkStratusImageAxis::TIME) > 1) {
    this->File.Fail("of " + std::to_string(this->Dimension) + " axes " + std::to_string(spaces) + " are of space and " +
      std::to_string(count(vtkStratusImageAxis::TIME)) + " of time, must be 1 to 3 and at most 1; set 'kinds' or 'space directions'");
  }
  this->CheckVectors(kinds);
  this->SetTime(axes);
}

void Header::SetSpace(std::vector<vtkStratusImageAxis>& axes, const std::vector<std::string>& kinds)
{
  std::string space = vtkStratusLowerCase(this->Get("space"));
  std::replace(space.begin(), space.end(), ' ', '-'); // both are allowed
  size_t dimensions = static_cast<size_t>(this->GetInteger("space dimension", 1, 4, 0));
  bool has_time = false;
  if (this->Has("space")) {
    const auto found = std::find_if(std::begin(Spaces), std::end(Spaces), [&space](const auto& one) { return IsAmong(one.Names, space); });
    if (found == std::end(Spaces)) {
      this->Wrong("space", "which is unknown");
    }
    dimensions = static_cast<size_t>(found->Dimensions);
    has_time = found->HasTime;
    this->File.Notes.push_back("coordinates are " + space + ", as in the file");
  }
  if (dimensions == 0 || (dimensions == 4 && !has_time)) {
    this->File.Fail("'space directions' need the field 'space', or a 'space dimension' of 1 to 3");
  }
  const std::vector<Vector> steps = this->GetVectors("space directions");
  const std::vector<Vector> origins = this->GetVectors("space origin");
  if (steps.size() != this->Dimension) {
    this->Wrong("space directions", "must have " + std::to_string(this->Dimension) + " entries");
  }
  if (this->Has("space origin") && (origins.size() != 1 || (origins[0] && origins[0]->size() != dimensions))) {
    this->Wrong("space origin", "must be one vector of " + std::to_string(dimensions) + " numbers");
  }
  const std::vector<double> origin = origins.empty() || !origins[0] ? std::vector<double>(dimensions, 0.0) : *origins[0];
  std::copy_n(origin.begin(), std::min<size_t>(dimensions, 3), this->File.Origin.begin());
  this->TimeFirst = has_time ? origin[3] : 0.0;
  for (size_t i = 0; i < this->Dimension; ++i) {
    const bool of_space = kinds[i].empty() || kinds[i] == "domain" || kinds[i] == "space";
    if (!steps[i]) {
      if (of_space && !kinds[i].empty()) {
        this->Wrong("space directions", "with none for an axis of the kind " + kinds[i]);
      }
      axes[i].Kind = axes[i].Kind == vtkStratusImageAxis::TIME ? axes[i].Kind : vtkStratusImageAxis::COMPONENT;
      continue;
    }
    if (steps[i]->size() != dimensions) {
      this->Wrong("space directions", "must have vectors of " + std::to_string(dimensions) + " numbers");
    }
    const double along_time = has_time ? steps[i]->at(3) : 0.0;
    std::copy_n(steps[i]->begin(), std::min<size_t>(dimensions, 3), axes[i].Step.begin());
    const bool along_space =
      std::any_of(axes[i].Step.begin(), axes[i].Step.end(), [](double one) { return one != 0.0; }); // exact: a zero is written as one
    if ((along_time != 0.0 && along_space) || axes[i].Kind == vtkStratusImageAxis::COMPONENT) {
      this->Wrong("space directions",
        "of which entry " + std::to_string(i) + " is " +
          (along_space && along_time != 0.0 ? "of space and of time" : "for an axis of the kind " + kinds[i]));
    }
    if (along_time != 0.0) {
      axes[i].Kind = vtkStratusImageAxis::TIME;
      this->TimeStep = along_time;
    }
  }
  const std::vector<std::string> units = this->GetQuoted("space units");
  if (units.size() >= 3 && units[0] == units[1] && units[0] == units[2]) {
    this->File.LengthUnits = units[0];
  }
  if (has_time && units.size() == 4) {
    this->File.TimeUnits = units[3];
  }
}

// Axes along x, y and z. The first sample's position follows from the axis' ends, if the file has them.
void Header::SetSpacings(std::vector<vtkStratusImageAxis>& axes)
{
  const std::vector<double> none(this->Dimension, Unknown);
  const std::vector<double> spacings = this->Has("spacings") ? this->GetNumbers("spacings") : none;
  const std::vector<double> mins = this->Has("axis mins") ? this->GetNumbers("axis mins") : none;
  const std::vector<double> maxs = this->Has("axis maxs") ? this->GetNumbers("axis maxs") : none;
  const std::vector<std::string> centers =
    this->Has("centerings") ? this->GetWords("centerings") : std::vector<std::string>(this->Dimension, "???");
  std::vector<std::string> units = this->GetQuoted("units"), lengths;
  units.resize(this->Dimension);
  size_t along = 0;
  for (size_t i = 0; i < this->Dimension; ++i) {
    const std::string center = vtkStratusLowerCase(centers[i]);
    const bool node = center == "node"; // otherwise samples are in the middles of cells, Teem's default
    if (!node && center != "cell" && center != "???" && center != "none") {
      this->Wrong("centerings", "must have node, cell, ??? or none");
    }
    const double count = static_cast<double>(axes[i].Size) - (node ? 1.0 : 0.0);
    const double step = std::isfinite(spacings[i]) ? spacings[i] : (maxs[i] - mins[i]) / count;
    const double first = std::isfinite(mins[i]) && std::isfinite(step) ? mins[i] + (node ? 0.0 : 0.5 * step) : 0.0;
    if (step == 0.0) {
      this->File.Fail("axis " + std::to_string(i) + " has the spacing 0");
    }
    if (axes[i].Kind == vtkStratusImageAxis::TIME) {
      this->TimeStep = step;
      this->TimeFirst = first;
      this->File.TimeUnits = units[i];
    }
    if (axes[i].Kind != vtkStratusImageAxis::SPACE || along > 2) {
      continue;
    }
    axes[i].Step[along] = std::isfinite(step) ? step : 1.0;
    this->File.Origin[along] = first;
    lengths.push_back(units[i]);
    ++along;
  }
  if (!lengths.empty() && std::count(lengths.begin(), lengths.end(), lengths[0]) == static_cast<long>(lengths.size())) {
    this->File.LengthUnits = lengths[0];
  }
  const std::vector<Vector> origin = this->GetVectors("space origin");
  if (origin.size() == 1 && origin[0] && origin[0]->size() <= 3) { // spacings in a space without directions
    std::copy(origin[0]->begin(), origin[0]->end(), this->File.Origin.begin());
  } else if (this->Has("space origin")) {
    this->Wrong("space origin", "must be one vector of at most 3 numbers");
  }
}

void Header::SetTime(const std::vector<vtkStratusImageAxis>& axes)
{
  for (const vtkStratusImageAxis& axis : axes) {
    if (axis.Kind == vtkStratusImageAxis::TIME) {
      this->File.AddTime(axis.Size, this->TimeFirst, this->TimeStep);
    } else {
      this->File.Axes.push_back(axis);
    }
  }
}

// Components of vectors are along the measurement frame's axes.
void Header::CheckVectors(const std::vector<std::string>& kinds)
{
  this->File.IsVector = std::any_of(kinds.begin(), kinds.end(), [](const std::string& kind) { return IsAmong(VectorKinds, kind); });
  if (!this->Has("measurement frame") || !this->File.IsVector) {
    return;
  }
  const std::vector<Vector> frame = this->GetVectors("measurement frame");
  for (size_t r = 0; r < frame.size(); ++r) {
    for (size_t c = 0; frame[r] && c < frame[r]->size(); ++c) {
      if (frame[r]->at(c) != (r == c ? 1.0 : 0.0)) {
        this->Wrong("measurement frame", "which turns vectors; only (1,0,0) (0,1,0) (0,0,1) can be read");
      }
    }
  }
}

void Header::SetFiles(vtkStratusHeaderLines& lines)
{
  vtkStratusImageFile& file = this->File;
  const bool raw = file.Encoding == vtkStratusImageFile::RAW;
  constexpr int64_t most = std::numeric_limits<int64_t>::max() / 4;
  file.LineSkip = this->GetInteger("line skip", 0, most, 0);
  file.ByteSkip = this->GetInteger("byte skip", raw ? -1 : 0, most, 0);
  if (!this->Has("data file")) {
    const std::string& path = file.Path;
    if (path.size() > 5 && vtkStratusLowerCase(path.substr(path.size() - 5)) == ".nhdr") {
      file.Fail("the field 'data file' is missing, which a detached header (.nhdr) needs");
    }
    file.Files = { path };
    file.HeaderBytes = lines.GetBytes();
    return;
  }
  const std::vector<std::string> words = vtkStratusSplit(this->Get("data file"));
  const bool list = !words.empty() && words[0] == "LIST";
  const bool pattern = words.size() >= 4 && words[0].find('%') != std::string::npos;
  if (!list && !pattern) {
    if (words.empty()) {
      this->Wrong("data file", "must name a file");
    }
    file.Files = { vtkStratusBeside(file.Path, this->Get("data file")) };
    return;
  }
  // How many axes, of the first ones, a file has all samples of. All of them: files are parts of the last axis.
  const size_t at = list ? 1 : 4;
  int64_t within = static_cast<int64_t>(this->Dimension) - 1;
  if (words.size() > at + 1 ||
    (words.size() > at && (!vtkStratusParse(words[at], within) || within < 1 || within > static_cast<int64_t>(this->Dimension)))) {
    this->Wrong("data file", "must end with the number of axes of each file, 1 to " + std::to_string(this->Dimension));
  }
  const std::vector<std::string> sizes = this->GetWords("sizes");
  int64_t wanted = within == static_cast<int64_t>(this->Dimension) ? 0 : 1, last = 1;
  vtkStratusParse(sizes.back(), last);
  for (size_t i = static_cast<size_t>(within); i < this->Dimension; ++i) {
    int64_t size = 1;
    vtkStratusParse(sizes[i], size);
    wanted *= size; // the product of all sizes was checked
  }
  if (pattern) {
    file.Files = vtkStratusNumberedFiles(file, words[0], &words[1], wanted, last);
  } else {
    std::string line;
    while (lines.Next(line)) {
      const std::string name = vtkStratusTrimmed(line);
      if (!name.empty()) {
        file.Files.push_back(vtkStratusBeside(file.Path, name));
      }
    }
    const int64_t count = static_cast<int64_t>(file.Files.size());
    if (count == 0 || (wanted ? count != wanted : count > last)) {
      file.Fail("the list has " + std::to_string(count) + " files, must have " +
        (wanted ? std::to_string(wanted) : "1 to " + std::to_string(last)));
    }
  }
  if (last % static_cast<int64_t>(file.Files.size()) != 0 && wanted == 0) {
    file.Fail(std::to_string(file.Files.size()) + " files can't share " + std::to_string(last) + " slices evenly");
  }
}
} // namespace

vtkStratusImageFile vtkStratusReadNrrdHeader(const std::string& path)
{
  return Header(path).File;
}
