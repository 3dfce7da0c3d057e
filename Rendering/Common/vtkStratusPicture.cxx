// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusPicture.h"

#include "vtkAbstractMapper.h"
#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkMapper.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkPlane.h"
#include "vtkPlaneCollection.h"
#include "vtkPointData.h"
#include "vtkPropCollection.h"
#include "vtkProperty.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkShaderProperty.h"
#include "vtkTypeUInt32Array.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace {
// The rays of a camera's whole window in view coordinates. They are computed only from the projection, whose numbers are small, and then
// moved to the world. Inverting the composite matrix would cost digits far from the origin.
struct ViewRays {
  double Eye[3], Forward[3], Right[3], Up[3], Near, Far;
};

bool Unproject(const double inverse[16], double u, double v, double z, double point[3])
{
  const double window[4] = { u, v, z, 1.0 };
  double result[4];
  vtkMatrix4x4::MultiplyPoint(inverse, window, result);
  for (int a = 0; a < 3; ++a) {
    point[a] = result[a] / result[3];
  }
  return std::isfinite(point[0]) && std::isfinite(point[1]) && std::isfinite(point[2]);
}

// Finds the rays of a projection. In all of VTK's projections, sheared ones too, planes of constant depth are perpendicular to the view's z
// axis. The distance k to the eye's plane therefore runs along -z. Returns false where the projection is degenerate.
bool UnprojectRays(vtkMatrix4x4* projection, bool parallel, ViewRays& rays)
{
  double inverse[16];
  vtkMatrix4x4::Invert(&projection->Element[0][0], inverse);
  double nearCenter[3], farCenter[3], nearRight[3], nearUp[3];
  if (!Unproject(inverse, 0, 0, -1, nearCenter) || !Unproject(inverse, 0, 0, 1, farCenter) || !Unproject(inverse, 1, 0, -1, nearRight) ||
    !Unproject(inverse, 0, 1, -1, nearUp)) {
    return false;
  }
  const double depth = nearCenter[2] - farCenter[2];
  double eyeZ = 0.0;
  double scale = 1.0;
  if (!parallel) { // the eye is where x, y and w vanish: the inverse's third column
    eyeZ = inverse[10] / inverse[14];
    scale = 1.0 / (eyeZ - nearCenter[2]);
  }
  rays.Near = eyeZ - nearCenter[2];
  rays.Far = eyeZ - farCenter[2];
  for (int a = 0; a < 3; ++a) {
    rays.Forward[a] = (farCenter[a] - nearCenter[a]) / depth;
    rays.Right[a] = (nearRight[a] - nearCenter[a]) * scale;
    rays.Up[a] = (nearUp[a] - nearCenter[a]) * scale;
    rays.Eye[a] = nearCenter[a] - rays.Near * rays.Forward[a];
  }
  return depth > 0.0 && (parallel || rays.Near > 0.0) && std::isfinite(scale);
}

// Moves the rays of a part of the window to the world. The part's coordinate u is center[0] + half[0] u in the window.
void PlaceRays(vtkMatrix4x4* view, const ViewRays& rays, const double center[2], const double half[2], stratus_camera& camera)
{
  double inverse[16];
  vtkMatrix4x4::Invert(&view->Element[0][0], inverse);
  for (int a = 0; a < 3; ++a) {
    const double* row = inverse + 4 * a;
    const auto turn = [row](const double vector[3]) { return row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2]; };
    const double right = turn(rays.Right), up = turn(rays.Up);
    const double sideways = center[0] * right + center[1] * up;
    camera.eye[a] = row[3] + turn(rays.Eye) + (camera.parallel ? sideways : 0.0);
    camera.forward[a] = turn(rays.Forward) + (camera.parallel ? 0.0 : sideways);
    camera.right[a] = half[0] * right;
    camera.up[a] = half[1] * up;
  }
  camera.near_k = camera.parallel ? rays.Near : std::max(0.0, rays.Near);
  camera.far_k = rays.Far;
}

