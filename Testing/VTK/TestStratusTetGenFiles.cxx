// SPDX-License-Identifier: BSD-3-Clause
// TetGen's files: the reader reads the program's files, the program reads the writer's files, and both round trips keep every bit.
// Argument: a folder to write to.
#include "tetgen_testing.h"

#include "vtkStratusTetGenReader.h"
#include "vtkStratusTetGenWriter.h"

#include "vtkQuadraticTetra.h"

#include <cstdlib>

namespace {
using Reader = vtkStratusTetGenReader;
std::string Folder;

// A cube with an attribute at its points, a line and a point on one side, a polygon that goes on in the next line, a region.
const char* const CubePoly = "# a cube\n"
                             "10 3 1 1\n"
                             "0 0 0 0 5.5 1\n 1 1,0,0 5 1\n2\t1 1 0 +5 1\n3 0 1 0 5 1\n\n"
                             "4 0 0 1 5 1 # the upper side\n5 1 0 1 5 1\n6 1 1 1 5 1\n7 0 1 1 5 1\n8 .25 .5 0 1e-3 2\n9 .75 .5 0 5 2\n"
                             "6 1\n"
                             "2 0 3\n4 0 1 2 3\n2 8 9\n"
                             "1 0 4\n4 4 5 6\n 7\n"
                             "1 0 5\n4 0 1 5 4\n1 0 6\n4 1 2 6 5\n1 0 7\n4 2 3 7 6\n1 0 8\n4 3 0 4 7\n"
                             "0\n"
                             "1\n0 .5 .5 .5 77 .1\n";

bool TetGen(const std::string& switches, const std::string& file)
{
  const std::string command = "cd '" + Folder + "' && tetgen -" + switches + " " + file + " >/dev/null 2>&1";
  const int status = std::system(command.c_str());
  CHECK(status == 0, "'%s' ended with %d (is TetGen installed?)", command.c_str(), status);
  return status == 0;
}

void ReadFile(Reader* reader, const std::string& name)
{
  vtkNew<ErrorObserver> errors;
  reader->AddObserver(vtkCommand::ErrorEvent, errors);
  reader->SetFileName((Folder + "/" + name).c_str());
  reader->Update();
  CHECK(errors->Count == 0, "%s: %s", name.c_str(), errors->Text.c_str());
}

void WriteFile(vtkDataObject* data, vtkPolyData* surface, const std::string& name, int first)
{
  vtkNew<vtkStratusTetGenWriter> writer;
  vtkNew<ErrorObserver> errors;
  writer->AddObserver(vtkCommand::ErrorEvent, errors);
  writer->SetInputData(data);
  if (surface) {
    writer->SetInputData(1, surface);
  }
  writer->SetFileName((Folder + "/" + name).c_str());
  writer->SetFirstNumber(first);
  CHECK(writer->Write() == 1 && errors->Count == 0, "%s: %s", name.c_str(), errors->Text.c_str());
}

void CheckCube(Reader* reader, const char* what)
{
  vtkUnstructuredGrid* mesh = reader->GetOutput();
  CHECK(mesh->GetNumberOfCells() > 5, "%s: %lld cells", what, static_cast<long long>(mesh->GetNumberOfCells()));
  CHECK(std::abs(Volume(mesh) - 1.0) < 1e-12, "%s: the cube's volume is %.17g", what, Volume(mesh));
  CHECK(NeighborsAreRight(mesh), "%s: neighbours", what);
  for (int marker = 3; marker <= 8; ++marker) {
    const double area = Area(reader->GetSurface(), marker);
    CHECK(std::abs(area - 1.0) < 1e-12, "%s: side %d has an area of %.17g", what, marker, area);
  }
  vtkDataArray* region = mesh->GetCellData()->GetArray("Attribute1");
  CHECK(region && region->GetRange()[0] == 77 && region->GetRange()[1] == 77, "%s: the region's attribute", what);
  vtkDataArray* attribute = mesh->GetPointData()->GetArray("Attribute1");
  CHECK(attribute && attribute->GetComponent(0, 0) == 5.5 && attribute->GetComponent(8, 0) == 1e-3, "%s: attributes of points", what);
  CHECK(mesh->GetPointData()->GetArray("Marker"), "%s: markers of points", what);
  CHECK(reader->GetSurface()->GetNumberOfLines() > 18, "%s: edges", what);
}

// Every midpoint of an edge is where vtkQuadraticTetra puts it.
void CheckMiddles(vtkUnstructuredGrid* mesh)
{
  vtkNew<vtkQuadraticTetra> shape;
  int wrong = 0;
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell) {
    for (int edge = 0; edge < 6; ++edge) {
      const vtkIdType* ends = shape->GetEdgeArray(edge);
      double a[3], b[3], middle[3];
      mesh->GetPoint(Corners(mesh, cell)[ends[0]], a);
      mesh->GetPoint(Corners(mesh, cell)[ends[1]], b);
      mesh->GetPoint(Corners(mesh, cell)[ends[2]], middle);
      for (int axis = 0; axis < 3; ++axis) {
        wrong += std::abs(0.5 * (a[axis] + b[axis]) - middle[axis]) < 1e-12 ? 0 : 1;
      }
    }
  }
  CHECK(mesh->GetCellType(0) == VTK_QUADRATIC_TETRA && wrong == 0, "%d coordinates of middles are off", wrong);
}

