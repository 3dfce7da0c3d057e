// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusMultiBlockVolumeMapper
 * @brief   draws blocks of images and rectilinear grids, one behind the other, by a vtkStratusVolumeMapper each
 *
 * Replaces vtkMultiBlockVolumeMapper and vtkAMRVolumeMapper. The input is a vtkImageData, a vtkRectilinearGrid, composite data of them at
 * any depth (vtkMultiBlockDataSet, vtkPartitionedDataSet, vtkPartitionedDataSetCollection), or a vtkOverlappingAMR. Blocks that a plane
 * across an axis of the data parts are drawn in exact order, however uneven their sizes. Blocks that overlap are each drawn whole, the
 * farther middle first, with a warning: use vtkStratusMultiVolume for media that mix. Blocks that lack the array, and kinds of data that
 * are no grid of these, are left out with a warning. Each block chooses its own structure and sampling, and its gradients are one-sided at
 * its border unless it has ghost cells.
 *
 * Of AMR, each place has its finest cell, and the field has no crack between levels, whatever their ratios. Linear interpolation of values
 * of cells is between centres; a cell that finer ones cover has their field's value at its centre, and where two levels meet, the finer
 * side has the coarser side's values at the corners of halves of its cells. Values of points on such a border are those of the coarser
 * side, too. Nearest interpolation, and first hits, show each cell's own value. The mapper makes grids side by side that hold this field
 * exactly, with the finer cells of a place and, around them, the coarser ones at their own spacing; these are its blocks. Vectors are
 * interpolated by components before their magnitude is taken. Levels must nest: a box lies on whole cells of the next coarser level, which
 * has boxes there. Light by gradients, gradient opacity, functions of two variables and nearest interpolation of values of points are
 * refused by an error, and so is vtkNonOverlappingAMR.
 *
 * What vtkVolumeMapper has (scalars, blend mode, cropping, clipping planes) is set at this mapper, the rest at GetSettings(); both hold for
 * all blocks. The blocks' pictures are blended as floats, so that their borders show nothing. That draws the blend modes composite,
 * isosurface and slice, and first hits; more than one block in another mode is refused by an error, and nothing is drawn. The cost of a
 * picture grows with what is seen of each block, and each block keeps its own structure and tables.
 *
 * @sa vtkStratusVolumeMapper vtkStratusMultiVolume
 */
#ifndef vtkStratusMultiBlockVolumeMapper_h
#define vtkStratusMultiBlockVolumeMapper_h

#include "StratusRenderingVolumeModule.h" // For export macro
#include "vtkVolumeMapper.h"

#include <memory> // For std::unique_ptr

class vtkImageData;
class vtkDataSet;
class vtkStratusVolumeMapper;

class STRATUSRENDERINGVOLUME_EXPORT vtkStratusMultiBlockVolumeMapper : public vtkVolumeMapper
{
public:
  static vtkStratusMultiBlockVolumeMapper* New();
  vtkTypeMacro(vtkStratusMultiBlockVolumeMapper, vtkVolumeMapper);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * Get the mapper whose settings each block's mapper takes. It draws nothing itself.
   */
  vtkStratusVolumeMapper* GetSettings();

  //@{
  /**
   * Set/Get which piece of AMR is drawn, and of how many: boxes of the space that share its values evenly. Other input is drawn whole.
   * Numbers below their least become it. Default 0 of 1.
   */
  vtkSetClampMacro(Piece, int, 0, VTK_INT_MAX);
  vtkGetMacro(Piece, int);
  vtkSetClampMacro(NumberOfPieces, int, 1, VTK_INT_MAX);
  vtkGetMacro(NumberOfPieces, int);
  //@}

  /**
   * Set what the columns and rows of a two-dimensional function cover: first and last value, and first and last of the second variable, as
   * of data that this input is a part of. Where the first is greater than the last, as by default, each block's own data tell.
   */
  void SetTransfer2DRanges(const double ranges[4]);

  /**
   * Get the number of blocks of the last picture.
   */
  int GetNumberOfBlocks();

  /**
   * Get the mapper of a block in the last picture, 0..GetNumberOfBlocks()-1, in the input's order; nullptr beyond. It tells of statistics.
   */
  vtkStratusVolumeMapper* GetBlockMapper(int block);

  /**
   * Get the last picture, as vtkStratusVolumeMapper::GetLastImage() does; nullptr where there is none.
   */
  vtkImageData* GetLastImage();

  /**
   * Get why the last picture was refused; empty if it was not.
   */
  const char* GetLastError();

  /**
   * Get the bounds of what is drawn: without cells that other pieces of the data own (DUPLICATECELL).
   */
  double* GetBounds() VTK_SIZEHINT(6) override;
  using Superclass::GetBounds;
  vtkMTimeType GetMTime() override;

  /**
   * WARNING: INTERNAL METHOD - NOT INTENDED FOR GENERAL USE
   */
  void Render(vtkRenderer* renderer, vtkVolume* volume) override;
  void ReleaseGraphicsResources(vtkWindow* window) override;

  /**
   * WARNING: INTERNAL METHOD - NOT INTENDED FOR GENERAL USE
   * As of vtkStratusVolumeMapper, for all blocks: the largest sampling of any, and the shortest distance and least error. Returns false
   * where no block would be drawn. whole: an image or rectilinear grid that is measured in place of the input.
   */
  bool MeasureSampling(vtkRenderer* renderer, vtkVolume* volume, double choice[3], vtkDataSet* whole = nullptr);

protected:
  vtkStratusMultiBlockVolumeMapper();
  ~vtkStratusMultiBlockVolumeMapper() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;

private:
  vtkStratusMultiBlockVolumeMapper(const vtkStratusMultiBlockVolumeMapper&) = delete;
  void operator=(const vtkStratusMultiBlockVolumeMapper&) = delete;

  class Internals;
  std::unique_ptr<Internals> Internal;
  int Piece = 0;
  int NumberOfPieces = 1;
};

#endif
