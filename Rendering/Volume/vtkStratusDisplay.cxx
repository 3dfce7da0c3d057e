// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusDisplay.h"

#include "vtkOpenGLFramebufferObject.h"
#include "vtkOpenGLQuadHelper.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLShaderCache.h"
#include "vtkOpenGLState.h"
#include "vtkRenderer.h"
#include "vtkShaderProgram.h"
#include "vtkTextureObject.h"

#include "vtk_glew.h"

namespace {
const char* const FragmentShader = R"(//VTK::System::Dec
//VTK::Output::Dec
in vec2 texCoord;
uniform sampler2D source;
uniform sampler2D behind;
uniform int blends; // 1: the frame buffer does it
uniform vec2 scaleBias; // final colour window and level
void main()
{
  vec4 color = texture(source, texCoord);
  color.rgb = clamp(color.rgb * scaleBias.x + color.a * scaleBias.y, 0.0, 1.0);
  gl_FragData[0] = blends == 1 ? color : color + (1.0 - color.a) * texture(behind, texCoord);
}
)";
}

vtkStratusDisplay::vtkStratusDisplay() = default;
vtkStratusDisplay::~vtkStratusDisplay() = default;

void vtkStratusDisplay::ReleaseGraphicsResources(vtkWindow* window)
{
  this->Texture->ReleaseGraphicsResources(window);
  this->Behind->ReleaseGraphicsResources(window);
  this->Quad.reset();
  this->Window = nullptr;
}

// Software OpenGL rounds three times when it blends, which costs up to 1.3 of 255; a copy of what is behind lets the shader round once. Where
// several samples a pixel or a render pass lie between us and the frame buffer, its own blending has to do.
bool vtkStratusDisplay::CopyBehind(vtkRenderer* renderer, vtkOpenGLRenderWindow* window, int x, int y, const vtkStratusPicture& picture)
{
  if (renderer->GetPass() || window->GetRenderFramebuffer()->GetMultiSamples() > 0) {
    return false;
  }
  const unsigned int width = static_cast<unsigned int>(picture.Rectangle[2]), height = static_cast<unsigned int>(picture.Rectangle[3]);
  this->Behind->SetContext(window);
  if (this->Behind->GetWidth() != width || this->Behind->GetHeight() != height) {
    if (!this->Behind->Create2D(width, height, 4, VTK_UNSIGNED_CHAR, false)) {
      return false;
    }
  }
  this->Behind->Activate();
  this->Behind->CopyFromFrameBuffer(x, y, 0, 0, picture.Rectangle[2], picture.Rectangle[3]);
  return true;
}

// A quarter of the bytes to move and to sample.
const void* vtkStratusDisplay::RoundToBytes(const float* rgba, size_t count)
{
  this->Bytes.resize(count);
  unsigned char* bytes = this->Bytes.data();
  for (size_t i = 0; i < count; ++i) {
    const float value = rgba[i] * 255.0f + 0.5f;
    bytes[i] = static_cast<unsigned char>(static_cast<int>(value < 255.0f ? value : 255.0f)); // premultiplied light is never below 0
  }
  return bytes;
}

bool vtkStratusDisplay::Upload(vtkOpenGLRenderWindow* window, const vtkStratusPicture& picture, const float* rgba, bool bytes)
{
  if (this->Window && this->Window != window) {
    this->ReleaseGraphicsResources(this->Window);
  }
  this->Window = window;
  const unsigned int width = static_cast<unsigned int>(picture.Size[0]), height = static_cast<unsigned int>(picture.Size[1]);
  this->Texture->SetContext(window);
  this->Texture->SetWrapS(vtkTextureObject::ClampToEdge);
  this->Texture->SetWrapT(vtkTextureObject::ClampToEdge);
  const bool coarse = picture.Size[0] != picture.Rectangle[2] || picture.Size[1] != picture.Rectangle[3];
  this->Texture->SetMinificationFilter(coarse ? vtkTextureObject::Linear : vtkTextureObject::Nearest);
  this->Texture->SetMagnificationFilter(coarse ? vtkTextureObject::Linear : vtkTextureObject::Nearest);
  const void* texels = bytes ? this->RoundToBytes(rgba, static_cast<size_t>(4) * width * height) : rgba;
  if (!this->Texture->Create2DFromRaw(width, height, 4, bytes ? VTK_UNSIGNED_CHAR : VTK_FLOAT, const_cast<void*>(texels))) {
    return false;
  }
  if (!this->Quad) {
    this->Quad.reset(new vtkOpenGLQuadHelper(window, nullptr, FragmentShader, ""));
  } else {
    window->GetShaderCache()->ReadyShaderProgram(this->Quad->Program);
  }
  return this->Quad->Program && this->Quad->Program->GetCompiled();
}

bool vtkStratusDisplay::Draw(
  vtkRenderer* renderer, const vtkStratusPicture& picture, const float* rgba, float scale, float bias, bool onBlack)
{
  vtkOpenGLRenderWindow* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
  if (!window || !this->Upload(window, picture, rgba, onBlack && scale == 1.0f && bias == 0.0f)) {
    return false;
  }
  vtkOpenGLState* state = window->GetState();
  const int x = picture.Viewport[0] + picture.Rectangle[0], y = picture.Viewport[1] + picture.Rectangle[1];
  vtkOpenGLState::ScopedglViewport viewport(state);
  vtkOpenGLState::ScopedglScissor scissor(state);
  vtkOpenGLState::ScopedglEnableDisable depthTest(state, GL_DEPTH_TEST);
  vtkOpenGLState::ScopedglEnableDisable blend(state, GL_BLEND);
  vtkOpenGLState::ScopedglBlendFuncSeparate blendFunction(state);
  vtkOpenGLState::ScopedglDepthMask depthMask(state);
  state->vtkglViewport(x, y, picture.Rectangle[2], picture.Rectangle[3]);
  state->vtkglScissor(x, y, picture.Rectangle[2], picture.Rectangle[3]);
  state->vtkglDisable(GL_DEPTH_TEST); // the rays have ended at the opaque depth already
  state->vtkglDepthMask(GL_FALSE);
  this->Texture->Activate();
  const bool blends = onBlack || !this->CopyBehind(renderer, window, x, y, picture);
  if (blends) {
    state->vtkglEnable(GL_BLEND);
    state->vtkglBlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  } else {
    state->vtkglDisable(GL_BLEND);
  }
  this->Quad->Program->SetUniformi("blends", blends ? 1 : 0);
  this->Quad->Program->SetUniformi("behind", (blends ? this->Texture : this->Behind)->GetTextureUnit());
  const float scaleBias[2] = { scale, bias };
  this->Quad->Program->SetUniformi("source", this->Texture->GetTextureUnit());
  this->Quad->Program->SetUniform2f("scaleBias", scaleBias);
  this->Quad->Render();
  this->Texture->Deactivate();
  if (!blends) {
    this->Behind->Deactivate();
  }
  return true;
}
