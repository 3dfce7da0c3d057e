// SPDX-License-Identifier: BSD-3-Clause
// Data and settings of a mapper of tetrahedra, for a frame of several volumes that another module draws. Private to the modules.
#ifndef vtkStratusMeshDescription_h
#define vtkStratusMeshDescription_h

#include "stratus.h"

#include <string>

// Pointers are valid until the mapper draws or describes again.
struct vtkStratusMeshDescription {
  const stratus_mesh* Mesh = nullptr; // nullptr: there are no cells
  const stratus_transfer* Transfer = nullptr;
  stratus_tetra_options Options;
  stratus_volume Box; // a box around the mesh
  std::string Error;  // why there is nothing to describe
};

#endif
