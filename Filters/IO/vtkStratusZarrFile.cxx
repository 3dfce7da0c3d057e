// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusZarrFile.h"

#include "vtkStratusBricks.h"
#include "vtkStratusIdentity.h"
#include "vtkStratusMappedFile.h"
#include "vtkStratusNetCDFBricks.h"
#include "vtkStratusNetCDFValues.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <set>
#include <system_error>

namespace {
namespace files = std::filesystem;

constexpr int MostDepth = 32;      // of groups
constexpr size_t MostNodes = 4000; // arrays, and groups

// "level2" comes before "level10".
bool ComesBefore(const std::string& a, const std::string& b)
{
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      size_t m = i, n = j;
      for (; m < a.size() && is_digit(a[m]);) {
        ++m;
      }
      for (; n < b.size() && is_digit(b[n]);) {
        ++n;
      }
      if (m - i != n - j) {
        return m - i < n - j;
      }
      const int order = a.compare(i, m - i, b, j, n - j);
      if (order != 0) {
        return order < 0;
      }
      i = m;
      j = n;
    } else if (a[i] != b[j]) {
      return a[i] < b[j];
    } else {
      ++i;
      ++j;
    }
  }
  return a.size() - i < b.size() - j;
}

// Whether a name of a node or a document stays in its folder.
bool IsInside(const std::string& name)
{
  size_t first = 0;
  while (first <= name.size()) {
    const size_t end = std::min(name.find('/', first), name.size());
    const std::string part = name.substr(first, end - first);
    if (part.empty() || part == "." || part == ".." || part.find('\0') != std::string::npos) {
      return false;
    }
    first = end + 1;
  }
  return true;
}

// The bytes of a text of base 64, or none.
std::string BytesOf(const std::string& text)
{
  static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  uint32_t bits = 0;
  int count = 0;
  for (const char c : text.substr(0, text.find('='))) {
    const size_t digit = digits.find(c);
    if (digit == std::string::npos) {
      return "";
    }
    bits = bits << 6 | static_cast<uint32_t>(digit);
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes += static_cast<char>(bits >> count & 255);
    }
  }
  return bytes;
}

// The number that xarray writes as text, because JSON has none: a name, or the bytes of a double, little end first, in base 64.
bool NumberOf(const std::string& text, double& number)
{
  if (text == "NaN" || text == "Infinity" || text == "-Infinity") {
    number = text == "NaN" ? std::nan("") : text[0] == '-' ? -HUGE_VAL : HUGE_VAL;
    return true;
  }
  const std::string bytes = text.size() == 12 && text[11] == '=' ? BytesOf(text) : "";
  uint64_t bits = 0;
  for (size_t i = 0; i < bytes.size(); ++i) {
    bits |= static_cast<uint64_t>(static_cast<unsigned char>(bytes[i])) << 8 * i;
  }
  std::memcpy(&number, &bits, sizeof number);
  return bytes.size() == 8;
}

vtkStratusNetCDFAttribute AttributeOf(const Json::Value& value, bool of_values)
{
  vtkStratusNetCDFAttribute result;
  result.Exists = true;
  Json::Value list = value;
  if (!value.isArray()) {
    list = Json::Value(Json::arrayValue);
    if (!value.isNull() && !value.isObject()) {
      list.append(value);
    }
  }
  bool integers = true;
  for (const Json::Value& one : list) {
    double number = 0.0;
    if (one.isString() && !(of_values && NumberOf(one.asString(), number))) {
      result.IsText = true;
      result.Text = result.Length == 0 ? one.asString() : result.Text;
    } else if (one.isString() || one.isNumeric() || one.isBool()) {
      integers = integers && (one.isBool() || one.isInt64() || one.isUInt64()) && one.type() != Json::realValue;
      result.Reals.push_back(one.isString() ? number : one.asDouble());
      result.Integers.push_back(!integers ? 0 : one.isInt64() || one.isBool() ? one.asInt64() : static_cast<int64_t>(one.asUInt64()));
    } else {
      continue;
    }
    ++result.Length;
  }
  if (result.IsText) {
    result.Reals.clear();
  }
  if (!integers || result.IsText) {
    result.Integers.clear();
  }
  return result;
}
} // namespace

vtkStratusZarrFile::~vtkStratusZarrFile() = default;

bool vtkStratusZarrFile::IsZarr(const std::string& path)
{
  std::error_code error;
  const std::string name = files::path(path).filename().string();
  const bool is_document = name == "zarr.json" || name == ".zgroup" || name == ".zarray" || name == ".zattrs" || name == ".zmetadata";
  if (is_document && files::is_regular_file(path, error)) {
    return true;
  }
  for (const char* one : { "zarr.json", ".zgroup", ".zarray" }) {
    if (files::is_regular_file(path + "/" + one, error)) {
      return true;
    }
  }
  return false;
}