void ReadsWhatTetGenWrites()
{
  WriteText(Folder + "/cube.poly", CubePoly);
  for (const std::string switches : { "pq1.4aAneQ", "pq1.4aAnneQ", "pq1.4aAneo2Q", "pq1.4aAnneo2Q" }) {
    if (TetGen(switches, "cube.poly")) {
      vtkNew<Reader> reader;
      ReadFile(reader, "cube.1.ele");
      CheckCube(reader, switches.c_str());
      if (switches.find("o2") != std::string::npos) {
        CheckMiddles(reader->GetOutput());
      }
    }
  }
  // The names' common part, and single files of the mesh.
  for (const char* name : { "cube.1", "cube.1.node", "cube.1.edge", "cube.1.neigh" }) {
    vtkNew<Reader> reader;
    ReadFile(reader, name);
    CheckCube(reader, name);
  }
  vtkNew<Reader> reader;
  reader->ReadFacesOff();
  reader->ReadEdgesOff();
  reader->ReadNeighborsOff();
  ReadFile(reader, "cube.1");
  CHECK(reader->GetSurface()->GetNumberOfCells() == 0 && !reader->GetOutput()->GetCellData()->GetArray("Neighbors"),
    "what was turned off was read");
}

void CheckSame(Reader* a, Reader* b, const char* what)
{
  CHECK(SameArray(a->GetOutput()->GetPoints()->GetData(), b->GetOutput()->GetPoints()->GetData()), "%s: coordinates differ", what);
  CHECK(SameCells(a->GetOutput()->GetCells(), b->GetOutput()->GetCells()), "%s: tetrahedra differ", what);
  CHECK(SameArrays(a->GetOutput()->GetPointData(), b->GetOutput()->GetPointData()), "%s: point data differ", what);
  CHECK(SameArrays(a->GetOutput()->GetCellData(), b->GetOutput()->GetCellData()), "%s: cell data differ", what);
  CHECK(SameCells(a->GetSurface()->GetPolys(), b->GetSurface()->GetPolys()), "%s: faces differ", what);
  CHECK(SameCells(a->GetSurface()->GetLines(), b->GetSurface()->GetLines()), "%s: edges differ", what);
  CHECK(SameCells(a->GetSurface()->GetVerts(), b->GetSurface()->GetVerts()), "%s: vertices differ", what);
  CHECK(SameArrays(a->GetSurface()->GetCellData(), b->GetSurface()->GetCellData()), "%s: data of faces differ", what);
  CHECK(SameArrays(a->GetSurface()->GetFieldData(), b->GetSurface()->GetFieldData()), "%s: holes or regions differ", what);
}

