// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusCulledList.h"

#include "vtkActor.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <unordered_map>

#define TRY(call)                                                                                                                          \
  do {                                                                                                                                     \
    const stratus_status tried = (call);                                                                                                   \
    if (tried != STRATUS_OK) {                                                                                                             \
      return tried;                                                                                                                        \
    }                                                                                                                                      \
  } while (0)

namespace {
// Shares that vtkFrustumCoverageCuller allots: little to a prop without bounds, such as a title, and less to a point.
constexpr float ShareWithoutBounds = 1e-3f;
constexpr double ShareOfPoint = 1e-4;
constexpr size_t CacheLine = 64;
constexpr size_t Ahead = 4; // props

bool Same(const double a[6], const double b[6])
{
  return std::memcmp(a, b, 6 * sizeof(double)) == 0; // bytewise, so that NaN equals NaN
}

// Gets the prop's bounds and a share of -1, or NaN and a share of render time where the bounds cannot be used.
void Ask(vtkProp* prop, double bounds[6], float& share)
{
  const bool use = prop->GetUseBounds();
  const double* given = use ? prop->GetBounds() : nullptr;
  share = use ? ShareWithoutBounds : 1.0f;
  bool good = given != nullptr;
  for (int a = 0; good && a < 3; ++a) {
    good = given[2 * a] <= given[2 * a + 1] && std::fabs(given[2 * a]) <= 1e30 && std::fabs(given[2 * a + 1]) <= 1e30;
  }
  if (good) {
    std::copy(given, given + 6, bounds);
    share = -1.0f;
  } else {
    std::fill(bounds, bounds + 6, std::numeric_limits<double>::quiet_NaN());
  }
}

// Fetches the memory of the prop that comes `Ahead` places after `place` into the processor's cache: as much as an actor takes.
// VTK's objects lie scattered, and waiting for them is a good part of a pass over many. The prop itself may be of any class and size, since
// only its address is used.
void FetchAhead(vtkProp** props, size_t count, size_t place)
{
  for (size_t at = 0; place + Ahead < count && at < sizeof(vtkActor); at += CacheLine) {
    const void* memory = reinterpret_cast<const void*>(reinterpret_cast<uintptr_t>(props[place + Ahead]) + at);
#if defined(__GNUC__)
    __builtin_prefetch(memory);
#else
    (void)memory;
#endif
  }
}

void SetBit(std::vector<uint64_t>& bits, size_t bit)
{
  bits[bit / 64] |= uint64_t(1) << (bit % 64);
}

bool GetBit(const std::vector<uint64_t>& bits, size_t bit)
{
  return (bits[bit / 64] >> (bit % 64) & 1) != 0;
}
} // namespace

vtkStratusCulledList::~vtkStratusCulledList()
{
  this->Close();
}

void vtkStratusCulledList::Close()
{
  stratus_octree_view_destroy(this->View);
  stratus_octree_destroy(this->Octree);
  this->View = nullptr;
  this->Octree = nullptr;
  this->Order.clear();
  this->Positions.clear();
  this->Slots.clear();
  this->Free.clear();
  this->Seen.clear();
}

stratus_status vtkStratusCulledList::Open(stratus_context* context, const stratus_octree_options& options)
{
  this->Close();
  stratus_status status = stratus_octree_create(context, &options, &this->Octree);
  if (status == STRATUS_OK) {
    status = stratus_octree_view_create(this->Octree, &this->View);
  }
  if (status != STRATUS_OK) {
    this->Close();
  }
  return status;
}

stratus_octree_statistics vtkStratusCulledList::GetStatistics() const
{
  stratus_octree_statistics statistics = {};
  if (this->Octree) {
    stratus_octree_get_statistics(this->Octree, &statistics);
  }
  return statistics;
}

// ---- the renderer's list

