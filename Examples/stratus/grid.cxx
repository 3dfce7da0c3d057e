// SPDX-License-Identifier: BSD-3-Clause
#include "grid.h"

#include "camera.h"
#include "frame.h"
#include "input.h"
#include "transfer.h"

#include <vtkCellTypes.h>
#include <vtkDataArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

namespace {

constexpr size_t header = 1024; // a legacy file names its data set within this

// A mesh and what it borrows from.
struct mesh {
  std::vector<double> points;
  std::vector<int32_t> vertices;
  vtkSmartPointer<vtkDataObject> data;
  std::string array_name;
  stratus_mesh view = stratus_mesh_default();
  double bounds[6] = { 0, 0, 0, 0, 0, 0 };
};

void copy_cells(vtkUnstructuredGrid* grid, mesh& result)
{
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell) {
    const int type = grid->GetCellType(cell);
    grid->GetCellPoints(cell, ids);
    if (type != VTK_TETRA || ids->GetNumberOfIds() != 4) {
      throw cli::failure("cell " + std::to_string(cell) + " is a " + vtkCellTypes::GetClassNameFromTypeId(type) +
        "; only tetrahedra (vtkTetra) are drawn");
    }
    for (int i = 0; i < 4; ++i) {
      if (ids->GetId(i) < 0 || ids->GetId(i) >= grid->GetNumberOfPoints()) {
        throw cli::failure("cell " + std::to_string(cell) + " names point " + std::to_string(ids->GetId(i)) + ", outside 0.." +
          std::to_string(grid->GetNumberOfPoints() - 1));
      }
      result.vertices.push_back(static_cast<int32_t>(ids->GetId(i)));
    }
  }
}

void read_mesh(const std::string& path, const std::string& array, mesh& result)
{
  result.data = cli::read_data(path);
  vtkUnstructuredGrid* grid = vtkUnstructuredGrid::SafeDownCast(result.data);
  if (!grid) {
    throw cli::failure("'" + path + "' holds " + (result.data ? result.data->GetClassName() : "nothing") + ", not an unstructured grid");
  }
  if (grid->GetNumberOfCells() < 1 || grid->GetNumberOfPoints() > INT32_MAX) {
    throw cli::failure("'" + path + "' holds " + std::to_string(grid->GetNumberOfCells()) + " cells and " +
      std::to_string(grid->GetNumberOfPoints()) + " points; at least one cell and at most 2^31-1 points are drawn");
  }
  bool on_cells = false;
  vtkDataArray* values = cli::choose_array(grid, array, on_cells);
  result.array_name = values->GetName() ? values->GetName() : "(unnamed)";
  copy_cells(grid, result);
  result.points.resize(3 * static_cast<size_t>(grid->GetNumberOfPoints()));
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
    grid->GetPoint(i, &result.points[3 * static_cast<size_t>(i)]);
  }
  grid->GetBounds(result.bounds);
  stratus_mesh& view = result.view;
  view.points = result.points.data();
  view.point_count = grid->GetNumberOfPoints();
  view.vertices = result.vertices.data();
  view.cell_count = grid->GetNumberOfCells();
  view.values = values->GetVoidPointer(0);
  view.cell_values = on_cells ? 1 : 0;
  if (!cli::stratus_type_of(values, view.type)) {
    throw cli::failure("array '" + result.array_name + "' holds " + values->GetDataTypeAsString() + " values; numbers of 8 to 64 bits are drawn");
  }
}

// The mesh's values in a box of its size, for who asks how often values come and how long rays are, not where: all but the last few.
stratus_volume box_of(const mesh& m)
{
  stratus_volume box = stratus_volume_default();
  const int64_t count = m.view.cell_values ? m.view.cell_count : m.view.point_count;
  const auto side = static_cast<int64_t>(std::cbrt(static_cast<double>(count) + 0.5));
  box.values = m.view.values;
  box.type = m.view.type;
  box.cell_centered = 1;
  for (int a = 0; a < 3; ++a) {
    const double width = m.bounds[2 * a + 1] - m.bounds[2 * a];
    box.dimensions[a] = std::max<int64_t>(side, 1);
    box.origin[a] = m.bounds[2 * a];
    box.spacing[a] = (width > 0.0 ? width : 1e-30) / static_cast<double>(box.dimensions[a]);
  }
  return box;
}

