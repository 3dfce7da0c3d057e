// SPDX-License-Identifier: BSD-3-Clause
// The arrays by which a grid carries its partition. Private to the modules that compile it in.
#ifndef vtkStratusLeaves_h
#define vtkStratusLeaves_h

#include "stratus.h"
#include "vtkType.h"

#include <vector>

class vtkUnstructuredGrid;

constexpr const char* vtkStratusLeafArray = "StratusLeaf";                 // cell data: the leaf of each
constexpr const char* vtkStratusOriginalCellArray = "StratusOriginalCell"; // cell data: the cell of the filter's input
constexpr const char* vtkStratusPartitionArray = "StratusPartition";       // field data: version, nodes, leaves, frame, tree

// The tree of a grid's arrays, both ways.
struct vtkStratusLeaves {
  std::vector<stratus_partition_node> Nodes;
  std::vector<int32_t> Leaf;
  stratus_leaves Leaves;

  // False if the grid carries none, or none that is whole.
  bool Set(vtkUnstructuredGrid* grid);
  static void Write(const stratus_leaves& leaves, vtkIdType cells, vtkUnstructuredGrid* grid);
};

#endif
