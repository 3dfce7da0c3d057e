// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusLeaves.h"

#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>

namespace {
constexpr int HeaderNumbers = 12; // version, number of nodes, number of leaves, frame (9)
constexpr int NodeNumbers = 4;    // axis, below, above, value
constexpr vtkIdType NumbersMax = 2147483647;
} // namespace

bool vtkStratusLeaves::Set(vtkUnstructuredGrid* grid)
{
  vtkDataArray* leaf = grid->GetCellData()->GetArray(vtkStratusLeafArray);
  vtkDataArray* tree = grid->GetFieldData()->GetArray(vtkStratusPartitionArray);
  if (!leaf || !tree || leaf->GetNumberOfComponents() != 1 || leaf->GetNumberOfTuples() < grid->GetNumberOfCells() ||
    tree->GetNumberOfComponents() != 1 || tree->GetNumberOfTuples() < HeaderNumbers || tree->GetComponent(0, 0) != 1.0) {
    return false;
  }
  const double nodes = tree->GetComponent(1, 0);
  const double leaves = tree->GetComponent(2, 0);
  if (!(nodes >= 1.0 && nodes <= 131071.0 && leaves >= 1.0 && leaves <= 65536.0) ||
    tree->GetNumberOfTuples() != HeaderNumbers + NodeNumbers * static_cast<vtkIdType>(nodes)) {
    return false;
  }
  // The core refuses -2, which stands for every number outside -1..2^31 - 1.
  const auto number = [&](vtkIdType i) {
    const double value = tree->GetComponent(i, 0);
    return value >= -1.0 && value <= NumbersMax ? static_cast<int32_t>(value) : -2;
  };
  this->Nodes.resize(static_cast<size_t>(nodes));
  for (size_t n = 0; n < this->Nodes.size(); ++n) {
    const vtkIdType at = HeaderNumbers + NodeNumbers * static_cast<vtkIdType>(n);
    this->Nodes[n] = { number(at), number(at + 1), number(at + 2), 0, tree->GetComponent(at + 3, 0) };
  }
  this->Leaf.resize(static_cast<size_t>(leaf->GetNumberOfTuples()));
  for (size_t i = 0; i < this->Leaf.size(); ++i) {
    const double value = leaf->GetComponent(static_cast<vtkIdType>(i), 0);
    this->Leaf[i] = value >= 0.0 && value < leaves ? static_cast<int32_t>(value) : -1;
  }
  this->Leaves = { this->Nodes.data(), static_cast<int32_t>(nodes), static_cast<int32_t>(leaves), this->Leaf.data(), {} };
  for (int i = 0; i < 9; ++i) {
    this->Leaves.frame[i] = tree->GetComponent(3 + i, 0);
  }
  return true;
}

void vtkStratusLeaves::Write(const stratus_leaves& leaves, vtkIdType cells, vtkUnstructuredGrid* grid)
{
  vtkNew<vtkIntArray> leaf;
  leaf->SetName(vtkStratusLeafArray);
  leaf->SetNumberOfTuples(cells);
  std::copy(leaves.leaf, leaves.leaf + cells, leaf->GetPointer(0));
  grid->GetCellData()->AddArray(leaf);
  vtkNew<vtkDoubleArray> tree;
  tree->SetName(vtkStratusPartitionArray);
  for (const double value : { 1.0, static_cast<double>(leaves.node_count), static_cast<double>(leaves.leaf_count) }) {
    tree->InsertNextValue(value);
  }
  for (const double value : leaves.frame) {
    tree->InsertNextValue(value);
  }
  for (int32_t n = 0; n < leaves.node_count; ++n) {
    const stratus_partition_node& node = leaves.nodes[n];
    for (const double value : { double(node.axis), double(node.below), double(node.above), node.value }) {
      tree->InsertNextValue(value);
    }
  }
  grid->GetFieldData()->AddArray(tree);
}
