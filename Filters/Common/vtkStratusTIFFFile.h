// SPDX-License-Identifier: BSD-3-Clause
// What VTK's reader of TIFF leaves out. Private to the modules, never installed.
#ifndef vtkStratusTIFFFile_h
#define vtkStratusTIFFFile_h

#include "vtkStratusPrivate.h"

#include <string>

// Returns the position of the first row and column by the file's first page: 1..8, the values of TIFF's tag Orientation (1, also without
// the tag: top left; 4: bottom left); 0 if the file is not TIFF.
VTK_STRATUS_PRIVATE int vtkStratusTIFFOrientation(const std::string& path);

#endif
