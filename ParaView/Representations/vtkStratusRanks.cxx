// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusRanks.h"

#include "vtkBoundingBox.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkDataSetAttributes.h"
#include "vtkInformation.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkMultiProcessController.h"
#include "vtkPlane.h"
#include "vtkPlaneCollection.h"
#include "vtkPropCollection.h"
#include "vtkRenderer.h"
#include "vtkVolumeMapper.h"

#include <algorithm>
#include <vector>

namespace {

// Every rank's text, cut to fit `length` with its end.
std::vector<std::string> gather_texts(vtkMultiProcessController* controller, const std::string& mine, size_t length)
{
  std::vector<char> own(length, 0), all(length * static_cast<size_t>(controller->GetNumberOfProcesses()));
  mine.copy(own.data(), length - 1);
  controller->AllGather(own.data(), all.data(), static_cast<vtkIdType>(length));
  std::vector<std::string> texts;
  for (size_t at = 0; at < all.size(); at += length) {
    texts.emplace_back(&all[at]);
  }
  return texts;
}

bool has_array(vtkDataObject* data, int of, const char* name)
{
  auto* blocks = vtkCompositeDataSet::SafeDownCast(data);
  auto* grid = vtkDataSet::SafeDownCast(data);
  const std::vector<vtkDataSet*> grids = blocks ? vtkCompositeDataSet::GetDataSets(blocks) : std::vector<vtkDataSet*>(grid ? 1 : 0, grid);
  return std::any_of(grids.begin(), grids.end(), [of, name](vtkDataSet* block) { return block->GetAttributes(of)->GetArray(name); });
}

// Whether no rank's data have the array that is shown, while the data of before had it. False where no rank has data now, or none was
// chosen. Every rank must call it.
bool lost_array(vtkInformation* array, vtkDataObject* now, vtkDataObject* before)
{
  const char* name = array ? array->Get(vtkDataObject::FIELD_NAME()) : nullptr;
  const bool cells = array && array->Get(vtkDataObject::FIELD_ASSOCIATION()) == vtkDataObject::FIELD_ASSOCIATION_CELLS;
  const int of = cells ? vtkDataObject::CELL : vtkDataObject::POINT;
  const bool chosen = name && name[0];
  const int mine[3] = { now && now->GetNumberOfElements(vtkDataObject::CELL) > 0, chosen && has_array(now, of, name),
    chosen && has_array(before, of, name) };
  int any[3] = { mine[0], mine[1], mine[2] };
  if (stratus::count_ranks() > 1) {
    vtkMultiProcessController::GetGlobalController()->AllReduce(mine, any, 3, vtkCommunicator::MAX_OP);
  }
  return any[0] && !any[1] && any[2];
}
} // namespace

int stratus::count_ranks()
{
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  return controller ? controller->GetNumberOfProcesses() : 1;
}

int stratus::get_rank()
{
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  return controller ? controller->GetLocalProcessId() : 0;
}

std::vector<vtkIdType> stratus::count_before(const std::vector<vtkIdType>& mine)
{
  const size_t kinds = mine.size(), ranks = static_cast<size_t>(count_ranks());
  std::vector<vtkIdType> all(kinds * ranks), before(kinds, 0);
  if (ranks > 1) {
    vtkMultiProcessController::GetGlobalController()->AllGather(mine.data(), all.data(), static_cast<vtkIdType>(kinds));
  }
  for (size_t i = 0; i < kinds * static_cast<size_t>(get_rank()); ++i) {
    before[i % kinds] += all[i];
  }
  return before;
}

bool stratus::join_bounds(vtkMultiProcessController* controller, const double mine[6], double whole[6])
{
  double signed_bounds[6], least[6]; // upper bounds have their sign changed
  for (int i = 0; i < 6; ++i) {
    signed_bounds[i] = vtkMath::AreBoundsInitialized(mine) ? (i % 2 ? -1.0 : 1.0) * mine[i] : VTK_DOUBLE_MAX;
  }
  controller->AllReduce(signed_bounds, least, 6, vtkCommunicator::MIN_OP);
  for (int i = 0; i < 6 && least[0] < VTK_DOUBLE_MAX; ++i) {
    whole[i] = i % 2 ? -least[i] : least[i];
  }
  return least[0] < VTK_DOUBLE_MAX;
}

std::string stratus::agree_on_array(vtkMultiProcessController* controller, const std::string& mine, bool& on_cells)
{
  for (const std::string& other : gather_texts(controller, (on_cells ? "C" : "P") + mine, 257)) {
    if (other.size() > 1) {
      on_cells = other[0] == 'C';
      return other.substr(1);
    }
  }
  return std::string();
}

