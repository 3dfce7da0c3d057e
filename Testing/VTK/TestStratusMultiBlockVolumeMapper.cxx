// SPDX-License-Identifier: BSD-3-Clause
// vtkStratusMultiBlockVolumeMapper: a volume in uneven blocks, which no order of their middles draws right, looks like the whole volume.
// Blocks that the mapper leaves out, and inputs that it refuses.
#include "mapper_testing.h"

#include "vtkStratusMultiBlockVolumeMapper.h"

#include "vtkContourValues.h"
#include "vtkDoubleArray.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPolyData.h"
#include "vtkRectilinearGrid.h"
#include "vtkSphereSource.h"

namespace {
// Four blocks that wind around a fifth, so that no plane parts all of them; the last one is long and thin.
const int Extents[5][6] = { { 0, 22, 0, 10, 0, 24 }, { 22, 32, 0, 19, 0, 24 }, { 9, 32, 19, 28, 0, 24 }, { 0, 9, 10, 28, 0, 24 },
  { 9, 22, 10, 19, 0, 24 } };

vtkSmartPointer<vtkImageData> Part(vtkImageData* image, const int extent[6])
{
  vtkNew<vtkImageData> part;
  part->DeepCopy(image);
  part->Crop(extent);
  return part.Get();
}

vtkSmartPointer<vtkRectilinearGrid> WithCoordinates(vtkImageData* image)
{
  vtkNew<vtkRectilinearGrid> grid;
  grid->SetDimensions(image->GetDimensions());
  vtkNew<vtkDoubleArray> axes[3];
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < image->GetDimensions()[axis]; ++i) {
      axes[axis]->InsertNextValue(image->GetOrigin()[axis] + image->GetSpacing()[axis] * (image->GetExtent()[2 * axis] + i));
    }
  }
  grid->SetXCoordinates(axes[0]);
  grid->SetYCoordinates(axes[1]);
  grid->SetZCoordinates(axes[2]);
  grid->GetPointData()->ShallowCopy(image->GetPointData());
  return grid.Get();
}

struct Blocks : Scene {
  Blocks()
  {
    this->Volume->RotateZ(20);
    this->Volume->SetScale(1.0, -1.0, 1.2);
    this->Renderer->SetBackground(51 / 255.0, 102 / 255.0, 204 / 255.0);
    vtkNew<vtkMultiBlockDataSet> inner;
    for (unsigned int i = 0; i < 5; ++i) {
      const vtkSmartPointer<vtkImageData> part = Part(this->Image, Extents[i]);
      if (i == 3) {
        inner->SetBlock(i, WithCoordinates(part));
      } else {
        inner->SetBlock(i, part);
      }
    }
    this->Data->SetBlock(2, inner);
    this->Many->SetInputDataObject(this->Data);
    this->Many->GetSettings()->SetDevice("host");
    for (vtkStratusVolumeMapper* mapper : { this->Many->GetSettings(), this->Mapper.Get() }) { // each would choose its own
      mapper->SetSampling(vtkStratusVolumeMapper::PREINTEGRATED_SAMPLING);
      mapper->SetSampleDistance(0.25);
    }
    this->Many->AddObserver(vtkCommand::ErrorEvent, this->Errors);
    this->Many->AddObserver(vtkCommand::WarningEvent, this->Warnings);
    this->Look(35, 20);
  }

  // The whole volume's float picture, and then what the blocks show in the window: the largest difference in 1/255.
  double Difference()
  {
    this->Volume->SetMapper(this->Mapper);
    const std::vector<float> whole = this->Picture();
    CHECK(!whole.empty(), "nothing is drawn: %s", this->Mapper->GetLastError());
    if (whole.empty()) {
      return 255.0;
    }
    this->Volume->SetMapper(this->Many);
    this->Render();
    const std::vector<unsigned char> bytes = this->Bytes();
    double worst = 0.0;
    const double* background = this->Renderer->GetBackground();
    for (size_t p = 0; p < this->Pixels(); ++p) {
      for (size_t c = 0; c < 3; ++c) {
        const double meant = whole[4 * p + c] + (1.0 - whole[4 * p + 3]) * background[c];
        worst = std::max(worst, std::fabs(255.0 * meant - bytes[4 * p + c]));
      }
    }
    return worst;
  }

  vtkNew<vtkMultiBlockDataSet> Data;
  vtkNew<vtkStratusMultiBlockVolumeMapper> Many;
  vtkNew<ErrorObserver> Warnings;
};

// From everywhere, in both projections, and from within a block. The window rounds to a byte, once.
void AsTheWhole()
{
  Blocks scene;
  for (int view = 0; view < 12; ++view) {
    scene.Renderer->GetActiveCamera()->SetParallelProjection(view % 2);
    scene.Look(30 * view + 7, (view % 5) * 35 - 70);
    const double worst = scene.Difference();
    CHECK(worst <= 0.7, "view %d: %.2f of 255", view, worst);
    CHECK(scene.Many->GetNumberOfBlocks() == 5, "%d blocks", scene.Many->GetNumberOfBlocks());
  }
  scene.Renderer->GetActiveCamera()->SetParallelProjection(0);
  scene.Renderer->GetActiveCamera()->SetPosition(scene.Volume->GetCenter());
  scene.Renderer->GetActiveCamera()->SetFocalPoint(100, 20, 5);
  scene.Renderer->ResetCameraClippingRange();
  const double inside = scene.Difference();
  CHECK(inside <= 0.7, "from within: %.2f of 255", inside);
  CHECK(scene.Errors->Count == 0 && scene.Warnings->Count == 0, "it complains: %s", scene.Errors->Text.c_str());
}

