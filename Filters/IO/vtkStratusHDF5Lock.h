// SPDX-License-Identifier: BSD-3-Clause
// The lock of libhdf5, and of libnetcdf, which calls it. Private to the module.
#ifndef vtkStratusHDF5Lock_h
#define vtkStratusHDF5Lock_h

#include "vtkStratusPrivate.h"

#include <mutex>
#ifdef STRATUS_HDF5
#include <hdf5.h>
#endif

// Both libraries serve one thread at a time: readers hold this lock, and so does what reads bricks.
VTK_STRATUS_PRIVATE inline std::recursive_mutex& vtkStratusHDF5Lock()
{
  static std::recursive_mutex lock;
  return lock;
}

// Holds the lock, and keeps libhdf5 from printing errors meanwhile. libhdf5 prints the errors of each thread that does not switch that off;
// libnetcdf, which looks for attributes that no file needs to have, does so in one thread only.
class VTK_STRATUS_PRIVATE vtkStratusHDF5Call
{
public:
  vtkStratusHDF5Call() : Lock(vtkStratusHDF5Lock())
  {
#ifdef STRATUS_HDF5
    H5Eget_auto2(H5E_DEFAULT, &this->Function, &this->Data);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
#endif
  }
  ~vtkStratusHDF5Call()
  {
#ifdef STRATUS_HDF5
    H5Eset_auto2(H5E_DEFAULT, this->Function, this->Data);
#endif
  }
  vtkStratusHDF5Call(const vtkStratusHDF5Call&) = delete;
  void operator=(const vtkStratusHDF5Call&) = delete;

private:
  const std::lock_guard<std::recursive_mutex> Lock;
#ifdef STRATUS_HDF5
  H5E_auto2_t Function = nullptr;
  void* Data = nullptr;
#endif
};

#endif
