// SPDX-License-Identifier: BSD-3-Clause
// Rays through images and rectilinear grids. Along each axis a place is a number that grows with the index: the index itself for images,
// the coordinate for rectilinear grids (negated where they decrease). Values are at `At`, cells between `Walls`.
#include "vtkStratusPickRay.h"

#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"
#include "vtkRectilinearGrid.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>

namespace {
class Lattice
{
public:
  Lattice(const vtkStratusPickRay& ray, vtkDataSet* grid);

  bool Pick(vtkStratusPickHit& hit) const;

private:
  void PlaceOf(const double x[3], double place[3]) const;
  void PlaceAt(double t, double place[3]) const;
  double ValueAt(const double place[3]) const;
  double ValueOn(double t) const;
  std::vector<double> Cut() const;
  bool IsShown(const double place[3], int cell[3]) const;
  bool FindIn(double from, double to, double& t) const;
  void Fill(double t, const int cell[3], vtkStratusPickHit& hit) const;

  const vtkStratusPickRay& Ray;
  vtkImageData* Image;
  vtkRectilinearGrid* Grid;
  vtkUnsignedCharArray *PointGhosts, *CellGhosts;
  int Extent[6], Points[3];
  double Sign[3] = { 1, 1, 1 };
  std::vector<double> Walls[3], At[3], Crops[3];
  double First[3], Last[3]; // places of the ray's ends
};

// The number of the interval between ascending borders that holds a place; the nearest one beyond the ends.
int IntervalOf(const std::vector<double>& borders, double place)
{
  const auto after = std::upper_bound(borders.begin(), borders.end(), place);
  return static_cast<int>(
    std::min<ptrdiff_t>(std::max<ptrdiff_t>(after - borders.begin() - 1, 0), static_cast<ptrdiff_t>(borders.size()) - 2));
}

Lattice::Lattice(const vtkStratusPickRay& ray, vtkDataSet* grid)
    : Ray(ray), Image(vtkImageData::SafeDownCast(grid)), Grid(vtkRectilinearGrid::SafeDownCast(grid)),
      PointGhosts(grid->GetPointGhostArray()), CellGhosts(grid->GetCellGhostArray())
{
  this->Image ? this->Image->GetExtent(this->Extent) : this->Grid->GetExtent(this->Extent);
  vtkDataArray* const axes[] = { this->Grid ? this->Grid->GetXCoordinates() : nullptr, this->Grid ? this->Grid->GetYCoordinates() : nullptr,
    this->Grid ? this->Grid->GetZCoordinates() : nullptr };
  for (int a = 0; a < 3; ++a) {
    this->Points[a] = this->Extent[2 * a + 1] - this->Extent[2 * a] + 1;
    std::vector<double>& walls = this->Walls[a];
    this->Sign[a] = axes[a] && axes[a]->GetComponent(this->Points[a] - 1, 0) < axes[a]->GetComponent(0, 0) ? -1.0 : 1.0;
    for (int i = 0; i < this->Points[a]; ++i) {
      walls.push_back(axes[a] ? this->Sign[a] * axes[a]->GetComponent(i, 0) : this->Extent[2 * a] + i);
    }
    if (walls.size() < 2) { // a flat image has the thickness of a cell where values belong to cells, else none
      walls.push_back(walls.front() + (ray.OfCells ? 1.0 : 0.0));
    }
    this->At[a] = walls;
    if (ray.OfCells) {
      this->At[a].pop_back();
      for (size_t i = 0; i < this->At[a].size(); ++i) {
        this->At[a][i] = 0.5 * (walls[i] + walls[i + 1]);
      }
    }
    for (int side = 0; ray.CropPlanes && side < 2; ++side) {
      const double plane = ray.CropPlanes[2 * a + side];
      this->Crops[a].push_back(this->Image ? (plane - this->Image->GetOrigin()[a]) / this->Image->GetSpacing()[a] : this->Sign[a] * plane);
    }
  }
  this->PlaceOf(ray.P1, this->First);
  this->PlaceOf(ray.P2, this->Last);
}

void Lattice::PlaceOf(const double x[3], double place[3]) const
{
  if (this->Image) {
    this->Image->TransformPhysicalPointToContinuousIndex(x, place);
  } else {
    std::transform(x, x + 3, this->Sign, place, [](double number, double sign) { return number * sign; });
  }
}

void Lattice::PlaceAt(double t, double place[3]) const
{
  for (int a = 0; a < 3; ++a) {
    place[a] = this->First[a] + t * (this->Last[a] - this->First[a]);
  }
}

// The field at a place, by the lattice's values; those at its border hold beyond it.
double Lattice::ValueAt(const double place[3]) const
{
  int first[3], next[3];
  double weight[3];
  const int n[3] = { static_cast<int>(this->At[0].size()), static_cast<int>(this->At[1].size()), static_cast<int>(this->At[2].size()) };
  for (int a = 0; a < 3; ++a) {
    const std::vector<double>& at = this->At[a];
    first[a] = n[a] < 2 ? 0 : IntervalOf(at, place[a]);
    next[a] = std::min(first[a] + 1, n[a] - 1);
    const double width = at[static_cast<size_t>(next[a])] - at[static_cast<size_t>(first[a])];
    weight[a] = width > 0.0 ? std::min(std::max((place[a] - at[static_cast<size_t>(first[a])]) / width, 0.0), 1.0) : 0.0;
    if (this->Ray.Nearest && this->Ray.OfCells) {
      first[a] = IntervalOf(this->Walls[a], place[a]);
      weight[a] = 0.0;
    } else if (this->Ray.Nearest) {
      weight[a] = weight[a] < 0.5 ? 0.0 : 1.0;
    }
  }
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    double part = 1.0;
    vtkIdType tuple = 0;
    for (int a = 2; a >= 0; --a) {
      const bool far = (corner >> a & 1) != 0;
      part *= far ? weight[a] : 1.0 - weight[a];
      tuple = tuple * n[a] + (far ? next[a] : first[a]);
    }
    sum += part > 0.0 ? part * this->Ray.Value(tuple) : 0.0;
  }
  return sum;
}

