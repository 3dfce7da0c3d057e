// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusAMRParts.h"

#include "vtkStratusAMRLeaves.h"
#include "vtkStratusUncut.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkOverlappingAMR.h"
#include "vtkPointData.h"
#include "vtkTypeInt64Array.h"

#include <algorithm>
#include <cmath>

namespace {
using Box = vtkStratusAMRParts::Box;
using Place = vtkStratusAMRParts::Place;

constexpr const char* AllBoxes = "StratusBoxes"; // of an AMR's field data: level, first cell, end

int64_t Floor(int64_t a, int64_t b)
{
  return a >= 0 ? a / b : -((-a + b - 1) / b);
}

// Copies the values of a part of an extent.
void CutArrays(vtkDataSetAttributes* from, const int whole[6], vtkDataSetAttributes* to, const int part[6], bool cells)
{
  vtkIdType count[3], size[3];
  for (int a = 0; a < 3; ++a) {
    count[a] = whole[2 * a + 1] - whole[2 * a] + (cells ? 0 : 1);
    size[a] = part[2 * a + 1] - part[2 * a] + (cells ? 0 : 1);
  }
  for (int i = 0; i < from->GetNumberOfArrays(); ++i) {
    vtkDataArray* const array = from->GetArray(i);
    if (!array || !array->GetName()) {
      continue;
    }
    const auto cut = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(array->GetDataType()));
    cut->SetName(array->GetName());
    cut->SetNumberOfComponents(array->GetNumberOfComponents());
    cut->SetNumberOfTuples(size[0] * size[1] * size[2]);
    for (vtkIdType row = 0; row < size[1] * size[2]; ++row) {
      const vtkIdType y = part[2] - whole[2] + row % size[1], z = part[4] - whole[4] + row / size[1];
      cut->InsertTuples(row * size[0], size[0], (z * count[1] + y) * count[0] + part[0] - whole[0], array);
    }
    const int kind = from->IsArrayAnAttribute(i);
    to->AddArray(cut);
    if (kind >= 0) {
      to->SetActiveAttribute(cut->GetName(), kind);
    }
  }
}

bool HasWholeArrays(vtkDataSetAttributes* data, vtkIdType count)
{
  bool whole = true;
  for (int i = 0; i < data->GetNumberOfArrays(); ++i) {
    vtkDataArray* const array = data->GetArray(i);
    whole = whole && (!array || array->GetNumberOfTuples() == count);
  }
  return whole;
}
} // namespace

std::string vtkStratusAMRParts::NameOf(unsigned int level, unsigned int id)
{
  return "box " + std::to_string(id) + " of level " + std::to_string(level);
}

bool vtkStratusAMRParts::FindRatios(vtkOverlappingAMR* amr, Ratios& ratios, std::string& error)
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

bool vtkStratusAMRParts::FindBox(
  vtkOverlappingAMR* amr, unsigned int level, unsigned int id, vtkStratusAMRGrid* grid, Box& box, std::string& error)
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

bool vtkStratusAMRParts::List(vtkOverlappingAMR* amr, std::vector<Held>& boxes)
{
  std::string unused;
  bool good = true;
  for (unsigned int level = 0; level < amr->GetNumberOfLevels(); ++level) {
    for (unsigned int id = 0; id < vtkStratusNumberOfGrids(amr, level); ++id) {
      Held one = { level, id, vtkStratusGridOf(amr, level, id), {} };
      if (!one.Grid || one.Grid->GetNumberOfPoints() == 0) {
        continue;
      }
      good = FindBox(amr, level, id, one.Grid, one.Where, unused) && good;
      good = good && HasWholeArrays(one.Grid->GetPointData(), one.Grid->GetNumberOfPoints());
      good = good && HasWholeArrays(one.Grid->GetCellData(), one.Grid->GetNumberOfCells());
      boxes.push_back(one);
    }
  }
  return good;
}

void vtkStratusAMRParts::SetAll(vtkOverlappingAMR* amr, const std::vector<Box>& boxes)
{
  vtkNew<vtkTypeInt64Array> numbers;
  numbers->SetName(AllBoxes);
  numbers->SetNumberOfComponents(7);
  for (const Box& box : boxes) {
    const double tuple[] = { static_cast<double>(box.Level), static_cast<double>(box.Lo[0]), static_cast<double>(box.Lo[1]),
      static_cast<double>(box.Lo[2]), static_cast<double>(box.Hi[0]), static_cast<double>(box.Hi[1]), static_cast<double>(box.Hi[2]) };
    numbers->InsertNextTuple(tuple);
  }
  amr->GetFieldData()->AddArray(numbers);
}

