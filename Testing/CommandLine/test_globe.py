# SPDX-License-Identifier: BSD-3-Clause
"""`stratus render --globe`: the Earth's disk is as large as the camera says, it hides what is behind it, data are where their longitude and
latitude are, and other data are refused. Usage: test_globe.py PATH-OF-STRATUS FOLDER"""
import math
import os
import re
import sys

from checking import done, expect, fail

import netCDF4
import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

SIZE = 160
RADIUS = 6371000.0


def write(name, east, north, levels, values):
    with netCDF4.Dataset(name, "w") as file:
        for axis, places, units in (("z", levels, "m"), ("lat", north, "degrees_north"), ("lon", east, "degrees_east")):
            file.createDimension(axis, len(places))
            file.createVariable(axis, "f8", (axis,))[:] = places
            file[axis].units = units
        file["z"].positive = "up"
        file.createVariable("q", "f4", ("z", "lat", "lon"))[:] = values


def spot(east, north, longitude, latitude):
    """1 within 5 degrees of a place."""
    a, b = numpy.meshgrid(numpy.radians(east), numpy.radians(north))
    c, d = math.radians(longitude), math.radians(latitude)
    cosine = numpy.sin(b) * math.sin(d) + numpy.cos(b) * math.cos(d) * numpy.cos(a - c)
    return numpy.tile((cosine > math.cos(math.radians(5))).astype("f4"), (3, 1, 1))


def picture(*words):
    said = expect(0, "picture", "render", *words, "--device", "host", "--size", f"{SIZE}x{SIZE}", "--background", "black", "-o", "globe.png")
    reader = vtkPNGReader()
    reader.SetFileName("globe.png")
    reader.Update()
    image = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).reshape(SIZE, SIZE, -1)[..., :3].astype(int)
    return said, image


LOOK = ("--opacity", "0:0,0.5:0,0.6:1", "--color", "0:1:0:0,1:1:0:0", "--caption", "")  # red where the spot is
levels = numpy.array([0.0, 5000.0, 10000.0])
east, north = 1.0 + 2.0 * numpy.arange(180), -89.0 + 2.0 * numpy.arange(90)
write("world.nc", east, north, levels, spot(east, north, 40, 20))

said, bare = picture("world.nc", "--globe", "--opacity", "0:0,1:0", "--exaggerate", "1")
eye = [float(x) for x in re.search(r"eye (\S+) (\S+) (\S+),", said).groups()]
angle = math.radians(float(re.search(r"angle (\S+)", said).group(1)))
distance = math.hypot(*eye)
across = math.tan(math.asin(0.9997 * RADIUS / distance)) / math.tan(angle / 2) * SIZE / 2
disk = (bare.max(axis=2) > 8).sum()
print(f"the disk has {disk} pixels, {math.pi * across**2:.0f} by the camera")
if abs(disk / (math.pi * across**2) - 1) > 0.02 or across < 0.3 * SIZE:
    fail(f"the Earth has {disk} pixels, a circle of {across:.1f} has {math.pi * across**2:.0f}")

for azimuth, elevation, seen in ((40, 20, True), (220, -20, False), (130, 0, False)):
    said, image = picture("world.nc", "--globe", *LOOK, "--azimuth", str(azimuth), "--elevation", str(elevation))
    red = (image[..., 0] > 80) & (image[..., 0] > 3 * image[..., 1])
    if not re.search(r"heights +x 63.71 on the globe", said):
        fail(f"heights of a tenth of the radius:\n{said}")
    if seen:
        rows, columns = numpy.nonzero(red)
        middle = (columns.mean() - (SIZE - 1) / 2, rows.mean() - (SIZE - 1) / 2) if len(rows) else (SIZE, SIZE)
        if not len(rows) or math.hypot(*middle) > 3:
            fail(f"the spot is {middle} from the middle, where the camera looks")
    elif azimuth == 220 and red.any():
        fail(f"the Earth hides no spot behind it: {red.sum()} pixels")

# Python draws the picture of the command line
try:
    import stratus_volume
except ImportError:
    stratus_volume = None
if stratus_volume:
    class Coordinate:
        def __init__(self, name, places, units):
            self.values, self.dims, self.attrs = places, (name,), {"units": units}

    class Labelled:
        values, dims, attrs, name = spot(east, north, 40, 20), ("z", "lat", "lon"), {}, "q"
        coords = {"z": Coordinate("z", levels, "m"), "lat": Coordinate("lat", north, "degrees_north"), "lon": Coordinate("lon", east, "degrees_east")}

    said, image = picture("world.nc", "--globe", "--coast", *LOOK, "--unit-distance", "300000", "--azimuth", "70", "--elevation", "10")
    eye = [float(x) for x in re.search(r"eye (\S+) (\S+) (\S+),", said).groups()]
    camera = dict(position=eye, focal_point=(0, 0, 0), view_angle=float(re.search(r"angle (\S+)", said).group(1)))
    other = stratus_volume.show(Labelled(), [(0, 0), (0.5, 0), (0.6, 1)], [(0, 1, 0, 0), (1, 1, 0, 0)], (SIZE, SIZE), camera, (0, 0, 0), globe=True,
                                coast=True, unit_distance=300000, device="host", ink=0.85, caption="")
    apart = abs(other[::-1, :, :3].astype(int)[:SIZE - 30] - image[:SIZE - 30]).max(axis=2)  # without the factor at the top
    print(f"Python's picture differs from the command line's in {(apart > 2).sum()} pixels")
    if (apart > 2).any() or (image.max(axis=2) > 8).sum() < 3000:
        fail("Python draws another globe")

