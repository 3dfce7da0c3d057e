// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusNetCDFReader.h"

#include "vtkStratusNetCDFFile.h"

#include "vtkDataObjectTypes.h"
#include "vtkDataSet.h"
#include "vtkErrorCode.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <new>

vtkStratusNetCDFReader::vtkStratusNetCDFReader()
{
  this->SetNumberOfInputPorts(0);
  std::fill_n(this->WholeExtent, 6, 0);
}

vtkStratusNetCDFReader::~vtkStratusNetCDFReader()
{
  this->SetFileName(nullptr);
  this->SetVariableName(nullptr);
}

int vtkStratusNetCDFReader::FillInputPortInformation(int, vtkInformation*)
{
  return 0;
}

int vtkStratusNetCDFReader::FillOutputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkDataSet");
  return 1;
}

int vtkStratusNetCDFReader::GetNumberOfVariables()
{
  return static_cast<int>(this->Variables.size());
}

const char* vtkStratusNetCDFReader::GetNameOfVariable(int index)
{
  return index >= 0 && index < this->GetNumberOfVariables() ? this->Variables[static_cast<size_t>(index)].Name.c_str() : "";
}

const char* vtkStratusNetCDFReader::GetUnitsOfVariable(int index)
{
  return index >= 0 && index < this->GetNumberOfVariables() ? this->Variables[static_cast<size_t>(index)].Units.c_str() : "";
}

const char* vtkStratusNetCDFReader::GetLongNameOfVariable(int index)
{
  return index >= 0 && index < this->GetNumberOfVariables() ? this->Variables[static_cast<size_t>(index)].LongName.c_str() : "";
}

const char* vtkStratusNetCDFReader::GetTimeUnits()
{
  return this->TimeUnits.c_str();
}

const char* vtkStratusNetCDFReader::GetLengthUnits()
{
  return this->LengthUnits.c_str();
}

const char* vtkStratusNetCDFReader::GetDescription()
{
  return this->Description.c_str();
}

std::string vtkStratusNetCDFReader::ChosenName(const vtkStratusNetCDFFile& file) const
{
  const std::string wanted = this->VariableName ? this->VariableName : "";
  std::string names;
  for (const VariableEntry& one : this->Variables) {
    if (wanted.empty() || one.Name == wanted) {
      return one.Name;
    }
    names += (names.empty() ? "" : ", ") + one.Name + (one.Units.empty() ? "" : " (" + one.Units + ")");
  }
  file.Fail(wanted.empty() ? "there is no variable on a grid of three dimensions"
                           : "there is no variable '" + wanted + "' on the grid; those that are: " + (names.empty() ? "none" : names));
}

// Inspects the file where it or the variable was set anew.
bool vtkStratusNetCDFReader::Look()
{
  if (this->LookTime == this->GetMTime()) {
    return !this->OutputClass.empty();
  }
  this->LookTime = this->GetMTime();
  this->OutputClass.clear();
  this->Variables.clear();
  this->Times.clear();
  this->TimeUnits.clear();
  this->Description.clear();
  this->LengthUnits.clear();
  this->SetErrorCode(vtkErrorCode::NoError);
  if (!this->FileName || !*this->FileName) {
    this->SetErrorCode(vtkErrorCode::NoFileNameError);
    vtkErrorMacro("FileName is not set");
    return false;
  }
  try {
    const vtkStratusNetCDFFile file(this->FileName);
    this->OutputClass = this->Inspect(file);
  } catch (const vtkStratusNetCDFError& error) {
    this->SetErrorCode(vtkErrorCode::FileFormatError);
    vtkErrorMacro(<< error.Text);
  } catch (const std::bad_alloc&) {
    this->SetErrorCode(vtkErrorCode::UnknownError);
    vtkErrorMacro(<< "out of memory while looking at " << this->FileName);
  }
  return !this->OutputClass.empty();
}

int vtkStratusNetCDFReader::RequestDataObject(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
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

int vtkStratusNetCDFReader::RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  if (!this->Look()) {
    return 0;
  }
  vtkInformation* info = outputs->GetInformationObject(0);
  info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), this->WholeExtent, 6);
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

int vtkStratusNetCDFReader::RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  vtkInformation* info = outputs->GetInformationObject(0);
  vtkDataSet* output = vtkDataSet::GetData(info);
  if (!output || !this->Look()) {
    return 0;
  }
  size_t step = 0;
  if (!this->Times.empty() && info->Has(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP())) {
    const double time = info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP());
    const auto after = std::upper_bound(this->Times.begin(), this->Times.end(), time);
    step = after == this->Times.begin() ? 0 : static_cast<size_t>(after - this->Times.begin()) - 1;
  }
  try {
    const vtkStratusNetCDFFile file(this->FileName);
    this->Build(file, step, output);
    if (!this->Times.empty()) {
      output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), this->Times[step]);
    }
    return 1;
  } catch (const vtkStratusNetCDFError& error) {
    this->SetErrorCode(vtkErrorCode::FileFormatError);
    vtkErrorMacro(<< error.Text);
  } catch (const std::bad_alloc&) {
    this->SetErrorCode(vtkErrorCode::UnknownError);
    vtkErrorMacro(<< "out of memory while reading " << this->FileName);
  }
  output->Initialize();
  return 0;
}

void vtkStratusNetCDFReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
  os << indent << "VariableName: " << (this->VariableName ? this->VariableName : "(the first)") << "\n";
  os << indent << "Description: " << this->Description << "\n";
}
