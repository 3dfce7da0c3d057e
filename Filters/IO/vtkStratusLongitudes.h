// SPDX-License-Identifier: BSD-3-Clause
// Longitudes that jump by a whole turn, made continuous. Private to the module.
#ifndef vtkStratusLongitudes_h
#define vtkStratusLongitudes_h

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

namespace vtkStratusLongitudes {

// Calls back with each pair of neighbouring places.
using Edges = std::function<void(const std::function<void(size_t, size_t)>&)>;

// Adds whole turns, so that neighbours differ by at most half a turn wherever this is possible, and the first place that has a value keeps
// it. Around a pole it is impossible: where continuous longitudes meet again, neighbours differ by a turn. Neighbours that differ least
// are joined first, hence they meet where longitudes change fastest, near the pole. Values that are not finite are left as they are.
// degrees: longitudes, which are changed
// Returns whether any changed.
bool Unwrap(std::vector<double>& degrees, const Edges& edges);

// The pairs of neighbours of a lattice. An axis of stride 0 has one place.
Edges LatticeEdges(const std::array<size_t, 3>& lengths, const std::array<size_t, 3>& strides);

// Makes an axis continuous where it then increases or decreases all along; any other is left as it is. Returns whether it changed.
bool UnwrapAxis(std::vector<double>& degrees);

// Returns whether the values increase or decrease all along.
bool IsMonotone(const std::vector<double>& values);
} // namespace vtkStratusLongitudes

#endif
