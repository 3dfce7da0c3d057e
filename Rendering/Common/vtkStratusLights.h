// SPDX-License-Identifier: BSD-3-Clause
// A renderer's lights and a property's shading as the core's options, for every mapper that is lit.
#ifndef vtkStratusLights_h
#define vtkStratusLights_h

#include "stratus.h"
#include "vtkStratusPrivate.h"

#include <string>

class vtkRenderer;
class vtkVolumeProperty;

// Sets the material of the first component, and the lights that are on, unless `shading` is off.
VTK_STRATUS_PRIVATE bool vtkStratusSetShading(
  vtkRenderer* renderer, vtkVolumeProperty* property, stratus_shading& shading, std::string& error);

// Sets how light passes through matter, by a mapper's settings. blending: 0..2, as vtkGPUVolumeRayCastMapper has it. anisotropy: 0: the
// property's, where VTK has one.
VTK_STRATUS_PRIVATE void vtkStratusSetScattering(
  vtkVolumeProperty* property, bool shadows, double blending, double anisotropy, stratus_shading& shading);

// Sets the materials of the first `count` components. Returns whether one of them is lit; alike: they are the same.
VTK_STRATUS_PRIVATE bool vtkStratusSetMaterials(vtkVolumeProperty* property, int count, stratus_material* materials, bool& alike);

#endif
