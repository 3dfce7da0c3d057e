// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusCompositePass.h"

#include "vtkStratusGL.h"
#include "vtkStratusRankBlend.h"
#include "vtkStratusRanks.h"

#include "vtkBoundingBox.h"
#include "vtkCallbackCommand.h"
#include "vtkCameraPass.h"
#include "vtkDualDepthPeelingPass.h"
#include "vtkIceTCompositePass.h"
#include "vtkImageProcessingPass.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkOpenGLFXAAFilter.h"
#include "vtkOpenGLFramebufferObject.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLRenderer.h"
#include "vtkOpenGLState.h"
#include "vtkOrderedCompositingHelper.h"
#include "vtkOverlayPass.h"
#include "vtkPVDataRepresentation.h"
#include "vtkProp.h"
#include "vtkPropCollection.h"
#include "vtkRenderState.h"
#include "vtkRenderer.h"
#include "vtkTranslucentPass.h"
#include "vtkVolumetricPass.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <new>

namespace {

bool MakeDeep(vtkTextureObject* texture, int width, int height)
{
  texture->SetFormat(GL_RGBA);
  texture->SetInternalFormat(GL_RGBA16);
  texture->SetDataType(GL_UNSIGNED_SHORT);
  return texture->Allocate2D(static_cast<unsigned int>(width), static_cast<unsigned int>(height), 4, VTK_UNSIGNED_SHORT);
}
} // namespace

// IceT keeps only the part of a rank's picture within the rank's bounds. Rank 0, which hands in the picture of all, has this prop with the
// bounds of all. It draws nothing.
class vtkStratusWholeBounds : public vtkProp
{
public:
  static vtkStratusWholeBounds* New();
  vtkTypeMacro(vtkStratusWholeBounds, vtkProp);

  double* GetBounds() override { return this->Bounds; }
  double Bounds[6] = { 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 };
};

// VTK's peeling, with 16 bits a channel. VTK makes textures only where there are none.
class vtkStratusDeepPeelingPass : public vtkDualDepthPeelingPass
{
public:
  static vtkStratusDeepPeelingPass* New();
  vtkTypeMacro(vtkStratusDeepPeelingPass, vtkDualDepthPeelingPass);

  void Render(const vtkRenderState* state) override
  {
    if (!this->Textures[BackTemp]) {
      state->GetRenderer()->GetTiledSizeAndOrigin(&this->ViewportWidth, &this->ViewportHeight, &this->ViewportX, &this->ViewportY);
      for (int name = BackTemp; name < NumberOfTextures; ++name) {
        vtkTextureObject* texture = this->Textures[name] = vtkTextureObject::New();
        if (name == DepthA || name == DepthB) {
          this->InitDepthTexture(texture, state);
        } else if (name == OpaqueDepth) {
          this->InitOpaqueDepthTexture(texture, state);
        } else {
          texture->SetContext(vtkOpenGLRenderWindow::SafeDownCast(state->GetRenderer()->GetRenderWindow()));
          MakeDeep(texture, this->ViewportWidth, this->ViewportHeight);
        }
      }
    }
    this->Superclass::Render(state);
  }
};

vtkStandardNewMacro(vtkStratusDeepPeelingPass);
vtkStandardNewMacro(vtkStratusWholeBounds);
vtkStandardNewMacro(vtkStratusCompositePass);

namespace {
std::map<vtkRenderer*, vtkSmartPointer<vtkStratusCompositePass>> Passes;
}

vtkStratusCompositePass::vtkStratusCompositePass()
{
  this->Whole->PickableOff();
  const vtkNew<vtkTranslucentPass> translucent;
  this->Peeling->SetTranslucentPass(translucent);
  this->Peeling->SetVolumetricPass(this->Volumes);
}

vtkStratusCompositePass::~vtkStratusCompositePass() = default;

void vtkStratusCompositePass::Enter(vtkRenderer* renderer, vtkPVDataRepresentation* user, const Agree& agree, const Report& report)
{
  vtkSmartPointer<vtkStratusCompositePass>& pass = Passes[renderer];
  if (!pass) {
    pass = vtkSmartPointer<vtkStratusCompositePass>::New();
    pass->SetRenderer(renderer);
  }
  pass->Users.push_back({ user, agree, report });
}