// The same order with each block in a colour that hides what is behind it: a wrong order would show whole faces wrong.
void Opaque()
{
  Blocks scene;
  scene.Opacity->RemoveAllPoints();
  scene.Opacity->AddPoint(0.0, 0.9);
  scene.Opacity->AddPoint(1.0, 1.0);
  for (int view = 0; view < 8; ++view) {
    scene.Look(45 * view + 11, (view % 3) * 50 - 50);
    const double worst = scene.Difference();
    CHECK(worst <= 0.7, "opaque, view %d: %.2f of 255", view, worst);
  }
}

// Modes whose rays keep a number are of all blocks together, and a mask holds for all of them.
void InOtherModes()
{
  static const int modes[] = { vtkVolumeMapper::COMPOSITE_BLEND, vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND,
    vtkVolumeMapper::MINIMUM_INTENSITY_BLEND, vtkVolumeMapper::AVERAGE_INTENSITY_BLEND, vtkVolumeMapper::ADDITIVE_BLEND };
  Blocks scene;
  vtkNew<vtkImageData> mask;
  mask->CopyStructure(scene.Image);
  mask->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  auto* bytes = static_cast<unsigned char*>(mask->GetScalarPointer());
  for (vtkIdType i = 0; i < mask->GetNumberOfPoints(); ++i) {
    bytes[i] = i / 5 % 3 ? 255 : 0;
  }
  for (const int mode : modes) {
    for (const bool masked : { false, true }) {
      for (vtkStratusVolumeMapper* mapper : { scene.Many->GetSettings(), scene.Mapper.Get() }) {
        mapper->SetSampling(vtkStratusVolumeMapper::MIDPOINT_SAMPLING);
        mapper->SetSampleDistance(0.02); // a sample is cut at a block's border
        mapper->SetMaskInput(masked ? mask.Get() : nullptr);
      }
      scene.Mapper->SetBlendMode(mode);
      scene.Many->SetBlendMode(mode);
      const double worst = scene.Difference();
      CHECK(worst <= (masked ? 2.0 : 1.0), "mode %d%s: %.2f of 255", mode, masked ? ", masked" : "", worst);
    }
  }
  vtkNew<vtkImageData> wrong;
  wrong->SetDimensions(3, 3, 3);
  wrong->AllocateScalars(VTK_FLOAT, 1);
  scene.Many->GetSettings()->SetMaskInput(wrong);
  scene.Many->Modified();
  scene.Render();
  CHECK(std::string(scene.Many->GetLastError()).find("MaskInput") != std::string::npos, "a mask of floats: %s", scene.Many->GetLastError());
}

void LeftOutAndRefused()
{
  Blocks scene;
  auto* inner = vtkMultiBlockDataSet::SafeDownCast(scene.Data->GetBlock(2));
  vtkNew<vtkSphereSource> sphere;
  sphere->Update();
  inner->SetBlock(7, sphere->GetOutput());
  scene.Volume->SetMapper(scene.Many);
  scene.Many->SetScalarModeToUsePointFieldData();
  scene.Many->SelectScalarArray("density");
  scene.Render();
  CHECK(scene.Many->GetNumberOfBlocks() == 5 && scene.Warnings->Text.find("vtkPolyData") != std::string::npos, "no word of the sphere: %s",
    scene.Warnings->Text.c_str());
  inner->SetBlock(7, nullptr);
  vtkImageData::SafeDownCast(inner->GetBlock(0))->GetPointData()->GetArray("density")->SetName("other");
  scene.Data->Modified();
  scene.Many->Modified();
  scene.Render();
  CHECK(scene.Many->GetNumberOfBlocks() == 4 && scene.Warnings->Text.find("density") != std::string::npos, "no word of the array: %s",
    scene.Warnings->Text.c_str());
  vtkImageData::SafeDownCast(inner->GetBlock(0))->GetPointData()->GetArray("other")->SetName("density");
  scene.Many->SetBlendModeToMaximumIntensity();
  scene.Many->SetInputDataObject(scene.Image);
  scene.Render();
  CHECK(scene.Many->GetNumberOfBlocks() == 1 && !scene.Many->GetLastError()[0], "one image is refused: %s", scene.Many->GetLastError());
}

void Overlapping()
{
  Blocks scene;
  vtkNew<vtkPartitionedDataSet> data;
  data->SetPartition(0, Part(scene.Image, Extents[0]));
  const int over[6] = { 4, 30, 2, 20, 0, 24 };
  data->SetPartition(1, Part(scene.Image, over));
  scene.Many->SetInputDataObject(data);
  scene.Volume->SetMapper(scene.Many);
  scene.Volume->GetProperty()->GetIsoSurfaceValues()->SetValue(0, 0.5);
  scene.Many->SetBlendMode(vtkVolumeMapper::ISOSURFACE_BLEND);
  scene.Render();
  CHECK(scene.Warnings->Count == 0 && !scene.Many->GetLastError()[0], "surfaces that are joined by depth: %s, %s",
    scene.Warnings->Text.c_str(), scene.Many->GetLastError());
  scene.Many->SetBlendModeToComposite();
  scene.Render();
  CHECK(scene.Warnings->Text.find("overlap") != std::string::npos, "no word of the overlap: %s", scene.Warnings->Text.c_str());
}
} // namespace

int main()
{
  AsTheWhole();
  Opaque();
  InOtherModes();
  LeftOutAndRefused();
  Overlapping();
  std::printf("%d failures\n", Failures);
  return Failures != 0;
}
