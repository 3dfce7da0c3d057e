// SPDX-License-Identifier: BSD-3-Clause
// Measures the errors of all pictures of a scene against the double-precision reference, and counts the pixels that a structure changed.
// The reference's step is halved until two pictures agree by 10 dB more than the best figure printed, and to 70 dB at least where a
// transfer function jumps: there, plain steps converge slowly.
#include "bench.h"
#include "reference.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <unistd.h>

namespace bench {

namespace {

constexpr double finest = 1.0 / 256.0;
constexpr double least_of_jumps = 70.0; // dB

uint64_t mix(uint64_t hash, const void* data, size_t bytes)
{
  const unsigned char* p = static_cast<const unsigned char*>(data);
  uint64_t word;
  for (; bytes >= sizeof word; bytes -= sizeof word, p += sizeof word) {
    std::memcpy(&word, p, sizeof word);
    hash = (hash ^ word) * 0x9E3779B97F4A7C15u;
    hash ^= hash >> 29;
  }
  for (; bytes > 0; --bytes, ++p) {
    hash = (hash ^ *p) * 0x9E3779B97F4A7C15u;
  }
  return hash;
}

// Hashes everything that determines the reference's picture, except view, size and step. The number counts the reference's ways to
// integrate, so that a cache holds no picture of an earlier one.
uint64_t hash_of(const scene& s)
{
  const stratus_volume& v = s.volume;
  const int64_t values = v.dimensions[0] * v.dimensions[1] * v.dimensions[2] * v.value_stride;
  uint64_t hash = mix(2, v.values, static_cast<size_t>(values) * stratus_type_size(v.type));
  hash = mix(hash, v.dimensions, sizeof v.dimensions);
  hash = mix(hash, v.spacing, sizeof v.spacing);
  hash = mix(hash, v.origin, sizeof v.origin);
  hash = mix(hash, &s.shaded, sizeof s.shaded);
  for (const stratus_transfer& t : transfers_of(s)) {
    hash = mix(hash, t.opacity, 2 * t.opacity_count * sizeof(double));
    hash = mix(hash, t.color, 4 * t.color_count * sizeof(double));
    hash = mix(hash, &t.unit_distance, sizeof(double));
  }
  return hash;
}

// Whether a function has two points of the same value.
bool jumps(const std::vector<double>& points, size_t width)
{
  for (size_t i = width; i < points.size(); i += width) {
    if (points[i] == points[i - width]) {
      return true;
    }
  }
  return false;
}

// Shows on a terminal which reference is being drawn.
void progress(const scene& s, double step, int view)
{
  if (isatty(STDERR_FILENO)) {
    std::fprintf(stderr, "\r\033[K");
    if (view < views) {
      std::fprintf(stderr, "  reference of %s, steps of 1/%d voxel, view %d of %d", s.name.c_str(),
        static_cast<int>(std::lround(1.0 / step)), view + 1, views);
    }
  }
}

class references
{
public:
  references(stratus_context* context, const scene& s, int size, const std::string& cache)
      : Context(context), Scene(s), Size(size), Cache(cache), Hash(cache.empty() ? 0 : hash_of(s))
  {
  }

  std::vector<float> make(int view, double step) const
  {
    std::vector<float> rgba(4 * static_cast<size_t>(this->Size) * static_cast<size_t>(this->Size));
    const std::string path = this->Cache.empty() ? "" : this->path(view, step);
    if (!path.empty() && load_picture(path, rgba)) {
      return rgba;
    }
    const std::vector<stratus_transfer> transfers = transfers_of(this->Scene);
    const stratus_camera camera = camera_of(this->Context, this->Scene, view);
    reference_scene r = {};
    r.volume = &this->Scene.volume;
    const stratus_shading shading = shading_of(camera);
    r.transfer = transfers.data();
    r.camera = &camera;
    r.shading = this->Scene.shaded ? &shading : nullptr;
    if (reference_render(&r, this->Size, this->Size, step, rgba.data(), nullptr) != 0) {
      throw failure("no memory for the reference");
    }
    if (!path.empty()) {
      save_picture(path, rgba);
    }
    return rgba;
  }

private:
  std::string path(int view, double step) const
  {
    char name[160];
    std::snprintf(name, sizeof name, "/%s-%016llx-%d-%d-%d.rgba", this->Scene.name.c_str(), static_cast<unsigned long long>(this->Hash),
      this->Size, view, static_cast<int>(std::lround(1.0 / step)));
    return this->Cache + name;
  }

