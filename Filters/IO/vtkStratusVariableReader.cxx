// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusVariableReader.h"

#include "vtkStratusBricks.h"
#include "vtkStratusMapped.h"
#include "vtkStratusMappedFile.h"
#include "vtkStratusMetres.h"
#include "vtkStratusParts.h"
#include "vtkStratusReadError.h"
#include "vtkStratusUnits.h"

#include "vtkDataObject.h"
#include "vtkDataObjectTypes.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkErrorCode.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <new>

vtkStratusVariableReader::vtkStratusVariableReader()
{
  this->SetNumberOfInputPorts(0);
  std::fill_n(this->WholeExtent, 6, 0);
  std::fill_n(this->Part, 6, 0);
  std::fill_n(this->BricksPart, 6, 0);
  std::fill_n(this->OwnedPart, 6, 0);
}

vtkStratusVariableReader::~vtkStratusVariableReader()
{
  this->SetFileName(nullptr);
  this->SetVariableName(nullptr);
}

void vtkStratusVariableReader::SetMemoryLimit(vtkTypeInt64 bytes)
{
  vtkStratusSetBrickMemory(bytes);
}

vtkTypeInt64 vtkStratusVariableReader::GetMemoryLimit()
{
  return vtkStratusGetBrickMemory();
}

void vtkStratusVariableReader::SetMemoryLimitInMiB(vtkTypeInt64 size)
{
  constexpr int bits = 20;
  if (size > 0) {
    SetMemoryLimit(std::min(size, VTK_TYPE_INT64_MAX >> bits) << bits);
  }
}

vtkTypeInt64 vtkStratusVariableReader::GetMemoryUsed()
{
  return vtkStratusGetBrickMemoryUsed();
}

vtkTypeInt64 vtkStratusVariableReader::GetBytesRead()
{
  return vtkStratusGetBrickBytesRead();
}

int vtkStratusVariableReader::FillInputPortInformation(int, vtkInformation*)
{
  return 0;
}

int vtkStratusVariableReader::FillOutputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkDataSet");
  return 1;
}

int vtkStratusVariableReader::GetNumberOfVariables()
{
  return static_cast<int>(this->Variables.size());
}

vtkStringArray* vtkStratusVariableReader::GetNamesOfVariables()
{
  this->Names->Initialize();
  for (const VariableEntry& one : this->Variables) {
    this->Names->InsertNextValue(one.Name);
  }
  return this->Names;
}

const char* vtkStratusVariableReader::GetNameOfVariable(int index)
{
  return index >= 0 && index < this->GetNumberOfVariables() ? this->Variables[static_cast<size_t>(index)].Name.c_str() : "";
}

const char* vtkStratusVariableReader::GetUnitsOfVariable(int index)
{
  return index >= 0 && index < this->GetNumberOfVariables() ? this->Variables[static_cast<size_t>(index)].Units.c_str() : "";
}

const char* vtkStratusVariableReader::GetLongNameOfVariable(int index)
{
  return index >= 0 && index < this->GetNumberOfVariables() ? this->Variables[static_cast<size_t>(index)].LongName.c_str() : "";
}

const char* vtkStratusVariableReader::GetStandardNameOfVariable(int index)
{
  return index >= 0 && index < this->GetNumberOfVariables() ? this->Variables[static_cast<size_t>(index)].StandardName.c_str() : "";
}

const char* vtkStratusVariableReader::GetTimeUnits()
{
  return this->TimeUnits.c_str();
}

const char* vtkStratusVariableReader::GetTimeCalendar()
{
  return this->TimeCalendar.c_str();
}

const char* vtkStratusVariableReader::GetLengthUnits()
{
  return this->LengthUnits.c_str();
}

const char* vtkStratusVariableReader::GetNameOfAxis(int axis)
{
  return axis >= 0 && axis < 3 ? this->AxisNames[axis].c_str() : "";
}

const char* vtkStratusVariableReader::GetUnitsOfAxis(int axis)
{
  return axis < 0 || axis > 2 ? "" : this->AxisUnits[axis].empty() ? this->LengthUnits.c_str() : this->AxisUnits[axis].c_str();
}

