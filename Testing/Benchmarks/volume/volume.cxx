// SPDX-License-Identifier: BSD-3-Clause
// stratus-bench volume: compares pictures and times of Stratus and of existing volume renderers, in one process.
#include "bench.h"
#include "rate.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>

namespace {

const char* const help = R"(stratus-bench volume [options]

  --scene NAME|FILE,...     cloud, plume, fog, haze, peak, voxel, plume2 (two pollutants, a component each), bone, skin, stripes, shell,
                            plate, labels, cloud-N (resampled to N x N/2 x N), cumulus-rectilinear:K (stretched levels, which peers
                            draw resampled to an image of K times as many cells upwards; resample_ms is the time for it, and
                            no frame counts it; default 1), or an image file; each with +shade behind it: lit by a headlight;
                            default: all of these but haze, cloud-N and cumulus-rectilinear, cloud+shade, and
                            ../shared/data/isabel_02.vti, plain and lit, where it is
  --size N                  N x N pixels (default 512)
  --method M,...            stratus:none|block|distance|octant|hybrid|auto, with /2 or /4 (rays every 2 or 4 pixels) behind it, then
                            ~TOLERANCE, a number, or ~fixedpoint, which is the root mean square error that vtk:fixedpoint has in this
                            run, then @host or @device (the first OpenCL device); vtk:fixedpoint, with /2 or /4, vtk:gpu, openvdb,
                            nanovdb, each with :STEP in voxels behind it (default 1); floor; each but floor with a window behind
                            it: +gradient (background), +samples (8 a pixel), +axes, +outline, or +ordinary, which is all four
                            (default: all methods, stratus:auto and vtk:fixedpoint in ordinary windows, too)
  --curves, --quick-curves  methods over their settings: ours over tolerances, peers over steps
  --repeats N               most frames of each view (default 7): fewer if the middle half of their times is within 3 % of the
                            median, or they took .15 s
  --csv FILE                tidy rows: benchmark,scene,method,metric,value,unit (default: the standard output); before them rows `#
                            name,value`: processor, cores, compiler, commit (+: with changes), date, and the scenes that these made
  --append                  rows of other scenes that the file has stay
  --chart FILE.png          frame time against error
  --reference-cache FOLDER  keep the reference's pictures there (default: stratus/references where the system keeps caches; none)
  --no-error                times and differing pixels only
  --no-update               transfer functions do not change

Every frame is a whole Render() with WaitForCompletion(). A window is black, without multisampling, unless its method names another.
A method that cannot be measured has a row `failed`, and the exit status is 1. Needs a display; without one it starts itself under xvfb-run.
  frame_ms               median over the 8 views of record, each the median of its repeats; frame_ms/V: view V
  update_ms              from a change of the transfer function to the next picture, median over the views; over three or more of
                         them if these agree, over one if it took .15 s
  psnr_db, max_error     of float pixels, if the method has them
  psnr8_db               of the window read back in 8 bits
  samples                of a frame, median
Errors are measured at one pixel of each tile of 8 x 8, 4 x 4 or 2 x 2, if 16,384 of these pixels show something.

floor_ms is an estimate, not a bound: the samples with alpha > 0, one a voxel until a ray is opaque, at the rate of a tight loop that sets
up, skips and tests nothing. A method can take fewer samples than floor counts.

stratus-bench all --out FOLDER measures everything, stratus-bench compare A B compares two such runs.
stratus-bench distance --help describes distance fields, light --help light, octree --help culling, tetra --help tetrahedra, tree --help
first hits, and paraview --help the plugin in ParaView.
)";

struct options {
  std::vector<std::string> scenes, methods;
  std::string csv = "-", chart, cache = bench::default_reference_cache();
  bench::effort how;
  bool error = true, append = false;
};

options parse(int argc, char* argv[])
{
  options o;
  for (int i = 2; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--no-error" || word == "--append" || word == "--no-update") {
      o.error = o.error && word != "--no-error";
      o.append = o.append || word == "--append";
      o.how.updates = o.how.updates && word != "--no-update";
      continue;
    }
    if (word == "--curves" || word == "--quick-curves") {
      o.methods = bench::curve_methods(word == "--quick-curves");
      continue;
    }
    if (i + 1 == argc) {
      throw bench::failure(word + " is unknown or lacks its value; see --help");
    }
    const std::string value = argv[++i];
    if (word == "--scene") {
      const std::vector<std::string> more = bench::split(value);
      o.scenes.insert(o.scenes.end(), more.begin(), more.end());
    } else if (word == "--method") {
      const std::vector<std::string> more = bench::split(value);
      o.methods.insert(o.methods.end(), more.begin(), more.end());
    } else if (word == "--size") {
      o.how.size = std::atoi(value.c_str());
    } else if (word == "--repeats") {
      o.how.repeats = std::atoi(value.c_str());
    } else if (word == "--csv") {
      o.csv = value;
    } else if (word == "--chart") {
      o.chart = value;
    } else if (word == "--reference-cache") {
      o.cache = value == "none" ? "" : value;
    } else {
      throw bench::failure("unknown option " + word + "; see --help");
    }
  }
  if (o.how.size < 16 || o.how.size > 4096) {
    throw bench::failure("--size must be within 16..4096");
  }
  if (o.how.repeats < 1 || o.how.repeats > 1000) {
    throw bench::failure("--repeats must be within 1..1000");
  }
  if (o.scenes.empty()) {
    o.scenes = { "cloud", "plume", "fog", "voxel", "peak", "plume2", "bone", "skin", "stripes", "shell", "plate", "labels", "cloud+shade" };
    const char* isabel = "../shared/data/isabel_02.vti";
    if (std::ifstream(isabel)) {
      o.scenes.push_back(isabel);
      o.scenes.push_back(std::string(isabel) + "+shade");
    } else {
      std::fprintf(stderr, "%s is not here: isabel_02 is left out\n", isabel);
    }
  }
  if (o.methods.empty()) {
    o.methods = bench::all_methods();
  }
  for (const std::string& method : o.methods) {
    bench::check_method(method);
  }
  return o;
}

