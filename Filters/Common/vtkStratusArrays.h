// SPDX-License-Identifier: BSD-3-Clause
// Checks of a data set's arrays and cells. Files bring arrays of any length and cells that name any point, so nothing may read them
// unchecked. Private to the modules, never installed.
#ifndef vtkStratusArrays_h
#define vtkStratusArrays_h

#include "vtkStratusPrivate.h"

#include "vtkType.h"

#include <string>

class vtkCellArray;
class vtkDataSetAttributes;
class vtkPolyData;
class vtkUnsignedCharArray;
class vtkUnstructuredGrid;

// Sets `flags` to the array vtkGhostType, or to nullptr where there is none. Returns false, with the reason in `error`, unless the array
// holds one unsigned char for each of the `count` `things` ("points of the image").
VTK_STRATUS_PRIVATE bool vtkStratusFindGhosts(
  vtkDataSetAttributes* data, vtkIdType count, const char* things, vtkUnsignedCharArray*& flags, std::string& error);

// Returns false where an array has fewer tuples than `count`, the number of `things`.
VTK_STRATUS_PRIVATE bool vtkStratusCheckArrays(vtkDataSetAttributes* data, vtkIdType count, const char* things, std::string& error);

// Returns false where a cell names a point outside 0..points - 1, or where the cells' offsets are not valid. `first` is the number of the
// first of these cells, for the message.
VTK_STRATUS_PRIVATE bool vtkStratusCheckCells(vtkCellArray* cells, vtkIdType first, vtkIdType points, std::string& error);

// Checks a grid's cells in the same way, that every cell has a type, and the faces of polyhedra.
VTK_STRATUS_PRIVATE bool vtkStratusCheckGrid(vtkUnstructuredGrid* grid, std::string& error);

// Checks a surface's vertices, lines, polygons and strips in the same way, and the lengths of its point and cell arrays.
VTK_STRATUS_PRIVATE bool vtkStratusCheckSurface(vtkPolyData* surface, std::string& error);

#endif
