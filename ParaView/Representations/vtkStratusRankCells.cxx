// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusRankCells.h"

#include "vtkAppendFilter.h"
#include "vtkBoundingBox.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataSet.h"
#include "vtkExtractCells.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkImageData.h"
#include "vtkMultiProcessController.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkRectilinearGrid.h"
#include "vtkStructuredGrid.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <tuple>

namespace {

using Grid = vtkSmartPointer<vtkUnstructuredGrid>;
using Place = std::array<double, 3>;

// Positions of points in the order of all ranks: the block (which includes the rank if its pieces have no extents in a grid), and the
// place.
const char* const OrderArray = "StratusOrder";

void add_order(vtkDataSet* leaf, int block, int rank, vtkUnstructuredGrid* grid)
{
  int extent[6] = { 0, -1, 0, -1, 0, -1 };
  if (auto* image = vtkImageData::SafeDownCast(leaf)) {
    image->GetExtent(extent);
  } else if (auto* rectilinear = vtkRectilinearGrid::SafeDownCast(leaf)) {
    rectilinear->GetExtent(extent);
  } else if (auto* structured = vtkStructuredGrid::SafeDownCast(leaf)) {
    structured->GetExtent(extent);
  }
  vtkNew<vtkTypeInt64Array> order;
  order->SetName(OrderArray);
  order->SetNumberOfComponents(2);
  const bool listed = extent[1] < extent[0];
  const vtkTypeInt64 whose = (static_cast<vtkTypeInt64>(block) << 32) + (listed ? rank : 0);
  for (vtkIdType point = 0; listed && point < grid->GetNumberOfPoints(); ++point) {
    order->InsertNextTuple2(0, 0);
    order->SetTypedComponent(point, 0, whose);
    order->SetTypedComponent(point, 1, point);
  }
  vtkIdType at = 0;
  for (vtkTypeInt64 k = extent[4]; k <= extent[5]; ++k) {
    for (vtkTypeInt64 j = extent[2]; j <= extent[3]; ++j) {
      for (vtkTypeInt64 i = extent[0]; i <= extent[1]; ++i, ++at) {
        order->InsertNextTuple2(0, 0);
        order->SetTypedComponent(at, 0, whose);
        order->SetTypedComponent(at, 1, (k * (1 << 21) + j) * (1 << 21) + i); // extents are below 2^20 on each side of 0
      }
    }
  }
  grid->GetPointData()->AddArray(order);
}

bool shows(vtkUnsignedCharArray* cells, vtkUnsignedCharArray* points, vtkUnstructuredGrid* grid, vtkIdType cell)
{
  constexpr int owner_or_hidden = vtkDataSetAttributes::DUPLICATECELL | static_cast<int>(vtkDataSetAttributes::HIDDENCELL);
  bool shown = !cells || !(cells->GetValue(cell) & owner_or_hidden);
  if (shown && points) {
    vtkIdType count = 0;
    const vtkIdType* ids = nullptr;
    grid->GetCellPoints(cell, count, ids);
    shown = std::none_of(ids, ids + count, [points](vtkIdType id) { return points->GetValue(id) & vtkDataSetAttributes::HIDDENPOINT; });
  }
  return shown;
}

Grid extract(vtkUnstructuredGrid* from, vtkIdList* cells)
{
  vtkNew<vtkExtractCells> some;
  some->SetInputData(from);
  some->SetCellList(cells);
  some->PassThroughCellIdsOff();
  some->Update();
  Grid grid = some->GetOutput();
  return grid;
}

// Flags, or nullptr where there are none. Sets `problem` where there are too few or too many.
vtkUnsignedCharArray* find_flags(vtkUnsignedCharArray* flags, vtkIdType wanted, const char* things, std::string& problem)
{
  if (flags && flags->GetNumberOfValues() != wanted) {
    problem = "the ghost array of " + std::string(things) + " has " + std::to_string(flags->GetNumberOfValues()) + " values, there are " +
      std::to_string(wanted);
  }
  return flags;
}

// Lists the visible cells of a block that this rank owns. Returns nullptr, and sets `problem`, if the block can't be drawn.
Grid list_cells(vtkDataSet* leaf, int block, int rank, const stratus::Dealing& dealing, std::string& problem)
{
  const auto all = Grid::New();
  if (auto* listed = vtkUnstructuredGrid::SafeDownCast(leaf)) {
    all->CopyStructure(listed);
  } else {
    const auto bare = vtkSmartPointer<vtkDataSet>::Take(leaf->NewInstance());
    bare->CopyStructure(leaf);
    vtkNew<vtkAppendFilter> list;
    list->AddInputData(bare);
    list->Update();
    all->CopyStructure(list->GetOutput());
  }
  const auto attributes = [&dealing](vtkDataSet* grid) {
    return dealing.cells ? static_cast<vtkDataSetAttributes*>(grid->GetCellData()) : grid->GetPointData();
  };
  const vtkIdType wanted = dealing.cells ? leaf->GetNumberOfCells() : leaf->GetNumberOfPoints();
  for (const std::string& name : dealing.names) {
    vtkDataArray* array = attributes(leaf)->GetArray(name.c_str());
    if (!array || array->GetNumberOfTuples() < wanted) {
      problem = "the array \"" + name + "\" of " + (dealing.cells ? "cells" : "points") +
        (array ? " has " + std::to_string(array->GetNumberOfTuples()) + " values, there are " + std::to_string(wanted) : " is not there");
      return nullptr;
    }
    attributes(all)->AddArray(array);
  }
  add_order(leaf, block, rank, all);
  vtkUnsignedCharArray* cells = find_flags(leaf->GetCellGhostArray(), leaf->GetNumberOfCells(), "cells", problem);
  vtkUnsignedCharArray* points = find_flags(leaf->GetPointGhostArray(), leaf->GetNumberOfPoints(), "points", problem);
  if (!problem.empty()) {
    return nullptr;
  }
  if (!cells && !points) {
    return all;
  }
  vtkNew<vtkIdList> shown;
  for (vtkIdType cell = 0; cell < all->GetNumberOfCells(); ++cell) {
    if (shows(cells, points, all, cell)) {
      shown->InsertNextId(cell);
    }
  }
  return extract(all, shown);
}

// A rank's box, without ends where it is an end of all ranks' boxes: cells beyond are drawn, too.
std::vector<vtkBoundingBox> open_boxes(const std::vector<vtkBoundingBox>& boxes)
{
  vtkBoundingBox whole;
  for (const vtkBoundingBox& box : boxes) {
    if (box.IsValid()) {
      whole.AddBox(box);
    }
  }
  std::vector<vtkBoundingBox> open = boxes;
  for (vtkBoundingBox& box : open) {
    double bounds[6];
    box.GetBounds(bounds);
    for (int face = 0; face < 6 && box.IsValid(); ++face) {
      if (bounds[face] == whole.GetBound(face)) {
        bounds[face] = face % 2 ? std::numeric_limits<double>::max() : std::numeric_limits<double>::lowest();
      }
    }
    if (box.IsValid()) {
      box.SetBounds(bounds);
    }
  }
  return open;
}

bool reaches_into(const double cell[6], const vtkBoundingBox& box)
{
  bool reaches = box.IsValid() != 0;
  for (int axis = 0; reaches && axis < 3; ++axis) {
    reaches = cell[2 * axis] <= box.GetBound(2 * axis + 1) && cell[2 * axis + 1] >= box.GetBound(2 * axis);
  }
  return reaches;
}

bool within(const Place& point, const vtkBoundingBox& box)
{
  bool inside = true;
  for (int axis = 0; inside && axis < 3; ++axis) {
    inside = point[axis] > box.GetBound(2 * axis) && point[axis] < box.GetBound(2 * axis + 1);
  }
  return inside;
}

Place place_of(vtkUnstructuredGrid* grid, vtkIdType point)
{
  Place place;
  grid->GetPoint(point, place.data());
  return place;
}

class Dealer
{
public:
  Dealer(vtkMultiProcessController* controller, std::vector<Grid> blocks, const std::vector<vtkBoundingBox>& boxes)
      : Controller(controller), Blocks(std::move(blocks)), Boxes(open_boxes(boxes)), Ranks(controller->GetNumberOfProcesses())
  {
    this->Boxes.resize(static_cast<size_t>(this->Ranks));
    for (const Grid& block : this->Blocks) {
      this->Sent.emplace_back(static_cast<size_t>(this->Ranks * block->GetNumberOfCells()), false);
    }
  }

