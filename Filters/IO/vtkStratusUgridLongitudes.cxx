// SPDX-License-Identifier: BSD-3-Clause
// Longitudes of a mesh on the plane: continuous where the mesh spans less than the Earth. Around it, faces are cut at a meridian, and poles
// are lines, so that faces are once over each place.
#include "vtkStratusUgridMesh.h"

#include "vtkStratusLongitudes.h"
#include "vtkStratusReaderCore.h"

#include <algorithm>
#include <cmath>

namespace {
constexpr double NearPole = 1e-4; // degrees, which is some ten metres
} // namespace

bool vtkStratusUgridMesh::IsPole(int node) const
{
  return std::fabs(this->Y[static_cast<size_t>(node)]) > 90.0 - NearPole;
}

// Returns the copy of a node at another longitude.
int vtkStratusUgridMesh::CopyOf(const Corner& corner)
{
  if (this->X[static_cast<size_t>(corner.Node)] == corner.Longitude) {
    return corner.Node;
  }
  const auto added = this->Copies.insert({ { corner.Node, corner.Node, corner.Longitude }, static_cast<int>(this->X.size()) });
  if (added.second) {
    const double latitude = this->Y[static_cast<size_t>(corner.Node)];
    const vtkStratusUgridPlace of = this->NodeOf[static_cast<size_t>(corner.Node)];
    this->X.push_back(corner.Longitude);
    this->Y.push_back(latitude);
    this->NodeOf.push_back(of);
  }
  return added.first->second;
}

// Returns the node where a meridian meets the edge between two corners, whose values are between theirs.
int vtkStratusUgridMesh::NodeBetween(Corner a, Corner b, double meridian, double longitude)
{
  if (b.Node < a.Node) {
    std::swap(a, b);
  }
  const auto added = this->Copies.insert({ { a.Node, b.Node, longitude }, static_cast<int>(this->X.size()) });
  if (added.second) {
    const double weight = (b.Longitude - meridian) / (b.Longitude - a.Longitude); // of a
    const size_t first = static_cast<size_t>(a.Node), second = static_cast<size_t>(b.Node);
    const double latitude = weight * this->Y[first] + (1.0 - weight) * this->Y[second];
    const vtkStratusUgridPlace of = { this->NodeOf[first].First, this->NodeOf[second].First, weight };
    this->X.push_back(longitude);
    this->Y.push_back(latitude);
    this->NodeOf.push_back(of);
  }
  return added.first->second;
}

// Makes longitudes continuous over a mesh that spans less than the Earth. Around the Earth faces are cut where the file's longitudes jump,
// at 0 or 180 degrees. The longitude of a node at a pole means nothing.
void vtkStratusUgridMesh::JoinLongitudes()
{
  const auto edges = [this](const std::function<void(size_t, size_t)>& call) {
    for (size_t face = 0; face < this->GetFaces(); ++face) {
      int count = 0;
      const int* corners = this->GetFace(face, count);
      for (int c = 0; c < count; ++c) {
        const int next = corners[(c + 1) % count];
        if (!this->IsPole(corners[c]) && !this->IsPole(next)) {
          call(static_cast<size_t>(corners[c]), static_cast<size_t>(next));
        }
      }
    }
  };
  const auto jumps = [&edges](const std::vector<double>& longitudes) {
    bool any = false;
    edges([&](size_t a, size_t b) { any = any || std::fabs(longitudes[a] - longitudes[b]) > 180.0; });
    return any;
  };
  bool around = jumps(this->X);
  if (around) {
    std::vector<double> continuous = this->X;
    vtkStratusLongitudes::Unwrap(continuous, edges);
    if (!jumps(continuous)) {
      this->X = continuous;
      around = false;
      this->Description += ", longitudes made continuous where they jump";
    }
  }
  const double west = *std::max_element(this->X.begin(), this->X.end()) > 180.0 ? 0.0 : -180.0;
  for (size_t node = 0; around && node < this->X.size(); ++node) {
    this->X[node] -= 360.0 * std::floor((this->X[node] - west) / 360.0);
  }
  const std::vector<int64_t> offsets = this->Offsets;
  const std::vector<int32_t> corners = std::move(this->Corners);
  std::vector<std::vector<int>> further; // parts of faces behind the first
  std::vector<size_t> of;
  this->Offsets.assign(1, 0);
  this->Corners.clear();
  for (size_t face = 0; face + 1 < offsets.size(); ++face) {
    const auto first = corners.begin() + offsets[face], end = corners.begin() + offsets[face + 1];
    std::vector<std::vector<int>> parts;
    for (const Polygon& part : this->Unfold({ first, end })) {
      this->Cut(part, around, west, parts);
    }
    if (parts.empty() || this->IsAbsent(face)) {
      parts.assign(1, { first, end });
    }
    this->Corners.insert(this->Corners.end(), parts[0].begin(), parts[0].end());
    this->Offsets.push_back(static_cast<int64_t>(this->Corners.size()));
    for (size_t i = 1; i < parts.size(); ++i) {
      further.push_back(parts[i]);
      of.push_back(face);
    }
  }
  for (size_t i = 0; i < further.size(); ++i) {
    this->Corners.insert(this->Corners.end(), further[i].begin(), further[i].end());
    this->Offsets.push_back(static_cast<int64_t>(this->Corners.size()));
    this->FaceOf.push_back({ of[i], of[i], 1.0 });
    this->Absent.push_back(0);
  }
  this->Description += around ? ", faces cut at longitude " + vtkStratusNumberText(west) : "";
}

