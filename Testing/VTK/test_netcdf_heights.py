# SPDX-License-Identifier: BSD-3-Clause
"""Heights of CF's vertical coordinates: every formula of the conventions' appendix D, pressures, depths, units of any spelling, and WRF's
geopotential. Places are computed by NumPy from the arrays that netCDF4 wrote."""
import os

import netCDF4
import numpy

import stratus
from netcdf_reading import Read, check, degree, finish, near, standard_height, write

udunits = os.environ.get("STRATUS_UDUNITS", "1") == "1"  # whether the readers were built with UDUNITS
nt, nz, ny, nx = 2, 6, 4, 5
random = numpy.random.default_rng(7)
lat, lon = numpy.linspace(40, 46, ny), numpy.linspace(3, 9, nx)
field = numpy.arange(nt * nz * ny * nx, dtype="f4").reshape(nt, nz, ny, nx)
axes = {"lat": ("lat", lat, {"units": "degrees_north"}), "lon": ("lon", lon, {"units": "degrees_east"}),
    "time": ("time", numpy.array([0.0, 6.0]), {"units": "hours since 2000-01-01"}), "q": ("time lev lat lon", field, {"units": "1"})}
sizes = {"time": nt, "lev": nz, "lat": ny, "lon": nx}
k = numpy.arange(nz)[:, None, None]


def surface(low, high, times=True):
    """A field over time, latitude and longitude, or the latter two."""
    return random.uniform(low, high, (nt, ny, nx) if times else (ny, nx))


def column(array):
    return numpy.asarray(array)[:, None, None]


