// SPDX-License-Identifier: BSD-3-Clause
// All that an image can hold: types, memory layouts, arrays by name and number, ghosts and blanking, single layers; and cropping, clipping.
#include "mapper_testing.h"

#include "vtkContourValues.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageShiftScale.h"
#include "vtkPlane.h"
#include "vtkSOADataArrayTemplate.h"

namespace {
// The field in 0..100, rounded, is exact in every type: pictures of integers must be the same to the bit.
void Types()
{
  std::vector<float> first;
  const int types[] = { VTK_CHAR, VTK_SIGNED_CHAR, VTK_UNSIGNED_CHAR, VTK_SHORT, VTK_UNSIGNED_SHORT, VTK_INT, VTK_UNSIGNED_INT, VTK_LONG,
    VTK_UNSIGNED_LONG, VTK_LONG_LONG, VTK_UNSIGNED_LONG_LONG, VTK_ID_TYPE, VTK_FLOAT, VTK_DOUBLE };
  for (int type : types) {
    Scene scene(64, 48);
    scene.Opacity->RemoveAllPoints();
    scene.Opacity->AddPoint(10, 0);
    scene.Opacity->AddPoint(100, 0.6);
    scene.Mapper->SetSamplingToMidpoint(); // by hand: entries of the types' tables differ in width, so a probe may choose different steps
    scene.Mapper->SetSampleDistance(0.5);
    vtkDataArray* field = scene.Image->GetPointData()->GetScalars();
    auto typed = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(type));
    typed->SetName("typed");
    typed->SetNumberOfTuples(field->GetNumberOfTuples());
    for (vtkIdType i = 0; i < field->GetNumberOfTuples(); ++i) {
      typed->SetTuple1(i, std::round(100.0 * field->GetTuple1(i)));
    }
    scene.Image->GetPointData()->SetScalars(typed);
    const std::vector<float> picture = scene.Picture();
    CHECK(scene.Errors->Count == 0, "%s: %s", typed->GetDataTypeAsString(), scene.Errors->Text.c_str());
    CHECK(scene.Light() > 10.0, "%s: nothing to see", typed->GetDataTypeAsString());
    if (first.empty()) {
      first = picture;
    }
    double worst = 0.0;
    for (size_t i = 0; i < picture.size(); ++i) {
      worst = std::max(worst, std::fabs(static_cast<double>(picture[i]) - first[i]));
    }
    // Integers of more than 24 bits are kept relative to their first value, 0 here, so nothing may differ. Floats and doubles have table
    // entries of two other widths, so they differ from integers by an entry's width.
    const double most = type == VTK_FLOAT || type == VTK_DOUBLE ? 0.001 : 0.0;
    CHECK(worst <= most, "%s differs from char by %g", typed->GetDataTypeAsString(), worst);
  }
}

void Layouts()
{
  Scene scene(64, 48);
  const std::vector<float> plain = scene.Picture();
  vtkDataArray* field = scene.Image->GetPointData()->GetScalars();
  vtkNew<vtkSOADataArrayTemplate<float>> arrays;
  arrays->SetName("soa");
  arrays->SetNumberOfComponents(1);
  arrays->SetNumberOfTuples(field->GetNumberOfTuples());
  for (vtkIdType i = 0; i < field->GetNumberOfTuples(); ++i) {
    arrays->SetValue(i, static_cast<float>(field->GetTuple1(i)));
  }
  vtkNew<vtkFloatArray> other;
  other->DeepCopy(field);
  other->Fill(0.0);
  other->SetName("zero");
  scene.Image->GetPointData()->AddArray(arrays);
  scene.Image->GetPointData()->AddArray(other);
  scene.Mapper->SetScalarModeToUsePointFieldData();
  scene.Mapper->SelectScalarArray("soa");
  CHECK(scene.Picture() == plain, "a structure of arrays gives another picture");
  const vtkTypeUInt64 builds = scene.Mapper->GetRangeBuilds();
  CHECK(scene.Picture() == plain && scene.Mapper->GetRangeBuilds() == builds, "a structure of arrays is read again for each picture");
  scene.Mapper->SelectScalarArray("zero");
  CHECK(scene.Light() == 0.0, "the array 'zero' shows");
  scene.Mapper->SelectScalarArray(0);
  CHECK(scene.Picture() == plain, "array number 0 gives another picture");
  scene.Mapper->SelectScalarArray(2);
  CHECK(scene.Light() == 0.0, "array number 2, 'zero', shows");
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
}

