// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusDisplay.h"

#include "vtkStratusGL.h"

#include "vtkDataObject.h"
#include "vtkHardwareSelector.h"
#include "vtkOpenGLFramebufferObject.h"
#include "vtkOpenGLQuadHelper.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLShaderCache.h"
#include "vtkOpenGLState.h"
#include "vtkRenderer.h"
#include "vtkShaderProgram.h"
#include "vtkTextureObject.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace {
constexpr int PieceRows = 32;
constexpr float LEAST_SELECTED = 3.0f / 255.0f;
const char* const FragmentShader = R"(//VTK::System::Dec
//VTK::Output::Dec
in vec2 texCoord;
uniform sampler2D source;
uniform vec2 scaleBias; // final colour window and level
uniform vec4 piece;     // of the picture, that the viewport shows: corner and size
#ifdef BLENDS
uniform sampler2D behind;
#endif
#ifdef WRITES_DEPTH
uniform sampler2D depths;
#endif
void main()
{
  vec2 place = piece.xy + texCoord * piece.zw;
#ifdef FETCHES
  vec4 color = texelFetch(source, ivec2(place * vec2(textureSize(source, 0))), 0);
#else
  vec4 color = texture(source, place);
#endif
#ifdef WRITES_DEPTH
  if (color.a == 0.0)
  {
    discard;
  }
  gl_FragDepth = texture(depths, place).r;
#endif
  color.rgb = clamp(color.rgb * scaleBias.x + color.a * scaleBias.y, 0.0, 1.0);
#ifdef BLENDS
  color += (1.0 - color.a) * texture(behind, place);
#endif
  gl_FragData[0] = color;
}
)";

// Whether the frame buffer has more than 8 bits a channel.
bool IsDeep(vtkOpenGLRenderWindow* window)
{
  vtkOpenGLFramebufferObject* frame = window->GetRenderFramebuffer();
  vtkTextureObject* target = frame->GetNumberOfColorAttachments() > 0 ? frame->GetColorAttachmentAsTextureObject(0) : nullptr;
  return target && target->GetVTKDataType() != VTK_UNSIGNED_CHAR;
}

