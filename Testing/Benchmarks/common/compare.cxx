// SPDX-License-Identifier: BSD-3-Clause
// stratus-bench compare: prints where a run is slower or less exact than another.
#include "bench.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>

namespace bench {

namespace {

const char* const help = R"(stratus-bench compare A B [--least PERCENT]

A and B are folders that stratus-bench all wrote, A the earlier. Exit status 1 if something of ours got slower or less exact from A to B.

Slower: repeats are compared in pairs, view by view or round by round, at every setting of a method on a scene. The change of the peers'
times in the same scene and process measures the change of the machine; all ratios are divided by it. A sign test over the pairs has to
reject chance (p <= .01), and the median of the ratios has to exceed PERCENT (default 5). Less exact: an error, which no noise changes, grew
by more than 2 %.
)";

constexpr double significance = 0.01;
constexpr double error_growth = 1.02;

using series = std::map<int, double>; // repeat -> ms
// scene -> method -> metric
using repeats_of_scenes = std::map<std::string, std::map<std::string, std::map<std::string, series>>>;
using errors_of_scenes = std::map<std::string, std::map<std::string, double>>; // "scene, method" -> metric

struct run {
  repeats_of_scenes repeats;
  errors_of_scenes errors;
};

// Metrics of error. In dB more is better; they become errors here.
bool error_of(const row& r, double& error)
{
  static const char* const metrics[] = { "rmse255", "rmse255_8bit", "wrong_percent", "wrong_hits", "wrong_culls", "wrong_visible_pairs",
    "false_keeps", "exact_false_keeps", "differing_pixels", "failed" };
  if (r.metric == "psnr_db" || r.metric == "psnr8_db") {
    error = std::pow(10.0, -0.05 * r.value);
    return true;
  }
  error = r.value;
  if (r.metric == "error") { /* of light. Those of paths, and against paths, are random */
    return r.method.rfind("stratus:path", 0) != 0 && r.method.rfind("stratus:multiple", 0) != 0;
  }
  return std::any_of(std::begin(metrics), std::end(metrics), [&](const char* name) { return r.metric == name; });
}

void read(const std::string& path, const std::string& part, run& into)
{
  for (const row& r : read_csv(path).rows) {
    const std::string scene = part + ' ' + r.scene;
    const size_t slash = r.metric.find('/');
    double error = 0.0;
    if (slash != std::string::npos) {
      into.repeats[scene][r.method][r.metric.substr(0, slash)][std::atoi(r.metric.c_str() + slash + 1)] = r.value;
    } else if (is_ours(r.method) && error_of(r, error)) {
      into.errors[scene + ", " + r.method][r.metric] = error;
    }
  }
}

// Adds the logarithms of B's times over A's, for the repeats that both have.
void add_ratios(const series& a, const series& b, std::vector<double>& ratios)
{
  for (const auto& entry : a) {
    const auto other = b.find(entry.first);
    if (other != b.end() && entry.second > 0.0 && other->second > 0.0) {
      ratios.push_back(std::log(other->second / entry.second));
    }
  }
}

// Returns the probability that at least `above` of `count` fair coins show heads.
double by_chance(size_t above, size_t count)
{
  double sum = 0.0, ways = std::lgamma(static_cast<double>(count) + 1.0);
  for (size_t k = above; k <= count; ++k) {
    const double chosen = std::lgamma(static_cast<double>(k) + 1.0) + std::lgamma(static_cast<double>(count - k) + 1.0);
    sum += std::exp(ways - chosen - static_cast<double>(count) * std::log(2.0));
  }
  return sum;
}

// Returns how many of a scene's methods got slower.
int compare_times(const std::string& scene, const repeats_of_scenes& a, const repeats_of_scenes& b, double least)
{
  std::map<std::string, std::map<std::string, std::vector<double>>> ratios; // metric -> family -> ratios
  std::map<std::string, std::vector<double>> of_peers;                      // metric -> the median of each peer's point
  for (const auto& method : a.at(scene)) {
    const auto other = b.at(scene).find(method.first);
    for (const auto& metric : method.second) {
      if (other == b.at(scene).end() || other->second.count(metric.first) == 0) {
        continue;
      }
      std::vector<double> both;
      add_ratios(metric.second, other->second.at(metric.first), both);
      if (is_ours(method.first)) {
        std::vector<double>& all = ratios[metric.first][family_of(method.first)];
        all.insert(all.end(), both.begin(), both.end());
      } else if (!both.empty()) {
        of_peers[metric.first].push_back(median(both));
      }
    }
  }
  int slower = 0;
  for (const auto& metric : ratios) {
    const double machine = median(of_peers[metric.first]); // 0 without peers
    for (const auto& family : metric.second) {
      std::vector<double> own;
      std::transform(family.second.begin(), family.second.end(), std::back_inserter(own), [&](double r) { return r - machine; });
      const auto above = static_cast<size_t>(std::count_if(own.begin(), own.end(), [](double r) { return r > 0.0; }));
      const double change = 100.0 * std::expm1(median(own));
      if (change > least && by_chance(above, own.size()) <= significance) {
        std::printf("slower: %s, %s, %s: %+.1f %% in the median, in %zu of %zu pairs (the machine: %+.1f %%)\n", scene.c_str(),
          family.first.c_str(), metric.first.c_str(), change, above, own.size(), 100.0 * std::expm1(machine));
        ++slower;
      }
    }
  }
  return slower;
}

int compare_errors(const errors_of_scenes& a, const errors_of_scenes& b)
{
  int worse = 0;
  for (const auto& entry : b) {
    const auto before = a.find(entry.first);
    for (const auto& metric : entry.second) {
      const bool known = before != a.end() && before->second.count(metric.first) > 0;
      const double was = known ? before->second.at(metric.first) : 0.0;
      const bool failed = metric.first == "failed";
      if ((known || (failed && before != a.end())) && metric.second > error_growth * was) {
        std::printf(
          "%s: %s, %s: %.4g after %.4g\n", failed ? "fails" : "less exact", entry.first.c_str(), metric.first.c_str(), metric.second, was);
        ++worse;
      }
    }
  }
  return worse;
}
} // namespace