// Blanked points and cells are transparent. The light that remains of a constant volume measures how many cells are drawn.
void Blanking()
{
  Scene scene(64, 48);
  const double whole = scene.Light();
  vtkNew<vtkUnsignedCharArray> cells;
  cells->SetName(vtkDataSetAttributes::GhostArrayName());
  cells->SetNumberOfTuples(scene.Image->GetNumberOfCells());
  cells->Fill(0);
  scene.Image->GetCellData()->AddArray(cells);
  CHECK(scene.Light() == whole, "a ghost array of zeros changes the picture");
  for (vtkIdType c = 0; c < cells->GetNumberOfTuples() / 2; ++c) {
    cells->SetValue(c, vtkDataSetAttributes::HIDDENCELL);
  }
  cells->Modified();
  const double half = scene.Light();
  CHECK(half > 0.05 * whole && half < 0.95 * whole, "half of the cells hidden: light %g of %g", half, whole);
  cells->Fill(vtkDataSetAttributes::HIDDENCELL);
  cells->Modified();
  CHECK(scene.Light() == 0.0, "hidden cells show");
  scene.Image->GetCellData()->RemoveArray(vtkDataSetAttributes::GhostArrayName());
  CHECK(scene.Light() == whole, "cells stay hidden");

  vtkNew<vtkUnsignedCharArray> points;
  points->SetName(vtkDataSetAttributes::GhostArrayName());
  points->SetNumberOfTuples(scene.Image->GetNumberOfPoints());
  points->Fill(vtkDataSetAttributes::HIDDENPOINT);
  scene.Image->GetPointData()->AddArray(points);
  CHECK(scene.Light() == 0.0, "hidden points show");
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
}

// A hidden point hides the cells that touch it, where values are of cells, too.
void HiddenPointsOfCells()
{
  Scene scene(64, 48);
  vtkImageData* image = scene.Image;
  int count[3];
  image->GetDimensions(count);
  FillField(image, true, "of cells");
  scene.Mapper->SetScalarModeToUseCellData();
  const std::vector<float> plain = scene.Picture();
  vtkNew<vtkUnsignedCharArray> points, cells;
  points->SetName(vtkDataSetAttributes::GhostArrayName());
  points->SetNumberOfTuples(image->GetNumberOfPoints());
  points->Fill(0);
  cells->SetName(vtkDataSetAttributes::GhostArrayName());
  cells->SetNumberOfTuples(image->GetNumberOfCells());
  cells->Fill(0);
  const int at[3][3] = { { 11, 11, 11 }, { 22, 17, 14 }, { count[0] - 1, 0, 1 } }; // within the blobs, and at the border
  for (const int* p : at) {
    points->SetValue((p[2] * count[1] + p[1]) * count[0] + p[0], vtkDataSetAttributes::HIDDENPOINT);
    for (int c = 0; c < 8; ++c) {
      const int i = p[0] - (c & 1), j = p[1] - (c >> 1 & 1), k = p[2] - (c >> 2);
      if (i >= 0 && j >= 0 && k >= 0 && i < count[0] - 1 && j < count[1] - 1 && k < count[2] - 1) {
        cells->SetValue((k * (count[1] - 1) + j) * (count[0] - 1) + i, vtkDataSetAttributes::HIDDENCELL);
      }
    }
  }
  image->GetCellData()->AddArray(cells);
  const std::vector<float> hidden = scene.Picture();
  image->GetCellData()->RemoveArray(vtkDataSetAttributes::GhostArrayName());
  CHECK(hidden != plain && scene.Picture() == plain, "hidden cells change nothing, or stay");
  image->GetPointData()->AddArray(points);
  CHECK(scene.Picture() == hidden, "hidden points do not hide the cells at them");
  points->Fill(0);
  points->Modified();
  CHECK(scene.Picture() == plain, "cells at points that are shown again stay hidden");
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
}

void Cropping()
{
  Scene scene;
  scene.Mapper->SetSampleDistance(0.25);
  scene.Image->SetExtent(5, 37, -4, 24, 0, 24);
  scene.Image->SetOrigin(-2, 3, 1);
  scene.Look(35, 20);
  const double whole = scene.Light();
  // VTK's planes are in the image's own coordinates: here voxels 12..25, 0..18, 3..20.
  const double planes[6] = { -2 + 0.9 * 12, -2 + 0.9 * 25, 3, 3 + 18, 1 + 1.1 * 3, 1 + 1.1 * 20 };
  scene.Mapper->CroppingOn();
  scene.Mapper->SetCroppingRegionPlanes(planes);
  const double part = scene.Light();
  CHECK(part > 0.1 * whole && part < 0.9 * whole, "cropped light %g of %g", part, whole);
  const double psnr = ReferencePsnr(scene, [&](reference_scene& reference) {
    reference.crop = 1;
    std::copy_n(planes, 6, reference.crop_bounds);
  });
  CHECK(psnr >= 76.0, "cropped: %.1f dB against the reference", psnr);
  scene.Mapper->CroppingOff();
  CHECK(scene.Light() == whole, "cropping that is off crops");
}

