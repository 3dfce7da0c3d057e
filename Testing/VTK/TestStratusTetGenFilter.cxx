// SPDX-License-Identifier: BSD-3-Clause
// Surfaces filled by TetGen: volumes, holes, regions, limits, markers. Input that crashes TetGen or never lets it end becomes an error.
// Argument: a folder to write to.
#include "tetgen_testing.h"

#include "vtkStratusTetGenFilter.h"

#include "vtkExecutive.h"
#include "vtkSphereSource.h"
#include "vtkTriangleFilter.h"

#include <csignal>
#include <limits>

#include <sys/stat.h>

namespace {
using Filter = vtkStratusTetGenFilter;
const double Zero[3] = { 0, 0, 0 }, One[3] = { 1, 1, 1 };
std::string Folder;

// Updates; the outputs hold something if and only if there is no error. Returns the error.
std::string Run(Filter* filter)
{
  vtkNew<ErrorObserver> errors, silence;
  filter->AddObserver(vtkCommand::ErrorEvent, errors);
  filter->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, silence); // it says that its algorithm has failed, too
  filter->Modified();
  filter->Update();
  const bool empty = filter->GetOutput()->GetNumberOfCells() + filter->GetOutput()->GetNumberOfPoints() == 0 &&
    filter->GetBoundary()->GetNumberOfCells() + filter->GetBoundary()->GetNumberOfPoints() == 0;
  CHECK(errors->Count <= 1 && (errors->Count == 1) == empty, "%d errors, %s outputs: %s", errors->Count, empty ? "empty" : "full",
    errors->Text.c_str());
  filter->RemoveAllObservers();
  return errors->Text;
}

void Good(Filter* filter, double volume, const char* what)
{
  const std::string error = Run(filter);
  CHECK(error.empty(), "%s: %s", what, error.c_str());
  const double found = Volume(filter->GetOutput());
  const double cells = static_cast<double>(filter->GetOutput()->GetNumberOfCells());
  CHECK(std::abs(found - volume) < 1e-12 * volume * cells, "%s: the volume is %.17g, not %.17g", what, found, volume);
}

void Refused(Filter* filter, const char* word)
{
  const std::string error = Run(filter);
  CHECK(error.find(word) != std::string::npos, "'%s' says nothing of '%s'", error.c_str(), word);
}

double LargestVolume(vtkUnstructuredGrid* mesh)
{
  double largest = 0.0;
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell) {
    largest = std::max(largest, SixVolumes(mesh, Corners(mesh, cell)) / 6.0);
  }
  return largest;
}

// Of circumscribed radius to shortest edge, by the textbook: the radius from the determinant of the products of opposite edges.
double WorstRatio(vtkUnstructuredGrid* mesh)
{
  double worst = 0.0;
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell) {
    const vtkIdType* c = Corners(mesh, cell);
    const auto edge = [&](int i, int j) {
      double a[3], b[3];
      mesh->GetPoint(c[i], a);
      mesh->GetPoint(c[j], b);
      return std::sqrt(vtkMath::Distance2BetweenPoints(a, b));
    };
    const double p = edge(0, 1) * edge(2, 3), q = edge(0, 2) * edge(1, 3), r = edge(0, 3) * edge(1, 2);
    const double radius = std::sqrt((p + q + r) * (p + q - r) * (p - q + r) * (q + r - p)) / (4.0 * SixVolumes(mesh, c));
    const double shortest = std::min({ edge(0, 1), edge(0, 2), edge(0, 3), edge(1, 2), edge(1, 3), edge(2, 3) });
    worst = std::max(worst, radius / shortest);
  }
  return worst;
}

