// SPDX-License-Identifier: BSD-3-Clause
#include "heights.h"

#include "support.h"

namespace cli {

// From the south and a little from the east, so that north is up and east is right, as on a map.
constexpr double earth_azimuth = -70.0, earth_elevation = 35.0;

void set_heights(options& o, const series* in, vtkDataSet* grid)
{
  o.about = in ? in->about() : data_about();
  if (!o.about.earth || !grid) {
    return;
  }
  o.azimuth = o.has_azimuth ? o.azimuth : earth_azimuth;
  o.elevation = o.has_elevation ? o.elevation : earth_elevation;
  double bounds[6];
  grid->GetBounds(bounds);
  const double factor = stratus_look_height_factor(bounds, o.up.empty() ? 2 : o.up[0] - 'x');
  // A photograph has true heights, and numbers of rays are of true directions.
  if (!o.has_exaggeration && factor > 1.0 && !o.cloud && o.quantities.empty()) {
    o.exaggeration = factor;
    o.heights = format("heights x %.15g", factor);
  }
}
} // namespace cli
