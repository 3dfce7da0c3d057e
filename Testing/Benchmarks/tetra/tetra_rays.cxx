// SPDX-License-Identifier: BSD-3-Clause
// Finds which cells a ray meets, and where. Each cell is intersected with the rays of the pixels that its corners span, by the planes of
// its faces, in double precision. It uses no neighbours, no order and no code of the core, whose pictures and orders it judges.
#include "tetra_bench.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace bench {

namespace {

constexpr int tile = 8;                // pixels
constexpr double least_length = 1e-12; // relative to its position: shorter stretches may be rounding errors

using vector3 = std::array<double, 3>;

double dot(const vector3& a, const vector3& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

vector3 minus(const vector3& a, const vector3& b)
{
  return { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
}

vector3 cross(const vector3& a, const vector3& b)
{
  return { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
}

vector3 of(const double* p)
{
  return { p[0], p[1], p[2] };
}

// A cell as barycentric coordinates, linear in the position relative to the eye, and the pixels that it can cover.
struct prepared {
  double slope[4][3], start[4], value[4];
  int64_t cell;
  double box[4]; // in pixels: x from, to, y from, to
};

class picture_plane
{
public:
  picture_plane(const stratus_camera& camera, int size) : Camera(camera), Size(size)
  {
    const vector3 f = of(camera.forward), r = of(camera.right), u = of(camera.up);
    const double whole = dot(cross(r, u), f);
    const vector3 rows[3] = { cross(u, f), cross(f, r), cross(r, u) };
    for (int i = 0; i < 3; ++i) {
      for (int a = 0; a < 3; ++a) {
        this->Rows[i][static_cast<size_t>(a)] = rows[i][static_cast<size_t>(a)] / whole;
      }
    }
  }

  // Returns the coordinates along right, up and forward of a position relative to the eye.
  vector3 along(const vector3& p) const { return { dot(this->Rows[0], p), dot(this->Rows[1], p), dot(this->Rows[2], p) }; }

  // Finds the pixels that the corners span. Returns false if the cell is behind the eye or outside the window.
  bool box_of(const vector3 (&corners)[4], double box[4]) const
  {
    const double nearest = this->Camera.near_k;
    bool any = false;
    box[0] = box[2] = INFINITY;
    box[1] = box[3] = -INFINITY;
    const auto add = [&](double x, double y) {
      const double px = 0.5 * (x + 1.0) * this->Size - 0.5, py = 0.5 * (y + 1.0) * this->Size - 0.5;
      box[0] = std::min(box[0], px);
      box[1] = std::max(box[1], px);
      box[2] = std::min(box[2], py);
      box[3] = std::max(box[3], py);
      any = true;
    };
    for (int i = 0; i < 4; ++i) {
      if (this->Camera.parallel) {
        add(corners[i][0], corners[i][1]);
        continue;
      }
      // The least depth at which corners are projected. A cell that comes nearer is cut there.
      const double least = std::max(nearest, 1e-9 * std::abs(corners[0][2]) + 1e-300);
      if (corners[i][2] >= least) {
        add(corners[i][0] / corners[i][2], corners[i][1] / corners[i][2]);
      }
      for (int j = 0; j < i; ++j) {
        const double a = corners[i][2] - least, b = corners[j][2] - least;
        if ((a < 0.0) != (b < 0.0)) {
          const double t = a / (a - b);
          add((corners[i][0] + t * (corners[j][0] - corners[i][0])) / least, (corners[i][1] + t * (corners[j][1] - corners[i][1])) / least);
        }
      }
    }
    // A scattered ray may lie half a pixel off the pixel's centre. Rounding needs a little more.
    box[0] -= 0.51;
    box[1] += 0.51;
    box[2] -= 0.51;
    box[3] += 0.51;
    return any && box[1] >= 0.0 && box[3] >= 0.0 && box[0] <= this->Size - 1 && box[2] <= this->Size - 1;
  }

private:
  const stratus_camera& Camera;
  int Size;
  vector3 Rows[3];
};

vector3 corner(const stratus_mesh& mesh, const vector3& eye, int64_t cell, int v)
{
  return minus(of(mesh.points + 3 * static_cast<int64_t>(mesh.vertices[4 * cell + v])), eye);
}

// Returns false for a cell that is flat up to rounding, in which no ray lies.
bool prepare(const stratus_mesh& mesh, const vector3& eye, int64_t cell, prepared& p)
{
  vector3 q[4];
  for (int v = 0; v < 4; ++v) {
    q[v] = corner(mesh, eye, cell, v);
    p.value[v] = mesh.values ? static_cast<double>(static_cast<const float*>(mesh.values)[mesh.vertices[4 * cell + v]]) : 0.0;
  }
  for (int f = 0; f < 4; ++f) {
    const vector3 &a = q[(f + 1) % 4], u = minus(q[(f + 2) % 4], a), v = minus(q[(f + 3) % 4], a), normal = cross(u, v);
    const double inner = dot(normal, minus(q[f], a));
    if (std::abs(inner) <= 1e-12 * std::sqrt(dot(normal, normal) * dot(u, u))) {
      return false;
    }
    for (int i = 0; i < 3; ++i) {
      p.slope[f][i] = normal[static_cast<size_t>(i)] / inner;
    }
    p.start[f] = -dot(normal, a) / inner;
  }
  p.cell = cell;
  return true;
}

bool meet(const prepared& p, const vector3& origin, const vector3& direction, double nearest, double farthest, stretch& hit)
{
  double start[4], rise[4];
  hit.low = nearest;
  hit.high = farthest;
  for (int f = 0; f < 4; ++f) {
    const vector3 slope = { p.slope[f][0], p.slope[f][1], p.slope[f][2] };
    start[f] = p.start[f] + dot(slope, origin);
    rise[f] = dot(slope, direction);
    if (rise[f] > 0.0) {
      hit.low = std::max(hit.low, -start[f] / rise[f]);
    } else if (rise[f] < 0.0) {
      hit.high = std::min(hit.high, -start[f] / rise[f]);
    } else if (start[f] < 0.0) {
      return false;
    }
  }
  if (!(hit.high - hit.low > least_length * (std::abs(hit.low) + std::abs(hit.high)))) {
    return false;
  }
  hit.first = hit.last = 0.0;
  for (int f = 0; f < 4; ++f) {
    hit.first += p.value[f] * (start[f] + hit.low * rise[f]);
    hit.last += p.value[f] * (start[f] + hit.high * rise[f]);
  }
  const auto ends = std::minmax_element(p.value, p.value + 4); // in slivers, rounding may exceed them
  hit.first = std::min(std::max(hit.first, *ends.first), *ends.second);
  hit.last = std::min(std::max(hit.last, *ends.first), *ends.second);
  hit.cell = p.cell;
  return true;
}

// Hashes a number to 0..1.
double scattered_unit(uint32_t number)
{
  number = (number ^ 61u ^ (number >> 16)) * 9u;
  number = (number ^ (number >> 4)) * 0x27d4eb2du;
  return static_cast<double>((number ^ (number >> 15)) >> 8) / 16777216.0;
}

// The cells of each tile: where they begin, and their numbers.
struct bins {
  std::vector<size_t> begin;
  std::vector<int32_t> cells;
};

bins bin_cells(const stratus_mesh& mesh, const picture_plane& plane, const vector3& eye, int size)
{
  const int across = (size + tile - 1) / tile;
  std::vector<std::array<int16_t, 4>> spans(static_cast<size_t>(mesh.cell_count));
  bins b;
  b.begin.assign(static_cast<size_t>(across) * static_cast<size_t>(across) + 1, 0);
#pragma omp parallel for schedule(static, 4096)
  for (int64_t c = 0; c < mesh.cell_count; ++c) {
    vector3 q[4];
    double box[4];
    for (int v = 0; v < 4; ++v) {
      q[v] = plane.along(corner(mesh, eye, c, v));
    }
    spans[static_cast<size_t>(c)] = { 1, 0, 1, 0 };
    if (plane.box_of(q, box)) {
      for (int i = 0; i < 4; ++i) {
        const double at = std::floor(std::min(std::max(box[i], 0.0), size - 1.0) / tile);
        spans[static_cast<size_t>(c)][static_cast<size_t>(i)] = static_cast<int16_t>(at);
      }
    }
  }
  for (int pass = 0; pass < 2; ++pass) {
    for (int64_t c = 0; c < mesh.cell_count; ++c) {
      const auto& s = spans[static_cast<size_t>(c)];
      for (int y = s[2]; y <= s[3]; ++y) {
        for (int x = s[0]; x <= s[1]; ++x) {
          size_t& at = b.begin[static_cast<size_t>(y * across + x) + (pass == 0)];
          if (pass == 1) {
            b.cells[at] = static_cast<int32_t>(c);
          }
          ++at;
        }
      }
    }
    if (pass == 0) {
      for (size_t i = 1; i < b.begin.size(); ++i) {
        b.begin[i] += b.begin[i - 1];
      }
      b.cells.resize(b.begin.back());
    }
  }
  b.begin.insert(b.begin.begin(), 0); // each tile begins at the previous one's end
  return b;
}

void visit_tile(const std::vector<prepared>& cells, const stratus_camera& camera, int size, int at, bool scattered,
  const std::function<void(ray_of_pixel&)>& visit, ray_of_pixel& ray)
{
  const int across = (size + tile - 1) / tile;
  for (int i = 0; i < tile * tile; ++i) {
    const int x = at % across * tile + i % tile, y = at / across * tile + i / tile;
    if (x >= size || y >= size) {
      continue;
    }
    ray.pixel = y * size + x;
    const auto number = static_cast<uint32_t>(2 * ray.pixel);
    const double px = x + (scattered ? scattered_unit(number) - 0.5 : 0.0), py = y + (scattered ? scattered_unit(number + 1) - 0.5 : 0.0);
    const double u = (2.0 * px + 1.0) / size - 1.0, v = (2.0 * py + 1.0) / size - 1.0;
    vector3 origin = { 0, 0, 0 }, direction;
    for (size_t a = 0; a < 3; ++a) {
      const double side = u * camera.right[a] + v * camera.up[a];
      origin[a] = camera.parallel ? side : 0.0;
      direction[a] = camera.forward[a] + (camera.parallel ? 0.0 : side);
    }
    ray.length = std::sqrt(dot(direction, direction));
    ray.stretches.clear();
    for (const prepared& p : cells) {
      stretch hit;
      if (px >= p.box[0] && px <= p.box[1] && py >= p.box[2] && py <= p.box[3] &&
        meet(p, origin, direction, camera.near_k, camera.far_k, hit)) {
        ray.stretches.push_back(hit);
      }
    }
    std::sort(
      ray.stretches.begin(), ray.stretches.end(), [](const stretch& p, const stretch& q) { return p.low + p.high < q.low + q.high; });
    visit(ray);
  }
}
} // namespace

void visit_rays(
  const stratus_mesh& mesh, const stratus_camera& camera, int size, bool scattered, const std::function<void(ray_of_pixel&)>& visit)
{
  const vector3 eye = of(camera.eye);
  const picture_plane plane(camera, size);
  const bins b = bin_cells(mesh, plane, eye, size);
  const int across = (size + tile - 1) / tile;
#pragma omp parallel
  {
    ray_of_pixel ray;
    std::vector<prepared> cells;
#pragma omp for schedule(dynamic, 1)
    for (int at = 0; at < across * across; ++at) {
      cells.clear();
      for (size_t i = b.begin[static_cast<size_t>(at)]; i < b.begin[static_cast<size_t>(at) + 1]; ++i) {
        prepared p;
        vector3 q[4];
        if (prepare(mesh, eye, b.cells[i], p)) {
          for (int v = 0; v < 4; ++v) {
            q[v] = plane.along(corner(mesh, eye, b.cells[i], v));
          }
          plane.box_of(q, p.box);
          cells.push_back(p);
        }
      }
      visit_tile(cells, camera, size, at, scattered, visit, ray);
    }
  }
}
} // namespace bench
