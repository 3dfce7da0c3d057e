// SPDX-License-Identifier: BSD-3-Clause
// Grids of longitudes, latitudes and heights on a sphere, by the core (stratus/globe.h), in VTK's arrays. Private to the module.
#ifndef vtkStratusSphere_h
#define vtkStratusSphere_h

#include "stratus/globe.h"

#include "vtkSmartPointer.h"

#include <string>
#include <vector>

class vtkDataArray;
class vtkDoubleArray;

namespace vtkStratusSphere {

constexpr double EarthRadius = STRATUS_EARTH_RADIUS; // metres

// degrees: longitude and latitude of each point, columns fastest; they may be NaN. Throws vtkStratusReadError, as Place() does.
stratus_globe_lattice FindLattice(size_t columns, size_t rows, const std::vector<double>& degrees);
std::string Describe(const stratus_globe_lattice& lattice); // ", closed at both poles", or ""

// Values on the lattice and `levels` levels, x fastest, from the file's values: of points that close the lattice, means of those that are
// known. Such a point is hidden if all that it is made of are.
vtkSmartPointer<vtkDataArray> Spread(const stratus_globe_lattice& lattice, size_t levels, vtkDataArray* values);
std::vector<char> Spread(const stratus_globe_lattice& lattice, size_t levels, const std::vector<char>& hidden);

// Returns the places of points, whose heights are the third coordinates of `points`, on the sphere. Without a lattice they are `points`.
// degrees: of each point of a level of the file, or of all levels
vtkSmartPointer<vtkDoubleArray> Place(
  const stratus_globe_lattice* lattice, size_t levels, const std::vector<double>& degrees, vtkDoubleArray* points, double factor);
// The factor by which the heights of points, of which `hidden` do not count, reach over a tenth of the radius; 1 if there is one height.
double FactorOf(vtkDoubleArray* points, const std::vector<char>& hidden);
} // namespace vtkStratusSphere

#endif