vtkStratusZarrFile::vtkStratusZarrFile(const std::string& path, const std::string& selection) : vtkStratusNetCDFModel(path), Folder(path)
{
  std::error_code error;
  if (!IsZarr(path)) {
    this->Fail(files::exists(path, error) ? "it is no folder of Zarr, which has a file zarr.json, .zgroup or .zarray"
                                          : std::string("there is no such folder"));
  }
  if (!files::is_directory(path, error)) {
    this->Folder = files::path(path).parent_path().string();
    this->Folder = this->Folder.empty() ? "." : this->Folder;
  }
  this->Folder += this->Folder.back() == '/' ? "" : "/";
  Json::Value consolidated;
  if (vtkStratusReadJson(this->Folder + ".zmetadata", consolidated)) {
    this->UseConsolidated(consolidated["metadata"]);
  } else if (vtkStratusReadJson(this->Folder + "zarr.json", consolidated) && consolidated["consolidated_metadata"].isObject()) {
    this->UseConsolidated(consolidated["consolidated_metadata"]["metadata"]);
  }
  this->Load("", 0);
  this->FindImages();
  this->AddDimensions();
  this->AddCoordinates();
  this->Select(selection);
}

// Keeps metadata that a group has of the nodes below it: "rho/.zarray" in version 2, "rho" in version 3.
void vtkStratusZarrFile::UseConsolidated(const Json::Value& metadata)
{
  if (!metadata.isObject()) {
    return;
  }
  for (const std::string& name : metadata.getMemberNames()) {
    const Json::Value& one = metadata[name];
    if (one.isObject() && IsInside(name)) {
      this->Documents[one["node_type"].isString() ? name + "/zarr.json" : name] = one;
    }
  }
}

// Finds a file of metadata. Returns false if there is none.
bool vtkStratusZarrFile::Document(const std::string& name, Json::Value& value) const
{
  const auto found = this->Documents.find(name);
  if (found != this->Documents.end()) {
    value = found->second;
    return true;
  }
  // A group without a list of all nodes below it, and the root, whose own file need not be in it.
  return (this->Documents.empty() || name.find('/') == std::string::npos) && vtkStratusReadJson(this->Folder + name, value);
}

// The names of nodes that may be directly below a group.
std::vector<std::string> vtkStratusZarrFile::ChildrenOf(const std::string& path) const
{
  std::set<std::string> names;
  for (auto one = this->Documents.lower_bound(path); one != this->Documents.end() && one->first.compare(0, path.size(), path) == 0; ++one) {
    const size_t slash = one->first.find('/', path.size());
    if (slash != std::string::npos) {
      names.insert(one->first.substr(path.size(), slash - path.size()));
    }
  }
  std::error_code error;
  if (this->Documents.empty()) {
    for (files::directory_iterator at(this->Folder + path, error), end; !error && at != end; at.increment(error)) {
      std::error_code unknown;
      if (at->is_directory(unknown)) {
        names.insert(at->path().filename().string());
      }
    }
  }
  if (error) {
    this->Fail("the group '" + path + "' cannot be listed: " + error.message());
  }
  std::vector<std::string> sorted(names.begin(), names.end());
  std::stable_sort(sorted.begin(), sorted.end(), ComesBefore);
  return sorted;
}

// Loads the array or the attributes of the group of a path, with a slash behind. Returns false if it is neither.
bool vtkStratusZarrFile::LoadNode(const std::string& path, bool& is_group)
{
  Json::Value node, attributes;
  is_group = false;
  if (this->Document(path + "zarr.json", node)) {
    const std::string type = node["node_type"].isString() ? node["node_type"].asString() : "";
    if (node["zarr_format"] != 3 || (type != "array" && type != "group")) {
      this->Fail("'" + path + "zarr.json' is of no array or group of version 3");
    }
    is_group = type == "group";
    if (!is_group) {
      this->AddArray(path, node, node["attributes"]);
    }
    attributes = node["attributes"];
  } else if (this->Document(path + ".zarray", node)) {
    if (node["zarr_format"] != 2) {
      this->Fail("'" + path + ".zarray' has the zarr_format " + node["zarr_format"].toStyledString() + "; 2 and 3 are read");
    }
    this->Document(path + ".zattrs", attributes);
    this->AddArray(path, node, attributes);
  } else if (this->Document(path + ".zgroup", node)) {
    this->Document(path + ".zattrs", attributes);
    is_group = true;
  } else {
    return false;
  }
  if (is_group) {
    this->CheckCount(this->Groups.size());
    this->Groups.push_back({ path, attributes });
  }
  return true;
}

