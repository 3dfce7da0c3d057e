# SPDX-License-Identifier: BSD-3-Clause
"""`stratus render --cloud`: extinction by Beer's law in closed form, densities of air, the sun, and what it is short for. Usage: test_cloud_water.py
PATH-OF-STRATUS FOLDER"""
import math
import os
import re

from checking import done, expect, fail

import netCDF4
import numpy

WIDTH = 400.0  # metres, of the slab along x
SMALL = ("-o", "a.png", "--size", "8x8", "--tolerance", "0.1")  # only the words are tested, not the picture
ALONG_X = ("--azimuth", "0", "--elevation", "0", "--parallel", "--size", "32x32", "--device", "host")


def refuse(status, pattern, *words):
    expect(status, pattern, "render", *words, "-o", "no.png")
    if os.path.exists("no.png"):
        fail(f"{words} left a picture")


def write(name, variables, lengths=("m", "m", "m"), time=None, north=None, east=None, calendar=None, curved=False):
    """A file of a 5 x 4 x 3 grid, 400 m wide, from 1000 to 1200 m. variables: (name, units, standard_name, values by height). lengths: the units of
    z, y and x; north, east: the middle in degrees, in place of lengths. curved: heights of three dimensions."""
    metres = {"m": 1.0, "km": 1000.0}
    with netCDF4.Dataset(name, "w") as file:
        places = [1000.0 + 50.0 * numpy.arange(5), 100.0 * numpy.arange(4), WIDTH / 2 * numpy.arange(3)]
        names = ["z", "y", "x"]
        for n, (axis, values, unit) in enumerate(zip(names, places, lengths)):
            file.createDimension(axis, len(values))
            own = file.createVariable(axis, "f8", (axis,))
            if n and north is not None:
                own.units, own.standard_name = (("degrees_north", "latitude"), ("degrees_east", "longitude"))[n - 1]
                own[:] = (north, east)[n - 1] + 0.001 * (numpy.arange(len(values)) - (len(values) - 1) / 2)
            else:
                if unit:
                    own.units = unit
                own[:] = values / metres.get(unit, 1.0)
        dimensions = tuple(names)
        if time:
            file.createDimension("time", numpy.size(time[1]))
            own = file.createVariable("time", "f8", ("time",))
            own.units, own[:] = time[0], time[1]
            if calendar:
                own.calendar = calendar
            dimensions = ("time", *dimensions)
        if curved:
            own = file.createVariable("heights", "f8", tuple(names))
            own.units, own.standard_name = "m", "height"
            own[:] = numpy.broadcast_to(places[0][:, None, None], (5, 4, 3))
        for variable, units, standard_name, values in variables:
            own = file.createVariable(variable, "f8", dimensions)
            if units:
                own.units = units
            if curved:
                own.coordinates = "heights"
            if standard_name:
                own.standard_name = standard_name
            own[:] = numpy.broadcast_to(numpy.reshape(numpy.asarray(values, float), (-1, 1, 1)), (5, 4, 3))


def darkest(file, *words):
    said = expect(0, "quantity +transmittance", "render", file, "-o", "t.png", "--cloud", *words, *ALONG_X, "--quantity", "transmittance")
    found = re.search(r"quantity +transmittance, (\S+) \.\. ", said)
    return float(found[1]) if found else math.nan


def holds(what, found, depth):
    """The function's extinction is too small by at most .001, and rays of 32 pixels sum their samples to about 1e-4."""
    if not abs(-math.log(max(found, 1e-300)) / depth - 1) < 0.002:
        fail(f"{what}: transmittance {found}, by Beer's law {math.exp(-depth)}")


def depth_of(content, radius=1e-5, density=1000.0):
    return 1.5 * content / (density * radius) * WIDTH


def standard_density(height):
    """U.S. Standard Atmosphere 1976 below 11 km, in closed form."""
    return 1.225 * (1 - 0.0065 * (6356766 * height / (6356766 + height)) / 288.15) ** 4.2558797


