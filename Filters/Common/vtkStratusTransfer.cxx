// SPDX-License-Identifier: BSD-3-Clause
// Converts vtkVolumeProperty's functions to the core's. Beyond the ends of a function that does not clamp VTK says 0: its points end with
// steps to 0, so that the core's functions always clamp.
#include "vtkStratusInput.h"

#include "vtkColorTransferFunction.h"
#include "vtkPiecewiseFunction.h"
#include "vtkVolumeProperty.h"

#include <algorithm>

void vtkStratusTransferView::PointToOpacity()
{
  this->Transfer.opacity = this->Opacity.GetPoints();
  this->Transfer.opacity_count = this->Opacity.GetCount();
}

void vtkStratusTransferView::PointToColor()
{
  this->Transfer.color = this->Color.GetPoints();
  this->Transfer.color_count = this->Color.GetCount();
}

// Returns whether there is a gradient opacity other than 1 everywhere.
bool vtkStratusTransferView::SetGradient(vtkVolumeProperty* property, int index)
{
  if (property->GetDisableGradientOpacity(index) || !property->HasGradientOpacity(index) ||
    !this->Gradient.Set(property->GetGradientOpacity(index), 1)) {
    return false;
  }
  for (size_t n = 0; n < this->Gradient.GetCount(); ++n) {
    if (this->Gradient.GetPoints()[2 * n + 1] != 1.0) {
      return true;
    }
  }
  return false;
}

bool vtkStratusTransferView::Set(vtkVolumeProperty* property, int index, std::string& error)
{
  this->Transfer = stratus_transfer_default();
  if (!this->Opacity.Set(property->GetScalarOpacity(index), 1)) {
    error = "the scalar opacity function has no points, it needs at least 1";
    return false;
  }
  const bool colored = property->GetColorChannels(index) == 3 ? this->Color.Set(property->GetRGBTransferFunction(index))
                                                              : this->Color.Set(property->GetGrayTransferFunction(index), 3);
  if (!colored) {
    error = "the colour transfer function has no points, it needs at least 1";
    return false;
  }
  this->PointToOpacity();
  this->PointToColor();
  if (this->SetGradient(property, index)) {
    this->Transfer.gradient = this->Gradient.GetPoints();
    this->Transfer.gradient_count = this->Gradient.GetCount();
  }
  this->Transfer.weight = property->GetComponentWeight(index);
  this->Transfer.unit_distance = property->GetScalarOpacityUnitDistance(index);
  return true;
}

int vtkStratusTransferView::FindHighestLabel(vtkVolumeProperty* property)
{
  int highest = 0;
  for (int label : property->GetLabelMapLabels()) {
    highest = label > 0 && label < 256 ? std::max(highest, label) : highest;
  }
  return highest;
}

bool vtkStratusTransferView::SetLabel(vtkVolumeProperty* property, int label, const vtkStratusTransferView& component0, std::string& error)
{
  vtkPiecewiseFunction* opacity = property->GetLabelScalarOpacity(label);
  vtkColorTransferFunction* color = property->GetLabelColor(label);
  this->Transfer = component0.Transfer;
  this->Transfer.gradient = nullptr;
  this->Transfer.gradient_count = 0;
  if (opacity) {
    if (!this->Opacity.Set(opacity, 1)) {
      error = "the scalar opacity function of label " + std::to_string(label) + " has no points, it needs at least 1";
      return false;
    }
    this->PointToOpacity();
  }
  vtkPiecewiseFunction* gradient = property->GetDisableGradientOpacity() ? nullptr : property->GetLabelGradientOpacity(label);
  if (gradient && this->Gradient.Set(gradient, 1)) { // one that is 1 everywhere counts, too: it takes the property's place
    this->Transfer.gradient = this->Gradient.GetPoints();
    this->Transfer.gradient_count = this->Gradient.GetCount();
  }
  if (color) {
    if (!this->Color.Set(color)) {
      error = "the colour transfer function of label " + std::to_string(label) + " has no points, it needs at least 1";
      return false;
    }
    this->PointToColor();
  }
  return true;
}
