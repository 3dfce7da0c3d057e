// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "reading.h"
#include "stratus.h"

#include <limits>
#include <string>
#include <vector>

namespace cli {

struct options {
  std::string command; // render, info, tree, sort, devices, help
  std::string source;
  std::string output;
  std::string array;
  std::string opacity;
  std::string color;
  std::string background;
  std::string device = "auto";
  std::string up; // x, y, z; empty: the scene's, else z
  double unit_distance = 0.0;
  double azimuth = 30.0;
  double elevation = 30.0;
  double zoom = 1.0;
  double sample_distance = 0.0;
  int width = 512;
  int height = 512;
  int threads = 0;
  double read_timeout = usual_read_timeout; // seconds; 0: never
  int depth = 3;                            // sort: of the K-D tree
  bool parallel = false;
  bool nearest = false;
  bool shade = false;
  bool audit = false;
  bool shows_samples = false; // render: how many samples each pixel took, in place of what it shows
  bool has_range = false;     // tree: of values, lower..upper
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  stratus_tree_method method = STRATUS_TREE_HYBRID;
  stratus_tetra_method tetra_method = STRATUS_TETRA_METHOD_AUTO; // render: of grids
  stratus_mode mode = STRATUS_MODE_COMPOSITE;
  std::vector<double> contours; // isosurface
  std::vector<double> average;  // average: none, or the range of values that count
  std::vector<double> crop;     // none, or six planes across the grid's axes
  int crop_regions = STRATUS_CROP_INSIDE;
  std::string mask; // an image of bytes, 0 where nothing is to be seen
  int jitter = -1;  // or the seed
  stratus_normals normals = STRATUS_NORMALS_FACES;
  stratus_structure structure = STRATUS_STRUCTURE_AUTO;
  stratus_sampling sampling = STRATUS_SAMPLING_AUTO;
};

// Throws usage where the command line makes no sense.
options parse(int argc, char* argv[]);
std::string help();
} // namespace cli
