// SPDX-License-Identifier: BSD-3-Clause
// Draws a float picture over the window's contents, one texel per pixel. Private to the module.
//
// VTK's vtkRayCastImageDisplayHelper does the same for bytes. Its texture coordinates shrink the picture by a pixel, and it rounds before
// it blends. This class rounds once: after the blend, or before the upload where nothing is behind the picture.
#ifndef vtkStratusDisplay_h
#define vtkStratusDisplay_h

#include "vtkStratusCellFinder.h"
#include "vtkStratusPeels.h"
#include "vtkStratusPicture.h"

#include "vtkNew.h"

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

class vtkOpenGLQuadHelper;
class vtkOpenGLRenderWindow;
class vtkTextureObject;
class vtkWindow;

class VTK_STRATUS_PRIVATE vtkStratusDisplay
{
public:
  // The picture.Size pixels to draw, premultiplied. The window shows rgb * Scale + alpha * Bias.
  struct Pixels {
    const float* Rgba = nullptr;
    // The same rounded, drawn if given; then Scale is 1, Bias is 0. They are precise enough over black, and where the frame buffer blends,
    // which rounds its source to bytes first.
    const unsigned char* Bytes = nullptr;
    int Window[4] = { 0, 0, 0, 0 }; // x0, x1, y0, y1: pixels outside are empty
    float Scale = 1.0f;
    float Bias = 0.0f;
    bool Encodes = false; // each pixel's own colour, not multiplied by alpha, is linear and shown by stratus_screen_level()
    const std::vector<float>* Depth = nullptr; // along each ray, as the core gives it
    // Casts rays of the picture up to window depths, one a ray; empty where a part of a ray has no colour of its own. Valid in this frame.
    std::function<bool(const float* depths, std::vector<float>& rgba)> Cast;
    bool WritesDepth = false;               // into the window's depth buffer, where alpha is not 0
    bool Alone = false;                     // nothing was drawn before, so that the bytes may replace the frame buffer's
    vtkStratusCellFinder* Finder = nullptr; // finds cells and points while the renderer picks; nullptr: none are reported
  };

  // Chooses how a picture is displayed with the final colour's window and level. `bytes`: of the picture, to be filled in if Pixels.Bytes
  // is set. The caller fills in the rest.
  static Pixels ChoosePixels(vtkRenderer* renderer, const vtkStratusPicture::Others& others, float finalWindow, float finalLevel,
    const std::vector<unsigned char>& bytes);

  vtkStratusDisplay();
  ~vtkStratusDisplay();
  vtkStratusDisplay(const vtkStratusDisplay&) = delete;
  void operator=(const vtkStratusDisplay&) = delete;

  // Must be called before each draw. Returns false if the draw is complete already: a renderer that peels draws several times a frame, and
  // the later draws place the first one's frame between other peels. Then `error` is lastError, the result of the frame's first draw.
  bool Begin(vtkRenderer* renderer, vtkProp* prop, vtkAbstractMapper* mapper, const std::string& lastError, std::string& error);
  // Ends a draw for which Begin() returned true. While the renderer picks props it draws the prop's selection colour, or the number of the
  // cell or point that each ray shows first, and their depth, where more than 3 of 255 show, as VTK's mappers do. Returns false, with the
  // reason in `error`, where the window can't show it.
  bool Draw(vtkRenderer* renderer, const vtkStratusPicture& picture, const Pixels& pixels, std::string& error);
  void ReleaseGraphicsResources(vtkWindow* window);

private:
  // A part of the picture and its place.
  struct Part {
    int From[2]; // in the picture
    int Size[2];
    int To[2]; // in the window, where the part may have another size
    int ToSize[2];
  };

  // A rectangle of a part that is drawn at its own size.
  struct Piece {
    int From[2]; // in the part
    int Size[2];
  };

  // A variant of the shader.
  struct QuadKind {
    bool WritesDepth = false;
    bool Fetches = false; // one texel a pixel, without a filter
    bool Blends = false;  // over a copy of the pixels behind; otherwise the frame buffer blends
  };

  vtkStratusPeels::Draw ChooseStage(vtkRenderer* renderer, vtkProp* prop, vtkAbstractMapper* mapper);
  bool DrawPixels(vtkRenderer* renderer, const vtkStratusPicture& picture, const Pixels& pixels);
  bool DrawPeeled();
  static Part ChoosePart(const vtkStratusPicture& picture, const Pixels& pixels);
  static void CopyPixels(
    vtkOpenGLRenderWindow* window, const vtkStratusPicture& picture, const Pixels& pixels, const Part& part, int x, int y);
  static bool IsSoftware();
  void BlendOver(const vtkStratusPicture& picture, const Pixels& pixels, const Part& part);
  bool WriteInPlace(
    vtkRenderer* renderer, vtkOpenGLRenderWindow* window, const vtkStratusPicture& picture, const Pixels& pixels, const Part& part);
  bool Upload(vtkOpenGLRenderWindow* window, const vtkStratusPicture& picture, const Pixels& pixels, const Part& part);
  bool CopyBehind(vtkRenderer* renderer, vtkOpenGLRenderWindow* window, const Part& part);
  vtkOpenGLQuadHelper* PrepareQuad(vtkOpenGLRenderWindow* window, const QuadKind& kind);
  bool UploadDepth(vtkOpenGLRenderWindow* window, const vtkStratusPicture& picture, const Part& part);
  static std::vector<Piece> FindPieces(const vtkStratusPicture& picture, const Pixels& pixels, const Part& part);
  bool Blend(
    vtkRenderer* renderer, vtkOpenGLRenderWindow* window, const vtkStratusPicture& picture, const Pixels& pixels, const Part& part);

  void ChooseSelected(vtkRenderer* renderer, const vtkStratusPicture& picture, Pixels& pixels);

  void Encode(const vtkStratusPicture& picture, Pixels& pixels);

  std::vector<float> Selected;    // colours for picking
  std::vector<float> Encoded;     // colours for the screen
  std::vector<float> WindowDepth; // of this draw; empty: it shows no depth
  vtkNew<vtkTextureObject> Texture;
  vtkNew<vtkTextureObject> Behind;
  vtkNew<vtkTextureObject> Depth;
  std::map<int, std::unique_ptr<vtkOpenGLQuadHelper>> Quads; // one per kind
  std::vector<unsigned char> Blended;                        // pixels that WriteInPlace() writes back
  vtkOpenGLRenderWindow* Window = nullptr;                   // owner of the textures
  vtkStratusPeels Peels;
  vtkStratusPeels::Draw Stage = vtkStratusPeels::NONE;
  vtkStratusPeels::Picture Peeled;     // drawn between peels in this frame; without textures, nothing is drawn
  const vtkProp* PeeledProp = nullptr; // prop of Peeled, because props may share a mapper; only compared
};

#endif
