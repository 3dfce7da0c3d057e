// SPDX-License-Identifier: BSD-3-Clause
// Pictures from files and to files, by VTK's readers and writers and ours of OpenEXR. Private to the module.
#ifndef vtkStratusPictureFile_h
#define vtkStratusPictureFile_h

#include "vtkStratusPrivate.h"

#include "vtkSmartPointer.h"

#include <string>

class vtkImageData;

// Reads .exr, and what VTK reads as an image. Throws std::runtime_error with a sentence.
VTK_STRATUS_PRIVATE vtkSmartPointer<vtkImageData> vtkStratusReadPicture(const std::string& path);

// Writes .png or .exr. Throws std::runtime_error with a sentence.
VTK_STRATUS_PRIVATE void vtkStratusWritePicture(vtkImageData* image, const std::string& path);

#endif