def test_extinction():
    content = 3e-5
    write("kg.nc", [("qv", "kg kg-1", "specific_humidity", 0.01), ("lwc", "kg m-3", None, content)])
    holds("kg m-3", darkest("kg.nc"), depth_of(content))
    holds("a radius of 20 um", darkest("kg.nc", "20"), depth_of(content) / 2)
    write("g.nc", [("a", "g m-3", "mass_concentration_of_cloud_liquid_water_in_air", 1000 * content)], lengths=("m", "km", "km"))
    holds("g m-3 on kilometres", darkest("g.nc"), depth_of(content))
    write("curved.nc", [("qc", "kg m-3", None, content)], curved=True)
    holds("a curvilinear grid", darkest("curved.nc", "--tolerance", "0.1"), depth_of(content))
    expect(0, "mesh +[1-9]", "render", "curved.nc", "--cloud", *SMALL)
    write("ice.nc", [("QICE", "g m-3", None, 1000 * content)])
    holds("ice", darkest("ice.nc"), depth_of(content, 3e-5, 917.0))
    write("none.nc", [("a", None, None, content)], lengths=("", "", ""))
    holds("units and lengths as given", darkest("none.nc", "--variable", "a", "--water-units", "g/m3", "--metres", "10"), depth_of(content) / 100)
    # a water content that falls linearly in height is nowhere more than at the ground
    write("falls.nc", [("qc", "kg m-3", None, content * numpy.linspace(1, 0, 5))])
    found = darkest("falls.nc")
    if not depth_of(content) * 0.9 < -math.log(found) < depth_of(content):
        fail(f"a content that falls with height: {found}")


def test_air():
    ratio = 3e-5
    write("ratio.nc", [("clw", "kg kg-1", "mass_fraction_of_cloud_liquid_water_in_air", ratio * numpy.array([0, 1, 0, 0, 0]))])
    # Levels are linear between nodes: on rays through the middle level the content is almost its own.
    found = -math.log(darkest("ratio.nc"))
    highest = depth_of(ratio * standard_density(1050.0))
    if not 0.85 * highest < found <= highest:
        fail(f"the standard atmosphere's density: depth {found}, {highest} at the level")
    write("dense.nc", [("qc", "g kg-1", None, 1000 * ratio), ("rho", "kg m-3", "air_density", 0.7)])
    holds("the file's density", darkest("dense.nc"), depth_of(ratio * 0.7))
    write("curved.nc", [("qc", "g kg-1", None, 1000 * ratio), ("rho", "kg m-3", "air_density", 0.7)], curved=True)
    holds("the file's density on a curvilinear grid", darkest("curved.nc", "--tolerance", "0.1"), depth_of(ratio * 0.7))
    expect(0, "air +density 'rho'", "render", "dense.nc", "--cloud", *SMALL)
    write("warm.nc", [("ta", "K", "air_temperature", 250.0), ("qc", "g kg-1", None, 1000 * ratio), ("p", "Pa", "air_pressure", 60000.0)])
    holds("the file's pressure and temperature", darkest("warm.nc"), depth_of(ratio * 60000 / (287.05 * 250)))
    expect(0, "density of dry air by 'p' and 'ta'", "render", "warm.nc", "--cloud", *SMALL)
    write("cold.nc", [("ta", "K", "air_temperature", 25.0), ("qc", "g kg-1", None, 1000 * ratio), ("p", "Pa", "air_pressure", 60000.0)])
    refuse(1, "temperature of air 25 K, must be in 100..400 K", "cold.nc", "--cloud")


