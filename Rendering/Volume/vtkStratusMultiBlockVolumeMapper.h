// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusMultiBlockVolumeMapper
 * @brief   draws blocks of images and rectilinear grids, one behind the other, by a vtkStratusVolumeMapper each
 *
 * Replaces vtkMultiBlockVolumeMapper and vtkAMRVolumeMapper. The input is a vtkImageData, a vtkRectilinearGrid, composite data of them at
 * any depth (vtkMultiBlockDataSet, vtkPartitionedDataSet, vtkPartitionedDataSetCollection), or a vtkOverlappingAMR. Blocks that a plane
 * across an axis of the data separates are drawn in exact order, however uneven their sizes. In composite mode, blocks that overlap are
 * each drawn whole, the block with the farther middle first, with a warning: use vtkStratusMultiVolume for media that mix. Other modes join
 * them: surfaces by depth, the best value, the mean or sum of all. Blocks that lack the array, and data
 * of other classes, are left out with a warning. Each block chooses its own structure and sampling. Its gradients are one-sided at its
 * border unless it has ghost cells.
 *
 * In AMR, the finest cell at a place is drawn, and the field has no crack between levels, whatever their ratios. Linear interpolation of
 * cell values is between cell centres. A cell that finer cells cover has the value of their field at its centre. Where two levels meet, the
 * finer side uses the coarser side's values at the corners of half cells. Point values on such a border are also taken from the coarser
 * side. Nearest interpolation, and first hits, show each cell's own value. The mapper makes adjacent grids that hold this field exactly:
 * the finer cells of a place and, around them, the coarser ones at their own spacing. These grids are its blocks. Vectors are interpolated
 * by components before their magnitude is computed. Levels must nest: a box covers whole cells of the next coarser level, which has boxes
 * there. Nearest interpolation of point values is refused by an error, and so is vtkNonOverlappingAMR.
 *
 * Gradients in AMR are differences of this field over the width of each level's cells, about the centres of all its cells, and between
 * these as values are. So light has no seams between levels. Magnitudes are in values per mean spacing of the coarsest level. The grids of
 * lit pictures keep their gradients, and take four times the memory.
 *
 * Set the members of vtkVolumeMapper (scalars, blend mode, cropping, clipping planes) at this mapper, and all other settings at
 * GetSettings(). Both hold for all blocks. The blocks' frames are blended as floats, so that their borders do not show. All blend modes
 * and first hits are drawn. Maximum, minimum, average and additive are of all blocks together, with the range of all values. A mask or a
 * label map of GetSettings() may have any grid: each value of a block takes the byte of the mask's nearest point, and 0 outside the mask.
 * The cost of a frame grows with the visible part of each block. Each block keeps its own structure and tables.
 *
 * Among other volumes of the renderer it is drawn by depth. Volumes that overlap it are drawn over it or under it, with a warning.
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
   * Get the mapper that holds the settings of all blocks' mappers. It draws nothing itself.
   */
  vtkStratusVolumeMapper* GetSettings();

  //@{
  /**
   * Set/Get the piece of an AMR input that is drawn, and the number of pieces: boxes in space that share the values evenly. Other input is
   * drawn whole. Numbers below the minimum are raised to it. Default 0 of 1.
   */
  vtkSetClampMacro(Piece, int, 0, VTK_INT_MAX);
  vtkGetMacro(Piece, int);
  vtkSetClampMacro(NumberOfPieces, int, 1, VTK_INT_MAX);
  vtkGetMacro(NumberOfPieces, int);
  //@}

  /**
   * Set the ranges of a two-dimensional function's columns and rows, if this input is a part of larger data: first and last value, and
   * first and last value of the second variable. If first > last (default), the data of all blocks set the range.
   */
  void SetTransfer2DRanges(const double ranges[4]);

  /**
   * Get the number of blocks of the last picture.
   */
  int GetNumberOfBlocks();

  /**
   * Get the mapper of a block in the last frame, 0..GetNumberOfBlocks()-1, in the input's order; nullptr beyond. Its getters report
   * statistics.
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
   * Get the bounds of the drawn cells. Cells that other pieces of the data own (DUPLICATECELL) do not count.
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
  bool MeasureSampling(vtkRenderer* renderer, vtkVolume* volume, double choice[4], vtkDataSet* whole = nullptr);

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
