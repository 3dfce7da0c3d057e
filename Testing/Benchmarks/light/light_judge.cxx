// SPDX-License-Identifier: BSD-3-Clause
// Errors of lit images. Light that comes from the light itself is judged by the reference in double, in which a ray goes from each sample
// to the light. Scattered light is judged by the path tracer, too, whose noise is known and subtracted.
#include "bench_commit.h"
#include "light_bench.h"
#include "reference.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace bench {

namespace {

// The reference in double draws one pixel of each tile, because each of its samples has a ray of its own.
constexpr int tile = 4;
constexpr double first_step = 0.25, finest_step = 1.0 / 64.0; // in voxels
// Two pictures in double are to agree so much better than the best image agrees with them.
constexpr double agreement = 0.3;
// Paths are added until the error is known to this fraction.
constexpr double known_enough = 0.25;
constexpr int first_paths = 16;

void check(stratus_context* context, stratus_status status)
{
  if (status != STRATUS_OK) {
    throw failure(std::string(stratus_status_name(status)) + ": " + stratus_context_message(context));
  }
}

// ---- in double

struct sum_of_squares {
  double squares = 0.0, count = 0.0, largest = 0.0;
  void add(const std::vector<float>& a, const std::vector<float>& b)
  {
    reference_error(a.data(), b.data(), a.size() / 4, &this->squares, &this->count, &this->largest);
  }
  double error() const { return this->count > 0.0 ? std::sqrt(this->squares / this->count) : 0.0; }
};

// The pixels of an image that the reference draws.
std::vector<float> picked(const std::vector<float>& rgba, int size)
{
  std::vector<float> result = rgba;
  for (int i = 0; i < size * size; ++i) {
    if (!reference_picks(tile, i % size, i / size)) {
      std::fill_n(result.begin() + 4 * i, 4, 0.0f);
    }
  }
  return result;
}

class double_reference
{
public:
  double_reference(const light_subject& s, const lighting& l, int size, const std::string& cache)
      : Subject(s), Light(l), Size(size), Cache(cache)
  {
  }

  light_images draw(double step) const
  {
    light_images result;
    for (const int view : judged_views) {
      result.push_back(this->draw(view, step));
    }
    return result;
  }

private:
  std::vector<float> draw(int view, double step) const
  {
    const stratus_camera& camera = this->Subject.cameras[static_cast<size_t>(view)];
    const scene& of = *this->Subject.volume;
    const std::vector<stratus_transfer> transfers = transfers_of(of);
    const stratus_shading shading = shading_of(this->Subject, this->Light, camera);
    std::vector<float> rgba(4 * static_cast<size_t>(this->Size) * static_cast<size_t>(this->Size));
    const stratus_light& light = shading.lights[0];
    const double numbers[] = { shading.ambient, shading.diffuse, shading.specular, shading.specular_power, shading.scattering,
      shading.anisotropy, static_cast<double>(shading.shadows), light.vector[0], light.vector[1], light.vector[2], light.color[0] };
    char name[160];
    std::snprintf(name, sizeof name, "/light-%s-%016llx-%d-%d-%d-%d.rgba", this->Subject.name.c_str(),
      static_cast<unsigned long long>(hash_bytes(hash_of(of), numbers, sizeof numbers)), this->Size, tile, view,
      static_cast<int>(std::lround(1.0 / step)));
    const std::string path = this->Cache + name;
    if (!this->Cache.empty() && load_picture(path, rgba)) {
      return rgba;
    }
    reference_scene r = {};
    r.volume = &of.volume;
    r.transfer = transfers.data();
    r.camera = &camera;
    r.shading = &shading;
    r.tile = tile;
    if (reference_render(&r, this->Size, this->Size, step, rgba.data(), nullptr) != 0) {
      throw failure("no memory for the reference");
    }
    if (!this->Cache.empty()) {
      save_picture(path, rgba);
    }
    return rgba;
  }

  const light_subject& Subject;
  const lighting& Light;
  int Size;
  std::string Cache;
};

// ---- by paths

stratus_path_options paths_of(const light_subject& s, const lighting& l)
{
  stratus_path_options o = stratus_path_options_default();
  o.bounces = l.bounces;
  o.albedo = l.diffuse;
  o.anisotropy = l.anisotropy;
  o.light_count = 1;
  o.lights[0] = sun_of(s);
  for (int a = 0; a < 3; ++a) {
    o.up[a] = a == s.up_axis;
  }
  return o;
}

class path_tracer
{
public:
  path_tracer(stratus_context* context, const light_subject& s, const lighting& l, int view, int size)
      : Context(context), Subject(s), Functions(transfers_of(*s.volume)), Options(paths_of(s, l)),
        Camera(s.cameras[static_cast<size_t>(view)]), Size(size), Rgba(4 * static_cast<size_t>(size) * static_cast<size_t>(size)),
        Errors(this->Rgba.size())
  {
    check(context, stratus_path_tracer_create(context, &this->Tracer));
  }
  ~path_tracer() { stratus_path_tracer_destroy(this->Tracer); }
  path_tracer(const path_tracer&) = delete;
  path_tracer& operator=(const path_tracer&) = delete;

