// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusCFGrid.h"

#include "vtkDoubleArray.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <netcdf.h>

namespace {
constexpr double EarthRadius = 6371000.0; // metres

// Heights that follow from other variables: appendix D of the CF conventions.
constexpr struct {
  const char* Name;
  const char* Terms[5];
} Formulas[] = {
  { "ocean_sigma_coordinate", { "sigma", "eta", "depth" } },
  { "ocean_s_coordinate_g1", { "s", "C", "eta", "depth", "depth_c" } },
  { "ocean_s_coordinate_g2", { "s", "C", "eta", "depth", "depth_c" } },
  { "atmosphere_hybrid_height_coordinate", { "a", "b", "orog" } },
};

std::string Lower(std::string text)
{
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool IsOneOf(const std::string& word, std::initializer_list<const char*> words)
{
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool IsDegrees(const std::string& units)
{
  return units.compare(0, 6, "degree") == 0;
}

bool IsPressure(const std::string& units)
{
  return IsOneOf(units, { "Pa", "hPa", "mb", "mbar", "millibar", "millibars" });
}

// Metres of a unit of length, 0 for other units.
double MetresOf(const std::string& units)
{
  if (IsOneOf(units, { "m", "meter", "meters", "metre", "metres" })) {
    return 1.0;
  }
  return IsOneOf(units, { "km", "kilometer", "kilometers", "kilometre", "kilometres" }) ? 1000.0 : units == "cm" ? 0.01 : 0.0;
}

double HeightOfPressure(double pressure, const std::string& units)
{
  return 44330.77 * (1.0 - std::pow(pressure / (units == "Pa" ? 101325.0 : 1013.25), 0.190263));
}

int AxisOfName(const std::string& name)
{
  const std::string word = Lower(name);
  if (IsOneOf(word, { "x", "xc", "xt", "xm", "xh", "lon", "longitude", "rlon", "west_east", "xi_rho", "ni", "i", "nx" })) {
    return 0;
  }
  if (IsOneOf(word, { "y", "yc", "yt", "ym", "yh", "lat", "latitude", "rlat", "south_north", "eta_rho", "nj", "j", "ny" })) {
    return 1;
  }
  const bool height = IsOneOf(word,
    { "z", "zc", "zt", "zm", "zh", "lev", "level", "levels", "height", "altitude", "depth", "plev", "pressure", "bottom_top", "s_rho",
      "s_w", "sigma", "layer", "k", "nz" });
  return height ? 2 : -1;
}
} // namespace

bool vtkStratusCFGrid::IsVolume(const vtkStratusNetCDFFile& file, const Variable& variable)
{
  if (variable.Type == NC_CHAR || variable.Type >= NC_STRING) {
    return false;
  }
  int space = 0;
  for (int dimension : variable.Dimensions) {
    space += file.LengthOf(dimension) > 1 && !file.TimeOf(dimension) ? 1 : 0;
  }
  return space == 3;
}

vtkStratusCFGrid::vtkStratusCFGrid(const vtkStratusNetCDFFile& file, const Variable& variable) : File(file), Of(variable)
{
  this->FindDimensions();
  this->FindCoordinates();
  this->ConvertUnits();
}

void vtkStratusCFGrid::FindDimensions()
{
  std::vector<int> space;
  for (int dimension : this->Of.Dimensions) {
    const Variable* time = this->File.TimeOf(dimension);
    if (time) {
      this->Time = time;
      this->TimeDimension = dimension;
    } else if (this->File.LengthOf(dimension) > 1) {
      space.push_back(dimension);
    }
  }
  if (space.size() != 3) {
    this->File.Fail("variable '" + this->Of.Name + "' has " + std::to_string(space.size()) +
      " dimensions in space that are longer than 1; a volume has 3");
  }
  this->SortDimensions(space);
}

// By what the dimensions' coordinates tell, if that names each axis once; else x is the last.
void vtkStratusCFGrid::SortDimensions(std::vector<int> space)
{
  this->Dimensions = { { space[2], space[1], space[0] } };
  std::array<int, 3> told = { { -1, -1, -1 } };
  for (int dimension : space) {
    const int axis = this->AxisOfDimension(dimension);
    if (axis < 0 || told[static_cast<size_t>(axis)] >= 0) {
      return;
    }
    told[static_cast<size_t>(axis)] = dimension;
  }
  this->Dimensions = told;
}

int vtkStratusCFGrid::AxisOfDimension(int dimension) const
{
  const std::string& name = this->File.NameOf(dimension);
  const Variable* own = this->File.Find(name);
  const int axis = own ? this->AxisOf(*own) : -1;
  return axis >= 0 ? axis : AxisOfName(name);
}

// Returns 0, 1, 2 for a coordinate along x, y, z, and -1 where its attributes tell nothing.
int vtkStratusCFGrid::AxisOf(const Variable& coordinate) const
{
  const std::string axis = this->File.Text(coordinate, "axis"), name = this->File.Text(coordinate, "standard_name"),
                    units = this->File.Text(coordinate, "units");
  if (axis == "X" || axis == "Y" || axis == "Z") {
    return axis[0] - 'X';
  }
  if (IsOneOf(name, { "longitude", "projection_x_coordinate", "grid_longitude" }) || IsOneOf(units, { "degrees_east", "degree_east" })) {
    return 0;
  }
  if (IsOneOf(name, { "latitude", "projection_y_coordinate", "grid_latitude" }) || IsOneOf(units, { "degrees_north", "degree_north" })) {
    return 1;
  }
  const bool vertical = IsOneOf(name, { "altitude", "height", "depth", "air_pressure", "height_above_reference_ellipsoid" }) ||
    name.compare(0, 6, "ocean_") == 0 || name.compare(0, 11, "atmosphere_") == 0;
  return vertical || IsPressure(units) || !this->File.Text(coordinate, "positive").empty() ? 2 : -1;
}

// Returns whether the variable depends on time and the three axes alone.
bool vtkStratusCFGrid::Fits(const Variable& variable) const
{
  return variable.Type != NC_CHAR && variable.Type < NC_STRING &&
    std::all_of(variable.Dimensions.begin(), variable.Dimensions.end(), [this](int one) {
      return one == this->TimeDimension || this->File.LengthOf(one) == 1 ||
        std::find(this->Dimensions.begin(), this->Dimensions.end(), one) != this->Dimensions.end();
    });
}

void vtkStratusCFGrid::FindCoordinates()
{
  std::vector<const Variable*> others;
  for (const std::string& name : vtkStratusWords(this->File.Text(this->Of, "coordinates"))) {
    const Variable* one = this->File.Find(name);
    if (one && this->Fits(*one)) {
      others.push_back(one);
    }
  }
  for (size_t a = 0; a < 3; ++a) {
    const int dimension = this->Dimensions[a];
    const auto along = [dimension](const Variable* one) { return one && one->Dimensions.size() == 1 && one->Dimensions[0] == dimension; };
    const Variable* own = this->File.Find(this->File.NameOf(dimension));
    const auto other = std::find_if(others.begin(), others.end(), along);
    this->Sources[a].Coordinate = along(own) ? own : other == others.end() ? nullptr : *other;
  }
  if (!this->Sources[0].Coordinate || !this->Sources[1].Coordinate) {
    std::array<const Variable*, 2> found = { { nullptr, nullptr } };
    for (const Variable* one : others) {
      const int axis = one->Dimensions.size() >= 2 ? this->AxisOf(*one) < 0 ? AxisOfName(one->Name) : this->AxisOf(*one) : -1;
      if (axis == 0 || axis == 1) {
        found[static_cast<size_t>(axis)] = one;
      }
    }
    if (found[0] && found[1]) {
      this->Horizontal = found;
    }
  }
  this->FindHeight(others);
  for (int a = 0; a < 3; ++a) {
    this->ReadAxis(a);
  }
}

void vtkStratusCFGrid::FindHeight(const std::vector<const Variable*>& others)
{
  for (const Variable* one : others) {
    const auto& of = one->Dimensions;
    if (std::find(of.begin(), of.end(), this->Dimensions[2]) != of.end() && of.size() >= 3 && this->Horizontal[0] != one &&
      this->Horizontal[1] != one) {
      this->Height = one;
      return;
    }
  }
  const Variable* levels = this->Sources[2].Coordinate;
  const std::string name = levels ? this->File.Text(*levels, "standard_name") : "",
                    terms = levels ? this->File.Text(*levels, "formula_terms") : "";
  for (int i = 0; i < 4 && !terms.empty(); ++i) {
    if (name == Formulas[i].Name) {
      this->Formula = i + 1;
      for (const char* term : Formulas[i].Terms) {
        if (term) {
          this->Terms.push_back(&this->Term(terms, term));
        }
      }
    }
  }
}

const vtkStratusCFGrid::Variable& vtkStratusCFGrid::Term(const std::string& terms, const std::string& name) const
{
  const std::vector<std::string> words = vtkStratusWords(terms);
  for (size_t i = 0; i + 1 < words.size(); i += 2) {
    if (words[i] == name + ":") {
      const Variable* found = this->File.Find(words[i + 1]);
      if (!found || !this->Fits(*found)) {
        this->File.Fail(
          "formula_terms name '" + words[i + 1] + "' for '" + name + "', which " + (found ? "has another grid" : "is not there"));
      }
      return *found;
    }
  }
  this->File.Fail("formula_terms '" + terms + "' have no '" + name + "'");
}

// Reads an axis, which must increase or decrease, and turns it round where it decreases. Without a coordinate it counts from 0.
void vtkStratusCFGrid::ReadAxis(int axis)
{
  const size_t a = static_cast<size_t>(axis);
  const Variable* coordinate = this->Sources[a].Coordinate;
  std::vector<double>& at = this->Axes[a];
  at.resize(this->File.LengthOf(this->Dimensions[a]));
  for (size_t i = 0; i < at.size(); ++i) {
    at[i] = static_cast<double>(i);
  }
  const bool used = axis < 2 ? !this->Horizontal[a] : !this->Height && this->Formula == 0;
  if (!coordinate || !used) {
    return;
  }
  this->Sources[a].Units = this->File.Text(*coordinate, "units");
  at = this->File.ReadComplete(*coordinate, "coordinate");
  for (size_t i = 1; i < at.size(); ++i) {
    if (!((at[i] - at[i - 1]) * (at[1] - at[0]) > 0.0)) {
      this->File.Fail("coordinate '" + coordinate->Name + "' must increase or decrease all along: number " + std::to_string(i) + " is " +
        vtkStratusNumberText(at[i]) + ", after " + vtkStratusNumberText(at[i - 1]));
    }
  }
}

void vtkStratusCFGrid::ConvertUnits()
{
  std::array<std::string, 3> units = { { this->Sources[0].Units, this->Sources[1].Units, this->Sources[2].Units } };
  for (size_t a = 0; a < 2 && this->Horizontal[0]; ++a) {
    units[a] = this->File.Text(*this->Horizontal[a], "units");
  }
  const Variable* height = this->Height ? this->Height : this->Formula > 0 ? nullptr : this->Sources[2].Coordinate;
  units[2] = height ? this->File.Text(*height, "units") : this->Formula > 0 ? "m" : "";
  for (size_t a = 0; a < 3; ++a) {
    const double metres = MetresOf(units[a]);
    this->Factors[a] = metres > 0.0 ? metres : 1.0;
  }
  const bool degrees = IsDegrees(units[0]) && IsDegrees(units[1]);
  this->Metres = (degrees || (MetresOf(units[0]) > 0.0 && MetresOf(units[1]) > 0.0)) && (MetresOf(units[2]) > 0.0 || IsPressure(units[2]));
  if (degrees) {
    double low = INFINITY, high = -INFINITY;
    const std::vector<double> latitudes = this->Horizontal[1] ? this->File.ReadComplete(*this->Horizontal[1], "coordinate") : this->Axes[1];
    for (double latitude : latitudes) {
      low = std::min(low, latitude);
      high = std::max(high, latitude);
    }
    const double degree = std::acos(-1.0) / 180.0;
    this->Factors[0] = EarthRadius * degree * std::cos(0.5 * (low + high) * degree);
    this->Factors[1] = EarthRadius * degree;
    this->Description += "degrees as metres at latitude " + vtkStratusNumberText(0.5 * (low + high)) + "; ";
  }
  this->Pressure = IsPressure(units[2]);
  if (this->Pressure) {
    this->Description += "pressure as height in the standard atmosphere; ";
  }
  if (height && this->File.Text(*height, "positive") == "down" && !this->Pressure) {
    this->Factors[2] = -this->Factors[2];
  }
  for (int a = 0; a < 3; ++a) {
    this->ConvertAxis(a, this->Factors[static_cast<size_t>(a)]);
    const size_t i = static_cast<size_t>(a);
    const Variable* from = a < 2 && this->Horizontal[i] ? this->Horizontal[i]
      : a == 2 && this->Height                          ? this->Height
                                                        : this->Sources[i].Coordinate;
    this->Description += std::string(1, "xyz"[a]) + " by " +
      (from ? "'" + from->Name + "'" + (units[i].empty() ? "" : " (" + units[i] + ")") : "number") + (a < 2 ? ", " : "");
  }
  if (this->Formula > 0) {
    this->Description += std::string(", by the formula of ") + Formulas[this->Formula - 1].Name;
  }
}

void vtkStratusCFGrid::ConvertAxis(int axis, double factor)
{
  std::vector<double>& at = this->Axes[static_cast<size_t>(axis)];
  const std::string& units = this->Sources[static_cast<size_t>(axis)].Units;
  for (double& value : at) {
    value = axis == 2 && this->Pressure && !this->Height ? HeightOfPressure(value, units) : value * factor;
  }
  if (at.size() > 1 && at[1] < at[0]) {
    this->Flipped[static_cast<size_t>(axis)] = !this->IsCurved();
    if (!this->IsCurved()) {
      std::reverse(at.begin(), at.end());
    }
  }
}

// Evenly spaced up to the digits of floats, in which most files store coordinates.
bool vtkStratusCFGrid::IsUniform() const
{
  for (const std::vector<double>& at : this->Axes) {
    const double first = at.front(), step = (at.back() - first) / static_cast<double>(at.size() - 1);
    const double rounding = 2.4e-7 * std::max(std::fabs(first), std::fabs(at.back()));
    for (size_t i = 0; i < at.size(); ++i) {
      if (std::fabs(at[i] - (first + step * static_cast<double>(i))) > std::min(std::max(rounding, 1e-9 * step), 0.01 * step)) {
        return false;
      }
    }
  }
  return true;
}

vtkStratusCFField vtkStratusCFGrid::ReadField(const Variable& variable, size_t step, const char* complete) const
{
  vtkStratusCFField field;
  std::vector<size_t> start, count;
  for (int dimension : variable.Dimensions) {
    const bool space = std::find(this->Dimensions.begin(), this->Dimensions.end(), dimension) != this->Dimensions.end();
    start.push_back(dimension == this->TimeDimension ? step : 0);
    count.push_back(space ? this->File.LengthOf(dimension) : 1);
  }
  size_t stride = 1;
  for (size_t i = count.size(); i-- > 0;) {
    for (size_t a = 0; a < 3; ++a) {
      if (this->Dimensions[a] == variable.Dimensions[i]) {
        field.Strides[a] = stride;
      }
    }
    stride *= count[i];
  }
  field.Values = this->File.Read(variable, start, count);
  for (vtkIdType i = 0; complete && i < field.Values->GetNumberOfTuples(); ++i) {
    if (!std::isfinite(field.Values->GetComponent(i, 0))) {
      this->File.Fail(std::string(complete) + " '" + variable.Name + "' has no value (a fill value, or not finite) at number " +
        std::to_string(i) + ", all must be finite");
    }
  }
  return field;
}

vtkSmartPointer<vtkDataArray> vtkStratusCFGrid::ReadValues(size_t step) const
{
  const vtkStratusCFField field = this->ReadField(this->Of, step, nullptr);
  const size_t nx = this->GetLength(0), ny = this->GetLength(1), nz = this->GetLength(2);
  const bool plain = field.Strides[0] == 1 && field.Strides[1] == nx && field.Strides[2] == nx * ny && !this->Flipped[0] &&
    !this->Flipped[1] && !this->Flipped[2];
  if (plain) {
    return field.Values;
  }
  vtkSmartPointer<vtkDataArray> sorted;
  sorted.TakeReference(field.Values->NewInstance());
  sorted->SetName(field.Values->GetName());
  sorted->SetNumberOfTuples(static_cast<vtkIdType>(nx * ny * nz));
  size_t to = 0;
  for (size_t k = 0; k < nz; ++k) {
    for (size_t j = 0; j < ny; ++j) {
      for (size_t i = 0; i < nx; ++i, ++to) {
        const size_t from =
          field.Index(this->Flipped[0] ? nx - 1 - i : i, this->Flipped[1] ? ny - 1 - j : j, this->Flipped[2] ? nz - 1 - k : k);
        sorted->SetTuple(static_cast<vtkIdType>(to), static_cast<vtkIdType>(from), field.Values);
      }
    }
  }
  return sorted;
}

double vtkStratusCFGrid::HeightByFormula(const std::vector<vtkStratusCFField>& terms, size_t x, size_t y, size_t z) const
{
  double t[5] = { 0, 0, 0, 0, 0 };
  for (size_t i = 0; i < terms.size(); ++i) {
    t[i] = terms[i].At(x, y, z);
  }
  if (this->Formula == 1) { // sigma, eta, depth
    return t[1] + t[0] * (t[2] + t[1]);
  }
  if (this->Formula == 4) { // a, b, orog
    return t[0] + t[1] * t[2];
  }
  const double s = t[0], stretching = t[1], eta = t[2], depth = t[3], critical = t[4];
  if (this->Formula == 2) {
    const double rest = critical * s + (depth - critical) * stretching;
    return rest + eta * (1.0 + rest / depth);
  }
  return eta + (eta + depth) * (critical * s + depth * stretching) / (critical + depth);
}

vtkSmartPointer<vtkDataArray> vtkStratusCFGrid::ReadPoints(size_t step) const
{
  std::array<vtkStratusCFField, 3> fields;
  std::vector<vtkStratusCFField> terms;
  for (size_t a = 0; a < 2 && this->Horizontal[0]; ++a) {
    fields[a] = this->ReadField(*this->Horizontal[a], step, "coordinate");
  }
  if (this->Height) {
    fields[2] = this->ReadField(*this->Height, step, "coordinate");
  }
  for (const Variable* term : this->Terms) {
    terms.push_back(this->ReadField(*term, step, "term of the height"));
  }
  const std::string units = this->Height ? this->File.Text(*this->Height, "units") : "";
  const size_t n[3] = { this->GetLength(0), this->GetLength(1), this->GetLength(2) };
  vtkSmartPointer<vtkDoubleArray> points = vtkSmartPointer<vtkDoubleArray>::New();
  points->SetNumberOfComponents(3);
  points->SetNumberOfTuples(static_cast<vtkIdType>(n[0] * n[1] * n[2]));
  double* to = points->GetPointer(0);
  for (size_t k = 0; k < n[2]; ++k) {
    for (size_t j = 0; j < n[1]; ++j) {
      for (size_t i = 0; i < n[0]; ++i, to += 3) {
        to[0] = fields[0].Values ? fields[0].At(i, j, k) * this->Factors[0] : this->Axes[0][i];
        to[1] = fields[1].Values ? fields[1].At(i, j, k) * this->Factors[1] : this->Axes[1][j];
        to[2] = this->Axes[2][k];
        if (this->Height) {
          const double z = fields[2].At(i, j, k);
          to[2] = this->Pressure ? HeightOfPressure(z, units) : z * this->Factors[2];
        } else if (this->Formula > 0) {
          to[2] = this->HeightByFormula(terms, i, j, k);
        }
      }
    }
  }
  return points;
}
