// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusVisibilitySort
 * @brief   tetrahedra in an order in which none hides one that comes before it
 *
 * Plugs into vtkProjectedTetrahedraMapper, or any other that takes a vtkVisibilitySort. Input: a vtkUnstructuredGrid of linear tetrahedra.
 * Which of two neighbours is in front follows from their face, in exact arithmetic where double does not tell; which of two cells on both
 * sides of a gap, from where their border faces cover one another in the view. If the input comes from vtkStratusPartitionFilter and still
 * is as that left it, its leaves are sorted apart and in parallel. Neighbours are found when the input has changed; an order is kept
 * while the eye stays, or where there are no gaps, as long as every cell hides the same neighbours.
 *
 * MaxCellsReturned, Direction and ModelTransform are honoured. What cannot be sorted gives an error and no cells.
 *
 * @sa vtkStratusPartitionFilter vtkProjectedTetrahedraMapper
 */
#ifndef vtkStratusVisibilitySort_h
#define vtkStratusVisibilitySort_h

#include "StratusFiltersTetrahedraModule.h" // For export macro
#include "vtkVisibilitySort.h"

#include <memory> // For std::unique_ptr

class STRATUSFILTERSTETRAHEDRA_EXPORT vtkStratusVisibilitySort : public vtkVisibilitySort
{
public:
  static vtkStratusVisibilitySort* New();
  vtkTypeMacro(vtkStratusVisibilitySort, vtkVisibilitySort);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  //@{
  /**
   * Sorts for the camera as it is now; gives at most MaxCellsReturned cells, the next in order; nullptr after the last.
   */
  void InitTraversal() override;
  vtkIdTypeArray* GetNextCells() override;
  //@}

  enum PeelingType { NEAREST, LAYERS };
  //@{
  /**
   * NEAREST: of the cells that nothing hides any more one of the nearest comes next. LAYERS: all of them do, as Li et al. 2012 have it;
   * gaps may then be crossed in the wrong order. Default NEAREST.
   */
  vtkSetClampMacro(Peeling, int, NEAREST, LAYERS);
  vtkGetMacro(Peeling, int);
  //@}

  //@{
  /**
   * Threads of the host, 0: as many as OpenMP would take, at most 1024. Default 0.
   */
  vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
  vtkGetMacro(NumberOfThreads, int);
  //@}

  //@{
  /**
   * Of the last traversal: leaves; rings of cells that hide one another, each broken once; those of them that lead across gaps, as where
   * cells overlap; cells that came before some that hide them, as rings were too many; layers (peeling in layers); milliseconds that
   * neighbours took, once, and signs and peeling, each time.
   */
  vtkGetMacro(NumberOfLeaves, int);
  vtkGetMacro(NumberOfCycles, vtkIdType);
  vtkGetMacro(NumberOfOverlaps, vtkIdType);
  vtkGetMacro(NumberOfForcedCells, vtkIdType);
  vtkGetMacro(NumberOfLayers, int);
  vtkGetMacro(BuildMilliseconds, double);
  vtkGetMacro(SortMilliseconds, double);
  //@}

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
