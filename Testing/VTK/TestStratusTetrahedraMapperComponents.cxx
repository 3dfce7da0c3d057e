// SPDX-License-Identifier: BSD-3-Clause
// vtkStratusTetrahedraMapper: arrays of two to four components give the image mapper's picture of equal linear fields: independent
// components by sums and by shares, and dependent ones; lit and unlit; in all modes. The colour function selects a component, and
// components that cannot be drawn are refused.
#include "tetrahedra_scene.h"

#include "vtkColorTransferFunction.h"
#include "vtkContourValues.h"
#include "vtkDoubleArray.h"
#include "vtkMultiBlockDataSet.h"
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

// Light with a material for each component, of which the second, if independent, is not lit; and gradient opacity of the first.
void SetLight(vtkVolumeProperty* look, int components, double most)
{
  vtkNew<vtkPiecewiseFunction> thin;
  thin->AddPoint(0.0, 0.2);
  thin->AddPoint(0.3 * most, 1.0);
  look->SetGradientOpacity(0, thin);
  for (int c = 0; c < components; ++c) {
    look->SetShade(c, c != 1);
    look->SetAmbient(c, 0.1 + 0.1 * c);
    look->SetDiffuse(c, 0.8 - 0.1 * c);
    look->SetSpecular(c, 0.3);
    look->SetSpecularPower(c, 5.0 + 4.0 * c);
  }
}

void LikeTheImage(bool independent, int components, bool bytes, int mixing, bool lit = false)
{
  GridScene scene;
  SetFields(scene, components, bytes);
  SetFunctions(scene.Volume->GetProperty(), bytes ? 240.0 : 1.0);
  scene.Volume->GetProperty()->SetIndependentComponents(independent);
  if (lit) {
    SetLight(scene.Volume->GetProperty(), components, bytes ? 240.0 : 1.0);
  }
  scene.Tetrahedra->SetComponentMixing(mixing);
  scene.Mapper->SetComponentMixing(mixing);
  for (int view = 0; view < 3; ++view) {
    scene.Look(35 + 130 * view, 20 - 30 * view);
    const double psnr = scene.Psnr();
    CHECK(psnr > 55.0, "%d components, independent %d, bytes %d, mixing %d, lit %d, view %d: %.1f dB", components, independent, bytes,
      mixing, lit, view, psnr);
  }
  CHECK(scene.GridErrors->Count == 0, "%s", scene.GridErrors->Text.c_str());
  CHECK(lit || std::string(scene.Tetrahedra->GetMethodReason()) == "march: several components cannot be projected", "%s",
    scene.Tetrahedra->GetMethodReason());
}

// Each component is drawn by itself, and the pictures are added, or their lit surfaces are drawn by depth, as the image mapper does.
void ModesLikeTheImage(int mode, int components, bool bytes)
{
  GridScene scene;
  SetFields(scene, components, bytes);
  SetFunctions(scene.Volume->GetProperty(), bytes ? 240.0 : 1.0);
  scene.Volume->GetProperty()->SetScalarOpacityUnitDistance(0, 9.0);
  if (mode == vtkStratusTetrahedraMapper::ISOSURFACE_BLEND) {
    SetLight(scene.Volume->GetProperty(), components, bytes ? 240.0 : 1.0);
    scene.Volume->GetProperty()->GetIsoSurfaceValues()->SetValue(0, bytes ? 100.5 : 0.4);
    scene.Volume->GetProperty()->GetIsoSurfaceValues()->SetValue(1, bytes ? 150.5 : 0.6);
  }
  scene.Tetrahedra->SetBlendMode(mode);
  scene.Mapper->SetBlendMode(mode);
  for (int view = 0; view < 3; ++view) {
    scene.Look(35 + 130 * view, 20 - 30 * view);
    const double psnr = scene.Psnr();
    CHECK(psnr > 45.0, "mode %d, %d components, bytes %d, view %d: %.1f dB", mode, components, bytes, view, psnr);
  }
  CHECK(scene.GridErrors->Count == 0, "%s", scene.GridErrors->Text.c_str());
}

