// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusInput.h"

#include "vtkStratusArrays.h"
#include "vtkStratusCoreType.h"
#include "vtkStratusMapped.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMatrix3x3.h"
#include "vtkMatrix4x4.h"
#include "vtkPointData.h"
#include "vtkRectilinearGrid.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>

namespace {
std::string ArrayName(vtkDataArray* array)
{
  return array->GetName() ? std::string("'") + array->GetName() + "'" : std::string("without a name");
}

// Mixes a modification time into a revision, so that a change of any of the times changes the revision.
uint64_t Mix(uint64_t revision, uint64_t time)
{
  return (revision ^ time) * UINT64_C(0x9E3779B97F4A7C15) + (revision >> 29);
}

void AddNames(vtkDataSetAttributes* data, const char* where, std::string& text)
{
  for (int i = 0; i < data->GetNumberOfArrays(); ++i) {
    vtkDataArray* array = data->GetArray(i);
    if (array && array->GetName()) {
      text += std::string(text.empty() ? "" : ", ") + "'" + array->GetName() + "' (" + where + ")";
    }
  }
}
} // namespace

vtkDataSet* vtkStratusAsImage(vtkDataObject* object)
{
  vtkDataSet* image = vtkImageData::SafeDownCast(object);
  return image ? image : vtkRectilinearGrid::SafeDownCast(object);
}

void vtkStratusMakeOutput(vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkDataObject* input = vtkStratusAsImage(vtkDataObject::GetData(inputs[0]));
  vtkDataObject* output = vtkDataObject::GetData(outputs);
  if (!output || (input && output->GetDataObjectType() != input->GetDataObjectType())) {
    auto made = vtkSmartPointer<vtkDataObject>::Take(input ? input->NewInstance() : vtkImageData::New());
    outputs->GetInformationObject(0)->Set(vtkDataObject::DATA_OBJECT(), made);
  }
}

std::string vtkStratusArrayNames(vtkDataSet* image)
{
  std::string names;
  AddNames(image->GetPointData(), "points", names);
  AddNames(image->GetCellData(), "cells", names);
  return names.empty() ? "the input has no array with a name" : "the input has " + names;
}

void vtkStratusImageView::Release()
{
  this->Source = nullptr;
  this->Plain = nullptr;
}

bool vtkStratusImageView::Set(
  vtkDataSet* image, vtkDataArray* array, bool cells, vtkMatrix4x4* matrix, std::string& error, int mostComponents, int component)
{
  this->Volume = stratus_volume_default();
  this->Volume.cell_centered = cells ? 1 : 0;
  vtkImageData* regular = vtkImageData::SafeDownCast(image);
  vtkRectilinearGrid* grid = vtkRectilinearGrid::SafeDownCast(image);
  int points[3] = { 0, 0, 0 };
  if (regular) {
    regular->GetDimensions(points);
  } else if (grid) {
    grid->GetDimensions(points);
  }
  for (int a = 0; a < 3; ++a) {
    // VTK counts one layer of cells along an axis of one point.
    this->Volume.dimensions[a] = cells ? std::max(points[a] - 1, 1) : points[a];
  }
  if (!this->SetValues(image, array, cells, mostComponents, component, error) || !this->SetGhosts(image, cells, error)) {
    return false;
  }
  if (matrix) {
    std::copy(&matrix->Element[0][0], &matrix->Element[0][0] + 16, this->Volume.matrix);
  }
  if (regular) {
    this->SetGeometry(regular);
  }
  return regular || this->SetCoordinates(grid, error);
}

// Copies coordinates of any type as doubles. The core checks that they rise or fall.
bool vtkStratusImageView::SetCoordinates(vtkRectilinearGrid* grid, std::string& error)
{
  vtkDataArray* const axes[] = { grid->GetXCoordinates(), grid->GetYCoordinates(), grid->GetZCoordinates() };
  const int* dimensions = grid->GetDimensions();
  for (int a = 0; a < 3; ++a) {
    const vtkIdType count = axes[a] ? axes[a]->GetNumberOfTuples() : 0;
    if (dimensions[a] < 2 || count != dimensions[a] || axes[a]->GetNumberOfComponents() != 1) {
      error = std::string("the rectilinear grid has ") + std::to_string(dimensions[a]) + " points along " + "xyz"[a] + " and " +
        std::to_string(count) + " coordinates, it needs as many, and at least 2: a flat grid has no volume";
      return false;
    }
    std::vector<double>& coordinates = this->Coordinates[a];
    coordinates.resize(static_cast<size_t>(count));
    for (vtkIdType i = 0; i < count; ++i) {
      coordinates[i] = axes[a]->GetComponent(i, 0);
    }
    this->Volume.coordinates[a] = coordinates.data();
    this->CropOffset[a] = 0.0;
  }
  return true;
}

