// SPDX-License-Identifier: BSD-3-Clause
// Draws pictures in double precision from the stretches of rays in cells, and measures the error of others. Each stretch is split where the
// transfer function bends, then into steps of small optical depth, each integrated by three-point Gauss quadrature. No tables are used.
#include "bench_commit.h"
#include "tetra_bench.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace bench {

namespace {

constexpr double depth_of_step = 0.01;
constexpr double opaque_enough = 1e-9; // transparency at which a ray ends

// The transfer function between two of its points, where opacity and colour are linear.
struct piece {
  double from, to;              // values of the field
  double opacity, opacity_rise; // at x: opacity + opacity_rise (x - from)
  double color[3], color_rise[3];
};

double at_points(const std::vector<double>& points, size_t width, size_t column, double x)
{
  const size_t count = points.size() / width;
  if (x <= points[0]) {
    return points[column];
  }
  for (size_t i = 1; i < count; ++i) {
    const double a = points[width * (i - 1)], b = points[width * i];
    if (x <= b) {
      const double t = (x - a) / (b - a);
      return (1.0 - t) * points[width * (i - 1) + column] + t * points[width * i + column];
    }
  }
  return points[width * (count - 1) + column];
}

// Splits a function into pieces from -infinity to infinity. The benchmark's functions have no steps.
std::vector<piece> pieces_of(const transfer& t)
{
  std::vector<double> bends;
  for (size_t i = 0; i < t.opacity.size(); i += 2) {
    bends.push_back(t.opacity[i]);
  }
  for (size_t i = 0; i < t.color.size(); i += 4) {
    bends.push_back(t.color[i]);
  }
  std::sort(bends.begin(), bends.end());
  bends.erase(std::unique(bends.begin(), bends.end()), bends.end());
  std::vector<piece> pieces;
  for (size_t i = 0; i <= bends.size(); ++i) {
    piece p = {};
    p.from = i == 0 ? -INFINITY : bends[i - 1];
    p.to = i == bends.size() ? INFINITY : bends[i];
    const bool outside = i == 0 || i == bends.size();
    const double a = outside ? bends[i == 0 ? 0 : i - 1] : p.from, b = outside ? a : p.to;
    const auto fill = [&](const std::vector<double>& points, size_t width, size_t column, double& value, double& rise) {
      value = at_points(points, width, column, a);
      rise = outside ? 0.0 : (at_points(points, width, column, b) - value) / (b - a);
    };
    fill(t.opacity, 2, 1, p.opacity, p.opacity_rise);
    for (size_t c = 0; c < 3; ++c) {
      fill(t.color, 4, c + 1, p.color[c], p.color_rise[c]);
    }
    pieces.push_back(p);
  }
  return pieces;
}

class integrator
{
public:
  integrator(const transfer& function, double step) : Pieces(pieces_of(function)), Unit(function.unit_distance), Step(step) {}

  // Draws one ray.
  void ray(const ray_of_pixel& r, float* rgba) const
  {
    double color[3] = { 0, 0, 0 }, left = 1.0;
    for (const stretch& s : r.stretches) {
      this->pass(s.first, s.last, (s.high - s.low) * r.length / this->Unit, color, left);
      if (left < opaque_enough) {
        break;
      }
    }
    for (int c = 0; c < 3; ++c) {
      rgba[c] = static_cast<float>(color[c]);
    }
    rgba[3] = static_cast<float>(1.0 - left);
  }

private:
  // Integrates a stretch. length is in unit distances.
  void pass(double first, double last, double length, double color[3], double& left) const
  {
    const bool rises = last >= first;
    const double low = std::min(first, last), high = std::max(first, last);
    const auto count = static_cast<int>(this->Pieces.size());
    int at = static_cast<int>(std::upper_bound(this->Pieces.begin(), this->Pieces.end(), rises ? low : high,
                                [](double x, const piece& p) { return x < p.from; }) -
               this->Pieces.begin()) -
      1;
    for (int done = 0; done < count && at >= 0 && at < count; ++done, at += rises ? 1 : -1) {
      const piece& p = this->Pieces[static_cast<size_t>(at)];
      const double from = std::max(low, p.from), to = std::min(high, p.to);
      if (from > to || (from == to && high > low)) {
        if (from > to) {
          break;
        }
        continue;
      }
      const double part = high > low ? length * ((to - from) / (high - low)) : length;
      this->within(p, rises ? from : to, rises ? to : from, part, color, left);
      if (high == low) {
        break;
      }
    }
  }

  void within(const piece& p, double first, double last, double length, double color[3], double& left) const
  {
    double tint[3];
    const double depth = gauss(p, first, last, length, tint);
    const int steps = depth > this->Step ? static_cast<int>(std::ceil(std::min(depth / this->Step, 1e6))) : 1;
    for (int i = 0; i < steps && left >= opaque_enough; ++i) {
      const double d =
        steps == 1 ? depth : gauss(p, first + (last - first) * i / steps, first + (last - first) * (i + 1) / steps, length / steps, tint);
      if (d > 0.0) {
        const double alpha = -std::expm1(-d), nearer = d * d * (d / 24.0 - 1.0 / 12.0); // correction: nearer colours count more
        for (int c = 0; c < 3; ++c) {
          color[c] += left * (alpha * tint[c] / d + nearer * p.color_rise[c] * (last - first) / steps);
        }
        left *= 1.0 - alpha;
      }
    }
  }

