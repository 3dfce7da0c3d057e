// SPDX-License-Identifier: BSD-3-Clause
// Numbers of each pixel's ray, as arrays in addition to a picture. Private to the modules.
#ifndef vtkStratusQuantities_h
#define vtkStratusQuantities_h

#include "stratus.h"

#include "vtkStratusPrivate.h"

#include <string>
#include <vector>

class vtkAbstractVolumeMapper;
class vtkDataArray;
class vtkDataObject;
class vtkImageData;
class vtkProp3D;
struct vtkStratusPicture;

class VTK_STRATUS_PRIVATE vtkStratusQuantities
{
public:
  // Sets which are wanted, by their names, with spaces or commas between them. names: may be nullptr. Returns false with the reason in
  // `error`.
  bool Set(const char* names, double threshold, std::string& error);
  // Sets what lengths and values are of: one volume, or several whose numbers add up. Lengths are of the data's own coordinates whatever
  // the prop's scale, and in metres where the data's field data have an array MetresPerUnit. Where volumes differ in either, lengths are
  // the world's. Call ForgetVolumes() before the first.
  void ForgetVolumes() { this->Volumes = 0; }
  void AddVolume(vtkAbstractVolumeMapper* mapper, vtkProp3D* prop);
  // The same of data in the world itself. values: the array.
  void AddData(vtkDataObject* data, vtkDataArray* values, const double linear[9]);
  // Computes what is wanted for the rays of a picture, if anything is. blocks: as in stratus_quantities. Returns false where it fails, with
  // the context's message in `error`, or where an abort ends it.
  bool Compute(stratus_context* context, const stratus_ray_cast_input* inputs, int count, bool blocks, const stratus_camera& camera,
    const stratus_image& rays, std::string& error);
  // Adds an array for each quantity to an image of the whole viewport. Where no ray was cast, sums are 0 and the transmittance is 1.
  void AddTo(vtkImageData* image, const vtkStratusPicture& picture) const { this->AddTo(image, &picture); }
  // The same where each point of the image has a ray.
  void AddTo(vtkImageData* image) const { this->AddTo(image, nullptr); }

private:
  void AddTo(vtkImageData* image, const vtkStratusPicture* picture) const;

  bool Wanted[STRATUS_QUANTITY_COUNT] = {};
  double Threshold = 0.5;
  int Volumes = 0;
  double Linear[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 }; // of the props' matrices
  double MetresPerUnit = 0.0;                       // 0: unknown
  std::string Units;                                // of the values; "": unknown
  std::vector<float> Values[STRATUS_QUANTITY_COUNT];
};

#endif
