// SPDX-License-Identifier: BSD-3-Clause
// `stratus render`: opens a file, chooses how its data are drawn, and draws one step or all. The next step is read while one is drawn.
#include "render.h"

#include "casting.h"
#include "cloud.h"
#include "drawing.h"
#include "frame.h"
#include "heights.h"
#include "input.h"
#include "series.h"
#include "sun.h"

#include "vtkStratusMetres.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <future>
#include <sys/resource.h>
#include <unistd.h>

namespace {

using cli::row;

// Converts a step's data to the grids that the options need. `water` is null without --cloud.
cli::routed route_for(vtkDataObject* data, size_t step, const cli::options& o, const cli::cloud* water)
{
  const bool hits = o.mode == STRATUS_MODE_FIRST_HIT, lit = hits ? o.normals == STRATUS_NORMALS_GRADIENT : o.shade || o.scatter;
  cli::routed routed = cli::route(data, o.source, o.array, o.nearest || hits, lit);
  if (water) {
    water->convert(routed, step);
  }
  return routed;
}

// Sets what --cloud, --sun-time and defaults of the Earth's data find out from the data. Returns a line about the sun, or "".
std::string set_by_data(
  cli::options& o, const cli::options& given, const cli::routed& data, const cli::series* in, size_t step, const cli::cloud* water)
{
  vtkDataSet* const grid = data.image ? data.image : data.grid;
  if (water) {
    water->set_function(o, grid);
  }
  cli::set_heights(o, in, grid);
  cli::set_planes(o, given);
  const bool is_map = o.about.axes[0].kind == STRATUS_AXIS_LONGITUDE && o.about.axes[1].kind == STRATUS_AXIS_LATITUDE;
  if (o.coast && !o.globe && !is_map && !o.about.place) {
    throw cli::usage("--coast: " +
      (!o.about.why_no_place.empty()
          ? o.about.why_no_place
          : "'" + o.source + "' has no longitudes and latitudes along x and y, and no grid mapping, as netCDF files may have"));
  }
  return cli::set_sun(o, given, in, grid, step);
}

// Reads a step and keeps it when the reader reads the next one, in another thread: other readers than ours may write that over its arrays.
cli::routed read_apart(cli::series& in, size_t step, const cli::options& o, const cli::cloud* water)
{
  const vtkSmartPointer<vtkDataObject> shared = in.read(step);
  const auto own = vtkSmartPointer<vtkDataObject>::Take(shared->NewInstance());
  in.makes_new_arrays() ? own->ShallowCopy(shared) : own->DeepCopy(shared);
  return route_for(own, step, o, water);
}

// Draws the requested annotations around the volume.
void annotate(
  const cli::context& core, cli::frame& frame, const cli::options& o, const cli::drawing& drawing, const cli::series* in, size_t step)
{
  frame.annotate(core, cli::annotation(o), drawing.place(), drawing.functions(), in ? in->time_of(step) : "");
}

// Of several INPUTs, whose values may have several units, only lengths have one.
void set_units(cli::frame& frame, const cli::drawing& drawing, const cli::routed& data, const cli::series* in, const cli::options& o)
{
  vtkDataSet* set = data.image ? data.image : data.grid;
  frame.set_units(drawing.place().scale, vtkStratusMetresPerUnit(set), in && o.companions.empty() ? in->value_units() : "");
}

std::unique_ptr<cli::drawing> drawing_of(const cli::options& o, cli::context& core, const cli::routed& data)
{
  if (!o.companions.empty()) {
    return cli::make_several_drawing(o, core);
  }
  return data.grid ? cli::make_grid_drawing(o, core) : cli::make_volume_drawing(o, core);
}

// Prints which variable is drawn, on which grid. `in` is null for a scene.
void print_reading(const cli::options& o, const cli::series* in, const cli::cloud* water, const std::string& sun)
{
  if (in && !in->choice().empty()) {
    row("variable", in->choice());
  }
  if (in && !in->grid().empty()) {
    row("coordinates", in->grid());
  }
  if (!o.heights.empty()) {
    row("heights",
      o.globe ? o.heights.substr(o.heights.find('x')) + " on the globe; --exaggerate 1 for true heights"
              : cli::format(
                  o.has_exaggeration ? "x %.15g, by --exaggerate" : "x %.15g, because the data are flat; --exaggerate 1 for true heights",
                  o.exaggeration));
  }
  if (water) {
    water->print_rows();
  }
  if (!sun.empty()) {
    row("sun", sun);
  }
}

void warn_of_nothing(const cli::options& o, const cli::drawing& drawing)
{
  const cli::transfer& functions = drawing.functions();
  const std::vector<double>& opacity = functions.opacity; // values beyond its ends have the opacity of the ends
  const std::pair<double, double> values = drawing.range();
  bool all_zero = true;
  for (size_t i = 1; i < opacity.size(); i += 2) {
    all_zero = all_zero && opacity[i] <= 0.0;
  }
  const bool misses = o.mode == STRATUS_MODE_ISOSURFACE &&
    std::none_of(o.contours.begin(), o.contours.end(), [&values](double c) { return c >= values.first && c <= values.second; });
  std::string reason =
    cli::format("no ray meets a value that shows, or opacities are too low for a length of %.6g", functions.unit_distance);
  if (all_zero) {
    reason = "the opacity is 0 for every value";
  } else if (misses) {
    reason = "no contour is within the values";
  } else if (opacity[1] <= 0.0 && opacity.back() <= 0.0) {
    double low = 0.0, high = 0.0;
    functions.shown(low, high);
    reason = cli::format("the opacity, for a length of %.6g, is above 0 only in %.6g .. %.6g", functions.unit_distance, low, high);
  }
  std::fprintf(stderr, "stratus: warning: the picture shows nothing: %s, and the values are in %.6g .. %.6g\n", reason.c_str(),
    values.first, values.second);
}

// `in` is null for a scene.
void render_one(const cli::options& given, const cli::routed& data, const cli::series* in, size_t step, const cli::cloud* water)
{
  cli::options o = given;
  const std::string sun = set_by_data(o, given, data, in, step, water);
  const std::string time = in ? in->describe(step) : "";
  cli::context core(o.path ? "host" : o.device, o.threads);
  cli::frame frame(o);
  const std::unique_ptr<cli::drawing> drawing = drawing_of(o, core, data);
  drawing->take(data);
  drawing->look();
  cli::output_file out(o.output); // before the work, so that a path that cannot be written is reported at once
  const stratus_image image = frame.view();
  drawing->draw(image);
  if (frame.shows_nothing()) {
    warn_of_nothing(o, *drawing);
  }
  if (frame.has_numbers()) {
    set_units(frame, *drawing, data, in, o);
    drawing->measure(frame.numbers());
  }
  annotate(core, frame, o, *drawing, in, step);
  std::printf("%s\n", o.source.c_str());
  print_reading(o, in, water, sun);
  if (!time.empty()) {
    row("time", time);
  }
  drawing->print_rows();
  if (image.samples) {
    row("a pixel", frame.describe_samples());
  }
  for (const std::string& line : frame.describe_numbers()) {
    row("quantity", line);
  }
  if (o.report) {
    core.print_build_report();
  }
  frame.write(core, out);
  row("picture", o.output);
  drawing->judge();
}

std::string frame_name(const std::string& pattern, size_t number)
{
  char name[4096];
  std::snprintf(name, sizeof name, pattern.c_str(), static_cast<int>(number)); // parse() has checked that it has one %d
  return name;
}

// Takes the one of the first, middle and last step whose values range widest, and looks at it: a field often starts as one value.
void look_at_widest(cli::drawing& drawing, cli::series& in, const cli::options& o, const cli::cloud* water)
{
  const size_t candidates[] = { 0, in.steps() / 2, in.steps() - 1 };
  size_t best = 0;
  double widest = -1.0;
  for (size_t i = 0; i < 3; ++i) {
    if (i > 0 && candidates[i] == candidates[i - 1]) {
      continue;
    }
    drawing.take(read_apart(in, candidates[i], o, water));
    const std::pair<double, double> range = drawing.range();
    if (range.second - range.first > widest) {
      widest = range.second - range.first;
      best = candidates[i];
    }
  }
  drawing.take(read_apart(in, best, o, water));
  drawing.look();
  row("functions", "and camera by " + in.describe(best));
}

// A bar with the time left on a terminal, else a line for each frame.
class film_progress
{
public:
  explicit film_progress(size_t all) : All(all), Terminal(cli::shows_progress()) {}
  ~film_progress()
  {
    if (this->Terminal) {
      std::fprintf(stderr, "\r\033[K");
    }
  }
  film_progress(const film_progress&) = delete;
  film_progress& operator=(const film_progress&) = delete;

