// SPDX-License-Identifier: BSD-3-Clause
// Helpers of the culler's tests: a window of actors that is drawn with and without cullers, and a comparison of the two pictures.
#ifndef culler_testing_h
#define culler_testing_h

#include "vtkStratusOctreeCuller.h"

#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkConeSource.h"
#include "vtkCubeSource.h"
#include "vtkCullerCollection.h"
#include "vtkNew.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkRendererCollection.h"
#include "vtkSmartPointer.h"
#include "vtkSphereSource.h"
#include "vtkUnsignedCharArray.h"

#include <cmath>
#include <cstdio>
#include <vector>

static int Failures = 0;

// Prints and counts a condition that does not hold, and goes on.
#define CHECK(condition, ...)                                                                                                              \
  do {                                                                                                                                     \
    if (!(condition)) {                                                                                                                    \
      ++Failures;                                                                                                                          \
      std::printf("%s:%d: %s does not hold: ", __FILE__, __LINE__, #condition);                                                            \
      std::printf(__VA_ARGS__);                                                                                                            \
      std::printf("\n");                                                                                                                   \
    }                                                                                                                                      \
  } while (0)

using Pixels = std::vector<unsigned char>;

// A sphere with a source and a mapper of its own.
struct Part {
  explicit Part(double x = 0.0, double y = 0.0, double z = 0.0, double radius = 0.3)
  {
    this->Source->SetRadius(radius);
    this->Mapper->SetInputConnection(this->Source->GetOutputPort());
    this->Actor->SetMapper(this->Mapper);
    this->Actor->SetPosition(x, y, z);
  }
  vtkNew<vtkSphereSource> Source;
  vtkNew<vtkPolyDataMapper> Mapper;
  vtkNew<vtkActor> Actor;
};

class CulledWindow
{
public:
  CulledWindow()
  {
    this->Window->SetOffScreenRendering(1);
    this->Window->SetMultiSamples(0);
    this->Window->SetSize(160, 120);
    this->Window->AddRenderer(this->Renderer);
    this->Culler = vtkStratusOctreeCuller::Install(this->Renderer);
    this->Culler->SetLeafProps(4); // so that few props split the octree
  }

  // Looks from (0, 0, 10) at the origin. The view is about 5 wide and 4 high at z = 0.
  void LookAhead()
  {
    vtkCamera* camera = this->Renderer->GetActiveCamera();
    camera->SetPosition(0, 0, 10);
    camera->SetFocalPoint(0, 0, 0);
    camera->SetViewUp(0, 1, 0);
    camera->SetViewAngle(20);
    camera->SetClippingRange(1, 100);
  }

  // Adds n^3 spheres, cubes and cones, 2 apart, the first at the origin. They share sources, but not mappers.
  void AddLattice(int n)
  {
    vtkNew<vtkSphereSource> sphere;
    vtkNew<vtkCubeSource> cube;
    vtkNew<vtkConeSource> cone;
    vtkPolyDataAlgorithm* sources[3] = { sphere, cube, cone };
    for (int i = 0; i < n * n * n; ++i) {
      vtkNew<vtkPolyDataMapper> mapper;
      vtkNew<vtkActor> actor;
      mapper->SetInputConnection(sources[i % 3]->GetOutputPort());
      actor->SetMapper(mapper);
      actor->SetPosition(2 * (i % n), 2 * (i / n % n), 2 * (i / n / n));
      actor->SetScale(0.3 + 0.1 * (i * 7 % 11), 0.3 + 0.1 * (i * 5 % 13), 0.8);
      actor->RotateWXYZ(37.0 * i, 1, i % 4, 2);
      actor->GetProperty()->SetColor(0.2 + 0.2 * (i % 5), 0.2 + 0.2 * (i % 4), 0.2 + 0.4 * (i % 3));
      this->Renderer->AddActor(actor);
    }
  }

  Pixels Draw()
  {
    this->Window->Render();
    vtkNew<vtkUnsignedCharArray> pixels;
    const int* size = this->Window->GetSize();
    this->Window->GetRGBACharPixelData(0, 0, size[0] - 1, size[1] - 1, 0, pixels);
    return Pixels(pixels->GetPointer(0), pixels->GetPointer(0) + pixels->GetNumberOfValues());
  }

  // Checks that the pictures with cullers and without any are equal, and returns the picture. The cullers come first, so that no other
  // drawing brings data up to date for them.
  Pixels Compare(const char* what)
  {
    const Pixels culled = this->Draw();
    const vtkIdType seen = this->Culler->GetNumberOfVisibleProps(), all = this->Culler->GetNumberOfProps();
    std::vector<std::vector<vtkSmartPointer<vtkCuller>>> cullers;
    vtkRendererCollection* renderers = this->Window->GetRenderers();
    vtkCollectionSimpleIterator cookie;
    renderers->InitTraversal(cookie);
    while (vtkRenderer* renderer = renderers->GetNextRenderer(cookie)) {
      cullers.emplace_back();
      while (vtkCuller* culler = renderer->GetCullers()->GetLastItem()) {
        cullers.back().emplace_back(culler);
        renderer->RemoveCuller(culler);
      }
    }
    const Pixels whole = this->Draw();
    size_t number = 0;
    renderers->InitTraversal(cookie);
    while (vtkRenderer* renderer = renderers->GetNextRenderer(cookie)) {
      for (const auto& culler : cullers[number]) {
        renderer->AddCuller(culler);
      }
      ++number;
    }
    CHECK(culled == whole, "%s: another picture than without a culler, %lld of %lld props drawn", what, static_cast<long long>(seen),
      static_cast<long long>(all));
    return culled;
  }

  vtkIdType Seen() { return this->Culler->GetNumberOfVisibleProps(); }

  vtkNew<vtkRenderWindow> Window;
  vtkNew<vtkRenderer> Renderer;
  vtkStratusOctreeCuller* Culler;
};

inline bool Empty(const Pixels& pixels)
{
  for (size_t i = 0; i < pixels.size(); ++i) {
    if (i % 4 != 3 && pixels[i] != pixels[i % 4]) {
      return false;
    }
  }
  return true;
}

#endif
