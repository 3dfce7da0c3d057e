// SPDX-License-Identifier: BSD-3-Clause
#include "grid.h"

#include "camera.h"
#include "casting.h"
#include "drawing.h"
#include "globe.h"
#include "mesh.h"
#include "picture.h"

#include <algorithm>
#include <cstdio>
#include <string>

namespace {

// The mode of meshes of the same name. Options for regular grids only are refused, so that none is ignored silently.
stratus_tetra_mode mode_of(const cli::options& o)
{
  if (o.path) {
    throw cli::usage("'" + o.source + "' is a grid of cells: --mode path is for images and rectilinear grids");
  }
  if (o.structure != STRATUS_STRUCTURE_AUTO || o.sampling != STRATUS_SAMPLING_AUTO || o.nearest || o.audit || o.sample_distance != 0.0 ||
    o.cell_error != 0.0 || !o.mask.empty() || o.jitter >= 0) {
    throw cli::usage("'" + o.source +
      "' is a grid of cells: structure, sampling, interpolation, sample distance, cell error, mask, jitter and " + "audit are for images");
  }
  for (int i = STRATUS_TETRA_COMPOSITE; i <= STRATUS_TETRA_FIRST_HIT; ++i) {
    const auto mode = static_cast<stratus_tetra_mode>(i);
    if (std::string(stratus_tetra_mode_name(mode)) == stratus_mode_name(o.mode)) {
      return mode;
    }
  }
  return STRATUS_TETRA_COMPOSITE; // there is no mode that meshes lack
}
} // namespace

namespace cli {

stratus_camera place_camera(const context& core, const options& o, const mesh& m, const stratus_transfer& view, const double* room)
{
  const stratus_volume box = m.outline();
  return place_camera(core, o, { { &box, view } }, o.up.empty() ? 2 : o.up[0] - 'x', room);
}

} // namespace cli

namespace {

using cli::row;

class grid_drawing : public cli::drawing
{
public:
  grid_drawing(const cli::options& o, cli::context& core) : Options(o), Core(core), Mode(mode_of(o)) {}
  ~grid_drawing() override { stratus_tetra_caster_destroy(this->Caster); }
  grid_drawing(const grid_drawing&) = delete;
  grid_drawing& operator=(const grid_drawing&) = delete;

  void take(const cli::routed& data) override;
  void look() override;
  std::pair<double, double> range() const override;
  cli::scene_frame place() const override;
  const cli::transfer& functions() const override { return this->Transfer; }
  void draw(const stratus_image& image) override;
  void measure(const stratus_quantities& wanted) override;
  void print_rows() const override;

private:
  stratus_tetra_options how() const;
  int across() const { return this->Options.globe ? -1 : this->up(); } // the axis across layers, -1: away from the middle
  int up() const { return this->Options.up.empty() ? 2 : this->Options.up[0] - 'x'; }

