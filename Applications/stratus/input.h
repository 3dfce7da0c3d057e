// SPDX-License-Identifier: BSD-3-Clause
// Reads an image file, or makes a scene of record, as the core's view of a volume.
#pragma once

#include "support.h"

#include <vtkImageData.h>
#include <vtkSmartPointer.h>

class vtkDataArray;

namespace cli {

// Reads any image or unstructured grid that VTK reads, and TetGen's files. Any complaint of VTK is a failure, so that a damaged file is
// never drawn in part.
vtkSmartPointer<vtkDataObject> read_data(const std::string& path);
// Returns whether the name is that of a TetGen file: .node, .ele, .face, .edge, .neigh.
bool is_tetgen(const std::string& path);
// Reads an image as read_data() does, and fails for other data.
vtkSmartPointer<vtkImageData> read_image(const std::string& path);

// Returns the array `name`. If the name is empty it returns the active scalars, or else the first array of one component. Points come
// before cells.
vtkDataArray* choose_array(vtkDataSet* data_set, const std::string& name, bool& on_cells);

// Borrows the array's values. A sheet (an image with one point along an axis) gets the thickness of a cell, because it would be invisible
// otherwise.
stratus_volume view_of(vtkImageData* image, vtkDataArray* array, bool on_cells);

// Finds the core's type. Returns false where there is none (bits, strings).
bool stratus_type_of(vtkDataArray* array, stratus_type& type);
const char* name_of(stratus_type type);
// Describes size, type and spacing in one line.
std::string describe(const stratus_volume& volume);

class input
{
public:
  input(context& core, const std::string& source, const std::string& array);
  ~input();
  input(const input&) = delete;
  input& operator=(const input&) = delete;

  stratus_volume volume;
  std::string array_name;
  vtkSmartPointer<vtkImageData> image; // null for a scene
  stratus_scene* scene = nullptr;      // null for a file
  int up_axis = 2;

private:
  context& Core;
};
} // namespace cli
