// SPDX-License-Identifier: BSD-3-Clause
#include "grid.h"

#include "camera.h"
#include "frame.h"
#include "mesh.h"
#include "transfer.h"

#include <cstdio>

namespace {

// Refuses options that apply to regular grids only, so that none is ignored silently.
void refuse_options(const cli::options& o)
{
  if (o.mode != STRATUS_MODE_COMPOSITE || o.structure != STRATUS_STRUCTURE_AUTO || o.sampling != STRATUS_SAMPLING_AUTO || o.nearest ||
    o.shade || o.audit || o.sample_distance != 0.0 || o.cell_error != 0.0 || !o.crop.empty() || !o.mask.empty() || o.jitter >= 0) {
    throw cli::usage("'" + o.source +
      "' is an unstructured grid: other modes than composite, structure, sampling, interpolation, sample distance, cell error, " +
      "crop, mask, jitter and audit are for images");
  }
}
} // namespace

namespace cli {

stratus_camera place_camera(const context& core, const options& o, const mesh& m, const stratus_transfer& view)
{
  stratus_volume box = m.box();
  const uint8_t nothing[8] = {}; // of no value, so that the whole box counts as shown
  box.values = nothing;
  box.type = STRATUS_UINT8;
  for (int a = 0; a < 3; ++a) {
    box.spacing[a] *= static_cast<double>(box.dimensions[a]) / 2.0;
    box.dimensions[a] = 2;
  }
  return place_camera(core, o, box, view, o.up.empty() ? 2 : o.up[0] - 'x');
}

void render_grid(const options& o)
{
  refuse_options(o);
  context core(o.device, o.threads);
  const vtkSmartPointer<vtkUnstructuredGrid> grid = read_grid(o.source);
  const mesh m(grid, o.array, o.source);
  core.check(stratus_mesh_check(core, &m.view()), "'" + o.source + "'");
  frame picture(o);
  const transfer look = make_transfer(m.box(), nullptr, o.opacity, o.color, o.unit_distance);
  const stratus_transfer view = look.view();
  core.check(stratus_transfer_check(core, &view), "transfer function");
  const stratus_camera camera = place_camera(core, o, m, view);
  output_file out(o.output); // before the work, so that a path that cannot be written is reported at once

  stratus_image image = picture.view();
  stratus_tetra_report report = {};
  stratus_tetra_caster* caster = nullptr;
  core.check(stratus_tetra_caster_create(core, &caster), "caster of tetrahedra");
  stratus_tetra_options how = stratus_tetra_options_default();
  how.method = o.tetra_method;
  how.tolerance = o.tolerance;
  const stratus_status status = stratus_tetra_caster_render(caster, &m.view(), &view, &camera, &how, &image, &report);
  stratus_tetra_caster_destroy(caster);
  core.check(status, "render");

  std::printf("%s\n", o.source.c_str());
  row("mesh",
    grouped(static_cast<unsigned long long>(report.cells)) + " tetrahedra, " +
      grouped(static_cast<unsigned long long>(grid->GetNumberOfPoints())) + " points, array '" + m.array_name + "' on " +
      (m.view().cell_values ? "cells" : "points"));
  if (m.ignored() > 0) {
    row("ignored", grouped(static_cast<unsigned long long>(m.ignored())) + " vertices, lines and polygons");
  }
  row("camera", describe(camera));
  row("opacity", look.origin);
  row("device", stratus_context_device(core));
  row("build", format("%.2f ms: cells and border %.2f, table %.2f", report.build_ms + report.table_ms, report.build_ms, report.table_ms));
  row("frame",
    format("%.2f ms for %d x %d pixels, %s rays met the mesh",
      report.transform_ms + report.entries_ms + report.march_ms + report.sort_ms + report.bin_ms + report.project_ms, o.width, o.height,
      grouped(report.rays).c_str()));
  row("method", report.why);
  row("cells passed", grouped(report.segments) + ", in from outside " + grouped(report.entries) + " times");
  row("flat", grouped(static_cast<unsigned long long>(report.flat)) + " cells have no volume");
  if (image.samples) {
    row("a pixel", picture.describe_samples());
  }
  if (o.report) {
    core.print_build_report();
  }
  picture.write(out);
  row("picture", o.output);
}
} // namespace cli
