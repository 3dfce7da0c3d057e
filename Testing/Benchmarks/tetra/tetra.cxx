// SPDX-License-Identifier: BSD-3-Clause
// stratus-bench tetra: compares pictures and visibility orders of tetrahedra with existing methods, in one process.
#include "tetra_bench.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <system_error>

namespace bench {

namespace {

const char* const help = R"(stratus-bench tetra [options]

  --mesh NAME|FILE,...      bluntfin, post (of ../shared/data), holes (a plate with 24 holes, filled by TetGen), wavelet (a lattice),
                            estuary (water in layers), or a file of tetrahedra with point scalars; default: the first four
  --function F,...          ramp, peaks, opaque (default: all): scenes are MESH/FUNCTION
  --method M,...            stratus:auto|march|project, stratus:march|project@device (the first OpenCL device), vtk:projected,
                            vtk:projected+stratus-sort (8 leaves) and -sort-1 (one), vtk:raycast (Bunyk), vtk:zsweep; ours with
                            ~TOLERANCE behind it, the last two with :PIXELS from ray to ray (default 1); vtk:resample (vtkResampleToImage to
                            128^3 points, drawn by FixedPoint) and vtk:resample+stratus (by vtkStratusVolumeMapper), with :POINTS
                            along each axis;
                            sorters: stratus:sort (8 leaves), stratus:sort-1|2|4, stratus:sort-fifo (in layers), -fifo-2|4|8 (leaves by the
                            paper's rule), vtk:depthsort (default: all but @device, resample and
                            vtk:zsweep, which takes tens of seconds a frame)
  --curves, --quick-curves  mappers over their settings, but vtk:zsweep
  --size N                  N x N pixels (default 512)
  --repeats N               most frames a view and method (default 7): fewer if the middle half of their times is within 3 % of the
                            median, or they took .15 s; rounds of sorters (at most 3)
  --rays N                  N x N rays a view ask orders for wrong pairs, 24 views; 0: none (default 160)
  --csv FILE                tidy rows: benchmark,scene,method,metric,value,unit (default: the standard output)
                            the comments before them say where they come from, as in stratus-bench volume
  --append                  rows of other scenes that the file has stay, so that meshes can be run one by one
  --chart FILE.png          frame time against error, of all rows
  --cache FOLDER            keep the mesh that TetGen makes
  --reference-cache FOLDER  keep the reference's pictures
  --pictures FOLDER         each method's window in the first view, and the reference, as PNG
  --no-error                times and orders only

Methods take turns; before each frame the camera moves, so that no order is the last one's.
  frame_ms              whole Render() with WaitForCompletion(), median over the 8 views of record, each the median of its repeats
  rmse255               of float pixels: root mean square of RGBA in 0..255 over the pixels that either picture lights, against a march in
                        double precision through the cells
  rmse255_8bit          of the window read back in 8 bits
  reference_rmse255     change of the reference with steps of four times the length
  sort_ms               median over the 8 views, signs and cut cells included
  build_ms              neighbours (VTK: centres)
  wrong_visible_pairs   of visible_pairs of cells that follow one another on rays, over 24 views: 6 directions (3 along axes) x parallel,
                        perspective, near, inside
  cycles                sum over those views
  bytes, peak_bytes     the core's own after the first picture or order, and at most until then; of images their values
  resample_ms           vtkResampleToImage, which no frame counts; points outside the mesh are transparent, and errors there and of the
                        resampling count
VTK's mappers of tetrahedra use opacity as attenuation: they get functions with the same meaning.
)";

struct options {
  std::vector<std::string> meshes, functions, methods;
  std::string csv = "-", chart, cache, reference_cache = default_reference_cache(), pictures;
  int size = 512, repeats = 7, rays = 160;
  bool error = true, append = false;
};

bool has(const std::vector<std::string>& names, const std::string& name)
{
  return std::find(names.begin(), names.end(), name) != names.end();
}

void check(options& o)
{
  std::vector<std::string> known = tetra_mappers();
  known.insert(known.end(), tetra_sorters().begin(), tetra_sorters().end());
  o.meshes = o.meshes.empty() ? std::vector<std::string>{ "bluntfin", "post", "holes", "wavelet" } : o.meshes;
  o.functions = o.functions.empty() ? tetra_functions() : o.functions;
  if (o.methods.empty()) { // methods on devices, on images, and z-sweep, whose frames take tens of seconds, run only on request
    std::copy_if(known.begin(), known.end(), std::back_inserter(o.methods), [](const std::string& m) {
      return m.find('@') == std::string::npos && m != "vtk:zsweep" && m.find("resample") == std::string::npos;
    });
  }
  for (const std::string& method : o.methods) {
    if (!has(known, method) && !is_tetra_mapper(method)) {
      throw failure("unknown method " + method + "; see --help");
    }
  }
  for (const std::string& function : o.functions) {
    if (!has(tetra_functions(), function)) {
      throw failure("unknown function " + function + "; see --help");
    }
  }
  if (o.size < 16 || o.size > 4096) {
    throw failure("--size must be within 16..4096");
  }
  if (o.repeats < 1 || o.repeats > 1000 || o.rays < 0 || o.rays > 4096) {
    throw failure("--repeats must be within 1..1000, --rays within 0..4096");
  }
}

options parse(int argc, char* argv[])
{
  options o;
  for (int i = 2; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--no-error" || word == "--append") {
      (word == "--append" ? o.append : o.error) = word == "--append";
      continue;
    }
    if (word == "--curves" || word == "--quick-curves") {
      const std::vector<std::string> more = tetra_curve_methods(word == "--quick-curves");
      o.methods.insert(o.methods.end(), more.begin(), more.end());
      continue;
    }
    if (i + 1 == argc) {
      throw failure(word + " is unknown or lacks its value; see --help");
    }
    const std::string value = argv[++i];
    std::map<std::string, std::vector<std::string>*> lists = { { "--mesh", &o.meshes }, { "--function", &o.functions },
      { "--method", &o.methods } };
    std::map<std::string, int*> numbers = { { "--size", &o.size }, { "--repeats", &o.repeats }, { "--rays", &o.rays } };
    std::map<std::string, std::string*> files = { { "--csv", &o.csv }, { "--chart", &o.chart }, { "--cache", &o.cache },
      { "--reference-cache", &o.reference_cache }, { "--pictures", &o.pictures } };
    if (lists.count(word) > 0) {
      const std::vector<std::string> more = split(value);
      lists[word]->insert(lists[word]->end(), more.begin(), more.end());
    } else if (numbers.count(word) > 0) {
      *numbers[word] = std::atoi(value.c_str());
    } else if (files.count(word) > 0) {
      *files[word] = value;
    } else {
      throw failure("unknown option " + word + "; see --help");
    }
  }
  check(o);
  return o;
}

