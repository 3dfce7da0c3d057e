// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusAMRLeaves.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace {

// Values that count as much as one more grid, which takes some 3 ms of each frame: 2.8 million cells in 680 boxes took .06 s as 7 grids of
// 57 million values, and .7 s as 226 grids of 31 million (AMD EPYC, 2 cores).
constexpr double GridCost = 300000.0;
constexpr size_t MostPlanes = 48; // of an axis, that are tried

using Place = vtkStratusAMRField::Place;

double Volume(const Place& lo, const Place& hi)
{
  double volume = 1.0;
  for (size_t axis = 0; axis < 3; ++axis) {
    volume *= static_cast<double>(std::max<int64_t>(hi[axis] - lo[axis], 0));
  }
  return volume;
}

double Shared(const Place& lo, const Place& hi, const Place& other_lo, const Place& other_hi)
{
  Place from, to;
  for (size_t axis = 0; axis < 3; ++axis) {
    from[axis] = std::max(lo[axis], other_lo[axis]);
    to[axis] = std::min(hi[axis], other_hi[axis]);
  }
  return Volume(from, to);
}
} // namespace

bool vtkStratusAMRLeaves::FindPiece(
  const std::vector<Box>& boxes, const Place& cell, const std::vector<double>& values, int piece, int pieces, Place& lo, Place& hi)
{
  const auto values_in = [&](const Place& from, const Place& to) {
    double sum = 0.0;
    for (size_t i = 0; i < boxes.size(); ++i) {
      sum += values[i] * Shared(from, to, boxes[i].Lo, boxes[i].Hi) / Volume(boxes[i].Lo, boxes[i].Hi);
    }
    return sum;
  };
  if (piece >= pieces) {
    return false;
  }
  while (pieces > 1) {
    size_t axis = 0;
    for (size_t other = 1; other < 3; ++other) {
      axis = (hi[other] - lo[other]) / cell[other] > (hi[axis] - lo[axis]) / cell[axis] ? other : axis;
    }
    const int below = pieces / 2;
    const double wanted = values_in(lo, hi) * below / pieces;
    int64_t first = 1, last = (hi[axis] - lo[axis]) / cell[axis] - 1; // planes, from lo
    if (last < first) {
      return piece == 0;
    }
    Place middle = hi;
    while (first < last) {
      const int64_t plane = first + (last - first) / 2;
      middle[axis] = lo[axis] + plane * cell[axis];
      const bool beyond = values_in(lo, middle) < wanted;
      first = beyond ? plane + 1 : first;
      last = beyond ? last : plane;
    }
    const int64_t plane = lo[axis] + first * cell[axis];
    if (piece < below) {
      hi[axis] = plane;
      pieces = below;
    } else {
      lo[axis] = plane;
      piece -= below;
      pieces -= below;
    }
  }
  return true;
}

vtkStratusAMRLeaves::vtkStratusAMRLeaves(
  const vtkStratusAMRField& field, const std::vector<vtkStratusAMRField::Box>& all, bool nearest, int piece, int pieces)
    : Field(field), Nearest(nearest)
{
  std::vector<Box> boxes;
  std::vector<double> values;
  Place cell;
  for (size_t axis = 0; axis < 3; ++axis) {
    cell[axis] = field.GetCell(0, static_cast<int>(axis));
  }
  for (const vtkStratusAMRField::Box& box : all) {
    Box one = { box.Level, box.Lo, box.Hi };
    for (size_t axis = 0; axis < 3; ++axis) {
      const int64_t cell = field.GetCell(box.Level, static_cast<int>(axis));
      one.Lo[axis] *= cell;
      one.Hi[axis] *= cell;
      this->WholeLo[axis] = boxes.empty() ? one.Lo[axis] : std::min(this->WholeLo[axis], one.Lo[axis]);
      this->WholeHi[axis] = boxes.empty() ? one.Hi[axis] : std::max(this->WholeHi[axis], one.Hi[axis]);
    }
    boxes.push_back(one);
    values.push_back(Volume(box.Lo, box.Hi));
  }
  Place lo = this->WholeLo, hi = this->WholeHi;
  if (!boxes.empty() && FindPiece(boxes, cell, values, piece, pieces, lo, hi)) {
    this->Divide(boxes, lo, hi);
  }
}

// Returns how much of lo..hi the boxes of a level fill. They don't overlap. Whole numbers below 2^53 and sums of them are exact; beyond, a
// part counts as filled that nearly is, which changes which lattice is chosen, but only where a hole is a billionth of the part.
double vtkStratusAMRLeaves::VolumeIn(const std::vector<Box>& boxes, int level, const Place& lo, const Place& hi) const
{
  double sum = 0.0;
  for (const Box& box : boxes) {
    sum += box.Level == level ? Shared(lo, hi, box.Lo, box.Hi) : 0.0;
  }
  return sum;
}

