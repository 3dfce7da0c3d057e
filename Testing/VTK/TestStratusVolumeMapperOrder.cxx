// SPDX-License-Identifier: BSD-3-Clause
// Several volumes with mappers of their own in one renderer: the picture depends on their places only, not on the order in which they were
// added, and equals vtkStratusMultiVolume's. Volumes that can't be mixed, and volumes of VTK's mappers, raise one warning.
#include "mapper_testing.h"

#include "vtkStratusMultiBlockVolumeMapper.h"
#include "vtkStratusMultiVolume.h"
#include "vtkStratusTetrahedraMapper.h"

#include "vtkActor.h"
#include "vtkAssembly.h"
#include "vtkContourValues.h"
#include "vtkDataSetTriangleFilter.h"
#include "vtkFixedPointVolumeRayCastMapper.h"
#include "vtkHardwareSelector.h"
#include "vtkInformation.h"
#include "vtkLODProp3D.h"
#include "vtkPlane.h"
#include "vtkPlaneSource.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkSelection.h"
#include "vtkSelectionNode.h"
#include "vtkUnstructuredGrid.h"
#include "vtkWeakPointer.h"

#include <numeric>

namespace {
// A cube of 5 points a side about the origin, of side 2 and of any colour. Its values are even, or grow along x.
struct Cube {
  explicit Cube(double red, double green, double blue, bool even = true)
  {
    this->Image->SetDimensions(5, 5, 5);
    this->Image->SetSpacing(0.5, 0.5, 0.5);
    this->Image->SetOrigin(-1, -1, -1);
    vtkNew<vtkFloatArray> values;
    values->SetName("density");
    for (int i = 0; i < 5 * 5 * 5; ++i) {
      values->InsertNextValue(even ? 1.0f : 0.25f * static_cast<float>(i % 5));
    }
    this->Image->GetPointData()->SetScalars(values);
    vtkNew<vtkPiecewiseFunction> opacity;
    vtkNew<vtkColorTransferFunction> color;
    opacity->AddPoint(0.0, 0.0);
    opacity->AddPoint(1.0, 0.6);
    color->AddRGBPoint(0.0, red, green, blue);
    this->Volume->GetProperty()->SetScalarOpacity(opacity);
    this->Volume->GetProperty()->SetColor(color);
    this->Volume->GetProperty()->SetInterpolationTypeToLinear();
    this->Mapper->SetInputData(this->Image);
    this->Mapper->SetDevice("host");
    this->Volume->SetMapper(this->Mapper);
  }

  // The same cube cut into tetrahedra, drawn by their mapper.
  void Triangulate()
  {
    vtkNew<vtkDataSetTriangleFilter> cut;
    cut->SetInputData(this->Image);
    cut->Update();
    this->Meshes->SetInputData(cut->GetOutput());
    this->Meshes->SetDevice("host");
    this->Volume->SetMapper(this->Meshes);
  }

  void Clip(double x, double y, double z)
  {
    vtkNew<vtkPlane> plane;
    plane->SetNormal(x, y, z);
    this->Volume->GetMapper()->AddClippingPlane(plane);
  }

  vtkNew<vtkImageData> Image;
  vtkNew<vtkStratusVolumeMapper> Mapper;
  vtkNew<vtkStratusTetrahedraMapper> Meshes;
  vtkNew<vtkVolume> Volume;
};

using Bytes = std::vector<unsigned char>;

// A window whose renderer is given props in any order. Warnings and errors of mappers that are watched are counted.
struct Stage {
  explicit Stage(int width = 60, int height = 50)
  {
    this->Window->SetMultiSamples(0);
    this->Window->SetSize(width, height);
    this->Window->AddRenderer(this->Renderer);
  }

  void Watch(vtkObject* mapper)
  {
    mapper->AddObserver(vtkCommand::WarningEvent, this->Warnings);
    mapper->AddObserver(vtkCommand::ErrorEvent, this->Errors);
  }

  void Look(double azimuth, double elevation, bool parallel = false)
  {
    vtkCamera* camera = this->Renderer->GetActiveCamera();
    camera->SetParallelProjection(parallel);
    camera->SetParallelScale(3.5);
    camera->SetPosition(0, 0, 14);
    camera->SetFocalPoint(0, 0, 0);
    camera->SetViewUp(0, 1, 0);
    camera->Azimuth(azimuth);
    camera->Elevation(elevation);
    camera->SetClippingRange(4, 30);
  }

