// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusCloudWater.h"

#include "vtkDataSet.h"
#include "vtkFloatArray.h"
#include "vtkInformation.h"

#include <cmath>

vtkStratusAir::vtkStratusAir(stratus_context* context, vtkDataSet* grid, bool onCells, int up, double metres)
    : Context(context), Grid(grid), OnCells(onCells), Up(up), Metres(metres), Height(std::nan(""))
{
}

stratus_status vtkStratusAir::Find(vtkIdType value, double* density)
{
  if (this->Density) {
    *density = this->Density->GetComponent(value, 0);
    return STRATUS_OK;
  }
  if (this->Pressure && this->Temperature) {
    return stratus_air_density(this->Context, this->Pressure->GetComponent(value, 0), this->Temperature->GetComponent(value, 0), density);
  }
  const double height = this->HeightOf(value);
  if (height != this->Height) { // neighbours along a level share it
    double pressure = 0.0, temperature = 0.0;
    stratus_status status = stratus_air_standard(this->Context, height, &pressure, &temperature);
    status = status == STRATUS_OK ? stratus_air_density(this->Context, pressure, temperature, &this->Standard) : status;
    if (status != STRATUS_OK) {
      return status;
    }
    this->Height = height;
  }
  *density = this->Standard;
  return STRATUS_OK;
}

double vtkStratusAir::HeightOf(vtkIdType value) const
{
  double place[6];
  if (this->OnCells) {
    this->Grid->GetCellBounds(value, place);
    return 0.5 * (place[2 * this->Up] + place[2 * this->Up + 1]) * this->Metres;
  }
  this->Grid->GetPoint(value, place);
  return place[this->Up] * this->Metres;
}

void vtkStratusCloudWater::Set(const char* name, const char* standardName, const char* unit, double radius)
{
  const bool ice = stratus_cloud_phase_of(name, standardName) == STRATUS_CLOUD_ICE;
  this->Radius = radius > 0.0 ? radius : ice ? STRATUS_ICE_RADIUS : STRATUS_WATER_RADIUS;
  this->ParticleDensity = ice ? STRATUS_ICE_DENSITY : STRATUS_WATER_DENSITY;
  this->Factor = 1.0;
  this->Measure = stratus_cloud_unit(unit, &this->Factor);
}

stratus_status vtkStratusCloudWater::ConvertToContents(vtkStratusAir& air, vtkDataArray* ratios, vtkFloatArray* contents) const
{
  const vtkIdType count = ratios->GetNumberOfTuples();
  contents->SetNumberOfValues(count);
  contents->GetInformation()->Set(vtkDataArray::UNITS_LABEL(), "kg m-3");
  for (vtkIdType i = 0; i < count; ++i) {
    const double ratio = ratios->GetComponent(i, 0);
    double density = 1.0;
    if (std::fabs(ratio) > 0.0) { // otherwise dry or missing, and its air may be missing as well
      const stratus_status status = air.Find(i, &density);
      if (status != STRATUS_OK) {
        return status;
      }
    }
    contents->SetValue(i, static_cast<float>(ratio * this->Factor * density));
  }
  return STRATUS_OK;
}

stratus_status vtkStratusCloudWater::MakeFunction(stratus_context* context, double metres, double points[4], double* unitDistance) const
{
  const double factor = this->Measure == STRATUS_CLOUD_MIXING_RATIO ? 1.0 : this->Factor;
  double extinction = 0.0;
  const stratus_status status = stratus_cloud_extinction(context, factor, this->Radius, this->ParticleDensity, &extinction);
  return status == STRATUS_OK
    ? stratus_cloud_opacity(context, extinction * metres, STRATUS_CLOUD_MOST_CONTENT / factor, points, unitDistance)
    : status;
}
