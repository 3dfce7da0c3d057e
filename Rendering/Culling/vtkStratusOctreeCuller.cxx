// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusOctreeCuller.h"

#include "vtkStratusCulledList.h"

#include "vtkCamera.h"
#include "vtkCullerCollection.h"
#include "vtkFrustumCoverageCuller.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"

#include <chrono>
#include <cmath>
#include <map>
#include <string>

vtkStandardNewMacro(vtkStratusOctreeCuller);

namespace {
double Milliseconds()
{
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Gets the planes of the view frustum, widened by `margin` pixels. In clip coordinates x, y and z are in -w..w; the margin widens x and y.
// Normals have unit length, because coverage measures distances. The camera's composite matrix, and so GetFrustumPlanes(), ignores stereo,
// so the matrices that an eye is drawn with are multiplied here.
void GetFrustum(vtkRenderer* renderer, double margin, stratus_frustum& frustum)
{
  vtkCamera* camera = renderer->GetActiveCamera();
  vtkNew<vtkMatrix4x4> matrix;
  vtkMatrix4x4* projection = camera->GetProjectionTransformMatrix(renderer->GetTiledAspectRatio(), -1.0, 1.0);
  vtkMatrix4x4::Multiply4x4(projection, camera->GetModelViewTransformMatrix(), matrix);
  const int* size = renderer->GetSize();
  for (int p = 0; p < 6; ++p) {
    const int axis = p / 2;
    const double sign = p % 2 == 0 ? 1.0 : -1.0;
    const double wide = axis < 2 && size[axis] > 0 ? 1.0 + 2.0 * margin / size[axis] : 1.0;
    double* plane = frustum.planes[p];
    for (int i = 0; i < 4; ++i) {
      plane[i] = wide * matrix->GetElement(3, i) + sign * matrix->GetElement(axis, i);
    }
    const double length = std::sqrt(plane[0] * plane[0] + plane[1] * plane[1] + plane[2] * plane[2]);
    for (int i = 0; length > 0.0 && i < 4; ++i) {
      plane[i] /= length;
    }
  }
  camera->GetPosition(frustum.eye);
}

bool SameTree(const stratus_octree_options& a, const stratus_octree_options& b)
{
  return a.stop == b.stop && a.pixels == b.pixels && a.c == b.c && a.levels == b.levels && a.leaf_objects == b.leaf_objects;
}

// Returns whether the camera's state is the one in which it will draw. The camera learns only then which eye it is.
bool KnowsEye(vtkRenderer* renderer)
{
  vtkRenderWindow* window = renderer->GetRenderWindow();
  vtkCamera* camera = renderer->GetActiveCamera();
  const bool stereo = window && window->GetStereoRender() != 0;
  if (!window || stereo != (camera->GetStereo() != 0)) {
    return !window;
  }
  const int type = window->GetStereoType(), eye = camera->GetLeftEye();
  return !stereo || (type != VTK_STEREO_LEFT && type != VTK_STEREO_RIGHT) || eye == (type == VTK_STEREO_LEFT);
}

// Leaves out no prop and keeps the render times.
double KeepAll(vtkProp** props, int count, bool initialized)
{
  double total = 0.0;
  for (int i = 0; i < count; ++i) {
    props[i]->SetRenderTimeMultiplier(initialized ? props[i]->GetRenderTimeMultiplier() : 1.0);
    total += props[i]->GetRenderTimeMultiplier();
  }
  return total;
}
} // namespace

class vtkStratusOctreeCuller::Internals
{
public:
  struct Served {
    vtkWeakPointer<vtkRenderer> Renderer; // shows whether the address belongs to another renderer by now
    vtkStratusCulledList List;
    stratus_octree_options Options;
    vtkMTimeType Asked = 0;
    vtkMTimeType Doubtful = 0; // time of a camera that may draw with matrices from before it learned its eye
  };

  ~Internals() { this->Close(); }

  void Close()
  {
    this->Renderers.clear(); // octrees before their context
    stratus_context_destroy(this->Context);
    this->Context = nullptr;
  }

  // Returns the core's reason for a failure.
  std::string Message(stratus_status status) const
  {
    const std::string reason = this->Context ? stratus_context_message(this->Context) : "";
    return std::string(stratus_status_name(status)) + (reason.empty() ? "" : ": ") + reason;
  }

  stratus_status OpenContext(int threads)
  {
    if (this->Context && this->Threads == threads) {
      return STRATUS_OK;
    }
    this->Close();
    stratus_context_options options = stratus_context_options_default();
    options.device = "host";
    options.threads = threads;
    this->Threads = threads;
    return stratus_context_create(&options, &this->Context, nullptr, 0);
  }