// While it lives, only the first of the frame buffer's colours is written. A pass such as vtkSSAOPass has others, of places and normals,
// which the picture has not.
class FirstColorOnly
{
public:
  FirstColorOnly()
  {
    GLint most = 1;
    glGetIntegerv(GL_MAX_DRAW_BUFFERS, &most);
    for (int n = 1; n < most; ++n) {
      GLint target = GL_NONE;
      glGetIntegerv(static_cast<GLenum>(GL_DRAW_BUFFER0 + n), &target);
      if (target != GL_NONE) {
        this->Others.push_back(static_cast<GLuint>(n));
        glColorMaski(static_cast<GLuint>(n), GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
      }
    }
  }
  ~FirstColorOnly()
  {
    for (GLuint n : this->Others) {
      glColorMaski(n, GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    }
  }
  FirstColorOnly(const FirstColorOnly&) = delete;
  void operator=(const FirstColorOnly&) = delete;

private:
  std::vector<GLuint> Others;
};

const char* const Unshown = "the picture can't be shown: the render window is not an OpenGL one, or it compiles no shader";
} // namespace

vtkStratusDisplay::vtkStratusDisplay() = default;
vtkStratusDisplay::~vtkStratusDisplay() = default;

void vtkStratusDisplay::ReleaseGraphicsResources(vtkWindow* window)
{
  this->Texture->ReleaseGraphicsResources(window);
  this->Behind->ReleaseGraphicsResources(window);
  this->Depth->ReleaseGraphicsResources(window);
  this->Quads.clear();
  this->Peels.ReleaseGraphicsResources(window);
  this->Peeled = vtkStratusPeels::Picture();
  this->Window = nullptr;
}

vtkStratusDisplay::Part vtkStratusDisplay::ChoosePart(const vtkStratusPicture& picture, const Pixels& pixels)
{
  Part part;
  for (int a = 0; a < 2; ++a) {
    // A coarse picture is interpolated up to its borders, so it is drawn whole.
    const bool coarse = picture.Size[0] != picture.Rectangle[2] || picture.Size[1] != picture.Rectangle[3];
    part.From[a] = coarse ? 0 : pixels.Window[2 * a];
    part.Size[a] = coarse ? picture.Size[a] : pixels.Window[2 * a + 1] - pixels.Window[2 * a];
    part.To[a] = picture.Viewport[a] + picture.Rectangle[a] + part.From[a];
    part.ToSize[a] = coarse ? picture.Rectangle[2 + a] : part.Size[a];
  }
  return part;
}

// Copies pixels to (x, y) of the bound texture.
void vtkStratusDisplay::CopyPixels(
  vtkOpenGLRenderWindow* window, const vtkStratusPicture& picture, const Pixels& pixels, const Part& part, int x, int y)
{
  const size_t first = 4 * (static_cast<size_t>(part.From[1]) * picture.Size[0] + part.From[0]);
  const void* from = pixels.Bytes ? static_cast<const void*>(pixels.Bytes + first) : pixels.Rgba + first;
  vtkOpenGLState* state = window->GetState();
  state->vtkglPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  state->vtkglPixelStorei(GL_UNPACK_ROW_LENGTH, picture.Size[0]);
  glTexSubImage2D(GL_TEXTURE_2D, 0, x, y, part.Size[0], part.Size[1], GL_RGBA, pixels.Bytes ? GL_UNSIGNED_BYTE : GL_FLOAT, from);
  state->vtkglPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
}

// Blends the picture's floats over the bytes behind it, and rounds once. Each loop does the same to all four channels, so that compilers
// make vectors of it.
void vtkStratusDisplay::BlendOver(const vtkStratusPicture& picture, const Pixels& pixels, const Part& part)
{
  const size_t width = 4 * static_cast<size_t>(part.Size[0]);
  const float scale[4] = { 255.0f * pixels.Scale, 255.0f * pixels.Scale, 255.0f * pixels.Scale, 255.0f };
  const float shift[4] = { 255.0f * pixels.Bias, 255.0f * pixels.Bias, 255.0f * pixels.Bias, 0.0f };
  std::vector<float> row(width);
  for (int j = 0; j < part.Size[1]; ++j) {
    const float* from = pixels.Rgba + 4 * (static_cast<size_t>(part.From[1] + j) * picture.Size[0] + part.From[0]);
    unsigned char* to = this->Blended.data() + j * width;
    float* sum = row.data();
    for (size_t at = 0; at < width; ++at) {
      sum[at] = to[at];
    }
    for (size_t at = 0; at < width; at += 4) {
      const float alpha = from[at + 3], left = 1.0f - alpha;
      for (size_t c = 0; c < 4; ++c) {
        const float color = scale[c] * from[at + c] + alpha * shift[c];
        sum[at + c] = left * sum[at + c] + (color < 0.0f ? 0.0f : color > 255.0f ? 255.0f : color);
      }
    }
    for (size_t at = 0; at < width; ++at) {
      const float rounded = sum[at] + 0.5f;
      to[at] = static_cast<unsigned char>(static_cast<int>(rounded > 255.0f ? 255.0f : rounded));
    }
  }
}

// Whether OpenGL runs on the processor, where reading pixels waits for no other device.
bool vtkStratusDisplay::IsSoftware()
{
  const char* renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  const std::string name = renderer ? renderer : "";
  return name.find("llvmpipe") != std::string::npos || name.find("softpipe") != std::string::npos || name.find("SWR") != std::string::npos;
}

// Writes to the frame buffer's texture without drawing. Software OpenGL needs about as long to draw the frame as the core needs to cast the
// rays of a small scene; a copy costs a tenth. If nothing is behind the frame, its bytes are copied. Otherwise, in software OpenGL only,
// the pixels behind are read, blended here and copied back. Returns false if it copied nothing.
bool vtkStratusDisplay::WriteInPlace(
  vtkRenderer* renderer, vtkOpenGLRenderWindow* window, const vtkStratusPicture& picture, const Pixels& pixels, const Part& part)
{
  vtkOpenGLFramebufferObject* frame = window->GetRenderFramebuffer();
  const bool copies = pixels.Bytes && pixels.Alone;
  if ((!copies && !IsSoftware()) || !this->WindowDepth.empty() || renderer->GetPass() || frame->GetMultiSamples() > 0 ||
    window->GetUsingSRGBColorSpace() || part.Size[0] != part.ToSize[0] || part.Size[1] != part.ToSize[1]) {
    return false;
  }
  vtkTextureObject* target = frame->GetNumberOfColorAttachments() > 0 ? frame->GetColorAttachmentAsTextureObject(0) : nullptr;
  if (!target || target->GetTarget() != GL_TEXTURE_2D || target->GetVTKDataType() != VTK_UNSIGNED_CHAR || target->GetComponents() != 4 ||
    part.To[0] < 0 || part.To[1] < 0 || part.To[0] + part.Size[0] > static_cast<int>(target->GetWidth()) ||
    part.To[1] + part.Size[1] > static_cast<int>(target->GetHeight())) {
    return false;
  }
  GLint bound = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
  if (static_cast<unsigned int>(bound) != frame->GetFBOIndex()) {
    return false;
  }
  vtkOpenGLState* state = window->GetState();
  if (!copies) {
    this->Blended.resize(4 * static_cast<size_t>(part.Size[0]) * part.Size[1]);
    state->PushReadFramebufferBinding();
    frame->Bind(GL_READ_FRAMEBUFFER);
    frame->ActivateReadBuffer(0);
    state->vtkglPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(part.To[0], part.To[1], part.Size[0], part.Size[1], GL_RGBA, GL_UNSIGNED_BYTE, this->Blended.data());
    state->PopReadFramebufferBinding();
    this->BlendOver(picture, pixels, part);
  }
  target->Activate();
  if (copies) {
    CopyPixels(window, picture, pixels, part, part.To[0], part.To[1]);
  } else {
    state->vtkglPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexSubImage2D(GL_TEXTURE_2D, 0, part.To[0], part.To[1], part.Size[0], part.Size[1], GL_RGBA, GL_UNSIGNED_BYTE, this->Blended.data());
  }
  target->Deactivate();
  return true;
}

// Copies the pixels behind the frame, so that the shader can blend and round once. Software OpenGL rounds three times when it blends, which
// costs up to 1.3 of 255. Returns false if multisampling or a render pass separates the frame from the frame buffer; the frame buffer then
// blends.
bool vtkStratusDisplay::CopyBehind(vtkRenderer* renderer, vtkOpenGLRenderWindow* window, const Part& part)
{
  if (renderer->GetPass() || window->GetRenderFramebuffer()->GetMultiSamples() > 0) {
    return false;
  }
  const unsigned int width = static_cast<unsigned int>(part.ToSize[0]), height = static_cast<unsigned int>(part.ToSize[1]);
  this->Behind->SetContext(window);
  if (this->Behind->GetWidth() != width || this->Behind->GetHeight() != height) {
    if (!this->Behind->Create2D(width, height, 4, VTK_UNSIGNED_CHAR, false)) {
      return false;
    }
  }
  this->Behind->Activate();
  this->Behind->CopyFromFrameBuffer(part.To[0], part.To[1], 0, 0, part.ToSize[0], part.ToSize[1]);
  return true;
}

bool vtkStratusDisplay::Upload(vtkOpenGLRenderWindow* window, const vtkStratusPicture& picture, const Pixels& pixels, const Part& part)
{
  const unsigned int width = static_cast<unsigned int>(part.Size[0]), height = static_cast<unsigned int>(part.Size[1]);
  const int type = pixels.Bytes ? VTK_UNSIGNED_CHAR : VTK_FLOAT;
  this->Texture->SetContext(window);
  this->Texture->SetWrapS(vtkTextureObject::ClampToEdge);
  this->Texture->SetWrapT(vtkTextureObject::ClampToEdge);
  const bool coarse = part.Size[0] != part.ToSize[0] || part.Size[1] != part.ToSize[1];
  // Depths are not interpolated, so colours must not be, either.
  const bool writesDepth = !this->WindowDepth.empty() && this->Stage != vtkStratusPeels::FIRST;
  const int filter = coarse && !writesDepth && pixels.Rgba != this->Selected.data() ? vtkTextureObject::Linear : vtkTextureObject::Nearest;
  this->Texture->SetMinificationFilter(filter);
  this->Texture->SetMagnificationFilter(filter);
  if (!this->Texture->GetHandle() || this->Texture->GetWidth() != width || this->Texture->GetHeight() != height ||
    this->Texture->GetVTKDataType() != type) {
    if (!this->Texture->Create2D(width, height, 4, type, false)) {
      return false;
    }
  }
  this->Texture->Activate();
  CopyPixels(window, picture, pixels, part, 0, 0);
  return this->WindowDepth.empty() || this->UploadDepth(window, picture, part);
}

// Returns nullptr where the shader does not compile.
vtkOpenGLQuadHelper* vtkStratusDisplay::PrepareQuad(vtkOpenGLRenderWindow* window, const QuadKind& kind)
{
  const int number = (kind.WritesDepth ? 1 : 0) + (kind.Fetches ? 2 : 0) + (kind.Blends ? 4 : 0);
  std::unique_ptr<vtkOpenGLQuadHelper>& quad = this->Quads[number];
  if (!quad) {
    const std::string shader = FragmentShader;
    const size_t first = shader.find('\n') + 1; // the #version replaces the first line, and a #define must follow it
    std::string defines;
    defines += kind.WritesDepth ? "#define WRITES_DEPTH\n" : "";
    defines += kind.Fetches ? "#define FETCHES\n" : "";
    defines += kind.Blends ? "#define BLENDS\n" : "";
    quad.reset(new vtkOpenGLQuadHelper(window, nullptr, (shader.substr(0, first) + defines + shader.substr(first)).c_str(), ""));
  } else {
    window->GetShaderCache()->ReadyShaderProgram(quad->Program);
  }
  return quad->Program && quad->Program->GetCompiled() ? quad.get() : nullptr;
}

bool vtkStratusDisplay::UploadDepth(vtkOpenGLRenderWindow* window, const vtkStratusPicture& picture, const Part& part)
{
  const unsigned int width = static_cast<unsigned int>(part.Size[0]), height = static_cast<unsigned int>(part.Size[1]);
  this->Depth->SetContext(window);
  this->Depth->SetMinificationFilter(vtkTextureObject::Nearest);
  this->Depth->SetMagnificationFilter(vtkTextureObject::Nearest);
  if (!this->Depth->GetHandle() || this->Depth->GetWidth() != width || this->Depth->GetHeight() != height) {
    if (!this->Depth->Create2D(width, height, 1, VTK_FLOAT, false)) {
      return false;
    }
  }
  this->Depth->Activate();
  vtkOpenGLState* state = window->GetState();
  state->vtkglPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  state->vtkglPixelStorei(GL_UNPACK_ROW_LENGTH, picture.Size[0]);
  const float* from = this->WindowDepth.data() + static_cast<size_t>(part.From[1]) * picture.Size[0] + part.From[0];
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, part.Size[0], part.Size[1], GL_RED, GL_FLOAT, from);
  state->vtkglPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
  return true;
}

