// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusAMRField.h"

#include "vtkSMPTools.h"

#include <algorithm>
#include <cmath>

namespace {

constexpr int64_t Reach = INT64_C(1) << 20; // tiles along an axis, to each side of 0

std::string Text(const vtkStratusAMRField::Box& box, const std::vector<vtkStratusAMRField::Box>& before)
{
  const auto of_level = [&box](const vtkStratusAMRField::Box& other) { return other.Level == box.Level; };
  return "box " + std::to_string(std::count_if(before.begin(), before.end(), of_level)) + " of level " + std::to_string(box.Level);
}
} // namespace

uint64_t vtkStratusAMRField::KeyOf(const Place& tile)
{
  uint64_t key = 0;
  for (const int64_t along : tile) {
    key = key << 21 | static_cast<uint64_t>(along + Reach);
  }
  return key;
}

bool vtkStratusAMRField::Begin(const std::vector<std::array<int, 3>>& ratios, bool cells, int components, std::string& error)
{
  this->Levels.clear();
  this->Levels.resize(ratios.size() + 1);
  this->Boxes.clear();
  this->Cells = cells;
  this->Components = this->Numbers = components;
  if (this->Levels.size() > 32) {
    error = std::to_string(this->Levels.size()) + " levels of refinement, at most 32 can be drawn";
    return false;
  }
  for (size_t axis = 0; axis < 3; ++axis) {
    this->Levels.back().Cell[axis] = 2;
    for (size_t i = ratios.size(); i-- > 0;) {
      this->Levels[i].Ratio[axis] = ratios[i][axis];
      this->Levels[i].Cell[axis] = this->Levels[i + 1].Cell[axis] * ratios[i][axis];
      if (this->Levels[i].Cell[axis] > INT64_C(1) << 31) {
        error = "cells of level " + std::to_string(i) + " are more than 2^30 of the finest ones wide";
        return false;
      }
    }
  }
  return true;
}

vtkStratusAMRField::Tile& vtkStratusAMRField::Make(int level, const Place& cell, size_t& index)
{
  Place tile;
  index = 0;
  for (size_t axis = 3; axis-- > 0;) {
    tile[axis] = Floor(cell[axis], Side);
    index = index * Side + static_cast<size_t>(cell[axis] - tile[axis] * Side);
  }
  std::unique_ptr<Tile>& found = this->Levels[static_cast<size_t>(level)].Tiles[KeyOf(tile)];
  if (!found) {
    found = std::make_unique<Tile>();
    found->Values.assign(found->State.size() * static_cast<size_t>(this->Components), 0.0);
  }
  return *found;
}

const vtkStratusAMRField::Tile* vtkStratusAMRField::Find(int level, const Place& cell, size_t& index, Cache& cache) const
{
  Place tile;
  index = 0;
  for (size_t axis = 3; axis-- > 0;) {
    tile[axis] = Floor(cell[axis], Side);
    index = index * Side + static_cast<size_t>(cell[axis] - tile[axis] * Side);
  }
  const uint64_t key = KeyOf(tile);
  if (!cache.Last[level] || cache.Key[level] != key) {
    const auto& tiles = this->Levels[static_cast<size_t>(level)].Tiles;
    const auto found = tiles.find(key);
    if (found == tiles.end()) {
      return nullptr;
    }
    cache.Last[level] = found->second.get();
    cache.Key[level] = key;
  }
  return cache.Last[level];
}

uint8_t vtkStratusAMRField::StateOf(int level, const Place& cell, Cache& cache) const
{
  size_t index;
  const Tile* tile = this->Find(level, cell, index, cache);
  return tile ? tile->State[index] : 0;
}

const double* vtkStratusAMRField::ValuesOf(int level, const Place& cell, Cache& cache) const
{
  size_t index;
  const Tile* tile = this->Find(level, cell, index, cache);
  return tile && tile->State[index] & HAS_VALUE ? tile->Values.data() + index * static_cast<size_t>(this->Numbers) : nullptr;
}

