// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusHybridTreeFilter
 * @brief   builds the tree by which rays skip empty space, and stores it in the image
 *
 * Input: a vtkImageData or vtkRectilinearGrid with scalars of one component on points (or on cells, by SetInputArrayToProcess). First
 * output: a shallow copy of it, see GetOutputDataObject(), with the tree in its field data:
 * - "StratusHybridTree" (unsigned char): the tree, with a version and a checksum;
 * - "StratusHybridTreeVersion" (int): the major and minor version of the Stratus that wrote it;
 * - "StratusHybridTreeHash" (string): a hash of the values and hidden parts from which it was built.
 *
 * VTK's writers and readers keep these arrays. A vtkStratusVolumeMapper uses the tree of its input if the tree holds all that the transfer
 * function shows, and builds its own otherwise.
 *
 * Second output: a vtkPolyData with one polyline per node, the box of the node in world coordinates, parents before children. Cell data:
 * "Depth" (int, 0 at the root; the scalars), "Kind" (unsigned char: 0 inner node, 1 leaf of bricks, 2 leaf of a distance field) and "Count"
 * (vtkIdType: voxels of the tree in the box).
 *
 * The tree holds what VolumeProperty's scalar opacity shows. Without a VolumeProperty it holds values in LowerThreshold..UpperThreshold.
 *
 * If the filter fails, its outputs stay unchanged.
 *
 * @sa vtkStratusVolumeMapper vtkStratusDistanceMapFilter
 */
#ifndef vtkStratusHybridTreeFilter_h
#define vtkStratusHybridTreeFilter_h

#include "StratusFiltersHybridTreeModule.h" // For export macro
#include "vtkImageAlgorithm.h"

#include <memory> // For std::unique_ptr

class vtkPolyData;
class vtkTable;
class vtkVolumeProperty;

