// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusHDF5Reader.h"

#include "vtkStratusBricks.h"
#include "vtkStratusHDF5File.h"
#include "vtkStratusIdentity.h"
#include "vtkStratusImageFile.h"
#include "vtkStratusMakeArray.h"
#include "vtkStratusMappedFile.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMath.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <memory>
#include <new>
#include <numeric>

vtkStandardNewMacro(vtkStratusHDF5Reader);

namespace {
constexpr char Root[] = "/VTKHDF";
constexpr size_t StepsMost = 1 << 20;
constexpr double Flat = 1e-6; // three axes of length 1 that span a smaller volume are in one plane

// Reads `count` numbers of a data set of one dimension as doubles; none if there are not that many.
std::vector<double> ReadNumbers(const vtkStratusHDF5File& file, const std::string& path, size_t count)
{
  const std::unique_ptr<vtkStratusHDF5Values> values = file.Open(path);
  if (!values || values->GetSizes().size() != 1 || values->GetSizes()[0] < count) {
    return {};
  }
  const size_t zero = 0;
  const vtkSmartPointer<vtkDataArray> read = vtkStratusMakeArray(values->GetType(), 1, static_cast<vtkIdType>(count));
  if (!values->Read(&zero, &count, read->GetVoidPointer(0))) {
    file.Fail("'" + path + "' cannot be read");
  }
  std::vector<double> numbers(count);
  for (size_t i = 0; i < count; ++i) {
    numbers[i] = read->GetComponent(static_cast<vtkIdType>(i), 0);
  }
  return numbers;
}

std::string SizesText(const std::vector<size_t>& sizes)
{
  std::string text;
  for (const size_t size : sizes) {
    text += (text.empty() ? "" : " x ") + std::to_string(size);
  }
  return text.empty() ? "one value" : text;
}

} // namespace

// The part of a data set that is an array of the image: at one index of its dimension of time, with all components.
struct vtkStratusHDF5Reader::Box {
  std::shared_ptr<vtkStratusHDF5Values> Values;
  int64_t Sizes[3] = { 1, 1, 1 }; // along x, y, z
  size_t Before = 0, Axes = 3;    // dimensions before those in space, and in space
  size_t Index = 0;               // along the dimension before

  size_t DimensionOf(size_t axis) const { return this->Before + this->Axes - 1 - axis; }

  bool Read(const int64_t lo[3], const int64_t size[3], void* to) const
  {
    std::vector<size_t> start(this->Values->GetSizes().size(), 0), count = this->Values->GetSizes();
    if (this->Before > 0) {
      start[0] = this->Index;
      count[0] = 1;
    }
    for (size_t a = 0; a < this->Axes; ++a) {
      start[this->DimensionOf(a)] = static_cast<size_t>(lo[a]);
      count[this->DimensionOf(a)] = static_cast<size_t>(size[a]);
    }
    return this->Values->Read(start.data(), count.data(), to);
  }
};

vtkStratusHDF5Reader::vtkStratusHDF5Reader()
{
  std::fill_n(this->Origin, 3, 0.0);
  std::fill_n(this->Spacing, 3, 1.0);
  std::fill_n(this->Direction, 9, 0.0);
  this->GivesParts = true;
}

vtkStratusHDF5Reader::~vtkStratusHDF5Reader() = default;

int vtkStratusHDF5Reader::CanReadFile(const char* path)
{
  try {
    const vtkStratusHDF5File file(path ? path : "");
    return !file.Has(Root) || file.Text(Root, "Type") == "ImageData" ? 1 : 0;
  } catch (const vtkStratusReadError&) {
    return 0;
  }
}

std::string vtkStratusHDF5Reader::Inspect()
{
  const vtkStratusHDF5File file(this->FileName);
  this->Arrays.clear();
  this->Ghosts.clear();
  std::fill_n(this->WholeExtent, 6, 0);
  std::fill_n(this->Origin, 3, 0.0);
  std::fill_n(this->Spacing, 3, 1.0);
  for (int i = 0; i < 9; ++i) {
    this->Direction[i] = i % 4 == 0 ? 1.0 : 0.0;
  }
  if (file.Has(Root)) {
    this->InspectImage(file);
  } else {
    this->InspectDataSets(file);
  }
  return "vtkImageData";
}

