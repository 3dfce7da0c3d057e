// SPDX-License-Identifier: BSD-3-Clause
// Scattered light by random paths: each picture of an unchanged scene continues the last one.
#include "vtkStratusVolumeMapperInternals.h"

#include <algorithm>
#include <cmath>

namespace {
stratus_path_options PathsOf(const stratus_ray_cast_options& options, bool multiple)
{
  const stratus_shading& shading = options.light.shading;
  stratus_path_options paths = stratus_path_options_default();
  paths.seed = options.sampling.jitter_seed;
  paths.bounces = multiple ? 0 : 1;
  paths.albedo = std::min(shading.diffuse, 1.0);
  paths.anisotropy = shading.anisotropy;
  paths.light_count = shading.light_count;
  std::copy_n(shading.lights, STRATUS_LIGHTS_MAX, paths.lights);
  for (int a = 0; a < 3; ++a) {
    paths.sky_zenith[a] = multiple ? shading.sky_zenith[a] : 0.0;
    paths.sky_horizon[a] = multiple ? shading.sky_horizon[a] : 0.0;
    paths.up[a] = shading.up[a];
  }
  paths.interpolation = options.sampling.interpolation;
  paths.clipping = options.clipping;
  paths.mask = options.mask;
  return paths;
}
} // namespace

stratus_status vtkStratusVolumeMapper::Internals::CastPaths(const stratus_ray_cast_options& options, const stratus_image& image)
{
  stratus_path_options paths = PathsOf(options, this->Mapper->MultipleScattering != 0);
  stratus_status status = this->Tracer ? STRATUS_OK : stratus_path_tracer_create(this->Context.Get(), &this->Tracer);
  double seconds = 0.0;
  this->Report = stratus_ray_cast_report();
  this->Report.window[1] = image.width;
  this->Report.window[3] = image.height;
  paths.tolerance = this->Mapper->PathTolerance;
  paths.samples = 1;
  for (bool more = true; more && status == STRATUS_OK;) {
    const stratus_path_report before = this->PathReport;
    status = stratus_path_tracer_render(
      this->Tracer, &this->Image.GetVolume(), this->Functions.data(), &this->Picture.Camera, &paths, &image, &this->PathReport);
    if (status != STRATUS_OK) {
      break;
    }
    const double took = this->PathReport.seconds - (this->PathReport.restarted ? 0.0 : before.seconds);
    seconds += took;
    // As many again as there are, but no more than there is time for. The error of one path is not known.
    const double fit = std::floor((this->Mapper->PathSeconds - seconds) * paths.samples / std::max(took, 1e-9));
    more = this->PathReport.samples < 2 || (!this->Mapper->GetPathFinished() && fit >= 1.0);
    paths.samples = static_cast<int>(std::max(1.0, std::min({ fit, static_cast<double>(this->PathReport.samples), 1e9 })));
  }
  this->Report.cast_ms = 1e3 * seconds;
  this->Report.expected_error = status == STRATUS_OK ? this->PathReport.standard_error : std::nan("");
  this->Report.tolerance_met = status == STRATUS_OK && this->Mapper->GetPathFinished() ? 1 : 0;
  return status;
}

double vtkStratusVolumeMapper::GetPathError()
{
  return this->GetPathSamples() > 1 ? this->Internal->PathReport.standard_error : std::nan("");
}

vtkTypeUInt64 vtkStratusVolumeMapper::GetPathSamples()
{
  return this->Internal->PathReport.samples;
}

bool vtkStratusVolumeMapper::GetPathFinished()
{
  return this->GetPathError() <= this->PathTolerance;
}
