// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusCFReader
 * @brief   reads a variable of three dimensions from a netCDF file with CF's conventions
 *
 * The output's class follows from the coordinates of the variable's dimensions:
 * - evenly spaced ones along all axes give a vtkImageData (so do dimensions without coordinates, counted from 0);
 * - others a vtkRectilinearGrid, at the very coordinates that the file has;
 * - two-dimensional ones (latitude and longitude of a turned or curved grid), a three-dimensional height, or a height that follows terrain
 * or a free surface (formula_terms of ocean_sigma_coordinate, ocean_s_coordinate_g1 and _g2, atmosphere_hybrid_height_coordinate) give a
 *   vtkStructuredGrid, anew at each time step where they change in time.
 *
 * Axes are told by axis, standard_name, units and names, else by their order (time, z, y, x). Coordinates that decrease are turned round
 * with their values, positive: "down" becomes negative z. Where both horizontal coordinates are degrees, they become metres on a sphere of
 * 6,371 km at the middle latitude; lengths become metres, a pressure becomes the height of the standard atmosphere. GetDescription() tells
 * what was done. Values are point data of the variable's name.
 *
 * Coordinates that are missing, not finite, repeated or not monotone are errors, and so is a time that does not increase.
 *
 * @sa vtkStratusUgridReader
 */
#ifndef vtkStratusCFReader_h
#define vtkStratusCFReader_h

#include "vtkStratusNetCDFReader.h"

class STRATUSFILTERSIO_EXPORT vtkStratusCFReader : public vtkStratusNetCDFReader
{
public:
  static vtkStratusCFReader* New();
  vtkTypeMacro(vtkStratusCFReader, vtkStratusNetCDFReader);
  void PrintSelf(ostream& os, vtkIndent indent) override;

protected:
  vtkStratusCFReader() = default;
  ~vtkStratusCFReader() override = default;

  std::string InspectFile(const vtkStratusNetCDFFile& file) override;
  void BuildFile(const vtkStratusNetCDFFile& file, size_t step, vtkDataSet* output) override;

private:
  vtkStratusCFReader(const vtkStratusCFReader&) = delete;
  void operator=(const vtkStratusCFReader&) = delete;
};

#endif