  Bytes Draw(const std::vector<vtkProp*>& props)
  {
    this->Renderer->RemoveAllViewProps();
    for (vtkProp* prop : props) {
      this->Renderer->AddViewProp(prop);
    }
    this->Window->Render();
    vtkNew<vtkUnsignedCharArray> pixels;
    const int* size = this->Window->GetSize();
    this->Window->GetRGBACharPixelData(0, 0, size[0] - 1, size[1] - 1, 0, pixels);
    return Bytes(pixels->GetPointer(0), pixels->GetPointer(0) + pixels->GetNumberOfValues());
  }

  // The picture of these volumes by vtkStratusMultiVolume, and other props.
  Bytes DrawMixed(const std::vector<vtkVolume*>& volumes, const std::vector<vtkProp*>& others = {})
  {
    vtkNew<vtkStratusMultiVolume> multi;
    for (size_t n = 0; n < volumes.size(); ++n) {
      multi->SetVolume(volumes[n], static_cast<int>(n));
    }
    std::vector<vtkProp*> props = others;
    props.push_back(multi);
    const Bytes picture = this->Draw(props);
    CHECK(std::string(multi->GetLastError()).empty(), "%s", multi->GetLastError());
    this->Renderer->RemoveAllViewProps();
    multi->ReleaseGraphicsResources(this->Window);
    return picture;
  }

  // Draws the volumes in all orders, each after `others`. Returns the first picture, of which all others must have the bits.
  Bytes DrawInAllOrders(const char* what, const std::vector<vtkVolume*>& volumes, const std::vector<vtkProp*>& others = {})
  {
    std::vector<size_t> order(volumes.size());
    std::iota(order.begin(), order.end(), 0);
    Bytes first;
    do {
      std::vector<vtkProp*> props = others;
      for (size_t n : order) {
        props.push_back(volumes[n]);
      }
      const Bytes picture = this->Draw(props);
      first = first.empty() ? picture : first;
      CHECK(picture == first, "%s: volumes in another order: the picture differs by %d of 255", what, Worst(picture, first));
    } while (std::next_permutation(order.begin(), order.end()));
    CHECK(std::count_if(first.begin(), first.end(), [](unsigned char c) { return c > 20 && c < 255; }) > 200, "%s: little is shown", what);
    return first;
  }

  static int Worst(const Bytes& a, const Bytes& b)
  {
    int worst = a.size() == b.size() ? 0 : 255;
    for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
      worst = std::max(worst, std::abs(a[i] - b[i]));
    }
    return worst;
  }

  // The root mean square difference over the values that show something.
  static double Rms(const Bytes& a, const Bytes& b)
  {
    double sum = 0.0, shown = 0.0;
    for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
      sum += (a[i] - b[i]) * (a[i] - b[i]);
      shown += a[i] > 0 || b[i] > 0;
    }
    return std::sqrt(sum / std::max(shown, 1.0));
  }

  vtkNew<vtkRenderer> Renderer;
  vtkNew<vtkRenderWindow> Window;
  vtkNew<ErrorObserver> Warnings, Errors;
};

// Root mean square difference, of 255, between volumes that are drawn one by one and the same volumes in one pass. Each picture may err by
// ImageErrorTolerance, .255, and the first is rounded to bytes once a volume.
constexpr double OneByOne = 1.0;

void Apart()
{
  Cube red(1, 0.1, 0.1), blue(0.1, 0.1, 1), green(0.1, 1, 0.1, false);
  red.Volume->SetPosition(-1.2, 0, 0);
  blue.Volume->SetPosition(1.2, 0.3, 0);
  green.Volume->SetPosition(0.2, 0.1, 2.1);
  green.Volume->RotateY(30);
  Stage stage;
  stage.Watch(red.Mapper), stage.Watch(blue.Mapper), stage.Watch(green.Mapper);
  for (const double azimuth : { 80.0, -75.0, 0.0, 40.0 }) {
    for (const bool parallel : { false, true }) {
      stage.Look(azimuth, 0.2 * azimuth, parallel);
      const Bytes two = stage.DrawInAllOrders("two", { red.Volume, blue.Volume });
      double off = Stage::Rms(two, stage.DrawMixed({ red.Volume, blue.Volume }));
      CHECK(off <= OneByOne, "two at %g: %g of 255 from the mixed picture", azimuth, off);
      const Bytes three = stage.DrawInAllOrders("three", { red.Volume, blue.Volume, green.Volume });
      off = Stage::Rms(three, stage.DrawMixed({ red.Volume, blue.Volume, green.Volume }));
      CHECK(off <= OneByOne, "three at %g: %g of 255 from the mixed picture", azimuth, off);
    }
  }
  CHECK(stage.Warnings->Count == 0 && stage.Errors->Count == 0, "%s %s", stage.Warnings->Text.c_str(), stage.Errors->Text.c_str());
}