int vtkStratusVariableReader::GetKindOfAxis(int axis)
{
  return axis >= 0 && axis < 3 ? this->FileAxes[axis].Kind : AXIS_OF_NUMBERS;
}

const char* vtkStratusVariableReader::GetTitleOfAxis(int axis)
{
  return axis < 0 || axis > 2 || this->FileAxes[axis].Title.empty() ? this->GetNameOfAxis(axis) : this->FileAxes[axis].Title.c_str();
}

const char* vtkStratusVariableReader::GetFileUnitsOfAxis(int axis)
{
  return axis < 0 || axis > 2 || this->FileAxes[axis].Units.empty() ? this->GetUnitsOfAxis(axis) : this->FileAxes[axis].Units.c_str();
}

double vtkStratusVariableReader::GetScaleOfAxis(int axis)
{
  return axis >= 0 && axis < 3 ? this->FileAxes[axis].Scale : 1.0;
}

int vtkStratusVariableReader::GetNumberOfLevelsOfAxis(int axis)
{
  return axis >= 0 && axis < 3 ? static_cast<int>(this->FileAxes[axis].Levels.size() / 2) : 0;
}

double vtkStratusVariableReader::GetCoordinateOfLevel(int axis, int level)
{
  return level >= 0 && level < this->GetNumberOfLevelsOfAxis(axis) ? this->FileAxes[axis].Levels[2 * static_cast<size_t>(level)] : 0.0;
}

double vtkStratusVariableReader::GetNumberOfLevel(int axis, int level)
{
  return level >= 0 && level < this->GetNumberOfLevelsOfAxis(axis) ? this->FileAxes[axis].Levels[2 * static_cast<size_t>(level) + 1] : 0.0;
}

const char* vtkStratusVariableReader::GetDescription()
{
  return this->Description.c_str();
}

std::string vtkStratusVariableReader::ChosenName() const
{
  const std::string wanted = this->VariableName ? this->VariableName : "";
  std::string names;
  for (const VariableEntry& one : this->Variables) {
    if (wanted.empty() || one.Name == wanted) {
      return one.Name;
    }
    names += (names.empty() ? "" : ", ") + one.Name + (one.Units.empty() ? "" : " (" + one.Units + ")");
  }
  throw vtkStratusReadError{ std::string(this->FileName) + ": " +
    (wanted.empty() ? "there is no variable on a grid of three dimensions"
                    : "there is no variable '" + wanted + "' on the grid; those that are: " + (names.empty() ? "none" : names)) };
}

// Inspects the file where it or the variable was set anew.
bool vtkStratusVariableReader::Look()
{
  if (this->LookTime == this->GetMTime()) {
    return !this->OutputClass.empty();
  }
  this->LookTime = this->GetMTime();
  this->Bricks.clear();
  this->Ahead = nullptr;
  this->OutputClass.clear();
  this->Variables.clear();
  this->Times.clear();
  this->TimeUnits.clear();
  this->TimeCalendar.clear();
  this->Description.clear();
  this->LengthUnits.clear();
  for (int axis = 0; axis < 3; ++axis) {
    this->AxisNames[axis].clear();
    this->AxisUnits[axis].clear();
    this->FileAxes[axis] = vtkStratusFileAxis();
  }
  this->SetErrorCode(vtkErrorCode::NoError);
  if (!this->FileName || !*this->FileName) {
    this->SetErrorCode(vtkErrorCode::NoFileNameError);
    vtkErrorMacro("FileName is not set");
    return false;
  }
  try {
    this->OutputClass = this->Inspect();
  } catch (const vtkStratusReadError& error) {
    this->SetErrorCode(vtkErrorCode::FileFormatError);
    vtkErrorMacro(<< error.Text);
  } catch (const std::bad_alloc&) {
    this->SetErrorCode(vtkErrorCode::UnknownError);
    vtkErrorMacro(<< "out of memory while looking at " << this->FileName);
  }
  return !this->OutputClass.empty();
}

// Takes the bricks of a step from those that are kept. They may have to wait for a thread that reads them, which may wait for a lock of the
// caller's, so that they are freed later.
void vtkStratusVariableReader::Retire(size_t step)
{
  this->Retired.push_back(this->Bricks[step]);
  this->Bricks.erase(step);
}

