// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusUgridMesh.h"

#include "vtkStratusReaderCore.h"
#include "vtkStratusSphere.h"
#include "vtkStratusUnits.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace {
constexpr size_t MostCorners = 64; // of a face; a shorter dimension of a connectivity counts corners
} // namespace

const vtkStratusUgridMesh::Variable* vtkStratusUgridMesh::FindTopology(const vtkStratusNetCDFModel& file)
{
  const Variable* found = nullptr;
  for (const Variable& one : file.GetVariables()) {
    double dimension = 2.0;
    if (file.Text(one, "cf_role") == "mesh_topology" && (!file.Number(one, "topology_dimension", dimension) || dimension == 2.0)) {
      return &one;
    }
    found = one.BaseName() == "nv" && one.Dimensions.size() == 2 ? &one : found;
  }
  found = found ? found : FindMpas(file);
  return found ? found : FindCells(file);
}

vtkStratusUgridMesh::vtkStratusUgridMesh(const vtkStratusNetCDFModel& file, bool on_sphere) : File(file), Sphere(on_sphere)
{
  this->Topology = FindTopology(file);
  if (!this->Topology) {
    file.Fail(
      "there is no mesh: no variable of cf_role mesh_topology and topology_dimension 2, no 'nv' of FVCOM, no 'cellsOnVertex' of MPAS, "
      "and no longitudes and latitudes with bounds of three or more corners");
  }
  const Variable& topology = *this->Topology;
  if (file.Text(topology, "cf_role") == "mesh_topology") {
    const std::vector<std::string> coordinates = vtkStratusWords(file.Text(topology, "node_coordinates"));
    const Variable& first = this->Named(coordinates.size() > 1 ? coordinates[0] : "", "node_coordinates of two variables");
    const Variable& second = this->Named(coordinates[1], "node_coordinates of two variables");
    const std::string name = file.Text(first, "standard_name");
    const bool turned = name == "latitude" || name == "projection_y_coordinate";
    this->ReadNodes(turned ? second : first, turned ? first : second, "");
    this->ReadFaces(this->Named(file.Text(topology, "face_node_connectivity"), "face_node_connectivity"), 0);
  } else if (topology.BaseName() == "nv") {
    const Variable* x = file.Find("x", &topology);
    const std::vector<double> own = x && x->Dimensions.size() == 1 ? file.ReadComplete(*x, "coordinate") : std::vector<double>();
    const bool plane = std::any_of(own.begin(), own.end(), [](double one) { return one != 0.0; }); // FVCOM writes zeros on a sphere
    this->ReadNodes(this->Named(plane ? "x" : "lon", "coordinates"), this->Named(plane ? "y" : "lat", "coordinates"), "");
    this->ReadFaces(topology, 1);
  } else if (FindMpas(file) == this->Topology) {
    this->ReadMpas();
  } else {
    this->ReadCells();
  }
  this->Finish();
}

const vtkStratusUgridMesh::Variable& vtkStratusUgridMesh::Named(const std::string& name, const char* what) const
{
  const Variable* one = name.empty() ? nullptr : this->File.Find(name, this->Topology);
  if (!one) {
    this->File.Fail(
      "the mesh '" + this->Topology->Name + "' has no " + what + (name.empty() ? "" : ": there is no variable '" + name + "'"));
  }
  return *one;
}

// usual_unit: of coordinates that have none
void vtkStratusUgridMesh::ReadNodes(const Variable& x, const Variable& y, const char* usual_unit)
{
  if (x.Dimensions.size() != 1 || y.Dimensions != x.Dimensions) {
    this->File.Fail("the nodes' coordinates '" + x.Name + "' and '" + y.Name + "' must have one and the same dimension");
  }
  this->NodeDimension = x.Dimensions[0];
  this->XName = x.Name;
  this->YName = y.Name;
  this->X = this->File.ReadComplete(x, "coordinate of nodes");
  this->Y = this->File.ReadComplete(y, "coordinate of nodes");
  if (this->X.empty()) {
    this->File.Fail("the mesh has no nodes");
  }
  vtkStratusUnit unit = vtkStratusUnitOf(this->File.Text(x, "units"));
  unit = unit.IsLength() || unit.IsAngle() ? unit : vtkStratusUnitOf(usual_unit);
  this->Metres = unit.IsLength() || unit.IsAngle();
  this->Degrees = unit.IsAngle();
  for (std::vector<double>* at : { &this->X, &this->Y }) {
    std::transform(at->begin(), at->end(), at->begin(), [&unit](double one) { return unit.Convert(one); });
  }
  this->DescribeNodes("nodes at '" + x.Name + "' and '" + y.Name + "'");
}

