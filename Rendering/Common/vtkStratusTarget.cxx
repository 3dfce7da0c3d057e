// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusTarget.h"

#include "vtkStratusGL.h"

#include "vtkOpenGLFramebufferObject.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLState.h"
#include "vtkRenderer.h"

#include <algorithm>

namespace {
// Returns the internal format of the depth of the frame buffer that is bound for reading; 0: it has none.
GLint DepthFormat()
{
  GLint kind = GL_NONE, name = 0, format = 0;
  glGetFramebufferAttachmentParameteriv(GL_READ_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE, &kind);
  if (kind == GL_NONE) {
    return 0;
  }
  glGetFramebufferAttachmentParameteriv(GL_READ_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_NAME, &name);
  GLint before = 0;
  if (kind == GL_RENDERBUFFER) {
    glGetIntegerv(GL_RENDERBUFFER_BINDING, &before);
    glBindRenderbuffer(GL_RENDERBUFFER, static_cast<GLuint>(name));
    glGetRenderbufferParameteriv(GL_RENDERBUFFER, GL_RENDERBUFFER_INTERNAL_FORMAT, &format);
    glBindRenderbuffer(GL_RENDERBUFFER, static_cast<GLuint>(before));
  } else {
    glGetIntegerv(GL_TEXTURE_BINDING_2D_MULTISAMPLE, &before);
    glBindTexture(GL_TEXTURE_2D_MULTISAMPLE, static_cast<GLuint>(name));
    glGetTexLevelParameteriv(GL_TEXTURE_2D_MULTISAMPLE, 0, GL_TEXTURE_INTERNAL_FORMAT, &format);
    glBindTexture(GL_TEXTURE_2D_MULTISAMPLE, static_cast<GLuint>(before));
  }
  return format;
}

// A frame buffer of one sample a pixel, with a depth of the same format, as long as it lives. OpenGL copies depths between equal formats
// only.
class Resolved
{
public:
  Resolved(vtkOpenGLState* state, GLint format, int width, int height) : State(state)
  {
    GLint before = 0;
    glGetIntegerv(GL_RENDERBUFFER_BINDING, &before);
    glGenFramebuffers(1, &this->Buffer);
    glGenRenderbuffers(1, &this->Depth);
    glBindRenderbuffer(GL_RENDERBUFFER, this->Depth);
    glRenderbufferStorage(GL_RENDERBUFFER, static_cast<GLenum>(format), width, height);
    glBindRenderbuffer(GL_RENDERBUFFER, static_cast<GLuint>(before));
    state->vtkglBindFramebuffer(GL_DRAW_FRAMEBUFFER, this->Buffer);
    glFramebufferRenderbuffer(GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, this->Depth);
    const GLenum none = GL_NONE;
    glDrawBuffers(1, &none);
  }
  ~Resolved()
  {
    glDeleteRenderbuffers(1, &this->Depth);
    glDeleteFramebuffers(1, &this->Buffer);
  }
  Resolved(const Resolved&) = delete;
  void operator=(const Resolved&) = delete;

  // Copies depths of the frame buffer that is bound for reading, and is then bound itself.
  void Copy(int x, int y, int width, int height)
  {
    vtkOpenGLState::ScopedglEnableDisable scissor(this->State, GL_SCISSOR_TEST);
    this->State->vtkglDisable(GL_SCISSOR_TEST);
    glBlitFramebuffer(x, y, x + width, y + height, 0, 0, width, height, GL_DEPTH_BUFFER_BIT, GL_NEAREST);
    this->State->vtkglBindFramebuffer(GL_READ_FRAMEBUFFER, this->Buffer);
    glReadBuffer(GL_NONE);
  }

private:
  vtkOpenGLState* State;
  GLuint Buffer = 0, Depth = 0;
};
} // namespace

// A pass binds its frame buffer for drawing and reading. A pass that peels is bound only for drawing, and the buffer with the scene's
// opaque depth stays bound for reading.
void vtkStratusTarget::Find(vtkRenderer* renderer)
{
  renderer->GetTiledSizeAndOrigin(&this->Viewport[2], &this->Viewport[3], &this->Viewport[0], &this->Viewport[1]);
  this->Buffer = 0;
  auto* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
  if (!window || !renderer->GetPass()) {
    return;
  }
  const auto isWindow = [window](GLint bound) { return static_cast<unsigned int>(bound) == window->GetRenderFramebuffer()->GetFBOIndex(); };
  GLint draw = 0, read = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &draw);
  glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read);
  if (!isWindow(draw) && !isWindow(read)) {
    this->Buffer = static_cast<unsigned int>(read);
    glGetIntegerv(GL_VIEWPORT, this->Viewport);
  }
}

void vtkStratusTarget::ReadDepth(vtkRenderer* renderer, int x, int y, int width, int height, float* depths) const
{
  auto* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
  if (!window || this->Buffer == 0) {
    renderer->GetRenderWindow()->GetZbufferData(x, y, x + width - 1, y + height - 1, depths);
    return;
  }
  vtkOpenGLState* state = window->GetState();
  state->PushFramebufferBindings();
  state->vtkglBindFramebuffer(GL_FRAMEBUFFER, this->Buffer);
  GLint samples = 0, kind = GL_NONE;
  glGetIntegerv(GL_SAMPLES, &samples); // of the frame buffer that is bound for drawing
  glGetFramebufferAttachmentParameteriv(GL_READ_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE, &kind);
  state->vtkglPixelStorei(GL_PACK_ALIGNMENT, 1);
  if (kind == GL_NONE) {
    std::fill_n(depths, static_cast<size_t>(width) * height, 1.0f);
  } else if (samples > 0) {
    Resolved resolved(state, DepthFormat(), width, height);
    resolved.Copy(x, y, width, height);
    glReadPixels(0, 0, width, height, GL_DEPTH_COMPONENT, GL_FLOAT, depths);
    state->vtkglBindFramebuffer(GL_FRAMEBUFFER, this->Buffer); // before the other one is deleted
  } else {
    glReadPixels(x, y, width, height, GL_DEPTH_COMPONENT, GL_FLOAT, depths);
  }
  state->PopFramebufferBindings();
}
