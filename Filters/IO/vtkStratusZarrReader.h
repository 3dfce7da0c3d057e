// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusZarrReader
 * @brief   reads an array of three dimensions from a folder of Zarr
 *
 * FileName is the folder of a group or an array of Zarr, version 2 or 3, or a file of its metadata (zarr.json, .zgroup, .zarray). Arrays
 * are variables, with their path in their names ("run1/rho"); a group's metadata that are consolidated are used.
 *
 * Dimensions have the names that xarray and libnetcdf give them (the attribute _ARRAY_DIMENSIONS, or dimension_names of version 3). Their
 * coordinates, the output's class, the time, units, scale_factor and the other attributes are read as vtkStratusCFReader does it; the
 * fill_value of version 2 is _FillValue where dimensions have names. Integers without attributes of values keep their type; otherwise
 * values are floats or doubles. Dimensions without names are "dim_0", "dim_1" ..., and points are at their numbers.
 *
 * Images of OME-Zarr (versions 0.1 to 0.5, the attribute `multiscales`) have the image's scale and translation, in the image's unit, which
 * GetLengthUnits() returns. The variables are the levels of resolution, the finest first. A channel is read at index 0, another one by
 * SetSelection("c=1"); time steps are the pipeline's.
 *
 * Codecs: zlib, gzip, lz4, shuffle, bitround, crc32c, transpose and sharding_indexed; zstd and blosc if the module is built with libzstd
 * and libblosc. An array with another codec, or whose type is not of booleans, integers or reals, is an error that names it. Halves become
 * floats. A chunk without a file has the fill value. A chunk that cannot be decoded is an error; in bricks (SetMapFile()) its values are
 * missing, and so are the values of chunks that are read together with it.
 *
 * With SetMapFile() the bricks are chunks. Decoding is done by several threads at once.
 *
 * @sa vtkStratusCFReader
 */
#ifndef vtkStratusZarrReader_h
#define vtkStratusZarrReader_h

#include "vtkStratusCFReader.h"

class STRATUSFILTERSIO_EXPORT vtkStratusZarrReader : public vtkStratusCFReader
{
public:
  static vtkStratusZarrReader* New();
  vtkTypeMacro(vtkStratusZarrReader, vtkStratusCFReader);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * Returns 1 if a path is the folder of a group or an array of Zarr, or a file of its metadata, else 0.
   */
  static int CanReadFile(const char* name);

protected:
  vtkStratusZarrReader() = default;
  ~vtkStratusZarrReader() override = default;

#ifndef __VTK_WRAP__
  std::unique_ptr<vtkStratusNetCDFModel> OpenFile() override;
#endif
  std::string InspectFile(const vtkStratusNetCDFModel& file) override;

private:
  vtkStratusZarrReader(const vtkStratusZarrReader&) = delete;
  void operator=(const vtkStratusZarrReader&) = delete;
};

#endif
