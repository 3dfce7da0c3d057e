// SPDX-License-Identifier: BSD-3-Clause
#include "cloud.h"

#include "picture.h"
#include "support.h"

#include "vtkStratusMetres.h"

#include <vtkDataSetAttributes.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>

namespace {

// Reads a variable of the air at a step, on the grid of the cloud's water. `grids` keeps it.
vtkDataArray* read_air(
  const std::string& path, cli::reading_options reading, const std::string& variable, size_t step, vtkIdType count, cli::routed& kept)
{
  reading.variable = variable;
  cli::series in(path, reading);
  const vtkSmartPointer<vtkDataObject> shared = in.read(step);
  const auto own = vtkSmartPointer<vtkDataObject>::Take(shared->NewInstance());
  own->ShallowCopy(shared);
  kept = cli::route(own, path, variable);
  bool on_cells = false;
  vtkDataArray* values = cli::choose_array(kept.image ? kept.image : kept.grid, variable, on_cells);
  if (values->GetNumberOfTuples() != count) {
    throw cli::failure("'" + variable + "' in '" + path + "' has " + std::to_string(values->GetNumberOfTuples()) +
      " values, the water has " + std::to_string(count));
  }
  return values;
}
} // namespace

namespace cli {

void set_cloud_look(options& o)
{
  double zenith[3], horizon[3];
  stratus_cloud_light(o.sun_color, zenith, horizon);
  o.cloud = true;
  o.albedo = STRATUS_CLOUD_ALBEDO;
  o.anisotropy = STRATUS_CLOUD_ANISOTROPY;
  o.sky.assign(zenith, zenith + 3);
  o.sky.insert(o.sky.end(), horizon, horizon + 3);
  o.background = format("%.4f:%.4f:%.4f,%.4f:%.4f:%.4f", stratus_screen_level(horizon[0]), stratus_screen_level(horizon[1]),
    stratus_screen_level(horizon[2]), stratus_screen_level(zenith[0]), stratus_screen_level(zenith[1]), stratus_screen_level(zenith[2]));
}

std::string find_cloud_water(const series& in, const options& o)
{
  const std::vector<variable_name> names = in.names();
  std::string list;
  if (!o.array.empty() || names.empty()) {
    return o.array;
  }
  for (const stratus_cloud_phase phase : { STRATUS_CLOUD_WATER, STRATUS_CLOUD_ICE }) {
    for (const variable_name& one : names) {
      if (stratus_cloud_phase_of(one.name.c_str(), one.standard_name.c_str()) == phase) {
        return one.name;
      }
    }
  }
  for (const variable_name& one : names) {
    list += (list.empty() ? "" : ", ") + one.name + (one.units.empty() ? "" : " (" + one.units + ")");
  }
  throw failure("--cloud: no variable of '" + o.source + "' is known as water of clouds; choose one by --variable NAME of: " + list);
}

cloud::cloud(const options& o, const series* in)
    : Source(o.source), Array(o.array), Units(o.water_units), Metres(o.metres), Reading(o.reading()), Up(o.up.empty() ? 2 : o.up[0] - 'x')
{
  std::string standard_name;
  for (const variable_name& one : in ? in->names() : std::vector<variable_name>()) {
    if (one.name == this->Array) {
      this->Units = this->Units.empty() ? one.units : this->Units;
      standard_name = one.standard_name;
    }
  }
  this->Water.Set(this->Array.c_str(), standard_name.c_str(), this->Units.c_str(), o.radius);
  if (this->Water.Measure == STRATUS_CLOUD_UNKNOWN) {
    throw failure("--cloud: '" + (this->Array.empty() ? this->Source : this->Array) + "' has " +
      (this->Units.empty() ? "no unit" : "the unit '" + this->Units + "', which is no water in air") +
      ": give --water-units kg/m3, g/m3, kg/kg or g/kg");
  }
  if (this->Water.Measure == STRATUS_CLOUD_MIXING_RATIO && !in) {
    throw failure("--cloud: the scene '" + this->Source + "' has no density of air: give --water-units kg/m3 or g/m3");
  }
  if (this->Water.Measure == STRATUS_CLOUD_MIXING_RATIO) {
    this->find_air(*in);
  }
}

void cloud::find_air(const series& in)
{
  for (const variable_name& one : in.names()) {
    using known_name = std::pair<const char*, std::string*>;
    const known_name all[] = { { "air_density", &this->Density }, { "air_pressure", &this->Pressure },
      { "air_temperature", &this->Temperature } };
    for (const known_name& known : all) {
      if (one.standard_name == known.first && known.second->empty()) {
        *known.second = one.name;
      }
    }
  }
  if (this->Pressure.empty() || this->Temperature.empty()) {
    this->Pressure.clear();
    this->Temperature.clear();
  }
}

double cloud::metres_of(vtkDataSet* grid) const
{
  const double metres = this->Metres > 0.0 ? this->Metres : vtkStratusMetresPerUnit(grid);
  if (!(metres > 0.0)) {
    throw failure("--cloud: the coordinates of '" + this->Source + "' have no unit of length: give --metres M, the metres of a unit");
  }
  return metres;
}

void cloud::convert(routed& data, size_t step) const
{
  if (this->Water.Measure != STRATUS_CLOUD_MIXING_RATIO) {
    return;
  }
  const context core("host", 1);
  std::vector<vtkSmartPointer<vtkDataSet>*> grids = { data.image ? &data.image : &data.grid };
  for (auto& block : data.blocks) {
    grids.push_back(&block);
  }
  for (vtkSmartPointer<vtkDataSet>* grid : grids) {
    const auto copy = vtkSmartPointer<vtkDataSet>::Take((*grid)->NewInstance());
    copy->ShallowCopy(*grid);
    bool on_cells = false;
    vtkDataArray* const ratios = choose_array(copy, this->Array, on_cells);
    const vtkIdType count = ratios->GetNumberOfTuples();
    vtkStratusAir air(core, copy, on_cells, this->Up, this->metres_of(copy));
    routed of_density, of_pressure, of_temperature;
    if (!this->Density.empty()) {
      air.Density = read_air(this->Source, this->Reading, this->Density, step, count, of_density);
    } else if (!this->Pressure.empty()) {
      air.Pressure = read_air(this->Source, this->Reading, this->Pressure, step, count, of_pressure);
      air.Temperature = read_air(this->Source, this->Reading, this->Temperature, step, count, of_temperature);
    }
    vtkNew<vtkFloatArray> contents;
    core.check(this->Water.ConvertToContents(air, ratios, contents), "--cloud");
    contents->SetName(ratios->GetName());
    vtkDataSetAttributes* const attributes = copy->GetAttributes(on_cells ? vtkDataObject::CELL : vtkDataObject::POINT);
    attributes->AddArray(contents); // in place of the ratios, which have its name
    attributes->SetActiveScalars(contents->GetName());
    *grid = copy;
  }
}

void cloud::set_function(options& o, vtkDataSet* grid) const
{
  const context core("host", 1);
  double points[4];
  core.check(this->Water.MakeFunction(core, this->metres_of(grid), points, &o.unit_distance), "--cloud");
  o.opacity = format("%.17g:%.17g,%.17g:%.17g", points[0], points[1], points[2], points[3]);
  o.color = o.color.empty() ? "0:1:1:1" : o.color;
}

void cloud::print_rows() const
{
  double extinction = 0.0;
  const context core("host", 1);
  core.check(stratus_cloud_extinction(core, 1e-3, this->Water.Radius, this->Water.ParticleDensity, &extinction), "--cloud");
  row("water",
    "in " + this->Units +
      format(", of %s with an effective radius of %g um: extinction %.3g/m for 1 g/m3",
        this->Water.ParticleDensity == STRATUS_ICE_DENSITY ? "ice" : "droplets", this->Water.Radius * 1e6, extinction));
  if (this->Water.Measure == STRATUS_CLOUD_MIXING_RATIO) {
    row("air",
      !this->Density.empty()      ? "density '" + this->Density + "'"
        : !this->Pressure.empty() ? "density of dry air by '" + this->Pressure + "' and '" + this->Temperature + "'"
                                  : std::string("density of the standard atmosphere at the file's heights"));
  }
}
} // namespace cli
