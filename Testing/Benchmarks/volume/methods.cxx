// SPDX-License-Identifier: BSD-3-Clause
// Makes methods by name, and measures all of them in the same way.
#include "bench.h"
#include "openvdb_mapper.h"
#include "window.h"

#include "vtkStratusVolumeMapper.h"

#include <vtkFixedPointVolumeRayCastMapper.h>
#include <vtkFloatArray.h>
#include <vtkGPUVolumeRayCastMapper.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace bench {

namespace {

const char* const structures[] = { "auto", "none", "block", "distance", "octant", "hybrid" };

// Splits NAME+WINDOW, and tells what the window shows besides the volume. Returns false for other windows.
bool parse_dress(const std::string& whole, std::string& name, dress& d)
{
  const size_t plus = whole.find('+');
  name = whole.substr(0, plus);
  d = dress();
  if (plus == std::string::npos) {
    return true;
  }
  const std::string word = whole.substr(plus + 1);
  const bool all = word == "ordinary";
  d.gradient = all || word == "gradient";
  d.samples = all || word == "samples";
  d.axes = all || word == "axes";
  d.outline = all || word == "outline";
  return d.gradient || d.samples || d.axes || d.outline;
}

// stratus:STRUCTURE[~TOLERANCE][@host|@device]
struct stratus_method {
  int structure = 0;
  std::string tolerance; // a number, or `fixedpoint`; empty: the default
  std::string device;
};

// Returns false for other names.
bool parse_stratus(const std::string& name, stratus_method& m)
{
  if (name.rfind("stratus:", 0) != 0) {
    return false;
  }
  const size_t at = std::min(name.find('@'), name.size());
  const size_t about = std::min(name.find('~'), at);
  const std::string where = name.substr(std::min(at + 1, name.size()));
  const auto found = std::find(std::begin(structures), std::end(structures), name.substr(8, about - 8));
  if (found == std::end(structures) || (at < name.size() && where != "host" && where != "device")) {
    return false;
  }
  m.structure = static_cast<int>(found - std::begin(structures));
  m.tolerance = about < at ? name.substr(about + 1, at - about - 1) : "";
  m.device = where.empty() ? "auto" : where == "device" ? "0" : where;
  char* end = nullptr;
  const bool positive = std::strtod(m.tolerance.c_str(), &end) > 0.0 && *end == '\0';
  return about == at || m.tolerance == "fixedpoint" || positive;
}

vtkSmartPointer<vtkVolumeMapper> make_stratus(const stratus_method& m, double fixed_point_error)
{
  if (m.device == "0" && stratus_device_count() == 0) {
    throw failure("no OpenCL device for @device");
  }
  auto mapper = vtkSmartPointer<vtkStratusVolumeMapper>::New();
  mapper->SetStructure(m.structure);
  mapper->SetDevice(m.device.c_str());
  if (!m.tolerance.empty()) {
    mapper->SetImageErrorTolerance(m.tolerance == "fixedpoint" ? fixed_point_error : std::atof(m.tolerance.c_str()));
  }
  return mapper;
}

// All automatic adjustments are off. step is in world units.
vtkSmartPointer<vtkVolumeMapper> make_fixed_point(double step)
{
  auto mapper = vtkSmartPointer<vtkFixedPointVolumeRayCastMapper>::New();
  mapper->AutoAdjustSampleDistancesOff();
  mapper->LockSampleDistanceToInputSpacingOff();
  mapper->SetImageSampleDistance(1.0f);
  mapper->SetMinimumImageSampleDistance(1.0f);
  mapper->SetMaximumImageSampleDistance(1.0f);
  mapper->SetSampleDistance(static_cast<float>(step));
  mapper->SetInteractiveSampleDistance(static_cast<float>(step));
  return mapper;
}

vtkSmartPointer<vtkVolumeMapper> make_gpu(double step)
{
  auto mapper = vtkSmartPointer<vtkGPUVolumeRayCastMapper>::New();
  mapper->AutoAdjustSampleDistancesOff();
  mapper->LockSampleDistanceToInputSpacingOff();
  mapper->UseJitteringOff();
  mapper->SetImageSampleDistance(1.0f);
  mapper->SetSampleDistance(static_cast<float>(step));
  return mapper;
}

vtkSmartPointer<vtkVolumeMapper> make_mapper(const scene& s, const std::string& method, double fixed_point_error)
{
  stratus_method ours;
  if (parse_stratus(method, ours)) {
    return make_stratus(ours, fixed_point_error);
  }
  if (method == "vtk:fixedpoint" || method == "vtk:fixedpoint:0.5") {
    return make_fixed_point(method == "vtk:fixedpoint" ? s.voxel : 0.5 * s.voxel);
  }
  if (method == "vtk:gpu") {
    return make_gpu(s.voxel);
  }
  if (method == "openvdb") {
    auto mapper = vtkSmartPointer<openvdb_mapper>::New();
    mapper->set_volume(s.volume, s.voxel);
    return mapper;
  }
  throw failure("unknown method " + method);
}

std::vector<float> float_picture(vtkVolumeMapper* mapper, int size)
{
  std::vector<float> rgba;
  if (auto* ours = vtkStratusVolumeMapper::SafeDownCast(mapper)) {
    vtkImageData* image = ours->GetLastImage();
    auto* array = image ? vtkFloatArray::SafeDownCast(image->GetPointData()->GetArray("RGBA")) : nullptr;
    if (!array || array->GetNumberOfValues() != 4 * static_cast<vtkIdType>(size) * size) {
      throw failure("the mapper drew nothing");
    }
    rgba.assign(array->GetPointer(0), array->GetPointer(0) + array->GetNumberOfValues());
  }
  return rgba;
}

double samples_of(vtkVolumeMapper* mapper)
{
  if (auto* ours = vtkStratusVolumeMapper::SafeDownCast(mapper)) {
    return static_cast<double>(ours->GetSamplesTaken());
  }
  if (auto* vdb = openvdb_mapper::SafeDownCast(mapper)) {
    return static_cast<double>(vdb->samples());
  }
  return -1.0;
}

bool draws(const std::vector<uint8_t>& bytes)
{
  return std::any_of(bytes.begin(), bytes.end(), [](uint8_t b) { return b != 0; });
}
} // namespace

