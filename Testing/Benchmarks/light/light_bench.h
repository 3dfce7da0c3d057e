// SPDX-License-Identifier: BSD-3-Clause
// Declarations that the parts of stratus-bench light share: what is drawn, kinds of light, casters, and judges.
#pragma once

#include "bench.h"
#include "tetra_bench.h"

namespace bench {

int light_main(int argc, char* argv[]);

// A volume, or a mesh of tetrahedra. One of both pointers is set.
struct light_subject {
  std::string name;
  const scene* volume = nullptr;
  const tetra_mesh* mesh = nullptr;
  transfer function; // of the mesh
  double bounds[6];
  int up_axis = 2;
  std::vector<stratus_camera> cameras; // one per view
};

// A kind of light.
struct lighting {
  const char* name;
  bool sun; // a light that stays in the world; otherwise a headlight
  double ambient, diffuse, specular;
  int shadows;
  double scattering, anisotropy;
  // Number of scatterings by which the path tracer draws this light, 0: no limit. -1: it cannot, because it knows no normals. The reference
  // in double draws all that is lit by the light itself: -1 and 1.
  int bounces;
};
const std::vector<lighting>& all_lighting();

// A direction from the side of view 0, and from above.
stratus_light sun_of(const light_subject& s);
// The material and the light as casters and the reference in double take them.
stratus_shading shading_of(const light_subject& s, const lighting& l, const stratus_camera& camera);

// ---- light_casters.cxx

// A caster with its options.
class light_caster
{
public:
  struct report {
    double maps_ms = -1.0, maps_bytes = -1.0, maps_error = -1.0; // -1: not in the report
    double expected_error = -1.0;                                // -1: not measured
    double samples = 0.0;                                        // segments of a mesh
  };
  virtual ~light_caster() = default;
  virtual report draw(const stratus_camera& camera, int size, float* rgba) = 0;
  void move_light(); // by so little that the image stays, but maps are built again

protected:
  stratus_shading* Shading = nullptr;
  bool Moved = false;
};
// l: nullptr for an unlit caster.
std::unique_ptr<light_caster> make_caster(stratus_context* context, const light_subject& s, const lighting* l, double tolerance);

// ---- light_times.cxx

// A median, and the interval in which the true one is with a confidence of at least 95 %, whatever the distribution: order statistics.
struct interval {
  double low, median, high;
  bool known; // false: the values are too few for an interval
};
interval median_interval(std::vector<double> values);

struct light_effort {
  int size = 512, error_size = 128; // pixels each way: of frames that are timed, and of images that are compared
  double seconds = 30.0;            // longest time for the repeats of one method at one tolerance, and for each reference
};

// A round draws all views, unlit and lit by turns.
struct light_times {
  interval frame, unlit, ratio;                // ms of a frame, mean of the views; median of the rounds
  double processor_ratio = 0.0;                // the ratio in processor time
  interval maps = { -1.0, -1.0, -1.0, false }; // ms; -1: there are none
  double maps_processor_ratio = 0.0;           // processor time of maps over the processor time of an unlit frame
  int rounds = 0;
  light_caster::report report; // of the last frame; maps_ms of the first
};
light_times time_light(stratus_context* context, const light_subject& s, const lighting& l, double tolerance, const light_effort& how);

// ---- light_judge.cxx

constexpr int judged_views[] = { 0, 4 }; // opposite sides of the subject

// Images of the judged views, RGBA.
using light_images = std::vector<std::vector<float>>;
light_images draw_light(stratus_context* context, const light_subject& s, const lighting* l, double tolerance, int size);

// Root mean square error over the pixels that the image or the reference shows. low, high: the noise of a reference leaves the true error
// within these bounds, by two deviations.
struct light_error {
  double low, error, high;
};
struct light_judgement {
  std::vector<light_error> errors; // one per set of images
  double samples = 0.0;            // paths a pixel; 0: the reference in double judged
  double reference_error = 0.0;    // standard error of the paths; the difference of the two last pictures in double
  light_images paths;              // RGBA of the judged views, each followed by its standard errors
};
light_judgement judge_in_double(
  const light_subject& s, const lighting& l, const std::vector<light_images>& images, const light_effort& how, const std::string& cache);
light_judgement judge_by_paths(stratus_context* context, const light_subject& s, const lighting& l, const std::vector<light_images>& images,
  const light_effort& how, const std::string& cache);

// ---- light_export.cxx: for peers in programs of their own

// Writes the image of a volume and the paths of a judgement, and returns the scene's entry in the list of scenes.
std::string export_scene(const light_subject& s, const light_images& paths, const std::string& folder);
void export_list(const std::vector<std::string>& scenes, const std::string& folder);

// ---- light_judge.cxx: the path tracer as a method

struct light_path {
  int samples;
  double seconds, standard_error, vertices;
};
// Draws view 0 by more and more paths.
std::vector<light_path> run_paths(stratus_context* context, const light_subject& s, const lighting& l, const light_effort& how);
} // namespace bench
