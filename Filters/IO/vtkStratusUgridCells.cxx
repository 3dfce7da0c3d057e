// SPDX-License-Identifier: BSD-3-Clause
// Meshes that no variable of UGRID describes: MPAS, whose nodes are the middles of cells, and cells with bounds by CF, as ICON has them.
#include "vtkStratusUgridMesh.h"

#include "vtkStratusReaderCore.h"
#include "vtkStratusText.h"
#include "vtkStratusUnits.h"

#include <algorithm>
#include <cmath>

namespace {
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
    file.LengthOf(bounds->Dimensions[1]) >= 3 && file.LengthOf(bounds->Dimensions[1]) <= STRATUS_FACE_NODES_MAX;
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
  if (!by_vertex && (!of_vertices || of_vertices->Dimensions.size() != 1 || rows != this->GetNodes())) {
    this->File.Fail("the mesh '" + this->Topology->Name + "' needs corners of all " + std::to_string(this->GetNodes()) +
      " cells, and 'lonVertex' or 'xVertex', which say how many there are");
  }
  this->FaceDimension = by_vertex ? this->Topology->Dimensions[0] : of_vertices->Dimensions[0];
  const Variable* const counts = by_vertex ? nullptr : this->File.Find("nEdgesOnCell", this->Topology);
  const std::vector<double> used = counts ? this->File.ReadComplete(*counts, "number of edges") : std::vector<double>();
  const vtkSmartPointer<vtkDataArray> values = this->File.Read(*this->Topology);
  std::vector<double> numbers(rows * columns);
  for (size_t i = 0; i < numbers.size(); ++i) { // 0: none
    const double number = values->GetComponent(static_cast<vtkIdType>(i), 0);
    const bool counts_not = i / columns < used.size() && !(static_cast<double>(i % columns) < used[i / columns]);
    numbers[i] = counts_not || number == 0.0 ? NAN : number;
  }
  stratus_face_table table = {};
  table.rows = static_cast<int64_t>(rows);
  table.columns = static_cast<int64_t>(columns);
  table.first = 1.0;
  table.rows_are_nodes = by_vertex ? 0 : 1;
  const int degree = this->File.FindDimension("vertexDegree"); // a corner at the border of a region has fewer cells
  table.fewest = degree >= 0 ? static_cast<int>(this->File.LengthOf(degree)) : 3;
  this->FindFaces(numbers, table, this->File.LengthOf(this->FaceDimension), this->Topology->Name);
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
      int count = 0;
      const int* corners = this->GetFace(face, count);
      for (int c = 0; c < count; ++c) {
        low = std::min(low, at[static_cast<size_t>(corners[c])]);
        high = std::max(high, at[static_cast<size_t>(corners[c])]);
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
  const size_t corners = this->File.LengthOf(bounds[0]->Dimensions[1]), count = at[0].size();
  if (count == 0) {
    this->File.Fail("the mesh has no cells");
  }
  std::vector<double> degrees(2 * count);
  for (size_t i = 0; i < count; ++i) {
    degrees[2 * i] = at[0][i];
    degrees[2 * i + 1] = at[1][i];
  }
  std::vector<int32_t> joined(count);
  std::vector<int64_t> first(count);
  int64_t nodes = 0;
  const vtkStratusReaderCore core;
  core.Check(stratus_faces_join_corners(core, static_cast<int64_t>(count), degrees.data(), joined.data(), first.data(), &nodes),
    this->File.GetPath() + ": '" + bounds[0]->Name + "': ");
  for (size_t node = 0; node < static_cast<size_t>(nodes); ++node) {
    this->X.push_back(at[0][static_cast<size_t>(first[node])]);
    this->Y.push_back(at[1][static_cast<size_t>(first[node])]);
  }
  this->DescribeNodes("corners of cells by '" + bounds[0]->Name + "' and '" + bounds[1]->Name + "'");
  stratus_face_table table = {};
  table.rows = static_cast<int64_t>(count / corners);
  table.columns = static_cast<int64_t>(corners);
  table.fewest = 3;
  this->FindFaces({ joined.begin(), joined.end() }, table, count / corners, bounds[0]->Name);
}
