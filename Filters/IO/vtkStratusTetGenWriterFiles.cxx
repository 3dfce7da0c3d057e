// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusTetGenWriterFiles.h"

#include "vtkStratusTetGenMesh.h"

#include "vtkCellData.h"
#include "vtkErrorCode.h"
#include "vtkFieldData.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace {
const vtkIdType MostColumns = 72;  // TetGen reads lines of up to 2047 bytes, and a number takes up to 25
const vtkIdType CornersALine = 64; // corners, for the same reason

[[noreturn]] void Fail(const std::string& text)
{
  throw vtkStratusTetGenError{ text, vtkErrorCode::UnknownError };
}

std::string Number(vtkIdType value)
{
  return std::to_string(value);
}

// Returns whether an array describes the mesh itself (markers, neighbours, ids, flags) rather than a quantity on it.
bool IsBookkeeping(const char* name)
{
  const char* const names[] = { "Marker", "Neighbors", "Facet", "vtkOriginalPointIds", "vtkOriginalCellIds", "vtkGhostType" };
  return name && std::any_of(std::begin(names), std::end(names), [name](const char* one) { return std::strcmp(one, name) == 0; });
}

vtkDataArray* FindMarker(vtkDataSetAttributes* data)
{
  vtkDataArray* marker = data->GetArray("Marker");
  return marker && marker->GetNumberOfComponents() == 1 ? marker : nullptr;
}

void PutCorners(vtkStratusTetGenOutput& output, vtkIdType count, const vtkIdType* corners, vtkIdType first)
{
  output.Put(count);
  for (vtkIdType corner = 0; corner < count; ++corner) {
    if (corner % CornersALine == CornersALine - 1) {
      output.EndLine();
    }
    output.Put(corners[corner] + first);
  }
}

double Finite(vtkDataArray* array, vtkIdType tuple, int component, const std::string& what)
{
  const double value = array->GetComponent(tuple, component);
  if (!std::isfinite(value)) {
    Fail(what + " hold " + std::to_string(value) + " in tuple " + Number(tuple) + ", TetGen's files take finite numbers only");
  }
  return value;
}
} // namespace

vtkStratusTetGenColumns::vtkStratusTetGenColumns(vtkDataSetAttributes* data, const char* what) : What(what), Marker(FindMarker(data))
{
  for (int index = 0; index < data->GetNumberOfArrays(); ++index) {
    vtkDataArray* array = data->GetArray(index);
    if (array && !IsBookkeeping(array->GetName())) {
      this->Attributes.push_back(array);
      this->Count += array->GetNumberOfComponents();
    }
  }
  if (this->Count > MostColumns) {
    Fail(this->What + " have " + Number(this->Count) + " components, TetGen's lines hold up to " + Number(MostColumns));
  }
}

void vtkStratusTetGenColumns::PutAttributes(vtkStratusTetGenOutput& output, vtkIdType tuple) const
{
  for (vtkDataArray* array : this->Attributes) {
    for (int component = 0; component < array->GetNumberOfComponents(); ++component) {
      const double value = array->GetComponent(tuple, component);
      if (!std::isfinite(value)) { // the message is built only where it is needed
        Finite(array, tuple, component, this->What + " '" + (array->GetName() ? array->GetName() : "") + "'");
      }
      output.Put(value);
    }
  }
}

void vtkStratusTetGenColumns::PutMarker(vtkStratusTetGenOutput& output, vtkIdType tuple) const
{
  if (!this->Marker) {
    return;
  }
  const double value = this->Marker->GetComponent(tuple, 0);
  if (!(value >= std::numeric_limits<int>::min() && value <= std::numeric_limits<int>::max() && value == std::floor(value))) {
    Fail(this->What + " 'Marker' hold " + std::to_string(value) + " in tuple " + Number(tuple) + ", markers are integers of 32 bits");
  }
  output.Put(static_cast<vtkIdType>(value));
}

