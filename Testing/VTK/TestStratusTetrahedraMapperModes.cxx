// SPDX-License-Identifier: BSD-3-Clause
// vtkStratusTetrahedraMapper: every blend mode, clipping planes and crop boxes give the image mapper's picture of an equal linear field.
// Projection refuses the modes that only marching draws.
#include "tetrahedra_scene.h"

#include "vtkCellData.h"
#include "vtkContourValues.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"
#include "vtkMatrix4x4.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPlane.h"
#include "vtkSphere.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>

namespace {
// Sets the same on both mappers.
template <typename Function> void Both(GridScene& scene, Function&& function)
{
  function(scene.Tetrahedra.Get());
  function(scene.Mapper.Get());
}

void Modes()
{
  const char* const names[] = { "composite", "maximum", "minimum", "average", "additive", "isosurface", "slice" };
  for (int mode = 1; mode <= vtkStratusTetrahedraMapper::SLICE_BLEND; ++mode) {
    for (int view = 0; view < 3; ++view) {
      GridScene scene;
      vtkVolumeProperty* look = scene.Volume->GetProperty();
      Both(scene, [&](auto* mapper) {
        mapper->SetBlendMode(mode);
        mapper->SetAverageIPScalarRange(0.2, view == 2 ? 0.6 : 1e9);
      });
      look->SetScalarOpacityUnitDistance(4.0);
      look->GetIsoSurfaceValues()->SetValue(0, 0.31);
      look->GetIsoSurfaceValues()->SetValue(1, 0.52);
      vtkNew<vtkSphere> sphere;
      sphere->SetCenter(scene.Volume->GetCenter());
      sphere->SetRadius(2.5);
      look->SetSliceFunction(sphere);
      scene.Look(35 + 130 * view, 20 - 30 * view);
      scene.Mapper->SetSampleDistance(0.005);
      const double psnr = scene.Psnr();
      CHECK(psnr > 50.0, "%s, view %d: %.1f dB", names[mode], view, psnr);
      CHECK(scene.GridErrors->Count == 0, "%s: %s", names[mode], scene.GridErrors->Text.c_str());
    }
  }
}

void PlanesAndBoxes()
{
  for (const int method : { vtkStratusTetrahedraMapper::MARCH_METHOD, vtkStratusTetrahedraMapper::PROJECT_METHOD }) {
    for (int view = 0; view < 3; ++view) {
      GridScene scene;
      scene.Tetrahedra->SetMethod(method);
      scene.Look(35 + 130 * view, 20 - 30 * view);
      scene.Volume->SetOrientation(10, 20, 30); // boxes turn with the volume, planes do not
      const double whole = scene.GridLight();
      vtkNew<vtkPlane> plane;
      plane->SetOrigin(scene.Volume->GetCenter());
      plane->SetNormal(0.5, -0.7, 0.3 * view);
      Both(scene, [&](auto* mapper) {
        mapper->SetCropping(true);
        mapper->SetCroppingRegionPlanes(0.7, 5.2, 1.3, 6.5, -1.0, 4.6);
      });
      double psnr = scene.Psnr();
      CHECK(psnr > 55.0, "a box, method %d, view %d: %.1f dB", method, view, psnr);
      const double cropped = scene.GridLight();
      Both(scene, [&](auto* mapper) { mapper->AddClippingPlane(plane); });
      psnr = scene.Psnr();
      CHECK(psnr > 55.0, "a plane and a box, method %d, view %d: %.1f dB", method, view, psnr);
      const double cut = scene.GridLight();
      CHECK(0.0 < cut && cut < cropped && cropped < whole, "light %g, cropped %g, cut %g", whole, cropped, cut);
      CHECK(scene.GridErrors->Count == 0, "%s", scene.GridErrors->Text.c_str());
    }
  }
}

// A mask hides the cells whose middle is nearest to a point of byte 0, or outside, as a ghost array hides them.
void Masks()
{
  GridScene scene, ghosts;
  vtkNew<vtkImageData> mask;
  mask->SetDimensions(5, 9, 8);          // not of the grid's size, nor at its place
  mask->SetOrigin(0.213, -0.417, 0.331); // so that no middle is half way between points
  mask->SetSpacing(1.1, 0.7, 0.8);
  mask->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  auto* bytes = static_cast<unsigned char*>(mask->GetScalarPointer());
  for (vtkIdType i = 0; i < mask->GetNumberOfPoints(); ++i) {
    bytes[i] = i % 7 == 0 || i % 5 > 2 ? 0 : 1 + i % 255;
  }
  vtkNew<vtkUnsignedCharArray> hidden;
  hidden->SetName(vtkDataSetAttributes::GhostArrayName());
  for (vtkIdType cell = 0; cell < ghosts.Grid->GetNumberOfCells(); ++cell) {
    vtkIdType count;
    const vtkIdType* ids;
    double middle[3] = { 0, 0, 0 };
    ghosts.Grid->GetCellPoints(cell, count, ids);
    for (vtkIdType i = 0; i < count; ++i) {
      for (int a = 0; a < 3; ++a) {
        middle[a] += ghosts.Grid->GetPoint(ids[i])[a] / 4;
      }
    }
    int at[3], dimensions[3];
    mask->GetDimensions(dimensions);
    bool inside = true;
    for (int a = 0; a < 3; ++a) {
      at[a] = static_cast<int>(std::floor((middle[a] - mask->GetOrigin()[a]) / mask->GetSpacing()[a] + 0.5));
      inside = inside && at[a] >= 0 && at[a] < dimensions[a];
    }
    const bool shows = inside && bytes[(at[2] * dimensions[1] + at[1]) * dimensions[0] + at[0]] > 0;
    hidden->InsertNextValue(shows ? 0 : vtkDataSetAttributes::HIDDENCELL);
  }
  ghosts.Grid->GetCellData()->AddArray(hidden);
  const double whole = scene.GridLight();
  scene.Tetrahedra->SetMaskInput(mask);
  CHECK(scene.GridPicture() == ghosts.GridPicture(), "a mask is not as ghosts");
  CHECK(scene.GridLight() > 0.0 && scene.GridLight() < whole, "light %g of %g", scene.GridLight(), whole);
  bytes[3 * 5 * 9 + 4 * 5 + 2] = 0; // near the middle
  const double before = scene.GridLight();
  mask->Modified();
  CHECK(scene.GridLight() < before, "a changed mask changes nothing");
  // A label map is as the mask if the label has the opacity, and the property, which all else has, none.
  const std::vector<float> masked = scene.GridPicture();
  vtkNew<vtkImageData> map;
  map->DeepCopy(mask);
  auto* labels = static_cast<unsigned char*>(map->GetScalarPointer());
  for (vtkIdType i = 0; i < map->GetNumberOfPoints(); ++i) {
    labels[i] = bytes[i] == 0 ? 0 : 2;
  }
  vtkNew<vtkPiecewiseFunction> clear, dense;
  clear->AddPoint(0, 0);
  dense->AddPoint(0, 0.9);
  vtkVolumeProperty* look = scene.Volume->GetProperty();
  look->SetLabelScalarOpacity(2, scene.Opacity);
  look->SetScalarOpacity(clear);
  scene.Tetrahedra->SetMaskInput(map);
  scene.Tetrahedra->SetMaskTypeToLabelMap();
  const std::vector<float> shown = scene.GridPicture();
  double most = 0.0;
  for (size_t i = 0; i < std::min(masked.size(), shown.size()); ++i) {
    most = std::max(most, std::fabs(static_cast<double>(masked[i] - shown[i])));
  }
  CHECK(shown.size() == masked.size() && most < 1e-3, "a label map is not as the mask: %g", most); // the tolerance
  look->SetLabelScalarOpacity(2, dense);
  CHECK(scene.GridLight() > before, "a label's opacity changes nothing");
  look->SetScalarOpacity(scene.Opacity);
  scene.Tetrahedra->SetMaskInput(mask); // other modes have no use for labels
  scene.Tetrahedra->SetBlendModeToMaximumIntensity();
  const std::vector<float> labelled = scene.GridPicture();
  scene.Tetrahedra->SetMaskInput(nullptr);
  CHECK(labelled == scene.GridPicture() && scene.GridErrors->Count == 0, "a label map in maximum: %s", scene.GridErrors->Text.c_str());
}

// First hits are solids: opaque, lit, at their depth, which ends what is behind.
void FirstHits()
{
  GridScene scene;
  vtkVolumeProperty* look = scene.Volume->GetProperty();
  scene.Opacity->RemoveAllPoints(); // the field 0.1 x + 0.05 z shows from 0.4 on
  scene.Opacity->AddPoint(0.4, 0.0);
  scene.Opacity->AddPoint(1.0, 0.5);
  scene.Tetrahedra->SetRenderModeToFirstHit();
  look->ShadeOn();
  scene.Look(215, 20); // from where the field does not show
  const std::vector<float> faces = scene.GridPicture();
  scene.Tetrahedra->SetNormalsToGradient();
  const std::vector<float> smooth = scene.GridPicture();
  vtkFloatArray* depth = vtkFloatArray::SafeDownCast(scene.Tetrahedra->GetLastImage()->GetPointData()->GetArray("Depth"));
  const stratus_camera camera = ReferenceCamera(scene.Renderer);
  const int width = scene.Renderer->GetSize()[0], height = scene.Renderer->GetSize()[1];
  int inside = 0, wrong = 0;
  for (size_t p = 0; 4 * p < faces.size(); ++p) {
    const double u = (2.0 * (p % width) + 1.0) / width - 1.0, v = (2.0 * (p / width) + 1.0) / height - 1.0;
    double along[3], length = 0.0, local[4] = { 0, 0, 0, 1 };
    CHECK(faces[4 * p + 3] == 0.0f || faces[4 * p + 3] == 1.0f, "alpha %g", faces[4 * p + 3]);
    for (int a = 0; a < 3; ++a) {
      along[a] = camera.forward[a] + u * camera.right[a] + v * camera.up[a];
      length += along[a] * along[a];
    }
    if (faces[4 * p + 3] == 0.0f) {
      continue;
    }
    for (int a = 0; a < 3; ++a) {
      local[a] = camera.eye[a] + depth->GetValue(static_cast<vtkIdType>(p)) * along[a] / std::sqrt(length);
    }
    vtkNew<vtkMatrix4x4> inverse;
    vtkMatrix4x4::Invert(scene.Volume->GetMatrix(), inverse);
    inverse->MultiplyPoint(local, local);
    const double value = 0.1 * local[0] + 0.05 * local[2];
    const bool on = std::fabs(value - 0.4) < 1e-3;
    inside += on;
    bool side = false;
    for (int a = 0; a < 3; ++a) {
      side = side || std::fabs(local[a]) < 1e-3 || std::fabs(local[a] - Boxes) < 1e-3;
    }
    wrong += !(on || (side && value > 0.4));
    // a linear field's gradient is the same by either kind of normals
    for (size_t c = 0; on && !side && c < 3; ++c) {
      CHECK(
        std::fabs(faces[4 * p + c] - smooth[4 * p + c]) < 1e-3f, "light by cells %g, by points %g", faces[4 * p + c], smooth[4 * p + c]);
    }
  }
  CHECK(inside > 500 && wrong == 0, "%d hits within cells, %d nowhere", inside, wrong);
  CHECK(scene.GridErrors->Count == 0, "%s", scene.GridErrors->Text.c_str());
}

void WhatIsRefused()
{
  GridScene scene;
  const auto refuses = [&](const char* word) {
    const int before = scene.GridErrors->Count;
    CHECK(scene.GridPicture().empty() && scene.GridErrors->Count == before + 1 && scene.GridErrors->Has(word), "not \"%s\": %s", word,
      scene.GridErrors->Text.c_str());
  };
  scene.Tetrahedra->SetBlendModeToMinimumIntensity();
  scene.Tetrahedra->SetMethodToProject();
  refuses("mode minimum cannot be projected");
  scene.Tetrahedra->SetMethodToAuto();
  CHECK(scene.GridLight() > 0.0, "auto marches");
  CHECK(std::string(scene.Tetrahedra->GetMethodReason()) == "march: mode minimum cannot be projected", "%s",
    scene.Tetrahedra->GetMethodReason());
  scene.Tetrahedra->SetBlendModeToIsoSurface();
  scene.Volume->GetProperty()->GetIsoSurfaceValues()->SetNumberOfContours(0);
  refuses("0 contour values");
  scene.Volume->GetProperty()->GetIsoSurfaceValues()->SetNumberOfContours(17);
  refuses("17 isosurface values");
  vtkNew<vtkImageData> mask;
  mask->SetDimensions(3, 3, 3);
  mask->AllocateScalars(VTK_FLOAT, 1);
  scene.Tetrahedra->SetMaskInput(mask);
  refuses("no point scalars of one unsigned char");
  scene.Tetrahedra->SetMaskInput(nullptr);
  scene.Tetrahedra->SetRenderModeToFirstHit();
  refuses("blend mode 5 is not supported in first hits");
  scene.Tetrahedra->SetRenderModeToComposite();
  scene.Tetrahedra->SetBlendMode(7);
  refuses("blend mode 7");
  scene.Tetrahedra->SetBlendModeToSlice();
  refuses("needs a SliceFunction");
  scene.Tetrahedra->SetBlendModeToAverageIntensity();
  scene.Tetrahedra->SetAverageIPScalarRange(2, 1);
  refuses("average_range 2 .. 1");
  scene.Tetrahedra->SetBlendModeToComposite();
  scene.Tetrahedra->CroppingOn();
  scene.Tetrahedra->SetCroppingRegionPlanes(0, 1, 3, 2, 0, 1);
  refuses("crop_bounds 3 .. 2 along axis 1");
  scene.Tetrahedra->CroppingOff();
  CHECK(scene.GridLight() > 0.0, "nothing is drawn after errors");
}
} // namespace

int main()
{
  Modes();
  PlanesAndBoxes();
  Masks();
  FirstHits();
  WhatIsRefused();
  return Failures ? 1 : 0;
}
