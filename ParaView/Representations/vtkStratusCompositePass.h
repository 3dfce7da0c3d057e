// SPDX-License-Identifier: BSD-3-Clause
// Draws a view's frames with 16 bits a channel and rounds them to bytes once. Private to the module.
//
// ParaView's ranks draw their parts into frame buffers of bytes, and IceT blends these, again as bytes. Each rank rounds, so that N ranks
// whose pieces are behind one another differ by N of 255 from one rank. Here the frame buffer has 16 bits a channel while a view draws, and
// ranks blend their parts before rounding (vtkStratusRankBlend.h). Rank 0 then has the whole frame and all others an empty one, which IceT
// joins without a change. Channels are numbers in 0..1, as in frame buffers of bytes: light of surfaces beyond 1 is cut off, as in
// ParaView's own frames. Layers of translucent surfaces, and the volumes between them, have 16 bits, too.
//
// Each rank has its own surfaces, but a ray's last segment in a piece may reach beyond the piece. All ranks therefore share the depths of
// their opaque surfaces before anything translucent is drawn.
//
// A pass belongs to a renderer as long as a representation uses it. It wraps ParaView's default pass when a frame starts, because ParaView
// recreates its passes when settings of the view change. Other passes (ray tracing, values of surfaces), picking and tiled displays are not
// changed.
#pragma once

#include "vtkNew.h"
#include "vtkRenderPass.h"
#include "vtkSmartPointer.h"
#include "vtkTextureObject.h"
#include "vtkWeakPointer.h"

#include <functional>
#include <string>
#include <vector>

class vtkBoundingBox;
class vtkIceTCompositePass;
class vtkMultiProcessController;
class vtkOpenGLFXAAFilter;
class vtkOpenGLFramebufferObject;
class vtkOpenGLRenderWindow;
class vtkOverlayPass;
class vtkPVDataRepresentation;
class vtkRenderer;
class vtkStratusDeepPeelingPass;
class vtkStratusWholeBounds;
class vtkVolumetricPass;

class vtkStratusCompositePass : public vtkRenderPass
{
public:
  static vtkStratusCompositePass* New();
  vtkTypeMacro(vtkStratusCompositePass, vtkRenderPass);

  // Adds a representation that is drawn in the renderer, until it leaves. The pass works if one of them is visible. agree: called on all of
  // several ranks before each frame, with the box of each rank's part, unless the representation is hidden. report: called in the same way
  // after the frame.
  using Agree = std::function<void(vtkMultiProcessController*, const std::vector<vtkBoundingBox>&)>;
  using Report = std::function<void(vtkMultiProcessController*)>;
  static void Enter(vtkRenderer* renderer, vtkPVDataRepresentation* user, const Agree& agree, const Report& report);
  static void Leave(vtkRenderer* renderer, vtkPVDataRepresentation* user);

  void Render(const vtkRenderState* state) override;
  void ReleaseGraphicsResources(vtkWindow* window) override;

protected:
  vtkStratusCompositePass();
  ~vtkStratusCompositePass() override;

private:
  vtkStratusCompositePass(const vtkStratusCompositePass&) = delete;
  void operator=(const vtkStratusCompositePass&) = delete;

  void SetRenderer(vtkRenderer* renderer);
  void KeepBackground();
  void Begin();
  bool Install();
  void ShareBounds();
  bool Prepare(vtkOpenGLRenderWindow* window);
  void DrawScene(const vtkRenderState* state, vtkOpenGLRenderWindow* window);
  void ShareSurfaces(vtkOpenGLRenderWindow* window);
  bool MakeRoom();
  void ReportProblem(const std::string& problem);
  void Read(vtkOpenGLRenderWindow* window, std::vector<unsigned short>& picture);
  void Round(vtkOpenGLRenderWindow* window, vtkTextureObject* bytes);
  bool BlendRanks(vtkOpenGLRenderWindow* window, vtkTextureObject* bytes);
  bool HasRanks() const;

  vtkWeakPointer<vtkRenderer> Renderer;
  vtkSmartPointer<vtkRenderPass> Delegate;
  vtkIceTCompositePass* IceT = nullptr; // of this frame; nullptr: there is one rank
  struct User {
    vtkPVDataRepresentation* Shown;
    Agree BeforePicture;
    Report AfterPicture;
  };
  std::vector<User> Users;                    // in the order in which they entered, the same on all ranks
  bool Active = false;                        // in this frame
  float Background[3] = { 0.0f, 0.0f, 0.0f }; // 0..255, whole numbers; black where it is not the same everywhere
  vtkNew<vtkTextureObject> Deep;
  vtkNew<vtkOpenGLFramebufferObject> Source;
  vtkNew<vtkStratusWholeBounds> Whole;
  vtkNew<vtkStratusDeepPeelingPass> Peeling;
  vtkNew<vtkVolumetricPass> Volumes;
  vtkNew<vtkOverlayPass> Overlays;
  vtkNew<vtkOpenGLFXAAFilter> FXAA;
  std::vector<std::vector<unsigned short>> Layers; // of this frame: translucent parts, and opaque surfaces
  std::vector<unsigned char> Bytes;
  std::vector<float> Depths, Least;
  std::string Reported; // the last message about memory that this rank lacked
};