vtkSmartPointer<vtkDataArray> vtkStratusVariableReader::BricksOf(
  size_t step, const std::function<vtkSmartPointer<vtkDataArray>(size_t)>& make)
{
  constexpr size_t most = 8; // steps: each may have its file open
  const uint64_t file = vtkStratusIdentityOfFile(this->FileName, 0, -1);
  const auto at = [&](size_t one) {
    const auto kept = this->Bricks.find(one);
    if (kept != this->Bricks.end() && vtkStratusIdentityOf(kept->second) == 0) {
      this->Retire(one); // something changed the array
    }
    vtkSmartPointer<vtkDataArray>& array = this->Bricks[one];
    array = array ? array : make(one);
    return array;
  };
  if (file != this->BricksFile || !std::equal(this->Part, this->Part + 6, this->BricksPart)) { // it was replaced
    while (!this->Bricks.empty()) {
      this->Retire(this->Bricks.begin()->first);
    }
    this->BricksFile = file;
    std::copy_n(this->Part, 6, this->BricksPart);
  }
  const bool plays = !this->Bricks.empty() && step != this->LastStep, back = step < this->LastStep;
  this->LastStep = step;
  if (this->Ahead) {
    vtkStratusReadAhead(this->Ahead, nullptr);
    this->Retired.push_back(this->Ahead);
    this->Ahead = nullptr;
  }
  const vtkSmartPointer<vtkDataArray> now = at(step);
  if (now && plays && (back ? step > 0 : step + 1 < this->Times.size())) {
    try {
      this->Ahead = at(back ? step - 1 : step + 1);
    } catch (const vtkStratusReadError&) { // the error comes when the step is shown
      this->Bricks.erase(back ? step - 1 : step + 1);
    }
    if (this->Ahead) {
      vtkStratusReadAhead(this->Ahead, now);
    }
  }
  // Nothing is dropped for a step that is read ahead: past steps make room.
  const bool full = 2 * vtkStratusGetBrickMemoryUsed() > vtkStratusGetBrickMemory();
  while (this->Bricks.size() > (full ? 2 : most)) { // the one that is farthest in time goes
    const size_t first = this->Bricks.begin()->first, last = std::prev(this->Bricks.end())->first;
    this->Retire(step - first > last - step ? first : last);
  }
  return now;
}

void vtkStratusVariableReader::SetAxesOnSphere()
{
  static const char* const names[] = { "x", "y", "z" };
  this->LengthUnits = "m";
  for (int axis = 0; axis < 3; ++axis) {
    this->AxisNames[axis] = names[axis];
    this->AxisUnits[axis] = "m";
    this->FileAxes[axis] = vtkStratusFileAxis();
  }
}

int vtkStratusVariableReader::RequestDataObject(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  if (!this->Look()) {
    return 0;
  }
  vtkInformation* info = outputs->GetInformationObject(0);
  vtkDataObject* before = vtkDataObject::GetData(info);
  if (!before || this->OutputClass != before->GetClassName()) {
    vtkDataObject* output = vtkDataObjectTypes::NewDataObject(this->OutputClass.c_str());
    info->Set(vtkDataObject::DATA_OBJECT(), output);
    output->Delete();
  }
  return 1;
}

int vtkStratusVariableReader::RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  if (!this->Look()) {
    return 0;
  }
  vtkInformation* info = outputs->GetInformationObject(0);
  if (vtkDataObject::GetData(info)->GetExtentType() == VTK_3D_EXTENT) {
    info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), this->WholeExtent, 6);
    if (this->GivesParts) { // and their ghosts, which the pipeline would give whole arrays for
      info->Set(vtkAlgorithm::CAN_HANDLE_PIECE_REQUEST(), 1);
    }
  } else {
    info->Remove(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT());
    info->Remove(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT()); // of an output with an extent
  }
  if (this->Times.empty()) {
    info->Remove(vtkStreamingDemandDrivenPipeline::TIME_STEPS());
    info->Remove(vtkStreamingDemandDrivenPipeline::TIME_RANGE());
  } else {
    double range[2] = { this->Times.front(), this->Times.back() };
    info->Set(vtkStreamingDemandDrivenPipeline::TIME_STEPS(), this->Times.data(), static_cast<int>(this->Times.size()));
    info->Set(vtkStreamingDemandDrivenPipeline::TIME_RANGE(), range, 2);
  }
  return 1;
}

