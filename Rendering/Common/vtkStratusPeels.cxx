// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusPeels.h"

#include "vtkStratusGL.h"

#include "vtkAbstractMapper.h"
#include "vtkDualDepthPeelingPass.h"
#include "vtkInformation.h"
#include "vtkInformationObjectBaseVectorKey.h"
#include "vtkOpenGLFramebufferObject.h"
#include "vtkOpenGLQuadHelper.h"
#include "vtkOpenGLRenderPass.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLShaderCache.h"
#include "vtkOpenGLState.h"
#include "vtkProp.h"
#include "vtkShaderProgram.h"
#include "vtkTextureObject.h"

#include <algorithm>

namespace {
// The pass replaces //VTK::DepthPeeling::Dec and //VTK::CallWorker::Impl by code that calls initializeRayCast() and castRay().
const char* const FragmentShader = R"(//VTK::System::Dec
//VTK::Output::Dec
in vec2 texCoord;
#ifdef PARTS
uniform sampler2D first;
uniform sampler2D second;
int calls = 0;
#elif defined(DEPTHS)
vec4 ranges = vec4(-1.0);
#else
uniform sampler2D source;
uniform sampler2D depths;
#endif
uniform vec2 scaleBias; // final colour window and level
uniform vec2 in_inverseWindowSize;
#ifdef FRONT
uniform sampler2D soFar; // colours in front of the peels, with the volumes that were drawn between them
#endif
const float g_opacityThreshold = 1.0;
//VTK::DepthPeeling::Dec
void initializeRayCast() {}
vec4 castRay(const float zStart, const float zEnd)
{
#ifdef DEPTHS
  ranges = ranges.x < 0.0 ? vec4(zStart, zEnd, -1.0, -1.0) : vec4(ranges.xy, zStart, zEnd);
  return vec4(0.0);
#else
#ifdef PARTS
  vec4 color = calls == 0 ? texture(first, texCoord) : texture(second, texCoord);
  ++calls;
#else
  float z = min(texture(depths, texCoord).r, 0.9999999);
  if (z < zStart || z >= zEnd)
  {
    return vec4(0.0);
  }
  vec4 color = texture(source, texCoord);
#endif
  color.rgb = clamp(color.rgb * scaleBias.x + color.a * scaleBias.y, 0.0, 1.0);
  return color;
#endif
}
void main()
{
//VTK::CallWorker::Impl
#ifdef FRONT
  vec4 front = texture(lastFrontColorTex, gl_FragCoord.xy * in_inverseWindowSize);
  vec4 now = texture(soFar, gl_FragCoord.xy * in_inverseWindowSize);
  vec4 added = gl_FragData[1] - front; // this volume's colour, by the share of light that the colours in front let through
  float alpha = front.a < 1.0 ? added.a / (1.0 - front.a) : 0.0;
  gl_FragData[1] = now + added - alpha * (now - front);
#endif
#ifdef DEPTHS
  gl_FragData[0] = texCoord.x < -1.0 ? vec4(0.0) : ranges; // never: the quad wants its coordinates read
#endif
}
)";
// The uniforms that the pass declares are the only sign of its stage.
const char* const FrontOfPeels = "uniform sampler2D lastFrontColorTex"; // while it peels: the colours in front, from the peels so far
const char* const RestOfPeels = "uniform sampler2D depthRangeTex";      // after the last peel

bool Declares(const std::string& shader, const char* uniform)
{
  return shader.find(uniform) != std::string::npos;
}
} // namespace

vtkStratusPeels::Adding::Adding(vtkOpenGLState* state) : State(state)
{
  glGetIntegerv(GL_BLEND_EQUATION_RGB, &this->Equation[0]);
  glGetIntegerv(GL_BLEND_EQUATION_ALPHA, &this->Equation[1]);
  this->State->vtkglBlendEquation(GL_FUNC_ADD);
}

