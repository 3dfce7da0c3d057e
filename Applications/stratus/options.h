// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "formats.h"
#include "reading.h"
#include "stratus.h"

#include <array>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace cli {

// A volume that is drawn with the first one, and how it looks.
struct companion {
  std::string source, array, raw, select, opacity, color;
  double unit_distance = 0.0;
};

// Names and units of the drawn variable and its grid in the file, for defaults.
struct data_about {
  bool earth = false; // a netCDF file whose coordinates are lengths or degrees
  std::string name, standard_name, units = {};
  std::array<axis_about, 3> axes = {};
  // x and y of a longitude and latitude in degrees, of a grid on the plane of a projection; empty: none, and why not
  std::function<bool(const double degrees[2], double at[2])> place = {};
  std::string why_no_place = {};
};

struct options {
  std::string command;  // render, info, tree, sort, compare, devices, colors, version, help, completion
  bool topical = false; // help: about `source`, or an overview where that is empty; otherwise all of it
  bool quiet = false;
  std::string source;
  std::vector<companion> companions; // render: the INPUTs behind the first
  std::string output;
  std::string frames; // render: the names of the pictures of all steps, with one %d
  std::string time;   // the step: see series::find(); "all" is left out, since --frames says it
  std::string array;
  std::string raw;    // layout of a headerless file: see choose_format()
  std::string select; // "NAME=INDEX,...": indices of netCDF's dimensions
  std::string opacity;
  std::string color;
  std::string background;
  std::string device = "auto";
  std::string up; // x, y or z; empty: the scene's, else z
  double unit_distance = 0.0;
  double azimuth = 30.0;
  double elevation = 30.0;
  bool has_azimuth = false, has_elevation = false;
  double zoom = 1.0;
  double sample_distance = 0.0;
  double cell_error = 0.0;
  double tolerance = 0.001; // root mean square error of RGBA in 0..1
  bool has_tolerance = false;
  int width = 512;
  int height = 512;
  int threads = 0;
  double memory = 0.0;                      // bytes; 0: half of the free memory
  double read_timeout = usual_read_timeout; // seconds; 0: no limit
  int depth = 3;                            // sort: depth of the K-D tree
  double exaggeration = 1.0;                // of heights
  bool has_exaggeration = false;
  std::string heights; // for the caption, if set_heights() chose the exaggeration; otherwise ""
  data_about about;
  bool logarithmic = false, linear = false;
  bool axes = false;
  bool coast = false;
  bool globe = false;
  bool color_bar = false;
  std::string caption; // {time} is the step's
  bool parallel = false;
  bool nearest = false;
  bool shade = false, scatter = false, shadows = false, multiple = false;
  bool audit = false;
  bool report = false;                      // render, tree, sort: prints the stages of building
  bool shows_samples = false;               // render: draws the samples that each pixel took
  std::vector<stratus_quantity> quantities; // render: draws the first one's numbers, or writes all to OpenEXR
  double threshold = 0.5;                   // of the quantity transmittance_depth
  bool has_range = false;                   // tree: lower..upper is given
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  stratus_tree_method method = STRATUS_TREE_AUTO;
  bool agglomerative_by_edges = false;                           // tree: ac-edges instead of ac
  bool uncorrected_flooding = false;                             // tree: hybrid-paper-raw instead of hybrid-paper
  stratus_tetra_method tetra_method = STRATUS_TETRA_METHOD_AUTO; // render: method for unstructured grids
  stratus_mode mode = STRATUS_MODE_COMPOSITE;
  bool path = false;                     // --mode path; `mode` is then composite
  std::string of_path, of_scattering;    // one of the options for it that were given
  bool has_sky = false;                  // --sky is given
  int samples = 0;                       // path: of each pixel; 0: as many as the tolerance needs
  int bounces = 0;                       // path: 0: no limit
  int seed = 0;                          // path
  double albedo = 1.0, anisotropy = 0.0; // path, scatter
  std::vector<std::vector<double>> suns; // x, y, z and, if given, red, green, blue
  std::vector<double> sun_at;            // azimuth, elevation in degrees and, if given, red, green, blue
  std::string sun_time;                  // a moment in UTC, or "file"
  std::vector<double> place;             // of sun_time: latitude, longitude in degrees; empty: the file's
  double sun_color[3] = { 1, 1, 1 };     // of suns without a colour
  std::vector<double> sky;               // path, multiple: red, green, blue of the zenith and, if given, of the horizon
  bool cloud = false;                    // values are a cloud's water
  double radius = 0.0;                   // cloud: effective radius in m; 0: the usual one
  std::string water_units;               // cloud: of the values; empty: the file's
  double metres = 0.0;                   // cloud: of a unit of the coordinates; 0: the file's
  std::vector<double> contours;          // isosurface
  std::vector<double> slice;             // slice: a point of the plane, and its normal
  std::vector<double> average;           // average: empty, or the range of values that count
  std::vector<double> crop;              // empty, or six planes across the grid's axes
  int crop_regions = STRATUS_CROP_INSIDE;
  std::string mask;     // file of an image of bytes, 0 where the volume is hidden
  std::string mask_raw; // layout of a headerless mask file
  int jitter = -1;      // seed, or -1: none
  stratus_normals normals = STRATUS_NORMALS_FACES;
  // compare: limits and outputs, named like the members of vtkStratusImageTest
  std::string baseline, difference, json, junit;
  bool exact = false;
  double largest_mean = -1.0, largest_difference = -1.0, least_ssim = -2.0;
  stratus_structure structure = STRATUS_STRUCTURE_AUTO;
  stratus_sampling sampling = STRATUS_SAMPLING_AUTO;

  reading_options reading() const
  {
    return { this->array, this->raw, this->select, this->globe, this->has_exaggeration ? this->exaggeration : 0.0 };
  }
};

// Throws usage for an invalid command line.
options parse(int argc, char* argv[]);
std::string help();
// All options that parse() knows.
std::vector<std::string> option_words();
} // namespace cli
