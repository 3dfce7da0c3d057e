// SPDX-License-Identifier: BSD-3-Clause
// The lock of libhdf5, and of libnetcdf, which calls it. Private to the module.
#ifndef vtkStratusHDF5Lock_h
#define vtkStratusHDF5Lock_h

#include "vtkStratusPrivate.h"

#include <mutex>

// Both libraries serve one thread at a time: readers hold this lock, and so does what reads bricks.
VTK_STRATUS_PRIVATE inline std::recursive_mutex& vtkStratusHDF5Lock()
{
  static std::recursive_mutex lock;
  return lock;
}

#endif