  // Sends each rank the cells that `belongs` names of those that it has not got, and keeps what comes here.
  template <typename Belongs> void Exchange(Belongs&& belongs)
  {
    for (int to = 0; to < this->Ranks; ++to) {
      vtkNew<vtkAppendFilter> join;
      for (size_t b = 0; b < this->Blocks.size(); ++b) {
        vtkUnstructuredGrid* block = this->Blocks[b];
        vtkNew<vtkIdList> cells;
        for (vtkIdType cell = 0; cell < block->GetNumberOfCells(); ++cell) {
          auto sent = this->Sent[b].begin() + static_cast<std::ptrdiff_t>(to * block->GetNumberOfCells() + cell);
          if (!*sent && belongs(block, cell, to)) {
            *sent = true;
            cells->InsertNextId(cell);
          }
        }
        if (cells->GetNumberOfIds() > 0) {
          join->AddInputData(extract(block, cells));
        }
      }
      const auto sent = Grid::New();
      if (join->GetNumberOfInputConnections(0) > 0) {
        join->Update();
        sent->ShallowCopy(join->GetOutput());
      }
      std::vector<vtkSmartPointer<vtkDataObject>> got;
      this->Controller->Gather(sent, got, to);
      for (const auto& part : got) {
        auto* grid = vtkUnstructuredGrid::SafeDownCast(part);
        if (to == this->Controller->GetLocalProcessId() && grid && grid->GetNumberOfCells() > 0) {
          this->Held.push_back(grid);
        }
      }
    }
  }

