// SPDX-License-Identifier: BSD-3-Clause
// A cloud with an opaque ball in it: ball-in-cloud [OUT.png]. Without a file name it opens a window to turn it in.
#include <vtkStratusVolumeMapper.h>

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPerlinNoise.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkSphereSource.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

// Noise of five octaves, denser towards the middle of -1..1 along each axis.
static void MakeCloud(vtkImageData* image, int size)
{
  image->SetDimensions(size, size, size);
  image->SetOrigin(-1, -1, -1);
  image->SetSpacing(2.0 / (size - 1), 2.0 / (size - 1), 2.0 / (size - 1));
  image->AllocateScalars(VTK_FLOAT, 1);
  vtkNew<vtkPerlinNoise> noise;
  float* value = static_cast<float*>(image->GetScalarPointer());
  for (vtkIdType point = 0; point < image->GetNumberOfPoints(); ++point) {
    double x[3];
    image->GetPoint(point, x);
    double density = 0.55 - 0.9 * (x[0] * x[0] + 2.0 * x[1] * x[1] + x[2] * x[2]);
    for (int octave = 0; octave < 5; ++octave) {
      const double frequency = 1.5 * (1 << octave);
      noise->SetFrequency(frequency, frequency, frequency);
      noise->SetAmplitude(0.6 / (1 << octave));
      density += noise->EvaluateFunction(x);
    }
    *value++ = static_cast<float>(std::max(0.0, std::min(1.0, density)));
  }
}

int main(int argc, char** argv)
{
  vtkNew<vtkImageData> cloud;
  MakeCloud(cloud, 128);

  vtkNew<vtkStratusVolumeMapper> mapper; // where vtkSmartVolumeMapper stood
  mapper->SetInputData(cloud);
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(0.0, 0.0);
  opacity->AddPoint(1.0, 0.5);
  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(0.0, 1.0, 1.0, 1.0);
  color->AddRGBPoint(1.0, 0.55, 0.6, 0.7);
  vtkNew<vtkVolume> volume;
  volume->SetMapper(mapper);
  volume->GetProperty()->SetScalarOpacity(opacity);
  volume->GetProperty()->SetScalarOpacityUnitDistance(0.05);
  volume->GetProperty()->SetColor(color);
  volume->GetProperty()->SetInterpolationTypeToLinear();

  vtkNew<vtkSphereSource> sphere;
  sphere->SetCenter(0.1, 0.0, 0.0);
  sphere->SetRadius(0.4);
  sphere->SetThetaResolution(64);
  sphere->SetPhiResolution(64);
  vtkNew<vtkPolyDataMapper> sphereMapper;
  sphereMapper->SetInputConnection(sphere->GetOutputPort());
  vtkNew<vtkActor> ball;
  ball->SetMapper(sphereMapper);
  ball->GetProperty()->SetColor(0.9, 0.35, 0.1);

  vtkNew<vtkRenderer> renderer;
  renderer->AddVolume(volume);
  renderer->AddActor(ball);
  renderer->SetBackground(0.16, 0.3, 0.5);
  vtkNew<vtkRenderWindow> window;
  window->SetSize(640, 480);
  window->AddRenderer(renderer);
  renderer->GetActiveCamera()->SetPosition(1.5, 1.2, 3.5);
  renderer->ResetCamera();
  renderer->GetActiveCamera()->Zoom(1.7);

  if (argc < 2) {
    vtkNew<vtkRenderWindowInteractor> interactor;
    interactor->SetRenderWindow(window);
    window->Render();
    interactor->Start();
    return EXIT_SUCCESS;
  }
  window->Render();
  std::printf(
    "%s on %s, %.1f ms: %s\n", mapper->GetStructureUsedAsString(), mapper->GetDeviceName(), mapper->GetCastTime(), mapper->GetReason());
  vtkNew<vtkWindowToImageFilter> picture;
  picture->SetInput(window);
  picture->ReadFrontBufferOff();
  vtkNew<vtkPNGWriter> writer;
  writer->SetFileName(argv[1]);
  writer->SetInputConnection(picture->GetOutputPort());
  writer->Write();
  return writer->GetErrorCode() == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
