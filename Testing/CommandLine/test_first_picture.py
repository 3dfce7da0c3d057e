# SPDX-License-Identifier: BSD-3-Clause
"""First pictures of netCDF files without an option: heights, view, colours and opacity by what the file says about its variable.
Usage: test_first_picture.py PATH-OF-STRATUS FOLDER"""
import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, os.pardir, "Examples", "Python"))

from checking import done, expect, fail

import first_pictures
import netCDF4
import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

SIZE = ("--size", "120x90", "--device", "host")
BLACK = ("--background", "black")


def blob(nz, ny, nx, wide=0.25, middle=(0.5, 0.5, 0.5)):
    """1 in the middle, 0 from a distance on."""
    axes = numpy.meshgrid(*(numpy.linspace(0, 1, n) - m for n, m in zip((nz, ny, nx), middle)), indexing="ij")
    return numpy.clip(1 - sum(axis**2 for axis in axes) / wide**2, 0, None)


def write(name, values, axes, variable="tracer", **attributes):
    """axes: name, places and attributes of each."""
    with netCDF4.Dataset(name, "w") as file:
        for axis, places, own in axes:
            file.createDimension(axis, len(places))
            coordinate = file.createVariable(axis, "f8", (axis,))
            coordinate[:] = places
            coordinate.setncatts(own)
        file.createVariable(variable, "f4", [axis for axis, *_ in axes], fill_value=numpy.float32(1e20))[:] = values
        file[variable].setncatts(attributes)
    return name


def ocean(name, values, depth=5000.0, **attributes):
    nz, ny, nx = values.shape
    return write(name, values, (("depth", numpy.linspace(0, depth, nz), dict(units="m", positive="down", axis="Z")),
                                ("lat", numpy.linspace(-60, 60, ny), dict(units="degrees_north", axis="Y")),
                                ("lon", numpy.linspace(0, 180, nx), dict(units="degrees_east", axis="X"))), **attributes)


def box(name, values, lengths, **attributes):
    return write(name, values, [(axis, numpy.linspace(0, length, n), dict(units="m", axis=axis.upper()))
                                for axis, n, length in zip("zyx", values.shape, lengths)], **attributes)


def pixels(path):
    reader = vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)[::-1]


def picture(*words):
    said = expect(0, "picture", "render", *words, "-o", "first.png", *SIZE)
    return said, pixels("first.png").astype(int)


def lit(*words):
    """Which pixels show anything, over a black background, without the rows of a caption."""
    said, image = picture(*words, *BLACK)
    return image[18 if "heights" in said else 0:, :, :3].max(axis=2) > 8


def test_heights():
    flat = ocean("flat.nc", blob(12, 20, 24), units="kg m-3")
    said, image = picture(flat)
    factor = re.search(r"heights +x (\S+), because the data are flat", said)
    if not factor or not 500 < float(factor[1]) < 1000:  # half of 40,000 km by cos(0), by 5 km: 800
        fail(f"heights of a flat ocean: {said}")
    same = picture(flat, "--exaggerate", factor[1])[1]
    if (image != same).any():
        fail("the picture is not that of --exaggerate with its caption")
    if (picture(flat, "--caption", "dye")[1] != picture(flat, "--exaggerate", factor[1], "--caption", "dye")[1]).any():
        fail("a caption does not say the factor")
    if "heights" in picture(flat, "--exaggerate", "1")[0]:
        fail("heights that were given are told as ours")
    if "heights" in picture(flat, "--quantity", "integral")[0] or "heights" in picture(flat, "--cloud", "--variable", "tracer")[0]:
        fail("numbers of rays, and photographs, are of true heights")
    for name in box("cube.nc", blob(12, 12, 12), (10, 10, 10)), box("low.nc", blob(12, 12, 12), (1.01, 10, 10)):
        if "heights" in picture(name)[0] or (picture(name)[1] != picture(name, "--exaggerate", "1")[1]).any():
            fail(f"{name} is not flat, and its heights are exaggerated")
    if "heights" not in picture(box("flatter.nc", blob(12, 12, 12), (0.99, 10, 10)))[0]:
        fail("0.99 of 10 is flat")
    with netCDF4.Dataset("numbers.nc", "w") as file:  # without coordinates
        for axis, n in zip("zyx", (3, 60, 60)):
            file.createDimension(axis, n)
        file.createVariable("q", "f4", tuple("zyx"))[:] = blob(3, 60, 60)
    if "heights" in picture("numbers.nc")[0]:
        fail("numbers of values are no heights")
    expect(0, "picture", "render", flat, "-o", "flat.exr", *SIZE) if "OpenEXR" in expect(0, "stratus", "--version") else None