  void done(size_t count, const std::string& file, const std::string& time)
  {
    const double passed = std::chrono::duration<double>(std::chrono::steady_clock::now() - this->Start).count();
    const long left = std::lround(passed / static_cast<double>(count) * static_cast<double>(this->All - count));
    if (this->Terminal) {
      const int filled = static_cast<int>(40 * count / this->All);
      std::fprintf(stderr, "\r\033[K[%s%s] frame %zu of %zu, %ld:%02ld:%02ld left", std::string(static_cast<size_t>(filled), '#').c_str(),
        std::string(static_cast<size_t>(40 - filled), '.').c_str(), count, this->All, left / 3600, left / 60 % 60, left % 60);
    } else {
      row("frame", file + (time.empty() ? "" : ", " + time) + cli::format(", %ld s left", left));
      std::fflush(stdout);
    }
  }

private:
  size_t All;
  bool Terminal;
  std::chrono::steady_clock::time_point Start = std::chrono::steady_clock::now();
};

void render_film(const cli::options& given, cli::series& in, const cli::cloud* water)
{
  cli::options o = given;
  cli::context core(o.path ? "host" : o.device, o.threads);
  core.quiet();
  cli::frame frame(o);
  {
    cli::output_file first(frame_name(o.frames, 0));
  } // a path that cannot be written is reported at once
  std::printf("%s\n", o.source.c_str());
  cli::routed data = read_apart(in, 0, o, water);
  const std::string sun = set_by_data(o, given, data, &in, 0, water);
  print_reading(o, &in, water, sun);
  const std::unique_ptr<cli::drawing> drawing = drawing_of(o, core, data);
  look_at_widest(*drawing, in, o, water);
  const stratus_image image = frame.view();
  {
    film_progress progress(in.steps());
    for (size_t step = 0; step < in.steps(); ++step) {
      std::future<cli::routed> next;
      if (step + 1 < in.steps()) {
        // bricks of the next step are read ahead by threads of their own, as long as the reader shows this one
        next = std::async(in.reads_ahead() ? std::launch::deferred : std::launch::async,
          [&in, &given, water, step] { return read_apart(in, step + 1, given, water); });
      }
      cli::set_sun(o, given, &in, data.image ? data.image : data.grid, step); // which moves
      drawing->take(data);
      drawing->draw(image);
      if (frame.has_numbers()) {
        set_units(frame, *drawing, data, &in, o);
        drawing->measure(frame.numbers());
      }
      annotate(core, frame, o, *drawing, &in, step);
      cli::output_file out(frame_name(o.frames, step));
      frame.write(core, out);
      drawing->judge();
      progress.done(step + 1, frame_name(o.frames, step), in.describe(step));
      if (next.valid()) {
        data = next.get();
      }
    }
  }
  drawing->print_rows();
  row("frames", cli::grouped(in.steps()) + ", " + o.frames);
  struct rusage used;
  if (getrusage(RUSAGE_SELF, &used) == 0) {
    row("memory", cli::format("%.1f MiB resident at most", static_cast<double>(used.ru_maxrss) / 1024.0));
  }
}
} // namespace

void cli::render(const options& given)
{
  options o = given;
  std::unique_ptr<cloud> water;
  if (o.globe && (is_scene(o.source) || !o.companions.empty())) {
    throw usage(
      is_scene(o.source) ? "--globe: only netCDF and Zarr have longitudes and latitudes" : "--globe shows one INPUT: leave out the others");
  }
  if (is_scene(o.source)) {
    if (!o.time.empty() || !o.frames.empty()) {
      throw usage("'" + o.source + "' is a scene, which has no time: leave out " + (o.time.empty() ? "--frames" : "--time"));
    }
    water = o.cloud ? std::make_unique<cloud>(o, nullptr) : nullptr;
    render_one(o, routed(), nullptr, 0, water.get());
    return;
  }
  if (o.cloud) {
    o.array = find_cloud_water(series(o.source, o.reading()), o);
  }
  series in(o.source, o.reading());
  water = o.cloud ? std::make_unique<cloud>(o, &in) : nullptr;
  if (!o.frames.empty()) {
    render_film(o, in, water.get());
    return;
  }
  const size_t step = in.find(o.time);
  render_one(o, route_for(in.read(step), step, o, water.get()), &in, step, water.get());
}
