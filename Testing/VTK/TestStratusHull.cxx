// SPDX-License-Identifier: BSD-3-Clause
// Which of two regions hides the other, against rays through random points of both, and whether they overlap, against a point in both that
// projections onto half-spaces find.
#include "mapper_testing.h"
#include "vtkStratusHull.h"

#include "vtkMinimalStandardRandomSequence.h"
#include "vtkTransform.h"

namespace {
using Hull = vtkStratusHull;
using Vector = vtkStratusHull::Vector;

vtkNew<vtkMinimalStandardRandomSequence> Random;

double Any(double low, double high)
{
  Random->Next();
  return Random->GetRangeValue(low, high);
}

// A region as half-spaces, which this test finds itself.
struct Region {
  // Planes may leave nothing of the region, so that the number of points in it is not known in advance.
  Region(bool turned, int planes)
  {
    const double box[6] = { Any(-2, 0), Any(0.1, 2), Any(-2, 0), Any(0.1, 2), Any(-2, 0), Any(0.1, 2) };
    this->Move->Translate(Any(-3, 3), Any(-3, 3), Any(-3, 3));
    if (turned) {
      this->Move->RotateWXYZ(Any(0, 360), Any(-1, 1), Any(-1, 1), Any(-1, 1));
      this->Move->Scale(Any(0.3, 2), Any(0.3, 2), -Any(0.3, 2));
    }
    std::vector<Hull::HalfSpace> within;
    for (int p = 0; p < planes; ++p) {
      Vector normal = { Any(-1, 1), Any(-1, 1), Any(-1, 1) };
      vtkMath::Normalize(normal.data());
      double middle[3] = { 0.5 * (box[0] + box[1]), 0.5 * (box[2] + box[3]), 0.5 * (box[4] + box[5]) };
      this->Move->TransformPoint(middle, middle);
      within.push_back({ normal, vtkMath::Dot(normal.data(), middle) + Any(-1, 0.5) });
    }
    std::copy_n(box, 6, this->Box);
    this->Within = within;
    this->Shape.Set(box, this->Move->GetMatrix()->GetData(), within);
    this->Back->DeepCopy(this->Move->GetMatrix());
    this->Back->Invert();
  }

  // How deep a point is inside, about; negative outside.
  double Depth(const Vector& point) const
  {
    double local[4] = { point[0], point[1], point[2], 1.0 }, depth = 1e30;
    this->Back->MultiplyPoint(local, local);
    for (int a = 0; a < 3; ++a) {
      depth = std::min({ depth, local[a] - this->Box[2 * a], this->Box[2 * a + 1] - local[a] });
    }
    for (const Hull::HalfSpace& half : this->Within) {
      depth = std::min(depth, vtkMath::Dot(half.Normal.data(), point.data()) - half.Offset);
    }
    return depth;
  }

  Vector Somewhere() const
  {
    double point[3] = { Any(this->Box[0], this->Box[1]), Any(this->Box[2], this->Box[3]), Any(this->Box[4], this->Box[5]) };
    this->Move->TransformPoint(point, point);
    return { point[0], point[1], point[2] };
  }