def test_frame_is_filled():
    full = numpy.linspace(1, 2, 12 * 20 * 24).reshape(12, 20, 24)
    for name in ocean("full.nc", full, units="K"), box("square.nc", full, (100, 5000, 5000), units="K"), box("cubic.nc", full, (9, 9, 9), units="K"):
        shown = lit(name)
        rows, columns = numpy.nonzero(shown.any(axis=1))[0], numpy.nonzero(shown.any(axis=0))[0]
        wide, high = (columns[-1] - columns[0] + 1) / 120, (rows[-1] - rows[0] + 1) / 90
        if max(wide, high) < 0.9 or shown[:, 0].any() or shown[:, -1].any() or shown[-1].any():
            fail(f"{name}: the data are {wide:.2f} x {high:.2f} of the frame")
    if len({picture("full.nc", *words)[1].tobytes() for words in ((), ("--azimuth", "-70"), ("--elevation", "35"))}) != 2:
        fail("the view is not from -70, 35, or a turned view fills the frame")


def test_opacity_by_depth():
    """A layer whose columns are alike absorbs the same share of light from above for any height: 1 - exp(-1.5)."""
    layer = numpy.broadcast_to(numpy.linspace(3, 20, 12)[:, None, None], (12, 20, 24))
    for depth in 50.0, 5000.0:
        name = ocean("layer.nc", layer, depth=depth, units="degC")
        for words in (), ("--exaggerate", "1"), ("--exaggerate", "50"):
            image = picture(name, "--background", "transparent", "--elevation", "90", "--parallel", *words)[1]
            alpha = image[45, 60, 3] / 255
            if abs(alpha - (1 - numpy.exp(-1.5))) > 0.02:  # pieces of the function, and a byte
                fail(f"{depth} m {words}: alpha {alpha:.3f}")
    for name in curvilinear("curvilinear.nc", layer), layered_mesh("mesh.nc", layer[:, 0, 0]):
        said, image = picture(name, "--variable", "temp", "--background", "transparent", "--elevation", "90", "--parallel")
        alpha = image[45, 60, 3] / 255
        if abs(alpha - (1 - numpy.exp(-1.5))) > 0.02:
            fail(f"{name}: alpha {alpha:.3f}\n{said}")


def curvilinear(name, values):
    """A turned lattice, whose depth is the same everywhere."""
    with netCDF4.Dataset(name, "w") as file:
        for axis, n in zip(("depth", "j", "i"), values.shape):
            file.createDimension(axis, n)
        depth = file.createVariable("depth", "f8", ("depth",))
        depth[:] = numpy.linspace(0, 3000, values.shape[0])
        depth.setncatts(dict(units="m", positive="down", axis="Z", standard_name="depth"))
        j, i = numpy.meshgrid(numpy.arange(values.shape[1]), numpy.arange(values.shape[2]), indexing="ij")
        for coordinate, places, direction in ("lon", i - 0.3 * j, "east"), ("lat", j + 0.3 * i, "north"):
            file.createVariable(coordinate, "f8", ("j", "i"))[:] = places
            file[coordinate].units = f"degrees_{direction}"
        file.createVariable("temp", "f4", ("depth", "j", "i"))[:] = values
        file["temp"].setncatts(dict(units="degC", coordinates="lat lon"))
    return name


def layered_mesh(name, layers):
    """Squares of a mesh (UGRID) in layers, with values at nodes that depend on the layer only."""
    n = 9
    x, y = (each.ravel() for each in numpy.meshgrid(numpy.linspace(0, 9000, n), numpy.linspace(0, 9000, n)))
    corners = [[j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i] for j in range(n - 1) for i in range(n - 1)]
    with netCDF4.Dataset(name, "w") as file:
        for dimension, size in ("node", n * n), ("face", len(corners)), ("corner", 4), ("layer", len(layers)):
            file.createDimension(dimension, size)
        file.createVariable("mesh", "i4").setncatts(dict(cf_role="mesh_topology", topology_dimension=2, node_coordinates="nx ny",
                                                         face_node_connectivity="corners"))
        for axis, places in ("x", x), ("y", y):
            file.createVariable("n" + axis, "f8", ("node",))[:] = places
            file["n" + axis].setncatts(dict(units="m", standard_name=f"projection_{axis}_coordinate"))
        file.createVariable("corners", "i4", ("face", "corner"))[:] = corners
        file["corners"].setncatts(dict(start_index=0, cf_role="face_node_connectivity"))
        file.createVariable("layer", "f8", ("layer",))[:] = numpy.linspace(0, 30, len(layers))
        file["layer"].setncatts(dict(units="m", positive="down"))
        file.createVariable("temp", "f4", ("layer", "node"))[:] = numpy.repeat(layers, n * n).reshape(len(layers), -1)
        file["temp"].setncatts(dict(mesh="mesh", location="node", units="degC"))
    return name


