// SPDX-License-Identifier: BSD-3-Clause
// A ray through a data set's field, and where its opacity first reaches a bound. Private to the module.
#ifndef vtkStratusPickRay_h
#define vtkStratusPickRay_h

#include "vtkStratusPrivate.h"

#include "vtkType.h"

#include <functional>
#include <vector>

class vtkDataArray;
class vtkDataSet;
class vtkPiecewiseFunction;
class vtkStructuredGrid;
struct vtkStratusTetrahedra;

// A search along the line p1 + t (p2 - p1), t within begin..end, in the data set's coordinates.
struct VTK_STRATUS_PRIVATE vtkStratusPickRay {
  double P1[3], P2[3], Begin, End;
  vtkPiecewiseFunction* Opacity;
  double Bound;
  std::function<double(vtkIdType tuple)> Value; // of a point or a cell
  bool OfCells, Nearest;
  // Crop planes across the axes, as VTK's mappers have them, and the bits of the regions that show. Of meshes, the box shows.
  const double* CropPlanes = nullptr;
  int CropRegions = 0;

  // The largest opacity of values within a..b in any order.
  double GetMost(double a, double b) const;
  // Where the opacity first reaches the bound between two places, over which the value rises or falls all along; false: nowhere.
  bool FindInPiece(double from, double to, const std::function<double(double t)>& value, double& t) const;
};

struct VTK_STRATUS_PRIVATE vtkStratusPickHit {
  double T = VTK_DOUBLE_MAX;
  vtkIdType Cell = -1, Point = -1;
  int CellIJK[3] = { 0, 0, 0 }, PointIJK[3] = { 0, 0, 0 };
  double PCoords[3] = { 0, 0, 0 };
  double Gradient[3] = { 0, 0, 0 }; // zero where the field has none
};

// Each sets the hit where there is one nearer than it has, and returns whether it did.
VTK_STRATUS_PRIVATE bool vtkStratusPickLattice(const vtkStratusPickRay& ray, vtkDataSet* imageOrRectilinear, vtkStratusPickHit& hit);
VTK_STRATUS_PRIVATE bool vtkStratusPickStructured(const vtkStratusPickRay& ray, vtkStructuredGrid* grid, vtkStratusPickHit& hit);
VTK_STRATUS_PRIVATE bool vtkStratusPickTetrahedra(
  const vtkStratusPickRay& ray, vtkDataSet* grid, const vtkStratusTetrahedra& parts, vtkDataArray* pointValues, vtkStratusPickHit& hit);

#endif