// covered: whether cells fill it, so that it may be a leaf.
vtkStratusAMRLeaf vtkStratusAMRLeaves::Describe(const std::vector<Box>& boxes, const Place& lo, const Place& hi, bool& covered) const
{
  vtkStratusAMRLeaf leaf;
  leaf.Lo = lo;
  leaf.Hi = hi;
  leaf.Level = -1;
  for (const Box& box : boxes) {
    if (box.Level > leaf.Level && Shared(lo, hi, box.Lo, box.Hi) > 0.0) {
      leaf.Level = box.Level;
    }
  }
  covered = leaf.Level >= 0 && this->VolumeIn(boxes, 0, lo, hi) == Volume(lo, hi);
  if (covered && this->Field.IsOfCells() && !this->Nearest) {
    Place around_lo, around_hi;
    bool whole = true; // cells of its level
    for (size_t axis = 0; axis < 3; ++axis) {
      const int64_t cell = this->Field.GetCell(leaf.Level, static_cast<int>(axis));
      around_lo[axis] = std::max(lo[axis] - cell, this->WholeLo[axis]);
      around_hi[axis] = std::min(hi[axis] + cell, this->WholeHi[axis]);
      whole = whole && lo[axis] % cell == 0 && hi[axis] % cell == 0;
    }
    leaf.Even = whole && this->VolumeIn(boxes, leaf.Level, around_lo, around_hi) == Volume(around_lo, around_hi);
  }
  return leaf;
}

std::vector<int64_t> vtkStratusAMRLeaves::GetPlanes(const vtkStratusAMRLeaf& leaf, int axis) const
{
  const auto a = static_cast<size_t>(axis);
  const int64_t cell = this->Field.GetCell(leaf.Level, axis);
  const bool parts = this->Field.IsOfCells() && !this->Nearest;
  const int64_t step = parts && !leaf.Even ? cell / 2 : cell, first = leaf.Even ? leaf.Lo[a] + cell / 2 : leaf.Lo[a] + 1;
  std::vector<int64_t> planes = { leaf.Lo[a] };
  for (int64_t at = leaf.Even ? first : (first >= 0 ? (first + step - 1) / step : -(-first / step)) * step; at < leaf.Hi[a]; at += step) {
    planes.push_back(at);
  }
  planes.push_back(leaf.Hi[a]);
  return planes;
}

double vtkStratusAMRLeaves::CostOf(const vtkStratusAMRLeaf& leaf) const
{
  if (leaf.Level < 0) {
    return 0.0; // there is nothing
  }
  double values = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<size_t>(axis);
    const bool parts = this->Field.IsOfCells() && !this->Nearest && !leaf.Even;
    values *=
      static_cast<double>((leaf.Hi[a] - leaf.Lo[a]) * (parts ? 2 : 1)) / static_cast<double>(this->Field.GetCell(leaf.Level, axis)) + 1.0;
  }
  return values + GridCost;
}

// Takes a part of one level that borders on coarser cells as an even core and slabs of one cell about it, where that is cheaper.
bool vtkStratusAMRLeaves::Peel(const std::vector<Box>& boxes, const vtkStratusAMRLeaf& leaf)
{
  if (leaf.Even || !this->Field.IsOfCells() || this->Nearest ||
    this->VolumeIn(boxes, leaf.Level, leaf.Lo, leaf.Hi) != Volume(leaf.Lo, leaf.Hi)) {
    return false;
  }
  const auto trim = [this, &leaf](int sides) {
    vtkStratusAMRLeaf core = leaf;
    for (int side = 0; side < 6; ++side) {
      const auto axis = static_cast<size_t>(side / 2);
      const int64_t cell = sides >> side & 1 ? this->Field.GetCell(leaf.Level, side / 2) : 0;
      (side % 2 ? core.Hi : core.Lo)[axis] += side % 2 ? -cell : cell;
    }
    return core;
  };
  const auto is_even = [&](int sides) {
    const vtkStratusAMRLeaf core = trim(sides);
    bool covered = false;
    return Volume(core.Lo, core.Hi) > 0.0 && this->Describe(boxes, core.Lo, core.Hi, covered).Even;
  };
  int sides = 63;
  if (!is_even(sides)) {
    return false;
  }
  for (int side = 0; side < 6; ++side) {
    sides = is_even(sides & ~(1 << side)) ? sides & ~(1 << side) : sides;
  }
  std::vector<vtkStratusAMRLeaf> parts;
  vtkStratusAMRLeaf rest = leaf;
  const vtkStratusAMRLeaf core = trim(sides);
  for (int side = 0; side < 6; ++side) {
    const auto axis = static_cast<size_t>(side / 2);
    if (sides >> side & 1) {
      vtkStratusAMRLeaf slab = rest;
      (side % 2 ? slab.Lo : slab.Hi)[axis] = (side % 2 ? core.Hi : core.Lo)[axis];
      (side % 2 ? rest.Hi : rest.Lo)[axis] = (side % 2 ? core.Hi : core.Lo)[axis];
      parts.push_back(slab);
    }
  }
  rest.Even = true;
  parts.push_back(rest);
  double cost = 0.0;
  for (const vtkStratusAMRLeaf& part : parts) {
    cost += this->CostOf(part);
  }
  if (cost >= this->CostOf(leaf)) {
    return false;
  }
  this->Leaves.insert(this->Leaves.end(), parts.begin(), parts.end());
  return true;
}