// Volumes of one place that clipping planes or cropping planes separate, and the image's own directions.
void Cut()
{
  Stage stage;
  for (const double azimuth : { 60.0, -60.0 }) {
    stage.Look(azimuth, 15);
    Cube left(1, 0.1, 0.1), right(0.1, 0.1, 1);
    left.Clip(-1, 0, 0);
    right.Clip(1, 0, 0);
    left.Mapper->SetSampleDistance(0.05); // a step across the common plane has both colours mixed in one picture
    right.Mapper->SetSampleDistance(0.05);
    const Bytes clipped = stage.DrawInAllOrders("clipped", { left.Volume, right.Volume });
    const double off = Stage::Rms(clipped, stage.DrawMixed({ left.Volume, right.Volume }));
    CHECK(off <= OneByOne, "clipped at %g: %g of 255 from the mixed picture", azimuth, off);
    left.Volume->GetMapper()->RemoveAllClippingPlanes();
    right.Volume->GetMapper()->RemoveAllClippingPlanes();
    for (Cube* cube : { &left, &right }) {
      cube->Mapper->CroppingOn();
      cube->Mapper->SetCroppingRegionPlanes(cube == &left ? -1 : 0, cube == &left ? 0 : 1, -1, 1, -1, 1);
    }
    CHECK(stage.DrawInAllOrders("cropped", { left.Volume, right.Volume }) != stage.Draw({ left.Volume }), "one volume is not shown");
    CHECK(std::string(left.Mapper->GetReason()) != "" && left.Mapper->GetLastImage(), "cropped volumes are drawn by their own mappers");
    // Of 27 regions, those beyond one plane.
    left.Mapper->SetCroppingRegionPlanes(0, 5, -5, 5, -5, 5);
    left.Mapper->SetCroppingRegionFlags(1 << 12);
    stage.DrawInAllOrders("regions", { left.Volume, right.Volume });
    CHECK(left.Mapper->GetLastImage() != nullptr, "volumes in regions that do not meet are mixed");
    // Two turned images whose boxes are apart, though the boxes' bounds overlap.
    left.Mapper->CroppingOff();
    right.Mapper->CroppingOff();
    const double half = std::sqrt(0.5);
    for (Cube* cube : { &left, &right }) {
      cube->Image->SetDirectionMatrix(half, -half, 0, half, half, 0, 0, 0, 1);
      cube->Image->SetOrigin(cube == &left ? -1.6 : 0, cube == &left ? -1 : 0.65, -1);
    }
    stage.DrawInAllOrders("turned", { left.Volume, right.Volume });
    CHECK(left.Mapper->GetLastImage() != nullptr, "turned images that do not meet are mixed");
  }
}

