// SPDX-License-Identifier: BSD-3-Clause
// Times whole frames of all mappers in one window, in turns, so that changes of the machine's speed affect all alike.
#include "tetra_bench.h"

#include "vtkStratusPartitionFilter.h"
#include "vtkStratusTetrahedraMapper.h"
#include "vtkStratusVisibilitySort.h"
#include "vtkStratusVolumeMapper.h"

#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPointData.h>
#include <vtkProjectedTetrahedraMapper.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGridVolumeRayCastMapper.h>
#include <vtkUnstructuredGridVolumeZSweepMapper.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace bench {

namespace {

constexpr double slow_ms = 1500.0; // frames that take longer are drawn once per view

using mapper_pointer = vtkSmartPointer<vtkAbstractVolumeMapper>;

constexpr double resampled_along = 128.0; // points along each axis of an image, where a method names no other number

// tolerance 0: the default.
mapper_pointer make_stratus(const tetra_mesh& mesh, stratus_tetra_method method, const char* device, double tolerance)
{
  auto mapper = vtkSmartPointer<vtkStratusTetrahedraMapper>::New();
  mapper->SetMethod(static_cast<int>(method));
  mapper->SetDevice(device);
  if (tolerance > 0.0) {
    mapper->SetImageErrorTolerance(tolerance);
  }
  mapper->SetInputData(mesh.grid);
  return mapper;
}

// Keeps VTK's default settings, whose sorter is vtkCellCenterDepthSort.
mapper_pointer make_projected(const tetra_mesh& mesh, double)
{
  auto mapper = vtkSmartPointer<vtkProjectedTetrahedraMapper>::New();
  mapper->SetInputData(mesh.grid);
  return mapper;
}

// Depth: of the partition whose leaves are sorted.
template <int Depth> mapper_pointer make_projected_sorted(const tetra_mesh& mesh, double)
{
  auto mapper = vtkSmartPointer<vtkProjectedTetrahedraMapper>::New();
  vtkNew<vtkStratusVisibilitySort> sort;
  mapper->SetVisibilitySort(sort);
  mapper->SetInputData(mesh.grid);
  if (Depth > 0) {
    vtkNew<vtkStratusPartitionFilter> filter;
    filter->SetInputData(mesh.grid);
    filter->SetDepth(Depth);
    filter->Update();
    mapper->SetInputData(filter->GetOutput());
  }
  return mapper;
}

// Makes one of VTK's mappers that draw in lines of pixels. Every frame has rays so many pixels apart (0: 1), all else is VTK's default.
template <typename Mapper> mapper_pointer make_scanning(const tetra_mesh& mesh, double pixels)
{
  auto mapper = vtkSmartPointer<Mapper>::New();
  mapper->AutoAdjustSampleDistancesOff();
  mapper->SetImageSampleDistance(static_cast<float>(std::max(pixels, 1.0)));
  mapper->SetInputData(mesh.grid);
  return mapper;
}

// One line per method. A name with "resample" draws an image of the mesh, make_resampled().
const struct recipe {
  const char* name;
  mapper_pointer (*make)(const tetra_mesh& mesh, double setting); // nullptr: one of Stratus
  const char* sorter;
  stratus_tetra_method method;
  const char* device;
} recipes[] = {
  { "stratus:auto", nullptr, "", STRATUS_TETRA_METHOD_AUTO, "host" },
  { "stratus:march", nullptr, "", STRATUS_TETRA_METHOD_MARCH, "host" },
  { "stratus:project", nullptr, "stratus:sort-1", STRATUS_TETRA_METHOD_PROJECT, "host" },
  { "stratus:march@device", nullptr, "", STRATUS_TETRA_METHOD_MARCH, "0" },
  { "stratus:project@device", nullptr, "", STRATUS_TETRA_METHOD_PROJECT, "0" },
  { "vtk:projected", make_projected, "vtk:depthsort", STRATUS_TETRA_METHOD_AUTO, "" },
  { "vtk:projected+stratus-sort", make_projected_sorted<3>, "stratus:sort", STRATUS_TETRA_METHOD_AUTO, "" },
  { "vtk:projected+stratus-sort-1", make_projected_sorted<0>, "stratus:sort-1", STRATUS_TETRA_METHOD_AUTO, "" },
  { "vtk:raycast", make_scanning<vtkUnstructuredGridVolumeRayCastMapper>, "", STRATUS_TETRA_METHOD_AUTO, "" },
  { "vtk:resample", nullptr, "", STRATUS_TETRA_METHOD_AUTO, "" },
  { "vtk:resample+stratus", nullptr, "", STRATUS_TETRA_METHOD_AUTO, "" },
  { "vtk:zsweep", make_scanning<vtkUnstructuredGridVolumeZSweepMapper>, "", STRATUS_TETRA_METHOD_AUTO, "" },
};

bool resamples(const std::string& method)
{
  return method.rfind("vtk:resample", 0) == 0;
}

// Finds NAME, stratus:NAME~TOLERANCE, vtk:raycast:PIXELS, vtk:zsweep:PIXELS or vtk:resample:POINTS, and its setting; 0: none is named.
const recipe* find(const std::string& whole, double* setting = nullptr)
{
  const bool ours = is_ours(whole);
  const size_t mark = ours ? whole.find('~') : whole.rfind(':');
  std::string name = whole;
  double value = 0.0;
  if (mark != std::string::npos && mark > 3) {
    char* end = nullptr;
    value = std::strtod(whole.c_str() + mark + 1, &end);
    if (*end != '\0' || !(value > 0.0 && value <= (ours ? 1.0 : resamples(whole) ? 1024.0 : 16.0))) {
      return nullptr;
    }
    name.resize(mark);
  }
  if (setting) {
    *setting = value;
  }
  const auto found = std::find_if(std::begin(recipes), std::end(recipes), [&](const recipe& r) { return name == r.name; });
  return found == std::end(recipes) ? nullptr : found;
}

mapper_pointer make_mapper(const tetra_mesh& mesh, const std::string& name, sorter_metrics& more)
{
  double setting = 0.0;
  const recipe& r = *find(name, &setting);
  if (resamples(name)) {
    double ms = 0.0;
    const double along = setting > 0.0 ? setting : resampled_along;
    const bool ours = std::string(r.name) == "vtk:resample+stratus";
    mapper_pointer mapper = make_resampled(mesh, ours, std::max(static_cast<int>(along), 2), &ms);
    more["resample_ms"] = { ms, "ms" };
    more["bytes"] = { 4.0 * along * along * along, "B" };
    return mapper;
  }
  if (r.make) {
    return r.make(mesh, setting);
  }
  if (std::string(r.device) == "0" && stratus_device_count() == 0) {
    throw failure("there is no OpenCL device");
  }
  return make_stratus(mesh, r.method, r.device, setting);
}

// Converts a transfer function for VTK's mappers of tetrahedra. They take opacity as attenuation, where VTK's mappers of images and Stratus
// take it as the absorption over a unit distance. The equivalent attenuation is -ln(1 - opacity); a shorter unit distance scales it to
// VTK's limit of 1. Colours get the same points, because VTK's ray caster ignores all others.
transfer as_attenuation(const transfer& t)
{
  constexpr int parts = 24; // lines that approximate the curve between two points
  transfer same = t;
  same.opacity.clear();
  double most = 0.0;
  const auto add = [&](double x, double opacity) {
    same.opacity.insert(same.opacity.end(), { x, -std::log1p(-opacity) });
    most = std::max(most, same.opacity.back());
  };
  for (size_t i = 0; i + 2 < t.opacity.size(); i += 2) {
    for (int part = 0; part < parts; ++part) {
      const double s = static_cast<double>(part) / parts;
      add((1.0 - s) * t.opacity[i] + s * t.opacity[i + 2], (1.0 - s) * t.opacity[i + 1] + s * t.opacity[i + 3]);
    }
  }
  add(t.opacity[t.opacity.size() - 2], t.opacity.back());
  vtkNew<vtkColorTransferFunction> color;
  for (size_t i = 0; i < t.color.size(); i += 4) {
    color->AddRGBPoint(t.color[i], t.color[i + 1], t.color[i + 2], t.color[i + 3]);
  }
  same.color.clear();
  for (size_t i = 0; i < same.opacity.size(); i += 2) {
    double rgb[3];
    color->GetColor(same.opacity[i], rgb);
    same.color.insert(same.color.end(), { same.opacity[i], rgb[0], rgb[1], rgb[2] });
    same.opacity[i + 1] /= most;
  }
  same.unit_distance = t.unit_distance / most;
  return same;
}

void set_property(vtkVolumeProperty* property, const transfer& t)
{
  vtkNew<vtkPiecewiseFunction> opacity;
  vtkNew<vtkColorTransferFunction> color;
  for (size_t i = 0; i < t.opacity.size(); i += 2) {
    opacity->AddPoint(t.opacity[i], t.opacity[i + 1]);
  }
  for (size_t i = 0; i < t.color.size(); i += 4) {
    color->AddRGBPoint(t.color[i], t.color[i + 1], t.color[i + 2], t.color[i + 3]);
  }
  property->SetScalarOpacity(opacity);
  property->SetColor(color);
  property->SetScalarOpacityUnitDistance(t.unit_distance);
  property->SetInterpolationTypeToLinear();
  property->ShadeOff();
}

class stage
{
public:
  stage(stratus_context* context, const tetra_mesh& mesh, const transfer& t, int size) : Context(context), Mesh(mesh), Size(size)
  {
    this->Window->SetOffScreenRendering(1);
    this->Window->SetMultiSamples(0);
    this->Window->SetAlphaBitPlanes(1);
    this->Window->SetSize(size, size);
    this->Window->AddRenderer(this->Renderer);
    this->Renderer->SetBackground(0, 0, 0);
    this->Renderer->SetBackgroundAlpha(0.0);
    set_property(this->Property, t);
    set_property(this->VtkProperty, as_attenuation(t));
    set_property(this->ImageProperty, transfer_of_image(mesh, t));
    this->Window->Render(); // the window's set-up counts for no method
  }

