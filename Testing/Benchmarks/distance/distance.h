// SPDX-License-Identifier: BSD-3-Clause
// Declarations that the parts of stratus-bench distance share.
#pragma once

#include "stratus.h"

#include <cstdint>
#include <string>
#include <vector>

namespace bench {

// One byte per voxel, 1 if it is effective, x fastest.
struct distance_case {
  std::string name; // "sparse-128"
  int64_t size = 0; // voxels along each axis
  std::vector<uint8_t> effective;
};

// ---- distance_cases.cxx
std::vector<std::string> distance_case_names();
distance_case make_distance_case(const std::string& name, int64_t size); // throws failure

// ---- distance_itk.cxx
// Runs itk::SignedMaurerDistanceMapImageFilter: distances, not squared, negative inside. Returns the milliseconds of Update(), and the
// distances if `distances` is not null.
double run_itk(const distance_case& c, int threads, std::vector<float>* distances);
// Returns the voxels from which ITK measures, inside and outside: effective ones with at least one of 26 neighbours that is not.
std::vector<uint8_t> itk_contour(const distance_case& c);

// ---- distance.cxx
int distance_main(int argc, char* argv[]);
} // namespace bench
