// SPDX-License-Identifier: BSD-3-Clause
// Rays through tetrahedra, in each of which a field of points is linear and one of cells is even.
#include "vtkStratusPickRay.h"

#include "vtkStratusTetrahedra.h"

#include "vtkCell.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkPoints.h"
#include "vtkStructuredGrid.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace {
using Corners = std::array<const double*, 4>;

double Determinant(const double a[3], const double b[3], const double c[3])
{
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

// The weights of the corners at a point; false for a tetrahedron without volume.
bool WeightsAt(const Corners& p, const double x[3], double weights[4])
{
  double edges[3][3], to[3];
  for (int a = 0; a < 3; ++a) {
    for (int e = 0; e < 3; ++e) {
      edges[e][a] = p[static_cast<size_t>(e) + 1][a] - p[0][a];
    }
    to[a] = x[a] - p[0][a];
  }
  const double volume = Determinant(edges[0], edges[1], edges[2]);
  weights[1] = Determinant(to, edges[1], edges[2]) / volume;
  weights[2] = Determinant(edges[0], to, edges[2]) / volume;
  weights[3] = Determinant(edges[0], edges[1], to) / volume;
  weights[0] = 1.0 - weights[1] - weights[2] - weights[3];
  return volume != 0.0 && std::isfinite(weights[0]);
}

// Looks for a nearer hit in a tetrahedron with values at its corners.
bool PickIn(const vtkStratusPickRay& ray, const Corners& p, const double values[4], vtkStratusPickHit& hit)
{
  double first[4], last[4], begin = ray.Begin, end = std::min(ray.End, hit.T);
  if (!WeightsAt(p, ray.P1, first) || !WeightsAt(p, ray.P2, last)) {
    return false;
  }
  double from = 0.0, to = 0.0;
  for (int i = 0; i < 4; ++i) {
    const double along = last[i] - first[i];
    if (along != 0.0) {
      const double t = -first[i] / along;
      (along > 0.0 ? begin : end) = along > 0.0 ? std::max(begin, t) : std::min(end, t);
    } else if (first[i] < 0.0) {
      return false;
    }
    from += first[i] * values[i];
    to += last[i] * values[i];
  }
  double t = 0.0;
  if (!(begin < end) ||
    !ray.FindInPiece(
      begin, end, [&](double at) { return from + at * (to - from); }, t) ||
    !(t < hit.T)) {
    return false;
  }
  hit.T = t;
  double x[3], origin[4], moved[4];
  for (int a = 0; a < 3; ++a) {
    x[a] = p[0][a];
  }
  WeightsAt(p, x, origin);
  for (int a = 0; a < 3; ++a) { // the weights are linear, so that a step of 1 gives their slopes
    x[a] += 1.0;
    WeightsAt(p, x, moved);
    x[a] -= 1.0;
    hit.Gradient[a] = 0.0;
    for (int i = 0; i < 4; ++i) {
      hit.Gradient[a] += (moved[i] - origin[i]) * values[i];
    }
  }
  return true;
}

// The planes of a crop box cut the ray; false where nothing is left.
bool CropRay(const vtkStratusPickRay& ray, vtkStratusPickRay& cropped)
{
  cropped = ray;
  for (int a = 0; ray.CropPlanes && a < 3; ++a) {
    const double along = ray.P2[a] - ray.P1[a];
    const double one = (ray.CropPlanes[2 * a] - ray.P1[a]) / along, other = (ray.CropPlanes[2 * a + 1] - ray.P1[a]) / along;
    if (along != 0.0) {
      cropped.Begin = std::max(cropped.Begin, std::min(one, other));
      cropped.End = std::min(cropped.End, std::max(one, other));
    } else if (ray.P1[a] < ray.CropPlanes[2 * a] || ray.P1[a] > ray.CropPlanes[2 * a + 1]) {
      return false;
    }
  }
  return cropped.Begin <= cropped.End;
}

bool IsHidden(vtkDataSet* grid, vtkIdType cell)
{
  vtkUnsignedCharArray* const cells = grid->GetCellGhostArray();
  vtkUnsignedCharArray* const points = grid->GetPointGhostArray();
  bool hidden = cells && (cells->GetValue(cell) & vtkDataSetAttributes::HIDDENCELL) != 0;
  if (points && !hidden) {
    vtkIdList* ids = grid->GetCell(cell)->GetPointIds();
    for (vtkIdType i = 0; i < ids->GetNumberOfIds() && !hidden; ++i) {
      hidden = (points->GetValue(ids->GetId(i)) & vtkDataSetAttributes::HIDDENPOINT) != 0;
    }
  }
  return hidden;
}

// Finds the nearest point and the place in the cell that was hit.
void FillCell(const vtkStratusPickRay& ray, vtkDataSet* grid, vtkStratusPickHit& hit)
{
  double x[3], near[3], distance, best = VTK_DOUBLE_MAX;
  int sub = 0;
  for (int a = 0; a < 3; ++a) {
    x[a] = ray.P1[a] + hit.T * (ray.P2[a] - ray.P1[a]);
  }
  vtkCell* cell = grid->GetCell(hit.Cell);
  std::vector<double> weights(static_cast<size_t>(std::max(cell->GetNumberOfPoints(), vtkIdType(1))));
  cell->EvaluatePosition(x, near, sub, hit.PCoords, distance, weights.data());
  for (vtkIdType i = 0; i < cell->GetNumberOfPoints(); ++i) {
    double p[3];
    grid->GetPoint(cell->GetPointId(i), p);
    const double squared = (p[0] - x[0]) * (p[0] - x[0]) + (p[1] - x[1]) * (p[1] - x[1]) + (p[2] - x[2]) * (p[2] - x[2]);
    if (squared < best) {
      best = squared;
      hit.Point = cell->GetPointId(i);
    }
  }
}
} // namespace