// Says what nodes are, and how degrees become metres.
void vtkStratusUgridMesh::DescribeNodes(const std::string& what)
{
  for (size_t node = 0; node < this->X.size(); ++node) {
    this->NodeOf.push_back({ node, node, 1.0 });
  }
  if (this->Degrees) {
    const auto ends = std::minmax_element(this->Y.begin(), this->Y.end());
    const double degree = std::acos(-1.0) / 180.0, middle = 0.5 * (*ends.first + *ends.second);
    this->Factors = { { vtkStratusSphere::EarthRadius * degree * std::cos(middle * degree), vtkStratusSphere::EarthRadius * degree } };
    this->Description = this->Sphere ? "" : "degrees as metres at latitude " + vtkStratusNumberText(middle) + "; ";
  }
  this->Description += what;
}

std::shared_ptr<vtkStratusProjection> vtkStratusUgridMesh::MakeProjection(const Variable& variable) const
{
  const Variable& x = *this->File.Find(this->XName);
  const vtkStratusUnit unit = vtkStratusUnitOf(this->File.Text(x, "units"));
  for (const Variable* one : { &variable, this->Topology, &x }) {
    const Variable* mapping = unit.IsLength() ? vtkStratusProjection::FindMapping(this->File, *one) : nullptr;
    if (mapping) {
      auto projection = std::make_shared<vtkStratusProjection>(this->File, *mapping, unit.Scale);
      if (projection->IsRotated()) {
        this->File.Fail(
          "'" + x.Name + "' is in '" + this->File.Text(x, "units") + "', the grid mapping " + projection->Describe() + " needs degrees");
      }
      return projection;
    }
  }
  return nullptr;
}

// Fill values at the end of a face are left out. `first` is the number of the first node if the file has no start_index.
void vtkStratusUgridMesh::ReadFaces(const Variable& connectivity, int first)
{
  if (connectivity.Dimensions.size() != 2) {
    this->File.Fail("the faces' nodes '" + connectivity.Name + "' have " + std::to_string(connectivity.Dimensions.size()) +
      " dimensions, they must have 2");
  }
  const size_t lengths[2] = { this->File.LengthOf(connectivity.Dimensions[0]), this->File.LengthOf(connectivity.Dimensions[1]) };
  const bool turned = first == 1 ? lengths[0] <= 4 : lengths[1] > MostCorners && lengths[0] <= MostCorners;
  const size_t faces = lengths[turned ? 1 : 0], corners = lengths[turned ? 0 : 1];
  this->FaceDimension = connectivity.Dimensions[turned ? 1 : 0];
  for (int dimension : { this->NodeDimension, this->FaceDimension }) {
    if (dimension >= 0 && this->File.IsSelected(dimension)) {
      this->File.Fail("'" + this->File.NameOf(dimension) + "' is the dimension of the mesh's " +
        (dimension == this->NodeDimension ? "nodes" : "faces") + ", which cannot be selected");
    }
  }
  double start = first;
  this->File.Number(connectivity, "start_index", start);
  if (faces == 0 || corners < 3 || corners > MostCorners) {
    this->File.Fail("the mesh has " + std::to_string(faces) + " faces of up to " + std::to_string(corners) + " nodes, 3 to " +
      std::to_string(MostCorners) + " are needed");
  }
  const vtkSmartPointer<vtkDataArray> values = this->File.Read(connectivity);
  std::vector<double> numbers(faces * corners);
  for (size_t f = 0; f < faces; ++f) {
    for (size_t c = 0; c < corners; ++c) {
      numbers[f * corners + c] = values->GetComponent(static_cast<vtkIdType>(turned ? c * faces + f : f * corners + c), 0);
    }
  }
  stratus_face_table table = {};
  table.rows = static_cast<int64_t>(faces);
  table.columns = static_cast<int64_t>(corners);
  table.first = start;
  this->FindFaces(numbers, table, faces, connectivity.Name);
}