// What only regular grids have is told, not ignored.
void refuse_options(const cli::options& o)
{
  if (o.mode != STRATUS_MODE_COMPOSITE || o.structure != STRATUS_STRUCTURE_AUTO || o.sampling != STRATUS_SAMPLING_AUTO || o.nearest || o.audit ||
    o.sample_distance != 0.0) {
    throw cli::usage("'" + o.source + "' is an unstructured grid: first hits, structure, sampling, interpolation, sample distance and audit are for images");
  }
}
} // namespace

namespace cli {

bool is_grid(const std::string& path)
{
  const size_t dot = path.find_last_of('.');
  std::string extension = dot == std::string::npos ? "" : path.substr(dot);
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".vtu" || extension == ".pvtu") {
    return true;
  }
  if (extension != ".vtk") {
    return false;
  }
  std::ifstream file(path, std::ios::binary);
  std::string begin(header, ' ');
  file.read(&begin[0], static_cast<std::streamsize>(begin.size()));
  return begin.find("UNSTRUCTURED_GRID") != std::string::npos;
}

void render_grid(const options& o)
{
  refuse_options(o);
  context core("host", o.threads);
  mesh m;
  read_mesh(o.source, o.array, m);
  core.check(stratus_mesh_check(core, &m.view), "'" + o.source + "'");
  frame picture(o);
  stratus_volume box = box_of(m);
  const transfer look = make_transfer(box, nullptr, o.opacity, o.color, o.unit_distance);
  const stratus_transfer view = look.view();
  core.check(stratus_transfer_check(core, &view), "transfer function");
  const uint8_t nothing[8] = {}; // what of the box shows says nothing of the mesh: all of it is looked at
  box.values = nothing;
  box.type = STRATUS_UINT8;
  for (int a = 0; a < 3; ++a) {
    box.spacing[a] *= static_cast<double>(box.dimensions[a]) / 2.0;
    box.dimensions[a] = 2;
  }
  const stratus_camera camera = place_camera(core, o, box, view, o.up.empty() ? 2 : o.up[0] - 'x');
  output_file out(o.output); // before the work: a path that cannot be written is told at once

  stratus_image image = picture.view();
  stratus_tetra_report report = {};
  stratus_tetra_caster* caster = nullptr;
  core.check(stratus_tetra_caster_create(core, &caster), "caster of tetrahedra");
  const stratus_status status = stratus_tetra_caster_render(caster, &m.view, &view, &camera, nullptr, &image, &report);
  stratus_tetra_caster_destroy(caster);
  core.check(status, "render");

  std::printf("%s\n", o.source.c_str());
  row("mesh",
    grouped(static_cast<unsigned long long>(report.cells)) + " tetrahedra, " +
      grouped(static_cast<unsigned long long>(m.view.point_count)) + " points, array '" + m.array_name + "' on " +
      (m.view.cell_values ? "cells" : "points"));
  row("camera", describe(camera));
  row("opacity", look.origin);
  row("device", stratus_context_device(core));
  row("build", format("%.2f ms: cells and border %.2f, table %.2f", report.build_ms + report.table_ms, report.build_ms, report.table_ms));
  row("frame",
    format("%.2f ms for %d x %d pixels, %s rays met the mesh", report.transform_ms + report.entries_ms + report.march_ms, o.width, o.height,
      grouped(report.rays).c_str()));
  row("cells passed", grouped(report.segments) + ", in from outside " + grouped(report.entries) + " times");
  row("flat", grouped(static_cast<unsigned long long>(report.flat)) + " cells have no volume");
  if (image.samples) {
    row("a pixel", picture.describe_samples());
  }
  picture.write(out);
  out.commit();
  row("picture", o.output);
}
} // namespace cli
