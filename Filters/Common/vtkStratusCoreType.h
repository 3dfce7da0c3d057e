// SPDX-License-Identifier: BSD-3-Clause
// VTK's types of numbers as the core's. Private to the modules, never installed.
#ifndef vtkStratusCoreType_h
#define vtkStratusCoreType_h

#include "stratus/volume.h"

#include "vtkType.h"

// Returns false for a type that the core does not have.
inline bool vtkStratusCoreType(int type, stratus_type& result)
{
  switch (type) {
    case VTK_CHAR:
      result = static_cast<char>(-1) < 0 ? STRATUS_INT8 : STRATUS_UINT8;
      return true;
    case VTK_SIGNED_CHAR:
      result = STRATUS_INT8;
      return true;
    case VTK_UNSIGNED_CHAR:
      result = STRATUS_UINT8;
      return true;
    case VTK_SHORT:
      result = STRATUS_INT16;
      return true;
    case VTK_UNSIGNED_SHORT:
      result = STRATUS_UINT16;
      return true;
    case VTK_INT:
      result = STRATUS_INT32;
      return true;
    case VTK_UNSIGNED_INT:
      result = STRATUS_UINT32;
      return true;
    case VTK_LONG:
      result = sizeof(long) == 8 ? STRATUS_INT64 : STRATUS_INT32;
      return true;
    case VTK_UNSIGNED_LONG:
      result = sizeof(long) == 8 ? STRATUS_UINT64 : STRATUS_UINT32;
      return true;
    case VTK_LONG_LONG:
      result = STRATUS_INT64;
      return true;
    case VTK_UNSIGNED_LONG_LONG:
      result = STRATUS_UINT64;
      return true;
    case VTK_ID_TYPE:
      result = sizeof(vtkIdType) == 8 ? STRATUS_INT64 : STRATUS_INT32;
      return true;
    case VTK_FLOAT:
      result = STRATUS_FLOAT32;
      return true;
    case VTK_DOUBLE:
      result = STRATUS_FLOAT64;
      return true;
    default:
      return false;
  }
}

#endif
