// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusHybridTreeFilter
 * @brief   builds the tree that rays skip by, and lets the image carry it
 *
 * Input: a vtkImageData with scalars of one component on points (or on cells, by SetInputArrayToProcess). First output: the same image,
 * shallow, with the tree in its field data: "StratusHybridTree" (unsigned char: versioned, with a checksum), "StratusHybridTreeVersion"
 * (int: major and minor of the Stratus that wrote it) and "StratusHybridTreeHash" (string: of the values and hidden parts it was built
 * from). VTK's writers and readers keep them. A vtkStratusVolumeMapper that gets the image uses the tree where it serves, and builds its
 * own otherwise.
 *
 * Second output: a vtkPolyData with the box of each of the tree's nodes as one polyline in world coordinates, parents before children. Cell
 * data "Depth" (int, the root's is 0; the scalars), "Kind" (unsigned char: 0 inner node, 1 leaf of bricks, 2 leaf of a distance field) and
 * "Count" (vtkIdType: voxels in it).
 *
 * What counts is what VolumeProperty's scalar opacity shows or, without a VolumeProperty, LowerThreshold..UpperThreshold.
 *
 * Where the filter fails its outputs stay what they were.
 *
 * @sa vtkStratusVolumeMapper vtkStratusDistanceMapFilter
 */
#ifndef vtkStratusHybridTreeFilter_h
#define vtkStratusHybridTreeFilter_h

#include "StratusFiltersHybridTreeModule.h" // For export macro
#include "vtkImageAlgorithm.h"

#include <memory> // For std::unique_ptr

class vtkPolyData;
class vtkVolumeProperty;

class STRATUSFILTERSHYBRIDTREE_EXPORT vtkStratusHybridTreeFilter : public vtkImageAlgorithm
{
public:
  static vtkStratusHybridTreeFilter* New();
  vtkTypeMacro(vtkStratusHybridTreeFilter, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  vtkMTimeType GetMTime() override;

  //@{
  /**
   * The values that count, ends included; lower <= upper, infinities allowed. Default: all. Not used with a VolumeProperty.
   */
  vtkSetMacro(LowerThreshold, double);
  vtkGetMacro(LowerThreshold, double);
  vtkSetMacro(UpperThreshold, double);
  vtkGetMacro(UpperThreshold, double);
  void ThresholdBetween(double lower, double upper);
  //@}

  //@{
  /**
   * The property whose scalar opacity tells what counts. Default none.
   */
  virtual void SetVolumeProperty(vtkVolumeProperty* property);
  vtkVolumeProperty* GetVolumeProperty();
  //@}

  enum PurposeType { RAY_CASTING, FIRST_HITS };
  //@{
  /**
   * What the tree is for. RAY_CASTING: blocks of cells that show something between their smallest and largest value, rounded outward;
   * serves every transfer function that shows no more. FIRST_HITS: the voxels themselves; serves those that show the same. Default
   * RAY_CASTING.
   */
  vtkSetClampMacro(Purpose, int, RAY_CASTING, FIRST_HITS);
  vtkGetMacro(Purpose, int);
  void SetPurposeToRayCasting() { this->SetPurpose(RAY_CASTING); }
  void SetPurposeToFirstHits() { this->SetPurpose(FIRST_HITS); }
  //@}

  enum MethodType { HYBRID, HYBRID_PAPER, DISTANCE, OCTANT, SAH, SWEEP, LBVH, PLOC, AGGLOMERATIVE, DENSITY_PEAKS, K_MEANS };
  //@{
  /**
   * How the tree is built. HYBRID (default): leaves of distance fields where voxels lie even, a hierarchy of bricks where they don't;
   * HYBRID_PAPER: Guo et al. 2025 as written; DISTANCE and OCTANT: one field over everything; the others: hierarchies of single voxels, to
   * compare with.
   */
  vtkSetClampMacro(Method, int, HYBRID, K_MEANS);
  vtkGetMacro(Method, int);
  void SetMethodToHybrid() { this->SetMethod(HYBRID); }
  void SetMethodToHybridPaper() { this->SetMethod(HYBRID_PAPER); }
  void SetMethodToDistance() { this->SetMethod(DISTANCE); }
  void SetMethodToOctant() { this->SetMethod(OCTANT); }
  void SetMethodToSAH() { this->SetMethod(SAH); }
  void SetMethodToSweep() { this->SetMethod(SWEEP); }
  void SetMethodToLBVH() { this->SetMethod(LBVH); }
  void SetMethodToPLOC() { this->SetMethod(PLOC); }
  void SetMethodToAgglomerative() { this->SetMethod(AGGLOMERATIVE); }
  void SetMethodToDensityPeaks() { this->SetMethod(DENSITY_PEAKS); }
  void SetMethodToKMeans() { this->SetMethod(K_MEANS); }
  const char* GetMethodAsString();
  //@}

  //@{
  /**
   * A node this deep is a leaf, 1..64; hierarchies of voxels are only kept near it, by splits at the median. Default 32.
   */
  vtkSetClampMacro(MaximumDepth, int, 1, 64);
  vtkGetMacro(MaximumDepth, int);
  //@}

  //@{
  /**
   * Bricks of 4^3 voxels in a leaf of the sparse parts, and voxels in a leaf of the hierarchies of voxels; 1..64. Default 4 and 1.
   */
  vtkSetClampMacro(LeafBricks, int, 1, 64);
  vtkGetMacro(LeafBricks, int);
  vtkSetClampMacro(LeafVoxels, int, 1, 64);
  vtkGetMacro(LeafVoxels, int);
  //@}

  //@{
  /**
   * Most bricks that a leaf of a distance field covers, 1..2^29, and most of them for one that holds anything, at least 1. Values out of
   * range are an error when building. Default 33554432 and 512.
   */
  vtkSetMacro(FieldBricks, vtkIdType);
  vtkGetMacro(FieldBricks, vtkIdType);
  vtkSetMacro(FieldEmptiness, double);
  vtkGetMacro(FieldEmptiness, double);
  //@}

  //@{
  /**
   * How much the spread of voxels may differ between the axes for a node to count as even: of the node's extent (HYBRID, default .1), and
   * in voxels (HYBRID_PAPER, default 8). At least 0; else an error when building.
   */
  vtkSetMacro(Uniform, double);
  vtkGetMacro(Uniform, double);
  vtkSetMacro(PaperThreshold, double);
  vtkGetMacro(PaperThreshold, double);
  //@}

  //@{
  /**
   * Bandwidth of density in voxels, or 0 (default) for the paper's rule with its floor of 1. Negative: an error when building.
   */
  vtkSetMacro(Bandwidth, double);
  vtkGetMacro(Bandwidth, double);
  //@}

  //@{
  /**
   * Density summed voxel by voxel instead of over bricks, and anew in each node. Default off; HYBRID_PAPER always does both.
   */
  vtkSetClampMacro(ExactDensity, vtkTypeBool, 0, 1);
  vtkGetMacro(ExactDensity, vtkTypeBool);
  vtkBooleanMacro(ExactDensity, vtkTypeBool);
  vtkSetClampMacro(DensityPerNode, vtkTypeBool, 0, 1);
  vtkGetMacro(DensityPerNode, vtkTypeBool);
  vtkBooleanMacro(DensityPerNode, vtkTypeBool);
  //@}

  //@{
  /**
   * Of the last tree built: voxels that count, bricks that hold any, nodes, leaves, leaves of distance fields, depth of the deepest leaf,
   * bytes, cost by the surface area heuristic, milliseconds, and one sentence on what decided its shape.
   */
  vtkGetMacro(NumberOfVoxels, vtkIdType);
  vtkGetMacro(NumberOfBricks, vtkIdType);
  vtkGetMacro(NumberOfNodes, vtkIdType);
  vtkGetMacro(NumberOfLeaves, vtkIdType);
  vtkGetMacro(NumberOfFieldLeaves, vtkIdType);
  vtkGetMacro(Depth, int);
  vtkGetMacro(Bytes, vtkIdType);
  vtkGetMacro(SurfaceAreaCost, double);
  vtkGetMacro(BuildTime, double);
  const char* GetReason();
  //@}

  /**
   * The second output.
   */
  vtkPolyData* GetBoxes();

protected:
  vtkStratusHybridTreeFilter();
  ~vtkStratusHybridTreeFilter() override;

  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  double LowerThreshold;
  double UpperThreshold;
  int Purpose = RAY_CASTING;
  int Method = HYBRID;
  int MaximumDepth = 32;
  int LeafBricks = 4;
  int LeafVoxels = 1;
  vtkIdType FieldBricks = 33554432;
  double FieldEmptiness = 512.0;
  double Uniform = 0.1;
  double PaperThreshold = 8.0;
  double Bandwidth = 0.0;
  vtkTypeBool ExactDensity = 0;
  vtkTypeBool DensityPerNode = 0;

  vtkIdType NumberOfVoxels = 0;
  vtkIdType NumberOfBricks = 0;
  vtkIdType NumberOfNodes = 0;
  vtkIdType NumberOfLeaves = 0;
  vtkIdType NumberOfFieldLeaves = 0;
  int Depth = 0;
  vtkIdType Bytes = 0;
  double SurfaceAreaCost = 0.0;
  double BuildTime = 0.0;

private:
  vtkStratusHybridTreeFilter(const vtkStratusHybridTreeFilter&) = delete;
  void operator=(const vtkStratusHybridTreeFilter&) = delete;

  class Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