std::string stratus::join_words(vtkMultiProcessController* controller, const std::string& mine, std::string& last)
{
  const int changed = mine != last;
  int any = 0;
  std::string joined;
  controller->AllReduce(&changed, &any, 1, vtkCommunicator::MAX_OP);
  last = mine;
  if (any) {
    const std::vector<std::string> said = gather_texts(controller, mine, 512);
    for (size_t rank = 0; rank < said.size() && controller->GetLocalProcessId() == 0; ++rank) {
      if (!said[rank].empty()) {
        joined += (joined.empty() ? "rank " : "\nrank ") + std::to_string(rank) + ": " + said[rank];
      }
    }
  }
  return joined;
}

std::string stratus::choose_words(vtkMultiProcessController* controller, const std::string& failed, const std::string& problem,
  const std::string& refusal, int mode, bool dark)
{
  const bool projects = mode >= vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND && mode <= vtkVolumeMapper::ADDITIVE_BLEND;
  if (!failed.empty()) {
    return failed + "; its part is not drawn";
  }
  if (!problem.empty() || !refusal.empty()) {
    return problem.empty() ? refusal : problem;
  }
  if (controller->GetLocalProcessId() > 0) {
    return "";
  }
  return dark  ? "several ranks draw without shadows and scattered light, because each has only its own part of the matter"
    : projects ? "each rank shows the maximum, minimum, average or sum of its own part of a ray, laid over the others, not of the whole ray"
               : "";
}

std::string stratus::judge_parts(vtkMultiProcessController* controller, const double mine[6])
{
  const size_t ranks = static_cast<size_t>(controller->GetNumberOfProcesses());
  const size_t me = static_cast<size_t>(controller->GetLocalProcessId());
  std::vector<double> all(6 * ranks);
  controller->AllGather(mine, all.data(), 6);
  vtkBoundingBox whole;
  double filled = 0.0;
  std::string overlaps;
  const auto volume_of = [](const double* b) { return (b[1] - b[0]) * (b[3] - b[2]) * (b[5] - b[4]); };
  for (size_t rank = 0; rank < ranks; ++rank) {
    const double* other = &all[6 * rank];
    if (!vtkMath::AreBoundsInitialized(other)) {
      continue;
    }
    whole.AddBounds(other);
    filled += volume_of(other);
    bool overlap = rank > me && vtkMath::AreBoundsInitialized(mine);
    for (int axis = 0; overlap && axis < 3; ++axis) {
      const double common = std::min(mine[2 * axis + 1], other[2 * axis + 1]) - std::max(mine[2 * axis], other[2 * axis]);
      overlap = common > 1e-6 * (other[2 * axis + 1] - other[2 * axis]);
    }
    if (overlap) {
      overlaps += (overlaps.empty() ? "its part of the data overlaps the part of rank " : ", ") + std::to_string(rank);
    }
  }
  if (!overlaps.empty()) {
    return overlaps + "; they are drawn one over the other";
  }
  double bounds[6] = { 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 };
  if (whole.IsValid()) {
    whole.GetBounds(bounds);
  }
  return me == 0 && filled < (1.0 - 1e-6) * volume_of(bounds) ? "the ranks' parts of the data leave gaps between them" : "";
}

vtkSmartPointer<vtkPlaneCollection> stratus::planes_between(const double own[6], const double whole[6], vtkMatrix4x4* matrix)
{
  const auto planes = vtkSmartPointer<vtkPlaneCollection>::New();
  vtkNew<vtkMatrix4x4> inverse;
  vtkMatrix4x4::Invert(matrix, inverse);
  for (int face = 0; face < 6 && vtkMath::AreBoundsInitialized(own); ++face) {
    if (own[face] != whole[face]) {
      double point[4] = { 0.0, 0.0, 0.0, 1.0 }, normal[3]; // of the world
      point[face / 2] = own[face];
      matrix->MultiplyPoint(point, point);
      for (int axis = 0; axis < 3; ++axis) {
        normal[axis] = (face % 2 ? -1.0 : 1.0) * inverse->GetElement(face / 2, axis);
      }
      vtkNew<vtkPlane> plane;
      plane->SetOrigin(point);
      plane->SetNormal(normal);
      planes->AddItem(plane);
    }
  }
  return planes;
}

std::string stratus::keep_if_lost(vtkInformation* array, vtkSmartPointer<vtkDataObject>& now, vtkDataObject* before, bool& lost)
{
  const bool was = lost;
  lost = lost_array(array, now, before);
  if (lost) {
    now = before;
  }
  return lost && !was && get_rank() == 0
    ? std::string("the data have no array '") + array->Get(vtkDataObject::FIELD_NAME()) + "' any more; the last data that had it stay"
    : "";
}

bool stratus::has_translucent(vtkRenderer* renderer)
{
  vtkPropCollection* props = renderer->GetViewProps();
  vtkCollectionSimpleIterator at;
  props->InitTraversal(at);
  while (vtkProp* prop = props->GetNextProp(at)) {
    if (prop->GetVisibility() && prop->HasTranslucentPolygonalGeometry()) {
      return true;
    }
  }
  return false;
}
