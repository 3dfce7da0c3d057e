// SPDX-License-Identifier: BSD-3-Clause
// Grids as meshes of tetrahedra for the core. Private to the modules, never installed.
#ifndef vtkStratusTetrahedra_h
#define vtkStratusTetrahedra_h

#include "stratus.h"

#include "vtkStratusInput.h"
#include "vtkType.h"

#include <string>
#include <vector>

class vtkAbstractArray;
class vtkUnstructuredGrid;

struct VTK_STRATUS_PRIVATE vtkStratusTetrahedra {
  std::vector<double> Points;    // of the grid, all of them, then the middles of quadratic cells that have no point there
  std::vector<int32_t> Vertices; // four a tetrahedron
  std::vector<vtkIdType> Cells;  // the grid's cell that each is of, in rising order
  vtkIdType GridPoints = 0;
  vtkIdType LeftOut = 0;  // cells of no volume's dimension: vertices, lines, polygons
  bool CellByCell = true; // each cell of the grid is one tetrahedron, under its own number

  // Divides linear and quadratic cells and polyhedra; neighbours are divided alike across their faces. False, and why, for others, and for
  // numbers beyond 31 bits.
  bool Set(vtkUnstructuredGrid* grid, std::string& error);
  stratus_mesh GetMesh() const;
  // "nothing to draw" in words, where a grid with cells has none with a volume.
  std::string TellLeftOut() const;

  // to: an array with room for all Points; from: one of the grid's points. Values in the middles follow the cell's own shape functions.
  void CopyPointValues(vtkAbstractArray* from, vtkAbstractArray* to) const;

private:
  using Face = std::vector<vtkIdType>;
  struct Kind; // of cell
  struct Middle {
    size_t Node;                        // the first of the cell's in MiddleNodes
    const std::vector<double>* Weights; // of each there
  };

  static const Kind& GetKind(int type);
  bool AddCell(vtkUnstructuredGrid* grid, vtkIdType cell, std::string& error);
  void AddPolyhedron(vtkUnstructuredGrid* grid, vtkIdType cell);
  void AddConvexPointSet(vtkUnstructuredGrid* grid, vtkIdType cell);
  void AddLinear(const std::vector<Face>& faces, vtkIdType cell);
  void AddQuadratic(const Kind& kind, const vtkIdType* ids, vtkIdType cell);
  void AddPiece(vtkIdType a, vtkIdType b, vtkIdType c, vtkIdType d, vtkIdType cell);
  vtkIdType AddMiddle(const Kind& kind, const vtkIdType* ids);

  std::vector<Middle> Middles;
  std::vector<vtkIdType> MiddleNodes;
  std::vector<Face> Faces; // of the cell at hand
};

#endif
