// SPDX-License-Identifier: BSD-3-Clause
// Draws several INPUTs in one picture, mixed along the rays: volumes and meshes in any order.
#include "camera.h"
#include "casting.h"
#include "drawing.h"
#include "input.h"
#include "mesh.h"

#include "vtkBoundingBox.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace {

using cli::row;

// One of the INPUTs, with the caster of its kind.
struct member {
  cli::options o;
  std::unique_ptr<cli::input> input; // null for a mesh
  std::unique_ptr<cli::mesh> mesh;   // null for a volume
  cli::transfer functions;
  stratus_transfer view = {};
  stratus_volume outline = {}; // of a mesh
  stratus_tetra_options tetra_options = {};
  stratus_ray_cast_options options = {};
  stratus_ray_caster* caster = nullptr;
  stratus_tetra_caster* tetra = nullptr;
  stratus_ray_cast_report report = {};

  cli::look_input values(int up) const
  {
    return this->mesh ? this->mesh->values(up) : cli::look_input{ { this->input->volume }, {}, {}, false };
  }
  const stratus_volume& shape() const { return this->mesh ? this->outline : this->input->volume; }
  const std::string& array_name() const { return this->mesh ? this->mesh->array_name : this->input->array_name; }
};

class several_drawing : public cli::drawing
{
public:
  several_drawing(const cli::options& o, cli::context& core) : Options(o), Core(core)
  {
    if (o.tetra_method != STRATUS_TETRA_METHOD_AUTO) {
      throw cli::usage("--method needs a single grid: among several INPUTs a grid of cells is marched");
    }
  }
  ~several_drawing() override
  {
    for (const member& one : this->Members) {
      stratus_ray_caster_destroy(one.caster);
      stratus_tetra_caster_destroy(one.tetra);
    }
  }
  several_drawing(const several_drawing&) = delete;
  several_drawing& operator=(const several_drawing&) = delete;

  void take(const cli::routed& data) override;
  void look() override;
  std::pair<double, double> range() const override;
  cli::scene_frame place() const override;
  const cli::transfer& functions() const override { return this->Members[0].functions; }
  void draw(const stratus_image& image) override;
  void measure(const stratus_quantities& wanted) override;
  void print_rows() const override;
  void judge() const override;

private:
  std::vector<stratus_ray_cast_input> inputs();
  void take_member(const cli::options& o, const cli::routed& data);
  void set_mesh(member& one, const cli::routed& data);

  const cli::options& Options;
  cli::context& Core;
  std::vector<member> Members; // the first INPUT first
  cli::volume_parts Parts;     // of the first one
  stratus_camera Camera = {};
  int Up = 2;
};

// Reads the other INPUTs, too. Each has the first INPUT's options except those given after its name.
void several_drawing::take(const cli::routed& data)
{
  this->take_member(this->Options, data);
  for (const cli::companion& companion : this->Options.companions) {
    cli::options o = this->Options;
    o.source = companion.source;
    o.array = companion.array;
    o.raw = companion.raw;
    o.select = companion.select;
    o.opacity = companion.opacity;
    o.color = companion.color;
    o.unit_distance = companion.unit_distance;
    o.about = { o.about.earth, o.array, "" };
    this->take_member(o, cli::is_scene(o.source) ? cli::routed() : cli::route(cli::read_data(o.source, o.reading()), o.source, o.array));
  }
}

// Adds a scene, an image or a rectilinear grid, or else cells. The first one determines which axis is up.
void several_drawing::take_member(const cli::options& o, const cli::routed& data)
{
  if (!data.blocks.empty() || data.refined) {
    throw cli::usage(data.refined ? "'" + o.source + "' is AMR, which is drawn without others: leave out the other INPUTs"
                                  : "'" + o.source + "' is a volume of " + std::to_string(1 + data.blocks.size()) +
          " blocks, which is drawn without others: leave out the other INPUTs");
  }
  this->Members.emplace_back();
  member& one = this->Members.back();
  one.o = o;
  const bool first = this->Members.size() == 1;
  if (first && !o.up.empty()) {
    this->Up = o.up[0] - 'x';
  }
  if (data.grid) {
    this->set_mesh(one, data);
    return;
  }
  one.input.reset(
    data.image ? new cli::input(this->Core, o.source, data.image, o.array) : new cli::input(this->Core, o.source, o.reading()));
  if (first && o.up.empty()) {
    this->Up = one.input->up_axis;
  }
  one.input->volume.matrix[5 * this->Up] *= this->Options.exaggeration;
  this->Core.check(stratus_ray_caster_create(this->Core, &one.caster), "ray caster");
}

void several_drawing::set_mesh(member& one, const cli::routed& data)
{
  const cli::options& o = this->Options;
  if (!o.mask.empty() && this->Members.size() == 1) {
    throw cli::usage("'" + one.o.source + "' is a grid of cells, which takes no mask: name the volume that it masks first");
  }
  one.o.up = std::string(1, static_cast<char>('x' + this->Up));
  one.mesh = std::make_unique<cli::mesh>();
  one.mesh->set(data.grid, one.o);
  this->Core.check(stratus_mesh_check(this->Core, &one.mesh->view()), "'" + one.o.source + "'");
  one.outline = one.mesh->outline();
  this->Core.check(stratus_tetra_caster_create(this->Core, &one.tetra), "caster of tetrahedra");
}

