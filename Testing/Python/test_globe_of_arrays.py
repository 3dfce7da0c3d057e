#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""xarray.DataArrays of longitudes and latitudes on a globe: cells fill the shell, points that close the lattice have means, the Earth hides what is
behind it, coastlines are where the coast is, and other data are refused."""
import math
import warnings

from checking import check, done, refuse

import numpy
from stratus_volume import Volume, render, render_several, show, turn
from stratus_volume._draw import drawn_of

RADIUS = 6371000.0
SIZE = 160
host = dict(device="host", size=(SIZE, SIZE))
east, north, levels = 1.5 + 3.0 * numpy.arange(120), -88.5 + 3.0 * numpy.arange(60), numpy.array([0.0, 4000.0, 10000.0])


class Coordinate:
    def __init__(self, values, dims, **attrs):
        self.values, self.dims, self.attrs = numpy.asarray(values, float), dims, attrs


class Labelled:
    """What is read of an xarray.DataArray."""

    def __init__(self, values, dims, coords, name=None, **attrs):
        self.values, self.dims, self.coords, self.attrs, self.encoding, self.name = values, tuple(dims), coords, attrs, {}, name


def earth(values, east=east, north=north, levels=levels, dims=("z", "lat", "lon"), positive="up", **about):
    return Labelled(values, dims, dict(z=Coordinate(levels, ("z",), units="m", positive=positive),
                                       lat=Coordinate(north, ("lat",), units="degrees_north"),
                                       lon=Coordinate(east, ("lon",), units="degrees_east")), **about)


def place(longitude, latitude, height=0.0):
    a, b, r = numpy.radians(longitude), numpy.radians(latitude), RADIUS + height
    return numpy.stack([r * numpy.cos(b) * numpy.cos(a), r * numpy.cos(b) * numpy.sin(a), r * numpy.sin(b)], axis=-1)


def spot(longitude, latitude, east=east, north=north):
    """1 within 5 degrees of a place."""
    cosine = (place(*numpy.meshgrid(east, north)) @ place(longitude, latitude)) / RADIUS ** 2
    return numpy.tile((cosine > math.cos(math.radians(5))).astype("f4"), (3, 1, 1))


def fraction(points, low, high):
    """The share of the shell that cells fill."""
    corners = [points[k:points.shape[0] - 1 + k, j:points.shape[1] - 1 + j, i:points.shape[2] - 1 + i] for k in (0, 1) for j in (0, 1) for i in (0, 1)]
    sizes = 0
    for tetrahedron in (0, 1, 3, 7), (0, 3, 2, 7), (0, 2, 6, 7), (0, 6, 4, 7), (0, 4, 5, 7), (0, 5, 1, 7):
        a, b, c, d = (corners[n] for n in tetrahedron)
        sizes = sizes + numpy.einsum("...i,...i", numpy.cross(b - a, c - a), d - a) / 6
    check((sizes >= -1e-9 * abs(sizes).max()).all() or (sizes <= 1e-9 * abs(sizes).max()).all(), "all cells have one orientation")
    return abs(sizes.sum()) / (4 / 3 * math.pi * ((RADIUS + high) ** 3 - (RADIUS + low) ** 3))


def shells():
    field = numpy.arange(3 * 60 * 120, dtype="f4").reshape(3, 60, 120)
    globe = drawn_of(earth(field), exaggerate=50, device="host", globe=True)
    check(globe.points.shape == (3, 62, 121, 3), f"one more column, and a row at each pole: {globe.points.shape}")
    check(numpy.allclose(globe.points[:, 1:-1, :-1], place(*numpy.meshgrid(east, north))[None] * (1 + 50 * levels / RADIUS)[:, None, None, None],
                         rtol=0, atol=1e-3), "places")
    check(abs(fraction(globe.points, 0, 500000) - 1) < 2e-3, f"cells fill {fraction(globe.points, 0, 500000):.5f} of the shell")
    check(numpy.allclose(globe.values[:, 0], field[:, 0].mean(axis=-1)[:, None]) and (globe.values[:, :, -1] == globe.values[:, :, 0]).all(),
          "poles have the mean of their rows, and the first column comes again")
    check("closed at both poles" in globe.description, globe.description)
    check(abs(drawn_of(earth(field), device="host", globe=True).exaggeration - 63.71) < 1e-9, "heights reach over a tenth of the radius")
    turned = earth(field.transpose(2, 0, 1), dims=("lon", "z", "lat"))
    check((drawn_of(turned, device="host", globe=True).values == globe.values).all(), "dimensions in any order")
    sea = drawn_of(earth(field, positive="down"), exaggerate=1, device="host", globe=True)
    check(abs(numpy.linalg.norm(sea.points[-1], axis=-1) - RADIUS + 10000).max() < 1e-3, "depths are below")

    masked = numpy.ma.masked_where(numpy.arange(field.size).reshape(field.shape) % 120 < 30, field.astype("i4"))
    globe = drawn_of(earth(masked), device="host", globe=True)
    check(globe.values.dtype == "i4" and globe.values[0, 0, 0] == round(field[0, 0, 30:].mean()), f"means leave masked values out: {globe.values[0, 0, 0]}")
    masked[0, 0] = numpy.ma.masked
    check(drawn_of(earth(masked), device="host", globe=True).hidden.reshape(2, 61, 120)[0, 0].all(), "cells at a pole without values are hidden")

    # longitudes and latitudes of two dimensions, with the seam of two poles between the last rows
    i, cap = numpy.arange(180), 45
    shape = numpy.sin(numpy.radians(90 * (1 - (numpy.arange(cap + 1) + 0.5) / cap)))[:, None]
    at = math.tan(math.radians(35)) * (numpy.cos(numpy.radians(2 * i + 1)) + 1j * shape * numpy.sin(numpy.radians(2 * i + 1)))
    south = numpy.arange(-89, 20, 2.0)
    lon = numpy.concatenate([numpy.tile(2.0 * i + 1, (len(south), 1)), numpy.degrees(numpy.angle(at))])
    lat = numpy.concatenate([numpy.tile(south[:, None], (1, 180)), 90 - 2 * numpy.degrees(numpy.arctan(abs(at)))])
    values = numpy.random.default_rng(1).random((3, *lon.shape), "f4")
    coords = dict(z=Coordinate(levels, ("z",), units="m"), nav_lon=Coordinate(lon, ("y", "x"), units="degrees_east"),
                  nav_lat=Coordinate(lat, ("y", "x"), units="degrees_north"), y=Coordinate(numpy.arange(len(lon)), ("y",)))
    globe = drawn_of(Labelled(values, ("z", "y", "x"), coords), exaggerate=50, device="host", globe=True)
    check(globe.points.shape[1:3] == (102, 181) and "closed at the seam between two poles" in globe.description, f"{globe.points.shape}, {globe.description}")
    check(abs(fraction(globe.points, 0, 500000) - 1) < 2e-3, f"a tripolar lattice fills {fraction(globe.points, 0, 500000):.5f} of the shell")
    check(numpy.allclose(globe.values[:, -1, :-1], 0.5 * (values[:, -2] + values[:, -2, ::-1])), "the seam has the mean of both sides")


def pictures():
    look = dict(opacity=[(0, 0), (0.5, 0), (0.6, 1)], color=(1, 0, 0), globe=True, **host)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that nothing shows
        for azimuth, elevation, seen in ((40, 20, True), (220, -20, False)):
            image = render(earth(spot(40, 20)), camera=dict(azimuth=azimuth + 90, elevation=elevation), **look).rgba
            red = (image[..., 0] > 0.3) & (image[..., 0] > 3 * image[..., 1])
            rows, columns = numpy.nonzero(red)
            check(red.any() == seen, f"the Earth hides what is behind it: {red.sum()} pixels")
            if seen:
                check(math.hypot(rows.mean() - (SIZE - 1) / 2, columns.mean() - (SIZE - 1) / 2) < 3, f"the spot is where the camera looks: {rows.mean()}")
    # the disk by the camera's numbers
    camera = dict(position=(3 * RADIUS, 0, 0), focal_point=(0, 0, 0), view_angle=50)
    nothing = dict(look, opacity=[(0, 0), (1, 0)])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        bare = render(earth(spot(40, 20)), camera=camera, exaggerate=1, **nothing).rgba
        across = math.tan(math.asin(0.9997 / 3)) / math.tan(math.radians(25)) * SIZE / 2
        disk = (bare[..., 3] > 0).sum()
        check(abs(disk / (math.pi * across ** 2) - 1) < 0.02 and bare[..., 3].max() == 1, f"the disk has {disk} pixels, {math.pi * across ** 2:.0f} by the camera")
        # Cape Agulhas is the south of Africa; the South Pacific has no coast
        for longitude, latitude, has_coast in ((20, -34.8, True), (-130, -30, False)):
            camera = dict(azimuth=longitude + 90, elevation=latitude, zoom=5)
            plain, coast = (render(earth(spot(40, 20)), camera=camera, exaggerate=1, coast=wanted, **nothing).rgba for wanted in (False, True))
            rows, columns = numpy.nonzero((plain != coast).any(axis=2))
            check(bool(len(rows)) == has_coast, f"coast at {longitude}, {latitude}: {len(rows)} pixels")
            if has_coast:
                apart = numpy.hypot(rows - (SIZE - 1) / 2, columns - (SIZE - 1) / 2)
                check(apart.min() < 4 and rows.max() < SIZE / 2 + 4, f"the cape is {apart.min()} pixels from the middle, {rows.max()} is the south")
    # a region is looked at from above its middle
    x, y = numpy.linspace(100, 130, 31), numpy.linspace(-40, -20, 21)
    image = render(earth(spot(115, -30, x, y), x, y), **look).rgba
    rows, columns = numpy.nonzero((image[..., 0] > 0.3) & (image[..., 0] > 3 * image[..., 1]))
    check(len(rows) > 50 and abs(rows.mean() - SIZE / 2) < 0.15 * SIZE and abs(columns.mean() - SIZE / 2) < 0.15 * SIZE, "the middle of a region")
    # functions by the data's attributes
    warm = earth(280 + 20 * spot(40, 20) + numpy.random.default_rng(2).random((3, 60, 120), "f4"), name="ta", standard_name="air_temperature", units="K")
    picture = show(warm, globe=True, coast=True, color_bar=True, **host)
    check(picture.caption == "heights x 63.71" and picture.std() > 10, f"a picture with its factor: {picture.caption}")
    check(len(turn(warm, globe=True, frames=2, size=(40, 40), device="host")) == 2, "a film of a globe")
    depth = render(warm, globe=True, quantities="length", **host).quantities["length"]
    check(0 < numpy.nanmax(depth) < 2.5 * RADIUS, "numbers of rays that the Earth ends")


def refusals():
    field = spot(40, 20)
    refuse(ValueError, "are of the type ndarray, only xarray's have longitudes", show, field, globe=True)
    refuse(ValueError, "are of the type Volume", render, Volume(field, device="host"), globe=True)
    refuse(TypeError, "globe is 'yes', it must be True or False", show, earth(field), globe="yes")
    refuse(ValueError, "spacing is (1, 1, 1), but on a globe", render, earth(field), globe=True, spacing=(1, 1, 1))
    refuse(ValueError, "matrix is", render, earth(field), globe=True, matrix=numpy.eye(4))
    refuse(ValueError, "exaggerate is 0", render, earth(field), globe=True, exaggerate=0)
    refuse(ValueError, "on a globe the Earth ends rays", render, earth(field), globe=True, opaque_depth=numpy.ones((480, 640), "f4"))
    flat = earth(field)
    flat.coords["lon"] = Coordinate(east, ("lon",), units="m", standard_name="projection_x_coordinate")
    refuse(ValueError, "have no longitudes and latitudes in degrees", render, flat, globe=True)
    turned = earth(field)
    turned.coords["lon"] = Coordinate(east, ("lon",), units="degrees", standard_name="grid_longitude")
    refuse(ValueError, "have no longitudes and latitudes in degrees", render, turned, globe=True)
    bare = earth(field)
    bare.coords["z"] = Coordinate(levels, ("z",), units="1")
    refuse(ValueError, "the dimension 'z' has no coordinate in a unit of length or pressure", render, bare, globe=True)
    refuse(ValueError, "must be less than 637.1", render, earth(field, positive="down"), globe=True, exaggerate=1000)
    refuse(ValueError, "it must have three", render, Labelled(field[0], ("lat", "lon"), earth(field).coords), globe=True)
    globe = drawn_of(earth(field), device="host", globe=True)
    refuse(ValueError, "item 0 is on a globe", render_several, [globe, field])


shells()
pictures()
refusals()
done()