void Overlapping()
{
  Cube red(1, 0.1, 0.1, false), blue(0.1, 0.1, 1), green(0.1, 1, 0.1);
  blue.Volume->SetPosition(0.8, 0.4, 0.3);
  green.Volume->SetPosition(0.2, 0.1, 1.0);
  green.Volume->RotateY(30);
  Stage stage;
  stage.Watch(red.Mapper), stage.Watch(blue.Mapper), stage.Watch(green.Mapper);
  for (const bool light : { false, true }) { // over black, and where the frame buffer is blended with
    stage.Renderer->SetBackground(light ? 0.4 : 0.0, light ? 0.6 : 0.0, 0.0);
    for (const double azimuth : { 70.0, -100.0 }) {
      stage.Look(azimuth, 10);
      const Bytes two = stage.DrawInAllOrders("two overlap", { red.Volume, blue.Volume });
      CHECK(Stage::Worst(two, stage.DrawMixed({ red.Volume, blue.Volume })) == 0, "two at %g", azimuth);
      const Bytes three = stage.DrawInAllOrders("three overlap", { red.Volume, blue.Volume, green.Volume });
      const int worst = Stage::Worst(three, stage.DrawMixed({ red.Volume, blue.Volume, green.Volume }));
      CHECK(worst <= 1, "three at %g: %d", azimuth, worst); // ports are in another order
    }
  }
  CHECK(!red.Mapper->GetLastImage() && red.Mapper->GetSamplesTaken() > 0, "reports of a volume that is mixed");
  // A vtkStratusMultiVolume among them.
  vtkNew<vtkStratusMultiVolume> multi;
  multi->SetVolume(red.Volume, 3);
  multi->SetVolume(blue.Volume, 1);
  const Bytes with = stage.DrawInAllOrders("with several", { multi, green.Volume });
  CHECK(Stage::Worst(with, stage.DrawMixed({ red.Volume, blue.Volume, green.Volume })) <= 1, "a vtkStratusMultiVolume overlaps a volume");
  CHECK(stage.Warnings->Count == 0 && stage.Errors->Count == 0, "%s %s", stage.Warnings->Text.c_str(), stage.Errors->Text.c_str());
  // The volume by itself is drawn as ever after it was mixed.
  const Bytes alone = stage.Draw({ red.Volume });
  Cube fresh(1, 0.1, 0.1, false);
  CHECK(alone == stage.Draw({ fresh.Volume }), "a volume that was mixed before");
}

// Three bars, each before the next one, in a ring.
void Ring()
{
  Stage stage;
  stage.Look(0, 0);
  Cube bars[3] = { Cube(1, 0.1, 0.1), Cube(0.1, 0.1, 1), Cube(0.1, 1, 0.1) };
  std::vector<vtkVolume*> volumes;
  for (int n = 0; n < 3; ++n) {
    vtkVolume* volume = bars[n].Volume;
    volume->SetScale(1.8, 0.25, 0.1);
    volume->RotateZ(120.0 * n);
    volume->RotateY(25);
    volume->SetPosition(
      0.85 * std::cos(vtkMath::RadiansFromDegrees(120.0 * n - 90.0)), 0.85 * std::sin(vtkMath::RadiansFromDegrees(120.0 * n - 90.0)), 0);
    volumes.push_back(volume);
  }
  const Bytes picture = stage.DrawInAllOrders("ring", volumes);
  CHECK(!bars[0].Mapper->GetLastImage() && !bars[1].Mapper->GetLastImage() && !bars[2].Mapper->GetLastImage(), "a ring is not mixed");
  CHECK(Stage::Worst(picture, stage.DrawMixed(volumes)) <= 1, "ring");
}

vtkSmartPointer<vtkActor> Sheet(double x, double opacity)
{
  vtkNew<vtkPlaneSource> plane;
  plane->SetOrigin(x, -4, -4);
  plane->SetPoint1(x, 0.2, -4);
  plane->SetPoint2(x, -4, 4);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(plane->GetOutputPort());
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetColor(1, 1, 0);
  actor->GetProperty()->SetOpacity(opacity);
  return actor;
}

// An opaque sheet between volumes, and one that is peeled with them.
void Surfaces()
{
  Cube red(1, 0.1, 0.1), blue(0.1, 0.1, 1);
  for (const double at : { 1.3, 0.7 }) { // apart, overlapping
    red.Volume->SetPosition(-at, 0, 0);
    blue.Volume->SetPosition(at, 0, 0);
    for (const double azimuth : { 70.0, -70.0 }) {
      if (at < 1.0 && azimuth < 0.0) {
        continue;
      }
      Stage stage;
      stage.Look(azimuth, 10);
      const vtkSmartPointer<vtkActor> solid = Sheet(0, 1.0);
      const Bytes picture = stage.DrawInAllOrders("with a sheet", { red.Volume, blue.Volume }, { solid });
      double off = Stage::Rms(picture, stage.DrawMixed({ red.Volume, blue.Volume }, { solid }));
      CHECK(off <= (at > 1.0 ? OneByOne : 0.0), "with a sheet: %g of 255 from the mixed picture", off);
      const vtkSmartPointer<vtkActor> glass = Sheet(0, 0.5);
      stage.Renderer->SetUseDepthPeeling(true);
      stage.Renderer->SetUseDepthPeelingForVolumes(true);
      const Bytes peeled = stage.DrawInAllOrders("peeled", { red.Volume, blue.Volume }, { glass });
      off = Stage::Rms(peeled, stage.DrawMixed({ red.Volume, blue.Volume }, { glass }));
      CHECK(off <= (at > 1.0 ? OneByOne : 0.0), "peeled: %g of 255 from the mixed picture", off);
      CHECK(peeled != stage.Draw({ red.Volume, blue.Volume }), "the peeled sheet is not shown");
      red.Volume->ReleaseGraphicsResources(stage.Window);
      blue.Volume->ReleaseGraphicsResources(stage.Window);
    }
  }
}

