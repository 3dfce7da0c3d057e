// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusNetCDFReader
 * @brief   what the readers of netCDF files share
 *
 * Values that are missing (_FillValue, missing_value, outside of valid_range) are NaN; scale_factor and add_offset are applied.
 *
 * @sa vtkStratusCFReader vtkStratusUgridReader
 */
#ifndef vtkStratusNetCDFReader_h
#define vtkStratusNetCDFReader_h

#include "vtkStratusVariableReader.h"

class vtkStratusNetCDFFile;

class STRATUSFILTERSIO_EXPORT vtkStratusNetCDFReader : public vtkStratusVariableReader
{
public:
  vtkTypeMacro(vtkStratusNetCDFReader, vtkStratusVariableReader);
  void PrintSelf(ostream& os, vtkIndent indent) override;

protected:
  vtkStratusNetCDFReader() = default;
  ~vtkStratusNetCDFReader() override = default;

  /// As those of the superclass, with the file open.
  virtual std::string InspectFile(const vtkStratusNetCDFFile& file) = 0;
  virtual void BuildFile(const vtkStratusNetCDFFile& file, size_t step, vtkDataSet* output) = 0;

  std::string Inspect() override;
  void Build(size_t step, vtkDataObject* output) override;

private:
  vtkStratusNetCDFReader(const vtkStratusNetCDFReader&) = delete;
  void operator=(const vtkStratusNetCDFReader&) = delete;
};

#endif