  void add(const mapper_pointer& mapper)
  {
    vtkNew<vtkVolume> volume;
    volume->SetMapper(mapper);
    const bool image = !vtkUnstructuredGridVolumeMapper::SafeDownCast(mapper);
    volume->SetProperty(image                              ? this->ImageProperty
        : vtkStratusTetrahedraMapper::SafeDownCast(mapper) ? this->Property
                                                           : this->VtkProperty);
    volume->VisibilityOff();
    this->Renderer->AddVolume(volume);
    this->Volumes.emplace_back(volume);
  }

  // Returns the ms of a whole frame. turned: degrees off the standard view, so that no frame reuses the last order.
  double render(size_t method, int view, double turned)
  {
    stratus_camera at;
    if (stratus_scene_camera(this->Context, this->Mesh.bounds, 2, view, 0, 1.0, &at) != STRATUS_OK) {
      throw failure(stratus_context_message(this->Context));
    }
    const double* b = this->Mesh.bounds;
    vtkCamera* camera = this->Renderer->GetActiveCamera();
    camera->SetPosition(at.eye);
    camera->SetFocalPoint(0.5 * (b[0] + b[1]), 0.5 * (b[2] + b[3]), 0.5 * (b[4] + b[5]));
    camera->SetViewUp(0, 0, 1);
    camera->SetViewAngle(21.6);
    camera->Azimuth(turned);
    for (size_t i = 0; i < this->Volumes.size(); ++i) {
      this->Volumes[i]->SetVisibility(i == method);
    }
    this->Renderer->ResetCameraClippingRange();
    const double start = now_ms();
    this->Window->Render();
    this->Window->WaitForCompletion();
    return now_ms() - start;
  }

