// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusVDBReader.h"

#include "vtkStratusBricks.h"
#include "vtkStratusIdentity.h"
#include "vtkStratusMakeArray.h"
#include "vtkStratusMappedFile.h"
#include "vtkStratusParts.h"
#include "vtkStratusSparseGrid.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <new>

vtkStandardNewMacro(vtkStratusVDBReader);

namespace {
constexpr double Orthogonal = 1e-6;       // largest cosine of the angle between two axes: the rounding error of a rotation in floats
constexpr double MostBrickBytes = 0x1p40; // addresses, of the 2^47 that a process has
constexpr int64_t BrickSide = 32;         // voxels: 64 leaves

std::string WriteBytes(double bytes)
{
  char text[64];
  std::snprintf(text, sizeof text, bytes < 1e15 ? "%.0f bytes (%.4g MiB)" : "%.4g bytes (%.4g MiB)", bytes, bytes / 1048576.0);
  return text;
}

std::string WriteBox(const vtkStratusSparseGrid& grid)
{
  std::string text;
  for (int a = 0; a < 3; ++a) {
    text += (a ? ", " : "") + std::to_string(grid.Low[a]) + ".." + std::to_string(grid.High[a]);
  }
  return text;
}

double VoxelBytes(const vtkStratusSparseGrid& grid)
{
  return static_cast<double>(vtkDataArray::GetDataTypeSize(grid.Type)) * grid.Components;
}

double ImageBytes(const vtkStratusSparseGrid& grid)
{
  double bytes = VoxelBytes(grid);
  for (int a = 0; a < 3; ++a) {
    bytes *= static_cast<double>(grid.High[a] - grid.Low[a] + 3);
  }
  return bytes;
}

// Gives the extent of a block's cells that are in a part. Returns false if none is.
bool Clip(const vtkStratusCellBox& box, const int part[6], int extent[6])
{
  bool any = true;
  for (int a = 0; a < 3; ++a) {
    extent[2 * a] = static_cast<int>(std::max<int64_t>(box.Low[a], part[2 * a]));
    extent[2 * a + 1] = static_cast<int>(std::min<int64_t>(box.High[a], part[2 * a + 1]));
    any = any && extent[2 * a] < extent[2 * a + 1];
  }
  return any;
}

double Length(const vtkStratusSparseGrid& grid, size_t axis)
{
  return std::sqrt(
    grid.Matrix[axis] * grid.Matrix[axis] + grid.Matrix[3 + axis] * grid.Matrix[3 + axis] + grid.Matrix[6 + axis] * grid.Matrix[6 + axis]);
}
} // namespace

vtkStratusVDBReader::vtkStratusVDBReader()
{
  this->GivesParts = true;
}

vtkStratusVDBReader::~vtkStratusVDBReader() = default;

void vtkStratusVDBReader::Fail(const std::string& why) const
{
  throw vtkStratusReadError{ std::string(this->FileName) + ": " + why };
}

std::string vtkStratusVDBReader::Inspect()
{
  const std::unique_ptr<vtkStratusSparseFile> file = vtkStratusSparseFile::Open(this->FileName);
  std::string others;
  this->Grid.reset();
  for (const vtkStratusSparseFile::Entry& one : file->GetEntries()) {
    if (one.Known) {
      this->Variables.push_back({ one.Name, "", one.Kind });
    } else {
      others += (others.empty() ? "" : ", ") + ("'" + one.Name + "' of " + one.Kind);
    }
  }
  if (this->Variables.empty()) {
    this->Fail("there is no grid of numbers or vectors; the file has: " + (others.empty() ? "no grid" : others));
  }
  this->GridName = this->ChosenName();
  this->Grid = file->Read(this->GridName);
  this->Description = this->Grid->Kind + ", " + std::to_string(this->Grid->Active) + " active voxels in a sparse grid of " +
    WriteBytes(static_cast<double>(this->Grid->Bytes));
  this->CheckMap();
  this->FindExtent();
  this->Description += this->Grid->Empty ? ": nothing but background" : ", within " + WriteBox(*this->Grid);
  const bool blocks = this->ChooseBlocks();
  this->Description += blocks || this->Grid->Empty ? "" : ": an image of this box and a border of one voxel";
  this->Description += others.empty() ? "" : "; left out: " + others;
  return blocks ? "vtkPartitionedDataSet" : "vtkImageData";
}

void vtkStratusVDBReader::FindExtent()
{
  const vtkStratusSparseGrid& grid = *this->Grid;
  for (int a = 0; a < 3; ++a) {
    if (grid.Low[a] > grid.High[a] || grid.Low[a] <= INT_MIN || grid.High[a] >= INT_MAX) {
      this->Fail("the box of the active voxels of '" + this->GridName + "' is " + WriteBox(grid) +
        "; bounds must rise and be within -2147483647..2147483646");
    }
    this->WholeExtent[2 * a] = static_cast<int>(grid.Low[a] - 1);
    this->WholeExtent[2 * a + 1] = static_cast<int>(grid.High[a] + 1);
  }
}

