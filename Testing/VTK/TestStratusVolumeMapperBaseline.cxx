// SPDX-License-Identifier: BSD-3-Clause
// Compares the window with the pictures in Baseline by VTK's own image comparison. It ignores differences below 16 of 255, so the gate is
// TestStratusVolumeMapper, which compares floats. This test covers the parts that no reference knows: the geometry around the volume and
// the window itself. Argument: a folder for pictures that fail.
#include "mapper_testing.h"

#include "vtkActor.h"
#include "vtkConeSource.h"
#include "vtkImageDifference.h"
#include "vtkPNGReader.h"
#include "vtkPNGWriter.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkWindowToImageFilter.h"
#include "vtkXMLImageDataReader.h"

#include <fstream>

namespace {
std::string OutputFolder;

void Compare(Scene& scene, const std::string& name)
{
  scene.Render();
  CHECK(scene.Errors->Count == 0, "%s: %s", name.c_str(), scene.Errors->Text.c_str());
  vtkNew<vtkWindowToImageFilter> shown;
  shown->SetInput(scene.Window);
  shown->ReadFrontBufferOff();
  shown->Update();
  const std::string baseline = "Testing/VTK/Baseline/" + name + ".png";
  double error = 1e9;
  if (std::ifstream(baseline).good()) {
    vtkNew<vtkPNGReader> reader;
    reader->SetFileName(baseline.c_str());
    vtkNew<vtkImageDifference> difference;
    difference->SetInputConnection(shown->GetOutputPort());
    difference->SetImageConnection(reader->GetOutputPort());
    difference->Update();
    error = difference->GetThresholdedError();
  }
  std::printf("%s: %g\n", name.c_str(), error);
  // vtkTesting's own limit is 10.
  CHECK(error <= 10.0, "%s differs from %s by %g", name.c_str(), baseline.c_str(), error);
  if (error > 10.0) {
    vtkNew<vtkPNGWriter> writer;
    writer->SetFileName((OutputFolder + "/" + name + ".png").c_str());
    writer->SetInputConnection(shown->GetOutputPort());
    writer->Write();
  }
}

// A cone through both blobs, over a gradient, in a viewport that leaves a border.
void Opaque()
{
  Scene scene(256, 256);
  vtkNew<vtkConeSource> cone;
  cone->SetCenter(14, 14, 13);
  cone->SetDirection(1, 0.6, 0.4);
  cone->SetHeight(26);
  cone->SetRadius(4);
  cone->SetResolution(40);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(cone->GetOutputPort());
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.3, 0.9, 0.5);
  scene.Renderer->AddActor(actor);
  scene.Renderer->GradientBackgroundOn();
  scene.Renderer->SetBackground(0.1, 0.1, 0.2);
  scene.Renderer->SetBackground2(0.4, 0.5, 0.7);
  scene.Renderer->SetViewport(0.05, 0.1, 0.95, 1.0);
  scene.Look(30, 25);
  scene.Renderer->GetActiveCamera()->Zoom(1.5);
  Compare(scene, "TestStratusVolumeMapperOpaque");
}

// Voxels as they are, cropped, in a parallel view.
void Nearest()
{
  Scene scene(256, 256);
  scene.Volume->GetProperty()->SetInterpolationTypeToNearest();
  scene.Opacity->AddPoint(0.3, 0.8);
  scene.Mapper->CroppingOn();
  scene.Mapper->SetCroppingRegionPlanes(0, 30, 0, 20, 6, 13);
  scene.Renderer->GetActiveCamera()->ParallelProjectionOn();
  scene.Look(30, 25);
  scene.Renderer->GetActiveCamera()->Zoom(1.4);
  Compare(scene, "TestStratusVolumeMapperNearest");
}

// The hurricane, from a file in double.
bool Hurricane()
{
  const char* const path = "../shared/data/isabel_02.vti";
  if (!std::ifstream(path).good()) {
    std::printf("SKIPPED: %s is not there\n", path);
    return false;
  }
  Scene scene(256, 256);
  vtkNew<vtkXMLImageDataReader> reader;
  reader->SetFileName(path);
  scene.Mapper->SetInputConnection(reader->GetOutputPort());
  scene.Opacity->RemoveAllPoints();
  scene.Opacity->AddPoint(20.5, 0.0);
  scene.Opacity->AddPoint(68.2455, 0.6);
  scene.Color->RemoveAllPoints();
  scene.Color->AddRGBPoint(0, 0.1, 0.2, 0.8);
  scene.Color->AddRGBPoint(34.1, 0.9, 0.9, 0.3);
  scene.Color->AddRGBPoint(68.2455, 0.9, 0.1, 0.1);
  scene.Volume->GetProperty()->SetScalarOpacityUnitDistance(4.0);
  reader->Update();
  scene.Look(0, -50);
  Compare(scene, "TestStratusVolumeMapperHurricane");
  return true;
}
} // namespace

int main(int argc, char** argv)
{
  OutputFolder = argc > 1 ? argv[1] : ".";
  Opaque();
  Nearest();
  const bool whole = Hurricane();
  return Failures != 0 ? 1 : whole ? 0 : 77;
}
