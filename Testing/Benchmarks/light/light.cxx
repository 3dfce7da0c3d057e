// SPDX-License-Identifier: BSD-3-Clause
// stratus-bench light: times and errors of every kind of light, next to the unlit frame of the same volume or mesh.
#include "light_bench.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

const char* const help = R"(stratus-bench light [options]

  --scene NAME,...          scenes of stratus-bench volume, and MESH/FUNCTION of stratus-bench tetra
                            (default: cloud,cumulus-rectilinear,bone,plume, and bluntfin/ramp where it is)
  --light NAME,...          local (a headlight, by the field's gradient), shadows (a sun, by the gradient), single (a sun, scattered once
                            and evenly), multiple (a sun, scattered any number of times and evenly), path (multiple, by the path tracer);
                            default: all
  --tolerance T,...         default .0126,.005,.001
  --size N                  frames that are timed have N x N pixels (default 512)
  --error-size N            images that are compared have N x N pixels (default 128)
  --seconds S               longest time for the repeats of one light at one tolerance, and for one reference (default 30)
  --no-peers                without vtk:fixedpoint, and Stratus in a window
  --no-error                times only
  --csv FILE                rows as of stratus-bench volume (default: the standard output)
  --append                  rows of other scenes that the file has stay
  --chart FILE.png          frame time against error
  --redraw                  draw the chart of the file of --csv, and measure nothing
  --export FOLDER           write volumes, and the path tracer's images of `single`, for Testing/Benchmarks/light/vtk_gpu.py
  --reference-cache FOLDER  keep references there (default as in stratus-bench volume; none)

Frames of a method stratus:LIGHT~TOLERANCE are drawn by the core, without a window. A round draws all 8 views, unlit and lit by turns, by
two casters of the same tolerance. Rounds end if the medians of frame_ms and ratio are known within 3 % with a confidence of 95 %.
  frame_ms, unlit_ms        median of the rounds' mean frames
  ratio, processor_ratio    lit over unlit, in time and in processor time: medians of the rounds
  ratio_low, ratio_high     between these the true median is, with a confidence of 95 %
  maps_ms, maps_bytes       of the maps of light; maps_frames: maps_ms over unlit_ms; maps_processor_frames: in processor time
  error                     root mean square over the pixels that show something, against a reference; error_low, error_high: bounds by the
                            reference's own error. local: as stratus-bench volume, 8 views. shadows, single: a double reference with a ray
                            from each sample to the light, at one pixel of each tile of 4 x 4 of views 0 and 4
                            multiple: as path_error, without a limit of scatterings
  path_error                single: against the path tracer with one scattering, views 0 and 4. Its noise is subtracted; path_error_low and
                            path_error_high are bounds by the noise that is left
  finest_error              meshes: against tolerance 0; multiple: against a tenth of the least tolerance
  expected_error, maps_error  as reports expect them
stratus:path~N, N paths a pixel of view 0: frame_ms, and error: the standard error.
vtk:fixedpoint and stratus:window~TOLERANCE draw local light in a window, and are timed as in stratus-bench volume.
)";

struct options {
  std::vector<std::string> scenes, lights;
  std::vector<double> tolerances = { 0.0126, 0.005, 0.001 };
  std::string csv = "-", chart, folder, cache = bench::default_reference_cache();
  bench::light_effort how;
  bool error = true, peers = true, append = false, redraw = false;
};

double number_of(const std::string& word, const std::string& value, double least, double most)
{
  char* end = nullptr;
  const double number = std::strtod(value.c_str(), &end);
  if (value.empty() || *end != '\0' || !(number >= least && number <= most)) {
    char range[64];
    std::snprintf(range, sizeof range, "%g..%g", least, most);
    throw bench::failure(word + " must be within " + range + ", and is " + value);
  }
  return number;
}

const bench::lighting& lighting_of(const std::string& name)
{
  for (const bench::lighting& l : bench::all_lighting()) {
    if (name == l.name) {
      return l;
    }
  }
  throw bench::failure("unknown light '" + name + "'; see --help");
}

