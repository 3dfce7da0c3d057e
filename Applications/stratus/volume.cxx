// SPDX-License-Identifier: BSD-3-Clause
// Draws an image, a rectilinear grid, their blocks or a scene by the ray caster.
#include "camera.h"
#include "casting.h"
#include "drawing.h"
#include "input.h"
#include "paths.h"

#include "vtkStratusAMR.h"

#include "vtkBoundingBox.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace {

using cli::row;

class volume_drawing : public cli::drawing
{
public:
  volume_drawing(const cli::options& o, cli::context& core) : Options(o), Core(core)
  {
    if (o.tetra_method != STRATUS_TETRA_METHOD_AUTO) {
      throw cli::usage("'" + o.source + "' is no unstructured grid: --method is for grids and trees");
    }
  }
  ~volume_drawing() override
  {
    stratus_path_tracer_destroy(this->Tracer);
    stratus_ray_caster_destroy(this->Caster);
    for (stratus_ray_caster* caster : this->BlockCasters) {
      stratus_ray_caster_destroy(caster);
    }
  }
  volume_drawing(const volume_drawing&) = delete;
  volume_drawing& operator=(const volume_drawing&) = delete;

  void take(const cli::routed& data) override;
  void look() override;
  std::pair<double, double> range() const override;
  cli::scene_frame place() const override;
  const cli::transfer& functions() const override { return this->Transfer; }
  void draw(const stratus_image& image) override;
  void measure(const stratus_quantities& wanted) override;
  void print_rows() const override;
  void judge() const override;

private:
  cli::volumes all() const;
  cli::look_input values() const;
  std::vector<stratus_ray_cast_input> inputs();
  void trace(const stratus_image& image);

  const cli::options& Options;
  cli::context& Core;
  std::unique_ptr<cli::input> Input;
  cli::volume_parts Parts;
  std::vector<std::unique_ptr<cli::input>> Blocks; // further blocks of Input's volume
  std::vector<stratus_ray_caster*> BlockCasters;
  cli::transfer Transfer;
  stratus_transfer View = {}; // of a picture, as is
  stratus_ray_cast_options Casting = {};
  stratus_camera Camera = {};
  stratus_ray_caster* Caster = nullptr;
  stratus_ray_cast_report Report = {};
  stratus_path_tracer* Tracer = nullptr; // --mode path
  stratus_path_report Paths = {};
  int Up = 2;
  uint64_t Steps = 0; // the volume's revision, because a step's values may have the address of the last step's
};

void volume_drawing::take(const cli::routed& data)
{
  const cli::options& o = this->Options;
  this->Input.reset(
    data.image ? new cli::input(this->Core, o.source, data.image, o.array) : new cli::input(this->Core, o.source, o.reading()));
  this->Input->volume.revision = ++this->Steps;
  this->Up = o.up.empty() ? this->Input->up_axis : o.up[0] - 'x';
  this->Input->volume.matrix[5 * this->Up] *= o.exaggeration;
  this->Blocks.clear();
  this->Input->volume.gradients = data.refined ? vtkStratusAMR::GetGradients(data.image) : nullptr;
  for (const auto& block : data.blocks) {
    this->Blocks.push_back(std::make_unique<cli::input>(this->Core, o.source, block, o.array));
    this->Blocks.back()->volume.gradients = data.refined ? vtkStratusAMR::GetGradients(block) : nullptr;
    this->Blocks.back()->volume.revision = this->Steps;
    this->Blocks.back()->volume.matrix[5 * this->Up] *= o.exaggeration;
  }
  if (!this->Blocks.empty() && (!o.mask.empty() || o.audit || o.path)) {
    throw cli::usage("'" + o.source + "' is a volume of " + std::to_string(1 + this->Blocks.size()) + " blocks, which is drawn without " +
      (o.audit     ? "--audit"
          : o.path ? "--mode path"
                   : "--mask"));
  }
}

// The volume, or all its blocks.
cli::volumes volume_drawing::all() const
{
  cli::volumes result = { &this->Input->volume };
  for (const auto& block : this->Blocks) {
    result.push_back(&block->volume);
  }
  return result;
}

cli::look_input volume_drawing::values() const
{
  cli::look_input result;
  for (const stratus_volume* volume : this->all()) {
    result.volumes.push_back(*volume);
  }
  return result;
}

void volume_drawing::look()
{
  const cli::options& o = this->Options;
  const cli::input& in = *this->Input;
  this->Transfer = cli::make_transfer(this->Core, this->values(), in.scene, o);
  const stratus_transfer view = this->Transfer.view();
  this->Core.check(stratus_transfer_check(this->Core, &view), "transfer function");
  std::vector<cli::shown_volume> shown;
  for (const stratus_volume* volume : this->all()) {
    shown.push_back({ volume, view });
  }
  double room[4];
  const bool moved = cli::annotation(o).find_room(this->Core, this->place(), this->Transfer, room);
  this->Camera = cli::place_camera(this->Core, o, shown, this->Up, moved ? room : nullptr);
}

