// SPDX-License-Identifier: BSD-3-Clause
// Where on the window a volume is drawn, and the rays that go there. Private to the module.
#ifndef vtkStratusPicture_h
#define vtkStratusPicture_h

#include "stratus.h"

#include "vtkStratusInput.h"

class vtkRenderer;

struct VTK_STRATUS_PRIVATE vtkStratusPicture {
  int Viewport[4] = { 0, 0, 0, 0 };  // of the renderer: x, y in the window, width, height
  int Rectangle[4] = { 0, 0, 0, 0 }; // what the volume may cover: x, y in the viewport, width, height
  int Size[2] = { 0, 0 };            // pixels to cast; fewer than the rectangle's in a coarse picture
  stratus_camera Camera;

  bool IsEmpty() const { return this->Size[0] < 1 || this->Size[1] < 1; }
  // solid: values on points are cubes about them, half a voxel beyond the volume's bounds.
  // crop: bounds along the grid's axes as stratus_ray_cast_options has them, or nullptr. coarseness: pixels a ray along each axis, >= 1.
  // False where the camera is degenerate.
  bool Set(vtkRenderer* renderer, const stratus_volume& volume, const double* crop, double coarseness, bool solid = false);

private:
  void SetRectangle(const double worldToClip[16], const stratus_volume& volume, const double* crop, double margin);
};

#endif
