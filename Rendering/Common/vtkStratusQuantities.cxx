// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusQuantities.h"

#include "vtkStratusMetres.h"
#include "vtkStratusPicture.h"

#include "vtkAbstractVolumeMapper.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataSet.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkProp3D.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <limits>

namespace {
// The first part of composite data, or the data.
vtkDataSet* FirstOf(vtkDataObject* data)
{
  vtkCompositeDataSet* whole = vtkCompositeDataSet::SafeDownCast(data);
  if (!whole) {
    return vtkDataSet::SafeDownCast(data);
  }
  vtkSmartPointer<vtkCompositeDataIterator> at;
  at.TakeReference(whole->NewIterator());
  at->InitTraversal();
  return at->IsDoneWithTraversal() ? nullptr : vtkDataSet::SafeDownCast(at->GetCurrentDataObject());
}
} // namespace

bool vtkStratusQuantities::Set(const char* names, double threshold, std::string& error)
{
  const std::string all = names ? names : "";
  std::fill(std::begin(this->Wanted), std::end(this->Wanted), false);
  this->Threshold = threshold;
  for (size_t from = all.find_first_not_of(" ,"); from != std::string::npos;) {
    const size_t to = std::min(all.find_first_of(" ,", from), all.size());
    const std::string name = all.substr(from, to - from);
    int quantity = 0;
    std::string known;
    while (quantity < STRATUS_QUANTITY_COUNT && name != stratus_quantity_name(static_cast<stratus_quantity>(quantity))) {
      known += std::string(quantity ? ", " : "") + stratus_quantity_name(static_cast<stratus_quantity>(quantity));
      ++quantity;
    }
    if (quantity == STRATUS_QUANTITY_COUNT) {
      error = "quantity '" + name + "' must be one of " + known;
      return false;
    }
    this->Wanted[quantity] = true;
    from = all.find_first_not_of(" ,", to);
  }
  return true;
}

void vtkStratusQuantities::AddVolume(vtkAbstractVolumeMapper* mapper, vtkProp3D* prop)
{
  vtkDataObject* data = mapper->GetInputDataObject(0, 0);
  vtkDataSet* first = FirstOf(data);
  int cells = 0;
  vtkDataArray* values = first ? vtkAbstractMapper::GetScalars(first, mapper->GetScalarMode(), mapper->GetArrayAccessMode(),
                                   mapper->GetArrayId(), mapper->GetArrayName(), cells)
                               : nullptr;
  double linear[9];
  for (int n = 0; n < 9; ++n) {
    linear[n] = prop->GetMatrix()->GetElement(n / 3, n % 3);
  }
  this->AddData(data, values, linear);
}

void vtkStratusQuantities::AddData(vtkDataObject* data, vtkDataArray* values, const double linear[9])
{
  const char* label = values && values->HasInformation() && values->GetInformation()->Has(vtkDataArray::UNITS_LABEL())
    ? values->GetInformation()->Get(vtkDataArray::UNITS_LABEL())
    : nullptr;
  const std::string units = label ? label : "";
  const double own = vtkStratusMetresPerUnit(data), metres = own > 0.0 ? own : vtkStratusMetresPerUnit(FirstOf(data));
  const bool alike = std::equal(linear, linear + 9, this->Linear) && metres == this->MetresPerUnit;
  if (this->Volumes == 0) {
    std::copy(linear, linear + 9, this->Linear);
    this->MetresPerUnit = metres;
    this->Units = units;
  } else if (!alike) {
    std::fill(this->Linear, this->Linear + 9, 0.0);
    this->Linear[0] = this->Linear[4] = this->Linear[8] = 1.0;
    this->MetresPerUnit = 0.0;
  }
  this->Units = units == this->Units ? units : "";
  ++this->Volumes;
}

bool vtkStratusQuantities::Compute(stratus_context* context, const stratus_ray_cast_input* inputs, int count, bool blocks,
  const stratus_camera& camera, const stratus_image& rays, std::string& error)
{
  stratus_quantities wanted = stratus_quantities_default();
  bool any = false;
  double linear[3][3], inverse[3][3];
  std::copy(this->Linear, this->Linear + 9, linear[0]);
  if (vtkMath::Determinant3x3(linear) != 0.0) { // else drawing refuses the matrix
    vtkMath::Invert3x3(linear, inverse);
    std::transform(inverse[0], inverse[0] + 9, wanted.measure,
      [this](double one) { return this->MetresPerUnit > 0.0 ? one * this->MetresPerUnit : one; });
  }
  wanted.width = rays.width;
  wanted.height = rays.height;
  wanted.opaque_depth = rays.opaque_depth;
  wanted.threshold = this->Threshold;
  wanted.blocks = blocks ? 1 : 0;
  for (int q = 0; q < STRATUS_QUANTITY_COUNT; ++q) {
    this->Values[q].resize(this->Wanted[q] ? static_cast<size_t>(rays.width) * static_cast<size_t>(rays.height) : 0);
    wanted.of[q] = this->Wanted[q] ? this->Values[q].data() : nullptr;
    any = any || this->Wanted[q];
  }
  const stratus_status status = any ? stratus_ray_caster_render_quantities(inputs, count, &camera, &wanted) : STRATUS_OK;
  if (status != STRATUS_OK && status != STRATUS_CANCELLED) {
    error = stratus_context_message(context);
  }
  return status == STRATUS_OK;
}

void vtkStratusQuantities::AddTo(vtkImageData* image, const vtkStratusPicture* picture) const
{
  for (int q = 0; q < STRATUS_QUANTITY_COUNT; ++q) {
    if (!this->Wanted[q]) {
      continue;
    }
    const bool sum = q == STRATUS_QUANTITY_INTEGRAL || q == STRATUS_QUANTITY_LENGTH || q == STRATUS_QUANTITY_CELLS;
    const float nothing = sum ? 0.0f : q == STRATUS_QUANTITY_TRANSMITTANCE ? 1.0f : std::numeric_limits<float>::quiet_NaN();
    vtkNew<vtkFloatArray> array;
    array->SetName(stratus_quantity_name(static_cast<stratus_quantity>(q)));
    array->SetNumberOfTuples(image->GetNumberOfPoints());
    array->Fill(nothing);
    char units[256];
    stratus_quantity_unit(static_cast<stratus_quantity>(q), this->Units.c_str(), this->MetresPerUnit > 0.0 ? 1 : 0, units, sizeof units);
    if (*units) {
      array->GetInformation()->Set(vtkDataArray::UNITS_LABEL(), units);
    }
    if (picture) {
      picture->Spread(this->Values[q].data(), 1, array->GetPointer(0));
    } else {
      std::copy(this->Values[q].begin(), this->Values[q].end(), array->GetPointer(0));
    }
    image->GetPointData()->AddArray(array);
  }
}
