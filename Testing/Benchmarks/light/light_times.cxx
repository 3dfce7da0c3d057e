// SPDX-License-Identifier: BSD-3-Clause
// Times of lit frames next to unlit ones, and of the maps of light, repeated until their medians are known.
#include "light_bench.h"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace bench {

namespace {

constexpr double confidence = 0.95;
// A median is known if its interval is within this fraction of it, on both sides.
constexpr double narrow = 0.03;
constexpr int most_rounds = 60, warm_frames = 4; // the first frames build and try structures

double processor_ms()
{
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

bool is_narrow(const interval& i)
{
  return i.known && i.high - i.low <= 2.0 * narrow * i.median;
}

struct spent {
  double ms = 0.0, processor = 0.0;
};

void draw_timed(light_caster& caster, const stratus_camera& camera, int size, float* rgba, light_caster::report& report, spent& sum)
{
  const double start = now_ms(), processor = processor_ms();
  report = caster.draw(camera, size, rgba);
  sum.ms += now_ms() - start;
  sum.processor += processor_ms() - processor;
}

// Measure maps. Their ms are in the report of a volume. Other times are differences of two frames, with new maps and without.
void time_maps(light_caster& lit, const light_subject& s, const light_effort& how, float* rgba, light_times& times)
{
  std::vector<double> ms, processor;
  const double start = now_ms();
  do {
    light_caster::report report;
    spent built, kept;
    lit.move_light();
    draw_timed(lit, s.cameras.front(), how.size, rgba, report, built);
    const double reported = report.maps_ms;
    draw_timed(lit, s.cameras.front(), how.size, rgba, report, kept);
    ms.push_back(reported >= 0.0 ? reported : built.ms - kept.ms);
    processor.push_back(built.processor - kept.processor);
    times.maps = median_interval(ms);
  } while (!is_narrow(times.maps) && static_cast<int>(ms.size()) < most_rounds && now_ms() - start < 1e3 * how.seconds);
  times.maps_processor_ratio = median(processor);
}
} // namespace

interval median_interval(std::vector<double> values)
{
  interval result = { 0.0, median(values), 0.0, false };
  std::sort(values.begin(), values.end());
  const size_t n = values.size();
  // The true median is below the k-th smallest value if fewer than k values are below it, which are the tails of a binomial distribution.
  size_t cut = 0;
  double tail = std::pow(0.5, static_cast<double>(n)), term = tail;
  while (2.0 * tail <= 1.0 - confidence) {
    ++cut;
    term *= static_cast<double>(n - cut + 1) / static_cast<double>(cut);
    tail += term;
  }
  result.known = cut > 0;
  result.low = values[result.known ? cut - 1 : 0];
  result.high = values[n - std::max<size_t>(cut, 1)];
  return result;
}

light_times time_light(stratus_context* context, const light_subject& s, const lighting& l, double tolerance, const light_effort& how)
{
  light_times result;
  std::vector<float> rgba(4 * static_cast<size_t>(how.size) * static_cast<size_t>(how.size));
  const std::unique_ptr<light_caster> unlit = make_caster(context, s, nullptr, tolerance);
  const std::unique_ptr<light_caster> lit = make_caster(context, s, &l, tolerance);
  light_caster::report report;
  for (int frame = 0; frame < warm_frames; ++frame) {
    const stratus_camera& camera = s.cameras[static_cast<size_t>(frame % views)];
    unlit->draw(camera, how.size, rgba.data());
    lit->draw(camera, how.size, rgba.data());
  }
  std::vector<double> unlit_ms, lit_ms, unlit_processor, ratios, processor_ratios;
  const double start = now_ms();
  do {
    spent of[2];
    for (const stratus_camera& camera : s.cameras) {
      draw_timed(*unlit, camera, how.size, rgba.data(), report, of[0]);
      draw_timed(*lit, camera, how.size, rgba.data(), result.report, of[1]);
    }
    unlit_ms.push_back(of[0].ms / views);
    lit_ms.push_back(of[1].ms / views);
    unlit_processor.push_back(of[0].processor / views);
    ratios.push_back(of[1].ms / of[0].ms);
    processor_ratios.push_back(of[1].processor / of[0].processor);
    result.ratio = median_interval(ratios);
    result.frame = median_interval(lit_ms);
  } while (!(is_narrow(result.ratio) && is_narrow(result.frame)) && static_cast<int>(ratios.size()) < most_rounds &&
    now_ms() - start < 1e3 * how.seconds);
  result.unlit = median_interval(unlit_ms);
  result.processor_ratio = median(processor_ratios);
  result.rounds = static_cast<int>(ratios.size());
  if (l.shadows) {
    time_maps(*lit, s, how, rgba.data(), result);
    result.maps_processor_ratio /= median(unlit_processor);
  }
  return result;
}
} // namespace bench
