// SPDX-License-Identifier: BSD-3-Clause
// Finds which boxes a frustum truly meets, by clipping their faces against its planes. It shares no code with the methods that it judges.
#include "octree_bench.h"

#include <algorithm>

namespace bench {

namespace {

using point = std::array<double, 3>;

double value_of(const double plane[4], const point& p)
{
  return plane[0] * p[0] + plane[1] * p[1] + plane[2] * p[2] + plane[3];
}

// Clips a polygon (Sutherland and Hodgman).
std::vector<point> cut(const std::vector<point>& face, const double plane[4], double room)
{
  std::vector<point> kept;
  for (size_t i = 0; i < face.size(); ++i) {
    const point &p = face[i], &q = face[(i + 1) % face.size()];
    const double s = value_of(plane, p) + room, t = value_of(plane, q) + room;
    if (s >= 0.0) {
      kept.push_back(p);
    }
    if ((s >= 0.0) != (t >= 0.0)) {
      const double f = s / (s - t);
      kept.push_back({ p[0] + f * (q[0] - p[0]), p[1] + f * (q[1] - p[1]), p[2] + f * (q[2] - p[2]) });
    }
  }
  return kept;
}

point corner(const box_bounds& box, unsigned number)
{
  return { box[number & 1], box[2 + (number >> 1 & 1)], box[4 + (number >> 2)] };
}

// room: how far outside a box still counts; negative: how far inside it must reach.
bool meets(const box_bounds& box, const stratus_frustum& frustum, const point& inside, double room)
{
  bool all = true;
  for (const double* plane :
    { frustum.planes[0], frustum.planes[1], frustum.planes[2], frustum.planes[3], frustum.planes[4], frustum.planes[5] }) {
    bool any = false;
    for (unsigned c = 0; c < 8; ++c) {
      const bool in = value_of(plane, corner(box, c)) + room >= 0.0;
      any = any || in;
      all = all && in;
    }
    if (!any) {
      return false;
    }
  }
  const auto holds = [&](size_t a) { return inside[a] >= box[2 * a] - room && inside[a] <= box[2 * a + 1] + room; };
  if (all || (holds(0) && holds(1) && holds(2))) {
    return true;
  }
  static const unsigned faces[6][4] = { { 0, 2, 6, 4 }, { 1, 3, 7, 5 }, { 0, 1, 5, 4 }, { 2, 3, 7, 6 }, { 0, 1, 3, 2 }, { 4, 5, 7, 6 } };
  for (const auto& numbers : faces) {
    std::vector<point> face;
    for (const unsigned number : numbers) {
      face.push_back(corner(box, number));
    }
    for (int p = 0; p < 6 && !face.empty(); ++p) {
      face = cut(face, frustum.planes[p], room);
    }
    if (!face.empty()) {
      return true;
    }
  }
  return false;
}
} // namespace

verdict judge_culling(
  const std::vector<box_bounds>& boxes, const stratus_frustum& frustum, const stratus_camera& camera, const uint32_t* ids, size_t count)
{
  // Exceeds the rounding of coordinates up to 1000.
  constexpr double room = 1e-9;
  point inside;
  for (size_t a = 0; a < 3; ++a) {
    inside[a] = camera.eye[a] + (camera.near_k + 1.0) * camera.forward[a];
  }
  std::vector<char> kept(boxes.size(), 0);
  for (size_t i = 0; i < count; ++i) {
    kept[ids[i]] = 1;
  }
  verdict v;
  for (size_t i = 0; i < boxes.size(); ++i) {
    v.kept += kept[i] != 0;
    v.wrong_culls += !kept[i] && meets(boxes[i], frustum, inside, -room);
    v.false_keeps += kept[i] && !meets(boxes[i], frustum, inside, room);
  }
  return v;
}
} // namespace bench
