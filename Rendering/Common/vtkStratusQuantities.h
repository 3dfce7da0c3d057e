// SPDX-License-Identifier: BSD-3-Clause
// Numbers of each pixel's ray, as arrays in addition to a picture. Private to the modules.
#ifndef vtkStratusQuantities_h
#define vtkStratusQuantities_h

#include "stratus.h"

#include "vtkStratusPrivate.h"

#include <string>
#include <vector>

class vtkImageData;
struct vtkStratusPicture;

class VTK_STRATUS_PRIVATE vtkStratusQuantities
{
public:
  // Sets which are wanted, by their names, with spaces or commas between them. names: may be nullptr. Returns false with the reason in
  // `error`.
  bool Set(const char* names, double threshold, std::string& error);
  // Computes what is wanted for the rays of a picture, if anything is. blocks: as in stratus_quantities. Returns false where it fails, with
  // the context's message in `error`, or where an abort ends it.
  bool Compute(stratus_context* context, const stratus_ray_cast_input* inputs, int count, bool blocks, const stratus_camera& camera,
    const stratus_image& rays, std::string& error);
  // Adds an array for each quantity to an image of the whole viewport. Where no ray was cast, sums are 0 and the transmittance is 1.
  void AddTo(vtkImageData* image, const vtkStratusPicture& picture) const;

private:
  bool Wanted[STRATUS_QUANTITY_COUNT] = {};
  double Threshold = 0.5;
  std::vector<float> Values[STRATUS_QUANTITY_COUNT];
};

#endif
