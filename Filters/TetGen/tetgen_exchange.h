// SPDX-License-Identifier: BSD-3-Clause
// The files that vtkStratusTetGenFilter and its program stratus-tetgen exchange: a request on descriptor 0 and an answer on descriptor 3.
// Both programs run on one machine and come from one build, so the files hold the structs in their memory layout. Private to the module.
#ifndef tetgen_exchange_h
#define tetgen_exchange_h

#include <cstdint>

namespace tetgen_exchange {
const std::uint64_t RequestMagic = 0x3151527447545453;
const std::uint64_t AnswerMagic = 0x3153415447545453;
const int AnswerDescriptor = 3;

// Header of a request. Arrays follow it in this order: coordinates (3 doubles per point), holes (3 doubles each), regions (5 doubles each),
// the index of each facet's first corner (facets + 1 int32), corners (int32), markers of the facets (int32).
struct Request {
  std::uint64_t Magic;
  std::int64_t Points, Holes, Regions, Facets, Corners;
  double RadiusEdgeRatio, MinimumDihedralAngle; // 0: no bound on quality
  double MaximumVolume;                         // 0: no bound
  std::int64_t SteinerPoints;                   // -1: no bound
  std::int32_t PreserveBoundary;
  std::int32_t Seconds; // after which the program ends itself
};
static_assert(sizeof(Request) == 88, "no holes in it");

// Header of an answer. Arrays follow it in this order: coordinates (3 doubles per point; the request's points come first, in its order),
// attributes of regions (a double per tetrahedron, if there are regions), tetrahedra (4 int32 each), triangles of the boundary (3 int32
// each) and their markers (int32). The header is written last, so that a valid header means a complete answer.
struct Answer {
  std::uint64_t Magic;
  std::int64_t Status; // 0, or the number that TetGen throws
  std::int64_t Points, Tetrahedra, Attributes, Faces;
};
static_assert(sizeof(Answer) == 48, "no holes in it");
} // namespace tetgen_exchange

#endif
