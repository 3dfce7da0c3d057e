// SPDX-License-Identifier: BSD-3-Clause
// Lays a float picture over what the window shows, texel on pixel. Private to the module.
//
// VTK's vtkRayCastImageDisplayHelper does the same for bytes, through texture coordinates that shrink the picture by a pixel, and rounds before
// it blends. Here the picture is rounded once: after the blend, or, with nothing behind, before the upload.
#ifndef vtkStratusDisplay_h
#define vtkStratusDisplay_h

#include "vtkStratusPicture.h"

#include "vtkNew.h"

#include <memory>
#include <vector>

class vtkOpenGLQuadHelper;
class vtkOpenGLRenderWindow;
class vtkTextureObject;
class vtkWindow;

class VTK_STRATUS_PRIVATE vtkStratusDisplay
{
public:
  vtkStratusDisplay();
  ~vtkStratusDisplay();
  vtkStratusDisplay(const vtkStratusDisplay&) = delete;
  void operator=(const vtkStratusDisplay&) = delete;

  // rgba: premultiplied, picture.Size pixels. Shown is rgb * scale + alpha * bias. onBlack: nothing is behind. False if the window is not
  // an OpenGL one.
  bool Draw(vtkRenderer* renderer, const vtkStratusPicture& picture, const float* rgba, float scale, float bias, bool onBlack);
  void ReleaseGraphicsResources(vtkWindow* window);

private:
  bool Upload(vtkOpenGLRenderWindow* window, const vtkStratusPicture& picture, const float* rgba, bool bytes);
  const void* RoundToBytes(const float* rgba, size_t count);
  bool CopyBehind(vtkRenderer* renderer, vtkOpenGLRenderWindow* window, int x, int y, const vtkStratusPicture& picture);

  std::vector<unsigned char> Bytes;
  vtkNew<vtkTextureObject> Texture;
  vtkNew<vtkTextureObject> Behind;
  std::unique_ptr<vtkOpenGLQuadHelper> Quad;
  vtkOpenGLRenderWindow* Window = nullptr; // only compared
};

#endif
