// SPDX-License-Identifier: BSD-3-Clause
// Arrays of three components, of which one number is drawn: the length, or one component by its name.
#pragma once

#include <string>

class vtkDataArray;
class vtkDataSetAttributes;

namespace cli {

// A name that ends in .x, .y, .z or .magnitude: the array's name, and 0 to 3. Part -1: another name.
struct vector_part {
  std::string array;
  int part = -1;
};
vector_part vector_part_of(const std::string& name);

// Returns whether an array is one of vectors: three components, which are no colours of a byte each.
bool is_vector(vtkDataArray* array);
// Adds an array with that part of the vectors, "wind.x" or "wind (magnitude)", and returns it. Lengths are computed in double.
vtkDataArray* add_vector_part(vtkDataSetAttributes* data, vtkDataArray* vectors, int part);
} // namespace cli
