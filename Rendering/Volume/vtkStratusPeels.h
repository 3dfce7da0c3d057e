// SPDX-License-Identifier: BSD-3-Clause
// Lays a picture between the translucent surfaces of a renderer that peels them (UseDepthPeelingForVolumes). Private to the modules.
//
// vtkDualDepthPeelingPass draws volumes several times a frame, each time between other surfaces, into frame buffers of its own: what is
// behind all of them, what is before, then from the outside in. It lends a volume's shader the code that finds those depths and calls
// castRay() for what lies between two of them. Here castRay() gives the whole picture where its first depth lies between the two, and
// nothing elsewhere: so each pixel is drawn once a frame, before or behind each surface by its depth.
#ifndef vtkStratusPeels_h
#define vtkStratusPeels_h

#include "vtkStratusInput.h"

#include "vtkNew.h"

#include <map>
#include <memory>
#include <string>

class vtkAbstractMapper;
class vtkOpenGLQuadHelper;
class vtkOpenGLRenderPass;
class vtkOpenGLRenderWindow;
class vtkOpenGLState;
class vtkProp;
class vtkTextureObject;
class vtkWindow;

class VTK_STRATUS_PRIVATE vtkStratusPeels
{
public:
  // What is to be drawn: textures of premultiplied colours and of depths in the window, both of the part alone.
  struct Picture {
    vtkTextureObject* Colors = nullptr;
    vtkTextureObject* Depths = nullptr;
    int To[2] = { 0, 0 }; // the part's first pixel in the renderer's viewport
    int Size[2] = { 0, 0 };
    int Viewport[2] = { 0, 0 }; // the viewport's size
    float Scale = 1.0f, Bias = 0.0f;
  };

  // As long as it lives the window's own frame buffer is drawn into, not the pass's. Where the window has several samples a pixel the pass
  // of VTK 9.1 gets no depths of opaque surfaces from it, and takes all for hidden.
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
    int Equation[2];
  };

  vtkStratusPeels();
  ~vtkStratusPeels();
  vtkStratusPeels(const vtkStratusPeels&) = delete;
  void operator=(const vtkStratusPeels&) = delete;

  // Whether a pass draws the prop between peels at the moment, and which of its draws in this frame: all show the picture of the first.
  // OUTSIDE: the first, where the pass would lose it; see Outside.
  enum Draw { NONE, FIRST, LATER, OUTSIDE };
  Draw Begin(vtkProp* prop, vtkAbstractMapper* mapper);
  // After Begin(). False where the shader does not compile.
  bool Render(vtkOpenGLRenderWindow* window, const Picture& picture);
  void ReleaseGraphicsResources(vtkWindow* window);

private:
  bool CopyFront(vtkOpenGLRenderWindow* window, const int size[2]);

  vtkOpenGLRenderPass* Pass = nullptr; // this and the next three from Begin() to Render()
  vtkProp* Prop = nullptr;
  vtkAbstractMapper* Mapper = nullptr;
  std::string Shader;
  std::map<std::string, std::unique_ptr<vtkOpenGLQuadHelper>> Quads; // one a shader: the pass has three
  vtkNew<vtkTextureObject> Front;
};

#endif