// Cropping planes are along the image's own axes. Planes along the axes of a mirrored image's bounds miss the image, and a warning says so.
void CropMirrored()
{
  Scene scene;
  vtkNew<ErrorObserver> warnings;
  scene.Mapper->AddObserver(vtkCommand::WarningEvent, warnings);
  scene.Mapper->SetSampleDistance(0.25);
  scene.Image->SetDirectionMatrix(-1, 0, 0, 0, 1, 0, 0, 0, 1);
  scene.Look(35, 20);
  scene.Mapper->CroppingOn();
  scene.Mapper->SetCroppingRegionPlanes(scene.Image->GetBounds());
  CHECK(scene.Light() == 0.0, "planes of the bounds show something");
  CHECK(warnings->Count == 1 && warnings->Has("-28.8 and 0 miss the image, which extends from 0 to 28.8 along its own x axis"),
    "%d warnings: %s", warnings->Count, warnings->Text.c_str());
  scene.Render();
  CHECK(warnings->Count == 1, "warned again: %s", warnings->Text.c_str());
  const double planes[6] = { 0.9 * 12, 0.9 * 25, 0, 18, 1.1 * 3, 1.1 * 20 };
  scene.Mapper->SetCroppingRegionPlanes(planes);
  scene.Render();
  const double psnr = ReferencePsnr(scene, [&](reference_scene& reference) {
    reference.crop = 1;
    std::copy_n(planes, 6, reference.crop_bounds);
  });
  CHECK(psnr >= 76.0, "cropped along the image's axes: %.1f dB against the reference", psnr);
  CHECK(warnings->Count == 1 && scene.Errors->Count == 0, "%s", warnings->Text.c_str());
}

void Clipping()
{
  Scene scene;
  scene.Mapper->SetSampleDistance(0.25);
  scene.Volume->RotateX(30); // VTK's planes are in the world, not in the volume
  scene.Look(35, 20);
  const double whole = scene.Light();
  vtkNew<vtkPlane> planes[2];
  planes[0]->SetOrigin(12, 5, 12);
  planes[0]->SetNormal(0.6, 0, 0.8);
  planes[1]->SetOrigin(14, 8, 14);
  planes[1]->SetNormal(-1, 0.2, 0);
  for (auto& plane : planes) {
    scene.Mapper->AddClippingPlane(plane);
  }
  const double part = scene.Light();
  CHECK(part > 0.05 * whole && part < 0.95 * whole, "clipped light %g of %g", part, whole);
  const double psnr = ReferencePsnr(scene, [&](reference_scene& reference) {
    reference.clip_plane_count = 2;
    for (int p = 0; p < 2; ++p) {
      double normal[3], origin[3];
      planes[p]->GetNormal(normal);
      planes[p]->GetOrigin(origin);
      std::copy_n(normal, 3, reference.clip_planes[p]);
      reference.clip_planes[p][3] = -(normal[0] * origin[0] + normal[1] * origin[1] + normal[2] * origin[2]);
    }
  });
  CHECK(psnr >= 76.0, "clipped: %.1f dB against the reference", psnr);
}