double vtkStratusPosition(const stratus_volume& volume, int axis, double index)
{
  const double place = index + (volume.cell_centered ? 0.5 : 0.0);
  const double* x = volume.coordinates[axis];
  if (!x) {
    return volume.spacing[axis] * place;
  }
  const double last = static_cast<double>(volume.dimensions[axis] - (volume.cell_centered ? 0 : 1));
  const double cell = std::min(std::max(std::floor(place), 0.0), last - 1.0);
  const auto i = static_cast<size_t>(cell);
  return x[i] + std::min(std::max(place - cell, 0.0), 1.0) * (x[i + 1] - x[i]);
}

bool vtkStratusImageView::SetInput(vtkDataSet* image, vtkDataArray* array, int association, std::string& error)
{
  if (!image || image->GetNumberOfPoints() < 1) {
    error = "the input image is empty, it needs at least one point";
    return false;
  }
  if (!array) {
    error = "there is no such scalar array: " + vtkStratusArrayNames(image);
    return false;
  }
  return this->Set(image, array, association == vtkDataObject::FIELD_ASSOCIATION_CELLS, nullptr, error);
}

bool vtkStratusImageView::SetValues(
  vtkDataSet* image, vtkDataArray* array, bool cells, int mostComponents, int component, std::string& error)
{
  stratus_volume& volume = this->Volume;
  if (!vtkStratusCoreType(array->GetDataType(), volume.type)) {
    error = "array " + ArrayName(array) + " is of type " + array->GetDataTypeAsString() +
      ", which is not supported: use char to unsigned long long, float or double";
    return false;
  }
  const int components = array->GetNumberOfComponents();
  if (component >= components) {
    error = "array " + ArrayName(array) + " has " + std::to_string(components) + " components, VectorComponent is " +
      std::to_string(component) + ", must be 0 to " + std::to_string(components - 1);
    return false;
  }
  if (components < 1 || (component < 0 && components > mostComponents)) {
    error = "array " + ArrayName(array) + " has " + std::to_string(components) + " components, only arrays of 1 " +
      (mostComponents > 1 ? "to " + std::to_string(mostComponents) + " components" : "component") + " are supported";
    return false;
  }
  volume.components = component < 0 ? components : 1;
  volume.value_stride = components;
  const vtkIdType expected = cells ? image->GetNumberOfCells() : image->GetNumberOfPoints();
  if (array->GetNumberOfTuples() < expected) {
    error = "array " + ArrayName(array) + " has " + std::to_string(array->GetNumberOfTuples()) + " values, the image has " +
      std::to_string(expected) + (cells ? " cells" : " points");
    return false;
  }
  vtkDataArray* plain = array;
  if (!array->HasStandardMemoryLayout()) {
    const vtkMTimeType time = std::max(array->GetMTime(), image->GetMTime());
    if (this->Source != array || !this->Plain || this->PlainTime != time) {
      this->Plain = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(array->GetDataType()));
      this->Plain->DeepCopy(array);
      this->PlainTime = time;
    }
    plain = this->Plain;
  } else {
    this->Plain = nullptr;
  }
  this->Source = array;
  volume.values = plain->GetVoidPointer(std::max(component, 0)); // values, not tuples, are counted
  // The image's own time counts too: programs that write through a pointer often call Modified() on the image only.
  volume.revision = Mix(Mix(0, array->GetMTime()), image->GetMTime());
  vtkStratusSetSource(plain, std::max(component, 0), volume);
  this->Reads = vtkStratusReadsOf(plain);
  return true;
}

