// SPDX-License-Identifier: BSD-3-Clause
// vtkStratusTetrahedraMapper: arrays of two to four components give the image mapper's picture of the same linear fields, independent by
// adding and by their shares, and dependent; what is not drawn of them is refused.
#include "tetrahedra_scene.h"

#include "vtkColorTransferFunction.h"
#include "vtkPiecewiseFunction.h"
#include "vtkUnsignedCharArray.h"

namespace {
// Gives grid and image an array of linear fields: rising along x, falling along y, rising along z, and along all three, of 0 to 1 or 255.
void SetFields(GridScene& scene, int components, bool bytes)
{
  vtkSmartPointer<vtkDataArray> array;
  array.TakeReference(vtkDataArray::CreateDataArray(bytes ? VTK_UNSIGNED_CHAR : VTK_FLOAT));
  array->SetNumberOfComponents(components);
  array->SetName("fields");
  const int side = Boxes + 1;
  array->SetNumberOfTuples(side * side * side);
  for (int p = 0; p < side * side * side; ++p) {
    const int i = p % side, j = p / side % side, k = p / side / side;
    const double fields[4] = { 40.0 * i, 240.0 - 40.0 * j, 40.0 * k, 10.0 * (i + j + k) };
    for (int c = 0; c < components; ++c) {
      array->SetComponent(p, c, bytes ? fields[c] : fields[c] / 240.0);
    }
  }
  scene.Grid->GetPointData()->SetScalars(array);
  vtkSmartPointer<vtkDataArray> copy;
  copy.TakeReference(array->NewInstance());
  copy->DeepCopy(array);
  scene.Image->GetPointData()->SetScalars(copy);
}

void SetFunctions(vtkVolumeProperty* look, double most)
{
  for (int c = 0; c < 4; ++c) {
    vtkNew<vtkPiecewiseFunction> opacity;
    vtkNew<vtkColorTransferFunction> color;
    opacity->AddPoint((0.2 + 0.1 * c) * most, 0.0);
    opacity->AddPoint(0.9 * most, 0.25 - 0.03 * c);
    color->AddRGBPoint(0.0, c == 0, 0.4, c == 1);
    color->AddRGBPoint(most, c == 2, c != 0, 0.3);
    look->SetScalarOpacity(c, opacity);
    look->SetColor(c, color);
    look->SetComponentWeight(c, c == 1 ? 0.6 : 1.0);
  }
}

void LikeTheImage(bool independent, int components, bool bytes, int mixing)
{
  GridScene scene;
  SetFields(scene, components, bytes);
  SetFunctions(scene.Volume->GetProperty(), bytes ? 240.0 : 1.0);
  scene.Volume->GetProperty()->SetIndependentComponents(independent);
  scene.Tetrahedra->SetComponentMixing(mixing);
  scene.Mapper->SetComponentMixing(mixing);
  for (int view = 0; view < 3; ++view) {
    scene.Look(35 + 130 * view, 20 - 30 * view);
    const double psnr = scene.Psnr();
    CHECK(psnr > 55.0, "%d components, independent %d, bytes %d, mixing %d, view %d: %.1f dB", components, independent, bytes, mixing, view,
      psnr);
  }
  CHECK(scene.GridErrors->Count == 0, "%s", scene.GridErrors->Text.c_str());
  CHECK(std::string(scene.Tetrahedra->GetMethodReason()) == "march: several components cannot be projected", "%s",
    scene.Tetrahedra->GetMethodReason());
}

void WhatIsRefused()
{
  GridScene scene;
  SetFields(scene, 3, false);
  SetFunctions(scene.Volume->GetProperty(), 1.0);
  const auto refuses = [&](const char* word) {
    const int before = scene.GridErrors->Count;
    CHECK(scene.GridPicture().empty() && scene.GridErrors->Count == before + 1 && scene.GridErrors->Has(word), "not \"%s\": %s", word,
      scene.GridErrors->Text.c_str());
  };
  scene.Tetrahedra->SetBlendModeToAverageIntensity();
  refuses("values of 3 components are not supported in mode average");
  scene.Tetrahedra->SetBlendModeToComposite();
  scene.Tetrahedra->SetMethodToProject();
  refuses("values of 3 components cannot be projected");
  scene.Tetrahedra->SetMethodToAuto();
  scene.Volume->GetProperty()->ShadeOn();
  refuses("light and gradient opacity of 3 components");
  scene.Volume->GetProperty()->ShadeOff();
  scene.Volume->GetProperty()->IndependentComponentsOff();
  refuses("3 dependent components");
  scene.Volume->GetProperty()->IndependentComponentsOn();
  CHECK(scene.GridLight() > 0.0, "nothing is drawn after errors");
}
} // namespace

int main()
{
  LikeTheImage(true, 2, false, vtkStratusTetrahedraMapper::ADD_COMPONENTS);
  LikeTheImage(true, 4, true, vtkStratusTetrahedraMapper::ADD_COMPONENTS);
  LikeTheImage(true, 3, false, vtkStratusTetrahedraMapper::MEAN_COMPONENTS);
  LikeTheImage(false, 2, false, vtkStratusTetrahedraMapper::ADD_COMPONENTS);
  LikeTheImage(false, 4, true, vtkStratusTetrahedraMapper::ADD_COMPONENTS);
  WhatIsRefused();
  return Failures ? 1 : 0;
}
