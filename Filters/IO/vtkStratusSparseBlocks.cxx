// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusSparseBlocks.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace {

using Box = vtkStratusCellBox;

void Join(Box& all, const Box& one)
{
  for (int a = 0; a < 3; ++a) {
    all.Low[a] = std::min(all.Low[a], one.Low[a]);
    all.High[a] = std::max(all.High[a], one.High[a]);
  }
}

Box Nothing()
{
  constexpr int64_t most = std::numeric_limits<int64_t>::max(), least = std::numeric_limits<int64_t>::min();
  return { { most, most, most }, { least, least, least } };
}

// Given boxes, cut at the faces of the box around them, and the best plane that parts them.
struct Part {
  std::vector<Box> Of;
  Box Around;
  int Axis = -1; // -1: no plane saves anything
  int64_t Plane = 0;
  double Saves = 0.0;

  explicit Part(std::vector<Box>&& of) : Of(std::move(of)), Around(Nothing())
  {
    for (const Box& one : this->Of) {
      Join(this->Around, one);
    }
    for (int axis = 0; axis < 3; ++axis) {
      this->Look(axis);
    }
  }

private:
  // Tries the planes at which a box begins. Those before it are a prefix of the order by Low, cut at the plane; those that reach beyond it
  // a suffix of the order by High.
  void Look(int axis)
  {
    const size_t count = this->Of.size();
    std::vector<const Box*> by_low(count), by_high(count);
    for (size_t i = 0; i < count; ++i) {
      by_low[i] = by_high[i] = &this->Of[i];
    }
    std::sort(by_low.begin(), by_low.end(), [axis](const Box* a, const Box* b) { return a->Low[axis] < b->Low[axis]; });
    std::sort(by_high.begin(), by_high.end(), [axis](const Box* a, const Box* b) { return a->High[axis] < b->High[axis]; });
    std::vector<Box> beyond(count + 1, Nothing()); // of by_high[i] and all that follow
    for (size_t i = count; i > 0; --i) {
      beyond[i - 1] = beyond[i];
      Join(beyond[i - 1], *by_high[i - 1]);
    }
    const double whole = vtkStratusVoxelsOf(this->Around);
    Box before = Nothing();
    size_t first_beyond = 0;
    for (size_t i = 0; i < count; ++i) {
      const int64_t plane = by_low[i]->Low[axis];
      while (first_beyond < count && by_high[first_beyond]->High[axis] <= plane) {
        ++first_beyond;
      }
      if (plane > this->Around.Low[axis]) {
        Box below = before, above = beyond[first_beyond];
        below.High[axis] = std::min(below.High[axis], plane);
        above.Low[axis] = std::max(above.Low[axis], plane);
        const double saves = whole - vtkStratusVoxelsOf(below) - vtkStratusVoxelsOf(above);
        if (saves > this->Saves) {
          this->Saves = saves;
          this->Axis = axis;
          this->Plane = plane;
        }
      }
      Join(before, *by_low[i]);
    }
  }
};

bool SavesLess(const Part& a, const Part& b)
{
  return a.Saves < b.Saves;
}
} // namespace

double vtkStratusVoxelsOf(const vtkStratusCellBox& box)
{
  double voxels = 1.0;
  for (int a = 0; a < 3; ++a) {
    voxels *= static_cast<double>(box.High[a] - box.Low[a] + 1);
  }
  return voxels;
}

std::vector<vtkStratusCellBox> vtkStratusDivide(std::vector<vtkStratusCellBox> given, size_t most)
{
  std::vector<Box> result;
  if (given.empty()) {
    return result;
  }
  double wanted = 0.0;
  for (const Box& one : given) {
    wanted += static_cast<double>((one.High[0] - one.Low[0]) * (one.High[1] - one.Low[1])) * static_cast<double>(one.High[2] - one.Low[2]);
  }
  std::vector<Part> parts; // a heap, whose first saves the most
  const auto add = [&parts](std::vector<Box>&& of) {
    parts.emplace_back(std::move(of));
    std::push_heap(parts.begin(), parts.end(), SavesLess);
  };
  add(std::move(given));
  double voxels = vtkStratusVoxelsOf(parts.front().Around);
  while (parts.size() < most && parts.front().Axis >= 0 && voxels > 2.0 * wanted) {
    std::pop_heap(parts.begin(), parts.end(), SavesLess);
    const Part whole = std::move(parts.back());
    std::vector<Box> below, above;
    parts.pop_back();
    for (const Box& one : whole.Of) {
      if (one.Low[whole.Axis] < whole.Plane) {
        below.push_back(one);
        below.back().High[whole.Axis] = std::min(one.High[whole.Axis], whole.Plane);
      }
      if (one.High[whole.Axis] > whole.Plane) {
        above.push_back(one);
        above.back().Low[whole.Axis] = std::max(one.Low[whole.Axis], whole.Plane);
      }
    }
    voxels -= whole.Saves;
    add(std::move(below));
    add(std::move(above));
  }
  for (const Part& part : parts) {
    result.push_back(part.Around);
  }
  return result;
}
