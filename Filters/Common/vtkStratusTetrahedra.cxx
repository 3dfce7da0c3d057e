// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusTetrahedra.h"

#include "vtkStratusArrays.h"
#include "vtkStratusVersions.h"

#include "vtkAbstractArray.h"
#include "vtkCell.h"
#include "vtkCellType.h"
#include "vtkDataSetAttributes.h"
#include "vtkGenericCell.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cstddef>

namespace {
constexpr vtkIdType NumbersMax = 2147483647;
constexpr int Types = 256;

// Divides a face into a fan of triangles around its lowest point number, so that both cells at the face divide it alike.
template <typename Function> void Fan(const std::vector<vtkIdType>& face, Function&& function)
{
  const size_t count = face.size();
  const size_t lowest = static_cast<size_t>(std::min_element(face.begin(), face.end()) - face.begin());
  for (size_t i = 1; i + 1 < count; ++i) {
    function(face[lowest], face[(lowest + i) % count], face[(lowest + i + 1) % count]);
  }
}

// Divides a face whose points come in VTK's order: corners, edge midpoints, the face's centre. Without a centre, triangles cut off the
// corners, so that none is degenerate where edges are straight.
template <typename Function> void DivideQuadraticFace(int type, const std::vector<vtkIdType>& p, Function&& function)
{
  if (type == VTK_QUADRATIC_LINEAR_QUAD) { // its second and fourth edge have no midpoint
    Fan({ p[0], p[4], p[5], p[3] }, function);
    Fan({ p[4], p[1], p[2], p[5] }, function);
    return;
  }
  const size_t corners = type == VTK_QUADRATIC_TRIANGLE || type == VTK_BIQUADRATIC_TRIANGLE ? 3 : 4;
  const bool middle = p.size() > 2 * corners;
  for (size_t i = 0; i < corners; ++i) {
    const vtkIdType before = p[corners + (i + corners - 1) % corners], after = p[corners + i];
    if (middle) {
      function(before, p[i], p.back());
      function(p[i], after, p.back());
    } else {
      function(before, p[i], after);
    }
  }
  if (!middle) {
    Fan(std::vector<vtkIdType>(p.begin() + static_cast<std::ptrdiff_t>(corners), p.end()), function);
  }
}

std::string NameCell(vtkIdType cell, int type)
{
  return "cell " + std::to_string(cell) + " is a " + vtkStratusNameOfCellType(type) + " (" + std::to_string(type) + ")";
}
} // namespace

// Properties of a VTK cell type, looked up once.
struct vtkStratusTetrahedra::Kind {
  enum { Unknown, Flat, Linear, Quadratic, Curved, Polyhedron, ConvexPointSet } Way = Unknown;
  vtkIdType Points = 0;
  struct Side {
    int Type;
    Face Nodes; // anticlockwise as seen from outside
  };
  std::vector<Side> Sides;
  vtkIdType Inner = -1;        // the node that is on no side, -1: none
  std::vector<double> Weights; // shape functions of all nodes at the cell's centre, where no node is there

  explicit Kind(int type = VTK_EMPTY_CELL);
};

