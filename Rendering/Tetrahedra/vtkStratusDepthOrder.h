// SPDX-License-Identifier: BSD-3-Clause
// Draws the volumes of a renderer by depth, in whatever order they were added. Volumes that do not overlap are drawn from back to front.
// Volumes that overlap are mixed along the rays, if their mappers can. Private to the modules, never installed.
//
// VTK lets each volume draw itself, in the renderer's order. Each mapper therefore calls Draw() first. The first call of a frame finds the
// order and draws all volumes. The later calls find that their volume is drawn. Volumes of other mappers stay in their place: volumes that
// belong behind them are drawn before them, as far as the renderer's order allows. Otherwise a warning is raised, once a renderer.
//
// This module is the lowest that draws volumes. The module of images registers a Mixer, because it knows the other mappers.
#ifndef vtkStratusDepthOrder_h
#define vtkStratusDepthOrder_h

#include "StratusRenderingTetrahedraModule.h" // For export macro

#include <string>
#include <vector>

class vtkAbstractVolumeMapper;
class vtkRenderer;
class vtkVolume;

class STRATUSRENDERINGTETRAHEDRA_EXPORT vtkStratusDepthOrder
{
public:
  // OTHER: drawn by a class that does not call Draw(). MEDIUM: composited. SOLID: opaque, writes its depth, at which later rays end.
  // NOTHING: not drawn into the window.
  enum Kind { OTHER, MEDIUM, SOLID, NOTHING };

  class Mixer
  {
  public:
    virtual ~Mixer() = default;
    virtual Kind GetKind(vtkVolume* volume) const = 0;
    // Draws volumes as one medium. Returns "", or the reason why they can't be mixed; then nothing is drawn.
    virtual std::string Mix(vtkRenderer* renderer, const std::vector<vtkVolume*>& volumes) const = 0;
  };
  // The mixer must live as long as the program.
  static void SetMixer(const Mixer* mixer);

  // Returns false if the caller must draw the volume now. mapper: nullptr if the volume is a prop that draws itself.
  static bool Draw(vtkRenderer* renderer, vtkVolume* volume, vtkAbstractVolumeMapper* mapper);
};

#endif
