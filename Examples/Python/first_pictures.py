#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""first_pictures.py SHEET.png [FOLDER]: writes files of ocean, atmosphere, lakes, the Earth's crust and a scan, in the layouts of models and
instruments, draws each by `stratus render` without an option for its look, and joins the pictures in a sheet. The files stay in FOLDER, if it
is given. Needs `stratus` on the path, netCDF4, and VTK to read and write the pictures."""
import os
import subprocess
import sys
import tempfile

import netCDF4
import numpy

import model_files
from model_files import noise

EAST = dict(standard_name="longitude", axis="X", units="degrees_east")
NORTH = dict(standard_name="latitude", axis="Y", units="degrees_north")
DOWN = dict(standard_name="depth", positive="down", axis="Z", units="m")
UP = dict(standard_name="height", positive="up", axis="Z", units="m")
PRESSURE = dict(standard_name="air_pressure", positive="down", axis="Z", units="hPa")


def write(path, name, values, axes, **attributes):
    """One variable. axes: name, places and attributes of each."""
    with netCDF4.Dataset(path, "w") as file:
        file.Conventions = "CF-1.8"
        for axis, places, own in axes:
            file.createDimension(axis, len(places))
            file.createVariable(axis, "f8", (axis,))[:] = places
            file[axis].setncatts(own)
        file.createVariable(name, "f4", [axis for axis, *_ in axes], fill_value=numpy.float32(1e20))[:] = values
        file[name].setncatts(attributes)


def ocean():
    """The whole ocean on levels that are closer near the surface, with land."""
    depth = 5600 * numpy.geomspace(1, 800, 25) / 800
    lat, lon = numpy.linspace(-78, 80, 60), numpy.linspace(1, 359, 120)
    d, n = depth[:, None, None], lat[None, :, None]
    land = noise((60, 120), 3, 1.8)[None] > 0.45 - d / 3600
    shape = land.shape
    axes = (("depth", depth, DOWN), ("lat", lat, NORTH), ("lon", lon, EAST))
    temperature = -1.5 + 29 * numpy.exp(-(n / 32) ** 2 - d / 700) + 2 * numpy.exp(-d / 2500) + 1.2 * noise(shape, 1) * numpy.exp(-d / 500)
    salinity = 34.6 + 1.6 * numpy.exp(-((abs(n) - 25) / 14) ** 2 - d / 400) - 0.8 * numpy.exp(-((n - 60) / 15) ** 2 - d / 300)
    oxygen = 300 - 8 * temperature.clip(0) - 140 * numpy.exp(-((d - 700) / 500) ** 2 - (n / 30) ** 2)
    chlorophyll = 0.05 + 1.5 * numpy.exp(-d / 60 + noise(shape, 5)) * (1 + 2 * numpy.exp(-((n - 50) / 12) ** 2))
    for name, values, units, standard_name in (
            ("thetao", temperature, "degC", "sea_water_potential_temperature"),
            ("so", salinity + 0.2 * noise(shape, 2) * numpy.exp(-d / 600), "1e-3", "sea_water_salinity"),
            ("o2", oxygen, "mmol m-3", "mole_concentration_of_dissolved_molecular_oxygen_in_sea_water"),
            ("chl", chlorophyll, "mg m-3", "mass_concentration_of_chlorophyll_in_sea_water")):
        yield name, numpy.where(land, 1e20, values), axes, dict(units=units, standard_name=standard_name)


def coast():
    """A river's plume, 60 km long and some metres deep."""
    z, y, x = numpy.meshgrid(-numpy.linspace(0, 25, 20), numpy.linspace(0, 40e3, 50), numpy.linspace(0, 60e3, 80), indexing="ij")
    dye = numpy.exp(-((y - 20e3 - 3e3 * numpy.sin(x / 9e3)) / (3000 + 0.12 * x)) ** 2 + z / 3 - x / 25e3)
    axes = (("z", z[:, 0, 0], dict(units="m", positive="up")), ("y", y[0, :, 0], dict(units="m")), ("x", x[0, 0], dict(units="m")))
    yield "dye", dye * (1 + 0.25 * noise(dye.shape, 9)).clip(0), axes, dict(units="kg m-3", long_name="river water")


