// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusUgridReader.h"

#include "vtkStratusHDF5Lock.h"
#include "vtkStratusNetCDFFile.h"
#include "vtkStratusReaderCore.h"
#include "vtkStratusUgridLayers.h"
#include "vtkStratusUgridMesh.h"
#include "vtkStratusSphere.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDoubleArray.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>

vtkStandardNewMacro(vtkStratusUgridReader);

namespace {
using Variable = vtkStratusNetCDFModel::Variable;

bool IsValues(const vtkStratusUgridMesh& mesh, const vtkStratusUgridLayers& layers, const Variable& one)
{
  const bool placed = mesh.IsOnNodes(one) != mesh.IsOnFaces(one); // what has both dimensions is a table of neighbours
  const bool layered = mesh.FindLayers(one) == -1 || layers.IsOnLayers(one) || layers.IsOnBorders(one);
  return placed && layered && !mesh.IsPart(one) && !layers.Uses(one) && one.HasNumbers();
}

// The points of all borders of layers, in doubles, because coordinates of maps have seven digits before the point.
vtkSmartPointer<vtkPoints> MakePoints(const vtkStratusUgridMesh& mesh, const std::vector<double>& z)
{
  vtkSmartPointer<vtkDoubleArray> places = vtkSmartPointer<vtkDoubleArray>::New();
  places->SetNumberOfComponents(3);
  places->SetNumberOfTuples(static_cast<vtkIdType>(z.size()));
  double* to = places->GetPointer(0);
  for (size_t i = 0; i < z.size(); ++i) {
    *to++ = mesh.GetX()[i % mesh.GetNodes()];
    *to++ = mesh.GetY()[i % mesh.GetNodes()];
    *to++ = z[i];
  }
  vtkSmartPointer<vtkPoints> points = vtkSmartPointer<vtkPoints>::New();
  points->SetData(places);
  return points;
}

// Adds the prism of a face between two borders.
void AddPrism(vtkUnstructuredGrid* grid, const int* corners, int count, vtkIdType below, vtkIdType above, std::vector<vtkIdType>& ids)
{
  constexpr int types[] = { VTK_WEDGE, VTK_HEXAHEDRON, VTK_PENTAGONAL_PRISM, VTK_HEXAGONAL_PRISM };
  ids.clear();
  if (count <= 6) {
    for (vtkIdType border : { below, above }) {
      std::transform(corners, corners + count, std::back_inserter(ids), [border](int node) { return border + node; });
      if (count == 3) { // VTK counts a wedge's first triangle as seen from outside, other prisms' first faces as seen from within
        std::reverse(ids.end() - count, ids.end());
      }
    }
    grid->InsertNextCell(types[count - 3], 2 * count, ids.data());
    return;
  }
  ids.push_back(count); // faces of a polyhedron: the bottom seen from below, the top, the sides
  std::transform(corners, corners + count, std::back_inserter(ids), [below](int node) { return below + node; });
  std::reverse(ids.end() - count, ids.end());
  ids.push_back(count);
  std::transform(corners, corners + count, std::back_inserter(ids), [above](int node) { return above + node; });
  for (int i = 0; i < count; ++i) {
    const int a = corners[i], b = corners[(i + 1) % count];
    ids.insert(ids.end(), { 4, below + a, below + b, above + b, above + a });
  }
  grid->InsertNextCell(VTK_POLYHEDRON, count + 2, ids.data());
}

void AddCells(const vtkStratusUgridMesh& mesh, const std::vector<double>& z, const std::vector<uint8_t>& none,
  const std::vector<uint8_t>& dry, vtkUnstructuredGrid* grid)
{
  const size_t nodes = mesh.GetNodes(), layers = z.size() / nodes - 1;
  std::vector<uint8_t> hidden(layers * mesh.GetFaces());
  const vtkStratusReaderCore core;
  const stratus_faces faces = mesh.ViewFaces(dry);
  core.Check(stratus_prisms_hide(core, &faces, static_cast<int64_t>(layers), z.data(), none.data(), hidden.data()));
  std::vector<vtkIdType> ids;
  grid->Allocate(static_cast<vtkIdType>(hidden.size()));
  for (size_t layer = 0; layer < layers; ++layer) {
    for (size_t face = 0; face < mesh.GetFaces(); ++face) {
      int count = 0;
      const int* corners = mesh.GetFace(face, count);
      AddPrism(grid, corners, count, static_cast<vtkIdType>(layer * nodes), static_cast<vtkIdType>((layer + 1) * nodes), ids);
    }
  }
  if (std::any_of(hidden.begin(), hidden.end(), [](uint8_t one) { return one != 0; })) {
    vtkSmartPointer<vtkUnsignedCharArray> ghosts = vtkSmartPointer<vtkUnsignedCharArray>::New();
    ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
    ghosts->SetNumberOfValues(static_cast<vtkIdType>(hidden.size()));
    std::transform(hidden.begin(), hidden.end(), ghosts->GetPointer(0),
      [](uint8_t one) { return static_cast<unsigned char>(one ? vtkDataSetAttributes::HIDDENCELL : 0); });
    grid->GetCellData()->AddArray(ghosts);
  }
}

// Longitude and latitude of each node.
std::vector<double> DegreesOf(const vtkStratusUgridMesh& mesh, const std::shared_ptr<vtkStratusProjection>& projection)
{
  std::vector<double> degrees(2 * mesh.GetNodes());
  for (size_t node = 0; node < mesh.GetNodes(); ++node) {
    const double at[2] = { mesh.GetX()[node], mesh.GetY()[node] };
    if (!projection) {
      degrees[2 * node] = at[0] / mesh.GetFactor(0);
      degrees[2 * node + 1] = at[1] / mesh.GetFactor(1);
    } else if (!projection->ToEarth(at, &degrees[2 * node])) {
      mesh.GetFile().Fail("node " + std::to_string(node) + " at " + vtkStratusNumberText(at[0]) + ", " + vtkStratusNumberText(at[1]) +
        " has no place on the Earth by the grid mapping " + projection->Describe());
    }
  }
  return degrees;
}

// Values at the borders of layers on nodes, from those in the middle of the layers.
std::vector<double> AtBorders(
  const vtkStratusUgridValues& values, const vtkStratusUgridLayers& layers, const std::vector<double>& z, size_t nodes)
{
  const size_t count = layers.GetCount();
  std::vector<double> middles(count * nodes), result((count + 1) * nodes);
  for (size_t i = 0; i < middles.size(); ++i) {
    middles[i] = values.At(i % nodes, layers.FromBottom(i / nodes, count));
  }
  const vtkStratusReaderCore core;
  core.Check(
    stratus_layers_to_borders(core, static_cast<int64_t>(nodes), static_cast<int64_t>(count), z.data(), middles.data(), result.data()));
  return result;
}
} // namespace