double Lattice::ValueOn(double t) const
{
  double place[3];
  this->PlaceAt(t, place);
  return this->ValueAt(place);
}

// The ray's parameters between which it is in one cell and one box of eight values.
std::vector<double> Lattice::Cut() const
{
  double begin = this->Ray.Begin, end = this->Ray.End;
  std::vector<double> cuts;
  for (int a = 0; a < 3; ++a) {
    const double from = this->First[a], along = this->Last[a] - from;
    if (along == 0.0) {
      end = from < this->Walls[a].front() || from > this->Walls[a].back() ? begin - 1.0 : end;
      continue;
    }
    const double one = (this->Walls[a].front() - from) / along, other = (this->Walls[a].back() - from) / along;
    begin = std::max(begin, std::min(one, other));
    end = std::min(end, std::max(one, other));
    const auto add = [&](double place) { cuts.push_back((place - from) / along); };
    std::for_each(this->Walls[a].begin(), this->Walls[a].end(), add);
    std::for_each(this->Crops[a].begin(), this->Crops[a].end(), add);
    for (size_t i = 0; i < this->At[a].size() && (this->Ray.OfCells || this->Ray.Nearest); ++i) {
      add(this->Ray.Nearest ? 0.5 * (this->At[a][i] + this->At[a][std::min(i + 1, this->At[a].size() - 1)]) : this->At[a][i]);
    }
  }
  if (!(begin <= end)) {
    return {};
  }
  cuts.push_back(begin);
  cuts.push_back(end);
  cuts.erase(std::remove_if(cuts.begin(), cuts.end(), [=](double t) { return !(t >= begin && t <= end); }), cuts.end());
  std::sort(cuts.begin(), cuts.end());
  return cuts;
}

// Finds the cell of a place between cuts. Returns whether it shows: by ghosts, blanking and crop regions.
bool Lattice::IsShown(const double place[3], int cell[3]) const
{
  int region = 0;
  constexpr int steps[] = { 1, 3, 9 };
  vtkIdType number = 0;
  for (int a = 2; a >= 0; --a) {
    cell[a] = IntervalOf(this->Walls[a], place[a]);
    number = number * std::max(this->Points[a] - 1, 1) + cell[a];
    for (double plane : this->Crops[a]) {
      region += steps[a] * (this->Sign[a] * place[a] > this->Sign[a] * plane ? 1 : 0);
    }
  }
  bool shown = !this->Ray.CropPlanes || (this->Ray.CropRegions >> region & 1) != 0;
  shown = shown && !(this->CellGhosts && (this->CellGhosts->GetValue(number) & vtkDataSetAttributes::HIDDENCELL));
  for (int corner = 0; shown && this->PointGhosts && corner < 8; ++corner) {
    vtkIdType point = 0;
    for (int a = 2; a >= 0; --a) {
      point = point * this->Points[a] + std::min(cell[a] + (corner >> a & 1), this->Points[a] - 1);
    }
    shown = !(this->PointGhosts->GetValue(point) & vtkDataSetAttributes::HIDDENPOINT);
  }
  return shown;
}

