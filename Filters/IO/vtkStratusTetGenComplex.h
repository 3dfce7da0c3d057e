// SPDX-License-Identifier: BSD-3-Clause
// Reads TetGen's .poly and .smesh files: a surface of polygons (a piecewise linear complex) with seeds of holes and regions. Private to the
// module.
#ifndef vtkStratusTetGenComplex_h
#define vtkStratusTetGenComplex_h

#include "vtkStratusTetGenMesh.h"

class vtkPolyData;

// Reads the facets, holes and regions that follow the point list. The surface gets the cell data "Marker" and "Facet" and the field data
// "Holes", "Regions" and "FacetHoles" that vtkStratusTetGenReader documents. Throws vtkStratusTetGenError.
VTK_STRATUS_PRIVATE void vtkStratusTetGenReadComplex(
  vtkStratusTetGenInput& input, bool smesh, const vtkStratusTetGenNodes& nodes, vtkPolyData* surface);

#endif