// Finds the part of each stretch of PieceRows rows, from its first to its last pixel that is not empty. Software OpenGL takes about as long
// to blend an empty pixel over eight samples as one that shows.
std::vector<vtkStratusDisplay::Piece> vtkStratusDisplay::FindPieces(
  const vtkStratusPicture& picture, const Pixels& pixels, const Part& part)
{
  const int width = part.Size[0];
  std::vector<Piece> pieces;
  for (int y = 0; y < part.Size[1]; y += PieceRows) {
    Piece piece = { { width, y }, { 0, std::min(PieceRows, part.Size[1] - y) } };
    int beyond = 0;
    for (int j = y; j < y + piece.Size[1]; ++j) {
      const size_t first = static_cast<size_t>(part.From[1] + j) * picture.Size[0] + part.From[0];
      const auto isEmpty = [&](int x) {
        const size_t alpha = 4 * (first + x) + 3;
        return pixels.Bytes ? pixels.Bytes[alpha] == 0 : pixels.Rgba[alpha] == 0.0f;
      };
      int from = 0, to = width;
      while (from < piece.From[0] && isEmpty(from)) {
        ++from;
      }
      while (to > beyond && isEmpty(to - 1)) {
        --to;
      }
      piece.From[0] = from;
      beyond = to;
    }
    piece.Size[0] = beyond - piece.From[0];
    if (piece.Size[0] > 0) {
      pieces.push_back(piece);
    }
  }
  return pieces;
}