stratus_status vtkStratusCulledList::Look(vtkProp** props, int count, vtkStratusBoundsWatch& watch, bool ask, bool askAll, bool initialized)
{
  watch.NextLook();
  this->Asked = 0;
  this->Initialized = initialized;
  stratus_status status = this->Match(props, static_cast<size_t>(count), watch);
  if (status == STRATUS_OK && (ask || askAll) && this->Asked < this->Order.size()) {
    status = this->Refresh(props, watch, askAll);
  }
  if (status != STRATUS_OK) {
    this->Close();
  }
  return status;
}

// Lists differ little from frame to frame, so that a common beginning and end stay untouched. A prop at the address of a deleted one is not
// equal to it, because the weak pointer to the deleted one is NULL.
stratus_status vtkStratusCulledList::Match(vtkProp** props, size_t count, vtkStratusBoundsWatch& watch)
{
  const size_t before = this->Order.size(), shorter = std::min(before, count);
  size_t first = 0, last = 0;
  while (first < shorter && this->Slots[this->Order[first]].Prop.GetPointer() == props[first]) {
    ++first;
  }
  if (first == before && first == count) {
    return STRATUS_OK;
  }
  while (last < shorter - first && this->Slots[this->Order[before - 1 - last]].Prop.GetPointer() == props[count - 1 - last]) {
    ++last;
  }
  return this->Replace(props, first, before - last, count - last, watch);
}

stratus_status vtkStratusCulledList::Replace(vtkProp** props, size_t first, size_t oldEnd, size_t newEnd, vtkStratusBoundsWatch& watch)
{
  std::unordered_map<vtkProp*, uint32_t> known;
  std::vector<uint32_t> gone, slots(newEnd - first);
  for (size_t i = first; i < oldEnd; ++i) {
    const uint32_t slot = this->Order[i];
    vtkProp* prop = this->Slots[slot].Prop;
    if (!prop || !known.emplace(prop, slot).second) {
      gone.push_back(slot);
    }
  }
  std::vector<size_t> added; // in slots
  for (size_t i = first; i < newEnd; ++i) {
    const auto found = known.find(props[i]);
    if (found == known.end()) {
      added.push_back(i - first);
      continue;
    }
    slots[i - first] = found->second;
    known.erase(found);
  }
  for (const auto& entry : known) {
    gone.push_back(entry.second);
  }
  TRY(this->Remove(gone));
  TRY(this->Insert(props + first, newEnd - first, added, watch, slots));
  this->Order.erase(this->Order.begin() + static_cast<ptrdiff_t>(first), this->Order.begin() + static_cast<ptrdiff_t>(oldEnd));
  this->Order.insert(this->Order.begin() + static_cast<ptrdiff_t>(first), slots.begin(), slots.end());
  for (size_t i = first; i < this->Order.size(); ++i) {
    this->Positions[this->Slots[this->Order[i]].Id] = static_cast<uint32_t>(i);
  }
  return STRATUS_OK;
}

stratus_status vtkStratusCulledList::Remove(const std::vector<uint32_t>& gone)
{
  std::vector<uint32_t> ids;
  for (const uint32_t slot : gone) {
    ids.push_back(this->Slots[slot].Id);
    this->Slots[slot] = Slot();
  }
  this->Free.insert(this->Free.end(), gone.begin(), gone.end());
  return stratus_octree_remove(this->Octree, ids.data(), ids.size());
}