# a region is looked at from above
east, north = numpy.linspace(100, 130, 31), numpy.linspace(-40, -20, 21)
write("region.nc", east, north, levels, spot(east, north, 115, -30))
said, image = picture("region.nc", "--globe", *LOOK)
red = (image[..., 0] > 80) & (image[..., 0] > 3 * image[..., 1])
rows, columns = numpy.nonzero(red)
if red.sum() < 50 or abs(columns.mean() - SIZE / 2) > 0.15 * SIZE or abs(rows.mean() - SIZE / 2) > 0.15 * SIZE:
    fail(f"the middle of a region is seen: {red.sum()} pixels")

with netCDF4.Dataset("flat.nc", "w") as file:
    for axis in "zyx":
        file.createDimension(axis, 4)
        file.createVariable(axis, "f8", (axis,))[:] = numpy.arange(4.0)
        file[axis].units = "m"
    file.createVariable("q", "f4", ("z", "y", "x"))[:] = 1
expect(1, "has no longitudes and latitudes of the Earth", "render", "flat.nc", "--globe", "-o", "no.png")
expect(2, "--globe: only netCDF and Zarr have longitudes and latitudes", "render", "cloud", "--globe", "-o", "no.png")
expect(2, "leave out the others", "render", "world.nc", "region.nc", "--globe", "-o", "no.png")

# coastlines are where the coast is: Cape Agulhas in the south of Africa, in the middle of the picture, and none in the Pacific
said, plain = picture("world.nc", "--globe", "--opacity", "0:0,1:0", "--exaggerate", "1", "--azimuth", "20", "--elevation", "-34.8", "--zoom", "4")
said, image = picture("world.nc", "--globe", "--opacity", "0:0,1:0", "--exaggerate", "1", "--azimuth", "20", "--elevation", "-34.8", "--zoom",
                      "4", "--coast")
rows, columns = numpy.nonzero((image != plain).any(axis=2))
apart = numpy.hypot(rows - (SIZE - 1) / 2, columns - (SIZE - 1) / 2) if len(rows) else numpy.array([SIZE])
south = SIZE - rows.max() if len(rows) else 0
if apart.min() > 4 or not 0.3 < (rows > SIZE / 2 - 4).mean():
    fail(f"the cape is {apart.min():.0f} pixels from the middle; {(rows > SIZE / 2).mean():.2f} of the coast is north of it")
said, plain = picture("world.nc", "--globe", "--opacity", "0:0,1:0", "--exaggerate", "1", "--azimuth", "-130", "--elevation", "-30", "--zoom", "5")
said, image = picture("world.nc", "--globe", "--opacity", "0:0,1:0", "--exaggerate", "1", "--azimuth", "-130", "--elevation", "-30", "--zoom",
                      "5", "--coast")
if (image != plain).any():
    fail(f"the South Pacific has no coast: {(image != plain).any(axis=2).sum()} pixels")


def write_plane(name, mapping, x, y, units, standard):
    write(name, x, y, levels, numpy.ones((3, len(y), len(x)), "f4"))
    with netCDF4.Dataset(name, "a") as file:
        for axis, kind in (("lon", standard % "x"), ("lat", standard % "y")):
            file[axis].units, file[axis].standard_name, file[axis].axis = units, kind, "X" if axis == "lon" else "Y"
        file.createVariable("crs", "i4").setncatts(mapping)
        file["q"].grid_mapping = "crs"
    return name


# Coastlines of a plane: a map of Iceland in azimuthal projection reaches from 24.5 W to 13.5 W and from 63.4 N to 66.5 N.
x = numpy.linspace(-400e3, 400e3, 9)
laea = {"grid_mapping_name": "lambert_azimuthal_equal_area", "longitude_of_projection_origin": -19.0, "latitude_of_projection_origin": 64.0,
        "earth_radius": RADIUS}
