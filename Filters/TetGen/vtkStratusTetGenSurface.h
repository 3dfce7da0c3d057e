// SPDX-License-Identifier: BSD-3-Clause
// Converts a vtkPolyData to a request to TetGen, and TetGen's answer to a mesh. Private to the module.
#ifndef vtkStratusTetGenSurface_h
#define vtkStratusTetGenSurface_h

#include "vtkStratusTetGenProcess.h"

#include "vtkType.h"

#include <array>
#include <vector>

class vtkPolyData;
class vtkUnstructuredGrid;

struct VTK_STRATUS_PRIVATE vtkStratusTetGenSurface {
  std::vector<double> Coordinates;
  std::vector<vtkIdType> OriginalPoints; // the input's number of each of our points
  std::vector<std::int32_t> Begins, Corners, Markers;
  std::vector<std::array<double, 3>> Holes;
  std::vector<std::array<double, 5>> Regions;

  // Takes over polygons, strips and vertices and the points that they use, merges points with equal coordinates, and adds the field data
  // "Holes" and "Regions". Throws vtkStratusTetGenFailure.
  void Set(vtkPolyData* surface);
  void Write(tetgen_exchange::Request header, vtkStratusTetGenSpool& spool) const;

private:
  void SetPoints(vtkPolyData* surface, std::vector<vtkIdType>& ours);
  void AddFacet(vtkIdType size, const vtkIdType* points, std::int32_t marker, const std::vector<vtkIdType>& ours);
};

// Fills both outputs from a complete answer. Throws vtkStratusTetGenFailure where it is damaged.
VTK_STRATUS_PRIVATE void vtkStratusTetGenReadAnswer(
  vtkStratusTetGenSpool& answer, const vtkStratusTetGenSurface& surface, vtkUnstructuredGrid* mesh, vtkPolyData* boundary);

#endif
