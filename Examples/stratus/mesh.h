// SPDX-License-Identifier: BSD-3-Clause
// A file of an unstructured grid as the core's view of tetrahedra.
#pragma once

#include "support.h"

#include "vtkStratusMeshView.h"

#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

namespace cli {

// A file that says so by its name (.vtu, .pvtu, TetGen's .node, .ele ...) or its first lines (.vtk).
bool is_grid(const std::string& path);
vtkSmartPointer<vtkUnstructuredGrid> read_grid(const std::string& path);

// The grid's cells divided into tetrahedra, with the values of the array to draw.
class VTK_STRATUS_PRIVATE mesh
{
public:
  // array: its name, or where it is empty the one that choose_array() finds.
  mesh(vtkUnstructuredGrid* grid, const std::string& array, const std::string& path);
  const stratus_mesh& view() const { return this->View.GetMesh(); }
  vtkIdType ignored() const { return this->View.GetLeftOut(); }
  // The values in a box of the grid's size, for who asks how often values come and how long rays are, not where: all but the last few.
  stratus_volume box() const;

  std::string array_name;

private:
  vtkStratusMeshView View;
};
} // namespace cli
