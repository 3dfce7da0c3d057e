// SPDX-License-Identifier: BSD-3-Clause
// First hits in the window: light and depth as the scene has them, the same bits by every structure, the tree that an image carries used
// where it serves, and the cloud of record against its picture in Baseline. Argument: where to leave pictures that fail.
#include "mapper_testing.h"
#include "vtkStratusHybridTreeFilter.h"

#include "vtkActor.h"
#include "vtkFieldData.h"
#include "vtkImageDifference.h"
#include "vtkLight.h"
#include "vtkPNGReader.h"
#include "vtkPNGWriter.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkSphereSource.h"
#include "vtkWindowToImageFilter.h"

#include <fstream>

namespace {
std::string OutputFolder;

void FirstHits(Scene& scene)
{
  scene.Mapper->SetRenderModeToFirstHit();
  scene.Volume->GetProperty()->ShadeOn();
  scene.Renderer->ResetCamera();
}

// Compares a hit's depth in the depth buffer with its depth in the float picture.
void DepthIsInTheWindow()
{
  for (bool parallel : { false, true }) {
    Scene scene;
    FirstHits(scene);
    scene.Renderer->GetActiveCamera()->SetParallelProjection(parallel);
    scene.Renderer->SetBackground(0.2, 0.3, 0.4);
    scene.Render();
    CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
    const int* size = scene.Renderer->GetSize();
    std::vector<float> z(scene.Pixels());
    scene.Window->GetZbufferData(0, 0, size[0] - 1, size[1] - 1, z.data());
    const stratus_camera camera = ReferenceCamera(scene.Renderer);
    const float* depth = scene.Depth();
    int hits = 0;
    double worst = 0.0;
    for (int p = 0; p < size[0] * size[1]; ++p) {
      const double u = (2.0 * (p % size[0]) + 1) / size[0] - 1, v = (2.0 * (p / size[0]) + 1) / size[1] - 1;
      double square = 0.0;
      for (int a = 0; a < 3; ++a) {
        const double along = camera.forward[a] + (parallel ? 0.0 : u * camera.right[a] + v * camera.up[a]);
        square += along * along;
      }
      const double k = z[p] < 1.0f ? (parallel ? camera.near_k + z[p] * (camera.far_k - camera.near_k)
                                               : camera.near_k * camera.far_k / (camera.far_k - z[p] * (camera.far_k - camera.near_k)))
                                   : 0.0;
      CHECK((z[p] < 1.0f) == std::isfinite(depth[p]), "pixel %d: depth %g, in the window %g", p, depth[p], z[p]);
      if (z[p] < 1.0f) {
        ++hits;
        worst = std::max(worst, std::fabs(k * std::sqrt(square) - depth[p]) / depth[p]);
      }
    }
    // 24 bits of a depth buffer whose near plane is about a third of the way to the far one
    CHECK(hits > 1000 && worst < 1e-5, "%d hits, depths differ by %g", hits, worst);
    CHECK(scene.ShownError(scene.Renderer->GetBackground()) < 1.0, "shown with an error of %g",
      scene.ShownError(scene.Renderer->GetBackground()));
  }
}

// A ball half inside hides the volume behind it, and the volume in front hides the ball: drawn before the volume or, in a layer above,
// after.
void GeometryIsHiddenAndHides()
{
  std::vector<unsigned char> before, after;
  for (bool later : { false, true }) {
    Scene scene;
    FirstHits(scene);
    vtkNew<vtkSphereSource> ball;
    ball->SetCenter(13, 13, 16);
    ball->SetRadius(6);
    ball->SetThetaResolution(40);
    ball->SetPhiResolution(40);
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(ball->GetOutputPort());
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->SetColor(0, 1, 0);
    actor->GetProperty()->LightingOff();
    vtkNew<vtkRenderer> layer;
    if (later) {
      layer->SetActiveCamera(scene.Renderer->GetActiveCamera());
      layer->SetLayer(1);
      layer->SetPreserveDepthBuffer(1);
      layer->AddActor(actor);
      scene.Window->SetNumberOfLayers(2);
      scene.Window->AddRenderer(layer);
    } else {
      scene.Renderer->AddActor(actor);
    }
    scene.Render();
    CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
    (later ? after : before) = scene.Bytes();
  }
  size_t ball = 0, solid = 0, differing = 0;
  for (size_t p = 0; p < before.size() && p < after.size(); p += 4) {
    const bool green = before[p] == 0 && before[p + 1] == 255 && before[p + 2] == 0;
    ball += green;
    solid += !green && before[p] + before[p + 1] + before[p + 2] > 0;
    differing +=
      std::max({ std::abs(before[p] - after[p]), std::abs(before[p + 1] - after[p + 1]), std::abs(before[p + 2] - after[p + 2]) }) > 1;
  }
  CHECK(ball > 100 && solid > 500, "%zu pixels of the ball, %zu of the volume", ball, solid);
  // along the line where both meet, 24 bits decide
  CHECK(differing <= 30, "%zu pixels differ where geometry comes later", differing);
}

void EveryStructureShowsTheSame()
{
  Scene scene;
  FirstHits(scene);
  std::vector<float> first;
  for (int structure = vtkStratusVolumeMapper::NO_STRUCTURE; structure <= vtkStratusVolumeMapper::HYBRID_STRUCTURE; ++structure) {
    scene.Mapper->SetStructure(structure);
    const std::vector<float> picture = scene.Picture();
    CHECK(std::string(scene.Mapper->GetStructureUsedAsString()) == scene.Mapper->GetStructureAsString(), "structure %s used",
      scene.Mapper->GetStructureUsedAsString());
    CHECK(first.empty() || picture == first, "%s draws another picture", scene.Mapper->GetStructureAsString());
    first = picture;
  }
  CHECK(scene.Light() > 1000.0, "the picture is all but empty");
  scene.Mapper->AuditOn();
  scene.Render();
  CHECK(scene.Mapper->GetDifferingPixels() == 0, "the audit found %llu pixels",
    static_cast<unsigned long long>(scene.Mapper->GetDifferingPixels()));
}

// The red of a white volume's faces in the light that is given.
void LightIsTheScenes()
{
  Scene scene;
  FirstHits(scene);
  scene.Color->RemoveAllPoints();
  scene.Color->AddRGBPoint(0, 1, 1, 1);
  vtkVolumeProperty* property = scene.Volume->GetProperty();
  property->SetAmbient(0.0);
  property->SetDiffuse(1.0);
  property->SetSpecular(0.0);
  scene.Renderer->AutomaticLightCreationOff();
  vtkNew<vtkLight> light;
  light->SetLightTypeToSceneLight();
  light->SetPosition(0, 0, 100);
  light->SetFocalPoint(0, 0, 0);
  light->SetDiffuseColor(1, 0.5, 0);
  light->SetIntensity(0.8);
  scene.Renderer->AddLight(light);
  scene.Look(0, 0); // along -z: all that is seen faces the light, but for grazed sides
  scene.Renderer->GetActiveCamera()->ParallelProjectionOn();
  const std::vector<float> picture = scene.Picture();
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
  int lit = 0;
  for (size_t p = 0; p < scene.Pixels(); ++p) {
    const float* rgba = &picture[4 * p];
    CHECK(rgba[3] == 0.0f || (std::fabs(rgba[0] - 0.8f) < 1e-6f && std::fabs(rgba[1] - 0.4f) < 1e-6f && rgba[2] == 0.0f),
      "a face shows %g %g %g", rgba[0], rgba[1], rgba[2]);
    lit += rgba[3] > 0.0f;
  }
  CHECK(lit > 500, "%d pixels lit", lit);
  light->SetPosition(100, 0, 0); // from the side: faces are dark, the field's slopes are not
  CHECK(scene.Light() == static_cast<double>(lit), "a face is lit from the side");
  scene.Mapper->SetNormalsToGradient();
  CHECK(scene.Light() > lit + 10.0, "no slope is lit from the side");
  light->SetSwitch(0);
  CHECK(scene.Light() == static_cast<double>(lit), "a light that is off lights");
  property->ShadeOff();
  CHECK(scene.Light() == 4.0 * lit, "unshaded voxels don't have their own colour");
  property->ShadeOn();
  light->SwitchOn();
  light->PositionalOn();
  light->SetConeAngle(90);
  CHECK(scene.Light() > lit + 10.0, "a positional light lights nothing");
}

void BoundsReachHalfAVoxelFarther()
{
  Scene scene;
  double plain[6], wide[6];
  scene.Volume->GetBounds(plain);
  scene.Mapper->SetRenderModeToFirstHit();
  scene.Volume->Modified();
  scene.Volume->GetBounds(wide);
  const double half[3] = { 0.45, 0.5, 0.55 };
  for (int a = 0; a < 3; ++a) {
    CHECK(std::fabs(plain[2 * a] - half[a] - wide[2 * a]) < 1e-12 && std::fabs(plain[2 * a + 1] + half[a] - wide[2 * a + 1]) < 1e-12,
      "axis %d: %g..%g became %g..%g", a, plain[2 * a], plain[2 * a + 1], wide[2 * a], wide[2 * a + 1]);
  }
}

// ---- the tree that an image carries

void ExpectCarried(const char* what, vtkImageData* image, bool used)
{
  Scene own, carried;
  vtkNew<vtkImageData> plain;
  plain->ShallowCopy(image);
  plain->GetFieldData()->Initialize();
  own.Mapper->SetInputData(plain);
  carried.Mapper->SetInputData(image);
  FirstHits(own);
  FirstHits(carried);
  vtkNew<ErrorObserver> warnings;
  carried.Mapper->AddObserver(vtkCommand::WarningEvent, warnings);
  CHECK(carried.Picture() == own.Picture(), "%s: another picture", what);
  CHECK(own.Light() > 100.0, "%s: the picture is all but empty", what);
  CHECK(carried.Errors->Count == 0, "%s: %s", what, carried.Errors->Text.c_str());
  CHECK(carried.Mapper->GetCarriedTreeUsed() == used, "%s: the tree is %sused", what, used ? "not " : "");
  CHECK(carried.Mapper->GetStructureBuilds() == (used ? 0u : 1u), "%s: %llu trees built", what,
    static_cast<unsigned long long>(carried.Mapper->GetStructureBuilds()));
  CHECK(own.Mapper->GetStructureBuilds() == 1 && !own.Mapper->GetCarriedTreeUsed(), "%s: a tree from nowhere", what);
  carried.Renderer->GetActiveCamera()->Azimuth(20);
  carried.Render();
  CHECK(carried.Mapper->GetStructureBuilds() == (used ? 0u : 1u), "%s: a camera built a tree", what);
}

vtkSmartPointer<vtkImageData> WithTree(vtkImageData* image, vtkVolumeProperty* property, int purpose)
{
  vtkNew<vtkStratusHybridTreeFilter> filter;
  filter->SetInputData(image);
  filter->SetVolumeProperty(property);
  filter->SetPurpose(purpose);
  filter->Update();
  vtkSmartPointer<vtkImageData> result = vtkSmartPointer<vtkImageData>::New();
  result->DeepCopy(filter->GetOutput());
  return result;
}

void CarriedTrees()
{
  using Filter = vtkStratusHybridTreeFilter;
  Scene scene;
  vtkVolumeProperty* property = scene.Volume->GetProperty();
  const auto fresh = [&] { return WithTree(scene.Image, property, Filter::FIRST_HITS); };
  const auto bytes = [](vtkImageData* image) {
    return vtkUnsignedCharArray::SafeDownCast(image->GetFieldData()->GetAbstractArray("StratusHybridTree"));
  };
  ExpectCarried("fresh", fresh(), true);
  vtkSmartPointer<vtkImageData> moved = fresh();
  moved->SetOrigin(100, 200, 300);
  moved->SetSpacing(1, 2, 1);
  ExpectCarried("moved", moved, true);
  ExpectCarried("of cells", WithTree(scene.Image, property, Filter::RAY_CASTING), false);
  ExpectCarried("of all voxels", WithTree(scene.Image, nullptr, Filter::FIRST_HITS), false);
  vtkSmartPointer<vtkImageData> stale = fresh();
  vtkFloatArray::SafeDownCast(stale->GetPointData()->GetScalars())->SetValue(5000, 0.9f);
  ExpectCarried("stale", stale, false);
  vtkSmartPointer<vtkImageData> foreign = fresh();
  vtkNew<vtkImageData> other;
  other->SetDimensions(20, 20, 20);
  FillField(other, false, "density");
  foreign->GetFieldData()->AddArray(bytes(WithTree(other, property, Filter::FIRST_HITS)));
  ExpectCarried("foreign", foreign, false);
  vtkSmartPointer<vtkImageData> truncated = fresh();
  bytes(truncated)->Resize(bytes(truncated)->GetNumberOfTuples() / 2);
  ExpectCarried("truncated", truncated, false);
  vtkSmartPointer<vtkImageData> tampered = fresh();
  const vtkIdType last = bytes(tampered)->GetNumberOfValues() - 20;
  bytes(tampered)->SetValue(last, static_cast<unsigned char>(bytes(tampered)->GetValue(last) ^ 1));
  ExpectCarried("tampered", tampered, false);
  vtkSmartPointer<vtkImageData> floats = fresh();
  vtkNew<vtkFloatArray> numbers;
  numbers->DeepCopy(bytes(floats));
  floats->GetFieldData()->AddArray(numbers);
  ExpectCarried("in floats", floats, false);
  Scene shown;
  vtkNew<ErrorObserver> warnings;
  shown.Mapper->AddObserver(vtkCommand::WarningEvent, warnings);
  shown.Mapper->SetInputData(floats);
  FirstHits(shown);
  shown.Render();
  CHECK(warnings->Count == 1 && warnings->Has("'StratusHybridTree' is of type float"), "%d warnings: %s", warnings->Count,
    warnings->Text.c_str());
}

// ---- the cloud of record

void Cloud()
{
  Scene scene(480, 300);
  stratus_context* context = nullptr;
  stratus_scene* cloud = nullptr;
  if (stratus_context_create(nullptr, &context, nullptr, 0) != STRATUS_OK || stratus_scene_create(context, "cloud", &cloud) != STRATUS_OK) {
    CHECK(false, "there is no cloud");
    return;
  }
  const stratus_volume& volume = cloud->volume;
  CHECK(volume.type == STRATUS_UINT8 || volume.type == STRATUS_FLOAT32, "the cloud is of type %d", static_cast<int>(volume.type));
  scene.Image->SetDimensions(
    static_cast<int>(volume.dimensions[0]), static_cast<int>(volume.dimensions[1]), static_cast<int>(volume.dimensions[2]));
  scene.Image->SetSpacing(volume.spacing);
  scene.Image->AllocateScalars(volume.type == STRATUS_UINT8 ? VTK_UNSIGNED_CHAR : VTK_FLOAT, 1);
  std::copy_n(static_cast<const unsigned char*>(volume.values),
    static_cast<size_t>(scene.Image->GetNumberOfPoints()) * stratus_type_size(volume.type),
    static_cast<unsigned char*>(scene.Image->GetScalarPointer()));
  scene.Opacity->RemoveAllPoints();
  for (size_t i = 0; i < cloud->transfer.opacity_count; ++i) {
    scene.Opacity->AddPoint(cloud->transfer.opacity[2 * i], cloud->transfer.opacity[2 * i + 1]);
  }
  scene.Color->RemoveAllPoints(); // by the height of the values: the visible borders of the cloud have almost equal values
  const double low = cloud->transfer.color[0], high = cloud->transfer.color[4 * (cloud->transfer.color_count - 1)];
  scene.Color->AddRGBPoint(low, 0.95, 0.97, 1.0);
  scene.Color->AddRGBPoint(low + 0.2 * (high - low), 1.0, 0.75, 0.45);
  stratus_scene_destroy(context, cloud);
  stratus_context_destroy(context);
  FirstHits(scene);
  scene.Volume->GetProperty()->SetAmbient(0.15);
  scene.Volume->GetProperty()->SetDiffuse(0.7);
  scene.Renderer->GradientBackgroundOn();
  scene.Renderer->SetBackground(0.1, 0.12, 0.2);
  scene.Renderer->SetBackground2(0.4, 0.5, 0.65);
  vtkNew<vtkLight> sun;
  sun->SetLightTypeToSceneLight();
  sun->SetPosition(-0.2, 1.2, 0.6);
  sun->SetFocalPoint(0, 0, 0);
  scene.Renderer->AddLight(sun);
  vtkNew<vtkLight> eye;
  eye->SetLightTypeToHeadlight();
  eye->SetIntensity(0.3);
  scene.Renderer->AddLight(eye);
  scene.Look(30, 25);
  scene.Renderer->GetActiveCamera()->Zoom(4.0); // the middle: a voxel is some pixels wide
  scene.Render();
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
  vtkNew<vtkWindowToImageFilter> shown;
  shown->SetInput(scene.Window);
  shown->ReadFrontBufferOff();
  shown->Update();
  const std::string baseline = "Testing/VTK/Baseline/TestStratusVolumeMapperFirstHit.png";
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
  CHECK(error <= 10.0, "the cloud differs from %s by %g", baseline.c_str(), error); // vtkTesting's own limit
  if (error > 10.0) {
    vtkNew<vtkPNGWriter> writer;
    writer->SetFileName((OutputFolder + "/TestStratusVolumeMapperFirstHit.png").c_str());
    writer->SetInputConnection(shown->GetOutputPort());
    writer->Write();
  }
}
} // namespace

int main(int argc, char** argv)
{
  OutputFolder = argc > 1 ? argv[1] : ".";
  DepthIsInTheWindow();
  GeometryIsHiddenAndHides();
  EveryStructureShowsTheSame();
  LightIsTheScenes();
  BoundsReachHalfAVoxelFarther();
  CarriedTrees();
  Cloud();
  return Failures == 0 ? 0 : 1;
}
