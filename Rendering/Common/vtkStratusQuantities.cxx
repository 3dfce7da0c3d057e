// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusQuantities.h"

#include "vtkStratusPicture.h"

#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"

#include <algorithm>
#include <limits>

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

bool vtkStratusQuantities::Compute(stratus_context* context, const stratus_ray_cast_input* inputs, int count, bool blocks,
  const stratus_camera& camera, const stratus_image& rays, std::string& error)
{
  stratus_quantities wanted = stratus_quantities_default();
  bool any = false;
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

void vtkStratusQuantities::AddTo(vtkImageData* image, const vtkStratusPicture& picture) const
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
    picture.Spread(this->Values[q].data(), 1, array->GetPointer(0));
    image->GetPointData()->AddArray(array);
  }
}