std::vector<Box> vtkStratusAMRParts::GetAll(vtkOverlappingAMR* amr)
{
  std::vector<Box> boxes;
  std::string unused;
  auto* const numbers = vtkTypeInt64Array::SafeDownCast(amr->GetFieldData()->GetArray(AllBoxes));
  for (vtkIdType i = 0; numbers && numbers->GetNumberOfComponents() == 7 && i < numbers->GetNumberOfTuples(); ++i) {
    const vtkTypeInt64* n = numbers->GetPointer(7 * i);
    boxes.push_back({ static_cast<int>(n[0]), { n[1], n[2], n[3] }, { n[4], n[5], n[6] } });
  }
  for (unsigned int level = 0; !numbers && level < amr->GetNumberOfLevels(); ++level) {
    for (unsigned int id = 0; id < vtkStratusNumberOfGrids(amr, level); ++id) {
      vtkStratusAMRGrid* const grid = vtkStratusGridOf(amr, level, id);
      Box box;
      if (grid && grid->GetNumberOfPoints() > 0 && FindBox(amr, level, id, grid, box, unused)) {
        boxes.push_back(box);
      }
    }
  }
  return boxes;
}

bool vtkStratusAMRParts::FindPiece(
  const Ratios& ratios, const std::vector<Box>& all, int piece, int pieces, Place& lo, Place& hi, Place& cell)
{
  std::vector<Place> cells(ratios.size() + 1, Place{ 2, 2, 2 }); // of each level, in halves of the finest, as the field counts
  for (size_t level = ratios.size(); level-- > 0;) {
    for (size_t axis = 0; axis < 3; ++axis) {
      cells[level][axis] = cells[level + 1][axis] * ratios[level][axis];
    }
  }
  std::vector<vtkStratusAMRLeaves::Box> boxes;
  std::vector<double> values;
  for (const Box& box : all) {
    vtkStratusAMRLeaves::Box one = { box.Level, box.Lo, box.Hi };
    double count = 1.0;
    for (size_t axis = 0; axis < 3; ++axis) {
      const int64_t cell = cells[std::min(static_cast<size_t>(box.Level), ratios.size())][axis];
      count *= static_cast<double>(box.Hi[axis] - box.Lo[axis]);
      one.Lo[axis] *= cell;
      one.Hi[axis] *= cell;
      lo[axis] = boxes.empty() ? one.Lo[axis] : std::min(lo[axis], one.Lo[axis]);
      hi[axis] = boxes.empty() ? one.Hi[axis] : std::max(hi[axis], one.Hi[axis]);
    }
    boxes.push_back(one);
    values.push_back(count);
  }
  cell = cells[0];
  return !boxes.empty() && vtkStratusAMRLeaves::FindPiece(boxes, cell, values, piece, pieces, lo, hi);
}

bool vtkStratusAMRParts::FindNeeded(const Ratios& ratios, const Box& box, const Place& lo, const Place& hi, const Place& cell, Box& part)
{
  bool any = true;
  part.Level = box.Level;
  for (size_t axis = 0; axis < 3; ++axis) {
    int64_t scale = 1;
    for (int level = 0; level < box.Level; ++level) {
      scale *= ratios[static_cast<size_t>(level)][axis];
    }
    part.Lo[axis] = std::max(box.Lo[axis], (Floor(lo[axis], cell[axis]) - MARGIN) * scale);
    part.Hi[axis] = std::min(box.Hi[axis], (MARGIN - Floor(-hi[axis], cell[axis])) * scale);
    any = any && part.Lo[axis] < part.Hi[axis];
  }
  return any;
}

vtkSmartPointer<vtkStratusAMRGrid> vtkStratusAMRParts::Cut(const Held& box, const Box& part)
{
  if (part.Lo == box.Where.Lo && part.Hi == box.Where.Hi) {
    return box.Grid;
  }
  const int* const whole = box.Grid->GetExtent();
  int extent[6];
  for (size_t axis = 0; axis < 3; ++axis) {
    extent[2 * axis] = whole[2 * axis] + static_cast<int>(part.Lo[axis] - box.Where.Lo[axis]);
    extent[2 * axis + 1] = whole[2 * axis] + static_cast<int>(part.Hi[axis] - box.Where.Lo[axis]);
  }
  const auto grid = vtkSmartPointer<vtkStratusAMRGrid>::New();
  grid->SetOrigin(box.Grid->GetOrigin());
  grid->SetSpacing(box.Grid->GetSpacing());
  grid->SetExtent(extent);
  CutArrays(box.Grid->GetPointData(), whole, grid->GetPointData(), extent, false);
  CutArrays(box.Grid->GetCellData(), whole, grid->GetCellData(), extent, true);
  vtkStratusSetUncut(grid, vtkStratusGetUncut(box.Grid));
  return grid;
}
