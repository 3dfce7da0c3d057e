// SPDX-License-Identifier: BSD-3-Clause
// OpenVDB's mask tree, traversed by its hierarchical DDA down to the voxel.
#include <openvdb/openvdb.h>
#include <openvdb/math/DDA.h>
#include <openvdb/math/Ray.h>
#include <openvdb/tree/ValueAccessor.h>

#include "tree_methods.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

namespace bench {

namespace {

using mask_tree = openvdb::MaskTree;
using index_ray = openvdb::math::Ray<double>;

// The callbacks of LevelSetHDDA: the accessor finds nodes, and the last level tests whether the voxel is on.
class tester
{
public:
  using RayT = index_ray;
  explicit tester(const mask_tree& t) : accessor(t) {}
  void set_ray(const RayT& r) { this->whole = r; }
  const RayT& ray() const { return this->whole; }
  template <typename Node> bool hasNode(const openvdb::Coord& at) { return this->accessor.probeConstNode<Node>(at) != nullptr; }
  void setRange(double from, double to) { this->whole.setTimes(from, to); }
  void init(double from) { this->time = from; }
  bool operator()(const openvdb::Coord& at, double next)
  {
    if (this->accessor.isValueOn(at)) {
      this->voxel = at;
      return true;
    }
    this->time = next;
    return false;
  }

  double time = 0.0;
  openvdb::Coord voxel;

private:
  openvdb::tree::ValueAccessor<const mask_tree> accessor;
  RayT whole;
};

struct filler {
  const voxel_set* set;
  mask_tree::Ptr tree = std::make_shared<mask_tree>();

  explicit filler(const voxel_set* s) : set(s) {}
  filler(filler& other, tbb::split) : set(other.set) {}
  void operator()(const tbb::blocked_range<size_t>& range)
  {
    openvdb::tree::ValueAccessor<mask_tree> accessor(*this->tree);
    for (size_t v = range.begin(); v < range.end(); ++v) {
      const int32_t* p = this->set->positions + 3 * v;
      accessor.setValueOn(openvdb::Coord(p[0], p[1], p[2]));
    }
  }
  void join(filler& other) { this->tree->merge(*other.tree, openvdb::MERGE_ACTIVE_STATES_AND_NODES); }
};

class openvdb_hits : public first_hits
{
public:
  explicit openvdb_hits(const voxel_set& s) : set(s) {}
  void build() override
  {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 2);
    filler all(&this->set);
    tbb::parallel_reduce(tbb::blocked_range<size_t>(0, this->set.count, std::max<size_t>(1, (this->set.count + 1) / 2)), all);
    this->tree = all.tree;
    this->tree->evalActiveVoxelBoundingBox(this->box);
  }
  tree_numbers numbers() const override
  {
    tree_numbers n;
    n.bytes = static_cast<double>(this->tree->memUsage());
    std::vector<openvdb::Index32> counts = this->tree->nodeCount();
    n.nodes = 0.0;
    for (const openvdb::Index32 count : counts) {
      n.nodes += count;
    }
    n.depth = static_cast<double>(counts.size()) - 1.0;
    return n;
  }
  void prepare(const voxel_rays& from) override
  {
    this->rays.clear();
    for (const stratus_ray& r : from.rays) { // OpenVDB's rays must begin beyond 0, which is harmless: no measured ray begins inside a voxel
      this->rays.emplace_back(
        openvdb::Vec3d(r.origin), openvdb::Vec3d(r.direction), std::max(r.t_min, openvdb::math::Delta<double>::value()), 1e30);
    }
    this->found.assign(this->rays.size(), voxel_hit());
  }
  void trace() override
  {
    constexpr int level = mask_tree::RootNodeType::ChildNodeType::LEVEL;
    const openvdb::BBoxd bounds(this->box.min().asVec3d(), this->box.max().asVec3d() + openvdb::Vec3d(1.0));
    tester test(*this->tree);
    for (size_t i = 0; i < this->rays.size(); ++i) {
      index_ray r = this->rays[i];
      voxel_hit& hit = this->found[i];
      hit = voxel_hit();
      if (!r.clip(bounds)) {
        continue;
      }
      test.set_ray(r);
      if (openvdb::math::LevelSetHDDA<mask_tree, level>::test(test)) {
        hit.t = test.time;
        for (int a = 0; a < 3; ++a) {
          hit.voxel[a] = test.voxel[a];
        }
      }
    }
  }
  std::vector<voxel_hit> hits() const override { return this->found; }

private:
  const voxel_set& set;
  mask_tree::Ptr tree;
  openvdb::CoordBBox box;
  std::vector<index_ray> rays;
  std::vector<voxel_hit> found;
};
} // namespace

std::unique_ptr<first_hits> make_openvdb_hits(const voxel_set& set)
{
  openvdb::initialize();
  return std::make_unique<openvdb_hits>(set);
}
} // namespace bench
