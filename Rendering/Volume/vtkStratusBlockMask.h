// SPDX-License-Identifier: BSD-3-Clause
// The part of a mask, or label map, that a block of a cut volume takes. Private to the module.
#ifndef vtkStratusBlockMask_h
#define vtkStratusBlockMask_h

#include "vtkStratusPrivate.h"

#include "vtkDataSet.h"
#include "vtkImageData.h"
#include "vtkSmartPointer.h"
#include "vtkWeakPointer.h"

#include <string>

class VTK_STRATUS_PRIVATE vtkStratusBlockMask
{
public:
  // Returns an image with a byte for each value of `block`, an image or rectilinear grid: the mask's byte at the point nearest to the
  // value, or 0 if the value is more than half a voxel outside the mask. cells: the block's values are of cells. The image is kept until
  // mask or block change. Returns nullptr, and sets `error`, if the mask has no point scalars of one unsigned char each.
  vtkImageData* Get(vtkImageData* mask, vtkDataSet* block, bool cells, std::string& error);

private:
  vtkSmartPointer<vtkImageData> Part;
  vtkWeakPointer<vtkImageData> Mask;
  vtkWeakPointer<vtkDataSet> Of;
  bool Cells = false;
  vtkMTimeType Time = 0;
};

#endif
