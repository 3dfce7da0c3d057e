// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusSolidColor.h"

#include "vtkCellData.h"
#include "vtkColorTransferFunction.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkMultiProcessController.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <vector>

namespace {

vtkDataArray* first_array(vtkDataSetAttributes* arrays)
{
  if (vtkDataArray* active = arrays->GetScalars(); active && active->GetName()) {
    return active;
  }
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i) {
    vtkDataArray* array = arrays->GetArray(i);
    if (array && array->GetName() && std::string(array->GetName()) != vtkDataSetAttributes::GhostArrayName()) {
      return array;
    }
  }
  return nullptr;
}

std::vector<vtkDataSet*> grids_of(vtkDataObject* data)
{
  if (auto* grid = vtkDataSet::SafeDownCast(data)) {
    return { grid };
  }
  auto* blocks = vtkCompositeDataSet::SafeDownCast(data);
  return blocks ? vtkCompositeDataSet::GetDataSets(blocks) : std::vector<vtkDataSet*>();
}
} // namespace

stratus::SolidColor::SolidColor() : Range{ VTK_DOUBLE_MAX, -VTK_DOUBLE_MAX } {}

stratus::SolidColor::~SolidColor() = default;

void stratus::SolidColor::Choose(int& association, const char*& name)
{
  this->Solid = !name || !name[0];
  if (!this->Solid) {
    this->Name = name;
    this->Association = association;
  } else {
    name = this->Name.empty() ? this->FoundName.c_str() : this->Name.c_str();
    association = this->Name.empty() ? this->FoundAssociation : this->Association;
  }
}

void stratus::SolidColor::SetFunction(vtkColorTransferFunction* function)
{
  this->Function = function;
  if (function) {
    this->LastFunction = function;
  }
}

void stratus::SolidColor::SetOpacity(vtkPiecewiseFunction* function)
{
  this->Opacity = function;
  if (function) {
    this->LastOpacity = function;
  }
}

void stratus::SolidColor::SetColor(double red, double green, double blue)
{
  this->Color[0] = red;
  this->Color[1] = green;
  this->Color[2] = blue;
}

bool stratus::SolidColor::FindArray(vtkDataObject* data)
{
  const std::vector<vtkDataSet*> grids = grids_of(data);
  this->FoundName.clear();
  this->Range[0] = VTK_DOUBLE_MAX;
  this->Range[1] = -VTK_DOUBLE_MAX;
  for (const int of : { vtkDataObject::POINT, vtkDataObject::CELL }) {
    for (vtkDataSet* grid : grids) {
      vtkDataSetAttributes* arrays = grid->GetAttributes(of);
      vtkDataArray* array = this->FoundName.empty() ? first_array(arrays) : arrays->GetArray(this->FoundName.c_str());
      if (array && array->GetNumberOfTuples() > 0) {
        this->FoundName = array->GetName();
        this->FoundAssociation = of;
        double range[2];
        array->GetFiniteRange(range, array->GetNumberOfComponents() > 1 ? -1 : 0);
        this->Range[0] = std::min(this->Range[0], range[0]);
        this->Range[1] = std::max(this->Range[1], range[1]);
      }
    }
    if (!this->FoundName.empty()) {
      return true;
    }
  }
  return false;
}

void stratus::SolidColor::JoinRange(vtkMultiProcessController* ranks)
{
  const double mine[2] = { this->Range[0], -this->Range[1] };
  double least[2];
  ranks->AllReduce(mine, least, 2, vtkCommunicator::MIN_OP);
  this->Range[0] = least[0];
  this->Range[1] = -least[1];
}

void stratus::SolidColor::Apply(vtkVolumeProperty* property)
{
  vtkColorTransferFunction* function = this->Function;
  vtkPiecewiseFunction* opacity = this->Opacity;
  if (this->Solid) {
    double color[3];
    this->One->GetColor(0.0, color);
    if (this->One->GetSize() == 0 || !std::equal(color, color + 3, this->Color)) {
      this->One->RemoveAllPoints();
      this->One->AddRGBPoint(0.0, this->Color[0], this->Color[1], this->Color[2]);
    }
    const bool component = this->LastFunction && this->LastFunction->GetVectorMode() == vtkScalarsToColors::COMPONENT;
    this->One->SetVectorMode(component ? vtkScalarsToColors::COMPONENT : vtkScalarsToColors::MAGNITUDE);
    this->One->SetVectorComponent(component ? this->LastFunction->GetVectorComponent() : 0);
    function = this->One;
    opacity = this->LastOpacity;
    if (!opacity || this->IsOpen()) {
      const double ends[2] = { this->Range[0], this->Range[1] > this->Range[0] ? this->Range[1] : this->Range[0] + 1.0 };
      double* set = this->Ramp->GetRange();
      if (this->Ramp->GetSize() == 0 || set[0] != ends[0] || set[1] != ends[1]) {
        this->Ramp->RemoveAllPoints();
        this->Ramp->AddPoint(ends[0], 0.0);
        this->Ramp->AddPoint(ends[1], 1.0);
      }
      opacity = this->Ramp;
    }
  }
  if (function) {
    property->SetColor(function);
  }
  if (opacity) {
    property->SetScalarOpacity(opacity);
  }
}