// Finds what is requested. Returns false if that is nothing.
bool vtkStratusVariableReader::FindPart(vtkInformation* request, vtkDataObject* output)
{
  std::copy_n(this->WholeExtent, 6, this->Part);
  std::copy_n(this->WholeExtent, 6, this->OwnedPart);
  const bool divides = output->GetExtentType() == VTK_3D_EXTENT || output->IsA("vtkPartitionedDataSet");
  return !this->GivesParts || !divides || vtkStratusFindPart(request, this->WholeExtent, this->Part, this->OwnedPart);
}

// Sets the unit of the variable's values, and how long a unit of the coordinates is if that is known.
void vtkStratusVariableReader::SetUnits(vtkDataObject* output)
{
  const std::string name = this->ChosenName();
  for (const VariableEntry& one : this->Variables) {
    for (int kind = 0; one.Name == name && !one.Units.empty() && kind < 2; ++kind) {
      vtkFieldData* data = output->GetAttributesAsFieldData(kind == 0 ? vtkDataObject::POINT : vtkDataObject::CELL);
      vtkDataArray* values = data ? data->GetArray(name.c_str()) : nullptr;
      if (values) {
        values->GetInformation()->Set(vtkDataArray::UNITS_LABEL(), one.Units);
      }
    }
  }
  const double metres = vtkStratusMetresOf(this->LengthUnits);
  if (metres > 0.0) {
    vtkNew<vtkDoubleArray> array;
    array->SetName(vtkStratusMetresPerUnitName);
    array->InsertNextValue(metres);
    output->GetFieldData()->AddArray(array);
  }
}

int vtkStratusVariableReader::RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  vtkInformation* info = outputs->GetInformationObject(0);
  vtkDataObject* output = vtkDataObject::GetData(info);
  if (!output || !this->Look()) {
    return 0;
  }
  size_t step = 0;
  if (!this->Times.empty() && info->Has(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP())) {
    const double time = info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP());
    const auto after = std::upper_bound(this->Times.begin(), this->Times.end(), time);
    step = after == this->Times.begin() ? 0 : static_cast<size_t>(after - this->Times.begin()) - 1;
  }
  if (vtkFieldData* points = output->GetAttributesAsFieldData(vtkDataObject::POINT)) {
    points->Initialize(); // an image keeps the values of another variable, of other sizes perhaps
  }
  this->Retired.clear();
  if (!this->FindPart(info, output)) {
    output->Initialize();
    return 1;
  }
  try {
    this->Build(step, output);
    this->SetUnits(output);
    if (auto* grid = this->GivesParts && output->GetExtentType() == VTK_3D_EXTENT ? vtkDataSet::SafeDownCast(output) : nullptr) {
      vtkStratusCutGrid(grid, this->WholeExtent, this->Part);
      vtkStratusFlagDuplicates(grid, this->OwnedPart, this->Mapped && grid->GetNumberOfPoints() >= this->MappedBytesLeast);
    }
    this->Retired.clear();
    if (!this->Times.empty()) {
      output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), this->Times[step]);
    }
    return 1;
  } catch (const vtkStratusReadError& error) {
    this->SetErrorCode(vtkErrorCode::FileFormatError);
    vtkErrorMacro(<< error.Text);
  } catch (const std::bad_alloc&) {
    this->SetErrorCode(vtkErrorCode::UnknownError);
    vtkErrorMacro(<< "out of memory while reading " << this->FileName);
  }
  output->Initialize();
  return 0;
}

void vtkStratusVariableReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
  os << indent << "VariableName: " << (this->VariableName ? this->VariableName : "(the first)") << "\n";
  os << indent << "MapFile: " << this->MapFile << "\n";
  os << indent << "Mapped: " << this->Mapped << "\n";
  os << indent << "MappedBytesLeast: " << this->MappedBytesLeast << "\n";
  os << indent << "Description: " << this->Description << "\n";
}
