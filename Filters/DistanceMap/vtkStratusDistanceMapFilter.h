// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusDistanceMapFilter
 * @brief   distance in blocks from each block of an image to the nearest block that shows something
 *
 * Input: a vtkImageData or vtkRectilinearGrid with scalars of one component on points (or on cells, by SetInputArrayToProcess). Output: a
 * data set of the input's class, see GetOutputDataObject(), with one cell per block and the cell data "Distance" (unsigned char). The
 * distance is 0 in occupied blocks and the Chebyshev distance in blocks elsewhere, at most 127, in the kind PAPER 255. The output covers
 * the input. Its last blocks may extend beyond the input, except in a rectilinear grid, which ends with the input. For cell data the output
 * begins at the centre of the first cell, because interpolation does.
 *
 * A block is occupied if VolumeProperty's scalar opacity is above 0 somewhere between the block's smallest and largest value. Without a
 * VolumeProperty, a block is occupied if the range from its smallest to its largest value meets LowerThreshold..UpperThreshold, ends
 * included. Values of 24 bits or fewer are compared exactly. Values of wider types are compared as floats, and a float counts if any value
 * that rounds to it does, so that no bound is rounded inward.
 *
 * If the filter fails, its output stays unchanged.
 *
 * @sa vtkStratusVolumeMapper
 */
#ifndef vtkStratusDistanceMapFilter_h
#define vtkStratusDistanceMapFilter_h

#include "StratusFiltersDistanceMapModule.h" // For export macro
#include "vtkImageAlgorithm.h"

#include <memory> // For std::unique_ptr

class vtkTable;
class vtkVolumeProperty;

class STRATUSFILTERSDISTANCEMAP_EXPORT vtkStratusDistanceMapFilter : public vtkImageAlgorithm
{
public:
  static vtkStratusDistanceMapFilter* New();
  vtkTypeMacro(vtkStratusDistanceMapFilter, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  vtkTypeBool ProcessRequest(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  vtkMTimeType GetMTime() override;

  //@{
  /**
   * Set/Get the range of values that count as occupied, ends included. Lower must be <= upper; infinities are allowed. Default: all values.
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
   * Set/Get the property whose scalar opacity decides which blocks are occupied. Default none.
   */
  virtual void SetVolumeProperty(vtkVolumeProperty* property);
  vtkVolumeProperty* GetVolumeProperty();
  //@}

  //@{
  /**
   * Set/Get the number of cells along a block's edge: 2, 4, 8, 16 or 32. Default 4.
   */
  vtkSetMacro(BlockSize, int);
  vtkGetMacro(BlockSize, int);
  //@}

  enum KindType { BLOCK, FULL, PAPER, OCTANT };
  //@{
  /**
   * Set/Get the kind of distance. Default FULL.
   * - BLOCK: 1 in every empty block.
   * - FULL: the distance to the nearest occupied block.
   * - PAPER: the same distances, computed by Deakin and Knackstedt's own transform, and up to their limit of 255.
   * - OCTANT: the distance to the nearest occupied block that a ray of the octant Octant can reach.
   */
  vtkSetClampMacro(Kind, int, BLOCK, OCTANT);
  vtkGetMacro(Kind, int);
  void SetKindToBlock() { this->SetKind(BLOCK); }
  void SetKindToFull() { this->SetKind(FULL); }
  void SetKindToPaper() { this->SetKind(PAPER); }
  void SetKindToOctant() { this->SetKind(OCTANT); }
  const char* GetKindAsString();
  //@}

  //@{
  /**
   * Set/Get the octant of ray directions, 0..7: bit a is set if the rays move in the positive direction of axis a. Default 7. Used only by
   * the kind OCTANT.
   */
  vtkSetClampMacro(Octant, int, 0, 7);
  vtkGetMacro(Octant, int);
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
   * Get the number of occupied blocks of the last output.
   */
  vtkGetMacro(OccupiedBlocks, vtkIdType);
  //@}

protected:
  vtkStratusDistanceMapFilter();
  ~vtkStratusDistanceMapFilter() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  double LowerThreshold;
  double UpperThreshold;
  int BlockSize = 4;
  int Kind = FULL;
  int Octant = 7;
  int NumberOfThreads = 0;
  vtkIdType OccupiedBlocks = 0;

private:
  vtkStratusDistanceMapFilter(const vtkStratusDistanceMapFilter&) = delete;
  void operator=(const vtkStratusDistanceMapFilter&) = delete;

  class Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
