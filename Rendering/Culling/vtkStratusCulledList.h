// SPDX-License-Identifier: BSD-3-Clause
// Keeps one renderer's props in an octree of the core, in the order of the renderer's list. Private to the module, never installed.
#ifndef vtkStratusCulledList_h
#define vtkStratusCulledList_h

#include "stratus.h"
#include "vtkStratusBoundsWatch.h"

#include "vtkProp.h"

#include <vector>

class vtkPolyData;

class VTK_STRATUS_PRIVATE vtkStratusCulledList
{
public:
  // How coverage becomes render time, and how visible props are sorted.
  struct Policy {
    double MinimumCoverage, MaximumCoverage;
    int Sorting; // 0, 1 front to back, -1 back to front
    bool Exact;
  };

  vtkStratusCulledList() = default;
  ~vtkStratusCulledList();
  vtkStratusCulledList(const vtkStratusCulledList&) = delete;
  void operator=(const vtkStratusCulledList&) = delete;

  // All of these return a status of the core. After a failure the list is empty and ready for the next call.
  stratus_status Open(stratus_context* context, const stratus_octree_options& options);
  // Makes the octree hold these props with their present bounds. The bounds of new props are always queried. `ask`: also query the bounds
  // that the watch calls changed. `askAll`: query all bounds. `initialized`: render times that earlier cullers have set count.
  stratus_status Look(vtkProp** props, int count, vtkStratusBoundsWatch& watch, bool ask, bool askAll, bool initialized);
  // Moves the visible props of the last look to the front. `seen` gets their number, `total` the sum of their render times.
  stratus_status Cull(const stratus_frustum& frustum, const Policy& policy, vtkProp** props, int& seen, double& total);
  // Writes one polyline per node. `frustum` may be NULL.
  stratus_status Boxes(const stratus_frustum* frustum, vtkPolyData* output) const;

  bool IsOpen() const { return this->View != nullptr; }
  void Close();
  // Number of props whose bounds the last look queried.
  size_t GetNumberOfPropsAsked() const { return this->Asked; }
  stratus_octree_statistics GetStatistics() const;

private:
  struct Slot {
    vtkWeakPointer<vtkProp> Prop;
    vtkStratusBoundsWatch::State Watched;
    uint32_t Id = 0;     // of the octree
    float Share = -1.0f; // of render time, for props without usable bounds; -1: set by coverage
  };
  struct Entry {
    vtkProp* Prop;
    double Depth;
  };

  stratus_status Match(vtkProp** props, size_t count, vtkStratusBoundsWatch& watch);
  stratus_status Replace(vtkProp** props, size_t first, size_t oldEnd, size_t newEnd, vtkStratusBoundsWatch& watch);
  stratus_status Insert(
    vtkProp** props, size_t count, const std::vector<size_t>& added, vtkStratusBoundsWatch& watch, std::vector<uint32_t>& slots);
  stratus_status Remove(const std::vector<uint32_t>& gone);
  stratus_status Refresh(vtkProp** props, vtkStratusBoundsWatch& watch, bool askAll);
  void Mark(const stratus_octree_visible& visible);
  void ClearTimes();
  double Time(const stratus_octree_visible& visible, size_t position, const Policy& policy, double& depth);

  stratus_octree* Octree = nullptr;
  stratus_octree_view* View = nullptr;
  size_t Asked = 0;
  bool Initialized = false;
  std::vector<uint32_t> Order;            // slots in the order of the renderer's list
  std::vector<uint32_t> Positions;        // in Order, by id
  std::vector<Slot> Slots;                // one a prop, and some free ones
  std::vector<uint32_t> Free;             // slots
  std::vector<uint64_t> Seen, SeenBefore; // one bit per slot: the render time is not 0
  std::vector<uint64_t> Marks;            // one bit per position: the octree finds the prop visible
  std::vector<uint32_t> Ranks;            // by position, if marked: the index among the visible
  std::vector<Entry> Kept;
  std::vector<vtkProp*> Rest;
};

#endif
