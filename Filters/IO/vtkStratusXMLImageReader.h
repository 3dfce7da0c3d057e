// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusXMLImageReader
 * @brief   reads an image of a .vti file, and leaves its values in the file
 *
 * The output is the image that vtkXMLImageDataReader has as its output: all arrays of points and cells with their names, units and active
 * attributes, the field data, and the same extent, origin, spacing and direction.
 *
 * The reader is for files of one piece whose values are appended as raw bytes, in either order of bytes, uncompressed or compressed in
 * blocks by vtkZLibDataCompressor or vtkLZ4DataCompressor. CanReadFile() finds them; vtkXMLImageDataReader reads the others (base64, text,
 * several pieces, time steps). The writer's settings are SetDataModeToAppended() and EncodeAppendedDataOff().
 *
 * Values stay in the file if MapFile is on (default off) and an array has at least MappedBytesLeast bytes. Uncompressed values that begin
 * at a multiple of their size are mapped, unless they are more than the memory limit; all others are bricks, which several threads inflate.
 *
 * VariableName is the array that becomes active. Without one, active attributes are as in the file.
 *
 * A file is an error if its header is damaged, or if an array's values do not have the bytes that the extent needs. The error names the
 * array, the bytes that are there and the bytes that must be there.
 *
 * @sa vtkStratusImageReader vtkStratusHDF5Reader
 */
#ifndef vtkStratusXMLImageReader_h
#define vtkStratusXMLImageReader_h

#include "vtkStratusVariableReader.h"

#include <memory> // For std::unique_ptr

class vtkDataArray;
struct vtkStratusXMLArray;
struct vtkStratusXMLImage;

class STRATUSFILTERSIO_EXPORT vtkStratusXMLImageReader : public vtkStratusVariableReader
{
public:
  static vtkStratusXMLImageReader* New();
  vtkTypeMacro(vtkStratusXMLImageReader, vtkStratusVariableReader);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * Return 1 if the file is an image of VTK's XML format whose values are stored as this reader reads them, else 0.
   */
  static int CanReadFile(const char* path);

protected:
  vtkStratusXMLImageReader();
  ~vtkStratusXMLImageReader() override;

  std::string Inspect() override;
  void Build(size_t step, vtkDataObject* output) override;
  int RequestInformation(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
  vtkStratusXMLImageReader(const vtkStratusXMLImageReader&) = delete;
  void operator=(const vtkStratusXMLImageReader&) = delete;

  vtkSmartPointer<vtkDataArray> GetValues(const vtkStratusXMLArray& array, bool* left);
  void ReadFieldData(vtkDataObject* output);

  std::unique_ptr<vtkStratusXMLImage> Image;
};

#endif
