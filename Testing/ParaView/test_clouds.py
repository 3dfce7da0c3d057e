# SPDX-License-Identifier: BSD-3-Clause
"""pvbatch with the plugin: clouds in physical units. Extinction follows Beer's law, and pictures equal those of `stratus render --cloud`.
pvbatch test_clouds.py PLUGIN STRATUS COMPARE-PICTURES FOLDER."""
import os
import re
import subprocess
import sys
from math import exp

import numpy
from paraview import simple
from paraview.vtk import vtkCommonDataModel, vtkIOImage, vtkIOXML
from paraview.vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from beside import check, folder, leave, load, look_like, shot, stratus
from grids import add, unstructured, write
from showing import make_view, show_volume

LENGTH = 400.0  # metres, of the slab along x
LOOK = [(0, 0), (1, 0.5)], [(0, 0.9, 0.3, 0.1), (1, 0.1, 0.3, 0.9)]  # opacity and colours, which a cloud does not use


def image(name, values, spacing, origin, metres=None):
    """values: [i, j, k]. metres: of a unit of the coordinates, in field data."""
    grid = vtkCommonDataModel.vtkImageData()
    grid.SetDimensions(*values.shape)
    grid.SetSpacing(*spacing)
    grid.SetOrigin(*origin)
    add(grid, name, values)
    if metres:
        array = numpy_to_vtk(numpy.array([metres]), deep=True)
        array.SetName("MetresPerUnit")
        grid.GetFieldData().AddArray(array)
    return grid


def rectilinear(name, values, axes):
    grid = vtkCommonDataModel.vtkRectilinearGrid()
    grid.SetDimensions(*values.shape)
    for coordinates, set_coordinates in zip(axes, (grid.SetXCoordinates, grid.SetYCoordinates, grid.SetZCoordinates)):
        set_coordinates(numpy_to_vtk(coordinates, deep=True))
    add(grid, name, values)
    return grid


def write_grid(grid, name):
    writers = {".vti": vtkIOXML.vtkXMLImageDataWriter, ".vtr": vtkIOXML.vtkXMLRectilinearGridWriter, ".vtu": vtkIOXML.vtkXMLUnstructuredGridWriter}
    return write(grid, writers[os.path.splitext(name)[1]](), folder, name)


def clean(view, *proxies):
    simple.Delete(view)
    for proxy in proxies:
        simple.Delete(proxy)


# ---- Beer's law: the share of the background's light that passes a slab, from pictures before white and black
def transmittance(path, array, settings):
    view = make_view(32, 32)
    source, shown = show_volume(path, array, *LOOK, 1, view)
    width = LENGTH / 1000 if "km" in path else LENGTH
    height = source.GetDataInformation().GetBounds()[4:6]
    middle = [width / 2, 0.25 * width, sum(height) / 2]
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [-10 * width, *middle[1:]], middle, [0, 0, 1]
    view.CameraParallelProjection, view.CameraParallelScale = 1, 0.02 * width
    shown.StratusCloud = 1
    for key, value in settings.items():
        setattr(shown, "Stratus" + key, value)
    levels = []
    for level in 0, 1:
        view.Background = 3 * [level]
        levels.append(shot(view, f"slab-{level}").reshape(32, 32, 3)[16, 16])
    used = str(shown.GetProperty("StratusCloudUsed"))
    clean(view, shown, source)
    return (levels[1] - levels[0]).mean(), used


def standard_density(height):
    """Of the standard atmosphere below 11 km (ICAO Doc 7488), kg/m3."""
    temperature = 288.15 - 0.0065 * height
    return 101325 * (temperature / 288.15) ** 5.25588 / (287.05287 * temperature)


