// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusTetGenWriter
 * @brief   writes files that TetGen reads: .node, .ele, .neigh, .face and .edge of a mesh, .poly or .smesh of a surface
 *
 * Input 0 is one of
 * - a vtkUnstructuredGrid of tetrahedra, all linear or all quadratic. The writer writes .node and .ele, and .neigh if there are
 *   cell data "Neighbors" of four components. A grid without cells gives only .node. The optional input 1, a vtkPolyData over
 *   the same points, adds .face (its triangles) and .edge (its lines); a quadratic mesh accepts none.
 * - a vtkPolyData. The writer writes .poly if FileName says so, else .smesh, with the points in the same file. Polygons are
 *   facets; polygons with the same cell data "Facet" are one facet, which only .poly can hold. Lines of two points are edges
 *   to keep. The field data "Holes" (3 components), "Regions" (5: a point, the attribute, the largest volume) and "FacetHoles"
 *   (4: facet, point) are written, too.
 *
 * An array "Marker" of one component becomes the markers. The components of all other numeric arrays become attributes, without their
 * names. Numbers are written with the digits that restore the same double.
 *
 * Files take their names when all are complete. If writing fails or is aborted, previous files stay as they were.
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
   * Set/Get one of the files to write, or the common part of their names. Default none.
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  //@}

  //@{
  /**
   * Set/Get the number of the first point, tetrahedron, face ... in the files: 0 (default) or 1.
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
