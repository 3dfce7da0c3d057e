// SPDX-License-Identifier: BSD-3-Clause
// Grids of mixed cells for the tests of tetrahedra, and helpers that check cells which fill a box.
#ifndef tetrahedra_testing_h
#define tetrahedra_testing_h

#include "mapper_testing.h"

#include "vtkCell.h"
#include "vtkCellArray.h"
#include "vtkGenericCell.h"
#include "vtkIdList.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

using Grid = vtkSmartPointer<vtkUnstructuredGrid>;
using Vector = std::array<double, 3>;

inline Vector PointOf(vtkUnstructuredGrid* grid, vtkIdType id)
{
  Vector p;
  grid->GetPoint(id, p.data());
  return p;
}

inline Vector Minus(const Vector& a, const Vector& b)
{
  return { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
}

inline Vector Cross(const Vector& a, const Vector& b)
{
  return { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
}

inline double Dot(const Vector& a, const Vector& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Makes n*n*n unit cubes: two wedges where i == j, elsewhere hexahedra, voxels, and six pyramids each. All meet in whole faces.
inline Grid MixedGrid(int n)
{
  auto grid = Grid::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  const auto at = [n](int i, int j, int k) { return static_cast<vtkIdType>((k * (n + 1) + j) * (n + 1) + i); };
  for (int k = 0; k <= n; ++k) {
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        points->InsertNextPoint(i, j, k);
      }
    }
  }
  grid->SetPoints(points);
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const vtkIdType c[8] = { at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k), at(i, j, k + 1), at(i + 1, j, k + 1),
          at(i + 1, j + 1, k + 1), at(i, j + 1, k + 1) };
        if (i == j) {
          const vtkIdType wedges[2][6] = { { c[0], c[1], c[2], c[4], c[5], c[6] }, { c[0], c[2], c[3], c[4], c[6], c[7] } };
          grid->InsertNextCell(VTK_WEDGE, 6, wedges[0]);
          grid->InsertNextCell(VTK_WEDGE, 6, wedges[1]);
        } else if ((i + j + k) % 3 == 0) {
          static const int faces[6][4] = { { 0, 3, 2, 1 }, { 4, 5, 6, 7 }, { 0, 1, 5, 4 }, { 2, 3, 7, 6 }, { 1, 2, 6, 5 }, { 0, 4, 7, 3 } };
          const vtkIdType middle = points->InsertNextPoint(i + 0.5, j + 0.5, k + 0.5);
          for (const auto& f : faces) {
            const vtkIdType pyramid[5] = { c[f[0]], c[f[1]], c[f[2]], c[f[3]], middle };
            grid->InsertNextCell(VTK_PYRAMID, 5, pyramid);
          }
        } else if ((i + j + k) % 3 == 1) {
          const vtkIdType voxel[8] = { c[0], c[1], c[3], c[2], c[4], c[5], c[7], c[6] };
          grid->InsertNextCell(VTK_VOXEL, 8, voxel);
        } else {
          grid->InsertNextCell(VTK_HEXAHEDRON, 8, c);
        }
      }
    }
  }
  return grid;
}

// Makes n*n*n unit cubes of one type: hexahedra, or two wedges each.
inline Grid CubesOf(int n, int type)
{
  auto grid = Grid::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (int p = 0; p < (n + 1) * (n + 1) * (n + 1); ++p) {
    points->InsertNextPoint(p % (n + 1), p / (n + 1) % (n + 1), p / (n + 1) / (n + 1));
  }
  grid->SetPoints(points);
  const vtkIdType y = n + 1, z = y * y;
  for (int cube = 0; cube < n * n * n; ++cube) {
    const vtkIdType p = cube % n + cube / n % n * y + cube / n / n * z;
    const vtkIdType c[8] = { p, p + 1, p + 1 + y, p + y, p + z, p + 1 + z, p + 1 + y + z, p + y + z };
    if (type == VTK_WEDGE) {
      const vtkIdType wedges[2][6] = { { c[0], c[2], c[1], c[4], c[6], c[5] }, { c[0], c[3], c[2], c[4], c[7], c[6] } };
      grid->InsertNextCell(VTK_WEDGE, 6, wedges[0]);
      grid->InsertNextCell(VTK_WEDGE, 6, wedges[1]);
    } else {
      grid->InsertNextCell(VTK_HEXAHEDRON, 8, c);
    }
  }
  return grid;
}

