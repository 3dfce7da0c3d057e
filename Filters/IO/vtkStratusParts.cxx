// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusParts.h"

#include "vtkStratusBricks.h"
#include "vtkStratusMakeArray.h"
#include "vtkStratusMapped.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkExtentTranslator.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationIntegerKey.h"
#include "vtkInformationIntegerRequestKey.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkRectilinearGrid.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStructuredGrid.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cstring>
#include <vector>

namespace {
using Pipeline = vtkStreamingDemandDrivenPipeline;

const int* ExtentOf(vtkDataSet* grid)
{
  if (auto* image = vtkImageData::SafeDownCast(grid)) {
    return image->GetExtent();
  }
  if (auto* axes = vtkRectilinearGrid::SafeDownCast(grid)) {
    return axes->GetExtent();
  }
  return vtkStructuredGrid::SafeDownCast(grid)->GetExtent();
}

int64_t CountOf(const vtkStratusBox& box)
{
  return box.Size[0] * box.Size[1] * box.Size[2];
}

vtkSmartPointer<vtkDataArray> Cut(vtkDataArray* from, const vtkStratusBox& whole, const vtkStratusBox& part)
{
  const auto to = vtkStratusMakeArray(from->GetDataType(), from->GetNumberOfComponents(), CountOf(part));
  const int64_t tuple = from->GetNumberOfComponents() * from->GetDataTypeSize();
  const char* const values = static_cast<const char*>(from->GetVoidPointer(0));
  char* at = static_cast<char*>(to->GetVoidPointer(0));
  for (int64_t z = part.Low[2]; z < part.Low[2] + part.Size[2]; ++z) {
    for (int64_t y = part.Low[1]; y < part.Low[1] + part.Size[1]; ++y, at += part.Size[0] * tuple) {
      const int64_t first = (z * whole.Size[1] + y) * whole.Size[0] + part.Low[0];
      std::memcpy(at, values + first * tuple, static_cast<size_t>(part.Size[0] * tuple));
    }
  }
  to->SetName(from->GetName());
  to->CopyInformation(from->GetInformation());
  return to;
}

void CutAll(vtkDataSetAttributes* data, const vtkStratusBox& whole, const vtkStratusBox& part)
{
  for (int i = 0; i < data->GetNumberOfArrays(); ++i) {
    vtkDataArray* const array = data->GetArray(i);
    if (array && array->GetNumberOfTuples() == CountOf(whole) && CountOf(whole) != CountOf(part)) {
      const int kind = data->IsArrayAnAttribute(i);
      const vtkSmartPointer<vtkDataArray> cut = Cut(array, whole, part);
      data->AddArray(cut); // in the place of the array of its name
      if (kind >= 0) {
        data->SetActiveAttribute(cut->GetName(), kind);
      }
    }
  }
}

vtkSmartPointer<vtkDataArray> CutAxis(vtkDataArray* axis, const vtkStratusBox& part, size_t a)
{
  return Cut(axis, { { { 0, 0, 0 } }, { { axis->GetNumberOfTuples(), 1, 1 } } }, { { { part.Low[a], 0, 0 } }, { { part.Size[a], 1, 1 } } });
}

// Whether a point or a cell of an index along an axis belongs to another part. Points between two parts belong to both.
bool IsDuplicate(int64_t index, int axis, const int owned[6], const int part[6], bool cells)
{
  const int low = owned[2 * axis], high = owned[2 * axis + 1] - (cells ? 1 : 0);
  return part[2 * axis] < part[2 * axis + 1] && (index < low || index > high);
}

void Flag(vtkDataSetAttributes* data, const int owned[6], const int part[6], bool cells, bool in_bricks)
{
  constexpr unsigned char duplicate = vtkDataSetAttributes::DUPLICATEPOINT;
  static_assert(duplicate == +vtkDataSetAttributes::DUPLICATECELL, "points and cells have one flag");
  const vtkStratusBox all = vtkStratusBoxOf(part, part, cells);
  std::array<std::vector<unsigned char>, 3> flags; // of the indices along each axis
  for (int a = 0; a < 3; ++a) {
    for (int64_t i = 0; i < all.Size[static_cast<size_t>(a)]; ++i) {
      flags[static_cast<size_t>(a)].push_back(IsDuplicate(part[2 * a] + i, a, owned, part, cells) ? duplicate : 0);
    }
  }
  const auto write = [flags](const int64_t lo[3], const int64_t size[3], void* values) {
    auto* to = static_cast<unsigned char*>(values);
    for (int64_t z = lo[2]; z < lo[2] + size[2]; ++z) {
      for (int64_t y = lo[1]; y < lo[1] + size[1]; ++y, to += size[0]) {
        const unsigned char row = flags[2][static_cast<size_t>(z)] | flags[1][static_cast<size_t>(y)];
        std::transform(flags[0].begin() + lo[0], flags[0].begin() + lo[0] + size[0], to,
          [row](unsigned char flag) { return static_cast<unsigned char>(flag | row); });
      }
    }
    return true;
  };
  const char* const name = vtkDataSetAttributes::GhostArrayName();
  auto* const before = vtkUnsignedCharArray::SafeDownCast(data->GetArray(name));
  vtkSmartPointer<vtkDataArray> array;
  if (in_bricks && !before) {
    vtkStratusBrickSource source;
    source.Name = name;
    source.Type = VTK_UNSIGNED_CHAR;
    source.Dimensions = all.Size;
    source.Brick = { { 1, 1, 1 } };
    source.Read = write;
    array = vtkStratusMakeBricks(source);
    if (array) {
      vtkStratusSetOnlyDuplicates(array);
    }
  }
  if (!array) {
    array = vtkStratusMakeArray(VTK_UNSIGNED_CHAR, 1, CountOf(all));
    array->SetName(name);
    const int64_t zero[3] = { 0, 0, 0 };
    auto* const to = static_cast<unsigned char*>(array->GetVoidPointer(0));
    write(zero, all.Size.data(), to);
    for (vtkIdType i = 0; before && i < before->GetNumberOfValues(); ++i) {
      to[i] |= before->GetValue(i);
    }
  }
  data->AddArray(array);
}
} // namespace