// Finds the drawn box along the grid's axes, as origin + spacing * index. `margin` is in voxels, of the first and last spacing.
void LocalBox(const stratus_volume& volume, const double* crop, double margin, double box[6])
{
  for (int a = 0; a < 3; ++a) {
    const double cells = static_cast<double>(volume.dimensions[a] - (volume.cell_centered ? 0 : 1));
    const double* x = volume.coordinates[a];
    const double last = x ? x[static_cast<size_t>(cells)] : 0.0;
    const double begin = volume.origin[a] + (x ? std::min(x[0], last) : 0.0);
    const double spacing = x ? std::fabs(last - x[0]) / cells : volume.spacing[a];
    const size_t end = static_cast<size_t>(cells);
    double below = x ? std::fabs(x[1] - x[0]) : spacing, above = x ? std::fabs(x[end] - x[end - 1]) : spacing;
    if (x && last < x[0]) {
      std::swap(below, above);
    }
    box[2 * a] = begin - below * margin;
    box[2 * a + 1] = begin + spacing * cells + above * margin;
    if (crop) {
      box[2 * a] = std::max(box[2 * a], crop[2 * a]);
      box[2 * a + 1] = std::min(box[2 * a + 1], crop[2 * a + 1]);
    }
  }
}

void CornerToWorld(const stratus_volume& volume, const double box[6], int corner, double world[4])
{
  double offset[3];
  double local[4] = { 0, 0, 0, 1 };
  for (int a = 0; a < 3; ++a) {
    offset[a] = box[2 * a + ((corner >> a) & 1)] - volume.origin[a];
  }
  for (int a = 0; a < 3; ++a) {
    const double* row = volume.direction + 3 * a;
    local[a] = volume.origin[a] + row[0] * offset[0] + row[1] * offset[1] + row[2] * offset[2];
  }
  vtkMatrix4x4::MultiplyPoint(volume.matrix, local, world);
}

// Finds the pixels of a viewport that the hull of eight points may cover, and `margin` more on each side: x0, x1, y0, y1.
void ProjectCorners(const double worldToClip[16], const double corners[8][4], const int viewport[2], double margin, int part[4])
{
  double low[2] = { 1, 1 }, high[2] = { -1, -1 };
  for (int corner = 0; corner < 8; ++corner) {
    double clip[4];
    vtkMatrix4x4::MultiplyPoint(worldToClip, corners[corner], clip);
    if (!(clip[3] > 0.0) || clip[2] < -clip[3]) { // a box that reaches the near plane may cover any pixel
      low[0] = low[1] = -1;
      high[0] = high[1] = 1;
      break;
    }
    for (int a = 0; a < 2; ++a) {
      low[a] = std::min(low[a], clip[a] / clip[3]);
      high[a] = std::max(high[a], clip[a] / clip[3]);
    }
  }
  for (int a = 0; a < 2; ++a) {
    const int pixels = viewport[a];
    const double first = std::floor((low[a] + 1) * 0.5 * pixels) - margin;
    const double last = std::ceil((high[a] + 1) * 0.5 * pixels) + margin;
    part[2 * a] = static_cast<int>(std::min<double>(std::max(first, 0.0), pixels));
    part[2 * a + 1] = static_cast<int>(std::min<double>(std::max(last, 0.0), pixels));
  }
}

// Whether a prop draws nothing outside its bounds, but for the width of lines and points. Of subclasses, and of other mappers, whose
// shaders may widen what they draw, this is not known.
bool KeepsToBounds(vtkProp* prop)
{
  static const char* const mappers[] = { "vtkOpenGLPolyDataMapper", "vtkCompositePolyDataMapper2", "vtkDataSetMapper" };
  vtkActor* actor = vtkActor::SafeDownCast(prop);
  if (!actor || std::strcmp(actor->GetClassName(), "vtkOpenGLActor") != 0 || !actor->GetMapper() ||
    actor->GetShaderProperty()->HasVertexShaderCode() || actor->GetShaderProperty()->HasGeometryShaderCode() ||
    actor->GetShaderProperty()->GetNumberOfShaderReplacements() > 0) {
    return false;
  }
  return std::any_of(std::begin(mappers), std::end(mappers),
    [actor](const char* name) { return std::strcmp(actor->GetMapper()->GetClassName(), name) == 0; });
}
} // namespace

void vtkStratusPicture::SetRectangle(const std::vector<Box>& boxes, bool solid)
{
  int all[4] = { this->Viewport[2], 0, this->Viewport[3], 0 };
  for (const Box& of : boxes) {
    double box[6], corners[8][4];
    int part[4];
    LocalBox(*of.Volume, of.Crop, solid && !of.Volume->cell_centered ? 0.5 : 0.0, box);
    for (int corner = 0; corner < 8; ++corner) {
      CornerToWorld(*of.Volume, box, corner, corners[corner]);
    }
    ProjectCorners(this->WorldToClip, corners, this->Viewport + 2, 1, part); // one pixel more, for rounding
    for (int a = 0; a < 4; a += 2) {
      all[a] = std::min(all[a], part[a]);
      all[a + 1] = std::max(all[a + 1], part[a + 1]);
    }
  }
  if (this->TakesShadows) {
    all[0] = all[2] = 0;
    all[1] = this->Viewport[2];
    all[3] = this->Viewport[3];
  }
  for (int a = 0; a < 2; ++a) {
    this->Rectangle[a] = all[2 * a];
    this->Rectangle[2 + a] = std::max(0, all[2 * a + 1] - all[2 * a]);
  }
}

