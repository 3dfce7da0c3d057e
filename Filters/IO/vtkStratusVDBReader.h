// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusVDBReader
 * @brief   reads a sparse grid from a file of OpenVDB (.vdb) or NanoVDB (.nvdb) as a vtkImageData
 *
 * Which library reads is told by the file's first bytes. The file's grids are its variables: numbers of 8 to 64 bits, booleans as 0 and 1,
 * and vectors of three components. NanoVDB's packed floats (Fp4, Fp8, Fp16, FpN) become float, as do OpenVDB's halves. Grids of points,
 * masks and strings are left out, and GetDescription() tells which.
 *
 * The image is the box of the grid's active voxels with a border of one voxel. It has all values in there, those of tiles and inactive
 * voxels, too; what lies beyond is taken as not there. VTK's indices are those of the grid, and its values are points, at the places where
 * the grid's map (voxel size, turn, shift) puts them. A map with shear, or one of a frustum, is an error.
 *
 * The image is dense: its memory is that of the box. Pages of it that no value other than 0 comes to are never touched, and take no memory
 * on systems that give pages as they are written. A grid whose box would take more than MemoryLimit is an error that tells the bytes.
 */
#ifndef vtkStratusVDBReader_h
#define vtkStratusVDBReader_h

#include "vtkStratusVariableReader.h"

#include <memory> // For std::unique_ptr

class vtkStratusSparseGrid;

class STRATUSFILTERSIO_EXPORT vtkStratusVDBReader : public vtkStratusVariableReader
{
public:
  static vtkStratusVDBReader* New();
  vtkTypeMacro(vtkStratusVDBReader, vtkStratusVariableReader);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  //@{
  /**
   * Set/Get the most that the image may take, in MiB, at least 1. Default 4096.
   */
  vtkSetClampMacro(MemoryLimit, vtkIdType, 1, VTK_ID_MAX / 1048576);
  vtkGetMacro(MemoryLimit, vtkIdType);
  //@}

protected:
  vtkStratusVDBReader();
  ~vtkStratusVDBReader() override;

  std::string Inspect() override;
  void Build(size_t step, vtkDataSet* output) override;

private:
  vtkStratusVDBReader(const vtkStratusVDBReader&) = delete;
  void operator=(const vtkStratusVDBReader&) = delete;

  void CheckSize();
  void CheckMap();
  [[noreturn]] void Fail(const std::string& why) const;

  vtkIdType MemoryLimit = 4096;
  std::unique_ptr<vtkStratusSparseGrid> Grid; // from where it is looked at to where it is put out
  std::string GridName;
};

#endif
