// SPDX-License-Identifier: BSD-3-Clause
// Converts a file's data to the core's input: a regular grid of values, or a mesh.
#pragma once

#include <vtkDataSet.h>
#include <vtkImageData.h>
#include <vtkSmartPointer.h>

#include <string>
#include <vector>

class vtkDataArray;

namespace cli {

struct routed {
  vtkSmartPointer<vtkDataSet> image; // an image or a rectilinear grid, for the ray caster,
  // Further grids next to `image`, without overlap: the blocks of one volume. Each has the drawn array, of one type.
  std::vector<vtkSmartPointer<vtkDataSet>> blocks;
  vtkSmartPointer<vtkDataSet> grid; // or an unstructured or structured one, for the caster of tetrahedra
  std::string kind;                 // of the file's data, for people
  bool refined = false;             // whether image and blocks hold AMR, whose gradients are the grids' own
  std::string arrays;               // of composite data: the first part's arrays, since `grid` has only the drawn one
};

// The one place that decides how a kind of data is drawn. Throws failure for data that are not drawn at all, with their kind.
// Composite data that consist only of images and rectilinear grids stay blocks. Other composite data become one grid, in which parts that
// meet share their points. AMR becomes blocks that hold its field. `array` is the name of the array that will be drawn, "" for the first.
// nearest, gradients: cell values of AMR are drawn as they are; its gradients are read.
routed route(vtkDataObject* data, const std::string& path, const std::string& array, bool nearest = false, bool gradients = false);

// Returns the array `name`. If the name is empty it returns the active scalars, or else the first array of one component, or else the
// lengths of the first vectors. Points come before cells. Of vectors, the lengths are added to the data set and returned, or the component
// that "NAME.x", "NAME.y" or "NAME.z" names.
vtkDataArray* choose_array(vtkDataSet* data_set, const std::string& name, bool& on_cells);
} // namespace cli
