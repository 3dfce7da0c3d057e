// SPDX-License-Identifier: BSD-3-Clause
// Declarations that the parts of stratus-bench octree share: scenes of boxes, paths of cameras, and the judge.
#pragma once

#include "stratus.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace bench {

struct row; // bench.h

int octree_main(int argc, char* argv[]);

// ---- octree_scenes.cxx

using box_bounds = std::array<double, 6>;

// boxes-N: N boxes, unevenly spread over a cube of edge 100, with edges in a range of 100 to 1; the same at each call.
std::vector<box_bounds> make_boxes(const std::string& name);
const std::vector<std::string>& path_names(); // far, near, inside, turn
std::vector<stratus_camera> camera_path(stratus_context* context, const std::string& name, int frames);

// ---- octree_judge.cxx

struct verdict {
  size_t kept = 0, wrong_culls = 0, false_keeps = 0;
};
// Clips every box against the frustum, face by face. ids: the boxes that a method kept.
verdict judge_culling(
  const std::vector<box_bounds>& boxes, const stratus_frustum& frustum, const stratus_camera& camera, const uint32_t* ids, size_t count);

// ---- octree.cxx

struct closer {
  void operator()(stratus_context* c) const { stratus_context_destroy(c); }
  void operator()(stratus_octree* t) const { stratus_octree_destroy(t); }
  void operator()(stratus_octree_view* v) const { stratus_octree_view_destroy(v); }
};

// A new tree of boxes, and a view of it.
struct octree_run {
  octree_run(stratus_context* context, const std::vector<box_bounds>& boxes, const stratus_octree_options& options);
  // Returns the milliseconds of a call. threads: of the host.
  double look(const stratus_camera& camera, const stratus_octree_cull_options* options, int threads, stratus_octree_visible* visible) const;

  stratus_context* context;
  std::unique_ptr<stratus_octree, closer> tree; // outlives its view
  std::unique_ptr<stratus_octree_view, closer> view;
  std::vector<uint32_t> ids;
};

// ---- octree_paper.cxx

void run_paper(stratus_context* context, std::vector<row>& rows);

// ---- octree_actors.cxx

const std::vector<std::string>& actor_methods();
// actors-N: the boxes of boxes-N as actors.
void run_actors(stratus_context* context, const std::string& scene, const std::vector<std::string>& paths, int frames,
  const std::vector<std::string>& methods, std::vector<row>& rows);
} // namespace bench
