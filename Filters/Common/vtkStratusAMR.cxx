// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusAMR.h"

#include "vtkStratusAMRField.h"
#include "vtkStratusAMRLeaves.h"
#include "vtkStratusAMRParts.h"
#include "stratus.h"
#include "vtkStratusArrays.h"
#include "vtkStratusVersions.h"

#include "vtkAMRBox.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkOverlappingAMR.h"
#include "vtkPointData.h"
#include "vtkRectilinearGrid.h"
#include "vtkSMPTools.h"
#include "vtkUniformGrid.h"
#include "vtkUniformGridAMR.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <new>

namespace {

using Box = vtkStratusAMRField::Box;
using Parts = vtkStratusAMRParts;
using Place = vtkStratusAMRField::Place;

// The drawn data of a box.
struct Source {
  vtkDataArray* Values = nullptr;
  vtkUnsignedCharArray* Flags = nullptr; // of the points or cells that have the values
  Box Where;
};

bool FindSource(vtkStratusAMRGrid* grid, const std::string& name, bool cells, Source& source, std::string& error)
{
  vtkDataSetAttributes* data = cells ? static_cast<vtkDataSetAttributes*>(grid->GetCellData()) : grid->GetPointData();
  const vtkIdType count = cells ? grid->GetNumberOfCells() : grid->GetNumberOfPoints();
  if (source.Values->GetNumberOfTuples() < count) {
    error = name + " has " + std::to_string(source.Values->GetNumberOfTuples()) + " values for " + std::to_string(count) +
      (cells ? " cells" : " points");
    return false;
  }
  return vtkStratusFindGhosts(data, count, cells ? "cells of a box" : "points of a box", source.Flags, error);
}

constexpr const char* GradientArray = "StratusGradients"; // of a grid's field data

// How a level's values are converted to a grid's values.
struct Kind {
  int Type;
  double Least; // values nearer to 0 become 0: in floats, a grid of only such values would be indistinguishable from a constant one
};

// Chooses doubles if floats could not distinguish the values, as for close values far from 0.
Kind ChooseKind(const vtkStratusAMRField& field, int type, bool as_is)
{
  double range[2];
  const bool any = field.GetRange(range);
  const double most = any ? std::max(std::fabs(range[0]), std::fabs(range[1])) : 0.0;
  const bool digits = vtkDataArray::GetDataTypeSize(type) >= 4 && type != VTK_FLOAT;
  const bool doubles = digits && any && range[1] - range[0] < 0.125 * most;
  return { as_is ? type : doubles ? VTK_DOUBLE : VTK_FLOAT, std::min(1e-33, 1e-3 * most) };
}

bool IsEven(const std::vector<int64_t>& planes)
{
  const auto uneven = [&planes](size_t i) { return planes[i + 1] - planes[i] != planes[1] - planes[0]; };
  for (size_t i = 1; i + 1 < planes.size(); ++i) {
    if (uneven(i)) {
      return false;
    }
  }
  return true;
}

// An image or, where planes are not even, a rectilinear grid.
vtkSmartPointer<vtkDataSet> MakeGrid(const std::vector<int64_t> planes[3], const double origin[3], const double unit[3])
{
  int dimensions[3];
  bool even = true;
  for (int axis = 0; axis < 3; ++axis) {
    dimensions[axis] = static_cast<int>(planes[axis].size());
    even = even && IsEven(planes[axis]);
  }
  const auto at = [&](int axis, size_t i) { return origin[axis] + unit[axis] * static_cast<double>(planes[axis][i]); };
  if (even) {
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->SetDimensions(dimensions);
    image->SetOrigin(at(0, 0), at(1, 0), at(2, 0));
    double spacing[3];
    for (int axis = 0; axis < 3; ++axis) {
      spacing[axis] = unit[axis] * static_cast<double>(planes[axis][1] - planes[axis][0]);
    }
    image->SetSpacing(spacing);
    return image;
  }
  auto grid = vtkSmartPointer<vtkRectilinearGrid>::New();
  grid->SetDimensions(dimensions);
  vtkNew<vtkDoubleArray> axes[3];
  for (int axis = 0; axis < 3; ++axis) {
    axes[axis]->SetNumberOfTuples(dimensions[axis]);
    for (int i = 0; i < dimensions[axis]; ++i) {
      axes[axis]->SetValue(i, at(axis, static_cast<size_t>(i)));
    }
  }
  grid->SetXCoordinates(axes[0]);
  grid->SetYCoordinates(axes[1]);
  grid->SetZCoordinates(axes[2]);
  return grid;
}

// Makes the array of `count` values for a grid, and gives where its gradients go, in an array of the grid's field data.
vtkSmartPointer<vtkDataArray> MakeValues(vtkDataSet* grid, int type, const vtkStratusAMRField& field, size_t count, float*& gradients)
{
  auto values = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(type));
  const auto numbers = static_cast<vtkIdType>(count) * field.GetNumberOfComponents();
  values->SetNumberOfComponents(field.GetNumberOfComponents());
  gradients = nullptr;
  if (field.GetNumberOfNumbers() > field.GetNumberOfComponents()) {
    vtkNew<vtkFloatArray> all;
    all->SetName(GradientArray);
    all->SetNumberOfValues((type == VTK_FLOAT ? 4 : 3) * numbers);
    grid->GetFieldData()->AddArray(all);
    gradients = all->GetPointer(all->GetNumberOfValues() - 3 * numbers);
    if (type == VTK_FLOAT) {
      values->SetVoidArray(all->GetPointer(0), numbers, 1); // `all` keeps the memory
      return values;
    }
  }
  values->SetNumberOfTuples(static_cast<vtkIdType>(count));
  return values;
}