void vtkStratusCompositePass::Leave(vtkRenderer* renderer, vtkPVDataRepresentation* user)
{
  const auto found = Passes.find(renderer);
  if (found != Passes.end()) {
    auto& users = found->second->Users;
    users.erase(std::remove_if(users.begin(), users.end(), [user](const auto& other) { return other.Shown == user; }), users.end());
  }
}

void vtkStratusCompositePass::SetRenderer(vtkRenderer* renderer)
{
  this->Renderer = renderer;
  vtkNew<vtkCallbackCommand> before, start, end;
  before->SetClientData(this);
  before->SetCallback([](vtkObject*, unsigned long, void* pass, void*) { static_cast<vtkStratusCompositePass*>(pass)->KeepBackground(); });
  renderer->AddObserver(vtkCommand::StartEvent, before, 1.0f); // before vtkSynchronizedRenderers, which makes it black
  start->SetClientData(this);
  start->SetCallback([](vtkObject*, unsigned long, void* pass, void*) { static_cast<vtkStratusCompositePass*>(pass)->Begin(); });
  renderer->AddObserver(vtkCommand::StartEvent, start);
  end->SetCallback([](vtkObject* deleted, unsigned long, void*, void*) { Passes.erase(static_cast<vtkRenderer*>(deleted)); });
  renderer->AddObserver(vtkCommand::DeleteEvent, end);
}

void vtkStratusCompositePass::ReleaseGraphicsResources(vtkWindow* window)
{
  this->Deep->ReleaseGraphicsResources(window);
  this->Peeling->ReleaseGraphicsResources(window);
  this->FXAA->ReleaseGraphicsResources();
  this->Source->ReleaseGraphicsResources(window);
  if (this->Delegate) {
    this->Delegate->ReleaseGraphicsResources(window);
  }
}

bool vtkStratusCompositePass::HasRanks() const
{
  return this->IceT && this->IceT->GetController() && this->IceT->GetController()->GetNumberOfProcesses() > 1;
}

// Puts this pass around ParaView's default pass, unless it is there.
bool vtkStratusCompositePass::Install()
{
  this->IceT = nullptr;
  vtkRenderPass* outer = this->Renderer->GetPass();
  while (auto* image = vtkImageProcessingPass::SafeDownCast(outer)) {
    outer = image->GetDelegatePass();
  }
  auto* camera = vtkCameraPass::SafeDownCast(outer);
  if (!camera) {
    return false;
  }
  this->IceT = vtkIceTCompositePass::SafeDownCast(camera->GetDelegatePass());
  vtkRenderPass* inner = this->IceT ? this->IceT->GetRenderPass() : camera->GetDelegatePass();
  if (inner == this) {
    return true;
  }
  if (!inner || !inner->IsA("vtkPVDefaultPass")) {
    return false;
  }
  this->Delegate = inner;
  if (this->IceT) {
    this->IceT->SetRenderPass(this);
  } else {
    camera->SetDelegatePass(this);
  }
  return true;
}

void vtkStratusCompositePass::KeepBackground()
{
  const bool plain = !this->Renderer->GetGradientBackground() && !this->Renderer->GetTexturedBackground();
  for (int c = 0; c < 3; ++c) {
    const double value = plain ? this->Renderer->GetBackground()[c] : 0.0;
    this->Background[c] = std::floor(255.0f * std::min(std::max(static_cast<float>(value), 0.0f), 1.0f) + 0.5f);
  }
}

