// SPDX-License-Identifier: BSD-3-Clause
#include "paths.h"

#include "casting.h"

#include <algorithm>
#include <cmath>

namespace cli {

// Samples a pixel where neither their number nor a tolerance is given, and where only a tolerance ends them.
constexpr int usual_samples = 256, most_samples = 1000000000;

stratus_path_options paths_of(const options& o, const stratus_ray_cast_options& parts, int up)
{
  stratus_path_options paths = stratus_path_options_default();
  paths.samples = o.samples > 0 ? o.samples : o.has_tolerance ? most_samples : usual_samples;
  paths.tolerance = o.has_tolerance ? o.tolerance : 0.0;
  paths.seed = static_cast<uint64_t>(o.seed);
  paths.bounces = o.bounces;
  paths.albedo = o.albedo;
  paths.anisotropy = o.anisotropy;
  const int suns = set_suns(o, up, paths.lights);
  paths.light_count = suns == 0 && o.sky.empty() ? -1 : suns;
  set_sky(o, up, paths.sky_zenith, paths.sky_horizon, paths.up);
  paths.interpolation = o.nearest ? STRATUS_INTERPOLATION_NEAREST : STRATUS_INTERPOLATION_LINEAR;
  paths.clipping = parts.clipping;
  paths.mask = parts.mask;
  return paths;
}

void print_paths(const options& o, const context& core, const transfer& functions, const stratus_path_report& r)
{
  row("opacity", functions.origin);
  row("device", stratus_context_device(core));
  row("mode", "path");
  row("error",
    std::isnan(r.standard_error) ? "not known from 1 sample a pixel"
                                 : format("%.2g standard error, %.2g at most", r.standard_error, r.largest_error) +
        (o.has_tolerance ? format(", tolerance %g%s", o.tolerance, r.standard_error <= o.tolerance ? "" : ", which needs more samples")
                         : ""));
  row("frame", format("%.2f s for %d x %d pixels", r.seconds, o.width, o.height));
  row("paths", grouped(r.samples) + " a pixel, " + grouped(r.vertices) + " scatterings, " + grouped(r.lookups) + " values interpolated");
}
} // namespace cli
