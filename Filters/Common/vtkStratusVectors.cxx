// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusVectors.h"

#include "vtkColorTransferFunction.h"
#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkVolumeProperty.h"

#include "stratus.h"

#include <algorithm>
#include <cmath>

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
  vtkSmartPointer<vtkDataArray> values;
  if (component == Magnitude) {
    vtkNew<vtkDoubleArray> lengths; // integers would round them
    lengths->SetNumberOfValues(count);
    for (vtkIdType i = 0; i < count; ++i) {
      double square = 0.0;
      for (int c = 0; c < array->GetNumberOfComponents(); ++c) {
        square += array->GetComponent(i, c) * array->GetComponent(i, c);
      }
      lengths->SetValue(i, std::sqrt(square));
    }
    values = lengths;
  } else {
    values.TakeReference(array->NewInstance());
    values->SetNumberOfTuples(count);
    values->CopyComponent(0, array, component);
  }
  values->SetName(array->GetName());
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