// Fills the values of a leaf's grid, layer by layer. counts: the numbers of values along the axes. per_length: units in a length, of each
// axis.
void Fill(const vtkStratusAMRField& field, const vtkStratusAMRLeaf& leaf, const std::vector<int64_t> planes[3], const size_t counts[3],
  bool nearest, double least, const double per_length[3], vtkDataArray* values, float* gradients)
{
  const auto components = static_cast<size_t>(field.GetNumberOfComponents());
  const size_t count = counts[0] * counts[1] * counts[2];
  vtkSMPTools::For(0, static_cast<vtkIdType>(counts[2]), 1, [&](vtkIdType from, vtkIdType to) {
    vtkStratusAMRField::Cache cache;
    std::vector<double> tuple(static_cast<size_t>(field.GetNumberOfNumbers()));
    for (auto k = static_cast<size_t>(from); k < static_cast<size_t>(to); ++k) {
      auto id = static_cast<vtkIdType>(k * counts[1] * counts[0]);
      for (size_t j = 0; j < counts[1]; ++j) {
        for (size_t i = 0; i < counts[0]; ++i, ++id) {
          const Place at = { planes[0][i], planes[1][j], planes[2][k] };
          if (nearest) {
            field.EvaluateCell(at, { planes[0][i + 1], planes[1][j + 1], planes[2][k + 1] }, cache, tuple.data());
          } else if (leaf.Even) {
            field.EvaluateNode(leaf.Level, at, cache, tuple.data());
          } else {
            field.Evaluate(at, cache, tuple.data());
          }
          for (size_t c = 0; c < components; ++c) {
            values->SetComponent(id, static_cast<int>(c), std::fabs(tuple[c]) < least ? 0.0 : tuple[c]);
          }
          for (size_t d = 0; gradients && d < 3 * components; ++d) {
            gradients[d * count + static_cast<size_t>(id)] = static_cast<float>(tuple[components + d] * per_length[d % 3]);
          }
        }
      }
    }
  });
}
} // namespace

vtkMTimeType vtkStratusAMR::GetTime(vtkUniformGridAMR* amr)
{
  vtkMTimeType time = amr->GetMTime();
  for (unsigned int level = 0; level < amr->GetNumberOfLevels(); ++level) {
    for (unsigned int id = 0; id < vtkStratusNumberOfGrids(amr, level); ++id) {
      if (vtkStratusAMRGrid* grid = vtkStratusGridOf(amr, level, id)) {
        time = std::max({ time, grid->GetMTime(), grid->GetPointData()->GetMTime(), grid->GetCellData()->GetMTime() });
      }
    }
  }
  return time;
}

bool vtkStratusAMR::GetBounds(vtkUniformGridAMR* amr, int piece, int pieces, double bounds[6])
{
  vtkOverlappingAMR* overlapping = vtkOverlappingAMR::SafeDownCast(amr);
  Parts::Ratios ratios;
  std::string unused;
  if (!overlapping || !Parts::FindRatios(overlapping, ratios, unused)) {
    return false;
  }
  Place lo, hi, cell;
  if (!Parts::FindPiece(ratios, Parts::GetAll(overlapping), piece, pieces, lo, hi, cell)) {
    return false;
  }
  double unit[3];
  overlapping->GetSpacing(static_cast<unsigned int>(ratios.size()), unit);
  for (size_t axis = 0; axis < 3; ++axis) {
    bounds[2 * axis] = overlapping->GetOrigin()[axis] + 0.5 * unit[axis] * static_cast<double>(lo[axis]);
    bounds[2 * axis + 1] = overlapping->GetOrigin()[axis] + 0.5 * unit[axis] * static_cast<double>(hi[axis]);
  }
  return true;
}

const float* vtkStratusAMR::GetGradients(vtkDataSet* grid)
{
  vtkDataArray* points = grid->GetPointData()->GetScalars();
  vtkFloatArray* all = vtkFloatArray::SafeDownCast(grid->GetFieldData()->GetArray(GradientArray));
  return all ? all->GetPointer(all->GetNumberOfValues() - 3 * (points ? points : grid->GetCellData()->GetScalars())->GetNumberOfValues())
             : nullptr;
}

bool vtkStratusAMR::Set(vtkUniformGridAMR* amr, const FindArray& find, const Use& use, std::string& error)
{
  this->Grids.clear();
  vtkOverlappingAMR* overlapping = vtkOverlappingAMR::SafeDownCast(amr);
  if (!overlapping) {
    error = std::string("data of class ") + (amr ? amr->GetClassName() : "(none)") + " are not drawn; AMR of class vtkOverlappingAMR is";
    return false;
  }
  try {
    return this->Make(overlapping, find, use, error);
  } catch (const std::bad_alloc&) {
    this->Grids.clear();
    error = "the levels' grids need more memory than there is";
    return false;
  }
}

