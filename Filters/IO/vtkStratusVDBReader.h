// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusVDBReader
 * @brief   reads a sparse grid from a file of OpenVDB (.vdb) or NanoVDB (.nvdb) as an image, or as blocks
 *
 * The file's first bytes decide which library reads it. The file's grids are its variables: numbers of 8 to 64 bits, booleans as 0 and 1,
 * and vectors of three components. NanoVDB's packed floats (Fp4, Fp8, Fp16, FpN) become float, as do OpenVDB's halves. Grids of points,
 * masks and strings are left out, and GetDescription() names them.
 *
 * The image is the bounding box of the grid's active voxels plus a border of one voxel. It contains the values of all voxels in this box,
 * including tiles and inactive voxels; voxels outside the box are dropped. VTK's indices are the grid's indices. Values are points, placed
 * by the grid's map (voxel size, rotation, translation). A map with shear, or a frustum map, is an error.
 *
 * Values of an image of at least MappedBytesLeast bytes stay in a .nvdb file that is not compressed if MapFile is on (default off), or if
 * they are more than a memory limit that is set. They are bricks: the nodes above the leaves are kept, and leaves are read when something
 * looks at their voxels. Elsewhere nothing is read, and of floats and integers of 8 or 16 bits value ranges are known. Such an image may be
 * larger than MemoryLimit: it is the output where blocks would be too large as well.
 *
 * Another image is dense: it needs memory for the whole box. Pages of it that only hold 0 are never written, and use no memory on systems
 * that allocate pages on the first write. If the image needs more than MemoryLimit, the output is a vtkPartitionedDataSet of images
 * instead, unless Layout chooses. The images are blocks of the same grid that meet in faces and cover all cells with an active voxel at a
 * corner. They are divided until at least half of their voxels are in leaves and active tiles, or there are 256 of them.
 * vtkStratusMultiBlockVolumeMapper draws them as one volume, without seams; the space between blocks is empty, whatever the background's
 * value. Blocks that need more than MemoryLimit are an error that reports the bytes.
 *
 * A rank gets its part of the image, or of each block, with ghost cells. Of a .nvdb file that is not compressed, it reads only the leaves
 * in that part. Of a .vdb file whose grid becomes an image, it keeps only these; OpenVDB passes over the others. Other grids are in memory
 * as a whole while the part is made.
 */
#ifndef vtkStratusVDBReader_h
#define vtkStratusVDBReader_h

#include "vtkStratusVariableReader.h"

#include <memory> // For std::shared_ptr

class vtkImageData;
class vtkStratusSparseGrid;
struct vtkStratusCellBox;

class STRATUSFILTERSIO_EXPORT vtkStratusVDBReader : public vtkStratusVariableReader
{
public:
  static vtkStratusVDBReader* New();
  vtkTypeMacro(vtkStratusVDBReader, vtkStratusVariableReader);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  //@{
  /**
   * Set/Get whether the output is one image, or blocks; automatic: blocks where the image would take more than MemoryLimit. Default
   * automatic.
   */
  enum { AUTO_LAYOUT, IMAGE_LAYOUT, BLOCKS_LAYOUT };
  vtkSetClampMacro(Layout, int, AUTO_LAYOUT, BLOCKS_LAYOUT);
  vtkGetMacro(Layout, int);
  //@}

  //@{
  /**
   * Set/Get the most that the image or the blocks may take, in MiB, at least 1. Default 4096. An image of bricks takes what
   * vtkStratusVariableReader::SetMemoryLimit() says.
   */
  vtkSetClampMacro(MemoryLimit, vtkIdType, 1, VTK_ID_MAX / 1048576);
  vtkGetMacro(MemoryLimit, vtkIdType);
  //@}

protected:
  vtkStratusVDBReader();
  ~vtkStratusVDBReader() override;

  std::string Inspect() override;
  void Build(size_t step, vtkDataObject* output) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;

private:
  vtkStratusVDBReader(const vtkStratusVDBReader&) = delete;
  void operator=(const vtkStratusVDBReader&) = delete;

  void FindExtent();
  bool ChooseBlocks();
  vtkSmartPointer<vtkDataArray> LeaveValues(const std::shared_ptr<vtkStratusSparseGrid>& grid) const;
  void BuildImage(
    vtkImageData* image, const vtkStratusSparseGrid& grid, const int extent[6], vtkSmartPointer<vtkDataArray> values = nullptr) const;
  void CheckMap();
  [[noreturn]] void Fail(const std::string& why) const;

  int Layout = AUTO_LAYOUT;
  vtkIdType MemoryLimit = 4096;
  std::shared_ptr<vtkStratusSparseGrid> Grid; // from where it is looked at to where it is put out
  std::string GridName;
  std::vector<vtkStratusCellBox> Blocks; // empty: the output is an image
  bool LeavesImage = false;              // its values stay in the file
};

#endif
