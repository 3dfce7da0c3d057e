// SPDX-License-Identifier: BSD-3-Clause
// The order of a grid's tetrahedra is right at every face, for any camera, matrix and number of ids at once.
#include "vtkStratusVisibilitySort.h"

#include "tetrahedra_testing.h"

#include "vtkIdTypeArray.h"
#include "vtkMatrix4x4.h"
#include "vtkStratusPartitionFilter.h"

namespace {
Grid Tetrahedra(int depth)
{
  vtkNew<vtkStratusPartitionFilter> filter;
  filter->SetInputData(MixedGrid(4));
  filter->SetDepth(depth);
  filter->SetLeafCells(5);
  filter->Update();
  return filter->GetOutput();
}

std::vector<vtkIdType> Traverse(vtkStratusVisibilitySort* sort, vtkIdType chunk)
{
  std::vector<vtkIdType> cells;
  bool last = false;
  sort->InitTraversal();
  while (vtkIdTypeArray* ids = sort->GetNextCells()) {
    CHECK(!last && ids->GetNumberOfTuples() <= chunk && ids->GetNumberOfTuples() > 0, "%lld cells at once, %lld requested",
      static_cast<long long>(ids->GetNumberOfTuples()), static_cast<long long>(chunk));
    last = ids->GetNumberOfTuples() < chunk;
    cells.insert(cells.end(), ids->GetPointer(0), ids->GetPointer(0) + ids->GetNumberOfTuples());
  }
  return cells;
}

Vector ToWorld(vtkMatrix4x4* matrix, const Vector& p)
{
  double q[4] = { p[0], p[1], p[2], 1.0 };
  matrix->MultiplyPoint(q, q);
  return { q[0], q[1], q[2] };
}

// Neighbours of which the one behind comes first, by planes in world coordinates.
int WrongPairs(vtkUnstructuredGrid* grid, const std::vector<vtkIdType>& cells, vtkCamera* camera, vtkMatrix4x4* matrix)
{
  std::vector<vtkIdType> rank(static_cast<size_t>(grid->GetNumberOfCells()), -1);
  for (size_t i = 0; i < cells.size(); ++i) {
    rank[static_cast<size_t>(cells[i])] = static_cast<vtkIdType>(i);
  }
  int wrong = std::find(rank.begin(), rank.end(), -1) == rank.end() && cells.size() == rank.size() ? 0 : 1000000;
  Vector eye, along;
  camera->GetPosition(eye.data());
  camera->GetDirectionOfProjection(along.data());
  const Faces faces(grid);
  for (const auto& face : faces.Owners) {
    if (face.second.size() != 2) {
      continue;
    }
    const Vector a = ToWorld(matrix, PointOf(grid, face.first[0])), b = ToWorld(matrix, PointOf(grid, face.first[1])),
                 c = ToWorld(matrix, PointOf(grid, face.first[2]));
    const Vector normal = Cross(Minus(b, a), Minus(c, a));
    const double side = camera->GetParallelProjection() ? -Dot(normal, along) : Dot(normal, Minus(eye, a));
    vtkIdType count;
    const vtkIdType* ids;
    grid->GetCellPoints(face.second[0], count, ids);
    const vtkIdType* apex =
      std::find_if(ids, ids + 4, [&](vtkIdType id) { return std::find(face.first.begin(), face.first.end(), id) == face.first.end(); });
    const double own = Dot(normal, Minus(ToWorld(matrix, PointOf(grid, *apex)), a));
    if (std::abs(side) > 1e-9) { // else neither hides the other
      const bool first = side * own > 0.0;
      wrong += first != (rank[static_cast<size_t>(face.second[0])] < rank[static_cast<size_t>(face.second[1])]);
    }
  }
  return wrong;
}

void Orders()
{
  for (int depth = 0; depth <= 3; depth += 3) {
    Grid grid = Tetrahedra(depth);
    vtkNew<vtkStratusVisibilitySort> sort;
    vtkNew<vtkCamera> camera;
    vtkNew<vtkMatrix4x4> matrix;
    for (int mirror = 0; mirror < 2; ++mirror) {
      if (mirror) {
        const double elements[16] = { -1, 0.3, 0, 9, 0, 2, 0, -4, 0.2, 0, 1, 1, 0, 0, 0, 1 };
        matrix->DeepCopy(elements);
      }
      sort->SetModelTransform(matrix);
      sort->SetInput(grid);
      sort->SetCamera(camera);
      for (int view = 0; view < 16; ++view) {
        camera->SetPosition(view % 2 ? 13 : -9.5, view / 2 % 2 ? 7.1 : -12, view / 4 % 2 ? 1.7 : 14);
        camera->SetFocalPoint(2, 2.1, 1.9);
        camera->SetParallelProjection(view / 8);
        sort->SetMaxCellsReturned(view % 3 ? 100 : VTK_INT_MAX);
        sort->SetDirectionToFrontToBack();
        std::vector<vtkIdType> cells = Traverse(sort, sort->GetMaxCellsReturned());
        CHECK(WrongPairs(grid, cells, camera, matrix) == 0, "view %d, depth %d, mirror %d: %d pairs in the wrong order", view, depth,
          mirror, WrongPairs(grid, cells, camera, matrix));
        sort->SetDirectionToBackToFront();
        std::vector<vtkIdType> back = Traverse(sort, sort->GetMaxCellsReturned());
        std::reverse(back.begin(), back.end());
        CHECK(back == cells, "view %d: back to front is not front to back turned round", view);
        CHECK(sort->GetNumberOfLeaves() == 1 << depth, "%d leaves", sort->GetNumberOfLeaves());
      }
    }
  }
}

// Cells one within the other in all directions: no order is right, each cell comes once, and overlaps and forced cells are counted.
void Overlaps()
{
  Grid grid = Grid::New();
  vtkNew<vtkPoints> points;
  unsigned state = 7;
  for (vtkIdType cell = 0; cell < 2000; ++cell) {
    vtkIdType ids[4];
    for (vtkIdType& id : ids) {
      double p[3];
      for (double& x : p) {
        state = state * 1664525u + 1013904223u;
        x = (state >> 8) / 4194304.0;
      }
      id = points->InsertNextPoint(p);
    }
    grid->InsertNextCell(VTK_TETRA, 4, ids);
  }
  grid->SetPoints(points);
  vtkNew<vtkStratusVisibilitySort> sort;
  vtkNew<vtkCamera> camera;
  camera->SetPosition(12, 9, 7);
  camera->SetFocalPoint(2, 2, 2);
  sort->SetInput(grid);
  sort->SetCamera(camera);
  std::vector<vtkIdType> cells = Traverse(sort, sort->GetMaxCellsReturned());
  std::sort(cells.begin(), cells.end());
  CHECK(
    cells.size() == 2000 && std::adjacent_find(cells.begin(), cells.end()) == cells.end(), "%zu cells, not 2000 each once", cells.size());
  CHECK(sort->GetNumberOfOverlaps() > 0 && sort->GetNumberOfForcedCells() > 0, "%lld overlaps, %lld cells forced",
    static_cast<long long>(sort->GetNumberOfOverlaps()), static_cast<long long>(sort->GetNumberOfForcedCells()));
}

// A partition that something spoils after it was used: its tree is taken no more, the order is right without.
void Spoiled(const char* what, void (*spoil)(vtkUnstructuredGrid*))
{
  Grid grid = Tetrahedra(3);
  vtkNew<vtkStratusVisibilitySort> sort;
  vtkNew<vtkCamera> camera;
  vtkNew<vtkMatrix4x4> identity;
  camera->SetPosition(13, 7, 9);
  sort->SetInput(grid);
  sort->SetCamera(camera);
  sort->SetDirectionToFrontToBack();
  Traverse(sort, sort->GetMaxCellsReturned());
  CHECK(sort->GetNumberOfLeaves() == 8, "%d leaves", sort->GetNumberOfLeaves());
  spoil(grid);
  grid->Modified();
  const std::vector<vtkIdType> cells = Traverse(sort, sort->GetMaxCellsReturned());
  CHECK(sort->GetNumberOfLeaves() == 1, "%s: %d leaves of a tree that holds no more", what, sort->GetNumberOfLeaves());
  CHECK(WrongPairs(grid, cells, camera, identity) == 0, "%s: %d pairs in the wrong order", what, WrongPairs(grid, cells, camera, identity));
}

void MovePoints(vtkUnstructuredGrid* grid)
{
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
    const Vector p = PointOf(grid, i);
    grid->GetPoints()->SetPoint(i, p[0] + 0.4 * p[1], p[1] + 0.3 * p[2], p[2] + 0.2 * p[0]);
  }
  grid->GetPoints()->Modified();
}