// When a frame starts. All that decides here is the same on all ranks.
void vtkStratusCompositePass::Begin()
{
  const bool visible = std::any_of(this->Users.begin(), this->Users.end(), [](const auto& user) { return user.Shown->GetVisibility(); });
  this->Whole->VisibilityOff();
  const bool installed = visible && !this->Renderer->GetSelector() && this->Install();
  this->Active = installed && !this->Renderer->GetUseShadows();
  if (!visible || this->Renderer->GetSelector() || !this->IceT) {
    return;
  }
  vtkOrderedCompositingHelper* order = this->IceT->GetUseOrderedCompositing() ? this->IceT->GetOrderedCompositingHelper() : nullptr;
  if (order && this->HasRanks()) {
    for (const auto& user : this->Users) {
      if (user.Shown->GetVisibility()) {
        user.BeforePicture(this->IceT->GetController(), order->GetBoundingBoxes());
      }
    }
  }
  const int* tiles = this->IceT->GetTileDimensions();
  this->Active = this->Active && order && tiles[0] == 1 && tiles[1] == 1;
  if (this->Active && this->HasRanks()) {
    this->IceT->SetRenderEmptyImages(true); // every rank must come to Render()
    this->ShareBounds();
  }
}

void vtkStratusCompositePass::ShareBounds()
{
  double mine[6];
  this->Renderer->ComputeVisiblePropBounds(mine);
  if (!stratus::join_bounds(this->IceT->GetController(), mine, this->Whole->Bounds)) {
    return; // there is nothing to draw
  }
  if (!this->Renderer->GetViewProps()->IsItemPresent(this->Whole)) {
    this->Renderer->AddViewProp(this->Whole);
  }
  this->Whole->VisibilityOn();
}

// Copies the frame buffer into the deep texture. Returns false if the frame buffer is not of ParaView's kind.
bool vtkStratusCompositePass::Prepare(vtkOpenGLRenderWindow* window)
{
  vtkOpenGLFramebufferObject* frame = window ? window->GetRenderFramebuffer() : nullptr;
  vtkTextureObject* bytes = frame && frame->GetNumberOfColorAttachments() == 1 ? frame->GetColorAttachmentAsTextureObject(0) : nullptr;
  if (!bytes || frame->GetMultiSamples() > 0 || bytes->GetTarget() != GL_TEXTURE_2D || bytes->GetVTKDataType() != VTK_UNSIGNED_CHAR ||
    bytes->GetComponents() != 4) {
    return false;
  }
  GLint bound = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
  if (static_cast<unsigned int>(bound) != frame->GetFBOIndex()) {
    return false;
  }
  const unsigned int width = bytes->GetWidth(), height = bytes->GetHeight();
  this->Deep->SetContext(window);
  if (!this->Deep->GetHandle() || this->Deep->GetWidth() != width || this->Deep->GetHeight() != height) {
    if (!MakeDeep(this->Deep, static_cast<int>(width), static_cast<int>(height))) {
      return false;
    }
  }
  vtkOpenGLState* state = window->GetState();
  state->PushReadFramebufferBinding();
  frame->Bind(GL_READ_FRAMEBUFFER);
  frame->ActivateReadBuffer(0);
  this->Deep->CopyFromFrameBuffer(0, 0, 0, 0, static_cast<int>(width), static_cast<int>(height));
  this->Deep->Deactivate();
  state->PopReadFramebufferBinding();
  return true;
}

void vtkStratusCompositePass::Render(const vtkRenderState* state)
{
  this->NumberOfRenderedProps = 0;
  if (!this->Delegate) {
    return;
  }
  this->Whole->VisibilityOff();
  auto* window = vtkOpenGLRenderWindow::SafeDownCast(state->GetRenderer()->GetRenderWindow());
  int prepared = this->Active && this->Prepare(window);
  const bool ranks = this->Active && this->HasRanks();
  const bool room = !ranks || !prepared || this->MakeRoom();
  if (ranks) {
    int all = 0;
    prepared = prepared && room;
    this->IceT->GetController()->AllReduce(&prepared, &all, 1, vtkCommunicator::MIN_OP);
    prepared = all;
  }
  if (!prepared) {
    this->Delegate->Render(state);
    this->NumberOfRenderedProps = this->Delegate->GetNumberOfRenderedProps();
    if (ranks) {
      this->ReportProblem(room ? "" : "there is not enough memory to blend in 16 bits; ranks blend in 8");
    }
    return;
  }
  vtkOpenGLFramebufferObject* frame = window->GetRenderFramebuffer();
  const vtkSmartPointer<vtkTextureObject> bytes = frame->GetColorAttachmentAsTextureObject(0);
  frame->AddColorAttachment(0, this->Deep);
  this->DrawScene(state, window);
  if (this->HasRanks()) {
    this->ReportProblem(this->BlendRanks(window, bytes) ? "" : "there is not enough memory to blend; the last picture stays");
    for (const auto& user : this->Users) {
      if (user.Shown->GetVisibility()) {
        user.AfterPicture(this->IceT->GetController());
      }
    }
  } else {
    this->Round(window, bytes);
  }
}