def test_sun():
    water = [("qc", "kg m-3", None, 1e-3)]
    # Reda & Andreas 2004, table A5.1: azimuth 194.340, elevation 39.872 without refraction
    write("place.nc", water, time=("hours since 2003-10-17 18:00", 1.0 + 30.5 / 60), north=39.742476, east=-105.1786)
    for words in ((), ("--sun-time", "file"), ("--sun-time", "2003-10-17T12:30:30-07:00")):
        expect(0, r"sun +azimuth 194\.3, elevation 39\.9 degrees, at latitude 39\.74, longitude -105\.18", "render", "place.nc", "--cloud", *words, *SMALL)
    write("night.nc", water, time=("hours since 2003-10-17 00:00", 8.0), north=39.742476, east=-105.1786)
    expect(0, "sun +azimuth 120.0, elevation 40.0 degrees, because at the file's time and place it is -", "render", "night.nc", "--cloud", *SMALL)
    refuse(1, "the sun is below the horizon: azimuth", "night.nc", "--cloud", "--sun-time", "file")
    write("day.nc", water, time=("hours since 2003-10-17", [14.5, 17.5, 30.0]), north=39.742476, east=-105.1786)
    said = expect(0, "frames +3, day", "render", "day.nc", "--cloud", "--frames", "day-%d.bmp", "--size", "24x24", "--device", "host")
    if "HDF5" in said:  # which looks for attributes that files may have, in the thread that reads the next step
        fail("libhdf5 prints what it does not find:\n" + said)
    frames = []
    for n in range(3):
        with open(f"day-{n}.bmp", "rb") as file:
            frames.append(file.read())
    if len(set(frames)) != 3:
        fail("the sun does not move in a film of water that stands still")
    expect(0, "picture", "render", "day.nc", "--cloud", "--time", "step:1", "-o", "day.bmp", "--size", "24x24", "--device", "host")
    with open("day.bmp", "rb") as file:
        if file.read() != frames[1]:
            fail("the sun of a frame is not that of its step")
    refuse(1, "the sun is below the horizon", "day.nc", "--cloud", "--time", "step:2", "--sun-time", "file")
    for since, calendar in ("2003-10-17 18:00", "noleap"), ("1500-01-01", "standard"):
        write("other.nc", water, time=(f"hours since {since}", 1.0), north=39.7, east=-105.2, calendar=calendar)
        refuse(2, "has no times since a date of the Gregorian calendar", "other.nc", "--cloud", "--sun-time", "file")
    write("plain.nc", water)
    expect(0, "sun +azimuth 120.0, elevation 40.0 degrees, as usual, because the file's place is not known", "render", "plain.nc", "--cloud", *SMALL)
    refuse(2, "has no times since a date of", "plain.nc", "--cloud", "--sun-time", "file", "--place", "0,0")
    refuse(2, "has no longitudes and latitudes: give --place", "plain.nc", "--cloud", "--sun-time", "2003-10-17 12:00")
    refuse(2, "--place: when", "plain.nc", "--cloud", "--place", "1,2")
    refuse(2, "leave out one", "plain.nc", "--cloud", "--sun-time", "2003-10-17", "--sun-at", "1,2")
    refuse(1, "elevation of the sun 91 degrees, must be in -90..90", "plain.nc", "--cloud", "--sun-at", "0,91")
    refuse(2, "neither AZIMUTH,ELEVATION nor", "plain.nc", "--cloud", "--sun-at", "0,40,1")
    refuse(1, "latitude 95 degrees, must be in -90..90", "plain.nc", "--cloud", "--sun-time", "2003-10-17 12:00", "--place", "95,0")
    refuse(1, "is no moment like 2024-06-01", "plain.nc", "--cloud", "--sun-time", "noon")


def bytes_of(*words):
    expect(0, "picture", "render", *words, "-o", "b.bmp", "--size", "48x32", "--device", "host", "--background", "black")
    with open("b.bmp", "rb") as file:
        data = file.read()
    return numpy.frombuffer(data[int.from_bytes(data[10:14], "little"):], numpy.uint8).astype(float)


