// SPDX-License-Identifier: BSD-3-Clause
// Grids as meshes of tetrahedra for the core, and the arrays by which a grid carries its partition. Private to the module.
#ifndef vtkStratusTetrahedra_h
#define vtkStratusTetrahedra_h

#include "stratus.h"
#include "vtkType.h"

#include <string>
#include <vector>

class vtkDataArray;
class vtkUnstructuredGrid;

constexpr const char* vtkStratusLeafArray = "StratusLeaf";                 // cell data: the leaf of each
constexpr const char* vtkStratusOriginalCellArray = "StratusOriginalCell"; // cell data: the cell of the filter's input
constexpr const char* vtkStratusPartitionArray = "StratusPartition";       // field data: version, frame, nodes

struct vtkStratusTetrahedra
{
  std::vector<double> Points;    // of the grid, all of them
  std::vector<int32_t> Vertices; // four a tetrahedron
  std::vector<vtkIdType> Cells;  // the grid's cell that each is of

  // Divides linear cells, polyhedra and quadratic tetrahedra; neighbours are divided alike across their faces. Cells of no volume's dimension
  // (vertices, lines, polygons) are left out. False, and why, for others, and for numbers beyond 31 bits.
  bool Set(vtkUnstructuredGrid* grid, std::string& error);
  stratus_mesh GetMesh() const;

private:
  void Divide(const std::vector<std::vector<vtkIdType>>& faces, vtkIdType cell);
};

// The tree of a grid's arrays, both ways.
struct vtkStratusLeaves
{
  std::vector<stratus_partition_node> Nodes;
  std::vector<int32_t> Leaf;
  stratus_leaves Leaves;

  // False if the grid carries none, or none that is whole.
  bool Set(vtkUnstructuredGrid* grid);
  static void Write(const stratus_leaves& leaves, vtkIdType cells, vtkUnstructuredGrid* grid);
};

#endif
