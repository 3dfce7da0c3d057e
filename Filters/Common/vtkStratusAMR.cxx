// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusAMR.h"

#include "vtkStratusAMRField.h"
#include "vtkStratusAMRLeaves.h"
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
using Place = vtkStratusAMRField::Place;

std::string NameOf(unsigned int level, unsigned int id)
{
  return "box " + std::to_string(id) + " of level " + std::to_string(level);
}

// Finds how many cells of each level fit along a cell of the level before.
bool FindRatios(vtkOverlappingAMR* amr, std::vector<std::array<int, 3>>& ratios, std::string& error)
{
  for (unsigned int level = 0; level + 1 < amr->GetNumberOfLevels(); ++level) {
    double coarse[3], fine[3];
    amr->GetSpacing(level, coarse);
    amr->GetSpacing(level + 1, fine);
    std::array<int, 3> ratio;
    for (size_t axis = 0; axis < 3; ++axis) {
      const double exact = coarse[axis] / fine[axis];
      if (!(exact > 0.5 && exact < 1024.5) || std::fabs(exact - std::round(exact)) > 1e-6 * exact) {
        error = "level " + std::to_string(level + 1) + " divides cells of level " + std::to_string(level) + " by " + std::to_string(exact) +
          " along axis " + std::to_string(axis) + ", a whole number from 1 to 1024 is needed";
        return false;
      }
      ratio[axis] = static_cast<int>(std::round(exact));
    }
    ratios.push_back(ratio);
  }
  return true;
}

// Checks that a box is where the levels' lattice says, and gives its cells.
bool FindBox(vtkOverlappingAMR* amr, unsigned int level, unsigned int id, vtkStratusAMRGrid* grid, Box& box, std::string& error)
{
  double spacing[3], origin[3];
  int dimensions[3];
  amr->GetSpacing(level, spacing);
  grid->GetDimensions(dimensions);
  grid->GetOrigin(origin); // of the point of index 0
  const int* extent = grid->GetExtent();
  box.Level = static_cast<int>(level);
  for (size_t axis = 0; axis < 3; ++axis) {
    const double own = grid->GetSpacing()[axis];
    const double lo = (origin[axis] + own * extent[2 * axis] - amr->GetOrigin()[axis]) / spacing[axis];
    if (dimensions[axis] < 2) {
      error = NameOf(level, id) + " is flat along axis " + std::to_string(axis) + "; boxes of three dimensions are drawn";
      return false;
    }
    if (!(std::fabs(own - spacing[axis]) <= 1e-5 * spacing[axis]) || !(std::fabs(lo) < 1e9) || std::fabs(lo - std::round(lo)) > 1e-2) {
      error = NameOf(level, id) + " is not on its level's lattice: along axis " + std::to_string(axis) + " its spacing is " +
        std::to_string(own) + " (the level's is " + std::to_string(spacing[axis]) + ") and it starts at cell " + std::to_string(lo);
      return false;
    }
    box.Lo[axis] = static_cast<int64_t>(std::round(lo));
    box.Hi[axis] = box.Lo[axis] + dimensions[axis] - 1;
  }
  return true;
}

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
  std::vector<std::array<int, 3>> ratios;
  std::string unused;
  if (!overlapping || !FindRatios(overlapping, ratios, unused)) {
    return false;
  }
  std::vector<vtkStratusAMRLeaves::Box> boxes; // in halves of the finest level's cells, as the field counts
  std::vector<double> values;
  Place lo, hi, cell;
  double unit[3];
  overlapping->GetSpacing(static_cast<unsigned int>(ratios.size()), unit);
  for (unsigned int level = static_cast<unsigned int>(ratios.size()) + 1; level-- > 0;) {
    for (size_t axis = 0; axis < 3; ++axis) {
      cell[axis] = level == ratios.size() ? 2 : cell[axis] * ratios[level][axis];
    }
    for (unsigned int id = 0; id < vtkStratusNumberOfGrids(overlapping, level); ++id) {
      vtkStratusAMRGrid* grid = vtkStratusGridOf(overlapping, level, id);
      Box box;
      if (!grid || grid->GetNumberOfPoints() == 0 || !FindBox(overlapping, level, id, grid, box, unused)) {
        continue;
      }
      double count = 1.0;
      for (size_t axis = 0; axis < 3; ++axis) {
        count *= static_cast<double>(box.Hi[axis] - box.Lo[axis]);
        box.Lo[axis] *= cell[axis];
        box.Hi[axis] *= cell[axis];
        lo[axis] = boxes.empty() ? box.Lo[axis] : std::min(lo[axis], box.Lo[axis]);
        hi[axis] = boxes.empty() ? box.Hi[axis] : std::max(hi[axis], box.Hi[axis]);
      }
      boxes.push_back({ box.Level, box.Lo, box.Hi });
      values.push_back(count);
    }
  }
  if (boxes.empty() || !vtkStratusAMRLeaves::FindPiece(boxes, cell, values, piece, pieces, lo, hi)) {
    return false;
  }
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
  std::vector<std::array<int, 3>> ratios;
  if (!FindRatios(amr, ratios, error)) {
    return false;
  }
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
        error = NameOf(level, id) + " lacks the array";
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
        error = NameOf(level, id) +
          " has its array of another type or number of components than the first box, or on points where that has cells";
        return false;
      }
      if (!FindBox(amr, level, id, grid, source.Where, error) || !FindSource(grid, NameOf(level, id), cells, source, error)) {
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
  const vtkStratusAMRLeaves leaves(field, use.Nearest, use.Piece, use.Pieces);
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
