// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusTetGenComplex.h"

#include "vtkCellData.h"
#include "vtkFieldData.h"
#include "vtkPolyData.h"

#include <limits>

namespace {
// Cells of one kind. A vtkPolyData numbers its cells kind by kind, so their cell data are collected kind by kind, too.
struct Cells {
  vtkSmartPointer<vtkCellArray> Polygons = vtkSmartPointer<vtkCellArray>::New();
  std::vector<vtkIdType> Facets;
  std::vector<int> Markers;
};

class Parser
{
public:
  Parser(vtkStratusTetGenInput& input, bool smesh, const vtkStratusTetGenNodes& nodes)
      : Input(input), IsSmesh(smesh), Nodes(nodes), FacetHoles(MakeArray("FacetHoles", 4)), Holes(MakeArray("Holes", 3)),
        Regions(MakeArray("Regions", 5))
  {
  }
  void ReadFacets();
  void ReadHoles();
  void ReadRegions();
  void Fill(vtkPolyData* surface);

private:
  static vtkSmartPointer<vtkDoubleArray> MakeArray(const char* name, int components);
  vtkIdType ReadPolygon(vtkIdType facet);
  void ReadFacet(vtkIdType facet);
  int ReadMarker();

  vtkStratusTetGenInput& Input;
  bool IsSmesh;
  const vtkStratusTetGenNodes& Nodes;
  bool IsMarked = false;
  Cells Kinds[3]; // vertices, lines, polygons
  std::vector<vtkIdType> Corners;
  vtkSmartPointer<vtkDoubleArray> FacetHoles, Holes, Regions;
};

vtkSmartPointer<vtkDoubleArray> Parser::MakeArray(const char* name, int components)
{
  vtkSmartPointer<vtkDoubleArray> array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  return array;
}

int Parser::ReadMarker()
{
  const bool given = this->IsMarked && this->Input.HasNumber(); // a facet of a .smesh file may leave its marker out
  return given ? static_cast<int>(this->Input.GetInteger("the marker", std::numeric_limits<int>::min(), std::numeric_limits<int>::max()))
               : 0;
}

// Reads a polygon, whose corners may continue on the next lines. Returns its kind.
vtkIdType Parser::ReadPolygon(vtkIdType facet)
{
  const vtkIdType count = this->Input.GetCount("the number of corners", 1);
  if (count < 1) {
    this->Input.Fail("the number of corners is 0, it must be at least 1");
  }
  this->Corners.clear();
  for (vtkIdType corner = 0; corner < count; ++corner) {
    if (!this->Input.HasNumber()) {
      this->Input.NeedLine("corners of a polygon", corner, count);
    }
    this->Corners.push_back(this->Input.GetInteger("a corner", this->Nodes.First, this->Nodes.GetLast()) - this->Nodes.First);
  }
  Cells& cells = this->Kinds[count > 2 ? 2 : count - 1];
  cells.Polygons->InsertNextCell(count, this->Corners.data());
  cells.Facets.push_back(facet);
  return count > 2 ? 2 : count - 1;
}

void Parser::ReadFacet(vtkIdType facet)
{
  if (this->IsSmesh) {
    const vtkIdType kind = this->ReadPolygon(facet);
    this->Kinds[kind].Markers.push_back(this->ReadMarker());
    this->Input.EndLine();
    return;
  }
  const vtkIdType polygons = this->Input.GetCount("the number of polygons of a facet", 2);
  const vtkIdType holes = this->Input.HasNumber() ? this->Input.GetCount("the number of holes of a facet", 4) : 0;
  const int marker = this->ReadMarker();
  this->Input.EndLine();
  for (vtkIdType polygon = 0; polygon < polygons; ++polygon) {
    this->Input.NeedLine("polygons of a facet", polygon, polygons);
    const vtkIdType kind = this->ReadPolygon(facet);
    this->Kinds[kind].Markers.push_back(marker);
    this->Input.EndLine();
  }
  for (vtkIdType hole = 0; hole < holes; ++hole) {
    this->Input.NeedLine("holes of a facet", hole, holes);
    this->Input.GetInteger("the hole's number", 0, VTK_ID_MAX);
    double tuple[4] = { static_cast<double>(facet) };
    for (int axis = 0; axis < 3; ++axis) {
      tuple[1 + axis] = this->Input.GetFinite("a hole's coordinate");
    }
    this->FacetHoles->InsertNextTuple(tuple);
    this->Input.EndLine();
  }
}

void Parser::ReadFacets()
{
  this->Input.NeedLine("lists of facets", 0, 1);
  const vtkIdType facets = this->Input.GetCount("the number of facets", this->IsSmesh ? 2 : 3);
  this->IsMarked = this->Input.HasNumber() && this->Input.GetInteger("the flag of markers", 0, 1) == 1;
  this->Input.EndLine();
  for (vtkIdType facet = 0; facet < facets; ++facet) {
    this->Input.NeedLine("facets", facet, facets);
    this->ReadFacet(facet);
  }
}

void Parser::ReadHoles()
{
  this->Input.NeedLine("lists of holes", 0, 1);
  const vtkIdType holes = this->Input.GetCount("the number of holes", 4);
  this->Input.EndLine();
  for (vtkIdType hole = 0; hole < holes; ++hole) {
    this->Input.NeedLine("holes", hole, holes);
    this->Input.GetInteger("the hole's number", 0, VTK_ID_MAX);
    double tuple[3];
    for (double& coordinate : tuple) {
      coordinate = this->Input.GetFinite("a hole's coordinate");
    }
    this->Holes->InsertNextTuple(tuple);
    this->Input.EndLine();
  }
}

void Parser::ReadRegions()
{
  if (!this->Input.NextLine()) { // the list of regions may be missing
    return;
  }
  const vtkIdType regions = this->Input.GetCount("the number of regions", 5);
  this->Input.EndLine();
  for (vtkIdType region = 0; region < regions; ++region) {
    this->Input.NeedLine("regions", region, regions);
    this->Input.GetInteger("the region's number", 0, VTK_ID_MAX);
    double tuple[5];
    for (int axis = 0; axis < 3; ++axis) {
      tuple[axis] = this->Input.GetFinite("a region's coordinate");
    }
    tuple[3] = this->Input.GetFinite("a region's attribute");
    // TetGen takes a lone fourth number as attribute and as volume.
    tuple[4] = this->Input.HasNumber() ? this->Input.GetFinite("a region's largest volume") : tuple[3];
    this->Regions->InsertNextTuple(tuple);
    this->Input.EndLine();
  }
  this->Input.EndFile("regions", regions);
}

void Parser::Fill(vtkPolyData* surface)
{
  surface->SetPoints(this->Nodes.Points);
  surface->SetVerts(this->Kinds[0].Polygons);
  surface->SetLines(this->Kinds[1].Polygons);
  surface->SetPolys(this->Kinds[2].Polygons);
  vtkSmartPointer<vtkIntArray> markers = vtkSmartPointer<vtkIntArray>::New();
  markers->SetName("Marker");
  vtkSmartPointer<vtkIdTypeArray> facets = vtkSmartPointer<vtkIdTypeArray>::New();
  facets->SetName("Facet");
  for (const Cells& cells : this->Kinds) {
    for (size_t cell = 0; cell < cells.Facets.size(); ++cell) {
      facets->InsertNextValue(cells.Facets[cell]);
      markers->InsertNextValue(cells.Markers[cell]);
    }
  }
  if (this->IsMarked) {
    surface->GetCellData()->AddArray(markers);
  }
  surface->GetCellData()->AddArray(facets);
  for (const auto& array : { this->Holes, this->Regions, this->FacetHoles }) {
    if (array->GetNumberOfTuples() > 0) {
      surface->GetFieldData()->AddArray(array);
    }
  }
}
} // namespace

void vtkStratusTetGenReadComplex(vtkStratusTetGenInput& input, bool smesh, const vtkStratusTetGenNodes& nodes, vtkPolyData* surface)
{
  Parser parser(input, smesh, nodes);
  parser.ReadFacets();
  parser.ReadHoles();
  parser.ReadRegions();
  parser.Fill(surface);
}
