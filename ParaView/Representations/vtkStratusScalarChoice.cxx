// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusScalarChoice.h"

#include "vtkCellData.h"
#include "vtkColorTransferFunction.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkPointData.h"
#include "vtkSMPTools.h"
#include "vtkSmartPointer.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace {

// A component, or -1 for the magnitude.
vtkSmartPointer<vtkDataArray> make_values(vtkDataArray* from, int component, const std::string& name)
{
  vtkSmartPointer<vtkDataArray> made;
  made.TakeReference(component < 0 ? vtkDataArray::CreateDataArray(VTK_DOUBLE) : from->NewInstance());
  made->SetName(name.c_str());
  made->SetNumberOfTuples(from->GetNumberOfTuples());
  if (component >= 0) {
    made->CopyComponent(0, from, component);
    return made;
  }
  vtkSMPTools::For(0, from->GetNumberOfTuples(), [&](vtkIdType begin, vtkIdType end) {
    std::vector<double> tuple(static_cast<size_t>(from->GetNumberOfComponents()));
    for (vtkIdType i = begin; i < end; ++i) {
      from->GetTuple(i, tuple.data());
      double sum = 0.0;
      for (const double value : tuple) {
        sum += value * value;
      }
      made->SetComponent(i, 0, std::sqrt(sum));
    }
  });
  return made;
}
} // namespace

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
    const int component = one ? std::min(std::max(colors->GetVectorComponent(), 0), array->GetNumberOfComponents() - 1) : -1;
    chosen = std::string(name) + (one ? "_component_" + std::to_string(component) : "_magnitude");
    vtkDataArray* there = arrays->GetArray(chosen.c_str());
    if (!there || there->GetMTime() < array->GetMTime()) {
      arrays->AddArray(make_values(array, component, chosen));
    }
  }
  return chosen;
}
