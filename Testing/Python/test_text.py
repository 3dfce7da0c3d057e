#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Text and lines around pictures: axes have the coordinates' own numbers, coastlines are where they belong, and text leaves the edges free."""
from checking import ball, check, done, refuse

import warnings

import numpy
from stratus_volume import NothingShown, Volume, render, render_tetrahedra, show

host = dict(device="host", size=(320, 240))
field = ball((6, 20, 24), (3, 10, 12), 3)


class Coordinate:
    def __init__(self, values, **attrs):
        self.values, self.attrs = numpy.asarray(values, float), attrs


class Labelled:
    """What is read of an xarray.DataArray."""

    def __init__(self, values, coords, name=None, **attrs):
        self.values, self.dims, self.coords, self.attrs, self.encoding, self.name = values, tuple(coords), coords, attrs, {}, name


north, east = Coordinate(numpy.linspace(-60, 60, 20), units="degrees_north"), Coordinate(numpy.linspace(170, 290, 24) % 360, units="degrees_east")
depths = Coordinate([0.5, 10, 100, 1000, 3000, 5700], units="m", positive="down", long_name="depth of cells")
levels = Coordinate([100000, 85000, 70000, 50000, 25000, 10000], units="Pa", standard_name="air_pressure")


def earth(vertical, **about):
    return Labelled(field, dict(z=vertical, lat=north, lon=east), **about)


def numbers():
    for exaggerate in None, 1, 7.5:
        for vertical, title, units in (depths, "depth of cells", "m"), (levels, "air pressure", "hPa"), \
                (Coordinate([0, 1, 2, 3, 5, 9], units="km", long_name="a height above the geoid, of the middles of cells"), "z", "m"):
            drawn = Volume(earth(vertical), exaggerate=exaggerate, device="host")
            axes, places = drawn._axes, drawn.grid.coordinates
            check([axis.kind for axis in axes] == ["longitude", "latitude", "levels" if units == "hPa" else "number"], f"{axes}")
            check(numpy.allclose(places[0] * axes[0].scale, numpy.linspace(170, 290, 24)), "longitudes are the file's, of one turn")
            check(numpy.allclose(places[1] * axes[1].scale, north.values), "latitudes")
            own = vertical.values * (0.01 if units == "hPa" else 1000 if vertical.attrs["units"] == "km" else 1)
            at = drawn.exaggeration * places[2]
            found = numpy.interp(at, *zip(*sorted(axes[2].levels))) if units == "hPa" else at * axes[2].scale
            check(numpy.allclose(found, own), f"heights times {exaggerate} have true numbers: {found}, not {own}")
            check((axes[2].title, axes[2].units) == (title, units), f"{axes[2]}")
    turned = Volume(earth(depths), matrix=numpy.eye(4), device="host")
    check(turned._axes is None, "a matrix makes other places")
    plain = Volume(Labelled(field, dict(z=Coordinate(numpy.arange(6), units="s"), y=Coordinate(numpy.arange(20) * 2.0, units="K"),
                                        x=Coordinate(numpy.arange(24) + 5.0, units="mol"))), device="host")
    for axis, (place, values, unit) in enumerate(((plain.grid.coordinates[0], numpy.arange(24) + 5, "mol"),
                                                  (plain.grid.coordinates[1], 2 * numpy.arange(20), "K"))):
        label = plain._axes[axis]
        own = numpy.interp(place, *zip(*label.levels)) if label.levels else place * label.scale
        check(label.units == unit and numpy.allclose(own, values), f"coordinates of any unit: {label}")


def ink(data, **options):
    """Where a picture has more than the same without text."""
    return numpy.abs(render(data, **options, **host).rgba - render(data, **{**options, "show_axes": False, "coast": False}, **host).rgba).max(axis=2) > 0.2


