# SPDX-License-Identifier: BSD-3-Clause
"""Units of numbers of rays: a netCDF file with axes in km and one without units, whose integrals are known in closed form, drawn by a mapper, by
`stratus render` and by vtkStratusRayQuantities; the filter on other grids, too.  test_netcdf_units.py FOLDER"""
import os
import sys

import numpy
import vtk
from vtk.util.misc import calldata_type
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import stratus

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "ParaView"))
import netcdf

folder = sys.argv[1] if len(sys.argv) > 1 else "."
N = 9  # points along an axis, 1 apart; the field is x + 2 y + 3 z + 1
failures = 0
UNITS = vtk.vtkDataArray.UNITS_LABEL


def check(good, what):
    global failures
    if not good:
        failures += 1
        print(f"FAILED: {what}")


def near(a, b, what, tolerance=1e-5):
    a, b = numpy.asarray(a, float), numpy.asarray(b, float)
    off = numpy.abs(a - b).max() / numpy.abs(b).max() if a.shape == b.shape else numpy.inf
    check(off < tolerance, f"{what}: {off} of the largest off, {a.shape} {b.shape}")


def field(x, y, z):
    return x + 2 * y + 3 * z + 1


def write(name, axis, values):
    at = numpy.arange(N, dtype=float)
    z, y, x = numpy.meshgrid(at, at, at, indexing="ij")
    path = os.path.join(folder, name)
    units = lambda text: {"units": text} if text else {}
    variables = {key: ((key,), at, dict(axis=key.upper(), **units(axis))) for key in "zyx"}
    variables["q"] = (("z", "y", "x"), field(x, y, z), units(values))
    netcdf.write(path, {"z": N, "y": N, "x": N}, variables)
    return path


def read(path):
    reader = stratus.vtkStratusCFReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def units_of(data, name):
    array = data.GetPointData().GetArray(name)
    return array.GetInformation().Get(UNITS()) if array.HasInformation() and array.GetInformation().Has(UNITS()) else ""


def map_of(data, view=2, resolution=(0, 0), direction=None):
    numbers = stratus.vtkStratusRayQuantities()
    numbers.SetInputData(data)
    numbers.SetDevice("host")
    numbers.SetView(view)
    numbers.SetResolution(*resolution)
    if direction:
        numbers.SetDirection(*direction)
    for name in "Integral Length Mean Maximum MaximumDepth Cells".split():
        getattr(numbers, f"Set{name}")(True)
    numbers.Update()
    image = numbers.GetOutput()
    arrays = {image.GetPointData().GetArrayName(n): vtk_to_numpy(image.GetPointData().GetArray(n)).astype(float) for n in range(image.GetPointData().GetNumberOfArrays())}
    points = numpy.array([image.GetPoint(n) for n in range(image.GetNumberOfPoints())])
    return arrays, points, image


def expect_linear(data, view, unit, what, lo=0.0, hi=N - 1.0):
    """Along an axis the mean of a linear field is its value in the middle, and its largest value is at the top."""
    arrays, points, image = map_of(data, view)
    length, scale = hi - lo, [unit, unit, unit]
    at = points / unit
    check(numpy.allclose(at[:, view], hi), f"{what}: the image is not at the top")
    middle, top = at.copy(), at.copy()
    middle[:, view], top[:, view] = 0.5 * (lo + hi), hi
    near(arrays["integral"], field(*middle.T) * length * unit, f"{what}: integral")
    near(arrays["length"], numpy.full(len(at), length * unit), f"{what}: length")
    near(arrays["mean"], field(*middle.T), f"{what}: mean")
    near(arrays["maximum"], field(*top.T), f"{what}: maximum")
    check(numpy.abs(arrays["maximum_depth"]).max() < 1e-3 * length * unit, f"{what}: depth of the maximum, {arrays['maximum_depth'].max()}")
    return arrays, points, image


def of_files():
    for axis, values, metres, integral, length in (("km", "kg/m3", 1000.0, "kg m-2", "m"), ("km", "kg kg-1", 1000.0, "kg kg-1 m", "m"),
                                                   ("", "K", 1.0, "K grid units", "grid units"), ("", "", 1.0, "", "grid units"), ("m", "m-1", 1.0, "1", "m")):
        path = write("units.nc", axis, values)
        data = read(path)
        what = f"axes in '{axis}', values in '{values}'"
        _, _, image = expect_linear(data, 2, metres, what)
        check([units_of(image, name) for name in ("integral", "length", "mean", "maximum_depth", "cells")] == [integral, length, values, length, "1"],
              f"{what}: units are {[units_of(image, name) for name in ('integral', 'length', 'mean', 'maximum_depth', 'cells')]}")
        drawn(data, metres, integral, what)
        written(image, integral, what)


def drawn(data, metres, unit, what):
    """A mapper whose volume stretches heights by 10: the ray through the middle from above, of the data's own length."""
    for stretch in 1.0, 10.0:
        mapper, volume, renderer, window = stratus.vtkStratusVolumeMapper(), vtk.vtkVolume(), vtk.vtkRenderer(), vtk.vtkRenderWindow()
        mapper.SetInputData(data)
        mapper.SetDevice("host")
        mapper.SetQuantities("integral length")
        volume.SetMapper(mapper)
        volume.SetScale(1, 1, stretch)
        window.SetOffScreenRendering(1)
        window.SetSize(32, 32)
        window.AddRenderer(renderer)
        renderer.AddVolume(volume)
        camera = renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetPosition(0, 0, 1)
        camera.SetViewUp(0, 1, 0)
        renderer.ResetCamera()
        window.Render()
        image = mapper.GetLastImage()
        length = vtk_to_numpy(image.GetPointData().GetArray("length"))
        near([length.max()], [(N - 1) * metres], f"{what}, heights times {stretch}: length")
        rays = vtk_to_numpy(image.GetPointData().GetArray("integral"))[length > 0.999 * length.max()]
        near([rays.mean()], [(N - 1) * metres * field(4, 4, 4)], f"{what}, heights times {stretch}: mean of all rays", 1e-3)
        check(units_of(image, "integral") == unit, f"{what}: the mapper's unit is {units_of(image, 'integral')!r}")


