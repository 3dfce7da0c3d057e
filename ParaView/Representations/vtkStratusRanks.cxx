// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusRanks.h"

#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkMultiProcessController.h"
#include "vtkPlane.h"
#include "vtkPlaneCollection.h"
#include "vtkPropCollection.h"
#include "vtkRenderer.h"

#include <vector>

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

std::string stratus::agree_on_array(vtkMultiProcessController* controller, const std::string& mine, bool& on_cells)
{
  constexpr size_t length = 257; // what it is of, the name, 0
  std::vector<char> own(length, 0), all(length * static_cast<size_t>(controller->GetNumberOfProcesses()));
  own[0] = on_cells ? 1 : 0;
  mine.copy(&own[1], length - 2);
  controller->AllGather(own.data(), all.data(), static_cast<vtkIdType>(length));
  for (size_t at = 0; at < all.size(); at += length) {
    if (all[at + 1]) {
      on_cells = all[at] != 0;
      return std::string(&all[at + 1]);
    }
  }
  return std::string();
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
