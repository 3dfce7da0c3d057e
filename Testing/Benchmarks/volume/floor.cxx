// SPDX-License-Identifier: BSD-3-Clause
// Method `floor` estimates the time of an ideal ray caster. It counts the samples with alpha > 0, one voxel apart, until each ray is
// opaque, and divides by the sample rate of a tight loop. It is no lower bound: a caster that places samples differently can take fewer of
// them, as in scene fog.
#include "bench.h"
#include "rate.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bench {

namespace {

constexpr int block = 8;

class counter
{
public:
  counter(const scene& s);
  double count(const stratus_camera& camera, int size) const;

private:
  double value(int64_t i, int64_t j, int64_t k) const;
  double opacity(double value) const;
  double trace(const double origin[3], const double direction[3], double step) const;

  const scene& Scene;
  int64_t Blocks[3];
  std::vector<uint8_t> Shown;
};

double counter::value(int64_t i, int64_t j, int64_t k) const
{
  const stratus_volume& v = this->Scene.volume;
  const size_t at = static_cast<size_t>((k * v.dimensions[1] + j) * v.dimensions[0] + i);
  return v.type == STRATUS_UINT8 ? static_cast<const uint8_t*>(v.values)[at]
    : v.type == STRATUS_FLOAT32  ? static_cast<double>(static_cast<const float*>(v.values)[at])
                                 : static_cast<const double*>(v.values)[at];
}

double counter::opacity(double value) const
{
  const std::vector<double>& p = this->Scene.first.opacity;
  if (value <= p[0]) {
    return p[1];
  }
  for (size_t i = 2; i < p.size(); i += 2) {
    if (value <= p[i]) {
      return p[i - 1] + (value - p[i - 2]) / (p[i] - p[i - 2]) * (p[i + 1] - p[i - 1]);
    }
  }
  return p.back();
}

counter::counter(const scene& s) : Scene(s)
{
  const int64_t* n = s.volume.dimensions;
  for (int a = 0; a < 3; ++a) {
    this->Blocks[a] = (n[a] + block - 1) / block;
  }
  const int64_t blocks = this->Blocks[0] * this->Blocks[1] * this->Blocks[2];
  this->Shown.resize(static_cast<size_t>(blocks));
#pragma omp parallel for
  for (int64_t b = 0; b < blocks; ++b) {
    const int64_t at[3] = { b % this->Blocks[0] * block, b / this->Blocks[0] % this->Blocks[1] * block,
      b / this->Blocks[0] / this->Blocks[1] * block };
    double lo = std::numeric_limits<double>::infinity();
    double hi = -lo;
    for (int64_t k = at[2]; k <= std::min(at[2] + block, n[2] - 1); ++k) {
      for (int64_t j = at[1]; j <= std::min(at[1] + block, n[1] - 1); ++j) {
        for (int64_t i = at[0]; i <= std::min(at[0] + block, n[0] - 1); ++i) {
          lo = std::min(lo, this->value(i, j, k));
          hi = std::max(hi, this->value(i, j, k));
        }
      }
    }
    bool shown = this->opacity(lo) > 0.0 || this->opacity(hi) > 0.0;
    for (size_t i = 0; i < s.first.opacity.size(); i += 2) {
      shown = shown || (s.first.opacity[i] >= lo && s.first.opacity[i] <= hi && s.first.opacity[i + 1] > 0.0);
    }
    this->Shown[static_cast<size_t>(b)] = shown;
  }
}

double counter::trace(const double origin[3], const double direction[3], double step) const
{
  const int64_t* n = this->Scene.volume.dimensions;
  double begin = 0.0;
  double end = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a) {
    const double t0 = -origin[a] / direction[a];
    const double t1 = (static_cast<double>(n[a] - 1) - origin[a]) / direction[a];
    begin = std::max(begin, std::min(t0, t1));
    end = std::min(end, std::max(t0, t1));
  }
  double left = 1.0;
  double count = 0.0;
  for (double t = (std::floor(begin / step - 0.5) + 1.5) * step; t < end && left > 0.001; t += step) {
    int64_t i[3];
    double f[3];
    int64_t b = 0;
    for (int a = 2; a >= 0; --a) {
      const double x = origin[a] + t * direction[a];
      i[a] = std::min(std::max(static_cast<int64_t>(x), int64_t{ 0 }), std::max(n[a] - 2, int64_t{ 0 }));
      f[a] = x - static_cast<double>(i[a]);
      b = b * this->Blocks[a] + i[a] / block;
    }
    if (!this->Shown[static_cast<size_t>(b)]) {
      continue;
    }
    double v = 0.0;
    for (int c = 0; c < 8; ++c) {
      v += (c & 1 ? f[0] : 1 - f[0]) * (c & 2 ? f[1] : 1 - f[1]) * (c & 4 ? f[2] : 1 - f[2]) *
        this->value(std::min(i[0] + (c & 1), n[0] - 1), std::min(i[1] + (c >> 1 & 1), n[1] - 1), std::min(i[2] + (c >> 2), n[2] - 1));
    }
    const double alpha = this->opacity(v);
    if (alpha > 0.0) {
      count += 1.0;
      left *= std::pow(1.0 - alpha, step / this->Scene.first.unit_distance);
    }
  }
  return count;
}

double counter::count(const stratus_camera& camera, int size) const
{
  double total = 0.0;
#pragma omp parallel for schedule(dynamic, 4) reduction(+ : total)
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      double direction[3];
      double origin[3];
      double length = 0.0;
      for (int a = 0; a < 3; ++a) {
        direction[a] = camera.forward[a] + ((2.0 * x + 1.0) / size - 1.0) * camera.right[a] + ((2.0 * y + 1.0) / size - 1.0) * camera.up[a];
        length += direction[a] * direction[a];
      }
      for (int a = 0; a < 3; ++a) { // scenes are not rotated
        direction[a] /= std::sqrt(length) * this->Scene.volume.spacing[a];
        origin[a] = (camera.eye[a] - this->Scene.volume.origin[a]) / this->Scene.volume.spacing[a];
      }
      total += this->trace(origin, direction, this->Scene.voxel);
    }
  }
  return total;
}
} // namespace

floor_result run_floor(stratus_context* context, const scene& s, int size)
{
  const counter c(s);
  floor_result f;
  std::vector<double> counts;
  for (int view = 0; view < views; ++view) {
    counts.push_back(c.count(camera_of(context, s, view), size));
  }
  f.samples = median(counts);
  f.rate = bench_sample_rate();
  f.ms = 1e3 * f.samples / f.rate;
  return f;
}
} // namespace bench
