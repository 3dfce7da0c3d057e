// SPDX-License-Identifier: BSD-3-Clause
// Declarations that the parts of `stratus-bench tree` share: a set of voxels, its rays, and the methods that find first hits.
#pragma once

#include "bench.h"

namespace bench {

// Voxel (i,j,k) is [i,i+1] x [j,j+1] x [k,k+1].
struct voxel_set {
  std::string name;
  int64_t dimensions[3];
  const int32_t* positions; // triples
  size_t count;
};

struct voxel_rays {
  std::vector<stratus_ray> rays;
  bool coherent; // the rays of a picture of 512 x 512, row by row
};

struct voxel_hit {
  double t = -1.0; // < 0: none
  int32_t voxel[3] = { -1, -1, -1 };
};

struct tree_numbers {
  double bytes = -1.0, nodes = -1.0, depth = -1.0, sah = -1.0; // -1: unknown
};

// The numbers of a picture's rays tile by tile, each of tile x tile pixels; of other rays as they come.
std::vector<uint32_t> tile_order(const voxel_rays& rays, size_t tile);

// One method on one set. build() rebuilds everything from the list with 2 threads. trace() traces the prepared rays on one thread.
class first_hits
{
public:
  virtual ~first_hits() = default;
  virtual void build() = 0;
  virtual tree_numbers numbers() const = 0;
  virtual void prepare(const voxel_rays& rays) = 0; // converts rays to the method's own form; not timed
  virtual void trace() = 0;
  virtual std::vector<voxel_hit> hits() const = 0; // of the last trace(), in the rays' order
  virtual double visits() const { return -1.0; }   // nodes and steps a ray of the last trace(), in the mean; -1: unknown
};

// ---- tree_names.cxx: ours, and the names of all

struct context_deleter {
  void operator()(stratus_context* c) const { stratus_context_destroy(c); }
};
using context_pointer = std::unique_ptr<stratus_context, context_deleter>;
context_pointer open_context(const char* device, int threads); // throws failure
context_pointer host_context(int threads);
void check_status(stratus_context* context, stratus_status status); // throws failure

std::vector<std::string> all_tree_methods();
// Every exact method at three sizes of leaves, or qualities of the build. quick: without the slow ones.
std::vector<std::string> tree_curve_methods(bool quick);
bool is_tree_method(const std::string& name); // with or without a size of leaves
bool is_slow_tree(const std::string& method);
stratus_tree_options tree_options_of(const std::string& method); // of one of ours
bool may_err(const std::string& method);                         // whether a method's rays may step past voxels
std::unique_ptr<first_hits> make_hits(const voxel_set& set, const std::string& method);

// ---- embree.cxx: low, medium, high; packet, bricks, with :low, :high or nothing (medium) behind
std::unique_ptr<first_hits> make_embree_hits(const voxel_set& set, const std::string& kind);
// ---- openvdb_tree.cxx
std::unique_ptr<first_hits> make_openvdb_hits(const voxel_set& set);
// ---- tree_clusters.cxx: generated sets, clusters:NUMBER
struct cluster_box {
  int32_t lo[3], hi[3]; // voxels, [lo, hi)
};
bool is_cluster_scene(const std::string& name);
void make_cluster_set(const std::string& name, int64_t dimensions[3], std::vector<int32_t>& positions, std::vector<cluster_box>& boxes);
// Fills rays that begin in empty voxels in and about the boxes.
void make_cluster_rays(const stratus_voxels* voxels, const std::vector<cluster_box>& boxes, std::vector<stratus_ray>& rays);
// ---- tree_judge.cxx: counts hits that differ from the plain walk's. grazing: decided by rounding; wrong: all others; missed, late: wrong
// hits that find no voxel, or one behind the walk's
struct wrong_count {
  int64_t wrong = 0, grazing = 0, missed = 0, late = 0;
};
wrong_count count_wrong(
  const stratus_voxels* voxels, const voxel_rays& rays, const std::vector<stratus_hit>& walk, const std::vector<voxel_hit>& hits);

// ---- tree.cxx
int tree_main(int argc, char* argv[]);
// ---- tree_stages.cxx: builds stage by stage and rays, on the host and on a device; adds a row for each stage's times and kernels, and for
// the rays' times and errors. Throws failure if the two trees or their hits differ.
void run_stages(const voxel_set& set, const std::string& method, const std::string& device, int rounds, std::vector<row>& rows);

} // namespace bench
