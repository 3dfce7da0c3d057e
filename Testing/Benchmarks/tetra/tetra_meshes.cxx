// SPDX-License-Identifier: BSD-3-Clause
// The built-in meshes, their transfer functions and their views.
#include "input.h"
#include "tetra_bench.h"

#ifdef STRATUS_BENCH_TETGEN
#include "vtkStratusTetGenFilter.h"
#endif

#include <vtkCellArray.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

namespace bench {

namespace {

using scene_pointer = std::unique_ptr<stratus_mesh_scene, std::function<void(stratus_mesh_scene*)>>;

scene_pointer make_scene_mesh(stratus_context* context, const char* name)
{
  stratus_mesh_scene* scene = nullptr;
  if (stratus_mesh_scene_create(context, name, &scene) != STRATUS_OK) {
    throw failure(stratus_context_message(context));
  }
  return scene_pointer(scene, [context](stratus_mesh_scene* s) { stratus_mesh_scene_destroy(context, s); });
}

vtkSmartPointer<vtkUnstructuredGrid> make_listed(stratus_context* context, const char* name)
{
  const scene_pointer scene = make_scene_mesh(context, name);
  const stratus_mesh& mesh = scene->mesh;
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> values;
  points->SetDataTypeToDouble();
  values->SetName("value");
  for (int64_t i = 0; i < mesh.point_count; ++i) {
    points->InsertNextPoint(mesh.points + 3 * i);
    values->InsertNextValue(static_cast<const float*>(mesh.values)[i]);
  }
  grid->SetPoints(points);
  grid->GetPointData()->SetScalars(values);
  grid->Allocate(mesh.cell_count);
  for (int64_t c = 0; c < mesh.cell_count; ++c) {
    const vtkIdType ids[4] = { mesh.vertices[4 * c], mesh.vertices[4 * c + 1], mesh.vertices[4 * c + 2], mesh.vertices[4 * c + 3] };
    grid->InsertNextCell(VTK_TETRA, 4, ids);
  }
  return grid;
}

#ifdef STRATUS_BENCH_TETGEN
vtkSmartPointer<vtkUnstructuredGrid> fill_holes(stratus_context* context)
{
  const scene_pointer scene = make_scene_mesh(context, "holes");
  vtkNew<vtkPolyData> surface;
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> faces;
  points->SetDataTypeToDouble();
  for (int64_t i = 0; i < scene->mesh.point_count; ++i) {
    points->InsertNextPoint(scene->mesh.points + 3 * i);
  }
  for (int64_t q = 0; q < scene->quad_count; ++q) {
    const int32_t* v = scene->quads + 4 * q;
    const vtkIdType ids[4] = { v[0], v[1], v[2], v[3] };
    faces->InsertNextCell(4, ids);
  }
  surface->SetPoints(points);
  surface->SetPolys(faces);
  vtkNew<vtkStratusTetGenFilter> filter;
  filter->SetInputData(surface);
  filter->SetRadiusEdgeRatio(1.4);
  filter->SetMaximumVolume(scene->maximum_volume);
  filter->SetTimeLimit(600.0);
  filter->Update();
  vtkSmartPointer<vtkUnstructuredGrid> grid = filter->GetOutput();
  if (grid->GetNumberOfCells() == 0) {
    throw failure("TetGen filled nothing");
  }
  vtkNew<vtkFloatArray> values;
  values->SetName("value");
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
    double p[3];
    grid->GetPoint(i, p);
    values->InsertNextValue(static_cast<float>(stratus_mesh_scene_value("holes", p)));
  }
  grid->GetPointData()->Initialize();
  grid->GetPointData()->SetScalars(values);
  return grid;
}

vtkSmartPointer<vtkUnstructuredGrid> make_holes(stratus_context* context, const std::string& cache)
{
  const std::string path = cache + "/holes.vtu";
  if (!cache.empty() && std::ifstream(path)) {
    return vtkUnstructuredGrid::SafeDownCast(cli::read_data(path));
  }
  std::fprintf(stderr, "  TetGen fills the plate\n");
  vtkSmartPointer<vtkUnstructuredGrid> grid = fill_holes(context);
  if (!cache.empty()) {
    vtkNew<vtkXMLUnstructuredGridWriter> writer;
    writer->SetFileName(path.c_str());
    writer->SetInputData(grid);
    if (writer->Write() != 1 || writer->GetErrorCode() != 0) {
      throw failure("cannot write " + path);
    }
  }
  return grid;
}
#endif

vtkSmartPointer<vtkUnstructuredGrid> read_grid(const std::string& path)
{
  const vtkSmartPointer<vtkDataObject> data = cli::read_data(path);
  vtkSmartPointer<vtkUnstructuredGrid> grid = vtkUnstructuredGrid::SafeDownCast(data);
  bool on_cells = false;
  vtkDataArray* array = grid ? cli::choose_array(grid, "", on_cells) : nullptr;
  if (!array || on_cells) {
    throw failure("'" + path + "' is not an unstructured grid with point scalars");
  }
  grid->GetPointData()->SetActiveScalars(array->GetName());
  return grid;
}

std::string stem_of(const std::string& path)
{
  const size_t from = path.find_last_of('/') == std::string::npos ? 0 : path.find_last_of('/') + 1;
  return path.substr(from, path.find_last_of('.') - from);
}

// Copies the grid to the core's form.
void copy_arrays(tetra_mesh& mesh)
{
  vtkDataArray* scalars = mesh.grid->GetPointData()->GetScalars();
  const vtkIdType count = mesh.grid->GetNumberOfPoints();
  mesh.points.resize(3 * static_cast<size_t>(count));
  mesh.values.resize(static_cast<size_t>(count));
  for (vtkIdType i = 0; i < count; ++i) {
    mesh.grid->GetPoint(i, mesh.points.data() + 3 * i);
    mesh.values[static_cast<size_t>(i)] = static_cast<float>(scalars->GetComponent(i, 0));
  }
  for (vtkIdType c = 0; c < mesh.grid->GetNumberOfCells(); ++c) {
    vtkIdType size = 0;
    const vtkIdType* ids = nullptr;
    mesh.grid->GetCellPoints(c, size, ids);
    if (mesh.grid->GetCellType(c) != VTK_TETRA) {
      throw failure(mesh.name + ": cell " + std::to_string(c) + " is no tetrahedron");
    }
    for (int v = 0; v < 4; ++v) {
      mesh.vertices.push_back(static_cast<int32_t>(ids[v]));
    }
  }
  mesh.grid->GetBounds(mesh.bounds);
}
} // namespace

