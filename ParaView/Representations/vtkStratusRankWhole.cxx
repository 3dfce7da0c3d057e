// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusRankWhole.h"

#include "vtkStratusMapped.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"
#include "vtkMultiProcessController.h"
#include "vtkPointData.h"
#include "vtkRectilinearGrid.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <memory>
#include <new>

namespace {

enum Kind { NONE, IMAGE, RECTILINEAR };

// A rank's description of its piece, as numbers: a kind, an extent, and properties that must be equal on all ranks.
constexpr size_t FIXED = 1 + 6 + 15;

vtkDataSetAttributes* attributes_of(vtkDataSet* grid, bool cells)
{
  return cells ? static_cast<vtkDataSetAttributes*>(grid->GetCellData()) : grid->GetPointData();
}

std::vector<double> describe(vtkDataSet* piece, const std::vector<std::string>& names, bool cells)
{
  std::vector<double> described(FIXED + 2 * names.size(), 0.0);
  auto* image = vtkImageData::SafeDownCast(piece);
  auto* rectilinear = vtkRectilinearGrid::SafeDownCast(piece);
  if ((!image && !rectilinear) || piece->GetNumberOfPoints() == 0) {
    return described;
  }
  described[0] = image ? IMAGE : RECTILINEAR;
  std::copy_n(image ? image->GetExtent() : rectilinear->GetExtent(), 6, described.begin() + 1);
  if (image) {
    std::copy_n(image->GetOrigin(), 3, described.begin() + 7);
    std::copy_n(image->GetSpacing(), 3, described.begin() + 10);
    std::copy_n(image->GetDirectionMatrix()->GetData(), 9, described.begin() + 13);
  }
  const vtkIdType wanted = cells ? piece->GetNumberOfCells() : piece->GetNumberOfPoints();
  for (size_t i = 0; i < names.size(); ++i) {
    vtkDataArray* array = attributes_of(piece, cells)->GetArray(names[i].c_str());
    if (array && array->GetNumberOfTuples() == wanted && array->HasStandardMemoryLayout()) {
      described[FIXED + 2 * i] = array->GetDataType();
      described[FIXED + 2 * i + 1] = array->GetNumberOfComponents();
    }
  }
  return described;
}

// The extent of a piece's values, of points or of cells. A flat grid has a layer of cells.
struct Box {
  int from[3], to[3]; // from <= index < to

  Box(const double extent[6], bool cells)
  {
    for (int axis = 0; axis < 3; ++axis) {
      from[axis] = static_cast<int>(extent[2 * axis]);
      to[axis] = static_cast<int>(extent[2 * axis + 1]) + 1;
      to[axis] -= cells && to[axis] - from[axis] > 1;
    }
  }
  vtkIdType count() const
  {
    vtkIdType values = 1;
    for (int axis = 0; axis < 3; ++axis) {
      values *= to[axis] - from[axis];
    }
    return values;
  }
};

// Copies rows of a piece's values to their places in the whole.
void place(const Box& part, const unsigned char* values, const Box& whole, size_t size, unsigned char* to)
{
  const size_t row = size * static_cast<size_t>(part.to[0] - part.from[0]);
  const vtkIdType nx = whole.to[0] - whole.from[0], ny = whole.to[1] - whole.from[1];
  for (int z = part.from[2]; z < part.to[2]; ++z) {
    for (int y = part.from[1]; y < part.to[1]; ++y, values += row) {
      const vtkIdType at = ((z - whole.from[2]) * ny + y - whole.from[1]) * nx + part.from[0] - whole.from[0];
      std::copy_n(values, row, to + size * static_cast<size_t>(at));
    }
  }
}

class Gathering
{
public:
  Gathering(vtkMultiProcessController* controller, const std::vector<double>& described, size_t length)
      : Controller(controller), Described(described), Length(length), Ranks(described.size() / length)
  {
  }

  const double* of(size_t rank) const { return this->Described.data() + rank * this->Length; }

  // Whether all pieces are of one grid with the same arrays. Finds the first rank that has any, and the extent of the whole.
  bool Fit()
  {
    this->First = 0;
    while (this->First < this->Ranks && this->of(this->First)[0] == NONE) {
      ++this->First;
    }
    if (this->First == this->Ranks) {
      return false;
    }
    const double* first = this->of(this->First);
    std::copy_n(first + 1, 6, this->Extent);
    bool fit = std::all_of(first + FIXED, first + this->Length, [](double number) { return number > 0.0; });
    for (size_t rank = this->First; rank < this->Ranks; ++rank) {
      const double* piece = this->of(rank);
      if (piece[0] != NONE) {
        fit = fit && piece[0] == first[0] && std::equal(piece + 7, piece + this->Length, first + 7);
        for (int side = 0; side < 6; ++side) {
          this->Extent[side] = side % 2 ? std::max(this->Extent[side], piece[1 + side]) : std::min(this->Extent[side], piece[1 + side]);
        }
      }
    }
    return fit;
  }

