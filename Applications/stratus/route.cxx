// SPDX-License-Identifier: BSD-3-Clause
#include "route.h"

#include "support.h"
#include "vectors.h"

#include "vtkStratusAMR.h"
#include "vtkStratusArrays.h"
#include "vtkStratusBlocks.h"

#include <vtkCellData.h>
#include <vtkCompositeDataSet.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkPointData.h>
#include <vtkRectilinearGrid.h>
#include <vtkStructuredGrid.h>
#include <vtkUniformGrid.h>
#include <vtkUniformGridAMR.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <vector>

namespace {

// Coordinates of an axis must increase or decrease all along.
void check_axis(vtkDataArray* values, char axis, const std::string& path)
{
  const vtkIdType n = values ? values->GetNumberOfTuples() : 0;
  const auto at = [values](vtkIdType i) { return values->GetComponent(i, 0); };
  for (vtkIdType i = 0; i < n; ++i) {
    if (!std::isfinite(at(i)) || (i > 1 && !((at(i) - at(i - 1)) * (at(1) - at(0)) > 0.0)) || (i == 1 && at(1) == at(0))) {
      throw cli::failure("'" + path + "': the coordinates along " + axis +
        cli::format(" must increase or decrease all along: number %lld is %.9g", static_cast<long long>(i), at(i)) +
        (i > 0 ? cli::format(", after %.9g", at(i - 1)) : std::string()));
    }
  }
}

void check_axes(vtkRectilinearGrid* grid, const std::string& path)
{
  check_axis(grid->GetXCoordinates(), 'x', path);
  check_axis(grid->GetYCoordinates(), 'y', path);
  check_axis(grid->GetZCoordinates(), 'z', path);
}

std::string points_of(const int* dimensions, const char* what)
{
  return what + cli::format(" of %d x %d x %d points", dimensions[0], dimensions[1], dimensions[2]);
}

vtkDataArray* first_single(vtkDataSetAttributes* data)
{
  vtkDataArray* active = data->GetScalars();
  for (int i = 0; !active && i < data->GetNumberOfArrays(); ++i) {
    vtkDataArray* array = data->GetArray(i);
    if (array && array->GetNumberOfComponents() == 1 && std::strcmp(array->GetName() ? array->GetName() : "", "vtkGhostType") != 0) {
      active = array;
    }
  }
  return active;
}

// A part of the vectors that the name says, or the lengths of the first ones.
vtkDataArray* part_of_vectors(vtkDataSetAttributes* data, const std::string& name)
{
  const cli::vector_part wanted = cli::vector_part_of(name);
  for (int i = 0; i < data->GetNumberOfArrays(); ++i) {
    vtkDataArray* array = data->GetArray(i);
    if (array && cli::is_vector(array) &&
      (name.empty() || (wanted.part >= 0 && wanted.array == (array->GetName() ? array->GetName() : "")))) {
      return cli::add_vector_part(data, array, name.empty() ? 3 : wanted.part);
    }
  }
  return nullptr;
}

// Lists the arrays, with the ranges of arrays of one component.
std::string names_of(vtkDataSet* data_set)
{
  std::string names;
  for (vtkDataSetAttributes* data :
    { static_cast<vtkDataSetAttributes*>(data_set->GetPointData()), static_cast<vtkDataSetAttributes*>(data_set->GetCellData()) }) {
    for (int i = 0; i < data->GetNumberOfArrays(); ++i) {
      names += std::string(names.empty() ? "" : ", ") + (data->GetArrayName(i) ? data->GetArrayName(i) : "(unnamed)");
      vtkDataArray* array = data->GetArray(i);
      if (array && array->GetNumberOfComponents() == 1 && array->GetNumberOfTuples() > 0) {
        double range[2];
        array->GetFiniteRange(range);
        names += range[0] <= range[1] ? cli::format(" (%g .. %g)", range[0], range[1]) : " (nothing finite)";
      }
    }
  }
  return names.empty() ? "none" : names;
}
// The array that is drawn of a part if it is one of points.
vtkDataArray* drawn_on_points(vtkDataSet* part, const std::string& array)
{
  try {
    bool on_cells = false;
    vtkDataArray* values = cli::choose_array(part, array, on_cells);
    return on_cells ? nullptr : values;
  } catch (const cli::failure&) {
    return nullptr;
  }
}

bool overlap(vtkDataSet* a, vtkDataSet* b)
{
  const double *of_a = a->GetBounds(), *of_b = b->GetBounds();
  bool inside = true;
  for (int axis = 0; axis < 3; ++axis) {
    const double slack = 1e-6 * (of_a[2 * axis + 1] - of_a[2 * axis]);
    inside = inside && of_a[2 * axis] < of_b[2 * axis + 1] - slack && of_b[2 * axis] < of_a[2 * axis + 1] - slack;
  }
  return inside;
}

// Takes the parts as they are where all are images or rectilinear grids side by side that have the array on their points. Rays interpolate
// within their cells then. Returns false where one part is not so.
bool keep_blocks(vtkCompositeDataSet* whole, const std::string& path, const std::string& array, cli::routed& result)
{
  std::vector<vtkDataSet*> parts = vtkCompositeDataSet::GetDataSets(whole);
  parts.erase(std::remove_if(parts.begin(), parts.end(), [](vtkDataSet* part) { return part->GetNumberOfPoints() == 0; }), parts.end());
  std::map<std::string, int> kinds;
  int type = VTK_VOID;
  for (size_t i = 0; i < parts.size(); ++i) {
    vtkImageData* image = vtkImageData::SafeDownCast(parts[i]);
    vtkRectilinearGrid* axes = vtkRectilinearGrid::SafeDownCast(parts[i]);
    vtkDataArray* values = image || axes ? drawn_on_points(parts[i], array) : nullptr;
    type = i > 0 || !values ? type : values->GetDataType();
    if (!values || values->GetDataType() != type) {
      return false;
    }
    const int* dimensions = image ? image->GetDimensions() : axes->GetDimensions();
    const auto overlaps = [&](vtkDataSet* other) { return overlap(parts[i], other); };
    if (*std::min_element(dimensions, dimensions + 3) < 2 ||
      std::any_of(parts.begin(), parts.begin() + static_cast<std::ptrdiff_t>(i), overlaps)) {
      return false;
    }
    if (axes) {
      check_axes(axes, path);
    }
    ++kinds[parts[i]->GetClassName()];
  }
  if (parts.empty()) {
    return false;
  }
  result.kind = std::to_string(parts.size()) + (parts.size() == 1 ? " block:" : " blocks:");
  for (const auto& kind : kinds) {
    result.kind += cli::format(" %d ", kind.second) + kind.first;
  }
  result.arrays = names_of(parts[0]);
  result.image = parts[0];
  result.blocks.assign(parts.begin() + 1, parts.end());
  return true;
}

// Makes blocks of AMR.
void refine(vtkUniformGridAMR* amr, const std::string& path, const std::string& array, bool nearest, bool gradients, cli::routed& result)
{
  vtkStratusAMR grids;
  std::string error;
  int boxes = 0;
  const auto find = [&](vtkDataSet* box, bool& on_cells) {
    vtkDataArray* values = cli::choose_array(box, array, on_cells);
    result.arrays = boxes++ == 0 ? names_of(box) : result.arrays;
    return values;
  };
  if (!grids.Set(amr, find, { nearest, gradients }, error)) {
    throw cli::failure("'" + path + "': " + error);
  }
  if (grids.GetGrids().empty()) {
    throw cli::failure("'" + path + "' holds no box with values");
  }
  for (const auto& grid : grids.GetGrids()) { // the name from --array, also for a component of vectors
    vtkDataSetAttributes* data = grids.HasCells() ? static_cast<vtkDataSetAttributes*>(grid->GetCellData()) : grid->GetPointData();
    data->GetScalars()->SetName(array.empty() ? data->GetScalars()->GetName() : array.c_str());
  }
  const int levels = grids.GetNumberOfLevels();
  result.kind = std::string("AMR: ") + std::to_string(boxes) + (boxes == 1 ? " box in " : " boxes in ") + std::to_string(levels) +
    (levels == 1 ? " level" : " levels");
  result.image = grids.GetGrids()[0];
  result.blocks.assign(grids.GetGrids().begin() + 1, grids.GetGrids().end());
  result.refined = true;
}

// Joins the parts that have the array. `result` gets the grid and a description of the parts.
void join(vtkCompositeDataSet* whole, const std::string& path, const std::string& array, cli::routed& result)
{
  vtkStratusBlocks blocks;
  std::string error;
  vtkDataSet* first = nullptr;
  std::map<std::string, int> kinds;
  const auto find = [&](vtkDataSet* part, int& cells) {
    first = first ? first : part;
    ++kinds[part->GetClassName()];
    vtkDataArray* values = nullptr;
    for (cells = 0; cells < 2 && !values; cells += values ? 0 : 1) {
      vtkDataSetAttributes* data = cells ? static_cast<vtkDataSetAttributes*>(part->GetCellData()) : part->GetPointData();
      values = array.empty() ? first_single(data) : data->GetArray(array.c_str());
      values = values || array.empty() ? values : data->GetArray(cli::vector_part_of(array).array.c_str());
    }
    return values;
  };
  if (!blocks.Set(whole, find, error, false)) {
    throw cli::failure("'" + path + "': " + error + (first ? "; the first part's arrays are: " + names_of(first) : std::string()));
  }
  if (!blocks.GetGrid()) {
    throw cli::failure("'" + path + "' holds no part with a volume");
  }
  int parts = 0;
  for (const auto& kind : kinds) {
    parts += kind.second;
    result.kind += cli::format(" %d ", kind.second) + kind.first;
  }
  result.kind = std::to_string(parts) + (parts == 1 ? " part:" : " parts:") + result.kind +
    (blocks.DescribeLeftOut().empty() ? "" : "; left out: " + blocks.DescribeLeftOut());
  result.arrays = names_of(first);
  result.grid = blocks.GetGrid();
}
} // namespace