void Meshes()
{
  Cube red(1, 0.1, 0.1), mesh(0.1, 0.1, 1, false), other(0.1, 1, 0.1);
  mesh.Triangulate();
  Stage stage;
  stage.Watch(red.Mapper), stage.Watch(mesh.Meshes), stage.Watch(other.Meshes);
  for (const double at : { 1.3, 0.7 }) {
    red.Volume->SetPosition(-at, 0, 0);
    mesh.Volume->SetPosition(at, 0, 0);
    for (const double azimuth : { 70.0, -70.0 }) {
      stage.Look(azimuth, 10);
      const Bytes picture = stage.DrawInAllOrders("image and mesh", { red.Volume, mesh.Volume });
      const Bytes mixed = stage.DrawMixed({ red.Volume, mesh.Volume });
      const double off = Stage::Rms(picture, mixed);
      CHECK(at > 1.0 ? off <= OneByOne : Stage::Worst(picture, mixed) <= 1, "image and mesh: %g of 255 from the mixed picture", off);
    }
  }
  CHECK(stage.Warnings->Count == 0 && stage.Errors->Count == 0, "%s %s", stage.Warnings->Text.c_str(), stage.Errors->Text.c_str());
  // Two meshes: sorted where they are apart, refused where they overlap.
  other.Triangulate();
  stage.Look(70, 10);
  other.Volume->SetPosition(-1.3, 0, 0);
  mesh.Volume->SetPosition(1.3, 0, 0);
  const Bytes right = stage.DrawInAllOrders("two meshes", { mesh.Volume, other.Volume });
  stage.Look(-70, 10);
  CHECK(right != stage.DrawInAllOrders("two meshes", { mesh.Volume, other.Volume }) && stage.Warnings->Count == 0, "two meshes");
  other.Meshes->CroppingOn();
  other.Meshes->SetCroppingRegionPlanes(-1, 1, -1, 1, -1, 0);
  mesh.Meshes->CroppingOn();
  mesh.Meshes->SetCroppingRegionPlanes(-1, 1, -1, 1, 0, 1);
  mesh.Volume->SetPosition(-1.3, 0, 0);
  stage.DrawInAllOrders("two meshes of one place, cropped", { mesh.Volume, other.Volume });
  CHECK(stage.Warnings->Count == 0, "cropped meshes: %s", stage.Warnings->Text.c_str());
  mesh.Meshes->CroppingOff();
  stage.DrawInAllOrders("two meshes that overlap", { mesh.Volume, other.Volume });
  CHECK(stage.Warnings->Count == 1 && stage.Warnings->Has("no volume has a vtkStratusVolumeMapper"), "%d: %s", stage.Warnings->Count,
    stage.Warnings->Text.c_str());
}

// All crop regions are mixed.
void Fence()
{
  Cube red(1, 0.1, 0.1), blue(0.1, 0.1, 1);
  blue.Volume->SetPosition(0.7, 0.3, 0.2);
  blue.Mapper->CroppingOn();
  blue.Mapper->SetCroppingRegionPlanes(-0.5, 0.5, -0.5, 0.5, -0.5, 0.5);
  Stage stage;
  stage.Watch(red.Mapper);
  stage.Watch(blue.Mapper);
  stage.Look(60, 10);
  const Bytes box = stage.DrawInAllOrders("cropped to a box", { red.Volume, blue.Volume });
  blue.Mapper->SetCroppingRegionFlagsToFence();
  CHECK(stage.DrawInAllOrders("cropped to a fence", { red.Volume, blue.Volume }) != box, "a fence is not a box");
  CHECK(stage.Warnings->Count == 0 && stage.Errors->Count == 0, "%s %s", stage.Warnings->Text.c_str(), stage.Errors->Text.c_str());
}

