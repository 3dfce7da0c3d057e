// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusPanelLight.h"

#include "vtkStratusCloudWater.h"
#include "vtkStratusContext.h"
#include "vtkStratusMetres.h"
#include "vtkStratusRanks.h"
#include "vtkStratusTetrahedraMapper.h"
#include "vtkStratusVolumeMapper.h"

#include "vtkColorTransferFunction.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkDataSetAttributes.h"
#include "vtkFloatArray.h"
#include "vtkInformation.h"
#include "vtkLight.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPVDataRepresentation.h"
#include "vtkPiecewiseFunction.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <tuple>
#include <vector>

vtkStandardNewMacro(vtkStratusPanelLight);

class vtkStratusPanelLight::Internals
{
public:
  Internals() : Context([](double) { return false; })
  {
    this->White->AddRGBPoint(0.0, 1.0, 1.0, 1.0);
    this->Property->SetScalarOpacity(this->Opacity);
    this->Property->SetColor(this->White);
    this->Property->ShadeOn();
    this->Property->SetAmbient(0.0);
    this->Property->SetSpecular(0.0);
    this->Property->SetDiffuse(STRATUS_CLOUD_ALBEDO);
  }

  // Takes a status of the core. Returns whether it is STRATUS_OK; otherwise Problem has the reason.
  bool Check(stratus_status status)
  {
    if (status != STRATUS_OK) {
      this->Problem = std::string("no cloud is drawn: ") + stratus_context_message(this->Context.Get());
    }
    return status == STRATUS_OK;
  }
  bool HasContext() { return this->Context.Get() || this->Context.Create("host", 1, this->Problem); }

  vtkStratusContext Context;
  vtkNew<vtkVolumeProperty> Property;
  vtkNew<vtkPiecewiseFunction> Opacity;
  vtkNew<vtkColorTransferFunction> White;
  vtkNew<vtkLight> Sun;
  std::string Problem, Reported, Used;
  vtkPVDataRepresentation* User = nullptr;

  // Of the array that was taken last.
  std::string Array, Water, Units; // Water: the array of its contents, which may be Array
  double Metres = 1.0;
  int Components = 0;      // 0: the data lack the array
  std::string Unconverted; // why mixing ratios could not be converted
  std::tuple<bool, std::string, double, int> TakenFor{ false, "", 0.0, -1 };
};

vtkStratusPanelLight::vtkStratusPanelLight() : Internal(new Internals) {}

vtkStratusPanelLight::~vtkStratusPanelLight() = default;

void vtkStratusPanelLight::SetWaterUnits(const char* unit)
{
  this->WaterUnits = unit ? unit : "";
  this->Modified();
}

void vtkStratusPanelLight::SetSunTime(const char* time)
{
  this->SunTime = time ? time : "";
  this->Modified();
}

bool vtkStratusPanelLight::IsLeftOut() const
{
  return (this->Shadows || this->VolumetricScatteringBlending > 0.0) && stratus::count_ranks() > 1;
}

std::string vtkStratusPanelLight::TakeProblem()
{
  const bool news = this->Internal->Problem != this->Internal->Reported;
  this->Internal->Reported = this->Internal->Problem;
  return news && stratus::get_rank() == 0 ? this->Internal->Problem : "";
}

void vtkStratusPanelLight::SetUser(vtkPVDataRepresentation* user)
{
  this->Internal->User = user;
}

void vtkStratusPanelLight::Modified()
{
  this->Superclass::Modified();
  if (this->Internal->User && this->NeedsWater()) {
    this->Internal->User->MarkModified();
  }
}

const char* vtkStratusPanelLight::GetCloudUsed()
{
  return !this->Cloud ? "" : this->Internal->Problem.empty() ? this->Internal->Used.c_str() : this->Internal->Problem.c_str();
}

namespace {
std::vector<vtkDataSet*> grids_of(vtkDataObject* data)
{
  if (auto* grid = vtkDataSet::SafeDownCast(data)) {
    return { grid };
  }
  auto* blocks = vtkCompositeDataSet::SafeDownCast(data);
  return blocks ? vtkCompositeDataSet::GetDataSets(blocks) : std::vector<vtkDataSet*>();
}

vtkDataArray* array_of(vtkDataSet* grid, const char* name, bool on_cells)
{
  return name ? grid->GetAttributes(on_cells ? vtkDataObject::CELL : vtkDataObject::POINT)->GetArray(name) : nullptr;
}

// Returns the axis that a direction points along, 0, 1 or 2; -1 if none.
int axis_of(const double direction[3])
{
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] > 0.0 && direction[(axis + 1) % 3] == 0.0 && direction[(axis + 2) % 3] == 0.0) {
      return axis;
    }
  }
  return -1;
}
} // namespace

bool vtkStratusPanelLight::NeedsWater() const
{
  return this->Cloud && this->Internal->TakenFor != std::make_tuple(true, this->WaterUnits, this->MetresPerUnit, axis_of(this->SkyUp));
}

