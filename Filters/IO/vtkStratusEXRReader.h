// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusEXRReader
 * @brief   reads the channels of an OpenEXR file as arrays of a picture
 *
 * Output: a vtkImageData of one layer of points from 0, 0 on, with spacing 1. Its point data has arrays of floats, named as
 * vtkStratusEXRWriter writes them:
 * - R, G, B and A are the array "RGBA", R, G and B without A "RGB"; as in EXR, colours are premultiplied by alpha;
 * - Z is "Depth";
 * - channels "name.0", "name.1" ... are components of the array "name";
 * - any other channel is an array of its own name.
 *
 * The active scalars are RGBA, else RGB, else Y, else the first array. VTK's first row, at the bottom, is EXR's last. Channels may be of 32
 * or 16 bits; floats keep their bits, halves become the floats equal to them.
 *
 * Scan lines are read, of the file's first part, by whichever compression OpenEXR's C library knows. Tiles, deep pixels, channels of
 * integers and channels of a coarser grid than the picture are refused. An error empties the output.
 *
 * The class exists if Stratus was built with OpenEXR (STRATUS_BUILD_EXR).
 *
 * @sa vtkStratusEXRWriter vtkStratusImageTest
 */
#ifndef vtkStratusEXRReader_h
#define vtkStratusEXRReader_h

#include "StratusFiltersIOModule.h" // For export macro
#include "vtkImageAlgorithm.h"

class STRATUSFILTERSIO_EXPORT vtkStratusEXRReader : public vtkImageAlgorithm
{
public:
  static vtkStratusEXRReader* New();
  vtkTypeMacro(vtkStratusEXRReader, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  //@{
  /**
   * Set/Get the file to read. Default none.
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  //@}

  /**
   * Return 1 if the file begins as one of OpenEXR, else 0.
   */
  int CanReadFile(const char* path);

protected:
  vtkStratusEXRReader();
  ~vtkStratusEXRReader() override;

  int RequestInformation(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

  char* FileName = nullptr;

private:
  vtkStratusEXRReader(const vtkStratusEXRReader&) = delete;
  void operator=(const vtkStratusEXRReader&) = delete;

  template <typename Function> int Try(Function read);
};

#endif