// Within a box of eight values the field is a cubic of t, by its values at four places. Where its slope is zero, it turns.
bool Lattice::FindIn(double from, double to, double& t) const
{
  const double width = to - from;
  // Places a little within keep to the box where an end is rounded to beyond its wall.
  const auto value = [&](double at) { return this->ValueOn(std::min(std::max(at, from + 1e-9 * width), to - 1e-9 * width)); };
  double turns[4] = { from, to, to, to };
  if (!this->Ray.Nearest) {
    const double f0 = value(from), f1 = value(from + width / 3), f2 = value(from + 2 * width / 3), f3 = value(to);
    const double c3 = 4.5 * (f3 - f0 + 3 * (f1 - f2)), c2 = 9 * f0 - 22.5 * f1 + 18 * f2 - 4.5 * f3,
                 c1 = -5.5 * f0 + 9 * f1 - 4.5 * f2 + f3;
    const double discriminant = c2 * c2 - 3 * c3 * c1;
    int count = 1;
    if (discriminant >= 0) {
      const double q = -(c2 + std::copysign(std::sqrt(discriminant), c2));
      for (const double s : { c3 != 0 ? q / (3 * c3) : 2.0, q != 0 ? c1 / q : 2.0 }) {
        if (s > 0 && s < 1) {
          turns[count++] = from + s * width;
        }
      }
    }
    std::fill(turns + count, turns + 4, to);
    std::sort(turns, turns + 4);
  }
  for (int piece = 0; piece < 3; ++piece) {
    if (this->Ray.FindInPiece(turns[piece], turns[piece + 1], value, t)) {
      return true;
    }
  }
  return false;
}

void Lattice::Fill(double t, const int cell[3], vtkStratusPickHit& hit) const
{
  double place[3];
  this->PlaceAt(t, place);
  hit.T = t;
  hit.Cell = hit.Point = 0;
  for (int a = 2; a >= 0; --a) {
    const std::vector<double>& walls = this->Walls[a];
    const auto i = static_cast<size_t>(cell[a]);
    const double width = walls[i + 1] - walls[i];
    hit.PCoords[a] = width > 0.0 ? std::min(std::max((place[a] - walls[i]) / width, 0.0), 1.0) : 0.0;
    const int point = std::min(cell[a] + (hit.PCoords[a] < 0.5 ? 0 : 1), this->Points[a] - 1);
    hit.CellIJK[a] = this->Extent[2 * a] + cell[a];
    hit.PointIJK[a] = this->Extent[2 * a] + point;
    hit.Cell = hit.Cell * std::max(this->Points[a] - 1, 1) + cell[a];
    hit.Point = hit.Point * this->Points[a] + point;
  }
  // Differences over a cell, one-sided at the border, along the grid's own axes; then in the data set's coordinates.
  double slopes[3];
  for (int a = 0; a < 3; ++a) {
    const auto i = static_cast<size_t>(cell[a]);
    const double half = 0.5 * (this->Walls[a][i + 1] - this->Walls[a][i]);
    double low[3] = { place[0], place[1], place[2] }, high[3] = { place[0], place[1], place[2] };
    low[a] = std::max(place[a] - half, this->At[a].front());
    high[a] = std::min(place[a] + half, this->At[a].back());
    const double across = (high[a] - low[a]) * (this->Image ? this->Image->GetSpacing()[a] : this->Sign[a]);
    slopes[a] = high[a] > low[a] ? (this->ValueAt(high) - this->ValueAt(low)) / across : 0.0;
  }
  std::copy(slopes, slopes + 3, hit.Gradient);
  if (this->Image) {
    this->Image->GetDirectionMatrix()->MultiplyPoint(slopes, hit.Gradient);
  }
}

bool Lattice::Pick(vtkStratusPickHit& hit) const
{
  const std::vector<double> cuts = this->Cut();
  for (size_t i = 1; i < cuts.size() && cuts[i - 1] < hit.T; ++i) {
    double middle[3], t;
    int cell[3];
    this->PlaceAt(0.5 * (cuts[i - 1] + cuts[i]), middle);
    if (cuts[i] > cuts[i - 1] && this->IsShown(middle, cell) && this->FindIn(cuts[i - 1], cuts[i], t) && t < hit.T) {
      this->Fill(t, cell, hit);
      return true;
    }
  }
  return false;
}
} // namespace

bool vtkStratusPickLattice(const vtkStratusPickRay& ray, vtkDataSet* imageOrRectilinear, vtkStratusPickHit& hit)
{
  return Lattice(ray, imageOrRectilinear).Pick(hit);
}
