// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusTetGenFilter
 * @brief   fills a closed surface with tetrahedra by TetGen
 *
 * Input: a vtkPolyData whose polygons and strips enclose a volume and do not cross each other; polygons are planar. Walls inside are kept.
 * Vertices are points that the mesh must have; lines are ignored. Points with equal coordinates are merged, unused points dropped. The cell
 * data "Marker" (integer) mark facets. The field data "Holes" (3 components) and "Regions" (5 components: a point, an attribute, the
 * largest volume or 0) add to AddHole() and AddRegion(). vtkStratusTetGenReader reads these arrays from a .smesh file.
 *
 * First output: a vtkUnstructuredGrid of linear tetrahedra, none of them inverted. Its point data "vtkOriginalPointIds" are -1 for points
 * that TetGen added. If there are regions, its cell data "Region" (double) hold their attributes. Second output: the triangles of the
 * mesh's boundary and inner walls over the same points, with the cell data "Marker" (int; 1 where the input has none).
 *
 * TetGen runs in a process of its own, the program stratus-tetgen. It may crash on surfaces that cross themselves and may run without end
 * for a quality that cannot be reached; the filter then reports an error. Outputs are empty after an error.
 *
 * TetGen is under the AGPL: see the module's README.
 *
 * @sa vtkStratusTetGenReader vtkStratusTetGenWriter
 */
#ifndef vtkStratusTetGenFilter_h
#define vtkStratusTetGenFilter_h

#include "StratusFiltersTetGenModule.h" // For export macro
#include "vtkUnstructuredGridAlgorithm.h"

#include <memory> // For std::unique_ptr

class vtkPolyData;

class STRATUSFILTERSTETGEN_EXPORT vtkStratusTetGenFilter : public vtkUnstructuredGridAlgorithm
{
public:
  static vtkStratusTetGenFilter* New();
  vtkTypeMacro(vtkStratusTetGenFilter, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  //@{
  /**
   * Set/Get whether TetGen adds points until the tetrahedra are well shaped. Default on.
   */
  vtkSetClampMacro(Quality, vtkTypeBool, 0, 1);
  vtkGetMacro(Quality, vtkTypeBool);
  vtkBooleanMacro(Quality, vtkTypeBool);
  //@}

  //@{
  /**
   * Set/Get the bounds on shape that Quality imposes: the largest ratio of a tetrahedron's circumradius to its shortest edge, above 0 and
   * up to 1e6, and the smallest dihedral angle in degrees, 0..70. Default 2 and 0. Below a ratio of 1.2 or above an angle of 18 TetGen may
   * not end. Next to small angles of the surface TetGen accepts worse tetrahedra.
   */
  vtkSetMacro(RadiusEdgeRatio, double);
  vtkGetMacro(RadiusEdgeRatio, double);
  vtkSetMacro(MinimumDihedralAngle, double);
  vtkGetMacro(MinimumDihedralAngle, double);
  //@}

  //@{
  /**
   * Set/Get the largest volume of a tetrahedron, at least 0. Default 0: no bound.
   */
  vtkSetMacro(MaximumVolume, double);
  vtkGetMacro(MaximumVolume, double);
  //@}

  //@{
  /**
   * Set/Get the most points that TetGen may add, 0..2^31 - 1, or -1 (default) for any number. If TetGen reaches the limit, the bounds on
   * shape and volume may not hold.
   */
  vtkSetMacro(MaximumSteinerPoints, vtkIdType);
  vtkGetMacro(MaximumSteinerPoints, vtkIdType);
  //@}

  //@{
  /**
   * Set/Get whether the surface's triangles stay as they are, without added points. Default off.
   */
  vtkSetClampMacro(PreserveBoundary, vtkTypeBool, 0, 1);
  vtkGetMacro(PreserveBoundary, vtkTypeBool);
  vtkBooleanMacro(PreserveBoundary, vtkTypeBool);
  //@}

  //@{
  /**
   * Add a hole, remove all holes, or get their number. A hole is a point in a part that stays empty, up to the nearest facets around the
   * point.
   */
  void AddHole(double x, double y, double z);
  void RemoveAllHoles();
  int GetNumberOfHoles();
  //@}

  //@{
  /**
   * Add a region, remove all regions, or get their number. A region is a point in a part of the volume. The part's tetrahedra get this
   * value of "Region" and, where maximumVolume is above 0, are no larger. Parts without a region get integers above all attributes.
   */
  void AddRegion(double x, double y, double z, double attribute, double maximumVolume = 0.0);
  void RemoveAllRegions();
  int GetNumberOfRegions();
  //@}

  //@{
  /**
   * Set/Get the seconds after which TetGen is stopped, above 0 and up to 1e6. Default 60.
   */
  vtkSetMacro(TimeLimit, double);
  vtkGetMacro(TimeLimit, double);
  //@}

  //@{
  /**
   * Set/Get the program that runs TetGen. Default none: the stratus-tetgen built or installed with this library.
   */
  vtkSetFilePathMacro(Program);
  vtkGetFilePathMacro(Program);
  //@}

  /**
   * Get the second output.
   */
  vtkPolyData* GetBoundary();

protected:
  vtkStratusTetGenFilter();
  ~vtkStratusTetGenFilter() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  vtkTypeBool Quality = 1;
  double RadiusEdgeRatio = 2.0;
  double MinimumDihedralAngle = 0.0;
  double MaximumVolume = 0.0;
  vtkIdType MaximumSteinerPoints = -1;
  vtkTypeBool PreserveBoundary = 0;
  double TimeLimit = 60.0;
  char* Program = nullptr;

private:
  vtkStratusTetGenFilter(const vtkStratusTetGenFilter&) = delete;
  void operator=(const vtkStratusTetGenFilter&) = delete;

  class Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