void MeshesComeBack()
{
  for (const char* order : { "pq1.4aAneQ", "pq1.4aAneo2Q" }) {
    const bool linear = std::string(order).find("o2") == std::string::npos;
    if (!TetGen(order, "cube.poly")) {
      return;
    }
    for (int first = 0; first < 2; ++first) {
      vtkNew<Reader> ours;
      ours->SetReadFaces(linear);
      ours->SetReadEdges(linear);
      ReadFile(ours, "cube.1");
      WriteFile(ours->GetOutput(), linear ? ours->GetSurface() : nullptr, "back.1.ele", first);
      vtkNew<Reader> again;
      ReadFile(again, "back.1");
      CheckSame(ours, again, linear ? "linear" : "second order");
      CHECK(ReadText(Folder + "/back.1.node").find("\n" + std::to_string(first) + " 0 0 0 5.5 ") != std::string::npos, "counted otherwise");
      if (linear && TetGen("rneQ", "back.1")) { // TetGen takes our mesh for its own
        vtkNew<Reader> rebuilt;
        ReadFile(rebuilt, "back.2");
        CheckCube(rebuilt, "rebuilt");
        CHECK(rebuilt->GetOutput()->GetNumberOfCells() == ours->GetOutput()->GetNumberOfCells(), "TetGen made another mesh of ours");
      }
    }
    for (const char* rest : { ".face", ".edge" }) {
      std::filesystem::remove(Folder + "/back.1" + rest);
    }
  }
}

void SurfacesComeBack()
{
  vtkNew<Reader> cube;
  ReadFile(cube, "cube.poly");
  CHECK(cube->GetSurface()->GetNumberOfPolys() == 6 && cube->GetSurface()->GetNumberOfLines() == 1, "the cube's facets");
  CHECK(cube->GetOutput()->GetNumberOfCells() == 0 && cube->GetOutput()->GetNumberOfPoints() == 10, "a surface has no tetrahedra");
  vtkDataArray* regions = cube->GetSurface()->GetFieldData()->GetArray("Regions");
  CHECK(regions && regions->GetComponent(0, 3) == 77 && regions->GetComponent(0, 4) == 0.1, "the cube's region");
  for (int first = 0; first < 2; ++first) {
    WriteFile(cube->GetSurface(), nullptr, "again.poly", first);
    vtkNew<Reader> again;
    ReadFile(again, "again.poly");
    CheckSame(cube, again, "poly");
    if (TetGen("pq1.4aAneQ", "again.poly")) {
      vtkNew<Reader> mesh;
      ReadFile(mesh, "again.1");
      CheckCube(mesh, "meshed from our file");
    }
  }
  // A box in a box, the inner one a hole.
  const double lower[3] = { 0.1, -3, 1e6 }, upper[3] = { 2.1, 0, 1e6 + 1 }, inner[3] = { 0.5, -2, 1e6 + 0.25 },
               outer[3] = { 1, -1, 1e6 + 0.5 };
  vtkNew<vtkPolyData> boxes;
  AddBox(boxes, lower, upper, 10);
  AddBox(boxes, inner, outer, -20);
  vtkNew<vtkDoubleArray> holes;
  holes->SetName("Holes");
  holes->SetNumberOfComponents(3);
  holes->InsertNextTuple3(0.75, -1.5, 1e6 + 0.3);
  boxes->GetFieldData()->AddArray(holes);
  for (const char* name : { "boxes.smesh", "boxes.poly", "boxes" }) {
    WriteFile(boxes, nullptr, name, 1);
    vtkNew<Reader> again;
    ReadFile(again, name);
    CHECK(SameCells(again->GetSurface()->GetPolys(), boxes->GetPolys()), "%s: facets differ", name);
    CHECK(SameArray(again->GetSurface()->GetFieldData()->GetArray("Holes"), holes), "%s: holes differ", name);
    CHECK(SameArray(again->GetSurface()->GetPoints()->GetData(), boxes->GetPoints()->GetData()), "%s: coordinates differ", name);
    CHECK(SameArray(again->GetSurface()->GetCellData()->GetArray("Marker"), boxes->GetCellData()->GetArray("Marker")), "%s: markers", name);
  }
  if (TetGen("pneQ", "boxes.smesh")) {
    vtkNew<Reader> mesh;
    ReadFile(mesh, "boxes.1");
    CHECK(std::abs(Volume(mesh->GetOutput()) - 5.875) < 1e-6, "the hole is filled: %.17g", Volume(mesh->GetOutput())); // cancels at 1e6
  }
}

