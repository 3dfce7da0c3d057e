// SPDX-License-Identifier: BSD-3-Clause
// One renderer's props in an octree of the core, kept as the renderer lists them. Private to the module, never installed.
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
  // How a share of the window becomes an allotment of time, and what follows from the order.
  struct Policy {
    double MinimumCoverage, MaximumCoverage;
    int Sorting; // 0, 1 front to back, -1 back to front
    bool Exact;
  };

  vtkStratusCulledList() = default;
  ~vtkStratusCulledList();
  vtkStratusCulledList(const vtkStratusCulledList&) = delete;
  void operator=(const vtkStratusCulledList&) = delete;

  // All of these return a status of the core; after a failure the list is empty and fit for the next call.
  stratus_status Open(stratus_context* context, const stratus_octree_options& options);
  // Makes the octree hold these props with their present bounds. ask: also of those that stayed, by the watch; askAll: without it.
  stratus_status Look(vtkProp** props, int count, vtkStratusBoundsWatch& watch, bool ask, bool askAll);
  // Sorts the seen ones of the props of the last look to the front. seen, total: how many, and their times together.
  stratus_status Cull(const stratus_frustum& frustum, const Policy& policy, bool initialized, vtkProp** props, int& seen, double& total);
  // A polyline a node; frustum may be NULL.
  stratus_status Boxes(const stratus_frustum* frustum, vtkPolyData* output) const;

  bool IsOpen() const { return this->View != nullptr; }
  void Close();
  // Whose bounds the last look asked for.
  size_t GetNumberOfPropsAsked() const { return this->Asked; }
  stratus_octree_statistics GetStatistics() const;

private:
  struct Slot {
    vtkWeakPointer<vtkProp> Prop;
    vtkStratusBoundsWatch::State Watched;
    float Share = -1.0f; // of the window, where bounds tell none
    double Bounds[6];
  };
  struct Entry {
    vtkProp* Prop;
    double Depth;
  };

  stratus_status Match(vtkProp** props, size_t count, vtkStratusBoundsWatch& watch);
  stratus_status Replace(vtkProp** props, size_t first, size_t oldEnd, size_t newEnd, vtkStratusBoundsWatch& watch);
  stratus_status Insert(const std::vector<Slot>& slots, const std::vector<size_t>& places, std::vector<uint32_t>& ids);
  stratus_status Refresh(vtkStratusBoundsWatch& watch, bool askAll);
  void Mark(const stratus_octree_visible& visible);
  void ClearTimes();
  double Time(const stratus_octree_visible& visible, size_t position, const Policy& policy, double& depth);

  stratus_octree* Octree = nullptr;
  stratus_octree_view* View = nullptr;
  size_t Asked = 0;
  std::vector<uint32_t> Order;            // ids, as the renderer lists their props
  std::vector<uint32_t> Positions;        // by id
  std::vector<Slot> Slots;                // by id
  std::vector<uint64_t> Seen, SeenBefore; // a bit an id: whose time is not 0
  std::vector<uint64_t> Marks;            // a bit a position: what the octree calls visible
  std::vector<uint32_t> Ranks;            // by position, where marked: which of the visible
  std::vector<Entry> Kept;
  std::vector<vtkProp*> Rest;
};

#endif
