// SPDX-License-Identifier: BSD-3-Clause
#include "input.h"

#include "series.h"

#include "vtkStratusArrays.h"
#include "vtkStratusMapped.h"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkMatrix3x3.h>
#include <vtkPointData.h>
#include <vtkRectilinearGrid.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>
#include <sys/stat.h>

namespace {

bool has_scene(const std::string& name)
{
  for (int i = 0; i < stratus_scene_count(); ++i) {
    if (name == stratus_scene_name(i)) {
      return true;
    }
  }
  return false;
}

std::string scene_names()
{
  std::string names;
  for (int i = 0; i < stratus_scene_count(); ++i) {
    names += std::string(i ? ", " : "") + stratus_scene_name(i);
  }
  return names;
}

void set_type(vtkDataArray* array, stratus_volume& volume)
{
  if (!cli::stratus_type_of(array, volume.type)) {
    throw cli::failure(std::string("array '") + (array->GetName() ? array->GetName() : "") + "' holds " + array->GetDataTypeAsString() +
      " values; numbers of 8 to 64 bits are drawn");
  }
}

// Sets values and ghosts. The ghosts are of points unless the values are of cells.
void set_values(vtkDataSet* image, vtkDataArray* array, bool on_cells, stratus_volume& volume)
{
  const auto ghosts = [](vtkDataSetAttributes* data, vtkIdType count, const char* things) -> const uint8_t* {
    vtkUnsignedCharArray* flags = nullptr;
    std::string error;
    if (!vtkStratusFindGhosts(data, count, things, flags, error)) {
      throw cli::failure(error);
    }
    return flags ? flags->GetPointer(0) : nullptr;
  };
  const uint8_t* point_ghosts = ghosts(image->GetPointData(), image->GetNumberOfPoints(), "points of the image");
  volume.cell_ghosts = ghosts(image->GetCellData(), image->GetNumberOfCells(), "cells of the image");
  volume.point_ghosts = on_cells ? nullptr : point_ghosts;
  volume.values = array->GetVoidPointer(0);
  vtkStratusSetSource(array, 0, volume);
}
} // namespace