int compare_main(int argc, char* argv[])
{
  double least = 5.0;
  if (argc > 2 && std::strcmp(argv[2], "--help") == 0) {
    std::fputs(help, stdout);
    return 0;
  }
  if (argc == 6 && std::strcmp(argv[4], "--least") == 0) {
    char* end = nullptr;
    least = std::strtod(argv[5], &end);
    if (*end != '\0' || !(least >= 0.0 && least <= 1000.0)) {
      throw failure(std::string("--least must be within 0..1000 percent, not ") + argv[5]);
    }
  } else if (argc != 4) {
    throw failure("compare needs two folders; see --help");
  }
  run runs[2];
  for (int i = 0; i < 2; ++i) {
    bool any = false;
    for (const std::string& part : parts_of_all()) {
      const std::string path = std::string(argv[2 + i]) + '/' + part + ".csv";
      any = any || std::ifstream(path);
      read(path, part, runs[i]);
    }
    if (!any) {
      throw failure(std::string(argv[2 + i]) + " holds no table of stratus-bench all");
    }
  }
  int worse = compare_errors(runs[0].errors, runs[1].errors), scenes = 0;
  for (const auto& scene : runs[0].repeats) {
    if (runs[1].repeats.count(scene.first) == 0) {
      std::printf("not in %s: %s\n", argv[3], scene.first.c_str());
      continue;
    }
    worse += compare_times(scene.first, runs[0].repeats, runs[1].repeats, least);
    ++scenes;
  }
  std::printf("%d scenes compared, %d findings\n", scenes, worse);
  return worse > 0 ? 1 : 0;
}
} // namespace bench