bool vtkStratusPickTetrahedra(
  const vtkStratusPickRay& whole, vtkDataSet* grid, const vtkStratusTetrahedra& parts, vtkDataArray* pointValues, vtkStratusPickHit& hit)
{
  vtkStratusPickRay ray;
  if (!CropRay(whole, ray)) {
    return false;
  }
  bool found = false;
  for (size_t part = 0; part < parts.Cells.size(); ++part) {
    Corners corners;
    double values[4];
    const vtkIdType cell = parts.Cells[part];
    for (size_t i = 0; i < 4; ++i) {
      const auto vertex = static_cast<size_t>(parts.Vertices[4 * part + i]);
      corners[i] = &parts.Points[3 * vertex];
      values[i] = ray.OfCells ? ray.Value(cell) : pointValues->GetComponent(static_cast<vtkIdType>(vertex), 0);
    }
    vtkStratusPickHit nearer = hit;
    if (PickIn(ray, corners, values, nearer) && !IsHidden(grid, cell)) {
      hit = nearer;
      hit.Cell = cell;
      found = true;
    }
  }
  if (found) {
    FillCell(whole, grid, hit);
  }
  return found;
}

// A hexahedron is six tetrahedra, one for each path along edges from the first corner to the last, as the mapper divides it.
bool vtkStratusPickStructured(const vtkStratusPickRay& whole, vtkStructuredGrid* grid, vtkStratusPickHit& hit)
{
  constexpr int ways[6][2] = { { 1, 2 }, { 1, 4 }, { 2, 1 }, { 2, 4 }, { 4, 1 }, { 4, 2 } }; // axes as bits: the first step, the second
  vtkStratusPickRay ray;
  int n[3];
  grid->GetDimensions(n);
  if (!CropRay(whole, ray) || n[0] < 2 || n[1] < 2 || n[2] < 2) {
    return false;
  }
  bool found = false;
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell) {
    const vtkIdType i = cell % (n[0] - 1), j = cell / (n[0] - 1) % (n[1] - 1), k = cell / (static_cast<vtkIdType>(n[0] - 1) * (n[1] - 1));
    double points[8][3], values[8];
    for (int corner = 0; corner < 8; ++corner) {
      const vtkIdType point = i + (corner & 1) + n[0] * (j + (corner >> 1 & 1) + static_cast<vtkIdType>(n[1]) * (k + (corner >> 2 & 1)));
      grid->GetPoint(point, points[corner]);
      values[corner] = ray.Value(ray.OfCells ? cell : point);
    }
    for (const auto& way : ways) {
      const int corners[4] = { 0, way[0], way[0] | way[1], 7 };
      const double four[4] = { values[corners[0]], values[corners[1]], values[corners[2]], values[corners[3]] };
      vtkStratusPickHit nearer = hit;
      if (PickIn(ray, { points[corners[0]], points[corners[1]], points[corners[2]], points[corners[3]] }, four, nearer) &&
        !IsHidden(grid, cell)) {
        hit = nearer;
        hit.Cell = cell;
        found = true;
      }
    }
  }
  if (found) {
    FillCell(whole, grid, hit);
    const vtkIdType layer = static_cast<vtkIdType>(n[0] - 1) * (n[1] - 1);
    const int* extent = grid->GetExtent();
    const vtkIdType cells[3] = { hit.Cell % (n[0] - 1), hit.Cell / (n[0] - 1) % (n[1] - 1), hit.Cell / layer };
    const vtkIdType points[3] = { hit.Point % n[0], hit.Point / n[0] % n[1], hit.Point / (static_cast<vtkIdType>(n[0]) * n[1]) };
    for (int a = 0; a < 3; ++a) {
      hit.CellIJK[a] = extent[2 * a] + static_cast<int>(cells[a]);
      hit.PointIJK[a] = extent[2 * a] + static_cast<int>(points[a]);
    }
  }
  return found;
}
