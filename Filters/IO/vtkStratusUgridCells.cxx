// SPDX-License-Identifier: BSD-3-Clause
// Meshes that no variable of UGRID describes: MPAS, whose nodes are the middles of cells, and cells with bounds by CF, as ICON has them.
#include "vtkStratusUgridMesh.h"

#include "vtkStratusText.h"
#include "vtkStratusUnits.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace {
constexpr size_t MostCorners = 64;  // of a cell
constexpr double SameCorner = 1e-6; // radians, some six metres: corners of cells that are nearer to each other are one node

using Point = std::array<double, 3>;

// Numbers points on the unit sphere, near ones by one number.
class CornerNumbers
{
public:
  // Returns the number, which is the next one if the point is new.
  int NumberOf(const Point& at)
  {
    const std::array<int64_t, 3> box = BoxOf(at);
    for (int64_t i = -1; i <= 1; ++i) {
      for (int64_t j = -1; j <= 1; ++j) {
        for (int64_t k = -1; k <= 1; ++k) {
          const auto range = this->Boxes.equal_range(KeyOf({ { box[0] + i, box[1] + j, box[2] + k } }));
          for (auto one = range.first; one != range.second; ++one) {
            const Point& other = this->Points[static_cast<size_t>(one->second)];
            if (std::hypot(std::hypot(at[0] - other[0], at[1] - other[1]), at[2] - other[2]) < SameCorner) {
              return one->second;
            }
          }
        }
      }
    }
    const int number = static_cast<int>(this->Points.size());
    this->Boxes.insert({ KeyOf(box), number });
    this->Points.push_back(at);
    return number;
  }
  size_t Count() const { return this->Points.size(); }

private:
  static std::array<int64_t, 3> BoxOf(const Point& at)
  {
    std::array<int64_t, 3> box;
    std::transform(at.begin(), at.end(), box.begin(), [](double one) { return static_cast<int64_t>(std::floor(one / SameCorner)); });
    return box;
  }
  static uint64_t KeyOf(const std::array<int64_t, 3>& box) // 21 bits each, which 2 / SameCorner boxes fit into
  {
    constexpr uint64_t mask = (1U << 21) - 1U;
    return (static_cast<uint64_t>(box[0]) & mask) << 42 | (static_cast<uint64_t>(box[1]) & mask) << 21 |
      (static_cast<uint64_t>(box[2]) & mask);
  }
  std::vector<Point> Points;
  std::unordered_multimap<uint64_t, int> Boxes;
};

bool IsLongitude(const vtkStratusNetCDFModel& file, const vtkStratusNetCDFVariable& one)
{
  return file.Text(one, "standard_name") == "longitude" || vtkStratusIsEast(file.Text(one, "units"));
}

bool IsLatitude(const vtkStratusNetCDFModel& file, const vtkStratusNetCDFVariable& one)
{
  return file.Text(one, "standard_name") == "latitude" || vtkStratusIsNorth(file.Text(one, "units"));
}

// The bounds of a coordinate along one dimension, of three or more corners; nullptr if it has none.
const vtkStratusNetCDFVariable* BoundsOf(const vtkStratusNetCDFModel& file, const vtkStratusNetCDFVariable& one)
{
  const std::string name = one.Dimensions.size() == 1 ? file.Text(one, "bounds") : "";
  const vtkStratusNetCDFVariable* bounds = name.empty() ? nullptr : file.Find(name, &one);
  const bool fits = bounds && bounds->Dimensions.size() == 2 && bounds->Dimensions[0] == one.Dimensions[0] && bounds->HasNumbers() &&
    file.LengthOf(bounds->Dimensions[1]) >= 3 && file.LengthOf(bounds->Dimensions[1]) <= MostCorners;
  return fits ? bounds : nullptr;
}

// The latitudes that belong to longitudes of cells.
const vtkStratusNetCDFVariable* LatitudesOf(const vtkStratusNetCDFModel& file, const vtkStratusNetCDFVariable& longitudes)
{
  for (const vtkStratusNetCDFVariable& one : file.GetVariables()) {
    if (one.Dimensions == longitudes.Dimensions && IsLatitude(file, one) && BoundsOf(file, one) &&
      BoundsOf(file, one)->Dimensions == BoundsOf(file, longitudes)->Dimensions) {
      return &one;
    }
  }
  return nullptr;
}
} // namespace

