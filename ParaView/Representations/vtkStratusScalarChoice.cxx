// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusScalarChoice.h"

#include "vtkStratusVectors.h"

#include "vtkCellData.h"
#include "vtkColorTransferFunction.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <vector>

std::string stratus::choose_scalars(vtkDataObject* data, const char* name, bool on_cells, vtkVolumeProperty* property)
{
  vtkColorTransferFunction* colors = property->GetRGBTransferFunction(0);
  const bool one = colors->GetVectorMode() == vtkScalarsToColors::COMPONENT;
  std::vector<vtkDataSet*> grids;
  if (auto* grid = vtkDataSet::SafeDownCast(data)) {
    grids.push_back(grid);
  } else if (auto* blocks = vtkCompositeDataSet::SafeDownCast(data)) {
    grids = vtkCompositeDataSet::GetDataSets(blocks);
  }
  std::string chosen = name;
  for (vtkDataSet* grid : grids) {
    vtkDataSetAttributes* arrays =
      on_cells ? static_cast<vtkDataSetAttributes*>(grid->GetCellData()) : static_cast<vtkDataSetAttributes*>(grid->GetPointData());
    vtkDataArray* array = arrays->GetArray(name);
    if (!array || array->GetNumberOfComponents() < 2 || !property->GetIndependentComponents()) {
      continue;
    }
    const int component =
      one ? std::min(std::max(colors->GetVectorComponent(), 0), array->GetNumberOfComponents() - 1) : vtkStratusVectors::Magnitude;
    chosen = std::string(name) + (one ? "_component_" + std::to_string(component) : "_magnitude");
    vtkDataArray* there = arrays->GetArray(chosen.c_str());
    if (!there || there->GetMTime() < array->GetMTime()) {
      const auto values = vtkStratusVectors::Make(array, component);
      values->SetName(chosen.c_str());
      arrays->AddArray(values);
    }
  }
  return chosen;
}
