// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusEXRWriter.h"

#include "vtkStratusEXRFile.h"
#include "vtkStratusTemporaryFile.h"

#include "vtkDataArray.h"
#include "vtkErrorCode.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <new>
#include <stdexcept>
#include <type_traits>

vtkStandardNewMacro(vtkStratusEXRWriter);

namespace {
// The reason why nothing was written. Code is one of vtkErrorCode.
struct Failure {
  std::string Text;
  unsigned long Code;
};

[[noreturn]] void Fail(const std::string& text, unsigned long code = vtkErrorCode::UnknownError)
{
  throw Failure{ text, code };
}

// Converts a value to the float equal to it. Returns false where there is none; a NaN stays a NaN.
template <typename T> bool ToFloat(T value, float& result)
{
  result = static_cast<float>(value);
  if constexpr (std::is_floating_point<T>::value) {
    return result == value || value != value;
  } else {
    const float limit = std::ldexp(1.0f, std::numeric_limits<T>::digits); // one above the type's largest value
    return result < limit && result >= (std::is_signed<T>::value ? -limit : 0.0f) && static_cast<T>(result) == value;
  }
}

template <typename T> void ConvertRow(const T* values, vtkIdType first, int width, int components, const std::string& what, float* row)
{
  for (int x = 0; x < width; ++x) {
    const T value = values[(first + x) * components];
    if (!ToFloat(value, row[x])) {
      Fail(what + " holds " + std::to_string(value) + " in tuple " + std::to_string(first + x) + ", no float is equal to that");
    }
  }
}

void GetRow(vtkDataArray* array, int component, int width, int y, const std::string& what, float* row)
{
  const void* values = array->GetVoidPointer(0);
  const int components = array->GetNumberOfComponents();
  const vtkIdType first = static_cast<vtkIdType>(y) * width;
  switch (array->GetDataType()) {
    vtkTemplateMacro(ConvertRow(static_cast<const VTK_TT*>(values) + component, first, width, components, what, row));
  }
}

bool IsNumeric(int type)
{
  switch (type) {
    vtkTemplateMacro(return sizeof(VTK_TT) > 0);
  }
  return false;
}

std::string ChannelName(const std::string& array, int component, int components)
{
  const bool plain = array.empty();
  if ((array == "RGBA" && components == 4) || (array == "RGB" && components == 3) || (plain && (components == 3 || components == 4))) {
    return std::string(1, "RGBA"[component]);
  }
  if (components == 1) {
    return plain ? "Y" : array == "Depth" ? "Z" : array;
  }
  return (plain ? "" : array + ".") + std::to_string(component);
}

void AddChannels(vtkAbstractArray* abstract, int width, std::vector<vtkStratusEXRChannel>& channels)
{
  vtkDataArray* array = vtkDataArray::SafeDownCast(abstract);
  const std::string name = abstract->GetName() ? abstract->GetName() : "";
  const std::string what = "array '" + name + "'";
  if (!array || !IsNumeric(array->GetDataType())) {
    Fail(what + " is of type " + abstract->GetDataTypeAsString() + ", channels are made of numbers of 8 to 64 bits");
  }
  vtkSmartPointer<vtkDataArray> plain = array;
  if (!array->HasStandardMemoryLayout()) { // one copy for all rows and channels, because GetVoidPointer() would copy each time
    plain = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(array->GetDataType()));
    plain->DeepCopy(array);
  }
  const int components = array->GetNumberOfComponents();
  vtkInformation* info = array->HasInformation() ? array->GetInformation() : nullptr;
  const char* units = info && info->Has(vtkDataArray::UNITS_LABEL()) ? info->Get(vtkDataArray::UNITS_LABEL()) : nullptr;
  for (int c = 0; c < components; ++c) {
    channels.push_back(
      { ChannelName(name, c, components), [=](int y, float* row) { GetRow(plain, c, width, y, what, row); }, units ? units : "" });
  }
}

void Store(const std::vector<unsigned char>& bytes, const std::string& path)
{
  vtkStratusReplacingFile file;
  if (const int reason = file.Open(path)) {
    Fail("can't open " + path + ": " + std::strerror(reason), vtkErrorCode::CannotOpenFileError);
  }
  if (const int reason = file.Finish(bytes.data(), bytes.size())) {
    Fail("can't write " + path + ": " + std::strerror(reason),
      reason == ENOSPC ? vtkErrorCode::OutOfDiskSpaceError : vtkErrorCode::UnknownError);
  }
}
} // namespace

vtkStratusEXRWriter::vtkStratusEXRWriter() = default;

vtkStratusEXRWriter::~vtkStratusEXRWriter()
{
  this->SetFileName(nullptr);
}

int vtkStratusEXRWriter::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

void vtkStratusEXRWriter::WriteImage()
{
  vtkImageData* image = vtkImageData::SafeDownCast(this->GetInput());
  const std::string path = this->FileName ? this->FileName : "";
  if (path.empty()) {
    Fail("FileName is not set", vtkErrorCode::NoFileNameError);
  }
  int size[3] = { 0, 0, 0 };
  image->GetDimensions(size);
  if (size[0] < 1 || size[1] < 1 || size[2] != 1) {
    Fail("the input has " + std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " + std::to_string(size[2]) +
      " points, a picture has at least one along x and y, and one along z");
  }
  std::vector<vtkStratusEXRChannel> channels;
  vtkPointData* data = image->GetPointData();
  for (int i = 0; i < data->GetNumberOfArrays(); ++i) {
    vtkAbstractArray* array = data->GetAbstractArray(i);
    if (array->GetNumberOfTuples() != image->GetNumberOfPoints()) {
      Fail(std::string("array '") + (array->GetName() ? array->GetName() : "") + "' has " + std::to_string(array->GetNumberOfTuples()) +
        " tuples, it must have one for each of the " + std::to_string(image->GetNumberOfPoints()) + " points");
    }
    AddChannels(array, size[0], channels);
  }
  const auto progress = [this](double fraction) {
    this->UpdateProgress(fraction);
    if (this->GetAbortExecute()) {
      Fail(std::string("writing ") + this->FileName + " was aborted", vtkErrorCode::UserError);
    }
  };
  Store(vtkStratusEncodeEXR(size[0], size[1], channels, progress), path);
}

void vtkStratusEXRWriter::WriteData()
{
  this->SetErrorCode(vtkErrorCode::NoError);
  try {
    this->WriteImage();
  } catch (const Failure& failure) {
    this->SetErrorCode(failure.Code);
    vtkErrorMacro(<< failure.Text);
  } catch (const std::bad_alloc&) {
    this->SetErrorCode(vtkErrorCode::UnknownError);
    vtkErrorMacro(<< "out of memory while writing " << this->FileName);
  } catch (const std::exception& error) {
    this->SetErrorCode(vtkErrorCode::UnknownError);
    vtkErrorMacro(<< error.what());
  }
}

void vtkStratusEXRWriter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
}
