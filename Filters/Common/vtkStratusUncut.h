// SPDX-License-Identifier: BSD-3-Clause
// The extent that an image had before a part of it was cut out, by which its cells and points are numbered for people. Private to the
// modules.
#ifndef vtkStratusUncut_h
#define vtkStratusUncut_h

#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkNew.h"

#include <algorithm>

inline const char* vtkStratusUncutName()
{
  return "StratusUncutExtent"; // of the image's field data
}

inline void vtkStratusSetUncut(vtkImageData* image, const int extent[6])
{
  vtkNew<vtkIntArray> uncut;
  uncut->SetName(vtkStratusUncutName());
  uncut->SetNumberOfValues(6);
  std::copy_n(extent, 6, uncut->GetPointer(0));
  image->GetFieldData()->AddArray(uncut);
}

inline const int* vtkStratusGetUncut(vtkImageData* image)
{
  auto* const uncut = vtkIntArray::SafeDownCast(image->GetFieldData()->GetArray(vtkStratusUncutName()));
  return uncut && uncut->GetNumberOfValues() == 6 ? uncut->GetPointer(0) : image->GetExtent();
}

#endif
