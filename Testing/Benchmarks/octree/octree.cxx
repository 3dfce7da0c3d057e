// SPDX-License-Identifier: BSD-3-Clause
// stratus-bench octree: finds which of many boxes a camera sees, by view-adaptive octrees, a static octree and a plain list.
#include "octree_bench.h"
#include "bench.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <iterator>
#include <map>
#include <memory>

namespace bench {

namespace {

const char* const help = R"(stratus-bench octree [options]

  --scene NAME,...     boxes-N; actors-N: the same boxes as actors of VTK; paper: tables 1 to 3 of Li & Huang 2024 (default:
                       boxes-1000,boxes-9454,boxes-100000,boxes-1000000,actors-1000,actors-9454,actors-100000,paper)
  --path NAME,...      far, near, inside, turn (default: all of them)
  --method M,...       stratus:octree-paper|octree-euclid|octree-pixel|static|linear; the first two with :C behind, for another C, static
                       with :N, to leave nodes of N objects or fewer whole (16 without; the adaptive ones: 256). With actors
                       stratus:culler|culler-static, vtk:coverage. (default: all)
  --sweep C,...        stratus:octree-paper at these C too
  --curves             methods over their settings: C, objects in a leaf
  --frames N           of each path (default 120)
  --threads N          of the host (default 1)
  --csv FILE           tidy rows: benchmark,scene,method,metric,value,unit (default: the standard output); a scene is NAME/PATH
                       the comments before them say where they come from, as in stratus-bench volume
  --append             rows of other scenes that the file has stay
  --chart FILE.png     cull_ms against false_keeps

With one thread, times of culling are its processor time, otherwise wall clock. Methods take turns frame by frame.
  cull_ms, cull_worst_ms             median and slowest of a path's frames, from a tree without history; with actors the whole of Cull(),
                                     its search for changes included
  cull_first_ms                      with actors: a culler's first frame
  exact_cull_ms, exact_false_keeps   with separating axes
  update_ms                          1 % of the boxes moved by their own size
  nodes, bytes, depth                at the path's end; bytes are added to a list of the boxes. The static octree is split down to the
                                     depth that the pixel one reached
  added_bytes                        the tree's, in percent of the bytes of a list of its objects
  visible                            mean of the frames
  frame_ms, _best_ms, _worst_ms      with actors: median, fastest and slowest of up to 24 frames of the path, 512 x 384
  frame_cpu_ms, frame_cpu_worst_ms   with actors: processor time of all threads, median and most
  wrong_culls, false_keeps           against faces cut by the planes, at 5 frames; false_keeps in percent of the kept objects
)";

struct options {
  std::vector<std::string> scenes, paths, methods;
  std::string csv = "-", chart;
  int frames = 120, threads = 1;
  bool append = false, curves = false;
};

using context_pointer = std::unique_ptr<stratus_context, closer>;

void need(stratus_context* context, stratus_status status)
{
  if (status != STRATUS_OK) {
    throw failure(stratus_context_message(context));
  }
}

double clock_ms(int threads)
{
  if (threads > 1) {
    return now_ms();
  }
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

bool of_actors(const std::string& method)
{
  return std::count(actor_methods().begin(), actor_methods().end(), method) > 0;
}

stratus_octree_options method_options(const std::string& method)
{
  stratus_octree_options o = stratus_octree_options_default();
  const size_t number = method.find(':', 8);
  const std::string name = method.substr(0, number);
  if (name == "stratus:octree-paper" || name == "stratus:octree-euclid") {
    o.placement = STRATUS_OCTREE_TOUCHING;
    o.stop = name == "stratus:octree-paper" ? STRATUS_OCTREE_STOP_MANHATTAN : STRATUS_OCTREE_STOP_EUCLID;
    o.c = number == std::string::npos ? o.c : std::atof(method.c_str() + number + 1);
  } else if (name == "stratus:static") {
    o.stop = STRATUS_OCTREE_STOP_STATIC;
    o.leaf_objects = number == std::string::npos ? 16 : std::atoi(method.c_str() + number + 1);
  } else if (name == "stratus:linear") {
    o.levels = 0;
  } else if (name != "stratus:octree-pixel") {
    throw failure("unknown method " + method + "; see --help");
  }
  return o;
}

// ---- one method on one path

struct path_run {
  stratus_context* context;
  const std::vector<box_bounds>& boxes;
  const std::vector<stratus_camera>& cameras;
  int threads;
};

struct walked {
  std::vector<double> ms;
  double visible = 0.0;
  verdict judged;
};

walked walk_path(const path_run& run, const octree_run& octree, bool exact, bool judge)
{
  walked w;
  stratus_octree_cull_options cull = {};
  cull.exact = exact;
  const size_t frames = run.cameras.size(), every = std::max<size_t>(frames / 5, 1);
  for (size_t f = 0; f < frames; ++f) {
    stratus_octree_visible visible;
    w.ms.push_back(octree.look(run.cameras[f], &cull, run.threads, &visible));
    w.visible += static_cast<double>(visible.count) / static_cast<double>(frames);
    if (judge && f % every == every - 1) {
      stratus_frustum frustum;
      need(run.context, stratus_frustum_from_camera(run.context, &run.cameras[f], &frustum));
      const verdict v = judge_culling(run.boxes, frustum, run.cameras[f], visible.ids, visible.count);
      w.judged.kept += v.kept;
      w.judged.wrong_culls += v.wrong_culls;
      w.judged.false_keeps += v.false_keeps;
    }
  }
  return w;
}

double false_percent(const verdict& v)
{
  return v.kept > 0 ? 100.0 * static_cast<double>(v.false_keeps) / static_cast<double>(v.kept) : 0.0;
}

// Times five updates, each of which moves 1 % of the boxes, spread over all, by their own size.
double update_ms(const path_run& run, const octree_run& octree)
{
  std::vector<double> times;
  const size_t count = std::max<size_t>(run.boxes.size() / 100, 1);
  for (size_t repeat = 0; repeat < 5; ++repeat) {
    std::vector<uint32_t> moved;
    std::vector<box_bounds> bounds;
    for (size_t i = 0; i < count; ++i) {
      const size_t which = (i * 100 + repeat * 17) % run.boxes.size();
      box_bounds box = run.boxes[which];
      for (size_t a = 0; a < 3; ++a) {
        const double size = box[2 * a + 1] - box[2 * a];
        box[2 * a] += size;
        box[2 * a + 1] += size;
      }
      moved.push_back(octree.ids[which]);
      bounds.push_back(box);
    }
    const double start = clock_ms(run.threads);
    need(run.context, stratus_octree_move(octree.tree.get(), moved.data(), bounds[0].data(), count));
    times.push_back(clock_ms(run.threads) - start);
  }
  return median(times);
}

void run_method(const path_run& run, const std::string& scene, const std::string& method, int depth, std::vector<row>& rows)
{
  stratus_octree_options o = method_options(method);
  o.levels = o.stop == STRATUS_OCTREE_STOP_STATIC ? depth : o.levels;
  const octree_run octree(run.context, run.boxes, o);
  const walked plain = walk_path(run, octree, false, false);
  stratus_octree_statistics statistics;
  stratus_octree_get_statistics(octree.tree.get(), &statistics);
  const walked judged = walk_path(run, octree, false, true), exact = walk_path(run, octree, true, true);
  const size_t wrong = judged.judged.wrong_culls + exact.judged.wrong_culls;
  const auto add = [&](const char* metric, double value, const char* unit) { rows.push_back({ scene, method, metric, unit, value }); };
  add("cull_ms", median(plain.ms), "ms");
  add_repeats(scene, method, "cull_ms", "ms", plain.ms, rows);
  add("cull_worst_ms", *std::max_element(plain.ms.begin(), plain.ms.end()), "ms");
  add("exact_cull_ms", median(exact.ms), "ms");
  const double moved = update_ms(run, octree);
  add("update_ms", moved, "ms");
  add("nodes", static_cast<double>(statistics.nodes), "1");
  add("depth", statistics.depth, "1");
  add("bytes", static_cast<double>(statistics.bytes), "B");
  add("visible", plain.visible, "1");
  add("false_keeps", false_percent(judged.judged), "%");
  add("exact_false_keeps", false_percent(exact.judged), "%");
  add("wrong_culls", static_cast<double>(wrong), "1");
  std::fprintf(stderr,
    "  %-26s cull %.3f worst %.2f exact %.3f update %.2f ms, %zu nodes, depth %d, %.3g bytes, visible %.0f, false %.3f %% exact %.3f %%, "
    "wrong %zu\n",
    method.c_str(), median(plain.ms), *std::max_element(plain.ms.begin(), plain.ms.end()), median(exact.ms), moved, statistics.nodes,
    statistics.depth, static_cast<double>(statistics.bytes), plain.visible, false_percent(judged.judged), false_percent(exact.judged),
    wrong);
}

// Returns the depth that the pixel octree reaches on the path. The static octree gets this depth.
int pixel_depth(const path_run& run)
{
  stratus_octree_statistics statistics;
  const octree_run octree(run.context, run.boxes, method_options("stratus:octree-pixel"));
  walk_path(run, octree, false, false);
  stratus_octree_get_statistics(octree.tree.get(), &statistics);
  return std::max(statistics.depth, 1);
}

// ---- options

void check(options& o, const std::vector<std::string>& sweep)
{
  if (o.scenes.empty()) {
    o.scenes = { "boxes-1000", "boxes-9454", "boxes-100000", "boxes-1000000", "actors-1000", "actors-9454", "actors-100000", "paper" };
  }
  if (o.methods.empty()) {
    o.methods = { "stratus:octree-paper", "stratus:octree-euclid", "stratus:octree-pixel", "stratus:static", "stratus:static:256",
      "stratus:linear" };
    o.methods.insert(o.methods.end(), actor_methods().begin(), actor_methods().end());
  }
  if (o.curves) {
    o.methods = { "stratus:octree-paper:17.5", "stratus:octree-paper:35", "stratus:octree-paper:70", "stratus:octree-euclid:17.5",
      "stratus:octree-euclid:35", "stratus:octree-euclid:70", "stratus:octree-pixel", "stratus:static:4", "stratus:static:16",
      "stratus:static:256", "stratus:linear" };
    o.methods.insert(o.methods.end(), actor_methods().begin(), actor_methods().end());
  }
  for (const std::string& c : sweep) {
    o.methods.push_back("stratus:octree-paper:" + c);
  }
  for (const std::string& method : o.methods) {
    if (!of_actors(method)) {
      method_options(method);
    }
  }
  o.paths = o.paths.empty() ? path_names() : o.paths;
  for (const std::string& path : o.paths) {
    if (std::count(path_names().begin(), path_names().end(), path) == 0) {
      throw failure("unknown path " + path + "; see --help");
    }
  }
  if (o.frames < 1 || o.frames > 100000) {
    throw failure("--frames must be within 1..100000");
  }
}

options parse(int argc, char* argv[])
{
  options o;
  std::vector<std::string> sweep;
  for (int i = 2; i < argc; i += 2) {
    const std::string word = argv[i];
    if (word == "--append" || word == "--curves") {
      o.append = o.append || word == "--append";
      o.curves = o.curves || word == "--curves";
      --i;
      continue;
    }
    if (i + 1 == argc) {
      throw failure(word + " is unknown or lacks its value; see --help");
    }
    const std::string value = argv[i + 1];
    std::map<std::string, std::vector<std::string>*> lists = { { "--scene", &o.scenes }, { "--path", &o.paths }, { "--method", &o.methods },
      { "--sweep", &sweep } };
    std::map<std::string, int*> numbers = { { "--frames", &o.frames }, { "--threads", &o.threads } };
    std::map<std::string, std::string*> files = { { "--csv", &o.csv }, { "--chart", &o.chart } };
    if (lists.count(word) > 0) {
      *lists[word] = split(value);
    } else if (numbers.count(word) > 0) {
      *numbers[word] = std::atoi(value.c_str());
    } else if (files.count(word) > 0) {
      *files[word] = value;
    } else {
      throw failure("unknown option " + word + "; see --help");
    }
  }
  check(o, sweep);
  return o;
}

void run_scene(stratus_context* context, const std::string& scene, const options& o, std::vector<row>& rows)
{
  std::vector<std::string> of_boxes, others;
  std::partition_copy(o.methods.begin(), o.methods.end(), std::back_inserter(others), std::back_inserter(of_boxes), of_actors);
  if (scene.rfind("actors-", 0) == 0) {
    run_actors(context, scene, o.paths, o.frames, others, rows);
    return;
  }
  if (scene == "paper") {
    run_paper(context, rows);
    return;
  }
  const std::vector<box_bounds> boxes = make_boxes(scene);
  for (const std::string& path : o.paths) {
    std::fprintf(stderr, "%s/%s\n", scene.c_str(), path.c_str());
    const std::vector<stratus_camera> cameras = camera_path(context, path, o.frames);
    const path_run run = { context, boxes, cameras, o.threads };
    const int depth = pixel_depth(run);
    for (const std::string& method : of_boxes) {
      run_method(run, scene + '/' + path, method, depth, rows);
    }
  }
}
} // namespace

octree_run::octree_run(stratus_context* c, const std::vector<box_bounds>& boxes, const stratus_octree_options& options)
    : context(c), ids(boxes.size())
{
  stratus_octree* made = nullptr;
  stratus_octree_view* looking = nullptr;
  need(c, stratus_octree_create(c, &options, &made));
  this->tree.reset(made);
  need(c, stratus_octree_insert(made, boxes[0].data(), boxes.size(), this->ids.data()));
  need(c, stratus_octree_view_create(made, &looking));
  this->view.reset(looking);
}

double octree_run::look(
  const stratus_camera& camera, const stratus_octree_cull_options* options, int threads, stratus_octree_visible* visible) const
{
  stratus_frustum frustum;
  need(this->context, stratus_frustum_from_camera(this->context, &camera, &frustum));
  const double start = clock_ms(threads);
  need(this->context, stratus_octree_cull(this->view.get(), &frustum, options, visible));
  return clock_ms(threads) - start;
}

int octree_main(int argc, char* argv[])
{
  if (argc > 2 && std::strcmp(argv[2], "--help") == 0) {
    std::fputs(help, stdout);
    return 0;
  }
  const options o = parse(argc, argv);
  const bool actors =
    std::any_of(o.scenes.begin(), o.scenes.end(), [](const std::string& scene) { return scene.rfind("actors-", 0) == 0; });
  if (!o.chart.empty() || actors) {
    ensure_display(argv);
  }
  stratus_context_options host = stratus_context_options_default();
  stratus_context* made = nullptr;
  char message[512];
  host.device = "host";
  host.threads = o.threads;
  if (stratus_context_create(&host, &made, message, sizeof message) != STRATUS_OK) {
    throw failure(message);
  }
  const context_pointer context(made);
  std::vector<row> rows;
  check_writable(o.csv);
  for (const std::string& scene : o.scenes) {
    run_scene(made, scene, o, rows);
  }
  save_rows(o.csv, rows, "octree", o.append);
  if (!o.chart.empty()) {
    write_chart(o.chart, curves_of("octree", rows).front());
  }
  return any_failed(rows) ? 1 : 0;
}
} // namespace bench