class STRATUSFILTERSHYBRIDTREE_EXPORT vtkStratusHybridTreeFilter : public vtkImageAlgorithm
{
public:
  static vtkStratusHybridTreeFilter* New();
  vtkTypeMacro(vtkStratusHybridTreeFilter, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  vtkTypeBool ProcessRequest(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  vtkMTimeType GetMTime() override;

  //@{
  /**
   * Set/Get the range of values that the tree holds, ends included. Lower must be <= upper; infinities are allowed. Default: all values.
   * Ignored where a VolumeProperty is set.
   */
  vtkSetMacro(LowerThreshold, double);
  vtkGetMacro(LowerThreshold, double);
  vtkSetMacro(UpperThreshold, double);
  vtkGetMacro(UpperThreshold, double);
  void ThresholdBetween(double lower, double upper);
  //@}

  //@{
  /**
   * Set/Get the property whose scalar opacity decides which values the tree holds. Default none.
   */
  virtual void SetVolumeProperty(vtkVolumeProperty* property);
  vtkVolumeProperty* GetVolumeProperty();
  //@}

  enum PurposeType { RAY_CASTING, FIRST_HITS };
  //@{
  /**
   * Set/Get the purpose of the tree. Default RAY_CASTING.
   * - RAY_CASTING: the tree holds blocks of cells that show something between their smallest and largest value, rounded outward.
   *   It serves every transfer function that shows no more.
   * - FIRST_HITS: the tree holds single voxels. It serves transfer functions that show the same voxels. Of a vtkRectilinearGrid it is
   *   refused: voxels have equal spacing.
   */
  vtkSetClampMacro(Purpose, int, RAY_CASTING, FIRST_HITS);
  vtkGetMacro(Purpose, int);
  void SetPurposeToRayCasting() { this->SetPurpose(RAY_CASTING); }
  void SetPurposeToFirstHits() { this->SetPurpose(FIRST_HITS); }
  //@}

  enum MethodType { HYBRID, HYBRID_PAPER, DISTANCE, OCTANT, SAH, SWEEP, LBVH, PLOC, AGGLOMERATIVE, DENSITY_PEAKS, K_MEANS, WIDE, AUTO };
  //@{
  /**
   * Set/Get how the tree is built. Default AUTO.
   * - AUTO: OCTANT if it needs at most 1 MB or at most as many bytes as WIDE, otherwise WIDE. GetReason() says which was chosen, and why.
   * - HYBRID: leaves of distance fields where voxels are spread evenly, a hierarchy of bricks elsewhere.
   * - HYBRID_PAPER: the method of Guo et al. 2025 as published.
   * - DISTANCE, OCTANT: one distance field over everything; OCTANT stores a distance for each octant of ray directions.
   * - SAH, SWEEP, LBVH, PLOC, AGGLOMERATIVE, DENSITY_PEAKS, K_MEANS: hierarchies of single voxels, for comparison.
   * - WIDE: one leaf of all bricks with a hierarchy of 16 children a node over them, for sets that are large and sparse. Its nodes are not
   *   among the boxes of the second output.
   */
  vtkSetClampMacro(Method, int, HYBRID, AUTO);
  vtkGetMacro(Method, int);
  void SetMethodToAuto() { this->SetMethod(AUTO); }
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
  void SetMethodToWide() { this->SetMethod(WIDE); }
  const char* GetMethodAsString();
  //@}

  //@{
  /**
   * Set/Get the depth at which a node becomes a leaf, 1..64. Hierarchies of voxels may go deeper, but split at the median from there on.
   * AUTO, DISTANCE, OCTANT and WIDE have no depth to choose. Default 32.
   */
  vtkSetClampMacro(MaximumDepth, int, 1, 64);
  vtkGetMacro(MaximumDepth, int);
  //@}

  //@{
  /**
   * Set/Get the most bricks (4^3 voxels) in a leaf of bricks of HYBRID and HYBRID_PAPER, and the most voxels in a leaf of a hierarchy of
   * voxels; each 1..64. Default 4 and 1.
   */
  vtkSetClampMacro(LeafBricks, int, 1, 64);
  vtkGetMacro(LeafBricks, int);
  vtkSetClampMacro(LeafVoxels, int, 1, 64);
  vtkGetMacro(LeafVoxels, int);
  //@}

  //@{
  /**
   * Set/Get, for HYBRID and HYBRID_PAPER, the most bricks that a leaf of a distance field covers, 1..2^29, and, for HYBRID, the most of
   * them per brick that holds a voxel, at least 1. A value out of range is an error when building. Default 33554432 and 512.
   */
  vtkSetMacro(FieldBricks, vtkIdType);
  vtkGetMacro(FieldBricks, vtkIdType);
  vtkSetMacro(FieldEmptiness, double);
  vtkGetMacro(FieldEmptiness, double);
  //@}

  //@{
  /**
   * Set/Get how much the spread of voxels may differ between the axes for a node to count as evenly filled. Uniform (of HYBRID, default .1)
   * is a fraction of the node's extent. PaperThreshold (of HYBRID_PAPER, default 8) is in voxels. A value below 0 is an error when
   * building.
   */
  vtkSetMacro(Uniform, double);
  vtkGetMacro(Uniform, double);
  vtkSetMacro(PaperThreshold, double);
  vtkGetMacro(PaperThreshold, double);
  //@}

  //@{
  /**
   * Set/Get the bandwidth of the density estimate in voxels. 0 (default) takes the paper's rule, but at least 1. A negative value is an
   * error when building.
   */
  vtkSetMacro(Bandwidth, double);
  vtkGetMacro(Bandwidth, double);
  //@}

  //@{
  /**
   * Set/Get how density is estimated. ExactDensity sums it voxel by voxel instead of brick by brick; DensityPerNode computes it anew in
   * each node. Default off; HYBRID_PAPER always does both.
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
   * Set/Get whether AGGLOMERATIVE takes the sum of a box's edges for the distance of the two clusters in it, instead of its surface area as
   * published. Default off.
   */
  vtkSetClampMacro(AgglomerativeByEdges, vtkTypeBool, 0, 1);
  vtkGetMacro(AgglomerativeByEdges, vtkTypeBool);
  vtkBooleanMacro(AgglomerativeByEdges, vtkTypeBool);
  //@}

  //@{
  /**
   * Set/Get whether the leaves of HYBRID_PAPER keep the distances of its jump flooding as they come out, instead of corrected by exact
   * ones. Rays may then step past voxels, so the tree serves studies only: no mapper uses it. Default off.
   */
  vtkSetClampMacro(UncorrectedFlooding, vtkTypeBool, 0, 1);
  vtkGetMacro(UncorrectedFlooding, vtkTypeBool);
  vtkBooleanMacro(UncorrectedFlooding, vtkTypeBool);
  //@}

  //@{
  /**
   * Set/Get the device that builds: "auto" (the host or an OpenCL GPU, whichever draws a small picture faster), "host", or an OpenCL device
   * by its number or a part of its name. The output does not depend on it. A device that does not exist is an error that lists the existing
   * ones, and the previous device and output stay. The host does what has no kernels or does not fit the device, and everything where the
   * device is a processor. Default "auto".
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
   * Get statistics of the last tree built: voxels that it holds, bricks that hold any, nodes, leaves, leaves of distance fields, depth of
   * the deepest leaf, bytes, cost by the surface area heuristic, build time in milliseconds, and a sentence with the reason for its shape.
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
   * Get the second output.
   */
  vtkPolyData* GetBoxes();

protected:
  vtkStratusHybridTreeFilter();
  ~vtkStratusHybridTreeFilter() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  double LowerThreshold;
  double UpperThreshold;
  int Purpose = RAY_CASTING;
  int Method = AUTO;
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
  vtkTypeBool AgglomerativeByEdges = 0;
  vtkTypeBool UncorrectedFlooding = 0;
  int NumberOfThreads = 0;

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
