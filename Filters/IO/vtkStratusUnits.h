// SPDX-License-Identifier: BSD-3-Clause
// Units of coordinates, as UDUNITS reads them where the module is built with it. Private to the module.
#ifndef vtkStratusUnits_h
#define vtkStratusUnits_h

#include <string>

enum class vtkStratusQuantity { None, Length, Angle, Pressure, Temperature };

// The quantity of a unit, and the conversion of a value to m, degrees, Pa or K. A geopotential is a length: it is divided by standard
// gravity.
struct vtkStratusUnit {
  vtkStratusQuantity Quantity = vtkStratusQuantity::None;
  double Scale = 1.0, Offset = 0.0;
  double Convert(double value) const { return value * this->Scale + this->Offset; }
  bool IsLength() const { return this->Quantity == vtkStratusQuantity::Length; }
  bool IsAngle() const { return this->Quantity == vtkStratusQuantity::Angle; }
  bool IsPressure() const { return this->Quantity == vtkStratusQuantity::Pressure; }
};

constexpr double vtkStratusGravity = 9.80665; // m s-2

// Reads a unit. Text that is no unit of the quantities above, or none at all, gives Quantity None and the scale 1.
vtkStratusUnit vtkStratusUnitOf(const std::string& text);

// Returns the metres of a unit of length, 0 for other text.
double vtkStratusMetresOf(const std::string& text);

// Returns whether the unit is one of CF's for longitudes ("degrees_east", "degree_E", "degreesE" ...), or for latitudes, in any case.
bool vtkStratusIsEast(const std::string& units);
bool vtkStratusIsNorth(const std::string& units);

#endif
