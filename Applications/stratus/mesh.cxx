// SPDX-License-Identifier: BSD-3-Clause
#include "mesh.h"

#include "input.h"

#include <vtkDataArray.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>

#include <algorithm>
#include <cmath>

namespace cli {

vtkSmartPointer<vtkUnstructuredGrid> read_grid(const std::string& path)
{
  const routed data = route(read_data(path), path, "");
  vtkUnstructuredGrid* grid = vtkUnstructuredGrid::SafeDownCast(data.grid);
  if (!grid) {
    throw failure("'" + path + "' holds " + data.kind + ", not an unstructured grid");
  }
  return grid;
}

void mesh::set(vtkDataSet* grid, const options& o)
{
  const std::string& path = o.source;
  if (grid->GetNumberOfCells() < 1) {
    throw failure("'" + path + "' holds no cells, only " + std::to_string(grid->GetNumberOfPoints()) + " points; there is nothing to draw");
  }
  bool on_cells = false;
  vtkDataArray* values = choose_array(grid, o.array, on_cells);
  this->array_name = values->GetName() ? values->GetName() : "(unnamed)";
  this->points = grid->GetNumberOfPoints();
  std::string error;
  vtkNew<vtkMatrix4x4> matrix;
  const int up = o.up.empty() ? 2 : o.up[0] - 'x';
  matrix->SetElement(up, up, o.exaggeration);
  if (!this->View.Set(grid, values, on_cells, matrix, error)) {
    throw failure("'" + path + "': " + error);
  }
}

stratus_volume mesh::box() const
{
  const stratus_mesh& m = this->view();
  stratus_volume box = this->View.GetBox();
  const int64_t count = m.cell_values ? m.cell_count : m.point_count;
  const auto side = std::max<int64_t>(static_cast<int64_t>(std::cbrt(static_cast<double>(count) + 0.5)), 1);
  box.values = m.values;
  box.type = m.type;
  box.value_stride = m.value_stride;
  box.cell_centered = 1;
  for (int a = 0; a < 3; ++a) {
    box.spacing[a] /= static_cast<double>(side);
    box.dimensions[a] = side;
  }
  return box;
}

stratus_volume mesh::outline() const
{
  static const uint8_t nothing[8] = {}; // of no value, so that the whole box counts as shown
  stratus_volume box = this->box();
  box.values = nothing;
  box.type = STRATUS_UINT8;
  box.value_stride = 1;
  for (int a = 0; a < 3; ++a) {
    box.spacing[a] *= static_cast<double>(box.dimensions[a]) / 2.0;
    box.dimensions[a] = 2;
  }
  return box;
}
} // namespace cli
