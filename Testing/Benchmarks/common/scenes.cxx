// SPDX-License-Identifier: BSD-3-Clause
#include "bench.h"
#include "input.h"

#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkResampleToImage.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnsignedShortArray.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace bench {

stratus_transfer transfer::view() const
{
  stratus_transfer t = stratus_transfer_default();
  t.opacity = this->opacity.data();
  t.opacity_count = this->opacity.size() / 2;
  t.color = this->color.data();
  t.color_count = this->color.size() / 4;
  t.unit_distance = this->unit_distance;
  return t;
}

namespace {

void check(stratus_context* context, stratus_status status, const std::string& what)
{
  if (status != STRATUS_OK) {
    throw failure(what + ": " + stratus_status_name(status) + ": " + stratus_context_message(context));
  }
}

transfer own(const stratus_transfer& t)
{
  transfer result;
  result.opacity.assign(t.opacity, t.opacity + 2 * t.opacity_count);
  result.color.assign(t.color, t.color + 4 * t.color_count);
  result.unit_distance = t.unit_distance;
  return result;
}

// Wraps values in an array that does not own them.
vtkSmartPointer<vtkDataArray> wrap_values(const stratus_volume& v)
{
  const vtkIdType count = v.dimensions[0] * v.dimensions[1] * v.dimensions[2] * v.components;
  vtkSmartPointer<vtkDataArray> array;
  void* values = const_cast<void*>(v.values);
  if (v.type == STRATUS_UINT8) {
    auto bytes = vtkSmartPointer<vtkUnsignedCharArray>::New();
    bytes->SetArray(static_cast<unsigned char*>(values), count, 1);
    array = bytes;
  } else if (v.type == STRATUS_UINT16) {
    auto shorts = vtkSmartPointer<vtkUnsignedShortArray>::New();
    shorts->SetArray(static_cast<unsigned short*>(values), count, 1);
    array = shorts;
  } else if (v.type == STRATUS_FLOAT32) {
    auto floats = vtkSmartPointer<vtkFloatArray>::New();
    floats->SetArray(static_cast<float*>(values), count, 1);
    array = floats;
  } else {
    throw failure("a scene of a type that the bench does not know");
  }
  array->SetNumberOfComponents(v.components);
  array->SetName("values");
  return array;
}

vtkSmartPointer<vtkImageData> wrap(const stratus_volume& v)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(static_cast<int>(v.dimensions[0]), static_cast<int>(v.dimensions[1]), static_cast<int>(v.dimensions[2]));
  image->SetSpacing(v.spacing);
  image->SetOrigin(v.origin);
  image->GetPointData()->SetScalars(wrap_values(v));
  return image;
}

// Makes the grid of a scene with coordinates, and the image that VTK resamples it to: along stretched axes with `finer` times as many
// cells.
void wrap_grid(scene& s, int finer)
{
  const stratus_volume& v = s.volume;
  vtkNew<vtkDoubleArray> axes[3];
  int n[3];
  for (int a = 0; a < 3; ++a) {
    n[a] = static_cast<int>(v.dimensions[a]);
    for (int i = 0; i < n[a]; ++i) {
      axes[a]->InsertNextValue(v.origin[a] + (v.coordinates[a] ? v.coordinates[a][i] : v.spacing[a] * i));
    }
  }
  s.grid = vtkSmartPointer<vtkRectilinearGrid>::New();
  s.grid->SetDimensions(n);
  s.grid->SetXCoordinates(axes[0]);
  s.grid->SetYCoordinates(axes[1]);
  s.grid->SetZCoordinates(axes[2]);
  s.grid->GetPointData()->SetScalars(wrap_values(v));
  const auto start = std::chrono::steady_clock::now();
  vtkNew<vtkResampleToImage> resampled;
  resampled->SetInputDataObject(s.grid);
  for (int a = 0; a < 3; ++a) {
    n[a] = v.coordinates[a] ? (n[a] - 1) * finer + 1 : n[a];
  }
  resampled->SetSamplingDimensions(n);
  resampled->Update();
  s.resample_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  s.image = vtkSmartPointer<vtkImageData>::New();
  s.image->CopyStructure(resampled->GetOutput());
  s.image->GetPointData()->SetScalars(resampled->GetOutput()->GetPointData()->GetArray("values"));
}

// Resamples a scene over the same space by linear interpolation.
void resample(scene& s, int64_t along)
{
  const stratus_volume from = s.volume;
  const int64_t n[3] = { along, along / 2, along };
  auto values = std::make_shared<std::vector<float>>(static_cast<size_t>(n[0] * n[1] * n[2]));
  const float* in = static_cast<const float*>(from.values);
  double scale[3];
  for (int a = 0; a < 3; ++a) {
    scale[a] = static_cast<double>(from.dimensions[a] - 1) / static_cast<double>(n[a] - 1);
    s.volume.dimensions[a] = n[a];
    s.volume.spacing[a] = from.spacing[a] * scale[a];
  }
#pragma omp parallel for
  for (int64_t at = 0; at < n[0] * n[1] * n[2]; ++at) {
    const int64_t place[3] = { at % n[0], at / n[0] % n[1], at / n[0] / n[1] };
    int64_t i[3];
    double t[3];
    for (int a = 0; a < 3; ++a) {
      const double x = static_cast<double>(place[a]) * scale[a];
      i[a] = std::min(static_cast<int64_t>(x), from.dimensions[a] - 2);
      t[a] = x - static_cast<double>(i[a]);
    }
    double value = 0.0;
    for (int c = 0; c < 8; ++c) {
      const double weight = (c & 1 ? t[0] : 1 - t[0]) * (c & 2 ? t[1] : 1 - t[1]) * (c & 4 ? t[2] : 1 - t[2]);
      value += weight *
        static_cast<double>(in[((i[2] + (c >> 2)) * from.dimensions[1] + i[1] + (c >> 1 & 1)) * from.dimensions[0] + i[0] + (c & 1)]);
    }
    (*values)[static_cast<size_t>(at)] = static_cast<float>(value);
  }
  s.volume.values = values->data();
  s.memory = values;
}