  void DealByBoxes()
  {
    this->Exchange([this](vtkUnstructuredGrid* block, vtkIdType cell, int to) {
      double bounds[6];
      block->GetCellBounds(cell, bounds);
      return reaches_into(bounds, this->Boxes[static_cast<size_t>(to)]);
    });
  }

  // Adds the cells about the points of those that are held. Cells about a point within the box are all there.
  void DealByPoints()
  {
    const vtkBoundingBox& box = this->Boxes[static_cast<size_t>(this->Controller->GetLocalProcessId())];
    std::vector<Place> mine;
    for (const Grid& grid : this->Held) {
      for (vtkIdType point = 0; point < grid->GetNumberOfPoints(); ++point) {
        const Place place = place_of(grid, point);
        if (this->Rounds > 0 || !within(place, box)) {
          mine.push_back(place);
        }
      }
    }
    std::sort(mine.begin(), mine.end());
    mine.erase(std::unique(mine.begin(), mine.end()), mine.end());
    ++this->Rounds;
    const vtkIdType length = 3 * static_cast<vtkIdType>(mine.size());
    std::vector<vtkIdType> lengths(static_cast<size_t>(this->Ranks)), offsets(lengths.size(), 0);
    this->Controller->AllGather(&length, lengths.data(), 1);
    std::partial_sum(lengths.begin(), lengths.end() - 1, offsets.begin() + 1);
    std::vector<double> flat(static_cast<size_t>(offsets.back() + lengths.back()) + 1); // data() of none may be nullptr
    mine.push_back({ 0.0, 0.0, 0.0 });
    this->Controller->AllGatherV(mine[0].data(), flat.data(), length, lengths.data(), offsets.data());
    std::vector<std::vector<Place>> borders(lengths.size());
    for (size_t rank = 0; rank < borders.size(); ++rank) {
      for (vtkIdType at = offsets[rank]; at < offsets[rank] + lengths[rank]; at += 3) {
        const auto a = static_cast<size_t>(at);
        borders[rank].push_back({ flat[a], flat[a + 1], flat[a + 2] });
      }
    }
    this->Exchange([&borders](vtkUnstructuredGrid* block, vtkIdType cell, int to) {
      const std::vector<Place>& border = borders[static_cast<size_t>(to)];
      vtkIdType count = 0;
      const vtkIdType* ids = nullptr;
      block->GetCellPoints(cell, count, ids);
      return std::any_of(
        ids, ids + count, [&](vtkIdType id) { return std::binary_search(border.begin(), border.end(), place_of(block, id)); });
    });
  }