void vtkStratusTetGenWriteNodes(vtkStratusTetGenOutput& output, vtkPointSet* points, vtkIdType first)
{
  const vtkStratusTetGenColumns columns(points->GetPointData(), "point data");
  const vtkIdType count = points->GetNumberOfPoints();
  for (const vtkIdType value : { count, vtkIdType(3), columns.Count, vtkIdType(columns.Marker ? 1 : 0) }) {
    output.Put(value);
  }
  output.EndLine();
  for (vtkIdType point = 0; point < count; ++point) {
    output.Put(first + point);
    for (int axis = 0; axis < 3; ++axis) {
      output.Put(Finite(points->GetPoints()->GetData(), point, axis, "coordinates"));
    }
    columns.PutAttributes(output, point);
    columns.PutMarker(output, point);
    output.EndLine();
  }
}

void vtkStratusTetGenWriteElements(vtkStratusTetGenOutput& output, vtkUnstructuredGrid* mesh, vtkIdType first)
{
  const vtkStratusTetGenColumns columns(mesh->GetCellData(), "cell data");
  const vtkIdType count = mesh->GetNumberOfCells();
  const int type = count ? mesh->GetCellType(0) : VTK_TETRA;
  const vtkIdType corners = type == VTK_TETRA ? 4 : 10;
  int corner_of_vtk[10];
  for (int corner = 0; corner < 10; ++corner) {
    corner_of_vtk[vtkStratusTetGenCorner[corner]] = corner;
  }
  for (const vtkIdType value : { count, corners, columns.Count }) {
    output.Put(value);
  }
  output.EndLine();
  for (vtkIdType cell = 0; cell < count; ++cell) {
    if (mesh->GetCellType(cell) != type || (type != VTK_TETRA && type != VTK_QUADRATIC_TETRA)) {
      Fail("cell " + Number(cell) + " is of type " + Number(mesh->GetCellType(cell)) + ", it must be a tetrahedron (" + Number(VTK_TETRA) +
        "), or all must be quadratic ones (" + Number(VTK_QUADRATIC_TETRA) + ")");
    }
    vtkIdType size = 0;
    const vtkIdType* points = nullptr;
    mesh->GetCells()->GetCellAtId(cell, size, points);
    if (size != corners) {
      Fail("cell " + Number(cell) + " has " + Number(size) + " points, a tetrahedron of type " + Number(type) + " has " + Number(corners));
    }
    output.Put(first + cell);
    for (vtkIdType corner = 0; corner < corners; ++corner) {
      output.Put(first + points[corner_of_vtk[corner]]);
    }
    columns.PutAttributes(output, cell);
    output.EndLine();
  }
}

void vtkStratusTetGenWriteNeighbors(vtkStratusTetGenOutput& output, vtkDataArray* neighbors, vtkIdType first)
{
  const vtkIdType count = neighbors->GetNumberOfTuples();
  output.Put(count);
  output.Put(vtkIdType(4));
  output.EndLine();
  for (vtkIdType cell = 0; cell < count; ++cell) {
    output.Put(first + cell);
    for (int corner = 0; corner < 4; ++corner) {
      const double neighbor = neighbors->GetComponent(cell, corner);
      if (!(neighbor >= -1.0 && neighbor < static_cast<double>(count))) {
        Fail("cell data 'Neighbors' hold " + std::to_string(neighbor) + " for cell " + Number(cell) + ", it must be in -1.." +
          Number(count - 1));
      }
      output.Put(neighbor < 0.0 ? vtkIdType(-1) : first + static_cast<vtkIdType>(neighbor));
    }
    output.EndLine();
  }
}