namespace cli {

routed route(vtkDataObject* data, const std::string& path, const std::string& array, bool nearest, bool gradients)
{
  routed result;
  if (vtkImageData* image = vtkImageData::SafeDownCast(data)) {
    if (image->GetNumberOfPoints() < 1) {
      throw failure("'" + path + "' holds an empty image");
    }
    result.kind = points_of(image->GetDimensions(), "image");
    result.image = image;
  } else if (vtkUnstructuredGrid* grid = vtkUnstructuredGrid::SafeDownCast(data)) {
    std::string error;
    if (!vtkStratusCheckGrid(grid, error)) {
      throw failure("'" + path + "': " + error);
    }
    result.kind = "unstructured grid";
    result.grid = grid;
  } else if (vtkRectilinearGrid* axes = vtkRectilinearGrid::SafeDownCast(data)) {
    result.kind = points_of(axes->GetDimensions(), "rectilinear grid");
    check_axes(axes, path);
    result.image = axes;
  } else if (vtkStructuredGrid* curved = vtkStructuredGrid::SafeDownCast(data)) {
    int dimensions[3];
    curved->GetDimensions(dimensions);
    result.kind = points_of(dimensions, "curvilinear grid");
    result.grid = curved;
  } else if (vtkUniformGridAMR* amr = vtkUniformGridAMR::SafeDownCast(data)) {
    refine(amr, path, array, nearest, gradients, result);
  } else if (vtkCompositeDataSet* whole = vtkCompositeDataSet::SafeDownCast(data)) {
    if (!keep_blocks(whole, path, array, result)) {
      join(whole, path, array, result);
    }
  } else {
    throw failure("'" + path + "' holds " + (data ? data->GetClassName() : "nothing") + ", which has no volume to draw");
  }
  return result;
}

vtkDataArray* choose_array(vtkDataSet* data_set, const std::string& name, bool& on_cells)
{
  vtkDataArray* array = nullptr;
  for (int look = 0; look < 4 && !array; ++look) { // single values before vectors
    on_cells = look % 2 == 1;
    vtkDataSetAttributes* data = on_cells ? static_cast<vtkDataSetAttributes*>(data_set->GetCellData()) : data_set->GetPointData();
    array = look < 2 ? (name.empty() ? first_single(data) : data->GetArray(name.c_str())) : part_of_vectors(data, name);
    array = look < 2 && array && is_vector(array) ? add_vector_part(data, array, 3) : array;
  }
  if (!array) {
    throw failure((name.empty() ? std::string("no array to draw") : "no array '" + name + "'") + "; the arrays are: " + names_of(data_set));
  }
  const std::string label = array->GetName() ? array->GetName() : "(unnamed)";
  if (array->GetNumberOfComponents() != 1) {
    throw failure("array '" + label + "' has " + std::to_string(array->GetNumberOfComponents()) + " components; one is drawn");
  }
  const vtkIdType expected = on_cells ? data_set->GetNumberOfCells() : data_set->GetNumberOfPoints();
  if (array->GetNumberOfTuples() != expected) {
    throw failure("array '" + label + "' has " + std::to_string(array->GetNumberOfTuples()) + " values for " + std::to_string(expected) +
      (on_cells ? " cells" : " points"));
  }
  return array;
}
} // namespace cli
