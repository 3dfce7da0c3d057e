// SPDX-License-Identifier: BSD-3-Clause
// The grids of a piece of AMR, made of the parts of boxes that the piece needs: the bits of those that all boxes give, for cells, points,
// gradients and several ratios of levels; and how many cells a piece needs.
#include "vtkStratusAMR.h"
#include "vtkStratusAMRParts.h"
#include "vtkStratusUncut.h"

#include "vtkAMRBox.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkMinimalStandardRandomSequence.h"
#include "vtkNew.h"
#include "vtkOverlappingAMR.h"
#include "vtkPointData.h"
#include "vtkRectilinearGrid.h"
#include "vtkSmartPointer.h"
#include "vtkStructuredData.h"
#include "vtkUniformGrid.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

namespace {
using Parts = vtkStratusAMRParts;
using Box = Parts::Box;
using Place = Parts::Place;

int failures = 0;

void check(bool right, const std::string& what)
{
  if (!right) {
    std::printf("FAILED: %s\n", what.c_str());
    ++failures;
  }
}

vtkNew<vtkMinimalStandardRandomSequence> Random;

int64_t Any(int64_t least, int64_t most)
{
  Random->Next();
  return least + static_cast<int64_t>(Random->GetValue() * static_cast<double>(most - least + 1));
}

bool Overlap(const Box& a, const Box& b)
{
  bool overlap = a.Level == b.Level;
  for (size_t axis = 0; axis < 3; ++axis) {
    overlap = overlap && a.Lo[axis] < b.Hi[axis] && b.Lo[axis] < a.Hi[axis];
  }
  return overlap;
}

// Twelve boxes of level 0, and boxes within them of two finer levels.
std::vector<Box> MakeBoxes(const int ratios[2])
{
  std::vector<Box> boxes;
  for (int64_t i = 0; i < 12; ++i) {
    const Place lo = { -5 + 12 * (i % 4), 7 + 9 * (i / 4), -3 };
    boxes.push_back({ 0, lo, { lo[0] + 12, lo[1] + 9, lo[2] + 11 } });
  }
  for (int level = 1; level < 3; ++level) {
    const std::vector<Box> coarser = boxes;
    for (int tries = 0; tries < 20; ++tries) {
      const Box& within = coarser[static_cast<size_t>(Any(0, static_cast<int64_t>(coarser.size()) - 1))];
      Box box = { level, {}, {} };
      for (size_t axis = 0; axis < 3; ++axis) {
        const int64_t ratio = ratios[level - 1];
        const int64_t from = Any(within.Lo[axis], within.Hi[axis] - 1), to = Any(from + 1, std::min(within.Hi[axis], from + 4));
        box.Lo[axis] = from * ratio;
        box.Hi[axis] = to * ratio;
      }
      bool fits = within.Level == level - 1;
      for (const Box& other : boxes) {
        fits = fits && !Overlap(box, other);
      }
      if (fits) {
        boxes.push_back(box);
      }
    }
  }
  return boxes;
}

vtkSmartPointer<vtkOverlappingAMR> MakeData(const std::vector<Box>& boxes, const int ratios[2], bool cells)
{
  auto amr = vtkSmartPointer<vtkOverlappingAMR>::New();
  int counts[3] = { 0, 0, 0 };
  for (const Box& box : boxes) {
    ++counts[box.Level];
  }
  const double origin[3] = { 0.3, -20.0, 1e3 };
  double spacing[3] = { 0.7, 1.1, 0.9 };
  unsigned int ids[3] = { 0, 0, 0 };
  amr->Initialize(3, counts);
  amr->SetOrigin(origin);
  amr->SetGridDescription(VTK_XYZ_GRID);
  for (unsigned int level = 0; level < 3; ++level) {
    amr->SetSpacing(level, spacing);
    for (const Box& box : boxes) {
      if (box.Level != static_cast<int>(level)) {
        continue;
      }
      vtkNew<vtkUniformGrid> grid;
      double place[3];
      int lo[3], hi[3];
      for (size_t axis = 0; axis < 3; ++axis) {
        place[axis] = origin[axis] + spacing[axis] * static_cast<double>(box.Lo[axis]);
        lo[axis] = static_cast<int>(box.Lo[axis]);
        hi[axis] = static_cast<int>(box.Hi[axis]) - 1;
      }
      grid->SetOrigin(place);
      grid->SetSpacing(spacing);
      grid->SetDimensions(hi[0] - lo[0] + 2, hi[1] - lo[1] + 2, hi[2] - lo[2] + 2);
      vtkNew<vtkDoubleArray> values;
      values->SetName("rho");
      values->SetNumberOfTuples(cells ? grid->GetNumberOfCells() : grid->GetNumberOfPoints());
      for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i) {
        Random->Next();
        values->SetValue(i, Random->GetValue());
      }
      (cells ? static_cast<vtkDataSetAttributes*>(grid->GetCellData()) : grid->GetPointData())->SetScalars(values);
      amr->SetAMRBox(level, ids[level], vtkAMRBox(lo, hi));
      amr->SetDataSet(level, ids[level]++, grid);
    }
    for (double& along : spacing) {
      along /= level < 2 ? ratios[level] : 1;
    }
  }
  return amr;
}