// Facets with holes of their own, points on facets, points in a file of their own.
void PartsOfComplexes()
{
  WriteText(Folder + "/parts.node", "6\n1 0 0 0\n2 4 0 0\n3 4 4 0\n4 0 4 0\n5 2 2 0\n6 1 1 0\n");
  WriteText(
    Folder + "/parts.poly", "0 3 0 0\n2 0\n3 2\n4 1 2 3 4\n1 6\n2 5 6\n1 2.5 2.5 0\n2 1 2 0\n1\n3 1 2 5\n1\n7 1 2 3\n1\n1 5 6 7 8\n");
  vtkNew<Reader> reader;
  ReadFile(reader, "parts");
  vtkPolyData* surface = reader->GetSurface();
  CHECK(surface->GetNumberOfVerts() == 1 && surface->GetNumberOfLines() == 1 && surface->GetNumberOfPolys() == 2, "kinds of polygons");
  vtkDataArray* facets = surface->GetCellData()->GetArray("Facet");
  CHECK(facets && facets->GetComponent(0, 0) == 0 && facets->GetComponent(2, 0) == 0 && facets->GetComponent(3, 0) == 1, "facets");
  CHECK(!surface->GetCellData()->GetArray("Marker"), "markers where there are none");
  vtkDataArray* regions = surface->GetFieldData()->GetArray("Regions");
  CHECK(regions && regions->GetComponent(0, 4) == 8, "a region's lone number is both, its attribute and its volume");
  WriteFile(surface, nullptr, "parts2.poly", 1);
  vtkNew<Reader> again;
  ReadFile(again, "parts2.poly");
  CheckSame(reader, again, "parts");
  vtkNew<vtkStratusTetGenWriter> writer;
  vtkNew<ErrorObserver> errors;
  writer->AddObserver(vtkCommand::ErrorEvent, errors);
  writer->SetInputData(surface);
  writer->SetFileName((Folder + "/parts2.smesh").c_str());
  CHECK(writer->Write() == 0 && errors->Has("3 polygons and 2 holes"), "not refused: %s", errors->Text.c_str());
}

// A file of more than a megabyte, so that lines cross the borders of the blocks that are read at once; a line longer than a block; odd ends
// of lines.
void LongFilesAndLines()
{
  vtkNew<vtkUnstructuredGrid> mesh;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  unsigned state = 1;
  for (int point = 0; point < 60000; ++point) {
    double x[3];
    for (double& coordinate : x) {
      state = state * 1664525u + 1013904223u;
      coordinate = std::ldexp(static_cast<double>(state) - 2147483648.0, static_cast<int>(state >> 26) - 40) / 3.0;
    }
    points->InsertNextPoint(x);
  }
  mesh->SetPoints(points);
  WriteFile(mesh, nullptr, "long", 1);
  CHECK(std::filesystem::file_size(Folder + "/long.node") > 3000000, "the file is too short for this test");
  vtkNew<Reader> reader;
  ReadFile(reader, "long");
  CHECK(SameArray(reader->GetOutput()->GetPoints()->GetData(), points->GetData()), "coordinates differ");

  std::string text = "#" + std::string(3000000, 'x') + "\r\n4 3 0 0\r\n0 0 0 0\r\n1 1 0 0\r\n2 0 1 0\r\n3 0 0 1\r\n1 0\r\n600000";
  for (int corner = 0; corner < 600000; ++corner) {
    text += " " + std::to_string(corner % 4);
  }
  WriteText(Folder + "/long.smesh", text + "\r\n0\r\n0");
  vtkNew<Reader> polygon;
  ReadFile(polygon, "long.smesh");
  CHECK(
    polygon->GetSurface()->GetNumberOfPolys() == 1 && polygon->GetSurface()->GetPolys()->GetCellSize(0) == 600000, "the long line is cut");
  WriteFile(polygon->GetSurface(), nullptr, "short.smesh", 0);
  std::ifstream lines(Folder + "/short.smesh");
  size_t longest = 0;
  for (std::string line; std::getline(lines, line);) {
    longest = std::max(longest, line.size());
  }
  CHECK(longest < 2048, "TetGen can't read a line of %zu bytes", longest);
  vtkNew<Reader> again;
  ReadFile(again, "short.smesh");
  CHECK(SameCells(again->GetSurface()->GetPolys(), polygon->GetSurface()->GetPolys()), "the polygon is another");
}
} // namespace

int main(int argc, char** argv)
{
  Folder = std::string(argc > 1 ? argv[1] : ".") + "/tetgen-files";
  std::filesystem::create_directories(Folder);
  ReadsWhatTetGenWrites();
  MeshesComeBack();
  SurfacesComeBack();
  PartsOfComplexes();
  LongFilesAndLines();
  std::filesystem::remove_all(Folder);
  return Failures == 0 ? 0 : 1;
}
