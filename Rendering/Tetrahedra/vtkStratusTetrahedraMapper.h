// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusTetrahedraMapper
 * @brief   draws the volume of a vtkUnstructuredGrid, its cells divided into tetrahedra, with exact thickness and order
 *
 * Takes the place of vtkProjectedTetrahedraMapper and of vtkUnstructuredGridVolumeRayCastMapper: a vtkUnstructuredGrid and the vtkVolume's
 * vtkVolumeProperty go in, the picture is composited with the opaque geometry of the scene.
 *
 * Supported: linear and quadratic cells of every kind and polyhedra, of any orientation, in any number of parts, with gaps, hollows and
 * flat cells. All but linear tetrahedra are divided into such, neighbours alike across their faces, so that the field is linear in each
 * part; vertices, lines and polygons are ignored and counted, a grid that has nothing else is an error. Point and cell scalars of one
 * component and any numeric type but bits; scalar opacity, colour or grey, ScalarOpacityUnitDistance in world units; blend modes composite
 * and maximum intensity (the largest value of a ray, at the opacity of one unit distance); ghost and blanking arrays; values that are not
 * finite (whole cells with one are transparent); the volume's matrix; parallel and perspective cameras, also within the grid. Cells that
 * cross the near plane are cut there. All else (cells of higher order, shading, gradient opacity, more components, two-dimensional transfer
 * functions, label maps, clipping planes) is refused by an error, and nothing is drawn.
 *
 * What is built is kept: a new view of the same grid rebuilds nothing, a new transfer function a table only.
 *
 * @sa vtkStratusVolumeMapper vtkProjectedTetrahedraMapper
 */
#ifndef vtkStratusTetrahedraMapper_h
#define vtkStratusTetrahedraMapper_h

#include "StratusRenderingTetrahedraModule.h" // For export macro
#include "vtkUnstructuredGridVolumeMapper.h"

#include <memory> // For std::unique_ptr

class vtkImageData;

class STRATUSRENDERINGTETRAHEDRA_EXPORT vtkStratusTetrahedraMapper : public vtkUnstructuredGridVolumeMapper
{
public:
  static vtkStratusTetrahedraMapper* New();
  vtkTypeMacro(vtkStratusTetrahedraMapper, vtkUnstructuredGridVolumeMapper);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  //@{
  /**
   * A ray ends when its alpha passes this, 0..1. Default 0.9999. Not in maximum intensity.
   */
  vtkSetClampMacro(Termination, double, 0.0, 1.0);
  vtkGetMacro(Termination, double);
  //@}

  //@{
  /**
   * How a picture is drawn: rays march from cell to cell; cells that can show something are sorted and projected into tiles of pixels (on
   * the host only); or auto, whichever should cost less by counts of cells, pixels and segments in view. A camera that stands still never
   * changes the choice, and both give the same picture but for the rounding of floats: below .01 of 255 on the mean. Default AUTO_METHOD.
   */
  enum MethodType { AUTO_METHOD, MARCH_METHOD, PROJECT_METHOD };
  vtkSetClampMacro(Method, int, AUTO_METHOD, PROJECT_METHOD);
  vtkGetMacro(Method, int);
  void SetMethodToAuto() { this->SetMethod(AUTO_METHOD); }
  void SetMethodToMarch() { this->SetMethod(MARCH_METHOD); }
  void SetMethodToProject() { this->SetMethod(PROJECT_METHOD); }
  const char* GetMethodAsString();
  //@}

  //@{
  /**
   * Threads that draw, 0..1024; 0 takes as many as OpenMP would. The picture is the same with any number. Default 0.
   */
  vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
  vtkGetMacro(NumberOfThreads, int);
  //@}

  //@{
  /**
   * Where rays march: "auto" (the first OpenCL GPU, else the host), "host", or an OpenCL device by its number or a part of its name; the
   * picture is the same. One that does not exist is an error with the list of those that do, and the device stays what it was. A mesh that
   * a device can't hold is drawn on the host. Default "auto".
   */
  virtual void SetDevice(const char* device);
  virtual const char* GetDevice();
  const char* GetDeviceName(); // the one that draws, "" if there is none
  //@}

  //@{
  /**
   * Of the last picture: milliseconds that the march took, and making the grid ready (0 where it was), cells that rays passed, and faces
   * through which they came in.
   */
  double GetMarchMilliseconds();
  double GetBuildMilliseconds();
  vtkIdType GetNumberOfSegments();
  vtkIdType GetNumberOfEntries();
  //@}

  //@{
  /**
   * Of the last picture: tetrahedra that the cells were divided into; cells ignored: vertices, lines and polygons; tetrahedra left out
   * though no ghost or blanking array hides them, of values that are not finite or that name a point more than once.
   */
  vtkIdType GetNumberOfTetrahedra();
  vtkIdType GetNumberOfIgnoredCells();
  vtkIdType GetNumberOfBlankedTetrahedra();
  //@}

  //@{
  /**
   * Of the last picture: march or project, and why; milliseconds of the projection: order of cells, their outlines and tiles, pixels (0
   * where rays marched); cells that it saw; pixels whose cells had come in a wrong order (across gaps, in cycles) and were drawn again,
   * nearest first.
   */
  const char* GetMethodUsedAsString();
  const char* GetMethodReason();
  double GetSortMilliseconds();
  double GetBinMilliseconds();
  double GetProjectMilliseconds();
  vtkIdType GetNumberOfCellsInView();
  vtkIdType GetNumberOfPixelsDrawnAgain();
  //@}

  /**
   * Of the last picture: leaves that were sorted in parallel for the projection: those of vtkStratusPartitionFilter, if the input carries
   * its arrays and its points are still where they were, else 1. 0 where rays marched or nothing showed.
   */
  vtkIdType GetNumberOfLeaves();

  /**
   * The last picture as floats, as large as the renderer's viewport: point arrays RGBA (premultiplied by alpha) and Depth (world distance
   * along the ray from the eye, infinity where nothing is). nullptr before the first. Made anew with each call.
   */
  vtkImageData* GetLastImage();

  void Render(vtkRenderer* ren, vtkVolume* vol) override;
  void ReleaseGraphicsResources(vtkWindow* window) override;

protected:
  vtkStratusTetrahedraMapper();
  ~vtkStratusTetrahedraMapper() override;
  int FillInputPortInformation(int port, vtkInformation* info) override;

  double Termination = 0.9999;
  int Method = AUTO_METHOD;
  int NumberOfThreads = 0;

private:
  vtkStratusTetrahedraMapper(const vtkStratusTetrahedraMapper&) = delete;
  void operator=(const vtkStratusTetrahedraMapper&) = delete;

  class Internals;
  friend class Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
