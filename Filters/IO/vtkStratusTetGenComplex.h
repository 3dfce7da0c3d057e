// SPDX-License-Identifier: BSD-3-Clause
// TetGen's .poly and .smesh files: a surface of polygons (a piecewise linear complex), seeds of holes and of regions. Private to the
// module.
#ifndef vtkStratusTetGenComplex_h
#define vtkStratusTetGenComplex_h

#include "vtkStratusTetGenMesh.h"

class vtkPolyData;

// The facets, holes and regions, whatever follows the point list. The surface has cell data "Marker" and "Facet" and field data "Holes",
// "Regions" and "FacetHoles" as vtkStratusTetGenReader tells. Throws vtkStratusTetGenError.
VTK_STRATUS_PRIVATE void vtkStratusTetGenReadComplex(
  vtkStratusTetGenInput& input, bool smesh, const vtkStratusTetGenNodes& nodes, vtkPolyData* surface);

#endif