// Does what vtkOpenGLRenderer::UpdateGeometry does, but that it peels with 16 bits, and that ranks share depths.
void vtkStratusCompositePass::DrawScene(const vtkRenderState* state, vtkOpenGLRenderWindow* window)
{
  vtkRenderer* renderer = state->GetRenderer();
  auto* drawing = vtkOpenGLRenderer::SafeDownCast(renderer);
  this->ClearLights(renderer);
  this->UpdateLightGeometry(renderer);
  this->UpdateLights(renderer);
  renderer->DeviceRenderOpaqueGeometry(state->GetFrameBuffer());
  if (this->HasRanks()) {
    this->ShareSurfaces(window);
  }
  vtkProp** props = state->GetPropArray();
  const bool translucent =
    std::any_of(props, props + state->GetPropArrayCount(), [](vtkProp* prop) { return prop->HasTranslucentPolygonalGeometry() != 0; });
  const bool peels = renderer->GetUseDepthPeeling() && renderer->GetUseDepthPeelingForVolumes() && drawing->IsDualDepthPeelingSupported();
  if (translucent && peels) {
    this->Peeling->SetMaximumNumberOfPeels(renderer->GetMaximumNumberOfPeels());
    this->Peeling->SetOcclusionRatio(renderer->GetOcclusionRatio());
    this->Peeling->Render(state);
  } else if (translucent) {
    renderer->DeviceRenderTranslucentPolygonalGeometry(state->GetFrameBuffer());
  }
  if (renderer->GetUseFXAA()) { // volumes need none
    if (renderer->GetFXAAOptions()) {
      this->FXAA->UpdateConfiguration(renderer->GetFXAAOptions());
    }
    this->FXAA->Execute(drawing);
  }
  if (!translucent || !peels) {
    this->Volumes->Render(state);
  }
  this->Overlays->Render(state);
  this->NumberOfRenderedProps = state->GetPropArrayCount();
}

// Allocates the arrays that ranks share. Returns false if memory is short.
bool vtkStratusCompositePass::MakeRoom()
{
  const size_t count = static_cast<size_t>(this->Deep->GetWidth()) * this->Deep->GetHeight();
  try {
    this->Layers.resize(2);
    this->Layers[0].resize(4 * count);
    this->Layers[1].resize(4 * count);
    this->Depths.resize(count);
    this->Least.resize(count);
  } catch (const std::bad_alloc&) {
    return false;
  }
  return true;
}

// Lets rank 0 report shortages of any rank. Every rank must call it. problem: of this rank, or "".
void vtkStratusCompositePass::ReportProblem(const std::string& problem)
{
  const std::string words = stratus::join_words(this->IceT->GetController(), problem, this->Reported);
  if (!words.empty()) {
    vtkErrorMacro(<< words);
  }
}

void vtkStratusCompositePass::Read(vtkOpenGLRenderWindow* window, std::vector<unsigned short>& picture)
{
  vtkOpenGLState* state = window->GetState();
  const int width = static_cast<int>(this->Deep->GetWidth()), height = static_cast<int>(this->Deep->GetHeight());
  state->PushReadFramebufferBinding();
  window->GetRenderFramebuffer()->Bind(GL_READ_FRAMEBUFFER);
  window->GetRenderFramebuffer()->ActivateReadBuffer(0);
  state->vtkglPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_SHORT, picture.data());
  state->PopReadFramebufferBinding();
}

