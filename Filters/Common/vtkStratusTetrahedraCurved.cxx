// SPDX-License-Identifier: BSD-3-Clause
// Lagrange and Bezier cells, divided at their nodes: into hexahedra, wedges or tetrahedra of nodes that lie side by side. Neighbours share
// the nodes of their common face, and so divide it alike. Of Bezier cells, whose nodes only steer them, the point that belongs to a node by
// its place in the lattice takes the node's number.
#include "vtkStratusTetrahedra.h"

#include "vtkCell.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataArray.h"
#include "vtkGenericCell.h"
#include "vtkHigherOrderHexahedron.h"
#include "vtkHigherOrderTetra.h"
#include "vtkHigherOrderWedge.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>

namespace {
constexpr int OrderMost = 64; // beyond it a cell has more nodes than programs make

enum class Shape { Tetrahedron, Hexahedron, Wedge };

Shape ShapeOf(int type)
{
  return type == VTK_LAGRANGE_TETRAHEDRON || type == VTK_BEZIER_TETRAHEDRON ? Shape::Tetrahedron
    : type == VTK_LAGRANGE_HEXAHEDRON || type == VTK_BEZIER_HEXAHEDRON      ? Shape::Hexahedron
                                                                            : Shape::Wedge;
}

bool IsBezier(int type)
{
  return type == VTK_BEZIER_TETRAHEDRON || type == VTK_BEZIER_HEXAHEDRON || type == VTK_BEZIER_WEDGE;
}

// The number of nodes that a cell of these orders has.
vtkIdType CountNodes(Shape shape, const int order[3])
{
  const vtkIdType a = order[0] + 1, b = order[1] + 1, c = order[2] + 1;
  return shape == Shape::Tetrahedron ? a * (a + 1) * (a + 2) / 6 : shape == Shape::Hexahedron ? a * b * c : a * (a + 1) / 2 * c;
}

// Finds the orders of a cell of `count` nodes: `degrees` if there are any, else the same along all axes. Tetrahedra of 15 nodes and wedges
// of 21 are of order 2, with nodes in the middles of their faces and the cell, which are not used.
bool FindOrder(Shape shape, vtkDataArray* degrees, vtkIdType cell, vtkIdType count, int order[4])
{
  order[3] = static_cast<int>(count);
  if ((shape == Shape::Tetrahedron && count == 15) || (shape == Shape::Wedge && count == 21)) {
    std::fill_n(order, 3, 2);
    return true;
  }
  if (degrees && shape != Shape::Tetrahedron) {
    for (int a = 0; a < 3; ++a) {
      const double degree = degrees->GetComponent(cell, a);
      order[a] = degree >= 1.0 && degree <= OrderMost ? static_cast<int>(degree) : 0;
    }
    return *std::min_element(order, order + 3) > 0 && (shape == Shape::Hexahedron || order[0] == order[1]) &&
      CountNodes(shape, order) == count;
  }
  for (int same = 1; same <= OrderMost; ++same) {
    std::fill_n(order, 3, same);
    if (CountNodes(shape, order) == count) {
      return true;
    }
  }
  return false;
}

// The node at i, j, k of the cell's lattice.
vtkIdType NodeAt(Shape shape, int i, int j, int k, const int order[4])
{
  if (shape == Shape::Tetrahedron) {
    const vtkIdType place[4] = { i, j, k, order[0] - i - j - k };
    return vtkHigherOrderTetra::Index(place, order[0]);
  }
  return shape == Shape::Hexahedron ? vtkHigherOrderHexahedron::PointIndexFromIJK(i, j, k, order)
                                    : vtkHigherOrderWedge::PointIndexFromIJK(i, j, k, order);
}

template <typename Function> void EachNode(Shape shape, const int order[4], Function&& function)
{
  for (int k = 0; k <= order[2]; ++k) {
    for (int j = 0; j <= order[1] - (shape == Shape::Tetrahedron ? k : 0); ++j) {
      const int most = shape == Shape::Tetrahedron ? order[0] - j - k : shape == Shape::Wedge ? order[0] - j : order[0];
      for (int i = 0; i <= most; ++i) {
        function(i, j, k);
      }
    }
  }
}
} // namespace

bool vtkStratusTetrahedra::IsCurved(int type)
{
  return type == VTK_LAGRANGE_TETRAHEDRON || type == VTK_LAGRANGE_HEXAHEDRON || type == VTK_LAGRANGE_WEDGE || IsBezier(type);
}

// Moves the nodes of a Bezier cell to the points of the cell that belong to them, and keeps the weights by which their values follow.
void vtkStratusTetrahedra::PlaceBezier(vtkUnstructuredGrid* grid, vtkIdType cell, const int order[4])
{
  vtkNew<vtkGenericCell> generic;
  grid->GetCell(cell, generic);
  const Shape shape = ShapeOf(grid->GetCellType(cell));
  vtkIdList* ids = generic->GetPointIds();
  this->Placed.resize(static_cast<size_t>(this->GridPoints), false);
  EachNode(shape, order, [&](int i, int j, int k) {
    const vtkIdType id = ids->GetId(NodeAt(shape, i, j, k, order));
    if (this->Placed[static_cast<size_t>(id)]) {
      return;
    }
    this->Placed[static_cast<size_t>(id)] = true;
    const double at[3] = { static_cast<double>(i) / order[0], static_cast<double>(j) / order[1], static_cast<double>(k) / order[2] };
    std::vector<double> weights(static_cast<size_t>(ids->GetNumberOfIds()), 0.0);
    int part = 0;
    double x[3];
    generic->EvaluateLocation(part, at, x, weights.data());
    if (*std::max_element(weights.begin(), weights.end()) == 1.0) { // a corner
      return;
    }
    std::copy_n(x, 3, &this->Points[static_cast<size_t>(3 * id)]);
    this->OwnWeights.push_back(std::move(weights));
    this->Middles.push_back({ this->MiddleNodes.size(), &this->OwnWeights.back(), id });
    this->MiddleNodes.insert(this->MiddleNodes.end(), ids->begin(), ids->end());
  });
}

