// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusNetCDFReader
 * @brief   what the readers of netCDF files share
 *
 * Values are read as the netCDF users' guide says. All these attributes are about stored values, before scale_factor and add_offset:
 * - _Unsigned "true" or "false" gives integers the other sign; bytes with a valid limit above 127 have no sign.
 * - Values equal to _FillValue (its default for all types but bytes) or to any number of missing_value are NaN.
 * - Values outside of valid_range, or without it below valid_min or above valid_max, are NaN.
 * - Then scale_factor and add_offset are applied. Each must be one finite number; anything else is an error.
 *
 * Attributes are compared in the variable's type. GetDescription() tells which are ignored: text, and limits that packed integers cannot
 * hold. Values are floats if these tell all of the variable's values apart, else doubles.
 *
 * Variables are listed, and the first is read by default, in this order: fields of the cells; staggered ones; flags and masks; what
 * coordinates are made of, such as pressure, geopotential, height, thickness and area. Equals stay in the file's order.
 *
 * @sa vtkStratusCFReader vtkStratusUgridReader
 */
#ifndef vtkStratusNetCDFReader_h
#define vtkStratusNetCDFReader_h

#include "vtkStratusVariableReader.h"

class vtkStratusNetCDFFile;
struct vtkStratusNetCDFVariable;

class STRATUSFILTERSIO_EXPORT vtkStratusNetCDFReader : public vtkStratusVariableReader
{
public:
  vtkTypeMacro(vtkStratusNetCDFReader, vtkStratusVariableReader);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  //@{
  /**
   * Set/Get the dimensions that are read at one index only: "NAME=INDEX,NAME=INDEX...", indices from 0. A dimension that is selected is
   * neither an axis nor the time, so that a variable of more than three dimensions can be cut as one likes. A name with the path of its
   * group ("run1/number") is this group's dimension; without a path it is each dimension of this name. A name that the file does not have,
   * and an index out of range, are errors. Default none: what is neither axis nor time is read at index 0.
   */
  vtkSetStringMacro(Selection);
  vtkGetStringMacro(Selection);
  //@}

protected:
  vtkStratusNetCDFReader() = default;
  ~vtkStratusNetCDFReader() override;

  /// As those of the superclass, with the file open.
  virtual std::string InspectFile(const vtkStratusNetCDFFile& file) = 0;
  virtual void BuildFile(const vtkStratusNetCDFFile& file, size_t step, vtkDataSet* output) = 0;

  /// Lists a variable: before those of a later `place`, and at the same place fields of the cells first, then staggered ones, then flags
  /// and masks, then what coordinates are made of (pressure, geopotential, thickness, area).
  void AddVariable(const vtkStratusNetCDFFile& file, const vtkStratusNetCDFVariable& variable, int place = 0);

  std::string Inspect() override;
  void Build(size_t step, vtkDataObject* output) override;

  char* Selection = nullptr;

private:
  std::vector<int> Ranks; // of Variables

  vtkStratusNetCDFReader(const vtkStratusNetCDFReader&) = delete;
  void operator=(const vtkStratusNetCDFReader&) = delete;
};

#endif