  tetra_picture read(vtkAbstractVolumeMapper* mapper) const
  {
    tetra_picture picture;
    vtkNew<vtkUnsignedCharArray> pixels;
    this->Window->GetRGBACharPixelData(0, 0, this->Size - 1, this->Size - 1, 0, pixels);
    picture.bytes.assign(pixels->GetPointer(0), pixels->GetPointer(0) + pixels->GetNumberOfValues());
    auto* cells = vtkStratusTetrahedraMapper::SafeDownCast(mapper);
    auto* voxels = vtkStratusVolumeMapper::SafeDownCast(mapper);
    if (cells || voxels) {
      vtkImageData* image = cells ? cells->GetLastImage() : voxels->GetLastImage();
      auto* array = image ? vtkFloatArray::SafeDownCast(image->GetPointData()->GetArray("RGBA")) : nullptr;
      if (!array || array->GetNumberOfValues() != pixels->GetNumberOfValues()) {
        throw failure("the mapper drew nothing");
      }
      picture.rgba.assign(array->GetPointer(0), array->GetPointer(0) + array->GetNumberOfValues());
    }
    return picture;
  }

private:
  stratus_context* Context;
  const tetra_mesh& Mesh;
  int Size;
  vtkNew<vtkRenderWindow> Window;
  vtkNew<vtkRenderer> Renderer;
  vtkNew<vtkVolumeProperty> Property, VtkProperty, ImageProperty;
  std::vector<vtkSmartPointer<vtkVolume>> Volumes;
};

void check_drawn(const frame_result& r, int view)
{
  const std::vector<uint8_t>& bytes = r.pictures.back().bytes;
  if (std::all_of(bytes.begin(), bytes.end(), [](uint8_t b) { return b == 0; })) {
    throw failure(r.method + " shows nothing in view " + std::to_string(view));
  }
}

// Adds the bytes that a picture of Stratus needs, without grid and window, and the picture's cells, segments and build time.
void add_bytes(const tetra_mesh& mesh, const transfer& function, stratus_tetra_method method, int size, sorter_metrics& m)
{
  counted_context counted(0);
  const size_t before = counted.live();
  const stratus_mesh view = mesh.view();
  const stratus_transfer t = function.view();
  std::vector<float> rgba(4 * static_cast<size_t>(size) * static_cast<size_t>(size));
  stratus_tetra_caster* made = nullptr;
  stratus_tetra_report report;
  stratus_tetra_options options = stratus_tetra_options_default();
  stratus_camera camera;
  stratus_image image = {};
  options.method = method;
  image.width = image.height = size;
  image.rgba = rgba.data();
  if (stratus_tetra_caster_create(counted, &made) != STRATUS_OK ||
    stratus_scene_camera(counted, mesh.bounds, 2, 0, 0, 1.0, &camera) != STRATUS_OK) {
    throw failure(stratus_context_message(counted));
  }
  const std::unique_ptr<stratus_tetra_caster, decltype(&stratus_tetra_caster_destroy)> caster(made, &stratus_tetra_caster_destroy);
  if (stratus_tetra_caster_render(made, &view, &t, &camera, &options, &image, &report) != STRATUS_OK) {
    throw failure(stratus_context_message(counted));
  }
  const auto after = static_cast<double>(counted.live() - before), peak = static_cast<double>(counted.peak() - before);
  const auto cells = static_cast<double>(view.cell_count);
  m["cells"] = { cells, "1" };
  m["build_ms"] = { report.build_ms, "ms" };
  m["segments"] = { static_cast<double>(report.segments), "1" };
  m["bytes"] = { after, "B" };
  m["peak_bytes"] = { peak, "B" };
  m["bytes_per_cell"] = { after / cells, "B" };
  m["peak_bytes_per_cell"] = { peak / cells, "B" };
}
} // namespace