  Grid Join(const stratus::Dealing& dealing) const;

private:
  vtkMultiProcessController* Controller;
  std::vector<Grid> Blocks;
  std::vector<vtkBoundingBox> Boxes;
  int Ranks, Rounds = 0;
  std::vector<std::vector<bool>> Sent; // of each block, a flag for each rank and cell
  std::vector<Grid> Held;
};

// Numbers points anew: new_number[point].
void renumber(vtkUnstructuredGrid* grid, const std::vector<vtkIdType>& new_number)
{
  vtkNew<vtkIdTypeArray> ids;
  ids->DeepCopy(grid->GetCells()->GetConnectivityArray());
  for (vtkIdType at = 0; at < ids->GetNumberOfValues(); ++at) {
    ids->SetValue(at, new_number[static_cast<size_t>(ids->GetValue(at))]);
  }
  vtkNew<vtkIdTypeArray> offsets;
  offsets->DeepCopy(grid->GetCells()->GetOffsetsArray());
  vtkNew<vtkCellArray> cells;
  cells->SetData(offsets, ids);
  const vtkSmartPointer<vtkUnsignedCharArray> types = grid->GetCellTypesArray();
  const vtkSmartPointer<vtkIdTypeArray> faces = grid->GetFaces(), starts = grid->GetFaceLocations();
  for (vtkIdType cell = 0; faces && starts && cell < starts->GetNumberOfValues(); ++cell) {
    vtkIdType at = starts->GetValue(cell);
    for (vtkIdType left = at >= 0 ? faces->GetValue(at++) : 0; left > 0; --left) {
      for (vtkIdType points = faces->GetValue(at++); points > 0; --points, ++at) {
        faces->SetValue(at, new_number[static_cast<size_t>(faces->GetValue(at))]);
      }
    }
  }
  grid->SetCells(types, cells, starts, faces);
}

Grid Dealer::Join(const stratus::Dealing& dealing) const
{
  const auto joined = Grid::New();
  if (this->Held.empty()) {
    return joined;
  }
  vtkNew<vtkAppendFilter> join;
  for (const Grid& part : this->Held) {
    join->AddInputData(part);
  }
  join->Update();
  joined->DeepCopy(join->GetOutput());
  auto* order = vtkTypeInt64Array::SafeDownCast(joined->GetPointData()->GetArray(OrderArray));
  if (!order) {
    return Grid::New();
  }
  std::vector<vtkDataArray*> values;
  for (size_t i = 0; !dealing.cells && i < dealing.names.size(); ++i) {
    values.push_back(joined->GetPointData()->GetArray(dealing.names[i].c_str()));
  }
  // Points that are equal stand side by side, the first of them in the order of all ranks first.
  const size_t count = static_cast<size_t>(joined->GetNumberOfPoints());
  std::vector<Place> places(count);
  for (size_t point = 0; point < count; ++point) {
    places[point] = place_of(joined, static_cast<vtkIdType>(point));
  }
  const auto compare_values = [&values](vtkIdType a, vtkIdType b) {
    for (vtkDataArray* array : values) {
      for (int c = 0; array && c < array->GetNumberOfComponents(); ++c) {
        const double x = array->GetComponent(a, c), y = array->GetComponent(b, c);
        if (x < y || y < x) {
          return x < y ? -1 : 1;
        }
      }
    }
    return 0;
  };
  const auto rank_of = [order](vtkIdType point) {
    return std::make_pair(order->GetTypedComponent(point, 0), order->GetTypedComponent(point, 1));
  };
  std::vector<vtkIdType> sorted(count), first(count), kept;
  std::iota(sorted.begin(), sorted.end(), 0);
  std::sort(sorted.begin(), sorted.end(), [&](vtkIdType a, vtkIdType b) {
    const Place &p = places[static_cast<size_t>(a)], &q = places[static_cast<size_t>(b)];
    const int by_values = p == q ? compare_values(a, b) : 0;
    return p != q ? p < q : by_values != 0 ? by_values < 0 : rank_of(a) < rank_of(b);
  });
  for (size_t at = 0; at < count; ++at) {
    const bool same = at > 0 && places[static_cast<size_t>(sorted[at])] == places[static_cast<size_t>(sorted[at - 1])] &&
      compare_values(sorted[at], sorted[at - 1]) == 0;
    first[static_cast<size_t>(sorted[at])] = same ? first[static_cast<size_t>(sorted[at - 1])] : sorted[at];
    if (!same) {
      kept.push_back(sorted[at]);
    }
  }
  std::sort(kept.begin(), kept.end(), [&rank_of](vtkIdType a, vtkIdType b) { return rank_of(a) < rank_of(b); });
  std::vector<vtkIdType> new_number(count, 0);
  for (size_t n = 0; n < kept.size(); ++n) {
    new_number[static_cast<size_t>(kept[n])] = static_cast<vtkIdType>(n);
  }
  for (size_t point = 0; point < count; ++point) {
    new_number[point] = new_number[static_cast<size_t>(first[point])];
  }
  vtkNew<vtkPoints> points;
  points->SetDataType(joined->GetPoints()->GetDataType());
  vtkNew<vtkPointData> data;
  data->CopyAllOn();
  data->CopyAllocate(joined->GetPointData(), static_cast<vtkIdType>(kept.size()));
  for (size_t n = 0; n < kept.size(); ++n) {
    points->InsertNextPoint(places[static_cast<size_t>(kept[n])].data());
    data->CopyData(joined->GetPointData(), kept[n], static_cast<vtkIdType>(n));
  }
  data->RemoveArray(OrderArray);
  renumber(joined, new_number);
  joined->SetPoints(points);
  joined->GetPointData()->ShallowCopy(data);
  return joined;
}
} // namespace