void vtkStratusPanelLight::TakeWater(vtkDataObject* data, vtkInformation* shown)
{
  Internals& in = *this->Internal;
  const char* array = shown && shown->Has(vtkDataObject::FIELD_NAME()) ? shown->Get(vtkDataObject::FIELD_NAME()) : nullptr;
  const bool on_cells = shown && shown->Has(vtkDataObject::FIELD_ASSOCIATION()) &&
    shown->Get(vtkDataObject::FIELD_ASSOCIATION()) == vtkDataObject::FIELD_ASSOCIATION_CELLS;
  const int up = axis_of(this->SkyUp);
  in.TakenFor = std::make_tuple(this->Cloud, this->WaterUnits, this->MetresPerUnit, up);
  in.Array = in.Water = array ? array : "";
  in.Units = this->WaterUnits;
  in.Metres = this->MetresPerUnit;
  in.Components = 0;
  in.Unconverted.clear();
  if (!this->Cloud || !in.HasContext()) {
    return;
  }
  const std::vector<vtkDataSet*> grids = grids_of(data);
  for (vtkDataSet* grid : grids) {
    vtkDataArray* values = array_of(grid, array, on_cells);
    in.Components = values ? std::max(in.Components, values->GetNumberOfComponents()) : in.Components;
    const char* label = values ? values->GetInformation()->Get(vtkDataArray::UNITS_LABEL()) : nullptr;
    in.Units = in.Units == "auto" && label ? label : in.Units;
    in.Metres = in.Metres > 0.0 ? in.Metres : vtkStratusMetresPerUnit(grid);
  }
  in.Units = in.Units == "auto" ? "kg/m3" : in.Units;
  in.Metres = in.Metres > 0.0 ? in.Metres : vtkStratusMetresPerUnit(data);
  in.Metres = in.Metres > 0.0 ? in.Metres : 1.0;
  vtkStratusCloudWater water;
  water.Set(array, nullptr, in.Units.c_str(), 0.0);
  if (in.Components != 1 || water.Measure != STRATUS_CLOUD_MIXING_RATIO || up < 0) {
    return;
  }
  in.Water = in.Array + "_in_kg_m-3";
  for (vtkDataSet* grid : grids) {
    vtkDataArray* values = array_of(grid, array, on_cells);
    vtkStratusAir air(in.Context.Get(), grid, on_cells, up, in.Metres);
    vtkNew<vtkFloatArray> contents;
    if (values && in.Check(water.ConvertToContents(air, values, contents))) {
      contents->SetName(in.Water.c_str());
      grid->GetAttributes(on_cells ? vtkDataObject::CELL : vtkDataObject::POINT)->AddArray(contents);
    } else if (values) {
      in.Unconverted = in.Problem;
    }
  }
}

const std::string& vtkStratusPanelLight::GetWater() const
{
  return this->Internal->Water;
}

namespace {
std::string format(const char* pattern, double first, double second)
{
  char text[128];
  std::snprintf(text, sizeof text, pattern, first, second);
  return text;
}
} // namespace

// Sets function and sun of the cloud. Returns false, with the reason in Problem, if there is none.
bool vtkStratusPanelLight::UpdateCloud(vtkVolumeProperty* own)
{
  Internals& in = *this->Internal;
  in.Problem = in.Unconverted;
  if (!this->Cloud || in.Components == 0 || !in.Problem.empty() || !in.HasContext()) {
    return false;
  }
  const int up = axis_of(this->SkyUp);
  vtkStratusCloudWater water;
  water.Set(in.Array.c_str(), nullptr, in.Units.c_str(), 1e-6 * this->EffectiveRadius);
  if (stratus::count_ranks() > 1) {
    in.Problem = "no cloud is drawn: several ranks draw without shadows and scattered light";
  } else if (in.Components > 1) {
    in.Problem = "no cloud is drawn: '" + in.Array + "' has " + std::to_string(in.Components) + " components, water has 1";
  } else if (up < 0) {
    in.Problem = "no cloud is drawn: the direction upwards must be 1 0 0, 0 1 0 or 0 0 1";
  } else if (water.Measure == STRATUS_CLOUD_UNKNOWN) {
    in.Problem =
      "no cloud is drawn: the unit '" + in.Units + "' of '" + in.Array + "' is none of water in air, such as kg/m3, g/m3, kg/kg or g/kg";
  }
  double points[4], distance = 1.0, extinction = 0.0, seconds = 0.0, place[2] = { this->SunPosition[0], this->SunPosition[1] },
                    direction[3];
  stratus_context* context = in.Context.Get();
  if (!in.Problem.empty() || !in.Check(water.MakeFunction(context, in.Metres, points, &distance)) ||
    !in.Check(stratus_cloud_extinction(context, 1e-3, water.Radius, water.ParticleDensity, &extinction)) ||
    (!this->SunTime.empty() &&
      (!in.Check(stratus_time_parse(context, this->SunTime.c_str(), &seconds)) ||
        !in.Check(stratus_sun_position(context, seconds, this->SunPlace[0], this->SunPlace[1], &place[0], &place[1])))) ||
    !in.Check(stratus_sun_direction(context, place[0], place[1], up, direction))) {
    return false;
  }
  const std::string sun = format("sun at azimuth %.1f, elevation %.1f degrees", place[0], place[1]);
  if (!this->SunTime.empty() && place[1] <= 0.0) {
    in.Problem = "no cloud is drawn: the sun is below the horizon: " + sun;
    return false;
  }
  in.Used = "water in " + in.Units + (water.ParticleDensity == STRATUS_ICE_DENSITY ? ", ice" : ", droplets") +
    format(" with an effective radius of %g um: extinction %.3g/m for 1 g/m3; ", 1e6 * water.Radius, extinction) + sun;
  double* at = in.Opacity->GetDataPointer();
  if (in.Opacity->GetSize() != 2 || at[1] != points[1] || at[2] != points[2] || at[3] != points[3]) {
    in.Opacity->RemoveAllPoints();
    in.Opacity->AddPoint(points[0], points[1]);
    in.Opacity->AddPoint(points[2], points[3]);
  }
  double color[3], zenith[3], horizon[3];
  stratus_cloud_light(color, zenith, horizon);
  in.Sun->SetPosition(direction);
  in.Sun->SetDiffuseColor(color);
  in.Property->SetInterpolationType(own->GetInterpolationType());
  in.Property->SetScalarOpacityUnitDistance(distance);
  return true;
}