// Chooses between an image and blocks, which it divides.
bool vtkStratusVDBReader::ChooseBlocks()
{
  constexpr size_t most = 256; // pictures take a time that grows with them
  const vtkStratusSparseGrid& grid = *this->Grid;
  const double limit = 1048576.0 * static_cast<double>(this->MemoryLimit), image = ImageBytes(grid);
  const double memory = vtkStratusHasBrickMemory() ? static_cast<double>(vtkStratusGetBrickMemory()) : 0.0; // 0: no limit is set
  const bool wanted = (this->MapFile && image >= static_cast<double>(this->MappedBytesLeast)) || (memory > 0.0 && image > memory);
  const bool bricks = wanted && grid.InFile && image <= MostBrickBytes && vtkStratusHasBricks();
  const std::string takes = ". The sparse grid takes " + WriteBytes(static_cast<double>(grid.Bytes)) + "; the limit is " +
    std::to_string(this->MemoryLimit) + " MiB (MemoryLimit)";
  double blocks = 0.0;
  this->Blocks.clear();
  this->LeavesImage = bricks;
  if (this->Layout == IMAGE_LAYOUT || grid.Empty || (this->Layout == AUTO_LAYOUT && image <= limit)) {
    if (image > limit && !bricks) {
      this->Fail("the grid '" + this->GridName + "' would take " + WriteBytes(image) + " as an image: its active voxels are within " +
        WriteBox(grid) + takes);
    }
    return false;
  }
  this->Blocks = vtkStratusDivide(grid.ListActive(), most);
  for (const vtkStratusCellBox& box : this->Blocks) {
    blocks += VoxelBytes(grid) * vtkStratusVoxelsOf(box);
  }
  if (bricks && (blocks > limit || (memory > 0.0 && blocks > memory))) {
    this->Blocks.clear();
    return false;
  }
  if (blocks > limit) {
    this->Fail("the grid '" + this->GridName + "' would take " + WriteBytes(blocks) + " as " + std::to_string(this->Blocks.size()) +
      " blocks, and " + WriteBytes(image) + " as an image" + takes);
  }
  this->Description +=
    "; " + std::to_string(this->Blocks.size()) + " blocks of " + WriteBytes(blocks) + " in place of an image of " + WriteBytes(image);
  return true;
}

// An image has axes at right angles.
void vtkStratusVDBReader::CheckMap()
{
  const vtkStratusSparseGrid& grid = *this->Grid;
  const double* m = grid.Matrix.data();
  for (size_t a = 0; a < 3; ++a) {
    const double length = Length(grid, a);
    if (!(length > 0.0) || !std::isfinite(length) || !std::isfinite(grid.Offset[a])) {
      this->Fail("the grid '" + this->GridName + "' has voxels of the size " + std::to_string(length) + " along " + "xyz"[a] +
        ", which must be above 0 and finite");
    }
  }
  for (size_t a = 0; a < 3; ++a) {
    const size_t b = (a + 1) % 3;
    const double cosine = (m[a] * m[b] + m[3 + a] * m[3 + b] + m[6 + a] * m[6 + b]) / (Length(grid, a) * Length(grid, b));
    if (!(std::fabs(cosine) <= Orthogonal)) {
      this->Fail("the map of the grid '" + this->GridName + "' shears: its axes " + "xyz"[a] + " and " + "xyz"[b] + " meet at " +
        std::to_string(std::acos(cosine) * 180.0 / std::acos(-1.0)) + " degrees, an image needs 90");
    }
  }
}

