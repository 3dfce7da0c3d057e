// SPDX-License-Identifier: BSD-3-Clause
// OpenGL's functions as VTK loads them: by glew up to 9.3, by glad after that.
#pragma once

#if __has_include("vtk_glad.h")
#include "vtk_glad.h"
#else
#include "vtk_glew.h"
#endif