// Loads a group's arrays, then its groups.
void vtkStratusZarrFile::Load(const std::string& path, int depth)
{
  bool is_group = false;
  if (depth == 0 && !this->LoadNode(path, is_group)) {
    this->Fail("it has no metadata of an array or a group");
  }
  if (depth == 0 && !is_group) {
    return;
  }
  std::vector<std::string> groups;
  for (const std::string& name : this->ChildrenOf(path)) {
    if (this->LoadNode(path + name + "/", is_group) && is_group) {
      groups.push_back(path + name + "/");
    }
  }
  for (const std::string& group : groups) {
    if (depth >= MostDepth) {
      this->Fail("groups are nested more than " + std::to_string(MostDepth) + " deep: '" + group + "'");
    }
    this->Load(group, depth + 1);
  }
}

void vtkStratusZarrFile::CheckCount(size_t count) const
{
  if (count >= MostNodes) {
    this->Fail("it has more than " + std::to_string(MostNodes) + " arrays or groups; open one of its groups");
  }
}

void vtkStratusZarrFile::AddArray(const std::string& path, const Json::Value& metadata, const Json::Value& attributes)
{
  this->CheckCount(this->Variables.size());
  std::string name = path.substr(0, path.empty() ? 0 : path.size() - 1);
  if (name.empty()) { // the root
    std::error_code error;
    const files::path folder = files::absolute(this->Folder, error).lexically_normal().parent_path();
    name = folder.extension() == ".zarr" ? folder.stem().string() : folder.filename().string();
    name = name.empty() ? "values" : name;
  }
  Source source;
  source.Values = std::make_shared<vtkStratusZarrArray>(this->Folder + path, metadata, attributes);
  this->Variables.push_back({ 0, static_cast<int>(this->Sources.size()), source.Values->GetType(), name, {} });
  this->Sources.push_back(source);
}

int vtkStratusZarrFile::AddDimension(const std::string& path, const std::string& name, size_t length)
{
  this->Names.push_back(name);
  this->Paths.push_back(path);
  this->Lengths.push_back(length);
  this->Unlimited.push_back(0);
  this->Selected.push_back(-1);
  return static_cast<int>(this->Names.size()) - 1;
}

void vtkStratusZarrFile::AddDimensions()
{
  std::map<std::string, int> known; // by group, name and length
  for (Variable& variable : this->Variables) {
    const vtkStratusZarrArray& array = *this->SourceOf(variable).Values;
    const std::string own = variable.Name + "/", group = variable.Name.substr(0, variable.Name.rfind('/') + 1);
    const auto image = this->Images.find(static_cast<size_t>(variable.Id));
    for (size_t a = 0; a < array.GetShape().size(); ++a) {
      const size_t length = array.GetShape()[a];
      const std::string name = image != this->Images.end() ? image->second[a].Name : array.GetNames()[a];
      if (name.empty() || image != this->Images.end()) { // the array's own
        variable.Dimensions.push_back(this->AddDimension(own, name.empty() ? "dim_" + std::to_string(a) : name, length));
        continue;
      }
      const std::string key = '\n' + name + '\n' + std::to_string(length);
      std::string path = group;
      while (!path.empty() && known.count(path + key) == 0) { // in the groups above
        path.resize(path.size() - 1);
        path.resize(path.rfind('/') + 1);
      }
      path = known.count(path + key) == 0 ? group : path;
      const auto found = known.find(path + key);
      const int dimension = found != known.end() ? found->second : this->AddDimension(path, name, length);
      known[path + key] = dimension;
      variable.Dimensions.push_back(dimension);
    }
  }
}

vtkStratusZarrFile::Attribute vtkStratusZarrFile::ReadAttribute(const Variable& variable, const char* name) const
{
  const auto in = [name](const Json::Value& attributes) {
    static const std::set<std::string> of_values = { "_FillValue", "missing_value", "valid_min", "valid_max", "valid_range" };
    return attributes.isObject() && attributes.isMember(name) ? AttributeOf(attributes[name], of_values.count(name) > 0) : Attribute();
  };
  if (variable.Id == Global) {
    const std::string path = variable.Name.substr(0, variable.Name.rfind('/') + 1);
    const auto group = std::find_if(this->Groups.begin(), this->Groups.end(), [&path](const Group& one) { return one.Path == path; });
    return group == this->Groups.end() ? Attribute() : in(group->Attributes);
  }
  const Source& source = this->SourceOf(variable);
  const Attribute found = in(source.Values ? source.Values->GetAttributes() : source.Attributes);
  // Images have no missing values, and coordinates of dimensions may not have any: there the fill value is a number as any other.
  const bool filled = !found.Exists && source.Values && std::strcmp(name, "_FillValue") == 0 && !source.Values->GetMissing().isNull() &&
    this->Images.count(static_cast<size_t>(variable.Id)) == 0 &&
    (variable.Dimensions.size() != 1 || this->NameOf(variable.Dimensions[0]) != variable.BaseName());
  return filled ? AttributeOf(source.Values->GetMissing(), true) : found;
}