// Lets the depth buffer hold the least depths of all ranks' opaque surfaces, and takes from the frame buffer the pixels of this rank's
// surfaces that are the nearest.
void vtkStratusCompositePass::ShareSurfaces(vtkOpenGLRenderWindow* window)
{
  vtkOpenGLFramebufferObject* frame = window->GetRenderFramebuffer();
  vtkTextureObject* depth = frame->GetDepthAttachmentAsTextureObject();
  vtkMultiProcessController* controller = this->IceT->GetController();
  vtkOpenGLState* state = window->GetState();
  const int width = static_cast<int>(this->Deep->GetWidth()), height = static_cast<int>(this->Deep->GetHeight());
  const vtkIdType count = static_cast<vtkIdType>(width) * height;
  state->PushReadFramebufferBinding();
  frame->Bind(GL_READ_FRAMEBUFFER);
  state->vtkglPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_DEPTH_COMPONENT, GL_FLOAT, this->Depths.data());
  state->PopReadFramebufferBinding();
  const bool surfaces = std::any_of(this->Depths.begin(), this->Depths.end(), [](float z) { return z < 1.0f; });
  const int opaque[2] = { !depth, surfaces };
  int any[2] = { 0, 0 }; // a depth buffer that can't be written, opaque surfaces
  controller->AllReduce(opaque, any, 2, vtkCommunicator::MAX_OP);
  if (any[0] || !any[1]) {
    this->Layers.pop_back();
    return;
  }
  std::vector<float>& least = this->Least;
  controller->AllReduce(this->Depths.data(), least.data(), count, vtkCommunicator::MIN_OP);
  this->Read(window, this->Layers[1]);
  for (size_t pixel = 0; pixel < least.size(); ++pixel) {
    if (this->Depths[pixel] > least[pixel]) {
      std::fill_n(&this->Layers[1][4 * pixel], 4, static_cast<unsigned short>(0));
    }
  }
  const float nothing[4] = { 0.0f, 0.0f, 0.0f, 0.0f };
  glClearBufferfv(GL_COLOR, 0, nothing);
  depth->Activate();
  state->vtkglPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_DEPTH_COMPONENT, GL_FLOAT, least.data());
  depth->Deactivate();
}

// Gives the frame buffer its bytes back, and rounds what was drawn to them.
void vtkStratusCompositePass::Round(vtkOpenGLRenderWindow* window, vtkTextureObject* bytes)
{
  vtkOpenGLFramebufferObject* frame = window->GetRenderFramebuffer();
  vtkOpenGLState* state = window->GetState();
  const int width = static_cast<int>(bytes->GetWidth()), height = static_cast<int>(bytes->GetHeight());
  frame->AddColorAttachment(0, bytes);
  vtkOpenGLState::ScopedglEnableDisable scissor(state, GL_SCISSOR_TEST);
  state->vtkglDisable(GL_SCISSOR_TEST);
  state->PushReadFramebufferBinding();
  this->Source->SetContext(window);
  this->Source->Bind(GL_READ_FRAMEBUFFER);
  this->Source->AddColorAttachment(0, this->Deep);
  this->Source->ActivateReadBuffer(0);
  state->vtkglBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  state->PopReadFramebufferBinding();
}

// Gives the frame buffer its bytes back: on rank 0 the picture of all ranks, on the others none. Where a rank lacks memory, the last
// picture stays; returns whether this one had it.
bool vtkStratusCompositePass::BlendRanks(vtkOpenGLRenderWindow* window, vtkTextureObject* bytes)
{
  vtkOpenGLFramebufferObject* frame = window->GetRenderFramebuffer();
  vtkOpenGLState* state = window->GetState();
  const int size[2] = { static_cast<int>(bytes->GetWidth()), static_cast<int>(bytes->GetHeight()) };
  this->Read(window, this->Layers[0]);
  frame->AddColorAttachment(0, bytes);

  vtkMultiProcessController* controller = this->IceT->GetController();
  const std::vector<int> order = this->IceT->GetOrderedCompositingHelper()->ComputeSortOrder(this->Renderer->GetActiveCamera());
  const bool room = stratus::blend_ranks(controller, order, size, this->Layers, this->Background, this->Bytes);
  if (this->Bytes.size() != 4 * static_cast<size_t>(size[0]) * static_cast<size_t>(size[1])) {
    return room;
  }
  bytes->Activate();
  state->vtkglPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, size[0], size[1], GL_RGBA, GL_UNSIGNED_BYTE, this->Bytes.data());
  bytes->Deactivate();
  return room;
}