void vtkStratusHDF5Reader::InspectImage(const vtkStratusHDF5File& file)
{
  constexpr double newest = 2.0;
  const std::string type = file.Text(Root, "Type");
  const std::vector<double> version = file.Numbers(Root, "Version");
  if (type != "ImageData") {
    file.Fail("the type of the VTKHDF file is '" + type + "', must be 'ImageData'");
  }
  if (version.size() != 2 || version[0] < 1.0 || version[0] > newest) {
    file.Fail("the version of the VTKHDF file is " + (version.empty() ? std::string("missing") : std::to_string(std::lround(version[0]))) +
      ", must be two numbers, the first 1 or 2");
  }
  this->FindFrame(file);
  this->FindSteps(file);
  std::string left_out;
  this->FindArrays(file, false, left_out);
  this->FindArrays(file, true, left_out);
  if (this->Arrays.empty()) {
    file.Fail("the image has no array of numbers of its size" + (left_out.empty() ? "" : "; left out: " + left_out));
  }
  this->Description = "VTKHDF " + std::to_string(std::lround(version[0])) + "." + std::to_string(std::lround(version[1])) +
    ", an image with values of " + (this->FindChosen().Cells ? "cells" : "points") + (left_out.empty() ? "" : "; left out: " + left_out);
}

// Looks up extent, origin, spacing and direction.
void vtkStratusHDF5Reader::FindFrame(const vtkStratusHDF5File& file)
{
  const auto look = [&file](const char* name, size_t count, bool needed, double* to) {
    const std::vector<double> numbers = file.Numbers(Root, name);
    if (numbers.empty() && !needed) {
      return;
    }
    if (numbers.size() != count || !std::all_of(numbers.begin(), numbers.end(), [](double one) { return std::isfinite(one); })) {
      file.Fail(std::string("the attribute ") + name + " of the image has " + std::to_string(numbers.size()) + " numbers, must be " +
        std::to_string(count) + ", all finite");
    }
    std::copy(numbers.begin(), numbers.end(), to);
  };
  double extent[6];
  look("WholeExtent", 6, true, extent);
  look("Origin", 3, true, this->Origin);
  look("Spacing", 3, true, this->Spacing);
  look("Direction", 9, false, this->Direction);
  for (int a = 0; a < 3; ++a) {
    if (!(extent[2 * a] >= INT_MIN / 2 && extent[2 * a + 1] <= INT_MAX / 2 && extent[2 * a] <= extent[2 * a + 1])) {
      file.Fail("the attribute WholeExtent is " + vtkStratusWriteNumber(extent[2 * a]) + " to " + vtkStratusWriteNumber(extent[2 * a + 1]) +
        " along " + "xyz"[a] + ", must rise");
    }
    if (!(this->Spacing[a] > 0.0)) {
      file.Fail(
        std::string("the attribute Spacing is ") + vtkStratusWriteNumber(this->Spacing[a]) + " along " + "xyz"[a] + ", must be above 0");
    }
    this->WholeExtent[2 * a] = static_cast<int>(extent[2 * a]);
    this->WholeExtent[2 * a + 1] = static_cast<int>(extent[2 * a + 1]);
  }
  double axes[3][3];
  std::copy_n(this->Direction, 9, &axes[0][0]);
  if (!(std::fabs(vtkMath::Determinant3x3(axes)) >= Flat)) {
    file.Fail("the axes of the attribute Direction are in one plane, an image needs three directions");
  }
}

void vtkStratusHDF5Reader::FindSteps(const vtkStratusHDF5File& file)
{
  const std::string group = std::string(Root) + "/Steps";
  if (!file.Has(group)) {
    return;
  }
  const std::vector<double> count = file.Numbers(group, "NSteps");
  if (count.size() != 1 || !(count[0] >= 1.0 && count[0] <= static_cast<double>(StepsMost))) {
    file.Fail("the attribute NSteps is " + (count.empty() ? std::string("missing") : vtkStratusWriteNumber(count[0])) + ", must be 1 to " +
      std::to_string(StepsMost));
  }
  this->Times = ReadNumbers(file, group + "/Values", static_cast<size_t>(count[0]));
  if (this->Times.empty()) {
    file.Fail("'" + group + "/Values' must be " + std::to_string(std::lround(count[0])) + " numbers, the times of the steps");
  }
  for (size_t i = 0; i < this->Times.size(); ++i) {
    if (!std::isfinite(this->Times[i]) || (i > 0 && !(this->Times[i] > this->Times[i - 1]))) {
      file.Fail("the time of step " + std::to_string(i) + " is " + vtkStratusWriteNumber(this->Times[i]) + ", must be finite and rise");
    }
  }
}

