// SPDX-License-Identifier: BSD-3-Clause
// open_vkl SCENE...: draws scenes of record with Stratus and with Open VKL 2.0 in one process, in turns, and prints rows of
// docs/measurements.md's form. The script open-vkl builds and runs it, and prints the lines above the rows. Both draw the 8 views of record
// with 512x512 pixels into floats, by all threads. Errors are against the double-precision reference, at one pixel of each 8x8 tile.
//
// Methods: openvkl:STEP (steps in voxels), a structured regular volume; openvkl-vdb:1, its VDB volume of the leaves that hold anything, in
// sparse scenes; stratus:auto~0.001, and stratus:auto~METHOD, whose tolerance is that method's root mean square error. Open VKL draws with
// the packets (8 or 16 rays) and the resolution of intervals that are fastest on the first view; its metrics `width` and `hint` are these.
#include "march_16.h"
#include "reference.h"
#include "reference_shading.h"

#include "stratus/scenes.h"

#include <openvkl/openvkl.h>
#include <openvkl/vdb.h>

#include <openvkl/device/openvkl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>
#include <xmmintrin.h>

extern "C" int64_t march_8(void* sampler, void* context, const ispc::frame& f, int32_t x, int32_t y);

namespace {

constexpr int size = 512, views = 8, repeats = 7, tile = 8, table_last = 4096;
constexpr double steps[] = { 1.0, 0.5, 0.25 };

using picture = std::vector<float>; // rgba

[[noreturn]] void fail(const std::string& what)
{
  std::fprintf(stderr, "open_vkl: %s\n", what.c_str());
  std::exit(1);
}

void check(stratus_context* context, stratus_status status)
{
  if (status != STRATUS_OK) {
    fail(std::string(stratus_status_name(status)) + ": " + stratus_context_message(context));
  }
}

double median(std::vector<double> values)
{
  std::sort(values.begin(), values.end());
  const size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

// A scene, its cameras and the reference's pixels of all views.
struct input {
  const stratus_scene* scene;
  stratus_camera cameras[views];
  std::vector<picture> truth;
  std::vector<size_t> picks; // numbers of the reference's pixels
  double low, high;          // the least and the largest value
  double voxel;              // shortest edge
  double bounds[6];          // as of stratus_volume_bounds()
};

picture pick(const input& in, const picture& rgba)
{
  picture picked;
  for (const size_t i : in.picks) {
    picked.insert(picked.end(), rgba.begin() + static_cast<std::ptrdiff_t>(4 * i), rgba.begin() + static_cast<std::ptrdiff_t>(4 * i + 4));
  }
  return picked;
}

// Something that draws. Its figures are for the table.
struct method {
  std::string name;
  std::vector<double> ms[views];
  double squares = 0.0, count = 0.0, largest = 0.0;
  std::vector<double> samples; // of each view
  virtual ~method() = default;
  virtual uint64_t draw(const input& in, int view, picture& rgba) = 0; // returns the samples
  virtual void print_more(const char*) const {}
  double error() const { return std::sqrt(this->squares / std::max(this->count, 1.0)); }
};

struct stratus_method : method {
  stratus_context* Context;
  stratus_ray_caster* Caster = nullptr;
  double Tolerance;

  stratus_method(stratus_context* context, const std::string& after, double tolerance) : Context(context), Tolerance(tolerance)
  {
    this->name = "stratus:auto~" + after;
    check(context, stratus_ray_caster_create(context, &this->Caster));
  }
  ~stratus_method() override { stratus_ray_caster_destroy(this->Caster); }
  uint64_t draw(const input& in, int view, picture& rgba) override
  {
    stratus_image image = {};
    image.width = image.height = size;
    image.rgba = rgba.data();
    stratus_ray_cast_options options = stratus_ray_cast_options_default();
    options.sampling.tolerance = this->Tolerance;
    stratus_ray_cast_report report;
    check(this->Context,
      stratus_ray_caster_render(this->Caster, &in.scene->volume, in.scene->transfers, &in.cameras[view], &options, &image, &report));
    return report.samples;
  }
};

// A volume on one of Open VKL's devices, each of which has packets of one width, and one of the resolutions of intervals.
struct variant {
  int width;
  float hint;
  VKLVolume volume;
  VKLSampler sampler;
  VKLIntervalIteratorContext context;
};

struct vkl_method : method {
  std::vector<variant> Variants;
  variant Chosen;
  double Step;
  std::vector<float> Table;
  float Low, Scale;

  uint64_t draw(const input& in, int view, picture& rgba) override;
  void make_table(const input& in);
  void choose(const input& in);
  void print_more(const char* scene) const override
  {
    std::printf("open-vkl,%s,%s,width,%d,rays\n", scene, this->name.c_str(), this->Chosen.width);
    std::printf("open-vkl,%s,%s,hint,%g,1\n", scene, this->name.c_str(), static_cast<double>(this->Chosen.hint));
  }
};

void vkl_method::make_table(const input& in)
{
  const stratus_transfer& t = in.scene->transfer;
  this->Low = static_cast<float>(in.low);
  this->Scale = static_cast<float>(table_last / (in.high - in.low));
  this->Table.resize(4 * (table_last + 1));
  for (int i = 0; i <= table_last; ++i) {
    const double value = in.low + (in.high - in.low) * i / table_last;
    double rgb[3];
    reference_color(&t, value, rgb);
    const double alpha = 1.0 - std::pow(1.0 - reference_opacity(&t, value), this->Step * in.voxel / t.unit_distance);
    for (int c = 0; c < 4; ++c) {
      this->Table[static_cast<size_t>(4 * i + c)] = static_cast<float>(c < 3 ? rgb[c] * alpha : alpha);
    }
  }
}

uint64_t vkl_method::draw(const input& in, int view, picture& rgba)
{
  const stratus_camera& camera = in.cameras[view];
  ispc::frame f = {};
  for (int a = 0; a < 3; ++a) {
    f.eye[a] = static_cast<float>(camera.eye[a]);
    f.forward[a] = static_cast<float>(camera.forward[a]);
    f.right[a] = static_cast<float>(camera.right[a]);
    f.up[a] = static_cast<float>(camera.up[a]);
    f.bounds[a] = static_cast<float>(in.bounds[2 * a]);
    f.bounds[3 + a] = static_cast<float>(in.bounds[2 * a + 1]);
  }
  f.width = f.height = size;
  f.step = static_cast<float>(this->Step * in.voxel);
  f.least_left = 0.001f;
  f.low = this->Low;
  f.scale = this->Scale;
  f.last = table_last;
  f.table = this->Table.data();
  f.rgba = rgba.data();
  variant& v = this->Chosen;
  const auto march = v.width == 16 ? ispc::march_16 : march_8;
  const int rows = v.width / 4, across = size / 16;
  int64_t samples = 0;
#pragma omp parallel reduction(+ : samples)
  {
    const unsigned int before = _mm_getcsr();
    _mm_setcsr(before | 0x8040u); // Open VKL wants denormal numbers off
#pragma omp for schedule(dynamic)
    for (int block = 0; block < across * across; ++block) {
      for (int y = 0; y < 16; y += rows) {
        for (int x = 0; x < 16; x += 4) {
          samples += march(&v.sampler, &v.context, f, block % across * 16 + x, block / across * 16 + y);
        }
      }
    }
    _mm_setcsr(before);
  }
  return static_cast<uint64_t>(samples);
}

double milliseconds(method& m, const input& in, int view, picture& rgba, uint64_t* samples)
{
  const auto start = std::chrono::steady_clock::now();
  *samples = m.draw(in, view, rgba);
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void vkl_method::choose(const input& in)
{
  picture rgba(4 * static_cast<size_t>(size) * size);
  double best = INFINITY;
  variant fastest = this->Variants[0];
  for (const variant& v : this->Variants) {
    this->Chosen = v;
    double least = INFINITY;
    uint64_t samples;
    for (int n = 0; n < 3; ++n) {
      least = std::min(least, milliseconds(*this, in, 0, rgba, &samples));
    }
    std::fprintf(stderr, "  %s: packets of %d, hint %g: %.1f ms\n", this->name.c_str(), v.width, static_cast<double>(v.hint), least);
    if (least < best) {
      best = least;
      fastest = v;
    }
  }
  this->Chosen = fastest;
}

// The ranges of values with an opacity above 0.
std::vector<vkl_range1f> visible_ranges(const stratus_transfer& t)
{
  std::vector<vkl_range1f> ranges;
  for (size_t i = 0; i <= t.opacity_count; ++i) {
    // Piece i is between points i - 1 and i, the first and the last one reach to infinity.
    const double* a = t.opacity + 2 * (i > 0 ? i - 1 : 0);
    const double* b = t.opacity + 2 * std::min(i, t.opacity_count - 1);
    if (a[1] <= 0.0 && b[1] <= 0.0) {
      continue;
    }
    const float infinity = INFINITY;
    float lower = i > 0 ? static_cast<float>(a[0]) : -infinity, upper = i < t.opacity_count ? static_cast<float>(b[0]) : infinity;
    lower = a[1] > 0.0 ? lower : std::nextafter(lower, infinity);
    upper = b[1] > 0.0 ? upper : std::nextafter(upper, -infinity);
    if (!ranges.empty() && ranges.back().upper == lower) {
      ranges.back().upper = upper;
    } else {
      ranges.push_back({ lower, upper });
    }
  }
  return ranges;
}

VKLDataType vkl_type(stratus_type type)
{
  return type == STRATUS_UINT8 ? VKL_UCHAR : type == STRATUS_UINT16 ? VKL_USHORT : type == STRATUS_FLOAT32 ? VKL_FLOAT : VKL_UNKNOWN;
}

void set_data(VKLObject object, const char* name, VKLData data)
{
  vklSetData(object, name, data);
  vklRelease(data);
}

VKLVolume make_regular(VKLDevice device, const stratus_volume& v)
{
  VKLVolume volume = vklNewVolume(device, "structuredRegular");
  const size_t count = static_cast<size_t>(v.dimensions[0] * v.dimensions[1] * v.dimensions[2]);
  int n[3];
  float origin[3], spacing[3];
  for (int a = 0; a < 3; ++a) {
    n[a] = static_cast<int>(v.dimensions[a]);
    origin[a] = static_cast<float>(v.origin[a]);
    spacing[a] = static_cast<float>(v.spacing[a]);
  }
  vklSetVec3i(volume, "dimensions", n[0], n[1], n[2]);
  vklSetVec3f(volume, "gridOrigin", origin[0], origin[1], origin[2]);
  vklSetVec3f(volume, "gridSpacing", spacing[0], spacing[1], spacing[2]);
  set_data(volume, "data", vklNewData(device, count, vkl_type(v.type), v.values, VKL_DATA_SHARED_BUFFER, 0));
  return volume;
}

// The leaves of 8^3 values in which, or one value beside which, there is another value than the lowest.
VKLVolume make_vdb(VKLDevice device, const input& in)
{
  const stratus_volume& v = in.scene->volume;
  const int64_t* n = v.dimensions;
  const auto value = [&](int64_t i, int64_t j, int64_t k) {
    const bool inside = std::min({ i, j, k }) >= 0 && i < n[0] && j < n[1] && k < n[2];
    return static_cast<float>(inside ? reference_value(&v, i, j, k) : in.low);
  };
  std::vector<vkl_vec3i> origins;
  std::vector<float> values; // of a leaf z first
  for (int64_t leaf = 0; leaf < ((n[0] + 7) / 8) * ((n[1] + 7) / 8) * ((n[2] + 7) / 8); ++leaf) {
    const int64_t across = (n[0] + 7) / 8, up = (n[1] + 7) / 8;
    const int64_t x = leaf % across * 8, y = leaf / across % up * 8, z = leaf / across / up * 8;
    bool shown = false;
    for (int64_t at = 0; at < 1000 && !shown; ++at) {
      shown = value(x - 1 + at % 10, y - 1 + at / 10 % 10, z - 1 + at / 100) > static_cast<float>(in.low);
    }
    if (shown) {
      origins.push_back({ static_cast<int>(x), static_cast<int>(y), static_cast<int>(z) });
      for (int64_t at = 0; at < 512; ++at) {
        values.push_back(value(x + at / 64, y + at / 8 % 8, z + at % 8));
      }
    }
  }
  const std::vector<uint32_t> levels(origins.size(), VKL_VDB_NUM_LEVELS - 1), formats(origins.size(), VKL_FORMAT_DENSE_ZYX);
  // A leaf's values are at the centres of its cells.
  float place[12] = {};
  for (int a = 0; a < 3; ++a) {
    place[4 * a] = static_cast<float>(v.spacing[a]);
    place[9 + a] = static_cast<float>(v.origin[a] - 0.5 * v.spacing[a]);
  }
  VKLVolume volume = vklNewVolume(device, "vdb");
  VKLData packed = vklNewData(device, values.size(), VKL_FLOAT, values.data(), VKL_DATA_DEFAULT, 0);
  set_data(volume, "indexToObject", vklNewData(device, 12, VKL_FLOAT, place, VKL_DATA_DEFAULT, 0));
  set_data(volume, "node.level", vklNewData(device, levels.size(), VKL_UINT, levels.data(), VKL_DATA_DEFAULT, 0));
  set_data(volume, "node.format", vklNewData(device, formats.size(), VKL_UINT, formats.data(), VKL_DATA_DEFAULT, 0));
  set_data(volume, "node.origin", vklNewData(device, origins.size(), VKL_VEC3I, origins.data(), VKL_DATA_DEFAULT, 0));
  set_data(volume, "nodesPackedDense", vklNewData(device, 1, VKL_DATA, &packed, VKL_DATA_DEFAULT, 0));
  vklRelease(packed);
  return volume;
}

std::vector<variant> make_variants(const std::vector<VKLDevice>& devices, const input& in, bool vdb)
{
  const std::vector<vkl_range1f> ranges = visible_ranges(in.scene->transfer);
  const float background = static_cast<float>(in.low);
  std::vector<variant> variants;
  for (const VKLDevice device : devices) {
    VKLVolume volume = vdb ? make_vdb(device, in) : make_regular(device, in.scene->volume);
    set_data(volume, "background", vklNewData(device, 1, VKL_FLOAT, &background, VKL_DATA_DEFAULT, 0));
    vklCommit(volume);
    VKLSampler sampler = vklNewSampler(volume);
    vklCommit(sampler);
    for (const float hint : { 0.0f, 0.3f, 0.5f, 0.9f }) { // the four depths of its tree
      VKLIntervalIteratorContext context = vklNewIntervalIteratorContext(sampler);
      set_data(context, "valueRanges", vklNewData(device, ranges.size(), VKL_BOX1F, ranges.data(), VKL_DATA_DEFAULT, 0));
      vklSetFloat(context, "intervalResolutionHint", hint);
      vklCommit(context);
      variants.push_back({ vklGetNativeSIMDWidth(device), hint, volume, sampler, context });
    }
    if (vklDeviceGetLastErrorCode(device) != VKL_NO_ERROR) {
      fail(std::string("Open VKL: ") + vklDeviceGetLastErrorMsg(device));
    }
  }
  return variants;
}

std::vector<VKLDevice> make_devices()
{
  std::vector<VKLDevice> devices;
  vklInit();
  for (const char* name : { "cpu_8", "cpu_16" }) {
    VKLDevice device = vklNewDevice(name);
    if (device) {
      vklCommitDevice(device);
      devices.push_back(device);
    }
  }
  if (devices.empty()) {
    fail("Open VKL has no device with packets of 8 or 16 rays for this processor");
  }
  return devices;
}

void release(const std::vector<variant>& variants)
{
  for (size_t i = 0; i < variants.size(); ++i) {
    vklRelease(variants[i].context);
    if (i + 1 == variants.size() || variants[i + 1].volume.host != variants[i].volume.host) {
      vklRelease(variants[i].sampler);
      vklRelease(variants[i].volume);
    }
  }
}

std::unique_ptr<vkl_method> make_vkl(const std::vector<variant>& variants, const input& in, double step, const char* kind)
{
  auto m = std::make_unique<vkl_method>();
  char name[32];
  std::snprintf(name, sizeof name, "%s:%g", kind, step);
  m->name = name;
  m->Step = step;
  m->Variants = variants;
  m->make_table(in);
  m->choose(in);
  return m;
}

input make_input(stratus_context* context, const stratus_scene* scene)
{
  input in = {};
  const stratus_volume& v = scene->volume;
  if (v.components != 1 || vkl_type(v.type) == VKL_UNKNOWN || v.coordinates[0] || v.coordinates[1] || v.coordinates[2]) {
    fail(std::string("scene ") + scene->name + ": Open VKL draws one component of uint8, uint16 or float on equal spacing here");
  }
  in.scene = scene;
  in.low = in.high = reference_value_at(&v, 0);
  for (int64_t i = 0; i < v.dimensions[0] * v.dimensions[1] * v.dimensions[2]; ++i) {
    const double value = reference_value_at(&v, i);
    in.low = std::min(in.low, value);
    in.high = std::max(in.high, value);
  }
  in.voxel = std::min({ v.spacing[0], v.spacing[1], v.spacing[2] });
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      if (reference_picks(tile, x, y)) {
        in.picks.push_back(static_cast<size_t>(y * size + x));
      }
    }
  }
  check(context, stratus_volume_bounds(context, &v, in.bounds));
  for (int view = 0; view < views; ++view) {
    check(context, stratus_scene_camera(context, in.bounds, scene->up_axis, view, 0, 1.0, &in.cameras[view]));
    reference_scene r = {};
    r.volume = &v;
    r.transfer = scene->transfers;
    r.camera = &in.cameras[view];
    r.tile = tile;
    picture rgba(4 * static_cast<size_t>(size) * size);
    double agreement = 0.0;
    if (reference_converged(&r, size, size, 75.0, rgba.data(), nullptr, &agreement) != 0) {
      fail("no memory for the reference");
    }
    in.truth.push_back(pick(in, rgba));
    std::fprintf(stderr, "  reference of %s, view %d: agrees with itself to %.0f dB\n", scene->name, view, agreement);
  }
  return in;
}

// Draws all views once to warm up, then once more for errors.
void measure_error(method& m, const input& in)
{
  picture rgba(4 * static_cast<size_t>(size) * size);
  for (int turn = 0; turn < 2; ++turn) {
    m.squares = m.count = m.largest = 0.0;
    m.samples.clear();
    for (int view = 0; view < views; ++view) {
      m.samples.push_back(static_cast<double>(m.draw(in, view, rgba)));
      reference_error(pick(in, rgba).data(), in.truth[static_cast<size_t>(view)].data(), in.picks.size(), &m.squares, &m.count, &m.largest);
    }
  }
}

void print_method(const char* scene, const method& m)
{
  std::vector<double> ms;
  for (const std::vector<double>& of_view : m.ms) {
    ms.push_back(median(of_view));
  }
  const char* const name = m.name.c_str();
  std::printf("open-vkl,%s,%s,frame_ms,%.6g,ms\n", scene, name, median(ms));
  std::printf("open-vkl,%s,%s,psnr_db,%.6g,dB\n", scene, name, -20.0 * std::log10(std::max(m.error(), 1e-10)));
  std::printf("open-vkl,%s,%s,max_error,%.6g,1\n", scene, name, m.largest);
  std::printf("open-vkl,%s,%s,samples,%.6g,1\n", scene, name, median(m.samples));
  m.print_more(scene);
  std::fprintf(stderr, "%s %s: %.2f ms, %.1f dB\n", scene, name, median(ms), -20.0 * std::log10(std::max(m.error(), 1e-10)));
  std::fflush(stdout);
}

void measure(stratus_context* context, const std::vector<VKLDevice>& devices, const char* name)
{
  stratus_scene* scene = nullptr;
  check(context, stratus_scene_create(context, name, &scene));
  const input in = make_input(context, scene);
  std::vector<std::unique_ptr<method>> methods;
  methods.push_back(std::make_unique<stratus_method>(context, "0.001", 0.001));
  measure_error(*methods[0], in);
  const std::vector<variant> regular = make_variants(devices, in, false);
  for (const double step : steps) {
    methods.push_back(make_vkl(regular, in, step, "openvkl"));
    measure_error(*methods.back(), in);
    const std::string peer = methods.back()->name;
    methods.push_back(std::make_unique<stratus_method>(context, peer, methods.back()->error()));
    measure_error(*methods.back(), in);
  }
  const bool sparse = scene->occupied < 0.1 && scene->volume.type == STRATUS_FLOAT32;
  const std::vector<variant> vdb = sparse ? make_variants(devices, in, true) : std::vector<variant>();
  if (sparse) {
    methods.push_back(make_vkl(vdb, in, 1.0, "openvkl-vdb"));
    measure_error(*methods.back(), in);
  }
  picture rgba(4 * static_cast<size_t>(size) * size);
  for (int n = 0; n < repeats; ++n) {
    for (int view = 0; view < views; ++view) {
      for (const std::unique_ptr<method>& m : methods) {
        uint64_t samples;
        m->ms[view].push_back(milliseconds(*m, in, view, rgba, &samples));
      }
    }
  }
  for (const std::unique_ptr<method>& m : methods) {
    print_method(name, *m);
  }
  methods.clear();
  release(regular);
  release(vdb);
  stratus_scene_destroy(context, scene);
}
} // namespace

int main(int argc, char** argv)
{
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context = nullptr;
  char message[256];
  options.device = "host";
  if (stratus_context_create(&options, &context, message, sizeof message) != STRATUS_OK) {
    fail(message);
  }
  const std::vector<VKLDevice> devices = make_devices();
  for (int i = 1; i < argc; ++i) {
    measure(context, devices, argv[i]);
  }
  stratus_context_destroy(context);
  return 0;
}
