// SPDX-License-Identifier: BSD-3-Clause
// vtkStratusTetrahedraMapper: light and gradient opacity give the image mapper's picture of an equal linear field, with scalars of points
// and of cells. Modes without light or gradient opacity are refused.
#include "tetrahedra_scene.h"

#include "vtkContourValues.h"
#include "vtkLight.h"
#include "vtkPiecewiseFunction.h"

namespace {
// The gradient of the scene's field.
const double Steepness = std::sqrt(0.1 * 0.1 + 0.05 * 0.05);

void LikeTheImage(GridScene& scene, double least, const char* what)
{
  for (int view = 0; view < 3; ++view) {
    scene.Look(35 + 130 * view, 20 - 30 * view);
    const double psnr = scene.Psnr();
    CHECK(psnr > least, "%s, view %d: %.1f dB", what, view, psnr);
  }
  CHECK(scene.GridErrors->Count == 0, "%s: %s", what, scene.GridErrors->Text.c_str());
}

void Shine(vtkVolumeProperty* look)
{
  look->ShadeOn();
  look->SetAmbient(0.2);
  look->SetDiffuse(0.6);
  look->SetSpecular(0.5);
  look->SetSpecularPower(12);
}

void Lights()
{
  GridScene scene;
  Shine(scene.Volume->GetProperty());
  const std::vector<float> lit = scene.GridPicture();
  CHECK(std::string(scene.Tetrahedra->GetMethodReason()) == "march: light and gradient opacity cannot be projected", "%s",
    scene.Tetrahedra->GetMethodReason());
  LikeTheImage(scene, 60.0, "headlight");
  scene.Renderer->TwoSidedLightingOff();
  vtkNew<vtkLight> side, lamp;
  side->SetLightTypeToSceneLight();
  side->SetPosition(-3, 2, 4);
  side->SetFocalPoint(0, 0, 0);
  side->SetDiffuseColor(1, 0.6, 0.3);
  lamp->SetLightTypeToSceneLight();
  lamp->PositionalOn();
  lamp->SetPosition(8, 9, 7);
  lamp->SetFocalPoint(3, 3, 3);
  lamp->SetConeAngle(25);
  lamp->SetAttenuationValues(0.5, 0.02, 0.01);
  scene.Renderer->AddLight(side);
  scene.Renderer->AddLight(lamp);
  scene.Volume->SetOrientation(10, 20, 30);
  scene.Volume->SetScale(1, 2, 1);             // normals are no vectors
  LikeTheImage(scene, 45.0, "from two lamps"); // the rim of the cone is sharp: samples fall on both sides
  scene.Volume->GetProperty()->ShadeOff();
  const std::vector<float> dark = scene.GridPicture();
  scene.Tetrahedra->SetMethodToProject();
  const std::vector<float> projected = scene.GridPicture();
  CHECK(lit != dark && !projected.empty(), "light makes no difference, or is not off");
}

void Surfaces()
{
  GridScene scene;
  vtkVolumeProperty* look = scene.Volume->GetProperty();
  Shine(look);
  scene.Tetrahedra->SetBlendModeToIsoSurface();
  scene.Mapper->SetBlendMode(vtkVolumeMapper::ISOSURFACE_BLEND);
  look->GetIsoSurfaceValues()->SetValue(0, 0.31);
  look->GetIsoSurfaceValues()->SetValue(1, 0.52);
  LikeTheImage(scene, 50.0, "surfaces");
}

void GradientOpacity()
{
  GridScene scene;
  vtkNew<vtkPiecewiseFunction> gradient;
  gradient->AddPoint(0.5 * Steepness, 0.0);
  gradient->AddPoint(2.0 * Steepness, 0.9); // .3 where the field's steepness is
  scene.Volume->GetProperty()->SetGradientOpacity(gradient);
  LikeTheImage(scene, 60.0, "optical depth");
  const double thin = scene.GridLight();
  for (const double length : { 0.7, -1.0 }) {
    scene.Tetrahedra->SetGradientOpacityDistance(length);
    scene.Mapper->SetGradientOpacityDistance(length);
    LikeTheImage(scene, 60.0, "opacity of a length");
  }
  CHECK(scene.Tetrahedra->GetGradientOpacityDistance() == -1.0, "%g", scene.Tetrahedra->GetGradientOpacityDistance());
  scene.Volume->GetProperty()->DisableGradientOpacityOn();
  CHECK(scene.GridLight() > 1.1 * thin, "gradient opacity takes nothing away: %g of %g", thin, scene.GridLight());
}

void WhatIsRefused()
{
  GridScene scene;
  const auto refuses = [&](const char* word) {
    const int before = scene.GridErrors->Count;
    CHECK(scene.GridPicture().empty() && scene.GridErrors->Count == before + 1 && scene.GridErrors->Has(word), "not \"%s\": %s", word,
      scene.GridErrors->Text.c_str());
  };
  scene.Volume->GetProperty()->ShadeOn();
  scene.Tetrahedra->SetMethodToProject();
  refuses("light and gradient opacity cannot be projected");
  scene.Tetrahedra->SetMethodToAuto();
  scene.Tetrahedra->SetGradientOpacityDistance(NAN);
  refuses("GradientOpacityDistance is nan");
  scene.Tetrahedra->SetGradientOpacityDistance(0);
  for (int i = 0; i < 9; ++i) {
    vtkNew<vtkLight> light;
    scene.Renderer->AddLight(light);
  }
  refuses("more than 8 lights");
  scene.Volume->GetProperty()->ShadeOff();
  CHECK(scene.GridLight() > 0.0, "nothing is drawn after errors");
}

// Settings that have no meaning are left out with one warning, and the picture is the one without them.
void WhatIsLeftOut()
{
  using Sets = std::function<void(GridScene&)>;
  const auto leavesOut = [](int blend, const char* word, const Sets& sets) {
    GridScene scene;
    vtkNew<ErrorObserver> warnings;
    scene.Tetrahedra->AddObserver(vtkCommand::WarningEvent, warnings);
    scene.Tetrahedra->SetBlendMode(blend);
    scene.Volume->GetProperty()->GetIsoSurfaceValues()->SetValue(0, 0.5);
    const std::vector<float> before = scene.GridPicture();
    CHECK(scene.GridLight() > 10.0 && warnings->Count == 0, "%d: nothing is drawn, %s", blend, warnings->Text.c_str());
    sets(scene);
    CHECK(scene.GridPicture() == before && scene.GridErrors->Count == 0, "%s in mode %d: %s", word, blend, scene.GridErrors->Text.c_str());
    scene.Volume->GetProperty()->Modified();
    scene.Render();
    CHECK(warnings->Count == 1 && warnings->Has(word), "mode %d: %d warnings, '%s', not '%s'", blend, warnings->Count,
      warnings->Text.c_str(), word);
  };
  const Sets lights = [](GridScene& scene) {
    scene.Volume->GetProperty()->ShadeOn();
    for (int l = 0; l < 9; ++l) { // which are too many where there is light
      scene.Renderer->AddLight(vtkNew<vtkLight>());
    }
  };
  const Sets thins = [](GridScene& scene) { scene.Volume->GetProperty()->GetGradientOpacity()->AddPoint(0, 0.5); };
  const Sets labels = [](GridScene& scene) {
    vtkNew<vtkColorTransferFunction> red;
    red->AddRGBPoint(0, 1, 0, 0);
    scene.Volume->GetProperty()->SetLabelColor(1, red);
  };
  const Sets twoVariables = [](GridScene& scene) { scene.Volume->GetProperty()->SetTransferFunctionMode(vtkVolumeProperty::TF_2D); };
  for (int blend = vtkVolumeMapper::COMPOSITE_BLEND; blend <= vtkVolumeMapper::ISOSURFACE_BLEND; ++blend) {
    leavesOut(blend, "functions of labels", labels);
    leavesOut(blend, "TransferFunction2D", twoVariables);
    if (blend != vtkVolumeMapper::COMPOSITE_BLEND) {
      leavesOut(blend, "GradientOpacity", thins);
    }
    if (blend != vtkVolumeMapper::COMPOSITE_BLEND && blend != vtkVolumeMapper::ISOSURFACE_BLEND) {
      leavesOut(blend, "Shade", lights);
    }
  }
}
} // namespace

int main()
{
  Lights();
  Surfaces();
  GradientOpacity();
  WhatIsRefused();
  WhatIsLeftOut();
  return Failures ? 1 : 0;
}