def check_slabs():
    places = dict(spacing=(200, 50, 50), origin=(0, 0, 2950))
    ones = numpy.ones((3, 5, 3))
    km = dict(spacing=(0.2, 0.05, 0.05), origin=(0, 0, 2.95))
    # Of each slab: file, array, value, settings, and its extinction in 1/m by 3 content / (2 density radius).
    slabs = [("slab-si.vti", "qc", 1.5e-5, {}, 1.5 * 1.5e-5 / (1000 * 1e-5)),
             ("slab-g.vti", "lwc", 0.01, dict(WaterUnits="g/m3", EffectiveRadius=8), 1.5 * 1e-5 / (1000 * 8e-6)),
             ("slab-ice.vti", "qi", 0.05, dict(WaterUnits="g/m3"), 1.5 * 5e-5 / (917 * 3e-5)),
             ("slab-ratio.vti", "qc", 0.02, dict(WaterUnits="g/kg"), 1.5 * 2e-5 * standard_density(3000) / (1000 * 1e-5)),
             ("slab-km.vti", "qc", 1.5e-5, {}, 1.5 * 1.5e-5 / (1000 * 1e-5)),
             ("slab-km-given.vti", "qc", 2e-5, dict(WaterUnits="kg/kg", MetresPerUnit=1000), 1.5 * 2e-5 * standard_density(3000) / (1000 * 1e-5)),
             ("slab-cells.vtu", "qc", 0.02, dict(WaterUnits="g/kg"), 1.5 * 2e-5 * standard_density(3000) / (1000 * 1e-5))]
    for name, array, value, settings, extinction in slabs:
        grid = image(array, value * ones, **(km if "km" in name else places), metres=1000 if name == "slab-km.vti" else None)
        path = write_grid(unstructured(grid) if name.endswith("vtu") else grid, name)
        found, used = transmittance(path, array, settings)
        expected = exp(-extinction * LENGTH)
        print(f"{name}: {found:.4f} of the light passes, {expected:.4f} by Beer's law; {used}")
        # Two levels are rounded to bytes, and the extinction may be too small by .001.
        check(abs(found - expected) < 1.2 / 255, f"{name}: extinction is that of water in physical units")


# ---- pictures of the command line, of a cloud with overhangs that has no symmetry
def water(x, y, z):
    """g/kg at places in metres."""
    content = numpy.zeros(numpy.broadcast(x, y, z).shape)
    for cx, cy, cz, r, most in (300, 250, 900, 260, 0.5), (560, 320, 1080, 220, 0.8), (420, 480, 1250, 180, 0.6), (700, 600, 850, 120, 0.3):
        distance = ((x - cx) ** 2 + (y - cy) ** 2 + 1.4 * (z - cz) ** 2) ** 0.5
        content = numpy.maximum(content, most * numpy.clip(1.6 * (1 - distance / r), 0, 1))
    return content


def picture(path):
    """Bytes, rows from below, and channels."""
    reader = vtkIOImage.vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).astype(float)


