// SPDX-License-Identifier: BSD-3-Clause
#include "casting.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace cli {

void set_planes(options& o, const options& given)
{
  o.crop = given.crop;
  o.slice = given.slice;
  for (size_t a = 0; a < 3 && !o.globe; ++a) {
    const double scale = o.about.axes[a].scale; // the file's numbers in a unit of the grid's
    if (!o.crop.empty()) {
      double* const planes = &o.crop[2 * a];
      planes[0] /= scale;
      planes[1] /= scale;
      if (scale < 0.0) { // such as depths
        std::swap(planes[0], planes[1]);
      }
    }
    if (!o.slice.empty()) {
      o.slice[a] /= scale;
      o.slice[3 + a] *= scale;
    }
  }
}

stratus_slice slice_of(const options& o, int up)
{
  stratus_slice slice = {};
  for (size_t a = 0; a < 3 && !o.slice.empty(); ++a) {
    const double scale = static_cast<int>(a) == up ? o.exaggeration : 1.0;
    slice.center[a] = o.slice[a] * scale;
    slice.linear[a] = o.slice[3 + a] / scale;
  }
  return slice;
}

int set_suns(const options& o, int up, stratus_light lights[STRATUS_LIGHTS_MAX])
{
  std::vector<std::vector<double>> suns = o.suns;
  if (!o.sun_at.empty()) {
    suns.emplace_back(3);
    const context core("host", 1);
    core.check(stratus_sun_direction(core, o.sun_at[0], o.sun_at[1], up, suns.back().data()), "--sun-at");
    suns.back().insert(suns.back().end(), o.sun_at.begin() + 2, o.sun_at.end());
  }
  for (size_t i = 0; i < suns.size(); ++i) {
    std::copy_n(suns[i].begin(), 3, lights[i].vector);
    std::copy_n(o.sun_color, 3, lights[i].color);
    std::copy(suns[i].begin() + 3, suns[i].end(), lights[i].color);
  }
  return static_cast<int>(suns.size());
}

void set_sky(const options& o, int up, double zenith[3], double horizon[3], double upwards[3])
{
  if (!o.sky.empty()) {
    std::copy_n(o.sky.begin(), 3, zenith);
    std::copy_n(o.sky.end() - 3, 3, horizon);
  }
  for (int axis = 0; axis < 3; ++axis) {
    upwards[axis] = axis == up ? 1.0 : 0.0;
  }
}

void set_light(const options& o, int up, int& shade, stratus_shading& shading)
{
  shade = o.shade || o.scatter;
  shading.shadows = o.shadows || o.scatter;
  const int suns = set_suns(o, up, shading.lights);
  shading.light_count = suns > 0 || !o.sky.empty() ? suns : shading.light_count;
  if (o.scatter) {
    shading.ambient = shading.specular = 0.0;
    shading.diffuse = o.albedo;
    shading.scattering = 1.0;
    shading.anisotropy = o.anisotropy;
    shading.multiple = o.multiple;
    set_sky(o, up, shading.sky_zenith, shading.sky_horizon, shading.up);
  }
}

stratus_ray_cast_options casting_of(const options& o, int up)
{
  stratus_ray_cast_options cast = stratus_ray_cast_options_default();
  cast.mode = o.mode;
  cast.light.normals = o.normals;
  std::copy(o.average.begin(), o.average.end(), cast.optics.average_range);
  cast.optics.contour_count = static_cast<int>(o.contours.size());
  std::copy(o.contours.begin(), o.contours.end(), cast.optics.contours);
  cast.slice = slice_of(o, up);
  cast.sampling.jitter = o.jitter < 0 ? 0 : 1;
  cast.sampling.jitter_seed = static_cast<uint32_t>(std::max(0, o.jitter));
  cast.skipping.structure = o.structure;
  cast.sampling.rule = o.sampling;
  cast.sampling.interpolation = o.nearest ? STRATUS_INTERPOLATION_NEAREST : STRATUS_INTERPOLATION_LINEAR;
  cast.sampling.distance = o.sample_distance;
  cast.sampling.cell_error = o.cell_error;
  cast.sampling.tolerance = o.tolerance;
  set_light(o, up, cast.light.shade, cast.light.shading);
  cast.skipping.audit = o.audit;
  return cast;
}

