// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusXMLImageReader.h"

#include "vtkStratusBricks.h"
#include "vtkStratusIdentity.h"
#include "vtkStratusMakeArray.h"
#include "vtkStratusMappedFile.h"
#include "vtkStratusParts.h"
#include "vtkStratusXMLImage.h"

#include "vtkCallbackCommand.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataArraySelection.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkXMLImageDataReader.h"

#include <algorithm>
#include <exception>
#include <new>

vtkStandardNewMacro(vtkStratusXMLImageReader);

namespace {
// Returns an array of bricks. `values` stays as long as the array. Null where bricks can't be made.
vtkSmartPointer<vtkDataArray> MakeBricks(const vtkStratusXMLImage& image, const vtkStratusXMLArray& array,
  const std::shared_ptr<vtkStratusXMLValues>& values, const vtkStratusBox& part)
{
  constexpr int64_t blocks = 4; // in a brick, at least: of these, two are inflated for its neighbours, too
  const int64_t row = array.Sizes[0] * array.Components * vtkDataArray::GetDataTypeSize(array.Type);
  vtkStratusBrickSource source;
  source.Name = array.Name;
  source.Type = array.Type;
  source.Components = array.Components;
  source.Identity =
    vtkStratusIdentityOfPart(vtkStratusIdentityOfFile(image.Path, 0, -1), array.Name, { static_cast<uint64_t>(array.Cells) });
  source.Dimensions = array.Sizes;
  source.Brick = { { array.Sizes[0], std::clamp<int64_t>(blocks * values->GetBlockBytes() / row, 1, array.Sizes[1]), 1 } };
  source.Read = [values](const int64_t lo[3], const int64_t size[3], void* to) {
    try {
      return values->Read(lo, size, to);
    } catch (const std::bad_alloc&) {
      return false;
    }
  };
  vtkStratusCutSource(source, part.Low, part.Size);
  return vtkStratusMakeBricks(source);
}
} // namespace

vtkStratusXMLImageReader::vtkStratusXMLImageReader()
{
  this->GivesParts = true;
}

vtkStratusXMLImageReader::~vtkStratusXMLImageReader() = default;

int vtkStratusXMLImageReader::CanReadFile(const char* path)
{
  try {
    return path && vtkStratusWhyNoXMLImage(path).empty() ? 1 : 0;
  } catch (const vtkStratusReadError&) {
    return 0;
  }
}

std::string vtkStratusXMLImageReader::Inspect()
{
  this->Image.reset();
  vtkStratusXMLImage image = vtkStratusReadXMLImage(this->FileName);
  std::copy(image.Extent.begin(), image.Extent.end(), this->WholeExtent);
  // The first variable is the array that is drawn unless another one is chosen: the active scalars, else numbers before vectors.
  const auto rank = [&image](const vtkStratusXMLArray& array) {
    const bool active = array.Name == image.Active[array.Cells ? 1 : 0][vtkDataSetAttributes::SCALARS];
    return (array.Components == 1 ? 0 : 4) + (array.Cells ? 2 : 0) + (active ? 0 : 1);
  };
  std::vector<const vtkStratusXMLArray*> sorted;
  for (const vtkStratusXMLArray& array : image.Arrays) {
    if (array.Name != vtkDataSetAttributes::GhostArrayName()) {
      sorted.push_back(&array);
    }
  }
  std::stable_sort(sorted.begin(), sorted.end(), [&rank](const auto* one, const auto* other) { return rank(*one) < rank(*other); });
  for (const vtkStratusXMLArray* array : sorted) {
    const bool known = std::any_of(
      this->Variables.begin(), this->Variables.end(), [array](const VariableEntry& entry) { return entry.Name == array->Name; });
    if (!known) {
      this->Variables.push_back({ array->Name, array->Units, "" });
    }
  }
  for (const vtkStratusXMLArray& array : image.Arrays) {
    vtkStratusXMLValues(image, array); // looks at the bytes before the values, and at the file's length
  }
  if (this->VariableName && *this->VariableName) {
    this->ChosenName();
  }
  static const char* const compressors[] = { "", ", compressed by zlib", ", compressed by lz4" };
  this->Description = std::string("VTK's XML, raw bytes") + compressors[image.Compressor];
  this->Image = std::make_unique<vtkStratusXMLImage>(std::move(image));
  return "vtkImageData";
}