  Served& Of(vtkRenderer* renderer)
  {
    for (auto entry = this->Renderers.begin(); entry != this->Renderers.end();) {
      entry = entry->second.Renderer ? std::next(entry) : this->Renderers.erase(entry);
    }
    Served& served = this->Renderers[renderer];
    served.Renderer = renderer;
    return served;
  }

  const Served* Find(vtkRenderer* renderer) const
  {
    const auto found = this->Renderers.find(renderer);
    return found != this->Renderers.end() && found->second.Renderer && found->second.List.IsOpen() ? &found->second : nullptr;
  }

  // Returns whether the renderer will draw with the camera's present matrices.
  bool KnowsView(vtkRenderer* renderer)
  {
    Served& served = this->Of(renderer);
    const vtkMTimeType age = renderer->GetActiveCamera()->GetMTime();
    served.Doubtful = KnowsEye(renderer) ? served.Doubtful : age;
    return served.Doubtful != age;
  }

  stratus_status Cull(vtkStratusOctreeCuller* self, vtkRenderer* renderer, const stratus_frustum& frustum, vtkProp** propList,
    int& listLength, bool initialized, double& total);

  stratus_context* Context = nullptr;
  int Threads = 0;
  std::map<vtkRenderer*, Served> Renderers;
  vtkStratusBoundsWatch Watch;
};

vtkStratusOctreeCuller::vtkStratusOctreeCuller() : Internal(new Internals) {}

vtkStratusOctreeCuller::~vtkStratusOctreeCuller() = default;

// ---- installation

vtkStratusOctreeCuller* vtkStratusOctreeCuller::Install(vtkRenderer* renderer)
{
  if (!renderer) {
    return nullptr;
  }
  vtkNew<vtkStratusOctreeCuller> culler;
  std::vector<vtkSmartPointer<vtkFrustumCoverageCuller>> replaced;
  vtkCollectionSimpleIterator cookie;
  renderer->GetCullers()->InitTraversal(cookie);
  while (vtkCuller* other = renderer->GetCullers()->GetNextCuller(cookie)) {
    if (vtkStratusOctreeCuller* installed = vtkStratusOctreeCuller::SafeDownCast(other)) {
      return installed;
    }
    if (vtkFrustumCoverageCuller* coverage = vtkFrustumCoverageCuller::SafeDownCast(other)) {
      replaced.emplace_back(coverage);
    }
  }
  for (vtkFrustumCoverageCuller* coverage : replaced) {
    culler->SetMinimumCoverage(coverage->GetMinimumCoverage());
    culler->SetMaximumCoverage(coverage->GetMaximumCoverage());
    culler->SetSortingStyle(coverage->GetSortingStyle());
    renderer->RemoveCuller(coverage);
  }
  renderer->AddCuller(culler);
  return culler;
}

void vtkStratusOctreeCuller::Uninstall(vtkRenderer* renderer)
{
  vtkSmartPointer<vtkStratusOctreeCuller> found;
  vtkCollectionSimpleIterator cookie;
  if (renderer) {
    renderer->GetCullers()->InitTraversal(cookie);
    while (vtkCuller* culler = renderer->GetCullers()->GetNextCuller(cookie)) {
      found = found ? found.Get() : vtkStratusOctreeCuller::SafeDownCast(culler);
    }
  }
  if (found) {
    vtkNew<vtkFrustumCoverageCuller> coverage;
    coverage->SetMinimumCoverage(found->GetMinimumCoverage());
    coverage->SetMaximumCoverage(found->GetMaximumCoverage());
    coverage->SetSortingStyle(found->GetSortingStyle());
    renderer->RemoveCuller(found);
    renderer->AddCuller(coverage);
  }
}

stratus_status vtkStratusOctreeCuller::Internals::Cull(vtkStratusOctreeCuller* self, vtkRenderer* renderer, const stratus_frustum& frustum,
  vtkProp** propList, int& listLength, bool initialized, double& total)
{
  Internals::Served& served = this->Of(renderer);
  stratus_octree_options options = stratus_octree_options_default();
  options.stop = static_cast<stratus_octree_stop>(self->StopRule);
  options.pixels = self->Pixels;
  options.c = self->DistanceFactor;
  options.levels = self->MaximumLevel;
  options.leaf_objects = self->LeafProps;
  stratus_status status = STRATUS_OK;
  if (!served.List.IsOpen() || !SameTree(options, served.Options)) {
    served.Options = options;
    status = served.List.Open(this->Context, options);
  }
  const vtkMTimeType modified = self->GetMTime();
  if (status == STRATUS_OK) {
    status = served.List.Look(propList, listLength, this->Watch, !self->StaticProps, modified != served.Asked, initialized);
    served.Asked = modified;
    self->NumberOfPropsAsked = static_cast<vtkIdType>(served.List.GetNumberOfPropsAsked());
  }
  if (status == STRATUS_OK) {
    const int sign = self->SortingStyle == SORT_NONE ? 0 : self->SortingStyle == SORT_FRONT_TO_BACK ? 1 : -1;
    const vtkStratusCulledList::Policy policy = { self->MinimumCoverage, self->MaximumCoverage, sign, self->Exact };
    status = served.List.Cull(frustum, policy, propList, listLength, total);
  }
  if (status != STRATUS_OK) {
    served.List.Close();
  }
  return status;
}

double vtkStratusOctreeCuller::Cull(vtkRenderer* renderer, vtkProp** propList, int& listLength, int& initialized)
{
  const double start = Milliseconds();
  const bool before = initialized != 0;
  initialized = 1;
  double total = 0.0;
  stratus_frustum frustum;
  GetFrustum(renderer, this->Margin, frustum);
  stratus_status status = this->Internal->OpenContext(this->NumberOfThreads);
  this->NumberOfProps = listLength;
  if (status == STRATUS_OK &&
    (!this->Internal->KnowsView(renderer) || stratus_frustum_check(this->Internal->Context, &frustum) != STRATUS_OK)) {
    total = KeepAll(propList, listLength, before);
  } else if (status == STRATUS_OK) {
    status = this->Internal->Cull(this, renderer, frustum, propList, listLength, before, total);
  }
  if (status != STRATUS_OK) {
    vtkErrorMacro("No prop is left out: " << this->Internal->Message(status));
    total = KeepAll(propList, listLength, before);
  }
  this->NumberOfVisibleProps = listLength;
  this->CullTime = Milliseconds() - start;
  return total;
}

// ---- statistics and boxes

bool vtkStratusOctreeCuller::GetBoxes(vtkRenderer* renderer, vtkPolyData* output)
{
  const Internals::Served* served = this->Internal->Find(renderer);
  if (!served || !output) {
    return false;
  }
  stratus_frustum frustum;
  GetFrustum(renderer, this->Margin, frustum);
  const bool finite = stratus_frustum_check(this->Internal->Context, &frustum) == STRATUS_OK;
  return served->List.Boxes(finite ? &frustum : nullptr, output) == STRATUS_OK;
}

vtkIdType vtkStratusOctreeCuller::GetNumberOfNodes(vtkRenderer* renderer)
{
  const Internals::Served* served = this->Internal->Find(renderer);
  return served ? static_cast<vtkIdType>(served->List.GetStatistics().nodes) : 0;
}

vtkIdType vtkStratusOctreeCuller::GetBytes(vtkRenderer* renderer)
{
  const Internals::Served* served = this->Internal->Find(renderer);
  return served ? static_cast<vtkIdType>(served->List.GetStatistics().bytes) : 0;
}

const char* vtkStratusOctreeCuller::GetSortingStyleAsString()
{
  static const char* const names[] = { "none", "front to back", "back to front" };
  return names[this->SortingStyle];
}

const char* vtkStratusOctreeCuller::GetStopRuleAsString()
{
  static const char* const names[] = { "pixels", "Manhattan", "Euclid", "static" };
  return names[this->StopRule];
}

void vtkStratusOctreeCuller::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "StaticProps: " << this->StaticProps << "\n"
     << indent << "Margin: " << this->Margin << "\n"
     << indent << "MinimumCoverage: " << this->MinimumCoverage << "\n"
     << indent << "MaximumCoverage: " << this->MaximumCoverage << "\n"
     << indent << "SortingStyle: " << this->GetSortingStyleAsString() << "\n"
     << indent << "Exact: " << this->Exact << "\n"
     << indent << "StopRule: " << this->GetStopRuleAsString() << "\n"
     << indent << "Pixels: " << this->Pixels << "\n"
     << indent << "DistanceFactor: " << this->DistanceFactor << "\n"
     << indent << "MaximumLevel: " << this->MaximumLevel << "\n"
     << indent << "LeafProps: " << this->LeafProps << "\n"
     << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n"
     << indent << "NumberOfProps: " << this->NumberOfProps << "\n"
     << indent << "NumberOfVisibleProps: " << this->NumberOfVisibleProps << "\n"
     << indent << "NumberOfPropsAsked: " << this->NumberOfPropsAsked << "\n"
     << indent << "CullTime: " << this->CullTime << "\n";
}
