// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusEXRWriter
 * @brief   writes the arrays of a picture as named float channels of an OpenEXR file
 *
 * Input: a vtkImageData of one layer, for instance vtkStratusVolumeMapper::GetLastImage(). Each array of its point data becomes 32-bit
 * float channels, without loss (ZIP):
 * - "RGBA" becomes R, G, B and A; as in EXR, colours are premultiplied by alpha;
 * - "Depth" becomes Z;
 * - any other array of one component keeps its name ("Samples"), an array of more gets numbered channels: "name.0", "name.1" ...;
 * - an array without a name is RGBA, RGB or grey (Y) if it has 4, 3 or 1 components.
 *
 * A value to which no float is equal (0.1 in double, 16777217) is an error; nothing is rounded. VTK's first row, at the bottom, is EXR's
 * last. The image's origin and spacing are not written.
 *
 * The file takes its name when it is complete. If writing fails or is aborted, a previous file stays as it was.
 *
 * The class exists if Stratus was built with OpenEXR (STRATUS_BUILD_EXR).
 *
 * @sa vtkStratusVolumeMapper
 */
#ifndef vtkStratusEXRWriter_h
#define vtkStratusEXRWriter_h

#include "StratusFiltersIOModule.h" // For export macro
#include "vtkWriter.h"

class STRATUSFILTERSIO_EXPORT vtkStratusEXRWriter : public vtkWriter
{
public:
  static vtkStratusEXRWriter* New();
  vtkTypeMacro(vtkStratusEXRWriter, vtkWriter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  //@{
  /**
   * Set/Get the file to write. Default none.
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  //@}

protected:
  vtkStratusEXRWriter();
  ~vtkStratusEXRWriter() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  void WriteData() override;

  char* FileName = nullptr;

private:
  vtkStratusEXRWriter(const vtkStratusEXRWriter&) = delete;
  void operator=(const vtkStratusEXRWriter&) = delete;

  void WriteImage();
};

#endif