// Returns the values of the image's part as bricks. Null where they can't be.
vtkSmartPointer<vtkDataArray> vtkStratusVDBReader::LeaveValues(const std::shared_ptr<vtkStratusSparseGrid>& grid) const
{
  vtkStratusBrickSource source;
  std::array<int64_t, 3> origin;
  const vtkStratusBox part = vtkStratusBoxOf(this->WholeExtent, this->Part, false);
  source.Name = this->GridName;
  source.Type = grid->Type;
  source.Components = grid->Components;
  source.Identity = vtkStratusIdentityOfPart(vtkStratusIdentityOfFile(this->FileName, 0, -1), this->GridName, {});
  for (size_t a = 0; a < 3; ++a) {
    origin[a] = this->WholeExtent[2 * a];
    source.Dimensions[a] = this->WholeExtent[2 * a + 1] - origin[a] + 1;
    source.Brick[a] = BrickSide;
    source.Before[a] = origin[a] & (BrickSide - 1); // nodes begin at multiples of their side, also below 0
  }
  const size_t voxel = static_cast<size_t>(vtkDataArray::GetDataTypeSize(grid->Type)) * static_cast<size_t>(grid->Components);
  source.Read = [grid, origin, voxel](const int64_t lo[3], const int64_t size[3], void* values) {
    int64_t low[3], high[3];
    for (size_t a = 0; a < 3; ++a) {
      low[a] = origin[a] + lo[a];
      high[a] = low[a] + size[a] - 1;
    }
    std::memset(values, 0, voxel * static_cast<size_t>(size[0] * size[1] * size[2]));
    try {
      grid->Write(values, low, high);
    } catch (const vtkStratusReadError&) { // the mapper reports it
      return false;
    } catch (const std::bad_alloc&) {
      return false;
    }
    return true;
  };
  vtkStratusCutSource(source, part.Low, part.Size);
  const int64_t first[3] = { this->Part[0], this->Part[2], this->Part[4] }, last[3] = { this->Part[1], this->Part[3], this->Part[5] };
  source.Only = grid->ListOnly(first, last, BrickSide);
  return vtkStratusMakeBricks(source);
}

void vtkStratusVDBReader::BuildImage(
  vtkImageData* image, const vtkStratusSparseGrid& grid, const int extent[6], vtkSmartPointer<vtkDataArray> values) const
{
  double spacing[3], direction[9];
  int64_t low[3], high[3];
  for (size_t i = 0; i < 9; ++i) {
    direction[i] = grid.Matrix[i] / Length(grid, i % 3);
  }
  for (int a = 0; a < 3; ++a) {
    spacing[a] = Length(grid, static_cast<size_t>(a));
    low[a] = extent[2 * a];
    high[a] = extent[2 * a + 1];
  }
  image->SetExtent(extent[0], extent[1], extent[2], extent[3], extent[4], extent[5]);
  image->SetOrigin(grid.Offset.data());
  image->SetSpacing(spacing);
  image->SetDirectionMatrix(direction);
  if (!values) {
    values = vtkStratusMakeArray(grid.Type, grid.Components, image->GetNumberOfPoints());
    grid.Write(values->GetVoidPointer(0), low, high);
    values->SetName(this->GridName.c_str());
  }
  image->GetPointData()->AddArray(values);
  if (grid.Components == 1) {
    image->GetPointData()->SetActiveScalars(this->GridName.c_str());
  } else {
    image->GetPointData()->SetActiveVectors(this->GridName.c_str());
  }
}

void vtkStratusVDBReader::Build(size_t step, vtkDataObject* output)
{
  std::shared_ptr<vtkStratusSparseGrid> grid = std::move(this->Grid);
  if (!grid) {
    grid = vtkStratusSparseFile::Open(this->FileName)->Read(this->GridName);
    if (!this->Blocks.empty()) {
      grid->ListActive(); // so that the file is read once, and not for each block
    }
  }
  this->Mapped = 0;
  if (vtkImageData* image = vtkImageData::SafeDownCast(output)) {
    vtkSmartPointer<vtkDataArray> values;
    if (this->LeavesImage && grid->InFile) {
      values = this->BricksOf(step, [this, &grid](size_t) { return this->LeaveValues(grid); });
    }
    const vtkStratusBox part = vtkStratusBoxOf(this->WholeExtent, this->Part, false);
    const double bytes = VoxelBytes(*grid) * static_cast<double>(part.Size[0]) * static_cast<double>(part.Size[1] * part.Size[2]);
    if (!values && bytes > 1048576.0 * static_cast<double>(this->MemoryLimit)) {
      throw std::bad_alloc();
    }
    this->Mapped = values ? 1 : 0;
    this->BuildImage(image, *grid, this->Part, values);
    return;
  }
  vtkPartitionedDataSet* parts = vtkPartitionedDataSet::SafeDownCast(output);
  parts->Initialize();
  for (const vtkStratusCellBox& box : this->Blocks) {
    int extent[6], owned[6];
    if (Clip(box, this->OwnedPart, owned) && Clip(box, this->Part, extent)) {
      vtkNew<vtkImageData> block;
      this->BuildImage(block, *grid, extent);
      vtkStratusFlagDuplicates(block, owned, false);
      parts->SetPartition(parts->GetNumberOfPartitions(), block);
    }
  }
}

int vtkStratusVDBReader::FillOutputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkDataObject"); // an image, or blocks
  return 1;
}

void vtkStratusVDBReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Layout: " << this->Layout << "\n";
  os << indent << "MemoryLimit: " << this->MemoryLimit << "\n";
}
