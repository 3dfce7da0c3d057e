// SPDX-License-Identifier: BSD-3-Clause
// Writes VTK's arrays as TetGen's files. All functions throw vtkStratusTetGenError. Private to the module.
#ifndef vtkStratusTetGenWriterFiles_h
#define vtkStratusTetGenWriterFiles_h

#include "vtkStratusTetGenText.h"

class vtkDataArray;
class vtkDataSetAttributes;
class vtkFieldData;
class vtkPointSet;
class vtkPolyData;
class vtkUnstructuredGrid;

// TetGen's attributes and markers of points or cells. The array "Marker", if it has one component, holds the markers. The components of all
// other numeric arrays are attributes, except arrays that hold no quantities (neighbors, facets, ids, ghosts).
struct VTK_STRATUS_PRIVATE vtkStratusTetGenColumns {
  // `what`: "point data" or "cell data", for messages.
  vtkStratusTetGenColumns(vtkDataSetAttributes* data, const char* what);
  void PutAttributes(vtkStratusTetGenOutput& output, vtkIdType tuple) const;
  void PutMarker(vtkStratusTetGenOutput& output, vtkIdType tuple) const; // writes nothing where there are no markers

  std::string What;
  std::vector<vtkDataArray*> Attributes;
  vtkDataArray* Marker = nullptr;
  vtkIdType Count = 0; // total number of components
};

// Writes a .node file, or the first part of a .poly or .smesh file.
VTK_STRATUS_PRIVATE void vtkStratusTetGenWriteNodes(vtkStratusTetGenOutput& output, vtkPointSet* points, vtkIdType first);
VTK_STRATUS_PRIVATE void vtkStratusTetGenWriteElements(vtkStratusTetGenOutput& output, vtkUnstructuredGrid* mesh, vtkIdType first);
VTK_STRATUS_PRIVATE void vtkStratusTetGenWriteNeighbors(vtkStratusTetGenOutput& output, vtkDataArray* neighbors, vtkIdType first);
// `corners`: 3 writes polygons as a .face file, 2 writes lines as an .edge file.
VTK_STRATUS_PRIVATE void vtkStratusTetGenWritePieces(vtkStratusTetGenOutput& output, vtkPolyData* surface, int corners, vtkIdType first);
// Writes all that follows the points of a .poly or .smesh file.
VTK_STRATUS_PRIVATE void vtkStratusTetGenWriteComplex(vtkStratusTetGenOutput& output, vtkPolyData* surface, bool smesh, vtkIdType first);

#endif
