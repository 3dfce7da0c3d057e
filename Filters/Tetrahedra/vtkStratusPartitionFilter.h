// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusPartitionFilter
 * @brief   cuts an unstructured grid into the leaves of a K-D tree
 *
 * Input: a vtkUnstructuredGrid. Its linear, quadratic, Lagrange and Bezier cells and polyhedra are divided into tetrahedra that meet face
 * to face; of Bezier cells the nodes that only steer them move to the points that belong to them. Vertices, lines and polygons are dropped.
 * Planes then cut the tetrahedra, so that each piece is inside one leaf (Li et al. 2012). Neighbouring pieces share their points, across
 * leaves, too. Together the pieces of a cell fill the cell.
 *
 * Output: tetrahedra, leaf by leaf. The input's points keep their numbers. Behind them come the centres of quadratic cells that have no
 * node there (all but tetrahedra and triquadratic hexahedra and pyramids) and the points on cut edges. Point data are interpolated and cell
 * data copied; global ids are dropped, because they would no longer be unique. The cell data "StratusLeaf" and "StratusOriginalCell" and
 * the field data "StratusPartition" (the tree) are added; vtkStratusVisibilitySort reads them.
 *
 * @sa vtkStratusVisibilitySort
 */
#ifndef vtkStratusPartitionFilter_h
#define vtkStratusPartitionFilter_h

#include "StratusFiltersTetrahedraModule.h" // For export macro
#include "vtkUnstructuredGridAlgorithm.h"

#include <memory> // For std::unique_ptr

class vtkTable;

class STRATUSFILTERSTETRAHEDRA_EXPORT vtkStratusPartitionFilter : public vtkUnstructuredGridAlgorithm
{
public:
  static vtkStratusPartitionFilter* New();
  vtkTypeMacro(vtkStratusPartitionFilter, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum RuleType { MEDIAN, PAPER };
  //@{
  /**
   * Set/Get the rule that chooses a plane. MEDIAN takes, of the planes through points between the 40 % and the 60 % quantile, the one that
   * adds fewest cells. PAPER takes the one that adds fewest of evenly spaced planes. A plane must also satisfy Growth and Imbalance.
   * Default MEDIAN.
   */
  vtkSetClampMacro(Rule, int, MEDIAN, PAPER);
  vtkGetMacro(Rule, int);
  //@}

  //@{
  /**
   * Set/Get the depth of the tree, 0..16. It has at most 2^Depth leaves. Default 3.
   */
  vtkSetClampMacro(Depth, int, 0, 16);
  vtkGetMacro(Depth, int);
  //@}

  //@{
  /**
   * Set/Get the number of planes tried per axis and node, 1..4096. Default 64.
   */
  vtkSetClampMacro(Planes, int, 1, 4096);
  vtkGetMacro(Planes, int);
  //@}

  //@{
  /**
   * Set/Get the most new cells that a plane may add per cell of the node (the paper's Phi), > 0. Default infinity.
   */
  vtkSetMacro(Growth, double);
  vtkGetMacro(Growth, double);
  //@}

  //@{
  /**
   * Set/Get the bound on a plane's imbalance, the difference of its two sides over their mean (the paper's epsilon), > 0. Default 0.5.
   */
  vtkSetMacro(Imbalance, double);
  vtkGetMacro(Imbalance, double);
  //@}

  //@{
  /**
   * Set/Get how often the mesh may be rotated where no plane of the root is admissible, 0..64. Default 0.
   */
  vtkSetClampMacro(Rotations, int, 0, 64);
  vtkGetMacro(Rotations, int);
  //@}

  //@{
  /**
   * Set/Get the number of cells up to which a node is not cut, >= 1. Default 1024.
   */
  vtkSetClampMacro(LeafCells, vtkIdType, 1, VTK_ID_MAX);
  vtkGetMacro(LeafCells, vtkIdType);
  //@}

  //@{
  /**
   * Set/Get the device that cuts: "auto" (the host or an OpenCL GPU, whichever draws a small picture faster), "host", or an OpenCL device
   * by its number or a part of its name. The output does not depend on it. A device that does not exist is an error that lists the existing
   * ones, and the previous device and output stay. No stage has kernels: the host cuts. Default "auto".
   */
  virtual void SetDevice(const char* device);
  virtual const char* GetDevice();
  const char* GetDeviceName(); // the device in use, "" if there is none
  //@}

  //@{
  /**
   * Set/Get the number of threads of the host, 0..1024. 0 takes as many as OpenMP would. The output does not depend on it. Default 0.
   */
  vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
  vtkGetMacro(NumberOfThreads, int);
  //@}

  /**
   * Get the build stages of the last output. Each row is a stage. Columns: "Stage" (string), "Where" (string: the name of the device that
   * ran its kernels, or "host"), "Milliseconds" (double: wall-clock time without nested stages), "Bytes" (vtkIdType: size of the stage's
   * results) and "Kernels" (vtkIdType: number of kernels that the device ran). The table has no rows before the first output.
   */
  vtkTable* GetBuildReport();

  //@{
  /**
   * Get statistics of the last output: the number of leaves, the cells of the largest leaf, and the number of tetrahedra before cutting.
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
  int NumberOfThreads = 0;
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