void vtkStratusImageView::SetGeometry(vtkImageData* image)
{
  stratus_volume& volume = this->Volume;
  int extent[6];
  double origin[3];
  image->GetExtent(extent);
  image->GetOrigin(origin);
  image->GetSpacing(volume.spacing);
  const double* direction = image->GetDirectionMatrix()->GetData();
  std::copy(direction, direction + 9, volume.direction);
  for (int a = 0; a < 3; ++a) {
    volume.origin[a] = origin[a];
    for (int b = 0; b < 3; ++b) {
      // A start of 0 must not multiply a spacing that is not finite: the core would report the origin, though the spacing is at fault.
      volume.origin[a] += extent[2 * b] == 0 ? 0.0 : direction[3 * a + b] * volume.spacing[b] * extent[2 * b];
    }
  }
  for (int a = 0; a < 3; ++a) {
    this->CropOffset[a] = volume.origin[a] - (origin[a] + volume.spacing[a] * extent[2 * a]);
  }
}

bool vtkStratusImageView::SetGhosts(vtkDataSet* image, bool cells, std::string& error)
{
  vtkUnsignedCharArray* pointGhosts = nullptr;
  vtkUnsignedCharArray* cellGhosts = nullptr;
  if (!vtkStratusFindGhosts(image->GetPointData(), image->GetNumberOfPoints(), "points of the image", pointGhosts, error) ||
    !vtkStratusFindGhosts(image->GetCellData(), image->GetNumberOfCells(), "cells of the image", cellGhosts, error)) {
    return false;
  }
  stratus_volume& volume = this->Volume;
  if (pointGhosts && !cells) {
    volume.point_ghosts = pointGhosts->GetPointer(0);
    volume.revision = Mix(volume.revision, pointGhosts->GetMTime());
  }
  if (cellGhosts) { // flat images keep their cell flags, because the core counts their cells as VTK does
    volume.cell_ghosts = cellGhosts->GetPointer(0);
    volume.revision = Mix(volume.revision, cellGhosts->GetMTime());
  }
  if (pointGhosts && cells) {
    volume.revision = Mix(volume.revision, pointGhosts->GetMTime());
    this->HideCellsAtPoints(image, pointGhosts, cellGhosts);
    volume.cell_ghosts = this->CellGhosts.data();
  }
  return true;
}

// Where values are of cells, the core looks at no points: cells that touch a hidden point are marked here, as vtkUniformGrid hides them.
void vtkStratusImageView::HideCellsAtPoints(vtkDataSet* image, vtkUnsignedCharArray* points, vtkUnsignedCharArray* cells)
{
  const uint64_t revision = Mix(Mix(Mix(1, points->GetMTime()), cells ? cells->GetMTime() : 0), image->GetMTime());
  if (revision == this->CellGhostsRevision) {
    return;
  }
  this->CellGhostsRevision = revision;
  const int64_t* const count = this->Volume.dimensions; // of cells
  this->CellGhosts.assign(static_cast<size_t>(image->GetNumberOfCells()), 0);
  if (cells) {
    std::copy(cells->GetPointer(0), cells->GetPointer(0) + cells->GetNumberOfTuples(), this->CellGhosts.begin());
  }
  int places[3] = { 1, 1, 1 }; // points along an axis; one layer of points bears one layer of cells
  if (vtkImageData* regular = vtkImageData::SafeDownCast(image)) {
    regular->GetDimensions(places);
  } else if (vtkRectilinearGrid* grid = vtkRectilinearGrid::SafeDownCast(image)) {
    grid->GetDimensions(places);
  }
  vtkIdType point = 0;
  for (int64_t k = 0; k < places[2]; ++k) {
    for (int64_t j = 0; j < places[1]; ++j) {
      for (int64_t i = 0; i < places[0]; ++i, ++point) {
        if (!(points->GetValue(point) & STRATUS_GHOST_HIDDEN_POINT)) {
          continue;
        }
        for (int64_t z = std::max<int64_t>(k - 1, 0); z <= std::min(k, count[2] - 1); ++z) {
          for (int64_t y = std::max<int64_t>(j - 1, 0); y <= std::min(j, count[1] - 1); ++y) {
            for (int64_t x = std::max<int64_t>(i - 1, 0); x <= std::min(i, count[0] - 1); ++x) {
              this->CellGhosts[static_cast<size_t>((z * count[1] + y) * count[0] + x)] |= STRATUS_GHOST_HIDDEN_CELL;
            }
          }
        }
      }
    }
  }
}
