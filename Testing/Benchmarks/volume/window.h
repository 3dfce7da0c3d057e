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

// The contents of a window, in addition to the volume. A bare window is black, without multisampling or another prop.
struct dress {
  bool gradient = false; // background
  bool samples = false;  // 8 a pixel, VTK's default
  bool axes = false;     // at the volume's corner, a quarter of its longest edge
  bool outline = false;  // of the volume's bounds
};

class window
{
public:
  window(stratus_context* context, const scene& s, vtkVolumeMapper* mapper, int size, const dress& d = dress());

  void show(int view);               // moves the camera, draws nothing
  void use(const transfer& t);       // changes the transfer function, draws nothing
  double render();                   // ms of a whole frame
  double first();                    // ms of the first frame with the volume in it
  std::vector<uint8_t> read() const; // RGBA

private:
  void set(int component, const transfer& t);
  void put_on(const dress& d);

  stratus_context* Context;
  const scene& Scene;
  int Size;
  vtkNew<vtkRenderWindow> Window;
  vtkNew<vtkRenderer> Renderer;
  vtkNew<vtkVolume> Volume;
  vtkNew<vtkVolumeProperty> Property;
};
} // namespace bench
