// SPDX-License-Identifier: BSD-3-Clause
// The cells of a mesh that a mask leaves, or the labels that it gives them. Private to the module.
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
  // Returns a copy of a mesh. By the byte that its middle has in the mask, which is of the mesh's coordinates, a cell also is hidden where
  // that is 0, or (labels) has that label. The copy is valid until the next call. Returns nullptr, and sets `error`, if the mask has no
  // point scalars of one unsigned char each.
  const stratus_mesh* Apply(const stratus_mesh& mesh, vtkImageData* mask, bool labels, std::string& error);

private:
  std::vector<std::vector<uint8_t>> Bytes; // of the mesh's parts
  std::vector<stratus_mesh> Blocks;
  stratus_mesh Mesh = stratus_mesh_default();
  vtkWeakPointer<vtkImageData> Mask; // that, and what, Bytes was made for
  vtkMTimeType Time = 0;
  uint64_t Revision = 0;
  const void* Points = nullptr;
  bool Labels = false;
};

#endif
