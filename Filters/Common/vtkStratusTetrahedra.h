// SPDX-License-Identifier: BSD-3-Clause
// Divides an unstructured grid into tetrahedra for the core. Private to the modules, never installed.
#ifndef vtkStratusTetrahedra_h
#define vtkStratusTetrahedra_h

#include "stratus.h"

#include "vtkStratusInput.h"
#include "vtkType.h"

#include <deque>
#include <string>
#include <vector>

class vtkAbstractArray;
class vtkUnstructuredGrid;

struct VTK_STRATUS_PRIVATE vtkStratusTetrahedra {
  // All points of the grid, with nodes that only steer Bezier cells moved to their points of the cell, then the centres of quadratic cells
  // that have no node there.
  std::vector<double> Points;
  std::vector<int32_t> Vertices; // four per tetrahedron
  std::vector<vtkIdType> Cells;  // the grid's cell of each tetrahedron, ascending
  vtkIdType GridPoints = 0;
  vtkIdType LeftOut = 0;  // cells without a volume: vertices, lines, polygons, empty cells
  bool CellByCell = true; // each cell of the grid is one tetrahedron with the same number

  // Divides linear, quadratic, Lagrange and Bezier cells and polyhedra. Two neighbours divide their common face alike. Returns false, with
  // the reason in `error`, for other cells and for numbers beyond 31 bits.
  bool Set(vtkUnstructuredGrid* grid, std::string& error);
  stratus_mesh GetMesh() const;
  // The message for a grid none of whose cells has a volume, so that there is nothing to draw.
  std::string DescribeLeftOut() const;

  // Copies `from`, an array of the grid's points, to `to`, which has room for all Points. A value at a centre follows from the cell's shape
  // functions.
  void CopyPointValues(vtkAbstractArray* from, vtkAbstractArray* to) const;

private:
  using Face = std::vector<vtkIdType>;
  struct Kind; // of a cell type
  struct Middle {
    size_t Node;                        // index of the cell's first node in MiddleNodes
    const std::vector<double>* Weights; // one for each of the cell's nodes
    vtkIdType At;                       // the point whose values follow
  };

  static const Kind& GetKind(int type);
  bool AddCell(vtkUnstructuredGrid* grid, vtkIdType cell, std::string& error);
  void AddPolyhedron(vtkUnstructuredGrid* grid, vtkIdType cell);
  void AddConvexPointSet(vtkUnstructuredGrid* grid, vtkIdType cell);
  void AddLinear(const std::vector<Face>& faces, vtkIdType cell);
  void AddQuadratic(const Kind& kind, const vtkIdType* ids, vtkIdType cell);
  void AddPiece(vtkIdType a, vtkIdType b, vtkIdType c, vtkIdType d, vtkIdType cell);
  vtkIdType AddMiddle(const Kind& kind, const vtkIdType* ids);

  // vtkStratusTetrahedraCurved.cxx: Lagrange and Bezier cells.
  static bool IsCurved(int type);
  bool AddCurved(vtkUnstructuredGrid* grid, vtkIdType cell, vtkIdType count, const vtkIdType* ids, std::string& error);
  void PlaceBezier(vtkUnstructuredGrid* grid, vtkIdType cell, const int order[4]);
  template <typename Node> void AddCurvedTetrahedra(int left, Node&& node, vtkIdType cell);
  void AddBox(const vtkIdType p[8], vtkIdType cell);
  void AddPrism(const vtkIdType p[6], vtkIdType cell);

  std::vector<Middle> Middles;
  std::deque<std::vector<double>> OwnWeights; // of Bezier cells' nodes; they stay where they are
  std::vector<bool> Placed;                   // points of the grid that a Bezier cell has placed; empty: none
  std::vector<vtkIdType> MiddleNodes;
  std::vector<Face> Faces; // of the current cell, kept to reuse its memory
};

#endif