std::vector<std::string> all_methods()
{
  return { "stratus:none", "stratus:block", "stratus:distance", "stratus:octant", "stratus:hybrid", "stratus:auto", "stratus:none@device",
    "stratus:auto@device", "stratus:auto+ordinary", "stratus:auto~0.0126", "vtk:fixedpoint", "vtk:fixedpoint:0.5",
    "vtk:fixedpoint+ordinary", "vtk:gpu", "openvdb", "floor", "stratus:auto~fixedpoint" };
}

void check_method(const std::string& whole)
{
  stratus_method ours;
  std::string name;
  dress d;
  static const char* const others[] = { "vtk:fixedpoint", "vtk:fixedpoint:0.5", "vtk:gpu", "openvdb", "floor" };
  const bool dressed = parse_dress(whole, name, d) && (name == whole || name != "floor");
  if (!dressed || (!parse_stratus(name, ours) && std::find(std::begin(others), std::end(others), name) == std::end(others))) {
    throw failure("unknown method '" + whole +
      "'; known: stratus:none|block|distance|octant|hybrid|auto with ~TOLERANCE or ~fixedpoint or neither, and @host or @device or "
      "neither, "
      "vtk:fixedpoint, vtk:fixedpoint:0.5, vtk:gpu, openvdb, floor; all but floor with +ordinary, +gradient, +samples, +axes or +outline");
  }
}

bool needs_fixed_point(const std::string& method)
{
  return method.find("~fixedpoint") != std::string::npos;
}

result run_method(stratus_context* context, const scene& s, const std::string& whole, int size, double fixed_point_error)
{
  result r;
  dress d;
  std::string method;
  parse_dress(whole, method, d);
  r.scene = s.name;
  r.method = whole;
  r.judged = whole == method;
  const vtkSmartPointer<vtkVolumeMapper> mapper = make_mapper(s, method, fixed_point_error);
  window w(context, s, mapper, size, d);
  r.time.first_ms = w.first();
  std::vector<double> frames;
  std::vector<double> samples;
  for (int view = 0; view < views; ++view) {
    std::vector<double> times;
    w.show(view);
    for (int i = 0; i < 3; ++i) {
      times.push_back(w.render());
    }
    frames.push_back(median(times));
    samples.push_back(samples_of(mapper));
    r.pictures.push_back({ float_picture(mapper, size), w.read() });
    if (!draws(r.pictures.back().bytes)) {
      throw failure(method + " shows nothing of " + s.name + " in view " + std::to_string(view));
    }
  }
  std::vector<double> updates;
  for (int view = 0; view < views; ++view) {
    w.show(view);
    w.use(s.edited);
    w.render();
    w.use(s.first);
    updates.push_back(w.render());
  }
  r.time.frame_ms = median(frames);
  r.time.update_ms = median(updates);
  r.time.samples = median(samples);
  if (auto* ours = vtkStratusVolumeMapper::SafeDownCast(mapper)) {
    r.tolerance = ours->GetImageErrorTolerance();
    r.time.device = std::string(ours->GetDeviceName() ? ours->GetDeviceName() : "") + "; " + (ours->GetReason() ? ours->GetReason() : "");
  }
  return r;
}
} // namespace bench
