// SPDX-License-Identifier: BSD-3-Clause
// Draws images and scenes by the ray caster.
#include "camera.h"
#include "drawing.h"
#include "input.h"
#include "mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
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
    stratus_ray_caster_destroy(this->Caster);
    for (const member& more : this->More) {
      stratus_ray_caster_destroy(more.caster);
      stratus_tetra_caster_destroy(more.tetra);
    }
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
  void tell() const override;
  void judge() const override;

private:
  // A volume that is drawn with the first one, or a mesh.
  struct member {
    cli::options o;
    std::unique_ptr<cli::input> input;
    std::unique_ptr<cli::mesh> mesh; // null for a volume
    cli::transfer functions;
    stratus_volume outline = {}; // of a mesh
    stratus_tetra_options how = {};
    stratus_ray_caster* caster = nullptr;
    stratus_tetra_caster* tetra = nullptr;
    stratus_ray_cast_report report = {};
  };

  void read_more();
  void read_member(member& more);
  cli::volumes all() const;
  void draw_blocks(const stratus_ray_cast_options& cast, const stratus_image& image);
  void draw_several(const stratus_ray_cast_options& cast, const stratus_image& image);
  void choose_parts(stratus_ray_cast_options& cast);
  void tell_report() const;

  const cli::options& Options;
  cli::context& Core;
  std::unique_ptr<cli::input> Input, Mask;
  std::vector<std::unique_ptr<cli::input>> Blocks; // of the same volume as Input, beside it
  std::vector<stratus_ray_caster*> BlockCasters;
  std::vector<member> More;
  cli::transfer Transfer;
  stratus_camera Camera = {};
  stratus_ray_caster* Caster = nullptr;
  stratus_ray_cast_report Report = {};
  int Up = 2;
  uint64_t Steps = 0; // the volume's revision, because a step's values may lie where the last one's were
};

