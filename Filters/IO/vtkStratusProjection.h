// SPDX-License-Identifier: BSD-3-Clause
// Map projections and rotated poles of CF's appendix F, or of a coordinate reference system that the file has as text (WKT), by PROJ where
// the module is built with it. Private to the module.
#ifndef vtkStratusProjection_h
#define vtkStratusProjection_h

#include "vtkStratusNetCDFModel.h"

#include <memory>
#include <string>

class vtkStratusProjection
{
public:
  using Variable = vtkStratusNetCDFModel::Variable;

  // Returns the variable of attributes that the attribute grid_mapping of a variable names. nullptr if there is none, or if it is one of
  // longitudes and latitudes, which need no projection. Attributes are CF's parameters (grid_mapping_name and others), which count first,
  // or one text: crs_wkt of CF, spatial_ref of GDAL, wkt or EPSG_code of Delft3D FM.
  static const Variable* FindMapping(const vtkStratusNetCDFModel& file, const Variable& variable);
  // Metres of a radian of the coordinates of a geostationary view, which are angles of the instrument; 0 for other mappings.
  static double MetresPerRadian(const vtkStratusNetCDFModel& file, const Variable& mapping);

  // metres: of a unit of the projection coordinates, in which the file has the false easting and northing.
  // Throws vtkStratusReadError for a mapping that is unknown or incomplete, and where the module is built without PROJ.
  vtkStratusProjection(const vtkStratusNetCDFModel& file, const Variable& mapping, double metres);
  ~vtkStratusProjection();
  vtkStratusProjection(const vtkStratusProjection&) = delete;
  void operator=(const vtkStratusProjection&) = delete;

  // Coordinates are in degrees about another pole, those of other mappings in metres.
  bool IsRotated() const { return this->Rotated; }
  // degrees: longitude and latitude; at: x and y. Return false where the projection has no such place.
  bool ToPlane(const double degrees[2], double at[2]) const;
  bool ToEarth(const double at[2], double degrees[2]) const;
  // "'crs' (lambert_conformal_conic)"
  const std::string& Describe() const { return this->Description; }

private:
  struct Proj;
  std::unique_ptr<Proj> Library;
  bool Rotated = false;
  std::string Description;
};

#endif
