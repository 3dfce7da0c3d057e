// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusTetGenWriter
 * @brief   writes files that TetGen reads: .node, .ele, .neigh, .face and .edge of a mesh, .poly or .smesh of a surface
 *
 * Input 0 is one of
 * - a vtkUnstructuredGrid of tetrahedra, all linear or all quadratic: writes .node and .ele, and .neigh if there are cell data "Neighbors"
 * of four components. A grid without cells gives .node alone. The optional input 1, a vtkPolyData over the same points, adds .face (its
 *   triangles) and .edge (its lines); a quadratic mesh takes none.
 * - a vtkPolyData: writes .poly if FileName says so, else .smesh, its points in the same file. Its polygons are facets; those of the same
 * cell data "Facet" are one facet, which only .poly can hold. Lines of two points are edges to keep. Field data "Holes" (3 components),
 * "Regions" (5: a point, the attribute, the largest volume) and "FacetHoles" (4: facet, point).
 *
 * An array "Marker" of one component becomes the markers, the components of all other arrays of numbers become attributes; their names are
 * lost. Numbers are written with the digits that bring back the same double.
 *
 * Files take their names when all are complete: where writing fails or is aborted, files that were there stay as they were.
 *
 * @sa vtkStratusTetGenReader
 */
#ifndef vtkStratusTetGenWriter_h
#define vtkStratusTetGenWriter_h

#include "StratusFiltersIOModule.h" // For export macro
#include "vtkWriter.h"

#include <memory> // For std::unique_ptr

class STRATUSFILTERSIO_EXPORT vtkStratusTetGenWriter : public vtkWriter
{
public:
  static vtkStratusTetGenWriter* New();
  vtkTypeMacro(vtkStratusTetGenWriter, vtkWriter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  //@{
  /**
   * One of the files to write, or what the names of all shall have in common. Default none.
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  //@}

  //@{
  /**
   * The number of the first point, tetrahedron, face ... in the files: 0 (default) or 1.
   */
  vtkSetClampMacro(FirstNumber, int, 0, 1);
  vtkGetMacro(FirstNumber, int);
  //@}

protected:
  vtkStratusTetGenWriter();
  ~vtkStratusTetGenWriter() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  void WriteData() override;

  char* FileName = nullptr;
  int FirstNumber = 0;

private:
  vtkStratusTetGenWriter(const vtkStratusTetGenWriter&) = delete;
  void operator=(const vtkStratusTetGenWriter&) = delete;

  class Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