void volume_parts::set(const options& o, context& core, const stratus_volume& volume, stratus_ray_cast_options& cast)
{
  cast.clipping.crop = o.crop.empty() ? 0 : 1;
  std::copy(o.crop.begin(), o.crop.end(), cast.clipping.crop_bounds);
  cast.clipping.crop_regions = static_cast<uint32_t>(o.crop_regions);
  if (o.mask.empty()) {
    return;
  }
  if (!this->Mask) {
    this->Mask = std::make_unique<input>(core, o.mask, reading_options{ "", o.mask_raw, "" });
  }
  const stratus_volume& bytes = this->Mask->volume;
  if (bytes.type != STRATUS_UINT8 || !std::equal(bytes.dimensions, bytes.dimensions + 3, volume.dimensions)) {
    throw failure("mask '" + o.mask + "' has " + describe(bytes) + ", one uint8 for each value of " + describe(volume) + " is needed");
  }
  cast.mask.bytes = static_cast<const uint8_t*>(bytes.values);
}

void print_cast(const options& o, const context& core, const transfer& functions, const stratus_ray_cast_report& r)
{
  const double build = r.range_ms + r.table_ms + r.occupancy_ms + r.structure_ms + r.probe_ms + r.upload_ms;
  const double segments = static_cast<double>(r.samples) + static_cast<double>(r.skipped);
  row("opacity", functions.origin);
  row("device", stratus_context_device(core));
  row("structure", format("%s (%s KiB)", stratus_structure_name(r.structure), grouped((r.structure_bytes + 1023) / 1024).c_str()));
  row("mode", stratus_mode_name(o.mode));
  if (o.mode != STRATUS_MODE_FIRST_HIT && o.mode != STRATUS_MODE_ISOSURFACE && o.mode != STRATUS_MODE_SLICE) {
    row("sampling",
      stratus_sampling_name(r.sampling) +
        (r.sampling == STRATUS_SAMPLING_CELLS ? std::string() : format(", every %.4g", r.sample_distance)));
  }
  row("why", r.why);
  if (!std::isnan(r.expected_error)) {
    row("error",
      format("%.2g expected, tolerance %g%s", r.expected_error, o.tolerance,
        r.tolerance_met ? "" : ", which the finest setting is expected to miss"));
    row("probe", format("%.2f ms, ", r.probe_ms) + grouped(r.probe_samples) + " samples");
  }
  row("build",
    format("%.2f ms: ranges %.2f, tables %.2f, occupancy %.2f, structure %.2f, probe %.2f, upload %.2f", build, r.range_ms, r.table_ms,
      r.occupancy_ms, r.structure_ms, r.probe_ms, r.upload_ms));
  row("frame", format("%.2f ms for %d x %d pixels, %s rays in the volume", r.cast_ms, o.width, o.height, grouped(r.rays).c_str()));
  row("blocks", grouped(r.occupied_blocks) + " of " + grouped(r.blocks) + " occupied");
  if (o.mode == STRATUS_MODE_FIRST_HIT) {
    row("hits", grouped(r.samples) + ", " + grouped(r.lookups) + " nodes and steps visited");
  } else {
    row("samples",
      grouped(r.samples) + " taken, " + grouped(r.skipped) + " skipped" +
        (segments > 0.0 ? format(" (%.1f %%)", 100.0 * static_cast<double>(r.skipped) / segments) : ""));
  }
  if (o.audit) {
    row("audit", grouped(r.differing_pixels) + " pixels differ from the march without skipping");
  }
}

void judge_cast(const options& o, const stratus_ray_cast_report& r)
{
  if (o.audit && r.differing_pixels > 0) {
    throw failure("audit: skipping changed " + grouped(r.differing_pixels) + " pixels");
  }
}
} // namespace cli