scene scene_of_record(stratus_context* context, const std::string& name)
{
  scene s;
  stratus_scene* made = nullptr;
  check(context, stratus_scene_create(context, name.c_str(), &made), "scene " + name);
  s.memory = std::shared_ptr<void>(made, [context](void* p) { stratus_scene_destroy(context, static_cast<stratus_scene*>(p)); });
  s.name = name;
  s.volume = made->volume;
  s.first = own(made->transfer);
  s.edited = own(made->edited);
  for (int c = 1; c < s.volume.components; ++c) {
    s.others.push_back(own(made->transfers[c]));
  }
  s.up_axis = made->up_axis;
  return s;
}

// Makes the scene of a file. Its transfer functions are isabel's: points are shares of the scalar range, opacity is per spacing.
scene scene_of_file(const std::string& path)
{
  scene s;
  bool on_cells = false;
  s.image = cli::read_image(path);
  vtkDataArray* array = cli::choose_array(s.image, "", on_cells);
  if (on_cells) {
    throw failure(path + ": the bench's peers draw point data only");
  }
  s.image->GetPointData()->SetActiveScalars(array->GetName());
  s.volume = cli::view_of(s.image, array, on_cells);
  double range[2];
  array->GetFiniteRange(range);
  const double lo = range[0];
  const double width = range[1] - range[0];
  s.first.opacity = { lo, 0, lo + .3 * width, 0, lo + width, .6 };
  s.first.color = { lo, .1, .2, .8, lo + .5 * width, .9, .9, .3, lo + width, .9, .1, .1 };
  s.first.unit_distance = s.image->GetSpacing()[0];
  s.edited = s.first;
  s.edited.opacity = { lo, 0, lo + .2 * width, 0, lo + .5 * width, .2, lo + width, .4 };
  s.name = path.substr(path.find_last_of('/') + 1);
  s.name = s.name.substr(0, s.name.find_last_of('.'));
  return s;
}
} // namespace

scene make_scene(stratus_context* context, const std::string& whole)
{
  scene s;
  const size_t plus = whole.rfind("+shade");
  const bool shaded = plus != std::string::npos && plus + 6 == whole.size();
  std::string source = shaded ? whole.substr(0, plus) : whole;
  int finer = 1;
  const size_t colon = source.rfind(':');
  if (colon != std::string::npos && source.rfind("cumulus-rectilinear", 0) == 0) {
    finer = std::atoi(source.c_str() + colon + 1);
    source.erase(colon);
    if (finer < 1 || finer > 16) {
      throw failure("scene " + whole + ": cumulus-rectilinear:K takes K within 1..16");
    }
  }
  if (source.find_first_of("./") != std::string::npos) {
    s = scene_of_file(source);
  } else if (source.rfind("cloud-", 0) == 0) {
    const int along = std::atoi(source.c_str() + 6);
    if (along < 16 || along > 1024) {
      throw failure("scene " + source + ": cloud-N takes N within 16..1024");
    }
    s = scene_of_record(context, "cloud");
    resample(s, along);
    s.name = source;
  } else {
    s = scene_of_record(context, source);
  }
  if (s.volume.coordinates[0] || s.volume.coordinates[1] || s.volume.coordinates[2]) {
    wrap_grid(s, finer);
    s.name += finer > 1 ? ":" + std::to_string(finer) : "";
  } else if (!s.image) {
    s.image = wrap(s.volume);
  }
  if (shaded) {
    s.shaded = true;
    s.name += "+shade";
  }
  s.voxel = std::min({ s.volume.spacing[0], s.volume.spacing[1], s.volume.spacing[2] });
  check(context, stratus_volume_bounds(context, &s.volume, s.bounds), "bounds");
  return s;
}

std::vector<stratus_transfer> transfers_of(const scene& s)
{
  std::vector<stratus_transfer> all = { s.first.view() };
  for (const transfer& t : s.others) {
    all.push_back(t.view());
  }
  return all;
}

stratus_shading shading_of(const stratus_camera& camera)
{
  stratus_shading shading = stratus_ray_cast_options_default().light.shading;
  shading.ambient = 0.1;
  shading.diffuse = 0.7;
  shading.specular = 0.2;
  shading.specular_power = 10.0;
  shading.light_count = 1;
  shading.lights[0] = stratus_light();
  for (int a = 0; a < 3; ++a) {
    shading.lights[0].vector[a] = -camera.forward[a];
    shading.lights[0].color[a] = 1.0;
  }
  return shading;
}

stratus_camera camera_of(stratus_context* context, const scene& s, int view)
{
  stratus_camera camera;
  check(context, stratus_scene_camera(context, s.bounds, s.up_axis, view, 0, 1.0, &camera), "camera");
  return camera;
}

double median(std::vector<double> values)
{
  if (values.empty()) {
    return 0.0;
  }
  std::sort(values.begin(), values.end());
  const size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

bool settled(const std::vector<double>& ms, int most)
{
  constexpr double narrow = 0.03, long_ms = 150.0;
  const size_t count = ms.size(), beyond = count / 4;
  if (count >= static_cast<size_t>(most) || std::accumulate(ms.begin(), ms.end(), 0.0) >= long_ms) {
    return count > 0;
  }
  std::vector<double> sorted = ms;
  std::sort(sorted.begin(), sorted.end());
  return count >= 2 && sorted[count - 1 - beyond] - sorted[beyond] <= narrow * median(ms);
}
} // namespace bench
