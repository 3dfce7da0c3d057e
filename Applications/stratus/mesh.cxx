// SPDX-License-Identifier: BSD-3-Clause
#include "mesh.h"

#include "input.h"

#include <vtkDataArray.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

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

// Height of a point of a lattice. Only the axis of heights is stretched. up: -1: heights are distances from the middle.
static double height_of(const stratus_mesh& m, size_t point, int up)
{
  if (up < 0) {
    const auto at = [&](size_t axis) {
      return m.points ? m.points[3 * point + axis] : static_cast<double>(m.float_points[3 * point + axis]);
    };
    return std::hypot(at(0), at(1), at(2));
  }
  const double own = m.points ? m.points[3 * point + static_cast<size_t>(up)] : m.float_points[3 * point + static_cast<size_t>(up)];
  return own * m.matrix[5 * up];
}

// Orders the points of a mesh in layers by the columns that they are in, if all columns have as many points, and sets their values and
// lengths. Other meshes stay as they are.
static void set_columns(const stratus_mesh& m, int up, look_input& result)
{
  if (m.cell_values || !m.points || m.block_count > 0 || m.point_count < 2) {
    return;
  }
  const auto count = static_cast<size_t>(m.point_count);
  const size_t east = static_cast<size_t>((up + 1) % 3), north = static_cast<size_t>((up + 2) % 3);
  std::vector<size_t> order(count);
  std::iota(order.begin(), order.end(), size_t(0));
  const auto place = [&m](size_t point, size_t axis) { return m.points[3 * point + axis]; };
  const auto is_same = [&](size_t a, size_t b) { return place(a, east) == place(b, east) && place(a, north) == place(b, north); };
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    const double one[3] = { place(a, east), place(a, north), height_of(m, a, up) };
    const double other[3] = { place(b, east), place(b, north), height_of(m, b, up) };
    return std::lexicographical_compare(one, one + 3, other, other + 3);
  });
  size_t layers = 1;
  while (layers < count && is_same(order[0], order[layers])) {
    ++layers;
  }
  bool regular = layers > 1 && count % layers == 0;
  for (size_t i = 1; i < count && regular; ++i) {
    regular = is_same(order[i - 1], order[i]) == (i % layers != 0);
  }
  if (!regular) {
    return;
  }
  const size_t size = stratus_type_size(m.type);
  result.ordered.resize(count * size);
  result.thickness.resize(count);
  for (size_t i = 0; i < count; ++i) { // column i / layers, point i % layers of it; columns run fastest
    const size_t column = i / layers, layer = i % layers, at = column + layer * (count / layers);
    const auto* const from = static_cast<const unsigned char*>(m.values) + order[i] * static_cast<size_t>(m.value_stride) * size;
    std::copy_n(from, size, result.ordered.data() + at * size);
    const size_t below = layer > 0 ? i - 1 : i, above = layer + 1 < layers ? i + 1 : i;
    result.thickness[at] = 0.5 * std::fabs(height_of(m, order[above], up) - height_of(m, order[below], up));
  }
  result.unordered = false;
  stratus_volume& box = result.volumes[0];
  const int64_t dimensions[3] = { static_cast<int64_t>(count / layers), 1, static_cast<int64_t>(layers) };
  for (int a = 0; a < 3; ++a) { // with voxels as large as before, whose edge is the unit of opacity
    box.dimensions[a] = dimensions[a];
  }
  box.values = result.ordered.data();
  box.value_stride = 1;
}

// Makes a box as high as the mesh's points reach from the middle, of as large voxels as before, because a ray through a shell around the
// Earth meets its thickness, and not the Earth's.
static void set_shell(const stratus_mesh& m, stratus_volume& box)
{
  double least = INFINITY, most = 0.0;
  for (size_t point = 0; point < static_cast<size_t>(m.point_count); ++point) {
    const double height = height_of(m, point, -1);
    least = std::min(least, height);
    most = std::max(most, height);
  }
  if (most > least) {
    const double before = box.spacing[2];
    box.spacing[2] = (most - least) / static_cast<double>(box.dimensions[2]);
    box.spacing[0] *= before / box.spacing[2];
  }
}

look_input mesh::values(int up) const
{
  const stratus_mesh& m = this->view();
  look_input result;
  result.volumes.push_back(this->box());
  result.unordered = m.lattice[0] == 0;
  if (result.unordered && up < 0) {
    set_shell(m, result.volumes[0]);
    return result;
  }
  if (result.unordered) {
    set_columns(m, up, result);
    return result;
  }
  stratus_volume& box = result.volumes[0];
  for (int a = 0; a < 3; ++a) {
    const double extent = box.spacing[a] * static_cast<double>(box.dimensions[a]);
    box.dimensions[a] = m.lattice[a] - (m.cell_values ? 1 : 0);
    box.spacing[a] = extent / static_cast<double>(box.dimensions[a]);
  }
  const int64_t* n = box.dimensions;
  const size_t layer = static_cast<size_t>(m.lattice[0]) * static_cast<size_t>(m.lattice[1]);
  result.thickness.reserve(static_cast<size_t>(n[0] * n[1] * n[2]));
  for (int64_t k = 0; k < n[2]; ++k) {
    // From the layer of points below to the one above; points at an end have half a layer.
    const int64_t below = m.cell_values ? k : std::max<int64_t>(k - 1, 0),
                  above = m.cell_values ? k + 1 : std::min<int64_t>(k + 1, n[2] - 1);
    for (int64_t j = 0; j < n[1]; ++j) {
      for (int64_t i = 0; i < n[0]; ++i) {
        const size_t place = static_cast<size_t>(i + m.lattice[0] * j);
        const double length =
          height_of(m, place + static_cast<size_t>(above) * layer, up) - height_of(m, place + static_cast<size_t>(below) * layer, up);
        result.thickness.push_back((m.cell_values ? 1.0 : 0.5) * std::fabs(length));
      }
    }
  }
  return result;
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
