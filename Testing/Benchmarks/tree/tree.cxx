// SPDX-License-Identifier: BSD-3-Clause
// stratus-bench tree: build and trace times of trees over effective voxels, compared with Embree and OpenVDB, in one process.
#include "tree_methods.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <thread>
#include <time.h>

namespace bench {

namespace {

const char* const help = R"(stratus-bench tree [options]

  --scene NAME,...   17K 24K 30K 35K u225 u367 u571 u640 1M 10M, and cloud: the values > 0 of the volume (default: all)
                     archipelago, archipelago-1024 (the values > 0 of that volume) and islets take much memory: only where named
                     clusters:NUMBER, generated clusters apart from each other, among which random rays begin: only where named
  --method M,...     stratus:hybrid|hybrid-paper|hybrid-paper-raw|distance|octant|sah|sweep|lbvh|ploc|ac|ac-edges|dpc|kmeans|wide|
                     auto, all but distance, octant, wide and auto with :N behind it, bricks (the first three) or voxels in a leaf;
                     embree:low|medium|high, embree:packet and embree:bricks with :low or :high behind it or neither (medium),
                     openvdb (default: all; stratus:hybrid-paper, hybrid-paper-raw, ac, ac-edges, dpc and kmeans grow faster than n log n
                     and take sets of up to 35,000 voxels)
  --curves           methods over their settings; --quick-curves: without the slow ones
  --device NAME      only ours, on the host and on this OpenCL device (an index or a part of its name): builds stage by stage, ms, share
                     and kernels; rays, ns, and hits missed or late (default methods: stratus:hybrid|
                     hybrid-paper|hybrid-paper-raw|distance|octant|lbvh|ploc|wide)
  --rounds N         measurements of each method, one after the other in turn (default 5; 2 for 10M)
  --csv FILE         tidy rows: benchmark,scene,method,metric,value,unit (default: the standard output)
                     the comments before them say where they come from, as in stratus-bench volume
  --append           rows of other scenes that the file has stay
  --chart FILE.png   tracing against building

build_ms                  wall clock from the list of voxels to a tree that rays can use, 2 threads, median
primary_ns, random_ns     processor time a ray, one thread, median; 512 x 512 rays of record each
away_ns                   the same for the primary rays turned round, which miss the whole set: reading rays and writing hits
bytes                     the tree's memory (Embree: as its monitor reports after the build, without the list of voxels that its
                          callbacks read)
primary_visits, random_visits  ours: nodes and steps in distance fields a ray; a beam's rays share its visits
wrong_hits                among both kinds of rays, against a walk from voxel to voxel in double precision
grazing_hits              hits that differ where a ray meets a voxel for less than 1e-9 of the numbers around, or two at once
missed_hits, late_hits    in place of wrong_hits of stratus:hybrid-paper-raw, whose leaves keep raw flooded distances: the wrong hits
                          that find no voxel, or one behind the walk's
With --device: host_ms, device_ms, kernels of METHOD and of "METHOD STAGE", medians of the rounds; a failure if the two trees differ.
)";

constexpr int width = 512;
constexpr size_t slow_most = 35000;
constexpr double build_budget_ms = 20.0; // short builds are repeated within a round

// Methods whose builds have stages that a device does.
const std::vector<std::string> device_methods = { "stratus:hybrid", "stratus:hybrid-paper", "stratus:hybrid-paper-raw", "stratus:distance",
  "stratus:octant", "stratus:lbvh", "stratus:ploc", "stratus:wide" };

struct options {
  std::vector<std::string> scenes, methods;
  std::string csv = "-", chart, device;
  int rounds = 0;
  bool append = false;
};

