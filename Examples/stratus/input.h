// SPDX-License-Identifier: BSD-3-Clause
// An image file, or a scene of record, as the core's view of a volume.
#pragma once

#include "support.h"

#include <vtkImageData.h>
#include <vtkSmartPointer.h>

class vtkDataArray;

namespace cli {

// Reads any file of an image or an unstructured grid that VTK reads, and TetGen's. Whatever VTK complains about while it reads is a
// failure: half a picture is none.
vtkSmartPointer<vtkDataObject> read_data(const std::string& path);
// A file of TetGen's, by its name: .node, .ele, .face, .edge, .neigh.
bool is_tetgen(const std::string& path);
// What read_data() does, of an image.
vtkSmartPointer<vtkImageData> read_image(const std::string& path);

// The array to draw: `name`, or where it is empty the active scalars, else the first array of one component; points before cells.
vtkDataArray* choose_array(vtkDataSet* data_set, const std::string& name, bool& on_cells);

// Borrows the array's values. A sheet (an axis with one point) gets the thickness of a cell, or there would be nothing to see.
stratus_volume view_of(vtkImageData* image, vtkDataArray* array, bool on_cells);

// STRATUS_..., and false for what the core has no type for (bits, strings).
bool stratus_type_of(vtkDataArray* array, stratus_type& type);
const char* name_of(stratus_type type);
// Size, type and spacing in one line.
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
