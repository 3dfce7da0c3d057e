// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusTreeBoxes.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>

namespace {
// One polyline along all twelve edges, so that a box is one cell. It draws three edges twice.
const vtkIdType Stroke[16] = { 0, 1, 3, 2, 0, 4, 5, 1, 5, 7, 3, 7, 6, 2, 6, 4 };

// Finds the part of a box that is inside the volume, in index coordinates. The last blocks of cells may extend beyond the volume.
void Extent(const stratus_node_box& box, const stratus_volume& volume, bool cells, double extent[6])
{
  for (int a = 0; a < 3; ++a) {
    const double last = static_cast<double>(volume.dimensions[a] - 1);
    extent[2 * a] = static_cast<double>(box.lo[a]);
    extent[2 * a + 1] = static_cast<double>(box.hi[a]);
    if (!cells) {
      extent[2 * a] -= 0.5;
      extent[2 * a + 1] -= 0.5;
    } else {
      const double border = volume.cell_centered ? 0.5 : 0.0; // the volume of cell data extends half a cell beyond its outermost values
      extent[2 * a] = box.lo[a] == 0 ? -border : extent[2 * a];
      extent[2 * a + 1] = extent[2 * a + 1] >= last ? last + border : extent[2 * a + 1];
    }
  }
}

void Corner(const double extent[6], const stratus_volume& volume, int corner, double world[3])
{
  std::copy(volume.origin, volume.origin + 3, world);
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      world[a] += volume.direction[3 * a + b] * vtkStratusPosition(volume, b, extent[2 * b + ((corner >> b) & 1)]);
    }
  }
}
} // namespace

void vtkStratusTreeBoxes(const stratus_tree* tree, const stratus_volume& volume, bool cells, vtkPolyData* output)
{
  stratus_tree_statistics statistics;
  stratus_tree_get_statistics(tree, &statistics);
  std::vector<stratus_node_box> boxes(static_cast<size_t>(statistics.nodes));
  if (!boxes.empty()) {
    stratus_tree_boxes(tree, boxes.data());
  }
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> lines;
  vtkNew<vtkIntArray> depths;
  vtkNew<vtkUnsignedCharArray> kinds;
  vtkNew<vtkIdTypeArray> counts;
  depths->SetName("Depth");
  kinds->SetName("Kind");
  counts->SetName("Count");
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(8 * boxes.size()));
  vtkIdType first = 0;
  for (const stratus_node_box& box : boxes) {
    double extent[6], world[3];
    vtkIdType stroke[16];
    Extent(box, volume, cells, extent);
    for (int corner = 0; corner < 8; ++corner) {
      Corner(extent, volume, corner, world);
      points->SetPoint(first + corner, world);
    }
    std::transform(Stroke, Stroke + 16, stroke, [first](vtkIdType corner) { return first + corner; });
    lines->InsertNextCell(16, stroke);
    depths->InsertNextValue(box.depth);
    kinds->InsertNextValue(static_cast<unsigned char>(box.kind));
    counts->InsertNextValue(static_cast<vtkIdType>(box.voxels));
    first += 8;
  }
  output->Initialize();
  output->SetPoints(points);
  output->SetLines(lines);
  output->GetCellData()->SetScalars(depths);
  output->GetCellData()->AddArray(kinds);
  output->GetCellData()->AddArray(counts);
}
