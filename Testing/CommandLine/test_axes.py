# SPDX-License-Identifier: BSD-3-Clause
"""Axes around a picture: titles are whole, keep off the colour bar, and name what the numbers are, in one unit of length. Usage:
test_axes.py PATH-OF-STRATUS FOLDER"""
import os
import subprocess
import sys

import netCDF4
import numpy
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkPNGReader
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

STRATUS, FOLDER = os.path.realpath(sys.argv[1]), sys.argv[2]
os.makedirs(FOLDER, exist_ok=True)
os.chdir(FOLDER)
nz, ny, nx = 6, 7, 9
failures = 0


def check(condition, what):
    global failures
    if not condition:
        failures += 1
        print("does not hold:", what)


def write(name, axes, more=()):
    """axes: (name, values, attributes) of z, y, x; more: other variables, as (name, dimensions, values, attributes)"""
    with netCDF4.Dataset(name + ".nc", "w") as file:
        for axis, values, attributes in axes:
            file.createDimension(axis, len(values))
            if attributes is not None:
                file.createVariable(axis, "f8", (axis,))[:] = values
                file[axis].setncatts(attributes)
        for other, dimensions, values, attributes in more:
            for dimension, size in zip(dimensions, numpy.shape(values)):
                if dimension not in file.dimensions:
                    file.createDimension(dimension, size)
            file.createVariable(other, "f8", dimensions)[...] = values
            file[other].setncatts(attributes)
        values = file.createVariable("q", "f4", [axis for axis, _, _ in axes])
        values[:] = numpy.linspace(0, 1, values.size).reshape(values.shape)
        values.units = "kg kg-1"
        if more:
            values.coordinates = "XLONG XLAT"
    return name + ".nc"


def run(*words):
    return subprocess.run([STRATUS, *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300)


def drawn(name, *words, size="512x512"):
    """As annotations(), without the caption that names a factor of heights."""
    lines = annotations(name, *words, size=size)
    if "--exaggerate" in words:
        lines[annotations(name, "--exaggerate", words[words.index("--exaggerate") + 1], size=size) > 0] = 0
    return lines


def annotations(name, *words, size):
    """The annotations of a picture that shows nothing otherwise, over black: brightness[row, column], bottom row first. Of files with and
    without units heights and view are the same."""
    for word, usual in ("--exaggerate", "1"), ("--azimuth", "30"), ("--elevation", "30"):
        words += () if word in words else (word, usual)
    done = run("render", name, "-o", "out.png", "--size", size, "--device", "host", "--variable", "q", "--opacity", "0:0", "--background",
        "black", "--color", "viridis", *words)
    check(done.returncode == 0, "%s %s: %s" % (name, " ".join(words), done.stdout))
    reader = vtkPNGReader()
    reader.SetFileName("out.png")
    reader.Update()
    width, height, _ = reader.GetOutput().GetDimensions()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).reshape(height, width, -1)[..., :3].max(axis=2).astype(int)


metres, east, north = {"units": "m"}, numpy.linspace(-1e4, 2e4, nx), numpy.linspace(0, 25e3, ny)
shapes = {"flat": (numpy.linspace(0, 500, nz), 1), "deep": (numpy.linspace(-5700, -0.5, nz), 1), "cube": (numpy.linspace(0, 12e3, nz), 2),
    "tall": (numpy.linspace(0, 12e3, nz), 9)}
