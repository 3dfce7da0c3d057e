// SPDX-License-Identifier: BSD-3-Clause
// stratus-bench tree --device: what a tree is built of, stage by stage, on the host and on an OpenCL device, in turn. The set is a volume
// of bytes, 1 in its voxels, so that the search for voxels is a stage, too; a set of more than 2^30 places is a list.
#include "tree_methods.h"

#include <algorithm>
#include <cstring>
#include <map>

namespace bench {

namespace {

constexpr int64_t dense_most = int64_t(1) << 30;
const char* const whole_build = "all"; // stages

// Milliseconds of the rounds and the kernels of one stage.
struct stage {
  std::string name;
  std::vector<double> ms[2]; // host, device
  uint64_t kernels = 0;      // of the device's last round
};

struct stages {
  std::vector<stage> all;
  stage& of(const char* name)
  {
    for (stage& s : this->all) {
      if (s.name == name) {
        return s;
      }
    }
    this->all.push_back(stage());
    this->all.back().name = name;
    return this->all.back();
  }
};

struct voxels_deleter {
  void operator()(stratus_voxels* v) const { stratus_voxels_destroy(v); }
};
struct tree_deleter {
  void operator()(stratus_tree* t) const { stratus_tree_destroy(t); }
};

std::vector<uint8_t> fill(const voxel_set& set)
{
  const int64_t* n = set.dimensions;
  std::vector<uint8_t> values;
  if (n[0] * n[1] * n[2] <= dense_most) {
    values.resize(static_cast<size_t>(n[0] * n[1] * n[2]));
    for (size_t v = 0; v < set.count; ++v) {
      const int32_t* at = set.positions + 3 * v;
      values[static_cast<size_t>((at[2] * n[1] + at[1]) * n[0] + at[0])] = 1;
    }
  }
  return values;
}

// Builds a tree once; returns its bytes.
std::vector<uint8_t> build(
  stratus_context* c, const voxel_set& set, const std::vector<uint8_t>& values, const stratus_tree_options& options)
{
  stratus_voxels* made = nullptr;
  stratus_tree* tree = nullptr;
  if (values.empty()) {
    check_status(c, stratus_voxels_create_list(c, set.dimensions, set.positions, set.count, &made));
  } else {
    stratus_volume volume = stratus_volume_default();
    stratus_criterion criterion = stratus_criterion_default();
    volume.values = values.data();
    volume.type = STRATUS_UINT8;
    std::copy(set.dimensions, set.dimensions + 3, volume.dimensions);
    criterion.lower = 1.0;
    check_status(c, stratus_voxels_create(c, &volume, &criterion, &made));
  }
  const std::unique_ptr<stratus_voxels, voxels_deleter> voxels(made);
  check_status(c, stratus_tree_create(c, voxels.get(), &options, &tree));
  const std::unique_ptr<stratus_tree, tree_deleter> owner(tree);
  std::vector<uint8_t> bytes(stratus_tree_bytes(tree));
  stratus_tree_save(tree, bytes.data());
  return bytes;
}

void take_report(const stratus_context* c, int side, stages& all)
{
  stratus_build_stage told[STRATUS_BUILD_STAGES_MAX];
  const int count = std::min(stratus_context_get_build_report(c, told, STRATUS_BUILD_STAGES_MAX), STRATUS_BUILD_STAGES_MAX);
  std::map<std::string, double> ms; // a stage may be done at both places
  for (int i = 0; i < count; ++i) {
    ms[told[i].name] += told[i].ms;
    all.of(told[i].name).kernels += side ? told[i].kernels : 0;
  }
  for (const auto& one : ms) {
    all.of(one.first.c_str()).ms[side].push_back(one.second);
  }
}

double sum(const stages& all, int side)
{
  double ms = 0.0;
  for (const stage& s : all.all) {
    ms += s.ms[side].empty() ? 0.0 : median(s.ms[side]);
  }
  return ms;
}

void print(const std::string& scene, const std::string& method, const std::string& device, const stages& all, std::vector<row>& rows)
{
  const double whole[2] = { sum(all, 0), sum(all, 1) };
  std::fprintf(stderr, "%s, %s: host, and %s\n%-20s %10s %6s %10s %6s %7s %7s\n", scene.c_str(), method.c_str(), device.c_str(), "",
    "host_ms", "share", "device_ms", "share", "kernels", "ratio");
  const auto line = [&](const std::string& name, double host, double there, double kernels) {
    std::fprintf(stderr, "%-20s %10.3f %6.3f %10.3f %6.3f %7.0f %7.2f\n", name.c_str(), host, host / whole[0], there, there / whole[1],
      kernels, there / host);
    const std::string told = name == whole_build ? method : method + " " + name;
    rows.push_back({ scene, told, "host_ms", "ms", host });
    rows.push_back({ scene, told, "device_ms", "ms", there });
    rows.push_back({ scene, told, "kernels", "1", kernels });
  };
  double kernels = 0.0;
  for (const stage& s : all.all) {
    line(s.name, s.ms[0].empty() ? 0.0 : median(s.ms[0]), s.ms[1].empty() ? 0.0 : median(s.ms[1]), static_cast<double>(s.kernels));
    kernels += static_cast<double>(s.kernels);
  }
  line(whole_build, whole[0], whole[1], kernels);
}

} // namespace

void run_stages(const voxel_set& set, const std::string& method, const std::string& device, int rounds, std::vector<row>& rows)
{
  const stratus_tree_options options = tree_options_of(method);
  const context_pointer contexts[2] = { host_context(2), open_context(device.c_str(), 2) };
  const std::vector<uint8_t> values = fill(set);
  stages all;
  std::vector<uint8_t> bytes[2];
  for (int round = -1; round < rounds; ++round) { // the first one waits for OpenCL's compiler
    for (int side = 0; side < 2; ++side) {
      stratus_context* c = contexts[side].get();
      stratus_context_start_build_report(c);
      bytes[side] = build(c, set, values, options);
      if (round >= 0) {
        for (stage& s : all.all) {
          s.kernels = side ? 0 : s.kernels;
        }
        take_report(c, side, all);
      }
    }
    if (bytes[0] != bytes[1]) {
      throw failure("the trees of host and device differ");
    }
  }
  print(set.name, method, stratus_context_device(contexts[1].get()), all, rows);
}

} // namespace bench