void Boxes()
{
  vtkNew<vtkPolyData> box;
  AddBox(box, Zero, One, 11);
  vtkNew<Filter> filter;
  filter->SetInputData(box);
  filter->QualityOff();
  Good(filter, 1.0, "a box");
  CHECK(filter->GetOutput()->GetNumberOfPoints() == 8, "points were added without need");
  vtkDataArray* ids = filter->GetOutput()->GetPointData()->GetArray("vtkOriginalPointIds");
  for (vtkIdType point = 0; point < 8; ++point) {
    double a[3], b[3];
    filter->GetOutput()->GetPoint(point, a);
    box->GetPoint(static_cast<vtkIdType>(ids->GetComponent(point, 0)), b);
    CHECK(std::equal(a, a + 3, b), "point %lld differs from the input's", static_cast<long long>(point));
  }
  filter->SetMaximumVolume(0.01);
  Good(filter, 1.0, "small tetrahedra");
  CHECK(LargestVolume(filter->GetOutput()) <= 0.01, "the largest volume is %g", LargestVolume(filter->GetOutput()));
  CHECK(filter->GetOutput()->GetPointData()->GetArray("vtkOriginalPointIds")->GetRange()[0] == -1, "no point was added");
  for (int marker = 11; marker < 17; ++marker) {
    CHECK(std::abs(Area(filter->GetBoundary(), marker) - 1.0) < 1e-12, "side %d: %g", marker, Area(filter->GetBoundary(), marker));
  }
  const vtkIdType many = filter->GetOutput()->GetNumberOfPoints();
  filter->SetMaximumSteinerPoints(5);
  Good(filter, 1.0, "few points");
  const vtkIdType few = filter->GetOutput()->GetNumberOfPoints();
  CHECK(few <= 8 + 5 && many > 100, "%lld points", static_cast<long long>(few));
}

// A slab, whose eight corners make flat tetrahedra. It has no small angles; next to small angles TetGen promises nothing.
void Qualities()
{
  const double slab[3] = { 1, 0.9, 0.1 };
  vtkNew<vtkPolyData> box;
  AddBox(box, Zero, slab, 1);
  vtkNew<Filter> filter;
  filter->SetInputData(box);
  filter->QualityOff();
  Good(filter, 0.09, "a slab");
  CHECK(WorstRatio(filter->GetOutput()) > 2.0, "the worst ratio is %g from the beginning", WorstRatio(filter->GetOutput()));
  filter->QualityOn();
  for (const double ratio : { 2.0, 1.4 }) {
    filter->SetRadiusEdgeRatio(ratio);
    Good(filter, 0.09, "a slab of quality");
    CHECK(WorstRatio(filter->GetOutput()) <= ratio * (1.0 + 1e-9), "the worst ratio is %g", WorstRatio(filter->GetOutput()));
  }
}

void Spheres()
{
  vtkNew<vtkSphereSource> sphere;
  sphere->SetThetaResolution(16);
  sphere->SetPhiResolution(12);
  sphere->Update();
  // The volume within the triangles, from the divergence theorem.
  vtkPolyData* surface = sphere->GetOutput();
  double volume = 0.0;
  vtkNew<vtkIdList> ids;
  for (vtkIdType face = 0; face < surface->GetNumberOfPolys(); ++face) {
    double p[3][3], normal[3];
    surface->GetPolys()->GetCellAtId(face, ids);
    for (int corner = 0; corner < 3; ++corner) {
      surface->GetPoint(ids->GetId(corner), p[corner]);
    }
    vtkMath::Cross(p[1], p[2], normal);
    volume += vtkMath::Dot(p[0], normal) / 6.0;
  }
  vtkNew<Filter> filter;
  filter->SetInputData(surface);
  filter->SetRadiusEdgeRatio(1.4);
  filter->SetMaximumVolume(0.001);
  Good(filter, volume, "a sphere");
  filter->PreserveBoundaryOn();
  Good(filter, volume, "a sphere whose surface stays");
  CHECK(filter->GetBoundary()->GetNumberOfPolys() == surface->GetNumberOfPolys(), "%lld triangles are %lld now",
    static_cast<long long>(surface->GetNumberOfPolys()), static_cast<long long>(filter->GetBoundary()->GetNumberOfPolys()));
}

