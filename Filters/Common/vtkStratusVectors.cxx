// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusVectors.h"

#include "vtkColorTransferFunction.h"
#include "vtkSMPTools.h"
#include "vtkVolumeProperty.h"

#include "stratus.h"

#include <algorithm>
#include <cmath>
#include <numeric>

int vtkStratusVectors::Find(vtkVolumeProperty* property, int components)
{
  if (components < 2 || !property->GetIndependentComponents()) {
    return All;
  }
  const bool gray = property->GetColorChannels() == 1; // such a function has no mode
  vtkColorTransferFunction* color = gray ? nullptr : property->GetRGBTransferFunction();
  if (color && color->GetVectorMode() != vtkScalarsToColors::COMPONENT) {
    return Magnitude;
  }
  const int component = color ? color->GetVectorComponent() : 0;
  return component == 0 && components <= STRATUS_COMPONENTS_MAX ? All : component;
}

vtkSmartPointer<vtkDataArray> vtkStratusVectors::Make(vtkDataArray* array, int component)
{
  const vtkIdType count = array->GetNumberOfTuples();
  vtkSmartPointer<vtkDataArray> values;
  values.TakeReference(component == Magnitude ? vtkDataArray::CreateDataArray(VTK_DOUBLE) : array->NewInstance()); // integers would round
  values->SetName(array->GetName());
  values->SetNumberOfTuples(count);
  if (component != Magnitude) {
    values->CopyComponent(0, array, component);
    return values;
  }
  vtkSMPTools::For(0, count, [&](vtkIdType begin, vtkIdType end) {
    std::vector<double> tuple(static_cast<size_t>(array->GetNumberOfComponents()));
    for (vtkIdType i = begin; i < end; ++i) {
      array->GetTuple(i, tuple.data());
      values->SetComponent(i, 0, std::sqrt(std::inner_product(tuple.begin(), tuple.end(), tuple.begin(), 0.0)));
    }
  });
  return values;
}

vtkDataArray* vtkStratusVectors::Get(vtkDataArray* array, int component, vtkMTimeType time)
{
  time = std::max(time, array->GetMTime());
  const vtkIdType count = array->GetNumberOfTuples(); // may change without the time
  for (Entry& entry : this->Entries) {
    if (entry.Array == array && entry.Component == component && entry.Time == time && entry.Values->GetNumberOfTuples() == count) {
      entry.Asked = true;
      return entry.Values;
    }
  }
  const vtkSmartPointer<vtkDataArray> values = Make(array, component);
  this->Entries.push_back({ array, values, component, time, true });
  return values;
}

void vtkStratusVectors::Sweep()
{
  const auto forgotten = [](const Entry& entry) { return !entry.Asked; };
  this->Entries.erase(std::remove_if(this->Entries.begin(), this->Entries.end(), forgotten), this->Entries.end());
  for (Entry& entry : this->Entries) {
    entry.Asked = false;
  }
}