bool vtkStratusDisplay::Blend(
  vtkRenderer* renderer, vtkOpenGLRenderWindow* window, const vtkStratusPicture& picture, const Pixels& pixels, const Part& part)
{
  vtkOpenGLState* state = window->GetState();
  const bool writesDepth = !this->WindowDepth.empty();
  vtkOpenGLState::ScopedglViewport viewport(state);
  vtkOpenGLState::ScopedglScissor scissor(state);
  vtkOpenGLState::ScopedglEnableDisable depthTest(state, GL_DEPTH_TEST);
  vtkOpenGLState::ScopedglEnableDisable blend(state, GL_BLEND);
  vtkOpenGLState::ScopedglBlendFuncSeparate blendFunction(state);
  vtkOpenGLState::ScopedglDepthMask depthMask(state);
  const FirstColorOnly firstColor;
  state->vtkglViewport(part.To[0], part.To[1], part.ToSize[0], part.ToSize[1]);
  state->vtkglScissor(part.To[0], part.To[1], part.ToSize[0], part.ToSize[1]);
  // The rays end at the opaque depth, so that no depth test is needed. Depth is only written with the test enabled.
  if (writesDepth) {
    state->vtkglEnable(GL_DEPTH_TEST);
    state->vtkglDepthFunc(GL_ALWAYS);
  } else {
    state->vtkglDisable(GL_DEPTH_TEST);
  }
  state->vtkglDepthMask(writesDepth ? GL_TRUE : GL_FALSE);
  QuadKind kind;
  kind.WritesDepth = writesDepth;
  kind.Fetches = part.Size[0] == part.ToSize[0] && part.Size[1] == part.ToSize[1];
  kind.Blends = !pixels.Bytes && this->CopyBehind(renderer, window, part);
  vtkOpenGLQuadHelper* quad = this->PrepareQuad(window, kind);
  if (!kind.Blends) {
    state->vtkglEnable(GL_BLEND);
    state->vtkglBlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  } else {
    state->vtkglDisable(GL_BLEND);
  }
  if (quad) {
    const float scaleBias[2] = { pixels.Scale, pixels.Bias };
    quad->Program->SetUniformi("source", this->Texture->GetTextureUnit());
    quad->Program->SetUniform2f("scaleBias", scaleBias);
    if (kind.Blends) {
      quad->Program->SetUniformi("behind", this->Behind->GetTextureUnit());
    }
    if (writesDepth) {
      quad->Program->SetUniformi("depths", this->Depth->GetTextureUnit());
    }
    std::vector<Piece> pieces = { { { 0, 0 }, { part.ToSize[0], part.ToSize[1] } } };
    if (kind.Fetches && window->GetRenderFramebuffer()->GetMultiSamples() > 0) {
      pieces = FindPieces(picture, pixels, part);
    }
    for (const Piece& piece : pieces) {
      float place[4];
      for (int a = 0; a < 2; ++a) {
        place[a] = static_cast<float>(piece.From[a]) / static_cast<float>(part.ToSize[a]);
        place[2 + a] = static_cast<float>(piece.Size[a]) / static_cast<float>(part.ToSize[a]);
      }
      state->vtkglViewport(part.To[0] + piece.From[0], part.To[1] + piece.From[1], piece.Size[0], piece.Size[1]);
      quad->Program->SetUniform4f("piece", place);
      quad->Render();
    }
  }
  if (writesDepth) {
    state->vtkglDepthFunc(GL_LEQUAL); // VTK's default
  }
  if (kind.Blends) {
    this->Behind->Deactivate();
  }
  return quad != nullptr;
}

