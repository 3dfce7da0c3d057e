#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""xarray.DataArrays on the Earth: places in metres, heights that are exaggerated, depths that point down, colours and opacity by what a
variable is."""
from checking import ball, check, done, refuse

import warnings

import numpy
from stratus_volume import PlacesUnused, Volume, render, show

RADIUS = 6371000.0
host = dict(device="host", size=(60, 45))
field = ball((12, 20, 24), (6, 10, 12), 6)


class Coordinate:
    def __init__(self, values, **attrs):
        self.values, self.attrs = numpy.asarray(values, float), attrs


class Labelled:
    """What is read of an xarray.DataArray."""

    def __init__(self, values, coords, name=None, **attrs):
        self.values, self.dims, self.coords, self.attrs, self.encoding, self.name = values, tuple(coords), coords, attrs, {}, name


def ocean(values=field, depth=5000.0, vertical=None, **about):
    return Labelled(values, dict(depth=vertical or Coordinate(numpy.linspace(0, depth, values.shape[0]), units="m", positive="down"),
                                 lat=Coordinate(numpy.linspace(-60, 60, values.shape[1]), units="degrees_north"),
                                 lon=Coordinate(numpy.linspace(170, 190, values.shape[2]) % 360, units="degrees_east")), **about)


def places():
    drawn = Volume(ocean(), exaggerate=1, device="host")
    wide = numpy.radians(20) * RADIUS  # at latitude 0, the middle one
    x0, x1, y0, y1, z0, z1 = drawn.bounds
    check(abs(x1 - x0 - wide) < 1e-6 * wide and abs(y1 - y0 - 6 * wide) < 1e-5 * wide, f"degrees as metres: {drawn.bounds}")
    check((z0, z1) == (-5000, 0), f"depths are below 0: {z0}, {z1}")
    for metres, coordinate in ((0, 50), Coordinate([0, 5, 50], units="m")), ((-50, 0), Coordinate([0, 5, 50], units="m", standard_name="depth")), \
            ((0, 50), Coordinate([0, 5, 50], units="m", positive="up", standard_name="depth")), ((0, 50000), Coordinate([0, 5, 50], units="km")):
        vertical = Volume(Labelled(field[:3], dict(z=coordinate, lat=ocean().coords["lat"], lon=ocean().coords["lon"])), exaggerate=1, device="host")
        check(vertical.bounds[4:] == metres, f"{coordinate.attrs}: {vertical.bounds[4:]}")
    # Geometric heights of the standard atmosphere, of which 11,019 m are 11,000 geopotential ones.
    for units, factor in ("Pa", 1), ("hPa", 100):
        levels = Volume(ocean(field[:3], vertical=Coordinate(numpy.array([101325, 22632, 79.779]) / factor, units=units)), exaggerate=1, device="host")
        heights = [levels.grid.coordinates[2][level] for level in range(3)]
        check(numpy.allclose(heights, [0, 11019, 50000], atol=0.5), f"pressures as heights: {heights}")
    same = dict(zip("zyx", (Coordinate(numpy.arange(n) * 2.0, units="km") for n in field.shape)))
    check(Volume(Labelled(field, same), device="host").bounds == (0, 46, 0, 38, 0, 22), "lengths of one unit keep it")
    small = dict(zip("zyx", (Coordinate(numpy.arange(n) * scale, units="um") for n, scale in zip(field.shape, (0.01, 1, 1)))))
    check(Volume(Labelled(field, small), device="host").exaggeration == 1, "micrometres are not on the Earth")


def unused():
    def said(data, **options):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            Volume(data, device="host", **options)
        check(all(each.category is PlacesUnused and each.filename == __file__ for each in caught), "at the caller's line")
        return [str(each.message) for each in caught]

    def wide(units):
        result = Coordinate(numpy.zeros(field.shape[1:]), units=units)
        result.dims = ("eta", "xi")
        return result
    roms = Labelled(field, dict.fromkeys(("s_rho", "eta", "xi")))
    roms.coords = dict(lon_rho=wide("degree_east"), lat_rho=wide("degree_north"), mask=wide("1"))
    warned = said(roms)
    check(len(warned) == 1 and "places are indices, because coordinates have more than one dimension: lon_rho, lat_rho." in warned[0], f"two dimensions: {warned}")
    check(said(roms, spacing=(1, 1, 1)) == [], "places that are given are used")
    sigma = ocean(vertical=Coordinate(numpy.linspace(-1, 0, 12), units="1", standard_name="ocean_sigma_coordinate"))
    warned = said(sigma)
    check(len(warned) == 1 and "because 'depth' is in '1', neither a length nor a pressure." in warned[0], f"sigma levels: {warned}")
    refuse(ValueError, "coast is True, but places are no longitudes and latitudes", render, Volume(sigma, device="host"), coast=True)
    bare = ocean()
    del bare.coords["depth"]
    warned = said(bare)
    check(len(warned) == 1 and "because 'depth' has no coordinate." in warned[0], f"levels without a coordinate: {warned}")
    check(said(ocean()) == [] and said(field) == [] and said(Labelled(field, dict.fromkeys("zyx"))) == [], "others are used, or there are none")


def heights():
    flat = Volume(ocean(), device="host")
    wide = flat.bounds[3] - flat.bounds[2]
    check(flat.exaggeration == float(f"{0.2 * wide / 5000:.2g}"), f"a flat ocean: {flat.exaggeration}, {wide}")
    check(abs((flat.bounds[5] - flat.bounds[4]) / wide - 0.2) < 0.2 * 0.05, "is a fifth as high as wide")  # two digits
    given = render(ocean(), exaggerate=flat.exaggeration, **host).rgba
    check(numpy.array_equal(render(ocean(), **host).rgba, given), "as the factor that is given")
    check(not numpy.array_equal(render(ocean(), exaggerate=1, **host).rgba, given), "true heights are another picture")
    check(show(ocean(), **host).caption == f"heights x {flat.exaggeration:.15g}" and show(ocean(), exaggerate=1, **host).caption == "", "captions")
    check(Volume(ocean(), matrix=numpy.eye(4), device="host").exaggeration == 1, "a matrix is the caller's own")
    check(Volume(field, device="host").exaggeration == 1, "an array has no heights")
    check(Volume(field, exaggerate=3, device="host").bounds == (0, 23, 0, 19, 0, 33), "but they can be stretched")
    refuse(ValueError, "exaggerate is 0", Volume, field, exaggerate=0)
    refuse(TypeError, "exaggerate is 'x'", Volume, field, exaggerate="x")
    q = Volume(ocean(numpy.full(field.shape, 2.0), units="kg m-3"), device="host")
    down = dict(position=(q.bounds[0] + 1e6, 0, 1e8), focal_point=(q.bounds[0] + 1e6, 0, 0), view_up=(0, 1, 0), parallel_scale=1000)
    q._label = lambda name, array, unit: (array, unit)  # without xarray
    integral, unit = q.render(0.1, size=(5, 5), camera=down, quantities="integral").quantities["integral"]
    check(numpy.allclose(integral, 2 * 5000, rtol=1e-4) and unit == "kg m-2", f"integrals are over true heights: {integral[2, 2]} {unit}")


def framed():
    full = numpy.linspace(1, 2, field.size).reshape(field.shape)
    for vertical in None, Coordinate(numpy.linspace(0, 4e6, 12), units="m"):
        shown = render(ocean(full, vertical=vertical, units="K"), size=(80, 60), device="host").rgba[..., 3] > 0.01
        rows, columns = numpy.nonzero(shown.any(axis=1))[0], numpy.nonzero(shown.any(axis=0))[0]
        wide, high = (columns[-1] - columns[0] + 1) / 80, (rows[-1] - rows[0] + 1) / 60
        check(max(wide, high) > 0.9 and not (shown[:, 0].any() or shown[:, -1].any() or shown[0].any() or shown[-1].any()), f"{wide:.2f} x {high:.2f} of the frame")


def colors_and_opacity():
    signed = field * numpy.where(numpy.arange(24) < 12, 1, -1)
    for name, values, about in (("thermal", 20 * field, dict(units="degC")), ("haline", 34 + field, dict(standard_name="sea_water_salinity")),
                                ("cool-warm", signed, dict(units="m s-1")), ("cool-warm", signed, {}), ("cloud", field, dict(name="qc", units="kg kg-1")),
                                ("viridis", field, dict(units="kg m-3"))):
        own, by_name = (show(ocean(values, **about), **host, **options) for options in ({}, dict(color=name)))
        # The range of colours is the guess's, that of a named map the values': for signed and amounts they differ a little.
        check(numpy.abs(numpy.subtract(own, by_name, dtype=int)).max() < 40, f"{about} is drawn in {name}: {numpy.abs(numpy.subtract(own, by_name, dtype=int)).max()}")
    layer = numpy.broadcast_to(numpy.linspace(3, 20, 12)[:, None, None], field.shape)
    for depth in 50.0, 5000.0:
        for factor in None, 1.0, 50.0:
            drawn = Volume(ocean(layer, depth=depth, units="degC"), exaggerate=factor, device="host")
            middle = [0.5 * (drawn.bounds[2 * axis] + drawn.bounds[2 * axis + 1]) for axis in range(3)]
            down = dict(position=(middle[0], middle[1], drawn.bounds[5] + 1e6), focal_point=middle, view_up=(0, 1, 0), parallel_scale=1000)
            alpha = drawn.render(size=(3, 3), camera=down).rgba[1, 1, 3]
            check(abs(alpha - (1 - numpy.exp(-1.5))) < 0.02, f"a column of {depth} m times {factor}: alpha {alpha:.3f}")  # pieces of the function
    some = numpy.random.default_rng(3).random(field.shape) < 0.8e-3
    plume, spiked = (render(ocean(values, units="kg m-3"), **host).rgba for values in (field, numpy.where(some & (field == 0), 1e5, field)))
    dense = plume[..., 3] > 0.3
    share = spiked[dense, 3].mean() / plume[dense, 3].mean()
    check(dense.sum() > 50 and 0.8 < share < 1.25, f"outliers hide the rest: {dense.sum()} pixels, {share:.2f} of their alpha")


places()
unused()
heights()
framed()
colors_and_opacity()
done()