// Two rooms with a wall between them, triangles with points of their own, and a hole.
void HolesAndRegions()
{
  const double right[3] = { 3, 1, 1 }, middle[3] = { 1, 0, 0 }, lower[3] = { 1.5, 0.25, 0.25 }, upper[3] = { 2.5, 0.75, 0.75 };
  vtkNew<vtkPolyData> rooms;
  AddBox(rooms, Zero, One, 1);
  AddBox(rooms, middle, right, 1); // its points coincide with the wall's points
  vtkNew<vtkCellArray> without_twin;
  vtkNew<vtkIdList> ids;
  for (vtkIdType side = 0; side < 12; ++side) {
    rooms->GetPolys()->GetCellAtId(side, ids);
    const vtkIdType flat[4] = { 0, 0, 1, 1 }; // a side without an area in the twin's place
    without_twin->InsertNextCell(4, side == 6 ? flat : ids->GetPointer(0));
  }
  rooms->SetPolys(without_twin);
  AddBox(rooms, lower, upper, 9);
  rooms->GetPoints()->InsertNextPoint(1e9, 0, 0); // unused
  vtkNew<Filter> filter;
  filter->SetInputData(rooms);
  filter->QualityOff();
  filter->AddHole(2, 0.5, 0.5);
  Good(filter, 3.0 - 0.25, "a hole");
  CHECK(filter->GetOutput()->GetNumberOfPoints() == 20, "%lld points", static_cast<long long>(filter->GetOutput()->GetNumberOfPoints()));
  filter->RemoveAllHoles();
  Good(filter, 3.0, "no hole");
  filter->AddRegion(0.5, 0.5, 0.5, 7.0, 0.01);
  filter->AddRegion(1.1, 0.5, 0.5, -2.5);
  vtkNew<vtkDoubleArray> holes, regions;
  holes->SetName("Holes");
  holes->SetNumberOfComponents(3);
  holes->InsertNextTuple3(2, 0.5, 0.5);
  rooms->GetFieldData()->AddArray(holes); // as of a .smesh file
  Good(filter, 2.75, "regions");
  vtkUnstructuredGrid* mesh = filter->GetOutput();
  vtkDataArray* region = mesh->GetCellData()->GetArray("Region");
  double volumes[2] = { 0, 0 }, largest = 0.0;
  for (vtkIdType cell = 0; region && cell < mesh->GetNumberOfCells(); ++cell) {
    const double value = region->GetComponent(cell, 0), volume = SixVolumes(mesh, Corners(mesh, cell)) / 6.0;
    CHECK(value == 7.0 || value == -2.5, "a region of %g", value);
    volumes[value == 7.0 ? 0 : 1] += volume;
    largest = value == 7.0 ? std::max(largest, volume) : largest;
  }
  CHECK(std::abs(volumes[0] - 1.0) < 1e-12 && std::abs(volumes[1] - 1.75) < 1e-12, "rooms of %.17g and %.17g", volumes[0], volumes[1]);
  CHECK(largest > 0.0 && largest <= 0.01, "the largest volume in the first room is %g", largest);
}

// Two boxes that cross, and a surface that leaves TetGen 1.5 no way but a crash.
void Crashes()
{
  const double half[3] = { 0.5, 0.4, 0.3 }, two[3] = { 2, 2.1, 2.2 };
  vtkNew<vtkPolyData> crossing;
  AddBox(crossing, Zero, One, 1);
  AddBox(crossing, half, two, 1);
  vtkNew<Filter> filter;
  filter->SetInputData(crossing);
  Refused(filter, "cross");
  vtkNew<vtkPolyData> flat;
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> triangles;
  for (int point = 0; point < 9; ++point) {
    points->InsertNextPoint(point % 3, point / 3, 0.0);
  }
  for (const std::array<vtkIdType, 3>& triangle : { std::array<vtkIdType, 3>{ 0, 1, 3 }, { 1, 2, 4 }, { 3, 4, 6 }, { 4, 5, 7 } }) {
    triangles->InsertNextCell(3, triangle.data());
  }
  flat->SetPoints(points);
  flat->SetPolys(triangles);
  filter->SetInputData(flat);
  Refused(filter, "TetGen");
  // Programs that die of each signal, that say something, that say nothing: no chance of TetGen's is needed.
  vtkNew<vtkPolyData> box;
  AddBox(box, Zero, One, 1);
  filter->SetInputData(box);
  const auto pretend = [&](const std::string& script, const char* word) {
    const std::string path = Folder + "/pretend";
    WriteText(path, "#!/bin/sh\n" + script + "\n");
    chmod(path.c_str(), 0755);
    filter->SetProgram(path.c_str());
    Refused(filter, word);
  };
  pretend("kill -SEGV $$", "signal 11");
  pretend("kill -ABRT $$", "signal 6");
  pretend("echo a word of its own; exit 3", "a word of its own");
  pretend("exit 0", "without a mesh");
  pretend("cat >&3", "without a mesh"); // the request is no answer
  filter->SetProgram((Folder + "/nowhere").c_str());
  Refused(filter, "nowhere");
  filter->SetProgram(nullptr);
  Good(filter, 1.0, "after all that");
  // An application that ignores its children learns no status of theirs, but has its mesh, and its errors.
  std::signal(SIGCHLD, SIG_IGN);
  Good(filter, 1.0, "children ignored");
  filter->SetInputData(crossing);
  Refused(filter, "TetGen");
  std::signal(SIGCHLD, SIG_DFL);
}