// Returns an array's values, in the file if that is possible. *left: whether they are.
vtkSmartPointer<vtkDataArray> vtkStratusXMLImageReader::GetValues(const vtkStratusXMLArray& array, bool* left)
{
  const vtkStratusXMLImage& image = *this->Image;
  const auto values = std::make_shared<vtkStratusXMLValues>(image, array);
  const int64_t tuples = array.Sizes[0] * array.Sizes[1] * array.Sizes[2];
  const int64_t size = vtkDataArray::GetDataTypeSize(array.Type), bytes = tuples * array.Components * size;
  vtkSmartPointer<vtkDataArray> result;
  *left = false;
  if (this->MapFile && bytes >= this->MappedBytesLeast) {
    const vtkStratusBox part = vtkStratusBoxOf(this->WholeExtent, this->Part, array.Cells);
    result = values->GetBegin() < 0 ? MakeBricks(image, array, values, part)
                                    : vtkStratusLeaveRaw(image.Path, values->GetBegin(), array.Name.c_str(), array.Type, array.Components,
                                        array.Sizes.data(), part, true, image.Swaps() && size > 1);
    *left = result != nullptr;
  }
  if (!result) {
    result = vtkStratusMakeArray(array.Type, array.Components, tuples);
    result->SetName(array.Name.c_str());
    const bool whole = values->ReadAll(result->GetVoidPointer(0), [this, &image](double done) {
      this->UpdateProgress(done);
      if (this->GetAbortExecute()) {
        image.Fail("reading was aborted");
      }
    });
    if (!whole) {
      image.Fail("the values of the array '" + array.Name + "' cannot be read: they are damaged or cut short");
    }
  }
  if (!array.Units.empty()) {
    result->GetInformation()->Set(vtkDataArray::UNITS_LABEL(), array.Units);
  }
  return result;
}

// Field data are few, in any encoding: VTK's own reader reads them, and no other array.
void vtkStratusXMLImageReader::ReadFieldData(vtkDataObject* output)
{
  bool failed = false;
  vtkNew<vtkXMLImageDataReader> reader;
  vtkNew<vtkCallbackCommand> listener;
  listener->SetClientData(&failed);
  listener->SetCallback([](vtkObject*, unsigned long, void* client, void*) { *static_cast<bool*>(client) = true; });
  reader->SetFileName(this->FileName);
  reader->SetReaderErrorObserver(listener);
  reader->SetParserErrorObserver(listener);
  try {
    reader->UpdateInformation();
    reader->GetPointDataArraySelection()->DisableAllArrays();
    reader->GetCellDataArraySelection()->DisableAllArrays();
    reader->Update();
  } catch (const std::exception&) { // of sizes in a damaged file
    failed = true;
  }
  if (failed) {
    this->Image->Fail("the field data cannot be read: they are damaged or cut short");
  }
  vtkImageData* const read = reader->GetOutput();
  output->GetFieldData()->ShallowCopy(read->GetFieldData());
  if (read->GetInformation()->Has(vtkDataObject::DATA_TIME_STEP())) {
    output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), read->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()));
  }
}

void vtkStratusXMLImageReader::Build(size_t, vtkDataObject* output)
{
  constexpr int vector = 3;
  const vtkStratusXMLImage& from = *this->Image;
  vtkImageData* const image = vtkImageData::SafeDownCast(output);
  vtkDataSetAttributes* const data[] = { image->GetPointData(), image->GetCellData() };
  image->Initialize();
  image->SetExtent(this->WholeExtent);
  image->SetOrigin(from.Origin.data());
  image->SetSpacing(from.Spacing.data());
  image->SetDirectionMatrix(from.Direction.data());
  if (from.HasFieldData) {
    this->ReadFieldData(image);
  }
  this->Mapped = 0;
  for (const vtkStratusXMLArray& array : from.Arrays) {
    bool left = false;
    data[array.Cells ? 1 : 0]->AddArray(this->GetValues(array, &left));
    this->Mapped = left ? 1 : this->Mapped;
  }
  for (size_t cells = 0; cells < 2; ++cells) {
    for (size_t kind = 0; kind < from.Active[cells].size(); ++kind) {
      if (!from.Active[cells][kind].empty()) {
        data[cells]->SetActiveAttribute(from.Active[cells][kind].c_str(), static_cast<int>(kind));
      }
    }
  }
  for (int cells = 0; this->VariableName && *this->VariableName && cells < 2; ++cells) {
    if (vtkDataArray* chosen = data[cells]->GetArray(this->VariableName)) {
      const bool colours = chosen->GetDataType() == VTK_UNSIGNED_CHAR;
      data[cells]->SetActiveAttribute(this->VariableName,
        chosen->GetNumberOfComponents() == vector && !colours ? vtkDataSetAttributes::VECTORS : vtkDataSetAttributes::SCALARS);
      break; /* of points and cells with one name, points are meant */
    }
  }
}

int vtkStratusXMLImageReader::RequestInformation(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  if (!this->Superclass::RequestInformation(request, inputs, outputs)) {
    return 0;
  }
  vtkInformation* const info = outputs->GetInformationObject(0);
  info->Set(vtkDataObject::ORIGIN(), this->Image->Origin.data(), 3);
  info->Set(vtkDataObject::SPACING(), this->Image->Spacing.data(), 3);
  info->Set(vtkDataObject::DIRECTION(), this->Image->Direction.data(), 9);
  return 1;
}

void vtkStratusXMLImageReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}
