// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusImageReader.h"

#include "vtkStratusImageFile.h"
#include "vtkStratusImageValues.h"
#include "vtkStratusMakeArray.h"
#include "vtkStratusMappedFile.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <system_error>

vtkStandardNewMacro(vtkStratusImageReader);

namespace {
constexpr double Flat = 1e-6;    // three axes of length 1 that span a smaller volume are in one plane
constexpr double Sheared = 1e-4; // larger cosines are reported; smaller ones come from headers of few digits

std::string WriteVector(const double* vector)
{
  return "(" + vtkStratusWriteNumber(vector[0]) + ", " + vtkStratusWriteNumber(vector[1]) + ", " + vtkStratusWriteNumber(vector[2]) + ")";
}

// Gives axis `a`, which the file does not describe, the direction of length 1 that is perpendicular to the known axes and nearest to x, y
// or z.
void Complete(double axes[3][3], const bool known[3], int a)
{
  double base[3][3];
  int count = 0;
  const auto take_away = [&base, &count](double* vector) {
    for (int i = 0; i < count; ++i) {
      const double along = vtkMath::Dot(base[i], vector);
      for (int r = 0; r < 3; ++r) {
        vector[r] -= along * base[i][r];
      }
    }
    return vtkMath::Normalize(vector);
  };
  for (int i = 0; i < 3; ++i) {
    std::copy_n(axes[i], 3, base[count]);
    count += known[i] && take_away(base[count]) > 0.0 ? 1 : 0;
  }
  constexpr double enough = 0.5; // one of x, y, z has at least this part off a plane, 3^-1/2
  for (int i = 0; i < 3; ++i) {
    double vector[3] = { 0.0, 0.0, 0.0 };
    vector[(a + i) % 3] = 1.0;
    if (take_away(vector) > enough) {
      std::copy_n(vector, 3, axes[a]);
      return;
    }
  }
}

// Copies values of an order of axes into the order of components, x, y, z. `strides` has where the next sample of each axis goes.
template <class T> void Reorder(const T* from, T* to, const std::vector<int64_t>& sizes, const std::vector<int64_t>& strides)
{
  std::vector<int64_t> index(sizes.size(), 0);
  int64_t at = 0;
  for (;;) {
    for (int64_t i = 0; i < sizes[0]; ++i) {
      to[at + i * strides[0]] = *from++;
    }
    size_t axis = 1;
    while (axis < sizes.size()) {
      at += strides[axis];
      if (++index[axis] < sizes[axis]) {
        break;
      }
      at -= strides[axis] * sizes[axis];
      index[axis++] = 0;
    }
    if (axis == sizes.size()) {
      return;
    }
  }
}

template <class From, class To> void Scale(const From* from, To* to, vtkIdType count, double slope, double intercept)
{
  for (vtkIdType i = 0; i < count; ++i) {
    to[i] = static_cast<To>(slope * static_cast<double>(from[i]) + intercept);
  }
}

vtkSmartPointer<vtkDataArray> Scaled(vtkDataArray* stored, double slope, double intercept)
{
  const bool wide = stored->GetDataTypeSize() > 4 || stored->GetDataType() == VTK_INT || stored->GetDataType() == VTK_UNSIGNED_INT;
  const vtkSmartPointer<vtkDataArray> array =
    vtkStratusMakeArray(wide ? VTK_DOUBLE : VTK_FLOAT, stored->GetNumberOfComponents(), stored->GetNumberOfTuples());
  const vtkIdType count = stored->GetNumberOfValues();
  switch (stored->GetDataType()) {
    vtkTemplateMacro(wide
        ? Scale(static_cast<VTK_TT*>(stored->GetVoidPointer(0)), static_cast<double*>(array->GetVoidPointer(0)), count, slope, intercept)
        : Scale(static_cast<VTK_TT*>(stored->GetVoidPointer(0)), static_cast<float*>(array->GetVoidPointer(0)), count, slope, intercept));
  }
  return array;
}

vtkStratusImageFile ReadHeader(std::string path)
{
  switch (vtkStratusFindImageFormat(path)) {
    case vtkStratusImageFormat::NRRD:
      return vtkStratusReadNrrdHeader(path);
    case vtkStratusImageFormat::META:
      return vtkStratusReadMetaHeader(path);
    case vtkStratusImageFormat::NIFTI:
      return vtkStratusReadNiftiHeader(path);
    case vtkStratusImageFormat::NONE:
      break;
  }
  throw vtkStratusReadError{ path + ": is no file of NRRD, MetaImage or NIfTI: it begins with " +
    vtkStratusShown(vtkStratusReadStart(path, 40)) };
}
} // namespace

vtkStratusImageReader::vtkStratusImageReader()
{
  this->MapFile = 1;
  this->GivesParts = true;
}

vtkStratusImageReader::~vtkStratusImageReader() = default;

int vtkStratusImageReader::CanReadFile(const char* path)
{
  try {
    std::string name = path ? path : "";
    return vtkStratusFindImageFormat(name) != vtkStratusImageFormat::NONE ? 1 : 0;
  } catch (const vtkStratusReadError&) {
    return 0;
  }
}