def judge(name, path, expected, time, curved=True, variable="q", tolerance=1e-9):
    got = Read(path, variable, time)
    check(not got.error, "%s: %s" % (name, got.error))
    if not got.error:
        check(got.data.IsA("vtkStructuredGrid") == curved, name + ": " + got.data.GetClassName())
        check(near(got.points[..., 2], expected, tolerance),
            "%s: z is %s, not %s" % (name, got.points[:, 0, 0, 2], numpy.broadcast_to(expected, got.shape)[:, 0, 0]))
        check(got.units == "m" and numpy.array_equal(got.values, field[0 if time is None else int(time) // 6]), name + ": values")
    return got


def formula(name, expected, levels, terms, text=None, positive="up", **variables):
    """expected(step): z; terms: variables by terms; text: formula_terms, if written in another way"""
    text = text or " ".join("%s: %s" % pair for pair in terms.items())
    attributes = {"standard_name": name.split(" ")[0], "formula_terms": text, "positive": positive}
    path = write("heights " + name, sizes, lev=("lev", levels, attributes), **variables, **axes)
    for step in range(nt):
        judge(name, path, expected(step), 6.0 * step)
    return path


def scalar(value, units=None):
    return ("", numpy.float64(value), {"units": units} if units else {})


ps, sigma = surface(9e4, 1.03e5), numpy.linspace(.05, .99, nz)
xy, txy = "lat lon", "time lat lon"
formula("atmosphere_ln_pressure_coordinate", lambda t: standard_height(1e5 * numpy.exp(-column(2 - 2 * sigma))), 2 - 2 * sigma,
    {"p0": "p0", "lev": "lev"}, positive="down", p0=scalar(1000, "hPa"))
formula("atmosphere_sigma_coordinate", lambda t: standard_height(500 + column(sigma) * (ps[t] - 500)), sigma,
    {"sigma": "lev", "ps": "ps", "ptop": "top"}, ps=(txy, ps, {"units": "Pa"}), top=scalar(5, "millibar"))
a, b = 2e4 * sigma * (1 - sigma), sigma ** 2
hybrid = {"ps": (txy, ps, {"units": "Pa"}), "bk": ("lev", b, {"units": "1"})}
formula("atmosphere_hybrid_sigma_pressure_coordinate ap", lambda t: standard_height(column(a) + column(b) * ps[t]), numpy.arange(nz) + 1.0,
    {"ap": "ak", "b": "bk", "ps": "ps"}, text="ap : ak b:bk  ps: ps", ak=("lev", a / 100, {"units": "hPa"}), **hybrid)
formula("atmosphere_hybrid_sigma_pressure_coordinate a", lambda t: standard_height(column(a) + column(b) * ps[t]), sigma,
    {"b": "bk", "ps": "ps", "p0": "P0", "a": "ak"}, ak=("lev", a / 1e5, {}), P0=scalar(1e5, "Pa"), **hybrid)
orog = surface(0, 2000, False)
formula("atmosphere_hybrid_height_coordinate", lambda t: column(sigma) * 2e4 + column(1 - sigma) * orog, sigma,
    {"a": "a", "b": "b", "orog": "orog"}, a=("lev", sigma * 20, {"units": "km"}), b=("lev", 1 - sigma, {}), orog=(xy, orog, {"units": "m"}))
small = surface(-100, 300)
formula("atmosphere_sleve_coordinate",
    lambda t: column(sigma) * 3e4 + column((1 - sigma) ** 2) * orog + column((1 - sigma) ** 5) * small[t],
    sigma, {"a": "lev", "b1": "b1", "b2": "b2", "ztop": "ztop", "zsurf1": "large", "zsurf2": "small"}, ztop=scalar(3e4, "m"),
    b1=("lev", (1 - sigma) ** 2, {}), b2=("lev", (1 - sigma) ** 5, {}), large=(xy, orog, {"units": "m"}), small=(txy, small,
        {"units": "m"}))
s = numpy.linspace(-1, 0, nz)
eta, depth = surface(-1, 2), surface(50, 900, False)
sea = {"eta": (txy, 100 * eta, {"units": "cm"}), "depth": (xy, depth, {"units": "m"})}
formula("ocean_sigma_coordinate", lambda t: eta[t] + column(s) * (depth + eta[t]), s, {"sigma": "lev", "eta": "eta", "depth": "depth"},
    **sea)
theta_a, theta_b, critical = 5.0, .4, 30.0
song = (1 - theta_b) * numpy.sinh(theta_a * s) / numpy.sinh(theta_a) + \
    theta_b * (numpy.tanh(theta_a * (s + .5)) / (2 * numpy.tanh(.5 * theta_a)) - .5)
formula("ocean_s_coordinate", lambda t: eta[t] * (1 + column(s)) + critical * column(s) + (depth - critical) * column(song), s,
    {"s": "lev", "eta": "eta", "depth": "depth", "a": "a", "b": "b", "depth_c": "hc"}, a=scalar(theta_a), b=scalar(theta_b),
    hc=scalar(critical, "m"), **sea)
stretched = {"Cs": ("lev", song, {}), "hc": scalar(critical, "m"), **sea}
rest = critical * column(s) + (depth - critical) * column(song)
s_terms = {"s": "lev", "C": "Cs", "eta": "eta", "depth": "depth", "depth_c": "hc"}
formula("ocean_s_coordinate_g1", lambda t: rest + eta[t] * (1 + rest / depth), s, s_terms, **stretched)
ratio = (critical * column(s) + depth * column(song)) / (critical + depth)
formula("ocean_s_coordinate_g2", lambda t: eta[t] + (eta[t] + depth) * ratio, s, s_terms, **stretched)
upper = 3  # levels of sigma, the others have fixed heights
levels = numpy.array([0, -.5, -1, 9e9, 9e9, 9e9])
fixed = numpy.array([9e9, 9e9, 9e9, -300, -500, -1000])


def sigma_z(t):
    z = eta[t] + column(levels) * (numpy.minimum(200, depth) + eta[t])
    return numpy.where(k < upper, z, column(fixed))


mixed = {"sigma": "sigma", "eta": "eta", "depth": "depth", "depth_c": "dc", "zlev": "zlev"}
formula("ocean_sigma_z_coordinate", sigma_z, numpy.arange(nz) * -1.0, mixed, sigma=("lev", levels, {"fill": 9e9}),
    zlev=("lev", fixed, {"fill": 9e9, "units": "m"}), dc=scalar(200, "m"), **sea)
formula("ocean_sigma_z_coordinate nsigma", sigma_z, numpy.arange(nz) * -1.0, {**mixed, "nsigma": "nsigma"}, nsigma=scalar(upper),
    sigma=("lev", numpy.where(levels > 1, 0, levels), {}), zlev=("lev", numpy.where(fixed > 1, 0, fixed), {"units": "m"}),
    dc=scalar(200, "m"), **sea)
twice, z1, z2, steep, href, k_c = numpy.linspace(.2, 2, nz), 60.0, 200.0, .5, 400.0, 3
f = .5 * (z1 + z2) + .5 * (z1 - z2) * numpy.tanh(2 * steep / (z1 - z2) * (depth - href))
double = numpy.where(k + 1 <= k_c, column(twice) * f, f + (column(twice) - 1) * (depth - f))
for way in (1, -1):
    formula("ocean_double_sigma_coordinate %+d" % way, lambda t: way * double, twice,
        {"sigma": "lev", "depth": "depth", "z1": "z1", "z2": "z2", "a": "a", "href": "href", "k_c": "kc"}, a=scalar(steep), kc=scalar(k_c),
        positive="up" if way > 0 else "down", z1=scalar(z1, "m"), z2=scalar(z2, "m"), href=scalar(href, "m"), depth=sea["depth"])

# The hypsometric equation, over the ground that the file has or over the surface pressure's height, from both ends.
kelvin = random.uniform(200, 300, (nt, nz, ny, nx))
terms = {"ap": "ak", "b": "bk", "ps": "ps"}


def hypsometric(pressure, surface_pressure, ground, temperature):
    order = range(nz) if pressure[0, 0, 0] > pressure[-1, 0, 0] else range(nz)[::-1]
    z, below, last = numpy.empty_like(pressure), surface_pressure, None
    height = ground
    for level in order:
        mean = temperature[level] if last is None else .5 * (temperature[level] + last)
        height = height + 287.05 / 9.80665 * mean * numpy.log(below / pressure[level])
        z[level], below, last = height, pressure[level], temperature[level]
    return z


for name, turn, ground, units in (("up", -1, "orog", "m"), ("geopotential", 1, "PHIS", "m2 s-2" if udunits else "gpm"), ("bare", 1, None,
    None)):
    pressure = [column(a[::turn]) + column(b[::turn]) * ps[t] for t in range(nt)]
    extra = {ground: (xy, orog * (9.80665 if units == "m2 s-2" else 1), {"units": units})} if ground else {}
    formula("atmosphere_hybrid_sigma_pressure_coordinate hypsometric " + name,
        lambda t: hypsometric(pressure[t], ps[t], orog if ground else standard_height(ps[t]), kelvin[t]), sigma[::turn], terms,
        ps=hybrid["ps"], ak=("lev", a[::turn], {"units": "Pa"}), bk=("lev", b[::turn], {}),
        ta=("time lev lat lon", kelvin - 273.15, {"units": "degC", "standard_name": "air_temperature"}), **extra)

# A term that is missing on land hides the points there; the others are in their places.
land = eta[0] > 1.2
masked = numpy.where(land, 1e37, eta[:, :, :])
path = write("heights land", sizes, lev=("lev", s, {"standard_name": "ocean_sigma_coordinate",
    "formula_terms": "sigma: lev eta: zeta depth: h"}),
    zeta=(txy, masked, {"fill": 1e37, "units": "meter"}), h=sea["depth"], **axes)
got = Read(path, "q", 0)
check(land.any() and not got.error and near(got.points[:, ~land, 2], (eta[0] + column(s) * (depth + eta[0]))[:, ~land]),
    "points at sea: " + got.error)
check(not got.error and numpy.array_equal(got.hidden_points(), numpy.broadcast_to(land, (nz, ny, nx))), "points on land are hidden")

# Levels of one dimension: units, and which way is up.
numbers = numpy.array([0.0, 10, 30, 100, 200, 500])
pressures = numpy.array([1000.0, 850, 500, 300, 100, 50])
for name, values, attributes, expected in (
    ("depth", numbers, {"standard_name": "depth", "units": "m"}, -numbers), ("Down", numbers, {"positive": "Down", "units": "m"}, -numbers),
    ("DOWN", numbers, {"positive": " DOWN", "units": "Meter"}, -numbers), ("up", -numbers, {"standard_name": "depth", "positive": "up",
        "units": "m"}, -numbers), ("height", numbers, {"standard_name": "height", "units": "KILOMETERS"}, 1000 * numbers),
    ("symbol", numbers, {"units": "KM"}, 1000 * numbers), ("feet", numbers, {"units": "feet", "positive": "up"}, .3048 * numbers),
    ("scaled", numbers, {"units": "10 m"}, 10 * numbers), ("geopotential", numbers, {"units": "m**2 s**-2"}, numbers / 9.80665),
    ("gpm", numbers, {"units": "gpm"}, numbers), ("hPa", pressures, {"units": "hPa"}, standard_height(100 * pressures)),
    ("mb", pressures, {"units": "mb", "positive": "down"}, standard_height(100 * pressures)),
    ("Millibars", pressures, {"units": "Millibars"}, standard_height(100 * pressures)), ("atm", pressures, {"units": "atm"},
        standard_height(101325 * pressures)),
    ("scaled pressure", pressures, {"units": "100 Pa"}, standard_height(100 * pressures)), ("PA", pressures, {"units": "PA"}, standard_height(pressures)),
    ("dbar", numbers, {"units": "dbar"}, -1e4 * numbers / (1025 * 9.80665))):
    if not udunits and name in ("feet", "scaled", "geopotential", "atm", "scaled pressure"):
        continue
    path = write("heights levels " + name, sizes, lev=("lev", values, {"axis": "Z", **attributes}), **axes)
    got = Read(path)
    check(not got.error, "%s: %s" % (name, got.error))
    if not got.error:
        turned = expected[0] > expected[-1]
        check(near(got.points[:, 0, 0, 2], expected[::-1] if turned else expected), "%s: z is %s" % (name, got.points[:, 0, 0, 2]))
        check(numpy.array_equal(got.values, field[0, ::-1] if turned else field[0]) and got.units == "m", name + ": values")
name_only = {"time": nt, "depth": nz, "lat": ny, "lon": nx}
for name, values in (("name", numbers), ("name up", -numbers)):
    got = Read(write("heights " + name, name_only, depth=("depth", values, {"units": "m"}), lat=axes["lat"], lon=axes["lon"],
        time=axes["time"], q=("time depth lat lon", field, {})))
    check(not got.error and near(got.points[:, 0, 0, 2], -numbers[::-1]), name + ": " + got.error)

# Degrees in other spellings, and radians, together with heights in metres.
for name, north, east, scale in (("Degrees", "Degrees_north", "DegreesE", 1), ("letters", "degreeN", "degree_E", 1),
    ("short", "degrees", "arc_degree" if udunits else "Degree", 1), ("radian", "radian", "radians", numpy.pi / 180)):
    got = Read(write("heights degrees " + name, sizes, lev=("lev", numbers, {"units": "m"}), time=axes["time"], q=axes["q"],
        lat=("lat", lat * scale, {"units": north, "standard_name": "latitude"}), lon=("lon", lon * scale, {"units": east,
            "standard_name": "longitude"})))
    check(not got.error and near(got.points[0, :, 0, 1], degree * lat) and got.units == "m" and
        near(got.points[0, 0, :, 0], degree * lon * numpy.cos(numpy.radians(43))), "degrees, " + name + ": " + got.error)

# WRF: layers' middles, staggered variables, with a time or without, and ideal cases.
borders = numpy.linspace(0, 12000, nz + 1)[:, None, None] + surface(0, 1500, False) * numpy.linspace(1, 0, nz + 1)[:, None, None]
moved = random.uniform(-50, 50, (nt, nz + 1, ny, nx))
z_borders = [(9.81 * borders + moved[t]) / 9.81 for t in range(nt)]
middles = [.5 * (z[1:] + z[:-1]) for z in z_borders]
wide = numpy.concatenate
east = lambda z: wide([z[..., :1], .5 * (z[..., 1:] + z[..., :-1]), z[..., -1:]], axis=-1)
north = lambda z: wide([z[:, :1], .5 * (z[:, 1:] + z[:, :-1]), z[:, -1:]], axis=1)
mass = {"Time": nt, "bottom_top": nz, "bottom_top_stag": nz + 1, "south_north": ny, "south_north_stag": ny + 1, "west_east": nx,
    "west_east_stag": nx + 1}
xlat, xlong = lat[:, None] + .01 * lon, lon + .02 * lat[:, None]


def on(array, time=True):
    return ("Time " if time else "") + array


def wrf(name, q_of, coordinates="XLONG XLAT XTIME", time=True, ideal=False, x=xlong, y=xlat, letter=""):
    shape = [mass[one] for one in on(q_of, time).split()]
    values = numpy.arange(numpy.prod(shape), dtype="f4").reshape(shape)
    half = lambda array: numpy.stack([array] * nt) if time else array
    of = q_of.split()
    names = {"XLONG" + letter: (on(" ".join(of[1:]), time), half(0 * x if ideal else x).astype("f4"), {"units": "degree_east"}),
        "XLAT" + letter: (on(" ".join(of[1:]), time), half(0 * y if ideal else y).astype("f4"), {"units": "degree_north"})}
    path = write("heights wrf " + name, mass, **names,
        PH=(on("bottom_top_stag south_north west_east", time), moved if time else moved[0], {"units": "m2 s-2", "stagger": "Z"}),
        PHB=(on("bottom_top_stag south_north west_east", time), half(9.81 * borders), {"units": "m2 s-2", "stagger": "Z"}),
        **({"XTIME": ("Time", numpy.array([0.0, 60.0]), {"units": "minutes since 2000-01-01"})} if time else {}),
        Q=(on(q_of, time), values, {"units": "1", **({"coordinates": coordinates} if coordinates else {})}))
    if ideal:
        with netCDF4.Dataset(path, "a") as file:
            file.DX, file.DY = numpy.float32(3000), numpy.float32(2500)
    return path, values if time else values[None]


across = degree * numpy.cos(numpy.radians(.5 * float(numpy.float32(xlat).min() + numpy.float32(xlat).max())))
layers, levels_of = "bottom_top south_north west_east", "bottom_top_stag south_north west_east"
for name, q_of, expected, options in (("mass", layers, lambda t: middles[t], {}), ("W", levels_of, lambda t: z_borders[t], {}),
    ("unnamed", layers, lambda t: middles[t], {"coordinates": None}), ("still", layers, lambda t: middles[t], {"time": False}),
    ("U", "bottom_top south_north west_east_stag", lambda t: east(middles[t]), {"coordinates": "XLONG_U XLAT_U", "letter": "_U",
        "x": numpy.pad(xlong, ((0, 0), (0, 1)), mode="reflect", reflect_type="odd"), "y": numpy.pad(xlat, ((0, 0), (0, 1)), mode="edge")}),
    ("V", "bottom_top south_north_stag west_east", lambda t: north(middles[t]), {"coordinates": "XLONG_V XLAT_V", "letter": "_V",
        "x": numpy.pad(xlong, ((0, 1), (0, 0)), mode="edge"), "y": numpy.pad(xlat, ((0, 1), (0, 0)), mode="reflect", reflect_type="odd")}),
    ("ideal", layers, lambda t: middles[t], {"ideal": True}),
    ("ideal U", "bottom_top south_north west_east_stag", lambda t: east(middles[t]), {"ideal": True, "letter": "_U",
        "coordinates": "XLONG_U XLAT_U", "x": numpy.zeros((ny, nx + 1)), "y": numpy.zeros((ny, nx + 1))})):
    path, values = wrf(name, q_of, **options)
    for t in range(len(values)):
        got = Read(path, "Q", 60.0 * t if len(values) > 1 else None)
        check(not got.error, "WRF %s: %s" % (name, got.error))
        if got.error:
            continue
        check(near(got.points[..., 2], expected(t), 1e-9) and got.units == "m", "WRF " + name + ": heights")
        check(numpy.array_equal(got.values, values[t]), "WRF " + name + ": values")
        if options.get("ideal"):
            first = -1500 if name == "ideal U" else 0
            check(near(got.points[0, 0, :, 0], first + 3000 * numpy.arange(got.shape[2])) and
                near(got.points[0, :, 0, 1], 2500 * numpy.arange(ny)), "WRF %s: places" % name)
        elif name in ("mass", "W", "unnamed", "still"):
            check(near(got.points[0, ..., 0], across * xlong, 1e-6) and near(got.points[0, ..., 1], degree * xlat, 1e-6),
                "WRF " + name + ": places")

# A coordinate of three dimensions goes before all, and counts as its attributes say.
lifted = random.uniform(1, 2, (nz, ny, nx)) * numpy.linspace(1, 5, nz)[:, None, None]
got = judge("field", write("heights field", sizes, lev=("lev", s, {}), height=("lev lat lon", lifted, {"units": "km", "positive": "DOWN"}),
    **{**axes, "q": ("time lev lat lon", field, {"coordinates": "height"})}), -1000 * lifted, 0)

# Contradictions are refused.
for name, lev, extra, message in (
    ("unit", {"standard_name": "ocean_sigma_coordinate", "formula_terms": "sigma: lev eta: eta depth: depth"},
        {"eta": sea["eta"], "depth": (xy, depth, {"units": "Pa"})}, "'depth', has the unit 'Pa', it must be one of length"),
    ("term", {"standard_name": "atmosphere_sigma_coordinate", "formula_terms": "sigma: lev ps: ps"}, {"ps": hybrid["ps"]},
        "formula_terms 'sigma: lev ps: ps' have no 'ptop'"),
    ("there", {"standard_name": "atmosphere_sigma_coordinate", "formula_terms": "sigma: lev ps: ps ptop: none"}, {"ps": hybrid["ps"]},
        "name 'none' for 'ptop', which is not there"),
    ("negative", {"standard_name": "atmosphere_sigma_coordinate", "formula_terms": "sigma: lev ps: ps ptop: top"},
        {"ps": (txy, -ps, {"units": "Pa"}), "top": scalar(0, "Pa")}, "a pressure must not be negative"),
    ("positive", {"units": "m", "positive": "sideways"}, {}, "has positive 'sideways', it must be up or down"),
    ("below", {"units": "hPa"}, {}, "has a pressure of -1 hPa, it must not be negative")):
    got = Read(write("heights refused " + name, sizes, lev=("lev", numpy.linspace(-1, 0, nz) if name in ("below", "unit") else sigma,
        lev), **extra, **axes))
    check(message in got.error, "%s: '%s' is not in '%s'" % (name, message, got.error))

# Levels that are only numbers give a warning.
path = write("heights bare", sizes, lev=("lev", numpy.arange(nz) + 1.0, {}), **axes)
warnings = []
reader = stratus.vtkStratusCFReader()
reader.AddObserver("WarningEvent", lambda *_: warnings.append(1))
reader.SetFileName(path)
reader.Update()
check(len(warnings) == 1 and reader.GetLengthUnits() == "", "one warning of levels without a unit: %d" % len(warnings))
finish()
