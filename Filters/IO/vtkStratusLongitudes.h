// SPDX-License-Identifier: BSD-3-Clause
// Longitudes that jump by a whole turn, made continuous by the core. Private to the module.
#ifndef vtkStratusLongitudes_h
#define vtkStratusLongitudes_h

#include <array>
#include <cstddef>
#include <vector>

namespace vtkStratusLongitudes {

// Makes longitudes of a lattice continuous, by stratus_longitudes_unwrap(), which describes lengths and strides. Returns whether any
// changed.
bool Unwrap(std::vector<double>& degrees, const std::array<size_t, 3>& lengths, const std::array<size_t, 3>& strides);

// Makes an axis continuous where it then increases or decreases all along; any other is left as it is. Returns whether it changed.
bool UnwrapAxis(std::vector<double>& degrees);
} // namespace vtkStratusLongitudes

#endif
