// SPDX-License-Identifier: BSD-3-Clause
// A VTK mapper that draws a volume by OpenVDB: VolumeRayIntersector over the leaves that show something, BoxSampler, and TBB over tiles.
// This header does not include OpenVDB, whose macros clash with VTK's.
#pragma once

#include "stratus.h"

#include <vtkVolumeMapper.h>

#include <memory>

namespace bench {

class openvdb_mapper : public vtkVolumeMapper
{
public:
  static openvdb_mapper* New();
  vtkTypeMacro(openvdb_mapper, vtkVolumeMapper);

  // Borrows the values. step is in world units.
  void set_volume(const stratus_volume& volume, double step);
  unsigned long long samples() const; // of the last frame
  void Render(vtkRenderer* renderer, vtkVolume* volume) override;
  void ReleaseGraphicsResources(vtkWindow*) override {}

protected:
  openvdb_mapper();
  ~openvdb_mapper() override;

private:
  openvdb_mapper(const openvdb_mapper&) = delete;
  void operator=(const openvdb_mapper&) = delete;

  struct inside;
  std::unique_ptr<inside> In;
};
} // namespace bench