void several_drawing::look()
{
  std::vector<cli::shown_volume> shown;
  for (member& one : this->Members) {
    one.functions = cli::make_transfer(this->Core, one.values(this->Up), one.mesh ? nullptr : one.input->scene, one.o);
    const stratus_transfer view = one.functions.view();
    this->Core.check(stratus_transfer_check(this->Core, &view), "transfer function of '" + one.o.source + "'");
    shown.push_back({ &one.shape(), view });
  }
  double room[4];
  const bool moved = cli::annotation(this->Options).find_room(this->Core, this->place(), this->functions(), room);
  this->Camera = cli::place_camera(this->Core, this->Options, shown, this->Up, moved ? room : nullptr);
}

std::pair<double, double> several_drawing::range() const
{
  const stratus_look_values found = cli::count_values(this->Core, this->Members[0].values(this->Up));
  return { found.low, found.high };
}

cli::scene_frame several_drawing::place() const
{
  cli::scene_frame frame;
  frame.camera = this->Camera;
  vtkBoundingBox box;
  for (const member& one : this->Members) {
    double own[6];
    this->Core.check(stratus_volume_bounds(this->Core, &one.shape(), own), "bounds");
    box.AddBounds(own);
  }
  box.GetBounds(frame.bounds);
  frame.scale[this->Up] = this->Options.exaggeration;
  frame.title = this->Members[0].array_name();
  return frame;
}

// The members as the core takes them. Only the first INPUT is cropped and masked.
std::vector<stratus_ray_cast_input> several_drawing::inputs()
{
  std::vector<stratus_ray_cast_input> inputs(this->Members.size());
  for (size_t n = 0; n < inputs.size(); ++n) {
    member& one = this->Members[n];
    one.view = one.functions.view();
    inputs[n].transfer = &one.view;
    one.options = cli::casting_of(this->Options, this->Up);
    if (one.mesh) {
      one.tetra_options = stratus_tetra_options_default();
      one.tetra_options.tolerance = this->Options.tolerance;
      cli::set_light(this->Options, this->Up, one.tetra_options.shade, one.tetra_options.shading);
      one.tetra_options.crop = n == 0 && !this->Options.crop.empty();
      std::copy(this->Options.crop.begin(), this->Options.crop.end(), one.tetra_options.crop_bounds);
      one.tetra_options.crop_regions = static_cast<uint32_t>(this->Options.crop_regions);
      inputs[n].tetra = one.tetra;
      inputs[n].mesh = &one.mesh->view();
      inputs[n].tetra_options = &one.tetra_options;
      continue;
    }
    if (n == 0) {
      this->Parts.set(this->Options, this->Core, one.input->volume, one.options);
    }
    inputs[n].caster = one.caster;
    inputs[n].volume = &one.input->volume;
    inputs[n].options = &one.options;
  }
  return inputs;
}

void several_drawing::measure(const stratus_quantities& wanted)
{
  const std::vector<stratus_ray_cast_input> inputs = this->inputs();
  this->Core.check(
    stratus_ray_caster_render_quantities(inputs.data(), static_cast<int>(inputs.size()), &this->Camera, &wanted), "quantity");
}

void several_drawing::draw(const stratus_image& image)
{
  const std::vector<stratus_ray_cast_input> inputs = this->inputs();
  const size_t count = inputs.size();
  std::vector<stratus_ray_cast_report> reports(count);
  this->Core.check(
    stratus_ray_caster_render_several(inputs.data(), static_cast<int>(count), &this->Camera, &image, reports.data()), "render");
  for (size_t n = 0; n < count; ++n) {
    this->Members[n].report = reports[n];
  }
}

// Rows about the whole run are printed from the first volume's report, since meshes have no structure and no sampling.
void several_drawing::print_rows() const
{
  const auto is_volume = [](const member& one) { return !one.mesh; };
  const auto volume = std::find_if(this->Members.begin(), this->Members.end(), is_volume);
  for (auto one = this->Members.begin(); one != this->Members.end(); ++one) {
    const bool first = one == this->Members.begin();
    const std::string what =
      one->mesh ? cli::grouped(static_cast<unsigned long long>(one->mesh->points)) + " points" : cli::describe(one->input->volume);
    row(!first      ? "with"
        : one->mesh ? "mesh"
                    : "volume",
      (first ? "" : one->o.source + ": ") + what + ", array '" + one->array_name() + "'");
    if (one != volume) {
      row("opacity", one->functions.origin);
      row("why", one->report.why);
    }
  }
  row("camera", cli::describe(this->Camera));
  if (volume != this->Members.end()) {
    cli::print_cast(this->Options, this->Core, volume->functions, volume->report);
    return;
  }
  const stratus_ray_cast_report& r = this->Members[0].report;
  row("device", stratus_context_device(this->Core));
  row("frame",
    cli::format("%.2f ms for %d x %d pixels, %s rays met a mesh", r.cast_ms, this->Options.width, this->Options.height,
      cli::grouped(r.rays).c_str()));
  row("cells passed", cli::grouped(r.samples));
}

void several_drawing::judge() const
{
  cli::judge_cast(this->Options, this->Members[0].report);
}
} // namespace

std::unique_ptr<cli::drawing> cli::make_several_drawing(const options& o, context& core)
{
  return std::make_unique<several_drawing>(o, core);
}
