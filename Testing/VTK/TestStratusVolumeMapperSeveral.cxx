// SPDX-License-Identifier: BSD-3-Clause
// vtkStratusMultiVolume: volumes of different grids and places that overlap, against the double reference with several fields; its
// interface, geometry inside, picking, translucent surfaces, and refused inputs.
#include "mapper_testing.h"

#include "Testing/support/reference_several.h"
#include "vtkStratusMultiVolume.h"
#include "vtkStratusTetrahedraMapper.h"

#include "vtkActor.h"
#include "vtkContourValues.h"
#include "vtkFixedPointVolumeRayCastMapper.h"
#include "vtkHardwareSelector.h"
#include "vtkInformation.h"
#include "vtkPlane.h"
#include "vtkPlaneSource.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkSelection.h"
#include "vtkSelectionNode.h"
#include "vtkSphereSource.h"
#include "vtkUnstructuredGrid.h"

#include <functional>

namespace {
// Scene's own volume at port 0 and a second one, turned and of other spacing, at port 5.
struct Pair : Scene {
  explicit Pair(int width = 160, int height = 120) : Scene(width, height)
  {
    this->OtherImage->SetDimensions(20, 41, 24);
    this->OtherImage->SetSpacing(1.4, 0.6, 1.0);
    this->OtherImage->SetOrigin(3, -2, 5);
    FillField(this->OtherImage, false, "smoke", 80.0);
    this->OtherOpacity->AddPoint(4.0, 0.0);
    this->OtherOpacity->AddPoint(80.0, 0.6);
    this->OtherColor->AddRGBPoint(0.0, 0.1, 0.9, 0.2);
    this->OtherColor->AddRGBPoint(80.0, 0.9, 0.9, 1.0);
    vtkVolumeProperty* property = this->Other->GetProperty();
    property->SetScalarOpacity(this->OtherOpacity);
    property->SetColor(this->OtherColor);
    property->SetInterpolationTypeToLinear();
    property->SetScalarOpacityUnitDistance(2.5);
    this->OtherMapper->SetInputData(this->OtherImage);
    this->Other->SetMapper(this->OtherMapper);
    this->Other->SetOrigin(14, 10, 16);
    this->Other->RotateZ(35);
    this->Other->RotateX(20);
    this->Renderer->RemoveViewProp(this->Volume);
    this->Multi->SetVolume(this->Volume);
    this->Multi->SetVolume(this->Other, 5);
    this->Multi->AddObserver(vtkCommand::ErrorEvent, this->Errors);
    this->Renderer->AddViewProp(this->Multi);
    this->Look(35, 20);
  }

  std::vector<float> Mixed()
  {
    this->Render();
    vtkImageData* image = this->Multi->GetLastImage();
    std::vector<float> picture;
    if (image) {
      const float* rgba = vtkFloatArray::SafeDownCast(image->GetPointData()->GetArray("RGBA"))->GetPointer(0);
      picture.assign(rgba, rgba + 4 * this->Pixels());
    }
    return picture;
  }

  // Returns the PSNR of a picture against the reference with both fields.
  // change: of the second field's scene and volume.
  double Psnr(const std::vector<float>& picture, const float* opaqueDepth = nullptr, const reference_mesh* mesh = nullptr,
    const std::function<void(reference_scene&, stratus_volume&)>& change = nullptr)
  {
    const double opacity[2][6] = { { 0.1, 0.0, 0.4, 0.15, 1.0, 0.5 }, { 4.0, 0.0, 80.0, 0.6 } };
    const double color[2][12] = { { 0.0, 0.1, 0.2, 0.9, 0.5, 0.9, 0.8, 0.3, 1.0, 1.0, 0.2, 0.1 },
      { 0.0, 0.1, 0.9, 0.2, 80.0, 0.9, 0.9, 1.0 } };
    const stratus_camera camera = ReferenceCamera(this->Renderer);
    stratus_volume volumes[2];
    stratus_transfer transfers[2];
    reference_scene scenes[2];
    for (int n = 0; n < 2; ++n) {
      vtkImageData* image = n ? this->OtherImage : this->Image;
      volumes[n] = ReferenceVolume(image, vtkFloatArray::SafeDownCast(image->GetPointData()->GetScalars()), false,
        n ? this->Other->GetMatrix() : this->Volume->GetMatrix());
      transfers[n] = stratus_transfer_default();
      transfers[n].opacity = opacity[n];
      transfers[n].opacity_count = n ? 2 : 3;
      transfers[n].color = color[n];
      transfers[n].color_count = n ? 2 : 3;
      transfers[n].unit_distance = n ? 2.5 : 1.5;
      scenes[n] = reference_scene();
      scenes[n].volume = &volumes[n];
      scenes[n].transfer = &transfers[n];
      scenes[n].camera = &camera;
      scenes[n].opaque_depth = opaqueDepth;
    }
    if (change) {
      change(scenes[1], volumes[1]);
    }
    std::vector<float> rgba(4 * this->Pixels());
    const int* size = this->Renderer->GetSize();
    const reference_mixture mixture = { scenes, 2, mesh, mesh ? 1 : 0, &camera, opaqueDepth };
    if (picture.empty() || reference_render_mixture(&mixture, size[0], size[1], 0.6 / 16, rgba.data(), nullptr) != 0) {
      return -1.0;
    }
    return reference_psnr(picture.data(), rgba.data(), this->Pixels());
  }

