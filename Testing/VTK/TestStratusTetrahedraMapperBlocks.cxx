// SPDX-License-Identifier: BSD-3-Clause
// vtkStratusTetrahedraMapper and composite data sets: blocks of a grid give the picture of the whole. Structured ones stay lattices, whose
// borders rays enter anew, unless their faces have other diagonals; rays cross the borders of joined ones. Nested and empty blocks; images
// and rectilinear grids; blocks that are left out, and refused inputs.
#include "tetrahedra_scene.h"

#include "vtkDoubleArray.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPolyData.h"
#include "vtkRectilinearGrid.h"
#include "vtkStructuredGrid.h"
#include "vtkUnsignedCharArray.h"

#include <cstring>

namespace {
constexpr int Side = 6; // boxes along an edge of the whole

void PlaceOf(int i, int j, int k, double x[3])
{
  x[0] = i + 0.3 * std::sin(j + 0.6 * k);
  x[1] = j + 0.25 * std::cos(1.2 * i);
  x[2] = 0.8 * k + 0.4 * std::sin(0.9 * i) * std::cos(j);
}

float ValueOf(int i, int j, int k)
{
  return 0.35f + 0.3f * static_cast<float>(std::sin(0.9 * i + 0.37 * j * k));
}

// Boxes from..to along each axis of the whole, bent or straight.
vtkSmartPointer<vtkStructuredGrid> Part(const int from[3], const int to[3], bool cells, bool bent)
{
  auto grid = vtkSmartPointer<vtkStructuredGrid>::New();
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> values;
  points->SetDataTypeToDouble();
  values->SetName("density");
  for (int k = from[2]; k <= to[2]; ++k) {
    for (int j = from[1]; j <= to[1]; ++j) {
      for (int i = from[0]; i <= to[0]; ++i) {
        double x[3] = { static_cast<double>(i), static_cast<double>(j), static_cast<double>(k) };
        if (bent) {
          PlaceOf(i, j, k, x);
        }
        points->InsertNextPoint(x);
        if (!cells || (i < to[0] && j < to[1] && k < to[2])) {
          values->InsertNextValue(ValueOf(i, j, k));
        }
      }
    }
  }
  grid->SetDimensions(to[0] - from[0] + 1, to[1] - from[1] + 1, to[2] - from[2] + 1);
  grid->SetPoints(points);
  (cells ? static_cast<vtkDataSetAttributes*>(grid->GetCellData()) : grid->GetPointData())->SetScalars(values);
  return grid;
}

vtkSmartPointer<vtkStructuredGrid> Octant(int number, bool cells, bool bent)
{
  int from[3], to[3];
  for (int a = 0; a < 3; ++a) {
    from[a] = number >> a & 1 ? Side / 2 : 0;
    to[a] = number >> a & 1 ? Side : Side / 2;
  }
  return Part(from, to, cells, bent);
}

vtkSmartPointer<vtkStructuredGrid> Whole(bool cells, bool bent)
{
  const int from[3] = { 0, 0, 0 }, to[3] = { Side, Side, Side };
  return Part(from, to, cells, bent);
}

vtkSmartPointer<vtkUnstructuredGrid> Hexahedra(vtkStructuredGrid* from)
{
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  vtkNew<vtkIdList> ids;
  grid->SetPoints(from->GetPoints());
  grid->GetPointData()->ShallowCopy(from->GetPointData());
  grid->GetCellData()->ShallowCopy(from->GetCellData());
  for (vtkIdType c = 0; c < from->GetNumberOfCells(); ++c) {
    from->GetCellPoints(c, ids);
    grid->InsertNextCell(VTK_HEXAHEDRON, ids);
  }
  return grid;
}

// The straight octant as an image, or as a rectilinear grid.
vtkSmartPointer<vtkDataSet> Straight(int number, bool image)
{
  const auto octant = Octant(number, false, false);
  double first[3];
  int n[3];
  octant->GetPoint(0, first);
  octant->GetDimensions(n);
  vtkSmartPointer<vtkDataSet> result;
  if (image) {
    const auto made = vtkSmartPointer<vtkImageData>::New();
    made->SetDimensions(n);
    made->SetOrigin(first);
    result = made;
  } else {
    const auto made = vtkSmartPointer<vtkRectilinearGrid>::New();
    vtkSmartPointer<vtkDoubleArray> axes[3];
    for (int a = 0; a < 3; ++a) {
      axes[a] = vtkSmartPointer<vtkDoubleArray>::New();
      for (int i = 0; i < n[a]; ++i) {
        axes[a]->InsertNextValue(first[a] + i);
      }
    }
    made->SetDimensions(n);
    made->SetXCoordinates(axes[0]);
    made->SetYCoordinates(axes[1]);
    made->SetZCoordinates(axes[2]);
    result = made;
  }
  result->GetPointData()->SetScalars(octant->GetPointData()->GetScalars());
  return result;
}

struct BlockScene : GridScene {
  BlockScene() : GridScene(64, 48) { this->Tetrahedra->AddObserver(vtkCommand::WarningEvent, this->Warnings); }
  // Blocks look like the whole grid, marched and projected, and no ray enters at the borders of joined blocks.
  void IsWhole(vtkDataObjectTree* blocks, vtkStructuredGrid* whole, const char* what, bool joined = true)
  {
    for (const int method : { vtkStratusTetrahedraMapper::MARCH_METHOD, vtkStratusTetrahedraMapper::PROJECT_METHOD }) {
      this->Tetrahedra->SetMethod(method);
      this->Tetrahedra->SetInputData(whole);
      this->Renderer->ResetCamera();
      const std::vector<float> right = this->GridPicture();
      const vtkIdType entries = this->Tetrahedra->GetNumberOfEntries(), tetrahedra = this->Tetrahedra->GetNumberOfTetrahedra();
      double bounds[6];
      std::copy_n(this->Tetrahedra->GetBounds(), 6, bounds);
      this->Tetrahedra->SetInputData(blocks);
      CHECK(std::equal(bounds, bounds + 6, this->Tetrahedra->GetBounds()), "%s: other bounds", what);
      const std::vector<float> ours = this->GridPicture();
      const double error = TetraError(ours, std::vector<double>(right.begin(), right.end()));
      CHECK(error < 0.01, "%s, method %d: %.4f of 255", what, method, error);
      const vtkIdType ourEntries = this->Tetrahedra->GetNumberOfEntries();
      const bool marches = method == vtkStratusTetrahedraMapper::MARCH_METHOD;
      CHECK(joined || !marches ? ourEntries == entries : ourEntries > entries, "%s: %lld entries, %lld into the whole", what,
        static_cast<long long>(ourEntries), static_cast<long long>(entries));
      CHECK(this->Tetrahedra->GetNumberOfTetrahedra() == tetrahedra, "%s: %lld tetrahedra", what,
        static_cast<long long>(this->Tetrahedra->GetNumberOfTetrahedra()));
    }
    CHECK(this->GridErrors->Count == 0, "%s: %s", what, this->GridErrors->Text.c_str());
  }
  vtkNew<ErrorObserver> Warnings;
};

void BlocksOfAWhole()
{
  for (const bool cells : { false, true }) {
    BlockScene scene;
    vtkNew<vtkMultiBlockDataSet> outer, inner, empty;
    vtkNew<vtkPartitionedDataSetCollection> collection;
    vtkNew<vtkPartitionedDataSet> parts;
    for (unsigned int number = 0; number < 8; ++number) { // structured and unstructured ones at two depths
      const auto octant = Octant(static_cast<int>(number), cells, true);
      vtkDataSet* block = octant;
      const auto listed = Hexahedra(octant);
      block = number % 3 == 1 ? static_cast<vtkDataSet*>(listed) : block;
      (number < 4 ? outer : inner)->SetBlock(number, block);
      parts->SetPartition(number, block);
    }
    outer->SetBlock(9, inner);
    outer->SetBlock(10, empty);
    outer->SetBlock(11, vtkNew<vtkUnstructuredGrid>());
    collection->SetPartitionedDataSet(1, parts);
    const auto whole = Whole(cells, true);
    scene.IsWhole(outer, whole, "blocks");
    scene.IsWhole(parts, whole, "parts");
    scene.IsWhole(collection, whole, "a collection");
    CHECK(scene.Warnings->Count == 0, "%s", scene.Warnings->Text.c_str());
  }
}

// The octant with its points along an axis in reverse order.
vtkSmartPointer<vtkStructuredGrid> Reversed(vtkStructuredGrid* from, int axis)
{
  auto grid = vtkSmartPointer<vtkStructuredGrid>::New();
  int n[3];
  from->GetDimensions(n);
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> values;
  points->SetDataTypeToDouble();
  values->SetName("density");
  for (int p = 0; p < n[0] * n[1] * n[2]; ++p) {
    int at[3] = { p % n[0], p / n[0] % n[1], p / n[0] / n[1] };
    at[axis] = n[axis] - 1 - at[axis];
    const vtkIdType source = (static_cast<vtkIdType>(at[2]) * n[1] + at[1]) * n[0] + at[0];
    points->InsertNextPoint(from->GetPoint(source));
    values->InsertNextTuple(source, from->GetPointData()->GetScalars());
  }
  grid->SetDimensions(n);
  grid->SetPoints(points);
  grid->GetPointData()->SetScalars(values);
  return grid;
}

// Structured blocks are marched as they are: no cell is listed, and light and components cross their borders.
void StructuredBlocks()
{
  for (const bool cells : { false, true }) {
    BlockScene scene;
    vtkNew<vtkMultiBlockDataSet> blocks;
    for (unsigned int number = 0; number < 8; ++number) {
      blocks->SetBlock(number, Octant(static_cast<int>(number), cells, true));
    }
    const auto whole = Whole(cells, true);
    scene.IsWhole(blocks, whole, "structured blocks", false);
    scene.Tetrahedra->SetMethodToAuto();
    scene.GridPicture();
    CHECK(
      std::string(scene.Tetrahedra->GetMethodReason()).find("not listed") != std::string::npos, "%s", scene.Tetrahedra->GetMethodReason());
    scene.Volume->GetProperty()->ShadeOn();
    scene.Tetrahedra->SetMethodToMarch();
    scene.Tetrahedra->SetInputData(whole);
    const std::vector<float> right = scene.GridPicture();
    scene.Tetrahedra->SetInputData(blocks);
    const std::vector<float> ours = scene.GridPicture();
    const double error = TetraError(ours, std::vector<double>(right.begin(), right.end()));
    CHECK(error < 0.01, "lit structured blocks: %.4f of 255", error);
    CHECK(scene.GridErrors->Count == 0, "%s", scene.GridErrors->Text.c_str());
  }
}

// A block whose j runs the other way meets its neighbour along i by other diagonals: both are joined, and divided alike. Along j its
// diagonals fit.
void BlocksThatRunTheOtherWay()
{
  for (const int axis : { 0, 1 }) {
    BlockScene scene;
    vtkNew<vtkMultiBlockDataSet> blocks;
    vtkNew<vtkUnstructuredGrid> listed;
    const auto left = Octant(0, false, true), right = Octant(1, false, true);
    const auto other = Reversed(right, axis);
    blocks->SetBlock(0, left);
    blocks->SetBlock(1, other);
    scene.Tetrahedra->SetMethodToMarch();
    scene.Tetrahedra->SetInputData(blocks);
    scene.Renderer->ResetCamera();
    const std::vector<float> ours = scene.GridPicture();
    const vtkIdType entries = scene.Tetrahedra->GetNumberOfEntries();
    vtkNew<vtkMultiBlockDataSet> together; // with an unstructured block, which is joined
    together->SetBlock(0, Hexahedra(left));
    together->SetBlock(1, other);
    scene.Tetrahedra->SetInputData(together);
    const std::vector<float> joined = scene.GridPicture();
    CHECK(axis == 1 ? entries == scene.Tetrahedra->GetNumberOfEntries() : entries > scene.Tetrahedra->GetNumberOfEntries(),
      "axis %d: %lld entries, %lld of joined blocks", axis, static_cast<long long>(entries),
      static_cast<long long>(scene.Tetrahedra->GetNumberOfEntries()));
    const double error = TetraError(ours, std::vector<double>(joined.begin(), joined.end()));
    CHECK(axis == 0 || error < 0.01, "%.4f of 255", error); // along i the cells of lattices are divided otherwise than joined ones
    CHECK(scene.GridErrors->Count == 0, "%s", scene.GridErrors->Text.c_str());
  }
}

void ImagesAndRectilinearGrids()
{
  BlockScene scene;
  vtkNew<vtkMultiBlockDataSet> blocks;
  for (unsigned int number = 0; number < 8; ++number) {
    const auto curved = Octant(static_cast<int>(number), false, false);
    const auto straight = Straight(static_cast<int>(number), number % 3 == 0);
    blocks->SetBlock(number, number % 3 == 2 ? static_cast<vtkDataSet*>(curved) : straight.Get());
  }
  scene.IsWhole(blocks, Whole(false, false), "images and rectilinear grids");
}

// Steps in new objects rebuild only the values.
void Steps()
{
  BlockScene scene;
  for (int step = 0; step < 4; ++step) {
    vtkNew<vtkMultiBlockDataSet> blocks;
    for (unsigned int number = 0; number < 8; ++number) {
      const auto octant = Octant(static_cast<int>(number), false, true);
      auto* values = vtkFloatArray::SafeDownCast(octant->GetPointData()->GetScalars());
      for (vtkIdType v = 0; v < values->GetNumberOfValues(); ++v) {
        values->SetValue(v, values->GetValue(v) * (1.0f - 0.1f * static_cast<float>(step)));
      }
      blocks->SetBlock(number, octant);
    }
    scene.Tetrahedra->SetInputData(blocks);
    scene.GridPicture();
    scene.GridPicture();
    CHECK(scene.Tetrahedra->GetGeometryBuilds() == 1 && scene.Tetrahedra->GetValueBuilds() == static_cast<vtkTypeUInt64>(step) + 1,
      "step %d: %llu and %llu builds", step, static_cast<unsigned long long>(scene.Tetrahedra->GetGeometryBuilds()),
      static_cast<unsigned long long>(scene.Tetrahedra->GetValueBuilds()));
  }
}

// Blocks whose values differ where they touch both keep their values. Hidden cells and points hide only in their own block.
void BlocksOfTheirOwn()
{
  BlockScene scene;
  vtkNew<vtkMultiBlockDataSet> blocks;
  vtkNew<vtkUnstructuredGrid> apart;
  auto left = Octant(0, false, true), right = Octant(1, false, true);
  auto* values = vtkFloatArray::SafeDownCast(right->GetPointData()->GetScalars());
  for (vtkIdType v = 0; v < values->GetNumberOfValues(); ++v) {
    values->SetValue(v, 0.9f - values->GetValue(v));
  }
  left->BlankPoint(3); // at the border of both
  left->BlankCell(8);
  blocks->SetBlock(0, left);
  blocks->SetBlock(1, right);
  scene.Tetrahedra->SetTermination(1.0);
  scene.Tetrahedra->SetInputData(blocks);
  scene.Renderer->ResetCamera();
  const std::vector<float> ours = scene.GridPicture();
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> all;
  points->SetDataTypeToDouble();
  for (vtkStructuredGrid* part : { left.Get(), right.Get() }) {
    const vtkIdType first = points->GetNumberOfPoints();
    for (vtkIdType p = 0; p < part->GetNumberOfPoints(); ++p) {
      points->InsertNextPoint(part->GetPoint(p));
      all->InsertNextTuple(p, part->GetPointData()->GetScalars());
    }
    static const int ways[6][2] = { { 1, 2 }, { 1, 5 }, { 3, 2 }, { 3, 7 }, { 4, 5 }, { 4, 7 } }; // of VTK's corners
    vtkNew<vtkIdList> ids;
    for (vtkIdType c = 0; c < part->GetNumberOfCells(); ++c) {
      part->GetCellPoints(c, ids);
      for (const auto& way : ways) {
        const vtkIdType v[4] = { first + ids->GetId(0), first + ids->GetId(way[0]), first + ids->GetId(way[1]), first + ids->GetId(6) };
        if (part->IsCellVisible(c)) {
          apart->InsertNextCell(VTK_TETRA, 4, v);
        }
      }
    }
  }
  apart->SetPoints(points);
  const double error = TetraError(ours, TetraReference(scene, apart, all, false));
  CHECK(error < 0.1, "two blocks of their own: RMSE %.4f of 255", error);
  CHECK(scene.GridErrors->Count == 0, "%s", scene.GridErrors->Text.c_str());
}

void WhatIsLeftOut()
{
  BlockScene scene;
  vtkNew<vtkMultiBlockDataSet> blocks, bare;
  vtkNew<vtkPolyData> surface;
  vtkNew<vtkPoints> corners;
  for (int i = 0; i < 3; ++i) {
    corners->InsertNextPoint(i, i * i, 0);
  }
  const vtkIdType triangle[3] = { 0, 1, 2 };
  surface->SetPoints(corners);
  surface->AllocateEstimate(1, 3);
  surface->InsertNextCell(VTK_TRIANGLE, 3, triangle);
  const auto without = Octant(2, false, true), ofCells = Octant(3, true, true), drawn = Octant(0, false, true);
  without->GetPointData()->Initialize();
  blocks->SetBlock(0, surface);
  blocks->SetBlock(1, drawn);
  blocks->SetBlock(2, without);
  blocks->SetBlock(3, ofCells);
  scene.IsWhole(blocks, drawn, "one block of four");
  CHECK(scene.Warnings->Count > 0 && scene.Warnings->Has("1 block without a volume, 1 block without the scalar array, 1 block whose"), "%s",
    scene.Warnings->Text.c_str());
  CHECK(scene.Tetrahedra->GetNumberOfIgnoredCells() == 0, "cells of blocks left out count");
  bare->SetBlock(0, without);
  scene.Tetrahedra->SetInputData(bare);
  CHECK(scene.GridPicture().empty() && scene.GridErrors->Has("no block to draw, but 1 block without the scalar array"), "%s",
    scene.GridErrors->Text.c_str());
  vtkNew<vtkMultiBlockDataSet> nothing;
  scene.Tetrahedra->SetInputData(nothing);
  const int errors = scene.GridErrors->Count;
  scene.Render();
  CHECK(scene.GridErrors->Count == errors, "a data set without blocks: %s", scene.GridErrors->Text.c_str());
  const auto cut = Octant(1, false, true);
  cut->GetPointData()->GetScalars()->SetNumberOfTuples(5);
  blocks->SetBlock(2, cut);
  scene.Tetrahedra->SetInputData(blocks);
  scene.Render();
  CHECK(scene.GridErrors->Has("block 1: the scalar array has 5 values, the block has 64 points"), "%s", scene.GridErrors->Text.c_str());
}
} // namespace

int main()
{
  BlocksOfAWhole();
  StructuredBlocks();
  BlocksThatRunTheOtherWay();
  ImagesAndRectilinearGrids();
  Steps();
  BlocksOfTheirOwn();
  WhatIsLeftOut();
  return Failures ? 1 : 0;
}