bool vtkStratusAMRField::Start(const Box& box, std::string& error)
{
  const int64_t most = Side * Reach - Side;
  for (size_t axis = 0; axis < 3; ++axis) {
    if (box.Hi[axis] <= box.Lo[axis] || box.Lo[axis] < -most || box.Hi[axis] > most) {
      error = Text(box, this->Boxes) + " has the cells " + std::to_string(box.Lo[axis]) + " to " + std::to_string(box.Hi[axis] - 1) +
        " along axis " + std::to_string(axis) + ": one at least is needed, between -" + std::to_string(most) + " and " +
        std::to_string(most);
      return false;
    }
  }
  Cache cache;
  Place at;
  for (at[2] = box.Lo[2]; at[2] < box.Hi[2]; ++at[2]) {
    for (at[1] = box.Lo[1]; at[1] < box.Hi[1]; ++at[1]) {
      for (at[0] = box.Lo[0]; at[0] < box.Hi[0]; ++at[0]) {
        if (this->StateOf(box.Level, at, cache) & EXISTS) {
          error = Text(box, this->Boxes) + " overlaps another box of its level; boxes of a level must lie side by side";
          return false;
        }
      }
    }
  }
  return true;
}

// Marks the coarser cells that a box covers.
bool vtkStratusAMRField::Cover(const Box& box, std::string& error)
{
  const Place& ratio = this->Levels[static_cast<size_t>(box.Level - 1)].Ratio;
  Place lo, hi, at;
  for (size_t axis = 0; axis < 3; ++axis) {
    lo[axis] = Floor(box.Lo[axis], ratio[axis]);
    hi[axis] = Floor(box.Hi[axis], ratio[axis]);
    if (lo[axis] * ratio[axis] != box.Lo[axis] || hi[axis] * ratio[axis] != box.Hi[axis]) {
      error = "a box of level " + std::to_string(box.Level) + " has the cells " + std::to_string(box.Lo[axis]) + " to " +
        std::to_string(box.Hi[axis] - 1) + " along axis " + std::to_string(axis) + ", which are no whole cells of level " +
        std::to_string(box.Level - 1) + ", each " + std::to_string(ratio[axis]) + " wide";
      return false;
    }
  }
  Cache cache;
  size_t index;
  for (at[2] = lo[2]; at[2] < hi[2]; ++at[2]) {
    for (at[1] = lo[1]; at[1] < hi[1]; ++at[1]) {
      for (at[0] = lo[0]; at[0] < hi[0]; ++at[0]) {
        if (!(this->StateOf(box.Level - 1, at, cache) & EXISTS)) {
          error = "a box of level " + std::to_string(box.Level) + " is where level " + std::to_string(box.Level - 1) + " has no cells";
          return false;
        }
        this->Make(box.Level - 1, at, index).State[index] |= COVERED;
      }
    }
  }
  return true;
}

// Gives the cells of a level that finer ones cover these ones' field at their centres.
void vtkStratusAMRField::TakeFiner(int level)
{
  const Level& own = this->Levels[static_cast<size_t>(level)];
  Cache cache;
  Place center, finer;
  for (const Box& box : this->Boxes) {
    for (finer[2] = 0; box.Level == level + 1 && finer[2] < (box.Hi[2] - box.Lo[2]) / own.Ratio[2]; ++finer[2]) {
      for (finer[1] = 0; finer[1] < (box.Hi[1] - box.Lo[1]) / own.Ratio[1]; ++finer[1]) {
        for (finer[0] = 0; finer[0] < (box.Hi[0] - box.Lo[0]) / own.Ratio[0]; ++finer[0]) {
          Place cell;
          for (size_t axis = 0; axis < 3; ++axis) {
            cell[axis] = box.Lo[axis] / own.Ratio[axis] + finer[axis];
            center[axis] = cell[axis] * own.Cell[axis] + own.Cell[axis] / 2;
          }
          size_t index;
          Tile& tile = this->Make(level, cell, index);
          this->EvaluateNode(level + 1, center, cache, tile.Values.data() + index * static_cast<size_t>(this->Components));
        }
      }
    }
  }
}

bool vtkStratusAMRField::End(std::string& error)
{
  for (const Box& box : this->Boxes) {
    if (box.Level > 0 && !this->Cover(box, error)) {
      return false;
    }
  }
  for (int level = this->GetNumberOfLevels() - 2; this->Cells && level >= 0; --level) {
    this->TakeFiner(level);
  }
  return true;
}

bool vtkStratusAMRField::GetRange(double range[2]) const
{
  const auto components = static_cast<size_t>(this->Components), numbers = static_cast<size_t>(this->Numbers);
  range[0] = HUGE_VAL;
  range[1] = -HUGE_VAL;
  for (const Level& level : this->Levels) {
    for (const auto& tile : level.Tiles) {
      for (size_t i = 0; i < tile.second->Values.size(); ++i) {
        const double value = tile.second->Values[i];
        const uint8_t state = tile.second->State[i / numbers];
        if (i % numbers < components && state & HAS_VALUE && !(this->Cells && state & COVERED) && std::fabs(value) <= 1e30) {
          range[0] = std::min(range[0], value);
          range[1] = std::max(range[1], value);
        }
      }
    }
  }
  return range[0] <= range[1];
}

