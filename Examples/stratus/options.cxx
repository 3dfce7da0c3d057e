// SPDX-License-Identifier: BSD-3-Clause
#include "options.h"
#include "support.h"
#include "transfer.h"

#include <functional>
#include <limits>
#include <map>

namespace cli {

static std::string method_names()
{
  std::string names;
  for (int i = 0; i < STRATUS_TREE_METHODS; ++i) {
    names += std::string(i ? ", " : "") + stratus_tree_method_name(static_cast<stratus_tree_method>(i));
  }
  return names;
}

std::string help()
{
  return R"(stratus - draws volumes

  stratus render INPUT -o OUT.png [options]   draw a picture; OUT.exr has floats: R, G, B, A, depth Z, Samples
  stratus info INPUT [--array NAME]           tell what is in a file or scene: sizes, arrays, kinds of cells
  stratus tree INPUT [options] [-o OUT.vtp]   build the tree that rays skip by, tell its numbers, write its nodes' boxes
  stratus sort GRID [--depth N] [--up A]      cut a grid into leaves, sort its cells from 16 views, and count what comes out wrong
  stratus devices                             list the OpenCL devices
  stratus --help

INPUT is an image file (.vti .pvti .vtk .mha .mhd .nrrd .nhdr .nii .tif .png and what else VTK reads as an image)
or a scene's name: cloud, plume, fog, haze, peak, voxel; to be drawn, told of or sorted also an unstructured grid (.vtu .pvtu .vtk, TetGen's
.node .ele), whose cells are divided into tetrahedra.

What is drawn
  --array NAME            point or cell array of one component (default: the active scalars, else the first that fits)
  --opacity LIST          "value:alpha,..." with alpha in 0..1 per unit distance (default: the scene's own, else guessed from
                          the histogram: transparent over the background's value, a ramp beyond it)
  --color NAME|LIST       a colour map, )" +
    color_names() + R"(, stretched over what is shown,
                          or "value:r:g:b,..." with r, g, b in 0..1
  --crop X,X,Y,Y,Z,Z      only what lies between these planes across the grid's axes, in the file's coordinates
  --crop-regions N        of the 27 regions that the planes of --crop make, bit x + 3 y + 9 z for each that is shown, 0..134217727
                          (default 8192: between all of them)
  --mask FILE             an image of one byte a value, 0 where nothing is to be seen
  --unit-distance D       world length that alpha is per (default: a voxel's edge)
  --nearest               nearest instead of linear interpolation
  --shade                 light from the eye on the field's gradient (composite, isosurface)
  --background B          dark, light, black, white, transparent, r:g:b, or r:g:b,r:g:b from bottom to top (default dark)

From where
  --size WxH              pixels (default 512x512)
  --azimuth DEG           about the upward axis (default 30)
  --elevation DEG         above the ground, -90..90 (default 30)
  --zoom F                2 shows everything twice as large (default 1: all of it fits)
  --parallel              parallel instead of perspective projection
  --up x|y|z              which axis points upward (default z; a scene has its own)

How
  --sample-distance D     world length between samples (default: from the data and the opacity)
  --sampling S            auto, midpoint, preintegrated (default auto)
  --jitter SEED           move each ray's samples by a part of their distance, so that grain turns into noise; another seed, another noise
  --structure S           auto, none, block, distance, octant, hybrid: how empty space is skipped; never changes the picture
  --mode M                composite; first-hit: what shows at all as solid voxels, lit from the eye; maximum, minimum: of the values along a
                          ray, in their colour; average, additive: of opacity times value, in grey; isosurface (default composite)
  --contours V,V,...      of isosurfaces: 1 to 16 values, each in the colour and opacity that the functions give it
  --average-range A,B     of averages: the values that count (default: all)
  --method M              of unstructured grids: rays march through faces, or cells are sorted and projected; the same picture. auto, march,
                          project (default auto: what should cost less)
  --normals N             of first hits: faces, gradient (default faces)
  --device D              auto, host, an OpenCL device's index, or a part of its name (default auto)
  --threads N             threads of the host (default: all)
  --show samples          a heat map of the samples that each pixel took, with a scale, in place of the picture; --color has its colours
  --audit                 draw again without skipping and count the pixels that differ; any is a failure

Trees
  --lower V, --upper V    the values that count (default: what the opacity shows)
  --method M              )" +
    method_names() + R"( (default hybrid)
  --mode M                composite: blocks of cells for ray casting; first-hit: voxels (default composite)

Orders
  --depth N               planes between the mesh and a leaf, 0..16 (default 3)

The exit status is 0 only if the picture was written whole; 1 if something failed, 2 if the command was not understood.

