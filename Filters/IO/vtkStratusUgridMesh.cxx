// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusUgridMesh.h"

#include "vtkStratusLongitudes.h"
#include "vtkStratusSphere.h"
#include "vtkStratusUnits.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

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
  return found;
}

vtkStratusUgridMesh::vtkStratusUgridMesh(const vtkStratusNetCDFModel& file) : File(file)
{
  const Variable* topology = FindTopology(file);
  if (!topology) {
    file.Fail("there is no mesh: no variable of cf_role mesh_topology and topology_dimension 2, and no 'nv' of FVCOM");
  }
  this->Topology = topology;
  const bool fvcom = topology->Dimensions.size() == 2 && topology->BaseName() == "nv" && file.Text(*topology, "cf_role") != "mesh_topology";
  const auto named = [&](const std::string& name, const char* what) -> const Variable& {
    const Variable* one = name.empty() ? nullptr : file.Find(name, topology);
    if (!one) {
      file.Fail("the mesh '" + topology->Name + "' has no " + what + (name.empty() ? "" : ": there is no variable '" + name + "'"));
    }
    return *one;
  };
  if (fvcom) {
    const Variable* x = file.Find("x", topology);
    const std::vector<double> own = x && x->Dimensions.size() == 1 ? file.ReadComplete(*x, "coordinate") : std::vector<double>();
    const bool plane = std::any_of(own.begin(), own.end(), [](double one) { return one != 0.0; }); // FVCOM writes zeros on a sphere
    this->ReadNodes(named(plane ? "x" : "lon", "coordinates"), named(plane ? "y" : "lat", "coordinates"));
    this->ReadFaces(*topology, 1);
    return;
  }
  const std::vector<std::string> coordinates = vtkStratusWords(file.Text(*topology, "node_coordinates"));
  const Variable& first = named(coordinates.size() > 1 ? coordinates[0] : "", "node_coordinates of two variables");
  const Variable& second = named(coordinates[1], "node_coordinates of two variables");
  const std::string name = file.Text(first, "standard_name");
  const bool turned = name == "latitude" || name == "projection_y_coordinate";
  this->ReadNodes(turned ? second : first, turned ? first : second);
  this->ReadFaces(named(file.Text(*topology, "face_node_connectivity"), "face_node_connectivity"), 0);
}

void vtkStratusUgridMesh::ReadNodes(const Variable& x, const Variable& y)
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
  const vtkStratusUnit unit = vtkStratusUnitOf(this->File.Text(x, "units"));
  this->Metres = unit.IsLength() || unit.IsAngle();
  this->Degrees = unit.IsAngle();
  for (std::vector<double>* at : { &this->X, &this->Y }) {
    std::transform(at->begin(), at->end(), at->begin(), [&unit](double one) { return unit.Convert(one); });
  }
  this->NodeOf.resize(this->X.size());
  std::iota(this->NodeOf.begin(), this->NodeOf.end(), size_t{ 0 });
  if (this->Degrees) {
    const auto ends = std::minmax_element(this->Y.begin(), this->Y.end());
    const double degree = std::acos(-1.0) / 180.0, middle = 0.5 * (*ends.first + *ends.second);
    this->Factors = { { vtkStratusSphere::EarthRadius * degree * std::cos(middle * degree), vtkStratusSphere::EarthRadius * degree } };
    this->Description = "degrees as metres at latitude " + vtkStratusNumberText(middle) + "; ";
  }
  this->Description += "nodes at '" + x.Name + "' and '" + y.Name + "'";
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
    if (this->File.IsSelected(dimension)) {
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
  const vtkSmartPointer<vtkDataArray> numbers = this->File.Read(connectivity);
  std::vector<int> face;
  for (size_t f = 0; f < faces; ++f) {
    face.clear();
    for (size_t c = 0; c < corners; ++c) {
      const double number = numbers->GetComponent(static_cast<vtkIdType>(turned ? c * faces + f : f * corners + c), 0);
      if (std::isnan(number)) {
        continue;
      }
      const double node = number - start;
      if (!(node >= 0.0 && node < static_cast<double>(this->GetNodes())) || node != std::floor(node)) {
        this->File.Fail("face " + std::to_string(f) + " names node " + vtkStratusNumberText(number) + ", the nodes are " +
          vtkStratusNumberText(start) + " to " + vtkStratusNumberText(start + static_cast<double>(this->GetNodes()) - 1));
      }
      face.push_back(static_cast<int>(node));
    }
    if (face.size() < 3) {
      this->File.Fail("face " + std::to_string(f) + " has " + std::to_string(face.size()) + " nodes, at least 3 are needed");
    }
    this->Corners.insert(this->Corners.end(), face.begin(), face.end());
    this->Offsets.push_back(this->Corners.size());
  }
  if (this->Degrees) {
    this->JoinLongitudes();
  }
  for (size_t node = 0; node < this->X.size(); ++node) {
    this->X[node] *= this->Factors[0];
    this->Y[node] *= this->Factors[1];
  }
  this->TurnFaces();
}

