// SPDX-License-Identifier: BSD-3-Clause
// The whole pipeline, each part on a device: a source, the builder of the tree, the mapper that walks it, and reports of who built what.
// pipeline [DEVICE [OUT.png]]. DEVICE is auto (the default), host, an OpenCL device's number or a part of its name. Without a file name it
// opens a window.
#include <vtkStratusHybridTreeFilter.h>
#include <vtkStratusVolumeMapper.h>

#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPiecewiseFunction.h>
#include <vtkRTAnalyticSource.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkTable.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>
#include <vtkWindowToImageFilter.h>

#include <cstdio>
#include <cstdlib>
#include <string>

static void Print(const char* who, const char* device, vtkTable* report)
{
  std::printf("%s, %s\n  %-20s %-40s %8s %12s %8s\n", who, device, "stage", "where", "ms", "bytes", "kernels");
  for (vtkIdType row = 0; row < report->GetNumberOfRows(); ++row) {
    std::printf("  %-20s %-40s %8.2f %12lld %8lld\n", report->GetValueByName(row, "Stage").ToString().c_str(),
      report->GetValueByName(row, "Where").ToString().c_str(), report->GetValueByName(row, "Milliseconds").ToDouble(),
      report->GetValueByName(row, "Bytes").ToLongLong(), report->GetValueByName(row, "Kernels").ToLongLong());
  }
}

int main(int argc, char** argv)
{
  const char* device = argc > 1 ? argv[1] : "auto";
  vtkNew<vtkRTAnalyticSource> source;
  source->SetWholeExtent(-48, 48, -48, 48, -48, 48);
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(180.0, 0.0);
  opacity->AddPoint(270.0, 0.4);
  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(180.0, 0.2, 0.4, 0.8);
  color->AddRGBPoint(270.0, 1.0, 0.8, 0.4);
  vtkNew<vtkVolume> volume;
  volume->GetProperty()->SetScalarOpacity(opacity);
  volume->GetProperty()->SetColor(color);
  volume->GetProperty()->SetInterpolationTypeToLinear();

  vtkNew<vtkStratusHybridTreeFilter> builder;
  builder->SetInputConnection(source->GetOutputPort());
  builder->SetVolumeProperty(volume->GetProperty());
  builder->SetDevice(device);
  vtkNew<vtkStratusVolumeMapper> mapper;
  mapper->SetInputConnection(builder->GetOutputPort());
  mapper->SetDevice(device);
  mapper->SetStructureToHybrid(); // the default takes the tree where that is faster
  volume->SetMapper(mapper);
  if (std::string(builder->GetDevice()) != device) {
    return EXIT_FAILURE; // the error listed the devices
  }

  vtkNew<vtkRenderer> renderer;
  renderer->AddVolume(volume);
  vtkNew<vtkRenderWindow> window;
  window->SetSize(480, 480);
  window->AddRenderer(renderer);
  renderer->GetActiveCamera()->SetPosition(2.0, 1.5, 3.0);
  renderer->ResetCamera();
  window->Render();
  Print("builder", builder->GetDeviceName(), builder->GetBuildReport());
  Print("mapper", mapper->GetDeviceName(), mapper->GetBuildReport());
  std::printf("the mapper walked the builder's tree: %s\n", mapper->GetCarriedTreeUsed() ? "yes" : "no");
  if (argc < 3) {
    vtkNew<vtkRenderWindowInteractor> interactor;
    interactor->SetRenderWindow(window);
    interactor->Start();
    return EXIT_SUCCESS;
  }
  vtkNew<vtkWindowToImageFilter> picture;
  picture->SetInput(window);
  picture->ReadFrontBufferOff();
  vtkNew<vtkPNGWriter> writer;
  writer->SetFileName(argv[2]);
  writer->SetInputConnection(picture->GetOutputPort());
  writer->Write();
  return mapper->GetCarriedTreeUsed() && writer->GetErrorCode() == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
