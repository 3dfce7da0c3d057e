// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusBlocks.h"

#include "stratus.h"
#include "vtkStratusArrays.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataSetAttributes.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkRectilinearGrid.h"
#include "vtkStructuredGrid.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <tuple>

namespace {
constexpr unsigned char Duplicate = vtkDataSetAttributes::DUPLICATECELL;
constexpr unsigned char HiddenCell = vtkDataSetAttributes::HIDDENCELL;

// Sets the points along the axes of a grid whose cells follow from them.
bool FindDimensions(vtkDataSet* grid, int points[3])
{
  if (auto* image = vtkImageData::SafeDownCast(grid)) {
    image->GetDimensions(points);
  } else if (auto* axes = vtkRectilinearGrid::SafeDownCast(grid)) {
    axes->GetDimensions(points);
  } else if (auto* curved = vtkStructuredGrid::SafeDownCast(grid)) {
    curved->GetDimensions(points);
  } else {
    return false;
  }
  return true;
}

vtkMTimeType TimeOf(vtkDataSet* grid, vtkDataArray* scalars)
{
  vtkMTimeType time = std::max(grid->GetMTime(), scalars->GetMTime());
  if (auto* points = vtkPointSet::SafeDownCast(grid)) {
    time = points->GetPoints() ? std::max(time, points->GetPoints()->GetMTime()) : time;
  }
  if (auto* cells = vtkUnstructuredGrid::SafeDownCast(grid)) {
    time = std::max(time, cells->GetMeshMTime());
  }
  return time;
}

void AddLeftOut(vtkIdType count, const char* why, std::string& text)
{
  if (count > 0) {
    text += (text.empty() ? "" : ", ") + std::to_string(count) + (count == 1 ? " block " : " blocks ") + why;
  }
}
} // namespace

// Points of all blocks, each place once. A table without buckets holds their numbers.
class vtkStratusBlocks::Points
{
public:
  Points(vtkIdType most, vtkDataArray* values) : Values(values)
  {
    size_t size = 16;
    while (size < 2 * static_cast<size_t>(most)) {
      size *= 2;
    }
    this->Table.assign(size, -1);
    this->Places->SetDataTypeToDouble();
    this->Tuple.resize(values ? static_cast<size_t>(values->GetNumberOfComponents()) : 0);
    this->Other.resize(this->Tuple.size());
  }

  // Returns the number of the point at `x` whose scalars equal the scalars of point `from` in `scalars`. Cell scalars do not keep points
  // apart.
  vtkIdType Add(const double x[3], vtkDataArray* scalars, vtkIdType from)
  {
    const double place[3] = { x[0] + 0.0, x[1] + 0.0, x[2] + 0.0 }; // of -0 and 0 make 0
    uint64_t hash = stratus_hash(place, sizeof place, 0);
    if (this->Values && scalars) {
      scalars->GetTuple(from, this->Tuple.data());
    }
    for (;; ++hash) {
      vtkIdType& slot = this->Table[hash & (this->Table.size() - 1)];
      if (slot < 0) {
        slot = this->Places->InsertNextPoint(place);
        if (this->Values) {
          this->Values->InsertNextTuple(this->Tuple.data());
        }
        return slot;
      }
      double known[3];
      this->Places->GetPoint(slot, known);
      if (std::memcmp(known, place, sizeof place) == 0 && this->HasValues(slot)) {
        return slot;
      }
    }
  }
  // Like the function above, by the place only.
  vtkIdType Add(const double x[3]) { return this->Add(x, nullptr, 0); }
  vtkPoints* Get() { return this->Places; }

private:
  // Values are compared as they are stored, so that one that is not a number equals itself.
  bool HasValues(vtkIdType point)
  {
    if (!this->Values) {
      return true;
    }
    this->Values->GetTuple(point, this->Other.data());
    return std::memcmp(this->Tuple.data(), this->Other.data(), this->Tuple.size() * sizeof(double)) == 0;
  }

  std::vector<vtkIdType> Table;
  vtkNew<vtkPoints> Places;
  vtkDataArray* Values;
  std::vector<double> Tuple, Other;
};

