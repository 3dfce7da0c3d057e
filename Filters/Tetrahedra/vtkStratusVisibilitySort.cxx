// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusVisibilitySort.h"

#include "vtkStratusContext.h"
#include "vtkStratusLeaves.h"
#include "vtkStratusTetrahedra.h"

#include "vtkCamera.h"
#include "vtkIdTypeArray.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkTable.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>

vtkStandardNewMacro(vtkStratusVisibilitySort);

class vtkStratusVisibilitySort::Internals
{
public:
  explicit Internals(vtkStratusVisibilitySort* sort) : Sort(sort), Context([](double) { return false; })
  {
    this->Context.OnRelease = [this] { this->Clear(); };
  }
  ~Internals()
  {
    this->Clear();
    this->Context.OnRelease = nullptr;
  }

  bool Build(vtkUnstructuredGrid* grid, std::string& error);
  bool Run(std::string& error);
  void Clear()
  {
    stratus_visibility_order_destroy(this->Order);
    this->Order = nullptr;
    this->Built = 0;
  }

  vtkStratusVisibilitySort* Sort;
  vtkStratusContext Context;
  vtkStratusTetrahedra Mesh;
  vtkStratusLeaves Leaves;
  stratus_visibility_order* Order = nullptr;
  stratus_visibility_result Result{};
  vtkDataSet* Grid = nullptr; // only compared, it may be gone
  vtkMTimeType Built = 0;
  vtkIdType Next = 0, Count = 0;
  vtkNew<vtkIdTypeArray> Cells;
  vtkNew<vtkTable> Report; // of the last traversal
};

bool vtkStratusVisibilitySort::Internals::Build(vtkUnstructuredGrid* grid, std::string& error)
{
  if (!this->Context.Prepare(this->Sort->NumberOfThreads, error)) {
    return false;
  }
  stratus_context_start_build_report(this->Context.Get());
  if (this->Order && this->Grid == grid && this->Built == grid->GetMTime()) {
    return true;
  }
  this->Clear();
  if (!this->Mesh.Set(grid, error)) {
    return false;
  }
  for (vtkIdType i = 0; i < grid->GetNumberOfCells(); ++i) {
    if (grid->GetCellType(i) != VTK_TETRA) {
      error = "cell " + std::to_string(i) + " is of type " + std::to_string(grid->GetCellType(i)) +
        ", only tetrahedra (10) can be sorted: vtkStratusPartitionFilter divides others";
      return false;
    }
  }
  const stratus_mesh mesh = this->Mesh.GetMesh();
  stratus_context* context = this->Context.Get();
  stratus_status status = STRATUS_INVALID_ARGUMENT;
  if (this->Leaves.Set(grid)) {
    // The core refuses a tree that no longer fits the cells, for instance because a filter moved the points. The mesh then is one leaf.
    status = stratus_visibility_order_create(context, &mesh, &this->Leaves.Leaves, &this->Order);
  }
  if (status == STRATUS_INVALID_ARGUMENT) {
    status = stratus_visibility_order_create(context, &mesh, nullptr, &this->Order);
    this->Sort->NumberOfLeaves = 1;
  } else {
    this->Sort->NumberOfLeaves = this->Leaves.Leaves.leaf_count;
  }
  if (status != STRATUS_OK) {
    error = stratus_context_message(context);
    return false;
  }
  this->Grid = grid;
  this->Built = grid->GetMTime();
  return true;
}

bool vtkStratusVisibilitySort::Internals::Run(std::string& error)
{
  vtkCamera* from = this->Sort->Camera;
  stratus_camera camera = {};
  from->GetPosition(camera.eye);
  from->GetDirectionOfProjection(camera.forward);
  camera.far_k = INFINITY;
  camera.parallel = from->GetParallelProjection() ? 1 : 0;
  double identity[16];
  vtkMatrix4x4::Identity(identity);
  const double* matrix = this->Sort->ModelTransform ? this->Sort->ModelTransform->GetData() : identity;
  const stratus_peeling peeling = this->Sort->Peeling == LAYERS ? STRATUS_PEELING_LAYERS : STRATUS_PEELING_NEAREST;
  if (stratus_visibility_order_sort(this->Order, &camera, matrix, peeling, &this->Result) != STRATUS_OK) {
    error = stratus_context_message(this->Context.Get());
    return false;
  }
  this->Context.GetBuildReport(this->Report);
  return true;
}

