// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusTetGenMesh.h"

#include <limits>

// TetGen lists the midpoints of edges 2-3, 0-3, 0-1, 1-2, 1-3, 0-2; VTK lists 0-1, 1-2, 0-2, 0-3, 1-3, 2-3.
const int vtkStratusTetGenCorner[10] = { 0, 1, 2, 3, 6, 7, 9, 5, 8, 4 };

namespace {
const vtkIdType MostColumns = 4096; // attributes; TetGen's own lines end at 2047 bytes
const int SmallestMarker = std::numeric_limits<int>::min();
const int LargestMarker = std::numeric_limits<int>::max();

std::vector<vtkSmartPointer<vtkDoubleArray>> MakeAttributes(vtkIdType columns, vtkIdType values)
{
  std::vector<vtkSmartPointer<vtkDoubleArray>> attributes;
  for (vtkIdType column = 0; column < columns; ++column) {
    attributes.push_back(vtkSmartPointer<vtkDoubleArray>::New());
    attributes.back()->SetName(("Attribute" + std::to_string(column + 1)).c_str());
    attributes.back()->SetNumberOfValues(values);
  }
  return attributes;
}

vtkSmartPointer<vtkIntArray> MakeMarkers(vtkIdType values)
{
  vtkSmartPointer<vtkIntArray> markers = vtkSmartPointer<vtkIntArray>::New();
  markers->SetName("Marker");
  markers->SetNumberOfValues(values);
  return markers;
}

vtkIdType OptionalInteger(vtkStratusTetGenInput& input, const char* name, vtkIdType lower, vtkIdType upper, vtkIdType missing)
{
  return input.HasNumber() ? input.GetInteger(name, lower, upper) : missing;
}
} // namespace

void vtkStratusTetGenReadNodes(vtkStratusTetGenInput& input, bool whole, vtkStratusTetGenNodes& nodes)
{
  input.NeedLine("headers", 0, 1);
  const vtkIdType count = input.GetCount("the number of points", 4);
  OptionalInteger(input, "the dimension", 3, 3, 3);
  const vtkIdType columns = OptionalInteger(input, "the number of attributes", 0, MostColumns, 0);
  const bool marked = OptionalInteger(input, "the flag of markers", 0, 1, 0) == 1;
  input.EndLine();
  input.CheckCount("the number of points", count, 4 + columns);
  nodes.Points = vtkSmartPointer<vtkPoints>::New();
  nodes.Points->SetDataTypeToDouble();
  nodes.Points->SetNumberOfPoints(count);
  nodes.Attributes = MakeAttributes(columns, count);
  nodes.Markers = marked ? MakeMarkers(count) : nullptr;
  double* xyz = count ? vtkDoubleArray::SafeDownCast(nodes.Points->GetData())->GetPointer(0) : nullptr;
  for (vtkIdType point = 0; point < count; ++point) {
    input.NeedLine("points", point, count);
    if (point == 0) {
      nodes.First = input.GetInteger("the number of the first point", 0, 1);
    } else {
      input.GetInteger("the point's number", nodes.First + point, nodes.First + point);
    }
    *xyz++ = input.GetFinite("x");
    *xyz++ = input.GetFinite("y");
    *xyz++ = input.GetFinite("z");
    for (const auto& attribute : nodes.Attributes) {
      attribute->SetValue(point, input.GetReal("an attribute"));
    }
    if (marked) {
      nodes.Markers->SetValue(point, static_cast<int>(input.GetInteger("the marker", SmallestMarker, LargestMarker)));
    }
    input.EndLine();
  }
  if (whole) {
    input.EndFile("points", count);
  }
}

void vtkStratusTetGenReadElements(vtkStratusTetGenInput& input, const vtkStratusTetGenNodes& nodes, vtkStratusTetGenElements& elements)
{
  input.NeedLine("headers", 0, 1);
  const vtkIdType count = input.GetCount("the number of tetrahedra", 5);
  const vtkIdType corners = OptionalInteger(input, "the number of points of a tetrahedron", 4, 10, 4);
  if (corners != 4 && corners != 10) {
    input.Fail("the number of points of a tetrahedron is " + std::to_string(corners) + ", it must be 4 or 10");
  }
  const vtkIdType columns = OptionalInteger(input, "the number of attributes", 0, MostColumns, 0);
  input.EndLine();
  input.CheckCount("the number of tetrahedra", count, 1 + corners + columns);
  elements.Corners = static_cast<int>(corners);
  elements.Count = count;
  elements.Connectivity = vtkSmartPointer<vtkIdTypeArray>::New();
  elements.Connectivity->SetNumberOfValues(count * corners);
  elements.Attributes = MakeAttributes(columns, count);
  for (vtkIdType element = 0; element < count; ++element) {
    input.NeedLine("tetrahedra", element, count);
    input.GetInteger("the tetrahedron's number", nodes.First + element, nodes.First + element);
    vtkIdType ids[10];
    for (int corner = 0; corner < elements.Corners; ++corner) {
      ids[corner] = input.GetInteger("a corner", nodes.First, nodes.GetLast()) - nodes.First;
    }
    for (int corner = 0; corner < elements.Corners; ++corner) {
      elements.Connectivity->SetValue(element * corners + corner, ids[vtkStratusTetGenCorner[corner]]);
    }
    for (const auto& attribute : elements.Attributes) {
      attribute->SetValue(element, input.GetReal("an attribute"));
    }
    input.EndLine();
  }
  input.EndFile("tetrahedra", count);
}

