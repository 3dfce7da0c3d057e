// SPDX-License-Identifier: BSD-3-Clause
// Tables 1 to 3 of Li & Huang 2024 on our 9454 boxes: the savings of splitting on demand, the effect of C, and the cost of a level. (Rows
// of actors-9454 are its table 4, frames per second.) All trees are the paper's: an object is in every child that its sphere touches, and
// nodes are split to the last level or C.
#include "bench.h"
#include "octree_bench.h"

#include <cstdio>
#include <memory>

namespace bench {

namespace {

constexpr const char* scene_of_the_paper = "boxes-9454";
constexpr int frames = 120;

struct grown {
  double nodes, bytes, object_bytes, cull_ms, culled;
};

// Walks a tree along the whole path. cull_ms and culled (percent) are means over the frames.
grown grow(stratus_context* context, const std::vector<box_bounds>& boxes, const std::vector<stratus_camera>& cameras,
  const stratus_octree_options& o)
{
  const octree_run run(context, boxes, o);
  double ms = 0.0, visible = 0.0;
  for (const stratus_camera& camera : cameras) {
    stratus_octree_visible seen;
    ms += run.look(camera, nullptr, 1, &seen);
    visible += static_cast<double>(seen.count);
  }
  stratus_octree_statistics s;
  stratus_octree_get_statistics(run.tree.get(), &s);
  const double count = static_cast<double>(cameras.size());
  return { static_cast<double>(s.nodes), static_cast<double>(s.bytes), static_cast<double>(s.object_bytes), ms / count,
    100.0 - 100.0 * visible / count / static_cast<double>(boxes.size()) };
}

// Leaves hold one object, so that only the last level or C ends a branch. C of 1e9 turns the rule by distance off; callers may lower it.
stratus_octree_options options_of(bool on_demand, int levels)
{
  stratus_octree_options o = stratus_octree_options_default();
  o.placement = STRATUS_OCTREE_TOUCHING;
  o.stop = on_demand ? STRATUS_OCTREE_STOP_MANHATTAN : STRATUS_OCTREE_STOP_STATIC;
  o.c = 1e9;
  o.leaf_objects = 1;
  o.levels = levels;
  return o;
}

struct row_adder {
  std::vector<row>& rows;
  void add(const std::string& scene, const std::string& method, const grown& g) const
  {
    rows.push_back({ scene, method, "nodes", "1", g.nodes });
    rows.push_back({ scene, method, "bytes", "B", g.bytes });
    rows.push_back({ scene, method, "added_bytes", "%", 100.0 * g.bytes / g.object_bytes });
    rows.push_back({ scene, method, "cull_mean_ms", "ms", g.cull_ms });
    rows.push_back({ scene, method, "culled", "%", g.culled });
    std::fprintf(stderr, "  %-22s %-26s %.0f nodes, %.3g bytes (%.0f %% of the objects'), cull %.3f ms, culled %.1f %%\n", scene.c_str(),
      method.c_str(), g.nodes, g.bytes, 100.0 * g.bytes / g.object_bytes, g.cull_ms, g.culled);
  }
};
} // namespace

void run_paper(stratus_context* context, std::vector<row>& rows)
{
  const std::vector<box_bounds> boxes = make_boxes(scene_of_the_paper);
  const row_adder to = { rows };
  const auto one_view = [&](const std::string& path) { return camera_path(context, path, 1); };
  // Table 1: one view, and many views.
  for (const char* path : { "inside", "turn" }) {
    for (const int views : { 1, frames }) {
      const std::string scene = std::string("paper-table-1/") + path + (views > 1 ? "-path" : "-view");
      to.add(scene, "stratus:static", grow(context, boxes, camera_path(context, path, views), options_of(false, 5)));
      to.add(scene, "stratus:octree-on-demand", grow(context, boxes, camera_path(context, path, views), options_of(true, 5)));
    }
  }
  // Table 2: values of C at several distances.
  for (const char* path : { "far", "near", "inside" }) {
    for (const int c : { 5, 15, 25, 35, 40, 70 }) {
      stratus_octree_options o = options_of(true, 8);
      o.c = c;
      to.add(std::string("paper-table-2/") + path, "stratus:octree-paper:" + std::to_string(c), grow(context, boxes, one_view(path), o));
    }
  }
  // Table 3: nodes and memory at the same depth.
  for (int depth = 2; depth <= 7; ++depth) {
    const std::string scene = "paper-table-3/depth-" + std::to_string(depth);
    to.add(scene, "stratus:static", grow(context, boxes, one_view("inside"), options_of(false, depth)));
    to.add(scene, "stratus:octree-on-demand", grow(context, boxes, one_view("inside"), options_of(true, depth)));
  }
}
} // namespace bench