vtkStratusTetrahedra::Kind::Kind(int type)
{
  if (type == VTK_EMPTY_CELL || type == VTK_CONVEX_POINT_SET || type == VTK_POLYHEDRON) {
    this->Way = type == VTK_EMPTY_CELL ? Flat : type == VTK_POLYHEDRON ? Polyhedron : ConvexPointSet;
    return;
  }
  const auto cell = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(type));
  if (!cell || cell->GetCellDimension() < 3) {
    this->Way = cell ? Flat : Unknown;
    return;
  }
  if (type > VTK_TRIQUADRATIC_PYRAMID) { // arbitrary order or parametric
    this->Way = IsCurved(type) ? Curved : Unknown;
    return;
  }
  this->Way = cell->IsLinear() ? Linear : Quadratic;
  this->Points = cell->GetNumberOfPoints();
  std::vector<bool> outer(static_cast<size_t>(this->Points), false);
  for (vtkIdType i = 0; i < this->Points; ++i) {
    cell->GetPointIds()->SetId(i, i);
  }
  for (int f = 0; f < cell->GetNumberOfFaces(); ++f) {
    vtkCell* face = cell->GetFace(f);
    Side side = { face->GetCellType(), Face(face->GetPointIds()->begin(), face->GetPointIds()->end()) };
    if (side.Type == VTK_PIXEL) { // VTK_PIXEL lists its points row by row, not around the face
      std::swap(side.Nodes[2], side.Nodes[3]);
    }
    for (vtkIdType node : side.Nodes) {
      outer[static_cast<size_t>(node)] = true;
    }
    this->Sides.push_back(side);
  }
  const auto inner = std::find(outer.begin(), outer.end(), false);
  if (inner != outer.end()) {
    this->Inner = inner - outer.begin();
  } else if (this->Way == Quadratic) {
    double middle[3];
    this->Weights.resize(outer.size());
    cell->GetParametricCenter(middle);
    cell->InterpolateFunctions(middle, this->Weights.data());
  }
}

const vtkStratusTetrahedra::Kind& vtkStratusTetrahedra::GetKind(int type)
{
  static const std::vector<Kind> kinds = [] {
    std::vector<Kind> all;
    for (int t = 0; t < Types; ++t) {
      all.emplace_back(t);
    }
    return all;
  }();
  return kinds[static_cast<size_t>(type) % Types];
}

// Leaves out a tetrahedron with a repeated point. A cell degenerated from another type, as a wedge stored as a hexahedron, yields such
// pieces.
void vtkStratusTetrahedra::AddPiece(vtkIdType a, vtkIdType b, vtkIdType c, vtkIdType d, vtkIdType cell)
{
  if (a == b || a == c || a == d || b == c || b == d || c == d) {
    return;
  }
  for (const vtkIdType point : { a, b, c, d }) {
    this->Vertices.push_back(static_cast<int32_t>(point));
  }
  this->Cells.push_back(cell);
}

// Divides a cell into a fan of tetrahedra around its lowest point number. That point is also the lowest of each of its faces, so that the
// neighbour divides these faces alike.
void vtkStratusTetrahedra::AddLinear(const std::vector<Face>& faces, vtkIdType cell)
{
  vtkIdType apex = VTK_ID_MAX;
  for (const Face& face : faces) {
    apex = face.empty() ? apex : std::min(apex, *std::min_element(face.begin(), face.end()));
  }
  for (const Face& face : faces) {
    if (face.size() > 2 && std::find(face.begin(), face.end(), apex) == face.end()) {
      Fan(face, [&](vtkIdType p, vtkIdType q, vtkIdType r) { this->AddPiece(p, r, q, apex, cell); });
    }
  }
}

vtkIdType vtkStratusTetrahedra::AddMiddle(const Kind& kind, const vtkIdType* ids)
{
  double x[3] = { 0.0, 0.0, 0.0 };
  this->Middles.push_back({ this->MiddleNodes.size(), &kind.Weights, static_cast<vtkIdType>(this->Points.size() / 3) });
  for (vtkIdType i = 0; i < kind.Points; ++i) {
    this->MiddleNodes.push_back(ids[i]);
    for (int a = 0; a < 3; ++a) {
      x[a] += kind.Weights[static_cast<size_t>(i)] * this->Points[static_cast<size_t>(3 * ids[i] + a)];
    }
  }
  this->Points.insert(this->Points.end(), x, x + 3);
  return static_cast<vtkIdType>(this->Points.size() / 3) - 1;
}