bool vtkStratusPicture::Set(vtkRenderer* renderer, const stratus_volume& volume, const double* crop, double coarseness, bool solid)
{
  return this->Set(renderer, { { &volume, crop } }, coarseness, solid);
}

bool vtkStratusPicture::Set(vtkRenderer* renderer, const std::vector<Box>& boxes, double coarseness, bool solid)
{
  this->Target.Find(renderer);
  std::copy_n(this->Target.Viewport, 4, this->Viewport);
  vtkCamera* camera = renderer->GetActiveCamera();
  vtkMatrix4x4* view = camera->GetModelViewTransformMatrix();
  vtkMatrix4x4* projection = camera->GetProjectionTransformMatrix(renderer->GetTiledAspectRatio(), -1, 1);
  vtkMatrix4x4::Multiply4x4(&projection->Element[0][0], &view->Element[0][0], this->WorldToClip);
  this->SetRectangle(boxes, solid);
  double center[2], half[2];
  for (int a = 0; a < 2; ++a) {
    const double pixels = this->Viewport[2 + a];
    this->Size[a] = static_cast<int>(std::ceil(this->Rectangle[2 + a] / std::max(1.0, coarseness)));
    center[a] = (2.0 * this->Rectangle[a] + this->Rectangle[2 + a]) / pixels - 1.0;
    half[a] = this->Rectangle[2 + a] / pixels;
  }
  this->Camera = stratus_camera();
  // An off-axis projection is perspective whatever the camera's flag says.
  this->Camera.parallel = projection->GetElement(3, 2) == 0.0 ? 1 : 0;
  ViewRays rays;
  if (!UnprojectRays(projection, this->Camera.parallel != 0, rays)) {
    return false;
  }
  PlaceRays(view, rays, center, half, this->Camera);
  return true;
}

// ---------------------------------------------------------------- values per ray

// Adds the pixels to a part that a prop may write depth to. An axes actor's bounds also include axes that point backwards from the origin,
// wherever it is. Its parts are therefore queried instead.
void vtkStratusPicture::FindPart(vtkProp* prop, int part[4]) const
{
  int found[4] = { 0, this->Viewport[2], 0, this->Viewport[3] };
  if (std::strcmp(prop->GetClassName(), "vtkAxesActor") == 0) {
    vtkNew<vtkPropCollection> parts;
    prop->GetActors(parts);
    vtkCollectionSimpleIterator iterator;
    parts->InitTraversal(iterator);
    while (vtkProp* one = parts->GetNextProp(iterator)) {
      this->FindPart(one, part);
    }
    return;
  }
  if (KeepsToBounds(prop)) {
    const double* bounds = prop->GetBounds();
    if (!bounds || bounds[0] > bounds[1]) { // no points
      return;
    }
    double corners[8][4];
    for (int corner = 0; corner < 8; ++corner) {
      for (int a = 0; a < 3; ++a) {
        corners[corner][a] = bounds[2 * a + (corner >> a & 1)];
      }
      corners[corner][3] = 1.0;
    }
    vtkProperty* property = vtkActor::SafeDownCast(prop)->GetProperty();
    const double width = std::max(property->GetLineWidth(), property->GetPointSize());
    ProjectCorners(this->WorldToClip, corners, this->Viewport + 2, 2.0 + width, found);
  }
  if (found[0] < found[1] && found[2] < found[3]) {
    const bool none = part[0] == part[1];
    for (int a = 0; a < 4; a += 2) {
      part[a] = none ? found[a] : std::min(part[a], found[a]);
      part[a + 1] = none ? found[a + 1] : std::max(part[a + 1], found[a + 1]);
    }
  }
}

vtkStratusPicture::Others vtkStratusPicture::FindOthers(
  vtkRenderer* renderer, vtkProp* prop, const std::function<bool(vtkProp*)>& endsNoRay) const
{
  Others others;
  others.Geometry = renderer->GetPreserveDepthBuffer() || !renderer->GetErase() || renderer->GetPass() || renderer->GetUseDepthPeeling();
  if (others.Geometry) {
    others.Part[1] = this->Viewport[2];
    others.Part[3] = this->Viewport[3];
  }
  vtkPropCollection* props = renderer->GetViewProps();
  vtkCollectionSimpleIterator iterator;
  props->InitTraversal(iterator);
  while (vtkProp* other = props->GetNextProp(iterator)) {
    if (other != prop && other->GetVisibility()) {
      if (!other->IsA("vtkActor2D") && (renderer->GetSelector() || !endsNoRay(other))) { // all write depth while the renderer picks
        others.Geometry = true;
        this->FindPart(other, others.Part);
      }
      others.Any = true;
    }
  }
  return others;
}

