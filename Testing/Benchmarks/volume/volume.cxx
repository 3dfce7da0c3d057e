// SPDX-License-Identifier: BSD-3-Clause
// stratus-bench volume: compares Stratus' pictures and times with those of existing volume renderers, in one process.
#include "bench.h"
#include "rate.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <unistd.h>

namespace {

const char* const help = R"(stratus-bench volume [options]

  --scene NAME|FILE,...     cloud, plume, fog, haze, peak, voxel, plume2 (two pollutants, a component each), bone, skin, stripes, shell,
                            plate, labels, cloud-N (resampled to N x N/2 x N), or an image file; each with +shade behind it: lit by a
                            headlight; default: all of these but haze and cloud-N, cloud+shade, and ../shared/data/isabel_02.vti, plain and
                            lit, where it is
  --size N                  N x N pixels (default 512)
  --method M,...            stratus:none|block|distance|octant|hybrid|auto, with ~TOLERANCE behind it, a number, or ~fixedpoint, which is
                            the root mean square error that vtk:fixedpoint has in this run, and with @host or @device (the first OpenCL
                            device) behind that; vtk:fixedpoint, vtk:fixedpoint:0.5, vtk:gpu, openvdb, floor; each but floor with a window
                            behind it: +gradient (background), +samples (8 a pixel), +axes, +outline, or +ordinary, which is all four
                            (default: all methods, stratus:auto and vtk:fixedpoint in ordinary windows, too)
  --csv FILE                tidy rows: benchmark,scene,method,metric,value,unit (default: the standard output); before them rows `#
                            name,value`: processor, cores, compiler, commit (+: with changes), date, and the scenes that these made
  --chart FILE.png          frame time against error
  --reference-cache FOLDER  keep the reference's pictures, which take most of the time
  --no-error                times and differing pixels only

Every frame is a whole Render() with WaitForCompletion(). frame_ms is the median over the 8 views of record, each the median of 3.
A window is black, without multisampling, unless
told otherwise. update_ms: from a change of the transfer function to the next picture, median over the views.
psnr_db is of float pixels, psnr8_db of the
window read back in 8 bits, max_error of floats where a method has them. samples: a frame's, median. Needs a display; without one it starts
itself under xvfb-run.

floor_ms is an estimate, not a bound: the samples with alpha > 0, one a voxel until a ray is opaque, at the rate of a tight loop that sets
up, skips and tests nothing. A method can take fewer samples than floor counts.

stratus-bench distance --help tells of distance fields, stratus-bench octree --help of culling,
stratus-bench tetra --help of tetrahedra.
)";

struct options {
  std::vector<std::string> scenes, methods;
  std::string csv = "-", chart, cache;
  int size = 512;
  bool error = true;
};

std::vector<std::string> list(const std::string& text)
{
  std::vector<std::string> parts;
  std::istringstream stream(text);
  std::string part;
  while (std::getline(stream, part, ',')) {
    parts.push_back(part);
  }
  return parts;
}