  stratus render cloud -o cloud.png
  stratus render head.mha -o head.png --opacity "0:0,300:0,1500:.3" --color gray --azimuth 120 --size 1024x768
)";
}

namespace {

void set_size(options& o, const std::string& text)
{
  const std::vector<std::string> sides = split(text, 'x');
  if (sides.size() != 2) {
    throw usage("--size: '" + text + "' is not WIDTHxHEIGHT");
  }
  o.width = whole_number(sides[0], "--size", 1, 16384);
  o.height = whole_number(sides[1], "--size", 1, 16384);
}

double within(const std::string& text, const std::string& what, double low, double high)
{
  const double value = number(text, what);
  if (value < low || value > high) {
    throw usage(what + ": " + text + " is outside " + format("%g..%g", low, high));
  }
  return value;
}

double positive(const std::string& text, const std::string& what)
{
  const double value = number(text, what);
  if (value <= 0.0) {
    throw usage(what + ": " + text + " is not above 0");
  }
  return value;
}

stratus_structure structure_named(const std::string& text)
{
  for (int i = STRATUS_STRUCTURE_AUTO; i <= STRATUS_STRUCTURE_HYBRID; ++i) {
    if (text == stratus_structure_name(static_cast<stratus_structure>(i))) {
      return static_cast<stratus_structure>(i);
    }
  }
  throw usage("--structure: '" + text + "' is none of auto, none, block, distance, octant, hybrid");
}

stratus_tetra_method tetra_method_named(const std::string& text)
{
  for (int i = STRATUS_TETRA_METHOD_AUTO; i <= STRATUS_TETRA_METHOD_PROJECT; ++i) {
    const stratus_tetra_method method = static_cast<stratus_tetra_method>(i);
    if (text == stratus_tetra_method_name(method)) {
      return method;
    }
  }
  throw usage("--method: '" + text + "' is none of auto, march, project");
}

stratus_tree_method method_named(const std::string& text)
{
  for (int i = 0; i < STRATUS_TREE_METHODS; ++i) {
    if (text == stratus_tree_method_name(static_cast<stratus_tree_method>(i))) {
      return static_cast<stratus_tree_method>(i);
    }
  }
  throw usage("--method: '" + text + "' is none of " + method_names());
}

stratus_mode mode_named(const std::string& text)
{
  std::string names;
  for (int i = STRATUS_MODE_COMPOSITE; i <= STRATUS_MODE_ISOSURFACE; ++i) {
    const stratus_mode mode = static_cast<stratus_mode>(i);
    if (text == stratus_mode_name(mode)) {
      return mode;
    }
    names += std::string(i ? ", " : "") + stratus_mode_name(mode);
  }
  throw usage("--mode: '" + text + "' is none of " + names);
}

std::vector<double> numbers(const std::string& text, const std::string& what, size_t least, size_t most)
{
  std::vector<double> values;
  for (const std::string& word : split(text, ',')) {
    values.push_back(number(word, what));
  }
  if (values.size() < least || values.size() > most) {
    throw usage(what + ": '" + text + "' has " + std::to_string(values.size()) + format(" values, %zu..%zu are needed", least, most));
  }
  return values;
}

stratus_normals normals_named(const std::string& text)
{
  if (text != "faces" && text != "gradient") {
    throw usage("--normals: '" + text + "' is none of faces, gradient");
  }
  return text == "faces" ? STRATUS_NORMALS_FACES : STRATUS_NORMALS_GRADIENT;
}

stratus_sampling sampling_named(const std::string& text)
{
  if (text == "auto") {
    return STRATUS_SAMPLING_AUTO;
  }
  if (text == "midpoint") {
    return STRATUS_SAMPLING_MIDPOINT;
  }
  if (text == "preintegrated" || text == "pre-integrated") {
    return STRATUS_SAMPLING_PREINTEGRATED;
  }
  throw usage("--sampling: '" + text + "' is none of auto, midpoint, preintegrated");
}

void check_complete(const options& o)
{
  if (o.command == "render" || o.command == "info" || o.command == "tree" || o.command == "sort") {
    if (o.source.empty()) {
      throw usage(o.command + ": which INPUT?");
    }
    if (o.command == "render" && o.output.empty()) {
      throw usage("render: where to? Give -o OUT.png");
    }
    if (o.mode == STRATUS_MODE_ISOSURFACE && o.contours.empty()) {
      throw usage("--mode isosurface: which values? Give --contours V,V,...");
    }
    if (o.crop_regions != STRATUS_CROP_INSIDE && o.crop.empty()) {
      throw usage("--crop-regions: between which planes? Give --crop X,X,Y,Y,Z,Z");
    }
    if (o.command == "tree" && o.mode > STRATUS_MODE_FIRST_HIT) {
      throw usage(std::string("tree: --mode '") + stratus_mode_name(o.mode) + "' is none of composite, first-hit");
    }
    if (o.lower > o.upper) {
      throw usage(format("--lower: %g is above --upper %g", o.lower, o.upper));
    }
  } else if (o.command != "devices" && o.command != "help") {
    throw usage(o.command.empty() ? "no command" : "unknown command '" + o.command + "'");
  }
}
} // namespace

