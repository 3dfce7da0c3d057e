// SPDX-License-Identifier: BSD-3-Clause
// Grids of all linear cells, divided and cut: pieces fill the box and meet face to face, and every array comes along.
#include "vtkStratusPartitionFilter.h"

#include "tetrahedra_testing.h"

#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkExecutive.h"
#include "vtkIntArray.h"
#include "vtkPointData.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"

namespace {
double Linear(const Vector& p)
{
  return p[0] + 2.0 * p[1] - 3.0 * p[2];
}

void AddArrays(vtkUnstructuredGrid* grid)
{
  vtkNew<vtkDoubleArray> vectors;
  vtkNew<vtkFloatArray> scalars;
  vtkNew<vtkIntArray> numbers;
  vtkNew<vtkStringArray> names;
  vectors->SetName("vectors");
  vectors->SetNumberOfComponents(3);
  scalars->SetName("scalars");
  numbers->SetName("numbers");
  names->SetName("names");
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
    const Vector p = PointOf(grid, i);
    vectors->InsertNextTuple3(Linear(p), p[1], 1.0);
    scalars->InsertNextValue(static_cast<float>(Linear(p)));
  }
  for (vtkIdType i = 0; i < grid->GetNumberOfCells(); ++i) {
    numbers->InsertNextValue(static_cast<int>(7 * i));
    names->InsertNextValue(std::to_string(i));
  }
  grid->GetPointData()->AddArray(vectors);
  grid->GetPointData()->SetScalars(scalars);
  grid->GetCellData()->SetScalars(numbers);
  grid->GetCellData()->AddArray(names);
}

// Volumes add up, border faces are the box's surface, no face has three owners.
void Fills(vtkUnstructuredGrid* grid, int n, const char* what)
{
  double volume = 0.0, surface = 0.0, least = 1.0;
  size_t most = 0;
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    CHECK(grid->GetCellType(c) == VTK_TETRA, "%s: cell %lld is no tetrahedron", what, static_cast<long long>(c));
    volume += std::abs(Volume(grid, c));
    least = std::min(least, std::abs(Volume(grid, c)));
  }
  const Faces faces(grid);
  for (const auto& face : faces.Owners) {
    most = std::max(most, face.second.size());
    if (face.second.size() == 1) {
      const Vector a = PointOf(grid, face.first[0]);
      const Vector normal = Cross(Minus(PointOf(grid, face.first[1]), a), Minus(PointOf(grid, face.first[2]), a));
      surface += 0.5 * std::sqrt(Dot(normal, normal));
    }
  }
  CHECK(std::abs(volume - n * n * n) < 1e-12 * n * n * n, "%s: volume %.17g of %d", what, volume, n * n * n);
  CHECK(std::abs(surface - 6 * n * n) < 1e-11 * n * n, "%s: border of %.17g, not %d", what, surface, 6 * n * n);
  CHECK(most == 2, "%s: a face has %zu owners", what, most);
  CHECK(least > 0.0, "%s: a piece has no volume", what);
}

void Carries(vtkUnstructuredGrid* input, vtkUnstructuredGrid* output)
{
  vtkDataArray* vectors = output->GetPointData()->GetArray("vectors");
  vtkDataArray* scalars = output->GetPointData()->GetScalars();
  vtkDataArray* numbers = output->GetCellData()->GetScalars();
  auto* names = vtkStringArray::SafeDownCast(output->GetCellData()->GetAbstractArray("names"));
  vtkDataArray* original = output->GetCellData()->GetArray("StratusOriginalCell");
  CHECK(vectors && scalars && numbers && names && original, "an array or an attribute is lost");
  if (!vectors || !scalars || !numbers || !names || !original) {
    return;
  }
  for (vtkIdType i = 0; i < output->GetNumberOfPoints(); ++i) {
    const Vector p = PointOf(output, i);
    CHECK(std::abs(vectors->GetComponent(i, 0) - Linear(p)) < 1e-13 && std::abs(vectors->GetComponent(i, 2) - 1.0) < 1e-15 &&
        std::abs(scalars->GetComponent(i, 0) - Linear(p)) < 1e-5,
      "point %lld: %g is not %g", static_cast<long long>(i), vectors->GetComponent(i, 0), Linear(p));
  }
  for (vtkIdType c = 0; c < output->GetNumberOfCells(); ++c) {
    const auto from = static_cast<vtkIdType>(original->GetTuple1(c));
    CHECK(
      from >= 0 && from < input->GetNumberOfCells() && numbers->GetTuple1(c) == 7.0 * from && names->GetValue(c) == std::to_string(from),
      "cell %lld has another cell's data", static_cast<long long>(c));
  }
}

