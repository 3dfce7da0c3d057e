// SPDX-License-Identifier: BSD-3-Clause
// Helpers of the tests of TetGen's files and filter: text files, volumes and areas by textbook formulas, comparisons, and a box.
#ifndef tetgen_testing_h
#define tetgen_testing_h

#include "mapper_testing.h"

#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

inline void WriteText(const std::string& path, const std::string& text)
{
  std::ofstream(path, std::ios::binary) << text;
}

inline std::string ReadText(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
}

// Returns six times the signed volume of the first four corners' tetrahedron.
inline double SixVolumes(vtkPointSet* mesh, const vtkIdType* corners)
{
  double p[4][3], a[3], b[3], c[3], normal[3];
  for (int corner = 0; corner < 4; ++corner) {
    mesh->GetPoint(corners[corner], p[corner]);
  }
  vtkMath::Subtract(p[1], p[0], a);
  vtkMath::Subtract(p[2], p[0], b);
  vtkMath::Subtract(p[3], p[0], c);
  vtkMath::Cross(a, b, normal);
  return vtkMath::Dot(normal, c);
}

inline const vtkIdType* Corners(vtkUnstructuredGrid* mesh, vtkIdType cell)
{
  vtkIdType size = 0;
  const vtkIdType* corners = nullptr;
  mesh->GetCells()->GetCellAtId(cell, size, corners);
  return corners;
}

// Returns the volume of all cells, and checks that none is inverted or flat.
inline double Volume(vtkUnstructuredGrid* mesh)
{
  double volume = 0.0;
  int bad = 0;
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell) {
    const double six = SixVolumes(mesh, Corners(mesh, cell));
    bad += six > 0.0 ? 0 : 1;
    volume += six / 6.0;
  }
  CHECK(bad == 0, "%d of %lld cells are inverted or flat", bad, static_cast<long long>(mesh->GetNumberOfCells()));
  return volume;
}

// Returns the area of the triangles with this marker.
inline double Area(vtkPolyData* surface, int marker)
{
  vtkDataArray* markers = surface->GetCellData()->GetArray("Marker");
  double area = 0.0;
  for (vtkIdType face = 0; markers && face < surface->GetNumberOfPolys(); ++face) {
    vtkIdType size = 0;
    const vtkIdType* points = nullptr;
    surface->GetPolys()->GetCellAtId(face, size, points);
    if (markers->GetComponent(surface->GetNumberOfLines() + face, 0) == marker) {
      double p[3][3], a[3], b[3], normal[3];
      for (int corner = 0; corner < 3; ++corner) {
        surface->GetPoint(points[corner], p[corner]);
      }
      vtkMath::Subtract(p[1], p[0], a);
      vtkMath::Subtract(p[2], p[0], b);
      vtkMath::Cross(a, b, normal);
      area += 0.5 * vtkMath::Norm(normal);
    }
  }
  return area;
}

// Checks that each neighbour has all corners of the cell but the one opposite to it, and that a cell has a neighbour wherever another cell
// has that face.
inline bool NeighborsAreRight(vtkUnstructuredGrid* mesh)
{
  vtkDataArray* neighbors = mesh->GetCellData()->GetArray("Neighbors");
  if (!neighbors || neighbors->GetNumberOfComponents() != 4) {
    return false;
  }
  const vtkIdType cells = mesh->GetNumberOfCells();
  for (vtkIdType cell = 0; cell < cells; ++cell) {
    for (int corner = 0; corner < 4; ++corner) {
      std::set<vtkIdType> face(Corners(mesh, cell), Corners(mesh, cell) + 4);
      face.erase(Corners(mesh, cell)[corner]);
      vtkIdType found = -1;
      for (vtkIdType other = 0; other < cells; ++other) {
        std::set<vtkIdType> points(Corners(mesh, other), Corners(mesh, other) + 4);
        found = other != cell && std::includes(points.begin(), points.end(), face.begin(), face.end()) ? other : found;
      }
      if (static_cast<vtkIdType>(neighbors->GetComponent(cell, corner)) != found) {
        return false;
      }
    }
  }
  return true;
}

// Adds a box of six quadrilaterals with markers `marker` .. `marker` + 5.
inline void AddBox(vtkPolyData* surface, const double lower[3], const double upper[3], int marker)
{
  if (!surface->GetPoints()) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    vtkNew<vtkCellArray> polygons;
    vtkNew<vtkIntArray> markers;
    markers->SetName("Marker");
    surface->SetPoints(points);
    surface->SetPolys(polygons);
    surface->GetCellData()->AddArray(markers);
  }
  const vtkIdType first = surface->GetNumberOfPoints();
  for (int corner = 0; corner < 8; ++corner) {
    surface->GetPoints()->InsertNextPoint(
      corner & 1 ? upper[0] : lower[0], corner & 2 ? upper[1] : lower[1], corner & 4 ? upper[2] : lower[2]);
  }
  const vtkIdType sides[6][4] = { { 0, 2, 6, 4 }, { 1, 3, 7, 5 }, { 0, 1, 5, 4 }, { 2, 3, 7, 6 }, { 0, 1, 3, 2 }, { 4, 5, 7, 6 } };
  for (int side = 0; side < 6; ++side) {
    vtkIdType corners[4];
    std::transform(sides[side], sides[side] + 4, corners, [first](vtkIdType corner) { return first + corner; });
    surface->GetPolys()->InsertNextCell(4, corners);
    vtkIntArray::SafeDownCast(surface->GetCellData()->GetArray("Marker"))->InsertNextValue(marker + side);
  }
}

// Returns whether two arrays have the same type, shape and bits.
inline bool SameArray(vtkDataArray* a, vtkDataArray* b)
{
  if (!a || !b || a->GetDataType() != b->GetDataType() || a->GetNumberOfValues() != b->GetNumberOfValues() ||
    a->GetNumberOfComponents() != b->GetNumberOfComponents()) {
    return false;
  }
  const size_t bytes = static_cast<size_t>(a->GetNumberOfValues()) * static_cast<size_t>(a->GetDataTypeSize());
  return bytes == 0 ||
    std::equal(
      static_cast<char*>(a->GetVoidPointer(0)), static_cast<char*>(a->GetVoidPointer(0)) + bytes, static_cast<char*>(b->GetVoidPointer(0)));
}

// Returns whether b has the arrays of a and no others.
inline bool SameArrays(vtkFieldData* a, vtkFieldData* b)
{
  bool same = a->GetNumberOfArrays() == b->GetNumberOfArrays();
  for (int index = 0; same && index < a->GetNumberOfArrays(); ++index) {
    same = SameArray(a->GetArray(index), b->GetArray(a->GetArrayName(index)));
  }
  return same;
}

inline bool SameCells(vtkCellArray* a, vtkCellArray* b)
{
  if (!a || !b) { // a grid without cells has none
    return a == b;
  }
  bool same = a->GetNumberOfCells() == b->GetNumberOfCells();
  for (vtkIdType cell = 0; same && cell < a->GetNumberOfCells(); ++cell) {
    vtkNew<vtkIdList> one, two;
    a->GetCellAtId(cell, one);
    b->GetCellAtId(cell, two);
    same = one->GetNumberOfIds() == two->GetNumberOfIds() && std::equal(one->begin(), one->end(), two->begin());
  }
  return same;
}

#endif