std::pair<double, double> volume_drawing::range() const
{
  const stratus_look_values found = cli::count_values(this->Core, this->values());
  return { found.low, found.high };
}

cli::scene_frame volume_drawing::place() const
{
  cli::scene_frame frame;
  frame.camera = this->Camera;
  vtkBoundingBox box;
  for (const stratus_volume* volume : this->all()) {
    double own[6];
    this->Core.check(stratus_volume_bounds(this->Core, volume, own), "bounds");
    box.AddBounds(own);
  }
  box.GetBounds(frame.bounds);
  frame.scale[this->Up] = this->Options.exaggeration;
  frame.title = this->Input->array_name;
  return frame;
}

// The volume, or all its blocks, as the core takes them.
std::vector<stratus_ray_cast_input> volume_drawing::inputs()
{
  const cli::volumes volumes = this->all();
  this->Casting = cli::casting_of(this->Options, this->Up);
  this->Parts.set(this->Options, this->Core, this->Input->volume, this->Casting);
  this->View = this->Transfer.view();
  std::vector<stratus_ray_cast_input> inputs(volumes.size());
  this->BlockCasters.resize(std::max(this->BlockCasters.size(), this->Blocks.size()), nullptr);
  for (size_t i = 0; i < volumes.size(); ++i) {
    stratus_ray_caster*& caster = i > 0 ? this->BlockCasters[i - 1] : this->Caster;
    if (!caster) {
      this->Core.check(stratus_ray_caster_create(this->Core, &caster), "ray caster");
    }
    inputs[i].caster = caster;
    inputs[i].volume = volumes[i];
    inputs[i].transfer = &this->View;
    inputs[i].options = &this->Casting;
  }
  return inputs;
}

// Draws light that is scattered.
void volume_drawing::trace(const stratus_image& image)
{
  stratus_ray_cast_options parts = stratus_ray_cast_options_default();
  this->Parts.set(this->Options, this->Core, this->Input->volume, parts);
  const stratus_path_options paths = cli::paths_of(this->Options, parts, this->Up);
  this->View = this->Transfer.view();
  if (!this->Tracer) {
    this->Core.check(stratus_path_tracer_create(this->Core, &this->Tracer), "path tracer");
  }
  this->Core.check(
    stratus_path_tracer_render(this->Tracer, &this->Input->volume, &this->View, &this->Camera, &paths, &image, &this->Paths), "render");
}

void volume_drawing::draw(const stratus_image& image)
{
  if (this->Options.path) {
    this->trace(image);
    return;
  }
  const std::vector<stratus_ray_cast_input> inputs = this->inputs();
  std::vector<stratus_ray_cast_report> reports(inputs.size());
  this->Core.check(
    stratus_ray_caster_render_blocks(inputs.data(), static_cast<int>(inputs.size()), &this->Camera, &image, reports.data()), "render");
  // The reasons are from the block with the most samples, the counts are summed over all blocks.
  const auto busiest = std::max_element(reports.begin(), reports.end(),
    [](const stratus_ray_cast_report& a, const stratus_ray_cast_report& b) { return a.samples < b.samples; });
  this->Report = *busiest;
  for (auto r = reports.begin(); r != reports.end(); ++r) {
    if (r != busiest) {
      stratus_ray_cast_report_add(&this->Report, &*r);
    }
  }
}

void volume_drawing::measure(const stratus_quantities& wanted)
{
  const std::vector<stratus_ray_cast_input> inputs = this->inputs();
  stratus_quantities of_blocks = wanted;
  of_blocks.blocks = 1;
  this->Core.check(
    stratus_ray_caster_render_quantities(inputs.data(), static_cast<int>(inputs.size()), &this->Camera, &of_blocks), "quantity");
}

void volume_drawing::print_rows() const
{
  row("volume",
    (this->Blocks.empty() ? "" : std::to_string(1 + this->Blocks.size()) + " blocks, the first of ") + cli::describe(this->Input->volume) +
      ", array '" + this->Input->array_name + "'");
  row("camera", cli::describe(this->Camera));
  if (this->Options.path) {
    cli::print_paths(this->Options, this->Core, this->Transfer, this->Paths);
  } else {
    cli::print_cast(this->Options, this->Core, this->Transfer, this->Report);
  }
}

void volume_drawing::judge() const
{
  cli::judge_cast(this->Options, this->Report);
}
} // namespace

std::unique_ptr<cli::drawing> cli::make_volume_drawing(const options& o, context& core)
{
  return std::make_unique<volume_drawing>(o, core);
}