// The corners of a face with continuous longitudes. A corner at a pole becomes an edge as wide as its neighbours are apart, because on the
// plane a pole is a line. A face around a pole becomes quadrangles between each of its edges and the pole, whose values are the nearest
// node's.
std::vector<vtkStratusUgridMesh::Polygon> vtkStratusUgridMesh::Unfold(const std::vector<int>& face)
{
  std::vector<int> nodes = face;
  const auto start = std::find_if(nodes.begin(), nodes.end(), [this](int node) { return !this->IsPole(node); });
  if (start == nodes.end()) {
    return {};
  }
  std::rotate(nodes.begin(), start, nodes.end());
  Polygon polygon;
  double last = this->X[static_cast<size_t>(nodes[0])];
  for (size_t i = 0; i <= nodes.size(); ++i) { // the first again, for the turns around the face
    const int node = nodes[i % nodes.size()];
    if (this->IsPole(node)) {
      polygon.push_back({ node, last });
      continue;
    }
    const double longitude = this->X[static_cast<size_t>(node)] - 360.0 * std::round((this->X[static_cast<size_t>(node)] - last) / 360.0);
    if (!polygon.empty() && this->IsPole(polygon.back().Node) && longitude != last) {
      polygon.push_back({ polygon.back().Node, longitude });
    }
    polygon.push_back({ node, longitude });
    last = longitude;
  }
  const bool pole = std::any_of(nodes.begin(), nodes.end(), [this](int node) { return this->IsPole(node); });
  if (pole || std::fabs(polygon.back().Longitude - polygon.front().Longitude) < 180.0) {
    polygon.pop_back();
    return { polygon };
  }
  const int nearest = *std::max_element(nodes.begin(), nodes.end(),
    [this](int a, int b) { return std::fabs(this->Y[static_cast<size_t>(a)]) < std::fabs(this->Y[static_cast<size_t>(b)]); });
  const double latitude = std::copysign(90.0, this->Y[static_cast<size_t>(nearest)]);
  const int at = static_cast<int>(this->X.size());
  const vtkStratusUgridPlace of = this->NodeOf[static_cast<size_t>(nearest)];
  this->X.push_back(this->X[static_cast<size_t>(nearest)]);
  this->Y.push_back(latitude);
  this->NodeOf.push_back(of);
  std::vector<Polygon> parts;
  for (size_t i = 0; i + 1 < polygon.size(); ++i) {
    parts.push_back({ polygon[i], polygon[i + 1], { at, polygon[i + 1].Longitude }, { at, polygon[i].Longitude } });
  }
  return parts;
}

// Adds the parts of a polygon within each turn from `west` on.
void vtkStratusUgridMesh::Cut(const Polygon& polygon, bool around, double west, std::vector<std::vector<int>>& parts)
{
  const auto order = [](const Corner& a, const Corner& b) { return a.Longitude < b.Longitude; };
  const auto ends = std::minmax_element(polygon.begin(), polygon.end(), order);
  const double low = around ? std::floor((ends.first->Longitude - west) / 360.0) : 0.0,
               high = around ? std::ceil((ends.second->Longitude - west) / 360.0) : 1.0;
  for (double turn = low; turn < high; turn += 1.0) {
    const double shift = around ? 360.0 * turn : 0.0, begin = west + shift, end = begin + 360.0;
    std::vector<int> part;
    const auto add = [&part](int node) {
      if (part.empty() || (part.back() != node && part.front() != node)) {
        part.push_back(node);
      }
    };
    for (size_t i = 0; i < polygon.size(); ++i) {
      const Corner &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      if (!around || (a.Longitude >= begin && a.Longitude <= end)) {
        add(this->CopyOf({ a.Node, a.Longitude - shift }));
      }
      const bool eastwards = a.Longitude < b.Longitude;
      for (const double meridian : { eastwards ? begin : end, eastwards ? end : begin }) {
        if (around && (a.Longitude - meridian) * (b.Longitude - meridian) < 0.0) {
          add(this->NodeBetween(a, b, meridian, meridian - shift));
        }
      }
    }
    if (part.size() >= 3) {
      parts.push_back(part);
    }
  }
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