std::string vtkStratusImageReader::Inspect()
{
  this->File.reset();
  if (this->Raw) {
    this->File = std::make_unique<vtkStratusImageFile>(*this->Raw);
    this->File->Path = this->FileName;
    this->File->Files = { this->FileName };
  } else {
    this->File = std::make_unique<vtkStratusImageFile>(ReadHeader(this->FileName));
  }
  const vtkStratusImageFile& file = *this->File;
  file.CountValues();
  this->Variables.push_back({ file.ArrayName, file.Units, file.Content });
  this->ChosenName();
  this->Times = file.Times;
  this->TimeUnits = file.TimeUnits;
  this->LengthUnits = file.LengthUnits;
  this->Description = file.Format;
  if (file.Slope != 1.0 || file.Intercept != 0.0) {
    this->Description += ", values are " + vtkStratusWriteNumber(file.Slope) + " * stored + " + vtkStratusWriteNumber(file.Intercept);
  }
  for (const std::string& note : file.Notes) {
    this->Description += ", " + note;
  }
  this->FindFrame();
  vtkStratusImageValues(file, [](double) {}); // looks at the lengths of the files
  return "vtkImageData";
}

// Finds extent, origin, spacing and direction.
void vtkStratusImageReader::FindFrame()
{
  const vtkStratusImageFile& file = *this->File;
  double axes[3][3] = {};
  bool known[3] = { false, false, false };
  int count = 0;
  int64_t components = 1;
  std::fill_n(this->WholeExtent, 6, 0);
  std::fill_n(this->Spacing, 3, 1.0);
  std::copy_n(file.Origin.begin(), 3, this->Origin);
  for (const vtkStratusImageAxis& axis : file.Axes) {
    components *= axis.Kind == vtkStratusImageAxis::COMPONENT ? axis.Size : 1;
    if (axis.Kind != vtkStratusImageAxis::SPACE) {
      continue;
    }
    std::copy_n(axis.Step.begin(), 3, axes[count]);
    this->WholeExtent[2 * count + 1] = static_cast<int>(axis.Size) - 1;
    const double length = vtkMath::Norm(axes[count]);
    if (!std::isfinite(length) || (length == 0.0 && axis.Size > 1)) {
      file.Fail("the step along axis " + std::to_string(count) + " is " + WriteVector(axes[count]) + ", must be finite and longer than 0");
    }
    known[count] = length > 0.0;
    this->Spacing[count] = known[count] ? length : 1.0;
    for (int r = 0; known[count] && r < 3; ++r) {
      axes[count][r] /= length;
    }
    ++count;
  }
  if (!std::isfinite(this->Origin[0]) || !std::isfinite(this->Origin[1]) || !std::isfinite(this->Origin[2])) {
    file.Fail("the first sample is at " + WriteVector(this->Origin) + ", must be finite");
  }
  if (components > VTK_INT_MAX) {
    file.Fail("a sample has " + std::to_string(components) + " components, must have at most " + std::to_string(VTK_INT_MAX));
  }
  this->Components = static_cast<int>(components);
  for (int a = 0; a < 3; ++a) {
    if (!known[a]) {
      Complete(axes, known, a);
      known[a] = true;
    }
  }
  double steepest = 0.0;
  for (int a = 0; a < 3; ++a) {
    steepest = std::max(steepest, std::fabs(vtkMath::Dot(axes[a], axes[(a + 1) % 3])));
    for (int r = 0; r < 3; ++r) {
      this->Direction[3 * r + a] = axes[a][r];
    }
  }
  const double volume = vtkMath::Determinant3x3(axes[0], axes[1], axes[2]);
  if (!(std::fabs(volume) >= Flat)) {
    file.Fail("the axes " + WriteVector(axes[0]) + ", " + WriteVector(axes[1]) + ", " + WriteVector(axes[2]) +
      " are in one plane, an image needs three directions");
  }
  this->Description += volume < 0.0 ? ", a left-handed frame" : "";
  this->Description += steepest > Sheared ? ", a sheared frame" : "";
}

void vtkStratusImageReader::SetRawLayout(const int size[3], int type, bool bigEndian, const double spacing[3], vtkTypeInt64 skip)
{
  this->Raw = std::make_unique<vtkStratusImageFile>();
  this->Raw->Format = "raw values";
  this->Raw->ArrayName = "ImageFile";
  this->Raw->Type = type;
  this->Raw->BigEndian = bigEndian;
  this->Raw->HeaderBytes = skip;
  for (size_t a = 0; a < 3; ++a) {
    vtkStratusImageAxis axis;
    axis.Size = size[a];
    axis.Step[a] = spacing[a];
    this->Raw->Axes.push_back(axis);
  }
  this->Modified();
}

