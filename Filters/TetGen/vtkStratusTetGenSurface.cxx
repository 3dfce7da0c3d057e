// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusTetGenSurface.h"

#include "vtkStratusArrays.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace {
const vtkIdType MostNumbers = std::numeric_limits<std::int32_t>::max(); // TetGen's numbers have 32 bits

[[noreturn]] void Fail(const std::string& text)
{
  throw vtkStratusTetGenFailure{ text };
}

std::string Number(vtkIdType value)
{
  return std::to_string(value);
}

// Appends the tuples of a field-data array. Throws where a seed is not finite.
template <size_t N> void AddSeeds(vtkPolyData* surface, const char* name, std::vector<std::array<double, N>>& seeds)
{
  vtkDataArray* array = surface->GetFieldData()->GetArray(name);
  if (array && array->GetNumberOfComponents() != static_cast<int>(N)) {
    Fail(std::string("field data '") + name + "' have " + Number(array->GetNumberOfComponents()) + " components, they must have " +
      Number(static_cast<vtkIdType>(N)));
  }
  for (vtkIdType tuple = 0; array && tuple < array->GetNumberOfTuples(); ++tuple) {
    std::array<double, N> seed;
    array->GetTuple(tuple, seed.data());
    seeds.push_back(seed);
  }
  for (size_t index = 0; index < seeds.size(); ++index) {
    if (!std::all_of(seeds[index].begin(), seeds[index].end(), [](double value) { return std::isfinite(value); })) {
      Fail(std::string(name) + " " + Number(static_cast<vtkIdType>(index)) + " is not finite");
    }
  }
}

// Returns a cell's marker, 1 where there are none. vtkPolyData numbers vertices first, then lines, polygons and strips.
std::int32_t MarkerOf(vtkPolyData* surface, vtkIdType cell)
{
  vtkDataArray* markers = surface->GetCellData()->GetArray("Marker");
  if (!markers || markers->GetNumberOfComponents() != 1) {
    return 1;
  }
  const double value = markers->GetComponent(cell, 0);
  if (!(std::abs(value) <= static_cast<double>(MostNumbers) && value == std::floor(value))) {
    Fail("cell data 'Marker' hold " + std::to_string(value) + " for cell " + Number(cell) + ", markers are integers of 32 bits");
  }
  return static_cast<std::int32_t>(value);
}
} // namespace

// Collects the points that cells use, in the input's order. Points with equal coordinates are merged, because TetGen handles duplicates
// badly. `ours` maps each point of the input to its number in the request, -1 where it is unused.
void vtkStratusTetGenSurface::SetPoints(vtkPolyData* surface, std::vector<vtkIdType>& ours)
{
  using Place = std::pair<std::array<double, 3>, vtkIdType>;
  ours.assign(static_cast<size_t>(surface->GetNumberOfPoints()), -1);
  vtkNew<vtkIdList> cell;
  for (vtkCellArray* cells : { surface->GetVerts(), surface->GetPolys(), surface->GetStrips() }) {
    for (vtkIdType index = 0; index < cells->GetNumberOfCells(); ++index) {
      cells->GetCellAtId(index, cell);
      std::for_each(cell->begin(), cell->end(), [&ours](vtkIdType point) { ours[static_cast<size_t>(point)] = point; });
    }
  }
  std::vector<Place> places;
  for (const vtkIdType point : ours) {
    if (point >= 0) {
      Place place;
      surface->GetPoint(point, place.first.data());
      place.second = point;
      if (!std::all_of(place.first.begin(), place.first.end(), [](double x) { return std::isfinite(x); })) {
        Fail("point " + Number(point) + " of the surface is not finite");
      }
      places.push_back(place);
    }
  }
  std::sort(places.begin(), places.end());
  for (size_t index = 1; index < places.size(); ++index) {
    if (places[index].first == places[index - 1].first) {
      ours[static_cast<size_t>(places[index].second)] = places[index - 1].second;
      places[index].second = places[index - 1].second; // the lowest number of all points here
    }
  }
  for (size_t point = 0; point < ours.size(); ++point) {
    if (ours[point] == static_cast<vtkIdType>(point)) {
      double place[3];
      surface->GetPoint(static_cast<vtkIdType>(point), place);
      this->Coordinates.insert(this->Coordinates.end(), place, place + 3);
      ours[point] = static_cast<vtkIdType>(this->OriginalPoints.size());
      this->OriginalPoints.push_back(static_cast<vtkIdType>(point));
    } else if (ours[point] >= 0) {
      ours[point] = ours[static_cast<size_t>(ours[point])]; // merged into a point of a lower number, which is mapped already
    }
  }
}

