// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusPartitionFilter
 * @brief   an unstructured grid cut into the leaves of a K-D tree
 *
 * Input: a vtkUnstructuredGrid. Its cells are divided into tetrahedra that meet face to face (linear and quadratic cells and polyhedra;
 * vertices, lines and polygons are dropped, cells of higher order refused), and those are cut by planes, so that each lies in one leaf: Li
 * et al. 2012. Pieces meet in the same points, across leaves, too, and fill what they were cut from.
 *
 * Output: tetrahedra, leaf by leaf. Points keep their numbers; the middles of quadratic cells that have no point there (all but tetrahedra,
 * triquadratic hexahedra and pyramids) and points on cut edges follow; point data are interpolated, cell data
 * copied (global ids are dropped, as they would no longer be unique). Cell data "StratusLeaf" and "StratusOriginalCell" and field data
 * "StratusPartition" (the tree) are added; vtkStratusVisibilitySort reads them.
 *
 * @sa vtkStratusVisibilitySort
 */
#ifndef vtkStratusPartitionFilter_h
#define vtkStratusPartitionFilter_h

#include "StratusFiltersTetrahedraModule.h" // For export macro
#include "vtkUnstructuredGridAlgorithm.h"

#include <memory> // For std::unique_ptr

class STRATUSFILTERSTETRAHEDRA_EXPORT vtkStratusPartitionFilter : public vtkUnstructuredGridAlgorithm
{
public:
  static vtkStratusPartitionFilter* New();
  vtkTypeMacro(vtkStratusPartitionFilter, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum RuleType { MEDIAN, PAPER };
  //@{
  /**
   * MEDIAN: of the planes through points between the 40 % and the 60 % quantile the one that adds fewest cells. PAPER: of evenly spaced
   * planes the one that adds fewest among those that Growth and Imbalance admit. Default MEDIAN.
   */
  vtkSetClampMacro(Rule, int, MEDIAN, PAPER);
  vtkGetMacro(Rule, int);
  //@}

  //@{
  /**
   * At most 2^Depth leaves, 0..16. Default 3.
   */
  vtkSetClampMacro(Depth, int, 0, 16);
  vtkGetMacro(Depth, int);
  //@}

  //@{
  /**
   * Planes tried an axis and node, 1..4096. Default 64.
   */
  vtkSetClampMacro(Planes, int, 1, 4096);
  vtkGetMacro(Planes, int);
  //@}

  //@{
  /**
   * Most new cells per cell of a node (the paper's Phi), > 0. Default: any.
   */
  vtkSetMacro(Growth, double);
  vtkGetMacro(Growth, double);
  //@}

  //@{
  /**
   * The difference of a plane's two sides over their mean stays below this (the paper's epsilon), > 0. Default 0.5.
   */
  vtkSetMacro(Imbalance, double);
  vtkGetMacro(Imbalance, double);
  //@}

  //@{
  /**
   * Where no plane is admissible the mesh is turned as many times at most, 0..64. Default 0.
   */
  vtkSetClampMacro(Rotations, int, 0, 64);
  vtkGetMacro(Rotations, int);
  //@}

  //@{
  /**
   * A node of so many cells or fewer is not cut, >= 1. Default 1024.
   */
  vtkSetClampMacro(LeafCells, vtkIdType, 1, VTK_ID_MAX);
  vtkGetMacro(LeafCells, vtkIdType);
  //@}

  //@{
  /**
   * Of the last output: leaves; cells of the largest; tetrahedra before anything was cut.
   */
  vtkGetMacro(NumberOfLeaves, int);
  vtkGetMacro(LargestLeaf, vtkIdType);
  vtkGetMacro(NumberOfTetrahedra, vtkIdType);
  //@}

protected:
  vtkStratusPartitionFilter();
  ~vtkStratusPartitionFilter() override;

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  int Rule = MEDIAN;
  int Depth = 3;
  int Planes = 64;
  double Growth;
  double Imbalance = 0.5;
  int Rotations = 0;
  vtkIdType LeafCells = 1024;
  int NumberOfLeaves = 0;
  vtkIdType LargestLeaf = 0;
  vtkIdType NumberOfTetrahedra = 0;

private:
  vtkStratusPartitionFilter(const vtkStratusPartitionFilter&) = delete;
  void operator=(const vtkStratusPartitionFilter&) = delete;

  class Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
