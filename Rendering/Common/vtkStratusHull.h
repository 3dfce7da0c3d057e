// SPDX-License-Identifier: BSD-3-Clause
// The convex region of the world in which a volume may show: a box of any orientation, cut by clipping planes. Finds which of two regions
// hides the other. Private to the modules.
#ifndef vtkStratusHull_h
#define vtkStratusHull_h

#include "vtkStratusPrivate.h"

#include <array>
#include <vector>

class VTK_STRATUS_PRIVATE vtkStratusHull
{
public:
  using Vector = std::array<double, 3>;
  // The points x with normal . x >= offset. The normal has length 1.
  struct HalfSpace {
    Vector Normal;
    double Offset;
  };
  // Where rays come from: the eye, or, in a parallel view, the direction of all rays.
  struct View {
    bool Parallel = false;
    Vector Eye = { 0.0, 0.0, 0.0 };
  };
  // APART: no ray meets both regions. BEHIND: each ray that meets both meets the other region first. BEFORE: it meets this region first.
  // OVERLAP: the regions have more in common than a border.
  enum Relation { APART, BEHIND, BEFORE, OVERLAP };

  // Sets the region to a box (xmin, xmax, ymin, ...) that an affine matrix moves to the world, within half-spaces of the world.
  void Set(const double box[6], const double matrix[16], const std::vector<HalfSpace>& within);
  bool IsEmpty() const { return this->Corners.empty(); }
  // An empty region is apart from all others.
  Relation Compare(const vtkStratusHull& other, const View& view) const;
  // Returns how far from the viewer the middle of the bounds is: a square of a distance, or a length along the rays.
  double GetDistance(const View& view) const;
  // An order of regions that depends on nothing but their corners.
  bool operator<(const vtkStratusHull& other) const { return this->Corners < other.Corners; }

private:
  void FindCorners(double length);
  void FindEdges(double length);
  void FindSpan(const Vector& axis, double span[2]) const;

  std::vector<HalfSpace> Sides;
  std::vector<Vector> Corners; // in lexicographic order
  std::vector<Vector> Edges;   // directions of length 1
  Vector Middle = { 0.0, 0.0, 0.0 };
  double Length = 0.0; // diagonal of the bounds
};

#endif
