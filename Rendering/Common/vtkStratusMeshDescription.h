// SPDX-License-Identifier: BSD-3-Clause
// What a mapper of tetrahedra has to draw, for a picture of several volumes that another module makes. Private to the modules.
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
