// SPDX-License-Identifier: BSD-3-Clause
// Tells vtkStratusDepthOrder, of a module below, which volumes this module's mappers draw, and mixes them. Private to the module.
#ifndef vtkStratusVolumeMixer_h
#define vtkStratusVolumeMixer_h

#include "vtkStratusPrivate.h"

VTK_STRATUS_PRIVATE void vtkStratusRegisterMixer();

#endif