options parse(int argc, char* argv[])
{
  options o;
  const std::map<std::string, std::function<void(const std::string&)>> with_value = {
    { "-o", [&](const std::string& v) { o.output = v; } },
    { "--output", [&](const std::string& v) { o.output = v; } },
    { "--array", [&](const std::string& v) { o.array = v; } },
    { "--opacity", [&](const std::string& v) { o.opacity = v; } },
    { "--color", [&](const std::string& v) { o.color = v; } },
    { "--background", [&](const std::string& v) { o.background = v; } },
    { "--device", [&](const std::string& v) { o.device = v; } },
    { "--show",
      [&](const std::string& v) {
        if (v != "picture" && v != "samples") {
          throw usage("--show: '" + v + "' is none of picture, samples");
        }
        o.shows_samples = v == "samples";
      } },
    { "--unit-distance", [&](const std::string& v) { o.unit_distance = positive(v, "--unit-distance"); } },
    { "--size", [&](const std::string& v) { set_size(o, v); } },
    { "--azimuth", [&](const std::string& v) { o.azimuth = number(v, "--azimuth"); } },
    { "--elevation", [&](const std::string& v) { o.elevation = within(v, "--elevation", -90.0, 90.0); } },
    { "--zoom", [&](const std::string& v) { o.zoom = within(v, "--zoom", 0.15, 1e6); } },
    { "--sample-distance", [&](const std::string& v) { o.sample_distance = positive(v, "--sample-distance"); } },
    { "--sampling", [&](const std::string& v) { o.sampling = sampling_named(v); } },
    { "--mode", [&](const std::string& v) { o.mode = mode_named(v); } },
    { "--contours", [&](const std::string& v) { o.contours = numbers(v, "--contours", 1, STRATUS_CONTOURS_MAX); } },
    { "--average-range", [&](const std::string& v) { o.average = numbers(v, "--average-range", 2, 2); } },
    { "--crop", [&](const std::string& v) { o.crop = numbers(v, "--crop", 6, 6); } },
    { "--crop-regions", [&](const std::string& v) { o.crop_regions = whole_number(v, "--crop-regions", 0, STRATUS_CROP_ALL); } },
    { "--mask", [&](const std::string& v) { o.mask = v; } },
    { "--jitter", [&](const std::string& v) { o.jitter = whole_number(v, "--jitter", 0, std::numeric_limits<int>::max()); } },
    { "--normals", [&](const std::string& v) { o.normals = normals_named(v); } },
    { "--method",
      [&](const std::string& v) {
        if (o.command == "render") {
          o.tetra_method = tetra_method_named(v);
        } else {
          o.method = method_named(v);
        }
      } },
    { "--lower",
      [&](const std::string& v) {
        o.lower = number(v, "--lower");
        o.has_range = true;
      } },
    { "--upper",
      [&](const std::string& v) {
        o.upper = number(v, "--upper");
        o.has_range = true;
      } },
    { "--structure", [&](const std::string& v) { o.structure = structure_named(v); } },
    { "--threads", [&](const std::string& v) { o.threads = whole_number(v, "--threads", 1, 1024); } },
    { "--depth", [&](const std::string& v) { o.depth = whole_number(v, "--depth", 0, 16); } },
    { "--up",
      [&](const std::string& v) {
        if (v != "x" && v != "y" && v != "z") {
          throw usage("--up: '" + v + "' is none of x, y, z");
        }
        o.up = v;
      } },
  };
  const std::map<std::string, bool*> flags = { { "--parallel", &o.parallel }, { "--nearest", &o.nearest }, { "--shade", &o.shade }, { "--audit", &o.audit } };
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = with_value.find(word);
    const auto flag = flags.find(word);
    if (word == "--help" || word == "-h") {
      o.command = "help";
      return o;
    }
    if (value != with_value.end()) {
      if (i + 1 == argc) {
        throw usage(word + " needs a value");
      }
      value->second(argv[++i]);
    } else if (flag != flags.end()) {
      *flag->second = true;
    } else if (word.size() > 1 && word[0] == '-') {
      throw usage("unknown option '" + word + "'");
    } else if (o.command.empty()) {
      o.command = word;
    } else if (o.source.empty()) {
      o.source = word;
    } else {
      throw usage("one INPUT at a time: '" + word + "' is too many");
    }
  }
  check_complete(o);
  return o;
}
} // namespace cli