def coast():
    for vertical in depths, levels:
        data = earth(vertical)
        drawn = Volume(data, exaggerate=1, device="host")
        axes, bounds = drawn._axes, drawn.bounds
        middle = [0.5 * (bounds[0] + bounds[1]), 0.5 * (bounds[2] + bounds[3]), 0]
        half = 0.55 * (bounds[3] - bounds[2])
        camera = dict(position=(*middle[:2], 1e8), focal_point=middle, view_up=(0, 1, 0), parallel_scale=half)
        lines = drawn.render(camera=camera, coast=True, opacity=[(0, 0), (1, 1e-6)], size=(640, 480)).rgba[..., 3] > 0.2
        check(1000 < lines.sum() < 20000, f"{lines.sum()} pixels of coast")

        def near(longitude, latitude, reach):
            column = 320 + 240 * (longitude / axes[0].scale - middle[0]) / half
            row = 240 - 240 * (latitude / axes[1].scale - middle[1]) / half
            return lines[int(row) - reach:int(row) + reach + 1, int(column) - reach:int(column) + reach + 1].any()
        # North Cape of New Zealand, Cabo Corrientes, Punta Parinas, Punta Lavapie: a pixel is half a degree wide, and 1:110m as exact
        for place in (173.0, -34.4), (254.3, 20.4), (278.7, -4.7), (286.4, -37.2):
            check(near(*place, 4), f"the coast at {place}")
        check(not near(220, 0, 15) and not near(240, -30, 15), "none in the Pacific")
    refuse(ValueError, "no longitudes and latitudes", render, field, coast=True, **host)
    refuse(ValueError, "no longitudes and latitudes", render, earth(depths), coast=True, matrix=numpy.eye(4), **host)


def texts():
    q = earth(levels, name="q", units="kg kg-1")
    for size in (256, 256), (320, 240), (640, 480), (1024, 1024), (1920, 1080):
        both = render(q, size=size, device="host", show_axes=True, color_bar=True, coast=True, caption="A caption " * 12, opacity=[(0, 0), (1, 1e-6)])
        alpha = both.rgba[..., 3]
        edge = numpy.concatenate([alpha[:2].ravel(), alpha[-2:].ravel(), alpha[:, :2].ravel(), alpha[:, -2:].ravel()])
        check(alpha.max() > 0.99 and edge.max() == 0, f"text leaves the edge free at {size}")
    none = show(q, caption="", **host)
    check((show(q, **host) != none).any() and (show(q, caption="", exaggerate=1, **host) == show(q, exaggerate=1, **host)).all(), "heights are in the picture")
    factor = show(q, **host).caption
    check((show(q, caption="x", **host) == render(q, caption="x, " + factor, **host).picture((0.08, 0.1, 0.14))).all(), "and behind a caption")
    for background, expected in (None, 0.5), ((1, 1, 1), 0.1), ((0, 0, 0), 0.9):
        picture = show(field, caption="Text", background=background, opacity=[(0, 0), (1, 1e-6)], **host)
        levels_of = picture[5:30, 5:60, :3][picture[5:30, 5:60, 3] > 250].astype(int)
        wanted = levels_of.min() if background == (1, 1, 1) else levels_of.max()
        check(abs(wanted - 255 * expected) <= 2, f"ink over {background}: {wanted}")
    points = numpy.moveaxis(numpy.indices((3, 3, 3)), 0, -1).astype(float)
    mesh = [render_tetrahedra(points, None, numpy.arange(27.0).reshape(3, 3, 3), show_axes=axes, color_bar=axes, **host).rgba for axes in (False, True)]
    check(numpy.abs(mesh[1] - mesh[0]).max() > 0.5, "axes of cells")
    placed = dict(position=(60, -60, 50), focal_point=(12, 10, 3), view_up=(0, 0, 1))
    check(ink(field, camera=placed, show_axes=True).sum() > 500, "a camera of one's own stays, and has axes")
    for name, value, error, words in (("show_axes", "x", TypeError, "show_axes is 'x', it must be True or False"), ("ink", 2, ValueError, "ink is 2"),
                                      ("caption", 3, TypeError, "caption is 3, it must be a text"), ("color_bar", None, TypeError, "color_bar is None")):
        refuse(error, words, render, field, **{name: value}, **host)


warnings.simplefilter("ignore", NothingShown)  # of volumes that leave the picture to text
numbers()
coast()
texts()
done()