  vtkNew<vtkImageData> OtherImage;
  vtkNew<vtkPiecewiseFunction> OtherOpacity;
  vtkNew<vtkColorTransferFunction> OtherColor;
  vtkNew<vtkStratusVolumeMapper> OtherMapper;
  vtkNew<vtkVolume> Other;
  vtkNew<vtkStratusMultiVolume> Multi;
};

void Mixed()
{
  for (int parallel = 0; parallel < 2; ++parallel) {
    Pair scene;
    const double ground[3] = { 51 / 255.0, 102 / 255.0, 204 / 255.0 }; // bytes, so that only the picture is rounded
    scene.Renderer->SetBackground(ground[0], ground[1], ground[2]);
    scene.Renderer->GetActiveCamera()->SetParallelProjection(parallel);
    scene.Renderer->ResetCamera();
    const double db = scene.Psnr(scene.Mixed());
    CHECK(db >= 60.0, "%.1f dB at the default tolerance", db);
    double worst = 0.0;
    const std::vector<float> picture = scene.Mixed();
    const std::vector<unsigned char> bytes = scene.Bytes();
    for (size_t p = 0; p < scene.Pixels(); ++p) {
      for (size_t c = 0; c < 3; ++c) {
        worst = std::max(worst, std::fabs(255.0 * (picture[4 * p + c] + (1.0 - picture[4 * p + 3]) * ground[c]) - bytes[4 * p + c]));
      }
    }
    CHECK(worst <= 0.51, "the window is off by %g of 255", worst);
    scene.Mapper->AuditOn();
    scene.Mapper->SetStructureToDistance();
    CHECK(scene.Mixed() == picture && scene.Multi->GetDifferingPixels() == 0, "%llu pixels differ",
      static_cast<unsigned long long>(scene.Multi->GetDifferingPixels()));
    CHECK(scene.Multi->GetSamplesTaken() > 1000 && scene.Multi->GetCastTime() > 0.0 && scene.Multi->GetUsedSampleDistance(5) > 0.0 &&
        std::string(scene.Multi->GetReason(5)).find("sample distance") != std::string::npos,
      "reports: %s", scene.Multi->GetReason(5));
    if (stratus_device_count() > 0) {
      scene.Mapper->SetDevice("0");
      CHECK(scene.Mixed() == picture && std::string(scene.Multi->GetReason(0)).find("drawn on the host") == std::string::npos,
        "the device draws otherwise: %s", scene.Multi->GetReason(0));
    }
    CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
  }
}

// The order of ports changes no more than rounding does, and the mixed picture is neither volume over the other.
void Ports()
{
  Pair scene;
  const std::vector<float> picture = scene.Mixed();
  scene.Multi->RemoveVolume(0);
  scene.Multi->SetVolume(scene.Volume, 7);
  const std::vector<float> swapped = scene.Mixed();
  double worst = 0.0;
  for (size_t at = 0; at < picture.size(); ++at) {
    worst = std::max<double>(worst, std::fabs(picture[at] - swapped[at]));
  }
  CHECK(!picture.empty() && worst < 1e-5, "another order of ports changes %g", worst);
  scene.Other->VisibilityOff();
  const std::vector<float> one = scene.Mixed();
  scene.Other->VisibilityOn();
  scene.Volume->VisibilityOff();
  const std::vector<float> other = scene.Mixed();
  double over = 0.0;
  for (size_t at = 0; at < picture.size(); ++at) {
    over = std::max<double>(over, std::fabs(one[at] + (1.0f - one[at / 4 * 4 + 3]) * other[at] - picture[at]));
  }
  CHECK(over > 0.1, "the volumes cover one another: %g", over);
  // A single volume looks like its own mapper's picture.
  scene.Volume->VisibilityOn();
  scene.Multi->RemoveVolume(5);
  const std::vector<float> single = scene.Mixed();
  scene.Renderer->RemoveViewProp(scene.Multi);
  scene.Renderer->AddViewProp(scene.Volume);
  CHECK(single == scene.Picture(), "a single volume is another picture");
}

void Interface()
{
  Pair scene;
  double bounds[6], one[6], other[6];
  scene.Multi->GetBounds(bounds);
  scene.Volume->GetBounds(one);
  scene.Other->GetBounds(other);
  for (int side = 0; side < 6; ++side) {
    CHECK(bounds[side] == (side % 2 ? std::max(one[side], other[side]) : std::min(one[side], other[side])), "bounds %d", side);
  }
  CHECK(scene.Multi->GetNumberOfVolumes() == 2 && scene.Multi->GetVolume(5) == scene.Other && !scene.Multi->GetVolume(1) &&
      !scene.Multi->GetVolume(-1) && scene.Multi->GetProperty() == scene.Volume->GetProperty(),
    "volumes by port");
  const vtkMTimeType time = scene.Multi->GetMTime(), redraw = scene.Multi->GetRedrawMTime();
  scene.Other->SetPosition(1, 0, 0);
  CHECK(scene.Multi->GetMTime() > time, "moving a volume modifies the prop");
  scene.OtherOpacity->AddPoint(90.0, 0.5);
  CHECK(scene.Multi->GetRedrawMTime() > redraw, "a changed function requests a redraw");
  scene.Multi->SetVolume(scene.Volume, 8);
  CHECK(scene.Errors->Count == 1 && scene.Errors->Has("port 8 must be 0..7"), "%s", scene.Errors->Text.c_str());
  scene.Multi->SetVolume(scene.Volume, 2);
  CHECK(scene.Errors->Count == 2 && scene.Errors->Has("is at port 0 already"), "%s", scene.Errors->Text.c_str());
  scene.Multi->SetVolume(scene.Multi, 2);
  CHECK(scene.Errors->Count == 3 && scene.Errors->Has("itself"), "%s", scene.Errors->Text.c_str());
  vtkNew<vtkStratusMultiVolume> copy;
  copy->ShallowCopy(scene.Multi);
  CHECK(copy->GetVolume(5) == scene.Other, "a shallow copy has the volumes");
  scene.Multi->RemoveVolume(0);
  scene.Multi->RemoveVolume(5);
  scene.Render();
  CHECK(scene.Multi->GetBounds()[0] > scene.Multi->GetBounds()[1] && !scene.Multi->GetProperty() && scene.Errors->Count == 3,
    "without volumes nothing is drawn, and that is no error");
}

void Geometry()
{
  Pair scene;
  vtkNew<vtkSphereSource> ball;
  ball->SetRadius(6);
  ball->SetCenter(14, 14, 13);
  ball->SetThetaResolution(24);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(ball->GetOutputPort());
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  scene.Renderer->AddActor(actor);
  scene.Renderer->ResetCamera();
  const std::vector<float> picture = scene.Mixed();
  const int* size = scene.Renderer->GetSize();
  std::vector<float> z(scene.Pixels());
  scene.Window->GetZbufferData(0, 0, size[0] - 1, size[1] - 1, z.data());
  const double db = scene.Psnr(picture, z.data());
  CHECK(db >= 60.0, "%.1f dB with a ball inside", db);
}

void Picking()
{
  Pair scene;
  scene.Renderer->SetBackground(0.3, 0.6, 0.9);
  const std::vector<float> before = scene.Mixed();
  int shown = 0;
  for (size_t p = 0; p < scene.Pixels(); ++p) {
    shown += before[4 * p + 3] > 3.0f / 255.0f; // as VTK picks
  }
  vtkNew<vtkHardwareSelector> selector;
  selector->SetRenderer(scene.Renderer);
  const int* size = scene.Renderer->GetSize();
  selector->SetArea(0, 0, static_cast<unsigned int>(size[0] - 1), static_cast<unsigned int>(size[1] - 1));
  selector->SetFieldAssociation(vtkDataObject::FIELD_ASSOCIATION_CELLS);
  const auto selection = vtkSmartPointer<vtkSelection>::Take(selector->Select());
  const bool one = selection && selection->GetNumberOfNodes() == 1;
  CHECK(one && selection->GetNode(0)->GetProperties()->Get(vtkSelectionNode::PROP()) == scene.Multi, "the prop is not picked");
  CHECK(!one || selection->GetNode(0)->GetProperties()->Get(vtkSelectionNode::PIXEL_COUNT()) == shown, "%d pixels show", shown);
  CHECK(shown > 1000 && scene.Mixed() == before, "the picture after picking is another");
}

// A translucent sheet before the volumes and one behind them, with volumes peeled.
void Peeling()
{
  for (double z : { 60.0, -60.0 }) {
    Pair scene;
    vtkNew<vtkPlaneSource> plane;
    plane->SetOrigin(-100, -100, z);
    plane->SetPoint1(100, -100, z);
    plane->SetPoint2(-100, 100, z);
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(plane->GetOutputPort());
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->LightingOff();
    actor->GetProperty()->SetColor(1, 0, 0);
    actor->GetProperty()->SetOpacity(0.5);
    vtkCamera* camera = scene.Renderer->GetActiveCamera();
    camera->SetFocalPoint(14, 14, 13);
    camera->SetPosition(14, 14, 120);
    camera->SetViewUp(0, 1, 0);
    camera->SetClippingRange(20, 250);
    const std::vector<float> volumes = scene.Mixed();
    scene.Renderer->AddActor(actor);
    scene.Renderer->SetUseDepthPeeling(true);
    scene.Renderer->SetUseDepthPeelingForVolumes(true);
    scene.Render();
    const std::vector<unsigned char> bytes = scene.Bytes();
    double worst = 0.0;
    for (size_t p = 0; !volumes.empty() && p < scene.Pixels(); ++p) {
      for (size_t c = 0; c < 3; ++c) {
        const double sheet = c == 0 ? 0.5 : 0.0, of = volumes[4 * p + c], left = 1.0 - volumes[4 * p + 3];
        const double meant = z > 0.0 ? sheet + 0.5 * of : of + left * sheet;
        worst = std::max(worst, std::fabs(255.0 * meant - bytes[4 * p + c]));
      }
    }
    CHECK(!volumes.empty() && worst < 3.0, "a sheet at %g: the window is off by %g of 255", z, worst);
  }
}

// A mesh of 6 n^3 tetrahedra that leans and overlaps the scene's volume, as VTK's grid and as the reference's mesh.
struct Cells {
  Cells()
  {
    static const int path[6][2] = { { 0, 1 }, { 0, 2 }, { 1, 0 }, { 1, 2 }, { 2, 0 }, { 2, 1 } };
    const int n = 4, side = n + 1, step[3] = { 1, side, side * side };
    vtkNew<vtkPoints> points;
    vtkNew<vtkFloatArray> scalars;
    points->SetDataTypeToDouble();
    scalars->SetName("heat");
    for (int i = 0; i < side * side * side; ++i) {
      const double at[3] = { 6.0 * (i % side), 5.0 * (i / side % side) + 2.0 * (i % side), 5.0 * (i / side / side) };
      points->InsertNextPoint(at);
      this->Points.insert(this->Points.end(), at, at + 3);
      this->Values.push_back(static_cast<float>(0.5 + 0.5 * std::sin(1.7 * i)));
      scalars->InsertNextValue(this->Values.back());
    }
    this->Grid->SetPoints(points);
    this->Grid->GetPointData()->SetScalars(scalars);
    for (int box = 0; box < n * n * n; ++box) {
      const int corner = (box / n / n * side + box / n % n) * side + box % n;
      for (const int* turn : path) {
        const int a = corner + step[turn[0]], b = a + step[turn[1]], last = corner + 1 + side + side * side;
        const vtkIdType ids[4] = { corner, a, b, last };
        this->Grid->InsertNextCell(VTK_TETRA, 4, ids);
        this->Vertices.insert(this->Vertices.end(), ids, ids + 4);
      }
    }
    this->Opacity->AddPoint(0.1, 0.0);
    this->Opacity->AddPoint(1.0, 0.4);
    this->Color->AddRGBPoint(0.0, 0.9, 0.2, 0.8);
    this->Color->AddRGBPoint(1.0, 0.2, 1.0, 0.4);
    vtkVolumeProperty* property = this->Volume->GetProperty();
    property->SetScalarOpacity(this->Opacity);
    property->SetColor(this->Color);
    property->SetInterpolationTypeToLinear();
    property->SetScalarOpacityUnitDistance(3.0);
    this->Mapper->SetInputData(this->Grid);
    this->Volume->SetMapper(this->Mapper);
    this->Volume->SetPosition(3, 1, 4);
    this->Volume->RotateY(15);
  }

