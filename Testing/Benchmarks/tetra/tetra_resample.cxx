// SPDX-License-Identifier: BSD-3-Clause
// The way around a mesh: its values resampled to an image, which a mapper of images draws.
#include "tetra_bench.h"

#include "vtkStratusVolumeMapper.h"

#include <vtkDataArray.h>
#include <vtkFixedPointVolumeRayCastMapper.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkResampleToImage.h>

#include <algorithm>
#include <cmath>

namespace bench {

double value_outside(const tetra_mesh& mesh)
{
  const auto range = std::minmax_element(mesh.values.begin(), mesh.values.end());
  const double low = static_cast<double>(*range.first), high = static_cast<double>(*range.second);
  return low - std::max(1e-3 * (high - low), 1e-30);
}

vtkSmartPointer<vtkImageData> resample_mesh(const tetra_mesh& mesh, int along, double* ms)
{
  const double start = now_ms();
  vtkNew<vtkResampleToImage> filter;
  filter->SetInputDataObject(mesh.grid);
  filter->SetSamplingDimensions(along, along, along);
  filter->Update();
  *ms = now_ms() - start;
  vtkImageData* all = filter->GetOutput();
  vtkDataArray* values = all->GetPointData()->GetArray(mesh.grid->GetPointData()->GetScalars()->GetName());
  vtkDataArray* valid = all->GetPointData()->GetArray(filter->GetMaskArrayName());
  if (!values || !valid) {
    throw failure("vtkResampleToImage gives no values");
  }
  auto image = vtkSmartPointer<vtkImageData>::New();
  vtkNew<vtkFloatArray> floats;
  image->CopyStructure(all);
  floats->SetNumberOfTuples(values->GetNumberOfTuples());
  const double outside = value_outside(mesh);
  for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i) { // FixedPoint knows no blanked points: they get a value that is transparent
    floats->SetValue(i, static_cast<float>(valid->GetComponent(i, 0) != 0.0 ? values->GetComponent(i, 0) : outside));
  }
  image->GetPointData()->SetScalars(floats);
  return image;
}

transfer transfer_of_image(const tetra_mesh& mesh, const transfer& t)
{
  const double outside = value_outside(mesh), low = static_cast<double>(*std::min_element(mesh.values.begin(), mesh.values.end()));
  const double edge = 0.5 * (outside + low);
  transfer same = t;
  same.opacity = { outside, 0.0, edge, 0.0, edge, t.opacity[1] }; // functions clamp: the first opacity holds below their first point
  if (t.opacity[0] <= edge) {
    throw failure("the function of " + mesh.name + " begins below its values");
  }
  same.opacity.insert(same.opacity.end(), t.opacity.begin(), t.opacity.end());
  return same;
}

vtkSmartPointer<vtkAbstractVolumeMapper> make_resampled(const tetra_mesh& mesh, bool ours, int along, double* ms)
{
  const vtkSmartPointer<vtkImageData> image = resample_mesh(mesh, along, ms);
  if (ours) {
    auto mapper = vtkSmartPointer<vtkStratusVolumeMapper>::New();
    mapper->SetDevice("host");
    mapper->SetInputData(image);
    return mapper;
  }
  auto mapper = vtkSmartPointer<vtkFixedPointVolumeRayCastMapper>::New();
  const double* spacing = image->GetSpacing();
  mapper->AutoAdjustSampleDistancesOff();
  mapper->SetImageSampleDistance(1.0f);
  mapper->SetSampleDistance(static_cast<float>(0.5 * std::min({ spacing[0], spacing[1], spacing[2] })));
  mapper->SetInputData(image);
  return mapper;
}
} // namespace bench