const vtkStratusHDF5Reader::Array& vtkStratusHDF5Reader::FindChosen() const
{
  const std::string name = this->ChosenName();
  return *std::find_if(this->Arrays.begin(), this->Arrays.end(), [&name](const Array& one) { return one.Name == name; });
}

// Returns the sizes of the grid along z, y, x for arrays of points or cells.
std::vector<size_t> vtkStratusHDF5Reader::GridOf(bool cells) const
{
  std::vector<size_t> grid;
  for (int a = 2; a >= 0; --a) {
    const int count = this->WholeExtent[2 * a + 1] - this->WholeExtent[2 * a];
    grid.push_back(static_cast<size_t>(cells ? std::max(count, 1) : count + 1));
  }
  return grid;
}

// Returns whether an array has the sizes of the grid. A dimension of time may come before them, and one of components behind them; z may be
// left out of a flat image.
bool vtkStratusHDF5Reader::Fits(Array& array) const
{
  const std::vector<size_t> grid = this->GridOf(array.Cells);
  const std::vector<size_t>& sizes = array.Sizes;
  for (const bool timed : { !this->Times.empty(), false }) {
    for (const int axes : { 3, grid[0] == 1 ? 2 : 3 }) {
      const size_t before = timed ? 1 : 0, end = before + static_cast<size_t>(axes);
      const bool several = sizes.size() == end + 1 && sizes.back() > 0 && sizes.back() <= INT_MAX;
      if ((sizes.size() == end || several) &&
        std::equal(grid.end() - axes, grid.end(), sizes.begin() + static_cast<std::ptrdiff_t>(before))) {
        array.Timed = timed;
        array.Axes = axes;
        array.Components = several ? static_cast<int>(sizes.back()) : 1;
        return true;
      }
    }
  }
  return false;
}

void vtkStratusHDF5Reader::AddArray(const vtkStratusHDF5File& file, const Array& array, bool first)
{
  this->Arrays.push_back(array);
  this->Variables.insert(first ? this->Variables.begin() : this->Variables.end(),
    { array.Name, file.Text(array.Path, "units"), file.Text(array.Path, "long_name") });
}

void vtkStratusHDF5Reader::FindArrays(const vtkStratusHDF5File& file, bool cells, std::string& left_out)
{
  const std::string group = std::string(Root) + (cells ? "/CellData" : "/PointData"), scalars = file.Text(group, "Scalars");
  for (const std::string& name : file.List(group)) {
    Array array;
    array.Name = name;
    array.Path = group + "/" + name;
    array.Cells = cells;
    const std::unique_ptr<vtkStratusHDF5Values> values = file.Open(array.Path);
    array.Sizes = values ? values->GetSizes() : array.Sizes;
    const bool fits = values && this->Fits(array);
    const bool known = std::any_of(this->Arrays.begin(), this->Arrays.end(), [&name](const Array& one) { return one.Name == name; });
    if (fits && name == vtkDataSetAttributes::GhostArrayName()) {
      this->Ghosts.push_back(array);
    } else if (fits && !known) {
      this->AddArray(file, array, name == scalars && !cells);
    } else {
      left_out += (left_out.empty() ? "'" : ", '") + name +
        (fits         ? "' of cells, because points have one of this name"
            : !values ? "', which has no numbers"
                      : "' of the size " + SizesText(array.Sizes) + ", the grid has " + SizesText(this->GridOf(cells)));
    }
  }
}

