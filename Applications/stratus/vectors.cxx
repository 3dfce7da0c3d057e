// SPDX-License-Identifier: BSD-3-Clause
#include "vectors.h"

#include <vtkDataArray.h>
#include <vtkDataSetAttributes.h>
#include <vtkSmartPointer.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace {

constexpr const char* endings[] = { ".x", ".y", ".z", ".magnitude" };
constexpr int magnitude = 3;
} // namespace

namespace cli {

vector_part vector_part_of(const std::string& name)
{
  for (int part = 0; part <= magnitude; ++part) {
    const std::string ending = endings[part];
    if (name.size() > ending.size() && name.compare(name.size() - ending.size(), ending.size(), ending) == 0) {
      return { name.substr(0, name.size() - ending.size()), part };
    }
  }
  return {};
}

bool is_vector(vtkDataArray* array)
{
  return array->GetNumberOfComponents() == 3 && array->GetDataType() != VTK_UNSIGNED_CHAR;
}

vtkDataArray* add_vector_part(vtkDataSetAttributes* data, vtkDataArray* vectors, int part)
{
  const std::string base = vectors->GetName() ? vectors->GetName() : "(unnamed)";
  const std::string name = base + (part == magnitude ? " (magnitude)" : endings[part]);
  if (vtkDataArray* known = data->GetArray(name.c_str())) {
    return known;
  }
  const bool whole = part == magnitude && vectors->GetDataType() != VTK_FLOAT; // lengths of integers are no integers
  const auto values = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(whole ? VTK_DOUBLE : vectors->GetDataType()));
  values->SetName(name.c_str());
  values->SetNumberOfTuples(vectors->GetNumberOfTuples());
  for (vtkIdType i = 0; i < vectors->GetNumberOfTuples(); ++i) {
    double v[3];
    vectors->GetTuple(i, v);
    values->SetComponent(i, 0, part == magnitude ? std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) : v[part]);
  }
  data->AddArray(values);
  return values;
}
} // namespace cli