bool vtkStratusUgridReader::CanReadFile(const char* name)
{
  try {
    const vtkStratusHDF5Call call;
    const vtkStratusNetCDFFile file(name ? name : "");
    return vtkStratusUgridMesh::FindTopology(file) != nullptr;
  } catch (const vtkStratusReadError&) {
    return false;
  }
}

std::string vtkStratusUgridReader::InspectFile(const vtkStratusNetCDFModel& file)
{
  vtkStratusUgridMesh mesh(file, this->Coordinates == SPHERE);
  const vtkStratusUgridLayers layers(mesh);
  mesh.SetLayers(layers.GetDimensions(), layers.GetCount());
  for (bool layered : { true, false }) {
    for (const Variable& one : file.GetVariables()) {
      if (IsValues(mesh, layers, one) && layered == (mesh.FindLayers(one) >= 0)) {
        this->AddVariable(file, one, layered ? 0 : 1);
      }
    }
  }
  const Variable& chosen = *file.Find(this->ChosenName());
  if (layers.IsNumbers()) {
    vtkWarningMacro(<< file.GetPath()
                    << ": heights are only numbers of layers, while x and y are in metres: the file has no heights of them");
  }
  this->LengthUnits = mesh.IsInMetres() && !layers.IsNumbers() ? "m" : "";
  for (int a = 0; a < 3; ++a) {
    this->AxisNames[a] = a < 2 ? mesh.GetAxisName(a) : "height";
  }
  this->AxisUnits[2] = layers.IsNumbers() ? "" : "m";
  for (int a = 0; a < 2; ++a) {
    if (mesh.IsInDegrees()) {
      this->FileAxes[a] = { a == 0 ? AXIS_OF_LONGITUDES : AXIS_OF_LATITUDES, a == 0 ? "longitude" : "latitude", "degrees",
        1.0 / mesh.GetFactor(a), {} };
    }
    const std::string title = file.Title(*file.Find(mesh.GetCoordinateName(a)));
    this->FileAxes[a].Title = title.empty() ? this->FileAxes[a].Title : title;
  }
  if (layers.IsDepth()) {
    this->FileAxes[2].Title = "depth";
    this->FileAxes[2].Scale = -1.0;
  }
  this->Description = mesh.Describe() + "; " + layers.Describe() + mesh.DescribeOthers(chosen) + file.DescribeValues(chosen);
  if (this->Coordinates == SPHERE) {
    const std::shared_ptr<vtkStratusProjection> projection = mesh.MakeProjection(chosen);
    if (!mesh.IsInDegrees() && !projection) {
      file.Fail("the mesh has no longitudes and latitudes, and no grid mapping that gives them, so that it has no place on a sphere");
    }
    this->Description += projection ? "; longitudes and latitudes by the grid mapping " + projection->Describe() : "";
    this->Description += "; on a sphere of 6371 km";
    this->SetAxesOnSphere();
  } else {
    try {
      const std::shared_ptr<vtkStratusProjection> projection = mesh.MakeProjection(chosen);
      const auto place = [projection](const double degrees[2], double at[2]) { return projection->ToPlane(degrees, at); };
      projection ? this->SetPlaceOnPlane(place, "") : this->SetPlaceOnPlane(nullptr, "");
    } catch (const vtkStratusReadError& why) { // the mesh itself needs no projection
      this->SetPlaceOnPlane(nullptr, why.Text);
    }
  }
  const int time = mesh.FindTime(chosen) >= 0 ? mesh.FindTime(chosen) : layers.GetTime();
  if (time >= 0) {
    const vtkStratusNetCDFModel::TimeSteps steps = file.ReadTimes(time);
    this->Times = steps.Values;
    this->TimeUnits = steps.Units;
    this->TimeCalendar = steps.Calendar;
    this->Description += steps.Note;
  }
  return "vtkUnstructuredGrid";
}