  // Puts together what ranks have in boxes of their own; `to` is of rank 0 and may be nullptr elsewhere.
  void Gather(const void* mine, size_t size, bool cells, void* to) const
  {
    const size_t me = static_cast<size_t>(this->Controller->GetLocalProcessId());
    std::vector<vtkIdType> lengths(this->Ranks, 0), offsets(this->Ranks, 0);
    vtkIdType all = 0;
    for (size_t rank = 0; rank < this->Ranks; ++rank) {
      const double* piece = this->of(rank);
      lengths[rank] = piece[0] != NONE ? Box(piece + 1, cells).count() * static_cast<vtkIdType>(size) : 0;
      offsets[rank] = all;
      all += lengths[rank];
    }
    std::vector<unsigned char> got(me == 0 ? static_cast<size_t>(all) : 0);
    this->Controller->GatherV(static_cast<const unsigned char*>(mine), got.data(), lengths[me], lengths.data(), offsets.data(), 0);
    for (size_t rank = 0; me == 0 && rank < this->Ranks; ++rank) {
      if (lengths[rank] > 0) {
        place(Box(this->of(rank) + 1, cells), got.data() + offsets[rank], Box(this->Extent, cells), size, static_cast<unsigned char*>(to));
      }
    }
  }

  void GatherPlanes(vtkRectilinearGrid* mine, int axis, double* to) const
  {
    std::vector<vtkIdType> lengths(this->Ranks, 0), offsets(this->Ranks, 0);
    vtkIdType all = 0;
    for (size_t rank = 0; rank < this->Ranks; ++rank) {
      const double* extent = this->of(rank) + 1 + 2 * axis;
      lengths[rank] = this->of(rank)[0] != NONE ? static_cast<vtkIdType>(extent[1] - extent[0]) + 1 : 0;
      offsets[rank] = all;
      all += lengths[rank];
    }
    std::vector<double> own, got(to ? static_cast<size_t>(all) : 0);
    for (vtkIdType i = 0; mine && i < lengths[static_cast<size_t>(this->Controller->GetLocalProcessId())]; ++i) {
      vtkDataArray* planes = axis == 0 ? mine->GetXCoordinates() : axis == 1 ? mine->GetYCoordinates() : mine->GetZCoordinates();
      own.push_back(planes->GetComponent(i, 0));
    }
    this->Controller->GatherV(own.data(), got.data(), static_cast<vtkIdType>(own.size()), lengths.data(), offsets.data(), 0);
    for (size_t rank = 0; to && rank < this->Ranks; ++rank) {
      const auto first = static_cast<vtkIdType>(this->of(rank)[1 + 2 * axis] - this->Extent[2 * axis]);
      std::copy_n(got.begin() + offsets[rank], lengths[rank], to + (lengths[rank] > 0 ? first : 0));
    }
  }

  vtkMultiProcessController* Controller;
  const std::vector<double>& Described;
  size_t Length, Ranks, First = 0;
  double Extent[6] = { 0., 0., 0., 0., 0., 0. };
};

// Flags without those that say which rank owns a cell: here one rank has all.
void gather_hidden(const Gathering& pieces, vtkDataSet* piece, bool cells, vtkDataSet* whole)
{
  vtkUnsignedCharArray* flags = !piece ? nullptr : cells ? piece->GetCellGhostArray() : piece->GetPointGhostArray();
  constexpr unsigned char owned = vtkDataSetAttributes::DUPLICATECELL;
  static_assert(owned == +vtkDataSetAttributes::DUPLICATEPOINT, "points and cells have one flag");
  const vtkIdType count = piece ? (cells ? piece->GetNumberOfCells() : piece->GetNumberOfPoints()) : 0;
  std::vector<unsigned char> mine(static_cast<size_t>(count), 0);
  if (flags && flags->GetNumberOfValues() == count) {
    std::transform(flags->GetPointer(0), flags->GetPointer(0) + count, mine.begin(),
      [](unsigned char flag) { return static_cast<unsigned char>(flag & ~owned); });
  }
  const int any = std::any_of(mine.begin(), mine.end(), [](unsigned char flag) { return flag != 0; });
  int all = 0;
  pieces.Controller->AllReduce(&any, &all, 1, vtkCommunicator::MAX_OP);
  if (all) {
    vtkNew<vtkUnsignedCharArray> joined;
    joined->SetName(vtkDataSetAttributes::GhostArrayName());
    if (whole) {
      joined->SetNumberOfValues(cells ? whole->GetNumberOfCells() : whole->GetNumberOfPoints());
      joined->FillValue(0);
      attributes_of(whole, cells)->AddArray(joined);
    }
    pieces.Gather(mine.data(), 1, cells, whole ? joined->GetPointer(0) : nullptr);
  }
}

bool has_room(double bytes)
{
  const std::unique_ptr<char[]> trial(new (std::nothrow) char[static_cast<size_t>(bytes)]);
  return trial != nullptr;
}

vtkSmartPointer<vtkDataSet> make_whole(const Gathering& pieces, vtkDataSet* piece, const double* first, bool root)
{
  int extent[6];
  std::copy_n(pieces.Extent, 6, extent);
  if (first[0] == IMAGE) {
    const auto image = vtkSmartPointer<vtkImageData>::New();
    image->SetExtent(extent);
    image->SetOrigin(first + 7);
    image->SetSpacing(first + 10);
    image->SetDirectionMatrix(first + 13);
    return image;
  }
  const auto grid = vtkSmartPointer<vtkRectilinearGrid>::New();
  grid->SetExtent(extent);
  for (int axis = 0; axis < 3; ++axis) {
    vtkNew<vtkDoubleArray> joined;
    joined->SetNumberOfValues(root ? extent[2 * axis + 1] - extent[2 * axis] + 1 : 0);
    pieces.GatherPlanes(vtkRectilinearGrid::SafeDownCast(piece), axis, root ? joined->GetPointer(0) : nullptr);
    axis == 0 ? grid->SetXCoordinates(joined) : axis == 1 ? grid->SetYCoordinates(joined) : grid->SetZCoordinates(joined);
  }
  return grid;
}
} // namespace

