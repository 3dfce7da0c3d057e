// SPDX-License-Identifier: BSD-3-Clause
// Declarations that the parts of stratus-bench share.
#pragma once

#include "stratus.h"

#include <vtkImageData.h>
#include <vtkRectilinearGrid.h>
#include <vtkSmartPointer.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace bench {

constexpr int views = 8; // number of cameras of a scene

struct failure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// ---- scenes.cxx

struct transfer {
  std::vector<double> opacity; // (value, opacity) pairs
  std::vector<double> color;   // (value, red, green, blue) quadruples
  double unit_distance = 1.0;
  stratus_transfer view() const;
};

struct scene {
  std::string name;
  vtkSmartPointer<vtkImageData> image;
  // A rectilinear grid, which Stratus draws; then `image` is vtkResampleToImage's image of it, for peers. nullptr: none.
  vtkSmartPointer<vtkRectilinearGrid> grid;
  double resample_ms = 0.0; // what that took
  stratus_volume volume;    // borrows the values of the image, or of the grid
  transfer first, edited;
  std::vector<transfer> others; // of all components but the first
  bool shaded = false;          // lit by a headlight, in the default material of vtkVolumeProperty
  int up_axis = 2;
  double bounds[6];
  double voxel = 1.0; // a voxel's shortest edge in the world
  std::shared_ptr<void> memory;
};

// Makes a built-in scene, cloud-N (the cloud resampled to N x N/2 x N over the same space), cumulus-rectilinear:K (peers draw an image of K
// times as many cells along stretched axes), or the scene of a file, named by its stem. The suffix "+shade" lights it.
scene make_scene(stratus_context* context, const std::string& source);
// Returns the transfer functions of all components.
std::vector<stratus_transfer> transfers_of(const scene& s);
// Returns the light and material of a lit scene for a camera.
stratus_shading shading_of(const stratus_camera& camera);
stratus_camera camera_of(stratus_context* context, const scene& s, int view);

// ---- a method's pictures and times of a scene's views

struct picture {
  std::vector<float> rgba;    // premultiplied; empty if the method has no float picture
  std::vector<uint8_t> bytes; // RGBA of the window
};

struct timing {
  double first_ms = 0.0;
  double frame_ms = 0.0;
  double update_ms = 0.0;
  double samples = -1.0;      // per frame; -1: unknown
  std::vector<double> frames; // ms of each view, whose median is frame_ms
  std::string device;
};

struct result {
  std::string scene, method;
  timing time;
  std::vector<picture> pictures; // one per view
  bool judged = true;            // false: the window shows more than the volume, so that only times are compared
  double psnr_db = 0.0, psnr8_db = 0.0, max_error = 0.0, reference_db = 0.0;
  double differing_pixels = -1.0; // -1: not compared
  double tolerance = -1.0;        // that the method was given; -1: it knows none
};

struct floor_result {
  double ms = 0.0, samples = 0.0, rate = 0.0;
};

// How much of a method is measured.
struct effort {
  int size = 512;      // of the window, in pixels each way
  int repeats = 7;     // most frames of each view, see settled()
  bool updates = true; // whether transfer functions are changed, too
};

inline double now_ms()
{
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}
double median(std::vector<double> values);
// Whether repeated times suffice: the middle half of two or more is within 3 % of their median, they took .15 s, or there are `most`.
bool settled(const std::vector<double>& ms, int most);

// ---- methods.cxx, floor.cxx

std::vector<std::string> all_methods();
void check_method(const std::string& name); // throws failure
// Whether a method's tolerance is the error of vtk:fixedpoint, which has to be measured first.
bool needs_fixed_point(const std::string& method);
result run_method(stratus_context* context, const scene& s, const std::string& method, const effort& how, double fixed_point_error);
// Every method at several settings of its own: tolerances, or steps.
std::vector<std::string> curve_methods(bool quick);
floor_result run_floor(stratus_context* context, const scene& s, int size);

// ---- cache.cxx

// Makes a folder and its parents, unless they exist or the name is empty. Call it before measuring: a reference takes minutes, and must not
// be lost because its folder is missing.
void make_folder(const std::string& folder);
// The folder for references where none is named: `references` in the library's cache folder; empty where there is none.
std::string default_reference_cache();
// Returns false if there is no such file, or if its number of floats differs.
bool load_picture(const std::string& path, std::vector<float>& rgba);
void save_picture(const std::string& path, const std::vector<float>& rgba);

class progress;

// ---- judge.cxx

uint64_t hash_bytes(uint64_t hash, const void* data, size_t bytes);
// Hashes everything that determines the reference's picture, except light, view, size, tile and step. The reference's own sources count, so
// that a cache holds no picture of an earlier one.
uint64_t hash_of(const scene& s);

// The reference pictures of one scene, refined until they are precise enough for the compared results. They are drawn at one pixel of each
// tile, if enough of these pixels show something.
class judge
{
public:
  judge(stratus_context* context, const scene& s, const effort& how, const std::string& cache, const progress& shown);
  ~judge();
  void measure(std::vector<result>& results); // fills errors
  void compare(std::vector<result>& results); // fills differing_pixels

private:
  struct state;
  std::unique_ptr<state> State;
};

