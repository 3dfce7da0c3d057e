// SPDX-License-Identifier: BSD-3-Clause
// Where on the window a volume is drawn, the rays that go there, and what is handed over ray by ray. Private to the modules.
#ifndef vtkStratusPicture_h
#define vtkStratusPicture_h

#include "stratus.h"

#include "vtkStratusInput.h"

#include "vtkSmartPointer.h"

#include <cstdint>
#include <functional>
#include <vector>

class vtkImageData;
class vtkProp;
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

  // What else the renderer draws: something that may have written depth before, or anything beside the prop. endsNoRay: of another prop,
  // that it writes no depth.
  struct Others {
    bool Geometry = false;
    bool Any = false;
  };
  static Others FindOthers(vtkRenderer* renderer, vtkProp* prop, const std::function<bool(vtkProp*)>& endsNoRay);
  // The opaque depth at each ray, until the next call. Not to be asked for where nothing can have been drawn before: it costs as much as a
  // simple scene.
  const float* ReadOpaqueDepth(vtkRenderer* renderer);
  // The window's depths, 0..1, of distances along the rays; 1 where nothing is.
  void ToWindowDepth(const std::vector<float>& distances, std::vector<float>& depth) const;
  // What the rays brought back, over the whole viewport: RGBA, Depth (infinite where nothing was drawn) and, unless nullptr, Samples.
  vtkSmartPointer<vtkImageData> MakeImage(
    const std::vector<float>& rgba, const std::vector<float>& depth, const std::vector<uint32_t>* samples) const;

private:
  void SetRectangle(const double worldToClip[16], const stratus_volume& volume, const double* crop, double margin);

  std::vector<float> WindowDepth, OpaqueDepth;
};

#endif