std::vector<vtkStratusBlocks::Block> vtkStratusBlocks::List(vtkCompositeDataSet* whole, const Find& find)
{
  std::vector<Block> blocks;
  vtkIdType flat = 0, bare = 0, other = 0;
  vtkSmartPointer<vtkCompositeDataIterator> at;
  at.TakeReference(whole->NewIterator());
  for (at->InitTraversal(); !at->IsDoneWithTraversal(); at->GoToNextItem()) {
    vtkDataSet* set = vtkDataSet::SafeDownCast(at->GetCurrentDataObject());
    int points[3], cells = 0;
    if (!set || set->GetNumberOfCells() == 0 || set->GetNumberOfPoints() == 0) {
      continue;
    }
    if (!vtkUnstructuredGrid::SafeDownCast(set) && (!FindDimensions(set, points) || *std::min_element(points, points + 3) < 2)) {
      ++flat;
      continue;
    }
    vtkDataArray* scalars = find(set, cells);
    if (!scalars || cells > 1) {
      ++bare;
    } else if (!blocks.empty() &&
      ((cells == 1) != this->Cells || scalars->GetNumberOfComponents() != blocks.front().Scalars->GetNumberOfComponents())) {
      ++other;
    } else {
      this->Cells = cells == 1;
      blocks.push_back({ set, scalars, TimeOf(set, scalars) });
    }
  }
  this->LeftOut.clear();
  AddLeftOut(flat, "without a volume", this->LeftOut);
  AddLeftOut(bare, "without the scalar array", this->LeftOut);
  AddLeftOut(other, "whose scalar array differs from the first block's in points or cells, or in its number of components", this->LeftOut);
  return blocks;
}

namespace {
// A face at the border of a structured grid: the names of its corners, in rising order, and of the ends of its diagonal.
struct BorderFace {
  std::array<vtkIdType, 4> Corners;
  std::array<vtkIdType, 2> Diagonal;
  bool operator<(const BorderFace& f) const { return std::tie(this->Corners, this->Diagonal) < std::tie(f.Corners, f.Diagonal); }
};

// Calls function(a, b, c, d) with the numbers of the corners of each face at the border; a and d are the ends of the diagonal by which the
// core divides it: the corners of the lowest and the highest number.
template <typename Function> void VisitBorder(const int n[3], Function&& function)
{
  const vtkIdType step[3] = { 1, n[0], static_cast<vtkIdType>(n[0]) * n[1] };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int side = 0; side < 2; ++side) {
      for (int i = 0; i + 1 < n[u]; ++i) {
        for (int j = 0; j + 1 < n[v]; ++j) {
          const vtkIdType first = side * (n[axis] - 1) * step[axis] + i * step[u] + j * step[v];
          function(first, first + step[u], first + step[v], first + step[u] + step[v]);
        }
      }
    }
  }
}
} // namespace

// Whether the blocks are structured grids whose common faces have one diagonal, so that their tetrahedra meet in whole faces.
bool vtkStratusBlocks::AreLattices() const
{
  vtkIdType most = 0;
  for (const Block& block : this->Known) {
    int n[3];
    if (!vtkStructuredGrid::SafeDownCast(block.Set) || block.Scalars->GetDataType() != this->Known.front().Scalars->GetDataType()) {
      return false;
    }
    FindDimensions(block.Set, n);
    most += 2 * (static_cast<vtkIdType>(n[0]) * n[1] + static_cast<vtkIdType>(n[1]) * n[2] + static_cast<vtkIdType>(n[2]) * n[0]);
  }
  Points points(most, nullptr);
  std::vector<BorderFace> faces;
  for (const Block& block : this->Known) {
    int n[3];
    FindDimensions(block.Set, n);
    VisitBorder(n, [&](vtkIdType a, vtkIdType b, vtkIdType c, vtkIdType d) {
      std::array<vtkIdType, 4> corners = { a, b, c, d };
      for (vtkIdType& corner : corners) {
        corner = points.Add(block.Set->GetPoint(corner));
      }
      BorderFace face = { corners, { std::min(corners[0], corners[3]), std::max(corners[0], corners[3]) } };
      std::sort(face.Corners.begin(), face.Corners.end());
      if (std::adjacent_find(face.Corners.begin(), face.Corners.end()) == face.Corners.end()) { // a triangle has no diagonal
        faces.push_back(face);
      }
    });
  }
  std::sort(faces.begin(), faces.end());
  return std::adjacent_find(faces.begin(), faces.end(),
           [](const BorderFace& f, const BorderFace& g) { return f.Corners == g.Corners && f.Diagonal != g.Diagonal; }) == faces.end();
}

