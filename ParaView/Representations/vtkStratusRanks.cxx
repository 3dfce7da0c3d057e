// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusRanks.h"

#include "vtkMath.h"
#include "vtkMultiProcessController.h"

int stratus::count_ranks()
{
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  return controller ? controller->GetNumberOfProcesses() : 1;
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
