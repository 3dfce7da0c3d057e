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

vtkStratusNetCDFFile::vtkStratusNetCDFFile(const std::string& path) : Path(path)
{
  this->Check(nc_open(path.c_str(), NC_NOWRITE, &this->Id), "no netCDF file that can be read");
  try {
    int dimensions = 0, variables = 0, attributes = 0, unlimited = 0;
    char name[NC_MAX_NAME + 1] = "";
    this->Check(nc_inq(this->Id, &dimensions, &variables, &attributes, &unlimited), "contents");
    for (int i = 0; i < dimensions; ++i) {
      size_t length = 0;
      this->Check(nc_inq_dim(this->Id, i, name, &length), "dimension");
      this->Names.push_back(name);
      this->Lengths.push_back(length);
    }
    for (int i = 0; i < variables; ++i) {
      Variable one = { i, NC_NAT, "", {} };
      int count = 0;
      this->Check(nc_inq_varndims(this->Id, i, &count), "variable");
      one.Dimensions.resize(static_cast<size_t>(count));
      this->Check(nc_inq_var(this->Id, i, name, &one.Type, nullptr, one.Dimensions.data(), nullptr), "variable");
      one.Name = name;
      this->Variables.push_back(one);
    }
    this->CheckLength(attributes, unlimited);
  } catch (const vtkStratusReadError&) {
    nc_close(this->Id);
    throw;
  }
}

// libnetcdf takes zeros for what a file of the classic formats lacks at its end, so its least length is computed from its contents, as the
// format's specification has it. Other formats are checked by HDF5.
void vtkStratusNetCDFFile::CheckLength(int attributes, int unlimited) const
{
  int format = 0;
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

const vtkStratusNetCDFFile::Variable* vtkStratusNetCDFFile::Find(const std::string& name) const
{
  const auto found =
    std::find_if(this->Variables.begin(), this->Variables.end(), [&name](const Variable& one) { return one.Name == name; });
  return found == this->Variables.end() ? nullptr : &*found;
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

std::string vtkStratusNetCDFFile::Text(const Variable& variable, const char* attribute) const
{
  nc_type type = NC_NAT;
  size_t length = 0;
  if (nc_inq_att(this->Id, variable.Id, attribute, &type, &length) != NC_NOERR) {
    return "";
  }
  std::string text;
  if (type == NC_CHAR) {
    text.resize(length);
    this->Check(nc_get_att_text(this->Id, variable.Id, attribute, &text[0]), "attribute");
  } else if (type == NC_STRING && length > 0) {
    std::vector<char*> strings(length);
    this->Check(nc_get_att_string(this->Id, variable.Id, attribute, strings.data()), "attribute");
    text = strings[0] ? strings[0] : "";
    nc_free_string(length, strings.data());
  }
  return text.substr(0, text.find('\0'));
}

bool vtkStratusNetCDFFile::Number(const Variable& variable, const char* attribute, double& value) const
{
  nc_type type = NC_NAT;
  size_t length = 0;
  if (nc_inq_att(this->Id, variable.Id, attribute, &type, &length) != NC_NOERR || length < 1 || type == NC_CHAR || type == NC_STRING) {
    return false;
  }
  std::vector<double> values(length);
  this->Check(nc_get_att_double(this->Id, variable.Id, attribute, values.data()), "attribute");
  value = values[0];
  return true;
}

vtkStratusNetCDFValues vtkStratusNetCDFFile::ValuesOf(const Variable& variable) const
{
  if (variable.Type == NC_CHAR || variable.Type >= NC_STRING) {
    this->Fail("variable '" + variable.Name + "' holds no numbers");
  }
  try {
    return vtkStratusNetCDFValues(this->Id, variable.Id, variable.Type, variable.Name);
  } catch (const std::string& why) {
    this->Fail(why);
  }
}

std::string vtkStratusNetCDFFile::DescribeValues(const Variable& variable) const
{
  return this->ValuesOf(variable).Describe();
}

vtkSmartPointer<vtkDataArray> vtkStratusNetCDFFile::Read(
  const Variable& variable, const std::vector<size_t>& start, const std::vector<size_t>& count) const
{
  std::vector<size_t> from = start, many = count;
  if (count.empty()) {
    from.assign(variable.Dimensions.size(), 0);
    for (int dimension : variable.Dimensions) {
      many.push_back(this->LengthOf(dimension));
    }
  }
  int status = NC_NOERR;
  const vtkSmartPointer<vtkDataArray> array = this->ValuesOf(variable).Read(from, many, status);
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

const vtkStratusNetCDFFile::Variable* vtkStratusNetCDFFile::TimeOf(int dimension) const
{
  const auto is_time = [this](const Variable& one) {
    return this->Text(one, "units").find(" since ") != std::string::npos || this->Text(one, "standard_name") == "time" ||
      this->Text(one, "axis") == "T";
  };
  const std::string& name = this->NameOf(dimension);
  const Variable* own = this->Find(name);
  const bool named = name == "time" || name == "Time" || name == "TIME" || name == "t";
  if (own && own->Dimensions.size() == 1 && own->Dimensions[0] == dimension && (named || is_time(*own))) {
    return own;
  }
  for (const Variable& one : this->Variables) { // WRF's XTIME along the dimension Time
    if (one.Dimensions.size() == 1 && one.Dimensions[0] == dimension && is_time(one)) {
      return &one;
    }
  }
  return nullptr;
}

std::vector<double> vtkStratusNetCDFFile::ReadTimes(const Variable& variable) const
{
  std::vector<double> times = this->ReadComplete(variable, "time");
  for (size_t i = 1; i < times.size(); ++i) {
    if (!(times[i] > times[i - 1])) {
      this->Fail("time '" + variable.Name + "' must increase: step " + std::to_string(i) + " is at " + vtkStratusNumberText(times[i]) +
        ", after " + vtkStratusNumberText(times[i - 1]));
    }
  }
  return times;
}