// ---- one mesh

using picture_table = std::vector<std::vector<std::vector<float>>>; // view, function, pixels

struct truth {
  picture_table pictures;
  std::vector<double> agreement; // for each function
};

truth make_truth(stratus_context* context, const tetra_mesh& mesh, const options& o)
{
  truth t;
  std::vector<transfer> functions;
  for (const std::string& function : o.functions) {
    functions.push_back(tetra_transfer(mesh, function));
  }
  for (int view = 0; view < views; ++view) {
    stratus_camera camera;
    if (stratus_scene_camera(context, mesh.bounds, 2, view, 0, 1.0, &camera) != STRATUS_OK) {
      throw failure(stratus_context_message(context));
    }
    t.pictures.push_back(tetra_references(mesh, functions, camera, o.size, o.reference_cache, view == 0 ? &t.agreement : nullptr));
  }
  return t;
}

void add_more(const std::string& scene, const std::string& method, const sorter_metrics& more, std::vector<row>& rows)
{
  for (const auto& m : more) {
    rows.push_back({ scene, method, m.first, m.second.second, m.second.first });
  }
}

// Writes a picture over black, as the window shows it.
void write_picture(
  const std::string& folder, const std::string& scene, const std::string& method, const std::vector<uint8_t>& rgba, int size)
{
  vtkNew<vtkImageData> image;
  vtkNew<vtkPNGWriter> writer;
  std::string name = scene + '-' + method + ".png";
  std::replace_if(
    name.begin(), name.end(), [](char c) { return c == '/' || c == ':'; }, '-');
  image->SetDimensions(size, size, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  auto* bytes = static_cast<uint8_t*>(image->GetScalarPointer());
  for (size_t i = 0; i < rgba.size(); ++i) {
    if (i % 4 < 3) {
      *bytes++ = rgba[i];
    }
  }
  writer->SetFileName((folder + '/' + name).c_str());
  writer->SetInputData(image);
  writer->Write();
  if (writer->GetErrorCode() != 0) {
    throw failure("cannot write " + folder + '/' + name);
  }
}

void write_pictures(
  const options& o, const std::string& scene, const std::vector<frame_result>& results, const std::vector<float>& reference)
{
  std::vector<uint8_t> bytes(reference.size());
  std::transform(reference.begin(), reference.end(), bytes.begin(), [](float x) { return static_cast<uint8_t>(255.0f * x + 0.5f); });
  write_picture(o.pictures, scene, "reference", bytes, o.size);
  for (const frame_result& r : results) {
    write_picture(o.pictures, scene, r.method, r.pictures[0].bytes, o.size);
  }
}

void add_errors(const truth& t, size_t function, const frame_result& r, const std::string& scene, std::vector<row>& rows)
{
  tetra_error in_float, in_bytes;
  for (size_t view = 0; view < r.pictures.size(); ++view) {
    const std::vector<float>& reference = t.pictures[view][function];
    const tetra_picture& p = r.pictures[view];
    std::vector<float> floats(p.bytes.size());
    std::transform(p.bytes.begin(), p.bytes.end(), floats.begin(), [](uint8_t b) { return static_cast<float>(b) / 255.0f; });
    in_bytes.add(floats.data(), reference.data(), reference.size() / 4);
    if (!p.rgba.empty()) {
      in_float.add(p.rgba.data(), reference.data(), reference.size() / 4);
    }
  }
  if (in_float.count > 0.0) {
    rows.push_back({ scene, r.method, "rmse255", "1", in_float.rmse255() });
  }
  rows.push_back({ scene, r.method, "rmse255_8bit", "1", in_bytes.rmse255() });
  rows.push_back({ scene, r.method, "reference_rmse255", "1", t.agreement[function] });
}

void run_mesh(stratus_context* context, const tetra_mesh& mesh, const options& o, std::vector<row>& rows)
{
  std::vector<std::string> mappers, sorters;
  for (const std::string& method : o.methods) {
    (is_tetra_mapper(method) ? mappers : sorters).push_back(method);
  }
  std::vector<std::string> needed = sorters; // the requested sorters, and the sorters that pictures depend on
  for (const std::string& mapper : mappers) {
    if (!sorter_of(mapper).empty() && !has(needed, sorter_of(mapper))) {
      needed.push_back(sorter_of(mapper));
    }
  }
  order_options how;
  how.rounds = std::min(o.repeats, 3);
  how.rays = o.rays;
  how.threads = stratus_context_threads(context);
  std::map<std::string, sorter_metrics> orders = run_sorters(context, mesh, needed, how);
  const truth t = o.error && !mappers.empty() ? make_truth(context, mesh, o) : truth();
  for (size_t f = 0; f < o.functions.size(); ++f) {
    const std::string scene = mesh.name + '/' + o.functions[f];
    std::fprintf(stderr, "%s\n", scene.c_str());
    std::vector<mapper_failure> failures;
    const std::vector<frame_result> results =
      run_mappers(context, mesh, tetra_transfer(mesh, o.functions[f]), mappers, o.size, o.repeats, failures);
    for (const mapper_failure& wrong : failures) {
      add_failure(scene, wrong.method, wrong.why.c_str(), rows);
    }
    if (o.error && !o.pictures.empty()) {
      write_pictures(o, scene, results, t.pictures[0][f]);
    }
    for (const frame_result& r : results) {
      rows.push_back({ scene, r.method, "first_ms", "ms", r.first_ms });
      rows.push_back({ scene, r.method, "frame_ms", "ms", r.frame_ms });
      add_repeats(scene, r.method, "frame_ms", "ms", r.frames, rows);
      if (o.error) {
        add_errors(t, f, r, scene, rows);
      }
      add_more(scene, r.method, r.more, rows);
      if (!sorter_of(r.method).empty()) {
        sorter_metrics order = orders[sorter_of(r.method)];
        for (const auto& m : r.more) { // a picture's own metrics replace its order's metrics
          order.erase(m.first);
        }
        add_more(scene, r.method, order, rows);
      }
    }
    for (const std::string& s : sorters) {
      add_more(scene, s, orders[s], rows);
    }
  }
}

// ---- output

void print(const std::vector<row>& rows)
{
  static const char* const metrics[] = { "frame_ms", "rmse255", "rmse255_8bit", "resample_ms", "sort_ms", "sort_1thread_ms", "build_ms",
    "wrong_visible_pairs", "cycles", "layers", "cells", "peak_bytes_per_cell", "bytes_per_cell" };
  std::map<std::string, double> values;
  std::vector<std::pair<std::string, std::string>> lines;
  for (const row& r : rows) {
    values[r.scene + '\n' + r.method + '\n' + r.metric] = r.value;
    if (lines.empty() || lines.back() != std::make_pair(r.scene, r.method)) {
      lines.emplace_back(r.scene, r.method);
    }
  }
  std::fprintf(stderr, "%-16s %-28s", "scene", "method");
  for (const char* metric : metrics) {
    std::fprintf(stderr, " %9.9s", metric);
  }
  for (const auto& line : lines) {
    std::fprintf(stderr, "\n%-16s %-28s", line.first.c_str(), line.second.c_str());
    for (const char* metric : metrics) {
      const auto found = values.find(line.first + '\n' + line.second + '\n' + metric);
      std::fprintf(stderr, found == values.end() ? " %9s" : "", "");
      if (found != values.end()) {
        std::fprintf(stderr, std::strncmp(metric, "rmse", 4) == 0 ? " %9.4f" : found->second < 1e3 ? " %9.2f" : " %9.0f", found->second);
      }
    }
  }
  std::fprintf(stderr, "\n");
}

// Returns whether all methods were measured.
bool run(stratus_context* context, const options& o)
{
  check_writable(o.csv);
  std::vector<row> rows;
  for (const std::string& folder : { o.cache, o.reference_cache, o.pictures }) {
    make_folder(folder);
  }
  for (const std::string& source : o.meshes) {
    tetra_mesh mesh;
    std::fprintf(stderr, "%s\n", source.c_str());
    if (make_tetra_mesh(context, source, o.cache, mesh)) {
      run_mesh(context, mesh, o, rows);
    }
  }
  if (rows.empty()) {
    throw failure("no mesh to measure");
  }
  print(rows);
  save_rows(o.csv, rows, "tetra", o.append);
  if (!o.chart.empty()) {
    write_chart(o.chart, curves_of("tetra", o.append ? read_csv(o.csv).rows : rows).front());
  }
  return !any_failed(rows);
}
} // namespace

int tetra_main(int argc, char* argv[])
{
  if (argc > 2 && std::strcmp(argv[2], "--help") == 0) {
    std::fputs(help, stdout);
    return 0;
  }
  const options o = parse(argc, argv);
  ensure_display(argv);
  stratus_context_options host = stratus_context_options_default();
  stratus_context* made = nullptr;
  char message[512];
  host.device = "host";
  if (stratus_context_create(&host, &made, message, sizeof message) != STRATUS_OK) {
    throw failure(message);
  }
  const std::unique_ptr<stratus_context, decltype(&stratus_context_destroy)> context(made, &stratus_context_destroy);
  return run(made, o) ? 0 : 1;
}
} // namespace bench
