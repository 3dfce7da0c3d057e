# SPDX-License-Identifier: BSD-3-Clause
"""Longitudes that jump by 360 degrees become continuous, on an axis and on a lattice: places judged by NumPy, from the angles before the
jump was made."""
import numpy

from netcdf_reading import Read, check, degree, finish, near, write

nz, ny, nx = 3, 5, 24
heights = numpy.array([0.0, 100.0, 300.0])
latitudes = numpy.linspace(40, 60, ny)
field = numpy.arange(nz * ny * nx, dtype="f4").reshape(nz, ny, nx)


def axis(name, longitudes, units="degrees_east", **attributes):
    path = write("longitudes " + name, {"z": nz, "lat": ny, "lon": len(longitudes)},
        z=("z", heights, {"units": "m", "positive": "up"}), lat=("lat", latitudes, {"units": "degrees_north"}),
        lon=("lon", longitudes, {"units": units, **attributes}), q=("z lat lon", field[:, :, :len(longitudes)], {}))
    return Read(path)


across = degree * numpy.cos(numpy.radians(50))
smooth = numpy.linspace(350, 372, nx)
for name, stored, expected in (
    ("east", smooth % 360, smooth), ("west", smooth[::-1] % 360, smooth[::-1]), ("dateline", smooth % 360 - 180, smooth - 180),
    ("global", (numpy.arange(nx) * 15 + 100 + 180) % 360 - 180, numpy.arange(nx) * 15 + 100), ("plain", smooth - 360, smooth - 360),
    ("two", numpy.array([-180.0, 180.0]), [-180, 180]), ("wide", numpy.array([0.0, 100, 300, 359]), [0, 100, 300, 359]),
    ("single", (smooth % 360).astype("f4"), smooth)):
    got = axis(name, stored)
    check(not got.error, name + ": " + got.error)
    if not got.error:
        x, values = got.points[0, 0, :, 0], got.values
        expected = numpy.asarray(expected, float)
        if expected[0] > expected[-1]:
            expected, values = expected[::-1], values[..., ::-1]
        turns = numpy.round((x / across - expected) / 360)
        check(numpy.all(turns == turns[0]) and near(x, across * (expected + 360 * turns), 2e-7), name + ": places")
        check(near(x[-1 if name == "west" else 0], across * float(stored[0]), 2e-7), name + ": the first stays")
        check(numpy.array_equal(values, field[:, :, :len(stored)]), name + ": values")
got = axis("radians", numpy.radians(smooth % 360), units="radian", standard_name="longitude")
check(not got.error and near(got.points[0, 0, :, 0], across * smooth), "radians: " + got.error)
got = axis("back", numpy.array([0.0, 2, 1, 3]))
check("must increase or decrease all along: number 2 is 1, after 2" in got.error, "an axis that turns back is refused: " + got.error)

# A global ocean of which the longitudes jump at 73 degrees east, with displaced poles: the lattice before the jump is continuous.
rows, columns = 40, 60
j, i = numpy.linspace(0, 1, rows)[:, None], numpy.linspace(0, 1, columns)[None, :]
longitude = -180 + 360 * i + 0 * j
latitude = -77 + 137 * j ** 1.02 + 0 * i
w = numpy.clip((j - .85) / .15, 0, 1)
latitude = latitude + w ** 2 * 18 * numpy.cos(numpy.radians(2 * (longitude - 80))) ** 2
longitude = longitude + w ** 2 * 25 * numpy.sin(numpy.radians(2 * (longitude - 80)))


def lattice(name, longitudes, latitudes, order="y x", **attributes):
    turned = order == "x y"
    n, m = longitudes.shape
    values = numpy.arange(3 * n * m, dtype="f4").reshape(3, n, m)
    path = write("lattice " + name, {"y": n, "x": m, "z": 3}, z=("z", heights, {"units": "m", "positive": "down"}),
        lon=(order, longitudes.T if turned else longitudes, {"units": "degrees_east", **attributes}),
        lat=(order, latitudes.T if turned else latitudes, {"units": "degrees_north", **attributes}),
        q=("z y x", values, {"coordinates": "lat lon"}))
    return Read(path), values


for name, jump, order in (("jump", 73, "y x"), ("turned", 73, "x y"), ("seam", 180, "y x"), ("atlantic", -30, "y x")):
    stored = (longitude + 180 + jump) % 360 - 180
    got, values = lattice(name, stored, latitude, order)
    check(not got.error, name + ": " + got.error)
    if not got.error:
        across = degree * numpy.cos(numpy.radians(.5 * (latitude.min() + latitude.max())))
        expected = longitude + jump
        expected += stored[0, 0] - expected[0, 0]
        check(near(got.points[1, :, :, 0], across * expected), name + ": x is continuous")
        check(near(got.points[1, :, :, 1], degree * latitude) and near(got.points[1, :, :, 2], -100), name + ": y and z")
        check(numpy.array_equal(got.values, values) and not got.hidden_cells().any(), name + ": values, and nothing is hidden")

# Around a pole longitudes cannot be continuous: the cells that they tear apart are hidden, a row of them from the pole outwards.
u, v = numpy.meshgrid(numpy.arange(21) - 9.6, numpy.arange(17) - 7.7)
polar_lon, polar_lat = numpy.degrees(numpy.arctan2(v, u)), 90 - 2 * numpy.hypot(u, v)
got, values = lattice("polar", polar_lon, polar_lat)
check(not got.error, "polar: " + got.error)
if not got.error:
    across = degree * numpy.cos(numpy.radians(.5 * (polar_lat.min() + polar_lat.max())))
    x = got.points[0, :, :, 0] / across
    check(near((x - polar_lon + 180) % 360, 180, 1e-9), "polar: longitudes equal the file's, up to turns")
    corners = numpy.stack([x[:-1, :-1], x[1:, :-1], x[:-1, 1:], x[1:, 1:]])
    torn = corners.max(0) - corners.min(0) > 180
    check(numpy.array_equal(got.hidden_cells(), numpy.broadcast_to(torn, (2, 16, 20))), "polar: torn cells, and no others, are hidden")
    check(1 <= torn.sum() <= 20, "polar: few cells are torn (%d)" % torn.sum())

# Where a model has no longitude, on land, the points are hidden and the others in their places.
land = (i * columns % 7 < 2) & (j * rows % 5 < 3)
got, values = lattice("land", numpy.where(land, 1e20, (longitude + 253) % 360 - 180), numpy.where(land, 1e20, latitude), fill=1e20)
check(not got.error, "land: " + got.error)
if not got.error:
    sea = ~land
    across = degree * numpy.cos(numpy.radians(.5 * (latitude[sea].min() + latitude[sea].max())))
    turns = (got.points[0, :, :, 0] / across - longitude - 73)[sea] / 360
    check(numpy.abs(turns - numpy.round(turns[0])).max() < 1e-9 and near(got.points[0, :, :, 1][sea], degree * latitude[sea]),
        "land: places at sea")
    check(numpy.array_equal(got.hidden_points()[0], land) and numpy.isfinite(got.points).all(), "land: points on land are hidden")
finish()