options parse(int argc, char* argv[])
{
  options o;
  for (int i = 2; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--no-error") {
      o.error = false;
      continue;
    }
    if (i + 1 == argc) {
      throw bench::failure(word + " is unknown or lacks its value; --help tells more");
    }
    const std::string value = argv[++i];
    if (word == "--scene") {
      const std::vector<std::string> more = list(value);
      o.scenes.insert(o.scenes.end(), more.begin(), more.end());
    } else if (word == "--method") {
      const std::vector<std::string> more = list(value);
      o.methods.insert(o.methods.end(), more.begin(), more.end());
    } else if (word == "--size") {
      o.size = std::atoi(value.c_str());
    } else if (word == "--csv") {
      o.csv = value;
    } else if (word == "--chart") {
      o.chart = value;
    } else if (word == "--reference-cache") {
      o.cache = value;
    } else {
      throw bench::failure("unknown option " + word + "; --help tells more");
    }
  }
  if (o.size < 16 || o.size > 4096) {
    throw bench::failure("--size must be within 16..4096");
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
double fixed_point_error(
  stratus_context* context, const bench::scene& scene, int size, bench::judge& judge, std::vector<bench::result>& results)
{
  const auto known = std::find_if(results.begin(), results.end(), [](const bench::result& r) { return r.method == "vtk:fixedpoint"; });
  std::vector<bench::result> fixed = { known != results.end() ? *known : bench::run_method(context, scene, "vtk:fixedpoint", size, 0.0) };
  judge.measure(fixed);
  return std::pow(10.0, -0.05 * fixed[0].psnr8_db);
}

// Shows on a terminal what is being measured.
void working_on(const std::string& scene, const std::string& method)
{
  if (isatty(STDERR_FILENO)) {
    std::fprintf(stderr, "\r\033[K%s%s%s", method.empty() ? "" : "  ", scene.c_str(), method.empty() ? "" : (", " + method).c_str());
  }
}

void run_scene(stratus_context* context, const std::string& source, const options& o, std::vector<bench::row>& rows)
{
  const bench::scene scene = bench::make_scene(context, source);
  std::vector<bench::result> results;
  bench::judge judge(context, scene, o.size, o.cache);
  double fixed_point = 0.0;
  const bool plain = !scene.shaded && scene.volume.components == 1;
  for (const std::string& method : o.methods) {
    if (!plain && (method == "floor" || method == "openvdb")) {
      std::fprintf(stderr, "  %s has no light and takes one component: left out\n", method.c_str());
      continue;
    }
    working_on(scene.name, method);
    if (method == "floor") {
      const bench::floor_result f = bench::run_floor(context, scene, o.size);
      working_on("", "");
      std::fprintf(stderr, "  floor (estimate): %.0f samples with alpha > 0 at %.0f M/s (%s, all threads): %.2f ms\n", f.samples,
        1e-6 * f.rate, bench_sample_loop(), f.ms);
      bench::add_rows(scene.name, f, rows);
      continue;
    }
    if (bench::needs_fixed_point(method) && fixed_point == 0.0) {
      if (!o.error) {
        working_on("", "");
        std::fprintf(stderr, "  %s needs errors, which --no-error does without: left out\n", method.c_str());
        continue;
      }
      fixed_point = fixed_point_error(context, scene, o.size, judge, results);
    }
    results.push_back(bench::run_method(context, scene, method, o.size, fixed_point));
    working_on("", "");
    const bench::timing& t = results.back().time;
    std::fprintf(stderr, "  %-22s first %.1f ms, frame %.2f ms, update %.2f ms  %s\n", method.c_str(), t.first_ms, t.frame_ms, t.update_ms,
      t.device.c_str());
  }
  if (o.error) {
    if (!isatty(STDERR_FILENO)) {
      std::fprintf(stderr, "  drawing the reference\n");
    }
    judge.measure(results);
    judge.compare(results);
  }
  for (const bench::result& r : results) {
    bench::add_rows(r, rows);
  }
}

void run(const options& o)
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
  for (size_t i = 0; i < o.scenes.size(); ++i) {
    std::fprintf(stderr, "%s (scene %zu of %zu)\n", o.scenes[i].c_str(), i + 1, o.scenes.size());
    run_scene(context, o.scenes[i], o, rows);
  }
  bench::print_table(rows);
  bench::write_csv(o.csv, rows);
  if (!o.chart.empty()) {
    bench::write_chart(o.chart, rows);
  }
  stratus_context_destroy(context);
}
} // namespace

int bench::volume_main(int argc, char* argv[])
{
  const bool asked = argc > 2 && std::strcmp(argv[2], "--help") == 0;
  if (argc < 2 || std::strcmp(argv[1], "volume") != 0 || asked) {
    const bool told = asked || (argc > 1 && std::strcmp(argv[1], "--help") == 0);
    std::fputs(help, told ? stdout : stderr);
    return told ? 0 : 2;
  }
  const options o = parse(argc, argv);
  ensure_display(argv);
  run(o);
  return 0;
}
