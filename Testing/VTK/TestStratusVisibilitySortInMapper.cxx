// SPDX-License-Identifier: BSD-3-Clause
// VTK's own mapper draws by our order what it draws by an order found face by face, bit for bit: from all sides, moved and mirrored, from
// within, with cells turned inside out. By VTK's order of centres it draws something else.
#include "vtkStratusVisibilitySort.h"

#include "tetrahedra_testing.h"

#include "vtkCellCenterDepthSort.h"
#include "vtkIdTypeArray.h"
#include "vtkProjectedTetrahedraMapper.h"
#include "vtkStratusPartitionFilter.h"
#include "vtkVisibilitySort.h"

#include <queue>

namespace {

// Orders cells from back to front only by the planes of their faces; the mesh is convex.
class PlainSort : public vtkVisibilitySort
{
public:
  static PlainSort* New();
  vtkTypeMacro(PlainSort, vtkVisibilitySort);
  void InitTraversal() override;
  vtkIdTypeArray* GetNextCells() override;
  vtkIdType Come = 0; // cells of the last order

private:
  std::vector<vtkIdType> Order;
  size_t Next = 0;
  vtkNew<vtkIdTypeArray> Chunk;
};

vtkStandardNewMacro(PlainSort);

void PlainSort::InitTraversal()
{
  auto* grid = vtkUnstructuredGrid::SafeDownCast(this->Input);
  vtkNew<vtkMatrix4x4> inverse;
  vtkMatrix4x4::Invert(this->ModelTransform, inverse);
  double eye[4] = { 0, 0, 0, 1 }, along[4] = { 0, 0, 0, 0 };
  this->Camera->GetPosition(eye);
  this->Camera->GetDirectionOfProjection(along);
  inverse->MultiplyPoint(eye, eye);
  inverse->MultiplyPoint(along, along);
  const vtkIdType cells = grid->GetNumberOfCells();
  std::vector<std::vector<vtkIdType>> before(static_cast<size_t>(cells)); // cells that this one hides nothing of: they come after it
  std::vector<int> waiting(static_cast<size_t>(cells), 0);
  const Faces faces(grid);
  for (const auto& face : faces.Owners) {
    if (face.second.size() != 2) {
      continue;
    }
    const Vector a = PointOf(grid, face.first[0]);
    const Vector normal = Cross(Minus(PointOf(grid, face.first[1]), a), Minus(PointOf(grid, face.first[2]), a));
    const double side = this->Camera->GetParallelProjection() ? -Dot(normal, { along[0], along[1], along[2] })
                                                              : Dot(normal, Minus({ eye[0], eye[1], eye[2] }, a));
    vtkIdType count;
    const vtkIdType* ids;
    grid->GetCellPoints(face.second[0], count, ids);
    const vtkIdType* apex =
      std::find_if(ids, ids + 4, [&](vtkIdType id) { return std::find(face.first.begin(), face.first.end(), id) == face.first.end(); });
    const bool first_in_front = side * Dot(normal, Minus(PointOf(grid, *apex), a)) > 0.0;
    const vtkIdType front = face.second[first_in_front ? 0 : 1], back = face.second[first_in_front ? 1 : 0];
    before[static_cast<size_t>(back)].push_back(front);
    ++waiting[static_cast<size_t>(front)];
  }
  std::queue<vtkIdType> ready;
  for (vtkIdType c = 0; c < cells; ++c) {
    if (waiting[static_cast<size_t>(c)] == 0) {
      ready.push(c);
    }
  }
  this->Order.clear();
  this->Next = 0;
  for (; !ready.empty(); ready.pop()) {
    this->Order.push_back(ready.front());
    for (const vtkIdType front : before[static_cast<size_t>(ready.front())]) {
      if (--waiting[static_cast<size_t>(front)] == 0) {
        ready.push(front);
      }
    }
  }
  this->Come = static_cast<vtkIdType>(this->Order.size());
}

vtkIdTypeArray* PlainSort::GetNextCells()
{
  if (this->Next == this->Order.size()) {
    return nullptr;
  }
  const size_t count = std::min(static_cast<size_t>(this->MaxCellsReturned), this->Order.size() - this->Next);
  this->Chunk->SetNumberOfTuples(static_cast<vtkIdType>(count));
  std::copy_n(this->Order.begin() + static_cast<std::ptrdiff_t>(this->Next), count, this->Chunk->GetPointer(0));
  this->Next += count;
  return this->Chunk;
}

// Returns a mesh of tetrahedra. With `inverted`, every 37th cell has two points exchanged, which changes its orientation but not its place.
Grid Mesh(int depth, bool inverted)
{
  Grid mixed = MixedGrid(5);
  for (vtkIdType i = 0; i < mixed->GetNumberOfPoints(); ++i) {
    Vector p = PointOf(mixed, i);
    for (size_t a = 0; a < 3; ++a) {
      p[a] += p[a] > 0.0 && p[a] < 5.0 ? 0.12 * std::sin(37.0 * static_cast<double>(i) + 11.0 * static_cast<double>(a)) : 0.0;
    }
    mixed->GetPoints()->SetPoint(i, p.data());
  }
  vtkNew<vtkStratusPartitionFilter> filter;
  filter->SetInputData(mixed);
  filter->SetDepth(depth);
  filter->SetLeafCells(5);
  filter->Update();
  Grid grid = filter->GetOutput();
  vtkNew<vtkFloatArray> field;
  field->SetName("field");
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
    const Vector p = PointOf(grid, i);
    field->InsertNextValue(static_cast<float>(0.5 + 0.5 * std::sin(1.7 * p[0]) * std::cos(1.3 * p[1] + p[2])));
  }
  grid->GetPointData()->SetScalars(field);
  if (inverted) {
    vtkNew<vtkCellArray> cells;
    for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
      vtkNew<vtkIdList> ids;
      grid->GetCellPoints(c, ids);
      if (c % 37 == 0) {
        std::swap(*ids->GetPointer(1), *ids->GetPointer(2));
      }
      cells->InsertNextCell(ids);
    }
    grid->SetCells(VTK_TETRA, cells);
  }
  return grid;
}

