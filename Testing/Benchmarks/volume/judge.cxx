// SPDX-License-Identifier: BSD-3-Clause
// Measures the errors of all pictures of a scene against the double-precision reference, and counts the pixels that a structure changed.
// The reference's step is halved until two pictures agree by 10 dB more than the best figure printed, and to 70 dB at least where a
// transfer function jumps: there, plain steps converge slowly.
#include "bench.h"
#include "bench_commit.h"
#include "reference.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <string>

namespace bench {

uint64_t hash_bytes(uint64_t hash, const void* data, size_t bytes)
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

uint64_t hash_of(const scene& s)
{
  const stratus_volume& v = s.volume;
  const int64_t values = v.dimensions[0] * v.dimensions[1] * v.dimensions[2] * v.value_stride;
  uint64_t hash = hash_bytes(hash_bytes(2, STRATUS_BENCH_REFERENCE, std::strlen(STRATUS_BENCH_REFERENCE)), v.values,
    static_cast<size_t>(values) * stratus_type_size(v.type));
  hash = hash_bytes(hash, v.dimensions, sizeof v.dimensions);
  hash = hash_bytes(hash, v.spacing, sizeof v.spacing);
  hash = hash_bytes(hash, v.origin, sizeof v.origin);
  hash = hash_bytes(hash, &v.components, sizeof v.components);
  hash = hash_bytes(hash, &s.up_axis, sizeof s.up_axis);
  hash = hash_bytes(hash, &s.shaded, sizeof s.shaded);
  for (const stratus_transfer& t : transfers_of(s)) {
    hash = hash_bytes(hash, t.opacity, 2 * t.opacity_count * sizeof(double));
    hash = hash_bytes(hash, t.color, 4 * t.color_count * sizeof(double));
    hash = hash_bytes(hash, &t.unit_distance, sizeof(double));
  }
  return hash;
}

namespace {

constexpr double finest = 1.0 / 256.0;
constexpr double least_of_jumps = 70.0; // dB
// Of all views, on which errors are measured. Squares of errors differ by two decades or so, so that their mean is known to a few percent.
constexpr size_t enough_pixels = 16384;

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

class references
{
public:
  references(stratus_context* context, const scene& s, int size, const std::string& cache)
      : Context(context), Scene(s), Size(size), Cache(cache), Hash(cache.empty() ? 0 : hash_of(s))
  {
  }

  // Returns the pixels that errors are measured on, one after the other.
  std::vector<float> make(int view, double step) const
  {
    std::vector<float> picked(4 * this->Picks.size());
    const std::string path = this->Cache.empty() ? "" : this->path(view, step);
    if (!path.empty() && load_picture(path, picked)) {
      return picked;
    }
    std::vector<float> rgba(4 * static_cast<size_t>(this->Size) * static_cast<size_t>(this->Size));
    const std::vector<stratus_transfer> transfers = transfers_of(this->Scene);
    const stratus_camera camera = camera_of(this->Context, this->Scene, view);
    reference_scene r = {};
    r.volume = &this->Scene.volume;
    const stratus_shading shading = shading_of(camera);
    r.transfer = transfers.data();
    r.camera = &camera;
    r.shading = this->Scene.shaded ? &shading : nullptr;
    r.tile = this->Tile;
    if (reference_render(&r, this->Size, this->Size, step, rgba.data(), nullptr) != 0) {
      throw failure("no memory for the reference");
    }
    picked = this->pick(rgba);
    if (!path.empty()) {
      save_picture(path, picked);
    }
    return picked;
  }

  // Takes the largest tiles that leave enough pixels in which a method shows something.
  void choose_pixels(const std::vector<picture>& pictures)
  {
    for (this->Tile = 8; this->Tile >= 1; this->Tile /= 2) {
      this->Picks.clear();
      for (int y = 0; y < this->Size; ++y) {
        for (int x = 0; x < this->Size; ++x) {
          if (reference_picks(this->Tile, x, y)) {
            this->Picks.push_back(static_cast<size_t>(y) * static_cast<size_t>(this->Size) + static_cast<size_t>(x));
          }
        }
      }
      size_t lit = 0;
      for (const picture& p : pictures) {
        lit += static_cast<size_t>(std::count_if(this->Picks.begin(), this->Picks.end(), [&](size_t i) { return p.bytes[4 * i + 3] > 0; }));
      }
      if (lit >= enough_pixels || this->Tile == 1) {
        return;
      }
    }
  }

