// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusNetCDFFile.h"

#include "vtkStratusNetCDFValues.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <netcdf.h>
#include <sstream>
#include <system_error>

namespace {

size_t Padded(size_t bytes)
{
  return (bytes + 3) / 4 * 4;
}

size_t BytesOf(nc_type type)
{
  size_t bytes = 0;
  nc_inq_type(-1, type, nullptr, &bytes);
  return bytes;
}

size_t BytesOfAttributes(int file, int variable, int count)
{
  size_t bytes = 8;
  for (int i = 0; i < count; ++i) {
    char name[NC_MAX_NAME + 1] = "";
    nc_type type = NC_NAT;
    size_t length = 0;
    nc_inq_attname(file, variable, i, name);
    nc_inq_att(file, variable, name, &type, &length);
    bytes += 4 + Padded(std::strlen(name)) + 8 + Padded(length * BytesOf(type));
  }
  return bytes;
}
} // namespace

std::recursive_mutex& vtkStratusNetCDFLock()
{
  static std::recursive_mutex lock;
  return lock;
}

std::vector<std::string> vtkStratusWords(const std::string& text)
{
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; stream >> word;) {
    words.push_back(word);
  }
  return words;
}

std::string vtkStratusNumberText(double value)
{
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

void vtkStratusNetCDFFile::Fail(const std::string& why) const
{
  throw vtkStratusReadError{ this->Path + ": " + why };
}

void vtkStratusNetCDFFile::Check(int status, const std::string& what) const
{
  if (status != NC_NOERR) {
    this->Fail(what + ": " + nc_strerror(status));
  }
}

vtkStratusNetCDFFile::vtkStratusNetCDFFile(const std::string& path, const std::string& selection) : Path(path)
{
  this->Check(nc_open(path.c_str(), NC_NOWRITE, &this->Id), "no netCDF file that can be read");
  try {
    this->Load(this->Id, "");
    this->CheckLength();
    this->Select(selection);
  } catch (const vtkStratusReadError&) {
    nc_close(this->Id);
    throw;
  }
}

// Lists the dimensions and variables of a group, then its groups' dimensions and variables. `path` has a slash at its end.
void vtkStratusNetCDFFile::Load(int group, const std::string& path)
{
  char name[NC_MAX_NAME + 1] = "";
  int dimensions = 0, variables = 0, groups = 0, unlimited = 0;
  this->Check(nc_inq_dimids(group, &dimensions, nullptr, 0), "dimensions");
  this->Check(nc_inq_varids(group, &variables, nullptr), "variables");
  this->Check(nc_inq_grps(group, &groups, nullptr), "groups");
  this->Check(nc_inq_unlimdims(group, &unlimited, nullptr), "unlimited dimensions");
  std::vector<int> dimension_ids(static_cast<size_t>(dimensions)), variable_ids(static_cast<size_t>(variables)),
    group_ids(static_cast<size_t>(groups)), unlimited_ids(static_cast<size_t>(unlimited));
  this->Check(nc_inq_dimids(group, nullptr, dimension_ids.data(), 0), "dimensions");
  this->Check(nc_inq_varids(group, nullptr, variable_ids.data()), "variables");
  this->Check(nc_inq_grps(group, nullptr, group_ids.data()), "groups");
  this->Check(nc_inq_unlimdims(group, nullptr, unlimited_ids.data()), "unlimited dimensions");
  for (int id : dimension_ids) {
    size_t length = 0;
    this->Check(nc_inq_dim(group, id, name, &length), "dimension");
    this->Numbers[id] = static_cast<int>(this->Names.size());
    this->Names.push_back(name);
    this->Paths.push_back(path);
    this->Lengths.push_back(length);
    this->Unlimited.push_back(std::count(unlimited_ids.begin(), unlimited_ids.end(), id) > 0 ? 1 : 0);
    this->Selected.push_back(-1);
  }
  for (int id : variable_ids) {
    Variable one = { group, id, NC_NAT, "", {} };
    int count = 0;
    this->Check(nc_inq_varndims(group, id, &count), "variable");
    one.Dimensions.resize(static_cast<size_t>(count));
    this->Check(nc_inq_var(group, id, name, &one.Type, nullptr, one.Dimensions.data(), nullptr), "variable");
    one.Name = path + name;
    for (int& dimension : one.Dimensions) {
      dimension = this->Numbers.at(dimension);
    }
    this->Variables.push_back(one);
  }
  for (int id : group_ids) {
    this->Check(nc_inq_grpname(id, name), "group");
    this->Load(id, path + name + "/");
  }
}

void vtkStratusNetCDFFile::Select(const std::string& selection)
{
  std::istringstream stream(selection);
  for (std::string part; std::getline(stream, part, ',');) {
    const size_t equal = part.rfind('=');
    const std::string name = part.substr(0, equal), number = equal == std::string::npos ? "" : part.substr(equal + 1);
    if (name.empty() || number.empty() || number.size() > 18 || number.find_first_not_of("0123456789") != std::string::npos) {
      this->Fail("the selection '" + part + "' is not NAME=INDEX, with a dimension's name and an index from 0");
    }
    const long long index = std::stoll(number);
    std::string names;
    bool found = false;
    for (size_t i = 0; i < this->Names.size(); ++i) {
      const std::string path = this->Paths[i] + this->Names[i];
      names += (names.empty() ? "" : ", ") + path + " (" + std::to_string(this->Lengths[i]) + ")";
      if (name != path && name != "/" + path && name != this->Names[i]) {
        continue;
      }
      if (static_cast<size_t>(index) >= this->Lengths[i]) {
        this->Fail("the selection '" + part + "' is out of range: '" + path + "' has " + std::to_string(this->Lengths[i]) + " values" +
          (this->Lengths[i] > 0 ? ", the index must be 0 to " + std::to_string(this->Lengths[i] - 1) : ""));
      }
      this->Selected[i] = index;
      found = true;
    }
    if (!found) {
      this->Fail("there is no dimension '" + name + "' to select; those that are: " + (names.empty() ? "none" : names));
    }
  }
}

// libnetcdf reads zeros beyond the end of a truncated file of the classic formats. The file's minimum length is therefore computed from its
// contents, by the format's specification. Other formats are checked by HDF5.
void vtkStratusNetCDFFile::CheckLength() const
{
  int format = 0, attributes = 0, unlimited = 0;
  this->Check(nc_inq(this->Id, nullptr, nullptr, &attributes, &unlimited), "contents");
  this->Check(nc_inq_format(this->Id, &format), "format");
  if (format != NC_FORMAT_CLASSIC && format != NC_FORMAT_64BIT_OFFSET) {
    return;
  }
  size_t needed = 8 + 8 + BytesOfAttributes(this->Id, NC_GLOBAL, attributes) + 8;
  for (const std::string& name : this->Names) {
    needed += 8 + Padded(name.size());
  }
  size_t a_record = 0, unpadded = 0, with_records = 0;
  for (const Variable& one : this->Variables) {
    int own = 0;
    this->Check(nc_inq_varnatts(this->Id, one.Id, &own), "attributes");
    needed += 4 + Padded(one.Name.size()) + 4 + 4 * one.Dimensions.size() + BytesOfAttributes(this->Id, one.Id, own) + 8 +
      (format == NC_FORMAT_CLASSIC ? 4 : 8);
    size_t bytes = BytesOf(one.Type);
    const bool recorded = !one.Dimensions.empty() && one.Dimensions[0] == unlimited;
    for (size_t i = recorded ? 1 : 0; i < one.Dimensions.size(); ++i) {
      bytes *= this->LengthOf(one.Dimensions[i]);
    }
    needed += recorded ? 0 : Padded(bytes);
    a_record += recorded ? Padded(bytes) : 0;
    unpadded += recorded ? bytes : 0;
    with_records += recorded ? 1 : 0;
  }
  needed += unlimited < 0 ? 0 : this->LengthOf(unlimited) * (with_records == 1 ? unpadded : a_record);
  std::error_code error;
  const std::uintmax_t there = std::filesystem::file_size(this->Path, error);
  if (!error && there + 3 < needed) { // the last padding may be left out
    this->Fail("the file is cut short: it has " + std::to_string(there) + " bytes, its variables need " + std::to_string(needed));
  }
}

vtkStratusNetCDFFile::~vtkStratusNetCDFFile()
{
  nc_close(this->Id);
}

const vtkStratusNetCDFFile::Variable* vtkStratusNetCDFFile::Find(const std::string& name, const Variable* from) const
{
  const auto named = [this](const std::string& path) -> const Variable* {
    const auto found =
      std::find_if(this->Variables.begin(), this->Variables.end(), [&path](const Variable& one) { return one.Name == path; });
    return found == this->Variables.end() ? nullptr : &*found;
  };
  if (!from || (!name.empty() && name[0] == '/')) {
    return named(name.substr(name.find_first_not_of('/') == std::string::npos ? name.size() : name.find_first_not_of('/')));
  }
  std::string path = from->Name;
  while (path.find('/') != std::string::npos) {
    path.resize(path.rfind('/'));
    if (const Variable* found = named(path + "/" + name)) {
      return found;
    }
  }
  if (const Variable* found = named(name)) {
    return found;
  }
  const auto found =
    std::find_if(this->Variables.begin(), this->Variables.end(), [&name](const Variable& one) { return one.BaseName() == name; });
  return found == this->Variables.end() ? nullptr : &*found;
}

const vtkStratusNetCDFFile::Variable* vtkStratusNetCDFFile::CoordinateOf(int dimension) const
{
  const auto found = std::find_if(this->Variables.begin(), this->Variables.end(), [this, dimension](const Variable& one) {
    return one.Dimensions.size() == 1 && one.Dimensions[0] == dimension && one.BaseName() == this->NameOf(dimension);
  });
  return found == this->Variables.end() ? nullptr : &*found;
}

std::string vtkStratusNetCDFFile::DescribeDimensions(const Variable& variable) const
{
  std::string text;
  for (int dimension : variable.Dimensions) {
    text += (text.empty() ? "" : ", ") + this->NameOf(dimension) + " (" + std::to_string(this->LengthOf(dimension)) + ")";
  }
  return text.empty() ? "none" : text;
}

std::string vtkStratusNetCDFFile::DescribeIndex(int dimension) const
{
  const std::string& name = this->NameOf(dimension);
  return "; '" + name + "' at index " + std::to_string(this->IndexOf(dimension)) + " of 0.." +
    std::to_string(this->LengthOf(dimension) - 1) + (this->IsSelected(dimension) ? "" : ", select " + name + "=INDEX for another");
}

int vtkStratusNetCDFFile::FindDimension(const std::string& name) const
{
  const auto found = std::find(this->Names.begin(), this->Names.end(), name);
  return found == this->Names.end() ? -1 : static_cast<int>(found - this->Names.begin());
}

size_t vtkStratusNetCDFFile::CountOf(const Variable& variable) const
{
  size_t count = 1;
  for (int dimension : variable.Dimensions) {
    count *= this->LengthOf(dimension);
  }
  return count;
}

std::string vtkStratusNetCDFFile::Title(const Variable& variable) const
{
  constexpr size_t longest = 32;
  std::string title = this->Text(variable, "long_name");
  if (title.empty() || title.size() > longest) {
    title = this->Text(variable, "standard_name");
    std::replace(title.begin(), title.end(), '_', ' ');
  }
  if (title == "projection x coordinate" || title == "projection y coordinate") {
    return title.substr(11, 1); // the letter says as much
  }
  return title;
}

std::string vtkStratusNetCDFFile::Text(const Variable& variable, const char* attribute) const
{
  nc_type type = NC_NAT;
  size_t length = 0;
  if (nc_inq_att(variable.Group, variable.Id, attribute, &type, &length) != NC_NOERR) {
    return "";
  }
  std::string text;
  if (type == NC_CHAR) {
    text.resize(length);
    this->Check(nc_get_att_text(variable.Group, variable.Id, attribute, &text[0]), "attribute");
  } else if (type == NC_STRING && length > 0) {
    std::vector<char*> strings(length);
    this->Check(nc_get_att_string(variable.Group, variable.Id, attribute, strings.data()), "attribute");
    text = strings[0] ? strings[0] : "";
    nc_free_string(length, strings.data());
  }
  return text.substr(0, text.find('\0'));
}

bool vtkStratusNetCDFFile::Has(const Variable& variable, const char* attribute) const
{
  return nc_inq_att(variable.Group, variable.Id, attribute, nullptr, nullptr) == NC_NOERR;
}

std::vector<double> vtkStratusNetCDFFile::NumbersOf(const Variable& variable, const char* attribute) const
{
  nc_type type = NC_NAT;
  size_t length = 0;
  if (nc_inq_att(variable.Group, variable.Id, attribute, &type, &length) != NC_NOERR || type == NC_CHAR || type >= NC_STRING) {
    return {};
  }
  std::vector<double> values(length);
  this->Check(nc_get_att_double(variable.Group, variable.Id, attribute, values.data()), "attribute");
  return values;
}

bool vtkStratusNetCDFFile::Number(const Variable& variable, const char* attribute, double& value) const
{
  const std::vector<double> values = this->NumbersOf(variable, attribute);
  value = values.empty() ? value : values[0];
  return !values.empty();
}

vtkStratusNetCDFValues vtkStratusNetCDFFile::ValuesOf(const Variable& variable) const
{
  if (variable.Type == NC_CHAR || variable.Type >= NC_STRING) {
    this->Fail("variable '" + variable.Name + "' holds no numbers");
  }
  try {
    return vtkStratusNetCDFValues(variable.Group, variable.Id, variable.Type, variable.Name);
  } catch (const std::string& why) {
    this->Fail(why);
  }
}

std::string vtkStratusNetCDFFile::DescribeValues(const Variable& variable) const
{
  return this->ValuesOf(variable).Describe();
}

std::vector<size_t> vtkStratusNetCDFFile::ChunksOf(const Variable& variable) const
{
  int storage = NC_CONTIGUOUS;
  std::vector<size_t> chunks(variable.Dimensions.size());
  const int status = nc_inq_var_chunking(variable.Group, variable.Id, &storage, chunks.data());
  return status == NC_NOERR && storage == NC_CHUNKED ? chunks : std::vector<size_t>();
}

vtkSmartPointer<vtkDataArray> vtkStratusNetCDFFile::Read(const Variable& variable, const std::vector<size_t>& start,
  const std::vector<size_t>& count, std::unique_lock<std::recursive_mutex>* lock) const
{
  std::vector<size_t> from = start, many = count;
  if (count.empty()) {
    from.assign(variable.Dimensions.size(), 0);
    for (int dimension : variable.Dimensions) {
      many.push_back(this->LengthOf(dimension));
    }
  }
  int status = NC_NOERR;
  const vtkSmartPointer<vtkDataArray> array = this->ValuesOf(variable).Read(from, many, status, lock);
  this->Check(status, "variable '" + variable.Name + "' cannot be read");
  array->SetName(variable.Name.c_str());
  return array;
}

std::vector<double> vtkStratusNetCDFFile::ReadComplete(const Variable& variable, const std::string& what) const
{
  const vtkSmartPointer<vtkDataArray> array = this->Read(variable);
  std::vector<double> values(static_cast<size_t>(array->GetNumberOfTuples()));
  for (size_t i = 0; i < values.size(); ++i) {
    values[i] = array->GetComponent(static_cast<vtkIdType>(i), 0);
    if (!std::isfinite(values[i])) {
      this->Fail(what + " '" + variable.Name + "' has no value (a fill value, or not finite) at number " + std::to_string(i) +
        ", all must be finite");
    }
  }
  return values;
}
