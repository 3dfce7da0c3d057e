// SPDX-License-Identifier: BSD-3-Clause
// The grid of a CF variable: which of its dimensions is which axis, and where its points lie. Private to the module.
#ifndef vtkStratusCFGrid_h
#define vtkStratusCFGrid_h

#include "vtkStratusCFVertical.h"
#include "vtkStratusNetCDFLayout.h"
#include "vtkStratusNetCDFModel.h"
#include "vtkStratusParts.h"
#include "vtkStratusProjection.h"
#include "vtkStratusUnits.h"
#include "vtkStratusVariableReader.h"

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

class vtkDoubleArray;

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
  using Variable = vtkStratusNetCDFModel::Variable;

  // Returns whether the variable has three dimensions in space, longer than 1, and numbers.
  static bool IsVolume(const vtkStratusNetCDFModel& file, const Variable& variable);

  // on_earth: horizontal coordinates are longitudes and latitudes of the Earth, whatever plane the file's own are on: two-dimensional ones
  // of the file, or those that its projection gives. A file that has neither is an error.
  vtkStratusCFGrid(const vtkStratusNetCDFModel& file, const Variable& variable, bool on_earth = false); // throws vtkStratusReadError

  bool IsCurved() const { return this->Horizontal[0] || !this->Places[0].empty() || this->Vertical->IsCurved(); }
  bool IsUniform() const;
  std::string Describe() const { return this->Description; }
  bool IsInDegrees() const { return this->Degrees; } // longitudes and latitudes of the Earth, which became metres
  // Finds x and y of a longitude and latitude in degrees on a grid that is on the plane of a projection. Returns false where it has no
  // place.
  using Place = std::function<bool(const double degrees[2], double at[2])>;
  // The function of a grid whose x and y are projection coordinates, empty for another. Throws vtkStratusReadError as vtkStratusProjection.
  Place GetPlaceOnPlane() const;
  // Longitude and latitude of the columns and rows, x fastest, in degrees: of one level, or of all levels where they differ between levels.
  std::vector<double> ReadDegrees(size_t step) const;
  bool IsInMetres() const { return this->Metres; }
  // The name of an axis of the points' coordinates and their unit, "" if it has none.
  const std::string& GetAxisName(int axis) const { return this->Names[static_cast<size_t>(axis)]; }
  const std::string& GetAxisUnits(int axis) const { return this->Units[static_cast<size_t>(axis)]; }
  // The file's own numbers along an axis, for labels.
  const vtkStratusFileAxis& GetFileAxis(int axis) const { return this->FileAxes[static_cast<size_t>(axis)]; }
  bool IsSheet() const { return this->Flat && !this->Metres; } // x and y are in metres, and z is not
  int GetTime() const { return this->Layout.GetTime(); }       // a dimension, or -1
  const Variable& GetVariable() const { return this->Of; }
  const vtkStratusNetCDFModel& GetFile() const { return this->File; }
  int GetDimension(int axis) const { return this->Dimensions[static_cast<size_t>(axis)]; }
  size_t GetLength(int axis) const { return this->File.LengthOf(this->GetDimension(axis)); }
  const std::vector<double>& GetAxis(int axis) const { return this->Axes[axis]; } // ascending
  // Returns 0, 1, 2 for a coordinate along x, y, z, and -1 if its attributes name no axis.
  int AxisOf(const Variable& coordinate) const;
  // Fits: true if the variable depends only on time, the three axes and dimensions that are read at one index. Has: true if it depends on
  // the axis.
  bool Fits(const Variable& variable) const;
  bool Has(const Variable& variable, int axis) const;
  // Reads a variable that fits. One on other dimensions than the grid's own needs those.
  vtkStratusCFField ReadField(const Variable& variable, size_t step, const std::array<int, 3>* dimensions = nullptr) const;
  // Values of the variable with x fastest, along ascending axes.
  vtkSmartPointer<vtkDataArray> ReadValues(size_t step) const;
  // The same values in a box as bricks of the file, which are read when something looks at them; null where they can't be.
  vtkSmartPointer<vtkDataArray> MakeBricks(size_t step, const vtkStratusBox& box) const;
  // Points of a curved grid, x fastest, in doubles.
  // hidden_points: 1 for points that have no place, hidden_cells: 1 for cells that longitudes around a pole tear apart; empty: none
  vtkSmartPointer<vtkDataArray> ReadPoints(size_t step, std::vector<char>& hidden_points, std::vector<char>& hidden_cells) const;

  // Whether coordinates that were read so far differ between time steps.
  bool Moves() const { return this->ReadsTime; }

private:
  mutable bool ReadsTime = false;
  void CheckSize() const;
  void FindCoordinates();
  void FindHorizontal(const std::vector<const Variable*>& others);
  bool FindWrfSpacing(const Variable& x, const Variable& y);
  int AxisOfDimension(int dimension) const;
  vtkStratusUnit UnitOf(const Variable& coordinate) const;
  bool IsOfEarth(const Variable& coordinate) const;
  bool IsOfPlane(const Variable& coordinate) const;
  std::shared_ptr<vtkStratusProjection> MakeProjection() const;
  void FindPlaces();
  void ReadAxis(int axis);
  void ConvertUnits();
  void NameAxes(const std::array<const Variable*, 2>& from, const std::array<vtkStratusUnit, 2>& units, bool degrees);
  void ConvertAxis(int axis);
  std::string TitleOr(const Variable* coordinate, const std::string& usual) const;
  void DescribeHorizontal(const std::array<const Variable*, 2>& from, bool degrees);
  void DescribeVertical();
  double MiddleLatitude() const;
  std::vector<double> ReadHorizontal(int axis, size_t step, std::array<size_t, 3>& strides) const;
  void HideTorn(const std::vector<double>& longitudes, const std::array<size_t, 3>& strides, std::vector<char>& hidden) const;
  void HideMissing(vtkDoubleArray* points, std::vector<char>& hidden) const;

  const vtkStratusNetCDFModel& File;
  const Variable& Of;
  const bool OnEarth;
  const Variable* Mapping; // of the file's plane, nullptr: none
  vtkStratusNetCDFLayout Layout;
  std::array<int, 3> Dimensions;                                            // of x, y, z
  std::array<const Variable*, 3> Along = { { nullptr, nullptr, nullptr } }; // coordinates of one dimension
  std::array<std::vector<double>, 3> Axes;
  std::array<bool, 3> Flipped = { { false, false, false } };
  std::array<const Variable*, 2> Horizontal = { { nullptr, nullptr } }; // of two dimensions or more
  std::array<std::vector<double>, 2> Places; // longitudes and latitudes by the projection, x fastest; empty: not used
  std::unique_ptr<vtkStratusCFVertical> Vertical;
  std::array<double, 2> Spacing = { { 0.0, 0.0 } }; // of points without coordinates, in metres; 0: unknown
  std::array<double, 2> Factors = { { 1.0, 1.0 } }; // of x and y in m or degrees, to metres
  bool Continuous = false;                          // longitudes were made so
  bool Degrees = false;
  bool Metres = true, Flat = false; // all axes are in metres; x and y are
  std::string Description;
  std::array<std::string, 3> Names, Units; // of the points' coordinates
  std::array<vtkStratusFileAxis, 3> FileAxes;
};

#endif