const float* vtkStratusPicture::ReadOpaqueDepth(vtkRenderer* renderer, const Others& others)
{
  this->Ends = nullptr;
  const int* rectangle = this->Rectangle;
  int from[2], size[2];
  for (int a = 0; a < 2; ++a) {
    from[a] = std::max(others.Part[2 * a], rectangle[a]);
    size[a] = std::min(others.Part[2 * a + 1], rectangle[a] + rectangle[2 + a]) - from[a];
  }
  if (!others.Geometry || size[0] <= 0 || size[1] <= 0) {
    return nullptr;
  }
  const int x = this->Viewport[0] + from[0], y = this->Viewport[1] + from[1];
  this->PartDepth.resize(static_cast<size_t>(size[0]) * size[1]);
  this->Target.ReadDepth(renderer, x, y, size[0], size[1], this->PartDepth.data());
  if (size[0] == rectangle[2] && size[1] == rectangle[3]) {
    this->WindowDepth.swap(this->PartDepth);
  } else {
    this->WindowDepth.assign(static_cast<size_t>(rectangle[2]) * rectangle[3], 1.0f);
    for (int j = 0; j < size[1]; ++j) {
      const size_t to = static_cast<size_t>(from[1] - rectangle[1] + j) * rectangle[2] + (from[0] - rectangle[0]);
      std::copy_n(this->PartDepth.data() + static_cast<size_t>(j) * size[0], size[0], this->WindowDepth.data() + to);
    }
  }
  if (this->Size[0] == rectangle[2] && this->Size[1] == rectangle[3]) {
    this->Ends = this->WindowDepth.data();
    return this->Ends;
  }
  this->OpaqueDepth.resize(static_cast<size_t>(this->Size[0]) * this->Size[1]);
  for (int j = 0; j < this->Size[1]; ++j) {
    const size_t row = static_cast<size_t>((j + 0.5) * rectangle[3] / this->Size[1]) * rectangle[2];
    for (int i = 0; i < this->Size[0]; ++i) {
      const size_t column = static_cast<size_t>((i + 0.5) * rectangle[2] / this->Size[0]);
      this->OpaqueDepth[static_cast<size_t>(j) * this->Size[0] + i] = this->WindowDepth[row + column];
    }
  }
  this->Ends = this->OpaqueDepth.data();
  return this->Ends;
}

bool vtkStratusPicture::IsWhole(const float* depths) const
{
  constexpr float rounding = 1e-7f; // of a depth buffer of 24 bits, read in two ways
  const size_t count = static_cast<size_t>(this->Size[0]) * static_cast<size_t>(this->Size[1]);
  size_t ray = 0;
  while (ray < count && depths[ray] >= (this->Ends ? this->Ends[ray] : 1.0f) - rounding) {
    ++ray;
  }
  return ray == count;
}

stratus_image vtkStratusPicture::MakeRoom(std::vector<float>& rgba, std::vector<float>& depth, const float* opaqueDepth,
  std::vector<uint32_t>* samples, std::vector<unsigned char>* bytes) const
{
  const size_t pixels = static_cast<size_t>(this->Size[0]) * this->Size[1];
  stratus_image image = stratus_image();
  rgba.resize(4 * pixels);
  depth.resize(pixels);
  image.width = this->Size[0];
  image.height = this->Size[1];
  image.rgba = rgba.data();
  image.depth = depth.data();
  image.opaque_depth = opaqueDepth;
  if (samples) {
    samples->resize(pixels);
    image.samples = samples->data();
  }
  if (bytes) {
    bytes->resize(4 * pixels);
    image.rgba8 = bytes->data();
  }
  return image;
}

namespace {
// Gives where a ray goes, which is at u and v in -1..1 in the picture, at the length that the camera has there.
inline void FindDirection(const stratus_camera& camera, double u, double v, double direction[3])
{
  for (int a = 0; a < 3; ++a) {
    direction[a] = camera.forward[a] + (camera.parallel ? 0.0 : u * camera.right[a] + v * camera.up[a]);
  }
}
} // namespace