void vtkStratusUgridReader::BuildFile(const vtkStratusNetCDFModel& file, size_t step, vtkDataSet* output)
{
  vtkUnstructuredGrid* grid = vtkUnstructuredGrid::SafeDownCast(output);
  vtkStratusUgridMesh mesh(file, this->Coordinates == SPHERE);
  const vtkStratusUgridLayers layers(mesh);
  mesh.SetLayers(layers.GetDimensions(), layers.GetCount());
  std::vector<double> z;
  std::vector<uint8_t> none, dry;
  layers.Read(step, z, none, dry);
  grid->SetPoints(MakePoints(mesh, z));
  if (vtkDoubleArray* places = this->Coordinates == SPHERE ? vtkDoubleArray::SafeDownCast(grid->GetPoints()->GetData()) : nullptr) {
    this->UsedHeightFactor = this->HeightFactor > 0.0 ? this->HeightFactor : vtkStratusSphere::FactorOf(places, {});
    const std::vector<double> degrees = DegreesOf(mesh, mesh.MakeProjection(*file.Find(this->ChosenName()))); // which all levels have
    const size_t levels = static_cast<size_t>(places->GetNumberOfTuples()) / mesh.GetNodes();
    vtkStratusSphere::Place(nullptr, levels, degrees, places, this->UsedHeightFactor);
  }
  AddCells(mesh, z, none, dry, grid);
  const Variable& chosen = *file.Find(this->ChosenName());
  const vtkStratusUgridValues values = mesh.Read(chosen, step);
  const size_t count = layers.GetCount();
  const bool on_nodes = mesh.IsOnNodes(chosen), borders = layers.IsOnBorders(chosen), layered = layers.IsOnLayers(chosen);
  const size_t places = on_nodes ? mesh.GetNodes() : mesh.GetFaces(), storeys = on_nodes ? count + 1 : count;
  vtkSmartPointer<vtkDataArray> array;
  array.TakeReference(values.Values->NewInstance());
  array->SetName(chosen.Name.c_str());
  array->SetNumberOfTuples(static_cast<vtkIdType>(places * storeys));
  const std::vector<double> at_borders = on_nodes && layered ? AtBorders(values, layers, z, places) : std::vector<double>();
  for (size_t s = 0; s < storeys; ++s) {
    for (size_t p = 0; p < places; ++p) {
      double value = 0.0;
      if (on_nodes && layered) {
        value = at_borders[s * places + p];
      } else if (on_nodes || layered) {
        value = values.At(p, layered ? layers.FromBottom(s, count) : borders ? layers.FromBottom(s, count + 1) : 0);
      } else {
        value = borders ? 0.5 * (values.At(p, layers.FromBottom(s, count + 1)) + values.At(p, layers.FromBottom(s + 1, count + 1)))
                        : values.At(p, 0);
      }
      array->SetComponent(static_cast<vtkIdType>(s * places + p), 0, value);
    }
  }
  vtkDataSetAttributes* data = on_nodes ? static_cast<vtkDataSetAttributes*>(grid->GetPointData()) : grid->GetCellData();
  data->AddArray(array);
  data->SetActiveScalars(chosen.Name.c_str());
}

void vtkStratusUgridReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}