template <class Mapper> vtkVolumeProperty* vtkStratusPanelLight::ApplyTo(Mapper* mapper, int mode, vtkVolumeProperty* own)
{
  const bool whole = stratus::count_ranks() == 1;
  const bool cloud = mode == vtkVolumeMapper::COMPOSITE_BLEND && this->UpdateCloud(own);
  double zenith[3], horizon[3];
  std::copy_n(this->SkyZenith, 3, zenith);
  std::copy_n(this->SkyHorizon, 3, horizon);
  if (cloud) {
    stratus_cloud_light(nullptr, zenith, horizon);
  }
  mapper->SetShadows(whole && this->Shadows);
  mapper->SetVolumetricScatteringBlending(cloud ? 2.0 : whole ? this->VolumetricScatteringBlending : 0.0); // which has shadows
  mapper->SetScatteringAnisotropy(cloud ? STRATUS_CLOUD_ANISOTROPY : this->ScatteringAnisotropy);
  mapper->SetGlobalIlluminationReach(cloud ? 1.0 : this->GlobalIlluminationReach);
  mapper->SetMultipleScattering(cloud || this->MultipleScattering);
  mapper->SetSkyZenith(zenith);
  mapper->SetSkyHorizon(horizon);
  mapper->SetSkyUp(this->SkyUp);
  mapper->SetSun(cloud ? this->Internal->Sun.Get() : nullptr);
  mapper->SetScreenEncoding(cloud);
  return cloud ? this->Internal->Property.Get() : own;
}

vtkVolumeProperty* vtkStratusPanelLight::Apply(vtkStratusVolumeMapper* mapper, int mode, vtkVolumeProperty* own)
{
  return this->ApplyTo(mapper, mode, own);
}

vtkVolumeProperty* vtkStratusPanelLight::Apply(vtkStratusTetrahedraMapper* mapper, int mode, vtkVolumeProperty* own)
{
  return this->ApplyTo(mapper, mode, own);
}

void vtkStratusPanelLight::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Shadows: " << this->Shadows << "\n";
  os << indent << "VolumetricScatteringBlending: " << this->VolumetricScatteringBlending << "\n";
  os << indent << "ScatteringAnisotropy: " << this->ScatteringAnisotropy << "\n";
  os << indent << "GlobalIlluminationReach: " << this->GlobalIlluminationReach << "\n";
  os << indent << "MultipleScattering: " << this->MultipleScattering << "\n";
  os << indent << "SkyZenith: " << this->SkyZenith[0] << " " << this->SkyZenith[1] << " " << this->SkyZenith[2] << "\n";
  os << indent << "SkyHorizon: " << this->SkyHorizon[0] << " " << this->SkyHorizon[1] << " " << this->SkyHorizon[2] << "\n";
  os << indent << "SkyUp: " << this->SkyUp[0] << " " << this->SkyUp[1] << " " << this->SkyUp[2] << "\n";
  os << indent << "Cloud: " << this->Cloud << "\n";
  os << indent << "WaterUnits: " << this->WaterUnits << "\n";
  os << indent << "EffectiveRadius: " << this->EffectiveRadius << "\n";
  os << indent << "MetresPerUnit: " << this->MetresPerUnit << "\n";
  os << indent << "SunPosition: " << this->SunPosition[0] << " " << this->SunPosition[1] << "\n";
  os << indent << "SunTime: " << this->SunTime << "\n";
  os << indent << "SunPlace: " << this->SunPlace[0] << " " << this->SunPlace[1] << "\n";
}