  stratus_context* Context;
  const scene& Scene;
  int Size;
  std::string Cache;
  uint64_t Hash;
};

struct error {
  double squares = 0.0, count = 0.0, largest = 0.0;
  void add(const float* a, const float* b, size_t pixels) { reference_error(a, b, pixels, &this->squares, &this->count, &this->largest); }
  // Equal pictures get a finite figure, which tables and charts can hold.
  double psnr() const { return this->squares > 0.0 ? -10.0 * std::log10(this->squares / this->count) : 200.0; }
};

std::vector<float> to_floats(const std::vector<uint8_t>& bytes)
{
  std::vector<float> result(bytes.size());
  for (size_t i = 0; i < bytes.size(); ++i) {
    result[i] = static_cast<float>(bytes[i]) / 255.0f;
  }
  return result;
}

void measure_result(const std::vector<std::vector<float>>& reference, result& r)
{
  error in_float;
  error in_bytes;
  for (int view = 0; view < views; ++view) {
    const picture& p = r.pictures[static_cast<size_t>(view)];
    const std::vector<float>& truth = reference[static_cast<size_t>(view)];
    if (!p.rgba.empty()) {
      in_float.add(p.rgba.data(), truth.data(), truth.size() / 4);
    }
    in_bytes.add(to_floats(p.bytes).data(), truth.data(), truth.size() / 4);
  }
  const bool floats = !r.pictures[0].rgba.empty();
  r.psnr_db = floats ? in_float.psnr() : 0.0;
  r.psnr8_db = in_bytes.psnr();
  r.max_error = floats ? in_float.largest : in_bytes.largest;
}

// Returns "~0.01@device" of stratus:octant~0.01@device. Only pictures of one tolerance and device are compared.
std::string how(const std::string& method)
{
  return method.substr(std::min(method.find_first_of("~@"), method.size()));
}
} // namespace

struct judge::state {
  stratus_context* Context;
  const scene& Scene;
  int Size;
  references Source;
  double Step; // of Fine; 0: nothing is drawn yet
  std::vector<std::vector<float>> Coarse, Fine;
  double Agreement; // dB, of Fine with Coarse

  double draw(double step);
};

// Draws all views, and returns how far they agree with the last ones, in dB.
double judge::state::draw(double step)
{
  error self;
  for (int view = 0; view < views; ++view) {
    progress(this->Scene, step, view);
    const size_t v = static_cast<size_t>(view);
    this->Coarse[v].swap(this->Fine[v]);
    this->Fine[v] = this->Source.make(view, step);
    if (!this->Coarse[v].empty()) {
      self.add(this->Coarse[v].data(), this->Fine[v].data(), this->Fine[v].size() / 4);
    }
  }
  progress(this->Scene, step, views);
  this->Step = step;
  return self.psnr();
}

judge::judge(stratus_context* context, const scene& s, int size, const std::string& cache)
    : State(new state{ context, s, size, references(context, s, size, cache), 0.0, {}, {}, 0.0 })
{
  this->State->Coarse.resize(views);
  this->State->Fine.resize(views);
}

judge::~judge() = default;

void judge::measure(std::vector<result>& results)
{
  state& j = *this->State;
  if (std::none_of(results.begin(), results.end(), [](const result& r) { return r.judged; })) {
    return;
  }
  const double least = jumps(j.Scene.first.opacity, 2) || jumps(j.Scene.first.color, 4) ? least_of_jumps : 0.0;
  if (j.Step == 0.0) {
    // Without light and other components, steps end at cells and at the function's points, so that long ones suffice.
    j.draw(j.Scene.shaded || j.Scene.volume.components > 1 ? 0.125 : 1.0);
    j.Agreement = j.draw(0.5 * j.Step);
  }
  for (;;) {
    double best = 0.0;
    for (result& r : results) {
      if (r.judged) {
        measure_result(j.Fine, r);
        r.reference_db = j.Agreement;
        best = std::max({ best, r.psnr_db, r.psnr8_db });
      }
    }
    if (j.Agreement >= std::max(best + 10.0, least)) {
      return;
    }
    if (0.5 * j.Step < finest) {
      std::fprintf(stderr, "  warning: the reference of %s agrees with itself to %.1f dB only, the best figure is %.1f dB\n",
        j.Scene.name.c_str(), j.Agreement, best);
      return;
    }
    j.Agreement = j.draw(0.5 * j.Step);
  }
}

void judge::compare(std::vector<result>& results)
{
  const state& j = *this->State;
  std::map<std::string, std::vector<picture>> none; // by tolerance and device
  for (const result& r : results) {
    if (r.method.rfind("stratus:none", 0) == 0 && r.judged) {
      none[how(r.method)] = r.pictures;
    }
  }
  for (result& r : results) {
    if (r.method.rfind("stratus:", 0) != 0 || !r.judged) {
      continue;
    }
    std::vector<picture>& plain = none[how(r.method)];
    if (plain.empty()) {
      plain = run_method(j.Context, j.Scene, "stratus:none" + how(r.method), j.Size, r.tolerance).pictures;
    }
    r.differing_pixels = 0.0;
    for (int view = 0; view < views; ++view) {
      const std::vector<float>& a = r.pictures[static_cast<size_t>(view)].rgba;
      const std::vector<float>& b = plain[static_cast<size_t>(view)].rgba;
      for (size_t i = 0; i < a.size(); i += 4) {
        r.differing_pixels += std::memcmp(a.data() + i, b.data() + i, 4 * sizeof(float)) != 0;
      }
    }
  }
}
} // namespace bench