vtkStratusPeels::Adding::~Adding()
{
  this->State->vtkglBlendEquationSeparate(static_cast<GLenum>(this->Equation[0]), static_cast<GLenum>(this->Equation[1]));
}

vtkStratusPeels::Outside::Outside(vtkOpenGLRenderWindow* window)
    : State(window->GetState()), Culls(State->GetEnumState(GL_CULL_FACE)), Blending(State)
{
  this->State->PushDrawFramebufferBinding();
  window->GetRenderFramebuffer()->Bind(GL_DRAW_FRAMEBUFFER);
  this->State->vtkglDisable(GL_CULL_FACE);
}

vtkStratusPeels::Outside::~Outside()
{
  this->State->SetEnumState(GL_CULL_FACE, this->Culls);
  this->State->PopDrawFramebufferBinding();
}

vtkStratusPeels::vtkStratusPeels() = default;
vtkStratusPeels::~vtkStratusPeels() = default;

void vtkStratusPeels::ReleaseGraphicsResources(vtkWindow* window)
{
  this->Front->ReleaseGraphicsResources(window);
  this->Ranges->ReleaseGraphicsResources(window);
  this->Parts[0]->ReleaseGraphicsResources(window);
  this->Parts[1]->ReleaseGraphicsResources(window);
  this->Buffer->ReleaseGraphicsResources(window);
  this->Quads.clear();
}

vtkStratusPeels::Draw vtkStratusPeels::Begin(vtkProp* prop, vtkAbstractMapper* mapper)
{
  this->Pass = nullptr;
  this->Prop = prop;
  this->Mapper = mapper;
  vtkInformation* keys = prop->GetPropertyKeys();
  vtkInformationObjectBaseVectorKey* passes = vtkOpenGLRenderPass::RenderPasses();
  for (int n = 0; keys && keys->Has(passes) && n < keys->Length(passes); ++n) {
    auto* pass = vtkDualDepthPeelingPass::SafeDownCast(keys->Get(passes, n));
    if (!pass) {
      continue;
    }
    std::string vertex, geometry;
    this->Shader = FragmentShader;
    if (pass->PreReplaceShaderValues(vertex, geometry, this->Shader, mapper, prop) && this->Shader != FragmentShader) {
      this->Pass = pass;
    }
  }
  if (!this->Pass) {
    return NONE;
  }
  return Declares(this->Shader, FrontOfPeels) || Declares(this->Shader, RestOfPeels) ? LATER : FIRST;
}

// Copies the colours that the previous volumes have left in front of the peels. The pass's code puts castRay()'s colour under the colours
// of before all volumes, and the pass would blend the results of several volumes by their maximum. The shader puts each volume over those
// before it, as in the other ranges of depth, where the frame buffer blends.
bool vtkStratusPeels::CopyFront(vtkOpenGLRenderWindow* window, const int size[2])
{
  const unsigned int width = static_cast<unsigned int>(size[0]), height = static_cast<unsigned int>(size[1]);
  this->Front->SetContext(window);
  if (this->Front->GetWidth() != width || this->Front->GetHeight() != height) {
    if (!this->Front->Create2D(width, height, 4, VTK_FLOAT, false)) { // the pass may have more bits than bytes have
      return false;
    }
  }
  vtkOpenGLState* state = window->GetState();
  GLint bound = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
  state->PushReadFramebufferBinding();
  state->vtkglBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<unsigned int>(bound));
  state->vtkglReadBuffer(GL_COLOR_ATTACHMENT1);
  this->Front->Activate();
  this->Front->CopyFromFrameBuffer(0, 0, 0, 0, size[0], size[1]);
  state->PopReadFramebufferBinding();
  return true;
}

