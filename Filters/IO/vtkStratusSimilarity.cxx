// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusSimilarity.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace {
constexpr int Window = vtkStratusSimilarityWindow;

std::array<double, Window> WindowWeights()
{
  std::array<double, Window> weights;
  double sum = 0.0;
  for (int i = 0; i < Window; ++i) {
    const double at = (i - Window / 2) / 1.5;
    sum += weights[static_cast<size_t>(i)] = std::exp(-0.5 * at * at);
  }
  for (double& weight : weights) {
    weight /= sum;
  }
  return weights;
}

// Weighted means over all windows within the picture: of `value(pixel)`, first along x, then along y.
template <typename Value> std::vector<double> WindowMeans(int width, int height, Value value)
{
  const std::array<double, Window> weights = WindowWeights();
  const auto columns = static_cast<size_t>(width - Window + 1), rows = static_cast<size_t>(height - Window + 1);
  std::vector<double> along(columns * static_cast<size_t>(height)), means(columns * rows);
  for (size_t y = 0; y < static_cast<size_t>(height); ++y) {
    for (size_t x = 0; x < columns; ++x) {
      for (size_t i = 0; i < Window; ++i) {
        along[y * columns + x] += weights[i] * value(y * static_cast<size_t>(width) + x + i);
      }
    }
  }
  for (size_t y = 0; y < rows; ++y) {
    for (size_t i = 0; i < Window; ++i) {
      for (size_t x = 0; x < columns; ++x) {
        means[y * columns + x] += weights[i] * along[(y + i) * columns + x];
      }
    }
  }
  return means;
}
} // namespace

double vtkStratusSimilarity(const std::vector<double>& a, const std::vector<double>& b, int width, int height)
{
  const auto means = [&](auto value) { return WindowMeans(width, height, value); };
  const std::vector<double> of_a = means([&a](size_t i) { return a[i]; }), of_b = means([&b](size_t i) { return b[i]; });
  const std::vector<double> of_aa = means([&a](size_t i) { return a[i] * a[i]; }), of_bb = means([&b](size_t i) { return b[i] * b[i]; });
  const std::vector<double> of_ab = means([&a, &b](size_t i) { return a[i] * b[i]; });
  constexpr double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
  double sum = 0.0;
  for (size_t i = 0; i < of_a.size(); ++i) {
    const double product = of_a[i] * of_b[i], squares = of_a[i] * of_a[i] + of_b[i] * of_b[i];
    sum += (2.0 * product + c1) * (2.0 * (of_ab[i] - product) + c2) / ((squares + c1) * (of_aa[i] + of_bb[i] - squares + c2));
  }
  return sum / static_cast<double>(of_a.size());
}
