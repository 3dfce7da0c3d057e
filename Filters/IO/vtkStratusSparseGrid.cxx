// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusSparseGrid.h"

#include <cerrno>
#include <cstring>
#include <fstream>

std::unique_ptr<vtkStratusSparseFile> vtkStratusSparseFile::Open(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  char first[8] = {};
  if (!file) {
    throw vtkStratusReadError{ path + ": " + std::strerror(errno) };
  }
  file.read(first, sizeof first);
  // Both libraries begin files with a number whose bytes read as these names.
  if (std::memcmp(first, "NanoVDB0", 8) == 0) {
#ifdef STRATUS_NANOVDB
    return vtkStratusNanoVDBFile(path);
#else
    throw vtkStratusReadError{ path + ": this library was built without NanoVDB (Debian: libnanovdb-dev), which reads .nvdb files" };
#endif
  }
  if (std::memcmp(first, " BDV\0\0\0\0", 8) == 0) {
#ifdef STRATUS_OPENVDB
    return vtkStratusOpenVDBFile(path);
#else
    throw vtkStratusReadError{ path + ": this library was built without OpenVDB (Debian: libopenvdb-dev), which reads .vdb files" };
#endif
  }
  throw vtkStratusReadError{ path + ": it begins as neither a .vdb file of OpenVDB nor a .nvdb file of NanoVDB does" };
}