void vtkStratusTetrahedra::AddQuadratic(const Kind& kind, const vtkIdType* ids, vtkIdType cell)
{
  if (kind.Points == 10) {
    // Nodes 0..3 are corners, nodes 4..9 the midpoints of edges 01 12 20 03 13 23. Four tetrahedra are at the corners, four around the line
    // from node 4 to node 9.
    static const int parts[8][4] = { { 0, 4, 6, 7 }, { 4, 1, 5, 8 }, { 6, 5, 2, 9 }, { 7, 8, 9, 3 }, { 4, 9, 6, 7 }, { 4, 9, 7, 8 },
      { 4, 9, 8, 5 }, { 4, 9, 5, 6 } };
    for (const auto& part : parts) {
      this->AddPiece(ids[part[0]], ids[part[1]], ids[part[2]], ids[part[3]], cell);
    }
    return;
  }
  const vtkIdType apex = kind.Inner >= 0 ? ids[kind.Inner] : this->AddMiddle(kind, ids);
  Face face;
  for (const Kind::Side& side : kind.Sides) {
    face.clear();
    for (vtkIdType node : side.Nodes) {
      face.push_back(ids[node]);
    }
    DivideQuadraticFace(side.Type, face, [&](vtkIdType p, vtkIdType q, vtkIdType r) { this->AddPiece(p, r, q, apex, cell); });
  }
}

void vtkStratusTetrahedra::AddPolyhedron(vtkUnstructuredGrid* grid, vtkIdType cell)
{
  vtkNew<vtkIdList> numbers; // of faces, then the size and the points of each
  grid->GetFaceStream(cell, numbers);
  std::vector<Face> faces(static_cast<size_t>(numbers->GetId(0)));
  const vtkIdType* stream = numbers->GetPointer(1);
  for (Face& face : faces) {
    face.assign(stream + 1, stream + 1 + *stream);
    stream += 1 + *stream;
  }
  this->AddLinear(faces, cell);
}

void vtkStratusTetrahedra::AddConvexPointSet(vtkUnstructuredGrid* grid, vtkIdType cell)
{
  vtkNew<vtkGenericCell> generic;
  grid->GetCell(cell, generic);
  std::vector<Face> faces(static_cast<size_t>(generic->GetNumberOfFaces()));
  for (int f = 0; f < generic->GetNumberOfFaces(); ++f) {
    vtkIdList* ids = generic->GetFace(f)->GetPointIds();
    faces[static_cast<size_t>(f)].assign(ids->begin(), ids->end());
  }
  this->AddLinear(faces, cell);
}

bool vtkStratusTetrahedra::AddCell(vtkUnstructuredGrid* grid, vtkIdType cell, std::string& error)
{
  const int type = grid->GetCellType(cell);
  const Kind& kind = GetKind(type);
  if (kind.Way == Kind::Flat) {
    ++this->LeftOut;
    return true;
  }
  if (kind.Way == Kind::Unknown) {
    error = NameCell(cell, type) + ", only linear, quadratic, Lagrange and Bezier cells can be divided into tetrahedra";
    return false;
  }
  vtkIdType count = 0;
  const vtkIdType* ids = nullptr;
  grid->GetCellPoints(cell, count, ids);
  if (kind.Points > 0 && count != kind.Points) {
    error = NameCell(cell, type) + " of " + std::to_string(count) + " points, it must have " + std::to_string(kind.Points);
    return false;
  }
  if (type == VTK_TETRA) { // kept as it is, even if degenerate
    this->Vertices.insert(this->Vertices.end(), ids, ids + 4);
    this->Cells.push_back(cell);
  } else if (kind.Way == Kind::Curved) {
    if (!this->AddCurved(grid, cell, count, ids, error)) {
      error = NameCell(cell, type) + " " + error;
      return false;
    }
  } else if (kind.Way == Kind::Quadratic) {
    this->AddQuadratic(kind, ids, cell);
  } else if (kind.Way == Kind::Polyhedron) {
    this->AddPolyhedron(grid, cell);
  } else if (kind.Way == Kind::ConvexPointSet) {
    this->AddConvexPointSet(grid, cell);
  } else {
    std::vector<Face>& faces = this->Faces;
    faces.resize(kind.Sides.size());
    for (size_t f = 0; f < faces.size(); ++f) {
      faces[f].clear();
      for (vtkIdType node : kind.Sides[f].Nodes) {
        faces[f].push_back(ids[node]);
      }
    }
    this->AddLinear(faces, cell);
  }
  return true;
}