void set_option(options& o, const std::string& word, const std::string& value)
{
  if (word == "--scene") {
    o.scenes = bench::split(value);
  } else if (word == "--light") {
    o.lights = bench::split(value);
  } else if (word == "--tolerance") {
    o.tolerances.clear();
    for (const std::string& tolerance : bench::split(value)) {
      o.tolerances.push_back(number_of(word, tolerance, 1e-6, 1.0));
    }
  } else if (word == "--size") {
    o.how.size = static_cast<int>(number_of(word, value, 16, 4096));
  } else if (word == "--error-size") {
    o.how.error_size = static_cast<int>(number_of(word, value, 16, 4096));
  } else if (word == "--seconds") {
    o.how.seconds = number_of(word, value, 0.1, 1e6);
  } else if (word == "--csv") {
    o.csv = value;
  } else if (word == "--chart") {
    o.chart = value;
  } else if (word == "--export") {
    o.folder = value;
  } else if (word == "--reference-cache") {
    o.cache = value == "none" ? "" : value;
  } else {
    throw bench::failure("unknown option " + word + "; see --help");
  }
}

options parse(int argc, char* argv[])
{
  options o;
  for (int i = 2; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--no-error" || word == "--no-peers" || word == "--append" || word == "--redraw") {
      o.error = o.error && word != "--no-error";
      o.peers = o.peers && word != "--no-peers";
      o.append = o.append || word == "--append";
      o.redraw = o.redraw || word == "--redraw";
    } else if (i + 1 == argc) {
      throw bench::failure(word + " is unknown or lacks its value; see --help");
    } else {
      set_option(o, word, argv[++i]);
    }
  }
  if (o.scenes.empty()) {
    o.scenes = { "cloud", "cumulus-rectilinear", "bone", "plume", "bluntfin/ramp" };
  }
  if (o.lights.empty()) {
    for (const bench::lighting& l : bench::all_lighting()) {
      o.lights.emplace_back(l.name);
    }
  }
  for (const std::string& light : o.lights) {
    lighting_of(light);
  }
  return o;
}

// ---- scenes

// A subject and the scene or mesh that it points to.
struct loaded {
  bench::scene volume, lit; // lit: the same with stratus-bench volume's local light
  bench::tetra_mesh mesh;
  bench::light_subject subject;
};

// Returns false, with the reason on the standard error, if a mesh is not available here.
bool load(stratus_context* context, const std::string& name, loaded& of)
{
  bench::light_subject& s = of.subject;
  const size_t slash = name.find('/');
  const std::string function = slash == std::string::npos ? "" : name.substr(slash + 1);
  const std::vector<std::string>& functions = bench::tetra_functions();
  s.name = name;
  if (std::find(functions.begin(), functions.end(), function) != functions.end()) {
    if (!bench::make_tetra_mesh(context, name.substr(0, slash), "", of.mesh)) {
      return false;
    }
    s.mesh = &of.mesh;
    s.function = bench::tetra_transfer(of.mesh, function);
    std::copy_n(of.mesh.bounds, 6, s.bounds);
  } else {
    of.volume = bench::make_scene(context, name);
    of.lit = bench::make_scene(context, name + "+shade");
    s.name = of.volume.name;
    s.volume = &of.volume;
    s.up_axis = of.volume.up_axis;
    std::copy_n(of.volume.bounds, 6, s.bounds);
  }
  for (int view = 0; view < bench::views; ++view) {
    stratus_camera camera;
    if (stratus_scene_camera(context, s.bounds, s.up_axis, view, 0, 1.0, &camera) != STRATUS_OK) {
      throw bench::failure(stratus_context_message(context));
    }
    s.cameras.push_back(camera);
  }
  return true;
}

// ---- rows

using rows = std::vector<bench::row>;

std::string method_of(const char* name, double setting)
{
  char text[64];
  std::snprintf(text, sizeof text, "stratus:%s~%g", name, setting);
  return text;
}