  stratus_path_report add(int samples)
  {
    stratus_path_report report;
    stratus_image image = stratus_image();
    image.width = image.height = this->Size;
    image.rgba = this->Rgba.data();
    this->Options.samples = samples;
    check(this->Context,
      stratus_path_tracer_render(
        this->Tracer, &this->Subject.volume->volume, this->Functions.data(), &this->Camera, &this->Options, &image, &report));
    check(this->Context, stratus_path_tracer_errors(this->Tracer, this->Errors.data()));
    return report;
  }
  const std::vector<float>& rgba() const { return this->Rgba; }
  const std::vector<float>& errors() const { return this->Errors; }

private:
  stratus_context* Context;
  const light_subject& Subject;
  std::vector<stratus_transfer> Functions;
  stratus_path_options Options;
  stratus_camera Camera;
  int Size;
  std::vector<float> Rgba, Errors;
  stratus_path_tracer* Tracer = nullptr;
};

// A view by paths, which a cache may have.
struct traced_view {
  std::vector<float> picture; // RGBA and its standard errors, after one another
  double samples = 0.0;
};

// The mean of (image - paths)^2 - (standard error of the paths)^2 is free of the paths' noise, because their mean is unbiased and the image
// has no noise. The deviation of a mean over pixels bounds the noise that is left.
light_error compare(const light_images& image, const std::vector<traced_view>& traced)
{
  double sum = 0.0, squares = 0.0, pixels = 0.0;
  for (size_t v = 0; v < traced.size(); ++v) {
    const std::vector<float>& a = image[v];
    const float* b = traced[v].picture.data();
    const float* deviation = b + a.size();
    for (size_t i = 0; i < a.size(); i += 4) {
      if (a[i + 3] > 0.0f || b[i + 3] > 0.0f) {
        double x = 0.0;
        for (size_t c = i; c < i + 4; ++c) {
          const double d = static_cast<double>(a[c]) - static_cast<double>(b[c]), e = static_cast<double>(deviation[c]);
          x += 0.25 * (d * d - e * e);
        }
        sum += x;
        squares += x * x;
        pixels += 1.0;
      }
    }
  }
  const double mean = pixels > 0.0 ? sum / pixels : 0.0;
  const double deviation = pixels > 0.0 ? std::sqrt(std::max(squares / pixels - mean * mean, 0.0) / pixels) : 0.0;
  const auto root = [](double x) { return std::sqrt(std::max(x, 0.0)); };
  return { root(mean - 2.0 * deviation), root(mean), root(mean + 2.0 * deviation) };
}

bool is_known(const light_error& e)
{
  return e.high - e.low <= 2.0 * known_enough * e.error;
}

double standard_error(const std::vector<traced_view>& traced)
{
  double squares = 0.0, count = 0.0;
  for (const traced_view& view : traced) {
    const size_t n = view.picture.size() / 2;
    for (size_t i = 0; i < n; i += 4) {
      for (size_t c = 0; view.picture[i + 3] > 0.0f && c < 4; ++c, ++count) {
        const double e = static_cast<double>(view.picture[n + i + c]);
        squares += e * e;
      }
    }
  }
  return count > 0.0 ? std::sqrt(squares / count) : 0.0;
}
} // namespace

light_images draw_light(stratus_context* context, const light_subject& s, const lighting* l, double tolerance, int size)
{
  const std::unique_ptr<light_caster> caster = make_caster(context, s, l, tolerance);
  light_images result;
  for (const int view : judged_views) {
    result.emplace_back(4 * static_cast<size_t>(size) * static_cast<size_t>(size));
    caster->draw(s.cameras[static_cast<size_t>(view)], size, result.back().data());
  }
  return result;
}

light_judgement judge_in_double(
  const light_subject& s, const lighting& l, const std::vector<light_images>& images, const light_effort& how, const std::string& cache)
{
  const double_reference reference(s, l, how.error_size, cache);
  light_judgement result;
  light_images coarse, fine = reference.draw(first_step);
  for (double step = first_step;;) {
    const double start = now_ms();
    step *= 0.5;
    coarse.swap(fine);
    fine = reference.draw(step);
    sum_of_squares self;
    for (size_t v = 0; v < fine.size(); ++v) {
      self.add(coarse[v], fine[v]);
    }
    result.reference_error = self.error();
    result.errors.clear();
    double best = INFINITY;
    for (const light_images& image : images) {
      sum_of_squares sum;
      for (size_t v = 0; v < fine.size(); ++v) {
        sum.add(picked(image[v], how.error_size), fine[v]);
      }
      const double error = sum.error();
      result.errors.push_back({ std::max(error - result.reference_error, 0.0), error, error + result.reference_error });
      best = std::min(best, error);
    }
    // The next picture takes twice as long.
    if (result.reference_error <= agreement * best || 0.5 * step < finest_step || 2.0 * (now_ms() - start) > 1e3 * how.seconds) {
      return result;
    }
  }
}

