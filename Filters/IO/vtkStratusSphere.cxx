// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusSphere.h"

#include "vtkStratusReaderCore.h"

#include "vtkDoubleArray.h"

#include <algorithm>
#include <cmath>

namespace {
// Calls back with the index of each point of the lattice, and with the file's points that it is made of: first, stride, count.
template <class Visit> void EachPoint(const stratus_globe_lattice& lattice, size_t levels, const Visit& visit)
{
  const int64_t columns = stratus_globe_columns(&lattice), rows = stratus_globe_rows(&lattice),
                all = lattice.data_columns * lattice.data_rows;
  int64_t to = 0;
  for (int64_t k = 0; k < static_cast<int64_t>(levels); ++k) {
    for (int64_t j = 0; j < rows; ++j) {
      for (int64_t i = 0; i < columns; ++i, ++to) {
        int64_t first = 0, stride = 0;
        const int64_t count = stratus_globe_source(&lattice, i, j, &first, &stride);
        visit(to, k * all + first, stride, count);
      }
    }
  }
}

size_t SizeOf(const stratus_globe_lattice& lattice, size_t levels)
{
  return levels * static_cast<size_t>(stratus_globe_columns(&lattice)) * static_cast<size_t>(stratus_globe_rows(&lattice));
}
} // namespace

stratus_globe_lattice vtkStratusSphere::FindLattice(size_t columns, size_t rows, const std::vector<double>& degrees)
{
  const vtkStratusReaderCore core;
  stratus_globe_lattice lattice;
  core.Check(stratus_globe_find_lattice(core, static_cast<int64_t>(columns), static_cast<int64_t>(rows), degrees.data(), &lattice));
  return lattice;
}

std::string vtkStratusSphere::Describe(const stratus_globe_lattice& lattice)
{
  char text[256];
  stratus_globe_describe(&lattice, text, sizeof text);
  return text;
}

vtkSmartPointer<vtkDataArray> vtkStratusSphere::Spread(const stratus_globe_lattice& lattice, size_t levels, vtkDataArray* values)
{
  vtkSmartPointer<vtkDataArray> result;
  result.TakeReference(values->NewInstance());
  result->SetName(values->GetName());
  result->SetNumberOfComponents(values->GetNumberOfComponents());
  result->SetNumberOfTuples(static_cast<vtkIdType>(SizeOf(lattice, levels)));
  EachPoint(lattice, levels, [&](int64_t to, int64_t first, int64_t stride, int64_t count) {
    if (count == 1) {
      result->SetTuple(to, first, values);
      return;
    }
    for (int c = 0; c < values->GetNumberOfComponents(); ++c) {
      double sum = 0.0, known = 0.0;
      for (int64_t n = 0; n < count; ++n) {
        const double value = values->GetComponent(first + n * stride, c);
        sum += std::isfinite(value) ? value : 0.0;
        known += std::isfinite(value);
      }
      result->SetComponent(to, c, known > 0.0 ? sum / known : std::nan(""));
    }
  });
  return result;
}

std::vector<char> vtkStratusSphere::Spread(const stratus_globe_lattice& lattice, size_t levels, const std::vector<char>& hidden)
{
  std::vector<char> result(hidden.empty() ? 0 : SizeOf(lattice, levels), 0);
  if (!hidden.empty()) {
    EachPoint(lattice, levels, [&](int64_t to, int64_t first, int64_t stride, int64_t count) {
      bool all = true;
      for (int64_t n = 0; n < count && all; ++n) {
        all = hidden[static_cast<size_t>(first + n * stride)] != 0;
      }
      result[static_cast<size_t>(to)] = all ? 1 : 0;
    });
  }
  return result;
}

vtkSmartPointer<vtkDoubleArray> vtkStratusSphere::Place(
  const stratus_globe_lattice* lattice, size_t levels, const std::vector<double>& degrees, vtkDoubleArray* points, double factor)
{
  const size_t all = static_cast<size_t>(points->GetNumberOfTuples());
  stratus_globe_points from = {};
  from.lattice = lattice;
  from.count = static_cast<int64_t>(all / levels);
  from.levels = static_cast<int64_t>(levels);
  from.degrees = degrees.data();
  from.degrees_of_levels = levels > 1 && degrees.size() == 2 * all ? 1 : 0;
  from.heights = points->GetPointer(0) + 2;
  from.height_stride = 3;
  from.factor = factor;
  vtkSmartPointer<vtkDoubleArray> result = points;
  if (lattice) {
    result = vtkSmartPointer<vtkDoubleArray>::New();
    result->SetNumberOfComponents(3);
    result->SetNumberOfTuples(static_cast<vtkIdType>(SizeOf(*lattice, levels)));
  }
  const vtkStratusReaderCore core;
  core.Check(stratus_globe_place(core, &from, result->GetPointer(0)));
  return result;
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
  return stratus_globe_height_factor(low, high);
}
