// SPDX-License-Identifier: BSD-3-Clause
// The continuous field of values on boxes of several levels of refinement, where each place has its finest level. Private to the modules.
//
// Places are counted in whole numbers of *units* along each axis, half a cell of the finest level, so that cells, their centres and their
// corners are whole on all levels, and whatever two levels share is the same number.
//
// Cell values are at cells' centres. A cell that finer cells cover has their field's value at its centre: the mean of the finer cells
// around it. Each visible cell is divided in eight at its centre. A corner of these parts that touches cells of one level, finer ones
// included, has the mean of the cells of that level around it, as in linear interpolation between centres. A corner that touches a coarser
// visible cell has the coarser side's value there. Within a part the field is trilinear. Two levels therefore have equal values where they
// meet, whatever their ratio: there is no crack. Point values work alike, with whole cells in place of parts.
//
// The gradient of each cell (point) of each level, covered ones included, is by differences of this field at places one width of the cell
// before and behind its centre (the point). A place without the field leaves the one-sided difference. These gradients are interpolated as
// values are, across levels, too: so they are continuous wherever the field is, and do not depend on the grids that hold it.
#ifndef vtkStratusAMRField_h
#define vtkStratusAMRField_h

#include "vtkStratusPrivate.h"

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

class VTK_STRATUS_PRIVATE vtkStratusAMRField
{
public:
  using Place = std::array<int64_t, 3>;

  // Cells lo..hi - 1 of a level, in that level's own count.
  struct Box {
    int Level = 0;
    Place Lo{}, Hi{};
  };

  // ratios: how many cells of level i + 1 fit along a cell of level i; one fewer than there are levels. Returns false, with the reason, if
  // the number of places is too large to count.
  bool Begin(const std::vector<std::array<int, 3>>& ratios, bool cells, int components, std::string& error);
  // Adds a box of the values value(i): of its cells or its points, x fastest. hidden(i): whether it shows nothing; it gets the value NaN.
  // Returns false, with the reason, where another box of the level has one of its cells. Boxes of a level are numbered as they come.
  template <class Value, class Hidden> bool Add(const Box& box, const Value& value, const Hidden& hidden, std::string& error);
  // Must follow the last Add(). Returns false, with the reason, if a box does not cover whole cells of the next coarser level.
  bool End(std::string& error);
  // Makes the gradients. Must follow End().
  void TakeGradients();

  // Results that one thread keeps from one place to the next.
  struct Cache;

  int GetNumberOfLevels() const { return static_cast<int>(this->Levels.size()); }
  int GetNumberOfComponents() const { return this->Components; }
  // Numbers at each place: the components, and behind them each one's derivatives, per unit, along the axes, if there are gradients.
  int GetNumberOfNumbers() const { return this->Numbers; }
  bool IsOfCells() const { return this->Cells; }
  // Gets the range of the visible values, without values beyond 1e30, which mean "no value". Returns false if there are none.
  bool GetRange(double range[2]) const;
  // Units along a cell of a level.
  int64_t GetCell(int level, int axis) const { return this->Levels[static_cast<size_t>(level)].Cell[static_cast<size_t>(axis)]; }

  // Gives the field at a place in units, whose closed surroundings hold a cell at least; NaN elsewhere. sums: as many as there are numbers.
  void Evaluate(const Place& at, Cache& cache, double* sums) const;
  // Gives what Evaluate() does at a corner of parts of `level`, or a point, that touches no coarser cell.
  void EvaluateNode(int level, const Place& at, Cache& cache, double* sums) const;
  // Gives the value of the finest cell that holds the middle of lo..hi, in units; values are of cells. Returns false where there is none.
  bool EvaluateCell(const Place& lo, const Place& hi, Cache& cache, double* values) const;

private:
  static constexpr int Side = 8; // of a tile, in cells
  struct Tile {
    std::array<uint8_t, Side * Side * Side> State{}; // of cells: EXISTS, COVERED
    std::vector<double> Values;                      // of cells or points; NaN: not there
  };
  struct Level {
    Place Cell{};  // in units
    Place Ratio{}; // to the next finer level
    std::unordered_map<uint64_t, std::unique_ptr<Tile>> Tiles;
  };
  // The part of a cell in which a place was last, and the field at its corners.
  struct Part {
    Place Lo{};
    int Known = 0; // a bit a corner
    std::vector<double> Values;
  };
  enum State : uint8_t { EXISTS = 1, COVERED = 2, HAS_VALUE = 4 };

  static int64_t Floor(int64_t a, int64_t b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }
  static uint64_t KeyOf(const Place& tile);
  Tile& Make(int level, const Place& cell, size_t& index);
  const Tile* Find(int level, const Place& cell, size_t& index, Cache& cache) const;
  uint8_t StateOf(int level, const Place& cell, Cache& cache) const;
  const double* ValuesOf(int level, const Place& cell, Cache& cache) const;
  bool Start(const Box& box, std::string& error);
  int FindCoarsest(const Place& at, Cache& cache) const;
  void Differ(int level, const Place& index, Cache& cache, double* out) const;
  const double* EvaluateCorner(int level, const Place& part, size_t corner, const Place& node, Cache& cache) const;
  bool Cover(const Box& box, std::string& error);
  void TakeFiner(int level);

  std::vector<Level> Levels;
  std::vector<Box> Boxes;
  bool Cells = true;
  int Components = 1, Numbers = 1;
};

struct vtkStratusAMRField::Cache {
  const vtkStratusAMRField::Tile* Last[32] = {};
  uint64_t Key[32];
  Part Parts[32]; // of each level
};

template <class Value, class Hidden>
bool vtkStratusAMRField::Add(const Box& box, const Value& value, const Hidden& hidden, std::string& error)
{
  if (!this->Start(box, error)) {
    return false;
  }
  const auto components = static_cast<size_t>(this->Components);
  const int64_t more = this->Cells ? 0 : 1;
  int64_t number = 0;
  size_t index = 0;
  Place at;
  for (at[2] = box.Lo[2]; at[2] < box.Hi[2] + more; ++at[2]) {
    for (at[1] = box.Lo[1]; at[1] < box.Hi[1] + more; ++at[1]) {
      for (at[0] = box.Lo[0]; at[0] < box.Hi[0] + more; ++at[0], ++number) {
        Tile& tile = this->Make(box.Level, at, index);
        const bool is_cell = at[0] < box.Hi[0] && at[1] < box.Hi[1] && at[2] < box.Hi[2];
        const bool hides = hidden(number);
        if (is_cell) {
          tile.State[index] |= EXISTS;
        }
        if (tile.State[index] & HAS_VALUE) { // a point that boxes share: the first box has set its value
          continue;
        }
        tile.State[index] |= HAS_VALUE;
        for (size_t c = 0; c < components; ++c) {
          tile.Values[index * components + c] = hides ? std::numeric_limits<double>::quiet_NaN() : value(number, static_cast<int>(c));
        }
      }
    }
  }
  this->Boxes.push_back(box);
  return true;
}

#endif