  // Returns the optical depth; tint: the integral of colour times optical depth.
  static double gauss(const piece& p, double first, double last, double length, double tint[3])
  {
    static const double places[3] = { 0.11270166537925831, 0.5, 0.88729833462074169 }, weights[3] = { 5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0 };
    double depth = 0.0;
    tint[0] = tint[1] = tint[2] = 0.0;
    const double from = std::isfinite(p.from) ? p.from : first; // the function is constant beyond its ends
    for (int i = 0; i < 3; ++i) {
      const double x = first + places[i] * (last - first) - from;
      const double d = -std::log1p(-std::min(p.opacity + p.opacity_rise * x, 1.0 - 1e-12)) * weights[i] * length;
      depth += d;
      for (int c = 0; c < 3; ++c) {
        tint[c] += d * (p.color[c] + p.color_rise[c] * x);
      }
    }
    return depth;
  }

  std::vector<piece> Pieces;
  double Unit, Step;
};

// ---- cached pictures

uint64_t mix(uint64_t hash, const void* data, size_t bytes)
{
  const auto* p = static_cast<const unsigned char*>(data);
  for (size_t i = 0; i < bytes; ++i) {
    hash = (hash ^ p[i]) * 0x100000001B3u;
  }
  return hash;
}

template <typename T> uint64_t mix_all(uint64_t hash, const std::vector<T>& values)
{
  return mix(hash, values.data(), values.size() * sizeof(T));
}

std::string path_of(const tetra_mesh& mesh, const transfer& t, const stratus_camera& camera, int size, const std::string& cache)
{
  uint64_t hash = mix(0xcbf29ce484222325u, STRATUS_BENCH_REFERENCE, std::strlen(STRATUS_BENCH_REFERENCE));
  hash = mix_all(mix_all(mix_all(hash, mesh.points), mesh.vertices), mesh.values);
  hash = mix_all(mix_all(hash, t.opacity), t.color);
  hash = mix(hash, &t.unit_distance, sizeof t.unit_distance);
  for (const double* v : { camera.eye, camera.forward, camera.right, camera.up }) {
    hash = mix(hash, v, 3 * sizeof *v);
  }
  hash = mix(mix(hash, &camera.near_k, sizeof camera.near_k), &camera.parallel, sizeof camera.parallel);
  char name[128];
  std::snprintf(name, sizeof name, "/%.80s-%016llx-%d.rgba", mesh.name.c_str(), static_cast<unsigned long long>(hash), size);
  return cache + name;
}
} // namespace

std::vector<std::vector<float>> tetra_references(const tetra_mesh& mesh, const std::vector<transfer>& functions,
  const stratus_camera& camera, int size, const std::string& cache, std::vector<double>* agreement)
{
  const size_t values = 4 * static_cast<size_t>(size) * static_cast<size_t>(size);
  std::vector<std::vector<float>> pictures(functions.size(), std::vector<float>(values)), coarse;
  bool all = !cache.empty() && !agreement;
  for (size_t i = 0; i < functions.size() && all; ++i) {
    all = load_picture(path_of(mesh, functions[i], camera, size, cache), pictures[i]);
  }
  if (all) {
    return pictures;
  }
  coarse = pictures;
  std::vector<integrator> fine, rough;
  for (const transfer& t : functions) {
    fine.emplace_back(t, depth_of_step);
    rough.emplace_back(t, 4.0 * depth_of_step);
  }
  visit_rays(mesh.view(), camera, size, false, [&](ray_of_pixel& ray) {
    for (size_t i = 0; i < fine.size(); ++i) {
      fine[i].ray(ray, pictures[i].data() + 4 * static_cast<size_t>(ray.pixel));
      if (agreement) {
        rough[i].ray(ray, coarse[i].data() + 4 * static_cast<size_t>(ray.pixel));
      }
    }
  });
  for (size_t i = 0; i < functions.size(); ++i) {
    if (agreement) {
      tetra_error e;
      e.add(coarse[i].data(), pictures[i].data(), values / 4);
      agreement->push_back(e.rmse255());
    }
    if (!cache.empty()) {
      save_picture(path_of(mesh, functions[i], camera, size, cache), pictures[i]);
    }
  }
  return pictures;
}

void tetra_error::add(const float* rgba, const float* reference, size_t pixels)
{
  for (size_t p = 0; p < pixels; ++p) {
    if (rgba[4 * p + 3] > 0.0f || reference[4 * p + 3] > 0.0f) {
      for (size_t c = 4 * p; c < 4 * p + 4; ++c) {
        const double d = 255.0 * (static_cast<double>(rgba[c]) - static_cast<double>(reference[c]));
        this->squares += d * d;
        this->count += 1.0;
      }
    }
  }
}

double tetra_error::rmse255() const
{
  return this->count > 0.0 ? std::sqrt(this->squares / this->count) : INFINITY; // two empty pictures do not count as agreement
}
} // namespace bench
