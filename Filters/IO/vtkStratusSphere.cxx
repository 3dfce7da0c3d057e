// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusSphere.h"

#include "vtkStratusNetCDFFile.h"
#include "vtkStratusReadError.h"

#include "vtkDoubleArray.h"

#include <algorithm>
#include <cmath>

namespace {
constexpr double Degree = 0.017453292519943295;
constexpr double Same = 1e-3; // of a step of the lattice: places that coincide but for rounding

using Point = std::array<double, 3>;

Point OnSphere(double longitude, double latitude)
{
  const double across = std::cos(latitude * Degree);
  return { { across * std::cos(longitude * Degree), across * std::sin(longitude * Degree), std::sin(latitude * Degree) } };
}

double Distance(const Point& a, const Point& b)
{
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

// The places of a lattice on the sphere of radius 1.
class Places
{
public:
  Places(size_t columns, size_t rows, const std::function<void(size_t, size_t, double[2])>& place) : Columns(columns), All(columns * rows)
  {
    for (size_t j = 0; j < rows; ++j) {
      for (size_t i = 0; i < columns; ++i) {
        double degrees[2];
        place(i, j, degrees);
        this->All[j * columns + i] = OnSphere(degrees[0], degrees[1]);
      }
    }
  }
  const Point& At(size_t column, size_t row) const { return this->All[row * this->Columns + column]; }
  double Apart(size_t column, size_t row, size_t other, size_t other_row) const
  {
    return Distance(this->At(column, row), this->At(other, other_row));
  }

private:
  size_t Columns;
  std::vector<Point> All;
};

// Whether a condition on distances holds in all rows in which places are known and columns are apart, of which there must be some.
template <class Condition> bool InAllRows(size_t columns, size_t rows, const Places& at, const Condition& holds)
{
  size_t known = 0;
  for (size_t j = 0; j < rows; ++j) {
    const double step = 0.5 * (at.Apart(0, j, 1, j) + at.Apart(columns - 2, j, columns - 1, j));
    if (std::isfinite(step) && step > 1e-9) { // else the row is a pole
      if (!holds(j, step)) {
        return false;
      }
      ++known;
    }
  }
  return known > 0;
}

// The latitude of the pole that a row is around and next to, 0 if there is none. `next`: a row on the other side of it.
double PoleOf(size_t columns, size_t row, size_t next, const std::function<void(size_t, size_t, double[2])>& place)
{
  double first[2], other[2];
  place(0, row, first);
  place(0, next, other);
  for (size_t i = 1; i < columns; ++i) {
    double one[2];
    place(i, row, one);
    if (!(std::fabs(one[1] - first[1]) < 1e-6)) {
      return 0.0;
    }
  }
  const double left = 90.0 - std::fabs(first[1]), step = std::fabs(first[1] - other[1]);
  const bool is_next = left > Same * step && left <= (1.0 + Same) * step && std::fabs(other[1]) < std::fabs(first[1]);
  return is_next ? std::copysign(90.0, first[1]) : 0.0;
}
} // namespace

vtkStratusSphere::Lattice vtkStratusSphere::FindLattice(
  size_t columns, size_t rows, const std::function<void(size_t, size_t, double[2])>& place)
{
  const Places at(columns, rows, place);
  const size_t last = columns - 1;
  Lattice lattice;
  lattice.FileColumns = columns;
  lattice.FileRows = lattice.Rows = rows;
  size_t kept = columns;
  const auto repeats = [&](size_t n) { // the last column is the file's column n, counted from 0
    return columns > n + 3 && InAllRows(columns, rows, at, [&](size_t j, double step) { return at.Apart(last, j, n, j) < Same * step; });
  };
  bool closed = repeats(0);
  for (size_t n = 1; n < 4 && !closed; ++n) {
    if (repeats(n)) {
      kept -= n;
      closed = true;
      lattice.Description += ", without " + std::to_string(n) + " columns that repeat the first ones";
    }
  }
  for (size_t i = 0; i < kept; ++i) {
    lattice.Columns.push_back(i);
  }
  // two columns are always next to each other
  if (!closed && columns > 2 && InAllRows(columns, rows, at, [&](size_t j, double step) { return at.Apart(last, j, 0, j) < 1.5 * step; })) {
    closed = true;
    lattice.Columns.push_back(0);
    lattice.Description += ", closed from the last column to the first";
  }
  if (!closed) {
    return lattice;
  }
  // a lattice with two poles in the north that turns about its points: the last row is the last but two in reverse
  for (size_t shift = 0; shift < 3 && lattice.Rows == rows && rows > 3; ++shift) {
    size_t known = 0, same = 0;
    for (size_t i = 0; i < columns; ++i) {
      const size_t mirror = (2 * columns - i - shift) % columns;
      const double step = at.Apart(i, rows - 1, i + 1 < columns ? i + 1 : i - 1, rows - 1), apart = at.Apart(i, rows - 1, mirror, rows - 3);
      known += std::isfinite(step) && step > 1e-9 && std::isfinite(apart);
      same += step > 1e-9 && apart < Same * step;
    }
    if (known > columns / 2 && same + 4 > known) { // at its ends columns may repeat
      lattice.Rows = rows - 1;
      lattice.Description += ", without the last row, which repeats another one";
    }
  }
  lattice.Before = PoleOf(columns, 0, 1, place);
  lattice.After = lattice.Rows == rows ? PoleOf(columns, rows - 1, rows - 2, place) : 0.0;
  if (lattice.Before != 0.0 || lattice.After != 0.0) {
    lattice.Description += lattice.Before != 0.0 && lattice.After != 0.0 ? ", closed at both poles" : ", closed at a pole";
  }
  return lattice;
}

namespace {
// Calls back with each point of the lattice and the file's point that it is; of a pole, with the file's row that is next to it.
template <class Visit, class Pole>
void EachPoint(const vtkStratusSphere::Lattice& lattice, size_t levels, const Visit& visit, const Pole& pole)
{
  const size_t columns = lattice.Columns.size(), all = lattice.FileColumns * lattice.FileRows;
  size_t to = 0;
  for (size_t k = 0; k < levels; ++k) {
    if (lattice.Before != 0.0) {
      pole(to, k * all, lattice.Before);
      to += columns;
    }
    for (size_t j = 0; j < lattice.Rows; ++j) {
      for (size_t i = 0; i < columns; ++i, ++to) {
        visit(to, k * all + j * lattice.FileColumns + lattice.Columns[i]);
      }
    }
    if (lattice.After != 0.0) {
      pole(to, k * all + (lattice.FileRows - 1) * lattice.FileColumns, lattice.After);
      to += columns;
    }
  }
}
} // namespace

vtkSmartPointer<vtkDataArray> vtkStratusSphere::Spread(const Lattice& lattice, size_t levels, vtkDataArray* values)
{
  vtkSmartPointer<vtkDataArray> result;
  const size_t columns = lattice.Columns.size();
  result.TakeReference(values->NewInstance());
  result->SetName(values->GetName());
  result->SetNumberOfComponents(values->GetNumberOfComponents());
  result->SetNumberOfTuples(static_cast<vtkIdType>(levels * columns * lattice.GetRows()));
  EachPoint(
    lattice, levels, [&](size_t to, size_t from) { result->SetTuple(static_cast<vtkIdType>(to), static_cast<vtkIdType>(from), values); },
    [&](size_t to, size_t row, double) {
      for (int c = 0; c < values->GetNumberOfComponents(); ++c) {
        double sum = 0.0, known = 0.0;
        for (size_t i = 0; i < lattice.FileColumns; ++i) {
          const double value = values->GetComponent(static_cast<vtkIdType>(row + i), c);
          sum += std::isfinite(value) ? value : 0.0;
          known += std::isfinite(value);
        }
        const double mean = known > 0.0 ? sum / known : std::nan("");
        for (size_t i = 0; i < columns; ++i) {
          result->SetComponent(static_cast<vtkIdType>(to + i), c, mean);
        }
      }
    });
  return result;
}

std::vector<char> vtkStratusSphere::Spread(const Lattice& lattice, size_t levels, const std::vector<char>& hidden)
{
  std::vector<char> result(hidden.empty() ? 0 : levels * lattice.Columns.size() * lattice.GetRows(), 0);
  if (!hidden.empty()) {
    EachPoint(
      lattice, levels, [&](size_t to, size_t from) { result[to] = hidden[from]; },
      [&](size_t to, size_t row, double) {
        const auto first = hidden.begin() + static_cast<std::ptrdiff_t>(row);
        const bool all = std::all_of(first, first + static_cast<std::ptrdiff_t>(lattice.FileColumns), [](char one) { return one != 0; });
        std::fill_n(result.begin() + static_cast<std::ptrdiff_t>(to), lattice.Columns.size(), all ? 1 : 0);
      });
  }
  return result;
}

void vtkStratusSphere::PlacePoles(const Lattice& lattice, size_t levels, const std::array<double, 2>& degrees, vtkDoubleArray* points)
{
  double* const at = points->GetPointer(0);
  EachPoint(
    lattice, levels, [](size_t, size_t) {},
    [&](size_t to, size_t, double latitude) {
      double height = 0.0;
      for (size_t i = 0; i < lattice.Columns.size(); ++i) {
        height += at[3 * (to + i) + 2] / static_cast<double>(lattice.Columns.size());
      }
      for (size_t i = 0; i < lattice.Columns.size(); ++i) {
        at[3 * (to + i) + 1] = latitude / degrees[1];
        at[3 * (to + i) + 2] = height;
      }
    });
}

double vtkStratusSphere::FactorOf(vtkDoubleArray* points, const std::vector<char>& hidden)
{
  const double* const at = points->GetPointer(0);
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < static_cast<size_t>(points->GetNumberOfTuples()); ++i) {
    if (hidden.empty() || !hidden[i]) {
      low = std::min(low, at[3 * i + 2]);
      high = std::max(high, at[3 * i + 2]);
    }
  }
  return high > low ? 0.1 * EarthRadius / (high - low) : 1.0;
}

void vtkStratusSphere::Place(vtkDoubleArray* points, size_t level, const std::array<double, 2>& degrees, double factor)
{
  struct Known {
    double X, Y;
    Point Unit;
  };
  const size_t count = static_cast<size_t>(points->GetNumberOfTuples());
  std::vector<Known> known(
    std::min(level, count), { std::nan(""), 0.0, {} }); // of the level before: sines and cosines take most of the time
  double* at = points->GetPointer(0);
  for (size_t i = 0; i < count; ++i, at += 3) {
    const double radius = EarthRadius + factor * at[2];
    if (!(radius > 0.0)) {
      throw vtkStratusReadError{ "a height of " + vtkStratusNumberText(at[2]) + " m times " + vtkStratusNumberText(factor) +
        " is below the middle of the Earth: the factor of heights must be less than " + vtkStratusNumberText(-EarthRadius / at[2]) };
    }
    Known& below = known[i % level];
    if (!(below.X == at[0] && below.Y == at[1])) {
      below = { at[0], at[1], OnSphere(at[0] * degrees[0], at[1] * degrees[1]) };
    }
    for (size_t axis = 0; axis < 3; ++axis) {
      at[axis] = radius * below.Unit[axis];
    }
  }
}
