// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusPieceDistanceMapFilter.h"

#include "vtkStratusRanks.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkIdTypeArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <utility>

vtkStandardNewMacro(vtkStratusPieceDistanceMapFilter);

vtkStratusPieceDistanceMapFilter::vtkStratusPieceDistanceMapFilter() = default;
vtkStratusPieceDistanceMapFilter::~vtkStratusPieceDistanceMapFilter() = default;

namespace {

// Intervals of a piece along an axis, in values: up to the first block's begin, and from there on, so that an interval begins with a block
// or is inside one.
std::vector<std::pair<int, int>> Stretches(int first, int last, int origin, int size)
{
  const int begin = origin + (first - origin + size - 1) / size * size;
  std::vector<std::pair<int, int>> stretches;
  if (begin > first) {
    stretches.emplace_back(first, std::min(begin, last));
  }
  if (begin < last || first == last) {
    stretches.emplace_back(std::min(begin, last), last);
  }
  return stretches;
}

// The cells of a piece that are no ghosts, which lie about the first and the last of them; empty where there are none.
void OwnedCells(vtkImageData* piece, int extent[6])
{
  piece->GetExtent(extent);
  vtkUnsignedCharArray* flags = piece->GetCellGhostArray();
  if (!flags || flags->GetNumberOfValues() != piece->GetNumberOfCells()) {
    return;
  }
  const int whole[6] = { extent[0], extent[1], extent[2], extent[3], extent[4], extent[5] };
  int found[6] = { 0, -1, 0, -1, 0, -1 };
  vtkIdType cell = 0;
  for (int k = whole[4]; k < std::max(whole[5], whole[4] + 1); ++k) {
    for (int j = whole[2]; j < std::max(whole[3], whole[2] + 1); ++j) {
      for (int i = whole[0]; i < std::max(whole[1], whole[0] + 1); ++i, ++cell) {
        const int place[3] = { i, j, k };
        if (flags->GetValue(cell) & vtkDataSetAttributes::DUPLICATECELL) {
          continue;
        }
        const bool first = found[1] < found[0];
        for (int a = 0; a < 3; ++a) {
          found[2 * a] = first ? place[a] : std::min(found[2 * a], place[a]);
          found[2 * a + 1] = first ? place[a] + 1 : std::max(found[2 * a + 1], place[a] + 1);
        }
      }
    }
  }
  std::copy_n(found, 6, extent);
}

// Lets ghosts of another piece count as values.
void ShowDuplicates(vtkDataSetAttributes* data, unsigned char duplicate)
{
  auto* flags = vtkUnsignedCharArray::SafeDownCast(data->GetArray(vtkDataSetAttributes::GhostArrayName()));
  if (flags) {
    vtkNew<vtkUnsignedCharArray> hidden;
    hidden->SetName(vtkDataSetAttributes::GhostArrayName());
    for (vtkIdType i = 0; i < flags->GetNumberOfValues(); ++i) {
      hidden->InsertNextValue(static_cast<unsigned char>(flags->GetValue(i) & ~duplicate));
    }
    data->AddArray(hidden);
  }
}
} // namespace

int vtkStratusPieceDistanceMapFilter::RequestUpdateExtent(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  const int done = this->Superclass::RequestUpdateExtent(request, inputs, outputs);
  if (stratus::count_ranks() > 1) {
    vtkInformation* input = inputs[0]->GetInformationObject(0);
    const int layers = vtkStreamingDemandDrivenPipeline::GetUpdateGhostLevel(outputs->GetInformationObject(0));
    input->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), std::max(layers, 1));
  }
  return done;
}

void vtkStratusPieceDistanceMapFilter::SetSettings(vtkStratusDistanceMapFilter* filter, int kind, int block)
{
  filter->SetKind(kind);
  filter->SetBlockSize(block);
  filter->SetOctant(this->Octant);
  filter->SetNumberOfThreads(this->NumberOfThreads);
  filter->SetDevice(this->GetDevice());
}

