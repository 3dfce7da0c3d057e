// SPDX-License-Identifier: BSD-3-Clause
// Functions of two variables of vtkStratusVolumeMapper: finds them in the property, and takes them to the core's terms.
#include "vtkStratusVolumeMapperInternals.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>

bool vtkStratusVolumeMapper::Internals::HasTransfer2D(vtkVolumeProperty* property) const
{
  return property->GetTransferFunctionMode() == vtkVolumeProperty::TF_2D && this->GetMode() == STRATUS_MODE_COMPOSITE;
}

// Finds the array of the function's second variable, which is of the same points or cells as the scalars.
vtkDataArray* vtkStratusVolumeMapper::Internals::FindSecond(vtkDataSet* image, bool cells, std::string& error) const
{
  const char* name = this->Mapper->Transfer2DYAxisArray;
  vtkDataSetAttributes* all = cells ? static_cast<vtkDataSetAttributes*>(image->GetCellData()) : image->GetPointData();
  vtkDataArray* second = all->GetArray(name);
  const vtkIdType wanted = cells ? image->GetNumberOfCells() : image->GetNumberOfPoints();
  if (!second) {
    error = std::string("there is no array '") + name + "' of " + (cells ? "cells" : "points") +
      ", which Transfer2DYAxisArray names: " + vtkStratusArrayNames(image);
  } else if (second->GetNumberOfComponents() != 1 || second->GetNumberOfTuples() < wanted) {
    error = std::string("Transfer2DYAxisArray '") + name + "' has " + std::to_string(second->GetNumberOfTuples()) + " values of " +
      std::to_string(second->GetNumberOfComponents()) + " components, the image needs " + std::to_string(wanted) + " of 1";
  }
  return error.empty() ? second : nullptr;
}

// Returns an array whose tuples are a component of `array` and a value of `second`, as the core takes two variables. Arrays of two types
// become floats.
vtkDataArray* vtkStratusVolumeMapper::Internals::Pair(vtkDataArray* array, int component, vtkDataArray* second)
{
  const vtkMTimeType time = std::max(array->GetMTime(), second->GetMTime());
  if (this->PairOf[0] != array || this->PairOf[1] != second || this->PairTime != time || this->PairComponent != component) {
    const bool same = array->GetDataType() == second->GetDataType();
    this->Pairs.TakeReference(vtkDataArray::CreateDataArray(same ? array->GetDataType() : VTK_FLOAT));
    this->Pairs->SetNumberOfComponents(2);
    this->Pairs->SetNumberOfTuples(std::min(array->GetNumberOfTuples(), second->GetNumberOfTuples()));
    this->Pairs->CopyComponent(0, array, component);
    this->Pairs->CopyComponent(1, second, 0);
    this->PairOf[0] = array;
    this->PairOf[1] = second;
    this->PairTime = time;
    this->PairComponent = component;
  }
  return this->Pairs;
}

// Sets the function of this frame. Columns cover the range of the values, as in VTK's mapper. Rows cover the range of the second array, or
// magnitudes from 0 to a quarter of the range of values.
bool vtkStratusVolumeMapper::Internals::SetTransfer2D(
  vtkVolumeProperty* property, vtkDataArray* array, int component, vtkDataArray* second, std::string& error)
{
  vtkImageData* image = property->GetTransferFunction2D();
  vtkDataArray* entries = image ? image->GetPointData()->GetScalars() : nullptr;
  int size[3] = { 0, 0, 0 };
  if (image) {
    image->GetDimensions(size);
  }
  if (!entries || entries->GetDataType() != VTK_FLOAT || entries->GetNumberOfComponents() != 4 || size[2] != 1 || size[0] < 1 ||
    size[1] < 1 || entries->GetNumberOfTuples() < static_cast<vtkIdType>(size[0]) * size[1]) {
    error = std::string("TransferFunctionMode is TF_2D, and TransferFunction2D ") +
      (image ? "has " + std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " + std::to_string(size[2]) + " points"
             : "is not set") +
      ": a vtkImageData of one layer with point scalars of 4 floats is needed";
    return false;
  }
  double range[2], other[2];
  array->GetFiniteRange(range, component);
  const double* set = this->Transfer2DRanges;
  std::copy_n(set, set[0] <= set[1] ? 2 : 0, range);
  const double extent = range[1] > range[0] ? range[1] - range[0] : 1.0; // a volume of one value, or of none, has the first column
  other[0] = 0.0;
  other[1] = 0.25 * extent;
  if (second) {
    second->GetFiniteRange(other, 0);
  }
  std::copy_n(set + 2, set[2] <= set[3] ? 2 : 0, other);
  if (second) {
    other[1] = other[1] > other[0] ? other[1] : other[0] + 1.0;
  }
  const bool any = range[0] <= range[1];
  this->Transfer2D = stratus_transfer_2d();
  this->Transfer2D.rgba = static_cast<const float*>(entries->GetVoidPointer(0));
  this->Transfer2D.columns = size[0];
  this->Transfer2D.rows = size[1];
  this->Transfer2D.value_range[0] = any ? range[0] : 0.0;
  this->Transfer2D.value_range[1] = this->Transfer2D.value_range[0] + extent;
  std::copy_n(other, 2, this->Transfer2D.second_range);
  this->Transfer2D.unit_distance = property->GetScalarOpacityUnitDistance();
  this->Transfer2D.revision = std::max(image->GetMTime(), entries->GetMTime());
  return true;
}

