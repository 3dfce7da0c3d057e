// SPDX-License-Identifier: BSD-3-Clause
// Translucent surfaces before, inside and behind a volume, with the renderer's flags of depth peeling. The window is compared with layers
// that this test blends itself. The surfaces cut a volume into layers: the part before a surface is the picture that ends at an opaque
// surface in its place, and an even fog's layers are known. First hits are one layer, at the depth where they begin. If volumes are not
// peeled, a volume covers all surfaces, and volumes cover one another in the order of drawing.
#include "tetrahedra_scene.h"

#include "vtkActor.h"
#include "vtkPlaneSource.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkSphereSource.h"

#include <memory>

namespace {
// Unlit, across the view, from x = -1000 to Edge: part of the pixels have it.
struct Sheet {
  Sheet(Scene& scene, double z, double edge, double red, double green, double blue, double opacity)
      : Z(z), Edge(edge), Color{ red, green, blue, opacity }
  {
    vtkNew<vtkPlaneSource> plane;
    plane->SetOrigin(-1000, -1000, z);
    plane->SetPoint1(edge, -1000, z);
    plane->SetPoint2(-1000, 1000, z);
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(plane->GetOutputPort());
    this->Actor->SetMapper(mapper);
    this->Actor->GetProperty()->LightingOff();
    this->Actor->GetProperty()->SetColor(red, green, blue);
    this->Actor->GetProperty()->SetOpacity(opacity);
    scene.Renderer->AddActor(this->Actor);
  }
  vtkNew<vtkActor> Actor;
  double Z, Edge, Color[4];
};

struct Layer {
  double K;       // distance to the eye's plane
  double Rgba[4]; // premultiplied
};

// One of the renderer's volumes, drawn apart: its picture, and how far away it begins.
struct Drawn {
  std::vector<float> Rgba, Depth;
  std::vector<std::vector<float>> Until; // the picture that ends at each sheet; none: it is not cut
};

Drawn Copy(vtkImageData* image)
{
  Drawn drawn;
  if (image) {
    auto* rgba = vtkFloatArray::SafeDownCast(image->GetPointData()->GetArray("RGBA"));
    auto* depth = vtkFloatArray::SafeDownCast(image->GetPointData()->GetArray("Depth"));
    drawn.Rgba.assign(rgba->GetPointer(0), rgba->GetPointer(0) + rgba->GetNumberOfValues());
    drawn.Depth.assign(depth->GetPointer(0), depth->GetPointer(0) + depth->GetNumberOfValues());
  }
  return drawn;
}

using Sheets = std::vector<std::unique_ptr<Sheet>>;

struct Flags {
  bool Peeling, ForVolumes;
  int Samples;
};

const double Ground[3] = { 0.25, 0.5, 0.125 };

// Computes the layers' colour at a pixel. Returns false if the pixel is too near to a sheet's edge or to its crossing with a volume's first
// depth.
bool Expect(const stratus_camera& camera, const int size[2], size_t pixel, const Sheets& sheets, const std::vector<Drawn>& volumes,
  bool peeled, double opaqueK, double color[3])
{
  const double u = (2.0 * static_cast<double>(pixel % size[0]) + 1.0) / size[0] - 1.0;
  const double v = (2.0 * static_cast<double>(pixel / size[0]) + 1.0) / size[1] - 1.0;
  double along[3], square = 0.0;
  for (int a = 0; a < 3; ++a) {
    along[a] = camera.forward[a] + (camera.parallel ? 0.0 : u * camera.right[a] + v * camera.up[a]);
    square += along[a] * along[a];
  }
  const double beginX = camera.eye[0] + (camera.parallel ? u * camera.right[0] + v * camera.up[0] : 0.0);
  std::vector<Layer> layers;
  std::vector<double> begins;
  const auto crossing = [&](const Sheet& sheet) { return (sheet.Z - camera.eye[2]) / along[2]; };
  std::vector<std::pair<double, size_t>> cuts; // of the sheets that the ray meets, nearest first
  for (size_t n = 0; n < sheets.size(); ++n) {
    const double k = crossing(*sheets[n]);
    if (beginX + k * along[0] < sheets[n]->Edge && k < opaqueK) {
      cuts.emplace_back(k, n);
    }
  }
  std::sort(cuts.begin(), cuts.end());
  for (const Drawn& volume : volumes) {
    const float* rgba = &volume.Rgba[4 * pixel];
    if (peeled && !volume.Until.empty()) {
      double before[4] = { 0, 0, 0, 0 };
      for (size_t n = 0; n <= cuts.size(); ++n) {
        const float* now = n < cuts.size() ? &volume.Until[cuts[n].second][4 * pixel] : rgba;
        Layer layer = { n < cuts.size() ? cuts[n].first - 1e-6 : HUGE_VAL, {} };
        for (int c = 0; c < 4 && before[3] < 1.0; ++c) {
          layer.Rgba[c] = (now[c] - before[c]) / (1.0 - before[3]);
        }
        layers.push_back(layer);
        std::copy(now, now + 4, before);
      }
      continue;
    }
    const double k = volume.Depth[pixel] / std::sqrt(square);
    if (rgba[3] > 0.0f) {
      begins.push_back(k);
      layers.push_back({ peeled ? k : -1.0, { rgba[0], rgba[1], rgba[2], rgba[3] } });
    }
  }
  for (const auto& sheet : sheets) {
    const double k = crossing(*sheet);
    const double x = beginX + k * along[0];
    if (std::fabs(x - sheet->Edge) < 0.5) {
      return false;
    }
    for (double begin : begins) {
      if (std::fabs(begin - k) < 1e-3) {
        return false;
      }
    }
    if (x < sheet->Edge && k < opaqueK) {
      const double* c = sheet->Color;
      layers.push_back({ k, { c[0] * c[3], c[1] * c[3], c[2] * c[3], c[3] } });
    }
  }
  std::stable_sort(layers.begin(), layers.end(), [](const Layer& a, const Layer& b) { return a.K > b.K; });
  for (const Layer& layer : layers) {
    for (int c = 0; c < 3; ++c) {
      color[c] = layer.Rgba[c] + (1.0 - layer.Rgba[3]) * color[c];
    }
  }
  return true;
}

// Along -z from before the volume.
void Look(Scene& scene, bool parallel)
{
  vtkCamera* camera = scene.Renderer->GetActiveCamera();
  camera->SetParallelProjection(parallel);
  camera->SetFocalPoint(14, 14, 13);
  camera->SetPosition(14, 14, 120);
  camera->SetViewUp(0, 1, 0);
  camera->SetViewAngle(20);
  camera->SetParallelScale(18);
  camera->SetClippingRange(20, 200);
}

// The window without sheets and volumes, and its depths: NaN at the edges of opaque things. Lost: VTK itself shows no sheet, with or
// without volumes. VTK 9.1 does so if it peels and the window has several samples a pixel.
struct Backdrop {
  std::vector<unsigned char> Bytes;
  std::vector<double> K;
  bool Lost = false;
};

Backdrop DrawBackdrop(Scene& scene, const Sheets& sheets, const std::vector<vtkVolume*>& volumes)
{
  const auto show = [&](bool sheetsShown, bool volumesShown) {
    for (const auto& sheet : sheets) {
      sheet->Actor->SetVisibility(sheetsShown);
    }
    for (vtkVolume* volume : volumes) {
      volume->SetVisibility(volumesShown);
    }
    scene.Render();
    return scene.Bytes();
  };
  Backdrop backdrop;
  const std::vector<unsigned char> withSheets = show(true, false);
  backdrop.Bytes = show(false, false);
  backdrop.Lost = withSheets == backdrop.Bytes;
  backdrop.K.resize(scene.Pixels());
  const int* size = scene.Renderer->GetSize();
  const int* origin = scene.Renderer->GetOrigin();
  std::vector<float> z(scene.Pixels());
  scene.Window->GetZbufferData(origin[0], origin[1], origin[0] + size[0] - 1, origin[1] + size[1] - 1, z.data());
  vtkCamera* camera = scene.Renderer->GetActiveCamera();
  const double near = camera->GetClippingRange()[0], far = camera->GetClippingRange()[1];
  for (int j = 0; j < size[1]; ++j) {
    for (int i = 0; i < size[0]; ++i) {
      const size_t p = static_cast<size_t>(j) * size[0] + i;
      const double w = camera->GetParallelProjection() ? near + z[p] * (far - near) : near * far / (far - z[p] * (far - near));
      bool edge = false;
      for (int q = 0; q < 4; ++q) {
        const int x = std::min(std::max(i + (q == 0) - (q == 1), 0), size[0] - 1),
                  y = std::min(std::max(j + (q == 2) - (q == 3), 0), size[1] - 1);
        edge = edge || (z[static_cast<size_t>(y) * size[0] + x] < 1.0f) != (z[p] < 1.0f);
      }
      backdrop.K[p] = edge ? std::nan("") : z[p] < 1.0f ? w : HUGE_VAL;
    }
  }
  show(true, true);
  return backdrop;
}

// Draws the volumes up to each sheet, which is opaque then and the only one.
void DrawUntil(Scene& scene, const Sheets& sheets, std::vector<Drawn>& drawn, const std::function<std::vector<Drawn>()>& pictures)
{
  const int peeling = scene.Renderer->GetUseDepthPeeling();
  scene.Renderer->SetUseDepthPeeling(0);
  for (const auto& one : sheets) {
    for (const auto& sheet : sheets) {
      sheet->Actor->SetVisibility(sheet == one);
    }
    one->Actor->GetProperty()->SetOpacity(1);
    scene.Render();
    const std::vector<Drawn> until = pictures();
    for (size_t n = 0; n < drawn.size(); ++n) {
      drawn[n].Until.push_back(until[n].Rgba);
    }
    one->Actor->GetProperty()->SetOpacity(one->Color[3]);
  }
  for (const auto& sheet : sheets) {
    sheet->Actor->VisibilityOn();
  }
  scene.Renderer->SetUseDepthPeeling(peeling);
  scene.Render();
}

// Two frames of the scene against the layers. pictures: of the volumes, in the order in which they are drawn.
void Judge(Scene& scene, const std::string& name, const Flags& flags, const Sheets& sheets, const std::vector<vtkVolume*>& volumes,
  const std::function<std::vector<Drawn>()>& pictures, bool parallel = false, bool cut = true)
{
  scene.Renderer->SetBackground(Ground[0], Ground[1], Ground[2]);
  scene.Window->SetMultiSamples(flags.Samples);
  scene.Renderer->SetUseDepthPeeling(flags.Peeling);
  scene.Renderer->SetUseDepthPeelingForVolumes(flags.ForVolumes);
  scene.Renderer->SetMaximumNumberOfPeels(20);
  Look(scene, parallel);
  const Backdrop backdrop = DrawBackdrop(scene, sheets, volumes);
  scene.Render();
  const std::vector<unsigned char> first = scene.Bytes();
  scene.Render();
  const std::vector<unsigned char> shown = scene.Bytes();
  CHECK(first == shown, "%s: two frames of one scene differ", name.c_str());
  std::vector<Drawn> drawn = pictures();
  if (cut) {
    DrawUntil(scene, sheets, drawn, pictures);
  }
  const stratus_camera camera = ReferenceCamera(scene.Renderer);
  const int* size = scene.Renderer->GetSize();
  const Sheets none;
  const bool peeled = flags.Peeling && flags.ForVolumes && !backdrop.Lost;
  size_t judged = 0, lit = 0;
  double worst = 0.0;
  for (size_t p = 0; p < scene.Pixels(); ++p) {
    double color[3];
    for (int c = 0; c < 3; ++c) {
      color[c] = backdrop.Bytes[4 * p + c] / 255.0;
    }
    if (std::isnan(backdrop.K[p]) || !Expect(camera, size, p, backdrop.Lost ? none : sheets, drawn, peeled, backdrop.K[p], color)) {
      continue;
    }
    ++judged;
    for (const Drawn& volume : drawn) {
      lit += volume.Rgba[4 * p + 3] > 0.1f;
    }
    for (int c = 0; c < 3; ++c) {
      worst = std::max(worst, std::fabs(255.0 * color[c] - shown[4 * p + c]));
    }
  }
  // Each layer is blended over another in bytes, and the backdrop counts as a layer, too.
  const size_t layers = cut && peeled ? drawn.size() * (sheets.size() + 1) : drawn.size();
  const double bar = 0.51 * static_cast<double>(sheets.size() + layers + 2);
  std::printf("%s, peeling %d, for volumes %d, %d samples, %s: %.2f of 255, bar %.2f, %zu pixels, %zu lit%s\n", name.c_str(), flags.Peeling,
    flags.ForVolumes, scene.Window->GetMultiSamples(), parallel ? "parallel" : "perspective", worst, bar, judged, lit,
    backdrop.Lost ? ", sheets lost by VTK" : "");
  CHECK(!backdrop.Lost || flags.Samples > 0, "%s: VTK shows no sheet at all", name.c_str());
  CHECK(worst <= bar, "%s: %.2f of 255 off", name.c_str(), worst);
  CHECK(judged > scene.Pixels() / 2 && lit > 500, "%s: %zu pixels judged, %zu lit, too few to prove anything", name.c_str(), judged, lit);
}

const Flags AllFlags[] = { { true, true, 0 }, { true, true, 4 }, { true, false, 0 }, { true, false, 4 }, { false, true, 0 },
  { false, false, 4 } };

// A sheet of three colours: before the volume, in its midst and behind it. The volume fills 0..26.4 along z.
void OneSheet()
{
  for (const Flags& flags : AllFlags) {
    for (double z : { 40.0, 13.0, -5.0 }) {
      Scene scene;
      Sheets sheets;
      sheets.emplace_back(new Sheet(scene, z, 14, 0.9, 0.1, 0.2, 0.4));
      Judge(scene, "a sheet at " + std::to_string(z), flags, sheets, { scene.Volume },
        [&] { return std::vector<Drawn>{ Copy(scene.Mapper->GetLastImage()) }; });
    }
  }
}

// More sheets than two, also more than peels, and opaque geometry in the volume.
void ManySheets(bool parallel)
{
  for (int samples : { 0, 4 }) {
    Scene scene;
    scene.Renderer->SetMaximumNumberOfPeels(20);
    Sheets sheets;
    const double z[] = { 36, 30, 24, 19, 14, 9, 4, -2, -6 };
    for (int n = 0; n < 9; ++n) {
      sheets.emplace_back(new Sheet(scene, z[n], 6 + 2 * n, n % 3 == 0, n % 3 == 1, n % 2, 0.2));
    }
    vtkNew<vtkSphereSource> sphere;
    sphere->SetCenter(17, 14, 8);
    sphere->SetRadius(6);
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(sphere->GetOutputPort());
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    scene.Renderer->AddActor(actor);
    Judge(
      scene, "nine sheets and a ball", { true, true, samples }, sheets, { scene.Volume },
      [&] { return std::vector<Drawn>{ Copy(scene.Mapper->GetLastImage()) }; }, parallel);
  }
}

// Two volumes, one before the other, added in either order: neither ends the other's rays, for any number of samples. A sheet is between
// them and other sheets are around; or both are between two sheets, which are the first, the middle or the last two of four.
void TwoVolumes(bool shared, const std::vector<double>& around = {})
{
  for (int samples : { 0, 4 }) {
    for (double z : { 30.0, -30.0 }) {
      Scene scene;
      vtkNew<vtkStratusVolumeMapper> mapper;
      mapper->SetInputData(scene.Image);
      mapper->SetDevice("host");
      vtkNew<vtkVolume> other;
      other->SetMapper(shared ? scene.Mapper.Get() : mapper.Get());
      other->SetProperty(scene.Volume->GetProperty());
      other->SetPosition(4, 3, z);
      scene.Renderer->AddVolume(other);
      Sheets sheets;
      int n = 0;
      for (double at : around.empty() ? std::vector<double>{ 62.0, z > 0 ? 28.0 : -1.0, -33.0 } : around) {
        sheets.emplace_back(new Sheet(scene, at, n == 1 ? 100 : 10 + 5 * n, n == 0, n == 1, n == 2, 0.3));
        ++n;
      }
      // From back to front, in whatever order they were added. A mapper that is shared has the last picture, which is the nearer volume's:
      // the other is drawn apart, by a mapper of its own.
      vtkVolume* const back = z > 0.0 ? scene.Volume.Get() : other.Get();
      const auto pictures = [&] {
        std::vector<Drawn> drawn{ Copy(scene.Mapper->GetLastImage()), Copy(mapper->GetLastImage()) };
        if (shared) {
          drawn[1] = drawn[0];
          back->SetMapper(mapper);
          scene.Render();
          drawn[0] = Copy(mapper->GetLastImage());
          back->SetMapper(scene.Mapper);
        } else if (z < 0.0) {
          std::swap(drawn[0], drawn[1]);
        }
        return drawn;
      };
      Judge(
        scene, shared ? "two volumes of one mapper" : "two volumes", { true, true, samples }, sheets, { scene.Volume, other }, pictures);
      float depth = 0.0f;
      const int* size = scene.Renderer->GetSize();
      scene.Window->GetZbufferData(size[0] / 2, size[1] / 2, size[0] / 2, size[1] / 2, &depth);
      CHECK(depth == 1.0f, "volumes have written a depth of %g", static_cast<double>(depth));
    }
  }
}

// First hits, and a renderer in a part of the window.
void OtherPictures()
{
  const Flags flags = { true, true, 0 };
  const auto judge = [&](const char* name, bool cut, const std::function<void(Scene&)>& change) {
    Scene scene;
    change(scene);
    Sheets sheets;
    sheets.emplace_back(new Sheet(scene, 40, 12, 0.9, 0.1, 0.2, 0.4));
    sheets.emplace_back(new Sheet(scene, 12, 20, 0.1, 0.9, 0.2, 0.4));
    Judge(
      scene, name, flags, sheets, { scene.Volume }, [&] { return std::vector<Drawn>{ Copy(scene.Mapper->GetLastImage()) }; }, false, cut);
  };
  judge("first hits", false, [](Scene& scene) { scene.Mapper->SetRenderModeToFirstHit(); });
  judge("a part of the window", true, [](Scene& scene) { scene.Renderer->SetViewport(0.25, 0.125, 1, 0.875); });
}

void Tetrahedra()
{
  for (const Flags& flags : AllFlags) {
    for (double z : { 8.0, 3.0, -2.0 }) {
      GridScene scene;
      scene.Volume->SetScale(4);
      scene.Volume->SetPosition(2, 2, 0);
      Sheets sheets;
      sheets.emplace_back(new Sheet(scene, 4 * z, 14, 0.9, 0.1, 0.2, 0.4));
      Judge(scene, "tetrahedra, a sheet at " + std::to_string(4 * z), flags, sheets, { scene.Volume },
        [&] { return std::vector<Drawn>{ Copy(scene.Tetrahedra->GetLastImage()) }; });
      CHECK(scene.GridErrors->Count == 0, "%s", scene.GridErrors->Text.c_str());
    }
  }
}

// An even fog before and behind a sheet, by the law of absorption.
void Fog()
{
  for (const double z : { 2.0, 7.0, 12.5 }) {
    Scene scene;
    vtkNew<vtkImageData> image;
    image->SetDimensions(15, 15, 15); // 0..28 along x and y, 0..14 along z
    image->SetSpacing(2, 2, 1);
    image->AllocateScalars(VTK_FLOAT, 1);
    image->GetPointData()->GetScalars()->FillComponent(0, 1.0);
    scene.Mapper->SetInputData(image);
    vtkVolumeProperty* look = scene.Volume->GetProperty();
    look->SetScalarOpacityUnitDistance(1);
    look->GetScalarOpacity()->RemoveAllPoints();
    look->GetScalarOpacity()->AddPoint(0, 0.1);
    look->GetScalarOpacity()->AddPoint(2, 0.1);
    look->GetRGBTransferFunction()->RemoveAllPoints();
    look->GetRGBTransferFunction()->AddRGBPoint(0, 0.2, 0.4, 1);
    Sheets sheets;
    sheets.emplace_back(new Sheet(scene, z, 1000, 0.9, 0.1, 0.2, 0.5));
    scene.Renderer->SetBackground(0, 0, 0);
    scene.Window->SetMultiSamples(0);
    scene.Renderer->SetUseDepthPeeling(1);
    scene.Renderer->SetUseDepthPeelingForVolumes(true);
    Look(scene, true);
    scene.Render();
    const std::vector<unsigned char> shown = scene.Bytes();
    const int* size = scene.Renderer->GetSize();
    const size_t middle = 4 * (static_cast<size_t>(size[1] / 2) * static_cast<size_t>(size[0]) + static_cast<size_t>(size[0] / 2));
    const double fog[3] = { 0.2, 0.4, 1 }, sheet[3] = { 0.9, 0.1, 0.2 };
    const double before = 1 - std::pow(0.9, 14 - z), behind = 1 - std::pow(0.9, z);
    for (size_t c = 0; c < 3; ++c) {
      const double right = fog[c] * before + (1 - before) * (0.5 * sheet[c] + 0.5 * fog[c] * behind);
      CHECK(std::fabs(255 * right - shown[middle + c]) < 2.1, "fog cut at %g: channel %zu is %d, not %.1f", z, c, shown[middle + c],
        255 * right);
    }
  }
}

// A frame's later draws repeat neither an error nor what was drawn before it.
void Errors()
{
  Scene scene;
  Look(scene, false);
  Sheets sheets;
  sheets.emplace_back(new Sheet(scene, 40, 12, 0.9, 0.1, 0.2, 0.4));
  scene.Renderer->SetUseDepthPeeling(1);
  scene.Renderer->SetUseDepthPeelingForVolumes(true);
  vtkNew<vtkImageData> none;
  scene.Render();
  scene.Mapper->SetInputData(none);
  scene.Render();
  CHECK(scene.Errors->Count == 1, "an empty volume between peels is reported %d times, not once", scene.Errors->Count);
  const std::vector<unsigned char> without = scene.Bytes();
  scene.Volume->VisibilityOff();
  scene.Render();
  CHECK(without == scene.Bytes(), "the picture before the error is still shown");
  scene.Volume->VisibilityOn();
  scene.Mapper->SetInputData(scene.Image);
  scene.Render();
  CHECK(scene.Light() > 10.0, "nothing is drawn after an error");
}
} // namespace

int main()
{
  OneSheet();
  ManySheets(false);
  ManySheets(true);
  TwoVolumes(false);
  TwoVolumes(true);
  TwoVolumes(false, { 62.0, -34.0, -36.0, -38.0 });
  TwoVolumes(false, { 66.0, 62.0, -34.0, -36.0 });
  TwoVolumes(false, { 70.0, 66.0, 62.0, -34.0 });
  OtherPictures();
  Tetrahedra();
  Fog();
  Errors();
  return Failures == 0 ? 0 : 1;
}