plane = write_plane("iceland.nc", laea, x, x, "m", "projection_%s_coordinate")
above = ("--parallel", "--elevation", "90", "--azimuth", "-90", "--exaggerate", "1")
bare = picture(plane, *above, "--opacity", "0:0,2:0")[1]
has_proj = os.environ.get("STRATUS_PROJ", "1") == "1"
if has_proj:
    said, box = picture(plane, *above, "--coast", "--opacity", "0:1,2:1", "--color", "0:1:0:0,2:1:0:0")
    said, coast = picture(plane, *above, "--coast", "--opacity", "0:0,2:0")
    rows, columns = numpy.nonzero((coast != bare).any(axis=2))
    filled = numpy.nonzero((box != bare).any(axis=2))
    metres = 800e3 / (filled[1].max() - filled[1].min() + 1)
    middle = [0.5 * (each.max() + each.min()) for each in filled]
    ends = [(columns.min() - middle[1]) * metres, (columns.max() - middle[1]) * metres, (rows.min() - middle[0]) * metres,
            (rows.max() - middle[0]) * metres]
    wanted = [RADIUS * math.radians(angle) for angle in (-5.5 * math.cos(math.radians(65.5)), 5.4 * math.cos(math.radians(65)), -0.6, 2.5)]
    print(f"Iceland reaches over {[round(end / 1000) for end in ends]} km, by the map over {[round(end / 1000) for end in wanted]}")
    if max(abs(end - want) for end, want in zip(ends, wanted)) > 30e3:
        fail("Iceland is elsewhere")
    said, image = picture(plane, "--globe", "--opacity", "0:0,2:1")
    if "'crs' (lambert_azimuthal_equal_area)" not in said or (image[..., 0] != image[..., 2]).sum() < 50:
        fail(f"a projected grid on the globe:\n{said}")

    # A grid about the Earth's own pole: its picture equals the one of longitudes and latitudes.
    east, north = numpy.linspace(-20, 40, 13), numpy.linspace(30, 65, 8)
    write("europe.nc", east, north, levels, numpy.ones((3, 8, 13), "f4"))
    own = {"grid_mapping_name": "rotated_latitude_longitude", "grid_north_pole_longitude": 180.0, "grid_north_pole_latitude": 90.0}
    turned = write_plane("turned.nc", own, east, north, "degrees", "grid_%s")
    with netCDF4.Dataset("turned.nc", "a") as file:
        file["lon"].standard_name, file["lat"].standard_name = "grid_longitude", "grid_latitude"
    one, other = (picture(name, *above, "--coast", "--opacity", "0:0,2:0")[1].max(axis=2) > 30 for name in ("europe.nc", "turned.nc"))
    if one.sum() < 200 or (one != other).sum() > 0.02 * one.sum():
        fail(f"two maps of Europe differ in {(one != other).sum()} of {one.sum()} pixels")
else:
    expect(2, "need PROJ, which this build lacks", "render", plane, "--coast", "-o", "no.png")
wrong = write_plane("wrong.nc", dict(laea, grid_mapping_name="peirce"), x, x, "m", "projection_%s_coordinate")
expect(2, "is none of the known ones: albers_conical_equal_area", "render", wrong, "--coast", "-o", "no.png")
expect(1, "is none of the known ones: albers_conical_equal_area", "render", wrong, "--globe", "-o", "no.png")

# Data all around the Earth: the whole disk is in the picture, in its middle, and meshes of MPAS and ICON are seen on it. A column of them has an
# optical depth of about 1.5, which is more than half opaque.
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Examples", "Python"))
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "Python"))
import datasets
import model_files

for path, name, least in ((model_files.mpas_atmosphere("."), "qc", 0.1), (model_files.icon_atmosphere("."), "temp", 0.4)):
    full, none = (picture(path, "--globe", *words)[1].astype(float) for words in ((), ("--opacity", "0:0,1000:0")))
    disk = none[20:].max(axis=2) > 0  # without the caption
    rows, columns = numpy.nonzero(disk)
    if not (0 < columns.min() and columns.max() < SIZE - 1 and rows.max() + 20 < SIZE - 1 and abs(columns.min() + columns.max() - SIZE + 1) < 4):
        fail(f"{path}: the disk is cut off or aside: {columns.min()} .. {columns.max()}, up to {rows.max() + 20} of {SIZE}")
    seen = (abs(full - none).max(axis=2)[20:][disk] > 40).mean()
    print(f"{path}: data are seen on {seen:.2f} of the disk")
    if seen < least:
        fail(f"{path}: data are seen on {seen:.2f} of the disk")
    whole = full[20:].max(axis=2) > 0
    if whole[-1].any() or whole[:, 0].any() or whole[:, -1].any():
        fail(f"{path}: data are cut off")
    if stratus_volume:  # Python draws the same first picture
        said, image = picture(path, "--globe", "--coast")
        eye = [float(x) for x in re.search(r"eye (\S+) (\S+) (\S+),", said).groups()]
        camera = dict(position=eye, focal_point=(0, 0, 0), view_angle=float(re.search(r"angle (\S+)", said).group(1)))
        other = stratus_volume.show(datasets.of_file(path), None, None, (SIZE, SIZE), camera, (0, 0, 0), scalars=name, globe=True, coast=True, device="host",
                                    ink=0.85, caption="")
        apart = abs(other[::-1, :, :3].astype(int)[:SIZE - 30] - image[:SIZE - 30]).max(axis=2)
        print(f"{path}: Python's picture differs from the command line's in {(apart > 2).sum()} pixels")
        if (apart > 2).any():
            fail(f"{path}: Python draws another first picture")
done()
