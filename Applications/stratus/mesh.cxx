// SPDX-License-Identifier: BSD-3-Clause
#include "mesh.h"

#include "input.h"
#include "reading.h"

#include "vtkStratusArrays.h"

#include <vtkDataArray.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace {
constexpr size_t header = 1024; // a legacy file names its data set type within these bytes
}

namespace cli {

bool is_grid(const std::string& path)
{
  const size_t dot = path.find_last_of('.');
  std::string extension = dot == std::string::npos ? "" : path.substr(dot);
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".vtu" || extension == ".pvtu" || is_tetgen(path)) {
    return true;
  }
  if (extension != ".vtk") {
    return false;
  }
  const reading watched(path, "the look for its kind");
  std::ifstream file(path, std::ios::binary);
  std::string begin(header, ' ');
  file.read(&begin[0], static_cast<std::streamsize>(begin.size()));
  return begin.find("UNSTRUCTURED_GRID") != std::string::npos;
}

vtkSmartPointer<vtkUnstructuredGrid> read_grid(const std::string& path)
{
  const vtkSmartPointer<vtkDataObject> data = read_data(path);
  vtkUnstructuredGrid* grid = vtkUnstructuredGrid::SafeDownCast(data);
  if (!grid) {
    throw failure("'" + path + "' holds " + (data ? data->GetClassName() : "nothing") + ", not an unstructured grid");
  }
  std::string error;
  if (!vtkStratusCheckGrid(grid, error)) {
    throw failure("'" + path + "': " + error);
  }
  return grid;
}

mesh::mesh(vtkUnstructuredGrid* grid, const std::string& array, const std::string& path)
{
  if (grid->GetNumberOfCells() < 1) {
    throw failure("'" + path + "' holds no cells, only " + std::to_string(grid->GetNumberOfPoints()) + " points; there is nothing to draw");
  }
  bool on_cells = false;
  vtkDataArray* values = choose_array(grid, array, on_cells);
  this->array_name = values->GetName() ? values->GetName() : "(unnamed)";
  std::string error;
  if (!this->View.Set(grid, values, on_cells, nullptr, error)) {
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
} // namespace cli