// ---- report.cxx, chart.cxx, origin.cxx

struct row {
  std::string scene, method, metric, unit;
  double value;
};
// The machine, compiler and commit that measured some scenes. In a CSV they are rows before the header, `# name,value`.
struct origin {
  std::string processor = "unknown", cores = "unknown", compiler = "unknown", commit = "unknown", date = "unknown";
  std::vector<std::string> scenes;
};
struct table {
  std::vector<origin> origins; // each scene is in exactly one of them
  std::vector<row> rows;
};
origin origin_of_this_run(); // without scenes
void write_origin(std::ostream& out, const origin& o);
void read_origin(const std::string& line, std::vector<origin>& origins); // a row before the header
// Replaces the rows of the scenes that this run measured, and keeps other scenes' rows before them.
void replace_scenes(table& t, const std::vector<row>& rows);
std::vector<std::string> split(const std::string& text); // at commas
// Rows of single measurements, METRIC/0, METRIC/1 and so on, by which runs are compared.
void add_repeats(const std::string& scene, const std::string& method, const std::string& metric, const char* unit,
  const std::vector<double>& values, std::vector<row>& rows);
// Reports a method that cannot be measured, and adds the row `failed`. The run goes on, and its exit status is 1.
void add_failure(const std::string& scene, const std::string& method, const char* why, std::vector<row>& rows);
bool any_failed(const std::vector<row>& rows);
void add_rows(const result& r, std::vector<row>& rows);
void add_rows(const std::string& scene, const floor_result& f, std::vector<row>& rows);
// Replaces a file whole, so that what it holds outlives a run that is interrupted; a device or a pipe is written in place.
void save_file(const std::string& path, const void* bytes, size_t size);
// Writes the rows of this run; append: the file's rows of other scenes stay.
void save_rows(const std::string& path, const std::vector<row>& rows, const char* benchmark, bool append);
// path "-": the standard output; benchmark: the first column. The rows' origins come before the header.
void write_csv(const std::string& path, const table& t, const char* benchmark);
// Throws failure if a table could not be written there. Call it before measuring.
void check_writable(const std::string& path);
// Returns a table without rows if there is no such file.
table read_csv(const std::string& path);
void print_table(const std::vector<row>& rows);

// ---- curves.cxx: the curves of a part's charts

// A method at one setting.
struct curve_point {
  std::string scene, method;
  double x, y; // > 0; less is better
};
// All points of a part of the bench, and its axes' titles.
struct curves {
  std::string title, x_title, y_title;
  std::string beats;    // a sentence: how a point is better by both axes
  std::string compared; // how a point of ours is compared with a peer's
  std::vector<curve_point> points;
  double exact; // the y of points without any error: the lower edge of the chart
};
// Returns the method without its setting: a method's settings share one curve.
std::string family_of(const std::string& method);
bool is_ours(const std::string& method);
// The curves of a part: volume, light, tetra, tree (two: primary and random rays), distance, octree.
std::vector<curves> curves_of(const std::string& part, const std::vector<row>& rows);
// The parts that stratus-bench all runs, in their order.
const std::vector<std::string>& parts_of_all();
std::vector<std::string> scenes_of(const curves& c);
// A peer's point, and the point of ours that is faster and more exact by most; without one `by` is nullptr. Where the peer has no error at
// all, one without error counts.
struct dominance {
  const curve_point* peer;
  const curve_point* by;
};
std::vector<dominance> dominance_of(const curves& c, const std::string& scene);
// One sentence about the chart of a scene.
std::string sentence_of(const curves& c, const std::string& scene);

// ---- chart.cxx

// Charts all scenes in one picture, both axes logarithmic.
void write_chart(const std::string& path, const curves& c);
// Charts one scene as STEM.png and STEM.svg, in a size for a page.
void write_scene_chart(const std::string& stem, const curves& c, const std::string& scene);
// The colour of a family's line, as #rrggbb.
std::string color_of(const std::string& family);

// ---- progress.cxx

// Prints the run's progress on the standard error: one line that is overwritten on a terminal, otherwise one line a scene.
class progress
{
public:
  progress(size_t scenes, size_t methods);
  ~progress();
  void at(const std::string& scene, const std::string& method);       // the next measurement
  void show(const std::string& scene, const std::string& what) const; // what: the current work
  void end_scene(const std::string& scene);

private:
  void clear() const;
  size_t Scenes, Methods, Scene = 0, Method = 0;
  double Start, SceneStart;
  std::FILE* Terminal;
};
std::string duration(double ms); // "2:05 min"

// ---- volume.cxx, all.cxx, compare.cxx
int volume_main(int argc, char* argv[]);
int all_main(int argc, char* argv[]);
int compare_main(int argc, char* argv[]);
// ---- page.cxx: charts and index.html of the tables in a folder
void write_page(const std::string& folder, const std::vector<std::string>& failures);

// ---- main.cxx: restarts the program under xvfb-run if there is no display
void ensure_display(char* argv[]);
} // namespace bench