light_judgement judge_by_paths(stratus_context* context, const light_subject& s, const lighting& l, const std::vector<light_images>& images,
  const light_effort& how, const std::string& cache)
{
  std::vector<std::unique_ptr<path_tracer>> tracers;
  std::vector<traced_view> traced;
  const stratus_path_options options = paths_of(s, l);
  const double numbers[] = { options.albedo, options.anisotropy, static_cast<double>(options.bounces), options.lights[0].vector[0],
    options.lights[0].vector[1], options.lights[0].vector[2], options.lights[0].color[0] };
  const uint64_t hash =
    hash_bytes(hash_bytes(hash_of(*s.volume), STRATUS_BENCH_PATHS, std::strlen(STRATUS_BENCH_PATHS)), numbers, sizeof numbers);
  const auto path_of = [&](int view) {
    char name[160];
    std::snprintf(
      name, sizeof name, "/paths-%s-%016llx-%d-%d.rgba", s.name.c_str(), static_cast<unsigned long long>(hash), how.error_size, view);
    return cache + name;
  };
  const size_t floats = 8 * static_cast<size_t>(how.error_size) * static_cast<size_t>(how.error_size);
  light_judgement result;
  const auto judge_all = [&] {
    result.errors.clear();
    for (const light_images& image : images) {
      result.errors.push_back(compare(image, traced));
    }
    result.samples = traced.front().samples;
    result.reference_error = standard_error(traced);
    result.paths.clear();
    for (const traced_view& view : traced) {
      result.paths.push_back(view.picture);
    }
    return std::all_of(result.errors.begin(), result.errors.end(), is_known);
  };
  // The last float of a file is the number of paths.
  for (const int view : judged_views) {
    traced_view known;
    known.picture.resize(floats + 1);
    if (cache.empty() || !load_picture(path_of(view), known.picture)) {
      break;
    }
    known.samples = static_cast<double>(known.picture.back());
    known.picture.pop_back();
    traced.push_back(known);
  }
  if (traced.size() == std::size(judged_views) && judge_all()) {
    return result;
  }
  const double known_before = traced.size() == std::size(judged_views) ? traced.front().samples : 0.0;
  const std::vector<traced_view> before = traced;
  for (const int view : judged_views) {
    tracers.push_back(std::make_unique<path_tracer>(context, s, l, view, how.error_size));
  }
  traced.assign(tracers.size(), traced_view());
  const double start = now_ms();
  bool enough = false;
  for (int samples = first_paths; !enough; samples *= 2) { // as many as there are, so that the number doubles
    const double round = now_ms();
    for (size_t v = 0; v < tracers.size(); ++v) {
      const stratus_path_report report = tracers[v]->add(traced[v].samples > 0.0 ? samples / 2 : samples);
      traced[v].samples = static_cast<double>(report.samples);
      traced[v].picture = tracers[v]->rgba();
      traced[v].picture.insert(traced[v].picture.end(), tracers[v]->errors().begin(), tracers[v]->errors().end());
    }
    enough = judge_all() || now_ms() - start + 2.0 * (now_ms() - round) > 1e3 * how.seconds || samples > (1 << 24);
  }
  if (known_before > traced.front().samples) { // an earlier run had more time
    traced = before;
    judge_all();
  } else {
    for (size_t v = 0; v < traced.size() && !cache.empty(); ++v) {
      std::vector<float> kept = traced[v].picture;
      kept.push_back(static_cast<float>(traced[v].samples));
      save_picture(path_of(judged_views[v]), kept);
    }
  }
  return result;
}

std::vector<light_path> run_paths(stratus_context* context, const light_subject& s, const lighting& l, const light_effort& how)
{
  path_tracer tracer(context, s, l, 0, how.size);
  std::vector<light_path> result;
  for (int samples = 4; samples <= 1024; samples *= 4) {
    const stratus_path_report report = tracer.add(result.empty() ? samples : samples - result.back().samples);
    result.push_back({ samples, report.seconds, report.standard_error, static_cast<double>(report.vertices) });
    if (4.0 * report.seconds > how.seconds) {
      break;
    }
  }
  return result;
}
} // namespace bench