stratus_mesh tetra_mesh::view() const
{
  stratus_mesh m = stratus_mesh_default();
  m.points = this->points.data();
  m.point_count = static_cast<int64_t>(this->points.size() / 3);
  m.vertices = this->vertices.data();
  m.cell_count = static_cast<int64_t>(this->vertices.size() / 4);
  m.values = this->values.data();
  m.type = STRATUS_FLOAT32;
  return m;
}

bool make_tetra_mesh(stratus_context* context, const std::string& source, const std::string& cache, tetra_mesh& mesh)
{
  mesh.name = stem_of(source);
  if (source == "estuary" || source == "wavelet") {
    mesh.grid = make_listed(context, source.c_str());
  } else if (source == "holes") {
#ifdef STRATUS_BENCH_TETGEN
    mesh.grid = make_holes(context, cache);
#else
    (void)cache;
    std::fprintf(stderr, "holes is LEFT OUT: this program was built without TetGen\n");
    return false;
#endif
  } else if (source == "bluntfin" || source == "post") {
    const std::string path = "../shared/data/" + source + ".vtu";
    if (!std::ifstream(path)) {
      std::fprintf(stderr, "%s is LEFT OUT: %s is not here\n", source.c_str(), path.c_str());
      return false;
    }
    mesh.grid = read_grid(path);
  } else {
    mesh.grid = read_grid(source);
  }
  copy_arrays(mesh);
  return true;
}