  double Box[6];
  vtkNew<vtkTransform> Move;
  vtkNew<vtkMatrix4x4> Back;
  std::vector<Hull::HalfSpace> Within;
  Hull Shape;
};

// The first and last place on a ray, of many, that is inside; first > last: none is.
void March(const Region& region, const Vector& from, const Vector& way, double found[2])
{
  found[0] = 1e30;
  found[1] = -1e30;
  for (int step = 0; step < 400; ++step) {
    const double k = 0.03 * step;
    if (region.Depth({ from[0] + k * way[0], from[1] + k * way[1], from[2] + k * way[2] }) > 0.0) {
      found[0] = std::min(found[0], k);
      found[1] = k;
    }
  }
}

void Pairs(bool turned, int planes)
{
  int counts[4] = { 0, 0, 0, 0 }, crossed = 0;
  for (int pair = 0; pair < 150; ++pair) {
    const Region a(turned, planes), b(turned, planes);
    Hull::View view;
    view.Parallel = pair % 2 == 1;
    view.Eye = { Any(-6, 6), Any(-6, 6), Any(-6, 6) };
    if (view.Parallel) {
      vtkMath::Normalize(view.Eye.data());
    }
    const Hull::Relation relation = a.Shape.Compare(b.Shape, view), reverse = b.Shape.Compare(a.Shape, view);
    ++counts[relation];
    const bool mirrored = relation == Hull::BEHIND ? reverse == Hull::BEFORE
      : relation == Hull::BEFORE                   ? reverse == Hull::BEHIND
                                                   : reverse == relation;
    CHECK(mirrored, "pair %d: %d one way, %d the other", pair, relation, reverse);
    double deepest = -1.0;
    for (int ray = 0; ray < 60; ++ray) {
      const Vector to = (ray % 2 ? a : b).Somewhere();
      deepest = std::max(deepest, std::min(a.Depth(to), b.Depth(to)));
      if (relation == Hull::OVERLAP || std::min(a.Depth(to), b.Depth(to)) > 0.0) {
        continue;
      }
      Vector from = view.Eye, way;
      for (int axis = 0; axis < 3; ++axis) {
        from[axis] = view.Parallel ? to[axis] - 6.0 * view.Eye[axis] : view.Eye[axis];
        way[axis] = to[axis] - from[axis];
      }
      vtkMath::Normalize(way.data());
      double first[2], second[2];
      March(a, from, way, first);
      March(b, from, way, second);
      if (first[0] <= first[1] && second[0] <= second[1]) {
        ++crossed;
        CHECK(relation == (first[1] < second[0] ? Hull::BEFORE : Hull::BEHIND),
          "pair %d: a ray is in one at %g to %g, in the other at %g to %g", pair, first[0], first[1], second[0], second[1]);
      }
    }
    CHECK(deepest < 1e-3 || relation == Hull::OVERLAP, "pair %d: a point is %g deep in both, and they are taken for apart", pair, deepest);
    if (relation == Hull::OVERLAP) { // projections onto half-spaces one after the other reach a point of both, if there is one
      Vector point = a.Somewhere();
      for (int turn = 0; turn < 4000 && std::min(a.Depth(point), b.Depth(point)) < -1e-6; ++turn) {
        for (const Region* region : { &a, &b }) {
          std::vector<Hull::HalfSpace> sides = region->Within;
          for (int side = 0; side < 6; ++side) { // rows of the inverse are normals
            const double sign = side % 2 ? -1.0 : 1.0, *row = region->Back->GetData() + 4 * (side / 2);
            const double length = vtkMath::Norm(row);
            sides.push_back(
              { { sign * row[0] / length, sign * row[1] / length, sign * row[2] / length }, sign * (region->Box[side] - row[3]) / length });
          }
          for (const Hull::HalfSpace& side : sides) {
            const double lacking = side.Offset - vtkMath::Dot(side.Normal.data(), point.data());
            for (int axis = 0; axis < 3; ++axis) {
              point[axis] += std::max(0.0, lacking) * side.Normal[axis];
            }
          }
        }
      }
      const double depth = std::min(a.Depth(point), b.Depth(point));
      CHECK(depth > -1e-3, "pair %d: taken for overlapping, but no common point is found: %g", pair, depth);
    }
  }
  CHECK(counts[Hull::BEHIND] > 5 && counts[Hull::BEFORE] > 5 && counts[Hull::OVERLAP] > 5 && crossed > 100,
    "cases: %d apart, %d behind, %d before, %d overlap, %d rays through both", counts[0], counts[1], counts[2], counts[3], crossed);
}

// Regions that touch do not overlap, near the origin and far away. Of a box, planes may leave nothing, or a sheet.
void Borders()
{
  for (double far : { 0.0, 6e6 }) {
    const double left[6] = { far, far + 1, 0, 1, 0, 1 }, right[6] = { far + 1, far + 2, 0.5, 2, 0, 1 };
    vtkNew<vtkMatrix4x4> identity;
    Hull a, b, c;
    Hull::View view;
    view.Eye = { far - 5, 0.5, 0.5 };
    a.Set(left, identity->GetData(), {});
    b.Set(right, identity->GetData(), {});
    CHECK(a.Compare(b, view) == Hull::BEFORE && b.Compare(a, view) == Hull::BEHIND, "boxes that touch at %g", far);
    view.Eye[0] = far + 9;
    CHECK(a.Compare(b, view) == Hull::BEHIND, "boxes that touch, from the other side, at %g", far);
    view.Parallel = true;
    view.Eye = { 0, 1, 0 };
    CHECK(a.Compare(b, view) == Hull::APART, "a view along the common side at %g", far);
    const Hull::HalfSpace beyond = { { 1, 0, 0 }, far + 0.5 }, before = { { -1, 0, 0 }, -far - 0.5 };
    view.Eye = { 1, 0, 0 };
    a.Set(left, identity->GetData(), { beyond });
    c.Set(left, identity->GetData(), { before });
    CHECK(c.Compare(a, view) == Hull::BEFORE, "two halves of a box at %g", far);
    a.Set(left, identity->GetData(), { { { 1, 0, 0 }, far + 2 } });
    CHECK(a.IsEmpty() && a.Compare(b, view) == Hull::APART, "a box that is cut away at %g", far);
  }
}
} // namespace

int main()
{
  Random->SetSeed(7);
  Pairs(false, 0);
  Pairs(true, 0);
  Pairs(true, 2);
  Borders();
  std::printf("%d failures\n", Failures);
  return Failures != 0;
}
