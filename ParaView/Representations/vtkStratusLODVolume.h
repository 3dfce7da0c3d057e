// SPDX-License-Identifier: BSD-3-Clause
// ParaView's prop draws no composite data and no structured grids: it takes any input that is not one data set of the mapper's usual kind
// for one without scalars. Mappers that look for these themselves are drawn by this prop.
#pragma once

#include "vtkLODProp3D.h"
#include "vtkPVLODVolume.h"

class vtkStratusLODVolume : public vtkPVLODVolume
{
public:
  static vtkStratusLODVolume* New();
  vtkTypeMacro(vtkStratusLODVolume, vtkPVLODVolume);

  int RenderVolumetricGeometry(vtkViewport* viewport) override
  {
    const int drawn = this->LODProp->RenderVolumetricGeometry(viewport);
    this->EstimatedRenderTime = this->LODProp->GetEstimatedRenderTime();
    return drawn;
  }
};