const std::vector<std::string>& tetra_functions()
{
  static const std::vector<std::string> names = { "ramp", "peaks", "opaque" };
  return names;
}

transfer tetra_transfer(const tetra_mesh& mesh, const std::string& function)
{
  static const double peaks[11][5] = { { 0, .2, .2, 1, 0 }, { .10, .1, .6, 1, .03 }, { .18, .1, 1, .8, .02 }, { .22, .2, 1, .4, .95 },
    { .26, .4, 1, .2, .02 }, { .5, 1, 1, 0, .05 }, { .56, 1, .8, 0, .02 }, { .60, 1, .6, 0, .95 }, { .64, 1, .4, 0, .02 },
    { .85, 1, .2, 0, .1 }, { 1, 1, 0, .2, .6 } };
  std::vector<float> sorted = mesh.values;
  std::sort(sorted.begin(), sorted.end());
  const auto quantile = [&](double part) {
    return static_cast<double>(sorted[static_cast<size_t>(part * static_cast<double>(sorted.size() - 1))]);
  };
  const double* b = mesh.bounds;
  const double radius = 0.5 * std::hypot(b[1] - b[0], b[3] - b[2], b[5] - b[4]);
  transfer t;
  t.unit_distance = radius / (function == "opaque" ? 150.0 : 8.0);
  if (function == "ramp") {
    const double lo = quantile(0.0), hi = quantile(1.0);
    t.opacity = { lo, .05, hi, .9 };
    t.color = { lo, 0, 0, 1, hi, 1, .8, 0 };
    return t;
  }
  const double lo = quantile(.02), hi = quantile(.98);
  for (const auto& p : peaks) {
    const double x = lo + p[0] * (hi - lo);
    t.opacity.insert(t.opacity.end(), { x, p[4] });
    t.color.insert(t.color.end(), { x, p[1], p[2], p[3] });
  }
  return t;
}

std::vector<stratus_camera> order_cameras(stratus_context* context, const tetra_mesh& mesh)
{
  static const double directions[6][3] = { { 1, 0, 0 }, { 0, -1, 0 }, { 0, 0, 1 }, { .7, .5, .42 }, { -.8, .3, .42 }, { -.2, -.9, -.35 } };
  const double* b = mesh.bounds;
  const double radius = 0.5 * std::hypot(b[1] - b[0], b[3] - b[2], b[5] - b[4]);
  const double middle[3] = { .5 * (b[0] + b[1]), .5 * (b[2] + b[3]), .5 * (b[4] + b[5]) };
  std::vector<stratus_camera> cameras;
  for (const auto& d : directions) {
    const double up[3] = { 0, std::abs(d[2]) == 1.0 ? 1.0 : 0.0, std::abs(d[2]) == 1.0 ? 0.0 : 1.0 };
    const double length = std::hypot(d[0], d[1], d[2]);
    const auto eye_at = [&](double distance, double* eye) {
      for (int a = 0; a < 3; ++a) {
        eye[a] = middle[a] + distance * radius * d[a] / length;
      }
    };
    double eye[3], beyond[3];
    stratus_camera camera[4];
    eye_at(-1.0, beyond);
    eye_at(3.86, eye);
    bool good = stratus_camera_parallel(context, eye, middle, up, .72 * radius, 1.0, camera + 0) == STRATUS_OK &&
      stratus_camera_perspective(context, eye, middle, up, 21.6, 1.0, camera + 1) == STRATUS_OK;
    eye_at(1.05, eye);
    good = good && stratus_camera_perspective(context, eye, middle, up, 70.0, 1.0, camera + 2) == STRATUS_OK &&
      stratus_camera_perspective(context, middle, beyond, up, 90.0, 1.0, camera + 3) == STRATUS_OK;
    if (!good) {
      throw failure(stratus_context_message(context));
    }
    cameras.insert(cameras.end(), camera, camera + 4);
  }
  return cameras;
}
} // namespace bench
