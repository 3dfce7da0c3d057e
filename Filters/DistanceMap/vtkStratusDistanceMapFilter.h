// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusDistanceMapFilter
 * @brief   distance in blocks from each block of an image to the nearest one that shows something
 *
 * Input: a vtkImageData with scalars of one component on points (or on cells, by SetInputArrayToProcess). Output: a vtkImageData with
 * one cell a block and the cell data "Distance" (unsigned char): 0 in occupied blocks, the Chebyshev distance in blocks elsewhere, 127
 * where it is longer. It lies over the input; its last blocks may reach beyond it. For cell data it begins at the centre of the first cell,
 * as interpolation does.
 *
 * A block is occupied if something of VolumeProperty's scalar opacity shows between the smallest and the largest value in it, or, without a
 * VolumeProperty, something in LowerThreshold..UpperThreshold, ends included. Values of 24 bits or fewer are compared exactly; of wider
 * types those that one float stands for are told as one. So no bound is ever rounded inward.
 *
 * Where the filter fails its output stays what it was.
 *
 * @sa vtkStratusVolumeMapper
 */
#ifndef vtkStratusDistanceMapFilter_h
#define vtkStratusDistanceMapFilter_h

#include "StratusFiltersDistanceMapModule.h" // For export macro
#include "vtkImageAlgorithm.h"

#include <memory> // For std::unique_ptr

class vtkVolumeProperty;

class STRATUSFILTERSDISTANCEMAP_EXPORT vtkStratusDistanceMapFilter : public vtkImageAlgorithm
{
public:
  static vtkStratusDistanceMapFilter* New();
  vtkTypeMacro(vtkStratusDistanceMapFilter, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  vtkMTimeType GetMTime() override;

  //@{
  /**
   * The values that count as occupied, ends included; lower <= upper, infinities allowed. Default: all. Not used with a VolumeProperty.
   */
  vtkSetMacro(LowerThreshold, double);
  vtkGetMacro(LowerThreshold, double);
  vtkSetMacro(UpperThreshold, double);
  vtkGetMacro(UpperThreshold, double);
  void ThresholdBetween(double lower, double upper);
  //@}

  //@{
  /**
   * The property whose scalar opacity tells what is occupied. Default none.
   */
  virtual void SetVolumeProperty(vtkVolumeProperty* property);
  vtkVolumeProperty* GetVolumeProperty();
  //@}

  //@{
  /**
   * Cells along a block: 2, 4, 8, 16 or 32. Default 4.
   */
  vtkSetMacro(BlockSize, int);
  vtkGetMacro(BlockSize, int);
  //@}

  enum KindType { BLOCK, FULL, PAPER, OCTANT };
  //@{
  /**
   * BLOCK: 1 in every empty block; FULL: the distance to the nearest occupied block; PAPER: the same by Deakin and Knackstedt's own
   * transform, equal to the bit; OCTANT: to the nearest one that a ray of the octant Octant can reach. Default FULL.
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
   * Of the rays, 0..7: bit a is set where they move towards + along axis a. Default 7. Used by the kind OCTANT.
   */
  vtkSetClampMacro(Octant, int, 0, 7);
  vtkGetMacro(Octant, int);
  //@}

  //@{
  /**
   * Of the last output: blocks that are occupied.
   */
  vtkGetMacro(OccupiedBlocks, vtkIdType);
  //@}

protected:
  vtkStratusDistanceMapFilter();
  ~vtkStratusDistanceMapFilter() override;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  double LowerThreshold;
  double UpperThreshold;
  int BlockSize = 4;
  int Kind = FULL;
  int Octant = 7;
  vtkIdType OccupiedBlocks = 0;

private:
  vtkStratusDistanceMapFilter(const vtkStratusDistanceMapFilter&) = delete;
  void operator=(const vtkStratusDistanceMapFilter&) = delete;

  class Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
