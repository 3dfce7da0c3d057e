// SPDX-License-Identifier: BSD-3-Clause
// The arrays in which a grid stores its partition. Private to the modules that compile it in.
#ifndef vtkStratusLeaves_h
#define vtkStratusLeaves_h

#include "stratus.h"

#include "vtkStratusPrivate.h"

#include "vtkType.h"

#include <vector>

class vtkUnstructuredGrid;

constexpr const char* vtkStratusLeafArray = "StratusLeaf";                 // cell data: the leaf of each cell
constexpr const char* vtkStratusOriginalCellArray = "StratusOriginalCell"; // cell data: the input cell that it comes from
constexpr const char* vtkStratusPartitionArray = "StratusPartition"; // field data: version, number of nodes, number of leaves, frame, nodes

// Reads a partition from a grid's arrays, and writes one to them.
struct VTK_STRATUS_PRIVATE vtkStratusLeaves {
  std::vector<stratus_partition_node> Nodes;
  std::vector<int32_t> Leaf;
  stratus_leaves Leaves;

  // Returns false where the grid carries no partition, or an incomplete one.
  bool Set(vtkUnstructuredGrid* grid);
  static void Write(const stratus_leaves& leaves, vtkIdType cells, vtkUnstructuredGrid* grid);
};

#endif
