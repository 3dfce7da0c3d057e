// SPDX-License-Identifier: BSD-3-Clause
// A VTK mapper that draws a volume by OpenVDB (VolumeRayIntersector and BoxSampler) or by NanoVDB (TreeMarcher and its trilinear sampler).
// Both march over the leaves that show something, with the same table and steps, and TBB over tiles.
// This header does not include OpenVDB, whose macros clash with VTK's.
#pragma once

#include "stratus.h"

#include <vtkVolumeMapper.h>

#include <memory>

namespace bench {

class vdb_mapper : public vtkVolumeMapper
{
public:
  static vdb_mapper* New();
  vtkTypeMacro(vdb_mapper, vtkVolumeMapper);

  // Borrows the values. step is in world units. nano: whether NanoVDB draws.
  void set_volume(const stratus_volume& volume, double step, bool nano);
  unsigned long long samples() const; // of the last frame
  void Render(vtkRenderer* renderer, vtkVolume* volume) override;
  void ReleaseGraphicsResources(vtkWindow*) override {}

protected:
  vdb_mapper();
  ~vdb_mapper() override;

private:
  vdb_mapper(const vdb_mapper&) = delete;
  void operator=(const vdb_mapper&) = delete;

  struct inside;
  std::unique_ptr<inside> In;
};
} // namespace bench