def check_pictures():
    x, y, z = numpy.linspace(0, 900, 31), numpy.linspace(0, 800, 28), numpy.linspace(600, 1500, 31)
    stretched = [900 * (numpy.linspace(0, 1, 31) + 0.05 * numpy.sin(numpy.linspace(0, 6.28, 31))), y, 600 + 900 * numpy.linspace(0, 1, 31) ** 1.2]
    on = lambda axes: water(*numpy.meshgrid(*axes, indexing="ij", sparse=True))
    even = image("qc", on((x, y, z)), (30, y[1], 30), (0, 0, 600))
    sun = "--sun-at", "150,35"
    place = dict(SunPosition=[150, 35])
    moment = dict(SunTime="2024-06-01 15:30 +02:00", SunPlace=[52.1, 11.6])
    scenes = [("cumulus.vti", even, ("--water-units", "g/kg", *sun), dict(WaterUnits="g/kg", **place)),
              ("cumulus-time.vti", even, ("--water-units", "g/m3", "--sun-time", "2024-06-01 15:30 +02:00", "--place", "52.1,11.6"),
               dict(WaterUnits="g/m3", **moment)),
              ("cumulus.vtr", rectilinear("qc", on(stretched), stretched), ("--water-units", "g/kg", *sun), dict(WaterUnits="g/kg", **place)),
              ("cumulus.vtu", unstructured(even), ("--water-units", "g/kg", *sun), dict(WaterUnits="g/kg", **place))]
    for name, grid, options, settings in scenes:
        path = write_grid(grid, name)
        expected_path = os.path.join(folder, name + "-expected.png")
        ran = subprocess.run([stratus, "render", path, "--array", "qc", "--cloud", "12", "--metres", "1", *options, "-o", expected_path, "--size", "240x200",
                              "--background", "transparent", "--azimuth", "70", "--elevation", "15"], capture_output=True, text=True)
        check(ran.returncode == 0, ran.stderr)
        view = make_view(240, 200)
        source, shown = show_volume(path, "qc", *LOOK, 100, view)
        look_like(view, ran.stdout)
        view.Background = [0.2, 0.3, 0.5]
        before = shot(view, name + "-before")
        shown.StratusCloud, shown.StratusEffectiveRadius = 1, 12
        for key, value in settings.items():
            setattr(shown, "Stratus" + key, value)
        seen = 255 * shot(view, name)
        rgba = picture(expected_path)
        alpha = rgba[:, 3:] / 255
        expected = alpha * rgba[:, :3] + (1 - alpha) * 255 * numpy.array(view.Background)
        covered = alpha[:, 0] > 0
        off = abs(seen - expected)[covered]
        # The command line rounds colours and opacity, ParaView their blend.
        print(f"{name}: differs from `stratus render` by {off.max():.2f} of 255, root mean square {(off ** 2).mean() ** 0.5:.2f}, in {covered.sum()} pixels, "
              f"{seen[covered].max():.0f} at most")
        check(off.max() < 2 and (off ** 2).mean() ** 0.5 < 0.5, f"{name}: the cloud looks as from the command line")
        check(covered.sum() > 5000 and seen[covered].max() > 215, f"{name}: the sun lights the cloud to white")
        used = str(shown.StratusCloudUsed)
        said = re.search(r"azimuth \S+, elevation \S+ degrees", ran.stdout)  # of a sun by time
        there = said[0] if said else "azimuth 150.0, elevation 35.0 degrees"
        check(there in used and "12 um" in used, f"the panel has '{used}', the command line '{there}'")
        shown.StratusCloud = 0
        check((shot(view, name + "-after") == before).all(), f"{name}: without the cloud, the functions and the light of before are back")
        if name == "cumulus.vti":
            check_problems(view, shown, before)
        clean(view, shown, source)


def check_problems(view, shown, before):
    """Settings by which no cloud can be drawn leave the volume as it was, and the panel says why."""
    shown.StratusCloud = 1
    usual = dict(EffectiveRadius=12, WaterUnits="g/kg", SunTime="", SkyUp=[0, 0, 1], SunPosition=[150, 35])
    for words, settings in (("effective radius 0.05 um, must be in 0.1..10000 um", dict(EffectiveRadius=0.05)),
                            ("the unit 'K' of 'qc' is none of water in air", dict(WaterUnits="K")),
                            ("'yesterday'", dict(SunTime="yesterday")),
                            ("the sun is below the horizon", dict(SunTime="2024-06-01 00:00")),
                            ("must be 1 0 0, 0 1 0 or 0 0 1", dict(SkyUp=[1, 0, 1])),
                            ("elevation of the sun 95 degrees", dict(SunPosition=[0, 95]))):
        for key, value in {**usual, **settings}.items():
            setattr(shown, "Stratus" + key, value)
        same = (shot(view, "cumulus-problem") == before).all()
        used = str(shown.StratusCloudUsed)
        check(words in used, f"the panel has '{used}', expected '{words}'")
        check(same, f"{settings}: the volume is drawn without the cloud")
    for key, value in usual.items():
        setattr(shown, "Stratus" + key, value)
    shown.StratusProjection = "Maximum Intensity"
    with_cloud = shot(view, "cumulus-maximum")
    shown.StratusCloud = 0
    check((shot(view, "cumulus-maximum") == with_cloud).all(), "a maximum has the values and the functions of the volume, not those of the cloud")


load()
check_slabs()
check_pictures()
leave()