stratus_faces vtkStratusUgridMesh::ViewFaces(const std::vector<uint8_t>& absent) const
{
  stratus_faces view = {}; // whose arrays are read only, unless the mesh itself changes them
  view.node_count = static_cast<int64_t>(this->GetNodes());
  view.face_count = static_cast<int64_t>(this->GetFaces());
  view.offsets = const_cast<int64_t*>(this->Offsets.data());
  view.nodes = const_cast<int32_t*>(this->Corners.data());
  view.absent = const_cast<uint8_t*>(absent.data());
  return view;
}

// Finds the faces by a table of numbers. table: all but its numbers; name: of its variable
void vtkStratusUgridMesh::FindFaces(const std::vector<double>& numbers, stratus_face_table table, size_t faces, const std::string& name)
{
  const vtkStratusReaderCore core;
  table.numbers = numbers.data();
  this->Offsets.assign(faces + 1, 0);
  this->Corners.assign(numbers.size() + 3 * faces, 0);
  this->Absent.assign(faces, 0);
  stratus_faces view = this->ViewFaces(this->Absent);
  core.Check(stratus_faces_from_table(core, &table, &view), this->File.GetPath() + ": '" + name + "': ");
  this->Corners.resize(static_cast<size_t>(this->Offsets.back()));
  for (size_t face = 0; face < faces; ++face) {
    this->FaceOf.push_back({ face, face, 1.0 });
  }
}

// Turns degrees into metres and faces counterclockwise, once all nodes and faces are there.
void vtkStratusUgridMesh::Finish()
{
  if (this->Degrees && !this->Sphere) {
    this->Flatten();
  }
  for (size_t node = 0; node < this->X.size(); ++node) {
    this->X[node] *= this->Factors[0];
    this->Y[node] *= this->Factors[1];
  }
  this->TurnFaces();
}

// Makes longitudes continuous, or cuts faces at a meridian.
void vtkStratusUgridMesh::Flatten()
{
  std::vector<double> degrees;
  degrees.reserve(2 * this->GetNodes());
  for (size_t node = 0; node < this->GetNodes(); ++node) {
    degrees.insert(degrees.end(), { this->X[node], this->Y[node] });
  }
  const vtkStratusReaderCore core;
  const stratus_faces view = this->ViewFaces(this->Absent);
  stratus_flat_faces flat = {};
  core.Check(stratus_faces_flatten(core, &view, degrees.data(), &flat),
    this->File.GetPath() + ": '" + this->XName + "' and '" + this->YName + "': ");
  const size_t nodes = static_cast<size_t>(flat.faces.node_count), faces = static_cast<size_t>(flat.faces.face_count);
  this->X.resize(nodes);
  this->Y.resize(nodes);
  this->NodeOf.resize(nodes);
  for (size_t node = 0; node < nodes; ++node) {
    this->X[node] = flat.degrees[2 * node];
    this->Y[node] = flat.degrees[2 * node + 1];
    this->NodeOf[node] = { static_cast<size_t>(flat.node_of[2 * node]), static_cast<size_t>(flat.node_of[2 * node + 1]),
      flat.weights[node] };
  }
  this->FaceOf.resize(faces);
  for (size_t face = 0; face < faces; ++face) {
    this->FaceOf[face] = { static_cast<size_t>(flat.face_of[face]), static_cast<size_t>(flat.face_of[face]), 1.0 };
  }
  this->FileOffsets.assign(flat.faces.offsets, flat.faces.offsets + faces + 1);
  this->FileCorners.assign(flat.faces.nodes, flat.faces.nodes + this->FileOffsets.back());
  this->FileOffsets.swap(this->Offsets);
  this->FileCorners.swap(this->Corners);
  this->Absent.assign(flat.faces.absent, flat.faces.absent + faces);
  this->Description += flat.unwrapped ? ", longitudes made continuous where they jump" : "";
  this->Description += flat.cut ? ", faces cut at longitude " + vtkStratusNumberText(flat.meridian) : "";
  stratus_flat_faces_destroy(core, &flat);
}

