// SPDX-License-Identifier: BSD-3-Clause
// Structural similarity of two pictures (Wang et al., IEEE Transactions on Image Processing 13(4), 2004). Private to the module.
#ifndef vtkStratusSimilarity_h
#define vtkStratusSimilarity_h

#include "vtkStratusPrivate.h"

#include <vector>

// Pixels along a window's edge; a picture has at least as many along each axis.
constexpr int vtkStratusSimilarityWindow = 11;

// Returns the mean over all windows within the picture, of one component in 0..1: a[y * width + x].
VTK_STRATUS_PRIVATE double vtkStratusSimilarity(const std::vector<double>& a, const std::vector<double>& b, int width, int height);

#endif
