// SPDX-License-Identifier: BSD-3-Clause
// Arrays of VTK as TetGen's files. All functions throw vtkStratusTetGenError. Private to the module.
#ifndef vtkStratusTetGenWriterFiles_h
#define vtkStratusTetGenWriterFiles_h

#include "vtkStratusTetGenText.h"

class vtkDataArray;
class vtkDataSetAttributes;
class vtkFieldData;
class vtkPointSet;
class vtkPolyData;
class vtkUnstructuredGrid;

// What TetGen calls attributes and markers, of points or cells: "Marker", if it has one component, and the components of all other arrays
// of numbers, save those that are no quantities (neighbors, facets, ids, ghosts).
struct VTK_STRATUS_PRIVATE vtkStratusTetGenColumns {
  // what: "point data" or "cell data", for messages.
  vtkStratusTetGenColumns(vtkDataSetAttributes* data, const char* what);
  void PutAttributes(vtkStratusTetGenOutput& output, vtkIdType tuple) const;
  void PutMarker(vtkStratusTetGenOutput& output, vtkIdType tuple) const; // nothing where there are no markers

  std::string What;
  std::vector<vtkDataArray*> Attributes;
  vtkDataArray* Marker = nullptr;
  vtkIdType Count = 0; // of components
};

// .node, or the first part of .poly and .smesh.
VTK_STRATUS_PRIVATE void vtkStratusTetGenWriteNodes(vtkStratusTetGenOutput& output, vtkPointSet* points, vtkIdType first);
VTK_STRATUS_PRIVATE void vtkStratusTetGenWriteElements(vtkStratusTetGenOutput& output, vtkUnstructuredGrid* mesh, vtkIdType first);
VTK_STRATUS_PRIVATE void vtkStratusTetGenWriteNeighbors(vtkStratusTetGenOutput& output, vtkDataArray* neighbors, vtkIdType first);
// corners: 3 for .face, the polygons; 2 for .edge, the lines.
VTK_STRATUS_PRIVATE void vtkStratusTetGenWritePieces(vtkStratusTetGenOutput& output, vtkPolyData* surface, int corners, vtkIdType first);
// All that follows the points.
VTK_STRATUS_PRIVATE void vtkStratusTetGenWriteComplex(vtkStratusTetGenOutput& output, vtkPolyData* surface, bool smesh, vtkIdType first);

#endif
