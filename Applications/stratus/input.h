// SPDX-License-Identifier: BSD-3-Clause
// Reads an image file or a rectilinear grid, or makes a scene of record, as the core's view of a volume.
#pragma once

#include "formats.h"
#include "route.h"
#include "support.h"

#include <vector>

class vtkRectilinearGrid;

namespace cli {

// Reads the first step of any file that series reads, which says what the others are.
vtkSmartPointer<vtkDataObject> read_data(const std::string& path, const reading_options& reading = {});
// Reads an image as read_data() does, and fails for other data.
vtkSmartPointer<vtkImageData> read_image(const std::string& path, const reading_options& reading = {});

// Borrows the array's values. A sheet (an image with one point along an axis) gets the thickness of a cell, because it would be invisible
// otherwise.
stratus_volume view_of(vtkImageData* image, vtkDataArray* array, bool on_cells);
// The same of a rectilinear grid, whose coordinates are kept in `coordinates`. The view's spacing is the mean one.
stratus_volume view_of(vtkRectilinearGrid* grid, vtkDataArray* array, bool on_cells, std::vector<double> coordinates[3]);

// Finds the core's type. Returns false where there is none (bits, strings).
bool stratus_type_of(vtkDataArray* array, stratus_type& type);
const char* name_of(stratus_type type);
// Describes size, type and spacing in one line.
std::string describe(const stratus_volume& volume);

// Returns whether `source` names a scene and no file. Throws failure for a bare word that is neither.
bool is_scene(const std::string& source);

class input
{
public:
  input(context& core, const std::string& source, const reading_options& reading);
  // Takes an image or a rectilinear grid that was read from the file `source`.
  input(context& core, const std::string& source, vtkDataSet* image, const std::string& array);
  ~input();
  input(const input&) = delete;
  input& operator=(const input&) = delete;

  stratus_volume volume;
  std::string array_name;
  vtkSmartPointer<vtkDataSet> image; // an image or a rectilinear grid; null for a scene
  stratus_scene* scene = nullptr;    // null for a file
  int up_axis = 2;

private:
  void set(vtkDataSet* from, const std::string& source, const std::string& array);

  context& Core;
  std::vector<double> Coordinates[3]; // of a rectilinear grid
};
} // namespace cli