// The parts that a piece needs, and the places of all boxes. margin: cells of level 0 that are taken away on each side.
vtkSmartPointer<vtkOverlappingAMR> Take(vtkOverlappingAMR* amr, int piece, int pieces, int64_t margin, bool& nothing)
{
  auto part_of = vtkSmartPointer<vtkOverlappingAMR>::New();
  std::vector<Parts::Held> boxes;
  Parts::Ratios ratios;
  std::string error;
  check(Parts::List(amr, boxes) && Parts::FindRatios(amr, ratios, error), "the data can be cut");
  std::vector<Box> all;
  for (const Parts::Held& box : boxes) {
    all.push_back(box.Where);
  }
  part_of->CopyStructure(amr);
  Parts::SetAll(part_of, all);
  Place lo, hi, cell;
  nothing = !Parts::FindPiece(ratios, all, piece, pieces, lo, hi, cell);
  for (size_t axis = 0; axis < 3; ++axis) {
    lo[axis] += margin * cell[axis];
    hi[axis] -= margin * cell[axis];
  }
  for (const Parts::Held& box : boxes) {
    Box part;
    if (!nothing && Parts::FindNeeded(ratios, box.Where, lo, hi, cell, part)) {
      part_of->SetDataSet(box.Level, box.Id, Parts::Cut(box, part));
    }
  }
  return part_of;
}

bool SameArray(vtkDataArray* a, vtkDataArray* b)
{
  return !a || !b ? a == b
                  : a->GetDataType() == b->GetDataType() && a->GetNumberOfValues() == b->GetNumberOfValues() &&
      std::memcmp(a->GetVoidPointer(0), b->GetVoidPointer(0), static_cast<size_t>(a->GetNumberOfValues() * a->GetDataTypeSize())) == 0;
}

bool SameGrid(vtkDataSet* a, vtkDataSet* b)
{
  bool same = std::string(a->GetClassName()) == b->GetClassName() && a->GetNumberOfPoints() == b->GetNumberOfPoints();
  for (vtkIdType i = 0; same && i < a->GetNumberOfPoints(); ++i) {
    double one[3], other[3];
    a->GetPoint(i, one);
    b->GetPoint(i, other);
    same = std::memcmp(one, other, sizeof one) == 0;
  }
  const float *first = vtkStratusAMR::GetGradients(a), *second = vtkStratusAMR::GetGradients(b);
  return same && SameArray(a->GetPointData()->GetScalars(), b->GetPointData()->GetScalars()) &&
    SameArray(a->GetCellData()->GetScalars(), b->GetCellData()->GetScalars()) && !first == !second &&
    SameArray(a->GetFieldData()->GetArray(0), b->GetFieldData()->GetArray(0));
}

bool SameGrids(const vtkStratusAMR& a, const vtkStratusAMR& b)
{
  bool same = a.GetGrids().size() == b.GetGrids().size();
  for (size_t i = 0; same && i < a.GetGrids().size(); ++i) {
    same = SameGrid(a.GetGrids()[i], b.GetGrids()[i]);
  }
  return same;
}

vtkDataArray* FindArray(vtkDataSet* grid, bool& cells)
{
  cells = grid->GetCellData()->GetArray("rho") != nullptr;
  return cells ? grid->GetCellData()->GetArray("rho") : grid->GetPointData()->GetArray("rho");
}

