// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusPartitionFilter.h"

#include "vtkStratusArrays.h"
#include "vtkStratusContext.h"
#include "vtkStratusLeaves.h"
#include "vtkStratusTetrahedra.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkTable.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <limits>

vtkStandardNewMacro(vtkStratusPartitionFilter);

class vtkStratusPartitionFilter::Internals
{
public:
  explicit Internals(vtkStratusPartitionFilter* filter)
      : Context([filter](double fraction) {
          filter->UpdateProgress(fraction);
          return filter->GetAbortExecute() != 0;
        })
  {
  }
  vtkStratusContext Context;
  vtkNew<vtkTable> Report; // of the last good output
};

namespace {
bool CheckAttributes(vtkUnstructuredGrid* grid, std::string& error)
{
  vtkUnsignedCharArray* flags = nullptr;
  const vtkIdType points = grid->GetNumberOfPoints(), cells = grid->GetNumberOfCells();
  return vtkStratusCheckArrays(grid->GetPointData(), points, "points of the grid", error) &&
    vtkStratusCheckArrays(grid->GetCellData(), cells, "cells of the grid", error) &&
    vtkStratusFindGhosts(grid->GetPointData(), points, "points of the grid", flags, error) &&
    vtkStratusFindGhosts(grid->GetCellData(), cells, "cells of the grid", flags, error);
}

// Makes the copies of the active attributes (scalars, vectors ...) active, too.
void KeepAttributes(vtkDataSetAttributes* from, vtkDataSetAttributes* to)
{
  for (int type = 0; type < vtkDataSetAttributes::NUM_ATTRIBUTES; ++type) {
    vtkAbstractArray* array = from->GetAbstractAttribute(type);
    if (array && array->GetName() && type != vtkDataSetAttributes::GLOBALIDS && to->GetAbstractArray(array->GetName())) {
      to->SetActiveAttribute(array->GetName(), type);
    }
  }
}

bool IsLeftOut(vtkDataSetAttributes* attributes, vtkAbstractArray* array)
{
  return array == attributes->GetAbstractAttribute(vtkDataSetAttributes::GLOBALIDS);
}

void InterpolatePoints(vtkPointData* from, const vtkStratusTetrahedra& tetrahedra, const stratus_partition_result& cut, vtkPointData* to)
{
  const auto old_points = static_cast<vtkIdType>(cut.old_points);
  const auto points = static_cast<vtkIdType>(cut.point_count);
  for (int a = 0; a < from->GetNumberOfArrays(); ++a) {
    vtkAbstractArray* array = from->GetAbstractArray(a);
    if (IsLeftOut(from, array)) {
      continue;
    }
    auto result = vtkSmartPointer<vtkAbstractArray>::Take(array->NewInstance());
    result->SetName(array->GetName());
    result->SetNumberOfComponents(array->GetNumberOfComponents());
    result->CopyComponentNames(array);
    result->SetNumberOfTuples(points);
    tetrahedra.CopyPointValues(array, result);
    auto* ghosts = vtkUnsignedCharArray::SafeDownCast(result);
    const bool flags =
      ghosts && ghosts == result && std::string(array->GetName() ? array->GetName() : "") == vtkDataSetAttributes::GhostArrayName();
    for (vtkIdType i = old_points; i < points; ++i) {
      const vtkIdType p = cut.ends[2 * (i - old_points)], q = cut.ends[2 * (i - old_points) + 1];
      if (flags) { // a ghost flag is set where both ends have it
        ghosts->SetValue(i, static_cast<unsigned char>(ghosts->GetValue(p) & ghosts->GetValue(q)));
      } else {
        result->InterpolateTuple(i, p, result, q, result, cut.weights[i - old_points]);
      }
    }
    to->AddArray(result);
  }
  KeepAttributes(from, to);
}

void CopyCells(vtkCellData* from, const std::vector<vtkIdType>& origins, vtkCellData* to)
{
  const auto cells = static_cast<vtkIdType>(origins.size());
  for (int a = 0; a < from->GetNumberOfArrays(); ++a) {
    vtkAbstractArray* array = from->GetAbstractArray(a);
    if (IsLeftOut(from, array)) {
      continue;
    }
    auto result = vtkSmartPointer<vtkAbstractArray>::Take(array->NewInstance());
    result->SetName(array->GetName());
    result->SetNumberOfComponents(array->GetNumberOfComponents());
    result->CopyComponentNames(array);
    result->SetNumberOfTuples(cells);
    for (vtkIdType i = 0; i < cells; ++i) {
      result->SetTuple(i, origins[static_cast<size_t>(i)], array);
    }
    to->AddArray(result);
  }
  KeepAttributes(from, to);
}

// Hides every piece of a cell that has a hidden corner, because not every piece touches that corner.
void HidePieces(
  vtkUnstructuredGrid* input, const vtkStratusTetrahedra& tetrahedra, const std::vector<vtkIdType>& origins, vtkUnstructuredGrid* output)
{
  vtkUnsignedCharArray* points = input->GetPointGhostArray();
  if (!points) {
    return;
  }
  std::vector<bool> hidden(static_cast<size_t>(input->GetNumberOfCells()));
  for (size_t i = 0; i < tetrahedra.Vertices.size(); ++i) {
    const vtkIdType point = tetrahedra.Vertices[i];
    if (point < tetrahedra.GridPoints && (points->GetValue(point) & vtkDataSetAttributes::HIDDENPOINT)) {
      hidden[static_cast<size_t>(tetrahedra.Cells[i / 4])] = true;
    }
  }
  if (std::find(hidden.begin(), hidden.end(), true) == hidden.end()) {
    return;
  }
  auto* cells = vtkUnsignedCharArray::SafeDownCast(output->GetCellData()->GetArray(vtkDataSetAttributes::GhostArrayName()));
  cells = cells ? cells : output->AllocateCellGhostArray();
  for (size_t i = 0; i < origins.size(); ++i) {
    const auto cell = static_cast<vtkIdType>(i);
    const int flag = hidden[static_cast<size_t>(origins[i])] ? vtkDataSetAttributes::HIDDENCELL : 0;
    cells->SetValue(cell, static_cast<unsigned char>(cells->GetValue(cell) | flag));
  }
}

void SetGeometry(const stratus_partition_result& cut, vtkUnstructuredGrid* output)
{
  vtkNew<vtkDoubleArray> coordinates;
  coordinates->SetNumberOfComponents(3);
  coordinates->SetNumberOfTuples(static_cast<vtkIdType>(cut.point_count));
  std::copy(cut.points, cut.points + 3 * cut.point_count, coordinates->GetPointer(0));
  vtkNew<vtkPoints> points;
  points->SetData(coordinates);
  output->SetPoints(points);
  vtkNew<vtkIdTypeArray> vertices;
  vertices->SetNumberOfTuples(static_cast<vtkIdType>(4 * cut.cell_count));
  std::copy(cut.vertices, cut.vertices + 4 * cut.cell_count, vertices->GetPointer(0));
  vtkNew<vtkCellArray> cells;
  cells->SetData(4, vertices);
  output->SetCells(VTK_TETRA, cells);
}
} // namespace

