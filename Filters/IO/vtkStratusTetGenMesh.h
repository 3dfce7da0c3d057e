// SPDX-License-Identifier: BSD-3-Clause
// Reads TetGen's .node, .ele, .neigh, .face and .edge files as VTK's arrays. All functions throw vtkStratusTetGenError. Private to the
// module.
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
  vtkIdType First = 0; // number of the first point, 0 or 1; tetrahedra, faces and edges start at the same number
  vtkSmartPointer<vtkPoints> Points;
  std::vector<vtkSmartPointer<vtkDoubleArray>> Attributes;
  vtkSmartPointer<vtkIntArray> Markers; // null where the file has none

  vtkIdType GetLast() const { return this->First + this->Points->GetNumberOfPoints() - 1; }
};

struct VTK_STRATUS_PRIVATE vtkStratusTetGenElements {
  int Corners = 4; // points of a tetrahedron, 4 or 10
  vtkIdType Count = 0;
  vtkSmartPointer<vtkIdTypeArray> Connectivity; // in VTK's order
  std::vector<vtkSmartPointer<vtkDoubleArray>> Attributes;
};

// Triangles or edges with their markers, without the midpoints of second-order edges.
struct VTK_STRATUS_PRIVATE vtkStratusTetGenPieces {
  vtkSmartPointer<vtkIdTypeArray> Connectivity;
  vtkSmartPointer<vtkIntArray> Markers;
};

// Reads the point list of a .node file or at the start of a .poly or .smesh file. `whole`: nothing may follow the list.
VTK_STRATUS_PRIVATE void vtkStratusTetGenReadNodes(vtkStratusTetGenInput& input, bool whole, vtkStratusTetGenNodes& nodes);
VTK_STRATUS_PRIVATE void vtkStratusTetGenReadElements(
  vtkStratusTetGenInput& input, const vtkStratusTetGenNodes& nodes, vtkStratusTetGenElements& elements);
// Reads the neighbour opposite each corner, -1 where there is none.
VTK_STRATUS_PRIVATE vtkSmartPointer<vtkIdTypeArray> vtkStratusTetGenReadNeighbors(
  vtkStratusTetGenInput& input, vtkIdType first, vtkIdType elements);
// `corners`: 3 for .face, 2 for .edge. `second_order`: 1 if the file holds the midpoints of edges, 0 if not; -1 if unknown: the number of
// columns then decides. Returns the value found.
VTK_STRATUS_PRIVATE int vtkStratusTetGenReadPieces(
  vtkStratusTetGenInput& input, const vtkStratusTetGenNodes& nodes, int corners, int second_order, vtkStratusTetGenPieces& pieces);

// The position in TetGen's files of each node of VTK's quadratic tetrahedron.
extern VTK_STRATUS_PRIVATE const int vtkStratusTetGenCorner[10];

#endif
