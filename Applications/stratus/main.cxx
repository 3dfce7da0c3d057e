// SPDX-License-Identifier: BSD-3-Clause
// The command line draws a volume to a picture file. `stratus --help` describes it.
#include "camera.h"
#include "frame.h"
#include "grid.h"
#include "input.h"
#include "mesh.h"
#include "options.h"
#include "output.h"
#include "picture.h"
#include "reading.h"
#include "sort.h"
#include "transfer.h"
#include "tree.h"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkLogger.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <sys/resource.h>

namespace {

using cli::row;

void print_report(const cli::context& core, const cli::options& o, const stratus_ray_cast_report& r, const std::string& opacity)
{
  const double build = r.range_ms + r.table_ms + r.occupancy_ms + r.structure_ms + r.probe_ms + r.upload_ms;
  const double segments = static_cast<double>(r.samples) + static_cast<double>(r.skipped);
  row("opacity", opacity);
  row("device", stratus_context_device(core));
  row(
    "structure", cli::format("%s (%s KiB)", stratus_structure_name(r.structure), cli::grouped((r.structure_bytes + 1023) / 1024).c_str()));
  row("mode", stratus_mode_name(o.mode));
  if (o.mode != STRATUS_MODE_FIRST_HIT && o.mode != STRATUS_MODE_ISOSURFACE) {
    row("sampling",
      stratus_sampling_name(r.sampling) +
        (r.sampling == STRATUS_SAMPLING_CELLS ? std::string() : cli::format(", every %.4g", r.sample_distance)));
  }
  row("why", r.why);
  if (!std::isnan(r.expected_error)) {
    row("error",
      cli::format("%.2g expected, tolerance %g%s", r.expected_error, o.tolerance,
        r.tolerance_met ? "" : ", which the finest setting is expected to miss"));
    row("probe", cli::format("%.2f ms, ", r.probe_ms) + cli::grouped(r.probe_samples) + " samples");
  }
  row("build",
    cli::format("%.2f ms: ranges %.2f, tables %.2f, occupancy %.2f, structure %.2f, probe %.2f, upload %.2f", build, r.range_ms, r.table_ms,
      r.occupancy_ms, r.structure_ms, r.probe_ms, r.upload_ms));
  row(
    "frame", cli::format("%.2f ms for %d x %d pixels, %s rays in the volume", r.cast_ms, o.width, o.height, cli::grouped(r.rays).c_str()));
  row("blocks", cli::grouped(r.occupied_blocks) + " of " + cli::grouped(r.blocks) + " occupied");
  if (o.mode == STRATUS_MODE_FIRST_HIT) {
    row("hits", cli::grouped(r.samples) + ", " + cli::grouped(r.lookups) + " nodes and steps visited");
  } else {
    row("samples",
      cli::grouped(r.samples) + " taken, " + cli::grouped(r.skipped) + " skipped" +
        (segments > 0.0 ? cli::format(" (%.1f %%)", 100.0 * static_cast<double>(r.skipped) / segments) : ""));
  }
  if (o.audit) {
    row("audit", cli::grouped(r.differing_pixels) + " pixels differ from the march without skipping");
  }
}

// Sets the crop and the mask. The result owns the mask's bytes.
std::unique_ptr<cli::input> choose_parts(
  cli::context& core, const cli::options& o, const stratus_volume& volume, stratus_ray_cast_options& cast)
{
  cast.crop = o.crop.empty() ? 0 : 1;
  std::copy(o.crop.begin(), o.crop.end(), cast.crop_bounds);
  cast.crop_regions = static_cast<uint32_t>(o.crop_regions);
  if (o.mask.empty()) {
    return nullptr;
  }
  auto mask = std::make_unique<cli::input>(core, o.mask, "");
  const stratus_volume& bytes = mask->volume;
  if (bytes.type != STRATUS_UINT8 || !std::equal(bytes.dimensions, bytes.dimensions + 3, volume.dimensions)) {
    throw cli::failure(
      "mask '" + o.mask + "' has " + cli::describe(bytes) + ", one uint8 for each value of " + cli::describe(volume) + " is needed");
  }
  cast.mask = static_cast<const uint8_t*>(bytes.values);
  return mask;
}

void render(const cli::options& o)
{
  if (cli::is_grid(o.source)) {
    cli::render_grid(o);
    return;
  }
  if (o.tetra_method != STRATUS_TETRA_METHOD_AUTO) {
    throw cli::usage("'" + o.source + "' is no unstructured grid: --method is for grids and trees");
  }
  cli::context core(o.device, o.threads);
  cli::input in(core, o.source, o.array);
  cli::frame frame(o);
  const cli::transfer transfer = cli::make_transfer(in.volume, in.scene, o.opacity, o.color, o.unit_distance);
  const stratus_transfer view = transfer.view();
  core.check(stratus_transfer_check(core, &view), "transfer function");
  const stratus_camera camera = cli::place_camera(core, o, in.volume, view, o.up.empty() ? in.up_axis : o.up[0] - 'x');
  cli::output_file out(o.output); // before the work, so that a path that cannot be written is reported at once

  stratus_image image = frame.view();
  stratus_ray_cast_options cast = stratus_ray_cast_options_default();
  cast.mode = o.mode;
  cast.normals = o.normals;
  std::copy(o.average.begin(), o.average.end(), cast.average_range);
  cast.contour_count = static_cast<int>(o.contours.size());
  std::copy(o.contours.begin(), o.contours.end(), cast.contours);
  const std::unique_ptr<cli::input> mask = choose_parts(core, o, in.volume, cast);
  cast.jitter = o.jitter < 0 ? 0 : 1;
  cast.jitter_seed = static_cast<uint32_t>(std::max(0, o.jitter));
  cast.structure = o.structure;
  cast.sampling = o.sampling;
  cast.interpolation = o.nearest ? STRATUS_INTERPOLATION_NEAREST : STRATUS_INTERPOLATION_LINEAR;
  cast.sample_distance = o.sample_distance;
  cast.cell_error = o.cell_error;
  cast.tolerance = o.tolerance;
  cast.shade = o.shade;
  cast.audit = o.audit;
  stratus_ray_cast_report report = {};
  stratus_ray_caster* caster = nullptr;
  core.check(stratus_ray_caster_create(core, &caster), "ray caster");
  const stratus_status status = stratus_ray_caster_render(caster, &in.volume, &view, &camera, &cast, &image, &report);
  stratus_ray_caster_destroy(caster);
  core.check(status, "render");

  std::printf("%s\n", o.source.c_str());
  row("volume", cli::describe(in.volume) + ", array '" + in.array_name + "'");
  row("camera", cli::describe(camera));
  print_report(core, o, report, transfer.origin);
  if (image.samples) {
    row("a pixel", frame.describe_samples());
  }
  if (o.report) {
    core.print_build_report();
  }
  frame.write(out);
  row("picture", o.output);
  if (o.audit && report.differing_pixels > 0) {
    throw cli::failure("audit: skipping changed " + cli::grouped(report.differing_pixels) + " pixels");
  }
}

void list_arrays(vtkImageData* image)
{
  for (bool cells : { false, true }) {
    vtkDataSetAttributes* data = cells ? static_cast<vtkDataSetAttributes*>(image->GetCellData()) : image->GetPointData();
    for (int i = 0; i < data->GetNumberOfArrays(); ++i) {
      vtkAbstractArray* array = data->GetAbstractArray(i);
      row(cells ? "cell array" : "point array",
        cli::format("'%s', %s, %d component%s", array->GetName() ? array->GetName() : "", array->GetDataTypeAsString(),
          array->GetNumberOfComponents(), array->GetNumberOfComponents() == 1 ? "" : "s"));
    }
  }
}

void info(const cli::options& o)
{
  if (cli::is_grid(o.source)) {
    cli::print_grid(o);
    return;
  }
  cli::context core("host", o.threads);
  cli::input in(core, o.source, o.array);
  const cli::histogram h = cli::histogram_of(in.volume);
  double bounds[6];
  core.check(stratus_volume_bounds(core, &in.volume, bounds), "bounds");
  std::printf("%s\n", o.source.c_str());
  row("volume", cli::describe(in.volume));
  row("origin", cli::format("%.10g %.10g %.10g", in.volume.origin[0], in.volume.origin[1], in.volume.origin[2]));
  row("bounds",
    cli::format("%.10g .. %.10g, %.10g .. %.10g, %.10g .. %.10g", bounds[0], bounds[1], bounds[2], bounds[3], bounds[4], bounds[5]));
  row("memory",
    cli::format("%.1f MiB of values", (h.finite + h.not_finite) * static_cast<double>(stratus_type_size(in.volume.type)) / 1048576.0));
  if (in.image) {
    list_arrays(in.image);
  }
  row("drawn", "'" + in.array_name + "'");
  if (h.finite > 0.0) {
    row("range", cli::format("%.9g .. %.9g", h.low, h.high));
  }
  row("not finite", cli::grouped(static_cast<unsigned long long>(h.not_finite)) + " values");
  row("opacity", cli::make_transfer(in.volume, in.scene, o.opacity, o.color, o.unit_distance).origin);
}

void devices()
{
  const int count = stratus_device_count();
  for (int i = 0; i < count; ++i) {
    char name[256];
    stratus_device_name(i, name, sizeof name);
    std::printf("%d  %s\n", i, name);
  }
  if (count == 0) {
    std::printf("no OpenCL device; the host draws\n");
  }
}

// Fails for a small stack, on which OpenCL's compilers and VTK's readers crash.
void check_stack()
{
  constexpr rlim_t least = 256; // KiB; commands crashed at 80 and worked at 96
  struct rlimit limit;
  if (getrlimit(RLIMIT_STACK, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY && limit.rlim_cur / 1024 < least) {
    throw cli::failure(cli::format("the stack may have %llu KiB, at least %llu are needed: ulimit -s %llu",
      static_cast<unsigned long long>(limit.rlim_cur / 1024), static_cast<unsigned long long>(least),
      static_cast<unsigned long long>(least)));
  }
}

void run(const cli::options& o)
{
  check_stack();
  cli::set_read_timeout(o.read_timeout);
  if (o.command == "render") {
    render(o);
  } else if (o.command == "info") {
    info(o);
  } else if (o.command == "tree") {
    cli::print_tree(o);
  } else if (o.command == "sort") {
    cli::print_sort(o);
  } else if (o.command == "devices") {
    devices();
  } else {
    std::fputs(cli::help().c_str(), stdout);
  }
  if (std::fflush(stdout) != 0) {
    throw cli::failure("cannot write to the standard output");
  }
}
} // namespace

int main(int argc, char* argv[])
{
  // VTK's messages are reported as an exception's text, so VTK itself must not print them.
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  try {
    run(cli::parse(argc, argv));
    return 0;
  } catch (const cli::usage& error) {
    std::fprintf(stderr, "stratus: %s\nstratus: --help tells how\n", error.what());
    return 2;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "stratus: out of memory\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stratus: %s\n", error.what());
  }
  return 1;
}