// Gives the numbers of a cell (point) of a level: its values and, behind them, their derivatives.
void vtkStratusAMRField::Differ(int level, const Place& index, Cache& cache, double* out) const
{
  const auto components = static_cast<size_t>(this->Components);
  const auto evaluate = [&](const Place& at, double* values) {
    Place place;
    for (size_t axis = 0; axis < 3; ++axis) {
      const int64_t width = this->GetCell(level, static_cast<int>(axis));
      place[axis] = at[axis] * width + (this->Cells ? width / 2 : 0);
    }
    if (this->Cells && (this->StateOf(level, at, cache) & (EXISTS | COVERED)) == EXISTS) {
      std::copy_n(this->ValuesOf(level, at, cache), components, values);
    } else {
      this->Evaluate(place, cache, values);
    }
  };
  std::vector<double> here(components), sides[2] = { here, here };
  evaluate(index, here.data());
  std::copy_n(this->ValuesOf(level, index, cache), components, out);
  for (size_t axis = 0; axis < 3; ++axis) {
    for (const int side : { 0, 1 }) {
      Place at = index;
      at[axis] += 2 * side - 1;
      evaluate(at, sides[side].data());
    }
    for (size_t c = 0; c < components; ++c) {
      const bool low = std::isfinite(sides[0][c]), high = std::isfinite(sides[1][c]);
      const double rise = (high ? sides[1][c] : here[c]) - (low ? sides[0][c] : here[c]);
      const auto width = static_cast<double>(this->GetCell(level, static_cast<int>(axis)));
      out[components + 3 * c + axis] = low || high ? rise / (low && high ? 2.0 * width : width) : 0.0;
    }
  }
}

void vtkStratusAMRField::TakeGradients()
{
  struct Task {
    int Level;
    Place First; // cell of the tile
    Tile* Of;
    std::vector<double> Numbers;
  };
  std::vector<Task> tasks;
  for (int level = 0; level < this->GetNumberOfLevels(); ++level) {
    for (auto& tile : this->Levels[static_cast<size_t>(level)].Tiles) {
      Task task = { level, {}, tile.second.get(), {} };
      for (size_t axis = 0; axis < 3; ++axis) {
        task.First[axis] = Side * (static_cast<int64_t>(tile.first >> 21 * (2 - axis) & (2 * Reach - 1)) - Reach);
      }
      tasks.push_back(task);
    }
  }
  const auto numbers = static_cast<size_t>(4 * this->Components);
  vtkSMPTools::For(0, static_cast<vtkIdType>(tasks.size()), 1, [&](vtkIdType from, vtkIdType to) {
    Cache cache;
    for (vtkIdType t = from; t < to; ++t) {
      Task& task = tasks[static_cast<size_t>(t)];
      task.Numbers.resize(task.Of->State.size() * numbers);
      for (size_t i = 0; i < task.Of->State.size(); ++i) {
        if (task.Of->State[i] & HAS_VALUE) {
          const auto at = static_cast<int64_t>(i);
          const Place index = { task.First[0] + at % Side, task.First[1] + at / Side % Side, task.First[2] + at / (Side * Side) };
          this->Differ(task.Level, index, cache, task.Numbers.data() + i * numbers);
        }
      }
    }
  });
  for (Task& task : tasks) {
    task.Of->Values.swap(task.Numbers);
  }
  this->Numbers = static_cast<int>(numbers);
}

// Finds the coarsest level of the cells that show and touch a place; -1: there is none.
int vtkStratusAMRField::FindCoarsest(const Place& at, Cache& cache) const
{
  for (int level = 0; level < this->GetNumberOfLevels(); ++level) {
    Place last, first;
    for (size_t axis = 0; axis < 3; ++axis) {
      const int64_t width = this->GetCell(level, static_cast<int>(axis));
      last[axis] = Floor(at[axis], width);
      first[axis] = last[axis] - (last[axis] * width == at[axis] ? 1 : 0);
    }
    for (int64_t k = first[2]; k <= last[2]; ++k) {
      for (int64_t j = first[1]; j <= last[1]; ++j) {
        for (int64_t i = first[0]; i <= last[0]; ++i) {
          if ((this->StateOf(level, { i, j, k }, cache) & (EXISTS | COVERED)) == EXISTS) {
            return level;
          }
        }
      }
    }
  }
  return -1;
}