vtkSmartPointer<vtkIdTypeArray> vtkStratusTetGenReadNeighbors(vtkStratusTetGenInput& input, vtkIdType first, vtkIdType elements)
{
  input.NeedLine("headers", 0, 1);
  input.GetInteger("the number of tetrahedra", elements, elements);
  OptionalInteger(input, "the number of neighbors", 4, 4, 4);
  input.EndLine();
  vtkSmartPointer<vtkIdTypeArray> neighbors = vtkSmartPointer<vtkIdTypeArray>::New();
  neighbors->SetName("Neighbors");
  neighbors->SetNumberOfComponents(4);
  neighbors->SetNumberOfTuples(elements);
  for (vtkIdType element = 0; element < elements; ++element) {
    input.NeedLine("tetrahedra", element, elements);
    input.GetInteger("the tetrahedron's number", first + element, first + element);
    for (int corner = 0; corner < 4; ++corner) {
      const vtkIdType neighbor = input.GetInteger("a neighbor", -1, first + elements - 1);
      if (neighbor != -1 && neighbor < first) {
        input.Fail("a neighbor is '0', it must be -1, or a number from 1 as all others of this mesh");
      }
      neighbors->SetTypedComponent(element, corner, neighbor == -1 ? -1 : neighbor - first);
    }
    input.EndLine();
  }
  input.EndFile("tetrahedra", elements);
  return neighbors;
}

int vtkStratusTetGenReadPieces(
  vtkStratusTetGenInput& input, const vtkStratusTetGenNodes& nodes, int corners, int second_order, vtkStratusTetGenPieces& pieces)
{
  const char* things = corners == 3 ? "faces" : "edges";
  const int middles = corners == 3 ? 3 : 1;
  const int owners = corners == 3 ? 2 : 1; // tetrahedra next to the face or edge, if TetGen was run with that option
  input.NeedLine("headers", 0, 1);
  const vtkIdType count = input.GetCount(corners == 3 ? "the number of faces" : "the number of edges", corners + 1);
  const bool marked = OptionalInteger(input, "the flag of markers", 0, 1, 0) == 1;
  input.EndLine();
  pieces.Connectivity = vtkSmartPointer<vtkIdTypeArray>::New();
  pieces.Connectivity->SetNumberOfValues(count * corners);
  pieces.Markers = marked ? MakeMarkers(count) : nullptr;
  for (vtkIdType piece = 0; piece < count; ++piece) {
    input.NeedLine(things, piece, count);
    if (second_order < 0) {
      const int columns = input.GetNumbersLeft() - 1 - (marked ? 1 : 0);
      if (corners == 2 && columns == 3) {
        input.Fail("the third point may be the middle of the edge or a tetrahedron next to it; the .ele or .face file is needed to decide");
      }
      second_order = columns == corners + middles || columns == corners + middles + owners ? 1 : 0;
    }
    input.GetInteger(corners == 3 ? "the face's number" : "the edge's number", nodes.First + piece, nodes.First + piece);
    for (int corner = 0; corner < corners; ++corner) {
      pieces.Connectivity->SetValue(piece * corners + corner, input.GetInteger("a corner", nodes.First, nodes.GetLast()) - nodes.First);
    }
    for (int middle = 0; second_order == 1 && middle < middles; ++middle) {
      input.GetInteger("the middle of an edge", nodes.First, nodes.GetLast());
    }
    if (marked) {
      pieces.Markers->SetValue(piece, static_cast<int>(input.GetInteger("the marker", SmallestMarker, LargestMarker)));
    }
    for (int owner = 0; input.HasNumber() && owner < owners; ++owner) {
      input.GetInteger("a tetrahedron next to it", -1, VTK_ID_MAX);
    }
    input.EndLine();
  }
  input.EndFile(things, count);
  return second_order;
}
