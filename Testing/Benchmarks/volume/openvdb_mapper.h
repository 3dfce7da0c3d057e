// SPDX-License-Identifier: BSD-3-Clause
// OpenVDB's way to draw a volume as a VTK mapper: its VolumeRayIntersector over the leaves that show something, its BoxSampler, TBB over
// tiles, drawn texel on pixel. In a header without OpenVDB, whose macros and VTK's don't like each other.
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

  // Borrows the values; steps of `step` in the world.
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
