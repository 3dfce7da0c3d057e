// SPDX-License-Identifier: BSD-3-Clause
// The frame buffer that a picture goes to. A render pass (vtkSSAAPass, vtkGaussianBlurPass, vtkEDLShading, ...) draws the scene into one of
// its own, whose size, origin and depth are not the window's. Private to the modules.
#ifndef vtkStratusTarget_h
#define vtkStratusTarget_h

#include "vtkStratusPrivate.h"

class vtkRenderer;

struct VTK_STRATUS_PRIVATE vtkStratusTarget {
  int Viewport[4] = { 0, 0, 0, 0 }; // of the renderer in the frame buffer: x, y, width, height
  unsigned int Buffer = 0;          // OpenGL's name of the pass's frame buffer; 0: the window's

  // Finds the frame buffer that is bound. Where a renderer peels, this is the one that has the scene's opaque geometry.
  void Find(vtkRenderer* renderer);
  // Reads window depths, 0..1, of a rectangle of the frame buffer. Where it has no depth, they are 1.
  void ReadDepth(vtkRenderer* renderer, int x, int y, int width, int height, float* depths) const;
};

#endif
