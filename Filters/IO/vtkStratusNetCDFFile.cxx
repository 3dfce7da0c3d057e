// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusNetCDFFile.h"

#include "vtkStratusNetCDFBricks.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <netcdf.h>
#include <system_error>

static_assert(vtkStratusNetCDFInt8 == NC_BYTE && vtkStratusNetCDFChar == NC_CHAR && vtkStratusNetCDFInt16 == NC_SHORT &&
    vtkStratusNetCDFInt32 == NC_INT && vtkStratusNetCDFFloat32 == NC_FLOAT && vtkStratusNetCDFFloat64 == NC_DOUBLE &&
    vtkStratusNetCDFUInt8 == NC_UBYTE && vtkStratusNetCDFUInt16 == NC_USHORT && vtkStratusNetCDFUInt32 == NC_UINT &&
    vtkStratusNetCDFInt64 == NC_INT64 && vtkStratusNetCDFUInt64 == NC_UINT64 && vtkStratusNetCDFText == NC_STRING &&
    vtkStratusNetCDFModel::Global == NC_GLOBAL,
  "numbers of libnetcdf");

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

void vtkStratusNetCDFFile::Check(int status, const std::string& what) const
{
  if (status != NC_NOERR) {
    this->Fail(what + ": " + nc_strerror(status));
  }
}

vtkStratusNetCDFFile::vtkStratusNetCDFFile(const std::string& path, const std::string& selection) : vtkStratusNetCDFModel(path)
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

std::vector<size_t> vtkStratusNetCDFFile::ChunksOf(const Variable& variable) const
{
  int storage = NC_CONTIGUOUS;
  std::vector<size_t> chunks(variable.Dimensions.size());
  const int status = nc_inq_var_chunking(variable.Group, variable.Id, &storage, chunks.data());
  return status == NC_NOERR && storage == NC_CHUNKED ? chunks : std::vector<size_t>();
}

vtkStratusNetCDFFile::Attribute vtkStratusNetCDFFile::ReadAttribute(const Variable& variable, const char* name) const
{
  Attribute result;
  nc_type type = NC_NAT;
  if (nc_inq_att(variable.Group, variable.Id, name, &type, &result.Length) != NC_NOERR) {
    return result;
  }
  const size_t length = result.Length;
  result.Exists = true;
  result.IsText = type == NC_CHAR || type >= NC_STRING;
  if (type == NC_CHAR) {
    result.Text.resize(length);
    this->Check(nc_get_att_text(variable.Group, variable.Id, name, &result.Text[0]), "attribute");
  } else if (type == NC_STRING && length > 0) {
    std::vector<char*> strings(length, nullptr);
    this->Check(nc_get_att_string(variable.Group, variable.Id, name, strings.data()), "attribute");
    result.Text = strings[0] ? strings[0] : "";
    nc_free_string(length, strings.data());
  }
  result.Text.resize(std::min(result.Text.size(), result.Text.find('\0')));
  if (result.IsText) {
    return result;
  }
  result.Reals.resize(length);
  this->Check(nc_get_att_double(variable.Group, variable.Id, name, result.Reals.data()), "attribute");
  if (type == NC_UINT64) {
    std::vector<unsigned long long> bits(length);
    this->Check(nc_get_att_ulonglong(variable.Group, variable.Id, name, bits.data()), "attribute");
    std::transform(bits.begin(), bits.end(), std::back_inserter(result.Integers), [](auto one) { return static_cast<std::int64_t>(one); });
  } else if (type != NC_FLOAT && type != NC_DOUBLE) {
    std::vector<long long> integers(length);
    this->Check(nc_get_att_longlong(variable.Group, variable.Id, name, integers.data()), "attribute");
    result.Integers.assign(integers.begin(), integers.end());
  }
  return result;
}

bool vtkStratusNetCDFFile::HasDefaultFill(const Variable& variable) const
{
  int none = 0;
  return nc_inq_var_fill(variable.Group, variable.Id, &none, nullptr) == NC_NOERR && !none;
}

void vtkStratusNetCDFFile::ReadStored(
  const Variable& variable, const std::vector<size_t>& start, const std::vector<size_t>& count, void* stored) const
{
  const size_t zero = 0, one = 1;
  const int status =
    nc_get_vara(variable.Group, variable.Id, start.empty() ? &zero : start.data(), count.empty() ? &one : count.data(), stored);
  this->Check(status, "variable '" + variable.Name + "' cannot be read");
}

std::vector<std::string> vtkStratusNetCDFFile::ReadTexts(const Variable& variable) const
{
  std::vector<std::string> texts(this->LengthOf(variable.Dimensions[0]));
  const std::string what = "variable '" + variable.Name + "' cannot be read";
  if (variable.Type == NC_STRING) {
    std::vector<char*> strings(texts.size(), nullptr);
    this->Check(nc_get_var_string(variable.Group, variable.Id, strings.data()), what);
    std::transform(strings.begin(), strings.end(), texts.begin(), [](const char* one) { return std::string(one ? one : ""); });
    nc_free_string(strings.size(), strings.data());
  } else {
    const size_t length = this->LengthOf(variable.Dimensions[1]);
    std::vector<char> all(texts.size() * length);
    this->Check(nc_get_var_text(variable.Group, variable.Id, all.data()), what);
    for (size_t i = 0; i < texts.size(); ++i) {
      texts[i].assign(&all[i * length], length);
      texts[i] = texts[i].substr(0, texts[i].find('\0'));
    }
  }
  for (std::string& text : texts) {
    text.resize(text.find_last_not_of(' ') + 1);
  }
  return texts;
}

vtkSmartPointer<vtkDataArray> vtkStratusNetCDFFile::MakeBricks(const Variable& variable, const vtkStratusNetCDFPart& part) const
{
  return vtkStratusMakeNetCDFBricks(*this, variable, part);
}