for name, (height, exaggeration) in shapes.items():
    path = write(name, (("zh", height, metres), ("yh", north, metres), ("xh", east, metres)))
    for size in ("512x512", "800x500") if name == "flat" else ("512x512",):
        bar = drawn(path, "--color-bar", "--exaggerate", str(exaggeration), size=size)  # a caption moves the bar
        rows, columns = numpy.nonzero(bar)
        left = numpy.nonzero(bar[(rows.min() + rows.max()) // 2])[0].min()
        place = slice(rows.min(), rows.max() + 1), slice(left, bar.shape[1])
        for look in (("--azimuth", "0"), ("--azimuth", "200", "--elevation", "60", "--parallel"),
            ("--azimuth", "330", "--elevation", "25")):
            both = drawn(path, "--color-bar", "--axes", "--exaggerate", str(exaggeration), *look, size=size)
            edge = numpy.concatenate([both[:2].ravel(), both[-2:].ravel(), both[:, :2].ravel(), both[:, -2:].ravel()])
            where = "%s at %s %s" % (name, size, " ".join(look))
            check(edge.max() == 0, where + ": a title or number is cut off at the picture's edge")
            check(numpy.array_equal(both[place], bar[place]), where + ": something runs into the colour bar")


def same(one, other, what):
    """Alike up to roundings of places: letters and lines may differ by a few pixels."""
    difference = numpy.abs(one - other)
    check((difference > 60).sum() <= 12, "%s: %d pixels differ" % (what, (difference > 60).sum()))


def bare(name, names, height, y, x):
    """The same numbers without units, under names that say what the titles have to say."""
    return write(name, tuple((label, values, {}) for label, values in zip(names, (height, y, x))))


height = shapes["flat"][0]
kilo = bare("kilo", ("height (km)", "yh (km)", "xh (km)"), height / 1000, north / 1000, east / 1000)
same(drawn("flat.nc", "--axes"), drawn(kilo, "--axes"), "axes of metres are in km, all of them")
in_km = write("in km", (("zh", height / 1000, {"units": "km"}), ("yh", north / 1000, {"units": "km"}), ("xh", east / 1000, {"units": "km"})))
same(drawn("flat.nc", "--axes"), drawn(in_km, "--axes"), "a file in km")
short = write("short", (("zh", height, metres), ("yh", north / 10, metres), ("xh", east / 10, metres)))
same(drawn(short, "--axes"), drawn(bare("metre", ("height (m)", "yh (m)", "xh (m)"), height, north / 10, east / 10), "--axes"),
    "axes below 10 km are in m")
changed = write("changed", (("zh", height, metres), ("yh", north, metres), ("other", east, metres)))
check((numpy.abs(drawn("flat.nc", "--axes") - drawn(changed, "--axes")) > 60).sum() > 50, "the title of x is its coordinate's name")

# Places are on a sphere, and WRF's levels heights, but axes have the file's own numbers.
lon, lat, top = numpy.linspace(-97, -96.3, nx), numpy.linspace(40, 40.5, ny), numpy.linspace(0, 12e3, nz + 1)
z = .5 * (top[1:] + top[:-1])
globe = write("globe", (("zh", z, metres), ("lat", lat, {"units": "degrees_north"}), ("lon", lon, {"units": "degrees_east"})))
stack = numpy.ones((1, ny, nx))
geopotential = numpy.broadcast_to(9.81 * top[:, None, None], (nz + 1, ny, nx))
levels = ("bottom_top_stag", "south_north", "west_east")
wrf = write("wrf", (("bottom_top", z, None), ("south_north", lat, None), ("west_east", lon, None)), (
    ("XLONG", levels[1:], numpy.broadcast_to(lon, (ny, nx)), {"units": "degree_east"}),
    ("XLAT", levels[1:], numpy.broadcast_to(lat[:, None], (ny, nx)), {"units": "degree_north"}),
    ("PH", levels, 0 * geopotential, {"units": "m2 s-2"}), ("PHB", levels, geopotential, {"units": "m2 s-2"})))
expected = drawn(globe, "--axes")
same(drawn(wrf, "--axes"), expected, "WRF's axes are longitude, latitude and height")
north_pole = write("north pole", (("zh", z, metres), ("rlat", lat, {"units": "degrees", "standard_name": "grid_latitude"}),
    ("rlon", lon, {"units": "degrees", "standard_name": "grid_longitude"})))
check((numpy.abs(drawn(north_pole, "--axes") - expected) > 60).sum() > 200, "degrees about another pole are not east and north")


def axes_of(path):
    """The row "axes" of info."""
    done = run("info", path)
    rows = [line.split(None, 1)[1] for line in done.stdout.splitlines() if line.startswith("  axes")]
    check(done.returncode == 0 and len(rows) == 1, "%s has one row of axes: %s" % (path, done.stdout))
    return rows[0] if rows else ""


def has_axes(path, expected):
    found = axes_of(path)
    check(found == expected, "%s: '%s', not '%s'" % (path, found, expected))


degrees = (("lat", lat, {"units": "degrees_north", "long_name": "Latitude"}), ("lon", lon, {"units": "degrees_east"}))
west = "longitude -97 .. -96.3 degrees, Latitude 40 .. 40.5 degrees, "
has_axes(globe, "longitude -97 .. -96.3 degrees, latitude 40 .. 40.5 degrees, height 1000 .. 11000 m")
has_axes(north_pole, "grid longitude -97 .. -96.3 degrees, grid latitude 40 .. 40.5 degrees, height 1000 .. 11000 m")
has_axes("flat.nc", "xh -10000 .. 20000 m, yh 0 .. 25000 m, height 0 .. 500 m")
depths = numpy.array([.5, 10, 100, 1000, 3000, 5700])
deep = write("depths", (("deptht", depths, {"units": "m", "positive": "down", "long_name": "Vertical T levels"}), *degrees))
has_axes(deep, west + "Vertical T levels 5700 .. 0.5 m")
sentence = write("sentence", (("depth", depths / 1000, {"units": "km", "standard_name": "depth",
    "long_name": "depth below the surface of the sea, at points of temperature"}), *degrees))
has_axes(sentence, west + "depth 5700 .. 0.5 m")
pressures = numpy.array([100000, 85000, 70000, 50000, 25000, 10000])
pressure = write("pressure", (("plev", pressures, {"units": "Pa", "standard_name": "air_pressure"}), *degrees))
has_axes(pressure, west + "air pressure 1000 .. 100 hPa")
turned = write("turned", (("plev", pressures[::-1] / 100, {"units": "hPa", "standard_name": "air_pressure"}), *degrees))
has_axes(turned, west + "air pressure 1000 .. 100 hPa")
same(drawn(turned, "--axes"), drawn(pressure, "--axes"), "levels of pressure from above or below, in Pa or hPa")
check((numpy.abs(drawn(deep, "--axes") - drawn(deep, "--axes", "--exaggerate", "2")) > 60).sum() > 50, "heights can be exaggerated")

# Heights that a formula gives, and unstructured meshes: depths count downwards.
levels = ("sigma", "y", "x")
sigma = write("terrain", (("sigma", numpy.linspace(-1, 0, nz), {"standard_name": "ocean_sigma_coordinate", "positive": "up",
    "formula_terms": "sigma: sigma eta: eta depth: bed"}), ("y", lat, None), ("x", lon, None)), (
    ("XLONG", levels[1:], numpy.broadcast_to(lon, (ny, nx)), {"units": "degrees_east"}),
    ("XLAT", levels[1:], numpy.broadcast_to(lat[:, None], (ny, nx)), {"units": "degrees_north"}),
    ("eta", levels[1:], numpy.zeros((ny, nx)), {"units": "m"}), ("bed", levels[1:], numpy.full((ny, nx), 200.0), {"units": "m"})))
has_axes(sigma, "longitude -97 .. -96.3 degrees, latitude 40 .. 40.5 degrees, depth 200 .. 0 m")
with netCDF4.Dataset("mesh.nc", "w") as file:
    for name, size in ("node", 4), ("face", 2), ("corner", 3), ("layer", nz):
        file.createDimension(name, size)
    file.createVariable("mesh", "i4").setncatts({"cf_role": "mesh_topology", "topology_dimension": 2, "node_coordinates": "node_x node_y",
        "face_node_connectivity": "corners"})
    for name, values, about in (("node_x", [5, 6, 6, 5], {"units": "degrees_east", "long_name": "longitude of nodes"}),
            ("node_y", [50, 50, 51, 51], {"units": "degrees_north", "standard_name": "latitude"})):
        file.createVariable(name, "f8", ("node",))[:] = values
        file[name].setncatts(about)
    file.createVariable("corners", "i4", ("face", "corner"))[:] = [[0, 1, 2], [0, 2, 3]]
    file["corners"].setncatts({"start_index": 0})
    file.createVariable("layer", "f8", ("layer",))[:] = depths
    file["layer"].setncatts({"units": "m", "positive": "down", "standard_name": "depth"})
    file.createVariable("q", "f8", ("face", "layer"))[:] = numpy.arange(2 * nz).reshape(2, nz)
    file["q"].setncatts({"mesh": "mesh", "location": "face"})
found = axes_of("mesh.nc")
check(found.startswith("longitude of nodes 5 .. 6 degrees, latitude 50 .. 51 degrees, depth ") and found.endswith(" m"), "UGRID: " + found)
check([float(word) for word in found.split()[-4:-1:2]][0] > 5000, "UGRID's lowest layer is the deepest: " + found)

# Coastlines: at the bottom of the air, and at the top of the sea. Europe is there from either side of the meridian where longitudes jump.
wide = (("lat", numpy.linspace(30, 65, ny), {"units": "degrees_north"}), ("lon", numpy.linspace(-20, 40, nx), {"units": "degrees_east"}))
beyond = (wide[0], ("lon", numpy.linspace(340, 400, nx), {"units": "degrees_east"}))
air = write("air", (("zh", z, metres), *wide))
lines = drawn(air, "--coast", "--parallel", "--elevation", "90", "--azimuth", "-90")
check((lines > 60).sum() > 1000, "--coast draws the coast of Europe")
same(drawn(write("air beyond", (("zh", z, metres), *beyond)), "--coast", "--parallel", "--elevation", "90", "--azimuth", "-90"), lines,
    "longitudes of 340 to 400 degrees")
sea = write("sea", (("depth", depths, {"units": "m", "positive": "down"}), *wide))
same(drawn(sea, "--coast", "--parallel", "--elevation", "90", "--azimuth", "-90"), lines, "from above, air and sea have one coast")
side = [numpy.nonzero(drawn(path, "--coast", "--parallel", "--elevation", "0", "--exaggerate", "100"))[0].mean() for path in (air, sea)]
check(side[0] < 250 and side[1] > 262, "the coast is at the bottom of the air and at the top of the sea: rows %s" % side)
refused = run("render", "flat.nc", "-o", "out.png", "--coast")
check(refused.returncode == 2 and "'flat.nc' has no longitudes and latitudes" in refused.stdout, "--coast without degrees: " + refused.stdout)

# Planes of --crop and --slice are in the numbers of the axes: degrees and depths.
above = "--opacity", "0:.9,1:.9", "--unit-distance", "500", "--parallel", "--elevation", "90", "--azimuth", "-90"
whole = drawn(sea, *above)
check((whole > 20).sum() > 10000, "the sea shows from above")
for planes, part in (("-20,40,30,65,0,6000", slice(0, 512)), ("10,40,30,65,0,6000", slice(256, 512)), ("10,40,30,65,3000,5700", slice(256, 512))):
    seen = numpy.nonzero((drawn(sea, "--crop=" + planes, *above) > 20).any(axis=0))[0]
    shown = numpy.nonzero((whole > 20).any(axis=0))[0]
    least, most = max(shown.min(), part.start), min(shown.max(), part.stop - 1)
    check(seen.size and abs(seen.min() - least) <= 2 and abs(seen.max() - most) <= 2, f"--crop {planes}: columns {seen.min()} to {seen.max()}, not {least} to {most}")
for place, shows in (("10,0,0,1,0,0", True), ("200,0,0,1,0,0", False), ("0,0,2000,0,0,1", True), ("0,0,-2000,0,0,1", False)):
    cut = drawn(sea, "--mode", "slice", "--slice=" + place, "--opacity", "0:1", "--azimuth", "20")
    check((cut > 20).any() == shows, f"--slice {place} {'shows' if shows else 'is beyond'} the sea")

# Scans have no name for their values: the colour bar has the file's. A name in the file stays.
for name in "smoke", "water":
    with open(name + ".nrrd", "wb") as file:
        file.write(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n\n" + bytes(range(64)))
scans = []
for name in "smoke.nrrd", "water.nrrd", "smoke.vti":
    if name.endswith(".vti"):
        image = vtkImageData()
        image.SetDimensions(4, 4, 4)
        values = numpy_to_vtk(numpy.arange(64, dtype="u1"))
        values.SetName("smoke")
        image.GetPointData().SetScalars(values)
        writer = vtkXMLImageDataWriter()
        writer.SetFileName(name), writer.SetInputData(image), writer.Write()
    done = run("render", name, "-o", "out.png", "--size", "300", "--color-bar", "--opacity", "0:0")
    check(done.returncode == 0, name + ": " + done.stdout)
    scans.append(open("out.png", "rb").read())
check(scans[0] != scans[1] and scans[0] == scans[2], "the colour bar of a scan has the name of its file")

# Levels that are only numbers are drawn, with one line that says this.
numbers = write("numbers", (("lev", numpy.arange(nz) + 1.0, {}), ("lat", lat, {"units": "degrees_north"}),
    ("lon", lon, {"units": "degrees_east"})))
done = run("info", numbers)
check(done.returncode == 0 and done.stdout.count("heights are only numbers") == 1, "levels without a unit: " + done.stdout)
sys.exit(1 if failures else 0)