  template <typename T> std::vector<T> pick(const std::vector<T>& rgba) const
  {
    std::vector<T> picked;
    picked.reserve(4 * this->Picks.size());
    for (const size_t i : this->Picks) {
      picked.insert(picked.end(), rgba.begin() + static_cast<std::ptrdiff_t>(4 * i), rgba.begin() + static_cast<std::ptrdiff_t>(4 * i + 4));
    }
    return picked;
  }

private:
  std::string path(int view, double step) const
  {
    char name[160];
    std::snprintf(name, sizeof name, "/%s-%016llx-%d-%d-%d-%d.rgba", this->Scene.name.c_str(), static_cast<unsigned long long>(this->Hash),
      this->Size, this->Tile, view, static_cast<int>(std::lround(1.0 / step)));
    return this->Cache + name;
  }

  stratus_context* Context;
  const scene& Scene;
  int Size;
  std::string Cache;
  uint64_t Hash;
  int Tile = 1;
  std::vector<size_t> Picks;
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

void measure_result(const references& source, const std::vector<std::vector<float>>& reference, result& r)
{
  error in_float;
  error in_bytes;
  for (int view = 0; view < views; ++view) {
    const picture& p = r.pictures[static_cast<size_t>(view)];
    const std::vector<float>& truth = reference[static_cast<size_t>(view)];
    if (!p.rgba.empty()) {
      in_float.add(source.pick(p.rgba).data(), truth.data(), truth.size() / 4);
    }
    in_bytes.add(to_floats(source.pick(p.bytes)).data(), truth.data(), truth.size() / 4);
  }
  const bool floats = !r.pictures[0].rgba.empty();
  r.psnr_db = floats ? in_float.psnr() : 0.0;
  r.psnr8_db = in_bytes.psnr();
  r.max_error = floats ? in_float.largest : in_bytes.largest;
}

// Returns "/2~0.01@device" of stratus:octant/2~0.01@device. Only pictures of the same rays, tolerance and device are compared.
std::string how(const std::string& method)
{
  return method.substr(std::min(method.find_first_of("/~@"), method.size()));
}
} // namespace

struct judge::state {
  stratus_context* Context;
  const scene& Scene;
  effort How;
  references Source;
  const progress& Shown;
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
    this->Shown.show(this->Scene.name,
      "reference in steps of 1/" + std::to_string(std::lround(1.0 / step)) + " voxel, view " + std::to_string(view + 1) + " of " +
        std::to_string(views));
    const size_t v = static_cast<size_t>(view);
    this->Coarse[v].swap(this->Fine[v]);
    this->Fine[v] = this->Source.make(view, step);
    if (!this->Coarse[v].empty()) {
      self.add(this->Coarse[v].data(), this->Fine[v].data(), this->Fine[v].size() / 4);
    }
  }
  this->Step = step;
  return self.psnr();
}

judge::judge(stratus_context* context, const scene& s, const effort& how, const std::string& cache, const progress& shown)
    : State(new state{ context, s, how, references(context, s, how.size, cache), shown, 0.0, {}, {}, 0.0 })
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
    j.Source.choose_pixels(std::find_if(results.begin(), results.end(), [](const result& r) { return r.judged; })->pictures);
    // Without light and other components, steps end at cells and at the function's points, so that long ones suffice.
    j.draw(j.Scene.shaded || j.Scene.volume.components > 1 ? 0.125 : 1.0);
    j.Agreement = j.draw(0.5 * j.Step);
  }
  for (;;) {
    double best = 0.0;
    for (result& r : results) {
      if (r.judged) {
        measure_result(j.Source, j.Fine, r);
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
  std::map<std::string, std::vector<picture>> none; // by rays, tolerance and device
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
      effort once = j.How;
      once.repeats = 1;
      once.updates = false;
      plain = run_method(j.Context, j.Scene, "stratus:none" + how(r.method), once, r.tolerance).pictures;
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
