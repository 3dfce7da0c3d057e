// SPDX-License-Identifier: BSD-3-Clause
// `stratus info` of an unstructured grid: its cells, points and arrays, the quality of the tetrahedra into which it is divided, and what
// `stratus render` would draw.
#include "grid.h"

#include "input.h"
#include "mesh.h"
#include "transfer.h"

#include "vtkStratusTetrahedra.h"
#include "vtkStratusVersions.h"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace {

std::string count(vtkIdType number)
{
  return cli::grouped(static_cast<unsigned long long>(number));
}

void print_cells(vtkDataSet* grid)
{
  std::array<vtkIdType, 256> of_type = {};
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell) {
    ++of_type[static_cast<size_t>(grid->GetCellType(cell)) % of_type.size()];
  }
  for (size_t type = 0; type < of_type.size(); ++type) {
    if (of_type[type] > 0) {
      cli::row("", count(of_type[type]) + " " + vtkStratusNameOfCellType(static_cast<int>(type)) + cli::format(" (%zu)", type));
    }
  }
}

void print_array(const char* where, vtkAbstractArray* array)
{
  std::string text = cli::format("'%s', %s, %d component%s", array->GetName() ? array->GetName() : "", array->GetDataTypeAsString(),
    array->GetNumberOfComponents(), array->GetNumberOfComponents() == 1 ? "" : "s");
  std::vector<double> range;
  vtkDataArray* numbers = vtkDataArray::SafeDownCast(array);
  if (numbers && numbers->GetNumberOfComponents() == 1 && numbers->GetNumberOfTuples() > 0) {
    double low = INFINITY, high = -INFINITY;
    vtkIdType not_finite = 0;
    for (vtkIdType i = 0; i < numbers->GetNumberOfTuples(); ++i) {
      const double value = numbers->GetComponent(i, 0);
      low = std::isfinite(value) ? std::min(low, value) : low;
      high = std::isfinite(value) ? std::max(high, value) : high;
      not_finite += std::isfinite(value) ? 0 : 1;
    }
    text += low <= high ? cli::format(", %.9g .. %.9g", low, high) : std::string();
    range = low <= high ? std::vector<double>{ low, high } : std::vector<double>();
    text += not_finite > 0 ? ", " + count(not_finite) + " not finite" : std::string();
  }
  cli::row(where, text, range);
}

void print_arrays(vtkDataSet* grid)
{
  for (bool cells : { false, true }) {
    vtkDataSetAttributes* data = cells ? static_cast<vtkDataSetAttributes*>(grid->GetCellData()) : grid->GetPointData();
    for (int i = 0; i < data->GetNumberOfArrays(); ++i) {
      print_array(cells ? "cell array" : "point array", data->GetAbstractArray(i));
    }
  }
}

// Draws a picture whose only purpose is its report.
stratus_tetra_report draw(
  const cli::context& core, const stratus_mesh& mesh, const stratus_transfer& transfer, const stratus_camera& camera, int width, int height)
{
  std::vector<float> pixels(4 * static_cast<size_t>(width) * static_cast<size_t>(height));
  stratus_image image = {};
  image.width = width;
  image.height = height;
  image.rgba = pixels.data();
  stratus_tetra_report report = {};
  stratus_tetra_caster* caster = nullptr;
  core.check(stratus_tetra_caster_create(core, &caster), "caster of tetrahedra");
  const stratus_status status = stratus_tetra_caster_render(caster, &mesh, &transfer, &camera, nullptr, &image, &report);
  stratus_tetra_caster_destroy(caster);
  core.check(status, "look at the tetrahedra");
  return report;
}

// Draws a single pixel, because the report on the mesh does not depend on the picture.
stratus_tetra_report look_at(const cli::context& core, const stratus_mesh& mesh)
{
  const double opacity[4] = { 0.0, 0.0, 1.0, 1.0 }, color[4] = { 0.0, 1.0, 1.0, 1.0 };
  stratus_transfer transfer = stratus_transfer_default();
  transfer.opacity = opacity;
  transfer.opacity_count = 2;
  transfer.color = color;
  transfer.color_count = 1;
  stratus_camera camera = {};
  camera.forward[2] = camera.right[0] = camera.up[1] = 1.0;
  camera.far_k = INFINITY;
  camera.parallel = 1;
  return draw(core, mesh, transfer, camera, 1, 1);
}