void vtkStratusTetGenWritePieces(vtkStratusTetGenOutput& output, vtkPolyData* surface, int corners, vtkIdType first)
{
  vtkCellArray* cells = corners == 3 ? surface->GetPolys() : surface->GetLines();
  const vtkIdType offset = surface->GetNumberOfVerts() + (corners == 3 ? surface->GetNumberOfLines() : 0);
  vtkStratusTetGenColumns columns(surface->GetCellData(), "cell data");
  const vtkIdType count = cells->GetNumberOfCells();
  output.Put(count);
  output.Put(vtkIdType(columns.Marker ? 1 : 0));
  output.EndLine();
  for (vtkIdType cell = 0; cell < count; ++cell) {
    vtkIdType size = 0;
    const vtkIdType* points = nullptr;
    cells->GetCellAtId(cell, size, points);
    if (size != corners) {
      Fail("cell " + Number(offset + cell) + " of the surface has " + Number(size) + " points, faces must have 3 and edges 2");
    }
    output.Put(first + cell);
    for (int corner = 0; corner < corners; ++corner) {
      output.Put(first + points[corner]);
    }
    columns.PutMarker(output, offset + cell);
    output.EndLine();
  }
}

namespace {
// Writes the facets, holes and regions of a surface.
class ComplexWriter
{
public:
  ComplexWriter(vtkStratusTetGenOutput& output, vtkPolyData* surface, bool smesh, vtkIdType first)
      : Output(output), Surface(surface), IsSmesh(smesh), First(first), Columns(surface->GetCellData(), "cell data")
  {
  }
  void FindFacets();
  void WriteFacets();
  void WriteSeeds(const char* name, int components);

private:
  struct Polygon {
    double Facet;
    vtkIdType Cell;
    vtkCellArray* Cells;
    vtkIdType Local; // number in its cell array
  };
  void WriteFacet(size_t begin, size_t end);
  size_t FacetEnd(size_t begin) const;
  std::vector<vtkIdType> FindHoles(double facet) const;