bool vtkStratusTetrahedra::AddCurved(vtkUnstructuredGrid* grid, vtkIdType cell, vtkIdType count, const vtkIdType* ids, std::string& error)
{
  const int type = grid->GetCellType(cell);
  const Shape shape = ShapeOf(type);
  vtkDataArray* degrees = grid->GetCellData()->GetHigherOrderDegrees();
  vtkDataArray* weights = grid->GetPointData()->GetRationalWeights();
  int order[4];
  if ((degrees && (degrees->GetNumberOfTuples() < grid->GetNumberOfCells() || degrees->GetNumberOfComponents() != 3)) ||
    (weights && weights->GetNumberOfTuples() < this->GridPoints)) {
    error = "the arrays of degrees and rational weights have " + std::to_string(degrees ? degrees->GetNumberOfTuples() : 0) + " and " +
      std::to_string(weights ? weights->GetNumberOfTuples() : 0) + " tuples, must have three degrees for each of the " +
      std::to_string(grid->GetNumberOfCells()) + " cells and a weight for each of the " + std::to_string(this->GridPoints) + " points";
    return false;
  }
  if (!FindOrder(shape, degrees, cell, count, order)) {
    error = "of " + std::to_string(count) + " points" + (degrees ? " and the grid's degrees" : "") + ", no cell of an order 1.." +
      std::to_string(OrderMost) + " has so many";
    return false;
  }
  if (IsBezier(type)) {
    this->PlaceBezier(grid, cell, order);
  }
  const auto node = [&](int i, int j, int k) { return ids[NodeAt(shape, i, j, k, order)]; };
  EachNode(shape, order, [&](int i, int j, int k) {
    if (shape == Shape::Tetrahedron) {
      this->AddCurvedTetrahedra(
        order[0] - i - j - k, [&](int a, int b, int c) { return node(i + a, j + b, k + c); }, cell);
    } else if (shape == Shape::Hexahedron && i < order[0] && j < order[1] && k < order[2]) {
      vtkIdType corner[8];
      for (int c = 0; c < 8; ++c) {
        corner[c] = node(i + ((c + 1) >> 1 & 1), j + (c >> 1 & 1), k + (c >> 2));
      }
      this->AddBox(corner, cell);
    } else if (shape == Shape::Wedge && k < order[2]) {
      for (int turned = 0; turned < 2 && i + j + turned < order[0]; ++turned) {
        vtkIdType corner[6];
        for (int c = 0; c < 6; ++c) { // (0 0) (1 0) (0 1), or (1 1) (0 1) (1 0)
          const int right = c % 3 == 1 ? 1 : 0, up = c % 3 == 2 ? 1 : 0;
          corner[c] = node(i + (turned ? 1 - right : right), j + (turned ? 1 - up : up), k + c / 3);
        }
        this->AddPrism(corner, cell);
      }
    }
  });
  return true;
}

// Divides what begins at a node of a tetrahedron's lattice: a tetrahedron, an octahedron and a tetrahedron upside down, as far as `left`,
// the order beyond that node, has room for them.
template <typename Node> void vtkStratusTetrahedra::AddCurvedTetrahedra(int left, Node&& node, vtkIdType cell)
{
  if (left >= 1) {
    this->AddPiece(node(0, 0, 0), node(1, 0, 0), node(0, 1, 0), node(0, 0, 1), cell);
  }
  if (left >= 2) {
    const vtkIdType ends[2] = { node(1, 0, 0), node(0, 1, 1) };
    const vtkIdType around[4] = { node(0, 1, 0), node(1, 1, 0), node(1, 0, 1), node(0, 0, 1) };
    for (int i = 0; i < 4; ++i) {
      this->AddPiece(ends[0], ends[1], around[i], around[(i + 1) % 4], cell);
    }
  }
  if (left >= 3) {
    this->AddPiece(node(1, 1, 0), node(1, 0, 1), node(0, 1, 1), node(1, 1, 1), cell);
  }
}

void vtkStratusTetrahedra::AddBox(const vtkIdType p[8], vtkIdType cell)
{
  this->AddLinear({ { p[0], p[3], p[2], p[1] }, { p[4], p[5], p[6], p[7] }, { p[0], p[1], p[5], p[4] }, { p[2], p[3], p[7], p[6] },
                    { p[1], p[2], p[6], p[5] }, { p[0], p[4], p[7], p[3] } },
    cell);
}

void vtkStratusTetrahedra::AddPrism(const vtkIdType p[6], vtkIdType cell)
{
  this->AddLinear(
    { { p[0], p[2], p[1] }, { p[3], p[4], p[5] }, { p[0], p[1], p[4], p[3] }, { p[1], p[2], p[5], p[4] }, { p[2], p[0], p[3], p[5] } },
    cell);
}
