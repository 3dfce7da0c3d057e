// SPDX-License-Identifier: BSD-3-Clause
#include "window.h"

#include "vtkStratusVolumeMapper.h"

#include <vtkActor.h>
#include <vtkAxesActor.h>
#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkLight.h>
#include <vtkOutlineSource.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPolyDataMapper.h>
#include <vtkTransform.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>

namespace bench {

window::window(stratus_context* context, const scene& s, vtkVolumeMapper* mapper, int size, const dress& d)
    : Context(context), Scene(s), Size(size)
{
  this->Window->SetOffScreenRendering(1);
  this->Window->SetMultiSamples(d.samples ? 8 : 0);
  this->Window->SetAlphaBitPlanes(1);
  this->Window->SetSize(size, size);
  this->Window->AddRenderer(this->Renderer);
  this->Renderer->SetBackground(0, 0, 0);
  this->Renderer->SetBackgroundAlpha(0.0);
  this->Property->SetInterpolationTypeToLinear();
  for (int c = 0; c < s.volume.components; ++c) {
    this->Property->SetShade(c, s.shaded);
    this->Property->SetAmbient(c, 0.1);
    this->Property->SetDiffuse(c, 0.7);
    this->Property->SetSpecular(c, 0.2);
    this->Property->SetSpecularPower(c, 10.0);
  }
  // vtkFixedPointVolumeRayCastMapper takes ambient light from the light, whose default is black.
  vtkNew<vtkLight> light;
  light->SetLightTypeToHeadlight();
  light->SetAmbientColor(1, 1, 1);
  this->Renderer->AddLight(light);
  this->Volume->SetProperty(this->Property);
  this->Volume->SetMapper(mapper);
  const bool ours = vtkStratusVolumeMapper::SafeDownCast(mapper) != nullptr;
  mapper->SetInputDataObject(0, ours && s.grid ? static_cast<vtkDataObject*>(s.grid) : s.image);
  this->use(s.first);
  this->put_on(d);
}

void window::put_on(const dress& d)
{
  const double* b = this->Scene.bounds;
  if (d.gradient) {
    this->Renderer->GradientBackgroundOn();
    this->Renderer->SetBackground(.1, .1, .2);
    this->Renderer->SetBackground2(.4, .5, .7);
  }
  if (d.axes) {
    const double length = .25 * std::max({ b[1] - b[0], b[3] - b[2], b[5] - b[4] });
    vtkNew<vtkAxesActor> axes;
    vtkNew<vtkTransform> corner;
    corner->Translate(b[0], b[2], b[4]);
    axes->SetUserTransform(corner);
    axes->SetTotalLength(length, length, length);
    this->Renderer->AddActor(axes);
  }
  if (d.outline) {
    vtkNew<vtkOutlineSource> outline;
    vtkNew<vtkPolyDataMapper> lines;
    vtkNew<vtkActor> actor;
    outline->SetBounds(b);
    lines->SetInputConnection(outline->GetOutputPort());
    actor->SetMapper(lines);
    this->Renderer->AddActor(actor);
  }
}

void window::use(const transfer& t)
{
  this->set(0, t);
  for (size_t c = 0; c < this->Scene.others.size(); ++c) {
    this->set(static_cast<int>(c) + 1, this->Scene.others[c]);
  }
}

void window::set(int component, const transfer& t)
{
  vtkNew<vtkPiecewiseFunction> opacity;
  vtkNew<vtkColorTransferFunction> color;
  opacity->AllowDuplicateScalarsOn(); // two points of the same value make a vertical step
  color->AllowDuplicateScalarsOn();
  for (size_t i = 0; i < t.opacity.size(); i += 2) {
    opacity->AddPoint(t.opacity[i], t.opacity[i + 1]);
  }
  for (size_t i = 0; i < t.color.size(); i += 4) {
    color->AddRGBPoint(t.color[i], t.color[i + 1], t.color[i + 2], t.color[i + 3]);
  }
  this->Property->SetScalarOpacity(component, opacity);
  this->Property->SetColor(component, color);
  this->Property->SetScalarOpacityUnitDistance(component, t.unit_distance);
}

void window::show(int view)
{
  const stratus_camera at = camera_of(this->Context, this->Scene, view);
  vtkCamera* camera = this->Renderer->GetActiveCamera();
  const double* b = this->Scene.bounds;
  const int up = this->Scene.up_axis;
  camera->SetPosition(at.eye[0], at.eye[1], at.eye[2]);
  camera->SetFocalPoint(0.5 * (b[0] + b[1]), 0.5 * (b[2] + b[3]), 0.5 * (b[4] + b[5]));
  camera->SetViewUp(up == 0, up == 1, up == 2);
  camera->SetViewAngle(21.6);
  this->Renderer->ResetCameraClippingRange();
}

double window::render()
{
  const double start = now_ms();
  this->Window->Render();
  this->Window->WaitForCompletion();
  return now_ms() - start;
}

double window::first()
{
  this->Renderer->RemoveViewProp(this->Volume);
  this->show(0);
  this->render(); // the window's set-up does not count as the method's
  this->Renderer->AddVolume(this->Volume);
  this->show(0);
  return this->render();
}

std::vector<uint8_t> window::read() const
{
  vtkNew<vtkUnsignedCharArray> pixels;
  this->Window->GetRGBACharPixelData(0, 0, this->Size - 1, this->Size - 1, 0, pixels);
  return std::vector<uint8_t>(pixels->GetPointer(0), pixels->GetPointer(0) + pixels->GetNumberOfValues());
}
} // namespace bench
