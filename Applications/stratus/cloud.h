// SPDX-License-Identifier: BSD-3-Clause
// Clouds in physical units (--cloud): from the water of a model's output to transfer function, light and background.
#pragma once

#include "options.h"
#include "route.h"
#include "series.h"

#include "vtkStratusCloudWater.h"

#include <string>

namespace cli {

// Sets light, sky and background of --cloud, which other options may replace.
void set_cloud_look(options& o);

// Returns the variable of cloud water: o.array, or the first that is liquid, or the first that is ice, by name or standard name. "": the
// file is not read by variables. Throws failure, which lists the variables, if there is none.
std::string find_cloud_water(const series& in, const options& o);

// A file's or a scene's values as the water of clouds.
class cloud
{
public:
  // `in` is null for a scene. The series' variable is the one that find_cloud_water() returns.
  cloud(const options& o, const series* in);
  // Replaces mixing ratios of a step by water contents, in copies of the grids.
  void convert(routed& data, size_t step) const;
  // Sets the transfer function for the grid of converted data, null for a scene. Throws failure if a unit is not known.
  void set_function(options& o, vtkDataSet* grid) const;
  void print_rows() const;

private:
  double metres_of(vtkDataSet* grid) const;
  void find_air(const series& in);

  std::string Source, Array, Units; // Units: of the values
  double Metres;                    // as given, 0: by the data
  vtkStratusCloudWater Water;
  reading_options Reading;
  std::string Density, Pressure, Temperature; // the file's variables of air, "": none
  int Up;
};
} // namespace cli
