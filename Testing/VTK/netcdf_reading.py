# SPDX-License-Identifier: BSD-3-Clause
"""Files written by netCDF4 and read by our readers, for tests that judge places and values by NumPy."""
import os
import sys

import netCDF4
import numpy
from vtk.util.numpy_support import vtk_to_numpy

import stratus

folder = sys.argv[1] if len(sys.argv) > 1 else "."
degree = 6371000 * numpy.pi / 180  # metres of a degree on the readers' sphere
failures = 0


def standard_height(pressure):
    """Heights in metres of pressures in Pa in the standard atmosphere (ICAO Doc 7488): its layers' lower ends in geopotential metres, temperatures
    and their change."""
    base, result = 101325.0, numpy.full(numpy.shape(pressure), numpy.nan)
    below = numpy.full(numpy.shape(pressure), True)
    ends = ((0, 288.15, -0.0065), (11000, 216.65, 0.0), (20000, 216.65, 0.001), (32000, 228.65, 0.0028), (47000, 270.65, 0.0),
            (51000, 270.65, -0.0028), (71000, 214.65, None))
    for (low, kelvin, change), (high, _, _) in zip(ends, ends[1:]):
        scale = 287.05287 * kelvin / 9.80665
        with numpy.errstate(divide="ignore"):
            up = -scale * numpy.log(pressure / base) if change == 0 else kelvin / change * ((pressure / base) ** (-change * 287.05287 / 9.80665) - 1)
        result = numpy.where(below, low + up, result)
        base *= numpy.exp((low - high) / scale) if change == 0 else (1 + change * (high - low) / kelvin) ** (-9.80665 / (287.05287 * change))
        below = pressure < base
    return 6356766.0 * result / (6356766.0 - result)


def check(condition, what):
    global failures
    if not condition:
        failures += 1
        print("does not hold:", what)


def finish():
    sys.exit(1 if failures else 0)


def write(name, dimensions, **variables):
    """A file of variables: name=(dimensions, values, attributes, or fill_value among them)."""
    path = os.path.join(folder, name + ".nc")
    with netCDF4.Dataset(path, "w") as file:
        for dimension, size in dimensions.items():
            file.createDimension(dimension, size)
        for variable, (of, values, attributes) in variables.items():
            attributes = dict(attributes)
            values = numpy.asarray(values)
            made = file.createVariable(variable, values.dtype, of.split(), fill_value=attributes.pop("fill", None))
            made.setncatts(attributes)
            made[...] = values
    return path


class Read:
    """What a reader makes of a file: error, description, and of its output points[k, j, i, xyz] and values[k, j, i] in the file's order
    or, of an image or rectilinear grid, in ascending order."""

    def __init__(self, path, variable=None, time=None, cls="vtkStratusCFReader", prepare=None):
        self.error = ""

        def hear(_object, _event, text):
            self.error += text

        hear.CallDataType = "string0"
        reader = self.reader = getattr(stratus, cls)()
        reader.AddObserver("ErrorEvent", hear)
        reader.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
        reader.SetFileName(path)
        if prepare:
            prepare(reader)
        if variable:
            reader.SetVariableName(variable)
        reader.UpdateInformation()
        if not self.error:
            reader.UpdateTimeStep(time) if time is not None else reader.Update()
        self.description = reader.GetDescription()
        self.units = reader.GetLengthUnits()
        self.data = reader.GetOutput()
        if self.error or not self.data or self.data.GetNumberOfPoints() == 0:
            self.error = self.error or "no output"
            return
        if self.data.IsA("vtkUnstructuredGrid"):
            return
        nx, ny, nz = self.data.GetDimensions()
        self.shape = nz, ny, nx
        if self.data.IsA("vtkStructuredGrid"):
            self.points = vtk_to_numpy(self.data.GetPoints().GetData()).reshape(nz, ny, nx, 3)
        else:
            x, y, z = ([self.data.GetPoint(i * step)[a] for i in range(n)] for a, (n, step) in enumerate(((nx, 1), (ny, nx), (nz,
                nx * ny))))
            self.points = numpy.stack(numpy.meshgrid(z, y, x, indexing="ij")[::-1], axis=-1)
        arrays = self.data.GetPointData()
        names = [arrays.GetArrayName(i) for i in range(arrays.GetNumberOfArrays())]
        self.values = vtk_to_numpy(arrays.GetArray([name for name in names if name != "vtkGhostType"][0])).reshape(self.shape)

    def hidden_points(self):
        ghosts = self.data.GetPointData().GetArray("vtkGhostType")
        return numpy.zeros(self.shape, bool) if not ghosts else vtk_to_numpy(ghosts).reshape(self.shape) != 0

    def hidden_cells(self):
        ghosts = self.data.GetCellData().GetArray("vtkGhostType")
        shape = tuple(n - 1 for n in self.shape)
        return numpy.zeros(shape, bool) if not ghosts else vtk_to_numpy(ghosts).reshape(shape) != 0


def near(a, b, tolerance=1e-9):
    """Whether two arrays differ by at most so much of their largest value."""
    a, b = numpy.broadcast_arrays(numpy.asarray(a, float), numpy.asarray(b, float))
    return a.shape == b.shape and bool(numpy.all(numpy.abs(a - b) <= tolerance * max(1e-300, numpy.abs(b).max())))