  // The reference's view of it, valid as long as this.
  reference_mesh Reference()
  {
    this->Mesh = stratus_mesh_default();
    this->Mesh.points = this->Points.data();
    this->Mesh.point_count = static_cast<int64_t>(this->Values.size());
    this->Mesh.vertices = this->Vertices.data();
    this->Mesh.cell_count = static_cast<int64_t>(this->Vertices.size() / 4);
    this->Mesh.values = this->Values.data();
    for (int i = 0; i < 16; ++i) {
      this->Mesh.matrix[i] = this->Volume->GetMatrix()->GetElement(i / 4, i % 4);
    }
    this->Transfer = stratus_transfer_default();
    this->Transfer.opacity = this->OpacityPoints;
    this->Transfer.opacity_count = 2;
    this->Transfer.color = this->ColorPoints;
    this->Transfer.color_count = 2;
    this->Transfer.unit_distance = 3.0;
    return { &this->Mesh, &this->Transfer, 0, nullptr, nullptr, nullptr };
  }

  double OpacityPoints[4] = { 0.1, 0.0, 1.0, 0.4 }, ColorPoints[8] = { 0.0, 0.9, 0.2, 0.8, 1.0, 0.2, 1.0, 0.4 };
  std::vector<double> Points;
  std::vector<int32_t> Vertices;
  std::vector<float> Values;
  stratus_mesh Mesh;
  stratus_transfer Transfer;
  vtkNew<vtkUnstructuredGrid> Grid;
  vtkNew<vtkPiecewiseFunction> Opacity;
  vtkNew<vtkColorTransferFunction> Color;
  vtkNew<vtkStratusTetrahedraMapper> Mapper;
  vtkNew<vtkVolume> Volume;
};

// An unstructured grid mixes with two images, and settings that do not mix are refused.
void Meshes()
{
  Pair scene;
  Cells cells;
  scene.Multi->SetVolume(cells.Volume, 2);
  scene.Renderer->ResetCamera();
  const std::vector<float> picture = scene.Mixed();
  reference_mesh mesh = cells.Reference();
  const double db = scene.Psnr(picture, nullptr, &mesh);
  CHECK(db >= 60.0, "%.1f dB with a mesh at the default tolerance", db);
  vtkVolumeProperty* property = cells.Volume->GetProperty();
  vtkNew<vtkPiecewiseFunction> gradient;
  gradient->AddPoint(0.0, 0.25);
  property->SetGradientOpacity(gradient);
  property->ShadeOn();
  property->SetAmbient(0.5);
  property->SetDiffuse(0.0);
  mesh.light = [](const void*, int64_t, const double*, const double*, double* rgb, double* depth) {
    std::for_each(rgb, rgb + 3, [](double& c) { c *= 0.5; });
    *depth *= 0.25;
  };
  const double lit = scene.Psnr(scene.Mixed(), nullptr, &mesh);
  CHECK(lit >= 60.0 && scene.Errors->Count == 0, "%.1f dB with a mesh in half of the light and a quarter of its depth: %s", lit,
    scene.Errors->Text.c_str());
  property->ShadeOff();
  property->SetGradientOpacity(static_cast<vtkPiecewiseFunction*>(nullptr));
  CHECK(scene.Mixed() == picture, "a mesh that is lit no more");
  CHECK(scene.Errors->Count == 0 && std::string(scene.Multi->GetReason(2)).find("from face to face") != std::string::npos, "%s, %s",
    scene.Errors->Text.c_str(), scene.Multi->GetReason(2));
  scene.Mapper->AuditOn();
  scene.Mapper->SetStructureToDistance();
  CHECK(scene.Mixed() == picture && scene.Multi->GetDifferingPixels() == 0, "%llu pixels differ",
    static_cast<unsigned long long>(scene.Multi->GetDifferingPixels()));
  cells.Volume->SetVisibility(0);
  CHECK(scene.Mixed() != picture, "a mesh that is not visible is drawn");
  cells.Volume->SetVisibility(1);
  cells.Grid->GetPointData()->GetScalars()->FillComponent(0, 0.0);
  cells.Grid->GetPointData()->GetScalars()->Modified();
  CHECK(scene.Mixed() != picture, "other values on a mesh are not seen");
  vtkNew<vtkUnstructuredGrid> none;
  cells.Mapper->SetInputData(none);
  CHECK(!scene.Mixed().empty() && scene.Errors->Count == 0, "a grid without cells: %s", scene.Errors->Text.c_str());
  scene.Multi->RemoveVolume(0);
  scene.Multi->RemoveVolume(5);
  cells.Mapper->SetInputData(cells.Grid);
  CHECK(scene.Mixed().empty() && scene.Errors->Has("no volume has a vtkStratusVolumeMapper"), "%s", scene.Errors->Text.c_str());
}

// Opaque isosurfaces of two images and a mesh, and opaque slices of both images: the nearest of those that each draws by itself.
void Surfaces()
{
  for (const int mode : { vtkVolumeMapper::ISOSURFACE_BLEND, vtkVolumeMapper::SLICE_BLEND }) {
    const bool isosurface = mode == vtkVolumeMapper::ISOSURFACE_BLEND;
    Pair scene;
    Cells cells;
    const double values[3] = { 0.45, 30.0, 0.9 };
    vtkVolume* volumes[3] = { scene.Volume, scene.Other, cells.Volume };
    vtkPiecewiseFunction* opacities[3] = { scene.Opacity, scene.OtherOpacity, cells.Opacity };
    const int count = isosurface ? 3 : 2;
    for (int n = 0; n < count; ++n) {
      vtkNew<vtkPlane> plane;
      plane->SetOrigin(14, 14, 13);
      plane->SetNormal(1, n ? -1 : 1, 0.5);
      opacities[n]->RemoveAllPoints();
      opacities[n]->AddPoint(0.0, 1.0);
      volumes[n]->GetProperty()->GetIsoSurfaceValues()->SetValue(0, values[n]);
      volumes[n]->GetProperty()->SetSliceFunction(plane);
    }
    scene.Mapper->SetBlendMode(mode);
    scene.OtherMapper->SetBlendMode(mode);
    if (isosurface) {
      cells.Mapper->SetBlendMode(mode);
      scene.Multi->SetVolume(cells.Volume, 2);
    }
    scene.Renderer->ResetCamera();
    std::vector<float> colors[3], depths[3];
    const auto draw = [&](std::vector<float>& color, std::vector<float>& depth) {
      color = scene.Mixed();
      vtkImageData* image = scene.Multi->GetLastImage();
      const float* far = image ? vtkFloatArray::SafeDownCast(image->GetPointData()->GetArray("Depth"))->GetPointer(0) : nullptr;
      depth.assign(far, far + (image ? scene.Pixels() : 0));
      CHECK(!color.empty() && scene.Errors->Count == 0, "mode %d: %s", mode, scene.Errors->Text.c_str());
    };
    std::vector<float> picture, depth;
    draw(picture, depth);
    for (int n = 0; n < count; ++n) { // a mesh needs an image, which has no surface then
      for (int other = 0; other < count; ++other) {
        volumes[other]->SetVisibility(other == n || (n == 2 && other == 0));
      }
      scene.Volume->GetProperty()->GetIsoSurfaceValues()->SetValue(0, n == 2 ? 1e6 : values[0]);
      draw(colors[n], depths[n]);
    }
    size_t shown[3] = { 0, 0, 0 }, off = 0;
    for (size_t p = 0; p < depth.size(); ++p) {
      int nearest = 0;
      for (int n = 1; n < count; ++n) {
        nearest = depths[n][p] < depths[nearest][p] ? n : nearest;
      }
      float worst = 0.0f;
      for (size_t c = 0; c < 4; ++c) {
        worst = std::max(worst, std::fabs(picture[4 * p + c] - colors[nearest][4 * p + c]));
      }
      shown[nearest] += colors[nearest][4 * p + 3] > 0.0f;
      off += worst > 0.002f;
    }
    CHECK(off <= depth.size() / 200, "mode %d: %d pixels are of another surface than the nearest", mode, static_cast<int>(off));
    CHECK(shown[0] > 50 && shown[1] > 50 && (shown[2] > 50) == isosurface, "mode %d: %d, %d and %d pixels", mode,
      static_cast<int>(shown[0]), static_cast<int>(shown[1]), static_cast<int>(shown[2]));
    for (vtkVolume* volume : volumes) {
      volume->SetVisibility(1);
    }
    scene.Volume->GetProperty()->GetIsoSurfaceValues()->SetValue(0, values[0]);
    if (stratus_device_count() > 0) {
      scene.Mapper->SetDevice("0");
      CHECK(scene.Mixed() == picture && std::string(scene.Multi->GetReason(0)).find("drawn on the host") == std::string::npos,
        "mode %d: the device draws otherwise: %s", mode, scene.Multi->GetReason(0));
    }
  }
}

// The second volume cell by cell, of two components, with a label map, and by a function of two variables.
void Media()
{
  {
    Pair scene;
    scene.OtherMapper->SetSamplingToCells();
    const double db = scene.Psnr(scene.Mixed());
    CHECK(db >= 60.0 && scene.Errors->Count == 0, "cells: %.1f dB, %s", db, scene.Errors->Text.c_str());
    CHECK(std::string(scene.Multi->GetReason(5)).find("cells") != std::string::npos, "%s", scene.Multi->GetReason(5));
  }
  const double color[4] = { 0.0, 0.9, 0.3, 0.1 }, opacity[2][4] = { { 4.0, 0.0, 80.0, 0.6 }, { 10.0, 0.0, 80.0, 0.3 } };
  stratus_transfer transfers[2];
  vtkNew<vtkColorTransferFunction> red;
  red->AddRGBPoint(color[0], color[1], color[2], color[3]);
  vtkNew<vtkPiecewiseFunction> thin;
  thin->AddPoint(10.0, 0.0);
  thin->AddPoint(80.0, 0.3);
  const auto second = [&](const reference_scene& of) {
    transfers[0] = transfers[1] = of.transfer[0];
    transfers[1].opacity = opacity[1];
    transfers[1].color = color;
    transfers[1].color_count = 1;
  };
  {
    Pair scene;
    const vtkSmartPointer<vtkFloatArray> array = vtkFloatArray::SafeDownCast(scene.OtherImage->GetPointData()->GetScalars());
    vtkNew<vtkFloatArray> two;
    two->SetName("two");
    two->SetNumberOfComponents(2);
    two->SetNumberOfTuples(array->GetNumberOfTuples());
    for (vtkIdType v = 0; v < array->GetNumberOfTuples(); ++v) {
      two->SetTypedComponent(v, 0, array->GetTypedComponent(v, 0));
      two->SetTypedComponent(v, 1, 80.0f - array->GetTypedComponent(v, 0));
    }
    scene.OtherImage->GetPointData()->SetScalars(two);
    vtkVolumeProperty* property = scene.Other->GetProperty();
    property->SetScalarOpacity(1, thin);
    property->SetColor(1, red);
    property->SetScalarOpacityUnitDistance(1, 2.5);
    property->SetInterpolationTypeToLinear();
    const double db = scene.Psnr(scene.Mixed(), nullptr, nullptr, [&](reference_scene& reference, stratus_volume& volume) {
      volume.components = 2;
      volume.value_stride = 2;
      second(reference);
      reference.transfer = transfers;
    });
    CHECK(db >= 60.0 && scene.Errors->Count == 0, "components: %.1f dB, %s", db, scene.Errors->Text.c_str());
  }
  {
    Pair scene;
    vtkNew<vtkImageData> map;
    int n[3];
    scene.OtherImage->GetDimensions(n);
    map->SetDimensions(n);
    map->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
    unsigned char* labels = static_cast<unsigned char*>(map->GetScalarPointer());
    for (vtkIdType v = 0; v < map->GetNumberOfPoints(); ++v) {
      labels[v] = v % n[0] > n[0] / 2 ? 1 : 0;
    }
    scene.OtherMapper->SetMaskInput(map);
    scene.OtherMapper->SetMaskTypeToLabelMap();
    scene.Other->GetProperty()->SetLabelColor(1, red);
    scene.Other->GetProperty()->SetLabelScalarOpacity(1, thin);
    scene.OtherMapper->SetSampleDistance(0.05); // labels are steps, which samples meet to the first order only
    const double db = scene.Psnr(scene.Mixed(), nullptr, nullptr, [&](reference_scene& reference, stratus_volume&) {
      second(reference);
      reference.transfer = transfers;
      reference.labels = labels;
      reference.label_count = 1;
    });
    CHECK(db >= 45.0 && scene.Errors->Count == 0, "labels: %.1f dB, %s", db, scene.Errors->Text.c_str());
  }
  {
    Pair scene;
    const int columns = 48, rows = 24;
    vtkNew<vtkImageData> function;
    function->SetDimensions(columns, rows, 1);
    function->AllocateScalars(VTK_FLOAT, 4);
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < columns; ++i) {
        const double x = (i + 0.5) / columns, y = (j + 0.5) / rows, u = (x - 0.6) / 0.4, v = (y - 0.3) / 0.6;
        const double entry[4] = { x, 1.0 - y, 0.3 + 0.5 * y, std::max(0.0, 0.7 * (1.0 - u * u - v * v)) };
        for (int c = 0; c < 4; ++c) {
          function->SetScalarComponentFromDouble(i, j, 0, c, entry[c]);
        }
      }
    }
    scene.Other->GetProperty()->SetTransferFunctionMode(vtkVolumeProperty::TF_2D);
    scene.Other->GetProperty()->SetTransferFunction2D(function);
    stratus_transfer_2d of = stratus_transfer_2d();
    of.rgba = static_cast<const float*>(function->GetScalarPointer());
    of.columns = columns;
    of.rows = rows;
    scene.OtherImage->GetPointData()->GetScalars()->GetRange(of.value_range);
    of.second_range[1] = 0.25 * (of.value_range[1] - of.value_range[0]);
    of.unit_distance = 2.5;
    const double db =
      scene.Psnr(scene.Mixed(), nullptr, nullptr, [&](reference_scene& reference, stratus_volume&) { reference.transfer_2d = &of; });
    CHECK(db >= 60.0 && scene.Errors->Count == 0, "a function of two variables: %.1f dB, %s", db, scene.Errors->Text.c_str());
  }
}

