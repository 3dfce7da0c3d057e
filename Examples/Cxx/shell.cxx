// SPDX-License-Identifier: BSD-3-Clause
// A surface, filled by TetGen, a field on the tetrahedra, and its picture: shell [OUT.png]. Without a file name it opens a window to turn
// it in.
#include <vtkStratusTetGenFilter.h>
#include <vtkStratusTetrahedraMapper.h>

#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkDoubleArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkSphereSource.h>
#include <vtkUnstructuredGrid.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>
#include <vtkWindowToImageFilter.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

static void AddSphere(vtkPolyData* surface, double radius)
{
  vtkNew<vtkSphereSource> sphere;
  sphere->SetRadius(radius);
  sphere->SetThetaResolution(32);
  sphere->SetPhiResolution(24);
  sphere->Update();
  const vtkIdType first = surface->GetNumberOfPoints();
  vtkPolyData* source = sphere->GetOutput();
  surface->GetPoints()->InsertPoints(first, source->GetNumberOfPoints(), 0, source->GetPoints());
  vtkNew<vtkIdList> corners;
  for (vtkIdType face = 0; face < source->GetNumberOfPolys(); ++face) {
    source->GetPolys()->GetCellAtId(face, corners);
    for (vtkIdType& corner : *corners) {
      corner += first;
    }
    surface->GetPolys()->InsertNextCell(corners);
  }
}

int main(int argc, char** argv)
{
  vtkNew<vtkPolyData> surface; // two spheres, one in the other
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> faces;
  surface->SetPoints(points);
  surface->SetPolys(faces);
  AddSphere(surface, 1.0);
  AddSphere(surface, 0.5);

  vtkNew<vtkStratusTetGenFilter> tetgen;
  tetgen->SetInputData(surface);
  tetgen->AddHole(0.0, 0.0, 0.0);
  tetgen->SetMaximumVolume(2e-4);
  tetgen->Update();
  vtkUnstructuredGrid* mesh = tetgen->GetOutput();
  if (mesh->GetNumberOfCells() == 0) {
    return EXIT_FAILURE;
  }

  vtkNew<vtkDoubleArray> field;
  field->SetName("waves");
  for (vtkIdType point = 0; point < mesh->GetNumberOfPoints(); ++point) {
    double x[3];
    mesh->GetPoint(point, x);
    double sum = 0.0;
    for (int a = 0; a < 3; ++a) {
      sum += std::sin(5.0 * x[a]) * std::cos(5.0 * x[(a + 1) % 3]);
    }
    field->InsertNextValue(sum);
  }
  mesh->GetPointData()->SetScalars(field);

  vtkNew<vtkStratusTetrahedraMapper> mapper;
  mapper->SetInputData(mesh);
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(0.3, 0.0);
  opacity->AddPoint(1.0, 0.6);
  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(0.3, 0.1, 0.4, 0.9);
  color->AddRGBPoint(1.0, 1.0, 0.6, 0.2);
  vtkNew<vtkVolume> volume;
  volume->SetMapper(mapper);
  volume->GetProperty()->SetScalarOpacity(opacity);
  volume->GetProperty()->SetScalarOpacityUnitDistance(0.1);
  volume->GetProperty()->SetColor(color);
  volume->GetProperty()->SetInterpolationTypeToLinear();

  vtkNew<vtkRenderer> renderer;
  renderer->AddVolume(volume);
  vtkNew<vtkRenderWindow> window;
  window->SetSize(480, 480);
  window->AddRenderer(renderer);
  renderer->GetActiveCamera()->SetPosition(2.0, 1.5, 3.0);
  renderer->ResetCamera();
  renderer->GetActiveCamera()->Zoom(1.5);
  if (argc < 2) {
    vtkNew<vtkRenderWindowInteractor> interactor;
    interactor->SetRenderWindow(window);
    window->Render();
    interactor->Start();
    return EXIT_SUCCESS;
  }
  window->Render();
  std::printf("%lld tetrahedra\n", static_cast<long long>(mesh->GetNumberOfCells()));
  vtkNew<vtkWindowToImageFilter> picture;
  picture->SetInput(window);
  picture->ReadFrontBufferOff();
  vtkNew<vtkPNGWriter> writer;
  writer->SetFileName(argv[1]);
  writer->SetInputConnection(picture->GetOutputPort());
  writer->Write();
  return writer->GetErrorCode() == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
