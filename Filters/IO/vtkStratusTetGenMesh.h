// SPDX-License-Identifier: BSD-3-Clause
// TetGen's .node, .ele, .neigh, .face and .edge files as arrays of VTK. All functions throw vtkStratusTetGenError. Private to the module.
#ifndef vtkStratusTetGenMesh_h
#define vtkStratusTetGenMesh_h

#include "vtkStratusTetGenText.h"

#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"

struct VTK_STRATUS_PRIVATE vtkStratusTetGenNodes {
  vtkIdType First = 0; // number of the first point, 0 or 1: that of all elements, too
  vtkSmartPointer<vtkPoints> Points;
  std::vector<vtkSmartPointer<vtkDoubleArray>> Attributes;
  vtkSmartPointer<vtkIntArray> Markers; // null where the file has none

  vtkIdType GetLast() const { return this->First + this->Points->GetNumberOfPoints() - 1; }
};

struct VTK_STRATUS_PRIVATE vtkStratusTetGenElements {
  int Corners = 4; // or 10
  vtkIdType Count = 0;
  vtkSmartPointer<vtkIdTypeArray> Connectivity; // in VTK's order
  std::vector<vtkSmartPointer<vtkDoubleArray>> Attributes;
};

// Triangles or edges with their markers; points in the middle of second-order edges are left out.
struct VTK_STRATUS_PRIVATE vtkStratusTetGenPieces {
  vtkSmartPointer<vtkIdTypeArray> Connectivity;
  vtkSmartPointer<vtkIntArray> Markers;
};

// The point list of a .node file or of the first part of a .poly or .smesh file; whole: nothing may follow.
VTK_STRATUS_PRIVATE void vtkStratusTetGenReadNodes(vtkStratusTetGenInput& input, bool whole, vtkStratusTetGenNodes& nodes);
VTK_STRATUS_PRIVATE void vtkStratusTetGenReadElements(
  vtkStratusTetGenInput& input, const vtkStratusTetGenNodes& nodes, vtkStratusTetGenElements& elements);
// The neighbour opposite each corner, -1 for none.
VTK_STRATUS_PRIVATE vtkSmartPointer<vtkIdTypeArray> vtkStratusTetGenReadNeighbors(
  vtkStratusTetGenInput& input, vtkIdType first, vtkIdType elements);
// corners: 3 for .face, 2 for .edge. second_order: whether middles of edges are in it; -1 is told by the number of columns, and returned.
VTK_STRATUS_PRIVATE int vtkStratusTetGenReadPieces(
  vtkStratusTetGenInput& input, const vtkStratusTetGenNodes& nodes, int corners, int second_order, vtkStratusTetGenPieces& pieces);

// Where corner i of a second-order tetrahedron of VTK stands in TetGen's files.
extern VTK_STRATUS_PRIVATE const int vtkStratusTetGenCorner[10];

#endif
