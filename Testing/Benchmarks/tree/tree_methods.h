// SPDX-License-Identifier: BSD-3-Clause
// What the parts of `stratus-bench tree` share: a set of voxels, its rays, and whoever finds first hits in it.
#pragma once

#include "bench.h"

namespace bench {

// Voxel (i,j,k) fills [i,i+1] and so on.
struct voxel_set {
  std::string name;
  int64_t dimensions[3];
  const int32_t* positions; // triples
  size_t count;
};

struct voxel_rays {
  std::vector<stratus_ray> rays;
  bool coherent; // 512 x 512 of a picture, row by row
};

struct voxel_hit {
  double t = -1.0; // < 0: none
  int32_t voxel[3] = { -1, -1, -1 };
};

struct tree_numbers {
  double bytes = -1.0, nodes = -1.0, depth = -1.0, sah = -1.0; // -1: not told
};

// One method on one set. build() makes everything anew from the list with 2 threads; trace() runs on one thread what prepare() has laid
// out.
class first_hits
{
public:
  virtual ~first_hits() = default;
  virtual void build() = 0;
  virtual tree_numbers numbers() const = 0;
  virtual void prepare(const voxel_rays& rays) = 0; // not timed: rays in the method's own form
  virtual void trace() = 0;
  virtual std::vector<voxel_hit> hits() const = 0; // of the last trace(), in the rays' order
};

// ---- embree.cxx: low, medium, high, packet, bricks
std::unique_ptr<first_hits> make_embree_hits(const voxel_set& set, const std::string& kind);
// ---- openvdb_tree.cxx
std::unique_ptr<first_hits> make_openvdb_hits(const voxel_set& set);
// ---- tree_judge.cxx: hits that differ from the plain walk's; grazing: those where rounding decides
struct wrong_count {
  int64_t wrong = 0, grazing = 0;
};
wrong_count count_wrong(
  const stratus_voxels* voxels, const voxel_rays& rays, const std::vector<stratus_hit>& walk, const std::vector<voxel_hit>& hits);

// ---- tree.cxx
int tree_main(int argc, char* argv[]);
} // namespace bench