void print_tetrahedra(const cli::context& core, vtkUnstructuredGrid* grid)
{
  vtkStratusTetrahedra parts;
  std::string error;
  if (!parts.Set(grid, error)) {
    cli::row("tetrahedra", "none: " + error);
    return;
  }
  stratus_mesh mesh = parts.GetMesh();
  std::vector<bool> used(static_cast<size_t>(mesh.point_count));
  for (int32_t point : parts.Vertices) {
    used[static_cast<size_t>(point)] = true;
  }
  vtkIdType unused = 0;
  for (vtkIdType point = 0; point < parts.GridPoints; ++point) {
    unused += used[static_cast<size_t>(point)] ? 0 : 1;
  }
  const std::vector<uint8_t> values(static_cast<size_t>(mesh.cell_count) + 1, 0); // all 0: the report on the mesh does not depend on values
  mesh.values = values.data();
  mesh.type = STRATUS_UINT8;
  mesh.cell_values = 1;
  core.check(stratus_mesh_check(core, &mesh), "the grid");
  const stratus_tetra_report report = look_at(core, mesh);
  cli::row("tetrahedra",
    count(report.cells) + (parts.CellByCell ? ", the cells themselves; " : " that the cells are divided into; ") + count(parts.LeftOut) +
      " vertices, lines and polygons ignored");
  cli::row("border", count(report.border_faces) + " faces");
  cli::row("shape",
    count(report.flat) + " without volume, " + count(report.inverted) + " of negative orientation, " + count(report.folded_faces) +
      " faces folded, " + count(report.broken_faces) + " shared by more than two");
  cli::row("unused", count(unused) + " points");
}
} // namespace

void cli::print_grid(const options& o, vtkDataSet* grid)
{
  context core(o.device, o.threads);
  double b[6] = { 0, 0, 0, 0, 0, 0 };
  row("grid", count(grid->GetNumberOfCells()) + " cells, " + count(grid->GetNumberOfPoints()) + " points",
    { static_cast<double>(grid->GetNumberOfCells()), static_cast<double>(grid->GetNumberOfPoints()) });
  vtkUnstructuredGrid* const listed = vtkUnstructuredGrid::SafeDownCast(grid);
  if (listed) {
    print_cells(listed);
  }
  if (grid->GetNumberOfPoints() > 0) {
    grid->GetBounds(b);
    row("bounds", format("%.10g .. %.10g, %.10g .. %.10g, %.10g .. %.10g", b[0], b[1], b[2], b[3], b[4], b[5]),
      std::vector<double>(b, b + 6));
  }
  print_arrays(grid);
  if (listed) {
    print_tetrahedra(core, listed);
  }
  row("memory", format("%.1f MiB", static_cast<double>(grid->GetActualMemorySize()) / 1024.0));
  try {
    mesh m;
    m.set(grid, o);
    core.check(stratus_mesh_check(core, &m.view()), "'" + o.source + "'");
    const transfer look = make_transfer(core, m.values(o.up.empty() ? 2 : o.up[0] - 'x'), nullptr, o);
    const stratus_transfer view = look.view();
    core.check(stratus_transfer_check(core, &view), "transfer function");
    const stratus_tetra_report report = draw(core, m.view(), view, place_camera(core, o, m, view), o.width, o.height);
    row("drawn",
      "'" + m.array_name + "' on " + (m.view().cell_values ? "cells" : "points") + ", " + count(report.shown_cells) + " of " +
        count(report.cells) + " tetrahedra" +
        (report.shown_cells < report.cells ? ", the others hidden or with values that are not finite" : ""));
    row("opacity", look.origin);
    row("method", report.why + format(", at %d x %d pixels", o.width, o.height));
  } catch (const failure& reason) {
    if (!o.array.empty()) { // the user chose this array
      throw;
    }
    row("drawn", std::string("nothing: ") + reason.what());
  }
}