void vtkStratusTetGenSurface::AddFacet(vtkIdType size, const vtkIdType* points, std::int32_t marker, const std::vector<vtkIdType>& ours)
{
  std::vector<std::int32_t> corners;
  for (vtkIdType index = 0; index < size; ++index) {
    const std::int32_t corner = static_cast<std::int32_t>(ours[static_cast<size_t>(points[index])]);
    if (corners.empty() || corners.back() != corner) {
      corners.push_back(corner);
    }
  }
  while (corners.size() > 1 && corners.back() == corners.front()) {
    corners.pop_back();
  }
  if (corners.size() < 3) { // merging has left it without area
    return;
  }
  this->Corners.insert(this->Corners.end(), corners.begin(), corners.end());
  if (static_cast<vtkIdType>(this->Corners.size()) > MostNumbers) {
    Fail("the surface has more than " + Number(MostNumbers) + " corners, which is TetGen's limit");
  }
  this->Begins.push_back(static_cast<std::int32_t>(this->Corners.size()));
  this->Markers.push_back(marker);
}

void vtkStratusTetGenSurface::Set(vtkPolyData* surface)
{
  if (surface->GetFieldData()->GetAbstractArray("FacetHoles")) {
    Fail("the surface has field data 'FacetHoles', facets with holes in them are not taken");
  }
  std::string error;
  if (!vtkStratusCheckSurface(surface, error)) {
    Fail(error);
  }
  std::vector<vtkIdType> ours;
  this->SetPoints(surface, ours);
  if (static_cast<vtkIdType>(this->OriginalPoints.size()) > MostNumbers / 3) {
    Fail("the surface has " + Number(static_cast<vtkIdType>(this->OriginalPoints.size())) + " points, TetGen takes up to " +
      Number(MostNumbers / 3));
  }
  this->Begins.assign(1, 0);
  vtkIdType cell = surface->GetNumberOfVerts() + surface->GetNumberOfLines();
  vtkNew<vtkIdList> ids;
  for (vtkIdType index = 0; index < surface->GetNumberOfPolys(); ++index, ++cell) {
    surface->GetPolys()->GetCellAtId(index, ids);
    this->AddFacet(ids->GetNumberOfIds(), ids->begin(), MarkerOf(surface, cell), ours);
  }
  for (vtkIdType index = 0; index < surface->GetNumberOfStrips(); ++index, ++cell) {
    surface->GetStrips()->GetCellAtId(index, ids);
    for (vtkIdType triangle = 0; triangle + 2 < ids->GetNumberOfIds(); ++triangle) {
      this->AddFacet(3, ids->begin() + triangle, MarkerOf(surface, cell), ours);
    }
  }
  if (this->Markers.size() < 4) {
    Fail("the surface has " + Number(static_cast<vtkIdType>(this->Markers.size())) + " facets with an area, at least 4 enclose a volume");
  }
  AddSeeds(surface, "Holes", this->Holes);
  AddSeeds(surface, "Regions", this->Regions);
}

void vtkStratusTetGenSurface::Write(tetgen_exchange::Request header, vtkStratusTetGenSpool& spool) const
{
  header.Magic = tetgen_exchange::RequestMagic;
  header.Points = static_cast<std::int64_t>(this->OriginalPoints.size());
  header.Holes = static_cast<std::int64_t>(this->Holes.size());
  header.Regions = static_cast<std::int64_t>(this->Regions.size());
  header.Facets = static_cast<std::int64_t>(this->Markers.size());
  header.Corners = static_cast<std::int64_t>(this->Corners.size());
  spool.Write(&header, sizeof header);
  const auto write = [&spool](const auto& values) { spool.Write(values.data(), values.size() * sizeof values[0]); };
  write(this->Coordinates);
  write(this->Holes);
  std::vector<std::array<double, 5>> numbered = this->Regions;
  for (size_t region = 0; region < numbered.size(); ++region) {
    // TetGen truncates attributes to integers, so it gets the regions' numbers; PutAttributes() puts the attributes back.
    numbered[region][3] = static_cast<double>(region + 1);
  }
  write(numbered);
  write(this->Begins);
  write(this->Corners);
  write(this->Markers);
  spool.Rewind();
}