// A layer of values on points is a sheet of a voxel's thickness, as VTK's mapper shows it, about the points: the same picture as of two
// layers of the values. Along either axis, in any mode, with a mask, and as a row of points.
void Sheets()
{
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool row : { false, true }) {
      int extent[6] = { 3, 22, -2, 17, 4, 20 }, twice[6];
      double origin[3] = { 1, 2, 3 }, moved[3];
      const double spacing[3] = { 0.9, 1.0, 1.1 };
      Scene scene(64, 48), thick(64, 48);
      vtkNew<vtkImageData> flat, layers, mask, masks;
      std::copy_n(origin, 3, moved);
      extent[2 * axis + 1] = extent[2 * axis];
      extent[2 * ((axis + 1) % 3) + 1] = row ? extent[2 * ((axis + 1) % 3)] : extent[2 * ((axis + 1) % 3) + 1];
      std::copy_n(extent, 6, twice);
      for (int a = 0; a < 3; ++a) {
        if (extent[2 * a] == extent[2 * a + 1]) {
          ++twice[2 * a + 1];
          moved[a] -= 0.5 * spacing[a];
        }
      }
      flat->SetExtent(extent);
      layers->SetExtent(twice);
      flat->SetOrigin(origin);
      layers->SetOrigin(moved);
      for (vtkImageData* image : { flat.Get(), layers.Get() }) {
        vtkImageData* hides = image == flat ? mask.Get() : masks.Get();
        image->SetSpacing(spacing);
        image->AllocateScalars(VTK_FLOAT, 1);
        hides->SetExtent(image->GetExtent());
        hides->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
        int at[6];
        image->GetExtent(at);
        for (int k = at[4]; k <= at[5]; ++k) {
          for (int j = at[2]; j <= at[3]; ++j) {
            for (int i = at[0]; i <= at[1]; ++i) { // of the one layer's points
              const int of[3] = { std::min(i, extent[1]), std::min(j, extent[3]), std::min(k, extent[5]) };
              *static_cast<float*>(image->GetScalarPointer(i, j, k)) =
                static_cast<float>(0.5 + 0.4 * std::sin(of[0] + 2.0 * of[1] + of[2]));
              *static_cast<unsigned char*>(hides->GetScalarPointer(i, j, k)) = (of[0] + of[1] + of[2]) % 5 != 0;
            }
          }
        }
      }
      scene.Mapper->SetInputData(flat);
      thick.Mapper->SetInputData(layers);
      scene.Look(35, 20);
      thick.Look(35, 20);
      const double *mine = scene.Volume->GetBounds(), *wanted = layers->GetBounds();
      for (int b = 0; b < 6; ++b) {
        CHECK(std::fabs(mine[b] - wanted[b]) < 1e-9, "axis %d: bound %d is %g, not %g", axis, b, mine[b], wanted[b]);
      }
      for (int mode = 0; mode <= vtkVolumeMapper::ISOSURFACE_BLEND + 1; ++mode) {
        const bool masked = mode > vtkVolumeMapper::ISOSURFACE_BLEND;
        for (Scene* s : { &scene, &thick }) {
          s->Mapper->SetBlendMode(masked ? vtkVolumeMapper::COMPOSITE_BLEND : mode);
          s->Mapper->SetMaskInput(!masked ? nullptr : s == &scene ? mask.Get() : masks.Get());
          s->Volume->GetProperty()->GetIsoSurfaceValues()->SetValue(0, 0.6);
        }
        const std::vector<float> picture = scene.Picture(), of_layers = thick.Picture();
        double worst = 0.0, light = 0.0;
        for (size_t i = 0; i < std::min(picture.size(), of_layers.size()); ++i) {
          worst = std::max(worst, std::fabs(static_cast<double>(picture[i]) - of_layers[i]));
          light += picture[i];
        }
        CHECK(light > 1.0 && worst < 0.01, "axis %d, row %d, mode %d: light %g, %g from two layers", axis, row, mode, light, worst);
      }
      CHECK(scene.Errors->Count == 0, "axis %d: %s", axis, scene.Errors->Text.c_str());
    }
  }
}

// Cells in a single layer have a thickness of their own.
void SingleLayers()
{
  Scene cells(64, 48);
  vtkNew<vtkImageData> layer;
  layer->SetDimensions(20, 20, 2);
  FillField(layer, true, "layer");
  layer->GetCellData()->GetScalars()->Fill(1.0);
  cells.Mapper->SetInputData(layer);
  cells.Look(20, 30);
  CHECK(cells.Light() > 10.0, "a layer of cells does not show");
  CHECK(cells.Errors->Count == 0, "%s", cells.Errors->Text.c_str());
}

void Pipeline()
{
  Scene scene(64, 48);
  const std::vector<float> before = scene.Picture();
  vtkNew<vtkImageShiftScale> shift;
  shift->SetInputData(scene.Image);
  shift->SetOutputScalarTypeToFloat();
  scene.Mapper->SetInputConnection(shift->GetOutputPort());
  CHECK(scene.Picture() == before, "the same data by a pipeline give another picture");
  shift->SetScale(0.5);
  CHECK(scene.Picture() != before, "the mapper does not update its pipeline");
}
} // namespace

int main()
{
  Types();
  Layouts();
  Blanking();
  HiddenPointsOfCells();
  Cropping();
  CropMirrored();
  Clipping();
  Sheets();
  SingleLayers();
  Pipeline();
  return Failures == 0 ? 0 : 1;
}