vtkStratusPeels::Draw vtkStratusDisplay::ChooseStage(vtkRenderer* renderer, vtkProp* prop, vtkAbstractMapper* mapper)
{
  vtkOpenGLRenderWindow* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
  vtkStratusTarget target;
  target.Find(renderer);
  const bool outside = window && target.Buffer == 0 && window->GetRenderFramebuffer()->GetMultiSamples() > 0;
  const vtkStratusPeels::Draw stage = this->Peels.Begin(prop, mapper);
  if (stage == vtkStratusPeels::FIRST && outside) {
    return vtkStratusPeels::OUTSIDE;
  }
  if (stage == vtkStratusPeels::LATER && !outside && prop != this->PeeledProp) {
    return vtkStratusPeels::FIRST;
  }
  return stage;
}

bool vtkStratusDisplay::DrawPixels(vtkRenderer* renderer, const vtkStratusPicture& picture, const Pixels& pixels)
{
  vtkOpenGLRenderWindow* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
  if (!window) {
    return false;
  }
  const Part part = ChoosePart(picture, pixels);
  const bool peeled = this->Stage == vtkStratusPeels::FIRST;
  if (part.Size[0] <= 0 || part.Size[1] <= 0 || (!peeled && this->WriteInPlace(renderer, window, picture, pixels, part))) {
    return true;
  }
  if (this->Window && this->Window != window) {
    this->ReleaseGraphicsResources(this->Window);
  }
  this->Window = window;
  bool drawn = this->Upload(window, picture, pixels, part);
  if (drawn && peeled) {
    this->Peeled.Colors = this->Texture;
    this->Peeled.Depths = this->Depth;
    for (int a = 0; a < 2; ++a) {
      this->Peeled.To[a] = part.To[a] - picture.Viewport[a];
      this->Peeled.Size[a] = part.ToSize[a];
      this->Peeled.Viewport[a] = picture.Viewport[2 + a];
    }
    this->Peeled.Cast = renderer->GetSelector() ? nullptr : pixels.Cast;
    for (int a = 0; a < 2 && this->Peeled.Cast; ++a) { // parts are of the whole picture
      this->Peeled.To[a] = picture.Rectangle[a];
      this->Peeled.Size[a] = picture.Rectangle[2 + a];
      this->Peeled.Rays[a] = picture.Size[a];
    }
    this->Peeled.Scale = pixels.Scale;
    this->Peeled.Bias = pixels.Bias;
    drawn = this->DrawPeeled();
  } else if (drawn) {
    const std::unique_ptr<vtkStratusPeels::Outside> frame(
      this->Stage == vtkStratusPeels::OUTSIDE ? new vtkStratusPeels::Outside(window) : nullptr);
    drawn = this->Blend(renderer, window, picture, pixels, part);
  }
  if (!this->WindowDepth.empty()) {
    this->Depth->Deactivate();
  }
  this->Texture->Deactivate();
  return drawn;
}