// Sets image, functions and function of two variables by an array, of which `component` is drawn (-1: it has one).
bool vtkStratusVolumeMapper::Internals::PrepareTransfer2D(
  vtkVolume* prop, vtkDataSet* image, vtkDataArray* array, bool cells, int component, const float* gradients, std::string& error)
{
  const int drawn = std::max(component, 0), components = array->GetNumberOfComponents();
  vtkDataArray* second = nullptr;
  if (drawn >= components || (component < 0 && components > 1)) {
    error = "TransferFunctionMode is TF_2D, and the array has " + std::to_string(components) +
      " components: " + (component < 0 ? "one is needed, by VectorMode" : "there is no component " + std::to_string(component));
    return false;
  }
  if (this->Mapper->Transfer2DYAxisArray) {
    second = this->FindSecond(image, cells, error);
    if (!second) {
      return false;
    }
  }
  this->Functions.assign(1, stratus_transfer_default()); // not read
  if (!this->SetTransfer2D(prop->GetProperty(), array, drawn, second, error) ||
    !this->Image.Set(
      image, second ? this->Pair(array, drawn, second) : array, cells, prop->GetMatrix(), error, 2, second ? -1 : component)) {
    return false;
  }
  this->Image.SetGradients(second ? nullptr : gradients);
  return true;
}

void vtkStratusVolumeMapper::Internals::AddTransfer2DRanges(vtkVolumeProperty* property, double ranges[4])
{
  vtkDataSet* image = vtkStratusAsImage(this->Mapper->GetDataObjectInput());
  bool cells = false;
  std::string unused;
  vtkDataArray* array = image && this->HasTransfer2D(property) ? this->FindArray(image, cells, unused) : nullptr;
  if (!array) {
    return;
  }
  const bool magnitude = this->Mapper->VectorMode == vtkStratusVolumeMapper::MAGNITUDE && array->GetNumberOfComponents() > 1;
  const int component = magnitude ? 0 : std::max(this->GetVectorComponent(array), 0);
  array = magnitude ? this->Vectors.Get(array, vtkStratusVectors::Magnitude, image->GetMTime()) : array;
  vtkDataArray* second = this->Mapper->Transfer2DYAxisArray ? this->FindSecond(image, cells, unused) : nullptr;
  double own[4] = { HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL };
  if (component < array->GetNumberOfComponents()) {
    array->GetFiniteRange(own, component);
  }
  if (second) {
    second->GetFiniteRange(own + 2, 0);
  }
  for (int i = 0; i < 4; ++i) {
    ranges[i] = i % 2 ? std::max(ranges[i], own[i]) : std::min(ranges[i], own[i]);
  }
}

// ---------------------------------------------------------------- gradients of the data's own

// Returns the gradients of an array's drawn numbers: of all its components, of one, or of the magnitude |v|, which has the sum of
// v grad v / |v| over its components.
const float* vtkStratusVolumeMapper::Internals::FindGradients(vtkDataArray* array, int component, bool magnitude)
{
  const vtkIdType count = array->GetNumberOfTuples(), components = array->GetNumberOfComponents();
  if (!this->Gradients || !magnitude) {
    return this->Gradients ? this->Gradients + 3 * std::max(component, 0) * count : nullptr;
  }
  if (this->GradientsOf != this->Gradients || this->GradientsTime != array->GetMTime()) {
    this->MagnitudeGradients.resize(static_cast<size_t>(3 * count));
    for (vtkIdType i = 0; i < 3 * count; ++i) {
      double sum = 0.0, square = 0.0;
      for (vtkIdType c = 0; c < components; ++c) {
        const double v = array->GetComponent(i % count, static_cast<int>(c));
        sum += v * static_cast<double>(this->Gradients[3 * c * count + i]);
        square += v * v;
      }
      this->MagnitudeGradients[static_cast<size_t>(i)] = square > 0.0 ? static_cast<float>(sum / std::sqrt(square)) : 0.0f;
    }
    this->GradientsOf = this->Gradients;
    this->GradientsTime = array->GetMTime();
  }
  return this->MagnitudeGradients.data();
}
