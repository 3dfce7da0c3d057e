// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusHull.h"

#include <algorithm>
#include <cmath>

namespace {
using Vector = vtkStratusHull::Vector;

// Regions that share less than this part of their length only touch: neighbouring grids may differ by rounding of floats.
constexpr double TOUCHING = 1e-6;
// Rounding of corners and directions, relative to the lengths that they are computed from.
constexpr double ROUNDING = 1e-9;

double Dot(const Vector& a, const Vector& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vector Cross(const Vector& a, const Vector& b)
{
  return { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
}

Vector Axis(int a)
{
  return { a == 0 ? 1.0 : 0.0, a == 1 ? 1.0 : 0.0, a == 2 ? 1.0 : 0.0 };
}

// Scales a vector to length 1. Returns false if it has no direction.
bool Normalize(Vector& a)
{
  const double length = std::sqrt(Dot(a, a));
  if (!(length > ROUNDING)) {
    return false;
  }
  for (double& value : a) {
    value /= length;
  }
  return true;
}

// Finds the point of three planes. Returns false if two of them are parallel.
bool Intersect(const vtkStratusHull::HalfSpace* const planes[3], Vector& point)
{
  const Vector crosses[3] = { Cross(planes[1]->Normal, planes[2]->Normal), Cross(planes[2]->Normal, planes[0]->Normal),
    Cross(planes[0]->Normal, planes[1]->Normal) };
  const double determinant = Dot(planes[0]->Normal, crosses[0]);
  if (std::fabs(determinant) < ROUNDING) {
    return false;
  }
  for (int a = 0; a < 3; ++a) {
    point[a] = (planes[0]->Offset * crosses[0][a] + planes[1]->Offset * crosses[1][a] + planes[2]->Offset * crosses[2][a]) / determinant;
  }
  return true;
}
} // namespace

void vtkStratusHull::Set(const double box[6], const double matrix[16], const std::vector<HalfSpace>& within)
{
  this->Sides.clear();
  this->Corners.clear();
  this->Edges.clear();
  for (int corner = 0; corner < 8; ++corner) {
    Vector world;
    for (int row = 0; row < 3; ++row) {
      const double* m = matrix + 4 * row;
      world[row] = m[0] * box[corner & 1] + m[1] * box[2 + (corner >> 1 & 1)] + m[2] * box[4 + (corner >> 2)] + m[3];
    }
    this->Corners.push_back(world);
  }
  Vector columns[3];
  bool flat = false;
  for (int a = 0; a < 3; ++a) {
    columns[a] = { matrix[a], matrix[4 + a], matrix[8 + a] };
    flat = !Normalize(columns[a]) || flat;
  }
  for (int a = 0; a < 3; ++a) {
    Vector normal = Cross(columns[(a + 1) % 3], columns[(a + 2) % 3]);
    if (flat || !Normalize(normal)) { // the matrix makes a box flat: its bounds are taken
      normal = Axis(a);
    }
    double span[2];
    this->FindSpan(normal, span);
    this->Sides.push_back({ normal, span[0] });
    this->Sides.push_back({ { -normal[0], -normal[1], -normal[2] }, -span[1] });
  }
  const double length = std::sqrt(std::pow(this->Corners[7][0] - this->Corners[0][0], 2) +
    std::pow(this->Corners[7][1] - this->Corners[0][1], 2) + std::pow(this->Corners[7][2] - this->Corners[0][2], 2));
  if (!within.empty()) {
    this->Sides.insert(this->Sides.end(), within.begin(), within.end());
    this->FindCorners(length);
  }
  this->FindEdges(length);
  std::sort(this->Corners.begin(), this->Corners.end());
  this->Length = 0.0;
  for (int a = 0; a < 3; ++a) {
    double span[2];
    this->FindSpan(Axis(a), span);
    this->Middle[a] = 0.5 * (span[0] + span[1]);
    this->Length = this->IsEmpty() ? 0.0 : std::hypot(this->Length, span[1] - span[0]);
  }
}

// Finds the corners of the half-spaces' intersection: the points of three planes that are in all half-spaces. There are at most a dozen
// planes. Coordinates are relative to the box, which may be far from the origin.
void vtkStratusHull::FindCorners(double length)
{
  const Vector origin = this->Corners[0];
  std::vector<HalfSpace> sides = this->Sides;
  for (HalfSpace& side : sides) {
    side.Offset -= Dot(side.Normal, origin);
  }
  this->Corners.clear();
  for (size_t i = 0; i < sides.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      for (size_t k = 0; k < j; ++k) {
        const HalfSpace* const planes[3] = { &sides[i], &sides[j], &sides[k] };
        Vector point;
        if (Intersect(planes, point) && std::all_of(sides.begin(), sides.end(), [&](const HalfSpace& side) {
              return Dot(side.Normal, point) >= side.Offset - ROUNDING * length;
            })) {
          this->Corners.push_back({ point[0] + origin[0], point[1] + origin[1], point[2] + origin[2] });
        }
      }
    }
  }
}

// Finds the directions in which two sides meet along an edge of the region, once each.
void vtkStratusHull::FindEdges(double length)
{
  const auto isOn = [&](const HalfSpace& side, const Vector& corner) {
    return std::fabs(Dot(side.Normal, corner) - side.Offset) <= TOUCHING * length;
  };
  for (size_t i = 0; i < this->Sides.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      Vector edge = Cross(this->Sides[i].Normal, this->Sides[j].Normal);
      const auto common = std::count_if(this->Corners.begin(), this->Corners.end(),
        [&](const Vector& corner) { return isOn(this->Sides[i], corner) && isOn(this->Sides[j], corner); });
      const auto isSame = [&](const Vector& other) { return std::fabs(Dot(edge, other)) > 1.0 - ROUNDING; };
      if (common > 1 && Normalize(edge) && std::none_of(this->Edges.begin(), this->Edges.end(), isSame)) {
        this->Edges.push_back(edge);
      }
    }
  }
}