// Lists the data sets of three dimensions of a file that is not VTKHDF.
void vtkStratusHDF5Reader::InspectDataSets(const vtkStratusHDF5File& file)
{
  for (const std::string& path : file.ListDataSets()) {
    const std::unique_ptr<vtkStratusHDF5Values> values = file.Open(path);
    if (values && values->GetSizes().size() == 3 &&
      std::all_of(values->GetSizes().begin(), values->GetSizes().end(), [](size_t n) { return n > 0 && n <= INT_MAX; })) {
      Array array;
      array.Name = array.Path = path;
      array.Sizes = values->GetSizes();
      this->AddArray(file, array, false);
    }
  }
  if (this->Arrays.empty()) {
    file.Fail("it has no group VTKHDF, and no data set of numbers of three dimensions");
  }
  for (size_t a = 0; a < 3; ++a) {
    this->WholeExtent[2 * a + 1] = static_cast<int>(this->FindChosen().Sizes[2 - a]) - 1;
  }
  this->Description = "HDF5, a data set without coordinates: the spacing is 1";
}

// Returns the index along the dimension of time at which a step's values are.
size_t vtkStratusHDF5Reader::IndexOf(const vtkStratusHDF5File& file, const Array& array, size_t step) const
{
  const std::string path = std::string(Root) + (array.Cells ? "/Steps/CellDataOffsets/" : "/Steps/PointDataOffsets/") + array.Name;
  double index = static_cast<double>(step);
  if (file.Has(path)) {
    const std::vector<double> offsets = ReadNumbers(file, path, this->Times.size());
    index = offsets.empty() ? NAN : offsets[step];
  }
  if (!(index >= 0.0 && index < static_cast<double>(array.Sizes[0]))) {
    file.Fail("the values of step " + std::to_string(step) + " of '" + array.Name + "' are at index " + vtkStratusWriteNumber(index) +
      ", must be from 0 to below " + std::to_string(array.Sizes[0]));
  }
  return static_cast<size_t>(index);
}

vtkStratusHDF5Reader::Box vtkStratusHDF5Reader::OpenBox(const vtkStratusHDF5File& file, const Array& array, size_t step) const
{
  Box box;
  box.Values = file.Open(array.Path);
  if (!box.Values || box.Values->GetSizes() != array.Sizes) {
    file.Fail("'" + array.Path + "' has changed since the file was opened first");
  }
  const std::vector<size_t> grid = this->GridOf(array.Cells);
  std::transform(grid.rbegin(), grid.rend(), box.Sizes, [](size_t n) { return static_cast<int64_t>(n); });
  const double bytes = std::accumulate(array.Sizes.begin(), array.Sizes.end(), static_cast<double>(sizeof(double)),
    [](double all, size_t n) { return all * static_cast<double>(n); });
  if (bytes > static_cast<double>(VTK_ID_MAX)) {
    file.Fail("'" + array.Path + "' has " + SizesText(array.Sizes) + " values, more than " + std::to_string(VTK_ID_MAX / sizeof(double)));
  }
  box.Before = array.Timed ? 1 : 0;
  box.Axes = static_cast<size_t>(array.Axes);
  box.Index = array.Timed ? this->IndexOf(file, array, step) : 0;
  return box;
}

// Reads all values, some layers at a time.
vtkSmartPointer<vtkDataArray> vtkStratusHDF5Reader::ReadValues(const vtkStratusHDF5File& file, const Array& array, const Box& box)
{
  constexpr int64_t least = int64_t(1) << 24; // bytes between two reports of progress
  const int64_t layer = box.Sizes[0] * box.Sizes[1];
  const vtkSmartPointer<vtkDataArray> values = vtkStratusMakeArray(box.Values->GetType(), array.Components, layer * box.Sizes[2]);
  const int64_t layer_bytes = layer * array.Components * values->GetDataTypeSize();
  const std::vector<size_t>& chunks = box.Values->GetChunks();
  const int64_t chunk = chunks.empty() || box.Axes < 3 ? 1 : static_cast<int64_t>(chunks[box.DimensionOf(2)]);
  const int64_t step = chunk * std::max<int64_t>(least / (chunk * layer_bytes), 1);
  for (int64_t z = 0; z < box.Sizes[2]; z += step) {
    const int64_t lo[3] = { 0, 0, z }, size[3] = { box.Sizes[0], box.Sizes[1], std::min(step, box.Sizes[2] - z) };
    if (!box.Read(lo, size, static_cast<char*>(values->GetVoidPointer(0)) + z * layer_bytes)) {
      file.Fail("the values of '" + array.Path + "' cannot be read: they are damaged, or have a filter that libhdf5 does not have");
    }
    this->UpdateProgress(static_cast<double>(z + size[2]) / static_cast<double>(box.Sizes[2]));
    if (this->GetAbortExecute()) {
      file.Fail("reading was aborted");
    }
  }
  values->SetName(array.Name.c_str());
  return values;
}