// Makes longitudes continuous over a mesh that spans less than the Earth. Around the Earth they stay as they are, and faces across the
// meridian where they jump get copies of nodes.
void vtkStratusUgridMesh::JoinLongitudes()
{
  const auto edges = [this](const std::function<void(size_t, size_t)>& call) {
    for (size_t face = 0; face < this->GetFaces(); ++face) {
      for (size_t c = this->Offsets[face]; c < this->Offsets[face + 1]; ++c) {
        const size_t next = c + 1 < this->Offsets[face + 1] ? c + 1 : this->Offsets[face];
        call(static_cast<size_t>(this->Corners[c]), static_cast<size_t>(this->Corners[next]));
      }
    }
  };
  const auto jumps = [&edges](const std::vector<double>& longitudes) {
    bool any = false;
    edges([&](size_t a, size_t b) { any = any || std::fabs(longitudes[a] - longitudes[b]) > 180.0; });
    return any;
  };
  if (!jumps(this->X)) {
    return;
  }
  std::vector<double> continuous = this->X;
  vtkStratusLongitudes::Unwrap(continuous, edges);
  if (!jumps(continuous)) {
    this->X = continuous;
    this->Description += ", longitudes made continuous where they jump";
    return;
  }
  this->Torn.assign(this->GetFaces(), 0);
  for (size_t face = 0; face < this->GetFaces(); ++face) {
    this->Torn[face] = std::fabs(this->TurnsAround(face)) > 0.5 ? 1 : 0;
    if (!this->Torn[face]) {
      this->CopyNodes(face);
    }
  }
  this->Description += ", copies of nodes where longitudes jump";
}

// The turns that longitudes make around a face: 0, or 1 or -1 if the pole is in it.
double vtkStratusUgridMesh::TurnsAround(size_t face) const
{
  double turns = 0.0;
  for (size_t c = this->Offsets[face]; c < this->Offsets[face + 1]; ++c) {
    const size_t next = c + 1 < this->Offsets[face + 1] ? c + 1 : this->Offsets[face];
    const double part = (this->X[static_cast<size_t>(this->Corners[next])] - this->X[static_cast<size_t>(this->Corners[c])]) / 360.0;
    turns += part - std::round(part);
  }
  return turns;
}

// Puts copies into a face, a turn further east, of the nodes that are more than half a turn west of its easternmost one.
void vtkStratusUgridMesh::CopyNodes(size_t face)
{
  double low = INFINITY, high = -INFINITY;
  const auto longitude = [this](size_t c) { return this->X[static_cast<size_t>(this->Corners[c])]; };
  for (size_t c = this->Offsets[face]; c < this->Offsets[face + 1]; ++c) {
    low = std::min(low, longitude(c));
    high = std::max(high, longitude(c));
  }
  if (high - low <= 180.0) {
    return;
  }
  for (size_t c = this->Offsets[face]; c < this->Offsets[face + 1]; ++c) {
    if (high - longitude(c) > 180.0) {
      const int node = this->Corners[c];
      const auto added = this->Copies.insert({ node, static_cast<int>(this->X.size()) });
      if (added.second) {
        this->X.push_back(this->X[static_cast<size_t>(node)] + 360.0);
        this->Y.push_back(this->Y[static_cast<size_t>(node)]);
        this->NodeOf.push_back(static_cast<size_t>(node));
      }
      this->Corners[c] = added.first->second;
    }
  }
}

// Turns faces so that their corners are counterclockwise.
void vtkStratusUgridMesh::TurnFaces()
{
  for (size_t face = 0; face < this->GetFaces(); ++face) {
    const auto first = this->Corners.begin() + static_cast<std::ptrdiff_t>(this->Offsets[face]),
               end = this->Corners.begin() + static_cast<std::ptrdiff_t>(this->Offsets[face + 1]);
    const double x0 = this->X[static_cast<size_t>(*first)], y0 = this->Y[static_cast<size_t>(*first)];
    double area = 0.0;
    for (auto corner = first + 1; corner + 1 < end; ++corner) {
      const auto a = static_cast<size_t>(corner[0]), b = static_cast<size_t>(corner[1]);
      area += (this->X[a] - x0) * (this->Y[b] - y0) - (this->X[b] - x0) * (this->Y[a] - y0);
    }
    if (area < 0.0) {
      std::reverse(first, end);
    }
  }
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
  return variable.Name == this->XName || variable.Name == this->YName || variable.Name == this->Topology->Name ||
    std::any_of(std::begin(attributes), std::end(attributes), names);
}

bool vtkStratusUgridMesh::Has(const Variable& variable, int dimension) const
{
  return std::find(variable.Dimensions.begin(), variable.Dimensions.end(), dimension) != variable.Dimensions.end();
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
  result.Nodes = this->IsOnNodes(variable) && this->NodeOf.size() > this->File.LengthOf(this->NodeDimension) ? &this->NodeOf : nullptr;
  result.Values = this->File.Read(variable, start, count);
  return result;
}

std::vector<double> vtkStratusUgridMesh::ReadAtNodes(const Variable& variable, size_t step) const
{
  const vtkStratusUgridValues values = this->Read(variable, step);
  std::vector<double> result(this->GetNodes(), 0.0);
  if (!this->IsOnFaces(variable)) {
    for (size_t node = 0; node < result.size(); ++node) {
      result[node] = values.At(node, 0);
    }
    return result;
  }
  std::vector<int> around(this->GetNodes(), 0);
  for (size_t face = 0; face < this->GetFaces(); ++face) {
    const double value = values.At(face, 0);
    for (size_t c = this->Offsets[face]; c < this->Offsets[face + 1] && std::isfinite(value); ++c) {
      const size_t node = this->NodeOf[static_cast<size_t>(this->Corners[c])];
      result[node] += value;
      ++around[node];
    }
  }
  for (size_t node = 0; node < result.size(); ++node) {
    result[node] = this->NodeOf[node] < node ? result[this->NodeOf[node]] : around[node] > 0 ? result[node] / around[node] : NAN;
  }
  return result;
}
