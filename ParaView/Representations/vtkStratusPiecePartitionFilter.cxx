// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusPiecePartitionFilter.h"

#include "vtkStratusRanks.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkUnstructuredGrid.h"

#include <vector>

vtkStandardNewMacro(vtkStratusPiecePartitionFilter);

vtkStratusPiecePartitionFilter::vtkStratusPiecePartitionFilter() = default;
vtkStratusPiecePartitionFilter::~vtkStratusPiecePartitionFilter() = default;

namespace {

// Adds an array of `from`'s numbers, each as `convert` has it.
template <typename Convert> void add_global(vtkCellData* cells, const char* from, const char* name, Convert&& convert)
{
  vtkDataArray* numbers = cells->GetArray(from);
  vtkNew<vtkIdTypeArray> global;
  global->SetName(name);
  for (vtkIdType cell = 0; numbers && cell < numbers->GetNumberOfTuples(); ++cell) {
    global->InsertNextValue(convert(static_cast<vtkIdType>(numbers->GetTuple1(cell))));
  }
  if (numbers) {
    cells->AddArray(global);
  }
}
} // namespace

int vtkStratusPiecePartitionFilter::RequestData(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkUnstructuredGrid* input = vtkUnstructuredGrid::GetData(inputs[0]);
  vtkUnstructuredGrid* output = vtkUnstructuredGrid::GetData(outputs);
  const bool empty = stratus::count_ranks() > 1 && input->GetNumberOfCells() == 0;
  const int done = empty ? 1 : this->Superclass::RequestData(request, inputs, outputs);
  vtkDataArray* leaves = output->GetCellData()->GetArray("StratusLeaf");
  const std::vector<vtkIdType> before =
    stratus::count_before({ !empty && done && leaves ? this->NumberOfLeaves : 0, input->GetNumberOfCells() });
  const vtkIdType leaves_before = before[0], cells_before = before[1];
  vtkDataArray* ids = input->GetCellData()->GetGlobalIds();
  if (!empty && done) {
    add_global(output->GetCellData(), "StratusLeaf", "StratusGlobalLeaf", [=](vtkIdType leaf) { return leaves_before + leaf; });
    add_global(output->GetCellData(), "StratusOriginalCell", "StratusGlobalOriginalCell",
      [=](vtkIdType cell) { return ids ? static_cast<vtkIdType>(ids->GetTuple1(cell)) : cells_before + cell; });
  }
  return done;
}