bool vtkStratusBlocks::Set(vtkCompositeDataSet* whole, const Find& find, std::string& error, bool lattices)
{
  const std::vector<Block> blocks = this->List(whole, find);
  if (blocks != this->Known || blocks.empty()) {
    this->Known = blocks;
    this->Kept.clear();
    for (const Block& block : blocks) {
      this->Kept.push_back(block.Set);
    }
    this->Refusal.clear();
    this->Several.clear();
    this->Grid = blocks.empty() ? nullptr : blocks.front().Set;
    this->Scalars = blocks.empty() ? nullptr : blocks.front().Scalars;
    int points[3];
    const bool image = this->Grid && !vtkStructuredGrid::SafeDownCast(this->Grid) && FindDimensions(this->Grid, points);
    if (blocks.empty() && !this->LeftOut.empty()) {
      this->Refusal = "the data set has no block to draw, but " + this->LeftOut;
    } else if ((image || blocks.size() > 1) && this->CheckAll(this->Refusal)) {
      if (lattices && this->AreLattices()) {
        for (const Block& block : blocks) {
          this->Several.emplace_back(vtkStructuredGrid::SafeDownCast(block.Set), block.Scalars);
        }
        this->Grid = nullptr;
      } else {
        this->Join(this->Refusal);
      }
    }
  }
  error = this->Refusal;
  return error.empty();
}

// Refuses what could not be read safely.
bool vtkStratusBlocks::Check(const Block& block, std::string& error) const
{
  auto* grid = vtkUnstructuredGrid::SafeDownCast(block.Set);
  const vtkIdType values = this->Cells ? block.Set->GetNumberOfCells() : block.Set->GetNumberOfPoints();
  if (grid && !vtkStratusCheckGrid(grid, error)) {
    return false;
  }
  if (block.Scalars->GetNumberOfTuples() < values) {
    error = "the scalar array has " + std::to_string(block.Scalars->GetNumberOfTuples()) + " values, the block has " +
      std::to_string(values) + (this->Cells ? " cells" : " points");
    return false;
  }
  if (block.Set->GetCellData()->GetHigherOrderDegrees() || block.Set->GetPointData()->GetRationalWeights()) {
    error = "cells with degrees or rational weights of their own cannot be joined with other blocks";
    return false;
  }
  auto* curved = vtkStructuredGrid::SafeDownCast(block.Set);
  int n[3];
  if (curved && FindDimensions(curved, n) && curved->GetNumberOfPoints() < static_cast<vtkIdType>(n[0]) * n[1] * n[2]) {
    error = "the block has " + std::to_string(curved->GetNumberOfPoints()) + " points, its extent has " +
      std::to_string(static_cast<vtkIdType>(n[0]) * n[1] * n[2]);
    return false;
  }
  return true;
}

bool vtkStratusBlocks::CheckAll(std::string& error) const
{
  for (size_t b = 0; b < this->Known.size(); ++b) {
    if (!this->Check(this->Known[b], error)) {
      error = "block " + std::to_string(b) + ": " + error;
      return false;
    }
  }
  return true;
}

bool vtkStratusBlocks::Join(std::string& error)
{
  vtkIdType most = 0;
  int type = this->Known.front().Scalars->GetDataType();
  for (const Block& block : this->Known) {
    most += block.Set->GetNumberOfPoints();
    type = block.Scalars->GetDataType() == type ? type : VTK_DOUBLE;
  }
  const auto scalars = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(type));
  scalars->SetName(this->Known.front().Scalars->GetName());
  scalars->SetNumberOfComponents(this->Known.front().Scalars->GetNumberOfComponents());
  const auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  vtkNew<vtkUnsignedCharArray> hidden;
  hidden->SetName(vtkDataSetAttributes::GhostArrayName());
  grid->Allocate();
  Points points(most, this->Cells ? nullptr : scalars.Get());
  for (size_t b = 0; b < this->Known.size(); ++b) {
    const Block& block = this->Known[b];
    const vtkIdType cells = grid->GetNumberOfCells();
    grid->SetPoints(points.Get());
    std::vector<vtkIdType> names(static_cast<size_t>(block.Set->GetNumberOfPoints()));
    for (vtkIdType p = 0; p < block.Set->GetNumberOfPoints(); ++p) {
      double x[3];
      block.Set->GetPoint(p, x);
      names[static_cast<size_t>(p)] = points.Add(x, block.Scalars, p);
    }
    int n[3];
    if (auto* listed = vtkUnstructuredGrid::SafeDownCast(block.Set)) {
      this->AppendCells(listed, names, grid);
    } else if (FindDimensions(block.Set, n)) {
      this->AppendBoxes(n, names, grid);
    }
    if (!this->Append(block, hidden, error)) {
      error = "block " + std::to_string(b) + ": " + error;
      return false;
    }
    for (vtkIdType c = 0; this->Cells && c < grid->GetNumberOfCells() - cells; ++c) {
      scalars->InsertNextTuple(block.Scalars->GetTuple(c));
    }
  }
  if (hidden->GetValueRange()[1] > 0) {
    grid->GetCellData()->AddArray(hidden);
  }
  (this->Cells ? static_cast<vtkDataSetAttributes*>(grid->GetCellData()) : grid->GetPointData())->SetScalars(scalars);
  this->Grid = grid;
  this->Scalars = scalars;
  return true;
}