bool vtkStratusTetrahedra::Set(vtkUnstructuredGrid* grid, std::string& error)
{
  const vtkIdType cells = grid->GetNumberOfCells();
  *this = vtkStratusTetrahedra();
  this->GridPoints = grid->GetNumberOfPoints();
  if (this->GridPoints > NumbersMax || cells > NumbersMax / 2) {
    error = "the grid has " + std::to_string(this->GridPoints) + " points and " + std::to_string(cells) +
      " cells, at most 2^31-1 and 2^30-1 are allowed";
    return false;
  }
  if (!vtkStratusCheckGrid(grid, error)) {
    return false;
  }
  this->Points.resize(static_cast<size_t>(3 * this->GridPoints));
  for (vtkIdType i = 0; i < this->GridPoints; ++i) {
    grid->GetPoint(i, &this->Points[static_cast<size_t>(3 * i)]);
  }
  this->Vertices.reserve(static_cast<size_t>(4 * cells));
  this->Cells.reserve(static_cast<size_t>(cells));
  for (vtkIdType c = 0; c < cells; ++c) {
    if (!this->AddCell(grid, c, error)) {
      return false;
    }
    this->CellByCell = this->CellByCell && grid->GetCellType(c) == VTK_TETRA;
  }
  if (this->Cells.size() > NumbersMax / 2 || this->Points.size() / 3 > static_cast<size_t>(NumbersMax)) {
    error = "the grid's " + std::to_string(cells) + " cells are " + std::to_string(this->Cells.size()) + " tetrahedra of " +
      std::to_string(this->Points.size() / 3) + " points, at most 2^30-1 and 2^31-1 are allowed";
    return false;
  }
  return true;
}

stratus_mesh vtkStratusTetrahedra::GetMesh() const
{
  stratus_mesh mesh = stratus_mesh_default();
  mesh.points = this->Points.data();
  mesh.point_count = static_cast<int64_t>(this->Points.size() / 3);
  mesh.vertices = this->Vertices.data();
  mesh.cell_count = static_cast<int64_t>(this->Vertices.size() / 4);
  return mesh;
}

std::string vtkStratusTetrahedra::DescribeLeftOut() const
{
  return "the grid has no cell with a volume: " + std::to_string(this->LeftOut) + " are vertices, lines, polygons or empty";
}

void vtkStratusTetrahedra::CopyPointValues(vtkAbstractArray* from, vtkAbstractArray* to) const
{
  vtkNew<vtkIdList> nodes;
  if (this->GridPoints > 0) {
    to->InsertTuples(0, this->GridPoints, 0, from);
  }
  auto* flags = vtkUnsignedCharArray::SafeDownCast(to);
  if (flags && (!to->GetName() || std::string(to->GetName()) != vtkDataSetAttributes::GhostArrayName())) {
    flags = nullptr;
  }
  for (const Middle& middle : this->Middles) {
    const std::vector<double>& weights = *middle.Weights;
    nodes->SetNumberOfIds(static_cast<vtkIdType>(weights.size()));
    for (size_t i = 0; i < weights.size(); ++i) {
      nodes->SetId(static_cast<vtkIdType>(i), this->MiddleNodes[middle.Node + i]);
    }
    const vtkIdType at = middle.At;
    if (flags && at < this->GridPoints) {
      continue; // a node of a Bezier cell keeps its own
    }
    if (flags) { // a ghost flag is set where all nodes have it
      unsigned char all = 255;
      for (vtkIdType node : *nodes) {
        all = static_cast<unsigned char>(all & flags->GetValue(node));
      }
      flags->SetValue(at, all);
    } else {
      to->InterpolateTuple(at, nodes, from, const_cast<double*>(weights.data()));
    }
  }
}
