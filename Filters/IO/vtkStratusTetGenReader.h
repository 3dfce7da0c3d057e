// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusTetGenReader
 * @brief   reads TetGen's files: .node, .ele, .neigh, .face, .edge, .poly and .smesh
 *
 * FileName names one file of a mesh, or the common part of the names (mesh.1). The mesh's other files are in the same folder (mesh.1.node,
 * mesh.1.ele ...).
 *
 * From .node, .ele, .neigh, .face and .edge: the first output is a vtkUnstructuredGrid of linear or quadratic tetrahedra. The .node file
 * must exist; the others may be missing unless FileName names them. The second output is a vtkPolyData of edges and faces over the same
 * points, without the midpoints of second-order edges.
 *
 * From .poly and .smesh (with points in the same file, or in the .node file next to it): the second output holds the surface, the first
 * holds points without cells.
 *
 * | array | where | |
 * |---|---|---|
 * | Attribute1, Attribute2 ... (double) | point data of both outputs, cell data of the first | of points and tetrahedra |
 * | Marker (int) | point data of both, cell data of the second | of points, faces, edges, facets, if the files have markers |
 * | Neighbors (vtkIdType, 4) | cell data of the first | the tetrahedron opposite each corner, -1 for none |
 * | Facet (vtkIdType) | cell data of the second | .poly and .smesh: polygons with the same number are one facet |
 * | Holes (double, 3) | field data of the second | .poly and .smesh: a point in each hole |
 * | Regions (double, 5) | field data of the second | .poly and .smesh: a point in each region, attribute, largest volume |
 * | FacetHoles (double, 4) | field data of the second | .poly: a facet's number and a point in a hole of it |
 *
 * The first attribute is the active scalars. If TetGen was run with regions, the last attribute of a tetrahedron is its region's.
 *
 * If the first point's number is 0, the mesh's files count from 0, otherwise from 1. Outputs count from 0. An error names the file, the
 * line, the value and the allowed values, and empties both outputs. The reader reads files in pieces of a megabyte and allocates no more
 * than a file can fill.
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
   * Set/Get a file of the mesh, or the common part of the files' names. Default none.
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  //@}

  //@{
  /**
   * Set/Get whether to read the .face, .edge and .neigh files that exist. A file that FileName names is always read. Default on.
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
   * Get the second output.
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
