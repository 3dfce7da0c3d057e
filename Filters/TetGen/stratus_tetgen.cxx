// SPDX-License-Identifier: BSD-3-Clause
// stratus-tetgen runs TetGen for vtkStratusTetGenFilter in a separate process, so that a crash or an infinite run does not harm the
// application. This source is under the licence above. The program built from it links TetGen and so falls under the AGPL as a whole
// (README.md).
#include "tetgen_exchange.h"

#include <tetgen.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include <sys/resource.h>
#include <unistd.h>

namespace {
using tetgen_exchange::Answer;
using tetgen_exchange::Request;
const size_t PieceBytes = size_t(1) << 30; // below the limit of a single read() or write()

template <typename T> void Read(T* values, size_t count)
{
  char* begin = reinterpret_cast<char*>(values);
  for (size_t left = count * sizeof(T); left > 0;) {
    const ssize_t got = read(0, begin, std::min(left, PieceBytes));
    if (got <= 0) {
      throw std::string("the request is cut short");
    }
    begin += got;
    left -= static_cast<size_t>(got);
  }
}

template <typename T> void Write(const T* values, size_t count)
{
  const char* begin = reinterpret_cast<const char*>(values);
  for (size_t left = count * sizeof(T); left > 0;) {
    const ssize_t put = write(tetgen_exchange::AnswerDescriptor, begin, std::min(left, PieceBytes));
    if (put <= 0) {
      throw std::string("the answer can't be written");
    }
    begin += put;
    left -= static_cast<size_t>(put);
  }
}

void WriteHeader(const Answer& answer)
{
  if (lseek(tetgen_exchange::AnswerDescriptor, 0, SEEK_SET) != 0) {
    throw std::string("the answer can't be written");
  }
  Write(&answer, 1);
}

// Returns memory from new[], because TetGen frees its input by delete[].
template <typename T> T* ReadNew(std::int64_t count)
{
  T* values = new T[static_cast<size_t>(count)];
  Read(values, static_cast<size_t>(count));
  return values;
}

void ReadSurface(const Request& request, tetgenio& in)
{
  in.numberofpoints = static_cast<int>(request.Points);
  in.pointlist = ReadNew<REAL>(3 * request.Points);
  in.numberofholes = static_cast<int>(request.Holes);
  in.holelist = request.Holes > 0 ? ReadNew<REAL>(3 * request.Holes) : nullptr;
  in.numberofregions = static_cast<int>(request.Regions);
  in.regionlist = request.Regions > 0 ? ReadNew<REAL>(5 * request.Regions) : nullptr;
  std::vector<std::int32_t> begins(static_cast<size_t>(request.Facets) + 1), corners(static_cast<size_t>(request.Corners));
  Read(begins.data(), begins.size());
  Read(corners.data(), corners.size());
  in.numberoffacets = static_cast<int>(request.Facets);
  in.facetmarkerlist = ReadNew<int>(request.Facets);
  in.facetlist = new tetgenio::facet[static_cast<size_t>(request.Facets)];
  for (size_t index = 0; index < static_cast<size_t>(request.Facets); ++index) {
    tetgenio::facet& facet = in.facetlist[index];
    tetgenio::init(&facet);
    facet.numberofpolygons = 1;
    facet.polygonlist = new tetgenio::polygon[1];
    facet.polygonlist[0].numberofvertices = begins[index + 1] - begins[index];
    facet.polygonlist[0].vertexlist = new int[static_cast<size_t>(begins[index + 1] - begins[index])];
    std::copy(corners.begin() + begins[index], corners.begin() + begins[index + 1], facet.polygonlist[0].vertexlist);
  }
}

// Switches of TetGen: p, the input is a surface; z, numbers start at 0; J, no point is left out, so that the request's points keep their
// numbers; Q, quiet.
std::string Switches(const Request& request, const tetgenio& in)
{
  std::string switches = "pzJQ";
  char number[96];
  if (request.RadiusEdgeRatio > 0.0) {
    std::snprintf(number, sizeof number, "q%.12g/%.12g", request.RadiusEdgeRatio, request.MinimumDihedralAngle);
    switches += number;
  }
  if (request.MaximumVolume > 0.0) {
    std::snprintf(number, sizeof number, "a%.12g", request.MaximumVolume);
    switches += number;
  }
  bool volumes = false;
  for (int region = 0; region < in.numberofregions; ++region) {
    volumes = volumes || in.regionlist[5 * region + 4] > 0.0;
  }
  switches += in.numberofregions > 0 ? (volumes ? "aA" : "A") : "";
  if (request.SteinerPoints >= 0) {
    switches += "S" + std::to_string(request.SteinerPoints);
  }
  return switches + (request.PreserveBoundary ? "Y" : "");
}

void Mesh(const Request& request, tetgenio& in, tetgenio& out)
{
  std::string switches = Switches(request, in);
  tetgenbehavior behavior;
  if (!behavior.parse_commandline(&switches[0])) {
    throw std::string("TetGen refuses the switches ") + switches;
  }
  tetrahedralize(&behavior, &in, &out);
}

void WriteMesh(const Request& request, const tetgenio& out)
{
  Answer answer = {};
  Write(&answer, 1); // reserves the header's place, still without the magic number that makes it valid
  const size_t tetrahedra = static_cast<size_t>(out.numberoftetrahedra), faces = static_cast<size_t>(out.numberoftrifaces);
  const bool regions = request.Regions > 0 && out.numberoftetrahedronattributes > 0;
  Write(out.pointlist, 3 * static_cast<size_t>(out.numberofpoints));
  for (size_t index = 0; regions && index < tetrahedra; ++index) { // the region's attribute comes last
    Write(out.tetrahedronattributelist + (index + 1) * static_cast<size_t>(out.numberoftetrahedronattributes) - 1, 1);
  }
  Write(out.tetrahedronlist, 4 * tetrahedra);
  Write(out.trifacelist, 3 * faces);
  const std::vector<int> none(out.trifacemarkerlist ? 0 : faces, 0);
  Write(out.trifacemarkerlist ? out.trifacemarkerlist : none.data(), faces);
  answer = { tetgen_exchange::AnswerMagic, 0, out.numberofpoints, out.numberoftetrahedra, regions ? out.numberoftetrahedra : 0,
    out.numberoftrifaces };
  WriteHeader(answer);
}

int Run()
{
  Request request = {};
  Read(&request, 1);
  if (request.Magic != tetgen_exchange::RequestMagic) {
    throw std::string("this is no request of vtkStratusTetGenFilter, whose program this is");
  }
  alarm(static_cast<unsigned>(request.Seconds)); // ends this program even if the filter's process is gone
  // Never deleted: TetGen may leave a partial mesh whose destructor would free memory twice.
  tetgenio& in = *new tetgenio;
  tetgenio& out = *new tetgenio;
  ReadSurface(request, in);
  Answer failed = { tetgen_exchange::AnswerMagic, 0, 0, 0, 0, 0 };
  try {
    Mesh(request, in, out);
  } catch (int status) {
    failed.Status = status != 0 ? status : 2;
  } catch (const std::bad_alloc&) {
    failed.Status = 1;
  }
  if (failed.Status != 0) {
    WriteHeader(failed);
  } else {
    WriteMesh(request, out);
  }
  return 0;
}
} // namespace

int main()
{
  const struct rlimit none = { 0, 0 };
  setrlimit(RLIMIT_CORE, &none); // a crash is an expected outcome and needs no core dump
  int status = 1;
  try {
    status = Run();
  } catch (const std::string& text) {
    std::fprintf(stderr, "stratus-tetgen: %s\n", text.c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stratus-tetgen: %s\n", error.what());
  }
  std::fflush(nullptr);
  _exit(status); // the heap may be damaged, so no destructor runs
}
