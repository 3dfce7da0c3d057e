// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusPeels.h"

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

#include "vtk_glew.h"

namespace {
// The pass replaces //VTK::DepthPeeling::Dec and //VTK::CallWorker::Impl by code that calls initializeRayCast() and castRay().
const char* const FragmentShader = R"(//VTK::System::Dec
//VTK::Output::Dec
in vec2 texCoord;
uniform sampler2D source;
uniform sampler2D depths;
uniform vec2 scaleBias; // final colour window and level
uniform vec2 in_inverseWindowSize;
const float g_opacityThreshold = 1.0;
//VTK::DepthPeeling::Dec
void initializeRayCast() {}
vec4 castRay(const float zStart, const float zEnd)
{
  float z = min(texture(depths, texCoord).r, 0.9999999);
  if (z < zStart || z >= zEnd)
  {
    return vec4(0.0);
  }
  vec4 color = texture(source, texCoord);
  color.rgb = clamp(color.rgb * scaleBias.x + color.a * scaleBias.y, 0.0, 1.0);
  return color;
}
void main()
{
//VTK::CallWorker::Impl
}
)";
// The uniforms that the pass declares are the only sign of its stage.
const char* const FrontOfPeels = "lastFrontColorTex"; // while it peels: the colours in front, from the peels so far
const char* const RestOfPeels = "depthRangeTex";      // after the last peel

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

// Copies the colours in front of the peels. The pass's code puts castRay()'s colour under the colours of a texture, and the pass would
// blend the results of several volumes by their maximum. To composite volumes over one another, that texture must hold what the previous
// volume has left in the buffer, so it is a copy of the buffer.
bool vtkStratusPeels::CopyFront(vtkOpenGLRenderWindow* window, const int size[2])
{
  const unsigned int width = static_cast<unsigned int>(size[0]), height = static_cast<unsigned int>(size[1]);
  this->Front->SetContext(window);
  if (this->Front->GetWidth() != width || this->Front->GetHeight() != height) {
    if (!this->Front->Create2D(width, height, 4, VTK_UNSIGNED_CHAR, false)) {
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

bool vtkStratusPeels::Render(vtkOpenGLRenderWindow* window, const Picture& picture)
{
  std::unique_ptr<vtkOpenGLQuadHelper>& quad = this->Quads[this->Shader];
  if (!quad) {
    quad.reset(new vtkOpenGLQuadHelper(window, nullptr, this->Shader.c_str(), ""));
  } else {
    window->GetShaderCache()->ReadyShaderProgram(quad->Program);
  }
  vtkShaderProgram* program = quad->Program;
  const bool peels = Declares(this->Shader, FrontOfPeels);
  if (!program || !program->GetCompiled() || !this->Pass->SetShaderParameters(program, this->Mapper, this->Prop) ||
    (peels && !this->CopyFront(window, picture.Viewport))) {
    return false;
  }
  vtkOpenGLState* state = window->GetState();
  vtkOpenGLState::ScopedglViewport viewport(state);
  vtkOpenGLState::ScopedglEnableDisable cullFace(state, GL_CULL_FACE);
  vtkOpenGLState::ScopedglEnableDisable blend(state, GL_BLEND);
  vtkOpenGLState::ScopedglBlendFuncSeparate blendFunction(state);
  const Adding adding(state);
  state->vtkglViewport(picture.To[0], picture.To[1], picture.Size[0], picture.Size[1]);
  state->vtkglDisable(GL_CULL_FACE);
  state->vtkglEnable(GL_BLEND);
  state->vtkglBlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  const float inverseSize[2] = { 1.0f / static_cast<float>(picture.Viewport[0]), 1.0f / static_cast<float>(picture.Viewport[1]) };
  const float scaleBias[2] = { picture.Scale, picture.Bias };
  picture.Colors->Activate();
  picture.Depths->Activate();
  program->SetUniformi("source", picture.Colors->GetTextureUnit());
  program->SetUniformi("depths", picture.Depths->GetTextureUnit());
  program->SetUniform2f("scaleBias", scaleBias);
  program->SetUniform2f("in_inverseWindowSize", inverseSize);
  if (peels) {
    program->SetUniformi(FrontOfPeels, this->Front->GetTextureUnit());
    glDisablei(GL_BLEND, 1); // the shader's second output already includes the colours in front
  }
  quad->Render();
  if (peels) {
    glEnablei(GL_BLEND, 1);
    this->Front->Deactivate();
  }
  picture.Depths->Deactivate();
  picture.Colors->Deactivate();
  return true;
}