// Returns the part's values, of those from number `first` of the file on, without reading them; null where they have to be read.
vtkSmartPointer<vtkDataArray> vtkStratusImageReader::Map(int64_t first, int64_t points)
{
#ifdef VTK_WORDS_BIGENDIAN
  constexpr bool big = true;
#else
  constexpr bool big = false;
#endif
  const vtkStratusImageFile& file = *this->File;
  const int64_t size = vtkDataArray::GetDataTypeSize(file.Type), bytes = points * this->Components * size;
  const bool same = (size == 1 || file.BigEndian == big) && file.Slope == 1.0 && file.Intercept == 0.0;
  if (!this->MapFile || !same || file.Encoding != vtkStratusImageFile::RAW || file.Files.size() != 1 || file.LineSkip != 0 ||
    bytes < this->MappedBytesLeast) {
    return nullptr;
  }
  std::error_code error;
  const int64_t length = static_cast<int64_t>(std::filesystem::file_size(file.Files[0], error));
  const int64_t begin = file.ByteSkip < 0 ? length - file.CountValues() * size : file.HeaderBytes + file.ByteSkip;
  if (error) {
    return nullptr;
  }
  const int64_t sizes[3] = { this->WholeExtent[1] + 1, this->WholeExtent[3] + 1, this->WholeExtent[5] + 1 };
  return vtkStratusLeaveRaw(file.Files[0], begin + first * size, file.ArrayName.c_str(), file.Type, this->Components, sizes,
    vtkStratusBoxOf(this->WholeExtent, this->Part, false));
}

// Reads a step in time as it is stored, with components first.
vtkSmartPointer<vtkDataArray> vtkStratusImageReader::ReadStored(size_t step)
{
  const vtkStratusImageFile& file = *this->File;
  // Of each sample outside the axis of time there are `times` runs of `inner` values in the file, of which one is the step's.
  int64_t inner = 1, outer = 1, times = 1, points = 1;
  std::vector<int64_t> sizes, strides;
  int64_t next_component = 1, next_point = this->Components;
  bool ordered = true;
  for (const vtkStratusImageAxis& axis : file.Axes) {
    if (axis.Kind == vtkStratusImageAxis::TIME) {
      times = axis.Size;
      inner *= outer;
      outer = 1;
      continue;
    }
    outer *= axis.Size;
    int64_t& next = axis.Kind == vtkStratusImageAxis::COMPONENT ? next_component : next_point;
    points *= axis.Kind == vtkStratusImageAxis::SPACE ? axis.Size : 1;
    ordered = ordered && (axis.Size == 1 || axis.Kind == vtkStratusImageAxis::SPACE || next_point == this->Components);
    sizes.push_back(axis.Size);
    strides.push_back(next);
    next *= axis.Size;
  }
  if (times == 1) { /* one run of all */
    inner *= outer;
    outer = 1;
  }
  const int64_t at = static_cast<int64_t>(step);
  const vtkSmartPointer<vtkDataArray> mapped = outer == 1 && ordered ? this->Map(at * inner, points) : nullptr;
  this->Mapped = mapped ? 1 : 0;
  if (mapped) {
    return mapped;
  }
  vtkStratusImageValues values(file, [this](double done) {
    this->UpdateProgress(done);
    if (this->GetAbortExecute()) {
      throw vtkStratusReadError{ this->File->Path + ": reading was aborted" };
    }
  });
  const vtkSmartPointer<vtkDataArray> array = vtkStratusMakeArray(file.Type, this->Components, points);
  const vtkSmartPointer<vtkDataArray> read = ordered ? array : vtkStratusMakeArray(file.Type, 1, points * this->Components);
  const int64_t bytes = array->GetDataTypeSize();
  char* const to = static_cast<char*>(read->GetVoidPointer(0));
  for (int64_t i = 0; i < outer; ++i) {
    values.Skip(at * inner);
    values.Next(to + i * inner * bytes, inner);
    values.Skip((times - 1 - at) * inner);
  }
  if (!ordered) {
    switch (file.Type) {
      vtkTemplateMacro(
        Reorder(static_cast<VTK_TT*>(read->GetVoidPointer(0)), static_cast<VTK_TT*>(array->GetVoidPointer(0)), sizes, strides));
    }
  }
  return array;
}

void vtkStratusImageReader::Build(size_t step, vtkDataObject* output)
{
  vtkImageData* const image = vtkImageData::SafeDownCast(output);
  const vtkStratusImageFile& file = *this->File;
  vtkSmartPointer<vtkDataArray> array = this->ReadStored(step);
  if (file.Slope != 1.0 || file.Intercept != 0.0) {
    array = Scaled(array, file.Slope, file.Intercept);
  }
  if (!array->GetName()) {
    array->SetName(file.ArrayName.c_str());
  }
  image->Initialize();
  image->SetExtent(this->WholeExtent);
  image->SetOrigin(this->Origin);
  image->SetSpacing(this->Spacing);
  image->SetDirectionMatrix(this->Direction);
  image->GetPointData()->AddArray(array);
  constexpr int vector = 3;
  if (file.IsVector && this->Components == vector) {
    image->GetPointData()->SetActiveVectors(array->GetName());
  } else {
    image->GetPointData()->SetActiveScalars(array->GetName());
  }
}

int vtkStratusImageReader::RequestInformation(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
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

void vtkStratusImageReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}
