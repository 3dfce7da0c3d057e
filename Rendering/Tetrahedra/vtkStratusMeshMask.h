// SPDX-License-Identifier: BSD-3-Clause
// The cells of a mesh that a mask leaves. Private to the module.
#ifndef vtkStratusMeshMask_h
#define vtkStratusMeshMask_h

#include "stratus.h"

#include "vtkStratusPrivate.h"

#include "vtkImageData.h"
#include "vtkWeakPointer.h"

#include <cstdint>
#include <string>
#include <vector>

class VTK_STRATUS_PRIVATE vtkStratusMeshMask
{
public:
  // Returns a copy of a mesh that also hides the cells whose middle has a byte of 0 in the mask, which is of the mesh's coordinates. The
  // copy is valid until the next call. Returns nullptr, and sets `error`, if the mask has no point scalars of one unsigned char each.
  const stratus_mesh* Hide(const stratus_mesh& mesh, vtkImageData* mask, std::string& error);

private:
  std::vector<std::vector<uint8_t>> Hidden; // of the mesh's parts
  std::vector<stratus_mesh> Blocks;
  stratus_mesh Mesh = stratus_mesh_default();
  vtkWeakPointer<vtkImageData> Mask; // that, and what, Hidden was made for
  vtkMTimeType Time = 0;
  uint64_t Revision = 0;
  const void* Points = nullptr;
};

#endif
