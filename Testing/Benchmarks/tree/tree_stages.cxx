// SPDX-License-Identifier: BSD-3-Clause
// stratus-bench tree --device: builds of trees, stage by stage, and rays through them, on the host and on an OpenCL device, in turn. The
// set is a volume of bytes, 1 in its voxels, so that the search for voxels is a stage, too; a set of more than 2^30 places is a list.
#include "tree_methods.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <map>
#include <thread>

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

// Lets the host's threads go to sleep: OpenMP's spin for a while after their work, on processors that a device may share with them.
void rest()
{
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

using tree_pointer = std::unique_ptr<stratus_tree, tree_deleter>;

tree_pointer build(stratus_context* c, const voxel_set& set, const std::vector<uint8_t>& values, const stratus_tree_options& options)
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
    std::fill(volume.origin, volume.origin + 3, 0.5); // as in a set of a list, voxel (i,j,k) is [i,i+1] x [j,j+1] x [k,k+1]
    std::copy(set.dimensions, set.dimensions + 3, volume.dimensions);
    criterion.lower = 1.0;
    check_status(c, stratus_voxels_create(c, &volume, &criterion, &made));
  }
  const std::unique_ptr<stratus_voxels, voxels_deleter> voxels(made);
  check_status(c, stratus_tree_create(c, voxels.get(), &options, &tree));
  return tree_pointer(tree);
}

std::vector<uint8_t> bytes_of(const stratus_tree* tree)
{
  std::vector<uint8_t> bytes(stratus_tree_bytes(tree));
  stratus_tree_save(tree, bytes.data());
  return bytes;
}

// Rays of one kind, and the exact hits, found in an octant field.
struct ray_set {
  std::vector<stratus_ray> rays;
  std::vector<stratus_hit> exact;
  std::vector<double> ns[2]; // a ray, on host and device
  int64_t missed = 0, late = 0;
};

void trace(stratus_context* c, const stratus_tree* tree, const std::vector<stratus_ray>& rays, std::vector<stratus_hit>& hits)
{
  hits.resize(rays.size());
  check_status(c, stratus_tree_first_hit(c, tree, rays.data(), rays.size(), hits.data()));
}

void make_rays(stratus_context* c, const voxel_set& set, ray_set kinds[2])
{
  stratus_voxels* made = nullptr;
  stratus_tree_options options = stratus_tree_options_default();
  voxel_rays rays;
  check_status(c, stratus_voxels_create_list(c, set.dimensions, set.positions, set.count, &made));
  const std::unique_ptr<stratus_voxels, voxels_deleter> voxels(made);
  stratus_tree* tree = nullptr;
  check_status(c, stratus_tree_create(c, voxels.get(), &options, &tree));
  const tree_pointer owner(tree);
  for (int kind = 0; kind < 2; ++kind) {
    rays.coherent = kind == 0;
    rays.rays.resize(512 * 512);
    check_status(c, stratus_voxel_scene_rays(c, voxels.get(), kind, rays.rays.data()));
    kinds[kind].rays.clear();
    for (const uint32_t number : tile_order(rays, 8)) {
      kinds[kind].rays.push_back(rays.rays[number]);
    }
    trace(c, tree, kinds[kind].rays, kinds[kind].exact);
  }
}

// Traces once on each side, and counts what differs from the exact hits. Host and device must find the same.
void run_rays(const context_pointer contexts[2], const tree_pointer trees[2], bool timed, ray_set& of)
{
  std::vector<stratus_hit> hits[2];
  for (int side = 0; side < 2; ++side) {
    rest();
    const double start = now_ms();
    trace(contexts[side].get(), trees[side].get(), of.rays, hits[side]);
    if (timed) {
      of.ns[side].push_back((now_ms() - start) * 1e6 / static_cast<double>(of.rays.size()));
    }
  }
  of.missed = of.late = 0;
  for (size_t r = 0; r < of.rays.size(); ++r) {
    const stratus_hit &here = hits[0][r], &there = hits[1][r];
    if (here.t != there.t || std::memcmp(here.voxel, there.voxel, sizeof here.voxel) != 0) {
      throw failure("the hits of host and device differ");
    }
    of.missed += here.voxel[0] < 0 && of.exact[r].voxel[0] >= 0;
    of.late += here.voxel[0] >= 0 && here.t > of.exact[r].t;
    if (here.t < of.exact[r].t) {
      throw failure("a ray hits before its first voxel");
    }
  }
}

