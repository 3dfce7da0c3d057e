// SPDX-License-Identifier: BSD-3-Clause
// Finds a volume's place in the window and the rays that go there, and converts values per ray. Private to the modules.
#ifndef vtkStratusPicture_h
#define vtkStratusPicture_h

#include "stratus.h"

#include "vtkStratusInput.h"
#include "vtkStratusTarget.h"

#include "vtkSmartPointer.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

class vtkAbstractMapper;
class vtkImageData;
class vtkProp;
class vtkRenderer;

struct VTK_STRATUS_PRIVATE vtkStratusPicture {
  vtkStratusTarget Target;           // the frame buffer that the picture goes to
  int Viewport[4] = { 0, 0, 0, 0 };  // of the renderer: x, y in the frame buffer, width, height
  int Rectangle[4] = { 0, 0, 0, 0 }; // part that the volume may cover: x, y in the viewport, width, height
  bool TakesShadows = false;         // of the volume by surfaces: the rectangle that Set() finds is the whole viewport
  int Size[2] = { 0, 0 };            // rays to cast; fewer than the rectangle's pixels in a coarse picture
  stratus_camera Camera;

  bool IsEmpty() const { return this->Size[0] < 1 || this->Size[1] < 1; }
  // `solid`: values on points are cubes, which extend half a voxel beyond the volume's bounds. `crop`: bounds along the grid's axes, as in
  // stratus_ray_cast_options, or nullptr. `coarseness`: pixels between rays along each axis, >= 1. Returns false where the camera is
  // degenerate.
  bool Set(vtkRenderer* renderer, const stratus_volume& volume, const double* crop, double coarseness, bool solid = false);

  // The same for several volumes; each box is one of them.
  struct Box {
    const stratus_volume* Volume;
    const double* Crop;
  };
  bool Set(vtkRenderer* renderer, const std::vector<Box>& boxes, double coarseness, bool solid = false);

  // Other drawn props of the renderer. Geometry: something may have written depth before. Any: another prop is visible.
  struct Others {
    bool Geometry = false;
    bool Any = false;
    int Part[4] = { 0, 0, 0, 0 }; // of the viewport, in which depth may have been written: x0, x1, y0, y1
  };
  // Must follow Set(). endsNoRay() returns whether another prop writes no depth.
  Others FindOthers(vtkRenderer* renderer, vtkProp* prop, const std::function<bool(vtkProp*)>& endsNoRay) const;
  // Returns the opaque depth at each ray, valid until the next call; nullptr where nothing can have been drawn before. Reading it costs as
  // much as a simple scene, so only the part of the others is read.
  const float* ReadOpaqueDepth(vtkRenderer* renderer, const Others& others);
  // Whether rays that end at these window depths, one a ray, make the picture of those that end where ReadOpaqueDepth() said last.
  bool IsWhole(const float* depths) const;
  // Allocates a frame of these rays, and returns it as the core's view. The last two may be nullptr.
  stratus_image MakeRoom(std::vector<float>& rgba, std::vector<float>& depth, const float* opaqueDepth,
    std::vector<uint32_t>* samples = nullptr, std::vector<unsigned char>* bytes = nullptr) const;
  // Converts distances along the rays to window depths, 0..1; 1 where nothing is.
  void ToWindowDepth(const std::vector<float>& distances, std::vector<float>& depth) const;
  // Finds where in the world a ray, by its number among the rays, has come after a distance, and where it goes.
  void FindPlace(size_t ray, float distance, double place[3], double direction[3]) const;
  // Makes an image of the whole viewport from values per ray: RGBA, Depth (infinite where nothing was drawn) and, unless nullptr, Samples.
  vtkSmartPointer<vtkImageData> MakeImage(
    const std::vector<float>& rgba, const std::vector<float>& depth, const std::vector<uint32_t>* samples) const;
  // Writes values per ray to the pixels of the whole viewport, which rays cover in part.
  template <class T> void Spread(const T* rays, int components, T* viewport) const;

private:
  void SetRectangle(const std::vector<Box>& boxes, bool solid);
  void FindPart(vtkProp* prop, int part[4]) const;

  double WorldToClip[16];
  std::vector<float> WindowDepth, OpaqueDepth, PartDepth;
  const float* Ends = nullptr; // what ReadOpaqueDepth() returned last
};

// Converts a mapper's clipping planes to a x + b y + c z + d >= 0, in the world, of which there may be `most`. Transforms of planes are
// ignored, as in VTK's mappers. Returns false, with the reason in `error`, if there are more planes.
VTK_STRATUS_PRIVATE bool vtkStratusClipPlanes(vtkAbstractMapper* mapper, int most, double (*planes)[4], int& count, std::string& error);

#endif
