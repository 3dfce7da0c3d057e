// SPDX-License-Identifier: BSD-3-Clause
// The grid of a CF variable: which of its dimensions is which axis, and where its points lie. Private to the module.
#ifndef vtkStratusCFGrid_h
#define vtkStratusCFGrid_h

#include "vtkStratusNetCDFFile.h"

#include <array>
#include <string>
#include <vector>

// Values over some of the axes x, y, z, all others being fixed. An axis that they do not depend on has the stride 0.
struct vtkStratusCFField {
  vtkSmartPointer<vtkDataArray> Values;
  std::array<size_t, 3> Strides = { { 0, 0, 0 } };
  size_t Index(size_t x, size_t y, size_t z) const { return x * this->Strides[0] + y * this->Strides[1] + z * this->Strides[2]; }
  double At(size_t x, size_t y, size_t z) const { return this->Values->GetComponent(static_cast<vtkIdType>(this->Index(x, y, z)), 0); }
};

class vtkStratusCFGrid
{
public:
  using Variable = vtkStratusNetCDFFile::Variable;

  // Returns whether the variable has three dimensions in space, longer than 1, and numbers.
  static bool IsVolume(const vtkStratusNetCDFFile& file, const Variable& variable);

  vtkStratusCFGrid(const vtkStratusNetCDFFile& file, const Variable& variable); // throws vtkStratusReadError

  bool IsCurved() const { return this->Horizontal[0] || this->Height || this->Formula > 0; }
  bool IsUniform() const;
  std::string Describe() const { return this->Description; }
  bool IsInMetres() const { return this->Metres; }
  const Variable* GetTime() const { return this->Time; }
  size_t GetLength(int axis) const { return this->Axes[axis].size(); }
  const std::vector<double>& GetAxis(int axis) const { return this->Axes[axis]; } // ascending
  // Values of the variable with x fastest, along ascending axes.
  vtkSmartPointer<vtkDataArray> ReadValues(size_t step) const;
  // Points of a curved grid, x fastest, in doubles.
  vtkSmartPointer<vtkDataArray> ReadPoints(size_t step) const;

private:
  struct Source {
    const Variable* Coordinate = nullptr; // of one dimension
    std::string Units;
  };
  void FindDimensions();
  void SortDimensions(std::vector<int> space);
  void FindCoordinates();
  void FindHeight(const std::vector<const Variable*>& others);
  int AxisOf(const Variable& coordinate) const;
  int AxisOfDimension(int dimension) const;
  void ReadAxis(int axis);
  void ConvertUnits();
  void ConvertAxis(int axis, double factor);
  bool Fits(const Variable& variable) const;
  vtkStratusCFField ReadField(const Variable& variable, size_t step, const char* complete) const;
  const Variable& Term(const std::string& terms, const std::string& name) const;
  double HeightByFormula(const std::vector<vtkStratusCFField>& terms, size_t x, size_t y, size_t z) const;

  const vtkStratusNetCDFFile& File;
  const Variable& Of;
  std::array<int, 3> Dimensions = { { -1, -1, -1 } }; // of x, y, z
  int TimeDimension = -1;
  const Variable* Time = nullptr;
  std::array<Source, 3> Sources;
  std::array<std::vector<double>, 3> Axes;
  std::array<bool, 3> Flipped = { { false, false, false } };
  std::array<const Variable*, 2> Horizontal = { { nullptr, nullptr } }; // of two dimensions
  const Variable* Height = nullptr;                                     // of three
  int Formula = 0;                                                      // number of a row in the table of formulas, from 1
  std::vector<const Variable*> Terms;
  std::array<double, 3> Factors = { { 1.0, 1.0, 1.0 } }; // of coordinates, to metres
  bool Pressure = false;
  bool Metres = true;
  std::string Description;
};

#endif