// Sets the blocks of the whole image that this rank's piece occupies. Each interval of the piece begins with a block or is inside one.
// Pieces and intervals share points, so that the values of a block's parts overlap, and a block is occupied if a part of it is.
bool vtkStratusPieceDistanceMapFilter::FindOccupied(
  vtkImageData* piece, bool cells, const Lattice& lattice, std::vector<unsigned char>& occupied)
{
  const auto values = vtkSmartPointer<vtkImageData>::Take(piece->NewInstance());
  values->ShallowCopy(piece);
  ShowDuplicates(values->GetCellData(), vtkDataSetAttributes::DUPLICATECELL);
  ShowDuplicates(values->GetPointData(), vtkDataSetAttributes::DUPLICATEPOINT);
  const int* extent = piece->GetExtent();
  std::vector<std::pair<int, int>> stretches[3];
  for (int a = 0; a < 3; ++a) {
    const int last = cells ? std::max(extent[2 * a + 1] - 1, extent[2 * a]) : extent[2 * a + 1];
    stretches[a] = Stretches(extent[2 * a], last, lattice.First[a], this->BlockSize);
  }
  for (const auto& z : stretches[2]) {
    for (const auto& y : stretches[1]) {
      for (const auto& x : stretches[0]) {
        const std::pair<int, int> of[3] = { x, y, z };
        int crop[6], first[3];
        for (int a = 0; a < 3; ++a) {
          crop[2 * a] = of[a].first;
          crop[2 * a + 1] = std::min(of[a].second + (cells ? 1 : 0), extent[2 * a + 1]);
          first[a] = std::min((of[a].first - lattice.First[a]) / this->BlockSize, lattice.Blocks[a] - 1);
        }
        vtkNew<vtkStratusDistanceMapFilter> part;
        const auto cut = vtkSmartPointer<vtkImageData>::Take(values->NewInstance());
        cut->ShallowCopy(values);
        cut->Crop(crop);
        this->SetSettings(part, BLOCK, this->BlockSize);
        part->ThresholdBetween(this->LowerThreshold, this->UpperThreshold);
        part->SetVolumeProperty(this->GetVolumeProperty());
        part->SetInputDataObject(cut);
        part->SetInputArrayToProcess(0, this->GetInputArrayInformation(0));
        part->Update();
        auto* map = vtkImageData::SafeDownCast(part->GetOutputDataObject(0));
        vtkDataArray* distances = map ? map->GetCellData()->GetArray("Distance") : nullptr;
        if (!distances) { // the part has said why
          return false;
        }
        int size[3];
        map->GetDimensions(size);
        for (vtkIdType block = 0; block < distances->GetNumberOfTuples(); ++block) {
          const int place[3] = { static_cast<int>(block % (size[0] - 1)), static_cast<int>(block / (size[0] - 1) % (size[1] - 1)),
            static_cast<int>(block / (static_cast<vtkIdType>(size[0] - 1) * (size[1] - 1))) };
          if (distances->GetTuple1(block) == 0.0) {
            const int at[3] = { first[0] + place[0], first[1] + place[1], first[2] + place[2] };
            if (at[0] < lattice.Blocks[0] && at[1] < lattice.Blocks[1] && at[2] < lattice.Blocks[2]) {
              occupied[static_cast<size_t>(lattice.GetNumber(at[0], at[1], at[2]))] = 1;
            }
          }
        }
      }
    }
  }
  return true;
}

// Takes the distances of an image that has one value within each block: 1 where it is occupied.
bool vtkStratusPieceDistanceMapFilter::FindDistances(
  const Lattice& lattice, const std::vector<unsigned char>& occupied, std::vector<unsigned char>& distances)
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(2 * lattice.Blocks[0] + 1, 2 * lattice.Blocks[1] + 1, 2 * lattice.Blocks[2] + 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  auto* values = vtkUnsignedCharArray::SafeDownCast(image->GetPointData()->GetScalars());
  values->FillValue(0);
  for (int k = 0; k < lattice.Blocks[2]; ++k) {
    for (int j = 0; j < lattice.Blocks[1]; ++j) {
      for (int i = 0; i < lattice.Blocks[0]; ++i) {
        int middle[3] = { 2 * i + 1, 2 * j + 1, 2 * k + 1 };
        values->SetValue(image->ComputePointId(middle), occupied[static_cast<size_t>(lattice.GetNumber(i, j, k))]);
      }
    }
  }
  vtkNew<vtkStratusDistanceMapFilter> filter;
  this->SetSettings(filter, this->Kind, 2);
  filter->ThresholdBetween(1.0, 1.0);
  filter->SetInputDataObject(image);
  filter->Update();
  auto* map = vtkImageData::SafeDownCast(filter->GetOutputDataObject(0));
  auto* found = map ? vtkUnsignedCharArray::SafeDownCast(map->GetCellData()->GetArray("Distance")) : nullptr;
  if (!found || found->GetNumberOfValues() != lattice.GetCount()) {
    return false;
  }
  distances.assign(found->GetPointer(0), found->GetPointer(0) + found->GetNumberOfValues());
  return true;
}

