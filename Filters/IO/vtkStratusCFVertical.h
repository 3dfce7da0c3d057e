// SPDX-License-Identifier: BSD-3-Clause
// Where the heights of a CF variable's points come from. Private to the module.
#ifndef vtkStratusCFVertical_h
#define vtkStratusCFVertical_h

#include "vtkStratusHeights.h"

#include <array>
#include <string>
#include <vector>

class vtkStratusCFGrid;

class vtkStratusCFVertical
{
public:
  using Variable = vtkStratusNetCDFModel::Variable;

  // grid: its dimensions are known
  // levels: the coordinate along its third dimension, or nullptr
  // others: the variables that the attribute coordinates names
  vtkStratusCFVertical(const vtkStratusCFGrid& grid, const Variable* levels, const std::vector<const Variable*>& others);

  // True if heights differ between columns. If false, Convert() gives a height from each level, or from its number if there are no levels.
  bool IsCurved() const { return this->Kind != Axis; }
  bool IsLength() const { return this->Kind == Formula || this->Kind == Wrf || this->Unit.IsLength() || this->Unit.IsPressure(); }
  bool IsWrf() const { return this->Kind == Wrf; }
  bool IsField() const { return this->Kind == Field; }
  bool IsSea() const { return this->Sea; }
  // True if heights are a depth's, below 0, in metres.
  bool IsDepth() const;
  const Variable* GetSource() const { return this->Source; } // levels or field, or nullptr
  const vtkStratusUnit& GetUnit() const { return this->Unit; }
  std::string Describe() const;
  double Convert(double value) const;
  // Writes the heights of all points, x fastest, `stride` apart. A point without a height gets NaN.
  void Read(size_t step, double* to, size_t stride) const;

private:
  enum KindType { Axis, Field, Formula, Wrf };

  bool FindField(const std::vector<const Variable*>& others);
  bool FindFormula();
  bool FindWrf();
  void FindAir();
  const Variable& Term(const std::map<std::string, std::string>& names, const char* name) const;
  double TermFactor(const Variable& variable, const vtkStratusFormula::Term& term) const;
  std::array<int, 3> WrfDimensions(const Variable& variable) const;
  void ReadField(size_t step, double* to, size_t stride) const;
  void ReadFormula(size_t step, double* to, size_t stride) const;
  void ReadColumns(size_t step, double* to, size_t stride) const;
  void ReadWrf(size_t step, double* to, size_t stride) const;

  const vtkStratusCFGrid& Grid;
  const vtkStratusNetCDFModel& File;
  KindType Kind = Axis;
  const Variable* Source = nullptr; // levels or field
  std::string Units;                // of the source, as the file has them
  vtkStratusUnit Unit;
  bool Down = false;
  bool Sea = false; // pressure is of sea water
  const vtkStratusFormula* Of = nullptr;
  std::vector<const Variable*> Terms;
  std::vector<double> Factors; // of the terms
  int SurfaceTerm = -1;        // the surface pressure's number among the terms
  const Variable* Temperature = nullptr;
  const Variable* Ground = nullptr; // height of the surface
  vtkStratusUnit GroundUnit;
};

#endif
