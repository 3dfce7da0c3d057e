// SPDX-License-Identifier: BSD-3-Clause
// What the parts of stratus-bench tetra share: meshes, views, stretches of rays in cells, the judge, and the sorters.
#pragma once

#include "bench.h"

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
  std::vector<double> points;                // the same, as the core takes it
  std::vector<int32_t> vertices;
  std::vector<float> values;
  double bounds[6];
  stratus_mesh view() const;
};
// bluntfin, post (of ../shared/data), holes, wavelet, or a file. cache: a folder that keeps what TetGen made, or empty. False, and why on
// the standard error, where a mesh of record cannot be had here.
bool make_tetra_mesh(stratus_context* context, const std::string& source, const std::string& cache, tetra_mesh& mesh);
// ramp, peaks, opaque over the mesh's values.
const std::vector<std::string>& tetra_functions();
transfer tetra_transfer(const tetra_mesh& mesh, const std::string& function);
// 24 cameras in which orders are asked for wrong pairs: 6 directions x parallel, perspective, near, inside.
std::vector<stratus_camera> order_cameras(stratus_context* context, const tetra_mesh& mesh);

// ---- tetra_rays.cxx

struct stretch {
  double low, high; // in lengths of the ray's direction
  int64_t cell;
  double first, last; // the field where the ray enters and leaves
};
struct ray_of_pixel {
  int pixel;
  double length;                  // of the direction, world
  std::vector<stretch> stretches; // front to back, by their middles
};
// All rays of a picture of size x size, pixel centres or, scattered, a place in each pixel; from several threads at once.
void visit_rays(
  const stratus_mesh& mesh, const stratus_camera& camera, int size, bool scattered, const std::function<void(ray_of_pixel&)>& visit);

// ---- tetra_judge.cxx

struct tetra_picture {
  std::vector<float> rgba;
  std::vector<uint8_t> bytes;
};
// Pictures of all functions from one camera, in double precision; cache: a folder, or empty. agreement: root mean square of 255 by which
// steps of four times the length differ, for each function, or NULL.
std::vector<std::vector<float>> tetra_references(const tetra_mesh& mesh, const std::vector<transfer>& functions,
  const stratus_camera& camera, int size, const std::string& cache, std::vector<double>* agreement);
// Sums of squares and counts over pixels that either shows.
struct tetra_error {
  double squares = 0.0, count = 0.0;
  void add(const float* rgba, const float* reference, size_t pixels);
  double rmse255() const;
};

// ---- tetra_orders.cxx

using sorter_metrics = std::map<std::string, std::pair<double, std::string>>; // metric -> value, unit
const std::vector<std::string>& tetra_sorters();
struct order_options {
  int rounds = 3, threads = 2, rays = 160; // rays x rays a view ask for wrong pairs
};
// All of `names` on one mesh, interleaved.
std::map<std::string, sorter_metrics> run_sorters(
  stratus_context* context, const tetra_mesh& mesh, const std::vector<std::string>& names, const order_options& options);

// ---- tetra_frames.cxx

struct frame_result {
  std::string method;
  double first_ms = 0.0, frame_ms = 0.0;
  sorter_metrics more;
  std::vector<tetra_picture> pictures; // a view each
};
const std::vector<std::string>& tetra_mappers();
// The sorter that a mapper's picture rests on, "" for none.
std::string sorter_of(const std::string& method);
std::vector<frame_result> run_mappers(stratus_context* context, const tetra_mesh& mesh, const transfer& function,
  const std::vector<std::string>& methods, int size, int repeats);

// ---- tetra_memory.cxx: bytes that a context asks for

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