// There is no leaf to be read for each cell.
void ShortenLeaves(vtkUnstructuredGrid* grid)
{
  vtkDataArray* leaf = grid->GetCellData()->GetArray("StratusLeaf");
  leaf->SetNumberOfTuples(grid->GetNumberOfCells() - 1);
  leaf->Modified();
}

void Refused(const char* word, vtkDataSet* input, vtkCamera* camera)
{
  vtkNew<vtkStratusVisibilitySort> sort;
  vtkNew<ErrorObserver> errors;
  sort->AddObserver(vtkCommand::ErrorEvent, errors);
  sort->SetInput(input);
  sort->SetCamera(camera);
  sort->InitTraversal();
  CHECK(!sort->GetNextCells(), "%s: there are cells", word);
  CHECK(errors->Count == 1 && errors->Has(word), "'%s' says nothing of '%s'", errors->Text.c_str(), word);
}

void Refusals()
{
  vtkNew<vtkCamera> camera;
  vtkNew<vtkImageData> image;
  Refused("not set", nullptr, camera);
  Refused("vtkImageData", image, camera);
  Refused("camera", Tetrahedra(0), nullptr);
  Refused("only tetrahedra", MixedGrid(2), camera);
  vtkNew<vtkStratusVisibilitySort> sort;
  sort->SetInput(Grid::New());
  sort->SetCamera(camera);
  sort->InitTraversal();
  CHECK(!sort->GetNextCells(), "an empty grid has cells");
}
} // namespace

int main()
{
  Orders();
  Overlaps();
  Spoiled("moved points", MovePoints);
  Spoiled("too few leaves", ShortenLeaves);
  Refusals();
  return Failures == 0 ? 0 : 1;
}
