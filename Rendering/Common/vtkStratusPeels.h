// SPDX-License-Identifier: BSD-3-Clause
// Draws a picture between the translucent surfaces of a renderer that peels them (UseDepthPeelingForVolumes). Private to the modules.
//
// vtkDualDepthPeelingPass draws volumes several times a frame into frame buffers of its own, each time between other surfaces: behind all
// of them, in front of all of them, then from the outside in. It adds code to a volume's shader that finds the depths of two surfaces and
// calls castRay() for the space between them, once or twice.
//
// If rays can be cut, the shader runs once to find the depths: castRay() keeps them. Rays are then cast up to each depth, and the colour
// between two depths is a difference: color = (last - first) / (1 - first's alpha). The shader runs again, and castRay() returns this
// colour. If rays cannot be cut (no part of a ray of a maximum has a colour), castRay() returns the whole frame's colour if the frame's
// depth is between the two, and nothing otherwise, so that each pixel is drawn once a frame.
#ifndef vtkStratusPeels_h
#define vtkStratusPeels_h

#include "vtkStratusInput.h"

#include "vtkNew.h"
#include "vtkOpenGLFramebufferObject.h"
#include "vtkTextureObject.h"

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

class vtkAbstractMapper;
class vtkOpenGLQuadHelper;
class vtkOpenGLRenderPass;
class vtkOpenGLRenderWindow;
class vtkOpenGLState;
class vtkProp;
class vtkWindow;

class VTK_STRATUS_PRIVATE vtkStratusPeels
{
public:
  // The part of a picture to draw: textures of premultiplied colours and of window depths.
  struct Picture {
    vtkTextureObject* Colors = nullptr;
    vtkTextureObject* Depths = nullptr;
    int To[2] = { 0, 0 }; // first pixel of the part in the renderer's viewport
    int Size[2] = { 0, 0 };
    int Viewport[2] = { 0, 0 }; // size of the viewport
    float Scale = 1.0f, Bias = 0.0f;
    // Casts rays up to window depths, one per ray, and sets premultiplied colours. Empty: rays can't be cut. The textures are then not
    // read.
    std::function<bool(const float* depths, std::vector<float>& rgba)> Cast;
    int Rays[2] = { 0, 0 };
  };

  // Blending adds as long as this lives; its end brings the blend equation of before back. VTK 9.1's state has no such scope of its own.
  class Adding
  {
  public:
    explicit Adding(vtkOpenGLState* state);
    ~Adding();
    Adding(const Adding&) = delete;
    void operator=(const Adding&) = delete;

  private:
    vtkOpenGLState* State;
    int Equation[2]; // of colours, of alpha
  };

  // While it lives, drawing goes to the window's own frame buffer, not to the pass's. In a window with multisampling, the pass of VTK 9.1
  // gets no depths of opaque surfaces and takes everything for hidden.
  class Outside
  {
  public:
    explicit Outside(vtkOpenGLRenderWindow* window);
    ~Outside();
    Outside(const Outside&) = delete;
    void operator=(const Outside&) = delete;

  private:
    vtkOpenGLState* State;
    bool Culls;
    Adding Blending;
  };

  vtkStratusPeels();
  ~vtkStratusPeels();
  vtkStratusPeels(const vtkStratusPeels&) = delete;
  void operator=(const vtkStratusPeels&) = delete;

  // The current draw of a prop: not between peels, the first of a frame, a later one, or a first one that the pass would lose (see
  // Outside). All draws of a frame show the picture of the first.
  enum Draw { NONE, FIRST, LATER, OUTSIDE };
  Draw Begin(vtkProp* prop, vtkAbstractMapper* mapper);
  // Must follow Begin(). Returns false where the shader does not compile.
  bool Render(vtkOpenGLRenderWindow* window, const Picture& picture);
  void ReleaseGraphicsResources(vtkWindow* window);

private:
  enum Kind { WHOLE, DEPTHS, PARTS }; // what castRay() does
  vtkOpenGLQuadHelper* PrepareQuad(vtkOpenGLRenderWindow* window, Kind kind);
  bool CopyFront(vtkOpenGLRenderWindow* window, const int size[2]);
  bool FindDepths(vtkOpenGLRenderWindow* window, const Picture& picture);
  bool CastParts(vtkOpenGLRenderWindow* window, const Picture& picture);
  bool Cut(const Picture& picture, int call, std::vector<float>& part);

  vtkOpenGLRenderPass* Pass = nullptr; // Pass, Prop, Mapper and Shader are valid from Begin() to Render()
  vtkProp* Prop = nullptr;
  vtkAbstractMapper* Mapper = nullptr;
  std::string Shader;
  std::map<std::string, std::unique_ptr<vtkOpenGLQuadHelper>> Quads; // one per shader, of which the pass has three, and kind
  vtkNew<vtkTextureObject> Front, Ranges, Parts[2];
  vtkNew<vtkOpenGLFramebufferObject> Buffer; // of Ranges
  std::vector<float> Pixels;                 // of Ranges: begin and end of the first call, and of the second; -1 where there is none
  std::vector<float> Depths, First, Last;
};

#endif
