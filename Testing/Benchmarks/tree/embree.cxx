// SPDX-License-Identifier: BSD-3-Clause
// Embree 3 or 4 on voxels as user geometry: one box per voxel, or one box per brick of 4^3 voxels whose bit mask is walked. The callbacks
// do as little as possible: reciprocals of the direction come with the ray, and only distance and primitive are written.
#include "tree_methods.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <atomic>
#include <cmath>
#include <cstring>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define WIDE_CLONES __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define WIDE_CLONES
#endif

namespace bench {

namespace {

constexpr int packet = 16, tile = 4; // a packet is a tile of 4 x 4 pixels

struct brick {
  uint64_t mask;
  int32_t at[3]; // in voxels
};

// The arguments of a query: Embree 4 needs arguments that name the context, Embree 3 the context itself.
#if RTC_VERSION_MAJOR >= 4
using query_context = RTCRayQueryContext;
class query
{
public:
  query(query_context* context, bool coherent)
  {
    rtcInitRayQueryContext(context);
    rtcInitIntersectArguments(&this->arguments);
    this->arguments.context = context;
    this->arguments.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
  }
  void one(RTCScene scene, RTCRayHit* ray) { rtcIntersect1(scene, ray, &this->arguments); }
  void sixteen(RTCScene scene, const int* valid, RTCRayHit16* rays) { rtcIntersect16(valid, scene, rays, &this->arguments); }

private:
  RTCIntersectArguments arguments;
};
#else
using query_context = RTCIntersectContext;
class query
{
public:
  query(query_context* from, bool coherent) : context(from)
  {
    rtcInitIntersectContext(from);
    from->flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  }
  void one(RTCScene scene, RTCRayHit* ray) { rtcIntersect1(scene, this->context, ray); }
  void sixteen(RTCScene scene, const int* valid, RTCRayHit16* rays) { rtcIntersect16(valid, scene, this->context, rays); }

private:
  query_context* context;
};
#endif

// Embree passes the context to the callbacks, so the members behind it carry what a callback needs.
struct ray_context {
  query_context head;
  float inverse[3];
  int32_t voxel; // bricks: the bit of the mask
};
struct packet_context {
  query_context head;
  float inverse[3][packet];
};

void voxel_bounds(const RTCBoundsFunctionArguments* a)
{
  const int32_t* p = static_cast<const int32_t*>(a->geometryUserPtr) + 3 * static_cast<size_t>(a->primID);
  RTCBounds* b = a->bounds_o;
  b->lower_x = static_cast<float>(p[0]);
  b->lower_y = static_cast<float>(p[1]);
  b->lower_z = static_cast<float>(p[2]);
  b->upper_x = static_cast<float>(p[0] + 1);
  b->upper_y = static_cast<float>(p[1] + 1);
  b->upper_z = static_cast<float>(p[2] + 1);
}

void voxel_hit_one(const RTCIntersectFunctionNArguments* a)
{
  const int32_t* p = static_cast<const int32_t*>(a->geometryUserPtr) + 3 * static_cast<size_t>(a->primID);
  const float* inverse = reinterpret_cast<const ray_context*>(a->context)->inverse;
  RTCRayHit* r = reinterpret_cast<RTCRayHit*>(a->rayhit);
  const float x0 = (static_cast<float>(p[0]) - r->ray.org_x) * inverse[0], x1 = (static_cast<float>(p[0] + 1) - r->ray.org_x) * inverse[0];
  const float y0 = (static_cast<float>(p[1]) - r->ray.org_y) * inverse[1], y1 = (static_cast<float>(p[1] + 1) - r->ray.org_y) * inverse[1];
  const float z0 = (static_cast<float>(p[2]) - r->ray.org_z) * inverse[2], z1 = (static_cast<float>(p[2] + 1) - r->ray.org_z) * inverse[2];
  const float from = std::max(std::max(std::min(x0, x1), std::min(y0, y1)), std::max(std::min(z0, z1), r->ray.tnear));
  const float to = std::min(std::min(std::max(x0, x1), std::max(y0, y1)), std::max(z0, z1));
  if (from <= to && from < r->ray.tfar) {
    r->ray.tfar = from;
    r->hit.primID = a->primID;
    r->hit.geomID = a->geomID;
  }
}

WIDE_CLONES void voxel_hit_packet(const RTCIntersectFunctionNArguments* a)
{
  const int32_t* p = static_cast<const int32_t*>(a->geometryUserPtr) + 3 * static_cast<size_t>(a->primID);
  const float x = static_cast<float>(p[0]), y = static_cast<float>(p[1]), z = static_cast<float>(p[2]);
  const packet_context* c = reinterpret_cast<const packet_context*>(a->context);
  RTCRayHit16* r = reinterpret_cast<RTCRayHit16*>(a->rayhit);
  const int* valid = a->valid;
  for (int i = 0; i < packet; ++i) {
    const float x0 = (x - r->ray.org_x[i]) * c->inverse[0][i], x1 = (x + 1.0f - r->ray.org_x[i]) * c->inverse[0][i];
    const float y0 = (y - r->ray.org_y[i]) * c->inverse[1][i], y1 = (y + 1.0f - r->ray.org_y[i]) * c->inverse[1][i];
    const float z0 = (z - r->ray.org_z[i]) * c->inverse[2][i], z1 = (z + 1.0f - r->ray.org_z[i]) * c->inverse[2][i];
    const float ax = x0 < x1 ? x0 : x1, bx = x0 < x1 ? x1 : x0, ay = y0 < y1 ? y0 : y1, by = y0 < y1 ? y1 : y0;
    const float az = z0 < z1 ? z0 : z1, bz = z0 < z1 ? z1 : z0;
    const float axy = ax > ay ? ax : ay, azn = az > r->ray.tnear[i] ? az : r->ray.tnear[i], bxy = bx < by ? bx : by;
    const float from = axy > azn ? axy : azn, to = bxy < bz ? bxy : bz;
    const bool hit = (valid[i] != 0) & (from <= to) & (from < r->ray.tfar[i]);
    r->ray.tfar[i] = hit ? from : r->ray.tfar[i];
    r->hit.primID[i] = hit ? a->primID : r->hit.primID[i];
    r->hit.geomID[i] = hit ? a->geomID : r->hit.geomID[i];
  }
}

void voxel_hit_any(const RTCIntersectFunctionNArguments* a)
{
  if (a->N == 1) {
    voxel_hit_one(a);
  } else {
    voxel_hit_packet(a);
  }
}

void brick_bounds(const RTCBoundsFunctionArguments* a)
{
  const brick* b = static_cast<const brick*>(a->geometryUserPtr) + a->primID;
  int lo[3] = { 4, 4, 4 }, hi[3] = { 0, 0, 0 };
  for (uint64_t m = b->mask; m; m &= m - 1) {
    const int bit = __builtin_ctzll(m), at[3] = { bit & 3, bit >> 2 & 3, bit >> 4 };
    for (int i = 0; i < 3; ++i) {
      lo[i] = std::min(lo[i], at[i]);
      hi[i] = std::max(hi[i], at[i] + 1);
    }
  }
  RTCBounds* o = a->bounds_o;
  o->lower_x = static_cast<float>(b->at[0] + lo[0]);
  o->lower_y = static_cast<float>(b->at[1] + lo[1]);
  o->lower_z = static_cast<float>(b->at[2] + lo[2]);
  o->upper_x = static_cast<float>(b->at[0] + hi[0]);
  o->upper_y = static_cast<float>(b->at[1] + hi[1]);
  o->upper_z = static_cast<float>(b->at[2] + hi[2]);
}

// Walks the brick from voxel to voxel, by the planes between them.
void brick_hit_one(const RTCIntersectFunctionNArguments* a)
{
  const brick* b = static_cast<const brick*>(a->geometryUserPtr) + a->primID;
  ray_context* c = reinterpret_cast<ray_context*>(a->context);
  RTCRayHit* r = reinterpret_cast<RTCRayHit*>(a->rayhit);
  const float origin[3] = { r->ray.org_x, r->ray.org_y, r->ray.org_z };
  float from = r->ray.tnear, to = r->ray.tfar, local[3];
  for (int i = 0; i < 3; ++i) {
    local[i] = static_cast<float>(b->at[i]) - origin[i];
    const float t0 = local[i] * c->inverse[i], t1 = (local[i] + 4.0f) * c->inverse[i];
    from = std::max(from, std::min(t0, t1));
    to = std::min(to, std::max(t0, t1));
  }
  if (!(from <= to)) {
    return;
  }
  static const int stride[3] = { 1, 4, 16 };
  int at[3], step[3], bit = 0;
  float next[3], delta[3];
  const float direction[3] = { r->ray.dir_x, r->ray.dir_y, r->ray.dir_z };
  for (int i = 0; i < 3; ++i) {
    const int place = static_cast<int>(std::floor(from * direction[i] - local[i]));
    at[i] = std::min(std::max(place, 0), 3);
    const bool up = c->inverse[i] > 0.0f;
    step[i] = up ? 1 : -1;
    next[i] = (local[i] + static_cast<float>(at[i] + up)) * c->inverse[i];
    delta[i] = std::fabs(c->inverse[i]);
    bit += at[i] * stride[i];
  }
  float t = from;
  while (!(b->mask >> bit & 1)) {
    const int axis = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    t = next[axis];
    at[axis] += step[axis];
    if (static_cast<unsigned>(at[axis]) > 3u || t > to) {
      return;
    }
    bit += step[axis] * stride[axis];
    next[axis] += delta[axis];
  }
  if (t < r->ray.tfar) {
    r->ray.tfar = t;
    r->hit.primID = a->primID;
    r->hit.geomID = a->geomID;
    c->voxel = bit;
  }
}

struct float_ray {
  float origin[3], direction[3], inverse[3];
};

// Returns the quality that a kind's last word names.
RTCBuildQuality quality_of(const std::string& kind)
{
  const std::string word = kind.substr(kind.rfind(':') + 1);
  return word == "low" ? RTC_BUILD_QUALITY_LOW : word == "high" ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM;
}

class embree_hits : public first_hits
{
public:
  embree_hits(const voxel_set& s, const std::string& kind)
      : set(s), bricks(kind.rfind("bricks", 0) == 0), packets(kind.rfind("packet", 0) == 0), quality(quality_of(kind))
  {
    this->device = rtcNewDevice("threads=2,user_threads=0");
    if (!this->device) {
      throw failure("Embree gives no device");
    }
    rtcSetDeviceMemoryMonitorFunction(
      this->device,
      [](void* user, ssize_t bytes, bool) {
        *static_cast<std::atomic<int64_t>*>(user) += bytes;
        return true;
      },
      &this->memory);
  }
  ~embree_hits() override
  {
    this->release();
    rtcReleaseDevice(this->device);
  }
  void build() override;
  tree_numbers numbers() const override
  {
    tree_numbers n;
    n.bytes = static_cast<double>(this->memory) + static_cast<double>(this->list.size() * sizeof(brick));
    return n;
  }
  void prepare(const voxel_rays& rays) override;
  void trace() override;
  std::vector<voxel_hit> hits() const override;

private:
  void release()
  {
    if (this->scene) {
      rtcReleaseScene(this->scene);
    }
    this->scene = nullptr;
  }
  void make_bricks();
  void trace_packets();