bool vtkStratusDisplay::DrawPeeled()
{
  return !this->Peeled.Colors || this->Peels.Render(this->Window, this->Peeled);
}

bool vtkStratusDisplay::Begin(
  vtkRenderer* renderer, vtkProp* prop, vtkAbstractMapper* mapper, const std::string& lastError, std::string& error)
{
  this->Stage = this->ChooseStage(renderer, prop, mapper);
  if (this->Stage == vtkStratusPeels::LATER) {
    error = this->DrawPeeled() ? lastError : Unshown;
    return false;
  }
  this->Peeled = vtkStratusPeels::Picture();
  this->PeeledProp = prop;
  return true;
}

// Bytes are precise enough on a black background, because no blend rounds after them, and in a window with multisampling, whose frame
// buffer rounds to bytes before it blends. A frame buffer with more bits a channel than bytes have takes floats.
vtkStratusDisplay::Pixels vtkStratusDisplay::ChoosePixels(vtkRenderer* renderer, const vtkStratusPicture::Others& others, float finalWindow,
  float finalLevel, const std::vector<unsigned char>& bytes)
{
  Pixels pixels;
  pixels.Scale = 1.0f / finalWindow;
  pixels.Bias = 0.5f - finalLevel * pixels.Scale;
  const double* background = renderer->GetBackground();
  const bool onBlack = !others.Geometry && !renderer->GetGradientBackground() && !renderer->GetTexturedBackground() &&
    background[0] == 0.0 && background[1] == 0.0 && background[2] == 0.0 && renderer->GetLayer() == 0;
  auto* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
  const bool blends = window && window->GetRenderFramebuffer()->GetMultiSamples() > 0 && !renderer->GetPass();
  if ((onBlack || blends) && !(window && IsDeep(window)) && !renderer->GetSelector() && pixels.Scale == 1.0f && pixels.Bias == 0.0f) {
    pixels.Bytes = bytes.data();
  }
  pixels.Alone = !others.Any && !renderer->GetPreserveColorBuffer() && !renderer->GetSelector() && renderer->GetBackgroundAlpha() == 0.0;
  return pixels;
}

