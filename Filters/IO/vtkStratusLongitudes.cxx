// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusLongitudes.h"

#include <cmath>
#include <numeric>

namespace vtkStratusLongitudes {

namespace {
constexpr double Turn = 360.0;
constexpr double Differences[] = { 1.0, 3.0, 10.0, 30.0, 90.0, 180.0 }; // neighbours are joined in this order, in degrees

// Groups of places whose turns to each other are known. Each place points to another of its group, up to the group's first.
class Groups
{
public:
  explicit Groups(size_t count) : Parents(count), Turns(count, 0) { std::iota(this->Parents.begin(), this->Parents.end(), size_t{ 0 }); }

  // Returns the group's first place, and the turns that the place has more than that.
  size_t Find(size_t place, int& turns)
  {
    size_t first = place;
    turns = 0;
    while (this->Parents[first] != first) {
      turns += this->Turns[first];
      first = this->Parents[first];
    }
    int rest = turns; // point all on the way to the first
    while (this->Parents[place] != first && place != first) {
      const size_t next = this->Parents[place];
      const int own = this->Turns[place];
      this->Parents[place] = first;
      this->Turns[place] = rest;
      rest -= own;
      place = next;
    }
    return first;
  }

  // Joins the groups of a and b, if they are two: b gets `turns` more than a.
  void Join(size_t a, size_t b, int turns)
  {
    int of_a = 0, of_b = 0;
    const size_t first_a = this->Find(a, of_a), first_b = this->Find(b, of_b);
    if (first_a < first_b) { // the first place stays the lowest number
      this->Parents[first_b] = first_a;
      this->Turns[first_b] = of_a + turns - of_b;
    } else if (first_b < first_a) {
      this->Parents[first_a] = first_b;
      this->Turns[first_a] = of_b - turns - of_a;
    }
  }

private:
  std::vector<size_t> Parents;
  std::vector<int> Turns;
};
} // namespace

bool Unwrap(std::vector<double>& degrees, const Edges& edges)
{
  bool jumps = false;
  edges([&](size_t a, size_t b) { jumps = jumps || std::fabs(degrees[a] - degrees[b]) > 0.5 * Turn; });
  if (!jumps) {
    return false;
  }
  Groups groups(degrees.size());
  double above = -1.0;
  for (double below : Differences) {
    edges([&](size_t a, size_t b) {
      const double difference = degrees[b] - degrees[a];
      if (!std::isfinite(difference)) {
        return;
      }
      const double turns = std::fabs(difference) > 0.5 * Turn ? std::round(difference / Turn) : 0.0;
      const double rest = std::fabs(difference - turns * Turn);
      if (rest > above && rest <= below) {
        groups.Join(a, b, -static_cast<int>(turns));
      }
    });
    above = below;
  }
  bool changed = false;
  for (size_t i = 0; i < degrees.size(); ++i) {
    int turns = 0;
    groups.Find(i, turns);
    degrees[i] += turns * Turn;
    changed = changed || turns != 0;
  }
  return changed;
}

Edges LatticeEdges(const std::array<size_t, 3>& lengths, const std::array<size_t, 3>& strides)
{
  return [lengths, strides](const std::function<void(size_t, size_t)>& call) {
    std::array<size_t, 3> n;
    for (size_t a = 0; a < 3; ++a) {
      n[a] = strides[a] > 0 ? lengths[a] : 1;
    }
    for (size_t k = 0; k < n[2]; ++k) {
      for (size_t j = 0; j < n[1]; ++j) {
        for (size_t i = 0; i < n[0]; ++i) {
          const size_t at = i * strides[0] + j * strides[1] + k * strides[2];
          const bool before[] = { i > 0, j > 0, k > 0 };
          for (size_t a = 0; a < 3; ++a) {
            if (before[a]) {
              call(at - strides[a], at);
            }
          }
        }
      }
    }
  };
}

bool IsMonotone(const std::vector<double>& values)
{
  for (size_t i = 1; i < values.size(); ++i) {
    if (!((values[i] - values[i - 1]) * (values[1] - values[0]) > 0.0)) {
      return false;
    }
  }
  return true;
}

bool UnwrapAxis(std::vector<double>& degrees)
{
  std::vector<double> continuous = degrees;
  if (!Unwrap(continuous, LatticeEdges({ { degrees.size(), 1, 1 } }, { { 1, 0, 0 } })) || !IsMonotone(continuous)) {
    return false;
  }
  degrees = continuous;
  return true;
}
} // namespace vtkStratusLongitudes
