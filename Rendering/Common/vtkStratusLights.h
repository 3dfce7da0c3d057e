// SPDX-License-Identifier: BSD-3-Clause
// A renderer's lights and a property's shading as the core's options, for every mapper that is lit.
#ifndef vtkStratusLights_h
#define vtkStratusLights_h

#include "stratus.h"
#include "vtkStratusPrivate.h"

#include "vtkVolume.h"

#include <string>

class vtkLight;
class vtkProp3D;
class vtkRenderer;
class vtkVolumeProperty;

// Sets the material of the first component, and the lights, unless `shading` is off. sun: the only light; nullptr: all lights of the
// renderer that are on.
VTK_STRATUS_PRIVATE bool vtkStratusSetShading(
  vtkRenderer* renderer, vtkLight* sun, vtkVolumeProperty* property, stratus_shading& shading, std::string& error);

// The anisotropy of a mapper; 0: the property's, where VTK has one.
VTK_STRATUS_PRIVATE double vtkStratusAnisotropy(double mapper, vtkVolumeProperty* property);

// The length of shadows for a GlobalIlluminationReach of 0..1, as vtkGPUVolumeRayCastMapper has it: from next to nothing to the diagonal of
// the prop's bounds. 0: the whole way.
VTK_STRATUS_PRIVATE double vtkStratusShadowLength(vtkProp3D* prop, double reach);

// Sets how light passes through matter, by a mapper's settings.
template <class Mapper> void vtkStratusSetScattering(Mapper* mapper, vtkVolume* volume, stratus_shading& shading)
{
  const double blending = mapper->GetVolumetricScatteringBlending(); // 0..2, as vtkGPUVolumeRayCastMapper has it
  shading.shadows = mapper->GetShadows() || blending > 0.0 ? 1 : 0;
  shading.scattering = 0.5 * blending;
  shading.anisotropy = vtkStratusAnisotropy(mapper->GetScatteringAnisotropy(), volume->GetProperty());
  shading.shadow_length = vtkStratusShadowLength(volume, mapper->GetGlobalIlluminationReach());
  shading.multiple = mapper->GetMultipleScattering() && blending > 0.0 ? 1 : 0;
  mapper->GetSkyZenith(shading.sky_zenith);
  mapper->GetSkyHorizon(shading.sky_horizon);
  mapper->GetSkyUp(shading.up);
}

// Sets the materials of the first `count` components. Returns whether one of them is lit; alike: they are the same.
VTK_STRATUS_PRIVATE bool vtkStratusSetMaterials(vtkVolumeProperty* property, int count, stratus_material* materials, bool& alike);

#endif