double thread_ms()
{
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

// ---------------------------------------------------------------- one scene

// A set of voxels, built-in or the cloud's, with its rays and the plain walk's hits.
struct tree_scene {
  context_pointer context = host_context(0);
  voxel_set set;
  std::vector<int32_t> own;       // positions of a set that is not built in
  std::vector<cluster_box> boxes; // of a generated set
  int32_t* listed = nullptr;
  stratus_voxels* voxels = nullptr;
  voxel_rays rays[2], away; // away: the primary rays turned round
  std::vector<stratus_hit> walk[2];

  explicit tree_scene(const std::string& name);
  ~tree_scene()
  {
    stratus_voxels_destroy(this->voxels);
    stratus_voxel_scene_release(this->context.get(), this->listed);
  }
  void list_volume(const std::string& name);
  void walk_plainly(); // fills voxels, rays and walk
};

void tree_scene::list_volume(const std::string& name)
{
  stratus_scene* scene = nullptr;
  check_status(this->context.get(), stratus_scene_create(this->context.get(), name.c_str(), &scene));
  const int64_t* n = scene->volume.dimensions;
  const float* floats = static_cast<const float*>(scene->volume.values);
  const uint8_t* bytes = static_cast<const uint8_t*>(scene->volume.values);
  const bool whole = scene->volume.type == STRATUS_UINT8;
  for (int64_t v = 0; v < n[0] * n[1] * n[2]; ++v) {
    if (whole ? bytes[v] > 0 : floats[v] > 0.0f) {
      this->own.insert(
        this->own.end(), { static_cast<int32_t>(v % n[0]), static_cast<int32_t>(v / n[0] % n[1]), static_cast<int32_t>(v / n[0] / n[1]) });
    }
  }
  std::copy(n, n + 3, this->set.dimensions);
  this->set.positions = this->own.data();
  this->set.count = this->own.size() / 3;
  stratus_scene_destroy(this->context.get(), scene);
}

tree_scene::tree_scene(const std::string& name)
{
  stratus_context* c = this->context.get();
  this->set.name = name;
  if (name == "cloud" || name == "archipelago-1024") {
    this->list_volume(name);
  } else if (is_cluster_scene(name)) {
    make_cluster_set(name, this->set.dimensions, this->own, this->boxes);
    this->set.positions = this->own.data();
    this->set.count = this->own.size() / 3;
  } else {
    check_status(c, stratus_voxel_scene_create(c, name.c_str(), this->set.dimensions, &this->listed, &this->set.count));
    this->set.positions = this->listed;
  }
}

void tree_scene::walk_plainly()
{
  stratus_context* c = this->context.get();
  check_status(c, stratus_voxels_create_list(c, this->set.dimensions, this->set.positions, this->set.count, &this->voxels));
  for (int kind = 0; kind < 2; ++kind) {
    this->rays[kind].coherent = kind == 0;
    this->rays[kind].rays.resize(width * width);
    this->walk[kind].resize(width * width);
    if (kind == 1 && !this->boxes.empty()) {
      make_cluster_rays(this->voxels, this->boxes, this->rays[kind].rays);
    } else {
      check_status(c, stratus_voxel_scene_rays(c, this->voxels, kind, this->rays[kind].rays.data()));
    }
    check_status(c, stratus_voxels_first_hit(c, this->voxels, this->rays[kind].rays.data(), width * width, this->walk[kind].data()));
  }
  this->away = this->rays[0];
  for (stratus_ray& ray : this->away.rays) {
    for (double& d : ray.direction) {
      d = -d;
    }
  }
}

struct measured {
  std::vector<double> build_ms, trace_ns[2], away_ns;
  double visits[2] = { -1.0, -1.0 };
  tree_numbers numbers;
  wrong_count count;
};

// The time of a ray.
double trace_ns(first_hits& hits, const voxel_rays& rays)
{
  hits.prepare(rays);
  const double start = thread_ms();
  hits.trace();
  return (thread_ms() - start) * 1e6 / static_cast<double>(rays.rays.size());
}

void run_round(const tree_scene& scene, const std::string& method, bool first, measured& m)
{
  // The previous method's idle threads spin for a while. Wait, so that they do not slow the next method.
  std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const std::unique_ptr<first_hits> hits = make_hits(scene.set, method);
  double spent = 0.0;
  do {
    const double start = now_ms();
    hits->build();
    m.build_ms.push_back(now_ms() - start);
    spent += m.build_ms.back();
  } while (spent < build_budget_ms);
  m.numbers = hits->numbers();
  for (int kind = 0; kind < 2; ++kind) {
    m.trace_ns[kind].push_back(trace_ns(*hits, scene.rays[kind]));
    if (first) {
      m.visits[kind] = hits->visits();
      const wrong_count count = count_wrong(scene.voxels, scene.rays[kind], scene.walk[kind], hits->hits());
      m.count.wrong += count.wrong;
      m.count.grazing += count.grazing;
      m.count.missed += count.missed;
      m.count.late += count.late;
    }
  }
  m.away_ns.push_back(trace_ns(*hits, scene.away));
}

void add_rows(const std::string& scene, const std::string& method, const measured& m, std::vector<row>& rows)
{
  const auto add = [&](const char* metric, double value, const char* unit) {
    if (value >= 0.0) {
      rows.push_back({ scene, method, metric, unit, value });
    }
  };
  add_repeats(scene, method, "build_ms", "ms", m.build_ms, rows);
  add_repeats(scene, method, "primary_ns", "ns", m.trace_ns[0], rows);
  add_repeats(scene, method, "random_ns", "ns", m.trace_ns[1], rows);
  add("build_ms", median(m.build_ms), "ms");
  add("primary_ns", median(m.trace_ns[0]), "ns");
  add("random_ns", median(m.trace_ns[1]), "ns");
  add("away_ns", median(m.away_ns), "ns");
  add("primary_visits", m.visits[0], "1");
  add("random_visits", m.visits[1], "1");
  add("bytes", m.numbers.bytes, "B");
  add("nodes", m.numbers.nodes, "1");
  add("depth", m.numbers.depth, "1");
  add("sah", m.numbers.sah, "1");
  if (may_err(method)) {
    add("missed_hits", static_cast<double>(m.count.missed), "1");
    add("late_hits", static_cast<double>(m.count.late), "1");
  } else {
    add("wrong_hits", static_cast<double>(m.count.wrong), "1");
  }
  add("grazing_hits", static_cast<double>(m.count.grazing), "1");
}

void run_scene(const std::string& name, const options& o, std::vector<row>& rows)
{
  tree_scene scene(name);
  scene.walk_plainly();
  std::fprintf(stderr, "%s: %zu voxels\n%-22s %10s %10s %10s %12s %9s %5s %9s %6s %8s %6s %5s\n", name.c_str(), scene.set.count, "",
    "build_ms", "primary_ns", "random_ns", "bytes", "nodes", "depth", "sah", "wrong", "grazing", "missed", "late");
  const int rounds = o.rounds ? o.rounds : scene.set.count > 5000000 ? 2 : 5;
  std::vector<std::string> methods;
  std::copy_if(o.methods.begin(), o.methods.end(), std::back_inserter(methods),
    [&](const std::string& m) { return scene.set.count <= slow_most || !is_slow_tree(m); });
  std::map<std::string, measured> all;
  for (int round = 0; round < rounds; ++round) {
    for (auto method = methods.begin(); method != methods.end();) {
      try {
        run_round(scene, *method, round == 0, all[*method]);
        ++method;
      } catch (const failure& e) {
        add_failure(name, *method, e.what(), rows);
        method = methods.erase(method);
      }
    }
  }
  for (const std::string& method : methods) {
    const measured& m = all[method];
    std::fprintf(stderr, "%-22s %10.3f %10.1f %10.1f %12.0f %9.0f %5.0f %9.1f %6lld %8lld %6lld %5lld\n", method.c_str(),
      median(m.build_ms), median(m.trace_ns[0]), median(m.trace_ns[1]), m.numbers.bytes, m.numbers.nodes, m.numbers.depth, m.numbers.sah,
      static_cast<long long>(m.count.wrong), static_cast<long long>(m.count.grazing), static_cast<long long>(m.count.missed),
      static_cast<long long>(m.count.late));
    add_rows(name, method, m, rows);
  }
}

void run_device(const std::string& name, const options& o, std::vector<row>& rows)
{
  const tree_scene scene(name);
  for (const std::string& method : o.methods) {
    if (scene.set.count > slow_most && is_slow_tree(method)) {
      continue;
    }
    try {
      run_stages(scene.set, method, o.device, o.rounds ? o.rounds : 5, rows);
    } catch (const failure& e) {
      add_failure(name, method, e.what(), rows);
    }
  }
}

// ---------------------------------------------------------------- the command line

void check_names(const std::vector<std::string>& names, const std::vector<std::string>& known, const char* what)
{
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      throw failure(std::string("unknown ") + what + " " + name + "; --help lists them");
    }
  }
}