void TestPieces(const int ratios[2], bool cells)
{
  const auto amr = MakeData(MakeBoxes(ratios), ratios, cells);
  const auto whole = static_cast<double>(amr->GetNumberOfElements(vtkDataObject::CELL));
  int differ = 0;
  for (const int pieces : { 2, 5 }) {
    double held = 0.0, most = 0.0;
    size_t grids = 0;
    for (int piece = 0; piece < pieces; ++piece) {
      bool nothing = false, unused = false;
      const auto part = Take(amr, piece, pieces, 0, nothing), less = Take(amr, piece, pieces, Parts::MARGIN, unused);
      const std::string what = "piece " + std::to_string(piece) + " of " + std::to_string(pieces) + ", ratios " +
        std::to_string(ratios[0]) + " and " + std::to_string(ratios[1]) + (cells ? ", cells" : ", points");
      for (int kind = 0; kind < (cells ? 3 : 2); ++kind) { // plain, with gradients, nearest
        const vtkStratusAMR::Use use = { kind == 2, kind == 1, piece, pieces };
        vtkStratusAMR all, own, bare;
        std::string error;
        check(all.Set(amr, FindArray, use, error) && own.Set(part, FindArray, use, error), what + ": " + error);
        check(SameGrids(all, own), what + ": other grids than of all boxes, kind " + std::to_string(kind));
        differ += bare.Set(less, FindArray, use, error) && SameGrids(all, bare) ? 0 : 1;
        grids += own.GetGrids().size();
      }
      double bounds[2][6] = {};
      check(vtkStratusAMR::GetBounds(amr, piece, pieces, bounds[0]) == !nothing &&
          vtkStratusAMR::GetBounds(part, piece, pieces, bounds[1]) == !nothing && std::memcmp(bounds[0], bounds[1], sizeof bounds[0]) == 0,
        what + ": other bounds");
      const auto own = static_cast<double>(part->GetNumberOfElements(vtkDataObject::CELL));
      held += own;
      most = std::max(most, own);
    }
    check(grids > 0, "something is made");
    std::printf("%d pieces: the largest holds %.2f of the cells, all together %.2f\n", pieces, most / whole, held / whole);
    check(most < (pieces == 2 ? 0.8 : 0.6) * whole, std::to_string(pieces) + " pieces hold too much");
  }
  check(differ > 0, "without the cells around them, pieces are others: the comparison can fail");
}

// Cells of a part are numbered as they were.
void TestNumbers()
{
  const int ratios[2] = { 2, 2 };
  const auto amr = MakeData(MakeBoxes(ratios), ratios, true);
  bool nothing = false;
  const auto part = Take(amr, 1, 3, 0, nothing);
  int cut = 0;
  for (unsigned int id = 0; id < amr->GetNumberOfDataSets(0); ++id) {
    vtkUniformGrid *whole = amr->GetDataSet(0, id), *own = part->GetDataSet(0, id);
    cut += own && own != whole ? 1 : 0;
    for (vtkIdType i = 0; own && i < own->GetNumberOfCells(); ++i) {
      double bounds[6], at[3], within[3], weights[8];
      int ijk[3], unused;
      own->GetCellBounds(i, bounds);
      for (int a = 0; a < 3; ++a) {
        at[a] = 0.5 * (bounds[2 * a] + bounds[2 * a + 1]);
        ijk[a] = static_cast<int>(std::floor((at[a] - own->GetOrigin()[a]) / own->GetSpacing()[a]));
      }
      const vtkIdType number = vtkStructuredData::ComputeCellIdForExtent(vtkStratusGetUncut(own), ijk);
      if (number != whole->vtkImageData::FindCell(at, nullptr, -1, 0.0, unused, within, weights) ||
        whole->GetCellData()->GetScalars()->GetComponent(number, 0) != own->GetCellData()->GetScalars()->GetComponent(i, 0)) {
        check(false, "a cell of a part has another number than in its box");
        return;
      }
    }
  }
  check(cut > 0, "boxes are cut");
}
} // namespace

int main()
{
  Random->SetSeed(7);
  const int all[2][2] = { { 2, 2 }, { 3, 2 } };
  for (const auto& ratios : all) {
    for (const bool cells : { true, false }) {
      TestPieces(ratios, cells);
    }
  }
  TestNumbers();
  return failures ? 1 : 0;
}