// Queries the bounds of props[i] for each i of `added`, and sets slots[i]. All work that needs the prop's memory is done with the query,
// which brings it into the processor's cache.
stratus_status vtkStratusCulledList::Insert(
  vtkProp** props, size_t count, const std::vector<size_t>& added, vtkStratusBoundsWatch& watch, std::vector<uint32_t>& slots)
{
  if (added.empty()) {
    return STRATUS_OK;
  }
  std::vector<double> bounds(6 * added.size());
  std::vector<uint32_t> ids(added.size());
  const size_t fresh = added.size() - std::min(added.size(), this->Free.size());
  for (size_t i = fresh; i-- > 0;) {
    this->Free.push_back(static_cast<uint32_t>(this->Slots.size() + i));
  }
  this->Slots.resize(this->Slots.size() + fresh);
  this->Seen.resize((this->Slots.size() + 63) / 64, 0);
  for (size_t i = 0; i < added.size(); ++i) {
    const uint32_t number = this->Free.back();
    Slot& slot = this->Slots[number];
    this->Free.pop_back();
    FetchAhead(props, count, added[i]);
    Ask(props[added[i]], &bounds[6 * i], slot.Share);
    watch.Asked(slot.Watched);
    slot.Prop = props[added[i]];
    slots[added[i]] = number;
    if (this->Initialized) {
      SetBit(this->Seen, number); // an earlier culler's render time counts, and ClearTimes() clears it if this look does not see the prop
    } else {
      props[added[i]]->SetRenderTimeMultiplier(0.0);
    }
  }
  this->Asked += added.size();
  TRY(stratus_octree_insert(this->Octree, bounds.data(), added.size(), ids.data()));
  this->Positions.resize(std::max(this->Positions.size(), stratus_octree_id_limit(this->Octree)));
  for (size_t i = 0; i < added.size(); ++i) {
    this->Slots[slots[added[i]]].Id = ids[i];
  }
  return STRATUS_OK;
}

stratus_status vtkStratusCulledList::Refresh(vtkProp** props, vtkStratusBoundsWatch& watch, bool askAll)
{
  std::vector<uint32_t> moved;
  std::vector<double> bounds;
  for (size_t i = 0; i < this->Order.size(); ++i) {
    Slot& slot = this->Slots[this->Order[i]];
    if (watch.IsAsked(slot.Watched)) {
      continue;
    }
    if (askAll) {
      FetchAhead(props, this->Order.size(), i);
      slot.Watched = vtkStratusBoundsWatch::State(); // its sources may be others by now
    } else if (!watch.Changed(props[i], slot.Watched)) {
      continue;
    }
    double before[6], now[6];
    TRY(stratus_octree_bounds(this->Octree, slot.Id, before));
    Ask(props[i], now, slot.Share);
    watch.Asked(slot.Watched);
    ++this->Asked;
    if (!Same(now, before)) {
      bounds.insert(bounds.end(), now, now + 6);
      moved.push_back(slot.Id);
    }
  }
  return moved.empty() ? STRATUS_OK : stratus_octree_move(this->Octree, moved.data(), bounds.data(), moved.size());
}

// ---- visible props

void vtkStratusCulledList::Mark(const stratus_octree_visible& visible)
{
  this->SeenBefore.swap(this->Seen);
  this->Seen.assign(this->SeenBefore.size(), 0);
  this->Marks.assign((this->Order.size() + 63) / 64, 0);
  this->Ranks.resize(this->Order.size());
  for (size_t i = 0; i < visible.count; ++i) {
    const uint32_t position = this->Positions[visible.ids[i]];
    SetBit(this->Marks, position);
    this->Ranks[position] = static_cast<uint32_t>(i);
  }
}

double vtkStratusCulledList::Time(const stratus_octree_visible& visible, size_t position, const Policy& policy, double& depth)
{
  const uint32_t rank = this->Ranks[position];
  const float share = this->Slots[this->Order[position]].Share;
  if (share >= 0.0f) {
    depth = -std::numeric_limits<double>::infinity(); // before all others, in the list's order
    return share;
  }
  depth = visible.depth[rank];
  double coverage = visible.coverage[rank];
  if (!(coverage > 0.0) && policy.MinimumCoverage == 0.0) {
    coverage = ShareOfPoint;
  }
  if (coverage < policy.MinimumCoverage) {
    return 0.0;
  }
  return coverage > policy.MaximumCoverage ? 1.0 : (coverage - policy.MinimumCoverage) / policy.MaximumCoverage;
}

// Sets the render time of props that were visible the last time and no longer are to 0.
void vtkStratusCulledList::ClearTimes()
{
  for (size_t word = 0; word < this->Seen.size(); ++word) {
    uint64_t bits = this->SeenBefore[word] & ~this->Seen[word];
    for (size_t slot = 64 * word; bits != 0; ++slot, bits >>= 1) {
      vtkProp* prop = (bits & 1) != 0 ? this->Slots[slot].Prop.GetPointer() : nullptr;
      if (prop) {
        prop->SetRenderTimeMultiplier(0.0);
      }
    }
  }
}