// Returns an array whose values stay in the file; null where they have to be read.
vtkSmartPointer<vtkDataArray> vtkStratusHDF5Reader::LeaveValues(const Array& array, const Box& box) const
{
  const int type = box.Values->GetType();
  const int64_t tuples = box.Sizes[0] * box.Sizes[1] * box.Sizes[2];
  const int64_t bytes = tuples * array.Components * vtkDataArray::GetDataTypeSize(type);
  if (!this->MapFile || bytes < this->MappedBytesLeast) {
    return nullptr;
  }
  const vtkStratusBox part = vtkStratusBoxOf(this->WholeExtent, this->Part, array.Cells);
  if (box.Values->GetBegin() >= 0) {
    const int64_t begin = box.Values->GetBegin() + static_cast<int64_t>(box.Index) * bytes;
    const vtkSmartPointer<vtkDataArray> left =
      vtkStratusLeaveRaw(this->FileName, begin, array.Name.c_str(), type, array.Components, box.Sizes, part);
    if (left) {
      return left;
    }
  }
  vtkStratusBrickSource source;
  source.Name = array.Name;
  source.Type = type;
  source.Components = array.Components;
  source.Identity = vtkStratusIdentityOfPart(vtkStratusIdentityOfFile(this->FileName, 0, -1), array.Path, { box.Index });
  std::copy_n(box.Sizes, 3, source.Dimensions.begin());
  source.Brick = { { box.Sizes[0], 1, 1 } };
  const std::vector<size_t>& chunks = box.Values->GetChunks();
  for (size_t a = 0; !chunks.empty() && a < box.Axes; ++a) {
    source.Brick[a] = std::min(static_cast<int64_t>(chunks[box.DimensionOf(a)]), box.Sizes[a]);
  }
  source.Read = [box](const int64_t lo[3], const int64_t size[3], void* values) {
    try {
      return box.Read(lo, size, values);
    } catch (const std::bad_alloc&) {
      return false;
    }
  };
  vtkStratusCutSource(source, part.Low, part.Size);
  return vtkStratusMakeBricks(source);
}

void vtkStratusHDF5Reader::Build(size_t step, vtkDataObject* output)
{
  constexpr int vector = 3;
  const vtkStratusHDF5File file(this->FileName);
  vtkImageData* const image = vtkImageData::SafeDownCast(output);
  image->Initialize();
  image->SetExtent(this->WholeExtent);
  image->SetOrigin(this->Origin);
  image->SetSpacing(this->Spacing);
  image->SetDirectionMatrix(this->Direction);
  const Array& chosen = this->FindChosen();
  vtkSmartPointer<vtkDataArray> values =
    this->BricksOf(step, [&](size_t one) { return this->LeaveValues(chosen, this->OpenBox(file, chosen, one)); });
  this->Mapped = values ? 1 : 0;
  values = values ? values : this->ReadValues(file, chosen, this->OpenBox(file, chosen, step));
  const auto data_of = [image](const Array& array) {
    return array.Cells ? static_cast<vtkDataSetAttributes*>(image->GetCellData()) : image->GetPointData();
  };
  data_of(chosen)->AddArray(values);
  const bool colours = values->GetDataType() == VTK_UNSIGNED_CHAR;
  data_of(chosen)->SetActiveAttribute(
    values->GetName(), chosen.Components == vector && !colours ? vtkDataSetAttributes::VECTORS : vtkDataSetAttributes::SCALARS);
  for (const Array& ghosts : this->Ghosts) {
    data_of(ghosts)->AddArray(this->ReadValues(file, ghosts, this->OpenBox(file, ghosts, step)));
  }
}

int vtkStratusHDF5Reader::RequestInformation(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  if (!this->Superclass::RequestInformation(request, inputs, outputs)) {
    return 0;
  }
  vtkInformation* const info = outputs->GetInformationObject(0);
  info->Set(vtkDataObject::ORIGIN(), this->Origin, 3);
  info->Set(vtkDataObject::SPACING(), this->Spacing, 3);
  info->Set(vtkDataObject::DIRECTION(), this->Direction, 9);
  return 1;
}

void vtkStratusHDF5Reader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}