// Turns faces so that their corners are counterclockwise, seen from above.
void vtkStratusUgridMesh::TurnFaces()
{
  const bool sphere = this->Sphere && this->Degrees;
  std::vector<double> places;
  places.reserve(2 * this->GetNodes());
  for (size_t node = 0; node < this->GetNodes(); ++node) { // longitudes and latitudes, or x and y
    places.insert(places.end(), { this->X[node] / (sphere ? this->Factors[0] : 1.0), this->Y[node] / (sphere ? this->Factors[1] : 1.0) });
  }
  const vtkStratusReaderCore core;
  const stratus_faces view = this->ViewFaces(this->Absent);
  core.Check(stratus_faces_turn(core, &view, places.data(), sphere ? 1 : 0));
}

bool vtkStratusUgridMesh::IsPart(const Variable& variable) const
{
  constexpr const char* attributes[] = { "node_coordinates", "edge_coordinates", "face_coordinates", "face_node_connectivity",
    "face_edge_connectivity", "face_face_connectivity", "edge_node_connectivity", "edge_face_connectivity", "boundary_node_connectivity" };
  const auto names = [&](const char* attribute) {
    const std::vector<std::string> words = vtkStratusWords(this->File.Text(*this->Topology, attribute));
    return std::any_of(
      words.begin(), words.end(), [&](const std::string& word) { return this->File.Find(word, this->Topology) == &variable; });
  };
  // MPAS' tables have dimensions of corners and edges, and its cells' own numbers one dimension.
  const auto of_corners = [this](int dimension) {
    const std::string name = this->File.NameOf(dimension);
    return name == "maxEdges" || name == "maxEdges2" || name == "vertexDegree" || name == "TWO" || name == "THREE" || name == "R3";
  };
  if (this->Mpas &&
    (variable.Dimensions.size() < 2 ? !variable.Dimensions.empty() && this->IsPlace(variable.Dimensions[0])
                                    : std::any_of(variable.Dimensions.begin(), variable.Dimensions.end(), of_corners))) {
    return variable.BaseName() != "bottomDepth" && variable.BaseName() != "ter";
  }
  return variable.Name == this->XName || variable.Name == this->YName || variable.Name == this->Topology->Name ||
    std::any_of(std::begin(attributes), std::end(attributes), names);
}

bool vtkStratusUgridMesh::Has(const Variable& variable, int dimension) const
{
  return dimension >= 0 && std::find(variable.Dimensions.begin(), variable.Dimensions.end(), dimension) != variable.Dimensions.end();
}

// The dimensions besides time, nodes and faces that have several values, or none.
std::vector<int> vtkStratusUgridMesh::FindOthers(const Variable& variable) const
{
  std::vector<int> others;
  std::copy_if(variable.Dimensions.begin(), variable.Dimensions.end(), std::back_inserter(others),
    [this](int one) { return !this->IsPlace(one) && !this->IsTime(one) && !this->File.IsSelected(one) && this->File.LengthOf(one) != 1; });
  return others;
}

void vtkStratusUgridMesh::SetLayers(const std::array<int, 2>& dimensions, size_t count)
{
  this->Layers = dimensions;
  this->LayerCount = count;
}

int vtkStratusUgridMesh::FindLayers(const Variable& variable) const
{
  const std::vector<int> others = this->FindOthers(variable);
  if (others.size() < 2) {
    return others.empty() ? -1 : others[0];
  }
  const auto known =
    std::find_if(others.begin(), others.end(), [this](int one) { return one == this->Layers[0] || one == this->Layers[1]; });
  if (known != others.end()) {
    return *known;
  }
  const auto fits = [this](int one) {
    return this->LayerCount > 0 && (this->File.LengthOf(one) == this->LayerCount || this->File.LengthOf(one) == this->LayerCount + 1);
  };
  return std::count_if(others.begin(), others.end(), fits) == 1 ? *std::find_if(others.begin(), others.end(), fits) : -2;
}