// Returns the error of vtk:fixedpoint over lit pixels, in the terms of the tolerance.
double fixed_point_error(stratus_context* context, const bench::scene& scene, const bench::effort& how, bench::judge& judge,
  const std::vector<bench::result>& results)
{
  const auto known = std::find_if(results.begin(), results.end(), [](const bench::result& r) { return r.method == "vtk:fixedpoint"; });
  std::vector<bench::result> fixed = { known != results.end() ? *known : bench::run_method(context, scene, "vtk:fixedpoint", how, 0.0) };
  judge.measure(fixed);
  return std::pow(10.0, -0.05 * fixed[0].psnr8_db);
}

void run_floor(stratus_context* context, const bench::scene& scene, const options& o, std::vector<bench::row>& rows)
{
  const bench::floor_result f = bench::run_floor(context, scene, o.how.size);
  std::fprintf(stderr, "  floor (estimate): %.0f samples with alpha > 0 at %.0f M/s (%s, all threads): %.2f ms\n", f.samples, 1e-6 * f.rate,
    bench_sample_loop(), f.ms);
  bench::add_rows(scene.name, f, rows);
}

// Says why a method is not measured on a scene; empty: it is.
std::string left_out(const bench::scene& scene, const std::string& method, const options& o)
{
  const bool plain = !scene.shaded && scene.volume.components == 1;
  return !plain && (method == "floor" || method.find("vdb") != std::string::npos) ? "it has no light and takes one component"
    : bench::needs_fixed_point(method) && !o.error                                ? "it needs errors, which --no-error does without"
    : scene.name == "voxel" && method.find("/4") != std::string::npos ? "its only voxel is smaller than the distance of the rays"
                                                                      : "";
}

void run_scene(
  stratus_context* context, const std::string& source, const options& o, bench::progress& progress, std::vector<bench::row>& rows)
{
  const bench::scene scene = bench::make_scene(context, source);
  if (scene.grid) {
    rows.push_back({ scene.name, "vtkResampleToImage", "resample_ms", "ms", scene.resample_ms });
  }
  std::vector<bench::result> results;
  bench::judge judge(context, scene, o.how, o.cache, progress);
  double fixed_point = 0.0;
  for (const std::string& method : o.methods) {
    progress.at(scene.name, method);
    const std::string why = left_out(scene, method, o);
    if (!why.empty()) {
      std::fprintf(stderr, "  %s is left out of %s: %s\n", method.c_str(), scene.name.c_str(), why.c_str());
      continue;
    }
    try {
      if (method == "floor") {
        run_floor(context, scene, o, rows);
        continue;
      }
      if (bench::needs_fixed_point(method) && fixed_point == 0.0) {
        fixed_point = fixed_point_error(context, scene, o.how, judge, results);
      }
      results.push_back(bench::run_method(context, scene, method, o.how, fixed_point));
    } catch (const bench::failure& e) {
      bench::add_failure(scene.name, method, e.what(), rows);
    }
  }
  if (o.error) {
    progress.at(scene.name, "the reference");
    judge.measure(results);
    judge.compare(results);
  }
  for (const bench::result& r : results) {
    bench::add_rows(r, rows);
  }
  progress.end_scene(scene.name);
}

// Returns whether all methods were measured.
bool run(const options& o)
{
  stratus_context_options host = stratus_context_options_default();
  stratus_context* context = nullptr;
  char message[512];
  host.device = "host";
  if (stratus_context_create(&host, &context, message, sizeof message) != STRATUS_OK) {
    throw bench::failure(message);
  }
  std::vector<bench::row> rows;
  bench::make_folder(o.cache);
  bench::check_writable(o.csv);
  bench::progress progress(o.scenes.size(), o.methods.size() + o.error);
  for (const std::string& scene : o.scenes) {
    run_scene(context, scene, o, progress, rows);
  }
  bench::print_table(rows);
  bench::save_rows(o.csv, rows, "volume", o.append);
  if (!o.chart.empty()) {
    bench::write_chart(o.chart, bench::curves_of("volume", rows).front());
  }
  stratus_context_destroy(context);
  return !bench::any_failed(rows);
}
} // namespace

int bench::volume_main(int argc, char* argv[])
{
  const bool asked = argc > 2 && std::strcmp(argv[2], "--help") == 0;
  if (argc < 2 || std::strcmp(argv[1], "volume") != 0 || asked) {
    const bool wanted = asked || (argc > 1 && std::strcmp(argv[1], "--help") == 0);
    std::fputs(help, wanted ? stdout : stderr);
    return wanted ? 0 : 2;
  }
  const options o = parse(argc, argv);
  ensure_display(argv);
  return run(o) ? 0 : 1;
}