stratus_status vtkStratusCulledList::Cull(const stratus_frustum& frustum, const Policy& policy, vtkProp** props, int& seen, double& total)
{
  stratus_octree_cull_options options = {};
  options.exact = policy.Exact;
  options.coverage = 1;
  options.hold = this->Asked > 0 && this->Asked == this->Order.size(); // all that vtkFrustumCoverageCuller would do is done already
  stratus_octree_visible visible;
  TRY(stratus_octree_cull(this->View, &frustum, &options, &visible));
  this->Mark(visible);
  this->Kept.clear();
  this->Rest.clear();
  this->Kept.reserve(visible.count);
  this->Rest.reserve(this->Order.size() - visible.count);
  total = 0.0;
  for (size_t position = 0; position < this->Order.size(); ++position) {
    Entry entry = { props[position], 0.0 };
    double time = GetBit(this->Marks, position) ? this->Time(visible, position, policy, entry.Depth) : 0.0;
    time *= time > 0.0 && this->Initialized ? entry.Prop->GetRenderTimeMultiplier() : 1.0;
    if (!(time > 0.0)) {
      this->Rest.push_back(entry.Prop);
      continue;
    }
    entry.Prop->SetRenderTimeMultiplier(time);
    total += time;
    this->Kept.push_back(entry);
    SetBit(this->Seen, this->Order[position]);
  }
  this->ClearTimes();
  if (policy.Sorting != 0) {
    const double sign = policy.Sorting;
    std::stable_sort(
      this->Kept.begin(), this->Kept.end(), [sign](const Entry& a, const Entry& b) { return sign * a.Depth < sign * b.Depth; });
  }
  vtkProp** end = std::transform(this->Kept.begin(), this->Kept.end(), props, [](const Entry& entry) { return entry.Prop; });
  std::copy(this->Rest.begin(), this->Rest.end(), end);
  seen = static_cast<int>(this->Kept.size());
  return STRATUS_OK;
}

// ---- boxes to look at

stratus_status vtkStratusCulledList::Boxes(const stratus_frustum* frustum, vtkPolyData* output) const
{
  // One polyline along all twelve edges, so that a box is one cell. It draws three edges twice.
  static const vtkIdType stroke[16] = { 0, 1, 3, 2, 0, 4, 5, 1, 5, 7, 3, 7, 6, 2, 6, 4 };
  std::vector<stratus_octree_node> nodes(this->GetStatistics().nodes);
  if (!nodes.empty()) {
    TRY(stratus_octree_nodes(this->Octree, frustum, nodes.data()));
  }
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> lines;
  vtkNew<vtkIntArray> levels;
  vtkNew<vtkUnsignedCharArray> visibility, split;
  vtkNew<vtkIdTypeArray> objects;
  levels->SetName("Level");
  visibility->SetName("Visibility");
  split->SetName("Split");
  objects->SetName("Objects");
  points->SetDataTypeToDouble();
  for (const stratus_octree_node& node : nodes) {
    vtkIdType corners[8], cell[16];
    for (int c = 0; c < 8; ++c) {
      corners[c] = points->InsertNextPoint(node.bounds[c & 1], node.bounds[2 + (c >> 1 & 1)], node.bounds[4 + (c >> 2)]);
    }
    std::transform(stroke, stroke + 16, cell, [&corners](vtkIdType corner) { return corners[corner]; });
    lines->InsertNextCell(16, cell);
    levels->InsertNextValue(node.level);
    visibility->InsertNextValue(static_cast<unsigned char>(node.side));
    split->InsertNextValue(node.split != 0);
    objects->InsertNextValue(static_cast<vtkIdType>(node.objects));
  }
  output->Initialize();
  output->SetPoints(points);
  output->SetLines(lines);
  output->GetCellData()->SetScalars(levels);
  output->GetCellData()->AddArray(visibility);
  output->GetCellData()->AddArray(split);
  output->GetCellData()->AddArray(objects);
  return STRATUS_OK;
}