void add_times(const std::string& scene, const std::string& method, const bench::light_times& t, rows& all)
{
  const auto add = [&](const char* metric, double value, const char* unit) { all.push_back({ scene, method, metric, unit, value }); };
  add("frame_ms", t.frame.median, "ms");
  add("unlit_ms", t.unlit.median, "ms");
  add("ratio", t.ratio.median, "1");
  add("ratio_low", t.ratio.low, "1");
  add("ratio_high", t.ratio.high, "1");
  add("processor_ratio", t.processor_ratio, "1");
  add("rounds", t.rounds, "1");
  add("samples", t.report.samples, "1");
  if (t.maps.median >= 0.0) {
    add("maps_ms", t.maps.median, "ms");
    add("maps_frames", t.maps.median / t.unlit.median, "1");
    add("maps_processor_frames", t.maps_processor_ratio, "1");
  }
  if (t.report.maps_bytes >= 0.0) {
    add("maps_bytes", t.report.maps_bytes, "B");
    add("maps_error", t.report.maps_error, "1");
  }
  if (t.report.expected_error >= 0.0) {
    add("expected_error", t.report.expected_error, "1");
  }
  std::fprintf(stderr, "  %s, %s: %.2f ms, unlit %.2f ms, ratio %.2f (%.2f to %.2f, in processor time %.2f), %d rounds", scene.c_str(),
    method.c_str(), t.frame.median, t.unlit.median, t.ratio.median, t.ratio.low, t.ratio.high, t.processor_ratio, t.rounds);
  if (t.maps.median >= 0.0) {
    std::fprintf(stderr, "; maps %.1f ms, %.1f unlit frames (in processor time %.1f)", t.maps.median, t.maps.median / t.unlit.median,
      t.maps_processor_ratio);
  }
  std::fprintf(stderr, "\n");
}

void add_error(const std::string& scene, const std::string& method, const std::string& prefix, const bench::light_judgement& j,
  const bench::light_error& e, rows& all)
{
  const auto add = [&](const char* metric, double value) { all.push_back({ scene, method, prefix + metric, "1", value }); };
  add("error", e.error);
  add("error_low", e.low);
  add("error_high", e.high);
  add("reference_error", j.reference_error);
  if (j.samples > 0.0) {
    add("reference_samples", j.samples);
  }
  std::fprintf(stderr, "  %s, %s: %serror %.3g (%.3g to %.3g), reference %.2g\n", scene.c_str(), method.c_str(), prefix.c_str(), e.error,
    e.low, e.high, j.reference_error);
}

double error_of(double psnr_db)
{
  return std::pow(10.0, -0.05 * psnr_db);
}

// ---- local light: judged as stratus-bench volume judges it

bench::result draw_local(stratus_context* context, const loaded& of, const bench::lighting& l, double tolerance, const options& o)
{
  bench::result r;
  r.scene = of.subject.name;
  r.method = method_of(l.name, tolerance);
  const std::unique_ptr<bench::light_caster> caster = bench::make_caster(context, of.subject, &l, tolerance);
  for (const stratus_camera& camera : of.subject.cameras) {
    bench::picture p;
    p.rgba.resize(4 * static_cast<size_t>(o.how.error_size) * static_cast<size_t>(o.how.error_size));
    caster->draw(camera, o.how.error_size, p.rgba.data());
    for (const float value : p.rgba) {
      p.bytes.push_back(static_cast<uint8_t>(std::lround(255.0 * std::min(std::max(static_cast<double>(value), 0.0), 1.0))));
    }
    r.pictures.push_back(p);
  }
  return r;
}