void vtkStratusHull::FindSpan(const Vector& axis, double span[2]) const
{
  span[0] = span[1] = this->IsEmpty() ? 0.0 : Dot(axis, this->Corners[0]);
  for (const Vector& corner : this->Corners) {
    const double at = Dot(axis, corner);
    span[0] = std::min(span[0], at);
    span[1] = std::max(span[1], at);
  }
}

double vtkStratusHull::GetDistance(const View& view) const
{
  if (view.Parallel) {
    return Dot(this->Middle, view.Eye);
  }
  const Vector way = { this->Middle[0] - view.Eye[0], this->Middle[1] - view.Eye[1], this->Middle[2] - view.Eye[2] };
  return Dot(way, way);
}

// Two convex regions are apart if and only if a plane separates them that is parallel to a side of one, or to an edge of each. A ray can
// cross the plane in one direction only. If two planes give opposite answers, no ray meets both regions.
vtkStratusHull::Relation vtkStratusHull::Compare(const vtkStratusHull& other, const View& view) const
{
  if (this->IsEmpty() || other.IsEmpty()) {
    return APART;
  }
  const double touching = TOUCHING * std::max(this->Length, other.Length);
  bool separated = false, before = false, behind = false;
  const auto look = [&](const Vector& axis) {
    double mine[2], its[2];
    this->FindSpan(axis, mine);
    other.FindSpan(axis, its);
    const bool below = mine[1] <= its[0] + touching;
    if (!below && its[1] > mine[0] + touching) {
      return;
    }
    separated = true;
    const double low = below ? mine[1] : its[1], high = below ? its[0] : mine[0], eye = Dot(axis, view.Eye);
    const bool up = view.Parallel ? eye > ROUNDING : eye < std::min(low, high); // the region below is met first
    const bool down = view.Parallel ? eye < -ROUNDING : eye > std::max(low, high);
    before = before || (below ? up : down);
    behind = behind || (below ? down : up);
  };
  for (int a = 0; a < 3; ++a) {
    look(Axis(a));
  }
  // Each stage looks at all its planes, so that the answer is the opposite one from the other region's view.
  if (!separated) {
    for (const vtkStratusHull* of : { this, &other }) {
      for (const HalfSpace& side : of->Sides) {
        look(side.Normal);
      }
    }
  }
  const size_t edges = separated ? 0 : this->Edges.size();
  for (size_t i = 0; i < edges; ++i) {
    for (const Vector& edge : other.Edges) {
      Vector axis = Cross(this->Edges[i], edge);
      if (Normalize(axis)) {
        look(axis);
      }
    }
  }
  return !separated ? OVERLAP : before == behind ? APART : before ? BEFORE : BEHIND;
}