void Cuts()
{
  const int n = 5;
  for (int depth = 0; depth <= 4; ++depth) {
    for (int rule = 0; rule < 2; ++rule) {
      Grid grid = MixedGrid(n);
      AddArrays(grid);
      vtkNew<vtkStratusPartitionFilter> filter;
      filter->SetInputData(grid);
      filter->SetDepth(depth);
      filter->SetRule(rule);
      filter->SetPlanes(7); // of the paper's rule: between the cubes' planes
      filter->SetLeafCells(5);
      filter->Update();
      vtkUnstructuredGrid* output = filter->GetOutput();
      Fills(output, n, rule ? "paper" : "median");
      Carries(grid, output);
      // One node or other of so few cells has no plane that leaves its sides alike enough.
      const int leaves = filter->GetNumberOfLeaves();
      CHECK(leaves <= 1 << depth && leaves > (1 << depth) - 2, "%d leaves at depth %d", leaves, depth);
      CHECK(rule == 0 || depth == 0 || output->GetNumberOfCells() > filter->GetNumberOfTetrahedra(), "the paper's planes cut nothing");
    }
  }
}

// A quadratic tetrahedron: its eight parts fill it.
void Quadratic()
{
  static const double corners[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
  static const int edges[6][2] = { { 0, 1 }, { 1, 2 }, { 2, 0 }, { 0, 3 }, { 1, 3 }, { 2, 3 } };
  auto grid = Grid::New();
  vtkNew<vtkPoints> points;
  for (const auto& c : corners) {
    points->InsertNextPoint(c);
  }
  for (const auto& e : edges) {
    points->InsertNextPoint(0.5 * (corners[e[0]][0] + corners[e[1]][0]), 0.5 * (corners[e[0]][1] + corners[e[1]][1]),
      0.5 * (corners[e[0]][2] + corners[e[1]][2]));
  }
  grid->SetPoints(points);
  const vtkIdType ids[10] = { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9 };
  grid->InsertNextCell(VTK_QUADRATIC_TETRA, 10, ids);
  vtkNew<vtkStratusPartitionFilter> filter;
  filter->SetInputData(grid);
  filter->Update();
  double volume = 0.0;
  for (vtkIdType c = 0; c < filter->GetOutput()->GetNumberOfCells(); ++c) {
    volume += Volume(filter->GetOutput(), c);
    CHECK(Volume(filter->GetOutput(), c) > 0.0, "part %lld is turned inside out", static_cast<long long>(c));
  }
  CHECK(filter->GetOutput()->GetNumberOfCells() == 8 && std::abs(volume - 1.0 / 6.0) < 1e-15, "parts of volume %.17g", volume);
}

// Adjacent cells of every quadratic type, straight and bent: their parts fill the box, meet face to face, and a linear field
// stays one.
void QuadraticGrids()
{
  struct Case {
    const char* Name;
    int Hexahedron, Wedge, Pyramid;
  };
  static const Case cases[] = { { "serendipity", VTK_QUADRATIC_HEXAHEDRON, VTK_QUADRATIC_WEDGE, VTK_QUADRATIC_PYRAMID },
    { "triquadratic", VTK_TRIQUADRATIC_HEXAHEDRON, VTK_BIQUADRATIC_QUADRATIC_WEDGE, VTK_TRIQUADRATIC_PYRAMID },
    { "biquadratic, linear wedges", VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON, VTK_QUADRATIC_LINEAR_WEDGE, 0 } };
  const int n = 3;
  for (const Case& c : cases) {
    for (int kind = c.Pyramid ? 0 : 1; kind < (c.Pyramid ? 1 : 3); ++kind) { // without pyramids: hexahedra, then wedges
      for (double bend : { 0.0, 0.04 }) {
        Grid linear = kind == 0 ? MixedGrid(n) : CubesOf(n, kind == 1 ? VTK_HEXAHEDRON : VTK_WEDGE);
        Grid grid = Elevated(linear, c.Hexahedron, c.Wedge, c.Pyramid, n, bend);
        AddArrays(grid);
        vtkNew<vtkStratusPartitionFilter> filter;
        filter->SetInputData(grid);
        filter->SetDepth(0);
        filter->Update();
        Fills(filter->GetOutput(), n, c.Name);
        filter->SetLeafCells(50);
        for (int depth = 1; depth <= 3; ++depth) { // straight edges' middles are on the planes, up to rounding
          filter->SetDepth(depth);
          filter->Update();
          Carries(grid, filter->GetOutput());
          Fills(filter->GetOutput(), n, c.Name);
        }
        CHECK(filter->GetNumberOfLeaves() > 4, "%s: %d leaves", c.Name, filter->GetNumberOfLeaves());
      }
    }
  }
}

// A wedge and a pyramid given as hexahedra with corners that are one point: the parts that are none are left out.
void CornersThatAreOne()
{
  auto grid = Grid::New();
  vtkNew<vtkPoints> points;
  for (int i = 0; i < 8; ++i) {
    points->InsertNextPoint(((i + 1) >> 1) & 1, (i >> 1) & 1, i >> 2);
  }
  grid->SetPoints(points);
  const vtkIdType wedge[8] = { 0, 1, 2, 2, 4, 5, 6, 6 }, pyramid[8] = { 0, 1, 2, 3, 4, 4, 4, 4 };
  for (const vtkIdType* ids : { wedge, pyramid }) {
    grid->Reset();
    grid->Allocate(1);
    grid->InsertNextCell(VTK_HEXAHEDRON, 8, ids);
    vtkNew<vtkStratusPartitionFilter> filter;
    filter->SetInputData(grid);
    filter->Update();
    double volume = 0.0;
    for (vtkIdType c = 0; c < filter->GetOutput()->GetNumberOfCells(); ++c) {
      CHECK(Volume(filter->GetOutput(), c) > 0.0, "a part without volume");
      volume += Volume(filter->GetOutput(), c);
    }
    CHECK(std::abs(volume - (ids == wedge ? 1.0 / 2.0 : 1.0 / 3.0)) < 1e-15, "volume %.17g", volume);
  }
}

void EmptyAndRefused()
{
  vtkNew<vtkStratusPartitionFilter> filter;
  vtkNew<ErrorObserver> errors, pipeline;
  filter->AddObserver(vtkCommand::ErrorEvent, errors);
  filter->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, pipeline);
  auto grid = Grid::New();
  filter->SetInputData(grid);
  filter->Update();
  CHECK(errors->Count == 0 && filter->GetOutput()->GetNumberOfCells() == 0, "an empty grid is no empty grid: %s", errors->Text.c_str());
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(0, 0, 0);
  points->InsertNextPoint(1, 0, 0);
  points->InsertNextPoint(1, 1, 0);
  points->InsertNextPoint(1, 1, 1);
  grid->SetPoints(points);
  const vtkIdType ids[20] = { 0, 1, 2, 3 }, wild[5] = { 0, 1, 2, 3, 4 };
  const auto refuses = [&](int type, vtkIdType count, const vtkIdType* of, const char* word) {
    grid->Allocate(1);
    grid->InsertNextCell(type, count, of);
    grid->Modified();
    const int before = errors->Count;
    filter->Update();
    CHECK(word ? errors->Count == before + 1 && errors->Has(word) : errors->Count == before, "type %d: '%s'", type, errors->Text.c_str());
    CHECK(filter->GetOutput()->GetNumberOfCells() == 0, "type %d: cells in the output", type);
  };
  refuses(VTK_TRIANGLE, 3, ids, nullptr);
  refuses(VTK_LAGRANGE_PYRAMID, 4, ids, "(74)");
  refuses(VTK_LAGRANGE_TETRAHEDRON, 5, ids, "of 5 points, no cell of an order");
  refuses(VTK_HEXAHEDRON, 4, ids, "of 4 points, it must have 8");
  refuses(VTK_TETRA, 3, ids, "of 3 points, it must have 4");
  refuses(VTK_PYRAMID, 5, wild, "names point 4, outside 0..3");
  const vtkIdType faces[] = { 3, 0, 1, 2, 3, 0, 1, 9, 3, 1, 2, 3, 3, 2, 0, 3 };
  grid->Allocate(1);
  grid->InsertNextCell(VTK_POLYHEDRON, 4, ids, 4, faces);
  grid->Modified();
  filter->Update();
  CHECK(errors->Has("names point 9, outside 0..3"), "'%s'", errors->Text.c_str());
  const auto distrusts = [&](vtkDataSetAttributes* data, vtkDataArray* array, const char* name, vtkIdType tuples, const char* word) {
    grid->Allocate(1);
    grid->InsertNextCell(VTK_TETRA, 4, ids);
    array->SetName(name);
    array->SetNumberOfTuples(tuples);
    array->Fill(0);
    data->AddArray(array);
    grid->Modified();
    const int before = errors->Count;
    filter->Update();
    CHECK(errors->Count == before + 1 && errors->Has(word), "%lld tuples: '%s'", static_cast<long long>(tuples), errors->Text.c_str());
    data->RemoveArray(name);
  };
  vtkPointData* of_points = grid->GetPointData();
  vtkCellData* of_cells = grid->GetCellData();
  distrusts(of_points, vtkNew<vtkDoubleArray>(), "short", 3, "array 'short' has 3 tuples, it must have one for each of the 4 points");
  distrusts(of_cells, vtkNew<vtkDoubleArray>(), "short", 0, "array 'short' has 0 tuples, it must have one for each of the 1 cells");
  distrusts(of_points, vtkNew<vtkIntArray>(), "vtkGhostType", 4, "'vtkGhostType' has 4 tuples of 1 int, it must have one unsigned char");
  distrusts(of_cells, vtkNew<vtkUnsignedCharArray>(), "vtkGhostType", 2, "'vtkGhostType' has 2 tuples");
}
} // namespace

int main()
{
  Cuts();
  Quadratic();
  QuadraticGrids();
  CornersThatAreOne();
  EmptyAndRefused();
  return Failures == 0 ? 0 : 1;
}