namespace {
// Replaces the numbers of regions by their attributes. TetGen numbers parts without a seed on from the last region; they get integers above
// all attributes.
void PutAttributes(const std::vector<std::array<double, 5>>& regions, vtkDoubleArray* attributes)
{
  const double seeds = static_cast<double>(regions.size());
  double largest = 0.0;
  for (const auto& region : regions) {
    largest = std::max(largest, std::floor(region[3]));
  }
  for (vtkIdType cell = 0; cell < attributes->GetNumberOfValues(); ++cell) {
    const double number = attributes->GetValue(cell);
    const bool seeded = number >= 1.0 && number <= seeds;
    attributes->SetValue(cell, seeded ? regions[static_cast<size_t>(number) - 1][3] : largest + std::max(1.0, number - seeds));
  }
}

// Reads 32-bit numbers from the answer. Throws unless all are in 0..limit - 1.
vtkSmartPointer<vtkIdTypeArray> ReadIds(vtkStratusTetGenSpool& answer, std::int64_t count, std::int64_t limit)
{
  std::vector<std::int32_t> numbers(static_cast<size_t>(count));
  if (!answer.Read(numbers.data(), numbers.size() * sizeof numbers[0]) ||
    !std::all_of(numbers.begin(), numbers.end(), [limit](std::int32_t number) { return number >= 0 && number < limit; })) {
    Fail("TetGen's answer is damaged");
  }
  auto ids = vtkSmartPointer<vtkIdTypeArray>::New();
  ids->SetNumberOfValues(count);
  std::copy(numbers.begin(), numbers.end(), ids->GetPointer(0));
  return ids;
}

// Drops the points that no tetrahedron uses, most of which are inside holes, and renumbers the rest. Returns the points kept, in order.
std::vector<vtkIdType> LeaveOut(vtkIdType points, vtkIdTypeArray* mesh, vtkIdTypeArray* boundary)
{
  std::vector<vtkIdType> number(static_cast<size_t>(points), -1), left;
  for (vtkIdType index = 0; index < mesh->GetNumberOfValues(); ++index) {
    number[static_cast<size_t>(mesh->GetValue(index))] = 0;
  }
  for (vtkIdType point = 0; point < points; ++point) {
    if (number[static_cast<size_t>(point)] == 0) {
      number[static_cast<size_t>(point)] = static_cast<vtkIdType>(left.size());
      left.push_back(point);
    }
  }
  for (vtkIdTypeArray* ids : { mesh, boundary }) {
    for (vtkIdType index = 0; index < ids->GetNumberOfValues(); ++index) {
      const vtkIdType now = number[static_cast<size_t>(ids->GetValue(index))];
      if (now < 0) {
        Fail("TetGen's answer is damaged: a face is on no tetrahedron");
      }
      ids->SetValue(index, now);
    }
  }
  return left;
}
} // namespace

void vtkStratusTetGenReadAnswer(
  vtkStratusTetGenSpool& answer, const vtkStratusTetGenSurface& surface, vtkUnstructuredGrid* mesh, vtkPolyData* boundary)
{
  tetgen_exchange::Answer header = {};
  answer.Rewind();
  if (!answer.Read(&header, sizeof header) || header.Magic != tetgen_exchange::AnswerMagic || header.Points < 0 || header.Tetrahedra < 0 ||
    header.Faces < 0) {
    Fail("TetGen's answer is damaged");
  }
  std::vector<double> coordinates(3 * static_cast<size_t>(header.Points));
  auto regions = vtkSmartPointer<vtkDoubleArray>::New();
  regions->SetName("Region");
  regions->SetNumberOfValues(header.Attributes);
  if (!answer.Read(coordinates.data(), coordinates.size() * sizeof(double)) ||
    !answer.Read(regions->GetPointer(0), static_cast<size_t>(header.Attributes) * sizeof(double))) {
    Fail("TetGen's answer is damaged");
  }
  PutAttributes(surface.Regions, regions);
  const auto tetrahedra = ReadIds(answer, 4 * header.Tetrahedra, header.Points);
  const auto faces = ReadIds(answer, 3 * header.Faces, header.Points);
  auto markers = vtkSmartPointer<vtkIntArray>::New();
  markers->SetName("Marker");
  markers->SetNumberOfValues(header.Faces);
  if (!answer.Read(markers->GetPointer(0), static_cast<size_t>(header.Faces) * sizeof(int))) {
    Fail("TetGen's answer is damaged");
  }
  if (header.Tetrahedra == 0) {
    Fail("TetGen found no tetrahedron: the surface encloses nothing, or holes take it all");
  }
  const std::vector<vtkIdType> left = LeaveOut(header.Points, tetrahedra, faces);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  auto original = vtkSmartPointer<vtkIdTypeArray>::New();
  original->SetName("vtkOriginalPointIds");
  for (const vtkIdType point : left) {
    points->InsertNextPoint(&coordinates[3 * static_cast<size_t>(point)]);
    const bool known = point < static_cast<vtkIdType>(surface.OriginalPoints.size());
    original->InsertNextValue(known ? surface.OriginalPoints[static_cast<size_t>(point)] : -1);
  }
  vtkNew<vtkCellArray> cells, triangles;
  cells->SetData(4, tetrahedra);
  triangles->SetData(3, faces);
  mesh->SetPoints(points);
  mesh->SetCells(VTK_TETRA, cells);
  mesh->GetPointData()->AddArray(original);
  if (header.Attributes > 0) {
    mesh->GetCellData()->AddArray(regions);
    mesh->GetCellData()->SetActiveScalars("Region");
  }
  boundary->SetPoints(points);
  boundary->SetPolys(triangles);
  boundary->GetPointData()->AddArray(original);
  boundary->GetCellData()->AddArray(markers);
}
