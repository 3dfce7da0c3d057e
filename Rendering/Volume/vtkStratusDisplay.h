// SPDX-License-Identifier: BSD-3-Clause
// Lays a float picture over what the window shows, texel on pixel. Private to the module.
//
// VTK's vtkRayCastImageDisplayHelper does the same for bytes, through texture coordinates that shrink the picture by a pixel, and rounds
// before it blends. Here the picture is rounded once: after the blend, or, with nothing behind, before the upload.
#ifndef vtkStratusDisplay_h
#define vtkStratusDisplay_h

#include "vtkStratusPeels.h"
#include "vtkStratusPicture.h"

#include "vtkNew.h"

#include <memory>

class vtkOpenGLQuadHelper;
class vtkOpenGLRenderWindow;
class vtkTextureObject;
class vtkWindow;

class VTK_STRATUS_PRIVATE vtkStratusDisplay
{
public:
  // What is to be shown: picture.Size pixels, premultiplied. Shown is rgb * Scale + alpha * Bias.
  struct Pixels {
    const float* Rgba = nullptr;
    const unsigned char* Bytes = nullptr; // the same rounded, or nullptr; taken if given: Scale and Bias are 1 and 0, and black is behind
    int Window[4] = { 0, 0, 0, 0 };       // x0, x1, y0, y1: nothing shows outside
    float Scale = 1.0f;
    float Bias = 0.0f;
    const float* Depth =
      nullptr;          // of the window, to be written where alpha is, or, FIRST, to be laid between peels by; or nullptr: none is
    bool Alone = false; // nothing has been drawn before: the bytes are what the window has to hold
  };

  vtkStratusDisplay();
  ~vtkStratusDisplay();
  vtkStratusDisplay(const vtkStratusDisplay&) = delete;
  void operator=(const vtkStratusDisplay&) = delete;

  // To be asked before each draw. LATER: DrawAgain() is all that is left to do. FIRST: Draw() needs depths.
  vtkStratusPeels::Draw Begin(vtkRenderer* renderer, vtkProp* prop, vtkAbstractMapper* mapper);
  // False if the window is not an OpenGL one.
  bool Draw(vtkRenderer* renderer, const vtkStratusPicture& picture, const Pixels& pixels);
  // What Draw() showed in this frame, between the peels of now; nothing if it was not called.
  bool DrawAgain();
  void ReleaseGraphicsResources(vtkWindow* window);

private:
  // A part of the picture, and where it goes.
  struct Part {
    int From[2]; // of the picture
    int Size[2];
    int To[2]; // of the window, and how large there
    int ToSize[2];
  };

  static Part ChoosePart(const vtkStratusPicture& picture, const Pixels& pixels);
  static void CopyPixels(
    vtkOpenGLRenderWindow* window, const vtkStratusPicture& picture, const Pixels& pixels, const Part& part, int x, int y);
  bool WriteInPlace(
    vtkRenderer* renderer, vtkOpenGLRenderWindow* window, const vtkStratusPicture& picture, const Pixels& pixels, const Part& part);
  bool Upload(vtkOpenGLRenderWindow* window, const vtkStratusPicture& picture, const Pixels& pixels, const Part& part);
  bool CopyBehind(vtkRenderer* renderer, vtkOpenGLRenderWindow* window, const Part& part);
  bool PrepareQuad(vtkOpenGLRenderWindow* window, bool writesDepth);
  bool UploadDepth(vtkOpenGLRenderWindow* window, const vtkStratusPicture& picture, const Pixels& pixels, const Part& part);
  void Blend(vtkRenderer* renderer, vtkOpenGLRenderWindow* window, const Pixels& pixels, const Part& part);

  vtkNew<vtkTextureObject> Texture;
  vtkNew<vtkTextureObject> Behind;
  vtkNew<vtkTextureObject> Depth;
  std::unique_ptr<vtkOpenGLQuadHelper> Quad, DepthQuad; // the second writes depth, too
  vtkOpenGLRenderWindow* Window = nullptr;              // that the textures belong to
  vtkStratusPeels Peels;
  vtkStratusPeels::Draw Stage = vtkStratusPeels::NONE;
  vtkStratusPeels::Picture Peeled;     // what is drawn between peels in this frame; without textures: nothing
  const vtkProp* PeeledProp = nullptr; // whose it is: props may share a mapper; only compared
};

#endif