// Volumes that can't be mixed are drawn in an order that does not depend on the renderer's, with one warning.
void Unmixed()
{
  const auto warns = [](const char* words, const std::function<void(Cube&, Cube&)>& change) {
    Cube red(1, 0.1, 0.1), blue(0.1, 0.1, 1);
    blue.Volume->SetPosition(0.7, 0.3, 0.2);
    change(red, blue);
    Stage stage;
    stage.Watch(red.Volume->GetMapper());
    if (blue.Volume->GetMapper() != red.Volume->GetMapper()) {
      stage.Watch(blue.Volume->GetMapper());
    }
    stage.Look(60, 10);
    stage.DrawInAllOrders(words, { red.Volume, blue.Volume });
    CHECK(stage.Warnings->Count == 1 && stage.Warnings->Has(words) && stage.Errors->Count == 0, "%s: %d warnings: %s, %s", words,
      stage.Warnings->Count, stage.Warnings->Text.c_str(), stage.Errors->Text.c_str());
  };
  warns("are not mixed, all volumes need the same", [](Cube& red, Cube&) { red.Mapper->SetBlendModeToMaximumIntensity(); });
  warns("share a mapper", [](Cube& red, Cube& blue) { blue.Volume->SetMapper(red.Mapper); });
  warns("paths go through one grid alone", [](Cube& red, Cube&) { red.Mapper->SetRenderModeToPath(); });
  vtkNew<vtkStratusMultiBlockVolumeMapper> blocks;
  warns("a vtkStratusMultiBlockVolumeMapper is not mixed", [&](Cube& red, Cube&) {
    blocks->SetInputDataObject(red.Image);
    blocks->GetSettings()->SetDevice("host");
    red.Volume->SetMapper(blocks);
  });
  // Maxima that are apart are sorted, too.
  Cube red(1, 0.1, 0.1), blue(0.1, 0.1, 1);
  red.Volume->SetPosition(-1.2, 0, 0);
  blue.Volume->SetPosition(1.2, 0, 0);
  red.Mapper->SetBlendModeToMaximumIntensity();
  blue.Mapper->SetBlendModeToMaximumIntensity();
  Stage stage;
  stage.Watch(red.Mapper), stage.Watch(blue.Mapper);
  stage.Look(70, 10);
  stage.DrawInAllOrders("maxima", { red.Volume, blue.Volume });
  // Maxima that overlap are the maxima of both.
  blue.Volume->SetPosition(-0.5, 0, 0);
  stage.DrawInAllOrders("maxima that overlap", { red.Volume, blue.Volume });
  CHECK(!red.Mapper->GetLastImage() && !blue.Mapper->GetLastImage(), "maxima that overlap are drawn one by one");
  // Isosurfaces that overlap are by depth.
  Cube along(1, 0.5, 0.1, false), across(0.1, 0.5, 1, false);
  across.Volume->RotateZ(70);
  for (const Cube* cube : { &along, &across }) {
    cube->Volume->GetProperty()->GetIsoSurfaceValues()->SetValue(0, 0.6);
    cube->Mapper->SetBlendModeToIsoSurface();
    stage.Watch(cube->Mapper);
  }
  stage.DrawInAllOrders("isosurfaces that overlap", { along.Volume, across.Volume });
  CHECK(!along.Mapper->GetLastImage() && !across.Mapper->GetLastImage(), "isosurfaces that overlap are drawn one by one");
  // First hits are solid: the other volume's rays end there, wherever it is.
  blue.Mapper->SetBlendModeToComposite();
  red.Mapper->SetBlendModeToComposite();
  red.Mapper->SetRenderModeToFirstHit();
  blue.Volume->SetPosition(-0.5, 0, 0);
  stage.DrawInAllOrders("first hits", { red.Volume, blue.Volume });
  CHECK(stage.Warnings->Count == 0 && stage.Errors->Count == 0, "%s %s", stage.Warnings->Text.c_str(), stage.Errors->Text.c_str());
}