vtkSmartPointer<vtkDataSet> stratus::gather_whole(vtkMultiProcessController* controller, vtkDataSet* piece,
  const std::vector<std::string>& names, bool cells, vtkIdType most, bool& gathered)
{
  const std::vector<double> mine = describe(piece, names, cells);
  std::vector<double> described(mine.size() * static_cast<size_t>(controller->GetNumberOfProcesses()));
  controller->AllGather(mine.data(), described.data(), static_cast<vtkIdType>(mine.size()));
  Gathering pieces(controller, described, mine.size());
  gathered = pieces.Fit();
  if (!gathered) {
    return nullptr;
  }
  const double* first = pieces.of(pieces.First);
  const Box box(pieces.Extent, cells);
  double bytes = 0.0, values = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    values *= pieces.Extent[2 * axis + 1] - pieces.Extent[2 * axis] + 1.0;
  }
  for (size_t i = 0; i < names.size(); ++i) {
    bytes += values * first[FIXED + 2 * i + 1] * vtkDataArray::GetDataTypeSize(static_cast<int>(first[FIXED + 2 * i]));
  }
  gathered = bytes <= static_cast<double>(most);
  const bool root = controller->GetLocalProcessId() == 0;
  const int room = gathered && has_room(root ? 2.0 * bytes + 4.0 * values : values); // gathered values and the grid's; flags
  int all_room = 0;
  controller->AllReduce(&room, &all_room, 1, vtkCommunicator::MIN_OP);
  gathered = all_room != 0;
  if (!gathered) {
    return nullptr;
  }
  if (mine[0] == NONE) {
    piece = nullptr;
  }
  vtkSmartPointer<vtkDataSet> whole = make_whole(pieces, piece, first, root);
  if (!root) {
    whole = nullptr;
  }
  for (size_t i = 0; i < names.size(); ++i) {
    const auto joined = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(static_cast<int>(first[FIXED + 2 * i])));
    joined->SetNumberOfComponents(static_cast<int>(first[FIXED + 2 * i + 1]));
    joined->SetName(names[i].c_str());
    if (root) {
      joined->SetNumberOfTuples(box.count());
      joined->Fill(0.0); // where no rank has a piece
      attributes_of(whole, cells)->AddArray(joined);
    }
    const size_t size = static_cast<size_t>(joined->GetDataTypeSize()) * static_cast<size_t>(joined->GetNumberOfComponents());
    vtkDataArray* own = piece ? attributes_of(piece, cells)->GetArray(names[i].c_str()) : nullptr;
    std::vector<unsigned char> values;
    if (own && vtkStratusReadsOf(own)) { // bricks, which MPI cannot read
      const auto* const from = static_cast<const unsigned char*>(own->GetVoidPointer(0));
      values.assign(from, from + size * static_cast<size_t>(own->GetNumberOfTuples()));
    }
    const void* const mine_of = !own ? nullptr : values.empty() ? own->GetVoidPointer(0) : values.data();
    pieces.Gather(mine_of, size, cells, root ? joined->GetVoidPointer(0) : nullptr);
  }
  gather_hidden(pieces, piece, false, whole);
  gather_hidden(pieces, piece, true, whole);
  return whole;
}
