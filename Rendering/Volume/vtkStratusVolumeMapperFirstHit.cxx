// SPDX-License-Identifier: BSD-3-Clause
// The light of vtkStratusVolumeMapper's pictures, the bounds of first hits, and the tree that an image may carry.
#include "vtkStratusVolumeMapperInternals.h"

#include "vtkStratusLights.h"
#include "vtkStratusTreeArrays.h"

#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"
#include "vtkRectilinearGrid.h"
#include "vtkRenderer.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>

// Sets materials for independent components if they differ. Returns whether any of them is lit.
bool vtkStratusVolumeMapper::Internals::SetMaterials(vtkVolumeProperty* property, stratus_ray_cast_options& options)
{
  const int components = this->Image.GetVolume().components;
  bool alike = true;
  const bool lit = vtkStratusSetMaterials(property, components, this->Materials.data(), alike);
  const bool several = this->HasLight() && components > 1 && property->GetIndependentComponents();
  options.light.materials = several && !alike ? this->Materials.data() : nullptr;
  return several && lit;
}

bool vtkStratusVolumeMapper::Internals::SetShading(
  vtkRenderer* renderer, vtkVolume* volume, stratus_ray_cast_options& options, std::string& error)
{
  vtkVolumeProperty* property = volume->GetProperty();
  const bool shade = property->GetShade() && this->HasLight();
  if (!this->SetMaterials(property, options) && !this->IsFirstHit() && !this->IsPath() && !shade) {
    return true;
  }
  stratus_shading& shading = options.light.shading;
  shading.on = shade || options.light.materials ? 1 : 0;
  options.light.shade = shade ? 1 : 0;
  vtkStratusSetScattering(this->Mapper, volume, shading);
  shading.surfaces = shading.shadows && !this->IsPath() ? this->Surfaces.Find(renderer) : nullptr;
  return vtkStratusSetShading(renderer, this->Mapper->GetSun(), property, shading, error);
}

// Voxels of values reach halfway beyond the first and the last one. A layer of points has half a voxel on either side.
void vtkStratusVolumeMapper::Internals::WidenBounds(double bounds[6]) const
{
  vtkStratusVolumeMapper* mapper = this->Mapper;
  vtkDataSet* input = vtkStratusAsImage(mapper->GetDataObjectInput());
  if (!input || !(bounds[0] <= bounds[1])) {
    return;
  }
  if (!this->IsFirstHit()) {
    double thickness[3];
    vtkStratusSheet::FindThickness(input, thickness);
    vtkImageData* turned = vtkImageData::SafeDownCast(input);
    for (int a = 0; a < 3; ++a) {
      double half = 0.0;
      for (int b = 0; b < 3; ++b) {
        half += 0.5 * thickness[b] * (turned ? std::fabs(turned->GetDirectionMatrix()->GetData()[3 * a + b]) : a == b ? 1.0 : 0.0);
      }
      bounds[2 * a] -= half;
      bounds[2 * a + 1] += half;
    }
    return;
  }
  int cells = 0;
  if (!vtkAbstractMapper::GetScalars(input, mapper->ScalarMode, mapper->ArrayAccessMode, mapper->ArrayId, mapper->ArrayName, cells) ||
    cells) {
    return;
  }
  if (vtkRectilinearGrid* grid = vtkRectilinearGrid::SafeDownCast(input)) {
    vtkDataArray* const axes[3] = { grid->GetXCoordinates(), grid->GetYCoordinates(), grid->GetZCoordinates() };
    for (int a = 0; a < 3; ++a) {
      const vtkIdType n = axes[a] ? axes[a]->GetNumberOfTuples() : 0;
      if (n > 1) { // the first may be the greatest
        const double first = axes[a]->GetComponent(0, 0), last = axes[a]->GetComponent(n - 1, 0);
        const double begin = first + 0.5 * (first - axes[a]->GetComponent(1, 0));
        const double end = last + 0.5 * (last - axes[a]->GetComponent(n - 2, 0));
        bounds[2 * a] = std::min(bounds[2 * a], std::min(begin, end));
        bounds[2 * a + 1] = std::max(bounds[2 * a + 1], std::max(begin, end));
      }
    }
    return;
  }
  vtkImageData* image = vtkImageData::SafeDownCast(input);
  const double* direction = image->GetDirectionMatrix()->GetData();
  const double* spacing = image->GetSpacing();
  for (int a = 0; a < 3; ++a) {
    double half = 0.0;
    for (int b = 0; b < 3; ++b) {
      half += 0.5 * std::fabs(direction[3 * a + b] * spacing[b]);
    }
    bounds[2 * a] -= half;
    bounds[2 * a + 1] += half;
  }
}

void vtkStratusVolumeMapper::Internals::OfferTree(stratus_ray_caster* caster, stratus_context* context)
{
  vtkStratusVolumeMapper* self = this->Mapper;
  vtkFieldData* fields = self->GetInput()->GetFieldData();
  vtkAbstractArray* offered = fields ? fields->GetAbstractArray(vtkStratusTreeArray) : nullptr;
  vtkUnsignedCharArray* tree = vtkUnsignedCharArray::SafeDownCast(offered);
  const vtkMTimeType time = offered ? offered->GetMTime() : 0;
  if (offered == this->Offered && time == this->OfferedTime && caster == this->OfferedTo) {
    return;
  }
  if (offered && !tree) {
    vtkWarningWithObjectMacro(self, << "the input's tree is not used: array '" << vtkStratusTreeArray << "' is of type "
                                    << offered->GetDataTypeAsString() << ", not unsigned char; one is built");
  }
  this->Offered = offered;
  this->OfferedTime = time;
  this->OfferedTo = caster;
  const size_t size = tree ? static_cast<size_t>(tree->GetNumberOfValues()) : 0;
  const void* bytes = size > 0 ? tree->GetPointer(0) : nullptr;
  if (stratus_ray_caster_offer_tree(caster, bytes, size) != STRATUS_OK) {
    vtkWarningWithObjectMacro(self, << "the input's tree is not used: " << stratus_context_message(context) << "; one is built");
  }
}
