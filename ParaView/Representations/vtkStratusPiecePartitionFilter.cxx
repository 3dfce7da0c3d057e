// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusPiecePartitionFilter.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
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
  vtkMultiProcessController* ranks = vtkMultiProcessController::GetGlobalController();
  const int count = ranks ? ranks->GetNumberOfProcesses() : 1;
  const bool empty = count > 1 && input->GetNumberOfCells() == 0;
  const int done = empty ? 1 : this->Superclass::RequestData(request, inputs, outputs);
  vtkDataArray* leaves = output->GetCellData()->GetArray("StratusLeaf");
  const vtkIdType mine[2] = { !empty && done && leaves ? this->NumberOfLeaves : 0, input->GetNumberOfCells() };
  std::vector<vtkIdType> all(2 * static_cast<size_t>(count));
  std::copy_n(mine, 2, all.begin());
  if (count > 1) {
    ranks->AllGather(mine, all.data(), 2);
  }
  vtkIdType leaves_before = 0, cells_before = 0;
  for (int rank = 0; ranks && rank < ranks->GetLocalProcessId(); ++rank) {
    leaves_before += all[2 * static_cast<size_t>(rank)];
    cells_before += all[2 * static_cast<size_t>(rank) + 1];
  }
  vtkDataArray* ids = input->GetCellData()->GetGlobalIds();
  if (!empty && done) {
    add_global(output->GetCellData(), "StratusLeaf", "StratusGlobalLeaf", [=](vtkIdType leaf) { return leaves_before + leaf; });
    add_global(output->GetCellData(), "StratusOriginalCell", "StratusGlobalOriginalCell",
      [=](vtkIdType cell) { return ids ? static_cast<vtkIdType>(ids->GetTuple1(cell)) : cells_before + cell; });
  }
  return done;
}
