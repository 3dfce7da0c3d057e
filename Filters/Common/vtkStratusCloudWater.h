// SPDX-License-Identifier: BSD-3-Clause
// An array of a grid as the water of clouds in physical units. Private to the modules and programs, never installed.
#ifndef vtkStratusCloudWater_h
#define vtkStratusCloudWater_h

#include "stratus.h"
#include "vtkStratusPrivate.h"

#include "vtkType.h" // For vtkIdType

class vtkDataArray;
class vtkDataSet;
class vtkFloatArray;

// The density of air at the values of a grid: that of the standard atmosphere at their heights, unless arrays of air are set.
class VTK_STRATUS_PRIVATE vtkStratusAir
{
public:
  // onCells: whether values are of cells; up: the axis upwards, 0, 1 or 2; metres: length of a world unit. The context and the grid stay
  // the caller's.
  vtkStratusAir(stratus_context* context, vtkDataSet* grid, bool onCells, int up, double metres);

  // Arrays of the grid's values, in kg/m3, Pa and K. Density is preferred to Pressure and Temperature, which go together.
  vtkDataArray *Density = nullptr, *Pressure = nullptr, *Temperature = nullptr;

  // Finds the density at a value, kg/m3.
  stratus_status Find(vtkIdType value, double* density);

private:
  double HeightOf(vtkIdType value) const;

  stratus_context* Context;
  vtkDataSet* Grid;
  bool OnCells;
  int Up;
  double Metres;
  double Height, Standard = 0.0; // of the last value, m, and the density there
};

struct vtkStratusCloudWater {
  double Radius = STRATUS_WATER_RADIUS;           // the effective radius, m
  double ParticleDensity = STRATUS_WATER_DENSITY; // kg/m3
  stratus_cloud_measure Measure = STRATUS_CLOUD_UNKNOWN;
  double Factor = 1.0; // from values to kg/m3 or kg/kg

  // Sets all by an array's name and standard name (either may be nullptr), its unit, and the radius in m, 0: the usual one of droplets or
  // crystals. Measure is STRATUS_CLOUD_UNKNOWN if the unit is none of water in air.
  void Set(const char* name, const char* standardName, const char* unit, double radius);

  // Converts mixing ratios, an array of the air's grid, to contents in kg/m3.
  stratus_status ConvertToContents(vtkStratusAir& air, vtkDataArray* ratios, vtkFloatArray* contents) const;

  // Makes the opacity of the values, or of the contents if the values are mixing ratios, as stratus_cloud_opacity() does. metres: length of
  // a world unit.
  stratus_status MakeFunction(stratus_context* context, double metres, double points[4], double* unitDistance) const;
};

#endif
