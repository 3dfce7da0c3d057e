// SPDX-License-Identifier: BSD-3-Clause
// Which values of an array of several components a colour map means: their magnitude, or one component.
#pragma once

#include <string>

class vtkDataObject;
class vtkVolumeProperty;

namespace stratus {

// Returns the name of an array of one component that holds what the property's colour map shows of the named one, in a data set or in each
// block of composite data; the array is added where it is missing or older. Arrays of one component, and those whose components a property
// takes as they are (IndependentComponents off), keep their name. Magnitudes are computed in double precision.
std::string choose_scalars(vtkDataObject* data, const char* name, bool on_cells, vtkVolumeProperty* property);
} // namespace stratus
