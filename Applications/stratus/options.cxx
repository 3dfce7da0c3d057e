// SPDX-License-Identifier: BSD-3-Clause
#include "options.h"
#include "cloud.h"
#include "colors.h"
#include "habits.h"
#include "nearest.h"
#include "support.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <limits>

namespace cli {

static std::string method_names()
{
  std::string names;
  for (int i = 0; i < STRATUS_TREE_METHODS; ++i) {
    names += std::string(i ? ", " : "") + stratus_tree_method_name(static_cast<stratus_tree_method>(i));
  }
  return names + ", ac-edges, hybrid-paper-raw";
}

// Breaks a text into lines of at most 140 columns, indented. The first line has `first` columns left.
static std::string wrapped(const std::string& text, size_t indent, size_t first)
{
  std::string result;
  size_t left = first;
  for (const std::string& word : split(text, ' ')) {
    const bool breaks = word.size() + 1 > left;
    result += breaks ? "\n" + std::string(indent, ' ') + word : (result.empty() ? "" : " ") + word;
    left = breaks ? 140 - indent - word.size() : left - word.size() - 1;
  }
  return result;
}

std::string help()
{
  return R"(stratus - draws volumes

  stratus render INPUT -o OUT.png [options]   render an image; also .jpg, .tif, .bmp; OUT.exr has floats: R, G, B, A, depth Z, Samples
  stratus render INPUT --frames OUT-%04d.png  render every time step
  stratus render INPUT INPUT ... -o OUT.png   render up to eight as one medium; --array, --select, --opacity, --color and
                                              --unit-distance are for the INPUT before them
  stratus info INPUT [--array NAME]           print the contents of a file or scene: sizes, arrays, cell types; --json OUT: as JSON
  stratus tree INPUT [options] [-o OUT.vtp]   build the tree by which rays skip empty space, print its statistics, write its nodes' boxes
  stratus sort GRID [--depth N] [--up A]      cut a grid into leaves, sort its cells for 16 views, and count cells in wrong order
  stratus compare A B [options]               compare two images (.exr, .png ...) and exit 1 if they differ by more than a limit
  stratus devices                             list the OpenCL devices
  stratus help [TOPIC]                        explain a command (render), a topic (camera) or an option (--opacity)
  stratus completion bash|zsh|fish            print completions for a shell; "man" prints a manual page
  stratus --version                           print the versions of Stratus and its libraries, and the OpenCL devices
  stratus --help

INPUT is a volume file or a scene's name.
  Volume images: .vti .pvti .vtk .mha .mhd .nrrd .nhdr .nii .hdr .tif .png .hdf .vtkhdf .h5 .vdb .nvdb, and others that VTK reads.
  Scenes: cloud, plume, fog, haze, peak, voxel, bone, skin, stripes, shell, plate, labels, cumulus-rectilinear.
  For render and info also:
  - rectilinear grids (.vtr .pvtr);
  - grids of cells, which are divided into tetrahedra: unstructured (.vtu .pvtu .vtk .hdf, TetGen's .node .ele), curvilinear (.vts .pvts),
    netCDF (.nc), folders of Zarr, multi-block (.vtm .vtmb), time series (.pvd), OpenFOAM (.foam, system/controlDict), EnSight (.case);
  - AMR (.vthb .vth): the finest cell at each place is drawn.

Data and appearance
  -o OUT                  the file to write; --output OUT and --output=OUT do the same, as for every option
  --array NAME            point or cell array (default: the active scalars, otherwise the first of one component). A vector array is drawn
                          by its magnitude, or by one component if .x, .y or .z follows the name. --variable is a synonym
  --raw NXxNYxNZ:TYPE     layout of a headerless file (.raw), x fastest. TYPE: int8, uint8, int16, uint16, int32, uint32, float32 or
                          float64. Optional, each after a colon: big (default little), a spacing DX,DY,DZ, +N for N bytes to skip at
                          the start
  --select NAME=INDEX     netCDF, Zarr: read a dimension at one index only, from 0, such as an ensemble's member. Separate several by
                          commas, or repeat --select (default: 0 for dimensions that are neither space nor time, which info lists)
  --time T                the time step: first, last, step:N (from 0), a moment ("2001-01-01 03:00", by the file's calendar), a time in the
                          file's units, or a duration with its unit (3h, 90min, "2 d") since the file's reference time, or with +
                          before it since its first step. The nearest step is used and printed
  --frames OUT-%04d.png   one image for each time step (--time all), all with one transfer function and one camera
  --opacity LIST          "value:alpha,..." with alpha in 0..1 per unit distance (default: the scene's own, otherwise guessed from
                          the histogram: transparent at the background's value, a ramp beyond it; surfaces are opaque, several
                          isosurfaces by half)
  --color NAME|LIST       a colour map, stretched over the values shown; NAME_r reverses it; or "value:r:g:b,..." with r, g, b in 0..1.
                          --color list prints the names: )" +
    wrapped(color_names(", "), 26, 140 - 26 - 31) + R"(
  --crop X,X,Y,Y,Z,Z      draw only the box between these planes across the grid's axes, in the numbers that --axes shows
  --crop-regions N        regions to draw of the 27 that the planes of --crop make: the sum of bits x + 3 y + 9 z, 0..134217727
                          (default 8192: the box between all planes)
  --mask FILE             an image of one byte a value; a value is hidden if its byte is 0
  --mask-raw ...          layout of a headerless mask file, as for --raw
  --unit-distance D       world length to which alpha applies (default: a voxel's edge)
  --exaggerate F          multiply heights (along the upward axis) by F (default 1; of a flat netCDF file on the Earth as much as makes its
                          height a fifth of its width, which the picture says)
  --globe                 show longitudes and latitudes of a netCDF file, its own or by its map projection, on a sphere of 6371 km, with
                          heights times F of --exaggerate (default: as much as makes them reach over a tenth of its radius)
  --log                   map colours, and a guessed opacity, to the logarithm of the value, over at most four decades
  --linear                map them to the value, even if values are lognormal
  --axes                  draw a box around the data, with the file's coordinates: degrees, m or km, depths, pressures
  --coast                 draw coastlines at the bottom of data with longitudes and latitudes or a map projection, of depths at the top,
                          or on the globe
  --color-bar             draw the colours of values, with the variable's name and unit
  --caption TEXT          draw a line of text at the top; {time} is the step's time
  --nearest               nearest instead of linear interpolation
  --shade                 light from the eye, or from each --sun, with the field's gradient as normal (composite, isosurface)
  --scatter               light from the eye, or from each --sun, that the matter scatters once (composite, isosurface); --albedo and
                          --anisotropy say how. With shadows
  --multiple              with --scatter: matter scatters light any number of times, by a solution on a grid
  --shadows               with --shade: matter absorbs light on its way from each sun
  --cloud [R]             draw water of clouds as a photograph shows it, from mass and size of the droplets: see Clouds
  --background B          dark, light, black, white, transparent, r:g:b, or r:g:b,r:g:b from bottom to top (default dark)

Camera
  --size WxH              pixels; W alone: a square (default 512x512)
  --azimuth DEG           about the upward axis, 0 from +x, 90 from +y (default 30; of a netCDF file on the Earth -70, from the south)
  --elevation DEG         above the ground, -90..90 (default 30; of a netCDF file on the Earth 35)
  --zoom F                2 shows everything twice as large (default 1: everything fits)
  --parallel              parallel instead of perspective projection
  --up x|y|z              which axis points upward (default z; a scene has its own)

Rendering
  --tolerance E           root mean square error of RGBA in 0..1 over the lit pixels that automatic settings may cause (default 0.001:
                          60 dB, a quarter of an 8-bit step); 0: the finest settings
  --sample-distance D     world length between samples (default: by the tolerance)
  --sampling S            auto, midpoint, preintegrated, cells (default auto: the cheapest that keeps the tolerance). cells integrates
                          cell by cell; only for composite without --mask
  --cell-error E          for --sampling cells: how far the field may depart from a line, as a fraction of the values that the functions
                          span (default: by the tolerance)
  --jitter SEED           shift each ray's samples by a random part of their distance, which turns banding into noise; the seed selects
                          the noise
  --structure S           how empty space is skipped: auto, none, block, distance, octant, hybrid (default auto); never changes the image
  --mode M                composite; first-hit: voxels of opacity > 0 as solids, lit from the eye; maximum, minimum: the colour of the
                          largest or smallest value on a ray; average, additive: of opacity times value, in grey; isosurface; slice;
                          path: light that is scattered any number of times, see below (default composite)
  --contours V,V,...      isosurfaces' values, 1 to 16, each in its colour and opacity by the transfer functions
  --slice X,Y,Z,NX,NY,NZ  the slice's plane: a point and the normal, in the numbers that --axes shows
  --average-range A,B     range of the values that --mode average uses (default: all)
  --method M              for grids of cells: march rays through faces, or project sorted cells; the image is the same. auto, march,
                          project (default auto: the one that should cost less)
  --normals N             for first-hit: faces, gradient (default faces)
  --device D              auto, host, an OpenCL device's index, or a part of its name (default auto). The device draws, and builds
                          structures that it has kernels for; the image is the same
  --quiet                 print nothing but errors
  --report, -v            print each build stage: its device, kernels that the device ran, milliseconds, bytes
  --threads N             threads of the host (default: all)
  --memory SIZE           memory that values of large files take at most, with what is built of them: 2G, 512M (default: half of what is
                          free). Half of it at least is for values. Chunks of files, and uncompressed files that are larger, are read when
                          a ray meets them, and dropped for others
  --read-timeout S        stop reading INPUT, or a mask, after S seconds without a byte read or progress reported; 0: never (default 60)
  --show samples          show a heat map of the samples that each pixel used, with a scale, instead of the image; --color sets its colours
  --quantity Q            show a map of a number of each pixel's ray, with a scale, instead of the image: integral (of the values over the
                          ray's length), length, mean, maximum, maximum_depth (where it is), cells, transmittance, or transmittance_depth
                          (where the transmittance falls to --threshold). To OUT.exr also several, with commas between them, as channels
                          in addition to the image
  --threshold T           the transmittance for --quantity transmittance_depth, above 0 and below 1 (default 0.5)
  --audit                 draw again without skipping and count the pixels that differ; any is a failure

Scattered light: --mode path traces random paths until their number or their error is reached; images and rectilinear grids.
--sun, --albedo and --anisotropy are for --scatter, too, and --sun for --shade
  --samples N             paths of each pixel (default 256, or as many as --tolerance needs)
  --tolerance E           end when the standard error of the image, root mean square of RGBA over the lit pixels, is at most E
  --sun X,Y,Z[,R,G,B]     direction to a sun, and its colour (default 1,1,1); repeat it for up to 8 (default: light from the eye, or no
                          sun if there is a sky)
  --sun-at A,E[,R,G,B]    direction to a sun by azimuth, degrees clockwise from north (-360..360), and elevation, degrees above the
                          horizon (-90..90). x is east and y is north
  --sun-time T            direction to the sun at a moment in UTC, such as 2024-06-01T15:30, or file: at the time of the step
  --place LAT,LON         where --sun-time is meant, degrees north and east (default: the middle of a file with longitudes and latitudes)
  --sky R,G,B[,R,G,B]     also for --multiple: colour of the sky at the zenith, and at and below the horizon (default: of one colour,
                          as at the zenith)
  --albedo A              part of the light that is scattered, times the colour; the rest is absorbed, 0..1 (default 1)
  --anisotropy G          -.99...99; light is scattered forwards by G > 0 (default 0: evenly)
  --bounces N             largest number of scatterings; 0: no limit (default 0)
  --seed N                selects the noise (default 0)

Clouds: --cloud sets extinction, light, sky and background, all to be replaced by their options; heights are as long as widths
  --cloud [R]             R: effective radius in micrometres, .1..10000 (default 10 of liquid water, 30 of ice). The extinction is 3 W / (2
                          density R) for W kilograms of water in a cubic metre. The variable is the first of cloud water by standard_name or
                          name (qc, QCLOUD, clw ...), or --variable. Mixing ratios are multiplied by the density of air: the file's
                          air_density, or of its air_pressure and air_temperature, otherwise the standard atmosphere's at that height
  --water-units U         unit of the values, such as g/m3 or kg/kg (default: the file's)
  --metres M              length of a unit of the coordinates in metres (default: the file's)
                          The sun is at the file's time and place if these are known and the sun is up, otherwise as by --sun-at 120,40

Trees
  --lower V, --upper V    range of the occupied values (default: values that the opacity shows)
  --method M              )" +
    method_names() + R"( (default auto)
  --mode M                composite: blocks of cells for ray casting; first-hit: voxels (default composite)

Sorting
  --depth N               planes between the mesh and a leaf, 0..16 (default 3)

Comparisons: all given limits must hold; without one, the images must be equal to the bit
  --exact                 all channels have equal bits
  --tolerance E           the root mean square difference of the colours in 0..1, over the pixels that are not 0 in both, is at most E
  --maximum D             each component of each colour differs by at most D, in 0..1
  --ssim S                the structural similarity is at least S, -1..1; 1 means equal
  --difference OUT        write an image of the differences: .png scaled so that the largest is white, .exr unscaled
  --json OUT              write the results, or those of info, as JSON; -: to the standard output, instead of text
  --junit OUT             write the verdict as a JUnit test

The stack limit must be at least 256 KiB (ulimit -s).
The exit status is 0 if the image was written completely, or the images compared are within the limits; 1 if something failed or the
images differ; 2 if the command line was not understood.

  stratus render cloud -o cloud.png
  stratus render head.mha -o head.png --opacity "0:0,300:0,1500:.3" --color gray --azimuth 120 --size 1024x768
)";
}

namespace {

void set_size(options& o, const std::string& text)
{
  std::vector<std::string> sides = split(text, 'x');
  if (sides.size() == 1) { // of a square
    sides.push_back(sides[0]);
  }
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

double not_negative(const std::string& text, const std::string& what)
{
  const double value = number(text, what);
  if (value < 0.0) {
    throw usage(what + ": " + text + " is below 0");
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
  for (int i = STRATUS_MODE_COMPOSITE; i <= STRATUS_MODE_SLICE; ++i) {
    const stratus_mode mode = static_cast<stratus_mode>(i);
    if (text == stratus_mode_name(mode)) {
      return mode;
    }
    names += std::string(i ? ", " : "") + stratus_mode_name(mode);
  }
  throw usage("--mode: '" + text + "' is none of " + names + ", path");
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
  if (text == "cells") {
    return STRATUS_SAMPLING_CELLS;
  }
  throw usage("--sampling: '" + text + "' is none of auto, midpoint, preintegrated, cells");
}

// ---- tables of options

template <std::string options::*Text> void keep(options& o, const std::string&, const std::string& value)
{
  o.*Text = value;
}

template <double options::*Number> void keep_number(options& o, const std::string& word, const std::string& value)
{
  o.*Number = number(value, word);
}

template <double options::*Number> void keep_positive(options& o, const std::string& word, const std::string& value)
{
  o.*Number = positive(value, word);
}

template <double options::*Number> void keep_not_negative(options& o, const std::string& word, const std::string& value)
{
  o.*Number = not_negative(value, word);
}

template <double options::*Bound> void keep_bound(options& o, const std::string& word, const std::string& value)
{
  o.*Bound = number(value, word);
  o.has_range = true;
}

void set_method(options& o, const std::string&, const std::string& value)
{
  if (o.command == "render") {
    o.tetra_method = tetra_method_named(value);
  } else {
    o.agglomerative_by_edges = value == "ac-edges";
    o.uncorrected_flooding = value == "hybrid-paper-raw";
    o.method = o.agglomerative_by_edges ? STRATUS_TREE_AC : o.uncorrected_flooding ? STRATUS_TREE_HYBRID_PAPER : method_named(value);
  }
}

void set_exaggeration(options& o, const std::string& word, const std::string& value)
{
  o.exaggeration = positive(value, word);
  o.has_exaggeration = true;
}

void set_azimuth(options& o, const std::string& word, const std::string& value)
{
  o.azimuth = number(value, word);
  o.has_azimuth = true;
}

void set_elevation(options& o, const std::string& word, const std::string& value)
{
  o.elevation = within(value, word, -90.0, 90.0);
  o.has_elevation = true;
}

void set_up(options& o, const std::string& word, const std::string& value)
{
  if (value != "x" && value != "y" && value != "z") {
    throw usage(word + ": '" + value + "' is none of x, y, z");
  }
  o.up = value;
}

void set_show(options& o, const std::string& word, const std::string& value)
{
  if (value != "picture" && value != "samples") {
    throw usage(word + ": '" + value + "' is none of picture, samples");
  }
  o.shows_samples = value == "samples";
}

void set_quantities(options& o, const std::string& word, const std::string& value)
{
  for (const std::string& name : split(value, ',')) {
    std::string names;
    int quantity = 0;
    while (quantity < STRATUS_QUANTITY_COUNT && name != stratus_quantity_name(static_cast<stratus_quantity>(quantity))) {
      names += std::string(quantity ? ", " : "") + stratus_quantity_name(static_cast<stratus_quantity>(quantity));
      ++quantity;
    }
    if (quantity == STRATUS_QUANTITY_COUNT) {
      throw usage(word + ": '" + name + "' is none of " + names);
    }
    o.quantities.push_back(static_cast<stratus_quantity>(quantity));
  }
}

void set_threshold(options& o, const std::string& word, const std::string& value)
{
  o.threshold = number(value, word);
  if (!(o.threshold > 0.0 && o.threshold < 1.0)) {
    throw usage(word + ": " + value + " must be above 0 and below 1");
  }
}

// Takes "out-%04d.png": one %d, with a width or without.
void set_frames(options& o, const std::string& word, const std::string& value)
{
  const size_t percent = value.find('%');
  size_t end = percent == std::string::npos ? value.size() : percent + 1;
  while (end < value.size() && std::isdigit(static_cast<unsigned char>(value[end]))) {
    ++end;
  }
  if (end >= value.size() || value[end] != 'd' || end - percent > 3 || value.find('%', percent + 1) != std::string::npos) {
    throw usage(word + ": '" + value + "' needs one number like %d or %04d, the step's");
  }
  o.frames = value;
}

void set_mode(options& o, const std::string&, const std::string& value)
{
  o.path = value == "path";
  o.mode = o.path ? STRATUS_MODE_COMPOSITE : mode_named(value);
}

// Keeps a whole number for --mode path.
template <int options::*Number, int Least> void keep_path_number(options& o, const std::string& word, const std::string& value)
{
  o.*Number = whole_number(value, word, Least, 1000000000);
  o.of_path = word;
}

void set_sun(options& o, const std::string& word, const std::string& value)
{
  o.suns.push_back(numbers(value, word, 3, 6));
  if (o.suns.back().size() % 3 != 0) {
    throw usage(word + ": '" + value + "' is neither X,Y,Z nor X,Y,Z,R,G,B");
  }
  if (o.suns.size() > STRATUS_LIGHTS_MAX) {
    throw usage(word + ": " + std::to_string(o.suns.size()) + format(" suns, must be %d at most", STRATUS_LIGHTS_MAX));
  }
}

void set_sky(options& o, const std::string& word, const std::string& value)
{
  o.sky = numbers(value, word, 3, 6);
  o.has_sky = true;
  if (o.sky.size() % 3 != 0) {
    throw usage(word + ": '" + value + "' is neither R,G,B nor R,G,B,R,G,B");
  }
}

template <double options::*Number> void keep_scattering(options& o, const std::string& word, const std::string& value)
{
  o.*Number = number(value, word); // the core knows the range
  o.of_scattering = word;
}

void set_sun_at(options& o, const std::string& word, const std::string& value)
{
  o.sun_at = numbers(value, word, 2, 5);
  if (o.sun_at.size() != 2 && o.sun_at.size() != 5) {
    throw usage(word + ": '" + value + "' is neither AZIMUTH,ELEVATION nor AZIMUTH,ELEVATION,R,G,B");
  }
}

void set_sun_time(options& o, const std::string& word, const std::string& value)
{
  if (value != "file") {
    const context core("host", 1);
    double seconds = 0.0;
    core.check(stratus_time_parse(core, value.c_str(), &seconds), word);
  }
  o.sun_time = value;
}

void set_radius(options& o, const std::string& value)
{
  o.radius = within(value, "--cloud", 0.1, 10000.0) * 1e-6;
}

void set_water_units(options& o, const std::string& word, const std::string& value)
{
  double factor = 1.0;
  if (stratus_cloud_unit(value.c_str(), &factor) == STRATUS_CLOUD_UNKNOWN) {
    throw usage(word + ": '" + value + "' is no mass of water in a volume or a mass of air, such as kg/m3, g/m3, kg/kg or g/kg");
  }
  o.water_units = value;
}

void set_tolerance(options& o, const std::string& word, const std::string& value)
{
  o.has_tolerance = true;
  (o.command == "compare" ? o.largest_mean : o.tolerance) = not_negative(value, word);
}

bool is_number(const std::string& word)
{
  char* end = nullptr;
  std::strtod(word.c_str(), &end);
  return !word.empty() && *end == '\0';
}

using text = const std::string&;

// In the order of help().
constexpr struct {
  const char* word;
  void (*set)(options& o, text word, text value);
} with_value[] = {
  { "-o", keep<&options::output> },
  { "--output", keep<&options::output> },
  { "--array", keep<&options::array> },
  { "--variable", keep<&options::array> },
  { "--raw", keep<&options::raw> },
  { "--select", [](options& o, text, text value) { o.select += (o.select.empty() ? "" : ",") + value; } },
  { "--time", keep<&options::time> },
  { "--frames", set_frames },
  { "--opacity", keep<&options::opacity> },
  { "--color", keep<&options::color> },
  { "--crop", [](options& o, text word, text value) { o.crop = numbers(value, word, 6, 6); } },
  { "--crop-regions", [](options& o, text word, text value) { o.crop_regions = whole_number(value, word, 0, STRATUS_CROP_ALL); } },
  { "--mask", keep<&options::mask> },
  { "--mask-raw", keep<&options::mask_raw> },
  { "--unit-distance", keep_positive<&options::unit_distance> },
  { "--exaggerate", set_exaggeration },
  { "--caption", keep<&options::caption> },
  { "--background", keep<&options::background> },
  { "--size", [](options& o, text, text value) { set_size(o, value); } },
  { "--azimuth", set_azimuth },
  { "--elevation", set_elevation },
  { "--zoom", [](options& o, text word, text value) { o.zoom = within(value, word, 0.15, 1e6); } },
  { "--up", set_up },
  { "--sample-distance", keep_positive<&options::sample_distance> },
  { "--tolerance", set_tolerance },
  { "--sampling", [](options& o, text, text value) { o.sampling = sampling_named(value); } },
  { "--cell-error", keep_positive<&options::cell_error> },
  { "--jitter", [](options& o, text word, text value) { o.jitter = whole_number(value, word, 0, std::numeric_limits<int>::max()); } },
  { "--structure", [](options& o, text, text value) { o.structure = structure_named(value); } },
  { "--mode", set_mode },
  { "--contours", [](options& o, text word, text value) { o.contours = numbers(value, word, 1, STRATUS_CONTOURS_MAX); } },
  { "--slice", [](options& o, text word, text value) { o.slice = numbers(value, word, 6, 6); } },
  { "--average-range", [](options& o, text word, text value) { o.average = numbers(value, word, 2, 2); } },
  { "--method", set_method },
  { "--normals", [](options& o, text, text value) { o.normals = normals_named(value); } },
  { "--device", keep<&options::device> },
  { "--threads", [](options& o, text word, text value) { o.threads = whole_number(value, word, 1, 1024); } },
  { "--memory", [](options& o, text word, text value) { o.memory = byte_size(value, word, 16e6, 1e15); } },
  { "--read-timeout", [](options& o, text word, text value) { o.read_timeout = within(value, word, 0.0, 1e6); } },
  { "--show", set_show },
  { "--quantity", set_quantities },
  { "--threshold", set_threshold },
  { "--samples", keep_path_number<&options::samples, 1> },
  { "--sun", set_sun },
  { "--sun-at", set_sun_at },
  { "--sun-time", set_sun_time },
  { "--place", [](options& o, text word, text value) { o.place = numbers(value, word, 2, 2); } },
  { "--sky", set_sky },
  { "--albedo", keep_scattering<&options::albedo> },
  { "--anisotropy", keep_scattering<&options::anisotropy> },
  { "--bounces", keep_path_number<&options::bounces, 0> },
  { "--seed", keep_path_number<&options::seed, 0> },
  { "--water-units", set_water_units },
  { "--metres", keep_positive<&options::metres> },
  { "--lower", keep_bound<&options::lower> },
  { "--upper", keep_bound<&options::upper> },
  { "--depth", [](options& o, text word, text value) { o.depth = whole_number(value, word, 0, 16); } },
  { "--maximum", keep_not_negative<&options::largest_difference> },
  { "--ssim", [](options& o, text word, text value) { o.least_ssim = within(value, word, -1.0, 1.0); } },
  { "--difference", keep<&options::difference> },
  { "--json", keep<&options::json> },
  { "--junit", keep<&options::junit> },
};

constexpr struct {
  const char* word;
  bool options::*flag;
} flags[] = {
  { "--nearest", &options::nearest },
  { "--log", &options::logarithmic },
  { "--linear", &options::linear },
  { "--axes", &options::axes },
  { "--coast", &options::coast },
  { "--globe", &options::globe },
  { "--color-bar", &options::color_bar },
  { "--shade", &options::shade },
  { "--scatter", &options::scatter },
  { "--shadows", &options::shadows },
  { "--multiple", &options::multiple },
  { "--parallel", &options::parallel },
  { "--audit", &options::audit },
  { "--report", &options::report },
  { "-v", &options::report },
  { "--quiet", &options::quiet },
  { "--exact", &options::exact },
};

// Finds a word in a table. Returns nullptr where the table lacks it.
template <class Table> auto find_word(const Table& table, const std::string& word)
{
  const auto found = std::find_if(std::begin(table), std::end(table), [&](const auto& entry) { return word == entry.word; });
  return found == std::end(table) ? nullptr : found;
}

// Sets an option of the INPUT before it. Returns false for options of the whole picture.
template <class Entry> bool set_companion(companion& last, const Entry* entry, const std::string& value)
{
  options own;
  const std::string word = entry->word;
  if (word != "--array" && word != "--variable" && word != "--raw" && word != "--select" && word != "--opacity" && word != "--color" &&
    word != "--unit-distance") {
    return false;
  }
  entry->set(own, word, value);
  last.array = own.array.empty() ? last.array : own.array;
  last.raw = own.raw.empty() ? last.raw : own.raw;
  last.select += (last.select.empty() || own.select.empty() ? "" : ",") + own.select;
  last.opacity = own.opacity.empty() ? last.opacity : own.opacity;
  last.color = own.color.empty() ? last.color : own.color;
  last.unit_distance = own.unit_distance > 0.0 ? own.unit_distance : last.unit_distance;
  return true;
}

// The words of the command line, where "--option=value" is two.
std::vector<std::string> words_of(int argc, char* argv[])
{
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const size_t equals = word.compare(0, 2, "--") == 0 ? word.find('=') : std::string::npos;
    const std::string option = word.substr(0, equals);
    const bool splits = equals != std::string::npos && (find_word(with_value, option) || option == "--cloud");
    words.push_back(splits ? option : word);
    if (splits) {
      words.push_back(word.substr(equals + 1));
    }
  }
  return words;
}

void check_output(const options& o)
{
  if (o.command != "render") {
    return;
  }
  if (o.time == "all" && o.frames.empty()) {
    throw usage("--time all: where to? Give --frames 'out-%04d.png'");
  }
  if (!o.frames.empty() && (!o.output.empty() || !(o.time.empty() || o.time == "all"))) {
    throw usage("--frames draws all steps: leave out " + std::string(o.output.empty() ? "--time " + o.time : "-o"));
  }
  if (!o.frames.empty() && !o.companions.empty()) {
    throw usage("--frames draws one INPUT: leave out '" + o.companions[0].source + "'");
  }
  if (o.output.empty() && o.frames.empty()) {
    throw usage("render: where to? Give -o OUT.png");
  }
}

void check_path(const options& o)
{
  if (!o.path) {
    if (!o.of_path.empty()) {
      throw usage(o.of_path + " is for --mode path");
    }
    if (o.has_sky && !o.multiple) {
      throw usage("--sky is for --scatter --multiple and --mode path");
    }
    if (o.multiple && !o.scatter) {
      throw usage("--multiple is for --scatter");
    }
    if (!o.of_scattering.empty() && !o.scatter) {
      throw usage(o.of_scattering + " is for --scatter and --mode path");
    }
    const char* const sun = !o.suns.empty() ? "--sun" : !o.sun_at.empty() ? "--sun-at" : !o.sun_time.empty() ? "--sun-time" : nullptr;
    if (sun && !o.scatter && !o.shade) {
      throw usage(std::string(sun) + " is for --shade, --scatter and --mode path");
    }
    if (o.shadows && !o.shade) {
      throw usage("--shadows is for --shade; --scatter has them");
    }
    return;
  }
  const char* other = o.shade               ? "--shade"
    : o.scatter                             ? "--scatter"
    : o.multiple                            ? "--multiple"
    : o.shadows                             ? "--shadows"
    : o.sampling != STRATUS_SAMPLING_AUTO   ? "--sampling"
    : o.sample_distance > 0.0               ? "--sample-distance"
    : o.cell_error > 0.0                    ? "--cell-error"
    : o.jitter >= 0                         ? "--jitter"
    : o.structure != STRATUS_STRUCTURE_AUTO ? "--structure"
    : o.audit                               ? "--audit"
                                            : nullptr;
  if (other) {
    throw usage(std::string("--mode path has light and samples of its own: leave out ") + other);
  }
  if (o.command != "render") {
    throw usage("--mode path is for render, not " + o.command);
  }
  if (!o.companions.empty()) {
    throw usage("--mode path draws one INPUT: leave out '" + o.companions[0].source + "'");
  }
  if (o.device != "auto" && o.device != "host") {
    throw usage("--mode path is computed by the host: leave out --device " + o.device);
  }
  if (o.has_tolerance && o.tolerance == 0.0) {
    throw usage("--tolerance 0 is reached by no number of paths: give more, or --samples");
  }
}

// As VTK's mappers, modes that are not lit ignore how matter scatters light, but not without a word.
void warn_of_ignored(const options& o)
{
  const char* const ignored = o.scatter ? "--scatter" : o.shadows ? "--shadows" : nullptr;
  if (ignored && !o.path && o.mode != STRATUS_MODE_COMPOSITE && o.mode != STRATUS_MODE_ISOSURFACE) {
    std::fprintf(
      stderr, "stratus: warning: %s has no effect in mode %s, only in composite and isosurface\n", ignored, stratus_mode_name(o.mode));
  }
}

void check_suns(const options& o)
{
  if (!o.sun_at.empty() && !o.sun_time.empty()) {
    throw usage("--sun-at and --sun-time are two directions of one sun: leave out one");
  }
  if (!o.place.empty() && o.sun_time.empty()) {
    throw usage("--place: when? Give --sun-time, or --sun-time file");
  }
  if (o.suns.size() == STRATUS_LIGHTS_MAX && (!o.sun_at.empty() || !o.sun_time.empty())) {
    throw usage(format("--sun: %d suns and one more, must be %d at most", STRATUS_LIGHTS_MAX, STRATUS_LIGHTS_MAX));
  }
}

void check_cloud(const options& o)
{
  if (o.logarithmic && o.linear) {
    throw usage("--log and --linear are two scales: leave out one");
  }
  const char* const of_cloud = o.metres > 0.0 ? "--metres" : !o.water_units.empty() ? "--water-units" : nullptr;
  if (!o.cloud && of_cloud) {
    throw usage(std::string(of_cloud) + " is for --cloud");
  }
  const char* other = !o.cloud         ? nullptr
    : !o.opacity.empty()               ? "--opacity"
    : o.unit_distance > 0.0            ? "--unit-distance"
    : o.logarithmic                    ? "--log"
    : o.linear                         ? "--linear"
    : o.color_bar                      ? "--color-bar"
    : o.shade                          ? "--shade"
    : o.mode != STRATUS_MODE_COMPOSITE ? "--mode"
                                       : nullptr;
  if (other) {
    throw usage(std::string("--cloud has opacity and light of its own: leave out ") + other);
  }
  if (o.cloud && o.command != "render") {
    throw usage("--cloud is for render, not " + o.command);
  }
  if (o.cloud && !o.companions.empty()) {
    throw usage("--cloud draws one INPUT: leave out '" + o.companions[0].source + "'");
  }
}

void check_complete(const options& o)
{
  if (!o.json.empty() && o.command != "info" && o.command != "compare") {
    throw usage("--json is for info and compare, not " + o.command);
  }
  check_suns(o);
  check_cloud(o);
  check_path(o);
  if (o.command == "render" || o.command == "info" || o.command == "tree" || o.command == "sort") {
    if (o.source.empty()) {
      throw usage(o.command + ": which INPUT?");
    }
    check_output(o);
    if ((o.shows_samples || !o.quantities.empty()) && (o.axes || o.coast || o.color_bar || !o.caption.empty())) {
      throw usage(std::string(o.shows_samples ? "--show samples" : "--quantity") +
        " is no picture of values: leave out --axes, --coast, --color-bar and --caption");
    }
    if (o.shows_samples && !o.quantities.empty()) {
      throw usage("--show samples and --quantity are two pictures: leave out one");
    }
    if (o.mode == STRATUS_MODE_ISOSURFACE && o.contours.empty()) {
      throw usage("--mode isosurface: which values? Give --contours V,V,...");
    }
    if ((o.mode == STRATUS_MODE_SLICE) == o.slice.empty()) {
      throw usage(o.slice.empty() ? "--mode slice: where? Give --slice X,Y,Z,NX,NY,NZ" : "--slice is for --mode slice");
    }
    if (o.crop_regions != STRATUS_CROP_INSIDE && o.crop.empty()) {
      throw usage("--crop-regions: between which planes? Give --crop X,X,Y,Y,Z,Z");
    }
    if (!o.mask_raw.empty() && o.mask.empty()) {
      throw usage("--mask-raw: of which file? Give --mask FILE");
    }
    if (o.cell_error > 0.0 && o.sampling != STRATUS_SAMPLING_AUTO && o.sampling != STRATUS_SAMPLING_CELLS) {
      throw usage("--cell-error is for --sampling cells, or auto");
    }
    if (o.sampling == STRATUS_SAMPLING_CELLS) {
      const char* what = o.mode != STRATUS_MODE_COMPOSITE ? "--mode" : o.mask.empty() ? nullptr : "--mask";
      if (what) {
        throw usage(std::string("--sampling cells is for composite without mask: leave out ") + what);
      }
      if (o.sample_distance > 0.0) {
        throw usage("--sampling cells has no step: give --cell-error in place of --sample-distance");
      }
    }
    if (o.command == "tree" && o.mode > STRATUS_MODE_FIRST_HIT) {
      throw usage(std::string("tree: --mode '") + stratus_mode_name(o.mode) + "' is none of composite, first-hit");
    }
    if (o.lower > o.upper) {
      throw usage(format("--lower: %g is above --upper %g", o.lower, o.upper));
    }
  } else if (o.command == "compare") {
    if (o.source.empty() || o.baseline.empty()) {
      throw usage("compare: which pictures? Give compare A B");
    }
  } else if (o.command == "completion") {
    if (o.source.empty()) {
      throw usage("completion: of which shell? Give bash, zsh, fish or man");
    }
  } else if (o.command != "devices" && o.command != "version" && o.command != "help") {
    throw usage(
      o.command.empty() ? "no command\n\n" + help_about("") : "unknown command '" + o.command + "'" + meant(o.command, commands()));
  }
}
} // namespace

std::vector<std::string> option_words()
{
  std::vector<std::string> words = { "--cloud", "--help", "--version" };
  for (const auto& entry : with_value) {
    words.emplace_back(entry.word);
  }
  for (const auto& entry : flags) {
    words.emplace_back(entry.word);
  }
  std::sort(words.begin(), words.end());
  return words;
}

options parse(int argc, char* argv[])
{
  options o;
  if (std::any_of(argv + 1, argv + std::max(argc, 1), [](const char* word) { return std::string(word) == "--cloud"; })) {
    set_cloud_look(o); // before the options that replace parts of it
  }
  if (argc > 1 && std::string(argv[1]) == "help") {
    o.command = "help";
    o.source = argc > 2 ? argv[2] : "";
    o.topical = true;
    return o;
  }
  std::vector<std::string> words = words_of(argc, argv);
  for (size_t i = 0; i < words.size(); ++i) {
    const std::string word = words[i];
    if (word == "--cloud") {
      if (i + 1 < words.size() && is_number(words[i + 1])) {
        set_radius(o, words[++i]);
      }
      continue;
    }
    if (word == "--help" || word == "-h") {
      o.topical = !o.command.empty();
      o.source = o.command;
      o.command = "help";
      return o;
    }
    if (word == "--version" || word == "-V" || (word == "-v" && words.size() == 1)) {
      o.command = "version";
      return o;
    }
    if (const auto* entry = find_word(with_value, word)) {
      if (i + 1 == words.size()) {
        const std::string about = help_about(word);
        throw usage(word + " needs a value, as in " + about.substr(0, about.find('\n')));
      }
      if (word == "--color" && words[i + 1] == "list") {
        o.command = "colors";
        return o;
      }
      if (o.companions.empty() || !set_companion(o.companions.back(), entry, words[i + 1])) {
        entry->set(o, word, words[i + 1]);
      }
      ++i;
    } else if (const auto* flag = find_word(flags, word)) {
      o.*flag->flag = true;
    } else if (word.size() > 1 && word[0] == '-') {
      throw usage("unknown option '" + word + "'" + meant(word, option_words()));
    } else if (o.command.empty()) {
      o.command = word;
    } else if (o.source.empty()) {
      o.source = word;
    } else if (o.command == "compare" && o.baseline.empty()) {
      o.baseline = word;
    } else if (o.command == "render" && o.companions.size() + 1 < STRATUS_SEVERAL_MAX) {
      o.companions.push_back({ word, "", "", "", "", "", 0.0 });
    } else {
      throw usage((o.command == "compare" ? "compare takes two pictures"
                                          : "one INPUT at a time, or of render up to " + std::to_string(STRATUS_SEVERAL_MAX)) +
        ": '" + word + "' is too many");
    }
  }
  o.scatter = o.scatter || (o.cloud && !o.path); // the path tracer scatters by itself
  o.multiple = o.multiple || (o.cloud && !o.path);
  check_complete(o);
  warn_of_ignored(o);
  return o;
}
} // namespace cli
