// SPDX-License-Identifier: BSD-3-Clause
// Reads a mask or label map at any place. Private to the modules.
#ifndef vtkStratusMask_h
#define vtkStratusMask_h

#include "vtkStratusPrivate.h"

#include "vtkType.h"

#include <string>

class vtkImageData;
class vtkUnsignedCharArray;

class VTK_STRATUS_PRIVATE vtkStratusMask
{
public:
  // Takes an image, which must live as long as this. Returns false, with the reason in `error`, if it has no point scalars of one unsigned
  // char each.
  bool Set(vtkImageData* mask, std::string& error);
  // Of the image and its scalars.
  vtkMTimeType GetTime() const;
  // Returns the byte of the point nearest to a place, or 0 if the place is more than half a voxel outside the image.
  unsigned char GetAt(const double place[3]) const;

private:
  vtkImageData* Image = nullptr;
  vtkUnsignedCharArray* Bytes = nullptr;
  int Extent[6] = { 0, -1, 0, -1, 0, -1 };
};

#endif
