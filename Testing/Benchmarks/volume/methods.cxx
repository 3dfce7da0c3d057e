// SPDX-License-Identifier: BSD-3-Clause
// Makes methods by name, and measures all of them in the same way.
#include "bench.h"
#include "vdb_mapper.h"
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

constexpr int fewest_updates = 3;        // views
constexpr double slow_update_ms = 150.0; // one such update is enough
const char* const structures[] = { "auto", "none", "block", "distance", "octant", "hybrid" };

// Splits NAME+WINDOW into the name and the window's other contents. Returns false for other windows.
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

// Takes "/PIXELS", the pixels from ray to ray, from the front of a text. Returns false for others than 2 and 4.
bool take_pixels(std::string& text, int& pixels)
{
  if (text.compare(0, 1, "/") != 0) {
    return true;
  }
  pixels = text.compare(1, 1, "2") == 0 ? 2 : text.compare(1, 1, "4") == 0 ? 4 : 0;
  text = text.substr(std::min<size_t>(2, text.size()));
  return pixels > 0;
}

// stratus:STRUCTURE[/PIXELS][~TOLERANCE][@host|@device]
struct stratus_method {
  int structure = 0;
  int image = 1;         // pixels from ray to ray
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
  const size_t slash = std::min(name.find('/'), about);
  const std::string where = name.substr(std::min(at + 1, name.size()));
  const auto found = std::find(std::begin(structures), std::end(structures), name.substr(8, slash - 8));
  std::string pixels = name.substr(slash, about - slash);
  if (found == std::end(structures) || !take_pixels(pixels, m.image) || !pixels.empty() ||
    (at < name.size() && where != "host" && where != "device")) {
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
  mapper->SetImageSampleDistance(m.image);
  if (!m.tolerance.empty()) {
    mapper->SetImageErrorTolerance(m.tolerance == "fixedpoint" ? fixed_point_error : std::atof(m.tolerance.c_str()));
  }
  return mapper;
}

// PEER[/PIXELS][:STEP]
struct peer_method {
  std::string name;
  double step = 1.0; // in voxels
  int image = 1;     // pixels from ray to ray; among peers, only vtk:fixedpoint has values other than 1
};

// Returns false for other names.
bool parse_peer(const std::string& whole, peer_method& m)
{
  static const char* const peers[] = { "vtk:fixedpoint", "vtk:gpu", "openvdb", "nanovdb" };
  const auto found =
    std::find_if(std::begin(peers), std::end(peers), [&](const std::string& peer) { return whole.compare(0, peer.size(), peer) == 0; });
  if (found == std::end(peers)) {
    return false;
  }
  m.name = *found;
  std::string rest = whole.substr(m.name.size());
  if (m.name == "vtk:fixedpoint" && !take_pixels(rest, m.image)) {
    return false;
  }
  if (rest.empty()) {
    return true;
  }
  char* end = nullptr;
  m.step = std::strtod(rest.c_str() + 1, &end);
  return rest[0] == ':' && *end == '\0' && m.step >= 0.01 && m.step <= 100.0;
}

// All automatic adjustments are off. step is in world units, image in pixels.
vtkSmartPointer<vtkVolumeMapper> make_fixed_point(double step, int image)
{
  const auto pixels = static_cast<float>(image);
  auto mapper = vtkSmartPointer<vtkFixedPointVolumeRayCastMapper>::New();
  mapper->AutoAdjustSampleDistancesOff();
  mapper->LockSampleDistanceToInputSpacingOff();
  mapper->SetImageSampleDistance(pixels);
  mapper->SetMinimumImageSampleDistance(pixels);
  mapper->SetMaximumImageSampleDistance(pixels);
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
  peer_method peer;
  if (parse_stratus(method, ours)) {
    return make_stratus(ours, fixed_point_error);
  }
  if (!parse_peer(method, peer)) {
    throw failure("unknown method " + method);
  }
  if (peer.name == "vtk:fixedpoint") {
    return make_fixed_point(peer.step * s.voxel, peer.image);
  }
  if (peer.name == "vtk:gpu") {
    return make_gpu(peer.step * s.voxel);
  }
  auto mapper = vtkSmartPointer<vdb_mapper>::New();
  mapper->set_volume(s.volume, peer.step * s.voxel, peer.name == "nanovdb");
  return mapper;
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
  if (auto* vdb = vdb_mapper::SafeDownCast(mapper)) {
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
    "vtk:fixedpoint+ordinary", "vtk:gpu", "openvdb", "nanovdb", "floor", "stratus:auto~fixedpoint" };
}

std::vector<std::string> curve_methods(bool quick)
{
  std::vector<std::string> methods;
  const auto add = [&](const std::string& name, std::initializer_list<const char*> settings) {
    for (const char* setting : settings) {
      methods.push_back(name + setting);
    }
  };
  if (quick) {
    add("stratus:auto", { "~0.1", "~0.01", "~0.001", "~0.0001" });
    add("stratus:auto/2", { "~0.3", "~0.1" });
    add("stratus:auto/4", { "~0.3" });
    add("stratus:none", { "~0.01", "~0.0001" });
    add("stratus:auto@device", { "" });
    add("vtk:fixedpoint", { ":2", "", ":0.5" });
    add("vtk:fixedpoint/2", { ":2", "" });
    add("vtk:gpu", { ":2", "", ":0.5" });
    add("openvdb", { ":2", "", ":0.5" });
    add("nanovdb", { "" });
    return methods;
  }
  add("stratus:auto",
    { "~0.1", "~0.03", "~0.0126", "~0.01", "~0.003", "~0.001", "~0.001+ordinary", "~0.0003", "~0.0001", "~0.00003", "~0.00001",
      "~fixedpoint" });
  add("stratus:auto/2", { "~0.3", "~0.1", "~0.03" });
  add("stratus:auto/4", { "~0.3", "~0.1" });
  for (const char* structure : structures) {
    if (std::string(structure) != "auto") {
      add(std::string("stratus:") + structure, { "~0.01", "~0.001", "~0.0001" });
    }
  }
  add("stratus:auto", { "~0.01@device", "~0.001@device", "~0.0001@device" });
  add("vtk:fixedpoint", { ":2", "", "+ordinary", ":0.5" });
  add("vtk:fixedpoint/2", { ":2", "", ":0.5" });
  add("vtk:gpu", { ":2", "", ":0.5" });
  add("openvdb", { ":2", "", ":0.5" });
  add("nanovdb", { "" }); // takes openvdb's samples
  return methods;
}

void check_method(const std::string& whole)
{
  stratus_method ours;
  peer_method peer;
  std::string name;
  dress d;
  const bool dressed = parse_dress(whole, name, d) && (name == whole || name != "floor");
  if (!dressed || (!parse_stratus(name, ours) && !parse_peer(name, peer) && name != "floor")) {
    throw failure("unknown method '" + whole +
      "'; known: stratus:none|block|distance|octant|hybrid|auto with /2 or /4 (rays every 2 or 4 pixels) or neither, ~TOLERANCE or "
      "~fixedpoint or neither, and @host or @device or neither, vtk:fixedpoint with /2 or /4 or neither, vtk:gpu, openvdb and nanovdb, "
      "each with "
      ":STEP (.01 to 100 voxels) or without, floor; "
      "all but floor with +ordinary, +gradient, +samples, +axes or +outline");
  }
}

bool needs_fixed_point(const std::string& method)
{
  return method.find("~fixedpoint") != std::string::npos;
}

result run_method(stratus_context* context, const scene& s, const std::string& whole, const effort& how, double fixed_point_error)
{
  result r;
  dress d;
  std::string method;
  parse_dress(whole, method, d);
  r.scene = s.name;
  r.method = whole;
  r.judged = whole == method;
  const vtkSmartPointer<vtkVolumeMapper> mapper = make_mapper(s, method, fixed_point_error);
  window w(context, s, mapper, how.size, d);
  r.time.first_ms = w.first();
  std::vector<double> samples;
  for (int view = 0; view < views; ++view) {
    std::vector<double> times;
    w.show(view);
    do {
      times.push_back(w.render());
    } while (!settled(times, how.repeats));
    r.time.frames.push_back(median(times));
    samples.push_back(samples_of(mapper));
    r.pictures.push_back({ float_picture(mapper, how.size), w.read() });
    if (!draws(r.pictures.back().bytes)) {
      throw failure(method + " shows nothing of " + s.name + " in view " + std::to_string(view));
    }
  }
  std::vector<double> updates;
  const auto enough = [&updates] {
    return settled(updates, views) && (updates.size() >= fewest_updates || updates.back() >= slow_update_ms);
  };
  for (int view = 0; view < views && how.updates && !enough(); ++view) {
    w.show(view);
    w.use(s.edited);
    w.render();
    w.use(s.first);
    updates.push_back(w.render());
  }
  r.time.frame_ms = median(r.time.frames);
  r.time.update_ms = updates.empty() ? -1.0 : median(updates);
  r.time.samples = median(samples);
  if (auto* ours = vtkStratusVolumeMapper::SafeDownCast(mapper)) {
    r.tolerance = ours->GetImageErrorTolerance();
    r.time.device = std::string(ours->GetDeviceName() ? ours->GetDeviceName() : "") + "; " + (ours->GetReason() ? ours->GetReason() : "");
  }
  return r;
}
} // namespace bench