  const voxel_set& set;
  const bool bricks, packets;
  const RTCBuildQuality quality;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::atomic<int64_t> memory{ 0 };
  std::vector<brick> list;
  std::vector<float_ray> rays;
  std::vector<uint32_t> order; // packets: the ray of each lane
  std::vector<float> times;
  std::vector<uint32_t> primitives;
  std::vector<int32_t> bits;
  bool coherent = false;
};

// Makes bricks as Stratus does: sets bits in an array of masks, then lists the masks that are not empty.
void embree_hits::make_bricks()
{
  int64_t n[3];
  for (int a = 0; a < 3; ++a) {
    n[a] = (this->set.dimensions[a] + 3) / 4;
  }
  std::vector<uint64_t> masks(static_cast<size_t>(n[0] * n[1] * n[2]));
#pragma omp parallel for num_threads(2)
  for (size_t v = 0; v < this->set.count; ++v) {
    const int32_t* p = this->set.positions + 3 * v;
    const int64_t at = (p[2] / 4 * n[1] + p[1] / 4) * n[0] + p[0] / 4;
    const uint64_t bit = uint64_t(1) << ((p[2] % 4 * 4 + p[1] % 4) * 4 + p[0] % 4);
#pragma omp atomic
    masks[static_cast<size_t>(at)] |= bit;
  }
  this->list.clear();
  for (size_t b = 0; b < masks.size(); ++b) {
    if (masks[b]) {
      const int64_t i = static_cast<int64_t>(b) % n[0], j = static_cast<int64_t>(b) / n[0] % n[1],
                    k = static_cast<int64_t>(b) / n[0] / n[1];
      this->list.push_back({ masks[b], { static_cast<int32_t>(4 * i), static_cast<int32_t>(4 * j), static_cast<int32_t>(4 * k) } });
    }
  }
  this->list.shrink_to_fit();
}

void embree_hits::build()
{
  this->release();
  if (this->bricks) {
    this->make_bricks();
  }
  this->scene = rtcNewScene(this->device);
  rtcSetSceneBuildQuality(this->scene, this->quality);
  RTCGeometry geometry = rtcNewGeometry(this->device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(this->bricks ? this->list.size() : this->set.count));
  rtcSetGeometryUserData(geometry, this->bricks ? static_cast<void*>(this->list.data()) : const_cast<int32_t*>(this->set.positions));
  rtcSetGeometryBuildQuality(geometry, this->quality);
  rtcSetGeometryBoundsFunction(geometry, this->bricks ? brick_bounds : voxel_bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, this->bricks ? brick_hit_one : voxel_hit_any);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(this->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(this->scene);
  if (rtcGetDeviceError(this->device) != RTC_ERROR_NONE) {
    throw failure("Embree cannot build");
  }
}

void embree_hits::prepare(const voxel_rays& from)
{
  const size_t count = from.rays.size();
  this->coherent = from.coherent;
  this->rays.resize(count);
  this->times.assign(count, 0.0f);
  this->primitives.assign(count, 0);
  this->bits.assign(count, 0);
  for (size_t r = 0; r < count; ++r) {
    for (int a = 0; a < 3; ++a) {
      this->rays[r].origin[a] = static_cast<float>(from.rays[r].origin[a]);
      this->rays[r].direction[a] = static_cast<float>(from.rays[r].direction[a]);
      this->rays[r].inverse[a] = 1.0f / this->rays[r].direction[a];
    }
  }
  this->order = tile_order(from, tile);
}

void embree_hits::trace_packets()
{
  static const int all[packet] = { -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1 };
  packet_context context;
  query ask(&context.head, this->coherent);
  alignas(64) int valid[packet];
  std::memcpy(valid, all, sizeof valid);
  alignas(64) RTCRayHit16 p;
  std::memset(&p, 0, sizeof p);
  for (size_t first = 0; first + packet <= this->rays.size(); first += packet) {
    for (int i = 0; i < packet; ++i) {
      const float_ray& r = this->rays[this->order[first + static_cast<size_t>(i)]];
      p.ray.org_x[i] = r.origin[0];
      p.ray.org_y[i] = r.origin[1];
      p.ray.org_z[i] = r.origin[2];
      p.ray.dir_x[i] = r.direction[0];
      p.ray.dir_y[i] = r.direction[1];
      p.ray.dir_z[i] = r.direction[2];
      p.ray.tnear[i] = 0.0f;
      p.ray.tfar[i] = INFINITY;
      p.ray.mask[i] = ~0u;
      p.hit.primID[i] = p.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      for (int a = 0; a < 3; ++a) {
        context.inverse[a][i] = r.inverse[a];
      }
    }
    ask.sixteen(this->scene, valid, &p);
    for (int i = 0; i < packet; ++i) {
      this->times[this->order[first + static_cast<size_t>(i)]] = p.ray.tfar[i];
      this->primitives[this->order[first + static_cast<size_t>(i)]] = p.hit.primID[i];
    }
  }
}

void embree_hits::trace()
{
  if (this->packets) {
    this->trace_packets();
    return;
  }
  ray_context context;
  query ask(&context.head, this->coherent);
  for (size_t i = 0; i < this->rays.size(); ++i) {
    const float_ray& r = this->rays[i];
    RTCRayHit h;
    h.ray = { r.origin[0], r.origin[1], r.origin[2], 0.0f, r.direction[0], r.direction[1], r.direction[2], 0.0f, INFINITY, ~0u, 0, 0 };
    h.hit.primID = h.hit.geomID = h.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    std::memcpy(context.inverse, r.inverse, sizeof context.inverse);
    context.voxel = 0;
    ask.one(this->scene, &h);
    this->times[i] = h.ray.tfar;
    this->primitives[i] = h.hit.primID;
    this->bits[i] = context.voxel;
  }
}

std::vector<voxel_hit> embree_hits::hits() const
{
  std::vector<voxel_hit> result(this->rays.size());
  for (size_t i = 0; i < result.size(); ++i) {
    const uint32_t primitive = this->primitives[i];
    if (primitive == RTC_INVALID_GEOMETRY_ID) {
      continue;
    }
    result[i].t = static_cast<double>(this->times[i]);
    for (int a = 0; a < 3; ++a) {
      result[i].voxel[a] = this->bricks ? this->list[primitive].at[a] + (this->bits[i] >> 2 * a & 3)
                                        : this->set.positions[3 * static_cast<size_t>(primitive) + static_cast<size_t>(a)];
    }
  }
  return result;
}
} // namespace

std::unique_ptr<first_hits> make_embree_hits(const voxel_set& set, const std::string& kind)
{
  return std::make_unique<embree_hits>(set, kind);
}
} // namespace bench