std::string vtkStratusUgridMesh::DescribeOthers(const Variable& variable) const
{
  std::string text;
  for (int dimension : variable.Dimensions) {
    text += this->File.IsSelected(dimension) ? this->File.DescribeIndex(dimension) : "";
  }
  for (int dimension : this->FindOthers(variable)) {
    text += dimension != this->FindLayers(variable) ? this->File.DescribeIndex(dimension) : "";
  }
  return text;
}

int vtkStratusUgridMesh::FindTime(const Variable& variable) const
{
  const auto found =
    std::find_if(variable.Dimensions.begin(), variable.Dimensions.end(), [this](int dimension) { return this->IsTime(dimension); });
  return found == variable.Dimensions.end() ? -1 : *found;
}

// An unlimited dimension without coordinates is a time, too, because neither meshes nor layers grow.
bool vtkStratusUgridMesh::IsTime(int dimension) const
{
  const bool grows = this->File.IsUnlimited(dimension) && !this->File.CoordinateOf(dimension) && !this->File.IsSelected(dimension);
  return this->File.IsTime(dimension) || (grows && this->File.LengthOf(dimension) > 1 && !this->IsPlace(dimension));
}

vtkStratusUgridValues vtkStratusUgridMesh::Read(const Variable& variable, size_t step) const
{
  const int layers = this->FindLayers(variable);
  std::vector<size_t> start, count;
  for (int dimension : variable.Dimensions) {
    const bool time = this->IsTime(dimension);
    const bool whole = this->IsPlace(dimension) || dimension == layers;
    start.push_back(whole ? 0 : time ? std::min(step, this->File.LengthOf(dimension) - 1) : this->File.IndexOf(dimension));
    count.push_back(whole ? this->File.LengthOf(dimension) : 1);
  }
  vtkStratusUgridValues result;
  size_t stride = 1;
  for (size_t i = count.size(); i-- > 0;) {
    const int dimension = variable.Dimensions[i];
    if (this->IsPlace(dimension)) {
      result.Across = stride;
    } else if (dimension == layers) {
      result.Along = stride;
    }
    stride *= count[i];
  }
  const bool nodes = this->IsOnNodes(variable), more_nodes = nodes && this->NodeOf.size() > this->File.LengthOf(this->NodeDimension),
             more_faces = !nodes && this->IsOnFaces(variable) && this->FaceOf.size() > this->File.LengthOf(this->FaceDimension);
  result.Places = more_nodes ? &this->NodeOf : more_faces ? &this->FaceOf : nullptr;
  result.Values = this->File.Read(variable, start, count);
  return result;
}

std::vector<double> vtkStratusUgridMesh::ReadAtNodes(const Variable& variable, size_t step) const
{
  return this->ToNodes(this->Read(variable, step), this->IsOnFaces(variable), 0);
}

std::vector<double> vtkStratusUgridMesh::ToNodes(const vtkStratusUgridValues& values, bool on_faces, size_t layer) const
{
  std::vector<double> result(this->GetNodes(), 0.0);
  if (!on_faces) {
    for (size_t node = 0; node < result.size(); ++node) {
      result[node] = values.At(node, layer);
    }
    return result;
  }
  // means over the file's faces, before nodes that are between others
  stratus_faces view = this->ViewFaces(this->Absent);
  if (!this->FileOffsets.empty()) {
    view.face_count = static_cast<int64_t>(this->FileOffsets.size() - 1);
    view.offsets = const_cast<int64_t*>(this->FileOffsets.data());
    view.nodes = const_cast<int32_t*>(this->FileCorners.data());
  }
  std::vector<double> of_faces(static_cast<size_t>(view.face_count));
  for (size_t face = 0; face < of_faces.size(); ++face) {
    of_faces[face] = values.AtFile(face, layer);
  }
  const vtkStratusReaderCore core;
  core.Check(stratus_faces_to_nodes(core, &view, of_faces.data(), result.data()));
  for (size_t node = 0; node < result.size(); ++node) {
    const vtkStratusUgridPlace& of = this->NodeOf[node];
    result[node] = of.First == of.Second ? result[of.First] : of.Weight * result[of.First] + (1.0 - of.Weight) * result[of.Second];
  }
  return result;
}