void vtkStratusAMRField::EvaluateNode(int level, const Place& at, Cache& cache, double* sums) const
{
  const auto numbers = static_cast<size_t>(this->Numbers);
  int64_t first[3];
  int counts[3];
  for (int axis = 0; axis < 3; ++axis) {
    const int64_t width = this->GetCell(level, axis), place = at[static_cast<size_t>(axis)];
    first[axis] = Floor(place, width);
    counts[axis] = 1;
    if (this->Cells && first[axis] * width == place) { // between two cells
      --first[axis];
      counts[axis] = 2;
    }
  }
  std::fill_n(sums, numbers, 0.0);
  int found = 0;
  for (int k = 0; k < counts[2]; ++k) {
    for (int j = 0; j < counts[1]; ++j) {
      for (int i = 0; i < counts[0]; ++i) {
        if (const double* values = this->ValuesOf(level, { first[0] + i, first[1] + j, first[2] + k }, cache)) {
          ++found;
          for (size_t c = 0; c < numbers; ++c) {
            sums[c] += values[c];
          }
        }
      }
    }
  }
  for (size_t c = 0; c < numbers && found > 1; ++c) {
    sums[c] /= found;
  }
}

void vtkStratusAMRField::Evaluate(const Place& at, Cache& cache, double* sums) const
{
  const int level = this->FindCoarsest(at, cache);
  const auto numbers = static_cast<size_t>(this->Numbers);
  if (level < 0) {
    std::fill_n(sums, numbers, std::numeric_limits<double>::quiet_NaN());
    return;
  }
  Place lo;
  double share[3];
  int64_t width[3];
  bool on_node = true;
  for (size_t axis = 0; axis < 3; ++axis) {
    width[axis] = this->GetCell(level, static_cast<int>(axis)) / (this->Cells ? 2 : 1);
    lo[axis] = Floor(at[axis], width[axis]) * width[axis];
    share[axis] = static_cast<double>(at[axis] - lo[axis]) / static_cast<double>(width[axis]);
    on_node = on_node && lo[axis] == at[axis];
  }
  if (on_node) {
    this->EvaluateNode(level, at, cache, sums);
    return;
  }
  std::fill_n(sums, numbers, 0.0);
  for (size_t c = 0; c < 8; ++c) {
    double weight = 1.0;
    Place node = lo;
    for (size_t axis = 0; axis < 3; ++axis) {
      const bool upper = (c >> axis & 1) != 0;
      weight *= upper ? share[axis] : 1.0 - share[axis];
      node[axis] += upper ? width[axis] : 0;
    }
    if (weight > 0.0) {
      const double* corner = this->EvaluateCorner(level, lo, c, node, cache);
      for (size_t i = 0; i < numbers; ++i) {
        sums[i] += weight * corner[i];
      }
    }
  }
}

// Returns the field at a corner of a part of a cell. The cache holds the last part.
const double* vtkStratusAMRField::EvaluateCorner(int level, const Place& part, size_t corner, const Place& node, Cache& cache) const
{
  const auto numbers = static_cast<size_t>(this->Numbers);
  Part& kept = cache.Parts[level];
  if (kept.Values.empty() || kept.Lo != part) {
    kept.Lo = part;
    kept.Known = 0;
    kept.Values.resize(8 * numbers);
  }
  double* values = kept.Values.data() + corner * numbers;
  if (!(kept.Known >> corner & 1)) {
    this->Evaluate(node, cache, values); // at a corner of its own or in a part of a coarser level
    kept.Known |= 1 << corner;
  }
  return values;
}

bool vtkStratusAMRField::EvaluateCell(const Place& lo, const Place& hi, Cache& cache, double* values) const
{
  for (int level = this->GetNumberOfLevels() - 1; level >= 0; --level) {
    Place cell;
    for (size_t axis = 0; axis < 3; ++axis) {
      cell[axis] = Floor(lo[axis] + (hi[axis] - lo[axis]) / 2, this->GetCell(level, static_cast<int>(axis)));
    }
    if (this->StateOf(level, cell, cache) & EXISTS) {
      std::copy_n(this->ValuesOf(level, cell, cache), static_cast<size_t>(this->Numbers), values);
      return true;
    }
  }
  return false;
}