void vtkStratusPicture::ToWindowDepth(const std::vector<float>& distances, std::vector<float>& depth) const
{
  const stratus_camera& camera = this->Camera;
  const int width = this->Size[0], height = this->Size[1];
  depth.resize(distances.size());
  for (int j = 0; j < height; ++j) {
    const double v = (2.0 * j + 1.0) / height - 1.0;
    for (int i = 0; i < width; ++i) {
      const double u = (2.0 * i + 1.0) / width - 1.0;
      const size_t at = static_cast<size_t>(j) * width + i;
      double direction[3];
      FindDirection(camera, u, v, direction);
      const double k = distances[at] / vtkMath::Norm(direction);
      const double z = (k - camera.near_k) / (camera.far_k - camera.near_k) * (camera.parallel ? 1.0 : camera.far_k / k);
      depth[at] = std::isfinite(k) && z < 1.0 ? static_cast<float>(std::max(0.0, z)) : 1.0f;
    }
  }
}

void vtkStratusPicture::FindPlace(size_t ray, float distance, double place[3], double direction[3]) const
{
  const stratus_camera& camera = this->Camera;
  const size_t width = static_cast<size_t>(this->Size[0]);
  const double u = (2.0 * static_cast<double>(ray % width) + 1.0) / this->Size[0] - 1.0;
  const double v = (2.0 * static_cast<double>(ray / width) + 1.0) / this->Size[1] - 1.0;
  FindDirection(camera, u, v, direction);
  vtkMath::Normalize(direction);
  for (int a = 0; a < 3; ++a) {
    place[a] = camera.eye[a] + (camera.parallel ? u * camera.right[a] + v * camera.up[a] : 0.0) + distance * direction[a];
  }
}

template <class T> void vtkStratusPicture::Spread(const T* rays, int components, T* viewport) const
{
  for (int j = 0; j < (this->IsEmpty() ? 0 : this->Rectangle[3]); ++j) {
    const size_t row = static_cast<size_t>((j + 0.5) * this->Size[1] / this->Rectangle[3]) * this->Size[0];
    T* to = viewport + components * (static_cast<size_t>(this->Rectangle[1] + j) * this->Viewport[2] + this->Rectangle[0]);
    for (int i = 0; i < this->Rectangle[2]; ++i) {
      const size_t from = row + static_cast<size_t>((i + 0.5) * this->Size[0] / this->Rectangle[2]);
      to = std::copy_n(rays + components * from, components, to);
    }
  }
}
template void vtkStratusPicture::Spread(const float* rays, int components, float* viewport) const;

vtkSmartPointer<vtkImageData> vtkStratusPicture::MakeImage(
  const std::vector<float>& rgba, const std::vector<float>& depth, const std::vector<uint32_t>* samples) const
{
  const int width = this->Viewport[2], height = this->Viewport[3];
  const vtkIdType pixels = static_cast<vtkIdType>(width) * height;
  vtkNew<vtkFloatArray> colors, depths;
  vtkNew<vtkTypeUInt32Array> counts;
  colors->SetName("RGBA");
  colors->SetNumberOfComponents(4);
  colors->SetNumberOfTuples(pixels);
  colors->Fill(0.0);
  depths->SetName("Depth");
  depths->SetNumberOfTuples(pixels);
  depths->Fill(std::numeric_limits<double>::infinity());
  counts->SetName("Samples");
  counts->SetNumberOfTuples(samples ? pixels : 0);
  counts->Fill(0.0);
  this->Spread(rgba.data(), 4, colors->GetPointer(0));
  this->Spread(depth.data(), 1, depths->GetPointer(0));
  if (samples) {
    this->Spread(samples->data(), 1, counts->GetPointer(0));
  }
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(width, height, 1);
  image->GetPointData()->SetScalars(colors);
  image->GetPointData()->AddArray(depths);
  if (samples) {
    image->GetPointData()->AddArray(counts);
  }
  return image;
}

bool vtkStratusClipPlanes(vtkAbstractMapper* mapper, int most, double (*planes)[4], int& count, std::string& error)
{
  vtkPlaneCollection* given = mapper->GetClippingPlanes();
  count = given ? given->GetNumberOfItems() : 0;
  if (count > most) {
    error = std::to_string(count) + " clipping planes are not supported, at most " + std::to_string(most) + " are";
    return false;
  }
  for (int p = 0; p < count; ++p) {
    vtkPlane* plane = given->GetItem(p);
    double normal[3], origin[3];
    plane->GetNormal(normal);
    plane->GetOrigin(origin);
    std::copy(normal, normal + 3, planes[p]);
    planes[p][3] = -vtkMath::Dot(normal, origin);
  }
  return true;
}