bool vtkStratusFindPart(vtkInformation* request, const int whole[6], int part[6], int owned[6])
{
  int all[6];
  std::copy_n(whole, 6, all);
  if (request->Has(Pipeline::UPDATE_EXTENT())) {
    request->Get(Pipeline::UPDATE_EXTENT(), all);
  }
  bool empty = false;
  for (int a = 0; a < 3; ++a) {
    all[2 * a] = std::max(all[2 * a], whole[2 * a]);
    all[2 * a + 1] = std::min(all[2 * a + 1], whole[2 * a + 1]);
    empty = empty || all[2 * a] > all[2 * a + 1];
  }
  std::copy_n(all, 6, part);
  std::copy_n(all, 6, owned);
  const int pieces = request->Has(Pipeline::UPDATE_NUMBER_OF_PIECES()) ? request->Get(Pipeline::UPDATE_NUMBER_OF_PIECES()) : 1;
  if (empty || pieces < 2) {
    return !empty;
  }
  const int piece = request->Get(Pipeline::UPDATE_PIECE_NUMBER());
  const int mode = request->Has(vtkExtentTranslator::UPDATE_SPLIT_MODE()) ? request->Get(vtkExtentTranslator::UPDATE_SPLIT_MODE())
                                                                          : vtkExtentTranslator::BLOCK_MODE;
  vtkNew<vtkExtentTranslator> translator;
  return translator->PieceToExtentThreadSafe(piece, pieces, Pipeline::GetUpdateGhostLevel(request), all, part, mode, 0) != 0 &&
    translator->PieceToExtentThreadSafe(piece, pieces, 0, all, owned, mode, 0) != 0;
}

vtkStratusBox vtkStratusBoxOf(const int whole[6], const int part[6], bool cells)
{
  vtkStratusBox box;
  for (size_t a = 0; a < 3; ++a) {
    const int64_t all = std::max(whole[2 * a + 1] - whole[2 * a], 1), size = part[2 * a + 1] - part[2 * a];
    box.Low[a] = part[2 * a] - whole[2 * a];
    box.Size[a] = size + 1;
    if (cells) { // a flat part has a layer of cells
      box.Low[a] = std::min(box.Low[a], all - 1);
      box.Size[a] = std::max<int64_t>(size, 1);
    }
  }
  return box;
}

void vtkStratusCutGrid(vtkDataSet* grid, const int whole[6], const int part[6])
{
  if (std::equal(whole, whole + 6, part)) {
    return;
  }
  const vtkStratusBox all = vtkStratusBoxOf(whole, whole, false), box = vtkStratusBoxOf(whole, part, false);
  CutAll(grid->GetPointData(), all, box);
  CutAll(grid->GetCellData(), vtkStratusBoxOf(whole, whole, true), vtkStratusBoxOf(whole, part, true));
  int extent[6];
  std::copy_n(part, 6, extent);
  if (auto* image = vtkImageData::SafeDownCast(grid)) {
    image->SetExtent(extent);
  } else if (auto* axes = vtkRectilinearGrid::SafeDownCast(grid)) {
    axes->SetExtent(extent);
    axes->SetXCoordinates(CutAxis(axes->GetXCoordinates(), box, 0));
    axes->SetYCoordinates(CutAxis(axes->GetYCoordinates(), box, 1));
    axes->SetZCoordinates(CutAxis(axes->GetZCoordinates(), box, 2));
  } else if (auto* curved = vtkStructuredGrid::SafeDownCast(grid)) {
    vtkNew<vtkPoints> points;
    points->SetData(Cut(curved->GetPoints()->GetData(), all, box));
    curved->SetExtent(extent);
    curved->SetPoints(points);
  }
}

void vtkStratusFlagDuplicates(vtkDataSet* grid, const int owned[6], bool in_bricks)
{
  const int* const part = ExtentOf(grid);
  if (!std::equal(owned, owned + 6, part)) {
    Flag(grid->GetPointData(), owned, part, false, in_bricks);
    Flag(grid->GetCellData(), owned, part, true, in_bricks);
  }
}
