// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusLODVolume.h"

#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkStratusLODVolume);