// Returns a quad whose program is ready and has the pass's parameters, or nullptr.
vtkOpenGLQuadHelper* vtkStratusPeels::PrepareQuad(vtkOpenGLRenderWindow* window, Kind kind)
{
  std::string shader = this->Shader, defines = kind == DEPTHS ? "#define DEPTHS\n" : kind == PARTS ? "#define PARTS\n" : "";
  if (kind != DEPTHS && Declares(shader, FrontOfPeels)) {
    defines += "#define FRONT\n";
  }
  shader.insert(shader.find('\n') + 1, defines); // the #version replaces the first line, and a #define must follow it
  std::unique_ptr<vtkOpenGLQuadHelper>& quad = this->Quads[shader];
  if (!quad) {
    quad.reset(new vtkOpenGLQuadHelper(window, nullptr, shader.c_str(), ""));
  } else {
    window->GetShaderCache()->ReadyShaderProgram(quad->Program);
  }
  const bool ready =
    quad->Program && quad->Program->GetCompiled() && this->Pass->SetShaderParameters(quad->Program, this->Mapper, this->Prop);
  return ready ? quad.get() : nullptr;
}

// Makes the pass's code write the depths between which it would cast rays, into a separate frame buffer.
bool vtkStratusPeels::FindDepths(vtkOpenGLRenderWindow* window, const Picture& picture)
{
  const unsigned int width = static_cast<unsigned int>(picture.Viewport[0]), height = static_cast<unsigned int>(picture.Viewport[1]);
  this->Ranges->SetContext(window);
  if (!this->Ranges->GetHandle() || this->Ranges->GetWidth() != width || this->Ranges->GetHeight() != height) {
    if (!this->Ranges->Create2D(width, height, 4, VTK_FLOAT, false)) {
      return false;
    }
  }
  vtkOpenGLQuadHelper* quad = this->PrepareQuad(window, DEPTHS);
  if (!quad) {
    return false;
  }
  vtkOpenGLState* state = window->GetState();
  vtkOpenGLState::ScopedglEnableDisable blend(state, GL_BLEND);
  const float inverseSize[2] = { 1.0f / static_cast<float>(picture.Viewport[0]), 1.0f / static_cast<float>(picture.Viewport[1]) };
  const float none[4] = { -1.0f, -1.0f, -1.0f, -1.0f };
  state->PushFramebufferBindings();
  this->Buffer->SetContext(window);
  this->Buffer->Bind();
  this->Buffer->AddColorAttachment(0, this->Ranges);
  this->Buffer->ActivateDrawBuffer(0);
  this->Buffer->ActivateReadBuffer(0);
  state->vtkglDisable(GL_BLEND);
  glClearBufferfv(GL_COLOR, 0, none);
  quad->Program->SetUniform2f("in_inverseWindowSize", inverseSize);
  quad->Render();
  this->Pixels.resize(4 * static_cast<size_t>(picture.Size[0]) * static_cast<size_t>(picture.Size[1]));
  state->vtkglPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(picture.To[0], picture.To[1], picture.Size[0], picture.Size[1], GL_RGBA, GL_FLOAT, this->Pixels.data());
  state->PopFramebufferBindings();
  return true;
}

// Finds the part of the rays between the depths of a call. Returns false where a cast fails.
bool vtkStratusPeels::Cut(const Picture& picture, int call, std::vector<float>& part)
{
  const int *rays = picture.Rays, *size = picture.Size;
  const size_t count = static_cast<size_t>(rays[0]) * static_cast<size_t>(rays[1]);
  part.assign(4 * count, 0.0f);
  for (int end = 1; end >= 0; --end) {
    std::vector<float>& rgba = end ? this->Last : this->First;
    bool any = false;
    this->Depths.resize(count);
    for (int j = 0; j < rays[1]; ++j) {
      const size_t row = static_cast<size_t>((j + 0.5) * size[1] / rays[1]) * static_cast<size_t>(size[0]);
      for (int i = 0; i < rays[0]; ++i) {
        const float* range = &this->Pixels[4 * (row + static_cast<size_t>((i + 0.5) * size[0] / rays[0])) + 2 * static_cast<size_t>(call)];
        const float depth = range[0] < range[1] ? std::min(std::max(range[end], 0.0f), 1.0f) : 0.0f;
        this->Depths[static_cast<size_t>(j) * static_cast<size_t>(rays[0]) + static_cast<size_t>(i)] = depth;
        any = any || depth > 0.0f;
      }
    }
    if (!any) {
      rgba.assign(4 * count, 0.0f);
      if (end) {
        return true;
      }
    } else if (!picture.Cast(this->Depths.data(), rgba)) {
      return false;
    }
  }
  for (size_t at = 0; at < 4 * count; at += 4) {
    const float left = 1.0f - this->First[at + 3];
    for (size_t c = 0; c < 4 && left > 0.0f; ++c) {
      part[at + c] = std::min(std::max((this->Last[at + c] - this->First[at + c]) / left, 0.0f), 1.0f);
    }
  }
  return true;
}