  const cli::options& Options;
  cli::context& Core;
  stratus_tetra_mode Mode;
  cli::mesh Mesh;
  cli::transfer Transfer;
  stratus_camera Camera = {};
  stratus_tetra_caster* Caster = nullptr;
  stratus_tetra_report Report = {};
};

void grid_drawing::take(const cli::routed& data)
{
  this->Mesh.set(data.grid, this->Options);
  this->Core.check(stratus_mesh_check(this->Core, &this->Mesh.view()), "'" + this->Options.source + "'");
}

void grid_drawing::look()
{
  const cli::options& o = this->Options;
  this->Transfer = cli::make_transfer(this->Core, this->Mesh.values(this->across()), nullptr, o);
  const stratus_transfer view = this->Transfer.view();
  this->Core.check(stratus_transfer_check(this->Core, &view), "transfer function");
  double room[4];
  const bool moved = cli::annotation(o).find_room(this->Core, this->place(), this->Transfer, room);
  this->Camera = cli::place_camera(this->Core, o, this->Mesh, view, moved ? room : nullptr);
}

std::pair<double, double> grid_drawing::range() const
{
  const stratus_look_values found = cli::count_values(this->Core, this->Mesh.values(this->across()));
  return { found.low, found.high };
}

cli::scene_frame grid_drawing::place() const
{
  cli::scene_frame frame;
  frame.camera = this->Camera;
  const stratus_volume box = this->Mesh.box();
  this->Core.check(stratus_volume_bounds(this->Core, &box, frame.bounds), "bounds");
  frame.scale[this->up()] = this->Options.exaggeration;
  frame.title = this->Mesh.array_name;
  return frame;
}

stratus_tetra_options grid_drawing::how() const
{
  stratus_tetra_options how = stratus_tetra_options_default();
  const cli::options& o = this->Options;
  how.mode = this->Mode;
  how.method = o.tetra_method;
  how.tolerance = o.tolerance;
  how.crop = o.crop.empty() ? 0 : 1;
  how.crop_regions = static_cast<uint32_t>(o.crop_regions);
  std::copy(o.crop.begin(), o.crop.end(), how.crop_bounds);
  std::copy(o.average.begin(), o.average.end(), how.average_range);
  how.contour_count = static_cast<int>(o.contours.size());
  std::copy(o.contours.begin(), o.contours.end(), how.contours);
  how.slice = cli::slice_of(o, this->up());
  cli::set_light(o, this->up(), how.shade, how.shading);
  how.shade = how.shade || o.mode == STRATUS_MODE_FIRST_HIT;
  how.normals = o.normals;
  return how;
}

void grid_drawing::draw(const stratus_image& image)
{
  if (!this->Caster) {
    this->Core.check(stratus_tetra_caster_create(this->Core, &this->Caster), "caster of tetrahedra");
  }
  const stratus_tetra_options how = this->how();
  const stratus_transfer view = this->Transfer.view();
  stratus_camera camera = this->Camera;
  stratus_image to = image;
  std::unique_ptr<cli::globe> earth;
  if (this->Options.globe) {
    const cli::background behind = cli::parse_background(this->Options.background);
    earth = std::make_unique<cli::globe>(this->Mesh.view(), this->Options.coast, behind.transparent ? 0.5 : 0.85);
    earth->end_rays(this->Core, camera, to);
  }
  this->Core.check(stratus_tetra_caster_render(this->Caster, &this->Mesh.view(), &view, &camera, &how, &to, &this->Report), "render");
  if (earth) {
    earth->draw(this->Core, camera, image);
  }
}

void grid_drawing::measure(const stratus_quantities& wanted)
{
  const stratus_tetra_options how = this->how();
  const stratus_transfer view = this->Transfer.view();
  stratus_ray_cast_input input = {};
  input.tetra = this->Caster;
  input.mesh = &this->Mesh.view();
  input.transfer = &view;
  input.tetra_options = &how;
  this->Core.check(stratus_ray_caster_render_quantities(&input, 1, &this->Camera, &wanted), "quantity");
}

void grid_drawing::print_rows() const
{
  const stratus_tetra_report& r = this->Report;
  row("mesh",
    cli::grouped(static_cast<unsigned long long>(r.cells)) + " tetrahedra, " +
      cli::grouped(static_cast<unsigned long long>(this->Mesh.points)) + " points, array '" + this->Mesh.array_name + "' on " +
      (this->Mesh.view().cell_values ? "cells" : "points"));
  if (this->Mesh.ignored() > 0) {
    row("ignored", cli::grouped(static_cast<unsigned long long>(this->Mesh.ignored())) + " vertices, lines and polygons");
  }
  row("camera", cli::describe(this->Camera));
  row("opacity", this->Transfer.origin);
  row("device", stratus_context_device(this->Core));
  row("build", cli::format("%.2f ms: cells and border %.2f, table %.2f", r.build_ms + r.table_ms, r.build_ms, r.table_ms));
  row("frame",
    cli::format("%.2f ms for %d x %d pixels, %s rays met the mesh",
      r.transform_ms + r.entries_ms + r.march_ms + r.sort_ms + r.bin_ms + r.project_ms, this->Options.width, this->Options.height,
      cli::grouped(r.rays).c_str()));
  row("mode", stratus_tetra_mode_name(this->Mode));
  row("method", r.why);
  row("cells passed", cli::grouped(r.segments) + ", in from outside " + cli::grouped(r.entries) + " times");
  row("flat", cli::grouped(static_cast<unsigned long long>(r.flat)) + " cells have no volume");
  row("built",
    cli::format("%s times the mesh, %s times its values", cli::grouped(r.mesh_builds).c_str(), cli::grouped(r.value_builds).c_str()));
}
} // namespace

std::unique_ptr<cli::drawing> cli::make_grid_drawing(const options& o, context& core)
{
  return std::make_unique<grid_drawing>(o, core);
}
