// SPDX-License-Identifier: BSD-3-Clause
// What readers throw within the module, and tell as VTK's error. Private to the module.
#ifndef vtkStratusReadError_h
#define vtkStratusReadError_h

#include <string>

// What is wrong with a file, as a sentence that begins with the file's name.
struct vtkStratusReadError {
  std::string Text;
};

#endif