// What VectorMode of the colour function chooses is drawn as an array of these values is, to the bit: of one grid and of blocks.
void VectorsLikeTheirValues(bool blocks, int components)
{
  GridScene scene;
  SetFields(scene, std::min(components, 4), true);
  vtkDataArray* fields = scene.Grid->GetPointData()->GetScalars();
  vtkNew<vtkUnsignedCharArray> vectors;
  vtkNew<vtkDoubleArray> lengths;
  vtkNew<vtkUnsignedCharArray> second, first;
  vectors->SetNumberOfComponents(components);
  for (vtkIdType p = 0; p < fields->GetNumberOfTuples(); ++p) {
    double square = 0.0;
    for (int c = 0; c < components; ++c) {
      const double value = fields->GetComponent(p, c % 4);
      vectors->InsertComponent(p, c, value);
      square += value * value;
    }
    lengths->InsertNextValue(std::sqrt(square));
    first->InsertNextValue(static_cast<unsigned char>(fields->GetComponent(p, 0)));
    second->InsertNextValue(static_cast<unsigned char>(fields->GetComponent(p, 1)));
  }
  SetFunctions(scene.Volume->GetProperty(), 240.0);
  vtkNew<vtkMultiBlockDataSet> several;
  const auto picture = [&](vtkDataArray* values) {
    vtkNew<vtkUnstructuredGrid> one, other;
    for (vtkUnstructuredGrid* grid : { one.Get(), other.Get() }) {
      grid->ShallowCopy(scene.Grid);
      grid->GetPointData()->SetScalars(values);
    }
    vtkNew<vtkPoints> moved;
    moved->DeepCopy(one->GetPoints());
    for (vtkIdType p = 0; p < moved->GetNumberOfPoints(); ++p) {
      moved->SetPoint(p, moved->GetPoint(p)[0] + Boxes, moved->GetPoint(p)[1], moved->GetPoint(p)[2]);
    }
    other->SetPoints(moved);
    several->SetBlock(0, one);
    several->SetBlock(1, other);
    scene.Tetrahedra->SetInputDataObject(blocks ? static_cast<vtkDataObject*>(several) : one);
    return scene.GridPicture();
  };
  vtkColorTransferFunction* color = scene.Volume->GetProperty()->GetRGBTransferFunction();
  const std::vector<float> of_lengths = picture(lengths), of_first = picture(first), of_second = picture(second);
  CHECK(of_lengths != of_second && of_first != of_second && !of_second.empty(), "the fields show the same");
  color->SetVectorModeToMagnitude();
  CHECK(picture(vectors) == of_lengths, "%d components, blocks %d: magnitudes", components, blocks);
  color->SetVectorModeToComponent();
  color->SetVectorComponent(1);
  CHECK(picture(vectors) == of_second, "%d components, blocks %d: the second", components, blocks);
  color->SetVectorComponent(0);
  CHECK((picture(vectors) == of_first) == (components > 4), "%d components, blocks %d: the first is drawn", components, blocks);
  CHECK(scene.GridErrors->Count == 0, "%s", scene.GridErrors->Text.c_str());
  color->SetVectorComponent(7);
  CHECK(picture(vectors).empty() && scene.GridErrors->Count == 1 && scene.GridErrors->Has("VectorComponent is 7") &&
      scene.GridErrors->Has(("0 to " + std::to_string(components - 1)).c_str()),
    "%s", scene.GridErrors->Text.c_str());
  color->SetVectorComponent(1);
  CHECK(picture(vectors) == of_second, "nothing is drawn after an error");
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
  scene.Volume->GetProperty()->IndependentComponentsOff();
  refuses("3 dependent components of type");
  scene.Volume->GetProperty()->IndependentComponentsOn();
  scene.Tetrahedra->SetBlendModeToComposite();
  scene.Tetrahedra->SetMethodToProject();
  refuses("values of 3 components cannot be projected");
  scene.Tetrahedra->SetMethodToAuto();
  scene.Volume->GetProperty()->ShadeOn(2);
  scene.Volume->GetProperty()->SetAmbient(2, -1.0);
  refuses("material of component 2");
  scene.Volume->GetProperty()->ShadeOff(2);
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
  LikeTheImage(true, 3, false, vtkStratusTetrahedraMapper::ADD_COMPONENTS, true);
  LikeTheImage(true, 2, false, vtkStratusTetrahedraMapper::MEAN_COMPONENTS, true);
  LikeTheImage(false, 2, false, vtkStratusTetrahedraMapper::ADD_COMPONENTS, true);
  LikeTheImage(false, 4, true, vtkStratusTetrahedraMapper::ADD_COMPONENTS, true);
  for (int mode = vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND; mode <= vtkVolumeMapper::ADDITIVE_BLEND; ++mode) {
    ModesLikeTheImage(mode, 1 + mode % 4 + (mode % 4 == 0), mode == vtkVolumeMapper::MINIMUM_INTENSITY_BLEND);
  }
  ModesLikeTheImage(vtkStratusTetrahedraMapper::ISOSURFACE_BLEND, 3, false);
  ModesLikeTheImage(vtkStratusTetrahedraMapper::ISOSURFACE_BLEND, 2, true);
  VectorsLikeTheirValues(false, 3);
  VectorsLikeTheirValues(true, 3);
  VectorsLikeTheirValues(false, 6);
  WhatIsRefused();
  return Failures ? 1 : 0;
}