// Returns the cost of the leaves that it makes.
double vtkStratusAMRLeaves::Divide(const std::vector<Box>& boxes, const Place& lo, const Place& hi)
{
  std::vector<Box> near; // those that touch it, or lie a cell away
  std::vector<const Box*> within;
  Place from, to;
  for (size_t axis = 0; axis < 3; ++axis) {
    const int64_t cell = this->Field.GetCell(0, static_cast<int>(axis));
    from[axis] = lo[axis] - cell;
    to[axis] = hi[axis] + cell;
  }
  std::copy_if(
    boxes.begin(), boxes.end(), std::back_inserter(near), [&](const Box& box) { return Shared(from, to, box.Lo, box.Hi) > 0.0; });
  for (const Box& box : near) {
    if (Shared(lo, hi, box.Lo, box.Hi) > 0.0) {
      within.push_back(&box);
    }
  }
  if (within.empty()) {
    return 0.0;
  }
  bool covered = false;
  const vtkStratusAMRLeaf whole = this->Describe(near, lo, hi, covered);
  const bool one_level = covered && this->VolumeIn(near, whole.Level, lo, hi) == Volume(lo, hi);
  const size_t first = this->Leaves.size();
  Place middle_hi, middle_lo;
  if (!one_level && this->FindPlane(near, within, lo, hi, middle_hi, middle_lo)) {
    const double cost = this->Divide(near, lo, middle_hi) + this->Divide(near, middle_lo, hi);
    if (!covered || cost < this->CostOf(whole)) {
      return cost;
    }
    this->Leaves.resize(first);
  }
  if (!covered) {
    return 0.0;
  }
  if (!one_level || !this->Peel(near, whole)) {
    this->Leaves.push_back(whole);
  }
  double cost = 0.0;
  for (size_t i = first; i < this->Leaves.size(); ++i) {
    cost += this->CostOf(this->Leaves[i]);
  }
  return cost;
}

// Finds the plane along a box's side whose two parts cost least as they are. Returns false where none cuts lo..hi.
bool vtkStratusAMRLeaves::FindPlane(const std::vector<Box>& near, const std::vector<const Box*>& within, const Place& lo, const Place& hi,
  Place& middle_hi, Place& middle_lo) const
{
  double best = HUGE_VAL;
  for (size_t axis = 0; axis < 3; ++axis) {
    std::vector<int64_t> planes;
    for (const Box* box : within) {
      for (const int64_t plane : { box->Lo[axis], box->Hi[axis] }) {
        if (plane > lo[axis] && plane < hi[axis]) {
          planes.push_back(plane);
        }
      }
    }
    std::sort(planes.begin(), planes.end());
    planes.erase(std::unique(planes.begin(), planes.end()), planes.end());
    const size_t count = std::min(planes.size(), MostPlanes);
    for (size_t i = 0; i < count; ++i) {
      Place below = hi, above = lo;
      below[axis] = above[axis] = planes[(i + 1) * planes.size() / (count + 1)];
      bool unused;
      // Among cuts of equal cost, prefer parts of equal size: the more the parts are halved, the fewer steps lead to parts of one level.
      const double cost = this->CostOf(this->Describe(near, lo, below, unused)) + this->CostOf(this->Describe(near, above, hi, unused)) +
        GridCost * std::fabs(Volume(lo, below) - Volume(above, hi)) / Volume(lo, hi);
      if (cost < best) {
        best = cost;
        middle_hi = below;
        middle_lo = above;
      }
    }
  }
  return best < HUGE_VAL;
}
