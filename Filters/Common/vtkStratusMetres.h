// SPDX-License-Identifier: BSD-3-Clause
// The unit of length of a data object's coordinates, which its field data may have.
#ifndef vtkStratusMetres_h
#define vtkStratusMetres_h

#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkFieldData.h"

#include <cmath>

// The name of an array of one number in field data: metres of a unit of the coordinates.
constexpr const char* vtkStratusMetresPerUnitName = "MetresPerUnit";

// Returns that number; 0 where there is none above 0 and finite. data: may be NULL.
inline double vtkStratusMetresPerUnit(vtkDataObject* data)
{
  vtkDataArray* array = data && data->GetFieldData() ? data->GetFieldData()->GetArray(vtkStratusMetresPerUnitName) : nullptr;
  const double metres = array && array->GetNumberOfTuples() > 0 ? array->GetComponent(0, 0) : 0.0;
  return metres > 0.0 && std::isfinite(metres) ? metres : 0.0;
}

#endif
