// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusTetGenReader
 * @brief   reads what TetGen reads and writes: .node, .ele, .neigh, .face, .edge, .poly and .smesh
 *
 * FileName names one file of a mesh, whose other files lie beside it (mesh.1.node, mesh.1.ele ...), or what their names have in common
 * (mesh.1).
 *
 * Of .node, .ele, .neigh, .face and .edge: the first output is a vtkUnstructuredGrid of tetrahedra, linear or quadratic; the .node file
 * must be there, all others may be missing unless FileName names them. The second output is a vtkPolyData of edges and faces over the same
 * points. Faces and edges of second-order meshes come without the points in the middle of their edges.
 *
 * Of .poly and .smesh (points in the same file, or in the .node file beside it): the second output holds the surface, the first is points
 * without cells.
 *
 * | array | where | |
 * |---|---|---|
 * | Attribute1, Attribute2 ... (double) | point data of both outputs, cell data of the first | of points and tetrahedra |
 * | Marker (int) | point data of both, cell data of the second | of points, faces, edges, facets, where the files have markers |
 * | Neighbors (vtkIdType, 4) | cell data of the first | the tetrahedron opposite each corner, -1 for none |
 * | Facet (vtkIdType) | cell data of the second | of .poly and .smesh: polygons of the same number are one facet |
 * | Holes (double, 3), Regions (double, 5) | field data of the second | of .poly and .smesh: a point in each; Regions: attribute, largest
 * volume | | FacetHoles (double, 4) | field data of the second | of .poly: a facet's number and a point in a hole of it |
 *
 * The first attributes are the scalars. A tetrahedron's last is its region's, if TetGen was asked for regions.
 *
 * Files count from 0 or from 1, told by the first point's number; outputs count from 0. What is wrong is told with the file, the line, the
 * value and what it must be; both outputs are empty then. Files of any size are read in pieces of a megabyte, and no more is allocated than
 * a file can fill.
 *
 * @sa vtkStratusTetGenWriter vtkStratusTetGenFilter
 */
#ifndef vtkStratusTetGenReader_h
#define vtkStratusTetGenReader_h

#include "StratusFiltersIOModule.h" // For export macro
#include "vtkUnstructuredGridAlgorithm.h"

#include <memory> // For std::unique_ptr

class vtkPolyData;

class STRATUSFILTERSIO_EXPORT vtkStratusTetGenReader : public vtkUnstructuredGridAlgorithm
{
public:
  static vtkStratusTetGenReader* New();
  vtkTypeMacro(vtkStratusTetGenReader, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  //@{
  /**
   * A file of the mesh, or what the names of all have in common. Default none.
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  //@}

  //@{
  /**
   * Whether to read .face, .edge and .neigh files that are there. Default on. One that FileName names is read in any case.
   */
  vtkSetClampMacro(ReadFaces, vtkTypeBool, 0, 1);
  vtkGetMacro(ReadFaces, vtkTypeBool);
  vtkBooleanMacro(ReadFaces, vtkTypeBool);
  vtkSetClampMacro(ReadEdges, vtkTypeBool, 0, 1);
  vtkGetMacro(ReadEdges, vtkTypeBool);
  vtkBooleanMacro(ReadEdges, vtkTypeBool);
  vtkSetClampMacro(ReadNeighbors, vtkTypeBool, 0, 1);
  vtkGetMacro(ReadNeighbors, vtkTypeBool);
  vtkBooleanMacro(ReadNeighbors, vtkTypeBool);
  //@}

  /**
   * The second output.
   */
  vtkPolyData* GetSurface();

protected:
  vtkStratusTetGenReader();
  ~vtkStratusTetGenReader() override;

  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  char* FileName = nullptr;
  vtkTypeBool ReadFaces = 1;
  vtkTypeBool ReadEdges = 1;
  vtkTypeBool ReadNeighbors = 1;

private:
  vtkStratusTetGenReader(const vtkStratusTetGenReader&) = delete;
  void operator=(const vtkStratusTetGenReader&) = delete;

  class Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
