// SPDX-License-Identifier: BSD-3-Clause
// Blends the pictures of several ranks before they are rounded to bytes.
#pragma once

#include <vector>

class vtkMultiProcessController;

namespace stratus {

// Blends the ranks' frames of width * height pixels over one another, in float, and rounds once. Pixels are red, green, blue and alpha in
// 0..65535, colours multiplied by alpha. All ranks have an equal number of layers: the first layers of all ranks are in front of the second
// ones. order: every rank, nearest first, equal on all ranks. background: the colour, 0..255, that ParaView draws behind the frame. Rank 0
// gets the frame in `bytes`; the others get an empty one there. Every rank of the controller must call it. Of a layer, only the smallest
// rectangle that is not empty is sent: each rank blends some rows of all ranks. If any rank lacks memory, `bytes` are not changed. Returns
// whether this rank had the memory.
bool blend_ranks(vtkMultiProcessController* controller, const std::vector<int>& order, const int size[2],
  const std::vector<std::vector<unsigned short>>& layers, const float background[3], std::vector<unsigned char>& bytes);
} // namespace stratus