void TimeLimits()
{
  vtkNew<vtkPolyData> box;
  AddBox(box, Zero, One, 1);
  vtkNew<Filter> filter;
  filter->SetInputData(box);
  filter->SetRadiusEdgeRatio(0.1); // no tetrahedron has it
  filter->SetTimeLimit(0.5);
  Refused(filter, "TimeLimit, 0.5");
  filter->SetTimeLimit(1000);
  filter->AddObserver(vtkCommand::ProgressEvent, filter.Get(), &vtkAlgorithm::AbortExecuteOn);
  vtkNew<ErrorObserver> errors, silence;
  filter->AddObserver(vtkCommand::ErrorEvent, errors);
  filter->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, silence);
  filter->Update();
  CHECK(errors->Has("aborted") && filter->GetOutput()->GetNumberOfCells() == 0, "the abort went unheard: %s", errors->Text.c_str());
  filter->RemoveAllObservers();
  filter->AbortExecuteOff();
  filter->SetRadiusEdgeRatio(2);
  Good(filter, 1.0, "after an abort");
}

void Refusals()
{
  const auto refuses = [](const char* word, const std::function<void(Filter*, vtkPolyData*)>& breaks) {
    vtkNew<vtkPolyData> box;
    AddBox(box, Zero, One, 1);
    vtkNew<Filter> filter;
    filter->SetInputData(box);
    breaks(filter, box);
    Refused(filter, word);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  using P = vtkPolyData;
  refuses("RadiusEdgeRatio is 0", [](Filter* f, P*) { f->SetRadiusEdgeRatio(0); });
  refuses("RadiusEdgeRatio is nan", [&](Filter* f, P*) { f->SetRadiusEdgeRatio(nan); });
  refuses("MinimumDihedralAngle is 90", [](Filter* f, P*) { f->SetMinimumDihedralAngle(90); });
  refuses("MaximumVolume is -1", [](Filter* f, P*) { f->SetMaximumVolume(-1); });
  refuses("MaximumSteinerPoints is -2", [](Filter* f, P*) { f->SetMaximumSteinerPoints(-2); });
  refuses("TimeLimit is 0", [](Filter* f, P*) { f->SetTimeLimit(0); });
  refuses("Holes 0 is not finite", [&](Filter* f, P*) { f->AddHole(nan, 0, 0); });
  refuses("no points", [](Filter*, P* p) { p->Initialize(); });
  refuses("0 facets", [](Filter*, P* p) { p->SetPolys(vtkSmartPointer<vtkCellArray>::New()); });
  refuses("point 3 of the surface", [&](Filter*, P* p) { p->GetPoints()->SetPoint(3, 0, nan, 0); });
  refuses("encloses nothing", [](Filter* f, P*) { f->AddHole(0.5, 0.5, 0.5); });
  refuses("'Marker' hold", [](Filter*, P* p) {
    vtkNew<vtkDoubleArray> markers;
    markers->SetName("Marker");
    markers->SetNumberOfValues(6);
    markers->FillValue(0.5);
    p->GetCellData()->AddArray(markers);
  });
  refuses("array 'Marker' has 2 tuples, it must have one for each of the 6 cells", [](Filter*, P* p) {
    vtkNew<vtkDoubleArray> markers;
    markers->SetName("Marker");
    markers->SetNumberOfValues(2);
    p->GetCellData()->AddArray(markers);
  });
  refuses("cell 6 names point 99, outside 0..7", [](Filter*, P* p) {
    const vtkIdType corners[3] = { 0, 1, 99 };
    p->GetPolys()->InsertNextCell(3, corners);
  });
}
} // namespace

int main(int argc, char** argv)
{
  Folder = std::string(argc > 1 ? argv[1] : ".") + "/tetgen-filter";
  std::filesystem::create_directories(Folder);
  Folder = std::filesystem::absolute(Folder).string();
  Boxes();
  Qualities();
  Spheres();
  HolesAndRegions();
  Crashes();
  TimeLimits();
  Refusals();
  std::filesystem::remove_all(Folder);
  return Failures == 0 ? 0 : 1;
}