options parse(int argc, char* argv[])
{
  options o;
  for (int i = 2; i < argc; i += 2) {
    const std::string word = argv[i];
    if (word == "--append" || word == "--curves" || word == "--quick-curves") {
      o.append = o.append || word == "--append";
      if (word != "--append") {
        o.methods = tree_curve_methods(word == "--quick-curves");
      }
      --i;
      continue;
    }
    if (i + 1 == argc) {
      throw failure(word + " is unknown or lacks its value; see --help");
    }
    const std::string value = argv[i + 1];
    if (word == "--scene") {
      o.scenes = split(value);
    } else if (word == "--method") {
      o.methods = split(value);
    } else if (word == "--device") {
      o.device = value;
    } else if (word == "--rounds") {
      o.rounds = std::atoi(value.c_str());
      if (o.rounds < 1 || o.rounds > 1000) {
        throw failure("--rounds must be within 1..1000");
      }
    } else if (word == "--csv") {
      o.csv = value;
    } else if (word == "--chart") {
      o.chart = value;
    } else {
      throw failure("unknown option " + word + "; see --help");
    }
  }
  std::vector<std::string> scenes;
  for (int s = 0; s < stratus_voxel_scene_count(); ++s) {
    scenes.push_back(stratus_voxel_scene_name(s));
  }
  scenes.insert(scenes.end(), { "cloud", "archipelago-1024" });
  std::vector<std::string> named;
  std::copy_if(
    o.scenes.begin(), o.scenes.end(), std::back_inserter(named), [](const std::string& name) { return !is_cluster_scene(name); });
  check_names(named, scenes, "scene");
  for (const std::string& method : o.methods) {
    if (!is_tree_method(method)) {
      throw failure("unknown method " + method + "; --help lists them");
    }
  }
  if (!o.device.empty()) {
    o.methods = o.methods.empty() ? device_methods : o.methods;
    for (const std::string& method : o.methods) {
      tree_options_of(method);
    }
  }
  if (o.scenes.empty()) {
    std::copy_if(scenes.begin(), scenes.end(), std::back_inserter(o.scenes),
      [](const std::string& name) { return name.rfind("archipelago", 0) != 0 && name != "islets"; });
  }
  o.methods = o.methods.empty() ? all_tree_methods() : o.methods;
  return o;
}

} // namespace

int tree_main(int argc, char* argv[])
{
  if (argc > 2 && std::strcmp(argv[2], "--help") == 0) {
    std::fputs(help, stdout);
    return 0;
  }
  const options o = parse(argc, argv);
  if (!o.chart.empty()) {
    ensure_display(argv);
  }
  std::vector<row> rows;
  check_writable(o.csv);
  for (const std::string& name : o.scenes) {
    o.device.empty() ? run_scene(name, o, rows) : run_device(name, o, rows);
  }
  save_rows(o.csv, rows, "tree", o.append);
  if (!o.chart.empty()) {
    write_chart(o.chart, curves_of("tree", rows).back());
  }
  return any_failed(rows) ? 1 : 0;
}
} // namespace bench