const vtkStratusUgridMesh::Variable* vtkStratusUgridMesh::FindMpas(const vtkStratusNetCDFModel& file)
{
  for (const char* name : { "cellsOnVertex", "verticesOnCell" }) {
    const Variable* one = file.Find(name);
    if (one && one->Dimensions.size() == 2 && one->HasNumbers()) {
      return one;
    }
  }
  return nullptr;
}

const vtkStratusUgridMesh::Variable* vtkStratusUgridMesh::FindCells(const vtkStratusNetCDFModel& file)
{
  for (const Variable& one : file.GetVariables()) {
    if (IsLongitude(file, one) && BoundsOf(file, one) && LatitudesOf(file, one)) {
      return &one;
    }
  }
  return nullptr;
}

// Adds a face of the file; one that lacks corners keeps its place.
void vtkStratusUgridMesh::AddFaceOf(std::vector<int>& corners)
{
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end()); // files repeat a corner where cells have fewer
  while (corners.size() > 1 && corners.front() == corners.back()) {
    corners.pop_back();
  }
  this->Absent.push_back(corners.size() < 3 ? 1 : 0);
  if (corners.size() < 3) {
    corners.assign(3, 0);
  }
  this->AddFace(corners);
}

// The faces are the triangles between the middles of cells, one for each corner of cells ("vertex"), so that values of cells are on nodes.
void vtkStratusUgridMesh::ReadMpas()
{
  this->Mpas = true;
  Variable global = *this->Topology;
  global.Id = vtkStratusNetCDFModel::Global;
  const bool sphere = vtkStratusLowerCase(vtkStratusTrimmed(this->File.Text(global, "on_a_sphere"))) != "no";
  this->ReadNodes(this->Named(sphere ? "lonCell" : "xCell", "middles of cells"),
    this->Named(sphere ? "latCell" : "yCell", "middles of cells"), sphere ? "radian" : "m");
  const bool by_vertex = this->Topology->BaseName() == "cellsOnVertex";
  const Variable* const of_vertices = this->File.Find(sphere ? "lonVertex" : "xVertex", this->Topology);
  const size_t rows = this->File.LengthOf(this->Topology->Dimensions[0]), columns = this->File.LengthOf(this->Topology->Dimensions[1]);
  const vtkSmartPointer<vtkDataArray> numbers = this->File.Read(*this->Topology);
  std::vector<std::vector<int>> faces;
  if (by_vertex) {
    this->FaceDimension = this->Topology->Dimensions[0];
    faces.resize(rows);
  } else {
    if (!of_vertices || of_vertices->Dimensions.size() != 1 || rows != this->GetNodes()) {
      this->File.Fail("the mesh '" + this->Topology->Name + "' needs corners of all " + std::to_string(this->GetNodes()) +
        " cells, and 'lonVertex' or 'xVertex', which say how many there are");
    }
    this->FaceDimension = of_vertices->Dimensions[0];
    faces.resize(this->File.LengthOf(this->FaceDimension));
  }
  const Variable* const counts = by_vertex ? nullptr : this->File.Find("nEdgesOnCell", this->Topology);
  const std::vector<double> used = counts ? this->File.ReadComplete(*counts, "number of edges") : std::vector<double>();
  const size_t most = by_vertex ? this->GetNodes() : faces.size();
  for (size_t row = 0; row < rows; ++row) {
    const size_t end = row < used.size() ? static_cast<size_t>(std::min(std::max(used[row], 0.0), static_cast<double>(columns))) : columns;
    for (size_t column = 0; column < end; ++column) {
      const double number = numbers->GetComponent(static_cast<vtkIdType>(row * columns + column), 0);
      if (std::isnan(number) || number == 0.0) { // none
        continue;
      }
      if (!(number >= 1.0 && number <= static_cast<double>(most)) || number != std::floor(number)) {
        this->File.Fail("'" + this->Topology->Name + "' has the number " + vtkStratusNumberText(number) + " in row " + std::to_string(row) +
          ", it must be 1 to " + std::to_string(most) + ", or 0 for none");
      }
      const size_t at = static_cast<size_t>(number) - 1;
      by_vertex ? faces[row].push_back(static_cast<int>(at)) : faces[at].push_back(static_cast<int>(row));
    }
  }
  const size_t full = this->File.FindDimension("vertexDegree") >= 0 ? this->File.LengthOf(this->File.FindDimension("vertexDegree")) : 3;
  for (std::vector<int>& face : faces) {
    if (face.size() < full) { // a corner at the border of a region
      face.clear();
    }
    this->AddFaceOf(face);
  }
  this->HidePeriodic(global);
}