namespace {
// The columns and rows of rays whose pixels a selector reads, from `first` on, before `end`. area: first column and row of the window, and
// the last ones. A ray more on each side is for pixels that a coarse picture's rays share.
void FindRead(const vtkStratusPicture& picture, const unsigned int area[4], size_t first[2], size_t end[2])
{
  for (int a = 0; a < 2; ++a) {
    const double from = picture.Viewport[a] + picture.Rectangle[a], most = picture.Size[a], rays = most / picture.Rectangle[2 + a];
    first[a] = static_cast<size_t>(std::clamp(std::floor((area[a] - from) * rays) - 1.0, 0.0, most));
    end[a] = static_cast<size_t>(std::clamp(std::ceil((area[2 + a] + 1.0 - from) * rays) + 1.0, 0.0, most));
  }
}
} // namespace

// Hardware picking reads the window, in one pass for the prop, others for the block in composite data, the cell or point, the process.
void vtkStratusDisplay::ChooseSelected(vtkRenderer* renderer, const vtkStratusPicture& picture, Pixels& pixels)
{
  vtkHardwareSelector* selector = renderer->GetSelector();
  const int pass = selector->GetCurrentPass();
  const bool points = selector->GetFieldAssociation() == vtkDataObject::FIELD_ASSOCIATION_POINTS;
  const int low = points ? vtkHardwareSelector::POINT_ID_LOW24 : vtkHardwareSelector::CELL_ID_LOW24;
  const int high = points ? vtkHardwareSelector::POINT_ID_HIGH24 : vtkHardwareSelector::CELL_ID_HIGH24;
  const bool ofProp = pass == vtkHardwareSelector::ACTOR_PASS || pass == vtkHardwareSelector::PROCESS_PASS;
  const bool ofBlock = pass == vtkHardwareSelector::COMPOSITE_INDEX_PASS && pixels.Finder && pixels.Finder->HasBlocks();
  const bool ofElement = (pass == low || pass == high) && pixels.Finder;
  float color[3] = { 0.0f, 0.0f, 0.0f };
  selector->BeginRenderProp();
  if (pixels.Finder) { // more than 24 bits take another pass
    selector->UpdateMaximumPointId(pixels.Finder->GetMost());
    selector->UpdateMaximumCellId(pixels.Finder->GetMost());
  }
  if (ofProp) {
    selector->GetPropColorValue(color);
  }
  // A selector that does not know the prop gives it no colour, and it hides nothing.
  const bool known = pass != vtkHardwareSelector::ACTOR_PASS || color[0] > 0.0f || color[1] > 0.0f || color[2] > 0.0f;
  this->Selected.assign(4 * static_cast<size_t>(picture.Size[0]) * picture.Size[1], 0.0f);
  size_t first[2], end[2];
  FindRead(picture, selector->GetArea(), first, end);
  const size_t width = static_cast<size_t>(picture.Size[0]);
  for (size_t row = first[1]; known && row < end[1]; ++row) {
    for (size_t ray = row * width + first[0]; ray < row * width + end[0]; ++ray) {
      if (!(pixels.Rgba[4 * ray + 3] > LEAST_SELECTED)) {
        continue;
      }
      if (ofBlock || ofElement) {
        double place[3], direction[3];
        picture.FindPlace(ray, (*pixels.Depth)[ray], place, direction);
        const vtkStratusCellFinder::Found found = pixels.Finder->Find(place, direction, points);
        const vtkIdType number = ofBlock ? static_cast<vtkIdType>(found.Block) : std::max<vtkIdType>(found.Element, 0);
        for (int c = 0; c < 3; ++c) {
          color[c] = static_cast<float>(number >> (8 * c + (pass == high ? 24 : 0)) & 255) / 255.0f;
        }
      }
      std::copy_n(color, 3, &this->Selected[4 * ray]);
      this->Selected[4 * ray + 3] = 1.0f;
    }
  }
  pixels.Rgba = this->Selected.data();
  pixels.Scale = 1.0f;
  pixels.Bias = 0.0f;
  // Where the selector keeps depths from pass to pass, as for points, a prop's own would hide it from the next one.
  pixels.WritesDepth = !renderer->GetPreserveDepthBuffer();
}

