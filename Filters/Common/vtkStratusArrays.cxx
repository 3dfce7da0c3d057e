// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusArrays.h"

#include "vtkStratusVersions.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataSetAttributes.h"
#include "vtkIdTypeArray.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

namespace {
std::string NameOf(vtkAbstractArray* array)
{
  return array->GetName() ? std::string("array '") + array->GetName() + "'" : std::string("an array without a name");
}

bool CheckPoint(vtkIdType cell, vtkIdType point, vtkIdType points, std::string& error)
{
  if (point < 0 || point >= points) {
    error = "cell " + std::to_string(cell) + " names point " + std::to_string(point) + ", outside 0.." + std::to_string(points - 1);
    return false;
  }
  return true;
}

#if VTK_STRATUS_FACES_ARE_CELLS
// A polyhedron's faces are cells of one array, whose numbers another has. Both have been checked.
bool CheckFaces(vtkUnstructuredGrid* grid, vtkIdType cell, std::string& error)
{
  vtkCellArray* of_cells = grid->GetPolyhedronFaceLocations();
  const vtkIdType count = of_cells ? of_cells->GetNumberOfCells() : 0;
  if (cell >= count) {
    error =
      "cell " + std::to_string(cell) + " is a polyhedron without faces: the grid has the faces of " + std::to_string(count) + " cells";
  }
  return cell < count;
}

bool CheckFaceArrays(vtkUnstructuredGrid* grid, std::string& error)
{
  vtkCellArray *faces = grid->GetPolyhedronFaces(), *of_cells = grid->GetPolyhedronFaceLocations();
  const char* const what = "faces of polyhedra: ";
  const bool sound = (!faces || vtkStratusCheckCells(faces, 0, grid->GetNumberOfPoints(), error)) &&
    (!of_cells || vtkStratusCheckCells(of_cells, 0, faces ? faces->GetNumberOfCells() : 0, error));
  error = sound ? error : what + error;
  return sound;
}
#else
// A polyhedron's faces are one run of numbers: the number of faces, then the size and the points of each face.
bool CheckFaces(vtkUnstructuredGrid* grid, vtkIdType cell, std::string& error)
{
  vtkIdTypeArray* faces = grid->GetFaces();
  vtkIdTypeArray* begins = grid->GetFaceLocations();
  const vtkIdType end = faces ? faces->GetNumberOfValues() : 0;
  vtkIdType at = begins && cell < begins->GetNumberOfValues() ? begins->GetValue(cell) : -1;
  bool inside = at >= 0 && at < end;
  for (vtkIdType left = inside ? faces->GetValue(at++) : 0; inside && left > 0; --left) {
    const vtkIdType size = at < end ? faces->GetValue(at++) : -1;
    inside = size >= 0 && size <= end - at;
    for (vtkIdType i = 0; inside && i < size; ++i) {
      if (!CheckPoint(cell, faces->GetValue(at++), grid->GetNumberOfPoints(), error)) {
        return false;
      }
    }
  }
  if (!inside) {
    error = "cell " + std::to_string(cell) + " is a polyhedron whose faces lie outside the " + std::to_string(end) +
      " numbers that faces are made of";
  }
  return inside;
}

bool CheckFaceArrays(vtkUnstructuredGrid*, std::string&)
{
  return true; // cell for cell
}
#endif
} // namespace

bool vtkStratusFindGhosts(vtkDataSetAttributes* data, vtkIdType count, const char* things, vtkUnsignedCharArray*& flags, std::string& error)
{
  vtkAbstractArray* array = data->GetAbstractArray(vtkDataSetAttributes::GhostArrayName());
  flags = vtkUnsignedCharArray::SafeDownCast(array);
  if (array && (!flags || flags->GetNumberOfComponents() != 1 || flags->GetNumberOfTuples() != count)) {
    error = NameOf(array) + " has " + std::to_string(array->GetNumberOfTuples()) + " tuples of " +
      std::to_string(array->GetNumberOfComponents()) + " " + array->GetDataTypeAsString() +
      ", it must have one unsigned char for each of the " + std::to_string(count) + " " + things;
    return false;
  }
  return true;
}

bool vtkStratusCheckArrays(vtkDataSetAttributes* data, vtkIdType count, const char* things, std::string& error)
{
  for (int i = 0; i < data->GetNumberOfArrays(); ++i) {
    vtkAbstractArray* array = data->GetAbstractArray(i);
    if (array->GetNumberOfTuples() < count) {
      error = NameOf(array) + " has " + std::to_string(array->GetNumberOfTuples()) + " tuples, it must have one for each of the " +
        std::to_string(count) + " " + things;
      return false;
    }
  }
  return true;
}

bool vtkStratusCheckCells(vtkCellArray* cells, vtkIdType first, vtkIdType points, std::string& error)
{
  if (!cells->IsValid()) {
    error = "the offsets of the " + std::to_string(cells->GetNumberOfCells()) + " cells do not rise from 0 to the " +
      std::to_string(cells->GetNumberOfConnectivityIds()) + " points that they have in all";
    return false;
  }
  for (vtkIdType cell = 0; cell < cells->GetNumberOfCells(); ++cell) {
    vtkIdType count = 0;
    const vtkIdType* ids = nullptr;
    cells->GetCellAtId(cell, count, ids);
    for (vtkIdType i = 0; i < count; ++i) {
      if (!CheckPoint(first + cell, ids[i], points, error)) {
        return false;
      }
    }
  }
  return true;
}

bool vtkStratusCheckGrid(vtkUnstructuredGrid* grid, std::string& error)
{
  const vtkIdType cells = grid->GetNumberOfCells();
  vtkDataArray* types = vtkStratusCellTypes(grid);
  const vtkIdType typed = types ? types->GetNumberOfValues() : 0;
  if (typed < cells) {
    error =
      "the grid has " + std::to_string(typed) + " types of cells, it must have one for each of the " + std::to_string(cells) + " cells";
    return false;
  }
  if (cells > 0 && !vtkStratusCheckCells(grid->GetCells(), 0, grid->GetNumberOfPoints(), error)) {
    return false;
  }
  if (!CheckFaceArrays(grid, error)) {
    return false;
  }
  for (vtkIdType cell = 0; cell < cells; ++cell) {
    if (grid->GetCellType(cell) == VTK_POLYHEDRON && !CheckFaces(grid, cell, error)) {
      return false;
    }
  }
  return true;
}

bool vtkStratusCheckSurface(vtkPolyData* surface, std::string& error)
{
  vtkIdType first = 0;
  for (vtkCellArray* cells : { surface->GetVerts(), surface->GetLines(), surface->GetPolys(), surface->GetStrips() }) {
    if (!vtkStratusCheckCells(cells, first, surface->GetNumberOfPoints(), error)) {
      return false;
    }
    first += cells->GetNumberOfCells();
  }
  return vtkStratusCheckArrays(surface->GetPointData(), surface->GetNumberOfPoints(), "points of the surface", error) &&
    vtkStratusCheckArrays(surface->GetCellData(), first, "cells of the surface", error);
}
