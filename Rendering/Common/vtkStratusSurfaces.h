// SPDX-License-Identifier: BSD-3-Clause
// The opaque surfaces of a renderer, which hide lights from volumes. Private to the modules.
#ifndef vtkStratusSurfaces_h
#define vtkStratusSurfaces_h

#include "stratus.h"
#include "vtkStratusPrivate.h"

#include <memory>

class vtkRenderer;

class VTK_STRATUS_PRIVATE vtkStratusSurfaces
{
public:
  // Returns the triangles of all visible actors that are opaque, are lit, and are drawn as surfaces of polygons, within their mappers'
  // clipping planes. Valid until the next call. All mappers of a renderer share them, and they are found anew if an actor has changed.
  const stratus_surfaces* Find(vtkRenderer* renderer);

  // Whether the surfaces take shadows in a picture of these inputs, wherever they are in the viewport. They do not while the renderer
  // picks, or peels volumes: then the picture is shown in parts.
  static bool TakeShadows(vtkRenderer* renderer, const stratus_ray_cast_input* inputs, int count);

private:
  struct Triangles;
  std::shared_ptr<const Triangles> Found;
};

#endif