namespace {
// The levels of a screen, between which lines are drawn: within .03 of 255 of stratus_screen_level().
class ScreenLevels
{
public:
  ScreenLevels()
  {
    for (int i = 0; i <= Count; ++i) {
      this->Levels[i] = static_cast<float>(stratus_screen_level(static_cast<double>(i) / Count));
    }
    this->Levels[Count + 1] = this->Levels[Count];
  }
  float Find(float linear) const
  {
    const float at = std::min(std::max(linear, 0.0f), 1.0f) * Count;
    const int before = static_cast<int>(at);
    return this->Levels[before] + (at - static_cast<float>(before)) * (this->Levels[before + 1] - this->Levels[before]);
  }

private:
  static constexpr int Count = 4096;
  float Levels[Count + 2];
};

void EncodeForScreen(float* rgba, size_t pixels)
{
  static const ScreenLevels levels;
  for (size_t pixel = 0; pixel < pixels; ++pixel, rgba += 4) {
    for (int c = 0; rgba[3] > 0.0f && c < 3; ++c) {
      rgba[c] = rgba[3] * levels.Find(rgba[c] / rgba[3]);
    }
  }
}
} // namespace

void vtkStratusDisplay::Encode(const vtkStratusPicture& picture, Pixels& pixels)
{
  const size_t count = static_cast<size_t>(picture.Size[0]) * picture.Size[1];
  this->Encoded.assign(pixels.Rgba, pixels.Rgba + 4 * count);
  EncodeForScreen(this->Encoded.data(), count);
  pixels.Rgba = this->Encoded.data();
  pixels.Bytes = nullptr;
  if (pixels.Cast) {
    pixels.Cast = [cast = pixels.Cast](const float* depths, std::vector<float>& rgba) {
      const bool done = cast(depths, rgba);
      EncodeForScreen(rgba.data(), rgba.size() / 4);
      return done;
    };
  }
}

bool vtkStratusDisplay::Draw(vtkRenderer* renderer, const vtkStratusPicture& picture, const Pixels& wanted, std::string& error)
{
  Pixels pixels = wanted;
  vtkHardwareSelector* selector = renderer->GetSelector();
  if (selector && pixels.Rgba) {
    this->ChooseSelected(renderer, picture, pixels);
  } else if (pixels.Encodes && pixels.Rgba) {
    this->Encode(picture, pixels);
  }
  this->WindowDepth.clear();
  if (pixels.WritesDepth || this->Stage == vtkStratusPeels::FIRST) { // peels are distinguished by depth
    picture.ToWindowDepth(*pixels.Depth, this->WindowDepth);
  }
  const bool drawn = this->DrawPixels(renderer, picture, pixels);
  if (selector && wanted.Rgba) {
    selector->EndRenderProp();
  }
  if (!drawn) {
    error = Unshown;
  }
  return drawn;
}
