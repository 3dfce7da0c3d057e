// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusTetGenFilter
 * @brief   fills a closed surface with tetrahedra, by TetGen
 *
 * Input: a vtkPolyData whose polygons and strips enclose a volume and do not cross each other; polygons are planar. Walls within are kept.
 * Vertices are points that the mesh shall have, lines count for nothing. Points in exactly one place are taken as one, unused ones are left
 * out. Cell data "Marker" (integer) mark facets; field data "Holes" (3 components) and "Regions" (5: a point, an attribute, the largest
 * volume or 0) add to what AddHole() and AddRegion() say: what vtkStratusTetGenReader gives of a .smesh file.
 *
 * First output: a vtkUnstructuredGrid of linear tetrahedra, none of them inverted, with point data "vtkOriginalPointIds" (-1 for points
 * that TetGen added), and cell data "Region" (double), the attributes of regions, if there are any. Second output: the mesh's boundary and
 * inner walls as triangles over the same points, with cell data "Marker" (int; 1 where the input has none).
 *
 * TetGen runs in a process of its own, the program stratus-tetgen: where it crashes, as it may for surfaces that cross themselves, or runs
 * on, as it may for a quality that can't be had, that is an error that says so. Outputs are empty after an error.
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
   * Whether to add points until tetrahedra are well shaped. Default on.
   */
  vtkSetClampMacro(Quality, vtkTypeBool, 0, 1);
  vtkGetMacro(Quality, vtkTypeBool);
  vtkBooleanMacro(Quality, vtkTypeBool);
  //@}

  //@{
  /**
   * With Quality: the largest ratio of a tetrahedron's circumscribed radius to its shortest edge, above 0, and the smallest angle between
   * two of its faces in degrees, 0..70. Default 2 and 0. Below 1.2 and above 18 TetGen may not come to an end; beside small angles of the
   * surface itself it lets worse ones stand.
   */
  vtkSetMacro(RadiusEdgeRatio, double);
  vtkGetMacro(RadiusEdgeRatio, double);
  vtkSetMacro(MinimumDihedralAngle, double);
  vtkGetMacro(MinimumDihedralAngle, double);
  //@}

  //@{
  /**
   * The largest volume of a tetrahedron, at least 0. Default 0: any.
   */
  vtkSetMacro(MaximumVolume, double);
  vtkGetMacro(MaximumVolume, double);
  //@}

  //@{
  /**
   * How many points TetGen may add at most, 0..2^31 - 1, or -1 (default) for any number. Where it is reached, quality and volume are not.
   */
  vtkSetMacro(MaximumSteinerPoints, vtkIdType);
  vtkGetMacro(MaximumSteinerPoints, vtkIdType);
  //@}

  //@{
  /**
   * Whether the surface's triangles stay as they are, without points added on it. Default off.
   */
  vtkSetClampMacro(PreserveBoundary, vtkTypeBool, 0, 1);
  vtkGetMacro(PreserveBoundary, vtkTypeBool);
  vtkBooleanMacro(PreserveBoundary, vtkTypeBool);
  //@}

  //@{
  /**
   * A point in a part that stays empty: all up to the next facets is left out.
   */
  void AddHole(double x, double y, double z);
  void RemoveAllHoles();
  int GetNumberOfHoles();
  //@}

  //@{
  /**
   * A point in a part whose tetrahedra shall have this value of "Region" and, where it is above 0, no larger volume. Parts that no region
   * lies in have whole values above all of these.
   */
  void AddRegion(double x, double y, double z, double attribute, double maximumVolume = 0.0);
  void RemoveAllRegions();
  int GetNumberOfRegions();
  //@}

  //@{
  /**
   * Seconds after which TetGen is stopped, above 0 and up to 1e6. Default 60.
   */
  vtkSetMacro(TimeLimit, double);
  vtkGetMacro(TimeLimit, double);
  //@}

  //@{
  /**
   * The program that runs TetGen. Default none: stratus-tetgen where it was built or installed with this library.
   */
  vtkSetFilePathMacro(Program);
  vtkGetFilePathMacro(Program);
  //@}

  /**
   * The second output.
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
