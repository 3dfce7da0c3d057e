// SPDX-License-Identifier: BSD-3-Clause
// The surface of blend mode slice. Private to the modules.
#ifndef vtkStratusSlice_h
#define vtkStratusSlice_h

#include "stratus.h"
#include "vtkStratusPrivate.h"

#include <string>

class vtkVolumeProperty;

// Converts a property's slice function. Returns false, with the reason in `error`, if there is none, or none of a class that is supported.
VTK_STRATUS_PRIVATE bool vtkStratusSetSlice(vtkVolumeProperty* property, stratus_slice& slice, std::string& error);

#endif
