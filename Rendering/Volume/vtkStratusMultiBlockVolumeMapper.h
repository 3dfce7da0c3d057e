// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusMultiBlockVolumeMapper
 * @brief   draws blocks of images and rectilinear grids, one behind the other, by a vtkStratusVolumeMapper each
 *
 * Replaces vtkMultiBlockVolumeMapper. The input is a vtkImageData, a vtkRectilinearGrid, or composite data of them at any depth
 * (vtkMultiBlockDataSet, vtkPartitionedDataSet, vtkPartitionedDataSetCollection). Blocks that a plane across an axis of the data parts are
 * drawn in exact order, however uneven their sizes. Blocks that overlap are each drawn whole, the farther middle first, with a warning: use
 * vtkStratusMultiVolume for media that mix. Blocks that lack the array, and kinds of data that are no grid of these, are left out with a
 * warning. Each block chooses its own structure and sampling, and its gradients are one-sided at its border unless it has ghost cells.
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
};

#endif