void Refusals()
{
  const auto refuses = [](const char* words, const std::function<void(Pair&)>& change) {
    Pair scene;
    change(scene);
    scene.Render();
    CHECK(scene.Errors->Count == 1 && scene.Errors->Has(words) && scene.Errors->Has("nothing is drawn"), "%d errors: %s",
      scene.Errors->Count, scene.Errors->Text.c_str());
    scene.Render();
    CHECK(
      scene.Errors->Count == 1 && !scene.Multi->GetLastImage() && std::string(scene.Multi->GetLastError()).find(words) != std::string::npos,
      "reported once: %s", scene.Multi->GetLastError());
  };
  refuses("the volume at port 5: there is no mapper", [](Pair& scene) { scene.Other->SetMapper(nullptr); });
  refuses("the volume at port 5: a mapper of class vtkFixedPoint", [](Pair& scene) {
    vtkNew<vtkFixedPointVolumeRayCastMapper> mapper;
    mapper->SetInputData(scene.OtherImage);
    scene.Other->SetMapper(mapper);
  });
  refuses("mode maximum", [](Pair& scene) { scene.OtherMapper->SetBlendModeToMaximumIntensity(); });
  refuses("mode first-hit", [](Pair& scene) { scene.OtherMapper->SetRenderModeToFirstHit(); });
  refuses("by cells of a volume with a gradient opacity", [](Pair& scene) {
    vtkNew<vtkPiecewiseFunction> steep;
    steep->AddPoint(0.0, 1.0);
    steep->AddPoint(1.0, 0.5);
    scene.OtherMapper->SetSamplingToCells();
    scene.Other->GetProperty()->SetGradientOpacity(steep);
  });
  refuses("mesh 1 of several has mode maximum", [](Pair& scene) {
    const Cells cells;
    cells.Mapper->SetBlendMode(vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND);
    scene.Multi->SetVolume(cells.Volume, 2);
  });
  refuses("is to be projected", [](Pair& scene) {
    const Cells cells;
    cells.Mapper->SetMethodToProject();
    scene.Multi->SetVolume(cells.Volume, 2);
  });
  refuses("the volume at port 2: the input is a", [](Pair& scene) {
    const Cells cells;
    cells.Mapper->SetInputData(static_cast<vtkDataSet*>(scene.OtherImage));
    scene.Multi->SetVolume(cells.Volume, 2);
  });
  refuses("there is no scalar array", [](Pair& scene) { scene.OtherImage->GetPointData()->Initialize(); });
}

// While the window wants many frames a second, fewer rays are cast; the next still picture is exact again.
void Interactive()
{
  Pair scene(400, 300);
  const std::vector<float> exact = scene.Mixed();
  scene.Window->SetDesiredUpdateRate(1e6);
  const std::vector<float> coarse = scene.Mixed();
  CHECK(!exact.empty() && exact != coarse, "a moving picture is as exact as a still one");
  scene.Window->SetDesiredUpdateRate(0.0001);
  CHECK(scene.Mixed() == exact, "a still picture after a moving one is another");
}
} // namespace

int main()
{
  Mixed();
  Ports();
  Interface();
  Geometry();
  Picking();
  Peeling();
  Meshes();
  Surfaces();
  Media();
  Refusals();
  Interactive();
  std::printf("%d failures\n", Failures);
  return Failures != 0;
}
