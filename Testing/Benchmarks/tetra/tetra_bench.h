// SPDX-License-Identifier: BSD-3-Clause
// Declarations that the parts of stratus-bench tetra share: meshes, views, stretches of rays in cells, the judge, and the sorters.
#pragma once

#include "bench.h"

#include <vtkAbstractVolumeMapper.h>
#include <vtkUnstructuredGrid.h>

#include <atomic>
#include <functional>
#include <map>

namespace bench {

int tetra_main(int argc, char* argv[]);

// ---- tetra_meshes.cxx

struct tetra_mesh {
  std::string name;
  vtkSmartPointer<vtkUnstructuredGrid> grid; // tetrahedra with point scalars
  std::vector<double> points;                // the same in the core's form
  std::vector<int32_t> vertices;
  std::vector<float> values;
  double bounds[6];
  stratus_mesh view() const;
};
// Makes bluntfin, post (of ../shared/data), holes, wavelet, or the mesh of a file. cache: a folder that keeps TetGen's meshes, or empty.
// Returns false, with the reason on the standard error, if a built-in mesh is not available here.
bool make_tetra_mesh(stratus_context* context, const std::string& source, const std::string& cache, tetra_mesh& mesh);
// Names of transfer functions over the mesh's values: ramp, peaks, opaque.
const std::vector<std::string>& tetra_functions();
transfer tetra_transfer(const tetra_mesh& mesh, const std::string& function);
// Returns the 24 cameras for which orders are checked: 6 directions x parallel, perspective, near, inside.
std::vector<stratus_camera> order_cameras(stratus_context* context, const tetra_mesh& mesh);

// ---- tetra_rays.cxx

struct stretch {
  double low, high; // in units of the ray's direction
  int64_t cell;
  double first, last; // the field where the ray enters and leaves
};
struct ray_of_pixel {
  int pixel;
  double length;                  // world length of the direction
  std::vector<stretch> stretches; // front to back, sorted by their middles
};
// Visits all rays of a picture of size x size, from several threads at once. Rays go through pixel centres or, if scattered, through a
// random place in each pixel.
void visit_rays(
  const stratus_mesh& mesh, const stratus_camera& camera, int size, bool scattered, const std::function<void(ray_of_pixel&)>& visit);

// ---- tetra_judge.cxx

struct tetra_picture {
  std::vector<float> rgba;
  std::vector<uint8_t> bytes;
};
// Draws all functions from one camera in double precision. cache: a folder, or empty. agreement, unless NULL: for each function, the root
// mean square difference of 255 from a picture with steps four times as long.
std::vector<std::vector<float>> tetra_references(const tetra_mesh& mesh, const std::vector<transfer>& functions,
  const stratus_camera& camera, int size, const std::string& cache, std::vector<double>* agreement);
// Sums squares and counts over the pixels that either picture shows.
struct tetra_error {
  double squares = 0.0, count = 0.0;
  void add(const float* rgba, const float* reference, size_t pixels);
  double rmse255() const;
};

// ---- tetra_orders.cxx

using sorter_metrics = std::map<std::string, std::pair<double, std::string>>; // metric -> value, unit
const std::vector<std::string>& tetra_sorters();
struct order_options {
  int rounds = 3, threads = 2, rays = 160; // rays x rays per view search for wrong pairs
};
// Runs all of `names` on one mesh, interleaved.
std::map<std::string, sorter_metrics> run_sorters(
  stratus_context* context, const tetra_mesh& mesh, const std::vector<std::string>& names, const order_options& options);

// ---- tetra_resample.cxx

// Resamples a mesh to an image of along^3 points over its bounds and draws the image by Stratus, or by VTK's FixedPoint in steps of half a
// voxel. *ms: the resampling's time.
vtkSmartPointer<vtkAbstractVolumeMapper> make_resampled(const tetra_mesh& mesh, bool ours, int along, double* ms);
// The function for it: points outside the mesh have a value below all others, which is transparent.
transfer transfer_of_image(const tetra_mesh& mesh, const transfer& t);

// ---- tetra_frames.cxx

struct frame_result {
  std::string method;
  double first_ms = 0.0, frame_ms = 0.0;
  std::vector<double> frames; // ms of each view, whose median is frame_ms
  sorter_metrics more;
  std::vector<tetra_picture> pictures; // one per view
};
struct mapper_failure {
  std::string method, why;
};
const std::vector<std::string>& tetra_mappers();
// Whether it is one of these, with or without a setting.
bool is_tetra_mapper(const std::string& method);
std::vector<std::string> tetra_curve_methods(bool quick); // at several settings
// Returns the sorter that a mapper's picture depends on; "": none.
std::string sorter_of(const std::string& method);
std::vector<frame_result> run_mappers(stratus_context* context, const tetra_mesh& mesh, const transfer& function,
  const std::vector<std::string>& methods, int size, int repeats, std::vector<mapper_failure>& failures);

// ---- tetra_memory.cxx: counts the bytes that a context allocates

class counted_context
{
public:
  explicit counted_context(int threads);
  ~counted_context();
  counted_context(const counted_context&) = delete;
  counted_context& operator=(const counted_context&) = delete;
  operator stratus_context*() const { return this->Context; }
  size_t live() const { return this->Live; }
  size_t peak() const { return this->Peak; }

private:
  static void* allocate(void* user, size_t bytes);
  static void release(void* user, void* memory);

  stratus_context* Context = nullptr;
  std::atomic<size_t> Live{ 0 }, Peak{ 0 };
};
} // namespace bench