// A volume of one of VTK's mappers among ours: right where the renderer's order allows it, and one warning where not.
void Others()
{
  Cube red(1, 0.1, 0.1), blue(0.1, 0.1, 1), green(0.1, 1, 0.1);
  red.Volume->SetPosition(-2.2, 0, 0);
  blue.Volume->SetPosition(2.2, 0, 0);
  vtkNew<vtkFixedPointVolumeRayCastMapper> fixed;
  fixed->SetInputData(green.Image);
  green.Volume->SetMapper(fixed);
  Stage stage;
  stage.Watch(red.Mapper), stage.Watch(blue.Mapper);
  stage.Look(80, 5);
  const Bytes one = stage.Draw({ red.Volume, green.Volume, blue.Volume }), other = stage.Draw({ blue.Volume, green.Volume, red.Volume });
  CHECK(one == other && stage.Warnings->Count == 0, "VTK's volume between ours: %s", stage.Warnings->Text.c_str());
  stage.Draw({ red.Volume, blue.Volume, green.Volume });
  stage.Draw({ green.Volume, red.Volume, blue.Volume });
  stage.Draw({ red.Volume, blue.Volume, green.Volume });
  CHECK(stage.Warnings->Count == 1 && stage.Warnings->Has("vtkFixedPointVolumeRayCastMapper"), "VTK's volume, first or last: %d: %s",
    stage.Warnings->Count, stage.Warnings->Text.c_str());
  // Where it is behind all of ours, it may be the first.
  Stage fresh;
  red.Volume->ReleaseGraphicsResources(stage.Window);
  blue.Volume->ReleaseGraphicsResources(stage.Window);
  green.Volume->ReleaseGraphicsResources(stage.Window);
  green.Volume->SetPosition(-5, 0, 0);
  fresh.Watch(red.Mapper), fresh.Watch(blue.Mapper);
  fresh.Look(80, 5);
  fresh.Renderer->GetActiveCamera()->SetFocalPoint(-1, 0, 0);
  fresh.DrawInAllOrders("before it", { red.Volume, blue.Volume }, { green.Volume });
  CHECK(fresh.Warnings->Count == 0, "VTK's volume behind ours: %s", fresh.Warnings->Text.c_str());
  fresh.Draw({ red.Volume });
  green.Volume->SetPosition(-2.5, 0, 0);
  fresh.Draw({ red.Volume, green.Volume });
  CHECK(fresh.Warnings->Count == 1, "VTK's volume overlaps the only one of ours: %d", fresh.Warnings->Count);
}

// Volumes that are hidden, out of view, in assemblies and in two renderers.
void Props()
{
  Cube red(1, 0.1, 0.1), blue(0.1, 0.1, 1), green(0.1, 1, 0.1);
  red.Volume->SetPosition(-1.2, 0, 0);
  blue.Volume->SetPosition(1.2, 0, 0);
  green.Volume->SetPosition(1.9, 0.2, 0);
  Stage stage;
  stage.Look(70, 10);
  const Bytes both = stage.Draw({ red.Volume, blue.Volume });
  green.Volume->VisibilityOff();
  CHECK(stage.DrawInAllOrders("hidden", { red.Volume, blue.Volume, green.Volume }) == both, "a volume that is hidden");
  green.Volume->VisibilityOn();
  green.Volume->SetPosition(0, 0, 900);
  CHECK(stage.DrawInAllOrders("out of view", { red.Volume, blue.Volume, green.Volume }) == both, "a volume that is out of view");
  red.Mapper->RenderToImageOn();
  const Bytes without = stage.DrawInAllOrders("to an image", { red.Volume, blue.Volume });
  CHECK(without == stage.Draw({ blue.Volume }), "a volume that is drawn to an image");
  red.Mapper->RenderToImageOff();
  // One after the other becomes invisible, which leaves calls of a frame out.
  stage.Draw({ blue.Volume, red.Volume });
  red.Volume->VisibilityOff();
  CHECK(stage.Draw({ blue.Volume, red.Volume }) == without, "the second volume is hidden");
  red.Volume->VisibilityOn();
  CHECK(stage.Draw({ blue.Volume, red.Volume }) == both, "the second volume is shown again");
  // A prop with levels of detail keeps its place: right where it is behind the other, and with a warning where it is before it.
  vtkNew<vtkLODProp3D> lod;
  lod->AddLOD(red.Mapper, red.Volume->GetProperty(), 0.0);
  lod->SetPosition(-1.2, 0, 0);
  stage.Watch(blue.Mapper);
  CHECK(stage.Draw({ lod, blue.Volume }) == both && stage.Warnings->Count == 0, "levels of detail: %s", stage.Warnings->Text.c_str());
  stage.Draw({ blue.Volume, lod });
  CHECK(stage.Warnings->Count == 1 && stage.Warnings->Has("vtkLODProp3D"), "levels of detail before: %d", stage.Warnings->Count);
  for (const double at : { 1.2, 0.7 }) {
    red.Volume->SetPosition(-at, 0, 0);
    blue.Volume->SetPosition(at, 0, 0);
    const Bytes plain = stage.Draw({ red.Volume, blue.Volume });
    for (const bool turned : { false, true }) {
      vtkNew<vtkAssembly> inner, outer;
      vtkVolume* const parts[2] = { turned ? blue.Volume : red.Volume, turned ? red.Volume : blue.Volume };
      outer->AddPart(inner);
      inner->AddPart(parts[0]);
      outer->AddPart(parts[1]);
      outer->SetPosition(3, 0, 0);
      inner->SetPosition(-2, 1, 0);
      parts[0]->AddPosition(-1, -1, 0);
      parts[1]->AddPosition(-3, 0, 0);
      const int worst = Stage::Worst(stage.Draw({ outer }), plain);
      CHECK(worst <= 1, "an assembly: %d", worst); // matrices are rounded
      parts[0]->AddPosition(1, 1, 0);
      parts[1]->AddPosition(3, 0, 0);
      CHECK(Stage::Worst(stage.Draw({ red.Volume, blue.Volume }), plain) <= 1, "volumes that have been parts of an assembly");
    }
  }
  // The same volumes in two renderers, which look from opposite sides.
  vtkNew<vtkRenderer> right;
  stage.Renderer->SetViewport(0, 0, 0.5, 1);
  right->SetViewport(0.5, 0, 1, 1);
  stage.Window->AddRenderer(right);
  right->AddVolume(blue.Volume);
  right->AddVolume(red.Volume);
  right->GetActiveCamera()->DeepCopy(stage.Renderer->GetActiveCamera());
  const Bytes twice = stage.DrawInAllOrders("two renderers", { red.Volume, blue.Volume });
  const size_t row = 4 * 60;
  size_t wrong = 0;
  for (size_t at = 0; at < twice.size(); ++at) {
    wrong += at % row < row / 2 && twice[at] != twice[at + row / 2];
  }
  CHECK(wrong == 0, "two renderers: %zu values differ", wrong);
}

