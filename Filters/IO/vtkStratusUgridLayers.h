// SPDX-License-Identifier: BSD-3-Clause
// The heights of a layered mesh: which variables they follow from, and the borders of layers at each node. Private to the module.
#ifndef vtkStratusUgridLayers_h
#define vtkStratusUgridLayers_h

#include "vtkStratusUgridMesh.h"
#include "vtkStratusUnits.h"

#include <string>
#include <vector>

class vtkStratusUgridLayers
{
public:
  using Variable = vtkStratusNetCDFModel::Variable;

  explicit vtkStratusUgridLayers(const vtkStratusUgridMesh& mesh); // throws vtkStratusReadError

  size_t GetCount() const { return this->Count; }
  std::array<int, 2> GetDimensions() const { return { { this->LayerDimension, this->BorderDimension } }; } // -1: unknown
  // Which of the borders or layers of a variable is this one, since files count from the top or from the bottom.
  size_t FromBottom(size_t number, size_t of) const { return this->TopFirst ? of - 1 - number : number; }
  // Returns whether a variable has values for each layer, or for each border; neither: it has no layers, or others.
  bool IsOnLayers(const Variable& variable) const;
  bool IsOnBorders(const Variable& variable) const;
  int GetTime() const { return this->Time; } // a dimension, or -1
  // True if heights are a depth's, below 0.
  bool IsDepth() const
  {
    return this->Kind == Sigma || this->Kind == Thicknesses || (this->Kind == Levels && this->Down && this->Unit.IsLength());
  }
  // True if heights are numbers of layers, because the file has no others.
  bool IsNumbers() const { return this->Numbers; }
  std::string Describe() const;
  bool Uses(const Variable& variable) const; // as a height

  // Finds the borders' heights, z[border * nodes + node], ascending, the nodes that have none, and the faces that are dry at this step.
  void Read(size_t step, std::vector<double>& z, std::vector<uint8_t>& none, std::vector<uint8_t>& dry) const;

private:
  enum KindType { Flat, Heights, Thicknesses, Sigma, Levels };

  // In vtkStratusUgridHeights.cxx:
  void FindHeights();
  bool FindThicknesses();
  void ReadHeights(size_t step, std::vector<double>& z, std::vector<uint8_t>& none) const;
  void ReadThicknesses(size_t step, std::vector<double>& z, std::vector<uint8_t>& none) const;

  void FindOrder();
  double ToHeight(double level) const;
  bool FindTerm(const char* term, const Variable*& found) const;
  void FindSurfaces();
  bool FindSigma();
  bool IsLevels(const Variable& one) const;
  bool FindLevels();
  void ReadBounds(const std::string& name);
  std::vector<double> ReadLength(const Variable& variable, size_t step) const;
  void TakeCount(const Variable& variable, int dimension, bool borders);
  std::vector<double> Bottom(size_t step, const std::vector<double>& surface) const;
  std::vector<double> BordersOf(const vtkStratusUgridValues& levels, size_t node) const;
  void ReadLevels(size_t step, std::vector<double>& z, std::vector<uint8_t>& none) const;
  void FindDry(size_t step, std::vector<uint8_t>& dry) const;

  const vtkStratusUgridMesh& Mesh;
  const vtkStratusNetCDFModel& File;
  KindType Kind = Flat;
  size_t Count = 1;
  int LayerDimension = -1, BorderDimension = -1;
  bool TopFirst = false;
  bool OfBorders = false;           // Levels are at borders
  const Variable* Source = nullptr; // heights, thicknesses, sigma or levels
  const Variable* Lowest = nullptr; // of thicknesses: the number of a node's lowest layer, nullptr: all have thickness
  vtkStratusUnit Unit;              // of heights or levels
  bool Down = false;                // levels count downwards
  bool Numbers = false;
  bool Stretched = false;    // the lowest layer reaches to the bottom
  std::vector<double> Fixed; // borders by bounds, from the bottom up; empty: there are no bounds
  const Variable* Surface = nullptr;
  const Variable* Bed = nullptr;
  enum BedType { Altitude, Depth, WaterDepth } BedMeans = Depth;
  const Variable* Wet = nullptr;
  bool WetIsOne = true;
  int Time = -1;
};

#endif
