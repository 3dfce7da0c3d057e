// SPDX-License-Identifier: BSD-3-Clause
// Declarations that the parts of stratus-bench share.
#pragma once

#include "stratus.h"

#include <vtkImageData.h>
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
  stratus_volume volume; // borrows the image's values
  transfer first, edited;
  std::vector<transfer> others; // of all components but the first
  bool shaded = false;          // lit by a headlight, in the default material of vtkVolumeProperty
  int up_axis = 2;
  double bounds[6];
  double voxel = 1.0; // a voxel's shortest edge in the world
  std::shared_ptr<void> memory;
};

// Makes a built-in scene, cloud-N (the cloud resampled to N x N/2 x N over the same space), or the scene of a file, named by its stem. The
// suffix "+shade" lights it.
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
  double samples = -1.0; // per frame; -1: unknown
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

inline double now_ms()
{
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}
double median(std::vector<double> values);

// ---- methods.cxx, floor.cxx

std::vector<std::string> all_methods();
void check_method(const std::string& name); // throws failure
// Whether a method's tolerance is the error of vtk:fixedpoint, which has to be measured first.
bool needs_fixed_point(const std::string& method);
result run_method(stratus_context* context, const scene& s, const std::string& method, int size, double fixed_point_error);
floor_result run_floor(stratus_context* context, const scene& s, int size);

// ---- cache.cxx

// Makes a folder and its parents, unless they exist or the name is empty. Call it before measuring: a reference takes minutes, and must not
// be lost because its folder is missing.
void make_folder(const std::string& folder);
// Returns false if there is no such file, or if its number of floats differs.
bool load_picture(const std::string& path, std::vector<float>& rgba);
void save_picture(const std::string& path, const std::vector<float>& rgba); // writes the whole file or none

// ---- judge.cxx

// The reference pictures of one scene, which are refined as far as the results that they are compared with ask for.
class judge
{
public:
  judge(stratus_context* context, const scene& s, int size, const std::string& cache);
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
void write_origin(std::FILE* file, const origin& o);
void read_origin(const std::string& line, std::vector<origin>& origins); // a row before the header
// Replaces the rows of the scenes that this run measured, and keeps those of other scenes before them.
void replace_scenes(table& t, const std::vector<row>& rows);
void add_rows(const result& r, std::vector<row>& rows);
void add_rows(const std::string& scene, const floor_result& f, std::vector<row>& rows);
// path "-": the standard output; benchmark: the first column. The rows' origin comes before the header.
void write_csv(const std::string& path, const std::vector<row>& rows, const char* benchmark = "volume");
// Writes a table that also holds rows of earlier runs.
void write_csv(const std::string& path, const table& t, const char* benchmark);
// Returns a table without rows if there is no such file.
table read_csv(const std::string& path);
void print_table(const std::vector<row>& rows);
// Charts frame time against error, both logarithmic: one chart per scene, one mark per method.
void write_chart(const std::string& path, const std::vector<row>& rows);
struct chart_mark {
  std::string scene, method;
  double x, y; // > 0
};
void write_chart(const std::string& path, const std::vector<chart_mark>& marks, const char* x_title, const char* y_title);

// ---- volume.cxx
int volume_main(int argc, char* argv[]);

// ---- main.cxx: restarts the program under xvfb-run if there is no display
void ensure_display(char* argv[]);
} // namespace bench
