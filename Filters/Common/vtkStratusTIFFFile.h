// SPDX-License-Identifier: BSD-3-Clause
// What VTK's reader of TIFF leaves out. Private to the modules, never installed.
#ifndef vtkStratusTIFFFile_h
#define vtkStratusTIFFFile_h

#include "vtkStratusPrivate.h"

#include <string>

// Returns where the first row and column lie, as the file's first page says: 1..8, the numbers of TIFF's tag Orientation (1: at the top
// and the left, where nothing is said; 4: at the bottom and the left); 0 for what is no file of TIFF.
VTK_STRATUS_PRIVATE int vtkStratusTIFFOrientation(const std::string& path);

#endif