bool vtkStratusPeels::CastParts(vtkOpenGLRenderWindow* window, const Picture& picture)
{
  if (!this->FindDepths(window, picture)) {
    return false;
  }
  std::vector<float> part;
  for (int call = 0; call < 2; ++call) {
    if (!this->Cut(picture, call, part)) {
      return false;
    }
    vtkTextureObject* texture = this->Parts[call];
    const unsigned int width = static_cast<unsigned int>(picture.Rays[0]), height = static_cast<unsigned int>(picture.Rays[1]);
    texture->SetContext(window);
    texture->SetMinificationFilter(vtkTextureObject::Nearest);
    texture->SetMagnificationFilter(vtkTextureObject::Nearest);
    if (!texture->Create2DFromRaw(width, height, 4, VTK_FLOAT, part.data())) {
      return false;
    }
  }
  return true;
}

bool vtkStratusPeels::Render(vtkOpenGLRenderWindow* window, const Picture& picture)
{
  vtkOpenGLState* state = window->GetState();
  vtkOpenGLState::ScopedglViewport viewport(state);
  vtkOpenGLState::ScopedglEnableDisable cullFace(state, GL_CULL_FACE);
  vtkOpenGLState::ScopedglEnableDisable blend(state, GL_BLEND);
  vtkOpenGLState::ScopedglBlendFuncSeparate blendFunction(state);
  const Adding adding(state);
  state->vtkglViewport(picture.To[0], picture.To[1], picture.Size[0], picture.Size[1]);
  state->vtkglDisable(GL_CULL_FACE);
  const bool parts = static_cast<bool>(picture.Cast);
  const bool peels = Declares(this->Shader, FrontOfPeels);
  if ((parts && !this->CastParts(window, picture)) || (peels && !this->CopyFront(window, picture.Viewport))) {
    return false;
  }
  vtkOpenGLQuadHelper* quad = this->PrepareQuad(window, parts ? PARTS : WHOLE);
  if (!quad) {
    return false;
  }
  state->vtkglEnable(GL_BLEND);
  state->vtkglBlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  const float inverseSize[2] = { 1.0f / static_cast<float>(picture.Viewport[0]), 1.0f / static_cast<float>(picture.Viewport[1]) };
  const float scaleBias[2] = { picture.Scale, picture.Bias };
  vtkTextureObject* const textures[2] = { parts ? this->Parts[0].Get() : picture.Colors, parts ? this->Parts[1].Get() : picture.Depths };
  for (int n = 0; n < 2; ++n) {
    textures[n]->Activate();
    quad->Program->SetUniformi(n == 0 ? (parts ? "first" : "source") : (parts ? "second" : "depths"), textures[n]->GetTextureUnit());
  }
  quad->Program->SetUniform2f("scaleBias", scaleBias);
  quad->Program->SetUniform2f("in_inverseWindowSize", inverseSize);
  if (peels) {
    quad->Program->SetUniformi("soFar", this->Front->GetTextureUnit());
    glDisablei(GL_BLEND, 1); // the shader's second output already includes the colours in front
  }
  quad->Render();
  if (peels) {
    glEnablei(GL_BLEND, 1);
    this->Front->Deactivate();
  }
  textures[1]->Deactivate();
  textures[0]->Deactivate();
  return true;
}