// A hardware selector finds the volume that is in front.
void Picking()
{
  Cube red(1, 0.1, 0.1), blue(0.1, 0.1, 1);
  red.Volume->SetPosition(-1.2, 0, 0);
  blue.Volume->SetPosition(1.2, 0, 0);
  Stage stage;
  for (const double azimuth : { 88.0, -88.0 }) {
    stage.Look(azimuth, 0);
    for (const bool turned : { false, true }) {
      const Bytes before = stage.Draw({ turned ? blue.Volume : red.Volume, turned ? red.Volume : blue.Volume });
      vtkNew<vtkHardwareSelector> selector;
      selector->SetRenderer(stage.Renderer);
      selector->SetArea(28, 23, 32, 27);
      selector->SetFieldAssociation(vtkDataObject::FIELD_ASSOCIATION_CELLS);
      const auto selection = vtkSmartPointer<vtkSelection>::Take(selector->Select());
      const vtkVolume* front = azimuth > 0.0 ? blue.Volume : red.Volume;
      const bool one = selection && selection->GetNumberOfNodes() == 1;
      CHECK(one && selection->GetNode(0)->GetProperties()->Get(vtkSelectionNode::PROP()) == front,
        "from %g, %d: the volume behind is picked", azimuth, turned);
      CHECK(stage.Draw({ red.Volume, blue.Volume }) == before, "the picture after picking is another");
    }
  }
}

// Volumes that were mixed are deleted with the last pointer to them.
void Lifetimes()
{
  vtkWeakPointer<vtkVolume> volumes[2];
  {
    Cube red(1, 0.1, 0.1), blue(0.1, 0.1, 1);
    volumes[0] = red.Volume;
    volumes[1] = blue.Volume;
    Stage stage;
    stage.Look(30, 10);
    stage.Draw({ red.Volume, blue.Volume });
    stage.Renderer->RemoveAllViewProps();
  }
  CHECK(!volumes[0] && !volumes[1], "a volume that was mixed is not deleted");
}
} // namespace

int main()
{
  Apart();
  Cut();
  Overlapping();
  Ring();
  Surfaces();
  Meshes();
  Fence();
  Unmixed();
  Others();
  Props();
  Picking();
  Lifetimes();
  std::printf("%d failures\n", Failures);
  return Failures != 0;
}