void vtkStratusPieceDistanceMapFilter::Fill(vtkImageData* piece, bool cells, const Lattice& lattice,
  const std::vector<unsigned char>& occupied, const std::vector<unsigned char>& distances, vtkImageData* output)
{
  int own[6], blocks[6];
  OwnedCells(piece, own);
  for (int a = 0; a < 3; ++a) { // a block is of the piece in which its first cell lies
    const int size = this->BlockSize;
    blocks[2 * a] = (own[2 * a] - lattice.First[a] + size - 1) / size;
    blocks[2 * a + 1] =
      own[2 * a] == own[2 * a + 1] ? 1 : std::min((own[2 * a + 1] - lattice.First[a] + size - 1) / size, lattice.Blocks[a]);
    if (own[2 * a + 1] < own[2 * a] || blocks[2 * a] >= blocks[2 * a + 1]) {
      output->Initialize();
      this->OccupiedBlocks = 0;
      return;
    }
  }
  double origin[3], spacing[3];
  piece->GetSpacing(spacing);
  const double first[3] = { lattice.First[0] + (cells ? 0.5 : 0.0), lattice.First[1] + (cells ? 0.5 : 0.0),
    lattice.First[2] + (cells ? 0.5 : 0.0) };
  piece->TransformContinuousIndexToPhysicalPoint(first, origin);
  output->Initialize();
  output->SetOrigin(origin);
  output->SetSpacing(this->BlockSize * spacing[0], this->BlockSize * spacing[1], this->BlockSize * spacing[2]);
  output->SetDirectionMatrix(piece->GetDirectionMatrix());
  output->SetExtent(blocks);
  vtkNew<vtkUnsignedCharArray> of;
  vtkNew<vtkIdTypeArray> numbers;
  of->SetName("Distance");
  numbers->SetName("StratusGlobalBlock");
  this->OccupiedBlocks = 0;
  for (int k = blocks[4]; k < blocks[5]; ++k) {
    for (int j = blocks[2]; j < blocks[3]; ++j) {
      for (int i = blocks[0]; i < blocks[1]; ++i) {
        const vtkIdType number = lattice.GetNumber(i, j, k);
        of->InsertNextValue(distances[static_cast<size_t>(number)]);
        numbers->InsertNextValue(number);
        this->OccupiedBlocks += occupied[static_cast<size_t>(number)];
      }
    }
  }
  output->GetCellData()->SetScalars(of);
  output->GetCellData()->AddArray(numbers);
}

int vtkStratusPieceDistanceMapFilter::RequestData(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkImageData* output = vtkImageData::GetData(outputs);
  vtkImageData* piece = vtkImageData::GetData(inputs[0]);
  if (stratus::count_ranks() == 1 || !output || this->BlockSize < 2) { // a size that is refused is an error on every rank
    const int done = this->Superclass::RequestData(request, inputs, outputs);
    vtkDataSet* map = vtkDataSet::GetData(outputs);
    vtkNew<vtkIdTypeArray> numbers;
    numbers->SetName("StratusGlobalBlock");
    for (vtkIdType block = 0; done && map && block < map->GetNumberOfCells(); ++block) {
      numbers->InsertNextValue(block);
    }
    if (done && map) {
      map->GetCellData()->AddArray(numbers);
    }
    return done;
  }
  vtkMultiProcessController* ranks = vtkMultiProcessController::GetGlobalController();
  const bool any = piece && piece->GetNumberOfCells() > 0;
  int association = vtkDataObject::FIELD_ASSOCIATION_POINTS;
  vtkDataArray* array = any ? this->GetInputArrayToProcess(0, piece, association) : nullptr;
  // Upper ends have their sign changed. The last two are flags: whether the array is of cells, and whether the rank has a piece.
  int mine[8] = { VTK_INT_MAX, VTK_INT_MAX, VTK_INT_MAX, VTK_INT_MAX, VTK_INT_MAX, VTK_INT_MAX, 0, 0 }, least[8];
  for (int a = 0; any && a < 6; ++a) {
    mine[a] = (a % 2 ? -1 : 1) * piece->GetExtent()[a];
  }
  mine[6] = array && association == vtkDataObject::FIELD_ASSOCIATION_CELLS ? -1 : 0;
  mine[7] = any ? -1 : 0;
  ranks->AllReduce(mine, least, 8, vtkCommunicator::MIN_OP);
  if (least[7] == 0) {
    return this->Superclass::RequestData(request, inputs, outputs); // which says that there is no image
  }
  const bool cells = least[6] != 0;
  Lattice lattice;
  for (int a = 0; a < 3; ++a) {
    lattice.First[a] = least[2 * a];
    const int last = cells ? std::max(-least[2 * a + 1] - 1, least[2 * a]) : -least[2 * a + 1];
    lattice.Blocks[a] = std::max(1, (last - lattice.First[a] + this->BlockSize - 1) / this->BlockSize);
  }
  std::vector<unsigned char> occupied(static_cast<size_t>(lattice.GetCount()), 0), all(occupied.size()), distances;
  int failed = any && !this->FindOccupied(piece, cells, lattice, occupied), any_failed = 0;
  ranks->AllReduce(occupied.data(), all.data(), lattice.GetCount(), vtkCommunicator::MAX_OP);
  failed = failed || !this->FindDistances(lattice, all, distances);
  ranks->AllReduce(&failed, &any_failed, 1, vtkCommunicator::MAX_OP);
  if (any_failed) {
    return 0;
  }
  if (any) {
    this->Fill(piece, cells, lattice, all, distances, output);
  } else {
    output->Initialize();
    this->OccupiedBlocks = 0;
  }
  return 1;
}