// Adds the times of a window's frames, and its images for the judge.
void run_window(stratus_context* context, const loaded& of, const std::string& method, const std::string& name, const options& o,
  std::vector<bench::result>& judged, rows& all)
{
  bench::effort how;
  how.updates = false;
  how.repeats = 5;
  how.size = o.how.size;
  const bench::result unlit = bench::run_method(context, of.volume, method, how, 0.0);
  const bench::result lit = bench::run_method(context, of.lit, method, how, 0.0);
  all.push_back({ of.subject.name, name, "frame_ms", "ms", lit.time.frame_ms });
  all.push_back({ of.subject.name, name, "unlit_ms", "ms", unlit.time.frame_ms });
  all.push_back({ of.subject.name, name, "ratio", "1", lit.time.frame_ms / unlit.time.frame_ms });
  std::fprintf(stderr, "  %s, %s: %.2f ms in a window, unlit %.2f ms\n", of.subject.name.c_str(), name.c_str(), lit.time.frame_ms,
    unlit.time.frame_ms);
  if (o.error) {
    how.size = o.how.error_size;
    how.repeats = 1;
    judged.push_back(bench::run_method(context, of.lit, method, how, 0.0));
    judged.back().scene = of.subject.name;
    judged.back().method = name;
  }
}

void judge_local(stratus_context* context, const loaded& of, std::vector<bench::result>& judged, const options& o,
  const bench::progress& progress, rows& all)
{
  bench::effort how;
  how.size = o.how.error_size;
  bench::judge judge(context, of.lit, how, o.cache, progress);
  judge.measure(judged);
  for (const bench::result& r : judged) {
    const bool floats = !r.pictures.front().rgba.empty();
    const double error = error_of(floats ? r.psnr_db : r.psnr8_db), doubt = error_of(r.reference_db);
    bench::light_judgement j;
    j.reference_error = doubt;
    add_error(r.scene, r.method, "", j, { std::max(error - doubt, 0.0), error, error + doubt }, all);
  }
}

// ---- one kind of light

void run_paths(stratus_context* context, const loaded& of, const bench::lighting& l, const options& o, rows& all)
{
  for (const bench::light_path& p : bench::run_paths(context, of.subject, l, o.how)) {
    const std::string method = method_of(l.name, p.samples);
    const auto add = [&](const char* metric, double value, const char* unit) {
      all.push_back({ of.subject.name, method, metric, unit, value });
    };
    add("frame_ms", 1e3 * p.seconds, "ms");
    add("error", p.standard_error, "1");
    add("vertices", p.vertices, "1");
    std::fprintf(stderr, "  %s, %s: %.2f s, standard error %.3g\n", of.subject.name.c_str(), method.c_str(), p.seconds, p.standard_error);
  }
}

void judge_mesh(stratus_context* context, const loaded& of, const bench::lighting& l, const std::vector<bench::light_images>& images,
  const options& o, rows& all)
{
  // To solve for many scatterings as exactly as can be takes minutes.
  const double tolerance = l.bounces == 0 ? 0.1 * *std::min_element(o.tolerances.begin(), o.tolerances.end()) : 0.0;
  const bench::light_images finest = bench::draw_light(context, of.subject, &l, tolerance, o.how.error_size);
  for (size_t t = 0; t < images.size(); ++t) {
    double squares = 0.0, count = 0.0;
    for (size_t v = 0; v < finest.size(); ++v) {
      for (size_t i = 0; i < finest[v].size(); i += 4) {
        for (size_t c = i; c < i + 4 && (finest[v][i + 3] > 0.0f || images[t][v][i + 3] > 0.0f); ++c, ++count) {
          const double d = static_cast<double>(images[t][v][c]) - static_cast<double>(finest[v][c]);
          squares += d * d;
        }
      }
    }
    const double error = count > 0.0 ? std::sqrt(squares / count) : 0.0;
    all.push_back({ of.subject.name, method_of(l.name, o.tolerances[t]), "finest_error", "1", error });
  }
}

