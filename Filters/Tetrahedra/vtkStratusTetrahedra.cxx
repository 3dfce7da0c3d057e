// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusTetrahedra.h"

#include "vtkCell.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkGenericCell.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>

namespace {
constexpr int HeaderNumbers = 12; // version, nodes, leaves, frame
constexpr int NodeNumbers = 4;    // axis, below, above, value
constexpr vtkIdType NumbersMax = 2147483647;

using Face = std::vector<vtkIdType>;

// A fan from the lowest point: both cells at a face see the same.
template <typename Function>
void Triangulate(const Face& face, Function&& function)
{
  const size_t count = face.size();
  const size_t lowest = static_cast<size_t>(std::min_element(face.begin(), face.end()) - face.begin());
  for (size_t i = 1; i + 1 < count; ++i) {
    function(face[lowest], face[(lowest + i) % count], face[(lowest + i + 1) % count]);
  }
}
}

// A fan from the cell's lowest point, which is the lowest of each face that it is on, too: those are divided as their other cell divides them.
void vtkStratusTetrahedra::Divide(const std::vector<Face>& faces, vtkIdType cell)
{
  vtkIdType apex = VTK_ID_MAX;
  for (const Face& face : faces) {
    apex = std::min(apex, *std::min_element(face.begin(), face.end()));
  }
  for (const Face& face : faces) {
    if (std::find(face.begin(), face.end(), apex) != face.end()) {
      continue;
    }
    Triangulate(face, [&](vtkIdType p, vtkIdType q, vtkIdType r) {
      for (const vtkIdType point : { p, r, q, apex }) { // faces run anticlockwise as seen from outside
        this->Vertices.push_back(static_cast<int32_t>(point));
      }
      this->Cells.push_back(cell);
    });
  }
}

bool vtkStratusTetrahedra::Set(vtkUnstructuredGrid* grid, std::string& error)
{
  this->Points.clear();
  this->Vertices.clear();
  this->Cells.clear();
  const vtkIdType points = grid->GetNumberOfPoints();
  const vtkIdType cells = grid->GetNumberOfCells();
  if (points > NumbersMax || cells > NumbersMax / 2) {
    error = "the grid has " + std::to_string(points) + " points and " + std::to_string(cells) + " cells, at most 2^31-1 and 2^30-1 are allowed";
    return false;
  }
  this->Points.resize(static_cast<size_t>(3 * points));
  for (vtkIdType i = 0; i < points; ++i) {
    grid->GetPoint(i, &this->Points[static_cast<size_t>(3 * i)]);
  }
  // Corners 0..3 and the middles of edges 01 12 20 03 13 23: four at the corners, four around the line between the middles of 01 and 23.
  static const int quadratic[8][4] = { { 0, 4, 6, 7 }, { 4, 1, 5, 8 }, { 6, 5, 2, 9 }, { 7, 8, 9, 3 }, { 4, 9, 6, 7 }, { 4, 9, 7, 8 },
    { 4, 9, 8, 5 }, { 4, 9, 5, 6 } };
  vtkNew<vtkGenericCell> generic;
  std::vector<Face> faces;
  for (vtkIdType c = 0; c < cells; ++c) {
    const int type = grid->GetCellType(c);
    vtkIdType count = 0;
    const vtkIdType* ids = nullptr;
    if (type == VTK_TETRA || type == VTK_QUADRATIC_TETRA) {
      static const int whole[1][4] = { { 0, 1, 2, 3 } };
      grid->GetCellPoints(c, count, ids);
      const int(*parts)[4] = type == VTK_TETRA ? whole : quadratic;
      for (int t = 0; t < (type == VTK_TETRA ? 1 : 8); ++t) {
        for (int i = 0; i < 4; ++i) {
          this->Vertices.push_back(static_cast<int32_t>(ids[parts[t][i]]));
        }
        this->Cells.push_back(c);
      }
      continue;
    }
    grid->GetCell(c, generic);
    if (generic->GetCellDimension() < 3) {
      continue;
    }
    if (!generic->IsLinear()) {
      error = "cell " + std::to_string(c) + " is of type " + std::to_string(type) +
        ", of cells that are not linear only quadratic tetrahedra (24) can be divided";
      return false;
    }
    faces.resize(static_cast<size_t>(generic->GetNumberOfFaces()));
    for (int f = 0; f < generic->GetNumberOfFaces(); ++f) {
      vtkCell* face = generic->GetFace(f);
      Face& points_of = faces[static_cast<size_t>(f)];
      points_of.assign(face->GetPointIds()->begin(), face->GetPointIds()->end());
      if (face->GetCellType() == VTK_PIXEL) { // points run row by row, not round about
        std::swap(points_of[2], points_of[3]);
      }
    }
    this->Divide(faces, c);
  }
  return true;
}

stratus_mesh vtkStratusTetrahedra::GetMesh() const
{
  stratus_mesh mesh = stratus_mesh_default();
  mesh.points = this->Points.data();
  mesh.point_count = static_cast<int64_t>(this->Points.size() / 3);
  mesh.vertices = this->Vertices.data();
  mesh.cell_count = static_cast<int64_t>(this->Vertices.size() / 4);
  return mesh;
}

bool vtkStratusLeaves::Set(vtkUnstructuredGrid* grid)
{
  vtkDataArray* leaf = grid->GetCellData()->GetArray(vtkStratusLeafArray);
  vtkDataArray* tree = grid->GetFieldData()->GetArray(vtkStratusPartitionArray);
  if (!leaf || !tree || leaf->GetNumberOfComponents() != 1 || tree->GetNumberOfComponents() != 1 || tree->GetNumberOfTuples() < HeaderNumbers ||
    tree->GetComponent(0, 0) != 1.0) {
    return false;
  }
  const double nodes = tree->GetComponent(1, 0);
  const double leaves = tree->GetComponent(2, 0);
  if (!(nodes >= 1.0 && nodes <= 131071.0 && leaves >= 1.0 && leaves <= 65536.0) ||
    tree->GetNumberOfTuples() != HeaderNumbers + NodeNumbers * static_cast<vtkIdType>(nodes)) {
    return false;
  }
  // A number that is no int becomes one that the core refuses.
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