vtkSmartPointer<vtkUnstructuredGrid> stratus::deal_cells(vtkMultiProcessController* controller, vtkDataObject* mine,
  const std::vector<vtkBoundingBox>& boxes, const Dealing& dealing, std::string& problem)
{
  std::vector<vtkDataSet*> leaves;
  if (auto* grid = vtkDataSet::SafeDownCast(mine)) {
    leaves.push_back(grid);
  } else if (auto* tree = vtkCompositeDataSet::SafeDownCast(mine)) {
    const auto at = vtkSmartPointer<vtkCompositeDataIterator>::Take(tree->NewIterator());
    at->SkipEmptyNodesOff(); // blocks that other ranks have count
    for (at->InitTraversal(); !at->IsDoneWithTraversal(); at->GoToNextItem()) {
      leaves.push_back(vtkDataSet::SafeDownCast(at->GetCurrentDataObject()));
    }
  }
  std::vector<Grid> blocks;
  problem.clear();
  for (size_t b = 0; b < leaves.size(); ++b) {
    if (leaves[b] && leaves[b]->GetNumberOfCells() > 0) {
      std::string why;
      const Grid block = list_cells(leaves[b], static_cast<int>(b), controller->GetLocalProcessId(), dealing, why);
      if (block) {
        blocks.push_back(block);
      } else {
        problem = (leaves.size() > 1 ? "block " + std::to_string(b) + ": " : "") + why + "; it is not drawn";
      }
    }
  }
  Dealer dealer(controller, std::move(blocks), boxes);
  dealer.DealByBoxes();
  for (int layer = 0; layer < dealing.layers; ++layer) {
    dealer.DealByPoints();
  }
  return dealer.Join(dealing);
}
