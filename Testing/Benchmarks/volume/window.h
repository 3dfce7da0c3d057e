// SPDX-License-Identifier: BSD-3-Clause
// A window with one volume. Frames are timed from Render() to WaitForCompletion().
#pragma once

#include "bench.h"

#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkVolume.h>
#include <vtkVolumeMapper.h>
#include <vtkVolumeProperty.h>

namespace bench {

class window
{
public:
  window(stratus_context* context, const scene& s, vtkVolumeMapper* mapper, int size);

  void show(int view);               // moves the camera, draws nothing
  void use(const transfer& t);       // changes the transfer function, draws nothing
  double render();                   // ms of a whole frame
  double first();                    // ms of the first frame with the volume in it
  std::vector<uint8_t> read() const; // RGBA

private:
  void set(int component, const transfer& t);

  stratus_context* Context;
  const scene& Scene;
  int Size;
  vtkNew<vtkRenderWindow> Window;
  vtkNew<vtkRenderer> Renderer;
  vtkNew<vtkVolume> Volume;
  vtkNew<vtkVolumeProperty> Property;
};
} // namespace bench