// Adds a flag for each cell of a block. Hidden points hide the cells at them, but only in their own block.
bool vtkStratusBlocks::Append(const Block& block, vtkUnsignedCharArray* hidden, std::string& error) const
{
  vtkUnsignedCharArray* points = nullptr;
  vtkUnsignedCharArray* cells = nullptr;
  vtkNew<vtkIdList> ids;
  if (!vtkStratusFindGhosts(block.Set->GetPointData(), block.Set->GetNumberOfPoints(), "points of the block", points, error) ||
    !vtkStratusFindGhosts(block.Set->GetCellData(), block.Set->GetNumberOfCells(), "cells of the block", cells, error)) {
    return false;
  }
  for (vtkIdType c = 0; c < block.Set->GetNumberOfCells(); ++c) {
    bool hides = cells && (cells->GetValue(c) & (Duplicate | HiddenCell));
    if (points && !hides) {
      block.Set->GetCellPoints(c, ids);
      hides =
        std::any_of(ids->begin(), ids->end(), [&](vtkIdType p) { return (points->GetValue(p) & vtkDataSetAttributes::HIDDENPOINT) != 0; });
    }
    hidden->InsertNextValue(hides ? HiddenCell : 0);
  }
  return true;
}

void vtkStratusBlocks::AppendCells(vtkUnstructuredGrid* from, const std::vector<vtkIdType>& names, vtkUnstructuredGrid* to) const
{
  std::vector<vtkIdType> ids;
  vtkNew<vtkIdList> stream;
  for (vtkIdType c = 0; c < from->GetNumberOfCells(); ++c) {
    const int type = from->GetCellType(c);
    vtkIdType count = 0;
    const vtkIdType* of = nullptr;
    ids.clear();
    if (type == VTK_POLYHEDRON) {
      from->GetFaceStream(c, stream);
      count = stream->GetId(0);
      of = stream->GetPointer(1);
      for (vtkIdType face = 0; face < count; ++face) {
        ids.push_back(*of);
        std::transform(of + 1, of + 1 + *of, std::back_inserter(ids), [&](vtkIdType p) { return names[static_cast<size_t>(p)]; });
        of += 1 + *of;
      }
      to->InsertNextCell(type, count, ids.data());
      continue;
    }
    from->GetCellPoints(c, count, of);
    std::transform(of, of + count, std::back_inserter(ids), [&](vtkIdType p) { return names[static_cast<size_t>(p)]; });
    to->InsertNextCell(type, count, ids.data());
  }
}

void vtkStratusBlocks::AppendBoxes(const int points[3], const std::vector<vtkIdType>& names, vtkUnstructuredGrid* to) const
{
  const size_t row = static_cast<size_t>(points[0]), layer = row * static_cast<size_t>(points[1]);
  for (size_t k = 0; k + 1 < static_cast<size_t>(points[2]); ++k) {
    for (size_t j = 0; j + 1 < static_cast<size_t>(points[1]); ++j) {
      for (size_t i = 0; i + 1 < row; ++i) {
        const vtkIdType* p = &names[k * layer + j * row + i];
        const vtkIdType box[8] = { p[0], p[1], p[row + 1], p[row], p[layer], p[layer + 1], p[layer + row + 1], p[layer + row] };
        to->InsertNextCell(VTK_HEXAHEDRON, 8, box);
      }
    }
  }
}