// Hides faces that reach across a plane whose opposite sides are one.
void vtkStratusUgridMesh::HidePeriodic(const Variable& global)
{
  const char* const periods[2] = { "x_period", "y_period" };
  for (size_t a = 0; a < 2; ++a) {
    double period = 0.0;
    const std::vector<double>& at = a == 0 ? this->X : this->Y;
    for (size_t face = 0; !this->Degrees && this->File.Number(global, periods[a], period) && period > 0.0 && face < this->GetFaces();
         ++face) {
      double low = INFINITY, high = -INFINITY;
      for (size_t c = this->Offsets[face]; c < this->Offsets[face + 1]; ++c) {
        low = std::min(low, at[static_cast<size_t>(this->Corners[c])]);
        high = std::max(high, at[static_cast<size_t>(this->Corners[c])]);
      }
      this->Absent[face] = high - low > 0.5 * period ? 1 : this->Absent[face];
    }
  }
}

// The faces are the cells, and nodes their corners, of which each cell has its own in the file.
void vtkStratusUgridMesh::ReadCells()
{
  const Variable &x = *this->Topology, &y = *LatitudesOf(this->File, x);
  const Variable* const bounds[2] = { BoundsOf(this->File, x), BoundsOf(this->File, y) };
  const double degree = std::acos(-1.0) / 180.0;
  std::array<std::vector<double>, 2> at;
  for (size_t a = 0; a < 2; ++a) {
    const std::string own = this->File.Text(*bounds[a], "units"), units = own.empty() ? this->File.Text(a == 0 ? x : y, "units") : own;
    vtkStratusUnit unit = vtkStratusUnitOf(units);
    unit = unit.IsAngle() ? unit : vtkStratusUnitOf("degree");
    at[a] = this->File.ReadComplete(*bounds[a], "corner of cells");
    std::transform(at[a].begin(), at[a].end(), at[a].begin(), [&unit](double one) { return unit.Convert(one); });
  }
  this->XName = x.Name;
  this->YName = y.Name;
  this->FaceDimension = x.Dimensions[0];
  if (this->File.IsSelected(this->FaceDimension)) {
    this->File.Fail("'" + this->File.NameOf(this->FaceDimension) + "' is the dimension of the mesh's cells, which cannot be selected");
  }
  this->Metres = this->Degrees = true;
  const size_t corners = this->File.LengthOf(bounds[0]->Dimensions[1]);
  CornerNumbers numbers;
  std::vector<std::vector<int>> faces(at[0].size() / corners);
  for (size_t i = 0; i < at[0].size(); ++i) {
    const double longitude = at[0][i] * degree, latitude = at[1][i] * degree;
    const Point point = { { std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude), std::sin(latitude) } };
    const int number = numbers.NumberOf(point);
    if (static_cast<size_t>(number) == this->X.size()) {
      this->X.push_back(at[0][i]);
      this->Y.push_back(at[1][i]);
    }
    faces[i / corners].push_back(number);
  }
  if (this->X.empty()) {
    this->File.Fail("the mesh has no cells");
  }
  this->DescribeNodes("corners of cells by '" + bounds[0]->Name + "' and '" + bounds[1]->Name + "'");
  for (std::vector<int>& face : faces) {
    this->AddFaceOf(face);
  }
}