def test_shorthand():
    """--cloud is what its options say, but for the encoding of colours for a screen."""
    content = 2e-4
    write("qc.nc", [("qc", "kg m-3", None, content * numpy.array([0, 1, 2, 1, 0]))])
    sun = [math.cos(math.radians(40)) * math.sin(math.radians(120)), math.cos(math.radians(40)) * math.cos(math.radians(120)),
           math.sin(math.radians(40))]
    bright = (0.4, 0.35, 0.3)
    extinction = 1.5 / (1000 * 1e-5)
    end, distance = 2 * content, 1e-3 / (extinction * 2 * content)
    sky = ",".join(map(str, (0.085, 0.19, 0.4, 0.29, 0.37, 0.46)))
    plain = ("qc.nc", "--scatter", "--multiple", "--sky", sky, "--anisotropy", ".85", "--opacity", f"0:0,{end}:{-math.expm1(-extinction * end * distance)}", "--unit-distance",
             str(distance), "--color", "0:1:1:1", "--sun", ",".join(map(repr, (*sun, *bright))))
    linear = bytes_of(*plain) / 255
    once = bytes_of(*(word for word in plain if word not in ("--multiple", "--sky", sky))) / 255
    if not once.mean() < 0.5 * linear.mean():
        fail(f"light that is scattered often is as dark as light that is scattered once: {once.mean()}, {linear.mean()}")
    for words in (("--sun-at", "120,40," + ",".join(map(str, bright))), ("--sun", ",".join(map(repr, (*sun, *bright))))):
        shown = bytes_of("qc.nc", "--cloud", *words)
        step = 0.6 / 255  # a half by rounding, the rest by the function's error
        low, high = [numpy.where(level <= 0.0031308, 12.92 * level, 1.055 * numpy.maximum(level, 0) ** (1 / 2.4) - 0.055)
                     for level in (numpy.maximum(linear - step, 0), linear + step)]
        if shown.max() < 100 or not ((shown >= 255 * low - 0.6) & (shown <= numpy.minimum(255 * high, 255) + 0.6)).all():
            fail(f"{words}: not the picture of the options that --cloud stands for: {shown.max()}, {linear.max() * 255}")
    before = bytes_of("qc.nc", "--cloud")
    for words in (("--anisotropy", "0"), ("--albedo", ".5"), ("--sun-at", "200,10"), ("--exaggerate", "3"), ("--color", "0:1:0:0"), ("30",), ("--sky", "0,0,0")):
        if (bytes_of("qc.nc", "--cloud", *words) == before).all():
            fail(f"{words} change nothing")
    if not (bytes_of("qc.nc", "--anisotropy", "0", "--cloud") == bytes_of("qc.nc", "--cloud", "--anisotropy", "0")).all():
        fail("options before --cloud are lost")
    expect(0, "mode +path", "render", "qc.nc", "--cloud", "--mode", "path", "--samples", "2", *SMALL)


def test_refusals():
    write("other.nc", [("qr", "kg kg-1", None, 1e-3), ("ta", "K", "air_temperature", 280.0)])
    refuse(1, r"no variable of 'other.nc' is known as water of clouds; choose one by --variable NAME of: qr \(kg kg-1\), ta \(K\)", "other.nc", "--cloud")
    refuse(1, "'ta' has the unit 'K', which is no water in air", "other.nc", "--cloud", "--variable", "ta")
    write("bare.nc", [("qc", None, None, 1e-3)], lengths=("", "", ""))
    refuse(1, "'qc' has no unit: give --water-units", "bare.nc", "--cloud")
    refuse(1, "have no unit of length: give --metres M", "bare.nc", "--cloud", "--water-units", "g/m3")
    refuse(2, "--water-units: 'K' is no mass of water", "bare.nc", "--cloud", "--water-units", "K")
    refuse(1, "the scene 'cloud' has no density of air", "cloud", "--cloud", "--water-units", "g/kg", "--metres", "20")
    refuse(2, "--cloud: 0.05 is outside 0.1..10000", "qc.nc", "--cloud", "0.05")
    for words in ("--opacity", "0:1"), ("--log",), ("--shade",), ("--unit-distance", "3"), ("--mode", "maximum"), ("--color-bar",):
        refuse(2, f"leave out {words[0]}", "qc.nc", "--cloud", *words)
    refuse(2, "--metres is for --cloud", "qc.nc", "--metres", "3")
    refuse(2, "--cloud draws one INPUT", "qc.nc", "qc.nc", "--cloud")
    refuse(2, "--sun-at is for --shade", "qc.nc", "--sun-at", "1,2")
    refuse(2, "--sky is for --scatter --multiple", "qc.nc", "--scatter", "--sky", "1,1,1")
    refuse(2, "--multiple is for --scatter", "qc.nc", "--multiple")
    refuse(2, "leave out --multiple", "qc.nc", "--multiple", "--mode", "path")
    expect(2, "--cloud is for render", "info", "qc.nc", "--cloud")
    expect(0, "extinction 0.15/m for 1 g/m3", "render", "cloud", "--cloud", "--water-units", "g/m3", "--metres", "20", *SMALL)


test_extinction()
test_air()
test_sun()
test_shorthand()
test_refusals()
done()