namespace cli {

vtkSmartPointer<vtkDataObject> read_data(const std::string& path, const reading_options& reading)
{
  return series(path, reading).read(0);
}

vtkSmartPointer<vtkImageData> read_image(const std::string& path, const reading_options& reading)
{
  const vtkSmartPointer<vtkDataObject> output = read_data(path, reading);
  vtkImageData* image = vtkImageData::SafeDownCast(output);
  if (!image) {
    throw failure("'" + path + "' holds " + (output ? output->GetClassName() : "nothing") + ", not an image (vtkImageData)");
  }
  route(image, path, "");
  return image;
}

bool stratus_type_of(vtkDataArray* array, stratus_type& type)
{
  const int vtk = array->GetDataType();
  if (vtk == VTK_FLOAT || vtk == VTK_DOUBLE) {
    type = vtk == VTK_FLOAT ? STRATUS_FLOAT32 : STRATUS_FLOAT64;
    return true;
  }
  const bool is_signed = array->GetDataTypeMin() < 0.0;
  switch (vtk == VTK_BIT ? 0 : array->GetDataTypeSize()) {
    case 1:
      type = is_signed ? STRATUS_INT8 : STRATUS_UINT8;
      return true;
    case 2:
      type = is_signed ? STRATUS_INT16 : STRATUS_UINT16;
      return true;
    case 4:
      type = is_signed ? STRATUS_INT32 : STRATUS_UINT32;
      return true;
    case 8:
      type = is_signed ? STRATUS_INT64 : STRATUS_UINT64;
      return true;
    default:
      return false;
  }
}

const char* name_of(stratus_type type)
{
  static const char* const names[] = { "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64" };
  return names[type];
}

std::string describe(const stratus_volume& v)
{
  const bool stretched = v.coordinates[0] || v.coordinates[1] || v.coordinates[2];
  return format("%lld x %lld x %lld %s on %s, %sspacing %g x %g x %g", static_cast<long long>(v.dimensions[0]),
    static_cast<long long>(v.dimensions[1]), static_cast<long long>(v.dimensions[2]), name_of(v.type), v.cell_centered ? "cells" : "points",
    stretched ? "mean " : "", v.spacing[0], v.spacing[1], v.spacing[2]);
}

stratus_volume view_of(vtkImageData* image, vtkDataArray* array, bool on_cells)
{
  stratus_volume volume = stratus_volume_default();
  int extent[6];
  image->GetExtent(extent);
  set_type(array, volume);
  bool sheet = false;
  double first[3];
  for (int a = 0; a < 3; ++a) {
    const int64_t points = static_cast<int64_t>(extent[2 * a + 1]) - extent[2 * a] + 1;
    volume.dimensions[a] = on_cells ? std::max<int64_t>(points - 1, 1) : points;
    volume.spacing[a] = image->GetSpacing()[a];
    sheet = sheet || (!on_cells && points == 1);
  }
  volume.cell_centered = on_cells || sheet;
  for (int a = 0; a < 3; ++a) {
    first[a] = volume.spacing[a] * (extent[2 * a] - (sheet ? 0.5 : 0.0));
  }
  const double* direction = image->GetDirectionMatrix()->GetData();
  for (int r = 0; r < 3; ++r) {
    volume.origin[r] = image->GetOrigin()[r];
    for (int c = 0; c < 3; ++c) {
      volume.direction[3 * r + c] = direction[3 * r + c];
      volume.origin[r] += direction[3 * r + c] * first[c];
    }
  }
  set_values(image, array, on_cells || sheet, volume);
  volume.cell_ghosts = sheet ? nullptr : volume.cell_ghosts;
  return volume;
}

stratus_volume view_of(vtkRectilinearGrid* grid, vtkDataArray* array, bool on_cells, std::vector<double> coordinates[3])
{
  stratus_volume volume = stratus_volume_default();
  vtkDataArray* const axes[] = { grid->GetXCoordinates(), grid->GetYCoordinates(), grid->GetZCoordinates() };
  set_type(array, volume);
  for (int a = 0; a < 3; ++a) {
    const int points = grid->GetDimensions()[a];
    if (points < 2 || !axes[a] || axes[a]->GetNumberOfTuples() != points) {
      throw failure(format("a rectilinear grid of %d points along %c and %lld coordinates; it needs as many, and at least 2", points,
        "xyz"[a], axes[a] ? static_cast<long long>(axes[a]->GetNumberOfTuples()) : 0LL));
    }
    coordinates[a].resize(static_cast<size_t>(points));
    for (int i = 0; i < points; ++i) {
      coordinates[a][static_cast<size_t>(i)] = axes[a]->GetComponent(i, 0);
    }
    volume.coordinates[a] = coordinates[a].data();
    volume.dimensions[a] = points - (on_cells ? 1 : 0);
    volume.spacing[a] = std::fabs(coordinates[a].back() - coordinates[a].front()) / (points - 1);
  }
  volume.cell_centered = on_cells;
  set_values(grid, array, on_cells, volume);
  return volume;
}

bool is_scene(const std::string& source)
{
  struct stat status;
  const bool exists = stat(source.c_str(), &status) == 0;
  if (!exists && !has_scene(source) && source.find_first_of("./") == std::string::npos) {
    throw failure("'" + source + "' is neither a file nor a scene (" + scene_names() + ")");
  }
  return !exists && has_scene(source);
}

input::input(context& core, const std::string& source, const reading_options& reading) : Core(core)
{
  if (!is_scene(source)) {
    this->set(read_image(source, reading), source, reading.variable);
    return;
  }
  if (!reading.variable.empty()) {
    throw usage("--array: the scene '" + source + "' has only one");
  }
  if (!reading.select.empty()) {
    throw usage("--select " + reading.select + ": the scene '" + source + "' has no dimensions with names");
  }
  core.check(stratus_scene_create(core, source.c_str(), &this->scene), "scene '" + source + "'");
  this->volume = this->scene->volume;
  this->volume.components = 1; // options describe one transfer function: of two pollutants, the first is drawn
  this->up_axis = this->scene->up_axis;
  this->array_name = source;
}

input::input(context& core, const std::string& source, vtkDataSet* from, const std::string& array) : Core(core)
{
  this->set(from, source, array);
}

void input::set(vtkDataSet* from, const std::string& source, const std::string& array)
{
  this->image = from;
  bool on_cells = false;
  vtkDataArray* values = choose_array(this->image, array, on_cells);
  vtkRectilinearGrid* grid = vtkRectilinearGrid::SafeDownCast(from);
  this->volume = grid ? view_of(grid, values, on_cells, this->Coordinates) : view_of(vtkImageData::SafeDownCast(from), values, on_cells);
  this->array_name = values->GetName() ? values->GetName() : "(unnamed)";
  this->Core.check(stratus_volume_check(this->Core, &this->volume), "'" + source + "'");
}

input::~input()
{
  stratus_scene_destroy(this->Core, this->scene);
}
} // namespace cli
