// SPDX-License-Identifier: BSD-3-Clause
// Draws a small box of value 1 through the installed modules; fails if the window stays black or the distance map has no distance.
#include "vtkStratusDistanceMapFilter.h"
#include "vtkStratusVolumeMapper.h"

#include <vtkColorTransferFunction.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPiecewiseFunction.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>

#include <stratus.h>

#include <algorithm>
#include <iostream>

int main()
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(32, 32, 32);
  image->AllocateScalars(VTK_FLOAT, 1);
  for (int k = 0; k < 32; ++k) {
    for (int j = 0; j < 32; ++j) {
      for (int i = 0; i < 32; ++i) {
        const bool inside = std::min({ i, j, k }) >= 12 && std::max({ i, j, k }) < 20;
        image->SetScalarComponentFromDouble(i, j, k, 0, inside ? 1.0 : 0.0);
      }
    }
  }
  vtkNew<vtkVolumeProperty> property;
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(0.0, 0.0);
  opacity->AddPoint(1.0, 0.5);
  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(0.0, 1.0, 1.0, 1.0);
  property->SetScalarOpacity(opacity);
  property->SetColor(color);
  property->SetInterpolationTypeToLinear();

  vtkNew<vtkStratusVolumeMapper> mapper;
  mapper->SetInputData(image);
  vtkNew<vtkVolume> volume;
  volume->SetMapper(mapper);
  volume->SetProperty(property);
  vtkNew<vtkRenderer> renderer;
  renderer->AddVolume(volume);
  vtkNew<vtkRenderWindow> window;
  window->SetMultiSamples(0);
  window->SetSize(64, 64);
  window->AddRenderer(renderer);
  renderer->ResetCamera();
  window->Render();

  vtkNew<vtkUnsignedCharArray> pixels;
  window->GetPixelData(0, 0, 63, 63, 1, pixels);
  const unsigned char brightest = *std::max_element(pixels->GetPointer(0), pixels->GetPointer(0) + pixels->GetNumberOfValues());

  vtkNew<vtkStratusDistanceMapFilter> filter;
  filter->SetInputData(image);
  filter->SetVolumeProperty(property);
  filter->Update();
  double range[2] = { 0.0, 0.0 };
  filter->GetOutput()->GetScalarRange(range);

  std::cout << "brightest pixel " << int(brightest) << ", distances " << range[0] << ".." << range[1] << ", status "
            << stratus_status_name(STRATUS_OK) << "\n";
  return brightest > 60 && range[1] > 0.0 ? 0 : 1;
}