void run_light(stratus_context* context, const loaded& of, const bench::lighting& l, const options& o, std::vector<bench::result>& judged,
  std::vector<std::string>& exported, rows& all)
{
  std::vector<bench::light_images> images;
  const bool local = l.bounces < 0 && !l.shadows;
  for (const double tolerance : o.tolerances) {
    const std::string method = method_of(l.name, tolerance);
    add_times(of.subject.name, method, bench::time_light(context, of.subject, l, tolerance, o.how), all);
    if (o.error && local && of.subject.volume) {
      judged.push_back(draw_local(context, of, l, tolerance, o));
    } else if (o.error) {
      images.push_back(bench::draw_light(context, of.subject, &l, tolerance, o.how.error_size));
    }
  }
  if (images.empty()) {
    return;
  }
  if (of.subject.mesh) {
    judge_mesh(context, of, l, images, o, all);
    return;
  }
  const auto add = [&](const bench::light_judgement& j, const char* prefix) {
    for (size_t t = 0; t < images.size(); ++t) {
      add_error(of.subject.name, method_of(l.name, o.tolerances[t]), prefix, j, j.errors[t], all);
    }
  };
  if (l.bounces != 0) {
    add(bench::judge_in_double(of.subject, l, images, o.how, o.cache), "");
  }
  if (l.bounces >= 0) {
    const bench::light_judgement paths = bench::judge_by_paths(context, of.subject, l, images, o.how, o.cache);
    add(paths, l.bounces ? "path_" : "");
    if (!o.folder.empty() && l.bounces == 1) {
      exported.push_back(bench::export_scene(of.subject, paths.paths, o.folder));
    }
  }
}

void run_scene(stratus_context* context, const std::string& name, const options& o, bench::progress& progress,
  std::vector<std::string>& exported, rows& all)
{
  loaded of;
  if (!load(context, name, of)) {
    progress.end_scene(name);
    return;
  }
  std::vector<bench::result> judged;
  for (const std::string& light : o.lights) {
    const bench::lighting& l = lighting_of(light);
    progress.at(of.subject.name, light);
    if (std::strcmp(l.name, "path") != 0) {
      run_light(context, of, l, o, judged, exported, all);
    } else if (of.subject.volume) { // the path tracer draws volumes
      run_paths(context, of, l, o, all);
    }
    if (std::strcmp(l.name, "local") == 0 && of.subject.volume && o.peers) {
      run_window(context, of, "vtk:fixedpoint", "vtk:fixedpoint", o, judged, all);
      for (const double tolerance : o.tolerances) {
        char setting[32];
        std::snprintf(setting, sizeof setting, "~%g", tolerance);
        run_window(context, of, std::string("stratus:auto") + setting, std::string("stratus:window") + setting, o, judged, all);
      }
    }
  }
  if (!judged.empty()) {
    judge_local(context, of, judged, o, progress, all);
  }
  progress.end_scene(of.subject.name);
}

bool run(const options& o)
{
  stratus_context_options host = stratus_context_options_default();
  stratus_context* context = nullptr;
  char message[512];
  host.device = "host";
  if (stratus_context_create(&host, &context, message, sizeof message) != STRATUS_OK) {
    throw bench::failure(message);
  }
  rows all;
  std::vector<std::string> exported;
  bench::make_folder(o.cache);
  bench::make_folder(o.folder);
  bench::check_writable(o.csv);
  bench::progress progress(o.scenes.size(), o.lights.size());
  for (const std::string& scene : o.scenes) {
    run_scene(context, scene, o, progress, exported, all);
    if (o.csv != "-") { // what is measured outlives a run that is interrupted
      bench::save_rows(o.csv, all, "light", o.append);
    }
  }
  if (o.csv == "-") {
    bench::save_rows(o.csv, all, "light", false);
  }
  if (!o.folder.empty()) {
    bench::export_list(exported, o.folder);
  }
  if (!o.chart.empty()) {
    bench::write_chart(o.chart, bench::curves_of("light", all).front());
  }
  stratus_context_destroy(context);
  return !all.empty();
}
} // namespace

int bench::light_main(int argc, char* argv[])
{
  if (argc > 2 && std::strcmp(argv[2], "--help") == 0) {
    std::fputs(help, stdout);
    return 0;
  }
  const options o = parse(argc, argv);
  if (o.peers || !o.chart.empty()) {
    ensure_display(argv);
  }
  if (o.redraw) {
    const std::vector<row> known = read_csv(o.csv).rows;
    if (known.empty() || o.chart.empty()) {
      throw failure("--redraw needs --chart, and rows in the file of --csv");
    }
    write_chart(o.chart, curves_of("light", known).front());
    return 0;
  }
  return run(o) ? 0 : 1;
}
