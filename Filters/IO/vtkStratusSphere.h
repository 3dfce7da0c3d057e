// SPDX-License-Identifier: BSD-3-Clause
// Grids of longitudes, latitudes and heights on a sphere. Private to the module.
#ifndef vtkStratusSphere_h
#define vtkStratusSphere_h

#include "vtkSmartPointer.h"

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

class vtkDataArray;
class vtkDoubleArray;

namespace vtkStratusSphere {

constexpr double EarthRadius = 6371000.0; // metres

// How the columns and rows of a lattice of longitudes and latitudes close the sphere: which of the file's they are.
struct Lattice {
  std::vector<size_t> Columns;      // the first comes again as the last if the lattice goes all the way round
  size_t Rows = 0;                  // of the file that are drawn
  double Before = 0.0, After = 0.0; // the latitude of a pole that is one more row, before the first or after the last; 0: there is none
  size_t FileColumns = 0, FileRows = 0;
  std::string Description;
  size_t GetRows() const { return this->Rows + (this->Before != 0.0) + (this->After != 0.0); }
};

// place: gives the longitude and latitude of a column and a row, in degrees. They may be NaN. The lattice is closed
// - where its last column is next to its first one. Columns at the end that repeat the first ones are left out, but for one;
// - where a row around a pole is next to it, by a row of points at the pole;
// - where the last row repeats a row before it in reverse, as lattices with two poles in the north have it: it is left out.
Lattice FindLattice(size_t columns, size_t rows, const std::function<void(size_t, size_t, double[2])>& place);

// Values on the lattice and `levels` levels, x fastest, from the file's values. A pole has the mean of the row that is next to it.
vtkSmartPointer<vtkDataArray> Spread(const Lattice& lattice, size_t levels, vtkDataArray* values);
std::vector<char> Spread(const Lattice& lattice, size_t levels, const std::vector<char>& hidden);

// Takes points of longitude and latitude, which are x and y times `degrees`, and height to the sphere: x towards longitude 0 on the
// equator, z to the north pole. Heights are multiplied by `factor`. level: the number of points after which longitudes and latitudes are
// likely to come again, > 0. Throws vtkStratusReadError where a point is not outside of the middle.
void Place(vtkDoubleArray* points, size_t level, const std::array<double, 2>& degrees, double factor);
// Puts the points of rows at poles there.
void PlacePoles(const Lattice& lattice, size_t levels, const std::array<double, 2>& degrees, vtkDoubleArray* points);
// The factor by which the heights of points, of which `hidden` do not count, reach over a tenth of the radius; 1 if there is one height.
double FactorOf(vtkDoubleArray* points, const std::vector<char>& hidden);
} // namespace vtkStratusSphere

#endif
