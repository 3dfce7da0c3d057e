// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusVDBReader.h"

#include "vtkStratusMakeArray.h"
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

vtkStandardNewMacro(vtkStratusVDBReader);

namespace {
constexpr double Orthogonal = 1e-6; // largest cosine of the angle between two axes: the rounding error of a rotation in floats

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

double Length(const vtkStratusSparseGrid& grid, size_t axis)
{
  return std::sqrt(
    grid.Matrix[axis] * grid.Matrix[axis] + grid.Matrix[3 + axis] * grid.Matrix[3 + axis] + grid.Matrix[6 + axis] * grid.Matrix[6 + axis]);
}
} // namespace

vtkStratusVDBReader::vtkStratusVDBReader() = default;
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
  this->Description = this->Grid->Kind + ", " + std::to_string(this->Grid->Active) + " active voxels in " +
    std::to_string(this->Grid->Leaves) + " leaves and tiles of " + WriteBytes(static_cast<double>(this->Grid->Bytes));
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
  const double voxel = static_cast<double>(vtkDataArray::GetDataTypeSize(grid.Type)) * grid.Components;
  const double limit = 1048576.0 * static_cast<double>(this->MemoryLimit);
  const std::string memory = ". The sparse grid takes " + WriteBytes(static_cast<double>(grid.Bytes)) + "; the limit is " +
    std::to_string(this->MemoryLimit) + " MiB (MemoryLimit)";
  double image = voxel, blocks = 0.0;
  this->Blocks.clear();
  for (int a = 0; a < 3; ++a) {
    image *= static_cast<double>(grid.High[a] - grid.Low[a] + 3);
  }
  if (this->Layout == IMAGE_LAYOUT || grid.Empty || (this->Layout == AUTO_LAYOUT && image <= limit)) {
    if (image > limit) {
      this->Fail("the grid '" + this->GridName + "' would take " + WriteBytes(image) + " as an image: its active voxels are within " +
        WriteBox(grid) + memory);
    }
    return false;
  }
  this->Blocks = vtkStratusDivide(grid.ListActive(), most);
  for (const vtkStratusCellBox& box : this->Blocks) {
    blocks += voxel * vtkStratusVoxelsOf(box);
  }
  if (blocks > limit) {
    this->Fail("the grid '" + this->GridName + "' would take " + WriteBytes(blocks) + " as " + std::to_string(this->Blocks.size()) +
      " blocks, and " + WriteBytes(image) + " as an image" + memory);
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

void vtkStratusVDBReader::BuildImage(vtkImageData* image, const vtkStratusSparseGrid& grid, const int extent[6]) const
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
  const vtkSmartPointer<vtkDataArray> values = vtkStratusMakeArray(grid.Type, grid.Components, image->GetNumberOfPoints());
  grid.Write(values->GetVoidPointer(0), low, high);
  values->SetName(this->GridName.c_str());
  image->GetPointData()->AddArray(values);
  if (grid.Components == 1) {
    image->GetPointData()->SetActiveScalars(this->GridName.c_str());
  } else {
    image->GetPointData()->SetActiveVectors(this->GridName.c_str());
  }
}

void vtkStratusVDBReader::Build(size_t, vtkDataObject* output)
{
  std::unique_ptr<vtkStratusSparseGrid> grid = std::move(this->Grid);
  if (!grid) {
    grid = vtkStratusSparseFile::Open(this->FileName)->Read(this->GridName);
  }
  if (vtkImageData* image = vtkImageData::SafeDownCast(output)) {
    this->BuildImage(image, *grid, this->WholeExtent);
    return;
  }
  vtkPartitionedDataSet* parts = vtkPartitionedDataSet::SafeDownCast(output);
  parts->Initialize();
  for (const vtkStratusCellBox& box : this->Blocks) {
    int extent[6];
    for (int a = 0; a < 3; ++a) {
      extent[2 * a] = static_cast<int>(box.Low[a]);
      extent[2 * a + 1] = static_cast<int>(box.High[a]);
    }
    vtkNew<vtkImageData> block;
    this->BuildImage(block, *grid, extent);
    parts->SetPartition(parts->GetNumberOfPartitions(), block);
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
