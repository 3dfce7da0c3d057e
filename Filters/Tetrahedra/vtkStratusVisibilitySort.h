// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusVisibilitySort
 * @brief   sorts tetrahedra so that none hides one that comes before it
 *
 * Plugs into vtkProjectedTetrahedraMapper, or any other class that takes a vtkVisibilitySort. Input: a vtkUnstructuredGrid of linear
 * tetrahedra.
 *
 * Which of two neighbours is in front follows from their common face, by exact arithmetic where double precision does not suffice. Which of
 * two cells on opposite sides of a gap is in front follows from where their border faces cover one another in the view. If the input comes
 * unchanged from vtkStratusPartitionFilter, its leaves are sorted separately and in parallel. Neighbours are found anew only when the input
 * changes. The last order is reused while the eye stays, or, in a mesh without gaps, while every cell hides the same neighbours.
 *
 * MaxCellsReturned, Direction and ModelTransform are honoured. An input that cannot be sorted gives an error and no cells.
 *
 * @sa vtkStratusPartitionFilter vtkProjectedTetrahedraMapper
 */
#ifndef vtkStratusVisibilitySort_h
#define vtkStratusVisibilitySort_h

#include "StratusFiltersTetrahedraModule.h" // For export macro
#include "vtkVisibilitySort.h"

#include <memory> // For std::unique_ptr

class vtkTable;

class STRATUSFILTERSTETRAHEDRA_EXPORT vtkStratusVisibilitySort : public vtkVisibilitySort
{
public:
  static vtkStratusVisibilitySort* New();
  vtkTypeMacro(vtkStratusVisibilitySort, vtkVisibilitySort);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  //@{
  /**
   * InitTraversal() sorts for the camera as it is now. GetNextCells() returns the next cells in order, at most MaxCellsReturned, and
   * nullptr after the last.
   */
  void InitTraversal() override;
  vtkIdTypeArray* GetNextCells() override;
  //@}

  enum PeelingType { NEAREST, LAYERS };
  //@{
  /**
   * Set/Get the choice among cells that no remaining cell hides. NEAREST takes one of the nearest. LAYERS takes all of them, as in Li et
   * al. 2012, and may cross gaps in the wrong order. Default NEAREST.
   */
  vtkSetClampMacro(Peeling, int, NEAREST, LAYERS);
  vtkGetMacro(Peeling, int);
  //@}

  //@{
  /**
   * Set/Get the device that finds the signs of faces: "auto" (the host or an OpenCL GPU, whichever draws a small picture faster), "host",
   * or an OpenCL device by its number or a part of its name. The order does not depend on it. A device that does not exist is an error that
   * lists the existing ones, and the previous device and order stay. The host does all else, the signs of meshes that are small or do not
   * fit the device, and everything where the device is a processor. Default "auto".
   */
  virtual void SetDevice(const char* device);
  virtual const char* GetDevice();
  const char* GetDeviceName(); // the device in use, "" if there is none
  //@}

  //@{
  /**
   * Set/Get the number of threads of the host, 0..1024. 0 takes as many as OpenMP would. Default 0.
   */
  vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
  vtkGetMacro(NumberOfThreads, int);
  //@}

  //@{
  /**
   * Get statistics of the last traversal.
   * - NumberOfLeaves: leaves of the partition.
   * - NumberOfCycles: cycles of cells that hide one another; each is broken once.
   * - NumberOfOverlaps: cycles that lead across a gap, as where cells overlap.
   * - NumberOfForcedCells: cells placed before a cell that hides them, because there were too many cycles.
   * - NumberOfLayers: layers of peeling, if Peeling is LAYERS.
   * - BuildMilliseconds: time to find neighbours, once per input.
   * - SortMilliseconds: time to find signs and to peel, in each traversal.
   */
  vtkGetMacro(NumberOfLeaves, int);
  vtkGetMacro(NumberOfCycles, vtkIdType);
  vtkGetMacro(NumberOfOverlaps, vtkIdType);
  vtkGetMacro(NumberOfForcedCells, vtkIdType);
  vtkGetMacro(NumberOfLayers, int);
  vtkGetMacro(BuildMilliseconds, double);
  vtkGetMacro(SortMilliseconds, double);
  //@}

  /**
   * Get the stages of the last traversal. Each row is a stage. Columns: "Stage" (string), "Where" (string: the name of the device that ran
   * its kernels, or "host"), "Milliseconds" (double: wall-clock time), "Bytes" (vtkIdType: size of the stage's results) and "Kernels"
   * (vtkIdType: number of kernels that the device ran). The table has no rows before the first traversal, and none for results that were
   * reused.
   */
  vtkTable* GetBuildReport();

protected:
  vtkStratusVisibilitySort();
  ~vtkStratusVisibilitySort() override;

  int Peeling = NEAREST;
  int NumberOfThreads = 0;
  int NumberOfLeaves = 0;
  vtkIdType NumberOfCycles = 0;
  vtkIdType NumberOfOverlaps = 0;
  vtkIdType NumberOfForcedCells = 0;
  int NumberOfLayers = 0;
  double BuildMilliseconds = 0.0;
  double SortMilliseconds = 0.0;

private:
  vtkStratusVisibilitySort(const vtkStratusVisibilitySort&) = delete;
  void operator=(const vtkStratusVisibilitySort&) = delete;

  class Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
