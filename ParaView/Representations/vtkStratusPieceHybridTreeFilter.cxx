// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusPieceHybridTreeFilter.h"

#include "vtkStratusRanks.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkIdTypeArray.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

#include <vector>

vtkStandardNewMacro(vtkStratusPieceHybridTreeFilter);

vtkStratusPieceHybridTreeFilter::vtkStratusPieceHybridTreeFilter() = default;
vtkStratusPieceHybridTreeFilter::~vtkStratusPieceHybridTreeFilter() = default;

int vtkStratusPieceHybridTreeFilter::RequestData(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkDataSet* input = vtkDataSet::GetData(inputs[0]);
  const bool empty = stratus::count_ranks() > 1 && (!input || input->GetNumberOfCells() == 0);
  const int done = empty ? 1 : this->Superclass::RequestData(request, inputs, outputs);
  vtkCellData* boxes = vtkPolyData::GetData(outputs, 1)->GetCellData();
  vtkDataArray* kinds = !empty && done ? boxes->GetArray("Kind") : nullptr;
  const vtkIdType count = kinds ? kinds->GetNumberOfTuples() : 0;
  vtkNew<vtkIdTypeArray> nodes, leaves;
  nodes->SetName("StratusGlobalNode");
  leaves->SetName("StratusGlobalLeaf");
  vtkIdType number_of_leaves = 0;
  for (vtkIdType node = 0; node < count; ++node) {
    number_of_leaves += kinds->GetTuple1(node) != 0.0;
  }
  const std::vector<vtkIdType> before = stratus::count_before({ count, number_of_leaves });
  vtkIdType leaf = before[1];
  for (vtkIdType node = 0; node < count; ++node) {
    nodes->InsertNextValue(before[0] + node);
    leaves->InsertNextValue(kinds->GetTuple1(node) != 0.0 ? leaf++ : -1);
  }
  if (kinds) {
    boxes->AddArray(nodes);
    boxes->AddArray(leaves);
  }
  return done;
}