void take_report(const stratus_context* c, int side, stages& all)
{
  stratus_build_stage report[STRATUS_BUILD_STAGES_MAX];
  const int count = std::min(stratus_context_get_build_report(c, report, STRATUS_BUILD_STAGES_MAX), STRATUS_BUILD_STAGES_MAX);
  std::map<std::string, double> ms; // a stage may be done at both places
  for (int i = 0; i < count; ++i) {
    ms[report[i].name] += report[i].ms;
    all.of(report[i].name).kernels += side ? report[i].kernels : 0;
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
    const std::string label = name == whole_build ? method : method + " " + name;
    rows.push_back({ scene, label, "host_ms", "ms", host });
    rows.push_back({ scene, label, "device_ms", "ms", there });
    rows.push_back({ scene, label, "kernels", "1", kernels });
  };
  double kernels = 0.0;
  for (const stage& s : all.all) {
    line(s.name, s.ms[0].empty() ? 0.0 : median(s.ms[0]), s.ms[1].empty() ? 0.0 : median(s.ms[1]), static_cast<double>(s.kernels));
    kernels += static_cast<double>(s.kernels);
  }
  line(whole_build, whole[0], whole[1], kernels);
}

void print_rays(const std::string& scene, const std::string& method, const char* kind, const ray_set& of, std::vector<row>& rows)
{
  const double ns[2] = { median(of.ns[0]), median(of.ns[1]) };
  std::fprintf(stderr, "%-20s %7.1f ns %6s %7.1f ns %6s %7s %7.2f  missed %lld, late %lld\n", kind, ns[0], "", ns[1], "", "", ns[1] / ns[0],
    static_cast<long long>(of.missed), static_cast<long long>(of.late));
  const std::string name = kind;
  rows.push_back({ scene, method, "host_" + name + "_ns", "ns", ns[0] });
  rows.push_back({ scene, method, "device_" + name + "_ns", "ns", ns[1] });
  rows.push_back({ scene, method, name + "_missed", "1", static_cast<double>(of.missed) });
  rows.push_back({ scene, method, name + "_late", "1", static_cast<double>(of.late) });
}

} // namespace

void run_stages(const voxel_set& set, const std::string& method, const std::string& device, int rounds, std::vector<row>& rows)
{
  const stratus_tree_options options = tree_options_of(method);
  const context_pointer contexts[2] = { host_context(2), open_context(device.c_str(), 2) };
  const std::vector<uint8_t> values = fill(set);
  stages all;
  ray_set kinds[2];
  make_rays(contexts[0].get(), set, kinds);
  for (int round = -1; round < rounds; ++round) { // the first one waits for OpenCL's compiler
    tree_pointer trees[2];
    for (int side = 0; side < 2; ++side) {
      stratus_context* c = contexts[side].get();
      rest();
      stratus_context_start_build_report(c);
      trees[side] = build(c, set, values, options);
      if (round >= 0) {
        for (stage& s : all.all) {
          s.kernels = side ? 0 : s.kernels;
        }
        take_report(c, side, all);
      }
    }
    if (bytes_of(trees[0].get()) != bytes_of(trees[1].get())) {
      throw failure("the trees of host and device differ");
    }
    for (ray_set& kind : kinds) {
      run_rays(contexts, trees, round >= 0, kind);
    }
  }
  print(set.name, method, stratus_context_device(contexts[1].get()), all, rows);
  print_rays(set.name, method, "primary", kinds[0], rows);
  print_rays(set.name, method, "random", kinds[1], rows);
}

} // namespace bench
