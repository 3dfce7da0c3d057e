// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusNetCDFModel.h"

#include "vtkStratusNetCDFValues.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

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

void vtkStratusNetCDFModel::Fail(const std::string& why) const
{
  throw vtkStratusReadError{ this->Path + ": " + why };
}

void vtkStratusNetCDFModel::FailWithoutNumbers(const Variable& variable) const
{
  this->Fail("variable '" + variable.Name + "' " + this->WhyNoNumbers(variable));
}

void vtkStratusNetCDFModel::Select(const std::string& selection)
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

const vtkStratusNetCDFModel::Variable* vtkStratusNetCDFModel::Find(const std::string& name, const Variable* from) const
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

const vtkStratusNetCDFModel::Variable* vtkStratusNetCDFModel::CoordinateOf(int dimension) const
{
  const auto found = std::find_if(this->Variables.begin(), this->Variables.end(), [this, dimension](const Variable& one) {
    return one.Dimensions.size() == 1 && one.Dimensions[0] == dimension && one.BaseName() == this->NameOf(dimension);
  });
  return found == this->Variables.end() ? nullptr : &*found;
}

std::string vtkStratusNetCDFModel::DescribeDimensions(const Variable& variable) const
{
  std::string text;
  for (int dimension : variable.Dimensions) {
    text += (text.empty() ? "" : ", ") + this->NameOf(dimension) + " (" + std::to_string(this->LengthOf(dimension)) + ")";
  }
  return text.empty() ? "none" : text;
}

std::string vtkStratusNetCDFModel::DescribeIndex(int dimension) const
{
  const std::string& name = this->NameOf(dimension);
  return "; '" + name + "' at index " + std::to_string(this->IndexOf(dimension)) + " of 0.." +
    std::to_string(this->LengthOf(dimension) - 1) + (this->IsSelected(dimension) ? "" : ", select " + name + "=INDEX for another");
}

int vtkStratusNetCDFModel::FindDimension(const std::string& name) const
{
  const auto found = std::find(this->Names.begin(), this->Names.end(), name);
  return found == this->Names.end() ? -1 : static_cast<int>(found - this->Names.begin());
}

size_t vtkStratusNetCDFModel::CountOf(const Variable& variable) const
{
  size_t count = 1;
  for (int dimension : variable.Dimensions) {
    count *= this->LengthOf(dimension);
  }
  return count;
}

std::string vtkStratusNetCDFModel::Title(const Variable& variable) const
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

std::string vtkStratusNetCDFModel::Text(const Variable& variable, const char* attribute) const
{
  return this->ReadAttribute(variable, attribute).Text;
}

bool vtkStratusNetCDFModel::Has(const Variable& variable, const char* attribute) const
{
  return this->ReadAttribute(variable, attribute).Exists;
}

std::vector<double> vtkStratusNetCDFModel::NumbersOf(const Variable& variable, const char* attribute) const
{
  return this->ReadAttribute(variable, attribute).Reals;
}

bool vtkStratusNetCDFModel::Number(const Variable& variable, const char* attribute, double& value) const
{
  const std::vector<double> values = this->NumbersOf(variable, attribute);
  value = values.empty() ? value : values[0];
  return !values.empty();
}

vtkStratusNetCDFValues vtkStratusNetCDFModel::ValuesOf(const Variable& variable) const
{
  if (!variable.HasNumbers()) {
    this->FailWithoutNumbers(variable);
  }
  const auto attributes = [this, &variable](const char* name) { return this->ReadAttribute(variable, name); };
  try {
    return vtkStratusNetCDFValues(attributes, variable.Type, variable.Name, this->HasDefaultFill(variable), this->KeepsIntegers());
  } catch (const std::string& why) {
    this->Fail(why);
  }
}

std::string vtkStratusNetCDFModel::DescribeValues(const Variable& variable) const
{
  return this->ValuesOf(variable).Describe();
}

vtkSmartPointer<vtkDataArray> vtkStratusNetCDFModel::Read(
  const Variable& variable, const std::vector<size_t>& start, const std::vector<size_t>& count) const
{
  std::vector<size_t> from = start, many = count;
  if (count.empty()) {
    from.assign(variable.Dimensions.size(), 0);
    for (int dimension : variable.Dimensions) {
      many.push_back(this->LengthOf(dimension));
    }
  }
  size_t total = 1;
  for (size_t one : many) {
    total *= one;
  }
  const vtkSmartPointer<vtkDataArray> array =
    this->ValuesOf(variable).Read(total, [&](void* stored) { this->ReadStored(variable, from, many, stored); });
  array->SetName(variable.Name.c_str());
  return array;
}

std::vector<double> vtkStratusNetCDFModel::ReadComplete(const Variable& variable, const std::string& what) const
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
