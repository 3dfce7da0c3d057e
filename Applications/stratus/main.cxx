// SPDX-License-Identifier: BSD-3-Clause
// The command line draws a volume to a picture file. `stratus --help` describes it.
#include "annotation.h"
#include "colors.h"
#include "compare.h"
#include "grid.h"
#include "habits.h"
#include "heights.h"
#include "input.h"
#include "json.h"
#include "options.h"
#include "reading.h"
#include "render.h"
#include "series.h"
#include "sort.h"
#include "transfer.h"
#include "tree.h"

#include <vtkBoundingBox.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkLogger.h>
#include <vtkPointData.h>
#include <vtkVersion.h>

#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <sys/resource.h>
#include <vector>

namespace {

using cli::row;

void list_arrays(vtkDataSet* image)
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

// blocks: those that are drawn with `in` as one volume.
void print_volume(
  const cli::options& o, cli::context& core, const cli::input& in, const std::vector<std::unique_ptr<cli::input>>& blocks = {})
{
  cli::look_input all;
  all.volumes.push_back(in.volume);
  for (const auto& block : blocks) {
    all.volumes.push_back(block->volume);
  }
  vtkBoundingBox box;
  double bounds[6];
  for (const stratus_volume& volume : all.volumes) {
    core.check(stratus_volume_bounds(core, &volume, bounds), "bounds");
    box.AddBounds(bounds);
  }
  box.GetBounds(bounds);
  const stratus_look_values h = cli::count_values(core, all);
  row("volume", (blocks.empty() ? "" : "the first block of ") + cli::describe(in.volume));
  row("origin", cli::format("%.10g %.10g %.10g", in.volume.origin[0], in.volume.origin[1], in.volume.origin[2]),
    { in.volume.origin[0], in.volume.origin[1], in.volume.origin[2] });
  row("bounds",
    cli::format("%.10g .. %.10g, %.10g .. %.10g, %.10g .. %.10g", bounds[0], bounds[1], bounds[2], bounds[3], bounds[4], bounds[5]),
    std::vector<double>(bounds, bounds + 6));
  row("memory",
    cli::format("%.1f MiB of values", (h.finite + h.not_finite) * static_cast<double>(stratus_type_size(in.volume.type)) / 1048576.0));
  if (in.image) {
    list_arrays(in.image);
  }
  row("drawn", "'" + in.array_name + "'");
  if (h.finite > 0.0) {
    row("range", cli::format("%.9g .. %.9g", h.low, h.high), { h.low, h.high });
  }
  row("not finite", cli::grouped(static_cast<unsigned long long>(h.not_finite)) + " values", { h.not_finite });
  row("opacity", cli::make_transfer(core, all, in.scene, o).origin);
}

void print_time(const cli::series& in)
{
  const size_t shown = 5;
  const std::vector<double>& times = in.times();
  if (times.empty()) {
    return;
  }
  std::string text = cli::grouped(times.size()) + " step" + (times.size() == 1 ? "" : "s") + ":";
  for (size_t i = 0; i < times.size(); ++i) {
    if (i < shown || i + 1 == times.size()) {
      text += cli::format(" %.9g", times[i]);
    } else if (i == shown) {
      text += " ...";
    }
  }
  row("time", text + (in.units().empty() ? "" : " " + in.units()), times);
}

void info(const cli::options& given)
{
  cli::options o = given;
  if (cli::is_scene(o.source)) {
    cli::context core("host", o.threads);
    const cli::input in(core, o.source, o.reading());
    cli::heading(o.source);
    print_volume(o, core, in);
    return;
  }
  cli::series in(o.source, o.reading());
  const size_t step = in.find(o.time);
  const std::vector<cli::variable_entry> variables = in.variables(step); // before the step, because the reader's output is one object
  const cli::routed data = cli::route(in.read(step), o.source, o.array);
  cli::set_heights(o, &in, data.image ? data.image : data.grid);
  cli::context core("host", o.threads);
  const std::unique_ptr<cli::input> image(data.image ? new cli::input(core, o.source, data.image, o.array) : nullptr);
  cli::heading(o.source);
  row("kind", data.kind + (image ? ", drawn by rays through its cells" : ", drawn as tetrahedra"));
  if (!data.arrays.empty()) {
    row("arrays", data.arrays);
  }
  if (!in.grid().empty()) {
    row("coordinates", in.grid());
  }
  if (o.about.earth) {
    row("axes", cli::describe_axes(o, (data.image ? data.image : data.grid)->GetBounds()));
  }
  print_time(in);
  if (in.steps() > 1) {
    row("", "shown: " + in.describe(step));
  }
  for (const cli::variable_entry& one : variables) {
    row("variable",
      "'" + one.name + "'" + (one.units.empty() ? "" : " in " + one.units) + (one.long_name.empty() ? "" : ", " + one.long_name) + ", " +
        (one.low <= one.high ? cli::format("%.9g .. %.9g", one.low, one.high) : "nothing finite"),
      one.low <= one.high ? std::vector<double>{ one.low, one.high } : std::vector<double>());
  }
  if (!in.choice().empty()) {
    row("", "drawn: " + in.choice());
  }
  if (image) {
    std::vector<std::unique_ptr<cli::input>> blocks;
    for (const auto& block : data.blocks) {
      blocks.push_back(std::make_unique<cli::input>(core, o.source, block, o.array));
    }
    print_volume(o, core, *image, blocks);
  } else {
    cli::print_grid(o, data.grid);
  }
}

// Each OpenCL device with its number.
std::vector<std::string> device_names()
{
  std::vector<std::string> names;
  for (int i = 0; i < stratus_device_count(); ++i) {
    char name[256];
    stratus_device_name(i, name, sizeof name);
    names.push_back(cli::format("%d  %s", i, name));
  }
  return names;
}

void devices()
{
  const std::vector<std::string> names = device_names();
  for (const std::string& name : names) {
    std::printf("%s\n", name.c_str());
  }
  if (names.empty()) {
    std::printf("no OpenCL device; the host draws\n");
  }
}

void version()
{
  std::printf("stratus %s\n", stratus_version());
  row("VTK", vtkVersion::GetVTKVersion());
  std::string formats;
#ifdef STRATUS_EXR
  formats += ", OpenEXR";
#endif
#ifdef STRATUS_NETCDF
  formats += ", netCDF";
#endif
#ifdef STRATUS_VDB
  formats += ", OpenVDB or NanoVDB";
#endif
  row("built with", formats.empty() ? "only VTK's own file formats" : formats.substr(2));
  const cli::context core("host", 0);
  row("host", stratus_context_device(core));
  const std::vector<std::string> names = device_names();
  for (const std::string& name : names) {
    row("OpenCL", name);
  }
  if (names.empty()) {
    row("OpenCL", "no device");
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

// Returns false for pictures that differ.
bool run(const cli::options& o)
{
  bool alike = true;
  check_stack();
  const bool only_json = o.json == "-"; // on the standard output
  if (o.quiet || only_json) {
    cli::silence(!only_json);
  }
  cli::set_read_timeout(o.read_timeout);
  cli::set_memory(o.memory);
  if (o.command == "render") {
    cli::render(o);
  } else if (o.command == "info") {
    info(o);
    if (!o.json.empty()) {
      cli::write_json(o.json, cli::json_of_rows(o.source));
    }
  } else if (o.command == "tree") {
    cli::print_tree(o);
  } else if (o.command == "sort") {
    cli::print_sort(o);
  } else if (o.command == "compare") {
    alike = cli::compare(o);
  } else if (o.command == "devices") {
    devices();
  } else if (o.command == "colors") {
    std::printf("%s\n", cli::color_names("\n").c_str());
  } else if (o.command == "version") {
    version();
  } else if (o.command == "completion") {
    std::fputs(cli::completion(o.source).c_str(), stdout);
  } else {
    std::fputs((o.topical ? cli::help_about(o.source) : cli::help()).c_str(), stdout);
  }
  if (std::fflush(stdout) != 0) {
    throw cli::failure("cannot write to the standard output");
  }
  return alike;
}
} // namespace

int main(int argc, char* argv[])
{
  // VTK's messages are reported as an exception's text, so VTK itself must not print them.
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  try {
    return run(cli::parse(argc, argv)) ? 0 : 1;
  } catch (const cli::usage& error) {
    std::fprintf(stderr, "stratus: %s\nstratus: see --help\n", error.what());
    return 2;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "stratus: out of memory\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stratus: %s\n", error.what());
  }
  return 1;
}
