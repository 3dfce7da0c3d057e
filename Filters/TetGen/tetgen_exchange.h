// SPDX-License-Identifier: BSD-3-Clause
// What vtkStratusTetGenFilter and its program stratus-tetgen hand each other in files: a request on descriptor 0, an answer on
// descriptor 3. Both run on one machine and come from one build, so that structs may go as they lie in memory. Private to the module.
#ifndef tetgen_exchange_h
#define tetgen_exchange_h

#include <cstdint>

namespace tetgen_exchange {
const std::uint64_t RequestMagic = 0x3151527447545453;
const std::uint64_t AnswerMagic = 0x3153415447545453;
const int AnswerDescriptor = 3;

// Then come, in this order: coordinates (3 doubles a point), holes (3 doubles each), regions (5 doubles each), where each facet's corners
// begin (facets + 1 int32), corners (int32), markers of facets (int32).
struct Request {
  std::uint64_t Magic;
  std::int64_t Points, Holes, Regions, Facets, Corners;
  double RadiusEdgeRatio, MinimumDihedralAngle; // 0: no quality asked for
  double MaximumVolume;                         // 0: any
  std::int64_t SteinerPoints;                   // -1: any number
  std::int32_t PreserveBoundary;
  std::int32_t Seconds; // after which the program ends by itself
};
static_assert(sizeof(Request) == 88, "no holes in it");

// Then come coordinates (3 doubles a point; those of the request first, in its order), attributes of regions (a double each tetrahedron, if
// there are regions), tetrahedra (4 int32), triangles of the boundary (3 int32) and their markers (int32). The header is written when all
// else is.
struct Answer {
  std::uint64_t Magic;
  std::int64_t Status; // 0, or what TetGen throws
  std::int64_t Points, Tetrahedra, Attributes, Faces;
};
static_assert(sizeof(Answer) == 48, "no holes in it");
} // namespace tetgen_exchange

#endif
