// SPDX-License-Identifier: BSD-3-Clause
// Bricks of a netCDF variable: chunks of the file, read when something looks at their values. Private to the module.
#ifndef vtkStratusNetCDFBricks_h
#define vtkStratusNetCDFBricks_h

#include "vtkStratusNetCDFFile.h"
#include "vtkStratusParts.h"

#include <array>

// Which part of a variable an array shows. For each of the variable's dimensions: the axis that it is, or -1 and the index at which it is
// read.
struct vtkStratusNetCDFPart {
  std::vector<int> Axes;
  std::vector<size_t> Indices;
  std::array<size_t, 3> Lengths;                             // along x, y, z
  std::array<bool, 3> Flipped = { { false, false, false } }; // the file's last value is the array's first
  vtkStratusBox Box;                                         // what is made of it

  // Returns how many values of the array's first chunk precede the array: the file's last chunk, which may not be whole.
  int64_t BeforeFirst(size_t axis, int64_t chunk) const
  {
    const int64_t rest = static_cast<int64_t>(this->Lengths[axis]) % chunk;
    return this->Flipped[axis] && rest > 0 ? chunk - rest : 0;
  }
};

// Returns the array, x fastest, with values as vtkStratusNetCDFFile::Read() gives them; null where it can't be made. The file is opened
// anew, for as long as the array has its values: by libhdf5, if that reads the chunks in several threads, or by libnetcdf, in one.
vtkSmartPointer<vtkDataArray> vtkStratusMakeNetCDFBricks(
  const vtkStratusNetCDFFile& file, const vtkStratusNetCDFVariable& variable, const vtkStratusNetCDFPart& part);

#endif