const std::vector<std::string>& tetra_mappers()
{
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& r : recipes) {
      all.emplace_back(r.name);
    }
    return all;
  }();
  return names;
}

std::vector<std::string> tetra_curve_methods(bool quick)
{
  if (quick) {
    return { "stratus:auto~0.1", "stratus:auto~0.001", "stratus:auto~0.00001", "vtk:projected", "vtk:raycast:2", "vtk:raycast" };
  }
  return { "stratus:auto~0.1", "stratus:auto~0.01", "stratus:auto~0.001", "stratus:auto~0.0001", "stratus:auto~0.00001",
    "stratus:march~0.01", "stratus:march~0.001", "stratus:march~0.0001", "stratus:project~0.01", "stratus:project~0.001",
    "stratus:project~0.0001", "vtk:projected", "vtk:projected+stratus-sort", "vtk:raycast:4", "vtk:raycast:2", "vtk:raycast" };
}

bool is_tetra_mapper(const std::string& method)
{
  return find(method) != nullptr;
}

std::string sorter_of(const std::string& method)
{
  const recipe* r = find(method);
  return r ? r->sorter : "";
}

std::vector<frame_result> run_mappers(stratus_context* context, const tetra_mesh& mesh, const transfer& function,
  const std::vector<std::string>& methods, int size, int repeats, std::vector<mapper_failure>& failures)
{
  stage s(context, mesh, function, size);
  std::vector<mapper_pointer> mappers;
  std::vector<frame_result> results;
  for (const std::string& method : methods) {
    sorter_metrics more;
    try {
      mappers.push_back(make_mapper(mesh, method, more));
    } catch (const failure& e) {
      failures.push_back({ method, e.what() });
      continue;
    }
    s.add(mappers.back());
    results.emplace_back();
    results.back().method = method;
    results.back().more = more;
  }
  for (size_t m = 0; m < mappers.size(); ++m) {
    results[m].first_ms = s.render(m, 0, 1.0);
  }
  for (int view = 0; view < views; ++view) {
    std::vector<std::vector<double>> times(mappers.size());
    for (int repeat = 1; repeat < repeats; ++repeat) { // turned a little, so that cells are sorted anew
      for (size_t m = 0; m < mappers.size(); ++m) {
        if (results[m].first_ms < slow_ms && !settled(times[m], repeats - 1)) {
          times[m].push_back(s.render(m, view, 0.05 * repeat));
        }
      }
    }
    for (size_t m = 0; m < mappers.size(); ++m) {
      times[m].push_back(s.render(m, view, 0.0));
      results[m].pictures.push_back(s.read(mappers[m]));
      check_drawn(results[m], view);
      results[m].frames.push_back(median(times[m]));
    }
  }
  for (size_t m = 0; m < mappers.size(); ++m) {
    results[m].frame_ms = median(results[m].frames);
    const recipe* r = find(results[m].method);
    if (std::string(r->device) == "host") {
      add_bytes(mesh, function, r->method, size, results[m].more);
    }
  }
  return results;
}
} // namespace bench
