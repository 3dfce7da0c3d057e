// SPDX-License-Identifier: BSD-3-Clause
// Exception of readers within the module, which they report as VTK's error. Private to the module.
#ifndef vtkStratusReadError_h
#define vtkStratusReadError_h

#include <string>

// The fault of a file, as a sentence that begins with the file's name.
struct vtkStratusReadError {
  std::string Text;
};

#endif