void volume_drawing::take(const cli::routed& data)
{
  const cli::options& o = this->Options;
  this->Input.reset(
    data.image ? new cli::input(this->Core, o.source, data.image, o.array) : new cli::input(this->Core, o.source, o.array, o.raw));
  this->Input->volume.revision = ++this->Steps;
  this->Up = o.up.empty() ? this->Input->up_axis : o.up[0] - 'x';
  this->Input->volume.matrix[5 * this->Up] *= o.exaggeration;
  this->Blocks.clear();
  for (const auto& block : data.blocks) {
    this->Blocks.push_back(std::make_unique<cli::input>(this->Core, o.source, block, o.array));
    this->Blocks.back()->volume.revision = this->Steps;
    this->Blocks.back()->volume.matrix[5 * this->Up] *= o.exaggeration;
  }
  if (!this->Blocks.empty() && (!o.companions.empty() || !o.mask.empty() || o.audit)) {
    throw cli::usage("'" + o.source + "' is a volume of " + std::to_string(1 + this->Blocks.size()) +
      " blocks, which is drawn alone: leave out " +
      (o.audit             ? "--audit"
          : o.mask.empty() ? "the other INPUTs"
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

// Reads a scene, an image or a rectilinear grid, or else cells.
void volume_drawing::read_member(member& more)
{
  const std::string& source = more.o.source;
  const bool scene = cli::is_scene(source);
  const cli::routed data = scene ? cli::routed() : cli::route(cli::read_data(source, more.o.array, more.o.raw), source, more.o.array);
  if (!data.blocks.empty()) {
    throw cli::usage("'" + source + "' is a volume of " + std::to_string(1 + data.blocks.size()) + " blocks, which is drawn alone");
  }
  if (scene || data.image) {
    more.input = scene ? std::make_unique<cli::input>(this->Core, source, more.o.array, more.o.raw)
                       : std::make_unique<cli::input>(this->Core, source, data.image, more.o.array);
    more.input->volume.matrix[5 * this->Up] *= this->Options.exaggeration;
    more.functions = cli::make_transfer({ &more.input->volume }, more.input->scene, more.o);
    this->Core.check(stratus_ray_caster_create(this->Core, &more.caster), "ray caster");
    return;
  }
  if (more.o.shade) {
    throw cli::usage("'" + source + "' is a grid of cells, which is not lit among several INPUTs: leave out --shade");
  }
  more.o.up = std::string(1, static_cast<char>('x' + this->Up));
  more.mesh = std::make_unique<cli::mesh>();
  more.mesh->set(data.grid, more.o);
  this->Core.check(stratus_mesh_check(this->Core, &more.mesh->view()), "'" + source + "'");
  more.outline = more.mesh->outline();
  const stratus_volume box = more.mesh->box();
  more.functions = cli::make_transfer({ &box }, nullptr, more.o);
  this->Core.check(stratus_tetra_caster_create(this->Core, &more.tetra), "caster of tetrahedra");
}

// Reads the other volumes, each with the options of the first but for what was said of it.
void volume_drawing::read_more()
{
  for (const cli::companion& companion : this->Options.companions) {
    member more;
    more.o = this->Options;
    more.o.source = companion.source;
    more.o.array = companion.array;
    more.o.raw = companion.raw;
    more.o.opacity = companion.opacity;
    more.o.color = companion.color;
    more.o.unit_distance = companion.unit_distance;
    this->read_member(more);
    this->More.push_back(std::move(more));
  }
}

void volume_drawing::look()
{
  const cli::options& o = this->Options;
  const cli::input& in = *this->Input;
  this->Transfer = cli::make_transfer(this->all(), in.scene, o);
  const stratus_transfer view = this->Transfer.view();
  this->Core.check(stratus_transfer_check(this->Core, &view), "transfer function");
  this->read_more();
  std::vector<cli::shown_volume> shown;
  for (const stratus_volume* volume : this->all()) {
    shown.push_back({ volume, view });
  }
  for (const member& more : this->More) {
    shown.push_back({ more.mesh ? &more.outline : &more.input->volume, more.functions.view() });
  }
  this->Camera = cli::place_camera(this->Core, o, shown, this->Up);
}

std::pair<double, double> volume_drawing::range() const
{
  const cli::histogram h = cli::histogram_of(this->all());
  return { h.low, h.high };
}

cli::scene_frame volume_drawing::place() const
{
  cli::scene_frame frame;
  frame.camera = this->Camera;
  this->Core.check(stratus_volume_bounds(this->Core, &this->Input->volume, frame.bounds), "bounds");
  cli::volumes shown = this->all();
  for (const member& more : this->More) {
    shown.push_back(more.mesh ? &more.outline : &more.input->volume);
  }
  for (const stratus_volume* volume : shown) {
    double own[6];
    this->Core.check(stratus_volume_bounds(this->Core, volume, own), "bounds");
    for (int side = 0; side < 6; ++side) {
      frame.bounds[side] = side % 2 ? std::max(frame.bounds[side], own[side]) : std::min(frame.bounds[side], own[side]);
    }
  }
  frame.scale[this->Up] = this->Options.exaggeration;
  frame.title = this->Input->array_name;
  return frame;
}

// Sets the crop and the mask, which is read once.
void volume_drawing::choose_parts(stratus_ray_cast_options& cast)
{
  const cli::options& o = this->Options;
  const stratus_volume& volume = this->Input->volume;
  cast.crop = o.crop.empty() ? 0 : 1;
  std::copy(o.crop.begin(), o.crop.end(), cast.crop_bounds);
  cast.crop_regions = static_cast<uint32_t>(o.crop_regions);
  if (o.mask.empty()) {
    return;
  }
  if (!this->Mask) {
    this->Mask = std::make_unique<cli::input>(this->Core, o.mask, "", o.mask_raw);
  }
  const stratus_volume& bytes = this->Mask->volume;
  if (bytes.type != STRATUS_UINT8 || !std::equal(bytes.dimensions, bytes.dimensions + 3, volume.dimensions)) {
    throw cli::failure(
      "mask '" + o.mask + "' has " + cli::describe(bytes) + ", one uint8 for each value of " + cli::describe(volume) + " is needed");
  }
  cast.mask = static_cast<const uint8_t*>(bytes.values);
}

void volume_drawing::draw(const stratus_image& image)
{
  const cli::options& o = this->Options;
  stratus_ray_cast_options cast = stratus_ray_cast_options_default();
  cast.mode = o.mode;
  cast.normals = o.normals;
  std::copy(o.average.begin(), o.average.end(), cast.average_range);
  cast.contour_count = static_cast<int>(o.contours.size());
  std::copy(o.contours.begin(), o.contours.end(), cast.contours);
  for (size_t a = 0; a < 3 && !o.slice.empty(); ++a) {
    const double scale = static_cast<int>(a) == this->Up ? o.exaggeration : 1.0;
    cast.slice.center[a] = o.slice[a] * scale;
    cast.slice.linear[a] = o.slice[3 + a] / scale;
  }
  this->choose_parts(cast);
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
  if (!this->Caster) {
    this->Core.check(stratus_ray_caster_create(this->Core, &this->Caster), "ray caster");
  }
  if (!this->More.empty()) {
    this->draw_several(cast, image);
    return;
  }
  if (!this->Blocks.empty()) {
    this->draw_blocks(cast, image);
    return;
  }
  const stratus_transfer view = this->Transfer.view();
  this->Core.check(
    stratus_ray_caster_render(this->Caster, &this->Input->volume, &view, &this->Camera, &cast, &image, &this->Report), "render");
}

void volume_drawing::draw_blocks(const stratus_ray_cast_options& cast, const stratus_image& image)
{
  const cli::volumes volumes = this->all();
  const stratus_transfer view = this->Transfer.view();
  std::vector<stratus_ray_cast_input> inputs(volumes.size());
  std::vector<stratus_ray_cast_report> reports(volumes.size());
  this->BlockCasters.resize(std::max(this->BlockCasters.size(), this->Blocks.size()), nullptr);
  for (size_t i = 0; i < volumes.size(); ++i) {
    stratus_ray_caster*& caster = i > 0 ? this->BlockCasters[i - 1] : this->Caster;
    if (!caster) {
      this->Core.check(stratus_ray_caster_create(this->Core, &caster), "ray caster");
    }
    inputs[i].caster = caster;
    inputs[i].volume = volumes[i];
    inputs[i].transfer = &view;
    inputs[i].options = &cast;
  }
  this->Core.check(
    stratus_ray_caster_render_blocks(inputs.data(), static_cast<int>(inputs.size()), &this->Camera, &image, reports.data()), "render");
  // The block with the most samples tells the reasons, all of them add up to the counts.
  const auto busiest = std::max_element(reports.begin(), reports.end(),
    [](const stratus_ray_cast_report& a, const stratus_ray_cast_report& b) { return a.samples < b.samples; });
  this->Report = *busiest;
  for (auto r = reports.begin(); r != reports.end(); ++r) {
    if (r != busiest) {
      stratus_ray_cast_report_add(&this->Report, &*r);
    }
  }
}

// Crop and mask are the first volume's alone.
void volume_drawing::draw_several(const stratus_ray_cast_options& cast, const stratus_image& image)
{
  const size_t count = 1 + this->More.size();
  stratus_ray_cast_options plain = cast;
  plain.crop = 0;
  plain.mask = nullptr;
  std::vector<stratus_transfer> views = { this->Transfer.view() };
  for (const member& more : this->More) {
    views.push_back(more.functions.view());
  }
  std::vector<stratus_ray_cast_input> inputs(count);
  for (size_t n = 0; n < count; ++n) {
    member* more = n > 0 ? &this->More[n - 1] : nullptr;
    inputs[n].transfer = &views[n];
    if (more && more->mesh) {
      more->how = stratus_tetra_options_default();
      more->how.tolerance = this->Options.tolerance;
      inputs[n].tetra = more->tetra;
      inputs[n].mesh = &more->mesh->view();
      inputs[n].tetra_options = &more->how;
    } else {
      inputs[n].caster = more ? more->caster : this->Caster;
      inputs[n].volume = more ? &more->input->volume : &this->Input->volume;
      inputs[n].options = more ? &plain : &cast;
    }
  }
  std::vector<stratus_ray_cast_report> reports(count);
  this->Core.check(
    stratus_ray_caster_render_several(inputs.data(), static_cast<int>(count), &this->Camera, &image, reports.data()), "render");
  this->Report = reports[0];
  for (size_t n = 1; n < count; ++n) {
    this->More[n - 1].report = reports[n];
  }
}

void volume_drawing::tell() const
{
  for (const member& more : this->More) {
    row("with",
      more.o.source + ": " +
        (more.mesh ? cli::grouped(static_cast<unsigned long long>(more.mesh->points)) + " points, array '" + more.mesh->array_name + "'"
                   : cli::describe(more.input->volume) + ", array '" + more.input->array_name + "'"));
    row("opacity", more.functions.origin);
    row("why", more.report.why);
  }
  row("volume",
    (this->Blocks.empty() ? "" : std::to_string(1 + this->Blocks.size()) + " blocks, the first of ") + cli::describe(this->Input->volume) +
      ", array '" + this->Input->array_name + "'");
  row("camera", cli::describe(this->Camera));
  this->tell_report();
}

void volume_drawing::tell_report() const
{
  const cli::options& o = this->Options;
  const stratus_ray_cast_report& r = this->Report;
  const double build = r.range_ms + r.table_ms + r.occupancy_ms + r.structure_ms + r.probe_ms + r.upload_ms;
  const double segments = static_cast<double>(r.samples) + static_cast<double>(r.skipped);
  row("opacity", this->Transfer.origin);
  row("device", stratus_context_device(this->Core));
  row(
    "structure", cli::format("%s (%s KiB)", stratus_structure_name(r.structure), cli::grouped((r.structure_bytes + 1023) / 1024).c_str()));
  row("mode", stratus_mode_name(o.mode));
  if (o.mode != STRATUS_MODE_FIRST_HIT && o.mode != STRATUS_MODE_ISOSURFACE && o.mode != STRATUS_MODE_SLICE) {
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

void volume_drawing::judge() const
{
  if (this->Options.audit && this->Report.differing_pixels > 0) {
    throw cli::failure("audit: skipping changed " + cli::grouped(this->Report.differing_pixels) + " pixels");
  }
}
} // namespace

std::unique_ptr<cli::drawing> cli::make_volume_drawing(const options& o, context& core)
{
  return std::make_unique<volume_drawing>(o, core);
}
