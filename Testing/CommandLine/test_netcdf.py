# SPDX-License-Identifier: BSD-3-Clause
"""netCDF files as `stratus` reads them: --select, variables of groups, and which variable is drawn. netCDF4 reads the same values at the same
indices. Usage: test_netcdf.py PATH-OF-STRATUS FOLDER"""
import re

from checking import done, expect, fail

import netCDF4
import numpy

LOOK = ("--size", "48x40", "--device", "host", "--opacity", "0:0,400:.6", "--unit-distance", "1")


def picture(name, *words):
    expect(0, "picture", "render", *words, "-o", name, *LOOK)
    with open(name, "rb") as file:
        return file.read()


def ranges(said):
    """Returns the variables' ranges as info prints them."""
    return {name: (float(low), float(high)) for name, low, high in re.findall(r"variable +'(.*?)'.*?, (\S+) \.\. (\S+)$", said, re.MULTILINE)}


def write(name, variables, group=None, **sizes):
    """Variables by name with their dimensions; all values differ."""
    with netCDF4.Dataset(name, "w") as file:
        place = file.createGroup(group) if group else file
        for dimension, size in sizes.items():
            place.createDimension(dimension, size)
        start = 0
        for variable, dimensions in variables.items():
            shape = [sizes[one] for one in dimensions.split()]
            place.createVariable(variable, "f4", dimensions.split())[:] = start + numpy.arange(numpy.prod(shape)).reshape(shape)
            start += 1000


def test_select():
    write("ensemble.nc", {"q": "number z y x", "r": "z pool y x"}, number=3, pool=2, z=4, y=5, x=6)
    with netCDF4.Dataset("ensemble.nc") as file:
        q, r = file["q"][:], file["r"][:]
    for words, number, pool in (((), 0, 0), (("--select", "number=2"), 2, 0), (("--select", "number=1,pool=1"), 1, 1),
                                (("--select", "pool=1", "--select", "number=1"), 1, 1)):
        said = expect(0, rf"'number' at index {number} of 0\.\.2" + ("$" if "number" in str(words) else ", select number=INDEX for another"), "info",
                      "ensemble.nc", *words)
        printed = ranges(said)
        if printed != {"q": (q[number].min(), q[number].max()), "r": (r[:, pool].min(), r[:, pool].max())}:
            fail(f"info {words} has the ranges {printed}")
    with netCDF4.Dataset("member.nc", "w") as file:
        for dimension, size in zip("zyx", (4, 5, 6)):
            file.createDimension(dimension, size)
        file.createVariable("q", "f4", tuple("zyx"))[:] = q[2]
    if picture("2.png", "ensemble.nc", "--select", "number=2") != picture("member.png", "member.nc"):
        fail("--select draws another picture than a file of only this member")
    if picture("0.png", "ensemble.nc") == picture("2.png", "ensemble.nc", "--select", "number=2"):
        fail("all members are one picture")
    both = picture("both.png", "ensemble.nc", "--select", "number=2", "ensemble.nc", "--select", "number=1")
    if both == picture("both.png", "ensemble.nc", "--select", "number=2", "ensemble.nc", "--select", "number=2"):
        fail("--select is not of the INPUT before it")
    expect(1, "there is no dimension 'level' to select; those that are: number \\(3\\), pool \\(2\\), z \\(4\\)", "info", "ensemble.nc", "--select", "level=1")
    expect(1, "'number' has 3 values, the index must be 0 to 2", "render", "ensemble.nc", "-o", "no.png", "--select", "number=3")
    expect(1, "is not NAME=INDEX", "info", "ensemble.nc", "--select", "number")
    expect(2, "the scene 'cloud' has no dimensions", "info", "cloud", "--select", "number=1")


def test_groups():
    write("groups.nc", {"rho": "z y x"}, group="run1", z=4, y=5, x=6)
    if ranges(expect(0, "drawn +'run1/rho'", "info", "groups.nc")) != {"run1/rho": (0, 119)}:
        fail("a variable of a group")
    expect(0, "array 'run1/rho'", "render", "groups.nc", "--variable", "run1/rho", "-o", "rho.png", *LOOK)


def test_no_volume():
    write("flat.nc", {"tas": "time y x"}, time=3, y=5, x=6)
    expect(1, r"no variable on a grid of three dimensions.*'tas' has the dimensions time \(3\), y \(5\), x \(6\)$", "info", "flat.nc")


def test_warning():
    """Levels without a unit are a warning, which is printed once, and drawn."""
    with netCDF4.Dataset("levels.nc", "w") as file:
        for name, units, size in (("lev", "1", 4), ("lat", "degrees_north", 5), ("lon", "degrees_east", 6)):
            file.createDimension(name, size)
            variable = file.createVariable(name, "f8", (name,))
            variable.setncatts({"units": units, "axis": {"lev": "Z", "lat": "Y", "lon": "X"}[name]})
            variable[:] = numpy.arange(size)
        file.createVariable("q", "f4", ("lev", "lat", "lon"))[:] = numpy.arange(120).reshape(4, 5, 6)
    said = expect(0, "stratus: warning: levels.nc: the levels of 'q' have no unit", "info", "levels.nc")
    if said.count("warning") != 1 or ranges(said) != {"q": (0, 119)}:
        fail(f"a warning is printed once, and the file is read:\n{said}")
    expect(0, "picture +levels.png", "render", "levels.nc", "-o", "levels.png", *LOOK)


test_select()
test_groups()
test_no_volume()
test_warning()
done()