bool vtkStratusAMR::Make(vtkOverlappingAMR* amr, const FindArray& find, const Use& use, std::string& error)
{
  Parts::Ratios ratios;
  if (!Parts::FindRatios(amr, ratios, error)) {
    return false;
  }
  const std::vector<Box> all = Parts::GetAll(amr);
  std::vector<Source> sources;
  int type = VTK_VOID, components = 0;
  for (unsigned int level = 0; level < amr->GetNumberOfLevels(); ++level) {
    for (unsigned int id = 0; id < vtkStratusNumberOfGrids(amr, level); ++id) {
      vtkStratusAMRGrid* grid = vtkStratusGridOf(amr, level, id);
      if (!grid || grid->GetNumberOfPoints() == 0) {
        continue;
      }
      Source source;
      bool cells = false;
      source.Values = find(grid, cells);
      if (!source.Values) {
        error = Parts::NameOf(level, id) + " lacks the array";
        return false;
      }
      if (sources.empty()) {
        this->Cells = cells;
        this->ArrayName = source.Values->GetName() ? source.Values->GetName() : "";
        type = source.Values->GetDataType();
        components = source.Values->GetNumberOfComponents();
        this->Levels = static_cast<int>(level) + 1;
      }
      if (cells != this->Cells || source.Values->GetDataType() != type || source.Values->GetNumberOfComponents() != components) {
        error = Parts::NameOf(level, id) +
          " has its array of another type or number of components than the first box, or on points where that has cells";
        return false;
      }
      if (!Parts::FindBox(amr, level, id, grid, source.Where, error) || !FindSource(grid, Parts::NameOf(level, id), cells, source, error)) {
        return false;
      }
      this->Levels = std::max(this->Levels, static_cast<int>(level) + 1);
      sources.push_back(source);
    }
  }
  if (sources.empty()) {
    return true;
  }
  if (use.Nearest && !this->Cells) {
    error =
      "nearest interpolation of AMR's values of points is not drawn: cells about points of two levels overlap. Use linear interpolation";
    return false;
  }
  for (const Box& box : all) {
    this->Levels = std::max(this->Levels, box.Level + 1);
  }
  ratios.resize(static_cast<size_t>(this->Levels - 1));
  vtkStratusAMRField field;
  if (!field.Begin(ratios, this->Cells, components, error)) {
    return false;
  }
  const auto hides = static_cast<unsigned char>(this->Cells ? STRATUS_GHOST_HIDDEN_CELL : STRATUS_GHOST_HIDDEN_POINT);
  for (const Source& source : sources) {
    const auto value = [&source](int64_t i, int c) { return source.Values->GetComponent(static_cast<vtkIdType>(i), c); };
    const auto hidden = [&source, hides](
                          int64_t i) { return source.Flags && (source.Flags->GetValue(static_cast<vtkIdType>(i)) & hides) != 0; };
    if (!field.Add(source.Where, value, hidden, error)) {
      return false;
    }
  }
  if (!field.End(error)) {
    return false;
  }
  const Kind kind = ChooseKind(field, type, use.Nearest && !use.Gradients);
  if (use.Gradients) {
    field.TakeGradients();
  }
  double unit[3], per_length[3], coarsest[3];
  amr->GetSpacing(static_cast<unsigned int>(this->Levels - 1), unit);
  amr->GetSpacing(0, coarsest);
  for (int axis = 0; axis < 3; ++axis) {
    unit[axis] *= 0.5;
    per_length[axis] = 1.0 / unit[axis];
  }
  this->Spacing = (coarsest[0] + coarsest[1] + coarsest[2]) / 3.0;
  const vtkStratusAMRLeaves leaves(field, all, use.Nearest, use.Piece, use.Pieces);
  for (const vtkStratusAMRLeaf& leaf : leaves.GetLeaves()) {
    std::vector<int64_t> planes[3];
    size_t counts[3];
    for (int axis = 0; axis < 3; ++axis) {
      planes[axis] = leaves.GetPlanes(leaf, axis);
      counts[axis] = planes[axis].size() - (use.Nearest ? 1 : 0);
    }
    float* gradients = nullptr;
    const vtkSmartPointer<vtkDataSet> grid = MakeGrid(planes, amr->GetOrigin(), unit);
    const vtkSmartPointer<vtkDataArray> values = MakeValues(grid, kind.Type, field, counts[0] * counts[1] * counts[2], gradients);
    values->SetName(this->ArrayName.c_str());
    Fill(field, leaf, planes, counts, use.Nearest, kind.Least, per_length, values, gradients);
    vtkDataSetAttributes* data = use.Nearest ? static_cast<vtkDataSetAttributes*>(grid->GetCellData()) : grid->GetPointData();
    data->SetScalars(values);
    this->Grids.push_back(grid);
  }
  this->Cells = use.Nearest;
  this->Gradients = use.Gradients;
  return true;
}
