// SPDX-License-Identifier: BSD-3-Clause
#include "heights.h"

#include "support.h"

#include <algorithm>
#include <cmath>

namespace cli {

// From the south and a little from the east, so that north is up and east is right, as on a map.
constexpr double earth_azimuth = -70.0, earth_elevation = 35.0;

// On the globe heights are in the coordinates. The camera looks from above the middle of the data, unless they go round.
static void set_globe(options& o, double factor, vtkDataSet* grid)
{
  double bounds[6], middle[3];
  grid->GetBounds(bounds);
  for (int axis = 0; axis < 3; ++axis) {
    middle[axis] = 0.5 * (bounds[2 * axis] + bounds[2 * axis + 1]);
  }
  const double across = std::hypot(middle[0], middle[1]), from_middle = std::hypot(across, middle[2]);
  if (from_middle > 0.1 * (bounds[1] - bounds[0] + bounds[3] - bounds[2] + bounds[5] - bounds[4]) / 3.0) {
    const double degree = std::acos(-1.0) / 180.0;
    o.azimuth = o.has_azimuth ? o.azimuth : std::atan2(middle[1], middle[0]) / degree;
    o.elevation = o.has_elevation ? o.elevation : std::max(-75.0, std::min(75.0, std::atan2(middle[2], across) / degree));
  }
  o.exaggeration = 1.0;
  o.heights = factor == 1.0 ? "" : format("heights x %.4g", factor);
}

void set_heights(options& o, const series* in, vtkDataSet* grid)
{
  o.about = in ? in->about() : data_about();
  if (o.globe && in && grid) {
    set_globe(o, in->height_factor(), grid);
  }
  if (o.globe || !o.about.earth || !grid) {
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
  }
  o.heights = o.exaggeration == 1.0 ? "" : format("heights x %.15g", o.exaggeration);
}
} // namespace cli
