// SPDX-License-Identifier: BSD-3-Clause
// The meaning of vertical coordinates: which way they count, pressure as height, and the formulas of appendix D of the CF conventions.
// Private to the module.
#ifndef vtkStratusHeights_h
#define vtkStratusHeights_h

#include "vtkStratusNetCDFModel.h"
#include "vtkStratusUnits.h"

#include <map>
#include <string>

// Returns whether a vertical coordinate counts downwards: by its attribute positive, else by its standard_name (depth), else by a name that
// begins with "depth" over values that are not negative. Another value of positive than up and down, in any case, is an error.
bool vtkStratusIsDown(const vtkStratusNetCDFModel& file, const vtkStratusNetCDFModel::Variable& variable);

// The height in metres of a pressure in Pa, which must not be negative, in the standard atmosphere, and the temperature there in K.
double vtkStratusHeightOfPressure(double pressure);
double vtkStratusTemperatureOfPressure(double pressure);
// The thickness in metres of a layer of dry air between two pressures, of the mean temperature in K: the hypsometric equation.
double vtkStratusThickness(double temperature, double below, double above);
// The height in metres, negative, of a pressure in Pa under the surface of the sea.
double vtkStratusHeightInSea(double pressure);

// A formula that yields heights in metres, or pressures in Pa, from terms that are other variables.
struct vtkStratusFormula {
  struct Term {
    const char* Name;
    vtkStratusQuantity Quantity; // None: a number
    bool Partial = false;        // values may be missing
  };
  static constexpr int MostTerms = 7;
  const char* Name;
  Term Terms[MostTerms];
  bool IsPressure;
  // terms: values in the order of Terms, in m and Pa
  // level: number of the level in the file, from 1
  // Returns NaN where the terms contradict themselves.
  double (*Compute)(const double* terms, double level);

  // Returns the formula of a standard_name, nullptr for a name that has none. Of two forms, the one whose terms are all named.
  static const vtkStratusFormula* Find(const std::string& standard_name, const std::map<std::string, std::string>& terms);
  // Reads an attribute formula_terms: names of variables by names of terms.
  static std::map<std::string, std::string> ReadTerms(const std::string& text);
};

#endif
