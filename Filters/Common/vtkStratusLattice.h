// SPDX-License-Identifier: BSD-3-Clause
// A structured grid as the core's lattice of hexahedra: its points are borrowed, its cells need no list. Private to the modules, never
// installed.
#ifndef vtkStratusLattice_h
#define vtkStratusLattice_h

#include "stratus.h"

#include "vtkStratusPrivate.h"

#include "vtkPoints.h"
#include "vtkSmartPointer.h"
#include "vtkTimeStamp.h"

#include <cstdint>
#include <array>
#include <string>
#include <vector>

class vtkStructuredGrid;
class vtkUnsignedCharArray;

class VTK_STRATUS_PRIVATE vtkStratusLattice
{
public:
  // Reads points, extent, and the arrays of ghosts and blanking. Returns false, with the reason in `error`, for a grid without a volume,
  // and where an array has another length than the extent says.
  bool Set(vtkStructuredGrid* grid, std::string& error);
  // A mesh without values and flags. The grid must live as long as the mesh.
  stratus_mesh GetMesh() const;
  // One flag per hexahedron; none where none is hidden.
  const std::vector<uint8_t>& GetHidden() const { return this->Hidden; }
  // Of the finite points of cells that are not hidden; without such points a box of no size at 0.
  const double* GetBounds() const { return this->Bounds; }

private:
  bool SetPoints(vtkStructuredGrid* grid, std::string& error);
  void Hide(vtkUnsignedCharArray* points, vtkUnsignedCharArray* cells);
  void FindBounds();

  // The objects that Hidden and Bounds were found from, and when these were changed last.
  struct Origin {
    vtkSmartPointer<vtkObject> Points, PointGhosts, CellGhosts;
    std::array<vtkMTimeType, 3> Times;
    std::array<int, 3> Extent;
  };
  bool IsFrom(const Origin& origin) const;

  Origin From;
  vtkTimeStamp Geometry; // when that was
  int Points[3] = { 0, 0, 0 };
  const double* Doubles = nullptr;
  const float* Floats = nullptr;
  vtkSmartPointer<vtkDataArray> Kept; // the array that the points are read from: the grid's, or a copy as doubles
  std::vector<uint8_t> Hidden;
  double Bounds[6] = { 0, 0, 0, 0, 0, 0 };
};

#endif
