// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusSlice.h"

#include "vtkCylinder.h"
#include "vtkMath.h"
#include "vtkPlane.h"
#include "vtkQuadric.h"
#include "vtkSphere.h"
#include "vtkVolumeProperty.h"
#if __has_include("vtkCone.h") // which smaller builds of VTK leave out
#include "vtkCone.h"
#endif

#include <algorithm>
#include <cmath>

bool vtkStratusSetSlice(vtkVolumeProperty* property, stratus_slice& slice, std::string& error)
{
  vtkImplicitFunction* function = property->GetSliceFunction();
  if (!function) {
    error = "blend mode slice (6) needs a SliceFunction";
  } else if (vtkPlane* plane = vtkPlane::SafeDownCast(function)) {
    plane->GetOrigin(slice.center);
    plane->GetNormal(slice.linear);
  } else if (vtkSphere* sphere = vtkSphere::SafeDownCast(function)) {
    sphere->GetCenter(slice.center);
    std::fill_n(slice.square, 3, 1.0);
    slice.constant = -sphere->GetRadius() * sphere->GetRadius();
  } else if (vtkCylinder* cylinder = vtkCylinder::SafeDownCast(function)) {
    double axis[3];
    cylinder->GetCenter(slice.center);
    cylinder->GetAxis(axis);
    vtkMath::Normalize(axis);
    for (int i = 0; i < 3; ++i) {
      slice.square[i] = 1.0 - axis[i] * axis[i];
      slice.square[3 + i] = -2.0 * axis[i] * axis[(i + 1) % 3];
    }
    slice.constant = -cylinder->GetRadius() * cylinder->GetRadius();
#ifdef vtkCone_h
  } else if (vtkCone* cone = vtkCone::SafeDownCast(function)) {
    const double slope = std::tan(vtkMath::RadiansFromDegrees(cone->GetAngle()));
    slice.square[0] = -slope * slope;
    slice.square[1] = slice.square[2] = 1.0;
#endif
  } else if (vtkQuadric* quadric = vtkQuadric::SafeDownCast(function)) {
    const double* coefficients = quadric->GetCoefficients();
    std::copy_n(coefficients, 6, slice.square);
    std::copy_n(coefficients + 6, 3, slice.linear);
    slice.constant = coefficients[9];
  } else {
    error = std::string("a SliceFunction of class ") + function->GetClassName() +
      " is not supported, only vtkPlane, vtkSphere, vtkCylinder, vtkCone and vtkQuadric are";
  }
  return error.empty();
}