vtkStratusVisibilitySort::vtkStratusVisibilitySort() : Internal(new Internals(this)) {}

vtkStratusVisibilitySort::~vtkStratusVisibilitySort() = default;

void vtkStratusVisibilitySort::SetDevice(const char* device)
{
  std::string error;
  if (this->Internal->Context.SetDevice(device, this->NumberOfThreads, error)) {
    this->Modified();
  } else if (!error.empty()) {
    vtkErrorMacro(<< error);
  }
}

const char* vtkStratusVisibilitySort::GetDevice()
{
  return this->Internal->Context.GetDevice().c_str();
}

const char* vtkStratusVisibilitySort::GetDeviceName()
{
  std::string error;
  return this->Internal->Context.Prepare(this->NumberOfThreads, error) ? stratus_context_device(this->Internal->Context.Get()) : "";
}

vtkTable* vtkStratusVisibilitySort::GetBuildReport()
{
  return this->Internal->Report;
}

void vtkStratusVisibilitySort::InitTraversal()
{
  Internals& internal = *this->Internal;
  internal.Next = internal.Count = 0;
  auto* grid = vtkUnstructuredGrid::SafeDownCast(this->Input);
  std::string error;
  if (!grid) {
    error = std::string("the input is ") + (this->Input ? this->Input->GetClassName() : "not set") + ", must be a vtkUnstructuredGrid";
  } else if (!this->Camera) {
    error = "the camera is not set";
  }
  if (!error.empty() || !internal.Build(grid, error) || !internal.Run(error)) {
    vtkErrorMacro(<< error);
    return;
  }
  internal.Count = static_cast<vtkIdType>(internal.Result.count);
  this->NumberOfCycles = static_cast<vtkIdType>(internal.Result.cycles);
  this->NumberOfOverlaps = static_cast<vtkIdType>(internal.Result.overlaps);
  this->NumberOfForcedCells = static_cast<vtkIdType>(internal.Result.forced);
  this->NumberOfLayers = internal.Result.layers;
  this->BuildMilliseconds = internal.Result.build_ms;
  this->SortMilliseconds = internal.Result.signs_ms + internal.Result.peel_ms;
  this->LastSortTime.Modified();
}

vtkIdTypeArray* vtkStratusVisibilitySort::GetNextCells()
{
  Internals& internal = *this->Internal;
  if (internal.Next == internal.Count) {
    return nullptr;
  }
  const vtkIdType count = std::min<vtkIdType>(this->MaxCellsReturned, internal.Count - internal.Next);
  internal.Cells->SetNumberOfTuples(count);
  vtkIdType* ids = internal.Cells->GetPointer(0);
  for (vtkIdType i = 0; i < count; ++i) {
    const vtkIdType at = internal.Next + i;
    ids[i] = internal.Result.cells[this->Direction == FRONT_TO_BACK ? at : internal.Count - 1 - at];
  }
  internal.Next += count;
  return internal.Cells;
}

void vtkStratusVisibilitySort::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Peeling: " << (this->Peeling == LAYERS ? "layers" : "nearest") << "\n";
  os << indent << "Device: " << this->GetDevice() << "\n";
  os << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n";
  os << indent << "NumberOfLeaves: " << this->NumberOfLeaves << "\n";
  os << indent << "NumberOfCycles: " << this->NumberOfCycles << "\n";
  os << indent << "NumberOfOverlaps: " << this->NumberOfOverlaps << "\n";
  os << indent << "NumberOfForcedCells: " << this->NumberOfForcedCells << "\n";
  os << indent << "NumberOfLayers: " << this->NumberOfLayers << "\n";
  os << indent << "BuildMilliseconds: " << this->BuildMilliseconds << "\n";
  os << indent << "SortMilliseconds: " << this->SortMilliseconds << "\n";
}
