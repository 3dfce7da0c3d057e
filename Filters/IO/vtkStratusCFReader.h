// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkStratusCFReader
 * @brief   reads a variable of three dimensions from a netCDF file with CF's conventions
 *
 * The output's class follows from the coordinates of the variable's dimensions:
 * - Coordinates that are evenly spaced along all axes give a vtkImageData (so do dimensions without coordinates, counted from 0).
 * - Other one-dimensional coordinates give a vtkRectilinearGrid, with the file's coordinates.
 * - Two-dimensional coordinates that the attribute `coordinates` of the variable names (latitude and longitude of a turned or curved grid;
 *   WRF's are found by their names), or heights that differ between columns, give a vtkStructuredGrid. It is rebuilt at each time step if
 *   they change in time.
 *
 * Variables in groups have their path in their names ("run1/rho"). Coordinates and terms are looked up in the variable's group, in the
 * groups above it, then in all groups.
 *
 * A variable may have more dimensions than three:
 * - A time is a dimension whose variable has units "... since ...", standard_name time, axis T or a time's name, numbers or texts
 *   ("2020-06-01_12:00:00" becomes seconds since the first), or that itself has a time's name ("Time", "month").
 * - An ensemble (standard_name realization, axis E, or its name) is read at index 0.
 * - If more than three dimensions of several values are left, the dimensions whose metadata name an axis are the axes, otherwise the last
 *   three. The outermost of the others is the time if there is none and this dimension has no coordinates. The rest is read at index 0.
 * - A dimension that SetSelection() names is read at its index, whatever it is.
 *
 * Axes are identified by axis, standard_name, units and names, otherwise by their order (time, z, y, x). Coordinates that decrease are
 * reversed with their values. Units are any that UDUNITS knows if the module is built with it, otherwise common ones.
 *
 * Horizontal coordinates: where both are degrees (or radians), they become metres on a sphere of 6,371 km at the middle latitude.
 * Longitudes that jump by 360 degrees are made continuous; the first one stays. Of a lattice that runs around a pole they cannot be
 * continuous everywhere: cells whose longitudes differ by more than 180 degrees are blanked by vtkGhostType.
 *
 * Heights, in metres, follow from the first of these that the file has:
 * - a variable on all three dimensions that the attribute `coordinates` of the variable names;
 * - formula_terms, by every formula of the conventions' appendix D. A formula for pressure gives heights by the hypsometric equation of dry
 *   air where the file has air_temperature on the same levels: up from surface_altitude (or surface_geopotential), else from the height of
 *   the surface pressure in the standard atmosphere. Without a temperature, pressure becomes the height of the standard atmosphere;
 * - PH and PHB of WRF, by (PH + PHB) / 9.81, in the middle of layers for variables there. Staggered variables have the mean of the heights
 *   around them. WRF's ideal cases, whose longitudes are all alike, have DX and DY as distances of points;
 * - the levels' coordinate: a length, a geopotential, a pressure as the height of the standard atmosphere, or a pressure in decibars as the
 *   depth of sea water of 1025 kg m-3. Levels count downwards if `positive` is `down` (upper or lower case). Without `positive`, they do if
 *   standard_name is `depth` or begins with `depth_`; without both, if the name begins with "depth" and no value is negative.
 * Levels that have no unit stay numbers, with a warning where x and y are metres.
 *
 * GetDescription() says which variables coordinates came from, and how their units were converted. Values are point data of the variable's
 * name. Points of which a coordinate of two or more dimensions, or a term of the height, is missing are blanked by vtkGhostType.
 *
 * Coordinates of one dimension that have missing values, values that are not finite, are repeated or not monotone are errors, and so are
 * terms of another quantity than their formula's, pressures below 0, and a time that does not increase.
 *
 * @sa vtkStratusUgridReader vtkStratusZarrReader
 */
#ifndef vtkStratusCFReader_h
#define vtkStratusCFReader_h

#include "vtkStratusNetCDFReader.h"

#include "vtkSmartPointer.h"

class vtkStructuredGrid;

class STRATUSFILTERSIO_EXPORT vtkStratusCFReader : public vtkStratusNetCDFReader
{
public:
  static vtkStratusCFReader* New();
  vtkTypeMacro(vtkStratusCFReader, vtkStratusNetCDFReader);
  void PrintSelf(ostream& os, vtkIndent indent) override;

protected:
  vtkStratusCFReader();
  ~vtkStratusCFReader() override;

  std::string InspectFile(const vtkStratusNetCDFModel& file) override;
  void BuildFile(const vtkStratusNetCDFModel& file, size_t step, vtkDataSet* output) override;

private:
  // The places of points that stay at all time steps, with blanking, and for which file and settings.
  vtkSmartPointer<vtkStructuredGrid> Places;
  vtkTypeUInt64 PlacesFile = 0;
  vtkMTimeType PlacesTime = 0;

  bool TakePlaces(vtkStructuredGrid* output);
  void KeepPlaces(vtkStructuredGrid* output);

  vtkStratusCFReader(const vtkStratusCFReader&) = delete;
  void operator=(const vtkStratusCFReader&) = delete;
};

#endif
