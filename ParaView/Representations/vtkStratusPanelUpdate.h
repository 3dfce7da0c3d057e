// SPDX-License-Identifier: BSD-3-Clause
// Keeps the statistics of the last frame in ParaView's panel up to date. Private to the module.
#pragma once

#include "vtkWeakPointer.h"

class vtkPVDataRepresentation;
class vtkRenderer;

namespace stratus {

// After each frame of a renderer, a client asks the information properties of a representation anew, which ParaView itself asks no more
// once its panel is there. A server's processes ask nothing.
class PanelUpdate
{
public:
  ~PanelUpdate() { this->Leave(); }
  void Enter(vtkRenderer* renderer, vtkPVDataRepresentation* representation);
  void Leave();

private:
  vtkWeakPointer<vtkRenderer> Renderer;
  unsigned long Observer = 0;
};
} // namespace stratus