def written(image, unit, what):
    if not hasattr(stratus, "vtkStratusEXRWriter"):
        return
    writer = stratus.vtkStratusEXRWriter()
    path = os.path.join(folder, "units.exr")
    writer.SetFileName(path)
    writer.SetInputData(image)
    writer.Write()
    with open(path, "rb") as file:
        head = file.read(4096)
    check((b"integral.units\0string\0" in head) == bool(unit) and (not unit or unit.encode() in head), f"{what}: no unit in the OpenEXR file")


def lattice(kind, shift=0.0, n=N):
    at = numpy.arange(n, dtype=float)
    if kind == "rectilinear":
        grid = vtk.vtkRectilinearGrid()
        grid.SetDimensions(n, n, n)
        for name in "XYZ":
            getattr(grid, f"Set{name}Coordinates")(numpy_to_vtk(at, deep=True))
    else:
        grid = vtk.vtkImageData()
        grid.SetDimensions(n, n, n)
        grid.SetOrigin(shift, 0, 0)
    values = vtk.vtkDoubleArray()
    values.SetName("q")
    for n in range(grid.GetNumberOfPoints()):
        values.InsertNextValue(field(*grid.GetPoint(n)))
    grid.GetPointData().SetScalars(values)
    return grid


def of_grids():
    for view in range(3):
        expect_linear(lattice("image"), view, 1.0, f"an image along {'xyz'[view]}")
    expect_linear(lattice("rectilinear"), 2, 1.0, "a rectilinear grid")
    divide = vtk.vtkDataSetTriangleFilter()
    divide.SetInputData(lattice("image"))
    divide.Update()
    arrays, points, _ = map_of(divide.GetOutput(), 2, (30, 20))
    check(len(points) == 600, "the resolution")
    near(arrays["integral"], 8 * field(points[:, 0], points[:, 1], 4), "tetrahedra: integral")
    blocks = vtk.vtkMultiBlockDataSet()
    blocks.SetBlock(0, lattice("image"))
    blocks.SetBlock(1, lattice("image", N - 1.0))
    arrays, points, _ = map_of(blocks, 0, (10, 10))
    near(arrays["integral"], 16 * field(8, points[:, 1], points[:, 2]), "blocks along x: integral")
    amr = vtk.vtkOverlappingAMR()
    amr.Initialize(1, [1])
    amr.SetOrigin([0, 0, 0])
    amr.SetGridDescription(8)  # VTK_XYZ_GRID
    amr.SetSpacing(0, [1, 1, 1])
    amr.SetAMRBox(0, 0, vtk.vtkAMRBox([0, 0, 0], [N - 2] * 3))
    box = vtk.vtkUniformGrid()
    box.ShallowCopy(lattice("image"))
    amr.SetDataSet(0, 0, box)
    arrays, points, _ = map_of(amr, 2, (10, 10))
    near(arrays["integral"], 8 * field(points[:, 0], points[:, 1], 4), "AMR: integral")


def of_directions():
    """Along a diagonal the middle ray of a cube is the longest, and the image is a plane across it."""
    arrays, points, image = map_of(lattice("image"), 3, (65, 65), (1, 1, 1))
    near([arrays["length"].max()], [8 * 3**0.5], "the diagonal")
    middle = arrays["length"].argmax()
    near([arrays["integral"][middle]], [8 * 3**0.5 * field(4, 4, 4)], "the integral along the diagonal")
    check(numpy.ptp(points.sum(axis=1)) < 1e-4 and abs(points[middle]).max() < 1e-4, f"the image is across the rays, {points[middle]}")


def refusals():
    class Errors:
        def __init__(self, algorithm):
            self.text = ""
            algorithm.AddObserver("ErrorEvent", self.add)
            algorithm.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)

        @calldata_type(vtk.VTK_STRING)
        def add(self, caller, event, text):
            self.text += text

    def expect(text, change, data=None):
        numbers = stratus.vtkStratusRayQuantities()
        numbers.SetInputData(data or lattice("image", n=3))
        change(numbers)
        errors = Errors(numbers)
        numbers.Update()
        check(text in errors.text, f"{text!r} is not in {errors.text!r}")

    expect("no quantity is chosen", lambda numbers: numbers.SetIntegral(False))
    expect("longer than 0", lambda numbers: (numbers.SetView(3), numbers.SetDirection(0, 0, 0)))
    expect("must be 0..16384", lambda numbers: numbers.SetResolution(-1, 4))
    expect("no grid with the array", lambda numbers: numbers.SetInputArrayToProcess(0, 0, 0, 0, "none"))
    expect("device", lambda numbers: numbers.SetDevice("no such device"))
    pieces = stratus.vtkStratusRayQuantities()
    pieces.SetInputData(lattice("image", n=3))
    errors = Errors(pieces)
    pieces.UpdatePiece(0, 2, 0)
    check("on one rank" in errors.text, f"pieces: {errors.text!r}")


of_files()
of_grids()
of_directions()
refusals()
print(f"{failures} failures")
sys.exit(1 if failures else 0)