std::vector<std::string> vtkStratusZarrFile::ReadTexts(const Variable& variable) const
{
  this->Fail("texts of '" + variable.Name + "' are not read"); // no type of arrays is one of texts
}

std::string vtkStratusZarrFile::WhyNoNumbers(const Variable& variable) const
{
  return "cannot be read: " + this->SourceOf(variable).Values->GetFault();
}

void vtkStratusZarrFile::CheckValues(const Variable& variable) const
{
  const Source& source = this->SourceOf(variable);
  if (source.Values && !source.Values->GetFault().empty()) {
    this->FailWithoutNumbers(variable);
  }
}

void vtkStratusZarrFile::ReadStored(
  const Variable& variable, const std::vector<size_t>& start, const std::vector<size_t>& count, void* stored) const
{
  const Source& source = this->SourceOf(variable);
  if (!source.Values) {
    for (size_t i = 0; i < count[0]; ++i) {
      static_cast<double*>(stored)[i] = source.Offset + source.Scale * static_cast<double>(start[0] + i);
    }
    return;
  }
  std::vector<int64_t> strides(count.size());
  int64_t stride = static_cast<int64_t>(source.Values->GetValueBytes());
  for (size_t i = count.size(); i-- > 0;) {
    strides[i] = stride;
    stride *= static_cast<int64_t>(count[i]);
  }
  try {
    source.Values->Read(start, count, static_cast<char*>(stored), strides, true);
  } catch (const vtkStratusReadError& why) {
    this->Fail("variable '" + variable.Name + "' cannot be read: " + why.Text);
  }
}

vtkSmartPointer<vtkDataArray> vtkStratusZarrFile::MakeBricks(const Variable& variable, const vtkStratusNetCDFPart& part) const
{
  const std::shared_ptr<const vtkStratusZarrArray> array = this->SourceOf(variable).Values;
  if (!array || !array->GetFault().empty()) {
    return nullptr; // reading fails with the reason
  }
  const auto values = std::make_shared<const vtkStratusNetCDFValues>(this->ValuesOf(variable));
  vtkStratusBrickSource source;
  source.Name = variable.Name;
  source.Type = values->GetResultType();
  std::vector<uint64_t> numbers;
  if (!this->Documents.empty()) {
    numbers.push_back(vtkStratusIdentityOfFile(this->Folder + ".zmetadata", 0, -1));
    numbers.push_back(vtkStratusIdentityOfFile(this->Folder + "zarr.json", 0, -1));
  }
  for (size_t i = 0; i < part.Axes.size(); ++i) {
    numbers.push_back(static_cast<uint64_t>(part.Axes[i] + 1));
    numbers.push_back(part.Axes[i] < 0 ? part.Indices[i] : part.Flipped[static_cast<size_t>(part.Axes[i])]);
    if (part.Axes[i] >= 0) {
      const size_t a = static_cast<size_t>(part.Axes[i]);
      source.Dimensions[a] = static_cast<int64_t>(part.Lengths[a]);
      source.Brick[a] = std::min(static_cast<int64_t>(array->GetChunk()[i]), source.Dimensions[a]);
      source.Before[a] = part.BeforeFirst(a, source.Brick[a]);
    }
  }
  source.Identity = vtkStratusIdentityOfPart(array->GetIdentity(), variable.Name, numbers);
  source.Read = [array, values, part](const int64_t lo[3], const int64_t size[3], void* to) {
    std::vector<size_t> start = part.Indices, count(start.size(), 1);
    std::vector<int64_t> strides(start.size(), 0);
    const int64_t bytes = static_cast<int64_t>(array->GetValueBytes()), along[3] = { bytes, bytes * size[0], bytes * size[0] * size[1] };
    int64_t first = 0;
    for (size_t i = 0; i < start.size(); ++i) {
      if (part.Axes[i] >= 0) {
        const size_t a = static_cast<size_t>(part.Axes[i]);
        const bool flipped = part.Flipped[a];
        start[i] = static_cast<size_t>(flipped ? static_cast<int64_t>(part.Lengths[a]) - lo[a] - size[a] : lo[a]);
        count[i] = static_cast<size_t>(size[a]);
        strides[i] = flipped ? -along[a] : along[a];
        first += flipped ? (size[a] - 1) * along[a] : 0;
      }
    }
    try {
      values->ReadInto(
        static_cast<size_t>(size[0] * size[1] * size[2]),
        [&](void* stored) { array->Read(start, count, static_cast<char*>(stored) + first, strides, false); }, to);
      return true;
    } catch (const vtkStratusReadError&) {
      return false;
    } catch (const std::bad_alloc&) {
      return false;
    }
  };
  vtkStratusCutSource(source, part.Box.Low, part.Box.Size);
  return vtkStratusMakeBricks(source);
}