def weather():
    """An analysis on pressure levels, and a volcano's plume on heights."""
    level = numpy.array([1000, 950, 900, 850, 800, 700, 600, 500, 400, 350, 300, 250, 225, 200, 175, 150, 125, 100.])
    lat, lon = numpy.linspace(70, 20, 70), numpy.linspace(-60, 60, 110)
    height, n, e = -7 * numpy.log(level[:, None, None] / 1013), lat[None, :, None], lon[None, None, :]
    shape = (len(level), 70, 110)
    jet = n - 48 - 7 * numpy.sin(numpy.radians(4 * e))
    axes = (("level", level, PRESSURE), ("latitude", lat, NORTH), ("longitude", lon, EAST))
    wind = 6 * noise(shape, 31) + 45 * numpy.exp(-(jet / 9) ** 2 - ((height - 10.5) / 4) ** 2) - 8 * numpy.exp(-((n - 24) / 8) ** 2)
    temperature = 288 - 0.55 * (n - 20) - 6.2 * numpy.minimum(height, 11.5) + 1.5 * noise(shape, 30)
    humidity = 0.014 * numpy.exp(-height / 2.2 - (n - 20) / 25) * (1 + 0.35 * noise(shape, 30)).clip(0.02)
    clouds = (0.9 * noise(shape, 32, 1.8) - 0.85).clip(0, 1) * numpy.exp(-((height - 5) / 5) ** 2)
    ascent = 0.3 * noise(shape, 33, 1.6) * numpy.sin(numpy.pi * (height / 14).clip(0, 1))
    for name, values, units, standard_name in (
            ("u", wind, "m s-1", "eastward_wind"), ("t", temperature, "K", "air_temperature"), ("q", humidity, "kg kg-1", "specific_humidity"),
            ("cc", clouds, "1", "cloud_area_fraction_in_atmosphere_layer"), ("w", ascent, "Pa s-1", "lagrangian_tendency_of_air_pressure")):
        yield name, values, axes, dict(units=units, standard_name=standard_name)
    z, y, x = numpy.meshgrid(numpy.linspace(0, 25e3, 30), numpy.linspace(55, 68, 70), numpy.linspace(-30, 10, 100), indexing="ij")
    east = (x + 19).clip(0)
    ash = numpy.exp(-((y - 63 - 1.2 * numpy.sin(east / 5)) / (0.35 + 0.05 * east)) ** 2 - ((z - 9e3 - 120 * east) / 1200) ** 2 - east / 14) * (x > -19)
    ash *= 5e-7 * (1 + 0.4 * noise(ash.shape, 40)).clip(0)
    axes = (("height", z[:, 0, 0], UP), ("lat", y[0, :, 0], NORTH), ("lon", x[0, 0], EAST))
    about = dict(units="kg kg-1", standard_name="mass_fraction_of_sulfur_dioxide_in_air")
    yield "so2", ash, axes, about
    wrong = numpy.random.default_rng(7).random(ash.shape) < 0.5e-3
    yield "so2_spikes", numpy.where(wrong, 5e-3, ash), axes, about


def eddies():
    """Clouds and turbulence in boxes that are not flat, and a tracer without coordinates."""
    z, x = numpy.arange(48) * 0.05 + 0.02, numpy.arange(64) * 0.1
    strength = noise((64, 64), 20, 1.6)[None]
    above = z[:, None, None]
    water = (strength - 0.6).clip(0) * ((above - 0.55) / 0.5).clip(0, 1) * (above < 0.7 + 0.75 * strength.clip(0))
    water = 1e-3 * water * (1 + 0.6 * noise((48, 64, 64), 21, 1.6)).clip(0)
    yield "qc", water, (("zh", z, dict(units="km")), ("yh", x, dict(units="km")), ("xh", x, dict(units="km"))), dict(units="kg/kg")
    box = [(axis, numpy.arange(64) * 0.01, dict(units="m", axis=axis.upper())) for axis in "zyx"]
    yield "vorticity", noise((64, 64, 64), 61, 1.8), box, dict(units="s-1", standard_name="atmosphere_relative_vorticity")
    yield "tracer", (noise((40, 64, 64), 60, 1.9) - 1.9).clip(0), [(axis, numpy.arange(n), {}) for axis, n in zip("zyx", (40, 64, 64))], {}


def write_all(folder):
    """Writes the files, and returns their paths."""
    paths = []
    for of in ocean, coast, weather, eddies:
        for name, values, axes, attributes in of():
            paths.append(os.path.join(folder, name + ".nc"))
            write(paths[-1], name, values, axes, **attributes)
    return paths + model_files.write_all(folder)


def join(pictures, path, columns=3):
    """Writes PNG files of one size as a sheet, row by row. All rows are full."""
    from vtkmodules.vtkFiltersCore import vtkImageAppend
    from vtkmodules.vtkIOImage import vtkPNGReader, vtkPNGWriter
    rows = vtkImageAppend()
    rows.SetAppendAxis(1)
    for first in reversed(range(0, len(pictures), columns)):  # VTK's rows begin at the bottom
        row = vtkImageAppend()
        for name in pictures[first:first + columns]:
            reader = vtkPNGReader()
            reader.SetFileName(name)
            row.AddInputConnection(reader.GetOutputPort())
        rows.AddInputConnection(row.GetOutputPort())
    writer = vtkPNGWriter()
    writer.SetInputConnection(rows.GetOutputPort())
    writer.SetFileName(path)
    writer.Write()


def main():
    if len(sys.argv) not in (2, 3):
        raise SystemExit(__doc__)
    with tempfile.TemporaryDirectory() as temporary:
        pictures, folder = [], sys.argv[2] if len(sys.argv) > 2 else temporary
        os.makedirs(folder, exist_ok=True)
        for path in write_all(folder):
            pictures.append(os.path.join(temporary, os.path.splitext(os.path.basename(path))[0] + ".png"))
            subprocess.run(["stratus", "render", path, "-o", pictures[-1], "--size", "360x270", "--color-bar"], check=True, stdout=subprocess.DEVNULL)
        join(pictures, sys.argv[1])


if __name__ == "__main__":
    main()
