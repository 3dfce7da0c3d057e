// SPDX-License-Identifier: BSD-3-Clause
// What a data set says of itself is checked before it is believed: files bring arrays of any length, and cells that name any point. Private
// to the modules, never installed.
#ifndef vtkStratusArrays_h
#define vtkStratusArrays_h

#include "vtkType.h"

#include <string>

class vtkCellArray;
class vtkDataSetAttributes;
class vtkPolyData;
class vtkUnsignedCharArray;
class vtkUnstructuredGrid;

#if defined(__GNUC__)
#define VTK_STRATUS_PRIVATE __attribute__((visibility("hidden")))
#else
#define VTK_STRATUS_PRIVATE
#endif

// The flags of vtkGhostType, nullptr where there are none. False, with the reason in `error`, unless they are one unsigned char for each of
// the `count` `things` ("points of the image").
VTK_STRATUS_PRIVATE bool vtkStratusFindGhosts(
  vtkDataSetAttributes* data, vtkIdType count, const char* things, vtkUnsignedCharArray*& flags, std::string& error);

// False where an array has fewer tuples than there are things.
VTK_STRATUS_PRIVATE bool vtkStratusCheckArrays(vtkDataSetAttributes* data, vtkIdType count, const char* things, std::string& error);

// False where a cell names a point that is not in 0..points - 1, or where the cells are not one run after the other through their list of
// points. first: the number of the first of these cells.
VTK_STRATUS_PRIVATE bool vtkStratusCheckCells(vtkCellArray* cells, vtkIdType first, vtkIdType points, std::string& error);

// The same of a grid, whose cells must have a type, and whose polyhedra faces, too.
VTK_STRATUS_PRIVATE bool vtkStratusCheckGrid(vtkUnstructuredGrid* grid, std::string& error);

// The same of a surface's vertices, lines, polygons and strips, and its arrays of points and cells.
VTK_STRATUS_PRIVATE bool vtkStratusCheckSurface(vtkPolyData* surface, std::string& error);

#endif
