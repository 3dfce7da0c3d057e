// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusImageReader
 * @brief   reads an image of NRRD, MetaImage or NIfTI, with its orientation and its scaling
 *
 * The file's first bytes decide its format: NRRD (.nrrd, .nhdr), MetaImage (.mha, .mhd), NIfTI-1 and NIfTI-2 (.nii, .nii.gz, .hdr with
 * .img).
 * The output is a vtkImageData with one array, named as VTK's readers name theirs: "ImageFile", "MetaImage", "NIFTI".
 *
 * Place: samples have the positions that the file gives them, in the file's own coordinates (GetDescription() says which). The spacing is
 * the distance between neighbouring samples, and the direction matrix has the directions from each sample to the next one as its columns.
 * It may mirror and shear: VTK's images and the Stratus mappers use the whole matrix. Axes in one plane are an error.
 *
 * Values: bytes are put into the machine's order. NIfTI's scl_slope and scl_inter and MetaImage's ElementToIntensityFunction are applied;
 * scaled values are float, or double where they are stored in 32 bits of integers or more than 32 bits.
 *
 * Components: of NRRD an axis of a kind such as vector, RGB-color or list, wherever it stands; of MetaImage the channels; of NIfTI the
 * fifth dimension, and colours. A vector's array is the active vectors, others are the active scalars.
 *
 * Time: in NRRD an axis of time, in MetaImage and NIfTI the fourth dimension. If the file does not say how long a step is, steps are
 * numbered.
 *
 * MapFile is on by default: values that are in the file as the program needs them stay there: uncompressed, in the machine's order of
 * bytes, not scaled, in one piece. If a memory limit is set and they are more, they are bricks; otherwise what a program writes into the
 * array stays in memory.
 *
 * A file is an error if it has less data than its header says, or needs an unsupported feature: the message names it. docs/command-line.md
 * has a table of supported features.
 *
 * @sa vtkStratusVDBReader vtkStratusCFReader
 */
#ifndef vtkStratusImageReader_h
#define vtkStratusImageReader_h

#include "vtkStratusVariableReader.h"

#include <memory> // For std::unique_ptr

class vtkDataArray;
struct vtkStratusImageFile;

class STRATUSFILTERSIO_EXPORT vtkStratusImageReader : public vtkStratusVariableReader
{
public:
  static vtkStratusImageReader* New();
  vtkTypeMacro(vtkStratusImageReader, vtkStratusVariableReader);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * Read a file without a header: size[0]*size[1]*size[2] values of a type of VTK's (VTK_FLOAT), x fastest, behind `skip` bytes. The first
   * value is at 0,0,0.
   */
  void SetRawLayout(const int size[3], int type, bool bigEndian, const double spacing[3], vtkTypeInt64 skip);

  /**
   * Return 1 if the file begins as one of NRRD, MetaImage or NIfTI, else 0.
   */
  static int CanReadFile(const char* path);

protected:
  vtkStratusImageReader();
  ~vtkStratusImageReader() override;

  std::string Inspect() override;
  void Build(size_t step, vtkDataObject* output) override;
  int RequestInformation(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
  vtkStratusImageReader(const vtkStratusImageReader&) = delete;
  void operator=(const vtkStratusImageReader&) = delete;

  void FindFrame();
  vtkSmartPointer<vtkDataArray> Map(int64_t first, int64_t points);
  vtkSmartPointer<vtkDataArray> ReadStored(size_t step);

  std::unique_ptr<vtkStratusImageFile> File;
  double Origin[3], Spacing[3], Direction[9];
  int Components = 1;
  std::unique_ptr<vtkStratusImageFile> Raw; // the layout of a file without a header
};

#endif