// Returns a grid's cells with nodes in the middles of edges, faces and cells, as the given types for hexahedra (and voxels), wedges and
// pyramids require. Nodes inside the box from 0 to n move by `bend`, because edges would be straight otherwise.
inline Grid Elevated(vtkUnstructuredGrid* linear, int hexahedron, int wedge, int pyramid, int n, double bend)
{
  auto grid = Grid::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  std::map<Vector, vtkIdType> known;
  const auto middle = [&](const std::vector<Vector>& of) {
    Vector sum = { 0, 0, 0 };
    for (const Vector& p : of) {
      for (size_t a = 0; a < 3; ++a) {
        sum[a] += p[a] / of.size();
      }
    }
    return sum;
  };
  for (vtkIdType c = 0; c < linear->GetNumberOfCells(); ++c) {
    const int from = linear->GetCellType(c);
    const int type = from == VTK_WEDGE ? wedge : from == VTK_PYRAMID ? pyramid : hexahedron;
    const auto cell = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(type));
    const vtkIdType count = cell->GetNumberOfPoints();
    vtkNew<vtkIdList> ids;
    linear->GetCellPoints(c, ids);
    if (from == VTK_VOXEL) {
      std::swap(*ids->GetPointer(2), *ids->GetPointer(3));
      std::swap(*ids->GetPointer(6), *ids->GetPointer(7));
    }
    std::vector<Vector> corners, nodes;
    for (vtkIdType id : *ids) {
      corners.push_back(PointOf(linear, id));
    }
    nodes.assign(static_cast<size_t>(count), middle(corners));
    std::copy(corners.begin(), corners.end(), nodes.begin());
    for (vtkIdType i = 0; i < count; ++i) {
      cell->GetPointIds()->SetId(i, i);
    }
    for (int e = 0; e < cell->GetNumberOfEdges(); ++e) {
      vtkIdList* edge = cell->GetEdge(e)->GetPointIds();
      if (edge->GetNumberOfIds() == 3) {
        nodes[edge->GetId(2)] = middle({ nodes[edge->GetId(0)], nodes[edge->GetId(1)] });
      }
    }
    for (int f = 0; f < cell->GetNumberOfFaces(); ++f) {
      vtkIdList* face = cell->GetFace(f)->GetPointIds();
      const vtkIdType of = face->GetNumberOfIds(), sides = of == 9 ? 4 : 3;
      if (of == 9 || of == 7) {
        std::vector<Vector> around;
        for (vtkIdType i = 0; i < sides; ++i) {
          around.push_back(nodes[face->GetId(i)]);
        }
        nodes[face->GetId(of - 1)] = middle(around);
      }
    }
    vtkNew<vtkIdList> result;
    for (Vector p : nodes) {
      Vector key;
      for (size_t a = 0; a < 3; ++a) {
        key[a] = std::round(p[a] * 3600.0);
      }
      const auto found = known.insert({ key, points->GetNumberOfPoints() });
      if (found.second) {
        const double inside = std::sin(M_PI * p[0] / n) * std::sin(M_PI * p[1] / n) * std::sin(M_PI * p[2] / n);
        const bool on = *std::min_element(p.begin(), p.end()) < 1e-9 || *std::max_element(p.begin(), p.end()) > n - 1e-9;
        for (size_t a = 0; a < 3 && !on; ++a) {
          p[a] += bend * inside * std::sin(5.0 * p[(a + 1) % 3] + 3.0 * p[a]);
        }
        points->InsertNextPoint(p.data());
      }
      result->InsertNextId(found.first->second);
    }
    grid->InsertNextCell(type, result);
  }
  grid->SetPoints(points);
  return grid;
}

struct Faces {
  std::map<std::array<vtkIdType, 3>, std::vector<vtkIdType>> Owners; // cells by the points of their faces, ascending
  explicit Faces(vtkUnstructuredGrid* grid)
  {
    for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
      vtkIdType count;
      const vtkIdType* ids;
      grid->GetCellPoints(c, count, ids);
      for (int f = 0; f < 4; ++f) {
        std::array<vtkIdType, 3> face = { ids[(f + 1) % 4], ids[(f + 2) % 4], ids[(f + 3) % 4] };
        std::sort(face.begin(), face.end());
        this->Owners[face].push_back(c);
      }
    }
  }
};

inline double Volume(vtkUnstructuredGrid* grid, vtkIdType cell)
{
  vtkIdType count;
  const vtkIdType* ids;
  grid->GetCellPoints(cell, count, ids);
  const Vector a = PointOf(grid, ids[0]);
  return Dot(Cross(Minus(PointOf(grid, ids[1]), a), Minus(PointOf(grid, ids[2]), a)), Minus(PointOf(grid, ids[3]), a)) / 6.0;
}

#endif