struct Stage {
  explicit Stage(vtkUnstructuredGrid* grid)
  {
    this->Opacity->AddPoint(0.0, 0.0);
    this->Opacity->AddPoint(1.0, 0.8);
    this->Color->AddRGBPoint(0.0, 0.1, 0.2, 0.9);
    this->Color->AddRGBPoint(1.0, 1.0, 0.3, 0.1);
    this->Volume->GetProperty()->SetScalarOpacity(this->Opacity);
    this->Volume->GetProperty()->SetColor(this->Color);
    this->Mapper->SetInputData(grid);
    this->Volume->SetMapper(this->Mapper);
    this->Renderer->AddVolume(this->Volume);
    this->Window->SetMultiSamples(0);
    this->Window->SetSize(150, 130);
    this->Window->AddRenderer(this->Renderer);
    this->Window->Render(); // VTK 9.1 draws its first frame otherwise than all that follow
  }

  std::vector<unsigned char> Picture(vtkVisibilitySort* sort)
  {
    this->Mapper->SetVisibilitySort(sort);
    this->Mapper->Modified();
    this->Window->Render();
    vtkNew<vtkUnsignedCharArray> pixels;
    this->Window->GetRGBACharPixelData(0, 0, 149, 129, 0, pixels);
    return std::vector<unsigned char>(pixels->GetPointer(0), pixels->GetPointer(0) + pixels->GetNumberOfValues());
  }

  vtkNew<vtkPiecewiseFunction> Opacity;
  vtkNew<vtkColorTransferFunction> Color;
  vtkNew<vtkProjectedTetrahedraMapper> Mapper;
  vtkNew<vtkVolume> Volume;
  vtkNew<vtkRenderer> Renderer;
  vtkNew<vtkRenderWindow> Window;
};

// Renderings of four kinds of views; how many by centres were others.
int Pictures(int depth, bool inverted)
{
  Grid grid = Mesh(depth, inverted);
  Stage stage(grid);
  vtkNew<vtkStratusVisibilitySort> ours;
  vtkNew<PlainSort> plain;
  vtkNew<vtkCellCenterDepthSort> centers;
  int others = 0;
  for (int view = 0; view < 8; ++view) {
    vtkCamera* camera = stage.Renderer->GetActiveCamera();
    vtkNew<vtkMatrix4x4> matrix;
    if (view % 4 == 2) {
      const double mirrored[16] = { -1, 0.3, 0, 4, 0, 1.2, 0, -1, 0.2, 0, 1, 1, 0, 0, 0, 1 };
      matrix->DeepCopy(mirrored);
    }
    stage.Volume->SetUserMatrix(matrix);
    camera->SetParallelProjection(view % 4 == 1);
    camera->SetViewUp(0, 0, 1);
    camera->SetFocalPoint(2.5, 2.4, 2.6);
    camera->SetPosition(view < 4 ? 11.3 : -6.1, view % 2 ? 9.2 : -7.7, 6.5);
    stage.Renderer->ResetCamera();
    const std::vector<unsigned char> expected = stage.Picture(plain), picture = stage.Picture(ours), by_centers = stage.Picture(centers);
    int64_t differ = 0;
    for (size_t i = 0; i < picture.size(); ++i) {
      differ += picture[i] != expected[i];
    }
    CHECK(plain->Come == grid->GetNumberOfCells(), "%lld cells came", static_cast<long long>(plain->Come));
    CHECK(std::count_if(expected.begin(), expected.end(), [](unsigned char x) { return x > 20; }) > 10000, "there is little to be seen");
    CHECK(differ == 0, "depth %d, inverted %d, view %d: %lld bytes differ", depth, inverted, view, static_cast<long long>(differ));
    CHECK(ours->GetNumberOfLeaves() == 1 << depth, "%d leaves", ours->GetNumberOfLeaves());
    CHECK(ours->GetNumberOfCycles() == 0, "%lld cycles", static_cast<long long>(ours->GetNumberOfCycles()));
    others += by_centers != expected;
  }
  return others;
}
} // namespace

int main()
{
  int others = 0;
  for (int depth = 0; depth <= 3; depth += 3) {
    for (int inverted = 0; inverted < 2; ++inverted) {
      others += Pictures(depth, inverted != 0);
    }
  }
  CHECK(others > 16, "of 32 pictures by centres %d are wrong: the order has no effect", others);
  return Failures == 0 ? 0 : 1;
}
