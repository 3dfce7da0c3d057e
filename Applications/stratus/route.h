// SPDX-License-Identifier: BSD-3-Clause
// What a file holds, as what the core takes: a regular grid of values, or a mesh.
#pragma once

#include <vtkImageData.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include <string>

class vtkDataArray;
class vtkDataSet;

namespace cli {

struct routed {
  vtkSmartPointer<vtkImageData> image;       // for the ray caster,
  vtkSmartPointer<vtkUnstructuredGrid> grid; // or this one, for the caster of tetrahedra
  std::string kind;                          // of the file's data, for people
};

// The one place that decides how a kind of data is drawn. Throws failure for data that are not drawn at all, with their kind. Rectilinear
// and structured grids and composite data become one unstructured grid with the same points; parts that meet share their points.
routed route(vtkDataObject* data, const std::string& path);

// Returns the array `name`. If the name is empty it returns the active scalars, or else the first array of one component. Points come
// before cells.
vtkDataArray* choose_array(vtkDataSet* data_set, const std::string& name, bool& on_cells);
} // namespace cli
