// SPDX-License-Identifier: BSD-3-Clause
// Arrays of readers. Private to the module.
#ifndef vtkStratusMakeArray_h
#define vtkStratusMakeArray_h

#include "vtkDataArray.h"
#include "vtkSmartPointer.h"

#include <cstdlib>
#include <new>

// Returns an array of zeros, which the system gives a page of only where something is written. Throws std::bad_alloc, where VTK's own
// allocation may end the program.
inline vtkSmartPointer<vtkDataArray> vtkStratusMakeArray(int type, int components, vtkIdType tuples)
{
  auto array = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(type));
  const vtkIdType values = tuples * components;
  void* memory = std::calloc(static_cast<size_t>(values), static_cast<size_t>(array->GetDataTypeSize()));
  if (!memory) {
    throw std::bad_alloc();
  }
  array->SetNumberOfComponents(components);
  array->SetVoidArray(memory, values, 0, vtkAbstractArray::VTK_DATA_ARRAY_FREE);
  return array;
}

#endif