def test_colors_by_meaning():
    """The colour map of a variable is the one that its standard name, unit or name stands for, and --color replaces it."""
    values = blob(12, 20, 24, 0.4)
    for map_name, scale, shift, attributes in (
            ("thermal", 20, 0, dict(standard_name="sea_water_temperature", units="degC")), ("haline", 1, 34, dict(standard_name="sea_water_salinity", units="1")),
            ("cool-warm", 2, -1, dict(standard_name="eastward_wind", units="m s-1")), ("cool-warm", 2, -1, dict(units="m s-1")),
            ("algae_r", 1, 0, dict(standard_name="mass_concentration_of_chlorophyll_in_sea_water", units="mg m-3")),
            ("cloud", 1, 0, dict(variable="QCLOUD", units="kg kg-1")), ("viridis", 1, 0, dict(units="kg m-3")), ("storm", 1, 0, dict(variable="h", units="m"))):
        name = ocean("meaning.nc", scale * values + shift, **attributes)
        if (picture(name)[1] != picture(name, "--color", map_name)[1]).any():
            fail(f"{attributes} is not drawn in {map_name}")
    name = ocean("bright.nc", values, units="kg m-3")
    if (picture(name, "--background", "white")[1] != picture(name, "--background", "white", "--color", "viridis_r")[1]).any():
        fail("the map over a bright background is not reversed")


def test_plumes_and_outliers():
    """A tracer of 3 % of the volume shows where it is, also among outliers of 1e-3 of the values that are 1e5 times as large."""
    values = blob(24, 40, 48, 0.2, (0.5, 0.4, 0.3))
    share = (values > 0).mean()
    if not 0.02 < share < 0.04:
        fail(f"the plume fills {share:.3f} of the volume")
    words = ("--background", "black", "--azimuth", "-90", "--elevation", "89.9", "--parallel", "--axes")
    name = ocean("plume.nc", values, units="kg m-3")
    full, none = (picture(name, "--opacity", f"0:{alpha}", "--color", "gray", *words)[1] for alpha in (1, 0))
    rows, columns = numpy.nonzero((full != none).any(axis=2))

    def part(places, low, high):
        """Of the box, from its upper left corner."""
        size = places.max() - places.min()
        return slice(round(places.min() + low * size), round(places.min() + high * size))
    inside = part(rows, 0.5, 0.7), part(columns, 0.2, 0.4)  # of the plume, and next to it
    beside = part(rows, 0.5, 0.7), part(columns, 0.6, 0.8)

    def levels(name):
        image = picture(name, *words)[1][..., :3].max(axis=2)
        return int(image[inside].max()), int(image[beside].max())
    plume = levels(name)
    if plume[0] < 100 or plume[1] > 8:
        fail(f"the plume is not seen: {plume[0]} where it is, {plume[1]} where it is not")
    some = numpy.random.default_rng(3).random(values.shape) < 0.8e-3
    some[:, :, :24] = False  # so that they are next to it
    spiked = levels(ocean("spikes.nc", numpy.where(some, 1e5, values), units="kg m-3"))
    if abs(spiked[0] - plume[0]) > 16:  # the range ends at another bin's edge, which changes colours by some steps
        fail(f"outliers change the plume: {spiked[0]}, not {plume[0]}")


def test_sheet():
    """Each file of the gallery's sheet shows its subject: neither next to nothing, nor a body of one colour."""
    for path in first_pictures.write_all("."):
        image = picture(path, "--background", "transparent")[1]
        alpha = image[18:, :, 3]  # without the caption
        seen = (alpha > 50).mean()
        if not 0.01 < seen < 0.9 or alpha.max() < 120:
            fail(f"{path}: alpha is above 50 of 255 in {seen:.3f} of the picture, {alpha.max()} at most")
        colors = image[18:][alpha > 50][:, :3]
        if numpy.ptp(colors, axis=0).max() < 30:
            fail(f"{path} is of one colour, {colors.min(axis=0)} to {colors.max(axis=0)}")


test_heights()
test_frame_is_filled()
test_opacity_by_depth()
test_colors_by_meaning()
test_plumes_and_outliers()
test_sheet()
done()
