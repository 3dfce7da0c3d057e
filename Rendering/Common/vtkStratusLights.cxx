// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusLights.h"

#include "vtkCamera.h"
#include "vtkLight.h"
#include "vtkLightCollection.h"
#include "vtkMatrix4x4.h"
#include "vtkProp3D.h"
#include "vtkRenderer.h"
#include "vtkVersion.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>

namespace {
// Whether a camera's model and view only turn and move the world.
bool IsRigid(vtkMatrix4x4* view)
{
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      double dot = i == j ? -1.0 : 0.0;
      for (int a = 0; a < 3; ++a) {
        dot += view->GetElement(i, a) * view->GetElement(j, a);
      }
      if (!(std::abs(dot) < 1e-9)) {
        return false;
      }
    }
  }
  return true;
}

// Converts a light. The renderer has already moved lights that follow the camera; directions are turned back to the camera's coordinates.
void SetLight(vtkLight* light, vtkCamera* camera, stratus_light& result)
{
  double position[4] = { 0.0, 0.0, 0.0, 1.0 }, focal[4] = { 0.0, 0.0, 0.0, 1.0 };
  light->GetTransformedPosition(position);
  light->GetTransformedFocalPoint(focal);
  vtkMatrix4x4* view = camera->GetModelViewTransformMatrix();
  const bool moves = light->LightTypeIsHeadlight() || light->LightTypeIsCameraLight();
  result.follows_camera = moves && !light->GetPositional() && IsRigid(view) ? 1 : 0;
  if (result.follows_camera) {
    view->MultiplyPoint(position, position);
    view->MultiplyPoint(focal, focal);
  }
  result.positional = light->GetPositional() ? 1 : 0;
  const double* attenuation = light->GetAttenuationValues();
  // A light of angle 0 shines only along its axis; the core's 0 means no cone.
  result.cone_angle = light->GetConeAngle() >= 90.0 ? 0.0 : std::max(light->GetConeAngle(), 1e-6);
  result.cone_exponent = light->GetExponent();
  result.separate_specular = 1;
  for (int a = 0; a < 3; ++a) {
    result.attenuation[a] = attenuation[a];
    result.axis[a] = focal[a] - position[a];
    result.vector[a] = result.positional ? position[a] : position[a] - focal[a];
    result.color[a] = light->GetIntensity() * light->GetDiffuseColor()[a];
    result.specular_color[a] = light->GetIntensity() * light->GetSpecularColor()[a];
  }
}
} // namespace

double vtkStratusShadowLength(vtkProp3D* prop, double reach)
{
  if (reach >= 1.0) {
    return 0.0;
  }
  const double diagonal = prop->GetLength();
  return std::isfinite(diagonal) ? diagonal * std::max(1.0 - std::pow(1.0 - reach, 0.33), 1e-3) : 0.0;
}

bool vtkStratusSetShading(vtkRenderer* renderer, vtkLight* sun, vtkVolumeProperty* property, stratus_shading& shading, std::string& error)
{
  shading.one_sided = renderer->GetTwoSidedLighting() ? 0 : 1;
  shading.ambient = property->GetAmbient();
  shading.diffuse = property->GetDiffuse();
  shading.specular = property->GetSpecular();
  shading.specular_power = property->GetSpecularPower();
  shading.light_count = 0;
  if (sun) {
    if (shading.on && sun->GetSwitch()) {
      SetLight(sun, renderer->GetActiveCamera(), shading.lights[shading.light_count++]);
    }
    return true;
  }
  vtkLightCollection* lights = renderer->GetLights();
  vtkCollectionSimpleIterator iterator;
  lights->InitTraversal(iterator);
  while (vtkLight* light = shading.on ? lights->GetNextLight(iterator) : nullptr) {
    if (!light->GetSwitch()) {
      continue;
    }
    if (shading.light_count == STRATUS_LIGHTS_MAX) {
      error = "more than " + std::to_string(STRATUS_LIGHTS_MAX) + " lights that are on are not supported";
      return false;
    }
    SetLight(light, renderer->GetActiveCamera(), shading.lights[shading.light_count++]);
  }
  return true;
}

double vtkStratusAnisotropy(double mapper, vtkVolumeProperty* property)
{
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 0)
  if (mapper == 0.0) {
    return std::clamp<double>(property->GetScatteringAnisotropy(), -STRATUS_ANISOTROPY_MOST, STRATUS_ANISOTROPY_MOST);
  }
#else
  (void)property;
#endif
  return mapper;
}

bool vtkStratusSetMaterials(vtkVolumeProperty* property, int count, stratus_material* materials, bool& alike)
{
  bool lit = false;
  alike = true;
  for (int c = 0; c < count; ++c) {
    stratus_material& mine = materials[c];
    mine = { property->GetShade(c), property->GetAmbient(c), property->GetDiffuse(c), property->GetSpecular(c),
      property->GetSpecularPower(c) };
    lit = lit || mine.shade;
    alike = alike && mine.shade == materials[0].shade && mine.ambient == materials[0].ambient && mine.diffuse == materials[0].diffuse &&
      mine.specular == materials[0].specular && mine.specular_power == materials[0].specular_power;
  }
  return lit;
}
