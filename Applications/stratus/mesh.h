// SPDX-License-Identifier: BSD-3-Clause
// Reads a file of an unstructured grid as the core's view of tetrahedra.
#pragma once

#include "options.h"
#include "support.h"
#include "transfer.h"

#include "vtkStratusMeshView.h"

#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

namespace cli {

// Reads the first step of a file as an unstructured grid, and fails for other data.
vtkSmartPointer<vtkUnstructuredGrid> read_grid(const std::string& path);

// A grid's cells divided into tetrahedra, with the values of the array to draw.
class VTK_STRATUS_PRIVATE mesh
{
public:
  // Replaces the grid. Unchanged parts are kept. choose_array() chooses the array.
  void set(vtkDataSet* grid, const options& o);
  const stratus_mesh& view() const { return this->View.GetMesh(); }
  vtkIdType ignored() const { return this->View.GetLeftOut(); }
  // Returns the grid's values to guess an opacity from: those of a structured grid in their order, with the world lengths along its
  // columns, and others in no spatial order, without the last few. up: the axis of heights in the world, -1: away from its middle.
  look_input values(int up) const;
  // Returns a volume of the grid's size, whose values have no spatial order.
  stratus_volume box() const;
  // Returns a volume of the grid's size, all of which counts as shown, to place a camera by.
  stratus_volume outline() const;

  std::string array_name;
  vtkIdType points = 0; // of the grid

private:
  vtkStratusMeshView View;
};
} // namespace cli
