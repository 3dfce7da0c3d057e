// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusCFVertical.h"
#include "vtkStratusText.h"

#include "vtkStratusCFGrid.h"

#include <algorithm>
#include <cmath>

namespace {
constexpr double WrfGravity = 9.81; // m s-2, WRF's own

bool IsOneOf(const std::string& word, std::initializer_list<const char*> words)
{
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool EndsWith(const std::string& text, const std::string& end)
{
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}
} // namespace

vtkStratusCFVertical::vtkStratusCFVertical(const vtkStratusCFGrid& grid, const Variable* levels, const std::vector<const Variable*>& others)
    : Grid(grid), File(grid.GetFile()), Source(levels)
{
  if (!this->FindField(others) && !this->FindFormula()) {
    this->FindWrf();
  }
  if (this->Source && this->Kind != Wrf) {
    this->Units = this->File.Text(*this->Source, "units");
    this->Unit = vtkStratusUnitOf(this->Units);
    this->Sea = this->Unit.IsPressure() &&
      (this->Unit.Scale == 10000.0 || this->File.Text(*this->Source, "standard_name").compare(0, 18, "sea_water_pressure") == 0);
    this->Down = vtkStratusIsDown(this->File, *this->Source);
  }
}

// A coordinate of three dimensions.
bool vtkStratusCFVertical::FindField(const std::vector<const Variable*>& others)
{
  for (const Variable* one : others) {
    if (this->Grid.Has(*one, 0) && this->Grid.Has(*one, 1) && this->Grid.Has(*one, 2) && this->Grid.AxisOf(*one) != 0 &&
      this->Grid.AxisOf(*one) != 1) {
      this->Source = one;
      this->Kind = Field;
      return true;
    }
  }
  return false;
}

bool vtkStratusCFVertical::FindFormula()
{
  const std::string text = this->Source ? this->File.Text(*this->Source, "formula_terms") : "";
  const std::map<std::string, std::string> names = vtkStratusFormula::ReadTerms(text);
  this->Of = text.empty() ? nullptr : vtkStratusFormula::Find(this->File.Text(*this->Source, "standard_name"), names);
  if (!this->Of) {
    return false;
  }
  this->Kind = Formula;
  for (const vtkStratusFormula::Term& term : this->Of->Terms) {
    if (term.Name) {
      const Variable& variable = this->Term(names, term.Name);
      this->SurfaceTerm = std::string(term.Name) == "ps" ? static_cast<int>(this->Terms.size()) : this->SurfaceTerm;
      this->Terms.push_back(&variable);
      this->Factors.push_back(this->TermFactor(variable, term));
    }
  }
  if (this->Of->IsPressure && this->SurfaceTerm >= 0) {
    this->FindAir();
  }
  return true;
}

const vtkStratusCFVertical::Variable& vtkStratusCFVertical::Term(const std::map<std::string, std::string>& names, const char* name) const
{
  const auto named = names.find(name);
  if (named == names.end()) {
    this->File.Fail("formula_terms '" + this->File.Text(*this->Source, "formula_terms") + "' have no '" + name + "'");
  }
  const Variable* found = this->File.Find(named->second, this->Source);
  if (!found || !this->Grid.Fits(*found)) {
    this->File.Fail(
      "formula_terms name '" + named->second + "' for '" + name + "', which " + (found ? "has another grid" : "is not there"));
  }
  return *found;
}

// Terms without units are in m, Pa or 1, as the formulas have them.
double vtkStratusCFVertical::TermFactor(const Variable& variable, const vtkStratusFormula::Term& term) const
{
  const std::string units = this->File.Text(variable, "units");
  const vtkStratusUnit unit = vtkStratusUnitOf(units);
  if (term.Quantity == vtkStratusQuantity::None || units.empty()) {
    return 1.0;
  }
  if (unit.Quantity != term.Quantity) {
    this->File.Fail(std::string("term '") + term.Name + "' of the formula, '" + variable.Name + "', has the unit '" + units +
      "', it must be one of " + (term.Quantity == vtkStratusQuantity::Length ? "length" : "pressure"));
  }
  return unit.Scale;
}

// The temperature on the same levels, and the height of the ground under them.
void vtkStratusCFVertical::FindAir()
{
  for (const Variable& one : this->File.GetVariables()) {
    const std::string standard = this->File.Text(one, "standard_name"), name = vtkStratusLowerCase(vtkStratusTrimmed(one.BaseName()));
    const vtkStratusUnit unit = vtkStratusUnitOf(this->File.Text(one, "units"));
    const bool fits = this->Grid.Fits(one), horizontal = fits && this->Grid.Has(one, 0) && this->Grid.Has(one, 1);
    const bool temperature = standard == "air_temperature" || (standard.empty() && IsOneOf(name, { "t", "ta", "temp", "temperature" }));
    if (horizontal && this->Grid.Has(one, 2) && temperature && unit.Quantity == vtkStratusQuantity::Temperature) {
      this->Temperature = &one;
    }
    const bool ground = IsOneOf(standard, { "surface_altitude", "surface_geopotential" }) ||
      (standard.empty() && IsOneOf(name, { "orog", "hgt", "phis", "zs" }));
    if (horizontal && !this->Grid.Has(one, 2) && ground && unit.IsLength()) {
      this->Ground = &one;
      this->GroundUnit = unit;
    }
  }
}

bool vtkStratusCFVertical::FindWrf()
{
  const std::string& name = this->File.NameOf(this->Grid.GetDimension(2));
  const Variable *perturbation = this->File.Find("PH", &this->Grid.GetVariable()),
                 *base = this->File.Find("PHB", &this->Grid.GetVariable());
  if (!IsOneOf(name, { "bottom_top", "bottom_top_stag" }) || !perturbation || !base) {
    return false;
  }
  this->Kind = Wrf;
  this->Terms = { perturbation, base };
  return true;
}

bool vtkStratusCFVertical::IsDepth() const
{
  const bool in_sea = this->Kind == Formula && std::string(this->Of->Name).compare(0, 6, "ocean_") == 0;
  return in_sea || ((this->Kind == Axis || this->Kind == Field) && this->Source && this->Down && this->Unit.IsLength());
}

std::string vtkStratusCFVertical::Describe() const
{
  if (this->Kind == Wrf) {
    return "z by 'PH' and 'PHB' of WRF, geopotential by 9.81 m s-2";
  }
  std::string text =
    "z by " + (this->Source ? "'" + this->Source->Name + "'" + (this->Units.empty() ? "" : " (" + this->Units + ")") : "number");
  text += this->Kind == Formula ? std::string(", by the formula of ") + this->Of->Name : "";
  if (this->Sea) {
    return text + ", pressure as depth of sea water of 1025 kg m-3";
  }
  if (this->Temperature) {
    return text + ", pressure as height by the hypsometric equation with '" + this->Temperature->Name + "' over " +
      (this->Ground ? "'" + this->Ground->Name + "'" : "the surface pressure's height in the standard atmosphere");
  }
  const bool pressure = this->Kind == Formula ? this->Of->IsPressure : this->Unit.IsPressure();
  return text + (pressure ? ", pressure as height in the standard atmosphere" : this->Down && this->Kind != Formula ? ", downwards" : "");
}

double vtkStratusCFVertical::Convert(double value) const
{
  const double z = this->Unit.Convert(value);
  if (this->Sea) {
    return vtkStratusHeightInSea(z);
  }
  if (!this->Unit.IsPressure()) {
    return this->Down ? -z : z;
  }
  if (z < 0.0) {
    this->File.Fail("coordinate '" + this->Source->Name + "' has a pressure of " + vtkStratusNumberText(value) + " " + this->Units +
      ", it must not be negative");
  }
  return vtkStratusHeightOfPressure(z);
}

void vtkStratusCFVertical::Read(size_t step, double* to, size_t stride) const
{
  switch (this->Kind) {
    case Axis:
      return;
    case Field:
      return this->ReadField(step, to, stride);
    case Formula:
      return this->ReadFormula(step, to, stride);
    case Wrf:
      return this->ReadWrf(step, to, stride);
  }
}

void vtkStratusCFVertical::ReadField(size_t step, double* to, size_t stride) const
{
  const vtkStratusCFField field = this->Grid.ReadField(*this->Source, step);
  for (size_t k = 0; k < this->Grid.GetLength(2); ++k) {
    for (size_t j = 0; j < this->Grid.GetLength(1); ++j) {
      for (size_t i = 0; i < this->Grid.GetLength(0); ++i, to += stride) {
        const double value = field.At(i, j, k);
        *to = std::isnan(value) ? NAN : this->Convert(value);
      }
    }
  }
}

void vtkStratusCFVertical::ReadFormula(size_t step, double* to, size_t stride) const
{
  std::vector<vtkStratusCFField> fields;
  for (const Variable* term : this->Terms) {
    fields.push_back(this->Grid.ReadField(*term, step));
  }
  const bool turned = std::string(this->Of->Name) == "ocean_double_sigma_coordinate" && this->Down; // its result counts as the levels do
  double* z = to;
  for (size_t k = 0; k < this->Grid.GetLength(2); ++k) {
    for (size_t j = 0; j < this->Grid.GetLength(1); ++j) {
      for (size_t i = 0; i < this->Grid.GetLength(0); ++i, z += stride) {
        double terms[vtkStratusFormula::MostTerms];
        std::fill(std::begin(terms), std::end(terms), NAN);
        bool missing = false;
        for (size_t t = 0; t < fields.size(); ++t) {
          terms[t] = fields[t].At(i, j, k) * this->Factors[t];
          missing = missing || (std::isnan(terms[t]) && !this->Of->Terms[t].Partial);
          if (std::isinf(terms[t]) || (std::isnan(terms[t]) && !this->Of->Terms[t].Partial && this->Terms[t]->Dimensions.size() < 2)) {
            this->File.Fail("term of the height '" + this->Terms[t]->Name + "' has no value (a fill value, or not finite) at level " +
              std::to_string(k) + ", all must be finite");
          }
        }
        *z = missing ? NAN : this->Of->Compute(terms, static_cast<double>(k + 1));
        if (!missing && (!std::isfinite(*z) || (this->Of->IsPressure && *z < 0.0))) {
          this->File.Fail(std::string("the formula of ") + this->Of->Name + " gives " + vtkStratusNumberText(*z) + " at level " +
            std::to_string(k) + ", it must be finite" + (this->Of->IsPressure ? ", and a pressure must not be negative" : ""));
        }
        *z = turned ? -*z : *z;
        if (this->Of->IsPressure && !this->Temperature) {
          *z = vtkStratusHeightOfPressure(*z);
        }
      }
    }
  }
  if (this->Temperature) {
    this->ReadColumns(step, to, stride);
  }
}

// Replaces pressures by heights, layer on layer from the ground up. If there is no temperature, the standard atmosphere's is used.
void vtkStratusCFVertical::ReadColumns(size_t step, double* to, size_t stride) const
{
  const vtkStratusUnit unit = vtkStratusUnitOf(this->File.Text(*this->Temperature, "units"));
  const vtkStratusCFField air = this->Grid.ReadField(*this->Temperature, step),
                          surface = this->Grid.ReadField(*this->Terms[static_cast<size_t>(this->SurfaceTerm)], step),
                          ground = this->Ground ? this->Grid.ReadField(*this->Ground, step) : vtkStratusCFField();
  const size_t nx = this->Grid.GetLength(0), ny = this->Grid.GetLength(1), nz = this->Grid.GetLength(2), layer = nx * ny * stride;
  for (size_t j = 0; j < ny; ++j) {
    for (size_t i = 0; i < nx; ++i) {
      double* const column = to + (i + nx * j) * stride;
      const bool up = column[0] > column[(nz - 1) * layer];
      double below = surface.At(i, j, 0) * this->Factors[static_cast<size_t>(this->SurfaceTerm)], last = NAN;
      const double given = this->Ground ? this->GroundUnit.Convert(ground.At(i, j, 0)) : NAN;
      double z = std::isnan(given) ? vtkStratusHeightOfPressure(below) : given;
      for (size_t n = 0; n < nz; ++n) {
        const size_t k = up ? n : nz - 1 - n;
        const double pressure = column[k * layer], here = unit.Convert(air.At(i, j, k));
        if (pressure == 0.0) {
          this->File.Fail("the formula of " + std::string(this->Of->Name) + " gives the pressure 0 at level " + std::to_string(k) +
            ", which has no height by the hypsometric equation");
        }
        const double temperature = std::isnan(here) ? vtkStratusTemperatureOfPressure(pressure) : here;
        z += vtkStratusThickness(std::isnan(last) ? temperature : 0.5 * (last + temperature), below, pressure);
        column[k * layer] = z;
        below = pressure;
        last = temperature;
      }
    }
  }
}

// The dimensions of a geopotential for this grid's axes: they are the grid's own, or staggered against them.
std::array<int, 3> vtkStratusCFVertical::WrfDimensions(const Variable& variable) const
{
  std::array<int, 3> result;
  for (size_t a = 0; a < 3; ++a) {
    const int own = this->Grid.GetDimension(static_cast<int>(a));
    const std::string& name = this->File.NameOf(own);
    const bool staggered = EndsWith(name, "_stag");
    const int other = this->File.FindDimension(staggered ? name.substr(0, name.size() - 5) : name + "_stag");
    const auto has = [&variable](int one) {
      return std::find(variable.Dimensions.begin(), variable.Dimensions.end(), one) != variable.Dimensions.end();
    };
    result[a] = has(own) ? own : other;
    const size_t length = this->File.LengthOf(own);
    if (!has(own) && (other < 0 || !has(other) || this->File.LengthOf(other) != (staggered ? length - 1 : length + 1))) {
      this->File.Fail("'" + variable.Name + "' has no dimension for '" + name + "', on which heights are needed");
    }
  }
  return result;
}

void vtkStratusCFVertical::ReadWrf(size_t step, double* to, size_t stride) const
{
  std::array<vtkStratusCFField, 2> fields;
  std::array<std::array<int, 3>, 2> dimensions;
  for (size_t f = 0; f < 2; ++f) {
    dimensions[f] = this->WrfDimensions(*this->Terms[f]);
    fields[f] = this->Grid.ReadField(*this->Terms[f], step, &dimensions[f]);
  }
  const size_t n[3] = { this->Grid.GetLength(0), this->Grid.GetLength(1), this->Grid.GetLength(2) };
  // The two places of a field between which one of the grid's is.
  const auto places = [&](size_t f, size_t axis, size_t at, size_t(&around)[2]) {
    const size_t length = this->File.LengthOf(dimensions[f][axis]);
    around[0] = length < n[axis] && at > 0 ? at - 1 : at;
    around[1] = length > n[axis] ? at + 1 : std::min(at, length - 1);
    around[0] = std::min(around[0], length - 1);
  };
  for (size_t k = 0; k < n[2]; ++k) {
    for (size_t j = 0; j < n[1]; ++j) {
      for (size_t i = 0; i < n[0]; ++i, to += stride) {
        double sum = 0.0;
        for (size_t f = 0; f < 2; ++f) {
          size_t x[2], y[2], z[2];
          places(f, 0, i, x);
          places(f, 1, j, y);
          places(f, 2, k, z);
          for (int corner = 0; corner < 8; ++corner) {
            sum += fields[f].At(x[corner & 1], y[corner >> 1 & 1], z[corner >> 2]);
          }
        }
        *to = sum / (8.0 * WrfGravity);
      }
    }
  }
}
