// SPDX-License-Identifier: BSD-3-Clause
// Blends the pictures of several ranks before they are rounded to bytes.
#pragma once

#include <vector>

class vtkMultiProcessController;

namespace stratus {

// Blends the ranks' pictures of width * height pixels over one another, in float, and rounds once. Pixels are red, green, blue and alpha in
// 0..65535, colours multiplied by alpha. Each rank has as many layers as the others: the first layers of all ranks lie before the second
// ones. order: every rank, nearest first, the same on all ranks. background: the colour, 0..255, that ParaView lays behind the picture.
// Rank 0 gets the picture in `bytes`; the others get an empty one there. Every rank of the controller must call it. Of a layer, only the
// smallest rectangle that is not empty is sent: each rank blends a stretch of the rows of all. Where any rank lacks memory, `bytes` stay as
// they are; returns whether this one had it.
bool blend_ranks(vtkMultiProcessController* controller, const std::vector<int>& order, const int size[2],
  const std::vector<std::vector<unsigned short>>& layers, const float background[3], std::vector<unsigned char>& bytes);
} // namespace stratus
