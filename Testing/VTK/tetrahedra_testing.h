// SPDX-License-Identifier: BSD-3-Clause
// Grids of mixed cells for the tests of tetrahedra, and what must hold of cells that fill a box.
#ifndef tetrahedra_testing_h
#define tetrahedra_testing_h

#include "mapper_testing.h"

#include "vtkCellArray.h"
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

// n*n*n unit cubes: hexahedra, voxels, six pyramids each, and a column of wedges along z in each corner: all meet in whole faces.
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

struct Faces {
  std::map<std::array<vtkIdType, 3>, std::vector<vtkIdType>> Owners; // cells by their faces' points in rising order
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