vtkStratusPartitionFilter::vtkStratusPartitionFilter() : Growth(std::numeric_limits<double>::infinity()), Internal(new Internals(this)) {}

vtkStratusPartitionFilter::~vtkStratusPartitionFilter() = default;

void vtkStratusPartitionFilter::SetDevice(const char* device)
{
  std::string error;
  if (this->Internal->Context.SetDevice(device, this->NumberOfThreads, error)) {
    this->Modified();
  } else if (!error.empty()) {
    vtkErrorMacro(<< error);
  }
}

const char* vtkStratusPartitionFilter::GetDevice()
{
  return this->Internal->Context.GetDevice().c_str();
}

const char* vtkStratusPartitionFilter::GetDeviceName()
{
  std::string error;
  return this->Internal->Context.Prepare(this->NumberOfThreads, error) ? stratus_context_device(this->Internal->Context.Get()) : "";
}

vtkTable* vtkStratusPartitionFilter::GetBuildReport()
{
  return this->Internal->Report;
}

int vtkStratusPartitionFilter::RequestData(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkUnstructuredGrid* input = vtkUnstructuredGrid::GetData(inputs[0]);
  vtkUnstructuredGrid* output = vtkUnstructuredGrid::GetData(outputs);
  std::string error;
  vtkStratusTetrahedra tetrahedra;
  if (!CheckAttributes(input, error) || !tetrahedra.Set(input, error) || !this->Internal->Context.Prepare(this->NumberOfThreads, error)) {
    vtkErrorMacro(<< error);
    return 0;
  }
  stratus_partition_options options = stratus_partition_options_default();
  options.rule = this->Rule == PAPER ? STRATUS_PARTITION_PAPER : STRATUS_PARTITION_MEDIAN;
  options.depth = this->Depth;
  options.planes = this->Planes;
  options.growth = this->Growth;
  options.imbalance = this->Imbalance;
  options.rotations = this->Rotations;
  options.leaf_cells = this->LeafCells;
  const stratus_mesh mesh = tetrahedra.GetMesh();
  stratus_context* context = this->Internal->Context.Get();
  stratus_partition* partition = nullptr;
  stratus_context_start_build_report(context);
  const stratus_status status = stratus_partition_create(context, &mesh, &options, &partition);
  if (status != STRATUS_OK) {
    if (status != STRATUS_CANCELLED) {
      vtkErrorMacro(<< stratus_context_message(context));
    }
    return 0;
  }
  this->Internal->Context.GetBuildReport(this->Internal->Report);
  stratus_partition_result cut;
  stratus_partition_get(partition, &cut);
  SetGeometry(cut, output);
  InterpolatePoints(input->GetPointData(), tetrahedra, cut, output->GetPointData());
  vtkNew<vtkIdTypeArray> original;
  original->SetName(vtkStratusOriginalCellArray);
  std::vector<vtkIdType> origins(static_cast<size_t>(cut.cell_count));
  for (size_t i = 0; i < origins.size(); ++i) {
    origins[i] = tetrahedra.Cells[static_cast<size_t>(cut.cells[i])];
    original->InsertNextValue(origins[i]);
  }
  CopyCells(input->GetCellData(), origins, output->GetCellData());
  HidePieces(input, tetrahedra, origins, output);
  output->GetCellData()->AddArray(original);
  output->GetFieldData()->PassData(input->GetFieldData());
  vtkStratusLeaves::Write(cut.leaves, static_cast<vtkIdType>(cut.cell_count), output);
  this->NumberOfLeaves = cut.leaves.leaf_count;
  this->LargestLeaf = static_cast<vtkIdType>(cut.largest_leaf);
  this->NumberOfTetrahedra = static_cast<vtkIdType>(mesh.cell_count);
  stratus_partition_destroy(partition);
  return 1;
}

void vtkStratusPartitionFilter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Rule: " << (this->Rule == PAPER ? "paper" : "median") << "\n";
  os << indent << "Depth: " << this->Depth << "\n";
  os << indent << "Planes: " << this->Planes << "\n";
  os << indent << "Growth: " << this->Growth << "\n";
  os << indent << "Imbalance: " << this->Imbalance << "\n";
  os << indent << "Rotations: " << this->Rotations << "\n";
  os << indent << "LeafCells: " << this->LeafCells << "\n";
  os << indent << "Device: " << this->GetDevice() << "\n";
  os << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n";
  os << indent << "NumberOfLeaves: " << this->NumberOfLeaves << "\n";
  os << indent << "LargestLeaf: " << this->LargestLeaf << "\n";
  os << indent << "NumberOfTetrahedra: " << this->NumberOfTetrahedra << "\n";
}