  vtkStratusTetGenOutput& Output;
  vtkPolyData* Surface;
  bool IsSmesh;
  vtkIdType First;
  vtkStratusTetGenColumns Columns;
  std::vector<Polygon> Polygons;
};

void ComplexWriter::FindFacets()
{
  vtkPolyData* surface = this->Surface;
  vtkDataArray* facets = surface->GetCellData()->GetArray("Facet");
  if (surface->GetNumberOfStrips() > 0) {
    Fail("the surface has " + Number(surface->GetNumberOfStrips()) + " strips, which vtkTriangleFilter makes triangles of");
  }
  vtkIdType cell = 0;
  for (vtkCellArray* cells : { surface->GetVerts(), surface->GetLines(), surface->GetPolys() }) {
    for (vtkIdType local = 0; local < cells->GetNumberOfCells(); ++local, ++cell) {
      const vtkIdType size = cells->GetCellSize(local);
      if (cells == surface->GetLines() && size != 2) {
        Fail("cell " + Number(cell) + " is a line of " + Number(size) + " points, it must have 2");
      }
      if (cells == surface->GetPolys() && size < 3) {
        Fail("cell " + Number(cell) + " is a polygon of " + Number(size) + " points, it must have at least 3");
      }
      if (cells != surface->GetVerts() || (facets && size == 1)) { // isolated points are in the point list already
        this->Polygons.push_back({ facets ? facets->GetComponent(cell, 0) : static_cast<double>(cell), cell, cells, local });
      }
    }
  }
  std::stable_sort(this->Polygons.begin(), this->Polygons.end(), [](const Polygon& a, const Polygon& b) { return a.Facet < b.Facet; });
}

size_t ComplexWriter::FacetEnd(size_t begin) const
{
  size_t end = begin + 1;
  while (end < this->Polygons.size() && this->Polygons[end].Facet == this->Polygons[begin].Facet) {
    ++end;
  }
  return end;
}

// Returns the tuples of "FacetHoles" that belong to this facet.
std::vector<vtkIdType> ComplexWriter::FindHoles(double facet) const
{
  std::vector<vtkIdType> tuples;
  vtkDataArray* holes = this->Surface->GetFieldData()->GetArray("FacetHoles");
  for (vtkIdType tuple = 0; holes && holes->GetNumberOfComponents() == 4 && tuple < holes->GetNumberOfTuples(); ++tuple) {
    if (holes->GetComponent(tuple, 0) == facet) {
      tuples.push_back(tuple);
    }
  }
  return tuples;
}

void ComplexWriter::WriteFacet(size_t begin, size_t end)
{
  const Polygon& lead = this->Polygons[begin];
  const std::vector<vtkIdType> holes = this->FindHoles(lead.Facet);
  if (this->IsSmesh && (end - begin > 1 || !holes.empty())) {
    Fail("facet " + Number(static_cast<vtkIdType>(lead.Facet)) + " has " + Number(static_cast<vtkIdType>(end - begin)) + " polygons and " +
      Number(static_cast<vtkIdType>(holes.size())) + " holes, which a .poly file can hold, but no .smesh file");
  }
  if (!this->IsSmesh) {
    this->Output.Put(static_cast<vtkIdType>(end - begin));
    this->Output.Put(static_cast<vtkIdType>(holes.size()));
    this->Columns.PutMarker(this->Output, lead.Cell);
    this->Output.EndLine();
  }
  for (size_t polygon = begin; polygon < end; ++polygon) {
    vtkIdType size = 0;
    const vtkIdType* points = nullptr;
    this->Polygons[polygon].Cells->GetCellAtId(this->Polygons[polygon].Local, size, points);
    PutCorners(this->Output, size, points, this->First);
    if (this->IsSmesh) {
      this->Columns.PutMarker(this->Output, lead.Cell);
    }
    this->Output.EndLine();
  }
  vtkDataArray* seeds = this->Surface->GetFieldData()->GetArray("FacetHoles");
  for (size_t hole = 0; hole < holes.size(); ++hole) {
    this->Output.Put(static_cast<vtkIdType>(hole) + this->First);
    for (int axis = 1; axis < 4; ++axis) {
      this->Output.Put(Finite(seeds, holes[hole], axis, "field data 'FacetHoles'"));
    }
    this->Output.EndLine();
  }
}

void ComplexWriter::WriteFacets()
{
  vtkIdType facets = 0;
  for (size_t begin = 0; begin < this->Polygons.size(); begin = this->FacetEnd(begin)) {
    ++facets;
  }
  this->Output.Put(facets);
  this->Output.Put(vtkIdType(this->Columns.Marker ? 1 : 0));
  this->Output.EndLine();
  for (size_t begin = 0; begin < this->Polygons.size(); begin = this->FacetEnd(begin)) {
    this->WriteFacet(begin, this->FacetEnd(begin));
  }
}

// Writes holes or regions, one tuple per line.
void ComplexWriter::WriteSeeds(const char* name, int components)
{
  vtkDataArray* seeds = this->Surface->GetFieldData()->GetArray(name);
  if (seeds && seeds->GetNumberOfComponents() != components) {
    Fail(std::string("field data '") + name + "' have " + Number(seeds->GetNumberOfComponents()) + " components, they must have " +
      Number(components));
  }
  const vtkIdType count = seeds ? seeds->GetNumberOfTuples() : 0;
  this->Output.Put(count);
  this->Output.EndLine();
  for (vtkIdType seed = 0; seed < count; ++seed) {
    this->Output.Put(seed + this->First);
    for (int component = 0; component < components; ++component) {
      this->Output.Put(Finite(seeds, seed, component, std::string("field data '") + name + "'"));
    }
    this->Output.EndLine();
  }
}
} // namespace

void vtkStratusTetGenWriteComplex(vtkStratusTetGenOutput& output, vtkPolyData* surface, bool smesh, vtkIdType first)
{
  ComplexWriter writer(output, surface, smesh, first);
  writer.FindFacets();
  writer.WriteFacets();
  writer.WriteSeeds("Holes", 3);
  writer.WriteSeeds("Regions", 5);
}
